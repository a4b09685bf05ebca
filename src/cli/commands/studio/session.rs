//! The session: what is open, what was set, and what has been made of it. One thread does the long work; a
//! change stops it, and it goes on with what is wanted now.

use super::opened::Opened;
use super::results::{Thumbnail, WorkResults};
use super::settings::{SideFile, StudioSettings};
use crate::cli::failure::explain;
use crate::cli::format::numbered;
use crate::cli::interrupt;
use crate::cli::values::Seed;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use vtex_studio::EventHub;
use vtex_studio::elements::ElementMasks;

/// Most states that undo goes back over, and most bytes of files in them.
const HISTORY: usize = 200;
const HISTORY_BYTES: usize = 256 << 20;
/// Most bytes of files that are open. One more closes those that were opened first.
const OPEN_BYTES: usize = 1 << 30;
/// Changes of one thing within this time are one step of undo.
const ONE_CHANGE: Duration = Duration::from_millis(1500);
/// Endings of files that are drawn in the page.
pub(super) const MASKS: &str = "masks.json";
pub(super) const DENSITY: &str = "density.png";
pub(super) const DOMAIN: &str = "domain.svg";
/// Number of variants that the page shows.
pub(super) const VARIANTS: u64 = 6;

/// One thing that is worked on.
pub(super) struct WorkSession {
    /// A number that no other has.
    pub(super) id: u64,
    pub(super) opened: Arc<Opened>,
    /// What was set, from the beginning; and the index of what is set now.
    history: Vec<StudioSettings>,
    at: usize,
    last: Option<(String, Instant)>,
    pub(super) results: WorkResults,
    /// The masks of the elements that are shown, whether mended or found.
    pub(super) elements: Option<Arc<ElementMasks>>,
    /// Whether they are mended.
    shows_mended: bool,
    /// A number that no other elements have.
    pub(super) elements_version: u64,
    /// The outlines of the elements with a number, once they were asked for.
    pub(super) outlines: Option<(u64, Arc<Vec<String>>)>,
    /// Where what is drawn in the page is written, once that is known, by the ending.
    pub(super) drawn_paths: BTreeMap<&'static str, PathBuf>,
    /// Whether the page shows variants.
    pub(super) wants_variants: bool,
    pub(super) thumbnails: Vec<Thumbnail>,
    /// Why variants are missing.
    pub(super) variants_fault: Option<Fault>,
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
    /// Held while work is written to disk.
    keeping: Mutex<()>,
    ended: AtomicBool,
}

/// A number that was not given before.
pub(super) fn next_version() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl WorkSession {
    pub(super) fn new(opened: Opened, settings: StudioSettings, restored: bool) -> Self {
        let drawn = |(ending, file): (&'static str, Option<&Arc<SideFile>>)| {
            Some((ending, file.filter(|file| file.drawn)?.path.clone()))
        };
        let files = |name: &str| settings.files.get(name);
        let known =
            [(MASKS, settings.masks.as_ref()), (DENSITY, files("density")), (DOMAIN, files("domain"))];
        Self {
            id: next_version(),
            outlines: None,
            drawn_paths: known.into_iter().filter_map(drawn).collect(),
            elements: settings.elements.clone(),
            shows_mended: settings.elements.is_some(),
            variants_of: settings.seed,
            opened: Arc::new(opened),
            history: vec![settings],
            at: 0,
            last: None,
            results: WorkResults::default(),
            elements_version: next_version(),
            wants_variants: false,
            thumbnails: Vec::new(),
            variants_fault: None,
            restored,
            not_kept: None,
        }
    }

    /// What is set now.
    pub(super) fn settings(&self) -> &StudioSettings {
        &self.history[self.at]
    }

    pub(super) fn can_undo(&self) -> bool {
        self.at > 0
    }

    pub(super) fn can_redo(&self) -> bool {
        self.at + 1 < self.history.len()
    }

    /// Sets something else. `what` names what changed; changes of the same that follow at once are one step.
    pub(super) fn change(&mut self, what: &str, settings: StudioSettings) {
        if settings == *self.settings() {
            return;
        }
        let same = self.last.as_ref().is_some_and(|(last, at)| last == what && at.elapsed() < ONE_CHANGE);
        self.history.truncate(self.at + 1);
        if same && self.at > 0 {
            self.history[self.at] = settings;
        } else {
            self.history.push(settings);
            self.forget(HISTORY, HISTORY_BYTES);
            self.at = self.history.len() - 1;
        }
        self.last = (!what.is_empty()).then(|| (what.to_owned(), Instant::now()));
        self.follow();
    }

    /// Drops the oldest states beyond a number of them, and of bytes. The last two stay.
    fn forget(&mut self, states: usize, bytes: usize) {
        while self.history.len() > states || self.history.len() > 2 && self.bytes() > bytes {
            self.history.remove(0);
        }
    }

    /// Bytes of the files in all that was set.
    fn bytes(&self) -> usize {
        let before = std::iter::once(None).chain(self.history.iter().map(Some));
        self.history.iter().zip(before).map(|(settings, before)| settings.bytes_beyond(before)).sum()
    }

    /// Where a file that is drawn in the page is written: a name that nothing else has.
    pub(super) fn drawn_path(&mut self, ending: &'static str) -> PathBuf {
        let first = self.opened.beside(&format!(".{ending}"));
        let free = || {
            let mut all = std::iter::once(first.clone()).chain((2..=100).map(|n| numbered(&first, n)));
            all.find(|path| !path.exists()).unwrap_or(first)
        };
        self.drawn_paths.entry(ending).or_insert_with(free).clone()
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
        let mended = self.settings().elements.clone();
        let shown_are_mended = self.shows_mended;
        self.shows_mended = mended.is_some();
        // Without mended ones, those that were found stay until an analysis finds others.
        if (mended.is_some() || shown_are_mended) && mended != self.elements {
            self.elements = mended;
            self.elements_version = next_version();
        }
        self.variants_fault = None;
        self.thumbnails.retain(|thumbnail| thumbnail.is_of(&self.history[self.at]));
    }
}

impl Work {
    /// Adds what was opened, and makes it the active one. Where too much is open, what was opened first is closed;
    /// its work is on disk.
    pub(super) fn open(&mut self, one: WorkSession) {
        self.sessions.push(one);
        let bytes =
            |one: &WorkSession| one.opened.bytes.len() + one.opened.picture.as_ref().map_or(0, Vec::len);
        while self.sessions.len() > 1 && self.sessions.iter().map(bytes).sum::<usize>() > OPEN_BYTES {
            self.sessions.remove(0);
        }
        self.active = self.sessions.len() - 1;
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
            keeping: Mutex::new(()),
            ended: AtomicBool::new(false),
        }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, Work> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the work of a session to disk as it is then, so that the last one to write has the newest.
    pub(super) fn keep(&self, id: u64) {
        let _one_at_a_time = self.keeping.lock().unwrap_or_else(PoisonError::into_inner);
        let found = |work: &Work| work.sessions.iter().position(|one| one.id == id);
        let (opened, settings) = {
            let work = self.state();
            let Some(at) = found(&work) else { return };
            (Arc::clone(&work.sessions[at].opened), work.sessions[at].settings().clone())
        };
        let fault = settings.keep(&opened).err().map(|e| Fault::of(&e.into()).error);
        let mut work = self.state();
        if let Some(at) = found(&work) {
            work.sessions[at].not_kept = fault;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn session() -> WorkSession {
        WorkSession::new(Opened::picture("a.png".into()), StudioSettings::new(None), false)
    }

    fn with_size(size: &str) -> StudioSettings {
        StudioSettings {
            options: BTreeMap::from([("size".into(), size.into())]),
            ..StudioSettings::new(None)
        }
    }

    #[test]
    fn changes_of_one_thing_at_once_are_one_step_back() {
        let mut session = session();
        session.change("size", with_size("1"));
        session.change("size", with_size("2"));
        session.change("seed", StudioSettings { seed: 7, ..with_size("2") });
        session.change("seed", StudioSettings { seed: 7, ..with_size("2") });
        assert!(session.step(true) && session.settings() == &with_size("2"));
        assert!(
            session.step(true) && session.settings() == &StudioSettings::new(None) && !session.step(true)
        );
        assert!(session.step(false) && session.step(false) && !session.step(false));
        assert!(session.step(true));
        session.change("", with_size("9"));
        assert!(!session.can_redo() && session.can_undo());
        for size in 0..300 {
            session.change("", with_size(&size.to_string()));
        }
        assert_eq!(session.history.len(), HISTORY);
    }

    #[test]
    fn undo_holds_no_more_bytes_than_it_may() {
        let mut session = session();
        for k in 0..6 {
            let file = Arc::new(SideFile::new("map.png".into(), vec![k; 1000]));
            let with_file =
                StudioSettings { files: BTreeMap::from([("density".into(), file)]), ..with_size("9") };
            session.change("", with_file.clone());
            // The same file counts once.
            session.change("", StudioSettings { seed: 7, ..with_file });
        }
        assert_eq!(session.bytes(), 12_000);
        session.forget(HISTORY, 6000);
        assert_eq!((session.bytes(), session.history.len()), (6000, 6));
        session.forget(HISTORY, 0);
        assert_eq!(session.history.len(), 2);
    }
}
