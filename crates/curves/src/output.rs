//! The samples of the result, their edges, and the curves along them.

use crate::graph::{CurveEdge, CurveGraph};
use crate::input::CurveInput;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, along};

/// Cosine of the largest angle between an edge and that of the exemplar that it follows: 60°.
const FOLLOWS: f64 = 0.5;
/// Points of an edge that is blended of two.
const BLENDED: usize = 24;

/// An edge of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JoinedEdge {
    pub(crate) ends: [u32; 2],
    /// For each end the half-edge of the exemplar that leaves its source as the edge leaves the end.
    pub(crate) from: [Option<u32>; 2],
    pub(crate) style: u32,
}

/// Samples and edges.
#[derive(Clone)]
pub(crate) struct CurveOutput {
    pub(crate) plane: PeriodicPlane,
    pub(crate) points: Vec<[f64; 2]>,
    /// The sample of the exemplar with the most similar neighbourhood (m).
    pub(crate) source: Vec<u32>,
    pub(crate) style: Vec<u32>,
    pub(crate) edges: Vec<JoinedEdge>,
    /// Of the first samples, which are given and stay as they are, the direction in which the curve goes on if it ends
    /// there and is to be continued.
    pub(crate) ahead: Vec<Option<[f64; 2]>>,
    /// Number of the edges, the first ones, that are given.
    pub(crate) given_edges: usize,
}

impl CurveOutput {
    pub(crate) fn new(plane: PeriodicPlane) -> Self {
        let (points, source, style, edges) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { plane, points, source, style, edges, ahead: Vec::new(), given_edges: 0 }
    }

    /// Number of the samples, the first ones, that are given.
    pub(crate) fn given(&self) -> usize {
        self.ahead.len()
    }

    /// The direction in which a given curve goes on from a sample.
    pub(crate) fn ahead(&self, sample: u32) -> Option<[f64; 2]> {
        self.ahead.get(sample as usize).copied().flatten()
    }

    /// The edges that are made.
    pub(crate) fn made_edges(&self) -> &[JoinedEdge] {
        &self.edges[self.given_edges..]
    }

    /// Whether a sample is an element.
    pub(crate) fn is_element(&self, sample: usize, input: &CurveInput) -> bool {
        input.is_of_elements(self.style[sample])
    }

    /// The elements that are made: places, and numbers in the list of those of the exemplar.
    pub(crate) fn elements(&self, input: &CurveInput) -> Vec<([f64; 2], usize)> {
        let made = (self.given()..self.len()).filter(|s| self.is_element(*s, input));
        made.filter_map(|s| Some((self.points[s], input.graph.element_at(self.source[s])?))).collect()
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Adds a sample like one of the exemplar, without edges.
    pub(crate) fn push(&mut self, at: [f64; 2], source: u32, input: &CurveInput) -> u32 {
        self.points.push(self.plane.wrapped(at));
        self.source.push(source);
        self.style.push(input.style[source as usize]);
        self.points.len() as u32 - 1
    }

    /// The edges at each sample: edge and end.
    pub(crate) fn incident(&self) -> Vec<Vec<(u32, usize)>> {
        let mut all = vec![Vec::new(); self.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            for d in 0..2 {
                all[edge.ends[d] as usize].push((e as u32, d));
            }
        }
        all
    }

    /// The way along an edge from one of its ends.
    pub(crate) fn way(&self, (edge, end): (u32, usize)) -> [f64; 2] {
        let ends = self.edges[edge as usize].ends;
        self.plane.between(self.points[ends[end] as usize], self.points[ends[1 - end] as usize])
    }

    /// The ways along the edges at each sample.
    pub(crate) fn ways(&self) -> Vec<Vec<[f64; 2]>> {
        self.incident().iter().map(|at| at.iter().map(|e| self.way(*e)).collect()).collect()
    }

    /// Keeps some samples, and the edges between them. Given ones must be kept.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        let mut new = vec![u32::MAX; self.len()];
        let mut count = 0;
        for s in (0..keep.len()).filter(|s| keep[*s]) {
            new[s] = count;
            self.points[count as usize] = self.points[s];
            self.source[count as usize] = self.source[s];
            self.style[count as usize] = self.style[s];
            count += 1;
        }
        self.points.truncate(count as usize);
        self.source.truncate(count as usize);
        self.style.truncate(count as usize);
        self.edges.retain_mut(|e| {
            e.ends = e.ends.map(|s| new[s as usize]);
            e.ends.iter().all(|s| *s != u32::MAX)
        });
    }

    /// Lets each end of an edge follow a half-edge of the source of its sample, which gives the edge its direction and
    /// course there: that of the nearest direction. No two follow the same. Where a given curve goes on, the edge follows
    /// that.
    pub(crate) fn improve_orientations(&mut self, input: &CurveInput) {
        for (s, at) in self.incident().iter().enumerate() {
            if self.ahead(s as u32).is_some() {
                continue;
            }
            let leaving = &input.graph.leaving[self.source[s] as usize];
            let mut pairs = Vec::new();
            for (k, &of) in at.iter().enumerate() {
                let way = unit(self.way(of));
                for &half in leaving {
                    let like = input.graph.edge(half).style == self.edges[of.0 as usize].style;
                    let own = unit(input.graph.way(half));
                    let cosine = way[0] * own[0] + way[1] * own[1];
                    if like && cosine > FOLLOWS {
                        pairs.push((cosine, k, half));
                    }
                }
                self.edges[of.0 as usize].from[of.1] = None;
            }
            pairs.sort_by(|p, q| q.0.total_cmp(&p.0).then((p.1, p.2).cmp(&(q.1, q.2))));
            let mut taken = Vec::new();
            for (_, k, half) in pairs {
                let from = &mut self.edges[at[k].0 as usize].from[at[k].1];
                if from.is_none() && !taken.contains(&half) {
                    *from = Some(half);
                    taken.push(half);
                }
            }
        }
    }

    /// The graph of the curves along all edges, or along those that are made. Where a given curve goes on, they do so in
    /// its direction.
    pub(crate) fn graph(&self, input: &CurveInput, made: bool) -> CurveGraph {
        let first = if made { self.given_edges } else { 0 };
        let mut leaving = vec![0u32; self.given()];
        for s in self.made_edges().iter().flat_map(|e| e.ends).filter(|s| (*s as usize) < self.given()) {
            leaving[s as usize] += 1;
        }
        // Where several edges leave an end, none of them goes on alone.
        let ahead = |e: usize| {
            let goes_on =
                |s: u32| self.ahead(s).filter(|_| e >= self.given_edges && leaving[s as usize] == 1);
            self.edges[e].ends.map(goes_on)
        };
        let numbers: Vec<usize> = (first..self.edges.len()).collect();
        let is_led = |e: usize| ahead(e).iter().any(Option::is_some);
        let mut shapes: Vec<Vec<[f64; 2]>> = vec![Vec::new(); self.edges.len()];
        for &e in numbers.iter().filter(|e| !is_led(**e)) {
            shapes[e] = self.course(e as u32, input);
        }
        let incident = self.incident();
        for &e in numbers.iter().filter(|e| is_led(**e)) {
            let edge = &self.edges[e];
            // The other end takes over the direction of the edge that follows.
            let direction = |d: usize| {
                ahead(e)[d].or_else(|| match incident[edge.ends[d] as usize][..] {
                    [a, b] => {
                        let (next, side) = if a.0 as usize == e { b } else { a };
                        let course = &shapes[next as usize];
                        (course.len() > 1).then(|| leaving_direction(course, side).map(|v| -v))
                    }
                    _ => edge.from[d].map(|half| input.graph.tangent(half)),
                })
            };
            shapes[e] = led(self.way((e as u32, 0)), [direction(0), direction(1)]);
        }
        let edge = |e: usize| CurveEdge {
            ends: self.edges[e].ends,
            shape: std::mem::take(&mut shapes[e]),
            style: self.edges[e].style,
        };
        let edges = numbers.into_iter().map(edge).collect();
        CurveGraph::new(self.plane, self.points.clone(), vec![false; self.len()], edges)
    }

    /// The course of an edge: that of the half-edge which it follows, sheared to its own way; where its ends follow two,
    /// from the one to the other.
    fn course(&self, e: u32, input: &CurveInput) -> Vec<[f64; 2]> {
        let way = self.way((e, 0));
        let sheared = |half: u32, backwards: bool| {
            let course = input.graph.course(if backwards { half ^ 1 } else { half });
            let total = along(&course).max(1e-9);
            let last = course[course.len() - 1];
            let (mut walked, mut before) = (0.0, course[0]);
            let step = |p: &[f64; 2]| {
                walked += along(&[before, *p]);
                before = *p;
                let t = walked / total;
                ([p[0] + t * (way[0] - last[0]), p[1] + t * (way[1] - last[1])], t)
            };
            course.iter().map(step).collect::<Vec<_>>()
        };
        let plain = |course: Vec<([f64; 2], f64)>| course.into_iter().map(|c| c.0).collect();
        match self.edges[e as usize].from {
            [Some(a), Some(b)] if a ^ 1 == b => plain(sheared(a, false)),
            [Some(a), None] => plain(sheared(a, false)),
            [None, Some(b)] => plain(sheared(b, true)),
            [None, None] => vec![[0.0; 2], way],
            [Some(a), Some(b)] => {
                let (a, b) = (sheared(a, false), sheared(b, true));
                let blend = |k: usize| {
                    let t = k as f64 / BLENDED as f64;
                    let weight = t * t * (3.0 - 2.0 * t);
                    let (p, q) = (at_share(&a, t), at_share(&b, t));
                    [p[0] + weight * (q[0] - p[0]), p[1] + weight * (q[1] - p[1])]
                };
                (0..=BLENDED).map(blend).collect()
            }
        }
    }

    /// Samples at the distance of another level along the curves that are made, after those `given` there. Each has the
    /// nearest sample of that level where the samples so far come from.
    pub(crate) fn resampled(&self, input: &CurveInput, next: &CurveInput, given: Self) -> Self {
        let graph = self.graph(input, true).sampled(next.scale.distance);
        let reach = 1.5 * input.scale.distance;
        let index = PointIndex::new(self.plane, reach, &self.points);
        let standing = PointIndex::new(self.plane, reach, &given.points);
        let numbers: Vec<usize> = (0..graph.points.len()).collect();
        // The given sample that a node stands for, or the source of a new one.
        let of_node = vtex_base::parallel::map(&numbers, |&n| {
            let (at, leaving) = (graph.points[n], &graph.leaving[n]);
            let style = leaving.first().map(|h| graph.edge(*h).style);
            let mut nearest: Option<(f64, u32, [f64; 2])> = None;
            let mut is_given = false;
            index.within(at, reach, |s, way| {
                let far = way[0] * way[0] + way[1] * way[1];
                is_given |= s < self.given() && far == 0.0;
                let better = nearest.is_none_or(|b| far < b.0 || far == b.0 && (s as u32) < b.1);
                if Some(self.style[s]) == style && better {
                    nearest = Some((far, s as u32, way));
                }
            });
            if is_given {
                return standing.nearest(at, reach).map(|(g, _)| (Some(g as u32), 0));
            }
            let (_, s, way) = nearest?;
            let from = input.graph.points[self.source[s as usize] as usize];
            let source = next.nearest_like([from[0] - way[0], from[1] - way[1]], (style?, leaving.len()))?;
            Some((None, source))
        });
        let mut new = given;
        let mut number = vec![u32::MAX; graph.points.len()];
        for (n, found) in of_node.into_iter().enumerate() {
            match found {
                Some((Some(given), _)) => number[n] = given,
                Some((None, source)) => {
                    number[n] = new.push(graph.points[n], source, next);
                    new.style[number[n] as usize] = graph.edge(graph.leaving[n][0]).style;
                }
                None => {}
            }
        }
        for edge in &graph.edges {
            let ends = edge.ends.map(|n| number[n as usize]);
            if ends.iter().all(|s| *s != u32::MAX) && ends[0] != ends[1] {
                new.edges.push(JoinedEdge { ends, from: [None; 2], style: edge.style });
            }
        }
        // All levels list the exemplar's elements in one order.
        for (at, number) in self.elements(input) {
            new.push(at, next.graph.elements[number].node, next);
        }
        new.improve_orientations(next);
        new
    }
}

impl CurveInput {
    /// The sample nearest to a place, one of a style and a number of edges if there is one about as near.
    fn nearest_like(&self, at: [f64; 2], (style, degree): (u32, usize)) -> Option<u32> {
        let delta = self.scale.distance;
        let mut best: Option<(f64, u32)> = None;
        self.index.within(at, 2.0 * delta, |i, way| {
            let other = usize::from(self.graph.degree(i) != degree) + 2 * usize::from(self.style[i] != style);
            let cost = libm::sqrt(way[0] * way[0] + way[1] * way[1]) + delta * other as f64;
            if best.is_none_or(|b| cost < b.0 || cost == b.0 && (i as u32) < b.1) {
                best = Some((cost, i as u32));
            }
        });
        best.map(|b| b.1)
    }
}

/// A curve along a way, with the directions of length 1 into it from its ends: a cubic by Hermite. An end without a
/// direction bends as the other one asks.
fn led(way: [f64; 2], directions: [Option<[f64; 2]>; 2]) -> Vec<[f64; 2]> {
    let size = libm::sqrt(way[0] * way[0] + way[1] * way[1]);
    let leave = directions[0].map(|a| [size * a[0], size * a[1]]);
    let arrive = directions[1].map(|a| [-size * a[0], -size * a[1]]);
    // The tangent at the free end of a parabola.
    let other = |t: [f64; 2]| [2.0 * way[0] - t[0], 2.0 * way[1] - t[1]];
    let (leave, arrive) = match (leave, arrive) {
        (Some(a), Some(b)) => (a, b),
        (Some(a), None) => (a, other(a)),
        (None, Some(b)) => (other(b), b),
        (None, None) => (way, way),
    };
    let point = |k: usize| {
        let t = k as f64 / BLENDED as f64;
        let (from, to) = (t * (1.0 - t) * (1.0 - t), t * t * (t - 1.0));
        let share = t * t * (3.0 - 2.0 * t);
        [0, 1].map(|i| share * way[i] + from * leave[i] + to * arrive[i])
    };
    (0..=BLENDED).map(point).collect()
}

/// The direction in which a course leaves its beginning, or its end.
fn leaving_direction(course: &[[f64; 2]], end: usize) -> [f64; 2] {
    let last = course.len() - 1;
    let [from, to] = if end == 0 { [course[0], course[1]] } else { [course[last], course[last - 1]] };
    unit([to[0] - from[0], to[1] - from[1]])
}

/// A direction of length 1, or nothing.
pub(crate) fn unit(v: [f64; 2]) -> [f64; 2] {
    let size = libm::sqrt(v[0] * v[0] + v[1] * v[1]);
    if size > 0.0 { [v[0] / size, v[1] / size] } else { [0.0; 2] }
}

/// The point of a course at a share of its length.
fn at_share(course: &[([f64; 2], f64)], t: f64) -> [f64; 2] {
    let k = course.partition_point(|c| c.1 < t).clamp(1, course.len() - 1);
    let [(a, from), (b, to)] = [course[k - 1], course[k]];
    let part = if to > from { ((t - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
}
