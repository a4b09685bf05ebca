//! Places of samples by least squares: matched pairs ask for the way between their matches (equation 2.14), edges for
//! the ways that they follow.

use crate::input::CurveInput;
use crate::output::{CurveOutput, unit};
use vtex_base::error::Result;
use vtex_base::geometry::coherence::NeighbourhoodMatches;
use vtex_base::geometry::plane::length;

/// Weight of the direction in which a given curve goes on, in neighbourhoods.
const AHEAD: usize = 12;
/// Change of a way between a given sample and another from which on it counts the less, in sample distances.
const DOUBTFUL: f64 = 0.25;

/// Moves samples to where matched neighbourhoods and edges want them; given ones stay.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn improve_positions(
    output: &mut CurveOutput,
    input: &CurveInput,
    matches: &NeighbourhoodMatches,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let incident = output.incident();
    let along = given_directions(output);
    let given = output.given();
    // Samples stand anywhere along given lines, so only ways across them count. These are all that holds the rest in its
    // place, so a few wrong matches must not move it.
    let across = |s: usize, other: u32, change: [f64; 2]| {
        if s >= given && other as usize >= given {
            return change;
        }
        let of = |sample: usize| along.get(sample).copied().flatten();
        let line = of(s).or_else(|| of(other as usize)).unwrap_or_default();
        let part = line[0] * change[0] + line[1] * change[1];
        let change = [change[0] - part * line[0], change[1] - part * line[1]];
        let ratio = length(change) / (DOUBTFUL * input.scale.distance);
        change.map(|v| v / (1.0 + ratio * ratio))
    };
    let ways = matches.wanted_ways(&output.source, input.sources(), across, |s, ways| {
        let made = |of: &&(u32, usize)| of.0 as usize >= output.given_edges;
        if let Some(ahead) = output.ahead(s as u32)
            && let [(e, d)] = incident[s].iter().filter(made).collect::<Vec<_>>()[..]
        {
            let way = output.way((*e, *d));
            let far = length(way);
            let change = [far * ahead[0] - way[0], far * ahead[1] - way[1]];
            let other = output.edges[*e as usize].ends[1 - d];
            (0..AHEAD).for_each(|_| ways.add(other, change));
        }
        for &(e, d) in &incident[s] {
            if let Some(half) = output.edges[e as usize].from[d] {
                let (way, wanted) = (output.way((e, d)), input.graph.way(half));
                ways.add(output.edges[e as usize].ends[1 - d], [wanted[0] - way[0], wanted[1] - way[1]]);
            }
        }
    });
    ways.with_fixed(given).move_points(&mut output.points, output.plane, go_on)
}

/// The direction of the line through each given sample, unless lines meet there.
fn given_directions(output: &CurveOutput) -> Vec<Option<[f64; 2]>> {
    let mut ways: Vec<Vec<[f64; 2]>> = vec![Vec::new(); output.given()];
    for e in 0..output.given_edges {
        for d in 0..2 {
            ways[output.edges[e].ends[d] as usize].push(output.way((e as u32, d)));
        }
    }
    let direction = |ways: &Vec<[f64; 2]>| match ways[..] {
        [way] => Some(unit(way)),
        [a, b] => Some(unit([a[0] - b[0], a[1] - b[1]])),
        _ => None,
    };
    ways.iter().map(direction).collect()
}
