//! Files that steer synthesis: shapes, masks, maps.
//!
//! A shape is fitted to the canvas as a viewer of SVGs would: as large as it goes, in the middle,
//! not distorted. Pictures are stretched over the canvas, whatever their size.

mod maps;
mod mask;
mod picture;
mod shape;

pub use maps::{density, shares};
pub use mask::mask;
pub use shape::{cage, shape};
