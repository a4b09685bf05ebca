//! A foreign SVG as an exemplar.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::import::{ImportParams, import};
use vtex::library::{AnalyzeParams, Library};

fuzz_target!(|bytes: &[u8]| {
    for lenient in [false, true] {
        let analyze = AnalyzeParams { lenient, ..AnalyzeParams::default() };
        if let Ok(library) = import(bytes, "fuzz", &ImportParams { wrap: None, analyze }, &()) {
            // What is read is valid.
            assert!(Library::from_bytes(&library.to_json(), "fuzz").is_ok());
            let _ = vtex::synth::reconstruct(&library);
        }
    }
});
