//! Shapes drawn on one element are repeated on all similar ones (Tu, dissertation, section 4.4.5.2).

use super::selection::Chosen;
use super::textons::{change, selected, selected_mut};
use std::collections::BTreeSet;
use vtex_base::error::EditFault;
use vtex_base::geometry::{Affine, Outline, Point, Vec2, shortest_offset};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Gaussian;
use vtex_scene::scene::{Element, ElementId, Instance, InstanceId, Scene, Shape};

/// The change that is repeated on elements.
pub(super) enum Propagated<'a> {
    /// Shapes on the canvas. They are drawn on the element beneath them.
    Over(&'a [Shape]),
    /// Shapes without a place. The largest is brought onto each element.
    Alone(&'a [Shape]),
    /// A new colour of the first shape.
    Fill(Colour),
}

/// Which elements count as similar.
#[derive(Clone, Copy)]
pub(super) struct Like {
    /// The element that others are compared with; by default the one drawn on, and without one all elements
    /// are similar.
    pub(super) of: Option<InstanceId>,
    /// Largest distance of median colours, in Oklab; by default elements of one category are similar.
    pub(super) similar: Option<f64>,
}

/// Largest number of lines and curves drawn on elements: some 20 MB of SVG.
const MOST_DRAWN: usize = 2_000_000;

/// Draws on all selected similar elements, in their frames, or replaces their shapes. Returns their number,
/// and how many of them have no frame.
///
/// # Errors
/// [`EditFault::TooMuchDrawn`].
pub(super) fn propagate(
    scene: &mut Scene,
    chosen: &Chosen,
    what: &Propagated<'_>,
    like: Like,
    replace: bool,
) -> Result<(usize, usize), EditFault> {
    let gaussians = scene.gaussians();
    let named = like.of.and_then(|id| {
        let mut all = scene.instances().zip(chosen.instances());
        all.position(|(instance, chosen)| chosen && instance.id == id)
    });
    if like.of.is_some() && named.is_none() {
        return Ok((0, 0));
    }
    let mut edited = named;
    // The map from the coordinates of the shapes to the canonical frame of an element.
    let mut canonical = Affine::IDENTITY;
    match what {
        Propagated::Over(shapes) => {
            let under = |k: &usize| named.is_none_or(|named| named == *k);
            let Some((found, map)) = element_beneath(scene, chosen, &gaussians, shapes)
                .filter(|(found, _)| under(found))
                .and_then(|(found, period)| Some((found, drawn_over(scene, found, period)?)))
            else {
                return Ok((0, 0));
            };
            (edited, canonical) = (Some(found), map);
        }
        Propagated::Alone(shapes) => {
            let Some(own) = largest(shapes).and_then(|shape| Gaussian::new(&shape.outline)) else {
                return Ok((0, 0));
            };
            canonical = own.frame().inverse();
        }
        Propagated::Fill(_) => (),
    }
    let like = match edited.and_then(|k| Some((scene.instances().nth(k)?, k))) {
        Some((source, k)) => likeness(scene, source, k, like.similar),
        None => vec![true; gaussians.len()],
    };
    let fill = matches!(what, Propagated::Fill(_));
    let mut alike = chosen.only(scene, |_| true, |_, _| false);
    let mut index = 0;
    let (mut count, mut thin) = (0, 0);
    for layer in &mut alike.layers {
        layer.fallback = false;
        for chosen in &mut layer.instances {
            let is = *chosen && like[index];
            let can = fill || gaussians[index].is_some();
            count += usize::from(is);
            thin += usize::from(is && !can);
            *chosen = is && can;
            index += 1;
        }
    }
    match what {
        Propagated::Fill(colour) => selected_mut(scene, &alike).for_each(|i| i.colour = Some(*colour)),
        Propagated::Over(shapes) | Propagated::Alone(shapes) => {
            let elements: BTreeSet<ElementId> = selected(scene, &alike).map(|i| i.element).collect();
            let (lines, elements) = (shapes.iter().map(lines).sum::<usize>(), elements.len());
            if lines.saturating_mul(elements) > MOST_DRAWN {
                return Err(EditFault::TooMuchDrawn { lines, elements, most: MOST_DRAWN });
            }
            let outline = matches!(what, Propagated::Alone(_)).then(|| largest(shapes)).flatten();
            change(scene, &alike, |element, _| {
                let replaced = replace.then_some(outline);
                drawn_on(element, shapes, canonical, replaced)
            });
            if replace {
                selected_mut(scene, &alike).for_each(|i| i.colour = None);
            }
        }
    }
    Ok((count, thin))
}

/// Lines and curves of a shape.
fn lines(shape: &Shape) -> usize {
    shape.outline.path().elements().len()
}

/// The shape with the largest area.
fn largest(shapes: &[Shape]) -> Option<&Shape> {
    shapes.iter().max_by(|a, b| a.outline.area().total_cmp(&b.outline.area()))
}

/// Canvas → canonical frame of the edited element; `period` is the shift of the copy that is drawn on.
fn drawn_over(scene: &Scene, edited: usize, period: Vec2) -> Option<Affine> {
    let source = scene.instances().nth(edited)?;
    let own = scene.element(source).gaussian()?;
    Some(own.frame().inverse() * source.affine().inverse() * Affine::translate(-period))
}

/// Largest squared Mahalanobis distance of shapes from the element on which they are drawn. The border of a disc
/// lies at 4.
const FARTHEST: f64 = 6.0;

/// The selected element on which shapes are drawn: the one whose mean is nearest to the middle of their
/// bounds by its own covariance; ties go to the one painted last. Also the shift, in whole periods, from the
/// element to its copy on which they are drawn.
fn element_beneath(
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

/// Whether each instance is similar to `source`.
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

/// An element with added or replaced shapes; `canonical` maps them to the canonical frame. If the shapes are
/// replaced, the outline of the whole is that of a shape, or else stays, so that the element keeps its frame.
fn drawn_on(
    element: &Element,
    shapes: &[Shape],
    canonical: Affine,
    replaced: Option<Option<&Shape>>,
) -> Element {
    let Some(own) = element.gaussian() else { return element.clone() };
    let map = own.frame() * canonical;
    let moved = |shape: &Shape| {
        let outline = Outline::new(&(map * shape.outline.path()))?;
        let gradient = shape.gradient.as_ref().and_then(|g| g.drawn(map));
        (!outline.is_empty()).then(|| Shape { gradient, ..shape.with_outline(outline) })
    };
    // Soft ellipses are visible only on another shape or alone.
    let new: Vec<Shape> = match shapes {
        [spot] if spot.is_soft() => moved(spot).into_iter().collect(),
        _ => shapes.iter().filter_map(moved).skip_while(Shape::is_soft).collect(),
    };
    let Some(outline) = replaced else {
        // Shapes on a soft ellipse are not visible.
        if element.base().is_soft() {
            return element.clone();
        }
        return element.with_shapes(element.shapes.iter().cloned().chain(new).collect());
    };
    if new.is_empty() {
        return element.clone();
    }
    let whole = outline.and_then(moved).map(|shape| shape.outline);
    let silhouette = Some(whole.unwrap_or_else(|| element.outline().clone()));
    Element { silhouette: silhouette.filter(|s| *s != new[0].outline), shapes: new, ..*element }
}
