//! Scales all lengths of a scene.

use super::{ControlPoint, Domain, Element, Field, Instance, Layer, Scene, Shadow, Stroke};
use vtex_base::geometry::{Affine, Outline};
use vtex_base::parallel;

/// Reciprocal of the step to which places are rounded.
const FINE: f64 = 1e3;

/// A place on a plane that is scaled along x and y.
pub(crate) fn place(at: [f64; 2], by: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| libm::round(at[k] * by[k] * FINE) / FINE)
}

/// The map of an instance after elements are scaled by `elements` and places by `places`, along x and y.
pub(crate) fn conjugate([a, b, c, d, e, f]: [f64; 6], elements: [f64; 2], places: [f64; 2]) -> [f64; 6] {
    let across = elements[1] / elements[0];
    let [e, f] = place([e, f], places);
    [a, b * across, c / across, d, e, f]
}

impl Field {
    /// The field of a plane that is scaled along x and y.
    pub(crate) fn scaled(&self, by: [f64; 2]) -> Self {
        let point = |p: &ControlPoint| {
            let [x, y] = place([p.x, p.y], by);
            ControlPoint { x, y, ..*p }
        };
        // A spacing of less than a pixel is not valid.
        let spacing = (self.spacing * mean(by)).max(1.0);
        Self { spacing, fallback: self.fallback, points: self.points.iter().map(point).collect() }
    }
}

impl Scene {
    /// The scene stretched over a canvas of another size in pixels. Elements, with their shadows and strokes,
    /// are scaled by `elements` along x and y; these factors equal those of the canvas up to its rounding.
    pub fn scaled(self, [width, height]: [u32; 2], elements: [f64; 2]) -> Self {
        let places = [f64::from(width) / f64::from(self.width), f64::from(height) / f64::from(self.height)];
        let affine = Affine::scale_non_uniform(elements[0], elements[1]);
        let stretch = Affine::scale_non_uniform(places[0], places[1]);
        let moved = |outline: &Outline| outline.moved(affine);
        let stretched = |outline: &Outline| outline.moved(stretch);
        let element = |e: &Element| Element {
            silhouette: e.silhouette.as_ref().map(moved),
            shapes: e.shapes.iter().map(|shape| shape.moved(affine)).collect(),
            ..*e
        };
        let size = mean(elements);
        let instance = |i: &Instance| Instance {
            transform: conjugate(i.transform, elements, places),
            shadow: i.shadow.map(|s| Shadow { offset: place(s.offset, places), blur: s.blur * size, ..s }),
            stroke: i.stroke.map(|s| Stroke { width: s.width * size, ..s }),
            ..*i
        };
        let layer = |l: Layer| Layer {
            region: l.region.as_ref().map(stretched),
            field: l.field.as_ref().map(|field| field.scaled(places)),
            instances: l.instances.iter().map(instance).collect(),
            ..l
        };
        Self {
            width,
            height,
            elements: parallel::map(&self.elements, element),
            layers: self.layers.into_iter().map(layer).collect(),
            domain: self.domain.map(|d| Domain { outline: stretched(&d.outline), ..d }),
            ..self
        }
    }
}

fn mean(by: [f64; 2]) -> f64 {
    libm::sqrt(by[0] * by[1])
}
