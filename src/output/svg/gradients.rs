//! Linear gradients in SVG, relative to the box around what they fill.
//!
//! In units of the box the numbers are short, the same wherever the shape stands, and editors keep
//! the gradient with its shape when it is moved. Any linear change of colour can be written so:
//! lines of one colour, drawn at right angles in the stretched box, are lines in the picture.

use super::number::{Number, Paint};
use super::xml::Xml;
use crate::geometry::{Affine, Rect};
use crate::scene::Gradient;
use std::fmt::Display;
use std::io::{self, Write};

/// Digits of a place in the box: a hundredth of the way is less than a step of colour.
const DIGITS: u8 = 2;

/// A gradient in units of a box, ready to write.
pub(super) struct BoxGradient {
    from: [f64; 2],
    to: [f64; 2],
    gradient: Gradient,
}

impl BoxGradient {
    /// The gradient of a shape moved by `affine`, which has `bounds` once it is moved; none where
    /// box or shape have no extent, so that nothing can change.
    pub(super) fn new(gradient: &Gradient, affine: Affine, bounds: Rect) -> Option<Self> {
        let [fx, fy] = gradient.from;
        let (dx, dy) = (gradient.to[0] - fx, gradient.to[1] - fy);
        let length2 = dx * dx + dy * dy;
        // The share of the way at a place is u x + v y + w.
        let (u, v) = (dx / length2, dy / length2);
        let w = -(u * fx + v * fy);
        let [a, b, c, d, e, f] = affine.inverse().as_coeffs();
        let (u, v, w) = (u * a + v * b, u * c + v * d, w + u * e + v * f);
        // The same of a place in the box, whose sides are 1.
        let (u, v, w) = (u * bounds.width(), v * bounds.height(), w + u * bounds.x0 + v * bounds.y0);
        let rate2 = u * u + v * v;
        if !(rate2.is_finite()
            && rate2 > 1e-12
            && w.is_finite()
            && bounds.width().min(bounds.height()) > 1e-3)
        {
            return None;
        }
        // It begins on an axis, which need not be written.
        let from = if v.abs() >= u.abs() { [0.0, -w / v] } else { [-w / u, 0.0] };
        let to = [from[0] + u / rate2, from[1] + v / rate2];
        Some(Self { from, to, gradient: *gradient })
    }

    pub(super) fn write<W: Write>(&self, xml: &mut Xml<W>, id: impl Display) -> io::Result<()> {
        xml.open("linearGradient");
        xml.attribute("id", id);
        let places = [
            ("x1", self.from[0], 0.0),
            ("y1", self.from[1], 0.0),
            ("x2", self.to[0], 1.0),
            ("y2", self.to[1], 0.0),
        ];
        for (name, value, default) in places {
            if (value - default).abs() >= 0.005 {
                xml.attribute(name, Number(value, DIGITS));
            }
        }
        for (colour, offset) in [(self.gradient.start, 0), (self.gradient.end, 1)] {
            xml.open("stop");
            if offset > 0 {
                xml.attribute("offset", offset);
            }
            xml.attribute("stop-color", Paint(colour));
            xml.close()?;
        }
        xml.close()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::raster::colour::Colour;

    #[test]
    fn places_in_the_box_have_the_share_of_the_way() {
        let gradient =
            Gradient { from: [3.0, -4.0], to: [9.0, 5.0], start: Colour([0; 3]), end: Colour([255; 3]) };
        for affine in [
            Affine::IDENTITY,
            Affine::new([0.6, 0.8, -0.8, 0.6, 40.0, 7.0]),
            Affine::new([-1.5, 0.2, 0.4, 0.7, -3.0, 12.0]),
        ] {
            let shape = Rect::new(-10.0, -6.0, 14.0, 9.0);
            let bounds = affine.transform_rect_bbox(shape);
            let found = BoxGradient::new(&gradient, affine, bounds).unwrap();
            let way = [found.to[0] - found.from[0], found.to[1] - found.from[1]];
            let length2 = way[0] * way[0] + way[1] * way[1];
            for p in [Point::new(0.0, 0.0), Point::new(5.0, 2.0), Point::new(-7.0, 8.0)] {
                let wanted = ((p.x - 3.0) * 6.0 + (p.y + 4.0) * 9.0) / 117.0;
                let there = affine * p;
                let u = (there.x - bounds.x0) / bounds.width() - found.from[0];
                let v = (there.y - bounds.y0) / bounds.height() - found.from[1];
                assert!(((u * way[0] + v * way[1]) / length2 - wanted).abs() < 1e-9);
            }
        }
        let flat = Rect::new(0.0, 0.0, 5.0, 0.0);
        assert!(BoxGradient::new(&gradient, Affine::IDENTITY, flat).is_none());
        assert!(BoxGradient::new(&gradient, Affine::scale(0.0), Rect::new(0.0, 0.0, 1.0, 1.0)).is_none());
    }
}
