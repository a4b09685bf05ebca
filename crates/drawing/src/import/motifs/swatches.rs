//! Generated swatches with known groups of elements, for tests of grouping.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use vtex_base::geometry::{Affine, Point, Rect, Vec2, rotation, shortest_offset, wrapped};
use vtex_base::sampling::{Stream, stream};

/// A shape of a swatch.
#[derive(Clone)]
enum DrawnPart {
    /// A polygon or ellipse, as path text, in the fill colour.
    Filled(Vec<Point>, &'static str),
    /// A straight stroke of a width.
    Stroke([Point; 2], f64, &'static str),
}

impl DrawnPart {
    fn moved(&self, map: Affine) -> Self {
        match self {
            Self::Filled(points, colour) => Self::Filled(points.iter().map(|p| map * *p).collect(), colour),
            Self::Stroke(ends, width, colour) => Self::Stroke(ends.map(|p| map * p), *width, colour),
        }
    }

    fn bounds(&self) -> Rect {
        let (points, reach) = match self {
            Self::Filled(points, _) => (&points[..], 0.0),
            Self::Stroke(ends, width, _) => (&ends[..], width / 2.0),
        };
        let first = Rect::from_points(points[0], points[0]);
        points.iter().fold(first, |sum, p| sum.union_pt(*p)).inflate(reach, reach)
    }

    fn write(&self, out: &mut String) {
        let text = |points: &[Point]| -> String {
            points.iter().map(|p| format!("{:.3} {:.3}", p.x, p.y)).collect::<Vec<_>>().join("L")
        };
        let _ = match self {
            Self::Filled(points, colour) => write!(out, "<path d='M{}z' fill='{colour}'/>", text(points)),
            Self::Stroke(ends, width, colour) => {
                write!(out, "<path d='M{}' stroke='{colour}' stroke-width='{width}'/>", text(ends))
            }
        };
    }
}

/// What a swatch is made of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Recipe {
    /// Parallel strokes.
    Strokes(usize),
    /// Petals around nothing, or around a disc.
    Ring(usize, bool),
    /// A disc with dots around it.
    Rosette(usize),
    /// Four diamonds that make a square.
    Diamonds,
    /// A stem with leaves on both sides that do not touch it.
    Sprig(usize),
    /// Two strokes, mirrored.
    Chevron,
    /// A large dot, a small one, and a stroke.
    Note,
    /// Single elements.
    Disc,
    Stroke,
    Triangle,
}

fn ellipse(middle: Point, along: f64, across: f64, angle: f64) -> Vec<Point> {
    let turn = rotation(angle);
    let at = |k: i32| {
        let (s, c) = libm::sincos(f64::from(k) * TAU / 24.0);
        middle + (turn * Point::new(along * c, across * s)).to_vec2()
    };
    (0..24).map(at).collect()
}

const INK: &str = "#264653";
const RED: &str = "#e76f51";
const SAND: &str = "#e9c46a";
const GREEN: &str = "#2a9d8f";

impl Recipe {
    /// The parts around the origin, and the largest gap that joins them.
    fn parts(self) -> (Vec<DrawnPart>, f64) {
        let stroke = |x0: f64, y0: f64, x1: f64, y1: f64, colour| {
            DrawnPart::Stroke([Point::new(x0, y0), Point::new(x1, y1)], 3.0, colour)
        };
        let around = |count: usize, radius: f64| {
            (0..count).map(move |k| {
                let angle = TAU * k as f64 / count as f64;
                let (s, c) = libm::sincos(angle);
                (Point::new(radius * c, radius * s), angle)
            })
        };
        match self {
            Self::Strokes(count) => {
                let y = |k: usize| 8.0 * (k as f64 - (count - 1) as f64 / 2.0);
                ((0..count).map(|k| stroke(-13.0, y(k), 13.0, y(k), INK)).collect(), 5.0)
            }
            Self::Ring(count, has_middle) => {
                let petal = |(at, angle)| DrawnPart::Filled(ellipse(at, 7.0, 3.4, angle), RED);
                let mut parts: Vec<_> = around(count, 15.0).map(petal).collect();
                if has_middle {
                    parts.push(DrawnPart::Filled(ellipse(Point::ORIGIN, 4.5, 4.5, 0.0), SAND));
                }
                (parts, 6.0)
            }
            Self::Rosette(count) => {
                let dot = |(at, _)| DrawnPart::Filled(ellipse(at, 2.4, 2.4, 0.0), GREEN);
                let mut parts: Vec<_> = around(count, 13.0).map(dot).collect();
                parts.push(DrawnPart::Filled(ellipse(Point::ORIGIN, 7.0, 7.0, 0.0), INK));
                (parts, 4.5)
            }
            Self::Diamonds => {
                let diamond = |(at, angle): (Point, f64)| {
                    let _ = angle;
                    let corner = |x: f64, y: f64| at + Vec2::new(x, y);
                    let points = [corner(7.0, 0.0), corner(0.0, 7.0), corner(-7.0, 0.0), corner(0.0, -7.0)];
                    DrawnPart::Filled(points.to_vec(), if at.x.abs() > 1.0 { SAND } else { RED })
                };
                (around(4, 11.0).map(diamond).collect(), 4.0)
            }
            Self::Sprig(pairs) => {
                let mut parts = vec![stroke(0.0, -4.0, 0.0, 12.0 * pairs as f64, GREEN)];
                for k in 0..pairs {
                    for side in [-1.0, 1.0] {
                        let at = Point::new(side * 9.0, 4.0 + 11.0 * k as f64);
                        parts.push(DrawnPart::Filled(ellipse(at, 6.0, 2.6, side * 0.5), GREEN));
                    }
                }
                (parts, 4.0)
            }
            Self::Chevron => {
                (vec![stroke(-3.0, 0.0, -13.0, 14.0, RED), stroke(3.0, 0.0, 13.0, 14.0, RED)], 4.0)
            }
            Self::Note => {
                let parts = vec![
                    DrawnPart::Filled(ellipse(Point::new(-8.0, 2.0), 6.0, 6.0, 0.0), INK),
                    DrawnPart::Filled(ellipse(Point::new(4.0, -3.0), 3.0, 3.0, 0.0), RED),
                    stroke(-2.0, 11.0, 12.0, 6.0, SAND),
                ];
                (parts, 5.0)
            }
            Self::Disc => (vec![DrawnPart::Filled(ellipse(Point::ORIGIN, 6.0, 6.0, 0.0), SAND)], 0.0),
            Self::Stroke => (vec![stroke(-13.0, 0.0, 13.0, 0.0, INK)], 0.0),
            Self::Triangle => {
                let points = [(0.0, -9.0), (8.0, 6.0), (-8.0, 6.0)].map(Point::from).to_vec();
                (vec![DrawnPart::Filled(points, GREEN)], 0.0)
            }
        }
    }
}

/// How copies of motifs are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turned {
    Never,
    Anyhow,
    Mirrored,
}

/// A swatch and the group of each of its parts.
pub(super) struct Swatch {
    pub(super) svg: String,
    pub(super) size: [f64; 2],
    pub(super) wrap: bool,
    /// Middle of the bounds of each part, and its group.
    pub(super) parts: Vec<(Point, usize)>,
}

/// How a swatch is generated.
#[derive(Clone, Debug)]
pub(super) struct SwatchPlan {
    /// Recipes with the number of copies wanted.
    pub(super) recipes: Vec<(Recipe, usize)>,
    pub(super) size: [f64; 2],
    pub(super) wrap: bool,
    pub(super) turned: Turned,
    /// Largest deviation of a part from its place, in units, and of its angle, in radians.
    pub(super) jitter: [f64; 2],
    /// Least gap between copies, in gaps within them.
    pub(super) apart: f64,
    pub(super) seed: u64,
}

impl SwatchPlan {
    pub(super) fn drawn(&self) -> Swatch {
        let mut random = stream(self.seed, "tests/swatch", 0);
        let periods = [0, 1].map(|k| self.wrap.then_some(self.size[k]));
        let mut svg = String::new();
        let mut parts: Vec<(Point, usize)> = Vec::new();
        // Outlines of what is placed, and the gap that it needs.
        let mut placed: Vec<(Vec<Point>, f64)> = Vec::new();
        let mut group = 0;
        for &(recipe, count) in &self.recipes {
            let (own, gap) = recipe.parts();
            for _ in 0..count {
                for _ in 0..400 {
                    let copy = self.copy(&own, &mut random);
                    let points: Vec<Point> = copy.iter().flat_map(outline_points).collect();
                    let needed = self.apart * gap.max(4.0);
                    let clear = placed.iter().all(|(other, least)| {
                        let least = least.max(needed);
                        points
                            .iter()
                            .all(|p| other.iter().all(|q| shortest_offset(*p, *q, periods).hypot() >= least))
                    });
                    let page = Rect::new(0.0, 0.0, self.size[0], self.size[1]);
                    let inside = copy.iter().all(|part| page.contains_rect(part.bounds().inflate(2.0, 2.0)));
                    if clear && (self.wrap || inside) {
                        for part in &copy {
                            let middle = part.bounds().center();
                            let home =
                                Point::new(wrapped(middle.x, periods[0]), wrapped(middle.y, periods[1]));
                            parts.push((home, group));
                            self.write(part, &mut svg);
                        }
                        placed.push((points, needed));
                        group += 1;
                        break;
                    }
                }
            }
        }
        let [w, h] = self.size;
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='{w}' height='{h}' viewBox='0 0 {w} {h}' fill='none'>\
             <rect width='{w}' height='{h}' fill='#fdf6e3'/>{svg}</svg>"
        );
        Swatch { svg, size: self.size, wrap: self.wrap, parts }
    }

    /// A copy at a random place, its parts a little off theirs.
    fn copy(&self, own: &[DrawnPart], random: &mut Stream) -> Vec<DrawnPart> {
        let flip = self.turned == Turned::Mirrored && random.unit() < 0.5;
        let angle = if self.turned == Turned::Anyhow { random.range(-PI, PI) } else { 0.0 };
        let at = Vec2::new(random.range(0.0, self.size[0]), random.range(0.0, self.size[1]));
        let flip = if flip { Affine::FLIP_X } else { Affine::IDENTITY };
        let map = Affine::translate(at) * rotation(angle) * flip;
        let [place, turn] = self.jitter;
        let shaken = |part: &DrawnPart| {
            let by = Vec2::new(random.range(-place, place), random.range(-place, place));
            let middle = part.bounds().center().to_vec2();
            let shake = Affine::translate(by + middle)
                * rotation(random.range(-turn, turn))
                * Affine::translate(-middle);
            part.moved(map * shake)
        };
        own.iter().map(shaken).collect()
    }

    /// Writes a part, at all places where it reaches the page.
    fn write(&self, part: &DrawnPart, out: &mut String) {
        let page = Rect::new(0.0, 0.0, self.size[0], self.size[1]);
        let steps = if self.wrap { -1..=1 } else { 0..=0 };
        for y in steps.clone() {
            for x in steps.clone() {
                let by = Affine::translate((f64::from(x) * self.size[0], f64::from(y) * self.size[1]));
                let moved = part.moved(by);
                if moved.bounds().overlaps(page) {
                    moved.write(out);
                }
            }
        }
    }
}

/// Points along the outline of a part.
fn outline_points(part: &DrawnPart) -> Vec<Point> {
    let ring: Vec<Point> = match part {
        DrawnPart::Filled(points, _) => points.clone(),
        DrawnPart::Stroke([p, q], width, _) => {
            let across = (*q - *p).normalize().turn_90() * (width / 2.0);
            vec![*p + across, *q + across, *q - across, *p - across]
        }
    };
    let side = |k: usize| (ring[k], ring[(k + 1) % ring.len()]);
    (0..ring.len())
        .flat_map(|k| {
            let (p, q) = side(k);
            let steps = libm::ceil(p.distance(q) / 3.0).max(1.0) as usize;
            (0..steps).map(move |i| p.lerp(q, i as f64 / steps as f64))
        })
        .collect()
}

/// Thirty swatches: pairs, rings, rosettes, squares of diamonds, sprigs, chevrons and mixtures of them, with
/// and without single elements, that repeat or do not, exact or shaken.
pub(super) fn thirty(first_seed: u64) -> Vec<SwatchPlan> {
    use Recipe::*;
    let mixtures: [&[(Recipe, usize)]; 15] = [
        &[(Strokes(2), 16)],
        &[(Strokes(2), 10), (Stroke, 10)],
        &[(Strokes(3), 8), (Disc, 9)],
        &[(Ring(6, false), 7)],
        &[(Ring(8, true), 5), (Disc, 8)],
        &[(Ring(5, true), 6), (Strokes(2), 8), (Triangle, 5)],
        &[(Rosette(7), 7), (Disc, 5)],
        &[(Diamonds, 9)],
        &[(Diamonds, 6), (Triangle, 9)],
        &[(Sprig(3), 6)],
        &[(Sprig(2), 7), (Disc, 10)],
        &[(Chevron, 10), (Triangle, 6)],
        &[(Note, 9), (Stroke, 6)],
        &[(Ring(6, true), 1), (Diamonds, 1), (Sprig(2), 2), (Strokes(2), 4), (Disc, 6)],
        &[(Ring(7, false), 3), (Rosette(6), 3), (Chevron, 4), (Stroke, 5), (Triangle, 4)],
    ];
    let plan = |k: usize| {
        let recipes = mixtures[k % mixtures.len()].to_vec();
        let second = k >= mixtures.len();
        SwatchPlan {
            recipes,
            size: [300.0, if k % 4 == 1 { 260.0 } else { 300.0 }],
            wrap: k.is_multiple_of(2) != second,
            turned: [Turned::Anyhow, Turned::Never, Turned::Mirrored][(k + usize::from(second)) % 3],
            jitter: if second { [0.8, 0.08] } else { [0.0; 2] },
            apart: if k.is_multiple_of(3) { 1.5 } else { 2.0 },
            seed: first_seed + k as u64,
        }
    };
    (0..2 * mixtures.len()).map(plan).collect()
}
