//! The whole path, photograph to files, on small crops of the exemplars.

use image::RgbImage;
use std::path::{Path, PathBuf};
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::output::{coverage, png, svg};
use vtex::scene::{Role, Scene, SynthParams};
use vtex::segment::Regions;
use vtex::synth::{reconstruct, synthesize};
use vtex::{Error, Result};

/// Side of the crops, in pixels.
const SIDE: u32 = 160;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars")
}

fn encode(image: &RgbImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn load(image: &RgbImage, name: &str) -> Result<Exemplar> {
    Exemplar::from_bytes(&encode(image), name, &Limits::default())
}

/// The middle of an image.
fn crop(path: &Path) -> RgbImage {
    let whole = image::open(path).unwrap().into_rgb8();
    let (x, y) = ((whole.width() - SIDE) / 2, (whole.height() - SIDE) / 2);
    image::imageops::crop_imm(&whole, x, y, SIDE, SIDE).to_image()
}

fn exemplar(name: &str) -> Exemplar {
    load(&crop(&folder().join(format!("{name}.png"))), name).unwrap()
}

fn library(exemplar: &Exemplar) -> Library {
    analyze(exemplar, &Regions, &AnalyzeParams::default(), &()).unwrap()
}

fn scene(library: &Library) -> Scene {
    let params = SynthParams { width: 240, height: 200, seed: 3, ..SynthParams::default() };
    synthesize(library, &params, &()).unwrap()
}

fn svg_of(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    svg::write(scene, &svg::SvgOptions::default(), &mut bytes).unwrap();
    bytes
}

fn png_of(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    png::encode(&png::render(scene, 1.0).unwrap(), Some(3), None, &mut bytes).unwrap();
    bytes
}

/// All files that the stages write for one exemplar.
fn all_files(name: &str) -> [Vec<u8>; 4] {
    let library = library(&exemplar(name));
    let scene = scene(&library);
    [library.to_json(), scene.to_json(), svg_of(&scene), png_of(&scene)]
}

/// Peak signal-to-noise ratio in dB, over the sRGB components.
fn psnr(image: &RgbImage, rgba: &[u8]) -> f64 {
    let mut sum = 0.0;
    for (a, b) in image.pixels().zip(rgba.chunks_exact(4)) {
        for c in 0..3 {
            let difference = f64::from(a.0[c]) - f64::from(b[c]);
            sum += difference * difference;
        }
    }
    10.0 * libm::log10(255.0 * 255.0 * f64::from(3 * image.width() * image.height()) / sum)
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| all_files("pebbles"))
    };
    let one = with(1);
    for threads in [2, 4] {
        assert!(with(threads) == one, "{threads} threads");
    }
}

#[test]
fn libraries_and_scenes_survive_being_saved() {
    let library = library(&exemplar("leaves"));
    let saved = library.to_json();
    let read = Library::from_bytes(&saved, "saved").unwrap();
    assert!(read == library && read.to_json() == saved);

    let scene = scene(&library);
    let replayed = self::scene(&read);
    assert!(replayed.to_json() == scene.to_json(), "a saved library gives another scene");
    let read = Scene::from_bytes(scene.to_json(), "saved").unwrap();
    assert!(read == scene && read.to_json() == scene.to_json());
    assert!(svg_of(&read) == svg_of(&scene), "a saved scene gives another SVG");
    assert!(png_of(&read) == png_of(&scene), "a saved scene gives another picture");
}

#[test]
fn another_seed_gives_another_texture() {
    let library = library(&exemplar("terrazzo"));
    let with = |seed| {
        let params = SynthParams { width: 200, height: 200, seed, ..SynthParams::default() };
        synthesize(&library, &params, &()).unwrap().layers
    };
    assert_ne!(with(1), with(2));
}

/// The reconstruction resembles the photograph: it has the same size, the same primaries and coverage, and
/// colours much nearer to it than its mean colour.
fn check_reconstruction(image: &RgbImage, library: &Library, name: &str) {
    let scene = reconstruct(library);
    assert_eq!((scene.width, scene.height), image.dimensions(), "{name}");
    assert_eq!(scene.of_role(Role::Primary).count(), library.primaries().len(), "{name}");
    assert_eq!(scene.of_role(Role::Secondary).count(), library.secondaries().len(), "{name}");
    let covered: u64 = coverage(&scene).values().sum();
    let share = covered as f64 / f64::from(image.width() * image.height());
    assert!((share - library.coverage).abs() < 0.02, "{name}: {share:.3}, not {:.3}", library.coverage);

    let drawn = png::render(&scene, 1.0).unwrap();
    let pixels = f64::from(image.width() * image.height());
    let mut mean = [0.0; 3];
    image.pixels().for_each(|p| (0..3).for_each(|c| mean[c] += f64::from(p.0[c]) / pixels));
    let [r, g, b] = mean.map(|v| v as u8);
    let flat = [r, g, b, 255].repeat(image.width() as usize * image.height() as usize);
    let (got, least) = (psnr(image, drawn.data()), psnr(image, &flat) + 3.0);
    assert!(got > least, "{name}: {got:.1} dB, at least {least:.1} are expected");
}

#[test]
fn reconstructions_show_the_exemplars() {
    for name in ["concrete", "flowers", "leaves", "pebbles", "terrazzo"] {
        let exemplar = exemplar(name);
        check_reconstruction(&exemplar.image, &library(&exemplar), name);
    }
}

#[test]
fn photographs_pass_the_whole_path() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/exemplars");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: there is no folder {}", folder.display());
        return;
    };
    let mut paths: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "jpg" || e == "png"));
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let image = crop(&path);
        let library = library(&load(&image, &name).unwrap());
        check_reconstruction(&image, &library, &name);
        let scene = scene(&library);
        assert!(!scene.layers[0].field.as_ref().unwrap().points.is_empty(), "{name}");
        let text = String::from_utf8(svg_of(&scene)).unwrap();
        roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(!text.contains("<image"), "{name}");
    }
}

/// A smooth slope with fine noise: nothing in it is an element.
fn slope() -> RgbImage {
    RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let noise = (x.wrapping_mul(2_654_435_761).wrapping_add(y.wrapping_mul(40_503 * 65_537)) >> 13) % 5;
        image::Rgb([60 + x / 2 + noise, 90 + y / 3 + noise, 110 + noise].map(|v| v as u8))
    })
}

#[test]
fn a_photograph_without_textons_still_gives_its_ground() {
    let library = library(&load(&slope(), "slope").unwrap());
    assert!(!library.source.warnings.is_empty(), "no warning, {} primaries", library.primaries().len());
    assert!(library.coverage < 0.1, "{} of a slope are primaries", library.coverage);
    assert!(library.coverage.is_sign_positive(), "written as -0.0");
    assert!(!library.background().points.is_empty());
    let scene = scene(&library);
    let drawn = png::render(&scene, 1.0).unwrap();
    // Colours lie within the range of the gradient.
    let inside =
        |c: usize, low: u8, high: u8| drawn.data().chunks_exact(4).all(|p| (low..=high).contains(&p[c]));
    assert!(inside(0, 50, 160) && inside(1, 80, 160) && inside(2, 100, 125));
}

#[test]
fn an_image_of_one_colour_is_refused_with_a_reason() {
    let flat = RgbImage::from_pixel(64, 64, image::Rgb([10, 20, 30]));
    let error = load(&flat, "flat.png").unwrap_err();
    assert!(matches!(error, Error::Unusable { .. }), "{error}");
    assert!(error.to_string().contains("#0a141e") && error.hint().is_some(), "{error}");
}
