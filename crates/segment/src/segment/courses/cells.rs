//! Rows divided into cells by the joints across them.

use super::joint::Joint;
use std::ops::Range;
use vtex_base::raster::blur::Plane;
use vtex_base::raster::{Connectivity, LabelMap, Mask, components_of_mask, edge_neighbours};

/// The part of a row, between its joints, that is searched for joints across it.
const INNER: Range<f64> = 0.12..0.88;
/// Least share of a column of it that has the colours of joints, if it is one.
const ACROSS: f64 = 0.6;
/// Width over which columns are averaged, in widths of the joint, and least number of pixels.
const AVERAGED: f64 = 0.5;
const LEAST_AVERAGED: f64 = 3.0;
/// Widest joint across a row, in widths of those along it: wider ones are ground between things of other shapes.
const WIDEST: f64 = 2.5;
/// Least share of the height of a row that is in the picture, where its columns count.
const SEEN: f64 = 0.4;
/// Lengths of cells, in medians of all between two joints: longer ones are several whose joint was not seen. Those that
/// the border of the picture cuts may be shorter.
const LENGTHS: Range<f64> = 0.35..1.6;
const LEAST_CUT: f64 = 0.1;
/// Longest cells, in heights of a row.
const LONGEST: f64 = 8.0;
/// How far the colours of joints reach into a cell, and a brick beyond it, in widths of the joint.
const DEPTH: f64 = 0.6;
const BEYOND: f64 = 0.5;
/// Deviation of the blur of joints, in their widths, and least one in pixels.
const BLUR: f64 = 1.0 / 12.0;
const LEAST_BLUR: f64 = 0.7;
/// Least share of a cell that its brick fills.
const FILLED: f64 = 0.75;

/// The cells of a picture.
pub(super) struct FoundCells {
    /// The pixels of each that is filled.
    pub(super) masks: Vec<Mask>,
    /// Number of parts of rows between two joints.
    pub(super) sought: usize,
}

/// A part of a row between two joints across it.
struct Cell {
    row: i32,
    /// The joints on both sides, along the row; empty at the border of the picture.
    joints: [Range<f64>; 2],
}

impl Cell {
    fn length(&self) -> f64 {
        self.joints[1].start - self.joints[0].end
    }

    fn is_cut(&self) -> bool {
        self.joints.iter().any(Range::is_empty)
    }
}

/// The cells of a picture, row by row.
pub(super) fn cells(joint: &Joint) -> FoundCells {
    let mut all = divided(joint);
    all.retain(|cell| cell.joints.iter().all(|across| across.end - across.start <= WIDEST * joint.width));
    let height = joint.period - joint.width;
    let mut lengths: Vec<f64> = all.iter().filter(|cell| !cell.is_cut()).map(Cell::length).collect();
    lengths.retain(|length| *length > 0.5 * height);
    lengths.sort_by(f64::total_cmp);
    let Some(&median) = lengths.get(lengths.len() / 2).filter(|length| **length <= LONGEST * height) else {
        return FoundCells { masks: Vec::new(), sought: 0 };
    };
    all.retain(|cell| cell.length() >= median * if cell.is_cut() { LEAST_CUT } else { LENGTHS.start });
    let sought = all.len();
    all.retain(|cell| cell.length() <= LENGTHS.end * median);
    let blurred = blurred(joint);
    let masks = vtex_base::parallel::map(&all, |cell| filled(joint, &blurred, cell));
    FoundCells { masks: masks.into_iter().flatten().collect(), sought }
}

/// Rows divided where most of a column has the colours of joints.
fn divided(joint: &Joint) -> Vec<Cell> {
    let [width, height] = joint.size;
    let corners = [[0, 0], [width, 0], [0, height], [width, height]].map(|[x, y]| joint.place(x, y));
    let rows = corners.map(|(row, ..)| row);
    let places = corners.map(|(_, _, along)| along);
    let first = rows.into_iter().min().unwrap_or(0) - 1;
    let count = (rows.into_iter().max().unwrap_or(0) - first + 2) as usize;
    let origin = libm::floor(places.into_iter().fold(f64::INFINITY, f64::min));
    let length = (places.into_iter().fold(f64::NEG_INFINITY, f64::max) - origin) as usize + 1;
    let inner = joint.period - joint.width;
    // For each row and place along it: how many pixels are seen, and how many have the colours of joints.
    let mut seen = vec![[0.0f64; 2]; count * length];
    for y in 0..height {
        for x in 0..width {
            let (row, across, along) = joint.place(x, y);
            if INNER.contains(&(across / inner)) {
                let column = ((along - origin) as usize).min(length - 1);
                let [all, like] = &mut seen[(row - first) as usize * length + column];
                *all += 1.0;
                *like += f64::from(u8::from(joint.has_colours(x, y)));
            }
        }
    }
    let least = SEEN * (INNER.end - INNER.start) * inner;
    let reach = libm::round(AVERAGED * joint.width).max(LEAST_AVERAGED) as usize / 2;
    let rows = (first..).zip(seen.chunks(length));
    rows.flat_map(|(row, columns)| row_cells(row, columns, reach, least, origin)).collect()
}

/// The cells of a row, of which each column has a number of pixels and one of those with the colours of joints.
fn row_cells(row: i32, columns: &[[f64; 2]], reach: usize, least: f64, origin: f64) -> Vec<Cell> {
    let is_seen = |k: &usize| columns[*k][0] >= least;
    let (Some(begin), Some(last)) =
        ((0..columns.len()).find(is_seen), (0..columns.len()).rev().find(is_seen))
    else {
        return Vec::new();
    };
    let is_joint = |k: usize| {
        let near = &columns[k.saturating_sub(reach).max(begin)..(k + reach + 1).min(last + 1)];
        let [all, like] = near.iter().fold([0.0; 2], |sum, c| [sum[0] + c[0], sum[1] + c[1]]);
        like > ACROSS * all
    };
    let place = |k: usize| origin + k as f64;
    let mut joints = vec![place(begin)..place(begin)];
    let mut start = None;
    for k in begin..=last + 1 {
        match (start, k <= last && is_joint(k)) {
            (None, true) => start = Some(k),
            (Some(from), false) => {
                joints.push(place(from)..place(k));
                start = None;
            }
            _ => {}
        }
    }
    joints.push(place(last + 1)..place(last + 1));
    joints.windows(2).map(|pair| Cell { row, joints: [pair[0].clone(), pair[1].clone()] }).collect()
}

/// The share of the surroundings of each pixel that has the colours of joints.
fn blurred(joint: &Joint) -> Plane {
    let [width, height] = joint.size;
    let one = |k: usize| f32::from(u8::from(joint.has_colours(k % width, k / width)));
    let plane = Plane { size: joint.size, values: (0..width * height).map(one).collect() };
    plane.blurred((BLUR * joint.width).max(LEAST_BLUR) as f32, [false; 2])
}

/// What each pixel of a cell's surroundings is.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// Of another cell, or of a joint.
    Beyond,
    Brick,
    /// Of the colours of joints, and near enough to its border to be of one.
    Mortar,
}

/// The pixels of the brick in a cell; `None` if it does not fill the cell.
fn filled(joint: &Joint, blurred: &Plane, cell: &Cell) -> Option<Mask> {
    let inner = joint.period - joint.width;
    // Half of each joint around it, and none at the border of the picture.
    let half = |joint: &Range<f64>| (joint.start + joint.end) / 2.0;
    let [from, to] = [half(&cell.joints[0]), half(&cell.joints[1])];
    let beyond = BEYOND * joint.width;
    let corners = [-beyond, inner + beyond].into_iter().flat_map(|across| [(across, from), (across, to)]);
    let corners: Vec<[f64; 2]> =
        corners.map(|(across, along)| joint.pixel(cell.row, across, along)).collect();
    let bound = |k: usize| {
        let low = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
        let high = corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
        let within = |v: f64| v.clamp(0.0, joint.size[k] as f64) as usize;
        within(libm::floor(low) - 1.0)..within(libm::ceil(high) + 1.0)
    };
    let [columns, rows] = [bound(0), bound(1)];
    let [wide, high] = [columns.len(), rows.len()];
    if wide == 0 || high == 0 {
        return None;
    }
    // Depth of a pixel within the cell, below 0 beyond it.
    let sides = [0, 1].map(|k| if cell.joints[k].is_empty() { None } else { Some(&cell.joints[k]) });
    let depth = |x: usize, y: usize| {
        let (row, across, along) = joint.place(x, y);
        let across = across + f64::from(row - cell.row) * joint.period;
        let left = sides[0].map_or(f64::INFINITY, |joint| along - joint.end);
        let right = sides[1].map_or(f64::INFINITY, |joint| joint.start - along);
        let is_near = across >= -beyond && across < inner + beyond && along >= from && along < to;
        is_near.then_some(across.min(inner - across).min(left).min(right))
    };
    let mut parts = vec![Part::Beyond; wide * high];
    // Mortar reaches in from the joints around.
    let mut open: Vec<usize> = Vec::new();
    let mut nominal = 0;
    for (k, part) in parts.iter_mut().enumerate() {
        let (x, y) = (columns.start + k % wide, rows.start + k / wide);
        let Some(depth) = depth(x, y) else { continue };
        nominal += usize::from(depth >= 0.0);
        let is_mortar = blurred.at(x, y) > 0.5 && depth < DEPTH * joint.width;
        match (is_mortar, depth < 0.0) {
            (true, true) => open.push(k),
            (true, false) => *part = Part::Mortar,
            (false, _) => *part = Part::Brick,
        }
    }
    while let Some(k) = open.pop() {
        for n in edge_neighbours(k, [wide, high]) {
            if parts[n] == Part::Mortar {
                parts[n] = Part::Beyond;
                open.push(n);
            }
        }
    }
    let labels = parts.iter().map(|part| u32::from(*part != Part::Beyond)).collect();
    let labels = LabelMap { width: wide as u32, height: high as u32, labels };
    let pieces = components_of_mask(&Mask::from_labels(&labels, |label| label == 1), Connectivity::Four);
    let brick = pieces.into_iter().max_by_key(Mask::area)?;
    let brick = brick.shifted(columns.start as i32, rows.start as i32);
    (f64::from(brick.area()) >= FILLED * nominal as f64).then_some(brick)
}
