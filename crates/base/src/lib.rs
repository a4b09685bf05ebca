//! Pixels and curves, and services for every stage: errors, progress, threads, random streams, stored
//! documents.

pub mod disjoint_sets;
pub mod document;
pub mod error;
pub mod file_names;
pub mod fourier;
pub mod geometry;
pub mod gzip;
pub mod kmeans;
pub mod parallel;
pub mod parameter;
pub mod progress;
pub mod raster;
pub mod sampling;
pub mod symmetric;

pub use error::{Error, Result};
pub use parameter::Parameter;
pub use progress::Progress;

/// Name and version of this program, as written into its files.
pub const PROGRAM: &str = concat!("vtex ", env!("CARGO_PKG_VERSION"));
