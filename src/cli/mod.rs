//! The command line: [`arguments`] are checked and become a job ([`resolve`]), a command in [`commands`]
//! does it, and its end is an exit code. No algorithms here.

mod analysis;
pub(crate) mod arguments;
mod command;
mod commands;
mod common;
mod config;
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
mod operations;
mod options;
pub(crate) mod output;
pub(crate) mod progress;
pub(crate) mod raw_arguments;
mod reading;
mod recipe;
pub(crate) mod resolve;
pub(crate) mod short_help;
mod summary;
mod synthesis;
mod table;
mod usage;
mod values;
mod weights;

/// Sets the number of threads that work is spread over; by default all cores.
pub(crate) fn use_threads(threads: Option<u16>) -> anyhow::Result<()> {
    #[cfg(feature = "parallel")]
    if let Some(threads) = threads {
        rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global()?;
    }
    let _ = threads;
    Ok(())
}
