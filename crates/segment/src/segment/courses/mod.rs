//! Bricks and tiles in rows: what lies between joints is one element, whatever its stains.
//!
//! Rows of a picture are known from its lattice. The strip between two rows in which colours vary least, at one phase of
//! the period, is their *joint* ([`joint`]). What has its colours across a row divides the row into *cells* ([`cells`]).
//! Each cell that is filled becomes one mask, and replaces the patches within it.
//!
//! Works badly where joints have the colours of the bricks, and where they differ much from row to row: then rows have no
//! clear joint, and masks stay as they are.

mod cells;
mod joint;

use super::ScoredMask;
use cells::cells;
use image::RgbImage;
use joint::Joint;
use vtex_base::raster::Mask;
use vtex_base::raster::blur::oklab_planes;
use vtex_scene::lattice;

/// Fewest cells of a picture that are believed, and least share of the rows' parts between joints that are cells.
const FEWEST: usize = 8;
const LEAST_SHARE: f64 = 0.6;
/// Least share of a mask within cells for which these replace it.
const WITHIN: f64 = 0.5;
/// Least share of a mask in joints for which it is left out.
const IN_JOINTS: f64 = 0.6;

/// Masks in which each cell of the picture's rows is one; unchanged where it has no rows with clear joints.
pub(super) fn whole_cells(masks: Vec<ScoredMask>, image: &RgbImage) -> Vec<ScoredMask> {
    let Some(lattice) = lattice::find(image).filter(lattice::Lattice::is_kept) else { return masks };
    let planes = oklab_planes(image, 1);
    let Some(joint) = Joint::new(&planes, &lattice) else { return masks };
    let found = cells(&joint);
    if found.masks.len() < FEWEST || (found.masks.len() as f64) < LEAST_SHARE * found.sought as f64 {
        return masks;
    }
    let spans = found.masks.iter().flat_map(Mask::spans).copied().collect();
    let covered = Mask::from_spans(spans);
    let kept = masks.into_iter().filter_map(|ScoredMask { mask, score }| {
        Some(ScoredMask { mask: outside(&mask, &covered, &joint)?, score })
    });
    let cells = found.masks.into_iter().map(|mask| ScoredMask { mask, score: 1.0 });
    cells.chain(kept).collect()
}

/// What a mask has outside of what cells cover; `None` if most of it is within that or in joints.
fn outside(mask: &Mask, covered: &Mask, joint: &Joint) -> Option<Mask> {
    let area = f64::from(mask.area());
    let outside = mask.without(covered);
    let in_joints = outside.pixels().filter(|&(x, y)| joint.has_colours(x as usize, y as usize)).count();
    let within = area - f64::from(outside.area());
    (within < WITHIN * area && (in_joints as f64) < IN_JOINTS * area).then_some(outside)
}

#[cfg(test)]
mod tests;
