//! Motifs: elements of a drawing that belong together.

use super::{ElementId, Library};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most periods by which a part may be moved.
const FURTHEST: i32 = 8;

/// Elements of a drawing that belong together, such as two parallel strokes or the petals of a ring.
/// Synthesis moves, turns and exchanges them as a whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Motif {
    /// Number of its kind. Motifs of one kind are copies of each other, up to rotation, reflection and small
    /// differences; their parts correspond in order.
    pub kind: u32,
    /// Its elements; at least two.
    pub parts: Vec<MotifPart>,
}

/// An element of a motif.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MotifPart {
    /// Index in [`Library::elements`].
    pub element: ElementId,
    /// Whole periods along x and y by which the element is moved to its motif, where that crosses a border of
    /// the page. Default 0 and 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub periods: [i32; 2],
}

fn is_zero(periods: &[i32; 2]) -> bool {
    *periods == [0; 2]
}

impl Library {
    /// The number of motifs of each number of elements, as in "12 motifs of 3 elements".
    pub fn motif_sizes(&self) -> BTreeMap<usize, usize> {
        let mut sizes = BTreeMap::new();
        for motif in &self.motifs {
            *sizes.entry(motif.parts.len()).or_default() += 1;
        }
        sizes
    }
}

/// Checks the motifs of a library.
pub(super) fn validate(library: &Library) -> Result<(), String> {
    let primaries = library.primaries().len();
    let mut is_part = vec![false; primaries];
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    for (i, motif) in library.motifs.iter().enumerate() {
        let at = format!("motifs[{i}]");
        let size = motif.parts.len();
        if size < 2 {
            return Err(format!("{at} has fewer than two parts"));
        }
        if *sizes.entry(motif.kind).or_insert(size) != size {
            return Err(format!("{at} has {size} parts, and others of kind {} have not", motif.kind));
        }
        for part in &motif.parts {
            let element = part.element.index();
            match is_part.get_mut(element) {
                None => return Err(format!("{at} names element {element}, there are {primaries} primaries")),
                Some(true) => return Err(format!("{at}: element {element} is a part twice")),
                Some(known) => *known = true,
            }
            let limit = if library.arrangement.periodic { FURTHEST } else { 0 };
            if part.periods.iter().any(|v| v.unsigned_abs() > limit.unsigned_abs()) {
                return Err(format!("{at}: element {element} is moved by more than {limit} periods"));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::testing::{library, mosaic};
    use vtex_base::document::Document as _;

    fn part(element: u32, periods: [i32; 2]) -> MotifPart {
        MotifPart { element: ElementId(element), periods }
    }

    #[test]
    fn parts_are_primaries_and_of_one_motif_each() {
        let mut own = library(&mosaic(120, 14.0, 0.6, 1));
        own.arrangement.periodic = true;
        let motif = |kind, parts: &[MotifPart]| Motif { kind, parts: parts.to_vec() };
        let pair = motif(0, &[part(0, [0, 0]), part(1, [0, -1])]);
        own.motifs = vec![pair.clone(), motif(0, &[part(3, [0, 0]), part(2, [0, 0])])];
        assert_eq!(own.validate(), Ok(()));
        assert_eq!(own.motif_sizes(), BTreeMap::from([(2, 2)]));
        let json = serde_json::to_string(&pair).unwrap();
        assert_eq!(json, r#"{"kind":0,"parts":[{"element":0},{"element":1,"periods":[0,-1]}]}"#);
        let most = own.primaries().len() as u32;
        for (wrong, fault) in [
            (motif(1, &[part(4, [0, 0])]), "fewer than two"),
            (motif(1, &[part(4, [0, 0]), part(0, [0, 0])]), "twice"),
            (motif(1, &[part(4, [0, 0]), part(most, [0, 0])]), "primaries"),
            (motif(1, &[part(4, [0, 0]), part(5, [9, 0])]), "periods"),
            (motif(0, &[part(4, [0, 0]), part(5, [0, 0]), part(6, [0, 0])]), "of kind 0"),
        ] {
            let mut other = own.clone();
            other.motifs.push(wrong);
            assert!(other.validate().unwrap_err().contains(fault), "{fault}");
        }
        own.arrangement.periodic = false;
        assert!(own.validate().is_err());
    }
}
