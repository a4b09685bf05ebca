//! Textures of motifs that were placed as wholes, taken apart into the elements of the drawing.

use super::compose::{Arranged, Placement, What};
use super::report::SynthReport;
use crate::arrange::motifs::MotifUnits;
use vtex_base::geometry::{Affine, rounded};
use vtex_scene::library::{ElementId, Library};
use vtex_scene::scene::LibraryId;

/// What was placed as motif units, as elements of the drawing.
pub(super) fn taken_apart(units: &MotifUnits, library: &Library, whole: Arranged<'_>) -> Arranged<'static> {
    let origin = |library: &Library, k: usize| {
        let [x, y] = library.elements[k].origin().map(f64::from);
        Affine::translate((x, y))
    };
    let mut placements = Vec::new();
    let mut motifs = 0;
    for placement in &whole.placements {
        let What::Known(_, unit, colour) = placement.what else { continue };
        let unit = unit.index();
        let motif = units.kind(unit).map(|_| motifs);
        motifs += u32::from(motif.is_some());
        let map = Affine::new(placement.transform) * origin(&units.library, unit).inverse();
        placements.extend(units.parts[unit].iter().map(|part| Placement {
            what: What::Known(LibraryId(0), ElementId::after(part.element), colour),
            transform: rounded(map * part.map * origin(library, part.element)),
            layer: placement.layer,
            motif,
            height: 0,
        }));
    }
    // What was tried and corrected was whole motifs.
    let SynthReport { attempts, refused, removed, added, .. } = whole.report;
    let report =
        SynthReport { attempts, refused, removed, added, ..SynthReport::of_drawing(library, 1.0, None) };
    Arranged { counted: Some("background field"), ..Arranged::new(whole.blank, placements, report) }
}
