//! Places of samples by least squares: matched pairs ask for the way between their matches (equation 2.14), edges for
//! the ways that they follow.

use crate::input::CurveInput;
use crate::output::CurveOutput;
use vtex_base::error::Result;
use vtex_base::geometry::coherence::NeighbourhoodMatches;
use vtex_base::geometry::plane::length;

/// Weight of the direction in which a given curve goes on, in neighbourhoods.
const AHEAD: usize = 12;

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
    let ways = matches.wanted_ways(&output.source, input.sources(), |s, ways| {
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
    ways.with_fixed(output.given()).move_points(&mut output.points, output.plane, go_on)
}
