//! A scene drawn as Gaussians: every element becomes an ellipse of one colour.

use super::Scene;
use crate::element::Gaussian;
use image::{Rgb, RgbImage};
use vtex_base::geometry::{Affine, Point};
use vtex_base::raster::colour::Colour;

/// Longest side of the picture, in pixels.
const LONGEST: f64 = 1024.0;
/// Squared Mahalanobis distance from which a Gaussian is invisible: less than a 500th is left of it.
const FARTHEST: f64 = 6.25;

/// Draws every element as a Gaussian in its median colour, each over those painted before it (Tu,
/// dissertation, equations 4.11 to 4.14), on the background's fallback colour, else on white. Elements too thin
/// for a Gaussian are left out, copies across the borders too. At most 1024 pixels on the longer side.
pub fn splat(scene: &Scene) -> RgbImage {
    let [width, height] = [scene.width, scene.height].map(f64::from);
    let scale = (LONGEST / width.max(height)).min(1.0);
    let [width, height] = [width, height].map(|v| (libm::round(v * scale) as u32).max(1));
    let field = scene.layers.iter().find_map(|layer| layer.field.as_ref());
    let ground = field.map_or(Colour([255; 3]), |field| field.fallback).to_oklab();
    let seen = scene.gaussians().into_iter().zip(scene.appearances());
    let seen = seen.filter_map(|(g, a)| Some((g?.moved(Affine::scale(scale)), a.median)));
    let pixels = splatted(seen, ground, [width, height]);
    RgbImage::from_fn(width, height, |x, y| {
        let lab = pixels[y as usize * width as usize + x as usize];
        Rgb(Colour::from_oklab(lab.map(|v| v as f32)).0)
    })
}

/// Gaussians with three features each, in painting order, over a ground: the features of each pixel, at its
/// centre.
fn splatted(
    gaussians: impl Iterator<Item = (Gaussian, [f32; 3])>,
    ground: [f32; 3],
    [width, height]: [u32; 2],
) -> Vec<[f64; 3]> {
    let mut pixels = vec![ground.map(f64::from); width as usize * height as usize];
    for (gaussian, features) in gaussians {
        let [xx, _, yy] = gaussian.covariance;
        // The pixels whose centres lie within its reach, along an axis.
        let along = |mean: f64, variance: f64, end: u32| {
            let reach = libm::sqrt(FARTHEST * variance);
            let first = libm::ceil(mean - reach - 0.5).clamp(0.0, f64::from(end)) as u32;
            first..(libm::floor(mean + reach - 0.5) + 1.0).clamp(0.0, f64::from(end)) as u32
        };
        for y in along(gaussian.mean.y, yy, height) {
            for x in along(gaussian.mean.x, xx, width) {
                let opacity = gaussian.at(Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
                let pixel = &mut pixels[y as usize * width as usize + x as usize];
                (0..3).for_each(|k| pixel[k] += opacity * (f64::from(features[k]) - pixel[k]));
            }
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ElementId, Instance, InstanceId, testing};
    use vtex_base::geometry::{Outline, Vec2, parse_path};

    fn gaussian(x: f64, covariance: [f64; 3]) -> Gaussian {
        Gaussian { mean: Point::new(x, 10.0), covariance, direction: Vec2::new(1.0, 0.0) }
    }

    #[test]
    fn overlapping_gaussians_follow_the_formula() {
        let (a, b) = (gaussian(9.0, [30.0, 8.0, 12.0]), gaussian(14.0, [16.0, -3.0, 25.0]));
        let (red, blue, ground) = ([0.6_f32, 0.2, 0.1], [0.4_f32, -0.1, -0.2], [0.9_f32, 0.0, 0.0]);
        let size = [24, 20];
        let drawn = splatted([(a, red), (b, blue)].into_iter(), ground, size);
        let turned = splatted([(b, blue), (a, red)].into_iter(), ground, size);
        let mut differ = 0;
        for (i, (pixel, other)) in drawn.iter().zip(&turned).enumerate() {
            let at = Point::new((i % 24) as f64 + 0.5, (i / 24) as f64 + 0.5);
            // Equations 4.12 to 4.14. Values beyond the reach are left out, as in the drawing.
            let opacity = |g: &Gaussian| {
                let v = g.at(at);
                let [xx, _, yy] = g.covariance;
                let far = |way: f64, variance: f64| way * way > FARTHEST * variance;
                let out = far(at.x - g.mean.x, xx) || far(at.y - g.mean.y, yy);
                if out { 0.0 } else { v }
            };
            let (first, last) = (opacity(&a), opacity(&b));
            let left = (1.0 - first) * (1.0 - last);
            for k in 0..3 {
                let [r, b, g] = [red[k], blue[k], ground[k]].map(f64::from);
                let wanted = last * b + first * (1.0 - last) * r + left * g;
                assert!((pixel[k] - wanted).abs() < 1e-6, "{at:?} {k}");
                let swapped = first * r + last * (1.0 - first) * b + left * g;
                assert!((other[k] - swapped).abs() < 1e-6, "{at:?} {k}");
            }
            differ += usize::from((pixel[0] - other[0]).abs() > 0.01);
        }
        assert!(differ > 20, "the order of painting shows");
    }

    #[test]
    fn a_scene_becomes_a_picture_of_ellipses() {
        let square = Outline::new(&parse_path("M0 0h12v12h-12z").unwrap()).unwrap();
        let [red, white] = [[200, 30, 30], [255; 3]].map(Colour);
        let mut instance = Instance::new(InstanceId(0), ElementId(0));
        instance.transform = [1.0, 0.0, 0.0, 1.0, 20.5, 8.5];
        let scene = testing::scene(
            [60, 30],
            vec![testing::element(0, Some(0), square, red)],
            Vec::new(),
            vec![instance],
            testing::flat(white),
        );
        let picture = splat(&scene);
        assert_eq!(picture.dimensions(), (60, 30));
        let near = |x, y, wanted: Colour| {
            picture.get_pixel(x, y).0.iter().zip(wanted.0).all(|(a, b)| a.abs_diff(b) < 3)
        };
        assert!(near(26, 14, red) && near(2, 2, white) && !near(33, 14, red) && !near(33, 14, white));
        let large = Scene { width: 5000, height: 10, ..scene };
        assert_eq!(splat(&large).dimensions(), (1024, 2));
    }
}
