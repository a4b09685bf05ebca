//! What the user sees while work goes on: bars, warnings, pictures of the stages.

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
    stage: &'static str,
    since: Instant,
    seconds: Vec<(&'static str, Duration)>,
    warnings: Vec<String>,
    pictures: u32,
    /// The first picture that could not be written.
    failure: Option<Error>,
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
        let new = state.stage != stage;
        if new {
            state.enter(stage);
            self.bar.reset();
        }
        if total > 0 {
            self.bar.set_length(total);
        }
        if new {
            let known = "{spinner} {msg:12} [{bar:32}] {human_pos}/{human_len} {eta}";
            let template = if total > 1 { known } else { "{spinner} {msg}" };
            let style =
                ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
            self.bar.set_style(style.progress_chars("=> "));
            self.bar.set_message(stage);
        }
        self.bar.set_position(done);
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
