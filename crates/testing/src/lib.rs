//! Procedural texture scenes with exact background truth: an image, and which pixel belongs to which
//! element.
//!
//! Stone chips, pebbles, leaves, flowers, flakes and blades are scattered or packed on noisy and
//! granular backgrounds. Elements vary internally (mottling, streaks, veins, facets, doming, ribs,
//! shadows), and their contrast to the background ranges from strong to almost none. Small grains,
//! and the grass of lawns, count as background: they have no label. The same parameters give the
//! same bytes on every machine.
//!
//! Scenes serve as test data, training data and examples. They are seen from straight above under
//! one light; perspective, specular light and depth of field are not simulated.

mod background;
mod camera;
mod elements;
mod fills;
mod layout;
mod noise;
mod render;
mod scenes;
mod shapes;
mod stopping;

pub use stopping::{StopAfter, StopAtOnce};

use image::RgbImage;
use vtex_base::error::{Result, check};
use vtex_base::raster::LabelMap;
use vtex_base::sampling::stream;

/// The kind of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneKind {
    /// Coloured stone chips, cut flat, in a smooth binder with small crumbs.
    Terrazzo,
    /// A few flakes and stones on a granular, sandy background.
    Concrete,
    /// Broken stone cast edge to edge, as in worktops and granite.
    Worktop,
    /// Crushed, faceted stones, overlapping or side by side.
    Gravel,
    /// Round stones on sand.
    Pebbles,
    /// Stones in mud of the same colour.
    MudStones,
    /// Autumn leaves, simple or lobed, on soil or grass.
    Leaves,
    /// Small, dull, crumpled leaves on dark soil.
    Litter,
    /// Flowers and heads of many petals in a lawn.
    Flowers,
    /// Rough-edged patches: rust, lichen, peeling paint.
    Flakes,
    /// Straw, needles, blades of grass.
    Blades,
    /// Leaves and blades in many overlapping layers, with a few flower heads.
    Meadow,
    /// A mixture of the other kinds' forms, fills, colours, backgrounds and layouts.
    Mixed,
}

impl SceneKind {
    /// All kinds.
    pub const ALL: [Self; 13] = [
        Self::Terrazzo,
        Self::Concrete,
        Self::Worktop,
        Self::Gravel,
        Self::Pebbles,
        Self::MudStones,
        Self::Leaves,
        Self::Litter,
        Self::Flowers,
        Self::Flakes,
        Self::Blades,
        Self::Meadow,
        Self::Mixed,
    ];

    /// Usual range of coverage of the kind.
    fn usual_coverage(self) -> [f64; 2] {
        match self {
            Self::Terrazzo => [0.3, 0.7],
            Self::Concrete => [0.03, 0.4],
            Self::Worktop => [0.5, 0.85],
            Self::Gravel => [0.7, 0.95],
            Self::Pebbles => [0.2, 0.85],
            Self::MudStones => [0.06, 0.4],
            Self::Leaves => [0.15, 0.9],
            Self::Litter => [0.2, 0.7],
            Self::Flowers => [0.05, 0.35],
            Self::Flakes => [0.1, 0.6],
            Self::Blades => [0.3, 0.85],
            Self::Meadow => [0.4, 0.8],
            Self::Mixed => [0.1, 0.8],
        }
    }
}

/// Parameters of a scene. Everything else (colours, forms, fills, light) follows from kind and seed.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneParams {
    /// Width in pixels, 1 to 16384. Default 512.
    pub width: u32,
    /// Height in pixels, 1 to 16384. Default 512.
    pub height: u32,
    /// Seed of all random choices. Default 0.
    pub seed: u64,
    /// Kind of the scene. Default [`SceneKind::Terrazzo`].
    pub kind: SceneKind,
    /// Share of the image that elements cover, 0 to 0.95. Layouts without overlap may not reach a high
    /// value. Default 0.5.
    pub coverage: f64,
    /// Contrast between the elements' colours and the background's: 1 keeps the palette, 0 gives all
    /// elements the background's mean colour, so only fill and light distinguish them. Default 1.
    pub contrast: f64,
    /// Diameter of the largest elements in pixels (of circles of the same area), 8 to 400. The smallest
    /// measure a half to a sixth of it. Default 48.
    pub size: f64,
    /// Standard deviation of the lens blur in pixels, 0 to 4. Default 0.5.
    pub blur: f64,
    /// Standard deviation of the sensor noise in 8-bit levels, 0 to 32. Default 2.
    pub noise: f64,
}

impl Default for SceneParams {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            seed: 0,
            kind: SceneKind::Terrazzo,
            coverage: 0.5,
            contrast: 1.0,
            size: 48.0,
            blur: 0.5,
            noise: 2.0,
        }
    }
}

impl SceneParams {
    /// Random parameters: any kind, sparse to packed, low to high contrast, with elements of about 30 to
    /// several thousand square pixels. Width and height in pixels.
    pub fn random(seed: u64, width: u32, height: u32) -> Self {
        let random = &mut stream(seed, "procedural/params", 0);
        // Mixed scenes are the most varied, so one in four is mixed.
        let kind = if random.chance(0.25) {
            SceneKind::Mixed
        } else {
            SceneKind::ALL[random.index(SceneKind::ALL.len() - 1)]
        };
        let [low, high] = kind.usual_coverage();
        let contrast = if random.chance(0.3) { random.range(0.15, 0.6) } else { random.range(0.6, 1.0) };
        let largest = f64::from(width.min(height)).clamp(24.0, 260.0) * 0.45;
        let octaves = libm::log2(largest / 12.0).max(0.0);
        Self {
            width,
            height,
            seed,
            kind,
            coverage: random.range(low, high),
            contrast,
            size: 12.0 * libm::exp2(octaves * random.unit()),
            blur: random.range(0.2, 1.0),
            noise: random.range(0.5, 6.0),
        }
    }

    fn validate(&self) -> Result<()> {
        let side = 1..=16_384;
        check(side.contains(&self.width), "width", self.width, "1 to 16384 pixels")?;
        check(side.contains(&self.height), "height", self.height, "1 to 16384 pixels")?;
        check((0.0..=0.95).contains(&self.coverage), "coverage", self.coverage, "0 to 0.95")?;
        check((0.0..=1.0).contains(&self.contrast), "contrast", self.contrast, "0 to 1")?;
        check((8.0..=400.0).contains(&self.size), "size", self.size, "8 to 400 pixels")?;
        check((0.0..=4.0).contains(&self.blur), "blur", self.blur, "0 to 4 pixels")?;
        check((0.0..=32.0).contains(&self.noise), "noise", self.noise, "0 to 32 levels")
    }
}

/// A generated scene: the image and its background truth.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedExemplar {
    /// The image.
    pub image: RgbImage,
    /// Label of the element visible at each pixel, numbered from 1 without gaps; 0 is background. An element
    /// that others cut in two keeps a single number.
    pub instances: LabelMap,
}

/// Generates a scene.
///
/// # Errors
/// [`vtex_base::Error::Parameter`] if a parameter is out of its range.
///
/// # Example
/// ```
/// use vtex_testing::{SceneKind, SceneParams, generate};
///
/// let params = SceneParams { kind: SceneKind::Pebbles, width: 64, height: 48, size: 16.0, ..Default::default() };
/// let scene = generate(&params)?;
/// assert_eq!(scene.image.dimensions(), (64, 48));
/// assert!(scene.instances.labels.iter().any(|&label| label > 0));
/// # Ok::<(), vtex_base::Error>(())
/// ```
pub fn generate(params: &SceneParams) -> Result<GeneratedExemplar> {
    params.validate()?;
    let scene = scenes::Composition::of(params);
    let (width, height) = (params.width as usize, params.height as usize);
    let mut canvas = render::Canvas::new(width, height, scene.light);
    let random = &mut stream(params.seed, "procedural/elements", 0);
    layout::grow(&scene, scene.above, &mut canvas, random);
    layout::place(&scene, params.coverage, &mut canvas, random);
    layout::grow(&scene, scene.below, &mut canvas, random);
    canvas.fill(&scene.background);

    let random = &mut stream(params.seed, "procedural/camera", 0);
    let camera = camera::Camera {
        gradient: [random.range(-0.12, 0.12) as f32, random.range(-0.12, 0.12) as f32],
        vignette: random.range(0.0, 0.12) as f32,
        blur: params.blur as f32,
        tone: random.range(-0.1, 0.15) as f32,
        noise: params.noise as f32,
        seed: random.bits() as u32,
    };
    let instances = canvas.instances();
    let image = camera.take(canvas.colours, width, height);
    Ok(GeneratedExemplar { image, instances })
}

#[cfg(test)]
mod tests;
