//! Scenes put together from placed textons; the exemplar's own arrangement as a scene.

use super::few::limit_colours;
use super::secondaries;
use crate::PROGRAM;
use crate::arrange::Arrangement;
use crate::arrange::controls::Controls;
use crate::arrange::variation::Variation;
use crate::geometry::{Affine, Outline};
use crate::library::Library;
use crate::raster::colour::Colour;
use crate::scene::{Domain, Field, Instance, LibraryRef, Patch, Scene, SynthParams, Texton, Tile};
use std::collections::BTreeMap;

/// The scene of an arrangement. Textons are listed in the order in which they first appear.
pub(crate) fn scene(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    arrangement: &Arrangement<'_>,
    secondaries: &[secondaries::Placed],
    background: Field,
) -> Scene {
    let references = libraries.iter().map(reference).collect();
    let mut scene = empty(references, params.width, params.height, background);
    scene.parameters = Some(params.clone());
    scene.tile = params.tile;
    scene.domain = controls.domain.clone().map(|outline| Domain { outline, edge: params.edge });
    let mut textons: Vec<Textons<'_>> =
        libraries.iter().enumerate().map(|(k, l)| Textons::new(k as u32, l)).collect();
    let model = arrangement.cells.model();
    for p in secondaries {
        let texton = textons[p.library].secondary(&mut scene, p.secondary);
        let variation = &model.variations[usize::from(p.variation)];
        push(&mut scene, Layer::Secondary, texton, p.at, variation, Some(p.colour));
    }
    for p in &arrangement.placed {
        let element = &model[p.element];
        let (texton, variation) = match element.fragment {
            // A fragment is varied already.
            Some(fragment) => {
                scene.textons.push(model.fragments[fragment as usize].clone());
                (scene.textons.len() as u32 - 1, &Variation::default())
            }
            None => {
                let texton = textons[element.library].primary(&mut scene, element.index);
                (texton, &model.variations[usize::from(p.variation)])
            }
        };
        push(&mut scene, Layer::Primary, texton, p.at, variation, None);
    }
    scene
}

/// The exemplar's own arrangement: what the library knows of the photograph, drawn back. Primaries
/// in their order with their details, secondaries where they are in their own colour, and the
/// palette's sites as the background. Where the library was made for so many colours at most, it has no
/// more, the ground included, which is then of one.
pub fn reconstruct(library: &Library) -> Scene {
    let b = &library.background;
    let background = Field { spacing: b.spacing, fallback: b.fallback, points: b.sites.clone() };
    let (width, height) = (library.source.width, library.source.height);
    let mut scene = empty(vec![reference(library)], width, height, background);
    let mut textons = Textons::new(0, library);
    let none = Variation::default();
    for (i, s) in library.secondaries.textons.iter().enumerate() {
        let texton = textons.secondary(&mut scene, i as u32);
        push(&mut scene, Layer::Secondary, texton, s.origin(), &none, Some(s.colour));
    }
    for (i, p) in library.primaries.iter().enumerate() {
        let texton = textons.primary(&mut scene, i as u32);
        push(&mut scene, Layer::Primary, texton, p.origin(), &none, None);
    }
    let most = library.source.parameters.colors as usize;
    if most > 0 {
        limit_colours(&mut scene, most);
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
pub(crate) fn instance(
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
pub(crate) struct Textons<'a> {
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
    pub(crate) fn known(number: u32, library: &'a Library, scene: &Scene) -> Self {
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
    pub(crate) fn primary(&mut self, scene: &mut Scene, index: u32) -> u32 {
        *self.primaries[index as usize].get_or_insert_with(|| {
            scene.textons.push(primary_texton(self.number, self.library, index));
            scene.textons.len() as u32 - 1
        })
    }

    /// The number of a secondary in the scene, which then holds it or one of the same shape.
    pub(crate) fn secondary(&mut self, scene: &mut Scene, index: u32) -> u32 {
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
    let moved = |outline: &Outline| translated(outline, p.origin());
    let [x, y] = p.origin().map(f64::from);
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
        outline: translated(&s.outline, s.origin()),
        colour: s.colour,
        gradient: None,
        details: Vec::new(),
    }
}

/// An outline moved so that `origin` comes to (0, 0).
pub(crate) fn translated(outline: &Outline, origin: [i32; 2]) -> Outline {
    let shift = Affine::translate((-f64::from(origin[0]), -f64::from(origin[1])));
    // Fails only beyond any exemplar's size; then the texton stays where it was.
    Outline::new(&(shift * outline.path())).unwrap_or_else(|| outline.clone())
}
