//! The samples of the exemplar on one level, and their neighbourhoods.

use crate::graph::CurveGraph;
use vtex_base::error::Result;
use vtex_base::geometry::coherence::SourcePoints;
use vtex_base::geometry::dense::DenseAssignment;
use vtex_base::geometry::plane::{PointIndex, Vicinity, length};
use vtex_base::parallel;

/// Weight of differences between edges, as against differences of places (γ of equation 2.8).
pub(crate) const EDGE_WEIGHT: f64 = 0.5;
/// Cost of another style, in sample distances.
const STYLE: f64 = 2.0;
/// Cost of an element in place of a curve, or of a curve in place of an element, in sample distances.
const ELEMENT: f64 = 4.0;
/// Most neighbours of a sample of the exemplar, and of the result.
const MOST_NEAR: usize = 64;
pub(crate) const MOST_NEAR_OUTPUT: usize = 40;
/// Samples with alike surroundings that are known of each, and parts of the circle that describe surroundings.
const SIMILAR: usize = 4;
const SECTORS: usize = 8;
/// Most samples that are compared by their surroundings.
const MOST_COMPARED: usize = 3000;
/// Most edges at samples of which all matches are tried.
const MOST_TRIED: usize = 4;

/// Lengths of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurveScale {
    /// Distance of samples along a curve (δ).
    pub(crate) distance: f64,
    /// Radius of neighbourhoods (r).
    pub(crate) radius: f64,
}

/// The exemplar's samples.
pub(crate) struct CurveInput {
    pub(crate) graph: CurveGraph,
    pub(crate) scale: CurveScale,
    pub(crate) index: PointIndex,
    pub(crate) near: Vicinity,
    /// The ways along the edges at each sample.
    pub(crate) ways: Vec<Vec<[f64; 2]>>,
    /// The style of each: that of its first edge, or of its element.
    pub(crate) style: Vec<u32>,
    /// The styles of elements, ascending.
    element_styles: Vec<u32>,
    similar: Vec<Vec<u32>>,
    /// Whether edges count in comparisons.
    pub(crate) with_edges: bool,
    /// Whether samples may be left without a match where neighbourhoods are compared.
    pub(crate) is_robust: bool,
}

impl CurveInput {
    /// The samples of a graph of curves.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn new(
        curves: &CurveGraph,
        scale: CurveScale,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let mut made = Self::alone(curves, scale);
        go_on()?;
        made.similar = made.alike();
        go_on()?;
        Ok(made)
    }

    /// The samples of a graph of curves, without what is known of similar ones.
    pub(crate) fn alone(curves: &CurveGraph, scale: CurveScale) -> Self {
        let graph = curves.sampled(scale.distance);
        let index = PointIndex::new(graph.plane, scale.radius, &graph.points);
        let near = Vicinity::new(&index, &graph.points, scale.radius, (MOST_NEAR, true));
        let ways: Vec<Vec<[f64; 2]>> =
            graph.leaving.iter().map(|l| l.iter().map(|h| graph.way(*h)).collect()).collect();
        let of_edges = |l: &Vec<u32>| l.first().map_or(0, |h| graph.edge(*h).style);
        let mut style: Vec<u32> = graph.leaving.iter().map(of_edges).collect();
        graph.elements.iter().for_each(|e| style[e.node as usize] = e.style);
        let mut element_styles: Vec<u32> = graph.elements.iter().map(|e| e.style).collect();
        element_styles.sort_unstable();
        element_styles.dedup();
        let (similar, with_edges, is_robust) = (Vec::new(), true, true);
        Self { graph, scale, index, near, ways, style, element_styles, similar, with_edges, is_robust }
    }

    pub(crate) fn len(&self) -> usize {
        self.graph.points.len()
    }

    /// Whether a style is that of elements.
    pub(crate) fn is_of_elements(&self, style: u32) -> bool {
        self.element_styles.binary_search(&style).is_ok()
    }

    /// The samples, for a search.
    pub(crate) fn sources(&self) -> SourcePoints<'_> {
        let Self { graph, index, near, .. } = self;
        let (plane, points) = (graph.plane, &graph.points);
        SourcePoints { plane, points, index, near, distance: self.scale.distance }
    }

    /// Samples whose surroundings resemble those of a sample.
    pub(crate) fn similar(&self, sample: u32) -> &[u32] {
        self.similar.get(sample as usize).map_or(&[], |s| s)
    }

    /// What tells a sample of the result from one of the exemplar, but for their places: edges (equation 2.5) and
    /// styles. A sample without edges is new, and its edges do not count.
    pub(crate) fn unlike(&self, (ways, style): (&[[f64; 2]], u32), i: u32) -> f64 {
        let i = i as usize;
        let delta = self.scale.distance;
        let styles = match (style, self.style[i]) {
            (a, b) if a == b => 0.0,
            (a, b) if self.is_of_elements(a) != self.is_of_elements(b) => ELEMENT * delta,
            _ => STYLE * delta,
        };
        if !self.with_edges || ways.is_empty() {
            return styles;
        }
        styles + EDGE_WEIGHT * edge_difference(ways, &self.ways[i], delta)
    }

    /// For each sample the samples with the most similar surroundings elsewhere.
    fn alike(&self) -> Vec<Vec<u32>> {
        let count = self.len();
        if count > MOST_COMPARED {
            return Vec::new();
        }
        let all: Vec<usize> = (0..count).collect();
        let descriptors: Vec<Vec<f64>> = parallel::map(&all, |&s| self.descriptor(s));
        parallel::map(&all, |&s| {
            let distance = |t: usize| -> f64 {
                descriptors[s].iter().zip(&descriptors[t]).map(|(a, b)| (a - b) * (a - b)).sum()
            };
            let mut best: Vec<(f64, u32)> = (0..count)
                .filter(|&t| t != s && self.style[t] == self.style[s])
                .map(|t| (distance(t), t as u32))
                .collect();
            if best.len() > SIMILAR {
                best.select_nth_unstable_by(SIMILAR, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                best.truncate(SIMILAR);
            }
            best.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            best.into_iter().map(|b| b.1).collect()
        })
    }

    /// How many samples lie in each direction, near and far, and how the sample's own edges leave.
    pub(crate) fn descriptor(&self, s: usize) -> Vec<f64> {
        let mut all = vec![0.0; 3 * SECTORS];
        let mut add = |ring: usize, way: [f64; 2], weight: f64| {
            let turn = libm::atan2(way[1], way[0]) / std::f64::consts::TAU * SECTORS as f64;
            let low = libm::floor(turn);
            let part = turn - low;
            let sector = (low as i64).rem_euclid(SECTORS as i64) as usize;
            all[ring * SECTORS + sector] += weight * (1.0 - part);
            all[ring * SECTORS + (sector + 1) % SECTORS] += weight * part;
        };
        for k in self.near.range(s) {
            let way = self.near.ways[k];
            add(usize::from(length(way) > 0.6 * self.scale.radius), way, 1.0);
        }
        for way in &self.ways[s] {
            add(2, *way, 3.0);
        }
        all
    }
}

/// Difference of the edges of two samples: the ways along edges that are matched, and `delta` for each edge too many
/// (equation 2.5).
pub(crate) fn edge_difference(a: &[[f64; 2]], b: &[[f64; 2]], delta: f64) -> f64 {
    let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let surplus = delta * (many.len() - few.len()) as f64;
    surplus
        + match few.len() {
            0 => 0.0,
            1..=MOST_TRIED if many.len() <= MOST_TRIED => least_matched(few, many, 0),
            _ => {
                let mut dense = DenseAssignment::default();
                dense.begin(many.len(), 1e9 * delta.max(1e-9));
                for p in few {
                    dense.row(many.iter().map(|q| way_difference(*p, *q)));
                }
                dense.solve()
            }
        }
}

/// The least sum of differences of all `few` from one each of `many` whose bit in `taken` is not set.
fn least_matched(few: &[[f64; 2]], many: &[[f64; 2]], taken: u32) -> f64 {
    let Some((first, rest)) = few.split_first() else {
        return 0.0;
    };
    let free = (0..many.len()).filter(|c| taken >> c & 1 == 0);
    let with = |c: usize| way_difference(*first, many[c]) + least_matched(rest, many, taken | 1 << c);
    free.map(with).fold(f64::INFINITY, f64::min)
}

fn way_difference(a: [f64; 2], b: [f64; 2]) -> f64 {
    length([a[0] - b[0], a[1] - b[1]])
}
