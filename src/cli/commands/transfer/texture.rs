//! The arrangement of one texture with the appearance of others.

use super::arguments::TransferArgs;
use crate::cli::analysis::{Analysis, texture};
use crate::cli::command::Resolved;
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::files::{Makes, check_files, outputs, required, targets};
use crate::cli::options::render::RenderParameters;
use crate::cli::options::svg::SvgParameters;
use crate::cli::output::{DrawingOptions, Targets, print_json, say};
use crate::cli::progress::Reporter;
use crate::cli::summary::{ElementCounts, Summary};
use serde::Serialize;
use vtex::Progress;
use vtex::control;
use vtex::output::file::Format;
use vtex::transfer::{TransferParams, TransferReport, transfer};

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "transfer" };

/// Textures, the parameters of the transfer, and the outputs.
pub(super) struct Transferring {
    structure: Analysis,
    appearances: Vec<Analysis>,
    map: Option<Input>,
    params: TransferParams,
    svg: SvgParameters,
    render: RenderParameters,
    targets: Targets,
}

impl Transferring {
    pub(super) fn new(a: TransferArgs, resolved: &Resolved) -> Result<Self, Failure> {
        let structure = required(a.structure)?;
        let appearances: Vec<Input> = a.appearance.into_iter().map(Input::new).collect();
        let map = a.map.map(Input::new);
        let mut read = vec![("--structure", &structure)];
        read.extend(appearances.iter().map(|file| ("--appearance", file)));
        read.extend(map.iter().map(|file| ("--map", file)));
        check_files(&read, &outputs(&a.output))?;
        match (appearances.len(), &map) {
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
            scale: a.element_scale,
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

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Transferring) -> anyhow::Result<()> {
    let Transferring { structure, appearances, map, params, svg, render, targets } = job;
    targets.probe()?;
    if let Some(warning) = render.warning(targets.any_uses(|uses| uses.scale)) {
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
        page: drawing.page(&scene),
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
    summary.print(common, piped)
}
