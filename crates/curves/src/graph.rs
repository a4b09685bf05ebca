//! Graphs of curves: nodes at ends, crossings, corners and between, and the edges that join them.

use vtex_base::geometry::plane::{PeriodicPlane, along, length};

/// Cosine of the largest angle between the two sides of a node at which a curve runs through it smoothly: 40°.
const SMOOTH: f64 = 0.766;
/// Share of an edge over which its direction at an end is measured.
const TANGENT: f64 = 0.25;

/// A piece of a curve between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CurveEdge {
    /// The nodes.
    pub(crate) ends: [u32; 2],
    /// Its course: ways from the first node, beginning with none and ending with the way to the second.
    pub(crate) shape: Vec<[f64; 2]>,
    /// Its appearance.
    pub(crate) style: u32,
}

/// A node without edges that stands for an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ElementNode {
    pub(crate) node: u32,
    /// Its number in the exemplar.
    pub(crate) element: u32,
    /// Its appearance, which no edge has.
    pub(crate) style: u32,
}

/// A graph of curves. Half-edge `2 e + d` is edge e as it leaves its end d.
#[derive(Clone, Debug)]
pub struct CurveGraph {
    pub(crate) plane: PeriodicPlane,
    /// The page of which the plane holds copies; the plane itself where it holds one.
    pub(crate) page: PeriodicPlane,
    pub(crate) points: Vec<[f64; 2]>,
    /// Nodes at which the border of the page cuts a curve.
    pub(crate) open: Vec<bool>,
    pub(crate) edges: Vec<CurveEdge>,
    /// The elements, by their nodes.
    pub(crate) elements: Vec<ElementNode>,
    /// The half-edges that leave each node.
    pub(crate) leaving: Vec<Vec<u32>>,
    /// Direction of each half-edge where it leaves, of length 1.
    tangents: Vec<[f64; 2]>,
}

/// A run of edges: half-edges, each from where the one before arrives.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EdgeChain {
    pub(crate) halves: Vec<u32>,
    /// Whether the last arrives where the first leaves, and the curve runs on there.
    pub(crate) closed: bool,
}

impl CurveGraph {
    pub(crate) fn new(
        plane: PeriodicPlane,
        points: Vec<[f64; 2]>,
        open: Vec<bool>,
        edges: Vec<CurveEdge>,
    ) -> Self {
        let mut leaving = vec![Vec::new(); points.len()];
        for (e, edge) in edges.iter().enumerate() {
            for d in 0..2 {
                leaving[edge.ends[d] as usize].push((2 * e + d) as u32);
            }
        }
        let (elements, tangents) = (Vec::new(), Vec::new());
        let mut made = Self { plane, page: plane, points, open, edges, elements, leaving, tangents };
        made.tangents = (0..2 * made.edges.len() as u32).map(|h| tangent(&made.course(h))).collect();
        made
    }

    /// The graph with elements, whose nodes ascend.
    pub(crate) fn with_elements(self, elements: Vec<ElementNode>) -> Self {
        Self { elements, ..self }
    }

    /// The graph as copies of a page.
    pub(crate) fn with_page(self, page: PeriodicPlane) -> Self {
        Self { page, ..self }
    }

    /// The place in the list of elements of the one that a node stands for.
    pub(crate) fn element_at(&self, node: u32) -> Option<usize> {
        self.elements.binary_search_by_key(&node, |e| e.node).ok()
    }

    /// The edge of a half-edge.
    pub(crate) fn edge(&self, half: u32) -> &CurveEdge {
        &self.edges[half as usize / 2]
    }

    /// The node that a half-edge leaves.
    pub(crate) fn start(&self, half: u32) -> u32 {
        self.edge(half).ends[half as usize % 2]
    }

    /// The node that a half-edge arrives at.
    pub(crate) fn end(&self, half: u32) -> u32 {
        self.edge(half).ends[1 - half as usize % 2]
    }

    /// The course of a half-edge: ways from the node that it leaves.
    pub(crate) fn course(&self, half: u32) -> Vec<[f64; 2]> {
        let shape = &self.edge(half).shape;
        if half.is_multiple_of(2) {
            return shape.clone();
        }
        let last = shape[shape.len() - 1];
        shape.iter().rev().map(|w| [w[0] - last[0], w[1] - last[1]]).collect()
    }

    /// The way along a half-edge.
    pub(crate) fn way(&self, half: u32) -> [f64; 2] {
        let shape = &self.edge(half).shape;
        let last = shape[shape.len() - 1];
        if half.is_multiple_of(2) { last } else { [-last[0], -last[1]] }
    }

    /// Direction of a half-edge where it leaves, of length 1.
    pub(crate) fn tangent(&self, half: u32) -> [f64; 2] {
        self.tangents[half as usize]
    }

    /// The number of ends of edges at a node.
    pub(crate) fn degree(&self, node: usize) -> usize {
        self.leaving[node].len()
    }

    /// Sum of the lengths of all edges.
    pub(crate) fn length(&self) -> f64 {
        self.edges.iter().map(|e| along(&e.shape)).sum()
    }

    /// For each half-edge the one that carries its curve on beyond the node that it leaves, if one does: pairs of nearly
    /// opposite directions and of one style, the straightest first. With `through`, a curve also turns a corner at a node
    /// of two ends; without, only smooth nodes of two ends are passed.
    pub(crate) fn continuations(&self, through: bool) -> Vec<Option<u32>> {
        let mut next = vec![None; 2 * self.edges.len()];
        for leaving in &self.leaving {
            if leaving.len() < 2 || !through && leaving.len() != 2 {
                continue;
            }
            let tangents: Vec<[f64; 2]> = leaving.iter().map(|h| self.tangent(*h)).collect();
            let mut pairs = Vec::new();
            for a in 0..leaving.len() {
                for b in a + 1..leaving.len() {
                    let opposite = -(tangents[a][0] * tangents[b][0] + tangents[a][1] * tangents[b][1]);
                    let runs_on = opposite > SMOOTH || through && leaving.len() == 2;
                    if runs_on && self.edge(leaving[a]).style == self.edge(leaving[b]).style {
                        pairs.push((opposite, a, b));
                    }
                }
            }
            pairs.sort_by(|p, q| q.0.total_cmp(&p.0).then((p.1, p.2).cmp(&(q.1, q.2))));
            for (_, a, b) in pairs {
                let [a, b] = [leaving[a], leaving[b]];
                if next[a as usize].is_none() && next[b as usize].is_none() {
                    next[a as usize] = Some(b);
                    next[b as usize] = Some(a);
                }
            }
        }
        next
    }

    /// All edges in chains that run through nodes as [`CurveGraph::continuations`] says.
    pub(crate) fn chains(&self, through: bool) -> Vec<EdgeChain> {
        let next = self.continuations(through);
        let mut done = vec![false; self.edges.len()];
        let mut chains = Vec::new();
        // Open chains from their ends, then closed ones.
        for closed in [false, true] {
            for first in 0..2 * self.edges.len() as u32 {
                if done[first as usize / 2] || !closed && next[first as usize].is_some() {
                    continue;
                }
                let mut halves = vec![first];
                done[first as usize / 2] = true;
                let mut half = first;
                while let Some(on) = next[(half ^ 1) as usize] {
                    if done[on as usize / 2] {
                        break;
                    }
                    done[on as usize / 2] = true;
                    halves.push(on);
                    half = on;
                }
                chains.push(EdgeChain { halves, closed });
            }
        }
        chains
    }

    /// Share of the length of all curves that lies in chains of some length.
    pub(crate) fn runs_on(&self, least: f64) -> f64 {
        let chains = self.chains(true);
        let lengths = chains.iter().map(|chain| along(&self.chain_course(chain).0)).filter(|l| *l >= least);
        lengths.sum::<f64>() / self.length().max(1e-9)
    }

    /// The course of a chain, and where each of its edges begins in it.
    pub(crate) fn chain_course(&self, chain: &EdgeChain) -> (Vec<[f64; 2]>, Vec<usize>) {
        let start = self.points[self.start(chain.halves[0]) as usize];
        let (mut course, mut begins) = (vec![start], Vec::with_capacity(chain.halves.len()));
        for &half in &chain.halves {
            begins.push(course.len() - 1);
            let from = course[course.len() - 1];
            course.extend(self.course(half)[1..].iter().map(|w| [from[0] + w[0], from[1] + w[1]]));
        }
        (course, begins)
    }

    /// The graph with samples about every `distance` along its curves, and at all nodes but smooth ones of two ends.
    pub(crate) fn sampled(&self, distance: f64) -> Self {
        const NONE: u32 = u32::MAX;
        let mut new = vec![NONE; self.points.len()];
        let (mut points, mut open, mut edges) = (Vec::new(), Vec::new(), Vec::new());
        for chain in self.chains(false) {
            let (course, _) = self.chain_course(&chain);
            let total = along(&course);
            let (first, last) = (self.start(chain.halves[0]), self.end(chain.halves[chain.halves.len() - 1]));
            let least = if chain.closed || first == last { 3.0 } else { 1.0 };
            let count = libm::round(total / distance).max(least) as usize;
            let mut node = |of: u32, points: &mut Vec<[f64; 2]>, open: &mut Vec<bool>| {
                if new[of as usize] == NONE {
                    new[of as usize] = points.len() as u32;
                    points.push(self.points[of as usize]);
                    open.push(self.open[of as usize]);
                }
                new[of as usize]
            };
            let begin = node(first, &mut points, &mut open);
            let mut from = begin;
            for (k, piece) in pieces(&course, count).into_iter().enumerate() {
                let end = if k + 1 < count {
                    let at = piece[piece.len() - 1];
                    points.push(self.plane.wrapped(at));
                    open.push(false);
                    points.len() as u32 - 1
                } else if chain.closed {
                    begin
                } else {
                    node(last, &mut points, &mut open)
                };
                let at = piece[0];
                let shape = piece.iter().map(|p| [p[0] - at[0], p[1] - at[1]]).collect();
                edges.push(CurveEdge { ends: [from, end], shape, style: self.edge(chain.halves[0]).style });
                from = end;
            }
        }
        let mut elements = self.elements.clone();
        for element in &mut elements {
            points.push(self.points[element.node as usize]);
            open.push(false);
            element.node = points.len() as u32 - 1;
        }
        Self::new(self.plane, points, open, edges).with_elements(elements).with_page(self.page)
    }
}

/// Direction at the beginning of a course, of length 1.
pub(crate) fn tangent(course: &[[f64; 2]]) -> [f64; 2] {
    let reach = TANGENT * along(course);
    let (mut walked, mut at) = (0.0, course[0]);
    for pair in course.windows(2) {
        at = pair[1];
        walked += length([pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]]);
        if walked >= reach {
            break;
        }
    }
    let way = [at[0] - course[0][0], at[1] - course[0][1]];
    let size = length(way);
    if size > 0.0 { [way[0] / size, way[1] / size] } else { [1.0, 0.0] }
}

/// A course cut into `count` pieces of the same length.
fn pieces(course: &[[f64; 2]], count: usize) -> Vec<Vec<[f64; 2]>> {
    let total = along(course);
    let mut all = Vec::with_capacity(count);
    let mut piece = vec![course[0]];
    let mut walked = 0.0;
    for pair in course.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let step = length([b[0] - a[0], b[1] - a[1]]);
        while all.len() + 1 < count {
            let wanted = total * (all.len() + 1) as f64 / count as f64;
            if wanted >= walked + step {
                break;
            }
            let t = if step > 0.0 { ((wanted - walked) / step).clamp(0.0, 1.0) } else { 0.0 };
            let at = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
            piece.push(at);
            all.push(std::mem::replace(&mut piece, vec![at]));
        }
        piece.push(b);
        walked += step;
    }
    // Rounding may leave the last cuts at the end itself.
    while all.len() + 1 < count {
        let at = piece[piece.len() - 1];
        all.push(std::mem::replace(&mut piece, vec![at]));
    }
    all.push(piece);
    for piece in &mut all {
        piece.dedup();
        if piece.len() < 2 {
            piece.push(piece[0]);
        }
    }
    all
}

impl CurveGraph {
    /// The graph on another plane, moved by a way.
    pub(crate) fn placed(&self, plane: PeriodicPlane, by: [f64; 2]) -> Self {
        let points = self.points.iter().map(|p| [p[0] + by[0], p[1] + by[1]]).collect();
        let elements = self.elements.clone();
        Self::new(plane, points, self.open.clone(), self.edges.clone()).with_elements(elements)
    }

    /// The graph with lengths along x and y multiplied.
    pub(crate) fn stretched(&self, by: [f64; 2]) -> Self {
        let scaled = |p: &[f64; 2]| [p[0] * by[0], p[1] * by[1]];
        let plane = PeriodicPlane { size: scaled(&self.plane.size), ..self.plane };
        let edges =
            self.edges.iter().map(|e| CurveEdge { shape: e.shape.iter().map(scaled).collect(), ..e.clone() });
        let points = self.points.iter().map(scaled).collect();
        Self::new(plane, points, self.open.clone(), edges.collect()).with_elements(self.elements.clone())
    }

    /// The graph repeated along the axes of a page that repeats.
    pub(crate) fn repeated(&self, times: [usize; 2]) -> Self {
        let [m, n] = times;
        let count = self.points.len();
        let period = self.plane.size;
        let plane =
            PeriodicPlane { size: [period[0] * m as f64, period[1] * n as f64], wraps: self.plane.wraps };
        let (mut points, mut open, mut edges) = (Vec::new(), Vec::new(), Vec::new());
        let mut elements = Vec::with_capacity(self.elements.len() * m * n);
        for j in 0..n {
            for i in 0..m {
                let by = [i as f64 * period[0], j as f64 * period[1]];
                points.extend(self.points.iter().map(|p| [p[0] + by[0], p[1] + by[1]]));
                open.extend(&self.open);
                let copy = ((j * m + i) * count) as u32;
                elements.extend(self.elements.iter().map(|e| ElementNode { node: copy + e.node, ..*e }));
                for edge in &self.edges {
                    let [a, b] = edge.ends.map(|s| s as usize);
                    let way = edge.shape[edge.shape.len() - 1];
                    // The copy of the page in which the edge ends.
                    let copy = |k: usize, at: usize, most: usize| {
                        let periods = (self.points[a][k] + way[k] - self.points[b][k]) / period[k];
                        (at as i64 + libm::round(periods) as i64).rem_euclid(most as i64) as usize
                    };
                    let there = copy(1, j, n) * m + copy(0, i, m);
                    let ends = [((j * m + i) * count + a) as u32, (there * count + b) as u32];
                    edges.push(CurveEdge { ends, ..edge.clone() });
                }
            }
        }
        Self::new(plane, points, open, edges).with_elements(elements).with_page(self.plane)
    }
}
