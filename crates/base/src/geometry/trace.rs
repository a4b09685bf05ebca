//! Contour tracing: converts a label map to a planar map of arcs along pixel edges (cracks).
//!
//! Every border between two labels is traced once, from junction to junction, and shared by both
//! sides. Faces are 4-connected: pixels of one label that touch only at a corner stay separate.

use crate::parallel;
use std::ops::Range;

/// Label of everything outside the map.
pub const OUTSIDE: u32 = u32::MAX;

/// A border between two labels along pixel edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arc {
    /// Label on the left in the direction of the points.
    pub left: u32,
    /// Label on the right.
    pub right: u32,
    /// Range of its lattice points, one pixel apart. The first and the last are junctions, or equal in a
    /// closed arc without junctions.
    pub points: Range<usize>,
    /// Numbers of the junctions at its ends; `None` for a closed curve without junctions.
    pub ends: Option<[u32; 2]>,
}

impl Arc {
    /// Whether the arc is a closed curve without junctions.
    pub fn closed(&self) -> bool {
        self.ends.is_none()
    }
}

/// A label map as a planar map: arcs between junctions, which separate the labels. [`FittedMap`]
/// turns it into smooth outlines.
///
/// [`FittedMap`]: super::FittedMap
#[derive(Clone, Debug)]
pub struct PlanarMap {
    /// The arcs.
    pub arcs: Vec<Arc>,
    /// The lattice points of all arcs.
    pub points: Vec<[i32; 2]>,
    /// Number of junctions.
    pub junctions: usize,
}

/// An arc with a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfArc {
    /// Index of the arc.
    pub arc: u32,
    /// Whether it is walked from its last point to its first.
    pub reversed: bool,
}

/// A closed chain of half arcs that keeps one face on its right.
pub(super) type Ring = Vec<HalfArc>;

const STEPS: [[i32; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]]; // right, down, left, up

impl PlanarMap {
    /// Traces a map of `width` × `height` labels, given row by row.
    pub fn trace(width: u32, height: u32, labels: &[u32]) -> Self {
        let lattice = LabelLattice { width: width as usize, height: height as usize, labels };
        let columns = lattice.width + 1;
        let count = columns * (lattice.height + 1);
        let mut cracks = vec![0u8; count];
        parallel::for_chunks(&mut cracks, columns, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, cracks)| *cracks = lattice.cracks(x, y));
        });
        let junctions: Vec<usize> = (0..count).filter(|&v| cracks[v].count_ones() > 2).collect();
        let map = Self { arcs: Vec::new(), points: Vec::new(), junctions: junctions.len() };
        let mut walker = Walker { lattice: &lattice, used: vec![0; count], junctions, map };
        // First the arcs that start at junctions, then the remaining closed curves.
        for junctions in [true, false] {
            for v in 0..count {
                let degree = cracks[v].count_ones();
                if degree >= 2 && (degree > 2) == junctions {
                    for direction in 0..4 {
                        if cracks[v] & (1 << direction) != 0 && walker.used[v] & (1 << direction) == 0 {
                            walker.walk(v, direction, &cracks);
                        }
                    }
                }
            }
        }
        walker.map
    }

    /// The lattice points of an arc.
    pub fn points_of(&self, arc: &Arc) -> &[[i32; 2]] {
        &self.points[arc.points.clone()]
    }

    /// The rings around each face from 1 to `count`, where `key` maps labels to faces. Face 0 and
    /// [`OUTSIDE`] have no rings. Rings keep their face on the right, so outer rings run clockwise on the
    /// screen. The ring with the largest area comes first.
    pub fn rings(&self, count: usize, key: impl Fn(u32) -> u32) -> Vec<Vec<Ring>> {
        let key = |label: u32| if label == OUTSIDE { 0 } else { key(label) };
        // Half arcs that leave each junction, by direction.
        let mut leaving: Vec<[Option<HalfArc>; 4]> = vec![[None; 4]; self.junctions];
        let on_border = |arc: &Arc| key(arc.left) != key(arc.right);
        for (i, arc) in self.arcs.iter().enumerate() {
            if let Some([first, last]) = arc.ends.filter(|_| on_border(arc)) {
                let p = self.points_of(arc);
                let n = p.len();
                let mut leave = |junction: u32, direction: usize, reversed: bool| {
                    leaving[junction as usize][direction] = Some(HalfArc { arc: i as u32, reversed });
                };
                leave(first, direction(p[0], p[1]), false);
                leave(last, direction(p[n - 1], p[n - 2]), true);
            }
        }
        let right_key = |h: HalfArc| {
            let arc = &self.arcs[h.arc as usize];
            key(if h.reversed { arc.left } else { arc.right })
        };
        let mut rings: Vec<Vec<Ring>> = vec![Vec::new(); count + 1];
        let mut done = vec![[false; 2]; self.arcs.len()];
        for (i, arc) in self.arcs.iter().enumerate() {
            if !on_border(arc) {
                continue;
            }
            for reversed in [false, true] {
                let first = HalfArc { arc: i as u32, reversed };
                let face = right_key(first);
                if face == 0 || face as usize > count || done[i][usize::from(reversed)] {
                    continue;
                }
                let mut ring = Ring::new();
                let mut at = first;
                loop {
                    done[at.arc as usize][usize::from(at.reversed)] = true;
                    ring.push(at);
                    let arc = &self.arcs[at.arc as usize];
                    let Some(ends) = arc.ends else { break };
                    let p = self.points_of(arc);
                    let n = p.len();
                    let heading =
                        if at.reversed { direction(p[1], p[0]) } else { direction(p[n - 2], p[n - 1]) };
                    let leaving = &leaving[ends[usize::from(!at.reversed)] as usize];
                    // Tightest turn towards the face first, so that faces are not connected through corners.
                    let next = [1, 0, 3].iter().find_map(|turn| {
                        let h = leaving[(heading + turn) % 4]?;
                        (right_key(h) == face).then_some(h)
                    });
                    match next {
                        Some(h) if h == first => break,
                        Some(h) => at = h,
                        None => unreachable!("a face's border is closed"),
                    }
                }
                rings[face as usize].push(ring);
            }
        }
        for face in &mut rings {
            face.sort_by_cached_key(|ring| -self.twice_area(ring));
        }
        rings
    }

    /// Twice the signed area of a ring on the lattice, positive for outer rings.
    fn twice_area(&self, ring: &Ring) -> i64 {
        let mut sum = 0;
        for h in ring {
            let p = self.points_of(&self.arcs[h.arc as usize]);
            let arc: i64 = p
                .windows(2)
                .map(|w| i64::from(w[0][0]) * i64::from(w[1][1]) - i64::from(w[1][0]) * i64::from(w[0][1]))
                .sum();
            sum += if h.reversed { -arc } else { arc };
        }
        sum
    }
}

fn direction(from: [i32; 2], to: [i32; 2]) -> usize {
    match [to[0] - from[0], to[1] - from[1]] {
        [1, 0] => 0,
        [0, 1] => 1,
        [-1, 0] => 2,
        _ => 3,
    }
}

struct LabelLattice<'a> {
    width: usize,
    height: usize,
    labels: &'a [u32],
}

impl LabelLattice<'_> {
    /// Label of the pixel whose upper left corner is the lattice point, shifted by (dx, dy).
    fn label(&self, x: usize, y: usize, dx: usize, dy: usize) -> u32 {
        let (px, py) = (x + dx, y + dy);
        if px == 0 || py == 0 || px > self.width || py > self.height {
            OUTSIDE
        } else {
            self.labels[(py - 1) * self.width + px - 1]
        }
    }

    /// Directions in which a crack leaves a lattice point, one bit each.
    fn cracks(&self, x: usize, y: usize) -> u8 {
        let (nw, ne, sw, se) =
            (self.label(x, y, 0, 0), self.label(x, y, 1, 0), self.label(x, y, 0, 1), self.label(x, y, 1, 1));
        u8::from(ne != se) | u8::from(sw != se) << 1 | u8::from(nw != sw) << 2 | u8::from(nw != ne) << 3
    }

    /// Labels left and right of the crack that leaves a lattice point in a direction.
    fn sides(&self, x: usize, y: usize, direction: usize) -> (u32, u32) {
        let at = |dx, dy| self.label(x, y, dx, dy);
        match direction {
            0 => (at(1, 0), at(1, 1)),
            1 => (at(1, 1), at(0, 1)),
            2 => (at(0, 1), at(0, 0)),
            _ => (at(0, 0), at(1, 0)),
        }
    }
}

struct Walker<'a> {
    lattice: &'a LabelLattice<'a>,
    /// Directions already walked from each lattice point, one bit each.
    used: Vec<u8>,
    /// The lattice points that are junctions, ascending.
    junctions: Vec<usize>,
    map: PlanarMap,
}

impl Walker<'_> {
    fn walk(&mut self, start: usize, mut direction: usize, cracks: &[u8]) {
        let columns = self.lattice.width + 1;
        let (left, right) = self.lattice.sides(start % columns, start / columns, direction);
        let first = self.map.points.len();
        let mut v = start;
        let push =
            |v: usize, points: &mut Vec<[i32; 2]>| points.push([(v % columns) as i32, (v / columns) as i32]);
        push(v, &mut self.map.points);
        loop {
            self.used[v] |= 1 << direction;
            let [dx, dy] = STEPS[direction];
            v = (v as i64 + i64::from(dx) + i64::from(dy) * columns as i64) as usize;
            let back = (direction + 2) % 4;
            self.used[v] |= 1 << back;
            push(v, &mut self.map.points);
            if v == start || cracks[v].count_ones() != 2 {
                break;
            }
            direction = (cracks[v] & !(1 << back)).trailing_zeros() as usize;
        }
        let closed = v == start && cracks[start].count_ones() == 2;
        let number = |v: usize| self.junctions.partition_point(|&u| u < v) as u32;
        let ends = (!closed).then(|| [start, v].map(number));
        self.map.arcs.push(Arc { left, right, points: first..self.map.points.len(), ends });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rings_enclose_exactly_their_pixels(labels in prop::collection::vec(0..4u32, 11 * 8), merge: bool) {
            let map = PlanarMap::trace(11, 8, &labels);
            let key = |l: u32| if merge { l.div_ceil(2) } else { l };
            let rings = map.rings(3, key);
            for face in 1..=3 {
                let pixels = labels.iter().filter(|&&l| key(l) == face).count() as i64;
                let area: i64 = rings[face as usize].iter().map(|r| map.twice_area(r)).sum();
                prop_assert_eq!(area, 2 * pixels);
            }
            for arc in &map.arcs {
                prop_assert!(arc.left != arc.right);
                let p = map.points_of(arc);
                prop_assert!(p.len() >= 2);
                prop_assert!(p.windows(2).all(|w| (w[0][0] - w[1][0]).abs() + (w[0][1] - w[1][1]).abs() == 1));
            }
        }
    }
}
