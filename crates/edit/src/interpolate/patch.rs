//! Interpolation of a texton's details and holes. They are deformed by mean value coordinates with the
//! outline that holds them; points that would lie outside are moved to its rim.

use super::correspond::{MatchingPlane, Properties, correspond};
use super::envelope;
use super::paint::ShapePaint;
use super::ring::{Ring, alignment, count, even, moments, sine_cosine, turned};
use vtex_base::geometry::{Cage, Outline, Point, inside, nearest};
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::Stream;
use vtex_scene::element::Profile;
use vtex_scene::scene::Shape;

/// Fit tolerance of outlines, in pixels.
pub(super) const TOLERANCE: f64 = 0.15;
/// Duration in which an unmatched detail vanishes or appears, as a share of the whole time.
const FADE: f64 = 0.5;

/// A detail of one scene, on the canvas, relative to the centre of its texton.
pub(super) struct CentredDetail {
    /// Its rings, the largest first.
    pub(super) rings: Vec<Ring>,
    pub(super) paint: ShapePaint,
    /// The profile of a soft ellipse, whose rim `rings` are.
    pub(super) profile: Option<Profile>,
}

/// A detail that changes over time.
pub(super) struct MovingDetail {
    rings: Vec<MovingRing>,
    /// Its fill at either end, with the point of the texton that the fill's coordinates refer to; `None`
    /// at an end where it does not exist.
    paints: [Option<(ShapePaint, Point)>; 2],
    /// Position in the painting order at either end, 0 to 1.
    keys: [f64; 2],
    /// The profile at either end where it is a soft ellipse.
    profiles: [Option<Profile>; 2],
}

/// A ring that changes over time.
pub(super) enum MovingRing {
    /// A matched pair, morphed point by point.
    Pair([Ring; 2]),
    /// An unmatched ring: it vanishes or appears.
    Unmatched { side: usize, ring: Ring, centre: Point, window: [f64; 2] },
}

/// The deformation of a texton's interior at some time.
pub(super) struct Carry<'a> {
    pub(super) cages: &'a [Cage; 2],
    /// The ring that details must stay inside.
    pub(super) hull: &'a Ring,
    /// Whether what sticks out of it is clipped, and so may stay there.
    pub(super) clips: bool,
    /// Ratios of lengths to those of either end, and the rotations so far.
    pub(super) scales: [f64; 2],
    pub(super) turns: [f64; 2],
}

impl MovingRing {
    /// A hole that exists at one end only.
    pub(super) fn hole(side: usize, ring: Ring) -> Self {
        let centre = moments(&ring).1;
        Self::Unmatched { side, ring, centre, window: [[0.0, 0.5], [0.5, 1.0]][side] }
    }

    /// The ring at time `t`; `None` while it is too small.
    pub(super) fn at(&self, carry: &Carry<'_>, t: f64) -> Option<Ring> {
        let there = match self {
            Self::Pair(_) => true,
            Self::Unmatched { side, window, .. } => envelope(*side, *window, t) > 0.02,
        };
        there.then(|| self.ring(carry, t))
    }

    /// The ring at time `t`, always with the same number of points.
    pub(super) fn ring(&self, carry: &Carry<'_>, t: f64) -> Ring {
        let kept = |p: Point| if carry.clips || inside(carry.hull, p) { p } else { nearest(carry.hull, p) };
        match self {
            Self::Pair([from, to]) => {
                let [a, b] = carry.cages;
                from.iter().zip(to).map(|(p, q)| kept(a.map(*p).lerp(b.map(*q), t))).collect()
            }
            Self::Unmatched { side, ring, centre, window } => {
                let size = envelope(*side, *window, t);
                let cage = &carry.cages[*side];
                let centre = cage.map(*centre);
                let point = |p: &Point| kept(centre.lerp(cage.map(*p), size));
                ring.iter().map(point).collect()
            }
        }
    }
}

impl MovingDetail {
    /// The detail at time `t`; `None` while it does not exist.
    pub(super) fn at(&self, carry: &Carry<'_>, t: f64) -> Option<Shape> {
        let profile = self.profile(t);
        let carry = &Carry { clips: profile.is_some(), ..*carry };
        let rings: Vec<Ring> = self.rings.iter().filter_map(|part| part.at(carry, t)).collect();
        let (area, centre) = rings.first().map(|r| moments(r))?;
        if area.abs() < 0.2 {
            return None;
        }
        let carried = |side: usize| {
            let (paint, from) = self.paints[side].as_ref()?;
            let turn = sine_cosine(carry.turns[side]);
            let there =
                |p: Point| centre + turned((p - *from).to_point(), turn).to_vec2() * carry.scales[side];
            Some(paint.carried(there))
        };
        let paint = match (carried(0), carried(1)) {
            (Some(a), Some(b)) => a.mixed(&b, t),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return None,
        };
        let outline = Outline::along(&rings, TOLERANCE).filter(|o| !o.is_empty())?;
        if let Some(profile) = profile {
            return Shape::soft_along(&outline, paint.colour, profile);
        }
        Some(Shape { gradient: paint.gradient.map(Box::new), ..Shape::new(outline, paint.colour) })
    }

    /// The profile at time `t` if it is a soft ellipse then.
    pub(super) fn profile(&self, t: f64) -> Option<Profile> {
        self.profiles[usize::from(t >= 0.5)]
    }

    /// All its rings at time `t`, always with the same numbers of points.
    pub(super) fn rings(&self, carry: &Carry<'_>, t: f64) -> Vec<Ring> {
        self.rings.iter().map(|part| part.ring(carry, t)).collect()
    }

    /// Its colours at either end.
    pub(super) fn colours(&self) -> [Colour; 2] {
        let colour = |side: usize| {
            self.paints[side].as_ref().or(self.paints[1 - side].as_ref()).map(|(paint, _)| paint.colour)
        };
        [0, 1].map(|side| colour(side).unwrap_or_default())
    }

    /// Position in the painting order at time `t`.
    pub(super) fn key(&self, t: f64) -> f64 {
        self.keys[0] + (self.keys[1] - self.keys[0]) * t
    }
}

/// Matches the details of two textons by position, size and colour. The textons' areas are given; the
/// second is rotated by `turn` relative to the first.
pub(super) fn patches(
    details: [&[CentredDetail]; 2],
    areas: [f64; 2],
    turn: f64,
    random: &mut Stream,
) -> Vec<MovingDetail> {
    let properties = [0, 1].map(|side| {
        let unit = libm::sqrt(areas[side].abs().max(1e-6));
        let back = sine_cosine(if side == 1 { -turn } else { 0.0 });
        let trait_of = |detail: &CentredDetail| {
            let (area, centre) = detail.rings.first().map_or((0.0, Point::ORIGIN), |r| moments(r));
            Properties {
                at: turned((centre.to_vec2() / unit).to_point(), back),
                size: libm::sqrt(area.abs()) / unit,
                colour: detail.paint.colour.to_oklab(),
                category: None,
            }
        };
        details[side].iter().map(trait_of).collect::<Vec<_>>()
    });
    let found = correspond(&properties[0], &properties[1], &MatchingPlane { area: 1.0, periods: [None; 2] });
    let key = |side: usize, k: u32| f64::from(k) / details[side].len() as f64;
    let mut out = Vec::with_capacity(details[0].len() + details[1].len());
    for [i, k] in found.pairs {
        let pair = [&details[0][i as usize], &details[1][k as usize]];
        if let Some(rings) = paired_rings([&pair[0].rings, &pair[1].rings], turn) {
            let centre = |side: usize| moments(&pair[side].rings[0]).1;
            let paints = [0, 1].map(|side| Some((pair[side].paint.clone(), centre(side))));
            let profiles = pair.map(|detail| detail.profile);
            out.push(MovingDetail { rings, paints, keys: [key(0, i), key(1, k)], profiles });
        }
    }
    for side in 0..2 {
        for &k in &found.unmatched[side] {
            let detail = &details[side][k as usize];
            let first = random.range(0.0, 1.0 - FADE);
            let window = [first, first + FADE];
            let Some(centre) = detail.rings.first().map(|r| moments(r).1) else { continue };
            let part = |r: &Ring| MovingRing::Unmatched { side, ring: even(r, count(r, r)), centre, window };
            let mut paints = [None, None];
            paints[side] = Some((detail.paint.clone(), centre));
            let rings = detail.rings.iter().map(part).collect();
            out.push(MovingDetail { rings, paints, keys: [key(side, k); 2], profiles: [detail.profile; 2] });
        }
    }
    out
}

/// Pairs two shapes by their first rings. Further rings (holes) vanish or appear. `None` if either
/// shape has no ring.
fn paired_rings(rings: [&[Ring]; 2], turn: f64) -> Option<Vec<MovingRing>> {
    let (a, b) = (rings[0].first()?, rings[1].first()?);
    let n = count(a, b);
    let (a, mut b) = (even(a, n), even(b, n));
    let around = |ring: &Ring, turn: f64| -> Ring {
        let (centre, turn) = (moments(ring).1, sine_cosine(turn));
        ring.iter().map(|p| turned((*p - centre).to_point(), turn)).collect()
    };
    let (shift, _) = alignment(&around(&a, 0.0), &around(&b, -turn), false);
    b.rotate_left(shift);
    let mut parts = vec![MovingRing::Pair([a, b])];
    for side in 0..2 {
        parts.extend(rings[side].iter().skip(1).map(|hole| MovingRing::hole(side, hole.clone())));
    }
    Some(parts)
}
