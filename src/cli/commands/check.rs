//! `vtex check`: scene → the share of its elements that analysis of its picture finds again.

use crate::cli::analysis::{Analysis, segmenter};
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::engine::EngineArgs;
use crate::cli::options::files::{check_files, required};
use crate::cli::output::{print_json, print_styled};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::table::table;
use clap::Args;
use std::path::PathBuf;
use tiny_skia::Pixmap;
use vtex::analyze::{Exemplar, analyze};
use vtex::import::{ImportParams, import};
use vtex::library::AnalyzeParams;
use vtex::output::png;
use vtex::output::raster_svg::render_svg;
use vtex::scene::{Layer, Role, Scene};
use vtex::statistics::Cycle;
use vtex::synth::reconstruct;

/// Draw a scene, analyse the picture, count what is found again
#[derive(Args)]
#[command(
    override_usage = "vtex check [OPTIONS] <SCENE> --library <LIBRARY>",
    after_help = "\
Examples:
  vtex check out.scene.json --library photo.lib.json
  vtex check out.svg --library photo.lib.json --json

Large elements count that lie whole on the canvas and are mostly seen. The
picture is analysed with the parameters of the library. Compare the numbers
with those of the library itself, given in place of the scene. An SVG is read
as a drawing."
)]
pub(crate) struct CheckArgs {
    /// A scene, plain or gzip, an SVG, or a library as its exemplar is; - reads stdin
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
        // The same file may be scene and library.
        if scene == Input::Stdin {
            check_files(&[("the scene", &scene), ("--library", &library)], &[])?;
        }
        let parameters = &resolved.parameters;
        let analysis = Analysis::plain(scene, a.engine, parameters)?;
        Ok(Self { library, analysis })
    }
}

fn run(common: &Common, reporter: &Reporter, checking: Checking) -> anyhow::Result<()> {
    let Checking { library, mut analysis } = checking;
    reporter.stage("reading")?;
    let known = reading::libraries(&[library])?.remove(0);
    analysis.parameters = known.source.parameters.clone();
    let bytes = analysis.input.read()?;
    let wanted = [InputKind::Scene, InputKind::Library, InputKind::Svg, InputKind::Unknown];
    let (scene, picture) = match InputKind::expect(&bytes, &analysis.input, &wanted)? {
        InputKind::Svg => of_svg(&bytes, &analysis, reporter)?,
        _ => {
            let scene = reading::texture_of(bytes, &analysis.input)?;
            reporter.stage("drawing")?;
            let picture = png::render(&scene, 1.0)?;
            (scene, picture)
        }
    };
    analysis.parameters.wrap = scene.tile.both();
    let exemplar = Exemplar {
        image: png::over_white(&picture),
        file: analysis.input.name(),
        sha256: known.source.sha256.clone(),
        layers: None,
        warnings: Vec::new(),
    };
    let segmenter = segmenter(common, &analysis, reporter)?;
    let again = analyze(&exemplar, &*segmenter, &analysis.parameters, reporter)?;
    let cycle = Cycle::between(&scene, &reconstruct(&again));
    if common.json {
        return print_json(&cycle, false);
    }
    print_styled(&told(&cycle))
}

/// The elements of an SVG at its own size, and its picture. Where layers are named as vtex names them, the large
/// elements alone count.
fn of_svg(bytes: &[u8], analysis: &Analysis, reporter: &Reporter) -> anyhow::Result<(Scene, Pixmap)> {
    let name = analysis.input.name();
    // Parts that import leaves out are drawn nevertheless.
    let lenient = AnalyzeParams { lenient: true, ..AnalyzeParams::default() };
    let params = ImportParams { analyze: lenient, ..ImportParams::default() };
    let mut scene = reconstruct(&import(bytes, &name, &params, reporter)?);
    let picture = render_svg(bytes, 1.0, &name, reporter)?;
    let is_primary = |layer: &Layer| {
        let last = layer.name.rsplit(' ').next().unwrap_or_default();
        last.eq_ignore_ascii_case(Role::Primary.name())
    };
    if scene.layers.iter().any(is_primary) {
        scene.layers.retain(is_primary);
    }
    // A drawing is enlarged where its elements are small.
    let size = f64::from(picture.width()) / f64::from(scene.width);
    scene.instances_mut().for_each(|i| i.transform = i.transform.map(|v| v * size));
    (scene.width, scene.height) = (picture.width(), picture.height());
    Ok((scene, picture))
}

/// The numbers with explanations.
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
