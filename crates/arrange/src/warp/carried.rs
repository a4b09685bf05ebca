//! Links between a scene and the libraries that it was made from.

use super::Bend;
use crate::arrange::model::{PlaceableId, PlacementModel, VariantId};
use std::collections::VecDeque;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::{Affine, Outline, PathEl, Point, STEP, Vec2};
use vtex_base::raster::{ControlMap, edge_neighbours};
use vtex_scene::library::{self, Library};
use vtex_scene::reconstruct::translated;
use vtex_scene::scene::{Element, Instance, Role, Scene, pixels};

/// Longer side of the map of library shares, in its own pixels.
const PARTS_SIDE: u32 = 256;

/// The libraries in the scene's order.
pub(super) fn matched(scene: &Scene, libraries: Vec<Library>) -> Result<Vec<Library>> {
    let fail = |name: &str, reason: String| Error::OtherLibrary { name: name.into(), reason };
    let mut left: Vec<Option<Library>> = libraries.into_iter().map(Some).collect();
    let mut found = Vec::with_capacity(scene.libraries.len());
    for reference in &scene.libraries {
        let fits = |l: &&mut Option<Library>| l.as_ref().is_some_and(|l| l.source.sha256 == reference.sha256);
        let library = left.iter_mut().find(fits).and_then(Option::take);
        let missing =
            || fail(&reference.exemplar, "the scene has elements of it, and it is not given".into());
        found.push(library.ok_or_else(missing)?);
    }
    if let Some(foreign) = left.into_iter().flatten().next() {
        return Err(fail(&foreign.source.file, "the scene was made without it".into()));
    }
    // The same photograph may since have been analysed differently.
    let strange =
        |library: &Library| fail(&library.source.file, "its elements are not those of the scene".into());
    for instance in scene.instances() {
        let element = scene.element(instance);
        let library = &found[element.library.index()];
        let known = element.source.and_then(|source| library.elements.get(source.index()));
        let Some(known) = known.filter(|e| e.category == element.category) else {
            return Err(strange(library));
        };
        // Small elements of equal shape are stored once, and fused elements have shapes of their own.
        let own_shape = element.category.is_some() && !element.fused;
        if own_shape && !is_shape_of(library, known, element) {
            return Err(strange(library));
        }
    }
    Ok(found)
}

/// Whether an element of a scene has the outline of an element of its library. Outlines are compared in
/// pixels of the arrangement, in which the scene was made.
fn is_shape_of(library: &Library, known: &library::ExemplarElement, element: &Element) -> bool {
    if library.is_in_pixels() {
        return translated(known.outline(), known.origin()) == *element.outline();
    }
    let [x, y] = library.source.scale;
    let pixels = |outline: &Outline| outline.moved(Affine::scale_non_uniform(x, y));
    let [a, b] = [known.outline(), element.outline()].map(pixels);
    let [p, q] = [a.bounds().origin(), b.bounds().origin()];
    // Both were rounded to the grid of outlines in units.
    let apart = Rounding { shift: p - q, most: 2.0 * STEP * x.max(y).max(1.0) };
    let (a, b) = (a.path().elements(), b.path().elements());
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| apart.allows(*a, *b))
}

/// Equality of two outlines, one of them shifted, up to a distance.
struct Rounding {
    shift: Vec2,
    most: f64,
}

impl Rounding {
    fn allows(&self, a: PathEl, b: PathEl) -> bool {
        let near = |a: Point, b: Point| (a - b - self.shift).hypot() <= self.most;
        match (a, b) {
            (PathEl::MoveTo(a), PathEl::MoveTo(b)) | (PathEl::LineTo(a), PathEl::LineTo(b)) => near(a, b),
            (PathEl::CurveTo(a, b, c), PathEl::CurveTo(d, e, f)) => near(a, d) && near(b, e) && near(c, f),
            (PathEl::ClosePath, PathEl::ClosePath) => true,
            _ => false,
        }
    }
}

/// The variant of a primary of the scene, in the nearest variation of the model.
pub(super) fn variant(model: &PlacementModel, instance: &Instance, element: &Element) -> VariantId {
    model.in_variation(placeable(model, element), variation(model, instance))
}

/// The placeable element of the model for an element of the scene.
fn placeable(model: &PlacementModel, element: &Element) -> PlaceableId {
    let number = element.source.map_or(0, |source| source.0);
    PlaceableId(model.sources[element.library.index()].elements.start + number)
}

/// Adds the scene's fused elements to the model. Returns the variant of each element that is one.
pub(super) fn fused(model: &mut PlacementModel, scene: &Scene) -> Vec<Option<VariantId>> {
    let known = |element: &Element| {
        element.fused.then(|| {
            let whole = model.in_variation(placeable(model, element), 0);
            model.add_fused(whole, pixels::mask(element.outline()), element.clone())
        })
    };
    scene.elements.iter().map(known).collect()
}

/// The variation nearest to that of an instance; ties go to the first.
pub(super) fn variation(model: &PlacementModel, instance: &Instance) -> u16 {
    let far = |k: usize| {
        let matrix = &model.variations[k].matrix;
        (0..4).map(|i| (matrix[i] - instance.transform[i]).abs()).sum::<f64>()
    };
    let mut best = 0;
    for k in 1..model.variations.len() {
        if far(k) < far(best) {
            best = k;
        }
    }
    best as u16
}

/// The share map of each library after the warp: each pixel belongs to the library of the nearest element.
pub(super) fn parts(scene: &Scene, bend: &Bend, libraries: usize) -> Vec<ControlMap> {
    let canvas = bend.canvas();
    let longer = canvas[0].max(canvas[1]);
    let [width, height] =
        canvas.map(|side| (u64::from(side) * u64::from(PARTS_SIDE) / u64::from(longer)).max(1) as usize);
    let mut part: Vec<Option<u32>> = vec![None; width * height];
    let mut queue = VecDeque::new();
    for instance in scene.of_role(Role::Primary).chain(scene.of_role(Role::Secondary)) {
        let element = scene.element(instance);
        let Some([x, y]) = bend.texton(instance, element) else { continue };
        let (x, y) = (x / f64::from(canvas[0]), y / f64::from(canvas[1]));
        if (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) {
            let cell = (y * height as f64) as usize * width + (x * width as f64) as usize;
            if part[cell].is_none() {
                part[cell] = Some(element.library.0);
                queue.push_back(cell);
            }
        }
    }
    while let Some(cell) = queue.pop_front() {
        for next in edge_neighbours(cell, [width, height]) {
            if part[next].is_none() {
                part[next] = part[cell];
                queue.push_back(next);
            }
        }
    }
    let share = |library: usize| {
        let values = part.iter().map(|l| f32::from(u8::from(*l == Some(library as u32)))).collect();
        ControlMap::new(width as u32, height as u32, values)
    };
    (0..libraries).filter_map(share).collect()
}
