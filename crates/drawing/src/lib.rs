//! SVG read: drawings as exemplars, shapes and maps that steer synthesis.

pub mod control;
pub mod import;
pub mod svg_tree;
