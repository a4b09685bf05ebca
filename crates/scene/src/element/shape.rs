//! Shapes and their paint.

use super::{Ellipse, Gradient, Line, Profile, SoftRim};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};
use vtex_base::geometry::{Affine, Outline};
use vtex_base::raster::colour::Colour;

/// A shape of an element: a filled outline, a stroked path, or a soft ellipse.
///
/// A stroked path is stored as its line, a soft ellipse as its matrix; the outline, the area that the stroke
/// paints or the ellipse's rim, is derived when it is read, so that all other code handles outlines only.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(try_from = "StoredShape")]
#[cfg_attr(feature = "schema", schemars(with = "StoredShape"))]
pub struct Shape {
    /// Its outline, in the coordinates of the element.
    pub outline: Outline,
    /// The stroked path that has this outline; `None` for a filled outline.
    pub line: Option<Box<Line>>,
    /// The soft ellipse that has this outline as its rim; `None` for other shapes. As the first shape of an element
    /// it is the only one.
    pub ellipse: Option<Box<Ellipse>>,
    /// Fill or stroke colour; if there is a gradient, its mean colour.
    pub colour: Colour,
    /// Gradient that replaces the colour. Few shapes have one.
    pub gradient: Option<Box<Gradient>>,
    /// Opacity, 0 to 1. Default 1.
    pub opacity: f64,
    /// The soft rim of the element of which this is the first shape, a filled outline. Few have one.
    pub rim: Option<Box<SoftRim>>,
}

/// A shape as files hold it: with an outline, a line or an ellipse.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Shape"))]
#[serde(deny_unknown_fields)]
struct StoredShape {
    /// A filled outline, in the coordinates of the element.
    #[serde(default)]
    outline: Option<Outline>,
    /// A stroked path, in place of the outline.
    #[serde(default)]
    line: Option<Box<Line>>,
    /// A soft ellipse, in place of the outline.
    #[serde(default)]
    ellipse: Option<Box<Ellipse>>,
    /// Fill or stroke colour; if there is a gradient, its mean colour.
    colour: Colour,
    /// Gradient that replaces the colour. A soft ellipse has none.
    #[serde(default)]
    gradient: Option<Box<Gradient>>,
    /// Opacity, 0 to 1. Default 1.
    #[serde(default = "opaque")]
    opacity: f64,
    /// The soft rim of the element of which this is the first shape, a filled outline. Default none.
    #[serde(default)]
    rim: Option<Box<SoftRim>>,
}

fn opaque() -> f64 {
    1.0
}

impl TryFrom<StoredShape> for Shape {
    type Error = String;

    fn try_from(stored: StoredShape) -> Result<Self, String> {
        let StoredShape { outline, line, ellipse, colour, gradient, opacity, rim } = stored;
        let outline = match (outline, &line, &ellipse) {
            (Some(outline), None, None) => outline,
            (None, Some(line), None) => match line.fault() {
                Some(fault) => return Err(fault),
                None => line.outline().ok_or("a line leads out of range")?,
            },
            (None, None, Some(ellipse)) => match ellipse.fault() {
                Some(fault) => return Err(fault),
                None => ellipse.outline().ok_or("an ellipse leads out of range")?,
            },
            _ => return Err("a shape has an outline, a line or an ellipse".into()),
        };
        Ok(Self { outline, line, ellipse, colour, gradient, opacity, rim })
    }
}

impl Serialize for Shape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let opacity = (self.opacity != opaque()).then_some(self.opacity);
        let more = [self.gradient.is_some(), opacity.is_some(), self.rim.is_some()];
        let count = 2 + more.into_iter().filter(|has| *has).count();
        let mut shape = serializer.serialize_struct("Shape", count)?;
        match (&self.line, &self.ellipse) {
            (Some(line), _) => shape.serialize_field("line", line)?,
            (None, Some(ellipse)) => shape.serialize_field("ellipse", ellipse)?,
            (None, None) => shape.serialize_field("outline", &self.outline)?,
        }
        shape.serialize_field("colour", &self.colour)?;
        match &self.gradient {
            Some(gradient) => shape.serialize_field("gradient", gradient)?,
            None => shape.skip_field("gradient")?,
        }
        match opacity {
            Some(opacity) => shape.serialize_field("opacity", &opacity)?,
            None => shape.skip_field("opacity")?,
        }
        match &self.rim {
            Some(rim) => shape.serialize_field("rim", rim)?,
            None => shape.skip_field("rim")?,
        }
        shape.end()
    }
}

impl Shape {
    /// An opaque filled shape of one colour.
    pub fn new(outline: Outline, colour: Colour) -> Self {
        Self { outline, line: None, ellipse: None, colour, gradient: None, opacity: opaque(), rim: None }
    }

    /// An opaque stroked path of one colour; `None` if its outline leaves the permitted coordinates, or its
    /// width, mitre limit or dashes are invalid.
    pub fn stroked(line: Line, colour: Colour) -> Option<Self> {
        let outline = line.outline().filter(|_| line.fault().is_none())?;
        Some(Self { line: Some(Box::new(line)), ..Self::new(outline, colour) })
    }

    /// A soft ellipse of one colour; `None` if its rim leaves the permitted coordinates.
    pub fn of_ellipse(ellipse: Ellipse, colour: Colour) -> Option<Self> {
        let outline = ellipse.outline().filter(|_| ellipse.fault().is_none())?;
        Some(Self { ellipse: Some(Box::new(ellipse)), ..Self::new(outline, colour) })
    }

    /// Whether it is a soft ellipse, of either profile. It is seen only within the first shape of its element, unless
    /// it is the first.
    pub fn is_soft(&self) -> bool {
        self.ellipse.is_some()
    }

    /// The area that it paints, in pixels²; that of a soft ellipse weighed by its opacity.
    pub fn area(&self) -> f64 {
        self.outline.area() * self.ellipse.as_ref().map_or(1.0, |ellipse| ellipse.profile.mean_opacity())
    }

    /// The shape with a map that preserves angles applied. The outline stays as it was where the map
    /// leads beyond ±10⁷ pixels.
    pub fn moved(&self, affine: Affine) -> Self {
        let ellipse = self.ellipse.as_ref().and_then(|ellipse| ellipse.moved(affine));
        // Files hold an ellipse without its outline, so this is that of the moved ellipse.
        let rim_of_ellipse = ellipse.as_ref().and_then(Ellipse::outline);
        Self {
            outline: rim_of_ellipse.unwrap_or_else(|| self.outline.moved(affine)),
            line: self.line.as_ref().and_then(|line| line.moved(affine)).map(Box::new),
            ellipse: ellipse.map(Box::new),
            gradient: self.gradient.as_ref().map(|g| Box::new(g.moved(affine))),
            rim: self.rim.as_ref().map(|rim| Box::new(rim.moved(affine))),
            ..*self
        }
    }

    /// The soft ellipse whose rim has the moments of an outline; `None` if the outline is degenerate.
    pub fn soft_along(outline: &Outline, colour: Colour, profile: Profile) -> Option<Self> {
        Self::of_ellipse(Ellipse::of_outline(outline, profile)?, colour)
    }

    /// The shape filled, with another outline; a soft ellipse becomes the one along it.
    pub fn with_outline(&self, outline: Outline) -> Self {
        let soft = self.ellipse.as_ref().and_then(|e| Self::soft_along(&outline, self.colour, e.profile));
        match soft {
            Some(soft) => Self { opacity: self.opacity, ..soft },
            None => Self {
                outline,
                line: None,
                ellipse: None,
                gradient: self.gradient.clone(),
                rim: self.rim.clone(),
                ..*self
            },
        }
    }

    /// The shape with all its colours changed.
    pub fn recoloured(&self, new: impl Fn(Colour) -> Colour) -> Self {
        Self {
            colour: new(self.colour),
            gradient: self.gradient.as_ref().map(|g| Box::new(g.recoloured(&new))),
            rim: self.rim.as_ref().map(|rim| Box::new(SoftRim { colour: new(rim.colour), ..**rim })),
            ..self.clone()
        }
    }

    /// Why the shape is invalid; `None` if it is valid.
    pub(super) fn fault(&self) -> Option<String> {
        if !(0.0..=1.0).contains(&self.opacity) {
            return Some(format!("opacity = {} is not within 0 to 1", self.opacity));
        }
        if let Some(fault) = self.line.as_ref().and_then(|line| line.fault()) {
            return Some(fault);
        }
        if self.ellipse.is_some() && self.gradient.is_some() {
            return Some("a soft ellipse has a gradient".into());
        }
        if let Some(fault) = self.ellipse.as_ref().and_then(|ellipse| ellipse.fault()) {
            return Some(fault);
        }
        if let Some(rim) = &self.rim {
            if self.ellipse.is_some() || self.line.is_some() {
                return Some("a rim is not along a filled outline".into());
            }
            if let Some(fault) = rim.fault() {
                return Some(fault);
            }
        }
        Some(format!("a gradient {}", self.gradient.as_ref()?.fault()?))
    }
}
