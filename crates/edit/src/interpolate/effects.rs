//! Interpolation of textons' shadows and strokes.

use vtex_base::geometry::Vec2;
use vtex_scene::scene::{Instance, Shadow, Stroke};

/// Shadow and stroke of a texton, with lengths in canvas pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Effects {
    pub(super) shadow: Option<Shadow>,
    pub(super) stroke: Option<Stroke>,
}

impl Effects {
    /// The effects of an instance, converted to canvas pixels.
    pub(super) fn of(instance: &Instance) -> Self {
        let Instance { shadow, stroke, .. } = *instance;
        let scale = libm::sqrt(instance.affine().determinant().abs());
        Self {
            shadow: shadow.map(|s| Shadow { blur: (s.blur * scale).min(Shadow::WIDEST), ..s }),
            stroke: stroke.map(|s| Stroke { width: (s.width * scale).min(Stroke::WIDEST), ..s }),
        }
    }

    /// Pair with the same effects. A missing shadow becomes one of opacity 0, a missing stroke one of
    /// width 0.
    pub(super) fn aligned(a: Self, b: Self) -> [Self; 2] {
        let shadow =
            |own: Option<Shadow>, other: Option<Shadow>| own.or(other.map(|s| Shadow { opacity: 0.0, ..s }));
        let stroke =
            |own: Option<Stroke>, other: Option<Stroke>| own.or(other.map(|s| Stroke { width: 0.0, ..s }));
        [(a, b), (b, a)].map(|(own, other)| Self {
            shadow: shadow(own.shadow, other.shadow),
            stroke: stroke(own.stroke, other.stroke),
        })
    }

    /// The effects at time `t` (0 to 1) between two. Colours are mixed in Oklab.
    pub(super) fn mixed(a: Self, b: Self, t: f64) -> Self {
        let [a, b] = Self::aligned(a, b);
        let between = |a: f64, b: f64| a + (b - a) * t;
        let shadow = a.shadow.zip(b.shadow).map(|(a, b)| Shadow {
            offset: [0, 1].map(|k| between(a.offset[k], b.offset[k])),
            opacity: between(a.opacity, b.opacity),
            blur: between(a.blur, b.blur),
        });
        let stroke = a
            .stroke
            .zip(b.stroke)
            .map(|(a, b)| Stroke { width: between(a.width, b.width), colour: a.colour.mixed(b.colour, t) });
        // Neither can be written if it is invisible.
        Self { shadow: shadow.filter(|s| s.opacity >= 0.002), stroke: stroke.filter(|s| s.width >= 0.005) }
    }

    /// The effects of a texton scaled by `size` (0 to 1): its shadow moves closer.
    pub(super) fn shrunk(&self, size: f64) -> Self {
        Self {
            shadow: self.shadow.map(|s| near(s, size)).map(|s| Shadow { blur: s.blur * size, ..s }),
            stroke: self.stroke.map(|s| Stroke { width: s.width * size, ..s }),
        }
    }
}

/// A shadow moved closer to its texton. Its blur is in the texton's pixels and scales with it.
pub(super) fn near(shadow: Shadow, size: f64) -> Shadow {
    Shadow { offset: shadow.offset.map(|v| v * size), ..shadow }
}

/// Offset of a shadow at half-time between two.
pub(super) fn half_way(a: &Shadow, b: &Shadow) -> Vec2 {
    (a.shift() + b.shift()) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::colour::Colour;
    use vtex_scene::scene::{ElementId, InstanceId};

    #[test]
    fn what_one_has_comes_and_goes_without_a_jump() {
        let instance = Instance {
            transform: [2.0, 0.0, 0.0, 2.0, 5.0, 5.0],
            shadow: Some(Shadow { offset: [4.0, 2.0], opacity: 0.6, blur: 3.0 }),
            stroke: Some(Stroke { width: 1.0, colour: Colour([200, 0, 0]) }),
            ..Instance::new(InstanceId(0), ElementId(0))
        };
        let (with, without) = (Effects::of(&instance), Effects::default());
        assert_eq!(Effects::mixed(with, without, 0.0), with);
        assert_eq!((with.shadow.unwrap().blur, with.stroke.unwrap().width), (6.0, 2.0));
        let half = Effects::mixed(without, with, 0.5);
        assert_eq!((half.shadow.unwrap().opacity, half.stroke.unwrap().width), (0.3, 1.0));
        assert_eq!(half.shadow.unwrap().offset, [4.0, 2.0]);
        assert_eq!(Effects::mixed(with, without, 1.0), without);
        let small = with.shrunk(0.5);
        assert_eq!((small.shadow.unwrap().offset, small.stroke.unwrap().width), ([2.0, 1.0], 1.0));
    }
}
