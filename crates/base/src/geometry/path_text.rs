//! SVG path data: a compact writer and a strict reader.

use kurbo::{BezPath, PathEl, Point};

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

/// Parses path data with the commands M, L, H, V, C and Z, absolute or relative.
///
/// # Errors
/// A message with the byte offset: an unknown command, a missing or non-finite number, or data that
/// does not start with a moveto.
pub fn parse_path(text: &str) -> Result<BezPath, String> {
    let mut r = PathReader { text, at: 0 };
    let mut path = BezPath::with_capacity(text.len() / BYTES_PER_ELEMENT + 1);
    let (mut current, mut start) = (Point::ORIGIN, Point::ORIGIN);
    let mut command = 0u8;
    loop {
        r.skip_separators();
        let Some(&byte) = r.bytes().get(r.at) else { break };
        if byte.is_ascii_alphabetic() {
            command = byte;
            r.at += 1;
        } else {
            match command {
                b'M' => command = b'L',
                b'm' => command = b'l',
                0 | b'Z' | b'z' => return Err(format!("path data: a command was expected at byte {}", r.at)),
                _ => {}
            }
        }
        if path.elements().is_empty() && !matches!(command, b'M' | b'm') {
            return Err("path data does not begin with M".into());
        }
        let origin = if command.is_ascii_lowercase() { current } else { Point::ORIGIN };
        match command {
            b'M' | b'm' => {
                current = r.point(origin)?;
                start = current;
                path.move_to(current);
            }
            b'L' | b'l' => {
                current = r.point(origin)?;
                path.line_to(current);
            }
            b'H' | b'h' => {
                current.x = origin.x + r.number()?;
                path.line_to(current);
            }
            b'V' | b'v' => {
                current.y = origin.y + r.number()?;
                path.line_to(current);
            }
            b'C' | b'c' => {
                let (a, b) = (r.point(origin)?, r.point(origin)?);
                current = r.point(origin)?;
                path.curve_to(a, b, current);
            }
            b'Z' | b'z' => {
                path.close_path();
                current = start;
            }
            other => {
                return Err(format!(
                    "path data: unknown command '{}' at byte {}",
                    char::from(other),
                    r.at - 1
                ));
            }
        }
    }
    Ok(path)
}

struct PathReader<'a> {
    text: &'a str,
    at: usize,
}

impl PathReader<'_> {
    fn bytes(&self) -> &[u8] {
        self.text.as_bytes()
    }

    fn skip_separators(&mut self) {
        while self.bytes().get(self.at).is_some_and(|b| b.is_ascii_whitespace() || *b == b',') {
            self.at += 1;
        }
    }

    fn number(&mut self) -> Result<f64, String> {
        self.skip_separators();
        let start = self.at;
        let digits = |r: &mut Self| {
            let from = r.at;
            while r.bytes().get(r.at).is_some_and(u8::is_ascii_digit) {
                r.at += 1;
            }
            r.at > from
        };
        if matches!(self.bytes().get(self.at), Some(b'-' | b'+')) {
            self.at += 1;
        }
        let mut any = digits(self);
        if self.bytes().get(self.at) == Some(&b'.') {
            self.at += 1;
            any |= digits(self);
        }
        if any && matches!(self.bytes().get(self.at), Some(b'e' | b'E')) {
            self.at += 1;
            if matches!(self.bytes().get(self.at), Some(b'-' | b'+')) {
                self.at += 1;
            }
            any = digits(self);
        }
        // Only ASCII bytes were skipped.
        match self.text[start..self.at].parse::<f64>() {
            Ok(v) if any && v.is_finite() => Ok(v),
            _ => Err(format!("path data: a number was expected at byte {start}")),
        }
    }

    fn point(&mut self, origin: Point) -> Result<Point, String> {
        let (x, y) = (self.number()?, self.number()?);
        Ok(Point::new(origin.x + x, origin.y + y))
    }
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
