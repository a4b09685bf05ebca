//! The mask generator, with networks whose answers are known.

use super::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A network that knows all discs `[x, y, radius]` of an image and returns the one at a point, on a
/// grid of cells of 2 px.
struct Oracle {
    discs: Vec<[f32; 3]>,
    asked: AtomicUsize,
    promises: bool,
}

struct OracleEmbedding<'a> {
    oracle: &'a Oracle,
    scale: f32,
    size: [usize; 2],
}

impl Prompter for Oracle {
    fn name(&self) -> String {
        "oracle".into()
    }

    fn embed<'a>(&'a self, image: &RgbImage) -> Result<Box<dyn Embedded + 'a>> {
        // The width of the image is 200 px at scale 1.
        let scale = image.width() as f32 / 200.0;
        let size = [image.width() as usize / 2, image.height() as usize / 2];
        Ok(Box::new(OracleEmbedding { oracle: self, scale, size }))
    }
}

impl OracleEmbedding<'_> {
    fn disc(&self, [x, y]: [f32; 2]) -> Option<[f32; 3]> {
        let discs = self.oracle.discs.iter().map(|d| d.map(|v| v * self.scale));
        let mut on = discs.filter(|d| (d[0] - x) * (d[0] - x) + (d[1] - y) * (d[1] - y) < d[2] * d[2]);
        on.next()
    }
}

impl Embedded for OracleEmbedding<'_> {
    fn expected_iou(&self, points: &[[f32; 2]]) -> Option<Vec<f32>> {
        let expected_iou = |&p: &[f32; 2]| if self.disc(p).is_some() { 0.95 } else { 0.1 };
        self.oracle.promises.then(|| points.iter().map(expected_iou).collect())
    }

    fn batch(&self) -> usize {
        7
    }

    fn masks(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>> {
        self.oracle.asked.fetch_add(points.len(), Ordering::Relaxed);
        let mask = |&p: &[f32; 2]| {
            let [width, height] = self.size;
            let disc = self.disc(p).into_iter();
            let logits = disc.map(|[cx, cy, r]| {
                let cell = |i: usize, c: f32| (2 * i + 1) as f32 - c;
                let value = |k: usize| {
                    let (x, y) = (cell(k % width, cx), cell(k / width, cy));
                    3.0 * (r - (x * x + y * y).sqrt())
                };
                let values = (0..width * height).map(value).collect();
                Logits { origin: [0.0; 2], step: [2.0; 2], width, height, values }
            });
            logits.map(|logits| PromptMask { predicted_iou: 0.95, logits }).collect()
        };
        Ok(points.iter().map(mask).collect())
    }
}

fn oracle(promises: bool) -> Oracle {
    let mut discs = Vec::new();
    for j in 0..5 {
        for i in 0..7 {
            let radius = 3.0 + ((i * 3 + j * 5) % 8) as f32;
            discs.push([16.3 + 28.0 * i as f32, 17.8 + 31.0 * j as f32, radius]);
        }
    }
    Oracle { discs, asked: AtomicUsize::new(0), promises }
}

fn params(levels: u32) -> GeneratorParams {
    GeneratorParams { spacing: 3.0, levels, stability: 0.3, confident: 0.3, ..GeneratorParams::default() }
}

fn find(oracle: Oracle, params: GeneratorParams) -> (Vec<FoundMask>, Cost) {
    let image = RgbImage::from_pixel(200, 160, image::Rgb([90, 80, 70]));
    Generator::new(Box::new(oracle), params).unwrap().find(&image, &()).unwrap()
}

#[test]
fn every_disc_is_found_once_and_at_its_size() {
    for (scales, levels) in [(vec![1.0], 1), (vec![1.0], 3), (vec![2.0], 3), (vec![0.7], 2)] {
        let (found, _) = find(oracle(false), GeneratorParams { scales, ..params(levels) });
        let discs = oracle(false).discs;
        assert_eq!(found.len(), discs.len());
        for [x, y, r] in discs {
            let here = found.iter().filter(|f| f.mask.contains(x as i32, y as i32)).collect::<Vec<_>>();
            let [one] = here[..] else { panic!("{} masks at {x}, {y}", here.len()) };
            let (area, truth) = (one.mask.area() as f32, std::f32::consts::PI * r * r);
            assert!((area - truth).abs() < 3.0 + 0.12 * truth, "radius {r}: {area} of {truth}");
        }
    }
}

#[test]
fn coarse_to_fine_finds_the_same_for_a_fraction_of_the_prompts() {
    let (all, full) = find(oracle(false), params(1));
    let (coarse, cost) = find(oracle(false), params(3));
    assert_eq!((full.prompts, full.grid), (66 * 53, 66 * 53));
    assert_eq!(coarse.len(), all.len());
    // Only points on discs are skipped; the others are never explained by a mask.
    assert!(cost.prompts < full.prompts && cost.grid == full.grid);
    let (skipping, cheap) = find(oracle(true), params(3));
    assert_eq!(skipping.len(), all.len());
    assert!(cheap.prompts * 10 < full.prompts, "{} of {}", cheap.prompts, full.prompts);
}

/// A network that returns the bright square at a point.
struct Bright;

struct Lit(RgbImage);

impl Prompter for Bright {
    fn name(&self) -> String {
        "bright".into()
    }

    fn embed<'a>(&'a self, image: &RgbImage) -> Result<Box<dyn Embedded + 'a>> {
        Ok(Box::new(Lit(image.clone())))
    }
}

impl Embedded for Lit {
    fn expected_iou(&self, _: &[[f32; 2]]) -> Option<Vec<f32>> {
        None
    }

    fn batch(&self) -> usize {
        64
    }

    fn masks(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>> {
        let (width, height) = (self.0.width() as usize, self.0.height() as usize);
        let values: Vec<f32> = self.0.pixels().map(|p| if p.0[0] > 128 { 4.0 } else { -4.0 }).collect();
        let logits = Logits { origin: [0.0; 2], step: [1.0; 2], width, height, values };
        Ok(points.iter().map(|_| vec![PromptMask { predicted_iou: 0.95, logits: logits.clone() }]).collect())
    }
}

#[test]
fn what_whole_and_crops_both_show_is_found_once() {
    let bright = |x: u32, y: u32| x % 40 < 12 && y % 40 < 12;
    let image = RgbImage::from_fn(160, 120, |x, y| image::Rgb([if bright(x, y) { 250 } else { 10 }; 3]));
    let generator = Generator::new(Box::new(Bright), GeneratorParams { crop: 72, ..params(1) }).unwrap();
    let (found, cost) = generator.find(&image, &()).unwrap();
    assert_eq!(found.len(), 12);
    assert!(found.iter().all(|f| f.mask.area() == 144 && f.scale == 0));
    // The crops were prompted, too. They overlap, so they have more points than the whole.
    assert!(cost.grid > 2 * 53 * 40);
}

#[test]
fn parameters_out_of_range_are_refused() {
    let wrong = |params: GeneratorParams| Generator::new(Box::new(oracle(false)), params).is_err();
    assert!(wrong(GeneratorParams { spacing: 0.5, ..params(1) }));
    assert!(wrong(params(0)));
    assert!(wrong(GeneratorParams { scales: vec![0.0], ..params(1) }));
    assert!(wrong(GeneratorParams { predicted_iou: f32::NAN, ..params(1) }));
    assert!(!wrong(params(1)));
}

#[test]
fn work_can_be_interrupted() {
    let image = RgbImage::new(40, 40);
    let answer =
        Generator::new(Box::new(oracle(false)), params(2)).unwrap().find(&image, &vtex_testing::StopAtOnce);
    assert!(matches!(answer, Err(vtex_base::Error::Interrupted)));
}
