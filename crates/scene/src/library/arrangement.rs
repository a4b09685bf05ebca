//! The arrangement: a run-length coded map of the primaries in the exemplar.
//!
//! Descriptors (paper §3.1.3) are windows of this one map, so it is stored instead of a category map for
//! each primary, with the half side of the windows. That takes kilobytes instead of megabytes. Labels are
//! identities, not categories: synthesis can tell two touching stones of one category apart, and the map
//! draws the exemplar back. Outside the exemplar a window is undefined, so primaries near its border keep
//! their descriptors; only those cut by it are never placed.

use super::LARGEST_SIDE;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::{DeserializeSeed, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;
use vtex_base::raster::LabelMap;

/// The map of primaries over the exemplar, row by row.
///
/// Descriptors are not stored individually. Each is a window of this map around its texton, extended
/// by the textons that reach out of it, and is derived from the map when needed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Arrangement {
    /// Width, in pixels.
    pub width: u32,
    /// Height, in pixels.
    pub height: u32,
    /// Whether left and right borders join, and top and bottom borders too. Default false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub periodic: bool,
    /// `label, length, label, length, …` over all rows in turn. Label 0 is background, label k is primary
    /// k - 1. Lengths add up to `width * height`.
    pub runs: Vec<u32>,
    /// Where elements stood that are not placed: runs as above, with label 1 for their pixels, which `runs` counts as
    /// background. Empty (the default) for none. Never stored.
    #[serde(skip)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub vacated: Vec<u32>,
}

/// Reads field by field, so that a short file cannot expand to more runs than the map has room for.
impl<'de> Deserialize<'de> for Arrangement {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ArrangementVisitor)
    }
}

struct ArrangementVisitor;

impl<'de> Visitor<'de> for ArrangementVisitor {
    type Value = Arrangement;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an arrangement: width, height and runs")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Arrangement, A::Error> {
        let (mut width, mut height, mut runs): (Option<u32>, Option<u32>, _) = (None, None, None);
        let mut periodic = None;
        while let Some(name) = fields.next_key::<String>()? {
            match &*name {
                "width" if width.is_none() => width = Some(fields.next_value()?),
                "height" if height.is_none() => height = Some(fields.next_value()?),
                "periodic" if periodic.is_none() => periodic = Some(fields.next_value()?),
                "runs" if runs.is_none() => {
                    // If the size comes later, the largest size applies.
                    let [w, h] =
                        [width, height].map(|v| v.unwrap_or(LARGEST_SIDE).min(LARGEST_SIDE) as usize);
                    runs = Some(fields.next_value_seed(RunsVisitor { most: 2 * w * h })?);
                }
                "width" | "height" | "periodic" | "runs" => {
                    return Err(A::Error::custom(format!("duplicate field `{name}`")));
                }
                other => {
                    return Err(A::Error::unknown_field(other, &["width", "height", "periodic", "runs"]));
                }
            }
        }
        let missing = A::Error::missing_field;
        Ok(Arrangement {
            width: width.ok_or_else(|| missing("width"))?,
            height: height.ok_or_else(|| missing("height"))?,
            periodic: periodic.unwrap_or(false),
            runs: runs.ok_or_else(|| missing("runs"))?,
            vacated: Vec::new(),
        })
    }
}

/// The runs of a map, limited to `most` numbers.
struct RunsVisitor {
    most: usize,
}

impl<'de> DeserializeSeed<'de> for RunsVisitor {
    type Value = Vec<u32>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<u32>, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for RunsVisitor {
    type Value = Vec<u32>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of labels and lengths")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Vec<u32>, A::Error> {
        let mut runs = Vec::new();
        while let Some(entry) = entries.next_element()? {
            if runs.len() == self.most {
                return Err(A::Error::custom(format!(
                    "arrangement.runs has more than {} entries, two for each pixel",
                    self.most
                )));
            }
            runs.push(entry);
        }
        Ok(runs)
    }
}

/// The runs of a map, row by row.
fn runs_of(map: &LabelMap) -> Vec<u32> {
    map.labels.chunk_by(|a, b| a == b).flat_map(|run| [run[0], run.len() as u32]).collect()
}

impl Arrangement {
    /// Encodes a label map in which label k is primary k - 1 and 0 is background.
    pub fn from_labels(map: &LabelMap) -> Self {
        Self {
            width: map.width,
            height: map.height,
            periodic: false,
            runs: runs_of(map),
            vacated: Vec::new(),
        }
    }

    /// The arrangement with the pixels where elements stood that are not placed: those with label 1.
    #[must_use]
    pub fn with_vacated(self, map: Option<&LabelMap>) -> Self {
        Self { vacated: map.map_or_else(Vec::new, runs_of), ..self }
    }

    /// The pixels where elements stood that are not placed: label 1; `None` if there are none.
    pub fn vacated_labels(&self) -> Option<LabelMap> {
        (!self.vacated.is_empty()).then(|| self.expanded(&self.vacated))
    }

    /// Decodes the label map. The arrangement must be valid (see [`Arrangement::check`]).
    pub fn to_labels(&self) -> LabelMap {
        self.expanded(&self.runs)
    }

    fn expanded(&self, runs: &[u32]) -> LabelMap {
        let mut labels = Vec::with_capacity(self.width as usize * self.height as usize);
        for run in runs.chunks_exact(2) {
            labels.extend(std::iter::repeat_n(run[0], run[1] as usize));
        }
        labels.resize(self.width as usize * self.height as usize, 0);
        LabelMap { width: self.width, height: self.height, labels }
    }

    /// Checks that the runs cover the map exactly and contain no label above `largest`.
    ///
    /// # Errors
    /// A description of the first fault.
    pub fn check(&self, largest: u32) -> Result<(), String> {
        let pairs = self.runs.chunks_exact(2);
        if !pairs.remainder().is_empty() {
            return Err("arrangement.runs has an odd number of entries".into());
        }
        let mut total = 0u64;
        for run in pairs {
            if run[0] > largest {
                return Err(format!("arrangement.runs names primary {}, there are {largest}", run[0]));
            }
            total += u64::from(run[1]);
        }
        let wanted = u64::from(self.width) * u64::from(self.height);
        if total != wanted {
            return Err(format!("arrangement.runs covers {total} pixels, not {wanted}"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Arrangement, String> {
        serde_json::from_str(text).map_err(|e| e.to_string())
    }

    #[test]
    fn fields_come_in_any_order_and_once() {
        let wanted =
            Arrangement { width: 3, height: 1, periodic: true, runs: vec![0, 3], vacated: Vec::new() };
        assert_eq!(read(&serde_json::to_string(&wanted).unwrap()), Ok(wanted.clone()));
        assert_eq!(read(r#"{"runs":[0,3],"height":1,"periodic":true,"width":3}"#), Ok(wanted));
        for (text, message) in [
            (r#"{"runs":[0,3],"height":1}"#, "missing field `width`"),
            (r#"{"runs":[],"height":1,"height":1}"#, "duplicate field `height`"),
            (r#"{"runs":[],"depth":1}"#, "unknown field `depth`"),
            (r#"{"runs":[-1]}"#, "expected u32"),
            ("[1]", "an arrangement"),
        ] {
            assert!(read(text).unwrap_err().contains(message), "{text}: {:?}", read(text));
        }
    }

    #[test]
    fn runs_are_bounded_by_the_size() {
        let text = format!(r#"{{"width":4,"height":2,"runs":[{}0]}}"#, "0,".repeat(16));
        assert!(read(&text).unwrap_err().contains("more than 16 entries"));
        assert!(read(&text.replace("[0,", "[")).is_ok());
    }
}
