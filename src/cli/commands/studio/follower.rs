//! Progress of the long work, for the page, and the end of work that is no longer wanted.

use super::results::Key;
use super::session::Session;
use super::stages::analysis_key;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use vtex::Progress;

/// How often the page hears of progress at most.
const PROGRESS: Duration = Duration::from_millis(80);

/// Passes progress on to the page, and stops work that is no longer wanted.
pub(super) struct Follower {
    session: Arc<Session>,
    version: u64,
    /// The analysis that is done, if it is one: it goes on while that is wanted.
    analysis: Option<Key>,
    /// The stage that was told last, and when.
    told: Mutex<(&'static str, Option<Instant>)>,
}

impl Follower {
    pub(super) fn new(session: &Arc<Session>, version: u64) -> Self {
        Self { session: Arc::clone(session), version, analysis: None, told: Mutex::new(("", None)) }
    }

    /// One of an analysis, which other changes than those of the analysis do not stop.
    pub(super) fn of_analysis(session: &Arc<Session>, version: u64, key: Key) -> Self {
        Self { analysis: Some(key), ..Self::new(session, version) }
    }

    fn is_wanted(&self) -> bool {
        if self.version == self.session.version() {
            return true;
        }
        let work = self.session.state();
        let one = &work.sessions[work.active];
        !work.rests
            && self.analysis.as_ref().is_some_and(|key| *key == analysis_key(&one.opened, one.settings()))
    }
}

impl Progress for Follower {
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.0 != stage || told.1.is_none_or(|at| at.elapsed() > PROGRESS) {
            *told = (stage, Some(Instant::now()));
            let progress = serde_json::json!({ "stage": stage, "done": done, "total": total });
            self.session.events.send("progress", &progress.to_string());
        }
        drop(told);
        !self.session.has_ended() && self.is_wanted()
    }

    fn warn(&self, message: &str) {
        let mut work = self.session.state();
        if !work.warnings.iter().any(|known| known == message) {
            work.warnings.push(message.to_owned());
        }
    }
}
