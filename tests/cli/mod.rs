//! The program as a user runs it in a shell.
#![cfg(feature = "cli")]

mod animate;
mod batch;
mod composing;
mod config;
mod context;
mod damaged;
mod edit;
mod files;
mod fills;
mod help;
mod integrate;
mod large;
mod layers;
mod line_art;
mod messages;
mod metrics;
mod models;
mod output;
mod page;
mod raster;
mod stages;
mod stopping;
#[cfg(feature = "studio")]
mod studio;
mod subtle;
pub(crate) mod support;
mod tune;
