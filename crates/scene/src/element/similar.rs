//! Shapes that are equal up to rotation, reflection and size.

use super::Shape;
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, BezPath, PathEl, Point};

/// Largest number of points of a polygon for which each point is tried as the first.
const MOST_STARTS: usize = 64;

/// The angle-preserving map from one list of shapes to another with the same paints, exact to `tolerance`
/// pixels; `None` if there is none. Gradients and rims are not compared: shapes with these are never similar.
fn similarity(from: &[Shape], to: &[Shape], tolerance: f64) -> Option<Affine> {
    let paint = |(a, b): (&Shape, &Shape)| {
        let plain = [a, b].iter().all(|s| s.gradient.is_none() && s.rim.is_none());
        let kind = |s: &Shape| (s.line.is_some(), s.ellipse.as_ref().map(|ellipse| ellipse.profile));
        plain && a.colour == b.colour && a.opacity == b.opacity && kind(a) == kind(b)
    };
    if from.len() != to.len() || from.is_empty() || !from.iter().zip(to).all(paint) {
        return None;
    }
    let (p, q): (Vec<Vec<Point>>, Vec<Vec<Point>>) = (points(from)?, points(to)?);
    if p.len() != q.len() || p.iter().zip(&q).any(|(a, b)| a.len() != b.len()) {
        return None;
    }
    if !kinds(from).eq(kinds(to)) {
        return None;
    }
    let p: Vec<Point> = p.concat();
    // A polygon may begin at any of its points.
    let starts = match &q[..] {
        [ring] if ring.len() <= MOST_STARTS && lines_only(&to[0]) => ring.len(),
        _ => 1,
    };
    let q: Vec<Point> = q.concat();
    let found = (0..starts).find_map(|start| {
        let turned: Vec<Point> = q[start..].iter().chain(&q[..start]).copied().collect();
        let back: Vec<Point> = turned.iter().rev().copied().collect();
        [(&turned, false), (&turned, true)]
            .into_iter()
            .chain((starts > 1).then_some((&back, true)))
            .find_map(|(q, mirrored)| fitted(&p, q, mirrored, tolerance))
    });
    found.filter(|map| lines_fit(from, to, *map, tolerance))
}

/// A member of a class of similar lists of shapes.
#[derive(Clone, Copy, Debug)]
pub struct SimilarTo {
    /// Index of the first member of the class; its own if no earlier list is similar.
    pub first: usize,
    /// The map from the first member.
    pub map: Affine,
}

/// The class of each list of shapes. Lists of different `kinds` are never similar.
pub fn classes<'a, K: Ord>(
    count: usize,
    shapes: impl Fn(usize) -> &'a [Shape],
    kinds: impl Fn(usize) -> K,
    tolerance: f64,
) -> Vec<SimilarTo> {
    let mut firsts: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    let mut found = Vec::with_capacity(count);
    let sketches: Vec<[f64; 2]> = (0..count).map(|k| sketch(shapes(k))).collect();
    for k in 0..count {
        let own = shapes(k);
        let length: usize = own.iter().map(|s| s.outline.path().elements().len()).sum();
        let colour = own.first().map(|s| s.colour.0);
        let known = firsts.entry((own.len(), length, colour, kinds(k))).or_default();
        // At most 64 candidates are compared.
        let candidates = known.iter().rev().take(64).copied();
        let mut candidates =
            candidates.filter(|&first| may_be_similar(sketches[first], sketches[k], tolerance));
        let similar = candidates
            .find_map(|first| Some(SimilarTo { first, map: similarity(shapes(first), own, tolerance)? }));
        if similar.is_none() {
            known.push(k);
        }
        found.push(similar.unwrap_or(SimilarTo { first: k, map: Affine::IDENTITY }));
    }
    found
}

/// Two measures of shapes, from the distances of their control points from the middle: root mean square over
/// mean, which does not depend on size, and the mean.
fn sketch(shapes: &[Shape]) -> [f64; 2] {
    let all: Vec<Point> = points(shapes).unwrap_or_default().concat();
    let count = all.len().max(1) as f64;
    let sum = all.iter().fold((0.0, 0.0), |s, p| (s.0 + p.x, s.1 + p.y));
    let middle = Point::new(sum.0 / count, sum.1 / count);
    let mean = all.iter().map(|p| p.distance(middle)).sum::<f64>() / count;
    let square = libm::sqrt(all.iter().map(|p| p.distance_squared(middle)).sum::<f64>() / count);
    [if mean > 0.0 { square / mean } else { 1.0 }, mean]
}

/// Whether shapes with these sketches can be similar: each point may deviate by the tolerance.
fn may_be_similar(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    let deviation = 6.0 * tolerance / a[1].min(b[1]).max(1e-9);
    (a[0] - b[0]).abs() <= deviation + 1e-9
}

/// Control points of each subpath.
fn points(shapes: &[Shape]) -> Option<Vec<Vec<Point>>> {
    let mut all: Vec<Vec<Point>> = Vec::new();
    for path in shapes.iter().map(path) {
        for element in path.elements() {
            match *element {
                PathEl::MoveTo(p) => all.push(vec![p]),
                PathEl::LineTo(p) => all.last_mut()?.push(p),
                PathEl::QuadTo(a, p) => all.last_mut()?.extend([a, p]),
                PathEl::CurveTo(a, b, p) => all.last_mut()?.extend([a, b, p]),
                PathEl::ClosePath => {}
            }
        }
    }
    Some(all)
}

fn path(shape: &Shape) -> &BezPath {
    shape.line.as_ref().map_or(shape.outline.path(), |line| line.path.path())
}

fn kinds(shapes: &[Shape]) -> impl Iterator<Item = u8> + '_ {
    shapes.iter().flat_map(|shape| path(shape).elements()).map(|e| match e {
        PathEl::MoveTo(_) => 0,
        PathEl::LineTo(_) => 1,
        PathEl::QuadTo(..) => 2,
        PathEl::CurveTo(..) => 3,
        PathEl::ClosePath => 4,
    })
}

fn lines_only(shape: &Shape) -> bool {
    let straight = |e: &PathEl| !matches!(e, PathEl::QuadTo(..) | PathEl::CurveTo(..));
    shape.line.is_none() && shape.outline.path().elements().iter().all(straight)
}

/// The least squares similarity between two lists of points, if none deviates by more than the tolerance. In
/// complex numbers it is z ↦ a·z + b, or a·z̄ + b if mirrored.
fn fitted(p: &[Point], q: &[Point], mirrored: bool, tolerance: f64) -> Option<Affine> {
    let n = p.len() as f64;
    let mean = |v: &[Point]| {
        let (x, y) = v.iter().fold((0.0, 0.0), |s, p| (s.0 + p.x, s.1 + p.y));
        Point::new(x / n, y / n)
    };
    let (cp, cq) = (mean(p), mean(q));
    let sign = if mirrored { -1.0 } else { 1.0 };
    let (mut re, mut im, mut square) = (0.0, 0.0, 0.0);
    for (p, q) in p.iter().zip(q) {
        let (u, v) = (*p - cp, *q - cq);
        let (x, y) = (u.x, sign * u.y);
        re += v.x * x + v.y * y;
        im += v.y * x - v.x * y;
        square += x * x + y * y;
    }
    if square <= 0.0 {
        return None;
    }
    let (re, im) = (re / square, im / square);
    let turn = Affine::new([re, im, -sign * im, sign * re, 0.0, 0.0]);
    let map = Affine::translate(cq.to_vec2()) * turn * Affine::translate(-cp.to_vec2());
    let near = p.iter().zip(q).all(|(p, q)| (map * *p).distance(*q) <= tolerance);
    (near && re * re + im * im > 0.0).then_some(map)
}

/// Whether stroked lines have the same style after a map.
fn lines_fit(from: &[Shape], to: &[Shape], map: Affine, tolerance: f64) -> bool {
    let size = libm::sqrt(map.determinant().abs());
    from.iter().zip(to).all(|(a, b)| match (&a.line, &b.line) {
        (Some(a), Some(b)) => {
            let near = |x: f64, y: f64| (x * size - y).abs() <= tolerance;
            let dashes = a.dashes.iter().zip(&b.dashes).all(|(x, y)| near(*x, *y));
            near(a.width, b.width)
                && (a.cap, a.join) == (b.cap, b.join)
                && a.dashes.len() == b.dashes.len()
                && dashes
        }
        _ => true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::{Outline, parse_path};
    use vtex_base::raster::colour::Colour;

    fn shape(text: &str, map: Affine) -> Shape {
        Shape::new(Outline::new(&(map * parse_path(text).unwrap())).unwrap(), Colour([9; 3]))
    }

    #[test]
    fn turned_mirrored_and_enlarged_copies_are_found() {
        let text = "M0 0h40l-10 30c-20 5-30-10-30-30z";
        let own = [shape(text, Affine::IDENTITY)];
        for map in [
            vtex_base::geometry::rotation(0.7) * Affine::translate((30.0, 4.0)),
            Affine::scale(1.7) * vtex_base::geometry::rotation(-2.0),
            Affine::FLIP_Y * vtex_base::geometry::rotation(1.0),
        ] {
            let found = similarity(&own, &[shape(text, map)], 0.05).unwrap();
            let p = Point::new(17.0, 11.0);
            assert!((found * p).distance(map * p) < 0.05);
        }
        assert_eq!(
            similarity(&own, &[shape("M0 0h40l-10 33c-20 5-30-10-30-30z", Affine::IDENTITY)], 0.05),
            None
        );
        assert_eq!(similarity(&own, &[shape(text, Affine::scale_non_uniform(1.0, 1.1))], 0.05), None);
        // A polygon that begins at another of its points.
        let square = [shape("M0 0h40v30h-20z", Affine::IDENTITY)];
        assert!(similarity(&square, &[shape("M40 30h-20l-20-30h40z", Affine::IDENTITY)], 0.05).is_some());
    }
}
