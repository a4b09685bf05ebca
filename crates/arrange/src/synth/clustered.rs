//! Drawings arranged by clustered samples ([`vtex_cluster`]): a library becomes its exemplar, the result a scene.

use super::compose::{Arranged, Placement, What};
use super::covered::{MOVED, is_moved};
use super::in_place::vary_in_place;
use super::methods::PlacementMethod;
use super::recognised::{ShapeLook, StandingDrawing, oklab};
use super::refusal::refusal;
use super::report::{ClusterReport, SynthReport};
use super::samples_picture::cluster_picture;
use super::single_drawing::single_drawing;
use super::thinned::thin;
use crate::arrange::Plan;
use crate::arrange::context::DrawnContext;
use crate::arrange::motifs::{DrawnElement, MotifUnits};
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, ConvexPolygon, Outline, Rect, Vec2, rounded};
use vtex_base::progress::{Progress, advance};
use vtex_cluster::{
    ClusterExemplar, ClusterParams, ClusterResult, ClusteredElement, ClusteringParts, Figure, FigurePlace,
    PeriodicPlane, cluster, cluster_beside,
};
use vtex_scene::element::{self, Shape, SimilarTo};
use vtex_scene::library::{ElementId, ExemplarElement, Library};
use vtex_scene::reconstruct::equal;
use vtex_scene::scene::{Ablation, LibraryId, Method, SynthParams};

/// Where no method is asked for: most elements of drawing and texture for which this one is chosen, and the largest side of
/// an element, as a share of the page's.
const MOST: f64 = 10_000.0;
const LARGEST: f64 = 0.5;

/// Most elements that an element may overlap on average, by their bounds, and the number of elements that are looked at.
/// The work grows with the square of the first.
const MOST_OVERLAPPED: usize = 150;
const LOOKED_AT: usize = 200;

/// Distance beyond a page up to which what the page cuts is looked at, in sides of the page.
const BESIDE: f64 = 0.1;

/// Placement by clustered samples: what is known of the drawing.
pub(super) struct Clustered {
    drawing: ClusteredDrawing,
    /// Its motifs: each is one figure.
    units: Option<MotifUnits>,
    /// The drawing that stays.
    standing: Option<StandingDrawing>,
}

impl PlacementMethod for Clustered {
    fn fits(plan: &Plan<'_>, _: &dyn Progress) -> Result<Self> {
        let refused = |allowed| refusal(Method::Clustered, allowed);
        let library = single_drawing(plan).map_err(refused)?;
        if plan.controls.density.is_some() && plan.controls.context.is_some() {
            return Err(refused("without a map of densities, beside a drawing that stays"));
        }
        let clipped = library.primaries().iter().filter(|e| e.clipped).count();
        if clipped > 0 && library.arrangement.periodic {
            return Err(refused(
                "for a drawing whose elements end: some of this one run on from copy to copy, which 'period' keeps",
            ));
        }
        if clipped == library.primaries().len() && clipped > 0 {
            return Err(refused("for a drawing with elements that its border does not cut"));
        }
        if overlapped(library.primaries()) > MOST_OVERLAPPED {
            return Err(refused(
                "for a drawing whose elements overlap few others; most of this one overlap hundreds",
            ));
        }
        let units = MotifUnits::new(library);
        let drawing = ClusteredDrawing::new(units.as_ref().map_or(library, |u| &u.library));
        let canvas = [plan.params.width, plan.params.height].map(f64::from);
        let context = plan.controls.context.as_ref();
        let standing = context.map(|context| StandingDrawing::new(&drawing, context, canvas));
        Ok(Self { drawing, units, standing })
    }

    fn arrange(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
        let go_on = || advance(progress, "primaries", 0, 2);
        go_on()?;
        let Self { drawing, units, standing } = self;
        let (library, params) = (&plan.libraries[0], &plan.params);
        let variation = params.variation.unwrap_or(1.0);
        let size = [params.width, params.height].map(f64::from);
        let parts = ClusteringParts {
            no_switch: params.without(Ablation::Switch),
            no_merge: params.without(Ablation::Merge),
            no_split: params.without(Ablation::Split),
            no_link: params.without(Ablation::Link),
            no_shape: params.without(Ablation::Shape),
        };
        let asked = ClusterParams {
            size,
            tile: [params.tile.x, params.tile.y],
            seed: params.seed,
            variation,
            without: parts,
            without_context: params.without(Ablation::ShapeContext),
            without_depth: params.without(Ablation::Depth),
        };
        let found = match standing {
            None => cluster(&drawing.exemplar, &asked, &go_on)?,
            Some(standing) => cluster_beside(&drawing.exemplar, &standing.context, &asked, &go_on)?,
        };
        advance(progress, "primaries", 1, 2)?;
        for (number, level) in found.levels.iter().enumerate() {
            progress.picture(&format!("samples-{}", number + 1), &|| {
                cluster_picture(level, [params.width, params.height])
            });
        }
        let mut placed = drawing.reaching(&found, params);
        let context = plan.controls.context.as_ref();
        if let Some(context) = context.filter(|_| placed.is_empty()) {
            return Err(context.too_small("elements"));
        }
        // Layers keep their order; within one, the order is that of the result.
        placed.sort_by_key(|e| drawing.places[e.place].layer);
        let known = if units.is_some() { equal(library.primaries()) } else { Vec::new() };
        let placements = placed
            .iter()
            .zip(0..)
            .flat_map(|(e, n)| drawing.placements(library, (units.as_ref(), n), &known, e));
        let placements = placements.collect();
        let share = context.map_or(1.0, |context| context.share(size)) / drawing.of_page;
        let recognised = standing.as_ref().map(|s| [s.recognised, s.context.places.len()]);
        let report = SynthReport {
            clusters: Some(ClusterReport { recognised, ..summed(&found) }),
            ..SynthReport::of_drawing(library, share, None)
        };
        let arranged = Arranged::of_drawing(plan, variation, placements, report);
        let mut arranged = Arranged { counted: Some("primaries"), ..arranged };
        thin(&mut arranged, plan, "primaries", progress)?;
        vary_in_place(&mut arranged, plan, "primaries", progress)?;
        Ok(arranged)
    }

    fn cleared(&self, context: &DrawnContext, canvas: [u32; 2]) -> DrawnContext {
        match &self.standing {
            Some(standing) => context.keeping(&standing.is_kept),
            None => context.without_lines(canvas),
        }
    }
}

/// Whether this method suits a plan best: a drawing of small elements on a page that ends.
pub(super) fn suits(plan: &Plan<'_>) -> bool {
    let [library] = &*plan.libraries else { return false };
    let [w, h] = library.page();
    let pages = f64::from(plan.params.width) * f64::from(plan.params.height) / (w * h);
    let are_few = library.primaries().len() as f64 * pages.max(1.0) <= MOST;
    let is_small = |b: Rect| b.width() <= LARGEST * w && b.height() <= LARGEST * h;
    let are_small = |e: &ExemplarElement| e.clipped || is_small(element::bounds(&e.shapes));
    !library.arrangement.periodic && are_few && library.primaries().iter().all(are_small)
}

/// How many others an element overlaps on average, by their bounds.
fn overlapped(elements: &[ExemplarElement]) -> usize {
    let bounds: Vec<Rect> = elements.iter().map(|e| element::bounds(&e.shapes)).collect();
    let step = bounds.len().div_ceil(LOOKED_AT).max(1);
    let some: Vec<&Rect> = bounds.iter().step_by(step).collect();
    let overlaps = |one: &&Rect| bounds.iter().filter(|other| other.overlaps(**one)).count();
    some.iter().map(overlaps).sum::<usize>() / some.len().max(1)
}

/// Sums over all levels.
fn summed(found: &ClusterResult) -> ClusterReport {
    let mut sum = ClusterReport::default();
    for level in &found.levels {
        sum.samples = level.samples[1];
        sum.iterations += level.energies.len();
        sum.switched += level.operations.switched;
        sum.merged += level.operations.merged;
        sum.split += level.operations.split;
        sum.moved += level.mended.moved;
        sum.removed += level.mended.removed + level.clusters[0] - level.clusters[1];
        sum.added += level.mended.added;
        sum.exchanged += level.mended.exchanged;
        sum.energies.push(level.energies.clone());
    }
    sum
}

/// An element of the drawing at its place.
#[derive(Clone, Copy)]
struct DrawnPlace {
    /// The element, or unit, that is there.
    own: usize,
    /// The first element that it equals, up to its place.
    element: usize,
    /// From the shapes of that element to the place.
    map: Affine,
    /// Reference point of the place.
    at: [f64; 2],
    layer: usize,
}

/// A library as an exemplar of clusters.
pub(super) struct ClusteredDrawing {
    pub(super) exemplar: ClusterExemplar,
    /// The looks of the shapes of each figure, around its reference point.
    pub(super) looks: Vec<Vec<ShapeLook>>,
    /// The drawing's element at each place of the exemplar.
    places: Vec<DrawnPlace>,
    /// Bounds of each place around its reference point.
    bounds: Vec<Rect>,
    /// Share of the page that is looked at.
    of_page: f64,
}

impl ClusteredDrawing {
    fn new(library: &Library) -> Self {
        let elements = library.primaries();
        let known = equal(elements);
        let mut figures: Vec<Figure> = Vec::new();
        let mut looks: Vec<Vec<ShapeLook>> = Vec::new();
        // The linear part that each figure's element is placed with, and the figure.
        let mut of_element: Vec<Vec<([f64; 4], u32)>> = vec![Vec::new(); elements.len()];
        let (mut places, mut drawn, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        let size = [library.source.width, library.source.height].map(f64::from);
        let around_page = Rect::new(0.0, 0.0, size[0], size[1]);
        let around = around_page.inflate(BESIDE * size[0], BESIDE * size[1]);
        for (l, layer) in library.layers.iter().enumerate() {
            for instance in &layer.instances {
                let own = instance.element.index();
                let Some(e) = elements.get(own) else { continue };
                let (element, from) = moved_first(&known, own);
                let map = Affine::new(instance.transform) * from;
                let [a, b, c, d, ..] = map.as_coeffs();
                let shapes = &elements[element].shapes;
                // What the border cuts only shows the others where no room is: it need not reach far beyond the page.
                let is_far = !around.contains_rect(map.transform_rect_bbox(element::bounds(shapes)));
                let cut = (e.clipped && is_far).then(|| within(shapes, map, around));
                let bounds_of = |all: &[Outline]| all.iter().map(Outline::bounds).reduce(|a, b| a.union(b));
                let shown = cut.as_deref().map_or_else(|| Some(element::bounds(shapes)), bounds_of);
                let Some(middle) = shown.map(|b| b.center()) else { continue };
                let listed = &mut of_element[element];
                let linear = [a, b, c, d];
                let alike = |other: &&([f64; 4], u32)| (0..4).all(|k| (other.0[k] - linear[k]).abs() < MOVED);
                let like = listed.iter().find(alike).filter(|_| cut.is_none());
                let figure = like.map_or(figures.len() as u32, |f| f.1);
                let turned = Affine::new([a, b, c, d, 0.0, 0.0]) * Affine::translate(-middle.to_vec2());
                if figure as usize == figures.len() {
                    if cut.is_none() {
                        listed.push((linear, figure));
                    }
                    let outlines = cut.unwrap_or_else(|| shapes.iter().map(|s| s.outline.clone()).collect());
                    let outlines = outlines.iter().map(|outline| outline.moved(turned)).collect();
                    let category = e.category.map_or(0, |c| c.index() as u32);
                    figures.push(Figure { outlines, category, colour: oklab(e.colour) });
                    looks.push(shapes.iter().map(|s| ShapeLook::of(s, turned)).collect());
                }
                let at = map * middle;
                let at = [at.x, at.y];
                places.push(FigurePlace { figure, at, placeable: !e.clipped });
                drawn.push(DrawnPlace { own, element, map, at, layer: l });
                bounds.push(figures[figure as usize].bounds());
            }
        }
        let wraps = [library.arrangement.periodic; 2];
        let page = if wraps[0] { around_page } else { trimmed(around_page, &places, &bounds) };
        places.iter_mut().for_each(|place| place.at = [place.at[0] - page.x0, place.at[1] - page.y0]);
        let of_page = page.area() / around_page.area();
        let page = PeriodicPlane { size: [page.width(), page.height()], wraps };
        Self { exemplar: ClusterExemplar { page, figures, places }, looks, places: drawn, bounds, of_page }
    }

    /// The elements that reach the canvas.
    fn reaching(&self, found: &ClusterResult, params: &SynthParams) -> Vec<ClusteredElement> {
        let canvas = Rect::new(0.0, 0.0, f64::from(params.width), f64::from(params.height));
        let size = [canvas.width(), canvas.height()];
        let tile = [params.tile.x, params.tile.y];
        let reaches = |e: &&ClusteredElement| {
            let b = self.bounds[e.place] + Vec2::new(e.at[0], e.at[1]);
            (tile[0] || b.x1 > 0.0 && b.x0 < size[0]) && (tile[1] || b.y1 > 0.0 && b.y0 < size[1])
        };
        found.elements.iter().filter(reaches).copied().collect()
    }

    /// The elements of the drawing that an element of the result stands for: itself, or the parts of a motif, which get a
    /// number.
    fn placements(
        &self,
        library: &Library,
        (units, number): (Option<&MotifUnits>, u32),
        known: &[SimilarTo],
        element: &ClusteredElement,
    ) -> Vec<Placement<'static>> {
        let DrawnPlace { own, element: first, map, at, layer } = self.places[element.place];
        let by = Affine::translate((element.at[0] - at[0], element.at[1] - at[1]));
        let motif = units.and_then(|units| units.kind(own)).map(|_| number);
        let placement = |first: usize, map: Affine, layer: usize| {
            let [x, y] = library.elements[first].origin().map(f64::from);
            Placement {
                what: What::Known(LibraryId(0), ElementId::after(first), None),
                transform: rounded(by * map * Affine::translate((x, y))),
                layer,
                motif,
                height: 0,
            }
        };
        let Some(units) = units else { return vec![placement(first, map, layer)] };
        let part = |part: &DrawnElement| {
            let (first, from) = moved_first(known, part.element);
            placement(first, part.map * from, part.order.layer)
        };
        units.parts[own].iter().map(part).collect()
    }
}

/// The page without a margin wider than half the mean distance of elements: it would be a hole in the texture.
fn trimmed(page: Rect, places: &[FigurePlace], bounds: &[Rect]) -> Rect {
    let moved = |(place, b): (&FigurePlace, &Rect)| *b + Vec2::new(place.at[0], place.at[1]);
    let Some(all) = places.iter().zip(bounds).map(moved).reduce(|a, b| a.union(b)) else { return page };
    let margin = 0.5 * libm::sqrt(all.area() / places.len() as f64);
    let trimmed = all.inflate(margin, margin).intersect(page);
    // Not where all lies beside the page.
    if trimmed.width().min(trimmed.height()) < 1.0 { page } else { trimmed }
}

/// The parts of shapes, as a map places them, that lie within a rectangle, in the coordinates of the shapes.
fn within(shapes: &[Shape], map: Affine, rectangle: Rect) -> Vec<Outline> {
    let polygon = ConvexPolygon::rect(rectangle);
    let part = |shape: &Shape| Some(polygon.part_of(&shape.outline.moved(map))?.moved(map.inverse()));
    shapes.iter().filter_map(part).collect()
}

/// The first element that an element equals up to its place, and the translation from that one; or itself.
fn moved_first(known: &[SimilarTo], own: usize) -> (usize, Affine) {
    let SimilarTo { first, map } = known[own];
    if is_moved(map) { (first, Affine::translate(map.translation())) } else { (own, Affine::IDENTITY) }
}

#[cfg(test)]
mod tests {
    use crate::synth::testing::drawing_of;
    use crate::synth::{Controls, synthesize_with};
    use vtex_base::error::{Error, Result};
    use vtex_base::geometry::{Outline, parse_path};
    use vtex_base::raster::LabelMap;
    use vtex_scene::library::{Library, testing};
    use vtex_scene::scene::{Ablation, Method, Scene, SynthParams, Tile};

    /// A drawing of rectangles of three sizes, no two rows alike.
    fn drawing() -> Library {
        let mut map = LabelMap::filled(160, 160, 0);
        for k in 0..16u32 {
            let (w, h) = [(22, 14), (12, 24), (9, 9)][(k * k % 7 % 3) as usize];
            let (x0, y0) = (4 + k % 4 * 40 + k / 4 * 3 % 8, 5 + k / 4 * 40 + k * 5 % 9);
            for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x0 + x, y0 + y))) {
                map.labels[(y * 160 + x) as usize] = k + 1;
            }
        }
        drawing_of(&map)
    }

    fn run(library: &Library, tile: bool, ablate: Vec<Ablation>) -> Result<Scene> {
        let params = SynthParams {
            width: 400,
            height: 320,
            seed: 2,
            method: Method::Clustered,
            tile: Tile { x: tile, y: tile },
            ablate,
            ..SynthParams::default()
        };
        let controls = Controls::default();
        let made = synthesize_with(std::slice::from_ref(library), &params, &controls, &());
        made.map(|(scene, report)| {
            assert_eq!(report.method, Method::Clustered);
            let off = (report.coverage / report.coverage_wanted - 1.0).abs();
            assert!(off < 0.1, "{} of {}", report.coverage, report.coverage_wanted);
            assert!(report.overlap.hidden < 0.01, "{:?}", report.overlap);
            let clusters = report.clusters.unwrap();
            assert!(clusters.samples > 0 && clusters.iterations >= clusters.energies.len());
            scene
        })
    }

    #[test]
    fn elements_of_a_drawing_are_moved_only() {
        let library = drawing();
        for tile in [false, true] {
            let scene = run(&library, tile, Vec::new()).unwrap();
            scene.check().unwrap();
            assert!(scene.instances().count() > 60);
            for instance in scene.instances() {
                assert_eq!(instance.transform[..4], [1.0, 0.0, 0.0, 1.0]);
                assert!(scene.elements[instance.element.index()].source.is_some());
            }
        }
        let parts = vec![Ablation::Link, Ablation::ShapeContext, Ablation::Switch];
        assert_ne!(
            run(&library, true, parts).unwrap().layers,
            run(&library, true, Vec::new()).unwrap().layers
        );
    }

    #[test]
    fn a_wide_margin_is_left_out() {
        let mut library = drawing();
        library.arrangement.periodic = false;
        let whole = super::ClusteredDrawing::new(&library);
        // The same elements in the middle of a page of three times the sides.
        for side in [&mut library.source.width, &mut library.source.height] {
            *side *= 3;
        }
        for instance in library.layers.iter_mut().flat_map(|l| &mut l.instances) {
            instance.transform[4] += 160.0;
            instance.transform[5] += 160.0;
        }
        let trimmed = super::ClusteredDrawing::new(&library);
        let [a, b] = [&whole, &trimmed].map(|drawing| drawing.exemplar.page.size);
        assert!((0..2).all(|k| b[k] >= a[k] - 20.0 && b[k] <= a[k] + 40.0), "{a:?} {b:?}");
        let share = b[0] * b[1] / (480.0 * 480.0);
        assert!((trimmed.of_page - share).abs() < 1e-9);
        for (place, drawn) in trimmed.exemplar.places.iter().zip(&trimmed.places) {
            assert!((0..2).all(|k| (0.0..b[k]).contains(&place.at[k]) && drawn.at[k] > 160.0));
        }
    }

    #[test]
    fn what_the_page_cuts_is_looked_at_near_the_page_only() {
        let mut library = drawing();
        library.arrangement.periodic = false;
        let path = parse_path("M-5000 20H80V140z").unwrap();
        library.elements[0].shapes[0].outline = Outline::new(&path).unwrap();
        library.elements[0].clipped = true;
        let cut = library.layers.iter_mut().flat_map(|l| &mut l.instances).find(|i| i.element.index() == 0);
        cut.unwrap().transform = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let drawn = super::ClusteredDrawing::new(&library);
        let size = [library.source.width, library.source.height].map(f64::from);
        for (place, bounds) in drawn.exemplar.places.iter().zip(&drawn.bounds) {
            let b = *bounds + vtex_base::geometry::Vec2::new(place.at[0], place.at[1]);
            assert!(b.x0 > -0.11 * size[0] && b.x1 < 1.11 * size[0], "{b:?}");
        }
        assert_eq!(drawn.exemplar.places.len(), library.primaries().len());
    }

    #[test]
    fn what_it_is_not_for_is_refused() {
        let refused = |library: &Library| {
            matches!(run(library, false, Vec::new()), Err(Error::Parameter { name: "method", .. }))
        };
        let photograph = testing::library(&LabelMap::filled(60, 60, 0));
        assert!(refused(&photograph));
        let mut endless = drawing();
        endless.elements[0].clipped = true;
        assert!(refused(&endless));
    }
}
