//! Arrangements of elements by optimisation of clustered samples, after Tu, Wei and Zwicker, *Clustered Vector Textures*
//! (ACM Transactions on Graphics 41, 4, 2022).
//!
//! Elements are clusters of samples. On three levels, from coarse to fine, neighbourhoods of samples are searched in the
//! exemplar, samples move to where the neighbourhoods found want them, samples that most of them miss are added, and
//! clusters change, merge and split. Then every cluster becomes the element of the exemplar that it resembles most.
//!
//! Beyond the paper, elements are mended one by one between the levels: what clashes is parted or removed, gaps are
//! filled. Elements keep their angles and sizes: they are only moved.
//!
//! Works badly for elements that reach over more than half the page, and for structure larger than a few elements, which
//! no neighbourhood sees.

mod balance;
mod board;
mod clustering;
mod context;
mod cut;
mod depth;
mod existence;
mod figures;
mod holes;
mod initial;
mod input;
mod mend;
mod optimise;
mod output;
mod positions;
mod raster;
mod rebuild;
mod relations;
mod search;
mod shape_energy;
mod standing;
#[cfg(test)]
mod tests;
mod votes;

pub use clustering::{ClusterOperations, ClusteringParts};
pub use figures::{ClusterExemplar, Figure, FigurePlace};
pub use mend::MendCounts;
pub use optimise::{
    ClusterParams, ClusterResult, ClusterSample, ClusteredElement, LevelReport, cluster, cluster_beside,
};
pub use standing::ClusterContext;
pub use vtex_base::geometry::plane::PeriodicPlane;
