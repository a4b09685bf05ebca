//! `vtex transfer`: the arrangement of one texture with the appearance of others.

use crate::cli::analysis::{Analysis, texture};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::config::CommandLineValues;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::engine::EngineArgs;
use crate::cli::options::files::{ForceArgs, Makes, check_files, outputs, required, targets};
use crate::cli::options::render::{RenderFlags, RenderParameters};
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::{DrawingOptions, Targets, print_json, say};
use crate::cli::progress::Reporter;
use crate::cli::summary::{ElementCounts, Summary};
use crate::cli::values::{between, named, one_of};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use vtex::Progress;
use vtex::control;
use vtex::output::file::Format;
use vtex::scene::TransferMode;
use vtex::transfer::{TransferParams, TransferReport, transfer};

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "transfer" };

/// The arrangement of one texture with the appearance of another
#[derive(Args)]
#[command(
    override_usage = "vtex transfer [OPTIONS] --structure <FILE> --appearance <FILE>...",
    after_help = "\
Examples:
  vtex transfer --structure a.scene.json --appearance b.lib.json -o out.svg
  vtex transfer --structure a.lib.json --appearance b.lib.json --mode mean
  vtex transfer --structure a.json --appearance b.json c.json --map m.png

A library stands for its exemplar as it is; photographs and drawings are
analysed first, as by 'vtex analyze'. Every element keeps its place,
size and direction. What is too thin to be drawn anew keeps its shape and is
counted."
)]
pub(crate) struct TransferArgs {
    /// The texture whose arrangement is kept: a scene or a library, plain or gzip, a photograph or a drawing;
    /// - reads stdin
    #[arg(long, value_name = "FILE", required = true)]
    pub(crate) structure: Option<PathBuf>,
    /// The texture whose appearance is taken over, of the same kinds; several with --map
    #[arg(long, value_name = "FILE", required = true, num_args = 1..)]
    pub(crate) appearance: Vec<PathBuf>,
    /// Where which appearance is used: a picture with one colour for each, in the order of its palette, else
    /// from dark to light; for two, grey will do
    #[arg(long, value_name = "FILE")]
    pub(crate) map: Option<PathBuf>,
    /// Take over the mean colours only, or replace each element by one drawn at random [mean or replace,
    /// default: replace]
    #[arg(long, value_name = "WORD", hide_possible_values = true)]
    #[arg(value_parser = one_of(&["mean", "replace"], named::<TransferMode>))]
    pub(crate) mode: Option<TransferMode>,
    /// Factor of the size of elements [0.01 to 100, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = between(0.01, 100.0))]
    pub(crate) element_scale: Option<f64>,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout; several -o write several files [default: ./STRUCTURE.transfer.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// The textures, and how they are combined and written.
struct Transferring {
    structure: Analysis,
    appearances: Vec<Analysis>,
    map: Option<Input>,
    params: TransferParams,
    svg: SvgParameters,
    render: RenderParameters,
    targets: Targets,
}

impl Arguments for TransferArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let job = Transferring::new(*self, &resolved)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &job)))
    }
}

impl Transferring {
    fn new(a: TransferArgs, resolved: &Resolved) -> Result<Self, Failure> {
        let structure = required(a.structure)?;
        let appearances: Vec<Input> = a.appearance.into_iter().map(Input::new).collect();
        let map = a.map.map(Input::new);
        let mut read = vec![("--structure", &structure)];
        read.extend(appearances.iter().map(|file| ("--appearance", file)));
        read.extend(map.iter().map(|file| ("--map", file)));
        check_files(&read, &outputs(&a.output))?;
        match (appearances.len(), &map) {
            (0, _) => {
                return Err(Failure::usage("no appearance is given").hint("name a library with --appearance"));
            }
            (1, Some(_)) => {
                let failure = Failure::usage("--map chooses between several appearances, and there is one");
                return Err(failure.hint("give --appearance several libraries"));
            }
            (2.., None) => {
                let failure = Failure::usage("nothing says where which appearance is used");
                return Err(failure.hint("give --map a picture with one colour for each appearance"));
            }
            _ => {}
        }
        let targets = targets(a.output, &a.force, &structure, MAKES)?;
        let parameters = &resolved.parameters;
        let params = TransferParams {
            mode: a.mode.unwrap_or_default(),
            scale: a.element_scale.unwrap_or(1.0),
            seed: resolved.seed.0,
        };
        let (svg, render) = (parameters.svg, parameters.render);
        let analysis = |input| Analysis::plain(input, a.engine.clone(), parameters);
        let structure = analysis(structure)?;
        let appearances = appearances.into_iter().map(analysis).collect::<Result<_, _>>()?;
        Ok(Self { structure, appearances, map, params, svg, render, targets })
    }
}

/// The summary in JSON.
#[derive(Serialize)]
struct TransferSummary<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    #[serde(flatten)]
    report: TransferReport,
}

fn run(common: &Common, reporter: &Reporter, job: &Transferring) -> anyhow::Result<()> {
    let Transferring { structure, appearances, map, params, svg, render, targets } = job;
    targets.probe()?;
    if let Some(warning) = render.warning(targets.has(Format::Png)) {
        reporter.warn(warning);
    }
    reporter.stage("reading")?;
    let read = |from| texture(common, from, reporter);
    let scene = read(structure)?;
    let others = appearances.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    let shares = match map {
        Some(file) => {
            let bytes = file.read()?;
            InputKind::expect(&bytes, file, &[InputKind::Image, InputKind::Unknown])
                .map_err(|failure| failure.hint("a map is a picture, such as a PNG"))?;
            control::shares(&[(&file.name(), &bytes)], others.len())?
        }
        None => Vec::new(),
    };
    reporter.stage("transferring")?;
    let (scene, report) = transfer(&scene, &others, &shares, params)?;
    if report.removed > 0 {
        let gone = report.removed;
        reporter.warn(&format!("{gone} elements are gone: the appearance has no large elements, or no small ones, to take their place"));
    }
    reporter.stage("writing")?;
    let drawing = DrawingOptions { svg: *svg, render: *render, recipe: None };
    let written = targets.write_scene(&scene, None, drawing)?;
    let textures = std::iter::once(structure).chain(appearances).map(|from| &from.input);
    let inputs = textures.chain(map).map(Input::name).collect();
    let summary = Summary {
        seed: Some(params.seed),
        size: drawing.size_of(&scene, targets.first.kind.format),
        counts: Some(ElementCounts::of_scene(&scene)),
        ..Summary::new("transfer", inputs, targets.path(), written, reporter)
    };
    let piped = targets.piped();
    if common.json {
        return print_json(&TransferSummary { summary: &summary, report }, piped);
    }
    if !common.quiet && report.thin > 0 {
        say(&format!("  {} elements are too thin to be drawn anew and keep their shape", report.thin));
    }
    summary.tell(common, piped)
}
