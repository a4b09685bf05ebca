//! Details of one texton that turn into those of another, inside the outline that holds them.

use super::correspond::{Plane, Traits, correspond};
use super::paint::Paint;
use super::presence;
use super::ring::{Ring, alignment, count, even, inside, moments, nearest, sine_cosine, turned};
use crate::geometry::{Cage, Outline, Point};
use crate::raster::colour::Colour;
use crate::sampling::Stream;
use crate::scene;

/// Tolerance of outlines, in pixels.
pub(super) const TOLERANCE: f64 = 0.15;
/// Share of the time that one which has no partner takes to go or to come.
const FADE: f64 = 0.5;

/// A detail at one end, relative to the centre of its texton, on the canvas.
pub(super) struct Detail {
    /// The largest ring first.
    pub(super) rings: Vec<Ring>,
    pub(super) paint: Paint,
}

/// A detail on its way.
pub(super) struct Patch {
    rings: Vec<Part>,
    /// What it is filled with at either end where there is one, and from where in the texton.
    paints: [Option<(Paint, Point)>; 2],
    /// Its place in the painting order at either end, 0 to 1.
    keys: [f64; 2],
}

/// A ring on its way.
pub(super) enum Part {
    /// It turns into another, point by point.
    Both([Ring; 2]),
    /// It is there at one end only.
    One { side: usize, ring: Ring, centre: Point, window: [f64; 2] },
}

/// How the inside of a texton is carried along.
pub(super) struct Carry<'a> {
    pub(super) cages: &'a [Cage; 2],
    /// What nothing may stick out of.
    pub(super) hull: &'a Ring,
    /// Lengths beside those at either end, and the turns so far.
    pub(super) scales: [f64; 2],
    pub(super) turns: [f64; 2],
}

impl Part {
    /// A hole, there at one end only.
    pub(super) fn hole(side: usize, ring: Ring) -> Self {
        let centre = moments(&ring).1;
        Self::One { side, ring, centre, window: [[0.0, 0.5], [0.5, 1.0]][side] }
    }

    /// The ring a share of the way; none if there is nothing of it.
    pub(super) fn at(&self, carry: &Carry<'_>, t: f64) -> Option<Ring> {
        let there = match self {
            Self::Both(_) => true,
            Self::One { side, window, .. } => presence(*side, *window, t) > 0.02,
        };
        there.then(|| self.ring(carry, t))
    }

    /// The ring a share of the way, with as many points at all times.
    pub(super) fn ring(&self, carry: &Carry<'_>, t: f64) -> Ring {
        let kept = |p: Point| if inside(carry.hull, p) { p } else { nearest(carry.hull, p) };
        match self {
            Self::Both([from, to]) => {
                let [a, b] = carry.cages;
                from.iter().zip(to).map(|(p, q)| kept(a.map(*p).lerp(b.map(*q), t))).collect()
            }
            Self::One { side, ring, centre, window } => {
                let size = presence(*side, *window, t);
                let cage = &carry.cages[*side];
                let centre = cage.map(*centre);
                let point = |p: &Point| kept(centre.lerp(cage.map(*p), size));
                ring.iter().map(point).collect()
            }
        }
    }
}

impl Patch {
    /// The detail a share of the way; none if there is nothing of it.
    pub(super) fn at(&self, carry: &Carry<'_>, t: f64) -> Option<scene::Patch> {
        let rings: Vec<Ring> = self.rings.iter().filter_map(|part| part.at(carry, t)).collect();
        let (area, centre) = rings.first().map(|r| moments(r))?;
        if area.abs() < 0.2 {
            return None;
        }
        let carried = |side: usize| {
            let (paint, from) = self.paints[side]?;
            let turn = sine_cosine(carry.turns[side]);
            let there =
                |p: Point| centre + turned((p - from).to_point(), turn).to_vec2() * carry.scales[side];
            Some(paint.carried(there))
        };
        let paint = match (carried(0), carried(1)) {
            (Some(a), Some(b)) => a.mixed(&b, t),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return None,
        };
        let outline = Outline::along(&rings, TOLERANCE).filter(|o| !o.is_empty())?;
        Some(scene::Patch { outline, colour: paint.colour, gradient: paint.gradient })
    }

    /// All its rings, with as many points at all times.
    pub(super) fn rings(&self, carry: &Carry<'_>, t: f64) -> Vec<Ring> {
        self.rings.iter().map(|part| part.ring(carry, t)).collect()
    }

    /// Its colours at either end.
    pub(super) fn colours(&self) -> [Colour; 2] {
        let colour = |side: usize| self.paints[side].or(self.paints[1 - side]).map(|(paint, _)| paint.colour);
        [0, 1].map(|side| colour(side).unwrap_or_default())
    }

    /// Where it stands in the painting order.
    pub(super) fn key(&self, t: f64) -> f64 {
        self.keys[0] + (self.keys[1] - self.keys[0]) * t
    }
}

/// Matches the details of two textons, whose areas are given, by place, size and colour; the second
/// stands turned by `turn` to the first.
pub(super) fn patches(
    details: [&[Detail]; 2],
    areas: [f64; 2],
    turn: f64,
    random: &mut Stream,
) -> Vec<Patch> {
    let traits = [0, 1].map(|side| {
        let unit = libm::sqrt(areas[side].abs().max(1e-6));
        let back = sine_cosine(if side == 1 { -turn } else { 0.0 });
        let trait_of = |detail: &Detail| {
            let (area, centre) = detail.rings.first().map_or((0.0, Point::ORIGIN), |r| moments(r));
            Traits {
                at: turned((centre.to_vec2() / unit).to_point(), back),
                size: libm::sqrt(area.abs()) / unit,
                colour: detail.paint.colour.to_oklab(),
                category: None,
            }
        };
        details[side].iter().map(trait_of).collect::<Vec<_>>()
    });
    let found = correspond(&traits[0], &traits[1], &Plane { area: 1.0, periods: [None; 2] });
    let key = |side: usize, k: u32| f64::from(k) / details[side].len() as f64;
    let mut out = Vec::with_capacity(details[0].len() + details[1].len());
    for [i, k] in found.pairs {
        let pair = [&details[0][i as usize], &details[1][k as usize]];
        if let Some(rings) = both([&pair[0].rings, &pair[1].rings], turn) {
            let centre = |side: usize| moments(&pair[side].rings[0]).1;
            let paints = [0, 1].map(|side| Some((pair[side].paint, centre(side))));
            out.push(Patch { rings, paints, keys: [key(0, i), key(1, k)] });
        }
    }
    for side in 0..2 {
        for &k in &found.alone[side] {
            let detail = &details[side][k as usize];
            let first = random.range(0.0, 1.0 - FADE);
            let window = [first, first + FADE];
            let Some(centre) = detail.rings.first().map(|r| moments(r).1) else { continue };
            let part = |r: &Ring| Part::One { side, ring: even(r, count(r, r)), centre, window };
            let mut paints = [None, None];
            paints[side] = Some((detail.paint, centre));
            let rings = detail.rings.iter().map(part).collect();
            out.push(Patch { rings, paints, keys: [key(side, k); 2] });
        }
    }
    out
}

/// Two shapes whose first rings correspond; the others, holes, close and open. None if either has no
/// ring.
fn both(rings: [&[Ring]; 2], turn: f64) -> Option<Vec<Part>> {
    let (a, b) = (rings[0].first()?, rings[1].first()?);
    let n = count(a, b);
    let (a, mut b) = (even(a, n), even(b, n));
    let around = |ring: &Ring, turn: f64| -> Ring {
        let (centre, turn) = (moments(ring).1, sine_cosine(turn));
        ring.iter().map(|p| turned((*p - centre).to_point(), turn)).collect()
    };
    let (shift, _) = alignment(&around(&a, 0.0), &around(&b, -turn), false);
    b.rotate_left(shift);
    let mut parts = vec![Part::Both([a, b])];
    for side in 0..2 {
        parts.extend(rings[side].iter().skip(1).map(|hole| Part::hole(side, hole.clone())));
    }
    Some(parts)
}
