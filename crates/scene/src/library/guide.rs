//! The guide: the exemplar's mean colours on a coarse grid. Synthesis follows it to preserve structure
//! larger than a few elements.
//!
//! The guide takes 3 to 9 % of the bytes of a library. The element in a cell is given by the arrangement.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, Rgb, RgbImage};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use vtex_base::raster::colour::{encoded, linear};
use vtex_base::raster::{Limits, decode};

/// Mean colours of the exemplar over square cells.
///
/// The elements in a cell are not stored; the arrangement has them pixel by pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Guide {
    /// Side of a cell, in pixels of the arrangement. Cells at the right and lower border may be cut off.
    pub cell: u32,
    /// Mean colour of each cell, averaged in linear light.
    pub picture: Picture,
}

/// A picture. In JSON it is a PNG in base64.
#[derive(Clone, PartialEq)]
pub struct Picture(pub RgbImage);

impl Guide {
    /// The guide of an exemplar. Colours are averaged in linear light, as seen from far away.
    pub fn of(image: &RgbImage) -> Self {
        let (width, height) = image.dimensions();
        let cell = Self::cell_for(width, height);
        let mean = |column: u32, row: u32| {
            let mut sum = [0f32; 3];
            let mut count = 0;
            for y in row * cell..((row + 1) * cell).min(height) {
                for x in column * cell..((column + 1) * cell).min(width) {
                    let colour = image.get_pixel(x, y).0.map(linear);
                    (0..3).for_each(|k| sum[k] += colour[k]);
                    count += 1;
                }
            }
            Rgb(sum.map(|v| encoded(v / count as f32)))
        };
        Self { cell, picture: Picture(RgbImage::from_fn(width.div_ceil(cell), height.div_ceil(cell), mean)) }
    }

    /// Side of the cells for an exemplar of the given size in pixels: 2, or more for large exemplars, to
    /// bound the cost of synthesis. Joints between elements need small cells, but large photographs have
    /// larger elements.
    pub fn cell_for(width: u32, height: u32) -> u32 {
        /// Number of cells above which they are enlarged.
        const MOST_CELLS: u64 = 400 * 400;
        let cells = |cell: u32| u64::from(width.div_ceil(cell)) * u64::from(height.div_ceil(cell));
        if cells(2) <= MOST_CELLS { 2 } else { 4 }
    }

    /// Checks that the guide fits an exemplar of the given size.
    ///
    /// # Errors
    /// A description of the first fault.
    pub(super) fn check(&self, width: u32, height: u32) -> Result<(), String> {
        if !(1..=64).contains(&self.cell) {
            return Err(format!("guide.cell = {} is not within 1 to 64", self.cell));
        }
        let wanted = (width.div_ceil(self.cell), height.div_ceil(self.cell));
        let found = self.picture.0.dimensions();
        if found != wanted {
            return Err(format!("guide.picture has {found:?} cells, not {wanted:?}"));
        }
        Ok(())
    }
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({} x {})", self.0.width(), self.0.height())
    }
}

impl Serialize for Picture {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut png = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive);
        let (width, height) = self.0.dimensions();
        encoder
            .write_image(self.0.as_raw(), width, height, ExtendedColorType::Rgb8)
            .map_err(serde::ser::Error::custom)?;
        serializer.serialize_str(&BASE64.encode(png))
    }
}

impl<'de> Deserialize<'de> for Picture {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::Error as _;
        let text = <std::borrow::Cow<'_, str>>::deserialize(deserializer)?;
        let png = BASE64.decode(text.as_bytes()).map_err(D::Error::custom)?;
        let limits = Limits { memory: 1 << 30, ..Limits::default() };
        let (image, _) = decode(&png, "guide.picture", &limits, 3).map_err(D::Error::custom)?;
        Ok(Self(image.into_rgb8()))
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Picture {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Picture".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": "string",
            "contentEncoding": "base64",
            "contentMediaType": "image/png"
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_the_mean_of_their_pixels() {
        let image = RgbImage::from_fn(5, 4, |x, _| if x < 2 { Rgb([200, 40, 40]) } else { Rgb([9, 9, 90]) });
        let guide = Guide::of(&image);
        assert_eq!((guide.cell, guide.picture.0.dimensions()), (2, (3, 2)));
        let cells: Vec<_> = guide.picture.0.pixels().map(|p| p.0).collect();
        assert_eq!(cells[..3], [[200, 40, 40], [9, 9, 90], [9, 9, 90]]);
    }

    #[test]
    fn pictures_survive_json_and_damage_is_an_error() {
        let image = RgbImage::from_fn(7, 5, |x, y| image::Rgb([x as u8 * 30, y as u8 * 50, 9]));
        let guide = Guide { cell: 2, picture: Picture(image) };
        let json = serde_json::to_string(&guide).unwrap();
        assert_eq!(serde_json::from_str::<Guide>(&json).unwrap(), guide);
        assert_eq!(guide.check(14, 9), Ok(()));
        assert!(guide.check(15, 9).is_err() && Guide { cell: 0, ..guide }.check(14, 9).is_err());
        for text in ["", "AAAA", "not base64!"] {
            let json = format!("{{\"cell\": 2, \"picture\": \"{text}\"}}");
            assert!(serde_json::from_str::<Guide>(&json).is_err(), "{text}");
        }
    }

    #[test]
    fn cells_grow_with_the_exemplar() {
        assert_eq!([500, 1024, 4096].map(|side| Guide::cell_for(side, side)), [2, 4, 4]);
    }
}
