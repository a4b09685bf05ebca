//! The commands, one file or folder for each.

mod analyze;
mod animate;
mod batch;
mod check;
mod completions;
mod doctor;
mod edit;
mod inspect;
mod interp;
mod layers;
mod man;
mod metrics;
mod models;
mod raster;
mod render;
mod stylize;
mod synth;
mod texture;
mod transfer;
mod tune;
mod vectorize;
mod warp;

use super::command::Arguments;
use clap::Subcommand;

/// Any command, with its arguments.
#[derive(Subcommand)]
pub(crate) enum Command {
    Texture(Box<texture::TextureArgs>),
    Vectorize(vectorize::VectorizeArgs),
    Analyze(analyze::AnalyzeArgs),
    Synth(synth::SynthArgs),
    Batch(Box<batch::BatchArgs>),
    Warp(warp::WarpArgs),
    Edit(edit::EditArgs),
    Transfer(transfer::TransferArgs),
    Stylize(stylize::StylizeArgs),
    Tune(tune::TuneArgs),
    Render(render::RenderArgs),
    Interp(interp::InterpArgs),
    Animate(animate::AnimateArgs),
    Layers(Box<layers::LayersArgs>),
    Raster(raster::RasterArgs),
    Inspect(inspect::InspectArgs),
    Metrics(metrics::MetricsArgs),
    Check(check::CheckArgs),
    Doctor(doctor::DoctorArgs),
    Models(models::ModelsArgs),
    Completions(completions::CompletionsArgs),
    Man(man::ManArgs),
}

impl Command {
    /// Its arguments.
    pub(crate) fn arguments(self) -> Box<dyn Arguments> {
        match self {
            Self::Texture(a) => a,
            Self::Vectorize(a) => Box::new(a),
            Self::Analyze(a) => Box::new(a),
            Self::Synth(a) => Box::new(a),
            Self::Batch(a) => a,
            Self::Warp(a) => Box::new(a),
            Self::Edit(a) => Box::new(a),
            Self::Transfer(a) => Box::new(a),
            Self::Stylize(a) => Box::new(a),
            Self::Tune(a) => Box::new(a),
            Self::Render(a) => Box::new(a),
            Self::Interp(a) => Box::new(a),
            Self::Animate(a) => Box::new(a),
            Self::Layers(a) => a,
            Self::Raster(a) => Box::new(a),
            Self::Inspect(a) => Box::new(a),
            Self::Metrics(a) => Box::new(a),
            Self::Check(a) => Box::new(a),
            Self::Doctor(a) => Box::new(a),
            Self::Models(a) => Box::new(a),
            Self::Completions(a) => Box::new(a),
            Self::Man(a) => Box::new(a),
        }
    }
}
