//! Stroked paths.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::geometry::{Affine, BezPath, Curve, Outline};

/// A path that is stroked. Lengths are in pixels of the element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// The path that the stroke follows.
    pub path: Curve,
    /// Width of the stroke, half on either side. Above 0, up to 10 000.
    pub width: f64,
    /// The form of its ends.
    #[serde(default, skip_serializing_if = "is_default")]
    pub cap: Cap,
    /// The form of its corners.
    #[serde(default, skip_serializing_if = "is_default")]
    pub join: Join,
    /// Largest length of a mitre, in widths; longer ones are bevelled. From 1. Default 4.
    #[serde(default = "miter_limit", skip_serializing_if = "is_miter_limit")]
    pub miter_limit: f64,
    /// Alternating lengths of dashes and gaps, each from 0; empty for a line without gaps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dashes: Vec<f64>,
    /// Length along the dashes at which the path begins.
    #[serde(default, skip_serializing_if = "is_default")]
    pub dash_offset: f64,
}

/// The form of the ends of a stroke, as in SVG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Cap {
    /// Cut off at the end.
    #[default]
    Butt,
    /// A half disc.
    Round,
    /// Half a square.
    Square,
}

/// The form of the corners of a stroke, as in SVG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Join {
    /// Pointed.
    #[default]
    Miter,
    /// A part of a disc.
    Round,
    /// Cut off.
    Bevel,
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn miter_limit() -> f64 {
    4.0
}

fn is_miter_limit(limit: &f64) -> bool {
    *limit == miter_limit()
}

impl Line {
    /// Largest permitted width, in pixels.
    pub const WIDEST: f64 = 1e4;
    /// Largest distance of the outline from the stroke, in pixels.
    const TOLERANCE: f64 = 0.02;

    /// A stroke without dashes, with butt ends and mitred corners.
    pub fn new(path: Curve, width: f64) -> Self {
        let (cap, join) = (Cap::default(), Join::default());
        Self { path, width, cap, join, miter_limit: miter_limit(), dashes: Vec::new(), dash_offset: 0.0 }
    }

    /// The area that the stroke paints; `None` if it cannot be drawn.
    pub(super) fn outline(&self) -> Option<Outline> {
        let cap = match self.cap {
            Cap::Butt => kurbo::Cap::Butt,
            Cap::Round => kurbo::Cap::Round,
            Cap::Square => kurbo::Cap::Square,
        };
        let join = match self.join {
            Join::Miter => kurbo::Join::Miter,
            Join::Round => kurbo::Join::Round,
            Join::Bevel => kurbo::Join::Bevel,
        };
        let stroke = kurbo::Stroke::new(self.width)
            .with_caps(cap)
            .with_join(join)
            .with_miter_limit(self.miter_limit)
            .with_dashes(self.dash_offset, self.dashes.iter().copied());
        Outline::new(&stroked(self.path.path(), stroke, Self::TOLERANCE))
    }

    /// The line with a map that preserves angles applied; `None` beyond ±10⁷ pixels.
    pub(super) fn moved(&self, affine: Affine) -> Option<Self> {
        let size = libm::sqrt(affine.determinant().abs());
        Some(Self {
            path: self.path.moved(affine)?,
            width: self.width * size,
            dashes: self.dashes.iter().map(|d| d * size).collect(),
            dash_offset: self.dash_offset * size,
            ..*self
        })
    }

    /// Why the line is invalid; `None` if it is valid.
    pub(super) fn fault(&self) -> Option<String> {
        let (wide, far) = (self.width > 0.0 && self.width <= Self::WIDEST, |v: f64| !(0.0..1e7).contains(&v));
        if !wide {
            return Some(format!("the width of a line, {}, is not within 0 to {}", self.width, Self::WIDEST));
        }
        if !(self.miter_limit >= 1.0 && self.miter_limit < 1e7) {
            return Some(format!("miter_limit = {} is below 1", self.miter_limit));
        }
        let strange = self.dashes.iter().any(|d| far(*d)) || far(self.dash_offset.abs());
        strange.then(|| "a dash is out of range".into())
    }
}

/// Most dashes along a path.
const MOST_DASHES: f64 = 1e5;

/// Length of a dash, in widths of its stroke, below which only its caps are seen.
const SHORTEST_DASH: f64 = 1e-3;

/// The area that a stroke along a path paints, up to `tolerance`. A stroke of more than 100 000 dashes is
/// drawn without gaps. Dashes without length are painted with their caps, as in SVG.
pub fn stroked(path: &BezPath, mut stroke: kurbo::Stroke, tolerance: f64) -> BezPath {
    let period: f64 = stroke.dash_pattern.iter().sum();
    let dashes = || kurbo::Shape::perimeter(path, 0.1) / period * stroke.dash_pattern.len() as f64;
    let is_dashed = period > 0.0 && dashes() < MOST_DASHES;
    if !is_dashed {
        stroke.dash_pattern.clear();
    }
    if stroke.start_cap != kurbo::Cap::Butt {
        // The library that expands strokes leaves out what has no length.
        let least = (SHORTEST_DASH * stroke.width).min(SHORTEST_DASH * period);
        if stroke.dash_pattern.len() % 2 == 1 {
            stroke.dash_pattern = [stroke.dash_pattern.clone(), stroke.dash_pattern].concat().into();
        }
        stroke.dash_pattern.iter_mut().step_by(2).for_each(|dash| *dash = dash.max(least));
    }
    kurbo::stroke(path, &stroke, &kurbo::StrokeOpts::default(), tolerance)
}
