//! The commands, one file or folder for each.

mod analyze;
mod animate;
mod batch;
mod completions;
mod doctor;
mod edit;
mod inspect;
mod integrate;
mod layers;
mod man;
mod metrics;
mod models;
mod raster;
mod render;
#[cfg(feature = "studio")]
mod studio;
mod synth;
mod texture;
mod transfer;
mod tune;
mod vectorize;
mod warp;

use super::command::Arguments;
use clap::Subcommand;

/// Any of them, with its arguments, in the order of the help.
#[derive(Subcommand)]
pub(crate) enum Command {
    Texture(Box<texture::TextureArgs>),
    Vectorize(vectorize::VectorizeArgs),
    Batch(Box<batch::BatchArgs>),
    Raster(raster::RasterArgs),
    #[cfg(feature = "studio")]
    Studio(studio::StudioArgs),
    Analyze(analyze::AnalyzeArgs),
    Synth(synth::SynthArgs),
    Render(render::RenderArgs),
    Layers(Box<layers::LayersArgs>),
    Inspect(inspect::InspectArgs),
    Edit(edit::EditArgs),
    Transfer(Box<transfer::TransferArgs>),
    Warp(warp::WarpArgs),
    Animate(Box<animate::AnimateArgs>),
    Metrics(metrics::MetricsArgs),
    Tune(tune::TuneArgs),
    Doctor(doctor::DoctorArgs),
    Models(models::ModelsArgs),
    Integrate(integrate::IntegrateArgs),
    Completions(completions::CompletionsArgs),
    Man(man::ManArgs),
}

impl Command {
    /// Its arguments.
    pub(crate) fn arguments(self) -> Box<dyn Arguments> {
        match self {
            Self::Texture(a) => a,
            Self::Vectorize(a) => Box::new(a),
            Self::Batch(a) => a,
            Self::Raster(a) => Box::new(a),
            #[cfg(feature = "studio")]
            Self::Studio(a) => Box::new(a),
            Self::Analyze(a) => Box::new(a),
            Self::Synth(a) => Box::new(a),
            Self::Render(a) => Box::new(a),
            Self::Layers(a) => a,
            Self::Inspect(a) => Box::new(a),
            Self::Edit(a) => Box::new(a),
            Self::Transfer(a) => a,
            Self::Warp(a) => Box::new(a),
            Self::Animate(a) => a,
            Self::Metrics(a) => Box::new(a),
            Self::Tune(a) => Box::new(a),
            Self::Doctor(a) => Box::new(a),
            Self::Models(a) => Box::new(a),
            Self::Integrate(a) => Box::new(a),
            Self::Completions(a) => Box::new(a),
            Self::Man(a) => Box::new(a),
        }
    }
}
