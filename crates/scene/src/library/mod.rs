//! The library of elements: the result of analysing an exemplar (`*.lib.json`).

mod arrangement;
mod categories;
mod contrast;
mod excluded;
mod guide;
mod instance;
mod layer_count;
mod motif;
mod parameters;
mod pixel_limit;
mod recolour;
mod strata;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
mod units;
mod validate;

pub use arrangement::Arrangement;
pub use categories::Categories;
pub use contrast::Contrast;
pub use guide::{Guide, Picture};
pub use instance::ExemplarInstance;
pub use motif::{Motif, MotifPart};
pub use parameters::{AnalyzeParams, EvenLight, Grouping, MotifGrouping, PictureKind, Shading};
pub use recolour::Stretch;
pub use strata::Stratum;

use crate::element;
pub use crate::element::{CategoryId, ElementId, Gradient, Role, Shape};
pub use crate::lattice::Lattice;
use crate::scene::{Field, LibraryRef};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use vtex_base::document;
use vtex_base::document::Document;
use vtex_base::geometry::Outline;
use vtex_base::raster::colour::Colour;
use vtex_base::raster::colour_names;

/// Largest side of an exemplar, in pixels.
const LARGEST_SIDE: u32 = 16_384;

/// Pixels of the arrangement for each unit of a drawing above which a tenth of a unit is visible.
const FINE: f64 = 4.0;

/// The result of analysing one exemplar. Coordinates are pixels of the photograph, or units of the drawing,
/// x right, y down, pixel centres at .5; colours are 8-bit sRGB. The arrangement and the guide may have
/// another resolution ([`Source::scale`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Library {
    /// Always `vtex-library`.
    pub format: String,
    /// Version of the format; this is 2.
    pub version: u32,
    /// The exemplar, and how it was analysed.
    pub source: Source,
    /// The elements: primaries, which have a category, before secondaries, which have none.
    pub elements: Vec<ExemplarElement>,
    /// The layers of the exemplar, in painting order.
    pub layers: Vec<ExemplarLayer>,
    /// Clusters of similar primaries.
    pub categories: Vec<Category>,
    /// Share of the exemplar covered by primaries, 0 to 1.
    pub coverage: f64,
    /// Map of the primaries in the exemplar. Descriptors are windows of this map.
    pub arrangement: Arrangement,
    /// Half the side of a descriptor's window, in pixels of the arrangement. By default 2.25 mean neighbour distances.
    pub descriptor_half: u32,
    /// The exemplar's colours on a coarse grid, which placement by correspondences follows. `None` in
    /// libraries of older versions; their textons are placed by descriptors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guide: Option<Guide>,
    /// Translations under which the exemplar looks the same; `None` if it has no rows and no lattice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lattice: Option<Lattice>,
    /// Elements of a drawing that belong together; each is a part of one motif or of none. Default: none are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motifs: Vec<Motif>,
}

/// The kind of an exemplar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SourceKind {
    /// A photograph, or any other raster image.
    Photograph,
    /// A vector drawing.
    Drawing,
}

/// The origin of a library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The kind of the exemplar.
    pub kind: SourceKind,
    /// File name of the exemplar, without its folder.
    pub file: String,
    /// Width of the exemplar, in pixels of the photograph or units of the drawing.
    pub width: u32,
    /// Height of the exemplar, in the same unit.
    pub height: u32,
    /// Pixels of the arrangement for each pixel of the photograph or unit of the drawing, along x and y. Below
    /// 1 for a photograph that was reduced before it was analysed. Default 1.
    #[serde(default = "same_scale", skip_serializing_if = "is_same_scale")]
    pub scale: [f64; 2],
    /// Number of copies of a small tile along x and y that make the exemplar: the tile was repeated before it was
    /// analysed, and width and height are those of all copies. Default 1 and 1.
    #[serde(default = "one_copy", skip_serializing_if = "is_one_copy")]
    pub copies: [u32; 2],
    /// How the copies of a periodic drawing overlap, as scales in rows do: by how many instances of their layer those one
    /// period further along x and y are painted later. Default 0 and 0: copies are painted instance by instance.
    #[serde(default, skip_serializing_if = "crate::element::is_default")]
    pub stacking: [i32; 2],
    /// Factor by which the contrast was stretched before the analysis. The library has the colours of the exemplar.
    /// Default 1.
    #[serde(default = "not_stretched", skip_serializing_if = "is_not_stretched")]
    #[cfg_attr(feature = "schema", schemars(transform = AnalyzeParams::CONTRAST.limits()))]
    pub contrast: f64,
    /// How many times as bright as the darkest place the brightest was lit, if that light was taken out before the
    /// analysis. The library has the colours of the even picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<f64>,
    /// SHA-256 of the exemplar's file, in hexadecimal.
    pub sha256: String,
    /// Name of the segmenter that made the masks, such as `regions`.
    pub segmenter: String,
    /// Parameters of the analysis, with all defaults filled in.
    pub parameters: AnalyzeParams,
    /// Name and version of the program that made the library.
    pub program: String,
    /// Reason for the number of strata: a clause without a full stop. `None` if nothing was decided.
    #[serde(default, rename = "layers", skip_serializing_if = "Option::is_none")]
    pub strata_reason: Option<String>,
    /// Warnings of the analysis, one sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

fn same_scale() -> [f64; 2] {
    [1.0; 2]
}

fn is_same_scale(scale: &[f64; 2]) -> bool {
    *scale == same_scale()
}

fn one_copy() -> [u32; 2] {
    [1; 2]
}

fn is_one_copy(copies: &[u32; 2]) -> bool {
    *copies == one_copy()
}

fn not_stretched() -> f64 {
    1.0
}

fn is_not_stretched(contrast: &f64) -> bool {
    *contrast == not_stretched()
}

/// An element of the exemplar: a texton of a photograph.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ExemplarElement {
    /// Category of similar primaries; `None` for a secondary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub category: Option<CategoryId>,
    /// Median colour of its pixels.
    pub colour: Colour,
    /// Colour minus the background field at the centroid, per sRGB component, -255 to 255. If it is given, a
    /// placed element takes its colour from the field beneath it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<[i16; 3]>,
    /// Area, in pixels of the arrangement.
    pub area: u32,
    /// Centroid.
    pub centroid: [f64; 2],
    /// Polsby–Popper compactness of the outline, 4π · area / perimeter², 0 to 1. `None` for a
    /// secondary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compactness: Option<f64>,
    /// Whether it is cut off by the border of the exemplar. Such an element belongs to the arrangement
    /// but is never placed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clipped: bool,
    /// The outline of the whole, if that is not the outline of the first shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub silhouette: Option<Outline>,
    /// Its shapes at its position in the exemplar, in painting order; at least one. The first covers the
    /// whole. Each extends a little underneath later ones.
    #[serde(deserialize_with = "element::deserialize_shapes")]
    pub shapes: Vec<Shape>,
}

impl ExemplarElement {
    /// The outline of the whole: its silhouette, or the outline of its first shape.
    pub fn outline(&self) -> &Outline {
        element::outline(self.silhouette.as_ref(), &self.shapes)
    }

    /// The shape that is painted first.
    pub fn base(&self) -> &Shape {
        &self.shapes[0]
    }

    /// The shapes that are painted on the first.
    pub fn details(&self) -> &[Shape] {
        &self.shapes[1..]
    }

    /// Its reference point: the centroid in whole pixels.
    pub fn origin(&self) -> [i32; 2] {
        self.centroid.map(|v| libm::round(v) as i32)
    }
}

/// A layer of the exemplar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ExemplarLayer {
    /// Its name, unique within the library. Not empty.
    pub name: String,
    /// The function of its elements in the texture.
    pub role: Role,
    /// The part of the exemplar that it fills; `None` for all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Outline>,
    /// Its colour in layer maps, for a background with a region or layers above it that have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
    /// Colours sampled between the elements: the control points of a colour field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<Field>,
    /// Typical distance between neighbouring secondaries, in pixels; 0 if there are fewer than three.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f64>,
    /// The placed elements, in painting order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instances: Vec<ExemplarInstance>,
}

impl ExemplarLayer {
    /// An empty layer named after its role.
    pub fn new(role: Role) -> Self {
        let name = role.name().into();
        Self { name, role, region: None, colour: None, field: None, spacing: None, instances: Vec::new() }
    }
}

/// A cluster of similar primaries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Category {
    /// The name that a user has given to it: 1 to 100 letters, digits, blanks and hyphens, different from those of
    /// others. Either all categories have one or none has; then [`Library::category_names`] makes them from
    /// colours and sizes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Mean of its members' features: red, green, blue (0 to 255), area (pixels of the arrangement), compactness (0 to 1).
    pub centre: [f64; 5],
    /// Number of members.
    pub members: u32,
    /// Share of the exemplar that its members cover, 0 to 1.
    pub coverage: f64,
}

impl Category {
    /// Mean colour of its members.
    pub fn colour(&self) -> Colour {
        let [red, green, blue, ..] = self.centre;
        Colour::from_f64([red, green, blue])
    }
}

impl Library {
    /// Whether the exemplar is a drawing.
    pub fn is_drawing(&self) -> bool {
        self.source.kind == SourceKind::Drawing
    }

    /// Whether the library was made of a picture of lines.
    pub fn is_line_art(&self) -> bool {
        self.source.parameters.kind == PictureKind::Curves
    }

    /// Plain names of the categories, in their order, all different: those that a user has given to them, or
    /// words for their mean colours, and for their sizes where colours are alike. Scenes, SVGs and reports use the same names.
    pub fn category_names(&self) -> Vec<String> {
        if let Some(given) = self.categories.iter().map(|c| c.name.clone()).collect() {
            return given;
        }
        let looks: Vec<(Colour, f64)> = self.categories.iter().map(|c| (c.colour(), c.centre[3])).collect();
        colour_names::distinct_sized(&looks)
    }

    /// The reference to the library that a scene stores.
    pub fn reference(&self) -> LibraryRef {
        LibraryRef {
            exemplar: self.source.file.clone(),
            sha256: self.source.sha256.clone(),
            categories: self.category_names(),
            fine: self.pixels_per_unit() > FINE,
        }
    }

    /// The borders of the cells of a lattice around its primaries ([`Lattice::cells`]), as path data of SVG in pixels of
    /// the exemplar.
    pub fn path_of_cells(&self, lattice: &Lattice) -> String {
        let centres: Vec<[f64; 2]> = self.primaries().iter().map(|p| p.centroid).collect();
        let size = [self.source.width, self.source.height].map(f64::from);
        let lines = lattice.cells(&centres, size);
        lines.iter().map(|[a, b]| format!("M{:.1} {:.1}L{:.1} {:.1}", a[0], a[1], b[0], b[1])).collect()
    }

    /// The primaries: large distinct elements, each with a category. Their order is that of the labels
    /// of the arrangement.
    pub fn primaries(&self) -> &[ExemplarElement] {
        &self.elements[..self.primary_count()]
    }

    /// The secondaries: small elements between the primaries.
    pub fn secondaries(&self) -> &[ExemplarElement] {
        &self.elements[self.primary_count()..]
    }

    fn primary_count(&self) -> usize {
        self.elements.partition_point(|e| e.category.is_some())
    }

    /// Index of the secondary with the given number among the secondaries.
    pub fn secondary_id(&self, number: u32) -> ElementId {
        ElementId::after(self.primary_count() + number as usize)
    }

    /// Typical distance between neighbouring secondaries, in pixels; 0 if it is not known.
    pub fn secondary_spacing(&self) -> f64 {
        self.layers.iter().find_map(|layer| layer.spacing).unwrap_or(0.0)
    }

    /// The three layers of a homogeneous photograph, with elements at the places of their shapes.
    pub fn three_layers(elements: &[ExemplarElement], background: Field, spacing: f64) -> Vec<ExemplarLayer> {
        let primaries = elements.partition_point(|e| e.category.is_some());
        let of = |range: Range<usize>| range.map(|i| ExemplarInstance::of(ElementId::after(i))).collect();
        vec![
            ExemplarLayer { field: Some(background), ..ExemplarLayer::new(Role::Background) },
            ExemplarLayer {
                spacing: Some(spacing),
                instances: of(primaries..elements.len()),
                ..ExemplarLayer::new(Role::Secondary)
            },
            ExemplarLayer { instances: of(0..primaries), ..ExemplarLayer::new(Role::Primary) },
        ]
    }
}

document!(Library, "vtex-library", 2);

impl Document for Library {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> Result<(), String> {
        validate::validate(self)
    }
}
