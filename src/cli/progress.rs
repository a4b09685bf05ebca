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
    /// Megapixels of the photograph at the size of the analysis.
    pub(crate) megapixels: f64,
    /// Megapixels of the canvas of a texture, if one is made.
    pub(crate) canvas: Option<f64>,
}

/// The segmenter of a photograph, as far as the duration depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ElementFinder {
    Texton,
    Regions,
}

/// Assumed megapixels of a photograph that was not read yet.
const USUAL: f64 = 0.8;

/// Seconds of a stage: of its own, and for each megapixel.
type Seconds = (&'static str, f64, f64);

/// Stages of segmentation with the network; measured, as those below, on two cores with photographs of .25 to
/// 1.2 megapixels and canvases of 1 and 9.
const TEXTON: [Seconds; 7] = [
    ("reading", 0.02, 0.0),
    ("loading", 0.08, 0.0),
    ("reading the image", 0.8, 2.1),
    ("finding masks: coarse grid", 0.02, 0.15),
    ("finding masks: fine grid", 0.0, 0.35),
    ("finding masks: finest grid", 0.05, 0.65),
    ("judging masks", 0.05, 0.8),
];
/// Stages of segmentation by merged regions.
const REGIONS: [Seconds; 2] = [("reading", 0.02, 0.0), ("merging regions", 0.02, 0.45)];
/// The remaining stages of the analysis.
const ANALYSIS: [Seconds; 5] = [
    ("primaries", 0.05, 1.15),
    ("details", 0.06, 0.75),
    ("joining", 0.0, 0.06),
    ("outlines", 0.1, 2.2),
    ("categories", 0.02, 0.2),
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

impl Plan {
    /// Stages and the seconds that they are expected to take.
    fn stages(&self) -> Vec<(&'static str, f64)> {
        let megapixels = if self.megapixels > 0.0 { self.megapixels } else { USUAL };
        let of = |stages: &[Seconds], size: f64| -> Vec<(&'static str, f64)> {
            stages.iter().map(|&(name, own, each)| (name, own + each * size)).collect()
        };
        let mut all = match self.finder {
            Some(ElementFinder::Texton) => of(&TEXTON, megapixels),
            Some(ElementFinder::Regions) => of(&REGIONS, megapixels),
            None => Vec::new(),
        };
        if self.finder.is_some() {
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

    /// Sets the megapixels of the photograph of the plan, and those of the analysis.
    pub(crate) fn learn(&self, megapixels: f64, analysed: f64) {
        let Some(plan) = self.state().plan else { return };
        // A texture is placed on the pixels of the analysis.
        let canvas = plan.canvas.map(|canvas| canvas * analysed / megapixels);
        self.whole().plan(&Plan { megapixels: analysed, canvas, ..plan });
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

    fn plan(finder: ElementFinder, megapixels: f64, canvas: Option<f64>) -> Plan {
        Plan { finder: Some(finder), megapixels, canvas }
    }

    /// Seconds by stage of runs of the released program, in the order of the plan's stages.
    type Run = (&'static str, Plan, &'static [f64]);

    fn runs() -> Vec<Run> {
        vec![
            (
                "concrete, texture",
                plan(ElementFinder::Texton, 0.25, Some(1.0)),
                &[
                    0.021, 0.149, 1.373, 0.01, 0.042, 0.155, 0.247, 0.343, 0.227, 0.009, 0.712, 0.078, 0.897,
                    0.047, 0.277, 0.384,
                ],
            ),
            (
                "concrete, vectorize",
                plan(ElementFinder::Regions, 0.25, None),
                &[0.019, 0.091, 0.254, 0.217, 0.008, 0.583, 0.086, 0.104],
            ),
            (
                "flowers, texture",
                plan(ElementFinder::Texton, 0.25, Some(1.0)),
                &[
                    0.008, 0.054, 1.218, 0.018, 0.051, 0.112, 0.219, 0.298, 0.282, 0.014, 0.546, 0.05, 0.753,
                    0.046, 0.234, 0.408,
                ],
            ),
            (
                "flowers, vectorize",
                plan(ElementFinder::Regions, 0.25, None),
                &[0.025, 0.094, 0.31, 0.29, 0.016, 0.578, 0.079, 0.086],
            ),
            (
                "leaves, texture",
                plan(ElementFinder::Texton, 0.3, Some(1.0)),
                &[
                    0.004, 0.066, 1.705, 0.031, 0.097, 0.186, 0.288, 0.358, 0.368, 0.017, 0.926, 0.068,
                    0.748, 0.061, 0.354, 0.452,
                ],
            ),
            (
                "leaves, vectorize",
                plan(ElementFinder::Regions, 0.3, None),
                &[0.019, 0.125, 0.37, 0.355, 0.02, 0.913, 0.123, 0.206],
            ),
            (
                "floor, texture",
                plan(ElementFinder::Texton, 1.049, Some(1.0)),
                &[
                    0.022, 0.101, 2.735, 0.831, 1.056, 1.294, 0.739, 1.562, 1.144, 0.345, 2.414, 0.199,
                    0.551, 0.465, 0.127, 0.392,
                ],
            ),
            (
                "floor, vectorize",
                plan(ElementFinder::Regions, 1.049, None),
                &[0.073, 0.405, 1.14, 0.737, 0.045, 1.611, 0.21, 0.323],
            ),
            (
                "mud, texture",
                plan(ElementFinder::Texton, 1.171, Some(1.0)),
                &[
                    0.015, 0.07, 3.268, 0.062, 0.212, 0.817, 1.031, 1.466, 0.813, 0.073, 3.344, 0.211, 0.351,
                    0.084, 0.543, 0.508,
                ],
            ),
            (
                "mud, vectorize",
                plan(ElementFinder::Regions, 1.171, None),
                &[0.081, 0.589, 1.591, 1.223, 0.09, 3.514, 0.477, 0.546],
            ),
            (
                "tile, texture",
                plan(ElementFinder::Texton, 0.25, Some(1.0)),
                &[
                    0.008, 0.101, 1.256, 0.035, 0.085, 0.172, 0.324, 0.357, 0.334, 0.031, 0.301, 0.071,
                    1.019, 0.192, 0.084, 0.311,
                ],
            ),
            (
                "concrete, texture of 9 megapixels",
                plan(ElementFinder::Texton, 0.25, Some(9.0)),
                &[
                    0.011, 0.058, 1.239, 0.015, 0.062, 0.127, 0.22, 0.261, 0.206, 0.006, 0.596, 0.046, 6.457,
                    0.597, 1.184, 3.266,
                ],
            ),
        ]
    }

    #[test]
    fn the_bar_is_within_a_tenth_of_the_time_gone_by() {
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
                    for k in 0..=20 {
                        let now = begin + own * slower * f64::from(k) / 20.0;
                        let (shown, true_share) = (whole.share(now), now / total);
                        let apart = (shown - true_share).abs();
                        // The time of outlines, the longest stage of vectorize, depends most on the
                        // photograph.
                        let most = if plan.canvas.is_some() { 0.1 } else { 0.15 };
                        assert!(apart <= most, "{name} x {slower}: {stage}: {shown:.3} at {true_share:.3}");
                    }
                    begin += own * slower;
                }
                assert!(whole.shown > 0.97, "{name}: it ends at {}", whole.shown);
            }
        }
    }
}
