//! Soft shadows as vectors: a few translucent outlines, one inside the other.
//!
//! The outline is drawn on a small raster and blurred; the outlines are level lines of the blurred shape,
//! found at sub-pixel precision. Whatever the shape, they are those of a real blur: corners are rounded, gaps
//! and holes close. All formats paint the same outlines.

use super::paths::path_of;
use std::collections::BTreeMap;
use tiny_skia::{FillRule, Mask, Transform};
use vtex_base::geometry::{Affine, FittedMap, Outline, PlanarMap, Point, Scale, Vec2};
use vtex_base::parallel;
use vtex_base::raster::blur::Plane;
use vtex_scene::scene::{ElementId, Instance, Scene, Shadow};

/// Most outlines of a shadow.
const MOST_LAYERS: u32 = 8;
/// Largest difference in darkness between outlines that is not visible as a step.
const STEP: f64 = 0.075;
/// Pixels of the raster per width of the soft edge: the minimum, and the number for each outline. With these
/// no two lines lie between two pixels.
const PIXELS: [f64; 2] = [8.5, 1.7];
/// Largest side of the raster.
const LARGEST_SIDE: f64 = 600.0;
/// Deviation of the blur, as a share of the width of the soft edge.
const DEVIATION: f64 = 0.25;
/// Largest distance of outlines from the level lines, in pixels of the raster.
const TOLERANCE: f64 = 0.35;

/// One of a shadow's nested outlines.
pub(super) struct ShadowOutline {
    /// In the element's coordinates.
    pub(super) outline: Outline,
    /// Opacity of this outline alone.
    pub(super) opacity: f64,
}

/// Element, blur and opacity.
pub(super) type Key = (ElementId, u64, u64);

/// The key of a shadow's shape, which instances at different places share.
pub(super) fn key(instance: &Instance, shadow: &Shadow) -> Key {
    (instance.element, shadow.blur.to_bits(), shadow.opacity.to_bits())
}

/// All different shadows of a scene, with the layers of each from the widest to the narrowest.
pub(super) struct Shadows(BTreeMap<Key, Vec<ShadowOutline>>);

impl Shadows {
    pub(super) fn new(scene: &Scene) -> Self {
        let mut wanted: BTreeMap<Key, Shadow> = BTreeMap::new();
        for instance in scene.instances() {
            if let Some(shadow) = instance.shadow {
                wanted.insert(key(instance, &shadow), shadow);
            }
        }
        let wanted: Vec<(Key, Shadow)> = wanted.into_iter().collect();
        let layers = parallel::map(&wanted, |(key, shadow)| {
            layers(scene.elements[key.0.index()].outline(), shadow.blur, shadow.opacity)
        });
        Self(wanted.into_iter().map(|(key, _)| key).zip(layers).collect())
    }

    /// The layers of each different shadow.
    pub(super) fn all(&self) -> impl Iterator<Item = (Key, &[ShadowOutline])> {
        self.0.iter().map(|(key, layers)| (*key, &layers[..]))
    }

    /// The layers of an instance's shadow.
    pub(super) fn of(&self, instance: &Instance, shadow: &Shadow) -> &[ShadowOutline] {
        self.0.get(&key(instance, shadow)).map_or(&[], Vec::as_slice)
    }
}

fn layers(outline: &Outline, blur: f64, opacity: f64) -> Vec<ShadowOutline> {
    let sharp = || vec![ShadowOutline { outline: outline.clone(), opacity }];
    let bounds = outline.bounds().inflate(blur, blur);
    let longest = bounds.width().max(bounds.height());
    let count = (libm::round(blur / 2.0) + 2.0).min(libm::ceil(opacity / STEP).max(1.0));
    let count = (count as u32).min(MOST_LAYERS);
    let pixel = (blur / (PIXELS[1] * f64::from(count)).max(PIXELS[0])).max(longest / LARGEST_SIDE);
    // A soft edge of less than two pixels of the raster is invisible on a shape of this size.
    if blur < 0.3 || blur < 2.0 * pixel {
        return sharp();
    }
    let size = [bounds.width(), bounds.height()].map(|v| libm::ceil(v / pixel) as usize + 2);
    let origin = Point::new(bounds.x0 - pixel, bounds.y0 - pixel);
    let Some(strength) = Strength::new(outline, size, origin, pixel, DEVIATION * blur / pixel) else {
        return sharp();
    };
    let level = |k: u32| (f64::from(k) - 0.5) / f64::from(count);
    let labels: Vec<u32> = strength
        .0
        .values
        .iter()
        .map(|v| (libm::floor(f64::from(*v) * f64::from(count) + 0.5)) as u32)
        .collect();
    let map = PlanarMap::trace(size[0] as u32, size[1] as u32, &labels);
    let fitted = FittedMap::with_edges(
        map,
        Scale { tolerance: TOLERANCE, cells: 1.0 },
        count as usize,
        count as usize,
        |l| l,
        |p, n, a, b| strength.distance(p, n, level(a.min(b) + 1).midpoint(level(a.max(b)))),
    );
    let back = Affine::translate(origin.to_vec2()) * Affine::scale(pixel);
    let mut before = 0.0;
    let mut layers = Vec::new();
    for k in 1..=count {
        let Some(traced) =
            fitted.outlines(1, |l| u32::from(l != vtex_base::geometry::OUTSIDE && l >= k)).pop()
        else {
            continue;
        };
        // The combined darkness of the outlines up to this one.
        let together = opacity * f64::from(k) / f64::from(count);
        let alone = 1.0 - (1.0 - together) / (1.0 - before);
        before = together;
        if let Some(outline) = Outline::new(&(back * traced.path())).filter(|o| !o.is_empty()) {
            layers.push(ShadowOutline { outline, opacity: alone.clamp(0.0, 1.0) });
        }
    }
    layers
}

/// The blurred shape on a raster: 0 outside, 1 well inside.
struct Strength(Plane);

impl Strength {
    fn new(
        outline: &Outline,
        [width, height]: [usize; 2],
        origin: Point,
        pixel: f64,
        deviation: f64,
    ) -> Option<Self> {
        let path = path_of(outline)?;
        let mut mask = Mask::new(width as u32, height as u32)?;
        let scale = (1.0 / pixel) as f32;
        let shift = [-origin.x / pixel, -origin.y / pixel].map(|v| v as f32);
        let transform = Transform::from_row(scale, 0.0, 0.0, scale, shift[0], shift[1]);
        mask.fill_path(&path, FillRule::Winding, true, transform);
        let values = mask.data().iter().map(|v| f32::from(*v) / 255.0).collect();
        Some(Self(Plane { size: [width, height], values }.blurred(deviation as f32, [false; 2])))
    }

    /// Bilinear between the centres of pixels.
    fn at(&self, p: Point) -> f64 {
        let axis = |v: f64, count: usize| {
            let v = (v - 0.5).clamp(0.0, (count - 1) as f64);
            let low = (v as usize).min(count.saturating_sub(2));
            (low, (low + 1).min(count - 1), v - low as f64)
        };
        let [width, height] = self.0.size;
        let ((x0, x1, u), (y0, y1, v)) = (axis(p.x, width), axis(p.y, height));
        let value = |x: usize, y: usize| f64::from(self.0.at(x, y));
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        mix(mix(value(x0, y0), value(x1, y0), u), mix(value(x0, y1), value(x1, y1), u), v)
    }

    /// The distance along a normal at which the strength is `level`, at most a pixel.
    fn distance(&self, p: Point, normal: Vec2, level: f64) -> f64 {
        let (before, after) = (self.at(p - normal), self.at(p + normal));
        let slope = (after - before) / 2.0;
        if slope.abs() < 1e-3 { 0.0 } else { ((level - self.at(p)) / slope).clamp(-0.8, 0.8) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Shape;
    use vtex_base::geometry::parse_path;

    fn of(text: &str, blur: f64) -> Vec<ShadowOutline> {
        layers(&Outline::new(&parse_path(text).unwrap()).unwrap(), blur, 0.5)
    }

    /// The darkness at a point, all layers together.
    fn darkness(layers: &[ShadowOutline], p: (f64, f64)) -> f64 {
        let over = layers.iter().filter(|l| l.outline.path().winding(p.into()) != 0);
        1.0 - over.fold(1.0, |light, l| light * (1.0 - l.opacity))
    }

    #[test]
    fn strength_falls_across_the_edge_as_far_as_the_blur_is_wide() {
        let layers = of("M0 0h60v60h-60z", 8.0);
        assert!(layers.len() >= 4);
        let at = |x: f64| darkness(&layers, (x, 30.3));
        assert!((at(30.0) - 0.5).abs() < 1e-6 && at(-8.0) == 0.0);
        assert!((at(0.0) - 0.25).abs() < 0.1);
        let along: Vec<f64> = (0..160).map(|k| at(f64::from(k) / 10.0 - 8.0)).collect();
        assert!(along.windows(2).all(|w| w[0] <= w[1]));
        assert!(along.windows(2).all(|w| w[1] - w[0] < 0.11), "it falls in small steps");
        // Corners are rounded.
        assert!(darkness(&layers, (0.5, 0.5)) < at(0.5));
    }

    #[test]
    fn dark_wide_shadows_fall_in_small_steps_and_faint_ones_have_few() {
        let shape = Outline::new(&parse_path("M0 0h60v60h-60z").unwrap()).unwrap();
        let dark = layers(&shape, 16.0, 0.6);
        let along: Vec<f64> = (0..320).map(|k| darkness(&dark, (f64::from(k) / 10.0 - 16.0, 30.3))).collect();
        assert!(along.windows(2).all(|w| (0.0..=STEP + 1e-9).contains(&(w[1] - w[0]))));
        assert!(layers(&shape, 16.0, 0.1).len() <= 2 && layers(&shape, 16.0, 0.0).len() <= 1);
    }

    #[test]
    fn sharp_tiny_and_strange_shapes_have_a_shadow_or_none() {
        assert_eq!(of("M0 0h6v6h-6z", 0.0).len(), 1);
        assert!(darkness(&of("M0 0h2v2h-2z", 4.0), (1.0, 1.0)) > 0.0);
        assert!(of("M0 0h900v900h-900z", 1.0).len() == 1, "an edge too soft to be seen");
        of("M0 0h1z", 3.0);
        of("", 3.0);
        let holed = of("M0 0h40v40h-40zM10 10v20h20v-20z", 3.0);
        assert!(darkness(&holed, (20.0, 20.0)) == 0.0 && darkness(&holed, (5.0, 20.0)) > 0.4);
    }
}
