//! Files that are read and written: the places of results, and the check that no file is both.

use crate::cli::failure::Failure;
use crate::cli::format::{self, Allowed, default_name};
use crate::cli::input::Input;
use crate::cli::output::{Destination, Target, Targets};
use clap::Args;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use vtex::output::file::{FileKind, Format};

/// Where results go.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ForceArgs {
    /// Replace existing files without asking, even if vtex did not write them. Without it, on a terminal,
    /// texture and synth ask before they replace a picture of another seed or exemplar. In scripts they
    /// replace it and print its seed
    #[arg(short, long)]
    pub(crate) force: bool,
}

/// An argument that is optional for the parser only with `--dump-config`.
pub(crate) fn required(path: Option<PathBuf>) -> Result<Input, Failure> {
    path.map(Input::new).ok_or_else(|| Failure::usage("no input is given"))
}

/// The result of a command.
#[derive(Clone, Copy)]
pub(crate) struct Makes {
    /// All formats in which the result may be written.
    pub(crate) allowed: Allowed,
    /// The default format.
    pub(crate) usual: Format,
    /// The default ending of its file's name, after the name of the input; may be empty. Commands differ in
    /// it, so that none replaces the result of another.
    pub(crate) word: &'static str,
}

/// The places of results: the given ones; else stdout if the input is stdin; else a file named after the
/// input.
pub(crate) fn targets(
    outputs: Vec<PathBuf>,
    force: &ForceArgs,
    input: &Input,
    makes: Makes,
) -> Result<Targets, Failure> {
    check_distinct(&self::outputs(&outputs))?;
    let mut outputs = outputs.into_iter();
    let first = match (outputs.next(), input) {
        (Some(path), _) => path,
        (None, Input::Stdin) => Path::new("-").into(),
        (None, Input::File(path)) => default_name(path, makes.word, makes.usual),
    };
    let first = target(first, force, makes)?;
    let others = outputs.map(|path| target(path, force, makes)).collect::<Result<_, _>>()?;
    Ok(Targets { first, others })
}

/// One place.
fn target(path: PathBuf, force: &ForceArgs, Makes { allowed, usual, .. }: Makes) -> Result<Target, Failure> {
    if path.as_os_str() == "-" {
        if !is_document(usual) && std::io::stdout().is_terminal() {
            return Err(Failure::usage("a terminal cannot show a picture").hint("name a file with --output"));
        }
        return Ok(Target { place: Destination::Stdout, kind: FileKind { format: usual, gzip: false } });
    }
    let kind = format::kind_of("--output", &path, allowed)?;
    Ok(Target { place: Destination::File { path, force: force.force }, kind })
}

/// Whether a format is text that vtex reads again.
fn is_document(format: Format) -> bool {
    matches!(format, Format::Scene | Format::Library)
}

/// The files of `-o`, with their flag.
pub(crate) fn outputs(paths: &[PathBuf]) -> Vec<(&'static str, Option<&Path>)> {
    paths.iter().map(|path| ("-o", Some(path.as_path()))).collect()
}

/// Fails if a file would be read and written, or standard input read twice.
pub(crate) fn check_files(read: &[(&str, &Input)], written: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    if read.iter().filter(|(_, file)| **file == Input::Stdin).count() > 1 {
        let failure = Failure::usage("'-' stands for more than one file");
        return Err(failure.hint("standard input can be read once"));
    }
    for (name, file) in read {
        if let Input::File(path) = file {
            for &other in written {
                check_distinct(&[(name, Some(path.as_path())), other])?;
            }
        }
    }
    Ok(())
}

/// A canonical path: links are resolved, also those of the folder of a file that does not exist yet.
pub(crate) fn plain(path: &Path) -> PathBuf {
    if let Ok(path) = path.canonicalize() {
        return path;
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

/// Fails if a file would be written twice: the later result would overwrite the earlier, even without
/// `--force`.
pub(crate) fn check_distinct(files: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    for (i, (name, path)) in files.iter().enumerate() {
        for (other, second) in &files[i + 1..] {
            if let (Some(a), Some(b)) = (path, second)
                && plain(a) == plain(b)
            {
                let message = format!("{name} and {other} name the same file, '{}'", a.display());
                return Err(Failure::usage(message).hint("give one of them another name"));
            }
        }
    }
    Ok(())
}
