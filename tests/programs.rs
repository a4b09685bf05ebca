//! The programs that people open an SVG in draw what vtex draws.
//!
//! Each installed program draws each kind of file, and its picture is compared with that of vtex. Programs
//! that are not installed are skipped with a note. The test is run by hand, because it starts other programs:
//! `cargo test --test all programs:: -- --ignored --nocapture` prints the table of
//! `docs/measurements/vectors.md`.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use tiny_skia::Pixmap;
use vtex::geometry::{Affine, Outline};
use vtex::import::{ImportParams, import};
use vtex::interpolate::Interpolation;
use vtex::output::svg::{self, Animation, SvgOptions};
use vtex::output::{png, raster_svg};
use vtex::raster::colour::Colour;
use vtex::scene::{Domain, Edge, Scene, Shadow, Stroke, SynthParams, Tile};
use vtex::synth::synthesize;

/// Largest mean difference, in 8-bit steps.
const MOST: f64 = 1.0;
/// Largest mean difference of a scene with many shadows: browsers round each of their layers down to whole
/// steps.
const MOST_OF_SHADOWS: f64 = 1.5;
/// Largest mean difference of a drawing of hairlines only, whose original differs as much between programs.
const MOST_OF_HAIRLINES: f64 = 2.2;

/// A program that draws an SVG to a PNG.
#[derive(Clone, Copy)]
enum Program {
    Inkscape,
    Chromium,
    Firefox,
    Librsvg,
}

impl Program {
    const ALL: [Self; 4] = [Self::Inkscape, Self::Chromium, Self::Firefox, Self::Librsvg];

    fn name(self) -> &'static str {
        match self {
            Self::Inkscape => "inkscape",
            Self::Chromium => "chromium",
            Self::Firefox => "firefox",
            Self::Librsvg => "rsvg-convert",
        }
    }

    /// Its path, found on the search path.
    fn find(self) -> Option<PathBuf> {
        let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
        folders.iter().map(|folder| folder.join(self.name())).find(|file| file.is_file())
    }

    /// The picture of a file of the given size, in pixels.
    fn draw(self, program: &Path, file: &Path, [width, height]: [u32; 2]) -> Rgb {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("picture.png");
        let profile = folder.path().join("profile");
        std::fs::create_dir(&profile).unwrap();
        let mut command = Command::new(program);
        command.env("HOME", folder.path()).stdin(Stdio::null());
        let page = format!("file://{}", file.display());
        match self {
            Self::Inkscape => command
                .arg("--export-type=png")
                .arg(format!("--export-filename={}", picture.display()))
                .arg(file),
            Self::Chromium => command
                .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
                .args(["--force-color-profile=srgb", "--disable-background-networking", "--disable-sync"])
                .arg(format!("--window-size={width},{height}"))
                .arg(format!("--user-data-dir={}", profile.display()))
                .arg(format!("--screenshot={}", picture.display()))
                .arg(page),
            Self::Firefox => command
                .args(["--headless", "--no-remote", "--profile"])
                .arg(&profile)
                .arg("--screenshot")
                .arg(&picture)
                .arg(format!("--window-size={width},{height}"))
                .arg(page),
            Self::Librsvg => command.arg(file).arg("-o").arg(&picture),
        };
        let output = command.output().unwrap();
        let drawn = image::open(&picture);
        let drawn = drawn.unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&output.stderr)));
        let drawn = drawn.into_rgba8();
        assert_eq!([drawn.width(), drawn.height()], [width, height], "{}", self.name());
        let white = |v: u8, a: u8| ((u32::from(v) * u32::from(a) + 255 * (255 - u32::from(a))) / 255) as u8;
        drawn.pixels().map(|p| [0, 1, 2].map(|c| white(p.0[c], p.0[3]))).collect()
    }
}

/// Pixels on white.
type Rgb = Vec<[u8; 3]>;

fn on_white(picture: &Pixmap) -> Rgb {
    let white = |v: u8, alpha: u8| v.saturating_add(255 - alpha);
    picture.pixels().iter().map(|p| [p.red(), p.green(), p.blue()].map(|v| white(v, p.alpha()))).collect()
}

/// A file, and the picture that vtex makes of it.
struct Case {
    name: String,
    text: String,
    size: [u32; 2],
    picture: Rgb,
}

impl Case {
    fn of(name: &str, scene: &Scene) -> Self {
        let picture = on_white(&png::render(scene, 1.0).unwrap());
        Self { name: name.into(), text: text(scene), size: [scene.width, scene.height], picture }
    }
}

fn text(scene: &Scene) -> String {
    let mut bytes = Vec::new();
    svg::write(scene, &SvgOptions::default(), &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// A scene wide enough that its background has several columns.
fn scene(seed: u64, tile: Tile) -> Scene {
    let params = SynthParams { width: 560, height: 200, seed, tile, ..SynthParams::default() };
    synthesize(&crate::support::library("pebbles"), &params, &()).unwrap()
}

fn shaped(mut scene: Scene) -> Scene {
    let first = scene.individuals().next().unwrap();
    let outline = scene.element(first).outline().clone();
    let bounds = outline.bounds();
    let path = Affine::translate((280.0, 100.0))
        * Affine::scale(240.0 / bounds.height().max(bounds.width()))
        * Affine::translate(-bounds.center().to_vec2())
        * outline.path();
    scene.domain = Some(Domain { outline: Outline::new(&path).unwrap(), edge: Edge::Clip });
    scene
}

fn styled(mut scene: Scene) -> Scene {
    let shadow = Shadow { offset: [3.0, 4.5], opacity: 0.4, blur: 5.0 };
    let mut layers = scene.layers.iter_mut().rev();
    let primary = &mut layers.next().unwrap().instances;
    primary.iter_mut().for_each(|i| i.shadow = Some(shadow));
    let stroke = Stroke { width: 1.5, colour: Colour([250, 240, 200]) };
    primary.iter_mut().step_by(3).for_each(|i| i.stroke = Some(stroke));
    scene
}

/// A sheet of two by two cells.
fn pattern(scene: &Scene) -> Case {
    let mut bytes = Vec::new();
    svg::write_pattern(scene, &SvgOptions::default(), &mut bytes).unwrap();
    let [w, h] = [scene.width, scene.height];
    let sheet = format!("width=\"{}\" height=\"{}\"", 2 * w, 2 * h);
    let text = String::from_utf8(bytes).unwrap().replacen("width=\"100%\" height=\"100%\"", &sheet, 1);
    let cell = on_white(&png::render(scene, 1.0).unwrap());
    let at = |i: u32| cell[(i / (2 * w) % h * w + i % w) as usize];
    Case { name: "pattern".into(), text, size: [2 * w, 2 * h], picture: (0..4 * w * h).map(at).collect() }
}

/// An animation that stands still at its beginning. Its outlines and fills are simpler than those of the
/// scene, so it is compared with its own shapes.
fn animation(from: &Scene, to: &Scene) -> Case {
    let way = Interpolation::new(from.clone(), to.clone(), &()).unwrap();
    let mut bytes = Vec::new();
    let options = Animation { seconds: 4.0, back: true, precision: 1 };
    svg::write_animation(&way, &options, &mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let picture = on_white(&raster_svg::render_svg(text.as_bytes(), 1.0, "animation", &()).unwrap());
    let still = "</title>\n<style>*{animation-play-state:paused!important}</style>";
    let text = text.replacen("</title>", still, 1);
    Case { name: "animation".into(), text, size: [from.width, from.height], picture }
}

/// Textures of two by two periods of our own drawing, and of those beside the repository, if there are any.
fn drawings() -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![folder.join("examples/drawings/garden.svg")];
    let beside =
        std::fs::read_dir(folder.join("../shared/exemplars/drawings")).into_iter().flatten().flatten();
    files
        .extend(beside.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "svg")));
    files.sort();
    let case = |file: PathBuf| {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let library = import(&std::fs::read(&file).unwrap(), &name, &ImportParams::default(), &()).unwrap();
        let [width, height] = [library.source.width, library.source.height].map(|side| 2 * side);
        let params = SynthParams { width, height, seed: 7, ..SynthParams::default() };
        Case::of(&name, &synthesize(&library, &params, &()).unwrap())
    };
    files.into_iter().map(case).collect()
}

fn cases() -> Vec<Case> {
    let plain = scene(4, Tile::default());
    let tile = scene(5, Tile { x: true, y: true });
    let mut cases = vec![
        Case::of("SVG", &plain),
        Case::of("tile", &tile),
        pattern(&tile),
        Case::of("domain", &shaped(plain.clone())),
        Case::of("shadows", &styled(plain.clone())),
        animation(&plain, &scene(6, Tile::default())),
    ];
    cases.extend(drawings());
    cases
}

#[test]
#[ignore = "starts Inkscape, Chromium, Firefox and rsvg-convert: cargo test --test all programs:: -- --ignored --nocapture"]
fn programs_draw_what_vtex_draws() {
    let missing = Program::ALL.into_iter().filter(|p| p.find().is_none());
    missing.for_each(|p| {
        eprintln!("SKIPPED: {} is not on the search path, so nothing was drawn by it", p.name())
    });
    let programs: Vec<(Program, PathBuf)> =
        Program::ALL.into_iter().filter_map(|p| Some((p, p.find()?))).collect();
    if programs.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut worst = Vec::new();
    println!("| file | program | mean | share above 40 | seconds |\n|---|---|--:|--:|--:|");
    for case in cases() {
        let file = folder.path().join(format!("{}.svg", case.name));
        std::fs::write(&file, &case.text).unwrap();
        for (program, path) in &programs {
            let start = Instant::now();
            let drawn = program.draw(path, &file, case.size);
            let seconds = start.elapsed().as_secs_f64();
            let off = |(a, b): (&[u8; 3], &[u8; 3])| [0, 1, 2].map(|c| a[c].abs_diff(b[c]));
            let off: Vec<[u8; 3]> = drawn.iter().zip(&case.picture).map(off).collect();
            let mean = off.iter().flatten().map(|v| f64::from(*v)).sum::<f64>() / (3 * off.len()) as f64;
            let far = off.iter().filter(|p| p.iter().any(|v| *v > 40)).count() as f64 / off.len() as f64;
            let (name, program) = (&case.name, program.name());
            println!("| {name} | {program} | {mean:.2} | {:.3} % | {seconds:.1} |", 100.0 * far);
            let most = match &**name {
                "shadows" => MOST_OF_SHADOWS,
                "hero-topography" => MOST_OF_HAIRLINES,
                _ => MOST,
            };
            if mean > most {
                worst.push(format!("{name} by {program}: {mean:.2}"));
            }
        }
    }
    assert_eq!(worst, Vec::<String>::new());
}
