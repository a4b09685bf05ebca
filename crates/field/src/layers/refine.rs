//! Borders of layers, drawn again pixel by pixel.
//!
//! Layers are found in a blurred picture, so their borders are smooth; those of rust, lichen and peeling paint are
//! ragged. Within a band around each border, a pixel belongs to the layer whose mean colour nearby is closer to its
//! own. A pixel near the border as it was found needs less evidence to stay than to change. What changes is joined
//! to its layer: single spots within another layer are elements, not layers.

use super::clean::without_specks;
use image::RgbImage;
use vtex_base::parallel;
use vtex_base::raster::blur::{Plane, oklab_planes};
use vtex_base::raster::{Connectivity, LabelMap, components, squared_distance};

/// Half the width of the band, as a share of the shorter side: twice the blur with which borders were found.
const BAND: f32 = 1.0 / 64.0;
/// Standard deviation of the window of mean colours, in bands.
const WINDOW: f32 = 1.5;
/// Standard deviations of the blurs of colours and of evidence, in pixels.
const BLURS: [f32; 2] = [0.8, 1.0];
/// Evidence that a whole band is worth. The difference between two layers is worth 1.
const NEARNESS: f32 = 0.35;
/// Most evidence of one pixel.
const MOST: f32 = 1.5;
/// Squared difference of two mean colours that counts as none, in Oklab.
const ALIKE: f32 = 1e-5;
/// Smallest piece of a layer, as a share of the squared shorter side.
const SPECK: f64 = 2.5e-5;

/// The map of a photograph, of `count` labels, with its borders drawn again. Lightness counts `lightness` times as
/// much as hue and chroma.
pub(super) fn refined(map: &LabelMap, count: usize, image: &RgbImage, lightness: f32) -> LabelMap {
    let size = [map.width as usize, map.height as usize];
    let shorter = size[0].min(size[1]);
    let band = BAND * shorter as f32;
    if count < 2 || band < 1.0 {
        return map.clone();
    }
    let planes = oklab_planes(image, 1).map(|plane| plane.blurred(BLURS[0], [false; 2]));
    let colours = LayerColours::new(map, count, &planes, lightness, band);
    let distances = distances(map, count);
    let mut evidence = vec![0f32; map.labels.len() * count];
    parallel::for_chunks(&mut evidence, size[0] * count, |y, row| {
        for (x, out) in row.chunks_mut(count).enumerate() {
            let i = y * size[0] + x;
            let colour = planes.each_ref().map(|plane| plane.values[i]);
            colours.costs([x, y], colour, |k| distances[k][i] < band, out);
        }
    });
    let costs: Vec<Plane> = (0..count)
        .map(|k| {
            let values = evidence.iter().skip(k).step_by(count).copied().collect();
            Plane { size, values }.blurred(BLURS[1], [false; 2])
        })
        .collect();
    let label = |i: usize| {
        let own = map.labels[i] as usize;
        let to_others = (0..count).filter(|&k| k != own).map(|k| distances[k][i]).fold(band, f32::min);
        let cost = |k: usize| {
            let depth = if k == own { to_others } else { -distances[k][i] };
            costs[k].values[i] - NEARNESS * depth / band
        };
        let near = (0..count).filter(|&k| distances[k][i] < band);
        near.min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(own) as u32
    };
    let wanted = LabelMap { labels: (0..map.labels.len()).map(label).collect(), ..*map };
    let least = libm::ceil(SPECK * (shorter * shorter) as f64) as usize;
    without_specks(joined(map, wanted), count, least, [false; 2])
}

/// The distance of each pixel from the border of each label, in pixels; 0 or less within it.
fn distances(map: &LabelMap, count: usize) -> Vec<Vec<f32>> {
    let labels: Vec<u32> = (0..count as u32).collect();
    parallel::map(&labels, |&label| {
        let squares = squared_distance(map.width as usize, map.height as usize, |i| map.labels[i] == label);
        // Borders lie half a pixel from the centres of adjacent pixels.
        squares.into_iter().map(|square| libm::sqrtf(square) - 0.5).collect()
    })
}

/// `wanted`, with the labels of `map` where a piece of it has no pixel in common with `map`.
fn joined(map: &LabelMap, mut wanted: LabelMap) -> LabelMap {
    let counted = LabelMap { labels: wanted.labels.iter().map(|l| l + 1).collect(), ..*map };
    let (pieces, labels) = components(&counted, Connectivity::Four);
    let mut is_joined = vec![false; labels.len()];
    for ((&piece, own), before) in pieces.labels.iter().zip(&wanted.labels).zip(&map.labels) {
        is_joined[piece as usize] |= own == before;
    }
    for ((label, before), &piece) in wanted.labels.iter_mut().zip(&map.labels).zip(&pieces.labels) {
        if !is_joined[piece as usize] {
            *label = *before;
        }
    }
    wanted
}

/// The mean colours of layers around each place, on a coarse grid.
struct LayerColours {
    grid: [usize; 2],
    /// Side of its cells, in pixels.
    cell: usize,
    lightness: f32,
    /// Of each layer: sums of the three components, then of pixels.
    sums: Vec<[Plane; 4]>,
}

impl LayerColours {
    fn new(map: &LabelMap, count: usize, planes: &[Plane; 3], lightness: f32, band: f32) -> Self {
        let size = planes[0].size;
        let cell = (band / 2.0).max(1.0) as usize;
        let grid = size.map(|v| v.div_ceil(cell));
        let blank = || Plane { size: grid, values: vec![0.0; grid[0] * grid[1]] };
        let mut sums: Vec<[Plane; 4]> = (0..count).map(|_| std::array::from_fn(|_| blank())).collect();
        for (i, &label) in map.labels.iter().enumerate() {
            let at = i / size[0] / cell * grid[0] + i % size[0] / cell;
            let own = &mut sums[label as usize];
            (0..3).for_each(|c| own[c].values[at] += planes[c].values[i]);
            own[3].values[at] += 1.0;
        }
        let sigma = WINDOW * band / cell as f32;
        let sums = sums.into_iter().map(|own| own.map(|plane| plane.blurred(sigma, [false; 2]))).collect();
        Self { grid, cell, lightness, sums }
    }

    /// The costs of the layers that are `near` a pixel of the given colour, relative to the least of them. A cost is
    /// a squared difference of colours, in units of that between the two layers near here that are most alike.
    fn costs(&self, at: [usize; 2], colour: [f32; 3], near: impl Fn(usize) -> bool, costs: &mut [f32]) {
        costs.fill(MOST);
        let near: Vec<usize> = (0..self.sums.len()).filter(|&k| near(k)).collect();
        if near.len() < 2 {
            return;
        }
        let means: Vec<[f32; 3]> = near.iter().map(|&k| self.mean(k, at)).collect();
        let apart = |a: [f32; 3], b: [f32; 3]| {
            let [l, a, b] = std::array::from_fn(|c| a[c] - b[c]);
            (self.lightness * l) * (self.lightness * l) + a * a + b * b
        };
        let pairs = (0..near.len()).flat_map(|i| (i + 1..near.len()).map(move |j| [i, j]));
        let unit = pairs.map(|[i, j]| apart(means[i], means[j])).fold(f32::INFINITY, f32::min) + ALIKE;
        let own: Vec<f32> = means.iter().map(|&mean| apart(colour, mean) / unit).collect();
        let least = own.iter().copied().fold(f32::INFINITY, f32::min);
        near.iter().zip(own).for_each(|(&k, cost)| costs[k] = (cost - least).min(MOST));
    }

    /// The mean colour of a layer around a pixel.
    fn mean(&self, layer: usize, at: [usize; 2]) -> [f32; 3] {
        let axis = |k: usize| {
            let v = ((at[k] as f32 + 0.5) / self.cell as f32 - 0.5).clamp(0.0, (self.grid[k] - 1) as f32);
            let low = v as usize;
            (low, (low + 1).min(self.grid[k] - 1), v - low as f32)
        };
        let ((x0, x1, u), (y0, y1, v)) = (axis(0), axis(1));
        let [l, a, b, pixels] = self.sums[layer].each_ref().map(|plane| {
            let top = plane.at(x0, y0) * (1.0 - u) + plane.at(x1, y0) * u;
            let low = plane.at(x0, y1) * (1.0 - u) + plane.at(x1, y1) * u;
            top * (1.0 - v) + low * v
        });
        [l, a, b].map(|sum| sum / pixels.max(f32::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::sampling::stream;

    /// Two layers with a ragged border along x = 128, and the same with a straight one.
    fn ragged(grain: f64) -> (RgbImage, LabelMap, LabelMap) {
        let is_rust = |x: u32, y: u32| {
            let tooth = 2.5 * libm::sin(f64::from(y) * 0.35) + libm::sin(f64::from(y) * 0.9);
            f64::from(x) > 128.0 + tooth
        };
        let mut random = stream(3, "grain", 0);
        let photo = RgbImage::from_fn(256, 256, |x, y| {
            let colour = if is_rust(x, y) { [150.0, 90.0, 50.0] } else { [190.0, 190.0, 185.0] };
            let grain = random.range(-grain, grain);
            Rgb(colour.map(|v: f64| (v + grain) as u8))
        });
        let labels = |inside: &dyn Fn(u32, u32) -> bool| LabelMap {
            width: 256,
            height: 256,
            labels: (0..256 * 256).map(|i| u32::from(inside(i % 256, i / 256))).collect(),
        };
        (photo, labels(&is_rust), labels(&|x, _| x > 128))
    }

    fn wrong(a: &LabelMap, b: &LabelMap) -> usize {
        a.labels.iter().zip(&b.labels).filter(|(a, b)| a != b).count()
    }

    #[test]
    fn borders_become_as_ragged_as_the_photographs() {
        for grain in [0.0, 25.0] {
            let (photo, painted, straight) = ragged(grain);
            let found = refined(&straight, 2, &photo, 0.5);
            let [before, after] = [&straight, &found].map(|map| wrong(map, &painted));
            assert!(after * 3 < before, "{grain}: {before} {after}");
        }
    }

    #[test]
    fn spots_within_another_layer_stay_in_it() {
        let (mut photo, painted, _) = ragged(0.0);
        for y in 100..106 {
            for x in 142..148 {
                photo.put_pixel(x, y, Rgb([190, 190, 185]));
            }
        }
        assert_eq!(refined(&painted, 2, &photo, 0.5).labels[103 * 256 + 145], 1);
    }

    #[test]
    fn layers_of_one_colour_keep_their_border() {
        let (_, _, straight) = ragged(0.0);
        let grey = RgbImage::from_pixel(256, 256, Rgb([128; 3]));
        assert_eq!(refined(&straight, 2, &grey, 0.5), straight);
        let one = LabelMap::filled(256, 256, 0);
        assert_eq!(refined(&one, 1, &grey, 0.5), one);
    }
}
