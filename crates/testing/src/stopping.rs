//! Observers that ask a stage to stop.

use std::sync::atomic::{AtomicUsize, Ordering};
use vtex_base::error::{Error, Result};
use vtex_base::progress::Progress;

/// Asks to stop at the first report.
pub struct StopAtOnce;

impl Progress for StopAtOnce {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        false
    }
}

/// Asks to stop after a number of reports, and counts all reports.
pub struct StopAfter {
    most: usize,
    reports: AtomicUsize,
}

impl StopAfter {
    /// Asks after `most` reports.
    pub fn new(most: usize) -> Self {
        Self { most, reports: AtomicUsize::new(0) }
    }

    /// The number of reports so far.
    pub fn reports(&self) -> usize {
        self.reports.load(Ordering::SeqCst)
    }

    /// Checks that work reports at least `least` times, and ends soon after it is asked to stop at any of its
    /// reports.
    pub fn check<T>(least: usize, work: impl Fn(&dyn Progress) -> Result<T>) {
        let whole = Self::new(usize::MAX);
        assert!(work(&whole).is_ok());
        let all = whole.reports();
        assert!(all >= least, "{all} reports");
        for most in (0..all).step_by(all.div_ceil(25)) {
            let observer = Self::new(most);
            assert!(matches!(work(&observer), Err(Error::Interrupted)), "after {most} of {all}");
            // Each parallel task may report once more.
            assert!(observer.reports() <= most + 4, "{} after {most}", observer.reports());
        }
    }
}

impl Progress for StopAfter {
    fn advance(&self, _: &'static str, _: u64, _: u64) -> bool {
        self.reports.fetch_add(1, Ordering::SeqCst) < self.most
    }
}
