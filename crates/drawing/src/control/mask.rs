//! Picture → outline: the smooth border of the white or opaque area.

use super::picture;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::{Affine, FittedMap, Outline, PlanarMap};
use vtex_base::raster::ControlMap;

/// Side to which small masks with soft borders are enlarged before tracing. Soft borders carry
/// sub-pixel positions.
const FINE_SIDE: u32 = 1024;
/// Largest factor by which a mask is enlarged.
const MOST_ENLARGED: u32 = 8;
/// Fit tolerance of the outline, in pixels of the mask: for soft borders, and for borders along pixels.
const TOLERANCE: [f64; 2] = [0.2, 0.5];

/// The outline of the white area of a picture (grey value at least half), stretched over a canvas of
/// `width` × `height` pixels. If the picture has transparent pixels, the opaque area is used instead,
/// whatever its colour. `name` appears in errors.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`]; [`Error::Control`] if the area is empty.
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
    let soft = is_soft(&map);
    let fine = if soft { (FINE_SIDE / columns.max(rows)).clamp(1, MOST_ENLARGED) } else { 1 };
    let (across, down) = (columns * fine, rows * fine);
    let mut labels = Vec::with_capacity(across as usize * down as usize);
    for y in 0..down {
        let row = (0..across).map(|x| {
            let centre = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            u32::from(level(&map, centre, fine) >= 0.5)
        });
        labels.extend(row);
    }
    let planar = PlanarMap::trace(across, down, &labels);
    drop(labels);
    let fitted = FittedMap::new(planar, TOLERANCE[usize::from(!soft)] * f64::from(fine), 1, 1, |label| label);
    let traced = fitted.outlines(1, |label| label).swap_remove(1);
    let stretch =
        Affine::scale_non_uniform(f64::from(width) / f64::from(across), f64::from(height) / f64::from(down));
    let outline = Outline::new(&(stretch * traced.path())).unwrap_or_default();
    if outline.area() >= 1.0 { Ok(outline) } else { Err(empty()) }
}

/// The value at a point of the map enlarged by `fine`, averaged over about one pixel. Plain bilinear
/// values oscillate from pixel to pixel.
fn level(map: &ControlMap, [x, y]: [f64; 2], fine: u32) -> f64 {
    let [columns, rows] = map.size().map(f64::from);
    let fine = f64::from(fine);
    let at = |dx: f64, dy: f64| map.at([x / fine + dx, y / fine + dy], [columns, rows]);
    if fine == 1.0 {
        return at(0.0, 0.0);
    }
    let h = 0.5;
    (at(-h, -h) + at(h, -h) + at(-h, h) + at(h, h)) / 4.0
}

/// Whether the border between inside and outside passes through intermediate values.
fn is_soft(map: &ControlMap) -> bool {
    let [columns, rows] = map.size();
    let value = |x: u32, y: u32| {
        map.at([f64::from(x) + 0.5, f64::from(y) + 0.5], [f64::from(columns), f64::from(rows)])
    };
    let between = |v: f64| (0.1..0.9).contains(&v);
    let (mut soft, mut hard) = (0u64, 0u64);
    for y in 0..rows {
        for x in 0..columns {
            let here = value(x, y);
            for (x, y) in [(x + 1, y), (x, y + 1)] {
                if x < columns && y < rows {
                    let there = value(x, y);
                    if (here >= 0.5) != (there >= 0.5) {
                        let counted = if between(here) || between(there) { &mut soft } else { &mut hard };
                        *counted += 1;
                    }
                }
            }
        }
    }
    soft > hard
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::picture::testing::encode;
    use image::{DynamicImage, GrayImage, Luma, Rgba, RgbaImage};
    use vtex_base::geometry::{Rect, is_simple};

    /// Coverage of each pixel by a disc of radius 20 about (32, 32), 0 to 255.
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
