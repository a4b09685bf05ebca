//! Measurements in child processes, and tables; shared by the benchmarks and the placement study.

use serde_json::Value;
use std::error::Error;
use std::ffi::OsStr;
use std::process::Command;
use std::sync::Mutex;
use vtex::Progress;

/// First argument of a child process.
pub(crate) const MEASURE: &str = "--measure";

pub(crate) type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Runs one measurement in a child process, on `threads` threads or on all cores.
pub(crate) fn child(arguments: &[&OsStr], threads: Option<u32>) -> Outcome<Value> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg(MEASURE).args(arguments);
    if let Some(threads) = threads {
        command.env("RAYON_NUM_THREADS", threads.to_string());
    }
    let output = command.output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// CPU seconds by stage. A stage lasts until the next one is named.
pub(crate) struct Watch(Mutex<(Vec<(String, f64)>, f64)>);

impl Watch {
    pub(crate) fn start(stage: &str) -> Self {
        Self(Mutex::new((vec![(stage.into(), 0.0)], cpu_seconds())))
    }

    pub(crate) fn next(&self, stage: &str) {
        let mut state = self.0.lock().expect("no measurement panics");
        let (stages, since) = &mut *state;
        let now = cpu_seconds();
        if let Some(last) = stages.last_mut() {
            last.1 += now - *since;
        }
        *since = now;
        if stages.last().is_none_or(|last| last.0 != stage) {
            stages.push((stage.into(), 0.0));
        }
    }

    /// The stages in order, without duplicates.
    pub(crate) fn stop(self) -> Vec<Stage> {
        self.next("");
        let (times, _) = self.0.into_inner().expect("no measurement panics");
        let mut stages: Vec<Stage> = Vec::new();
        for (stage, seconds) in times.into_iter().filter(|s| !s.0.is_empty()) {
            match stages.iter_mut().find(|s| s.stage == stage) {
                Some(known) => known.seconds += seconds,
                None => stages.push(Stage { stage, seconds }),
            }
        }
        stages
    }
}

/// CPU seconds of a stage.
#[derive(serde::Serialize)]
pub(crate) struct Stage {
    pub(crate) stage: String,
    pub(crate) seconds: f64,
}

/// Seconds of all stages before the stage `before`.
pub(crate) fn sum(stages: &[Stage], before: &str) -> f64 {
    stages.iter().take_while(|s| s.stage != before).map(|s| s.seconds).sum()
}

impl Progress for Watch {
    fn advance(&self, stage: &'static str, _: u64, _: u64) -> bool {
        self.next(stage);
        true
    }
}

/// CPU time of this process, user and system, of all threads.
pub(crate) fn cpu_seconds() -> f64 {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    }
    #[cfg(not(unix))]
    {
        f64::NAN
    }
}

/// Peak memory of this process so far, in bytes; `None` if the system does not report it.
pub(crate) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kibibytes * 1024)
}

pub(crate) fn row(cells: impl IntoIterator<Item = String>) -> String {
    let cells: Vec<String> = cells.into_iter().collect();
    format!("| {} |\n", cells.join(" | "))
}

pub(crate) fn seconds(value: &Value) -> String {
    value.as_f64().map_or("–".into(), |v| format!("{v:.2}"))
}

pub(crate) fn kilo(value: &Value) -> String {
    value.as_f64().map_or("–".into(), |v| format!("{:.0}", v / 1e3))
}

pub(crate) fn mega(value: &Value) -> String {
    value.as_f64().map_or("–".into(), |v| format!("{:.0}", v / 1e6))
}
