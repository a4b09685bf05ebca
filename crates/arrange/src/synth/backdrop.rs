//! The colour of an exemplar's background at any place.
//!
//! The library samples the background about every twenty-five pixels, away from all elements. The part of
//! the photograph that elements and samples leave unexplained is added block by block, so that soft clouds
//! and stains keep their contrast.

use vtex_base::geometry::wrapped;
use vtex_scene::library::{ExemplarElement, Library};
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Field, Tile};

/// Least share of background in a block that is corrected.
const LEAST: f64 = 0.15;
/// Least share of a block's background over which the unexplained part is spread. On a few bare pixels
/// between secondaries it would give colours that the photograph does not have.
const BARE: f64 = 0.6;
/// Largest correction of a component.
const MOST: f64 = 25.0;

/// The background of an exemplar.
pub(super) struct Backdrop {
    sites: Interpolant,
    /// Side of a block, in pixels.
    side: f64,
    blocks: [usize; 2],
    /// The correction of each block, by component.
    added: Vec<[f64; 3]>,
    wrap: bool,
}

/// The part of a background to model: all of it, or one stratum.
pub(super) struct BackgroundPart<'a> {
    /// Colours sampled there.
    pub(super) field: &'a Field,
    /// Whether a pixel belongs to it.
    pub(super) holds: &'a dyn Fn(u32, u32) -> bool,
    /// The secondaries on it.
    pub(super) secondaries: Vec<&'a ExemplarElement>,
}

impl Backdrop {
    /// Models a part of the background of a library's exemplar.
    pub(super) fn new(library: &Library, part: &BackgroundPart<'_>) -> Self {
        let (width, height) = (library.source.width, library.source.height);
        let sites = Interpolant::new(part.field, width, height, Tile::default());
        let side = part.field.spacing.max(8.0);
        let blocks = [width, height].map(|v| (f64::from(v) / side) as usize + 1);
        let wrap = library.arrangement.periodic;
        let mut this = Self { sites, side, blocks, added: vec![[0.0; 3]; blocks[0] * blocks[1]], wrap };
        this.added = this.unexplained(library, part);
        this
    }

    /// The colour at a place of the exemplar, by sRGB component.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let mut colour = self.sites.at(x, y);
        let added = self.added_at([x, y]);
        (0..3).for_each(|c| colour[c] += added[c]);
        colour
    }

    /// The correction at a place, interpolated between blocks.
    fn added_at(&self, at: [f64; 2]) -> [f64; 3] {
        let axis = |k: usize| {
            let v = at[k] / self.side - 0.5;
            let (first, share) = (libm::floor(v), v - libm::floor(v));
            let block = |v: f64| self.block(v as i64, k);
            [(block(first), 1.0 - share), (block(first + 1.0), share)]
        };
        let mut sum = [0.0; 3];
        for (row, v) in axis(1) {
            for (column, u) in axis(0) {
                let added = &self.added[row * self.blocks[0] + column];
                (0..3).for_each(|c| sum[c] += u * v * added[c]);
            }
        }
        sum
    }

    /// Index of a block column or row, clamped or wrapped at the border.
    fn block(&self, v: i64, k: usize) -> usize {
        let count = self.blocks[k] as i64;
        (if self.wrap { v.rem_euclid(count) } else { v.clamp(0, count - 1) }) as usize
    }

    /// Index of the block at a place.
    fn block_at(&self, at: [f64; 2]) -> usize {
        let [column, row] = [0, 1].map(|k| self.block(libm::floor(at[k] / self.side) as i64, k));
        row * self.blocks[0] + column
    }

    /// For each block the mean of the photograph's background minus that of secondaries and samples,
    /// limited by the bare background; smoothed, because secondaries lie across blocks.
    fn unexplained(&self, library: &Library, part: &BackgroundPart<'_>) -> Vec<[f64; 3]> {
        let Some(guide) = &library.guide else { return self.added.clone() };
        let mut photo = vec![[0.0; 4]; self.added.len()];
        let cell = f64::from(guide.cell);
        for (column, row, colour) in guide.picture.0.enumerate_pixels() {
            let at = [column, row].map(|v| (f64::from(v) + 0.5) * cell);
            let [x, y] = at.map(|v| v as u32);
            if x < library.source.width && y < library.source.height && (part.holds)(x, y) {
                let sum = &mut photo[self.block_at(at)];
                (0..3).for_each(|c| sum[c] += cell * cell * f64::from(colour.0[c]));
                sum[3] += cell * cell;
            }
        }
        let mut covered = vec![[0.0; 4]; self.added.len()];
        for s in &part.secondaries {
            let (sum, area) = (&mut covered[self.block_at(s.centroid)], f64::from(s.area));
            (0..3).for_each(|c| sum[c] += area * f64::from(s.colour.0[c]));
            sum[3] += area;
        }
        // Adjacent blocks have a weight of a quarter each.
        let smooth = |sums: &[[f64; 4]], block: usize| {
            let (column, row) = ((block % self.blocks[0]) as i64, (block / self.blocks[0]) as i64);
            let mut sum = sums[block];
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
                let beside = self.block(row + dy, 1) * self.blocks[0] + self.block(column + dx, 0);
                (0..4).for_each(|c| sum[c] += 0.25 * sums[beside][c]);
            }
            sum
        };
        let whole = 2.0 * self.side * self.side;
        let size = [library.source.width, library.source.height].map(f64::from);
        (0..photo.len())
            .map(|block| {
                let (photo, covered) = (smooth(&photo, block), smooth(&covered, block));
                if photo[3] < LEAST * whole {
                    return [0.0; 3];
                }
                let middle = [block % self.blocks[0], block / self.blocks[0]];
                let middle = [0, 1].map(|k| {
                    let v = (middle[k] as f64 + 0.5) * self.side;
                    if self.wrap { wrapped(v, Some(size[k])) } else { v.min(size[k]) }
                });
                let field = self.sites.at(middle[0], middle[1]);
                let bare = (photo[3] - covered[3]).max(0.0);
                let receiving = bare.max(BARE * photo[3]);
                [0, 1, 2].map(|c| ((photo[c] - covered[c] - bare * field[c]) / receiving).clamp(-MOST, MOST))
            })
            .map(|v| if v.iter().all(|v| v.is_finite()) { v } else { [0.0; 3] })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_scene::library::testing::{guided, mosaic};

    #[test]
    fn the_background_has_the_colours_of_the_guide() {
        // The palette of the library knows two grey values; the guide's background is darker on the left.
        let map = mosaic(200, 15.0, 0.6, 1);
        let library = guided(&map).without_secondaries();
        let part = BackgroundPart {
            field: &library.background(),
            holds: &|x, y| map.get(x, y) == 0,
            secondaries: Vec::new(),
        };
        let backdrop = Backdrop::new(&library, &part);
        let (left, right) = (backdrop.at([20.0, 100.0])[0], backdrop.at([180.0, 100.0])[0]);
        let known = |x: f64| 40.0 + x * 60.0 / 200.0;
        // Both are right, or farther from the palette than the largest correction.
        for (found, x) in [(left, 20.0), (right, 180.0)] {
            let palette = backdrop.sites.at(x, 100.0)[0];
            let wanted = known(x).max(palette - MOST);
            assert!((found - wanted).abs() < 6.0, "{found} {wanted}");
        }
    }
}
