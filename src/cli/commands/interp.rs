//! `vtex interp`: two scenes → frames, an animation, or a scene between them.

use crate::cli::interp_arguments::{Between, FilmKind, Interpolating, Pace, Wanted};
use crate::cli::options::Common;
use crate::cli::output::{Place, Target, Written};
use crate::cli::progress::Reporter;
use crate::cli::stages;
use crate::cli::summary::{Counts, Summary};
use std::path::Path;
use vtex::interpolate::{Interpolation, across};
use vtex::output::file::{Format, Kind};
use vtex::output::svg::Animation;
use vtex::output::{film::Film, png};
use vtex::scene::Scene;
use vtex::{Error, Progress};

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Interpolating) -> anyhow::Result<()> {
    let Interpolating { from, to, wanted, .. } = job;
    if let Wanted::Scene(_, Target { place, .. }) | Wanted::Film { place, .. } = wanted {
        place.probe()?;
    }
    reporter.stage("reading")?;
    let scenes = [stages::scene(from)?, stages::scene(to)?];
    let made = match wanted {
        Wanted::Scene(between, target) => one(reporter, job, &scenes, between, target)?,
        Wanted::Frames { folder, kind, force, pace } => {
            frames(reporter, job, &scenes, folder, (*kind, *force), pace)?
        }
        Wanted::Film { place, kind, pace } => film(reporter, job, &scenes, place, *kind, pace)?,
    };
    let summary = Summary {
        size: made.size,
        counts: made.counts,
        ..Summary::new("interp", vec![from.name(), to.name()], made.path, made.written, reporter)
    };
    summary.tell(common, made.path == Path::new("-"))
}

/// What was written where.
struct Made<'a> {
    path: &'a Path,
    written: Written,
    size: [u32; 2],
    counts: Option<Counts>,
}

/// One scene between the two.
fn one<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Scene; 2],
    between: &Between,
    target: &'a Target,
) -> anyhow::Result<Made<'a>> {
    let scene = match *between {
        Between::At(t) => {
            let way = Interpolation::new(from, to, reporter)?;
            reporter.stage("moving")?;
            way.at(t)
        }
        Between::Across(axis) => across(from, to, axis, reporter)?,
    };
    reporter.stage("drawing")?;
    let written = target.write_scene(&scene, job.svg, job.scale.scale)?;
    let drawn = target.kind.format == Format::Png;
    let size = if drawn { scaled(&scene, job) } else { [scene.width, scene.height] };
    Ok(Made { path: target.place.path(), written, size, counts: Some(Counts::of_scene(&scene)) })
}

/// Files of their own, one for each frame.
fn frames<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Scene; 2],
    folder: &'a Path,
    (kind, force): (Kind, bool),
    pace: &Pace,
) -> anyhow::Result<Made<'a>> {
    let way = Interpolation::new(from, to, reporter)?;
    std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
    let drawn = kind.format == Format::Png;
    let ending = if drawn { "png" } else { "svg" };
    let mut bytes = 0;
    for k in 0..pace.played() {
        let path = folder.join(format!("frame_{:04}.{ending}", k + 1));
        let target = Target { place: Place::File { path, force }, kind };
        bytes += target.write_scene(&frame(reporter, &way, pace, k)?, job.svg, job.scale.scale)?.bytes;
    }
    let size = if drawn { scaled(from, job) } else { [from.width, from.height] };
    Ok(Made { path: folder, written: Written::of(bytes), size, counts: None })
}

/// One file that plays.
fn film<'a>(
    reporter: &Reporter,
    job: &Interpolating,
    [from, to]: &[Scene; 2],
    place: &'a Place,
    kind: FilmKind,
    pace: &Pace,
) -> anyhow::Result<Made<'a>> {
    let way = Interpolation::new(from, to, reporter)?;
    let film = Film { frames: pace.played(), rate: pace.rate };
    let opaque = from.domain.is_none() && to.domain.is_none();
    let picture = |k: u32| png::render(&frame(reporter, &way, pace, k)?, job.scale.scale);
    let (written, size) = match kind {
        FilmKind::Gif => (Written::of(place.write(|out| film.write_gif(picture, out))?.1), scaled(from, job)),
        FilmKind::Png => {
            (Written::of(place.write(|out| film.write_png(opaque, picture, out))?.1), scaled(from, job))
        }
        FilmKind::Svg { gzip } => {
            reporter.stage("drawing")?;
            // As long as the way is in pictures, back not included.
            let seconds = f64::from(pace.frames) / pace.rate;
            let animation = Animation { seconds, back: pace.back, precision: job.svg.precision };
            let target = Target { place: place.clone(), kind: Kind { format: Format::Svg, gzip } };
            (target.write_animation(&way, &animation)?, [from.width, from.height])
        }
    };
    Ok(Made { path: place.path(), written, size, counts: None })
}

/// Frame `k` of those played.
fn frame(reporter: &Reporter, way: &Interpolation<'_>, pace: &Pace, k: u32) -> vtex::Result<Scene> {
    let go_on = reporter.advance("drawing", u64::from(k), u64::from(pace.played()));
    if go_on { Ok(way.at(pace.share(k))) } else { Err(Error::Interrupted) }
}

/// Size of a picture of a scene.
fn scaled(scene: &Scene, job: &Interpolating) -> [u32; 2] {
    [scene.width, scene.height].map(|v| (f64::from(v) * job.scale.scale).round().max(1.0) as u32)
}
