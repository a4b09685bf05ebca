//! Converts the logits of a prompt to a mask: threshold, connected piece, stability, pixels.
//!
//! The outline is the zero crossing of the interpolated logits. Analysis later moves outlines to where the
//! image has its edges.

use super::{Logits, PromptMask};
use crate::segment::similar::Measured;
use std::sync::OnceLock;
use vtex_base::raster::{Connectivity, Mask, Span, components_of_mask};

/// Offsets ±1 of the threshold at which the stability of a mask is measured.
const STABILITY_OFFSET: f32 = 1.0;
/// Logit that replaces those of other pieces.
const FAR: f32 = -8.0;

/// A mask given by a prompt, in the cells of its logits.
#[derive(Clone, Debug)]
pub(super) struct Proposal {
    /// The cells, in a grid that starts at the corner of the image.
    pub(super) cells: Measured,
    /// The logits around the cells.
    pub(super) logits: Logits,
    pub(super) predicted_iou: f32,
    /// Stability: area at the raised threshold over area at the lowered threshold, 0 to 1.
    pub(super) stability: f32,
    /// Number of prompts that gave this mask or a duplicate of it.
    pub(super) votes: u32,
    /// Its pixels, computed on first use.
    pub(super) pixels: OnceLock<Mask>,
}

impl Proposal {
    /// The piece of a prompt's mask that contains the point; `None` if there is none.
    pub(super) fn new(point: [f32; 2], mask: &PromptMask) -> Option<Self> {
        let l = &mask.logits;
        let (w, h) = (l.width, l.height);
        let cell = |axis: usize| libm::floorf((point[axis] - l.origin[axis]) / l.step[axis]);
        let (px, py) = (cell(0), cell(1));
        if !(px >= 0.0 && py >= 0.0 && px < w as f32 && py < h as f32) {
            return None;
        }
        let start = py as usize * w + px as usize;
        if l.values.len() != w * h || l.values[start] <= 0.0 || l.values[start].is_nan() {
            return None;
        }
        let mut inside = vec![false; w * h];
        inside[start] = true;
        let (mut stack, mut x0, mut x1, mut y0, mut y1) = (vec![start], w, 0, h, 0);
        while let Some(i) = stack.pop() {
            let (x, y) = (i % w, i / w);
            (x0, x1, y0, y1) = (x0.min(x), x1.max(x + 1), y0.min(y), y1.max(y + 1));
            let mut visit = |j: usize| {
                if l.values[j] > 0.0 && !inside[j] {
                    inside[j] = true;
                    stack.push(j);
                }
            };
            if x > 0 {
                visit(i - 1)
            }
            if x + 1 < w {
                visit(i + 1)
            }
            if y > 0 {
                visit(i - w)
            }
            if y + 1 < h {
                visit(i + w)
            }
        }
        // Cells from the corner of the image to the corner of the grid.
        let offset = |axis: usize| libm::roundf(l.origin[axis] / l.step[axis]) as i32;
        let (dx, dy) = (offset(0), offset(1));
        let mut spans = Vec::new();
        let (mut firm, mut loose) = (0u32, 0u32);
        for y in y0..y1 {
            let mut x = x0;
            while x < x1 {
                let from = x;
                while x < x1 && inside[y * w + x] {
                    x += 1;
                }
                if x > from {
                    let (x0, x1) = (from as i32 + dx, x as i32 + dx);
                    spans.push(Span { y: y as i32 + dy, x0, x1 });
                }
                x += usize::from(x < x1 && !inside[y * w + x]);
            }
            for x in x0..x1 {
                let value = l.values[y * w + x];
                firm += u32::from(inside[y * w + x] && value > STABILITY_OFFSET);
                loose += u32::from(value > -STABILITY_OFFSET);
            }
        }
        Some(Self {
            cells: Measured::new(Mask::from_spans(spans))?,
            logits: cut_out(l, &inside, [x0, y0, x1, y1]),
            predicted_iou: mask.predicted_iou,
            stability: firm as f32 / loose.max(1) as f32,
            votes: 1,
            pixels: OnceLock::new(),
        })
    }

    pub(super) fn score(&self) -> f32 {
        self.predicted_iou * self.stability
    }

    /// Area in pixels of the image.
    pub(super) fn area(&self) -> f32 {
        self.cells.area as f32 * self.logits.step[0] * self.logits.step[1]
    }
}

impl Logits {
    /// The pixels of an image of the given size, reduced by the factor `by`, whose centres have positive
    /// interpolated logits. Only the largest connected piece is kept.
    pub(super) fn rasterise(&self, by: f32, width: u32, height: u32) -> Mask {
        let [origin, step] = [self.origin, self.step].map(|v| v.map(|v| v * by));
        let end = |axis: usize, n: usize, most: u32| {
            (libm::ceilf(origin[axis] + step[axis] * n as f32).max(0.0) as u32).min(most)
        };
        let begin = |axis: usize| libm::floorf(origin[axis]).max(0.0) as u32;
        let between = |axis: usize, n: usize, pixel: u32| between(origin[axis], step[axis], n, pixel);
        let (x0, x1, y1) = (begin(0), end(0, self.width, width), end(1, self.height, height));
        let columns: Vec<Between> = (x0..x1).map(|x| between(0, self.width, x)).collect();
        let mut spans: Vec<Span> = Vec::new();
        for y in begin(1)..y1 {
            let (above, below, v) = between(1, self.height, y);
            let [above, below] = [above, below].map(|row| &self.values[row * self.width..][..self.width]);
            let mut open: Option<Span> = None;
            for (x, &(left, right, u)) in (x0 as i32..).zip(&columns) {
                let along = |row: &[f32]| row[left] * (1.0 - u) + row[right] * u;
                let inside = along(above) * (1.0 - v) + along(below) * v > 0.0;
                match &mut open {
                    Some(span) if inside => span.x1 = x + 1,
                    None if inside => open = Some(Span { y: y as i32, x0: x, x1: x + 1 }),
                    _ => spans.extend(open.take()),
                }
            }
            spans.extend(open);
        }
        let pieces = components_of_mask(&Mask::from_spans(spans), Connectivity::Four);
        // Ties go to the first.
        pieces.into_iter().rev().max_by_key(Mask::area).unwrap_or_default()
    }
}

/// The two of `n` cells between whose centres the centre of a pixel lies, and the second one's share.
fn between(origin: f32, step: f32, n: usize, pixel: u32) -> Between {
    let t = ((pixel as f32 + 0.5 - origin) / step - 0.5).clamp(0.0, (n - 1) as f32);
    let i = (t as usize).min(n.saturating_sub(2));
    (i, (i + 1).min(n - 1), t - i as f32)
}

/// Two cells, and the share of the second.
type Between = (usize, usize, f32);

/// The logits of a box and two cells around it. Those of other pieces are set far below 0.
fn cut_out(l: &Logits, inside: &[bool], [x0, y0, x1, y1]: [usize; 4]) -> Logits {
    let (left, top) = (x0.saturating_sub(2), y0.saturating_sub(2));
    let (right, bottom) = ((x1 + 2).min(l.width), (y1 + 2).min(l.height));
    let mut values = Vec::with_capacity((right - left) * (bottom - top));
    for y in top..bottom {
        for x in left..right {
            let i = y * l.width + x;
            values.push(if inside[i] || l.values[i] <= 0.0 { l.values[i] } else { FAR });
        }
    }
    let origin = [l.origin[0] + l.step[0] * left as f32, l.origin[1] + l.step[1] * top as f32];
    Logits { origin, step: l.step, width: right - left, height: bottom - top, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Logits of a disc, falling by 1 a pixel, on a grid of the given step.
    fn disc(centre: [f32; 2], radius: f32, step: f32, side: usize) -> PromptMask {
        let mut values = Vec::new();
        for j in 0..side {
            for i in 0..side {
                let (x, y) = ((i as f32 + 0.5) * step - centre[0], (j as f32 + 0.5) * step - centre[1]);
                values.push(radius - (x * x + y * y).sqrt());
            }
        }
        let logits = Logits { origin: [0.0; 2], step: [step; 2], width: side, height: side, values };
        PromptMask { predicted_iou: 0.9, logits }
    }

    #[test]
    fn pixels_follow_the_zero_crossing_between_cells() {
        for step in [1.0, 2.0, 4.0] {
            let p =
                Proposal::new([30.0, 31.0], &disc([30.3, 31.7], 12.4, step, (64.0 / step) as usize)).unwrap();
            let area = p.logits.rasterise(1.0, 64, 64).area() as f32;
            let truth = std::f32::consts::PI * 12.4 * 12.4;
            assert!((area - truth).abs() < 0.03 * truth, "step {step}: {area} of {truth}");
        }
    }

    #[test]
    fn only_the_piece_under_the_point_is_taken() {
        let (mut a, b) = (disc([12.0, 12.0], 6.0, 1.0, 48), disc([34.0, 34.0], 8.0, 1.0, 48));
        for (v, w) in a.logits.values.iter_mut().zip(&b.logits.values) {
            *v = v.max(*w);
        }
        let piece = Proposal::new([33.0, 30.0], &a).unwrap().logits.rasterise(1.0, 48, 48);
        assert!(piece.contains(34, 34) && !piece.contains(12, 12));
        assert!(Proposal::new([22.5, 22.5], &a).is_none());
        assert!(Proposal::new([-3.0, 5.0], &a).is_none());
    }

    #[test]
    fn soft_masks_are_less_stable() {
        let hard = disc([24.0, 24.0], 10.0, 1.0, 48);
        let mut soft = hard.clone();
        soft.logits.values.iter_mut().for_each(|v| *v *= 0.3);
        let stability = |m: &PromptMask| Proposal::new([24.0, 24.0], m).unwrap().stability;
        assert!(stability(&soft) < stability(&hard));
    }
}
