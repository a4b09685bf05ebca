//! Work away from the interpreter: detached from its lock, on threads of its own, with progress, warnings
//! and signals carried between the two.
//!
//! The calling thread waits for news of the work: it calls the progress function, and looks for signals every
//! 20 ms. So exceptions and Ctrl-C arrive in that thread.
//!
//! Every call has its own threads, which end with it. So a process may fork between calls, calls from
//! several threads do not wait for one another, and nothing runs at exit.

use crate::errors;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::available_parallelism;
use std::time::Duration;
use vtex::Progress;

/// Interval between checks for signals.
const POLL: Duration = Duration::from_millis(20);
/// Stack of a thread: as much as a program's first thread has.
const STACK: usize = 8 << 20;
/// Most threads.
const MOST: usize = 1024;

/// Number of threads; 0 for the default.
static THREADS: AtomicUsize = AtomicUsize::new(0);

/// Sets the number of threads of each call; `None` for the default.
#[pyfunction]
pub(crate) fn set_threads(py: Python<'_>, number: Option<usize>) -> PyResult<()> {
    if let Some(number) = number.filter(|n| !(1..=MOST).contains(n)) {
        return Err(errors::input(py, &format!("threads = {number} is out of range: 1 to {MOST}"), None));
    }
    THREADS.store(number.unwrap_or(0), Ordering::Relaxed);
    Ok(())
}

/// The number of threads of each call.
#[pyfunction]
pub(crate) fn threads() -> usize {
    let cores = || available_parallelism().map_or(1, usize::from);
    let asked = || std::env::var("VTEX_THREADS").ok()?.parse().ok().filter(|n| (1..=MOST).contains(n));
    match THREADS.load(Ordering::Relaxed) {
        0 => asked().unwrap_or_else(cores),
        number => number,
    }
}

/// News of the work.
enum News {
    Advance(&'static str, u64, u64),
    Warning(String),
}

/// Sends news of the work to the interpreter's thread, which may request a stop.
struct Listener<'a> {
    news: Sender<News>,
    stop: &'a AtomicBool,
    /// Whether steps are reported.
    watched: bool,
}

impl Progress for Listener<'_> {
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        if self.watched {
            // Without a receiver, news is discarded.
            let _ = self.news.send(News::Advance(stage, done, total));
        }
        !self.stop.load(Ordering::Relaxed)
    }

    fn warn(&self, message: &str) {
        let _ = self.news.send(News::Warning(message.to_owned()));
    }
}

/// Runs work detached from the interpreter. `progress` is called in the caller's thread with the stage, the
/// steps done and the number of steps. Exceptions of `progress` and of signal handlers stop the work and are
/// raised here.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&dyn Progress) -> vtex::Result<T> + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let mut outcome = None;
    let mut raised = None;
    let mut warnings = Vec::new();
    let built = py.detach(|| {
        let pool = ThreadPoolBuilder::new().num_threads(threads()).stack_size(STACK).build();
        pool.map(|pool| {
            let (news, inbox) = channel();
            let listener = Listener { news, stop: &stop, watched: progress.is_some() };
            pool.in_place_scope(|scope| {
                let outcome = &mut outcome;
                scope.spawn(move |_| *outcome = Some(work(&listener)));
                loop {
                    let heard = match inbox.recv_timeout(POLL) {
                        Ok(News::Warning(message)) => {
                            warnings.push(message);
                            continue;
                        }
                        Ok(News::Advance(stage, done, total)) => match &progress {
                            // After a stop, news is discarded.
                            Some(progress) if !stop.load(Ordering::Relaxed) => {
                                Python::attach(|py| tell(py, progress, stage, done, total))
                            }
                            _ => continue,
                        },
                        Err(RecvTimeoutError::Timeout) => {
                            Python::attach(|py| py.check_signals()).map(|()| true)
                        }
                        Err(RecvTimeoutError::Disconnected) => break,
                    };
                    match heard {
                        Ok(true) => continue,
                        Ok(false) => {}
                        Err(error) => raised = raised.take().or(Some(error)),
                    }
                    stop.store(true, Ordering::Relaxed);
                }
            });
        })
    });
    built.map_err(|e| errors::engine(py, &format!("threads cannot be started: {e}")))?;
    if let Some(error) = raised {
        return Err(error);
    }
    for message in warnings {
        warn(py, &message)?;
    }
    match outcome {
        Some(outcome) => outcome.map_err(|error| errors::raised(py, &error)),
        None => Err(errors::engine(py, "the work ended without a result")),
    }
}

/// Calls the progress function; `false` if it asks to stop.
fn tell(py: Python<'_>, progress: &Py<PyAny>, stage: &str, done: u64, total: u64) -> PyResult<bool> {
    let answer = progress.bind(py).call1((stage, done, total))?;
    // `None`, the result of a function without `return`, means to continue.
    py.check_signals()?;
    if answer.is_none() { Ok(true) } else { answer.is_truthy() }
}

/// Issues a warning at the line that called the package.
pub(crate) fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    py.import("vtex._errors")?.getattr("warn")?.call1((message,)).map(drop)
}
