//! Strokes of an exemplar, and the graph of them.
//!
//! Strokes are divided into short steps. What lies on an earlier stroke of the same style is left out, so that paths
//! drawn twice, or beyond the border of a page that repeats, count once. Nodes are the ends, the crossings, the places
//! where an end meets another stroke, and sharp corners; what is closer than the weld is one node.

use crate::graph::{CurveEdge, CurveGraph, ElementNode};
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, along, length};

/// Most steps that all strokes are divided into.
const MOST_STEPS: f64 = 400_000.0;
/// Most crossings of strokes, and most pairs of steps that are compared to find them.
const MOST_CROSSINGS: usize = 100_000;
const MOST_PAIRS: u64 = 200_000_000;
/// Cosine of the turn from which on a place of a stroke is a corner: 35°.
const CORNER: f64 = 0.82;
/// Cosine of the largest angle between strokes that count as one where they lie on one another.
const ALONG: f64 = 0.97;
/// Distance of a broken end from the border, in welds, and the largest share of ends at the border that are broken.
const BORDER: f64 = 6.0;
const BROKEN: f64 = 0.34;
/// Strokes between two questions whether to go on.
const AT_ONCE: usize = 256;

/// A stroked line of the exemplar.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveStroke {
    /// The line through its points, in the unit of the page. It may lead beyond a page that repeats.
    pub points: Vec<[f64; 2]>,
    /// Whether it ends where it begins.
    pub closed: bool,
    /// Its appearance: any number.
    pub style: u32,
}

/// An element between the strokes of the exemplar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveElement {
    /// Its place, in the unit of the page.
    pub at: [f64; 2],
    /// Its appearance: any number that no stroke has. Those of one number may stand for one another.
    pub style: u32,
}

/// A page of strokes.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveExemplar {
    /// The page. A page that does not repeat cuts the strokes.
    pub page: PeriodicPlane,
    /// The strokes.
    pub strokes: Vec<CurveStroke>,
    /// The elements between them. Those beyond a page that does not repeat do not count.
    pub elements: Vec<CurveElement>,
    /// Distance up to which ends meet, in the unit of the page; above 0.
    pub weld: f64,
}

/// A stroke in short steps.
struct SteppedLine {
    points: Vec<[f64; 2]>,
    closed: bool,
    style: u32,
    /// Whether its ends are at the border of the page.
    open: [bool; 2],
}

/// A step: its stroke and number, its first point and the way along it.
struct LineStep {
    line: u32,
    number: u32,
    from: [f64; 2],
    way: [f64; 2],
}

impl CurveExemplar {
    /// Whether the strokes, whose graph is `whole`, go on across the borders of a page that repeats: most of those that
    /// reach a border do. True where none reaches a border.
    pub fn is_seamless(&self, whole: &CurveGraph) -> bool {
        let copy = |p: [f64; 2], k: usize| libm::floor(p[k] / self.page.size[k]);
        let crosses = |w: &&[[f64; 2]]| (0..2).any(|k| self.page.wraps[k] && copy(w[0], k) != copy(w[1], k));
        let crossings: usize = self.strokes.iter().map(|s| s.points.windows(2).filter(crosses).count()).sum();
        let near = BORDER * self.weld;
        let at_border = |n: &usize| {
            let at = whole.points[*n];
            (0..2).any(|k| self.page.wraps[k] && (at[k] < near || at[k] > self.page.size[k] - near))
        };
        let broken = (0..whole.points.len()).filter(|n| whole.degree(*n) == 1).filter(at_border).count();
        broken as f64 <= BROKEN * (2 * crossings + broken) as f64
    }

    /// The graph of the strokes: edges from node to node.
    ///
    /// # Errors
    /// [`Error::TooLarge`] for strokes that cross or lie on one another too often; those of `go_on`.
    pub fn graph(&self, go_on: &dyn Fn() -> Result<()>) -> Result<CurveGraph> {
        let lines = self.lines(go_on)?;
        let mut steps = Vec::new();
        for (l, line) in lines.iter().enumerate() {
            for (k, pair) in line.points.windows(2).enumerate() {
                let way = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
                steps.push(LineStep { line: l as u32, number: k as u32, from: pair[0], way });
            }
        }
        let longest = steps.iter().map(|s| length(s.way)).fold(self.weld, f64::max);
        let middle =
            |s: &LineStep| self.page.wrapped([s.from[0] + 0.5 * s.way[0], s.from[1] + 0.5 * s.way[1]]);
        let middles: Vec<[f64; 2]> = steps.iter().map(middle).collect();
        let index = PointIndex::new(self.page, longest + self.weld, &middles);
        // The cuts of each line: steps and shares of a step, and the node.
        let mut cuts: Vec<Vec<(f64, u32)>> = vec![Vec::new(); lines.len()];
        let (mut nodes, mut open): (Vec<[f64; 2]>, Vec<bool>) = (Vec::new(), Vec::new());
        let mut add = |at: [f64; 2], is_open: bool| {
            nodes.push(self.page.wrapped(at));
            open.push(is_open);
            nodes.len() as u32 - 1
        };
        if index.looked_at(&middles, longest + 1e-9) > MOST_PAIRS {
            return Err(too_often());
        }
        let mut crossings = 0;
        for (a, step) in steps.iter().enumerate() {
            if a.is_multiple_of(64 * AT_ONCE) {
                go_on()?;
            }
            let line = &lines[step.line as usize];
            index.within(middles[a], longest + 1e-9, |b, between| {
                let other = &steps[b];
                if b <= a || other.line == step.line && line.beside(step.number, other.number) {
                    return;
                }
                if let Some([s, t]) = crossing(step.way, other.way, between) {
                    let at = [step.from[0] + s * step.way[0], step.from[1] + s * step.way[1]];
                    crossings += 1;
                    let node = add(at, false);
                    cuts[step.line as usize].push((f64::from(step.number) + s, node));
                    cuts[other.line as usize].push((f64::from(other.number) + t, node));
                }
            });
            if crossings > MOST_CROSSINGS {
                return Err(too_often());
            }
        }
        for (l, line) in lines.iter().enumerate() {
            if l.is_multiple_of(AT_ONCE) {
                go_on()?;
            }
            let last = line.points.len() - 1;
            for k in line.corners() {
                let node = add(line.points[k], false);
                cuts[l].push((k as f64, node));
            }
            for (d, k) in [0, last].into_iter().enumerate().filter(|_| !line.closed) {
                let at = line.points[k];
                let node = add(at, line.open[d]);
                cuts[l].push((k as f64, node));
                let mut best: Option<(f64, usize, f64)> = None;
                index.within(self.page.wrapped(at), longest + self.weld, |b, way| {
                    let other = &steps[b];
                    let own = other.line as usize == l
                        && (f64::from(other.number) - k as f64).abs() * longest < 4.0 * self.weld + longest;
                    let (share, far) = nearest_on(other.way, way);
                    if !own && far < self.weld && best.is_none_or(|(f, i, _)| (far, b) < (f, i)) {
                        best = Some((far, b, share));
                    }
                });
                if let Some((_, b, share)) = best {
                    cuts[steps[b].line as usize].push((f64::from(steps[b].number) + share, node));
                }
            }
        }
        Ok(self.assembled(&lines, cuts, (nodes, open)))
    }

    /// The strokes in short steps, each part once.
    fn lines(&self, go_on: &dyn Fn() -> Result<()>) -> Result<Vec<SteppedLine>> {
        let sound = |s: &&CurveStroke| s.points.iter().flatten().all(|v| v.is_finite());
        let strokes: Vec<&CurveStroke> = self.strokes.iter().filter(sound).collect();
        let total: f64 = strokes.iter().map(|s| along(&s.points)).sum();
        let step = (2.0 * self.weld).max(total / MOST_STEPS);
        let mut fresh: Vec<SteppedLine> = Vec::new();
        for (k, stroke) in strokes.iter().enumerate() {
            if k.is_multiple_of(AT_ONCE) {
                go_on()?;
            }
            let points = divided(stroke, step);
            if points.len() < 2 {
                continue;
            }
            let open = [false; 2];
            fresh.extend(self.cut(SteppedLine { points, closed: stroke.closed, style: stroke.style, open }));
        }
        // Only steps of one style on earlier ones are left out.
        let mut all: Vec<(usize, usize)> = Vec::new();
        let mut middles = Vec::new();
        for (l, line) in fresh.iter().enumerate() {
            for (k, pair) in line.points.windows(2).enumerate() {
                all.push((l, k));
                middles.push([0.5 * (pair[0][0] + pair[1][0]), 0.5 * (pair[0][1] + pair[1][1])]);
            }
        }
        let reach = 0.5 * step + self.weld;
        let index = PointIndex::new(self.page, reach, &middles);
        let way = |(l, k): (usize, usize)| {
            let [a, b] = [fresh[l].points[k], fresh[l].points[k + 1]];
            [b[0] - a[0], b[1] - a[1]]
        };
        let numbers: Vec<usize> = (0..all.len()).collect();
        let mut kept: Vec<bool> = Vec::with_capacity(all.len());
        if index.looked_at(&middles, reach) > MOST_PAIRS {
            return Err(too_often());
        }
        for part in numbers.chunks(64 * AT_ONCE) {
            go_on()?;
            kept.extend(vtex_base::parallel::map(part, |&a| {
                let (l, k) = all[a];
                let own = way((l, k));
                let mut repeated = false;
                index.within(middles[a], reach, |b, between| {
                    let (m, n) = all[b];
                    // Of two steps the later goes; steps near each other on one line are no copies.
                    let near = m == l && (n.abs_diff(k) as f64 * step) < 6.0 * self.weld.max(step);
                    if b >= a || near || fresh[m].style != fresh[l].style {
                        return;
                    }
                    let other = way((m, n));
                    let cosine =
                        (own[0] * other[0] + own[1] * other[1]) / (length(own) * length(other)).max(1e-12);
                    let aside = (own[0] * between[1] - own[1] * between[0]).abs() / length(own).max(1e-12);
                    let ahead = (own[0] * between[0] + own[1] * between[1]).abs() / length(own).max(1e-12);
                    let beside = ahead <= 0.5 * length(other) + 1e-9;
                    repeated |= cosine.abs() > ALONG && aside < self.weld && beside;
                });
                !repeated
            }));
        }
        let mut lines = Vec::new();
        let mut at = 0;
        for line in fresh {
            let count = line.points.len() - 1;
            let own = &kept[at..at + count];
            at += count;
            if own.iter().all(|k| *k) {
                lines.push(line);
                continue;
            }
            let mut k = 0;
            while k < count {
                let run = own[k..].iter().take_while(|kept| **kept == own[k]).count();
                if own[k] {
                    let points = line.points[k..=k + run].to_vec();
                    let open = [k == 0 && line.open[0], k + run == count && line.open[1]];
                    lines.push(SteppedLine { points, closed: false, style: line.style, open });
                }
                k += run;
            }
        }
        Ok(lines)
    }

    /// The parts of a line on the page.
    fn cut(&self, line: SteppedLine) -> Vec<SteppedLine> {
        let size = self.page.size;
        let beyond = |p: [f64; 2], k: usize| !self.page.wraps[k] && !(0.0..=size[k]).contains(&p[k]);
        let outside = |p: &[f64; 2]| beyond(*p, 0) || beyond(*p, 1);
        if !line.points.iter().any(outside) {
            return vec![line];
        }
        // Where the way from a point on the page to one beyond it crosses the border.
        let border = |from: [f64; 2], to: [f64; 2]| {
            let mut share: f64 = 1.0;
            for k in (0..2).filter(|&k| beyond(to, k)) {
                let limit = if to[k] < 0.0 { 0.0 } else { size[k] };
                share = share.min((limit - from[k]) / (to[k] - from[k]));
            }
            [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
        };
        let mut parts: Vec<SteppedLine> = Vec::new();
        let mut part: Vec<[f64; 2]> = Vec::new();
        let mut begins_open = false;
        let push = |points: Vec<[f64; 2]>, open: [bool; 2], parts: &mut Vec<SteppedLine>| {
            if points.len() > 1 {
                parts.push(SteppedLine { points, closed: false, style: line.style, open });
            }
        };
        for (k, p) in line.points.iter().enumerate() {
            match (outside(p), part.last().copied()) {
                (true, Some(last)) => {
                    part.push(border(last, *p));
                    push(std::mem::take(&mut part), [begins_open, true], &mut parts);
                }
                (true, None) => {}
                (false, Some(_)) => part.push(*p),
                (false, None) => {
                    begins_open = k > 0;
                    if k > 0 {
                        part.push(border(*p, line.points[k - 1]));
                    }
                    part.push(*p);
                }
            }
        }
        push(part, [begins_open, false], &mut parts);
        parts
    }

    /// Merges nodes, and cuts the lines into edges.
    fn assembled(
        &self,
        lines: &[SteppedLine],
        mut cuts: Vec<Vec<(f64, u32)>>,
        (nodes, open): (Vec<[f64; 2]>, Vec<bool>),
    ) -> CurveGraph {
        let index = PointIndex::new(self.page, self.weld, &nodes);
        let mut sets = DisjointSets::new(nodes.len());
        for (n, at) in nodes.iter().enumerate() {
            index.within(*at, self.weld, |other, _| {
                if other < n {
                    sets.join(n, other);
                }
            });
        }
        let mut number = vec![u32::MAX; nodes.len()];
        let (mut points, mut is_open): (Vec<[f64; 2]>, Vec<bool>) = (Vec::new(), Vec::new());
        for n in 0..nodes.len() {
            let root = sets.root(n);
            if number[root] == u32::MAX {
                number[root] = points.len() as u32;
                points.push(nodes[n]);
                is_open.push(open[n]);
            }
            number[n] = number[root];
        }
        let mut edges = Vec::new();
        for (line, cuts) in lines.iter().zip(&mut cuts) {
            cuts.iter_mut().for_each(|c| c.1 = number[c.1 as usize]);
            cuts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if cuts.is_empty() {
                cuts.push((0.0, points.len() as u32));
                points.push(self.page.wrapped(line.points[0]));
                is_open.push(false);
            }
            let count = (line.points.len() - 1) as f64;
            if line.closed {
                let (at, node) = cuts[0];
                cuts.push((at + count, node));
            }
            for pair in cuts.windows(2) {
                let course = line.between(pair[0].0, pair[1].0);
                let [from, to] = [points[pair[0].1 as usize], points[pair[1].1 as usize]];
                edges.extend(self.edge(&course, ([pair[0].1, pair[1].1], from, to), line.style));
            }
        }
        let is_on_page =
            |at: [f64; 2]| (0..2).all(|k| self.page.wraps[k] || (0.0..=self.page.size[k]).contains(&at[k]));
        let mut elements = Vec::new();
        for (number, element) in self.elements.iter().enumerate().filter(|e| is_on_page(e.1.at)) {
            let (node, style) = (points.len() as u32, element.style);
            points.push(self.page.wrapped(element.at));
            is_open.push(false);
            elements.push(ElementNode { node, element: number as u32, style });
        }
        CurveGraph::new(self.page, points, is_open, edges).with_elements(elements)
    }

    /// An edge along a course, fitted to its nodes; `None` for a remainder within one weld.
    fn edge(
        &self,
        course: &[[f64; 2]],
        (ends, from, to): ([u32; 2], [f64; 2], [f64; 2]),
        style: u32,
    ) -> Option<CurveEdge> {
        let long = along(course);
        if ends[0] == ends[1] && long < 4.0 * self.weld || long <= 0.0 {
            return None;
        }
        let last = course[course.len() - 1];
        let begin = self.page.between(self.page.wrapped(course[0]), from);
        let end = self.page.between(self.page.wrapped(last), to);
        let mut shape = vec![[0.0; 2]];
        let way = |p: &[f64; 2]| [p[0] - course[0][0] - begin[0], p[1] - course[0][1] - begin[1]];
        // Points within the weld of the ends would bend the moved ends back.
        let apart = |p: &&[f64; 2]| {
            let far = |q: [f64; 2]| length([p[0] - q[0], p[1] - q[1]]);
            far(course[0]) > self.weld && far(last) > self.weld
        };
        shape.extend(course[1..course.len() - 1].iter().filter(apart).map(way));
        let arrival = way(&last);
        shape.push([arrival[0] + end[0], arrival[1] + end[1]]);
        Some(CurveEdge { ends, shape, style })
    }
}

impl SteppedLine {
    /// Whether two steps of this line share a point.
    fn beside(&self, a: u32, b: u32) -> bool {
        let far = a.abs_diff(b) as usize;
        far < 2 || self.closed && far == self.points.len() - 2
    }

    /// The points at which it turns sharply.
    fn corners(&self) -> Vec<usize> {
        let n = self.points.len() - 1;
        let at = |k: usize| self.points[k % n];
        let inner = if self.closed { 0..n } else { 1..n };
        let turns = |k: &usize| {
            let (before, here, after) = match *k {
                0 => (self.points[n - 1], self.points[0], at(1)),
                k => (self.points[k - 1], self.points[k], self.points[k + 1]),
            };
            let (a, b) =
                ([here[0] - before[0], here[1] - before[1]], [after[0] - here[0], after[1] - here[1]]);
            a[0] * b[0] + a[1] * b[1] < CORNER * length(a) * length(b)
        };
        inner.filter(turns).collect()
    }

    /// The course between two places, given in steps; the second may lie beyond the end of a closed line.
    fn between(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let n = self.points.len() - 1;
        let at = |place: f64| {
            let place = if place > n as f64 { place - n as f64 } else { place };
            let k = (place as usize).min(n - 1);
            let t = place - k as f64;
            let [a, b] = [self.points[k], self.points[k + 1]];
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        };
        // A closed line on a torus may end a period beyond its beginning.
        let round = [self.points[n][0] - self.points[0][0], self.points[n][1] - self.points[0][1]];
        let moved = |p: [f64; 2], beyond: bool| if beyond { [p[0] + round[0], p[1] + round[1]] } else { p };
        let mut course = vec![at(from)];
        for k in libm::floor(from) as usize + 1..=libm::ceil(to) as usize - usize::from(to > 0.0) {
            let beyond = k > n;
            course.push(moved(self.points[if beyond { k - n } else { k }], beyond));
        }
        course.push(moved(at(to), to > n as f64));
        course.dedup();
        if course.len() < 2 {
            course.push(course[0]);
        }
        course
    }
}

/// The error for strokes that cross or lie on one another too often.
fn too_often() -> Error {
    let found = "lines that cross or cover one another too often".into();
    let limit = format!("{} thousand crossings", MOST_CROSSINGS / 1000);
    Error::TooLarge { what: Large::Drawing, name: "the drawing".into(), found, limit }
}

/// The points of a stroke, none further than `step` from the next, and none on the next.
fn divided(stroke: &CurveStroke, step: f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let ends = stroke.closed && stroke.points.first() != stroke.points.last();
    let back = stroke.points.first().filter(|_| ends);
    for &p in stroke.points.iter().chain(back) {
        let Some(&last) = points.last() else {
            points.push(p);
            continue;
        };
        let way = [p[0] - last[0], p[1] - last[1]];
        let count = libm::ceil(length(way) / step);
        for k in 1..=count as usize {
            let t = k as f64 / count;
            points.push([last[0] + t * way[0], last[1] + t * way[1]]);
        }
    }
    points
}

/// Where two steps cross, as shares of them; `between` is the way between their middles.
fn crossing(a: [f64; 2], b: [f64; 2], between: [f64; 2]) -> Option<[f64; 2]> {
    let across = a[0] * b[1] - a[1] * b[0];
    if across.abs() <= 1e-9 * length(a) * length(b) {
        return None;
    }
    // From the beginning of the first to that of the second.
    let to = [between[0] + 0.5 * (a[0] - b[0]), between[1] + 0.5 * (a[1] - b[1])];
    let s = (to[0] * b[1] - to[1] * b[0]) / across;
    let t = (to[0] * a[1] - to[1] * a[0]) / across;
    let within = |v: f64| (0.0..1.0).contains(&v);
    (within(s) && within(t)).then_some([s, t])
}

/// The place on a step nearest to a point, as a share of the step, and its distance; `way` leads from the point to the
/// middle of the step.
fn nearest_on(step: [f64; 2], way: [f64; 2]) -> (f64, f64) {
    let squared = (step[0] * step[0] + step[1] * step[1]).max(1e-300);
    let share = (0.5 - (way[0] * step[0] + way[1] * step[1]) / squared).clamp(0.0, 1.0);
    let at = [way[0] + (share - 0.5) * step[0], way[1] + (share - 0.5) * step[1]];
    (share, length(at))
}
