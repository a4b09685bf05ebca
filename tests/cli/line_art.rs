//! `--kind curves`: pictures of lines become drawings, and textures of their lines.
#![cfg(feature = "curves")]

use super::support::{Folder, encode};
use image::{DynamicImage, GrayImage, Luma};
use roxmltree::Document;
use vtex::library::Library;
use vtex::scene::Scene;

/// A folder with `waves.png`, a picture of a drawing of lines.
fn with_waves() -> Folder {
    let folder = Folder::new();
    let drawing = format!("{}/examples/drawings/waves.svg", env!("CARGO_MANIFEST_DIR"));
    folder.run(&format!("render {drawing} -o waves.png")).succeeds();
    folder
}

/// Which pixels of a picture are dark.
fn inked(folder: &Folder, name: &str) -> (GrayImage, Vec<bool>) {
    let picture = image::load_from_memory(&folder.read(name)).unwrap().into_luma8();
    let ink = picture.pixels().map(|p| p.0[0] < 160).collect();
    (picture, ink)
}

/// The share of the dark pixels of a picture that have dark ones of another within two pixels.
fn found(folder: &Folder, [of, other]: [&str; 2]) -> f64 {
    let ((picture, own), (_, other)) = (inked(folder, of), inked(folder, other));
    let [width, height] = [picture.width() as i64, picture.height() as i64];
    let is_near = |i: usize| {
        let (x, y) = (i as i64 % width, i as i64 / width);
        (-2..=2).any(|dy| {
            (-2..=2).any(|dx| {
                let inside = (0..width).contains(&(x + dx)) && (0..height).contains(&(y + dy));
                inside && other[((y + dy) * width + x + dx) as usize]
            })
        })
    };
    let all: Vec<usize> = (0..own.len()).filter(|i| own[*i]).collect();
    all.iter().filter(|i| is_near(**i)).count() as f64 / all.len() as f64
}

#[test]
fn a_picture_of_lines_becomes_strokes() {
    let folder = with_waves();
    folder.run("vectorize waves.png --kind curves -o waves.svg -o again.png").succeeds();
    let (recall, precision) =
        (found(&folder, ["waves.png", "again.png"]), found(&folder, ["again.png", "waves.png"]));
    assert!(recall >= 0.97 && precision >= 0.97, "recall {recall}, precision {precision}");
    let text = String::from_utf8(folder.read("waves.svg")).unwrap();
    let document = Document::parse(&text).unwrap();
    let strokes =
        document.descendants().filter(|n| n.has_tag_name("path") && n.has_attribute("stroke-width"));
    assert!(strokes.count() > 8, "{text}");
}

#[test]
fn its_texture_is_made_of_curves() {
    let folder = with_waves();
    let run =
        folder.run("texture waves.png --kind curves -o out.svg --size 260x200 --seed 1 --json").succeeds();
    assert_eq!(run.json()["method"], "curves");
    let [exemplar, made] = [0, 1].map(|k| run.json()["curves"]["ends"][k].as_f64().unwrap());
    assert!(made <= exemplar + 3.0, "{made} loose ends, {exemplar} in the picture");
    // The library says what the picture was read as, and tells the program again.
    folder.run("analyze waves.png --kind curves -o waves.lib.json").succeeds();
    let library = Library::read(&folder.path("waves.lib.json")).unwrap();
    assert_eq!(library.source.parameters.kind, vtex::library::PictureKind::Curves);
    assert_eq!(library.source.file, "waves.png");
    let length = |options: &str| {
        let files = "synth waves.lib.json -o out.svg --size 260x200 --seed 1 --json --force";
        let run = folder.run(&format!("{files} {options}")).succeeds();
        assert_eq!(run.json()["method"], "curves");
        run.json()["coverage"]["got"].as_f64().unwrap()
    };
    // Half as many lines on the left, twice as many on the right: five quarters in all.
    let ramp = GrayImage::from_fn(80, 40, |x, _| Luma([if x < 40 { 64 } else { 255 }]));
    folder.write("ramp.png", encode(&DynamicImage::ImageLuma8(ramp), image::ImageFormat::Png));
    let ratio = length("--density ramp.png") / length("");
    assert!((ratio - 1.25).abs() < 0.2, "{ratio}");
}

#[test]
fn figures_that_end_stay_whole() {
    let folder = Folder::new();
    // Rings out of line, on paper with a wide margin.
    let rings: Vec<[f64; 3]> = (0..25u32)
        .map(|k| {
            let along = |part: u32, by: u32| f64::from(80 + part * 40 + k * by % 9);
            [along(k % 5, 5), along(k / 5, 7), f64::from(7 + k % 6)]
        })
        .collect();
    let picture = GrayImage::from_fn(330, 330, |x, y| {
        let is_near =
            |[a, b, r]: &[f64; 3]| (libm::hypot(f64::from(x) - a, f64::from(y) - b) - r).abs() < 1.3;
        Luma([if rings.iter().any(is_near) { 20 } else { 245 }])
    });
    folder.write("rings.png", encode(&DynamicImage::ImageLuma8(picture), image::ImageFormat::Png));
    let run = folder
        .run("texture rings.png --kind curves -o out.svg -o out.scene.json --size 400 --seed 1 --json")
        .succeeds();
    assert_eq!(run.json()["method"], "clustered");
    let scene = Scene::read(&folder.path("out.scene.json")).unwrap();
    assert!(scene.instances().count() > 60, "{}", scene.instances().count());
    for element in &scene.elements {
        let [width, height] = {
            let b = element.outline().bounds();
            [b.width(), b.height()]
        };
        assert!((12.0..32.0).contains(&width) && (width - height).abs() < 2.0, "{width} x {height}");
    }
    // No hole is as wide as the paper's margin.
    let at: Vec<[f64; 2]> = scene.instances().map(|i| [i.transform[4], i.transform[5]]).collect();
    for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (40.0 * f64::from(x + 1), 40.0 * f64::from(y + 1))))
    {
        let nearest = at.iter().map(|p| libm::hypot(p[0] - x, p[1] - y)).fold(f64::MAX, f64::min);
        assert!(nearest < 60.0, "{nearest} at {x} {y}");
    }
}

#[test]
fn a_picture_of_lines_that_is_read_as_a_photograph_is_warned_of() {
    let folder = with_waves();
    folder.write("photo.png", super::support::photo());
    let warns = |arguments: &str| folder.run(arguments).succeeds().stderr.contains("--kind curves reads it");
    assert!(warns("analyze waves.png -o waves.lib.json"));
    assert!(!warns("analyze waves.png --kind curves -o waves.lib.json --force"));
    assert!(!warns("analyze photo.png -o photo.lib.json --force"));
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = with_waves();
    let blank = GrayImage::from_pixel(100, 100, Luma([240]));
    folder.write("blank.png", encode(&DynamicImage::ImageLuma8(blank), image::ImageFormat::Png));
    folder.run("analyze blank.png --kind curves -o x.lib.json").fails(1, "no lines stand out");
    folder.run("analyze waves.png --kind curves --save-masks m.png -o x.lib.json").fails(2, "neither masks");
    folder.run("analyze waves.png --kind lines -o x.lib.json").fails(2, "photo");
    folder.run("analyze waves.png --kind curves -o waves.lib.json").succeeds();
    folder.write("photo.png", super::support::photo());
    let density = "synth waves.lib.json -o x.svg --method period --density photo.png";
    folder.run(density).fails(2, "map of densities");
}
