//! New maps around a sketch.
//!
//! Borders are optimised on cells, which are wider than a thin stroke. Pixels take over how far a border
//! moved from where it was painted, at most by a share of the half width of the stroke there and of the gap
//! beside it. So strokes of any width keep their place.

use super::boundary::outlined;
use super::carried::LayerExemplar;
use super::map::{LayerMap, LayerRegion};
use super::optimised::{covered, soft_depth};
use super::regions::{Depths, around, depth};
use std::collections::VecDeque;
use vtex_base::error::{Error, Result};
use vtex_base::progress::Progress;
use vtex_base::raster::check_size;

/// Distance by which a border may leave its painted place, as a share of the half width of what it bounds.
const SHARE: f32 = 0.2;
/// A cell is painted if one of so many pixels is: a stroke narrower than a cell has no gaps.
const PARTS: usize = 8;

impl LayerExemplar<'_> {
    /// Makes a map around a sketch, which has labels where it is painted. Painted shapes keep their place
    /// and area and get borders like the exemplar's. Lower layers surround them as widely as in the
    /// exemplar, and the bottom layer fills the rest (the paper, fig. 12).
    ///
    /// # Errors
    /// [`Error::Control`] if nothing is painted above the bottom layer, or the map has one layer;
    /// [`Error::Interrupted`].
    pub fn sketched(
        &self,
        sketch: &[Option<u32>],
        size: [usize; 2],
        wrap: [bool; 2],
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<LayerMap> {
        self.check()?;
        check_size(size)?;
        let count = self.map.layers.len();
        if sketch.len() != size[0] * size[1] || sketch.iter().flatten().all(|&l| l == 0) {
            return Err(Error::Control {
                name: "the sketch".into(),
                role: "a sketch of layers",
                reason: "nothing is painted in the colour of a layer above the bottom one".into(),
                advice: "paint strokes in the colours of the layers on a transparent or white background",
            });
        }
        let cells = size.map(|v| v.div_ceil(self.cell()));
        let painted: Vec<LayerRegion> =
            (1..count).map(|k| covered(sketch, size, (cells, PARTS), wrap, k as u32)).collect();
        let made = outlined(&self.regions(), &painted, seed, progress)?;
        let regions: Vec<SketchedRegion> = (1..count)
            .map(|k| SketchedRegion {
                pixels: LayerRegion {
                    size,
                    wrap,
                    inside: sketch.iter().map(|l| l.is_some_and(|l| l as usize >= k)).collect(),
                },
                painted: &painted[k - 1],
                made: &made[k - 1],
                is_top: painted.get(k).is_none_or(|above| above.area() == 0),
            })
            .collect();
        let planes = regions.iter().map(SketchedRegion::depths).collect();
        let areas: Vec<f64> = regions.iter().map(SketchedRegion::share).collect();
        let shares = of_layers(&areas);
        let depths = Depths { size, wrap, grid: size, planes };
        Ok(self.map.with(depths.labels(&shares, self.most_distant(), 0)))
    }
}

/// The share of each layer, from those of the regions from S_1 up.
fn of_layers(regions: &[f64]) -> Vec<f64> {
    let share = |k: usize| if k == 0 { 1.0 } else { regions.get(k - 1).copied().unwrap_or(0.0) };
    (0..=regions.len()).map(|k| (share(k) - share(k + 1)).max(0.0)).collect()
}

/// A region of a sketch.
struct SketchedRegion<'a> {
    /// Painted pixels of its layer and those above.
    pixels: LayerRegion,
    /// The same, by cell.
    painted: &'a LayerRegion,
    /// What became of it, by cell.
    made: &'a LayerRegion,
    /// Whether no layer above it is painted.
    is_top: bool,
}

impl SketchedRegion<'_> {
    /// Its share of the canvas, 0 to 1: that of its pixels, and what its cells gained around a region above.
    fn share(&self) -> f64 {
        let of = |region: &LayerRegion| region.area() as f64 / region.inside.len() as f64;
        let gained = if self.is_top { 0.0 } else { of(self.made) - of(self.painted) };
        (of(&self.pixels) + gained).clamp(0.0, 1.0)
    }

    /// The depth of each pixel of the canvas. A region that surrounds another is as wide as its cells.
    fn depths(&self) -> Vec<f32> {
        let LayerRegion { size, wrap, .. } = self.pixels;
        let grid = self.made.size;
        let cell = (size[0] as f32 / grid[0] as f32).min(size[1] as f32 / grid[1] as f32);
        let made = soft_depth(self.made);
        let moved: Vec<f32> = made.iter().zip(soft_depth(self.painted)).map(|(to, from)| to - from).collect();
        let canvas = Depths { size, wrap, grid, planes: Vec::new() };
        let own = depth(&self.pixels);
        let most = most_moved(&own, size, wrap);
        let moved = canvas.enlarged(&moved);
        let kept = (0..own.len()).map(|i| own[i] + (cell * moved[i]).clamp(-most[i], most[i]));
        if self.is_top {
            return kept.collect();
        }
        kept.zip(canvas.enlarged(&made)).map(|(kept, made)| kept.max(cell * made)).collect()
    }
}

/// How far a border may move at each pixel, by the depths in a region: a share of the half width of the region, and
/// outside also of that of the gap.
fn most_moved(depths: &[f32], size: [usize; 2], wrap: [bool; 2]) -> Vec<f32> {
    let widths = half_widths(depths, size, wrap);
    let mut most: Vec<f32> =
        widths.iter().zip(depths).map(|(w, &d)| if d > 0.0 { SHARE * w } else { 0.0 }).collect();
    let mut rim: VecDeque<usize> =
        (0..depths.len()).filter(|&i| depths[i] > 0.0 && depths[i] < 1.0).collect();
    let mut seen: Vec<bool> = depths.iter().map(|&d| d > 0.0).collect();
    while let Some(i) = rim.pop_front() {
        for j in around(i, size, wrap).into_iter().flatten() {
            if !seen[j] && -depths[j] <= most[i] {
                seen[j] = true;
                most[j] = most[i];
                rim.push_back(j);
            }
        }
    }
    let outside = (0..depths.len()).filter(|&i| depths[i] <= 0.0);
    outside.for_each(|i| most[i] = most[i].min(SHARE * widths[i]));
    most
}

/// The half width of what each pixel lies in, the region or a gap: the depth at the end of the steepest way from the
/// border, without its sign.
fn half_widths(depths: &[f32], size: [usize; 2], wrap: [bool; 2]) -> Vec<f32> {
    let deeper = |i: usize| {
        let side = |j: usize| if (depths[i] > 0.0) == (depths[j] > 0.0) { depths[j].abs() } else { 0.0 };
        let mut best = (i, depths[i].abs());
        let beside = around(i, size, wrap);
        let rows = [Some(i), beside[2], beside[3]].into_iter().flatten();
        let of_row = |row: usize| {
            let [left, right, ..] = around(row, size, wrap);
            [Some(row), left, right].into_iter().flatten()
        };
        for j in rows.flat_map(of_row) {
            if side(j) > best.1 {
                best = (j, side(j));
            }
        }
        best.0
    };
    let mut ends = vec![usize::MAX; depths.len()];
    let mut way = Vec::new();
    for start in 0..depths.len() {
        let mut i = start;
        while ends[i] == usize::MAX {
            way.push(i);
            let next = deeper(i);
            if next == i {
                ends[i] = i;
            }
            i = next;
        }
        let end = ends[i];
        way.drain(..).for_each(|i| ends[i] = end);
    }
    ends.into_iter().map(|end| depths[end].abs()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::map::{Contacts, MapLayer};
    use super::super::names::named;
    use super::super::testing::nested as painted;
    use super::*;
    use vtex_base::raster::colour::Colour;

    fn exemplar(side: usize) -> LayerMap {
        let layers: Vec<MapLayer> = named(&(0..3).map(|k| Colour([40 + 60 * k, 90, 60])).collect::<Vec<_>>());
        LayerMap { labels: painted([side, side], 3, 2), layers }
    }

    /// A wave and a straight line of a width, in a square of a side.
    fn strokes(side: usize, width: f64) -> Vec<bool> {
        let s = side as f64;
        let wave: Vec<[f64; 2]> = (0..400)
            .map(|k| {
                [s * (0.15 + 0.7 * f64::from(k) / 400.0), s * (0.6 + 0.2 * libm::sin(f64::from(k) / 60.0))]
            })
            .collect();
        let inside = |i: usize| {
            let at = [(i % side) as f64 + 0.5, (i / side) as f64 + 0.5];
            let near = |p: &[f64; 2]| libm::hypot(at[0] - p[0], at[1] - p[1]) < width / 2.0;
            (at[1] - 0.15 * s).abs() < width / 2.0 && at[0] > 0.1 * s || wave.iter().any(near)
        };
        (0..side * side).map(inside).collect()
    }

    #[test]
    fn strokes_of_any_width_are_kept_and_surrounded() {
        // Cells are four pixels wide.
        let map = exemplar(512);
        for width in [3.0, 6.0, 12.0, 30.0, 50.0] {
            let stroke = strokes(300, width);
            let sketch: Vec<Option<u32>> = stroke.iter().map(|&s| s.then_some(2)).collect();
            let made = LayerExemplar { map: &map, photograph: None }
                .sketched(&sketch, [300, 300], [false; 2], 1, &())
                .unwrap();
            let top = |i: usize| made.labels.labels[i] == 2;
            let both = (0..90_000).filter(|&i| top(i) && stroke[i]).count() as f64;
            let either = (0..90_000).filter(|&i| top(i) || stroke[i]).count() as f64;
            assert!(both / either >= 0.8, "{width}: {}", both / either);
            let contacts = Contacts::new(&made.labels, 3, [false; 2]);
            assert!(contacts.between(0, 1) > 0 && contacts.between(1, 2) > 0);
            let distant = contacts.distant();
            assert!(distant < 0.02, "{width}: {distant}");
        }
        let nothing = vec![None; 90_000];
        let refused =
            LayerExemplar { map: &map, photograph: None }.sketched(&nothing, [300, 300], [false; 2], 1, &());
        assert!(matches!(refused, Err(Error::Control { .. })));
    }

    #[test]
    fn half_widths_are_those_of_strokes_and_gaps() {
        // Columns 0 to 9 and 16 to 39 are painted; the last 20 repeat into the first.
        let size = [60, 12];
        let inside = (0..720).map(|i| i % 60 < 10 || (16..40).contains(&(i % 60))).collect();
        let region = LayerRegion { size, wrap: [true; 2], inside };
        let widths = half_widths(&depth(&region), size, [true; 2]);
        for (x, half) in [(0, 5.0), (9, 5.0), (11, 3.0), (15, 3.0), (20, 12.0), (39, 12.0), (50, 10.0)] {
            assert!((widths[x] - half).abs() <= 0.5, "{x}: {}", widths[x]);
        }
    }
}
