//! Elements: what libraries and scenes are made of, a texton of a photograph or a figure of a drawing.
//!
//! An element is a list of shapes in painting order. Libraries and scenes share the shapes; their other data
//! on an element differ ([`crate::library::ExemplarElement`], [`crate::scene::Element`]).

mod appearance;
mod ellipse;
mod gaussian;
mod gradient;
mod line;
mod rim;
mod shape;
mod similar;
#[cfg(test)]
mod tests;

pub use appearance::Appearance;
pub use ellipse::{Ellipse, Profile};
pub use gaussian::Gaussian;
pub use gaussian::ROUND;
pub use gradient::{Gradient, GradientKind, Stop};
pub(crate) use line::is_default;
pub use line::stroked;
pub use line::{Cap, Join, Line};
pub use rim::SoftRim;
pub use shape::Shape;
pub use similar::{SimilarTo, classes};

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use vtex_base::geometry::{Outline, Rect};

/// Index of an element in the list of its library or scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(transparent)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The index of the element that follows `count` others.
    pub fn after(count: usize) -> Self {
        Self(count as u32)
    }

    /// The index in its list.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Index of a category in the list of its library.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(transparent)]
pub struct CategoryId(pub u16);

impl CategoryId {
    /// The index in its list.
    pub fn index(self) -> usize {
        self.0.into()
    }

    /// The number shown to people, counted from 1.
    pub fn number(self) -> u32 {
        u32::from(self.0) + 1
    }

    /// The category that a text denotes among names: by its name, in any case of letters, or by its number from 1.
    pub fn find(names: &[String], text: &str) -> Option<Self> {
        let lower = text.to_lowercase();
        let number = || text.parse::<usize>().ok()?.checked_sub(1).filter(|&index| index < names.len());
        let index = names.iter().position(|name| name == text);
        let index = index.or_else(|| names.iter().position(|name| name.to_lowercase() == lower));
        index.or_else(number).map(|index| Self(index as u16))
    }

    /// Writes its number instead of the index, for output to people.
    pub fn serialize_number<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u32(self.number())
    }
}

/// Its number.
impl std::fmt::Display for CategoryId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.number().fmt(f)
    }
}

/// The role of a layer: the function of its elements in the texture, which determines how they are treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// A colour field underneath the elements of other layers.
    Background,
    /// Small elements between the large ones, of one shape each. They are clipped at the edge of a
    /// domain and written compactly.
    Secondary,
    /// Large elements, each addressed by its id. At the edge of a domain they follow its rule.
    Primary,
}

impl Role {
    /// The name of the role in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Background => "background",
            Self::Secondary => "secondary",
            Self::Primary => "primary",
        }
    }

    /// Whether each element is individual: it is written as a group with an id, and a domain may keep it
    /// whole. Other layers are textures of many small elements.
    pub fn is_individual(self) -> bool {
        self == Self::Primary
    }
}

/// Reads the shapes of an element. Most elements have one shape, and a list that grows by default would
/// reserve memory for four.
pub(crate) fn deserialize_shapes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Shape>, D::Error> {
    struct ShapesVisitor;

    impl<'de> Visitor<'de> for ShapesVisitor {
        type Value = Vec<Shape>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("a list of shapes")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<Shape>, A::Error> {
            let mut shapes = Vec::with_capacity(1);
            while let Some(shape) = list.next_element()? {
                shapes.push(shape);
            }
            Ok(shapes)
        }
    }

    deserializer.deserialize_seq(ShapesVisitor)
}

/// Bounding box of what shapes paint; empty at the origin if there are none.
pub fn bounds(shapes: &[Shape]) -> Rect {
    let Some((first, details)) = shapes.split_first() else { return Rect::default() };
    let hard = details.iter().filter(|s| !s.is_soft()).map(|s| s.outline.bounds());
    let beyond = first.rim.as_ref().map_or(0.0, |rim| rim.width / 2.0);
    hard.fold(first.outline.bounds().inflate(beyond, beyond), |sum, next| sum.union(next))
}

/// The outline of an element as a whole: its silhouette if it has one of its own, else the outline of
/// its first shape, which contains the others.
pub(crate) fn outline<'a>(silhouette: Option<&'a Outline>, shapes: &'a [Shape]) -> &'a Outline {
    silhouette.unwrap_or(&shapes[0].outline)
}

/// Why shapes and silhouette are invalid; `None` if they are valid.
pub(crate) fn fault(shapes: &[Shape]) -> Option<String> {
    if shapes.is_empty() {
        return Some("has no shapes".into());
    }
    if shapes[0].is_soft() && shapes.len() > 1 {
        return Some("has shapes on a soft ellipse".into());
    }
    if shapes[1..].iter().any(|shape| shape.rim.is_some()) {
        return Some("has a rim that is not along its first shape".into());
    }
    shapes.iter().enumerate().find_map(|(i, shape)| Some(format!("shapes[{i}]: {}", shape.fault()?)))
}
