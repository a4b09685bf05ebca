//! Finds or reads layers, and makes a map of them.

use super::arguments::{From, Layered, LayersResult, MapMethod, Mapping};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::{Input, InputKind};
use crate::cli::output::{Destination, WrittenFile};
use crate::cli::progress::Reporter;
use crate::cli::summary::{LayersReport, Summary};
use image::RgbImage;
use vtex::analyze::{Exemplar, Limits};
use vtex::layers::{
    Count, FoundLayers, LayerExemplar, LayerMap, LayerPicture, Terrain, continuous, find, hole as read_hole,
};
use vtex::library::Library;
use vtex::output::layer_map::write_grey;
use vtex::synth::layer_map;
use vtex::{Progress, Result};

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Mapping) -> anyhow::Result<()> {
    job.target.place.probe()?;
    let made = match &job.from {
        From::Heights(input) => terrain(reporter, job, input)?,
        From::Layers(layered) => {
            if let Some(save) = &layered.save {
                save.place.probe()?;
            }
            layers(reporter, job, layered)?
        }
    };
    let summary = Summary {
        seed: Some(job.seed),
        size: made.size.map(|v| v as u32),
        layers: made.layers,
        ..Summary::new("layers", made.inputs, job.target.place.path(), WrittenFile::of(made.bytes), reporter)
    };
    summary.print(common, job.target.place == Destination::Stdout)
}

/// The written file.
struct LayersSummary {
    inputs: Vec<String>,
    size: [usize; 2],
    layers: Option<LayersReport>,
    bytes: u64,
}

/// Reads a picture.
fn read(input: &Input) -> anyhow::Result<(String, Vec<u8>)> {
    let bytes = input.read()?;
    InputKind::expect(&bytes, input, &[InputKind::Image, InputKind::Unknown])
        .map_err(|failure| failure.hint("layers are found in photographs and layer maps"))?;
    Ok((input.name(), bytes))
}

/// New terrain.
fn terrain(reporter: &Reporter, job: &Mapping, input: &Input) -> anyhow::Result<LayersSummary> {
    reporter.stage("reading")?;
    let (name, bytes) = read(input)?;
    let known = Terrain::from_bytes(&bytes, &name, &Limits::default())?;
    let made = known.carried(job.size.unwrap_or(known.size()), job.wrap, job.seed, reporter)?;
    reporter.stage("writing")?;
    let (_, bytes) =
        job.target.place.write(|out| write_grey(made.size(), &made.to_16_bits(), Some(job.seed), out))?;
    Ok(LayersSummary { inputs: vec![name], size: made.size(), layers: None, bytes })
}

/// Layers, with their photograph if there is one.
struct LayerInput {
    photograph: Option<RgbImage>,
    map: LayerMap,
    /// Reason for the number of layers, if it was decided.
    why: Option<String>,
}

fn layers(reporter: &Reporter, job: &Mapping, layered: &Layered) -> anyhow::Result<LayersSummary> {
    reporter.stage("reading")?;
    let bytes = layered.input.read()?;
    InputKind::expect(&bytes, &layered.input, &[InputKind::Image, InputKind::Library, InputKind::Unknown])
        .map_err(|failure| failure.hint("layers are found in photographs, layer maps and libraries"))?;
    let name = layered.input.name();
    let mut inputs = vec![name.clone()];
    let is_library = InputKind::of(&bytes) == InputKind::Library;
    let known = match is_library {
        true => of_library(layered, &Library::from_bytes(&bytes, &name)?)?,
        false => known(reporter, layered, &name, &bytes, &mut inputs)?,
    };
    drop(bytes);
    if let Some(save) = &layered.save {
        save.write(&known.map, [false; 2], Some(job.seed))?;
    }
    if known.map.layers.len() < 2 {
        let hint = if is_library {
            "give --layers 2 or a painted --layer-map to 'vtex analyze'"
        } else {
            "give --layers 2 to split it all the same, or paint its layers and give --layer-map"
        };
        let why = known.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
        return Err(Failure::failed(format!("'{name}' has a single layer{why}")).hint(hint).into());
    }
    let made = make(reporter, job, layered, &known, &mut inputs)?;
    reporter.stage("writing")?;
    let bytes = if layered.continuous {
        let values = continuous(&made, job.wrap);
        let most = made.layers.len() as f32;
        let values: Vec<u16> = values.iter().map(|v| (v / most * 65535.0).round() as u16).collect();
        job.target.place.write(|out| write_grey(made.size(), &values, Some(job.seed), out))?.1
    } else {
        job.target.write(&made, job.wrap, Some(job.seed))?
    };
    let report = LayersReport {
        names: made.layers.iter().map(|l| l.name.clone()).collect(),
        colours: made.layers.iter().map(|l| l.colour).collect(),
        wanted: known.map.shares(),
        got: made.shares(),
        coverage: Vec::new(),
        why: known.why,
    };
    Ok(LayersSummary { inputs, size: made.size(), layers: Some(report), bytes })
}

/// The layers of a library, with the colours of its guide in place of the photograph.
fn of_library(layered: &Layered, library: &Library) -> anyhow::Result<LayerInput> {
    let Layered { painted, parameters, .. } = layered;
    if painted.is_some() || parameters.count != Count::Auto || parameters.order.is_some() {
        return Err(Failure::usage("a library has its layers already")
            .hint("give --layers, --layer-order and --layer-map to 'vtex analyze'")
            .into());
    }
    let library = &*library.at_scale([1.0; 2]);
    let photograph = library.guide.as_ref().map(|guide| {
        let (width, height) = (library.source.width, library.source.height);
        RgbImage::from_fn(width, height, |x, y| *guide.picture.0.get_pixel(x / guide.cell, y / guide.cell))
    });
    Ok(LayerInput { photograph, map: layer_map(library), why: library.source.strata_reason.clone() })
}

/// The layers of the input: found, painted, or those of a layer map.
fn known(
    reporter: &Reporter,
    layered: &Layered,
    name: &str,
    bytes: &[u8],
    inputs: &mut Vec<String>,
) -> anyhow::Result<LayerInput> {
    let reordered = |map: LayerMap| match &layered.parameters.order {
        Some(order) => map.reordered(order),
        None => Ok(map),
    };
    let picture = LayerPicture::from_bytes(bytes, name, &Limits::default())?;
    if layered.painted.is_none() && picture.is_flat() {
        let map = picture.layers()?;
        if let vtex::layers::Count::Fixed(count) = layered.parameters.count
            && count != map.layers.len()
        {
            let found = map.layers.len();
            return Err(Failure::failed(format!("'{name}' has {found} flat colours, not {count} layers"))
                .hint("leave out --layers: a layer map has a layer for each colour")
                .into());
        }
        return Ok(LayerInput { photograph: None, map: reordered(map)?, why: None });
    }
    drop(picture);
    let photograph = Exemplar::from_bytes(bytes, name, &Limits::default())?;
    photograph.warnings.iter().for_each(|warning| reporter.warn(warning));
    let image = photograph.image;
    if let Some(painted) = &layered.painted {
        let (name, bytes) = read(painted)?;
        let map = LayerPicture::from_bytes(&bytes, &name, &Limits::default())?.layers()?;
        inputs.push(name);
        return Ok(LayerInput { photograph: Some(image), map: reordered(map)?, why: None });
    }
    let FoundLayers { map, decision } = find(&image, None, &layered.parameters, reporter)?;
    Ok(LayerInput { photograph: Some(image), map, why: Some(decision.why) })
}

/// Makes the requested result.
fn make(
    reporter: &Reporter,
    job: &Mapping,
    layered: &Layered,
    known: &LayerInput,
    inputs: &mut Vec<String>,
) -> anyhow::Result<LayerMap> {
    let exemplar = LayerExemplar { map: &known.map, photograph: known.photograph.as_ref() };
    let mut given = |input: &Input| -> anyhow::Result<LayerPicture> {
        let (name, bytes) = read(input)?;
        let picture = LayerPicture::from_bytes(&bytes, &name, &Limits::default())?;
        check_size(job, &picture)?;
        inputs.push(name);
        Ok(picture)
    };
    Ok(match &layered.wanted {
        LayersResult::New(method) => {
            let size = job.size.unwrap_or(known.map.size());
            match method {
                MapMethod::Correspondence => exemplar.carried(size, job.wrap, job.seed, reporter)?,
                MapMethod::Boundary => exemplar.optimised(size, job.wrap, job.seed, reporter)?,
            }
        }
        LayersResult::Sketch(input) => {
            let picture = given(input)?;
            let sketch = picture.sketch_in_colours_of(&known.map)?;
            exemplar.sketched(&sketch, picture.size(), job.wrap, job.seed, reporter)?
        }
        LayersResult::Control(input) => {
            let map = given(input)?.in_colours_of(&known.map)?;
            exemplar.controlled(&map, job.wrap)?
        }
        LayersResult::Fill { keep, hole } => {
            let keep = given(keep)?;
            let map = keep.in_colours_of(&known.map)?;
            let (name, bytes) = read(hole)?;
            let (size, hole) = read_hole(&bytes, &name, &Limits::default())?;
            inputs.push(name.clone());
            if size != keep.size() {
                let (w, h) = (size[0], size[1]);
                let message = format!(
                    "'{name}' has {w} x {h} pixels, '{}' has {} x {}",
                    keep.name(),
                    keep.size()[0],
                    keep.size()[1]
                );
                return Err(Failure::failed(message).hint("make --hole of the same size as --keep").into());
            }
            exemplar.filled(&map, &hole, job.wrap, job.seed, reporter)?
        }
    })
}

/// Refuses a given map whose size differs from the requested one.
fn check_size(job: &Mapping, picture: &LayerPicture) -> Result<(), Failure> {
    let size = picture.size();
    match job.size {
        Some(wanted) if wanted != size => {
            let message = format!(
                "'{}' has {} x {} pixels, --size asks for {} x {}",
                picture.name(),
                size[0],
                size[1],
                wanted[0],
                wanted[1]
            );
            Err(Failure::failed(message).hint("leave out --size, or give a map of that size"))
        }
        _ => Ok(()),
    }
}
