//! Scenes bent to another shape, with their density kept (paper §4.5).
//!
//! Textons move with the bend and keep their size and shape. Their descriptors are laid again where
//! they now stand, so that the gaps between them ask to be filled, and the same placement answers;
//! where textons crowd, density is corrected as ever. Secondaries move in small neighbourhoods,
//! control points of the background one by one; both are thinned where they crowd and added to where
//! they are sparse.
//!
//! Works badly where much is squeezed into little: rows and rings that the scene has are broken.

mod background;
mod bend;
mod carried;
#[cfg(test)]
mod tests;

pub use bend::Bend;

use crate::arrange::controls::Controls;
use crate::arrange::descriptor::Asks;
use crate::arrange::model::Model;
use crate::arrange::{Fixed, Task, arrange};
use crate::error::Result;
use crate::library::Library;
use crate::progress::{Progress, advance};
use crate::scene::field::Interpolant;
use crate::scene::{Domain, Edge, Instance, InstanceId, LibraryId, Method, Role, Scene, SynthParams, Tile};
use crate::synth::compose::{self, Known};
use crate::synth::{Report, check_canvas};

/// Distances may grow by this factor before gaps are looked for.
const NO_STRETCH: f64 = 1.02;

/// How a scene is bent, beside where to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WarpParams {
    /// Seed of what fills the gaps. Default: that of the scene.
    pub seed: Option<u64>,
    /// Treatment of elements at the edge of the new shape. Default: as in the scene.
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
    let (libraries, scene) = carried::matched(scene, libraries)?;
    let scene = &*scene;
    let shares = if libraries.len() > 1 { carried::parts(scene, bend, libraries.len()) } else { Vec::new() };
    let controls = Controls { domain: bend.domain(scene), density: None, shares, lead: None };

    // Textons of the scene are varied as its own seed says.
    let mut model = Model::new(&libraries, &SynthParams { seed: before.seed, ..params.clone() });
    let fragments = carried::fragments(&mut model, scene);
    let (mut fixed, mut standing) = (Vec::new(), Vec::new());
    let carried: Vec<&Instance> = scene.individuals().collect();
    for (i, &instance) in carried.iter().enumerate() {
        if i % 1024 == 0 {
            advance(progress, "carrying", i as u64, carried.len() as u64)?;
        }
        let element = scene.element(instance);
        let Some(there) = bend.texton(instance, element) else { continue };
        let fragment = fragments[instance.element.index()];
        let [.., x, y] = instance.transform;
        // Where nothing is stretched no gaps open: what a descriptor asks for beside what has come
        // along is room that the scene left empty.
        let asks = match fragment {
            Some(_) => Asks::Never,
            None if bend.stretch([x, y]) > NO_STRETCH => Asks::Always,
            None => Asks::InVain,
        };
        let variant = fragment.unwrap_or_else(|| carried::variant(&model, instance, element));
        fixed.push(Fixed { variant, at: there.map(|v| libm::round(v) as i32), asks });
        standing.push((i, there));
    }
    let method = Method::Descriptor;
    let task = Task { libraries: &libraries, controls: &controls, params: &params, method, fixed };
    let arrangement = arrange(&mut model, &task, progress)?;
    let (cells, model) = (&arrangement.cells, arrangement.cells.model());

    advance(progress, "background field", 0, 2)?;
    let field = background::field(scene, &libraries, cells, bend, &params);
    let interpolant = Interpolant::new(&field, width, height, Tile::default());
    advance(progress, "background field", 1, 2)?;
    let secondaries = background::secondaries(scene, &libraries, cells, &interpolant, bend, &params);
    advance(progress, "background field", 2, 2)?;

    let mut result = Scene {
        width,
        height,
        tile: Tile::default(),
        program: crate::PROGRAM.into(),
        domain: controls.domain.clone().map(|outline| Domain { outline, edge }),
        layers: Scene::three_layers(field),
        parameters: Some(params.clone()),
        ..scene.clone()
    };
    let mut known: Vec<Known<'_>> =
        libraries.iter().enumerate().map(|(k, l)| Known::of(LibraryId(k as u32), l, scene)).collect();
    let ids = scene.instances().map(|i| i.id.0);
    let mut next = InstanceId(ids.max().map_or(0, |id| id.wrapping_add(1)));
    for secondary in secondaries {
        let instance = match secondary {
            background::Secondary::Carried { instance, place } => moved(instance, place),
            background::Secondary::New(p) => {
                let element = known[p.library].secondary(&mut result, p.secondary);
                let variation = &model.variations[usize::from(p.variation)];
                compose::instance(fresh(&mut next), element, p.at, variation, Some(p.colour))
            }
        };
        result.layer_mut(Role::Secondary).instances.push(instance);
    }
    for p in &arrangement.placed {
        let instance = match p.fixed {
            Some(k) => {
                let (index, there) = standing[k];
                moved(carried[index], there)
            }
            None => {
                let placed = &model[p.element];
                let element = known[placed.library].primary(&mut result, placed.index);
                let variation = &model.variations[usize::from(p.variation)];
                compose::instance(fresh(&mut next), element, p.at, variation, None)
            }
        };
        result.layer_mut(Role::Primary).instances.push(instance);
    }
    result.drop_unused();
    let report = Report::new(&libraries, &arrangement, &result);
    Ok((result, report))
}

/// A new identity.
fn fresh(next: &mut InstanceId) -> InstanceId {
    let id = *next;
    next.0 = id.0.wrapping_add(1);
    id
}

/// An instance at another place, in whole pixels.
fn moved(instance: &Instance, place: [f64; 2]) -> Instance {
    let [a, b, c, d, ..] = instance.transform;
    Instance { transform: [a, b, c, d, libm::round(place[0]), libm::round(place[1])], ..instance.clone() }
}
