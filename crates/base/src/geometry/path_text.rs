//! SVG path data: a compact writer and a strict reader.

use kurbo::{BezPath, PathEl, Point};
use svgtypes::{SimplePathSegment as Segment, SimplifyingPathParser};

/// Format of written path data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathText {
    /// Digits after the decimal point, 0 to 6.
    pub precision: u8,
}

/// Format of stored outlines: two decimals, the resolution of [`super::STEP`].
pub(super) const STORED: PathText = PathText { precision: 2 };

/// Writes path data in its shortest form: relative commands, no redundant separators. Coordinates
/// are rounded to a grid, so rounding errors never accumulate along a ring.
pub fn write_path(path: &BezPath, style: PathText) -> String {
    let scale = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6][usize::from(style.precision.min(6))];
    let grid = |p: Point| (libm::round(p.x * scale) as i64, libm::round(p.y * scale) as i64);
    let mut w = PathWriter {
        out: String::new(),
        precision: style.precision.min(6),
        command: 0,
        tight: true,
        dotted: false,
    };
    let (mut at, mut start) = ((0i64, 0i64), (0i64, 0i64));
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(p) => {
                let to = grid(p);
                w.command(b'm');
                w.pair(to, at);
                (at, start) = (to, to);
                // Further pairs after a moveto are linetos.
                w.command = b'l';
            }
            PathEl::LineTo(p) => {
                let to = grid(p);
                if to == at {
                    continue;
                }
                if to.1 == at.1 {
                    w.command(b'h');
                    w.number(to.0 - at.0);
                } else if to.0 == at.0 {
                    w.command(b'v');
                    w.number(to.1 - at.1);
                } else {
                    w.command(b'l');
                    w.pair(to, at);
                }
                at = to;
            }
            PathEl::QuadTo(a, b) => {
                w.command(b'q');
                w.pair(grid(a), at);
                w.pair(grid(b), at);
                at = grid(b);
            }
            PathEl::CurveTo(a, b, c) => {
                w.command(b'c');
                for p in [a, b, c] {
                    w.pair(grid(p), at);
                }
                at = grid(c);
            }
            PathEl::ClosePath => {
                w.out.push('z');
                (w.command, w.tight) = (b'z', true);
                at = start;
            }
        }
    }
    w.out
}

struct PathWriter {
    out: String,
    precision: u8,
    /// The current command; repeated commands need no letter.
    command: u8,
    /// Whether the next number may follow without a separator.
    tight: bool,
    /// Whether the previous number has a decimal point, so that another point starts a new number.
    dotted: bool,
}

impl PathWriter {
    fn command(&mut self, c: u8) {
        if self.command != c {
            self.out.push(char::from(c));
            self.command = c;
            self.tight = true;
        }
    }

    fn pair(&mut self, to: (i64, i64), from: (i64, i64)) {
        self.number(to.0 - from.0);
        self.number(to.1 - from.1);
    }

    /// Writes a number given in units of 10^-precision.
    fn number(&mut self, units: i64) {
        use std::fmt::Write;
        let scale = 10i64.pow(u32::from(self.precision));
        let (whole, part) = (units.unsigned_abs() / scale as u64, units.unsigned_abs() % scale as u64);
        if units < 0 {
            self.out.push('-');
        } else if !(self.tight || self.dotted && whole == 0 && part != 0) {
            self.out.push(' ');
        }
        self.dotted = part != 0;
        if whole != 0 || part == 0 {
            let _ = write!(self.out, "{whole}");
        }
        if part != 0 {
            let width = usize::from(self.precision);
            let _ = write!(self.out, ".{part:0width$}");
            while self.out.ends_with('0') {
                self.out.pop();
            }
        }
        self.tight = false;
    }
}

/// About as many bytes as an element takes in stored outlines.
const BYTES_PER_ELEMENT: usize = 12;

/// Parses path data with the commands M, L, H, V, C, S, Q, T and Z, absolute or relative.
///
/// # Errors
/// A message with the position: an unknown command, a missing or non-finite number, data that does not start with a
/// moveto, or an arc, whose curves would be approximate.
pub fn parse_path(text: &str) -> Result<BezPath, String> {
    if let Some(at) = text.find(['A', 'a']) {
        return Err(format!("path data: an arc at byte {at}"));
    }
    let mut path = BezPath::with_capacity(text.len() / BYTES_PER_ELEMENT + 1);
    for segment in SimplifyingPathParser::from(text) {
        match segment.map_err(|e| format!("path data: {e}"))? {
            Segment::MoveTo { x, y } => path.move_to((x, y)),
            Segment::LineTo { x, y } => path.line_to((x, y)),
            Segment::CurveTo { x1, y1, x2, y2, x, y } => path.curve_to((x1, y1), (x2, y2), (x, y)),
            Segment::Quadratic { x1, y1, x, y } => path.quad_to((x1, y1), (x, y)),
            Segment::ClosePath => path.close_path(),
        }
    }
    if path.is_finite() { Ok(path) } else { Err("path data: a number is too large".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Outline;
    use proptest::prelude::*;

    #[test]
    fn shortest_form() {
        let mut p = BezPath::new();
        p.move_to((10.0, 20.0));
        p.line_to((15.5, 20.0));
        p.line_to((15.5, 18.25));
        p.line_to((10.25, 17.5));
        p.line_to((9.0, 17.0));
        p.curve_to((9.0, 18.0), (8.5, 19.0), (8.0, 20.0));
        p.close_path();
        assert_eq!(
            write_path(&p, PathText { precision: 2 }),
            "m10 20h5.5v-1.75l-5.25-.75-1.25-.5c0 1-.5 2-1 3z"
        );
    }

    #[test]
    fn bad_data_is_refused() {
        for bad in ["L1 2", "M1", "M1 2 A3", "M1e999 2", "M1 2z3", "M1 2 L--3 4", "M.. 1", "M1 2C1 2 3"] {
            assert!(parse_path(bad).is_err(), "{bad}");
        }
        assert!(parse_path("").is_ok_and(|p| p.elements().is_empty()));
    }

    proptest! {
        #[test]
        fn text_holds_an_outline_exactly(points in prop::collection::vec((-2e3..2e3f64, -2e3..2e3f64), 7..30)) {
            let mut path = BezPath::new();
            for (i, ring) in points.chunks_exact(7).enumerate() {
                path.move_to(ring[0]);
                path.line_to(ring[1]);
                path.curve_to(ring[2], ring[3], ring[4]);
                if i % 2 == 0 { path.line_to(ring[5]) } else { path.quad_to(ring[5], ring[6]) }
                path.close_path();
            }
            let outline = Outline::new(&path).unwrap();
            let json = serde_json::to_string(&outline).unwrap();
            let back: Outline = serde_json::from_str(&json).unwrap();
            prop_assert_eq!(&back.path().elements().len(), &outline.path().elements().len());
            prop_assert_eq!(serde_json::to_string(&back).unwrap(), json);
        }

        #[test]
        fn no_text_panics(text in "[MLHVCZmlhvcz0-9eE+., -]{0,40}") {
            let _ = parse_path(&text);
        }
    }
}
