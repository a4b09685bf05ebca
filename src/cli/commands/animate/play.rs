//! Animations as files.

use crate::cli::frames::Frames;
use crate::cli::options::frames::{AnimationKind, Played};
use crate::cli::output::{DrawingOptions, Target, WrittenFile};
use vtex::output::file::{FileKind, Format};

/// Writes all animations, or their frames; animated SVGs by `svg`.
pub(super) fn play_all(
    frames: &Frames<'_>,
    all: &[Played],
    opaque: bool,
    svg: impl Fn(&Target) -> vtex::Result<WrittenFile>,
) -> anyhow::Result<WrittenFile> {
    let mut all = all.iter().map(|played| {
        let written = match played {
            Played::Frames { folder, kind, force } => frames.write_files(folder, (*kind, *force))?,
            Played::Animation { place, kind: AnimationKind::Gif } => frames.write_gif(place)?,
            Played::Animation { place, kind: AnimationKind::Png } => frames.write_png(place, opaque)?,
            Played::Animation { place, kind: AnimationKind::Svg { gzip } } => {
                frames.reporter.stage("drawing")?;
                svg(&Target { place: place.clone(), kind: FileKind { format: Format::Svg, gzip: *gzip } })?
            }
        };
        anyhow::Ok((played.path(), written))
    });
    let Some((_, mut first)) = all.next().transpose()? else { return Ok(WrittenFile::default()) };
    for other in all {
        let (path, written) = other?;
        first.others.push((path.to_owned(), written.bytes));
        first.warnings.extend(written.warnings);
    }
    Ok(first)
}

/// Notes on options that change nothing in animated SVGs.
pub(super) fn idle(drawing: &DrawingOptions<'_>, played: &[Played], expands: bool) -> Vec<&'static str> {
    let svg = played.iter().all(Played::is_svg);
    let warnings = [
        drawing.render.warning(played.iter().any(Played::drawn)),
        (svg && drawing.svg.max_bytes.is_some())
            .then_some("--max-bytes has no effect here: nothing of an animation can be given up"),
        (svg && !expands && drawing.svg.expand)
            .then_some("--expand has no effect here: an animation has all elements in full"),
    ];
    warnings.into_iter().flatten().collect()
}
