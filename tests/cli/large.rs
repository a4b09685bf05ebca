//! Photographs that are reduced before they are analysed.

use super::support::{Folder, Run, encode};
use image::{GrayImage, ImageFormat, Luma};
use serde_json::Value;
use vtex::library::Library;
use vtex::scene::{Instance, Scene};

/// A folder with an exemplar of 512 × 512 px.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("terrazzo.png", include_bytes!("../../examples/exemplars/terrazzo.png"));
    folder
}

fn library(folder: &Folder, name: &str) -> Library {
    Library::from_bytes(folder.read(name), name).unwrap()
}

/// The size below which elements make up half of the total area.
fn across(mut areas: Vec<f64>) -> f64 {
    areas.sort_by(f64::total_cmp);
    let half = areas.iter().sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let at = areas.into_iter().find(|area| {
        sum += area;
        sum >= half
    });
    at.unwrap().sqrt()
}

fn across_of(library: &Library) -> f64 {
    across(library.primaries().iter().map(|p| p.outline().area()).collect())
}

#[test]
fn a_reduced_photograph_keeps_its_own_pixels() {
    let folder = folder();
    let analyze = "analyze terrazzo.png --segmenter regions --seed 1";
    let run = folder.run(&format!("{analyze} --max-pixels 0.09M -o small.lib.json")).succeeds();
    let told = "the photograph of 512 x 512 px was reduced to 300 x 300 px first";
    assert!(run.stderr.contains(told), "{}", run.stderr);
    let json =
        folder.run(&format!("{analyze} --max-pixels 90000 -o again.lib.json --json")).succeeds().json();
    assert_eq!(json["reduced"], serde_json::json!({"from": [512, 512], "to": [300, 300]}));
    assert_eq!(json["size"], serde_json::json!([512, 512]));
    assert_eq!(folder.read("small.lib.json"), folder.read("again.lib.json"));
    let run = folder.run(&format!("{analyze} --max-pixels off -o whole.lib.json")).succeeds();
    assert!(!run.stderr.contains("reduced"), "{}", run.stderr);
    // 512 x 512 px are below the limit.
    folder.run(&format!("{analyze} -o default.lib.json")).succeeds();

    let [small, whole, default] =
        ["small", "whole", "default"].map(|name| library(&folder, &format!("{name}.lib.json")));
    assert_eq!(
        (small.source.width, small.arrangement.width, small.source.scale),
        (512, 300, [300.0 / 512.0; 2])
    );
    assert_eq!((whole.source.scale, default.source.scale), ([1.0; 2], [1.0; 2]));
    assert_eq!(default.elements, whole.elements);
    let (a, b) = (across_of(&small), across_of(&whole));
    assert!((a / b - 1.0).abs() < 0.25, "elements are {a} px across, not {b}");
    assert!((small.coverage - whole.coverage).abs() < 0.1);

    // Textures of both libraries have elements of the same size, and the requested canvas.
    let json = folder
        .run("synth small.lib.json -o small.scene.json --size 400x300 --seed 3 --json")
        .succeeds()
        .json();
    assert_eq!(json["size"], serde_json::json!([400, 300]));
    folder.run("synth whole.lib.json -o whole.scene.json --size 400x300 --seed 3").succeeds();
    let size = |name: &str| {
        let scene = Scene::from_bytes(folder.read(name), name).unwrap();
        assert_eq!((scene.width, scene.height), (400, 300));
        let parameters = scene.parameters.clone().unwrap();
        assert_eq!((parameters.width, parameters.height), (400, 300));
        let places: Vec<f64> = scene.individuals().map(|i| i.transform[4]).collect();
        let right = places.iter().filter(|x| (200.0..500.0).contains(*x)).count();
        assert!(right * 3 > places.len() && right * 3 < places.len() * 2, "elements fill the canvas");
        let area = |i: &Instance| scene.element(i).outline().area() * i.affine().determinant().abs();
        across(scene.individuals().map(area).collect())
    };
    let (a, b) = (size("small.scene.json"), size("whole.scene.json"));
    assert!((a / b - 1.0).abs() < 0.35, "elements are {a} px large, not {b}");

    // Commands that combine a scene with its library handle the reduction.
    folder.run("warp small.scene.json small.lib.json --stretch 1.3 -o wide.scene.json").succeeds();
    folder.run("metrics small.lib.json small.scene.json").succeeds();
    folder.run("inspect small.lib.json -o page.html").succeeds();
    let edit: Run =
        folder.command("edit small.scene.json -o thin.svg --op").arg("thin 0.5").output().unwrap().into();
    edit.succeeds();
    // A texture of two photographs, one of them reduced, handles it too.
    let ramp = GrayImage::from_fn(64, 8, |x, _| Luma([x as u8 * 4]));
    folder.write("ramp.png", encode(&ramp.into(), ImageFormat::Png));
    folder.run("synth small.lib.json whole.lib.json --map ramp.png -o both.svg --size 200").succeeds();
}

#[test]
fn masks_have_the_size_of_the_photograph() {
    let folder = folder();
    let analyze = "analyze terrazzo.png --max-pixels 90000 --seed 1";
    for file in ["m.png", "m.json"] {
        folder
            .run(&format!("{analyze} --segmenter regions --save-masks {file} -o a.lib.json --force"))
            .succeeds();
        folder.run(&format!("{analyze} --masks {file} -o b.lib.json --force")).succeeds();
        let [a, b] = ["a.lib.json", "b.lib.json"].map(|name| library(&folder, name));
        assert_eq!(a.arrangement, b.arrangement, "{file}");
        assert_eq!(a.primaries().len(), b.primaries().len(), "{file}");
    }
    let masks = image::load_from_memory(&folder.read("m.png")).unwrap();
    assert_eq!((masks.width(), masks.height()), (512, 512));
    let json: Value = serde_json::from_slice(&folder.read("m.json")).unwrap();
    assert_eq!((&json["width"], &json["height"]), (&512.into(), &512.into()));
}

#[test]
fn limits_of_pixels_are_checked() {
    let folder = Folder::new();
    for wrong in ["4000", "none", "-1", "5000M"] {
        folder
            .run(&format!("analyze photo.png --max-pixels {wrong}"))
            .fails(2, "expected off, or 4096 to 4000000000 pixels, such as 1500000 or 1.5M");
    }
    folder.write("c.toml", "[analyze]\nmax-pixels = 'off'\n");
    folder.run("analyze photo.png --config c.toml --max-pixels 5000").succeeds();
    assert_eq!(library(&folder, "photo.lib.json").source.parameters.max_pixels, 5000);
    folder.run("analyze photo.png --config c.toml").succeeds();
    assert_eq!(library(&folder, "photo.lib.json").source.parameters.max_pixels, 0);
    folder.write("c.toml", "[analyze]\nmax-pixels = 12\n");
    folder.run("analyze photo.png --config c.toml").fails(2, "4096 to 4000000000 pixels");
}

#[test]
fn a_draft_is_reduced_further() {
    let folder = folder();
    folder.run("analyze terrazzo.png --preset draft").succeeds();
    let draft = library(&folder, "terrazzo.lib.json");
    assert_eq!(
        (draft.source.width, draft.arrangement.width, &*draft.source.segmenter),
        (512, 387, "regions")
    );
}
