//! Files that control synthesis and editing: shapes, masks, maps, palettes.
//!
//! A shape is fitted to the canvas as SVG viewers do by default: scaled uniformly to the largest
//! size that fits, and centred. Pictures are stretched over the canvas.

mod colours;
mod maps;
mod mask;
mod palette;
mod picture;
mod shape;

pub use colours::{ColourMap, colours};
pub use maps::{density, level, shares};
pub use mask::mask;
pub use palette::palette;
pub use shape::{cage, shape};
