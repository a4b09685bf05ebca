//! `vtex models`: the networks of Segment Anything that the user has.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::foreign::escaped;
use crate::cli::models::{DESCRIPTION, FileState, Model, ModelFolder};
use crate::cli::options::engine::{EngineArgs, engine};
use crate::cli::output::{print_json, print_styled, say};
use crate::cli::summary::bytes;
use crate::cli::values::Name;
use anstyle::Style;
use clap::{Args, Subcommand};
use serde::Serialize;
use std::path::PathBuf;

/// Manage models of Segment Anything for --segmenter sam
#[derive(Args)]
#[command(
    subcommand_required = true,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_long_help = "\
Examples:
  vtex models add encoder.onnx decoder.onnx --name mobile-sam
  vtex models list
  vtex models verify
  vtex models remove mobile-sam

Models are stored in vtex/models in your data folder, or in the folder that
VTEX_MODELS names. Nothing is ever downloaded."
)]
pub(crate) struct ModelsArgs {
    #[command(subcommand)]
    pub(crate) action: ModelsAction,
}

#[derive(Subcommand)]
pub(crate) enum ModelsAction {
    /// Add a model: copy its encoder and decoder, or one file with both
    #[command(after_help = "Examples:\n  vtex models add encoder.onnx decoder.onnx --name mobile-sam")]
    Add(ModelsAddArgs),
    /// List all models with their files
    List,
    /// Check that all files are still as they were when added
    Verify,
    /// Delete a model
    Remove {
        /// Name of the model
        #[arg(value_name = "NAME")]
        name: Name,
    },
}

/// The files of a model.
#[derive(Args)]
pub(crate) struct ModelsAddArgs {
    /// The ONNX files in any order, with the files of their weights if these are separate
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Name of the model: letters, digits, - and _
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Name,
    /// Replace an existing model of that name
    #[arg(short, long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

impl Arguments for ModelsArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let threads = resolved.parameters.threads;
        Ok(Box::new(move |common, _| run(common, self.action, threads)))
    }
}

fn run(common: &Common, action: ModelsAction, threads: Option<u16>) -> anyhow::Result<()> {
    let store = ModelFolder::open()?;
    match action {
        ModelsAction::Add(a) => {
            let model = store.add(&a.files, a.name.as_str(), a.force, &engine(a.engine, threads))?;
            if common.json {
                return json("models add", "model", &model);
            }
            if !common.quiet {
                let place = store.folder().join(&model.name);
                say(&format!("{}: {}, in '{}'", model.name, model.kind, place.display()));
            }
            Ok(())
        }
        ModelsAction::List => {
            let models = store.models()?;
            if common.json {
                return json("models list", "models", &models);
            }
            if models.is_empty() && !common.quiet {
                return print_styled(&format!(
                    "no models in '{}'\n",
                    escaped(&store.folder().display().to_string())
                ));
            }
            print_styled(&models.iter().map(show).collect::<String>())
        }
        ModelsAction::Verify => verify(common, &store),
        ModelsAction::Remove { name } => {
            store.remove(name.as_str())?;
            if !common.quiet && !common.json {
                say(&format!("{}: removed", name.as_str()));
            }
            Ok(())
        }
    }
}

/// A file of a model and its state.
#[derive(Serialize)]
struct Verified {
    model: String,
    file: String,
    state: FileState,
}

fn verify(common: &Common, store: &ModelFolder) -> anyhow::Result<()> {
    let mut all = Vec::new();
    for model in store.models()? {
        let files = store.verify(&model)?;
        all.extend(files.into_iter().map(|(file, state)| Verified {
            model: model.name.clone(),
            file,
            state,
        }));
    }
    all.extend(store.undescribed()?.into_iter().map(|model| Verified {
        model,
        file: DESCRIPTION.into(),
        state: FileState::Missing,
    }));
    let bad = all.iter().filter(|v| v.state != FileState::Good).count();
    if common.json {
        json("models verify", "files", &all)?;
    } else {
        let line = |v: &Verified| {
            let state = match v.state {
                FileState::Good => "as it was added",
                FileState::Changed => "CHANGED",
                FileState::Missing => "MISSING",
            };
            format!("{}/{}: {state}", v.model, v.file)
        };
        print_styled(&all.iter().map(|v| escaped(&line(v)) + "\n").collect::<String>())?;
    }
    if bad > 0 {
        let failure = Failure::failed(format!("{bad} of {} files are not as they were added", all.len()));
        return Err(failure.hint("add the model again with 'vtex models add --force'").into());
    }
    Ok(())
}

/// A model in a few lines, for people.
pub(super) fn show(model: &Model) -> String {
    let head = Style::new().bold();
    let mut text = format!("{head}{}{head:#}: {}\n", escaped(&model.name), escaped(&model.kind));
    for file in &model.files {
        text.push_str(&format!(
            "  {}, {}, {}\n    sha256 {}\n",
            escaped(&file.file),
            file.role.title(),
            bytes(file.bytes),
            escaped(&file.sha256)
        ));
    }
    text
}

/// Prints what a command found, under a name.
fn json(command: &str, name: &str, value: &impl Serialize) -> anyhow::Result<()> {
    let report = serde_json::json!({ "program": vtex::PROGRAM, "command": command, name: value });
    print_json(&report, false)
}
