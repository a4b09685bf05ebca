//! Pixels: decoding, label maps, run-length masks, components, distances, colour spaces.
//! Knows nothing of curves.

pub mod blur;
pub mod colour;
pub mod colour_names;
mod components;
pub mod contact;
mod control_map;
pub mod css;
pub mod decode;
mod distance;
mod labels;
mod mask;
pub mod oklab_map;
pub mod picture;
mod resize;

pub use components::{Connectivity, components, components_of_mask};
pub use control_map::ControlMap;
pub use decode::Limits;
pub use decode::{LARGEST_SIDE, check_size, decode};
pub use distance::squared_distance;
pub use labels::LabelMap;
pub use mask::{Mask, Span};
pub use resize::{Filter, resized};
