//! A plane divided among shapes: each place belongs to the shape that it is deepest in, or nearest to.
//!
//! Between shapes that overlap, the border runs half-way between the parts of their borders that lie in one another. Into
//! gaps, a shape grows the less the wider the side is that it turns to them, as if each kept its convex hull small.
//!
//! A grid shows which shapes meet and where. The borders are then moved to where both shapes are equally far, so the grid
//! does not show in them.

use crate::trace::thinned;
use std::collections::VecDeque;
use vtex_base::error::Result;
use vtex_base::geometry::{OUTSIDE, PlanarMap, Point, Rect, Vec2, inside, nearest_between};
use vtex_base::parallel;
use vtex_base::raster::{Connectivity, LabelMap, components, edge_neighbours};

/// Rows, borders and shapes between two questions whether to go on.
const AT_ONCE: usize = 64;
/// Steps in which a point is moved to where its shapes are equally far.
const STEPS: usize = 6;
/// How far a point may be moved from where the grid has it, in sides of a cell of the grid.
const MOVED: f64 = 2.5;

/// A closed shape of one or several rings, filled by the even-odd rule.
#[derive(Clone, Debug, PartialEq)]
pub struct CellShape {
    /// Its rings, without their first points at the end.
    pub rings: Vec<Vec<Point>>,
    bounds: Rect,
}

impl CellShape {
    /// A shape of rings, one at least, none empty.
    pub fn new(rings: Vec<Vec<Point>>) -> Self {
        let first = rings[0][0];
        let start = Rect::from_points(first, first);
        let bounds = rings.iter().flatten().fold(start, |bounds, p| bounds.union_pt(*p));
        Self { rings, bounds }
    }

    /// The middle of its bounds.
    pub(crate) fn middle(&self) -> Point {
        self.bounds.center()
    }

    pub(crate) fn bounds(&self) -> Rect {
        self.bounds
    }

    /// The shape with lengths along x and y multiplied.
    pub(crate) fn stretched(&self, by: [f64; 2]) -> Self {
        let ring = |ring: &Vec<Point>| ring.iter().map(|p| Point::new(by[0] * p.x, by[1] * p.y)).collect();
        Self::new(self.rings.iter().map(ring).collect())
    }

    /// Extent along a direction, with a point.
    fn width(&self, along: Vec2, p: Point) -> f64 {
        let own = p.to_vec2().dot(along);
        let (mut low, mut high) = (own, own);
        for q in self.rings.iter().flatten() {
            let v = q.to_vec2().dot(along);
            (low, high) = (low.min(v), high.max(v));
        }
        high - low
    }

    pub(crate) fn contains(&self, p: Point) -> bool {
        self.rings.iter().filter(|ring| inside(ring, p)).count() % 2 == 1
    }

    /// Distance from the border, below 0 inside, and the direction of length 1 in which it grows.
    pub(crate) fn distance(&self, p: Point) -> (f64, Vec2) {
        let mut best = (f64::INFINITY, Vec2::ZERO, Vec2::ZERO);
        for ring in &self.rings {
            let mut last = ring[ring.len() - 1];
            for &here in ring {
                let way = p - nearest_between([last, here], p);
                if way.hypot2() < best.0 {
                    best = (way.hypot2(), way, here - last);
                }
                last = here;
            }
        }
        let (far, sign) = (libm::sqrt(best.0), if self.contains(p) { -1.0 } else { 1.0 });
        // On the border itself the side tells the direction.
        let way = if far > 1e-9 { sign / far * best.1 } else { Vec2::new(best.2.y, -best.2.x) };
        let size = libm::sqrt(way.hypot2()).max(1e-12);
        (sign * far, way / size)
    }
}

/// Largest deviation of borders that are new from those on the grid, and distance from half a joint from which on a
/// border is new, in sides of a cell of the grid.
const LOOSE: f64 = 1.8;
const DRAWN: f64 = 0.5;
/// Least share of a border for which that is not so.
const DRAWN_SHARE: f64 = 0.9;
/// Largest difference of the costs there, in sides of a cell of the grid.
const EVEN: f64 = 0.2;
/// Depth in another shape from which on a border lies in it, in half joints or sides of a cell of the grid.
const WITHIN: f64 = 0.5;
/// How much steeper the cost is at a border that is not contested.
const FREE: f64 = 8.0;

/// A shape at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlacedShape {
    /// Its number.
    pub(crate) shape: u32,
    /// The way by which it is moved.
    pub(crate) by: Vec2,
}

/// A plane divided among placed shapes.
pub(crate) struct Partition {
    /// The ring around the part of each; empty for a shape without one. Its area is positive.
    pub(crate) rings: Vec<Vec<Point>>,
    /// The borders between two parts.
    pub(crate) borders: Vec<PartBorder>,
}

/// A border between the parts of two placed shapes.
pub(crate) struct PartBorder {
    pub(crate) points: Vec<Point>,
    pub(crate) sides: [u32; 2],
    /// Whether it lies where the exemplar has it: half a joint from both.
    pub(crate) is_drawn: bool,
}

/// Shapes on a part of the plane.
pub(crate) struct PartitionTask<'a> {
    pub(crate) shapes: &'a [CellShape],
    pub(crate) placed: &'a [PlacedShape],
    pub(crate) window: Rect,
    /// Side of a cell of the grid.
    pub(crate) step: f64,
    /// How far beyond its border a shape's part may reach.
    pub(crate) reach: f64,
    /// Largest deviation of a border from its points.
    pub(crate) tolerance: f64,
    /// Half the distance of shapes that lie side by side; `None` before it is known.
    pub(crate) half_gap: Option<f64>,
}

/// Shapes with what is known of each.
struct Placing<'a> {
    task: &'a PartitionTask<'a>,
    /// The parts of each shape's border that lie in others.
    contested: Vec<Vec<[Point; 2]>>,
}

impl PartitionTask<'_> {
    /// The plane divided. `go_on` is asked between parts of the work.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn divided(&self, go_on: &dyn Fn() -> Result<()>) -> Result<Partition> {
        let numbers: Vec<u32> = (0..self.placed.len() as u32).collect();
        let contested = in_parts(&numbers, go_on, |&k| self.contested(k))?;
        Placing { task: self, contested }.divided(go_on)
    }

    fn half_gap(&self) -> f64 {
        self.half_gap.unwrap_or(0.0)
    }

    /// Distance from a placed shape.
    pub(crate) fn distance(&self, placed: u32, p: Point) -> (f64, Vec2) {
        let PlacedShape { shape, by } = self.placed[placed as usize];
        self.shapes[shape as usize].distance(p - by)
    }

    fn bounds(&self, placed: u32) -> Rect {
        let PlacedShape { shape, by } = self.placed[placed as usize];
        self.shapes[shape as usize].bounds() + by
    }

    /// The parts of a placed shape's border that lie in others.
    fn contested(&self, placed: u32) -> Vec<[Point; 2]> {
        let bounds = self.bounds(placed);
        let others: Vec<u32> = (0..self.placed.len() as u32)
            .filter(|k| *k != placed && self.bounds(*k).overlaps(bounds))
            .collect();
        let PlacedShape { shape, by } = self.placed[placed as usize];
        let depth = WITHIN * self.half_gap().max(self.step);
        let mut found = Vec::new();
        if others.is_empty() {
            return found;
        }
        for ring in &self.shapes[shape as usize].rings {
            for k in 0..ring.len() {
                let [from, to] = [ring[k] + by, ring[(k + 1) % ring.len()] + by];
                let count = libm::ceil(from.distance(to) / self.step).max(1.0);
                for part in 0..count as usize {
                    let ends = [0, 1].map(|end| from.lerp(to, (part + end) as f64 / count));
                    let middle = ends[0].midpoint(ends[1]);
                    if others
                        .iter()
                        .any(|o| self.bounds(*o).contains(middle) && self.distance(*o, middle).0 < -depth)
                    {
                        found.push(ends);
                    }
                }
            }
        }
        found
    }
}

impl Placing<'_> {
    fn divided(&self, go_on: &dyn Fn() -> Result<()>) -> Result<Partition> {
        let task = self.task;
        let size =
            [task.window.width(), task.window.height()].map(|v| libm::ceil(v / task.step).max(1.0) as u32);
        let labels = self.labels(size, go_on)?;
        go_on()?;
        let map = PlanarMap::trace(size[0], size[1], &labels);
        let at = |p: [i32; 2]| task.window.origin() + task.step * Vec2::new(f64::from(p[0]), f64::from(p[1]));
        // The shapes at each junction.
        let mut meeting: Vec<(Point, Vec<u32>)> = vec![(Point::ORIGIN, Vec::new()); map.junctions];
        for arc in &map.arcs {
            let points = map.points_of(arc);
            for (end, p) in arc.ends.into_iter().flatten().zip([points[0], points[points.len() - 1]]) {
                let (place, shapes) = &mut meeting[end as usize];
                *place = at(p);
                shapes.extend(
                    [arc.left, arc.right].into_iter().filter(|l| !shapes.contains(l)).collect::<Vec<_>>(),
                );
            }
        }
        let junctions = in_parts(&meeting, go_on, |(place, shapes)| self.balanced(*place, shapes))?;
        let courses: Vec<(Vec<Point>, bool)> = in_parts(&map.arcs, go_on, |arc| {
            let points = map.points_of(arc);
            let sides = [arc.left, arc.right];
            let middles = points.windows(2).map(|w| at(w[0]).midpoint(at(w[1])));
            let inner = middles.map(|p| self.balanced(p, &sides));
            let Some(ends) = arc.ends else { return (inner.collect(), false) };
            let [first, last] = ends.map(|junction| junctions[junction as usize]);
            let course: Vec<Point> = [first].into_iter().chain(inner).chain([last]).collect();
            let is_drawn = self.is_as_drawn(&course, sides);
            (thinned(&course, if is_drawn { task.tolerance } else { LOOSE * task.step }), is_drawn)
        })?;
        let rings = map.rings(task.placed.len(), |label| label);
        let ring = |of: usize| {
            let mut ring: Vec<Point> = Vec::new();
            for half in rings[of + 1].first().into_iter().flatten() {
                let course = &courses[half.arc as usize].0;
                let open = course.len() - usize::from(!map.arcs[half.arc as usize].closed());
                match half.reversed {
                    false => ring.extend(&course[..open]),
                    true => ring.extend(course.iter().rev().take(open)),
                }
            }
            ring
        };
        let rings = (0..task.placed.len()).map(ring).collect();
        let is_between = |l: u32| l > 0 && l != OUTSIDE;
        let borders =
            map.arcs.iter().zip(courses).filter(|(arc, _)| is_between(arc.left) && is_between(arc.right));
        let borders = borders.map(|(arc, (points, is_drawn))| PartBorder {
            points,
            sides: [arc.left - 1, arc.right - 1],
            is_drawn,
        });
        Ok(Partition { rings, borders: borders.collect() })
    }

    /// Whether a border lies half a joint from both its shapes, counted from 1, but for its ends, where joints are wider.
    fn is_as_drawn(&self, course: &[Point], sides: [u32; 2]) -> bool {
        let task = self.task;
        let ends = [course[0], course[course.len() - 1]];
        let near = 2.0 * task.half_gap() + 2.0 * task.step;
        let inner: Vec<Point> =
            course.iter().copied().filter(|p| ends.iter().all(|end| end.distance(*p) > near)).collect();
        let is_off = |p: &&Point| {
            let known = sides.iter().filter(|l| **l > 0 && **l != OUTSIDE);
            known
                .into_iter()
                .any(|l| (task.distance(l - 1, **p).0 - task.half_gap()).abs() > DRAWN * task.step)
        };
        let off = inner.iter().filter(is_off).count() as f64;
        task.half_gap.is_none() || off <= (1.0 - DRAWN_SHARE) * inner.len() as f64
    }

    /// How little a place belongs to a shape, and the direction in which that grows.
    fn cost(&self, placed: u32, p: Point) -> (f64, Vec2) {
        self.cost_at(placed, p, self.task.distance(placed, p))
    }

    /// The cost of a place at a distance from a shape that grows in a direction: the distance from the middle of joints, or
    /// from what is contested where the place lies within.
    fn cost_at(&self, placed: u32, p: Point, (far, grows): (f64, Vec2)) -> (f64, Vec2) {
        let task = self.task;
        if far > task.half_gap() {
            let PlacedShape { shape, by } = task.placed[placed as usize];
            let wide = task.shapes[shape as usize].width(Vec2::new(-grows.y, grows.x), p - by) / task.reach;
            let weight = wide * wide;
            return (weight * (far - task.half_gap()), weight * grows);
        }
        let contested = &self.contested[placed as usize];
        if far >= 0.0 || contested.is_empty() {
            return (far - task.half_gap(), grows);
        }
        let mut best = (f64::INFINITY, Vec2::ZERO);
        for side in contested {
            let way = p - nearest_between(*side, p);
            if way.hypot2() < best.0 {
                best = (way.hypot2(), way);
            }
        }
        let within = libm::sqrt(best.0);
        // Near what is not contested the cost rises to that outside.
        if within > FREE * -far {
            return (FREE * far - task.half_gap(), FREE * grows);
        }
        (-within - task.half_gap(), -best.1 / within.max(1e-12))
    }

    /// The number of the nearest shape in each cell of the grid, from 1; each has one connected part at most.
    fn labels(&self, [width, height]: [u32; 2], go_on: &dyn Fn() -> Result<()>) -> Result<Vec<u32>> {
        let task = self.task;
        let inflated = |k| task.bounds(k).inflate(task.reach, task.reach);
        let boxes: Vec<Rect> = (0..task.placed.len() as u32).map(inflated).collect();
        let rows: Vec<u32> = (0..height).collect();
        let labels = in_parts(&rows, go_on, |&row| {
            let y = task.window.y0 + (f64::from(row) + 0.5) * task.step;
            let mut best: Vec<(f64, u32)> = vec![(f64::INFINITY, 0); width as usize];
            for (k, bounds) in boxes.iter().enumerate().filter(|(_, b)| (b.y0..=b.y1).contains(&y)) {
                let column =
                    |x: f64| ((x - task.window.x0) / task.step).clamp(0.0, f64::from(width)) as usize;
                for (x, best) in best.iter_mut().enumerate().take(column(bounds.x1)).skip(column(bounds.x0)) {
                    let p = Point::new(task.window.x0 + (x as f64 + 0.5) * task.step, y);
                    let distance = task.distance(k as u32, p);
                    if distance.0 > task.reach {
                        continue;
                    }
                    let cost = self.cost_at(k as u32, p, distance).0;
                    if cost < best.0 {
                        *best = (cost, k as u32 + 1);
                    }
                }
            }
            best.into_iter().map(|b| b.1).collect::<Vec<u32>>()
        })?;
        Ok(whole(LabelMap { width, height, labels: labels.concat() }))
    }

    /// A point moved to where shapes, counted from 1, are equally far; the point itself if that is nowhere near.
    fn balanced(&self, from: Point, shapes: &[u32]) -> Point {
        let task = self.task;
        let known = |l: &u32| *l > 0 && *l != OUTSIDE;
        if shapes.len() < 2 || !shapes.iter().all(known) {
            return from;
        }
        let mut p = from;
        for _ in 0..STEPS {
            let (first, grown) = self.cost(shapes[0] - 1, p);
            // Least squares of the differences to the first.
            let (mut xx, mut xy, mut yy, mut right) = (1e-6, 0.0, 1e-6, Vec2::ZERO);
            for other in &shapes[1..] {
                let (far, grows) = self.cost(other - 1, p);
                let (off, way) = (far - first, grows - grown);
                (xx, xy, yy) = (xx + way.x * way.x, xy + way.x * way.y, yy + way.y * way.y);
                right -= off * way;
            }
            let size = xx * yy - xy * xy;
            let step = Vec2::new(yy * right.x - xy * right.y, xx * right.y - xy * right.x) / size;
            let most = task.step;
            let long = libm::sqrt(step.hypot2());
            p += if long > most { step * (most / long) } else { step };
            if !p.is_finite() || p.distance(from) > MOVED * task.step {
                return from;
            }
        }
        let first = self.cost(shapes[0] - 1, p).0;
        let is_even =
            shapes[1..].iter().all(|other| (self.cost(other - 1, p).0 - first).abs() < EVEN * task.step);
        if is_even { p } else { from }
    }
}

/// A function of all items, in parts between which `go_on` is asked.
fn in_parts<T: Sync, U: Send>(
    items: &[T],
    go_on: &dyn Fn() -> Result<()>,
    f: impl Fn(&T) -> U + Sync + Send,
) -> Result<Vec<U>> {
    let mut all = Vec::with_capacity(items.len());
    for part in items.chunks(AT_ONCE) {
        go_on()?;
        all.extend(parallel::map(part, &f));
    }
    Ok(all)
}

/// Labels of which each has one connected part, its largest; what it loses goes to what is beside it.
fn whole(map: LabelMap) -> Vec<u32> {
    let (pieces, of_piece) = components(&map, Connectivity::Four);
    let mut areas = vec![0u32; of_piece.len()];
    pieces.labels.iter().for_each(|p| areas[*p as usize] += 1);
    let count = of_piece.iter().max().map_or(0, |l| *l as usize + 1);
    let mut largest: Vec<u32> = vec![0; count];
    for (piece, label) in of_piece.iter().enumerate().skip(1) {
        let known = &mut largest[*label as usize];
        if *known == 0 || areas[piece] > areas[*known as usize] {
            *known = piece as u32;
        }
    }
    let [width, height] = [map.width as usize, map.height as usize];
    let is_kept = |piece: u32| piece > 0 && largest[of_piece[piece as usize] as usize] == piece;
    let mut labels: Vec<u32> =
        pieces.labels.iter().map(|p| if is_kept(*p) { of_piece[*p as usize] } else { 0 }).collect();
    let mut queue: VecDeque<usize> = (0..labels.len()).filter(|i| labels[*i] > 0).collect();
    while let Some(i) = queue.pop_front() {
        for j in edge_neighbours(i, [width, height]) {
            if labels[j] == 0 {
                labels[j] = labels[i];
                queue.push_back(j);
            }
        }
    }
    labels
}
