//! Boundary optimisation (the paper, §3): a region whose border looks like that of an exemplar.
//!
//! Windows around the pixels of a border are compared bit by bit, in four turns. Every window of the
//! exemplar is assigned as often as every other, so all of its border comes back. Windows vote for
//! what is inside; the area is kept by rank instead of the paper's choice of a threshold, which
//! misses it by some per cent. Coarse to fine, one region after the other, each within the one below.
//!
//! Works on the cells of an exemplar, of which there are 128 along its shorter side. Loses direction
//! where windows are turned, so they are turned by half turns only where borders have a direction.

mod assignment;
mod nested;
mod outlined;
mod patches;
mod pyramid;
mod shape;

pub(super) use nested::{Job, Start, nested};
pub(super) use outlined::outlined;
pub use patches::shape_distance;

/// Side of the windows, in cells, on the finest level and on coarser ones.
const SIDES: [usize; 2] = [11, 15];
