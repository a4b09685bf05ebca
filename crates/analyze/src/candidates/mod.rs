//! Overlapping scored masks → disjoint primaries.
//!
//! A mask and the masks inside it describe the same pixels twice: a flower and its petals, a stone
//! and its facets, or a patch of background and the stones on it. The paper keeps the larger mask,
//! so one stray mask of the background swallows all stones on it. Here each candidate has a
//! *quality*: its score × the strength of the image's change along its rim × the square root of
//! its compactness. From each nest, the disjoint set with the largest sum of `area · quality²` is
//! kept. A whole object has as strong a rim as its parts and is more compact, so it wins over them.
//! A patch of background has a weak rim wherever it ends arbitrarily, so it loses to the objects on
//! it. Four kinds of mask always count as background: those that span opposite borders of the
//! image, those that surround other candidates like a net, those that hold several candidates
//! with much stronger rims, and those that cut through several smaller masks.

use image::RgbImage;
use vtex_base::raster::colour::{of_pixels, oklab};
use vtex_base::raster::{Connectivity, LabelMap, Mask, complement, components_of_mask, holes};
use vtex_segment::segment::ScoredMask;

/// Quantile of the colour steps along a rim that serves as the rim's strength.
const RIM_QUANTILE: f64 = 0.35;
/// A mask whose rim is weaker than this share of its parts' mean rim is background.
const WEAK_RIM: f64 = 0.6;
/// A mask that cuts through this many smaller ones is dropped.
const CUTS_OF_BACKGROUND: usize = 3;

/// A connected mask with the measures by which candidates are compared.
struct MeasuredMask {
    mask: Mask,
    area: u32,
    bounds: (i32, i32, i32, i32),
    score: f32,
    /// Strength of the rim: the [`RIM_QUANTILE`] of the colour steps along it, in Oklab units.
    rim: f32,
    quality: f32,
}

/// Selects disjoint primaries from overlapping masks. In the label map returned, primary `k` has
/// label `k + 1`; primaries are numbered in the order of their first pixel. `minimum_area` in
/// pixels.
pub(super) fn select(image: &RgbImage, masks: &[ScoredMask], minimum_area: u32) -> LabelMap {
    let (w, h) = (image.width() as i32, image.height() as i32);
    let lab = OklabImage::new(image);
    let pieces: Vec<(Mask, f32)> = masks.iter().flat_map(|m| pieces(m, minimum_area, w, h)).collect();
    let mut candidates: Vec<MeasuredMask> =
        vtex_base::parallel::map(&pieces, |(m, s)| MeasuredMask::new(m, *s, &lab));
    candidates.sort_by(|a, b| b.area.cmp(&a.area).then(b.quality.total_cmp(&a.quality)));
    drop_duplicates(&mut candidates);
    drop_nets(&mut candidates);
    drop_cutters(&mut candidates);
    let kept = best_of_nests(&candidates);
    paint(&candidates, &kept, image.width(), image.height(), minimum_area)
}

/// The connected pieces of a mask that are large enough to be primaries, with small holes filled.
fn pieces(scored: &ScoredMask, minimum_area: u32, w: i32, h: i32) -> Vec<(Mask, f32)> {
    let mut pieces = components_of_mask(&scored.mask, Connectivity::Four);
    let largest = pieces.iter().map(Mask::area).max().unwrap_or(0);
    // Small pieces beside a large one are noise of the segmenter.
    pieces.retain(|p| p.area() >= minimum_area.max(largest / 10) && !spans_image(p, w, h));
    pieces.into_iter().map(|p| (fill_small_holes(&p, minimum_area), scored.score)).collect()
}

/// Whether a mask reaches two opposite borders.
pub(super) fn spans_image(mask: &Mask, w: i32, h: i32) -> bool {
    mask.bounds().is_some_and(|(x0, y0, x1, y1)| (x0 <= 0 && x1 >= w) || (y0 <= 0 && y1 >= h))
}

/// The mask with small holes filled: those below `minimum` pixels or a fiftieth of its area.
fn fill_small_holes(mask: &Mask, minimum: u32) -> Mask {
    let small = holes(mask).into_iter().filter(|hole| hole.area() < minimum.max(mask.area() / 50));
    let spans = small.flat_map(|hole| hole.spans().to_vec()).chain(mask.spans().to_vec());
    Mask::from_spans(spans.collect())
}

/// An image in Oklab.
pub(super) struct OklabImage {
    width: i32,
    height: i32,
    pixels: Vec<[f32; 3]>,
}

impl OklabImage {
    pub(super) fn new(image: &RgbImage) -> Self {
        let pixels = of_pixels(image, oklab);
        Self { width: image.width() as i32, height: image.height() as i32, pixels }
    }

    fn at(&self, x: i32, y: i32) -> [f32; 3] {
        let (x, y) = (x.clamp(0, self.width - 1), y.clamp(0, self.height - 1));
        self.pixels[(y * self.width + x) as usize]
    }

    /// Strength of a mask's rim, and its length in cracks (pixel edges). A colour step compares the
    /// pixels two steps inside and outside; the strength is the [`RIM_QUANTILE`] of all steps. The
    /// image border does not count as rim. A true border is strong nearly everywhere, an arbitrary cut
    /// only in places.
    pub(super) fn rim(&self, mask: &Mask) -> (f32, u32) {
        let (mut steps, mut cracks) = (Vec::new(), 0u32);
        mask.for_cracks(|[x, y], [dx, dy], thick| {
            cracks += 1;
            let (ox, oy) = (x + dx, y + dy);
            if ox < 0 || oy < 0 || ox >= self.width || oy >= self.height {
                return;
            }
            let inner = if thick { self.at(x - dx, y - dy) } else { self.at(x, y) };
            let outer = self.at(ox + dx, oy + dy);
            let d2: f32 = inner.iter().zip(outer).map(|(a, b)| (a - b) * (a - b)).sum();
            steps.push(d2.sqrt());
        });
        let at = (RIM_QUANTILE * steps.len() as f64) as usize;
        let rim = if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(at, f32::total_cmp).1 };
        (rim, cracks)
    }
}

impl MeasuredMask {
    fn new(mask: &Mask, score: f32, lab: &OklabImage) -> Self {
        let (rim, cracks) = lab.rim(mask);
        let area = mask.area();
        // The crack length of a disc is 4/π times its true perimeter; the factor makes its compactness 1.
        let length = cracks as f32 * std::f32::consts::FRAC_PI_4;
        let compactness = (4.0 * std::f32::consts::PI * area as f32 / (length * length)).min(1.0);
        let quality = score.max(1e-3) * rim * compactness.sqrt();
        let bounds = mask.bounds().unwrap_or_default();
        Self { mask: mask.clone(), area, bounds, score, rim, quality }
    }

    fn boxes_meet(&self, other: &Self) -> bool {
        let (a, b) = (self.bounds, other.bounds);
        a.0 < b.2 && b.0 < a.2 && a.1 < b.3 && b.1 < a.3
    }

    fn overlap(&self, other: &Self) -> u32 {
        if self.boxes_meet(other) { self.mask.overlap(&other.mask) } else { 0 }
    }
}

/// Of candidates whose IoU exceeds 0.8, keeps only the one with the highest score.
fn drop_duplicates(candidates: &mut Vec<MeasuredMask>) {
    let n = candidates.len();
    let mut dropped = vec![false; n];
    for i in 0..n {
        for j in i + 1..n {
            let (a, b) = (&candidates[i], &candidates[j]);
            if f64::from(b.area) < 0.8 * f64::from(a.area) {
                break; // sorted by area
            }
            if dropped[i] || dropped[j] {
                continue;
            }
            let common = a.overlap(b);
            if f64::from(common) > 0.8 * f64::from(a.area + b.area - common) {
                let worse = if (b.score, b.quality) > (a.score, a.quality) { i } else { j };
                dropped[worse] = true;
            }
        }
    }
    let mut index = 0..;
    candidates.retain(|_| !dropped[index.next().unwrap_or(0)]);
}

/// Drops candidates whose rim cuts through several smaller ones. Such a mask is a patch of
/// background with parts of the objects on it.
fn drop_cutters(candidates: &mut Vec<MeasuredMask>) {
    let cuts = |big: &MeasuredMask, small: &MeasuredMask| {
        let inside = f64::from(big.overlap(small)) / f64::from(small.area);
        2 * small.area < big.area && inside > 0.15 && inside < 0.85
    };
    let cutters: Vec<bool> = (candidates.iter().enumerate())
        .map(|(i, big)| {
            candidates[i + 1..].iter().filter(|small| cuts(big, small)).count() >= CUTS_OF_BACKGROUND
        })
        .collect();
    let mut index = 0..;
    candidates.retain(|_| !cutters[index.next().unwrap_or(0)]);
}

/// Drops candidates with two or more others in their holes: background around objects.
fn drop_nets(candidates: &mut Vec<MeasuredMask>) {
    let nets: Vec<bool> = candidates
        .iter()
        .map(|net| {
            let (x0, y0, x1, y1) = net.bounds;
            let holes: u32 = complement(&net.mask, net.bounds).area();
            if holes * 5 < net.area {
                return false;
            }
            let gaps = components_of_mask(&complement(&net.mask, net.bounds), Connectivity::Four);
            let enclosed = gaps.iter().filter(|gap| {
                gap.bounds().is_some_and(|(a, b, c, d)| a > x0 && b > y0 && c < x1 && d < y1)
                    && candidates.iter().any(|c| {
                        c.area * 2 > gap.area() && f64::from(c.mask.overlap(gap)) > 0.5 * f64::from(c.area)
                    })
            });
            enclosed.count() >= 2
        })
        .collect();
    let mut index = 0..;
    candidates.retain(|_| !nets[index.next().unwrap_or(0)]);
}

/// The disjoint set of largest total worth from every nest, as indices, largest area first.
fn best_of_nests(candidates: &[MeasuredMask]) -> Vec<usize> {
    let n = candidates.len();
    // The parent is the smallest larger candidate that contains nine tenths of this one.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut roots = Vec::new();
    for i in 0..n {
        let c = &candidates[i];
        let parent = (0..i).rev().find(|&p| {
            candidates[p].area > c.area && f64::from(candidates[p].overlap(c)) >= 0.9 * f64::from(c.area)
        });
        match parent {
            Some(p) => children[p].push(i),
            None => roots.push(i),
        }
    }
    let worth = |c: &MeasuredMask| f64::from(c.area) * f64::from(c.quality) * f64::from(c.quality);
    let mut best = vec![0.0; n];
    let mut whole = vec![false; n];
    for i in (0..n).rev() {
        let parts = &children[i];
        let sum: f64 = parts.iter().map(|&p| best[p]).sum();
        let mean_rim =
            parts.iter().map(|&p| f64::from(candidates[p].rim)).sum::<f64>() / parts.len().max(1) as f64;
        let is_background = parts.len() >= 2 && f64::from(candidates[i].rim) < WEAK_RIM * mean_rim;
        // A single part that covers most of the whole is the same object found twice: the better one wins.
        let twin = match parts[..] {
            [p] if 2 * candidates[p].area > candidates[i].area && whole[p] => Some(&candidates[p]),
            _ => None,
        };
        let better = match twin {
            Some(twin) => candidates[i].quality >= twin.quality,
            None => worth(&candidates[i]) >= sum,
        };
        whole[i] = !is_background && better;
        best[i] = if whole[i] { worth(&candidates[i]) } else { sum };
    }
    let mut kept = Vec::new();
    let mut open = roots;
    while let Some(i) = open.pop() {
        if whole[i] { kept.push(i) } else { open.extend(&children[i]) }
    }
    kept.sort_unstable();
    kept
}

/// Paints the kept candidates in ascending quality. The largest visible piece of each remains.
fn paint(
    candidates: &[MeasuredMask],
    kept: &[usize],
    width: u32,
    height: u32,
    minimum_area: u32,
) -> LabelMap {
    let mut order = kept.to_vec();
    order.sort_by(|&a, &b| candidates[a].quality.total_cmp(&candidates[b].quality).then(b.cmp(&a)));
    let mut owner = LabelMap::filled(width, height, 0);
    for (rank, &i) in order.iter().enumerate() {
        owner.fill(&candidates[i].mask, rank as u32 + 1);
    }
    let mut left: Vec<Mask> = Vec::new();
    for (rank, visible) in Mask::all_of_labels(&owner, order.len() + 1).into_iter().enumerate().skip(1) {
        let c = &candidates[order[rank - 1]];
        let piece = components_of_mask(&visible, Connectivity::Four).into_iter().max_by_key(Mask::area);
        let piece = piece.filter(|p| p.area() >= minimum_area && p.area() * 2 >= c.area);
        left.extend(piece);
    }
    left.sort_by_key(|m| m.spans().first().map(|s| (s.y, s.x0)));
    let mut map = LabelMap::filled(width, height, 0);
    for (k, mask) in left.iter().enumerate() {
        map.fill(mask, k as u32 + 1);
    }
    map
}

#[cfg(test)]
mod tests;
