//! What is drawn on one element appears on all that are like it (Tu, dissertation, section 4.4.5.2).

use super::selection::Chosen;
use super::textons::{change, selected_mut};
use crate::element::Gaussian;
use crate::geometry::{Affine, Outline, Point, Vec2, shortest_offset};
use crate::scene::{Element, Instance, Scene, Shape};

/// Adds shapes, given on the canvas, to the selected element under them and to all selected elements that
/// are like it, in their frames; or puts them in place of these. Elements are alike if they are of one
/// category, or, with `similar`, if their median colours are no further apart in Oklab. How many there are,
/// and how many of them have no frame.
pub(super) fn propagate(
    scene: &mut Scene,
    chosen: &Chosen,
    shapes: &[Shape],
    similar: Option<f64>,
    replace: bool,
) -> (usize, usize) {
    let gaussians = scene.gaussians();
    let Some((edited, period)) = beneath(scene, chosen, &gaussians, shapes) else { return (0, 0) };
    let Some((source, own)) =
        scene.instances().nth(edited).and_then(|i| Some((i, scene.element(i).gaussian()?)))
    else {
        return (0, 0);
    };
    // From the canvas to the canonical frame of the edited element.
    let canonical = own.frame().inverse() * source.affine().inverse() * Affine::translate(-period);
    let like = likeness(scene, source, edited, similar);
    let mut alike = chosen.only(scene, |_| true, |_, _| false);
    let mut index = 0;
    let (mut count, mut thin) = (0, 0);
    for layer in &mut alike.layers {
        layer.fallback = false;
        for chosen in &mut layer.instances {
            let is = *chosen && like[index];
            count += usize::from(is);
            thin += usize::from(is && gaussians[index].is_none());
            *chosen = is && gaussians[index].is_some();
            index += 1;
        }
    }
    change(scene, &alike, |element, _| drawn_on(element, shapes, canonical, replace));
    if replace {
        selected_mut(scene, &alike).for_each(|i| i.colour = None);
    }
    (count, thin)
}

/// Largest squared Mahalanobis distance of shapes from the element on which they are drawn. The border of a disc
/// lies at 4.
const FARTHEST: f64 = 6.0;

/// The selected element on which shapes are drawn: the one whose mean is nearest to the middle of their
/// bounds by its own covariance; of several, the one painted last. With the whole periods from the element to
/// the copy of it on which they are drawn.
fn beneath(
    scene: &Scene,
    chosen: &Chosen,
    gaussians: &[Option<Gaussian>],
    shapes: &[Shape],
) -> Option<(usize, Vec2)> {
    let mut bounds = shapes.iter().map(|s| s.outline.bounds());
    let first = bounds.next()?;
    let middle: Point = bounds.fold(first, |all, next| all.union(next)).center();
    let periods = scene.periods();
    let value = |(i, chosen): (usize, bool)| {
        let own = gaussians[i].filter(|_| chosen)?;
        let way = shortest_offset(own.mean, middle, periods);
        Some((own.squared_distance(way), (i, middle - own.mean - way)))
    };
    let near = chosen.instances().enumerate().filter_map(value).filter(|(far, _)| *far <= FARTHEST);
    near.min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.0.cmp(&a.1.0))).map(|(_, found)| found)
}

/// Whether each instance is like one.
fn likeness(scene: &Scene, source: &Instance, edited: usize, similar: Option<f64>) -> Vec<bool> {
    if let Some(reach) = similar {
        let appearances = scene.appearances();
        let wanted = appearances[edited].median;
        let distance = |lab: [f32; 3]| -> f64 {
            libm::sqrt((0..3).map(|k| f64::from(lab[k] - wanted[k])).map(|d| d * d).sum())
        };
        return appearances.iter().map(|a| distance(a.median) <= reach).collect();
    }
    let element = scene.element(source);
    let key = |e: &Element| (e.library, e.category);
    let like = |i: &Instance| match element.category {
        Some(_) => key(scene.element(i)) == key(element),
        None => i.element == source.element,
    };
    scene.instances().map(like).collect()
}

/// An element with shapes that `canonical` brings to the canonical frame.
fn drawn_on(element: &Element, shapes: &[Shape], canonical: Affine, replace: bool) -> Element {
    let Some(own) = element.gaussian() else { return element.clone() };
    let map = own.frame() * canonical;
    let moved = |shape: &Shape| {
        let outline = Outline::new(&(map * shape.outline.path()))?;
        let gradient = shape.gradient.as_ref().and_then(|g| g.drawn(map));
        (!outline.is_empty()).then(|| Shape { gradient, ..shape.with_outline(outline) })
    };
    let new: Vec<Shape> = shapes.iter().filter_map(moved).collect();
    if !replace {
        return element.with_shapes(element.shapes.iter().cloned().chain(new).collect());
    }
    if new.is_empty() {
        return element.clone();
    }
    // The outline of the whole stays, so that the element has the frame that it had.
    Element { silhouette: Some(element.outline().clone()), shapes: new, ..*element }
}
