//! The work of the commands, done in memory: each is read from its command line as the program itself reads
//! it, so what the page shows is what the command would write.

use super::command_lines::{Commands, Wanted, Words};
use super::opened::Opened;
use super::results::Key;
use super::settings::{PALETTE, StudioSettings};
use crate::cli::analysis::{KnownBefore, library_of};
use crate::cli::command::{Arguments, Merged, Resolved};
use crate::cli::commands::analyze::AnalyzeArgs;
use crate::cli::commands::edit::{EditArgs, Editing};
use crate::cli::commands::render::RenderArgs;
use crate::cli::commands::synth::SynthArgs;
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::global::Global;
use crate::cli::output::{Buffer, Destination, DrawingOptions, Target};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::synthesis::heavy;
use clap::{Args, Parser};
use std::path::PathBuf;
use std::sync::Arc;
use vtex::Progress;
use vtex::analyze::AnalysisMemory;
use vtex::edit::{self, Files, Operation};
use vtex::library::Library;
use vtex::output::file::{FileKind, Format};
use vtex::output::png;
use vtex::scene::{Scene, SynthParams};
use vtex::segment::{MasksFile, Segmenter};
use vtex::synth::{SynthesisMemory, synthesize_again};
use vtex_studio::Caller;

/// A command line of one command.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct CommandLine<A: Args> {
    #[command(flatten)]
    global: Global,
    #[command(flatten)]
    arguments: A,
}

/// The arguments of a command, read.
struct ReadCommand<A> {
    arguments: A,
    common: Common,
    resolved: Resolved,
}

/// Reads the words of a command after its name.
fn read<A: Args + Arguments>(words: &[String]) -> anyhow::Result<ReadCommand<A>> {
    let parsed = CommandLine::<A>::try_parse_from(words.iter().skip(1));
    let CommandLine { global, mut arguments } = parsed.map_err(|e| {
        let text = e.to_string();
        let first = text.lines().next().unwrap_or_default();
        Failure::usage(first.trim_start_matches("error: ").to_owned())
    })?;
    let merged = Merged::new(&global, Some(&mut arguments))?;
    let (common, resolved) = merged.resolved(global, || clap::Command::new("vtex"));
    Ok(ReadCommand { arguments, common, resolved })
}

/// Who hears of the progress of work, and may stop it.
pub(super) type Listener = Arc<dyn Progress + Send>;

/// The commands whose results are shown.
pub(super) fn shown(opened: &Opened, settings: &StudioSettings) -> Commands {
    Commands::new(opened, settings, Wanted { format: Format::Svg, scale: None })
}

/// What an analysis depends on.
pub(super) fn analysis_key(opened: &Opened, settings: &StudioSettings) -> Key {
    let masks = settings.masks.as_ref().map(|masks| masks.sha256.clone()).unwrap_or_default();
    [vec![opened.sha256.clone(), masks], shown(opened, settings).analyze.unwrap_or_default()].concat()
}

/// Does `vtex analyze`.
///
/// # Errors
/// Options out of range, and those of the analysis.
pub(super) fn analyze(
    opened: &Opened,
    settings: &StudioSettings,
    words: &Words,
    memory: &mut AnalysisMemory,
    listener: Listener,
) -> anyhow::Result<Library> {
    let ReadCommand { arguments, common, resolved } = read::<AnalyzeArgs>(words)?;
    let (analysis, _) = arguments.analysis(&resolved.parameters)?;
    let reporter = Reporter::listening(&common, listener)?;
    let masks = settings.masks.as_ref().map(|file| {
        let name = file.path.file_name().unwrap_or(file.path.as_os_str()).to_string_lossy();
        MasksFile::from_bytes(file.bytes.clone(), &name)
    });
    let masks = masks.transpose()?.map(|masks| Box::new(masks) as Box<dyn Segmenter>);
    let known = KnownBefore { masks, memory: Some(memory) };
    library_of(&common, &analysis, opened.bytes.clone(), known, &reporter)
}

/// The canvas and page of `vtex synth`, without content.
///
/// # Errors
/// Options out of range.
pub(super) fn canvas_of(library: &Library, words: &Words) -> anyhow::Result<Scene> {
    let ReadCommand { arguments, resolved, .. } = read::<SynthArgs>(words)?;
    let (_, synthesis) = arguments.synthesis(resolved.parameters)?;
    let SynthParams { width, height, page, .. } = synthesis.canvas(std::slice::from_ref(library));
    Ok(Scene { page, ..Scene::new([width, height], Vec::new(), Vec::new()) })
}

/// Does `vtex synth`; with `most`, on a canvas of no more square pixels. `memory` is that of the last synthesis.
///
/// # Errors
/// Options out of range, and those of the synthesis.
pub(super) fn synthesize(
    library: &Library,
    settings: &StudioSettings,
    words: &Words,
    most: Option<f64>,
    (memory, listener): (&SynthesisMemory, &Listener),
) -> anyhow::Result<Scene> {
    let ReadCommand { arguments, resolved, .. } = read::<SynthArgs>(words)?;
    let (_, synthesis) = arguments.synthesis(resolved.parameters)?;
    let libraries = std::slice::from_ref(library);
    let mut parameters = synthesis.canvas(libraries);
    if let Some(most) = most {
        let area = f64::from(parameters.width) * f64::from(parameters.height);
        let share = (most / area).sqrt().min(1.0);
        let reduced = |side: u32| ((f64::from(side) * share) as u32).max(1);
        (parameters.width, parameters.height) = (reduced(parameters.width), reduced(parameters.height));
        parameters.page = parameters.page.map(|page| page.map(|side| side.times(share)));
    }
    if let (None, Some([warning, hint])) = (most, heavy(&parameters, libraries, false)) {
        listener.warn(&format!("{warning}; {hint}"));
    }
    let controls = reading::controls(&synthesis.steering, &parameters, 1, &|input| settings.file(input))?;
    let (scene, _) = synthesize_again(libraries, &parameters, &controls, memory, &**listener)?;
    Ok(scene)
}

/// Does `vtex edit`.
///
/// # Errors
/// Operations that cannot be done.
pub(super) fn edit(scene: &Scene, settings: &StudioSettings, words: &Words) -> anyhow::Result<Scene> {
    let ReadCommand { arguments, resolved, .. } = read::<EditArgs>(words)?;
    let palette = |input: &Input| palette_of(settings, input);
    let Editing { operations, seed, .. } = Editing::new(arguments, resolved.parameters, &palette)?;
    let operations: Vec<Operation> = operations.into_iter().map(|asked| asked.operation).collect();
    let canvas = [scene.width, scene.height];
    let read = |name: &str| Err(vtex::Error::read(&PathBuf::from(name), no_file()));
    let files = Files::read(&operations, canvas, read)?;
    Ok(edit::apply(scene.clone(), &operations, &files, seed)?.0)
}

/// The colours of the palette that operations may name.
fn palette_of(settings: &StudioSettings, input: &Input) -> vtex::Result<Vec<u8>> {
    let known = settings.files.get(PALETTE).filter(|file| file.path == input.path());
    known.map(|file| file.bytes.clone()).ok_or_else(|| vtex::Error::read(input.path(), no_file()))
}

/// The page has no other files for operations.
fn no_file() -> std::io::Error {
    std::io::Error::other("the studio has no files for operations")
}

/// The bytes that the last of some commands writes.
///
/// # Errors
/// Options out of range, and those of the writers.
pub(super) fn write(
    opened: &Opened,
    commands: &Commands,
    format: Format,
    library: Option<&Library>,
    scene: Option<&Scene>,
    caller: &Caller,
) -> anyhow::Result<Vec<u8>> {
    let buffer = Buffer::of(caller);
    let kind = FileKind { format, gzip: false };
    let target = Target { place: Destination::Memory(buffer.clone()), kind };
    match (format, library, scene) {
        (Format::Library, Some(library), _) => drop(target.write_bytes(&library.to_json())?),
        (_, _, Some(scene)) => {
            let drawing = drawing(opened, commands)?;
            if format.uses().scale {
                check_picture(scene, &drawing, format)?;
            }
            target.write_scene(scene, drawing)?;
        }
        _ => return Err(Failure::failed("there is nothing to save yet").into()),
    }
    Ok(buffer.take())
}

/// Most pixels of a PNG that the page saves: it is in memory as a whole, four bytes each.
const MOST_PIXELS: f64 = 100e6;

/// Fails if a file of a scene would have too many pixels.
fn check_picture(scene: &Scene, drawing: &DrawingOptions<'_>, format: Format) -> Result<(), Failure> {
    let [width, height] = drawing.size_of(scene, format);
    let pixels = |scale: f64| scale * scale * f64::from(scene.width) * f64::from(scene.height);
    if f64::from(width) * f64::from(height) <= MOST_PIXELS {
        return Ok(());
    }
    let title = format.writer().endings[0].title;
    let message = format!("a {title} of {width} x {height} px is too large for the studio");
    let most = (10.0 * (MOST_PIXELS / pixels(1.0)).sqrt()).floor() / 10.0;
    Err(Failure::failed(message)
        .hint(format!("set a scale of at most {most}, or run the command below, which has no such limit")))
}

/// How the last of some commands draws a scene.
///
/// # Errors
/// Options out of range.
pub(super) fn drawing(opened: &Opened, commands: &Commands) -> anyhow::Result<DrawingOptions<'static>> {
    let parameters = match (&commands.last, &commands.synth) {
        (Some(words), _) if opened.kind == InputKind::Scene && words[0] == "render" => {
            read::<RenderArgs>(words)?.resolved.parameters
        }
        (Some(words), _) => read::<EditArgs>(words)?.resolved.parameters,
        (None, Some(words)) => read::<SynthArgs>(words)?.resolved.parameters,
        (None, None) => return Err(Failure::failed("there is no texture to draw").into()),
    };
    Ok(DrawingOptions { svg: parameters.svg, render: parameters.render, recipe: None })
}

/// Checks all options and operations, without work.
///
/// # Errors
/// The first that is wrong.
pub(super) fn check(opened: &Opened, settings: &StudioSettings) -> anyhow::Result<()> {
    let commands = shown(opened, settings);
    let Commands { analyze, synth, last } = &commands;
    if let Some(words) = analyze {
        let ReadCommand { arguments, resolved, .. } = read::<AnalyzeArgs>(words)?;
        arguments.analysis(&resolved.parameters)?;
    }
    if let Some(words) = synth {
        let ReadCommand { arguments, resolved, .. } = read::<SynthArgs>(words)?;
        arguments.synthesis(resolved.parameters)?;
    }
    if let Some(words) = last.as_ref().filter(|words| words[0] == "edit") {
        let ReadCommand { arguments, resolved, .. } = read::<EditArgs>(words)?;
        Editing::new(arguments, resolved.parameters, &|input| palette_of(settings, input))?;
    } else {
        drawing(opened, &commands).map(drop)?;
    }
    Ok(())
}

/// Checks a file that steers by its kind of content.
///
/// # Errors
/// Content that `vtex synth` would refuse.
pub(super) fn check_side(option: &str, bytes: &[u8]) -> anyhow::Result<()> {
    match option {
        "density" => vtex::control::density(bytes, option).map(drop)?,
        PALETTE => vtex::control::palette(bytes, option).map(drop)?,
        _ => vtex::control::shape(bytes, option, [100, 100]).map(drop)?,
    }
    Ok(())
}

/// A map of densities as a grey PNG, upright and within the size of control maps.
///
/// # Errors
/// Content that is no picture.
pub(super) fn density_picture(bytes: &[u8]) -> anyhow::Result<Vec<u8>> {
    let map = vtex::control::density(bytes, "density")?;
    let [width, height] = map.size();
    let canvas = [width, height].map(f64::from);
    let grey = |x: u32, y: u32| {
        let density = map.at([x, y].map(|v| f64::from(v) + 0.5), canvas);
        image::Rgb([(density * 127.5).round() as u8; 3])
    };
    let mut png = Vec::new();
    png::encode_rgb(&image::RgbImage::from_fn(width, height, grey), &mut png)?;
    Ok(png)
}
