//! Places of samples by least squares: every matched pair asks for the way between its matches (equation 18 of the
//! paper).

use crate::input::InputSamples;
use crate::output::OutputSamples;
use crate::search::Matches;
use vtex_base::error::Result;
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::displace::WantedWays;

/// Moves samples to where matched neighbourhoods want them.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn improve_positions(
    output: &mut OutputSamples,
    input: &InputSamples,
    matches: &Matches,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let near = &matches.near;
    let mut ways = WantedWays::new(near.len());
    for s in 0..near.len() {
        ways.next_point();
        let source = input.points[output.source[s] as usize];
        for k in near.range(s).filter(|&k| matches.matched[k] != NONE) {
            let way = near.ways[k];
            let wanted = input.plane.between(source, input.points[matches.matched[k] as usize]);
            ways.add(near.ids[k], [wanted[0] - way[0], wanted[1] - way[1]]);
        }
    }
    let moved = ways.displacements(go_on)?;
    for (p, by) in output.points.iter_mut().zip(&moved) {
        *p = output.plane.wrapped([p[0] + by[0], p[1] + by[1]]);
    }
    Ok(())
}
