//! Libraries in other colours, and of stretched contrast.

use super::{Category, ExemplarElement, ExemplarLayer, Library, Shape};
use crate::scene::{ControlPoint, Field, Scene};
use image::Rgb;
use vtex_base::raster::colour::Colour;

/// An affine map of colours, with the same factor for each sRGB component, that stretches contrast.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    gain: f64,
    /// For each component a value, and the value that it becomes.
    middles: [[f64; 2]; 3],
}

impl Stretch {
    /// The stretch of components within ranges, from 0 to 255, by a factor. Each is stretched about the middle of its
    /// range, and moved as little as makes the stretched range fit, with some room beside it where there is some.
    pub fn new(ranges: [[f64; 2]; 3], gain: f64) -> Self {
        /// Room that a stretched range takes, in ranges.
        const ROOM: f64 = 1.25;
        let middles = ranges.map(|[low, high]| {
            let half = (ROOM * gain * (high - low) / 2.0).min(127.5);
            let middle = (low + high) / 2.0;
            [middle, middle.clamp(half, 255.0 - half)]
        });
        Self { gain, middles }
    }

    /// The stretch that the contrast of a library was measured for: one of its colours. `None` for an ordinary
    /// contrast.
    pub fn of_library(library: &Library) -> Option<Self> {
        if library.source.contrast == 1.0 {
            return None;
        }
        let mut ranges = [[255.0f64, 0.0]; 3];
        let mut add = |colour: Colour| {
            for (range, v) in ranges.iter_mut().zip(colour.to_f64()) {
                *range = [range[0].min(v), range[1].max(v)];
            }
        };
        library.elements.iter().flat_map(|e| &e.shapes).for_each(|shape| add(shape.colour));
        let fields = library.layers.iter().filter_map(|layer| layer.field.as_ref());
        fields.flat_map(|field| &field.points).for_each(|point| add(point.colour));
        library.guide.iter().flat_map(|guide| guide.picture.0.pixels()).for_each(|p| add(Colour(p.0)));
        (ranges[0][0] <= ranges[0][1]).then(|| Self::new(ranges, library.source.contrast))
    }

    /// The factor.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// A stretched colour, by sRGB component, not clamped.
    pub fn applied(&self, colour: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let [from, to] = self.middles[c];
            to + (colour[c] - from) * self.gain
        })
    }

    /// The colour that was stretched to `colour`.
    pub fn undone(&self, colour: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let [from, to] = self.middles[c];
            from + (colour[c] - to) / self.gain
        })
    }

    /// A library in stretched colours. Its categories keep their names.
    pub fn stretched(&self, library: &Library) -> Library {
        let mut stretched = library.clone().recoloured(|c| self.applied(c), self.gain);
        for (category, name) in stretched.categories.iter_mut().zip(library.category_names()) {
            category.name = Some(name);
        }
        stretched
    }

    /// The scene made of a library in stretched colours, in those of the library.
    pub fn undone_in(&self, mut scene: Scene) -> Scene {
        let own = |colour: &mut Colour| *colour = Colour::from_f64(self.undone(colour.to_f64()));
        let recoloured = |shape: &Shape| shape.recoloured(|c| Colour::from_f64(self.undone(c.to_f64())));
        for element in &mut scene.elements {
            *element = element.with_shapes(element.shapes.iter().map(recoloured).collect());
        }
        for layer in &mut scene.layers {
            layer.instances.iter_mut().filter_map(|i| i.colour.as_mut()).for_each(own);
            if let Some(field) = &mut layer.field {
                own(&mut field.fallback);
                field.points.iter_mut().for_each(|point| own(&mut point.colour));
            }
        }
        scene
    }
}

impl Library {
    /// The library with all its colours changed by a map of sRGB components from 0 to 255, which need not stay within
    /// them. Differences of colours, which must come from an affine map, are multiplied by `slope`. Only names of
    /// layers stay as they are.
    pub fn recoloured(self, new: impl Fn([f64; 3]) -> [f64; 3], slope: f64) -> Self {
        let colour = |c: Colour| Colour::from_f64(new(c.to_f64()));
        let element = |e: ExemplarElement| ExemplarElement {
            colour: colour(e.colour),
            difference: e.difference.map(|d| d.map(|v| libm::round(f64::from(v) * slope) as i16)),
            shapes: e.shapes.iter().map(|shape| shape.recoloured(colour)).collect(),
            ..e
        };
        let point = |p: ControlPoint| ControlPoint { colour: colour(p.colour), ..p };
        let field = |f: Field| Field {
            fallback: colour(f.fallback),
            points: f.points.into_iter().map(point).collect(),
            ..f
        };
        let layer =
            |l: ExemplarLayer| ExemplarLayer { colour: l.colour.map(colour), field: l.field.map(field), ..l };
        let category = |c: Category| {
            let [red, green, blue, area, compactness] = c.centre;
            let [red, green, blue] = new([red, green, blue]);
            Category { centre: [red, green, blue, area, compactness], ..c }
        };
        let guide = self.guide.map(|mut guide| {
            guide.picture.0.pixels_mut().for_each(|p| *p = Rgb(colour(Colour(p.0)).0));
            guide
        });
        Self {
            elements: self.elements.into_iter().map(element).collect(),
            layers: self.layers.into_iter().map(layer).collect(),
            categories: self.categories.into_iter().map(category).collect(),
            guide,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::testing::{guided, mosaic};
    use vtex_base::document::Document as _;

    #[test]
    fn colours_come_back_from_a_stretch() {
        let whole = guided(&mosaic(120, 14.0, 0.6, 1));
        let subtle = |[r, g, b]: [f64; 3]| [240.0 + r / 32.0, 8.0 + g / 32.0, 120.0 + b / 32.0];
        let mut library = whole.recoloured(subtle, 1.0 / 32.0);
        assert_eq!(Stretch::of_library(&library), None, "an ordinary contrast");
        library.source.contrast = 8.0;
        let stretch = Stretch::of_library(&library).unwrap();
        let stretched = stretch.stretched(&library);
        assert_eq!((stretched.validate(), stretched.category_names()), (Ok(()), library.category_names()));
        let mut back = stretched.clone().recoloured(|c| stretch.undone(c), 1.0 / stretch.gain());
        back.categories.clone_from(&library.categories);
        assert_eq!(back, library);
        let range = |library: &Library| {
            let red = library.elements.iter().map(|e| e.colour.0[0]);
            f64::from(red.clone().max().unwrap() - red.min().unwrap())
        };
        assert_eq!(range(&stretched), 8.0 * range(&library));
        let reconstruct = |library: &Library| crate::reconstruct::reconstruct(library);
        assert_eq!(stretch.undone_in(reconstruct(&stretched)), reconstruct(&library));
    }
}
