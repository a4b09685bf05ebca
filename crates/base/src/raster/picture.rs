//! Diagnostic pictures of label maps.

use super::LabelMap;
use image::{Rgb, RgbImage};

/// A colour for a label: black for 0, well distinguishable hues for the others.
pub fn label_colour(label: u32) -> [u8; 3] {
    if label == 0 {
        return [0; 3];
    }
    let h = label.wrapping_mul(2_654_435_761);
    let hue = f64::from(h >> 8) / f64::from(1u32 << 24) * 6.0;
    let value = 160.0 + f64::from(h & 0x5f);
    let saturation = 0.45 + f64::from((h >> 5) & 0x7) / 16.0;
    [5.0, 3.0, 1.0].map(|n| {
        let k = (n + hue) % 6.0;
        let dip = k.min(4.0 - k).clamp(0.0, 1.0);
        (value * (1.0 - saturation * dip)) as u8
    })
}

/// A label map in flat colours.
pub fn labels(map: &LabelMap) -> RgbImage {
    RgbImage::from_fn(map.width, map.height, |x, y| Rgb(label_colour(map.get(x, y))))
}

/// An image with the borders of a label map drawn on top.
pub fn outlines(image: &RgbImage, map: &LabelMap) -> RgbImage {
    let mut picture = image.clone();
    for y in 0..map.height.min(image.height()) {
        for x in 0..map.width.min(image.width()) {
            let label = map.get(x, y);
            let differs = |dx: i64, dy: i64| {
                map.at(i64::from(x) + dx, i64::from(y) + dy).is_some_and(|other| other != label)
            };
            if label != 0 && (differs(1, 0) || differs(0, 1) || differs(-1, 0) || differs(0, -1)) {
                picture.put_pixel(x, y, Rgb([255, 40, 200]));
            }
        }
    }
    picture
}
