//! How elements of the exemplar stand to each other: which overlap and by how much, how near the others come, and
//! where the neighbours of each are.

use crate::board::Board;
use crate::figures::{ClusterExemplar, Figure, FigurePlace};
use crate::raster::{FigurePixels, pixels};
use crate::standing::{StandingElement, StandingElements};
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::geometry::Point;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, length};
use vtex_base::parallel;

/// Neighbours known of each element, and how far away, in spacings.
const PARTNERS: usize = 12;
const PARTNERS_WITHIN: f64 = 2.5;
/// Largest clearance, in lengths of which the exemplar has 400, and the share of that of the exemplar that is kept.
const LARGEST_CLEARANCE: f64 = 32.0;
const KEPT_CLEARANCE: f64 = 0.75;
/// Most pairs of points of borders that are compared. Of drawings with more, only the nearest neighbours are measured.
const MOST_COMPARED: usize = 4_000_000_000;
/// Pairs of elements measured at a time.
const PAIRS_AT_ONCE: usize = 4096;
/// Places that differ by less are the same.
const SAME: f64 = 1.5;
/// Distance of the points of a border.
const BORDER: f64 = 2.5;
/// Shares of the exemplar's page that are farther from all elements than those counted as holes, and as wide ones.
const OPEN: f64 = 0.02;
const WIDE: f64 = 0.001;
/// Farthest that equal elements are noticed, in spacings.
const TWINS: f64 = 3.0;
/// Grid on which distances from elements are measured.
const GRID: f64 = 8.0;

/// Two places that may come near each other, and the way from the first to the second.
type NearPair = (u32, u32, [f64; 2]);

/// A neighbour of an element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementPartner {
    pub(crate) place: u32,
    pub(crate) way: [f64; 2],
}

/// What is known of the exemplar's elements. Lengths are those of which its page has about 400.
pub(crate) struct PlaceRelations<'a> {
    pub(crate) exemplar: &'a ClusterExemplar,
    /// The pixels of each figure, and those with the clearance around.
    figures: Vec<[FigurePixels; 2]>,
    /// Farthest point of each figure from its reference point.
    pub(crate) reach: Vec<f64>,
    /// The nearest neighbours of each place, by distance.
    pub(crate) partners: Vec<Vec<ElementPartner>>,
    /// Largest overlap of two categories, as a share of the smaller element.
    shares: BTreeMap<[u32; 2], f64>,
    /// Figures that look alike have one shape, whatever their colours; those that are also of one category one class.
    pub(crate) shape: Vec<u32>,
    pub(crate) class: Vec<u32>,
    /// Ways between shapes that overlap or are nearer than the clearance.
    close: BTreeMap<[u32; 2], Vec<[f64; 2]>>,
    /// Of overlapping pairs of two categories: how many there are, and in how many the first lies beneath.
    beneath: BTreeMap<[u32; 2], [u32; 2]>,
    pub(crate) clearance: f64,
    /// Typical distance of neighbours.
    pub(crate) spacing: f64,
    /// Distance from all elements that only few points of the page exceed.
    pub(crate) hole: f64,
    /// The same that hardly any point exceeds.
    pub(crate) widest: f64,
    /// Area of each place on the page, in pixels.
    pub(crate) visible: Vec<f64>,
    /// Whether each place overlaps no other: what does may be a part of something, such as a stem of its flower.
    pub(crate) alone: Vec<bool>,
    /// Share of each class among all elements. Those that the border of the page cuts count by their part on it.
    pub(crate) class_shares: Vec<f64>,
    /// Least distance of elements of each class, at most a few spacings.
    pub(crate) twin_distance: Vec<f64>,
    /// Points of each figure, close enough to tell how far others are.
    spots: Vec<Vec<[f64; 2]>>,
    /// Elements that stand on the canvas already. Their places have the numbers after those of the exemplar.
    pub(crate) standing: Option<StandingElements>,
    /// For each of these the place of the exemplar among whose neighbours it fits the best.
    like: Vec<u32>,
}

impl<'a> PlaceRelations<'a> {
    /// The relations of an exemplar. `go_on` is asked in between.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn new(exemplar: &'a ClusterExemplar, go_on: &dyn Fn() -> Result<()>) -> Result<Self> {
        let borders: Vec<Vec<[f64; 2]>> = parallel::map(&exemplar.figures, border);
        let reach: Vec<f64> =
            borders.iter().map(|b| b.iter().map(|p| length(*p)).fold(0.0, f64::max)).collect();
        let plane = exemplar.page;
        let places = &exemplar.places;
        let at: Vec<[f64; 2]> = places.iter().map(|p| p.at).collect();
        let spacing = spacing(exemplar);
        let index = PointIndex::new(plane, 2.0 * spacing, &at);
        let all: Vec<usize> = (0..places.len()).collect();
        let partners = parallel::map(&all, |&k| {
            let mut near = Vec::new();
            index.within(at[k], PARTNERS_WITHIN * spacing, |other, way| {
                if other != k {
                    near.push(ElementPartner { place: other as u32, way });
                }
            });
            near.sort_by(|a, b| length(a.way).total_cmp(&length(b.way)).then(a.place.cmp(&b.place)));
            near.truncate(PARTNERS);
            near
        });
        let largest = reach.iter().copied().fold(0.0, f64::max);
        // Pairs that may come near each other, each once.
        let mut pairs: Vec<Vec<NearPair>> = parallel::map(&all, |&k| {
            let mut near = Vec::new();
            let own = reach[places[k].figure as usize];
            index.within(at[k], own + largest + LARGEST_CLEARANCE, |other, way| {
                let both = own + reach[places[other].figure as usize] + LARGEST_CLEARANCE;
                if other > k && length(way) < both {
                    near.push((k as u32, other as u32, way));
                }
            });
            near.sort_by_key(|n| n.1);
            near
        });
        let border_of = |k: u32| &borders[places[k as usize].figure as usize];
        keep_nearest(&mut pairs, |a, b| border_of(a).len() * border_of(b).len());
        let pairs = pairs.concat();
        let of_pair = |&(a, b, way): &NearPair| gap(border_of(a), border_of(b), way);
        let mut gaps = Vec::with_capacity(pairs.len());
        for pairs in pairs.chunks(PAIRS_AT_ONCE) {
            go_on()?;
            gaps.extend(parallel::map(pairs, of_pair));
        }
        let mut nearest = vec![LARGEST_CLEARANCE; places.len()];
        for (&(a, b, _), gap) in pairs.iter().zip(&gaps) {
            for k in [a, b] {
                nearest[k as usize] = nearest[k as usize].min(*gap);
            }
        }
        nearest.sort_by(f64::total_cmp);
        let usual = nearest.get(nearest.len() / 10).copied().unwrap_or(0.0);
        let clearance = if usual < 2.0 * BORDER { 0.3 * usual } else { KEPT_CLEARANCE * usual };
        let figures = parallel::map(&exemplar.figures, |f| pixels(f, clearance));
        let shape = shapes(&borders);
        let class = classes(exemplar, &shape);
        let visible: Vec<f64> =
            places.iter().map(|p| visible(plane, p.at, &figures[p.figure as usize][0])).collect();
        let whole = |p: &FigurePlace| f64::from(figures[p.figure as usize][0].area.max(1));
        let parts: Vec<f64> = places.iter().zip(&visible).map(|(p, area)| area / whole(p)).collect();
        let mut made = Self {
            exemplar,
            figures,
            reach,
            partners,
            shares: BTreeMap::new(),
            close: BTreeMap::new(),
            class_shares: class_shares(exemplar, &class, &parts),
            visible,
            alone: vec![true; places.len()],
            twin_distance: twin_distance(exemplar, &class, spacing),
            shape,
            class,
            beneath: BTreeMap::new(),
            clearance,
            spacing,
            hole: f64::INFINITY,
            widest: f64::INFINITY,
            spots: Vec::new(),
            standing: None,
            like: Vec::new(),
        };
        made.count(&pairs, go_on)?;
        made.spots = made.figures.iter().map(|f| spots(&f[0])).collect();
        go_on()?;
        [made.hole, made.widest] = made.holes();
        Ok(made)
    }

    /// How far neighbours of an element are known.
    pub(crate) fn reach_of_partners(exemplar: &ClusterExemplar) -> f64 {
        PARTNERS_WITHIN * spacing(exemplar)
    }

    /// The relations beside elements that stand.
    ///
    /// # Errors
    /// Those of `go_on`.
    pub(crate) fn beside(
        mut self,
        standing: StandingElements,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let plane = standing.window.plane;
        self.standing = Some(standing);
        let like = Board::new(plane, &self).like_places(go_on)?;
        let neighbours: Vec<_> = like.iter().map(|k| self.partners[*k as usize].clone()).collect();
        self.partners.extend(neighbours);
        self.like = like;
        Ok(self)
    }

    /// The elements that stand.
    pub(crate) fn standing_elements(&self) -> &[StandingElement] {
        self.standing.as_ref().map_or(&[], |s| &s.elements)
    }

    /// The figure of a place, also of an element that stands.
    pub(crate) fn figure(&self, place: u32) -> u32 {
        let places = &self.exemplar.places;
        match (place as usize).checked_sub(places.len()) {
            None => places[place as usize].figure,
            Some(k) => self.standing_elements()[k].figure,
        }
    }

    /// A place itself; of an element that stands, the place of the exemplar that is like it.
    pub(crate) fn like(&self, place: u32) -> u32 {
        (place as usize).checked_sub(self.exemplar.places.len()).map_or(place, |k| self.like[k])
    }

    /// Overlaps and close pairs of the exemplar.
    fn count(&mut self, pairs: &[NearPair], go_on: &dyn Fn() -> Result<()>) -> Result<()> {
        let mut found = Vec::with_capacity(pairs.len());
        for pairs in pairs.chunks(PAIRS_AT_ONCE) {
            go_on()?;
            found.extend(parallel::map(pairs, |&(a, b, way)| {
                let [fa, fb] = [a, b].map(|k| self.exemplar.places[k as usize].figure);
                (self.overlap(fa, fb, way), self.grown_overlap(fa, fb, way))
            }));
        }
        for (&(a, b, way), (overlap, grown)) in pairs.iter().zip(found) {
            if grown == 0 {
                continue;
            }
            let [fa, fb] = [a, b].map(|k| self.exemplar.places[k as usize].figure);
            let [ca, cb] = [fa, fb].map(|f| self.exemplar.figures[f as usize].category);
            let [sa, sb] = [fa, fb].map(|f| self.shape[f as usize]);
            self.close.entry([sa, sb]).or_default().push(way);
            self.close.entry([sb, sa]).or_default().push([-way[0], -way[1]]);
            if overlap > 0 {
                self.alone[a as usize] = false;
                self.alone[b as usize] = false;
                let share = f64::from(overlap) / f64::from(self.area(fa).min(self.area(fb)));
                let known = self.shares.entry([ca.min(cb), ca.max(cb)]).or_insert(0.0);
                *known = known.max(share);
                // Places are in painting order: the first lies beneath.
                let count = self.beneath.entry([ca, cb]).or_default();
                *count = [count[0] + 1, count[1] + 1];
                self.beneath.entry([cb, ca]).or_default()[0] += 1;
            }
        }
        Ok(())
    }

    /// Share of the overlapping pairs of two categories in which the first lies beneath; `None` if there are none.
    pub(crate) fn beneath(&self, first: u32, second: u32) -> Option<f64> {
        let [fa, fb] = [first, second].map(|f| self.exemplar.figures[f as usize].category);
        let [all, below] = *self.beneath.get(&[fa, fb])?;
        Some(f64::from(below) / f64::from(all))
    }

    pub(crate) fn area(&self, figure: u32) -> u32 {
        self.figures[figure as usize][0].area
    }

    #[cfg(test)]
    pub(crate) fn pixels_of(&self, figure: u32) -> &FigurePixels {
        &self.figures[figure as usize][0]
    }

    /// Pixels that two figures share.
    pub(crate) fn overlap(&self, a: u32, b: u32, way: [f64; 2]) -> u32 {
        let by = way.map(|v| libm::round(v) as i32);
        self.figures[a as usize][0].overlap(&self.figures[b as usize][0], by)
    }

    fn grown_overlap(&self, a: u32, b: u32, way: [f64; 2]) -> u32 {
        let by = way.map(|v| libm::round(v) as i32);
        self.figures[a as usize][1].overlap(&self.figures[b as usize][0], by)
    }

    /// By how many pixels two figures are nearer than elements of the exemplar come. A figure never clashes where the
    /// exemplar has the same pair.
    pub(crate) fn clash(&self, a: u32, b: u32, way: [f64; 2]) -> f64 {
        if length(way) > self.reach[a as usize] + self.reach[b as usize] + self.clearance + 1.0 {
            return 0.0;
        }
        let grown = self.grown_overlap(a, b, way);
        if grown == 0 {
            return 0.0;
        }
        if let Some(known) = self.close.get(&[a, b].map(|f| self.shape[f as usize]))
            && known.iter().any(|k| length([k[0] - way[0], k[1] - way[1]]) < SAME)
        {
            return 0.0;
        }
        let [ca, cb] = [a, b].map(|f| self.exemplar.figures[f as usize].category);
        match self.shares.get(&[ca.min(cb), ca.max(cb)]) {
            Some(share) => {
                let most = share * f64::from(self.area(a).min(self.area(b)));
                (f64::from(self.overlap(a, b, way)) - most).max(0.0)
            }
            None => f64::from(grown),
        }
    }

    /// How far a pair is from the most similar pair of the exemplar, in units of the spacing: 0 for one that the exemplar
    /// has, at most 1.
    pub(crate) fn misfit(&self, place: u32, other: u32, way: [f64; 2]) -> f64 {
        let of = |p: &ElementPartner| {
            let off = length([p.way[0] - way[0], p.way[1] - way[1]]) / self.spacing;
            off + self.strangeness(self.exemplar.places[p.place as usize].figure, other)
        };
        self.partners[place as usize].iter().map(of).fold(1.0, f64::min)
    }

    /// How unlike two figures are: 0 for equal ones.
    pub(crate) fn strangeness(&self, a: u32, b: u32) -> f64 {
        let category = |f: u32| self.exemplar.figures[f as usize].category;
        let [same, alike] = [self.shape[a as usize] == self.shape[b as usize], category(a) == category(b)];
        match (same, alike) {
            (true, true) => 0.0,
            (true, false) | (false, true) => 0.1,
            (false, false) => 0.25,
        }
    }

    /// Distances from elements that shares [`OPEN`] and [`WIDE`] of the page exceed. Points nearer to a border that does
    /// not join do not count: what was beside it is not known.
    fn holes(&self) -> [f64; 2] {
        let points = self.exemplar.places.iter().flat_map(|p| {
            self.spots[p.figure as usize].iter().map(move |s| [p.at[0] + s[0], p.at[1] + s[1]])
        });
        let plane = self.exemplar.page;
        let within = |&(at, far): &([f64; 2], f64)| {
            (0..2).all(|k| plane.wraps[k] || at[k].min(plane.size[k] - at[k]) >= far)
        };
        let all = distances(plane, &points.collect::<Vec<_>>());
        let mut far: Vec<f64> = all.into_iter().filter(within).map(|d| d.1).collect();
        far.sort_by(f64::total_cmp);
        [OPEN, WIDE].map(|share| {
            let k = ((1.0 - share) * far.len() as f64) as usize;
            far.get(k).or(far.last()).copied().unwrap_or(f64::INFINITY)
        })
    }

    /// Points of a figure, close enough to tell how far others are.
    pub(crate) fn spots_of(&self, figure: u32) -> &[[f64; 2]] {
        &self.spots[figure as usize]
    }
}

/// Typical distance of neighbours.
fn spacing(exemplar: &ClusterExemplar) -> f64 {
    libm::sqrt(exemplar.page.area() / exemplar.places.len().max(1) as f64)
}

/// Points of a figure, some pixels apart.
fn spots(own: &FigurePixels) -> Vec<[f64; 2]> {
    let step = GRID as usize;
    let mut spots = Vec::new();
    for y in (own.rows[0]..own.rows[1]).step_by(step) {
        for run in own.runs_of(y) {
            spots.extend((run[0]..run[1]).step_by(step).map(|x| [f64::from(x) + 0.5, f64::from(y) + 0.5]));
            spots.push([f64::from(run[1]) - 0.5, f64::from(y) + 0.5]);
        }
    }
    spots
}

/// Largest difference of the borders of figures that look alike.
const ALIKE: f64 = 2.0;
/// Shapes with which a figure is compared at most.
const COMPARED: usize = 64;

/// For each figure the first that looks alike, numbered without gaps.
fn shapes(borders: &[Vec<[f64; 2]>]) -> Vec<u32> {
    let bounds = |b: &Vec<[f64; 2]>| -> [f64; 4] {
        b.iter().fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |r, p| {
            [r[0].min(p[0]), r[1].min(p[1]), r[2].max(p[0]), r[3].max(p[1])]
        })
    };
    let near = |a: &[[f64; 2]], b: &[[f64; 2]]| {
        a.iter().all(|p| b.iter().any(|q| length([q[0] - p[0], q[1] - p[1]]) < ALIKE))
    };
    let mut known: Vec<(usize, [f64; 4])> = Vec::new();
    let mut found = Vec::with_capacity(borders.len());
    for (k, own) in borders.iter().enumerate() {
        let box_of = bounds(own);
        let fits = |other: &[f64; 4]| (0..4).all(|k| (other[k] - box_of[k]).abs() < ALIKE);
        let mut alike = known.iter().enumerate().filter(|(_, o)| fits(&o.1)).take(COMPARED);
        let like = alike.find(|(_, (other, _))| near(own, &borders[*other]) && near(&borders[*other], own));
        let shape = like.map_or(known.len(), |l| l.0);
        if shape == known.len() {
            known.push((k, box_of));
        }
        found.push(shape as u32);
    }
    found
}

/// For each figure the number of its shape and category together.
fn classes(exemplar: &ClusterExemplar, shape: &[u32]) -> Vec<u32> {
    let mut known: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let of = |(figure, shape): (&Figure, &u32)| {
        let next = known.len() as u32;
        *known.entry((*shape, figure.category)).or_insert(next)
    };
    exemplar.figures.iter().zip(shape).map(of).collect()
}

/// The share of each class; `parts` are the shares of the places that lie on the page.
fn class_shares(exemplar: &ClusterExemplar, class: &[u32], parts: &[f64]) -> Vec<f64> {
    let mut counts = vec![0.0; class.len()];
    for (place, part) in exemplar.places.iter().zip(parts) {
        counts[class[place.figure as usize] as usize] += part;
    }
    let all: f64 = parts.iter().sum();
    counts.iter().map(|n| n / all.max(1e-9)).collect()
}

/// Pixels of a figure at a place that lie on the page.
fn visible(page: PeriodicPlane, at: [f64; 2], figure: &FigurePixels) -> f64 {
    let [columns, rows] = [0, 1].map(|k| {
        let low = libm::round(-at[k]) as i32;
        if page.wraps[k] { [i32::MIN, i32::MAX] } else { [low, low + libm::round(page.size[k]) as i32] }
    });
    f64::from(figure.area_within(columns, rows))
}

/// Least distance of elements of each class, at most [`TWINS`] spacings.
fn twin_distance(exemplar: &ClusterExemplar, class: &[u32], spacing: f64) -> Vec<f64> {
    let mut least = vec![TWINS * spacing; class.len()];
    let at: Vec<[f64; 2]> = exemplar.places.iter().map(|p| p.at).collect();
    let index = PointIndex::new(exemplar.page, TWINS * spacing, &at);
    for (k, place) in exemplar.places.iter().enumerate() {
        let own = class[place.figure as usize];
        index.within(place.at, TWINS * spacing, |other, way| {
            if other != k && class[exemplar.places[other].figure as usize] == own {
                least[own as usize] = least[own as usize].min(length(way));
            }
        });
    }
    least
}

/// Farthest distance that is told apart from others.
const FARTHEST: f64 = 100.0;

/// Points on a grid of a page, and their distances from the nearest of some others.
pub(crate) fn distances(plane: PeriodicPlane, points: &[[f64; 2]]) -> Vec<([f64; 2], f64)> {
    let index = PointIndex::new(plane, 2.0 * GRID, points);
    let count = plane.size.map(|v| (v / GRID).clamp(1.0, 200.0) as usize);
    let all: Vec<usize> = (0..count[0] * count[1]).collect();
    parallel::map(&all, |&k| {
        let at = [
            (0.5 + (k % count[0]) as f64) * plane.size[0] / count[0] as f64,
            (0.5 + (k / count[0]) as f64) * plane.size[1] / count[1] as f64,
        ];
        let mut radius = 2.0 * GRID;
        while radius < FARTHEST {
            if let Some((_, far)) = index.nearest(at, radius) {
                return (at, far);
            }
            radius *= 2.0;
        }
        (at, FARTHEST)
    })
}

/// Points along the border of a figure, around its reference point.
fn border(figure: &Figure) -> Vec<[f64; 2]> {
    let long: f64 = figure.outlines.iter().map(|o| o.perimeter()).sum();
    let step = BORDER.max(long / 2000.0);
    let mut points = Vec::new();
    for outline in &figure.outlines {
        for ring in outline.polygons(0.3) {
            let mut last: Point = ring[ring.len() - 1];
            for p in ring {
                let count = libm::ceil(last.distance(p) / step).max(1.0) as u32;
                points.extend((1..=count).map(|k| {
                    let q = last.lerp(p, f64::from(k) / f64::from(count));
                    [q.x, q.y]
                }));
                last = p;
            }
        }
    }
    if points.is_empty() {
        let middle = figure.bounds().center();
        points.push([middle.x, middle.y]);
    }
    points
}

/// Keeps the nearest pairs of each place, so that all together take at most [`MOST_COMPARED`] comparisons.
fn keep_nearest(pairs: &mut [Vec<NearPair>], work: impl Fn(u32, u32) -> usize) {
    let all: usize = pairs.iter().flatten().map(|&(a, b, _)| work(a, b)).sum();
    if all <= MOST_COMPARED {
        return;
    }
    let most = MOST_COMPARED / pairs.len().max(1);
    for near in pairs {
        near.sort_by(|a, b| length(a.2).total_cmp(&length(b.2)).then(a.1.cmp(&b.1)));
        let mut done = 0;
        near.retain(|&(a, b, _)| {
            done += work(a, b);
            done <= most
        });
        near.sort_by_key(|n| n.1);
    }
}

/// Least distance between points of two borders, up to [`LARGEST_CLEARANCE`].
fn gap(a: &[[f64; 2]], b: &[[f64; 2]], way: [f64; 2]) -> f64 {
    let mut least = LARGEST_CLEARANCE * LARGEST_CLEARANCE;
    for p in a {
        let from = [p[0] - way[0], p[1] - way[1]];
        for q in b {
            let (x, y) = (q[0] - from[0], q[1] - from[1]);
            least = f64::min(least, x * x + y * y);
        }
    }
    libm::sqrt(least)
}
