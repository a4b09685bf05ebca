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

/// The pixels that share an edge with pixel `i` of a picture, counted row by row: left, right, above, below.
#[inline]
pub fn edge_neighbours(i: usize, [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let x = i % width;
    let right = (x + 1 < width).then_some(i + 1);
    let below = (i + width < width * height).then_some(i + width);
    [(x > 0).then(|| i - 1), right, i.checked_sub(width), below].into_iter().flatten()
}
