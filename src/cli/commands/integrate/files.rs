//! The files of an extension in its folder: their states, installing and removing.

use super::host::HostFacts;
use super::programs::{is_executable, make_executable};
use crate::cli::executable;
use crate::cli::failure::Failure;
use crate::cli::output::Destination;
use serde::Serialize;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use vtex::{Error, Result};

/// The file beside an extension from which it reads the path of vtex.
const PROGRAM_FILE: &str = "vtex_program.txt";

/// The advice about files of others.
pub(crate) const MOVE: &str = "move this file elsewhere, or install to another folder with --folder";

/// The state of a file of an extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FileState {
    Installed,
    /// Of another version of vtex, or changed.
    Differs,
    Missing,
    /// Not of vtex.
    Foreign,
}

impl FileState {
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Installed => "installed",
            Self::Differs => "older or changed",
            Self::Missing => "missing",
            Self::Foreign => "not of vtex",
        }
    }

    fn is_own(self) -> bool {
        matches!(self, Self::Installed | Self::Differs)
    }
}

/// A file and its state.
#[derive(Serialize)]
pub(crate) struct FileReport {
    pub(crate) file: &'static str,
    pub(crate) state: FileState,
}

/// An extension in its folder, which need not exist.
pub(crate) struct Installation {
    pub(crate) host: &'static HostFacts,
    pub(crate) folder: PathBuf,
    /// The path of the running program, on a line.
    program: String,
}

impl Installation {
    /// An extension that starts the running program.
    ///
    /// # Errors
    /// If the path of the running program is unknown, or is not text.
    pub(crate) fn new(host: &'static HostFacts, folder: PathBuf) -> anyhow::Result<Self> {
        let path = executable::path()
            .map_err(|e| Failure::failed(format!("the path of the program is unknown: {e}")))?;
        let Some(text) = path.to_str() else {
            let failure = Failure::failed(format!("the path '{}' is not UTF-8", path.display()));
            return Err(failure.hint("move vtex to another folder").into());
        };
        Ok(Self { host, folder, program: format!("{text}\n") })
    }

    /// All files with their content, the one with the path of vtex last.
    fn parts(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let embedded = self.host.files.iter().map(|file| (file.name, file.content));
        embedded.chain(std::iter::once((PROGRAM_FILE, self.program.as_str())))
    }

    /// The state of each file.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(crate) fn states(&self) -> Result<Vec<FileReport>> {
        let mut all: Vec<FileReport> = Vec::new();
        for (file, expected) in self.parts() {
            let path = self.folder.join(file);
            let state = match read(&path)? {
                None => FileState::Missing,
                Some(found) if found == expected.as_bytes() => {
                    let is_ready = self.host.executable != Some(file) || is_executable(&path);
                    if is_ready { FileState::Installed } else { FileState::Differs }
                }
                Some(found) => {
                    // The path of vtex has no mark: it belongs to the files beside it.
                    let is_own = match file {
                        PROGRAM_FILE => all.iter().any(|other| other.state.is_own()),
                        _ => contains(&found, self.host.mark),
                    };
                    if is_own { FileState::Differs } else { FileState::Foreign }
                }
            };
            all.push(FileReport { file, state });
        }
        Ok(all)
    }

    /// Writes the files that are missing or differ, and returns their number. If there is a file of others,
    /// nothing is written.
    ///
    /// # Errors
    /// A file of others; a file that cannot be read or written.
    pub(crate) fn install(&self) -> anyhow::Result<usize> {
        let states = self.states()?;
        if let Some(foreign) = states.iter().find(|report| report.state == FileState::Foreign) {
            return Err(Failure::failed(self.foreign(foreign.file)).hint(MOVE).into());
        }
        let parts = self.parts().zip(states).filter(|(_, report)| report.state != FileState::Installed);
        let due: Vec<(Destination, &str, bool)> = parts
            .map(|((file, content), _)| {
                let place = Destination::File { path: self.folder.join(file), force: true };
                (place, content, self.host.executable == Some(file))
            })
            .collect();
        if due.is_empty() {
            return Ok(0);
        }
        fs::create_dir_all(&self.folder).map_err(|e| Error::write(&self.folder, e))?;
        due.iter().try_for_each(|(place, ..)| place.probe())?;
        for (place, content, executable) in &due {
            place.write(|out| out.write_all(content.as_bytes()))?;
            if *executable {
                make_executable(place.path()).map_err(|e| Error::write(place.path(), e))?;
            }
        }
        Ok(due.len())
    }

    /// What is wrong with a file of others.
    pub(crate) fn foreign(&self, file: &str) -> String {
        let path = self.folder.join(file);
        let HostFacts { extension, title, .. } = self.host;
        format!("'{}' is not part of the {extension} of vtex for {title}", path.display())
    }

    /// Removes the files of vtex and returns their number. The folder is removed if it is empty then.
    ///
    /// # Errors
    /// A file that cannot be read or removed.
    pub(crate) fn remove(&self) -> Result<usize> {
        let states = self.states()?;
        let own: Vec<&str> = states.iter().filter(|r| r.state.is_own()).map(|r| r.file).collect();
        // The path of vtex is removed first, because without the others it is not known as a file of vtex.
        for file in own.iter().rev() {
            let path = self.folder.join(file);
            fs::remove_file(&path).map_err(|e| Error::write(&path, e))?;
        }
        if !own.is_empty() {
            self.remove_compiled(&own);
            // A folder with other files stays.
            let _ = fs::remove_dir(&self.folder);
        }
        Ok(own.len())
    }

    /// Removes what Python has compiled from files. What cannot be removed stays.
    fn remove_compiled(&self, files: &[&str]) {
        let folder = self.folder.join("__pycache__");
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            // Such as `vtex_fill.cpython-311.pyc` of `vtex_fill.py`.
            let is_of = |file: &&str| file.strip_suffix("py").is_some_and(|stem| name.starts_with(stem));
            if name.ends_with(".pyc") && files.iter().any(is_of) {
                let _ = fs::remove_file(entry.path());
            }
        }
        let _ = fs::remove_dir(&folder);
    }
}

/// The content of a file; `None` if there is no file.
fn read(path: &Path) -> Result<Option<Vec<u8>>> {
    match fs::metadata(path) {
        // A folder cannot be read, and a pipe would be read without end: both count as files of others.
        Ok(found) if !found.is_file() => Ok(Some(Vec::new())),
        Ok(_) => fs::read(path).map(Some).map_err(|e| Error::read(path, e)),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
        Err(e) => Err(Error::read(path, e)),
    }
}

/// Whether bytes contain a text.
fn contains(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|part| part == text.as_bytes())
}
