//! Stroked lines of a periodic page, and the test whether a line that leaves the page continues on lines at
//! the opposite border.

use super::clip::page;
use super::paint::DrawnPaint;
use super::pieces::{DrawingPiece, PieceShape};
use super::read::DrawnStroke;
use kurbo::{Line, ParamCurveNearest};
use std::collections::BTreeMap;
use vtex_base::geometry::{BezPath, PathEl, Point, wrapped};

/// Cells along a side of the page.
const CELLS: f64 = 128.0;
/// Cells beyond the page that are included.
const BEYOND: i64 = 2;
/// Largest distance of a line from a drawn one that it repeats, in widths of its stroke.
const NEAR: f64 = 0.2;
/// Finest steps along lines, as a share of the page's larger side.
const FINEST: f64 = 3e-4;
/// Most steps along lines that are stored, and most comparisons of a place with a line. Beyond these no line
/// counts as continued.
const MOST_STEPS: usize = 20_000_000;
const MOST_COMPARED: usize = 30_000_000;

/// The straight lines of all stroked pieces, by the cells of the page that they cross.
pub(super) struct Lines<'a> {
    size: [f64; 2],
    cell: f64,
    pieces: &'a [DrawingPiece],
    /// The lines and their pieces.
    lines: Vec<(Line, usize)>,
    cells: BTreeMap<[i64; 2], Vec<u32>>,
    /// Remaining steps and comparisons.
    steps: usize,
    left: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(size: [f64; 2], pieces: &'a [DrawingPiece]) -> Self {
        let cell = size[0].max(size[1]) / CELLS;
        let (steps, left) = (MOST_STEPS, MOST_COMPARED);
        let mut all = Self { size, cell, pieces, lines: Vec::new(), cells: BTreeMap::new(), steps, left };
        for (k, piece) in pieces.iter().enumerate() {
            if let Some((path, stroke, _)) = stroked(piece) {
                all.add(k, path, all.step(stroke));
            }
        }
        if all.steps == 0 {
            all.left = 0;
        }
        all
    }

    /// Length of the steps along a stroke.
    fn step(&self, stroke: &DrawnStroke) -> f64 {
        (stroke.width / 4.0).max(FINEST * self.size[0].max(self.size[1]))
    }

    fn add(&mut self, piece: usize, path: &BezPath, step: f64) {
        let reach = page(self.size).inflate(self.cell, self.cell);
        each_line(path, step, |line| {
            let number = self.lines.len() as u32;
            let mut last = None;
            for p in steps(line, self.cell / 2.0).take(self.steps) {
                self.steps -= 1;
                if !reach.contains(p) {
                    continue;
                }
                let cell = self.cell_of(p);
                if last != Some(cell) {
                    self.cells.entry(cell).or_default().push(number);
                }
                last = Some(cell);
            }
            if last.is_some() {
                self.lines.push((line, piece));
            }
        });
    }

    fn cell_of(&self, p: Point) -> [i64; 2] {
        [p.x, p.y].map(|v| libm::floor(v / self.cell) as i64)
    }

    /// Whether a stroked piece that leaves the page coincides at the other side with lines of its own paint,
    /// so that its copies draw the same picture as the page.
    pub(super) fn continues(&mut self, piece: &DrawingPiece) -> bool {
        let Some((path, stroke, paint)) = stroked(piece) else { return false };
        let step = self.step(stroke);
        let inside = page(self.size);
        let mut found = true;
        each_line(path, step, |line| {
            let near = NEAR * stroke.width.max(step);
            let mut outside = steps(line, step).filter(|p| !inside.contains(*p));
            found = found && outside.all(|p| self.is_drawn(p, near, paint));
        });
        found
    }

    /// Whether a line of a paint is drawn within `reach` of a place, after the place is wrapped onto the
    /// page.
    fn is_drawn(&mut self, p: Point, reach: f64, paint: &DrawnPaint) -> bool {
        let p = Point::new(wrapped(p.x, Some(self.size[0])), wrapped(p.y, Some(self.size[1])));
        let [x, y] = self.cell_of(p);
        // Steps lie within a quarter of a cell of any place of their line.
        let around = libm::ceil(reach / self.cell + 0.25) as i64;
        let cells = |at: i64| (at - around).max(-BEYOND)..=(at + around).min(CELLS as i64 + BEYOND);
        for v in cells(y) {
            for u in cells(x) {
                self.left = self.left.saturating_sub(1);
                for &number in self.cells.get(&[u, v]).into_iter().flatten() {
                    if self.left == 0 {
                        return false;
                    }
                    self.left -= 1;
                    let (line, piece) = self.lines[number as usize];
                    let near = line.nearest(p, 0.0).distance_sq < reach * reach;
                    if near && self.pieces[piece].parts[0].paint == *paint {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// The line, stroke and paint of a piece that is a single stroked line.
fn stroked(piece: &DrawingPiece) -> Option<(&BezPath, &DrawnStroke, &DrawnPaint)> {
    match &piece.parts[..] {
        [PieceShape { path, paint, stroke: Some(stroke) }] => Some((path, stroke, paint)),
        _ => None,
    }
}

/// The straight lines of a flattened path.
fn each_line(path: &BezPath, step: f64, mut f: impl FnMut(Line)) {
    let (mut start, mut at) = (Point::ORIGIN, Point::ORIGIN);
    kurbo::flatten(path.iter(), step / 10.0, |element| {
        let to = match element {
            PathEl::MoveTo(p) => {
                (start, at) = (p, p);
                return;
            }
            PathEl::LineTo(p) => p,
            _ => start,
        };
        f(Line::new(at, to));
        at = to;
    });
}

/// Places along a line, at most `step` apart, its ends included.
fn steps(line: Line, step: f64) -> impl Iterator<Item = Point> {
    let count = libm::ceil(line.p0.distance(line.p1) / step).clamp(1.0, 1e6) as usize;
    (0..=count).map(move |k| line.p0.lerp(line.p1, k as f64 / count as f64))
}
