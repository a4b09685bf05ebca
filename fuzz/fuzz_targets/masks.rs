//! Reading masks, run-length JSON or label PNG, for an image of 64 x 48 pixels.
#![no_main]

use image::RgbImage;
use libfuzzer_sys::fuzz_target;
use vtex::segment::{MasksFile, Segmenter};

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = MasksFile::from_bytes(bytes.to_vec(), "fuzz") else { return };
    let Ok(masks) = file.segment(&RgbImage::new(64, 48), &()) else { return };
    for mask in masks {
        let (x0, y0, x1, y1) = mask.mask.bounds().expect("empty masks are left out");
        assert!(x0 >= 0 && y0 >= 0 && x1 <= 64 && y1 <= 48);
    }
});
