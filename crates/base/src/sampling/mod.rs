//! Random streams, Poisson-disk sets and weighted draws.

mod poisson;
mod stream;
mod sums;

pub use poisson::{Area, poisson_disk};
pub use stream::{Stream, stream};
pub use sums::WeightTree;
