//! What synthesis derives from a library once: masks around their origins, the exemplar's runs,
//! and which textons may be placed.

use crate::library::Library;
use crate::raster::{LabelMap, Mask, Span};

/// A cell of which nothing is known.
pub(super) const UNDEFINED: u16 = u16::MAX;
/// A cell that should hold no primary.
pub(super) const EMPTY: u16 = 0;

/// The shape of a primary.
pub(super) struct Shape {
    /// Its pixels, relative to the origin.
    pub(super) mask: Mask,
    /// Its centroid in the exemplar, rounded to whole pixels.
    pub(super) origin: [i32; 2],
    /// Box around its pixels relative to the origin: x0, y0, x1, y1, ends exclusive.
    pub(super) bounds: [i32; 4],
    /// Number of pixels.
    pub(super) area: u32,
    /// Its category.
    pub(super) category: usize,
    /// Its category as a cell of the target map; [`EMPTY`] if the category cannot be placed.
    pub(super) code: u16,
    /// Whole, so it may be placed anew.
    pub(super) placeable: bool,
}

/// A library made ready for placement.
pub(super) struct Model {
    /// One for each primary.
    pub(super) shapes: Vec<Shape>,
    /// Primaries of each category that may be placed.
    pub(super) members: Vec<Vec<u32>>,
    /// Half the side of descriptors, in pixels.
    pub(super) half: i32,
    /// Largest distance of a placeable pixel from its origin along an axis, in pixels.
    pub(super) reach: i32,
    /// Wanted share of the canvas, each category; zero where nothing can be placed.
    pub(super) wanted: Vec<f64>,
    exemplar: Runs,
}

/// The exemplar's arrangement as runs by row.
struct Runs {
    width: i32,
    height: i32,
    wrap: bool,
    /// Index of each row's first run.
    rows: Vec<u32>,
    /// End (exclusive) and label of each run.
    runs: Vec<(i32, u32)>,
}

impl Runs {
    fn new(map: &LabelMap, wrap: bool) -> Self {
        let mut rows = vec![0];
        let mut runs = Vec::new();
        for y in 0..map.height {
            let mut x = 0;
            for run in map.row(y).chunk_by(|a, b| a == b) {
                x += run.len() as i32;
                runs.push((x, run[0]));
            }
            rows.push(runs.len() as u32);
        }
        Self { width: map.width as i32, height: map.height as i32, wrap, rows, runs }
    }

    /// Calls `visit(x0, x1, label)` for the runs of row `y` within `from..to`.
    fn row(&self, y: i32, from: i32, to: i32, mut visit: impl FnMut(i32, i32, u32)) {
        let (row, first, last) = if self.wrap {
            let last = (to - 1).div_euclid(self.width);
            (y.rem_euclid(self.height), from.div_euclid(self.width), last)
        } else if (0..self.height).contains(&y) {
            (y, 0, 0)
        } else {
            return;
        };
        let runs = &self.runs[self.rows[row as usize] as usize..self.rows[row as usize + 1] as usize];
        for tile in first..=last {
            let shift = tile * self.width;
            let (low, high) = ((from - shift).max(0), (to - shift).min(self.width));
            let mut x = low;
            let start = runs.partition_point(|r| r.0 <= low);
            for &(end, label) in &runs[start..] {
                if x >= high {
                    break;
                }
                let end = end.min(high);
                visit(x + shift, end + shift, label);
                x = end;
            }
        }
    }
}

impl Model {
    /// From a library.
    pub(super) fn new(library: &Library) -> Self {
        let map = library.arrangement.to_labels();
        let (width, height) = (map.width as i32, map.height as i32);
        let wrap = library.source.parameters.wrap;
        let masks = Mask::all_of_labels(&map, library.primaries.len() + 1);
        let mut shapes: Vec<Shape> = library
            .primaries
            .iter()
            .zip(&masks[1..])
            .map(|(p, mask)| {
                let origin = p.centroid.map(|v| libm::round(v) as i32);
                let mask = relative(mask, origin, wrap.then_some([width, height]));
                let bounds = mask.bounds().map_or([0; 4], |b| [b.0, b.1, b.2, b.3]);
                let (area, placeable) = (mask.area(), !p.clipped && !mask.is_empty());
                Shape {
                    mask,
                    origin,
                    bounds,
                    area,
                    category: usize::from(p.category.0),
                    code: EMPTY,
                    placeable,
                }
            })
            .collect();
        let mut members = vec![Vec::new(); library.categories.len()];
        for (i, s) in shapes.iter().enumerate().filter(|(_, s)| s.placeable) {
            members[s.category].push(i as u32);
        }
        for s in &mut shapes {
            if !members[s.category].is_empty() && s.category < usize::from(UNDEFINED - 1) {
                s.code = s.category as u16 + 1;
            }
        }
        let reach = shapes.iter().filter(|s| s.placeable).flat_map(|s| s.bounds.map(i32::abs)).max();
        Self {
            half: library.descriptor_half as i32,
            reach: reach.unwrap_or(0),
            wanted: wanted(library, &members),
            exemplar: Runs::new(&map, wrap),
            shapes,
            members,
        }
    }

    /// Calls `visit(y, x0, x1, label)` for the runs of the window around a primary, relative to
    /// its origin; outside the exemplar there are none.
    pub(super) fn window(&self, primary: u32, mut visit: impl FnMut(i32, i32, i32, u32)) {
        let [ox, oy] = self.shapes[primary as usize].origin;
        for y in -self.half..=self.half {
            self.exemplar.row(oy + y, ox - self.half, ox + self.half + 1, |x0, x1, label| {
                visit(y, x0 - ox, x1 - ox, label);
            });
        }
    }

    /// Placeable textons per pixel of the exemplar.
    pub(super) fn density(&self) -> f64 {
        let count = self.members.iter().map(Vec::len).sum::<usize>();
        count as f64 / (f64::from(self.exemplar.width) * f64::from(self.exemplar.height))
    }
}

/// A mask around an origin; on a torus, every pixel where it is nearest to it.
pub(super) fn relative(mask: &Mask, origin: [i32; 2], torus: Option<[i32; 2]>) -> Mask {
    let Some([w, h]) = torus else { return mask.shifted(-origin[0], -origin[1]) };
    let near = |v: i32, size: i32| (v + size / 2).rem_euclid(size) - size / 2;
    let pixel = |(x, y): (i32, i32)| {
        let x = near(x - origin[0], w);
        Span { y: near(y - origin[1], h), x0: x, x1: x + 1 }
    };
    Mask::from_spans(mask.pixels().map(pixel).collect())
}

/// Share of the canvas wanted of each category. What belongs to categories that cannot be placed
/// goes to the others, as far as that changes none of them by more than a tenth.
fn wanted(library: &Library, members: &[Vec<u32>]) -> Vec<f64> {
    let share = |c: usize| if members[c].is_empty() { 0.0 } else { library.categories[c].coverage };
    let possible: f64 = (0..members.len()).map(share).sum();
    let factor = if possible > 0.0 { (library.coverage / possible).clamp(0.5, 1.1) } else { 0.0 };
    (0..members.len()).map(|c| share(c) * factor).collect()
}
