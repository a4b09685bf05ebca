//! Segment Anything: its exports in ONNX, and the engines that run them.

pub mod engine;
mod sam;

pub use sam::{Sam, SamRole, recognise};
