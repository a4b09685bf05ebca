//! The session: what is open, what was set, and what has been made of it. One thread does the long work; a
//! change stops it, and it goes on with what is wanted now.

use super::desk::{Desk, Opened};
use super::kept::{Kept, Key, Thumbnail};
use super::stages::analysis_key;
use crate::cli::failure::explain;
use crate::cli::interrupt;
use crate::cli::values::Seed;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use vtex::Progress;
use vtex_studio::EventHub;
use vtex_studio::elements::ElementMasks;

/// Most states that undo goes back over.
const HISTORY: usize = 200;
/// Changes of one thing within this time are one step of undo.
const ONE_CHANGE: Duration = Duration::from_millis(1500);
/// How often the page hears of progress at most.
const PROGRESS: Duration = Duration::from_millis(80);
/// Number of variants that the page shows.
pub(super) const VARIANTS: u64 = 6;

/// One thing that is worked on.
pub(super) struct WorkSession {
    pub(super) opened: Arc<Opened>,
    /// What was set, from the beginning; and the index of what is set now.
    history: Vec<Desk>,
    at: usize,
    last: Option<(String, Instant)>,
    pub(super) kept: Kept,
    /// The masks of the elements that are shown, whether mended or found.
    pub(super) elements: Option<Arc<ElementMasks>>,
    /// Whether they are mended.
    shows_mended: bool,
    /// A number that no other elements have.
    pub(super) elements_version: u64,
    /// Where mended masks are written, once that is known.
    pub(super) masks_path: Option<PathBuf>,
    /// Whether the page shows variants.
    pub(super) wants_variants: bool,
    pub(super) thumbnails: Vec<Thumbnail>,
    /// The seed before that of the first variant.
    pub(super) variants_of: u64,
    /// Whether the work of last time goes on.
    pub(super) restored: bool,
    /// Why work is not kept on disk.
    pub(super) not_kept: Option<String>,
}

/// What went wrong.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(super) struct Fault {
    pub(super) error: String,
    pub(super) hint: Option<String>,
}

impl Fault {
    pub(super) fn of(error: &anyhow::Error) -> Self {
        let (error, hint, _) = explain(error);
        Self { error, hint }
    }
}

/// The state of the session.
pub(super) struct Work {
    pub(super) sessions: Vec<WorkSession>,
    pub(super) active: usize,
    /// Whether the long work rests until something changes, because the user stopped it.
    pub(super) rests: bool,
    /// The last version for which the long work has ended.
    pub(super) done: u64,
    pub(super) fault: Option<Fault>,
    pub(super) warnings: Vec<String>,
}

/// The session, which the server and the working thread share.
pub(super) struct Session {
    state: Mutex<Work>,
    wake: Condvar,
    /// Counts up with every change; work for an older version stops.
    version: AtomicU64,
    pub(super) events: EventHub,
    pub(super) threads: Option<u16>,
    pub(super) seed: Option<Seed>,
    /// The folder of files that the page sends.
    pub(super) folder: PathBuf,
    ended: AtomicBool,
}

/// A number for elements that are shown.
pub(super) fn next_version() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl WorkSession {
    pub(super) fn new(opened: Opened, desk: Desk, restored: bool) -> Self {
        Self {
            masks_path: desk.masks.as_ref().map(|masks| masks.path.clone()),
            elements: desk.elements.clone(),
            shows_mended: desk.elements.is_some(),
            variants_of: desk.seed,
            opened: Arc::new(opened),
            history: vec![desk],
            at: 0,
            last: None,
            kept: Kept::default(),
            elements_version: next_version(),
            wants_variants: false,
            thumbnails: Vec::new(),
            restored,
            not_kept: None,
        }
    }

    /// What is set now.
    pub(super) fn desk(&self) -> &Desk {
        &self.history[self.at]
    }

    pub(super) fn can_undo(&self) -> bool {
        self.at > 0
    }

    pub(super) fn can_redo(&self) -> bool {
        self.at + 1 < self.history.len()
    }

    /// Sets something else. `what` names what changed; changes of the same that follow at once are one step.
    pub(super) fn change(&mut self, what: &str, desk: Desk) {
        if desk == *self.desk() {
            return;
        }
        let same = self.last.as_ref().is_some_and(|(last, at)| last == what && at.elapsed() < ONE_CHANGE);
        self.history.truncate(self.at + 1);
        if same && self.at > 0 {
            self.history[self.at] = desk;
        } else {
            self.history.push(desk);
            if self.history.len() > HISTORY {
                self.history.remove(0);
            }
            self.at = self.history.len() - 1;
        }
        self.last = (!what.is_empty()).then(|| (what.to_owned(), Instant::now()));
        self.follow();
    }

    /// Goes a step back, or forward.
    pub(super) fn step(&mut self, back: bool) -> bool {
        let possible = if back { self.can_undo() } else { self.can_redo() };
        if possible {
            self.at = if back { self.at - 1 } else { self.at + 1 };
            self.last = None;
            self.follow();
        }
        possible
    }

    /// Shows the mended elements, as soon as they are.
    fn follow(&mut self) {
        let mended = self.desk().elements.clone();
        let shown_are_mended = self.shows_mended;
        self.shows_mended = mended.is_some();
        // Without mended ones, those that were found stay until an analysis finds others.
        if (mended.is_some() || shown_are_mended) && mended != self.elements {
            self.elements = mended;
            self.elements_version = next_version();
        }
        self.thumbnails.retain(|thumbnail| thumbnail.is_of(&self.history[self.at]));
    }

    /// Writes the work to disk.
    pub(super) fn keep(&mut self) {
        self.not_kept = self.desk().keep(&self.opened).err().map(|e| Fault::of(&e.into()).error);
    }
}

impl Session {
    pub(super) fn new(
        sessions: Vec<WorkSession>,
        threads: Option<u16>,
        seed: Option<Seed>,
        folder: PathBuf,
    ) -> Self {
        let work = Work { sessions, active: 0, rests: false, done: 0, fault: None, warnings: Vec::new() };
        Self {
            state: Mutex::new(work),
            wake: Condvar::new(),
            version: AtomicU64::new(1),
            events: EventHub::default(),
            threads,
            seed,
            folder,
            ended: AtomicBool::new(false),
        }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, Work> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends all work.
    pub(super) fn end(&self) {
        self.ended.store(true, Ordering::SeqCst);
        self.wake.notify_all();
    }

    /// Whether the work ends.
    pub(super) fn has_ended(&self) -> bool {
        interrupt::is_requested() || self.ended.load(Ordering::SeqCst)
    }

    /// The version of what is wanted.
    pub(super) fn version(&self) -> u64 {
        self.version.load(Ordering::SeqCst)
    }

    /// Something was changed: the long work begins anew, with what is kept of it.
    pub(super) fn changed(&self, work: &mut Work) {
        self.version.fetch_add(1, Ordering::SeqCst);
        (work.rests, work.fault) = (false, None);
        self.wake.notify_all();
    }

    /// Stops the long work until something changes.
    pub(super) fn cancel(&self) {
        let mut work = self.state();
        if work.done < self.version() {
            self.version.fetch_add(1, Ordering::SeqCst);
            work.rests = true;
        }
    }

    /// Waits until there is something to do, and gives its version; `None` when the program ends.
    pub(super) fn wait(&self) -> Option<u64> {
        let mut work = self.state();
        loop {
            if self.has_ended() {
                return None;
            }
            let version = self.version();
            if work.done < version && !work.rests && !work.sessions.is_empty() {
                work.warnings.clear();
                return Some(version);
            }
            let waited = self.wake.wait_timeout(work, Duration::from_millis(200));
            work = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Tells the pages that the state has changed.
    pub(super) fn tell(&self) {
        self.events.send("changed", "{}");
    }

    /// Changes the state on behalf of the work for a version, unless something else is wanted by now.
    pub(super) fn publish(&self, version: u64, change: impl FnOnce(&mut Work, usize)) -> bool {
        let mut work = self.state();
        let current = version == self.version();
        if current {
            let active = work.active;
            change(&mut work, active);
        }
        current
    }
}

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
        !work.rests && self.analysis.as_ref().is_some_and(|key| *key == analysis_key(&one.opened, one.desk()))
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn session() -> WorkSession {
        let mut png = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(40, 40, |x, y| image::Rgb([x as u8, y as u8, 9]));
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        WorkSession::new(Opened::new("a.png".into(), png.into_inner()).unwrap(), Desk::new(None), false)
    }

    fn with_size(size: &str) -> Desk {
        Desk { options: BTreeMap::from([("size".into(), size.into())]), ..Desk::new(None) }
    }

    #[test]
    fn changes_of_one_thing_at_once_are_one_step_back() {
        let mut session = session();
        session.change("size", with_size("1"));
        session.change("size", with_size("2"));
        session.change("seed", Desk { seed: 7, ..with_size("2") });
        session.change("seed", Desk { seed: 7, ..with_size("2") });
        assert!(session.step(true) && session.desk() == &with_size("2"));
        assert!(session.step(true) && session.desk() == &Desk::new(None) && !session.step(true));
        assert!(session.step(false) && session.step(false) && !session.step(false));
        assert!(session.step(true));
        session.change("", with_size("9"));
        assert!(!session.can_redo() && session.can_undo());
        for size in 0..300 {
            session.change("", with_size(&size.to_string()));
        }
        assert_eq!(session.history.len(), HISTORY);
    }
}
