//! What the methods that make a drawing anew as a whole are for.

use crate::arrange::Plan;
use vtex_scene::library::Library;
use vtex_scene::scene::Edge;

/// The only library, a drawing, if nothing is asked that these methods do not follow; else what they are for.
pub(super) fn single_drawing<'a>(plan: &'a Plan<'_>) -> Result<&'a Library, &'static str> {
    let Plan { params, controls, .. } = plan;
    let [library] = &*plan.libraries else { return Err("for a single library") };
    if !library.is_drawing() || library.is_layered() {
        return Err("for a drawing");
    }
    if controls.structure.is_some() {
        return Err("without a guide");
    }
    if controls.context.is_some() && params.tile.any() {
        return Err("without a tile that repeats, beside a drawing that stays");
    }
    if params.edge != Edge::Clip {
        return Err("for elements cut where the shape or the canvas ends (edge clip)");
    }
    Ok(library)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::borrow::Cow;
    use vtex_base::raster::LabelMap;
    use vtex_scene::library::{SourceKind, testing};
    use vtex_scene::scene::SynthParams;

    #[test]
    fn what_these_methods_do_not_follow_is_refused() {
        let mut drawing = testing::library(&LabelMap::filled(60, 60, 0));
        drawing.source.kind = SourceKind::Drawing;
        let of = |params: SynthParams| {
            let libraries = Cow::Borrowed(std::slice::from_ref(&drawing));
            single_drawing(&Plan { libraries, controls: Cow::default(), params, memory: None }).err()
        };
        let plain = SynthParams::default;
        assert_eq!(of(plain()), None);
        for edge in [Edge::Keep, Edge::Avoid] {
            assert!(of(SynthParams { edge, ..plain() }).is_some_and(|why| why.contains("edge clip")));
        }
    }
}
