//! Scenes changed: operations, transfer to other shapes and pictures, interpolation, flow.

pub mod edit;
pub mod flow;
pub mod interpolate;
pub mod transfer;
