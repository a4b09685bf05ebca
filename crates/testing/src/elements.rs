//! Kinds of elements: form, colours and fill.

use super::fills::{ElementFill, Light, Style};
use super::render::PlacedShape;
use super::shapes::LocalOutline;
use std::f64::consts::TAU;
use vtex_base::sampling::Stream;

/// The form of an element.
#[derive(Clone, Debug)]
pub(super) enum ElementForm {
    /// Straight-sided broken stone.
    Chip { corners: [u32; 2], stretch: f32, rounding: f32 },
    /// Rounded stone, or a blot if `wobble` is large.
    Pebble { wobble: f32, stretch: f32 },
    /// Simple leaf, petal, needle or blade.
    Leaf { ratio: f32, fullness: f32, bend: f32, serration: f32 },
    /// Maple-like leaf.
    Lobed { lobes: u32, depth: f32, serration: f32 },
    /// Flower of joined petals, or a clover leaf.
    Star { petals: [u32; 2], pointed: f32, gap: f32 },
    /// Head of many separate petals.
    Head { petals: [u32; 2] },
}

/// A kind of element.
#[derive(Clone, Debug)]
pub(super) struct ElementKind {
    pub(super) form: ElementForm,
    pub(super) palette: Vec<Light>,
    pub(super) style: Style,
    /// Amplitude of the noise on the outline, as a share of the radius.
    pub(super) roughness: f32,
}

impl ElementKind {
    /// The parts of a random element around the origin, randomly rotated. `radius` is that of a circle of
    /// the same area, in pixels.
    pub(super) fn make(&self, radius: f32, label: u32, random: &mut Stream) -> Vec<PlacedShape> {
        let colour = self.colour(random);
        if let ElementForm::Head { petals } = self.form {
            return self.head(radius, petals, colour, label, random);
        }
        let mut vary = |v: f32| v * random.range(0.8, 1.25) as f32;
        let shape = match self.form {
            ElementForm::Chip { corners, stretch, rounding } => {
                let stretch = 1.0 + (stretch - 1.0) * vary(1.0);
                LocalOutline::chip(radius, corners, stretch, rounding, random)
            }
            ElementForm::Pebble { wobble, stretch } => {
                let stretch = 1.0 + (stretch - 1.0) * vary(1.0);
                LocalOutline::pebble(radius, wobble, stretch, random)
            }
            ElementForm::Leaf { ratio, fullness, bend, serration } => {
                let (ratio, bend) = (vary(ratio), vary(bend) * random.range(-1.0, 1.0) as f32);
                LocalOutline::leaf(radius, ratio, fullness, bend, serration, 18)
            }
            ElementForm::Lobed { lobes, depth, serration } => {
                LocalOutline::lobed(radius, lobes, vary(depth).min(0.8), serration, random)
            }
            ElementForm::Star { petals, pointed, gap } => {
                let n = petals[0] + random.below(u64::from(petals[1] - petals[0] + 1)) as u32;
                LocalOutline::star(radius, n, pointed, gap, random)
            }
            ElementForm::Head { .. } => return Vec::new(),
        };
        vec![self.element(shape, radius, colour, random.range(0.0, TAU), label, random)]
    }

    /// An element with an outline given by the layout.
    pub(super) fn fill(
        &self,
        shape: LocalOutline,
        radius: f32,
        label: u32,
        random: &mut Stream,
    ) -> PlacedShape {
        let colour = self.colour(random);
        self.element(shape, radius, colour, 0.0, label, random)
    }

    fn colour(&self, random: &mut Stream) -> Light {
        self.palette.get(random.index(self.palette.len())).copied().unwrap_or([0.2; 3])
    }

    /// An element around the origin.
    fn element(
        &self,
        shape: LocalOutline,
        radius: f32,
        colour: Light,
        turn: f64,
        label: u32,
        random: &mut Stream,
    ) -> PlacedShape {
        let fill = ElementFill::new(&self.style, colour, radius, random);
        let shape = if self.roughness > 0.0 {
            let wavelength = (radius * 0.45).max(2.5);
            shape.roughened(self.roughness * radius, wavelength, random.bits() as u32)
        } else {
            shape
        };
        let centre = [0.0, 0.0];
        PlacedShape { shape, fill, centre, turn: [libm::cos(turn) as f32, libm::sin(turn) as f32], label }
    }

    /// A flower head: petals in two or three rings, inner ones on top, with a common label.
    fn head(
        &self,
        radius: f32,
        petals: [u32; 2],
        colour: Light,
        label: u32,
        random: &mut Stream,
    ) -> Vec<PlacedShape> {
        let n = petals[0] + random.below(u64::from(petals[1] - petals[0] + 1)) as u32;
        let lean = [random.range(-0.2, 0.2) as f32 * radius, random.range(-0.2, 0.2) as f32 * radius];
        let mut parts = Vec::new();
        for ring in [0.35, 0.62, 0.9] {
            let count = ((f64::from(n) * ring) as u32).max(3);
            let start = random.range(0.0, TAU);
            for k in 0..count {
                let turn = start + (f64::from(k) + random.range(-0.3, 0.3)) / f64::from(count) * TAU;
                let reach = radius * (ring * random.range(0.85, 1.15)) as f32;
                let length = radius * random.range(0.42, 0.6) as f32;
                // Radius of a circle with the area of a petal of that half length.
                let size = length * 0.48;
                let shape = LocalOutline::leaf(size, random.range(2.6, 3.8) as f32, 0.62, 0.1, 0.0, 1);
                let (c, s) = (libm::cos(turn) as f32, libm::sin(turn) as f32);
                let centre =
                    [lean[0] * (1.0 - ring as f32) + c * reach, s * reach + lean[1] * (1.0 - ring as f32)];
                let tone = colour.map(|v| v * (1.15 - 0.45 * (1.0 - ring as f32)));
                parts.push(PlacedShape { centre, ..self.element(shape, size, tone, turn, label, random) });
            }
        }
        parts
    }
}
