//! Division of pieces into elements.
//!
//! Groups of the drawing come first. Without groups, pieces belong together if they lie within one another,
//! touch, or are much nearer to each other than to all other pieces. If the result would be endless or span
//! most of the page, as in a packed drawing, only contacts count that recur at the same relative place
//! ([`recurring`](super::recurring)).

use super::offsets::Offsets;
use super::pieces::DrawingPiece;
use super::read::DrawingPage;
use super::recurring::recurring;
use std::collections::BTreeMap;
use vtex_base::geometry::Rect;
use vtex_base::raster::contact::{Contact, Pair};
use vtex_scene::element::Shape;
use vtex_scene::library::Grouping;

/// Largest side of a group that is one element, as a share of the page's.
const LARGEST: f64 = 0.6;
/// Least share of a piece that lies on or under another of the same element.
const WITHIN: f64 = 0.75;
/// Least distance between elements, as a multiple of the distance between parts of one element.
const APART: f64 = 1.8;
/// Distances below this, in pixels, count as equal.
const FINEST: u16 = 2;
/// Largest distance of the parts of an element, as a share of the page's side.
pub(super) const NEAREST: f64 = 0.016;

/// Properties of the pieces.
pub(super) struct PieceProperties<'a> {
    pub(super) page: &'a DrawingPage,
    pub(super) pieces: &'a [DrawingPiece],
    /// Whether each piece is still cut by the border of a page that wraps.
    pub(super) cut: Vec<bool>,
    /// Bounds of each, in pixels.
    pub(super) bounds: Vec<Rect>,
    /// Pixels of each.
    pub(super) areas: Vec<u32>,
    pub(super) contacts: BTreeMap<Pair, Contact>,
    /// Size of the page, in pixels.
    pub(super) size: [f64; 2],
}

/// The elements as sets of pieces, with the copy of each piece that belongs to the set.
pub(super) fn elements(known: &PieceProperties<'_>, shapes: &[Vec<Shape>], how: Grouping) -> Offsets {
    let mut sets = Offsets::new(known.pieces.len());
    let mut last: BTreeMap<usize, usize> = BTreeMap::new();
    for (k, piece) in known.pieces.iter().enumerate().filter(|_| how == Grouping::Path) {
        if let Some(other) = last.insert(piece.item, k) {
            sets.join(other, k, known.nearest_copy(other, k));
        }
    }
    if matches!(how, Grouping::Auto | Grouping::Group) {
        known.join_groups(&mut sets, how);
    }
    known.join_halves(&mut sets);
    if how == Grouping::Auto {
        known.join_where(&mut sets, |c, (a, b, _)| {
            let [a, b] = [a, b].map(|k| known.areas[k as usize]);
            f64::from(c.hidden) >= WITHIN * f64::from(a.min(b))
        });
        known.join_where(&mut sets, |c, _| c.gap == 0);
        let recurring = recurring(known, shapes, &sets);
        known.join_where(&mut sets, |_, pair| recurring.contains(&pair));
        if let Some(most) = known.joint(&sets) {
            known.join_where(&mut sets, |c, _| c.gap <= most);
        }
    }
    sets
}

impl PieceProperties<'_> {
    /// The shift of `b` that brings it nearest to `a`.
    fn nearest_copy(&self, a: usize, b: usize) -> [i32; 2] {
        let apart = self.bounds[a].center() - self.bounds[b].center();
        let away = [apart.x / self.size[0], apart.y / self.size[1]];
        // Only pieces cut by borders have copies.
        if self.cut[a] && self.cut[b] { away.map(|v| libm::round(v) as i32) } else { [0; 2] }
    }

    /// Joins the pieces of each group that is one element.
    fn join_groups(&self, sets: &mut Offsets, how: Grouping) {
        let groups = &self.page.groups;
        let mut bounds: Vec<Option<Rect>> = vec![None; groups.len()];
        for (k, piece) in self.pieces.iter().enumerate() {
            let mut up = piece.group;
            while let Some(g) = up {
                bounds[g] = Some(bounds[g].map_or(self.bounds[k], |b| b.union(self.bounds[k])));
                up = groups[g].parent;
            }
        }
        let all = self.page.counted;
        let is_element = |g: usize| {
            let several = groups[g].items > 1 && groups[g].items < all;
            let small = bounds[g].is_some_and(|b| is_small(b, self.size, LARGEST));
            several && (small || how == Grouping::Group)
        };
        let mut first: BTreeMap<usize, usize> = BTreeMap::new();
        for (k, piece) in self.pieces.iter().enumerate() {
            let (mut up, mut outermost) = (piece.group, None);
            while let Some(g) = up {
                outermost = if is_element(g) { Some(g) } else { outermost };
                up = groups[g].parent;
            }
            if let Some(g) = outermost {
                let other = *first.entry(g).or_insert(k);
                if other != k {
                    sets.join(other, k, self.nearest_copy(other, k));
                }
            }
        }
    }

    /// Joins pieces of one paint that meet at a border, where both were cut.
    fn join_halves(&self, sets: &mut Offsets) {
        for (&(a, b, shift), contact) in &self.contacts {
            let (a, b) = (a as usize, b as usize);
            let alike = self.pieces[a].parts[0].paint.colour == self.pieces[b].parts[0].paint.colour;
            if shift != [0; 2] && contact.gap == 0 && alike && self.cut[a] && self.cut[b] {
                sets.join(a, b, shift);
            }
        }
    }

    /// Joins pieces whose contact satisfies `says`, if the result is small and not endless.
    fn join_where(&self, sets: &mut Offsets, says: impl Fn(&Contact, Pair) -> bool) {
        let mut trial = sets.clone();
        let mut pairs = Vec::new();
        for (&pair, contact) in &self.contacts {
            let (a, b, shift) = (pair.0 as usize, pair.1 as usize, pair.2);
            if self.pieces[a].layer == self.pieces[b].layer && says(contact, pair) {
                trial.join(a, b, shift);
                pairs.push((a, b, shift));
            }
        }
        let bounds = self.set_bounds(&trial);
        for (a, b, shift) in pairs {
            let root = trial.find(a).0;
            let sound = !trial.is_endless(root)
                && bounds.get(&root).is_some_and(|r| is_small(*r, self.size, LARGEST));
            if sound {
                sets.join(a, b, shift);
            }
        }
    }

    /// Bounds of each set, in the frame of its first piece.
    fn set_bounds(&self, sets: &Offsets) -> BTreeMap<usize, Rect> {
        let mut all: BTreeMap<usize, Rect> = BTreeMap::new();
        for (k, own) in self.bounds.iter().enumerate() {
            let (root, shift) = sets.find(k);
            let moved = *own
                + kurbo::Vec2::new(f64::from(shift[0]) * self.size[0], f64::from(shift[1]) * self.size[1]);
            all.entry(root).and_modify(|r| *r = r.union(moved)).or_insert(moved);
        }
        all
    }

    /// The largest distance between parts of one element. It exists if distances fall into two kinds: short
    /// ones within elements and long ones between them.
    fn joint(&self, sets: &Offsets) -> Option<u16> {
        // The lengths of a minimum spanning forest of near pieces.
        let mut pairs: Vec<(u16, Pair)> = self.contacts.iter().map(|(p, c)| (c.gap, *p)).collect();
        pairs.sort_unstable();
        let mut forest = sets.clone();
        let mut gaps = Vec::new();
        for (gap, (a, b, shift)) in pairs {
            let (a, b) = (a as usize, b as usize);
            if forest.find(a).0 != forest.find(b).0 {
                forest.join(a, b, shift);
                gaps.push(gap);
            }
        }
        let most = NEAREST * libm::sqrt(self.size[0] * self.size[1]);
        let reach = gaps.last().copied()?;
        // Larger distances are those of pieces that are not near each other.
        let beyond = libm::ceil(2.0 * most) as u16;
        let next = gaps.iter().copied().skip(1).chain([beyond.max(reach)]);
        let step = |(own, next): (u16, u16)| (f64::from(next) / f64::from(own.max(FINEST)), own);
        let short = |&(ratio, gap): &(f64, u16)| ratio >= APART && f64::from(gap) <= most && gap > 0;
        let best = gaps.iter().copied().zip(next).map(step).filter(short).last();
        best.map(|(_, gap)| gap)
    }
}

/// Whether a box is small compared with the page: at most `share` of each side.
fn is_small(b: Rect, size: [f64; 2], share: f64) -> bool {
    b.width() <= share * size[0] && b.height() <= share * size[1]
}
