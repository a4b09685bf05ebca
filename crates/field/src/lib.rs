//! Fields of correspondences: which place of an exemplar each place of a canvas comes from.

pub mod correspondence;
pub mod layers;
pub mod pixels;
