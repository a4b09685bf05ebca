//! Fitting of the small networks that score masks.
//!
//! Every candidate of every scene is a sample. Its target grows from 0 to 1 as its IoU with the best
//! true element grows from 0.4 to 0.9.

use std::fmt::Write;
use vtex::raster::Mask;
use vtex::sampling::{Stream, stream};
use vtex::segment::Perceptron;
use vtex_testing::{GeneratedExemplar, SceneParams, generate};

/// Sides of the scenes in turn: the larger ones hold larger elements.
const SIDES: [u32; 3] = [256, 256, 400];
/// Share of the clearly wrong candidates that are kept; their weight is raised accordingly.
const KEPT: f64 = 0.3;
/// Elements with fewer visible pixels are neither found nor missed.
const LEAST_AREA: u32 = 30;

const BATCH: usize = 256;
const RATE: f64 = 3e-3;
/// Standard deviation of the noise added to scaled features on every visit. It makes up for the
/// difference between photographs and scenes.
const NOISE: f64 = 0.25;

/// Features of a mask, its target (0 to 1) and its weight.
#[derive(Clone, Copy)]
pub(crate) struct Sample<const F: usize> {
    pub(crate) features: [f32; F],
    pub(crate) target: f32,
    pub(crate) weight: f32,
}

/// Samples of scenes by their numbers, with the candidates that `candidates` finds.
pub(crate) fn samples<const F: usize>(
    numbers: std::ops::Range<u64>,
    scene: impl Fn(u64) -> GeneratedExemplar + Sync,
    candidates: impl Fn(&image::RgbImage) -> Vec<(Mask, [f32; F])> + Sync,
) -> Vec<Sample<F>> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let scenes = numbers.end - numbers.start;
    let one = |number: u64| {
        let scene = scene(number);
        let candidates = candidates(&scene.image);
        of_scene(number, &scene, &candidates)
    };
    let parts = std::thread::scope(|scope| {
        let work =
            |t| move || (t..scenes).step_by(threads as usize).map(|i| one(numbers.start + i)).collect();
        let handles: Vec<_> = (0..threads).map(|t| scope.spawn(work(t))).collect();
        handles.into_iter().map(|h| h.join().expect("no panic")).collect::<Vec<Vec<_>>>()
    });
    let (mut all, mut found, mut wanted) = (Vec::new(), 0, 0);
    for i in 0..scenes {
        let (samples, f, w) = &parts[(i % threads) as usize][(i / threads) as usize];
        all.extend(samples);
        found += f;
        wanted += w;
    }
    println!("{} samples; {found} of {wanted} elements are among the candidates", all.len());
    all
}

/// The generated scene of a seed, as a camera and a file might show it.
pub(crate) fn generated(seed: u64) -> GeneratedExemplar {
    let side = SIDES[seed as usize % SIDES.len()];
    let params = SceneParams::random(seed, side, side);
    let mut scene = generate(&params).expect("random parameters are in range");
    disturb(&mut scene.image, seed);
    scene
}

/// Simulates the effects of cameras and file formats on three of four pictures.
fn disturb(picture: &mut image::RgbImage, seed: u64) {
    use image::imageops::{blur, colorops, unsharpen};
    let random = &mut stream(seed, "fit/disturb", 0);
    match random.below(4) {
        0 => *picture = unsharpen(picture, random.range(0.6, 1.4) as f32, 0),
        1 => *picture = blur(picture, random.range(0.3, 0.9) as f32),
        2 => colorops::contrast_in_place(picture, random.range(-40.0, 30.0) as f32),
        _ => {}
    }
    if random.chance(0.5) {
        let mut file = std::io::Cursor::new(Vec::new());
        let quality = 60 + random.below(36) as u8;
        let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, quality);
        picture.write_with_encoder(encoder).expect("memory");
        *picture = image::load_from_memory(file.get_ref()).expect("what was just written").to_rgb8();
    }
}

/// What a judge is to say of a candidate, by its largest IoU with an element.
pub(crate) fn target(iou: f32) -> f32 {
    ((iou - 0.4) / 0.5).clamp(0.0, 1.0)
}

/// The samples of one scene, the number of elements that a candidate matches, and that of all elements.
fn of_scene<const F: usize>(
    seed: u64,
    scene: &GeneratedExemplar,
    candidates: &[(Mask, [f32; F])],
) -> (Vec<Sample<F>>, usize, usize) {
    let areas = scene.instances.areas();
    let mut hit = vec![false; areas.len()];
    let mut shared = vec![0u32; areas.len()];
    let random = &mut stream(seed, "fit/kept", 0);
    let samples = candidates.iter().map(|(mask, features)| {
        let mut met = Vec::new();
        for (x, y) in mask.pixels() {
            let label = scene.instances.get(x as u32, y as u32) as usize;
            if shared[label] == 0 {
                met.push(label);
            }
            shared[label] += 1;
        }
        let area = mask.area();
        let mut best = 0.0f32;
        for label in met {
            let overlap = std::mem::take(&mut shared[label]);
            if label > 0 && areas[label] >= LEAST_AREA {
                let share = overlap as f32 / (area + areas[label] - overlap) as f32;
                hit[label] |= share >= 0.7;
                best = best.max(share);
            }
        }
        let target = target(best);
        let kept = target > 0.0 || random.chance(KEPT);
        // Large masks are few and matter more.
        let weight = libm::sqrtf(area as f32) / if target > 0.0 { 1.0 } else { KEPT as f32 };
        kept.then_some(Sample { features: *features, target, weight })
    });
    let samples = samples.flatten().collect();
    let found = hit.iter().filter(|&&h| h).count();
    (samples, found, areas[1..].iter().filter(|&&a| a >= LEAST_AREA).count())
}

/// Adam on the weighted cross entropy, with a step size that decays to 0.
pub(crate) fn fit<const F: usize, const H: usize>(
    samples: &mut [Sample<F>],
    passes: usize,
) -> Perceptron<F, H> {
    let mut network = start(samples);
    let count = H * (F + 2) + 1;
    let (mut first, mut second) = (vec![0.0f64; count], vec![0.0f64; count]);
    let total = (passes * samples.len().div_ceil(BATCH)) as f64;
    let mut done = 0.0;
    for pass in 0..passes {
        let random = &mut stream(0, "fit/pass", pass as u64);
        random.shuffle(samples);
        let (mut loss, mut sum) = (0.0, 0.0);
        for batch in samples.chunks(BATCH) {
            let mut slope = vec![0.0f64; count];
            let mut weights = 0.0;
            for sample in batch {
                loss += add_slope(&network, sample, random, &mut slope);
                weights += f64::from(sample.weight);
            }
            sum += weights;
            done += 1.0;
            let rate = RATE * (1.0 - done / total);
            let mut k = 0;
            visit(&mut network, |value| {
                let g = slope[k] / weights + 1e-5 * f64::from(*value);
                first[k] = 0.9 * first[k] + 0.1 * g;
                second[k] = 0.999 * second[k] + 0.001 * g * g;
                let c1 = 1.0 - libm::pow(0.9, done);
                let c2 = 1.0 - libm::pow(0.999, done);
                *value -= (rate * first[k] / c1 / ((second[k] / c2).sqrt() + 1e-8)) as f32;
                k += 1;
            });
        }
        println!("pass {pass}: cross entropy {:.4}", loss / sum);
    }
    network
}

/// A network that scales features to mean 0 and standard deviation 1, with small random weights.
fn start<const F: usize, const H: usize>(samples: &[Sample<F>]) -> Perceptron<F, H> {
    let random: &mut Stream = &mut stream(0, "fit/start", 0);
    let n = samples.len().max(1) as f64;
    let mean: [f64; F] =
        std::array::from_fn(|k| samples.iter().map(|s| f64::from(s.features[k])).sum::<f64>() / n);
    let scale = std::array::from_fn(|k| {
        let square =
            |s: &Sample<F>| (f64::from(s.features[k]) - mean[k]) * (f64::from(s.features[k]) - mean[k]);
        (1.0 / ((samples.iter().map(square).sum::<f64>() / n).sqrt() + 1e-3)) as f32
    });
    let size = libm::sqrt(2.0 / F as f64);
    Perceptron {
        mean: mean.map(|m| m as f32),
        scale,
        hidden: std::array::from_fn(|_| std::array::from_fn(|_| (size * random.normal()) as f32)),
        hidden_offset: [0.0; H],
        output: std::array::from_fn(|_| (0.2 * random.normal()) as f32),
        output_offset: -2.0,
    }
}

/// Visits every fitted number, in the order of the gradient.
fn visit<const F: usize, const H: usize>(network: &mut Perceptron<F, H>, mut change: impl FnMut(&mut f32)) {
    network.hidden.iter_mut().flatten().for_each(&mut change);
    network.hidden_offset.iter_mut().for_each(&mut change);
    network.output.iter_mut().for_each(&mut change);
    change(&mut network.output_offset);
}

/// Adds the gradient of a sample's loss and returns the loss.
fn add_slope<const F: usize, const H: usize>(
    network: &Perceptron<F, H>,
    sample: &Sample<F>,
    random: &mut Stream,
    slope: &mut [f64],
) -> f64 {
    let x: [f32; F] = std::array::from_fn(|k| {
        let scaled = (sample.features[k] - network.mean[k]) * network.scale[k];
        // Uniform noise of the wanted standard deviation: faster than normal noise, and as good here.
        (scaled + (NOISE * 3.464 * (random.unit() - 0.5)) as f32).clamp(-4.0, 4.0)
    });
    let units: [f32; H] = std::array::from_fn(|h| {
        (network.hidden_offset[h] + network.hidden[h].iter().zip(x).map(|(w, v)| w * v).sum::<f32>()).max(0.0)
    });
    let sum = network.output_offset + units.iter().zip(network.output).map(|(u, w)| u * w).sum::<f32>();
    let score = 1.0 / (1.0 + libm::exp(-f64::from(sum)));
    let (target, weight) = (f64::from(sample.target), f64::from(sample.weight));
    let error = weight * (score - target);
    for h in (0..H).filter(|&h| units[h] > 0.0) {
        let back = error * f64::from(network.output[h]);
        for k in 0..F {
            slope[h * F + k] += back * f64::from(x[k]);
        }
        slope[H * F + h] += back;
        slope[H * (F + 1) + h] += error * f64::from(units[h]);
    }
    slope[H * (F + 2)] += error;
    let safe = score.clamp(1e-6, 1.0 - 1e-6);
    -weight * (target * libm::log(safe) + (1.0 - target) * libm::log(1.0 - safe))
}

/// The network as a source file.
pub(crate) fn source<const F: usize, const H: usize>(
    network: &Perceptron<F, H>,
    made_by: &str,
    import: &str,
) -> String {
    let name = import.rsplit(':').next().unwrap_or(import);
    let list = |values: &[f32]| values.iter().map(|v| format!("{v:.4},")).collect::<String>();
    let mut text = format!(
        "//! The network's weights, {made_by}. Not written by hand.\n\n\
         use {import};\n\n\
         /// See [`{name}`].\n\
         #[rustfmt::skip]\n\
         #[allow(clippy::approx_constant)] // chance\n\
         pub(super) static NETWORK: {name} = {name} {{\n"
    );
    let mut field = |name: &str, value: String| writeln!(text, "    {name}: {value},").expect("memory");
    field("mean", format!("[{}]", list(&network.mean)));
    field("scale", format!("[{}]", list(&network.scale)));
    let rows: String = network.hidden.iter().map(|row| format!("\n        [{}],", list(row))).collect();
    field("hidden", format!("[{rows}\n    ]"));
    field("hidden_offset", format!("[{}]", list(&network.hidden_offset)));
    field("output", format!("[{}]", list(&network.output)));
    field("output_offset", format!("{:.4}", network.output_offset));
    text.push_str("};\n");
    text
}
