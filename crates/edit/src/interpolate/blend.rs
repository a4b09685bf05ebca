//! Morphs one ring into another, point by point at even distances, with a rotation where that moves less. A
//! ring that would cross itself on the way is rounded there.

use super::ring::{Ring, alignment, count, disc, even, moments, sine_cosine, turned};
use vtex_base::geometry::{Cage, is_simple, ring_path};

/// Number of points of the cages that carry details and holes.
const CAGE: usize = 32;
/// Times at which a morph is tested for self-crossings.
const CHECKED_TIMES: [f64; 5] = [0.5, 0.3, 0.7, 0.15, 0.85];
/// Amounts of rounding that are tried in turn until a morph does not cross itself.
const ROUNDINGS: [f64; 4] = [0.0, 0.35, 0.7, 1.0];

/// Morph between two rings around the origin, point by point.
pub(super) struct Blend {
    from: Ring,
    /// The second ring, rotated back by `turn`.
    to: Ring,
    /// Angle by which the first ring turns during the morph, in radians.
    turn: f64,
    /// Weight of a disc at half-time, 0 to 1.
    round: f64,
}

impl Blend {
    /// Morph between two rings with their centroids at the origin, both clockwise on the screen. Points
    /// are matched by arc length, from the start that moves them least. The ring turns if that reduces
    /// the movement considerably. A morph that would cross itself is rounded towards a disc.
    pub(super) fn new(from: &Ring, to: &Ring) -> Self {
        let n = count(from, to);
        let (from, mut to) = (even(from, n), even(to, n));
        let (shift, turn) = alignment(&from, &to, true);
        to.rotate_left(shift);
        let back = sine_cosine(-turn);
        to.iter_mut().for_each(|p| *p = turned(*p, back));
        let mut blend = Self { from, to, turn, round: 0.0 };
        for round in ROUNDINGS {
            blend.round = round;
            if CHECKED_TIMES.iter().all(|&t| simple(&blend.at(t))) {
                break;
            }
        }
        blend
    }

    /// Angle by which the ring has turned at the end, in radians.
    pub(super) fn turn(&self) -> f64 {
        self.turn
    }

    /// The ring at time `t` (0 to 1), around the origin.
    pub(super) fn at(&self, t: f64) -> Ring {
        let turn = sine_cosine(self.turn * t);
        let pairs = self.from.iter().zip(&self.to);
        let mut ring: Ring = pairs.map(|(a, b)| turned(a.lerp(*b, t), turn)).collect();
        let round = self.round * 4.0 * t * (1.0 - t);
        if round > 0.0 {
            let disc = disc(&ring);
            ring.iter_mut().zip(disc).for_each(|(p, q)| *p = p.lerp(q, round));
        }
        ring
    }

    /// Cages that map the interiors of the first and of the second ring to that of `ring`, the result of
    /// [`Blend::at`].
    pub(super) fn cages(&self, ring: &Ring) -> [Cage; 2] {
        let every = ring.len().div_ceil(CAGE);
        let some = |ring: &Ring| -> Ring { ring.iter().step_by(every).copied().collect() };
        let turn = sine_cosine(self.turn);
        let to = self.to.iter().map(|p| turned(*p, turn)).collect();
        [&self.from, &to].map(|before| Cage::of_polygons(some(before), some(ring)))
    }

    /// Ratios of lengths on `ring` to lengths on the first and on the second ring.
    pub(super) fn scales(&self, ring: &Ring) -> [f64; 2] {
        let area = |ring: &Ring| moments(ring).0.abs().max(1e-6);
        let here = area(ring);
        [&self.from, &self.to].map(|end| libm::sqrt(here / area(end)))
    }
}

/// Whether a ring does not cross itself.
fn simple(ring: &Ring) -> bool {
    // A ring that is star-shaped about its centre, which is usual, is recognised quickly.
    let (_, centre) = moments(ring);
    let n = ring.len();
    if (0..n).all(|i| (ring[i] - centre).cross(ring[(i + 1) % n] - centre) > 0.0) {
        return true;
    }
    is_simple(&ring_path(ring))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpolate::ring::length;
    use std::f64::consts::TAU;
    use vtex_base::geometry::Point;

    fn star(arms: f64, depth: f64, stretch: f64) -> Ring {
        let ring: Ring = (0..90)
            .map(|i| {
                let angle = TAU * f64::from(i) / 90.0;
                let [s, c] = sine_cosine(angle);
                let r = 20.0 * (1.0 + depth * libm::sin(arms * angle));
                Point::new(r * c * stretch, r * s / stretch)
            })
            .collect();
        let centre = moments(&ring).1;
        ring.iter().map(|p| *p - centre.to_vec2()).collect()
    }

    #[test]
    fn it_begins_and_ends_as_what_it_blends_and_is_simple_between() {
        for (a, b) in [
            (star(3.0, 0.3, 1.0), star(5.0, 0.5, 1.3)),
            (star(2.0, 0.8, 1.0), star(7.0, 0.7, 2.0)),
            (star(1.0, 0.1, 3.0), star(1.0, 0.1, 1.0 / 3.0)),
        ] {
            let blend = Blend::new(&a, &b);
            let area = |r: &Ring| moments(r).0;
            assert!((area(&blend.at(0.0)) / area(&a) - 1.0).abs() < 0.03);
            assert!((area(&blend.at(1.0)) / area(&b) - 1.0).abs() < 0.03);
            let (end, fine) = (blend.at(1.0), even(&b, 2000));
            let far = |p: &Point| fine.iter().map(|q| length(*p - *q)).fold(f64::INFINITY, f64::min);
            assert!(end.iter().map(far).fold(0.0, f64::max) < 1.5);
            for k in 0..=20 {
                let ring = blend.at(f64::from(k) / 20.0);
                assert!(simple(&ring), "{k}");
                assert!(area(&ring) > 0.6 * area(&a).min(area(&b)), "{k}: {}", area(&ring));
            }
        }
    }

    #[test]
    fn long_things_turn_and_keep_their_length() {
        let (a, b) = (star(1.0, 0.0, 2.5), star(1.0, 0.0, 0.4));
        let half = Blend::new(&a, &b).at(0.5);
        let longest = half.iter().map(|p| length(p.to_vec2())).fold(0.0, f64::max);
        assert!(longest > 45.0, "{longest}");
    }

    #[test]
    fn cages_carry_the_inside_along() {
        let (a, b) = (star(3.0, 0.2, 1.0), star(4.0, 0.2, 1.5));
        let blend = Blend::new(&a, &b);
        let [from, to] = blend.cages(&blend.at(0.0));
        let p = Point::new(3.0, -5.0);
        assert!(length(from.map(p) - p) < 1e-6);
        assert!(vtex_base::geometry::inside(&a, to.map(p)));
    }
}
