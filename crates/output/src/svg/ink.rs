//! The ink of a document: the one colour of all its elements.
//!
//! The element around them has the class `ink` and the colour; all others take their paint from it. One rule of CSS,
//! such as `.ink{color:#a00}`, therefore recolours fills and lines. Expanded documents state every colour in place,
//! for programs that do not know `currentColor`.

use super::SvgOptions;
use super::number::HexColour;
use super::xml::Xml;
use std::io::Write;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::Scene;

/// The colour that all elements inherit; `None` if each states its own.
#[derive(Clone, Copy)]
pub(super) struct InheritedInk(Option<Colour>);

impl InheritedInk {
    pub(super) fn new(scene: &Scene, options: &SvgOptions) -> Self {
        let ink = if options.expand { None } else { scene.ink() };
        Self(ink.map(|ink| ink.colour))
    }

    /// Whether a colour is inherited.
    pub(super) fn is(self, colour: Colour) -> bool {
        self.0 == Some(colour)
    }

    /// The attributes of the open element, which contains all elements.
    pub(super) fn begin<W: Write>(self, xml: &mut Xml<W>) {
        if let Some(colour) = self.0 {
            xml.attribute("class", "ink");
            xml.attribute("color", HexColour(colour));
            xml.attribute("fill", "currentColor");
        }
    }

    /// The paint of the open element: `fill` or `stroke`.
    pub(super) fn paint<W: Write>(self, xml: &mut Xml<W>, kind: &str, colour: Colour) {
        if self.is(colour) {
            xml.attribute(kind, "currentColor");
        } else {
            xml.attribute(kind, HexColour(colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::write;
    use super::*;
    use crate::raster_svg::render_svg;
    use crate::testing;
    use vtex_scene::scene::Tile;

    const RED: Colour = Colour([200, 0, 0]);

    fn text(scene: &Scene, expand: bool) -> String {
        let mut bytes = Vec::new();
        write(scene, &SvgOptions { precision: 2, expand, ..SvgOptions::default() }, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    fn pixels(text: &str) -> Vec<u8> {
        render_svg(text.as_bytes(), 1.0, "test", &()).unwrap().data().to_vec()
    }

    fn printed() -> Scene {
        let scene = testing::rimmed(testing::tiled(300, 200, 1, Tile { x: true, y: true }));
        testing::printed(testing::drawn(scene))
    }

    #[test]
    fn one_rule_recolours_fills_lines_and_rims() {
        let scene = printed();
        let plain = text(&scene, false);
        assert!(plain.contains("class=\"ink\" color=\"#000\" fill=\"currentColor\""));
        assert_eq!(plain.matches("\"#000\"").count(), 1, "no element states the ink");
        assert!(
            ["<symbol", "stroke=\"currentColor\"", "class=\"rim\""].iter().all(|part| plain.contains(part))
        );
        let ruled = plain.replacen("<title>", "<style>.ink{color:#c80000}</style><title>", 1);
        let red = scene.with_ink(RED, None).unwrap();
        assert_eq!(pixels(&ruled), pixels(&text(&red, false)));
        assert_ne!(pixels(&ruled), pixels(&plain));
    }

    #[test]
    fn expanded_documents_state_the_colours_in_place() {
        let scene = printed();
        let expanded = text(&scene, true);
        assert!(!expanded.contains("currentColor") && !expanded.contains("class=\"ink\""));
        let [a, b] = [expanded, text(&scene, false)].map(|text| pixels(&text));
        let differing = a.chunks(4).zip(b.chunks(4)).filter(|(a, b)| a[0].abs_diff(b[0]) > 32).count();
        assert!(differing < 30, "single pixels where dashes and anti-aliasing round otherwise: {differing}");
    }

    #[test]
    fn several_colours_are_stated_in_place() {
        let plain = text(&testing::scene(200, 150, 1), false);
        assert!(!plain.contains("currentColor") && !plain.contains("class=\"ink\""));
    }
}
