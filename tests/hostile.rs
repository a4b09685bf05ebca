//! Damaged and hostile files: every reader answers with a result or an error, and never panics;
//! what is accepted can be used.

use image::RgbImage;
use proptest::prelude::*;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::control;
use vtex::geometry::{Cage, Outline, PathText, Point, is_simple, parse_path, write_path};
use vtex::library::Library;
use vtex::output::raster_svg::render_svg;
use vtex::output::{pdf, png, svg};
use vtex::scene::{Scene, SynthParams};
use vtex::segment::{MasksFile, Regions, Segmenter, masks_to_bytes};
use vtex::synth::{reconstruct, synthesize};

/// Side of the photograph, in pixels.
const SIDE: u32 = 48;

/// Valid files, small enough to be damaged often.
struct Files {
    photo: Vec<u8>,
    masks: Vec<u8>,
    label_png: Vec<u8>,
    library: Vec<u8>,
    scene: Vec<u8>,
    svg: Vec<u8>,
}

static FILES: LazyLock<Files> = LazyLock::new(|| {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars/terrazzo.png");
    let crop = image::open(path).unwrap().crop_imm(200, 200, SIDE, SIDE);
    let mut photo = std::io::Cursor::new(Vec::new());
    crop.write_to(&mut photo, image::ImageFormat::Png).unwrap();
    let photo = photo.into_inner();
    let exemplar = Exemplar::from_bytes(&photo, "crop.png", &Limits::default()).unwrap();
    let found = Regions.segment(&exemplar.image, &()).unwrap();
    let masks = |name: &str| masks_to_bytes(name.as_ref(), "regions", SIDE, SIDE, &found, &[]).unwrap();
    let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &()).unwrap();
    assert!(!library.primaries().is_empty() && !library.secondaries().is_empty());
    let scene = small_scene(&library).unwrap();
    let mut text = Vec::new();
    svg::write(&scene, &svg::SvgOptions::default(), &mut text).unwrap();
    Files {
        photo,
        masks: masks("m.masks.json"),
        label_png: masks("m.png"),
        library: library.to_json(),
        scene: scene.to_json(),
        svg: text,
    }
});

fn small_scene(library: &Library) -> vtex::Result<Scene> {
    let params = SynthParams { width: 40, height: 30, ..SynthParams::default() };
    synthesize(library, &params, &())
}

fn use_library(bytes: &[u8]) {
    let Ok(library) = Library::from_bytes(bytes, "damaged") else { return };
    assert_eq!(Library::from_bytes(library.to_json(), "again").unwrap().to_json(), library.to_json());
    // A changed size may be very large; only small canvases are used.
    if u64::from(library.source.width) * u64::from(library.source.height) <= 1 << 16 {
        use_made(&reconstruct(&library));
        if let Ok(scene) = small_scene(&library) {
            use_made(&scene);
        }
    }
}

fn use_scene(bytes: &[u8]) {
    let Ok(scene) = Scene::from_bytes(bytes, "damaged") else { return };
    assert_eq!(Scene::from_bytes(scene.to_json(), "again").unwrap().to_json(), scene.to_json());
    use_made(&scene);
}

fn use_made(scene: &Scene) {
    if u64::from(scene.width) * u64::from(scene.height) <= 1 << 16 {
        let _ = svg::write(scene, &svg::SvgOptions::default(), std::io::sink());
        let _ = png::render(scene, 1.0);
        let _ = pdf::write(scene, std::io::sink());
    }
}

fn use_masks(bytes: &[u8]) {
    let Ok(file) = MasksFile::from_bytes(bytes.to_vec(), "damaged") else { return };
    let Ok(masks) = file.segment(&RgbImage::new(SIDE, SIDE), &()) else { return };
    for mask in masks {
        let (x0, y0, x1, y1) = mask.mask.bounds().unwrap();
        assert!(x0 >= 0 && y0 >= 0 && x1 <= SIDE as i32 && y1 <= SIDE as i32);
    }
}

fn use_photo(bytes: &[u8]) {
    let limits = Limits { side: 1024, memory: 64 << 20 };
    if let Ok(exemplar) = Exemplar::from_bytes(bytes, "damaged", &limits) {
        assert!(exemplar.image.width().min(exemplar.image.height()) >= Exemplar::SMALLEST_SIDE);
    }
}

/// A small SVG of one shape, with what a drawing program puts around it.
const SHAPE: &str = r#"<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="120px" height="90" viewBox="-5 0 240 180"><g transform="matrix(1 0.1 -0.1 1 3 4)"><path style="fill:#123;fill-rule:evenodd" d="M20,30c40-30 90,0 150 20v80l-90 30Q30 140 20 30zm60 20h30v30h-30z"/></g></svg>"#;

fn use_shape(bytes: &[u8]) {
    if let Ok(outline) = control::shape(bytes, "damaged", [100, 80]) {
        assert!(is_simple(outline.path()) && outline.area() >= 1.0);
    }
    if let Ok((after, _)) = control::cage(bytes, "damaged") {
        let (before, _) =
            control::cage(SHAPE.replace("zm60 20h30v30h-30z", "z").as_bytes(), "whole").unwrap();
        if let Ok(cage) = Cage::new(&before, &after) {
            let moved = cage.map(Point::new(40.0, 50.0));
            assert!(moved.x.is_finite() && moved.y.is_finite());
        }
    }
}

fn use_picture(bytes: &[u8]) {
    if let Ok(outline) = control::mask(bytes, "damaged", [100, 80]) {
        assert!(outline.area() >= 1.0);
    }
    let inside = |v: f64, most: f64| assert!((0.0..=most).contains(&v), "{v}");
    if let Ok(map) = control::density(bytes, "damaged") {
        inside(map.at([3.0, 4.0], [9.0, 9.0]), 2.0);
    }
    for libraries in 2..4 {
        for map in control::shares(&[("damaged", bytes)], libraries).unwrap_or_default() {
            inside(map.at([3.0, 4.0], [9.0, 9.0]), 1.0);
        }
    }
}

/// A change of bytes: its place, as a share of the length, and its kind.
#[derive(Clone, Debug)]
enum Damage {
    Set(f64, u8),
    Remove(f64, usize),
    Repeat(f64, usize),
    Cut(f64),
}

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    let place = || 0.0..1.0f64;
    let one = prop_oneof![
        4 => (place(), any::<u8>()).prop_map(|(at, byte)| Damage::Set(at, byte)),
        4 => (place(), prop::sample::select(b"0123456789-.,[]{}\"eEnl#McZ<>/=".to_vec()))
            .prop_map(|(at, byte)| Damage::Set(at, byte)),
        2 => (place(), 1..40usize).prop_map(|(at, n)| Damage::Remove(at, n)),
        2 => (place(), 1..40usize).prop_map(|(at, n)| Damage::Repeat(at, n)),
        1 => place().prop_map(Damage::Cut),
    ];
    prop::collection::vec(one, 1..5)
}

fn damaged(bytes: &[u8], list: &[Damage]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for one in list {
        let place = |share: &f64| (share * bytes.len() as f64) as usize;
        match one {
            Damage::Set(at, byte) => {
                let at = place(at);
                bytes.get_mut(at..).into_iter().flatten().take(1).for_each(|b| *b = *byte);
            }
            Damage::Remove(at, n) => drop(bytes.drain(place(at)..(place(at) + n).min(bytes.len()))),
            Damage::Repeat(at, n) => {
                let (from, to) = (place(at), (place(at) + n).min(bytes.len()));
                let copy = bytes[from..to].to_vec();
                bytes.splice(from..from, copy);
            }
            Damage::Cut(at) => bytes.truncate(place(at)),
        }
    }
    bytes
}

/// Replacements for the values of a document.
fn replacement() -> impl Strategy<Value = Value> {
    let numbers = [0.0, -1.0, 0.5, 1e-300, 1e300, -1e18, 255.0, 256.0, 65536.0, 4294967295.0, 4294967296.0];
    prop_oneof![
        prop::sample::select(numbers.to_vec()).prop_map(|v| serde_json::json!(v)),
        prop::sample::select(vec![0i64, 1, 2, 7, -1, 47, 48, 49, 65535, 100_000, i64::MAX])
            .prop_map(|v| serde_json::json!(v)),
        prop::sample::select(vec!["", "#ffffff", "M0,0", "M0 0h1v1z", "M0 0h1e9v1z", "NaN", "\u{0}<&\"'"])
            .prop_map(|v| serde_json::json!(v)),
        prop::sample::select(vec!["null", "true", "[]", "{}", "[0,1]", "[1e9,-1e9]", "[1,0,0,0,0,0]"])
            .prop_map(|v| serde_json::from_str(v).unwrap()),
    ]
}

/// Places of all values in a document, as JSON pointers.
fn places(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(k, v)| places(v, &format!("{at}/{k}"), found)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| places(v, &format!("{at}/{i}"), found));
        }
        _ => {}
    }
    found.push(at.to_owned());
}

/// The document with some values replaced. Places are drawn level by level, so that single fields
/// are met as often as the entries of long lists.
fn replaced(bytes: &[u8], changes: &[(Vec<f64>, Value)]) -> Vec<u8> {
    let mut document: Value = serde_json::from_slice(bytes).unwrap();
    for (turns, value) in changes {
        let (mut here, mut at) = (&document, String::new());
        for turn in turns {
            let pick = |n: usize| ((turn * n as f64) as usize).min(n.saturating_sub(1));
            let next = match here {
                Value::Object(fields) => fields.iter().nth(pick(fields.len())).map(|(k, v)| (k.clone(), v)),
                Value::Array(items) => {
                    items.get(pick(items.len())).map(|v| (pick(items.len()).to_string(), v))
                }
                _ => None,
            };
            let Some((key, inner)) = next else { break };
            at += &format!("/{key}");
            here = inner;
        }
        *document.pointer_mut(&at).unwrap() = value.clone();
    }
    serde_json::to_vec(&document).unwrap()
}

fn changes() -> impl Strategy<Value = Vec<(Vec<f64>, Value)>> {
    prop::collection::vec((prop::collection::vec(0.0..1.0f64, 1..6), replacement()), 1..3)
}

proptest! {
    // The cases differ in each run; fuzz targets run millions.
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_bytes_are_survived(list in damage()) {
        let files = &*FILES;
        use_library(&damaged(&files.library, &list));
        use_scene(&damaged(&files.scene, &list));
        use_masks(&damaged(&files.masks, &list));
        use_masks(&damaged(&files.label_png, &list));
        use_photo(&damaged(&files.photo, &list));
        use_picture(&damaged(&files.label_png, &list));
        use_shape(&damaged(SHAPE.as_bytes(), &list));
    }

    #[test]
    fn replaced_values_are_survived(list in changes()) {
        let files = &*FILES;
        use_library(&replaced(&files.library, &list));
        use_scene(&replaced(&files.scene, &list));
        use_masks(&replaced(&files.masks, &list));
    }

    #[test]
    fn random_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..200), text in "M ?[0-9]{1,3}[ ,][0-9]{1,3}[MmLlHhVvCcZzQA0-9eE+., -]{0,60}") {
        use_library(&bytes);
        use_scene(&bytes);
        use_masks(&bytes);
        use_photo(&bytes);
        use_picture(&bytes);
        use_shape(&bytes);
        let _ = render_svg(&bytes, 1.0, "random", &());
        if let Some(outline) = parse_path(&text).ok().and_then(|path| Outline::new(&path)) {
            let written = write_path(outline.path(), PathText { precision: 2 });
            prop_assert_eq!(Outline::new(&parse_path(&written).unwrap()), Some(outline), "{}", written);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 25, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_svg_is_survived(list in damage()) {
        let _ = render_svg(&damaged(&FILES.svg, &list), 1.0, "damaged", &());
    }
}

#[test]
fn every_field_of_a_document_is_checked_or_harmless() {
    // Each single field, by the values most likely to do harm.
    let hostile = ["-1", "0", "1e300", "4294967295", "65535", "null", "[]", "\"\"", "\"M0 0h1e6v1z\""];
    for (bytes, read) in [(&FILES.library, use_library as fn(&[u8])), (&FILES.scene, use_scene)] {
        let document: Value = serde_json::from_slice(bytes).unwrap();
        let mut all = Vec::new();
        places(&document, "", &mut all);
        // Each field once, whichever entries of lists it belongs to, and the first two entries of lists.
        let mut seen = BTreeSet::new();
        all.retain(|at| {
            let (within, last) = at.rsplit_once('/').unwrap_or_default();
            let within: Vec<&str> = within.split('/').filter(|part| part.parse::<u32>().is_err()).collect();
            !last.parse::<u32>().is_ok_and(|i| i >= 2) && seen.insert((within.join("/"), last.to_owned()))
        });
        assert!(all.len() > 30);
        for at in all {
            for value in hostile {
                let mut wrong = document.clone();
                *wrong.pointer_mut(&at).unwrap() = serde_json::from_str(value).unwrap();
                read(&serde_json::to_vec(&wrong).unwrap());
            }
        }
    }
}

#[test]
fn pictures_that_unpack_to_too_much_are_refused() {
    // A PNG of a few bytes whose header states 65535 × 65535 pixels.
    let mut bomb = Vec::new();
    let encoder = ::png::Encoder::new(&mut bomb, 65_535, 65_535);
    let mut writer = encoder.write_header().unwrap();
    writer.write_chunk(::png::chunk::IDAT, &[0; 9]).unwrap();
    drop(writer);
    let refused = |error: vtex::Error| assert!(matches!(error, vtex::Error::TooLarge { .. }), "{error}");
    refused(control::density(&bomb, "bomb.png").unwrap_err());
    refused(control::mask(&bomb, "bomb.png", [10, 10]).unwrap_err());
    refused(control::shares(&[("bomb.png", &bomb)], 2).unwrap_err());
}
