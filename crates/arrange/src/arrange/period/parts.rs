//! Motifs of a drawing taken apart into their elements, which then move as far as the drawing's own copies of
//! the motif differ.

use super::canvas::OccupiedCanvas;
use crate::arrange::motifs::{DrawnElement, MotifUnits, PaintingOrder};
use vtex_base::error::Result;
use vtex_base::geometry::{Affine, Vec2};
use vtex_base::sampling::{Stream, stream};

/// Deviations below which no part moves, in pixels.
const LEAST: f64 = 0.25;
/// Copies of a motif whose deviations are tried.
const TRIES: usize = 4;

/// The elements of placed units.
pub(super) struct TakenApart {
    pub(super) placed: Vec<DrawnElement>,
    /// For each unit of more than one element: its number, its map, and the index of its first element.
    wholes: Vec<(usize, Affine, usize)>,
}

impl TakenApart {
    pub(super) fn new(units: &MotifUnits, placed: &[DrawnElement]) -> Self {
        let mut apart = Self { placed: Vec::with_capacity(placed.len()), wholes: Vec::new() };
        for (unit, number) in placed.iter().zip(0..) {
            let motif = units.kind(unit.element).map(|_| number);
            let parts = &units.parts[unit.element];
            if parts.len() > 1 {
                apart.wholes.push((unit.element, unit.map, apart.placed.len()));
            }
            let part = |part: &DrawnElement| {
                let order =
                    PaintingOrder { later: part.order.later.saturating_add(unit.order.later), ..part.order };
                DrawnElement { map: unit.map * part.map, order, motif, ..*part }
            };
            apart.placed.extend(parts.iter().map(part));
        }
        apart
    }

    /// Moves the parts of motifs. Each part goes a share of the way, at most `share`, from its place to that
    /// which another copy of the motif in the drawing has, laid upon this one. Calls `go_on` before each motif.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn vary(
        &mut self,
        canvas: &mut OccupiedCanvas<'_>,
        units: &MotifUnits,
        share: f64,
        seed: u64,
        go_on: impl Fn() -> Result<()>,
    ) -> Result<()> {
        let mut random = stream(seed, "synth/motifs", 0);
        let kinds = units.kinds();
        for &(unit, map, first) in &self.wholes {
            go_on()?;
            let copies = units.kind(unit).and_then(|kind| kinds.get(&kind)).map_or(&[][..], Vec::as_slice);
            let Ok(own) = copies.binary_search(&unit) else { continue };
            if copies.len() < 2 {
                continue;
            }
            let [a, b, c, d, ..] = map.as_coeffs();
            let deviations = |random: &mut Stream| -> Vec<Vec2> {
                let part = share * random.unit();
                // Any copy but this one.
                let other = random.index(copies.len() - 1);
                let all = units.deviations(unit, copies[other + usize::from(other >= own)]);
                all.iter().map(|v| part * Vec2::new(a * v.x + c * v.y, b * v.x + d * v.y)).collect()
            };
            let tried: Vec<Vec<Vec2>> = (0..TRIES).map(|_| deviations(&mut random)).collect();
            let parts = first..first + units.parts[unit].len();
            canvas.move_parts(&mut self.placed[parts], first, &tried);
        }
        Ok(())
    }
}

/// Distances that the parts of a motif keep from each other, the largest that they have, in units of that between
/// elements.
const APART: [f64; 3] = [1.0, 0.5, 0.0];

impl OccupiedCanvas<'_> {
    /// Moves the parts of a motif, of which the first is the element number `first`, by the first of the
    /// vectors `tried` with which all fit.
    fn move_parts(&mut self, parts: &mut [DrawnElement], first: usize, tried: &[Vec<Vec2>]) {
        if parts.iter().any(|p| self.zone(p) != 0) || tried.iter().flatten().all(|v| v.hypot() < LEAST) {
            return;
        }
        self.take(parts, first);
        let apart = APART.into_iter().find(|&apart| {
            let fit = self.lay(parts, first, apart);
            if fit {
                self.take(parts, first);
            }
            fit
        });
        for by in tried {
            let moved =
                |(p, by): (&DrawnElement, &Vec2)| DrawnElement { map: Affine::translate(*by) * p.map, ..*p };
            let new: Vec<DrawnElement> = parts.iter().zip(by).map(moved).collect();
            let fit = new.iter().all(|p| self.zone(p) == 0 && self.fits(p, 1.0))
                && apart.is_none_or(|apart| self.lay(&new, first, apart));
            if fit {
                parts.copy_from_slice(&new);
                break;
            }
        }
        parts.iter().enumerate().for_each(|(k, p)| self.write(p, number(first, k), 0));
    }

    /// Puts parts on the canvas one after another, if each is at least so far apart from what is there.
    fn lay(&mut self, parts: &[DrawnElement], first: usize, apart: f64) -> bool {
        for (k, part) in parts.iter().enumerate() {
            if !self.fits(part, apart) {
                self.take(&parts[..k], first);
                return false;
            }
            self.write(part, number(first, k), 0);
        }
        true
    }

    /// Takes parts off the canvas.
    fn take(&mut self, parts: &[DrawnElement], first: usize) {
        parts.iter().enumerate().for_each(|(k, p)| self.write(p, 0, number(first, k)));
    }
}

/// The number on the canvas of a part of the motif whose first part is the element number `first`.
fn number(first: usize, part: usize) -> u32 {
    (first + part) as u32 + 1
}
