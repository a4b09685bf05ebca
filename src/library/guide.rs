//! The exemplar's colours on a coarse grid: what synthesis follows where structure is larger than a
//! few textons.

use crate::raster::{Limits, decode};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Mean colours of the exemplar over square cells.
///
/// What stands in a cell is not stored: the arrangement says it pixel by pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Guide {
    /// Side of a cell, in exemplar pixels. Cells at the right and lower border may be cut.
    pub cell: u32,
    /// The mean colour (of linear light) of every cell, as a PNG in base64.
    pub picture: Picture,
}

/// A picture that JSON holds as a PNG in base64.
#[derive(Clone, PartialEq)]
pub struct Picture(pub RgbImage);

impl Guide {
    /// Side of the cells for an exemplar: fine enough for a joint between textons, coarse enough that
    /// large photographs, whose textons are larger too, take no longer to follow.
    pub fn cell_for(width: u32, height: u32) -> u32 {
        /// Cells, above which they are made larger.
        const MOST_CELLS: u64 = 400 * 400;
        let cells = |cell: u32| u64::from(width.div_ceil(cell)) * u64::from(height.div_ceil(cell));
        if cells(2) <= MOST_CELLS { 2 } else { 4 }
    }

    /// Checks that it fits an exemplar.
    ///
    /// # Errors
    /// What is wrong.
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
