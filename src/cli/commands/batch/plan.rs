//! All jobs of a batch, checked as far as they can be without reading the inputs.

use super::arguments::BatchArgs;
use super::jobs::{self, BatchJob};
use super::values::{Forced, Shard, is_called};
use crate::cli::command::Resolved;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::nearest::nearest;
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
    /// The jobs that are done again, and whose files replace any.
    pub(crate) forced: Option<Forced>,
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
        let (shard, forced) = (arguments.shard.unwrap_or(Shard::WHOLE), arguments.force);
        check_forced(&jobs, forced.as_ref())?;
        Ok(Self { jobs, out_dir, shard, forced, engine, steering, seed: *seed })
    }

    /// Whether a job is done again, and its files replace any.
    pub(crate) fn forces(&self, job: &BatchJob) -> bool {
        self.forced.as_ref().is_some_and(|forced| forced.holds(&job.name, &job.input))
    }
}

/// Fails if `--force` names a job that there is not.
fn check_forced(jobs: &[BatchJob], forced: Option<&Forced>) -> Result<(), Failure> {
    let Some(Forced::Jobs(wanted)) = forced else { return Ok(()) };
    let is_known = |text: &&String| jobs.iter().any(|job| is_called(text, &job.name, &job.input));
    let Some(unknown) = wanted.iter().find(|text| !is_known(text)) else { return Ok(()) };
    let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
    let failure = Failure::usage(format!("--force={unknown} names no job of this batch"));
    Err(failure
        .hint(format!("jobs are named after their results: did you mean '{}'?", nearest(unknown, &names))))
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
