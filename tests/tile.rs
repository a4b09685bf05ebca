//! A texture that tiles shows no seam between its copies.

use std::sync::OnceLock;
use tiny_skia::Pixmap;
use vtex::geometry::{Affine, Outline, Vec2};
use vtex::library::{AnalyzeParams, Library};
use vtex::output::{png, raster_svg, svg};
use vtex::scene::{Role, Scene, SynthParams, Tile};
use vtex::synth::synthesize;

const WIDTH: u32 = 240;
const HEIGHT: u32 = 200;

/// The library of the middle of a generated exemplar.
fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(|| crate::support::library("pebbles"))
}

fn texture(tile: Tile) -> Scene {
    texture_of(library(), tile)
}

fn texture_of(library: &Library, tile: Tile) -> Scene {
    let params = SynthParams { width: WIDTH, height: HEIGHT, seed: 4, tile, ..SynthParams::default() };
    synthesize(library, &params, &()).unwrap()
}

fn svg_of(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    svg::write(scene, &svg::SvgOptions::default(), &mut bytes).unwrap();
    bytes
}

/// The scene with everything shifted and, along axes that tile, wrapped onto the canvas.
fn moved(mut scene: Scene, by: Vec2) -> Scene {
    let tile = scene.tile;
    let along = |v: f64, d: f64, size: u32, repeats: bool| {
        if repeats { (v + d).rem_euclid(f64::from(size)) } else { v + d }
    };
    for instance in scene.instances_mut() {
        let t = instance.transform;
        instance.transform[4] = along(t[4], by.x, WIDTH, tile.x);
        instance.transform[5] = along(t[5], by.y, HEIGHT, tile.y);
    }
    for p in scene.layers.iter_mut().filter_map(|l| l.field.as_mut()).flat_map(|f| &mut f.points) {
        (p.x, p.y) = (along(p.x, by.x, WIDTH, tile.x), along(p.y, by.y, HEIGHT, tile.y));
    }
    for region in scene.layers.iter_mut().filter_map(|l| l.region.as_mut()) {
        *region = Outline::new(&(Affine::translate(by) * region.path())).unwrap();
    }
    scene
}

/// Mean and largest difference, in 8-bit steps, between adjacent copies of a tile, from the place `at` on,
/// and another picture.
fn difference(tile: &Pixmap, whole: &Pixmap, at: Vec2) -> (f64, u8) {
    let (mut sum, mut most) = (0.0, 0);
    for y in 0..whole.height() {
        for x in 0..whole.width() {
            let (tx, ty) = ((x + at.x as u32) % tile.width(), (y + at.y as u32) % tile.height());
            let (a, b) = (tile.pixel(tx, ty).unwrap(), whole.pixel(x, y).unwrap());
            for gap in [a.red().abs_diff(b.red()), a.green().abs_diff(b.green()), a.blue().abs_diff(b.blue())]
            {
                sum += f64::from(gap);
                most = most.max(gap);
            }
        }
    }
    (sum / f64::from(3 * whole.width() * whole.height()), most)
}

#[test]
fn three_by_three_tiles_have_no_seam() {
    no_seams(library(), 3);
}

#[test]
fn regions_have_no_seam() {
    no_seams(
        &crate::support::library_with("pebbles", &AnalyzeParams { layers: 2, ..AnalyzeParams::default() }),
        6,
    );
}

fn no_seams(library: &Library, layers: usize) {
    for (x, y) in [(true, true), (true, false), (false, true)] {
        let tile = Tile { x, y };
        let scene = texture_of(library, tile);
        assert_eq!((scene.tile, scene.layers.len()), (tile, layers));
        let half = |repeats: bool, size: u32| if repeats { f64::from(size / 2) } else { 0.0 };
        let by = Vec2::new(half(x, WIDTH), half(y, HEIGHT));
        let other = moved(scene.clone(), by);
        let direct = [&scene, &other].map(|s| png::render(s, 1.0).unwrap());
        let by_svg = [&scene, &other].map(|s| raster_svg::render_svg(&svg_of(s), 1.0, "tile", &()).unwrap());
        for [tile, whole] in [direct, by_svg] {
            let (mean, most) = difference(&tile, &whole, by);
            assert!(mean < 0.7 && most <= 60, "{x} {y}: mean {mean}, largest {most}");
        }
    }
}

/// Textons cross the edges, so the test above can fail.
#[test]
fn textons_cross_every_edge_that_joins() {
    let scene = texture(Tile { x: true, y: true });
    for layer in scene.layers.iter().filter(|layer| layer.role != Role::Background) {
        let crossing = layer.instances.iter().filter(|i| {
            let bounds = scene.element(i).bounds();
            scene.copies(i.affine().transform_rect_bbox(bounds)).count() > 1
        });
        assert!(crossing.count() > 5);
    }
}

#[test]
fn a_pattern_is_written_of_what_tiles_both_ways_only() {
    let mut bytes = Vec::new();
    let options = svg::SvgOptions::default();
    svg::write_pattern(&texture(Tile { x: true, y: true }), &options, &mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    assert!(
        text.contains(
            "<pattern id=\"texture\" patternUnits=\"userSpaceOnUse\" width=\"240\" height=\"200\">"
        )
    );
    assert!(!text.contains("<image"));
    let error =
        svg::write_pattern(&texture(Tile { x: true, y: false }), &options, std::io::sink()).unwrap_err();
    assert!(matches!(error.downcast(), Ok(vtex::Error::Seams)));
}
