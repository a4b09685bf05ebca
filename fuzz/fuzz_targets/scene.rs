//! Reading a scene; one that is read is written back the same, and small ones can be drawn.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::output::{png, svg};
use vtex::scene::Scene;

fuzz_target!(|bytes: &[u8]| {
    let Ok(scene) = Scene::from_bytes(bytes, "fuzz") else { return };
    let written = scene.to_json();
    let again = Scene::from_bytes(&written, "fuzz").expect("what was written can be read");
    assert_eq!(again.to_json(), written);
    if u64::from(scene.width) * u64::from(scene.height) <= 1 << 16 {
        let _ = svg::write(&scene, &svg::SvgOptions::default(), std::io::sink());
        let _ = png::render(&scene, 1.0);
    }
});
