//! The page of a scene: the size at which it is printed or shown.
//!
//! A canvas has whole pixels, a page any size, so the two may differ in proportion by a part of a pixel. Writers
//! stretch the canvas over the page. A scene that tiles then repeats exactly at the size of its page.

use super::Scene;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Pixels per inch in CSS, and in files that do not state their size.
pub const CSS_DPI: u32 = 96;

/// Points to the inch.
const POINTS: f64 = 72.0;
/// Longer side of a canvas, in pixels, below which pictures of a page in lengths have several for each of them, and that of
/// such a picture: a drawing may have few units.
const COARSE: f64 = 300.0;
const FINE: f64 = 900.0;

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Pixels of CSS, 96 to the inch.
    Pixel,
    /// Points, 72 to the inch.
    Point,
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// Inches.
    Inch,
    /// Metres.
    Metre,
}

impl LengthUnit {
    /// All units with their names; a name precedes those that it ends in.
    const ALL: [(&str, Self); 6] = [
        ("px", Self::Pixel),
        ("pt", Self::Point),
        ("mm", Self::Millimetre),
        ("cm", Self::Centimetre),
        ("in", Self::Inch),
        ("m", Self::Metre),
    ];

    /// Points as a fraction: so a whole number of inches or points has no rounding error.
    fn points(self) -> [f64; 2] {
        match self {
            Self::Pixel => [3.0, 4.0],
            Self::Point => [1.0, 1.0],
            Self::Millimetre => [POINTS, 25.4],
            Self::Centimetre => [POINTS, 2.54],
            Self::Inch => [POINTS, 1.0],
            Self::Metre => [1000.0 * POINTS, 25.4],
        }
    }
}

/// Its name, as in `mm`.
impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(_, unit)| unit == self).map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

/// A length with its unit, from 0.01 mm to 1 km. As text a number and `px`, `pt`, `mm`, `cm`, `in` or `m`, such as
/// `300mm`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Length {
    value: f64,
    unit: LengthUnit,
}

impl Length {
    /// A length; `None` if it is shorter than 0.01 mm or longer than 1 km.
    pub fn new(value: f64, unit: LengthUnit) -> Option<Self> {
        let length = Self { value, unit };
        let millimetres = length.points() / POINTS * 25.4;
        (0.009_999..=1.000_001e6).contains(&millimetres).then_some(length)
    }

    /// The number before the unit.
    pub fn value(self) -> f64 {
        self.value
    }

    /// The unit.
    pub fn unit(self) -> LengthUnit {
        self.unit
    }

    /// Length in points, 72 to the inch.
    pub fn points(self) -> f64 {
        let [by, of] = self.unit.points();
        self.value * by / of
    }

    /// Length in inches.
    pub fn inches(self) -> f64 {
        self.points() / POINTS
    }

    /// Length in pixels of CSS, 96 to the inch.
    pub fn css_pixels(self) -> f64 {
        match self.unit {
            LengthUnit::Pixel => self.value,
            _ => self.points() / 0.75,
        }
    }

    /// The length `by` times as long, to a millionth of its unit; unchanged where that would be out of range.
    pub fn times(self, by: f64) -> Self {
        Self::new(libm::round(self.value * by * 1e6) / 1e6, self.unit).unwrap_or(self)
    }
}

/// A number and the name of the unit.
impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.value, self.unit)
    }
}

impl From<Length> for String {
    fn from(length: Length) -> Self {
        length.to_string()
    }
}

impl TryFrom<String> for Length {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let named = LengthUnit::ALL.iter().find_map(|(name, unit)| Some((text.strip_suffix(name)?, *unit)));
        let length = named.and_then(|(digits, unit)| {
            let plain = digits.trim_end().bytes().all(|b| b.is_ascii_digit() || b == b'.');
            Self::new(digits.trim_end().parse().ok().filter(|_| plain)?, unit)
        });
        length.ok_or_else(|| "expected a length of 0.01mm to 1000m in px, pt, mm, cm, in or m".into())
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Length {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Length".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        String::json_schema(generator)
    }
}

impl Scene {
    /// Width and height of the page in pixels of CSS, 96 to the inch; those of the canvas where the scene has no page.
    pub fn css_size(&self) -> [f64; 2] {
        let canvas = [self.width, self.height].map(f64::from);
        self.page.map_or(canvas, |page| page.map(Length::css_pixels))
    }

    /// Width and height of a picture of the scene, in pixels: those of its page if that is given in pixels, else those
    /// of its canvas. On a page in lengths, a canvas of less than 300 pixels is enlarged by a whole number, to at least 900.
    /// `scale` multiplies them; they are rounded, and at least 1.
    pub fn picture_size(&self, scale: f64) -> [u32; 2] {
        let canvas = [self.width, self.height].map(f64::from);
        let longer = canvas[0].max(canvas[1]);
        let size = match self.page {
            None => canvas,
            Some(page) if page.iter().all(|side| side.unit == LengthUnit::Pixel) => self.css_size(),
            Some(_) if longer < COARSE => canvas.map(|side| side * libm::ceil(FINE / longer)),
            Some(_) => canvas,
        };
        size.map(|side| (libm::round(side * scale) as u32).max(1))
    }

    /// The page of a canvas of another size, with the same pixels to the inch; `None` where the scene has none.
    pub fn page_of(&self, canvas: [u32; 2]) -> Option<[Length; 2]> {
        let by =
            [f64::from(canvas[0]) / f64::from(self.width), f64::from(canvas[1]) / f64::from(self.height)];
        self.page.map(|[width, height]| [width.times(by[0]), height.times(by[1])])
    }
}

/// The page of a canvas at `dpi` pixels to the inch, in millimetres; `None` at those of CSS, at which no page is needed.
pub fn page_at(canvas: [u32; 2], dpi: u32) -> Option<[Length; 2]> {
    let side = |pixels: u32| {
        let millimetres = f64::from(pixels) * 25.4 / f64::from(dpi);
        Length::new(libm::round(millimetres * 1e6) / 1e6, LengthUnit::Millimetre)
    };
    let [width, height] = canvas.map(side);
    if dpi == CSS_DPI { None } else { Some([width?, height?]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_and_written_as_they_are() {
        for text in ["300mm", "3m", "0.5in", "12pt", "29.7cm", "900px", "1000m", "0.01mm"] {
            let length: Length = text.parse().unwrap();
            assert_eq!(length.to_string(), text);
        }
        assert_eq!("1.50 mm".parse::<Length>().unwrap().to_string(), "1.5mm");
        for bad in ["", "mm", "-3mm", "1e3mm", "NaNmm", "infm", "3", "3kg", "0.001mm", "1001m", "3 m m"] {
            assert!(bad.parse::<Length>().is_err(), "{bad}");
        }
    }

    #[test]
    fn lengths_of_all_units_are_points_without_rounding_errors() {
        let points = |text: &str| text.parse::<Length>().unwrap().points();
        assert_eq!(["1in", "96px", "72pt", "25.4mm", "2.54cm", "0.0254m"].map(points), [72.0; 6]);
        assert_eq!("8.5in".parse::<Length>().unwrap().css_pixels(), 816.0);
    }

    #[test]
    fn pictures_have_the_size_of_a_page_in_pixels_and_no_coarse_one_of_another() {
        let field = crate::scene::testing::flat(vtex_base::raster::colour::Colour([0; 3]));
        let of = |canvas, page: Option<[&str; 2]>| {
            let scene =
                crate::scene::testing::scene(canvas, Vec::new(), Vec::new(), Vec::new(), field.clone());
            let page = page.map(|page| page.map(|side| side.parse().unwrap()));
            Scene { page, ..scene }
        };
        assert_eq!(of([42, 43], None).picture_size(2.0), [84, 86]);
        assert_eq!(of([42, 43], Some(["875px", "900px"])).picture_size(2.0), [1750, 1800]);
        assert_eq!(of([55, 28], Some(["100mm", "50mm"])).picture_size(1.0), [935, 476]);
        assert_eq!(of([354, 354], Some(["300mm", "300mm"])).picture_size(1.0), [354, 354]);
        assert_eq!(of([354, 118], Some(["3m", "1m"])).css_size().map(|v| v as u32), [11338, 3779]);
        let wider = of([354, 118], Some(["3m", "1m"])).page_of([708, 118]).unwrap();
        assert_eq!(wider.map(|side| side.to_string()), ["6m", "1m"]);
    }

    #[test]
    fn a_page_at_a_resolution_is_in_millimetres() {
        let text = |page: Option<[Length; 2]>| page.map(|p| p.map(|side| side.to_string()));
        assert_eq!(text(page_at([300, 118], 300)), Some(["25.4mm".into(), "9.990667mm".into()]));
        assert_eq!(page_at([300, 118], 96), None);
    }
}
