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
use crate::cli::values::{Axes, Margins, Size, named};
use clap::Args;
use serde::Deserialize;
use std::path::PathBuf;
use vtex::Progress;
use vtex::analyze::{Exemplar, Limits};
use vtex::layers::{LayerPicture, hole as read_hole};
use vtex::output::file::Format;
use vtex::output::png::encode_rgb;
use vtex::pixels::{ScanParams, by_numbers, carried, extended, filled, scanned, scanned_by_numbers};

/// Make pixels of any size from a photograph: a baseline
#[derive(Args)]
#[command(
    override_usage = "vtex raster [OPTIONS] <PHOTO>",
    after_long_help = "\
Examples:
  vtex raster photo.jpg -o big.png --size 1000 --tile
  vtex raster rust.jpg -o new.png --control layers.png map.png
  vtex raster photo.jpg -o scanned.png --method tsvq
  vtex raster photo.jpg -o mended.png --hole scratch.png
  vtex raster photo.jpg -o wider.png --extend 100,0,100,0"
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
    /// Size of the result: 1000, 1000x600, or at 96 px per inch: 300mm, 12in
    #[arg(long, value_name = "SIZE")]
    #[arg(takes = format!("1 to {} px each, default: as the photograph", Exemplar::LARGEST_SIDE))]
    pub(crate) size: Option<Size>,
    /// Make the result repeat without a seam, along x, y or both axes [none, both, x or y; alone: both;
    /// default: none]
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    pub(crate) tile: Option<Axes>,
    /// How to make pixels: correspondence copies patches of the photograph; tsvq makes them one by one from a
    /// codebook of neighbourhoods, and new textures have no seam [correspondence or tsvq, default:
    /// correspondence; tsvq with the options below]
    #[arg(long, value_name = "METHOD", value_parser = named::<PixelMethod>)]
    pub(crate) method: Option<PixelMethod>,
    /// Two layer maps: where the layers are in the photograph, and where they will be in the result. The
    /// second map sets the size
    #[arg(long, num_args = 2, value_names = ["KNOWN", "WANTED"], conflicts_with = "size")]
    pub(crate) control: Option<Vec<PathBuf>>,
    /// Make a part of the photograph again and keep the rest. The part is white in a picture of the same
    /// size, or opaque if that has transparency
    #[arg(long, value_name = "FILE", help_heading = CODEBOOK, conflicts_with_all = ["size", "control", "extend"])]
    pub(crate) hole: Option<PathBuf>,
    /// Continue the photograph beyond its border, by one number on all sides or by four: left, top, right,
    /// bottom
    #[arg(long, value_name = "PX|L,T,R,B", help_heading = CODEBOOK, conflicts_with_all = ["size", "control"])]
    #[arg(takes = format!("{}, default: 0", Margins::EACH))]
    pub(crate) extend: Option<Margins>,
    /// Number of resolution levels, each half of the next finer
    #[arg(long, help_heading = CODEBOOK)]
    #[arg(number_or(ScanParams::LEVELS, format!("up to {}, as many as the photograph has room for", ScanParams::MOST_DEFAULT_LEVELS)))]
    pub(crate) levels: Option<usize>,
    /// Side of the neighbourhoods that are compared, an odd number
    #[arg(long, alias = "neighborhood", help_heading = CODEBOOK, number = ScanParams::NEIGHBOURHOOD)]
    pub(crate) neighbourhood: Option<usize>,
    /// Number of codewords per level, at most its number of neighbourhoods
    #[arg(long, help_heading = CODEBOOK, number = ScanParams::CODEBOOK)]
    pub(crate) codebook: Option<usize>,
}

/// Heading of the options of one method.
const CODEBOOK: &str = "Pixels by codebook (--method tsvq)";

/// How pixels are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PixelMethod {
    #[default]
    Correspondence,
    Tsvq,
}

/// The source and the result.
struct Making {
    photo: Input,
    pixels: PixelsFrom,
    wrap: [bool; 2],
    /// Parameters of the codebook; `None` for the field.
    scan: Option<ScanParams>,
    seed: u64,
    place: Destination,
}

/// What the pixels are made for.
enum PixelsFrom {
    Photograph(Option<[usize; 2]>),
    Maps([Input; 2]),
    Hole(Input),
    Border([usize; 4]),
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
        let hole = a.hole.map(Input::new);
        read.extend(hole.iter().map(|file| ("--hole", file)));
        check_files(&read, &[("-o", a.output.as_deref())])?;
        let place = match (a.output, &photo) {
            (Some(path), _) if path.as_os_str() != "-" => {
                format::kind_of("--output", &path, |format| format == Format::Png)?;
                Destination::File { path, force: a.force.force }
            }
            (None, Input::File(path)) => {
                let mut name = format::stem(path);
                name.push(".raster.png");
                Destination::File { path: name.into(), force: a.force.force }
            }
            _ => Destination::Stdout,
        };
        let of_codebook = [
            ("--hole", hole.is_some()),
            ("--extend", a.extend.is_some()),
            ("--levels", a.levels.is_some()),
            ("--neighbourhood", a.neighbourhood.is_some()),
            ("--codebook", a.codebook.is_some()),
        ];
        let given = of_codebook.into_iter().find(|(_, given)| *given).map(|(name, _)| name);
        let method = match (a.method, given) {
            (Some(PixelMethod::Correspondence), Some(name)) => {
                return Err(Failure::usage(format!("{name} is for --method tsvq"))
                    .hint("leave out --method correspondence"));
            }
            (Some(method), _) => method,
            (None, Some(_)) => PixelMethod::Tsvq,
            (None, None) => PixelMethod::default(),
        };
        let scan = (method == PixelMethod::Tsvq).then(|| ScanParams {
            levels: a.levels,
            neighbourhood: a.neighbourhood.unwrap_or(ScanParams::NEIGHBOURHOOD.default()),
            codebook: a.codebook.unwrap_or(ScanParams::CODEBOOK.default()),
        });
        let pixels = match (control, hole, a.extend) {
            (Some(maps), ..) => PixelsFrom::Maps(maps),
            (_, Some(hole), _) => PixelsFrom::Hole(hole),
            (.., Some(Margins(margins))) => PixelsFrom::Border(margins),
            _ => PixelsFrom::Photograph(
                a.size.and_then(Size::pixels).map(|size| size.map(|side| side as usize)),
            ),
        };
        let wrap = a.tile.map_or([false; 2], |t| [t.0.x, t.0.y]);
        Ok(Self { photo, pixels, wrap, scan, seed, place })
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
    let mut other = |input| -> anyhow::Result<(String, Vec<u8>)> {
        let (name, bytes) = read(input)?;
        inputs.push(name.clone());
        Ok((name, bytes))
    };
    let (wrap, seed) = (job.wrap, job.seed);
    let scan = job.scan.unwrap_or_default();
    let made = match &job.pixels {
        PixelsFrom::Photograph(size) => {
            let size = size.unwrap_or([image.width() as usize, image.height() as usize]);
            match &job.scan {
                None => carried(&image, size, wrap, seed, reporter)?,
                Some(scan) => scanned(&image, size, scan, seed, reporter)?,
            }
        }
        PixelsFrom::Maps([known, wanted]) => {
            let mut picture = |input| -> anyhow::Result<LayerPicture> {
                let (name, bytes) = other(input)?;
                Ok(LayerPicture::from_bytes(&bytes, &name, &Limits::default())?)
            };
            let known = picture(known)?.layers()?;
            let wanted = picture(wanted)?.in_colours_of(&known)?;
            match &job.scan {
                None => by_numbers(&image, &known.labels, &wanted, wrap, seed, reporter)?,
                Some(scan) => scanned_by_numbers(&image, &known.labels, &wanted, wrap, scan, seed, reporter)?,
            }
        }
        PixelsFrom::Hole(hole) => {
            let (name, bytes) = other(hole)?;
            let ([w, h], hole) = read_hole(&bytes, &name, &Limits::default())?;
            let [own_w, own_h] = [image.width(), image.height()];
            if [w, h] != [own_w as usize, own_h as usize] {
                let message = format!("'{name}' has {w} x {h} pixels, the photograph {own_w} x {own_h}");
                return Err(Failure::failed(message).hint("make --hole of the photograph's size").into());
            }
            filled(&image, &hole, wrap, &scan, seed, reporter)?
        }
        PixelsFrom::Border(margins) => extended(&image, *margins, wrap, &scan, seed, reporter)?,
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
