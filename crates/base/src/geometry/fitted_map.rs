//! A planar map with smooth arcs: the outlines of all its faces, with shared borders.
//!
//! Each arc is sampled and fitted once, and both its sides use the same curve, so neighbours meet
//! without a gap. If the outline of a face crosses itself, the arcs involved are fitted more tightly,
//! and finally replaced by polylines through the midpoints of pixel edges, which cannot cross.

use super::arc_samples::{ArcSamples, Junctions};
use super::fit::{CurveSegment, fit_closed, fit_open};
use super::simple::{crossing_elements, is_simple};
use super::trace::{Arc, HalfArc, OUTSIDE, PlanarMap, Ring};
use super::{Outline, STEP};
use crate::parallel;
use kurbo::{BezPath, Point, Vec2};
use std::collections::BTreeMap;

/// A planar map whose arcs are smooth curves.
pub struct FittedMap {
    map: PlanarMap,
    arcs: Vec<FittedArc>,
    /// The rings of each label.
    labels: Vec<Vec<Ring>>,
}

/// Resolution of a label map, and tolerance of the curves fitted to it.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Fit tolerance: largest distance of a curve from its samples, in pixels of the image.
    pub tolerance: f64,
    /// Cells of the map along each side of a pixel, 1 or more. Outlines are in pixels of the image.
    pub cells: f64,
}

/// A fitted arc.
#[derive(Clone, Debug)]
struct FittedArc {
    start: Point,
    pieces: Vec<CurveSegment>,
}

/// Successively tighter fits: the share of the tolerance, and whether samples moved to the image's
/// edges are used. Arcs that still cross become polylines through the midpoints of pixel edges.
const FITS: [(f64, bool); 3] = [(1.0, true), (0.4, true), (0.4, false)];
/// Distance to each side over which a turn counts as a corner, in pixels.
const CORNER: f64 = 4.0;

impl FittedMap {
    /// Fits every arc of a planar map within `tolerance` pixels. `group` maps labels to groups; where a
    /// border between groups meets a border within one, the former passes through smoothly. Outlines of
    /// labels 1 to `count` and of groups 1 to `groups` are free of self-crossings.
    pub fn new(
        map: PlanarMap,
        tolerance: f64,
        count: usize,
        groups: usize,
        group: impl Fn(u32) -> u32 + Sync,
    ) -> Self {
        let scale = Scale { tolerance, cells: 1.0 };
        Self::with_edges(map, scale, count, groups, group, |_, _, _, _| 0.0)
    }

    /// As [`FittedMap::new`], for a map that may be finer than the image, with sub-pixel edges.
    /// `edge(point, normal, left, right)` gives the distance in pixels from a point of the border to the
    /// image's edge along `normal`, a unit vector from the label `left` to the label `right`.
    pub fn with_edges(
        map: PlanarMap,
        scale: Scale,
        count: usize,
        groups: usize,
        group: impl Fn(u32) -> u32 + Sync,
        edge: impl Fn(Point, Vec2, u32, u32) -> f64 + Sync,
    ) -> Self {
        let rank = |left: u32, right: u32| {
            if left == OUTSIDE || right == OUTSIDE { 2u8 } else { u8::from(group(left) != group(right)) }
        };
        let junctions = Junctions::new(&map, rank);
        let soft = |arc: &Arc| rank(arc.left, arc.right) == 0;
        let cells = scale.cells;
        let edge = |at: Point, normal, left, right| {
            edge((at.to_vec2() / cells).to_point(), normal, left, right) * cells
        };
        let mut parts = vec![0u32; groups + 1];
        for label in 1..=count as u32 {
            parts.get_mut(group(label) as usize).into_iter().for_each(|n| *n += 1);
        }
        // Groups of one label have its rings.
        let several = |l: u32| Some(group(l)).filter(|&g| parts.get(g as usize).is_some_and(|&n| n > 1));
        let (samples, [labels, unions]) = parallel::join(
            || ArcSamples::new(&map, &junctions, cells, soft, edge),
            || [map.rings(count, |l| l), map.rings(groups, |l| several(l).unwrap_or(0))],
        );
        let indices: Vec<usize> = (0..map.arcs.len()).collect();
        let fit = |i: usize, level: usize| {
            let arc = &map.arcs[i];
            if arc.left == OUTSIDE || arc.right == OUTSIDE {
                return along_border(map.points_of(arc), cells);
            }
            let Some(&(share, on_edges)) = FITS.get(level) else {
                return polyline(&samples.midpoints(&map, i), arc.closed(), cells);
            };
            let points = if on_edges { samples.refined() } else { samples.smoothed() };
            let ends = junctions.tangents(arc, points, i);
            let scale = Scale { tolerance: scale.tolerance * share, cells };
            fit_arc(points.of(i), arc.closed(), !soft(arc), ends, scale)
        };
        let mut arcs = parallel::map(&indices, |&i| fit(i, 0));
        let mut level = vec![0usize; arcs.len()];
        // Tighten crossing arcs until none is left. Levels only rise, so this terminates.
        let faces: Vec<&Vec<Ring>> = labels.iter().chain(&unions).filter(|face| !face.is_empty()).collect();
        let mut suspects: Vec<usize> = (0..faces.len()).collect();
        while !suspects.is_empty() {
            let looser = |i: &usize| level[*i] < FITS.len();
            let crossing: Vec<Vec<usize>> = parallel::map(&suspects, |&f| {
                let face = faces[f];
                let mut crossing = crossing_arcs(face, &arcs);
                if !crossing.is_empty() && !crossing.iter().any(looser) {
                    crossing = face.iter().flatten().map(|h| h.arc as usize).collect();
                }
                crossing
            });
            let mut tighten: Vec<usize> = crossing.into_iter().flatten().filter(looser).collect();
            tighten.sort_unstable();
            tighten.dedup();
            let refitted = parallel::map(&tighten, |&i| fit(i, level[i] + 1));
            let mut changed = vec![false; arcs.len()];
            for (&i, curve) in tighten.iter().zip(refitted) {
                (arcs[i], changed[i]) = (curve, true);
                level[i] += 1;
            }
            suspects = (0..faces.len())
                .filter(|&f| faces[f].iter().flatten().any(|h| changed[h.arc as usize]))
                .collect();
        }
        Self { map, arcs, labels }
    }

    /// The outlines of the faces 0 to `count`, where `key` maps labels to faces. Outline 0 is empty.
    pub fn outlines(&self, count: usize, key: impl Fn(u32) -> u32) -> Vec<Outline> {
        let rings = self.map.rings(count, key);
        parallel::map(&rings, |face| outline(path_of(face, |h| (&self.arcs[h.arc as usize], h.reversed))))
    }

    /// The outline of a label from 1 to `count` for painting it with others, one over another. Where
    /// `underlap(other)` is above 0, the outline extends that many pixels underneath the neighbour `other`,
    /// which hides hairlines of background along the joint.
    pub fn stacked_outline(&self, label: u32, underlap: impl Fn(u32) -> f64) -> Outline {
        let face = &self.labels[label as usize];
        let mut widened: BTreeMap<u32, FittedArc> = BTreeMap::new();
        for h in face.iter().flatten() {
            let arc = &self.map.arcs[h.arc as usize];
            let other = if h.reversed { arc.right } else { arc.left };
            let reach = if other == OUTSIDE || other == 0 { 0.0 } else { underlap(other) };
            if reach > 0.0 {
                let side = if h.reversed { 1.0 } else { -1.0 };
                widened.insert(h.arc, beside(&self.arcs[h.arc as usize], arc.closed(), side * reach));
            }
        }
        let bare = outline(path_of(face, |h| (&self.arcs[h.arc as usize], h.reversed)));
        if widened.is_empty() {
            return bare;
        }
        let path = path_of(face, |h| (widened.get(&h.arc).unwrap_or(&self.arcs[h.arc as usize]), h.reversed));
        // Extending underneath a thin neighbour may cross its far side; then the outline is not extended.
        let wide = outline(path);
        if wide.area() >= bare.area() && is_simple(wide.path()) { wide } else { bare }
    }
}

fn outline(path: BezPath) -> Outline {
    Outline::new(&path).unwrap_or_default()
}

/// Indices of the arcs of a face that cross one another.
fn crossing_arcs(face: &[Ring], arcs: &[FittedArc]) -> Vec<usize> {
    let path = path_of(face, |h| (&arcs[h.arc as usize], h.reversed));
    let crossing = crossing_elements(&path);
    if crossing.is_empty() {
        return Vec::new();
    }
    let mut arc_of_element = Vec::with_capacity(path.elements().len());
    for ring in face {
        let (first, last) = (ring[0].arc, ring[ring.len() - 1].arc);
        arc_of_element.push(first);
        for h in ring {
            arc_of_element.extend(arcs[h.arc as usize].pieces.iter().map(|_| h.arc));
        }
        arc_of_element.push(last);
    }
    crossing.into_iter().map(|element| arc_of_element[element] as usize).collect()
}

/// The closed path around a face.
fn path_of<'a>(face: &[Ring], curve: impl Fn(&HalfArc) -> (&'a FittedArc, bool)) -> BezPath {
    let mut path = BezPath::new();
    for ring in face {
        for (i, h) in ring.iter().enumerate() {
            let (c, reversed) = curve(h);
            if i == 0 {
                path.move_to(if reversed {
                    c.pieces.last().map_or(c.start, CurveSegment::end)
                } else {
                    c.start
                });
            }
            if reversed { append_reversed(&mut path, c) } else { append(&mut path, c) }
        }
        path.close_path();
    }
    path
}

fn append(path: &mut BezPath, c: &FittedArc) {
    for piece in &c.pieces {
        match *piece {
            CurveSegment::Line(p) => path.line_to(p),
            CurveSegment::Cubic(a, b, p) => path.curve_to(a, b, p),
        }
    }
}

fn append_reversed(path: &mut BezPath, c: &FittedArc) {
    for (i, piece) in c.pieces.iter().enumerate().rev() {
        let to = if i == 0 { c.start } else { c.pieces[i - 1].end() };
        match *piece {
            CurveSegment::Line(_) => path.line_to(to),
            CurveSegment::Cubic(a, b, _) => path.curve_to(b, a, to),
        }
    }
}

/// Converts a point of the map to pixels and rounds it to the outlines' grid. Both sides of an arc are
/// rounded in the same way.
fn grid(p: Point, cells: f64) -> Point {
    Point::new(libm::round(p.x / cells / STEP) * STEP, libm::round(p.y / cells / STEP) * STEP)
}

fn fit_arc(points: &[Point], closed: bool, sharp: bool, ends: [Option<Vec2>; 2], scale: Scale) -> FittedArc {
    let tolerance = scale.tolerance * scale.cells;
    let corners = sharp.then_some((CORNER * scale.cells) as usize);
    let (start, pieces) = if closed {
        fit_closed(points, corners, tolerance)
    } else {
        (points[0], fit_open(points, corners, ends, tolerance))
    };
    let pieces = pieces.into_iter().map(|piece| match piece {
        CurveSegment::Line(p) => CurveSegment::Line(grid(p, scale.cells)),
        CurveSegment::Cubic(a, b, p) => {
            CurveSegment::Cubic(grid(a, scale.cells), grid(b, scale.cells), grid(p, scale.cells))
        }
    });
    FittedArc { start: grid(start, scale.cells), pieces: pieces.collect() }
}

/// The exact curve along the image border: straight lines with corners.
fn along_border(lattice: &[[i32; 2]], cells: f64) -> FittedArc {
    let point = |p: [i32; 2]| grid(Point::new(f64::from(p[0]), f64::from(p[1])), cells);
    let turns = lattice.windows(3).filter(|w| w[0][0] != w[2][0] && w[0][1] != w[2][1]).map(|w| w[1]);
    let pieces = turns.chain(lattice.last().copied()).map(|p| CurveSegment::Line(point(p))).collect();
    FittedArc { start: point(lattice[0]), pieces }
}

fn polyline(points: &[Point], closed: bool, cells: f64) -> FittedArc {
    let rest = points[1..].iter().chain(closed.then_some(&points[0]));
    FittedArc {
        start: grid(points[0], cells),
        pieces: rest.map(|&p| CurveSegment::Line(grid(p, cells))).collect(),
    }
}

/// Offsets a curve by a small `distance` (positive to the right). The ends of an open curve stay. Each
/// joint moves along its normal, handles move with their joints. A line between fixed ends bows.
fn beside(curve: &FittedArc, closed: bool, distance: f64) -> FittedArc {
    let joint = |i: usize| if i == 0 { curve.start } else { curve.pieces[i - 1].end() };
    let count = curve.pieces.len();
    let unit = |v: Vec2| v / libm::sqrt(v.hypot2()).max(1e-9);
    // Directions at both ends of a segment; a handle may coincide with its joint.
    let way = |i: usize| match curve.pieces[i] {
        CurveSegment::Cubic(a, b, p) => [joint(i), a, b, p],
        CurveSegment::Line(p) => [joint(i), p, joint(i), p],
    };
    let begins = |i: usize| {
        let [from, rest @ ..] = way(i);
        unit(rest.into_iter().find(|q| *q != from).unwrap_or(from) - from)
    };
    let ends = |i: usize| {
        let [rest @ .., to] = way(i);
        unit(to - rest.into_iter().rev().find(|q| *q != to).unwrap_or(to))
    };
    let fixed = |i: usize| !closed && (i == 0 || i == count);
    // Displacement of the handles at each joint. Between two fixed ends, a curve moves at its middle by
    // three quarters of its handles' displacement.
    let moves: Vec<Vec2> = (0..=count)
        .map(|i| {
            let along = match i {
                0 if !closed => begins(0),
                i if fixed(i) => ends(count - 1),
                i => unit(ends((i + count - 1) % count) + begins(i % count)),
            };
            // y points down, so turning right is (x, y) → (-y, x).
            Vec2::new(-along.y, along.x) * if fixed(i) { distance * 4.0 / 3.0 } else { distance }
        })
        .collect();
    let moved = |i: usize| grid(if fixed(i) { joint(i) } else { joint(i) + moves[i] }, 1.0);
    let pieces = (0..count).flat_map(|i| {
        let bow = match curve.pieces[i] {
            CurveSegment::Line(to) if fixed(i) && fixed(i + 1) => {
                let middle = joint(i).midpoint(to) + moves[i] * 0.75;
                Some(CurveSegment::Line(grid(middle, 1.0)))
            }
            _ => None,
        };
        let piece = match curve.pieces[i] {
            CurveSegment::Line(_) => CurveSegment::Line(moved(i + 1)),
            CurveSegment::Cubic(a, b, _) => {
                CurveSegment::Cubic(grid(a + moves[i], 1.0), grid(b + moves[i + 1], 1.0), moved(i + 1))
            }
        };
        bow.into_iter().chain([piece])
    });
    FittedArc { start: moved(0), pieces: pieces.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::is_simple;
    use kurbo::Shape;
    use proptest::prelude::*;

    /// Label maps of blobs, thin lines and single pixels.
    fn maps() -> impl Strategy<Value = (u32, u32, Vec<u32>)> {
        let stamps = prop::collection::vec((0..24i32, 0..18i32, 1..7i32, 1..7i32, 0..6u32), 1..25);
        (stamps, prop::collection::vec(prop::option::weighted(0.04, 0..6u32), 24 * 18)).prop_map(
            |(stamps, noise)| {
                let mut labels = vec![0; 24 * 18];
                for (cx, cy, rx, ry, label) in stamps {
                    for (i, l) in labels.iter_mut().enumerate() {
                        let (dx, dy) = ((i % 24) as i32 - cx, (i / 24) as i32 - cy);
                        if dx * dx * ry * ry + dy * dy * rx * rx <= rx * rx * ry * ry {
                            *l = label;
                        }
                    }
                }
                for (l, n) in labels.iter_mut().zip(noise) {
                    *l = n.unwrap_or(*l);
                }
                (24, 18, labels)
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn outlines_are_simple_and_share_their_borders(
            (w, h, labels) in maps(),
            tolerance in 0.05..5.0f64,
            unrest in prop_oneof![Just(0.0), 0.0..2.0f64],
            cells in 1..4u32,
        ) {
            let group = |l: u32| l.div_ceil(2);
            // Extremely rough image edges: every point is displaced differently.
            let edge = |at: Point, _: Vec2, left: u32, right: u32| {
                unrest * libm::sin(at.x * 12.9 + at.y * 78.2 + f64::from(left * 7 + right))
            };
            let planar = PlanarMap::trace(w, h, &labels);
            let scale = Scale { tolerance, cells: f64::from(cells) };
            let fitted = FittedMap::with_edges(planar, scale, 5, 3, group, edge);
            let outlines = fitted.outlines(5, |l| l);
            let groups = fitted.outlines(3, group);
            let stacked = [1, 2, 3, 4, 5].map(|a| fitted.stacked_outline(a, |b| if a < b { 0.6 } else { 0.0 }));
            for (l, outline) in outlines.iter().enumerate().skip(1) {
                let pixels = labels.iter().filter(|&&x| x == l as u32).count();
                prop_assert_eq!(outline.is_empty(), pixels == 0);
                prop_assert!(is_simple(outline.path()), "label {} {:?}", l, outline);
                prop_assert!(is_simple(stacked[l - 1].path()));
                prop_assert!(stacked[l - 1].area() > outline.area() - 0.05);
            }
            for outline in &groups {
                prop_assert!(is_simple(outline.path()));
            }
            // Shared borders cancel: parts add up to the whole up to rounding.
            for g in 1..=3u32 {
                let parts: f64 = (1..=5).filter(|&l| group(l) == g).map(|l| outlines[l as usize].path().area()).sum();
                prop_assert!((parts - groups[g as usize].path().area()).abs() < 1e-6);
            }
            // The image is tiled: every face at the image border has a straight edge there.
            let all = fitted.outlines(1, |_| 1);
            prop_assert!((all[1].path().area() * scale.cells * scale.cells - f64::from(w * h)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_disc_is_round_and_keeps_its_area() {
        let labels: Vec<u32> = (0..60 * 60)
            .map(|i| {
                let (x, y) = (f64::from(i % 60) - 29.5, f64::from(i / 60) - 29.5);
                u32::from(x * x + y * y < 20.0 * 20.0)
            })
            .collect();
        let fitted = FittedMap::new(PlanarMap::trace(60, 60, &labels), 0.5, 1, 1, |l| l);
        let outline = &fitted.outlines(1, |l| l)[1];
        let pixels = labels.iter().sum::<u32>();
        assert!((outline.area() - f64::from(pixels)).abs() < 0.01 * f64::from(pixels));
        assert!(outline.compactness() > 0.98, "{}", outline.compactness());
        assert!(outline.path().elements().len() <= 12, "{:?}", outline);
    }
}
