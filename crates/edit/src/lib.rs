//! Changes scenes: operations, transfer of appearance, interpolation, flow.

pub mod edit;
pub mod flow;
pub mod interpolate;
pub mod transfer;
