//! The command line as clap sees it: commands, options, their help. Nothing is checked here that
//! needs a file or another option; see [`super::options`].
//!
//! Options that stand in a configuration file too are `Option`s, so that one given on the command
//! line is told apart from a default. Their help names range and default, and a test compares
//! these with the parameter structs.

use super::batch_arguments::BatchArgs;
use super::edit_arguments::EditArgs;
use super::interp_arguments::InterpArgs;
use super::metrics_arguments::MetricsArgs;
use super::values::{Axes, Bytes, Factors, Name, Seed, Size, WeightsFrom, named};
use clap::builder::styling::{AnsiColor, Styles};
use clap::{Arg, Args, ColorChoice, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::PathBuf;
use vtex::library::Shading;
use vtex::scene::{Ablation, Edge, Method};

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Yellow.on_default().bold())
    .usage(AnsiColor::Yellow.on_default().bold())
    .literal(AnsiColor::Green.on_default())
    .placeholder(AnsiColor::Cyan.on_default());

const EXAMPLES: &str = "\
Examples:
  vtex texture photo.jpg -o out.svg --size 1000     photograph to vector texture, in one go
  vtex analyze photo.jpg                            photograph to photo.lib.json
  vtex synth photo.lib.json --size 1000x600         library to photo.svg

Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted.";

/// Turn a photograph of a texture into an editable vector texture of any size
#[derive(Parser)]
#[command(name = "vtex", version, styles = STYLES, max_term_width = 100, after_help = EXAMPLES)]
#[command(disable_help_subcommand = true, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    Texture(Box<TextureArgs>),
    Vectorize(VectorizeArgs),
    Analyze(AnalyzeArgs),
    Synth(SynthArgs),
    Batch(Box<BatchArgs>),
    Warp(WarpArgs),
    Edit(EditArgs),
    Tune(TuneArgs),
    Render(RenderArgs),
    Interp(InterpArgs),
    Inspect(InspectArgs),
    Metrics(MetricsArgs),
    Doctor(DoctorArgs),
    Models(ModelsArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Options of every command.
#[derive(Args)]
#[command(next_help_heading = "Global options")]
pub(crate) struct Global {
    /// Seed of all random choices [0 to 18446744073709551615, default: one chosen,
    /// printed and stored]
    #[arg(long, global = true, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) seed: Option<Seed>,
    /// Threads, of all but ONNX Runtime; results do not depend on it [1 to 1024, default: all cores]
    #[arg(
        short,
        long,
        global = true,
        value_name = "NUMBER",
        env = "VTEX_THREADS",
        hide_env_values = true,
        allow_negative_numbers = true
    )]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Print nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say more: -v seconds by stage, -vv also all parameters
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// Print a summary in JSON on stdout (on stderr if stdout carries data)
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// When to use colours; see also NO_COLOR [auto, always or never, default: auto]
    #[arg(long, global = true, value_name = "WHEN", value_enum, hide_possible_values = true)]
    pub(crate) color: Option<When>,
    /// Read parameters from a TOML file; options given here win over it
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Print all parameters as a file for --config and do nothing else
    #[arg(long, global = true)]
    pub(crate) dump_config: bool,
    /// Write a numbered PNG of every stage into a folder, made if need be
    #[arg(long, global = true, value_name = "DIR")]
    pub(crate) debug_dir: Option<PathBuf>,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum When {
    #[default]
    Auto,
    Always,
    Never,
}

impl When {
    /// As the printing macros know it.
    pub(crate) fn as_choice(self) -> anstream::ColorChoice {
        match self {
            Self::Auto => anstream::ColorChoice::Auto,
            Self::Always => anstream::ColorChoice::Always,
            Self::Never => anstream::ColorChoice::Never,
        }
    }

    /// As the argument parser knows it.
    pub(crate) fn as_clap(self) -> ColorChoice {
        match self {
            Self::Auto => ColorChoice::Auto,
            Self::Always => ColorChoice::Always,
            Self::Never => ColorChoice::Never,
        }
    }
}

/// Where results go.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ForceArgs {
    /// Replace an existing file even if vtex did not write it
    #[arg(short, long)]
    pub(crate) force: bool,
}

/// The texture as a pattern, beside the result.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct PatternArgs {
    /// Also write an SVG of any size, filled with the texture as a <pattern>: .svg or .svgz; the
    /// texture must repeat along both axes (--tile)
    #[arg(long, value_name = "FILE")]
    pub(crate) pattern: Option<PathBuf>,
}

/// Photograph to vector texture, in one go
#[derive(Args)]
#[command(
    override_usage = "vtex texture [OPTIONS] <PHOTO>",
    after_help = "\
Examples:
  vtex texture photo.jpg -o out.svg --size 1000
  vtex texture photo.jpg -o - --size 400x300 --seed 7 > out.svg"
)]
pub(crate) struct TextureArgs {
    /// The photograph: PNG, JPEG, TIFF, WebP, BMP, GIF or PNM; - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout
    /// [default: ./PHOTO.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) pattern: PatternArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) synth: SynthFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

/// The photograph itself, drawn in vectors
#[derive(Args)]
#[command(
    override_usage = "vtex vectorize [OPTIONS] <PHOTO>",
    after_help = "\
Examples:
  vtex vectorize photo.jpg
  vtex vectorize photo.jpg --fidelity 0.25 -o fine.svg
  vtex vectorize photo.jpg --colors 12 --max-paths 2000 -o poster.svg"
)]
pub(crate) struct VectorizeArgs {
    /// The photograph: PNG, JPEG, TIFF, WebP, BMP, GIF or PNM; - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result, by extension .svg, .svgz, .png, .scene.json or .scene.json.gz; - writes SVG to stdout
    /// [default: ./PHOTO.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

/// Photograph to texton library
#[derive(Args)]
#[command(
    override_usage = "vtex analyze [OPTIONS] <PHOTO>",
    after_help = "\
Examples:
  vtex analyze photo.jpg
  vtex analyze photo.jpg -o photo.lib.json.gz --save-masks photo.masks.png
  vtex analyze photo.jpg --masks corrected.png --debug-dir stages"
)]
pub(crate) struct AnalyzeArgs {
    /// The photograph: PNG, JPEG, TIFF, WebP, BMP, GIF or PNM; - reads stdin
    #[arg(value_name = "PHOTO", required = true)]
    pub(crate) photo: Option<PathBuf>,
    /// Result, .lib.json or .lib.json.gz; - writes JSON to stdout [default: ./PHOTO.lib.json]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) masks: MasksArgs,
    #[command(flatten)]
    pub(crate) analyze: AnalyzeFlags,
}

/// Texton library to vector texture
#[derive(Args)]
#[command(
    override_usage = "vtex synth [OPTIONS] <LIBRARY>...",
    after_help = "\
Examples:
  vtex synth photo.lib.json --size 1000x600 --seed 7
  vtex synth photo.lib.json --domain logo.svg --density dense-left.png
  vtex synth sand.lib.json stones.lib.json --map where-stones.png
  vtex synth photo.lib.json -o out.scene.json.gz
  vtex synth photo.lib.json --tile --pattern page.svg
  vtex synth photo.lib.json -o - | gzip > out.svgz"
)]
pub(crate) struct SynthArgs {
    /// The library, plain or gzip; - reads stdin. Several, at most 16, share the canvas by --map
    #[arg(value_name = "LIBRARY", required = true)]
    pub(crate) library: Vec<PathBuf>,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout
    /// [default: ./LIBRARY.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) pattern: PatternArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
    #[command(flatten)]
    pub(crate) synth: SynthFlags,
    #[command(flatten)]
    pub(crate) background: SynthBackgroundFlags,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    /// Which library is where, for several: one grey picture for two (black the first, white the
    /// second), one with a colour for each (in the order of its palette, or from dark to light), or a
    /// grey one for each (white all, black nothing), given one after the other
    #[arg(long, value_name = "FILE", help_heading = "Control (pictures are stretched over the canvas)")]
    pub(crate) map: Vec<PathBuf>,
}

/// Files that steer synthesis.
#[derive(Args)]
#[command(next_help_heading = "Control (pictures are stretched over the canvas)")]
pub(crate) struct ControlArgs {
    /// Fill a shape: an SVG with one closed path, fitted to the canvas as a whole
    #[arg(long, value_name = "FILE", conflicts_with = "mask")]
    pub(crate) domain: Option<PathBuf>,
    /// Fill what is white in a picture, or opaque where it is partly transparent
    #[arg(long, value_name = "FILE")]
    pub(crate) mask: Option<PathBuf>,
    /// Density relative to the photograph's: a grey picture, black 0, middle grey 1, white 2
    #[arg(long, value_name = "FILE")]
    pub(crate) density: Option<PathBuf>,
}

/// Bend or stretch a scene; elements keep their size and density
#[derive(Args)]
#[command(
    override_usage = "vtex warp [OPTIONS] <SCENE> <LIBRARY>...",
    after_help = "\
Examples:
  vtex warp wide.scene.json photo.lib.json --scale 1.5x1 -o wider.svg
  vtex warp square.scene.json photo.lib.json --cage square.svg --to disc.svg -o bent.svg

Elements move, gaps are filled with new ones, and where they crowd some go. New ones are drawn by
the scene's seed, unless --seed gives another."
)]
pub(crate) struct WarpArgs {
    /// The scene, plain or gzip; - reads stdin
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) scene: Option<PathBuf>,
    /// The libraries that it was made from, plain or gzip; - reads stdin
    #[arg(value_name = "LIBRARY", required = true)]
    pub(crate) library: Vec<PathBuf>,
    /// The cage before: an SVG with one closed path, drawn over the scene, an SVG's pixel for a pixel
    #[arg(long, value_name = "FILE", requires = "to", conflicts_with = "scale")]
    pub(crate) cage: Option<PathBuf>,
    /// The cage after: a copy whose points have been moved; its page is the new canvas
    #[arg(long, value_name = "FILE", requires = "cage")]
    pub(crate) to: Option<PathBuf>,
    /// Stretch the canvas: 1.5 or 1.5x2 [0.1 to 10 each]
    #[arg(long, value_name = "FACTOR")]
    pub(crate) scale: Option<Factors>,
    /// At the edge of the new shape keep elements whole, clip them, or avoid it [keep, clip or avoid,
    /// default: as in the scene]
    #[arg(long, value_name = "HOW", value_parser = named::<Edge>)]
    pub(crate) edge: Option<Edge>,
    /// Result, by extension .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz; - writes SVG to
    /// stdout
    /// [default: ./SCENE.svg]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// Search weights of the score that suit a library
#[derive(Args)]
#[command(
    override_usage = "vtex tune [OPTIONS] <LIBRARY>",
    after_help = "\
Examples:
  vtex tune photo.lib.json
  vtex tune photo.lib.json --name thorough --seeds 10 --evaluations 2000 --seed 7

Weights are written beside the library, as photo.tuned.weights.json. Nothing uses them unless
asked to: vtex synth photo.lib.json --weights tuned"
)]
pub(crate) struct TuneArgs {
    /// The library, plain or gzip
    #[arg(value_name = "LIBRARY", required = true)]
    pub(crate) library: Option<PathBuf>,
    /// Name of the weights: letters, digits, - and _ [default: tuned]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<Name>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) search: TuneFlags,
}

/// How weights are searched.
#[derive(Args)]
#[command(next_help_heading = "Search")]
pub(crate) struct TuneFlags {
    /// Canvases placed for each set of weights [1 to 100, default: 3]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) seeds: Option<u32>,
    /// Sets of weights tried [10 to 100000, default: 200]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) evaluations: Option<u32>,
    /// Canvas, px: 1000 or 1000x600 [1 to 100000 each, at most 400 megapixels, default: 500]
    #[arg(long, value_name = "SIZE")]
    pub(crate) size: Option<Size>,
}

/// Library (drawn back as its exemplar), scene or SVG to picture
#[derive(Args)]
#[command(
    override_usage = "vtex render [OPTIONS] <FILE>",
    after_help = "\
Examples:
  vtex render photo.lib.json -o reconstruction.png
  vtex render out.svg -o out.png --scale 2
  vtex render out.scene.json -o out.svg"
)]
pub(crate) struct RenderArgs {
    /// A library, scene or SVG, plain or gzip; - reads stdin
    #[arg(value_name = "FILE", required = true)]
    pub(crate) file: Option<PathBuf>,
    /// Result, .png; of a library or scene also .svg, .svgz, .pdf, .scene.json or .scene.json.gz;
    /// - writes PNG to stdout [default: ./FILE.png]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    #[command(flatten)]
    pub(crate) pattern: PatternArgs,
    #[command(flatten)]
    pub(crate) render: RenderFlags,
    #[command(flatten)]
    pub(crate) svg: SvgFlags,
}

/// Say what a library or a scene holds, or write a page to look at
#[derive(Args)]
#[command(
    override_usage = "vtex inspect [OPTIONS] <FILE>...",
    after_help = "\
Examples:
  vtex inspect photo.lib.json
  vtex inspect out.scene.json --json | jq .counts
  vtex inspect photo.lib.json out.scene.json -o report.html --exemplar photo.jpg"
)]
pub(crate) struct InspectArgs {
    /// A library or scene, plain or gzip; - reads stdin. For a page also a scene and the libraries
    /// that it was made from
    #[arg(value_name = "FILE", required = true)]
    pub(crate) file: Vec<PathBuf>,
    /// Write a page for a browser, .html: pictures with layers and a slider, categories,
    /// distributions; - writes it to stdout [default: none, what the file holds is printed]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) force: ForceArgs,
    /// The photograph, shown on the page if its SHA-256 is that of the exemplar; may be given several
    /// times [default: the file of that name beside the library]
    #[arg(long, value_name = "PHOTO", requires = "output", help_heading = "Output")]
    pub(crate) exemplar: Vec<PathBuf>,
}

/// Say what networks run on, which models there are, and what is missing
#[derive(Args)]
#[command(after_help = "\
Examples:
  vtex doctor
  vtex doctor --onnxruntime /opt/onnxruntime/lib/libonnxruntime.so --json")]
pub(crate) struct DoctorArgs {
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

/// Keep models of Segment Anything for --segmenter sam
#[derive(Args)]
#[command(
    subcommand_required = true,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_help = "\
Examples:
  vtex models add encoder.onnx decoder.onnx --name mobile-sam
  vtex models list
  vtex models verify
  vtex models remove mobile-sam

Models are kept in vtex/models in the user's folder for data, or in the folder that VTEX_MODELS
names. Nothing is ever downloaded."
)]
pub(crate) struct ModelsArgs {
    #[command(subcommand)]
    pub(crate) action: ModelsAction,
}

#[derive(Subcommand)]
pub(crate) enum ModelsAction {
    /// Copy the files of a model: encoder and decoder, or one file that holds both
    #[command(after_help = "Examples:\n  vtex models add encoder.onnx decoder.onnx --name mobile-sam")]
    Add(ModelsAddArgs),
    /// Name all models, with their files
    List,
    /// Compare all files with what they were when they were added
    Verify,
    /// Delete a model
    Remove {
        /// Its name
        #[arg(value_name = "NAME")]
        name: Name,
    },
}

/// What a model is made of.
#[derive(Args)]
pub(crate) struct ModelsAddArgs {
    /// The ONNX files, in any order, and those with their weights if these are apart
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Name of the model: letters, digits, - and _
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Name,
    /// Replace a model of that name
    #[arg(short, long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

/// What networks run on.
#[derive(Args)]
#[command(next_help_heading = "Networks")]
pub(crate) struct EngineArgs {
    /// What runs networks: ONNX Runtime where it is found, or rten, which is part of vtex [auto,
    /// onnxruntime or rten, default: auto]
    #[arg(long, value_name = "NAME", value_enum, hide_possible_values = true)]
    pub(crate) engine: Option<EngineName>,
    /// ONNX Runtime's shared library [default: $VTEX_ONNXRUNTIME or $ORT_DYLIB_PATH, else the first
    /// found; see 'vtex doctor']
    #[arg(long, value_name = "FILE")]
    pub(crate) onnxruntime: Option<PathBuf>,
}

/// What runs networks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum EngineName {
    #[default]
    Auto,
    #[value(name = "onnxruntime")]
    OnnxRuntime,
    Rten,
}

/// Which network of Segment Anything.
#[derive(Args)]
#[command(next_help_heading = "Networks")]
pub(crate) struct SamArgs {
    /// Name of a model for --segmenter sam [default: the one there is; see 'vtex models']
    #[arg(long, value_name = "NAME")]
    pub(crate) model: Option<Name>,
    /// ONNX file of an image encoder for --segmenter sam, or one that decodes too
    #[arg(long, value_name = "FILE", conflicts_with = "model")]
    pub(crate) encoder: Option<PathBuf>,
    /// ONNX file of the prompt decoder that goes with it
    #[arg(long, value_name = "FILE", requires = "encoder")]
    pub(crate) decoder: Option<PathBuf>,
}

/// Print completions for a shell
#[derive(Args)]
#[command(after_help = "\
Examples:
  vtex completions bash > ~/.local/share/bash-completion/completions/vtex
  vtex completions zsh > ~/.zfunc/_vtex
  vtex completions fish > ~/.config/fish/completions/vtex.fish")]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

/// Write the man pages into a folder
#[derive(Args)]
#[command(after_help = "\
Examples:
  vtex man ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// The folder, made if need be
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

/// How masks are found.
#[derive(Args)]
#[command(next_help_heading = "Segmentation")]
pub(crate) struct MasksArgs {
    /// Use the masks of a file: a label PNG (8 or 16 bits, 0 is ground) or vtex's own JSON
    #[arg(long, value_name = "FILE", conflicts_with = "segmenter")]
    pub(crate) masks: Option<PathBuf>,
    /// Save the masks found: .masks.json, .masks.json.gz (exact) or .png (labels)
    #[arg(long, value_name = "FILE")]
    pub(crate) save_masks: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) sam: SamArgs,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

/// What finds the masks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SegmenterName {
    #[default]
    Auto,
    Texton,
    Regions,
    Felzenszwalb,
    Sam,
}

/// Section `[analyze]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Analysis (lengths in pixels of the photograph)")]
pub(crate) struct AnalyzeFlags {
    /// What finds the textons: auto is sam if a model was added, else texton [auto, texton, regions,
    /// felzenszwalb or sam, default: auto]
    #[arg(long, value_name = "NAME", value_enum, hide_possible_values = true, help_heading = "Segmentation")]
    pub(crate) segmenter: Option<SegmenterName>,
    /// Smallest primary texton, px of area [1 to 1000000, default: 5]
    #[arg(long, visible_alias = "min-area", value_name = "PX", allow_negative_numbers = true)]
    pub(crate) minimum_area: Option<u32>,
    /// Scale of details: larger means fewer [0 to 10000, default: 10]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) detail_scale: Option<f64>,
    /// Smoothing before details are sought, px [0 to 10, default: 0.7]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) detail_sigma: Option<f64>,
    /// Smallest detail, px of area [1 to 10000, default: 3]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) detail_minimum: Option<u32>,
    /// Colour difference within a secondary texton, a share [0 to 1, default: 0.055]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    pub(crate) secondary_tolerance: Option<f64>,
    /// Smallest secondary texton, px of area [1 to 10000, default: 3]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) secondary_minimum: Option<u32>,
    /// Largest secondary texton, px of area [1 to 100000, default: 300]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) secondary_maximum: Option<u32>,
    /// Categories of primary textons [1 to 1000, default: 15]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) categories: Option<u32>,
    /// How far a texton sees, in mean distances between textons [0.5 to 10,
    /// default: 2.25]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) descriptor_reach: Option<f64>,
    /// Distance between background colours, px [4 to 1000, default: 25]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) background_spacing: Option<f64>,
    /// Strip around textons that is not background, px [0 to 100,
    /// default: 5]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) background_margin: Option<f64>,
    /// Distance of smooth outlines from the photograph's, px; larger also means fewer shapes [0.05
    /// to 5, default: 0.5]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) fidelity: Option<f64>,
    /// Fill elements with one colour each, or with gradients where these tell more [flat or gradient,
    /// default: gradient]
    #[arg(long, value_name = "HOW", value_parser = named::<Shading>)]
    pub(crate) shading: Option<Shading>,
    /// Most colours, all flat; 0: as many as there are [0 to 4096, default: 0]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) colors: Option<u32>,
    /// Most elements and details together; 0: as many as there are [0 to 10000000, default: 0]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) max_paths: Option<u32>,
    /// Cells along each side of a pixel, on which small shapes are told apart; 0: as fits the
    /// photograph [0 to 4, default: 0]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) cells: Option<u32>,
    /// The photograph tiles: opposite borders join [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) wrap: Option<bool>,
}

/// Section `[synth]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Synthesis (lengths in pixels of the canvas)")]
pub(crate) struct SynthFlags {
    /// Canvas, px: 1000 or 1000x600 [1 to 100000 each, at most 400 megapixels, default: 1000]
    #[arg(long, value_name = "SIZE")]
    pub(crate) size: Option<Size>,
    /// How elements are placed: carried from the exemplar along a field of correspondences, which keeps
    /// structure larger than a few elements; one by one by the descriptors of their neighbours; or as
    /// the library allows [auto, correspondence or descriptor, default: auto]
    #[arg(long, value_name = "METHOD", value_parser = named::<Method>)]
    pub(crate) method: Option<Method>,
    /// Textons tried for each place, by descriptors [1 to 1000, default: 20]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) candidates: Option<u32>,
    /// Moves by one cell that may better a placement [0 to 100, default: 5]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) moves: Option<u32>,
    /// Weights of target, uncovered, empty, mismatched and same-overlap areas in the score of a
    /// placement, or the name of weights found by 'vtex tune' [-10 to 10 each,
    /// default: 0.5,-0.4,-0.2,-0.5,-0.5]
    #[arg(long, value_name = "T,U,E,M,S|NAME", allow_hyphen_values = true)]
    pub(crate) weights: Option<WeightsFrom>,
    /// Make it repeat without a seam, along x, y or both axes [none, both, x or y; alone: both;
    /// default: none]
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    pub(crate) tile: Option<Axes>,
    /// Turn each texton by a random angle, at most this many degrees either way [0 to 180, default: 0]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) rotate: Option<f64>,
    /// Mirror half of the textons [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) mirror: Option<bool>,
    /// Change each texton's size at random, at most this many per cent either way [0 to 50, default: 0]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) scale_jitter: Option<f64>,
    /// At the edge of a domain keep textons whole, clip them, or avoid it [keep, clip or avoid,
    /// default: clip]
    #[arg(long, value_name = "HOW", value_parser = named::<Edge>)]
    pub(crate) edge: Option<Edge>,
    /// Leave parts of the method out, to see what they do: secondary, overlap, density, decay,
    /// improve, growth, removal, copies, seeds, neighbourhoods [default: none]
    #[arg(long, value_name = "PART,...", value_parser = named::<Ablation>, value_delimiter = ',')]
    pub(crate) ablate: Option<Vec<Ablation>>,
}

/// Also of section `[synth]`; `texture` has the option from the analysis.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Synthesis (lengths in pixels of the canvas)")]
pub(crate) struct SynthBackgroundFlags {
    /// Distance between background colours, px [4 to 1000, default: as
    /// in the library]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub(crate) background_spacing: Option<f64>,
}

/// Section `[svg]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct SvgFlags {
    /// Decimals of numbers in an SVG [0 to 6, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) precision: Option<u8>,
    /// Write textons in full, not as <symbol> and <use> [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(hide_possible_values = true)]
    pub(crate) expand: Option<bool>,
    /// Most bytes of an SVG, as 5MB, 800kB or a number: gives up decimals, then fineness of outlines,
    /// then what is seen least [1 to 1000000000000, default: no limit]
    #[arg(long, value_name = "SIZE", allow_negative_numbers = true)]
    pub(crate) max_bytes: Option<Bytes>,
}

/// Section `[render]`.
#[derive(Args, Serialize)]
#[command(next_help_heading = "Output")]
pub(crate) struct RenderFlags {
    /// Pixels of a PNG for each pixel of the canvas [0.01 to 100, default: 1]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(crate) scale: Option<f64>,
}

/// The whole command, from which parser, completions and man pages are made.
pub(crate) fn command() -> clap::Command {
    const WORK: [&str; 2] = ["seed", "debug_dir"];
    const PARAMETERS: [&str; 3] = ["threads", "config", "dump_config"];
    const TELLING: [&str; 3] = ["quiet", "verbose", "json"];
    let command = Cli::command();
    let global: Vec<Arg> = command.get_arguments().cloned().collect();
    // Every command takes the options of all, but does not show those that mean nothing to it.
    let hide = |command: clap::Command, name: &str, hidden: &[&str]| {
        let args = global.iter().filter(|a| hidden.contains(&a.get_id().as_str()));
        let args: Vec<Arg> = args.map(|a| a.clone().hide(true)).collect();
        command.mut_subcommand(name, |sub| sub.args(args))
    };
    let command = hide(command, "tune", &WORK[1..]);
    let command = hide(command, "edit", &WORK[1..]);
    let command = hide(command, "render", &WORK);
    let command = hide(command, "metrics", &[&WORK[..], &PARAMETERS[1..]].concat());
    let command = hide(command, "inspect", &[&WORK[..], &PARAMETERS].concat());
    let command = hide(command, "interp", &WORK);
    let command = hide(command, "doctor", &[&WORK[..], &PARAMETERS[1..], &TELLING[..2]].concat());
    let command = hide(command, "models", &[&WORK[..], &PARAMETERS, &TELLING[..2]].concat());
    let all = [&WORK[..], &PARAMETERS, &TELLING, &["color"]].concat();
    hide(hide(command, "completions", &all), "man", &all)
}

/// [`command`], in which nothing else is needed beside `--dump-config`.
pub(crate) fn command_for(arguments: &[OsString]) -> clap::Command {
    let mut command = command();
    if arguments.iter().any(|a| a == "--dump-config") {
        command = command.subcommand_required(false);
        for (name, argument) in [
            ("texture", "photo"),
            ("vectorize", "photo"),
            ("analyze", "photo"),
            ("synth", "library"),
            ("batch", "input"),
            ("batch", "out_dir"),
            ("warp", "scene"),
            ("warp", "library"),
            ("tune", "library"),
            ("render", "file"),
            ("interp", "from"),
            ("interp", "to"),
            ("inspect", "file"),
        ] {
            command = command.mut_subcommand(name, |c| c.mut_arg(argument, |a| a.required(false)));
        }
    }
    command
}
