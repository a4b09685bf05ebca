//! `vtex models`: the networks of Segment Anything that the user has.

use crate::cli::failure::Failure;
use crate::cli::models::{Model, State, Store};
use crate::cli::options::{Common, ModelsJob};
use crate::cli::output::{print, print_styled, say};
use crate::cli::summary::bytes;
use anstyle::Style;
use serde::Serialize;

pub(super) fn run(common: &Common, job: &ModelsJob) -> anyhow::Result<()> {
    let store = Store::open()?;
    match job {
        ModelsJob::Add { files, name, force, engine } => {
            let model = store.add(files, name.as_str(), *force, engine)?;
            if common.json {
                return json(&model);
            }
            if !common.quiet {
                let place = store.folder().join(&model.name);
                say(&format!("{}: {}, in '{}'", model.name, model.kind, place.display()));
            }
            Ok(())
        }
        ModelsJob::List => {
            let models = store.models()?;
            if common.json {
                return json(&models);
            }
            if models.is_empty() && !common.quiet {
                say(&format!("no models in '{}'", store.folder().display()));
            }
            print_styled(&models.iter().map(show).collect::<String>())
        }
        ModelsJob::Verify => verify(common, &store),
        ModelsJob::Remove(name) => {
            store.remove(name.as_str())?;
            if !common.quiet && !common.json {
                say(&format!("{}: removed", name.as_str()));
            }
            Ok(())
        }
    }
}

/// A file of a model, as it is now.
#[derive(Serialize)]
struct Verified {
    model: String,
    file: String,
    state: State,
}

fn verify(common: &Common, store: &Store) -> anyhow::Result<()> {
    let mut all = Vec::new();
    for model in store.models()? {
        let files = store.verify(&model)?;
        all.extend(files.into_iter().map(|(file, state)| Verified {
            model: model.name.clone(),
            file,
            state,
        }));
    }
    let bad = all.iter().filter(|v| v.state != State::Good).count();
    if common.json {
        json(&all)?;
    } else {
        let line = |v: &Verified| {
            let state = match v.state {
                State::Good => "as it was added",
                State::Changed => "CHANGED",
                State::Missing => "MISSING",
            };
            format!("{}/{}: {state}\n", v.model, v.file)
        };
        print(all.iter().map(line).collect::<String>().as_bytes())?;
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
    let mut text = format!("{head}{}{head:#}: {}\n", model.name, model.kind);
    for file in &model.files {
        let sum = &file.sha256;
        text.push_str(&format!(
            "  {}, {}, {}\n    sha256 {sum}\n",
            file.file,
            file.role.title(),
            bytes(file.bytes)
        ));
    }
    text
}

fn json(value: &impl Serialize) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    print(text.as_bytes())
}
