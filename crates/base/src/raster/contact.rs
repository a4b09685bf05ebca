//! Contacts of masks on a page, and distances of near ones.

use super::Mask;
use crate::error::Result;
use std::collections::BTreeMap;

/// Shift in whole pages along x and y.
pub type Shift = [i32; 2];

/// The shift back.
pub fn minus(shift: Shift) -> Shift {
    shift.map(|v| -v)
}

/// Neighbours of a pixel, those at corners last.
const AROUND: [[i32; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];
/// A pixel of no mask.
const NONE: u32 = u32::MAX;
/// A pixel beyond the page.
const BEYOND: u32 = u32::MAX - 1;

/// A page on which masks were painted.
pub struct ContactPage {
    /// Width and height, in pixels.
    size: [i32; 2],
    /// Whether each axis repeats.
    wraps: [bool; 2],
    /// The visible copy at each pixel by its number, or [`NONE`], row by row. Around the page lies one pixel that is
    /// [`BEYOND`].
    seen: Vec<u32>,
    copies: Copies,
}

/// Copies of masks, numbered as they come.
#[derive(Default)]
struct Copies {
    /// Mask and shift of each.
    all: Vec<(u32, Shift)>,
    numbers: BTreeMap<(u32, Shift), u32>,
}

impl Copies {
    /// The number of a copy.
    fn number(&mut self, copy: (u32, Shift)) -> u32 {
        *self.numbers.entry(copy).or_insert_with(|| {
            self.all.push(copy);
            self.all.len() as u32 - 1
        })
    }

    /// The number of a copy as it is seen from another copy of the page.
    fn from(&mut self, number: u32, across: Shift) -> u32 {
        let (mask, shift) = self.all[number as usize];
        self.number((mask, [shift[0] - across[0], shift[1] - across[1]]))
    }

    /// Two copies as a pair.
    fn pair(&self, one: u32, other: u32) -> Pair {
        let [(a, from), (b, to)] = [one, other].map(|number| self.all[number as usize]);
        let shift = [to[0] - from[0], to[1] - from[1]];
        let back = minus(shift);
        if a < b || a == b && shift >= back { (a, b, shift) } else { (b, a, back) }
    }
}

/// Two adjacent masks, the lower number first, and the shift of the second's copy.
pub type Pair = (u32, u32, Shift);

/// The distance and overlap of two masks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contact {
    /// Distance between them, in pixels.
    pub gap: u16,
    /// Pixels of one that the other hides.
    pub hidden: u32,
}

/// The distance of each of `count` masks to the nearest other, at most `reach` pixels: 0 for one that touches others.
pub fn gaps(contacts: &BTreeMap<Pair, Contact>, count: usize, reach: u16) -> Vec<u16> {
    let mut gaps = vec![reach; count];
    for (&(a, b, _), contact) in contacts {
        let gap = if contact.hidden > 0 { 0 } else { contact.gap };
        for k in [a, b] {
            gaps[k as usize] = gaps[k as usize].min(gap);
        }
    }
    gaps
}

impl ContactPage {
    /// The page of `size` pixels on which masks are painted in turn. Also returns the contacts in which masks
    /// hide others.
    pub fn new(size: [i32; 2], wraps: [bool; 2], masks: &[Mask]) -> (Self, BTreeMap<Pair, Contact>) {
        let [width, height] = size.map(|v| v as usize);
        let mut seen = vec![BEYOND; (width + 2) * (height + 2)];
        for row in seen.chunks_exact_mut(width + 2).skip(1).take(height) {
            row[1..=width].fill(NONE);
        }
        let mut page = Self { size, wraps, seen, copies: Copies::default() };
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
        let new = self.copies.number((k, minus(shift)));
        for run in self.seen[i..][..length].chunk_by_mut(|a, b| a == b) {
            let old = run[0];
            if old != NONE && old != new {
                contacts.entry(self.copies.pair(old, new)).or_default().hidden += run.len() as u32;
            }
            run.fill(new);
        }
    }

    /// The pixel of the page at a place, and in which copy of the page the place lies.
    fn place(&self, at: [i32; 2]) -> Option<(usize, Shift)> {
        let shift = [0, 1].map(|k| at[k].div_euclid(self.size[k]));
        if (0..2).any(|k| shift[k] != 0 && !(self.wraps[k] && shift[k].abs() <= 100)) {
            return None;
        }
        let [x, y] = [0, 1].map(|k| at[k].rem_euclid(self.size[k]) as usize + 1);
        Some((y * self.stride() + x, shift))
    }

    /// Pixels from one row to the next.
    fn stride(&self) -> usize {
        self.size[0] as usize + 2
    }

    /// Number of visible pixels of each mask.
    #[cfg(test)]
    fn areas(&self, count: usize) -> Vec<u32> {
        let mut areas = vec![0; count];
        let seen = self.seen.iter().filter(|copy| **copy < BEYOND);
        seen.for_each(|copy| areas[self.copies.all[*copy as usize].0 as usize] += 1);
        areas
    }

    /// Adds masks that lie at most `reach` pixels apart. `go_on` is asked before each step from them.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub fn near(
        mut self,
        reach: u16,
        contacts: &mut BTreeMap<Pair, Contact>,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<()> {
        let sides = AROUND.map(|[x, y]| x as isize + y as isize * self.stride() as isize);
        let mut front = self.rim(&sides);
        // Steps from the mask at which each pixel was reached.
        let mut steps = vec![0u16; self.seen.len()];
        // The last pair and its distance, because the next pair is usually the same.
        let mut last: Option<([u32; 2], u16)> = None;
        for step in 0..=reach / 2 {
            go_on()?;
            let mut next = Vec::new();
            // Every second step includes corners, so that the reached area grows as an octagon.
            let around = &sides[..if step % 2 == 0 { 4 } else { 8 }];
            for &i in &front {
                let here = self.seen[i as usize];
                for side in around {
                    let Some((n, own)) = self.beside(i as usize, *side, here) else { continue };
                    let there = self.seen[n];
                    if there == NONE {
                        (self.seen[n], steps[n]) = (own, step + 1);
                        next.push(n as u32);
                    } else if there != own {
                        let gap = step + steps[n];
                        let met = [own, there];
                        if last.is_some_and(|(known, least)| known == met && least <= gap) {
                            continue;
                        }
                        let contact = contacts.entry(self.copies.pair(own, there));
                        let contact = contact.or_insert(Contact { gap, hidden: 0 });
                        contact.gap = contact.gap.min(gap);
                        last = Some((met, contact.gap));
                    }
                }
            }
            front = next;
        }
        Ok(())
    }

    /// The pixels of masks with a neighbour that is not of the same copy of the same mask.
    fn rim(&mut self, sides: &[isize]) -> Vec<u32> {
        let pixels = 0..self.seen.len() as u32;
        let mut is_rim = |i: usize| {
            let own = self.seen[i];
            let mut is_other =
                |side: &isize| self.beside(i, *side, own).is_some_and(|(n, own)| self.seen[n] != own);
            own < BEYOND && sides.iter().any(&mut is_other)
        };
        pixels.filter(|i| is_rim(*i as usize)).collect()
    }

    /// The neighbour of a pixel, and the number that the copy at the pixel has there.
    #[inline]
    fn beside(&mut self, i: usize, side: isize, own: u32) -> Option<(usize, u32)> {
        let n = i.wrapping_add_signed(side);
        if self.seen[n] == BEYOND { self.across(n, own) } else { Some((n, own)) }
    }

    /// The pixel of the page that is continued by one beyond it, and the number that a copy has there.
    #[cold]
    fn across(&mut self, beyond: usize, own: u32) -> Option<(usize, u32)> {
        let [x, y] = [beyond % self.stride(), beyond / self.stride()];
        let (n, shift) = self.place([x as i32 - 1, y as i32 - 1])?;
        Some((n, self.copies.from(own, shift)))
    }
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
        let (page, mut contacts) = ContactPage::new([20, 10], [true; 2], &masks);
        assert_eq!(page.areas(4), [12, 16, 16, 4]);
        page.near(4, &mut contacts, &|| Ok(())).unwrap();
        assert_eq!(contacts[&(0, 1, [0, 0])].gap, 2);
        // The third wraps to columns 0 and 1 and touches the first.
        assert_eq!(contacts[&(0, 2, [-1, 0])].gap, 0);
        assert_eq!((contacts[&(0, 3, [0, 0])].hidden, contacts[&(0, 3, [0, 0])].gap), (4, 0));
        for wraps in [[false, false], [false, true], [true, false]] {
            let (page, mut contacts) = ContactPage::new([20, 10], wraps, &masks);
            page.near(4, &mut contacts, &|| Ok(())).unwrap();
            assert_eq!(contacts.contains_key(&(0, 2, [-1, 0])), wraps[0]);
        }
    }
}
