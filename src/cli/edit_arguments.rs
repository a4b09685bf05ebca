//! The arguments of `vtex edit`, and what they ask for once they are checked.

use super::arguments::{ForceArgs, SvgFlags};
use super::config::SvgParameters;
use super::failure::Failure;
use super::input::Input;
use super::operations::{self, Asked};
use super::output::Target;
use clap::Args;
use std::path::PathBuf;

/// Change a scene: thin, tint, turn, replace its elements, put shadows under them, and more
#[derive(Args)]
#[command(
    override_usage = "vtex edit [OPTIONS] <SCENE> --op <OPERATION>...",
    after_help = "\
Examples:
  vtex edit out.scene.json -o thin.svg --op 'thin 0.5 --layer secondary'
  vtex edit out.scene.json -o red.scene.json --op 'tint #ff0000 --amount 0.4' --op 'shadow --length 6'
  vtex edit --list

Operations are done in the order given; the scene keeps a record of them. Random choices follow the
scene's seed, unless --seed gives another."
)]
pub(crate) struct EditArgs {
    /// The scene, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE")]
    pub(crate) scene: Option<PathBuf>,
    /// An operation with its own flags, in quotes; may be given again and again. --list explains all
    #[arg(long, value_name = "OPERATION", allow_hyphen_values = true)]
    pub(crate) op: Vec<String>,
    /// Explain all operations and do nothing else
    #[arg(long)]
    pub(crate) list: bool,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout
    /// [default: ./SCENE.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// What is done to which scene, and where the result goes.
pub(crate) enum Editing {
    /// All operations are explained.
    List,
    Edit {
        scene: Input,
        operations: Vec<Asked>,
        seed: Option<u64>,
        svg: SvgParameters,
        target: Target,
    },
}

/// The operations, each checked.
pub(crate) fn operations(texts: &[String]) -> anyhow::Result<Vec<Asked>> {
    if texts.is_empty() {
        let failure = Failure::usage("nothing says what to do to the scene");
        return Err(failure.hint("give operations with --op; 'vtex edit --list' explains them").into());
    }
    let read = |name: &str| Input::File(PathBuf::from(name)).read();
    texts.iter().map(|text| operations::parse(text, read)).collect()
}
