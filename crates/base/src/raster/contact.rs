//! Contacts of masks on a page, and distances of near ones.

use super::Mask;
use std::collections::BTreeMap;

/// Shift in whole pages along x and y.
pub type Shift = [i32; 2];

/// The shift back.
pub fn minus(shift: Shift) -> Shift {
    shift.map(|v| -v)
}

/// Neighbours of a pixel, those at corners last.
const AROUND: [(i32, i32); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// The page pixel by pixel: the visible mask at each pixel, and which copy of it.
pub struct ContactPage {
    /// Width and height, in pixels.
    pub size: [i32; 2],
    periodic: bool,
    seen: Vec<Seen>,
}

/// A copy of a mask.
#[derive(Clone, Copy)]
struct Seen {
    mask: u32,
    shift: [i8; 2],
    /// Steps from the mask at which it was reached.
    steps: u16,
}

impl Seen {
    /// No mask.
    const NONE: Self = Self { mask: u32::MAX, shift: [0; 2], steps: 0 };

    /// A mask itself.
    fn new(mask: u32, shift: Shift) -> Self {
        Self { mask, shift: shift.map(|v| v.clamp(-100, 100) as i8), steps: 0 }
    }

    fn is_none(self) -> bool {
        self.mask == Self::NONE.mask
    }

    /// Mask and shift.
    fn copy(self) -> (u32, Shift) {
        (self.mask, self.shift.map(i32::from))
    }

    /// The same copy seen from another copy of the page.
    fn from(self, across: Shift) -> Self {
        if across == [0; 2] {
            return self;
        }
        let (mask, shift) = self.copy();
        Self { steps: self.steps, ..Self::new(mask, [shift[0] - across[0], shift[1] - across[1]]) }
    }

    /// Whether both are the same copy, reached or not.
    fn is_same(self, other: Self) -> bool {
        (self.mask, self.shift) == (other.mask, other.shift)
    }
}

/// Two adjacent masks: the first, the second, and the shift of the second's copy.
pub type Pair = (u32, u32, Shift);

/// The distance and overlap of two masks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contact {
    /// Distance between them, in pixels.
    pub gap: u16,
    /// Pixels of one that the other hides.
    pub hidden: u32,
}

impl ContactPage {
    /// The page of `size` pixels on which masks are painted in turn. Also returns the contacts in which masks
    /// hide others.
    pub fn new(size: [i32; 2], periodic: bool, masks: &[Mask]) -> (Self, BTreeMap<Pair, Contact>) {
        let count = (size[0] * size[1]) as usize;
        let mut page = Self { size, periodic, seen: vec![Seen::NONE; count] };
        let mut contacts = BTreeMap::new();
        for (k, mask) in masks.iter().enumerate() {
            page.paint(k as u32, mask, &mut contacts);
        }
        (page, contacts)
    }

    fn paint(&mut self, k: u32, mask: &Mask, contacts: &mut BTreeMap<Pair, Contact>) {
        for span in mask.spans() {
            let mut x = span.x0;
            while x < span.x1 {
                let left = self.size[0] - x.rem_euclid(self.size[0]);
                let length = left.min(span.x1 - x);
                self.paint_run(k, [x, span.y], length as usize, contacts);
                x += length;
            }
        }
    }

    /// Paints pixels of one row of a copy of the page.
    fn paint_run(&mut self, k: u32, at: [i32; 2], length: usize, contacts: &mut BTreeMap<Pair, Contact>) {
        let Some((i, shift)) = self.place(at) else { return };
        // The pixels lie on the copy of the mask that is moved back to the page.
        let new = Seen::new(k, minus(shift));
        for run in self.seen[i..][..length].chunk_by_mut(|a, b| a.is_same(*b)) {
            let old = run[0];
            if !old.is_none() && !old.is_same(new) {
                contacts.entry(pair(old.copy(), new.copy())).or_default().hidden += run.len() as u32;
            }
            run.fill(new);
        }
    }

    /// The pixel of the page at a place, and in which copy of the page the place lies.
    fn place(&self, at: [i32; 2]) -> Option<(usize, Shift)> {
        let shift = [0, 1].map(|k| at[k].div_euclid(self.size[k]));
        if shift != [0; 2] && (!self.periodic || shift.iter().any(|v| v.abs() > 100)) {
            return None;
        }
        let [x, y] = [0, 1].map(|k| at[k].rem_euclid(self.size[k]));
        Some(((y * self.size[0] + x) as usize, shift))
    }

    /// Number of visible pixels of each mask.
    #[cfg(test)]
    fn areas(&self, count: usize) -> Vec<u32> {
        let mut areas = vec![0; count];
        self.seen.iter().filter(|p| !p.is_none()).for_each(|p| areas[p.mask as usize] += 1);
        areas
    }

    /// Adds masks that lie at most `reach` pixels apart.
    pub fn near(mut self, reach: u16, contacts: &mut BTreeMap<Pair, Contact>) {
        let mut front: Vec<usize> = (0..self.seen.len()).filter(|&i| self.is_rim(i)).collect();
        let mut seen = std::mem::take(&mut self.seen);
        // The last pair and its distance, because the next pair is usually the same.
        let mut last: Option<(Pair, u16)> = None;
        for step in 0..=reach / 2 {
            let mut next = Vec::new();
            for &i in &front {
                // Every second step includes corners, so that the reached area grows as an octagon.
                let around = if step % 2 == 0 { 4 } else { 8 };
                let (at, here) = (self.at(i), seen[i]);
                for side in AROUND.into_iter().take(around) {
                    let Some((n, across)) = self.beside(at, side) else { continue };
                    let own = here.from(across);
                    let there = &mut seen[n];
                    if there.is_none() {
                        *there = Seen { steps: step + 1, ..own };
                        next.push(n);
                    } else if !there.is_same(own) {
                        let gap = own.steps + there.steps;
                        let met = pair(own.copy(), there.copy());
                        if last.is_some_and(|(known, least)| known == met && least <= gap) {
                            continue;
                        }
                        let entry = contacts.entry(met).or_insert(Contact { gap, hidden: 0 });
                        entry.gap = entry.gap.min(gap);
                        last = Some((met, entry.gap));
                    }
                }
            }
            front = next;
        }
    }

    /// Whether a pixel of a mask has a neighbour that is not of the same copy of the same mask.
    fn is_rim(&self, i: usize) -> bool {
        let (at, own) = (self.at(i), self.seen[i]);
        let is_other =
            |side| self.beside(at, side).is_some_and(|(n, across)| !self.seen[n].is_same(own.from(across)));
        !own.is_none() && AROUND.into_iter().any(is_other)
    }

    /// Column and row of a pixel.
    fn at(&self, i: usize) -> [i32; 2] {
        let [i, w] = [i as u32, self.size[0] as u32];
        [(i % w) as i32, (i / w) as i32]
    }

    /// The neighbour of a pixel, and in which copy of the page it lies.
    fn beside(&self, [x, y]: [i32; 2], (dx, dy): (i32, i32)) -> Option<(usize, Shift)> {
        let [w, h] = self.size;
        let [x, y] = [x + dx, y + dy];
        if (0..w).contains(&x) && (0..h).contains(&y) {
            return Some(((y * w + x) as usize, [0; 2]));
        }
        self.place([x, y])
    }
}

/// A pair in canonical order, the lower number first.
fn pair((a, sa): (u32, Shift), (b, sb): (u32, Shift)) -> Pair {
    let shift = [sb[0] - sa[0], sb[1] - sa[1]];
    let back = minus(shift);
    if a < b || a == b && shift >= back { (a, b, shift) } else { (b, a, back) }
}

#[cfg(test)]
mod tests {
    use super::super::Span;
    use super::*;

    fn block(x: i32, y: i32, w: i32, h: i32) -> Mask {
        Mask::from_spans((y..y + h).map(|y| Span { y, x0: x, x1: x + w }).collect())
    }

    #[test]
    fn gaps_and_borders() {
        let masks = [block(2, 2, 4, 4), block(8, 2, 4, 4), block(18, 2, 4, 4), block(3, 3, 2, 2)];
        let (page, mut contacts) = ContactPage::new([20, 10], true, &masks);
        assert_eq!(page.areas(4), [12, 16, 16, 4]);
        page.near(4, &mut contacts);
        assert_eq!(contacts[&(0, 1, [0, 0])].gap, 2);
        // The third wraps to columns 0 and 1 and touches the first.
        assert_eq!(contacts[&(0, 2, [-1, 0])].gap, 0);
        assert_eq!((contacts[&(0, 3, [0, 0])].hidden, contacts[&(0, 3, [0, 0])].gap), (4, 0));
        let (page, mut contacts) = ContactPage::new([20, 10], false, &masks);
        page.near(4, &mut contacts);
        assert!(!contacts.contains_key(&(0, 2, [-1, 0])));
    }
}
