//! Drawings of cells: filled shapes side by side with thin joints between, such as mosaics, bricks and stained glass.
//!
//! The page is painted into a grid. A cell is a connected part of it with one shape on top, unless another cell encloses
//! it. What is left between cells must be thin. Strokes along the outlines of cells belong to these.

use super::line_drawing::is_line;
use super::page_raster::PageRaster;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::error::Result;
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::geometry::{Affine, Outline, Point, inside, signed_area};
use vtex_base::raster::squared_distance;
use vtex_curves::{CellExemplar, CellShape};
use vtex_scene::library::Library;

/// Grids on which it is seen whether there are cells, and on which they are measured.
const FEW: f64 = 2.5e5;
const MANY: f64 = 3e6;
/// Least number of cells, and least share of the page that they cover.
const LEAST: usize = 2;
const COVERED: f64 = 0.5;
/// Largest area of all shapes in areas of the page: cells lie side by side, beside a few grounds below them.
const STACKED: f64 = 16.0;
/// Largest width of the ground between cells, in widths of the middle cell, and least width of a cell.
const THIN: f64 = 0.5;
const NARROW: f64 = 0.2;
/// Least share of a cell that is seen, and largest share of the cells' area that may be hidden more.
const SEEN: f64 = 0.93;
const HIDDEN: f64 = 0.2;
/// Largest deviation of an outline from its polygon, in half widths of the middle cell.
const FLAT: f64 = 2e-3;

/// A shape of a library: its layer, and the numbers of its instance and of itself.
pub(super) type ShapeKey = [usize; 3];

/// The cells of a drawing.
pub(super) struct CellDrawing {
    pub(super) exemplar: CellExemplar,
    /// The shape that each cell is or is part of, and whether it is all of that.
    pub(super) sources: Vec<(ShapeKey, bool)>,
}

/// A shape as it is drawn.
struct DrawnShape {
    key: ShapeKey,
    outline: Outline,
    is_line: bool,
}

impl CellDrawing {
    /// The cells of a library on a page; `None` if it is another drawing.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(super) fn of(
        library: &Library,
        page: PeriodicPlane,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let mut shapes = Vec::new();
        let mut filled = 0.0;
        for (layer, own) in library.layers.iter().enumerate() {
            for (number, instance) in own.instances.iter().enumerate() {
                let Some(element) = library.primaries().get(instance.element.index()) else { continue };
                let map = Affine::new(instance.transform);
                let is_filled = element.shapes.first().is_some_and(|s| !is_line(s));
                for (k, shape) in element.shapes.iter().enumerate() {
                    if shape.is_soft() {
                        return Ok(None);
                    }
                    let is_line = is_line(shape);
                    if is_line && is_filled {
                        continue;
                    }
                    filled += if is_line { 0.0 } else { shape.area() * map.determinant().abs() };
                    shapes.push(DrawnShape {
                        key: [layer, number, k],
                        outline: shape.outline.moved(map),
                        is_line,
                    });
                }
            }
        }
        if !(COVERED..=STACKED).contains(&(filled / page.area())) {
            return Ok(None);
        }
        let of = |count: f64| CellMap::new(PageRaster::new(page, f64::INFINITY, count), &shapes, go_on);
        if of(FEW)?.middle_cell().is_none() {
            return Ok(None);
        }
        let map = of(MANY)?;
        Ok(map.middle_cell().and_then(|reach| map.drawing(reach, &shapes)))
    }
}

/// What is on top in the parts of a page.
struct CellMap {
    raster: PageRaster,
    parts: Vec<PagePart>,
}

/// A connected part of the page with one thing on top.
#[derive(Clone, Copy)]
struct PagePart {
    kind: PartKind,
    /// Cells of the grid.
    area: usize,
    /// Largest distance of a cell from other parts, and where that is, in cells.
    reach: f64,
    at: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum PartKind {
    Ground,
    Line,
    /// A shape, by its place in the list.
    Cell(u32),
    /// A shape within one cell, or a sliver.
    Detail,
}

/// The rows of a grid in runs of cells with the same on top.
struct Runs {
    /// The cells of each.
    runs: Vec<Range<usize>>,
    /// Connected runs with the same on top.
    sets: DisjointSets,
    /// Adjacent runs with different things on top.
    unlike: Vec<[usize; 2]>,
    /// Whether each cell has a neighbour with something else on top.
    is_border: Vec<bool>,
}

impl Runs {
    fn new(top: &[u32], raster: &PageRaster) -> Self {
        let [width, height] = raster.size;
        let wraps = raster.page().wraps;
        let mut runs: Vec<Range<usize>> = Vec::new();
        let mut rows = vec![0];
        for row in 0..height {
            let mut start = row * width;
            for run in top[start..][..width].chunk_by(|a, b| a == b) {
                runs.push(start..start + run.len());
                start += run.len();
            }
            rows.push(runs.len());
        }
        let (mut sets, mut unlike) = (DisjointSets::new(runs.len()), Vec::new());
        let mut is_border = vec![false; top.len()];
        // Two runs, and the cells of each that have neighbours in the other.
        let mut meet = |[a, b]: [usize; 2], cells: [Range<usize>; 2]| {
            if top[runs[a].start] == top[runs[b].start] {
                sets.join(a, b);
            } else {
                unlike.push([a, b]);
                cells.into_iter().for_each(|cells| is_border[cells].fill(true));
            }
        };
        for row in 0..height {
            let own = rows[row]..rows[row + 1];
            let pairs = (own.start..own.end - 1).map(|k| [k, k + 1]);
            for [a, b] in pairs.chain(wraps[0].then_some([own.end - 1, own.start])) {
                let (end, start) = (runs[a].end, runs[b].start);
                meet([a, b], [end - 1..end, start..start + 1]);
            }
            let below = if row + 1 < height { row + 1 } else { 0 };
            if below == 0 && !wraps[1] {
                continue;
            }
            let (mut a, mut b) = (rows[row], rows[below]);
            while a < rows[row + 1] && b < rows[below + 1] {
                let [one, other] = [(a, row), (b, below)].map(|(k, row)| {
                    let first = row * width;
                    [runs[k].start - first, runs[k].end - first]
                });
                let [low, high] = [one[0].max(other[0]), one[1].min(other[1])];
                meet([a, b], [row, below].map(|row| row * width + low..row * width + high));
                (a, b) = (a + usize::from(one[1] == high), b + usize::from(other[1] == high));
            }
        }
        Self { runs, sets, unlike, is_border }
    }
}

impl CellMap {
    fn new(raster: PageRaster, shapes: &[DrawnShape], go_on: &dyn Fn() -> Result<()>) -> Result<Self> {
        const GROUND: u32 = 0;
        const LINE: u32 = 1;
        let [width, height] = raster.size;
        let mut top = vec![GROUND; width * height];
        for (k, shape) in shapes.iter().enumerate() {
            go_on()?;
            let label = if shape.is_line { LINE } else { k as u32 + 2 };
            raster.each(&shape.outline, |cell| top[cell] = label);
        }
        let Runs { runs, mut sets, unlike, is_border } = Runs::new(&top, &raster);
        go_on()?;
        let far = squared_distance(width, height, |cell| is_border[cell]);
        let mut number: Vec<u32> = vec![u32::MAX; runs.len()];
        let mut parts: Vec<PagePart> = Vec::new();
        let part_of = |k: usize| {
            let (run, root) = (&runs[k], sets.root(k));
            if number[root] == u32::MAX {
                number[root] = parts.len() as u32;
                let kind = match top[run.start] {
                    GROUND => PartKind::Ground,
                    LINE => PartKind::Line,
                    k => PartKind::Cell(k - 2),
                };
                parts.push(PagePart { kind, area: 0, reach: 0.0, at: run.start });
            }
            let own = &mut parts[number[root] as usize];
            own.area += run.len();
            for cell in run.clone() {
                let reach = libm::sqrt(f64::from(far[cell])) + 0.5;
                if reach > own.reach && reach.is_finite() {
                    (own.reach, own.at) = (reach, cell);
                }
            }
            number[root]
        };
        let part: Vec<u32> = (0..runs.len()).map(part_of).collect();
        let mut beside: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for [a, b] in unlike.into_iter().map(|pair| pair.map(|run| part[run])) {
            beside.entry(a).or_default().insert(b);
            beside.entry(b).or_default().insert(a);
        }
        let mut made = Self { raster, parts };
        made.tell_details(&beside);
        Ok(made)
    }

    /// Shapes that lie within one cell, or are much narrower than most, are no cells. `beside` has the neighbours of each
    /// part.
    fn tell_details(&mut self, beside: &BTreeMap<u32, BTreeSet<u32>>) {
        let middle = self.middle_reach();
        let is_cell = |p: u32| matches!(self.parts[p as usize].kind, PartKind::Cell(_));
        let is_within =
            |p: u32| beside.get(&p).is_some_and(|b| b.len() == 1 && b.iter().all(|q| is_cell(*q)));
        let is_detail =
            |p: &u32| is_cell(*p) && (self.parts[*p as usize].reach < NARROW * middle || is_within(*p));
        let details: Vec<u32> = (0..self.parts.len() as u32).filter(is_detail).collect();
        details.into_iter().for_each(|p| self.parts[p as usize].kind = PartKind::Detail);
    }

    fn cells(&self) -> impl Iterator<Item = &PagePart> {
        self.parts.iter().filter(|p| matches!(p.kind, PartKind::Cell(_)))
    }

    /// Half the width of the cell in the middle of all area, 0 without cells.
    fn middle_reach(&self) -> f64 {
        let mut all: Vec<(f64, usize)> = self.cells().map(|p| (p.reach, p.area)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: usize = all.iter().map(|a| a.1).sum();
        let mut below = 0;
        let middle = all.iter().find(|a| {
            below += a.1;
            2 * below >= total
        });
        middle.map_or(0.0, |m| m.0)
    }

    /// Half the width of the cell in the middle, in cells of the grid, if the page is filled with cells and the ground
    /// between them is thin.
    fn middle_cell(&self) -> Option<f64> {
        let covered: usize = self.cells().map(|p| p.area).sum();
        let middle = self.middle_reach();
        let is_thin = |p: &PagePart| match p.kind {
            PartKind::Ground => p.reach <= THIN * middle,
            kind => kind != PartKind::Line,
        };
        let fits = self.cells().count() >= LEAST
            && covered as f64 >= COVERED * self.raster.size.map(|v| v as f64).iter().product::<f64>()
            && self.parts.iter().all(is_thin);
        fits.then_some(middle)
    }

    /// The cells; `None` if too many are hidden in part.
    fn drawing(&self, reach: f64, shapes: &[DrawnShape]) -> Option<CellDrawing> {
        let unit = self.raster.unit();
        let page = self.raster.page();
        let (mut cells, mut is_whole, mut sources) = (Vec::new(), Vec::new(), Vec::new());
        let (mut hidden, mut all) = (0.0, 0.0);
        for part in self.cells() {
            let PartKind::Cell(k) = part.kind else { continue };
            let shape = &shapes[k as usize];
            let polygons = shape.outline.polygons(FLAT * reach * unit);
            let Some((rings, is_all)) = around(&polygons, self.raster.middle(part.at), page) else {
                continue;
            };
            let cell = CellShape::new(rings);
            let seen = part.area as f64 * unit * unit;
            let is_seen = seen >= SEEN * cell.area();
            all += seen;
            hidden += if is_seen || !page.wraps[0] { 0.0 } else { seen };
            cells.push(cell);
            is_whole.push(is_seen);
            sources.push((shape.key, is_all));
        }
        let exemplar = CellExemplar { page, cells, is_whole };
        let is_fit = hidden <= HIDDEN * all && exemplar.is_whole.iter().filter(|w| **w).count() >= LEAST;
        is_fit.then_some(CellDrawing { exemplar, sources })
    }
}

/// The rings of a shape around a place on a page, outermost first, and whether they are all that it has: the smallest ring
/// about the place or a copy of it, and what is cut out of that.
fn around(polygons: &[Vec<Point>], at: [f64; 2], page: PeriodicPlane) -> Option<(Vec<Vec<Point>>, bool)> {
    let copies = |k: usize| if page.wraps[k] { -1..=1 } else { 0..=0 };
    let mut best: Option<(f64, usize, Point)> = None;
    for (j, i) in copies(1).flat_map(|j| copies(0).map(move |i| (j, i))) {
        let p = Point::new(at[0] + f64::from(i) * page.size[0], at[1] + f64::from(j) * page.size[1]);
        for (k, ring) in polygons.iter().enumerate().filter(|(_, ring)| inside(ring, p)) {
            let area = signed_area(ring).abs();
            if best.is_none_or(|b| area < b.0) {
                best = Some((area, k, p));
            }
        }
    }
    let (_, outer, p) = best?;
    let mut rings = vec![polygons[outer].clone()];
    let is_cut_out = |ring: &&Vec<Point>| inside(&polygons[outer], ring[0]) && !inside(ring, p);
    rings.extend(
        polygons.iter().enumerate().filter(|(k, _)| *k != outer).map(|(_, r)| r).filter(is_cut_out).cloned(),
    );
    let is_all = rings.len() == polygons.len();
    Some((rings, is_all))
}
