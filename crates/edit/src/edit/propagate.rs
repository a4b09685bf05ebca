//! Shapes drawn on one element are repeated on all similar ones (Tu, dissertation, section 4.4.5.2).

use super::AppliedCounts;
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

/// The elements that count as similar.
#[derive(Clone, Copy)]
pub(super) struct Similarity {
    /// The element that others are compared with; by default the one drawn on. Without either, all elements are
    /// similar.
    pub(super) of: Option<InstanceId>,
    /// Largest distance of median colours, in Oklab; by default elements of one category are similar.
    pub(super) distance: Option<f64>,
}

/// Largest number of lines and curves drawn on elements: some 20 MB of SVG.
const MOST_DRAWN: usize = 2_000_000;

/// Draws on all selected similar elements, in their frames, or replaces their shapes. Elements without a frame
/// count as thin.
///
/// # Errors
/// [`EditFault::TooMuchDrawn`].
pub(super) fn propagate(
    scene: &mut Scene,
    chosen: &Chosen,
    what: &Propagated<'_>,
    similarity: Similarity,
    replace: bool,
) -> Result<AppliedCounts, EditFault> {
    let gaussians = scene.gaussians();
    let Some(edited) = edited_element(scene, chosen, &gaussians, what, similarity.of) else {
        return Ok(AppliedCounts::default());
    };
    let is_similar = similar_elements(scene, edited.instance, similarity.distance);
    let needs_frame = !matches!(what, Propagated::Fill(_));
    let can_change: Vec<bool> = gaussians.iter().map(|g| !needs_frame || g.is_some()).collect();
    let (similar, counts) = restricted(scene, chosen, &is_similar, &can_change);
    match what {
        Propagated::Fill(colour) => selected_mut(scene, &similar).for_each(|i| i.colour = Some(*colour)),
        Propagated::Over(shapes) | Propagated::Alone(shapes) => {
            check_size(scene, &similar, shapes)?;
            let mode = match what {
                _ if !replace => DrawingMode::Add,
                Propagated::Alone(_) => DrawingMode::Replace { outline: largest(shapes) },
                _ => DrawingMode::Replace { outline: None },
            };
            change(scene, &similar, |element, _| drawn_on(element, shapes, edited.canonical, mode));
            if replace {
                selected_mut(scene, &similar).for_each(|i| i.colour = None);
            }
        }
    }
    Ok(counts)
}

/// The element on which a change is made first.
struct EditedElement {
    /// Index of its instance; `None` if the change is made on no particular element.
    instance: Option<usize>,
    /// The map from the coordinates of the shapes to the canonical frame of an element.
    canonical: Affine,
}

/// The element on which a change is made first, which must be the element `of` if that is given. `None` if there
/// is no such element, or no frame for the shapes.
fn edited_element(
    scene: &Scene,
    chosen: &Chosen,
    gaussians: &[Option<Gaussian>],
    what: &Propagated<'_>,
    of: Option<InstanceId>,
) -> Option<EditedElement> {
    let named = match of {
        Some(id) => {
            let mut all = scene.instances().zip(chosen.instances());
            Some(all.position(|(instance, chosen)| chosen && instance.id == id)?)
        }
        None => None,
    };
    match what {
        Propagated::Over(shapes) => {
            let (beneath, period) = element_beneath(scene, chosen, gaussians, shapes)?;
            if named.is_some_and(|named| named != beneath) {
                return None;
            }
            let canonical = drawn_over(scene, beneath, period)?;
            Some(EditedElement { instance: Some(beneath), canonical })
        }
        Propagated::Alone(shapes) => {
            let own = Gaussian::new(&largest(shapes)?.outline)?;
            Some(EditedElement { instance: named, canonical: own.frame().inverse() })
        }
        Propagated::Fill(_) => Some(EditedElement { instance: named, canonical: Affine::IDENTITY }),
    }
}

/// Restricts a selection to similar elements that can change, without points of fields. Counts all similar
/// elements, and those that cannot change as thin.
fn restricted(
    scene: &Scene,
    chosen: &Chosen,
    is_similar: &[bool],
    can_change: &[bool],
) -> (Chosen, AppliedCounts) {
    let mut restricted = chosen.only(scene, |_| true, |_, _| false);
    let mut counts = AppliedCounts::default();
    let mut each = is_similar.iter().zip(can_change);
    for layer in &mut restricted.layers {
        layer.fallback = false;
        for (chosen, (similar, can_change)) in layer.instances.iter_mut().zip(&mut each) {
            let matched = *chosen && *similar;
            counts.matched += usize::from(matched);
            counts.thin += usize::from(matched && !can_change);
            *chosen = matched && *can_change;
        }
    }
    (restricted, counts)
}

/// Fails if drawing shapes on all selected elements would take too many lines and curves.
fn check_size(scene: &Scene, chosen: &Chosen, shapes: &[Shape]) -> Result<(), EditFault> {
    let elements: BTreeSet<ElementId> = selected(scene, chosen).map(|i| i.element).collect();
    let (lines, elements) = (shapes.iter().map(lines).sum::<usize>(), elements.len());
    if lines.saturating_mul(elements) > MOST_DRAWN {
        return Err(EditFault::TooMuchDrawn { lines, elements, most: MOST_DRAWN });
    }
    Ok(())
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
        let offset = shortest_offset(own.mean, middle, periods);
        Some((own.squared_distance(offset), (i, middle - own.mean - offset)))
    };
    let near = chosen.instances().enumerate().filter_map(value).filter(|(far, _)| *far <= FARTHEST);
    near.min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.0.cmp(&a.1.0))).map(|(_, found)| found)
}

/// Whether each instance is similar to the edited one; all are if there is none.
fn similar_elements(scene: &Scene, edited: Option<usize>, distance: Option<f64>) -> Vec<bool> {
    let Some((index, source)) = edited.and_then(|k| Some((k, scene.instances().nth(k)?))) else {
        return vec![true; scene.count()];
    };
    if let Some(largest) = distance {
        let appearances = scene.appearances();
        let wanted = appearances[index].median;
        let distance = |lab: [f32; 3]| -> f64 {
            libm::sqrt((0..3).map(|k| f64::from(lab[k] - wanted[k])).map(|d| d * d).sum())
        };
        return appearances.iter().map(|a| distance(a.median) <= largest).collect();
    }
    let element = scene.element(source);
    let key = |e: &Element| (e.library, e.category);
    let is_similar = |i: &Instance| match element.category {
        Some(_) => key(scene.element(i)) == key(element),
        None => i.element == source.element,
    };
    scene.instances().map(is_similar).collect()
}

/// How shapes are drawn on an element.
#[derive(Clone, Copy)]
enum DrawingMode<'a> {
    /// On its shapes.
    Add,
    /// In place of its shapes. The outline of the whole becomes that of a shape, or stays, so that the element
    /// keeps its frame.
    Replace { outline: Option<&'a Shape> },
}

/// An element with added or replaced shapes; `canonical` maps them to the canonical frame.
fn drawn_on(element: &Element, shapes: &[Shape], canonical: Affine, mode: DrawingMode<'_>) -> Element {
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
    let DrawingMode::Replace { outline } = mode else {
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
