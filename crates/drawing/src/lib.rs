//! Reads SVGs and pictures: drawings as exemplars, and shapes and maps that steer synthesis.

pub mod control;
pub mod import;
mod line_art;
pub mod svg_tree;
