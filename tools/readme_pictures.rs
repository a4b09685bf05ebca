//! Draws the pictures of the README from the exemplars of this repository.
//!
//! `cargo run --release --example readme_pictures [FOLDER]`, by default `docs/images`

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::imageops::{self, FilterType as Scaling};
use image::{ImageBuffer, Luma, RgbImage};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use tiny_skia::Pixmap;
use vtex::Progress;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::interpolate::{Morph, morph};
use vtex::library::Library;
use vtex::output::png;
use vtex::output::raster_svg::render_svg;
use vtex::scene::{Scene, SynthParams};
use vtex::segment::MasksFile;
use vtex::segment::texton::Texton;
use vtex::synth::{reconstruct, synthesize};
use vtex::transfer::{StylizeParams, TransferParams, stylize, transfer};
use vtex_testing::{self, SceneKind, SceneParams};

/// Width of the white space between the parts of a picture, in pixels.
const GAP: u32 = 8;
/// Side of a picture of a whole texture, in pixels: large enough to judge it.
const SIDE: u32 = 300;
/// Quality of the files, of 100.
const QUALITY: u8 = 88;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

fn main() -> Outcome {
    let folder = std::env::args_os().nth(1).map_or("docs/images".into(), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let photo = open("terrazzo")?;
    let scene = scene(&library(&photo, &())?, 1024, 512, &())?;
    let small = imageops::resize(&photo.image, SIDE, SIDE, Scaling::Lanczos3);
    let result = draw(&scene, f64::from(SIDE) / 512.0)?;
    save(&grid(&[small, result], 2), &folder.join("terrazzo.jpg"))?;
    for (k, kinds) in SceneKind::ALL[..12].chunks(4).enumerate() {
        gallery(kinds, &folder.join(format!("gallery-{}.jpg", k + 1)))?;
    }
    zoom(&folder.join("zoom.jpg"))?;
    stages(&folder.join("stages.jpg"))?;
    composing(&folder.join("composing.jpg"))?;
    portrait(&folder.join("portrait.jpg"))?;
    fails(&folder.join("fails.jpg"))
}

/// A generated scene, and its exemplar with a name.
fn generated(params: &SceneParams) -> Outcome<(vtex_testing::GeneratedExemplar, Exemplar)> {
    let scene = vtex_testing::generate(params)?;
    let mut png = Vec::new();
    scene.image.write_with_encoder(PngEncoder::new(&mut png))?;
    let exemplar = Exemplar::from_bytes(&png, "generated.png", &Limits::default())?;
    Ok((scene, exemplar))
}

/// A generated exemplar of each kind, beside a texture made from it.
fn gallery(kinds: &[SceneKind], path: &Path) -> Outcome {
    let mut parts = Vec::new();
    for &kind in kinds {
        let params = SceneParams { kind, ..SceneParams::random(3, 512, 512) };
        let (_, exemplar) = generated(&params)?;
        let texture = draw(&scene(&library(&exemplar, &())?, 512, 512, &())?, 1.0)?;
        for picture in [&exemplar.image, &texture] {
            parts.push(side(picture));
        }
    }
    save(&grid(&parts, 4), path)
}

/// A crowded exemplar, its texture, and the texture made with the true masks.
fn fails(path: &Path) -> Outcome {
    let params = SceneParams { kind: SceneKind::Litter, ..SceneParams::random(3, 512, 512) };
    let (truth, exemplar) = generated(&params)?;
    let labels = ImageBuffer::<Luma<u16>, Vec<u16>>::from_fn(512, 512, |x, y| {
        Luma([truth.instances.labels[(y * 512 + x) as usize] as u16])
    });
    let mut png = Vec::new();
    labels.write_with_encoder(PngEncoder::new(&mut png))?;
    let masks = MasksFile::from_bytes(png, "truth.png")?;
    let corrected = analyze(&exemplar, &masks, &AnalyzeParams::default(), &())?;
    let mut parts = vec![exemplar.image.clone()];
    for library in [library(&exemplar, &())?, corrected] {
        parts.push(draw(&scene(&library, 512, 512, &())?, 1.0)?);
    }
    save(&grid(&parts.iter().map(side).collect::<Vec<_>>(), 3), path)
}

/// Two textures, the arrangement of the first with the appearance of the second, and a scene that changes
/// from the second at its sides to the first in the middle.
fn composing(path: &Path) -> Outcome {
    let pebbles = scene(&library(&open("pebbles")?, &())?, 500, 500, &())?;
    let leaves = library(&open("leaves")?, &())?;
    let params = TransferParams { seed: 7, ..TransferParams::default() };
    let (transferred, _) = transfer(&pebbles, &[reconstruct(&leaves)], &[], &params)?;
    let leaves = scene(&leaves, 500, 500, &())?;
    let island = morph(pebbles.clone(), leaves.clone(), &Morph::Radial, &())?;
    let parts = [&pebbles, &leaves, &transferred, &island].map(|scene| draw(scene, f64::from(SIDE) / 500.0));
    save(&grid(&parts.into_iter().collect::<Outcome<Vec<_>>>()?, 4), path)
}

/// A self-made portrait, and the same redrawn in leaves and in pebbles.
fn portrait(path: &Path) -> Outcome {
    let bytes = std::fs::read("examples/drawings/portrait.svg")?;
    let picture = rgb(&render_svg(&bytes, 1.0, "portrait.svg", &())?)?;
    let mut parts = vec![picture.clone()];
    for name in ["leaves", "pebbles"] {
        let elements = reconstruct(&library(&open(name)?, &())?);
        let params = StylizeParams { size: 900, seed: 7, ..StylizeParams::default() };
        parts.push(draw(&stylize(&picture, &elements, &params)?, 1.0)?);
    }
    let small = |part: &RgbImage| imageops::resize(part, SIDE, SIDE * 5 / 4, Scaling::CatmullRom);
    save(&grid(&parts.iter().map(small).collect::<Vec<_>>(), 3), path)
}

fn open(name: &str) -> Outcome<Exemplar> {
    Ok(Exemplar::open(Path::new(&format!("examples/exemplars/{name}.png")), &Limits::default())?)
}

fn library(photo: &Exemplar, progress: &dyn Progress) -> Outcome<Library> {
    Ok(analyze(photo, &Texton::new()?, &AnalyzeParams::default(), progress)?)
}

fn scene(library: &Library, width: u32, height: u32, progress: &dyn Progress) -> Outcome<Scene> {
    let params = SynthParams { width, height, seed: 7, ..SynthParams::default() };
    Ok(synthesize(library, &params, progress)?)
}

fn draw(scene: &Scene, scale: f64) -> Outcome<RgbImage> {
    rgb(&png::render(scene, scale)?)
}

fn rgb(picture: &Pixmap) -> Outcome<RgbImage> {
    let rgb = picture.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    Ok(RgbImage::from_raw(picture.width(), picture.height(), rgb).ok_or("too few pixels")?)
}

/// A part of the photograph, enlarged five times, beside the same part of its reconstruction.
fn zoom(path: &Path) -> Outcome {
    let (x, y, width, height, scale) = (125, 166, 64, 64, 5);
    let photo = open("flowers")?;
    let pixels = imageops::crop_imm(&photo.image, x, y, width, height).to_image();
    let pixels = imageops::resize(&pixels, width * scale, height * scale, Scaling::Nearest);
    let vectors = draw(&reconstruct(&library(&photo, &())?), f64::from(scale))?;
    let vectors = imageops::crop_imm(&vectors, x * scale, y * scale, width * scale, height * scale);
    save(&grid(&[pixels, vectors.to_image()], 2), path)
}

/// Collects the pictures of the stages.
struct Keep(Mutex<Vec<(String, RgbImage)>>);

impl Progress for Keep {
    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        self.0.lock().expect("nothing here panics").push((name.into(), draw()));
    }
}

/// Photograph, primaries, categories, target map, result.
fn stages(path: &Path) -> Outcome {
    let keep = Keep(Mutex::new(Vec::new()));
    let photo = open("terrazzo")?;
    let scene = scene(&library(&photo, &keep)?, 512, 512, &keep)?;
    let kept = keep.0.into_inner()?;
    let mut parts = vec![photo.image];
    for wanted in ["masks", "categories", "placed"] {
        let found = kept.iter().find(|(name, _)| name == wanted).ok_or(wanted)?;
        parts.push(found.1.clone());
    }
    parts.push(draw(&scene, 1.0)?);
    save(&grid(&parts.iter().map(side).collect::<Vec<_>>(), 3), path)
}

/// A picture of a whole texture at the size of all.
fn side(picture: &RgbImage) -> RgbImage {
    imageops::resize(picture, SIDE, SIDE, Scaling::CatmullRom)
}

/// Pictures in rows of `columns`.
fn grid(parts: &[RgbImage], columns: usize) -> RgbImage {
    let rows = || parts.chunks(columns);
    let width_of = |row: &[RgbImage]| row.iter().map(|p| p.width() + GAP).sum::<u32>() - GAP;
    let height_of = |row: &[RgbImage]| row.iter().map(RgbImage::height).max().unwrap_or(0);
    let width = rows().map(width_of).max().unwrap_or(0);
    let height = rows().map(|row| height_of(row) + GAP).sum::<u32>().saturating_sub(GAP);
    let mut grid = RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
    let mut y = 0;
    for row in rows() {
        let mut x = 0;
        for part in row {
            imageops::replace(&mut grid, part, x, y);
            x += i64::from(part.width() + GAP);
        }
        y += i64::from(height_of(row) + GAP);
    }
    grid
}

/// Saves as JPEG, a third as large as a PNG of these textures.
fn save(picture: &RgbImage, path: &Path) -> Outcome {
    let out = BufWriter::new(File::create(path)?);
    picture.write_with_encoder(JpegEncoder::new_with_quality(out, QUALITY))?;
    println!("{}: {} kB", path.display(), std::fs::metadata(path)?.len() / 1000);
    Ok(())
}
