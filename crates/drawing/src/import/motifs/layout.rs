//! The places of parts within a motif, and whether two motifs are copies of each other.

use super::features::MotifElement;
use super::tree::MotifPlane;
use crate::import::offsets::Shift;
use std::f64::consts::PI;
use vtex_base::geometry::{Affine, Point, Vec2, rigid_map, rotation};

/// Largest difference of the directions of corresponding parts, in radians.
const DIRECTION: f64 = 0.35;

/// A part at its place.
#[derive(Clone, Copy)]
pub(super) struct LaidPart {
    pub(super) element: usize,
    pub(super) shift: Shift,
    pub(super) label: usize,
    pub(super) at: Point,
    pub(super) axis: Option<f64>,
}

/// The parts of a set of elements.
#[derive(Clone)]
pub(super) struct MotifLayout {
    pub(super) parts: Vec<LaidPart>,
    /// Largest distance of a part's rim from the mean of their centres, in pixels.
    pub(super) extent: f64,
}

/// A layout as a copy of another.
pub(super) struct LayoutMatch {
    /// For each part of the other its own, as an index of parts.
    pub(super) order: Vec<usize>,
    /// Largest distance of a part from its place, in pixels.
    pub(super) residual: f64,
}

impl MotifLayout {
    pub(super) fn new(members: &[(usize, Shift)], elements: &[MotifElement], plane: MotifPlane) -> Self {
        let part = |&(element, shift): &(usize, Shift)| {
            let own = &elements[element];
            LaidPart {
                element,
                shift,
                label: own.label,
                at: own.centre + plane.vector(shift),
                axis: own.axis,
            }
        };
        let parts: Vec<LaidPart> = members.iter().map(part).collect();
        let count = parts.len().max(1) as f64;
        let middle = parts.iter().fold(Vec2::ZERO, |sum, p| sum + p.at.to_vec2()) / count;
        let rim = |p: &LaidPart| p.at.distance(middle.to_point()) + elements[p.element].radius();
        let extent = parts.iter().map(rim).fold(0.0, f64::max);
        Self { parts, extent }
    }

    /// The sorted labels of the parts.
    pub(super) fn composition(&self) -> Vec<usize> {
        let mut labels: Vec<usize> = self.parts.iter().map(|p| p.label).collect();
        labels.sort_unstable();
        labels
    }

    /// This layout as a copy of `other`, turned or mirrored, with no part further than `tolerance` from its
    /// place. The compositions must be equal.
    pub(super) fn as_copy_of(&self, other: &Self, tolerance: f64) -> Option<LayoutMatch> {
        let middle = |layout: &Self| -> Vec2 {
            let sum = layout.parts.iter().fold(Vec2::ZERO, |sum, p| sum + p.at.to_vec2());
            sum / layout.parts.len().max(1) as f64
        };
        let (own, from) = (middle(self), middle(other));
        // The part furthest from the middle fixes the angle; every own part of its label is tried.
        let far = |p: &LaidPart| (p.at.to_vec2() - from).hypot();
        let anchor = other.parts.iter().max_by(|p, q| far(p).total_cmp(&far(q)))?;
        let reach = far(anchor);
        let mut best: Option<LayoutMatch> = None;
        for candidate in self.parts.iter().filter(|p| p.label == anchor.label) {
            if ((candidate.at.to_vec2() - own).hypot() - reach).abs() > tolerance {
                continue;
            }
            for mirrored in [false, true] {
                let map = if reach > tolerance {
                    let pair = [from.to_point(), anchor.at];
                    rigid_map(&pair, &[own.to_point(), candidate.at], mirrored)
                } else {
                    // Concentric parts tell the angle by their directions.
                    let flip = if mirrored { Affine::FLIP_Y } else { Affine::IDENTITY };
                    let turn = match (anchor.axis, candidate.axis) {
                        (Some(a), Some(b)) => b - turned(a, flip),
                        _ => 0.0,
                    };
                    Affine::translate(own) * rotation(turn) * flip * Affine::translate(-from)
                };
                let Some(order) = self.order(other, map, 2.0 * tolerance) else { continue };
                let p: Vec<Point> = other.parts.iter().map(|p| p.at).collect();
                let q: Vec<Point> = order.iter().map(|&k| self.parts[k].at).collect();
                let map = if reach > tolerance { rigid_map(&p, &q, mirrored) } else { map };
                if !self.directions_agree(other, &order, map) {
                    continue;
                }
                let residual = p.iter().zip(&q).map(|(p, q)| (map * *p).distance(*q)).fold(0.0, f64::max);
                if residual <= tolerance && best.as_ref().is_none_or(|b| residual < b.residual - 1e-6) {
                    best = Some(LayoutMatch { order, residual });
                }
            }
        }
        best
    }

    /// The own part nearest to each mapped part of `other`, each once.
    fn order(&self, other: &Self, map: Affine, tolerance: f64) -> Option<Vec<usize>> {
        let mut taken = vec![false; self.parts.len()];
        let mut order = Vec::with_capacity(other.parts.len());
        for part in &other.parts {
            let at = map * part.at;
            let fits = |k: &usize| !taken[*k] && self.parts[*k].label == part.label;
            let distance = |k: usize| self.parts[k].at.distance(at);
            let near =
                (0..self.parts.len()).filter(fits).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
            let near = near.filter(|k| distance(*k) <= tolerance)?;
            taken[near] = true;
            order.push(near);
        }
        Some(order)
    }

    fn directions_agree(&self, other: &Self, order: &[usize], map: Affine) -> bool {
        other.parts.iter().zip(order).all(|(part, &k)| match (part.axis, self.parts[k].axis) {
            (Some(a), Some(b)) => angle_between(turned(a, map), b) <= DIRECTION,
            _ => true,
        })
    }

    /// Whether the layout itself has order: parts of one label that are parallel, mirrored, or at equal
    /// distances around a middle.
    pub(super) fn is_orderly(&self) -> bool {
        let first = self.parts[0];
        if self.parts.iter().any(|p| p.label != first.label) {
            return self.is_ring_with_middle();
        }
        match &self.parts[..] {
            [a, b] => match (a.axis, b.axis) {
                (Some(p), Some(q)) => {
                    let along = libm::atan2(b.at.y - a.at.y, b.at.x - a.at.x);
                    // The mirror image of one direction in the line between the two, or across it.
                    angle_between(p, q) <= DIRECTION / 2.0
                        || angle_between(2.0 * along - p, q) <= DIRECTION / 2.0
                }
                _ => true,
            },
            parts => {
                let axes: Option<Vec<f64>> = parts.iter().map(|p| p.axis).collect();
                let parallel = axes
                    .is_some_and(|axes| axes.iter().all(|a| angle_between(*a, axes[0]) <= DIRECTION / 2.0));
                parallel || is_ring(parts.iter().map(|p| p.at))
            }
        }
    }

    /// Whether all parts but one are a ring around that one.
    fn is_ring_with_middle(&self) -> bool {
        (0..self.parts.len()).any(|k| {
            let others = || self.parts.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, p)| p);
            let mut labels = others().map(|p| p.label);
            let first = labels.next();
            self.parts.len() >= 4
                && labels.all(|label| Some(label) == first)
                && is_ring(others().map(|p| p.at))
        })
    }
}

/// Whether points lie at about equal distances from their mean.
fn is_ring(points: impl Iterator<Item = Point>) -> bool {
    let points: Vec<Point> = points.collect();
    if points.len() < 3 {
        return false;
    }
    let middle = points.iter().fold(Vec2::ZERO, |sum, p| sum + p.to_vec2()) / points.len() as f64;
    let radii: Vec<f64> = points.iter().map(|p| p.distance(middle.to_point())).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    radii.iter().all(|r| (r - mean).abs() <= 0.15 * mean)
}

/// A direction after a map.
fn turned(axis: f64, map: Affine) -> f64 {
    let [a, b, c, d, ..] = map.as_coeffs();
    let (s, t) = libm::sincos(axis);
    libm::atan2(b * t + d * s, a * t + c * s)
}

/// Angle between two directions without a sense, in radians, at most π/2.
fn angle_between(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(PI);
    apart.min(PI - apart)
}
