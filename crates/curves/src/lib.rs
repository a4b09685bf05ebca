//! Textures of lines that run on, after chapter 2 of Tu's dissertation, *Continuous Curve Textures*.
//!
//! Strokes become a graph of samples: at their ends, crossings and corners, and at even distances between. Patches of
//! the exemplar are laid side by side so that curves go on across their borders. On three levels, from coarse to fine,
//! the neighbourhoods of samples are searched in the exemplar, and vote on where samples are, which are missing or too
//! many, and which are joined. Then the samples become paths again.
//!
//! Beyond the paper, an edge of the result follows one of the exemplar, so that its course survives, and loose ends that
//! the exemplar does not have are joined or removed.
//!
//! [`curves_beside`] goes on from lines that stand already, in a region beside them.
//!
//! Works badly for structure larger than a few neighbourhoods, such as long straight lines or letters, and where equal
//! curves lie nearer to one another than the sample distance.

mod context;
mod edges;
mod exemplar;
mod existence;
mod graph;
mod initial;
mod input;
mod joints;
mod measures;
mod mend;
mod optimise;
mod output;
mod partition;
mod positions;
mod quilt;
mod search;
#[cfg(test)]
mod tests;
mod trace;

pub use context::CurveContext;
pub use exemplar::{CurveElement, CurveExemplar, CurveStroke};
pub use graph::CurveGraph;
pub use measures::CurveMeasures;
pub use mend::CurveMends;
pub use optimise::{
    CurveLevel, CurveParams, CurveParts, CurveResult, PlacedCurveElement, curves, curves_beside,
};
pub use partition::CellShape;
pub use quilt::{CellExemplar, CellParams, QuiltedCell, quilted_cells};
pub use trace::TracedCurve;
