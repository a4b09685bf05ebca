//! Options that all commands share.

use std::path::PathBuf;

/// Options that all commands share.
#[derive(Clone, Debug)]
pub(crate) struct Common {
    /// Number of threads, if given.
    pub(crate) threads: Option<u16>,
    /// Whether no seed was given.
    pub(crate) seed_chosen: bool,
    pub(crate) quiet: bool,
    /// 0, 1 or 2.
    pub(crate) verbosity: u8,
    pub(crate) json: bool,
    pub(crate) debug_folder: Option<PathBuf>,
}
