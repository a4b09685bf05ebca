//! Other programs: their places and their versions.

use super::host::HostFacts;
use crate::cli::interrupt;
use std::env;
use std::io::{self, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Time between two looks at a running program.
const PAUSE: Duration = Duration::from_millis(20);

/// Most bytes read of a program's output.
const LONGEST: u64 = 1 << 16;

/// The path of Inkscape or GIMP: in `PATH`, or where it is usually installed.
pub(crate) fn find_host(host: &HostFacts) -> Option<PathBuf> {
    find(host.programs, &usual_folders(host))
}

/// The first of these programs in the folders of `PATH`, or in other folders.
pub(crate) fn find(names: &[&str], others: &[PathBuf]) -> Option<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = env::split_paths(&path).chain(others.iter().cloned()).collect();
    let mut candidates = names.iter().flat_map(|name| {
        let file = format!("{name}{}", env::consts::EXE_SUFFIX);
        folders.iter().map(move |folder| folder.join(&file))
    });
    candidates.find(|path| path.is_absolute() && path.is_file() && is_executable(path))
}

/// Where a program is installed that need not be in `PATH`.
fn usual_folders(host: &HostFacts) -> Vec<PathBuf> {
    if cfg!(target_os = "macos") {
        vec![host.on_macos.into()]
    } else if cfg!(windows) {
        let folder = |variable: &str, below: &str| {
            env::var_os(variable).map(|base| PathBuf::from(base).join(below).join(host.on_windows))
        };
        [folder("ProgramFiles", ""), folder("LOCALAPPDATA", "Programs")].into_iter().flatten().collect()
    } else {
        Vec::new()
    }
}

/// Whether the system may start a file.
#[cfg(unix)]
pub(crate) fn is_executable(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    std::fs::metadata(path).is_ok_and(|found| found.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
pub(crate) fn is_executable(_: &Path) -> bool {
    true
}

/// Lets everybody who can read a file start it.
#[cfg(unix)]
pub(crate) fn make_executable(path: &Path) -> io::Result<()> {
    use std::fs::{self, Permissions};
    use std::os::unix::fs::PermissionsExt;
    let mode = fs::metadata(path)?.permissions().mode();
    fs::set_permissions(path, Permissions::from_mode(mode | ((mode & 0o444) >> 2)))
}

#[cfg(not(unix))]
pub(crate) fn make_executable(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Runs a program and returns its standard output. It is stopped at the time limit, and when the user asks to
/// stop.
///
/// # Errors
/// If it cannot be started, fails, or does not end in time.
pub(crate) fn output(command: &mut Command, limit: Duration) -> io::Result<String> {
    // Not a pipe: reading one would wait for all processes that the program has started.
    let mut file = tempfile::tempfile()?;
    command.stdin(Stdio::null()).stdout(file.try_clone()?).stderr(Stdio::null());
    let mut child = command.spawn()?;
    let end = Instant::now() + limit;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if Instant::now() > end || interrupt::is_requested() {
            let _ = child.kill();
            let _ = child.wait();
            let reason = format!("no answer within {} s", limit.as_secs());
            return Err(io::Error::new(ErrorKind::TimedOut, reason));
        }
        std::thread::sleep(PAUSE);
    };
    if !status.success() {
        return Err(io::Error::other(status.to_string()));
    }
    file.rewind()?;
    let mut text = Vec::new();
    file.take(LONGEST).read_to_end(&mut text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// The first version in a text, as it is written and as numbers.
pub(crate) fn version(text: &str) -> Option<(&str, [u32; 2])> {
    text.split_whitespace().find_map(|word| {
        let (major, rest) = word.split_once('.')?;
        let minor: String = rest.chars().take_while(char::is_ascii_digit).collect();
        Some((word, [major.parse().ok()?, minor.parse().ok()?]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_read() {
        let inkscape = "Inkscape 1.2.2 (b0a8486541, 2022-12-01)\n";
        assert_eq!(version(inkscape), Some(("1.2.2", [1, 2])));
        assert_eq!(version("GNU Image Manipulation Program version 3.0.4"), Some(("3.0.4", [3, 0])));
        assert_eq!(version("Inkscape 1.4-dev"), Some(("1.4-dev", [1, 4])));
        for none in ["", "Inkscape", "a.b 1. .2 3"] {
            assert_eq!(version(none), None, "{none}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn programs_are_limited_in_time() {
        let run = |script: &str, limit| {
            let begin = Instant::now();
            let outcome = output(Command::new("/bin/sh").args(["-c", script]), Duration::from_millis(limit));
            (outcome.map_err(|e| e.kind()), begin.elapsed())
        };
        assert_eq!(run("echo 1.2", 10_000).0, Ok("1.2\n".into()));
        assert!(run("exit 3", 10_000).0.is_err());
        // The second `sleep` outlives the shell, and keeps its output open.
        for endless in ["exec sleep 20", "sleep 20 & wait"] {
            let (outcome, time) = run(endless, 200);
            assert_eq!(outcome, Err(ErrorKind::TimedOut));
            assert!(time < Duration::from_secs(10), "{endless}: {time:?}");
        }
    }
}
