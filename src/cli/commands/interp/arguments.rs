//! The arguments of `vtex interp`, checked.

use crate::cli::config::Parameters;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::input::Input;
use crate::cli::options::files::{ForceArgs, Makes, apart, check_files, outputs, required, targets};
use crate::cli::options::frames::{FrameFormat, Played, formats, played, rate};
use crate::cli::options::render::{RenderFlags, RenderParameters};
use crate::cli::options::svg::{SvgFlags, SvgParameters};
use crate::cli::output::Targets;
use crate::cli::values::{between, named, one_of};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use std::ffi::OsString;
use std::path::PathBuf;
use vtex::output::file::Format;
use vtex::scene::Axis;

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "between" };

/// One scene into another: frames, an animation, or one between
#[derive(Args)]
#[command(
    override_usage = "vtex interp [OPTIONS] <FROM> <TO>",
    after_help = "\
Examples:
  vtex interp a.scene.json b.scene.json -o animation.gif --frames 30 --back
  vtex interp a.scene.json b.scene.json -o animation.svg --frames 60
  vtex interp a.scene.json b.scene.json -o frames --format png --scale 2
  vtex interp a.scene.json b.scene.json -o half.svg --at 0.5
  vtex interp a.scene.json b.scene.json -o blend.svg --across x
  vtex interp a.scene.json b.scene.json -o island.svg --morph radial

Both scenes must be of one size. An animated SVG moves in browsers and shows the first scene
elsewhere."
)]
pub(crate) struct InterpArgs {
    /// The scene to begin with, plain or gzip; - reads stdin
    #[arg(value_name = "FROM", required = true)]
    pub(super) from: Option<PathBuf>,
    /// The scene to end with, plain or gzip; - reads stdin
    #[arg(value_name = "TO", required = true)]
    pub(super) to: Option<PathBuf>,
    /// Result, by extension an animation .svg, .svgz, .gif, .png or .apng, or a folder for frames;
    /// with --at, --across or --morph .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; several -o write
    /// several files [default with these: ./FROM.between.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(super) output: Vec<PathBuf>,
    /// Pictures, first and last included [2 to 10000, default: 30]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=10000))]
    pub(super) frames: Option<u32>,
    /// Pictures in a second of an animation [0.1 to 100, default: 15]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = rate)]
    pub(super) fps: Option<f64>,
    /// Play there and back, so that the animation has no jump
    #[arg(long)]
    pub(super) back: bool,
    /// Frames in a folder are [svg or png, default: svg]
    #[arg(long, value_name = "FORMAT", hide_possible_values = true)]
    #[arg(value_parser = formats())]
    pub(super) format: Option<FrameFormat>,
    /// One scene only, so far along the way [0 to 1]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, value_parser = between(0.0, 1.0))]
    #[arg(conflicts_with_all = ["across", "morph", "frames", "fps", "back", "format"])]
    pub(super) at: Option<f64>,
    /// One scene only, that turns into the other from left to right or from top to bottom [x or y]
    #[arg(long, value_name = "AXIS", value_parser = one_of(&["x", "y"], named::<Axis>), hide_possible_values = true)]
    #[arg(conflicts_with_all = ["frames", "fps", "back", "format"])]
    pub(super) across: Option<Axis>,
    /// One scene only, that turns into the other over the canvas: as with --across, or from the middle to
    /// the sides, or by a grey picture, black the first and white the second [x, y, radial or a file]
    #[arg(long, value_name = "WHERE", value_parser = OsStringValueParser::new().map(where_it_turns))]
    #[arg(conflicts_with_all = ["across", "frames", "fps", "back", "format"])]
    pub(super) morph: Option<MorphFrom>,
    #[command(flatten)]
    pub(super) force: ForceArgs,
    #[command(flatten)]
    pub(super) render: RenderFlags,
    #[command(flatten)]
    pub(super) svg: SvgFlags,
}

/// How a scene turns into another over the canvas.
#[derive(Clone, Debug)]
pub(super) enum MorphFrom {
    Axis(Axis),
    Radial,
    /// By a map in a file.
    Map(Input),
}

fn where_it_turns(text: OsString) -> MorphFrom {
    match text.to_str() {
        Some("x") => MorphFrom::Axis(Axis::X),
        Some("y") => MorphFrom::Axis(Axis::Y),
        Some("radial") => MorphFrom::Radial,
        _ => MorphFrom::Map(Input::new(text.into())),
    }
}

/// The two scenes, and the requested results.
pub(super) struct Interpolating {
    pub(super) from: Input,
    pub(super) to: Input,
    /// At least one.
    pub(super) wanted: Vec<InterpResult>,
    pub(super) scale: RenderParameters,
    pub(super) svg: SvgParameters,
}

/// One scene between two.
pub(super) enum One {
    /// One time, 0 to 1.
    At(f64),
    /// A time that varies over the canvas.
    Morph(MorphFrom),
}

/// The result wanted from two scenes.
pub(super) enum InterpResult {
    /// One scene.
    Scene(One, Targets),
    /// Frames in a folder, or one file that plays.
    Played(Played, Pace),
}

impl InterpResult {
    /// Whether its frames are pictures of pixels.
    pub(super) fn drawn(&self) -> bool {
        match self {
            Self::Scene(_, targets) => targets.has(Format::Png),
            Self::Played(played, _) => played.drawn(),
        }
    }
}

/// The number of frames and their rate.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    /// From the first scene to the second, both included.
    pub(super) frames: u32,
    pub(super) rate: f64,
    pub(super) back: bool,
}

impl Pace {
    /// Number of frames played, those on the way back included; the first is played once.
    pub(super) fn played(&self) -> u32 {
        if self.back { 2 * self.frames - 2 } else { self.frames }
    }

    /// Time of frame `k` of those played, 0 to 1.
    pub(super) fn share(&self, k: u32) -> f64 {
        let last = self.frames - 1;
        f64::from(if k > last { 2 * last - k } else { k }) / f64::from(last)
    }
}

impl Interpolating {
    /// Checks the options.
    pub(super) fn new(a: InterpArgs, parameters: &Parameters) -> Result<Self, Failure> {
        let (from, to) = (required(a.from)?, required(a.to)?);
        let mut read = vec![("the first scene", &from), ("the second scene", &to)];
        if let Some(MorphFrom::Map(map)) = &a.morph {
            read.push(("--morph", map));
        }
        check_files(&read, &outputs(&a.output))?;
        let morph = a.morph.or(a.across.map(MorphFrom::Axis)).map(One::Morph);
        let between = a.at.map(One::At).or(morph);
        let wanted = if let Some(between) = between {
            vec![InterpResult::Scene(between, targets(a.output, &a.force, &from, MAKES)?)]
        } else {
            let pace = Pace { frames: a.frames.unwrap_or(30), rate: a.fps.unwrap_or(15.0), back: a.back };
            if a.output.is_empty() {
                return Err(Failure::usage("nothing says where the animation goes")
                    .hint("give -o animation.svg, animation.gif or animation.png, or a folder for frames"));
            }
            apart(&outputs(&a.output))?;
            let play = |path| {
                let played = played(path, a.format, a.force.force, "give --at, --across or --morph")?;
                Ok(InterpResult::Played(played, pace))
            };
            a.output.into_iter().map(play).collect::<Result<_, Failure>>()?
        };
        Ok(Self { from, to, wanted, scale: parameters.render, svg: parameters.svg })
    }
}
