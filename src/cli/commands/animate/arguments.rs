//! The arguments of `vtex animate`.

use crate::cli::failure::Failure;
use crate::cli::format::{self, Lists};
use crate::cli::input::Input;
use crate::cli::number::Takes;
use crate::cli::options::files::{ForceArgs, check_distinct, outputs};
use crate::cli::options::frames::{FRAMES, FrameFormat, Played, formats, played};
use crate::cli::options::render::RenderFlags;
use crate::cli::options::svg::SvgFlags;
use crate::cli::values::{named, one_of};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use std::ffi::OsString;
use std::path::PathBuf;
use vtex::Parameter;
use vtex::flow::{Flow, FlowParams};
use vtex::output::raster_animation::RasterAnimation;
use vtex::scene::Axis;

/// Pictures of a loop, unless they are given.
pub(super) const FRAMES_OF_LOOP: u32 = 60;

/// Pictures from one scene to the other, unless they are given.
pub(super) const FRAMES_OF_WAY: u32 = 30;

/// Share of the way.
const AT: Parameter<f64> = Parameter::new("at", [0.0, 1.0], "");

/// Animate a scene with a flow, or turn it into another scene
#[derive(Args)]
#[command(
    override_usage = "vtex animate [OPTIONS] <SCENE> --output <FILE>\n       vtex animate [OPTIONS] <SCENE> <TO> --output <FILE>",
    after_long_help = "\
Examples:
  vtex animate grass.scene.json --flow wind -o grass.gif
  vtex animate pebbles.scene.json --flow vortex --frames 90 -o turning.svg
  vtex animate leaves.scene.json --flow directions.png -o frames --format png
  vtex animate a.scene.json b.scene.json -o animation.gif --frames 30 --back
  vtex animate a.scene.json b.scene.json -o half.svg --at 0.5
  vtex animate a.scene.json b.scene.json -o island.svg --morph radial

In a flow, elements that leave at one border enter at the opposite one. So use
scenes that repeat ('vtex synth --tile'). Two scenes must have the same size.
An animated SVG plays in browsers. Elsewhere it shows the scene at rest, or the
first scene."
)]
pub(crate) struct AnimateArgs {
    /// The scene, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) scene: Option<PathBuf>,
    /// The scene to turn into, plain or gzip; - reads stdin
    #[arg(value_name = "TO", conflicts_with_all = ["flow", "rounds", "strength"])]
    pub(crate) to: Option<PathBuf>,
    /// Motion: shear (upper third to the left, lower third to the right), vortex (all about the middle), wind
    /// (gusts), or a grey picture of directions: black right, dark grey down, middle grey left, light grey up
    /// [shear, vortex, wind or a file, default: wind]
    #[arg(long, value_name = "FLOW", value_parser = OsStringValueParser::new().map(flow))]
    pub(crate) flow: Option<FlowFrom>,
    /// Number of frames in a loop, or from one scene to the other, including both
    #[arg(long, number_or(FRAMES, format_args!("{FRAMES_OF_LOOP}; of two scenes {FRAMES_OF_WAY}")))]
    pub(crate) frames: Option<u32>,
    /// Frames per second
    #[arg(long, number = RasterAnimation::RATE, default_value_t = RasterAnimation::RATE.default())]
    #[arg(hide_short_help = true)]
    pub(crate) fps: f64,
    /// Number of rounds, or of gusts, in a loop
    #[arg(long, number = FlowParams::ROUNDS, default_value_t = FlowParams::ROUNDS.default())]
    #[arg(hide_short_help = true)]
    pub(crate) rounds: u32,
    /// Factor for the distance that wind and directions move elements
    #[arg(long, number = FlowParams::STRENGTH, default_value_t = FlowParams::STRENGTH.default())]
    #[arg(hide_short_help = true)]
    pub(crate) strength: f64,
    /// Play forwards and backwards, so that the animation of two scenes has no jump
    #[arg(long, requires = "to")]
    pub(crate) back: bool,
    /// Write one scene, at this point between the two; 0.5 is half-way
    #[arg(long, number = AT, value_name = "SHARE")]
    #[arg(requires = "to", conflicts_with_all = ["across", "morph", "frames", "fps", "back", "format"])]
    pub(crate) at: Option<f64>,
    /// Write one scene that turns into the other from left to right or from top to bottom [x or y]
    #[arg(long, value_name = "AXIS", value_parser = one_of(&["x", "y"], named::<Axis>), hide_possible_values = true)]
    #[arg(requires = "to", conflicts_with_all = ["frames", "fps", "back", "format"], hide_short_help = true)]
    pub(crate) across: Option<Axis>,
    /// Write one scene that turns into the other: along an axis as with --across, from the middle to the
    /// sides, or by a grey picture (black: first scene, white: second) [x, y, radial or a file]
    #[arg(long, value_name = "WHERE", value_parser = OsStringValueParser::new().map(where_it_turns))]
    #[arg(requires = "to", conflicts_with_all = ["across", "frames", "fps", "back", "format"])]
    pub(crate) morph: Option<MorphFrom>,
    /// Result: an animation .svg, .svgz, .gif, .png or .apng, or a folder for frames
    ///
    /// With --at, --across or --morph, the result is one scene: {formats} [default:
    /// ./SCENE.between.svg]. Several -o write several files
    #[arg(short, long, value_name = "FILE", lists = format::OF_SCENE)]
    pub(crate) output: Vec<PathBuf>,
    /// Format of frames in a folder [svg or png, default: svg]
    #[arg(long, value_name = "FORMAT", hide_possible_values = true, value_parser = formats(), hide_short_help = true)]
    pub(crate) format: Option<FrameFormat>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// A flow, or the file of its directions.
#[derive(Clone, Debug)]
pub(crate) enum FlowFrom {
    Known(Flow),
    File(Input),
}

fn flow(text: OsString) -> FlowFrom {
    match text.to_str() {
        Some("shear") => FlowFrom::Known(Flow::Shear),
        Some("vortex") => FlowFrom::Known(Flow::Vortex),
        Some("wind") => FlowFrom::Known(Flow::Wind),
        _ => FlowFrom::File(Input::new(text.into())),
    }
}

/// Where a scene turns into another.
#[derive(Clone, Debug)]
pub(crate) enum MorphFrom {
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

impl AnimateArgs {
    /// The outputs of an animation, at least one.
    pub(super) fn played(self, otherwise: &str) -> Result<Vec<Played>, Failure> {
        if self.output.is_empty() {
            return Err(Failure::usage("nothing says where the animation goes")
                .hint("give -o animation.svg, .gif or .png, or a folder for frames"));
        }
        check_distinct(&outputs(&self.output))?;
        let one = |path| played(path, self.format, self.force.force, otherwise);
        self.output.into_iter().map(one).collect()
    }
}
