//! What the methods that make a drawing anew as a whole are for.

use crate::arrange::controls::Controls;
use vtex_base::error::Error;
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::{Edge, SynthParams};

/// The only library, a drawing, if nothing is asked that these methods do not follow; else what they are for.
pub(super) fn single_drawing<'a>(
    libraries: &'a [Library],
    params: &SynthParams,
    controls: &Controls,
) -> Result<&'a Library, &'static str> {
    let [library] = libraries else { return Err("for a single library") };
    if library.source.kind != SourceKind::Drawing || library.is_layered() {
        return Err("for a drawing");
    }
    if params.varies() || controls.structure.is_some() {
        return Err("without turned, mirrored or resized elements, and without a guide");
    }
    if controls.context.is_some() && params.tile.any() {
        return Err("without a tile that repeats, beside a drawing that stays");
    }
    if params.edge != Edge::Clip {
        return Err("for elements cut where the shape or the canvas ends (edge clip)");
    }
    Ok(library)
}

/// What is said where a method is not for something.
pub(super) fn refusal(method: &str, allowed: &'static str) -> Error {
    Error::Parameter { name: "method", value: method.into(), allowed: allowed.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::LabelMap;
    use vtex_scene::library::testing;

    #[test]
    fn what_these_methods_do_not_follow_is_refused() {
        let mut drawing = testing::library(&LabelMap::filled(60, 60, 0));
        drawing.source.kind = SourceKind::Drawing;
        let of = |params: SynthParams| {
            single_drawing(std::slice::from_ref(&drawing), &params, &Controls::default()).err()
        };
        let plain = SynthParams::default;
        assert_eq!(of(plain()), None);
        assert!(of(SynthParams { mirror: true, ..plain() }).is_some_and(|why| why.contains("mirrored")));
        for edge in [Edge::Keep, Edge::Avoid] {
            assert!(of(SynthParams { edge, ..plain() }).is_some_and(|why| why.contains("edge clip")));
        }
    }
}
