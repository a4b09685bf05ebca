//! Clusters become elements again (§6.6 of the paper), and elements clusters for the next level.

use crate::board::{Board, BoardElement};
use crate::input::InputSamples;
use crate::output::{OutputSamples, in_groups};
use crate::relations::PlaceRelations;
use crate::shape_energy::{ClusterWork, ShapeMatch, shape_match};
use vtex_base::error::Result;
use vtex_base::geometry::dense::NONE;
use vtex_base::geometry::plane::{PeriodicPlane, length};
use vtex_base::parallel;

/// The samples of the elements on a canvas, each with its own sample of the exemplar as source.
pub(crate) fn sampled(board: &Board<'_>, input: &InputSamples) -> OutputSamples {
    let mut output = OutputSamples::new(board.plane);
    for (k, element) in board.standing().into_iter().enumerate() {
        let figure = board.figure(element.place);
        let like = board.relations.like(element.place);
        let from = input.cluster(like);
        let of_like = &input.of_figure[input.figure[like as usize] as usize];
        for (n, way) in input.of_figure[figure as usize].iter().enumerate() {
            let far = |s: &usize| length([of_like[*s][0] - way[0], of_like[*s][1] - way[1]]);
            // An element that stands may have samples of its own.
            let source = match figure == input.figure[like as usize] {
                true => n,
                false => (0..of_like.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0),
            };
            output.points.push(board.plane.wrapped([element.at[0] + way[0], element.at[1] + way[1]]));
            output.cluster.push(output.clusters);
            output.source.push((from.start + source) as u32);
        }
        output.clusters += 1;
        if k < board.given() {
            output.given = [output.points.len(), output.clusters as usize];
        }
    }
    output.copied.clone_from(&output.source);
    output
}

/// The elements that clusters resemble most, and for each cluster the number of its element, or [`NONE`] if it resembles
/// none: if its samples are on average more than twice the sample distance from those of the element.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn rebuilt<'a>(
    output: &OutputSamples,
    input: &InputSamples,
    relations: &'a PlaceRelations<'a>,
    plane: PeriodicPlane,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(Board<'a>, Vec<u32>)> {
    let members = output.members();
    let mut board = Board::new(plane, relations);
    let (standing, members) = members.split_at(output.given[1]);
    let nearest = |members: &Vec<u32>| {
        let placeable = |place: u32| input.placeable[place as usize];
        let found = shape_match(output, input, members, placeable, &mut ClusterWork::default());
        found.filter(|m| m.energy <= members.len() as f64)
    };
    let mut found = Vec::with_capacity(members.len());
    for group in in_groups(members) {
        go_on()?;
        found.extend(parallel::map(group, nearest));
    }
    let of = |found: Option<ShapeMatch>| match found {
        Some(m) if board.is_open(m.by) => board.add(BoardElement { place: m.place, at: m.by }) as u32,
        _ => NONE,
    };
    let made: Vec<u32> = found.into_iter().map(of).collect();
    let of_cluster = (0..standing.len() as u32).chain(made).collect();
    Ok((board, of_cluster))
}
