//! SVG → outline: the union of the shapes in a file.
//!
//! Shapes that do not cross each other keep their curves. The union of others is traced from pixels, four
//! to a pixel of the canvas along each side.
//!
//! Works badly with indirectly drawn shapes: text, bitmaps, clip paths and masks are not supported.

use crate::svg_tree;
use kurbo::{ParamCurve, Shape};
use resvg::usvg;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::{
    Affine, BezPath, FittedMap, Interior, Outline, PathEl, PlanarMap, Point, is_simple,
};

/// Largest number of segments of a shape. More take minutes to check for crossings.
const MOST_SEGMENTS: usize = 20_000;

/// Most samples along a side of the canvas, and most for a pixel, where a union is traced.
const MOST_SAMPLES: u32 = 4096;
const FINEST: u32 = 4;
/// Fit tolerance of a traced union, in samples.
const TOLERANCE: f64 = 0.5;

/// Reads the shapes in an SVG as one, the union of all that are filled, fitted to a canvas of `width` ×
/// `height` pixels: the SVG's page is scaled uniformly to the largest size that fits, and centred. A drawing
/// without fills may hold one stroked shape, which stands for the area that it encloses. `name` appears in
/// errors.
///
/// # Errors
/// [`Error::Control`] unless the file holds visible paths, rectangles, circles, ellipses or polygons, whose
/// rings are all closed, of which none crosses itself, and which enclose part of the canvas;
/// [`Error::TooLarge`] beyond 20000 segments.
pub fn shape(bytes: &[u8], name: &str, [width, height]: [u32; 2]) -> Result<Outline> {
    let reader = ShapeReader { name, role: "a shape" };
    let FileShapes { paths, size } = reader.read(bytes)?;
    let canvas = [width, height];
    let [width, height] = canvas.map(f64::from);
    let scale = (width / size[0]).min(height / size[1]);
    let margin = ((width - scale * size[0]) / 2.0, (height - scale * size[1]) / 2.0);
    let fitted = Affine::translate(margin) * Affine::scale(scale);
    let one = |(path, rule): (BezPath, Rule)| {
        let outline = reader.outline(&(fitted * path))?;
        Ok(Outline::new(&filled(outline.path(), rule)).unwrap_or_default())
    };
    let shapes = paths.into_iter().map(one).collect::<Result<Vec<Outline>>>()?;
    let outline = union(shapes, canvas);
    let bounds = outline.bounds();
    if outline.is_empty() || outline.area() < 1.0 {
        let advice = "it must be at least some pixels large on the canvas";
        return Err(reader.fail("it encloses no area", advice));
    }
    if bounds.x1 <= 0.0 || bounds.y1 <= 0.0 || bounds.x0 >= width || bounds.y0 >= height {
        let advice = "move it into the page of the drawing, or fit the page to it";
        return Err(reader.fail("it lies outside the canvas of its SVG", advice));
    }
    Ok(outline)
}

/// The union of shapes; if shapes cross each other, clipped to the canvas.
fn union(mut shapes: Vec<Outline>, [width, height]: [u32; 2]) -> Outline {
    if shapes.len() == 1 {
        return shapes.swap_remove(0);
    }
    let all: BezPath = shapes.iter().flat_map(|shape| shape.path()).collect();
    if is_simple(&all) {
        return Outline::new(&filled(&all, Rule::NonZero)).unwrap_or_default();
    }
    let fine = (MOST_SAMPLES / width.max(height)).clamp(1, FINEST);
    let [across, down] = [width, height].map(|side| (side * fine).min(MOST_SAMPLES));
    let step = [f64::from(width) / f64::from(across), f64::from(height) / f64::from(down)];
    let mut labels = vec![0u32; across as usize * down as usize];
    for region in shapes.iter().filter(|shape| !shape.is_empty()).map(Interior::new) {
        for (y, row) in labels.chunks_exact_mut(across as usize).enumerate() {
            for [a, b] in region.intervals((y as f64 + 0.5) * step[1]) {
                // The samples whose centres lie inside.
                let first = |x: f64| libm::ceil(x / step[0] - 0.5).clamp(0.0, f64::from(across)) as usize;
                row[first(a)..first(b).max(first(a))].fill(1);
            }
        }
    }
    let planar = PlanarMap::trace(across, down, &labels);
    drop(labels);
    let traced = FittedMap::new(planar, TOLERANCE, 1, 1, |label| label).outlines(1, |label| label).pop();
    let stretch = Affine::scale_non_uniform(step[0], step[1]);
    traced.map_or_else(Outline::default, |outline| outline.moved(stretch))
}

/// Reads a cage from an SVG: the single ring as drawn, in the SVG's pixels, with its direction and
/// its order of points. Also returns the width and height of the SVG's page, in pixels. `name`
/// appears in errors.
///
/// # Errors
/// As [`shape`]; also [`Error::Control`] for more than one ring.
pub fn cage(bytes: &[u8], name: &str) -> Result<(Outline, [u32; 2])> {
    let reader = ShapeReader { name, role: "a cage" };
    let FileShapes { paths, size } = reader.read(bytes)?;
    let [(path, _)] = &paths[..] else {
        const JOIN: &str = "join what belongs together into one path and delete the rest";
        return Err(reader.fail(format!("it contains {} shapes, one is needed", paths.len()), JOIN));
    };
    let outline = reader.outline(path)?;
    match rings(outline.path()).count() {
        1 if outline.area() >= 1.0 => Ok((outline, size.map(|v| libm::round(v).max(1.0) as u32))),
        1 => Err(reader.fail("it encloses no area", "it must be at least some pixels large")),
        n => Err(reader.fail(format!("it has {n} rings"), "a cage is one ring, without holes or islands")),
    }
}

/// The shapes in a file.
struct FileShapes {
    /// Each shape with its fill rule; at least one.
    paths: Vec<(BezPath, Rule)>,
    /// Width and height of the SVG's page, in its pixels.
    size: [f64; 2],
}

/// The fill rule.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rule {
    NonZero,
    EvenOdd,
}

/// Reads a file; `name` and `role` appear in errors.
struct ShapeReader<'a> {
    name: &'a str,
    role: &'static str,
}

impl ShapeReader<'_> {
    fn fail(&self, reason: impl Into<String>, advice: &'static str) -> Error {
        Error::Control { name: self.name.into(), role: self.role, reason: reason.into(), advice }
    }

    fn read(&self, bytes: &[u8]) -> Result<FileShapes> {
        let tree = svg_tree::parse(bytes, self.name, |fault| self.fail(fault.reason, fault.advice))?;
        let (mut found, mut cut) = (Vec::new(), false);
        let mut open = vec![(tree.root(), Affine::IDENTITY)];
        while let Some((group, map)) = open.pop() {
            let map = svg_tree::within(map, group);
            cut |= group.clip_path().is_some() || group.mask().is_some();
            for node in group.children() {
                match node {
                    usvg::Node::Group(inner) => open.push((inner, map)),
                    usvg::Node::Path(path) if path.is_visible() => found.push((&**path, map)),
                    _ => {}
                }
            }
        }
        // Shapes are found in any order; the union does not depend on it.
        if found.iter().any(|(path, _)| path.fill().is_some()) {
            found.retain(|(path, _)| path.fill().is_some());
        }
        if found.is_empty() {
            let advice = "draw closed paths, filled or stroked; convert text and bitmaps to paths first";
            return Err(self.fail("it contains no visible shape", advice));
        }
        if cut {
            let (reason, advice) = ("it is cut by a clip path or mask", "draw the shape itself as a path");
            return Err(self.fail(reason, advice));
        }
        let segments: usize = found.iter().map(|(path, _)| path.data().len()).sum();
        if segments > MOST_SEGMENTS {
            return Err(Error::TooLarge {
                what: Large::Drawing,
                name: self.name.into(),
                found: format!("{segments} segments"),
                limit: format!("{MOST_SEGMENTS} segments"),
            });
        }
        let ruled = |(path, map): (&usvg::Path, Affine)| {
            let rule = match path.fill().map(usvg::Fill::rule) {
                Some(usvg::FillRule::NonZero) => Rule::NonZero,
                // In a shape with only a stroke, every ring is an edge.
                Some(usvg::FillRule::EvenOdd) | None => Rule::EvenOdd,
            };
            Ok((self.closed(path, map)?, rule))
        };
        let paths = found.into_iter().map(ruled).collect::<Result<Vec<_>>>()?;
        let size = tree.size();
        Ok(FileShapes { paths, size: [f64::from(size.width()), f64::from(size.height())] })
    }

    /// The path in pixels of the SVG. All its rings must be closed.
    fn closed(&self, path: &usvg::Path, map: Affine) -> Result<BezPath> {
        use usvg::tiny_skia_path::PathSegment;
        let point = |p: usvg::tiny_skia_path::Point| map * Point::new(f64::from(p.x), f64::from(p.y));
        let mut out = BezPath::new();
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(p) => out.move_to(point(p)),
                PathSegment::LineTo(p) => out.line_to(point(p)),
                PathSegment::QuadTo(a, p) => out.quad_to(point(a), point(p)),
                PathSegment::CubicTo(a, b, p) => out.curve_to(point(a), point(b), point(p)),
                PathSegment::Close => out.close_path(),
            }
        }
        let bounds = out.bounding_box();
        let hair = 1e-4 * bounds.width().max(bounds.height());
        for ring in rings(&out) {
            let ends = [ring.first(), ring.last()].map(|e| e.and_then(PathEl::end_point));
            let meets = matches!(ends, [Some(a), Some(b)] if a.distance(b) <= hair);
            if ring.last() != Some(&PathEl::ClosePath) && !meets {
                let advice = "close it: end its path data with Z, or join its ends in the editor";
                return Err(self.fail("its path is open", advice));
            }
        }
        Ok(out)
    }

    /// Checks that the path does not cross itself.
    fn outline(&self, path: &BezPath) -> Result<Outline> {
        let outline = Outline::new(path).ok_or_else(|| {
            self.fail("its coordinates are beyond ten million pixels", "scale the drawing down")
        })?;
        if is_simple(outline.path()) {
            return Ok(outline);
        }
        Err(self.fail("its path crosses itself", "undo the crossing, or unite the parts in the editor"))
    }
}

/// The rings of a path, each as its elements.
fn rings(path: &BezPath) -> impl Iterator<Item = &[PathEl]> {
    path.elements().chunk_by(|_, next| !matches!(next, PathEl::MoveTo(_)))
}

/// The rings that separate inside from outside, the largest first. Holes run against the ring around
/// them.
fn filled(path: &BezPath, rule: Rule) -> BezPath {
    struct FilledRing {
        path: BezPath,
        area: f64,
        place: Point,
    }
    let all: Vec<FilledRing> = rings(path)
        .map(|elements| {
            let path = BezPath::from_vec(elements.to_vec());
            let place = path.segments().next().map_or(Point::ORIGIN, |s| s.eval(0.5));
            FilledRing { area: path.area(), path, place }
        })
        .filter(|ring| ring.area != 0.0)
        .collect();
    let inside = |winding: i32| match rule {
        Rule::NonZero => winding != 0,
        Rule::EvenOdd => winding % 2 != 0,
    };
    let mut kept: Vec<(f64, BezPath)> = Vec::new();
    for ring in &all {
        // A ring that contains this one has a larger area.
        let larger = all.iter().filter(|other| other.area.abs() > ring.area.abs());
        let around = larger.filter(|other| {
            other.path.bounding_box().contains(ring.place) && other.path.contains(ring.place)
        });
        let turn = |ring: &FilledRing| if ring.area > 0.0 { 1 } else { -1 };
        let outer: i32 = around.map(turn).sum();
        let (without, within) = (inside(outer), inside(outer + turn(ring)));
        if without != within {
            let turned = within != (ring.area > 0.0);
            let path = if turned { ring.path.reverse_subpaths() } else { ring.path.clone() };
            kept.push((ring.area.abs(), path));
        }
    }
    kept.sort_by(|a, b| b.0.total_cmp(&a.0));
    kept.into_iter().flat_map(|(_, path)| path).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::Rect;

    fn svg(inner: &str) -> Vec<u8> {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50">{inner}</svg>"#)
            .into_bytes()
    }

    fn of(inner: &str) -> Result<Outline> {
        shape(&svg(inner), "s.svg", [1000, 1000])
    }

    #[test]
    fn the_canvas_of_the_svg_is_fitted_to_the_canvas() {
        // Scaled by ten, and centred on a canvas twice as high.
        let rectangle = of(r#"<rect x="10" y="20" width="30" height="20"/>"#).unwrap();
        assert_eq!(rectangle.bounds(), Rect::new(100.0, 450.0, 400.0, 650.0));
        let turned =
            of(r#"<g transform="translate(50 0) rotate(90)"><rect width="30" height="20"/></g>"#).unwrap();
        assert_eq!(turned.bounds(), Rect::new(300.0, 250.0, 500.0, 550.0));
        let symbol = r##"<symbol id="s" overflow="visible"><path d="M0 0h30v20h-30z"/></symbol>"##;
        let used = format!(r##"{symbol}<use href="#s" transform="translate(50 0) rotate(90)"/>"##);
        assert_eq!(of(&used).unwrap().bounds(), turned.bounds());
        let disc = of(r#"<circle cx="50" cy="25" r="20" fill="none" stroke="red"/>"#).unwrap();
        assert!((disc.area() - std::f64::consts::PI * 4e4).abs() < 100.0);
        let viewed =
            br#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-1 -1 2 2"><path d="M-1-1H1V1H-1z"/></svg>"#;
        assert_eq!(shape(viewed, "s.svg", [70, 30]).unwrap().bounds(), Rect::new(20.0, 0.0, 50.0, 30.0));
    }

    #[test]
    fn holes_and_islands_follow_the_fill_rule() {
        let area = |d: &str, rule: &str| {
            let outline = of(&format!(r#"<path fill-rule="{rule}" d="{d}"/>"#)).unwrap();
            assert!(outline.path().area() > 0.0, "outer rings run clockwise");
            outline.area() / 100.0
        };
        let (same, against) = ("M0 0h40v40h-40zM10 10h20v20h-20z", "M0 0h40v40h-40zM10 10v20h20v-20z");
        assert_eq!([area(same, "nonzero"), area(same, "evenodd")], [1600.0, 1200.0]);
        assert_eq!([area(against, "nonzero"), area(against, "evenodd")], [1200.0, 1200.0]);
        // An island in a hole, the small rings first, and all drawn anticlockwise.
        let island = "M15 15v10h10v-10zM10 10v20h20v-20zM0 0v40h40v-40z M50 0v10h10v-10z";
        assert_eq!(area(island, "evenodd"), 1600.0 - 400.0 + 100.0 + 100.0);
        assert_eq!(area(island, "nonzero"), 1700.0);
    }

    #[test]
    fn several_shapes_are_their_union() {
        let area = |inner: &str| {
            let outline = of(inner).unwrap();
            assert!(outline.path().area() > 0.0 && is_simple(outline.path()));
            outline.area() / 100.0
        };
        // Two letters side by side, one of them a ring with a dot in it.
        let ring = r#"<path fill-rule="evenodd" d="M0 0h40v40h-40zM10 10h20v20h-20z"/>"#;
        let apart =
            format!(r#"{ring}<rect x="15" y="15" width="10" height="10"/><path d="M50 0h20v40h-20z"/>"#);
        assert_eq!(area(&apart), 1600.0 - 400.0 + 100.0 + 800.0);
        // A shape within another adds no area, in either order.
        for inner in [
            r#"<rect width="40" height="40"/><rect x="5" y="5" width="9" height="9"/>"#,
            r#"<rect x="5" y="5" width="9" height="9"/><rect width="40" height="40"/>"#,
        ] {
            assert_eq!(area(inner), 1600.0);
        }
        // Those that cross: a cross of two bars, and two discs, traced from pixels.
        let cross = area(r#"<path d="M10 0h20v50h-20z"/><path d="M0 15h40v20h-40z"/>"#);
        assert!((cross - (1000.0 + 800.0 - 400.0)).abs() < 1.0, "{cross}");
        let discs = area(r#"<circle cx="25" cy="25" r="20"/><circle cx="45" cy="25" r="20"/>"#);
        // The intersection: a lens of two discs of radius 20 whose centres are 20 apart.
        let lens = 400.0 * (2.0 * std::f64::consts::PI / 3.0 - 0.75_f64.sqrt());
        assert!((discs - (800.0 * std::f64::consts::PI - lens)).abs() < 3.0, "{discs}");
        // Stroked shapes do not count if there are filled ones.
        let outlined =
            r#"<rect width="10" height="10"/><rect width="90" height="40" fill="none" stroke="red"/>"#;
        assert_eq!(area(outlined), 100.0);
    }

    #[test]
    fn what_is_no_shape_is_told() {
        for (inner, message) in [
            ("", "contains no visible shape"),
            ("<text>A</text>", "contains no visible shape"),
            (r#"<rect width="9" height="9" visibility="hidden"/>"#, "contains no visible shape"),
            (r#"<path d="M0 0H9V9"/>"#, "its path is open"),
            (r#"<line x2="9" y2="9" stroke="red"/>"#, "its path is open"),
            (r#"<path d="M0 0H9V9H0z M20 20h9v9"/>"#, "its path is open"),
            (r#"<path d="M0 0L9 9H0L9 0z"/>"#, "crosses itself"),
            (r#"<path d="M0 0H9V9H0zM5 5h9v9h-9z"/>"#, "crosses itself"),
            (r#"<rect x="200" width="9" height="9"/>"#, "outside the canvas"),
            (r#"<rect width="1e-3" height="1e-3"/>"#, "encloses no area"),
            (r#"<path d="M0 0H1e30V9z"/>"#, "beyond ten million pixels"),
            (
                r#"<clipPath id="c"><rect width="5" height="5"/></clipPath><circle r="9" clip-path="url(#c)"/>"#,
                "clip path",
            ),
        ] {
            let error = of(inner).unwrap_err();
            assert!(error.to_string().contains(message), "{inner}: {error}");
            assert!(error.hint().is_some());
        }
        assert!(shape(b"no svg", "s.svg", [9, 9]).is_err());
        let many = format!(r#"<path d="M0 0{}z"/>"#, "h1v1".repeat(MOST_SEGMENTS));
        assert!(matches!(of(&many), Err(Error::TooLarge { .. })));
        // A path that ends at its start counts as closed.
        assert!(of(r#"<path d="M0 0H9V9H0L0 0"/>"#).is_ok());
    }

    #[test]
    fn cages_keep_scale_and_direction() {
        let read = |inner: &str| cage(&svg(inner), "c.svg");
        let (anticlockwise, page) = read(r#"<path d="M10 10v30h30v-30z"/>"#).unwrap();
        assert_eq!(anticlockwise.bounds(), Rect::new(10.0, 10.0, 40.0, 40.0));
        assert!(anticlockwise.path().area() < 0.0);
        assert_eq!(page, [100, 50]);
        let error = read(r#"<rect width="9" height="9"/><circle r="9"/>"#).unwrap_err();
        assert!(error.to_string().contains("it contains 2 shapes"), "{error}");
        let error = read(r#"<path d="M0 0H40V40H0z M9 9h5v5z"/>"#).unwrap_err();
        assert!(error.to_string().contains("it has 2 rings"), "{error}");
    }
}
