//! Textons in PDF: defined once and drawn often, or written in place.

use super::content::ContentStream;
use super::file::File;
use super::paint::{set_gradient, set_line_opacity, set_opacity};
use super::{is_empty, is_seen};
use crate::shadow::{self, Shadows};
use pdf_writer::Ref;
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, Outline, Rect, Vec2};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Ellipse, Profile};
use vtex_scene::scene::{Element, ElementId, Instance, Scene};

/// Least number of path elements, in all copies but one, for which a texton gets an object of its own.
const WORTH: usize = 40;

/// The textons of a scene and how each is written.
pub(super) struct PdfTextons<'a> {
    scene: &'a Scene,
    bounds: Vec<Rect>,
    /// Number of uses of each texton in each colour.
    uses: BTreeMap<(ElementId, Option<Colour>), usize>,
    /// Objects of the textons that are defined already.
    defined: BTreeMap<(ElementId, Option<Colour>), Ref>,
    shadows: Shadows,
    /// Objects of the shadows that are defined already.
    defined_shadows: BTreeMap<shadow::Key, Ref>,
    brushes: BrushForms,
}

/// The discs of soft ellipses that are defined already, by profile and colour.
#[derive(Default)]
struct BrushForms(BTreeMap<(Profile, Colour), Ref>);

impl BrushForms {
    /// The unit disc in one colour.
    fn form(&mut self, profile: Profile, colour: Colour, file: &mut File) -> Ref {
        if let Some(form) = self.0.get(&(profile, colour)) {
            return *form;
        }
        let bounds = Rect::new(-1.0, -1.0, 1.0, 1.0);
        let mut content = ContentStream::new();
        set_gradient(&mut content, file, &profile.brush(colour), bounds);
        content.fill_rectangle(bounds);
        let form = content.form(file, bounds);
        self.0.insert((profile, colour), form);
        form
    }
}

impl<'a> PdfTextons<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let bounds = scene.elements.iter().map(Element::bounds).collect();
        let (shadows, defined_shadows) = (Shadows::new(scene), BTreeMap::new());
        let mut textons = Self {
            scene,
            bounds,
            uses: BTreeMap::new(),
            defined: BTreeMap::new(),
            shadows,
            defined_shadows,
            brushes: BrushForms::default(),
        };
        for instance in scene.instances() {
            let count = textons.places(instance).count();
            *textons.uses.entry((instance.element, instance.colour)).or_default() += count;
        }
        textons
    }

    /// The heights of the visible copies of an instance, and their maps to the canvas.
    fn places(&self, instance: &Instance) -> impl Iterator<Item = (i64, Affine)> + use<'a> {
        let (scene, affine) = (self.scene, instance.affine());
        let bounds = instance.reach(self.bounds[instance.element.index()]);
        let shifts = scene.copies(bounds).filter(move |&shift| is_seen(scene, bounds, shift));
        let height = i64::from(instance.height);
        shifts.map(move |shift| (height + scene.height_of_copy(shift), affine.then_translate(shift)))
    }

    /// Draws a layer.
    pub(super) fn draw(&mut self, instances: &[Instance], content: &mut ContentStream, file: &mut File) {
        let places = |instance| self.places(instance).map(move |(height, affine)| (height, instance, affine));
        let mut painted: Vec<(i64, &Instance, Affine)> = instances.iter().flat_map(places).collect();
        if self.scene.is_stacked() {
            painted.sort_by_key(|place| place.0);
        }
        for of_one in painted.chunk_by(|a, b| a.1.id == b.1.id) {
            let instance = of_one[0].1;
            let key = (instance.element, instance.colour);
            let element = self.scene.element(instance);
            // Gradients are drawn in forms of their own.
            let shared = !element.base().is_soft()
                && (self.uses[&key].saturating_sub(1) * path_elements(element) >= WORTH
                    || has_gradient(element, instance.colour));
            for &(_, _, affine) in of_one {
                if let Some(shadow) = &instance.shadow {
                    let form = self.shadow(instance, shadow, file);
                    content.within(|c| {
                        c.transform(affine.then_translate(shadow.shift()));
                        c.draw(form);
                    });
                }
                let form = if shared { Some(self.form(key, element, file)) } else { None };
                content.within(|c| {
                    c.transform(affine);
                    match form {
                        Some(form) => c.draw(form),
                        // Written in its own coordinates, whose numbers are short.
                        None => paint(element, instance.colour, c, file, &mut self.brushes),
                    }
                    if let Some(stroke) = instance.stroke {
                        c.stroke(element.outline(), stroke.colour, stroke.width);
                    }
                });
            }
        }
    }

    /// A texton that is defined once, in one colour.
    fn form(&mut self, key: (ElementId, Option<Colour>), element: &Element, file: &mut File) -> Ref {
        if let Some(form) = self.defined.get(&key) {
            return *form;
        }
        let mut content = ContentStream::new();
        paint(element, key.1, &mut content, file, &mut self.brushes);
        let bounds =
            union(element.shapes.iter().filter(|shape| !shape.is_soft()).map(|shape| &shape.outline));
        let beyond = element.base().rim.as_ref().map_or(0.0, |rim| rim.width / 2.0);
        let bounds = bounds.inflate(beyond, beyond);
        let form = content.form(file, bounds);
        self.defined.insert(key, form);
        form
    }

    /// A shadow, which is defined once.
    fn shadow(&mut self, instance: &Instance, shadow: &vtex_scene::scene::Shadow, file: &mut File) -> Ref {
        let key = shadow::key(instance, shadow);
        if let Some(form) = self.defined_shadows.get(&key) {
            return *form;
        }
        let layers = self.shadows.of(instance, shadow);
        let mut content = ContentStream::new();
        content.fill_with(Colour([0; 3]));
        for layer in layers.iter().filter(|layer| !is_empty(&layer.outline)) {
            set_opacity(&mut content, file, layer.opacity);
            content.fill(&layer.outline);
        }
        let form = content.form(file, union(layers.iter().map(|layer| &layer.outline)));
        self.defined_shadows.insert(key, form);
        form
    }
}

/// The bounds of all outlines, slightly enlarged.
fn union<'a>(outlines: impl Iterator<Item = &'a Outline>) -> Rect {
    let bounds = outlines.filter(|o| !is_empty(o)).map(Outline::bounds).reduce(|a, b| a.union(b));
    bounds.map_or(Rect::ZERO, |b| b.inset(0.01))
}

/// Number of path elements of all shapes of an element.
fn path_elements(element: &Element) -> usize {
    element.shapes.iter().map(|s| s.outline.path().elements().len()).sum()
}

/// Whether an element, its base in `colour` if there is one, is painted with a gradient or softly.
fn has_gradient(element: &Element, colour: Option<Colour>) -> bool {
    element.paint(colour).1.is_some() || element.details().iter().any(|s| s.gradient.is_some() || s.is_soft())
}

/// The shapes of an element, its base in `colour` if there is one.
fn paint(
    element: &Element,
    colour: Option<Colour>,
    content: &mut ContentStream,
    file: &mut File,
    brushes: &mut BrushForms,
) {
    if let Some((ellipse, colour)) = element.spot(colour) {
        return paint_softly(ellipse, (colour, element.base().opacity), content, file, brushes);
    }
    let mut last = None;
    let seen = element.shapes.iter().enumerate().filter(|(_, shape)| !is_empty(&shape.outline));
    let seen: Vec<_> = seen.collect();
    for run in seen.chunk_by(|a, b| a.1.is_soft() == b.1.is_soft()) {
        if run[0].1.is_soft() {
            content.within(|c| {
                c.clip(&element.base().outline, &[Vec2::ZERO]);
                for (shape, ellipse) in run.iter().filter_map(|(_, s)| Some((s, s.ellipse.as_ref()?))) {
                    paint_softly(ellipse, (shape.colour, shape.opacity), c, file, brushes);
                }
            });
            continue;
        }
        for &(i, shape) in run {
            let own = colour.filter(|_| i == 0);
            let gradient = shape.gradient.as_deref().filter(|_| own.is_none());
            let flat = own.unwrap_or(shape.colour);
            if gradient.is_none() && shape.opacity == 1.0 {
                if last != Some(flat) {
                    content.fill_with(flat);
                }
                last = Some(flat);
                content.fill(&shape.outline);
                continue;
            }
            content.within(|c| {
                if shape.opacity != 1.0 {
                    set_opacity(c, file, shape.opacity);
                }
                match gradient {
                    Some(gradient) => set_gradient(c, file, gradient, shape.outline.bounds()),
                    None => c.fill_with(flat),
                }
                c.fill(&shape.outline);
            });
        }
    }
    if let Some(rim) = element.base().rim.as_ref().filter(|_| !is_empty(&element.base().outline)) {
        for [width, opacity] in rim.strokes() {
            content.within(|c| {
                set_line_opacity(c, file, opacity);
                c.stroke(&element.base().outline, rim.colour, width);
            });
        }
    }
}

/// A soft ellipse of one colour and opacity.
fn paint_softly(
    ellipse: &Ellipse,
    (colour, opacity): (Colour, f64),
    content: &mut ContentStream,
    file: &mut File,
    brushes: &mut BrushForms,
) {
    let form = brushes.form(ellipse.profile, colour, file);
    content.within(|c| {
        if opacity != 1.0 {
            set_opacity(c, file, opacity);
        }
        c.transform(ellipse.map());
        c.draw(form);
    });
}
