//! Progress for the user: bars, warnings, pictures of the stages.

use super::common::Common;
use super::failure::label;
use super::foreign::line;
use super::interrupt;
use super::output::{Destination, say_styled};
use anstyle::AnsiColor;
use image::RgbImage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use vtex::{Error, Progress, Result};
use vtex_segment::segment::pieces;

/// Shows progress, keeps the time of each stage and all warnings, and stops the work on Ctrl-C.
pub(crate) struct Reporter {
    bar: ProgressBar,
    /// Whether warnings are printed as they come.
    talks: bool,
    debug_folder: Option<PathBuf>,
    state: Mutex<ReportedState>,
    /// Who hears of everything too, and may stop the work.
    listener: Option<Arc<dyn Progress + Send>>,
    /// Shared with the bar, which asks it at every tick.
    whole: Arc<Mutex<TotalProgress>>,
    start: Instant,
}

struct ReportedState {
    plan: Option<Plan>,
    stage: &'static str,
    since: Instant,
    seconds: Vec<(&'static str, Duration)>,
    warnings: Vec<String>,
    pictures: u32,
    /// The first picture that could not be written.
    failure: Option<Error>,
}

/// Characters of the bar.
const WIDE: usize = 32;

/// The work of a command, as far as its duration depends on it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Plan {
    /// The segmenter that finds the elements of a photograph, if one is analysed.
    pub(crate) finder: Option<ElementFinder>,
    /// Width and height of the photograph at the size of the analysis, in pixels; 0 before it is read.
    pub(crate) size: [u32; 2],
    /// Megapixels of the canvas of a texture, if one is made.
    pub(crate) canvas: Option<f64>,
}

/// The segmenter of a photograph, as far as the duration depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ElementFinder {
    Texton,
    Regions,
}

/// Assumed size of a photograph that was not read yet, in pixels.
const USUAL: [u32; 2] = [1000, 800];

/// Seconds of a stage: of its own, and for each megapixel.
type Seconds = (&'static str, f64, f64);

/// Stages before segmentation; measured, as those below, on two cores with photographs of .25 to 12 megapixels and
/// canvases of 1 and 9.
const BEFORE: [Seconds; 3] = [("reading", 0.02, 0.0), ("loading", 0.08, 0.0), ("reducing", 0.0, 0.0)];
/// Stages of segmentation with the network. A large photograph has them for each piece of it.
const TEXTON: [Seconds; 5] = [
    ("reading the image", 0.8, 2.1),
    ("finding masks: coarse grid", 0.02, 0.15),
    ("finding masks: fine grid", 0.0, 0.35),
    ("finding masks: finest grid", 0.05, 0.65),
    ("judging masks", 0.05, 0.8),
];
/// Stages of segmentation by merged regions, likewise.
const REGIONS: [Seconds; 1] = [("merging regions", 0.02, 0.45)];
/// The remaining stages of the analysis.
const ANALYSIS: [Seconds; 5] = [
    ("primaries", 0.05, 1.15),
    ("details", 0.06, 0.75),
    ("joining", 0.0, 3.5),
    ("outlines", 0.02, 0.7),
    ("categories", 0.05, 0.3),
];
/// Stages of a texture; seconds for each megapixel are those of the canvas.
const TEXTURE: [Seconds; 4] = [
    ("structure", 0.15, 0.72),
    ("carrying", 0.0, 0.06),
    ("background field", 0.15, 0.12),
    ("writing", 0.1, 0.35),
];
/// Writing of results other than textures; seconds are per megapixel of the photograph.
const WRITING: [Seconds; 1] = [("writing", 0.03, 0.35)];

/// Seconds of stages in their order, for a command without a plan: the order tells which stages lie before
/// and after the present one. Half of the later stages are assumed to occur.
const ANY: [(&str, f64); 29] = [
    ("reading", 0.1),
    ("loading", 0.1),
    ("merging regions", 0.9),
    ("reading the image", 1.0),
    ("finding masks", 0.1),
    ("finding masks: coarse grid", 0.1),
    ("finding masks: fine grid", 0.1),
    ("finding masks: finest grid", 0.2),
    ("judging masks", 0.4),
    ("segmentation", 1.5),
    ("primaries", 0.6),
    ("details", 0.5),
    ("joining", 0.1),
    ("outlines", 1.3),
    ("categories", 0.1),
    ("structure", 2.0),
    ("carrying", 0.5),
    ("placement", 2.0),
    ("curves", 5.0),
    ("density", 0.5),
    ("secondaries", 0.5),
    ("background field", 0.2),
    ("tuning", 30.0),
    ("matching", 1.0),
    ("moving", 0.5),
    ("editing", 0.5),
    ("comparing", 5.0),
    ("drawing", 1.0),
    ("writing", 0.5),
];

fn megapixels(size: [u32; 2]) -> f64 {
    f64::from(size[0]) * f64::from(size[1]) / 1e6
}

impl Plan {
    /// Stages and the seconds that they are expected to take.
    fn stages(&self) -> Vec<(&'static str, f64)> {
        let size = if self.size[0] > 0 { self.size } else { USUAL };
        let megapixels = megapixels(size);
        let of = |stages: &[Seconds], size: f64| -> Vec<(&'static str, f64)> {
            stages.iter().map(|&(name, own, each)| (name, own + each * size)).collect()
        };
        let mut all = Vec::new();
        if let Some(finder) = self.finder {
            let found: &[Seconds] = match finder {
                ElementFinder::Texton => &TEXTON,
                ElementFinder::Regions => &REGIONS,
            };
            all.extend(of(&BEFORE, megapixels));
            all.extend(pieces(size).into_iter().flat_map(|piece| of(found, self::megapixels(piece))));
            all.extend(of(&ANALYSIS, megapixels));
        }
        match self.canvas {
            Some(canvas) => all.extend(of(&TEXTURE, canvas)),
            None => all.extend(of(&WRITING, megapixels)),
        }
        all
    }
}

/// Progress of the whole work: elapsed time as a share of the expected time. It never decreases.
#[derive(Debug)]
struct TotalProgress {
    stages: Vec<(&'static str, f64)>,
    /// Index of the present stage, and its expected seconds.
    at: usize,
    expected: f64,
    /// Start of the stage, in seconds since the work began.
    since: f64,
    /// Steps done and all steps of the stage; the latter is 0 while it is unknown.
    steps: (u64, u64),
    /// Seconds that earlier stages took, and their expected seconds.
    spent: [f64; 2],
    /// The largest share shown.
    shown: f64,
}

impl Default for TotalProgress {
    fn default() -> Self {
        let stages = ANY.iter().map(|&(name, seconds)| (name, seconds / 2.0)).collect();
        Self { stages, at: 0, expected: 0.0, since: 0.0, steps: (0, 0), spent: [0.0; 2], shown: 0.0 }
    }
}

/// Share of the work after which this machine's speed has as much weight as the measured one.
const PRIOR: f64 = 0.1;
/// Expected seconds of a stage that is not in the plan.
const UNKNOWN: f64 = 0.3;

impl TotalProgress {
    /// Replaces the plan by a better one; the present stage continues.
    fn plan(&mut self, plan: &Plan) {
        let name = self.stages.get(self.at).map(|stage| stage.0);
        self.stages = plan.stages();
        self.at = self.stages.iter().position(|stage| Some(stage.0) == name).unwrap_or(0);
    }

    /// Begins a stage: earlier stages of the plan are over, later ones are still to come.
    fn enter(&mut self, stage: &str, now: f64) {
        self.spent[0] = now;
        self.spent[1] += self.expected;
        (self.since, self.steps) = (now, (0, 0));
        let known = self.stages.iter().skip(self.at).position(|(name, _)| *name == stage);
        match known {
            Some(further) => {
                self.at += further;
                self.expected = self.stages[self.at].1;
            }
            None => self.expected = UNKNOWN,
        }
    }

    /// The share of the work done at a time.
    fn share(&mut self, now: f64) -> f64 {
        // Scales the plan by the speed of this machine, which is estimated from the stages so far.
        let prior = PRIOR * self.stages.iter().map(|stage| stage.1).sum::<f64>();
        let rate = (self.spent[0] + prior) / (self.spent[1] + prior);
        let gone = now - self.since;
        let expected = (self.expected * rate - gone).max(0.1 * gone);
        let left = match self.steps {
            (done, total) if done > 0 && total > 0 => {
                let part = (done as f64 / total as f64).min(1.0);
                part * (gone / part - gone) + (1.0 - part) * expected
            }
            _ => expected,
        };
        let known = self.stages.get(self.at).is_some_and(|stage| stage.1 == self.expected);
        let next = if known { self.at + 1 } else { self.at };
        let after: f64 = self.stages.iter().skip(next).map(|stage| stage.1).sum();
        let all = now + left + after * rate;
        let share = if all > 0.0 { now / all } else { 0.0 };
        self.shown = self.shown.max(share).min(1.0);
        self.shown
    }
}

impl Reporter {
    /// A reporter as the options ask for it: bars only on a terminal, and with `--json` nothing
    /// but the JSON.
    ///
    /// # Errors
    /// A folder for pictures that cannot be made.
    pub(crate) fn new(common: &Common) -> Result<Self> {
        let talks = !common.quiet && !common.json;
        let plain = std::env::var_os("TERM").is_some_and(|t| t == "dumb");
        let shown = talks && !plain && std::io::stderr().is_terminal();
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        if let Some(folder) = &common.debug_folder {
            std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
        }
        let state = ReportedState {
            plan: None,
            stage: "",
            since: Instant::now(),
            seconds: Vec::new(),
            warnings: Vec::new(),
            pictures: 0,
            failure: None,
        };
        Ok(Self {
            bar: ProgressBar::with_draw_target(None, target),
            talks,
            debug_folder: common.debug_folder.clone(),
            listener: None,
            state: Mutex::new(state),
            whole: Arc::default(),
            start: Instant::now(),
        })
    }

    /// A reporter that prints nothing and passes on what it hears.
    ///
    /// # Errors
    /// None of its own.
    #[cfg(feature = "studio")]
    pub(crate) fn listening(common: &Common, listener: Arc<dyn Progress + Send>) -> Result<Self> {
        let silent = Common { quiet: true, debug_folder: None, ..common.clone() };
        let mut reporter = Self::new(&silent)?;
        reporter.listener = Some(listener);
        Ok(reporter)
    }

    /// Sets the plan, from which the bar estimates the duration.
    pub(crate) fn plan(&self, plan: Plan) {
        self.state().plan = Some(plan);
        self.whole().plan(&plan);
    }

    /// Sets the size of the photograph of the plan, and that of the analysis, in pixels.
    pub(crate) fn learn(&self, photograph: [u32; 2], analysed: [u32; 2]) {
        let Some(plan) = self.state().plan else { return };
        // A texture is placed on the pixels of the analysis.
        let canvas = plan.canvas.map(|canvas| canvas * megapixels(analysed) / megapixels(photograph));
        self.whole().plan(&Plan { size: analysed, canvas, ..plan });
    }

    fn whole(&self) -> MutexGuard<'_, TotalProgress> {
        self.whole.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A bar that moves with time, even in stages that report rarely.
    fn style(&self) -> ProgressStyle {
        let (whole, start) = (Arc::clone(&self.whole), self.start);
        let draw = move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
            let share =
                whole.lock().unwrap_or_else(PoisonError::into_inner).share(start.elapsed().as_secs_f64());
            let full = (share * WIDE as f64) as usize;
            let head = if full < WIDE { ">" } else { "" };
            // Errors of the terminal are ignored.
            let _ = write!(out, "[{:=<full$}{head:<1$}] {2:>3} %", "", WIDE - full, (share * 100.0) as u32);
        };
        let style = ProgressStyle::with_template("{spinner} {share} {msg}");
        style.unwrap_or_else(|_| ProgressStyle::default_bar()).with_key("share", draw)
    }

    /// Begins a stage.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub(crate) fn stage(&self, name: &'static str) -> Result<()> {
        if self.advance(name, 0, 0) { Ok(()) } else { Err(Error::Interrupted) }
    }

    /// Ends the bar and the last stage: seconds by stage in order, and all warnings.
    pub(crate) fn finish(&self) -> (Vec<(&'static str, Duration)>, Vec<String>) {
        self.bar.finish_and_clear();
        let mut state = self.state();
        state.enter("");
        (std::mem::take(&mut state.seconds), std::mem::take(&mut state.warnings))
    }

    /// Prints a hint.
    pub(crate) fn hint(&self, message: &str) {
        self.talk("hint", AnsiColor::Cyan, message);
    }

    /// Runs work with the bar hidden, such as a question to the user.
    pub(crate) fn with_bar_hidden<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    fn talk(&self, kind: &str, colour: AnsiColor, message: &str) {
        if self.talks {
            let style = label(colour);
            self.bar.suspend(|| say_styled(&format!("{style}{kind}:{style:#} {}", line(message))));
        }
    }

    /// The first picture of a stage that could not be written.
    pub(crate) fn failure(&self) -> Option<Error> {
        self.state().failure.take()
    }

    fn state(&self) -> MutexGuard<'_, ReportedState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        // Removes the bar, so that the message of an error has its own line.
        self.bar.finish_and_clear();
    }
}

impl ReportedState {
    /// Adds the elapsed time to the stage that ends, and starts another.
    fn enter(&mut self, stage: &'static str) {
        let now = Instant::now();
        let spent = now - self.since;
        if !self.stage.is_empty() {
            match self.seconds.iter_mut().find(|s| s.0 == self.stage) {
                Some(known) => known.1 += spent,
                None => self.seconds.push((self.stage, spent)),
            }
        }
        (self.stage, self.since) = (stage, now);
    }
}

impl Progress for Reporter {
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        let mut state = self.state();
        if state.stage != stage {
            if state.stage.is_empty() && state.seconds.is_empty() {
                self.bar.set_style(self.style());
                self.bar.enable_steady_tick(Duration::from_millis(120));
            }
            state.enter(stage);
            self.whole().enter(stage, self.start.elapsed().as_secs_f64());
            self.bar.set_message(stage);
        }
        self.whole().steps = (done, total);
        let goes_on = state.failure.is_none() && !interrupt::is_requested();
        drop(state);
        goes_on && self.listener.as_ref().is_none_or(|listener| listener.advance(stage, done, total))
    }

    fn warn(&self, message: &str) {
        let mut state = self.state();
        if state.warnings.iter().any(|w| w == message) {
            return;
        }
        state.warnings.push(message.to_owned());
        self.listener.iter().for_each(|listener| listener.warn(message));
        self.talk("warning", AnsiColor::Yellow, message);
    }

    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        let Some(folder) = &self.debug_folder else { return };
        let number = {
            let mut state = self.state();
            state.pictures += 1;
            state.pictures
        };
        let place = Destination::File { path: folder.join(format!("{number:02}-{name}.png")), force: false };
        let written = place.write(|out| vtex::output::png::encode_rgb(&draw(), out));
        if let Err(e) = written {
            self.state().failure.get_or_insert(e);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_never_goes_back_and_never_restarts() {
        let mut whole = TotalProgress::default();
        let (mut last, mut now) = (0.0, 0.0);
        let stages =
            ["reading", "merging regions", "primaries", "outlines", "structure", "unheard of", "writing"];
        for stage in stages.into_iter().chain(["drawing"; 3]) {
            whole.enter(stage, now);
            for steps in [(0, 0), (0, 4), (2, 4), (1, 4), (4, 4), (9, 4), (0, 0)] {
                whole.steps = steps;
                now += 0.1;
                let share = whole.share(now);
                assert!((last..=1.0).contains(&share), "{stage} {steps:?}: {last} {share}");
                last = share;
            }
        }
        assert!(last > 0.7, "{last}");
    }

    fn plan(finder: ElementFinder, size: [u32; 2], canvas: Option<f64>) -> Plan {
        Plan { finder: Some(finder), size, canvas }
    }

    /// Seconds by stage of runs of the released program, in the order of the plan's stages. Those of joining, outlines
    /// and categories are of a later one, in proportion to primaries.
    type Run = (&'static str, Plan, &'static [f64]);

    fn runs() -> Vec<Run> {
        vec![
            (
                "concrete, texture",
                plan(ElementFinder::Texton, [500, 500], Some(1.0)),
                &[
                    0.021, 0.149, 0.0, 1.373, 0.01, 0.042, 0.155, 0.247, 0.343, 0.227, 0.469, 0.124, 0.164,
                    0.897, 0.047, 0.277, 0.384,
                ],
            ),
            (
                "concrete, vectorize",
                plan(ElementFinder::Regions, [500, 500], None),
                &[0.019, 0.0, 0.0, 0.091, 0.254, 0.217, 0.275, 0.058, 0.057, 0.104],
            ),
            (
                "flowers, texture",
                plan(ElementFinder::Texton, [500, 500], Some(1.0)),
                &[
                    0.008, 0.054, 0.0, 1.218, 0.018, 0.051, 0.112, 0.219, 0.298, 0.282, 0.536, 0.103, 0.093,
                    0.753, 0.046, 0.234, 0.408,
                ],
            ),
            (
                "flowers, vectorize",
                plan(ElementFinder::Regions, [500, 500], None),
                &[0.025, 0.0, 0.0, 0.094, 0.31, 0.29, 0.763, 0.149, 0.104, 0.086],
            ),
            (
                "leaves, texture",
                plan(ElementFinder::Texton, [600, 500], Some(1.0)),
                &[
                    0.004, 0.066, 0.0, 1.705, 0.031, 0.097, 0.186, 0.288, 0.358, 0.368, 0.693, 0.129, 0.081,
                    0.748, 0.061, 0.354, 0.452,
                ],
            ),
            (
                "leaves, vectorize",
                plan(ElementFinder::Regions, [600, 500], None),
                &[0.019, 0.0, 0.0, 0.125, 0.37, 0.355, 0.721, 0.167, 0.109, 0.206],
            ),
            (
                "floor, texture",
                plan(ElementFinder::Texton, [1024, 1024], Some(1.0)),
                &[
                    0.022, 0.101, 0.0, 2.735, 0.831, 1.056, 1.294, 0.739, 1.562, 1.144, 5.975, 0.613, 0.312,
                    0.551, 0.465, 0.127, 0.392,
                ],
            ),
            (
                "floor, vectorize",
                plan(ElementFinder::Regions, [1024, 1024], None),
                &[0.073, 0.0, 0.0, 0.405, 1.14, 0.737, 3.453, 0.512, 0.313, 0.323],
            ),
            (
                "mud, texture",
                plan(ElementFinder::Texton, [1265, 926], Some(1.0)),
                &[
                    0.015, 0.07, 0.0, 3.268, 0.062, 0.212, 0.817, 1.031, 1.466, 0.813, 8.31, 2.36, 0.58,
                    0.351, 0.084, 0.543, 0.508,
                ],
            ),
            (
                "mud, vectorize",
                plan(ElementFinder::Regions, [1265, 926], None),
                &[0.081, 0.0, 0.0, 0.589, 1.591, 1.223, 4.382, 1.238, 0.387, 0.546],
            ),
            (
                "tile, texture",
                plan(ElementFinder::Texton, [500, 500], Some(1.0)),
                &[
                    0.008, 0.101, 0.0, 1.256, 0.035, 0.085, 0.172, 0.324, 0.357, 0.334, 0.515, 0.129, 0.076,
                    1.019, 0.192, 0.084, 0.311,
                ],
            ),
            (
                "concrete, texture of 9 megapixels",
                plan(ElementFinder::Texton, [500, 500], Some(9.0)),
                &[
                    0.011, 0.058, 0.0, 1.239, 0.015, 0.062, 0.127, 0.22, 0.261, 0.206, 0.357, 0.094, 0.125,
                    6.457, 0.597, 1.184, 3.266,
                ],
            ),
        ]
    }

    #[test]
    fn the_bar_follows_the_time_gone_by() {
        for (name, plan, seconds) in runs() {
            let stages = plan.stages();
            assert_eq!(stages.len(), seconds.len(), "{name}");
            // The speed of the machine differs from the measured one.
            for slower in [0.8, 1.0, 1.25] {
                let mut whole = TotalProgress::default();
                whole.enter("reading", 0.0);
                whole.plan(&plan);
                let total: f64 = seconds.iter().sum::<f64>() * slower;
                let mut begin = 0.0;
                for ((stage, _), own) in stages.iter().zip(seconds) {
                    whole.enter(stage, begin);
                    for k in 0..=20u32 {
                        let now = begin + own * slower * f64::from(k) / 20.0;
                        // The longest stage of the analysis reports its rounds.
                        whole.steps = if *stage == "joining" { (k.into(), 20) } else { (0, 0) };
                        let (shown, true_share) = (whole.share(now), now / total);
                        let apart = (shown - true_share).abs();
                        // The time of joining, the longest stage of vectorize, depends most on the photograph.
                        let most = if plan.canvas.is_some() { 0.17 } else { 0.2 };
                        assert!(apart <= most, "{name} x {slower}: {stage}: {shown:.3} at {true_share:.3}");
                    }
                    begin += own * slower;
                }
                assert!(whole.shown > 0.97, "{name}: it ends at {}", whole.shown);
            }
        }
    }

    /// When joining reports its steps, of 1000, in shares of its time: measured with a photograph of six megapixels.
    const JOINING: [(u64, f64); 10] = [
        (0, 0.0),
        (280, 0.41),
        (440, 0.5),
        (531, 0.57),
        (583, 0.63),
        (612, 0.665),
        (650, 0.715),
        (715, 0.765),
        (752, 0.79),
        (773, 0.8),
    ];

    #[test]
    fn the_bar_follows_the_rounds_of_joining() {
        let seconds = [
            0.49, 0.23, 0.15, 9.66, 0.04, 0.32, 0.85, 1.74, 2.74, 1.49, 7.22, 1.42, 0.48, 0.19, 0.04, 0.25,
            0.35,
        ];
        let plan = plan(ElementFinder::Texton, [1342, 894], Some(0.2));
        let total: f64 = seconds.iter().sum();
        let mut whole = TotalProgress::default();
        whole.enter("reading", 0.0);
        whole.plan(&plan);
        let mut begin = 0.0;
        for ((stage, _), own) in plan.stages().into_iter().zip(seconds) {
            whole.enter(stage, begin);
            for k in 0..=40 {
                let part = f64::from(k) / 40.0;
                let done = JOINING.iter().filter(|(_, since)| *since <= part).map(|step| step.0).max();
                whole.steps = if stage == "joining" { (done.unwrap_or(0), 1000) } else { (0, 0) };
                let (shown, true_share) = (whole.share(begin + own * part), (begin + own * part) / total);
                let apart = (shown - true_share).abs();
                assert!(apart <= 0.1, "{stage} {part}: {shown:.3} at {true_share:.3}");
            }
            begin += own;
        }
    }

    #[test]
    fn a_large_photograph_is_segmented_in_pieces_and_the_bar_moves_in_each() {
        let size = [4000, 3000];
        let plan = plan(ElementFinder::Texton, size, Some(1.0));
        let stages = plan.stages();
        let readings = stages.iter().filter(|stage| stage.0 == "reading the image").count();
        assert_eq!(readings, pieces(size).len());
        let mut whole = TotalProgress::default();
        whole.enter("reading", 0.0);
        whole.plan(&plan);
        let total: f64 = stages.iter().map(|stage| stage.1).sum();
        let mut begin = 0.0;
        for (stage, seconds) in stages {
            whole.enter(stage, begin);
            begin += seconds;
            let apart = (whole.share(begin) - begin / total).abs();
            assert!(apart < 0.05, "{stage}: {} at {}", whole.shown, begin / total);
        }
    }
}
