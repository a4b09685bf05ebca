//! Elements one by one: what clashes is moved or removed, gaps are filled, and the covered area is made that of the
//! exemplar.
//!
//! The paper drops clusters that resemble no element, and leaves what overlaps or is open. A drawing shows both at once.
//! Fillers are proposed by elements that stand: the neighbours that they have in the exemplar.

use crate::balance::thin;
use crate::board::{BESIDE, Board, BoardElement, FITTING, OPERATIONS};
use crate::holes::fill_holes;
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use vtex_base::error::Result;
use vtex_base::sampling::stream;

/// Rounds of moves, and their lengths in units of the spacing.
const ROUNDS: usize = 6;
const STEPS: [f64; 3] = [0.02, 0.06, 0.14];
/// Directions of moves.
const DIRECTIONS: usize = 8;
/// Covered area, as a share of the exemplar's, up to which elements are added.
const LEAST: f64 = 1.0;
/// Covered area, as a share of the exemplar's, below which elements are scattered, and how many places are tried.
const SPARSE: f64 = 0.9;
const DARTS: usize = 4000;

/// Elements moved, removed and added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MendCounts {
    /// Elements moved away from others.
    pub moved: usize,
    /// Elements removed because they clashed, or because there were too many.
    pub removed: usize,
    /// Elements added in gaps.
    pub added: usize,
    /// Elements that took the place of those of another category.
    pub exchanged: usize,
}

/// Mends an arrangement.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn mend(board: &mut Board<'_>, seed: u64, go_on: &dyn Fn() -> Result<()>) -> Result<MendCounts> {
    let mut counts = MendCounts::default();
    part(board, &mut counts, go_on)?;
    remove_clashing(board, &mut counts, go_on)?;
    fill(board, &mut counts, go_on)?;
    scatter(board, seed, &mut counts, go_on)?;
    let first = board.elements.len();
    if board.given() == 0 {
        counts.added += fill_holes(board, seed, go_on)?;
    }
    counts.removed += thin(board, first, go_on)?;
    Ok(counts)
}

/// Fills a region beside elements that stand up to the exemplar's area, without what was made around it.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn complete(
    board: &mut Board<'_>,
    seed: u64,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<MendCounts> {
    let mut counts = MendCounts::default();
    board.keep_region();
    fill(board, &mut counts, go_on)?;
    scatter(board, seed, &mut counts, go_on)?;
    Ok(counts)
}

fn worst(board: &Board<'_>, id: usize) -> f64 {
    let Some(element) = board.elements[id] else { return 0.0 };
    board.clashes(element, Some(id)).iter().map(|c| c.1).sum()
}

/// Moves clashing elements by small steps as long as that helps.
fn part(board: &mut Board<'_>, counts: &mut MendCounts, go_on: &dyn Fn() -> Result<()>) -> Result<()> {
    let mut moved = BTreeSet::new();
    let mut open: BTreeSet<usize> = (0..board.elements.len()).collect();
    for _ in 0..ROUNDS {
        let mut next = BTreeSet::new();
        let given = board.given();
        for (n, id) in open.iter().copied().enumerate().filter(|n| n.1 >= given) {
            if usize::is_multiple_of(n, OPERATIONS) {
                go_on()?;
            }
            let Some(element) = board.elements[id] else { continue };
            let clashes = board.clashes(element, Some(id));
            let now: f64 = clashes.iter().map(|c| c.1).sum();
            if now == 0.0 {
                continue;
            }
            let mut best = (now, None);
            for step in STEPS {
                for k in 0..DIRECTIONS {
                    let (s, c) = libm::sincos(std::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
                    let by = step * board.relations.spacing;
                    let at = [element.at[0] + by * c, element.at[1] + by * s];
                    let sum: f64 =
                        board.clashes(BoardElement { at, ..element }, Some(id)).iter().map(|c| c.1).sum();
                    if sum < best.0 {
                        best = (sum, Some(at));
                    }
                }
                if best.0 == 0.0 {
                    break;
                }
            }
            if let Some(at) = best.1 {
                board.shift(id, at);
                moved.insert(id);
            }
            if best.0 > 0.0 {
                next.insert(id);
                next.extend(clashes.iter().map(|c| c.0));
            }
        }
        if next.is_empty() {
            break;
        }
        open = next;
    }
    counts.moved += moved.len();
    Ok(())
}

/// Removes elements until none clashes, those first whose clashes are the worst for their size and that fit the least.
fn remove_clashing(
    board: &mut Board<'_>,
    counts: &mut MendCounts,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let rank = |board: &Board<'_>, id: usize| -> Option<u64> {
        let element = board.elements[id]?;
        let by = worst(board, id);
        let size = board.size(element.place);
        let fit = board.support(element, Some(id)).clamp(0.0, 1.0);
        (by > 0.0).then(|| ((by / size.max(1.0)).min(1e6) * (1.5 - fit) * 1e6) as u64 + 1)
    };
    let mut queue: BinaryHeap<(u64, Reverse<usize>)> = BinaryHeap::new();
    for id in board.given()..board.elements.len() {
        if usize::is_multiple_of(id, OPERATIONS) {
            go_on()?;
        }
        queue.extend(rank(board, id).map(|r| (r, Reverse(id))));
    }
    let mut n = 0;
    while let Some((old, Reverse(id))) = queue.pop() {
        n += 1;
        if usize::is_multiple_of(n, OPERATIONS) {
            go_on()?;
        }
        match rank(board, id) {
            None => {}
            Some(now) if now < old => queue.push((now, Reverse(id))),
            Some(_) => {
                board.remove(id);
                counts.removed += 1;
            }
        }
    }
    Ok(())
}

/// Adds what neighbours propose and no element stands against, the best fitting first, up to the exemplar's area.
fn fill(board: &mut Board<'_>, counts: &mut MendCounts, go_on: &dyn Fn() -> Result<()>) -> Result<()> {
    let wanted = board.wanted();
    if board.fullness() >= LEAST {
        return Ok(());
    }
    let mut queue: BinaryHeap<(i64, Reverse<u32>, [i64; 2])> = BinaryHeap::new();
    let rank = |board: &Board<'_>, element: BoardElement| -> Option<i64> {
        if !board.fits(element) {
            return None;
        }
        let fit = board.support(element, None);
        (fit >= FITTING).then_some((fit * 1e6) as i64)
    };
    let exact = |v: [f64; 2]| v.map(|v| libm::round(v * 1e6) as i64);
    let propose = |board: &Board<'_>, id: usize, queue: &mut BinaryHeap<_>| {
        let Some(element) = board.elements[id] else { return };
        for partner in &board.relations.partners[element.place as usize] {
            if !board.relations.exemplar.places[partner.place as usize].placeable {
                continue;
            }
            let at = board.plane.wrapped([element.at[0] + partner.way[0], element.at[1] + partner.way[1]]);
            if let Some(rank) = rank(board, BoardElement { place: partner.place, at }) {
                queue.push((rank, Reverse(partner.place), exact(at)));
            }
        }
    };
    for id in 0..board.elements.len() {
        if usize::is_multiple_of(id, OPERATIONS) {
            go_on()?;
        }
        propose(board, id, &mut queue);
    }
    let mut n = 0;
    while let Some((old, Reverse(place), at)) = queue.pop() {
        n += 1;
        if usize::is_multiple_of(n, OPERATIONS) {
            go_on()?;
        }
        let element = BoardElement { place, at: at.map(|v| v as f64 * 1e-6) };
        let size = board.size(place);
        let Some(now) = rank(board, element) else { continue };
        if now < old {
            queue.push((now, Reverse(place), at));
        } else if board.area + 0.5 * size <= LEAST * wanted {
            // As near to the wanted area as one element allows.
            let id = board.add(element);
            counts.added += 1;
            propose(board, id, &mut queue);
        }
    }
    Ok(())
}

/// Adds elements at random free places where neighbours proposed too few, as for an exemplar of one element.
fn scatter(
    board: &mut Board<'_>,
    seed: u64,
    counts: &mut MendCounts,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let wanted = board.wanted();
    let places = &board.relations.exemplar.places;
    let placeable: Vec<u32> = (0..places.len() as u32).filter(|k| places[*k as usize].placeable).collect();
    let mut random = stream(seed, "cluster/scatter", 0);
    for n in 0..DARTS {
        if board.area >= SPARSE * wanted {
            break;
        }
        if usize::is_multiple_of(n, OPERATIONS) {
            go_on()?;
        }
        let place = placeable[random.index(placeable.len())];
        let at = board.plane.size.map(|side| random.range(0.0, side));
        let element = BoardElement { place, at };
        let size = board.size(place);
        if board.area + 0.5 * size <= wanted && board.fits(element) && board.twins(element, None) < BESIDE {
            board.add(element);
            counts.added += 1;
        }
    }
    Ok(())
}
