//! The arguments of `vtex batch`.

use super::jobs::JobSource;
use super::values::{Extension, Forced, Shard};
use crate::cli::format::Lists;
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

/// Make textures of many photographs or libraries
#[derive(Args)]
#[command(
    override_usage = "vtex batch [OPTIONS] --out-dir <DIR> <INPUT>...",
    mut_args(common(&["size", "tile"])),
    after_long_help = "\
Examples:
  vtex batch photos --out-dir textures --size 1000 --seed 7
  vtex batch a.jpg b.lib.json --out-dir textures --format svgz,scene.json.gz
  vtex batch jobs.toml --out-dir textures --shard 2/8 --json

If a job fails, the others continue, and the exit code is 1. DIR/batch.jsonl
records all jobs. Run the command again, and it skips jobs that were done with
the same input and parameters. A job during which the program was killed twice
is skipped; --force=NAME tries it again.

A file of jobs starts with the keys of --config, for all jobs. Then each [[job]]
has input (beside the file), output (a name without extension), format, and keys
for this job only, as in [job.synth]."
)]
pub(crate) struct BatchArgs {
    /// Photographs, drawings, libraries, folders, or one .toml file of jobs. Of a folder: all pictures, and
    /// SVGs that vtex did not write, by name
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) input: Vec<PathBuf>,
    /// Folder for the results, which are named after their inputs; vtex creates it if needed
    #[arg(short = 'o', long, value_name = "DIR", required = true)]
    pub(crate) out_dir: Option<PathBuf>,
    /// Formats to write for each job: {formats} [default: svg]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    #[arg(value_parser = one_of(Extension::names(), str::parse::<Extension>), hide_possible_values = true)]
    #[arg(fills("{formats}", &Extension::names().join(", ")))]
    pub(crate) format: Option<Vec<Extension>>,
    /// Do all jobs again, or those of --force=NAME,..., and replace existing files even if vtex did
    /// not write them
    #[arg(short, long, value_name = "NAME,...", help_heading = "Output")]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = Forced::ALL)]
    pub(crate) force: Option<Forced>,
    /// Do only part I of N, to share the jobs between machines: every N-th job from the I-th [1/1 to
    /// 10000/10000, default: 1/1]
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
