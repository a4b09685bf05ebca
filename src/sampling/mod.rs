//! Named random streams, Poisson disks, weighted draws.

mod poisson;
mod stream;

pub use poisson::{Area, poisson_disk};
pub use stream::{Stream, stream};
