//! Textures of cells that lie side by side with thin joints between, such as mosaics, bricks and stained glass.
//!
//! Patches of the exemplar are laid side by side so that joints go on across their borders, as for curves. Each cell
//! whose middle lies in a patch comes whole. Where cells of two patches overlap or leave a gap, the plane is divided among
//! them anew: each place belongs to the cell that it is deepest in, or nearest to. So no cell is broken, and away from the
//! borders of patches all are as in the exemplar.

use crate::exemplar::{CurveExemplar, CurveStroke};
use crate::graph::CurveGraph;
use crate::initial::{PatchRule, laid};
use crate::input::CurveInput;
use crate::optimise::{LevelScales, canvas, repeated, stretch};
use crate::output::CurveOutput;
use crate::partition::{CellShape, Partition, PartitionTask, PlacedShape};
use crate::trace::{ShownPart, thinned_ring, traced_ring};
use std::collections::BTreeMap;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::geometry::{Affine, BezPath, Point, Rect, Vec2, moved_inwards, opened, signed_area};
use vtex_base::parallel;
use vtex_base::raster::squared_distance;
use vtex_base::sampling::stream;

/// Cells of the grid across half a cell of the exemplar.
const FINE: f64 = 12.0;
/// Most cells of the grid.
const MOST_GRID: f64 = 2e7;
/// Largest share of a cell that others may cover.
const COVERED: f64 = 0.35;
/// Half the width of a gap that another cell fills, in half widths of the middle cell.
const HOLE: f64 = 0.62;
/// Share of a cell below which its part of the plane is left to others.
const REMNANT: f64 = 0.45;
/// How far a cell may grow, in half widths of the middle cell.
const GROWN: f64 = 1.5;
/// Distance of joints that counts as none, in half widths of the middle cell.
const NO_GAP: f64 = 0.02;
/// Share of the borders of a cell that lie where the exemplar has them from which on the cell stays as it is.
const SAME_SHARE: f64 = 0.97;
/// Deviation of the areas of cells, relative to their mean, from which on a drawing is irregular.
const IRREGULAR: f64 = 0.12;
/// Misfit of a patch from elsewhere up to which it is taken: any for irregular drawings; less where joints run on through
/// many cells; in regular ones what is out of step is seen at once.
const CHANGE: f64 = 10.0;
const CHANGE_LINED: f64 = 0.3;
const CHANGE_REGULAR: f64 = 0.04;
/// Length of a joint that runs on, in half widths of the middle cell, and the share of such joints that makes a drawing
/// one of lines.
const LONG: f64 = 16.0;
const LINED: f64 = 0.25;
/// Places tried for a patch, and its longest side in half widths of the middle cell.
const TRIED: usize = 60;
const PATCH: f64 = 7.0;
/// Least radius of the corners of cells that are made to fit, and half the width of the dents that they lose, in half
/// widths of the middle cell.
const ROUND: f64 = 0.02;
const DENT: f64 = 0.1;
/// Cells tried for a gap, and places tried for each along an axis, on either side, with their distance in half widths of
/// the middle cell. The share of a cell that must lie in the gap.
const CANDIDATES: usize = 16;
const PLACES: i64 = 3;
const APART: f64 = 0.25;
const FREE: f64 = 0.7;
/// Halvings of the interval in which the rounding of corners lies.
const BISECTIONS: usize = 8;
/// Distance up to which ends of joints meet, in half widths of the middle cell.
const WELD: f64 = 0.02;

/// A page of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct CellExemplar {
    /// The page.
    pub page: PeriodicPlane,
    /// The cells, as they lie on the page or beyond its border if it repeats.
    pub cells: Vec<CellShape>,
    /// Whether each may come in the result: the border of a page that does not repeat cuts some.
    pub is_whole: Vec<bool>,
}

/// What is to be made of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellParams {
    /// Width and height of the canvas, in the unit of the exemplar.
    pub size: [f64; 2],
    /// The axes along which the canvas repeats without a seam.
    pub tile: [bool; 2],
    /// Seed of all random choices.
    pub seed: u64,
    /// How readily the exemplar is rearranged, 0 to 1. With 0 it goes on as it is wherever it can.
    pub variation: f64,
}

/// A cell of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct QuiltedCell {
    /// The exemplar's cell that it is a copy of.
    pub cell: u32,
    /// The map from the exemplar to the canvas.
    pub map: Affine,
    /// Its outline on the canvas; `None` where it is the exemplar's.
    pub path: Option<BezPath>,
    /// Area of the part on the canvas. Where the page repeats, of all.
    pub shown_area: f64,
}

/// Lengths of a page of cells.
#[derive(Clone, Copy)]
struct CellScale {
    /// Half the width of the middle cell.
    reach: f64,
    /// Side of a cell of the grid.
    step: f64,
    /// Width of the joints, and radius of the cells' corners.
    gap: f64,
    rounding: f64,
    /// Extent of the largest cell.
    largest: f64,
    /// Whether joints run on through many cells.
    is_lined: bool,
}

/// A texture of cells. `go_on` is asked between parts of the work.
///
/// # Errors
/// [`Error::TooLarge`] for too many cells, [`Error::Parameter`] if they have no joints or do not fit on
/// the canvas, and those of `go_on`.
pub fn quilted_cells(
    exemplar: &CellExemplar,
    params: &CellParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<QuiltedCell>> {
    let by = stretch(exemplar.page, params.size, params.tile);
    let own = exemplar.stretched(by);
    let (scale, graph) = own.measured(go_on)?;
    if graph.length() <= 0.0 {
        return Err(Error::Parameter {
            name: "method",
            value: "curves".into(),
            allowed: "for cells that lie side by side; those of this drawing have no joints".into(),
        });
    }
    let scales = LevelScales::new(&graph);
    let coarsest = scales.coarsest();
    let input = CurveInput::alone(&repeated(&graph, 4.5 * coarsest.radius, scales.finest)?, coarsest);
    let plane = canvas(own.page, (params.size, params.tile), coarsest.radius.max(scale.largest));
    scale.check(Large::Canvas, plane)?;
    let change = match own.is_irregular() {
        false => CHANGE_REGULAR,
        true if scale.is_lined => CHANGE_LINED,
        true => CHANGE,
    };
    let change = params.variation * change;
    let side = (2.0 * coarsest.radius).max(PATCH * scale.reach);
    let rule = PatchRule { change, tried: TRIED, is_elsewhere: true, side, seed: params.seed };
    let (_, patches) = laid(&input, CurveOutput::new(plane), rule, None, go_on)?;
    let mut quilt = Quilt::new(&own, &scale, plane);
    for patch in &patches {
        go_on()?;
        if let Some(offset) = patch.offset {
            quilt.lay(
                Rect::new(0.0, 0.0, patch.size[0], patch.size[1]) + Vec2::new(patch.low[0], patch.low[1]),
                offset,
            );
        }
    }
    quilt.fill_holes(params.seed, go_on)?;
    let mut placed = quilt.placed;
    go_on()?;
    own.drop_remnants(&mut placed, plane, &scale, go_on)?;
    let found = own.traced((&placed, plane), &scale, (params, by), go_on)?;
    if found.is_empty() {
        return Err(Error::Parameter {
            name: "canvas",
            value: format!("{} x {} px", params.size[0], params.size[1]),
            allowed: format!("large enough for cells of {:.0} px", 2.0 * scale.reach).into(),
        });
    }
    Ok(found)
}

impl CellExemplar {
    fn stretched(&self, by: [f64; 2]) -> Self {
        let size = [0, 1].map(|k| by[k] * self.page.size[k]);
        Self {
            page: PeriodicPlane { size, ..self.page },
            cells: self.cells.iter().map(|c| c.stretched(by)).collect(),
            is_whole: self.is_whole.clone(),
        }
    }

    /// Whether the cells come in an order of their own wherever variation is asked for: they have different sizes, and
    /// their joints do not run on through many of them, as those of bricks do.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub fn is_rearranged(&self, go_on: &dyn Fn() -> Result<()>) -> Result<bool> {
        Ok(self.is_irregular() && !self.measured(go_on)?.0.is_lined)
    }

    /// Whether cells have different sizes.
    fn is_irregular(&self) -> bool {
        let whole = self.cells.iter().zip(&self.is_whole).filter(|c| *c.1);
        let areas: Vec<f64> = whole.map(|(c, _)| c.area()).collect();
        let count = (areas.len() as f64).max(1.0);
        let mean = areas.iter().sum::<f64>() / count;
        let deviation = areas.iter().map(|a| (a - mean) * (a - mean)).sum::<f64>() / count;
        libm::sqrt(deviation) > IRREGULAR * mean
    }

    /// The lengths of the page, and the graph of its joints.
    fn measured(&self, go_on: &dyn Fn() -> Result<()>) -> Result<(CellScale, CurveGraph)> {
        let mut reaches: Vec<f64> = parallel::map(&self.cells, CellShape::reach);
        reaches.sort_by(f64::total_cmp);
        let reach = reaches.get(reaches.len() / 2).copied().unwrap_or(1.0).max(1e-6);
        let extent = |c: &CellShape| c.bounds().width().max(c.bounds().height());
        let largest = self.cells.iter().map(extent).fold(0.0, f64::max);
        let mut scale =
            CellScale { reach, step: reach / FINE, gap: 0.0, rounding: 0.0, largest, is_lined: false };
        scale.check(Large::Drawing, self.page)?;
        go_on()?;
        let margin = largest + GROWN * reach;
        let [width, height] = self.page.size;
        let window = Rect::new(0.0, 0.0, width, height);
        let shown = [0, 1].map(|k| if self.page.wraps[k] { margin } else { 0.0 });
        let window = window.inflate(shown[0], shown[1]);
        let home: Vec<PlacedShape> =
            (0..self.cells.len() as u32).map(|shape| PlacedShape { shape, by: Vec2::ZERO }).collect();
        let placed = self.copies((&home, self.page), window, scale.reach * GROWN);
        let task = PartitionTask { half_gap: None, ..self.task(&placed, window, &scale) };
        let Partition { rings, borders } = task.divided(go_on)?;
        let mut gaps = Vec::new();
        let mut strokes = Vec::new();
        for border in &borders {
            let middle = border.points[border.points.len() / 2];
            let is_home = (0..2).all(|k| {
                let v = if k == 0 { middle.x } else { middle.y };
                !self.page.wraps[k] || (0.0..self.page.size[k]).contains(&v)
            });
            if !is_home {
                continue;
            }
            gaps.push(2.0 * task.distance(border.sides[0], middle).0.max(0.0));
            let points = border.points.iter().map(|p| [p.x, p.y]).collect();
            strokes.push(CurveStroke { points, closed: false, style: 0 });
        }
        gaps.sort_by(f64::total_cmp);
        scale.gap = gaps.get(gaps.len() / 2).copied().filter(|g| *g > NO_GAP * reach).unwrap_or(0.0);
        // The radius with which cells within their joints have their areas.
        let of_home = |k: &usize| placed[*k].by == Vec2::ZERO && self.is_whole[placed[*k].shape as usize];
        let whole: Vec<usize> = (0..placed.len()).filter(of_home).filter(|k| rings[*k].len() > 2).collect();
        let wanted: f64 = whole.iter().map(|k| self.cells[placed[*k].shape as usize].area()).sum();
        let area = |rounding: f64| -> f64 {
            let of = |k: &usize| signed_area(&CellScale { rounding, ..scale }.inner(&rings[*k]));
            parallel::map(&whole, of).into_iter().sum()
        };
        let (mut low, mut high) = (0.0, 0.9 * reach);
        if area(0.0) > 1.002 * wanted {
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                *(if area(middle) > wanted { &mut low } else { &mut high }) = middle;
            }
            scale.rounding = low;
        }
        let joints = CurveExemplar { page: self.page, strokes, elements: Vec::new(), weld: WELD * reach };
        let graph = joints.graph(go_on)?;
        scale.is_lined = graph.runs_on(LONG * reach) > LINED;
        Ok((scale, graph))
    }

    fn task<'a>(&'a self, placed: &'a [PlacedShape], window: Rect, scale: &CellScale) -> PartitionTask<'a> {
        let (step, reach) = (scale.step, GROWN * scale.reach);
        PartitionTask {
            shapes: &self.cells,
            placed,
            window,
            step,
            reach,
            tolerance: 0.05 * scale.step,
            half_gap: Some(0.5 * scale.gap),
        }
    }

    /// All copies of placed cells on a plane that come within `near` of a window.
    fn copies(
        &self,
        (placed, plane): (&[PlacedShape], PeriodicPlane),
        window: Rect,
        near: f64,
    ) -> Vec<PlacedShape> {
        let window = window.inflate(near, near);
        let mut copies = Vec::new();
        for own in placed {
            let bounds = self.cells[own.shape as usize].bounds() + own.by;
            let range = |k: usize, low: f64, high: f64, from: f64, to: f64| {
                let size = plane.size[k];
                let all = libm::ceil((from - high) / size) as i64..=libm::floor((to - low) / size) as i64;
                if plane.wraps[k] { all } else { 0..=0 }
            };
            for j in range(1, bounds.y0, bounds.y1, window.y0, window.y1) {
                for i in range(0, bounds.x0, bounds.x1, window.x0, window.x1) {
                    let way = Vec2::new(i as f64 * plane.size[0], j as f64 * plane.size[1]);
                    copies.push(PlacedShape { by: own.by + way, ..*own });
                }
            }
        }
        copies
    }

    /// Takes away placed cells of which others leave little.
    fn drop_remnants(
        &self,
        placed: &mut Vec<PlacedShape>,
        plane: PeriodicPlane,
        scale: &CellScale,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<()> {
        let margin = scale.largest + 2.0 * GROWN * scale.reach;
        let window = Rect::new(0.0, 0.0, plane.size[0], plane.size[1]).inflate(margin, margin);
        let copies = self.copies((placed, plane), window, GROWN * scale.reach);
        let rings = self.task(&copies, window, scale).divided(go_on)?.rings;
        let is_remnant = |own: &PlacedShape| {
            let copy = copies.iter().position(|c| c == own);
            copy.is_some_and(|k| signed_area(&rings[k]) < REMNANT * self.cells[own.shape as usize].area())
        };
        let kept: Vec<bool> = parallel::map(placed, |own| !is_remnant(own));
        let mut kept = kept.into_iter();
        placed.retain(|_| kept.next() != Some(false));
        Ok(())
    }

    /// The cells of the canvas, each along its part of it.
    fn traced(
        &self,
        (placed, plane): (&[PlacedShape], PeriodicPlane),
        scale: &CellScale,
        (params, by): (&CellParams, [f64; 2]),
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Vec<QuiltedCell>> {
        let shown = ShownPart { size: params.size, tile: params.tile, margin: 0.0 };
        let margin = scale.largest + 2.0 * GROWN * scale.reach;
        let canvas = Rect::new(0.0, 0.0, params.size[0], params.size[1]);
        let window = canvas.inflate(margin, margin);
        let copies = self.copies((placed, plane), window, GROWN * scale.reach);
        let task = self.task(&copies, window, scale);
        let Partition { rings, borders } = task.divided(go_on)?;
        // Length of the borders of each that lie where the exemplar has them, and of all.
        let mut drawn = vec![[0.0f64; 2]; copies.len()];
        for border in &borders {
            let long: f64 = border.points.windows(2).map(|w| w[0].distance(w[1])).sum();
            for side in border.sides {
                let [kept, all] = &mut drawn[side as usize];
                *all += long;
                *kept += if border.is_drawn { long } else { 0.0 };
            }
        }
        let is_home = |k: usize| {
            let at = self.cells[copies[k].shape as usize].middle() + copies[k].by;
            (0..2).all(|axis| {
                let v = if axis == 0 { at.x } else { at.y };
                !params.tile[axis] || (0.0..params.size[axis]).contains(&v)
            })
        };
        let numbers: Vec<usize> = (0..copies.len()).filter(|k| is_home(*k) && rings[*k].len() > 2).collect();
        let of = |&k: &usize| {
            let [kept, all] = drawn[k];
            let is_same = kept >= SAME_SHARE * all;
            let ring = if is_same { scale.inner(&rings[k]) } else { scale.fitted(&rings[k]) };
            let shown_area = if ring.len() > 2 { shown.area(ring.clone()) } else { 0.0 };
            if shown_area <= 0.0 {
                return None;
            }
            let map = Affine::translate(copies[k].by) * Affine::scale_non_uniform(by[0], by[1]);
            let tolerance = 0.1 * scale.step;
            let path = (!is_same).then(|| traced_ring(&thinned_ring(&ring, tolerance), tolerance));
            Some(QuiltedCell { cell: copies[k].shape, map, path, shown_area })
        };
        Ok(parallel::map(&numbers, of).into_iter().flatten().collect())
    }
}

impl CellShape {
    /// Area of its rings, those within others taken away.
    pub fn area(&self) -> f64 {
        let mut areas: Vec<f64> = self.rings.iter().map(|r| signed_area(r).abs()).collect();
        areas.sort_by(|a, b| b.total_cmp(a));
        areas[0] - areas[1..].iter().sum::<f64>()
    }

    /// About the radius of the largest disc within.
    fn reach(&self) -> f64 {
        const SIDE: usize = 16;
        let bounds = self.bounds();
        let at = |k: usize| {
            let share = [k % SIDE, k / SIDE].map(|v| (v as f64 + 0.5) / SIDE as f64);
            Point::new(bounds.x0 + share[0] * bounds.width(), bounds.y0 + share[1] * bounds.height())
        };
        (0..SIDE * SIDE).map(|k| -self.distance(at(k)).0).fold(0.0, f64::max)
    }
}

impl CellScale {
    /// An error if a plane has too many cells.
    fn check(&self, what: Large, plane: PeriodicPlane) -> Result<()> {
        if plane.area() <= MOST_GRID * self.step * self.step {
            return Ok(());
        }
        Err(Error::TooLarge {
            name: if what == Large::Canvas { "size" } else { "the drawing" }.into(),
            what,
            found: format!("about {:.0} cells", plane.area() / (4.0 * self.reach * self.reach)),
            limit: format!("{:.0}", MOST_GRID / (4.0 * FINE * FINE)),
        })
    }

    /// The outline of a cell that is made to fit within its ring of joints, without spikes and narrow dents.
    fn fitted(&self, ring: &[Point]) -> Vec<Point> {
        let dent = DENT * self.reach;
        let ring = moved_inwards(&moved_inwards(&thinned_ring(ring, 0.1 * self.step), -dent), dent);
        Self { rounding: self.rounding.max(ROUND * self.reach), ..*self }.inner(&ring)
    }

    /// The outline of a cell within its ring of joints.
    fn inner(&self, ring: &[Point]) -> Vec<Point> {
        if ring.len() < 3 {
            return Vec::new();
        }
        let ring = thinned_ring(ring, 0.1 * self.step);
        let inner = moved_inwards(&ring, 0.5 * self.gap);
        if self.rounding <= 0.0 {
            return inner;
        }
        let round = opened(&inner, self.rounding);
        if round.is_empty() { inner } else { round }
    }
}

/// Cells laid on a plane that repeats.
struct Quilt<'a> {
    exemplar: &'a CellExemplar,
    scale: &'a CellScale,
    plane: PeriodicPlane,
    placed: Vec<PlacedShape>,
    /// Columns and rows of a grid, and the number of the cell that covers each of its places, from 1.
    size: [usize; 2],
    on: Vec<u32>,
    /// Places of the grid that each cell covers, and how many of them others have covered.
    areas: Vec<[usize; 2]>,
}

impl<'a> Quilt<'a> {
    fn new(exemplar: &'a CellExemplar, scale: &'a CellScale, plane: PeriodicPlane) -> Self {
        let size = plane.size.map(|s| libm::ceil(s / (2.0 * scale.step)).max(1.0) as usize);
        let on = vec![0; size[0] * size[1]];
        Self { exemplar, scale, plane, placed: Vec::new(), size, on, areas: Vec::new() }
    }

    /// Lays the whole cells whose middles lie in a box, as the exemplar has them at an offset.
    fn lay(&mut self, at: Rect, offset: [f64; 2]) {
        let page = self.exemplar.page;
        for (shape, cell) in self.exemplar.cells.iter().enumerate().filter(|c| self.exemplar.is_whole[c.0]) {
            let middle = cell.middle() - Vec2::new(offset[0], offset[1]);
            let range = |k: usize, v: f64, low: f64, high: f64| {
                let all =
                    libm::ceil((low - v) / page.size[k]) as i64..libm::ceil((high - v) / page.size[k]) as i64;
                if page.wraps[k] { all } else { 0..i64::from((low..high).contains(&v)) }
            };
            for j in range(1, middle.y, at.y0, at.y1) {
                for i in range(0, middle.x, at.x0, at.x1) {
                    let way = Vec2::new(i as f64 * page.size[0], j as f64 * page.size[1]);
                    let by = way - Vec2::new(offset[0], offset[1]);
                    self.place(PlacedShape { shape: shape as u32, by });
                }
            }
        }
    }

    /// Width and height of a place of the grid.
    fn side(&self) -> [f64; 2] {
        [0, 1].map(|k| self.plane.size[k] / self.size[k] as f64)
    }

    /// The places of the grid that a cell covers.
    fn covered(&self, placed: PlacedShape) -> Vec<usize> {
        let cell = &self.exemplar.cells[placed.shape as usize];
        let bounds = cell.bounds() + placed.by;
        let side = self.side();
        let along = |k: usize, low: f64, high: f64| {
            libm::floor(low / side[k]) as i64..libm::ceil(high / side[k]) as i64
        };
        let mut all = Vec::new();
        for j in along(1, bounds.y0, bounds.y1) {
            for i in along(0, bounds.x0, bounds.x1) {
                let p = Point::new((i as f64 + 0.5) * side[0], (j as f64 + 0.5) * side[1]);
                if cell.contains(p - placed.by) {
                    let [x, y] = [i.rem_euclid(self.size[0] as i64), j.rem_euclid(self.size[1] as i64)];
                    all.push(y as usize * self.size[0] + x as usize);
                }
            }
        }
        all
    }

    /// Places a cell unless it would cover too much of others, or they of it.
    fn place(&mut self, placed: PlacedShape) -> bool {
        let covered = self.covered(placed);
        let most = |area: usize| COVERED * area as f64;
        let mut taken: BTreeMap<u32, usize> = BTreeMap::new();
        for &at in covered.iter().filter(|at| self.on[**at] > 0) {
            *taken.entry(self.on[at]).or_default() += 1;
        }
        let fits = taken.values().sum::<usize>() as f64 <= most(covered.len())
            && taken.iter().all(|(other, count)| {
                let [area, lost] = self.areas[*other as usize - 1];
                (lost + count) as f64 <= most(area)
            });
        if covered.is_empty() || !fits {
            return false;
        }
        taken.into_iter().for_each(|(other, count)| self.areas[other as usize - 1][1] += count);
        self.placed.push(placed);
        self.areas.push([covered.len(), 0]);
        let number = self.placed.len() as u32;
        for at in covered {
            if self.on[at] == 0 {
                self.on[at] = number;
            }
        }
        true
    }

    /// Notes that nothing fits around a place of the grid, whose cells have a side of `unit`.
    fn refuse(&self, at: usize, unit: f64, refused: &mut [bool]) {
        let [width, height] = self.size;
        let reach = libm::ceil(self.scale.reach / unit) as usize;
        let (x, y) = (at % width + width, at / width + height);
        for j in y.saturating_sub(reach)..=y + reach {
            for i in x.saturating_sub(reach)..=x + reach {
                refused[j % height * width + i % width] = true;
            }
        }
    }

    /// The cell and place about a point that fill most of a gap and cover least beside it.
    fn best_fit(&self, about: Point, cells: &[usize]) -> Option<PlacedShape> {
        let step = APART * self.scale.reach;
        let all: Vec<PlacedShape> = cells
            .iter()
            .flat_map(|&shape| {
                let by = about - self.exemplar.cells[shape].middle();
                let shifts = (-PLACES..=PLACES).flat_map(|j| (-PLACES..=PLACES).map(move |i| (i, j)));
                shifts.map(move |(i, j)| PlacedShape {
                    shape: shape as u32,
                    by: by + step * Vec2::new(i as f64, j as f64),
                })
            })
            .collect();
        let fits = parallel::map(&all, |placed| {
            let covered = self.covered(*placed);
            let free = covered.iter().filter(|at| self.on[**at] == 0).count();
            let is_free = free as f64 >= FREE * covered.len() as f64;
            is_free.then_some(2 * free as i64 - covered.len() as i64)
        });
        let found = fits.iter().zip(&all).filter_map(|(fit, placed)| Some(((*fit)?, placed)));
        found.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|f| *f.1)
    }

    /// Puts cells of about their size into gaps between the others.
    fn fill_holes(&mut self, seed: u64, go_on: &dyn Fn() -> Result<()>) -> Result<()> {
        let [width, height] = self.size;
        let side = self.side();
        let unit = libm::sqrt(side[0] * side[1]);
        let least = HOLE * self.scale.reach + 0.5 * self.scale.gap;
        let rim = (libm::ceil(2.0 * self.scale.reach / unit) as usize).min(width.min(height));
        let whole: Vec<usize> =
            (0..self.exemplar.cells.len()).filter(|c| self.exemplar.is_whole[*c]).collect();
        let mut random = stream(seed, "curves/holes", 0);
        let mut refused = vec![false; self.on.len()];
        loop {
            go_on()?;
            // Beyond the border the plane repeats.
            let [wide, high] = [width + 2 * rim, height + 2 * rim];
            let inner = |i: usize| {
                let (x, y) = ((i % wide + width - rim) % width, (i / wide + height - rim) % height);
                y * width + x
            };
            let far = squared_distance(wide, high, |i| self.on[inner(i)] > 0);
            let mut holes: Vec<(f32, usize)> = (0..far.len())
                .filter(|i| {
                    (rim..wide - rim).contains(&(i % wide)) && (rim..high - rim).contains(&(i / wide))
                })
                .filter(|i| f64::from(far[*i]) * unit * unit > least * least)
                .map(|i| (far[i], inner(i)))
                .filter(|(_, at)| !refused[*at])
                .collect();
            holes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            if holes.is_empty() || whole.is_empty() {
                return Ok(());
            }
            let mut filled = false;
            for (_, at) in holes {
                if self.on[at] > 0 || refused[at] {
                    continue;
                }
                let middle = Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
                let place = Point::new(middle.x * side[0], middle.y * side[1]);
                let tried: Vec<usize> = (0..CANDIDATES).map(|_| whole[random.index(whole.len())]).collect();
                match self.best_fit(place, &tried) {
                    Some(fitting) if self.place(fitting) => filled = true,
                    _ => self.refuse(at, unit, &mut refused),
                }
            }
            if !filled {
                return Ok(());
            }
        }
    }
}
