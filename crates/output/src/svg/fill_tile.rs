//! Scene → a tile for the fills of maps, layouts and web pages.
//!
//! QGIS, Mapbox and `background-image` repeat the page of an SVG; Inkscape repeats a `<pattern>` of one. A single file
//! serves both: the pattern contains all, so it can be copied to another document, and the page shows the pattern's
//! content by one `<use>`.
//!
//! The renderer of QGIS reads SVG Tiny 1.2: no clip paths, masks, symbols and patterns. It ignores the last and finds
//! the content in them. So the tile has only groups, paths, rectangles, gradients and `<use>`. Elements that cross a
//! border are whole at either side, as far as the page shows them. Expanded tiles have no `<use>` and therefore no
//! pattern.

use super::{Document, SvgOptions, SvgSummary, summed};
use crate::svg::xml::Xml;
use std::io::{self, Write};
use vtex_base::error::{Error, FillFault, Result};
use vtex_scene::scene::{Scene, Shape};

/// The id of the content.
const TILE: &str = "tile";

/// Distance by which the content extends beyond the tile, in pixels, so that a border within a pixel of the screen has
/// no transparent line.
const BLEED: f64 = 2.0;

/// Whether a scene can be a tile for fills.
///
/// # Errors
/// [`Error::Fill`] for a scene that would need masks or clip paths.
pub fn check_fill(scene: &Scene) -> Result<()> {
    let fault = if scene.domain.is_some() || scene.layers.iter().any(|layer| layer.region.is_some()) {
        FillFault::Shape
    } else if scene.elements.iter().any(|element| element.shapes.iter().any(Shape::is_soft)) {
        FillFault::Shading
    } else if scene.layers.iter().filter_map(|layer| layer.field.as_ref()).any(|f| !f.points.is_empty()) {
        FillFault::Background
    } else {
        return Ok(());
    };
    Err(Error::Fill(fault))
}

/// Writes the tile.
///
/// # Errors
/// Those of [`check_fill`] and of [`super::write()`]; [`Error::Seams`] for a scene that does not tile along both axes.
pub(super) fn write(scene: &Scene, options: &SvgOptions, out: impl Write) -> io::Result<SvgSummary> {
    if !scene.tile.both() {
        return Err(Error::Seams.into());
    }
    check_fill(scene)?;
    // Classes of categories are not written, so rules for them would have no effect.
    let options = SvgOptions { css: false, names: false, ..*options };
    let document = Document::new(scene, &options, BLEED)?;
    summed(document.textons.shared_count(), out, |xml| document.write_fill_tile(xml))
}

impl Document<'_> {
    fn write_fill_tile<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        self.begin(xml);
        super::write_page(xml, self.scene);
        xml.line();
        self.write_about(xml)?;
        if self.textons.expands() {
            return self.write_tile(xml);
        }
        xml.open("defs");
        xml.line();
        self.open_pattern(xml);
        xml.attribute("inkscape:label", crate::title(self.scene));
        xml.line();
        let before = xml.drawn();
        self.write_tile(xml)?;
        let content = xml.drawn().since(before);
        for _ in ["pattern", "defs"] {
            xml.close()?;
            xml.line();
        }
        xml.open("use");
        xml.attribute("xlink:href", format_args!("#{TILE}"));
        xml.follow(content);
        xml.close()?;
        xml.line();
        Ok(())
    }

    /// The content of the page and of the pattern.
    fn write_tile<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        xml.open("g");
        xml.attribute("id", TILE);
        self.textons.ink().begin(xml);
        xml.line();
        self.write_definitions(xml)?;
        for (layer, background) in self.scene.layers.iter().zip(&self.backgrounds) {
            if let Some((background, name)) = background {
                background.write_bands(xml, self.bleed, name)?;
            }
            self.write_compactly(xml, &layer.instances)?;
        }
        xml.close()?;
        xml.line();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster_svg::render_svg;
    use crate::testing;
    use std::collections::BTreeSet;
    use vtex_scene::scene::{Domain, Edge, Length, LengthUnit, Tile};

    const BOTH: Tile = Tile { x: true, y: true };

    fn written(scene: &Scene, fills: bool, expand: bool) -> String {
        let mut bytes = Vec::new();
        let options = SvgOptions { precision: 2, fills, expand, ..SvgOptions::default() };
        super::super::write(scene, &options, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    fn text(scene: &Scene, fills: bool) -> String {
        written(scene, fills, false)
    }

    fn printed() -> Scene {
        testing::printed(testing::drawn(testing::tiled(240, 160, 2, BOTH)))
    }

    fn difference(a: &[u8], b: &[u8]) -> f64 {
        let sum: u64 = a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        sum as f64 / a.len() as f64
    }

    #[test]
    fn a_tile_shows_the_picture_in_plain_shapes() {
        let scene = printed();
        let tile = text(&scene, true);
        let expanded = written(&scene, true, true);
        assert!(!expanded.contains("<use") && !expanded.contains("<pattern"));
        let document = roxmltree::Document::parse(&tile).unwrap();
        let names: BTreeSet<&str> =
            document.descendants().filter(|n| n.is_element()).map(|n| n.tag_name().name()).collect();
        let plain = ["defs", "g", "metadata", "path", "pattern", "rect", "svg", "title", "use"];
        assert!(names.iter().all(|name| plain.contains(name)), "{names:?}");
        assert!(["mask", "clip-path", "overflow"].iter().all(|name| !tile.contains(name)));
        let picture = text(&scene, false);
        let [a, b, c] = [&tile, &expanded, &picture]
            .map(|text| render_svg(text.as_bytes(), 1.0, "test", &()).unwrap().data().to_vec());
        assert!(difference(&a, &c) < 0.1, "{}", difference(&a, &c));
        assert!(difference(&b, &c) < 0.1, "{}", difference(&b, &c));
    }

    #[test]
    fn the_pattern_alone_repeats_the_tile() {
        let scene = printed();
        let tile = text(&scene, true);
        let start = tile.find("<pattern").unwrap();
        let end = tile.find("</pattern>").unwrap() + "</pattern>".len();
        let page = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"480\" height=\"160\">\
             <defs>{}</defs><rect width=\"480\" height=\"160\" fill=\"url(#texture)\"/></svg>",
            &tile[start..end]
        );
        let [wide, single] =
            [&page, &tile].map(|text| render_svg(text.as_bytes(), 1.0, "test", &()).unwrap());
        let row = 240 * 4;
        for (k, line) in wide.data().chunks_exact(row).enumerate() {
            let at = k / 2 * row;
            let off = difference(line, &single.data()[at..at + row]);
            assert!(off < 6.0, "{off} in row {}", k / 2);
        }
    }

    #[test]
    fn its_page_has_the_unit_asked_for() {
        let side = |value| Length::new(value, LengthUnit::Millimetre).unwrap();
        let scene = Scene { page: Some([side(30.0), side(20.0)]), ..printed() };
        let tile = text(&scene, true);
        assert!(tile.contains("width=\"30mm\" height=\"20mm\" viewBox=\"0 0 240 160\""));
        // 240 units are 30 mm, which are 113.4 pixels of CSS.
        assert!(
            tile.contains("patternTransform=\"scale(0.472440944882 0.472440944882)\""),
            "{}",
            &tile[..3000]
        );
    }

    #[test]
    fn what_needs_masks_or_clip_paths_is_refused() {
        let printed = printed();
        let refused = |scene: &Scene| match check_fill(scene) {
            Err(Error::Fill(fault)) => Some(fault),
            _ => None,
        };
        assert_eq!(refused(&printed), None);
        let outline = printed.elements[0].outline().clone();
        let shaped = Scene { domain: Some(Domain { outline, edge: Edge::Clip }), ..printed.clone() };
        assert_eq!(refused(&shaped), Some(FillFault::Shape));
        let photo = testing::tiled(240, 160, 2, BOTH);
        assert_eq!(refused(&photo), Some(FillFault::Shading));
        let cloudy = Scene { layers: photo.layers.clone(), ..printed.clone() };
        assert_eq!(refused(&cloudy), Some(FillFault::Background));
        let ends = Scene { tile: Tile::default(), ..printed };
        let options = SvgOptions { fills: true, ..SvgOptions::default() };
        assert!(matches!(write(&ends, &options, io::sink()).unwrap_err().downcast(), Ok(Error::Seams)));
    }
}
