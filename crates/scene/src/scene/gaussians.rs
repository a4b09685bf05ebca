//! The elements of a scene as Gaussians, and their appearance.
//!
//! The decoder is an affine map: an instance drawn in the frame of another Gaussian is the same element with
//! one map in front of its own. Outlines are never fitted again.

use super::{Element, Instance, Scene};
use crate::element::{Appearance, Gaussian};
use vtex_base::geometry::Affine;
use vtex_base::parallel;

impl Element {
    /// Its Gaussian, in its own coordinates; `None` if its outline has no area.
    pub fn gaussian(&self) -> Option<Gaussian> {
        Gaussian::new(self.outline())
    }
}

impl Scene {
    /// The Gaussian of every instance on the canvas, in painting order; `None` for those that are too thin
    /// for a frame ([`Gaussian::is_degenerate`]).
    pub fn gaussians(&self) -> Vec<Option<Gaussian>> {
        let own = parallel::map(&self.elements, Element::gaussian);
        let of = |i: &Instance| own[i.element.index()].map(|own| own.moved(i.affine()));
        self.instances().map(|i| of(i).filter(|g| !g.is_degenerate())).collect()
    }

    /// The appearance of every instance, in painting order.
    pub fn appearances(&self) -> Vec<Appearance> {
        let whole = parallel::map(&self.elements, |element| element.outline().area());
        let plain: Vec<usize> = (0..self.elements.len()).collect();
        let own = parallel::map(&plain, |&k| Appearance::new(&self.elements[k].shapes, whole[k], None));
        let of = |i: &Instance| {
            let k = i.element.index();
            let replaced = i.colour.map(|c| Appearance::new(&self.elements[k].shapes, whole[k], Some(c)));
            replaced.unwrap_or(own[k])
        };
        self.instances().map(of).collect()
    }
}

impl Instance {
    /// The coefficients of the map that moves the instance from the frame `own` to the frame `target`: A =
    /// U*^½ · R · U^-½ after its own map (decoder of composable textons).
    pub fn decoded(&self, own: &Gaussian, target: &Gaussian) -> [f64; 6] {
        let drawn: Affine = own.onto(target) * self.affine();
        drawn.as_coeffs()
    }
}
