//! Holes: places farther from all elements than any of the exemplar.

use crate::board::{BESIDE, Board, BoardElement, FITTING, OPERATIONS};
use crate::relations::distances;
use std::collections::BTreeSet;
use vtex_base::error::Result;
use vtex_base::geometry::plane::length;
use vtex_base::sampling::stream;

/// Places of the exemplar tried for a hole, and how far from its middle, in units of that distance.
const TRIED: usize = 24;
const SHIFTED: f64 = 0.25;

/// Puts elements in holes, the widest first: of those that overlap none in the exemplar, that which fits the best of some
/// that clash with none. Returns how many.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn fill_holes(board: &mut Board<'_>, seed: u64, go_on: &dyn Fn() -> Result<()>) -> Result<usize> {
    let widest = board.relations.widest;
    let spots: Vec<[f64; 2]> = board.standing().into_iter().flat_map(|e| spots(board, e)).collect();
    go_on()?;
    let mut holes: Vec<([f64; 2], f64)> =
        distances(board.plane, &spots).into_iter().filter(|d| d.1 > widest && board.is_open(d.0)).collect();
    holes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0[1].total_cmp(&b.0[1])).then(a.0[0].total_cmp(&b.0[0])));
    let places = &board.relations.exemplar.places;
    // Parts of something would stand there alone.
    let is_whole = |k: &u32| places[*k as usize].placeable && board.relations.alone[*k as usize];
    let whole: Vec<u32> = (0..places.len() as u32).filter(is_whole).collect();
    if whole.is_empty() {
        return Ok(0);
    }
    let before = board.elements.len();
    // One trial for each cell of the canvas.
    let mut tried = BTreeSet::new();
    for (n, (middle, _)) in holes.into_iter().enumerate() {
        if usize::is_multiple_of(n, OPERATIONS) {
            go_on()?;
        }
        let cell = middle.map(|v| (v / (0.5 * widest)) as u32);
        if !tried.insert(cell) || is_near(board, middle, widest, |id| id >= before) {
            continue;
        }
        let mut random = stream(seed, "cluster/holes", n as u64);
        let mut best: Option<(f64, BoardElement)> = None;
        for _ in 0..TRIED {
            let place = whole[random.index(whole.len())];
            let at = middle.map(|v| v + SHIFTED * widest * random.range(-1.0, 1.0));
            let element = BoardElement { place, at: board.plane.wrapped(at) };
            if !board.fits(element) || board.twins(element, None) >= BESIDE {
                continue;
            }
            let fit = board.support(element, None);
            if fit >= FITTING && best.is_none_or(|b| fit > b.0) {
                best = Some((fit, element));
            }
        }
        if let Some((_, element)) = best {
            board.add(element);
        }
    }
    Ok(board.elements.len() - before)
}

/// Whether an element, if it were removed, would leave a place farther from all others than any of the exemplar.
pub(crate) fn leaves_hole(board: &Board<'_>, id: usize) -> bool {
    let Some(element) = board.elements[id] else { return false };
    let widest = board.relations.widest;
    let own = board.relations.spots_of(board.figure(element.place));
    let middle =
        [0, 1].map(|k| element.at[k] + own.iter().map(|s| s[k]).sum::<f64>() / own.len().max(1) as f64);
    widest.is_finite() && !is_near(board, middle, widest, |other| other != id)
}

/// Points of an element.
fn spots(board: &Board<'_>, element: BoardElement) -> Vec<[f64; 2]> {
    let own = board.relations.spots_of(board.figure(element.place)).iter();
    own.map(|s| board.plane.wrapped([element.at[0] + s[0], element.at[1] + s[1]])).collect()
}

/// Whether one of the elements whose numbers `count` is near a place.
fn is_near(board: &Board<'_>, at: [f64; 2], within: f64, count: impl Fn(usize) -> bool) -> bool {
    let near = board.near(at, within + board.largest).into_iter().filter(|near| count(near.0));
    let mut spots = near.flat_map(|near| spots(board, near.1));
    spots.any(|s| length(board.plane.between(at, s)) <= within)
}
