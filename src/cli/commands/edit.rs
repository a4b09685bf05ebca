//! `vtex edit`: scene → scene, operation by operation.

use crate::cli::config::SvgParameters;
use crate::cli::edit_arguments::Editing;
use crate::cli::input::Input;
use crate::cli::options::Common;
use crate::cli::output::{Place, Target, print, say};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Summary};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use vtex::Progress;
use vtex::edit::{self, Need, Operation, Outcome, Parameter, Request};

pub(super) fn run(common: &Common, reporter: &Reporter, editing: &Editing) -> anyhow::Result<()> {
    match editing {
        Editing::List => print(list().as_bytes()),
        Editing::Edit { scene, requests, seed, svg, target } => {
            edit_scene(common, reporter, scene, requests, *seed, *svg, target)
        }
    }
}

/// The summary in JSON.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    operations: &'a [Outcome],
}

fn edit_scene(
    common: &Common,
    reporter: &Reporter,
    input: &Input,
    requests: &[Request],
    seed: Option<u64>,
    svg: SvgParameters,
    target: &Target,
) -> anyhow::Result<()> {
    target.place.probe()?;
    reporter.stage("reading")?;
    let scene = stages::scene(input)?;
    let canvas = [scene.width, scene.height];
    let read = |name: &str| Input::File(PathBuf::from(name)).read();
    let operations =
        requests.iter().map(|r| r.load(canvas, read)).collect::<vtex::Result<Vec<Operation>>>()?;
    reporter.stage("editing")?;
    let (scene, outcomes) = edit::apply(scene, &operations, seed)?;
    for outcome in outcomes.iter().filter(|o| o.matched == 0) {
        reporter.warn(&format!("'{}' matches nothing: the scene stays as it was", outcome.operation));
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
        let text = serde_json::to_string_pretty(&Told { summary: &summary, operations: &outcomes })?;
        if piped {
            say(&text);
            return Ok(());
        }
        return print(format!("{text}\n").as_bytes());
    }
    if !common.quiet {
        outcomes.iter().for_each(|outcome| say(&line(outcome)));
    }
    // The seed is the scene's own or was given, so there is none to tell.
    summary.tell(&Common { seed_chosen: false, debug_folder: None, ..*common }, piped)
}

/// What an operation came to.
fn line(outcome: &Outcome) -> String {
    let Outcome { operation, matched, removed } = outcome;
    let removed = if *removed > 0 { format!(", {removed} removed") } else { String::new() };
    format!("  {operation}: {matched} matched{removed}")
}

/// All operations, for people.
fn list() -> String {
    let mut text = String::from(
        "Operations of 'vtex edit', each in quotes after --op. Words with spaces in them are quoted again;\n\
         lengths are pixels of the canvas.\n",
    );
    for entry in edit::catalogue() {
        let _ = writeln!(text, "\n{}", entry.usage());
        wrap(&mut text, entry.does, 4);
        entry.parameters.iter().for_each(|p| describe(&mut text, p));
        let _ = writeln!(text, "    Example: --op \"{}\"", entry.example);
    }
    text.push_str("\nEvery operation also takes\n");
    edit::common_parameters().iter().for_each(|p| describe(&mut text, p));
    text
}

fn describe(text: &mut String, parameter: &Parameter) {
    let needed = if parameter.is_flag() && parameter.need == Need::Required { ", needed" } else { "" };
    let range = format!("[{}{needed}]", parameter.range());
    wrap(text, &format!("{}  {} {range}", parameter.title(), parameter.does), 6);
}

/// Adds a paragraph, indented and wrapped at 100 columns.
fn wrap(text: &mut String, paragraph: &str, indent: usize) {
    let mut column = 0;
    for word in paragraph.split(' ') {
        if column == 0 || column + 1 + word.len() > 100 {
            if column > 0 {
                text.push('\n');
            }
            let margin = if column == 0 { indent } else { indent + 4 };
            let _ = write!(text, "{:margin$}{word}", "");
            column = margin + word.len();
        } else {
            let _ = write!(text, " {word}");
            column += 1 + word.len();
        }
    }
    text.push('\n');
}
