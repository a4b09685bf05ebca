//! Boundary optimisation (the paper, §3): gives a region a border like that of an exemplar.
//!
//! Windows around the pixels of a border are compared bit by bit, in four rotations. All windows of the
//! exemplar are assigned equally often, so all of its border recurs. Windows vote on which pixels are
//! inside. The area is kept by rank, because the paper's threshold misses it by some per cent. Regions are
//! made coarse to fine, one after the other, each within the one below.
//!
//! Works on the cells of an exemplar, 128 along its shorter side. Rotated windows lose direction, so they
//! are only rotated by half turns where borders have a direction.

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
