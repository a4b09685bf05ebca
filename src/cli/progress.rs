//! Progress for the user: bars, warnings, pictures of the stages.

use super::common::Common;
use super::failure::label;
use super::foreign::line;
use super::interrupt;
use super::output::{Place, say_styled};
use anstyle::AnsiColor;
use image::RgbImage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use vtex::{Error, Progress, Result};

/// Shows progress, keeps the time of each stage and all warnings, and stops the work on Ctrl-C.
pub(crate) struct Reporter {
    bar: ProgressBar,
    /// Whether warnings are printed as they come.
    talks: bool,
    debug_folder: Option<PathBuf>,
    state: Mutex<State>,
}

struct State {
    bar: Whole,
    stage: &'static str,
    since: Instant,
    seconds: Vec<(&'static str, Duration)>,
    warnings: Vec<String>,
    pictures: u32,
    /// The first picture that could not be written.
    failure: Option<Error>,
}

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Seconds of stages in their order, as photographs of a megapixel take them: what is before and what is
/// after a stage is known by it. Of what is not here nothing is known.
const STAGES: [(&str, f64); 28] = [
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

/// How far all the work is. It never goes back: a stage takes its part of what is left.
#[derive(Debug, Default)]
struct Whole {
    /// Share done before the stage, and share of the stage.
    before: f64,
    part: f64,
    /// The largest share shown.
    shown: f64,
}

impl Whole {
    /// Begins a stage: what stands before it in the table is over, what stands after it is to come.
    fn enter(&mut self, stage: &str) {
        self.before = self.shown;
        let left = 1.0 - self.before;
        let known = STAGES.iter().position(|(name, _)| *name == stage);
        let weight = known.map_or(1.0, |at| STAGES[at].1);
        // Of the stages that may come, half do.
        let after: f64 = known.map_or(4.0, |at| STAGES[at + 1..].iter().map(|s| s.1).sum::<f64>() / 2.0);
        self.part = left * weight / (weight + after);
    }

    /// The share done after a number of steps of the stage.
    fn share(&mut self, done: u64, total: u64) -> f64 {
        let within = if total > 0 { (done as f64 / total as f64).min(1.0) } else { 0.0 };
        self.shown = self.shown.max(self.before + within * self.part).min(1.0);
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
        let state = State {
            bar: Whole::default(),
            stage: "",
            since: Instant::now(),
            seconds: Vec::new(),
            warnings: Vec::new(),
            pictures: 0,
            failure: None,
        };
        Ok(Self {
            bar: ProgressBar::with_draw_target(Some(STEPS), target),
            talks,
            debug_folder: common.debug_folder.clone(),
            state: Mutex::new(state),
        })
    }

    /// Names what is done next.
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

    /// Says what may be tried.
    pub(crate) fn hint(&self, message: &str) {
        self.talk("hint", AnsiColor::Cyan, message);
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

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        // After an error the message must not stand beside the rest of a bar.
        self.bar.finish_and_clear();
    }
}

impl State {
    /// Books the time gone by on the stage that ends, and starts another.
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
                let style = ProgressStyle::with_template("{spinner} [{bar:32}] {percent:>3} % {msg}");
                let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
                self.bar.set_style(style.progress_chars("=> "));
                // The clock goes on in stages that report rarely.
                self.bar.enable_steady_tick(Duration::from_millis(120));
            }
            state.enter(stage);
            state.bar.enter(stage);
            self.bar.set_message(stage);
        }
        self.bar.set_position((state.bar.share(done, total) * STEPS as f64) as u64);
        state.failure.is_none() && !interrupt::asked()
    }

    fn warn(&self, message: &str) {
        let mut state = self.state();
        if state.warnings.iter().any(|w| w == message) {
            return;
        }
        state.warnings.push(message.to_owned());
        self.talk("warning", AnsiColor::Yellow, message);
    }

    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        let Some(folder) = &self.debug_folder else { return };
        let number = {
            let mut state = self.state();
            state.pictures += 1;
            state.pictures
        };
        let place = Place::File { path: folder.join(format!("{number:02}-{name}.png")), force: false };
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
        let mut whole = Whole::default();
        let mut last = 0.0;
        let stages =
            ["reading", "merging regions", "primaries", "outlines", "structure", "unheard of", "writing"];
        for stage in stages.into_iter().chain(["drawing"; 3]) {
            whole.enter(stage);
            for (done, total) in [(0, 0), (0, 4), (2, 4), (1, 4), (4, 4), (9, 4), (0, 0)] {
                let share = whole.share(done, total);
                assert!((last..=1.0).contains(&share), "{stage} {done}/{total}: {last} {share}");
                last = share;
            }
        }
        assert!(last > 0.7, "{last}");
        // A stage that takes most of the time gets most of the bar.
        let mut whole = Whole::default();
        whole.enter("tuning");
        assert!(whole.share(1, 1) > 0.8);
    }
}
