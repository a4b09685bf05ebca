//! Elements of a drawing move at random, then apart until they are spread as evenly as in the drawing, and exchange
//! places. No two come nearer to each other than elements of the exemplar.

use super::canvas::OccupiedCanvas;
use super::spread::Spread;
use crate::arrange::motifs::DrawnElement;
use std::f64::consts::SQRT_2;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, NearPoints, Point, Vec2, shortest_offset};
use vtex_base::sampling::{Stream, stream};

/// Candidate partners tried for an exchange: first at places without a similar neighbour, then at places
/// without an equal one.
const PARTNERS: [usize; 2] = [16, 8];
/// Largest ratio of the sizes of elements that change places.
const RATIO: f64 = 1.4;
/// Least distance of similar elements, as a multiple of the mean distance between elements. It is not kept if
/// no candidate partner fits.
const COPIES: f64 = 1.4;
/// Rounds of random walks.
const WALKS: usize = 6;
/// Places tried for an element in each.
const STEPS: usize = 3;
/// Lengths of a step of a walk, in units of [`FARTHEST`].
const STRIDES: [f64; 3] = [1.0, 2.0, 4.0];
/// Most rounds in which elements move apart.
const ROUNDS: usize = 8;
/// Places tried for an element in each.
const SHIFTS: usize = 8;
/// Largest single shift, as a share of the mean distance between elements.
const FARTHEST: f64 = 0.22;
/// Clearances that are distinguished, in units of that of the exemplar.
const CLEARANCES: [f64; 6] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0];

/// The places that elements exchange.
struct ExchangePlaces {
    near: NearPoints,
    places: Vec<Point>,
    /// The element at each place.
    occupants: Vec<usize>,
    /// Least distance of similar elements, in pixels.
    reach: f64,
}

impl ExchangePlaces {
    /// Whether an occupant that satisfies `predicate` is within reach of a site; the sites `except` are left out.
    fn any_near(
        &self,
        site: usize,
        except: [usize; 2],
        periods: [Option<f64>; 2],
        predicate: impl Fn(usize) -> bool,
    ) -> bool {
        let mut any = false;
        self.near.each(self.places[site], |k| {
            any = any
                || !except.contains(&k)
                    && predicate(self.occupants[k])
                    && shortest_offset(self.places[site], self.places[k], periods).hypot() < self.reach;
        });
        any
    }
}

impl OccupiedCanvas<'_> {
    /// Exchanges and shifts elements; a share `share` of the free ones takes part. Calls `go_on`
    /// before each.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn vary(
        &mut self,
        placed: &mut [DrawnElement],
        share: f64,
        seed: u64,
        go_on: impl Fn() -> Result<()>,
    ) -> Result<()> {
        let mut random = stream(seed, "synth/period", 0);
        let mut moving: Vec<usize> =
            (0..placed.len()).filter(|&i| self.relations.free[placed[i].element]).collect();
        moving.retain(|_| random.unit() < share);
        random.shuffle(&mut moving);
        // Elements at the border of the canvas move only once, at the end, because their visible part changes.
        let (inner, border): (Vec<usize>, Vec<usize>) =
            moving.iter().partition(|&&i| self.zone(&placed[i]) == 0);
        let drawn = self.spread(placed).loads(&inner, &go_on)?;
        for _ in 0..WALKS {
            for &i in &inner {
                go_on()?;
                self.walk(placed, i, share, &mut random);
            }
        }
        let mut spread = self.spread(placed);
        for _ in 0..ROUNDS {
            if spread.loads(&inner, &go_on)? <= drawn {
                break;
            }
            for &i in &inner {
                go_on()?;
                self.move_apart(placed, &mut spread, i, share, &mut random);
            }
            spread = spread.settled();
        }
        let mut sites = self.sites(placed, &moving);
        for n in 0..moving.len() {
            go_on()?;
            self.exchange(placed, &mut sites, n, &mut random);
        }
        let mut spread = self.spread(placed);
        for &i in &border {
            go_on()?;
            self.move_apart(placed, &mut spread, i, share, &mut random);
        }
        Ok(())
    }

    /// The places of all elements.
    fn spread(&self, placed: &[DrawnElement]) -> Spread {
        let places = placed.iter().map(|p| self.centre(p)).collect();
        let spacing = self.relations.spacing;
        Spread::new(places, self.periods(), spacing, SQRT_2 * FARTHEST * spacing)
    }

    /// The places of the elements `moving`, each occupied by its own element.
    fn sites(&self, placed: &[DrawnElement], moving: &[usize]) -> ExchangePlaces {
        let places: Vec<Point> = moving.iter().map(|&i| self.centre(&placed[i])).collect();
        let reach = COPIES * self.relations.spacing;
        let near = NearPoints::new(&places, self.periods(), reach);
        ExchangePlaces { near, places, occupants: moving.to_vec(), reach }
    }

    /// Exchanges the element of a site with another of similar size.
    fn exchange(
        &mut self,
        placed: &mut [DrawnElement],
        sites: &mut ExchangePlaces,
        n: usize,
        random: &mut Stream,
    ) {
        let relations = self.relations;
        let extent = |p: &DrawnElement| {
            let b = relations.bounds[p.element];
            libm::hypot(b.width(), b.height())
        };
        let a = sites.occupants[n];
        let own = extent(&placed[a]);
        for attempt in 0..PARTNERS[0] + PARTNERS[1] {
            let m = random.index(sites.occupants.len());
            let b = sites.occupants[m];
            let other = extent(&placed[b]);
            let kinds = if attempt < PARTNERS[0] { &relations.first_like } else { &relations.first_upright };
            let [kind_a, kind_b] = [a, b].map(|i| kinds[placed[i].element]);
            let zones = [a, b].map(|i| self.zone(&placed[i]));
            let fit = zones[0] == zones[1] && own.max(other) <= RATIO * own.min(other);
            if kind_a == kind_b || !fit || self.crosses_bands(&placed[a], &placed[b]) {
                continue;
            }
            let is_near = |site: usize, kind: usize| {
                let periods = self.periods();
                sites.any_near(site, [n, m], periods, |i| kinds[placed[i].element] == kind)
            };
            if !is_near(m, kind_a) && !is_near(n, kind_b) && self.try_swap(placed, [a, b]) {
                sites.occupants.swap(n, m);
                return;
            }
        }
    }

    /// Whether the way between two elements leads across bands.
    fn crosses_bands(&self, a: &DrawnElement, b: &DrawnElement) -> bool {
        let way = shortest_offset(self.centre(a), self.centre(b), self.periods());
        let far = [way.x, way.y].map(|d| d.abs() > FARTHEST * self.relations.spacing);
        (0..2).any(|k| far[k] && !self.relations.moves_along[k])
    }

    /// Exchanges two elements if both fit; whether they did.
    fn try_swap(&mut self, placed: &mut [DrawnElement], [a, b]: [usize; 2]) -> bool {
        let (old_a, old_b) = (placed[a], placed[b]);
        self.set_taken(&old_a, false);
        self.set_taken(&old_b, false);
        let new_a = self.moved_to(&old_a, self.centre(&old_b));
        if self.fits(&new_a, 1.0) {
            self.set_taken(&new_a, true);
            let new_b = self.moved_to(&old_b, self.centre(&old_a));
            if self.fits(&new_b, 1.0) {
                self.set_taken(&new_b, true);
                (placed[a], placed[b]) = (new_a, new_b);
                return true;
            }
            self.set_taken(&new_a, false);
        }
        self.set_taken(&old_a, true);
        self.set_taken(&old_b, true);
        false
    }

    /// Moves an element within the canvas by a step of a random walk. Large elements find no partner to exchange
    /// places with, and leave the place of the period in this way.
    fn walk(&mut self, placed: &mut [DrawnElement], i: usize, share: f64, random: &mut Stream) {
        let old = placed[i];
        self.set_taken(&old, false);
        let centre = self.centre(&old);
        // Elements as far apart as in the drawing neither crowd nor leave gaps.
        let clearance = CLEARANCES[self.clearances(&old).saturating_sub(2)];
        for _ in 0..STEPS {
            let stride = STRIDES[random.index(STRIDES.len())];
            let by = self.step(stride * share, random);
            let new = self.moved_to(&old, centre + by);
            if self.zone(&new) == 0 && self.fits(&new, clearance) {
                placed[i] = new;
                break;
            }
        }
        self.set_taken(&placed[i], true);
    }

    /// Moves an element to a nearby place on which the others weigh less and which is no nearer to one of them, if such a
    /// place is found.
    fn move_apart(
        &mut self,
        placed: &mut [DrawnElement],
        spread: &mut Spread,
        i: usize,
        share: f64,
        random: &mut Stream,
    ) {
        let old = placed[i];
        self.set_taken(&old, false);
        let (centre, zone) = (self.centre(&old), self.zone(&old));
        let mut least = spread.load(i, centre);
        let clearance = CLEARANCES[self.clearances(&old).saturating_sub(1)];
        for _ in 0..SHIFTS {
            let place = centre + self.step(share, random);
            let load = spread.load(i, place);
            if load >= least {
                continue;
            }
            let new = self.moved_to(&old, place);
            if self.zone(&new) == zone && self.fits(&new, clearance) {
                placed[i] = new;
                least = load;
            }
        }
        self.set_taken(&placed[i], true);
        spread.set(i, self.centre(&placed[i]));
    }

    /// Number of clearances that an element has at its place.
    fn clearances(&mut self, p: &DrawnElement) -> usize {
        CLEARANCES.iter().take_while(|c| self.fits(p, **c)).count()
    }

    /// A random shift, at most `length` of the farthest, along the axes on which elements may move.
    fn step(&self, length: f64, random: &mut Stream) -> Vec2 {
        let reach = length * FARTHEST * self.relations.spacing;
        let along = |moves: bool| random.range(-reach, reach) * f64::from(u8::from(moves));
        let [x, y] = self.relations.moves_along.map(along);
        Vec2::new(x, y)
    }

    /// A copy with its centre at a place, which is wrapped along axes that repeat. It keeps its angle: angles are as often
    /// as in the drawing, and those that fit easily are not preferred.
    fn moved_to(&self, p: &DrawnElement, mut place: Point) -> DrawnElement {
        if self.taken.wraps[0] {
            place.x -= f64::from(self.canvas[0]) * libm::floor(place.x / f64::from(self.canvas[0]));
        }
        if self.taken.wraps[1] {
            place.y -= f64::from(self.canvas[1]) * libm::floor(place.y / f64::from(self.canvas[1]));
        }
        let centre = self.relations.bounds[p.element].center();
        let [a, b, c, d, ..] = self.library.layers[p.order.layer].instances[p.order.instance].transform;
        let linear = Affine::new([a, b, c, d, 0.0, 0.0]);
        let shift = place - linear * centre;
        // `fits` tests whole pixels.
        let map = Affine::translate(Vec2::new(libm::round(shift.x), libm::round(shift.y))) * linear;
        DrawnElement { map, ..*p }
    }
}
