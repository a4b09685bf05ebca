//! Layers found or read, and the map that is made of them.

use super::arguments::{From, Layered, MapFormat, MapTarget, Mapping, Method, Wanted};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::{Input, Kind};
use crate::cli::output::{Place, Written};
use crate::cli::progress::Reporter;
use crate::cli::summary::{LayersReport, Summary};
use image::RgbImage;
use vtex::analyze::{Exemplar as Photograph, Limits};
use vtex::layers::{
    Decision, Exemplar, Found, LayerMap, LayerPicture, Terrain, continuous, find, hole as read_hole,
};
use vtex::output::layer_map::{write_grey, write_json, write_png, write_svg};
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
        ..Summary::new("layers", made.inputs, job.target.place.path(), Written::of(made.bytes), reporter)
    };
    summary.tell(common, job.target.place == Place::Stdout)
}

/// The written file.
struct Made {
    inputs: Vec<String>,
    size: [usize; 2],
    layers: Option<LayersReport>,
    bytes: u64,
}

/// Reads a picture.
fn read(input: &Input) -> anyhow::Result<(String, Vec<u8>)> {
    let bytes = input.read()?;
    Kind::expect(&bytes, input, &[Kind::Image, Kind::Unknown])
        .map_err(|failure| failure.hint("layers are found in photographs and layer maps"))?;
    Ok((input.name(), bytes))
}

/// New terrain.
fn terrain(reporter: &Reporter, job: &Mapping, input: &Input) -> anyhow::Result<Made> {
    reporter.stage("reading")?;
    let (name, bytes) = read(input)?;
    let known = Terrain::from_bytes(&bytes, &name, &Limits::default())?;
    let made = known.carried(job.size.unwrap_or(known.size()), job.wrap, job.seed, reporter)?;
    reporter.stage("writing")?;
    let (_, bytes) =
        job.target.place.write(|out| write_grey(made.size(), &made.to_16_bits(), Some(job.seed), out))?;
    Ok(Made { inputs: vec![name], size: made.size(), layers: None, bytes })
}

/// A photograph, or none of a layer map; and its layers.
struct Known {
    photograph: Option<RgbImage>,
    map: LayerMap,
    decision: Option<Decision>,
}

fn layers(reporter: &Reporter, job: &Mapping, layered: &Layered) -> anyhow::Result<Made> {
    reporter.stage("reading")?;
    let (name, bytes) = read(&layered.input)?;
    let mut inputs = vec![name.clone()];
    let known = known(reporter, layered, &name, &bytes, &mut inputs)?;
    drop(bytes);
    if let Some(save) = &layered.save {
        write(save, &known.map, [false; 2], job.seed)?;
    }
    if known.map.layers.len() < 2 {
        let why = known.decision.as_ref().map_or(String::new(), |d| format!(": {}", d.why));
        return Err(Failure::failed(format!("'{name}' has a single layer{why}"))
            .hint("give --layers 2 to split it all the same, or paint its layers and give --layer-map")
            .into());
    }
    let made = make(reporter, job, layered, &known, &mut inputs)?;
    reporter.stage("writing")?;
    let bytes = if layered.continuous {
        let values = continuous(&made, job.wrap);
        let most = made.layers.len() as f32;
        let values: Vec<u16> = values.iter().map(|v| (v / most * 65535.0).round() as u16).collect();
        job.target.place.write(|out| write_grey(made.size(), &values, Some(job.seed), out))?.1
    } else {
        write(&job.target, &made, job.wrap, job.seed)?
    };
    let report = LayersReport {
        names: made.layers.iter().map(|l| l.name.clone()).collect(),
        colours: made.layers.iter().map(|l| l.colour).collect(),
        wanted: known.map.shares(),
        got: made.shares(),
        why: known.decision.map(|d| d.why),
    };
    Ok(Made { inputs, size: made.size(), layers: Some(report), bytes })
}

/// The layers of the input: found, painted, or those of a layer map.
fn known(
    reporter: &Reporter,
    layered: &Layered,
    name: &str,
    bytes: &[u8],
    inputs: &mut Vec<String>,
) -> anyhow::Result<Known> {
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
        return Ok(Known { photograph: None, map: reordered(map)?, decision: None });
    }
    drop(picture);
    let photograph = Photograph::from_bytes(bytes, name, &Limits::default())?;
    photograph.warnings.iter().for_each(|warning| reporter.warn(warning));
    let image = photograph.image;
    if let Some(painted) = &layered.painted {
        let (name, bytes) = read(painted)?;
        let map = LayerPicture::from_bytes(&bytes, &name, &Limits::default())?.layers()?;
        inputs.push(name);
        return Ok(Known { photograph: Some(image), map: reordered(map)?, decision: None });
    }
    let Found { map, decision } = find(&image, None, &layered.parameters, reporter)?;
    Ok(Known { photograph: Some(image), map, decision: Some(decision) })
}

/// Makes what is wanted.
fn make(
    reporter: &Reporter,
    job: &Mapping,
    layered: &Layered,
    known: &Known,
    inputs: &mut Vec<String>,
) -> anyhow::Result<LayerMap> {
    let exemplar = Exemplar { map: &known.map, photograph: known.photograph.as_ref() };
    let mut given = |input: &Input| -> anyhow::Result<LayerPicture> {
        let (name, bytes) = read(input)?;
        let picture = LayerPicture::from_bytes(&bytes, &name, &Limits::default())?;
        check_size(job, &picture)?;
        inputs.push(name);
        Ok(picture)
    };
    Ok(match &layered.wanted {
        Wanted::New(method) => {
            let size = job.size.unwrap_or(known.map.size());
            match method {
                Method::Correspondence => exemplar.carried(size, job.wrap, job.seed, reporter)?,
                Method::Boundary => exemplar.optimised(size, job.wrap, job.seed, reporter)?,
            }
        }
        Wanted::Sketch(input) => {
            let picture = given(input)?;
            let sketch = picture.sketch_in_colours_of(&known.map)?;
            exemplar.sketched(&sketch, picture.size(), job.wrap, job.seed, reporter)?
        }
        Wanted::Control(input) => {
            let map = given(input)?.in_colours_of(&known.map)?;
            exemplar.controlled(&map, job.wrap)?
        }
        Wanted::Fill { keep, hole } => {
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

/// Refuses a given map of another size than was asked for.
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

/// Writes a map.
fn write(target: &MapTarget, map: &LayerMap, wrap: [bool; 2], seed: u64) -> Result<u64> {
    let written = target.place.write(|out| match target.format {
        MapFormat::Png => write_png(map, Some(seed), out),
        MapFormat::Svg => write_svg(map, wrap, out),
        MapFormat::Json => write_json(map, wrap, Some(seed), out),
    })?;
    Ok(written.1)
}
