//! Textures of motifs that were placed as wholes, taken apart into the elements of the drawing.

use super::compose::{Placement, What, compose};
use super::report::SynthReport;
use crate::arrange::motifs::MotifUnits;
use vtex_base::geometry::{Affine, rounded};
use vtex_scene::library::{ElementId, Library};
use vtex_scene::scene::{InstanceId, LibraryId, Scene};

/// A scene of units as one of the drawing's elements, with its report.
pub(super) fn taken_apart(
    units: &MotifUnits,
    library: &Library,
    scene: Scene,
    report: SynthReport,
) -> (Scene, SynthReport) {
    let origin = |library: &Library, k: usize| {
        let [x, y] = library.elements[k].origin().map(f64::from);
        Affine::translate((x, y))
    };
    let mut placements = Vec::new();
    let mut empty = scene.clone();
    empty.elements.clear();
    for (l, layer) in empty.layers.iter_mut().enumerate() {
        for instance in std::mem::take(&mut layer.instances) {
            let unit = scene.elements[instance.element.index()].source.map_or(0, ElementId::index);
            let whole = instance.affine() * origin(&units.library, unit).inverse();
            placements.extend(units.parts[unit].iter().map(|part| Placement {
                what: What::Known(LibraryId(0), ElementId::after(part.element), instance.colour),
                transform: rounded(whole * part.map * origin(library, part.element)),
                layer: l,
            }));
        }
    }
    let libraries = std::slice::from_ref(library);
    let scene = compose(empty, InstanceId(0), libraries, placements);
    let own = SynthReport::of_scene(libraries, &scene, report.categories.clone());
    let report = SynthReport {
        primaries: own.primaries,
        textons: own.textons,
        overlap: own.overlap,
        repetition: own.repetition,
        ..report
    };
    (scene, report)
}
