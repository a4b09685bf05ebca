//! Lines that stand already, and the region beside them that is filled (§2.3, §2.4.2.3).
//!
//! The result is made on a window around the region. Samples of the lines that stand are the first of its samples; they
//! are compared and vote as others do, but keep their places, their edges and their existence. Beside the lines, outside
//! of the region, nothing is made. Elsewhere around the region curves run on and are cut off at its border in the end, so
//! that the border itself leaves no trace in them.

use crate::graph::CurveGraph;
use crate::input::{CurveInput, CurveScale};
use crate::output::{CurveOutput, JoinedEdge};
use crate::search::{choose_sources, search};
use vtex_base::error::Result;
use vtex_base::geometry::plane::PointIndex;
use vtex_base::geometry::{Outline, RegionWindow};
use vtex_base::parallel;

/// Width of the window around the region, in radii of neighbourhoods.
const AROUND: f64 = 2.0;
/// Distance from the lines within which, outside of the region, nothing is made, in radii of neighbourhoods.
const BESIDE: f64 = 1.0;
/// Distance of the points that stand for the lines, in finest sample distances.
const DENSE: f64 = 0.2;
/// Steps in which it is asked whether a loose end leads into the region, and the length of all in finest distances.
const AHEAD: [f64; 5] = [0.02, 0.25, 0.5, 0.75, 1.0];
/// Samples of the exemplar with like surroundings whose neighbourhoods are compared with that of each sample of the lines,
/// and searches for better ones after that.
const CANDIDATES: usize = 24;
const SEARCHES: usize = 3;
/// Most samples of the exemplar that each sample of the lines is compared with first.
const MOST_COMPARED: usize = 3000;

/// Lines that stand already, and the region to be filled beside them.
#[derive(Clone, Debug)]
pub struct CurveContext {
    /// The lines, on the canvas, in the styles of the exemplar.
    pub lines: CurveGraph,
    /// The region, on the canvas.
    pub region: Outline,
    /// A part of the exemplar of which a copy is laid in the region first, the middle of its bounds on that of the
    /// region's. `None`: the region is filled by chance.
    pub source: Option<Outline>,
}

/// A context on the window that is synthesised.
pub(crate) struct GivenLines {
    pub(crate) window: RegionWindow,
    lines: CurveGraph,
    /// Points close to one another along the lines.
    along: PointIndex,
    beside: f64,
    finest: f64,
    /// The way from the window to the part of the exemplar that is copied.
    pub(crate) copied: Option<[f64; 2]>,
}

impl GivenLines {
    /// A context on a canvas of a size. `coarsest` are the lengths of the coarsest level, `finest` the sample distance of
    /// the finest.
    pub(crate) fn new(
        context: &CurveContext,
        canvas: [f64; 2],
        (coarsest, finest): (CurveScale, f64),
    ) -> Self {
        let window = RegionWindow::new(&context.region, canvas, AROUND * coarsest.radius);
        let lines = context.lines.placed(window.plane, window.low.map(|v| -v));
        let dense = lines.sampled(DENSE * finest);
        let along: Vec<[f64; 2]> = dense.points.iter().copied().filter(|p| window.holds(*p)).collect();
        Self {
            lines,
            along: PointIndex::new(window.plane, coarsest.radius, &along),
            beside: BESIDE * coarsest.radius,
            finest,
            copied: context.source.as_ref().map(|source| window.way_to(source)),
            window,
        }
    }

    /// Whether a place of the window lies in the region.
    pub(crate) fn is_inside(&self, at: [f64; 2]) -> bool {
        self.window.is_inside(at)
    }

    /// Whether a place lies in the region, on the canvas or up to `margin` beyond it.
    pub(crate) fn is_shown(&self, at: [f64; 2], margin: f64) -> bool {
        self.window.is_on_canvas(at, margin) && self.is_inside(at)
    }

    /// Whether curves are made at a place: in the region, and around it where no line is near.
    pub(crate) fn is_free(&self, at: [f64; 2]) -> bool {
        self.window.holds(at) && (self.is_inside(at) || !self.along.any(at, self.beside))
    }

    /// Whether a line leads through a place.
    pub(crate) fn is_on_line(&self, at: [f64; 2], reach: f64) -> bool {
        self.along.any(at, reach)
    }

    /// Area of the window in which curves are made.
    pub(crate) fn free_area(&self, spacing: f64) -> f64 {
        let step = 0.5 * spacing;
        self.window.area_of(step, |at| self.is_free(at) && !self.is_on_line(at, step))
    }

    /// The samples of the lines on a level, with the most similar samples of the exemplar.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn samples(&self, input: &CurveInput, go_on: &dyn Fn() -> Result<()>) -> Result<CurveOutput> {
        let own = CurveInput::alone(&self.lines, input.scale);
        go_on()?;
        let chosen: Vec<u32> =
            (0..own.len() as u32).filter(|s| self.window.holds(own.graph.points[*s as usize])).collect();
        let known = input.len().div_ceil(MOST_COMPARED).max(1);
        let others: Vec<u32> = (0..input.len() as u32).step_by(known).collect();
        let of_input = parallel::map(&others, |i| input.descriptor(*i as usize));
        let candidates = parallel::map(&chosen, |s| {
            let descriptor = own.descriptor(*s as usize);
            let cost = |k: usize| -> f64 {
                let far: f64 = descriptor.iter().zip(&of_input[k]).map(|(a, b)| (a - b) * (a - b)).sum();
                // Styles come first.
                let other = own.style[*s as usize] != input.style[others[k] as usize];
                if other { far + 1e6 } else { far }
            };
            let mut all: Vec<(f64, u32)> = (0..others.len()).map(|k| (cost(k), others[k])).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            // Copies of one sample on a page that repeats count once.
            all.dedup_by(|a, b| a.0 - b.0 < 1e-9);
            all.into_iter().take(CANDIDATES).map(|c| c.1).collect::<Vec<u32>>()
        });
        go_on()?;
        let mut output = CurveOutput::new(self.window.plane);
        let mut number = vec![u32::MAX; own.len()];
        for (s, candidates) in chosen.iter().zip(&candidates) {
            let (s, source) = (*s as usize, candidates.first().copied().unwrap_or(0));
            number[s] = output.push(own.graph.points[s], source, input);
            output.style[number[s] as usize] = own.style[s];
            output.ahead.push(self.leads_on(&own.graph, s));
        }
        for edge in &own.graph.edges {
            let ends = edge.ends.map(|s| number[s as usize]);
            if ends.iter().all(|s| *s != u32::MAX) {
                output.edges.push(JoinedEdge { ends, from: [None; 2], style: edge.style });
            }
        }
        output.given_edges = output.edges.len();
        choose_sources(&mut output, input, &candidates, go_on)?;
        for _ in 0..SEARCHES {
            search(&mut output, input, go_on)?;
        }
        Ok(output)
    }

    /// The direction in which a line that ends at a node goes on into the region.
    fn leads_on(&self, graph: &CurveGraph, node: usize) -> Option<[f64; 2]> {
        let [only] = graph.leaving[node][..] else { return None };
        if graph.open[node] {
            return None;
        }
        let [x, y] = graph.tangent(only);
        let at = graph.points[node];
        let leads = |t: &f64| self.is_inside([at[0] - t * self.finest * x, at[1] - t * self.finest * y]);
        AHEAD.iter().any(leads).then_some([-x, -y])
    }
}
