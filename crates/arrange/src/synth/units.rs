//! Synthesis in the units of libraries: placement works on pixels, canvases and scenes have the units of the
//! exemplars.
//!
//! The number of pixels per unit is that of the finest photograph. Without photographs it is that of the
//! finest drawing, reduced on large canvases.
//!
//! The thresholds of colours are those of ordinary contrast. A library whose contrast was stretched for its analysis is
//! stretched for placement, too, if it is the only one, and the scene gets the library's own colours.

use super::drawn::with_drawing;
use super::{Controls, SynthReport, check_canvas, cleared, in_pixels, method};
use crate::arrange::period::check_periods;
use std::borrow::Cow;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::Affine;
use vtex_base::progress::Progress;
use vtex_base::raster::colour::Colour;
use vtex_field::correspondence::PagesMemory;
use vtex_scene::library::{CategoryId, Library, SourceKind, Stretch};
use vtex_scene::scene::{Domain, Method, Scene, SynthParams};

/// Number of pixels of a canvas above which drawings have fewer pixels per unit.
const MOST_PIXELS: f64 = 25e6;

/// [`synthesize`](super::synthesize) from several libraries and with control maps. Also reports how close the
/// result is to its targets.
///
/// # Errors
/// As [`synthesize`](super::synthesize); also [`Error::Parameter`] for no library, more than
/// [`Controls::MOST_LIBRARIES`], or a number of share maps other than that of libraries.
pub fn synthesize_with(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    synthesized(libraries, params, controls, None, progress)
}

/// What a synthesis leaves for the next one from the same libraries; see [`synthesize_again`].
#[derive(Default)]
pub struct SynthesisMemory(PagesMemory);

/// [`synthesize_with`] with a memory of the last synthesis. The scene is that of [`synthesize_with`]. Correspondences
/// are sooner found if libraries and lattices are those of the last time: the similar cells of an exemplar, which take
/// most of the time of a small canvas, are then known.
///
/// # Errors
/// Those of [`synthesize_with`].
pub fn synthesize_again(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: &SynthesisMemory,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    synthesized(libraries, params, controls, Some(&memory.0), progress)
}

fn synthesized(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let kept = excluding(libraries, &params.exclude, progress);
    let libraries = kept.as_deref().unwrap_or(libraries);
    let controls = &*anew(libraries, params, controls)?;
    let (scene, report) = match stretch(libraries, controls) {
        None => made(libraries, params, controls, memory, progress)?,
        Some(stretch) => {
            let stretched = [stretch.stretched(&libraries[0])];
            let (scene, mut report) = made(&stretched, params, controls, memory, progress)?;
            for stratum in &mut report.strata {
                stratum.colour = Colour::from_f64(stretch.undone(stratum.colour.to_f64()));
            }
            (stretch.undone_in(scene), report)
        }
    };
    if let Some(warning) = no_elements(libraries, &scene) {
        progress.warn(&warning);
    }
    let scene = match &controls.context {
        Some(context) => with_drawing(scene, &context.drawing),
        None => scene,
    };
    Ok((scene, report))
}

/// The stretch for placement from a subtle photograph.
fn stretch(libraries: &[Library], controls: &Controls) -> Option<Stretch> {
    match libraries {
        [library] if controls.context.is_none() => Stretch::of_library(library),
        _ => None,
    }
}

/// The controls, with a context that is cleared first if its region is to be made anew.
fn anew<'a>(
    libraries: &[Library],
    params: &SynthParams,
    controls: &'a Controls,
) -> Result<Cow<'a, Controls>> {
    let Some(context) = controls.context.as_ref().filter(|context| context.anew) else {
        return Ok(Cow::Borrowed(controls));
    };
    controls.validate(libraries)?;
    let method = method(libraries, params, controls)?;
    let context = cleared(&libraries[0], context, [params.width, params.height], method);
    Ok(Cow::Owned(Controls { context: Some(context), ..controls.clone() }))
}

/// The libraries without the categories of some names; `None` if all stay as they are.
fn excluding(libraries: &[Library], names: &[String], progress: &dyn Progress) -> Option<Vec<Library>> {
    let known: Vec<Vec<String>> = libraries.iter().map(Library::category_names).collect();
    let is_known = |name: &String| known.iter().any(|own| CategoryId::find(own, name).is_some());
    for name in names.iter().filter(|name| !is_known(name)) {
        progress.warn(&format!("there is no category '{name}' to exclude; {}", those_known(&known.concat())));
    }
    let kept = |library: &Library| library.excluding(names).unwrap_or_else(|| library.clone());
    names.iter().any(is_known).then(|| libraries.iter().map(kept).collect())
}

/// The names of categories, in a sentence.
fn those_known(names: &[String]) -> String {
    const MOST: usize = 20;
    let shown = names.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len() {
        0 => "the library has none".into(),
        1..=MOST => format!("known are {shown}"),
        all => format!("known are {shown} and {} more", all - MOST),
    }
}

/// A warning about a texture without elements, of libraries that have some; `None` otherwise.
fn no_elements(libraries: &[Library], scene: &Scene) -> Option<String> {
    let elements = libraries.iter().flat_map(Library::primaries);
    let (all, cut) = elements.fold((0, 0), |(all, cut), e| (all + 1, cut + usize::from(e.clipped)));
    if all == 0 || scene.individuals().next().is_some() {
        return None;
    }
    let why = if cut == all {
        ": the border cuts all of them, and this method places whole ones only"
    } else {
        ", and none has been placed"
    };
    Some(format!("the texture has no elements; the library has {all}{why}"))
}

/// The scene without the drawing that it may be made beside.
fn made(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    if libraries.iter().all(Library::is_in_pixels) {
        return in_pixels(libraries, params, controls, memory, progress);
    }
    params.validate()?;
    controls.validate(libraries)?;
    let period = method(libraries, params, controls)? == Method::Period;
    if period {
        check_periods(&libraries[0], params)?;
    }
    let scale = scale(libraries, params);
    let own: Vec<Library> = libraries.iter().map(|library| library.at_scale(scale).into_owned()).collect();
    let whole = if period { whole_periods(&libraries[0], params) } else { [false; 2] };
    let canvas = canvas(&own, params, scale, whole);
    let spacing = |v: f64| (v * mean(scale)).clamp(4.0, 1000.0);
    let on_pixels = SynthParams {
        width: canvas[0],
        height: canvas[1],
        background_spacing: params.background_spacing.map(spacing),
        lattice: params.lattice.scaled(scale),
        ..params.clone()
    };
    check_canvas(&on_pixels).map_err(|error| in_units(error, params, scale))?;
    let size = [params.width, params.height];
    let places = [0, 1].map(|k| f64::from(canvas[k]) / f64::from(size[k]));
    let stretch = Affine::scale_non_uniform(places[0], places[1]);
    let steered = Controls {
        domain: controls.domain.as_ref().map(|d| d.moved(stretch)),
        context: controls.context.as_ref().map(|c| c.scaled(places, scale)),
        ..controls.clone()
    };
    let (scene, mut report) = in_pixels(&own, &on_pixels, &steered, memory, progress)
        .map_err(|error| in_units(error, params, scale))?;
    // Whole periods are stretched with the canvas; otherwise copies would not meet. So are curves that go on from others.
    let exact = whole.contains(&true) || controls.context.is_some();
    let elements = if exact { places } else { scale };
    let scene = scene.scaled(size, elements.map(|v| 1.0 / v));
    let given = |p: SynthParams| SynthParams {
        width: params.width,
        height: params.height,
        background_spacing: params.background_spacing,
        lattice: params.lattice.clone(),
        ..p
    };
    let domain = |d: Domain| Domain { outline: controls.domain.clone().unwrap_or(d.outline), edge: d.edge };
    if let Some(copies) = &mut report.repetition.copies {
        copies.shortest /= mean(scale);
        copies.median /= mean(scale);
    }
    let scene = Scene { parameters: scene.parameters.map(given), domain: scene.domain.map(domain), ..scene };
    Ok((scene, report))
}

fn mean(scale: [f64; 2]) -> f64 {
    libm::sqrt(scale[0] * scale[1])
}

/// Pixels per unit of the canvas, along x and y.
fn scale(libraries: &[Library], params: &SynthParams) -> [f64; 2] {
    let finest = |kind: SourceKind| {
        let of_kind = libraries.iter().filter(|l| l.source.kind == kind).map(|l| l.source.scale);
        of_kind.max_by(|a, b| mean(*a).total_cmp(&mean(*b)))
    };
    if let Some(scale) = finest(SourceKind::Photograph) {
        return scale;
    }
    let scale = finest(SourceKind::Drawing).unwrap_or([1.0; 2]);
    let canvas = f64::from(params.width) * f64::from(params.height);
    let most = libm::sqrt(MOST_PIXELS / canvas).max(1.0);
    // Divided by a whole number, so that most borders between pixels keep their places.
    let part = libm::ceil(mean(scale) / most).max(1.0);
    scale.map(|v| v / part)
}

/// The axes along which the canvas is a whole number of periods long, but for its rounding: those that tile, and both
/// where its page says how long it is.
fn whole_periods(library: &Library, params: &SynthParams) -> [bool; 2] {
    let period = library.page();
    let fits = |size: u32, k: usize| {
        let rest = f64::from(size) / period[k];
        libm::round(rest) >= 1.0 && (rest - libm::round(rest)).abs() * period[k] <= 0.5
    };
    let shown = params.page.is_some() && fits(params.width, 0) && fits(params.height, 1);
    [params.tile.x || shown, params.tile.y || shown]
}

/// The canvas in pixels; along the axes of `whole`, it is a whole number of periods long.
fn canvas(own: &[Library], params: &SynthParams, scale: [f64; 2], whole: [bool; 2]) -> [u32; 2] {
    let side = |size: u32, scale: f64, whole: bool, period: u32| {
        let exact = f64::from(size) * scale;
        let period = f64::from(period);
        let side = if whole { libm::round(exact / period).max(1.0) * period } else { libm::round(exact) };
        (side as u32).max(1)
    };
    let source = &own[0].source;
    [
        side(params.width, scale[0], whole[0], source.width),
        side(params.height, scale[1], whole[1], source.height),
    ]
}

/// An error that names sizes, in the units of the canvas.
fn in_units(error: Error, params: &SynthParams, scale: [f64; 2]) -> Error {
    match error {
        Error::TooLarge { what, name, .. } => {
            let most = super::LARGEST_CANVAS as f64 / scale[0] / scale[1] / 1e6;
            let found = format!("{} x {} px", params.width, params.height);
            Error::TooLarge { what, name, found, limit: format!("{most:.0} megapixels of this photograph") }
        }
        Error::Periods { nearest, .. } => {
            let side = |v: u32, k: usize| (libm::round(f64::from(v) / scale[k]) as u32).max(1);
            let nearest = nearest.map(|[w, h]| [side(w, 0), side(h, 1)]);
            Error::Periods { width: params.width, height: params.height, nearest }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::document::Document;
    use vtex_scene::library::testing::{guided, mosaic};

    #[test]
    fn excluded_categories_are_not_placed_and_others_cover_about_as_much() {
        struct Warnings(std::sync::Mutex<Vec<String>>);
        impl Progress for Warnings {
            fn warn(&self, message: &str) {
                self.0.lock().unwrap().push(message.into());
            }
        }
        let whole = guided(&mosaic(140, 14.0, 0.6, 2));
        let names = whole.category_names();
        for method in [Method::Correspondence, Method::Descriptor] {
            let params = |exclude: &[String]| {
                let exclude = exclude.to_vec();
                SynthParams { width: 200, height: 160, seed: 3, method, exclude, ..SynthParams::default() }
            };
            let made = |exclude: &[String], progress: &dyn Progress| {
                let libraries = std::slice::from_ref(&whole);
                synthesize_with(libraries, &params(exclude), &Controls::default(), progress).unwrap()
            };
            let (scene, report) = made(&names[1..2], &());
            assert_eq!(
                (scene.validate(), &scene.parameters.as_ref().unwrap().exclude[..]),
                (Ok(()), &names[1..2])
            );
            let placed = |category: usize| {
                let of = |i: &&_| scene.element(i).category.is_some_and(|c| c.index() == category);
                scene.primary().iter().filter(of).count()
            };
            assert!(placed(1) == 0 && placed(0) > 5 && placed(2) > 5, "{method:?}");
            let [first, second, third] = [0, 1, 2].map(|c| &report.categories[c]);
            assert_eq!((second.wanted, second.got), (0.0, 0.0));
            let cover = (first.got + third.got) / (first.wanted + third.wanted);
            assert!((0.65..1.3).contains(&cover), "{method:?}: {first:?} {third:?}");
            // A name that no category has changes nothing, and is told.
            let warnings = Warnings(Default::default());
            let (plain, _) = made(&[], &());
            let (other, _) = made(&["no such".into()], &warnings);
            assert_eq!(other.elements, plain.elements);
            let said = warnings.0.lock().unwrap().concat();
            assert!(said.starts_with("there is no category 'no such' to exclude; known are "), "{said}");
            assert!(names.iter().all(|name| said.contains(name.as_str())), "{said}");
            let (empty, _) = made(&names, &());
            assert!(empty.primary().is_empty());
        }
    }

    #[test]
    fn a_scene_does_not_depend_on_what_was_made_before() {
        let libraries = [1, 2].map(|seed| [guided(&mosaic(120, 14.0, 0.6, seed))]);
        let memory = SynthesisMemory::default();
        for (k, width, seed) in [(0, 90, 1), (0, 160, 1), (0, 90, 5), (1, 90, 1), (0, 90, 1)] {
            let params = SynthParams { width, height: 100, seed, ..SynthParams::default() };
            let controls = Controls::default();
            let again = synthesize_again(&libraries[k], &params, &controls, &memory, &()).unwrap();
            let fresh = synthesize_with(&libraries[k], &params, &controls, &()).unwrap();
            assert!(again.1.structure.is_some());
            assert!(again.0.to_json() == fresh.0.to_json(), "{k} {width} {seed}");
        }
    }
}
