//! A foreign SVG as an exemplar.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::import::{ImportParams, import};
use vtex::library::{AnalyzeParams, Library};
use vtex::scene::{Method, SynthParams, Tile};
use vtex::synth::{reconstruct, synthesize};

fuzz_target!(|bytes: &[u8]| {
    for lenient in [false, true] {
        let analyze = AnalyzeParams { lenient, ..AnalyzeParams::default() };
        if let Ok(library) = import(bytes, "fuzz", &ImportParams { wrap: None, analyze }, &()) {
            // What is read is valid.
            assert!(Library::from_bytes(library.to_json(), "fuzz").is_ok());
            let _ = reconstruct(&library);
            textures(&library);
        }
    }
});

/// Textures by each method, whole periods and not.
fn textures(library: &Library) {
    let [width, height] = [library.source.width, library.source.height];
    if width * height > 300 * 300 {
        return;
    }
    for (method, tile, size) in [
        (Method::Auto, true, [width, 2 * height]),
        (Method::Auto, false, [150, 90]),
        (Method::Descriptor, true, [150, 90]),
    ] {
        let [width, height] = size;
        let tile = Tile { x: tile, y: tile };
        let variation = Some(1.0);
        let params = SynthParams { width, height, method, tile, variation, ..SynthParams::default() };
        if let Ok(scene) = synthesize(library, &params, &()) {
            assert!(vtex::scene::Scene::from_bytes(scene.to_json(), "fuzz").is_ok());
        }
    }
}
