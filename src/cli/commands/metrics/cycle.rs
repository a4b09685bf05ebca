//! Analyses the picture of a scene and compares the elements found with those of the scene.

use crate::cli::analysis::{Analysis, segmenter};
use crate::cli::common::Common;
use crate::cli::input::{Input, InputKind};
use crate::cli::output::{print_json, print_styled};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::table::table;
use tiny_skia::Pixmap;
use vtex::analyze::{Exemplar, analyze};
use vtex::import::{ImportParams, import};
use vtex::library::{AnalyzeParams, EvenLight};
use vtex::output::png;
use vtex::output::raster_svg::render_svg;
use vtex::scene::{Layer, Role, Scene};
use vtex::statistics::Cycle;
use vtex::synth::reconstruct;

/// Counts the elements that analysis of the picture of a scene finds again. `analysis` has the parameters of
/// the library.
pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    library: &Input,
    mut analysis: Analysis,
) -> anyhow::Result<()> {
    reporter.stage("reading")?;
    let known = reading::libraries(std::slice::from_ref(library))?.remove(0);
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
    analysis.parameters.even_light = EvenLight::Off;
    let exemplar = Exemplar {
        image: png::over_white(&picture),
        copies: [1; 2],
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
    print_styled(&text(&cycle))
}

/// The elements of an SVG at its own size, and its picture. If layers are named as by vtex, only large
/// elements count.
fn of_svg(bytes: &[u8], analysis: &Analysis, reporter: &Reporter) -> anyhow::Result<(Scene, Pixmap)> {
    let name = analysis.input.name();
    // The picture also shows parts that import leaves out.
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
fn text(cycle: &Cycle) -> String {
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
