//! `vtex raster`: photograph → pixels.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::{Input, InputKind};
use crate::cli::number::Takes;
use crate::cli::options::files::{ForceArgs, check_files, required};
use crate::cli::output::{Destination, WrittenFile};
use crate::cli::progress::Reporter;
use crate::cli::summary::Summary;
use crate::cli::values::{Axes, Size, named};
use clap::Args;
use serde::Deserialize;
use std::path::PathBuf;
use vtex::Progress;
use vtex::analyze::{Exemplar, Limits};
use vtex::layers::LayerPicture;
use vtex::output::file::Format;
use vtex::output::png::encode_rgb;
use vtex::pixels::{Leaf, by_numbers, carried, scanned};

/// Photograph to pixels of any size: a baseline
#[derive(Args)]
#[command(
    override_usage = "vtex raster [OPTIONS] <PHOTO>",
    after_long_help = "\
Examples:
  vtex raster photo.jpg -o big.png --size 1000 --tile
  vtex raster rust.jpg -o new.png --control layers.png map.png
  vtex raster photo.jpg -o scanned.png --method tsvq"
)]
pub(crate) struct RasterArgs {
    /// The photograph: PNG, JPEG, TIFF, WebP, BMP, GIF or PNM; - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result: .png; - writes to stdout [default: ./PHOTO.raster.png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    /// Size of the result, 1000 or 1000x600
    #[arg(long, value_name = "SIZE")]
    #[arg(takes = format!("1 to {} px each, default: as the photograph", Exemplar::LARGEST_SIDE))]
    pub(crate) size: Option<Size>,
    /// Make it repeat without a seam, along x, y or both axes [none, both, x or y; alone: both;
    /// default: none]
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    pub(crate) tile: Option<Axes>,
    /// Pixels carried along a field of correspondences, or made one by one with a codebook of
    /// neighbourhoods, exact or soft [correspondence, tsvq or tsvq-soft, default: correspondence]
    #[arg(long, value_name = "METHOD", value_parser = named::<PixelMethod>)]
    pub(crate) method: Option<PixelMethod>,
    /// Two layer maps: where in the photograph what is, and where it is to be in the result; the
    /// second sets the size
    #[arg(long, num_args = 2, value_names = ["KNOWN", "WANTED"], conflicts_with_all = ["size", "method"])]
    pub(crate) control: Option<Vec<PathBuf>>,
}

/// How pixels are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PixelMethod {
    #[default]
    Correspondence,
    Tsvq,
    TsvqSoft,
}

/// The source and the result.
struct Making {
    photo: Input,
    control: Option<[Input; 2]>,
    size: Option<[usize; 2]>,
    wrap: [bool; 2],
    method: PixelMethod,
    seed: u64,
    place: Destination,
}

impl Arguments for RasterArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let making = Making::new(*self, resolved.seed.0)?;
        Ok(Box::new(move |common, reporter| run(common, reporter, &making)))
    }
}

impl Making {
    fn new(a: RasterArgs, seed: u64) -> Result<Self, Failure> {
        let photo = required(a.photo)?;
        let control = match a.control.map(<[PathBuf; 2]>::try_from) {
            Some(Ok(maps)) => Some(maps.map(Input::new)),
            Some(Err(_)) => return Err(Failure::usage("--control takes two maps")),
            None => None,
        };
        let mut read = vec![("the photograph", &photo)];
        read.extend(control.iter().flatten().map(|file| ("--control", file)));
        check_files(&read, &[("-o", a.output.as_deref())])?;
        let place = match (a.output, &photo) {
            (Some(path), _) if path.as_os_str() != "-" => {
                format::kind_of("--output", &path, &[Format::Png])?;
                Destination::File { path, force: a.force.force }
            }
            (None, Input::File(path)) => {
                let mut name = format::stem(path);
                name.push(".raster.png");
                Destination::File { path: name.into(), force: a.force.force }
            }
            _ => Destination::Stdout,
        };
        let size = a.size.map(|s| [s.width as usize, s.height as usize]);
        let wrap = a.tile.map_or([false; 2], |t| [t.0.x, t.0.y]);
        Ok(Self { photo, control, size, wrap, method: a.method.unwrap_or_default(), seed, place })
    }
}

fn run(common: &Common, reporter: &Reporter, job: &Making) -> anyhow::Result<()> {
    job.place.probe()?;
    reporter.stage("reading")?;
    let read = |input: &Input| -> anyhow::Result<(String, Vec<u8>)> {
        let bytes = input.read()?;
        InputKind::expect(&bytes, input, &[InputKind::Image, InputKind::Unknown])
            .map_err(|failure| failure.hint("draw scenes and SVGs with 'vtex render' first"))?;
        Ok((input.name(), bytes))
    };
    let (name, bytes) = read(&job.photo)?;
    let photo = Exemplar::from_bytes(&bytes, &name, &Limits::default())?;
    photo.warnings.iter().for_each(|warning| reporter.warn(warning));
    let image = photo.image;
    let mut inputs = vec![name];
    let made = if let Some([known, wanted]) = &job.control {
        let mut picture = |input| -> anyhow::Result<LayerPicture> {
            let (name, bytes) = read(input)?;
            inputs.push(name.clone());
            Ok(LayerPicture::from_bytes(&bytes, &name, &Limits::default())?)
        };
        let known = picture(known)?.layers()?;
        let wanted = picture(wanted)?.in_colours_of(&known)?;
        by_numbers(&image, &known.labels, &wanted, job.wrap, job.seed, reporter)?
    } else {
        let size = job.size.unwrap_or([image.width() as usize, image.height() as usize]);
        match job.method {
            PixelMethod::Correspondence => carried(&image, size, job.wrap, job.seed, reporter)?,
            PixelMethod::Tsvq => scanned(&image, size, Leaf::Exact, job.seed, reporter)?,
            PixelMethod::TsvqSoft => scanned(&image, size, Leaf::Mean, job.seed, reporter)?,
        }
    };
    reporter.stage("writing")?;
    let (_, bytes) = job.place.write(|out| encode_rgb(&made, out))?;
    let summary = Summary {
        seed: Some(job.seed),
        size: [made.width(), made.height()],
        ..Summary::new("raster", inputs, job.place.path(), WrittenFile::of(bytes), reporter)
    };
    summary.print(common, job.place == Destination::Stdout)
}
