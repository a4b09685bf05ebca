//! Drawings for tests.

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
