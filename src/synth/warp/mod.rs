//! Scenes bent to another shape, with their density kept (paper §4.5).
//!
//! Textons move with the bend and keep their size and shape. Their descriptors are laid again where
//! they now stand, so that the gaps between them ask to be filled, and the same placement answers;
//! where textons crowd, density is corrected as ever. Secondaries move in small neighbourhoods,
//! control points of the background one by one; both are thinned where they crowd and added to where
//! they are sparse.
//!
//! Works badly where much is squeezed into little: rows and rings that the scene has are broken.

mod bend;
mod carried;
mod ground;
#[cfg(test)]
mod tests;

pub use bend::Bend;

use super::compose::{self, Textons};
use super::controls::Controls;
use super::model::Model;
use super::target::TargetMap;
use super::{Report, check_canvas, choice, density, picture, primaries, report};
use crate::error::Result;
use crate::library::Library;
use crate::progress::{Progress, advance};
use crate::scene::field::Interpolant;
use crate::scene::{Ablation, Domain, Edge, Instance, Scene, SynthParams, Tile};

/// What fits a texton that was carried along, against those placed to fill gaps: it stays if one of
/// them can go.
const CARRIED_SCORE: f32 = 1.0;

/// Distances may grow by this factor before gaps are looked for.
const NO_STRETCH: f64 = 1.02;

/// How a scene is bent, beside where to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WarpParams {
    /// Seed of what fills the gaps. Default: that of the scene.
    pub seed: Option<u64>,
    /// What becomes of textons at the edge of the new shape. Default: as in the scene.
    pub edge: Option<Edge>,
}

/// Bends a scene, made from these libraries, in any order. What stays keeps its identity and its
/// place in the scene's list of textons. The result does not repeat.
///
/// # Errors
/// [`crate::Error::Control`] unless the libraries are those that the scene was made from;
/// [`crate::Error::TooLarge`] beyond 400 megapixels; [`crate::Error::Interrupted`].
pub fn warp(
    scene: &Scene,
    libraries: Vec<Library>,
    bend: &Bend,
    warp: WarpParams,
    progress: &dyn Progress,
) -> Result<(Scene, Report)> {
    let before = scene.parameters.clone().unwrap_or_default();
    let [width, height] = bend.canvas();
    let edge = warp.edge.or(scene.domain.as_ref().map(|d| d.edge)).unwrap_or(before.edge);
    let seed = warp.seed.unwrap_or(before.seed);
    let params = SynthParams { width, height, seed, edge, tile: Tile::default(), ..before.clone() };
    params.validate()?;
    check_canvas(&params)?;
    let libraries = carried::matched(scene, libraries)?;
    let shares = if libraries.len() > 1 { carried::lands(scene, bend, libraries.len()) } else { Vec::new() };
    let controls = Controls { domain: bend.domain(scene), density: None, shares };

    // Textons of the scene are varied as its own seed says.
    let mut model = Model::new(&libraries, &SynthParams { seed: before.seed, ..params.clone() });
    let fragments = carried::fragments(&mut model, scene);
    let grid = TargetMap::grid(&model, width, height, params.tile);
    let ground = super::ground::Ground::new(&grid, &controls, &params);
    let mut map = TargetMap::new(&model, ground, grid);
    let mut choice = choice::Choice::new(&model, !params.without(Ablation::Decay));
    // Which of the scene's primaries stand, in the order of their places on the map.
    let mut standing = Vec::new();
    for (i, instance) in scene.primary.iter().enumerate() {
        if i % 1024 == 0 {
            advance(progress, "carrying", i as u64, scene.primary.len() as u64)?;
        }
        let texton = &scene.textons[instance.texton as usize];
        let Some(there) = bend.texton(instance, texton) else { continue };
        let at = [0, 1].map(|k| libm::round(there[k]) as i32 + map.grid.margin[k]);
        if map.grid.cell(at).is_some() {
            let form = fragments[instance.texton as usize]
                .unwrap_or_else(|| carried::form(&model, instance, texton));
            map.stand(form, at, CARRIED_SCORE);
            if model.primary(form).placeable {
                choice.used(&model, form);
            }
            standing.push((i, there));
        }
    }
    // Where nothing is stretched no gaps open: what a descriptor asks for beside what has come along
    // is room that the scene left empty.
    let (gaping, closed): (Vec<u32>, Vec<u32>) = (0..standing.len() as u32).partition(|&id| {
        let [.., x, y] = scene.primary[standing[id as usize].0].transform;
        bend.stretch([x, y]) > NO_STRETCH
    });
    gaping.into_iter().for_each(|id| map.write_descriptor(id));
    let asked = map.requests.len();
    closed.into_iter().for_each(|id| map.write_descriptor(id));
    (asked..map.requests.len()).for_each(|request| map.drop_request(request as u32));
    let placement = primaries::place(&mut map, &mut choice, &params, progress)?;
    let correction = density::correct(&mut map, &mut choice, &params, progress)?;
    progress.picture("placed", &|| picture::placed(&map));

    advance(progress, "ground", 0, 2)?;
    let field = ground::field(scene, &libraries, &map, bend, &params);
    let interpolant = Interpolant::new(&field, width, height, Tile::default());
    advance(progress, "ground", 1, 2)?;
    let secondaries = ground::secondaries(scene, &libraries, &map, &interpolant, bend, &params);
    advance(progress, "ground", 2, 2)?;

    let mut result = Scene {
        width,
        height,
        tile: Tile::default(),
        program: crate::PROGRAM.into(),
        domain: controls.domain.clone().map(|outline| Domain { outline, edge }),
        secondary: Vec::new(),
        primary: Vec::new(),
        background: field,
        parameters: Some(params),
        ..scene.clone()
    };
    let mut textons: Vec<Textons<'_>> =
        libraries.iter().enumerate().map(|(k, l)| Textons::known(k as u32, l, scene)).collect();
    let ids = scene.primary.iter().chain(&scene.secondary).map(|i| i.id);
    let mut next = ids.max().map_or(0, |id| id.wrapping_add(1));
    for secondary in secondaries {
        let instance = match secondary {
            ground::Secondary::Carried { index, place } => moved(&scene.secondary[index], place),
            ground::Secondary::New(p) => {
                let texton = textons[p.library].secondary(&mut result, p.secondary);
                let variation = &model.variations[usize::from(p.variation)];
                compose::instance(fresh(&mut next), texton, p.at, variation, Some(p.colour))
            }
        };
        result.secondary.push(instance);
    }
    for id in map.painting_order().into_iter().filter(|&id| compose::is_seen(&map, id)) {
        let instance = match standing.get(id as usize) {
            Some(&(index, there)) => moved(&scene.primary[index], there),
            None => {
                let p = map.placed[id as usize];
                let primary = model.primary(p.form);
                let texton = textons[primary.library].primary(&mut result, primary.index);
                let at = [0, 1].map(|k| p.at[k] - map.grid.margin[k]);
                compose::instance(fresh(&mut next), texton, at, model.variation(p.form), None)
            }
        };
        result.primary.push(instance);
    }
    drop_unused(&mut result);
    let report = report::Report::new(&libraries, &map, &result, placement, correction);
    Ok((result, report))
}

/// A new identity.
fn fresh(next: &mut u32) -> u32 {
    let id = *next;
    *next = next.wrapping_add(1);
    id
}

/// An instance at another place, in whole pixels.
fn moved(instance: &Instance, place: [f64; 2]) -> Instance {
    let [a, b, c, d, ..] = instance.transform;
    Instance { transform: [a, b, c, d, libm::round(place[0]), libm::round(place[1])], ..instance.clone() }
}

/// Takes textons out of the list that nothing uses any more.
fn drop_unused(scene: &mut Scene) {
    let mut used = vec![false; scene.textons.len()];
    scene.primary.iter().chain(&scene.secondary).for_each(|i| used[i.texton as usize] = true);
    let mut count = 0;
    let numbers: Vec<u32> = used
        .iter()
        .map(|&used| {
            count += u32::from(used);
            count.saturating_sub(1)
        })
        .collect();
    for instance in scene.primary.iter_mut().chain(&mut scene.secondary) {
        instance.texton = numbers[instance.texton as usize];
    }
    let mut used = used.into_iter();
    scene.textons.retain(|_| used.next().unwrap_or(false));
}
