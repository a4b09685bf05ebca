//! vtex turns a photograph of a texture into an editable vector texture of any size.
//!
//! The stages, in the order of the data: [`segment`] finds masks in a photograph, [`analyze`] turns
//! them into a [`library::Library`] of textons (elements), [`synth`] places textons in a
//! [`scene::Scene`], and [`output`] writes the scene as SVG, PDF or PNG. [`edit`] and
//! [`interpolate`] change scenes; [`metrics`] and [`report`] compare results with photographs.
//!
//! Each stage is a function from plain data and one parameter struct to plain data. Libraries and
//! scenes can be saved as JSON and read again. The same input, parameters and seed give the same
//! bytes on any number of threads. The method is that of Palazzolo, van Kaick and Mould, "By-Example
//! Synthesis of Vector Textures" (2025), called "the paper" in this documentation.
//!
//! # Example
//! From a picture to an SVG twice as wide:
//! ```
//! use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
//! use vtex::output::svg::{self, SvgOptions};
//! use vtex::procedural::{Kind, SceneParams, generate};
//! use vtex::scene::SynthParams;
//! use vtex::segment::Regions;
//! use vtex::synth::synthesize;
//!
//! // A generated picture stands for a photograph.
//! let params = SceneParams { width: 96, height: 96, kind: Kind::Pebbles, size: 20.0, ..Default::default() };
//! let mut png = std::io::Cursor::new(Vec::new());
//! generate(&params)?.image.write_to(&mut png, image::ImageFormat::Png)?;
//!
//! let exemplar = Exemplar::from_bytes(&png.into_inner(), "pebbles.png", &Limits::default())?;
//! let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &())?;
//! let scene = synthesize(&library, &SynthParams { width: 192, height: 96, ..Default::default() }, &())?;
//! let mut bytes = Vec::new();
//! svg::write(&scene, &SvgOptions::default(), &mut bytes)?;
//! assert!(bytes.starts_with(b"<?xml") || bytes.starts_with(b"<svg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `()` as the last argument of a stage means that nobody listens to its progress; see [`Progress`].

#![forbid(unsafe_code)]

mod disjoint_sets;
mod document;
pub mod error;
mod fourier;
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
pub mod element;
#[cfg(feature = "onnx")]
pub mod engine;
pub mod flow;
pub mod geometry;
pub mod import;
pub mod interpolate;
pub mod lattice;
pub mod layers;
pub mod library;
pub mod metrics;
pub mod output;
pub mod pixels;
pub mod procedural;
pub mod raster;
mod reconstruct;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod segment;
pub mod statistics;
pub mod synth;
pub mod transfer;
pub mod tune;
pub mod warp;

pub use error::{Error, Result};
pub use progress::Progress;

/// Name and version of this program, as written into its files.
pub const PROGRAM: &str = concat!("vtex ", env!("CARGO_PKG_VERSION"));
