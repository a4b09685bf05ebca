//! Tests: soft rims are drawn alike by all writers.

use super::png::render;
use super::seams::{TILES, difference, laid, pictures};
use super::svg::{self, SvgOptions};
use super::{pdf, testing};
use roxmltree::{Document, Node};
use vtex_base::geometry::{Affine, Outline, parse_path};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::SoftRim;
use vtex_scene::scene::{Domain, Edge, ElementId, Instance, InstanceId, Scene, Shape, Tile};

/// A square of 120 × 120 px alone in the middle of a canvas of 200 × 200, with a rim.
fn square(rim: Option<SoftRim>) -> Scene {
    let mut scene = testing::scene(200, 200, 1);
    let outline = Outline::new(&parse_path("M-60-60h120v120h-120z").unwrap()).unwrap();
    let shape = Shape { rim: rim.map(Box::new), ..Shape::new(outline, Colour([200, 120, 40])) };
    scene.elements[0].shapes = vec![shape];
    scene.layers.iter_mut().for_each(|layer| layer.instances.clear());
    let transform = Affine::translate((100.0, 100.0)).as_coeffs();
    scene.primary_mut().push(Instance { transform, ..Instance::new(InstanceId(1), ElementId(0)) });
    scene
}

fn text(scene: &Scene, options: &SvgOptions) -> String {
    let mut bytes = Vec::new();
    svg::write(scene, options, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

#[test]
fn the_opacity_of_a_rim_falls_as_told() {
    let rim = SoftRim { width: 12.0, colour: Colour([10, 60, 220]), opacity: 0.9 };
    let (plain, rimmed) = (pictures(&square(None), 1.0), pictures(&square(Some(rim)), 1.0));
    for ((name, plain), (_, rimmed)) in plain.iter().zip(&rimmed) {
        // Across the left side, at x = 40.
        for x in 30..50 {
            let opacity = rim.opacity_at((f64::from(x) + 0.5 - 40.0).abs());
            let (below, seen) = (laid(plain, x, 100), laid(rimmed, x, 100));
            for c in 0..3 {
                let below = f64::from(below[c]);
                let wanted = below + opacity * (f64::from(rim.colour.0[c]) - below);
                assert!((f64::from(seen[c]) - wanted).abs() <= 3.0, "{name} {x} {c}: {seen:?}, not {wanted}");
            }
        }
    }
    assert!(rim.opacity_at(0.5) > 0.7);
}

#[test]
fn rims_are_alike_in_all_writers() {
    for (tile, scale) in [(Tile::default(), 0.5), (Tile::default(), 2.3), (TILES[0], 1.0)] {
        for edge in [None, Some(Edge::Keep), Some(Edge::Clip)] {
            let bare = testing::styled(testing::tiled(300, 200, 11, tile));
            let mut scene = testing::rimmed(bare.clone());
            scene.domain = edge.map(|edge| Domain { outline: bean(), edge });
            let all = pictures(&scene, scale);
            for (name, other) in &all[1..] {
                let (mean, bad) = difference(&all[0].1, other, 0, 0, 40);
                assert!(mean < 0.5 && bad < 1e-3, "{name} {tile:?} {edge:?} {scale}: {mean}, bad {bad}");
            }
            let bare = Scene { domain: scene.domain.clone(), ..bare };
            let (mean, _) = difference(&all[0].1, &render(&bare, scale).unwrap(), 0, 0, 40);
            assert!(mean > 0.3, "{tile:?} {edge:?} {scale}: {mean}");
        }
    }
}

fn bean() -> Outline {
    let path = parse_path("M80 90C140 10 230 30 220 110C210 170 170 130 140 150C100 180 40 140 80 90Z");
    Outline::new(&path.unwrap()).unwrap()
}

#[test]
fn rims_show_no_seam() {
    let scene = testing::rimmed(testing::tiled(300, 200, 1, TILES[0]));
    let moved = testing::moved(scene.clone(), 150.0, 100.0);
    for ((name, tiles), (_, whole)) in pictures(&scene, 1.0).iter().zip(&pictures(&moved, 1.0)) {
        let (mean, bad) = difference(tiles, whole, 150, 100, 40);
        assert!(mean < 0.3 && bad == 0.0, "{name}: mean {mean}, bad {bad}");
    }
    // An element beyond the border whose rim alone reaches the canvas.
    let rim = SoftRim { width: 20.0, colour: Colour([10, 60, 220]), opacity: 1.0 };
    let mut beyond = square(Some(rim));
    beyond.tile = TILES[0];
    beyond.primary_mut()[0].transform[4] = -62.0;
    for (name, picture) in pictures(&beyond, 1.0) {
        let [red, _, blue, _] = laid(&picture, 0, 100);
        assert!(blue > 120 && red < 80, "{name}: {red} {blue}");
    }
}

#[test]
fn an_svg_has_each_outline_once() {
    let scene = testing::rimmed(testing::scene(400, 300, 3));
    let shared = text(&scene, &SvgOptions::default());
    let document = Document::parse(&shared).unwrap();
    let is_rim = |node: &Node<'_, '_>| node.attribute("class") == Some("rim");
    let rims: Vec<Node<'_, '_>> = document.descendants().filter(is_rim).collect();
    let drawn = (0..scene.elements.len()).filter(|k| scene.instances().any(|i| i.element.index() == *k));
    assert_eq!(rims.len(), drawn.filter(|k| scene.elements[*k].base().rim.is_some()).count());
    for rim in rims {
        assert_eq!((rim.attribute("fill"), rim.attribute("stroke-linejoin")), (Some("none"), Some("round")));
        let lines: Vec<Node<'_, '_>> = rim.children().filter(Node::is_element).collect();
        let number = |node: &Node<'_, '_>, name| node.attribute(name).unwrap().parse::<f64>().unwrap();
        let widths: Vec<f64> = lines.iter().map(|line| number(line, "stroke-width")).collect();
        assert!(widths.len() == 3 && widths.is_sorted_by(|a, b| a > b), "{widths:?}");
        // The outline itself has no paint of its own, which would hide that of the rim.
        let link = lines[0].attribute(("http://www.w3.org/1999/xlink", "href")).unwrap();
        let of_link = |node: &Node<'_, '_>| node.attribute("id") == Some(&link[1..]);
        let path = document.descendants().find(of_link).unwrap();
        assert!(path.has_tag_name(("http://www.w3.org/2000/svg", "path")));
        assert!(["fill", "stroke", "stroke-width"].iter().all(|name| !path.has_attribute(*name)));
    }
    let expanded = text(&scene, &SvgOptions { expand: true, ..SvgOptions::default() });
    assert!(expanded.contains("class=\"rim\"") && !expanded.contains("<use"));
}

#[test]
fn a_pdf_has_three_lines_for_a_rim() {
    let strokes = |scene: &Scene| {
        let mut bytes = Vec::new();
        pdf::write(scene, &mut bytes).unwrap();
        pdf::tests::count(&pdf::tests::objects(&bytes), "/CA ")
    };
    let rim = SoftRim { width: 12.0, colour: Colour([10, 60, 220]), opacity: 0.9 };
    assert_eq!((strokes(&square(None)), strokes(&square(Some(rim)))), (0, 3));
}
