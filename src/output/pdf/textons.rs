//! Textons in PDF: defined once and drawn often, or written where they stand.

use super::{fill, flat, gradual, is_seen, layer, path_of};
use crate::geometry::{Affine, Rect};
use crate::raster::colour::Colour;
use crate::scene::{Instance, Scene, Texton};
use krilla::geom::Transform;
use krilla::graphic::Graphic;
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
    uses: BTreeMap<(u32, Option<Colour>), usize>,
    /// Those that are defined already.
    defined: BTreeMap<(u32, Option<Colour>), Graphic>,
}

impl<'a> Textons<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let bounds = scene.textons.iter().map(Texton::bounds).collect();
        let mut textons = Self { scene, bounds, uses: BTreeMap::new(), defined: BTreeMap::new() };
        for instance in scene.secondary.iter().chain(&scene.primary) {
            let count = textons.places(instance).count();
            *textons.uses.entry((instance.texton, instance.colour)).or_default() += count;
        }
        textons
    }

    /// The maps to the canvas of what is seen of an instance and its copies.
    fn places(&self, instance: &Instance) -> impl Iterator<Item = Affine> + use<'a> {
        let (scene, affine) = (self.scene, instance.affine());
        let bounds = affine.transform_rect_bbox(self.bounds[instance.texton as usize]);
        let shifts = scene.copies(bounds).filter(move |&shift| is_seen(scene, bounds, shift));
        shifts.map(move |shift| affine.then_translate(shift))
    }

    /// Draws a layer.
    pub(super) fn draw(&mut self, instances: &[Instance], surface: &mut Surface<'_>) {
        for instance in instances {
            let key = (instance.texton, instance.colour);
            let texton = &self.scene.textons[instance.texton as usize];
            let shared = self.uses[&key].saturating_sub(1) * elements(texton) >= WORTH;
            for affine in self.places(instance) {
                let [a, b, c, d, e, f] = affine.as_coeffs().map(|v| v as f32);
                surface.push_transform(&Transform::from_row(a, b, c, d, e, f));
                if shared {
                    let define = || layer(surface, |s| paint(texton, instance.colour, s));
                    let graphic = self.defined.entry(key).or_insert_with(define).clone();
                    surface.draw_graphic(graphic);
                } else {
                    // In its own coordinates, whose numbers are short.
                    paint(texton, instance.colour, surface);
                }
                surface.pop();
            }
        }
    }
}

/// Elements of all paths of a texton.
fn elements(texton: &Texton) -> usize {
    let outlines = std::iter::once(&texton.outline).chain(texton.details.iter().map(|p| &p.outline));
    outlines.map(|o| o.path().elements().len()).sum()
}

/// The paths of a texton, its base in `colour` if there is one.
fn paint(texton: &Texton, colour: Option<Colour>, surface: &mut Surface<'_>) {
    let (base, gradient) = texton.base(colour);
    let base = std::iter::once((&texton.outline, base, gradient));
    let details = texton.details.iter().map(|p| (&p.outline, p.colour, p.gradient.as_ref()));
    for (outline, colour, gradient) in base.chain(details) {
        if let Some(path) = path_of(outline) {
            fill(surface, &path, gradient.map_or_else(|| flat(colour), gradual));
        }
    }
}
