//! The shares of the categories: elements of a category that covers too much are removed, or become elements of one that
//! covers too little.
//!
//! The paper leaves the shares to the optimisation. Neighbourhoods that go on well come again and again, the more so on a
//! page without a period, whose border is seldom copied.

use crate::board::{Board, BoardElement, FITTING, OPERATIONS};
use crate::holes::leaves_hole;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::sampling::stream;

/// Covered area, as a share of the exemplar's, from which elements are removed: those that fit less than some, and all.
const MOST: f64 = 1.03;
const LOOSE: f64 = 0.5;
const TOLERATED: f64 = 1.06;
/// Share of all that is to be covered by which a category may cover too much.
const SLACK: f64 = 0.02;
/// Rounds in which every element is looked at once.
const ROUNDS: usize = 4;
/// Places of the exemplar tried for an element, of those drawn that would help.
const TRIED: usize = 24;
const DRAWN: usize = 500;

/// An element that may take the place of another.
struct Exchange {
    id: usize,
    by: BoardElement,
    /// How much better it fits among the neighbours.
    gain: f64,
}

/// How much more each category covers than it should.
struct Surplus {
    areas: Vec<f64>,
    /// What all categories should cover.
    wanted: f64,
}

impl Surplus {
    fn of(board: &Board<'_>) -> Self {
        let wanted = board.wanted_areas();
        let mut areas: Vec<f64> = wanted.iter().map(|v| -v).collect();
        for element in board.elements.iter().flatten() {
            areas[board.category(element.place)] += board.size(element.place);
        }
        Self { areas, wanted: wanted.iter().sum() }
    }

    /// Whether an element is one too many: without it both its category and all together are nearer to what they should be.
    fn is_too_many(&self, board: &Board<'_>, place: u32) -> bool {
        let half = 0.5 * board.size(place);
        self.areas[board.category(place)] > half && board.area - half > self.wanted
    }

    fn remove(&mut self, board: &Board<'_>, place: u32) {
        self.areas[board.category(place)] -= board.size(place);
    }

    /// Whether the category of a place covers clearly too much.
    fn is_clear(&self, board: &Board<'_>, place: u32) -> bool {
        self.areas[board.category(place)] > SLACK * self.wanted
    }

    /// Whether a category covers clearly too much, and all shares together are nearer to what they should be if one place
    /// of it stands for another.
    fn falls(&self, board: &Board<'_>, from: u32, to: u32) -> bool {
        let [lost, won] = [from, to].map(|place| self.areas[board.category(place)]);
        let [less, more] = [lost - board.size(from), won + board.size(to)];
        let is_nearer = less.abs() + more.abs() < lost.abs() + won.abs();
        self.is_clear(board, from) && board.category(from) != board.category(to) && is_nearer
    }

    fn exchange(&mut self, board: &Board<'_>, from: u32, to: u32) {
        self.remove(board, from);
        self.areas[board.category(to)] += board.size(to);
    }
}

/// Removes elements while all together cover too much, those first that fit the least, but none from number `last` on.
/// None is removed where it would leave a hole. What fits loosely goes down to what is wanted, from categories that cover too much; what fits well stays as long as
/// it can, since it would be missed. Returns how many.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn thin(board: &mut Board<'_>, last: usize, go_on: &dyn Fn() -> Result<()>) -> Result<usize> {
    let mut surplus = Surplus::of(board);
    let wanted = surplus.wanted;
    // Beside elements that stand the neighbours say what belongs there.
    let (most, loose) = if board.given() == 0 { (MOST, LOOSE) } else { (TOLERATED, f64::NEG_INFINITY) };
    if board.area <= most * wanted {
        return Ok(0);
    }
    let mut order: Vec<(f64, usize)> = Vec::new();
    for id in board.given()..last {
        if usize::is_multiple_of(id, OPERATIONS) {
            go_on()?;
        }
        if let Some(element) = board.elements[id] {
            order.push((board.support(element, Some(id)), id));
        }
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut removed = 0;
    for &(_, id) in order.iter().take_while(|o| o.0 < loose) {
        let Some(element) = board.elements[id] else { continue };
        let is_spare = is_alone(board, element.place) && surplus.is_too_many(board, element.place);
        if is_spare && !leaves_hole(board, id) {
            surplus.remove(board, element.place);
            board.remove(id);
            removed += 1;
        }
    }
    for &(_, id) in &order {
        let Some(element) = board.elements[id] else { continue };
        if board.area <= TOLERATED * wanted {
            break;
        }
        let is_enough = board.area - board.size(element.place) >= (2.0 - TOLERATED) * wanted;
        if is_enough && !leaves_hole(board, id) {
            board.remove(id);
            removed += 1;
        }
    }
    Ok(removed)
}

/// Exchanges elements where the others fit as well among the neighbours and clash with none, the best first, as long as
/// the shares of the categories come nearer to those of the exemplar. Returns how many.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn balance(board: &mut Board<'_>, seed: u64, go_on: &dyn Fn() -> Result<()>) -> Result<usize> {
    let mut surplus = Surplus::of(board);
    let mut done = 0;
    for round in 0..ROUNDS {
        let mut found = Vec::new();
        let ids: Vec<usize> = (board.given()..board.elements.len()).collect();
        for some in ids.chunks(OPERATIONS) {
            go_on()?;
            let of = |id: &usize| best(board, &surplus, *id, (seed, round));
            found.extend(parallel::map(some, of).into_iter().flatten());
        }
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.id.cmp(&b.id)));
        let before = done;
        for Exchange { id, by, .. } in found {
            let Some(element) = board.elements[id] else { continue };
            if surplus.falls(board, element.place, by.place) && board.clashes(by, Some(id)).is_empty() {
                surplus.exchange(board, element.place, by.place);
                board.exchange(id, by);
                done += 1;
            }
        }
        if done == before {
            break;
        }
    }
    Ok(done)
}

/// Whether an element overlaps no other in the exemplar.
fn is_alone(board: &Board<'_>, place: u32) -> bool {
    board.relations.alone[board.relations.like(place) as usize]
}

/// What fits best in place of an element: for a part of something only what has the same shape.
fn best(board: &Board<'_>, surplus: &Surplus, id: usize, (seed, round): (u64, usize)) -> Option<Exchange> {
    let element = board.elements[id].filter(|e| surplus.is_clear(board, e.place))?;
    let places = &board.relations.exemplar.places;
    let shape = |place: u32| board.relations.shape[board.figure(place) as usize];
    let suits = |place: &u32| {
        let stands = is_alone(board, element.place) && is_alone(board, *place);
        let is_whole = stands || shape(element.place) == shape(*place);
        places[*place as usize].placeable && is_whole && surplus.falls(board, element.place, *place)
    };
    let mut random = stream(seed, "cluster/balance", (round * board.elements.len() + id) as u64);
    let mut others: Vec<u32> = if places.len() > DRAWN {
        (0..DRAWN).map(|_| random.index(places.len()) as u32).filter(suits).collect()
    } else {
        (0..places.len() as u32).filter(suits).collect()
    };
    random.shuffle(&mut others);
    let own = board.support(element, Some(id));
    let fits = |place: u32| {
        let by = BoardElement { place, ..element };
        let fit = board.support(by, Some(id));
        (fit >= FITTING.min(own) && board.clashes(by, Some(id)).is_empty()).then_some(Exchange {
            id,
            by,
            gain: fit - own,
        })
    };
    let found = others.into_iter().take(TRIED).filter_map(fits);
    found.max_by(|a, b| a.gain.total_cmp(&b.gain).then(b.by.place.cmp(&a.by.place)))
}
