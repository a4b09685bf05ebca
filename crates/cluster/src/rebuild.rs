//! Clusters become elements again (§6.6 of the paper), and elements clusters for the next level.

use crate::board::{Board, BoardElement};
use crate::input::InputSamples;
use crate::output::OutputSamples;
use crate::relations::PlaceRelations;
use crate::shape_energy::shape_match;
use vtex_base::geometry::dense::{DenseAssignment, NONE};
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::parallel;

/// The samples of the elements on a canvas, each with its own sample of the exemplar as source.
pub(crate) fn sampled(board: &Board<'_>, input: &InputSamples) -> OutputSamples {
    let mut output = OutputSamples::new(board.plane);
    for element in board.standing() {
        let figure = &input.of_figure[input.figure[element.place as usize] as usize];
        for (way, source) in figure.iter().zip(input.cluster(element.place)) {
            output.points.push(board.plane.wrapped([element.at[0] + way[0], element.at[1] + way[1]]));
            output.cluster.push(output.clusters);
            output.source.push(source as u32);
        }
        output.copied.extend(input.cluster(element.place).map(|s| s as u32));
        output.clusters += 1;
    }
    output
}

/// The elements that clusters resemble most, and for each cluster the number of its element, or [`NONE`] if it resembles
/// none: if its samples are on average more than twice the sample distance from those of the element.
pub(crate) fn rebuilt<'a>(
    output: &OutputSamples,
    input: &InputSamples,
    relations: &'a PlaceRelations<'a>,
    plane: PeriodicPlane,
) -> (Board<'a>, Vec<u32>) {
    let members = output.members();
    let found = parallel::map(&members, |members| {
        let placeable = |place: u32| input.placeable[place as usize];
        let found = shape_match(output, input, members, placeable, &mut DenseAssignment::default());
        found.filter(|m| m.energy <= members.len() as f64)
    });
    let mut board = Board::new(plane, relations);
    let of = |found: Option<crate::shape_energy::ShapeMatch>| match found {
        Some(m) => board.add(BoardElement { place: m.place, at: m.by }) as u32,
        None => NONE,
    };
    let of_cluster = found.into_iter().map(of).collect();
    (board, of_cluster)
}
