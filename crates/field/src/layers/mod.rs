//! Layers: nested regions of a weathered surface, found in a photograph and made anew.
//!
//! A layer map has one label for each pixel, 0 at the bottom. The region S_i of layer i holds all pixels
//! whose label is i or more, so regions are nested: S_2 lies in S_1. [`find`] splits a photograph into
//! layers. [`LayerExemplar::carried`] and [`LayerExemplar::optimised`] make a new map of any size: the first copies
//! labels along a correspondence field, the second is the boundary optimisation of Rosenberger, Cohen-Or
//! and Lischinski, "Layered Shape Synthesis" (2009), called "the paper" here. [`LayerExemplar::sketched`] and
//! [`LayerExemplar::filled`] start from a given map. [`Terrain`] makes height maps.
//!
//! Works badly where two phenomena lie side by side without nesting, and where a layer has a recognisable
//! shape: only the local character of borders is kept.

mod boundary;
mod carried;
mod carrier;
mod clean;
mod continuous;
mod extent;
mod find;
mod map;
mod names;
mod optimised;
mod order;
mod outlines;
mod picture;
mod refine;
mod regions;
mod separation;
mod sketched;
mod terrain;
mod whole_elements;

pub use boundary::shape_distance;
pub use carried::LayerExemplar;
pub use carrier::Carrier;
pub use continuous::{continuous, discrete};
pub use find::{Count, Decision, FindParams, FoundLayers, LayerSearch, find};
pub use map::{Contacts, LayerMap, LayerRegion, MOST_LAYERS, MapLayer};
pub use picture::{LayerPicture, hole};
pub use terrain::Terrain;

#[cfg(test)]
mod figures;
#[cfg(test)]
mod testing;
