//! Two scenes → a scene between them: textons move and change into those of the other scene (paper
//! §4.5, figures 1 and 9).
//!
//! Textons are paired by an assignment over place, size, colour and category (`correspond`, `assign`),
//! primaries with primaries, each with its details, secondaries with secondaries. Outlines of a pair
//! turn into one another point by point around the moving centre (`blend`); details are carried along
//! by the outline that holds them while they turn into those of the other (`patch`). Textons without
//! partner shrink to nothing or grow from nothing where they stand, one after another (`item`). Shadows
//! and lines around textons change with them (`effects`). The fields of the background are blended
//! (`ground`), shapes that are filled become one another (`domain`). Where a thing stands in the
//! painting order moves from its place in one scene to that in the other.
//!
//! Works badly for outlines that are much branched: those that would cross themselves half-way become
//! rounder there. Where two textons that overlap change places in the painting order, one pops in
//! front of the other.

mod blend;
mod correspond;
mod domain;
mod effects;
mod ground;
mod item;
mod motion;
mod paint;
mod patch;
mod ring;
mod side;
#[cfg(test)]
mod tests;
mod when;

pub use crate::scene::Axis;
pub use motion::{Brush, Motion, Moving};

use crate::document::Document;
use crate::error::{Error, Result};
use crate::geometry::{Point, Vec2, shortest_way};
use crate::parallel;
use crate::progress::{Progress, advance};
use crate::sampling::stream;
use crate::scene::{Between, EditRecord, Instance, LibraryRef, Place, Recorded, Scene, Texton, Tile};
use correspond::{Correspondence, Plane, Traits, correspond};
use domain::Region;
use effects::Effects;
use ground::{Ground, untiled};
use item::{Drawn, Item, Layer, What};
use side::Side;
use std::borrow::Cow;
use when::When;

/// Two scenes, and what of one becomes what of the other.
pub struct Interpolation<'a> {
    ends: [&'a Scene; 2],
    /// The scenes with what repeats in only one of them listed copy by copy.
    scenes: [Cow<'a, Scene>; 2],
    /// The scenes without what they hold.
    shells: [Scene; 2],
    /// Textons by layer.
    secondary: Vec<Item>,
    primary: Vec<Item>,
    ground: Ground,
    region: Option<Region>,
    /// Libraries of both, and where in that list those of each are.
    libraries: Vec<LibraryRef>,
    indices: [Vec<u32>; 2],
}

/// How many textons of a layer have found a partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Matched {
    /// Pairs that become one another.
    pub pairs: usize,
    /// Textons of either scene that shrink to nothing or grow from nothing.
    pub alone: usize,
}

impl<'a> Interpolation<'a> {
    /// Finds out which texton becomes which. Scenes that repeat along an axis both do so on the way;
    /// what repeats in one only is there copy by copy.
    ///
    /// # Errors
    /// [`Error::Sizes`] unless both canvases are of one size; a scene that breaks its invariants;
    /// [`Error::Interrupted`].
    pub fn new(from: &'a Scene, to: &'a Scene, progress: &dyn Progress) -> Result<Self> {
        let tile = Tile { x: from.tile.x && to.tile.x, y: from.tile.y && to.tile.y };
        Self::along(from, to, tile, progress)
    }

    /// With both scenes repeating along the axes of `tile` only.
    fn along(from: &'a Scene, to: &'a Scene, tile: Tile, progress: &dyn Progress) -> Result<Self> {
        let ends = [from, to];
        for scene in ends {
            let format = |reason| Error::Format { name: "scene".into(), format: Scene::FORMAT, reason };
            scene.validate().map_err(format)?;
        }
        let sizes = ends.map(|s| [s.width, s.height]);
        if sizes[0] != sizes[1] {
            return Err(Error::Sizes { from: sizes[0], to: sizes[1] });
        }
        let scenes =
            ends.map(|s| if s.tile == tile { Cow::Borrowed(s) } else { Cow::Owned(untiled(s, tile)) });
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
        let (ground, region) = (Ground::new(both), Region::new(both));
        let shells = [0, 1].map(|k| shell(both[k]));
        Ok(Self { ends, scenes, shells, secondary, primary, ground, region, libraries, indices })
    }

    /// The scene a share `t` of the way, 0 to 1: the first scene at 0, the second at 1. Between them
    /// seed, parameters and edits are those of the nearer, and a last edit says what it is.
    pub fn at(&self, t: f64) -> Scene {
        if t < 1.0 && t > 0.0 {
            self.between(&When::Now(t))
        } else {
            self.ends[usize::from(t >= 1.0)].clone()
        }
    }

    /// Pairs among the primaries, and among the secondaries.
    pub fn matched(&self) -> [Matched; 2] {
        [&self.primary, &self.secondary].map(|items| {
            let pairs = items.iter().filter(|item| item.is_pair()).count();
            Matched { pairs, alone: items.len() - pairs }
        })
    }

    fn between(&self, when: &When) -> Scene {
        let middle =
            Point::new(f64::from(self.shells[0].width) / 2.0, f64::from(self.shells[0].height) / 2.0);
        let mut scene = self.shells[usize::from(when.at(middle) >= 0.5)].clone();
        scene.libraries.clone_from(&self.libraries);
        scene.background = self.ground.at(when);
        scene.domain = self.region.as_ref().map(|r| r.at(when));
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

    /// What a scene between the two says of itself.
    fn record(&self, when: &When) -> EditRecord {
        let [from, to] = self.ends.map(|scene| scene.libraries.iter().map(|l| l.exemplar.clone()).collect());
        let place = match *when {
            When::Now(t) => Place::At(t),
            When::Across(axis, _) => Place::Across(axis),
        };
        EditRecord { operation: Recorded::Interpolation(Between { from, to, place }), seed: 0 }
    }

    /// The instances of a layer in painting order; their textons are added to the scene. Ids are
    /// those of the items, so they are the same at all times.
    fn drawn(
        &self,
        layer: Layer,
        items: &[Item],
        when: &When,
        first: usize,
        scene: &mut Scene,
        used: &mut [Vec<Option<u32>>; 2],
    ) -> Vec<Instance> {
        let ends = item::Ends {
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
                What::Old { side, instance } => {
                    let index = instance.texton as usize;
                    let texton = *used[side][index].get_or_insert_with(|| {
                        let texton = &self.scenes[side].textons[index];
                        let library = self.indices[side][texton.library as usize];
                        add(Texton { library, ..texton.clone() })
                    });
                    Instance { id, texton, ..instance }
                }
                What::New { texton, at, effects } => {
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

/// A scene that is the first at one side of the canvas, left or top, and becomes the second towards
/// the other. It does not repeat along that axis.
///
/// # Errors
/// As [`Interpolation::new`].
pub fn across(from: &Scene, to: &Scene, axis: Axis, progress: &dyn Progress) -> Result<Scene> {
    let tile = Tile {
        x: from.tile.x && to.tile.x && axis != Axis::X,
        y: from.tile.y && to.tile.y && axis != Axis::Y,
    };
    let length = f64::from(if axis == Axis::X { from.width } else { from.height });
    Ok(Interpolation::along(from, to, tile, progress)?.between(&When::Across(axis, length)))
}

/// What [`Progress`] calls the work of [`Interpolation::new`].
const STAGE: &str = "matching";

/// All textons of a layer on their way.
fn items(sides: &[Side<'_>; 2], layer: Layer) -> Vec<Item> {
    let scene = sides[0].scene;
    let (width, height) = (f64::from(scene.width), f64::from(scene.height));
    let periods = scene.tile.periods([width, height]);
    let plane = Plane { area: width * height, periods };
    let traits: [Vec<Traits>; 2] =
        [0, 1].map(|k| parallel::map(layer.of(sides[k].scene), |i| sides[k].traits(i)));
    let Correspondence { pairs, alone } = correspond(&traits[0], &traits[1], &plane);
    let name = match layer {
        Layer::Secondary => ["interpolate/secondary/first", "interpolate/secondary/second"],
        Layer::Primary => ["interpolate/primary/first", "interpolate/primary/second"],
    };
    let one =
        |side: usize, k: u32| Item::one(sides, side, layer, k, &mut stream(0, name[side], u64::from(k)));
    let paired = parallel::map(&pairs, |&[i, k]| {
        let way = shortest_way(traits[0][i as usize].at, traits[1][k as usize].at, plane.periods);
        let random = &mut stream(0, "interpolate/details", u64::from(i));
        match Item::both(sides, layer, [i, k], way, random) {
            Some(item) => vec![item],
            None => vec![one(0, i), one(1, k)],
        }
    });
    let mut items: Vec<Item> = paired.into_iter().flatten().collect();
    for side in 0..2 {
        items.extend(alone[side].iter().map(|&k| one(side, k)));
    }
    items
}

/// A scene without what it holds.
fn shell(scene: &Scene) -> Scene {
    let mut shell = scene.clone();
    (shell.textons, shell.secondary, shell.primary) = (Vec::new(), Vec::new(), Vec::new());
    (shell.background.points, shell.domain) = (Vec::new(), None);
    shell
}

/// How much of its size something has that is there at one end only and goes or comes within a
/// window of time.
fn presence(side: usize, [first, last]: [f64; 2], t: f64) -> f64 {
    let u = ((t - first) / (last - first)).clamp(0.0, 1.0);
    let smooth = u * u * (3.0 - 2.0 * u);
    if side == 0 { 1.0 - smooth } else { smooth }
}
