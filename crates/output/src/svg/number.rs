//! Numbers and colours in their shortest form.

use std::fmt;
use vtex_base::raster::colour::Colour;

/// A number rounded to a count of decimal digits (0 to 9): `.5`, `-3`, `12.25`.
pub(super) struct Number(pub(super) f64, pub(super) u8);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.*}", usize::from(self.1), self.0);
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        match text.strip_prefix('-').unwrap_or(text) {
            "0" => f.write_str("0"),
            digits => {
                if text.starts_with('-') {
                    f.write_str("-")?;
                }
                match digits.strip_prefix('0') {
                    Some(part) if part.starts_with('.') => f.write_str(part),
                    _ => f.write_str(digits),
                }
            }
        }
    }
}

/// Several numbers, separated by spaces only where needed.
pub(super) fn list(numbers: &[Number]) -> String {
    let mut text = String::new();
    for number in numbers {
        let next = number.to_string();
        if !text.is_empty() && !next.starts_with('-') {
            text.push(' ');
        }
        text.push_str(&next);
    }
    text
}

/// A colour as `#abc` where that is exact, else `#aabbcd`.
pub(super) struct HexColour(pub(super) Colour);

impl fmt::Display for HexColour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0.0;
        if [r, g, b].iter().all(|v| v % 17 == 0) {
            write!(f, "#{:x}{:x}{:x}", r / 17, g / 17, b / 17)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortest_numbers() {
        let shown = |v: f64, digits: u8| Number(v, digits).to_string();
        assert_eq!(shown(0.5, 2), ".5");
        assert_eq!(shown(-0.25, 2), "-.25");
        assert_eq!(shown(-0.001, 2), "0");
        assert_eq!(shown(100.0, 0), "100");
        assert_eq!(shown(100.0, 3), "100");
        assert_eq!(shown(-12.3456, 3), "-12.346");
        assert_eq!(list(&[Number(1.0, 2), Number(-2.5, 2), Number(0.5, 2)]), "1-2.5 .5");
    }

    #[test]
    fn shortest_colours() {
        assert_eq!(HexColour(Colour([0xaa, 0xbb, 0x00])).to_string(), "#ab0");
        assert_eq!(HexColour(Colour([0xaa, 0xbb, 0x01])).to_string(), "#aabb01");
    }
}
