//! Textons in PDF: defined once and drawn often, or written where they stand.

use super::{flat, gradual, is_seen, layer, path_of};
use crate::geometry::{Affine, Rect};
use crate::output::shadow::{self, Shadows};
use crate::raster::colour::Colour;
use crate::scene::{Element, ElementId, Instance, Scene};
use krilla::geom::Transform;
use krilla::graphic::Graphic;
use krilla::num::NormalizedF32;
use krilla::paint::{Fill, LineJoin, Stroke};
use krilla::surface::Surface;
use std::collections::BTreeMap;

/// From how many path elements on, in all copies but one, a texton is worth an object of its own:
/// the object takes some 500 bytes, an element some 12 when packed.
const WORTH: usize = 40;

/// The textons of a scene and how each is written.
pub(super) struct Textons<'a> {
    scene: &'a Scene,
    bounds: Vec<Rect>,
    /// How often each is drawn in which colour.
    uses: BTreeMap<(ElementId, Option<Colour>), usize>,
    /// Those that are defined already.
    defined: BTreeMap<(ElementId, Option<Colour>), Graphic>,
    shadows: Shadows,
    /// The shadows that are defined already.
    defined_shadows: BTreeMap<shadow::Key, Graphic>,
}

impl<'a> Textons<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let bounds = scene.elements.iter().map(Element::bounds).collect();
        let (shadows, defined_shadows) = (Shadows::new(scene), BTreeMap::new());
        let mut textons =
            Self { scene, bounds, uses: BTreeMap::new(), defined: BTreeMap::new(), shadows, defined_shadows };
        for instance in scene.instances() {
            let count = textons.places(instance).count();
            *textons.uses.entry((instance.element, instance.colour)).or_default() += count;
        }
        textons
    }

    /// The maps to the canvas of what is seen of an instance and its copies.
    fn places(&self, instance: &Instance) -> impl Iterator<Item = Affine> + use<'a> {
        let (scene, affine) = (self.scene, instance.affine());
        let bounds = instance.reach(self.bounds[instance.element.index()]);
        let shifts = scene.copies(bounds).filter(move |&shift| is_seen(scene, bounds, shift));
        shifts.map(move |shift| affine.then_translate(shift))
    }

    /// Draws a layer.
    pub(super) fn draw(&mut self, instances: &[Instance], surface: &mut Surface<'_>) {
        for instance in instances {
            let key = (instance.element, instance.colour);
            let element = self.scene.element(instance);
            // Gradients are drawn in forms of their own.
            let shared = self.uses[&key].saturating_sub(1) * path_elements(element) >= WORTH
                || has_gradient(element, instance.colour);
            for affine in self.places(instance) {
                if let Some(shadow) = &instance.shadow {
                    let key = shadow::key(instance, shadow);
                    let layers = self.shadows.of(instance, shadow);
                    let define = || layer(surface, |s| darken(layers, s));
                    let graphic = self.defined_shadows.entry(key).or_insert_with(define).clone();
                    surface.push_transform(&transform(affine.then_translate(shadow.shift())));
                    surface.draw_graphic(graphic);
                    surface.pop();
                }
                surface.push_transform(&transform(affine));
                if shared {
                    let define = || layer(surface, |s| paint(element, instance.colour, s));
                    let graphic = self.defined.entry(key).or_insert_with(define).clone();
                    surface.draw_graphic(graphic);
                } else {
                    // In its own coordinates, whose numbers are short.
                    paint(element, instance.colour, surface);
                }
                if let (Some(stroke), Some(path)) = (instance.stroke, path_of(element.outline())) {
                    let (paint, width) = (flat(stroke.colour), stroke.width as f32);
                    let line = Stroke { paint, width, line_join: LineJoin::Round, ..Stroke::default() };
                    surface.set_fill(None);
                    surface.set_stroke(Some(line));
                    surface.draw_path(&path);
                    surface.set_stroke(None);
                }
                surface.pop();
            }
        }
    }
}

fn transform(affine: Affine) -> Transform {
    let [a, b, c, d, e, f] = affine.as_coeffs().map(|v| v as f32);
    Transform::from_row(a, b, c, d, e, f)
}

/// The layers of a shadow.
fn darken(layers: &[shadow::Layer], surface: &mut Surface<'_>) {
    for layer in layers {
        let opacity = NormalizedF32::new(layer.opacity as f32).unwrap_or(NormalizedF32::ONE);
        if let Some(path) = path_of(&layer.outline) {
            surface.set_fill(Some(Fill { paint: flat(Colour([0; 3])), opacity, ..Fill::default() }));
            surface.draw_path(&path);
        }
    }
}

/// Number of path elements of all shapes of an element.
fn path_elements(element: &Element) -> usize {
    element.shapes.iter().map(|s| s.outline.path().elements().len()).sum()
}

/// Whether an element, its base in `colour` if there is one, is painted with a gradient.
fn has_gradient(element: &Element, colour: Option<Colour>) -> bool {
    element.paint(colour).1.is_some() || element.details().iter().any(|s| s.gradient.is_some())
}

/// The shapes of an element, its base in `colour` if there is one.
fn paint(element: &Element, colour: Option<Colour>, surface: &mut Surface<'_>) {
    for (i, shape) in element.shapes.iter().enumerate() {
        let Some(path) = path_of(&shape.outline) else { continue };
        let own = colour.filter(|_| i == 0);
        let gradient = shape.gradient.as_deref().filter(|_| own.is_none());
        let paint = gradient.map_or_else(|| flat(own.unwrap_or(shape.colour)), gradual);
        let opacity = NormalizedF32::new(shape.opacity as f32).unwrap_or(NormalizedF32::ONE);
        surface.set_fill(Some(Fill { paint, opacity, ..Fill::default() }));
        surface.draw_path(&path);
    }
}
