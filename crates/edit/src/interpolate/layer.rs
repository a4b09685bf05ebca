//! Interpolation of layers. Layers are paired by role and name; one without a partner grows from nothing,
//! its region included.

use super::background::BlendedField;
use super::correspond::{Matching, MatchingPlane, Properties, correspond};
use super::region::{Extent, RegionTween};
use super::side::Side;
use super::tween::Tween;
use vtex_base::geometry::shortest_offset;
use vtex_base::parallel;
use vtex_base::sampling::stream;
use vtex_scene::scene::{Instance, Layer, Role, Scene};

/// A layer of the first scene and the one of the second that it becomes, by index; `None` on a side
/// without such a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LayerPair(pub(super) [Option<usize>; 2]);

impl LayerPair {
    /// Its layer in the scene of a side.
    pub(super) fn layer(self, side: usize, scene: &Scene) -> Option<&Layer> {
        self.0[side].map(|k| &scene.layers[k])
    }

    /// Its instances in the scene of a side, in painting order.
    pub(super) fn of(self, side: usize, scene: &Scene) -> &[Instance] {
        self.layer(side, scene).map_or(&[], |layer| &layer.instances)
    }

    /// The pairs of two scenes, in painting order: layers of one role with the same name, others of one
    /// role in their order. A layer without a partner is paired with nothing.
    pub(super) fn all(scenes: [&Scene; 2]) -> Vec<Self> {
        let [from, to] = scenes.map(|s| &s.layers[..]);
        let mut partners: Vec<Option<usize>> = vec![None; from.len()];
        let mut taken = vec![false; to.len()];
        for by_name in [true, false] {
            for (k, layer) in
                from.iter().enumerate().filter(|(k, _)| partners[*k].is_none()).collect::<Vec<_>>()
            {
                let fits = |other: &Layer| other.role == layer.role && (!by_name || other.name == layer.name);
                partners[k] = (0..to.len()).find(|&j| !taken[j] && fits(&to[j]));
                partners[k].into_iter().for_each(|j| taken[j] = true);
            }
        }
        let mut pairs: Vec<Self> = partners.iter().enumerate().map(|(k, j)| Self([Some(k), *j])).collect();
        // Others come right after the layer that they follow in their scene.
        for j in (0..to.len()).filter(|&j| !taken[j]) {
            let before = j.checked_sub(1).and_then(|b| pairs.iter().position(|p| p.0[1] == Some(b)));
            pairs.insert(before.map_or(0, |at| at + 1), Self([None, Some(j)]));
        }
        pairs
    }
}

/// A layer that changes over time.
pub(super) struct LayerTween {
    pub(super) pair: LayerPair,
    pub(super) name: String,
    pub(super) role: Role,
    /// Number of elements in the layers below it.
    pub(super) first: usize,
    pub(super) tweens: Vec<Tween>,
    pub(super) field: Option<BlendedField>,
    pub(super) region: Option<RegionTween>,
}

impl LayerTween {
    /// The tweens of a pair of layers, above `first` elements. `number` is the pair's place among those
    /// of its role.
    pub(super) fn new(sides: &[Side<'_>; 2], pair: LayerPair, number: usize, first: usize) -> Self {
        let scenes = [0, 1].map(|k| sides[k].scene);
        let layers = [0, 1].map(|k| pair.layer(k, scenes[k]));
        let named = layers[0].or(layers[1]);
        let role = named.map_or(Role::Primary, |layer| layer.role);
        let canvas = [scenes[0].width, scenes[0].height].map(f64::from);
        let fields = layers.map(|layer| layer.and_then(|l| l.field.as_ref()));
        let extents = layers.map(|layer| match layer {
            None => Extent::Nothing,
            Some(layer) => layer.region.as_ref().map_or(Extent::Whole, Extent::Of),
        });
        Self {
            pair,
            name: named.map_or(String::new(), |layer| layer.name.clone()),
            role,
            first,
            tweens: tweens(sides, pair, role, number),
            // On a side without a field the layer has that of the other side.
            field: match fields {
                [None, None] => None,
                [from, to] => from.or(to).zip(to.or(from)).map(|(a, b)| BlendedField::new(scenes[0], [a, b])),
            },
            // Elements without a partner grow and shrink by themselves; fields need a region for it.
            region: if fields == [None, None] && extents.iter().all(|e| !matches!(e, Extent::Of(_))) {
                None
            } else {
                RegionTween::new(canvas, extents)
            },
        }
    }
}

/// The tweens of all elements of a pair of layers.
fn tweens(sides: &[Side<'_>; 2], pair: LayerPair, role: Role, number: usize) -> Vec<Tween> {
    let scene = sides[0].scene;
    let (width, height) = (f64::from(scene.width), f64::from(scene.height));
    let periods = scene.tile.periods([width, height]);
    let plane = MatchingPlane { area: width * height, periods };
    let properties: [Vec<Properties>; 2] =
        [0, 1].map(|k| parallel::map(pair.of(k, sides[k].scene), |i| sides[k].properties(i)));
    let Matching { pairs, unmatched } = correspond(&properties[0], &properties[1], &plane);
    let key = |k: u32| (number as u64) << 32 | u64::from(k);
    let one = |side: usize, k: u32| {
        let name = format!("interpolate/{}/{}", role.name(), ["first", "second"][side]);
        Tween::unmatched(sides, side, pair, k, &mut stream(0, &name, key(k)))
    };
    let paired = parallel::map(&pairs, |&[i, k]| {
        let offset =
            shortest_offset(properties[0][i as usize].at, properties[1][k as usize].at, plane.periods);
        let random = &mut stream(0, "interpolate/details", key(i));
        match Tween::pair(sides, pair, [i, k], offset, random) {
            Some(tween) => vec![tween],
            None => vec![one(0, i), one(1, k)],
        }
    });
    let mut tweens: Vec<Tween> = paired.into_iter().flatten().collect();
    for side in 0..2 {
        tweens.extend(unmatched[side].iter().map(|&k| one(side, k)));
    }
    tweens
}
