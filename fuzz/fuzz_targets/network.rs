//! Reading a network, and telling whether it is an export of Segment Anything.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::engine::{EngineOptions, Runtime, NetworkSource, load};
use vtex::segment::prompt::sam::recognise;

fuzz_target!(|bytes: &[u8]| {
    let options = EngineOptions { runtime: Runtime::Rten, threads: Some(1), ..EngineOptions::default() };
    if let Ok(network) = load(NetworkSource::Bytes { name: "fuzz", bytes }, &options) {
        let _ = recognise(network.as_ref(), "fuzz");
    }
});
