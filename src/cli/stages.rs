//! The library's stages as the commands call them.

use super::arguments::SegmenterName;
use super::input::{Input, Kind};
use super::options::{Analysis, DomainFrom, How, MasksFrom, Steering};
use super::output::Place;
use super::progress::Reporter;
use image::RgbImage;
use vtex::analyze::{Exemplar, Limits};
use vtex::control;
use vtex::library::Library;
use vtex::scene::{Scene, SynthParams};
use vtex::segment::{Felzenszwalb, MasksFile, Regions, ScoredMask, Segmenter, masks_to_bytes};
use vtex::synth::{Bend, Controls, Report};
use vtex::{Error, Progress, Result};

/// Photograph → library; saves the masks if asked.
pub(super) fn analyze(analysis: &Analysis, reporter: &Reporter) -> anyhow::Result<Library> {
    reporter.stage("reading")?;
    let bytes = analysis.photo.read()?;
    Kind::expect(&bytes, &analysis.photo, &[Kind::Image, Kind::Unknown])?;
    let name = match &analysis.photo {
        Input::Stdin => "-".into(),
        Input::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy(),
    };
    let exemplar = Exemplar::from_bytes(&bytes, &name, &Limits::default())?;
    drop(bytes);
    let segmenter: Box<dyn Segmenter> = match &analysis.masks {
        MasksFrom::File(path) => Box::new(MasksFile::read(path)?),
        MasksFrom::Segmenter(SegmenterName::Felzenszwalb) => Box::new(Felzenszwalb::default()),
        MasksFrom::Segmenter(SegmenterName::Regions) => Box::new(Regions),
    };
    let saving = Saving { segmenter, place: analysis.save_masks.as_ref() };
    Ok(vtex::analyze::analyze(&exemplar, &saving, &analysis.parameters, reporter)?)
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
