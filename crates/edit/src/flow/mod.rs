//! Scene → the same scene carried by a flow, at any time of a loop (Tu, dissertation, sections 4.4.6 and
//! 7.7.3).
//!
//! All flows are loops: at the end every element is at its first place again, or has left the canvas and come
//! back. Where the flow enters the canvas, copies of elements at the opposite side are listed beyond the
//! border. Fields and regions do not move.
//!
//! Works badly for scenes that do not repeat, because copies beyond the borders reach onto the canvas, and
//! for shear with large elements, which move against each other at the borders of its bands.

mod paths;
#[cfg(test)]
mod tests;
mod track;

pub use track::Key;

use paths::{Path, Start};
use std::collections::BTreeSet;
use vtex_base::Parameter;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Point, Vec2, rotation};
use vtex_base::parallel;
use vtex_base::raster::ControlMap;
use vtex_scene::scene::{Instance, InstanceId, Role, Scene, Tile};

/// The flow that moves the elements.
#[derive(Clone, Debug, PartialEq)]
pub enum Flow {
    /// The upper third of the canvas moves to the left, the lower third to the right, the middle rests.
    Shear,
    /// Everything turns about the middle, clockwise.
    Vortex,
    /// Gusts cross the canvas from left to right; elements sway, turn a little, and swing back.
    Wind,
    /// A map of directions stretched over the canvas: 0 and 1 point to the right, a quarter down. Large
    /// elements move a short way, vanish, and reappear where they started; small ones rest.
    Field(ControlMap),
}

/// Parameters of a flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowParams {
    /// Number of rounds of shear and vortex, or of gusts of wind, in a loop.
    pub rounds: u32,
    /// Factor of the distances of wind and field.
    pub strength: f64,
    /// Seed of random choices. Default 0.
    pub seed: u64,
}

/// Ranges and defaults of the fields of the same names.
#[allow(missing_docs)]
impl FlowParams {
    pub const ROUNDS: Parameter<u32> = Parameter::new("rounds", [1, 100], "").or(1);
    pub const STRENGTH: Parameter<f64> = Parameter::new("strength", [0.01, 10.0], "").or(1.0);
}

impl Default for FlowParams {
    fn default() -> Self {
        Self { rounds: Self::ROUNDS.default(), strength: Self::STRENGTH.default(), seed: 0 }
    }
}

/// A scene in a flow.
pub struct Flowing {
    /// The scene at rest. It does not repeat, and lists the copies beyond the borders that enter.
    scene: Scene,
    /// The path of each instance, in painting order.
    paths: Vec<Path>,
}

impl Flowing {
    /// Prepares a scene.
    ///
    /// # Errors
    /// [`vtex_base::Error::Format`] for a scene that breaks its invariants; [`vtex_base::Error::Parameter`]
    /// for a parameter out of range.
    pub fn new(scene: &Scene, flow: &Flow, params: &FlowParams) -> Result<Self> {
        scene.check()?;
        FlowParams::ROUNDS.check(params.rounds)?;
        FlowParams::STRENGTH.check(params.strength)?;
        let canvas = [f64::from(scene.width), f64::from(scene.height)];
        let (mut scene, originals) = listed(scene, paths::margin(flow, canvas, params));
        scene.tile = Tile::default();
        // A copy moves as its original does.
        let individual = scene.roles().map(Role::is_individual);
        let places = scene.instances().map(|i| scene.place(i));
        let starts: Vec<Start> = originals
            .into_iter()
            .zip(places)
            .zip(individual)
            .map(|((id, at), individual)| Start { at, id: id.0.into(), individual })
            .collect();
        let paths = parallel::map(&starts, |start| Path::new(flow, start, canvas, params));
        Ok(Self { scene, paths })
    }

    /// The scene at a share of the loop; 0 and 1 give the same scene. The same elements are listed at all
    /// times, except those too small to be visible.
    pub fn at(&self, time: f64) -> Scene {
        let time = time - libm::floor(time);
        let mut scene = self.scene.clone();
        let mut paths = self.paths.iter();
        for layer in &mut scene.layers {
            layer.instances.retain_mut(|instance| {
                let Some(now) = paths.next().map(|path| path.at(time)) else { return true };
                let [.., x, y] = instance.transform;
                let linear = rotation(now.angle) * Affine::scale(now.size) * instance.affine();
                let [a, b, c, d, ..] = linear.as_coeffs();
                instance.transform = [a, b, c, d, x + now.way.x, y + now.way.y];
                now.size >= VANISHED
            });
        }
        scene.drop_unused();
        scene
    }

    /// The scene at rest. It does not repeat, and lists the copies beyond the borders that enter.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Number of clockwise rounds of all elements about the middle of the canvas in a loop; `None` for other
    /// flows.
    pub fn rounds(&self) -> Option<f64> {
        let rounds = |path: &Path| match path {
            Path::Round { rounds, .. } => Some(*rounds),
            _ => None,
        };
        let first = self.paths.first().and_then(rounds)?;
        self.paths.iter().all(|path| rounds(path) == Some(first)).then_some(first)
    }

    /// The paths of the elements of [`Flowing::scene`] through a loop, in painting order: keys with linear
    /// motion between them, within a quarter of a pixel of the true path. No keys for an element that rests.
    pub fn ways(&self) -> Vec<Vec<Key>> {
        parallel::map(&self.paths, track::keys)
    }

    /// Number of moving elements, those beyond the borders included.
    pub fn count(&self) -> usize {
        self.paths.len()
    }
}

/// Size below which an element is not drawn.
const VANISHED: f64 = 0.02;

/// The place of an element relative to its place in the scene.
struct Now {
    way: Vec2,
    /// In radians.
    angle: f64,
    size: f64,
}

/// A scene that lists copies of its elements as far as `margin` pixels beyond the borders, each right after
/// its original; and the original of each instance, itself or another.
fn listed(scene: &Scene, margin: [f64; 2]) -> (Scene, Vec<InstanceId>) {
    let canvas = [f64::from(scene.width), f64::from(scene.height)];
    let bounds: Vec<_> = scene.elements.iter().map(vtex_scene::scene::Element::bounds).collect();
    let used: BTreeSet<u32> = scene.instances().map(|i| i.id.0).collect();
    let first = used.last().map_or(0, |id| id.wrapping_add(1));
    let mut unused = (first..=u32::MAX).chain(0..first).filter(|id| !used.contains(id));
    let (mut out, mut originals) = (scene.clone(), Vec::with_capacity(scene.count()));
    for layer in &mut out.layers {
        let mut all = Vec::with_capacity(layer.instances.len());
        for instance in layer.instances.drain(..) {
            let at = scene.place(&instance);
            let reach = instance.reach(bounds[instance.element.index()]);
            let own = reach.width().max(reach.height());
            // Elements of a scene that repeats may be listed beyond the canvas.
            let [a, b, c, d, ..] = instance.transform;
            let home = Instance { transform: [a, b, c, d, at.x, at.y], ..instance };
            let near = |p: Point| {
                let along = |v: f64, k: usize| (-own - margin[k]..canvas[k] + own + margin[k]).contains(&v);
                along(p.x, 0) && along(p.y, 1)
            };
            all.push(home.clone());
            originals.push(home.id);
            for (i, j) in (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j))).filter(|s| *s != (0, 0)) {
                let p = at + Vec2::new(f64::from(i) * canvas[0], f64::from(j) * canvas[1]);
                if near(p)
                    && let Some(id) = unused.next()
                {
                    let transform = [a, b, c, d, p.x, p.y];
                    all.push(Instance { id: InstanceId(id), transform, ..home.clone() });
                    originals.push(home.id);
                }
            }
        }
        layer.instances = all;
    }
    (out, originals)
}
