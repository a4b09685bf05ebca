//! The command line: what is asked ([`arguments`]) becomes validated [`Options`], a command in
//! [`commands`] does it, and its end is an [`Exit`] code. No algorithms here.

pub(crate) mod arguments;
mod batch;
mod batch_arguments;
pub(crate) mod commands;
mod config;
mod edit_arguments;
mod exit;
pub(crate) mod failure;
mod format;
mod input;
mod interp_arguments;
pub(crate) mod interrupt;
mod metrics_arguments;
mod models;
mod nearest;
mod operations;
mod options;
pub(crate) mod output;
mod progress;
pub(crate) mod raw_arguments;
mod stages;
mod summary;
mod table;
mod values;

pub(crate) use arguments::Cli;
pub(crate) use exit::Exit;
pub(crate) use options::Options;

/// Sets the number of threads that work is spread over; by default all cores.
pub(crate) fn use_threads(threads: Option<u16>) -> anyhow::Result<()> {
    #[cfg(feature = "parallel")]
    if let Some(threads) = threads {
        rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global()?;
    }
    let _ = threads;
    Ok(())
}
