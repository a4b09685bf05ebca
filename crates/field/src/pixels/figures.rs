//! Figures of docs/measurements/layers.md: photographs beside pictures that are made of them. Pictures are written to
//! the folder `OUT`.

use super::neighbourhood::{KnownNeighbourhoods, Neighbourhood, NeighbourhoodVector, complete};
use super::pyramid::PictureLevel;
use super::tsvq::distance;
use super::*;
use crate::photographs::photograph;
use rustfft::FftDirection;
use std::time::Instant;
use vtex_base::fourier::Spectrum;

/// Grey values of a picture, 0 to 1, row by row.
struct Grey {
    size: [usize; 2],
    values: Vec<f64>,
}

impl Grey {
    fn new(image: &RgbImage) -> Self {
        let light = |p: &Rgb<u8>| {
            let [r, g, b] = p.0.map(f64::from);
            (0.299 * r + 0.587 * g + 0.114 * b) / 255.0
        };
        let size = [image.width() as usize, image.height() as usize];
        Self { size, values: image.pixels().map(light).collect() }
    }

    /// The earth mover's distance of the values of two pictures.
    fn distance(&self, other: &Self) -> f64 {
        let quantiles = |picture: &Self| -> Vec<f64> {
            let mut all = picture.values.clone();
            all.sort_by(f64::total_cmp);
            (0..1000).map(|k| all[(2 * k + 1) * all.len() / 2000]).collect()
        };
        quantiles(self).iter().zip(quantiles(other)).map(|(a, b)| (a - b).abs()).sum::<f64>() / 1000.0
    }

    /// The mean step between adjacent pixels: from each column to the next, the last being beside the
    /// first; or from each row.
    fn steps(&self, axis: usize) -> Vec<f64> {
        let [w, h] = self.size;
        let at = |k: usize, m: usize| if axis == 0 { m * w + k % w } else { k % h * w + m };
        let step = |k: usize| {
            let other = self.size[1 - axis];
            let each = (0..other).map(|m| (self.values[at(k, m)] - self.values[at(k + 1, m)]).abs());
            each.sum::<f64>() / other as f64
        };
        (0..self.size[axis]).map(step).collect()
    }

    /// The mean step across both seams over that within.
    fn seam(&self) -> f64 {
        let (mut seam, mut within) = (0.0, 0.0);
        for axis in 0..2 {
            let steps = self.steps(axis);
            seam += steps[steps.len() - 1];
            within += mean(&steps[..steps.len() - 1]);
        }
        seam / within
    }

    /// The mean gradient.
    fn gradient(&self) -> f64 {
        (0..2).map(|axis| mean(&self.steps(axis)[..self.size[axis] - 1])).sum()
    }

    /// The autocorrelation of the values, which are taken to repeat, by rows and columns of offsets.
    fn autocorrelation(&self) -> impl Fn(i64, i64) -> f64 + use<> {
        let [w, h] = self.size;
        let mean = mean(&self.values);
        let mut spectrum =
            Spectrum::new(w, h, |x, y| self.values[y * w + x] - mean).transformed(FftDirection::Forward);
        spectrum.data.iter_mut().for_each(|v| *v = (v.norm_sqr() / (w * h) as f64).into());
        let data = spectrum.transformed(FftDirection::Inverse).data;
        move |x, y| {
            data[y.rem_euclid(h as i64) as usize * w + x.rem_euclid(w as i64) as usize].re / data[0].re
        }
    }

    /// Logarithms of the mean power in rings of frequencies, of parts of 128² px under a Hann window.
    fn spectrum(&self) -> Vec<f64> {
        const SIDE: usize = 128;
        let mean = mean(&self.values);
        let hann = |k: usize| 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * k as f64 / SIDE as f64);
        let mut rings = vec![(0.0, 0.0); SIDE / 2];
        for [ox, oy] in [[0, 0], [1, 0], [0, 1], [1, 1]]
            .map(|[x, y]| [x * (self.size[0] - SIDE), y * (self.size[1] - SIDE)])
        {
            let value = |x, y| (self.values[(oy + y) * self.size[0] + ox + x] - mean) * hann(x) * hann(y);
            let found = Spectrum::new(SIDE, SIDE, value).transformed(FftDirection::Forward);
            for (i, v) in found.data.iter().enumerate() {
                let f = [i % SIDE, i / SIDE].map(|k| k.min(SIDE - k) as f64);
                let ring = libm::sqrt(f[0] * f[0] + f[1] * f[1]) as usize;
                if (1..SIDE / 2).contains(&ring) {
                    rings[ring].0 += v.norm_sqr();
                    rings[ring].1 += 1.0;
                }
            }
        }
        rings[1..].iter().map(|(sum, count)| libm::log(sum / count + 1e-9)).collect()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The correlation of two series.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (ma, mb) = (mean(a), mean(b));
    let product = |f: &dyn Fn(usize) -> f64| (0..a.len()).map(f).sum::<f64>();
    let (saa, sbb) = (product(&|i| (a[i] - ma) * (a[i] - ma)), product(&|i| (b[i] - mb) * (b[i] - mb)));
    product(&|i| (a[i] - ma) * (b[i] - mb)) / libm::sqrt(saa * sbb)
}

/// The upper left part of a photograph.
fn part(name: &str, side: u32) -> Option<RgbImage> {
    photograph(name).map(|photo| image::imageops::crop_imm(&photo, 0, 0, side, side).to_image())
}

fn save(made: &RgbImage, name: &str) {
    if let Ok(folder) = std::env::var("OUT") {
        made.save(format!("{folder}/{name}.png")).unwrap();
    }
}

/// Rows V3 and V4: distributions, seams, gradients and spectra of pictures of 288² px made of 192² px.
#[test]
#[ignore = "prints figures"]
fn pictures_beside_photographs() {
    const SEEDS: u64 = 4;
    for name in ["gravel.png", "tile_1.jpg", "concrete_1.jpg", "rusty_metal_05.jpg", "mud_cracks.jpg"] {
        let Some(own) = part(name, 192) else { return };
        let known = Grey::new(&own);
        for by_codebook in [false, true] {
            let began = Instant::now();
            let mut means = [0.0; 4];
            for seed in 1..=SEEDS {
                let made = match by_codebook {
                    false => carried(&own, [288; 2], [true; 2], seed, &()).unwrap(),
                    true => scanned(&own, [288; 2], &ScanParams::default(), seed, &()).unwrap(),
                };
                save(&made, &format!("{name}.{by_codebook}.{seed}"));
                let grey = Grey::new(&made);
                let figures = [
                    known.distance(&grey),
                    grey.seam(),
                    grey.gradient() / known.gradient(),
                    correlation(&known.spectrum(), &grey.spectrum()),
                ];
                means.iter_mut().zip(figures).for_each(|(mean, v)| *mean += v / SEEDS as f64);
            }
            let [distance, seam, gradient, spectrum] = means;
            println!(
                "{name} {} distance {distance:.3} seam {seam:.2} gradient {gradient:.2} \
                 spectrum {spectrum:.3}, {:.1} s",
                if by_codebook { "tsvq" } else { "correspondence" },
                began.elapsed().as_secs_f64() / SEEDS as f64
            );
        }
    }
}

/// Row V6: the height of the autocorrelation at the lattice of a brick wall.
#[test]
#[ignore = "prints figures"]
fn bricks_on_more_levels() {
    const SEEDS: u64 = 6;
    let Some(own) = photograph("brick_wall_02.jpg") else { return };
    let own = image::imageops::resize(&own, 128, 128, image::imageops::FilterType::Triangle);
    save(&own, "bricks");
    let known = Grey::new(&own).autocorrelation();
    let far = |[x, y]: [i64; 2]| x * x + y * y >= 36 && (y > 0 || x > 0);
    let all = (0..=40).flat_map(|y| (-40..=40).map(move |x| [x, y])).filter(|at| far(*at));
    let peak = all.max_by(|a, b| known(a[0], a[1]).total_cmp(&known(b[0], b[1]))).unwrap();
    println!("photograph: {:.2} at {peak:?}", known(peak[0], peak[1]));
    for levels in 1..=4 {
        let params = ScanParams { levels: Some(levels), neighbourhood: 5, ..ScanParams::default() };
        let mut heights = Vec::new();
        for seed in 1..=SEEDS {
            let made = scanned(&own, [256; 2], &params, seed, &()).unwrap();
            save(&made, &format!("bricks.{levels}.{seed}"));
            let found = Grey::new(&made).autocorrelation();
            let near = (-2..=2).flat_map(|y| (-2..=2).map(move |x| [peak[0] + x, peak[1] + y]));
            heights.push(near.map(|[x, y]| found(x, y)).fold(f64::NEG_INFINITY, f64::max));
        }
        println!("{levels} levels: {:.3} {heights:.2?}", mean(&heights));
    }
}

/// Row V5: photographs continued by 64 px on all sides, and the middle of others made anew: the distribution and
/// the gradient of the new pixels, and the steps across the border of old and new over those within the old.
#[test]
#[ignore = "prints figures"]
fn continued_and_filled() {
    for name in ["gravel.png", "tile_1.jpg", "concrete_1.jpg", "rusty_metal_05.jpg", "mud_cracks.jpg"] {
        let Some(own) = part(name, 192) else { return };
        let params = ScanParams::default();
        let wide = extended(&own, [64; 4], [false; 2], &params, 1, &()).unwrap();
        let in_hole = |x: u32, y: u32| (60..124).contains(&x) && (60..124).contains(&y);
        let hole: Vec<bool> = own.enumerate_pixels().map(|(x, y, _)| in_hole(x, y)).collect();
        let mended = filled(&own, &hole, [false; 2], &params, 1, &()).unwrap();
        let in_margin = |x: u32, y: u32| !(64..256).contains(&x) || !(64..256).contains(&y);
        for (what, made, is_new) in
            [("continued", wide, &in_margin as &dyn Fn(u32, u32) -> bool), ("filled", mended, &in_hole)]
        {
            save(&made, &format!("{name}.{what}"));
            let grey = Grey::new(&made);
            let (mut new, mut steps) = (Vec::new(), [const { Vec::new() }; 3]);
            for (x, y, _) in made.enumerate_pixels() {
                let value = |x: u32, y: u32| grey.values[(y * made.width() + x) as usize];
                if is_new(x, y) {
                    new.push(value(x, y));
                }
                for [u, v] in [[x + 1, y], [x, y + 1]] {
                    if u < made.width() && v < made.height() {
                        let kind = usize::from(is_new(x, y)) + usize::from(is_new(u, v));
                        steps[kind].push((value(x, y) - value(u, v)).abs());
                    }
                }
            }
            let known = Grey::new(&own);
            let distance = known.distance(&Grey { size: [new.len(), 1], values: new });
            let [old, across, within] = steps.map(|steps| mean(&steps));
            println!(
                "{name} {what}: distance {distance:.3} border {:.2} gradient {:.2}",
                across / old,
                within / old
            );
        }
    }
}

/// Row V7: texture by numbers with the tree and with a search of all neighbourhoods: times, and the distances
/// that are found.
#[test]
#[ignore = "prints figures"]
fn numbers_by_tree_and_by_full_search() {
    const SIDE: u32 = 256;
    let Some(own) = part("rust_metal053c.jpg", SIDE) else { return };
    // Light and dark parts, and a map of rings.
    let light = image::imageops::blur(&own, 4.0);
    let light: Vec<f32> = light.pixels().map(|p| oklab(p.0)[0]).collect();
    let mut sorted = light.clone();
    sorted.sort_by(f32::total_cmp);
    let labels = light.iter().map(|l| u32::from(*l > sorted[sorted.len() / 2])).collect();
    let known = LabelMap { width: SIDE, height: SIDE, labels };
    let ring = |i: u32| {
        let [x, y] = [i % SIDE, i / SIDE].map(|v| f64::from(v) - f64::from(SIDE) / 2.0);
        libm::sqrt(x * x + y * y) as u32 / 30 % 2
    };
    let wanted = LabelMap { width: SIDE, height: SIDE, labels: (0..SIDE * SIDE).map(ring).collect() };
    let params = ScanParams::default();
    let began = Instant::now();
    let made = scanned_by_numbers(&own, &known, &wanted, [false; 2], &params, 1, &()).unwrap();
    let whole = began.elapsed().as_secs_f64();
    save(&made, "numbers");

    // The searches of the finest level, a sample of them.
    let [exemplar, canvas] =
        [(&own, &known), (&made, &wanted)].map(|(image, map)| PictureLevel::of(image, Some(map)));
    let (above, coarser) = (exemplar.halved(), canvas.halved());
    let form = Neighbourhood::new(&exemplar, 3);
    let complete = complete(&exemplar, Some(&above), 3);
    let codebook = |label| {
        KnownNeighbourhoods::new(
            &form,
            &exemplar,
            Some(&above),
            &complete,
            label,
            params.codebook,
            &mut || Ok(()),
        )
    };
    let books: Vec<KnownNeighbourhoods> = (0..2).map(|label| codebook(label).unwrap()).collect();
    let mut asked = Vec::new();
    for i in (0..canvas.pixels.len()).step_by(101) {
        let mut vector = NeighbourhoodVector::default();
        form.read(&canvas, Some(&coarser), canvas.place(i), &mut vector);
        asked.push((vector.values, &books[canvas.label(i) as usize]));
    }
    let timed = |search: &dyn Fn(&[f32], &KnownNeighbourhoods) -> f32| {
        let began = Instant::now();
        let far: f64 = asked.iter().map(|(v, known)| f64::from(libm::sqrtf(search(v, known)))).sum();
        (began.elapsed().as_secs_f64() / asked.len() as f64, far / asked.len() as f64)
    };
    let tree = timed(&|v, known| known.book.search(&known.vectors, v, None, |_, far| far).1);
    let full = timed(&|v, known| {
        known.vectors.chunks(v.len()).map(|w| distance(v, w)).fold(f32::INFINITY, f32::min)
    });
    // Two searches of each pixel of the finest level; the other levels have a third as many.
    let searches = 2.0 * f64::from(SIDE * SIDE) * 4.0 / 3.0;
    let whole_full = whole + searches * (full.0 - tree.0);
    println!(
        "search: {:.0} times as fast, {:.2} times as far; all the work: {whole:.1} s, {:.0} times as fast",
        full.0 / tree.0,
        tree.1 / full.1,
        whole_full / whole
    );
}
