//! What an extension needs: the program that it extends, its files, and modules of Python.

use super::files::{FileReport, FileState, Installation, MOVE};
use super::programs::{find, find_host, output, version};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::foreign::escaped;
use crate::cli::interrupt;
use crate::cli::output::{print_json, print_styled};
use anstyle::Style;
use serde::Serialize;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

/// Time for another program to print its version. The first start of Inkscape may take seconds.
const LIMIT: Duration = Duration::from_secs(20);

/// Prints the version of Python, and those of the modules given that are missing.
const SCRIPT: &str = "\
import sys, importlib.util as u
print(sys.version.split()[0], *[m for m in sys.argv[1:] if u.find_spec(m) is None])";

/// The oldest Python that works.
const OLDEST_PYTHON: [u32; 2] = [3, 10];

#[derive(Serialize)]
struct CheckReport {
    program: &'static str,
    command: &'static str,
    /// `inkscape` or `gimp`.
    host: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    found: Option<Found>,
    /// The Python that Inkscape uses, unless Inkscape contains its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    python: Option<Found>,
    folder: PathBuf,
    files: Vec<FileReport>,
    missing: Vec<Missing>,
}

/// A program, and its version or the reason why that is unknown.
#[derive(Serialize)]
struct Found {
    path: PathBuf,
    version: String,
}

/// What is missing, and how to get it.
#[derive(Serialize)]
struct Missing {
    what: String,
    hint: String,
}

impl Missing {
    fn new(what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { what: what.into(), hint: hint.into() }
    }
}

/// Prints what is there and what is missing. Writes nothing.
///
/// # Errors
/// Something that is missing; a file that cannot be read.
pub(crate) fn check(common: &Common, installation: &Installation) -> anyhow::Result<()> {
    let host = installation.host;
    let mut missing = Vec::new();
    let found = examine_host(installation, &mut missing);
    // On Windows and macOS, Inkscape contains Python.
    let uses_python = !host.modules.is_empty() && !cfg!(any(windows, target_os = "macos"));
    let python = if uses_python { examine_python(host.modules, &mut missing) } else { None };
    let files = installation.states()?;
    examine_files(installation, &files, &mut missing);
    interrupt::check()?;
    let folder = installation.folder.clone();
    let report = CheckReport {
        program: vtex::PROGRAM,
        command: "integrate",
        host: host.word,
        found,
        python,
        folder,
        files,
        missing,
    };
    if common.json {
        print_json(&report, false)?;
    } else {
        print_styled(&report.show(host.title))?;
    }
    if report.missing.is_empty() {
        return Ok(());
    }
    let all = |part: fn(&Missing) -> &str| report.missing.iter().map(part).collect::<Vec<_>>().join("; ");
    let failure = Failure::failed(all(|missing| &missing.what));
    Err(failure.hint(all(|missing| &missing.hint)).reported_already().into())
}

/// Finds Inkscape or GIMP.
fn examine_host(installation: &Installation, missing: &mut Vec<Missing>) -> Option<Found> {
    let host = installation.host;
    let [major, minor] = host.oldest;
    let needed = format!("{} {major}.{minor} or newer", host.title);
    let Some(path) = find_host(host) else {
        let what = format!("{} was not found", host.title);
        missing.push(Missing::new(what, format!("install {needed}, or add its folder to PATH")));
        return None;
    };
    let version = match output(Command::new(&path).arg("--version"), LIMIT) {
        Ok(text) => match version(&text) {
            Some((text, numbers)) => {
                if numbers < host.oldest {
                    let what = format!("'{}' is {} {text}", path.display(), host.title);
                    missing.push(Missing::new(what, format!("install {needed}")));
                }
                text.to_owned()
            }
            None => "unknown version".into(),
        },
        Err(e) => format!("unknown version: {e}"),
    };
    Some(Found { path, version })
}

/// Finds the Python that Inkscape uses, and the modules that it lacks.
fn examine_python(modules: &[&str], missing: &mut Vec<Missing>) -> Option<Found> {
    let [major, minor] = OLDEST_PYTHON;
    let install = format!("install Python {major}.{minor} or newer");
    let Some(path) = find(&["python3"], &[]) else {
        missing.push(Missing::new("python3 was not found", install));
        return None;
    };
    let place = path.display().to_string();
    let text = match output(Command::new(&path).args(["-c", SCRIPT]).args(modules), LIMIT) {
        Ok(text) => text,
        Err(e) => {
            missing.push(Missing::new(format!("'{place}' does not work: {e}"), install));
            return Some(Found { path, version: "unknown version".into() });
        }
    };
    let (version, numbers) = version(&text).unwrap_or(("unknown version", OLDEST_PYTHON));
    if numbers < OLDEST_PYTHON {
        missing.push(Missing::new(format!("'{place}' is Python {version}"), install));
    }
    let lacking: Vec<&str> = text.split_whitespace().filter(|word| modules.contains(word)).collect();
    if !lacking.is_empty() {
        let what = format!("'{place}' lacks {}", lacking.join(", "));
        let packages: Vec<String> = lacking.iter().map(|module| format!("python3-{module}")).collect();
        let hint =
            format!("install them for this Python, on Debian with 'apt install {}'", packages.join(" "));
        missing.push(Missing::new(what, hint));
    }
    Some(Found { version: version.to_owned(), path })
}

/// Reports files that are not as this program installs them.
fn examine_files(installation: &Installation, files: &[FileReport], missing: &mut Vec<Missing>) {
    let host = installation.host;
    if let Some(foreign) = files.iter().find(|report| report.state == FileState::Foreign) {
        missing.push(Missing::new(installation.foreign(foreign.file), MOVE));
        return;
    }
    let count = files.iter().filter(|report| report.state != FileState::Installed).count();
    if count > 0 {
        let of = if count == files.len() { count.to_string() } else { format!("{count} of {}", files.len()) };
        let what = format!("{of} files of the {} are not installed", host.extension);
        missing.push(Missing::new(what, format!("run 'vtex integrate {}' without --check", host.word)));
    }
}

impl CheckReport {
    /// The report as text.
    fn show(&self, title: &str) -> String {
        let head = Style::new().bold();
        let mut text = format!("{head}{}{head:#}\n\n", self.program);
        let mut line =
            |name: &str, value: &str| text.push_str(&format!("{head}{name:9}{head:#} {}\n", escaped(value)));
        let show = |found: &Option<Found>| match found {
            Some(Found { path, version }) => format!("{version}, '{}'", path.display()),
            None => "not found".into(),
        };
        line(title, &show(&self.found));
        if self.python.is_some() {
            line("python3", &show(&self.python));
        }
        line("folder", &format!("'{}'", self.folder.display()));
        for report in &self.files {
            line("", &format!("{}: {}", report.file, report.state.title()));
        }
        text
    }
}
