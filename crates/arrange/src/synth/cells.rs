//! Drawings of cells made anew: cells come whole, and fit where they meet others ([`vtex_curves::quilted_cells`]).

use super::cell_drawing::CellDrawing;
use super::compose::{Arranged, Placement, What};
use super::line_drawing::is_line;
use super::report::SynthReport;
use crate::arrange::Plan;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, BezPath, Curve, Outline, PathEl, Point, Rect, ring_path, rounded};
use vtex_base::progress::{Progress, advance};
use vtex_curves::{CellParams, QuiltedCell, quilted_cells};
use vtex_scene::element::{Line, Shape};
use vtex_scene::library::{ExemplarElement, ExemplarInstance};
use vtex_scene::scene::{Element, LibraryId};

/// Least share of the bounds of a cell that a stroke along its outline has.
const ALONG: f64 = 0.8;

/// A texture of the cells of a drawing.
///
/// # Errors
/// As [`quilted_cells`], and those of `progress`.
pub(super) fn cell_texture(
    plan: &Plan<'_>,
    drawing: &CellDrawing,
    progress: &dyn Progress,
) -> Result<Arranged<'static>> {
    let (library, params) = (&plan.libraries[0], &plan.params);
    let go_on = || advance(progress, "curves", 0, 2);
    let asked = CellParams {
        size: [params.width, params.height].map(f64::from),
        tile: [params.tile.x, params.tile.y],
        seed: params.seed,
        variation: params.variation.unwrap_or(1.0),
    };
    let found = quilted_cells(&drawing.exemplar, &asked, &go_on)?;
    advance(progress, "curves", 1, 2)?;
    let mut areas = vec![0.0; library.categories.len()];
    let mut placements = Vec::with_capacity(found.len());
    for cell in &found {
        let ([layer, instance, number], is_all) = drawing.sources[cell.cell as usize];
        let instance = &library.layers[layer].instances[instance];
        let element = &library.primaries()[instance.element.index()];
        let fitted = if cell.path.is_none() && is_all {
            // Elements of scenes have their own place at the origin.
            let [x, y] = element.origin().map(f64::from);
            let map = cell.map * Affine::new(instance.transform) * Affine::translate((x, y));
            Some((What::Known(LibraryId(0), instance.element, None), rounded(map)))
        } else {
            made(element, instance, (number, is_all), (drawing, cell))
        };
        let Some((what, transform)) = fitted else { continue };
        if let Some(category) = element.category {
            areas[category.index()] += cell.shown_area;
        }
        placements.push(Placement { what, transform, layer, motif: None, height: 0 });
    }
    let canvas = asked.size[0] * asked.size[1];
    let covered = areas.into_iter().map(|made| (made / canvas).min(1.0)).collect();
    advance(progress, "curves", 2, 2)?;
    let report = SynthReport::of_drawing(library, 1.0, Some(covered));
    Ok(Arranged::of_drawing(plan, asked.variation, placements, report))
}

/// A cell as an element made for it, and its place: shape `number` of an element, and what goes with that; `is_all`:
/// the cell is all of the shape.
fn made(
    element: &ExemplarElement,
    instance: &ExemplarInstance,
    (number, is_all): (usize, bool),
    (drawing, cell): (&CellDrawing, &QuiltedCell),
) -> Option<(What<'static>, [f64; 6])> {
    let path = match &cell.path {
        Some(path) => path.clone(),
        None => {
            let rings = &drawing.exemplar.cells[cell.cell as usize].rings;
            cell.map * rings.iter().flat_map(|ring| ring_path(ring)).collect::<BezPath>()
        }
    };
    let first = path.elements().first().and_then(PathEl::end_point)?;
    let at = Point::new(libm::round(first.x), libm::round(first.y));
    let path = Affine::translate(-at.to_vec2()) * path;
    let outline = Outline::new(&path)?;
    let map = Affine::translate(-at.to_vec2()) * cell.map * Affine::new(instance.transform);
    let whole = element.shapes[number].outline.bounds();
    let mut shapes = Vec::with_capacity(element.shapes.len());
    for (k, shape) in element.shapes.iter().enumerate() {
        let along = shape.line.as_ref().filter(|line| is_along(line, whole));
        if k == number {
            shapes.push(shape.moved(map).with_outline(outline.clone()));
        } else if let Some(line) = along {
            let line = Line { path: Curve::new(path.clone())?, ..(**line).clone() };
            shapes.extend(Shape::stroked(line, shape.colour).map(|s| Shape { opacity: shape.opacity, ..s }));
        } else if is_all && !is_line(shape) {
            shapes.push(shape.moved(map));
        }
    }
    let made = Element {
        library: LibraryId(0),
        source: Some(instance.element),
        category: element.category,
        fused: true,
        silhouette: None,
        shapes,
    };
    Some((What::Made(Box::new(made)), Affine::translate(at.to_vec2()).as_coeffs()))
}

/// Whether a stroke runs along an outline of the given bounds.
fn is_along(line: &Line, outline: Rect) -> bool {
    let bounds = kurbo::Shape::bounding_box(line.path.path());
    bounds.width() >= ALONG * outline.width() && bounds.height() >= ALONG * outline.height()
}

#[cfg(test)]
mod tests {
    use super::{CellDrawing, Progress};
    use crate::synth::testing::drawing_of;
    use crate::synth::{Controls, SynthReport, synthesize_with};
    use std::sync::atomic::{AtomicUsize, Ordering};
    use vtex_base::error::Error;
    use vtex_base::geometry::Outline;
    use vtex_base::geometry::plane::PeriodicPlane;
    use vtex_base::raster::{ControlMap, LabelMap};
    use vtex_scene::element::Shape;
    use vtex_scene::library::Library;
    use vtex_scene::scene::{Method, Scene, SynthParams, Tile};

    /// Slabs with joints of four pixels on a page that repeats: four columns, each divided elsewhere.
    fn slabs() -> Library {
        let mut map = LabelMap::filled(160, 120, 0);
        let (mut left, mut label) = (0, 0);
        for k in 0..4 {
            let mut top = 0;
            for height in [[40, 44, 36], [52, 30, 38], [34, 46, 40], [42, 28, 50]][k] {
                label += 1;
                for (dx, dy) in (2..height - 2).flat_map(|dy| (2..38).map(move |dx| (dx, dy))) {
                    map.labels[((top + dy) * 160 + left + dx) as usize] = label;
                }
                top += height;
            }
            left += 40;
        }
        drawing_of(&map)
    }

    /// Outlines of generated libraries go round each row of pixels: these are rectangles.
    fn rectangles(mut library: Library) -> Library {
        for element in &mut library.elements {
            let path = kurbo::Shape::to_path(&element.shapes[0].outline.bounds(), 0.1);
            element.shapes = vec![Shape::new(Outline::new(&path).unwrap(), element.colour)];
        }
        library
    }

    fn run(library: &Library, method: Method, controls: &Controls) -> Result<(Scene, SynthReport), Error> {
        let params = SynthParams {
            width: 330,
            height: 250,
            seed: 2,
            method,
            tile: Tile { x: true, y: true },
            ..SynthParams::default()
        };
        synthesize_with(std::slice::from_ref(library), &params, controls, &())
    }

    #[test]
    fn slabs_fill_a_tile_with_even_joints() {
        let library = rectangles(slabs());
        let (scene, report) = run(&library, Method::Curves, &Controls::default()).unwrap();
        scene.check().unwrap();
        assert_eq!(report.method, Method::Curves);
        let off = (report.coverage / report.coverage_wanted - 1.0).abs();
        assert!(off < 0.06, "{} of {}", report.coverage, report.coverage_wanted);
        let shown: f64 = report.categories.iter().map(|c| c.got).sum();
        assert!((shown / report.coverage - 1.0).abs() < 0.06, "{shown} and {}", report.coverage);
        // Each is of an element of the drawing, in its colour.
        for element in &scene.elements {
            let source = &library.elements[element.source.unwrap().index()];
            assert_eq!((element.category, element.shapes[0].colour), (source.category, source.colour));
        }
        let density = ControlMap::new(1, 1, vec![1.0]).unwrap();
        let refused =
            run(&library, Method::Curves, &Controls { density: Some(density), ..Controls::default() });
        assert!(matches!(refused, Err(Error::Parameter { name: "method", .. })), "{refused:?}");
    }

    /// Counts reports of the stage in which a drawing is looked at, and asks to stop after `most` of them.
    struct Looks {
        most: usize,
        seen: AtomicUsize,
    }

    impl Progress for Looks {
        fn advance(&self, stage: &'static str, _: u64, _: u64) -> bool {
            stage != "primaries" || self.seen.fetch_add(1, Ordering::Relaxed) < self.most
        }
    }

    #[test]
    fn the_page_is_looked_at_once_and_that_can_be_stopped() {
        let library = rectangles(slabs());
        let asked = std::cell::Cell::new(0);
        let go_on = || {
            asked.set(asked.get() + 1);
            Ok(())
        };
        let page = PeriodicPlane { size: [160.0, 120.0], wraps: [true; 2] };
        assert!(CellDrawing::of(&library, page, &go_on).unwrap().is_some());
        let params =
            SynthParams { width: 330, height: 250, method: Method::Curves, ..SynthParams::default() };
        for most in [0, asked.get() / 2, usize::MAX] {
            let looks = Looks { most, seen: AtomicUsize::new(0) };
            let made = synthesize_with(std::slice::from_ref(&library), &params, &Controls::default(), &looks);
            assert_eq!(matches!(made, Err(Error::Interrupted)), most < usize::MAX, "{most}");
            assert_eq!(looks.seen.into_inner(), asked.get().min(most.saturating_add(1)));
        }
    }

    #[test]
    fn slabs_far_from_one_another_are_no_cells() {
        let mut map = LabelMap::filled(160, 120, 0);
        for (x, y) in
            (0..120).flat_map(|y| (0..160).map(move |x| (x, y))).filter(|(x, y)| x % 40 < 22 && y % 40 < 22)
        {
            map.labels[(y * 160 + x) as usize] = 1 + x / 40 + 4 * (y / 40);
        }
        let library = rectangles(drawing_of(&map));
        let refused = run(&library, Method::Curves, &Controls::default());
        assert!(matches!(refused, Err(Error::Parameter { name: "method", .. })), "{refused:?}");
    }
}
