//! Places of samples by least squares: every matched pair asks for the way between its matches (equation 18 of the
//! paper).

use crate::input::InputSamples;
use crate::output::OutputSamples;
use vtex_base::error::Result;
use vtex_base::geometry::coherence::NeighbourhoodMatches;

/// Moves samples to where matched neighbourhoods want them; those of elements that stand stay.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn improve_positions(
    output: &mut OutputSamples,
    input: &InputSamples,
    matches: &NeighbourhoodMatches,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let ways = matches.wanted_ways(&output.source, input.sources(), |_, _, change| change, |_, _| {});
    ways.with_fixed(output.given[0]).move_points(&mut output.points, output.plane, go_on)
}
