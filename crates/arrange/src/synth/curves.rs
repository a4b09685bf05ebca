//! Drawings of lines that run on, made anew as curves ([`vtex_curves`]), or continued.

use super::cell_drawing::CellDrawing;
use super::cells::cell_texture;
use super::compose::{Arranged, Placement, What};
use super::line_density::thinned;
use super::line_drawing::{LineDrawing, is_line};
use super::methods::PlacementMethod;
use super::refusal::{if_fits, refusal};
use super::report::{CurveReport, SynthReport};
use super::samples_picture::graph_picture;
use super::single_drawing::single_drawing;
use super::thinned::shown;
use crate::arrange::Plan;
use crate::arrange::context::DrawnContext;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::geometry::{Affine, Point};
use vtex_base::progress::{Progress, advance};
use vtex_curves::{CurveContext, CurveGraph, CurveParams, CurveParts, CurveResult, curves, curves_beside};
use vtex_scene::element::Shape;
use vtex_scene::library::Library;
use vtex_scene::scene::{Ablation, Element, Method};

/// Longest side of an element between the lines, as a share of the page's shorter one, and largest share that larger ones
/// may have of the area of all lines and larger elements.
const LARGEST: f64 = 0.35;
const STRAY: f64 = 0.02;
/// Least share of the area that lines longer than [`LARGEST`] have in a drawing whose lines run on; and that lines have in
/// one of short lines, of which most meet others.
const LONG: f64 = 0.05;
const SHORT: f64 = 0.5;
const MEET: f64 = 0.8;
/// Tolerance of curves, in widths of the thinnest line.
const TOLERANCE: f64 = 0.04;
/// The stage in which a drawing is looked at, and what the method is for.
const STAGE: &str = "primaries";
const LINES: &str = "for a drawing of lines, strokes or filled shapes that are long and thin, with small elements between them, \
     or of cells that lie side by side";

/// Placement by curves, or by cells that come whole.
pub(super) struct Curves {
    /// The cells of the drawing, if it is one of cells.
    cells: Option<CellDrawing>,
}

/// The drawing of a plan that asks for nothing that curves do not follow; else what they are for.
fn drawing_of<'a>(plan: &'a Plan<'_>) -> Result<&'a Library, &'static str> {
    if plan.params.varies() {
        Err("without turned, mirrored or resized elements")
    } else {
        single_drawing(plan)
    }
}

impl PlacementMethod for Curves {
    fn fits(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Self> {
        let library = drawing_of(plan).map_err(|allowed| refusal(Method::Curves, allowed))?;
        if plan.controls.density.is_some() && plan.controls.context.is_some() {
            return Err(refusal(Method::Curves, "without a map of densities, beside a drawing that stays"));
        }
        let cells = cells_of(plan, progress)?;
        if cells.is_some() || is_of_lines(library) {
            Ok(Self { cells })
        } else {
            Err(refusal(Method::Curves, LINES))
        }
    }

    fn arrange(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
        match &self.cells {
            Some(cells) => cell_texture(plan, cells, progress),
            None => line_texture(plan, progress),
        }
    }
}

impl Curves {
    /// A drawing of cells that come in an order of their own.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub(super) fn of_rearranged_cells(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Option<Self>> {
        if drawing_of(plan).is_err() {
            return Ok(None);
        }
        let Some(cells) = cells_of(plan, progress)? else { return Ok(None) };
        let is_rearranged = cells.exemplar.is_rearranged(&|| advance(progress, STAGE, 0, 2));
        Ok(if_fits(is_rearranged)?.unwrap_or(false).then_some(Self { cells: Some(cells) }))
    }
}

/// Whether a drawing has lines and hardly anything else that is large.
fn is_of_lines(library: &Library) -> bool {
    let (mut lines, mut others) = (0.0, 0.0);
    let largest = LARGEST * f64::from(library.source.width.min(library.source.height));
    for shape in library.primaries().iter().flat_map(|e| &e.shapes) {
        let bounds = shape.outline.bounds();
        if is_line(shape) {
            lines += shape.area();
        } else if bounds.width().max(bounds.height()) > largest {
            others += shape.area();
        }
    }
    lines > 0.0 && others <= STRAY * (lines + others)
}

/// Whether the lines of a drawing run on, so that it is more than elements side by side.
pub(super) fn runs_on(library: &Library) -> bool {
    let elements = library.primaries();
    let largest = LARGEST * f64::from(library.source.width.min(library.source.height));
    let touching = library.arrangement.to_labels().touching();
    let (mut all, mut long, mut lines) = (0.0, 0.0, 0.0);
    let (mut count, mut meeting) = (0.0, 0.0);
    for (k, element) in elements.iter().enumerate() {
        let area: f64 = element.shapes.iter().map(Shape::area).sum();
        all += area;
        if !element.shapes.iter().all(is_line) {
            continue;
        }
        let meets = touching.get(k + 1) == Some(&true);
        (lines, count, meeting) = (lines + area, count + 1.0, meeting + f64::from(u8::from(meets)));
        // A short period may hold long elements, which end nevertheless.
        let is_open = meets || element.clipped || !library.arrangement.periodic;
        let bounds = vtex_scene::element::bounds(&element.shapes);
        if is_open && bounds.width().max(bounds.height()) > largest {
            long += area;
        }
    }
    long > LONG * all || lines > SHORT * all && meeting > MEET * count
}

/// The cells of the only library of a plan, if it is a drawing of cells and nothing is asked that these do not follow.
fn cells_of(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Option<CellDrawing>> {
    if plan.controls.density.is_some() || plan.controls.context.is_some() {
        return Ok(None);
    }
    let library = &plan.libraries[0];
    let page = page(library, library.arrangement.periodic);
    CellDrawing::of(library, page, &|| advance(progress, STAGE, 0, 2))
}

/// The page of a library.
fn page(library: &Library, periodic: bool) -> PeriodicPlane {
    let size = [library.source.width, library.source.height].map(f64::from);
    PeriodicPlane { size, wraps: [periodic; 2] }
}

/// A texture of curves, and how close it came.
///
/// # Errors
/// As [`curves`], and those of `progress`.
fn line_texture(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
    let Plan { params, controls, .. } = plan;
    let library = &plan.libraries[0];
    let go_on = || advance(progress, "curves", 0, 2);
    go_on()?;
    let periodic = library.arrangement.periodic;
    // What is drawn beside has layers and categories of its own.
    let by_look = controls.context.is_some();
    let mut drawing = LineDrawing::new(library, page(library, periodic), by_look, &go_on)?;
    let mut graph = drawing.exemplar.graph(&go_on)?;
    if periodic && !drawing.exemplar.is_seamless(&graph) {
        drawing = LineDrawing::new(library, page(library, false), by_look, &go_on)?;
        graph = drawing.exemplar.graph(&go_on)?;
    }
    // Lines are made as densely as the densest place asks for, and shown as densely as each place does.
    let canvas = [params.width, params.height].map(f64::from);
    let dense = controls.largest_density().max(1.0);
    let asked = CurveParams {
        size: canvas.map(|side| dense * side),
        tile: [params.tile.x, params.tile.y],
        seed: params.seed,
        variation: params.variation.unwrap_or(1.0),
        tolerance: dense * TOLERANCE * drawing.thinnest,
        without: CurveParts {
            no_edge: params.without(Ablation::Edge),
            no_robust: params.without(Ablation::Robust),
            no_orientation: params.without(Ablation::Orientation),
            no_existence: params.without(Ablation::Existence),
            no_patches: params.without(Ablation::Patches),
            no_mend: params.without(Ablation::Mend),
        },
    };
    let mut found = match &controls.context {
        Some(context) => continued((&drawing, &graph), context, &asked, &go_on)?,
        None => curves(&graph, &asked, &go_on)?,
    };
    if found.curves.is_empty() {
        return Err(refusal(Method::Curves, LINES));
    }
    advance(progress, "curves", 1, 2)?;
    for (number, level) in found.levels.iter().enumerate() {
        progress.picture(&format!("graph-{}", number + 1), &|| {
            graph_picture(level, asked.size.map(|side| libm::ceil(side) as u32))
        });
    }
    if controls.density.is_some() {
        for curve in &mut found.curves {
            curve.path.apply_affine(Affine::scale(1.0 / dense));
            curve.shown_length /= dense;
        }
        found.elements.iter_mut().for_each(|e| e.at = e.at.map(|v| v / dense));
        let plane = PeriodicPlane { size: canvas, wraps: asked.tile };
        let density = |at| controls.density_at(plane.wrapped(at), canvas) / dense;
        // Length by area has grown by `dense`, number by area by its square.
        let places: Vec<Point> =
            found.elements.iter().map(|e| Point::from(<(f64, f64)>::from(e.at))).collect();
        let mut stays = shown(&places, plane, params.seed, |at| density([at.x, at.y]) / dense).into_iter();
        found.elements.retain(|_| stays.next() == Some(true));
        found.curves = thinned(std::mem::take(&mut found.curves), plane, density, &go_on)?;
    }
    found.curves.sort_by_key(|c| (drawing.styles[c.style as usize].layer, c.style));
    let line = |(element, at, layer): (Element, Point, usize)| Placement {
        what: What::Made(Box::new(element)),
        transform: Affine::translate(at.to_vec2()).as_coeffs(),
        layer,
        motif: None,
        height: 0,
    };
    let lines = found.curves.iter().filter_map(|curve| drawing.element(curve)).map(line);
    let between = |below: bool| {
        let drawing = &drawing;
        found.elements.iter().filter_map(move |placed| {
            let element = &drawing.elements[placed.element as usize];
            (element.is_below(&drawing.styles) == below).then(|| element.placed(placed.at))
        })
    };
    let placements = between(true).chain(lines).chain(between(false)).collect();
    let share =
        controls.context.as_ref().map_or(controls.mean_density(dense), |context| context.share(canvas));
    advance(progress, "curves", 2, 2)?;
    let report = SynthReport {
        curves: Some(report(&found, controls.context.is_some())),
        ..SynthReport::of_drawing(library, share, Some(drawing.covered(library, &found, params)))
    };
    Ok(Arranged::of_drawing(plan, asked.variation, placements, report))
}

/// Curves in the region of a context, in the styles of a drawing.
fn continued(
    (drawing, graph): (&LineDrawing, &CurveGraph),
    context: &DrawnContext,
    asked: &CurveParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<CurveResult> {
    let page = PeriodicPlane { size: asked.size, wraps: [false; 2] };
    let mut drawn = LineDrawing::new(&context.drawing, page, true, go_on)?;
    if drawn.exemplar.strokes.is_empty() {
        return Err(Error::Control {
            name: context.drawing.source.file.clone(),
            role: "a context",
            reason: "it contains no lines".into(),
            advice: "draw strokes or long thin shapes in it, which the texture goes on from, or leave it out",
        });
    }
    drawn.exemplar.elements.clear();
    let alike: Vec<u32> = drawn.styles.iter().map(|style| drawing.style_like(style) as u32).collect();
    drawn.exemplar.strokes.iter_mut().for_each(|stroke| stroke.style = alike[stroke.style as usize]);
    let lines = drawn.exemplar.graph(go_on)?;
    let beside = CurveContext { lines, region: context.region.clone(), source: context.source.clone() };
    let found = curves_beside(graph, &beside, asked, go_on)?;
    if found.curves.is_empty() {
        return Err(context.too_small("lines"));
    }
    Ok(found)
}

/// The counts of a result.
fn report(found: &CurveResult, has_context: bool) -> CurveReport {
    let [exemplar, made] = &found.measures;
    let per = |ends: f64| 1000.0 * ends;
    CurveReport {
        samples: found.levels.last().map_or(0, |l| l.samples[1]),
        iterations: found.levels.iter().map(|l| l.energies.len()).sum(),
        energies: found.levels.iter().map(|l| l.energies.clone()).collect(),
        paths: found.curves.len(),
        joined: found.mended.joined,
        attached: found.mended.attached,
        removed: found.mended.removed,
        ends: [per(exemplar.end_density()), per(made.end_density())],
        degree_variation: made.degree_variation(exemplar),
        continued: has_context.then_some(found.continued),
    }
}

#[cfg(test)]
mod tests {
    use crate::synth::testing::drawing_of;
    use crate::synth::{Controls, SynthReport, synthesize_with};
    use kurbo::Shape as _;
    use vtex_base::error::{Error, Result};
    use vtex_base::geometry::Outline;
    use vtex_base::raster::{ControlMap, LabelMap};
    use vtex_scene::element::Shape;
    use vtex_scene::library::{Library, SourceKind, testing};
    use vtex_scene::scene::{Ablation, Method, Scene, SynthParams, Tile};

    /// Four bands that wave across a page that repeats, filled outlines of four pixels.
    fn drawing() -> Library {
        let mut map = LabelMap::filled(160, 120, 0);
        for k in 0..4u32 {
            for x in 0..160u32 {
                let wave = 6.0 * libm::sin(f64::from(x) / 160.0 * std::f64::consts::TAU);
                let y = (15.0 + 30.0 * f64::from(k) + wave) as u32;
                (y..y + 4).for_each(|y| map.labels[(y * 160 + x) as usize] = k + 1);
            }
        }
        drawing_of(&map)
    }

    fn run(library: &Library, tile: bool, ablate: Vec<Ablation>) -> Result<(Scene, SynthReport)> {
        let params = SynthParams {
            width: 330,
            height: 250,
            seed: 2,
            method: Method::Curves,
            tile: Tile { x: tile, y: tile },
            ablate,
            ..SynthParams::default()
        };
        synthesize_with(std::slice::from_ref(library), &params, &Controls::default(), &())
    }

    #[test]
    fn filled_bands_become_strokes_that_run_on() {
        let library = drawing();
        for tile in [false, true] {
            let (scene, report) = run(&library, tile, Vec::new()).unwrap();
            scene.check().unwrap();
            assert_eq!(report.method, Method::Curves);
            let curves = report.curves.as_ref().unwrap();
            assert_eq!(curves.ends, [0.0, 0.0]);
            // Two strokes to a band at most: paths end where they bend sharply.
            assert!((8..=20).contains(&curves.paths), "{}", curves.paths);
            let off = (report.coverage / report.coverage_wanted - 1.0).abs();
            assert!(off < 0.15, "{} of {}", report.coverage, report.coverage_wanted);
            for element in &scene.elements {
                let line = element.shapes[0].line.as_ref().unwrap();
                assert!((line.width - 4.0).abs() < 0.6, "{}", line.width);
            }
        }
    }

    #[test]
    fn elements_between_the_bands_come_whole() {
        let mut map = drawing().arrangement.to_labels();
        for (k, j) in (0..3u32).flat_map(|k| (0..4u32).map(move |j| (k, j))) {
            let wave = 6.0 * libm::sin(f64::from(40 * j + 13) / 160.0 * std::f64::consts::TAU);
            let [x, y] = [40 * j + 10, (29.0 + 30.0 * f64::from(k) + wave) as u32];
            for (dx, dy) in (0..7).flat_map(|dy| (0..7).map(move |dx| (dx, dy))) {
                map.labels[((y + dy) * 160 + x + dx) as usize] = 5 + 4 * k + j;
            }
        }
        let mut library = drawing_of(&map);
        // Outlines of generated libraries go round each row of pixels.
        for element in &mut library.elements[4..] {
            let square = element.shapes[0].outline.bounds().to_path(0.1);
            element.shapes = vec![Shape::new(Outline::new(&square).unwrap(), element.colour)];
        }
        let (scene, report) = run(&library, true, Vec::new()).unwrap();
        scene.check().unwrap();
        let is_square = |number: usize| scene.elements[number].shapes[0].line.is_none();
        let instances = scene.layers.iter().flat_map(|layer| &layer.instances);
        let squares = instances.filter(|i| is_square(i.element.index())).count() as f64;
        let wanted = 12.0 * 330.0 * 250.0 / (160.0 * 120.0);
        assert!((squares / wanted - 1.0).abs() < 0.2, "{squares} of {wanted}");
        // They are those of the library, moved.
        for element in scene.elements.iter().filter(|e| e.shapes[0].line.is_none()) {
            let source = &library.elements[element.source.unwrap().index()].shapes[0];
            let [own, other] = [element.shapes[0].outline.bounds(), source.outline.bounds()];
            assert!(
                (own.width() - other.width()).abs() < 0.01 && (own.height() - other.height()).abs() < 0.01
            );
        }
        let off = (report.coverage / report.coverage_wanted - 1.0).abs();
        assert!(off < 0.15, "{} of {}", report.coverage, report.coverage_wanted);
    }

    #[test]
    fn a_map_of_densities_takes_lines_away() {
        let library = drawing();
        let covered = |density: Option<[f32; 2]>| {
            let controls = Controls {
                density: density.map(|v| ControlMap::new(2, 1, v.to_vec()).unwrap()),
                ..Controls::default()
            };
            let params =
                SynthParams { width: 330, height: 250, method: Method::Curves, ..SynthParams::default() };
            let (scene, report) =
                synthesize_with(std::slice::from_ref(&library), &params, &controls, &()).unwrap();
            scene.check().unwrap();
            report.coverage
        };
        let whole = covered(None);
        assert!((covered(Some([1.0, 1.0])) / whole - 1.0).abs() < 0.02);
        assert!((covered(Some([0.5, 0.5])) / whole - 0.5).abs() < 0.12);
        assert!((covered(Some([2.0, 2.0])) / whole - 2.0).abs() < 0.25);
        assert_eq!(covered(Some([0.0, 0.0])), 0.0);
    }

    #[test]
    fn every_level_has_a_picture() {
        #[derive(Default)]
        struct Names(std::sync::Mutex<Vec<String>>);
        impl vtex_base::progress::Progress for Names {
            fn picture(&self, name: &str, _: &dyn Fn() -> image::RgbImage) {
                self.0.lock().unwrap().push(name.into());
            }
        }
        let names = Names::default();
        let params =
            SynthParams { width: 330, height: 250, method: Method::Curves, ..SynthParams::default() };
        let made = synthesize_with(&[drawing()], &params, &Controls::default(), &names).unwrap();
        let levels = made.1.curves.unwrap().energies.len();
        let seen = names.0.into_inner().unwrap();
        assert!(levels > 0 && (1..=levels).all(|k| seen.contains(&format!("graph-{k}"))), "{seen:?}");
    }

    #[test]
    fn parts_can_be_left_out() {
        let library = drawing();
        let parts = vec![Ablation::Patches, Ablation::Mend];
        let (scene, report) = run(&library, true, parts).unwrap();
        scene.check().unwrap();
        let curves = report.curves.unwrap();
        assert!(curves.joined + curves.attached + curves.removed == 0);
        assert!(curves.iterations > 2);
    }

    #[test]
    fn what_it_is_not_for_is_refused() {
        let refused = |library: &Library| {
            matches!(run(library, false, Vec::new()), Err(Error::Parameter { name: "method", .. }))
        };
        let mut photograph = drawing();
        photograph.source.kind = SourceKind::Photograph;
        assert!(refused(&photograph));
        let mut map = LabelMap::filled(100, 100, 0);
        for (x, y) in (10..40).flat_map(|y| (10..40).map(move |x| (x, y))) {
            map.labels[(y * 100 + x) as usize] = 1;
        }
        let mut blocks = testing::library(&map);
        blocks.source.kind = SourceKind::Drawing;
        assert!(refused(&blocks));
    }
}
