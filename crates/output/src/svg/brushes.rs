//! Soft ellipses in SVG: circles of radius 1, seen through matrices, filled by the brush of their profile and colour.
//!
//! A brush is a radial gradient in units of the user, which Chromium, Firefox, Inkscape, librsvg and resvg draw
//! alike. A circle takes some 75 bytes, and ten in a packed file. A reference to a circle of its colour is no shorter
//! when packed, and Inkscape opens it at half the speed.

use super::gradients::write_stops;
use super::number::{Number, list};
use super::xml::Xml;
use std::collections::BTreeMap;
use std::io::{self, Write};
use vtex_base::geometry::Affine;
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Ellipse, Profile};
use vtex_scene::scene::Scene;

/// The brushes of all soft ellipses of a scene.
pub(super) struct Brushes {
    numbers: BTreeMap<(Profile, Colour), usize>,
    precision: u8,
}

impl Brushes {
    pub(super) fn new(scene: &Scene, precision: u8) -> Self {
        let details = scene.elements.iter().flat_map(|e| e.details());
        let shading = details.filter_map(|shape| Some((shape.ellipse.as_deref()?, shape.colour)));
        let spots = scene.instances().filter_map(|i| scene.element(i).spot(i.colour));
        let brushes = shading.chain(spots).map(|(ellipse, colour)| ((ellipse.profile, colour), 0));
        let mut numbers: BTreeMap<(Profile, Colour), usize> = brushes.collect();
        numbers.values_mut().enumerate().for_each(|(i, number)| *number = i);
        Self { numbers, precision }
    }

    /// All brushes, for `<defs>`.
    pub(super) fn write_definitions<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        for ((profile, colour), number) in &self.numbers {
            xml.open("radialGradient");
            xml.attribute("id", format_args!("u{number}"));
            xml.attribute("gradientUnits", "userSpaceOnUse");
            for (name, value) in [("cx", 0), ("cy", 0), ("r", 1)] {
                xml.attribute(name, value);
            }
            write_stops(xml, &profile.brush(*colour))?;
            xml.close()?;
            xml.line();
        }
        Ok(())
    }

    /// A soft ellipse of one colour and opacity, moved by `affine`.
    pub(super) fn write<W: Write>(
        &self,
        xml: &mut Xml<W>,
        ellipse: &Ellipse,
        (colour, opacity): (Colour, f64),
        affine: Affine,
    ) -> io::Result<()> {
        let Some(moved) = ellipse.moved(affine) else { return Ok(()) };
        let number = self.numbers.get(&(moved.profile, colour)).copied().unwrap_or_default();
        xml.open("circle");
        xml.attribute("r", 1);
        xml.attribute("fill", format_args!("url(#u{number})"));
        if opacity < 1.0 {
            xml.attribute("opacity", Number(opacity, 4));
        }
        let [a, b, c, d, x, y] = moved.map().as_coeffs();
        // Many radii are of a pixel or two.
        let length = |v: f64| Number(v, self.precision.max(1));
        let place = |v: f64| Number(v, self.precision);
        let numbers = [length(a), length(b), length(c), length(d), place(x), place(y)];
        xml.attribute("transform", format_args!("matrix({})", list(&numbers)));
        xml.close()
    }
}
