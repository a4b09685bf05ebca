//! Colour palettes from text files.

use vtex_base::error::{Error, Result};
use vtex_base::raster::colour::Colour;

/// Largest number of colours in a palette.
const MOST: usize = 256;

/// Reads the colours of a palette in order, without duplicates. A GIMP palette (`.gpl`) is read as
/// such. In any other text, every `#aabbcc` or bare `aabbcc` is a colour. `name` appears in errors.
///
/// # Errors
/// [`Error::Control`] if there is none, or more than 256.
pub fn palette(bytes: &[u8], name: &str) -> Result<Vec<Colour>> {
    let text = String::from_utf8_lossy(bytes);
    let found: Vec<Colour> =
        if text.starts_with("GIMP Palette") { text.lines().filter_map(triple).collect() } else { hex(&text) };
    let mut colours: Vec<Colour> = Vec::new();
    for colour in found {
        if !colours.contains(&colour) && colours.len() <= MOST {
            colours.push(colour);
        }
    }
    let fail =
        |reason: String, advice| Error::Control { name: name.into(), role: "a palette", reason, advice };
    match colours.len() {
        0 => Err(fail(
            "it contains no colour".into(),
            "write colours as #aabbcc, one a line, or give a GIMP palette",
        )),
        1..=MOST => Ok(colours),
        _ => Err(fail(
            format!("it contains more than {MOST} colours"),
            "a palette needs few colours, some ten",
        )),
    }
}

/// A line of a GIMP palette: three numbers, optionally followed by a name.
fn triple(line: &str) -> Option<Colour> {
    let mut parts = line.split_whitespace();
    let mut next = || parts.next()?.parse::<u8>().ok();
    Some(Colour([next()?, next()?, next()?]))
}

fn hex(text: &str) -> Vec<Colour> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric());
    words.filter(|w| w.len() == 6).filter_map(|w| Colour::from_hex(&format!("#{w}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn palettes_of_several_programs_are_read() {
        let wanted = [Colour([16, 32, 48]), Colour([255, 0, 170])];
        for text in [
            "#102030\n#ff00aa\n#102030\n",
            "[\"#102030\", \"#FF00AA\"]",
            "102030-ff00aa",
            "GIMP Palette\nName: two\nColumns: 2\n#\n 16  32  48\tdark\n255 0 170 Untitled\n",
        ] {
            assert_eq!(palette(text.as_bytes(), "p").unwrap(), wanted, "{text}");
        }
    }

    #[test]
    fn what_is_no_palette_is_told() {
        let many: String = (0..300).map(|i| format!("#0000{i:02x}\n#{i:04x}00\n")).collect();
        for (text, message) in [("", "no colour"), ("\u{0}\u{ff}", "no colour"), (&many, "more than 256")] {
            let error = palette(text.as_bytes(), "p.txt").unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
        }
    }
}
