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
/// No mask.
const NONE: u32 = u32::MAX;

/// The page pixel by pixel: the visible mask at each pixel, and which copy of it.
pub struct ContactPage {
    /// Width and height, in pixels.
    pub size: [i32; 2],
    periodic: bool,
    masks: Vec<u32>,
    shifts: Vec<[i8; 2]>,
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
        let mut page = Self { size, periodic, masks: vec![NONE; count], shifts: vec![[0; 2]; count] };
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
        let own = minus(shift);
        let new = own.map(|v| v as i8);
        let (masks, shifts) = (&mut self.masks[i..][..length], &mut self.shifts[i..][..length]);
        let mut hide = |(other, theirs): (u32, [i8; 2]), count: usize| {
            if other != NONE && (other != k || theirs != new) {
                let pair = pair((other, theirs.map(i32::from)), (k, own));
                contacts.entry(pair).or_default().hidden += count as u32;
            }
        };
        let mut begin = 0;
        for x in 1..=length {
            let last = (masks[begin], shifts[begin]);
            if x == length || (masks[x], shifts[x]) != last {
                hide(last, x - begin);
                begin = x;
            }
        }
        masks.fill(k);
        shifts.fill(new);
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
        self.masks.iter().filter(|p| **p != NONE).for_each(|p| areas[*p as usize] += 1);
        areas
    }

    /// Adds masks that lie at most `reach` pixels apart.
    pub fn near(&self, reach: u16, contacts: &mut BTreeMap<Pair, Contact>) {
        let (mut masks, mut shifts) = (self.masks.clone(), self.shifts.clone());
        let mut steps = vec![0u16; masks.len()];
        let mut front: Vec<usize> = (0..masks.len()).filter(|&i| self.is_rim(i)).collect();
        // The last pair and its distance, because the next pair is usually the same.
        let mut last: Option<(Pair, u16)> = None;
        for step in 0..=reach / 2 {
            let mut next = Vec::new();
            for &i in &front {
                // Every second step includes corners, so that the reached area grows as an octagon.
                let around = if step % 2 == 0 { 4 } else { 8 };
                let at = self.at(i);
                for side in AROUND.into_iter().take(around) {
                    let Some((n, across)) = self.beside(at, side) else { continue };
                    // The copy as seen from the neighbour's page.
                    let moved = [0, 1].map(|k| i32::from(shifts[i][k]) - across[k]);
                    let own = (masks[i], moved.map(|v| v.clamp(-100, 100) as i8));
                    if masks[n] == NONE {
                        (masks[n], shifts[n]) = own;
                        steps[n] = step + 1;
                        next.push(n);
                    } else if (masks[n], shifts[n]) != own {
                        let gap = steps[i] + steps[n];
                        let met = pair((own.0, moved), (masks[n], shifts[n].map(i32::from)));
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
        if self.masks[i] == NONE {
            return false;
        }
        let at = self.at(i);
        let same = |side: (i32, i32)| {
            let Some((n, across)) = self.beside(at, side) else { return true };
            let moved = [0, 1].map(|k| i32::from(self.shifts[i][k]) - across[k]);
            (self.masks[n], self.shifts[n].map(i32::from)) == (self.masks[i], moved)
        };
        !AROUND.into_iter().all(same)
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
        page.near(4, &mut contacts);
        assert_eq!(contacts[&(0, 1, [0, 0])].gap, 2);
        // The third wraps to columns 0 and 1 and touches the first.
        assert_eq!(contacts[&(0, 2, [-1, 0])].gap, 0);
        assert_eq!((contacts[&(0, 3, [0, 0])].hidden, contacts[&(0, 3, [0, 0])].gap), (4, 0));
        assert_eq!(page.areas(4), [12, 16, 16, 4]);
        let (page, mut contacts) = ContactPage::new([20, 10], false, &masks);
        page.near(4, &mut contacts);
        assert!(!contacts.contains_key(&(0, 2, [-1, 0])));
    }
}
