//! Textures of motifs that were placed as wholes, taken apart into the elements of the drawing.

use super::compose::{Placement, What, compose};
use super::covered::covered;
use super::report::{CategoryReport, SynthReport};
use crate::arrange::motifs::MotifUnits;
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, rounded};
use vtex_base::progress::{Progress, advance};
use vtex_scene::library::{ElementId, Library};
use vtex_scene::scene::{InstanceId, LibraryId, Scene};

/// A scene of units as one of the drawing's elements, with its report.
///
/// # Errors
/// Those of `progress`.
pub(super) fn taken_apart(
    units: &MotifUnits,
    library: &Library,
    (mut scene, report): (Scene, SynthReport),
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let origin = |library: &Library, k: usize| {
        let [x, y] = library.elements[k].origin().map(f64::from);
        Affine::translate((x, y))
    };
    let mut placements = Vec::new();
    let units_of: Vec<usize> = std::mem::take(&mut scene.elements)
        .iter()
        .map(|element| element.source.map_or(0, ElementId::index))
        .collect();
    let mut motifs = 0;
    for (l, layer) in scene.layers.iter_mut().enumerate() {
        for instance in std::mem::take(&mut layer.instances) {
            let unit = units_of[instance.element.index()];
            let motif = units.kind(unit).map(|_| motifs);
            motifs += u32::from(motif.is_some());
            let whole = instance.affine() * origin(&units.library, unit).inverse();
            placements.extend(units.parts[unit].iter().map(|part| Placement {
                what: What::Known(LibraryId(0), ElementId::after(part.element), instance.colour),
                transform: rounded(whole * part.map * origin(library, part.element)),
                layer: l,
                motif,
            }));
        }
    }
    let libraries = std::slice::from_ref(library);
    let scene = compose(scene, InstanceId(0), libraries, placements);
    let covered = covered(library, &scene, || advance(progress, "background field", 2, 2))?;
    let categories = CategoryReport::of(library, covered);
    let own = SynthReport::of_scene(libraries, &scene, categories);
    // What was tried and corrected was whole motifs.
    let SynthReport { attempts, refused, removed, added, .. } = report;
    let report = SynthReport { coverage_wanted: library.coverage, attempts, refused, removed, added, ..own };
    Ok((scene, report))
}
