//! Reading of scenes, libraries and control files.

use super::failure::Failure;
use super::input::{Input, InputKind};
use super::layer_maps;
use super::options::control::{DomainFrom, Steering, StructureFrom};
use super::recipe::metadata;
use vtex::control;
use vtex::library::Library;
use vtex::scene::{Method, Scene, SynthParams};
use vtex::synth::{Controls, StructureGuide, layer_map, reconstruct};

/// Reads the files that steer the synthesis of a number of libraries; `bytes` are those of a file.
pub(crate) fn controls(
    steering: &Steering,
    parameters: &SynthParams,
    libraries: usize,
    bytes: &dyn Fn(&Input) -> vtex::Result<Vec<u8>>,
) -> anyhow::Result<Controls> {
    let canvas = [parameters.width, parameters.height];
    let read = |file: &Input, wanted, hint: &str| -> anyhow::Result<(String, Vec<u8>)> {
        let bytes = bytes(file)?;
        InputKind::expect(&bytes, file, &[wanted, InputKind::Unknown])
            .map_err(|failure| failure.hint(hint))?;
        Ok((file.name(), bytes))
    };
    let a_picture = "a map is a picture, such as a PNG";
    let domain = match &steering.domain {
        None => None,
        Some(DomainFrom::Shape(file)) => {
            let (name, bytes) =
                read(file, InputKind::Svg, "a shape is an SVG; a picture is given with --domain-mask")?;
            Some(control::shape(&bytes, &name, canvas)?)
        }
        Some(DomainFrom::Mask(file)) => {
            let (name, bytes) =
                read(file, InputKind::Image, "a mask is a picture; an SVG is given with --domain")?;
            Some(control::mask(&bytes, &name, canvas)?)
        }
    };
    let density = match &steering.density {
        None => None,
        Some(file) => {
            let (name, bytes) = read(file, InputKind::Image, a_picture)?;
            Some(control::density(&bytes, &name)?)
        }
    };
    let maps = steering.maps.iter().map(|file| read(file, InputKind::Image, a_picture));
    let maps = maps.collect::<anyhow::Result<Vec<_>>>()?;
    let maps: Vec<(&str, &[u8])> = maps.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
    let shares = if maps.is_empty() { Vec::new() } else { control::shares(&maps, libraries)? };
    // A fault of the guide is reported before the synthesis.
    match &steering.structure {
        Some(_) if parameters.method == Method::Descriptor => {
            let failure = Failure::usage("--control and --guide lead placement by correspondences");
            return Err(failure.hint("leave out --method descriptor").into());
        }
        Some(StructureFrom::Layers(file @ Input::File(_))) => drop(layer_maps::read(file)?),
        _ => {}
    }
    Ok(Controls { domain, density, shares, ..Controls::default() })
}

/// Reads the guide of the large structure, if there is one.
pub(crate) fn structure_guide(
    steering: &Steering,
    library: &Library,
) -> anyhow::Result<Option<StructureGuide>> {
    Ok(match &steering.structure {
        None => None,
        Some(StructureFrom::Layers(_)) if !library.is_layered() => {
            let failure = Failure::failed("the library has a single layer, so --control has nothing to lead");
            return Err(failure.hint("give --layers 2 or a painted --layer-map to 'vtex analyze'").into());
        }
        Some(StructureFrom::Layers(file)) => {
            Some(StructureGuide::Strata(layer_maps::read(file)?.in_colours_of(&layer_map(library))?))
        }
        Some(StructureFrom::Lightness(file)) => {
            let bytes = file.read()?;
            InputKind::expect(&bytes, file, &[InputKind::Image, InputKind::Unknown])
                .map_err(|failure| failure.hint("a guide is a picture, such as a photograph"))?;
            Some(StructureGuide::Lightness(control::level(&bytes, &file.name())?))
        }
    })
}

/// Reads a scene.
pub(crate) fn scene(input: &Input) -> anyhow::Result<Scene> {
    let bytes = input.read()?;
    InputKind::expect(&bytes, input, &[InputKind::Scene, InputKind::Unknown])
        .map_err(|failure| failure.hint(scene_hint(&bytes, input)))?;
    Ok(Scene::from_bytes(bytes, &input.name())?)
}

/// A hint for a file that is not a scene.
fn scene_hint(bytes: &[u8], input: &Input) -> String {
    let Some(metadata) = metadata(bytes) else {
        return "make a scene with 'vtex synth photo.lib.json -o out.scene.json'".into();
    };
    let scene = input.path().with_extension("scene.json");
    let (svg, scene) = (input.name(), scene.display());
    // Only textures of photographs store a recipe.
    if metadata["recipe"].is_object() {
        return format!("make its scene again: vtex texture PHOTO --again {svg} -o {scene}");
    }
    let seed = metadata["seed"].as_u64().map_or(String::new(), |seed| format!(" --seed {seed}"));
    format!("make its scene: repeat the command that wrote it, with{seed} -o {scene}")
}

/// A scene from its bytes, or from those of a library as the reconstruction of its exemplar.
pub(crate) fn texture_of(bytes: Vec<u8>, input: &Input) -> anyhow::Result<Scene> {
    let kind = InputKind::expect(&bytes, input, &[InputKind::Library, InputKind::Scene, InputKind::Unknown])?;
    Ok(match kind {
        InputKind::Library => reconstruct(&Library::from_bytes(&bytes, &input.name())?),
        _ => Scene::from_bytes(&bytes, &input.name())?,
    })
}

/// Reads libraries.
pub(crate) fn libraries(inputs: &[Input]) -> anyhow::Result<Vec<Library>> {
    let read = |input: &Input| {
        let bytes = input.read()?;
        // An unknown file may be a damaged library; the error of reading it states the place.
        InputKind::expect(&bytes, input, &[InputKind::Library, InputKind::Unknown])?;
        Ok(Library::from_bytes(bytes, &input.name())?)
    };
    inputs.iter().map(read).collect()
}
