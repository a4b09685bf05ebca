//! Drawings of lines that run on, made anew as curves ([`vtex_curves`]).
//!
//! Stroked paths are taken as they are. Filled outlines that are long and thin, and strokes that the border of a page
//! has cut, are painted into cells, whose centre lines are the strokes.

use super::compose::{Placement, What, compose_drawing};
use super::report::{CategoryReport, CurveReport, SynthReport};
use super::samples_picture::graph_picture;
use super::single_drawing::{refusal, single_drawing};
use crate::arrange::controls::Controls;
use vtex_base::error::Result;
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::geometry::{Affine, Curve, PathEl, Point};
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::Colour;
use vtex_curves::{
    CurveExemplar, CurveParams, CurveParts, CurveResult, CurveStroke, Ink, TracedCurve, centre_lines, curves,
};
use vtex_scene::element::{Cap, CategoryId, ElementId, Join, Line, Shape};
use vtex_scene::library::Library;
use vtex_scene::scene::{Ablation, Element, LibraryId, Scene, SynthParams, pixels};

/// Least ratio of length to width of a filled outline that is a line.
const THIN: f64 = 5.0;
/// Largest share of the area of all shapes that may be no lines.
const STRAY: f64 = 0.02;
/// Cells across the thinnest painted line, and most cells of a page.
const CELLS: f64 = 20.0;
const MOST_CELLS: f64 = 6e6;
/// Weld and tolerance of curves, in widths of the thinnest line.
const WELD: f64 = 0.25;
const TOLERANCE: f64 = 0.04;
/// The method, and what it is for.
const METHOD: &str = "curves";
const LINES: &str = "for a drawing of lines: strokes, or filled shapes that are long and thin";
/// Largest deviation of a stroked path from its points, in widths.
const FLAT: f64 = 0.02;

/// Whether a library can be made anew: one drawing of lines, without a control that this method does not follow.
///
/// # Errors
/// [`Error::Parameter`] that says what prevents it.
pub(super) fn check(libraries: &[Library], params: &SynthParams, controls: &Controls) -> Result<()> {
    let library = single_drawing(libraries, params, controls).map_err(|allowed| refusal(METHOD, allowed))?;
    let (mut lines, mut others) = (0.0, 0.0);
    for shape in library.primaries().iter().flat_map(|e| &e.shapes) {
        *(if is_line(shape) { &mut lines } else { &mut others }) += shape.area();
    }
    if lines == 0.0 || others > STRAY * (lines + others) {
        return Err(refusal(METHOD, LINES));
    }
    Ok(())
}

/// Whether a shape is a stroke or looks like one.
fn is_line(shape: &Shape) -> bool {
    shape.line.is_some()
        || !shape.is_soft() && proportion(shape).is_some_and(|(width, ratio)| width > 0.0 && ratio > THIN)
}

/// Width of a thin outline, and the ratio of its length to it.
fn proportion(shape: &Shape) -> Option<(f64, f64)> {
    let (area, compactness) = (shape.outline.area(), shape.outline.compactness());
    let perimeter = libm::sqrt(4.0 * std::f64::consts::PI * area / compactness.max(1e-9));
    // Of a rectangle: area = width · length, half the perimeter = width + length.
    let half = 0.5 * perimeter;
    let root = half * half - 4.0 * area;
    (area > 0.0 && root >= 0.0).then(|| {
        let width = 0.5 * (half - libm::sqrt(root));
        (width, (half - width) / width.max(1e-9))
    })
}

/// A texture of curves, and how close it came.
///
/// # Errors
/// As [`curves`], and those of `progress`.
pub(super) fn synthesize(
    library: &Library,
    params: &SynthParams,
    controls: &Controls,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let go_on = || advance(progress, "curves", 0, 2);
    go_on()?;
    let periodic = library.arrangement.periodic;
    let mut drawing = LineDrawing::new(library, periodic, &go_on)?;
    let mut graph = drawing.exemplar.graph(&go_on)?;
    if periodic && !drawing.exemplar.is_seamless(&graph) {
        drawing = LineDrawing::new(library, false, &go_on)?;
        graph = drawing.exemplar.graph(&go_on)?;
    }
    let asked = CurveParams {
        size: [params.width, params.height].map(f64::from),
        tile: [params.tile.x, params.tile.y],
        seed: params.seed,
        variation: params.variation.unwrap_or(1.0),
        tolerance: TOLERANCE * drawing.thinnest,
        without: CurveParts {
            no_edge: params.without(Ablation::Edge),
            no_robust: params.without(Ablation::Robust),
            no_orientation: params.without(Ablation::Orientation),
            no_existence: params.without(Ablation::Existence),
            no_patches: params.without(Ablation::Patches),
            no_mend: params.without(Ablation::Mend),
        },
    };
    let mut found = curves(&graph, &asked, &go_on)?;
    if found.curves.is_empty() {
        return Err(refusal(METHOD, LINES));
    }
    advance(progress, "curves", 1, 2)?;
    for (number, level) in found.levels.iter().enumerate() {
        progress.picture(&format!("graph-{}", number + 1), &|| {
            graph_picture(level, [params.width, params.height])
        });
    }
    found.curves.sort_by_key(|c| (drawing.styles[c.style as usize].layer, c.style));
    let elements: Vec<(Element, Point, usize)> =
        found.curves.iter().filter_map(|curve| drawing.element(curve)).collect();
    let params = SynthParams { variation: Some(asked.variation), ..params.clone() };
    let placements = elements.iter().map(|(element, at, layer)| Placement {
        what: What::Made(element),
        transform: Affine::translate(at.to_vec2()).as_coeffs(),
        layer: *layer,
    });
    let scene = compose_drawing(library, &params, controls, placements);
    let categories = drawing.covered(library, &found, &params);
    advance(progress, "curves", 2, 2)?;
    let report = SynthReport {
        coverage_wanted: library.coverage,
        curves: Some(report(&found)),
        ..SynthReport::of_scene(std::slice::from_ref(library), &scene, categories)
    };
    Ok((scene, report))
}

/// The counts of a result.
fn report(found: &CurveResult) -> CurveReport {
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
    }
}

/// The appearance of a stroke.
#[derive(Clone, Debug, PartialEq)]
struct LineStyle {
    /// A line without path.
    line: Line,
    colour: Colour,
    opacity: f64,
    layer: usize,
    /// The first element that has it, and its category.
    element: usize,
    category: Option<CategoryId>,
    /// Whether its width is found by thinning.
    is_painted: bool,
}

/// A drawing as strokes.
struct LineDrawing {
    exemplar: CurveExemplar,
    styles: Vec<LineStyle>,
    /// Width of the thinnest line.
    thinnest: f64,
}

impl LineDrawing {
    fn new(library: &Library, periodic: bool, go_on: &dyn Fn() -> Result<()>) -> Result<Self> {
        let size = [library.source.width, library.source.height].map(f64::from);
        let page = PeriodicPlane { size, wraps: [periodic; 2] };
        let (mut styles, mut strokes): (Vec<LineStyle>, Vec<CurveStroke>) = (Vec::new(), Vec::new());
        // The outlines of each style that are painted.
        let mut painted: Vec<(u32, Vec<Shape>)> = Vec::new();
        let mut thinnest = f64::INFINITY;
        for (layer, own) in library.layers.iter().enumerate() {
            for instance in &own.instances {
                go_on()?;
                let number = instance.element.index();
                let Some(element) = library.primaries().get(number) else { continue };
                for shape in element.shapes.iter().filter(|s| is_line(s)) {
                    let shape = shape.moved(Affine::new(instance.transform));
                    let line = match &shape.line {
                        Some(line) => Line { path: Curve::default(), ..(**line).clone() },
                        None => Line {
                            cap: Cap::Round,
                            join: Join::Round,
                            ..Line::new(Curve::default(), proportion(&shape).map_or(1.0, |p| p.0))
                        },
                    };
                    thinnest = thinnest.min(line.width);
                    let fresh = LineStyle {
                        line,
                        colour: shape.colour,
                        opacity: shape.opacity,
                        layer,
                        element: number,
                        category: element.category,
                        is_painted: shape.line.is_none(),
                    };
                    let known = styles.iter().position(|s| s.is_like(&fresh));
                    let style = known.unwrap_or(styles.len());
                    match &shape.line {
                        Some(line) => strokes.extend(of_path(line, style as u32)),
                        None => match painted.iter_mut().find(|p| p.0 == style as u32) {
                            Some(shapes) => shapes.1.push(shape.clone()),
                            None => painted.push((style as u32, vec![shape.clone()])),
                        },
                    }
                    if known.is_none() {
                        styles.push(fresh);
                    }
                }
            }
        }
        for (style, shapes) in painted {
            let (lines, width) = thinned(&shapes, page, thinnest, go_on)?;
            styles[style as usize].line.width = width.max(1e-3);
            let stroke = |(points, closed)| CurveStroke { points, closed, style };
            strokes.extend(lines.into_iter().map(stroke));
        }
        let thinnest = styles.iter().map(|s| s.line.width).fold(f64::INFINITY, f64::min);
        Ok(Self { exemplar: CurveExemplar { page, strokes, weld: WELD * thinnest }, styles, thinnest })
    }

    /// A curve as an element, its place and its layer.
    fn element(&self, curve: &TracedCurve) -> Option<(Element, Point, usize)> {
        let style = &self.styles[curve.style as usize];
        let first = curve.path.elements().first().and_then(PathEl::end_point)?;
        let at = Point::new(libm::round(first.x), libm::round(first.y));
        let path = Curve::new(Affine::translate(-at.to_vec2()) * curve.path.clone())?;
        let shape = Shape::stroked(Line { path, ..style.line.clone() }, style.colour)?;
        if shape.outline.is_empty() {
            return None;
        }
        let element = Element {
            library: LibraryId(0),
            source: Some(ElementId::after(style.element)),
            category: style.category,
            fused: true,
            silhouette: None,
            shapes: vec![Shape { opacity: style.opacity, ..shape }],
        };
        Some((element, at, style.layer))
    }

    /// Share of the canvas that the lines of each category cover: their lengths times their widths, as against the
    /// exemplar's.
    fn covered(&self, library: &Library, found: &CurveResult, params: &SynthParams) -> Vec<CategoryReport> {
        let areas = |lengths: &mut dyn Iterator<Item = (u32, f64)>| {
            let mut sums = vec![0.0; library.categories.len()];
            for (style, length) in lengths {
                let style = &self.styles[style as usize];
                if let Some(category) = style.category {
                    sums[category.index()] += length * style.line.width;
                }
            }
            sums
        };
        let canvas = f64::from(params.width) * f64::from(params.height);
        let made = areas(&mut found.curves.iter().map(|c| (c.style, c.shown_length)));
        CategoryReport::of(library, made.into_iter().map(|made| (made / canvas).min(1.0)))
    }
}

impl LineStyle {
    /// Whether lines of the two styles look the same. The width of painted ones is found later.
    fn is_like(&self, other: &Self) -> bool {
        let line =
            |s: &Self| if s.is_painted { Line { width: 1.0, ..s.line.clone() } } else { s.line.clone() };
        self.is_painted == other.is_painted
            && (self.colour, self.layer, self.category) == (other.colour, other.layer, other.category)
            && self.opacity == other.opacity
            && line(self) == line(other)
    }
}

/// The pieces of a stroked path.
fn of_path(line: &Line, style: u32) -> Vec<CurveStroke> {
    let mut strokes: Vec<CurveStroke> = Vec::new();
    kurbo::flatten(line.path.path().iter(), FLAT * line.width, |element| match element {
        PathEl::MoveTo(p) => strokes.push(CurveStroke { points: vec![[p.x, p.y]], closed: false, style }),
        PathEl::ClosePath => {
            if let Some(stroke) = strokes.last_mut() {
                stroke.closed = true;
            }
        }
        element => {
            if let (Some(stroke), Some(p)) = (strokes.last_mut(), element.end_point()) {
                stroke.points.push([p.x, p.y]);
            }
        }
    });
    strokes.retain(|s| s.points.len() > 1);
    strokes
}

/// Lines through their points, and whether they are closed.
type ThinLines = Vec<(Vec<[f64; 2]>, bool)>;

/// The centre lines of outlines, and their mean width.
fn thinned(
    shapes: &[Shape],
    page: PeriodicPlane,
    thinnest: f64,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(ThinLines, f64)> {
    let most = libm::sqrt(MOST_CELLS / page.area());
    let fine = (CELLS / thinnest.max(1e-6)).min(most);
    // Whole cells on a page that repeats; a page that does not has a rim, over which lines lead.
    let rim = page.wraps.map(|w| if w { 0 } else { 4 * CELLS as i32 });
    let count = page.size.map(|s| libm::round(s * fine).max(3.0));
    let by = [count[0] / page.size[0], count[1] / page.size[1]];
    let size = [0, 1].map(|k| count[k] as usize + 2 * rim[k] as usize);
    let mut ink = Ink { size, wraps: page.wraps, cells: vec![false; size[0] * size[1]] };
    let scale = Affine::scale_non_uniform(by[0], by[1]);
    for shape in shapes {
        go_on()?;
        for span in pixels::mask(&shape.outline.moved(scale)).spans() {
            let place = |v: i32, k: usize| {
                let v = v + rim[k];
                if page.wraps[k] {
                    Some(v.rem_euclid(size[k] as i32))
                } else {
                    (0..size[k] as i32).contains(&v).then_some(v)
                }
            };
            let Some(row) = place(span.y, 1) else { continue };
            for x in span.x0..span.x1 {
                if let Some(column) = place(x, 0) {
                    ink.cells[row as usize * size[0] + column as usize] = true;
                }
            }
        }
    }
    extend(&mut ink, rim.map(|r| r as usize));
    let (lines, width) = centre_lines(&ink, go_on)?;
    let back = |p: [f64; 2]| [0, 1].map(|k| (p[k] - f64::from(rim[k])) / by[k]);
    let lines = lines.into_iter().map(|(points, closed)| (points.into_iter().map(back).collect(), closed));
    Ok((lines.collect(), width / libm::sqrt(by[0] * by[1])))
}

/// Leads what reaches the border of the page over its rim, so that thinning does not shorten it.
fn extend(ink: &mut Ink, rim: [usize; 2]) {
    let size = ink.size;
    let inner = |v: usize, k: usize| if rim[k] == 0 { v } else { v.clamp(rim[k] + 1, size[k] - rim[k] - 2) };
    for y in 0..size[1] {
        for x in 0..size[0] {
            let from = inner(y, 1) * size[0] + inner(x, 0);
            ink.cells[y * size[0] + x] = ink.cells[from];
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::synth::{Controls, SynthReport, synthesize_with};
    use vtex_base::error::{Error, Result};
    use vtex_base::raster::LabelMap;
    use vtex_scene::library::{Library, Role, SourceKind, testing};
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
        let mut library = testing::library(&map);
        let count = library.primaries().len();
        library.elements.truncate(count);
        library.layers.retain(|l| l.role != Role::Secondary);
        library.source.kind = SourceKind::Drawing;
        library.arrangement.periodic = true;
        library
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
