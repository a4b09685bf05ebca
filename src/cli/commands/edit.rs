//! `vtex edit`: scene → scene, operation by operation.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::{CommandLineValues, Parameters};
use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists};
use crate::cli::input::Input;
use crate::cli::operations::{self, ParsedOperation};
use crate::cli::options::files::{ForceArgs, Makes, check_files, outputs, required, targets};
use crate::cli::options::render::{RenderFlags, RenderParameters};
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{DrawingOptions, Targets, print, print_json, say};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::{ElementCounts, Summary};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use vtex::Progress;
use vtex::edit::{self, Files, Operation, Outcome};
use vtex::output::file::Format;

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "edited" };

/// Change a scene: thin, tint, turn, replace, shadow, and more
#[derive(Args)]
#[command(
    override_usage = "vtex edit [OPTIONS] <SCENE> --op <OPERATION>...",
    after_long_help = "\
Examples:
  vtex edit out.scene.json -o thin.svg --op 'thin 0.5 --layer secondary'
  vtex edit out.scene.json -o red.svg --op 'tint red' --op 'shadow --length 6'
  vtex edit --list

Operations run in the order given, and the scene records them. Random choices
follow the scene's seed, unless you give --seed."
)]
pub(crate) struct EditArgs {
    /// The scene, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE")]
    pub(crate) scene: Option<PathBuf>,
    /// Operation with its flags, in quotes; for several, repeat --op. --list explains all
    #[arg(long, value_name = "OPERATION", allow_hyphen_values = true)]
    pub(crate) op: Vec<String>,
    /// Explain all operations, and stop
    #[arg(long)]
    pub(crate) list: bool,
    /// Result: {formats} [default: ./SCENE.edited.svg]
    ///
    /// The file extension sets the format. - writes SVG to stdout. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = MAKES.allowed)]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// The operations, their scene, and the place of the result.
pub(crate) struct Editing {
    scene: Input,
    pub(crate) operations: Vec<ParsedOperation>,
    pub(crate) seed: Option<u64>,
    svg: SvgParameters,
    render: RenderParameters,
    targets: Targets,
}

impl Arguments for EditArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        if self.list {
            return Ok(Box::new(|_, _| print(operations::list().as_bytes())));
        }
        let editing = Editing::new(*self, resolved.parameters, &Input::read)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &editing)))
    }
}

impl Editing {
    /// Checks the options; `read` gives the bytes of a file.
    pub(crate) fn new(
        a: EditArgs,
        parameters: Parameters,
        read: &dyn Fn(&Input) -> vtex::Result<Vec<u8>>,
    ) -> anyhow::Result<Self> {
        let scene = required(a.scene)?;
        let operations = parsed(&a.op, read)?;
        check_files(&[("the scene", &scene)], &outputs(&a.output))?;
        let targets = targets(a.output, &a.force, &scene, MAKES)?;
        let Parameters { seed, svg, render, .. } = parameters;
        let seed = seed.map(|s| s.0);
        Ok(Self { scene, operations, seed, svg, render, targets })
    }
}

/// The operations, each checked.
fn parsed(
    texts: &[String],
    read: &dyn Fn(&Input) -> vtex::Result<Vec<u8>>,
) -> anyhow::Result<Vec<ParsedOperation>> {
    if texts.is_empty() {
        let failure = Failure::usage("nothing says what to do to the scene");
        return Err(failure.hint("give operations with --op; 'vtex edit --list' explains them").into());
    }
    let read = |name: &str| read(&Input::File(PathBuf::from(name)));
    texts.iter().map(|text| operations::parse(text, read)).collect()
}

/// The summary in JSON.
#[derive(Serialize)]
struct EditSummary<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    operations: Vec<OperationReport<'a>>,
}

/// The text of an operation, and its outcome.
#[derive(Serialize)]
struct OperationReport<'a> {
    operation: &'a str,
    #[serde(flatten)]
    outcome: Outcome,
}

fn run(common: &Common, reporter: &Reporter, editing: &Editing) -> anyhow::Result<()> {
    let Editing { scene: input, operations: asked, seed, svg, render, targets } = editing;
    targets.probe()?;
    if let Some(warning) = render.warning(targets.any_uses(|uses| uses.scale)) {
        reporter.warn(warning);
    }
    reporter.stage("reading")?;
    let scene = reading::scene(input)?;
    let canvas = [scene.width, scene.height];
    let read = |name: &str| Input::File(PathBuf::from(name)).read();
    let operations: Vec<Operation> = asked.iter().map(|a| a.operation.clone()).collect();
    let files = Files::read(&operations, canvas, read)?;
    reporter.stage("editing")?;
    let (scene, outcomes) = edit::apply(scene, &operations, &files, *seed)?;
    let done = asked.iter().zip(outcomes);
    let done: Vec<OperationReport<'_>> =
        done.map(|(a, outcome)| OperationReport { operation: &a.text, outcome }).collect();
    for OperationReport { operation, .. } in done.iter().filter(|d| d.outcome.matched == 0) {
        reporter.warn(&format!("'{operation}' matches nothing: the scene stays as it was"));
    }
    reporter.stage("writing")?;
    let drawing = DrawingOptions { svg: *svg, render: *render, recipe: None };
    let written = targets.write_scene(&scene, None, drawing)?;
    let summary = Summary {
        seed: scene.edits.last().map(|e| e.seed),
        size: drawing.size_of(&scene, targets.first.kind.format),
        page: drawing.page(&scene),
        counts: Some(ElementCounts::of_scene(&scene)),
        ..Summary::new("edit", vec![input.name()], targets.path(), written, reporter)
    };
    let piped = targets.piped();
    if common.json {
        return print_json(&EditSummary { summary: &summary, operations: done }, piped);
    }
    if !common.quiet {
        done.iter().for_each(|done| say(&line(done)));
    }
    // The seed is that of the scene or was given, so it is not reported.
    summary.print(&Common { seed_chosen: false, debug_folder: None, ..*common }, piped)
}

/// The outcome of an operation.
fn line(done: &OperationReport<'_>) -> String {
    let OperationReport { operation, outcome: Outcome { matched, removed, thin } } = done;
    let thin = match thin {
        0 => String::new(),
        count => format!(", {count} too thin to be drawn anew and left as they are"),
    };
    let removed = if *removed > 0 { format!(", {removed} removed") } else { String::new() };
    format!("  {operation}: {matched} selected{removed}{thin}")
}
