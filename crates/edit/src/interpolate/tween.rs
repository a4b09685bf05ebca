//! Interpolation of one texton: into its partner, or, if unmatched, from or to nothing.

use super::blend::Blend;
use super::effects::{Effects, near};
use super::envelope;
use super::layer::LayerPair;
use super::motion::{Motion, MovingShape};
use super::paint::ShapePaint;
use super::patch::{Carry, MovingDetail, MovingRing, TOLERANCE, patches};
use super::progression::Progression;
use super::ring::{Ring, sine_cosine, turned};
use super::side::{CentredInstance, Side, same};
use vtex_base::geometry::{Affine, Outline, Point, Vec2};
use vtex_base::sampling::Stream;
use vtex_scene::element::{Ellipse, SoftRim};
use vtex_scene::scene::{Element, Instance, InstanceId, LibraryId, Scene, Shape};

/// Duration in which an unmatched texton vanishes or appears, as a share of the whole time.
const FADE: f64 = 0.35;

/// A texton that changes over time.
pub(super) struct Tween {
    /// Position in the painting order of either scene, 0 to 1.
    keys: [f64; 2],
    kind: TweenKind,
}

enum TweenKind {
    Pair(Box<MatchedTextons>),
    /// An unmatched texton: it vanishes or appears where it is, by scaling.
    Unmatched {
        side: usize,
        instance: u32,
        centre: Point,
        window: [f64; 2],
    },
}

/// A matched pair of textons.
struct MatchedTextons {
    /// Index of each instance in its layer.
    instances: [u32; 2],
    /// Whether both are the same, so that nothing changes.
    still: bool,
    centres: [Point; 2],
    blend: Blend,
    holes: Vec<MovingRing>,
    paints: [ShapePaint; 2],
    details: Vec<MovingDetail>,
}

/// A texton at some time.
pub(super) struct TweenedTexton {
    /// Position in the painting order.
    pub(super) key: f64,
    pub(super) what: TweenContent,
}

pub(super) enum TweenContent {
    /// An instance of scene `side`, unchanged or scaled about its centre.
    Existing { side: usize, instance: Instance },
    /// A new texton, placed with its origin at `at`.
    New { element: Element, at: Point, effects: Effects },
}

impl Tween {
    /// The tween of an unmatched instance.
    pub(super) fn unmatched(
        sides: &[Side<'_>; 2],
        side: usize,
        layer: LayerPair,
        k: u32,
        random: &mut Stream,
    ) -> Self {
        let instances = layer.of(side, sides[side].scene);
        let first = random.range(0.0, 1.0 - FADE);
        let centre = sides[side].centre(&instances[k as usize]);
        let kind = TweenKind::Unmatched { side, instance: k, centre, window: [first, first + FADE] };
        Self { keys: [f64::from(k) / instances.len() as f64; 2], kind }
    }

    /// The tween of a pair; `offset` is the offset from the first to the second. `None` if either has no
    /// area.
    pub(super) fn pair(
        sides: &[Side<'_>; 2],
        layer: LayerPair,
        pair: [u32; 2],
        offset: Vec2,
        random: &mut Stream,
    ) -> Option<Self> {
        let lists = [0, 1].map(|s| layer.of(s, sides[s].scene));
        let placed = |s: usize| sides[s].placed(&lists[s][pair[s] as usize]);
        let [a, b]: [CentredInstance; 2] = [placed(0)?, placed(1)?];
        let blend = Blend::new(&a.rings[0], &b.rings[0]);
        let turn = blend.turn();
        let details = if a.details.is_empty() && b.details.is_empty() {
            Vec::new()
        } else {
            patches([&a.details, &b.details], [a.area, b.area], turn, random)
        };
        let holes = [&a, &b].into_iter().enumerate();
        let holes = holes.flat_map(|(s, p)| p.rings[1..].iter().map(move |r| MovingRing::hole(s, r.clone())));
        let still = same(sides, [0, 1].map(|s| &lists[s][pair[s] as usize]));
        let both = MatchedTextons {
            instances: pair,
            still,
            centres: [a.centre, a.centre + offset],
            blend,
            holes: holes.collect(),
            paints: [a.paint, b.paint],
            details,
        };
        let keys = [0, 1].map(|s| f64::from(pair[s]) / lists[s].len() as f64);
        Some(Self { keys, kind: TweenKind::Pair(Box::new(both)) })
    }

    /// The texton at a time; `None` while it does not exist.
    pub(super) fn at(&self, ends: &Ends<'_>, layer: LayerPair, when: &Progression) -> Option<TweenedTexton> {
        let old = |side: usize, k: u32| layer.of(side, ends.scenes[side])[k as usize].clone();
        let (t, what) = match &self.kind {
            TweenKind::Unmatched { side, instance, centre, window } => {
                let t = when.at(*centre);
                let size = envelope(*side, *window, t);
                if size < 0.02 {
                    return None;
                }
                let mut instance = old(*side, *instance);
                if size < 1.0 {
                    let scaled = Affine::scale_about(size, *centre) * instance.affine();
                    instance.transform = scaled.as_coeffs();
                    instance.shadow = instance.shadow.map(|shadow| near(shadow, size));
                }
                (t, TweenContent::Existing { side: *side, instance })
            }
            TweenKind::Pair(both) => {
                let t = when.between(both.centres);
                let what = if both.still || t <= 0.0 || t >= 1.0 {
                    let side = usize::from(t >= 1.0);
                    TweenContent::Existing { side, instance: old(side, both.instances[side]) }
                } else {
                    both.at(ends, layer, t)?
                };
                (t, what)
            }
        };
        Some(TweenedTexton { key: self.key(t), what })
    }

    /// Position in the painting order at time `t`.
    pub(super) fn key(&self, t: f64) -> f64 {
        self.keys[0] + (self.keys[1] - self.keys[0]) * t
    }

    /// The whole motion.
    pub(super) fn motion(&self, ends: &Ends<'_>, layer: LayerPair, id: InstanceId) -> Motion {
        match &self.kind {
            TweenKind::Pair(both) => {
                let of = |side: usize| &layer.of(side, ends.scenes[side])[both.instances[side] as usize];
                let effects = Effects::aligned(Effects::of(of(0)), Effects::of(of(1)));
                let spot = ends.scenes[0].element(of(0)).spot(None).map(|spot| spot.0);
                Motion { id, shapes: MovingShape::with_effects(both.shapes(spot), effects), window: None }
            }
            TweenKind::Unmatched { side, instance, centre, window } => {
                let instance = &layer.of(*side, ends.scenes[*side])[*instance as usize];
                let element = ends.scenes[*side].element(instance);
                let (base, _) = element.paint(instance.colour);
                let details =
                    element.details().iter().filter(|d| !d.is_soft()).map(|d| (&d.outline, d.colour));
                let spot = element.spot(None).and_then(|(ellipse, _)| {
                    ellipse.resized(ellipse.profile.opaque_radius(), ellipse.profile)?.outline()
                });
                let outline = spot.as_ref().unwrap_or(&element.base().outline);
                let all = std::iter::once((outline, base)).chain(details);
                let moving = |(outline, colour): (&Outline, _)| {
                    MovingShape::resized(outline, instance.affine(), *centre, *side == 1, colour)
                };
                let own = Effects::of(instance);
                let effects = if *side == 1 { [own.shrunk(0.0), own] } else { [own, own.shrunk(0.0)] };
                let shapes = MovingShape::with_effects(all.map(moving).collect(), effects);
                Motion { id, shapes, window: Some(*window) }
            }
        }
    }

    /// Whether it is a matched pair.
    pub(super) fn is_pair(&self) -> bool {
        matches!(self.kind, TweenKind::Pair(_))
    }
}

impl MatchedTextons {
    /// Rotation at time `t` relative to the first and to the second end, in radians.
    fn turns(&self, t: f64) -> [f64; 2] {
        let turn = self.blend.turn();
        [turn * t, turn * (t - 1.0)]
    }

    /// Outline and details at the beginning, at half-time and at the end. `spot` is the ellipse that the element is.
    fn shapes(&self, spot: Option<&Ellipse>) -> Vec<MovingShape> {
        const TIMES: [f64; 3] = [0.0, 0.5, 1.0];
        let hulls = TIMES.map(|t| self.blend.at(t));
        let cages = hulls.each_ref().map(|hull| self.blend.cages(hull));
        let carries = [0, 1, 2].map(|k| Carry {
            cages: &cages[k],
            hull: &hulls[k],
            clips: false,
            scales: [1.0; 2],
            turns: self.turns(TIMES[k]),
        });
        let centres = TIMES.map(|t| self.centres[0].lerp(self.centres[1], t));
        let size = spot.map_or(1.0, |ellipse| ellipse.profile.opaque_radius());
        let outline = [0, 1, 2].map(|k| {
            let holes = self.holes.iter().map(|hole| hole.ring(&carries[k], TIMES[k]));
            let hull = hulls[k].iter().map(|p| (p.to_vec2() * size).to_point()).collect();
            std::iter::once(hull).chain(holes).collect()
        });
        let mut shapes = vec![MovingShape::new(outline, centres, self.paints.each_ref().map(|p| p.colour))];
        let mut order: Vec<(f64, &MovingDetail)> = self.details.iter().map(|d| (d.key(0.5), d)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let hard = order.iter().filter(|(_, patch)| patch.profile(0.5).is_none());
        shapes.extend(hard.map(|(_, patch)| {
            let rings = [0, 1, 2].map(|k| patch.rings(&carries[k], TIMES[k]));
            MovingShape::new(rings, centres, patch.colours())
        }));
        shapes
    }

    fn at(&self, ends: &Ends<'_>, layer: LayerPair, t: f64) -> Option<TweenContent> {
        let ring = self.blend.at(t);
        let scales = self.blend.scales(&ring);
        let turns = self.turns(t);
        let paint = {
            let carried = |side: usize| {
                let turn = sine_cosine(turns[side]);
                let there = |p: Point| (turned(p, turn).to_vec2() * scales[side]).to_point();
                self.paints[side].carried(there)
            };
            carried(0).mixed(&carried(1), t)
        };
        let mut rings: Vec<Ring> = Vec::new();
        let mut details = Vec::new();
        if !(self.holes.is_empty() && self.details.is_empty()) {
            let cages = self.blend.cages(&ring);
            let carry = Carry { cages: &cages, hull: &ring, clips: false, scales, turns };
            rings.extend(self.holes.iter().filter_map(|hole| hole.at(&carry, t)));
            let mut order: Vec<(f64, &MovingDetail)> = self.details.iter().map(|d| (d.key(t), d)).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            details.extend(order.iter().filter_map(|(_, patch)| patch.at(&carry, t)));
        }
        rings.insert(0, ring);
        let outline = Outline::along(&rings, TOLERANCE)?;
        let instances = [0, 1].map(|side| &layer.of(side, ends.scenes[side])[self.instances[side] as usize]);
        let side = usize::from(t >= 0.5);
        let nearer = ends.scenes[side].element(instances[side]);
        let opacities = [0, 1].map(|side| ends.scenes[side].element(instances[side]).base().opacity);
        let base = match nearer.spot(None) {
            Some((ellipse, _)) => Shape::soft_along(&outline, paint.colour, ellipse.profile)?,
            None => Shape { gradient: paint.gradient.map(Box::new), ..Shape::new(outline, paint.colour) },
        };
        let rims = [0, 1].map(|side| {
            let rim = ends.scenes[side].element(instances[side]).base().rim.as_ref()?;
            Some(rim.moved(instances[side].affine()))
        });
        let rim = SoftRim::mixed(rims[0].as_ref(), rims[1].as_ref(), t);
        let rim = rim.filter(|_| !base.is_soft()).map(Box::new);
        let base = Shape { opacity: opacities[0] + (opacities[1] - opacities[0]) * t, rim, ..base };
        let element = Element {
            library: ends.libraries[side][nearer.library.index()],
            source: nearer.source,
            category: nearer.category,
            fused: false,
            silhouette: None,
            shapes: std::iter::once(base).chain(details).collect(),
        };
        let at = self.centres[0].lerp(self.centres[1], t);
        let effects = Effects::mixed(Effects::of(instances[0]), Effects::of(instances[1]), t);
        Some(TweenContent::New { element, at, effects })
    }
}

/// The two scenes, and for each the indices of its libraries in the combined list.
pub(super) struct Ends<'a> {
    pub(super) scenes: [&'a Scene; 2],
    pub(super) libraries: [&'a [LibraryId]; 2],
}
