//! The content of a page or of a form: operators, and the resources that they name.

use super::file::{File, Ref};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Result;
use vtex_base::geometry::{Affine, Outline, PathEl, Point, Rect, Vec2};
use vtex_base::raster::colour::Colour;

/// Decimals of coordinates, in pixels; outlines have two.
const PLACE: u32 = 3;
/// Decimals of the linear coefficients of a transform.
const SCALE: u32 = 6;
/// Decimals of colours and opacities. A step of 8 bits is four units of the last one.
const SHARE: u32 = 3;

/// Operators in the order in which they paint.
#[derive(Default)]
pub(super) struct ContentStream {
    text: String,
    /// Forms by name `x0`, `x1`, …
    forms: BTreeMap<Ref, usize>,
    /// Graphics states by name `g0`, …
    states: BTreeMap<Ref, usize>,
    /// Patterns by name `p0`, …
    patterns: BTreeMap<Ref, usize>,
    /// Shadings by name `s0`, …
    shadings: BTreeMap<Ref, usize>,
    /// Whether a mask is used, so that the form of this content must be a group.
    masked: bool,
}

impl ContentStream {
    /// Paints between saving and restoring the graphics state.
    pub(super) fn within<T>(&mut self, paint: impl FnOnce(&mut Self) -> T) -> T {
        self.text += "q\n";
        let result = paint(self);
        self.text += "Q\n";
        result
    }

    /// Applies a transform to the coordinates of later operators.
    pub(super) fn transform(&mut self, affine: Affine) {
        let [a, b, c, d, e, f] = affine.as_coeffs();
        numbers(&mut self.text, [a, b, c, d], SCALE);
        numbers(&mut self.text, [e, f], PLACE);
        self.text += "cm\n";
    }

    /// Sets the colour of later fills.
    pub(super) fn fill_with(&mut self, colour: Colour) {
        numbers(&mut self.text, shares(colour), SHARE);
        self.text += "rg\n";
    }

    /// Sets the pattern of later fills.
    pub(super) fn fill_with_pattern(&mut self, pattern: Ref) {
        let name = name(&mut self.patterns, pattern);
        let _ = writeln!(self.text, "/Pattern cs\n/p{name} scn");
    }

    /// Sets the opacity to that of a graphics state.
    pub(super) fn set_opacity(&mut self, state: Ref) {
        self.set(state);
    }

    /// Sets the mask to that of a graphics state.
    pub(super) fn set_mask(&mut self, state: Ref) {
        self.masked = true;
        self.set(state);
    }

    fn set(&mut self, state: Ref) {
        let name = name(&mut self.states, state);
        let _ = writeln!(self.text, "/g{name} gs");
    }

    /// Fills an outline.
    pub(super) fn fill(&mut self, outline: &Outline) {
        self.path(outline, Vec2::ZERO);
        self.text += "f\n";
    }

    /// Fills a rectangle.
    pub(super) fn fill_rectangle(&mut self, r: Rect) {
        numbers(&mut self.text, [r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0], PLACE);
        self.text += "re\nf\n";
    }

    /// Draws a line with round joins along an outline.
    pub(super) fn stroke(&mut self, outline: &Outline, colour: Colour, width: f64) {
        numbers(&mut self.text, shares(colour), SHARE);
        self.text += "RG\n";
        numbers(&mut self.text, [width], PLACE);
        self.text += "w\n1 j\n";
        self.path(outline, Vec2::ZERO);
        self.text += "S\n";
    }

    /// Clips later painting to the union of an outline and its shifted copies.
    pub(super) fn clip(&mut self, outline: &Outline, shifts: &[Vec2]) {
        for &shift in shifts {
            self.path(outline, shift);
        }
        self.text += "W\nn\n";
    }

    /// Draws a form.
    pub(super) fn draw(&mut self, form: Ref) {
        let name = name(&mut self.forms, form);
        let _ = writeln!(self.text, "/x{name} Do");
    }

    /// Draws a form as optional content of the page's group with this index.
    pub(super) fn draw_optional(&mut self, form: Ref, group: usize) {
        let _ = writeln!(self.text, "/OC /l{group} BDC");
        self.draw(form);
        self.text += "EMC\n";
    }

    /// Fills everything with a shading.
    pub(super) fn shade(&mut self, shading: Ref) {
        let name = name(&mut self.shadings, shading);
        let _ = writeln!(self.text, "/s{name} sh");
    }

    /// A closed path.
    fn path(&mut self, outline: &Outline, shift: Vec2) {
        let out = &mut self.text;
        let mut place = |points: &[Point], operator: &str| {
            for &p in points {
                numbers(out, [p.x + shift.x, p.y + shift.y], PLACE);
            }
            out.push_str(operator);
        };
        let mut at = Point::ORIGIN;
        for element in outline.path().elements() {
            match *element {
                PathEl::MoveTo(p) => place(&[p], "m\n"),
                PathEl::LineTo(p) => place(&[p], "l\n"),
                PathEl::QuadTo(a, p) => place(&[at.lerp(a, 2.0 / 3.0), p.lerp(a, 2.0 / 3.0), p], "c\n"),
                PathEl::CurveTo(a, b, p) => place(&[a, b, p], "c\n"),
                PathEl::ClosePath => place(&[], "h\n"),
            }
            at = element.end_point().unwrap_or(at);
        }
    }

    /// The resources as an entry of a dictionary; `more` are further kinds of them.
    pub(super) fn resources(&self, more: &str) -> String {
        let mut out = format!("/Resources <<{more}");
        let kinds = [
            ("XObject", 'x', &self.forms),
            ("ExtGState", 'g', &self.states),
            ("Pattern", 'p', &self.patterns),
            ("Shading", 's', &self.shadings),
        ];
        for (kind, letter, objects) in kinds.into_iter().filter(|k| !k.2.is_empty()) {
            let _ = write!(out, "/{kind} <<");
            for (object, number) in objects {
                let _ = write!(out, "/{letter}{number} {object}");
            }
            out += ">>";
        }
        out + ">>"
    }

    /// The operators as a stream of a page.
    pub(super) fn page(&self, file: &mut File) -> Ref {
        file.add_text(&self.text)
    }

    /// The content as a form that paints within `bounds`.
    ///
    /// # Errors
    /// Those of packing.
    pub(super) fn form(self, file: &mut File, bounds: Rect) -> Result<Ref> {
        let is_group = self.masked;
        self.written(file, bounds, is_group)
    }

    /// The content as a form that is a transparency group, which masks and masked content require.
    ///
    /// # Errors
    /// Those of packing.
    pub(super) fn group(self, file: &mut File, bounds: Rect) -> Result<Ref> {
        self.written(file, bounds, true)
    }

    fn written(self, file: &mut File, bounds: Rect, is_group: bool) -> Result<Ref> {
        let mut entries = String::from("/Type /XObject/Subtype /Form/BBox [");
        numbers(&mut entries, [bounds.x0, bounds.y0, bounds.x1, bounds.y1], PLACE);
        entries.pop();
        entries += "]";
        entries += &self.resources("");
        if is_group {
            entries += "/Group <</S /Transparency/CS /DeviceRGB>>";
        }
        file.add_stream(&entries, &self.text)
    }
}

/// The number of an object among the resources of its kind.
fn name(objects: &mut BTreeMap<Ref, usize>, object: Ref) -> usize {
    let next = objects.len();
    *objects.entry(object).or_insert(next)
}

/// The components of a colour, 0 to 1.
pub(super) fn shares(Colour(components): Colour) -> [f64; 3] {
    components.map(|v| f64::from(v) / 255.0)
}

/// Appends numbers, a space after each.
pub(super) fn numbers<const N: usize>(out: &mut String, values: [f64; N], decimals: u32) {
    for value in values {
        let scale = 10i64.pow(decimals);
        let units = libm::round(value * scale as f64) as i64;
        let (whole, part) = (units.unsigned_abs() / scale as u64, units.unsigned_abs() % scale as u64);
        if units < 0 {
            out.push('-');
        }
        if whole != 0 || part == 0 {
            let _ = write!(out, "{whole}");
        }
        if part != 0 {
            let _ = write!(out, ".{part:0width$}", width = decimals as usize);
            out.truncate(out.trim_end_matches('0').len());
        }
        out.push(' ');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let mut out = String::new();
        numbers(&mut out, [0.0, -0.0, 1.0, -0.25, 12.34, 1.0004, 0.0996, -100.0], 3);
        assert_eq!(out, "0 0 1 -.25 12.34 1 .1 -100 ");
    }

    #[test]
    fn resources_are_named_once() {
        let mut file = File::default();
        let (a, b) = (file.add("a".into()), file.add("b".into()));
        let mut content = ContentStream::default();
        content.within(|c| {
            c.draw(b);
            c.draw(a);
            c.draw(b);
        });
        assert_eq!(content.text, "q\n/x0 Do\n/x1 Do\n/x0 Do\nQ\n");
        assert_eq!(content.resources(""), "/Resources <</XObject <</x1 1 0 R/x0 2 0 R>>>>");
    }
}
