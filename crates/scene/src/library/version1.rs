//! Libraries of version 1, which kept primaries, secondaries and background apart.

use super::{
    AnalyzeParams, Arrangement, Category, CategoryId, ExemplarElement, Gradient, Guide, Library, Shape,
    Source, SourceKind,
};
use crate::element::version1::{Version1Detail, shapes};
use crate::scene::{ControlPoint, Field};
use serde::Deserialize;
use vtex_base::geometry::Outline;
use vtex_base::raster::colour::Colour;

/// A library as version 1 stores it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LibraryVersion1 {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u32,
    source: Version1Source,
    primaries: Vec<Primary>,
    secondaries: Secondaries,
    categories: Vec<Category>,
    coverage: f64,
    background: Version1Background,
    arrangement: Arrangement,
    descriptor_half: u32,
    #[serde(default)]
    guide: Option<Guide>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Version1Source {
    file: String,
    width: u32,
    height: u32,
    sha256: String,
    segmenter: String,
    parameters: AnalyzeParams,
    program: String,
    #[serde(default)]
    warnings: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Primary {
    id: u32,
    outline: Outline,
    colour: Colour,
    base: Colour,
    #[serde(default)]
    gradient: Option<Box<Gradient>>,
    category: CategoryId,
    area: u32,
    centroid: [f64; 2],
    compactness: f64,
    #[serde(default)]
    clipped: bool,
    details: Vec<Version1Detail>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Secondaries {
    spacing: f64,
    textons: Vec<Version1Secondary>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Version1Secondary {
    outline: Outline,
    colour: Colour,
    difference: [i16; 3],
    area: u32,
    centroid: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Version1Background {
    spacing: f64,
    fallback: Colour,
    sites: Vec<ControlPoint>,
}

impl TryFrom<LibraryVersion1> for Library {
    type Error = String;

    fn try_from(old: LibraryVersion1) -> Result<Self, String> {
        if let Some((i, p)) = old.primaries.iter().enumerate().find(|(i, p)| p.id as usize != *i) {
            return Err(format!("primaries[{i}].id is {}", p.id));
        }
        let primaries = old.primaries.into_iter().map(ExemplarElement::from);
        let elements: Vec<ExemplarElement> =
            primaries.chain(old.secondaries.textons.into_iter().map(ExemplarElement::from)).collect();
        let Version1Background { spacing, fallback, sites } = old.background;
        let background = Field { spacing, fallback, points: sites };
        let s = old.source;
        let periodic = s.parameters.wrap;
        Ok(Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            source: Source {
                strata_reason: None,
                kind: SourceKind::Photograph,
                file: s.file,
                width: s.width,
                height: s.height,
                scale: [1.0; 2],
                copies: [1; 2],
                contrast: 1.0,
                sha256: s.sha256,
                segmenter: s.segmenter,
                parameters: s.parameters,
                program: s.program,
                warnings: s.warnings,
            },
            layers: Self::three_layers(&elements, background, old.secondaries.spacing),
            elements,
            categories: old.categories,
            coverage: old.coverage,
            arrangement: Arrangement { periodic, ..old.arrangement },
            descriptor_half: old.descriptor_half,
            guide: old.guide,
            lattice: None,
            motifs: Vec::new(),
        })
    }
}

impl From<Primary> for ExemplarElement {
    fn from(old: Primary) -> Self {
        Self {
            category: Some(old.category),
            colour: old.colour,
            difference: None,
            area: old.area,
            centroid: old.centroid,
            compactness: Some(old.compactness),
            clipped: old.clipped,
            silhouette: None,
            shapes: shapes(old.outline, old.base, old.gradient, old.details),
        }
    }
}

impl From<Version1Secondary> for ExemplarElement {
    fn from(old: Version1Secondary) -> Self {
        Self {
            category: None,
            colour: old.colour,
            difference: Some(old.difference),
            area: old.area,
            centroid: old.centroid,
            compactness: None,
            clipped: false,
            silhouette: None,
            shapes: vec![Shape::new(old.outline, old.colour)],
        }
    }
}
