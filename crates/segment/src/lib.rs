//! Masks of the elements in a photograph: region merging, prompts, networks and their engines.

#[cfg(feature = "onnx")]
pub mod engine;
pub mod segment;
