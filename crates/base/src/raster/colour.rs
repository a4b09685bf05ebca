//! Colours: 8-bit sRGB for files; linear light and Oklab for arithmetic.

use crate::parallel::for_chunks;
use image::RgbImage;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// An 8-bit sRGB colour. In JSON and SVG it is written `"#rrggbb"`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Colour(pub [u8; 3]);

impl Colour {
    /// Parses `#rrggbb`; `None` for any other text.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?;
        if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        let channel = |i: usize| u8::from_str_radix(&digits[i..i + 2], 16).ok();
        Some(Self([channel(0)?, channel(2)?, channel(4)?]))
    }

    /// Converts sRGB components in 0..=255, rounded and clamped.
    pub fn from_f64(rgb: [f64; 3]) -> Self {
        Self(rgb.map(|v| libm::round(v).clamp(0.0, 255.0) as u8))
    }

    /// The sRGB components as floats in 0..=255.
    pub fn to_f64(self) -> [f64; 3] {
        self.0.map(f64::from)
    }

    /// Converts to Oklab (Ottosson 2020): L in 0..=1, a and b about -0.4..=0.4.
    pub fn to_oklab(self) -> [f32; 3] {
        oklab(self.0)
    }

    /// Converts from Oklab to the nearest 8-bit sRGB colour. Components out of gamut are clamped.
    pub fn from_oklab([lightness, a, b]: [f32; 3]) -> Self {
        let cube = |v: f32| v * v * v;
        let l = cube(lightness + 0.396_337_78 * a + 0.215_803_76 * b);
        let m = cube(lightness - 0.105_561_346 * a - 0.063_854_17 * b);
        let s = cube(lightness - 0.089_484_18 * a - 1.291_485_5 * b);
        let linear = [
            4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
            -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
            -0.004_196_086 * l - 0.703_418_6 * m + 1.707_614_7 * s,
        ];
        Self(linear.map(encoded))
    }

    /// Distance of two colours in Oklab: 1 from black to white.
    pub fn distance(self, other: Self) -> f32 {
        libm::sqrtf(squared_distance(self.to_oklab(), other.to_oklab()))
    }

    /// Linear interpolation in Oklab from this colour (`share` 0) to another (`share` 1).
    pub fn mixed(self, other: Self, share: f64) -> Self {
        let (a, b, share) = (self.to_oklab(), other.to_oklab(), share as f32);
        Self::from_oklab(std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
    }
}

/// Encodes linear light, clamped to 0..=1, as an 8-bit sRGB component.
pub fn encoded(linear: f32) -> u8 {
    let table = linear_table();
    let above = table.partition_point(|&v| (v as f32) < linear);
    match above {
        0 => 0,
        256 => 255,
        i => {
            // Between two steps the encoding is practically linear.
            let nearer = linear - (table[i - 1] as f32) < (table[i] as f32) - linear;
            (if nearer { i - 1 } else { i }) as u8
        }
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

impl fmt::Debug for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Serialize for Colour {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        struct Text<'a>(#[serde(borrow)] Cow<'a, str>);

        let Text(text) = Text::deserialize(deserializer)?;
        Self::from_hex(&text).ok_or_else(|| {
            serde::de::Error::custom(format_args!(
                "'{}' is not a colour like #a0b1c2",
                crate::error::clip(&text)
            ))
        })
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Colour {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Colour".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({"type": "string", "pattern": "^#[0-9a-f]{6}$"})
    }
}

/// Decodes an 8-bit sRGB component to linear light in 0..=1 (IEC 61966-2-1).
pub fn linear(component: u8) -> f32 {
    linear_table()[component as usize] as f32
}

/// Linear light of all 8-bit sRGB components.
pub fn linear_table() -> &'static [f64; 256] {
    use std::sync::OnceLock;
    static TABLE: OnceLock<[f64; 256]> = OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|i| {
            let v = i as f64 / 255.0;
            if v <= 0.040_45 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
        })
    })
}

/// Converts 8-bit sRGB to Oklab (Ottosson 2020): L in 0..=1, a and b about -0.4..=0.4.
pub fn oklab(rgb: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = rgb.map(linear);
    let l = libm::cbrtf(0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b);
    let m = libm::cbrtf(0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b);
    let s = libm::cbrtf(0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b);
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Maps each pixel of an image with `f`, row by row.
pub fn of_pixels<T: Copy + Default + Send>(
    image: &RgbImage,
    f: impl Fn([u8; 3]) -> T + Sync + Send,
) -> Vec<T> {
    let mut values = vec![T::default(); image.width() as usize * image.height() as usize];
    let width = image.width().max(1) as usize;
    for_chunks(&mut values, width, |y, row| {
        for (value, rgb) in row.iter_mut().zip(image.as_raw()[3 * y * width..].chunks_exact(3)) {
            *value = f([rgb[0], rgb[1], rgb[2]]);
        }
    });
    values
}

/// Squared distance of two colours in Oklab.
pub fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

/// Component-wise median of 8-bit sRGB colours; `None` for an empty sequence.
pub fn median(colours: impl IntoIterator<Item = [u8; 3]>) -> Option<Colour> {
    let mut histogram = [[0u32; 256]; 3];
    let mut count = 0u32;
    for rgb in colours {
        for (h, v) in histogram.iter_mut().zip(rgb) {
            h[v as usize] += 1;
        }
        count += 1;
    }
    (count > 0).then(|| {
        Colour(histogram.map(|h| {
            let mut seen = 0;
            h.iter()
                .position(|n| {
                    seen += n;
                    seen * 2 >= count
                })
                .unwrap_or(255) as u8
        }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_is_read_and_written() {
        assert_eq!(Colour::from_hex("#0a1Bff"), Some(Colour([10, 27, 255])));
        assert_eq!(Colour([10, 27, 255]).to_string(), "#0a1bff");
        for bad in ["0a1bff", "#0a1bf", "#0a1bfg", "#+a1bff", "", "#ééé"] {
            assert_eq!(Colour::from_hex(bad), None, "{bad}");
        }
    }

    #[test]
    fn oklab_of_greys_has_no_chroma() {
        for v in [0u8, 40, 128, 255] {
            let [l, a, b] = oklab([v; 3]);
            assert!(a.abs() < 1e-3 && b.abs() < 1e-3, "{v}: {a} {b}");
            assert!((0.0..=1.001).contains(&l));
        }
    }

    #[test]
    fn every_colour_comes_back_from_oklab() {
        for i in 0..4096u32 {
            let colour = Colour([(i % 16 * 17) as u8, (i / 16 % 16 * 17) as u8, (i / 256 * 17) as u8]);
            assert_eq!(Colour::from_oklab(colour.to_oklab()), colour);
        }
        let (black, white) = (Colour([0; 3]), Colour([255; 3]));
        assert_eq!((black.mixed(white, 0.0), black.mixed(white, 1.0)), (black, white));
        assert_eq!(Colour::from_oklab([0.7, 0.4, 0.2]).0[2], 0);
    }

    #[test]
    fn median_is_taken_per_component() {
        let m = median([[0, 9, 5], [10, 8, 5], [20, 7, 200]]);
        assert_eq!(m, Some(Colour([10, 8, 5])));
        assert_eq!(median([]), None);
    }
}
