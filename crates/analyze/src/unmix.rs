//! Removes mixed pixels: those on a border get the colour of the side they are labelled with.
//!
//! A pixel that an outline crosses shows a mixture of both sides. Left in, it becomes a thin crescent along
//! the rim of an element, as a detail or a secondary. Drawing a smooth outline mixes the colours again, so
//! nothing is lost. Edges are still located in the photograph.

use super::grid::{Cells, SubpixelGrid};
use image::{Rgb, RgbImage};
use vtex_base::parallel::{for_chunks, map};
use vtex_base::raster::LabelMap;

/// Largest distance of mixed pixels from a border, in pixels.
const DEPTH: u32 = 2;
/// Radius in which a pixel looks for the unmixed colours of both sides, in pixels.
const REACH: i32 = 3;
/// Least distance of two colours (8-bit steps) whose mixture can be recognised.
const CONTRAST: f32 = 12.0;
/// Least share of its own side's colour in a mixed pixel: the share at the border, and its increase
/// per pixel inwards. A pixel with less is mislabelled rather than mixed, as in a gap between petals.
const LEAST_OWN_SHARE: [f32; 2] = [0.2, 0.3];
/// Largest distance of a mixture from the line between both colours: 8-bit steps, plus this share
/// of the line's length.
const LINE_TOLERANCE: [f32; 2] = [8.0, 0.2];

/// The enlarged image with the mixed cells along label borders replaced.
pub(super) fn unmixed(
    image: &Cells<RgbImage>,
    labels: &Cells<LabelMap>,
    grid: SubpixelGrid,
) -> Cells<RgbImage> {
    let depth = (DEPTH * grid.cells) as u8;
    let rings = rings(labels, depth);
    let around = around(labels.width, grid);
    let mut of_ring = vec![Vec::new(); usize::from(depth) + 1];
    (0..)
        .zip(&rings)
        .filter(|(_, ring)| **ring <= depth)
        .for_each(|(i, &ring)| of_ring[usize::from(ring)].push(i));
    let mut clean = image.0.clone();
    // From the inner rings outwards: cleaned inner cells tell the outer ones their colour.
    for cells in of_ring.into_iter().rev() {
        let place = |i: u32| [i % labels.width, i / labels.width];
        let own =
            map(&cells, |&i| mixture(&clean, labels, &rings, place(i).map(|v| v as i32), &around, grid));
        for (i, own) in cells.into_iter().zip(own) {
            if let Some(own) = own {
                let [x, y] = place(i);
                clean.put_pixel(x, y, own);
            }
        }
    }
    Cells(clean)
}

/// The ring of each cell: 1 at the border of its label, 2 next to a cell of ring 1 of the same label,
/// and so on up to `depth`; `depth + 1` further inside.
fn rings(labels: &LabelMap, depth: u8) -> Vec<u8> {
    let (w, n) = (labels.width as usize, labels.labels.len());
    let all = &labels.labels;
    let beside = |x: usize, i: usize| {
        let there = [(x > 0, 1, 0), (x + 1 < w, 0, 1), (i >= w, w, 0), (i + w < n, 0, w)];
        there.into_iter().filter(|t| t.0).map(move |(_, less, more)| i + more - less)
    };
    let mut rings = vec![depth + 1; n];
    for_chunks(&mut rings, w.max(1), |y, row| {
        for (x, ring) in row.iter_mut().enumerate() {
            if beside(x, y * w + x).any(|j| all[j] != all[y * w + x]) {
                *ring = 1;
            }
        }
    });
    for ring in 2..=depth {
        let before = rings.clone();
        for_chunks(&mut rings, w.max(1), |y, row| {
            for (x, own) in row.iter_mut().enumerate() {
                // Cells of other labels lie only beside those of ring 1.
                if *own > depth && beside(x, y * w + x).any(|j| before[j] == ring - 1) {
                    *own = ring;
                }
            }
        });
    }
    rings
}

/// A pixel near another: steps in cells to the right, down, and along the label map; and its weight.
type Near = ([i32; 2], i32, f32);

/// The pixels up to [`REACH`] away. Nearer ones weigh more.
fn around(width: u32, grid: SubpixelGrid) -> Vec<Near> {
    let steps = (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| [dx, dy]));
    let near = steps.filter_map(|[dx, dy]| {
        let distance2 = dx * dx + dy * dy;
        let [x, y] = [dx, dy].map(|d| d * grid.cells as i32);
        let weight = 1.0 / (distance2 * distance2) as f32;
        (1..=REACH * REACH).contains(&distance2).then_some(([x, y], y * width as i32 + x, weight))
    });
    near.collect()
}

/// The unmixed colour of a cell, or `None` if the cell does not show a mixture of both sides.
fn mixture(
    image: &RgbImage,
    labels: &LabelMap,
    rings: &[u8],
    [x, y]: [i32; 2],
    around: &[Near],
    grid: SubpixelGrid,
) -> Option<Rgb<u8>> {
    let (width, height) = (labels.width as i32, labels.height as i32);
    let at = y * width + x;
    let (own_label, ring) = (labels.labels[at as usize], rings[at as usize]);
    let cells = grid.cells as i32;
    let pixels = image.as_raw().as_chunks::<3>().0;
    let (mut own, mut other) = (Mean::default(), Mean::default());
    let reach = REACH * cells;
    let within = x >= reach && y >= reach && x + reach < width && y + reach < height;
    for &([dx, dy], step, weight) in around {
        let inside = || (0..width).contains(&(x + dx)) && (0..height).contains(&(y + dy));
        if !within && !inside() {
            continue;
        }
        let i = (at + step) as usize;
        if labels.labels[i] == own_label {
            if rings[i] > ring {
                own.add(pixels[i], weight);
            }
        } else if i32::from(rings[i]) > cells {
            other.add(pixels[i], weight);
        }
    }
    let (own, other) = (own.mean()?, other.mean()?);
    let here = image.get_pixel(x as u32, y as u32).0.map(f32::from);
    let line: [f32; 3] = std::array::from_fn(|c| own[c] - other[c]);
    let length2: f32 = line.iter().map(|v| v * v).sum();
    let length = length2.sqrt();
    if length < CONTRAST {
        return None;
    }
    let share = (0..3).map(|c| (here[c] - other[c]) * line[c]).sum::<f32>() / length2;
    let off2: f32 = (0..3).map(|c| here[c] - other[c] - share * line[c]).map(|v| v * v).sum();
    let least = LEAST_OWN_SHARE[0] + LEAST_OWN_SHARE[1] * (f32::from(ring) - 0.5) / cells as f32;
    let mixed = share < 0.98 && share > least && off2.sqrt() < LINE_TOLERANCE[0] + LINE_TOLERANCE[1] * length;
    mixed.then(|| Rgb(own.map(|v| (v + 0.5) as u8)))
}

/// Mean colour of the nearest pixels.
#[derive(Default)]
struct Mean {
    sum: [f32; 3],
    weight: f32,
}

impl Mean {
    fn add(&mut self, colour: [u8; 3], weight: f32) {
        (0..3).for_each(|c| self.sum[c] += weight * f32::from(colour[c]));
        self.weight += weight;
    }

    fn mean(&self) -> Option<[f32; 3]> {
        (self.weight > 0.0).then(|| self.sum.map(|v| v / self.weight))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STONE: [f32; 3] = [180.0, 90.0, 40.0];
    const GROUND: [f32; 3] = [60.0, 70.0, 90.0];

    /// A blurred disc on a plain background, and its labels.
    fn disc(blur: f32) -> (RgbImage, LabelMap) {
        let depth = |x: u32, y: u32| {
            let (dx, dy) = (x as f32 + 0.5 - 20.3, y as f32 + 0.5 - 19.6);
            11.0 - (dx * dx + dy * dy).sqrt()
        };
        let image = RgbImage::from_fn(40, 40, |x, y| {
            let share = (0.5 + depth(x, y) / (2.0 * blur)).clamp(0.0, 1.0);
            Rgb(std::array::from_fn(|c| (GROUND[c] + (STONE[c] - GROUND[c]) * share) as u8))
        });
        let mut labels = LabelMap::filled(40, 40, 0);
        (0..40).for_each(|y| (0..40).for_each(|x| labels.set(x, y, u32::from(depth(x, y) > 0.0))));
        (image, labels)
    }

    #[test]
    fn both_sides_get_their_own_colour() {
        // Enlarged pictures overshoot a little, so a few cells are assigned to the wrong side.
        for (cells, tolerance, few) in [(1, 2.0, 0), (2, 10.0, 10), (3, 10.0, 20)] {
            let grid = SubpixelGrid { cells };
            for blur in [0.5, 1.0, 1.5] {
                let (image, labels) = disc(blur);
                let fine = grid.image(&image);
                let labels = grid.labels(&image, &fine, &labels);
                let off = |picture: &RgbImage| {
                    let wrong = |(x, y, pixel): &(u32, u32, &Rgb<u8>)| {
                        let wanted = if labels.get(*x, *y) == 1 { STONE } else { GROUND };
                        (0..3).any(|c| (f32::from(pixel.0[c]) - wanted[c]).abs() > tolerance)
                    };
                    picture.enumerate_pixels().filter(wrong).count()
                };
                let (before, after) = (off(&fine), off(&unmixed(&fine, &labels, grid)));
                assert!(after <= few && before > 2 * few.max(after), "{cells}, {blur}: {before}, {after}");
            }
        }
    }

    #[test]
    fn what_is_no_mixture_stays() {
        let (mut image, labels) = disc(0.5);
        // A dark line along the rim, darker than both sides.
        let dark = Rgb([5, 5, 5]);
        let rings = rings(&labels, 2);
        for (i, pixel) in image.pixels_mut().enumerate() {
            if rings[i] == 1 && labels.labels[i] == 1 {
                *pixel = dark;
            }
        }
        let clean = unmixed(&Cells(image), &Cells(labels.clone()), SubpixelGrid { cells: 1 });
        let kept = (0..1600).filter(|&i| rings[i] == 1 && labels.labels[i] == 1);
        assert!(kept.clone().count() > 40);
        for i in kept {
            assert_eq!(*clean.get_pixel(i as u32 % 40, i as u32 / 40), dark);
        }
    }
}
