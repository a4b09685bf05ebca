//! The style of elements: shadows, lines, fewer details, simpler outlines.

use super::colours::mean;
use super::selection::Chosen;
use super::textons::{change, selected_mut, size};
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::{Element, Instance, Scene, Shadow, Shape, Stroke};

/// Decimals with which the length of simplified outlines is measured: those of an SVG.
const DECIMALS: u8 = 1;

/// Converts a length on the canvas to a texton's own pixels, rounded to hundredths, at least 0.01.
fn in_own_pixels(length: f64, size: f64) -> f64 {
    (libm::round(100.0 * length / size.max(1e-6)) / 100.0).max(0.01)
}

/// Whether each element of a scene is a soft ellipse. It is shading of the ground, and has neither shadow nor line.
fn are_spots(scene: &Scene) -> Vec<bool> {
    scene.elements.iter().map(|element| element.base().is_soft()).collect()
}

pub(super) fn shadow(scene: &mut Scene, chosen: &Chosen, angle: f64, length: f64, opacity: f64, blur: f64) {
    let angle = angle.to_radians();
    let offset = [libm::cos(angle), libm::sin(angle)].map(|v| libm::round(100.0 * length * v) / 100.0);
    let is_spot = are_spots(scene);
    for instance in selected_mut(scene, chosen) {
        let has_shadow = opacity > 0.0 && !is_spot[instance.element.index()];
        let blur = if blur == 0.0 { 0.0 } else { in_own_pixels(blur, size(instance)).min(Shadow::WIDEST) };
        instance.shadow = has_shadow.then_some(Shadow { offset, opacity, blur });
    }
}

pub(super) fn outline(scene: &mut Scene, chosen: &Chosen, width: f64, colour: Colour) {
    let is_spot = are_spots(scene);
    for instance in selected_mut(scene, chosen) {
        let has_line = width > 0.0 && !is_spot[instance.element.index()];
        let own = in_own_pixels(width, size(instance)).min(Stroke::WIDEST);
        instance.stroke = has_line.then_some(Stroke { width: own, colour });
    }
}

/// Keeps the widths of shadow and line on the canvas after the size of the instance changed; `before` is its
/// former size.
pub(super) fn keep_widths(instance: &mut Instance, before: f64) {
    let now = size(instance);
    if let Some(stroke) = &mut instance.stroke {
        stroke.width = in_own_pixels(stroke.width * before, now).min(Stroke::WIDEST);
    }
    if let Some(shadow) = instance.shadow.as_mut().filter(|shadow| shadow.blur > 0.0) {
        shadow.blur = in_own_pixels(shadow.blur * before, now).min(Shadow::WIDEST);
    }
}

pub(super) fn flatten(scene: &mut Scene, chosen: &Chosen) {
    change(scene, chosen, |element, _| match element.spot(None) {
        Some(_) => element.clone(),
        None => Element {
            silhouette: None,
            shapes: vec![Shape::new(element.outline().clone(), mean(element))],
            ..*element
        },
    });
}

/// Simplifies outlines within `tolerance` pixels of the canvas, and drops details smaller than a square of
/// that side.
pub(super) fn simplify(scene: &mut Scene, chosen: &Chosen, tolerance: f64) {
    change(scene, chosen, |element, size| {
        let tolerance = tolerance / size.max(1e-6);
        let large = |s: &&Shape| s.outline.area() >= tolerance * tolerance;
        let shapes = std::iter::once(element.base()).chain(element.details().iter().filter(large));
        Element {
            silhouette: element.silhouette.as_ref().map(|outline| outline.refitted(tolerance, DECIMALS)),
            shapes: shapes.map(|s| s.with_outline(s.outline.refitted(tolerance, DECIMALS))).collect(),
            ..*element
        }
    });
}
