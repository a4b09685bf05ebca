//! All jobs of a batch, checked as far as they can be without reading the inputs.

use super::arguments::BatchArgs;
use super::jobs::{self, BatchJob};
use super::values::Shard;
use crate::cli::command::Resolved;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::options::control::Steering;
use crate::cli::options::engine::engine;
use crate::cli::options::files::plain;
use crate::cli::options::masks::{SamFrom, masks_from};
use crate::cli::values::Seed;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use vtex::engine::EngineOptions;

/// A batch, checked as far as it can be without reading the inputs.
pub(crate) struct Batch {
    /// All jobs, of all shards.
    pub(crate) jobs: Vec<BatchJob>,
    pub(crate) out_dir: PathBuf,
    pub(crate) shard: Shard,
    pub(crate) force: bool,
    pub(crate) engine: EngineOptions,
    pub(crate) steering: Steering,
    /// The seed of jobs without their own.
    pub(crate) seed: Seed,
}

impl Batch {
    /// Checks the whole batch before any work starts.
    ///
    /// # Errors Usage errors, and errors of reading folders.
    pub(crate) fn new(arguments: BatchArgs, resolved: &Resolved) -> anyhow::Result<Self> {
        let Resolved { parameters, seed, config, values, .. } = resolved;
        let Some(source) = arguments.source else {
            return Err(Failure::usage("no input is given").into());
        };
        let Some(out_dir) = arguments.out_dir else {
            return Err(Failure::usage("--out-dir is missing").into());
        };
        let sam = SamFrom::new(arguments.sam);
        let jobs = jobs::list(source, config.as_ref(), values, arguments.format.as_deref(), |segmenter| {
            masks_from(None, segmenter, sam.clone())
        })?;
        let steering = Steering::new(arguments.control, Vec::new());
        check_distinct(&jobs, &steering, &out_dir)?;
        let engine = engine(arguments.engine, parameters.threads);
        let (shard, force) = (arguments.shard.unwrap_or(Shard::WHOLE), arguments.force);
        Ok(Self { jobs, out_dir, shard, force, engine, steering, seed: *seed })
    }
}

/// Fails if a file would be read and written, or standard input read by every job.
fn check_distinct(jobs: &[BatchJob], steering: &Steering, out_dir: &Path) -> Result<(), Failure> {
    let folder = plain(out_dir);
    let results: BTreeSet<PathBuf> =
        jobs.iter().flat_map(BatchJob::files).map(|file| folder.join(file)).collect();
    let check = |name: &str, path: &Path| {
        if !results.contains(&plain(path)) {
            return Ok(());
        }
        let message = format!("{name} and a result name the same file, '{}'", path.display());
        Err(Failure::usage(message).hint("give --out-dir another folder"))
    };
    for job in jobs {
        check("an input", &job.input)?;
    }
    for (flag, file) in steering.files() {
        let Input::File(path) = file else {
            let failure = Failure::usage(format!("{flag} cannot be standard input here"));
            return Err(failure.hint("it is read for every job; name a file"));
        };
        check(flag, path)?;
    }
    Ok(())
}
