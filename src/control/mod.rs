//! Files that steer synthesis and editing: shapes, masks, maps, palettes.
//!
//! A shape is fitted to the canvas as a viewer of SVGs would: as large as it goes, in the middle,
//! not distorted. Pictures are stretched over the canvas, whatever their size.

mod maps;
mod mask;
mod palette;
mod picture;
mod shape;

pub use maps::{density, level, shares};
pub use mask::mask;
pub use palette::palette;
pub use shape::{cage, shape};
