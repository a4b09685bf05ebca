//! Tests: a scene that tiles has no seam, drawn directly or from its SVG.

use super::png::render;
use super::raster_svg::render_svg;
use super::svg::{self, SvgOptions};
use super::{coverage, inside, testing};
use tiny_skia::Pixmap;
use vtex_base::geometry::{Affine, BezPath, Outline};
use vtex_scene::scene::{Domain, Edge, ElementId, Scene, Tile};

pub(super) const TILES: [Tile; 3] =
    [Tile { x: true, y: true }, Tile { x: true, y: false }, Tile { x: false, y: true }];

/// Rows of the background lie at equal places before and after a move by half of this canvas.
const SIZE: (u32, u32) = (300, 200);

fn by_svg(scene: &Scene, options: SvgOptions, scale: f64) -> Pixmap {
    let mut bytes = Vec::new();
    svg::write(scene, &options, &mut bytes).unwrap();
    render_svg(&bytes, scale, "test", &()).unwrap()
}

/// All ways of drawing, by name.
pub(super) fn pictures(scene: &Scene, scale: f64) -> [(&'static str, Pixmap); 3] {
    // Precise enough to compare single pixels.
    let fine = SvgOptions { precision: 2, ..SvgOptions::default() };
    let expanded = SvgOptions { expand: true, ..fine };
    [
        ("png", render(scene, scale).unwrap()),
        ("svg", by_svg(scene, fine, scale)),
        ("expanded", by_svg(scene, expanded, scale)),
    ]
}

/// Pixel (x, y) of copies of a picture laid side by side.
pub(super) fn laid(picture: &Pixmap, x: u32, y: u32) -> [u8; 4] {
    let p = picture.pixel(x % picture.width(), y % picture.height()).unwrap();
    [p.red(), p.green(), p.blue(), p.alpha()]
}

/// Compares copies laid side by side, begun at (dx, dy), with another picture: mean difference of
/// components, and the share of pixels that differ by more than `most`.
pub(super) fn difference(tiles: &Pixmap, whole: &Pixmap, dx: u32, dy: u32, most: u8) -> (f64, f64) {
    let (mut sum, mut bad) = (0.0, 0.0);
    for y in 0..whole.height() {
        for x in 0..whole.width() {
            let (a, b) = (laid(tiles, x + dx, y + dy), laid(whole, x, y));
            let gaps = [0, 1, 2, 3].map(|c| a[c].abs_diff(b[c]));
            sum += gaps.iter().map(|g| f64::from(*g)).sum::<f64>() / 4.0;
            bad += f64::from(u8::from(gaps.iter().any(|g| *g > most)));
        }
    }
    let pixels = f64::from(whole.width() * whole.height());
    (sum / pixels, bad / pixels)
}

/// Half a period along the axes that tile, in pixels.
fn half(tile: Tile) -> (u32, u32) {
    (if tile.x { SIZE.0 / 2 } else { 0 }, if tile.y { SIZE.1 / 2 } else { 0 })
}

#[test]
fn tiles_laid_side_by_side_show_no_seam() {
    for tile in TILES {
        let scene = testing::tiled(SIZE.0, SIZE.1, 1, tile);
        let (dx, dy) = half(tile);
        let moved = testing::moved(scene.clone(), f64::from(dx), f64::from(dy));
        for scale in [1u32, 2] {
            let scaled = f64::from(scale);
            for ((name, tiles), (_, whole)) in pictures(&scene, scaled).iter().zip(&pictures(&moved, scaled))
            {
                let (mean, bad) = difference(tiles, whole, dx * scale, dy * scale, 40);
                assert!(mean < 0.3 && bad == 0.0, "{name} {tile:?} x{scale}: mean {mean}, bad {bad}");
            }
        }
    }
}

#[test]
fn the_background_alone_shows_no_seam() {
    for tile in TILES {
        let mut scene = testing::tiled(SIZE.0, SIZE.1, 2, tile);
        scene.layers.iter_mut().for_each(|layer| layer.instances.clear());
        let (dx, dy) = half(tile);
        let moved = testing::moved(scene.clone(), f64::from(dx), f64::from(dy));
        for ((name, tiles), (_, whole)) in pictures(&scene, 1.0).iter().zip(&pictures(&moved, 1.0)) {
            // The places of stops depend on the beginnings of columns, which differ after the move.
            let [(mean, more), (_, most)] = [2, 5].map(|d| difference(tiles, whole, dx, dy, d));
            assert!(mean < 0.6 && more < 0.05 && most == 0.0, "{name} {tile:?}: {mean} {more} {most}");
        }
    }
}

/// A scene that does not tile has seams, so the test above can fail.
#[test]
fn without_tiling_there_is_a_seam() {
    let tile = TILES[0];
    let mut scene = testing::tiled(SIZE.0, SIZE.1, 1, tile);
    let (dx, dy) = half(tile);
    let moved = testing::moved(scene.clone(), f64::from(dx), f64::from(dy));
    scene.tile = Tile::default();
    let (mean, bad) = difference(&render(&scene, 1.0).unwrap(), &render(&moved, 1.0).unwrap(), dx, dy, 4);
    assert!(mean > 1.0 && bad > 0.02, "{mean} {bad}");
}

#[test]
fn both_writers_draw_the_same_copies() {
    for tile in TILES {
        let [(_, png), (_, svg), (_, expanded)] = pictures(&testing::tiled(310, 190, 3, tile), 1.3);
        for other in [svg, expanded] {
            let (mean, bad) = difference(&png, &other, 0, 0, 40);
            assert!(mean < 0.5 && bad == 0.0, "{tile:?}: {mean} {bad}");
        }
    }
}

#[test]
fn coverage_does_not_depend_on_where_the_seam_lies() {
    let scene = testing::tiled(SIZE.0, SIZE.1, 4, TILES[0]);
    let moved = testing::moved(scene.clone(), 150.0, 100.0);
    let [a, b] = [&scene, &moved].map(|s| coverage(s).into_values().collect::<Vec<_>>());
    // Rounding may move a border across the centre of a pixel.
    assert!(a.iter().zip(&b).all(|(a, b)| a.abs_diff(*b) <= a / 500), "{a:?} {b:?}");
    assert_eq!(inside(&scene), u64::from(SIZE.0 * SIZE.1));
}

/// A bean, at a place.
fn domain(x: f64, y: f64, edge: Edge) -> Domain {
    let path = BezPath::from_svg("M0 0C60-80 150-60 140 20C130 80 90 40 60 60C20 90-40 50 0 0Z").unwrap();
    Domain { outline: Outline::new(&(Affine::translate((x, y)) * path)).unwrap(), edge }
}

#[test]
fn outside_the_domain_nothing_is_drawn() {
    for edge in [Edge::Keep, Edge::Clip, Edge::Avoid] {
        let mut scene = testing::scene(SIZE.0, SIZE.1, 5);
        let full = render(&scene, 1.5).unwrap();
        scene.domain = Some(domain(80.3, 90.7, edge));
        let all = pictures(&scene, 1.5);
        for (name, picture) in &all[1..] {
            let (mean, bad) = difference(&all[0].1, picture, 0, 0, 64);
            assert!(mean < 0.5 && bad == 0.0, "{edge:?} {name}: {mean} {bad}");
        }
        let picture = &all[0].1;
        let centre = laid(picture, 225, 135);
        assert_eq!(centre, laid(&full, 225, 135), "inside all stays");
        let clear = picture.pixels().iter().filter(|p| p.alpha() == 0).count();
        let solid = picture.pixels().iter().filter(|p| p.alpha() == 255).count();
        let area = scene.domain.as_ref().unwrap().outline.area() * 2.25;
        let pixels = picture.pixels().len() as f64;
        if edge == Edge::Keep {
            assert!(solid as f64 > area * 1.1, "textons stick out");
        } else {
            assert!((solid as f64 - area).abs() < 600.0 && (clear as f64 - pixels + area).abs() < 600.0);
        }
    }
}

#[test]
fn only_what_is_inside_the_domain_counts() {
    let mut scene = testing::scene(SIZE.0, SIZE.1, 6);
    let all: u64 = coverage(&scene).values().sum();
    scene.domain = Some(domain(80.0, 90.0, Edge::Keep));
    let (covered, pixels): (u64, u64) = (coverage(&scene).values().sum(), inside(&scene));
    let area = scene.domain.as_ref().unwrap().outline.area();
    assert!((pixels as f64 - area).abs() < 60.0, "{pixels} {area}");
    assert!(covered < pixels && covered > 0 && covered < all);
    scene.domain.as_mut().unwrap().outline = Outline::default();
    assert!(render(&scene, 1.0).unwrap_err().to_string().contains("domain"));
}

/// The copies of a domain count too.
#[test]
fn a_domain_may_cross_the_seam() {
    let mut scene = testing::tiled(SIZE.0, SIZE.1, 7, TILES[0]);
    scene.domain = Some(domain(80.0, 90.0, Edge::Clip));
    let moved = testing::moved(scene.clone(), 150.0, 100.0);
    for ((name, tiles), (_, whole)) in pictures(&scene, 1.0).iter().zip(&pictures(&moved, 1.0)) {
        let (mean, bad) = difference(tiles, whole, 150, 100, 64);
        assert!(mean < 0.2 && bad == 0.0, "{name}: mean {mean}, bad {bad}");
    }
}

#[test]
fn a_pattern_shows_the_tile_again_and_again() {
    let scene = testing::tiled(120, 90, 8, TILES[0]);
    let mut bytes = Vec::new();
    svg::write_pattern(&scene, &SvgOptions::default(), &mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let tile = by_svg(&scene, SvgOptions::default(), 1.0);
    let sheet = text.replacen("width=\"100%\" height=\"100%\"", "width=\"360\" height=\"270\"", 1);
    let sheet = render_svg(sheet.as_bytes(), 1.0, "sheet", &()).unwrap();
    assert_eq!((sheet.width(), sheet.height()), (360, 270));
    let (mean, bad) = difference(&tile, &sheet, 0, 0, 3);
    assert!(mean < 0.2 && bad == 0.0, "{mean} {bad}");
    // Where the cell ends within a pixel of the picture there is no hairline either.
    for scale in [0.77, 1.37, 1.75, 2.5] {
        let sheet = text.replacen("width=\"100%\" height=\"100%\"", "width=\"400\" height=\"300\"", 1);
        let sheet = render_svg(sheet.as_bytes(), scale, "sheet", &()).unwrap();
        assert!(sheet.pixels().iter().all(|p| p.alpha() == 255), "{scale}");
    }
    for tile in [TILES[1], TILES[2], Tile::default()] {
        let scene = testing::tiled(120, 90, 8, tile);
        let error = svg::write_pattern(&scene, &SvgOptions::default(), std::io::sink()).unwrap_err();
        assert!(matches!(error.downcast(), Ok(vtex_base::error::Error::Seams)));
    }
}

#[test]
fn shadows_and_lines_are_alike_in_all_writers_and_cross_the_seams() {
    for tile in TILES {
        let scene = testing::styled(testing::tiled(SIZE.0, SIZE.1, 9, tile));
        let (dx, dy) = half(tile);
        let moved = testing::moved(scene.clone(), f64::from(dx), f64::from(dy));
        let all = pictures(&scene, 1.0);
        for ((name, tiles), (_, whole)) in all.iter().zip(&pictures(&moved, 1.0)) {
            // Bends of lines are drawn slightly differently at different places.
            let (mean, bad) = difference(tiles, whole, dx, dy, 40);
            assert!(mean < 0.4 && bad < 2e-4, "{name} {tile:?}: mean {mean}, bad {bad}");
        }
        for (name, other) in &all[1..] {
            let (mean, bad) = difference(&all[0].1, other, 0, 0, 40);
            assert!(mean < 0.5 && bad == 0.0, "{name} {tile:?}: mean {mean}, bad {bad}");
        }
    }
}

#[test]
fn a_shadow_falls_on_what_lies_below_and_on_nothing_above() {
    let mut scene = testing::scene(200, 120, 10);
    scene.secondary_mut().clear();
    scene.primary_mut().truncate(3);
    let plain = scene.elements[..24].iter().position(|e| e.details().is_empty()).unwrap();
    for (instance, x) in scene.primary_mut().iter_mut().zip([60.0, 95.0, 130.0]) {
        instance.element = ElementId::after(plain);
        instance.transform = [1.0, 0.0, 0.0, 1.0, x, 60.0];
        instance.colour = Some(vtex_base::raster::colour::Colour([200, 60, 60]));
    }
    let plain = render(&scene, 1.0).unwrap();
    scene.primary_mut()[1].shadow =
        Some(vtex_scene::scene::Shadow { offset: [30.0, 0.0], opacity: 0.5, blur: 6.0 });
    let right = render(&scene, 1.0).unwrap();
    scene.primary_mut()[1].shadow =
        Some(vtex_scene::scene::Shadow { offset: [-35.0, 0.0], opacity: 0.5, blur: 6.0 });
    let left = render(&scene, 1.0).unwrap();
    let (first, second, third) = ((55, 60), (95, 60), (133, 60));
    assert_eq!(laid(&right, third.0, third.1), laid(&plain, third.0, third.1));
    assert_eq!(laid(&right, second.0, second.1), laid(&plain, second.0, second.1));
    assert!(laid(&left, first.0, first.1)[0] < laid(&plain, first.0, first.1)[0]);
}

#[test]
fn layers_with_regions_strokes_and_radial_gradients_are_alike_in_all_writers() {
    for tile in [Tile::default(), TILES[0]] {
        for edge in [None, Some(Edge::Keep), Some(Edge::Clip)] {
            let mut scene = testing::drawn(testing::tiled(SIZE.0, SIZE.1, 11, tile));
            scene.domain = edge.map(|edge| domain(80.0, 90.0, edge));
            assert_eq!(Scene::from_bytes(scene.to_json(), "drawn").unwrap(), scene);
            let all = pictures(&scene, 1.0);
            for (name, other) in &all[1..] {
                let (mean, bad) = difference(&all[0].1, other, 0, 0, 40);
                assert!(mean < 0.5 && bad < 1e-3, "{name} {tile:?} {edge:?}: mean {mean}, bad {bad}");
            }
        }
    }
    // The region hides what lies outside of it, and shows its field inside.
    let plain = render(&testing::tiled(SIZE.0, SIZE.1, 11, Tile::default()), 1.0).unwrap();
    let drawn = render(&testing::drawn(testing::tiled(SIZE.0, SIZE.1, 11, Tile::default())), 1.0).unwrap();
    assert_eq!(laid(&plain, 5, 100), laid(&drawn, 5, 100));
    assert_eq!(laid(&drawn, 297, 60), [70, 110, 60, 255]);
}
