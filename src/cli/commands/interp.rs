//! `vtex interp`: two scenes → frames, an animation, or a scene between them.

use crate::cli::input::{Input, Kind as Content};
use crate::cli::interp_arguments::{Between, FilmKind, Interpolating, Pace, Wanted};
use crate::cli::options::Common;
use crate::cli::output::{Place, Target, Written};
use crate::cli::progress::Reporter;
use crate::cli::summary::{Counts, Seconds, Summary, peak_memory};
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
    let scenes = [read(from)?, read(to)?];
    let made = match wanted {
        Wanted::Scene(between, target) => one(reporter, job, &scenes, between, target)?,
        _ => many(reporter, job, &scenes)?,
    };
    for warning in &made.written.warnings {
        reporter.warn(warning);
    }
    let (seconds, warnings) = reporter.finish();
    let summary = Summary {
        program: vtex::PROGRAM,
        command: "interp",
        inputs: vec![from.name(), to.name()],
        output: made.path.display().to_string(),
        pattern: None,
        bytes: made.written.bytes,
        given_up: made.written.given_up,
        seed: None,
        size: made.size,
        counts: made.counts,
        coverage: None,
        overlap: None,
        repetition: None,
        seconds: Seconds(seconds),
        peak_memory: peak_memory(),
        warnings,
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

fn read(input: &Input) -> anyhow::Result<Scene> {
    let bytes = input.read()?;
    Content::expect(&bytes, input, &[Content::Scene, Content::Unknown])
        .map_err(|failure| failure.hint("make a scene with 'vtex synth photo.lib.json -o out.scene.json'"))?;
    Ok(Scene::from_bytes(&bytes, &input.name())?)
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
        Between::At(t) => Interpolation::new(from, to, reporter)?.at(t),
        Between::Across(axis) => across(from, to, axis, reporter)?,
    };
    reporter.stage("drawing")?;
    let written = target.write_scene(&scene, job.svg, job.scale.scale)?;
    let size = [scene.width, scene.height];
    Ok(Made { path: target.place.path(), written, size, counts: Some(Counts::of_scene(&scene)) })
}

/// Frames, or a film of them.
fn many<'a>(
    reporter: &Reporter,
    job: &'a Interpolating,
    [from, to]: &[Scene; 2],
) -> anyhow::Result<Made<'a>> {
    let scale = job.scale.scale;
    let way = Interpolation::new(from, to, reporter)?;
    let frame = |pace: &Pace, k: u32| -> vtex::Result<Scene> {
        let go_on = reporter.advance("drawing", u64::from(k), u64::from(pace.played()));
        if go_on { Ok(way.at(pace.share(k))) } else { Err(Error::Interrupted) }
    };
    let picture = |pace: &Pace, k: u32| png::render(&frame(pace, k)?, scale);
    let (path, bytes, drawn) = match &job.wanted {
        Wanted::Frames { folder, kind, force, pace } => {
            std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
            let ending = if kind.format == Format::Png { "png" } else { "svg" };
            let mut bytes = 0;
            for k in 0..pace.played() {
                let path = folder.join(format!("frame_{:04}.{ending}", k + 1));
                let target = Target { place: Place::File { path, force: *force }, kind: *kind };
                bytes += target.write_scene(&frame(pace, k)?, job.svg, scale)?.bytes;
            }
            (folder.as_path(), bytes, ending == "png")
        }
        Wanted::Film { place, kind, pace } => {
            let film = Film { frames: pace.played(), rate: pace.rate };
            let opaque = from.domain.is_none() && to.domain.is_none();
            let ((), bytes) = match kind {
                FilmKind::Gif => place.write(|out| film.write_gif(|k| picture(pace, k), out))?,
                FilmKind::Png => place.write(|out| film.write_png(opaque, |k| picture(pace, k), out))?,
                FilmKind::Svg { gzip } => {
                    return animated(job, &way, &film, *gzip, place, pace);
                }
            };
            (place.path(), bytes, true)
        }
        Wanted::Scene(..) => unreachable!("one scene is written elsewhere"),
    };
    let side = |v: u32| if drawn { (f64::from(v) * scale).round().max(1.0) as u32 } else { v };
    let written = Written { bytes, ..Written::default() };
    Ok(Made { path, written, size: [side(from.width), side(from.height)], counts: None })
}

/// A film that a viewer draws itself.
fn animated<'a>(
    job: &'a Interpolating,
    way: &Interpolation<'_>,
    film: &Film,
    packed: bool,
    place: &'a Place,
    pace: &Pace,
) -> anyhow::Result<Made<'a>> {
    // As long as the way is in pictures, back not included.
    let seconds = f64::from(pace.frames) / film.rate;
    let animation = Animation { seconds, back: pace.back, precision: job.svg.precision };
    let target = Target { place: place.clone(), kind: Kind { format: Format::Svg, gzip: packed } };
    let written = target.write_animation(way, &animation)?;
    let [scene, _] = way.scenes();
    Ok(Made { path: place.path(), written, size: [scene.width, scene.height], counts: None })
}
