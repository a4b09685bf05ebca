//! Drawings and libraries of drawings that are very large, or odd. Steps that compare all shapes with all would
//! make these tests take hours.

use std::fmt::Write as _;
use vtex::geometry::Affine;
use vtex::import::{Grouping, ImportParams, import};
use vtex::library::{AnalyzeParams, ExemplarElement, Library};
use vtex::scene::{Method, SynthParams, Tile};
use vtex::synth::synthesize;
use vtex::{Error, Result};

const GARDEN: &[u8] = include_bytes!("../examples/drawings/garden.svg");

fn svg(inner: &str) -> Vec<u8> {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 100 80">{inner}</svg>"#)
        .into_bytes()
}

fn read_as(inner: &str, wrap: Option<bool>, analyze: AnalyzeParams) -> Result<Library> {
    import(&svg(inner), "drawing.svg", &ImportParams { wrap, analyze }, &())
}

fn read(inner: &str) -> Result<Library> {
    read_as(inner, None, AnalyzeParams::default())
}

fn lenient(inner: &str) -> Library {
    read_as(inner, None, AnalyzeParams { lenient: true, ..AnalyzeParams::default() }).unwrap()
}

/// `count` numbered texts, one after the other.
fn many(count: usize, text: impl Fn(usize) -> String) -> String {
    (0..count).fold(String::new(), |mut all, k| {
        let _ = write!(all, "{}", text(k));
        all
    })
}

#[test]
fn thin_strokes_across_the_border_are_read_in_time() {
    let line = |k: usize| {
        let y = 1.0 + k as f64 * 78.0 / 12_000.0;
        format!(r##"<path d="M-3 {y:.4}L60 {:.4}" stroke="#123" stroke-width=".004"/>"##, y + 0.3)
    };
    let inner = many(12_000, line);
    let library = (read_as(&inner, Some(true), AnalyzeParams::default())).unwrap();
    assert!(!library.primaries().is_empty());
}

#[test]
fn a_stroke_wider_than_the_page_is_read_and_a_far_wider_one_refused() {
    let stroke = |width: &str| {
        format!(r#"<path d="M-5 40H105" stroke="red" stroke-width="{width}"/><circle cx="9" cy="9" r="4"/>"#)
    };
    let library = read_as(&stroke("1e3"), Some(true), AnalyzeParams::default()).unwrap();
    assert!(library.primaries().len() <= 2);
    let refused = read(&stroke("1e8")).unwrap_err().to_string();
    assert!(refused.contains("further than a hundred pages"), "{refused}");
    assert_eq!(lenient(&stroke("1e8")).primaries().len(), 1);
}

#[test]
fn lines_without_length_are_the_dots_that_their_caps_paint() {
    let dots = [
        r#"<path d="M10 10h0"/>"#,
        r#"<path d="M30 10L30 10"/>"#,
        r#"<line x1="50" y1="10" x2="50" y2="10"/>"#,
        r#"<path d="M70 10z"/>"#,
        r#"<path d="M90 10h.001"/>"#,
        r#"<polyline points="10 30 10 30"/>"#,
        r#"<path d="M30 30c0 0 0 0 0 0"/>"#,
        r#"<path d="M50 30h0M70 30v0"/>"#,
        r#"<g transform="scale(1 -1)"><path d="M90-30h0"/></g>"#,
    ];
    let with = |cap: &str, inner: &str| {
        format!(r##"<g fill="none" stroke="#c33" stroke-width="6" stroke-linecap="{cap}">{inner}</g>"##)
    };
    let areas = |library: &Library| -> Vec<f64> {
        let scale = f64::from(library.source.width) / 100.0;
        library.primaries().iter().map(|e| e.base().outline.area() / scale / scale).collect()
    };
    for (cap, area) in [("round", std::f64::consts::PI * 9.0), ("square", 36.0)] {
        let found = areas(&read(&with(cap, &dots.concat())).unwrap());
        assert_eq!(found.len(), 10, "{cap}");
        assert!(found.iter().all(|a| (a - area).abs() < 0.02 * area), "{cap}: {found:?}");
        // Lines beside dots stay lines; dashes without length are dots too.
        let mixed = read(&with(cap, r#"<path d="M10 20h0M20 60h30"/>"#)).unwrap();
        let lines = mixed.primaries().iter().filter(|e| e.base().line.is_some()).count();
        assert_eq!((mixed.primaries().len(), lines), (2, 1), "{cap}");
        let dotted = read(&with(cap, r#"<path d="M10 40h80" stroke-dasharray="0 10"/>"#)).unwrap();
        let found = areas(&dotted)[0];
        assert!((8.0..9.5).contains(&(found / area)), "{cap}: {found}");
    }
    assert!(read(&with("butt", &dots.concat())).unwrap().primaries().is_empty());
    // A stretched dot is an ellipse.
    let stretched = read(&with("round", r#"<path transform="scale(2 1)" d="M20 30h0"/>"#)).unwrap();
    assert!((areas(&stretched)[0] - std::f64::consts::PI * 18.0).abs() < 1.0);
}

#[test]
fn shapes_as_large_as_the_page_are_read_in_time_or_refused() {
    let shapes = |opacity: &str| {
        many(100_000, |k| format!(r##"<path d="M0 0h100v80H0z" fill="#{:06x}"{opacity}/>"##, k % 0xff_ffff))
    };
    let library = (read(&shapes(""))).unwrap();
    assert_eq!((library.primaries().len(), library.background().fallback.0), (0, [0x01, 0x86, 0x9f]));
    let error = (read(&shapes(r#" opacity=".5""#))).unwrap_err();
    assert!(matches!(&error, Error::TooLarge { found, .. } if found.contains("100000 times")), "{error}");
}

#[test]
fn layers_of_one_name_are_read_in_time() {
    let inkscape =
        r#"xmlns:i="http://www.inkscape.org/namespaces/inkscape" i:groupmode="layer" i:label="Layer""#;
    let layer = |k: usize| {
        let (x, y) = (1 + k % 97, 1 + k / 97 % 77);
        format!(r#"<g id="g{k}" {inkscape}><rect x="{x}" y="{y}" width=".5" height=".5"/></g>"#)
    };
    let layers = many(5_000, layer);
    let library = (read(&layers)).unwrap();
    assert_eq!(library.layers.len(), 5_001);
    assert_eq!((&*library.layers[1].name, &*library.layers[5_000].name), ("Layer", "Layer 5000"));
}

#[test]
fn paths_become_elements_in_time() {
    let path = |k: usize| {
        let (x, y) = (k % 300, k / 300);
        format!(
            "<path d='M{:.3} {:.3}h.1v.1z'/>",
            1.0 + f64::from(x as u32) * 0.32,
            1.0 + f64::from(y as u32) * 0.25
        )
    };
    let analyze = AnalyzeParams { elements: Grouping::Path, ..AnalyzeParams::default() };
    let library = (read_as(&many(90_000, path), Some(false), analyze)).unwrap();
    assert_eq!(library.primaries().len(), 90_000);
}

#[test]
fn pictures_count_where_they_are_shown() {
    let circle = r#"<circle cx="50" cy="40" r="9"/>"#;
    let image = r#"<image id="photo" width="9" height="9" xlink:href="data:image/png;base64,AAAA"/>"#;
    let slice = image.replace("width", r#"preserveAspectRatio="xMidYMid slice" width"#);
    for unused in [
        format!("<defs>{image}</defs>{circle}"),
        format!("<symbol id='s'>{image}</symbol>{circle}"),
        format!("<g display='none'>{image}</g>{circle}"),
    ] {
        assert_eq!(read(&unused).unwrap().primaries().len(), 1, "{unused}");
    }
    for shown in [
        format!("{image}{circle}"),
        format!("{slice}{circle}"),
        format!("{}{circle}", image.replace("data:image/png;base64,AAAA", "other.svg")),
        format!("<defs>{image}</defs><use xlink:href='#photo'/>{circle}"),
    ] {
        let error = read(&shown).map(|l| l.primaries().len()).unwrap_err().to_string();
        assert!(error.contains("raster image"), "{error}");
        assert_eq!(lenient(&shown).primaries().len(), 1);
    }
    let named = read(&format!("{image}{circle}")).unwrap_err().to_string();
    assert!(named.contains("'photo'"), "{named}");
}

#[test]
fn what_is_left_out_is_not_looked_at() {
    // The borders join because the blurred bar at one border is left out.
    let discs = many(12, |k| {
        format!(r##"<circle cx="{}" cy="{}" r="5" fill="#b42"/>"##, 14 + k % 4 * 24, 15 + k / 4 * 25)
    });
    let filter = r#"<filter id="f"><feGaussianBlur stdDeviation="1"/></filter>"#;
    let bar = r##"<path d="M0 2h12v76H0z" fill="#05a" filter="url(#f)"/>"##;
    let page = r##"<rect width="100" height="80" fill="#eee"/>"##;
    let whole = read(&format!("{page}{discs}")).unwrap();
    let lacking = lenient(&format!("{page}{filter}{bar}{discs}"));
    assert!(whole.arrangement.periodic && lacking.arrangement.periodic);
    let guides = [&whole, &lacking].map(|l| l.guide.as_ref().unwrap().picture.0.clone());
    assert_eq!(guides[0].dimensions(), guides[1].dimensions());
    let off = guides[0].pixels().zip(guides[1].pixels());
    let off: f64 = off.map(|(a, b)| (0..3).map(|k| f64::from(a.0[k].abs_diff(b.0[k]))).sum::<f64>()).sum();
    let mean = off / f64::from(3 * guides[0].width() * guides[0].height());
    assert!(mean < 1.0, "{mean}");
}

#[test]
fn shapes_that_always_come_together_are_one_element() {
    // All mushrooms stand on one line that touches them.
    let mushroom = |x: usize| {
        format!(
            r##"<path d="M{x} 50v10h4v-10z" fill="#ddd"/><path d="M{} 50c0-8 12-8 12 0z" fill="#b33"/>"##,
            x - 4
        )
    };
    let all: String = [12, 31, 55, 78].map(mushroom).concat();
    let line = r##"<path d="M2 60h96v3h-96z" fill="#363"/>"##;
    let count = |inner: &str| {
        let library = read_as(inner, Some(false), AnalyzeParams::default()).unwrap();
        let mut shapes: Vec<usize> = library.primaries().iter().map(|e| e.shapes.len()).collect();
        shapes.sort_unstable();
        shapes
    };
    assert_eq!(count(&format!("{line}{all}")), [1, 2, 2, 2, 2]);
    // Caps at differing relative places remain separate elements.
    let loose: String = [(12, 0), (31, 1), (55, 2), (78, 3)]
        .map(|(x, off)| mushroom(x).replace(&format!("M{} 50c", x - 4), &format!("M{} 50c", x - 4 + off)))
        .concat();
    assert_eq!(count(&format!("{line}{loose}")).len(), 9);
}

#[test]
fn texts_that_are_left_out_are_named() {
    let library = read("<text x='5' y='20'>two  words</text><text/><circle cx='50' cy='40' r='9'/>").unwrap();
    assert_eq!(library.source.warnings, ["the text 'two words' and 1 more is left out: turn it into a path"]);
}

#[test]
fn instances_keep_the_transform_that_their_library_gives() {
    let params = ImportParams::default();
    let mut library = import(GARDEN, "garden.svg", &params, &()).unwrap();
    // Elements squeezed along one axis, which import never makes, are valid.
    for layer in &mut library.layers {
        layer.instances.iter_mut().for_each(|i| i.transform = [1.0, 0.0, 0.0, 0.5, 0.0, 0.0]);
    }
    let library = Library::from_bytes(library.to_json(), "squeezed").unwrap();
    let [width, height] = [library.source.width * 2, library.source.height * 2];
    let sizes = |variation: f64| {
        let tile = Tile { x: true, y: true };
        let (method, variation) = (Method::Period, Some(variation));
        let params = SynthParams { width, height, method, tile, variation, ..SynthParams::default() };
        let scene = synthesize(&library, &params, &()).unwrap();
        let size = |[a, b, c, d, ..]: [f64; 6]| (1000.0 * (a * d - b * c).abs()).round() as i64;
        let mut sizes: Vec<i64> = scene.instances().map(|i| size(i.transform)).collect();
        sizes.sort_unstable();
        sizes
    };
    assert_eq!(sizes(0.0), sizes(1.0), "places are changed, sizes are not");
}

#[test]
fn turned_uses_of_a_symbol_are_where_they_are_drawn() {
    let symbol = "<symbol id='s' overflow='visible'><path d='M0 0h30v20h-30z' fill='#123456'/></symbol>";
    let turns = ["translate(30 10) rotate(90)", "matrix(.6 .8 -.8 .6 60 10)", "translate(10 50) scale(.7)"];
    let of = |shown: &dyn Fn(&str) -> String| {
        let inner: String = turns.iter().map(|turn| shown(turn)).collect();
        let library = read_as(&format!("{symbol}{inner}"), Some(false), AnalyzeParams::default()).unwrap();
        let placed = |e: &ExemplarElement| e.shapes[0].outline.bounds();
        library.primaries().iter().map(placed).collect::<Vec<_>>()
    };
    let used = of(&|turn| format!("<use href='#s' transform='{turn}'/>"));
    let drawn = of(&|turn| format!("<path d='M0 0h30v20h-30z' fill='#123456' transform='{turn}'/>"));
    assert_eq!(used.len(), turns.len());
    for (a, b) in used.iter().zip(&drawn) {
        assert!((a.center() - b.center()).hypot() < 0.01 && (a.area() - b.area()).abs() < 0.1, "{a:?} {b:?}");
    }
}

#[test]
fn stubs_that_lines_cover_are_not_read() {
    let line = |d: &str| format!(r##"<path d="{d}" fill="none" stroke="#000" stroke-width=".6"/>"##);
    let lines = many(6, |k| line(&format!("M{0} 10h9v8", 12 * k + 5)));
    let count = |inner: &str| read(inner).unwrap().primaries().len();
    // Within a line, on its end, and across it.
    let covered = line("M8 10h.05") + &line("M13.98 10h.05") + &line("M20 9.98v.05");
    assert_eq!(count(&(lines.clone() + &covered)), 6);
    // In the open, of another colour, and with round caps: a dot.
    let apart = line("M50 60h.05");
    let red = apart.replace("#000", "#f00").replace("50 60", "8 10");
    let dot = apart.replace("/>", r#" stroke-linecap="round"/>"#);
    assert_eq!(count(&(lines.clone() + &apart)), 7);
    assert!(count(&(lines.clone() + &red)) > 6 && count(&(lines + &dot)) == 7);
}

#[test]
fn strict_rows_stay_by_default() {
    let rows = many(21, |k| {
        let (x, y) = (k % 7 * 14 + k / 7 * 5 % 11, 10 + k / 7 * 26);
        format!(r##"<path d="M{} {y}h{}v1h-8z" fill="#234"/>"##, x as f64 + 1.3 * (k * k % 3) as f64, 8)
    });
    let library = read_as(&rows, Some(true), AnalyzeParams::default()).unwrap();
    let (width, height, method) = (300, 240, Method::Period);
    let params = SynthParams { width, height, method, seed: 4, ..SynthParams::default() };
    let ys = |params: &SynthParams| {
        let scene = synthesize(&library, params, &()).unwrap();
        let middle = |i: &vtex::scene::Instance| {
            (Affine::new(i.transform) * scene.element(i).shapes[0].outline.bounds().center()).y
        };
        let middles = scene.instances().map(|i| middle(i).rem_euclid(80.0));
        middles.map(|y| libm::round(y * 2.0) as i64).collect::<std::collections::BTreeSet<i64>>()
    };
    assert!(ys(&params).len() <= 3, "{:?}", ys(&params));
    assert!(ys(&SynthParams { variation: Some(1.0), ..params }).len() > 3);
}
