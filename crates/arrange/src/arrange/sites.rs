//! Points scattered over the canvas; each owns the places nearest to it.

use super::grid::Grid;
use vtex_base::sampling::{Area, Stream, poisson_disk};
use vtex_scene::scene::Tile;

/// Points in square buckets, for look-ups of near points. Positions are whole pixels.
pub(crate) struct Buckets {
    side: f64,
    low: [i32; 2],
    columns: usize,
    rows: usize,
    /// Where each bucket begins in `items`; one more entry than buckets.
    start: Vec<u32>,
    items: Vec<u32>,
}

impl Buckets {
    pub(crate) fn new(points: &[[i32; 2]], side: f64) -> Self {
        let side = side.max(1.0);
        let fold = |c: usize, f: fn(i32, i32) -> i32| points.iter().map(|p| p[c]).reduce(f).unwrap_or(0);
        let low = [0, 1].map(|c| fold(c, i32::min));
        let count = |c: usize| (f64::from(fold(c, i32::max) - low[c]) / side) as usize + 1;
        let (columns, rows) = (count(0), count(1));
        let mut buckets = Self {
            side,
            low,
            columns,
            rows,
            start: vec![0; columns * rows + 1],
            items: vec![0; points.len()],
        };
        // Counting sort keeps the order of the points within a bucket.
        let of: Vec<usize> = points.iter().map(|&p| buckets.bucket(p)).collect();
        for &b in &of {
            buckets.start[b + 1] += 1;
        }
        for b in 0..columns * rows {
            buckets.start[b + 1] += buckets.start[b];
        }
        let mut next = buckets.start.clone();
        for (i, &b) in of.iter().enumerate() {
            buckets.items[next[b] as usize] = i as u32;
            next[b] += 1;
        }
        buckets
    }

    fn column_row(&self, p: [i32; 2]) -> [i64; 2] {
        [0, 1].map(|c| libm::floor(f64::from(p[c] - self.low[c]) / self.side) as i64)
    }

    fn bucket(&self, p: [i32; 2]) -> usize {
        let [column, row] = self.column_row(p);
        row as usize * self.columns + column as usize
    }

    /// Calls `visit` with every point in the buckets within `reach` buckets of that of `p`.
    pub(crate) fn near(&self, p: [i32; 2], reach: i64, mut visit: impl FnMut(u32)) {
        let [column, row] = self.column_row(p);
        let range =
            |centre: i64, count: usize| (centre - reach).max(0)..(centre + reach + 1).min(count as i64);
        for r in range(row, self.rows) {
            for c in range(column, self.columns) {
                let b = r as usize * self.columns + c as usize;
                self.items[self.start[b] as usize..self.start[b + 1] as usize].iter().for_each(|&i| visit(i));
            }
        }
    }
}

fn distance2(a: [i32; 2], b: [i32; 2]) -> i64 {
    let [dx, dy] = [0, 1].map(|c| i64::from(a[c] - b[c]));
    dx * dx + dy * dy
}

/// Points of the canvas; each owns the places nearest to it.
pub(crate) struct Sites {
    /// The sites, then their copies on the other sides of seams.
    centres: Vec<[i32; 2]>,
    /// Index of the original site of each copy.
    copied: Vec<usize>,
    buckets: Buckets,
}

impl Sites {
    /// Sites about `radius` pixels apart on a canvas that may repeat. Queried points must lie within twice
    /// the radius of the canvas.
    pub(crate) fn new(mut centres: Vec<[i32; 2]>, radius: f64, canvas: [f64; 2], tile: Tile) -> Self {
        let mut copied = Vec::new();
        let shifts = |wrap: bool, size: f64| {
            let most = if wrap { libm::ceil(4.0 * radius / size) as i32 } else { 0 };
            (-most..=most).map(move |k| k * size as i32)
        };
        for i in 0..centres.len() {
            for dy in shifts(tile.y, canvas[1]) {
                for dx in shifts(tile.x, canvas[0]) {
                    let copy = [centres[i][0] + dx, centres[i][1] + dy];
                    let near = |k: usize| {
                        let v = f64::from(copy[k]);
                        v >= -4.0 * radius && v <= canvas[k] + 4.0 * radius
                    };
                    if [dx, dy] != [0, 0] && near(0) && near(1) {
                        centres.push(copy);
                        copied.push(i);
                    }
                }
            }
        }
        let buckets = Buckets::new(&centres, radius);
        Self { centres, copied, buckets }
    }

    /// The sites, without copies.
    pub(crate) fn centres(&self) -> &[[i32; 2]] {
        &self.centres[..self.centres.len() - self.copied.len()]
    }

    /// The site that is nearest to a point, itself or by a copy.
    pub(crate) fn owner(&self, p: [i32; 2]) -> Option<usize> {
        let (nearest, count) = (self.nearest(p), self.centres().len());
        if nearest < count { Some(nearest) } else { self.copied.get(nearest - count).copied() }
    }

    /// The cell of a site: the points nearer to it than to any other site or copy within twice the radius.
    /// Ties go to the first site.
    pub(crate) fn cell(&self, site: usize) -> VoronoiCell {
        let centre = self.centres[site];
        let mut others = Vec::new();
        self.buckets.near(centre, 4, |i| {
            if i as usize != site {
                let place = self.centres[i as usize];
                others.push((distance2(centre, place), i as usize, place));
            }
        });
        others.sort_unstable();
        VoronoiCell { site, centre, others }
    }

    /// Index of the site or copy nearest to a point, of those within two buckets; ties go to the first.
    /// Copies come after all sites.
    fn nearest(&self, p: [i32; 2]) -> usize {
        let mut best = (i64::MAX, usize::MAX);
        self.buckets.near(p, 2, |i| {
            best = best.min((distance2(self.centres[i as usize], p), i as usize));
        });
        best.1
    }

    /// Whether a site lies within `radius` pixels, at most that of the sites, of a point.
    pub(crate) fn any_within(&self, p: [i32; 2], radius: f64) -> bool {
        let mut found = false;
        self.buckets.near(p, 1, |i| {
            found |= (distance2(self.centres[i as usize], p) as f64) < radius * radius;
        });
        found
    }
}

/// The cells nearest to one site.
pub(crate) struct VoronoiCell {
    site: usize,
    centre: [i32; 2],
    /// Other sites: squared distance, index, place; the nearest first.
    others: Vec<(i64, usize, [i32; 2])>,
}

impl VoronoiCell {
    /// Whether a point belongs to the site.
    pub(crate) fn owns(&self, p: [i32; 2]) -> bool {
        let own = distance2(self.centre, p);
        // A site more than twice as far from this one as the point is cannot be nearer to it.
        let near = self.others.iter().take_while(|other| other.0 <= 4 * own);
        !near.into_iter().any(|&(_, i, place)| (distance2(place, p), i) < (own, self.site))
    }
}

/// Sites of a Poisson-disk set over the canvas and, beyond borders, `outside` pixels more.
pub(crate) fn scattered(grid: &Grid, radius: f64, outside: f64, random: &mut Stream) -> Sites {
    let (canvas, tile) = (grid.canvas(), grid.tile);
    let margin = [tile.x, tile.y].map(|wrap| if wrap { 0.0 } else { outside });
    let area = Area {
        width: canvas[0] + 2.0 * margin[0],
        height: canvas[1] + 2.0 * margin[1],
        wrap_x: tile.x,
        wrap_y: tile.y,
    };
    let centres = poisson_disk(area, radius, random).into_iter();
    let centres = centres.map(|p| [0, 1].map(|k| libm::floor(p[k] - margin[k]) as i32)).collect();
    Sites::new(centres, radius, canvas, tile)
}
