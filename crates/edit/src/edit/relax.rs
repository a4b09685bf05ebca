//! Elements moved apart, so that the distances between them become even.

use super::place::put;
use super::selection::{Chosen, ChosenPlaces};
use vtex_base::geometry::{Affine, NearPoints, Point, Vec2, shortest_offset, wrapped};
use vtex_base::parallel;
use vtex_scene::scene::Scene;

/// Distance between neighbours in a hexagonal lattice, relative to the square root of the area per point.
const LATTICE: f64 = 1.074_569_93;

/// Largest number of neighbours that push one element. Only elements that lie on many others have more.
const MOST_NEIGHBOURS: u32 = 64;

/// How elements are moved.
pub(super) struct Relaxing<'a> {
    pub(super) rounds: u32,
    /// Share of the missing distance that is moved in each round.
    pub(super) strength: f64,
    /// Least distance of elements; by default that of a hexagonal lattice of equally many elements.
    pub(super) minimum: Option<f64>,
    /// The places that elements are moved within, if not the whole canvas.
    pub(super) places: Option<ChosenPlaces<'a>>,
}

/// Moves the selected elements of each layer away from neighbours nearer than the least distance: in each
/// round by half of the mean missing distance, all at the same time. Elements that are not selected do not
/// move, but push others. Elements whose centres lie on the canvas stay on it, and those of `places` stay
/// there; the lattice is then that of the elements in these places.
pub(super) fn relax(scene: &mut Scene, chosen: &Chosen, how: &Relaxing<'_>) {
    let (periods, size) = (scene.periods(), [f64::from(scene.width), f64::from(scene.height)]);
    let places = how.places.as_ref();
    let plane = RelaxedCanvas { periods, size, places };
    let area = size[0] * size[1] * places.map_or(1.0, |places| places.share(size));
    for k in 0..scene.layers.len() {
        let moves = &chosen.layers[k].instances;
        let before: Vec<Point> = scene.layers[k].instances.iter().map(|i| scene.place(i)).collect();
        if before.is_empty() || !moves.contains(&true) {
            continue;
        }
        let count = before.iter().filter(|p| places.is_none_or(|places| places.hold(**p))).count();
        let lattice = LATTICE * libm::sqrt(area / count.max(1) as f64);
        // No arrangement of equally many points has twice the distance of a lattice.
        let distance = how.minimum.map_or(lattice, |least| least.min(2.0 * lattice));
        if distance <= 0.0 {
            continue;
        }
        let mut at = before.clone();
        for _ in 0..how.rounds {
            if !plane.spread(&mut at, moves, distance, how.strength) {
                break;
            }
        }
        for ((instance, from), to) in scene.layers[k].instances.iter_mut().zip(before).zip(at) {
            let way = to - from;
            if way != Vec2::ZERO {
                put(instance, Affine::IDENTITY, [way.x, way.y], periods);
            }
        }
    }
}

/// The canvas on which elements are moved.
struct RelaxedCanvas<'a> {
    periods: [Option<f64>; 2],
    size: [f64; 2],
    /// The places that elements do not leave.
    places: Option<&'a ChosenPlaces<'a>>,
}

impl RelaxedCanvas<'_> {
    /// One round. Returns whether any point has moved.
    fn spread(&self, at: &mut [Point], moves: &[bool], distance: f64, strength: f64) -> bool {
        // Points far beyond the canvas must not make the cells of the index large.
        let within: Vec<Point> = at.iter().map(|&p| self.clamped(p)).collect();
        let near = NearPoints::new(&within, self.periods, distance);
        let all: Vec<usize> = (0..at.len()).collect();
        let way = |&i: &usize| match moves[i] {
            true => self.displacement(at, &near, i, moves, distance) * strength,
            false => Vec2::ZERO,
        };
        let ways = parallel::map(&all, way);
        let mut moved = false;
        for (point, way) in at.iter_mut().zip(ways) {
            moved |= way.hypot2() > 1e-6;
            *point = self.kept(*point, *point + way);
        }
        moved
    }

    /// The displacement of one point in a round.
    fn displacement(&self, at: &[Point], near: &NearPoints, i: usize, moves: &[bool], distance: f64) -> Vec2 {
        let (mut sum, mut count) = (Vec2::ZERO, 0);
        near.each(self.clamped(at[i]), |j| {
            if count >= MOST_NEIGHBOURS {
                return;
            }
            let apart = shortest_offset(at[j], at[i], self.periods);
            let square = apart.hypot2();
            if j == i || square >= distance * distance {
                return;
            }
            let length = libm::sqrt(square);
            // Points at the same place are separated in a direction that depends on their indices.
            let (sine, cosine) = libm::sincos(i as f64 * 2.399_963);
            let unit = if length > 1e-6 { apart / length } else { Vec2::new(cosine, sine) };
            // If the neighbour does not move, the point moves by the whole missing distance.
            let share = if moves[j] { 0.5 } else { 1.0 };
            sum += unit * (distance - length) * share;
            count += 1;
        });
        // Pushes of several neighbours are averaged; the sum is divided by two at least.
        if count == 0 { Vec2::ZERO } else { sum / f64::from(count).max(2.0) * 2.0 }
    }

    /// The nearest point of the canvas where it does not repeat.
    fn clamped(&self, p: Point) -> Point {
        let along = |v: f64, k: usize| if self.periods[k].is_none() { v.clamp(0.0, self.size[k]) } else { v };
        Point::new(along(p.x, 0), along(p.y, 1))
    }

    /// A point moved onto the canvas along axes that do not repeat, and along the border of the places where
    /// it would leave them.
    fn kept(&self, from: Point, to: Point) -> Point {
        let along = |from: f64, to: f64, k: usize| match self.periods[k] {
            None if (0.0..=self.size[k]).contains(&from) => to.clamp(0.0, self.size[k]),
            _ => to,
        };
        let to = Point::new(along(from.x, to.x, 0), along(from.y, to.y, 1));
        let Some(places) = self.places else { return to };
        let ways = [to, Point::new(to.x, from.y), Point::new(from.x, to.y)];
        let on_canvas = |p: &Point| Point::new(wrapped(p.x, self.periods[0]), wrapped(p.y, self.periods[1]));
        ways.into_iter().find(|p| places.hold(on_canvas(p))).unwrap_or(from)
    }
}
