//! Distances between random small patches: sliced Wasserstein at several scales (Karras and others
//! 2018), and nearest neighbours of each picture's patches in the other (Simakov and others 2008).
//!
//! Patches and directions come from random streams with a fixed seed. Other draws would give
//! slightly different values; `docs/measurements/metrics.md` says by how much.

use super::plane::{Channel, dot};
use vtex_base::parallel;
use vtex_base::sampling::{Stream, stream};

/// Levels of the Laplacian pyramid.
const LEVELS: usize = 4;
/// Side of the patches taken from the pyramid, in pixels.
const SIDE: usize = 7;
/// Number of patches per picture and level.
const PATCHES: usize = 6000;
/// Number of directions onto which patches are projected.
const DIRECTIONS: u64 = 256;
/// Side of the patches compared by nearest neighbours, in pixels.
const SOUGHT_SIDE: usize = 9;
/// Number of patches whose nearest neighbour is sought, and number of patches searched.
const SOUGHT: [usize; 2] = [1200, 5000];
/// Subsampling steps of the two scales at which nearest neighbours are sought.
const STEPS: [usize; 2] = [2, 4];

/// Three channels of the same size.
pub(super) type Channels = [Channel; 3];

/// Sliced Wasserstein distance between patches of the Laplacian pyramids, in standard deviations of
/// the first picture's. One value per level, the finest first, for the levels large enough for a patch.
pub(super) fn swd(a: &Channels, b: &Channels) -> Vec<f64> {
    let (a, b) = (pyramid(a), pyramid(b));
    let levels = a.iter().zip(&b).zip(0..);
    let holds = |p: &Channels| p[0].width.min(p[0].height) >= SIDE;
    levels
        .take_while(|((a, b), _)| holds(a) && holds(b))
        .map(|((a, b), level)| at_level(a, b, level))
        .collect()
}

fn at_level(a: &Channels, b: &Channels, level: u64) -> f64 {
    let mut random = stream(0, "metrics/patches", level);
    let mut a = PicturePatches::draw(a, SIDE, PATCHES, &mut random);
    let mut b = PicturePatches::draw(b, SIDE, PATCHES, &mut random);
    for (channel, (mean, deviation)) in a.channels().into_iter().enumerate() {
        for patches in [&mut a, &mut b] {
            patches.scale(channel, mean, deviation + 0.004);
        }
    }
    let directions: Vec<u64> = (0..DIRECTIONS).collect();
    let (a, b) = (Distinct::of(&a), Distinct::of(&b));
    let distances = parallel::map(&directions, |&k| {
        let mut random = stream(0, "metrics/directions", level * DIRECTIONS + k);
        let direction: Vec<f64> = (0..a.patches.length).map(|_| random.normal()).collect();
        let length = libm::sqrt(direction.iter().map(|v| v * v).sum());
        let direction: Vec<f32> = direction.iter().map(|v| (v / length) as f32).collect();
        let pairs = a.sorted_along(&direction).into_iter().zip(b.sorted_along(&direction));
        pairs.map(|(x, y)| f64::from((x - y).abs())).sum::<f64>() / PATCHES as f64
    });
    distances.iter().sum::<f64>() / DIRECTIONS as f64
}

/// The patches of a picture that differ, each with its number: small pictures and flat ones have few.
struct Distinct<'a> {
    patches: &'a PicturePatches,
    /// Index of a patch, and how many are equal to it.
    all: Vec<(usize, usize)>,
}

impl<'a> Distinct<'a> {
    fn of(patches: &'a PicturePatches) -> Self {
        let bits = |i: &usize| patches.get(*i).iter().map(|v| v.to_bits());
        let mut order: Vec<usize> = (0..patches.corners.len()).collect();
        order.sort_unstable_by(|i, j| bits(i).cmp(bits(j)));
        let equal = order.chunk_by(|i, j| bits(i).eq(bits(j)));
        Self { patches, all: equal.map(|equal| (equal[0], equal.len())).collect() }
    }

    /// The lengths of all patches along a direction, in ascending order.
    fn sorted_along(&self, direction: &[f32]) -> Vec<f32> {
        let mut along: Vec<(f32, usize)> =
            self.all.iter().map(|&(i, count)| (dot(self.patches.get(i), direction), count)).collect();
        along.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        along.into_iter().flat_map(|(length, count)| std::iter::repeat_n(length, count)).collect()
    }
}

/// The Laplacian pyramid: each level's difference from the next coarser one, and the coarsest level.
fn pyramid(channels: &Channels) -> Vec<Channels> {
    let mut levels = Vec::new();
    let mut current = channels.clone();
    for _ in 1..LEVELS {
        let smaller = current.each_ref().map(|p| p.smooth(1.0).every(2));
        let [a, b, c] = [0, 1, 2].map(|k| {
            let (fine, coarse) = (&current[k], &smaller[k]);
            fine.zip(&coarse.resized(fine.width, fine.height), |f, c| f - c)
        });
        levels.push([a, b, c]);
        current = smaller;
    }
    levels.push(current);
    levels
}

/// Nearest-neighbour distances between the patches of two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Completeness {
    /// Mean distance of the second picture's patches to the nearest of the first, relative to that among
    /// the first picture's own patches.
    pub(super) coherence: f64,
    /// Mean distance of the first picture's patches to the nearest of the second, relative to that among
    /// the first picture's own patches.
    pub(super) completeness: f64,
}

/// Mean over two scales; `None` if neither has enough patches.
pub(super) fn completeness(a: &Channels, b: &Channels) -> Option<Completeness> {
    let found: Vec<Completeness> = STEPS.iter().filter_map(|step| at_step(a, b, *step)).collect();
    let mean = |value: fn(&Completeness) -> f64| {
        (!found.is_empty()).then(|| found.iter().map(value).sum::<f64>() / found.len() as f64)
    };
    Some(Completeness { coherence: mean(|c| c.coherence)?, completeness: mean(|c| c.completeness)? })
}

fn at_step(a: &Channels, b: &Channels, step: usize) -> Option<Completeness> {
    let smaller = |p: &Channels| p.each_ref().map(|p| p.smooth(step as f64 / 2.0).every(step));
    let (a, b) = (smaller(a), smaller(b));
    let sides = [&a, &b].map(|p| p[0].width.min(p[0].height));
    if sides.iter().any(|side| *side < 3 * SOUGHT_SIDE) {
        return None;
    }
    let mut random = stream(0, "metrics/patches", (LEVELS + step) as u64);
    let mut draw = |p: &Channels, count: usize| PicturePatches::draw(p, SOUGHT_SIDE, count, &mut random);
    let (among_a, among_b) = (draw(&a, SOUGHT[1]), draw(&b, SOUGHT[1]));
    let (of_a, of_b) = (draw(&a, SOUGHT[0]), draw(&b, SOUGHT[0]));
    let own = of_a.mean_nearest(&among_a, true) + 1e-6;
    Some(Completeness {
        coherence: of_b.mean_nearest(&among_a, false) / own,
        completeness: of_a.mean_nearest(&among_b, false) / own,
    })
}

/// Patches of a picture, each a row of values, channel by channel.
struct PicturePatches {
    data: Vec<f32>,
    /// Number of values in a patch.
    length: usize,
    /// Upper left corner of each patch.
    corners: Vec<[usize; 2]>,
}

impl PicturePatches {
    fn draw(channels: &Channels, side: usize, count: usize, random: &mut Stream) -> Self {
        let free = [channels[0].width, channels[0].height].map(|s| s - side + 1);
        let corners: Vec<[usize; 2]> = (0..count).map(|_| free.map(|n| random.index(n))).collect();
        let mut data = Vec::with_capacity(count * 3 * side * side);
        for [x, y] in &corners {
            for plane in channels {
                (*y..y + side).for_each(|y| data.extend_from_slice(&plane.row(y)[*x..x + side]));
            }
        }
        Self { data, length: 3 * side * side, corners }
    }

    fn iter(&self) -> impl Iterator<Item = &[f32]> {
        self.data.chunks_exact(self.length)
    }

    fn get(&self, index: usize) -> &[f32] {
        &self.data[index * self.length..(index + 1) * self.length]
    }

    /// Mean and standard deviation of each channel.
    fn channels(&self) -> [(f64, f64); 3] {
        [0, 1, 2].map(|c| {
            let part = self.length / 3;
            let values = || self.iter().flat_map(|p| &p[c * part..(c + 1) * part]).map(|v| f64::from(*v));
            let count = (self.corners.len() * part) as f64;
            let mean = values().sum::<f64>() / count;
            (mean, libm::sqrt(values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count))
        })
    }

    fn scale(&mut self, channel: usize, mean: f64, unit: f64) {
        let part = self.length / 3;
        for patch in self.data.chunks_exact_mut(self.length) {
            let values = patch[channel * part..(channel + 1) * part].iter_mut();
            values.for_each(|v| *v = ((f64::from(*v) - mean) / unit) as f32);
        }
    }

    /// The patches at a third of their resolution.
    fn coarse(&self) -> Vec<CoarsePatch> {
        self.iter().map(CoarsePatch::new).collect()
    }

    /// Mean distance of each patch to its nearest among `others`. With `apart`, overlapping patches are
    /// ignored.
    fn mean_nearest(&self, others: &Self, apart: bool) -> f64 {
        let numbers: Vec<usize> = (0..self.corners.len()).collect();
        let [outlined, known] = [self, others].map(PicturePatches::coarse);
        // From the darkest to the lightest.
        let mut order: Vec<usize> = (0..known.len()).collect();
        order.sort_by(|i, j| known[*i].light.total_cmp(&known[*j].light));
        let over = |a: &[usize; 2], b: &[usize; 2]| (0..2).all(|k| a[k].abs_diff(b[k]) < SOUGHT_SIDE);
        let distances = parallel::map(&numbers, |&i| {
            let (own, coarse) = (self.get(i), &outlined[i]);
            let lighter = order.partition_point(|&other| known[other].light < coarse.light);
            let mut darker = order[..lighter].iter().rev().copied().peekable();
            let mut lighter = order[lighter..].iter().copied().peekable();
            let mut best = f32::INFINITY;
            loop {
                let least = |other: Option<&usize>| {
                    other.map_or(f32::INFINITY, |&k| coarse.least_by_light(&known[k]))
                };
                let (dark, light) = (least(darker.peek()), least(lighter.peek()));
                let next = if dark <= light { darker.next() } else { lighter.next() };
                // Of the others none is nearer.
                let Some(k) = next.filter(|_| best > 0.0 && dark.min(light) <= best) else { break };
                if coarse.least(&known[k]) <= best && !(apart && over(&self.corners[i], &others.corners[k])) {
                    best = best.min(squared_distance(own, others.get(k), best));
                }
            }
            libm::sqrt(f64::from(best))
        });
        // A patch that overlaps all others has no nearest neighbour.
        let known = || distances.iter().filter(|d| d.is_finite());
        known().sum::<f64>() / known().count().max(1) as f64
    }
}

/// A patch of [`SOUGHT_SIDE`] at a third of its resolution, from which follows how near another is at best.
struct CoarsePatch {
    /// Sum of the first channel, over the root of their number.
    light: f32,
    /// Sums of the channels' blocks of 3 x 3, likewise.
    blocks: [f32; 27],
}

impl CoarsePatch {
    fn new(patch: &[f32]) -> Self {
        const PIXELS: usize = SOUGHT_SIDE * SOUGHT_SIDE;
        let mut blocks = [0.0; 27];
        for (i, value) in patch.iter().enumerate() {
            let (channel, x, y) = (i / PIXELS, i % SOUGHT_SIDE, i % PIXELS / SOUGHT_SIDE);
            blocks[9 * channel + 3 * (y / 3) + x / 3] += value / 3.0;
        }
        Self { light: blocks[..9].iter().sum::<f32>() / 3.0, blocks }
    }

    /// A lower bound of the squared distance of the patches, by the first channel's mean.
    fn least_by_light(&self, other: &Self) -> f32 {
        Self::rounded((self.light - other.light) * (self.light - other.light))
    }

    /// A higher lower bound.
    fn least(&self, other: &Self) -> f32 {
        Self::rounded(self.blocks.iter().zip(&other.blocks).map(|(a, b)| (a - b) * (a - b)).sum())
    }

    /// A little less, for errors of rounding.
    fn rounded(bound: f32) -> f32 {
        bound * 0.999 - 1e-8
    }
}

/// Squared distance; stops early with a partial sum once it exceeds `enough`.
fn squared_distance(a: &[f32], b: &[f32], enough: f32) -> f32 {
    const STRIDE: usize = 32;
    let mut sum = 0.0;
    for (a, b) in a.chunks(STRIDE).zip(b.chunks(STRIDE)) {
        let mut lanes = [0.0f32; 8];
        let ((left, left_rest), (right, right_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
        let rest = left_rest.iter().zip(right_rest);
        sum += rest.map(|(x, y)| (x - y) * (x - y)).sum::<f32>();
        for (x, y) in left.iter().zip(right) {
            (0..8).for_each(|k| lanes[k] += (x[k] - y[k]) * (x[k] - y[k]));
        }
        sum += lanes.iter().sum::<f32>();
        if sum > enough {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels(width: usize, height: usize, length: usize) -> Channels {
        [3, 5, 7].map(|step| {
            Channel::from_fn(width, height, |x, y| ((x * step + y * 2) % length) as f32 / length as f32)
        })
    }

    #[test]
    fn a_picture_is_made_of_its_own_patches() {
        let (a, b) = (channels(72, 64, 19), channels(72, 64, 31));
        let own = completeness(&a, &a).unwrap();
        let other = completeness(&a, &b).unwrap();
        assert!(own.coherence < 1.05 && own.completeness < 1.05, "{own:?}");
        assert!(other.coherence > 1.2 && other.completeness > 1.2, "{other:?}");
        assert_eq!(completeness(&a, &channels(52, 60, 19)), None);
    }

    #[test]
    fn the_nearest_patch_is_that_of_a_search_of_all() {
        let noise = |seed: u64| -> Channels {
            let mut random = stream(seed, "metrics/patches", 9);
            [0, 1, 2].map(|_| {
                let values: Vec<f32> =
                    (0..40 * 36).map(|_| random.index(6) as f32 / 6.0).map(|v| v * v).collect();
                Channel { width: 40, height: 36, data: values }.smooth(1.0)
            })
        };
        let mut random = stream(1, "metrics/patches", 1);
        let [a, b] = [1, 2].map(|seed| PicturePatches::draw(&noise(seed), SOUGHT_SIDE, 300, &mut random));
        for (from, to, apart) in [(&a, &b, false), (&a, &a, true), (&a, &a, false)] {
            let over = |i: usize, k: usize| {
                (0..2).all(|axis| from.corners[i][axis].abs_diff(to.corners[k][axis]) < SOUGHT_SIDE)
            };
            let nearest = |i: usize| {
                let others = (0..300).filter(|&k| !(apart && over(i, k)));
                others
                    .map(|k| squared_distance(from.get(i), to.get(k), f32::INFINITY))
                    .fold(f32::INFINITY, f32::min)
            };
            let all: Vec<f64> =
                (0..300).map(nearest).filter(|v| v.is_finite()).map(|v| f64::from(v).sqrt()).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            assert_eq!(from.mean_nearest(to, apart), mean);
        }
    }

    #[test]
    fn a_pyramid_adds_up_to_the_picture() {
        let picture = channels(45, 38, 13);
        let levels = pyramid(&picture);
        assert_eq!(levels.iter().map(|l| l[0].width).collect::<Vec<_>>(), [45, 23, 12, 6]);
        let mut sum = levels[3][1].clone();
        for level in levels[..3].iter().rev() {
            sum = level[1].zip(&sum.resized(level[1].width, level[1].height), |f, c| f + c);
        }
        let off = sum.zip(&picture[1], |a, b| (a - b).abs());
        assert!(off.data.iter().all(|v| *v < 1e-5));
    }

    #[test]
    fn early_ends_are_only_taken_above_the_best() {
        let a: Vec<f32> = (0..243).map(|v| v as f32).collect();
        let b = vec![0.0; 243];
        let whole = squared_distance(&a, &b, f32::INFINITY);
        assert!((whole - 4_753_485.0).abs() < 5.0, "{whole}");
        assert!(squared_distance(&a, &b, 10.0) > 10.0);
    }
}
