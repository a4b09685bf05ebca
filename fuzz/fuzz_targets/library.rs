//! Reading a library; one that is read is written back the same, and can be drawn.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::library::Library;
use vtex::output::svg;

fuzz_target!(|bytes: &[u8]| {
    let Ok(library) = Library::from_bytes(bytes, "fuzz") else { return };
    let written = library.to_json();
    let again = Library::from_bytes(&written, "fuzz").expect("what was written can be read");
    assert_eq!(again.to_json(), written);
    let scene = vtex::synth::reconstruct(&library);
    let _ = svg::write(&scene, &svg::SvgOptions::default(), std::io::sink());
});
