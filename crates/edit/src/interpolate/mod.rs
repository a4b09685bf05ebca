//! Two scenes → a scene between them: textons move and change into those of the other scene (paper
//! §4.5, figures 1 and 9).
//!
//! Textons are paired by an assignment over position, size, colour and category (`correspond`): primaries
//! with primaries, including their details, and secondaries with secondaries.
//! The outlines of a pair are morphed point by point around the moving centre (`blend`). Details
//! are deformed with the outline that contains them while they change into their partners
//! (`patch`). Unmatched textons shrink or grow in place, one after another (`tween`). Shadows and
//! strokes are interpolated (`effects`), and so are background fields (`background`), domains
//! (`domain`) and positions in the painting order. A scene between two records this in its `edits`.
//!
//! Works badly for strongly branched outlines, because those that would cross themselves at half-time become
//! rounder. If two overlapping textons swap their painting order, one suddenly appears in front of the other.

mod background;
mod blend;
mod correspond;
mod effects;
mod layer;
mod motion;
mod paint;
mod patch;
mod progression;
mod region;
mod ring;
mod side;
#[cfg(test)]
mod tests;
mod tween;

pub use motion::{Brush, LayerMotion, Motion, MovingShape};
pub use vtex_scene::scene::Axis;

use background::untiled;
use effects::Effects;
use layer::{LayerPair, LayerTween};
use progression::Progression;
use region::DomainTween;
use side::Side;
use std::sync::Arc;
use tween::{TweenContent, TweenedTexton};
use vtex_base::error::{Error, Result};
use vtex_base::geometry::{Point, Vec2};
use vtex_base::parallel;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::ControlMap;
use vtex_scene::scene::{
    Between, EditRecord, Element, ElementId, Instance, InstanceId, Layer, LibraryId, LibraryRef, Place,
    Recorded, Scene, Tile,
};

/// An interpolation between two scenes: pairs their textons once, then gives the scene at any time.
/// It owns both scenes.
pub struct Interpolation {
    ends: [Arc<Scene>; 2],
    /// The scenes, with everything that repeats in only one of them listed copy by copy.
    scenes: [Arc<Scene>; 2],
    /// The scenes without elements, layers and domain.
    shells: [Scene; 2],
    /// The layers over time, in painting order.
    layers: Vec<LayerTween>,
    domain: Option<DomainTween>,
    /// The libraries of both scenes, and for each scene the indices of its own in this list.
    libraries: Vec<LibraryRef>,
    indices: [Vec<LibraryId>; 2],
}

/// How many textons of a layer have a partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Matched {
    /// Number of pairs.
    pub pairs: usize,
    /// Number of textons of either scene without a partner; they shrink or grow.
    pub unmatched: usize,
}

impl Interpolation {
    /// Pairs the textons of two scenes. The result is periodic along the axes along which both scenes
    /// are. A scene that is periodic along a further axis is represented by the copies that reach the
    /// canvas.
    ///
    /// # Errors
    /// [`Error::Sizes`] if the canvases differ in size; [`Error::Format`] for a scene that breaks its
    /// invariants; [`Error::Interrupted`].
    ///
    /// # Example
    /// ```no_run
    /// # mod vtex { pub use {vtex_base::Error, vtex_edit::interpolate, vtex_scene::scene}; }
    /// use std::path::Path;
    /// use vtex::{interpolate::Interpolation, scene::Scene};
    ///
    /// let from = Scene::read(Path::new("spring.scene.json"))?;
    /// let to = Scene::read(Path::new("autumn.scene.json"))?;
    /// let between = Interpolation::new(from, to, &())?;
    /// let frames: Vec<Scene> = (0..=24).map(|k| between.at(f64::from(k) / 24.0)).collect();
    /// # Ok::<(), vtex::Error>(())
    /// ```
    pub fn new(
        from: impl Into<Arc<Scene>>,
        to: impl Into<Arc<Scene>>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let ends @ [from, to] = &[from.into(), to.into()];
        let tile = Tile { x: from.tile.x && to.tile.x, y: from.tile.y && to.tile.y };
        Self::along(ends.clone(), tile, progress)
    }

    /// As [`Interpolation::new`], with both scenes periodic only along the axes of `tile`.
    fn along(ends: [Arc<Scene>; 2], tile: Tile, progress: &dyn Progress) -> Result<Self> {
        for scene in &ends {
            scene.check()?;
        }
        let sizes = ends.each_ref().map(|s| [s.width, s.height]);
        if sizes[0] != sizes[1] {
            return Err(Error::Sizes { from: sizes[0], to: sizes[1] });
        }
        let scenes =
            ends.each_ref().map(|s| if s.tile == tile { Arc::clone(s) } else { Arc::new(untiled(s, tile)) });
        advance(progress, STAGE, 0, 1)?;
        let mut libraries = Vec::new();
        let sides = [0, 1].map(|k| Side::new(&scenes[k], &mut libraries));
        let both = [&*scenes[0], &*scenes[1]];
        let mut layers: Vec<LayerTween> = Vec::new();
        let pairs = LayerPair::all(both);
        for (k, pair) in pairs.iter().enumerate() {
            advance(progress, STAGE, 1 + k as u64, 1 + pairs.len() as u64)?;
            let first = layers.last().map_or(0, |below| below.first + below.tweens.len());
            let role = |pair: LayerPair| [0, 1].map(|s| pair.layer(s, both[s]).map(|layer| layer.role));
            let number = pairs[..k].iter().filter(|p| role(**p) == role(*pair)).count();
            layers.push(LayerTween::new(&sides, *pair, number, first));
        }
        let indices = sides.map(|side| side.libraries);
        let domain = DomainTween::new(both);
        let shells = [0, 1].map(|k| without_content(both[k]));
        Ok(Self { ends, scenes, shells, layers, domain, libraries, indices })
    }

    /// The scene at time `t`: the first scene at 0 and below, the second at 1 and above. In between, seed,
    /// parameters and edits are those of the nearer scene, and a last edit records the interpolation.
    pub fn at(&self, t: f64) -> Scene {
        if t < 1.0 && t > 0.0 {
            self.between(&Progression::Uniform(t))
        } else {
            Scene::clone(&self.ends[usize::from(t >= 1.0)])
        }
    }

    /// Counts of pairs and unmatched elements of each layer, with the layer's name, in painting order.
    pub fn matched(&self) -> Vec<(&str, Matched)> {
        let of = |layer: &'_ LayerTween| {
            let pairs = layer.tweens.iter().filter(|tween| tween.is_pair()).count();
            Matched { pairs, unmatched: layer.tweens.len() - pairs }
        };
        self.layers.iter().map(|layer| (layer.name.as_str(), of(layer))).collect()
    }

    fn between(&self, when: &Progression) -> Scene {
        let middle =
            Point::new(f64::from(self.shells[0].width) / 2.0, f64::from(self.shells[0].height) / 2.0);
        let mut scene = self.shells[usize::from(when.at(middle) >= 0.5)].clone();
        scene.libraries.clone_from(&self.libraries);
        scene.domain = self.domain.as_ref().map(|r| r.at(when));
        scene.edits.push(self.record(when));
        let mut used = [0, 1].map(|k| vec![None; self.scenes[k].elements.len()]);
        for layer in &self.layers {
            let instances = self.drawn(layer, when, &mut scene, &mut used);
            let mut name = layer.name.clone();
            while scene.layers.iter().any(|other| other.name == name) {
                name.push('\'');
            }
            scene.layers.push(Layer {
                name,
                region: layer.region.as_ref().map(|r| r.at(when)),
                field: layer.field.as_ref().map(|f| f.at(when)),
                instances,
                ..Layer::new(layer.role)
            });
        }
        scene
    }

    /// The edit that records the interpolation in a scene.
    fn record(&self, when: &Progression) -> EditRecord {
        let [from, to] =
            self.ends.each_ref().map(|scene| scene.libraries.iter().map(|l| l.exemplar.clone()).collect());
        let place = match when {
            Progression::Uniform(t) => Place::At(*t),
            Progression::Across(axis, _) => Place::Across(*axis),
            Progression::Radial(_) => Place::Radial,
            Progression::Map(..) => Place::Map,
        };
        EditRecord { operation: Recorded::Interpolation(Between { from, to, place }), seed: 0 }
    }

    /// The instances of a layer in painting order. Adds their elements to the scene. Ids follow from the
    /// position among the tweens, so they are the same at all times.
    fn drawn(
        &self,
        layer: &LayerTween,
        when: &Progression,
        scene: &mut Scene,
        used: &mut [Vec<Option<ElementId>>; 2],
    ) -> Vec<Instance> {
        let ends = tween::Ends {
            scenes: [&self.scenes[0], &self.scenes[1]],
            libraries: [&self.indices[0], &self.indices[1]],
        };
        let mut drawn: Vec<(usize, TweenedTexton)> =
            parallel::map(&layer.tweens, |tween| tween.at(&ends, layer.pair, when))
                .into_iter()
                .enumerate()
                .filter_map(|(i, drawn)| drawn.map(|d| (i, d)))
                .collect();
        drawn.sort_by(|a, b| a.1.key.total_cmp(&b.1.key));
        let tile = scene.tile;
        let size = [f64::from(scene.width), f64::from(scene.height)];
        let home = |at: Point| {
            let within =
                |v: f64, size: f64, repeats: bool| if repeats { v - libm::floor(v / size) * size } else { v };
            Vec2::new(within(at.x, size[0], tile.x), within(at.y, size[1], tile.y))
        };
        let instance = |(i, drawn): (usize, TweenedTexton)| {
            let id = InstanceId((layer.first + i) as u32);
            match drawn.what {
                TweenContent::Existing { side, instance } => {
                    let index = instance.element.index();
                    let element = *used[side][index].get_or_insert_with(|| {
                        let element = &self.scenes[side].elements[index];
                        let library = self.indices[side][element.library.index()];
                        scene.add(Element { library, ..element.clone() })
                    });
                    // Motifs of both scenes have the same numbers.
                    Instance { id, element, motif: None, ..instance }
                }
                TweenContent::New { element, at, effects } => {
                    let at = home(at);
                    let Effects { shadow, stroke } = effects;
                    let transform = [1.0, 0.0, 0.0, 1.0, at.x, at.y];
                    Instance { transform, shadow, stroke, ..Instance::new(id, scene.add(element)) }
                }
            }
        };
        drawn.into_iter().map(instance).collect()
    }
}

/// Where on the canvas a scene becomes another.
#[derive(Clone, Debug, PartialEq)]
pub enum Morph {
    /// From the left to the right side, or from the upper to the lower.
    Axis(Axis),
    /// From the middle to the ellipse that touches the sides; corners show the second scene only.
    Radial,
    /// By a map stretched over the canvas: 0 is the first scene, 1 the second.
    Map(ControlMap),
}

/// A scene that changes over the canvas from one scene to the other. It is not periodic along an axis along
/// which it changes, and with a map along none.
///
/// # Errors
/// As [`Interpolation::new`].
pub fn morph(
    from: impl Into<Arc<Scene>>,
    to: impl Into<Arc<Scene>>,
    morph: &Morph,
    progress: &dyn Progress,
) -> Result<Scene> {
    let ends @ [from, to] = &[from.into(), to.into()];
    let canvas = [f64::from(from.width), f64::from(from.height)];
    let (keeps, when) = match morph {
        Morph::Axis(Axis::X) => ([false, true], Progression::Across(Axis::X, canvas[0])),
        Morph::Axis(Axis::Y) => ([true, false], Progression::Across(Axis::Y, canvas[1])),
        Morph::Radial => ([true; 2], Progression::Radial(canvas)),
        Morph::Map(map) => ([false; 2], Progression::Map(map.clone(), canvas)),
    };
    let tile = Tile { x: from.tile.x && to.tile.x && keeps[0], y: from.tile.y && to.tile.y && keeps[1] };
    Ok(Interpolation::along(ends.clone(), tile, progress)?.between(&when))
}

/// [`morph`] along an axis.
///
/// # Errors
/// As [`Interpolation::new`].
pub fn across(
    from: impl Into<Arc<Scene>>,
    to: impl Into<Arc<Scene>>,
    axis: Axis,
    progress: &dyn Progress,
) -> Result<Scene> {
    morph(from, to, &Morph::Axis(axis), progress)
}

/// Name of the stage of [`Interpolation::new`] in [`Progress`].
const STAGE: &str = "matching";

/// A scene without elements, layers and domain.
fn without_content(scene: &Scene) -> Scene {
    Scene { elements: Vec::new(), layers: Vec::new(), domain: None, ..scene.clone() }
}

/// Scale of an unmatched item at time `t`, 0 to 1. Within its window of time it falls smoothly to 0
/// (`side` 0) or rises from 0 (`side` 1).
fn envelope(side: usize, [first, last]: [f64; 2], t: f64) -> f64 {
    let u = ((t - first) / (last - first)).clamp(0.0, 1.0);
    let smooth = u * u * (3.0 - 2.0 * u);
    if side == 0 { 1.0 - smooth } else { smooth }
}
