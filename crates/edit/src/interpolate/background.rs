//! Interpolation of background fields: the control points of both, each between the two fields'
//! colours at its position.
//!
//! At either end all points lie on the field of that scene, so the field changes continuously. Where
//! points of both fields are close together, their colours agree.

use super::progression::Progression;
use vtex_base::geometry::{Affine, BezPath, Outline, Point, Rect, Vec2};
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{ControlPoint, Element, Field, Scene, Tile};

/// Two background fields that change into one another.
pub(super) struct BlendedField {
    spacing: f64,
    fallback: [Colour; 2],
    /// Control points with the colours of both fields.
    points: Vec<(Point, [Colour; 2])>,
}

impl BlendedField {
    /// The tween between two fields on the canvas of a scene.
    pub(super) fn new(scene: &Scene, own: [&Field; 2]) -> Self {
        let Scene { width, height, tile, .. } = *scene;
        let fields = own.map(|field| Interpolant::new(field, width, height, tile));
        let within =
            |v: f64, size: u32, repeats: bool| if repeats { v } else { v.clamp(0.0, f64::from(size)) };
        let listed: Vec<(usize, ControlPoint)> =
            [0, 1].into_iter().flat_map(|side| own[side].points.iter().map(move |p| (side, *p))).collect();
        let fallback = own.map(|field| field.fallback);
        let mut points = parallel::map(&listed, |(side, p)| {
            // Beyond the canvas a field may diverge.
            let other = fields[1 - side].at(within(p.x, width, tile.x), within(p.y, height, tile.y));
            let mut colours = [p.colour; 2];
            colours[1 - side] = Colour::from_f64(other);
            (Point::new(p.x, p.y), colours)
        });
        let spacing = own[0].spacing.min(own[1].spacing);
        if points.is_empty() && fallback[0] != fallback[1] {
            // Two fields without control points: a grid of points mixes them evenly.
            let at = |k: u32, size: u32| f64::from(k) * f64::from(size) / 10.0;
            let all = (0..=10).flat_map(|y| (0..=10).map(move |x| (x, y)));
            points.extend(all.map(|(x, y)| (Point::new(at(x, width), at(y, height)), fallback)));
        }
        Self { spacing, fallback, points }
    }

    /// The field at a time.
    pub(super) fn at(&self, when: &Progression) -> Field {
        let point = |(p, [from, to]): &(Point, [Colour; 2])| ControlPoint {
            x: p.x,
            y: p.y,
            colour: from.mixed(*to, when.at(*p)),
        };
        Field {
            spacing: self.spacing,
            fallback: self.fallback[0].mixed(self.fallback[1], 0.5),
            points: parallel::map(&self.points, point),
        }
    }
}

/// The scene with periodicity only along the axes of `kept`. Instances and control points that repeat
/// along the other axes are listed once for each copy that reaches the canvas, under the same id.
pub(super) fn untiled(scene: &Scene, kept: Tile) -> Scene {
    let mut out = scene.clone();
    out.tile = kept;
    // A scene periodic along the lost axes alone finds the copies to be listed.
    let lost = Scene { tile: Tile { x: scene.tile.x && !kept.x, y: scene.tile.y && !kept.y }, ..out.clone() };
    let bounds: Vec<_> = scene.elements.iter().map(Element::bounds).collect();
    let repeated = |outline: &Outline| {
        let mut path = BezPath::new();
        for shift in lost.copies(outline.bounds()) {
            path.extend((Affine::translate(shift) * outline.path()).iter());
        }
        Outline::new(&path).unwrap_or_else(|| outline.clone())
    };
    for layer in &mut out.layers {
        let listed = std::mem::take(&mut layer.instances);
        for instance in listed {
            let affine = instance.affine();
            for shift in lost.copies(instance.reach(bounds[instance.element.index()])) {
                let mut copy = instance.clone();
                if shift != Vec2::ZERO {
                    copy.transform = (Affine::translate(shift) * affine).as_coeffs();
                }
                layer.instances.push(copy);
            }
        }
        layer.region = layer.region.as_ref().map(repeated);
        let Some(field) = &mut layer.field else { continue };
        let around = 3.0 * field.spacing;
        let listed = std::mem::take(&mut field.points);
        for p in listed {
            let reach = Rect::new(p.x - around, p.y - around, p.x + around, p.y + around);
            for shift in lost.copies(reach) {
                field.points.push(ControlPoint { x: p.x + shift.x, y: p.y + shift.y, ..p });
            }
        }
    }
    if let Some(domain) = &mut out.domain {
        domain.outline = repeated(&domain.outline);
    }
    out
}
