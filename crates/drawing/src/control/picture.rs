//! Pictures as scalar data: grey values and opacity.

use image::{DynamicImage, ImageBuffer, LumaA, RgbaImage};
use vtex_base::error::Result;
use vtex_base::raster::{self, ControlMap, Limits};

/// Largest width and height of a control map; larger pictures are averaged down.
const MOST_SAMPLES: u32 = 4096;

/// A picture as grey values and opacity, each 0 to 65535, with the EXIF rotation applied.
pub(super) type Grey = ImageBuffer<LumaA<u16>, Vec<u16>>;

/// Converts a picture to grey values (Rec. 709 weights of the sRGB components).
pub(super) fn grey(image: &DynamicImage) -> Grey {
    image.to_luma_alpha16()
}

/// Decodes a picture of data and applies its EXIF rotation.
///
/// # Errors
/// [`vtex_base::Error::Decode`] if the bytes are no image or damaged, [`vtex_base::Error::OtherFormat`] for a picture of
/// another kind, [`vtex_base::Error::TooLarge`] beyond the default [`Limits`].
pub(super) fn read(bytes: &[u8], name: &str) -> Result<DynamicImage> {
    // 8 bytes per pixel at most: grey and opacity of 16 bits, or colour and opacity of 8.
    let (mut image, orientation) = raster::decode(bytes, name, &Limits::default(), 4)?;
    image.apply_orientation(orientation);
    Ok(image)
}

/// Decodes a picture of colours as [`read`] does, in sRGB.
///
/// # Errors
/// Those of [`read`].
pub(super) fn read_colours(bytes: &[u8], name: &str) -> Result<RgbaImage> {
    // A map has no place for warnings: colours that cannot be converted are as they are stored.
    let (mut image, orientation) =
        raster::decode_colours(bytes, name, &Limits::default(), 4, &mut Vec::new())?;
    image.apply_orientation(orientation);
    Ok(colours(&image))
}

/// Converts a picture to 8-bit colours and opacity.
pub(super) fn colours(image: &DynamicImage) -> RgbaImage {
    image.to_rgba8()
}

/// A map with the values of `width` × `height` pixels; large pictures are averaged down.
pub(super) fn map(width: u32, height: u32, value: impl Fn(u32, u32) -> f32) -> Option<ControlMap> {
    let fold = width.max(height).div_ceil(MOST_SAMPLES).max(1);
    let (columns, rows) = (width.div_ceil(fold), height.div_ceil(fold));
    let bounds = |i: u32, count: u32, size: u32| {
        let at = |i: u32| (u64::from(i) * u64::from(size) / u64::from(count)) as u32;
        at(i)..at(i + 1)
    };
    let mut values = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows {
        for column in 0..columns {
            let (mut sum, mut count) = (0.0, 0.0);
            for y in bounds(row, rows, height) {
                for x in bounds(column, columns, width) {
                    sum += f64::from(value(x, y));
                    count += 1.0;
                }
            }
            values.push((sum / count) as f32);
        }
    }
    ControlMap::new(columns, rows, values)
}

#[cfg(test)]
pub(super) mod testing {
    use vtex_base::raster::ControlMap;

    /// Encodes a picture as PNG.
    pub(in crate::control) fn encode(image: image::DynamicImage) -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    /// The value of a pixel of a map.
    pub(in crate::control) fn at(map: &ControlMap, x: u32, y: u32) -> f64 {
        let [width, height] = map.size().map(f64::from);
        map.at([f64::from(x) + 0.5, f64::from(y) + 0.5], [width, height])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_averaged() {
        let sized = |w, h| map(w, h, |x, _| (x % 2) as f32).unwrap();
        assert_eq!(sized(4096, 3).size(), [4096, 3]);
        let halved = sized(8192, 5);
        assert_eq!(halved.size(), [4096, 3]);
        for x in [0.0, 17.3, 4096.0] {
            assert_eq!(halved.at([x, 1.0], [4096.0, 3.0]), 0.5);
        }
    }
}
