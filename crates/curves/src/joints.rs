//! The edges of a first arrangement: within patches, across their borders, and from given lines.

use crate::input::CurveInput;
use crate::output::{CurveOutput, JoinedEdge};
use vtex_base::geometry::plane::{PointIndex, length};

/// Longest miss of two ends that are joined across a border, in sample distances, and the cosine of their largest angle.
const JOINED: f64 = 1.3;
const STRAIGHT: f64 = 0.5;

/// A patch of the canvas: its corner, its size, the way from the canvas to the exemplar, and its samples by their
/// sources.
pub(crate) struct Patch {
    pub(crate) low: [f64; 2],
    pub(crate) size: [f64; 2],
    pub(crate) offset: Option<[f64; 2]>,
    pub(crate) samples: Vec<(u32, u32)>,
}

impl Patch {
    pub(crate) fn middle(&self) -> [f64; 2] {
        [0, 1].map(|k| self.low[k] + 0.5 * self.size[k])
    }
}

/// A curve that leaves a patch, or that is given and goes on.
struct Loose {
    sample: u32,
    /// The half-edge of the exemplar that it follows.
    half: Option<u32>,
    style: u32,
    /// The way along it, and where it would arrive.
    way: [f64; 2],
    to: [f64; 2],
}

/// The edges within patches, and across their borders.
pub(crate) fn join(output: &mut CurveOutput, patches: &[Patch], input: &CurveInput) {
    let delta = input.scale.distance;
    let mut loose: Vec<Loose> = Vec::new();
    for (s, ahead) in output.ahead.iter().enumerate() {
        if let Some(ahead) = ahead {
            let (at, way) = (output.points[s], ahead.map(|v| delta * v));
            let to = [at[0] + way[0], at[1] + way[1]];
            loose.push(Loose { sample: s as u32, half: None, style: output.style[s], way, to });
        }
    }
    for patch in patches {
        let Some(offset) = patch.offset else { continue };
        let half = patch.size.map(|s| 0.5 * s);
        let middle = patch.middle();
        for &(source, sample) in &patch.samples {
            let centre = [0, 1].map(|k| middle[k] + offset[k]);
            let from = input.graph.plane.between(centre, input.graph.points[source as usize]);
            for &h in &input.graph.leaving[source as usize] {
                let way = input.graph.way(h);
                let at = [from[0] + way[0], from[1] + way[1]];
                let inside = (0..2).all(|k| -half[k] <= at[k] && at[k] < half[k]);
                let end = input.graph.end(h);
                let other = patch.samples.binary_search_by_key(&end, |s| s.0);
                match other {
                    Ok(k) if inside => {
                        if h.is_multiple_of(2) {
                            let ends = [sample, patch.samples[k].1];
                            let from = [Some(h), Some(h ^ 1)];
                            output.edges.push(JoinedEdge { ends, from, style: input.graph.edge(h).style });
                        }
                    }
                    _ => {
                        let to = [middle[0] + at[0], middle[1] + at[1]];
                        let style = input.graph.edge(h).style;
                        loose.push(Loose { sample, half: Some(h), style, way, to });
                    }
                }
            }
        }
    }
    let places: Vec<[f64; 2]> = loose.iter().map(|l| output.points[l.sample as usize]).collect();
    let index = PointIndex::new(output.plane, JOINED * delta, &places);
    let mut pairs = Vec::new();
    for (g, own) in loose.iter().enumerate() {
        let way = own.way;
        index.within(output.plane.wrapped(own.to), JOINED * delta, |h, miss| {
            let other = &loose[h];
            let back = output.plane.between(output.plane.wrapped(other.to), places[g]);
            let there = other.way;
            let opposite =
                -(way[0] * there[0] + way[1] * there[1]) / (length(way) * length(there)).max(1e-12);
            if h > g
                && own.sample != other.sample
                && own.style == other.style
                && length(back) < JOINED * delta
                && opposite > STRAIGHT
            {
                pairs.push((length(miss) + length(back) + delta * (1.0 - opposite), g, h));
            }
        });
    }
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))));
    let mut taken = vec![false; loose.len()];
    for (_, g, h) in pairs {
        if !taken[g] && !taken[h] {
            (taken[g], taken[h]) = (true, true);
            let ends = [loose[g].sample, loose[h].sample];
            let from = [loose[g].half, loose[h].half];
            output.edges.push(JoinedEdge { ends, from, style: loose[g].style });
        }
    }
}
