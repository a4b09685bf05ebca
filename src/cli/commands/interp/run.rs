//! Frames, an animation, or a scene between two.

use super::arguments::{Interpolating, MorphFrom, One, Pace, Wanted};
use crate::cli::common::Common;
use crate::cli::input;
use crate::cli::options::frames::{AnimationKind, digits};
use crate::cli::options::render::Background;
use crate::cli::output::{Drawing, Place, Target, Targets, Written};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::{Counts, Summary};
use std::cmp::Reverse;
use std::path::Path;
use std::sync::Arc;
use vtex::control;
use vtex::interpolate::{Interpolation, Morph, morph};
use vtex::output::file::{Format, Kind};
use vtex::output::raster_animation::RasterAnimation;
use vtex::output::reduce::GivenUp;
use vtex::output::svg::Animation;
use vtex::scene::Scene;
use vtex::{Error, Progress};

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Interpolating) -> anyhow::Result<()> {
    let Interpolating { from, to, wanted, .. } = job;
    for wanted in wanted {
        match wanted {
            Wanted::Scene(_, targets) => targets.probe()?,
            Wanted::Animation { place, .. } => place.probe()?,
            Wanted::Frames { .. } => {}
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
            Wanted::Scene(between, targets) => one(reporter, job, &scenes, between, targets)?,
            Wanted::Frames { folder, kind, force, pace } => {
                frames(reporter, job, &scenes, folder, (*kind, *force), pace)?
            }
            Wanted::Animation { place, kind, pace } => animation(reporter, job, &scenes, place, *kind, pace)?,
        });
    }
    let mut all = all.into_iter();
    let Some(mut made) = all.next() else { return Ok(()) };
    for Made { path, written, .. } in all {
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

/// Notes on options that change nothing here.
fn idle(job: &Interpolating) -> Vec<&'static str> {
    let svg =
        job.wanted.iter().all(|w| matches!(w, Wanted::Animation { kind: AnimationKind::Svg { .. }, .. }));
    let limit = svg && job.svg.max_bytes.is_some();
    let expand = svg && job.svg.expand;
    let warnings = [
        job.scale.warning(job.wanted.iter().any(Wanted::drawn)),
        limit.then_some("--max-bytes has no effect here: nothing of an animation can be given up"),
        expand.then_some("--expand has no effect here: an animation has all elements in full"),
    ];
    warnings.into_iter().flatten().collect()
}

/// The written files.
struct Made<'a> {
    path: &'a Path,
    written: Written,
    size: [u32; 2],
    counts: Option<Counts>,
    /// Whether standard output has carried it.
    piped: bool,
}

/// How scenes between the two are drawn.
fn drawing(job: &Interpolating) -> Drawing<'static> {
    Drawing { svg: job.svg, render: job.scale, recipe: None }
}

/// One scene between the two.
fn one<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Arc<Scene>; 2],
    between: &One,
    targets: &'a Targets,
) -> anyhow::Result<Made<'a>> {
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
    let counts = Some(Counts::of_scene(&scene));
    Ok(Made { path: targets.path(), written, size, counts, piped: targets.piped() })
}

/// Where a scene turns into another, with the map that says so.
fn read(place: &MorphFrom) -> anyhow::Result<Morph> {
    Ok(match place {
        MorphFrom::Axis(axis) => Morph::Axis(*axis),
        MorphFrom::Radial => Morph::Radial,
        MorphFrom::Map(file) => {
            let bytes = file.read()?;
            input::Kind::expect(&bytes, file, &[input::Kind::Image, input::Kind::Unknown])
                .map_err(|failure| failure.hint("--morph takes x, y, radial or a grey picture"))?;
            Morph::Map(control::level(&bytes, &file.name())?)
        }
    })
}

/// Files of their own, one for each frame.
fn frames<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Arc<Scene>; 2],
    folder: &'a Path,
    (kind, force): (Kind, bool),
    pace: &Pace,
) -> anyhow::Result<Made<'a>> {
    let way = Interpolation::new(from.clone(), to.clone(), reporter)?;
    std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
    let drawn = kind.format == Format::Png;
    let ending = if drawn { "png" } else { "svg" };
    let count = pace.played();
    let name = |k: u32| folder.join(format!("frame_{k:0digits$}.{ending}", digits = digits(count)));
    let mut written = Written::default();
    for k in 0..count {
        let target = Target { place: Place::File { path: name(k + 1), force }, kind };
        let one = target.write_scene(&frame(reporter, &way, pace, k)?, drawing(job))?;
        written.bytes += one.bytes;
        one.warnings.iter().for_each(|warning| reporter.warn(warning));
        // The most that any frame had to give up.
        let lost = |given: &GivenUp| (given.details + given.elements, Reverse(given.decimals));
        written.given_up = written.given_up.into_iter().chain(one.given_up).max_by_key(lost);
    }
    if name(count + 1).exists() {
        reporter.warn(&format!(
            "the folder holds frames of another animation as well, from '{}' on",
            name(count + 1).display()
        ));
    }
    let size = drawing(job).size_of(from, kind.format);
    Ok(Made { path: folder, written, size, counts: None, piped: false })
}

/// One file that plays.
fn animation<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Arc<Scene>; 2],
    place: &'a Place,
    kind: AnimationKind,
    pace: &Pace,
) -> anyhow::Result<Made<'a>> {
    let way = Interpolation::new(from.clone(), to.clone(), reporter)?;
    let animation = RasterAnimation { frames: pace.played(), rate: pace.rate };
    let with_background = job.scale.background != Some(Background::None);
    let opaque = with_background && from.domain.is_none() && to.domain.is_none();
    let picture = |k: u32| drawing(job).picture(&frame(reporter, &way, pace, k)?);
    let written = match kind {
        AnimationKind::Gif => Written::of(place.write(|out| animation.write_gif(picture, out))?.1),
        AnimationKind::Png => Written::of(place.write(|out| animation.write_png(opaque, picture, out))?.1),
        AnimationKind::Svg { gzip } => {
            reporter.stage("drawing")?;
            // As long as the way is in pictures, back not included.
            let seconds = f64::from(pace.frames) / pace.rate;
            let animation = Animation { seconds, back: pace.back, precision: job.svg.precision };
            let target = Target { place: place.clone(), kind: Kind { format: Format::Svg, gzip } };
            target.write_animation(&way, &animation)?
        }
    };
    let svg = matches!(kind, AnimationKind::Svg { .. });
    let size = drawing(job).size_of(from, if svg { Format::Svg } else { Format::Png });
    Ok(Made { path: place.path(), written, size, counts: None, piped: *place == Place::Stdout })
}

/// Frame `k` of those played.
fn frame(reporter: &Reporter, way: &Interpolation, pace: &Pace, k: u32) -> vtex::Result<Scene> {
    let go_on = reporter.advance("drawing", u64::from(k), u64::from(pace.played()));
    if go_on { Ok(way.at(pace.share(k))) } else { Err(Error::Interrupted) }
}
