//! Picture → outline: the smooth border of what is white, or opaque.

use super::picture;
use crate::error::{Error, Result};
use crate::geometry::{Affine, FittedMap, Outline, PlanarMap};

/// Small masks are enlarged to this side before they are traced, so that soft borders are followed
/// more finely than to their pixels.
const FINE_SIDE: u32 = 1024;
/// Most times that a mask is enlarged.
const MOST_ENLARGED: u32 = 8;
/// How far the outline may lie from the border between the pixels, in pixels of the mask.
const TOLERANCE: f64 = 0.4;

/// The outline of what is white in a picture, at least half, stretched over a canvas of `width` ×
/// `height` pixels. In a picture that is transparent anywhere, what is opaque counts instead,
/// whatever its colour.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`]; [`Error::Control`] if nothing is inside.
pub fn mask(bytes: &[u8], name: &str, [width, height]: [u32; 2]) -> Result<Outline> {
    let grey = picture::grey(&picture::read(bytes, name)?);
    let channel = usize::from(grey.pixels().any(|p| p.0[1] < u16::MAX));
    let share = |x, y| f32::from(grey.get_pixel(x, y).0[channel]) / f32::from(u16::MAX);
    let empty = || Error::Control {
        name: name.into(),
        role: "a mask",
        reason: if channel == 0 { "nothing in it is white" } else { "nothing in it is opaque" }.into(),
        advice: "white is inside and black outside; in a picture with transparency, opaque is inside",
    };
    let map = picture::map(grey.width(), grey.height(), share).ok_or_else(empty)?;
    let [columns, rows] = map.size();
    let fine = (FINE_SIDE / columns.max(rows)).clamp(1, MOST_ENLARGED);
    let (across, down) = (columns * fine, rows * fine);
    let mut labels = Vec::with_capacity(across as usize * down as usize);
    for y in 0..down {
        let row = (0..across).map(|x| {
            let centre = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            u32::from(map.at(centre, [f64::from(across), f64::from(down)]) >= 0.5)
        });
        labels.extend(row);
    }
    let planar = PlanarMap::trace(across, down, &labels);
    drop(labels);
    let fitted = FittedMap::new(planar, TOLERANCE * f64::from(fine), 1, 1, |label| label);
    let traced = fitted.outlines(1, |label| label).swap_remove(1);
    let stretch =
        Affine::scale_non_uniform(f64::from(width) / f64::from(across), f64::from(height) / f64::from(down));
    let outline = Outline::new(&(stretch * traced.path())).unwrap_or_default();
    if outline.area() >= 1.0 { Ok(outline) } else { Err(empty()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::picture::testing::encode;
    use crate::geometry::{Rect, is_simple};
    use image::{DynamicImage, GrayImage, Luma, Rgba, RgbaImage};

    /// How much of each pixel lies in a disc of radius 20 about (32, 32), 0 to 255.
    fn disc(x: u32, y: u32) -> u8 {
        let (dx, dy) = (f64::from(x) - 31.5, f64::from(y) - 31.5);
        ((20.5 - libm::sqrt(dx * dx + dy * dy)).clamp(0.0, 1.0) * 255.0) as u8
    }

    #[test]
    fn a_small_soft_disc_becomes_a_round_one() {
        let picture = DynamicImage::from(GrayImage::from_fn(64, 64, |x, y| Luma([disc(x, y)])));
        let outline = mask(&encode(picture), "m.png", [1600, 1600]).unwrap();
        let radius = 500.0;
        assert!((outline.area() / (std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.01);
        assert!(outline.compactness() > 0.995, "{}", outline.compactness());
        assert!(is_simple(outline.path()));
        for point in outline.path().segments().map(|s| kurbo::ParamCurve::eval(&s, 0.37)) {
            let distance = libm::hypot(point.x - 800.0, point.y - 800.0);
            // A quarter of a pixel of the mask.
            assert!((distance - radius).abs() < 25.0 / 4.0, "{distance}");
        }
    }

    #[test]
    fn straight_edges_stay_and_holes_are_kept() {
        let picture = GrayImage::from_fn(40, 20, |x, y| {
            let hole = (10..16).contains(&x) && (5..9).contains(&y);
            Luma([if x < 30 && !hole { 255 } else { 0 }])
        });
        let outline = mask(&encode(picture.into()), "m.png", [400, 100]).unwrap();
        assert_eq!(outline.bounds(), Rect::new(0.0, 0.0, 300.0, 100.0));
        let area = 300.0 * 100.0 - 60.0 * 20.0;
        assert!((outline.area() - area).abs() < 0.01 * area, "{}", outline.area());
    }

    #[test]
    fn opacity_counts_where_there_is_any() {
        let black = RgbaImage::from_fn(64, 64, |x, y| Rgba([0, 0, 0, disc(x, y)]));
        let white = GrayImage::from_fn(64, 64, |x, y| Luma([disc(x, y)]));
        let [a, b] =
            [DynamicImage::from(black), white.into()].map(|i| mask(&encode(i), "m.png", [64, 64]).unwrap());
        assert_eq!(a, b);
    }

    #[test]
    fn nothing_inside_is_told() {
        let error = mask(&encode(GrayImage::new(8, 8).into()), "m.png", [64, 64]).unwrap_err();
        assert!(error.to_string().contains("nothing in it is white"), "{error}");
        let error = mask(&encode(RgbaImage::new(8, 8).into()), "m.png", [64, 64]).unwrap_err();
        assert!(error.to_string().contains("nothing in it is opaque"), "{error}");
        assert!(mask(b"no picture", "m.png", [64, 64]).is_err());
    }
}
