//! Elements of a drawing exchange places, move at random and settle. None comes nearer to another than in the
//! exemplar.

use super::PeriodCopy;
use super::canvas::OccupiedCanvas;
use std::f64::consts::TAU;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, NearPoints, Point, Vec2, rotation, shortest_offset};
use vtex_base::sampling::{Stream, stream};

/// Candidate partners tried for an exchange: first at places without a similar neighbour, then at places
/// without an equal one.
const PARTNERS: [usize; 2] = [16, 8];
/// Largest ratio of the sizes of elements that change places.
const RATIO: f64 = 1.4;
/// Least distance of similar elements, in mean distances between elements, as long as there are partners.
const COPIES: f64 = 1.4;
/// Rounds in which elements wander before they settle, and places tried in each.
const WALKS: usize = 6;
const STEPS: usize = 3;
/// Lengths of a single step, in units of [`FARTHEST`].
const STRIDES: [f64; 3] = [1.0, 2.0, 4.0];
/// Rounds in which elements settle, and places tried in each.
const SETTLES: usize = 4;
const SHIFTS: usize = 8;
/// Largest shift at once, as a share of the mean distance between elements.
const FARTHEST: f64 = 0.22;
/// Clearances that settling elements may have, in units of that of the exemplar.
const CLEARANCES: [f64; 6] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0];
/// Angles of elements that may be turned at will.
const TURNS: usize = 24;
/// Largest gap between the angles of such elements, in radians.
const LARGEST_GAP: f64 = 1.75;

/// The places that elements exchange.
struct ExchangePlaces {
    near: NearPoints,
    places: Vec<Point>,
    /// The element at each place.
    occupants: Vec<usize>,
    reach: f64,
}

impl ExchangePlaces {
    /// Whether an occupant that satisfies `holds` is within reach of a site, not counting the sites `but`.
    fn any_near(
        &self,
        site: usize,
        but: [usize; 2],
        periods: [Option<f64>; 2],
        holds: impl Fn(usize) -> bool,
    ) -> bool {
        let mut any = false;
        self.near.each(self.places[site], |k| {
            any = any
                || !but.contains(&k)
                    && holds(self.occupants[k])
                    && shortest_offset(self.places[site], self.places[k], periods).hypot() < self.reach;
        });
        any
    }
}

impl OccupiedCanvas<'_> {
    /// Exchanges, shifts and turns elements; a share `share` of the free ones takes part. Calls `go_on`
    /// before each.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn vary(
        &mut self,
        placed: &mut [PeriodCopy],
        share: f64,
        seed: u64,
        go_on: impl Fn() -> Result<()>,
    ) -> Result<()> {
        let mut random = stream(seed, "synth/period", 0);
        let mut all: Vec<usize> = (0..placed.len()).filter(|&i| self.known.free[placed[i].element]).collect();
        all.retain(|_| random.unit() < share);
        random.shuffle(&mut all);
        for _ in 0..WALKS {
            for &i in &all {
                go_on()?;
                self.walk(placed, i, share, &mut random);
            }
        }
        for _ in 0..SETTLES {
            for &i in &all {
                go_on()?;
                // Elements at the border of the canvas settle once, at the end, because their visible part
                // changes.
                if self.zone(&placed[i]) == 0 {
                    self.settle(placed, i, share, &mut random);
                }
            }
        }
        let mut sites = self.sites(placed, &all);
        for n in 0..all.len() {
            go_on()?;
            self.exchange(placed, &mut sites, n, &mut random);
        }
        for &i in &all {
            go_on()?;
            self.settle(placed, i, share, &mut random);
        }
        Ok(())
    }

    /// The places of the elements `all`, each with its own element.
    fn sites(&self, placed: &[PeriodCopy], all: &[usize]) -> ExchangePlaces {
        let places: Vec<Point> = all.iter().map(|&i| self.middle(&placed[i])).collect();
        let reach = COPIES * self.known.spacing;
        let near = NearPoints::new(&places, self.periods(), reach);
        ExchangePlaces { near, places, occupants: all.to_vec(), reach }
    }

    /// Exchanges the element of a site with another of similar size.
    fn exchange(
        &mut self,
        placed: &mut [PeriodCopy],
        sites: &mut ExchangePlaces,
        n: usize,
        random: &mut Stream,
    ) {
        let known = self.known;
        let extent = |p: &PeriodCopy| {
            let b = known.bounds[p.element];
            libm::hypot(b.width(), b.height())
        };
        let a = sites.occupants[n];
        let own = extent(&placed[a]);
        for attempt in 0..PARTNERS[0] + PARTNERS[1] {
            let m = random.index(sites.occupants.len());
            let b = sites.occupants[m];
            let other = extent(&placed[b]);
            let kinds = if attempt < PARTNERS[0] { &known.alike } else { &known.same };
            let [kind_a, kind_b] = [a, b].map(|i| kinds[placed[i].element]);
            let zones = [a, b].map(|i| self.zone(&placed[i]));
            if kind_a == kind_b || zones[0] != zones[1] || own.max(other) > RATIO * own.min(other) {
                continue;
            }
            let has = |site: usize, kind: usize| {
                let periods = self.periods();
                sites.any_near(site, [n, m], periods, |i| kinds[placed[i].element] == kind)
            };
            if !has(m, kind_a) && !has(n, kind_b) && self.swapped(placed, [a, b], random) {
                sites.occupants.swap(n, m);
                return;
            }
        }
    }

    /// Exchanges two elements, if both fit.
    fn swapped(&mut self, placed: &mut [PeriodCopy], [a, b]: [usize; 2], random: &mut Stream) -> bool {
        let (old_a, old_b) = (placed[a], placed[b]);
        self.write(&old_a, 0, a as u32 + 1);
        self.write(&old_b, 0, b as u32 + 1);
        let new_a = self.at(&old_a, self.middle(&old_b), random);
        if self.fits(&new_a, 1.0) {
            self.write(&new_a, a as u32 + 1, 0);
            let new_b = self.at(&old_b, self.middle(&old_a), random);
            if self.fits(&new_b, 1.0) {
                self.write(&new_b, b as u32 + 1, 0);
                (placed[a], placed[b]) = (new_a, new_b);
                return true;
            }
            self.write(&new_a, 0, a as u32 + 1);
        }
        self.write(&old_a, a as u32 + 1, 0);
        self.write(&old_b, b as u32 + 1, 0);
        false
    }

    /// Moves an element within the canvas by a random walk, so that large elements too leave repeated places.
    /// Elements at the border do not move, because the visible share of each kind would change.
    fn walk(&mut self, placed: &mut [PeriodCopy], i: usize, share: f64, random: &mut Stream) {
        let old = placed[i];
        if self.zone(&old) != 0 {
            return;
        }
        self.write(&old, 0, i as u32 + 1);
        let middle = self.middle(&old);
        for _ in 0..STEPS {
            let stride = STRIDES[random.index(STRIDES.len())];
            let reach = stride * share * FARTHEST * self.known.spacing;
            let by = Vec2::new(random.range(-reach, reach), random.range(-reach, reach));
            let new = self.at(&old, middle + by, random);
            if self.zone(&new) == 0 && self.fits(&new, 1.0) {
                placed[i] = new;
                break;
            }
        }
        self.write(&placed[i].clone(), i as u32 + 1, 0);
    }

    /// Moves an element to a place farther from others, if there is one, and turns it if other elements of
    /// its kind are turned.
    fn settle(&mut self, placed: &mut [PeriodCopy], i: usize, share: f64, random: &mut Stream) {
        let old = placed[i];
        self.write(&old, 0, i as u32 + 1);
        let (middle, zone) = (self.middle(&old), self.zone(&old));
        let reach = share * FARTHEST * self.known.spacing;
        // Number of clearances that it keeps at its place.
        let mut has = CLEARANCES.iter().take_while(|c| self.fits(&old, **c)).count();
        for _ in 0..SHIFTS {
            let by = Vec2::new(random.range(-reach, reach), random.range(-reach, reach));
            let new = self.at(&old, middle + by, random);
            if has == CLEARANCES.len() || self.zone(&new) != zone {
                continue;
            }
            // The next clearance is the likeliest to fail, so it is tested first.
            if CLEARANCES[..=has].iter().rev().all(|c| self.fits(&new, *c)) {
                placed[i] = new;
                has += 1;
            }
        }
        self.write(&placed[i].clone(), i as u32 + 1, 0);
    }

    /// An element with its middle at a place, turned by an angle of its kind. Along axes that repeat it stays
    /// on the canvas.
    fn at(&self, p: &PeriodCopy, mut place: Point, random: &mut Stream) -> PeriodCopy {
        let class = self.known.equal[p.element];
        let angles = self.known.angles.get(&class.0).map_or(&[][..], Vec::as_slice);
        // The element's own angle in its class.
        let [a, b, ..] = class.1.as_coeffs();
        let own = libm::atan2(b, a);
        let turn = match angles.len() {
            0 | 1 => 0.0,
            _ if go_round(angles) => random.index(TURNS) as f64 / TURNS as f64 * TAU,
            // The angles are those of elements that are not mirrored.
            _ if class.1.determinant() < 0.0 => 0.0,
            count => angles[random.index(count)] - own,
        };
        if self.wrap[0] {
            place.x -= f64::from(self.canvas[0]) * libm::floor(place.x / f64::from(self.canvas[0]));
        }
        if self.wrap[1] {
            place.y -= f64::from(self.canvas[1]) * libm::floor(place.y / f64::from(self.canvas[1]));
        }
        let centre = self.known.bounds[p.element].center();
        let [a, b, c, d, ..] = self.library.layers[p.order.0].instances[p.order.1].transform;
        let given = Affine::new([a, b, c, d, 0.0, 0.0]);
        let linear = if turn.abs() < 1e-3 { given } else { rotation(turn) * given };
        let at = place - linear * centre;
        // At whole pixels, where the fit was tested.
        let map = Affine::translate(Vec2::new(libm::round(at.x), libm::round(at.y))) * linear;
        PeriodCopy { map, ..*p }
    }
}

/// Whether angles, ascending and in radians, leave no large gap on the circle, so that elements seem to have
/// any angle.
fn go_round(angles: &[f64]) -> bool {
    let (Some(first), Some(last)) = (angles.first(), angles.last()) else { return false };
    let gaps = angles.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.chain([first + TAU - last]).all(|gap| gap < LARGEST_GAP)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_angles_are_kept_to_and_many_go_round() {
        assert!(!go_round(&[]) && !go_round(&[-0.14, 0.0, 0.14]) && !go_round(&[0.0, TAU / 2.0]));
        assert!(go_round(&[-2.4, -0.8, 0.8, 2.4]));
    }
}
