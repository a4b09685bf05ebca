//! A photograph that repeats, with a margin of its continuation across its borders, so that elements cut by
//! the borders are whole.
//!
//! Masks are found in the photograph without the margin. Two masks that meet across a border are one element
//! from here on; details, secondaries and outlines are found in the photograph with its margin, and elements
//! whose centroid lies in the margin are left out, because they are copies of others.
//!
//! When this works badly: an element that a border cuts, of which only one part was found, stays cut. It is
//! known, but not placed.

use image::RgbImage;
use std::borrow::Cow;
use std::collections::BTreeMap;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::geometry::{Affine, Outline};
use vtex_base::raster::LabelMap;
use vtex_scene::library::ExemplarElement;

/// Least width of a margin, in pixels.
const LEAST: u32 = 24;
/// Room in the margin beyond the elements that reach into it, in pixels.
const ROOM: u32 = 8;
/// Largest width of a margin, as a share of the shorter side.
const MOST: f64 = 0.4;
/// Share of the longer of two contacts with a border that has to meet the other for two masks to be one
/// element.
const MEETS: f64 = 0.5;
/// Largest distance of two copies of one element after their shift, in pixels, and the largest ratio of their
/// areas.
const SAME: f64 = 1.0;
const ALIKE: f64 = 1.3;
/// A mask with fewer pixels at a border does not count as cut.
const FEW: usize = 4;

/// The margin around a photograph; its width is 0 for one that does not repeat.
pub(super) struct Margin {
    /// Size of the photograph.
    size: [u32; 2],
    /// Width on each side; 0 for no margin, with which all methods leave their input unchanged.
    width: u32,
    /// Masks that are one element across the right border, and across the lower one, by their labels: the one
    /// before the border, the one after it.
    joined: [BTreeMap<u32, u32>; 2],
    /// Labels of masks that a border cuts and that have no counterpart at the opposite border.
    cut: Vec<u32>,
}

impl Margin {
    /// No margin.
    pub(super) fn none(size: [u32; 2]) -> Self {
        Self { size, width: 0, joined: [BTreeMap::new(), BTreeMap::new()], cut: Vec::new() }
    }

    /// Width and height of the photograph without it, in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The margin that a photograph with these primaries needs.
    pub(super) fn new(primaries: &LabelMap) -> Self {
        let size = [primaries.width, primaries.height];
        let edges = [0, 1].map(|axis| edges(primaries, axis));
        let joined = edges.each_ref().map(|(before, after)| joined(before, after));
        let mut cut = Vec::new();
        let mut reach = 0;
        let bounds = bounds(primaries);
        for (axis, (before, after)) in edges.iter().enumerate() {
            for (side, line) in [before, after].into_iter().enumerate() {
                for (&label, &count) in &counts(line) {
                    let [low, high] = bounds[label as usize][axis];
                    let partner = if side == 0 {
                        joined[axis].contains_key(&label)
                    } else {
                        joined[axis].values().any(|l| *l == label)
                    };
                    if partner {
                        reach = reach.max(if side == 0 { size[axis] - low } else { high + 1 });
                    } else if count >= FEW {
                        cut.push(label);
                    }
                }
            }
        }
        let most = (f64::from(size[0].min(size[1])) * MOST) as u32;
        Self { size, width: (reach + ROOM).max(LEAST).min(most), joined, cut }
    }

    fn is_none(&self) -> bool {
        self.width == 0
    }

    /// Size of the photograph with its margin.
    fn whole(&self) -> [u32; 2] {
        self.size.map(|side| side + 2 * self.width)
    }

    /// The copy of the photograph at a place of the whole along an axis, counted from 0, and the place in
    /// that copy.
    fn copy(&self, at: u32, axis: usize) -> (u32, u32) {
        let side = self.size[axis];
        let moved = at + side - self.width;
        (moved / side, moved % side)
    }

    /// The photograph with its margin.
    pub(super) fn image<'a>(&self, image: &'a RgbImage) -> Cow<'a, RgbImage> {
        if self.is_none() {
            return Cow::Borrowed(image);
        }
        let [width, height] = self.whole();
        let pixel = |x, y| *image.get_pixel(self.copy(x, 0).1, self.copy(y, 1).1);
        Cow::Owned(RgbImage::from_fn(width, height, pixel))
    }

    /// The primaries of the photograph with its margin, numbered by their first pixel, and the labels of
    /// those that are cut.
    pub(super) fn primaries(&self, primaries: LabelMap) -> (LabelMap, Vec<u32>) {
        if self.is_none() {
            return (primaries, Vec::new());
        }
        let count = primaries.labels.iter().max().map_or(0, |most| *most as usize) + 1;
        // A node for each label in each of the nine copies.
        let node = |[i, j]: [u32; 2], label: u32| (j as usize * 3 + i as usize) * count + label as usize;
        let mut sets = DisjointSets::new(9 * count);
        for across in 0..3 {
            for along in 0..2 {
                for (&a, &b) in &self.joined[0] {
                    sets.join(node([along, across], a), node([along + 1, across], b));
                }
                for (&a, &b) in &self.joined[1] {
                    sets.join(node([across, along], a), node([across, along + 1], b));
                }
            }
        }
        let [width, height] = self.whole();
        let mut is_cut = vec![false; count];
        self.cut.iter().for_each(|&label| is_cut[label as usize] = true);
        let roots: Vec<usize> = (0..9 * count).map(|node| sets.root(node)).collect();
        // The new label of each root, 0 for none yet.
        let mut numbers = vec![0; 9 * count];
        let mut last = 0;
        let mut cut = std::collections::BTreeSet::new();
        let mut labels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let (j, row) = self.copy(y, 1);
            for x in 0..width {
                let (i, column) = self.copy(x, 0);
                let label = primaries.get(column, row);
                if label == 0 {
                    labels.push(0);
                    continue;
                }
                let new = &mut numbers[roots[node([i, j], label)]];
                if *new == 0 {
                    last += 1;
                    *new = last;
                }
                labels.push(*new);
                if is_cut[label as usize] {
                    cut.insert(*new);
                }
            }
        }
        (LabelMap { width, height, labels }, cut.into_iter().collect())
    }

    /// The part of a map of the whole that is the photograph.
    pub(super) fn inner<'a>(&self, map: &'a LabelMap) -> Cow<'a, LabelMap> {
        if self.is_none() {
            return Cow::Borrowed(map);
        }
        let [width, height] = self.size;
        let rows = (0..height).flat_map(|y| {
            let first = (y + self.width) as usize * map.width as usize + self.width as usize;
            &map.labels[first..first + width as usize]
        });
        Cow::Owned(LabelMap { width, height, labels: rows.copied().collect() })
    }

    /// Like [`Margin::inner`], with the labels of the elements that are kept. `new` gives the new label for
    /// each old one, 0 for elements that are dropped. A dropped copy takes the label of the copy that is
    /// kept.
    fn kept_labels(&self, map: &LabelMap, new: &[u32]) -> LabelMap {
        let sides = self.size.map(i64::from);
        let of = |x: i64, y: i64| map.at(x, y).map_or(0, |label| new[label as usize]);
        let mut inner = self.inner(map).into_owned();
        for (i, label) in inner.labels.iter_mut().enumerate() {
            let at = [i as i64 % sides[0], i as i64 / sides[0]].map(|v| v + i64::from(self.width));
            let copies =
                [0, -1, 1].into_iter().flat_map(|j| [0, -1, 1].map(|i| [i * sides[0], j * sides[1]]));
            let labels = copies.map(|[x, y]| of(at[0] + x, at[1] + y));
            *label = if *label == 0 { 0 } else { labels.into_iter().find(|l| *l > 0).unwrap_or(0) };
        }
        inner
    }

    /// The elements whose centroid lies in the photograph, at their places in it.
    pub(super) fn kept(&self, elements: Vec<ExemplarElement>) -> Vec<ExemplarElement> {
        self.kept_of(elements).0
    }

    /// The primaries whose centroid lies in the photograph, and their map. `map` has a label for each.
    pub(super) fn kept_primaries(
        &self,
        primaries: Vec<ExemplarElement>,
        map: LabelMap,
    ) -> (Vec<ExemplarElement>, LabelMap) {
        if self.is_none() {
            return (primaries, map);
        }
        let mut new = vec![0; primaries.len() + 1];
        let (kept, indices) = self.kept_of(primaries);
        (1..).zip(&indices).for_each(|(label, &old)| new[old + 1] = label);
        (kept, self.kept_labels(&map, &new))
    }

    /// [`Margin::kept`], with the former indices of those that are kept.
    fn kept_of(&self, elements: Vec<ExemplarElement>) -> (Vec<ExemplarElement>, Vec<usize>) {
        if self.is_none() {
            let indices = (0..elements.len()).collect();
            return (elements, indices);
        }
        let margin = f64::from(self.width);
        let size = self.size.map(f64::from);
        let mut kept = Vec::new();
        let mut indices = Vec::new();
        // Elements on a border. Their copy at the opposite border may lie on either side of it.
        let mut seam = Vec::new();
        for (i, element) in elements.into_iter().enumerate() {
            if !self.holds(element.centroid) {
                continue;
            }
            let centroid = element.centroid.map(|v| v - margin);
            if !(0..2).all(|k| (SAME..size[k] - SAME).contains(&centroid[k])) {
                let own = (centroid, element.area);
                if seam.iter().any(|other| self.is_copy(*other, own)) {
                    continue;
                }
                seam.push(own);
            }
            let home = [0, 1].map(|k| match centroid[k] {
                low if low < 0.0 => size[k],
                high if high >= size[k] => -size[k],
                _ => 0.0,
            });
            let shift = Affine::translate((home[0] - margin, home[1] - margin));
            let moved = |outline: Outline| Outline::new(&(shift * outline.path())).unwrap_or_default();
            kept.push(ExemplarElement {
                centroid: [0, 1].map(|k| libm::floor((centroid[k] + home[k]) * 1e4) / 1e4),
                silhouette: element.silhouette.map(moved),
                shapes: element.shapes.iter().map(|shape| shape.moved(shift)).collect(),
                ..element
            });
            indices.push(i);
        }
        (kept, indices)
    }

    /// Whether one of two elements, each with its centroid and area, is the other's copy at another border.
    fn is_copy(&self, (a, one): ([f64; 2], u32), (b, other): ([f64; 2], u32)) -> bool {
        let off = |k: usize| {
            let way = (a[k] - b[k]).abs();
            way.min((way - f64::from(self.size[k])).abs())
        };
        let far = (0..2).any(|k| (a[k] - b[k]).abs() > f64::from(self.size[k]) / 2.0);
        far && off(0) < SAME && off(1) < SAME && f64::from(one.max(other)) < ALIKE * f64::from(one.min(other))
    }

    /// Place in the photograph with its margin → place in the photograph.
    pub(super) fn place(&self, at: [f64; 2]) -> [f64; 2] {
        if self.is_none() {
            return at;
        }
        [0, 1].map(|k| (at[k] - f64::from(self.width)).rem_euclid(f64::from(self.size[k])))
    }

    /// Whether an element with this centroid, in the photograph with its margin, may be kept.
    pub(super) fn holds(&self, at: [f64; 2]) -> bool {
        let margin = f64::from(self.width);
        self.is_none()
            || (0..2).all(|k| (margin - SAME..margin + f64::from(self.size[k]) + SAME).contains(&at[k]))
    }
}

/// The labels along the last line of pixels across an axis, and along the first.
fn edges(map: &LabelMap, axis: usize) -> (Vec<u32>, Vec<u32>) {
    let [last, count] = if axis == 0 { [map.width - 1, map.height] } else { [map.height - 1, map.width] };
    let line =
        |at: u32| (0..count).map(|k| if axis == 0 { map.get(at, k) } else { map.get(k, at) }).collect();
    (line(last), line(0))
}

/// Number of pixels of each label in a line.
fn counts(line: &[u32]) -> BTreeMap<u32, usize> {
    let mut counts = BTreeMap::new();
    line.iter().filter(|label| **label > 0).for_each(|label| *counts.entry(*label).or_insert(0) += 1);
    counts
}

/// The pairs of labels of two adjacent lines that are one element.
fn joined(before: &[u32], after: &[u32]) -> BTreeMap<u32, u32> {
    let [first, second] = [before, after].map(counts);
    let mut meet: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (&a, &b) in before.iter().zip(after).filter(|(a, b)| **a > 0 && **b > 0 && a != b) {
        *meet.entry((a, b)).or_insert(0) += 1;
    }
    // More than half of the longer contact, so no label has two partners.
    let longer = |(a, b): &(u32, u32)| first[a].max(second[b]) as f64;
    meet.into_iter().filter(|(pair, n)| *n as f64 > MEETS * longer(pair)).map(|(pair, _)| pair).collect()
}

/// First and last pixel of each label along both axes; an empty range for a label that does not occur.
fn bounds(map: &LabelMap) -> Vec<[[u32; 2]; 2]> {
    let count = map.labels.iter().max().map_or(0, |most| *most as usize) + 1;
    let mut bounds = vec![[[u32::MAX, 0]; 2]; count];
    for (i, &label) in map.labels.iter().enumerate() {
        let at = [i as u32 % map.width, i as u32 / map.width];
        for (bound, v) in bounds[label as usize].iter_mut().zip(at) {
            *bound = [bound[0].min(v), bound[1].max(v)];
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use crate::{AnalyzeParams, Exemplar, analyze};
    use image::{Rgb, RgbImage};
    use vtex_scene::element;
    use vtex_scene::library::Library;
    use vtex_segment::segment::Felzenszwalb;

    /// Dark discs of several sizes on light ground, on a torus.
    const DISCS: [[i64; 3]; 7] =
        [[0, 30, 11], [40, 0, 9], [95, 95, 12], [60, 50, 10], [25, 70, 8], [70, 20, 7], [58, 78, 6]];
    const SIDE: i64 = 96;

    fn discs() -> RgbImage {
        RgbImage::from_fn(SIDE as u32, SIDE as u32, |x, y| {
            let way = |a: i64, b: i64| {
                let d = (a - b).rem_euclid(SIDE);
                d.min(SIDE - d)
            };
            let inside = |[cx, cy, r]: &[i64; 3]| {
                let (dx, dy) = (way(i64::from(x), *cx), way(i64::from(y), *cy));
                dx * dx + dy * dy <= r * r
            };
            Rgb(if DISCS.iter().any(inside) { [60, 40, 30] } else { [210, 205, 190] })
        })
    }

    fn library(image: RgbImage, wrap: bool) -> Library {
        let exemplar = Exemplar {
            image,
            copies: [1; 2],
            file: "discs.png".into(),
            sha256: "0".repeat(64),
            layers: None,
            warnings: Vec::new(),
        };
        let params = AnalyzeParams { wrap, layers: 1, ..AnalyzeParams::default() };
        analyze(&exemplar, &Felzenszwalb::default(), &params, &()).unwrap()
    }

    #[test]
    fn what_the_borders_cut_is_one_element() {
        let cut = library(discs(), false);
        // Two in halves, one in quarters.
        assert_eq!(cut.primaries().iter().filter(|p| p.clipped).count(), 8);
        let whole = library(discs(), true);
        assert_eq!((whole.primaries().len(), whole.arrangement.periodic), (DISCS.len(), true));
        for [x, y, r] in DISCS {
            let area = std::f64::consts::PI * (r * r) as f64;
            let way = |a: f64, b: i64| {
                let d = (a - b as f64 - 0.5).rem_euclid(SIDE as f64);
                d.min(SIDE as f64 - d)
            };
            let near = |c: [f64; 2]| way(c[0], x) + way(c[1], y) < 1.5;
            let found = whole.primaries().iter().position(|p| near(p.centroid)).unwrap();
            let primary = &whole.primaries()[found];
            assert!(!primary.clipped && (f64::from(primary.area) / area - 1.0).abs() < 0.2, "{x} {y}");
            let bounds = element::bounds(&primary.shapes);
            assert!((bounds.width() - (2 * r + 1) as f64).abs() < 2.5, "{x} {y} {bounds:?}");
            // All its pixels have its label, at all borders of the photograph.
            let labels = whole.arrangement.to_labels();
            let pixels = labels.labels.iter().filter(|l| **l as usize == found + 1).count();
            assert!((pixels as f64 / area - 1.0).abs() < 0.2, "{x} {y} {pixels}");
        }
    }

    #[test]
    fn the_part_of_an_element_that_nothing_meets_is_not_placed() {
        // Half a disc at the right border, with nothing on the other side.
        let image = RgbImage::from_fn(96, 96, |x, y| {
            let (dx, dy) = (i64::from(x) - 95, i64::from(y) - 48);
            Rgb(if dx * dx + dy * dy < 150 { [60, 40, 30] } else { [210, 205, 190] })
        });
        let library = library(image, true);
        assert_eq!((library.primaries().len(), library.primaries()[0].clipped), (1, true));
    }
}
