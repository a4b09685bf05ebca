//! `vtex integrate`: vtex in the menus of other programs.

mod check;
mod files;
mod folder;
mod host;
mod programs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::output::{print_json, say};
use clap::Args;
use files::Installation;
use folder::{OWN, usual_folder};
use host::Host;
use std::path::{Path, PathBuf};

/// Add vtex to the menu of Inkscape or GIMP
#[derive(Args)]
#[command(after_long_help = "\
Examples:
  vtex integrate inkscape
  vtex integrate inkscape --check
  vtex integrate gimp --remove

This command replaces and removes only files of vtex.")]
pub(crate) struct IntegrateArgs {
    /// The program to extend
    #[arg(value_enum, value_name = "PROGRAM")]
    pub(crate) host: Host,
    /// Report what is installed and what is missing; write nothing
    #[arg(long)]
    pub(crate) check: bool,
    /// Remove the files that vtex installed
    #[arg(long, conflicts_with = "check")]
    pub(crate) remove: bool,
    /// Folder to install to [default: vtex in your folder of extensions]
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

impl Arguments for IntegrateArgs {
    fn job(self: Box<Self>, _: Resolved) -> anyhow::Result<Job> {
        let named = self.folder.as_deref();
        if self.host == Host::Gimp && named.is_some_and(|folder| !folder.ends_with(OWN)) {
            let failure = Failure::usage("GIMP finds the plug-in only in a folder with the name 'vtex'");
            return Err(failure.hint("add /vtex to --folder").into());
        }
        Ok(Box::new(move |common, _| run(common, *self)))
    }
}

fn run(common: &Common, arguments: IntegrateArgs) -> anyhow::Result<()> {
    let IntegrateArgs { host, check, remove, folder } = arguments;
    let folder = match folder {
        Some(folder) => folder,
        None => usual_folder(host)?,
    };
    let installation = Installation::new(host.facts(), folder)?;
    if check {
        return check::check(common, &installation);
    }
    let place = &installation.folder;
    let (title, menu) = (installation.host.title, installation.host.menu);
    if remove {
        let count = installation.remove()?;
        let text = match count {
            0 => format!("no files of vtex in '{}'", place.display()),
            1 => format!("removed 1 file from '{}'", place.display()),
            n => format!("removed {n} files from '{}'", place.display()),
        };
        return report(common, host, place, ("removed", count), &text);
    }
    let count = installation.install()?;
    let text = match count {
        0 => format!("already installed in '{}': see {menu} in {title}", place.display()),
        _ => format!("installed in '{}': restart {title}, then look under {menu}", place.display()),
    };
    report(common, host, place, ("written", count), &text)
}

/// Reports what was done: a number of files under a name, or a sentence.
fn report(
    common: &Common,
    host: Host,
    folder: &Path,
    (name, count): (&str, usize),
    text: &str,
) -> anyhow::Result<()> {
    if common.json {
        let report = serde_json::json!({
            "program": vtex::PROGRAM,
            "command": "integrate",
            "host": host.facts().word,
            "folder": folder.display().to_string(),
            name: count,
        });
        return print_json(&report, false);
    }
    if !common.quiet {
        say(text);
    }
    Ok(())
}
