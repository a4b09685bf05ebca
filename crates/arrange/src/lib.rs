//! Library in, scene out: placement, background, composition.

pub mod arrange;
pub mod synth;
pub mod tune;
pub mod warp;
