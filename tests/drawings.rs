//! Drawings as exemplars: import, refusals, and textures made of them.

use std::collections::BTreeSet;
use vtex::geometry::{Affine, Outline, Point, Rect, parse_path};
use vtex::import::{Grouping, ImportParams, import};
use vtex::library::{AnalyzeParams, ExemplarElement, Library, SourceKind};
use vtex::output::raster_svg::render_svg;
use vtex::output::svg::{self, SvgOptions};
use vtex::output::{pdf, png};
use vtex::raster::ControlMap;
use vtex::scene::{Edge, Method, Scene, SynthParams, Tile};
use vtex::synth::{CanvasSize, Controls, Cost, reconstruct, synthesize, synthesize_with};
use vtex::{Error, Result};

const GARDEN: &[u8] = include_bytes!("../examples/drawings/garden.svg");

fn svg(inner: &str) -> Vec<u8> {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 100 80">{inner}</svg>"#)
        .into_bytes()
}

fn read(bytes: &[u8]) -> Result<Library> {
    import(bytes, "drawing.svg", &ImportParams::default(), &())
}

fn of(inner: &str) -> Library {
    read(&svg(inner)).unwrap()
}

fn lenient(inner: &str) -> Result<Library> {
    let analyze = AnalyzeParams { lenient: true, ..AnalyzeParams::default() };
    import(&svg(inner), "drawing.svg", &ImportParams { analyze, wrap: None }, &())
}

/// Mean difference of all samples of a reconstruction and resvg's drawing over white, in 8-bit steps.
fn difference(bytes: &[u8], library: &Library) -> f64 {
    let scene = reconstruct(library);
    let drawn = png::render(&scene, 1.0).unwrap();
    let page = render_svg(bytes, 1.0, "drawing.svg", &()).unwrap();
    let scale = f64::from(drawn.width()) / f64::from(page.width());
    let wanted = render_svg(bytes, scale, "drawing.svg", &()).unwrap();
    assert_eq!((wanted.width(), wanted.height()), (drawn.width(), drawn.height()));
    let over_white = |p: &tiny_skia::PremultipliedColorU8| {
        [p.red(), p.green(), p.blue()].map(|v| f64::from(v) + 255.0 - f64::from(p.alpha()))
    };
    let sum: f64 = wanted
        .pixels()
        .iter()
        .zip(drawn.pixels())
        .map(|(a, b)| (0..3).map(|k| (over_white(a)[k] - over_white(b)[k]).abs()).sum::<f64>())
        .sum();
    sum / (3.0 * wanted.pixels().len() as f64)
}

fn texture(library: &Library, params: SynthParams) -> Scene {
    synthesize(library, &params, &()).unwrap()
}

#[test]
fn a_drawing_of_many_kinds_of_shapes_is_read_and_drawn_back() {
    let library = read(GARDEN).unwrap();
    assert_eq!(library.source.kind, SourceKind::Drawing);
    assert!(library.arrangement.periodic, "its borders join");
    assert_eq!(library.background().fallback.0, [0xf6, 0xf2, 0xe7]);
    // Three flowers of two shapes each, four leaves, two suns, three stems; elements cut by a border are
    // listed once.
    assert_eq!(library.primaries().len(), 12);
    assert!(library.primaries().iter().all(|p| !p.clipped));
    assert_eq!(library.primaries().iter().filter(|p| p.shapes.len() == 2).count(), 3);
    assert_eq!(library.primaries().iter().filter(|p| p.shapes[0].line.is_some()).count(), 3);
    assert_eq!(library.primaries().iter().filter(|p| p.shapes[0].gradient.is_some()).count(), 2);
    let found = difference(GARDEN, &library);
    assert!(found <= 0.5, "{found}");
    // Equal elements are listed once: a flower, a leaf, two suns, three stems.
    assert_eq!(reconstruct(&library).elements.len(), 7);
    let again = Library::from_bytes(library.to_json(), "again").unwrap();
    assert!(again.to_json() == library.to_json(), "what is stored is read again");
}

#[test]
fn halves_at_the_borders_become_one_element() {
    let inner = r##"<rect width="100" height="80" fill="#eee"/>
        <path fill="#357" d="M0 20c8 0 8 20 0 20zM100 20v20c-8 0-8-20 0-20z"/><path fill="#735" d="M40 30h20v20h-20z"/>
        <path fill="#375" d="M70 0h9v6h-9zM70 80v-5h9v5z"/>"##;
    let library = of(inner);
    assert_eq!(library.primaries().len(), 3);
    assert!(library.primaries().iter().all(|p| !p.clipped && p.shapes.len() == 1));
    // The joined element has the area of both halves.
    let areas: Vec<f64> = library.primaries().iter().map(|p| p.base().outline.area()).collect();
    let scale = f64::from(library.source.width) / 100.0;
    assert!(areas.iter().any(|a| (a / scale / scale - 11.0 * 9.0).abs() < 0.5), "{areas:?}");
    assert!(difference(&svg(inner), &library) <= 0.5);
}

#[test]
fn elements_that_go_on_beyond_a_page_that_ends_are_whole() {
    let flower = |x: i32, y: i32| {
        let petal = |dx: i32, dy: i32| format!("<circle cx='{}' cy='{}' r='4'/>", x + dx, y + dy);
        let petals: String = [(-7, 0), (7, 0), (0, -7), (0, 7)].map(|(dx, dy)| petal(dx, dy)).concat();
        format!("<g fill='#a33'>{petals}</g>")
    };
    let inside: String = (0..9).map(|k| flower(25 + 25 * (k % 3), 25 + 20 * (k / 3))).collect();
    // One has its lower petal beside the page; of another only a petal is on it; a third was cut there.
    let inner = format!("{inside}{}{}<path fill='#a33' d='M0 20h6v10h-6z'/>", flower(88, 78), flower(12, -7));
    let library = of(&inner);
    assert!(!library.arrangement.periodic);
    let at = |x: f64, y: f64| {
        let far = |e: &&ExemplarElement| Point::new(e.centroid[0], e.centroid[1]).distance(Point::new(x, y));
        let all = library.primaries().iter();
        all.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
    };
    let [whole, beyond, beside, cut] = [at(25.0, 25.0), at(88.0, 78.0), at(12.0, 0.0), at(3.0, 25.0)];
    assert_eq!([whole, beyond, beside, cut].map(|e| e.clipped), [false, false, true, true]);
    assert_eq!([whole, beyond].map(|e| e.shapes.len()), [4, 4]);
    assert_eq!(whole.category, beyond.category);
    assert!((f64::from(beyond.area) / f64::from(whole.area) - 1.0).abs() < 0.1, "{}", beyond.area);
    // Categories cover what is seen of them.
    let seen: f64 = library.categories.iter().map(|c| c.coverage).sum();
    assert!((seen - library.coverage).abs() < 1e-9 && seen < 0.4, "{seen}");
}

#[test]
fn a_page_that_ends_is_arranged_as_its_neighbourhoods() {
    let mark = |k: usize| {
        let (x, y) = (2 + 20 * (k % 5) + k * 7 % 5, 10 + 19 * (k / 5) + k * 5 % 6);
        format!("<circle cx='{x}' cy='{y}' r='{}' fill='#{}'/>", 3 + k % 2, ["a33", "33a"][k * k % 3 % 2])
    };
    let library = of(&(0..20).map(mark).collect::<String>());
    let params = SynthParams { width: 300, height: 300, ..SynthParams::default() };
    let libraries = std::slice::from_ref(&library);
    let (_, report) = synthesize_with(libraries, &params, &Controls::default(), &()).unwrap();
    let chosen = if cfg!(feature = "clustered") { Method::Clustered } else { Method::Descriptor };
    assert_eq!(report.method, chosen);
    assert!((report.coverage / report.coverage_wanted - 1.0).abs() < 0.1, "{report:?}");
    assert_eq!(report.overlap.hidden, 0.0);
}

#[test]
fn how_shapes_are_grouped_can_be_chosen() {
    let inner = r##"<rect width="100" height="80" fill="#eee"/><g><path fill="#357" d="M10 10h8v8h-8zM30 10h8v8h-8z"/>
        <circle fill="#f90" cx="24" cy="30" r="6"/></g><circle fill="#090" cx="70" cy="50" r="9"/>"##;
    let count = |elements: Grouping| {
        let analyze = AnalyzeParams { elements, ..AnalyzeParams::default() };
        let params = ImportParams { analyze, wrap: None };
        import(&svg(inner), "drawing.svg", &params, &()).unwrap().primaries().len()
    };
    let found = [Grouping::Auto, Grouping::Group, Grouping::Path, Grouping::Piece].map(count);
    assert_eq!(found, [2, 2, 3, 4]);
}

#[test]
fn layers_of_the_drawing_are_kept() {
    let inner = r##"<g xmlns:i="http://www.inkscape.org/namespaces/inkscape" i:groupmode="layer" i:label="Far" id="g1">
        <circle cx="20" cy="20" r="5"/></g><g id="Layer_2"><circle cx="60" cy="20" r="5"/><circle cx="80" cy="60" r="5"/></g>"##;
    let library = of(inner);
    let names: Vec<(&str, usize)> = library.layers.iter().map(|l| (&*l.name, l.instances.len())).collect();
    assert_eq!(names, [("background", 0), ("Far", 1), ("Layer_2", 2)]);
    let scene = texture(&library, SynthParams { width: 500, height: 400, ..SynthParams::default() });
    assert_eq!(scene.layers.iter().map(|l| &*l.name).collect::<Vec<_>>(), ["background", "Far", "Layer_2"]);
}

#[test]
fn what_cannot_be_read_is_named_or_left_out() {
    let circle = r#"<circle cx="50" cy="40" r="9"/>"#;
    for (inner, word) in [
        (r#"<image id="photo" width="9" height="9" xlink:href="data:image/png;base64,AAAA"/>"#, "photo"),
        (
            r#"<filter id="f"><feGaussianBlur stdDeviation="2"/></filter><g id="soft" filter="url(#f)"><circle r="9" cx="20" cy="20"/></g>"#,
            "soft",
        ),
        (
            r#"<mask id="m"><rect width="50" height="50" fill="white"/></mask><g id="cut" mask="url(#m)"><circle r="9" cx="20" cy="20"/></g>"#,
            "cut",
        ),
        (
            r#"<pattern id="p" width="9" height="9" patternUnits="userSpaceOnUse"><circle r="3"/></pattern><circle id="filled" cx="25" cy="25" r="20" fill="url(#p)"/>"#,
            "filled",
        ),
        (
            r#"<clipPath id="c"><circle r="5" cx="20" cy="20"/></clipPath><g id="round" clip-path="url(#c)"><rect width="40" height="40"/></g>"#,
            "round",
        ),
    ] {
        let inner = format!("{circle}{inner}");
        let error = read(&svg(&inner)).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
        let library = lenient(&inner).unwrap();
        assert_eq!((library.primaries().len(), library.source.warnings.len()), (1, 1), "{word}");
    }
    // A clip path that is a convex polygon is applied.
    let library = of(
        r##"<rect width="100" height="80" fill="#eee"/><clipPath id="c"><path d="M10 10h20v20h-20z"/></clipPath><g clip-path="url(#c)"><circle r="12" cx="30" cy="20"/></g>"##,
    );
    let [scale, area] =
        [f64::from(library.source.width) / 100.0, library.primaries()[0].base().outline.area()];
    // The left half of a disc of radius 12, as far as it lies within 10 of its middle: ten times the root of
    // 144 - 100, and 144 times the angle whose sine is 10 / 12.
    let wanted = 10.0 * f64::sqrt(44.0) + 144.0 * 0.985_111;
    assert!((area / scale / scale - wanted).abs() < 0.5, "{area}");
    let text = of(&format!("{circle}<text x='5' y='20'>words</text>"));
    assert!(text.source.warnings[0].contains("text"), "{:?}", text.source.warnings);
}

#[test]
fn hostile_drawings_end_in_an_error_or_a_library() {
    for bytes in [&b""[..], b"<svg", b"<html/>", b"{}", &[0xff, 0xfe, 0, 1]] {
        assert!(read(bytes).is_err());
    }
    // A path that cannot be drawn is an error, or draws nothing.
    for d in ["M1e30 0L-1e30 1e30L5 5z", "MNaN 0h9v9z", "M1e39 0h9v9z", "M0 0h1e9v1e9z"] {
        match read(&svg(&format!(r#"<path d="{d}"/><circle cx="50" cy="40" r="9"/>"#))) {
            Ok(library) => assert!(library.primaries().len() <= 2, "{d}"),
            Err(error) => {
                assert!(matches!(error, Error::Control { .. } | Error::Undrawable { .. }), "{error}")
            }
        }
    }
    let bomb: String = (0..12).fold(String::from(r#"<!ENTITY a0 "<circle r='3'/>">"#), |text, k| {
        let inner = format!("&a{k};").repeat(10);
        format!("{text}<!ENTITY a{} \"{inner}\">", k + 1)
    });
    let text = format!(
        r#"<!DOCTYPE svg [{bomb}]><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">&a12;</svg>"#
    );
    assert!(read(text.as_bytes()).is_err());
    let uses: String = (0..12).fold(String::from(r#"<g id="u0"><circle r="3"/></g>"#), |text, k| {
        let inner = format!(r##"<use xlink:href="#u{k}"/>"##).repeat(10);
        format!(r#"{text}<g id="u{}">{inner}</g>"#, k + 1)
    });
    assert!(read(&svg(&format!("<defs>{uses}</defs><use xlink:href='#u12'/>"))).is_err());
    let cycle = r##"<g id="a"><use xlink:href="#b"/></g><g id="b"><use xlink:href="#a"/></g><circle cx="50" cy="40" r="9"/>"##;
    assert!(read(&svg(cycle)).unwrap_err().to_string().contains("lead back to themselves"));
    let outside = r#"<use xlink:href="file:///etc/passwd#a"/><circle cx="50" cy="40" r="9"/>"#;
    assert!(read(&svg(outside)).is_ok_and(|l| l.primaries().len() == 1));
    let many = format!("<g>{}</g>", r#"<path d="M1 1h1v1z"/>"#.repeat(450_000));
    assert!(matches!(read(&svg(&many)), Err(Error::TooLarge { .. })));
    let large = format!("<!--{}-->", " ".repeat(70 << 20));
    assert!(matches!(read(&svg(&large)), Err(Error::TooLarge { .. })));
}

#[test]
fn nearly_empty_drawings_make_textures() {
    for (inner, count) in [
        ("", 0),
        (r##"<rect width="100" height="80" fill="#357"/>"##, 0),
        (r##"<circle cx="50" cy="40" r="9" fill="#357"/>"##, 1),
    ] {
        let library = of(inner);
        assert_eq!(library.primaries().len(), count);
        for tile in [Tile::default(), Tile { x: true, y: true }] {
            let [width, height] = [library.source.width * 2, library.source.height * 2];
            let scene = texture(&library, SynthParams { width, height, tile, ..SynthParams::default() });
            assert_eq!(scene.count(), 4 * count);
        }
    }
}

#[test]
fn elements_keep_apart_and_their_number() {
    let library = read(GARDEN).unwrap();
    let [width, height] = [library.source.width * 3, library.source.height * 3];
    let tile = Tile { x: true, y: true };
    let still = SynthParams { width, height, tile, variation: Some(0.0), ..SynthParams::default() };
    let moved = SynthParams { variation: Some(1.0), seed: 3, ..still.clone() };
    let (still, moved) = (texture(&library, still), texture(&library, moved));
    assert_eq!((still.count(), moved.count()), (9 * 12, 9 * 12));
    let places = |scene: &Scene| -> BTreeSet<String> {
        scene.instances().map(|i| format!("{:?} {:?}", i.element, i.transform)).collect()
    };
    let (a, b) = (places(&still), places(&moved));
    assert!(a.intersection(&b).count() < a.len() / 4, "most elements left their places");
    // The drawn coverage is the same: elements do not touch, so none is hidden.
    let drawn = |scene: &Scene| {
        let picture = png::render(scene, 1.0).unwrap();
        let ground = picture.pixels()[0];
        picture.pixels().iter().filter(|p| **p != ground).count() as f64
    };
    let ratio = drawn(&moved) / drawn(&still);
    assert!((0.97..1.03).contains(&ratio), "{ratio}");
}

#[test]
fn elements_do_not_move_into_empty_rings_nor_across_bands() {
    // Rings in a band above, all of them empty, and dots that fill the rest.
    let ring = |k: i32| {
        format!(
            r##"<circle cx="{}" cy="17" r="9" fill="none" stroke="#123" stroke-width="1"/>"##,
            25 * k + 12
        )
    };
    let at = |k: i32| [7 * (k % 14) + 1 + k * k * 5 % 6, 31 + 7 * (k / 14) + k * k * 3 % 5];
    let dot = |k: i32| format!(r#"<circle cx="{}" cy="{}" r=".7"/>"#, at(k)[0], at(k)[1]);
    let library = of(&(0..4).map(ring).chain((0..84).map(dot)).collect::<String>());
    let params = SynthParams {
        width: 300,
        height: 240,
        variation: Some(1.0),
        method: Method::Period,
        ..SynthParams::default()
    };
    let scene = texture(&library, params);
    let boxes = |small: bool| -> Vec<Rect> {
        let bounds = scene
            .instances()
            .map(|i| Affine::new(i.transform).transform_rect_bbox(scene.element(i).bounds()));
        bounds.filter(|b| (b.width() < 5.0) == small).collect()
    };
    let (dots, rings) = (boxes(true), boxes(false));
    assert!(dots.len() >= 600 && rings.len() >= 30, "{} {}", dots.len(), rings.len());
    for ring in &rings {
        let inside = dots.iter().filter(|dot| dot.center().distance(ring.center()) < 8.0).count();
        assert_eq!(inside, 0, "{ring:?}");
    }
    for dot in &dots {
        let y = dot.center().y.rem_euclid(80.0);
        assert!(!(10.0..24.0).contains(&y), "{dot:?}");
    }
}

/// Rows of scales, each over the next one below, drawn as far as they reach the page.
fn scales() -> Vec<u8> {
    let scale = |row: i32, column: i32| {
        let (x, y) = (25.0 * f64::from(column) + if row % 2 == 0 { 0.0 } else { 12.5 }, 20 * row);
        format!(r##"<circle cx="{x}" cy="{y}" r="14" fill="#9cd" stroke="#024" stroke-width="2"/>"##)
    };
    let row = |row: i32| (-1..=4).map(|column| scale(row, column)).collect::<String>();
    svg(&(0..=4).rev().map(row).collect::<String>())
}

#[test]
fn scales_lie_over_one_another_as_on_the_page_in_every_period() {
    let bytes = scales();
    let library = read(&bytes).unwrap();
    assert!(library.arrangement.periodic && library.source.stacking != [0; 2]);
    let page = render_svg(&bytes, 2.0, "drawing.svg", &()).unwrap();
    for tile in [Tile::default(), Tile { x: true, y: true }] {
        let params =
            SynthParams { width: 200, height: 160, tile, method: Method::Period, ..SynthParams::default() };
        let scene = texture(&library, params);
        let mut written = Vec::new();
        svg::write(&scene, &SvgOptions::default(), &mut written).unwrap();
        let by_svg = render_svg(&written, 2.0, "texture.svg", &()).unwrap();
        for picture in [by_svg, png::render(&scene, 2.0).unwrap()] {
            let differs = |(k, p): (usize, &tiny_skia::PremultipliedColorU8)| {
                let (x, y) = (k % 400 % 200, k / 400 % 160);
                p.red().abs_diff(page.pixels()[200 * y + x].red()) > 80
            };
            let count = picture.pixels().iter().enumerate().filter(|&pixel| differs(pixel)).count();
            assert!(count < 40, "{tile:?}: {count}");
        }
    }
}

/// A page with a pattern of a cross, and four quarters of a disc around it.
fn patterned(transform: &str, filled: &str) -> Vec<u8> {
    let disc = |x: i32, y: i32| format!(r##"<circle cx="{x}" cy="{y}" r="3" fill="#b40"/>"##);
    let discs: String = [(0, 0), (16, 0), (0, 12), (16, 12)].map(|(x, y)| disc(x, y)).concat();
    svg(&format!(
        r##"<pattern id="p" patternUnits="userSpaceOnUse" width="16" height="12" patternTransform="{transform}">
        <rect width="16" height="12" fill="#fec"/><path d="M8 3v6M5 6h6" stroke="#099"/>{discs}</pattern>{filled}"##
    ))
}

#[test]
fn a_page_that_a_pattern_fills_is_one_copy_of_it() {
    let whole = r##"<rect x="-9" y="-9" width="800" height="600" fill="#fff"/><rect x="-5" y="-5" width="300" height="200" fill="url(#p)"/>"##;
    for (transform, size, turned) in [("", [16, 12], false), ("scale(2) rotate(30)", [32, 24], true)] {
        let library = read(&patterned(transform, whole)).unwrap();
        assert_eq!([library.source.width, library.source.height], size);
        assert!(library.arrangement.periodic, "{transform}");
        assert_eq!(library.primaries().len(), 2, "a cross and a disc");
        assert_eq!(library.background().fallback.0, [255, 238, 204]);
        assert_eq!(library.source.warnings.iter().any(|w| w.contains("upright")), turned);
    }
}

#[test]
fn patterns_in_convex_shapes_are_drawn_copy_by_copy() {
    let beside = r#"<rect x="10" y="10" width="40" height="30" fill="url(#p)" stroke="green"/><circle cx="80" cy="50" r="9"/>"#;
    let bytes = patterned("rotate(20)", beside);
    let library = read(&bytes).unwrap();
    assert_eq!([library.source.width, library.source.height], [100, 80]);
    assert!(difference(&bytes, &library) < 1.5);
    // Not of other shapes, nor as strokes, and not without end.
    for odd in [
        r#"<circle cx="50" cy="40" r="30" fill="url(#p)"/>"#,
        r#"<path d="M9 9h50v50" fill="none" stroke="url(#p)"/>"#,
    ] {
        let bytes = patterned("", odd);
        assert!(read(&bytes).unwrap_err().to_string().contains("pattern"), "{odd}");
    }
    let endless = patterned(
        "scale(.001)",
        r#"<rect x="10" y="10" width="40" height="30" fill="url(#p)"/><rect width="1" height="1"/>"#,
    );
    assert!(read(&endless).unwrap_err().to_string().contains("too many copies"));
}

#[test]
fn a_tangle_is_not_clustered() {
    let line = |k: i32| format!(r#"<path d="M{} 6L{} 74" stroke="black"/>"#, 5 + k % 20, 70 + k * 7 % 25);
    let library = of(&(0..300).map(line).collect::<String>());
    let params = SynthParams { width: 100, height: 80, method: Method::Clustered, ..SynthParams::default() };
    let error = synthesize(&library, &params, &()).unwrap_err().to_string();
    assert!(error.contains("whose elements overlap few others"), "{error}");
}

#[test]
fn what_touches_a_border_does_not_need_a_copy_beyond_it() {
    let discs = |ground: &str, left: f64| {
        let whole = (0..40).map(|k| [12 + k * 37 % 76, 8 + k * 23 % 64]);
        let whole = whole.map(|[x, y]| format!(r#"<circle cx="{x}" cy="{y}" r="1.5"/>"#)).collect::<String>();
        let beside = (0..8).map(|k| format!(r#"<circle cx="{left}" cy="{}" r="3"/>"#, 5 + 9 * k));
        of(&(ground.to_owned() + &whole + &beside.collect::<String>())).arrangement.periodic
    };
    assert!(discs("", 3.0) && discs("", 2.9), "they stand beside the border");
    assert!(!discs("", 0.0), "the border cuts them");
    let gradient = r##"<linearGradient id="g"><stop stop-color="#fff"/><stop offset="1" stop-color="#789"/></linearGradient><rect width="100" height="80" fill="url(#g)"/>"##;
    assert!(!discs(gradient, 3.0), "the ground does not go on");
}

#[test]
fn a_tile_is_a_whole_number_of_periods() {
    let library = read(GARDEN).unwrap();
    let tile = Tile { x: true, y: false };
    let params =
        SynthParams { width: library.source.width + 10, height: 300, tile, ..SynthParams::default() };
    let error = synthesize(&library, &params, &()).unwrap_err().to_string();
    assert!(error.contains(&format!("{} x", library.source.width)), "{error}");
}

/// A swatch of 13.9 x 14.3 units with some elements.
fn small_swatch() -> Library {
    let inner = r##"<rect width="13.9" height="14.3" fill="#fff"/><circle cx="3" cy="3" r="1.2"/>
        <circle cx="9" cy="10" r=".8" fill="#c33"/><path d="M6 5h2v1h-2z"/>"##;
    let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 13.9 14.3">{inner}</svg>"#);
    read(text.as_bytes()).unwrap()
}

fn sized(library: &Library, size: CanvasSize, params: SynthParams) -> Scene {
    let mut params = params;
    size.set(&mut params, std::slice::from_ref(library), None);
    texture(library, params)
}

#[test]
fn a_small_drawing_is_shown_three_times_along_each_axis() {
    let library = small_swatch();
    let still = SynthParams { variation: Some(0.0), method: Method::Period, ..SynthParams::default() };
    let scene = sized(&library, CanvasSize::Auto, still.clone());
    // 41.7 x 42.9 units at 900 px.
    assert_eq!(([scene.width, scene.height], scene.picture_size(1.0)), ([42, 43], [875, 900]));
    assert_eq!(scene.count(), 9 * library.primaries().len());
    // On the page, periods are exact thirds.
    let places: Vec<[f64; 2]> =
        scene.instances().map(|i| [i.transform[4] / 42.0, i.transform[5] / 43.0]).collect();
    for [x, y] in &places {
        for wanted in [[x + 1.0 / 3.0, *y], [*x, y + 1.0 / 3.0]] {
            let found = places.iter().any(|p| (0..2).all(|k| (p[k] - wanted[k]).abs() < 1e-4));
            assert!(found || wanted.iter().any(|v| *v > 0.99), "{wanted:?}");
        }
    }
    // A tile has whole periods on any page.
    let both = Tile { x: true, y: true };
    let lengths = |text: [&str; 2]| CanvasSize::Page(text.map(|side| side.parse().unwrap()));
    for (page, most) in [(["300mm", "300mm"], 0.03), (["3m", "1m"], 0.03), (["10cm", "29.7cm"], 0.04)] {
        let tiled = SynthParams { tile: both, ..still.clone() };
        let scene = sized(&library, lengths(page), tiled);
        let [wide, high] = scene.css_size();
        let counts = [f64::from(scene.width) / 13.9, f64::from(scene.height) / 14.3];
        let whole = counts.map(f64::round);
        assert!((0..2).all(|k| (counts[k] - whole[k]).abs() < 0.05), "{page:?}: {counts:?}");
        let stretch = (whole[0] * 13.9 / wide) / (whole[1] * 14.3 / high);
        assert!((stretch - 1.0).abs() < most, "{page:?}: {whole:?}, {stretch}");
        assert_eq!(scene.count() as f64, whole[0] * whole[1] * library.primaries().len() as f64);
        assert_eq!(scene.page.map(|page| page.map(|side| side.to_string())), Some(page.map(str::to_owned)));
    }
}

#[test]
fn a_drawing_of_many_elements_is_repeated_less_unasked() {
    let dots: String = (0..1500)
        .map(|k| {
            format!(
                r#"<circle cx="{}" cy="{}" r=".4"/>"#,
                f64::from(k % 50) * 2.0 + 1.0,
                f64::from(k / 50) * 2.6 + 1.0
            )
        })
        .collect();
    let library = of(&dots);
    let mut params = SynthParams::default();
    CanvasSize::Auto.set(&mut params, std::slice::from_ref(&library), None);
    assert_eq!([params.width, params.height], [200, 160], "two by two pages");
    let explicit = CanvasSize::Pixels([500, 300]);
    explicit.set(&mut params, std::slice::from_ref(&library), None);
    assert_eq!(([params.width, params.height], params.page), ([500, 300], None));
}

#[test]
fn the_cost_of_a_texture_is_known_before() {
    let garden = read(GARDEN).unwrap();
    for (library, pages) in
        [(garden, 8.0), (small_swatch(), 30.0), (crate::support::library("terrazzo"), 3.0)]
    {
        let [w, h] = library.page().map(|side| (pages * side) as u32);
        let params = SynthParams { width: w, height: h, ..SynthParams::default() };
        let cost = Cost::of(std::slice::from_ref(&library), &params);
        let scene = texture(&library, params);
        let shapes: usize = scene.instances().map(|i| scene.element(i).shapes.len()).sum();
        let svg = svg::write(&scene, &SvgOptions::default(), std::io::sink()).unwrap().bytes;
        let pdf = pdf::write(&scene, std::io::sink()).unwrap();
        let found = [shapes as f64, svg as f64, pdf as f64];
        for (k, estimate) in [cost.shapes, cost.svg_bytes, cost.pdf_bytes].into_iter().enumerate() {
            let by = estimate / found[k];
            assert!((0.5..2.0).contains(&by), "{}: {k}: {estimate} for {}", library.source.file, found[k]);
        }
        assert!(!cost.is_heavy(&cost));
    }
}

#[test]
fn a_drawing_beside_a_photograph_has_its_part_to_itself() {
    let libraries = [crate::support::library("pebbles"), read(GARDEN).unwrap()];
    let left = vec![1.0, 1.0, 0.0, 0.0];
    let right = left.iter().map(|v| 1.0 - v).collect();
    let shares = [left, right].map(|values| ControlMap::new(4, 1, values).unwrap()).to_vec();
    let controls = Controls { shares, ..Controls::default() };
    let params = SynthParams { width: 1200, height: 600, seed: 4, ..SynthParams::default() };
    let (scene, report) = synthesize_with(&libraries, &params, &controls, &()).unwrap();
    let scene = Scene::from_bytes(scene.to_json(), "mixed").unwrap();
    let mut found = [0; 2];
    for instance in scene.individuals() {
        let element = scene.element(instance);
        let middle = instance.affine().transform_rect_bbox(element.bounds()).center();
        let part = usize::from(middle.x > 600.0);
        assert_eq!(element.library.index(), part, "{middle:?}");
        found[part] += 1;
    }
    // The drawing has as many elements as alone on a canvas of this size, and only its own background.
    let period = f64::from(libraries[1].source.width) * f64::from(libraries[1].source.height);
    let wanted = 12.0 * 600.0 * 600.0 / period;
    assert!(found[0] > 50 && (f64::from(found[1]) - wanted).abs() < 0.25 * wanted, "{found:?} {wanted}");
    let picture = png::render(&scene, 1.0).unwrap();
    let ground = libraries[1].background().fallback.0;
    let plain = (0..600).flat_map(|y| (620..1200).map(move |x| (x, y))).filter(|&(x, y)| {
        let p = picture.pixel(x, y).unwrap();
        [p.red(), p.green(), p.blue()] == ground
    });
    let [plain, empty] = [plain.count() as f64 / (580.0 * 600.0), 1.0 - libraries[1].coverage];
    assert!((plain - empty).abs() < 0.06, "{plain} {empty}");
    assert!((report.coverage - report.coverage_wanted).abs() < 0.1, "{report:?}");
}

#[test]
fn sizes_are_the_units_of_the_drawing() {
    let library = read(GARDEN).unwrap();
    assert_eq!((library.source.width, library.source.height), (480, 360));
    let params =
        SynthParams { width: 960, height: 360, tile: Tile { x: true, y: true }, ..SynthParams::default() };
    let scene = texture(&library, params);
    assert_eq!((scene.width, scene.height), (960, 360));
    // Two periods hold twice the area of one.
    let area = |scene: &Scene| {
        scene
            .instances()
            .map(|i| scene.element(i).outline().area() * i.affine().determinant().abs())
            .sum::<f64>()
    };
    let [one, two] = [area(&reconstruct(&library)), area(&scene)];
    assert!((two / one - 2.0).abs() < 0.02, "{one} {two}");
    // A small page, whose map has many pixels for each unit.
    let inner = r##"<rect width="20" height="16" fill="#eee"/><circle cx="6" cy="5" r="3" fill="#357"/><path
        d="M12 9h5v4h-5z" fill="#a33"/>"##;
    let small = String::from_utf8(svg(inner)).unwrap().replace("0 0 100 80", "0 0 20 16");
    let library = read(small.as_bytes()).unwrap();
    assert_eq!((library.source.width, library.source.height), (20, 16));
    assert!(library.source.scale[0] >= 10.0 && library.arrangement.width >= 200);
    let disc = library.primaries()[0].outline();
    assert!((disc.area() - 9.0 * std::f64::consts::PI).abs() < 0.1, "{}", disc.area());
    let scene = texture(&library, SynthParams { width: 60, height: 48, ..SynthParams::default() });
    assert!(scene.count() >= 9, "{}", scene.count());
    // The library is unchanged after writing and reading, and a tiny page is read as a larger one.
    assert_eq!(Library::from_bytes(library.to_json(), "again").unwrap(), library);
    let tiny = String::from_utf8(svg(r##"<circle cx=".5" cy=".4" r=".2"/>"##)).unwrap();
    let library = read(tiny.replace("0 0 100 80", "0 0 1 .8").as_bytes()).unwrap();
    assert_eq!((library.source.width, library.source.height), (100, 80));
    assert!(library.source.warnings[0].contains("read as one of 100 x 80"), "{:?}", library.source.warnings);
}

/// Asks to stop after a number of reports.
struct StopsAfter(std::sync::atomic::AtomicUsize);

impl vtex::Progress for StopsAfter {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        use std::sync::atomic::Ordering::SeqCst;
        self.0.fetch_update(SeqCst, SeqCst, |left| left.checked_sub(1)).is_ok()
    }
}

#[test]
fn the_import_of_a_drawing_stops_within_a_few_shapes() {
    use std::fmt::Write as _;
    let mut text = String::from(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 400">"#);
    for k in 0..300 {
        let _ = write!(text, r#"<path d="M{} {}h9v{}z"/>"#, k % 20 * 20, k / 20 * 20, 5 + k % 7);
    }
    text += "</svg>";
    let import = |reports: usize| {
        let progress = StopsAfter(reports.into());
        let made = import(text.as_bytes(), "many.svg", &ImportParams::default(), &progress);
        (made, reports - progress.0.into_inner())
    };
    let (made, all) = import(1_000_000);
    assert!(made.is_ok());
    // Import reports at least four times for each shape.
    assert!(all > 4 * 300, "{all}");
    for reports in (0..all).step_by(97) {
        assert!(matches!(import(reports).0, Err(vtex::Error::Interrupted)), "{reports} of {all}");
    }
}

#[test]
fn whole_motifs_keep_to_a_domain_along_a_field() {
    let library = read(GARDEN).unwrap();
    let path = parse_path("M40 40H560V460H40Z").unwrap();
    let controls = Controls { domain: Some(Outline::new(&path).unwrap()), ..Controls::default() };
    let [width, height] = [600, 500];
    for seed in 0..4 {
        let params = SynthParams {
            width,
            height,
            seed,
            method: Method::Correspondence,
            edge: Edge::Avoid,
            ..SynthParams::default()
        };
        let (scene, _) = synthesize_with(std::slice::from_ref(&library), &params, &controls, &()).unwrap();
        assert!(scene.count() > 5);
        for instance in scene.instances() {
            let b = scene.element(instance).outline().bounds_after(instance.affine());
            let inside = b.x0 > 38.0 && b.y0 > 38.0 && b.x1 < 562.0 && b.y1 < 462.0;
            assert!(inside, "{b:?}");
        }
    }
}

#[test]
fn cells_of_different_sizes_come_in_another_order() {
    let library = read(include_bytes!("../examples/drawings/mosaic.svg")).unwrap();
    let tile = Tile { x: true, y: true };
    let params = SynthParams { width: 320, height: 300, seed: 2, tile, ..SynthParams::default() };
    let of = |params: &SynthParams| {
        synthesize_with(std::slice::from_ref(&library), params, &Controls::default(), &()).unwrap()
    };
    let (scene, report) = of(&params);
    assert_eq!(report.method, Method::Curves);
    scene.check().unwrap();
    let off = report.coverage / report.coverage_wanted - 1.0;
    assert!(off.abs() < 0.05, "{} of {}", report.coverage, report.coverage_wanted);
    // Some are the drawing's own, others are made to fit.
    let made = scene.elements.iter().filter(|e| e.fused).count();
    assert!(made > 0 && made < scene.elements.len(), "{made} of {}", scene.elements.len());
    let (_, report) = of(&SynthParams { method: Method::Period, width: 300, ..params });
    assert_eq!(report.method, Method::Period);
}
