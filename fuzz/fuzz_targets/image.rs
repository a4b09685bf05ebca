//! Decoding an exemplar, within 64 MiB.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::analyze::{Exemplar, Limits};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { side: 2048, memory: 64 << 20 };
    if let Ok(exemplar) = Exemplar::from_bytes(bytes, "fuzz", &limits) {
        assert!(exemplar.image.width().min(exemplar.image.height()) >= Exemplar::SMALLEST_SIDE);
    }
});
