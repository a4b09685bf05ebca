//! `vtex transfer`, `animate` and `metrics --library`: inputs, outputs and refusals.

use super::support::{Folder, is_document};

const SWATCH: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='120' height='120'>\
    <rect width='120' height='120' fill='#fea'/>\
    <path fill='#c33' d='M20 20h24v10h-24z'/><path fill='#c33' d='M70 30h24v10h-24z'/>\
    <path fill='#36c' d='M30 70l20 8-6 20z'/><path fill='#36c' d='M80 70l20 8-6 20z'/></svg>";

fn with_scene() -> Folder {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o a.scene.json --size 120 --seed 5").succeeds();
    folder.write("swatch.svg", SWATCH);
    folder
}

#[test]
fn textures_of_all_kinds_lend_arrangement_and_appearance() {
    let folder = with_scene();
    for (structure, appearance, name) in [
        ("a.scene.json", "photo.lib.json", "1.svg"),
        ("photo.png", "swatch.svg", "2.scene.json"),
        ("swatch.svg", "a.scene.json", "3.png"),
    ] {
        let run = folder.run(&format!(
            "transfer --structure {structure} --appearance {appearance} -o {name} --seed 3 --json"
        ));
        assert!(run.succeeds().json()["seconds"].is_object(), "{name}");
    }
    assert!(is_document(&folder.read("2.scene.json"), "vtex-scene"));
    // A photograph as structure gives the same result as its library.
    folder.run("transfer --structure photo.png --appearance a.scene.json -o b.svg --seed 3").succeeds();
    folder.run("analyze photo.png -o own.lib.json --seed 3").succeeds();
    folder.run("transfer --structure own.lib.json --appearance a.scene.json -o c.svg --seed 3").succeeds();
    assert!(folder.read("b.svg") == folder.read("c.svg"));
    folder.write("page.html", "<!doctype html><p>no texture</p>");
    folder.run("transfer --structure page.html --appearance a.scene.json -o d.svg").fails(1, "page.html");
    folder
        .run("transfer --structure a.scene.json --appearance photo.lib.json swatch.svg -o d.svg")
        .fails(2, "nothing says where which appearance is used");
    assert!(!folder.path("d.svg").exists());
}

#[test]
fn a_picture_is_redrawn_in_any_texture() {
    let folder = with_scene();
    for (texture, name) in [("photo.lib.json", "1.svg"), ("swatch.svg", "2.png")] {
        folder
            .run(&format!(
                "transfer --onto photo.png --appearance {texture} -o {name} --longer-side 90 --seed 1"
            ))
            .succeeds();
    }
    folder.run("transfer --onto a.scene.json --appearance photo.lib.json -o 3.svg").fails(1, "a.scene.json");
    folder
        .run("transfer --onto photo.png --appearance photo.lib.json --element-size 1 -o 3.svg")
        .fails(2, "expected 2 to 1000 px");
}

#[test]
fn a_flow_plays_in_every_form() {
    let folder = with_scene();
    for (name, beginning) in
        [("f.gif", &b"GIF89a"[..]), ("f.png", b"\x89PNG"), ("f.svg", b"<?xml"), ("f.svgz", b"\x1f\x8b")]
    {
        folder.run(&format!("animate a.scene.json -o {name} --frames 3 --seed 2")).succeeds();
        assert!(folder.read(name).starts_with(beginning), "{name}");
    }
    let text = String::from_utf8(folder.read("f.svg")).unwrap();
    assert!(
        text.contains("<animateTransform") && text.contains("dur=\".2s\""),
        "three frames at 15 a second"
    );
    folder.run("animate a.scene.json -o again.svg --frames 3 --seed 2").succeeds();
    assert!(folder.read("again.svg") == text.as_bytes());
    folder.run("animate a.scene.json -o frames --frames 2 --flow vortex").succeeds();
    assert!(folder.path("frames/frame_0002.svg").exists());
    let idle = folder.run("animate a.scene.json -o g.svg --frames 2 --max-bytes 9kB").succeeds();
    assert!(idle.stderr.contains("--max-bytes has no effect"), "{}", idle.stderr);
    folder.run("animate a.scene.json -o f.pdf").fails(2, "cannot tell the kind of animation");
    folder.run("animate a.scene.json -o h.gif --flow photo.lib.json").fails(1, "photo.lib.json");
}

#[test]
fn elements_are_found_again_in_scenes_and_in_svgs() {
    let folder = with_scene();
    folder.run("render a.scene.json -o a.svg").succeeds();
    let told = |file: &str| {
        let run = folder.run(&format!("metrics {file} --library photo.lib.json --json")).succeeds();
        let told = run.json();
        (told["elements"].as_u64().unwrap(), told["matched"].as_f64().unwrap())
    };
    let (scene, svg) = (told("a.scene.json"), told("a.svg"));
    assert!(scene.0 > 10 && scene.1 > 0.6, "{scene:?}");
    // The SVG gives about the same numbers; they differ by pieces of elements that touch the border.
    assert!(svg.0.abs_diff(scene.0) <= scene.0 / 5 && (svg.1 - scene.1).abs() < 0.15, "{scene:?} {svg:?}");
    folder.run("metrics photo.png --library photo.lib.json").fails(1, "photo.png");
}

#[test]
fn a_colour_or_a_drawing_spreads_to_all_like_one() {
    let folder = with_scene();
    let edit = |operation: &str, name: &str| {
        let mut command = folder.command(&format!("edit a.scene.json -o {name} --json"));
        super::support::Run::from(command.args(["--op", operation]).output().unwrap())
    };
    let filled = edit("propagate --fill #ff0000 --layer primary", "1.svg").succeeds().json();
    assert!(filled["operations"][0]["matched"].as_u64().unwrap() > 10, "{filled}");
    assert!(String::from_utf8(folder.read("1.svg")).unwrap().contains("\"#f00\""));
    edit("propagate --element swatch.svg --layer primary", "2.scene.json").succeeds();
    let told = folder.run("inspect 2.scene.json").succeeds();
    assert!(
        told.text().contains("propagate element=swatch.svg replace=true layer=primary"),
        "{}",
        told.text()
    );
    for operation in ["propagate", "propagate swatch.svg --fill red", "propagate --fill red --of x"] {
        edit(operation, "3.svg").fails(2, "cannot do 'propagate");
    }
}

#[test]
fn a_photograph_whose_borders_join_is_found_to_repeat() {
    let folder = Folder::new();
    // Blurred noise on a torus, with discs, one of them across a border.
    let noise = |x: u32, y: u32| {
        let h = (x % 96).wrapping_mul(0x9e37_79b1) ^ (y % 96).wrapping_mul(0x85eb_ca6b);
        let h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
        (h ^ (h >> 12)) >> 27
    };
    let image = image::RgbImage::from_fn(96, 96, |x, y| {
        let grain = (0..36).map(|k| noise(x + k % 6, y + k / 6)).sum::<u32>() / 12;
        let [dx, dy] = [x, y].map(|v| (i64::from(v) + 48) % 48 - 24);
        let disc = dx * dx + dy * dy < 120;
        image::Rgb(if disc { [40 + grain as u8 / 4, 60, 90] } else { [120 + grain as u8; 3] })
    });
    let image = image::DynamicImage::from(image);
    let part = image.crop_imm(0, 0, 80, 80);
    folder.write("torus.png", super::support::encode(&image, image::ImageFormat::Png));
    let analyzed = |option: &str, name: &str| {
        let run = folder.run(&format!("analyze torus.png -o {name} --segmenter felzenszwalb {option}"));
        let library: serde_json::Value = serde_json::from_slice(&folder.read(name)).unwrap();
        (run.succeeds().stderr, library["arrangement"]["periodic"] == true)
    };
    let (told, periodic) = analyzed("", "auto.lib.json");
    assert!(periodic && told.contains("give --wrap=off"), "{told}");
    let (told, periodic) = analyzed("--wrap=off", "off.lib.json");
    assert!(!periodic && !told.contains("give --wrap=off"), "{told}");
    // A part of the picture does not repeat.
    folder.write("torus.png", super::support::encode(&part, image::ImageFormat::Png));
    let (told, periodic) = analyzed("", "part.lib.json");
    assert!(!periodic && !told.contains("give --wrap=off"), "{told}");
}
