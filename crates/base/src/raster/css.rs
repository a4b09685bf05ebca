//! Colours as people write them: `#rrggbb`, `#rgb`, a name of CSS, or another opaque colour of CSS.

use super::colour::Colour;

/// Reads a colour; `None` for any other text.
pub fn colour(text: &str) -> Option<Colour> {
    // The only name of CSS Color Module Level 4 that Level 3 lacks.
    let text = if text.eq_ignore_ascii_case("rebeccapurple") { "#663399" } else { text };
    let read: svgtypes::Color = text.parse().ok()?;
    (read.alpha == u8::MAX).then_some(Colour([read.red, read.green, read.blue]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_digits_are_colours() {
        let of = |text| colour(text).map(|c| c.0);
        assert_eq!(of("#102030"), Some([0x10, 0x20, 0x30]));
        assert_eq!(of("#f80"), Some([0xff, 0x88, 0]));
        assert_eq!(
            (of("RebeccaPurple"), of("aliceblue")),
            (Some([0x66, 0x33, 0x99]), Some([0xf0, 0xf8, 0xff]))
        );
        assert_eq!((of("yellowgreen"), of("tan")), (Some([0x9a, 0xcd, 0x32]), Some([0xd2, 0xb4, 0x8c])));
        for bad in ["", "#", "#12", "#12345", "#1020307f", "#ggg", "rot", "102030", "#ää", "transparent"] {
            assert!(of(bad).is_none(), "{bad}");
        }
    }
}
