//! `vtex check`: scene → how well its elements are found again in its picture.

use crate::cli::analysis::{Analysis, segmenter};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::options::engine::{EngineArgs, engine};
use crate::cli::options::files::{check_files, required};
use crate::cli::options::layers::LayerFiles;
use crate::cli::options::masks::MasksFrom;
use crate::cli::output::{print, print_styled};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::table::table;
use clap::Args;
use std::path::PathBuf;
use vtex::analyze::{Exemplar, analyze};
use vtex::output::png;
use vtex::statistics::Cycle;
use vtex::synth::reconstruct;

/// Draw a scene, analyse the picture, and count the elements that are found again
#[derive(Args)]
#[command(
    override_usage = "vtex check [OPTIONS] <SCENE> --library <LIBRARY>",
    after_help = "\
Examples:
  vtex check out.scene.json --library photo.lib.json
  vtex check out.scene.json --library photo.lib.json --json

Large elements count that lie whole on the canvas and are mostly seen. The
picture is analysed with the parameters of the library. Compare the numbers
with those of the library itself, given in place of the scene."
)]
pub(crate) struct CheckArgs {
    /// A scene, or a library as its exemplar is, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) scene: Option<PathBuf>,
    /// The library whose parameters of analysis are used
    #[arg(long, value_name = "LIBRARY", required = true)]
    pub(crate) library: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

/// A scene, and how its picture is analysed.
struct Checking {
    scene: Input,
    library: Input,
    analysis: Analysis,
}

impl Arguments for CheckArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let checking = Checking::new(*self, &resolved)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, checking)))
    }
}

impl Checking {
    fn new(a: CheckArgs, resolved: &Resolved) -> Result<Self, Failure> {
        let (scene, library) = (required(a.scene)?, required(a.library)?);
        // The same file may be both.
        if scene == Input::Stdin {
            check_files(&[("the scene", &scene), ("--library", &library)], &[])?;
        }
        let parameters = &resolved.parameters;
        let analysis = Analysis {
            photo: scene.clone(),
            masks: MasksFrom::Auto,
            engine: engine(a.engine, parameters.threads),
            save_masks: None,
            layers: LayerFiles::default(),
            parameters: parameters.analyze.clone(),
            wrap: None,
            looks_at_borders: false,
        };
        Ok(Self { scene, library, analysis })
    }
}

fn run(common: &Common, reporter: &Reporter, checking: Checking) -> anyhow::Result<()> {
    let Checking { scene: input, library, mut analysis } = checking;
    reporter.stage("reading")?;
    let scene = reading::texture(&input)?;
    let known = reading::libraries(&[library])?.remove(0);
    analysis.parameters = known.source.parameters.clone();
    reporter.stage("drawing")?;
    let pixmap = png::render(&scene, 1.0)?;
    let exemplar = Exemplar {
        image: png::over_white(&pixmap),
        file: input.name(),
        sha256: known.source.sha256.clone(),
        layers: None,
        warnings: Vec::new(),
    };
    let segmenter = segmenter(common, &analysis, reporter)?;
    let again = analyze(&exemplar, &*segmenter, &analysis.parameters, reporter)?;
    let cycle = Cycle::between(&scene, &reconstruct(&again));
    if common.json {
        return print(format!("{}\n", serde_json::to_string_pretty(&cycle)?).as_bytes());
    }
    print_styled(&told(&cycle))
}

/// The numbers, with what they mean.
fn told(cycle: &Cycle) -> String {
    let row =
        |name: &str, value: String, meaning: &str| [name.to_owned(), value, meaning.to_owned()].to_vec();
    table(&[
        ["cycle consistency", "", ""].map(str::to_owned).to_vec(),
        row("elements", cycle.elements.to_string(), "whole on the canvas and mostly seen"),
        row("matched", format!("{:.3}", cycle.matched), "share found again, 0 to 1"),
        row("distance", format!("{:.3}", cycle.distance), "between partners, in roots of the area"),
        row("size", format!("{:.3}", cycle.size), "ratio of their areas, in doublings"),
        row("colour", format!("{:.2}", cycle.colour), "between their medians, in Oklab times 100"),
        row("cost", format!("{:.3}", cycle.cost), "of all together; 0 is perfect, 2 is nothing found"),
    ])
}
