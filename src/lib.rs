//! vtex turns a photograph of a texture into an editable vector texture of any size.
//!
//! The path of the data: [`segment`] finds masks in an image, [`analyze`] makes a
//! [`library::Library`] of textons from them, [`synth`] places them in a [`scene::Scene`],
//! [`output`] writes the scene. Each stage is a function from plain data and one parameter struct
//! to plain data, and what it gives can be saved and read again. The method is that of Palazzolo,
//! van Kaick and Mould, "By-Example Synthesis of Vector Textures" (2025).

#![forbid(unsafe_code)]

mod disjoint_sets;
mod document;
pub mod error;
pub mod gzip;
mod parallel;
mod progress;
mod svg_tree;
mod symmetric;

pub mod analyze;
mod arrange;
pub mod control;
mod correspondence;
pub mod edit;
#[cfg(feature = "onnx")]
pub mod engine;
pub mod geometry;
pub mod interpolate;
pub mod library;
pub mod metrics;
pub mod output;
pub mod procedural;
pub mod raster;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod segment;
pub mod statistics;
pub mod synth;
pub mod tune;
pub mod warp;

pub use error::{Error, Result};
pub use progress::Progress;

/// Name and version of this program, as written into its files.
pub const PROGRAM: &str = concat!("vtex ", env!("CARGO_PKG_VERSION"));
