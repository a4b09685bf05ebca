//! The first arrangement: blocks of the exemplar side by side (§6.2 of the paper).
//!
//! The paper copies square patches from random places and cuts the elements at their borders. Here a block takes the
//! elements whole, those whose reference points it holds, and its place in the exemplar is chosen of many: so that no
//! element clashes with those of earlier blocks, no gap opens, and pairs across the border stand as pairs of the exemplar
//! do. Where all places are bad, as in interlocking swatches, the exemplar goes on as it is.

use crate::board::{Board, BoardElement};
use crate::relations::PlaceRelations;
use crate::space::{PeriodicPlane, PointIndex, length};
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::sampling::{Stream, stream};

/// Side of a block, as a share of the exemplar's mean side: two radii of the first level.
const BLOCK: f64 = 1.0 / 3.0;
/// Places tried for a block: random ones, and ones that put an element on an equal one.
const RANDOM: usize = 20;
const ALIGNED: usize = 28;
/// Costs of clashes, for each element area, of open places, and of pairs unlike any of the exemplar.
const CLASH: f64 = 4.0;
const OPEN: f64 = 2.0;
const STRANGE: f64 = 1.0;
/// By how much another place may be worse than going on.
const CHANGE: f64 = 0.4;
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
    let page = relations.exemplar.page;
    // A block holds a few elements, and less than the page.
    let side = (BLOCK * 400.0).max(1.6 * relations.spacing);
    let most = [0, 1].map(|k| if page.wraps[k] { 0.9 * page.size[k] } else { 0.6 * page.size[k] });
    let count = [0, 1].map(|k| libm::ceil(plane.size[k] / side.min(most[k])).max(1.0) as usize);
    let size = [0, 1].map(|k| plane.size[k] / count[k] as f64);
    let mut offsets: Vec<[f64; 2]> = Vec::new();
    for j in 0..count[1] {
        for i in 0..count[0] {
            go_on()?;
            let block = CanvasBlock { low: [i as f64 * size[0], j as f64 * size[1]], size };
            let mut random = stream(seed, "cluster/blocks", offsets.len() as u64);
            let beside = [(i > 0).then(|| offsets.len() - 1), (j > 0).then(|| offsets.len() - count[0])];
            let going_on: Vec<[f64; 2]> = beside.into_iter().flatten().map(|k| offsets[k]).collect();
            let offset = choose(&board, block, &going_on, variation, &mut random);
            for element in contents(relations, block, offset) {
                board.add(element);
            }
            offsets.push(offset);
        }
    }
    Ok(board)
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
    variation: f64,
    random: &mut Stream,
) -> [f64; 2] {
    let page = board.relations.exemplar.page;
    // The exemplar has to cover the block.
    let fits = |offset: [f64; 2]| -> bool {
        (0..2).all(|k| {
            let low = block.low[k] - offset[k];
            page.wraps[k] || (low >= -1e-6 && low + block.size[k] <= page.size[k] + 1e-6)
        })
    };
    let anywhere = |random: &mut Stream| -> [f64; 2] {
        std::array::from_fn(|k| {
            let room = if page.wraps[k] { page.size[k] } else { (page.size[k] - block.size[k]).max(0.0) };
            block.low[k] - random.range(0.0, 1.0) * room
        })
    };
    if board.elements.is_empty() {
        // The first block of a canvas that is to repeat the exemplar is where it is in the exemplar.
        return if variation > 0.0 { anywhere(random) } else { [0.0; 2] };
    }
    let first = going_on.iter().copied().filter(|o| fits(*o));
    let least = first.map(|o| (cost(board, block, o), o)).min_by(|a, b| a.0.total_cmp(&b.0));
    if variation <= 0.0
        && let Some((_, offset)) = least
    {
        return offset;
    }
    let same = |a: [f64; 2], b: [f64; 2]| length(page.between(page.wrapped(a), page.wrapped(b))) < 2.0;
    let mut others: Vec<[f64; 2]> = aligned(board, block, random);
    others.extend((0..RANDOM).map(|_| anywhere(random)));
    others.retain(|o| fits(*o) && !going_on.iter().any(|g| same(*g, *o)));
    let costs = vtex_base::parallel::map(&others, |o| cost(board, block, *o));
    let mut ranked: Vec<(f64, [f64; 2])> = costs.into_iter().zip(others).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = ranked.first().map_or(f64::INFINITY, |r| r.0);
    if let Some((stay, offset)) = least
        && best > stay + CHANGE * variation
    {
        return offset;
    }
    let good = ranked.iter().take_while(|r| r.0 <= best + DRAWN).count();
    match ranked.get(random.index(good)) {
        Some(found) => found.1,
        None => anywhere(random),
    }
}

/// Offsets that put an element of the exemplar on an equal one beside the block, or on one of its category.
fn aligned(board: &Board<'_>, block: CanvasBlock, random: &mut Stream) -> Vec<[f64; 2]> {
    let exemplar = board.relations.exemplar;
    let middle = [block.low[0] + 0.5 * block.size[0], block.low[1] + 0.5 * block.size[1]];
    let radius = 0.5 * length(block.size) + 0.7 * board.relations.spacing;
    let near = board.near(middle, radius);
    let mut by_figure: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut by_category: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (k, place) in exemplar.places.iter().enumerate() {
        by_figure.entry(place.figure).or_default().push(k as u32);
        by_category.entry(exemplar.figures[place.figure as usize].category).or_default().push(k as u32);
    }
    let mut offsets = Vec::new();
    for n in 0..ALIGNED.min(4 * near.len()) {
        let (_, element, way) = near[random.index(near.len())];
        let figure = board.figure(element.place);
        let of = match n % 4 {
            0..3 => &by_figure[&figure],
            _ => &by_category[&exemplar.figures[figure as usize].category],
        };
        let place = exemplar.places[of[random.index(of.len())] as usize];
        // Near the block, so that the offset does not jump across a seam of the canvas.
        let at = [middle[0] + way[0], middle[1] + way[1]];
        offsets.push([at[0] - place.at[0], at[1] - place.at[1]]);
    }
    offsets
}

/// How badly a block from a place of the exemplar suits the elements around it.
fn cost(board: &Board<'_>, block: CanvasBlock, offset: [f64; 2]) -> f64 {
    let relations = board.relations;
    let own = contents(relations, block, offset);
    let (mut clash, mut area, mut strange, mut pairs) = (0.0, 0.0, 0.0, 0u32);
    for element in &own {
        let figure = board.figure(element.place);
        let size = f64::from(relations.area(figure));
        area += size;
        for (id, by) in board.clashes(*element, None) {
            let other = board.elements[id].map_or(size, |e| f64::from(relations.area(board.figure(e.place))));
            clash += (by / size.min(other).max(1.0)).min(1.0) * size;
        }
        for (_, other, way) in board.near(element.at, 1.5 * relations.spacing) {
            strange += relations.misfit(element.place, board.figure(other.place), way);
            pairs += 1;
        }
    }
    let open = open_share(board, block, &own);
    let strange = if pairs == 0 { 0.0 } else { strange / f64::from(pairs) };
    CLASH * clash / area.max(1.0) + OPEN * open + STRANGE * strange
}

/// Share of the points near the block's border to other elements that are too far from all elements.
fn open_share(board: &Board<'_>, block: CanvasBlock, own: &[BoardElement]) -> f64 {
    let relations = board.relations;
    let middle = [block.low[0] + 0.5 * block.size[0], block.low[1] + 0.5 * block.size[1]];
    let reach = 0.5 * length(block.size) + relations.reach.iter().copied().fold(0.0, f64::max) + relations.spacing;
    let around = board.near(middle, reach).into_iter().map(|n| {
        let at = [middle[0] + n.2[0], middle[1] + n.2[1]];
        (n.1.place, at)
    });
    let all = around.chain(own.iter().map(|e| (e.place, e.at)));
    let spots = all.flat_map(|(place, at)| {
        let own = relations.spots_of(board.figure(place));
        own.iter().map(move |s| [at[0] + s[0], at[1] + s[1]])
    });
    // Around the block lies a plane without seams.
    let margin = reach + GRID;
    let corner = [block.low[0] - margin, block.low[1] - margin];
    let size = block.size.map(|v| v + 2.0 * margin);
    let plane = PeriodicPlane { size, wraps: [false; 2] };
    let spots: Vec<[f64; 2]> = spots.map(|p| [p[0] - corner[0], p[1] - corner[1]]).collect();
    let index = PointIndex::new(plane, relations.hole.clamp(GRID, 100.0), &spots);
    // What lies near the right and the lower border is for later blocks.
    let count = block.size.map(|v| libm::ceil((v - relations.hole).max(0.4 * v) / GRID) as usize);
    let mut open = 0u32;
    for k in 0..count[0] * count[1] {
        let at = [margin + GRID * (k % count[0]) as f64, margin + GRID * (k / count[0]) as f64];
        open += u32::from(index.nearest(at, relations.hole + 1.0).is_none());
    }
    f64::from(open) / (count[0] * count[1]) as f64
}
