//! The command line: [`arguments`] are checked and become a job ([`resolve`]), a command in [`commands`]
//! does it, and its end is an exit code. No algorithms here.

mod analysis;
pub(crate) mod arguments;
mod command;
mod commands;
mod common;
mod config;
pub(crate) mod executable;
pub(crate) mod exit;
pub(crate) mod failure;
mod foreign;
mod format;
mod frames;
mod hints;
mod input;
pub(crate) mod interrupt;
mod layer_maps;
mod models;
mod nearest;
mod number;
mod operations;
mod options;
pub(crate) mod output;
pub(crate) mod panics;
pub(crate) mod progress;
pub(crate) mod raw_arguments;
mod reading;
mod recipe;
mod replacing;
pub(crate) mod resolve;
mod summary;
mod synthesis;
mod table;
mod usage;
mod values;
mod weights;

/// Runs work on a number of threads; by default on all cores.
pub(crate) fn on_threads<R: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> anyhow::Result<R> + Send,
) -> anyhow::Result<R> {
    #[cfg(feature = "parallel")]
    return rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .stack_size(STACK)
        .build()?
        .install(work);
    #[cfg(not(feature = "parallel"))]
    {
        let _ = threads;
        work()
    }
}

/// Bytes of each thread's stack, as large as the main thread's.
#[cfg(feature = "parallel")]
const STACK: usize = 8 << 20;
