//! Animations: the format that the name of the output stands for.

use crate::cli::failure::Failure;
use crate::cli::output::Destination;
use crate::cli::values::{named, one_of};
use clap::builder::TypedValueParser;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use vtex::Parameter;
use vtex::output::file::{FileKind, Format};

/// Number of pictures.
pub(crate) const FRAMES: Parameter<u32> = Parameter::new("frames", [2, 10_000], "");

/// Formats of frames in a folder.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FrameFormat {
    Svg,
    Png,
}

/// The parser of a format of frames.
pub(crate) fn formats() -> impl TypedValueParser<Value = FrameFormat> {
    one_of(&["svg", "png"], named::<FrameFormat>)
}

/// Formats of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AnimationKind {
    Svg { gzip: bool },
    Gif,
    Png,
}

/// The form of an animation.
pub(crate) enum Played {
    /// Files of their own, named by their number.
    Frames { folder: PathBuf, kind: FileKind, force: bool },
    /// One animated file.
    Animation { place: Destination, kind: AnimationKind },
}

impl Played {
    /// Whether its frames are pictures of pixels.
    pub(crate) fn drawn(&self) -> bool {
        match self {
            Self::Frames { kind, .. } => kind.format == Format::Png,
            Self::Animation { kind, .. } => !matches!(kind, AnimationKind::Svg { .. }),
        }
    }

    /// Whether it is an animated SVG.
    pub(crate) fn is_svg(&self) -> bool {
        matches!(self, Self::Animation { kind: AnimationKind::Svg { .. }, .. })
    }

    /// The file, or the folder.
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Frames { folder, .. } => folder,
            Self::Animation { place, .. } => place.path(),
        }
    }

    /// The format whose size its pictures have.
    pub(crate) fn format(&self) -> Format {
        if self.drawn() { Format::Png } else { Format::Svg }
    }

    /// Checks that the file can be written.
    pub(crate) fn probe(&self) -> vtex::Result<()> {
        match self {
            Self::Frames { .. } => Ok(()),
            Self::Animation { place, .. } => place.probe(),
        }
    }
}

/// An animation, or frames in a folder, by the name of the output.
pub(crate) fn played(
    path: PathBuf,
    format: Option<FrameFormat>,
    force: bool,
    otherwise: &str,
) -> Result<Played, Failure> {
    let name = path.to_string_lossy().to_ascii_lowercase();
    let known = [
        (".svg", AnimationKind::Svg { gzip: false }),
        (".svgz", AnimationKind::Svg { gzip: true }),
        (".gif", AnimationKind::Gif),
        (".png", AnimationKind::Png),
        (".apng", AnimationKind::Png),
    ];
    let found = known.iter().find(|(ending, _)| name.ends_with(ending)).filter(|_| !path.is_dir());
    match found {
        Some(_) if format.is_some() => {
            Err(Failure::usage("--format is for frames in a folder").hint("give -o the name of a folder"))
        }
        Some(&(_, kind)) => Ok(Played::Animation { place: Destination::File { path, force }, kind }),
        None if is_folder(&path) => {
            let format = match format.unwrap_or(FrameFormat::Svg) {
                FrameFormat::Svg => Format::Svg,
                FrameFormat::Png => Format::Png,
            };
            Ok(Played::Frames { folder: path, kind: FileKind { format, gzip: false }, force })
        }
        None => Err(Failure::usage(format!("cannot tell the kind of animation from '{}'", path.display()))
            .hint(format!(
                "give -o a name that ends in .svg, .svgz, .gif, .png or .apng, or the name of a folder; \
                 other files contain one scene: {otherwise}"
            ))),
    }
}

/// Whether a path can only be a folder.
fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.as_os_str() != "-" && path.extension().is_none()
}

/// Digits of the numbers of these files, at least four, so that they sort by name.
pub(crate) fn digits(count: u32) -> usize {
    count.to_string().len().max(4)
}
