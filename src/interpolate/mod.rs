//! Two scenes → a scene between them: textons move and change into those of the other scene (paper
//! §4.5, figures 1 and 9).
//!
//! Textons are paired by an assignment over position, size, colour and category (`correspond`,
//! `assign`): primaries with primaries, including their details, and secondaries with secondaries.
//! The outlines of a pair are morphed point by point around the moving centre (`blend`). Details
//! are deformed with the outline that contains them while they change into their partners
//! (`patch`). Unmatched textons shrink or grow in place, one after another (`tween`). Shadows and
//! strokes are interpolated (`effects`), and so are background fields (`background`), domains
//! (`domain`) and positions in the painting order.
//!
//! Works badly for strongly branched outlines: those that would cross themselves at half-time become
//! rounder. Where two overlapping textons swap their painting order, one pops in front of the other.

mod background;
mod blend;
mod correspond;
mod domain;
mod effects;
mod motion;
mod paint;
mod patch;
mod progression;
mod ring;
mod side;
#[cfg(test)]
mod tests;
mod tween;

pub use crate::scene::Axis;
pub use motion::{Brush, Motion, Moving};

use crate::document::Document;
use crate::error::{Error, Result};
use crate::geometry::{Point, Vec2, shortest_offset};
use crate::parallel;
use crate::progress::{Progress, advance};
use crate::sampling::stream;
use crate::scene::{Between, EditRecord, Instance, LibraryRef, Place, Recorded, Scene, Texton, Tile};
use background::{BlendedField, untiled};
use correspond::{Correspondence, Plane, Properties, correspond};
use domain::DomainTween;
use effects::Effects;
use progression::Progression;
use side::Side;
use std::sync::Arc;
use tween::{Content, Drawn, Layer, Tween};

/// An interpolation between two scenes: pairs their textons once, then gives the scene at any time.
/// It owns both scenes.
pub struct Interpolation {
    ends: [Arc<Scene>; 2],
    /// The scenes, with everything that repeats in only one of them listed copy by copy.
    scenes: [Arc<Scene>; 2],
    /// The scenes without textons, instances, control points and domain.
    shells: [Scene; 2],
    /// The textons of each layer over time.
    secondary: Vec<Tween>,
    primary: Vec<Tween>,
    background: BlendedField,
    domain: Option<DomainTween>,
    /// The libraries of both scenes, and for each scene the indices of its own in this list.
    libraries: Vec<LibraryRef>,
    indices: [Vec<u32>; 2],
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
            let format = |reason| Error::Format { name: "scene".into(), format: Scene::FORMAT, reason };
            scene.validate().map_err(format)?;
        }
        let sizes = ends.each_ref().map(|s| [s.width, s.height]);
        if sizes[0] != sizes[1] {
            return Err(Error::Sizes { from: sizes[0], to: sizes[1] });
        }
        let scenes =
            ends.each_ref().map(|s| if s.tile == tile { Arc::clone(s) } else { Arc::new(untiled(s, tile)) });
        advance(progress, STAGE, 0, 4)?;
        let mut libraries = Vec::new();
        let sides = [0, 1].map(|k| Side::new(&scenes[k], &mut libraries));
        advance(progress, STAGE, 1, 4)?;
        let primary = items(&sides, Layer::Primary);
        advance(progress, STAGE, 2, 4)?;
        let secondary = items(&sides, Layer::Secondary);
        advance(progress, STAGE, 3, 4)?;
        let indices = sides.map(|side| side.libraries);
        let both = [&*scenes[0], &*scenes[1]];
        let (background, domain) = (BlendedField::new(both), DomainTween::new(both));
        let shells = [0, 1].map(|k| shell(both[k]));
        Ok(Self { ends, scenes, shells, secondary, primary, background, domain, libraries, indices })
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

    /// Counts of pairs and unmatched textons among the primaries, and among the secondaries.
    pub fn matched(&self) -> [Matched; 2] {
        [&self.primary, &self.secondary].map(|items| {
            let pairs = items.iter().filter(|item| item.is_pair()).count();
            Matched { pairs, unmatched: items.len() - pairs }
        })
    }

    fn between(&self, when: &Progression) -> Scene {
        let middle =
            Point::new(f64::from(self.shells[0].width) / 2.0, f64::from(self.shells[0].height) / 2.0);
        let mut scene = self.shells[usize::from(when.at(middle) >= 0.5)].clone();
        scene.libraries.clone_from(&self.libraries);
        scene.background = self.background.at(when);
        scene.domain = self.domain.as_ref().map(|r| r.at(when));
        scene.edits.push(self.record(when));
        let mut used = [0, 1].map(|k| vec![None; self.scenes[k].textons.len()]);
        for (layer, items) in [(Layer::Secondary, &self.secondary), (Layer::Primary, &self.primary)] {
            let first = if matches!(layer, Layer::Primary) { self.secondary.len() } else { 0 };
            let instances = self.drawn(layer, items, when, first, &mut scene, &mut used);
            match layer {
                Layer::Secondary => scene.secondary = instances,
                Layer::Primary => scene.primary = instances,
            }
        }
        scene
    }

    /// The edit that records the interpolation in a scene.
    fn record(&self, when: &Progression) -> EditRecord {
        let [from, to] =
            self.ends.each_ref().map(|scene| scene.libraries.iter().map(|l| l.exemplar.clone()).collect());
        let place = match *when {
            Progression::Uniform(t) => Place::At(t),
            Progression::Across(axis, _) => Place::Across(axis),
        };
        EditRecord { operation: Recorded::Interpolation(Between { from, to, place }), seed: 0 }
    }

    /// The instances of a layer in painting order. Adds their textons to the scene. Ids follow from the
    /// position in `items`, so they are the same at all times.
    fn drawn(
        &self,
        layer: Layer,
        items: &[Tween],
        when: &Progression,
        first: usize,
        scene: &mut Scene,
        used: &mut [Vec<Option<u32>>; 2],
    ) -> Vec<Instance> {
        let ends = tween::Ends {
            scenes: [&self.scenes[0], &self.scenes[1]],
            libraries: [&self.indices[0], &self.indices[1]],
        };
        let mut drawn: Vec<(usize, Drawn)> = parallel::map(items, |item| item.at(&ends, layer, when))
            .into_iter()
            .enumerate()
            .filter_map(|(i, drawn)| drawn.map(|d| (i, d)))
            .collect();
        drawn.sort_by(|a, b| a.1.key.total_cmp(&b.1.key));
        let mut add = |texton: Texton| {
            scene.textons.push(texton);
            scene.textons.len() as u32 - 1
        };
        let tile = scene.tile;
        let size = [f64::from(scene.width), f64::from(scene.height)];
        let home = |at: Point| {
            let within =
                |v: f64, size: f64, repeats: bool| if repeats { v - libm::floor(v / size) * size } else { v };
            Vec2::new(within(at.x, size[0], tile.x), within(at.y, size[1], tile.y))
        };
        let instance = |(i, drawn): (usize, Drawn)| {
            let id = (first + i) as u32;
            match drawn.what {
                Content::Existing { side, instance } => {
                    let index = instance.texton as usize;
                    let texton = *used[side][index].get_or_insert_with(|| {
                        let texton = &self.scenes[side].textons[index];
                        let library = self.indices[side][texton.library as usize];
                        add(Texton { library, ..texton.clone() })
                    });
                    Instance { id, texton, ..instance }
                }
                Content::New { texton, at, effects } => {
                    let at = home(at);
                    let Effects { shadow, stroke } = effects;
                    let transform = [1.0, 0.0, 0.0, 1.0, at.x, at.y];
                    Instance { transform, shadow, stroke, ..Instance::new(id, add(texton)) }
                }
            }
        };
        drawn.into_iter().map(instance).collect()
    }
}

/// A scene that changes across the canvas: it is the first scene at the left (or upper) side and
/// becomes the second towards the opposite side. It is not periodic along that axis.
///
/// # Errors
/// As [`Interpolation::new`].
pub fn across(
    from: impl Into<Arc<Scene>>,
    to: impl Into<Arc<Scene>>,
    axis: Axis,
    progress: &dyn Progress,
) -> Result<Scene> {
    let ends @ [from, to] = &[from.into(), to.into()];
    let tile = Tile {
        x: from.tile.x && to.tile.x && axis != Axis::X,
        y: from.tile.y && to.tile.y && axis != Axis::Y,
    };
    let length = f64::from(if axis == Axis::X { from.width } else { from.height });
    Ok(Interpolation::along(ends.clone(), tile, progress)?.between(&Progression::Across(axis, length)))
}

/// Name of the stage of [`Interpolation::new`] in [`Progress`].
const STAGE: &str = "matching";

/// The tweens of all textons of a layer.
fn items(sides: &[Side<'_>; 2], layer: Layer) -> Vec<Tween> {
    let scene = sides[0].scene;
    let (width, height) = (f64::from(scene.width), f64::from(scene.height));
    let periods = scene.tile.periods([width, height]);
    let plane = Plane { area: width * height, periods };
    let properties: [Vec<Properties>; 2] =
        [0, 1].map(|k| parallel::map(layer.of(sides[k].scene), |i| sides[k].properties(i)));
    let Correspondence { pairs, unmatched } = correspond(&properties[0], &properties[1], &plane);
    let name = match layer {
        Layer::Secondary => ["interpolate/secondary/first", "interpolate/secondary/second"],
        Layer::Primary => ["interpolate/primary/first", "interpolate/primary/second"],
    };
    let one = |side: usize, k: u32| {
        Tween::unmatched(sides, side, layer, k, &mut stream(0, name[side], u64::from(k)))
    };
    let paired = parallel::map(&pairs, |&[i, k]| {
        let offset =
            shortest_offset(properties[0][i as usize].at, properties[1][k as usize].at, plane.periods);
        let random = &mut stream(0, "interpolate/details", u64::from(i));
        match Tween::pair(sides, layer, [i, k], offset, random) {
            Some(item) => vec![item],
            None => vec![one(0, i), one(1, k)],
        }
    });
    let mut items: Vec<Tween> = paired.into_iter().flatten().collect();
    for side in 0..2 {
        items.extend(unmatched[side].iter().map(|&k| one(side, k)));
    }
    items
}

/// A scene without textons, instances, control points and domain.
fn shell(scene: &Scene) -> Scene {
    let mut shell = scene.clone();
    (shell.textons, shell.secondary, shell.primary) = (Vec::new(), Vec::new(), Vec::new());
    (shell.background.points, shell.domain) = (Vec::new(), None);
    shell
}

/// Scale of an unmatched item at time `t`, 0 to 1. Within its window of time it falls smoothly to 0
/// (`side` 0) or rises from 0 (`side` 1).
fn envelope(side: usize, [first, last]: [f64; 2], t: f64) -> f64 {
    let u = ((t - first) / (last - first)).clamp(0.0, 1.0);
    let smooth = u * u * (3.0 - 2.0 * u);
    if side == 0 { 1.0 - smooth } else { smooth }
}
