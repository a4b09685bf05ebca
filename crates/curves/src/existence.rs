//! Existence of samples: those that most neighbourhoods leave alone are removed, those that most miss are added
//! (§2.4.3.4 and algorithm 1).

use crate::context::GivenLines;
use crate::input::CurveInput;
use crate::output::CurveOutput;
use vtex_base::geometry::coherence::{MissedGroup, MissedPoint, NeighbourhoodMatches, StandingPoints};
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::length;
use vtex_base::parallel;

/// Distance from a given line within which none is made, in sample distances.
pub(crate) const ON_LINE: f64 = 0.4;
/// Share of the neighbourhoods that keep a sample.
const MAJORITY: f64 = 0.5;

/// Says which samples stay, and where some are missing: beside lines that are given, only where curves are made.
pub(crate) fn improve_existence(
    output: &CurveOutput,
    input: &CurveInput,
    matches: &NeighbourhoodMatches,
    given: Option<&GivenLines>,
) -> (Vec<bool>, Vec<MissedGroup>) {
    let mut held = vec![0u32; matches.near.len()];
    let mut wanted = vec![0u32; matches.near.len()];
    for s in 0..matches.near.len() {
        for k in matches.near.range(s) {
            let other = matches.near.ids[k] as usize;
            held[other] += 1;
            wanted[other] += u32::from(matches.matched[k] != NONE);
        }
    }
    let is_wanted = |s: usize| f64::from(wanted[s]) >= MAJORITY * f64::from(held[s]);
    let keep = (0..held.len()).map(|s| s < output.given() || is_wanted(s)).collect();
    let mut added = missing(output, input, matches);
    let reach = ON_LINE * input.scale.distance;
    added.retain(|m| given.is_none_or(|g| g.is_free(m.at) && !g.is_on_line(m.at, reach)));
    (keep, added)
}

/// The samples that most neighbourhoods around a place miss.
fn missing(output: &CurveOutput, input: &CurveInput, matches: &NeighbourhoodMatches) -> Vec<MissedGroup> {
    let distance = input.scale.distance;
    let rim = input.scale.radius - 0.5 * distance;
    let all: Vec<usize> = (0..matches.near.len()).collect();
    let of_neighbourhood = |&s: &usize| -> Vec<MissedPoint> {
        let (own, centre) = (matches.near.range(s), output.points[s]);
        let there = input.near.range(output.source[s] as usize);
        let inner = there.take_while(|k| length(input.near.ways[*k]) < rim);
        inner
            .filter(|k| {
                let i = input.near.ids[*k];
                !input.graph.open[i as usize] && !matches.matched[own.clone()].contains(&i)
            })
            .map(|k| {
                let way = input.near.ways[k];
                MissedPoint { at: [centre[0] + way[0], centre[1] + way[1]], source: input.near.ids[k] }
            })
            .collect()
    };
    let found: Vec<MissedPoint> = parallel::map(&all, of_neighbourhood).into_iter().flatten().collect();
    let standing = StandingPoints {
        plane: output.plane,
        points: &output.points,
        alike: |a: u32, b: u32| input.style[a as usize] == input.style[b as usize],
        is_of_kind: |s: usize, source: u32| output.style[s] == input.style[source as usize],
    };
    standing.missed(&found, distance, rim)
}
