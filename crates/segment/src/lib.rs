//! Masks of the elements in a photograph: region merging, prompts, the texton network, files.

pub mod segment;
