//! Random streams, Poisson-disk sets, points left out evenly, and weighted draws.

mod elimination;
mod poisson;
mod stream;
mod sums;

pub use elimination::{even_ranks, evenly_reduced};
pub use poisson::{Area, poisson_disk};
pub use stream::{Stream, stream};
pub use sums::WeightTree;
