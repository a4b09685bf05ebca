//! Files of older versions are read and give the same pictures as before. The files in `tests/versions` were
//! written by vtex 0.1 when the formats had version 1.

use std::path::{Path, PathBuf};
use vtex::library::{Library, SourceKind};
use vtex::output::png;
use vtex::scene::{Role, Scene, SynthParams, Tile};
use vtex::synth::synthesize;

fn stored(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/versions").join(name)
}

/// Mean difference of a scene's picture from a stored one, in 8-bit steps.
fn difference(scene: &Scene, name: &str) -> f64 {
    let wanted = image::open(stored(name)).unwrap().into_rgb8();
    let drawn = png::render(scene, 1.0).unwrap();
    assert_eq!((drawn.width(), drawn.height()), wanted.dimensions());
    let rgb = drawn.data().chunks_exact(4).flat_map(|p| &p[..3]);
    let sum: u64 = rgb.zip(wanted.as_raw()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / wanted.len() as f64
}

#[test]
fn a_library_of_version_1_gives_its_picture() {
    let library = Library::read(&stored("pebbles.lib.json.gz")).unwrap();
    assert_eq!((library.version, library.source.kind), (Library::VERSION, SourceKind::Photograph));
    assert!(!library.primaries().is_empty() && !library.secondaries().is_empty());
    let names: Vec<&str> = library.layers.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(names, ["background", "secondary", "primary"]);
    let tile = Tile { x: true, y: true };
    let params = SynthParams { width: 120, height: 90, seed: 3, tile, ..SynthParams::default() };
    let scene = synthesize(&library, &params, &()).unwrap();
    assert!(difference(&scene, "synthesised.png") < 0.05);
    // The library is unchanged after writing in the present version.
    let again = Library::from_bytes(library.to_json(), "again").unwrap();
    assert_eq!(again, library);
}

#[test]
fn a_scene_of_version_1_gives_its_picture() {
    let scene = Scene::read(&stored("pebbles.scene.json.gz")).unwrap();
    assert_eq!(scene.version, Scene::VERSION);
    assert!(difference(&scene, "edited.png") < 0.05);
    assert!(scene.of_role(Role::Primary).all(|i| i.shadow.is_some()));
    let edits: Vec<String> = scene.edits.iter().map(|e| e.operation.to_string()).collect();
    assert_eq!(edits.len(), 2);
    assert!(edits[0].ends_with("layer=secondary") && edits[1].ends_with("layer=primary"), "{edits:?}");
    assert_eq!(Scene::from_bytes(scene.to_json(), "again").unwrap(), scene);
}

#[test]
fn scene_and_library_of_version_1_fit_together() {
    use vtex::warp::{Bend, WarpParams, warp};
    let library = Library::read(&stored("pebbles.lib.json.gz")).unwrap();
    let scene = Scene::read(&stored("pebbles.scene.json.gz")).unwrap();
    let bend = Bend::scale(&scene, [1.5, 1.2]).unwrap();
    let (wider, report) = warp(&scene, vec![library], &bend, WarpParams::default(), &()).unwrap();
    assert!(report.primaries > 0 && wider.of_role(Role::Secondary).count() > 0);
    // Small elements, whose sources version 1 does not name, are kept.
    let known = |i: &vtex::scene::Instance| scene.of_role(Role::Secondary).any(|old| old.id == i.id);
    assert!(wider.of_role(Role::Secondary).filter(|i| known(i)).count() > 20);
}

#[test]
fn versions_that_are_not_known_are_named() {
    for text in [r#"{"format":"vtex-scene","version":3}"#, r#"{"format":"vtex-scene","version":0}"#] {
        let error = Scene::from_bytes(text.as_bytes(), "new").unwrap_err();
        assert!(matches!(error, vtex::Error::Version { known: 2, .. }), "{error}");
    }
}
