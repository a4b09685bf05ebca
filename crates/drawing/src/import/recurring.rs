//! Recurring contacts: shapes of different colours that always occur together, at the same relative place.

use super::elements::PieceProperties;
use super::offsets::Offsets;
use std::collections::{BTreeMap, BTreeSet};
use vtex_base::geometry::{Affine, Point, Rect};
use vtex_base::raster::contact::{Contact, Pair};
use vtex_scene::element::{Shape, classes};

/// Largest difference between equal shapes, and between the places of their partners, in pixels.
const EQUAL: f64 = 0.25;
/// Least number of contacts that recur.
const LEAST: usize = 2;

/// Two pieces that touch.
struct Touch {
    pair: Pair,
    /// Place of the second relative to the first, both in the frames of their classes.
    relative: Affine,
}

/// The pairs of pieces of one layer, in different sets, whose contact recurs: at least twice, and wherever the
/// rarer of the two shapes occurs, the other is at the same relative place.
pub(super) fn recurring(
    known: &PieceProperties<'_>,
    shapes: &[Vec<Shape>],
    sets: &Offsets,
) -> BTreeSet<Pair> {
    let touching = |(pair, contact): (&Pair, &Contact)| {
        let [a, b] = [pair.0 as usize, pair.1 as usize];
        let [p, q] = [a, b].map(|k| &known.pieces[k]);
        let differs = p.parts[0].paint.colour != q.parts[0].paint.colour && p.layer == q.layer;
        let apart = sets.find(a).0 != sets.find(b).0;
        (differs && apart && (contact.gap == 0 || contact.hidden > 0)).then_some(*pair)
    };
    let pairs: Vec<Pair> = known.contacts.iter().filter_map(touching).collect();
    if pairs.len() < LEAST {
        return BTreeSet::new();
    }
    let classes = classes(shapes.len(), |k| &shapes[k], |k| known.pieces[k].layer, EQUAL);
    let mut members: BTreeMap<usize, usize> = BTreeMap::new();
    classes.iter().for_each(|c| *members.entry(c.first).or_default() += 1);
    let mut by_kind: BTreeMap<[usize; 2], Vec<Touch>> = BTreeMap::new();
    for pair in pairs {
        let (a, b, shift) = (pair.0 as usize, pair.1 as usize, pair.2);
        let swapped = classes[a].first > classes[b].first;
        let (low, high, sign) = if swapped { (b, a, -1.0) } else { (a, b, 1.0) };
        let [dx, dy] = [0, 1].map(|k| sign * f64::from(shift[k]) * known.size[k]);
        let relative = classes[low].map.inverse() * Affine::translate((dx, dy)) * classes[high].map;
        by_kind.entry([classes[low].first, classes[high].first]).or_default().push(Touch { pair, relative });
    }
    let mut found = BTreeSet::new();
    for ([a, b], touches) in by_kind {
        let fewest = members[&a].min(members[&b]);
        for same_place in by_place(touches, known.bounds[b]) {
            if same_place.len() >= LEAST.max(fewest) {
                found.extend(same_place.iter().map(|t| t.pair));
            }
        }
    }
    found
}

/// Contacts of two kinds of shapes, grouped by relative place; `bounds` are those of the second.
fn by_place(touches: Vec<Touch>, bounds: Rect) -> Vec<Vec<Touch>> {
    let corners = [(bounds.x0, bounds.y0), (bounds.x1, bounds.y0), (bounds.x0, bounds.y1)].map(Point::from);
    let mut groups: Vec<Vec<Touch>> = Vec::new();
    for touch in touches {
        let same = |other: &Touch| {
            corners.iter().all(|&p| (touch.relative * p).distance(other.relative * p) <= 4.0 * EQUAL)
        };
        // At most 64 places are compared.
        match groups.iter().take(64).position(|group| same(&group[0])) {
            Some(k) => groups[k].push(touch),
            None => groups.push(vec![touch]),
        }
    }
    groups
}
