//! What the methods that make a drawing anew as a whole are for.

use crate::arrange::controls::Controls;
use vtex_base::error::Error;
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::SynthParams;

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
    let varied = params.rotate > 0.0 || params.mirror || params.scale_jitter > 0.0;
    if varied || controls.density.is_some() || controls.structure.is_some() {
        return Err(
            "without turned, mirrored or resized elements, and without a map of densities or a guide",
        );
    }
    Ok(library)
}

/// What is said where a method is not for something.
pub(super) fn refusal(method: &str, allowed: &'static str) -> Error {
    Error::Parameter { name: "method", value: method.into(), allowed: allowed.into() }
}
