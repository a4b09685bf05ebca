//! Makes the exemplars of `examples/exemplars`, or random scenes with their ground truth, or measures
//! the speed.

use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use vtex_testing::{self, GeneratedExemplar, SceneKind, SceneParams};

#[path = "../examples/exemplars/scenes.rs"]
mod scenes;

const USAGE: &str = "\
Usage: make_exemplars OUT_DIR                                 the scenes of examples/exemplars
       make_exemplars OUT_DIR --random N [--size S] [--seed K] [--kind NAME]
                                                              N random scenes of S x S pixels, seeds K, K+1 ...,
                                                              each with its instances as a 16-bit label PNG
       make_exemplars OUT_DIR --random N --packed [...]       the same as three files for training: images.rgb
                                                              (N x S x S x 3 bytes), labels.u16 (N x S x S,
                                                              little endian), kinds.txt (a line each)
       make_exemplars --bench [--size S] [--kind NAME]        scenes per second on one core";

struct Arguments {
    folder: Option<PathBuf>,
    random: Option<u64>,
    packed: bool,
    size: u32,
    seed: u64,
    kind: Option<SceneKind>,
    bench: bool,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = parse(std::env::args().skip(1)).map_err(|message| format!("{message}\n{USAGE}"))?;
    if arguments.bench {
        return bench(&arguments);
    }
    let folder = arguments.folder.clone().ok_or(USAGE)?;
    std::fs::create_dir_all(&folder)?;
    match arguments.random {
        Some(count) if arguments.packed => pack(&arguments, count, &folder)?,
        Some(count) => {
            for seed in arguments.seed..arguments.seed + count {
                let scene = vtex_testing::generate(&arguments.params(seed))?;
                save_labels(&scene, &folder.join(format!("scene_{seed:05}.labels.png")))?;
                save(&scene.image, &folder.join(format!("scene_{seed:05}.png")))?;
            }
        }
        None => {
            for (name, params) in scenes::finished() {
                save(&scenes::picture(&params)?, &folder.join(format!("{name}.png")))?;
            }
        }
    }
    Ok(())
}

impl Arguments {
    fn params(&self, seed: u64) -> SceneParams {
        let mut params = SceneParams::random(seed, self.size, self.size);
        params.kind = self.kind.unwrap_or(params.kind);
        params
    }
}

fn parse(words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut arguments =
        Arguments { folder: None, random: None, packed: false, size: 256, seed: 0, kind: None, bench: false };
    let mut words = words;
    while let Some(word) = words.next() {
        let mut number = || {
            let text = words.next().ok_or(format!("{word} needs a number"))?;
            text.parse::<u64>().map_err(|_| format!("{word} {text}: not a whole number"))
        };
        match word.as_str() {
            "--random" => arguments.random = Some(number()?),
            "--size" => arguments.size = number()?.try_into().map_err(|_| "--size is too large")?,
            "--seed" => arguments.seed = number()?,
            "--packed" => arguments.packed = true,
            "--bench" => arguments.bench = true,
            "--kind" => {
                let name = words.next().unwrap_or_default();
                let kind = SceneKind::ALL.into_iter().find(|k| format!("{k:?}").eq_ignore_ascii_case(&name));
                arguments.kind = Some(kind.ok_or(format!("--kind {name}: one of {:?}", SceneKind::ALL))?);
            }
            flag if flag.starts_with('-') => return Err(format!("unknown flag {flag}")),
            _ => arguments.folder = Some(word.into()),
        }
    }
    Ok(arguments)
}

fn save(image: &image::RgbImage, path: &Path) -> Result<(), Box<dyn Error>> {
    use image::codecs::png::{CompressionType, FilterType, PngEncoder};
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
    image.write_with_encoder(encoder)?;
    Ok(())
}

/// Writes all scenes one after another into three files.
fn pack(arguments: &Arguments, count: u64, folder: &Path) -> Result<(), Box<dyn Error>> {
    let create = |name| std::fs::File::create(folder.join(name)).map(std::io::BufWriter::new);
    let (mut images, mut labels, mut kinds) =
        (create("images.rgb")?, create("labels.u16")?, create("kinds.txt")?);
    for seed in arguments.seed..arguments.seed + count {
        let params = arguments.params(seed);
        let scene = vtex_testing::generate(&params)?;
        images.write_all(scene.image.as_raw())?;
        for &label in &scene.instances.labels {
            labels.write_all(&u16::try_from(label)?.to_le_bytes())?;
        }
        writeln!(kinds, "{:?}", params.kind)?;
    }
    [images, labels, kinds].iter_mut().try_for_each(std::io::Write::flush)?;
    Ok(())
}

fn save_labels(scene: &GeneratedExemplar, path: &Path) -> Result<(), Box<dyn Error>> {
    let map = &scene.instances;
    let labels: Vec<u16> = map.labels.iter().map(|&l| l.try_into()).collect::<Result<_, _>>()?;
    let picture = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(map.width, map.height, labels);
    picture.ok_or("labels do not fill the map")?.save(path)?;
    Ok(())
}

fn bench(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let count = 200;
    let started = Instant::now();
    for seed in 0..count {
        vtex_testing::generate(&arguments.params(seed))?;
    }
    let seconds = started.elapsed().as_secs_f64();
    let (size, speed) = (arguments.size, count as f64 / seconds);
    println!("{count} random scenes of {size} x {size}: {speed:.1} a second on one core");
    Ok(())
}
