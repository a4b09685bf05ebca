//! The textons of one of the two scenes as polygons.

use super::correspond::Properties;
use super::paint::ShapePaint;
use super::patch::CentredDetail;
use super::ring::{Ring, moments, transformed};
use vtex_base::geometry::{Affine, Outline, Point};
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::{Element, Gradient, Instance, LibraryId, LibraryRef, Scene};

/// Largest distance between a polygon and its curve, in pixels.
const FLAT: f64 = 0.05;

/// A scene and the shapes of its textons.
pub(super) struct Side<'a> {
    pub(super) scene: &'a Scene,
    flat: Vec<FlatTexton>,
    /// Index of each of its libraries in the combined list.
    pub(super) libraries: Vec<LibraryId>,
}

/// A texton in its own coordinates, flattened to polygons.
struct FlatTexton {
    rings: Vec<Ring>,
    details: Vec<Vec<Ring>>,
    area: f64,
    centre: Point,
    /// Mean colour in Oklab, details included.
    colour: [f32; 3],
}

/// An instance, relative to its centre.
pub(super) struct CentredInstance {
    pub(super) centre: Point,
    /// Rings on the canvas, relative to the centre: the outer ring first, clockwise.
    pub(super) rings: Vec<Ring>,
    pub(super) area: f64,
    pub(super) paint: ShapePaint,
    pub(super) details: Vec<CentredDetail>,
}

impl<'a> Side<'a> {
    /// Flattens the textons of a scene. Appends its libraries to `libraries` unless they are listed.
    pub(super) fn new(scene: &'a Scene, libraries: &mut Vec<LibraryRef>) -> Self {
        let index = |reference: &LibraryRef| {
            let found = libraries.iter().position(|l| l == reference);
            let index = found.unwrap_or_else(|| {
                libraries.push(reference.clone());
                libraries.len() - 1
            });
            LibraryId(index as u32)
        };
        let known = scene.libraries.iter().map(index).collect();
        Self { scene, flat: parallel::map(&scene.elements, FlatTexton::new), libraries: known }
    }

    /// The properties of an instance by which it is matched.
    pub(super) fn properties(&self, instance: &Instance) -> Properties {
        let flat_texton = &self.flat[instance.element.index()];
        let element = self.scene.element(instance);
        let affine = instance.affine();
        Properties {
            at: affine * flat_texton.centre,
            size: libm::sqrt((flat_texton.area * affine.determinant()).abs()),
            colour: instance.colour.map_or(flat_texton.colour, Colour::to_oklab),
            category: element.category.map(|c| (self.libraries[element.library.index()], c)),
        }
    }

    /// The centre of an instance on the canvas.
    pub(super) fn centre(&self, instance: &Instance) -> Point {
        instance.affine() * self.flat[instance.element.index()].centre
    }

    /// An instance as polygons; `None` if it has no area.
    pub(super) fn placed(&self, instance: &Instance) -> Option<CentredInstance> {
        let flat_texton = &self.flat[instance.element.index()];
        let element = self.scene.element(instance);
        let affine = instance.affine();
        let centre = affine * flat_texton.centre;
        let affine = affine.then_translate(-centre.to_vec2());
        let rings = transformed(&flat_texton.rings, affine);
        let area = rings.first().map_or(0.0, |r| moments(r).0);
        let details = flat_texton.details.iter().zip(element.details());
        let details = details.filter(|(rings, _)| !rings.is_empty()).map(|(rings, patch)| CentredDetail {
            rings: transformed(rings, affine),
            paint: paint((patch.colour, patch.gradient.as_deref()), affine),
            profile: patch.ellipse.as_ref().map(|ellipse| ellipse.profile),
        });
        (area > 1e-3).then(|| CentredInstance {
            centre,
            area,
            paint: paint(element.paint(instance.colour), affine),
            details: details.collect(),
            rings,
        })
    }
}

/// Whether two instances look the same in the same place.
pub(super) fn same(sides: &[Side<'_>; 2], instances: [&Instance; 2]) -> bool {
    let [a, b] = instances;
    let [s, t] = [0, 1].map(|k| sides[k].scene.element(instances[k]));
    let placed = (a.transform, a.colour, a.shadow, a.stroke) == (b.transform, b.colour, b.shadow, b.stroke);
    placed && s.category == t.category && s.shapes == t.shapes
}

fn paint((colour, gradient): (Colour, Option<&Gradient>), affine: Affine) -> ShapePaint {
    ShapePaint { colour, gradient: gradient.map(|g| g.moved(affine)) }
}

impl FlatTexton {
    fn new(element: &Element) -> Self {
        let flat = |outline: &Outline| transformed(&outline.polygons(FLAT), Affine::IDENTITY);
        let rings = flat(element.outline());
        let (area, centre) = rings.first().map_or((0.0, Point::ORIGIN), |r| moments(r));
        let details: Vec<Vec<Ring>> = element.details().iter().map(|d| flat(&d.outline)).collect();
        let mut sum = [0.0; 3];
        let mut rest = area.abs();
        let mut add = |colour: Colour, weight: f64| {
            (0..3).for_each(|k| sum[k] += f64::from(colour.to_oklab()[k]) * weight);
        };
        let mut all = 0.0;
        for (rings, patch) in details.iter().zip(element.details()) {
            let share = patch.ellipse.as_ref().map_or(1.0, |ellipse| ellipse.profile.mean_opacity());
            let weight = rings.first().map_or(0.0, |r| moments(r).0.abs()) * share;
            add(patch.colour, weight);
            (rest, all) = (rest - weight, all + weight);
        }
        // Overlaps of details are ignored: the remaining area is at least 0.
        let rest = rest.max(1e-6);
        add(element.base().colour, rest);
        let colour = sum.map(|v| (v / (all + rest)) as f32);
        Self { rings, details, area, centre, colour }
    }
}
