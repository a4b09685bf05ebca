//! Parameters of synthesis, as stored in the scene.

use super::{Edge, Length, Tile};
use crate::lattice::Lattice;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use vtex_base::Parameter;
use vtex_base::error::{self, check};

/// Parameters of synthesis. Lengths in pixels. Ranges and defaults of numbers are constants, such as
/// [`SynthParams::CANDIDATES`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SynthParams {
    /// Width of the canvas.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SIDE.limits()))]
    pub width: u32,
    /// Height of the canvas.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SIDE.limits()))]
    pub height: u32,
    /// Width and height at which the canvas is printed or shown, such as `300mm`. A period that fits the canvas but for its
    /// rounding to whole pixels is stretched to fit. Default: a pixel of CSS for each pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub page: Option<[Length; 2]>,
    /// Seed of all random choices. Default 0.
    pub seed: u64,
    /// How primaries are placed. Default `auto`. A scene stores the method used.
    pub method: Method,
    /// Number of candidates tried for each placement.
    #[cfg_attr(feature = "schema", schemars(transform = Self::CANDIDATES.limits()))]
    pub candidates: u32,
    /// Number of moves by one cell that may improve a placement.
    #[cfg_attr(feature = "schema", schemars(transform = Self::MOVES.limits()))]
    pub moves: u32,
    /// Weights of the candidates' score.
    pub weights: Weights,
    /// Distance between background points. Default: that of the library.
    #[cfg_attr(feature = "schema", schemars(transform = Self::BACKGROUND_SPACING.limits()))]
    pub background_spacing: Option<f64>,
    /// Axes along which the texture repeats seamlessly. Default none.
    pub tile: Tile,
    /// Largest rotation of a texton in either direction, in degrees. Default: 0, but a photograph with few whole
    /// elements is turned and mirrored where neither its light nor its structure has a direction.
    #[cfg_attr(feature = "schema", schemars(transform = Self::ROTATE.limits()))]
    pub rotate: Option<f64>,
    /// Whether half of the textons, chosen at random, are mirrored. Default false.
    pub mirror: bool,
    /// Largest change of a texton's size in either direction, in per cent.
    #[cfg_attr(feature = "schema", schemars(transform = Self::SCALE_JITTER.limits()))]
    pub scale_jitter: f64,
    /// Treatment of primaries at the edge of a domain. Default `clip`.
    pub edge: Edge,
    /// Parts of the method that are left out, for experiments. Default none.
    pub ablate: Vec<Ablation>,
    /// For [`Method::Period`] the share of the movable elements that leave their place in the period: 0
    /// repeats the exemplar exactly. Default: 0 for a regular exemplar, 1 for another. For
    /// [`Method::Clustered`] and [`Method::Curves`] how readily the exemplar is rearranged. Default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(transform = Self::VARIATION.limits()))]
    pub variation: Option<f64>,
    /// The rows or the lattice that the texture follows, for [`Method::Correspondence`]: `auto`, `off`, or
    /// one or two vectors in pixels of the exemplar, such as `80,0,40,60`. Default `auto`.
    pub lattice: LatticeChoice,
    /// Names of categories that are left out: where their elements stand in the exemplar counts as background.
    /// Default none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub exclude: Vec<String>,
}

/// The lattice that placement by correspondences follows. As text `auto`, `off`, or two or four numbers with
/// commas.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum LatticeChoice {
    /// That of each library, if analysis found one that is regular everywhere ([`Lattice::is_kept`]).
    #[default]
    Auto,
    /// None.
    Off,
    /// One or two vectors in pixels of the exemplar.
    Vectors(Vec<[f64; 2]>),
}

impl LatticeChoice {
    /// The lattice that a texture follows, given the one that analysis found.
    ///
    /// # Errors
    /// Those of [`Lattice::new`].
    pub fn of(&self, found: Option<&Lattice>) -> error::Result<Option<Lattice>> {
        match self {
            Self::Auto => Ok(found.filter(|lattice| lattice.is_kept()).cloned()),
            Self::Off => Ok(None),
            Self::Vectors(vectors) => Lattice::new(vectors).map(Some),
        }
    }

    /// The choice with lengths along x and y multiplied.
    pub fn scaled(&self, by: [f64; 2]) -> Self {
        match self {
            Self::Vectors(vectors) => {
                Self::Vectors(vectors.iter().map(|v| [v[0] * by[0], v[1] * by[1]]).collect())
            }
            other => other.clone(),
        }
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for LatticeChoice {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "LatticeChoice".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        String::json_schema(generator)
    }
}

impl fmt::Display for LatticeChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Off => f.write_str("off"),
            Self::Vectors(vectors) => {
                let numbers: Vec<String> = vectors.iter().flatten().map(f64::to_string).collect();
                f.write_str(&numbers.join(","))
            }
        }
    }
}

impl From<LatticeChoice> for String {
    fn from(choice: LatticeChoice) -> Self {
        choice.to_string()
    }
}

impl TryFrom<String> for LatticeChoice {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for LatticeChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => return Ok(Self::Auto),
            "off" => return Ok(Self::Off),
            _ => {}
        }
        const EXPECTED: &str = "expected auto, off, or one or two vectors in pixels: 80,0 or 80,0,40,60";
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let numbers: Vec<f64> = text.split(',').map(number).collect::<Option<_>>().ok_or(EXPECTED)?;
        let (vectors, []) = numbers.as_chunks::<2>() else { return Err(EXPECTED.into()) };
        match Lattice::new(vectors) {
            Ok(_) => Ok(Self::Vectors(vectors.to_vec())),
            Err(_) => Err("expected one or two vectors of at least 4 px, in different directions".into()),
        }
    }
}

/// How primaries are placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// `curves` for a picture of lines and a drawing of irregular cells, `period` for another periodic drawing,
    /// `clustered` for one of small elements that is not, `descriptor` for others; else `correspondence` if
    /// every library has a guide and no option is set that only `descriptor`
    /// supports (weights of the score, parts of its method left out); otherwise `descriptor`.
    #[default]
    Auto,
    /// Elements are copied along a field that maps each place of the result to a place of the
    /// exemplar. It preserves structure larger than a few elements.
    Correspondence,
    /// Elements are drawn one by one to match the descriptors of their neighbours (paper §3.2.1).
    Descriptor,
    /// The exemplar's own period is repeated, and its movable elements are exchanged, moved and turned.
    /// For one periodic drawing.
    Period,
    /// Elements are clusters of samples, which are optimised until all neighbourhoods look like those of the
    /// exemplar (Tu, Wei and Zwicker 2022). For one drawing.
    Clustered,
    /// Lines that run on are made anew as a graph of curves, in which all neighbourhoods look like those of the
    /// exemplar (Tu, dissertation, chapter 2). For one drawing of lines, or of cells side by side, which come whole in
    /// another order.
    Curves,
}

/// A part of the method that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Ablation {
    /// No secondary textons (paper, table 3).
    Secondary,
    /// Candidates that overlap a placed texton at all are rejected (paper, table 3).
    Overlap,
    /// Coverage is not corrected (paper, table 3).
    Density,
    /// The probability of a texton does not fall after it is used (paper, table 3).
    Decay,
    /// Placements are not improved by moves.
    Improve,
    /// No textons are added where placement leaves gaps.
    Growth,
    /// Surplus textons are removed at random instead of by overlap and fit.
    Removal,
    /// Copies of a texton may be placed next to each other.
    Copies,
    /// Placement starts at a single place.
    Seeds,
    /// Secondaries are scattered one by one instead of by neighbourhoods of the exemplar.
    Neighbourhoods,
    /// Secondaries placed by neighbourhoods keep their exemplar colours, whatever lies beneath (paper, §3.3).
    Matching,
    /// Samples do not know where they lie within their cluster ([`Method::Clustered`]).
    ShapeContext,
    /// Link energy is left out ([`Method::Clustered`]).
    Link,
    /// Shape energy is left out ([`Method::Clustered`]).
    Shape,
    /// Samples do not change clusters ([`Method::Clustered`]).
    Switch,
    /// Clusters are not merged ([`Method::Clustered`]).
    Merge,
    /// Clusters are not split ([`Method::Clustered`]).
    Split,
    /// The painting order is left to chance ([`Method::Clustered`]).
    Depth,
    /// Edges do not count where neighbourhoods are compared ([`Method::Curves`]).
    Edge,
    /// Neighbourhoods are compared without outliers: every sample has to match one ([`Method::Curves`]).
    Robust,
    /// Lines are straight between samples, instead of taking their course from the exemplar ([`Method::Curves`]).
    Orientation,
    /// Samples are neither added nor removed ([`Method::Curves`]).
    Existence,
    /// The first arrangement is noise instead of patches ([`Method::Curves`]).
    Patches,
    /// Loose ends are not joined or removed ([`Method::Curves`]).
    Mend,
}

impl Ablation {
    /// All parts, in the order of declaration.
    pub const ALL: [Self; 24] = [
        Self::Secondary,
        Self::Overlap,
        Self::Density,
        Self::Decay,
        Self::Improve,
        Self::Growth,
        Self::Removal,
        Self::Copies,
        Self::Seeds,
        Self::Neighbourhoods,
        Self::Matching,
        Self::ShapeContext,
        Self::Link,
        Self::Shape,
        Self::Switch,
        Self::Merge,
        Self::Split,
        Self::Depth,
        Self::Edge,
        Self::Robust,
        Self::Orientation,
        Self::Existence,
        Self::Patches,
        Self::Mend,
    ];
}

/// Weights of the five areas in a candidate's score (paper §3.2.1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Weights {
    /// Covered area of the requested region. Default 0.5.
    #[cfg_attr(feature = "schema", schemars(transform = Self::EACH.limits()))]
    pub target: f64,
    /// Uncovered area of the requested region. Default -0.4.
    #[cfg_attr(feature = "schema", schemars(transform = Self::EACH.limits()))]
    pub uncovered: f64,
    /// Covered area that should be empty. Default -0.2.
    #[cfg_attr(feature = "schema", schemars(transform = Self::EACH.limits()))]
    pub empty: f64,
    /// Covered area that should hold another category. Default -0.5.
    #[cfg_attr(feature = "schema", schemars(transform = Self::EACH.limits()))]
    pub mismatched: f64,
    /// Covered area of another region of the same category. Default -0.5.
    #[cfg_attr(feature = "schema", schemars(transform = Self::EACH.limits()))]
    pub same_overlap: f64,
}

impl Weights {
    /// Range of each weight.
    pub const EACH: Parameter<f64> = Parameter::new("weights", [-10.0, 10.0], "each");
}

impl Default for Weights {
    fn default() -> Self {
        Self { target: 0.5, uncovered: -0.4, empty: -0.2, mismatched: -0.5, same_overlap: -0.5 }
    }
}

/// Ranges, units and defaults of the fields of the same names.
#[allow(missing_docs)]
impl SynthParams {
    /// Of the width and the height of the canvas.
    pub const SIDE: Parameter<u32> = Parameter::new("size", [1, 100_000], "px on each side").or(1000);
    pub const CANDIDATES: Parameter<u32> = Parameter::new("candidates", [1, 1000], "").or(20);
    pub const MOVES: Parameter<u32> = Parameter::new("moves", [0, 100], "").or(5);
    pub const ROTATE: Parameter<f64> = Parameter::new("rotate", [0.0, 180.0], "degrees");
    pub const SCALE_JITTER: Parameter<f64> = Parameter::new("scale-jitter", [0.0, 50.0], "per cent").or(0.0);
    pub const VARIATION: Parameter<f64> = Parameter::new("variation", [0.0, 1.0], "");
    pub const BACKGROUND_SPACING: Parameter<f64> = Parameter::new("background-spacing", [4.0, 1000.0], "px");
}

impl Default for SynthParams {
    fn default() -> Self {
        Self {
            width: Self::SIDE.default(),
            height: Self::SIDE.default(),
            page: None,
            seed: 0,
            method: Method::default(),
            candidates: Self::CANDIDATES.default(),
            moves: Self::MOVES.default(),
            weights: Weights::default(),
            background_spacing: None,
            tile: Tile::default(),
            rotate: None,
            mirror: false,
            scale_jitter: Self::SCALE_JITTER.default(),
            edge: Edge::default(),
            ablate: Vec::new(),
            variation: None,
            lattice: LatticeChoice::default(),
            exclude: Vec::new(),
        }
    }
}

impl SynthParams {
    /// Checks every range.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] naming the first parameter out of range.
    pub fn validate(&self) -> vtex_base::Result<()> {
        let Self { width, height, weights: w, .. } = self;
        let fits = Self::SIDE.allows(*width) && Self::SIDE.allows(*height);
        check(fits, "size", format!("{width}x{height}"), Self::SIDE.to_string())?;
        Self::CANDIDATES.check(self.candidates)?;
        Self::MOVES.check(self.moves)?;
        for value in [w.target, w.uncovered, w.empty, w.mismatched, w.same_overlap] {
            Weights::EACH.check(value)?;
        }
        self.background_spacing.map_or(Ok(()), |spacing| Self::BACKGROUND_SPACING.check(spacing))?;
        self.variation.map_or(Ok(()), |variation| Self::VARIATION.check(variation))?;
        if let LatticeChoice::Vectors(vectors) = &self.lattice {
            Lattice::new(vectors)?;
        }
        self.rotate.map_or(Ok(()), |angle| Self::ROTATE.check(angle))?;
        Self::SCALE_JITTER.check(self.scale_jitter)
    }

    /// Whether elements are turned, mirrored or resized.
    pub fn varies(&self) -> bool {
        self.rotate.is_some_and(|angle| angle > 0.0) || self.mirror || self.scale_jitter > 0.0
    }

    /// Whether a part of the method is left out.
    pub fn without(&self, part: Ablation) -> bool {
        self.ablate.contains(&part)
    }
}
