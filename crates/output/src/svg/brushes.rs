//! Soft ellipses in SVG: one circle of each colour, seen through matrices.
//!
//! A circle of radius 1 is filled with a radial gradient in units of the user, which Chromium, Firefox, Inkscape,
//! librsvg and resvg draw alike. A reference to it takes some 70 bytes, and ten in a packed file.

use super::gradients::write_stops;
use super::number::{Number, list};
use super::xml::{ViewerLoad, Xml};
use std::collections::BTreeMap;
use std::io::{self, Write};
use vtex_base::geometry::Affine;
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Ellipse;
use vtex_scene::scene::{Scene, Shape};

/// The colours of all soft ellipses of a scene.
pub(super) struct Brushes {
    numbers: BTreeMap<Colour, usize>,
    /// Whether each ellipse is a circle of its own in place of a reference to one.
    expand: bool,
    precision: u8,
}

impl Brushes {
    pub(super) fn new(scene: &Scene, expand: bool, precision: u8) -> Self {
        let shapes = scene.elements.iter().flat_map(|e| e.details());
        let mut numbers: BTreeMap<Colour, usize> = BTreeMap::new();
        for shape in shapes.filter(|s| s.is_soft()) {
            numbers.insert(shape.colour, 0);
        }
        numbers.values_mut().enumerate().for_each(|(i, number)| *number = i);
        Self { numbers, expand, precision }
    }

    /// Gradients and circles, for `<defs>`.
    pub(super) fn write_definitions<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        for (colour, number) in &self.numbers {
            xml.open("radialGradient");
            xml.attribute("id", format_args!("u{number}g"));
            xml.attribute("gradientUnits", "userSpaceOnUse");
            for (name, value) in [("cx", 0), ("cy", 0), ("r", 1)] {
                xml.attribute(name, value);
            }
            write_stops(xml, &Ellipse::brush(*colour))?;
            xml.close()?;
            if !self.expand {
                xml.open("circle");
                xml.attribute("id", format_args!("u{number}"));
                xml.attribute("r", 1);
                xml.attribute("fill", format_args!("url(#u{number}g)"));
                xml.close()?;
            }
            xml.line();
        }
        Ok(())
    }

    /// A soft ellipse, moved by `affine`.
    pub(super) fn write<W: Write>(
        &self,
        xml: &mut Xml<W>,
        shape: &Shape,
        ellipse: &Ellipse,
        affine: Affine,
    ) -> io::Result<()> {
        let Some(ellipse) = Ellipse::new(affine * ellipse.map()) else { return Ok(()) };
        let number = self.numbers.get(&shape.colour).copied().unwrap_or_default();
        if self.expand {
            xml.open("circle");
            xml.attribute("r", 1);
            xml.attribute("fill", format_args!("url(#u{number}g)"));
        } else {
            xml.open("use");
            xml.attribute("xlink:href", format_args!("#u{number}"));
            xml.follow(ViewerLoad { elements: 1, references: 1 });
        }
        if shape.opacity < 1.0 {
            xml.attribute("opacity", Number(shape.opacity, 4));
        }
        let numbers = ellipse.map().as_coeffs().map(|v| Number(v, self.precision));
        xml.attribute("transform", format_args!("matrix({})", list(&numbers)));
        xml.close()
    }
}
