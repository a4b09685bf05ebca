//! Pictures → maps of colours.

use super::picture;
use vtex_base::error::{Error, Result};
use vtex_base::raster::ControlMap;
use vtex_base::raster::colour::Colour;

/// The colours of a picture, stretched over a canvas of any size.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourMap {
    /// L, a and b of Oklab, each times the opacity, and the opacity.
    channels: [ControlMap; 4],
}

impl ColourMap {
    /// The colour at a point of a canvas of the given size, both in pixels, in Oklab, and its opacity, 0 to
    /// 1. Bilinear, constant beyond the borders.
    pub fn at(&self, point: [f64; 2], canvas: [f64; 2]) -> ([f32; 3], f64) {
        let [l, a, b, opacity] = self.channels.each_ref().map(|c| c.at(point, canvas));
        if opacity <= 0.0 { ([0.0; 3], 0.0) } else { ([l, a, b].map(|v| (v / opacity) as f32), opacity) }
    }
}

/// Reads a picture as a map of its colours, which its colour profile says if it has one. Large pictures are averaged down. `name` appears in errors.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`]; [`Error::Control`] for a picture without pixels.
pub fn colours(bytes: &[u8], name: &str) -> Result<ColourMap> {
    let image = picture::read_colours(bytes, name)?;
    let (width, height) = (image.width(), image.height());
    let channel = |k: usize| {
        let map = picture::map(width, height, |x, y| {
            let [r, g, b, opacity] = image.get_pixel(x, y).0;
            let opacity = f32::from(opacity) / 255.0;
            if k == 3 { opacity } else { Colour([r, g, b]).to_oklab()[k] * opacity }
        });
        map.ok_or_else(|| Error::Control {
            name: name.into(),
            role: "a map of colours",
            reason: "it has no pixels".into(),
            advice: "is the file complete?",
        })
    };
    Ok(ColourMap { channels: [channel(0)?, channel(1)?, channel(2)?, channel(3)?] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::picture::testing::encode;
    use image::{Rgba, RgbaImage};

    #[test]
    fn colours_stand_where_they_are_and_clear_ones_do_not_bleed() {
        let pixels = [[255, 0, 0, 255], [0, 0, 255, 0], [0, 255, 0, 255]];
        let picture = RgbaImage::from_fn(3, 1, |x, _| Rgba(pixels[x as usize]));
        let map = colours(&encode(picture.into()), "c.png").unwrap();
        let at = |x: f64| map.at([x, 5.0], [30.0, 10.0]);
        let (red, opaque) = at(5.0);
        assert_eq!((Colour::from_oklab(red), opaque), (Colour([255, 0, 0]), 1.0));
        assert_eq!(at(15.0).1, 0.0);
        // Half way to the transparent pixel the colour is still red.
        let (between, opacity) = at(10.0);
        assert!((opacity - 0.5).abs() < 1e-6 && Colour::from_oklab(between) == Colour([255, 0, 0]));
    }
}
