//! Figures as pixels, to measure by how much they overlap.

use crate::figures::Figure;
use vtex_base::geometry::Interior;
use vtex_base::raster::{Mask, Span};

/// The pixels of a figure around its reference point, row by row.
#[derive(Debug)]
pub(crate) struct FigurePixels {
    /// First and last row plus one, first and last column plus one.
    pub(crate) rows: [i32; 2],
    pub(crate) columns: [i32; 2],
    /// The runs of row y are `runs[starts[y - rows[0]]..]`, up to the start of the next.
    starts: Vec<u32>,
    runs: Vec<[i32; 2]>,
    pub(crate) area: u32,
}

impl FigurePixels {
    fn new(mask: &Mask) -> Self {
        let (x0, y0, x1, y1) = mask.bounds().unwrap_or_default();
        let mut starts = vec![0u32; (y1 - y0) as usize + 1];
        mask.spans().iter().for_each(|s| starts[(s.y - y0) as usize + 1] += 1);
        for y in 1..starts.len() {
            starts[y] += starts[y - 1];
        }
        let runs = mask.spans().iter().map(|s| [s.x0, s.x1]).collect();
        Self { rows: [y0, y1], columns: [x0, x1], starts, runs, area: mask.area() }
    }

    /// The runs of a row, first and last column plus one of each.
    pub(crate) fn runs_of(&self, y: i32) -> &[[i32; 2]] {
        let k = (y - self.rows[0]) as usize;
        &self.runs[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Whether the bounds of two figures overlap, the other one moved.
    fn meets(&self, other: &Self, by: [i32; 2]) -> bool {
        let [dx, dy] = by;
        self.columns[0] < other.columns[1] + dx
            && other.columns[0] + dx < self.columns[1]
            && self.rows[0] < other.rows[1] + dy
            && other.rows[0] + dy < self.rows[1]
    }

    /// Pixels within bounds: first and last column plus one, first and last row plus one.
    pub(crate) fn area_within(&self, columns: [i32; 2], rows: [i32; 2]) -> u32 {
        let within = self.rows[0].max(rows[0])..self.rows[1].min(rows[1]);
        let runs = within.flat_map(|y| self.runs_of(y));
        runs.map(|run| (run[1].min(columns[1]) - run[0].max(columns[0])).max(0) as u32).sum()
    }

    /// Pixels that two figures share, the other one moved.
    pub(crate) fn overlap(&self, other: &Self, by: [i32; 2]) -> u32 {
        if !self.meets(other, by) {
            return 0;
        }
        let mut sum = 0;
        for y in self.rows[0].max(other.rows[0] + by[1])..self.rows[1].min(other.rows[1] + by[1]) {
            let (a, b) = (self.runs_of(y), other.runs_of(y - by[1]));
            let (mut i, mut j) = (0, 0);
            while i < a.len() && j < b.len() {
                let [x0, x1] = [a[i][0].max(b[j][0] + by[0]), a[i][1].min(b[j][1] + by[0])];
                sum += (x1 - x0).max(0) as u32;
                if a[i][1] < b[j][1] + by[0] { i += 1 } else { j += 1 }
            }
        }
        sum
    }
}

/// Largest side of a figure that is drawn, in pixels.
const LARGEST: f64 = 4000.0;

/// The pixels whose middles lie in a figure.
fn mask(figure: &Figure) -> Mask {
    let mut spans = Vec::new();
    for outline in &figure.outlines {
        let (interior, b) = (Interior::new(outline), outline.bounds());
        let [y0, y1] = [b.y0.max(-LARGEST), b.y1.min(LARGEST)];
        for y in libm::floor(y0) as i32..libm::ceil(y1) as i32 {
            let first = |x: f64| libm::ceil(x.clamp(-LARGEST, LARGEST) - 0.5) as i32;
            let row = interior.intervals(f64::from(y) + 0.5).into_iter();
            spans.extend(row.map(|[a, b]| Span { y, x0: first(a), x1: first(b) }));
        }
    }
    let mask = Mask::from_spans(spans);
    if !mask.is_empty() {
        return mask;
    }
    // A figure smaller than a pixel.
    let middle = figure.bounds().center();
    let [x, y] = [middle.x, middle.y].map(|v| libm::floor(v.clamp(-LARGEST, LARGEST)) as i32);
    Mask::from_spans(vec![Span { y, x0: x, x1: x + 1 }])
}

/// The pixels of a figure, and those up to `clearance` pixels around it.
pub(crate) fn pixels(figure: &Figure, clearance: f64) -> [FigurePixels; 2] {
    let own = mask(figure);
    let reach = libm::floor(clearance) as i32;
    let mut spans = Vec::new();
    for dy in -reach..=reach {
        let beside = libm::floor(libm::sqrt(clearance * clearance - f64::from(dy * dy))) as i32;
        spans.extend(own.spans().iter().map(|s| Span { y: s.y + dy, x0: s.x0 - beside, x1: s.x1 + beside }));
    }
    [FigurePixels::new(&own), FigurePixels::new(&Mask::from_spans(spans))]
}
