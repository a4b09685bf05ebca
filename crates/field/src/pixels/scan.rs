//! Pixel-by-pixel synthesis with a codebook of neighbourhoods (Wei and Levoy, as in `tsvq.rs`).

use super::Leaf;
use super::tsvq::Codebook;
use image::RgbImage;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::oklab;
use vtex_base::sampling::stream;

/// Leaves of a codebook (the paper: 4096).
const LEAVES: usize = 4096;
/// Most neighbourhoods that a codebook is made from.
const MOST_KNOWN: usize = 1 << 16;
/// Most levels, and the shortest side of the coarsest.
const LEVELS: usize = 6;
const COARSEST: u32 = 16;
/// Scans of each level. In the second, the pixels across the seams are known.
const SCANS: usize = 2;
/// Radius of a neighbourhood in pixels, on the level and on the next coarser one.
const REACH: [i64; 2] = [3, 1];

/// A picture on one level, in Oklab.
struct PictureLevel {
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
}

impl PictureLevel {
    fn new(image: &RgbImage) -> Self {
        let size = [image.width() as usize, image.height() as usize];
        Self { size, pixels: image.pixels().map(|p| oklab(p.0)).collect() }
    }

    /// The level at half the resolution: means of 2 × 2 pixels.
    fn halved(&self) -> Self {
        let size = self.size.map(|v| (v / 2).max(1));
        let mean = |i: usize| {
            let [x, y] = [i % size[0] * 2, i / size[0] * 2];
            let at = |dx: usize, dy: usize| {
                self.pixels[(y + dy).min(self.size[1] - 1) * self.size[0] + (x + dx).min(self.size[0] - 1)]
            };
            let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            std::array::from_fn(|c| four.iter().map(|p| p[c]).sum::<f32>() / 4.0)
        };
        Self { size, pixels: (0..size[0] * size[1]).map(mean).collect() }
    }

    /// The pixel at a place; places wrap around.
    fn at(&self, x: i64, y: i64) -> [f32; 3] {
        let [x, y] = [x.rem_euclid(self.size[0] as i64), y.rem_euclid(self.size[1] as i64)];
        self.pixels[y as usize * self.size[0] + x as usize]
    }

    /// The causal neighbourhood of a pixel: the earlier pixels within 7 × 7, and 3 × 3 pixels of the
    /// coarser level.
    fn neighbourhood(&self, coarser: Option<&Self>, x: i64, y: i64, to: &mut Vec<f32>) {
        for dy in -REACH[0]..=0 {
            let last = if dy == 0 { -1 } else { REACH[0] };
            (-REACH[0]..=last).for_each(|dx| to.extend(self.at(x + dx, y + dy)));
        }
        if let Some(coarser) = coarser {
            for dy in -REACH[1]..=REACH[1] {
                (-REACH[1]..=REACH[1]).for_each(|dx| to.extend(coarser.at(x / 2 + dx, y / 2 + dy)));
            }
        }
    }
}

/// Makes a picture of `size` pixels, which repeats along both axes.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub(super) fn scanned(
    image: &RgbImage,
    size: [usize; 2],
    leaf: Leaf,
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    let mut known = vec![PictureLevel::new(image)];
    while known.len() < LEVELS
        && known[known.len() - 1].size.iter().all(|&v| v as u32 >= 2 * COARSEST)
        && size.iter().all(|&v| v >> known.len() >= COARSEST as usize)
    {
        known.push(known[known.len() - 1].halved());
    }
    let mut coarser: Option<PictureLevel> = None;
    let mut colours = Vec::new();
    let rows: u64 = (0..known.len()).map(|l| (SCANS * (size[1] >> l).max(1)) as u64).sum();
    let mut done = 0;
    for level in (0..known.len()).rev() {
        let exemplar = &known[level];
        let (vectors, middles, length) = neighbourhoods(exemplar, known.get(level + 1));
        let book = Codebook::new(&vectors, length, LEAVES);
        // Pixels start as random pixels of the exemplar.
        let size = size.map(|v| (v >> level).max(1));
        let mut random = stream(seed, "pixels/noise", level as u64);
        let pixels = (0..size[0] * size[1]).map(|_| exemplar.pixels[random.index(exemplar.pixels.len())]);
        let mut made = PictureLevel { size, pixels: pixels.collect() };
        let means = (leaf == Leaf::Mean).then(|| book.means_of(&middles, &exemplar.pixels));
        colours = vec![0u32; made.pixels.len()];
        let mut vector = Vec::with_capacity(length);
        for y in (0..SCANS).flat_map(|_| 0..size[1]) {
            advance(progress, "pixels", done, rows)?;
            done += 1;
            for x in 0..size[0] {
                vector.clear();
                made.neighbourhood(coarser.as_ref(), x as i64, y as i64, &mut vector);
                let (node, _) = book.encode(&vector);
                let i = y * size[0] + x;
                colours[i] = middles[book.nearest(&vectors, node, &vector) as usize];
                made.pixels[i] = match &means {
                    Some(means) => means[node as usize],
                    None => exemplar.pixels[colours[i] as usize],
                };
            }
        }
        coarser = Some(made);
    }
    let width = image.width();
    let pixel = |i: usize| match (leaf, &coarser) {
        (Leaf::Mean, Some(made)) => vtex_base::raster::colour::Colour::from_oklab(made.pixels[i]).0,
        _ => image.get_pixel(colours[i] % width, colours[i] / width).0,
    };
    Ok(RgbImage::from_fn(size[0] as u32, size[1] as u32, |x, y| {
        image::Rgb(pixel(y as usize * size[0] + x as usize))
    }))
}

/// The neighbourhoods of a level in one array, the pixel at the centre of each, and their length. Those
/// that cross the border are left out; of very many, an even sample is taken.
fn neighbourhoods(level: &PictureLevel, coarser: Option<&PictureLevel>) -> (Vec<f32>, Vec<u32>, usize) {
    let [w, h] = level.size.map(|v| v as i64);
    let [side, above] = [REACH[0].min((w - 1) / 2), REACH[0].min(h - 1)];
    let inside = move |x: i64, y: i64| x >= side && x < w - side && y >= above;
    let places: Vec<(i64, i64)> =
        (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).filter(|&(x, y)| inside(x, y)).collect();
    let step = places.len().div_ceil(MOST_KNOWN).max(1);
    let (mut vectors, mut middles) = (Vec::new(), Vec::new());
    for &(x, y) in places.iter().step_by(step) {
        level.neighbourhood(coarser, x, y, &mut vectors);
        middles.push((y * w + x) as u32);
    }
    let length = vectors.len() / middles.len().max(1);
    (vectors, middles, length)
}

#[cfg(test)]
mod tests {
    use super::super::tsvq::distance;
    use super::*;
    use std::time::Instant;

    /// Row V7 of the method: speed-up of the tree over a search of all neighbourhoods, and the increase of
    /// the distances found, on neighbourhoods of another photograph.
    #[test]
    #[ignore = "prints figures for docs/measurements/layers.md"]
    fn tree_beside_full_search() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/exemplars/gravel.png");
        let Ok(photo) = image::open(path) else { return eprintln!("skipped: there is no {path}") };
        let part = |x, y| PictureLevel::new(&photo.crop_imm(x, y, 128, 128).to_rgb8());
        let (known, held) = (part(0, 0), part(200, 200));
        let (vectors, _, length) = neighbourhoods(&known, Some(&known.halved()));
        let (asked, _, _) = neighbourhoods(&held, Some(&held.halved()));
        let asked: Vec<&[f32]> = asked.chunks(length).step_by(13).take(1000).collect();
        let book = Codebook::new(&vectors, length, LEAVES);

        let error = |found: &[u32]| -> f64 {
            let of = |m: u32| &vectors[m as usize * length..][..length];
            asked.iter().zip(found).map(|(v, &m)| f64::from(distance(v, of(m))).sqrt()).sum()
        };
        let began = Instant::now();
        let tree: Vec<u32> = asked.iter().map(|v| book.nearest(&vectors, book.encode(v).0, v)).collect();
        let seconds = began.elapsed().as_secs_f64();
        let began = Instant::now();
        let near = |v: &&[f32]| {
            let far = vectors.chunks(length).map(|w| distance(v, w)).enumerate();
            far.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(m, _)| m as u32)
        };
        let full: Vec<u32> = asked.iter().map(near).collect();
        let times = began.elapsed().as_secs_f64() / seconds;
        println!("{times:.0} times as fast, {:.2} times as far", error(&tree) / error(&full));
        assert!(times >= 20.0);
    }
}
