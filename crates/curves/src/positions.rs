//! Places of samples by least squares: matched pairs ask for the way between their matches (equation 2.14), edges for
//! the ways that they follow.

use crate::input::CurveInput;
use crate::output::CurveOutput;
use crate::search::CurveMatches;
use vtex_base::error::Result;
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::displace::WantedWays;

/// Moves samples to where matched neighbourhoods and edges want them.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn improve_positions(
    output: &mut CurveOutput,
    input: &CurveInput,
    matches: &CurveMatches,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let near = &matches.near;
    let incident = output.incident();
    let mut ways = WantedWays::new(near.len());
    for s in 0..near.len() {
        ways.next_point();
        let source = input.graph.points[output.source[s] as usize];
        for k in near.range(s).filter(|&k| matches.matched[k] != NONE) {
            let way = near.ways[k];
            let wanted = input.graph.plane.between(source, input.graph.points[matches.matched[k] as usize]);
            ways.add(near.ids[k], [wanted[0] - way[0], wanted[1] - way[1]]);
        }
        for &(e, d) in &incident[s] {
            if let Some(half) = output.edges[e as usize].from[d] {
                let (way, wanted) = (output.way((e, d)), input.graph.way(half));
                ways.add(output.edges[e as usize].ends[1 - d], [wanted[0] - way[0], wanted[1] - way[1]]);
            }
        }
    }
    let moved = ways.displacements(go_on)?;
    for (p, by) in output.points.iter_mut().zip(&moved) {
        *p = output.plane.wrapped([p[0] + by[0], p[1] + by[1]]);
    }
    Ok(())
}
