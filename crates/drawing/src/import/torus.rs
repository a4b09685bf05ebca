//! Makes the pieces of a periodic page whole across its borders.
//!
//! Copies of a piece at opposite borders are one piece. Rings are cut at the stretches that run along
//! borders, and their ends are linked to the ends at the same place of the opposite border.

use super::clip::page;
use super::lines::Lines;
use super::offsets::{Offsets, Shift, minus, plus};
use super::pieces::{DrawingPiece, PieceShape};
use super::stacking::DrawnCopy;
use kurbo::{PathSeg, Shape as _};
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, BezPath, ConvexPolygon, Point, Rect, Vec2, closed_rings};

/// Largest distance of places that count as equal, as a share of the page's larger side.
const SAME: f64 = 1.5e-3;
/// Largest distance of a place that counts as on a border, likewise.
const ON_BORDER: f64 = 3e-4;
/// Largest difference in area of two copies, as a share.
const AREA: f64 = 0.02;
/// Most pieces at the borders that are compared with one another.
const MOST: usize = 4_000;
/// Most stretches at one place of a border that are compared with one another.
const MOST_AT_ONCE: usize = 64;

/// Largest share of a piece that may lie outside the page if its copy at the opposite border is missing.
const FORGOTTEN: f64 = 0.3;

/// A page whose opposite borders join.
pub(super) struct Torus {
    pub(super) size: [f64; 2],
    same: f64,
    near: f64,
}

/// A stretch of a ring between two stretches along the border.
struct Chain {
    piece: usize,
    path: Vec<PathSeg>,
    /// Borders on which it begins and ends.
    ends: [PageBorder; 2],
}

/// A border of the page: axis across it, and whether it is the far one.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct PageBorder {
    pub(super) axis: usize,
    pub(super) far: bool,
}

impl Torus {
    pub(super) fn new(size: [f64; 2]) -> Self {
        let side = size[0].max(size[1]);
        Self { size, same: SAME * side, near: ON_BORDER * side }
    }

    /// The vector of a shift.
    pub(super) fn vector(&self, shift: Shift) -> Vec2 {
        Vec2::new(f64::from(shift[0]) * self.size[0], f64::from(shift[1]) * self.size[1])
    }

    /// Makes pieces whole. Also returns what was drawn, in painting order, as copies of these.
    pub(super) fn whole(&self, pieces: Vec<DrawingPiece>) -> (Vec<DrawingPiece>, Vec<DrawnCopy>) {
        let drawn: Vec<Rect> = pieces.iter().map(DrawingPiece::bounds).collect();
        let (mut pieces, repeated, of) = self.once(pieces, &drawn);
        let bounds: Vec<Rect> = pieces.iter().map(DrawingPiece::bounds).collect();
        let alone: Vec<usize> =
            (0..pieces.len()).filter(|&k| self.sticks_out(&bounds[k]) && !repeated[k]).collect();
        let few = alone.len() <= MOST;
        let mut lines = Lines::new(self.size, &pieces);
        let mut cut = vec![false; pieces.len()];
        for k in alone {
            let forgotten = few && self.is_forgotten(k, &pieces, &bounds);
            cut[k] = !forgotten && !lines.continues(&pieces[k]);
        }
        let clip = ConvexPolygon::rect(page(self.size));
        for (piece, cut) in pieces.iter_mut().zip(cut) {
            if cut {
                piece.parts = piece.parts.iter().filter_map(|part| clipped(part, &clip)).collect();
            }
        }
        let remains: Vec<bool> = pieces.iter().map(|p| !p.parts.is_empty()).collect();
        let remaining = places_of(&remains);
        pieces.retain(|p| !p.parts.is_empty());
        let (whole, parts) = self.stitched(pieces);
        let copy = |((kept, shift), bounds): ((usize, Shift), Rect)| {
            let (piece, own) = parts[remaining[kept]?];
            Some(DrawnCopy { piece, shift: plus(shift, own), bounds })
        };
        let copies = of.into_iter().zip(drawn).filter_map(copy).collect();
        (whole, copies)
    }

    fn sticks_out(&self, b: &Rect) -> bool {
        let near = self.near;
        b.x0 < -near || b.y0 < -near || b.x1 > self.size[0] + near || b.y1 > self.size[1] + near
    }

    /// Leaves out the copies of pieces that are drawn at several borders. Also returns for each remaining
    /// piece whether it had a copy, and for all pieces, of which remaining one they are copies, and where.
    fn once(
        &self,
        pieces: Vec<DrawingPiece>,
        bounds: &[Rect],
    ) -> (Vec<DrawingPiece>, Vec<bool>, Vec<(usize, Shift)>) {
        let outside: Vec<usize> = (0..pieces.len()).filter(|&i| self.sticks_out(&bounds[i])).collect();
        let mut repeated = vec![false; pieces.len()];
        let mut of: Vec<(usize, Shift)> = (0..pieces.len()).map(|k| (k, [0; 2])).collect();
        if outside.len() > MOST {
            return (pieces, repeated, of);
        }
        let areas: Vec<f64> = pieces.iter().map(|p| p.parts.iter().map(|q| q.path.area()).sum()).collect();
        for (n, &a) in outside.iter().enumerate() {
            if of[a].0 != a {
                continue;
            }
            for &b in &outside[n + 1..] {
                let apart = bounds[b].origin() - bounds[a].origin();
                let shift = [apart.x / self.size[0], apart.y / self.size[1]].map(|v| libm::round(v) as i32);
                let moved = bounds[a] + self.vector(shift);
                let [p, q] = [moved, bounds[b]];
                let off = (p.x0 - q.x0).abs().max((p.y0 - q.y0).abs());
                let off = off.max((p.x1 - q.x1).abs()).max((p.y1 - q.y1).abs());
                let alike = shift != [0; 2]
                    && off <= self.same
                    && (areas[a] - areas[b]).abs() <= AREA * areas[a].abs().max(self.same * self.same)
                    && same_paint(&pieces[a], &pieces[b]);
                if alike {
                    repeated[a] = true;
                    if of[b].0 == b {
                        of[b] = (a, shift);
                    }
                }
            }
        }
        let is_first: Vec<bool> = of.iter().enumerate().map(|(k, (first, _))| *first == k).collect();
        let places = places_of(&is_first);
        of.iter_mut().for_each(|(first, _)| *first = places[*first].unwrap_or_default());
        let kept = pieces.into_iter().zip(repeated).zip(is_first).filter(|(_, is_first)| *is_first);
        let (pieces, repeated) = kept.map(|(kept, _)| kept).unzip();
        (pieces, repeated, of)
    }

    /// Whether a small part of a piece lies outside the page and its copy is missing: no shape of its paint
    /// is at the other side.
    fn is_forgotten(&self, k: usize, all: &[DrawingPiece], bounds: &[Rect]) -> bool {
        let b = bounds[k];
        let over = [-b.x0, b.x1 - self.size[0], -b.y0, b.y1 - self.size[1]];
        let sides = [b.width(), b.width(), b.height(), b.height()];
        if over.iter().zip(sides).any(|(over, side)| *over > FORGOTTEN * side) {
            return false;
        }
        let shifts: [Shift; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let missing = |(over, shift): (&f64, Shift)| {
            let there = b + self.vector(shift);
            let met = |(other, bounds): (&DrawingPiece, &Rect)| {
                bounds.overlaps(there) && same_paint(other, &all[k])
            };
            *over <= self.near || !all.iter().zip(bounds).any(met)
        };
        over.iter().zip(shifts).all(missing)
    }

    /// Joins halves that were cut by a border along it. Also returns for each piece of which one it is a part or, at
    /// these periods, a copy.
    fn stitched(&self, pieces: Vec<DrawingPiece>) -> (Vec<DrawingPiece>, Vec<(usize, Shift)>) {
        let mut chains: Vec<Chain> = Vec::new();
        let mut sets = Offsets::new(pieces.len());
        for (k, piece) in pieces.iter().enumerate() {
            let [PieceShape { path, paint, stroke: None }] = &piece.parts[..] else { continue };
            if paint.gradient.is_some() {
                continue;
            }
            for ring in closed_rings(path) {
                match self.chains(&ring) {
                    Some(found) => {
                        chains.extend(found.into_iter().map(|(path, ends)| Chain { piece: k, path, ends }))
                    }
                    // A path that runs along borders only.
                    None => sets.set_endless(k),
                }
            }
        }
        let next = self.links(&chains, &pieces);
        for (chain, next) in chains.iter().zip(&next) {
            match next {
                Some((other, shift)) => sets.join(chain.piece, chains[*other].piece, *shift),
                None => sets.set_endless(chain.piece),
            }
        }
        self.rebuilt(&pieces, &chains, &next, &sets)
    }

    /// The border that a segment runs along.
    fn border(&self, segment: &PathSeg) -> Option<PageBorder> {
        let PathSeg::Line(l) = segment else { return None };
        let on = |axis: usize, v: f64| {
            let at = |p: Point| [p.x, p.y][axis];
            (at(l.p0) - v).abs() <= self.near && (at(l.p1) - v).abs() <= self.near
        };
        [0, 1].into_iter().find_map(|axis| {
            [false, true].into_iter().find_map(|far| {
                on(axis, if far { self.size[axis] } else { 0.0 }).then_some(PageBorder { axis, far })
            })
        })
    }

    /// The stretches of a ring away from the borders; empty if it does not touch them, `None` if it never
    /// leaves them.
    fn chains(&self, ring: &[PathSeg]) -> Option<Vec<(Vec<PathSeg>, [PageBorder; 2])>> {
        let borders: Vec<Option<PageBorder>> = ring.iter().map(|s| self.border(s)).collect();
        let Some(first) = borders.iter().position(Option::is_some) else { return Some(Vec::new()) };
        if borders.iter().all(Option::is_some) {
            return None;
        }
        let n = ring.len();
        let mut found = Vec::new();
        let mut open: Option<(Vec<PathSeg>, PageBorder)> = None;
        let mut last = borders[first]?;
        for k in 1..=n {
            let i = (first + k) % n;
            match borders[i] {
                None => open.get_or_insert_with(|| (Vec::new(), last)).0.push(ring[i]),
                Some(border) => {
                    if let Some((path, begin)) = open.take() {
                        found.push((path, [begin, border]));
                    }
                    last = border;
                }
            }
        }
        Some(found)
    }

    /// For each chain, the one that continues it at the opposite border, and its shift.
    fn links(&self, chains: &[Chain], pieces: &[DrawingPiece]) -> Vec<Option<(usize, Shift)>> {
        // Chains that are still free, by border and place of their beginnings.
        let place = |border: PageBorder, p: Point| {
            let along = if border.axis == 0 { p.y } else { p.x };
            (border.axis, border.far, libm::floor(along / self.same) as i64)
        };
        let start = |k: usize| chains[k].path.first().map(kurbo::ParamCurve::start).unwrap_or_default();
        let mut free: BTreeMap<(usize, bool, i64), Vec<usize>> = BTreeMap::new();
        for (k, chain) in chains.iter().enumerate() {
            free.entry(place(chain.ends[0], start(k))).or_default().push(k);
        }
        let mut next = Vec::with_capacity(chains.len());
        for chain in chains {
            let border = chain.ends[1];
            let mut shift = [0; 2];
            shift[border.axis] = if border.far { 1 } else { -1 };
            let end = chain.path.last().map(kurbo::ParamCurve::end).unwrap_or_default();
            let (own, layer) = (&pieces[chain.piece].parts[0].paint, pieces[chain.piece].layer);
            let distance = |k: usize| {
                let theirs = &pieces[chains[k].piece];
                let like = theirs.parts[0].paint == *own && theirs.layer == layer;
                like.then(|| (start(k) + self.vector(shift)).distance(end)).filter(|d| *d <= self.same)
            };
            let (axis, far, at) = place(PageBorder { far: !border.far, ..border }, end);
            let near = (at - 1..=at + 1).filter_map(|at| free.get(&(axis, far, at)));
            // At most a fixed number at one place is compared.
            let near = near.flat_map(|there| there.iter().take(MOST_AT_ONCE));
            let near = near.filter_map(|&k| Some((distance(k)?, k)));
            let best = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            next.push(best.map(|(_, k)| {
                let there = free.entry(place(chains[k].ends[0], start(k))).or_default();
                if let Some(at) = there.iter().position(|other| *other == k) {
                    there.remove(at);
                }
                (k, shift)
            }));
        }
        next
    }

    /// The pieces, with the pieces of each closed set joined to one.
    fn rebuilt(
        &self,
        pieces: &[DrawingPiece],
        chains: &[Chain],
        next: &[Option<(usize, Shift)>],
        sets: &Offsets,
    ) -> (Vec<DrawingPiece>, Vec<(usize, Shift)>) {
        let mut cut = vec![false; pieces.len()];
        chains.iter().for_each(|c| cut[c.piece] = true);
        let joined = |k: usize| cut[k] && !sets.is_endless(k);
        let mut paths: Vec<BezPath> = vec![BezPath::new(); pieces.len()];
        // Rings away from the borders stay with their piece.
        for (k, piece) in pieces.iter().enumerate().filter(|(k, _)| joined(*k)) {
            let (root, shift) = sets.find(k);
            for ring in closed_rings(&piece.parts[0].path) {
                if self.chains(&ring).is_some_and(|chains| chains.is_empty()) {
                    paths[root].extend(Affine::translate(self.vector(shift)) * closed(&ring));
                }
            }
        }
        let mut done = vec![false; chains.len()];
        for start in (0..chains.len()).filter(|&c| joined(chains[c].piece)) {
            let (mut ring, mut at, mut shift) = (Vec::new(), start, sets.find(chains[start].piece).1);
            while !done[at] {
                done[at] = true;
                let moved = Affine::translate(self.vector(shift));
                ring.extend(chains[at].path.iter().map(|s| moved * *s));
                let Some((other, by)) = next[at] else { break };
                shift = plus(shift, by);
                at = other;
            }
            if !ring.is_empty() {
                paths[sets.find(chains[start].piece).0].extend(closed(&straightened(ring, self.near)));
            }
        }
        let of = |k: usize| if joined(k) { sets.find(k) } else { (k, [0; 2]) };
        let is_whole: Vec<bool> = (0..pieces.len()).map(|k| of(k).0 == k).collect();
        let places = places_of(&is_whole);
        let part = |k: usize| (places[of(k).0].unwrap_or_default(), minus(of(k).1));
        let parts = (0..pieces.len()).map(part).collect();
        let mut whole = Vec::new();
        for (k, piece) in pieces.iter().enumerate() {
            if !joined(k) {
                whole.push(piece.clone());
            } else if sets.find(k).0 == k {
                let path = std::mem::take(&mut paths[k]);
                let path = if path.area() < 0.0 { path.reverse_subpaths() } else { path };
                let part = PieceShape { path, ..piece.parts[0].clone() };
                whole.push(DrawingPiece { parts: vec![part], ..piece.clone() });
            }
        }
        (whole, parts)
    }

    /// Moves points on a border beyond it by `by`, so that adjacent copies leave no gap.
    pub(super) fn widened(&self, path: &BezPath, by: f64) -> BezPath {
        let mut out = BezPath::new();
        for ring in closed_rings(path) {
            let n = ring.len();
            let borders: Vec<Option<PageBorder>> = ring.iter().map(|s| self.border(s)).collect();
            let moved = |p: Point, sides: [Option<PageBorder>; 2]| {
                let mut p = [p.x, p.y];
                for b in sides.into_iter().flatten() {
                    p[b.axis] = if b.far { self.size[b.axis] + by } else { -by };
                }
                Point::new(p[0], p[1])
            };
            let corner = |i: usize| {
                let before = (i + n - 1) % n;
                moved(kurbo::ParamCurve::start(&ring[i]), [borders[before], borders[i]])
            };
            out.move_to(corner(0));
            for (i, segment) in ring.iter().enumerate() {
                let end = corner((i + 1) % n);
                match segment {
                    PathSeg::Line(_) => out.line_to(end),
                    PathSeg::Quad(q) => out.quad_to(q.p1, end),
                    PathSeg::Cubic(c) => out.curve_to(c.p1, c.p2, end),
                }
            }
            out.close_path();
        }
        out
    }

    /// Whether a path runs along a border.
    pub(super) fn is_cut(&self, path: &BezPath) -> bool {
        closed_rings(path).iter().flatten().any(|s| self.border(s).is_some())
    }
}

/// The places of those that are kept, among these.
fn places_of(is_kept: &[bool]) -> Vec<Option<usize>> {
    let mut count = 0..;
    is_kept.iter().map(|kept| if *kept { count.next() } else { None }).collect()
}

/// Whether two pieces have the same paint.
fn same_paint(a: &DrawingPiece, b: &DrawingPiece) -> bool {
    let same = |(p, q): (&PieceShape, &PieceShape)| {
        let plain = p.paint.gradient.is_some() == q.paint.gradient.is_some();
        p.stroke.is_some() == q.stroke.is_some() && p.paint.colour == q.paint.colour && plain
    };
    a.parts.len() == b.parts.len() && a.layer == b.layer && a.parts.iter().zip(&b.parts).all(same)
}

/// The part of a part on the page; a stroke becomes the area that it paints.
fn clipped(part: &PieceShape, clip: &ConvexPolygon) -> Option<PieceShape> {
    let area = match &part.stroke {
        Some(stroke) => super::shapes::line(&part.path, stroke, 1.0)
            .and_then(|line| vtex_scene::element::Shape::stroked(line, part.paint.colour))
            .map(|shape| shape.outline.path().clone())?,
        None => part.path.clone(),
    };
    let path = clip.clipped(&area);
    (!path.elements().is_empty() && path.area().abs() > 1e-9).then(|| PieceShape {
        path,
        paint: part.paint.clone(),
        stroke: None,
    })
}

/// A ring as a path.
fn closed(ring: &[PathSeg]) -> BezPath {
    let mut path = BezPath::new();
    for (i, segment) in ring.iter().enumerate() {
        if i == 0 {
            path.move_to(kurbo::ParamCurve::start(segment));
        }
        match segment {
            PathSeg::Line(l) => path.line_to(l.p1),
            PathSeg::Quad(q) => path.quad_to(q.p1, q.p2),
            PathSeg::Cubic(c) => path.curve_to(c.p1, c.p2, c.p3),
        }
    }
    path.close_path();
    path
}

/// A ring in which consecutive lines of one direction are joined.
fn straightened(ring: Vec<PathSeg>, within: f64) -> Vec<PathSeg> {
    let mut out: Vec<PathSeg> = Vec::with_capacity(ring.len());
    let on_one_line = |a: Point, b: Point, c: Point| {
        let along = c - a;
        along.hypot() > 0.0
            && ((b - a).cross(along) / along.hypot()).abs() <= within
            && (b - a).dot(c - b) >= 0.0
    };
    for segment in ring {
        if let (Some(PathSeg::Line(last)), PathSeg::Line(new)) = (out.last_mut(), segment)
            && on_one_line(last.p0, last.p1, new.p1)
        {
            last.p1 = new.p1;
            continue;
        }
        out.push(segment);
    }
    if let (Some(PathSeg::Line(first)), Some(PathSeg::Line(last))) =
        (out.first().copied(), out.last().copied())
        && out.len() > 3
        && on_one_line(last.p0, last.p1, first.p1)
    {
        out.pop();
        out[0] = PathSeg::Line(kurbo::Line::new(last.p0, first.p1));
    }
    out
}
