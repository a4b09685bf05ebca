//! The library's stages as the commands call them.

use super::failure::Failure;
use super::input::{Input, Kind};
use super::models::{Store, sums_of_network};
use super::options::{Analysis, Common, DomainFrom, How, MasksFrom, SamFrom, Steering};
use super::output::{Place, say};
use super::progress::Reporter;
use super::values::Name;
use image::RgbImage;
use vtex::analyze::{Exemplar, Limits};
use vtex::control;
use vtex::engine::{Choice, EngineOptions, Runtime, Source, choose};
use vtex::library::Library;
use vtex::scene::{Scene, SynthParams};
use vtex::segment::prompt::{Generator, GeneratorParams, Sam};
use vtex::segment::texton::Texton;
use vtex::segment::{Felzenszwalb, MasksFile, Regions, ScoredMask, Segmenter, masks_to_bytes};
use vtex::synth::{Controls, Report};
use vtex::warp::Bend;
use vtex::{Error, Progress, Result};

/// Photograph → library; saves the masks if asked.
pub(super) fn analyze(common: &Common, analysis: &Analysis, reporter: &Reporter) -> anyhow::Result<Library> {
    reporter.stage("reading")?;
    let bytes = analysis.photo.read()?;
    Kind::expect(&bytes, &analysis.photo, &[Kind::Image, Kind::Unknown])?;
    let name = match &analysis.photo {
        Input::Stdin => "-".into(),
        Input::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy(),
    };
    let exemplar = Exemplar::from_bytes(&bytes, &name, &Limits::default())?;
    drop(bytes);
    let segmenter = segmenter(common, analysis, reporter)?;
    let saving = Saving { segmenter, place: analysis.save_masks.as_ref() };
    Ok(vtex::analyze::analyze(&exemplar, &saving, &analysis.parameters, reporter)?)
}

/// Loads what finds masks.
fn segmenter(
    common: &Common,
    analysis: &Analysis,
    reporter: &Reporter,
) -> anyhow::Result<Box<dyn Segmenter>> {
    match &analysis.masks {
        MasksFrom::File(path) => return Ok(Box::new(MasksFile::read(path)?)),
        MasksFrom::Felzenszwalb => return Ok(Box::new(Felzenszwalb::default())),
        MasksFrom::Regions => return Ok(Box::new(Regions)),
        MasksFrom::Auto | MasksFrom::Texton | MasksFrom::Sam(_) => {}
    }
    reporter.stage("loading")?;
    let Some(from) = sam_from(&analysis.masks) else {
        return Ok(Box::new(Texton::new(&for_texton(&analysis.engine))?));
    };
    let sam = sam(&from, &analysis.engine)?;
    if common.verbosity > 0 && !common.json {
        say(&format!("{}{}", sam.title(), why_not(&analysis.engine)));
    }
    Ok(Box::new(Generator::new(Box::new(sam), GeneratorParams::default())?))
}

/// The network of Segment Anything that finds masks, if one does.
fn sam_from(masks: &MasksFrom) -> Option<SamFrom> {
    match masks {
        MasksFrom::Sam(from) => Some(from.clone()),
        // Without a folder for models there are none.
        MasksFrom::Auto => {
            let any = Store::open().is_ok_and(|s| s.names().is_ok_and(|names| !names.is_empty()));
            any.then_some(SamFrom::Model(None))
        }
        _ => None,
    }
}

/// All that masks depend on but the photograph and its parameters, as text: what finds them, sums of
/// files, the engine.
pub(super) fn finds_masks(masks: &MasksFrom, options: &EngineOptions) -> anyhow::Result<String> {
    let engine = |engine: &EngineOptions| {
        Ok::<_, Error>(match choose(engine)? {
            Choice::OnnxRuntime { version, .. } => format!("ONNX Runtime {version}"),
            Choice::Rten { .. } => "rten".to_owned(),
        })
    };
    Ok(match (masks, sam_from(masks)) {
        (_, Some(from)) => {
            let sums = match &from {
                SamFrom::Files(files) => {
                    let sums: Vec<Vec<String>> =
                        files.iter().map(|path| sums_of_network(path)).collect::<Result<_>>()?;
                    sums.concat()
                }
                SamFrom::Model(name) => {
                    let store = Store::open()?;
                    store.sums(&model_name(&store, name.as_ref())?)?
                }
            };
            format!("sam {} {}", sums.join(" "), engine(options)?)
        }
        (MasksFrom::Regions, None) => "regions".into(),
        (MasksFrom::Felzenszwalb, None) => "felzenszwalb".into(),
        (MasksFrom::File(path), None) => format!("file {}", sums_of_network(path)?.join(" ")),
        (_, None) => format!("texton {}", engine(&for_texton(options))?),
    })
}

/// What runs the network that is part of the program: ONNX Runtime only if asked for by name, so
/// that masks do not depend on what else is installed.
fn for_texton(engine: &EngineOptions) -> EngineOptions {
    let unnamed = engine.runtime == Runtime::Auto && engine.library.is_none();
    EngineOptions { runtime: if unnamed { Runtime::Rten } else { engine.runtime }, ..engine.clone() }
}

/// Loads Segment Anything.
fn sam(from: &SamFrom, engine: &EngineOptions) -> anyhow::Result<Sam> {
    let files = match from {
        SamFrom::Files(files) => files.clone(),
        SamFrom::Model(name) => {
            let store = Store::open()?;
            store.networks(&model_name(&store, name.as_ref())?)?
        }
    };
    let files: Vec<Source<'_>> = files.iter().map(|path| Source::File(path)).collect();
    Ok(Sam::open(&files, engine)?)
}

/// The model that is named, or the only one.
fn model_name(store: &Store, name: Option<&Name>) -> anyhow::Result<String> {
    let names = store.names()?;
    match (name, &names[..]) {
        (Some(name), _) => Ok(name.as_str().to_owned()),
        (None, [only]) => Ok(only.clone()),
        (None, []) => {
            let failure = Failure::failed("there is no model of Segment Anything");
            let hint = "add one with 'vtex models add', or name its files with --encoder and --decoder";
            Err(failure.hint(hint).into())
        }
        (None, several) => {
            let message = format!("there are several models: {}", several.join(", "));
            Err(Failure::usage(message).hint("choose one with --model").into())
        }
    }
}

/// Why ONNX Runtime does not run networks though it may, for people.
pub(super) fn why_not(engine: &EngineOptions) -> String {
    match choose(engine) {
        Ok(Choice::Rten { because: Some(reason) }) => format!(" ({reason})"),
        _ => String::new(),
    }
}

/// A segmenter that also saves what it finds.
struct Saving<'a> {
    segmenter: Box<dyn Segmenter>,
    place: Option<&'a Place>,
}

impl Segmenter for Saving<'_> {
    fn name(&self) -> String {
        self.segmenter.name()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        let masks = self.segmenter.segment(image, progress)?;
        if let Some(place) = self.place {
            let (width, height) = image.dimensions();
            let bytes = masks_to_bytes(place.path(), &self.name(), width, height, &masks)?;
            place.write(|out| out.write_all(&bytes).map_err(|e| Error::write(place.path(), e)))?;
        }
        Ok(masks)
    }
}

/// Reads the files that steer the synthesis of so many libraries.
pub(super) fn controls(
    steering: &Steering,
    parameters: &SynthParams,
    libraries: usize,
) -> anyhow::Result<Controls> {
    let canvas = [parameters.width, parameters.height];
    let read = |file: &Input, wanted, hint: &str| -> anyhow::Result<(String, Vec<u8>)> {
        let bytes = file.read()?;
        Kind::expect(&bytes, file, &[wanted, Kind::Unknown]).map_err(|failure| failure.hint(hint))?;
        Ok((file.name(), bytes))
    };
    let a_picture = "a map is a picture, such as a PNG";
    let domain = match &steering.domain {
        None => None,
        Some(DomainFrom::Shape(file)) => {
            let (name, bytes) = read(file, Kind::Svg, "a shape is an SVG; a picture is given with --mask")?;
            Some(control::shape(&bytes, &name, canvas)?)
        }
        Some(DomainFrom::Mask(file)) => {
            let (name, bytes) =
                read(file, Kind::Image, "a mask is a picture; an SVG is given with --domain")?;
            Some(control::mask(&bytes, &name, canvas)?)
        }
    };
    let density = match &steering.density {
        None => None,
        Some(file) => {
            let (name, bytes) = read(file, Kind::Image, a_picture)?;
            Some(control::density(&bytes, &name)?)
        }
    };
    let maps = steering.maps.iter().map(|file| read(file, Kind::Image, a_picture));
    let maps = maps.collect::<anyhow::Result<Vec<_>>>()?;
    let maps: Vec<(&str, &[u8])> = maps.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
    let shares = if maps.is_empty() { Vec::new() } else { control::shares(&maps, libraries)? };
    Ok(Controls { domain, density, shares })
}

/// Libraries → scene, and how close it came to what was wanted.
pub(super) fn synthesize(
    libraries: &[Library],
    parameters: &SynthParams,
    controls: &Controls,
    reporter: &Reporter,
) -> Result<(Scene, Report)> {
    vtex::synth::synthesize_with(libraries, parameters, controls, reporter)
}

/// Reads a scene.
pub(super) fn scene(input: &Input) -> anyhow::Result<Scene> {
    let bytes = input.read()?;
    Kind::expect(&bytes, input, &[Kind::Scene, Kind::Unknown])
        .map_err(|failure| failure.hint("make a scene with 'vtex synth photo.lib.json -o out.scene.json'"))?;
    Ok(Scene::from_bytes(&bytes, &input.name())?)
}

/// Reads libraries.
pub(super) fn libraries(inputs: &[Input]) -> anyhow::Result<Vec<Library>> {
    let read = |input: &Input| {
        let bytes = input.read()?;
        // What is nothing known may still be a damaged library, and reading it says where.
        Kind::expect(&bytes, input, &[Kind::Library, Kind::Unknown])?;
        Ok(Library::from_bytes(&bytes, &input.name())?)
    };
    inputs.iter().map(read).collect()
}

/// Scene → the way that it is bent.
pub(super) fn bend(scene: &Scene, how: &How) -> anyhow::Result<Bend> {
    let read = |file: &Input| {
        let bytes = file.read()?;
        Kind::expect(&bytes, file, &[Kind::Svg, Kind::Unknown])
            .map_err(|failure| failure.hint("a cage is drawn as an SVG with one closed path"))?;
        anyhow::Ok(control::cage(&bytes, &file.name())?)
    };
    Ok(match how {
        How::Scale(factors) => Bend::scale(scene, *factors)?,
        How::Cage([before, after]) => {
            let (before, _) = read(before)?;
            let (after, canvas) = read(after)?;
            Bend::cage(before, after, canvas)?
        }
    })
}

/// Library → the exemplar as a scene.
pub(super) fn reconstruct(library: &Library) -> Scene {
    vtex::synth::reconstruct(library)
}
