//! Values of an exemplar's pixels, copied along a correspondence field.

use crate::correspondence::CorrespondenceField;
use vtex_base::parallel;

/// A correspondence field over the pixels of a canvas and of its exemplar.
pub struct Carrier<'a, P> {
    /// The field.
    pub field: &'a CorrespondenceField,
    /// Side of a cell of the exemplar, in pixels.
    pub cell: usize,
    /// Width and height of a cell of the canvas, in pixels. Cells at the right and lower edge may reach beyond it.
    pub pitch: [f64; 2],
    /// Cells beside the canvas, left and above.
    pub margin: [usize; 2],
    /// Size of the canvas, in pixels.
    pub canvas: [usize; 2],
    /// The index of the exemplar's pixel at a pixel of a page; `None` if there is none.
    pub pixel: P,
}

/// How a sample continues a cell near it, along one axis.
#[derive(Clone, Copy)]
struct NearbyCell {
    /// Index of the cell.
    cell: usize,
    /// Place of the sample, in cells from where the cell begins.
    away: f64,
    weight: f32,
}

impl<'a, P: Fn(usize, [i64; 2]) -> Option<usize> + Sync> Carrier<'a, P> {
    /// A field from an exemplar of one page that fills the canvas exactly: cells are slightly smaller where their size
    /// does not divide it.
    pub(super) fn filling(field: &'a CorrespondenceField, cell: usize, canvas: [usize; 2], pixel: P) -> Self {
        let pitch = [0, 1].map(|k| canvas[k] as f64 / field.size[k] as f64);
        Self { field, cell, pitch, margin: [0; 2], canvas, pixel }
    }

    /// Planes of the exemplar, sampled on a grid over the canvas. Each sample is the mean over the cells
    /// within `reach`, each continued from its source and weighted by a Gaussian of `sigma` cells.
    pub(super) fn voted(
        &self,
        planes: &[Vec<f32>],
        grid: [usize; 2],
        reach: i64,
        sigma: f64,
    ) -> Vec<Vec<f32>> {
        let nearby = |k: usize| -> Vec<Vec<NearbyCell>> {
            (0..grid[k]).map(|g| self.nearby(k, (g as f64 + 0.5) / grid[k] as f64, reach, sigma)).collect()
        };
        let [columns, rows] = [nearby(0), nearby(1)];
        let count = planes.len();
        let mut voted = vec![0f32; grid[0] * grid[1] * count];
        parallel::for_chunks(&mut voted, grid[0] * count, |gy, row| {
            for (column, out) in columns.iter().zip(row.chunks_mut(count)) {
                let mut total = 0.0;
                for (across, down) in column.iter().flat_map(|c| rows[gy].iter().map(move |r| (c, r))) {
                    let source = self.field.sources[down.cell * self.field.size[0] + across.cell];
                    let [u, v] = source.at.map(f64::from);
                    let cell = self.cell as f64;
                    let place = [whole((u + across.away) * cell), whole((v + down.away) * cell)];
                    let Some(pixel) = (self.pixel)(usize::from(source.page), place) else { continue };
                    let weight = across.weight * down.weight;
                    out.iter_mut().zip(planes).for_each(|(out, plane)| *out += weight * plane[pixel]);
                    total += weight;
                }
                if total > 0.0 {
                    out.iter_mut().for_each(|v| *v /= total);
                }
            }
        });
        (0..count).map(|c| voted.iter().skip(c).step_by(count).copied().collect()).collect()
    }

    /// The cells near a place of the canvas, given as a share of its side, across seams but not beyond borders.
    fn nearby(&self, axis: usize, share: f64, reach: i64, sigma: f64) -> Vec<NearbyCell> {
        let (pitch, margin) = (self.pitch[axis], self.margin[axis] as f64);
        let (count, side) = (self.field.size[axis] as i64, self.canvas[axis] as f64);
        let at = share * side;
        let own = libm::floor(at / pitch + margin) as i64;
        let of = |there: i64| {
            let turns = if self.field.wrap[axis] { there.div_euclid(count) } else { 0 };
            let cell = there - turns * count;
            let begins = (cell as f64 - margin) * pitch + turns as f64 * side;
            let away = (at - begins) / pitch;
            let off = away - 0.5;
            let weight = libm::exp(-off * off / (2.0 * sigma * sigma)) as f32;
            (0..count).contains(&cell).then_some(NearbyCell { cell: cell as usize, away, weight })
        };
        (own - reach..=own + reach).filter_map(of).collect()
    }
}

/// The largest integer that is not above `v`.
fn whole(v: f64) -> i64 {
    let towards_zero = v as i64;
    towards_zero - i64::from(towards_zero as f64 > v)
}

/// The index of a pixel of the only page, which is an exemplar of `size` pixels.
pub(super) fn pixel_of(size: [usize; 2]) -> impl Fn(usize, [i64; 2]) -> Option<usize> {
    move |_, [x, y]| {
        let is_inside = (0..size[0] as i64).contains(&x) && (0..size[1] as i64).contains(&y);
        is_inside.then(|| y as usize * size[0] + x as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::CellSource;

    /// A field of 4 × 3 cells of 5 pixels that copies an exemplar of 20 × 15 pixels, moved by a cell.
    fn moved(wrap: bool) -> CorrespondenceField {
        let source = |i: usize| CellSource { page: 0, at: [((i % 4 + 1) % 4) as u16, (i / 4) as u16] };
        CorrespondenceField { size: [4, 3], wrap: [wrap, false], sources: (0..12).map(source).collect() }
    }

    /// The field over a canvas, in cells of 5 pixels.
    fn over<P>(field: &CorrespondenceField, canvas: [usize; 2], pixel: P) -> Carrier<'_, P> {
        Carrier { field, cell: 5, pitch: [5.0; 2], margin: [0; 2], canvas, pixel }
    }

    #[test]
    fn a_field_that_moves_the_exemplar_copies_its_pixels() {
        let field = moved(false);
        let carrier = over(&field, [20, 15], pixel_of([20, 15]));
        let plane: Vec<f32> = (0..300).map(|i| (i % 20) as f32).collect();
        let copied = carrier.voted(&[plane], [20, 15], 0, 1.0).swap_remove(0);
        // Away from the cell where the exemplar ends.
        let is_moved = |x: usize| (copied[x] - (x + 5) as f32).abs() < 1e-3;
        assert!((0..14).all(is_moved), "{copied:?}");
    }

    #[test]
    fn cells_continue_across_a_seam() {
        let field = moved(true);
        // The last column of cells reaches beyond the canvas by two pixels.
        let carrier = over(&field, [18, 15], pixel_of([20, 15]));
        let near = carrier.nearby(0, 0.5 / 18.0, 1, 1.0);
        let found: Vec<(usize, f64)> = near.iter().map(|n| (n.cell, n.away * 5.0)).collect();
        assert_eq!(found, [(3, 3.5), (0, 0.5), (1, -4.5)]);
    }

    #[test]
    fn whole_numbers_are_below() {
        let of = [-2.0, -1.2, -0.0, 0.0, 0.9, 7.0, 7.3].map(whole);
        assert_eq!(of, [-2, -2, 0, 0, 0, 7, 7]);
    }
}
