//! Graph-based segmentation (Felzenszwalb and Huttenlocher 2004) of an image or of a mask's interior.
//!
//! Neighbours are the four pixels that share an edge, so regions are 4-connected and their outlines
//! never touch themselves at a corner. Scale and minimum size have the same meaning as in
//! scikit-image: weights are Euclidean distances of 8-bit RGB colours after smoothing.
//!
//! Works badly where elements vary more internally than they differ from their surroundings, because
//! it does not consider shape.

use super::{ScoredMask, Segmenter};
use image::RgbImage;
use std::ops::Range;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::error::{Result, check};
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::blur::{Part, convolve, gaussian};
use vtex_base::raster::{LabelMap, Mask, Span};

/// A part of an image smoothed by a Gaussian.
#[derive(Clone, Debug)]
struct Smoothed {
    part: Part,
    /// sRGB components, 0 to 255, row by row.
    pixels: Vec<[f32; 3]>,
}

impl Smoothed {
    /// Smooths the sRGB components of part of an image by half a [`gaussian`] kernel.
    fn new(image: &RgbImage, part: Part, half: &[f32]) -> Self {
        let colour = |x: usize, y: usize| image.get_pixel(x as u32, y as u32).0.map(f32::from);
        let size = [image.width() as usize, image.height() as usize];
        Self { pixels: convolve(colour, size, &part, half, [false; 2]), part }
    }

    /// Smooths a whole image.
    fn whole(image: &RgbImage, half: &[f32]) -> Self {
        Self::new(image, [0..image.width() as usize, 0..image.height() as usize], half)
    }

    /// A run of pixels in the part.
    fn run(&self, s: &Span) -> &[[f32; 3]] {
        let [columns, rows] = &self.part;
        let start = (s.y as usize - rows.start) * columns.len() + s.x0 as usize - columns.start;
        &self.pixels[start..start + s.len() as usize]
    }
}

/// Segments a whole image. Regions are numbered from 1 in the order of their first pixel. `scale` (at
/// least 0) controls the size of regions: a larger scale gives larger regions. Regions of fewer than
/// `minimum` pixels are joined to the most similar neighbour.
fn felzenszwalb(image: &Smoothed, scale: f64, minimum: u32) -> LabelMap {
    let [w, h] = image.part.each_ref().map(Range::len);
    let mut edges = Vec::with_capacity(2 * w * h);
    for i in 0..w * h {
        if i % w + 1 < w {
            edges.push(edge(&image.pixels, i, i + 1, 2 * i));
        }
        if i + w < w * h {
            edges.push(edge(&image.pixels, i, i + w, 2 * i + 1));
        }
    }
    let mut forest = Forest::new(w * h);
    let ends = |e: u32| {
        let i = e as usize / 2;
        (i, if e.is_multiple_of(2) { i + 1 } else { i + w })
    };
    forest.grow(edges, ends, scale as f32, minimum);
    let labels = forest.number();
    LabelMap { width: w as u32, height: h as u32, labels }
}

/// Segments the interior of a mask into 4-connected regions that tile it, in the order of their first pixel.
/// The image is smoothed by half a [`gaussian`] kernel. A region can be smaller than `minimum` pixels only if
/// it is a whole connected component of the mask. Parts of the mask outside the image are ignored.
pub fn details(image: &RgbImage, half: &[f32], mask: &Mask, scale: f64, minimum: u32) -> Vec<Mask> {
    let (w, h) = (image.width() as i32, image.height() as i32);
    let inside = |s: &&Span| s.y >= 0 && s.y < h && s.x1 > 0 && s.x0 < w;
    let spans: Vec<Span> = (mask.spans().iter().filter(inside))
        .map(|s| Span { y: s.y, x0: s.x0.max(0), x1: s.x1.min(w) })
        .collect();
    let Some((x0, y0, x1, y1)) = mask.bounds() else { return Vec::new() };
    let range = |from: i32, to: i32, n: i32| from.clamp(0, n) as usize..to.clamp(0, n) as usize;
    let image = Smoothed::new(image, [range(x0, x1, w), range(y0, y1, h)], half);
    // The mask's pixels are numbered along its runs.
    let mut pixels = Vec::with_capacity(mask.area() as usize);
    let mut pairs = Vec::with_capacity(2 * pixels.capacity());
    let mut first = Vec::with_capacity(spans.len());
    let mut above = 0;
    for (i, s) in spans.iter().enumerate() {
        let start = pixels.len();
        first.push(start);
        pixels.extend_from_slice(image.run(s));
        pairs.extend((start + 1..pixels.len()).map(|p| (p - 1, p)));
        while above < i && (spans[above].y < s.y - 1 || spans[above].y == s.y - 1 && spans[above].x1 <= s.x0)
        {
            above += 1;
        }
        let over = spans[above..i].iter().enumerate().take_while(|(_, t)| t.y < s.y && t.x0 < s.x1);
        for (j, t) in over {
            for x in s.x0.max(t.x0)..s.x1.min(t.x1) {
                pairs.push((first[above + j] + (x - t.x0) as usize, start + (x - s.x0) as usize));
            }
        }
    }
    let edges = pairs.iter().enumerate().map(|(e, &(i, j))| edge(&pixels, i, j, e)).collect();
    let mut forest = Forest::new(pixels.len());
    forest.grow(edges, |e| pairs[e as usize], scale as f32, minimum);
    let labels = forest.number();
    let mut pieces: Vec<Vec<Span>> = vec![Vec::new(); labels.iter().max().map_or(0, |&n| n as usize)];
    for (s, &start) in spans.iter().zip(&first) {
        let row = &labels[start..][..s.len() as usize];
        let mut x = s.x0;
        for run in row.chunk_by(|a, b| a == b) {
            let x1 = x + run.len() as i32;
            pieces[run[0] as usize - 1].push(Span { y: s.y, x0: x, x1 });
            x = x1;
        }
    }
    pieces.into_iter().map(Mask::from_spans).collect()
}

/// A sort key for an edge: the weight's bits (floats of one sign sort like integers), then its number.
fn edge(pixels: &[[f32; 3]], i: usize, j: usize, number: usize) -> u64 {
    let (a, b) = (pixels[i], pixels[j]);
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let weight = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    u64::from(weight.to_bits()) << 32 | number as u64
}

/// Disjoint sets of pixels.
struct Forest {
    sets: DisjointSets,
    size: Vec<u32>,
    /// Largest weight in each set's minimum spanning tree, plus scale / size.
    limit: Vec<f32>,
}

impl Forest {
    fn new(pixels: usize) -> Self {
        Self { sets: DisjointSets::new(pixels), size: vec![1; pixels], limit: Vec::new() }
    }

    fn join(&mut self, a: usize, b: usize) -> usize {
        let (a, b) = if self.size[a] >= self.size[b] { (a, b) } else { (b, a) };
        self.sets.attach(a, b);
        self.size[a] += self.size[b];
        a
    }

    fn grow(&mut self, mut edges: Vec<u64>, ends: impl Fn(u32) -> (usize, usize), scale: f32, minimum: u32) {
        edges.sort_unstable();
        self.limit = vec![scale; self.size.len()];
        for &e in &edges {
            let weight = f32::from_bits((e >> 32) as u32);
            let (i, j) = ends(e as u32);
            let (a, b) = (self.sets.root(i), self.sets.root(j));
            if a != b && weight < self.limit[a].min(self.limit[b]) {
                let joined = self.join(a, b);
                self.limit[joined] = weight + scale / self.size[joined] as f32;
            }
        }
        for &e in &edges {
            let (i, j) = ends(e as u32);
            let (a, b) = (self.sets.root(i), self.sets.root(j));
            if a != b && self.size[a].min(self.size[b]) < minimum {
                self.join(a, b);
            }
        }
    }

    /// The set of each pixel, numbered from 1 in the order of first pixels.
    fn number(&mut self) -> Vec<u32> {
        self.sets.indices().0.into_iter().map(|index| index + 1).collect()
    }
}

/// Segmenter by Felzenszwalb's method. Each region is a mask, except background and specks. The
/// simplest segmenter; [`Regions`](super::Regions) finds elements more reliably.
#[derive(Clone, Debug, PartialEq)]
pub struct Felzenszwalb {
    /// Scale of the segmentation: a larger scale gives larger regions. 0 to 100 000, default 200.
    pub scale: f64,
    /// Standard deviation of the smoothing, in pixels. 0 to 10, default 0.3.
    pub sigma: f64,
    /// Area of the smallest region, in pixels. 1 to 1 000 000, default 20.
    pub minimum: u32,
}

impl Default for Felzenszwalb {
    fn default() -> Self {
        Self { scale: 200.0, sigma: 0.3, minimum: 20 }
    }
}

impl Felzenszwalb {
    /// Checks every range.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] naming the first parameter out of range.
    pub fn validate(&self) -> Result<()> {
        check((0.0..=100_000.0).contains(&self.scale), "scale", self.scale, "0 to 100000")?;
        check((0.0..=10.0).contains(&self.sigma), "sigma", self.sigma, "0 to 10 px")?;
        check((1..=1_000_000).contains(&self.minimum), "minimum", self.minimum, "1 to 1000000 px")
    }
}

impl Segmenter for Felzenszwalb {
    fn name(&self) -> String {
        "felzenszwalb".into()
    }

    /// Regions that touch opposite borders, or cover more than a tenth of the image, are background.
    /// A region's score is the share of its bounding box that it covers.
    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        self.validate()?;
        advance(progress, "segmentation", 0, 3)?;
        let smoothed = Smoothed::whole(image, &gaussian(self.sigma));
        advance(progress, "segmentation", 1, 3)?;
        let map = felzenszwalb(&smoothed, self.scale, self.minimum);
        advance(progress, "segmentation", 2, 3)?;
        let regions = map.labels.iter().max().map_or(0, |&n| n as usize);
        let masks = Mask::all_of_labels(&map, regions + 1);
        let (w, h) = (image.width() as i32, image.height() as i32);
        let largest = image.width() as u64 * u64::from(image.height()) / 10;
        let scored = masks.into_iter().filter_map(|mask| {
            let (x0, y0, x1, y1) = mask.bounds()?;
            let spans_image = x0 == 0 && x1 == w || y0 == 0 && y1 == h;
            let area = mask.area();
            let keep = !spans_image && u64::from(area) <= largest;
            let score = area as f32 / ((x1 - x0) as f32 * (y1 - y0) as f32);
            keep.then_some(ScoredMask { mask, score })
        });
        let scored = scored.collect();
        advance(progress, "segmentation", 3, 3)?;
        Ok(scored)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vtex_base::raster::{Connectivity, components_of_mask};

    fn speckled(width: u32, height: u32, values: &[u8]) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| {
            let v = values[(y * width + x) as usize % values.len()];
            image::Rgb([v, v / 2, 255 - v])
        })
    }

    proptest! {
        #[test]
        fn details_tile_the_mask_and_are_connected(
            values in prop::collection::vec(any::<u8>(), 17 * 13),
            runs in prop::collection::vec((-2..15i32, -3..17i32, 1..9i32), 0..24),
            scale in 0.0..400.0f64,
            minimum in 1..6u32,
        ) {
            let image = speckled(17, 13, &values);
            let mask = Mask::from_spans(
                runs.iter().map(|&(y, x0, n)| Span { y, x0, x1: x0 + n }).collect(),
            );
            let inside: Vec<_> = mask.pixels()
                .filter(|&(x, y)| (0..17).contains(&x) && (0..13).contains(&y))
                .collect();
            let pieces = details(&image, &gaussian(0.95), &mask, scale, minimum);
            let mut tiled: Vec<_> = pieces.iter().flat_map(|p| p.pixels()).map(|(x, y)| (y, x)).collect();
            tiled.sort_unstable();
            prop_assert_eq!(tiled, inside.iter().map(|&(x, y)| (y, x)).collect::<Vec<_>>());
            let clipped = Mask::from_spans(
                inside.iter().map(|&(x, y)| Span { y, x0: x, x1: x + 1 }).collect(),
            );
            let parts = components_of_mask(&clipped, Connectivity::Four);
            for piece in &pieces {
                prop_assert_eq!(components_of_mask(piece, Connectivity::Four).len(), 1);
                prop_assert!(piece.area() >= minimum || parts.contains(piece));
            }
        }

        #[test]
        fn a_full_mask_gives_the_regions_of_the_image(
            values in prop::collection::vec(any::<u8>(), 11 * 9),
            scale in 0.0..400.0f64,
        ) {
            let (image, half) = (speckled(11, 9, &values), gaussian(0.8));
            let map = felzenszwalb(&Smoothed::whole(&image, &half), scale, 3);
            let full = Mask::from_labels(&map, |_| true);
            let regions = Mask::all_of_labels(&map, map.areas().len());
            for region in &regions[1..] {
                prop_assert_eq!(components_of_mask(region, Connectivity::Four).len(), 1);
            }
            prop_assert_eq!(regions.len() - 1, details(&image, &half, &full, scale, 3).len());
        }
    }

    #[test]
    fn smoothing_keeps_a_constant_and_the_mean() {
        assert!(Smoothed::whole(&RgbImage::new(5, 0), &gaussian(2.0)).pixels.is_empty());
        let flat = Smoothed::whole(&RgbImage::from_pixel(5, 7, image::Rgb([9, 90, 200])), &gaussian(2.0));
        assert!(flat.pixels.iter().all(|p| (p[0] - 9.0).abs() < 1e-3 && (p[2] - 200.0).abs() < 1e-3));
        let mut dot = RgbImage::new(21, 21);
        dot.put_pixel(10, 10, image::Rgb([255; 3]));
        let sum: f32 = Smoothed::whole(&dot, &gaussian(1.0)).pixels.iter().map(|p| p[0]).sum();
        assert!((sum - 255.0).abs() < 0.1, "{sum}");
    }

    #[test]
    fn a_part_is_smoothed_as_it_is_in_the_whole() {
        let values: Vec<u8> = (0..=250u8).map(|v| v.wrapping_mul(37)).collect();
        let (image, half) = (speckled(23, 19, &values), gaussian(1.4));
        let whole = Smoothed::whole(&image, &half);
        for part in
            [[0..23, 0..19], [0..4, 15..19], [20..23, 0..1], [7..16, 5..12], [5..5, 0..19], [0..23, 19..19]]
        {
            let found = Smoothed::new(&image, part.clone(), &half);
            let [columns, rows] = part;
            let runs = rows.map(|y| Span { y: y as i32, x0: columns.start as i32, x1: columns.end as i32 });
            assert_eq!(found.pixels, runs.flat_map(|s| whole.run(&s).to_vec()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn two_halves_are_two_regions() {
        let image = RgbImage::from_fn(20, 10, |x, _| image::Rgb([if x < 10 { 20 } else { 220 }; 3]));
        let map = felzenszwalb(&Smoothed::whole(&image, &gaussian(0.0)), 50.0, 5);
        assert!((0..200).all(|i| map.labels[i] == u32::from(i % 20 >= 10) + 1));
    }
}
