//! Library → scene: correspondences or target map, density, secondaries, background.
//!
//! Primaries are carried from the exemplar along a field of correspondences (`correspondence`), or
//! placed on a target map by their descriptors until nothing is asked for any more (`primaries`); then
//! coverage is corrected in both directions (`density`). Secondaries fill the ground between them, and
//! a field of colours through scattered points lies beneath all.
//!
//! When this works badly: exemplars with long curves, which islands cut; and exemplars with so few
//! whole textons that copies are seen.

mod background;
mod bands;
mod choice;
mod clearance;
mod compose;
mod controls;
mod correspondence;
mod density;
mod grid;
mod ground;
mod model;
mod neighbourhoods;
mod picture;
mod pixels;
mod primaries;
mod report;
mod secondaries;
pub mod statistics;
mod sums;
mod target;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
pub mod tune;
mod variation;
mod warp;

pub use compose::reconstruct;
pub(crate) use compose::{primary_texton, reference, secondary_texton};
pub use controls::Controls;
pub use correspondence::Structure;
pub use report::{CategoryReport, Report};
pub use warp::{Bend, WarpParams, warp};

use crate::error::{Error, Result};
use crate::library::Library;
use crate::progress::{Progress, advance};
use crate::scene::field::Interpolant;
use crate::scene::{Ablation, Method, Scene, SynthParams, Weights};
use correspondence::Correspondence;

/// Largest canvas, in pixels.
const LARGEST_CANVAS: u64 = 400_000_000;
/// Memory that a pixel of the canvas takes, in bytes: seven of the target map, the rest its share of
/// what is placed (measured on sandy concrete, which has the most).
const BYTES_PER_PIXEL: u64 = 25;

/// A new texture like the exemplar that the library was made from, of the size in `params`.
/// Same library, parameters and program: the same scene, on any number of threads.
///
/// # Errors
/// [`Error::Parameter`] for a parameter out of range, [`Error::TooLarge`] for a canvas of more than
/// 400 megapixels, [`Error::Interrupted`].
pub fn synthesize(library: &Library, params: &SynthParams, progress: &dyn Progress) -> Result<Scene> {
    let libraries = std::slice::from_ref(library);
    synthesize_with(libraries, params, &Controls::default(), progress).map(|(scene, _)| scene)
}

/// [`synthesize`] from several libraries and under control, with how close the result came to
/// what was wanted.
///
/// # Errors
/// As [`synthesize`]; also [`Error::Parameter`] for no library, more than
/// [`Controls::MOST_LIBRARIES`], or not as many maps of shares as libraries.
pub fn synthesize_with(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    progress: &dyn Progress,
) -> Result<(Scene, Report)> {
    params.validate()?;
    controls.validate(libraries.len())?;
    check_canvas(params)?;

    let method = method(libraries, params)?;
    let params = &SynthParams { method, ..params.clone() };
    let mut model = model::Model::new(libraries, params);
    let grid = target::TargetMap::grid(&model, params.width, params.height, params.tile);
    let ground = ground::Ground::new(&grid, controls, params);
    let correspondence = match method {
        Method::Correspondence => Correspondence::new(libraries, &model, &grid, &ground, params, progress)?,
        _ => None,
    };
    let carried = match &correspondence {
        Some(c) => Some(c.carry(libraries, &mut model, &grid, &ground, params, progress)?),
        None => None,
    };
    let mut map = target::TargetMap::new(&model, ground, grid);
    let mut choice = choice::Choice::new(&model, !params.without(Ablation::Decay));
    if let Some(carried) = &carried {
        carried.stand(&mut map, &mut choice);
    }
    let placement = primaries::place(&mut map, &mut choice, params, progress)?;
    let correction = density::correct(&mut map, &mut choice, params, progress)?;
    progress.picture("placed", &|| picture::placed(&map));

    advance(progress, "ground", 0, 2)?;
    let field = background::field(libraries, &map, correspondence.as_ref(), params);
    let interpolant = Interpolant::new(&field, params.width, params.height, params.tile);
    advance(progress, "ground", 1, 2)?;
    let secondaries = secondaries::place(libraries, &map, &interpolant, correspondence.as_ref(), params);
    advance(progress, "ground", 2, 2)?;

    let scene = compose::scene(libraries, params, controls, &map, &secondaries, field);
    let report = report::Report::new(libraries, &map, &scene, placement, correction);
    Ok((scene, report::Report { structure: carried.map(|c| c.structure), ..report }))
}

/// The method that places primaries, if it is left open.
///
/// # Errors
/// [`Error::Parameter`] if correspondences are asked for and a library has no guide.
fn method(libraries: &[Library], params: &SynthParams) -> Result<Method> {
    let guided = libraries.iter().all(|l| l.guide.is_some());
    // Parts that correspondences have too.
    let of_both = |part: &Ablation| *part == Ablation::Secondary;
    let plain = params.weights == Weights::default() && params.ablate.iter().all(of_both);
    match params.method {
        Method::Auto if guided && plain => Ok(Method::Correspondence),
        Method::Auto => Ok(Method::Descriptor),
        Method::Correspondence if !guided => Err(Error::Parameter {
            name: "method",
            value: "correspondence".into(),
            allowed: "for libraries with a guide, which those of older versions lack (analyse the photograph again)",
        }),
        method => Ok(method),
    }
}

/// The primaries of a scene alone, as placement and density leave them, and the share of the canvas
/// that each category covered before density was corrected.
fn primaries_alone(
    libraries: &[Library],
    params: &SynthParams,
    progress: &dyn Progress,
) -> Result<(Scene, Vec<f64>)> {
    let controls = Controls::default();
    let model = model::Model::new(libraries, params);
    let grid = target::TargetMap::grid(&model, params.width, params.height, params.tile);
    let ground = ground::Ground::new(&grid, &controls, params);
    let mut map = target::TargetMap::new(&model, ground, grid);
    let mut choice = choice::Choice::new(&model, !params.without(Ablation::Decay));
    primaries::place(&mut map, &mut choice, params, progress)?;
    let canvas = f64::from(params.width) * f64::from(params.height);
    let categories = 0..model.members.len();
    let covered = categories.map(|c| map.covered_by(c) as f64 / canvas).collect();
    density::correct(&mut map, &mut choice, params, progress)?;
    let field = crate::scene::Field { spacing: 1.0, fallback: Default::default(), points: Vec::new() };
    Ok((compose::scene(libraries, params, &controls, &map, &[], field), covered))
}

/// An error if the canvas is too large.
fn check_canvas(params: &SynthParams) -> Result<()> {
    let canvas = u64::from(params.width) * u64::from(params.height);
    if canvas <= LARGEST_CANVAS {
        return Ok(());
    }
    Err(Error::TooLarge {
        name: "size".into(),
        found: format!(
            "{} x {} px, about {} GB of memory",
            params.width,
            params.height,
            canvas * BYTES_PER_PIXEL / 1_000_000_000
        ),
        limit: format!("{} megapixels", LARGEST_CANVAS / 1_000_000),
    })
}
