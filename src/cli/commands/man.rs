//! `vtex man`: manual pages from the same definitions as the help.

use crate::cli::{arguments, output::Place};
use std::path::Path;
use vtex::Error;

pub(super) fn run(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
    let mut command = arguments::command();
    command.build();
    let commands = command.get_subcommands().flat_map(|c| std::iter::once(c).chain(c.get_subcommands()));
    for command in std::iter::once(&command).chain(commands) {
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        let path = folder.join(format!("{name}.1"));
        // These pages are vtex's whoever wrote what stands there now.
        let place = Place::File { path: path.clone(), force: true };
        let page = clap_mangen::Man::new(command.clone());
        place.write(|out| page.render(&mut *out).map_err(|e| Error::write(&path, e)))?;
    }
    Ok(())
}
