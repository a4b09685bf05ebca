//! Secondaries copied with their islands.
//!
//! A secondary is placed where the cell of its origin is copied to, so islands keep their secondaries whole
//! and the number of secondaries needs no correction. At the borders of islands, secondaries are added of
//! which a large part was copied but not the origin.

use super::Correspondence;
use crate::arrange::model::PlacementModel;
use std::sync::OnceLock;
use vtex_base::geometry::{Interior, Point};
use vtex_scene::library::{ExemplarElement, Library};

/// Least copied share of a secondary whose origin's cell was not copied.
const LEAST_COPIED: f64 = 0.4;
/// Side of the buckets in which secondaries are sought, in pixels.
const BUCKET: i32 = 8;

/// A secondary of a library at a place of the canvas, before it has a colour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SecondaryPlace {
    /// Its index in its library.
    pub(crate) secondary: u32,
    /// Place of its origin on the canvas, in pixels.
    pub(crate) at: [i32; 2],
    /// Index of its variation in the model.
    pub(crate) variation: u16,
}

/// A secondary on a page.
struct PageSecondary {
    /// Row and column of the cell of its origin.
    cell: (u16, u16),
    secondary: u32,
    /// Place of its origin within the cell.
    within: [i32; 2],
}

/// A place at which a cell of the canvas shows a part of a secondary.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct SecondaryVote {
    secondary: u32,
    /// Place of its origin on the canvas, in pixels.
    at: [i32; 2],
    /// Index of the page that it is copied from.
    page: usize,
}

impl Correspondence {
    /// The copied secondaries of a library, with the places of their origins on the canvas. Each is placed
    /// where the cell of its origin was copied to, so islands keep their secondaries whole and the number of
    /// secondaries is the exemplar's. At the borders of islands, secondaries are added of which a large part
    /// was copied but not the origin.
    pub(crate) fn secondaries(
        &self,
        library: &Library,
        number: usize,
        model: &PlacementModel,
    ) -> Vec<SecondaryPlace> {
        let cell = self.pages.cell;
        let mut placed = Vec::new();
        let on_page: Vec<Vec<PageSecondary>> = (0..self.pages.sheets.len())
            .map(|k| {
                let own = self.pages.sheets[k].library == number;
                if own { self.on_page(library, k, model) } else { Vec::new() }
            })
            .collect();
        let [w, h] = self.field.size;
        for y in 0..h {
            for x in 0..w {
                let source = self.field.sources[y * w + x];
                let page = usize::from(source.page);
                let key = (source.at[1], source.at[0]);
                let first = on_page[page].partition_point(|s| s.cell < key);
                for s in on_page[page][first..].iter().take_while(|s| s.cell == key) {
                    let at = [0, 1].map(|k| ([x, y][k] as i32 - self.margin[k]) * cell + s.within[k]);
                    placed.push(self.copied_secondary(page, s.secondary, at));
                }
            }
        }
        let without = self.copied_without_origin(library, number, model, &placed);
        placed.extend(without);
        placed
    }

    fn copied_secondary(&self, page: usize, secondary: u32, at: [i32; 2]) -> SecondaryPlace {
        SecondaryPlace { secondary, at, variation: self.pages.sheets[page].variation }
    }

    /// The secondaries of a page by the cells of their origins.
    fn on_page(&self, library: &Library, page: usize, model: &PlacementModel) -> Vec<PageSecondary> {
        let (sheet, cell) = (&self.pages.sheets[page], self.pages.cell);
        let size = self.pages.pages[page].size;
        let mut on_page = Vec::new();
        for (k, s) in library.secondaries().iter().enumerate() {
            sheet.copies(model, s.origin(), size.map(|v| v as i32 * cell), |at| {
                let within = at.map(|v| v.rem_euclid(cell));
                on_page.push(PageSecondary {
                    cell: ((at[1] / cell) as u16, (at[0] / cell) as u16),
                    secondary: k as u32,
                    within,
                });
            });
        }
        on_page.sort_unstable_by_key(|s| (s.cell, s.secondary));
        on_page
    }

    /// Secondaries at the borders of islands of which enough was copied, but not the cell of the origin.
    /// Without them seams would be bare where secondaries tile the background.
    fn copied_without_origin(
        &self,
        library: &Library,
        number: usize,
        model: &PlacementModel,
        placed: &[SecondaryPlace],
    ) -> Vec<SecondaryPlace> {
        let cell = self.pages.cell;
        let shapes = SecondaryShapes::new(library);
        let mut votes: Vec<SecondaryVote> = Vec::new();
        let [w, h] = self.field.size;
        for y in 0..h {
            for x in 0..w {
                let page = usize::from(self.field.sources[y * w + x].page);
                let sheet = &self.pages.sheets[page];
                if sheet.library != number || !self.is_seam([x, y]) {
                    continue;
                }
                let canvas = [0, 1].map(|k| ([x, y][k] as i32 - self.margin[k]) * cell + cell / 2);
                let (_, there) = self.source(canvas);
                let Some(place) = sheet.exemplar(model, there) else { continue };
                for secondary in shapes.at(library, place) {
                    let own = library.secondaries()[secondary as usize].origin();
                    let own = sheet.on_page(model, own, there);
                    let at = [0, 1].map(|k| canvas[k] + own[k] - there[k]);
                    votes.push(SecondaryVote { secondary, at, page });
                }
            }
        }
        votes.sort_unstable();
        let mut known: Vec<(u32, [i32; 2])> = placed.iter().map(|p| (p.secondary, p.at)).collect();
        known.sort_unstable();
        let is_added = |votes: &&[SecondaryVote]| {
            let SecondaryVote { secondary, at, .. } = votes[0];
            let area = covered(&library.secondaries()[secondary as usize]);
            let enough = votes.len() as f64 * f64::from(cell * cell) >= LEAST_COPIED * area;
            enough && known.binary_search(&(secondary, at)).is_err()
        };
        let groups = votes.chunk_by(|a, b| a == b).filter(is_added);
        groups.map(|v| self.copied_secondary(v[0].page, v[0].secondary, v[0].at)).collect()
    }

    /// Whether another island is within two cells of a cell.
    fn is_seam(&self, [x, y]: [usize; 2]) -> bool {
        let [w, h] = self.field.size;
        let own = self.field.sources[y * w + x];
        let continues = |dx: i64, dy: i64| {
            let (u, v) = (x as i64 + dx, y as i64 + dy);
            if u < 0 || v < 0 || u >= w as i64 || v >= h as i64 {
                return true;
            }
            let other = self.field.sources[v as usize * w + u as usize];
            other.page == own.page
                && i64::from(other.at[0]) - i64::from(own.at[0]) == dx
                && i64::from(other.at[1]) - i64::from(own.at[1]) == dy
        };
        ![(-2, 0), (2, 0), (0, -2), (0, 2), (-1, -1), (1, -1), (-1, 1), (1, 1)]
            .iter()
            .all(|&(dx, dy)| continues(dx, dy))
    }
}

/// The number of pixels on which a secondary is found; a spot covers more than it paints.
fn covered(secondary: &ExemplarElement) -> f64 {
    if secondary.base().is_soft() { secondary.outline().area() } else { f64::from(secondary.area) }
}

/// The shapes of an exemplar's secondaries, by place.
struct SecondaryShapes {
    columns: i32,
    rows: i32,
    /// Secondaries whose boxes touch each bucket.
    buckets: Vec<Vec<u32>>,
    /// Computed on first use.
    regions: Vec<OnceLock<Interior>>,
}

impl SecondaryShapes {
    fn new(library: &Library) -> Self {
        let [columns, rows] = [library.source.width, library.source.height].map(|v| v as i32 / BUCKET + 1);
        let mut buckets = vec![Vec::new(); (columns * rows) as usize];
        for (k, s) in library.secondaries().iter().enumerate() {
            let b = s.outline().bounds();
            let range = |low: f64, high: f64, count: i32| {
                let bucket = |v: f64| (libm::floor(v) as i32 / BUCKET).clamp(0, count - 1);
                bucket(low)..=bucket(high)
            };
            for row in range(b.y0, b.y1, rows) {
                for column in range(b.x0, b.x1, columns) {
                    buckets[(row * columns + column) as usize].push(k as u32);
                }
            }
        }
        let regions = library.secondaries().iter().map(|_| OnceLock::new()).collect();
        Self { columns, rows, buckets, regions }
    }

    /// The secondaries on a pixel of the exemplar: all spots, and a patch.
    fn at<'a>(&'a self, library: &'a Library, [x, y]: [i32; 2]) -> impl Iterator<Item = u32> + 'a {
        let (column, row) = ((x / BUCKET).clamp(0, self.columns - 1), (y / BUCKET).clamp(0, self.rows - 1));
        let middle = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let mut has_patch = false;
        let holds = move |&k: &u32| {
            let outline = library.secondaries()[k as usize].outline();
            self.regions[k as usize].get_or_init(|| Interior::new(outline)).contains(middle)
        };
        self.buckets[(row * self.columns + column) as usize].iter().copied().filter(holds).filter(move |&k| {
            let is_spot = library.secondaries()[k as usize].base().is_soft();
            is_spot || !std::mem::replace(&mut has_patch, true)
        })
    }
}
