//! Warps scenes to another shape and keeps their density (paper §4.5).
//!
//! Elements move with the warp and keep their size and shape. Their descriptors are applied again at the
//! new places, so that the gaps between them request elements and the usual placement fills them. Where
//! elements crowd, the density is corrected as in synthesis. Secondaries move in small neighbourhoods,
//! control points of the background one by one. Both are thinned where they crowd and added where they are
//! sparse.
//!
//! Works badly where the scene is compressed much: its rows and rings are broken.

mod background;
mod bend;
mod carried;
#[cfg(test)]
mod tests;

pub use bend::Bend;

use crate::arrange::controls::Controls;
use crate::arrange::descriptor::InitialRequests;
use crate::arrange::model::PlacementModel;
use crate::arrange::{Fixed, Plan, arrange};
use crate::synth::SynthReport;
use crate::synth::canvas::check_canvas;
use crate::synth::compose::{self, Arranged, Placement, What};
use background::WarpedSecondary;
use std::borrow::Cow;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_scene::library::Library;
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Edge, Instance, InstanceId, Method, Role, Scene, SynthParams, Tile};

/// Distances may grow by this factor without a search for gaps.
const NO_STRETCH: f64 = 1.02;

/// Parameters of a warp, apart from the bend itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WarpParams {
    /// Seed for filling the gaps. Default: that of the scene.
    pub seed: Option<u64>,
    /// Treatment of elements at the edge of the new shape. Default: as in the scene.
    pub edge: Option<Edge>,
}

/// Warps a scene. `libraries` are those that it was made from, in any order. Elements that stay keep their
/// identity and their index in the scene. The result does not tile.
///
/// # Errors
/// [`vtex_base::Error::Control`] unless the libraries are those that the scene was made from;
/// [`vtex_base::Error::TooLarge`] beyond 400 megapixels; [`vtex_base::Error::Interrupted`].
pub fn warp(
    scene: &Scene,
    libraries: Vec<Library>,
    bend: &Bend,
    warp: WarpParams,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let before = scene.parameters.clone().unwrap_or_default();
    let [width, height] = bend.canvas();
    let edge = warp.edge.or(scene.domain.as_ref().map(|d| d.edge)).unwrap_or(before.edge);
    let seed = warp.seed.unwrap_or(before.seed);
    let page = scene.page_of([width, height]);
    let params = SynthParams { width, height, page, seed, edge, tile: Tile::default(), ..before.clone() };
    params.validate()?;
    check_canvas(&params)?;
    let libraries = carried::matched(scene, libraries)?;
    // A scene is bent pixel by pixel.
    let libraries: Vec<Library> = libraries.iter().map(|l| l.at_scale([1.0; 2]).into_owned()).collect();
    let shares = if libraries.len() > 1 { carried::parts(scene, bend, libraries.len()) } else { Vec::new() };
    let controls = Cow::Owned(Controls { domain: bend.domain(scene), shares, ..Controls::default() });
    let by_descriptors = SynthParams { method: Method::Descriptor, ..params.clone() };
    let plan = Plan { libraries: Cow::Owned(libraries), controls, params: by_descriptors, memory: None };

    // Variations are drawn with the scene's own seed.
    let mut model =
        PlacementModel::new(&plan.libraries, &SynthParams { seed: before.seed, ..params.clone() });
    let (fixed, standing) = carry(scene, bend, &mut model, progress)?;
    let carried: Vec<&Instance> = scene.individuals().collect();
    let arrangement = arrange(&mut model, &plan, &fixed, progress)?;

    advance(progress, "background field", 0, 2)?;
    let field = background::field(scene, &plan, &arrangement.cells, bend);
    let interpolant = Interpolant::new(&field, width, height, Tile::default());
    advance(progress, "background field", 1, 2)?;
    let secondaries = background::secondaries(scene, &plan, &arrangement.cells, &interpolant, bend);
    advance(progress, "background field", 2, 2)?;

    let layers = Scene::three_layers(field);
    let layer = |role: Role| layers.iter().position(|l| l.role == role).unwrap_or(0);
    let below = secondaries.iter().map(|secondary| match secondary {
        WarpedSecondary::Carried { instance, place } => moved(instance, *place, layer(Role::Secondary)),
        WarpedSecondary::New(p) => compose::secondary(&plan, &arrangement, p, layer(Role::Secondary)),
    });
    let above = arrangement.placed.iter().map(|p| match p.fixed.map(|k| standing[k]) {
        Some((index, there)) => moved(carried[index], there, layer(Role::Primary)),
        None => compose::primary(&arrangement, p, layer(Role::Primary)),
    });
    let placements = below.chain(above).collect();
    let blank = Scene {
        elements: scene.elements.clone(),
        libraries: scene.libraries.clone(),
        edits: scene.edits.clone(),
        parameters: Some(params),
        ..compose::blank(&plan, layers)
    };
    let last = scene.instances().map(|i| i.id.0).max();
    let first = InstanceId(last.map_or(0, |id| id.wrapping_add(1)));
    let report = SynthReport::of_arrangement(&plan, &arrangement);
    Arranged { first, ..Arranged::new(blank, placements, report) }.composed(&plan, progress)
}

/// Index of an element among those of the scene, and its place in the new one.
type Standing = (usize, [f64; 2]);

/// Elements of the scene that remain in the new one.
fn carry(
    scene: &Scene,
    bend: &Bend,
    model: &mut PlacementModel,
    progress: &dyn Progress,
) -> Result<(Vec<Fixed>, Vec<Standing>)> {
    let fused = carried::fused(model, scene);
    let (mut fixed, mut standing) = (Vec::new(), Vec::new());
    let carried: Vec<&Instance> = scene.individuals().collect();
    for (i, &instance) in carried.iter().enumerate() {
        if i % 1024 == 0 {
            advance(progress, "carrying", i as u64, carried.len() as u64)?;
        }
        let element = scene.element(instance);
        let Some(there) = bend.texton(instance, element) else { continue };
        let known = fused[instance.element.index()];
        let [.., x, y] = instance.transform;
        // Without stretch no gaps open: room that a descriptor requests between moved elements was empty in
        // the scene.
        let requests = match known {
            Some(_) => InitialRequests::None,
            None if bend.stretch([x, y]) > NO_STRETCH => InitialRequests::Open,
            None => InitialRequests::Dropped,
        };
        let variant = known.unwrap_or_else(|| carried::variant(model, instance, element));
        fixed.push(Fixed { variant, at: there.map(|v| libm::round(v) as i32), requests });
        standing.push((i, there));
    }
    Ok((fixed, standing))
}

/// An instance moved to another place, in whole pixels.
fn moved(instance: &Instance, place: [f64; 2], layer: usize) -> Placement<'_> {
    let [a, b, c, d, ..] = instance.transform;
    let transform = [a, b, c, d, libm::round(place[0]), libm::round(place[1])];
    Placement { what: What::Kept(instance), transform, layer, motif: None, height: 0 }
}
