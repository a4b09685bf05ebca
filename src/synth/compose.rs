//! Scenes put together from placed textons; the exemplar's own arrangement as a scene.

use super::controls::Controls;
use super::secondaries;
use super::target::TargetMap;
use super::variation::Variation;
use crate::PROGRAM;
use crate::geometry::{Affine, Outline};
use crate::library::{Library, Primary};
use crate::raster::colour::Colour;
use crate::scene::{Domain, Field, Instance, LibraryRef, Patch, Scene, SynthParams, Texton, Tile};
use std::collections::BTreeMap;

/// The scene of a filled map. Textons are listed in the order in which they first appear.
pub(super) fn scene(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    map: &TargetMap<'_>,
    placed: &[secondaries::Placed],
    background: Field,
) -> Scene {
    let references = libraries.iter().map(reference).collect();
    let mut scene = empty(references, params.width, params.height, background);
    scene.parameters = Some(params.clone());
    scene.tile = params.tile;
    scene.domain = controls.domain.clone().map(|outline| Domain { outline, edge: params.edge });
    let mut textons: Vec<Textons<'_>> =
        libraries.iter().enumerate().map(|(k, l)| Textons::new(k as u32, l)).collect();
    for p in placed {
        let texton = textons[p.library].secondary(&mut scene, p.secondary);
        let variation = &map.model().variations[usize::from(p.variation)];
        push(&mut scene, Layer::Secondary, texton, p.at, variation, Some(p.colour));
    }
    let none = Variation::default();
    for id in map.painting_order() {
        let p = map.placed[id as usize];
        if is_seen(map, id) {
            let primary = map.model().primary(p.form);
            let at = [0, 1].map(|k| p.at[k] - map.grid.margin[k]);
            let (texton, variation) = match primary.fragment {
                // A fragment is varied already.
                Some(fragment) => {
                    scene.textons.push(map.model().fragments[fragment as usize].clone());
                    (scene.textons.len() as u32 - 1, &none)
                }
                None => {
                    let texton = textons[primary.library].primary(&mut scene, primary.index);
                    (texton, map.model().variation(p.form))
                }
            };
            push(&mut scene, Layer::Primary, texton, at, variation, None);
        }
    }
    scene
}

/// Whether anything can be seen of a placed texton where the map is to be filled.
pub(super) fn is_seen(map: &TargetMap<'_>, id: u32) -> bool {
    let p = map.placed[id as usize];
    let spans = map.model().shape(p.form).mask.spans().iter();
    let canvas = spans.flat_map(|&s| map.grid.parts(s, p.at)).flat_map(|part| part.canvas);
    let mut filled = canvas.filter(|&i| map.ground.zone(i).is_some());
    filled.any(|i| map.owner[i] == id)
}

/// The exemplar's own arrangement: what the library knows of the photograph, drawn back. Primaries
/// in their order with their details, secondaries where they are in their own colour, and the
/// palette's sites as the background.
pub fn reconstruct(library: &Library) -> Scene {
    let b = &library.background;
    let background = Field { spacing: b.spacing, fallback: b.fallback, points: b.sites.clone() };
    let (width, height) = (library.source.width, library.source.height);
    let mut scene = empty(vec![reference(library)], width, height, background);
    let mut textons = Textons::new(0, library);
    let none = Variation::default();
    for (i, s) in library.secondaries.textons.iter().enumerate() {
        let texton = textons.secondary(&mut scene, i as u32);
        push(&mut scene, Layer::Secondary, texton, secondaries::origin(s), &none, Some(s.colour));
    }
    for (i, p) in library.primaries.iter().enumerate() {
        let texton = textons.primary(&mut scene, i as u32);
        push(&mut scene, Layer::Primary, texton, origin(p), &none, None);
    }
    scene
}

pub(crate) fn reference(library: &Library) -> LibraryRef {
    LibraryRef { exemplar: library.source.file.clone(), sha256: library.source.sha256.clone() }
}

fn empty(libraries: Vec<LibraryRef>, width: u32, height: u32, background: Field) -> Scene {
    Scene {
        format: Scene::FORMAT.into(),
        version: Scene::VERSION,
        width,
        height,
        tile: Tile::default(),
        parameters: None,
        program: PROGRAM.into(),
        libraries,
        textons: Vec::new(),
        secondary: Vec::new(),
        primary: Vec::new(),
        background,
        domain: None,
        edits: Vec::new(),
    }
}

enum Layer {
    Secondary,
    Primary,
}

/// Appends an instance; ids count through both layers.
fn push(
    scene: &mut Scene,
    layer: Layer,
    texton: u32,
    at: [i32; 2],
    variation: &Variation,
    colour: Option<Colour>,
) {
    let id = (scene.secondary.len() + scene.primary.len()) as u32;
    let instance = instance(id, texton, at, variation, colour);
    match layer {
        Layer::Secondary => scene.secondary.push(instance),
        Layer::Primary => scene.primary.push(instance),
    }
}

/// A texton at a place of the canvas.
pub(super) fn instance(
    id: u32,
    texton: u32,
    at: [i32; 2],
    variation: &Variation,
    colour: Option<Colour>,
) -> Instance {
    // Five decimals are a hundredth of a pixel at a distance of a thousand, and short to write.
    let [a, b, c, d] = variation.matrix.map(|v| libm::round(v * 1e5) / 1e5);
    let transform = [a, b, c, d, f64::from(at[0]), f64::from(at[1])];
    Instance { transform, colour, ..Instance::new(id, texton) }
}

/// Which of a library's textons a scene holds already, and where.
pub(super) struct Textons<'a> {
    /// Which library of the scene.
    number: u32,
    library: &'a Library,
    primaries: Vec<Option<u32>>,
    secondaries: Vec<Option<u32>>,
    /// Shapes of secondaries by their path data: the smallest are often alike to the pixel, and
    /// every instance has its own colour.
    alike: BTreeMap<String, u32>,
}

impl<'a> Textons<'a> {
    fn new(number: u32, library: &'a Library) -> Self {
        let secondaries = vec![None; library.secondaries.textons.len()];
        let primaries = vec![None; library.primaries.len()];
        Self { number, library, primaries, secondaries, alike: BTreeMap::new() }
    }

    /// Those that a scene holds already.
    pub(super) fn known(number: u32, library: &'a Library, scene: &Scene) -> Self {
        let mut textons = Self::new(number, library);
        for (i, t) in scene.textons.iter().enumerate().filter(|(_, t)| t.library == number && !t.fragment) {
            let (list, primary) = match t.category {
                Some(_) => (&mut textons.primaries, true),
                None => (&mut textons.secondaries, false),
            };
            if let Some(known) = list.get_mut(t.source as usize) {
                *known = Some(i as u32);
            }
            if !primary {
                textons.alike.insert(t.outline.to_string(), i as u32);
            }
        }
        textons
    }

    /// The number of a primary in the scene, which then holds it.
    pub(super) fn primary(&mut self, scene: &mut Scene, index: u32) -> u32 {
        *self.primaries[index as usize].get_or_insert_with(|| {
            scene.textons.push(primary_texton(self.number, self.library, index));
            scene.textons.len() as u32 - 1
        })
    }

    /// The number of a secondary in the scene, which then holds it or one of the same shape.
    pub(super) fn secondary(&mut self, scene: &mut Scene, index: u32) -> u32 {
        *self.secondaries[index as usize].get_or_insert_with(|| {
            let texton = secondary_texton(self.number, self.library, index);
            *self.alike.entry(texton.outline.to_string()).or_insert_with(|| {
                scene.textons.push(texton);
                scene.textons.len() as u32 - 1
            })
        })
    }
}

/// A primary of the library that has the given number in a scene.
pub(crate) fn primary_texton(number: u32, library: &Library, index: u32) -> Texton {
    let p = &library.primaries[index as usize];
    let moved = |outline: &Outline| translated(outline, origin(p));
    let [x, y] = origin(p).map(f64::from);
    let shift = Affine::translate((-x, -y));
    let patch = |d: &crate::library::Detail| Patch {
        outline: moved(&d.outline),
        colour: d.colour,
        gradient: d.gradient.map(|g| g.moved(shift)),
    };
    Texton {
        library: number,
        source: index,
        category: Some(p.category.0),
        fragment: false,
        outline: moved(&p.outline),
        colour: p.base,
        gradient: p.gradient.map(|g| g.moved(shift)),
        details: p.details.iter().map(patch).collect(),
    }
}

/// A secondary of the library that has the given number in a scene.
pub(crate) fn secondary_texton(number: u32, library: &Library, index: u32) -> Texton {
    let s = &library.secondaries.textons[index as usize];
    Texton {
        library: number,
        source: index,
        category: None,
        fragment: false,
        outline: translated(&s.outline, secondaries::origin(s)),
        colour: s.colour,
        gradient: None,
        details: Vec::new(),
    }
}

/// Origin of a primary: its centroid in whole pixels.
pub(super) fn origin(primary: &Primary) -> [i32; 2] {
    primary.centroid.map(|v| libm::round(v) as i32)
}

/// An outline moved so that `origin` comes to (0, 0).
pub(super) fn translated(outline: &Outline, origin: [i32; 2]) -> Outline {
    let shift = Affine::translate((-f64::from(origin[0]), -f64::from(origin[1])));
    // Fails only beyond any exemplar's size; then the texton stays where it was.
    Outline::new(&(shift * outline.path())).unwrap_or_else(|| outline.clone())
}
