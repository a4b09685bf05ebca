//! Drawings of cells made anew: cells come whole, and fit where they meet others ([`vtex_curves::quilted_cells`]).

use super::cell_drawing::CellDrawing;
use super::compose::{Placement, What, compose_drawing};
use super::line_drawing::is_line;
use super::report::{CategoryReport, SynthReport};
use crate::arrange::controls::Controls;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, BezPath, Curve, Outline, PathEl, Point, Rect, ring_path, rounded};
use vtex_base::progress::{Progress, advance};
use vtex_curves::{CellParams, QuiltedCell, quilted_cells};
use vtex_scene::element::{ElementId, Line, Shape};
use vtex_scene::library::Library;
use vtex_scene::scene::{Element, LibraryId, Scene, SynthParams};

/// Least share of the bounds of a cell that a stroke along its outline has.
const ALONG: f64 = 0.8;

/// A texture of the cells of a drawing.
///
/// # Errors
/// As [`quilted_cells`], and those of `progress`.
pub(super) fn cell_texture(
    library: &Library,
    drawing: &CellDrawing,
    (params, controls): (&SynthParams, &Controls),
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let go_on = || advance(progress, "curves", 0, 2);
    let asked = CellParams {
        size: [params.width, params.height].map(f64::from),
        tile: [params.tile.x, params.tile.y],
        seed: params.seed,
        variation: params.variation.unwrap_or(1.0),
    };
    let found = quilted_cells(&drawing.exemplar, &asked, &go_on)?;
    advance(progress, "curves", 1, 2)?;
    let cells: Vec<FittedCell> =
        found.iter().filter_map(|cell| FittedCell::new(library, drawing, cell)).collect();
    let placements = cells.iter().map(|cell| Placement {
        what: match &cell.made {
            Some(element) => What::Made(element),
            None => What::Known(LibraryId(0), cell.source, None),
        },
        transform: cell.transform,
        layer: cell.layer,
        motif: None,
    });
    let params = SynthParams { variation: Some(asked.variation), ..params.clone() };
    let scene = compose_drawing(library, &params, controls, placements);
    let mut areas = vec![0.0; library.categories.len()];
    for cell in &cells {
        if let Some(category) = library.primaries()[cell.source.index()].category {
            areas[category.index()] += cell.area;
        }
    }
    let canvas = asked.size[0] * asked.size[1];
    let categories = CategoryReport::of(library, areas.into_iter().map(|made| (made / canvas).min(1.0)));
    advance(progress, "curves", 2, 2)?;
    let libraries = std::slice::from_ref(library);
    let report = SynthReport {
        coverage_wanted: library.coverage,
        ..SynthReport::of_scene(libraries, &scene, categories)
    };
    Ok((scene, report))
}

/// A cell as an element at its place.
struct FittedCell {
    source: ElementId,
    /// The element if it is not the library's.
    made: Option<Element>,
    transform: [f64; 6],
    layer: usize,
    area: f64,
}

impl FittedCell {
    fn new(library: &Library, drawing: &CellDrawing, cell: &QuiltedCell) -> Option<Self> {
        let ([layer, instance, number], is_all) = drawing.sources[cell.cell as usize];
        let instance = &library.layers[layer].instances[instance];
        let element = &library.primaries()[instance.element.index()];
        let drawn = Affine::new(instance.transform);
        let (source, area) = (instance.element, cell.shown_area);
        if cell.path.is_none() && is_all {
            // Elements of scenes have their own place at the origin.
            let [x, y] = element.origin().map(f64::from);
            let transform = rounded(cell.map * drawn * Affine::translate((x, y)));
            return Some(Self { source, made: None, transform, layer, area });
        }
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
        let map = Affine::translate(-at.to_vec2()) * cell.map * drawn;
        let whole = element.shapes[number].outline.bounds();
        let mut shapes = Vec::with_capacity(element.shapes.len());
        for (k, shape) in element.shapes.iter().enumerate() {
            let along = shape.line.as_ref().filter(|line| is_along(line, whole));
            if k == number {
                shapes.push(shape.moved(map).with_outline(outline.clone()));
            } else if let Some(line) = along {
                let line = Line { path: Curve::new(path.clone())?, ..(**line).clone() };
                shapes.extend(
                    Shape::stroked(line, shape.colour).map(|s| Shape { opacity: shape.opacity, ..s }),
                );
            } else if is_all && !is_line(shape) {
                shapes.push(shape.moved(map));
            }
        }
        let category = element.category;
        let made = Element {
            library: LibraryId(0),
            source: Some(source),
            category,
            fused: true,
            silhouette: None,
            shapes,
        };
        let transform = Affine::translate(at.to_vec2()).as_coeffs();
        Some(Self { source, made: Some(made), transform, layer, area })
    }
}

/// Whether a stroke runs along an outline of the given bounds.
fn is_along(line: &Line, outline: Rect) -> bool {
    let bounds = kurbo::Shape::bounding_box(line.path.path());
    bounds.width() >= ALONG * outline.width() && bounds.height() >= ALONG * outline.height()
}

#[cfg(test)]
mod tests {
    use crate::synth::testing::drawing_of;
    use crate::synth::{Controls, SynthReport, synthesize_with};
    use vtex_base::error::Error;
    use vtex_base::geometry::Outline;
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
