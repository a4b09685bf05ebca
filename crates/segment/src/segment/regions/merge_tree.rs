//! The merge tree: the order in which regions are merged, and the measurements of each node.
//!
//! Sums are stored only for regions that still grow. A node is measured when it becomes part of another.

use super::oversegmentation::GradientImage;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};

/// Bins of the histogram of gradients along a rim. Each is twice as wide as the previous one, from 0.25.
pub(super) const BINS: usize = 8;
/// Area in pixels below which the weight of a merge is reduced, by the ratio of the smaller area to it raised
/// to [`SMALL_POWER`].
const SMALL: f32 = 400.0;
/// Exponent of that ratio.
const SMALL_POWER: f32 = 0.35;

/// Sums over the pixels of a region. They add up under union.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PixelSums {
    pub(super) area: f32,
    pub(super) colour: [f64; 3],
    pub(super) colour_square: [f64; 3],
    pub(super) gradient: f64,
    /// x, y, xx, yy, xy.
    pub(super) place: [f64; 5],
    /// Sums of lightness · x and lightness · y.
    pub(super) shade: [f64; 2],
    /// First and last column and row.
    pub(super) bounds: [u32; 4],
    /// Pixel edges along each image border: left, top, right, bottom.
    pub(super) border: [u32; 4],
    /// Number of basins, the shallow ones too.
    pub(super) basins: u32,
}

impl PixelSums {
    fn add(&mut self, o: &Self) {
        self.area += o.area;
        self.gradient += o.gradient;
        for c in 0..3 {
            self.colour[c] += o.colour[c];
            self.colour_square[c] += o.colour_square[c];
        }
        for k in 0..5 {
            self.place[k] += o.place[k];
        }
        for k in 0..2 {
            self.shade[k] += o.shade[k];
            self.bounds[k] = self.bounds[k].min(o.bounds[k]);
            self.bounds[k + 2] = self.bounds[k + 2].max(o.bounds[k + 2]);
        }
        for k in 0..4 {
            self.border[k] += o.border[k];
        }
        self.basins += o.basins;
    }

    /// Mean colour.
    pub(super) fn mean(&self) -> [f32; 3] {
        self.colour.map(|c| (c / f64::from(self.area)) as f32)
    }
}

/// Sums over the pixel edges between two regions, or along the whole rim of one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RimSums {
    pub(super) length: f32,
    pub(super) gradient: f32,
    pub(super) histogram: [f32; BINS],
    /// Sum of colour steps (two pixels outside minus two pixels inside), and of their lengths.
    pub(super) step: [f32; 3],
    pub(super) step_length: f32,
    /// Number of pixel edges with a step below 2.
    pub(super) faint: f32,
}

impl RimSums {
    /// Adds `factor` times another rim. `sign` -1 reverses its steps.
    fn add(&mut self, o: &Self, factor: f32, sign: f32) {
        self.length += factor * o.length;
        self.gradient += factor * o.gradient;
        self.step_length += factor * o.step_length;
        self.faint += factor * o.faint;
        for (h, v) in self.histogram.iter_mut().zip(o.histogram) {
            *h += factor * v;
        }
        for (s, v) in self.step.iter_mut().zip(o.step) {
            *s += factor * sign * v;
        }
    }
}

/// A region: a basin with the shallow basins joined to it, or the union of several regions.
#[derive(Clone, Debug)]
pub(super) struct MergedRegion {
    pub(super) sums: PixelSums,
    pub(super) rim: RimSums,
    /// Weight of the merge that made it, not below those of its parts; 0 for a basin.
    pub(super) weight: f32,
    /// Its node.
    node: u32,
    /// The first of its borders, and the number of its borders, removed ones included.
    first: u32,
    borders: u32,
}

/// The union that a region becomes part of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Union {
    pub(super) weight: f32,
    pub(super) area: f32,
}

/// A region's place in the tree.
#[derive(Clone, Debug)]
pub(super) struct RegionNode {
    pub(super) area: f32,
    /// `None` for a basin.
    pub(super) children: Option<[u32; 2]>,
    /// `None` for a root.
    pub(super) parent: Option<u32>,
}

/// A border between two regions. Steps go from the first to the second.
#[derive(Clone, Debug)]
struct RegionBorder {
    ends: [u32; 2],
    rim: RimSums,
    alive: bool,
    /// The next border of each end.
    next: [u32; 2],
}

/// The end of a list of borders.
const END: u32 = u32::MAX;

/// The nodes in order of creation: basins first, children before parents.
pub(super) struct Tree {
    pub(super) nodes: Vec<RegionNode>,
}

/// Index of the border between two regions, by [`key`].
type Index = FxHashMap<u64, u32>;

/// The first regions, see [`Tree::new`], and the borders between them.
fn graph(
    field: &GradientImage,
    labels: &[u32],
    counts: &[u32],
) -> (Vec<PixelSums>, Vec<RegionBorder>, Index) {
    let (w, h) = (field.width, field.height);
    let count = counts.len();
    let empty =
        |&basins: &u32| PixelSums { bounds: [u32::MAX, u32::MAX, 0, 0], basins, ..PixelSums::default() };
    let mut sums: Vec<PixelSums> = counts.iter().map(empty).collect();
    let mut borders: Vec<RegionBorder> = Vec::with_capacity(3 * count);
    let mut index = Index::with_capacity_and_hasher(3 * count, Default::default());
    let mut last = (u64::MAX, 0);
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let colour = field.colours[i];
            let s = &mut sums[labels[i] as usize];
            s.area += 1.0;
            s.gradient += f64::from(field.gradient[i]);
            for c in 0..3 {
                let v = f64::from(colour[c]);
                s.colour[c] += v;
                s.colour_square[c] += v * v;
            }
            let (fx, fy) = (x as f64, y as f64);
            for (sum, v) in s.place.iter_mut().zip([fx, fy, fx * fx, fy * fy, fx * fy]) {
                *sum += v;
            }
            s.shade[0] += f64::from(colour[0]) * fx;
            s.shade[1] += f64::from(colour[0]) * fy;
            let [x0, y0, x1, y1] = s.bounds;
            s.bounds = [x0.min(x as u32), y0.min(y as u32), x1.max(x as u32), y1.max(y as u32)];
            for (n, at) in s.border.iter_mut().zip([x == 0, y == 0, x + 1 == w, y + 1 == h]) {
                *n += u32::from(at);
            }
            let mut meet = |j: usize, before: usize, after: usize| {
                let (a, b) = (labels[i], labels[j]);
                if a == b {
                    return;
                }
                let key = key(a, b);
                let found = if last.0 == key {
                    last.1
                } else {
                    *index.entry(key).or_insert_with(|| {
                        borders.push(RegionBorder {
                            ends: [a, b],
                            rim: RimSums::default(),
                            alive: true,
                            next: [END; 2],
                        });
                        borders.len() as u32 - 1
                    })
                };
                last = (key, found);
                let border = &mut borders[found as usize];
                let (p, q) = (field.colours[before], field.colours[after]);
                let sign = if border.ends[0] == a { 1.0 } else { -1.0 };
                let step = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
                let length = (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt();
                let gradient = field.gradient[i].max(field.gradient[j]);
                let bits = (4.0 * gradient).to_bits() >> 23; // exponent: 127 at 0.25
                let mut histogram = [0.0; BINS];
                histogram[(bits.saturating_sub(126) as usize).min(BINS - 1)] = 1.0;
                let faint = if length < 2.0 { 1.0 } else { 0.0 };
                let rim = RimSums { length: 1.0, gradient, histogram, step, step_length: length, faint };
                border.rim.add(&rim, 1.0, sign);
            };
            if x + 1 < w {
                meet(i + 1, if x > 0 { i - 1 } else { i }, if x + 2 < w { i + 2 } else { i + 1 });
            }
            if y + 1 < h {
                meet(i + w, if y > 0 { i - w } else { i }, if y + 2 < h { i + 2 * w } else { i + w });
            }
        }
    }
    (sums, borders, index)
}

fn key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// The properties of a region that the weight of a merge depends on.
#[derive(Clone, Copy)]
struct MergeProperties {
    mean: [f32; 3],
    /// Factor of the weight of a merge by the region's size: 1, or less if it is small.
    size: f32,
}

impl MergeProperties {
    fn new(sums: &PixelSums) -> Self {
        Self { mean: sums.mean(), size: libm::powf(sums.area.min(SMALL) / SMALL, SMALL_POWER) }
    }
}

/// Weight of a merge: the difference between two regions, reduced if one is small.
fn weight([a, b]: [&MergeProperties; 2], rim: &RimSums, border: f32) -> f32 {
    let (p, q) = (a.mean, b.mean);
    let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let means = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    let step = rim.step;
    let coherent = (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt() / rim.length;
    let across = 0.5 * (rim.step_length / rim.length + coherent);
    (border * across + (1.0 - border) * means) * a.size.min(b.size)
}

/// Borders in the order of their weights; ties: the older border first. Only those of the least weights are
/// in a heap, which stays small enough for a processor's cache; the others wait in bins.
struct Queue {
    heap: BinaryHeap<Reverse<(u32, u32)>>,
    bins: Vec<Vec<(u32, u32)>>,
    /// Number of bins whose borders are in the heap.
    taken: usize,
    /// The least weight under which each border waits, as bits; those of positive floats have their order.
    least: Vec<u32>,
}

/// Number of low bits of a weight, in which the weights of one bin differ.
const BIN: u32 = 16;

impl Queue {
    fn new(weights: impl Iterator<Item = f32>) -> Self {
        let least: Vec<u32> = weights.map(f32::to_bits).collect();
        let mut queue =
            Self { heap: BinaryHeap::new(), bins: vec![Vec::new(); 1 << (32 - BIN)], taken: 0, least };
        for e in 0..queue.least.len() {
            queue.enqueue(queue.least[e], e as u32);
        }
        queue
    }

    /// Lowers the weight under which a border waits. A weight that rose is updated when the border is popped.
    fn lower(&mut self, border: u32, weight: f32) {
        if weight.to_bits() < self.least[border as usize] {
            self.push(border, weight);
        }
    }

    fn push(&mut self, border: u32, weight: f32) {
        self.least[border as usize] = weight.to_bits();
        self.enqueue(weight.to_bits(), border);
    }

    fn enqueue(&mut self, bits: u32, border: u32) {
        let bin = (bits >> BIN) as usize;
        if bin < self.taken {
            self.heap.push(Reverse((bits, border)))
        } else {
            self.bins[bin].push((bits, border))
        }
    }

    /// The border of least weight, and that weight.
    fn pop(&mut self) -> Option<(f32, u32)> {
        loop {
            while let Some(Reverse((bits, border))) = self.heap.pop() {
                if bits == self.least[border as usize] {
                    return Some((f32::from_bits(bits), border));
                }
            }
            let bin = self.bins[self.taken..].iter().position(|bin| !bin.is_empty())?;
            self.taken += bin + 1;
            let bin = std::mem::take(&mut self.bins[self.taken - 1]);
            self.heap = bin.into_iter().map(Reverse).collect();
        }
    }
}

impl MergedRegion {
    /// Adds a border to the list.
    fn link(&mut self, e: u32, border: &mut RegionBorder, end: usize) {
        border.next[end] = self.first;
        self.first = e;
        self.borders += 1;
    }
}

impl Tree {
    /// Merges neighbours, least weight first (ties: the older border), until none are left. The first regions
    /// are those of `labels`, and `counts` the number of basins in each. `share` is the weight of the step
    /// across the border; the rest is that of the difference of means. `see` is called once for each node,
    /// with its number, the region, and the union that it becomes part of, if any; regions are not stored.
    pub(super) fn new(
        field: &GradientImage,
        labels: &[u32],
        counts: &[u32],
        share: f32,
        progress: &dyn Progress,
        see: &mut dyn FnMut(usize, &MergedRegion, Option<Union>),
    ) -> Result<Self> {
        let count = counts.len();
        let (sums, mut borders, mut index) = graph(field, labels, counts);
        let node = |sums: &PixelSums| RegionNode { area: sums.area, children: None, parent: None };
        let mut nodes: Vec<RegionNode> = Vec::with_capacity(2 * count);
        nodes.extend(sums.iter().map(node));
        let region = |(node, sums)| {
            let rim = RimSums::default();
            MergedRegion { sums, rim, weight: 0.0, node, first: END, borders: 0 }
        };
        // A region is identified by one of the first regions in it.
        let mut regions: Vec<MergedRegion> = (0..).zip(sums).map(region).collect();
        for (e, border) in (0..).zip(&mut borders) {
            for (end, sign) in [1.0, -1.0].into_iter().enumerate() {
                let region = &mut regions[border.ends[end] as usize];
                region.rim.add(&border.rim, 1.0, sign);
                region.link(e, border, end);
            }
        }
        let mut looks: Vec<MergeProperties> =
            regions.iter().map(|region| MergeProperties::new(&region.sums)).collect();
        let now = |looks: &[MergeProperties], border: &RegionBorder| {
            weight(border.ends.map(|end| &looks[end as usize]), &border.rim, share)
        };
        let mut queue = Queue::new(borders.iter().map(|border| now(&looks, border)));
        while let Some((least, e)) = queue.pop() {
            let border = &mut borders[e as usize];
            if !border.alive {
                continue;
            }
            let weight = now(&looks, border);
            if weight > least {
                queue.push(e, weight);
                continue;
            }
            let made = nodes.len();
            if made.is_multiple_of(4096) {
                advance(progress, "merging regions", (made - count) as u64, count as u64)?;
            }
            border.alive = false;
            let ends = border.ends.map(|end| end as usize);
            let parts = ends.map(|end| &regions[end]);
            let weight = weight.max(parts[0].weight).max(parts[1].weight);
            let union = Union { weight, area: parts[0].sums.area + parts[1].sums.area };
            for part in parts {
                see(part.node as usize, part, Some(union));
                nodes[part.node as usize].parent = Some(made as u32);
            }
            let children = Some(parts.map(|part| part.node));
            nodes.push(RegionNode { area: union.area, children, parent: None });
            // The region with more borders keeps its identifier.
            let [gone, kept] = if parts[0].borders < parts[1].borders { ends } else { [ends[1], ends[0]] };
            let part = regions[gone].clone();
            let whole = &mut regions[kept];
            whole.sums.add(&part.sums);
            whole.rim.add(&part.rim, 1.0, 1.0);
            whole.rim.add(&borders[e as usize].rim, -2.0, 0.0);
            (whole.weight, whole.node) = (weight, made as u32);
            looks[kept] = MergeProperties::new(&whole.sums);
            let (gone, id) = (gone as u32, kept as u32);
            let mut e = part.first;
            while e != END {
                let old = &mut borders[e as usize];
                let at = usize::from(old.ends[1] == gone);
                let (this, next) = (e, old.next[at]);
                e = next;
                if !old.alive {
                    continue;
                }
                old.ends[at] = id;
                let changed = *index.entry(key(id, old.ends[1 - at])).or_insert(this);
                if changed == this {
                    whole.link(this, old, at);
                } else {
                    old.alive = false;
                    let (ends, rim) = (old.ends, old.rim);
                    let twin = &mut borders[changed as usize];
                    twin.rim.add(&rim, 1.0, if twin.ends == ends { 1.0 } else { -1.0 });
                }
                queue.lower(changed, now(&looks, &borders[changed as usize]));
            }
        }
        for region in regions.iter().filter(|region| nodes[region.node as usize].parent.is_none()) {
            see(region.node as usize, region, None);
        }
        Ok(Self { nodes })
    }
}

#[cfg(test)]
mod tests {
    use super::super::oversegmentation::ScaledOklabImage;
    use super::*;
    use image::RgbImage;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn sums_and_rims_are_those_of_the_pixels(values in prop::collection::vec(0..6u8, 14 * 12)) {
            let image = RgbImage::from_fn(14, 12, |x, y| {
                let v = 40 * values[(y * 14 + x) as usize];
                image::Rgb([v, 255 - v, v / 2])
            });
            let field = GradientImage::new(&ScaledOklabImage::new(&image), 0.5);
            let (labels, counts) = field.deep_basins();
            let count = counts.len();
            let mut regions = vec![None; 2 * count - 1];
            let mut see = |node: usize, region: &MergedRegion, union: Option<Union>| {
                assert!(regions[node].replace((region.clone(), union)).is_none());
            };
            let tree = Tree::new(&field, &labels, &counts, 0.7, &(), &mut see).unwrap();
            prop_assert_eq!(tree.nodes.len(), 2 * count - 1);
            let regions: Vec<(MergedRegion, Option<Union>)> = regions.into_iter().map(Option::unwrap).collect();
            let mut pixels: Vec<Vec<usize>> = vec![Vec::new(); count];
            for (i, &label) in labels.iter().enumerate() {
                pixels[label as usize].push(i);
            }
            for (i, node) in tree.nodes.iter().enumerate() {
                let region = &regions[i].0;
                if let Some([a, b]) = node.children {
                    let both = [&pixels[a as usize][..], &pixels[b as usize][..]].concat();
                    pixels.push(both);
                    for child in [a, b] {
                        let union = regions[child as usize].1.unwrap();
                        prop_assert_eq!([union.weight, union.area], [regions[i].0.weight, node.area]);
                        prop_assert!(union.weight >= regions[child as usize].0.weight);
                    }
                    prop_assert_eq!(tree.nodes[b as usize].parent, Some(i as u32));
                }
                let inside = |x: usize, y: usize| pixels[i].contains(&(y * 14 + x));
                let (mut rim, mut border, mut lightness) = (0, 0, 0.0);
                for &p in &pixels[i] {
                    let (x, y) = (p % 14, p / 14);
                    rim += usize::from(x > 0 && !inside(x - 1, y)) + usize::from(x < 13 && !inside(x + 1, y));
                    rim += usize::from(y > 0 && !inside(x, y - 1)) + usize::from(y < 11 && !inside(x, y + 1));
                    border += u32::from(x == 0) + u32::from(y == 0) + u32::from(x == 13) + u32::from(y == 11);
                    lightness += field.colours[p][0];
                }
                prop_assert_eq!(region.sums.area, pixels[i].len() as f32);
                prop_assert!((region.rim.length - rim as f32).abs() < 1e-3);
                prop_assert!((region.rim.histogram.iter().sum::<f32>() - rim as f32).abs() < 1e-3);
                prop_assert_eq!(region.sums.border.iter().sum::<u32>(), border);
                prop_assert!((region.sums.mean()[0] - lightness / pixels[i].len() as f32).abs() < 1e-2);
            }
        }
    }
}
