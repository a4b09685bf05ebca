//! Two scenes: frames or an animation from one to the other, or a scene between them.

use super::arguments::{AnimateArgs, FRAMES_OF_WAY, MorphFrom};
use super::play::{idle, play_all};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::frames::Frames;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::files::{Makes, check_files, outputs, targets};
use crate::cli::options::frames::Played;
use crate::cli::output::{DrawingOptions, Targets};
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::summary::{ElementCounts, Summary};
use std::sync::Arc;
use vtex::Progress;
use vtex::control;
use vtex::interpolate::{Interpolation, Morph, morph};
use vtex::output::file::{BackgroundChoice, Format};
use vtex::output::raster_animation::RasterAnimation;
use vtex::output::svg::{Animation, SvgOptions};
use vtex::scene::Scene;

const MAKES: Makes = Makes { allowed: format::OF_SCENE, usual: Format::Svg, word: "between" };

/// The two scenes and the requested outputs.
pub(super) struct Between {
    from: Input,
    to: Input,
    wanted: Wanted,
    drawing: DrawingOptions<'static>,
}

/// The result wanted from two scenes.
enum Wanted {
    /// The scene at a share of the way.
    At(f64, Targets),
    /// One scene that is at different shares of the way at different places.
    Morph(MorphFrom, Targets),
    /// Animations, at least one.
    Played(Vec<Played>, Pace),
}

/// Number and playback of frames.
#[derive(Clone, Copy)]
struct Pace {
    /// Number of frames from the first scene to the second, both included.
    frames: u32,
    rate: f64,
    back: bool,
}

impl Pace {
    /// Number of frames played, including those on the way back. The first frame is played once.
    fn played(&self) -> u32 {
        if self.back { 2 * self.frames - 2 } else { self.frames }
    }

    /// Share of the way of the `k`-th frame played.
    fn share(&self, k: u32) -> f64 {
        let last = self.frames - 1;
        f64::from(if k > last { 2 * last - k } else { k }) / f64::from(last)
    }
}

impl Between {
    /// Checks the options.
    pub(super) fn new(
        mut a: AnimateArgs,
        from: Input,
        to: Input,
        drawing: DrawingOptions<'static>,
    ) -> Result<Self, Failure> {
        let mut read = vec![("the first scene", &from), ("the second scene", &to)];
        if let Some(MorphFrom::Map(map)) = &a.morph {
            read.push(("--morph", map));
        }
        check_files(&read, &outputs(&a.output))?;
        let morph = a.morph.take().or(a.across.map(MorphFrom::Axis));
        let wanted = if let Some(share) = a.at {
            Wanted::At(share, targets(a.output, &a.force, &from, MAKES)?)
        } else if let Some(morph) = morph {
            Wanted::Morph(morph, targets(a.output, &a.force, &from, MAKES)?)
        } else {
            let pace = Pace { frames: a.frames.unwrap_or(FRAMES_OF_WAY), rate: a.fps, back: a.back };
            Wanted::Played(a.played("give --at, --across or --morph")?, pace)
        };
        Ok(Self { from, to, wanted, drawing })
    }
}

pub(super) fn run(common: &Common, reporter: &Reporter, job: &Between) -> anyhow::Result<()> {
    let Between { from, to, wanted, drawing } = job;
    match wanted {
        Wanted::At(_, targets) | Wanted::Morph(_, targets) => targets.probe()?,
        Wanted::Played(played, _) => played.iter().try_for_each(Played::probe)?,
    }
    reporter.stage("reading")?;
    let names = vec![from.name(), to.name()];
    let [from, to] = [reading::scene(from)?, reading::scene(to)?].map(Arc::new);
    let way = || Interpolation::new(from.clone(), to.clone(), reporter);
    let (scene, targets) = match wanted {
        Wanted::At(share, targets) => {
            let way = way()?;
            reporter.stage("moving")?;
            (way.at(*share), targets)
        }
        Wanted::Morph(place, targets) => (morph(from.clone(), to.clone(), &read(place)?, reporter)?, targets),
        Wanted::Played(wanted, pace) => {
            idle(drawing, wanted, false).iter().for_each(|warning| reporter.warn(warning));
            let way = way()?;
            let animation = RasterAnimation { frames: pace.played(), rate: pace.rate };
            let scene = &|k| way.at(pace.share(k));
            let frames = Frames { reporter, drawing: *drawing, animation, scene };
            let opaque = |scene: &Scene| scene.domain.is_none();
            let opaque =
                drawing.render.background != Some(BackgroundChoice::None) && opaque(&from) && opaque(&to);
            // Duration of the way in one direction.
            let seconds = f64::from(pace.frames) / pace.rate;
            let fitted = |scene: &Scene| SvgOptions::from(drawing.svg).fit(scene).precision;
            let animation = Animation { seconds, back: pace.back, precision: fitted(&from).max(fitted(&to)) };
            let written =
                play_all(&frames, wanted, opaque, |target| target.write_animation(&way, &animation))?;
            let first = &wanted[0];
            let summary = Summary {
                size: drawing.size_of(&from, first.format()),
                page: drawing.page(&from),
                ..Summary::new("animate", names, first.path(), written, reporter)
            };
            return summary.print(common, false);
        }
    };
    if let Some(warning) = drawing.render.warning(targets.any_uses(|uses| uses.scale)) {
        reporter.warn(warning);
    }
    reporter.stage("drawing")?;
    let written = targets.write_scene(&scene, None, *drawing)?;
    let summary = Summary {
        size: drawing.size_of(&scene, targets.first.kind.format),
        page: drawing.page(&scene),
        counts: Some(ElementCounts::of_scene(&scene)),
        ..Summary::new("animate", names, targets.path(), written, reporter)
    };
    summary.print(common, targets.piped())
}

/// Where a scene turns into another, with the content of the map.
fn read(place: &MorphFrom) -> anyhow::Result<Morph> {
    Ok(match place {
        MorphFrom::Axis(axis) => Morph::Axis(*axis),
        MorphFrom::Radial => Morph::Radial,
        MorphFrom::Map(file) => {
            let bytes = file.read()?;
            InputKind::expect(&bytes, file, &[InputKind::Image, InputKind::Unknown])
                .map_err(|failure| failure.hint("--morph takes x, y, radial or a grey picture"))?;
            Morph::Map(control::level(&bytes, &file.name())?)
        }
    })
}
