//! `vtex animate` of two scenes: results, and notes on options without effect.

use super::support::Folder;
use serde_json::json;

/// A folder with two small scenes.
fn scenes() -> Folder {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o a.scene.json --size 60 --seed 1").succeeds();
    folder.run("synth photo.lib.json -o b.scene.json --size 60 --seed 2").succeeds();
    folder
}

#[test]
fn frames_are_files_and_those_of_another_film_are_told() {
    let folder = scenes();
    folder.run("animate a.scene.json b.scene.json -o animation --frames 3").succeeds();
    let names = || {
        let all = std::fs::read_dir(folder.path("animation")).unwrap();
        let mut names: Vec<String> = all.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(names(), ["frame_0001.svg", "frame_0002.svg", "frame_0003.svg"]);
    folder.run("render a.scene.json -o a.svg").succeeds();
    assert!(folder.read("animation/frame_0001.svg") == folder.read("a.svg"));
    let shorter = folder.run("animate a.scene.json b.scene.json -o animation --frames 2").succeeds();
    assert!(shorter.stderr.contains("frames of another animation"), "{}", shorter.stderr);
    let back =
        folder.run("animate a.scene.json b.scene.json -o pictures --frames 3 --back --format png --json");
    assert_eq!(back.succeeds().json()["size"], serde_json::json!([60, 60]));
    assert!(
        folder.path("pictures/frame_0004.png").exists() && !folder.path("pictures/frame_0005.png").exists()
    );
}

#[test]
fn films_are_what_their_names_say() {
    let folder = scenes();
    for (name, beginning) in
        [("f.gif", &b"GIF89a"[..]), ("f.png", b"\x89PNG"), ("f.svg", b"<?xml"), ("f.svgz", b"\x1f\x8b")]
    {
        folder.run(&format!("animate a.scene.json b.scene.json -o {name} --frames 2")).succeeds();
        assert!(folder.read(name).starts_with(beginning), "{name}");
    }
    folder
        .run("animate a.scene.json b.scene.json -o animation.pdf")
        .fails(2, "cannot tell the kind of animation");
    folder.run("animate a.scene.json b.scene.json -o f.gif --format png").fails(2, "--format is for frames");
    folder.run("synth photo.lib.json -o c.scene.json --size 50 --seed 2").succeeds();
    folder.run("animate a.scene.json c.scene.json -o f.gif").fails(1, "different sizes");
}

#[test]
fn options_that_change_nothing_are_told() {
    let folder = scenes();
    let run =
        |options: &str| folder.run(&format!("animate a.scene.json b.scene.json {options}")).succeeds().stderr;
    let told = run("-o f.svg --scale 2 --max-bytes 5kB --expand");
    for option in ["--scale", "--max-bytes", "--expand"] {
        assert!(told.contains(&format!("{option} has no effect here")), "{told}");
    }
    assert!(run("-o half.svg --at 0.5 --scale 2").contains("--scale has no effect here"));
    assert!(!run("-o half.svg --at 0.5 --expand --max-bytes 5MB").contains("no effect"));
    assert!(!run("-o f.gif --frames 2 --scale 0.5").contains("no effect"));
}

#[test]
fn a_scene_between_says_how_it_was_made() {
    let folder = scenes();
    folder.run("animate a.scene.json b.scene.json -o half.scene.json --at 0.5").succeeds();
    let scene: serde_json::Value = serde_json::from_slice(&folder.read("half.scene.json")).unwrap();
    let between = json!({ "from": ["photo.png"], "to": ["photo.png"], "place": { "at": 0.5 } });
    assert_eq!(scene["edits"][0]["operation"]["interpolation"], between);
    let told = folder.run("inspect half.scene.json").succeeds();
    assert!(told.text().contains("interpolation from=photo.png to=photo.png at=0.5"), "{}", told.text());
}
