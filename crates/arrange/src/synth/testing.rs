//! Drawings and warnings for tests.

use std::sync::Mutex;
use vtex_base::progress::Progress;
use vtex_base::raster::LabelMap;
use vtex_scene::library::{Library, Role, SourceKind, testing};

/// A drawing of the areas of a map, on a page that repeats.
pub(crate) fn drawing_of(map: &LabelMap) -> Library {
    let mut library = testing::library(map);
    let count = library.primaries().len();
    library.elements.truncate(count);
    library.layers.retain(|l| l.role != Role::Secondary);
    library.source.kind = SourceKind::Drawing;
    library.arrangement.periodic = true;
    library
}

/// Labels a rectangle of a map that repeats: left, top, width and height, in pixels.
pub(crate) fn fill(map: &mut LabelMap, label: u32, [x, y, w, h]: [u32; 4]) {
    for (dx, dy) in (0..h).flat_map(|dy| (0..w).map(move |dx| (dx, dy))) {
        map.set((x + dx) % map.width, (y + dy) % map.height, label);
    }
}

/// The warnings of a run.
#[derive(Default)]
pub(crate) struct Warnings(pub(crate) Mutex<Vec<String>>);

impl Progress for Warnings {
    fn warn(&self, message: &str) {
        self.0.lock().unwrap().push(message.into());
    }
}
