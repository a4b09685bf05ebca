//! `vtex completions`: what a shell sources.

use crate::cli::{arguments, output};
use clap_complete::Shell;

pub(super) fn run(shell: Shell) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut arguments::command(), "vtex", &mut script);
    output::print(&script)
}
