//! The first arrangement: blocks of the exemplar side by side (§6.2 of the paper).
//!
//! The paper copies square patches from random places and cuts the elements at their borders. Here a block takes the
//! elements whole, those whose reference points it holds, and its place in the exemplar is chosen of many: so that no
//! element clashes with those of earlier blocks, no gap opens, and pairs across the border stand as pairs of the exemplar
//! do. Where all places are bad, as in interlocking swatches, the exemplar goes on as it is.

use crate::board::{Board, BoardElement, SAME_OFFSET};
use crate::relations::PlaceRelations;
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, length};
use vtex_base::sampling::{Stream, stream};

/// Side of a block, as a share of the exemplar's mean side: two radii of the first level.
const BLOCK: f64 = 1.0 / 3.0;
/// Places tried for a block: random ones, and ones that put an element on an equal one.
const RANDOM: usize = 12;
const ALIGNED: usize = 24;
/// Costs of clashes, for each element area, of open places, of pairs unlike any of the exemplar, and of equal elements
/// nearer to each other than in the exemplar.
const CLASH: f64 = 4.0;
const OPEN: f64 = 2.0;
const STRANGE: f64 = 1.0;
const TWINS: f64 = 0.4;
/// By how much another place may be worse than going on.
const CHANGE: f64 = 0.45;
/// Places whose costs are computed between two questions whether to go on.
const AT_ONCE: usize = 8;
/// Places compared by the shares of figures.
const COMPARED: usize = 8;
/// Share of a block that may lie beside the page along each axis.
const BEYOND: f64 = 0.3;
/// Grid on which open places are sought.
const GRID: f64 = 16.0;
/// Places of which one is drawn: those whose cost is at most so much above the least.
const DRAWN: f64 = 0.06;

/// A block of the canvas: its corner and its size.
#[derive(Clone, Copy)]
struct CanvasBlock {
    low: [f64; 2],
    size: [f64; 2],
}

impl CanvasBlock {
    fn middle(&self) -> [f64; 2] {
        [self.low[0] + 0.5 * self.size[0], self.low[1] + 0.5 * self.size[1]]
    }

    /// The way from the corner to a point.
    fn within(&self, p: [f64; 2]) -> [f64; 2] {
        [p[0] - self.low[0], p[1] - self.low[1]]
    }

    /// Distance of a point within from the border.
    fn depth(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.within(p);
        x.min(y).min(self.size[0] - x).min(self.size[1] - y)
    }

    fn holds(&self, p: [f64; 2]) -> bool {
        let within = self.within(p);
        (0..2).all(|k| (0.0..self.size[k]).contains(&within[k]))
    }
}

/// Fills a canvas with blocks. `variation`, 0 to 1, says how readily blocks come from elsewhere; with 0 the exemplar goes
/// on wherever it can.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn blocks<'a>(
    relations: &'a PlaceRelations<'a>,
    plane: PeriodicPlane,
    (variation, seed): (f64, u64),
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Board<'a>> {
    let mut board = Board::new(plane, relations);
    let grid = BlockGrid::new(relations, plane);
    let mut offsets: Vec<[f64; 2]> = Vec::new();
    for (i, j) in grid.places() {
        go_on()?;
        let block = grid.block(i, j);
        let mut random = stream(seed, "cluster/blocks", offsets.len() as u64);
        let beside = [(i > 0).then(|| offsets.len() - 1), (j > 0).then(|| offsets.len() - grid.count[0])];
        let mut going_on: Vec<[f64; 2]> = beside.into_iter().flatten().map(|k| offsets[k]).collect();
        going_on.extend(from_standing(&board, block));
        let offset = choose(&board, block, &going_on, (variation, &mut random), go_on)?;
        fill(&mut board, block, offset);
        offsets.push(offset);
    }
    Ok(board)
}

/// Fills a canvas with the exemplar moved by one offset.
pub(crate) fn copy<'a>(
    relations: &'a PlaceRelations<'a>,
    plane: PeriodicPlane,
    offset: [f64; 2],
) -> Board<'a> {
    let mut board = Board::new(plane, relations);
    let grid = BlockGrid::new(relations, plane);
    grid.places().for_each(|(i, j)| fill(&mut board, grid.block(i, j), offset));
    board
}

/// The blocks of a canvas, in rows.
struct BlockGrid {
    count: [usize; 2],
    size: [f64; 2],
}

impl BlockGrid {
    /// Blocks that hold a few elements each, and less than the page.
    fn new(relations: &PlaceRelations<'_>, plane: PeriodicPlane) -> Self {
        let page = relations.exemplar.page;
        let side = (BLOCK * 400.0).max(1.6 * relations.spacing);
        let most = [0, 1].map(|k| if page.wraps[k] { 0.9 * page.size[k] } else { 0.6 * page.size[k] });
        let count = [0, 1].map(|k| libm::ceil(plane.size[k] / side.min(most[k])).max(1.0) as usize);
        Self { count, size: [0, 1].map(|k| plane.size[k] / count[k] as f64) }
    }

    /// Column and row of each block, row by row.
    fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [columns, rows] = self.count;
        (0..rows).flat_map(move |j| (0..columns).map(move |i| (i, j)))
    }

    fn block(&self, i: usize, j: usize) -> CanvasBlock {
        CanvasBlock { low: [i as f64 * self.size[0], j as f64 * self.size[1]], size: self.size }
    }
}

/// Adds the elements of a block that may be made.
fn fill(board: &mut Board<'_>, block: CanvasBlock, offset: [f64; 2]) {
    for element in open_contents(board, block, offset) {
        board.add(element);
    }
}

/// Number of elements of a period below which they are a lattice.
const LATTICE: f64 = 4.0;
/// Displacements tried for a regular order, at most.
const DISPLACEMENTS: usize = 60;
/// Elements looked at under each displacement, at most.
const LOOKED_AT: usize = 500;
/// Mean misfit up to which a displaced exemplar is the same.
const REGULAR: f64 = 0.1;

/// Whether the exemplar is regular: a lattice of few elements, or about the same when it is moved by less than its own
/// period.
pub(crate) fn is_regular(relations: &PlaceRelations<'_>, period: PeriodicPlane) -> bool {
    let (exemplar, places) = (relations.exemplar, &relations.exemplar.places);
    let in_period = places.len() as f64 * period.area() / exemplar.page.area();
    if period.wraps == [true; 2] && in_period < LATTICE {
        return true;
    }
    let at: Vec<[f64; 2]> = places.iter().map(|p| p.at).collect();
    let index = PointIndex::new(exemplar.page, relations.spacing, &at);
    let shape = |k: usize| relations.shape[places[k].figure as usize];
    // The element of the commonest shape, put on others of that shape.
    let mut shapes: BTreeMap<u32, (usize, usize)> = BTreeMap::new();
    for k in 0..places.len() {
        shapes.entry(shape(k)).or_insert((0, k)).0 += 1;
    }
    let commonest = shapes.into_values().max_by_key(|&(count, k)| (count, std::cmp::Reverse(k)));
    let Some((_, first)) = commonest else { return false };
    let ways = (0..places.len())
        .filter(|k| shape(*k) == shape(first))
        .map(|k| [at[k][0] - at[first][0], at[k][1] - at[first][1]]);
    let moves = |way: &[f64; 2]| {
        let off = PeriodicPlane { wraps: [true; 2], ..period }.between([0.0; 2], *way);
        length(off) > 0.3 * relations.spacing
    };
    ways.filter(moves).take(DISPLACEMENTS).any(|way| {
        let misfit = |k: usize| {
            let (to, mut least) = ([at[k][0] + way[0], at[k][1] + way[1]], 1.0f64);
            index.within(to, relations.spacing, |other, off| {
                let strange = relations.strangeness(places[k].figure, places[other].figure);
                least = least.min(length(off) / relations.spacing + strange);
            });
            least
        };
        let some: Vec<usize> = (0..places.len()).step_by(places.len().div_ceil(LOOKED_AT)).collect();
        some.iter().map(|k| misfit(*k)).sum::<f64>() <= REGULAR * some.len() as f64
    })
}

/// The elements of a block that may be made.
fn open_contents(board: &Board<'_>, block: CanvasBlock, offset: [f64; 2]) -> Vec<BoardElement> {
    let mut found = contents(board.relations, block, offset);
    found.retain(|e| board.is_open(e.at));
    found
}

/// The elements of a block whose canvas is the exemplar moved by `offset`.
fn contents(relations: &PlaceRelations<'_>, block: CanvasBlock, offset: [f64; 2]) -> Vec<BoardElement> {
    let page = relations.exemplar.page;
    let corner = [block.low[0] - offset[0], block.low[1] - offset[1]];
    let mut found = Vec::new();
    for (k, place) in relations.exemplar.places.iter().enumerate() {
        let within: [f64; 2] = std::array::from_fn(|k| {
            let v = place.at[k] - corner[k];
            if page.wraps[k] { v - page.size[k] * libm::floor(v / page.size[k]) } else { v }
        });
        if place.placeable && (0..2).all(|k| (0.0..block.size[k]).contains(&within[k])) {
            let at = [block.low[0] + within[0], block.low[1] + within[1]];
            found.push(BoardElement { place: k as u32, at });
        }
    }
    found
}

fn choose(
    board: &Board<'_>,
    block: CanvasBlock,
    going_on: &[[f64; 2]],
    (variation, random): (f64, &mut Stream),
    go_on: &dyn Fn() -> Result<()>,
) -> Result<[f64; 2]> {
    let page = board.relations.exemplar.page;
    // The exemplar has to cover most of the block. What stands at its border would hardly ever come if it had to cover all.
    let beyond = block.size.map(|v| BEYOND * v);
    let fits = |offset: [f64; 2]| -> bool {
        (0..2).all(|k| {
            let low = block.low[k] - offset[k];
            page.wraps[k] || (low >= -beyond[k] && low + block.size[k] <= page.size[k] + beyond[k])
        })
    };
    let anywhere = |random: &mut Stream| -> [f64; 2] {
        std::array::from_fn(|k| {
            if page.wraps[k] {
                return block.low[k] - random.range(0.0, 1.0) * page.size[k];
            }
            let room = (page.size[k] - block.size[k] + 2.0 * beyond[k]).max(0.0);
            block.low[k] + beyond[k] - random.range(0.0, 1.0) * room
        })
    };
    if board.elements.is_empty() {
        // The first block of a canvas that is to repeat the exemplar is where it is in the exemplar.
        return Ok(if variation > 0.0 { anywhere(random) } else { [0.0; 2] });
    }
    let open = OpenPoints::new(board, block);
    let first = going_on.iter().copied().filter(|o| fits(*o));
    let least = first.map(|o| (cost(board, block, &open, o), o)).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, offset)) = least
        && (variation <= 0.0 || open_contents(board, block, offset).is_empty() && open.points.is_empty())
    {
        return Ok(offset);
    }
    let mut others: Vec<[f64; 2]> = aligned(board, block, random);
    others.extend((0..RANDOM).map(|_| anywhere(random)));
    others.retain(|o| fits(*o) && !going_on.iter().any(|g| is_same(page, *g, *o)));
    let mut costs = Vec::with_capacity(others.len());
    for some in others.chunks(AT_ONCE) {
        costs.extend(vtex_base::parallel::map(some, |o| cost(board, block, &open, *o)));
        go_on()?;
    }
    let mut ranked: Vec<(f64, [f64; 2])> = costs.into_iter().zip(others).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = ranked.first().map_or(f64::INFINITY, |r| r.0);
    if let Some((stay, offset)) = least
        && best > stay + CHANGE * variation
    {
        return Ok(offset);
    }
    // Of about equally good ones that which keeps the shares of the categories best.
    let mut good: Vec<[f64; 2]> = ranked.iter().take_while(|r| r.0 <= best + DRAWN).map(|r| r.1).collect();
    random.shuffle(&mut good);
    let balance = |offset: &[f64; 2]| imbalance(board, &open_contents(board, block, *offset));
    let balanced = good.iter().take(COMPARED).map(|o| (balance(o), *o)).min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(balanced.map_or_else(|| anywhere(random), |found| found.1))
}

/// How far the shares of the classes on the canvas, with some more elements, are from those of the exemplar.
fn imbalance(board: &Board<'_>, more: &[BoardElement]) -> f64 {
    let mut counts = vec![0.0; board.relations.class_shares.len()];
    let all = board.elements.iter().flatten().chain(more);
    let mut total = 0.0;
    for element in all {
        counts[board.relations.class[board.figure(element.place) as usize] as usize] += 1.0;
        total += 1.0;
    }
    let wanted = &board.relations.class_shares;
    counts.iter().zip(wanted).map(|(n, share)| (n / f64::max(total, 1.0) - share).abs()).sum()
}

/// Offsets with which the exemplar goes on from elements that stand beside a block.
fn from_standing(board: &Board<'_>, block: CanvasBlock) -> Vec<[f64; 2]> {
    let (exemplar, page, middle) = (board.relations.exemplar, board.relations.exemplar.page, block.middle());
    let radius = 0.5 * length(block.size) + board.relations.spacing;
    let mut offsets: Vec<[f64; 2]> = Vec::new();
    for (_, element, way) in board.near(middle, radius).into_iter().filter(|n| n.0 < board.given()) {
        let place = exemplar.places[board.relations.like(element.place) as usize];
        let offset = [0, 1].map(|k| middle[k] + way[k] - place.at[k]);
        if !offsets.iter().any(|o| is_same(page, *o, offset)) {
            offsets.push(offset);
        }
    }
    offsets
}

/// Whether two offsets are the same on a page.
fn is_same(page: PeriodicPlane, a: [f64; 2], b: [f64; 2]) -> bool {
    length(page.between(page.wrapped(a), page.wrapped(b))) < SAME_OFFSET
}

/// Offsets that put an element of the exemplar on one of its shape beside the block, or on one of its category.
fn aligned(board: &Board<'_>, block: CanvasBlock, random: &mut Stream) -> Vec<[f64; 2]> {
    let exemplar = board.relations.exemplar;
    let middle = block.middle();
    let radius = 0.5 * length(block.size) + 0.7 * board.relations.spacing;
    let near = board.near(middle, radius);
    let mut by_shape: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut by_category: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (k, place) in exemplar.places.iter().enumerate() {
        by_shape.entry(board.relations.shape[place.figure as usize]).or_default().push(k as u32);
        by_category.entry(exemplar.figures[place.figure as usize].category).or_default().push(k as u32);
    }
    let mut offsets = Vec::new();
    for n in 0..ALIGNED.min(4 * near.len()) {
        let (_, element, way) = near[random.index(near.len())];
        let figure = board.figure(element.place);
        let by_shape = by_shape.get(&board.relations.shape[figure as usize]).filter(|_| n % 4 < 3);
        // Elements that stand may have shapes of their own.
        let of = by_shape.unwrap_or(&by_category[&exemplar.figures[figure as usize].category]);
        let place = exemplar.places[of[random.index(of.len())] as usize];
        // Near the block, so that the offset does not jump across a seam of the canvas.
        let at = [middle[0] + way[0], middle[1] + way[1]];
        offsets.push([at[0] - place.at[0], at[1] - place.at[1]]);
    }
    offsets
}

/// How badly a block from a place of the exemplar suits the elements around it.
fn cost(board: &Board<'_>, block: CanvasBlock, open: &OpenPoints, offset: [f64; 2]) -> f64 {
    let relations = board.relations;
    let own = open_contents(board, block, offset);
    let (mut clash, mut area, mut strange, mut pairs) = (0.0, 0.0, 0.0, 0u32);
    let mut twins = 0.0;
    for element in &own {
        let figure = board.figure(element.place);
        // Elements deep within the block meet none around it.
        let deep = (2.0 * board.largest + relations.clearance).max(1.5 * relations.spacing);
        if block.depth(element.at) > deep {
            continue;
        }
        let near = board.near(element.at, 1.5 * relations.spacing);
        let clashes = board.clashes(*element, None);
        if near.is_empty() && clashes.is_empty() {
            continue;
        }
        let size = f64::from(relations.area(figure));
        area += size;
        for (id, by) in clashes {
            let other = board.elements[id].map_or(size, |e| f64::from(relations.area(board.figure(e.place))));
            clash += (by / size.min(other).max(1.0)).min(1.0) * size;
        }
        twins += board.twins(*element, None);
        for (_, other, way) in near {
            strange += relations.misfit(element.place, board.figure(other.place), way);
            pairs += 1;
        }
    }
    // What the elements around expect within the block.
    let middle = block.middle();
    let at: Vec<[f64; 2]> = own.iter().map(|e| block.within(e.at)).collect();
    let plane = PeriodicPlane { size: block.size, wraps: [false; 2] };
    let index = PointIndex::new(plane, relations.spacing, &at);
    for (_, element, way) in board.near(middle, 0.5 * length(block.size) + 1.5 * relations.spacing) {
        for partner in &relations.partners[element.place as usize] {
            if length(partner.way) > 1.5 * relations.spacing {
                break;
            }
            let at = [middle[0] + way[0] + partner.way[0], middle[1] + way[1] + partner.way[1]];
            if !block.holds(at) || !board.is_open(at) {
                continue;
            }
            let wanted = relations.exemplar.places[partner.place as usize].figure;
            let mut missed: f64 = 1.0;
            index.within(block.within(at), relations.spacing, |k, way| {
                let off = length(way) / relations.spacing;
                missed = missed.min(off + relations.strangeness(wanted, board.figure(own[k].place)));
            });
            strange += missed;
            pairs += 1;
        }
    }
    let open = open.share(board, block, &own, offset);
    let strange = if pairs == 0 { 0.0 } else { strange / f64::from(pairs) };
    CLASH * clash / area.max(1.0) + OPEN * open + STRANGE * strange + TWINS * twins / own.len().max(1) as f64
}

/// The points of a block, on a grid, that are far from all elements around it.
struct OpenPoints {
    /// Ways from the block's corner.
    points: Vec<[f64; 2]>,
    /// Number of points of the grid.
    all: usize,
}

impl OpenPoints {
    fn new(board: &Board<'_>, block: CanvasBlock) -> Self {
        let relations = board.relations;
        let middle = block.middle();
        let around = board.near(middle, 0.5 * length(block.size) + board.largest + relations.hole.min(100.0));
        let near =
            around.into_iter().map(|n| (n.1.place, block.within([middle[0] + n.2[0], middle[1] + n.2[1]])));
        let count = block.size.map(|v| libm::ceil(v / GRID) as usize);
        let grid = (0..count[0] * count[1]).map(|k| [k % count[0], k / count[0]].map(|v| GRID * v as f64));
        let mut points = far_from(board, block, near, grid.collect());
        points.retain(|p| board.is_free([block.low[0] + p[0], block.low[1] + p[1]]));
        Self { points, all: count[0] * count[1] }
    }

    /// Share of the points that are far from the elements of the block, too, although the exemplar has an element there
    /// that is not for later blocks.
    fn share(&self, board: &Board<'_>, block: CanvasBlock, own: &[BoardElement], offset: [f64; 2]) -> f64 {
        let local = |e: &BoardElement| (e.place, block.within(e.at));
        let open = far_from(board, block, own.iter().map(local), self.points.clone());
        if open.is_empty() {
            return 0.0;
        }
        let margin = board.largest + board.relations.hole.min(100.0);
        let around = CanvasBlock { low: block.low.map(|v| v - margin), size: block.size.map(|v| v + margin) };
        let expected = contents(board.relations, around, offset);
        let count = open.len();
        let right = far_from(board, block, expected.iter().map(local), open);
        (count - right.len()) as f64 / self.all.max(1) as f64
    }
}

/// The points that are far from all of some elements. Places are ways from the block's corner.
fn far_from(
    board: &Board<'_>,
    block: CanvasBlock,
    elements: impl Iterator<Item = (u32, [f64; 2])>,
    points: Vec<[f64; 2]>,
) -> Vec<[f64; 2]> {
    let hole = board.relations.hole.min(100.0);
    // Only what comes near the block counts.
    let margin = hole + GRID;
    let mut spots = Vec::new();
    for (place, at) in elements {
        for s in board.relations.spots_of(board.figure(place)) {
            let p = [0, 1].map(|k| at[k] + s[k] + margin);
            if (0..2).all(|k| (0.0..block.size[k] + 2.0 * margin).contains(&p[k])) {
                spots.push(p);
            }
        }
    }
    let plane = PeriodicPlane { size: block.size.map(|v| v + 2.0 * margin), wraps: [false; 2] };
    let index = PointIndex::new(plane, hole.max(GRID), &spots);
    let far = |p: &[f64; 2]| !index.any([p[0] + margin, p[1] + margin], hole + 1.0);
    points.into_iter().filter(far).collect()
}
