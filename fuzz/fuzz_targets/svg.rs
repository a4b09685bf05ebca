//! Drawing a foreign SVG.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::output::raster_svg::render_svg;

fuzz_target!(|bytes: &[u8]| {
    let _ = render_svg(bytes, 0.01, "fuzz", &());
});
