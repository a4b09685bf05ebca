//! Scores of segmenters on procedural scenes and on photographs labelled by hand, and pictures of their
//! masks on any photograph.
//!
//! `cargo run --release --example segment_scores -- [--scenes 200] [--first 9000000] [--side 256]`
//! `cargo run --release --example segment_scores -- --labels PHOTO_DIR`
//! `cargo run --release --example segment_scores -- --photos DIR --out DIR`
//! `cargo run --release --example segment_scores -- --grid PHOTO_DIR`
//!
//! Prints recall, the share of true elements of at least 30 visible pixels that a mask matches (IoU of
//! at least 0.7), and the share of masks that match none. Segmenters: `texton`; the masks of its network
//! alone, better ones over worse; `regions`; plain Felzenszwalb with the fixed parameters of the best
//! F-score on other scenes. `--labels` does the same on the crops of `tests/labels`, for each of the two
//! lists there. `--photos` draws outlines over every picture of a folder instead. `--grid` prints the
//! share of masks of a full grid of prompts that the coarse-to-fine search finds too, and the share of
//! prompts that it needs.

use std::path::{Path, PathBuf};
use vtex::raster::{LabelMap, Mask, picture};
use vtex::segment::prompt::{Generator, GeneratorParams};
use vtex::segment::texton::{Texton, TextonNetwork};
use vtex::segment::{Felzenszwalb, Regions, ScoredMask, Segmenter};
use vtex_testing::{GeneratedExemplar, SceneKind, SceneParams, generate};

mod labelled;
use labelled::{LabelledCrop, UNSURE, areas_known, crops};

type Failure = Box<dyn std::error::Error>;

const LEAST_AREA: u32 = 30;
const MATCH: f64 = 0.7;
/// First seed of the scenes on which Felzenszwalb's parameters are chosen.
const SEARCH_SEED: u64 = 8_000_000;
const SEARCH_SCENES: u64 = 40;

fn main() -> Result<(), Failure> {
    let (mut scenes, mut first, mut side) = (200u64, 9_000_000u64, 256u32);
    let (mut photos, mut labels, mut grid, mut out) = (None, None, None, PathBuf::from("."));
    let mut arguments = std::env::args().skip(1);
    while let Some(flag) = arguments.next() {
        let value = arguments.next().ok_or(format!("{flag} needs a value"))?;
        match flag.as_str() {
            "--scenes" => scenes = value.parse()?,
            "--first" => first = value.parse()?,
            "--side" => side = value.parse()?,
            "--photos" => photos = Some(PathBuf::from(value)),
            "--labels" => labels = Some(PathBuf::from(value)),
            "--grid" => grid = Some(PathBuf::from(value)),
            "--out" => out = value.into(),
            _ => return Err(format!("unknown flag {flag}").into()),
        }
    }
    if let Some(folder) = photos {
        return draw_photos(&folder, &out);
    }
    if let Some(folder) = grid {
        return compare_grids(&folder);
    }
    let felzenszwalb = search(256)?;
    println!("Felzenszwalb's best setting: {felzenszwalb:?}");
    let methods: [(&str, Box<dyn Segmenter>); 4] = [
        ("texton", Box::new(Texton::new()?)),
        ("network", Box::new(NetworkAlone::new(3)?)),
        ("regions", Box::new(Regions)),
        ("felzensz.", Box::new(felzenszwalb)),
    ];
    match labels {
        Some(folder) => compare_labels(&folder, &methods),
        None => compare_scenes(scenes, first, side, &methods),
    }
}

/// The masks of the texton network alone, better ones over worse.
struct NetworkAlone(Generator);

impl NetworkAlone {
    fn new(levels: u32) -> Result<Self, Failure> {
        let network = TextonNetwork::built_in()?;
        let params = GeneratorParams {
            scales: vec![2.0, 1.0, 0.5],
            predicted_iou: 0.6,
            stability: 0.6,
            confident: 0.82,
            crop: 16_384,
            levels,
            ..GeneratorParams::default()
        };
        Ok(Self(Generator::new(Box::new(network), params)?))
    }
}

impl Segmenter for NetworkAlone {
    fn name(&self) -> String {
        "network".into()
    }

    fn segment(
        &self,
        image: &image::RgbImage,
        progress: &dyn vtex::Progress,
    ) -> vtex::Result<Vec<ScoredMask>> {
        let mut taken = LabelMap::filled(image.width(), image.height(), 0);
        let mut masks = self.0.segment(image, progress)?;
        masks.retain(|scored| {
            let free = scored.mask.pixels().filter(|&(x, y)| taken.get(x as u32, y as u32) == 0).count();
            let kept = 2 * free as u32 > scored.mask.area();
            if kept {
                taken.fill(&scored.mask, 1);
            }
            kept
        });
        Ok(masks)
    }
}

type Methods<'a> = [(&'a str, Box<dyn Segmenter>)];

fn header(methods: &Methods) {
    print!("{:20} {:>9}", "", "");
    methods.iter().for_each(|(name, _)| print!("  {name:>9} {:>7}", ""));
    print!("\n{:20} {:>9}", "", "elements");
    methods.iter().for_each(|_| print!("  {:>9} {:>7}", "found", "false"));
    println!();
}

fn line(name: &str, tallies: &[Tally]) {
    print!("{name:20} {:9}", tallies[0].wanted);
    tallies.iter().for_each(|t| print!("  {:9.3} {:7.3}", t.found_share(), t.false_share()));
    println!();
}

/// A line for the elements of some size, of which masks that match none are not told.
fn size_line(name: &str, wanted: usize, found: &[usize]) {
    print!("{name:20} {wanted:9}");
    found.iter().for_each(|&n| print!("  {:9.3} {:7}", n as f64 / wanted.max(1) as f64, ""));
    println!();
}

fn compare_scenes(scenes: u64, first: u64, side: u32, methods: &Methods) -> Result<(), Failure> {
    let mut totals = vec![vec![Tally::default(); methods.len()]; SceneKind::ALL.len()];
    for seed in first..first + scenes {
        let parameters = SceneParams::random(seed, side, side);
        let GeneratedExemplar { image, instances } = generate(&parameters)?;
        let kind = SceneKind::ALL.iter().position(|&k| k == parameters.kind).unwrap_or(0);
        for (total, (_, method)) in totals[kind].iter_mut().zip(methods) {
            total.add(tally(&instances, &method.segment(&image, &())?));
        }
    }
    header(methods);
    let mut sums = vec![Tally::default(); methods.len()];
    for (kind, row) in SceneKind::ALL.iter().zip(&totals) {
        line(&format!("{kind:?}"), row);
        sums.iter_mut().zip(row).for_each(|(sum, t)| sum.add(t.clone()));
    }
    line("all", &sums);
    for (bin, size) in SIZES.iter().enumerate() {
        let found: Vec<usize> = sums.iter().map(|t| t.found_by_size[bin]).collect();
        size_line(&format!("{size:>5} px up"), sums[0].wanted_by_size[bin], &found);
    }
    Ok(())
}

fn compare_labels(photos: &Path, methods: &Methods) -> Result<(), Failure> {
    for title in ["Chosen on", "Reported on"] {
        println!("\n{title}");
        header(methods);
        let mut sums = vec![Tally::default(); methods.len()];
        let (mut large_wanted, mut large_found) = (0usize, vec![0usize; methods.len()]);
        for crop in crops(photos, title)? {
            let tallies = compare_photo(&crop, methods)?;
            line(&crop.name, &tallies);
            let (limit, wanted, found) = upper_third(&crop.truth, &tallies);
            size_line(&format!(" from {limit}"), wanted, &found);
            large_wanted += wanted;
            large_found.iter_mut().zip(found).for_each(|(sum, n)| *sum += n);
            sums.iter_mut().zip(tallies).for_each(|(sum, t)| sum.add(t));
        }
        line("all", &sums);
        size_line(" upper thirds", large_wanted, &large_found);
    }
    Ok(())
}

/// What each method finds of the elements of a crop.
fn compare_photo(crop: &LabelledCrop, methods: &Methods) -> Result<Vec<Tally>, Failure> {
    let mut tallies = Vec::new();
    for (_, method) in methods {
        let masks = method.segment(&crop.photo, &())?;
        let clipped = masks.iter().map(|m| ScoredMask { mask: crop.clip(&m.mask), score: m.score });
        tallies.push(tally(&crop.truth, &clipped.collect::<Vec<_>>()));
    }
    Ok(tallies)
}

/// The upper third of the elements by area: its least area, how many they are, and how many of them
/// each method found.
fn upper_third(truth: &LabelMap, tallies: &[Tally]) -> (u32, usize, Vec<usize>) {
    let mut areas: Vec<u32> = areas_known(truth).into_iter().filter(|&a| a >= LEAST_AREA).collect();
    areas.sort_unstable();
    let limit = areas.get(areas.len() * 2 / 3).copied().unwrap_or(0);
    let large = |areas: &[u32]| areas.iter().filter(|&&a| a >= limit).count();
    (limit, large(&areas), tallies.iter().map(|t| large(&t.found_areas)).collect())
}

fn compare_grids(folder: &Path) -> Result<(), Failure> {
    let (full, coarse) = (NetworkAlone::new(1)?.0, NetworkAlone::new(3)?.0);
    println!("{:12} {:>8} {:>8} {:>9} {:>8}", "photograph", "masks", "found", "prompts", "asked");
    for photo in pictures(folder)? {
        let image = image::open(&photo)?.to_rgb8();
        let (all, _) = full.find(&image, &())?;
        let (some, cost) = coarse.find(&image, &())?;
        let alike = |a: &Mask, b: &Mask| {
            let both = a.overlap(b);
            10 * both >= 8 * (a.area() + b.area() - both)
        };
        let found = all.iter().filter(|a| some.iter().any(|b| a.scale == b.scale && alike(&a.mask, &b.mask)));
        let (found, name) = (found.count(), photo.file_stem().unwrap_or_default().to_string_lossy());
        let share = |a: f64, b: f64| a / b.max(1.0);
        println!(
            "{name:12} {:8} {:8.3} {:9} {:8.3}",
            all.len(),
            share(found as f64, all.len() as f64),
            cost.grid,
            share(cost.prompts as f64, cost.grid as f64)
        );
    }
    Ok(())
}

/// The PNG and JPEG files of a folder.
fn pictures(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>()?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "png" || e == "jpg"));
    paths.sort();
    Ok(paths)
}

/// Smallest area of each size class reported.
const SIZES: [u32; 5] = [30, 100, 300, 1000, 3000];

#[derive(Clone, Default)]
struct Tally {
    wanted: usize,
    found: usize,
    masks: usize,
    unmatched: usize,
    wanted_by_size: [usize; SIZES.len()],
    found_by_size: [usize; SIZES.len()],
    found_areas: Vec<u32>,
}

impl Tally {
    fn add(&mut self, o: Self) {
        self.wanted += o.wanted;
        self.found += o.found;
        self.masks += o.masks;
        self.unmatched += o.unmatched;
        for k in 0..SIZES.len() {
            self.wanted_by_size[k] += o.wanted_by_size[k];
            self.found_by_size[k] += o.found_by_size[k];
        }
        self.found_areas.extend(o.found_areas);
    }

    fn found_share(&self) -> f64 {
        self.found as f64 / self.wanted.max(1) as f64
    }

    fn false_share(&self) -> f64 {
        self.unmatched as f64 / self.masks.max(1) as f64
    }

    fn f_score(&self) -> f64 {
        let (recall, precision) = (self.found_share(), 1.0 - self.false_share());
        2.0 * recall * precision / (recall + precision).max(1e-9)
    }
}

/// Counts matches. Masks that are too small, match an element too small to count, or lie mostly on
/// unsure pixels count neither as right nor as wrong.
fn tally(truth: &LabelMap, masks: &[ScoredMask]) -> Tally {
    let areas = areas_known(truth);
    let mut found = vec![false; areas.len()];
    let mut tally = Tally::default();
    for scored in masks {
        let area = scored.mask.area();
        let mut shared = std::collections::BTreeMap::new();
        for (x, y) in scored.mask.pixels() {
            *shared.entry(truth.get(x as u32, y as u32)).or_insert(0u32) += 1;
        }
        if shared.get(&UNSURE).is_some_and(|&n| 2 * n > area) {
            continue;
        }
        let known = shared.iter().filter(|(label, _)| **label > 0 && **label != UNSURE);
        let overlap =
            |(&label, &n): (&u32, &u32)| (f64::from(n) / f64::from(area + areas[label as usize] - n), label);
        let (best, label) = known.map(overlap).fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
        let matched = best >= MATCH;
        found[label as usize] |= matched;
        if area >= LEAST_AREA && !(matched && areas[label as usize] < LEAST_AREA) {
            tally.masks += 1;
            tally.unmatched += usize::from(!matched);
        }
    }
    for (label, &area) in areas.iter().enumerate().skip(1).filter(|&(_, &a)| a >= LEAST_AREA) {
        let bin = SIZES.iter().rposition(|&s| area >= s).unwrap_or(0);
        tally.wanted += 1;
        tally.found += usize::from(found[label]);
        tally.wanted_by_size[bin] += 1;
        tally.found_by_size[bin] += usize::from(found[label]);
        tally.found_areas.extend(found[label].then_some(area));
    }
    tally
}

/// The parameters of plain Felzenszwalb with the best F-score on separate scenes.
fn search(side: u32) -> Result<Felzenszwalb, Failure> {
    let scenes: Vec<GeneratedExemplar> = (SEARCH_SEED..SEARCH_SEED + SEARCH_SCENES)
        .map(|seed| generate(&SceneParams::random(seed, side, side)))
        .collect::<Result<_, _>>()?;
    let mut best = (0.0, Felzenszwalb::default());
    for scale in [50.0, 100.0, 200.0, 400.0, 800.0] {
        for sigma in [0.3, 0.5, 0.8, 1.2] {
            for minimum in [12, 20, 40, 80] {
                let setting = Felzenszwalb { scale, sigma, minimum };
                let mut sum = Tally::default();
                for scene in &scenes {
                    sum.add(tally(&scene.instances, &setting.segment(&scene.image, &())?));
                }
                if sum.f_score() > best.0 {
                    best = (sum.f_score(), setting);
                }
            }
        }
    }
    Ok(best.1)
}

fn draw_photos(folder: &Path, out: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    let texton = Texton::new()?;
    for path in pictures(folder)? {
        let photo = image::open(&path)?.to_rgb8();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        for (method, segmenter) in [("texton", &texton as &dyn Segmenter), ("regions", &Regions)] {
            let start = std::time::Instant::now();
            let masks = segmenter.segment(&photo, &())?;
            let seconds = start.elapsed().as_secs_f64();
            let mut map = LabelMap::filled(photo.width(), photo.height(), 0);
            masks.iter().zip(1..).for_each(|(scored, label)| map.fill(&scored.mask, label));
            picture::outlines(&photo, &map).save(out.join(format!("{name}.{method}.png")))?;
            let covered = map.labels.iter().filter(|&&l| l > 0).count() as f64 / map.labels.len() as f64;
            println!("{name} {method}: {} masks, {covered:.3} covered, {seconds:.2} s", masks.len());
        }
    }
    Ok(())
}
