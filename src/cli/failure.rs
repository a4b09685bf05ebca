//! Messages for the user when something goes wrong, and their exit codes.

use super::exit::Exit;
use super::foreign::{escaped_json, in_lines, line};
use super::hints::hint;
use super::usage;
use anstyle::{AnsiColor, Style};
use std::ffi::OsString;
use std::io::{ErrorKind, Write as _};
use std::path::Path;
use vtex::Error;

/// A failure of the command line's own, beside those of the library.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Failure {
    message: String,
    hint: Option<String>,
    exit: Exit,
    /// Whether it was reported in JSON already.
    is_reported: bool,
}

impl Failure {
    /// The command line or the configuration is wrong.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None, exit: Exit::Usage, is_reported: false }
    }

    /// The work failed.
    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None, exit: Exit::Failed, is_reported: false }
    }

    /// A failure that was reported in a line of JSON already.
    pub(crate) fn reported_already(mut self) -> Self {
        self.is_reported = true;
        self
    }

    /// A hint, in one sentence without a full stop.
    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// The style of `error:` and `warning:`.
pub(crate) const fn label(colour: AnsiColor) -> Style {
    Style::new().bold().fg_color(Some(anstyle::Color::Ansi(colour)))
}

/// Prints an error of the argument parser, or the requested help or version.
pub(crate) fn show_usage(error: &clap::Error, arguments: &[OsString]) -> Exit {
    if error.use_stderr() {
        anstream::eprint!("{}", usage::text(error, arguments));
        Exit::Usage
    } else {
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        // A closed pipe (`vtex --help | head -1`) is no failure: see [`show`].
        match printed {
            Ok(()) => Exit::Success,
            Err(e) => show(&Error::write(Path::new("-"), e).into()),
        }
    }
}

/// The message of an error, its hint and its exit code.
pub(crate) fn explain(error: &anyhow::Error) -> (String, Option<String>, Exit) {
    match error.downcast_ref::<Error>() {
        Some(e @ Error::Interrupted) => (e.to_string(), hint(e), Exit::Interrupted),
        Some(e @ (Error::Parameter { .. } | Error::DrawingPeriods { .. } | Error::Edit { .. })) => {
            (e.to_string(), hint(e), Exit::Usage)
        }
        Some(e) => (e.to_string(), hint(e), Exit::Failed),
        None => match error.downcast_ref::<Failure>() {
            Some(f) => (f.message.clone(), f.hint.clone(), f.exit),
            None => (format!("{error:#}"), None, Exit::Failed),
        },
    }
}

/// Prints an error as an object of JSON on stdout, for programs: its message, its hint and the exit code.
pub(crate) fn show_json(error: &anyhow::Error) {
    if error.downcast_ref::<Failure>().is_some_and(|failure| failure.is_reported) {
        return;
    }
    let (error, hint, exit) = explain(error);
    let mut object = serde_json::json!({ "program": vtex::PROGRAM, "error": error, "exit": exit.code() });
    if let Some(hint) = hint {
        object["hint"] = hint.into();
    }
    // An error is ignored: stdout was closed on purpose.
    let _ = writeln!(std::io::stdout(), "{}", escaped_json(&format!("{object:#}")));
}

/// Prints an error and its hint on stderr and says how to exit. Prints nothing if the reader of stdout has
/// closed it.
pub(crate) fn show(error: &anyhow::Error) -> Exit {
    if let Some(Error::Write { path, source }) = error.downcast_ref::<Error>()
        && source.kind() == ErrorKind::BrokenPipe
        && path.as_os_str() == "-"
    {
        return Exit::Success;
    }
    let (message, hint, exit) = explain(error);
    let red = label(AnsiColor::Red);
    // The signature of a network is reported in lines.
    let lines = matches!(error.downcast_ref::<Error>(), Some(Error::Network { .. }));
    let message = if lines { in_lines(&message) } else { line(&message) };
    let mut text = format!("{red}error:{red:#} {message}\n");
    if let Some(hint) = hint {
        let cyan = label(AnsiColor::Cyan);
        text.push_str(&format!("{cyan}hint:{cyan:#} {}\n", line(&hint)));
    }
    anstream::eprint!("{text}");
    exit
}
