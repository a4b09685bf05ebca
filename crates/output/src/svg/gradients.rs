//! Gradients in SVG, relative to the bounding box of the filled shape.
//!
//! In units of the box the numbers are short and do not depend on the place of the shape, and editors keep
//! the gradient with its shape when it is moved. Any linear change of colour can be written so: lines of one
//! colour, drawn at right angles in the stretched box, are lines in the picture.

use super::number::{HexColour, Number, list};
use super::xml::Xml;
use std::fmt::Display;
use std::io::{self, Write};
use vtex_base::geometry::{Affine, Rect};
use vtex_scene::element::{Gradient, GradientKind};

/// Digits of a place in the box: a hundredth of the box is less than a step of colour.
const DIGITS: u8 = 2;

/// A gradient in units of a box, ready to write.
pub(super) struct BoxGradient<'a> {
    place: GradientPlace,
    gradient: &'a Gradient,
}

/// The place of a gradient in its box.
enum GradientPlace {
    /// From a point to a point.
    Linear([f64; 2], [f64; 2]),
    /// The map from the unit disc around (0, 0).
    Radial(Affine),
}

impl<'a> BoxGradient<'a> {
    /// The gradient of a shape moved by `affine`, whose bounds after that are `bounds`; `None` if box or
    /// gradient has no extent.
    pub(super) fn new(gradient: &'a Gradient, affine: Affine, bounds: Rect) -> Option<Self> {
        if bounds.width().min(bounds.height()) <= 1e-3 {
            return None;
        }
        let place = match gradient.kind {
            GradientKind::Linear => linear(gradient, affine, bounds)?,
            GradientKind::Radial => radial(gradient, affine, bounds)?,
        };
        Some(Self { place, gradient })
    }

    pub(super) fn write<W: Write>(&self, xml: &mut Xml<W>, id: impl Display) -> io::Result<()> {
        match &self.place {
            GradientPlace::Linear(from, to) => {
                xml.open("linearGradient");
                xml.attribute("id", id);
                let places =
                    [("x1", from[0], 0.0), ("y1", from[1], 0.0), ("x2", to[0], 1.0), ("y2", to[1], 0.0)];
                for (name, value, default) in places {
                    if (value - default).abs() >= 0.005 {
                        xml.attribute(name, Number(value, DIGITS));
                    }
                }
            }
            GradientPlace::Radial(map) => {
                xml.open("radialGradient");
                xml.attribute("id", id);
                for (name, value) in [("cx", 0), ("cy", 0), ("r", 1)] {
                    xml.attribute(name, value);
                }
                let numbers = map.as_coeffs().map(|v| Number(v, DIGITS + 1));
                xml.attribute("gradientTransform", format_args!("matrix({})", list(&numbers)));
            }
        }
        write_stops(xml, self.gradient)?;
        xml.close()
    }
}

/// The stops of a gradient.
pub(super) fn write_stops<W: Write>(xml: &mut Xml<W>, gradient: &Gradient) -> io::Result<()> {
    for stop in gradient.stops() {
        xml.open("stop");
        if stop.offset > 0.0 {
            xml.attribute("offset", Number(stop.offset, 3));
        }
        xml.attribute("stop-color", HexColour(stop.colour));
        if stop.opacity < 1.0 {
            xml.attribute("stop-opacity", Number(stop.opacity, 3));
        }
        xml.close()?;
    }
    Ok(())
}

fn linear(gradient: &Gradient, affine: Affine, bounds: Rect) -> Option<GradientPlace> {
    let [fx, fy] = gradient.from;
    let (dx, dy) = (gradient.to[0] - fx, gradient.to[1] - fy);
    let length2 = dx * dx + dy * dy;
    // The offset of the gradient at a place is u x + v y + w.
    let (u, v) = (dx / length2, dy / length2);
    let w = -(u * fx + v * fy);
    let [a, b, c, d, e, f] = affine.inverse().as_coeffs();
    let (u, v, w) = (u * a + v * b, u * c + v * d, w + u * e + v * f);
    // The same in the coordinates of the box, whose sides are 1.
    let (u, v, w) = (u * bounds.width(), v * bounds.height(), w + u * bounds.x0 + v * bounds.y0);
    let rate2 = u * u + v * v;
    if !(rate2.is_finite() && rate2 > 1e-12 && w.is_finite()) {
        return None;
    }
    // It begins on an axis, so one coordinate need not be written.
    let from = if v.abs() >= u.abs() { [0.0, -w / v] } else { [-w / u, 0.0] };
    Some(GradientPlace::Linear(from, [from[0] + u / rate2, from[1] + v / rate2]))
}

fn radial(gradient: &Gradient, affine: Affine, bounds: Rect) -> Option<GradientPlace> {
    let [x, y] = gradient.from;
    let radius = libm::hypot(gradient.to[0] - x, gradient.to[1] - y);
    let box_of = Affine::scale_non_uniform(1.0 / bounds.width(), 1.0 / bounds.height())
        * Affine::translate((-bounds.x0, -bounds.y0));
    let map = box_of * affine * Affine::translate((x, y)) * Affine::scale(radius);
    let sound = map.as_coeffs().iter().all(|v| v.is_finite()) && map.determinant().abs() > 1e-12;
    sound.then_some(GradientPlace::Radial(map))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::Point;
    use vtex_base::raster::colour::Colour;

    #[test]
    fn places_in_the_box_have_the_share_of_the_way() {
        let gradient = Gradient::linear([3.0, -4.0], [9.0, 5.0], [Colour([0; 3]), Colour([255; 3])]);
        for affine in [
            Affine::IDENTITY,
            Affine::new([0.6, 0.8, -0.8, 0.6, 40.0, 7.0]),
            Affine::new([-1.5, 0.2, 0.4, 0.7, -3.0, 12.0]),
        ] {
            let shape = Rect::new(-10.0, -6.0, 14.0, 9.0);
            let bounds = affine.transform_rect_bbox(shape);
            let place = BoxGradient::new(&gradient, affine, bounds).unwrap().place;
            let GradientPlace::Linear(from, to) = place else { panic!("a linear gradient") };
            let way = [to[0] - from[0], to[1] - from[1]];
            let length2 = way[0] * way[0] + way[1] * way[1];
            for p in [Point::new(0.0, 0.0), Point::new(5.0, 2.0), Point::new(-7.0, 8.0)] {
                let wanted = ((p.x - 3.0) * 6.0 + (p.y + 4.0) * 9.0) / 117.0;
                let there = affine * p;
                let u = (there.x - bounds.x0) / bounds.width() - from[0];
                let v = (there.y - bounds.y0) / bounds.height() - from[1];
                assert!(((u * way[0] + v * way[1]) / length2 - wanted).abs() < 1e-9);
            }
        }
        let flat = Rect::new(0.0, 0.0, 5.0, 0.0);
        assert!(BoxGradient::new(&gradient, Affine::IDENTITY, flat).is_none());
        assert!(BoxGradient::new(&gradient, Affine::scale(0.0), Rect::new(0.0, 0.0, 1.0, 1.0)).is_none());
    }
}
