//! The content of a page or of a form: operators, and the resources that they name.

use super::file::{COMPACT, File};
use pdf_writer::types::{ColorSpaceOperand, LineJoinStyle};
use pdf_writer::writers::Resources;
use pdf_writer::{Content, Dict, Name, Ref};
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, Outline, PathEl, Point, Rect, Vec2};
use vtex_base::raster::colour::Colour;

/// Decimals of coordinates, in pixels; outlines have two.
pub(super) const PLACE: u32 = 3;
/// Decimals of the linear coefficients of a transform.
const SCALE: u32 = 6;
/// Decimals of colours and opacities. A step of 8 bits is four units of the last one.
pub(super) const SHARE: u32 = 3;

/// The objects that operators name, by a letter and the number of each: `x0`, `x1`, …
#[derive(Default)]
struct Named(BTreeMap<Ref, usize>);

impl Named {
    /// The name of an object.
    fn name(&mut self, letter: char, object: Ref) -> String {
        let next = self.0.len();
        format!("{letter}{}", self.0.entry(object).or_insert(next))
    }

    fn list(&self, letter: char, mut names: Dict<'_>) {
        for (object, number) in &self.0 {
            names.pair(Name(format!("{letter}{number}").as_bytes()), *object);
        }
    }
}

/// Operators in the order in which they paint.
pub(super) struct ContentStream {
    content: Content,
    forms: Named,
    /// Graphics states.
    states: Named,
    patterns: Named,
    shadings: Named,
    /// Whether a mask is used, so that the form of this content must be a group.
    masked: bool,
}

impl ContentStream {
    pub(super) fn new() -> Self {
        let [forms, states, patterns, shadings] = std::array::from_fn(|_| Named::default());
        let content = Content::with_settings(COMPACT);
        Self { content, forms, states, patterns, shadings, masked: false }
    }

    /// Paints between saving and restoring the graphics state.
    pub(super) fn within<T>(&mut self, paint: impl FnOnce(&mut Self) -> T) -> T {
        self.content.save_state();
        let result = paint(self);
        self.content.restore_state();
        result
    }

    /// Applies a transform to the coordinates of later operators.
    pub(super) fn transform(&mut self, affine: Affine) {
        let [a, b, c, d, e, f] = affine.as_coeffs();
        let ([a, b, c, d], [e, f]) = (rounded([a, b, c, d], SCALE), rounded([e, f], PLACE));
        self.content.transform([a, b, c, d, e, f]);
    }

    /// Sets the colour of later fills.
    pub(super) fn fill_with(&mut self, colour: Colour) {
        let [r, g, b] = shares(colour);
        self.content.set_fill_rgb(r, g, b);
    }

    /// Sets the pattern of later fills.
    pub(super) fn fill_with_pattern(&mut self, pattern: Ref) {
        let name = self.patterns.name('p', pattern);
        self.content.set_fill_color_space(ColorSpaceOperand::Pattern);
        self.content.set_fill_pattern([], Name(name.as_bytes()));
    }

    /// Sets the opacity to that of a graphics state.
    pub(super) fn set_opacity(&mut self, state: Ref) {
        let name = self.states.name('g', state);
        self.content.set_parameters(Name(name.as_bytes()));
    }

    /// Sets the mask to that of a graphics state.
    pub(super) fn set_mask(&mut self, state: Ref) {
        self.masked = true;
        self.set_opacity(state);
    }

    /// Fills an outline.
    pub(super) fn fill(&mut self, outline: &Outline) {
        self.path(outline, Vec2::ZERO);
        self.content.fill_nonzero();
    }

    /// Fills a rectangle.
    pub(super) fn fill_rectangle(&mut self, r: Rect) {
        let [x, y, width, height] = rounded([r.x0, r.y0, r.width(), r.height()], PLACE);
        self.content.rect(x, y, width, height).fill_nonzero();
    }

    /// Draws a line with round joins along an outline.
    pub(super) fn stroke(&mut self, outline: &Outline, colour: Colour, width: f64) {
        let ([r, g, b], [width]) = (shares(colour), rounded([width], PLACE));
        self.content.set_stroke_rgb(r, g, b).set_line_width(width).set_line_join(LineJoinStyle::RoundJoin);
        self.path(outline, Vec2::ZERO);
        self.content.stroke();
    }

    /// Clips later painting to the union of an outline and its shifted copies.
    pub(super) fn clip(&mut self, outline: &Outline, shifts: &[Vec2]) {
        for &shift in shifts {
            self.path(outline, shift);
        }
        self.content.clip_nonzero().end_path();
    }

    /// Draws a form.
    pub(super) fn draw(&mut self, form: Ref) {
        let name = self.forms.name('x', form);
        self.content.x_object(Name(name.as_bytes()));
    }

    /// Draws a form as optional content of the page's group with this index.
    pub(super) fn draw_optional(&mut self, form: Ref, group: usize) {
        let content = self.content.begin_marked_content_with_properties(Name(b"OC"));
        content.properties_named(Name(format!("l{group}").as_bytes()));
        self.draw(form);
        self.content.end_marked_content();
    }

    /// Fills everything with a shading.
    pub(super) fn shade(&mut self, shading: Ref) {
        let name = self.shadings.name('s', shading);
        self.content.shading(Name(name.as_bytes()));
    }

    /// A closed path.
    fn path(&mut self, outline: &Outline, shift: Vec2) {
        let place = |p: Point| rounded([p.x + shift.x, p.y + shift.y], PLACE);
        let mut at = Point::ORIGIN;
        for element in outline.path().elements() {
            let mut curve = |points: [Point; 3]| {
                let [[ax, ay], [bx, by], [x, y]] = points.map(place);
                self.content.cubic_to(ax, ay, bx, by, x, y);
            };
            match *element {
                PathEl::QuadTo(a, p) => curve([at.lerp(a, 2.0 / 3.0), p.lerp(a, 2.0 / 3.0), p]),
                PathEl::CurveTo(a, b, p) => curve([a, b, p]),
                PathEl::MoveTo(p) => drop(self.content.move_to(place(p)[0], place(p)[1])),
                PathEl::LineTo(p) => drop(self.content.line_to(place(p)[0], place(p)[1])),
                PathEl::ClosePath => drop(self.content.close_path()),
            }
            at = element.end_point().unwrap_or(at);
        }
    }

    /// Writes the resources.
    pub(super) fn resources(&self, mut out: Resources<'_>) {
        let kinds = [
            ("XObject", 'x', &self.forms),
            ("ExtGState", 'g', &self.states),
            ("Pattern", 'p', &self.patterns),
            ("Shading", 's', &self.shadings),
        ];
        for (kind, letter, named) in kinds.into_iter().filter(|kind| !kind.2.0.is_empty()) {
            named.list(letter, out.insert(Name(kind.as_bytes())).dict());
        }
    }

    /// The operators as an unpacked stream of a page.
    pub(super) fn page(&self, file: &mut File) -> Ref {
        let number = file.reserve();
        file.pdf.stream(number, self.content.as_bytes());
        number
    }

    /// The content as a form that paints within `bounds`.
    pub(super) fn form(self, file: &mut File, bounds: Rect) -> Ref {
        let is_group = self.masked;
        self.written(file, bounds, is_group)
    }

    /// The content as a form that is a transparency group, which masks and masked content require.
    pub(super) fn group(self, file: &mut File, bounds: Rect) -> Ref {
        self.written(file, bounds, true)
    }

    fn written(self, file: &mut File, bounds: Rect, is_group: bool) -> Ref {
        let [x0, y0, x1, y1] = rounded([bounds.x0, bounds.y0, bounds.x1, bounds.y1], PLACE);
        let resources = file.add(|object| self.resources(object.start()));
        file.add_form(self.content.as_bytes(), |form| {
            form.bbox(pdf_writer::Rect::new(x0, y0, x1, y1)).pair(Name(b"Resources"), resources);
            if is_group {
                form.group().transparency().color_space().device_rgb();
            }
        })
    }
}

/// The components of a colour, 0 to 1.
pub(super) fn shares(Colour(components): Colour) -> [f32; 3] {
    rounded(components.map(|v| f64::from(v) / 255.0), SHARE)
}

/// Numbers rounded to a count of decimals.
pub(super) fn rounded<const N: usize>(values: [f64; N], decimals: u32) -> [f32; N] {
    let scale = f64::from(10u32.pow(decimals));
    values.map(|value| (libm::round(value * scale) / scale) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let mut content = ContentStream::new();
        content.transform(Affine::new([0.0, -0.0, 0.000_002, -0.25, 1.0004, 12_345.678_9]));
        content.fill_rectangle(Rect::new(-100.0, 0.0996, -99.0, 0.5));
        assert_eq!(content.content.as_bytes(), b" 0 0 0.000002 -0.25 1 12345.679 cm -100 0.1 1 0.4 re\nf");
    }

    #[test]
    fn resources_are_named_once() {
        let mut file = File::new();
        let (a, b) = (file.add(|o| o.primitive(1)), file.add(|o| o.primitive(2)));
        let mut content = ContentStream::new();
        content.within(|c| {
            c.draw(b);
            c.draw(a);
            c.draw(b);
        });
        assert_eq!(content.content.as_bytes(), b"q/x0 Do/x1 Do/x0 Do\nQ");
        let mut chunk = pdf_writer::Chunk::with_settings(COMPACT);
        content.resources(chunk.indirect(a).start());
        assert_eq!(chunk.as_bytes(), b"1 0 obj\n<</XObject<</x1 1 0 R/x0 2 0 R>>>>\nendobj\n");
    }
}
