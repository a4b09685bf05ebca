//! `vtex doctor`: the engines for networks, the models, and missing files.

use super::models::show;
use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::foreign::escaped;
use crate::cli::models::{Model, ModelFolder};
use crate::cli::options::common;
use crate::cli::options::engine::{EngineArgs, engine};
use crate::cli::output::{print_json, print_styled};
use anstyle::Style;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use vtex::engine::{EngineChoice, EngineOptions, GIVEN, MINIMUM_MINOR, choose, locate};

/// Check the neural-network runtimes and models
#[derive(Args)]
#[command(
    mut_args(common(&["engine"])),
    after_long_help = "\
Examples:
  vtex doctor
  vtex doctor --onnxruntime /opt/onnxruntime/lib/libonnxruntime.so --json"
)]
pub(crate) struct DoctorArgs {
    #[command(flatten)]
    pub(crate) engine: EngineArgs,
}

impl Arguments for DoctorArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let options = engine(self.engine, resolved.parameters.threads);
        Ok(Box::new(move |common, _| run(common, &options)))
    }
}

#[derive(Serialize)]
struct DoctorReport {
    program: &'static str,
    command: &'static str,
    /// `ONNX Runtime` or `rten`; `None` if the chosen engine is not available.
    #[serde(skip_serializing_if = "Option::is_none")]
    engine: Option<&'static str>,
    /// Version of ONNX Runtime.
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    library: Option<PathBuf>,
    /// The places where the shared library was searched, with the result of each.
    libraries: Vec<CandidateReport>,
    threads: usize,
    models_folder: Option<PathBuf>,
    models: Vec<Model>,
    missing: Vec<String>,
}

#[derive(Serialize)]
struct CandidateReport {
    path: PathBuf,
    by: &'static str,
}

fn run(common: &Common, options: &EngineOptions) -> anyhow::Result<()> {
    let report = examine(options);
    if common.json {
        return print_json(&report, false);
    }
    print_styled(&report.show())
}

fn examine(options: &EngineOptions) -> DoctorReport {
    let found = locate(options.library.as_deref());
    let libraries = found
        .into_iter()
        .map(|f| CandidateReport { path: f.path, by: if f.by == GIVEN { "--onnxruntime" } else { f.by } })
        .collect();
    let mut missing = Vec::new();
    let how = format!(
        "only networks of Segment Anything gain by it; 'pip install onnxruntime' brings it; version 1.{MINIMUM_MINOR} or newer serves; name its library with --onnxruntime if it is not found"
    );
    let (engine, version, library) = match choose(options) {
        Ok(EngineChoice::OnnxRuntime { library, version }) => {
            (Some("ONNX Runtime"), Some(version), Some(library))
        }
        Ok(EngineChoice::Rten { because }) => {
            missing.extend(because.map(|reason| format!("{reason}: {how}")));
            (Some("rten"), None, None)
        }
        Err(e) => {
            missing.push(format!("{e}: {how}"));
            (None, None, None)
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let (mut models_folder, mut models) = (None, Vec::new());
    match ModelFolder::open() {
        Ok(store) => {
            match store.models() {
                Ok(found) => models = found,
                Err(e) => missing.push(e.to_string()),
            }
            models_folder = Some(store.folder().to_owned());
        }
        Err(e) => missing.push(e.to_string()),
    }
    if models.is_empty() {
        missing.push(
            "no model for --segmenter sam: export one of SAM, MobileSAM, EfficientSAM or SAM 2 to ONNX and add it with 'vtex models add encoder.onnx decoder.onnx --name NAME'"
                .into(),
        );
    }
    DoctorReport {
        program: vtex::PROGRAM,
        command: "doctor",
        engine,
        version,
        library,
        libraries,
        threads: options.threads.unwrap_or(cores),
        models_folder,
        models,
        missing,
    }
}

impl DoctorReport {
    /// Prints the report as text.
    fn show(&self) -> String {
        let head = Style::new().bold();
        let mut text = format!("{head}{}{head:#}\n\n", self.program);
        let mut line =
            |name: &str, value: &str| text.push_str(&format!("{head}{name:12}{head:#} {}\n", escaped(value)));
        let version = self.version.iter().map(|v| format!(" {v}")).collect::<String>();
        line("engine", &format!("{}{version}", self.engine.unwrap_or("none")));
        for candidate in &self.libraries {
            let used = self.library.as_ref() == Some(&candidate.path);
            let name = if used { "library" } else { "not used" };
            line(name, &format!("{} ({})", candidate.path.display(), candidate.by));
        }
        line("threads", &self.threads.to_string());
        let folder = self.models_folder.as_ref().map(|f| f.display().to_string());
        line("models", &format!("{} in '{}'", self.models.len(), folder.unwrap_or_default()));
        for model in &self.models {
            text.push_str(&show(model));
        }
        if !self.missing.is_empty() {
            text.push_str(&format!("\n{head}optional, not found{head:#}\n"));
        }
        for what in &self.missing {
            text.push_str(&format!("  {}\n", escaped(what)));
        }
        text
    }
}
