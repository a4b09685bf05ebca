//! Reading path data; an outline is written and read back the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vtex::geometry::{Outline, PathText, parse_path, write_path};

fuzz_target!(|text: &str| {
    let Ok(path) = parse_path(text) else { return };
    let Some(outline) = Outline::new(&path) else { return };
    let written = write_path(outline.path(), PathText { precision: 2 });
    let again = Outline::new(&parse_path(&written).expect("what was written can be read"));
    assert_eq!(again.expect("and lies on the grid"), outline);
});
