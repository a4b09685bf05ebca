//! Frames, an animation, or a scene between two.

use super::arguments::{InterpResult, Interpolating, MorphFrom, One, Pace};
use crate::cli::common::Common;
use crate::cli::frames::Frames;
use crate::cli::input;
use crate::cli::options::frames::{AnimationKind, Played};
use crate::cli::options::render::BackgroundChoice;
use crate::cli::output::{Destination, DrawingOptions, Target, Targets, WrittenFile};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::{ElementCounts, Summary};
use std::path::Path;
use std::sync::Arc;
use vtex::Progress;
use vtex::control;
use vtex::interpolate::{Interpolation, Morph, morph};
use vtex::output::file::{FileKind, Format};
use vtex::output::raster_animation::RasterAnimation;
use vtex::output::svg::Animation;
use vtex::scene::Scene;

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Interpolating) -> anyhow::Result<()> {
    let Interpolating { from, to, wanted, .. } = job;
    for wanted in wanted {
        match wanted {
            InterpResult::Scene(_, targets) => targets.probe()?,
            InterpResult::Played(played, _) => played.probe()?,
        }
    }
    reporter.stage("reading")?;
    let scenes = [reading::scene(from)?, reading::scene(to)?].map(Arc::new);
    for warning in idle(job) {
        reporter.warn(warning);
    }
    let mut all = Vec::new();
    for wanted in wanted {
        all.push(match wanted {
            InterpResult::Scene(between, targets) => one(reporter, job, &scenes, between, targets)?,
            InterpResult::Played(wanted, pace) => played(reporter, job, &scenes, wanted, pace)?,
        });
    }
    let mut all = all.into_iter();
    let Some(mut made) = all.next() else { return Ok(()) };
    for InterpSummary { path, written, .. } in all {
        made.written.others.push((path.to_owned(), written.bytes));
        made.written.warnings.extend(written.warnings);
    }
    let summary = Summary {
        size: made.size,
        counts: made.counts,
        ..Summary::new("interp", vec![from.name(), to.name()], made.path, made.written, reporter)
    };
    summary.tell(common, made.piped)
}

/// Notes on options without effect.
fn idle(job: &Interpolating) -> Vec<&'static str> {
    let is_svg =
        |played: &Played| matches!(played, Played::Animation { kind: AnimationKind::Svg { .. }, .. });
    let svg = job.wanted.iter().all(|w| matches!(w, InterpResult::Played(played, _) if is_svg(played)));
    let limit = svg && job.svg.max_bytes.is_some();
    let expand = svg && job.svg.expand;
    let warnings = [
        job.scale.warning(job.wanted.iter().any(InterpResult::drawn)),
        limit.then_some("--max-bytes has no effect here: nothing of an animation can be given up"),
        expand.then_some("--expand has no effect here: an animation has all elements in full"),
    ];
    warnings.into_iter().flatten().collect()
}

/// The written files.
struct InterpSummary<'a> {
    path: &'a Path,
    written: WrittenFile,
    size: [u32; 2],
    counts: Option<ElementCounts>,
    /// Whether it was written to standard output.
    piped: bool,
}

/// How scenes between the two are drawn.
fn drawing(job: &Interpolating) -> DrawingOptions<'static> {
    DrawingOptions { svg: job.svg, render: job.scale, recipe: None }
}

/// One scene between the two.
fn one<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Arc<Scene>; 2],
    between: &One,
    targets: &'a Targets,
) -> anyhow::Result<InterpSummary<'a>> {
    let scene = match between {
        One::At(t) => {
            let way = Interpolation::new(from.clone(), to.clone(), reporter)?;
            reporter.stage("moving")?;
            way.at(*t)
        }
        One::Morph(place) => morph(from.clone(), to.clone(), &read(place)?, reporter)?,
    };
    reporter.stage("drawing")?;
    let written = targets.write_scene(&scene, None, drawing(job))?;
    let size = drawing(job).size_of(&scene, targets.first.kind.format);
    let counts = Some(ElementCounts::of_scene(&scene));
    Ok(InterpSummary { path: targets.path(), written, size, counts, piped: targets.piped() })
}

/// Reads the map of a morph, if it has one.
fn read(place: &MorphFrom) -> anyhow::Result<Morph> {
    Ok(match place {
        MorphFrom::Axis(axis) => Morph::Axis(*axis),
        MorphFrom::Radial => Morph::Radial,
        MorphFrom::Map(file) => {
            let bytes = file.read()?;
            input::InputKind::expect(&bytes, file, &[input::InputKind::Image, input::InputKind::Unknown])
                .map_err(|failure| failure.hint("--morph takes x, y, radial or a grey picture"))?;
            Morph::Map(control::level(&bytes, &file.name())?)
        }
    })
}

/// Frames in a folder, or one file that plays.
fn played<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Arc<Scene>; 2],
    played: &'a Played,
    pace: &Pace,
) -> anyhow::Result<InterpSummary<'a>> {
    let way = Interpolation::new(from.clone(), to.clone(), reporter)?;
    let drawing = drawing(job);
    let animation = RasterAnimation { frames: pace.played(), rate: pace.rate };
    let frames = Frames { reporter, drawing, animation, scene: &|k| way.at(pace.share(k)) };
    let written = match played {
        Played::Frames { folder, kind, force } => frames.write_files(folder, (*kind, *force))?,
        Played::Animation { place, kind: AnimationKind::Gif } => frames.write_gif(place)?,
        Played::Animation { place, kind: AnimationKind::Png } => {
            let with_background = job.scale.background != Some(BackgroundChoice::None);
            frames.write_png(place, with_background && from.domain.is_none() && to.domain.is_none())?
        }
        Played::Animation { place, kind: AnimationKind::Svg { gzip } } => {
            reporter.stage("drawing")?;
            // Duration of the frames, without those on the way back.
            let seconds = f64::from(pace.frames) / pace.rate;
            let animation = Animation { seconds, back: pace.back, precision: job.svg.precision };
            let target = Target { place: place.clone(), kind: FileKind { format: Format::Svg, gzip: *gzip } };
            target.write_animation(&way, &animation)?
        }
    };
    let (path, format) = match played {
        Played::Frames { folder, kind, .. } => (folder.as_path(), kind.format),
        Played::Animation { place, kind: AnimationKind::Svg { .. } } => (place.path(), Format::Svg),
        Played::Animation { place, .. } => (place.path(), Format::Png),
    };
    let piped = matches!(played, Played::Animation { place: Destination::Stdout, .. });
    Ok(InterpSummary { path, written, size: drawing.size_of(from, format), counts: None, piped })
}
