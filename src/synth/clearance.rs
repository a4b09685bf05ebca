//! Distance of every cell to the nearest placed texton, kept up to date while textons are added.

use super::sums::Sums;
use super::target::TargetMap;
use crate::sampling::Stream;

/// Steps of the 3-4 chamfer distance (Borgefors 1986), which is in thirds of a pixel.
const STRAIGHT: u8 = 3;
const DIAGONAL: u8 = 4;
/// Side of the blocks whose weights are summed for the draw, in cells.
const BLOCK: i32 = 16;

/// Distances up to a limit, and places drawn in proportion to them.
pub(super) struct Clearance {
    width: i32,
    height: i32,
    /// Chamfer distances, at most `limit`.
    pub(super) distance: Vec<u8>,
    /// Largest distance told apart, in thirds of a pixel.
    pub(super) limit: u8,
    /// Cells within `frame` of the border of the map are not drawn.
    frame: i32,
    blocks: Sums,
    columns: i32,
}

impl Clearance {
    /// Distances on a map, up to `reach` pixels (at most 85).
    pub(super) fn new(map: &TargetMap<'_>, reach: i32, frame: i32) -> Self {
        let limit = (reach.clamp(1, 85) * i32::from(STRAIGHT)) as u8;
        let (width, height) = (map.width, map.height);
        let distance = (0..map.owner.len()).map(|i| if map.taken(i) { 0 } else { limit }).collect();
        let (columns, rows) = ((width + BLOCK - 1) / BLOCK, (height + BLOCK - 1) / BLOCK);
        let blocks = Sums::zeros((columns * rows) as usize);
        let mut clearance = Self { width, height, distance, limit, frame, blocks, columns };
        clearance.spread([0, 0, width, height]);
        clearance
    }

    /// Takes note of a texton added: its cells are at distance 0.
    pub(super) fn add(&mut self, map: &TargetMap<'_>, id: u32) {
        let placed = map.placed[id as usize];
        let shape = &map.model().shapes[placed.primary as usize];
        for &span in shape.mask.spans() {
            self.distance[map.cells(span, placed.at)].fill(0);
        }
        let reach = i32::from(self.limit / STRAIGHT) + 1;
        let [x0, y0, x1, y1] = shape.bounds;
        let [x, y] = placed.at;
        self.spread([
            (x + x0 - reach).clamp(0, self.width),
            (y + y0 - reach).clamp(0, self.height),
            (x + x1 + reach).clamp(0, self.width),
            (y + y1 + reach).clamp(0, self.height),
        ]);
    }

    /// Carries smaller distances on within a box (two passes), then sums its blocks.
    fn spread(&mut self, [x0, y0, x1, y1]: [i32; 4]) {
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        let width = self.width as usize;
        let (left, right) = (x0 as usize, x1 as usize);
        // Row by row, each from the row before it: first what comes from above, which needs no
        // order within the row, then from the side.
        for y in y0..y1 {
            let (before, rest) = self.distance.split_at_mut(y as usize * width);
            let row = &mut rest[left..right];
            if y > 0 {
                let above = &before[before.len() - width..];
                from_row(row, above, left, right);
            }
            for i in 1..row.len() {
                row[i] = row[i].min(row[i - 1].saturating_add(STRAIGHT));
            }
        }
        for y in (y0..y1).rev() {
            let (before, rest) = self.distance.split_at_mut((y as usize + 1) * width);
            let start = before.len() - width;
            let row = &mut before[start + left..start + right];
            if y + 1 < self.height {
                from_row(row, &rest[..width], left, right);
            }
            for i in (1..row.len()).rev() {
                row[i - 1] = row[i - 1].min(row[i].saturating_add(STRAIGHT));
            }
        }
        for by in y0 / BLOCK..=(y1 - 1) / BLOCK {
            for bx in x0 / BLOCK..=(x1 - 1) / BLOCK {
                let sum =
                    self.block_rows(bx, by).map(|(_, _, row)| row.iter().map(|&d| u64::from(d)).sum::<u64>());
                let sum = sum.sum();
                self.blocks.set((by * self.columns + bx) as usize, sum);
            }
        }
    }

    /// The rows of a block that may be drawn: first column, row, distances.
    fn block_rows(&self, bx: i32, by: i32) -> impl Iterator<Item = (i32, i32, &[u8])> {
        let x0 = (bx * BLOCK).max(self.frame);
        let x1 = ((bx + 1) * BLOCK).min(self.width - self.frame).max(x0);
        let y0 = (by * BLOCK).max(self.frame);
        let y1 = ((by + 1) * BLOCK).min(self.height - self.frame);
        (y0..y1).map(move |y| {
            let start = y as usize * self.width as usize;
            (x0, y, &self.distance[start + x0 as usize..start + x1 as usize])
        })
    }

    /// A free cell drawn in proportion to its distance; `None` if there is none.
    pub(super) fn draw(&self, random: &mut Stream) -> Option<[i32; 2]> {
        let block = self.blocks.draw(random)? as i32;
        let mut left = random.below(self.blocks.get(block as usize));
        for (x0, y, row) in self.block_rows(block % self.columns, block / self.columns) {
            for (x, &d) in (x0..).zip(row) {
                if left < u64::from(d) {
                    return Some([x, y]);
                }
                left -= u64::from(d);
            }
        }
        None
    }
}

/// Distances carried on from the neighbouring row to the columns `left..right`.
fn from_row(row: &mut [u8], other: &[u8], left: usize, right: usize) {
    for (d, o) in row.iter_mut().zip(&other[left..right]) {
        *d = (*d).min(o.saturating_add(STRAIGHT));
    }
    let skip = usize::from(left == 0);
    for (d, o) in row[skip..].iter_mut().zip(&other[left + skip - 1..]) {
        *d = (*d).min(o.saturating_add(DIAGONAL));
    }
    for (d, o) in row.iter_mut().zip(&other[(left + 1).min(right)..(right + 1).min(other.len())]) {
        *d = (*d).min(o.saturating_add(DIAGONAL));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;
    use crate::synth::model::Model;
    use crate::synth::testing::{library, mosaic};

    #[test]
    fn kept_up_to_date_as_if_made_anew() {
        let library = library(&mosaic(100, 14.0, 0.8, 1));
        let model = Model::new(&library);
        let placeable: Vec<u32> = model.members.iter().flatten().copied().collect();
        let mut random = stream(1, "clearance test", 0);
        let mut map = TargetMap::new(&model, 90, 70);
        let mut clearance = Clearance::new(&map, 12, 4);
        for _ in 0..12 {
            let at = [random.index(map.width as usize) as i32, random.index(map.height as usize) as i32];
            let id = map.stand(placeable[random.index(placeable.len())], at);
            clearance.add(&map, id);
            let anew = Clearance::new(&map, 12, 4);
            assert!(clearance.distance == anew.distance);
            for block in 0..(clearance.columns * ((map.height + BLOCK - 1) / BLOCK)) as usize {
                assert_eq!(clearance.blocks.get(block), anew.blocks.get(block));
            }
            for _ in 0..20 {
                let [x, y] = clearance.draw(&mut random).unwrap();
                assert!(!map.taken(map.index(x, y)));
            }
        }
        // Near the true distance (within the error of the chamfer, 8 %).
        let squared =
            crate::raster::squared_distance(map.width as usize, map.height as usize, |i| map.taken(i));
        for (i, &d) in clearance.distance.iter().enumerate() {
            let (got, true_one) = (f64::from(d) / 3.0, f64::from(libm::sqrtf(squared[i])).min(12.0));
            assert!((got - true_one).abs() <= 0.09 * true_one + 0.34, "{got} {true_one}");
        }
    }
}
