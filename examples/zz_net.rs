//! How well segmenters find the elements of procedural scenes, and what they find in photographs.
//!
//! `cargo run --release --example segment_scores -- [--scenes 200] [--first 9000000] [--side 256]`
//! `cargo run --release --example segment_scores -- --photos DIR --out DIR`
//!
//! Prints, by kind of scene, the share of true elements with at least 30 visible pixels that a mask
//! matches (intersection over union of at least 0.7), and the share of masks that match none.
//! Plain Felzenszwalb is shown at its single best setting, searched on other scenes by the F-score
//! of the two. With `--photos`, outlines are drawn over every picture of a folder instead.

use std::path::{Path, PathBuf};
use vtex::procedural::{Exemplar, Kind, SceneParams, generate};
use vtex::raster::{LabelMap, picture};
use vtex::segment::{Felzenszwalb, Regions, ScoredMask, Segmenter};

type Failure = Box<dyn std::error::Error>;

const LEAST_AREA: u32 = 30;
const MATCH: f64 = 0.7;
/// The search for Felzenszwalb's setting uses seeds from here.
const SEARCH_SEED: u64 = 8_000_000;
const SEARCH_SCENES: u64 = 40;

fn main() -> Result<(), Failure> {
    let (mut scenes, mut first, mut side) = (200u64, 9_000_000u64, 256u32);
    let (mut photos, mut out) = (None, PathBuf::from("."));
    let mut net: Option<String> = None;
    let mut joint = false;
    let (mut scales, mut q, mut st, mut lev) = (vec![2.0f32], 0.3f32, 0.3f32, 3u32);
    let mut arguments = std::env::args().skip(1);
    while let Some(flag) = arguments.next() {
        let value = arguments.next().ok_or(format!("{flag} needs a value"))?;
        match flag.as_str() {
            "--scenes" => scenes = value.parse()?,
            "--first" => first = value.parse()?,
            "--side" => side = value.parse()?,
            "--net" => net = Some(value),
            "--scales" => scales = value.split(',').map(|v| v.parse().unwrap()).collect(),
            "--joint" => joint = value == "1",
            "--q" => q = value.parse()?,
            "--st" => st = value.parse()?,
            "--levels" => lev = value.parse()?,
            "--photos" => photos = Some(PathBuf::from(value)),
            "--out" => out = value.into(),
            _ => return Err(format!("unknown flag {flag}").into()),
        }
    }
    if let Some(net) = net {
        use vtex::segment::prompt::{Generator, GeneratorParams};
        use vtex::segment::texton::{Texton, TextonNetwork};
        let _ = net;
        let options =
            vtex::engine::EngineOptions { runtime: vtex::engine::Runtime::Rten, ..Default::default() };
        let params = GeneratorParams {
            scales,
            predicted_iou: q,
            stability: st,
            confident: 0.6,
            levels: lev,
            crop: 16384,
            ..GeneratorParams::default()
        };
        if joint {
            let g = Texton::new(&options)?;
            if let Some(folder) = photos {
                return draw(
                    &|p| {
                        let t = Timer(std::sync::Mutex::new((String::new(), cpu(), Default::default())));
                        let r = g.segment(p, &t)?;
                        use vtex::Progress;
                        t.advance("end", 0, 0);
                        eprintln!("{:?}", t.0.lock().unwrap().2);
                        Ok(r)
                    },
                    &folder,
                    &out,
                );
            }
            let mut totals = [[Tally::default(); Kind::ALL.len()]; 2];
            for seed in first..first + scenes {
                let parameters = SceneParams::random(seed, side, side);
                let scene = generate(&parameters)?;
                let kind = Kind::ALL.iter().position(|&k| k == parameters.kind).unwrap_or(0);
                totals[0][kind].add(tally(&scene, &g.segment(&scene.image, &())?));
                let all: Vec<ScoredMask> = g
                    .candidates(&scene.image, &())?
                    .into_iter()
                    .map(|c| ScoredMask { mask: c.mask, score: 0.0 })
                    .collect();
                totals[1][kind].add(tally(&scene, &all));
            }
            return table(totals);
        }
        let g = Generator::new(Box::new(TextonNetwork::built_in(&options)?), params)?;
        if let Some(folder) = photos {
            return draw(&|p| Ok(g.segment(p, &())?), &folder, &out);
        }
        let mut totals = [[Tally::default(); Kind::ALL.len()]; 2];
        let start = std::time::Instant::now();
        let mut cost = [0u64; 2];
        for seed in first..first + scenes {
            let parameters = SceneParams::random(seed, side, side);
            let scene = generate(&parameters)?;
            let kind = Kind::ALL.iter().position(|&k| k == parameters.kind).unwrap_or(0);
            let (found, c) = g.find(&scene.image, &())?;
            cost[0] += c.grid;
            cost[1] += c.prompts;
            let all: Vec<ScoredMask> = found
                .iter()
                .map(|f| ScoredMask { mask: f.mask.clone(), score: f.predicted_iou * f.stability })
                .collect();
            totals[1][kind].add(tally(&scene, &all));
            totals[0][kind].add(tally(&scene, &greedy(&all, side)));
        }
        println!(
            "{:.2} s a scene, prompts {} of {}",
            start.elapsed().as_secs_f64() / scenes as f64,
            cost[1],
            cost[0]
        );
        return table(totals);
    }
    match photos {
        Some(folder) => draw_photos(&folder, &out),
        None => compare(scenes, first, side),
    }
}

fn compare(scenes: u64, first: u64, side: u32) -> Result<(), Failure> {
    let best = search(side)?;
    println!("Felzenszwalb's best setting: {best:?}");
    let mut totals = [[Tally::default(); Kind::ALL.len()]; 2];
    for seed in first..first + scenes {
        let parameters = SceneParams::random(seed, side, side);
        let scene = generate(&parameters)?;
        let kind = Kind::ALL.iter().position(|&k| k == parameters.kind).unwrap_or(0);
        totals[0][kind].add(tally(&scene, &Regions.segment(&scene.image, &())?));
        totals[1][kind].add(tally(&scene, &best.segment(&scene.image, &())?));
    }
    table(totals)
}

struct Timer(std::sync::Mutex<(String, f64, std::collections::BTreeMap<String, f64>)>);
fn cpu() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}
impl vtex::Progress for Timer {
    fn advance(&self, stage: &'static str, _: u64, _: u64) -> bool {
        let mut g = self.0.lock().unwrap();
        let now = cpu();
        let d = now - g.1;
        let old = std::mem::replace(&mut g.0, stage.to_string());
        *g.2.entry(old).or_insert(0.0) += d;
        g.1 = now;
        true
    }
}

fn greedy(all: &[ScoredMask], side: u32) -> Vec<ScoredMask> {
    let mut taken = LabelMap::filled(side, side, 0);
    let mut out = Vec::new();
    for m in all {
        let free = m.mask.pixels().filter(|&(x, y)| taken.get(x as u32, y as u32) == 0).count() as u32;
        if 2 * free > m.mask.area() {
            for (x, y) in m.mask.pixels() {
                taken.set(x as u32, y as u32, 1);
            }
            out.push(m.clone());
        }
    }
    out
}

fn draw(
    g: &dyn Fn(&image::RgbImage) -> Result<Vec<ScoredMask>, Failure>,
    folder: &Path,
    out: &Path,
) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>()?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "png" || e == "jpg"));
    paths.sort();
    for path in paths {
        let photo = image::open(&path)?.to_rgb8();
        let start = std::time::Instant::now();
        let found = g(&photo)?;
        let seconds = start.elapsed().as_secs_f64();
        let mut map = LabelMap::filled(photo.width(), photo.height(), 0);
        let mut n = 0;
        for f in &found {
            let free = f.mask.pixels().filter(|&(x, y)| map.get(x as u32, y as u32) == 0).count() as u32;
            if 2 * free > f.mask.area() {
                n += 1;
                for (x, y) in f.mask.pixels() {
                    if map.get(x as u32, y as u32) == 0 {
                        map.set(x as u32, y as u32, n);
                    }
                }
            }
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        picture::outlines(&photo, &map).save(out.join(format!("{name}.png")))?;
        println!("{name}: {n} masks of {}, {seconds:.2} s", found.len());
    }
    Ok(())
}

fn table(totals: [[Tally; Kind::ALL.len()]; 2]) -> Result<(), Failure> {
    println!("{:12} {:>9}  {:>9} {:>9}   {:>9} {:>9}", "", "", "regions", "", "felzensz.", "");
    println!(
        "{:12} {:>9}  {:>9} {:>9}   {:>9} {:>9}",
        "kind", "elements", "found", "false", "found", "false"
    );
    let line = |name: &str, [a, b]: [Tally; 2]| {
        println!(
            "{name:12} {:9}  {:9.3} {:9.3}   {:9.3} {:9.3}",
            a.wanted,
            a.found_share(),
            a.false_share(),
            b.found_share(),
            b.false_share()
        );
    };
    let mut sums = [Tally::default(); 2];
    for (k, kind) in Kind::ALL.iter().enumerate() {
        line(&format!("{kind:?}"), [totals[0][k], totals[1][k]]);
        (0..2).for_each(|m| sums[m].add(totals[m][k]));
    }
    line("all", sums);
    for (bin, name) in SIZES.iter().enumerate() {
        let share = |t: &Tally| t.found_by_size[bin] as f64 / t.wanted_by_size[bin].max(1) as f64;
        println!(
            "{:>5} px up   {:8}  {:9.3} {:9}   {:9.3}",
            name,
            sums[0].wanted_by_size[bin],
            share(&sums[0]),
            "",
            share(&sums[1])
        );
    }
    Ok(())
}

/// Smallest areas of the size classes reported.
const SIZES: [u32; 5] = [30, 100, 300, 1000, 3000];

#[derive(Clone, Copy, Default)]
struct Tally {
    wanted: usize,
    found: usize,
    masks: usize,
    unmatched: usize,
    wanted_by_size: [usize; SIZES.len()],
    found_by_size: [usize; SIZES.len()],
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

/// Masks that match an element too small to count are neither right nor wrong, and so are masks
/// too small themselves.
fn tally(scene: &Exemplar, masks: &[ScoredMask]) -> Tally {
    let areas = scene.instances.areas();
    let mut found = vec![false; areas.len()];
    let mut tally = Tally::default();
    for scored in masks {
        let area = scored.mask.area();
        let mut shared = std::collections::BTreeMap::new();
        for (x, y) in scored.mask.pixels() {
            *shared.entry(scene.instances.get(x as u32, y as u32)).or_insert(0u32) += 1;
        }
        let overlap =
            |(&label, &n): (&u32, &u32)| (f64::from(n) / f64::from(area + areas[label as usize] - n), label);
        let best = shared.iter().filter(|(label, _)| **label > 0).map(overlap);
        let (best, label) = best.fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
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
    }
    tally
}

/// The setting of plain Felzenszwalb with the best F-score on scenes of its own.
fn search(side: u32) -> Result<Felzenszwalb, Failure> {
    let scenes: Vec<Exemplar> = (SEARCH_SEED..SEARCH_SEED + SEARCH_SCENES)
        .map(|seed| generate(&SceneParams::random(seed, side, side)))
        .collect::<Result<_, _>>()?;
    let mut best = (0.0, Felzenszwalb::default());
    for scale in [50.0, 100.0, 200.0, 400.0, 800.0] {
        for sigma in [0.3, 0.5, 0.8, 1.2] {
            for minimum in [12, 20, 40, 80] {
                let setting = Felzenszwalb { scale, sigma, minimum };
                let mut sum = Tally::default();
                for scene in &scenes {
                    sum.add(tally(scene, &setting.segment(&scene.image, &())?));
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
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>()?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "png" || e == "jpg"));
    paths.sort();
    for path in paths {
        let photo = image::open(&path)?.to_rgb8();
        let start = std::time::Instant::now();
        let masks = Regions.segment(&photo, &())?;
        let seconds = start.elapsed().as_secs_f64();
        let mut map = LabelMap::filled(photo.width(), photo.height(), 0);
        for (scored, label) in masks.iter().zip(1..) {
            for (x, y) in scored.mask.pixels() {
                map.set(x as u32, y as u32, label);
            }
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        picture::outlines(&photo, &map).save(out.join(format!("{name}.png")))?;
        let covered = map.labels.iter().filter(|&&l| l > 0).count() as f64 / map.labels.len() as f64;
        println!("{name}: {} masks, {covered:.3} covered, {seconds:.2} s", masks.len());
    }
    Ok(())
}
