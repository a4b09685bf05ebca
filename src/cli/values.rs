//! Values of options with a syntax of their own: canvas sizes, seeds, weights.

use super::number::within;
use clap::builder::{PossibleValue, TypedValueParser};
use serde::de::value::{Error as ValueError, StrDeserializer};
use serde::de::{DeserializeOwned, IntoDeserializer};
use serde::{Serialize, Serializer};
use std::ffi::OsStr;
use std::str::FromStr;
use vtex::Parameter;
use vtex::analyze::Exemplar;
use vtex::output::DPI;
use vtex::scene::{Length, LengthUnit, SynthParams, Tile, Weights};
use vtex::synth::CanvasSize;
use vtex::warp::Bend;
use vtex_base::file_names::is_device;

/// The size of a canvas: `auto`, `1000` or `1000x600` in pixels, or lengths such as `300mm` or `3m x 1m`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Size(pub(crate) CanvasSize);

impl Size {
    /// The description of canvas sizes in the help.
    pub(crate) fn canvas(side: Parameter<u32>) -> String {
        format!("{side}, at most 400 megapixels")
    }

    /// Width and height in pixels, lengths at 96 pixels to the inch; `None` for `auto`.
    pub(crate) fn pixels(self) -> Option<[u32; 2]> {
        match self.0 {
            CanvasSize::Auto => None,
            CanvasSize::Pixels(size) => Some(size),
            CanvasSize::Page(page) => Some(page.map(|side| side.css_pixels().round() as u32)),
        }
    }
}

/// Two sides with an `x` between, which does not end the unit `px`.
fn sides(text: &str) -> (&str, &str) {
    let is_between =
        |at: &usize| text[..*at].bytes().next_back().is_some_and(|b| !b.eq_ignore_ascii_case(&b'p'));
    let between = text.match_indices(['x', 'X']).map(|(at, _)| at).find(is_between);
    between.map_or((text, text), |at| (&text[..at], &text[at + 1..]))
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self(CanvasSize::Auto));
        }
        let (width, height) = sides(text);
        let side = |text: &str| {
            let text = text.strip_suffix("px").unwrap_or(text);
            let is_number = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
            is_number.then(|| text.parse::<u32>().ok()).flatten().filter(|v| SynthParams::SIDE.allows(*v))
        };
        if let (Some(width), Some(height)) = (side(width), side(height)) {
            return Ok(Self(CanvasSize::Pixels([width, height])));
        }
        let length = |text: &str| text.parse().ok().filter(|side: &Length| side.unit() != LengthUnit::Pixel);
        match (length(width), length(height)) {
            (Some(width), Some(height)) => Ok(Self(CanvasSize::Page([width, height]))),
            _ => Err(format!(
                "expected 1000 or 1000x600, {}, or lengths in mm, cm, m, in or pt, such as 300mm, 12in or 3mx1m",
                SynthParams::SIDE
            )),
        }
    }
}

impl Serialize for Size {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            CanvasSize::Auto => serializer.serialize_str("auto"),
            CanvasSize::Pixels([width, height]) => serializer.collect_str(&format_args!("{width}x{height}")),
            CanvasSize::Page([width, height]) => serializer.collect_str(&format_args!("{width}x{height}")),
        }
    }
}

/// Pixels of the canvas to the inch: `auto` or a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Resolution(pub(crate) Option<u32>);

impl FromStr for Resolution {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self(None)),
            text => {
                within(DPI)(text).map(|dpi| Self(Some(dpi))).map_err(|_| format!("expected auto, or {DPI}"))
            }
        }
    }
}

impl Serialize for Resolution {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            None => serializer.serialize_str("auto"),
            Some(dpi) => serializer.serialize_u32(dpi),
        }
    }
}

/// Whether an exemplar tiles: `auto`, `on` or `off`; also `true` and `false`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Wrap {
    #[default]
    Auto,
    On,
    Off,
}

impl Wrap {
    pub(crate) const NAMES: [&'static str; 3] = ["auto", "on", "off"];

    /// The choice; `None` for `auto`.
    pub(crate) fn choice(self) -> Option<bool> {
        match self {
            Self::Auto => None,
            Self::On => Some(true),
            Self::Off => Some(false),
        }
    }
}

impl FromStr for Wrap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "on" | "true" => Ok(Self::On),
            "off" | "false" => Ok(Self::Off),
            _ => Err("expected auto, on or off".into()),
        }
    }
}

impl Serialize for Wrap {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.choice() {
            Some(wrap) => serializer.serialize_bool(wrap),
            None => serializer.serialize_str("auto"),
        }
    }
}

/// `1.5` or `1.5x2`: factors along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factors(pub(crate) [f64; 2]);

impl FromStr for Factors {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let factor = |t: &str| {
            let value = t.parse().ok().filter(|v| Bend::FACTORS.allows(*v));
            value.ok_or_else(|| format!("expected 1.5 or 1.5x2, {}", Bend::FACTORS))
        };
        let (x, y) = text.split_once(['x', 'X']).unwrap_or((text, text));
        Ok(Self([factor(x)?, factor(y)?]))
    }
}

/// `40` or `40,0,40,0`: widths at the left, the top, the right and the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Margins(pub(crate) [usize; 4]);

impl Margins {
    /// Range of each width.
    pub(crate) const EACH: Parameter<usize> =
        Parameter::new("extend", [0, Exemplar::LARGEST_SIDE as usize], "px each");
}

impl FromStr for Margins {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let values: Result<Vec<usize>, _> = text.split(',').map(|t| within(Self::EACH)(t.trim())).collect();
        match values.as_deref() {
            Ok([all]) => Ok(Self([*all; 4])),
            Ok([left, top, right, bottom]) => Ok(Self([*left, *top, *right, *bottom])),
            _ => Err(format!("expected 40, or 40,0,40,0 for left, top, right and bottom, {}", Self::EACH)),
        }
    }
}

/// `5MB`, `800kB` or a plain number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bytes(pub(crate) u64);

impl Bytes {
    /// Range of the number of bytes.
    pub(crate) const RANGE: Parameter<u64> = Parameter::new("max-bytes", [1, 1_000_000_000_000], "");
}

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim().to_ascii_lowercase();
        let units = [("gb", 1e9), ("mb", 1e6), ("kb", 1e3), ("b", 1.0), ("", 1.0)];
        let found = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)));
        let value = found.and_then(|(number, size)| Some(number.trim_end().parse::<f64>().ok()? * size));
        let value = value.map(|v| v.floor() as u64).filter(|v| Self::RANGE.allows(*v));
        value.map(Self).ok_or_else(|| format!("expected 5MB, 800kB or a number of bytes, {}", Self::RANGE))
    }
}

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.0)
    }
}

/// A 64-bit seed. TOML integers have 63 bits, so larger seeds are written as text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Seed(pub(crate) u64);

impl Seed {
    /// A seed that the user did not give: 32 random bits, short enough to be read out and exact in
    /// every JSON reader.
    pub(crate) fn chosen() -> Self {
        use std::hash::{BuildHasher, Hasher};
        // The standard library keys its hashers from the system's random numbers.
        Self(std::collections::hash_map::RandomState::new().build_hasher().finish() >> 32)
    }
}

impl FromStr for Seed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse().map(Self).map_err(|_| format!("expected a whole number, 0 to {}", u64::MAX))
    }
}

impl Serialize for Seed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match i64::try_from(self.0) {
            Ok(number) => serializer.serialize_i64(number),
            Err(_) => serializer.collect_str(&self.0),
        }
    }
}

/// The five weights of the score, in the order of [`Weights`]; `0.5,-0.4,-0.2,-0.5,-0.5`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub(crate) struct FiveWeights(pub(crate) [f64; 5]);

impl FromStr for FiveWeights {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let list = text.trim_start_matches('[').trim_end_matches(']');
        let values: Result<Vec<f64>, _> = list.split(',').map(|t| within(Weights::EACH)(t.trim())).collect();
        let five = values.ok().and_then(|v| <[f64; 5]>::try_from(v).ok());
        five.map(Self).ok_or_else(|| format!("expected five numbers with commas between, {}", Weights::EACH))
    }
}

/// Weights of the score: five numbers, or the name of a file that holds them.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum WeightsFrom {
    Numbers(FiveWeights),
    Name(Name),
}

impl FromStr for WeightsFrom {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(name) => Ok(Self::Name(name)),
            Err(_) if text.contains(',') => text.parse().map(Self::Numbers),
            Err(_) => Err("expected five numbers with commas between, or a name".into()),
        }
    }
}

/// A name of weights or of a model: letters of ASCII, at least one, digits, `-` and `_`; at most 64. It is
/// also the name of a file or folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub(crate) struct Name(String);

impl Name {
    /// The name.
    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for Name {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let allowed = |c: u8| c.is_ascii_alphanumeric() || c == b'-' || c == b'_';
        if is_device(text) {
            return Err("Windows takes it for a device, not for a file: give another name".into());
        }
        let named = text.len() <= 64 && text.bytes().any(|c| c.is_ascii_alphabetic());
        if named && text.bytes().all(allowed) {
            return Ok(Self(text.to_owned()));
        }
        Err("expected letters, digits, - and _, at most 64 and at least one letter".into())
    }
}

impl From<Weights> for FiveWeights {
    fn from(w: Weights) -> Self {
        Self([w.target, w.uncovered, w.empty, w.mismatched, w.same_overlap])
    }
}

impl From<FiveWeights> for Weights {
    fn from(FiveWeights([target, uncovered, empty, mismatched, same_overlap]): FiveWeights) -> Self {
        Self { target, uncovered, empty, mismatched, same_overlap }
    }
}

/// Axes along which a texture repeats: `none`, `both`, `x` or `y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Axes(pub(crate) Tile);

impl Axes {
    /// The names of the choices.
    pub(crate) const NAMES: [&str; 4] = ["none", "both", "x", "y"];
}

impl FromStr for Axes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (x, y) = match text {
            "none" | "false" => (false, false),
            "both" | "true" => (true, true),
            "x" => (true, false),
            "y" => (false, true),
            _ => return Err("expected both, x, y or none".into()),
        };
        Ok(Self(Tile { x, y }))
    }
}

impl Serialize for Axes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match (self.0.x, self.0.y) {
            (false, false) => "none",
            (true, true) => "both",
            (true, false) => "x",
            (false, true) => "y",
        })
    }
}

/// A parser of values that have names, which completions offer.
#[derive(Clone)]
pub(crate) struct OneOf<T> {
    names: &'static [&'static str],
    parse: fn(&str) -> Result<T, String>,
}

/// Values read by `parse`, with these names.
pub(crate) fn one_of<T>(names: &'static [&'static str], parse: fn(&str) -> Result<T, String>) -> OneOf<T> {
    OneOf { names, parse }
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for OneOf<T> {
    type Value = T;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<T, clap::Error> {
        let (names, parse) = (self.names, self.parse);
        let parse = move |text: &str| parse(text).map_err(|_| one_of_these(names));
        parse.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.names.iter().copied().map(PossibleValue::new)))
    }
}

/// The message for an unknown name.
pub(crate) fn one_of_these(names: &[impl AsRef<str>]) -> String {
    if names.is_empty() { String::new() } else { format!("expected {}", alternatives(names)) }
}

/// Names in words, as in "a, b or c".
pub(crate) fn alternatives(names: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => names.concat(),
    }
}

/// A value by its name in files.
pub(crate) fn named<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    let name: StrDeserializer<'_, ValueError> = text.into_deserializer();
    T::deserialize(name).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_one_or_two_sides() {
        let pixels = |width, height| Ok(Size(CanvasSize::Pixels([width, height])));
        for (text, size) in [("1000", [1000, 1000]), ("1000x600", [1000, 600]), ("90px", [90, 90])] {
            assert_eq!(text.parse(), pixels(size[0], size[1]), "{text}");
        }
        assert_eq!("9pxx8px".parse(), pixels(9, 8));
        for bad in
            ["", "0", "x", "10x", "x10", "1x2x3", "-5", "+5", "1.5", "100001", "99999999999", "10 x 10"]
        {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }

    #[test]
    fn sizes_may_be_lengths() {
        let read = |text: &str| text.parse::<Size>().ok();
        for (text, pixels) in [
            ("12inx12in", [1152, 1152]),
            ("3m x 1.5m", [11339, 5669]),
            ("30cmx200mm", [1134, 756]),
            ("72ptx36pt", [96, 48]),
        ] {
            let size = read(text).unwrap();
            assert_eq!(size.pixels(), Some(pixels), "{text}");
            let written = serde_json::to_value(size).unwrap();
            assert_eq!(written, text.replace(' ', ""));
            assert_eq!(read(written.as_str().unwrap()), Some(size));
        }
        assert_eq!(read("12in"), read("12in x 12in"));
        assert_eq!(read("auto").map(Size::pixels), Some(None));
        assert_eq!(["mm", "-3mm", "3mmx5", "1e9m", "NaNmm", "9kg"].map(read), [None; 6]);
    }

    #[test]
    fn resolutions_are_numbers_or_auto() {
        assert_eq!("auto".parse(), Ok(Resolution(None)));
        assert_eq!("150".parse(), Ok(Resolution(Some(150))));
        for bad in ["", "0", "9601", "1.5", "fine"] {
            assert!(bad.parse::<Resolution>().is_err(), "{bad}");
        }
    }

    #[test]
    fn factors_are_one_or_two_numbers() {
        assert_eq!("1.5".parse(), Ok(Factors([1.5, 1.5])));
        assert_eq!("0.5x2".parse(), Ok(Factors([0.5, 2.0])));
        for bad in ["", "x", "0", "0.05", "11", "1x", "-1", "NaN", "1x2x3", "inf"] {
            assert!(bad.parse::<Factors>().is_err(), "{bad}");
        }
    }

    #[test]
    fn margins_are_one_or_four_widths() {
        assert_eq!("40".parse(), Ok(Margins([40; 4])));
        assert_eq!("1,2, 3,0".parse(), Ok(Margins([1, 2, 3, 0])));
        for bad in ["", "1,2", "1,2,3,4,5", "-1", "1.5", "1,2,3,x", "999999999"] {
            assert!(bad.parse::<Margins>().is_err(), "{bad}");
        }
    }

    #[test]
    fn chosen_seeds_are_short_and_differ() {
        let seeds: Vec<Seed> = (0..8).map(|_| Seed::chosen()).collect();
        assert!(seeds.iter().all(|s| s.0 < 1 << 32));
        assert!(seeds.windows(2).any(|w| w[0] != w[1]));
    }

    #[test]
    fn axes_come_back() {
        for name in Axes::NAMES {
            let axes: Axes = name.parse().unwrap();
            assert_eq!(serde_json::to_value(axes).unwrap(), name);
        }
        assert!("xy".parse::<Axes>().is_err());
        assert!(named::<vtex::scene::Edge>("cut").unwrap_err().contains("keep"));
    }

    #[test]
    fn weights_are_five_numbers() {
        assert_eq!("0.5,-0.4, -0.2,-0.5,-0.5".parse(), Ok(FiveWeights::from(Weights::default())));
        for bad in ["", "1,2,3,4", "1,2,3,4,5,6", "1,2,3,4,x"] {
            assert!(bad.parse::<FiveWeights>().is_err(), "{bad}");
            assert!(bad.parse::<WeightsFrom>().is_err(), "{bad}");
        }
    }

    #[test]
    fn weights_may_have_a_name() {
        for good in ["tuned", "a-1_B", "-x"] {
            let weights: WeightsFrom = good.parse().unwrap();
            assert_eq!(serde_json::to_value(&weights).unwrap(), good);
        }
        for bad in ["7", "-0.5", "a.b", "../a", "a b", "ä", &"a".repeat(65)] {
            assert!(bad.parse::<WeightsFrom>().is_err(), "{bad}");
        }
    }
}
