//! Warps, interpolation and transfer of scenes, and redrawing of pictures.

use crate::library::Library;
use crate::pictures::{Named, PictureInput};
use crate::run::{run, warn};
use crate::scene::Scene;
use crate::writing::from_json;
use pyo3::prelude::*;
use serde::Deserialize;
use vtex::interpolate::{Axis, Interpolation, Morph};
use vtex::scene::{Edge, TransferMode};
use vtex::transfer::{Keep, StylizeParams, TransferParams};
use vtex::warp::{Bend, WarpParams};
use vtex::{Error, control};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WarpOptions {
    stretch: Option<[f64; 2]>,
    edge: Option<Edge>,
    seed: Option<u64>,
}

/// Bends a scene: by cages, before and after, or by the factors of the options.
#[pyfunction]
pub(crate) fn warp(
    py: Python<'_>,
    scene: PyRef<'_, Scene>,
    libraries: Vec<PyRef<'_, Library>>,
    options: &str,
    cages: Option<(Named, Named)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Scene> {
    let WarpOptions { stretch, edge, seed } = from_json(py, options, "warp")?;
    let scene = scene.inner.clone();
    let libraries: Vec<_> = libraries.iter().map(|library| library.inner.clone()).collect();
    let made = run(py, progress, move |progress| {
        let bend = match &cages {
            Some(((before, drawn), (after, moved))) => {
                let (before, _) = control::cage(drawn, before)?;
                let (after, canvas) = control::cage(moved, after)?;
                Bend::cage(before, after, canvas)?
            }
            None => Bend::scale(&scene, stretch.unwrap_or([1.0; 2]))?,
        };
        let libraries = libraries.iter().map(|library| (**library).clone()).collect();
        vtex::warp::warp(&scene, libraries, &bend, WarpParams { seed, edge }, progress)
    });
    made.map(|(scene, _)| scene.into())
}

/// The scenes between two, at shares of the way.
#[pyfunction]
pub(crate) fn interpolate(
    py: Python<'_>,
    first: PyRef<'_, Scene>,
    second: PyRef<'_, Scene>,
    shares: Vec<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Scene>> {
    let (first, second) = (first.inner.clone(), second.inner.clone());
    let made = run(py, progress, move |progress| {
        let way = Interpolation::new(first, second, progress)?;
        let mut scenes = Vec::with_capacity(shares.len());
        for (k, share) in shares.iter().enumerate() {
            if !progress.advance("moving", k as u64, shares.len() as u64) {
                return Err(Error::Interrupted);
            }
            scenes.push(way.at(*share));
        }
        Ok(scenes)
    });
    Ok(made?.into_iter().map(Scene::from).collect())
}

/// A scene that turns into another over the canvas: along an axis, from the middle (`"radial"`), or by a map.
#[pyfunction]
pub(crate) fn morph(
    py: Python<'_>,
    first: PyRef<'_, Scene>,
    second: PyRef<'_, Scene>,
    place: &str,
    map: Option<Named>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Scene> {
    let (first, second) = (first.inner.clone(), second.inner.clone());
    let made = run(py, progress, move |progress| {
        let morph = match (&map, place) {
            (Some((name, bytes)), _) => Morph::Map(control::level(bytes, name)?),
            (None, "x") => Morph::Axis(Axis::X),
            (None, "y") => Morph::Axis(Axis::Y),
            (None, _) => Morph::Radial,
        };
        vtex::interpolate::morph(first, second, &morph, progress)
    });
    made.map(Scene::from)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TransferOptions {
    mode: TransferMode,
    element_scale: f64,
    seed: u64,
}

/// The arrangement of one scene with the appearance of others; `maps` give the share of each.
#[pyfunction]
pub(crate) fn transfer(
    py: Python<'_>,
    structure: PyRef<'_, Scene>,
    appearances: Vec<PyRef<'_, Scene>>,
    options: &str,
    maps: Vec<Named>,
) -> PyResult<Scene> {
    let TransferOptions { mode, element_scale, seed } = from_json(py, options, "transfer")?;
    let structure = structure.inner.clone();
    let appearances: Vec<_> = appearances.iter().map(|scene| scene.inner.clone()).collect();
    let (scene, report) = run(py, None, move |_| {
        let appearances: Vec<vtex::scene::Scene> =
            appearances.iter().map(|scene| (**scene).clone()).collect();
        let maps: Vec<(&str, &[u8])> = maps.iter().map(|(name, bytes)| (&name[..], &bytes[..])).collect();
        let shares = if maps.is_empty() { Vec::new() } else { control::shares(&maps, appearances.len())? };
        let params = TransferParams { mode, scale: element_scale, seed };
        vtex::transfer::transfer(&structure, &appearances, &shares, &params)
    })?;
    if report.removed > 0 {
        warn(py, &format!("{} elements are gone: the appearance has none of their role", report.removed))?;
    }
    Ok(scene.into())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StylizeOptions {
    keep: Keep,
    longer_side: u32,
    element_size: Option<f64>,
    levels: u32,
    seed: u64,
}

/// A picture redrawn in the elements of a scene.
#[pyfunction]
pub(crate) fn stylize(
    py: Python<'_>,
    name: String,
    picture: PictureInput,
    texture: PyRef<'_, Scene>,
    options: &str,
) -> PyResult<Scene> {
    let options: StylizeOptions = from_json(py, options, "stylize")?;
    let texture = texture.inner.clone();
    let made = run(py, None, move |_| {
        let StylizeOptions { keep, longer_side, element_size, levels, seed } = options;
        let params = StylizeParams { size: longer_side, element: element_size, levels, keep, seed };
        vtex::transfer::stylize(&picture.exemplar(&name, false)?.image, &texture, &params)
    });
    made.map(Scene::from)
}
