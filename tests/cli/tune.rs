//! `vtex tune`, and weights by name.

use super::support::{Folder, is_document};
use serde_json::Value;

const TUNE: &str = "tune photo.lib.json --evaluations 10 --size 90x70 --seeds 1 --seed 3";

fn weights(scene: &[u8]) -> Value {
    serde_json::from_slice::<Value>(scene).unwrap()["parameters"]["weights"].clone()
}

#[test]
fn weights_are_written_beside_the_library_and_used_by_name() {
    let folder = Folder::with_library();
    let run = folder.run(TUNE).succeeds();
    assert!(run.stderr.contains("before") && run.stderr.contains("correlation"), "{}", run.stderr);
    // The hint to use the weights is printed only if they are better.
    let kept = run.stderr.contains("no weights were found");
    assert_eq!(!kept, run.stderr.contains("use them with"), "{}", run.stderr);
    assert_eq!(kept, run.stderr.contains("contains those that the search began with"), "{}", run.stderr);
    let file = folder.read("photo.tuned.weights.json");
    assert!(is_document(&file, "vtex-weights"));
    let mut tuned: Value = serde_json::from_slice(&file).unwrap();
    assert!(tuned.as_object_mut().unwrap().remove("sha256").is_some());
    // The result is the same on any number of threads.
    let json = folder.run(&format!("{TUNE} --threads 1 --json")).succeeds().json();
    assert_eq!((&json["tuned"], folder.read("photo.tuned.weights.json")), (&tuned, file));

    folder.run("synth photo.lib.json --size 60 --weights tuned --seed 1 -o a.scene.json").succeeds();
    assert_eq!(weights(&folder.read("a.scene.json")), tuned["weights"]);
    folder.write("a.toml", "[synth]\nweights = \"tuned\"\n");
    folder.run("texture photo.png --size 60 --config a.toml --seed 1 -o b.scene.json").succeeds();
    assert_eq!(weights(&folder.read("b.scene.json")), tuned["weights"]);
    // Weights of the command line take precedence over the name in the file, and tuned weights are used only
    // on request.
    folder
        .run("synth photo.lib.json --size 60 --config a.toml --weights=1,0,0,0,0 -o c.scene.json")
        .succeeds();
    assert_eq!(weights(&folder.read("c.scene.json"))["target"], 1.0);
    folder.run("synth photo.lib.json --size 60 -o d.scene.json").succeeds();
    assert_eq!(weights(&folder.read("d.scene.json"))["empty"], -0.2);
}

#[test]
fn missing_and_foreign_weights_are_named() {
    let folder = Folder::with_library();
    for arguments in ["synth photo.lib.json", "texture photo.png"] {
        let run = folder.run(&format!("{arguments} --weights best")).fails(1, "'photo.best.weights.json'");
        assert!(
            run.stderr.contains("hint: 'vtex tune photo.lib.json --name best' makes them"),
            "{}",
            run.stderr
        );
    }
    folder.write("photo.tuned.weights.json", "{}");
    folder.run("synth photo.lib.json --weights tuned").fails(1, "not a valid vtex-weights file");
    folder.run(TUNE).fails(1, "was not written by vtex");
    folder.run(&format!("{TUNE} --force")).succeeds();
    folder.run("tune photo.png").fails(1, "contains an image, not a library");
    let names = ["photo.lib.json", "photo.png", "photo.tuned.weights.json"];
    assert_eq!(folder.names(), names);
}
