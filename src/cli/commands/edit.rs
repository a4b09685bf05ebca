//! `vtex edit`: scene → scene, operation by operation.

use crate::cli::config::SvgParameters;
use crate::cli::edit_arguments::Editing;
use crate::cli::input::Input;
use crate::cli::operations::{self, Asked};
use crate::cli::options::Common;
use crate::cli::output::{Place, Target, print, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Summary};
use serde::Serialize;
use std::path::PathBuf;
use vtex::Progress;
use vtex::edit::{self, Files, Operation, Outcome};

pub(super) fn run(common: &Common, reporter: &Reporter, editing: &Editing) -> anyhow::Result<()> {
    match editing {
        Editing::List => print(operations::list().as_bytes()),
        Editing::Edit { scene, operations, seed, svg, target } => {
            edit_scene(common, reporter, scene, operations, *seed, *svg, target)
        }
    }
}

/// The summary in JSON.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    operations: Vec<Done<'a>>,
}

/// An operation as it was written, and what it came to.
#[derive(Serialize)]
struct Done<'a> {
    operation: &'a str,
    #[serde(flatten)]
    outcome: Outcome,
}

fn edit_scene(
    common: &Common,
    reporter: &Reporter,
    input: &Input,
    asked: &[Asked],
    seed: Option<u64>,
    svg: SvgParameters,
    target: &Target,
) -> anyhow::Result<()> {
    target.place.probe()?;
    reporter.stage("reading")?;
    let scene = stages::scene(input)?;
    let canvas = [scene.width, scene.height];
    let read = |name: &str| Input::File(PathBuf::from(name)).read();
    let operations: Vec<Operation> = asked.iter().map(|a| a.operation.clone()).collect();
    let files = Files::read(&operations, canvas, read)?;
    reporter.stage("editing")?;
    let (scene, outcomes) = edit::apply(scene, &operations, &files, seed)?;
    let done = asked.iter().zip(outcomes);
    let done: Vec<Done<'_>> = done.map(|(a, outcome)| Done { operation: &a.text, outcome }).collect();
    for Done { operation, .. } in done.iter().filter(|d| d.outcome.matched == 0) {
        reporter.warn(&format!("'{operation}' matches nothing: the scene stays as it was"));
    }
    reporter.stage("writing")?;
    let written = target.write_scene(&scene, svg, 1.0)?;
    let summary = Summary {
        seed: scene.edits.last().map(|e| e.seed),
        size: canvas,
        counts: Some(Counts::of_scene(&scene)),
        ..Summary::new("edit", vec![input.name()], target.place.path(), written, reporter)
    };
    let piped = target.place == Place::Stdout;
    if common.json {
        let text = serde_json::to_string_pretty(&Told { summary: &summary, operations: done })?;
        if piped {
            say(&text);
            return Ok(());
        }
        return print(format!("{text}\n").as_bytes());
    }
    if !common.quiet {
        done.iter().for_each(|done| say(&line(done)));
    }
    // The seed is the scene's own or was given, so there is none to tell.
    summary.tell(&Common { seed_chosen: false, debug_folder: None, ..*common }, piped)
}

/// What an operation came to.
fn line(done: &Done<'_>) -> String {
    let Done { operation, outcome: Outcome { matched, removed } } = done;
    let removed = if *removed > 0 { format!(", {removed} removed") } else { String::new() };
    format!("  {operation}: {matched} matched{removed}")
}
