//! The two stored data types: libraries, which analysis writes, and scenes, which synthesis writes.

pub mod element;
pub mod lattice;
pub mod library;
pub mod reconstruct;
pub mod scene;
pub mod statistics;
