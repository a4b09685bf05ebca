//! `vtex man`: manual pages from the same definitions as the help.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::output::Destination;
use clap::Args;
use std::path::{Path, PathBuf};
use vtex::Error;

/// Write the man pages to a folder
#[derive(Args)]
#[command(
    hide = true,
    after_long_help = "\
Examples:
  vtex man ~/.local/share/man/man1"
)]
pub(crate) struct ManArgs {
    /// The folder; vtex creates it if needed
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

impl Arguments for ManArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        Ok(Box::new(move |_, _| run(&self.folder, (resolved.program)())))
    }
}

fn run(folder: &Path, command: clap::Command) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
    // `vtex help` prints the help of the others and has no page.
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let commands = command.get_subcommands().flat_map(|c| std::iter::once(c).chain(c.get_subcommands()));
    for command in std::iter::once(&command).chain(commands) {
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        let path = folder.join(format!("{name}.1"));
        // Manual pages are replaced even if another program wrote the existing file.
        let place = Destination::File { path, force: true };
        let page = clap_mangen::Man::new(command.clone()).source(vtex::PROGRAM);
        place.write(|out| page.render(&mut *out))?;
    }
    Ok(())
}
