//! The arguments of `vtex batch`.

use super::jobs::JobSource;
use super::values::{Extension, Forced, Shard};
use crate::cli::options::analyze::AnalyzeFlags;
use crate::cli::options::common;
use crate::cli::options::control::ControlArgs;
use crate::cli::options::engine::EngineArgs;
use crate::cli::options::masks::SamArgs;
use crate::cli::options::preset::PresetArgs;
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::options::synth::SynthFlags;
use crate::cli::values::one_of;
use clap::Args;
use std::path::PathBuf;

/// Textures of many photographs or libraries
#[derive(Args)]
#[command(
    override_usage = "vtex batch [OPTIONS] --out-dir <DIR> <INPUT>...",
    mut_args(common(&["size", "tile"])),
    after_long_help = "\
Examples:
  vtex batch photos --out-dir textures --size 1000 --seed 7
  vtex batch a.jpg b.lib.json --out-dir textures --format svgz,scene.json.gz
  vtex batch jobs.toml --out-dir textures --shard 2/8 --json

A job that fails does not stop the others; the exit code is then 1. Run again, jobs that were done
from the same input and parameters are skipped: DIR/batch.jsonl records them. A job during which the
program was killed twice is left out; --force=NAME tries it again. A file of jobs has the keys of
--config at its top, for all jobs, then a [[job]] for each, with input (beside the file), output (a
name without extension), format, and keys for this job alone, as in [job.synth]."
)]
pub(crate) struct BatchArgs {
    /// Photographs, drawings, libraries, folders (all pictures in them, and SVGs that vtex did not write, by
    /// name), or one .toml file of jobs
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) input: Vec<PathBuf>,
    /// Folder for results, named after their inputs, made if need be
    #[arg(short = 'o', long, value_name = "DIR", required = true)]
    pub(crate) out_dir: Option<PathBuf>,
    /// Formats written for each: svg, svgz, pdf, png, scene.json, scene.json.gz, lib.json,
    /// lib.json.gz [default: svg]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    #[arg(value_parser = one_of(&Extension::ALL, str::parse::<Extension>), hide_possible_values = true)]
    pub(crate) format: Option<Vec<Extension>>,
    /// Do all jobs again, or those of --force=NAME,..., and replace existing files even if vtex did
    /// not write them
    #[arg(short, long, value_name = "NAME,...", help_heading = "Output")]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = Forced::ALL)]
    pub(crate) force: Option<Forced>,
    /// Do only the I-th of N parts of the jobs, for many machines: every N-th from the I-th
    /// [1/1 to 10000/10000, default: 1/1]
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    pub(crate) shard: Option<Shard>,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) synth: SynthFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    #[command(flatten)]
    pub(crate) sam: SamArgs,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
    /// The source of jobs, after it was read.
    #[arg(skip)]
    pub(crate) source: Option<JobSource>,
}
