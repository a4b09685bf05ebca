//! The source of masks.

use super::analyze::SegmenterName;
use super::engine::EngineArgs;
use crate::cli::failure::Failure;
use crate::cli::values::Name;
use clap::Args;
use std::path::PathBuf;

/// How masks are found.
#[derive(Args)]
#[command(next_help_heading = "Segmentation")]
pub(crate) struct MasksArgs {
    /// Use masks from a file: a label PNG (8 or 16 bits, 0 is background), or vtex's own JSON with its
    /// categories
    #[arg(long, value_name = "FILE", conflicts_with = "segmenter")]
    pub(crate) masks: Option<PathBuf>,
    /// Save the masks that vtex found: .masks.json, .masks.json.gz (exact) or .png (labels)
    #[arg(long, value_name = "FILE")]
    pub(crate) save_masks: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) sam: SamArgs,
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

/// Which network of Segment Anything.
#[derive(Args)]
#[command(next_help_heading = "Networks")]
pub(crate) struct SamArgs {
    /// Name of a model for --segmenter sam [default: the one there is; see 'vtex models']
    #[arg(long, value_name = "NAME")]
    pub(crate) model: Option<Name>,
    /// ONNX file of the image encoder for --segmenter sam, or of encoder and decoder in one
    #[arg(long, value_name = "FILE", conflicts_with = "model")]
    pub(crate) encoder: Option<PathBuf>,
    /// ONNX file of the prompt decoder that belongs to the encoder
    #[arg(long, value_name = "FILE", requires = "encoder")]
    pub(crate) decoder: Option<PathBuf>,
}

/// The source of masks.
#[derive(Clone, Debug)]
pub(crate) enum MasksFrom {
    /// Segment Anything if there is a model, else the texton network.
    Auto,
    Texton,
    Regions,
    /// As `Regions`, but with a single tree: [`Auto`](Self::Auto) of `vectorize`.
    OneTree,
    Felzenszwalb,
    Sam(SamFrom),
    File(PathBuf),
}

/// The source of a network of Segment Anything.
#[derive(Clone, Debug)]
pub(crate) enum SamFrom {
    /// A model that was added, or the only one.
    Model(Option<Name>),
    Files(Vec<PathBuf>),
}

impl SamFrom {
    /// The source that the options name, if any.
    pub(crate) fn new(args: SamArgs) -> Option<Self> {
        let files: Vec<PathBuf> = args.encoder.into_iter().chain(args.decoder).collect();
        if files.is_empty() {
            args.model.map(|name| Self::Model(Some(name)))
        } else {
            Some(Self::Files(files))
        }
    }
}

/// The source of masks: a file, or a segmenter.
pub(crate) fn masks_from(
    file: Option<PathBuf>,
    segmenter: SegmenterName,
    sam: Option<SamFrom>,
) -> Result<MasksFrom, Failure> {
    Ok(match (file, segmenter, sam) {
        (None, SegmenterName::Sam, sam) => MasksFrom::Sam(sam.unwrap_or(SamFrom::Model(None))),
        (_, _, Some(_)) => {
            let message = "--model, --encoder and --decoder are for --segmenter sam";
            return Err(Failure::usage(message).hint("add --segmenter sam"));
        }
        (Some(file), ..) => MasksFrom::File(file),
        (None, SegmenterName::Auto, None) => MasksFrom::Auto,
        (None, SegmenterName::Texton, None) => MasksFrom::Texton,
        (None, SegmenterName::Regions, None) => MasksFrom::Regions,
        (None, SegmenterName::Felzenszwalb, None) => MasksFrom::Felzenszwalb,
    })
}
