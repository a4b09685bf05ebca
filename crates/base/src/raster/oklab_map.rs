//! Affine maps of Oklab, by which colours are changed.

use super::colour::Colour;

/// An affine map of Oklab: each row makes a component of a new colour, of the three old ones and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OklabMap([[f32; 4]; 3]);

impl OklabMap {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    /// The same amount added to every colour.
    pub fn shift(by: [f32; 3]) -> Self {
        let mut map = Self::IDENTITY;
        (0..3).for_each(|i| map.0[i][3] = by[i]);
        map
    }

    /// A share (0 to 1) of one colour mixed into every other.
    pub fn mix(colour: [f32; 3], share: f32) -> Self {
        let mut map = Self::shift(colour.map(|v| v * share));
        (0..3).for_each(|i| map.0[i][i] = 1.0 - share);
        map
    }

    /// Hues turned by an angle in radians, chroma multiplied, lightness (0 to 1) added to.
    pub fn adjust(hue: f64, chroma: f64, lightness: f64) -> Self {
        let (sine, cosine) = libm::sincos(hue);
        let [s, c] = [sine * chroma, cosine * chroma].map(|v| v as f32);
        Self([[1.0, 0.0, 0.0, lightness as f32], [0.0, c, -s, 0.0], [0.0, s, c, 0.0]])
    }

    /// The colour that another becomes.
    pub fn of(&self, colour: Colour) -> Colour {
        if *self == Self::IDENTITY {
            return colour;
        }
        let [l, a, b] = colour.to_oklab();
        Colour::from_oklab(self.0.map(|[x, y, z, one]| x * l + y * a + z * b + one))
    }

    /// A key that is the same for equal maps.
    pub fn key(&self) -> [[u32; 4]; 3] {
        // Adding 0 turns -0 into 0.
        self.0.map(|row| row.map(|v| (v + 0.0).to_bits()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_move_mix_and_turn_colours() {
        let red = Colour([200, 40, 40]);
        let [l, a, b] = red.to_oklab();
        assert_eq!(OklabMap::IDENTITY.of(red), red);
        assert_eq!(OklabMap::shift([0.1, 0.0, 0.0]).of(red), Colour::from_oklab([l + 0.1, a, b]));
        let grey = Colour([128; 3]);
        assert_eq!(OklabMap::mix(grey.to_oklab(), 0.3).of(red), red.mixed(grey, 0.3));
        let pale = OklabMap::adjust(0.0, 0.0, 0.0).of(red).to_oklab();
        assert!((pale[0] - l).abs() < 0.005 && pale[1].abs() < 0.005 && pale[2].abs() < 0.005);
        let back = OklabMap::adjust(std::f64::consts::PI, 1.0, 0.0).of(Colour([120, 100, 100])).to_oklab();
        assert!(back[1] < 0.0);
        assert_eq!(OklabMap::shift([-0.0; 3]).key(), OklabMap::IDENTITY.key());
    }
}
