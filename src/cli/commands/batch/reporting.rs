//! Reports on how jobs ended.

use super::record::{Record, Status};
use crate::cli::common::Common;
use crate::cli::failure::label;
use crate::cli::foreign::{escaped, line};
use crate::cli::output::{print, say, say_styled};
use crate::cli::summary::bytes as show_bytes;
use crate::cli::table::table;
use anstyle::AnsiColor;
use serde::Serialize;

/// All jobs together, the last line of `--json`.
#[derive(Serialize)]
pub(super) struct Total {
    pub(super) program: &'static str,
    pub(super) command: &'static str,
    pub(super) shard: String,
    pub(super) jobs: usize,
    pub(super) done: usize,
    pub(super) skipped: usize,
    pub(super) failed: usize,
    pub(super) seconds: f64,
}

impl Total {
    /// Prints the outcome of all jobs: a line of JSON, or a table.
    pub(super) fn print(&self, common: &Common, records: &[Record]) -> anyhow::Result<()> {
        if common.json {
            return print(format!("{}\n", serde_json::to_string(self)?).as_bytes());
        }
        if common.quiet {
            return Ok(());
        }
        let head = ["job", "seconds", "size", "primaries", "coverage", "wanted", "bytes", ""];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(records.iter().map(row));
        say_styled(&format!("\n{}", table(&rows)));
        let Self { done, skipped, failed, .. } = self;
        let left = self.jobs - done - skipped - failed;
        let left = if left > 0 { format!(", {left} not begun or not ended") } else { String::new() };
        say(&format!(
            "{done} done, {skipped} skipped (done before), {failed} failed{left} in {:.1} s",
            self.seconds
        ));
        Ok(())
    }
}

/// Prints the outcome of a job.
pub(super) fn print_record(common: &Common, record: &Record) -> anyhow::Result<()> {
    if common.json {
        return print(format!("{}\n", serde_json::to_string(record)?).as_bytes());
    }
    if let Some(error) = &record.error {
        let (red, cyan) = (label(AnsiColor::Red), label(AnsiColor::Cyan));
        say_styled(&format!("{red}error:{red:#} {}: {}", escaped(&record.input), line(error)));
        if let Some(hint) = &record.hint {
            say_styled(&format!("{cyan}hint:{cyan:#} {}", line(hint)));
        }
    }
    Ok(())
}

/// A row of the table.
fn row(record: &Record) -> Vec<String> {
    let share = |k: usize| record.coverage.map_or(String::new(), |c| format!("{:.3}", c[k]));
    let bytes: u64 = record.outputs.iter().map(|w| w.bytes).sum();
    let status = match record.status {
        Status::Done => "done",
        Status::Skipped => "skipped",
        Status::Failed => "failed",
    };
    vec![
        escaped(&record.job),
        format!("{:.2}", record.seconds),
        record.size.map_or(String::new(), |[w, h]| format!("{w} x {h}")),
        record.primaries.map_or(String::new(), |n| n.to_string()),
        share(1),
        share(0),
        if bytes > 0 { show_bytes(bytes) } else { String::new() },
        status.to_owned(),
    ]
}

pub(super) fn thousandths(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}
