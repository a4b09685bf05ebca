//! The paths of elements through a loop.

use super::{Flow, FlowParams, Now};
use std::f64::consts::TAU;
use vtex_base::geometry::{Point, Vec2};
use vtex_base::raster::ControlMap;
use vtex_base::sampling::stream;

/// Number of random values of a shear's wobble in a loop.
const KNOTS: usize = 10;
/// Standard deviation of the wobble, as a share of the canvas's width (the paper's 1/30 of half of it).
const WOBBLE: f64 = 1.0 / 60.0;
/// Largest displacement by wind, as a share of the shorter side, and the largest turn, in radians.
const GUST: f64 = 0.012;
const BEND: f64 = 0.22;
/// Wavelength of wind, as a share of the width, before it is rounded to fit a whole number of times.
const WAVE: f64 = 0.5;
/// Length of a path along a field, as a share of the shorter side.
const DRIFT: f64 = 0.18;
/// Share of a loop in which an element along a field appears, and in which it vanishes.
const FADE: f64 = 0.15;
/// Steps of a path along a field.
const STEPS: usize = 48;

/// Distance beyond the borders from which elements enter the canvas, along x and y.
pub(super) fn margin(flow: &Flow, [width, height]: [f64; 2], params: &FlowParams) -> [f64; 2] {
    match flow {
        // Half the diagonal reaches this far beyond the sides.
        Flow::Vortex => {
            let half = libm::sqrt(width * width + height * height) / 2.0;
            [half - width / 2.0, half - height / 2.0]
        }
        // Elements that cross one side enter at the other.
        Flow::Shear => [width, 0.0],
        Flow::Wind => [0.0; 2],
        Flow::Field(_) => [DRIFT * params.strength * width.min(height); 2],
    }
}

/// The path of an element.
pub(super) enum Path {
    /// At rest.
    Still,
    /// Along x, by `distance` pixels in a loop, with a wobble. Wraps at `period`, starting at `from`.
    Band { distance: f64, from: f64, period: f64, wobble: [f64; KNOTS] },
    /// About the middle, `rounds` times in a loop.
    Round { arm: Vec2, rounds: f64 },
    /// Back and forth.
    Sway { rounds: f64, phase: f64, way: Vec2, bend: f64 },
    /// Points at equal time steps from appearance to disappearance, and the share of that time at which a
    /// loop begins.
    Drift { points: Vec<Vec2>, phase: f64 },
}

/// The initial state of an element.
pub(super) struct Start {
    /// Its place.
    pub(super) at: Point,
    /// Its id, or that of the element that it is a copy of.
    pub(super) id: u64,
    /// Whether it is an individual element. Other elements form a texture together, so neighbours move alike.
    pub(super) individual: bool,
}

impl Path {
    pub(super) fn new(flow: &Flow, start: &Start, canvas: [f64; 2], params: &FlowParams) -> Self {
        let Start { at, id, individual } = *start;
        let [width, height] = canvas;
        let rounds = f64::from(params.rounds);
        let shorter = width.min(height);
        match flow {
            Flow::Shear => {
                let sign = match at.y.rem_euclid(height) / height {
                    third if third < 1.0 / 3.0 => -1.0,
                    third if third > 2.0 / 3.0 => 1.0,
                    _ => return Self::Still,
                };
                let mut random = stream(params.seed, "flow/shear", id);
                // A loop begins where the scene has the element.
                let wobble = std::array::from_fn(|k| {
                    if k == 0 || !individual { 0.0 } else { random.normal() * WOBBLE * width }
                });
                Self::Band { distance: sign * rounds * width, from: at.x, period: width, wobble }
            }
            Flow::Vortex => Self::Round { arm: at - Point::new(width / 2.0, height / 2.0), rounds },
            Flow::Wind => {
                let mut random = stream(params.seed, "flow/wind", id);
                let own = if individual { 1.0 } else { 0.0 };
                let bulge = 0.12 * libm::sin(TAU * at.y / height);
                let phase = bulge - at.x / (WAVE * width) + 0.05 * own * random.normal();
                let strength = params.strength * (1.0 + own * random.range(-0.3, 0.3));
                let way = Vec2::new(1.0, 0.15 * own * random.normal()) * (GUST * shorter * strength);
                Self::Sway { rounds, phase, way, bend: BEND * own * strength.min(3.0) }
            }
            Flow::Field(_) if !individual => Self::Still,
            Flow::Field(map) => {
                // A whole number of steps, so that a loop begins exactly where the scene has the element.
                let first = libm::ceil(FADE * STEPS as f64) as usize;
                let more = stream(params.seed, "flow/field", id).index(STEPS - 2 * first + 1);
                let phase = (first + more) as f64 / STEPS as f64;
                let length = DRIFT * params.strength * shorter;
                Self::Drift { points: drifted(map, at, canvas, length, phase), phase }
            }
        }
    }

    /// The times at which the element jumps to another place, as shares of the loop, 0 to 1.
    pub(super) fn jumps(&self) -> Vec<f64> {
        let inner = |time: &f64| (0.0..=1.0).contains(time);
        match self {
            Self::Still | Self::Round { .. } | Self::Sway { .. } => Vec::new(),
            Self::Band { distance, from, period, .. } => {
                let begin = from.rem_euclid(*period);
                let wraps = libm::ceil((distance / period).abs()) as i64 + 1;
                let at = |k: i64| (k as f64 * period - begin) / distance;
                (-wraps..=wraps).map(at).filter(inner).collect()
            }
            Self::Drift { phase, .. } => Some(1.0 - phase).filter(inner).into_iter().collect(),
        }
    }

    /// Number of samples in a loop that describe the path.
    pub(super) fn samples(&self) -> f64 {
        match self {
            Self::Still => 1.0,
            Self::Band { .. } => 8.0 * KNOTS as f64,
            // With this number of chords per round, each is at most an eighth of a pixel from the circle.
            Self::Round { arm, rounds } => {
                let radius = libm::sqrt(arm.hypot2());
                rounds * (16.0 + libm::ceil(std::f64::consts::PI * libm::sqrt(4.0 * radius)))
            }
            Self::Sway { rounds, .. } => 48.0 * rounds,
            Self::Drift { .. } => 2.0 * STEPS as f64,
        }
    }

    /// The place at a share of the loop, 0 to 1.
    pub(super) fn at(&self, time: f64) -> Now {
        let still = Now { way: Vec2::ZERO, angle: 0.0, size: 1.0 };
        match self {
            Self::Still => still,
            Self::Band { distance, from, period, wobble } => {
                let x = (from + distance * time).rem_euclid(*period) - from.rem_euclid(*period);
                Now { way: Vec2::new(x + smooth(wobble, time), 0.0), ..still }
            }
            Self::Round { arm, rounds } => {
                let angle = TAU * rounds * time;
                let (sine, cosine) = libm::sincos(angle);
                let turned = Vec2::new(cosine * arm.x - sine * arm.y, sine * arm.x + cosine * arm.y);
                Now { way: turned - *arm, angle, size: 1.0 }
            }
            Self::Sway { rounds, phase, way, bend } => {
                let gust = |turn: f64| libm::sin(TAU * turn);
                let now = gust(rounds * time + phase) - gust(*phase);
                Now { way: *way * now, angle: bend * now, size: 1.0 }
            }
            Self::Drift { points, phase } => {
                let age = (time + phase) - libm::floor(time + phase);
                let at = age * (points.len() - 1) as f64;
                let low = (at as usize).min(points.len() - 2);
                let way = points[low].lerp(points[low + 1], at - low as f64);
                Now { way, angle: 0.0, size: envelope(age.min(1.0 - age) / FADE) }
            }
        }
    }
}

/// From 0 to 1, smoothly.
fn envelope(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// A smooth periodic curve through values at equal time steps.
fn smooth(knots: &[f64; KNOTS], time: f64) -> f64 {
    let at = time * KNOTS as f64;
    let low = at as usize % KNOTS;
    let (a, b) = (knots[low], knots[(low + 1) % KNOTS]);
    a + (b - a) * envelope(at - libm::floor(at))
}

/// Points along a field, relative to `from`, which is reached after a share `phase` of the length.
fn drifted(map: &ControlMap, from: Point, canvas: [f64; 2], length: f64, phase: f64) -> Vec<Vec2> {
    let step = length / STEPS as f64;
    let direction = |p: Point| {
        // Copies beyond the borders move as their originals do.
        let home = [p.x.rem_euclid(canvas[0]), p.y.rem_euclid(canvas[1])];
        let (sine, cosine) = libm::sincos(TAU * map.turn_at(home, canvas));
        Vec2::new(cosine, sine)
    };
    let walk = |share: f64, sign: f64| {
        let mut p = from;
        let mut points = vec![Vec2::ZERO];
        let count = libm::ceil(share * STEPS as f64) as usize;
        for _ in 0..count.max(1) {
            // The midpoint rule.
            let half = p + direction(p) * (sign * step / 2.0);
            p += direction(half) * (sign * step);
            points.push(p - from);
        }
        points
    };
    let (back, on) = (walk(phase, -1.0), walk(1.0 - phase, 1.0));
    // Sampled at equal steps, with `from` exactly at `phase`.
    let along = |points: &[Vec2], steps: f64| {
        let low = (steps as usize).min(points.len() - 2);
        points[low].lerp(points[low + 1], (steps - low as f64).min(1.0))
    };
    let at = |share: f64| {
        let steps = (share - phase) * STEPS as f64;
        if steps < 0.0 { along(&back, -steps) } else { along(&on, steps) }
    };
    (0..=STEPS).map(|k| at(k as f64 / STEPS as f64)).collect()
}
