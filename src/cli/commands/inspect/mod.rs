//! `vtex inspect`: what libraries and scenes hold, printed or as a page.

mod page;
mod print;
mod svg;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::input::Input;
use crate::cli::options::files::ForceArgs;
use clap::Args;
use page::PageOptions;
use std::path::PathBuf;

/// Print what a library or a scene contains, or write a page about it
#[derive(Args)]
#[command(
    override_usage = "vtex inspect [OPTIONS] <FILE>...",
    after_long_help = "\
Examples:
  vtex inspect photo.lib.json
  vtex inspect out.scene.json --json | jq .counts
  vtex inspect photo.lib.json out.scene.json -o page.html --exemplar photo.jpg"
)]
pub(crate) struct InspectArgs {
    /// A library, a scene, or an SVG from vtex, plain or gzip; - reads stdin. For a page also a scene and the
    /// libraries that it was made from
    #[arg(value_name = "FILE", required = true)]
    pub(crate) file: Vec<PathBuf>,
    /// Write a page for a browser, .html: pictures with layers and a slider, categories, distributions; -
    /// writes it to stdout [default: none, what the file contains is printed]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    /// Photograph to show on the page, if its SHA-256 is that of the exemplar; you can give several [default:
    /// the file of that name beside the library]
    #[arg(long, value_name = "PHOTO", requires = "output", help_heading = "Output")]
    pub(crate) exemplar: Vec<PathBuf>,
}

impl Arguments for InspectArgs {
    fn job(self: Box<Self>, _: Resolved) -> anyhow::Result<Job> {
        let files: Vec<Input> = self.file.into_iter().map(Input::new).collect();
        let page = PageOptions::new(&files, self.output, self.exemplar, &self.force)?;
        Ok(Box::new(move |common, reporter| match &page {
            Some(page) => page::run(common, reporter, &files, page),
            None => files.iter().try_for_each(|file| print::run(common, file)),
        }))
    }
}
