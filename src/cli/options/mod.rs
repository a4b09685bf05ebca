//! Groups of options that several commands share: as types for clap, and as checked values.

pub(crate) mod analyze;
pub(crate) mod control;
pub(crate) mod engine;
pub(crate) mod files;
pub(crate) mod frames;
pub(crate) mod global;
pub(crate) mod layers;
pub(crate) mod masks;
pub(crate) mod pattern;
pub(crate) mod preset;
pub(crate) mod render;
pub(crate) mod svg;
pub(crate) mod synth;
pub(crate) mod variants;
