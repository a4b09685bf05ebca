//! The list of jobs, from files, folders or a file of jobs; each has a name and parameters.

use super::values::Extension;
use crate::cli::config::{CommandLineValues, ConfigLayer, Parameters, fault};
use crate::cli::failure::Failure;
use crate::cli::format::stem;
use crate::cli::input::read_text;
use crate::cli::options::analyze::SegmenterName;
use crate::cli::options::masks::MasksFrom;
use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use toml::{Table, Value};
use vtex::Error;
use vtex_base::file_names::is_device;

/// Extensions of pictures in a folder.
const PICTURES: [&str; 13] =
    ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "pnm", "ppm", "pgm", "pbm", "pam"];

/// Number of bytes of an SVG that are read to recognise it.
const HEAD: u64 = 256;

/// One input and the results to be made from it.
#[derive(Clone, Debug)]
pub(crate) struct BatchJob {
    pub(crate) input: PathBuf,
    /// File name of the results, without extension.
    pub(crate) name: String,
    pub(crate) formats: Vec<Extension>,
    pub(crate) parameters: Parameters,
    /// The source of a photograph's masks.
    pub(crate) masks: MasksFrom,
}

impl BatchJob {
    /// Names of all results.
    pub(crate) fn files(&self) -> impl Iterator<Item = String> {
        self.formats.iter().map(|format| format!("{}.{}", self.name, format.as_str()))
    }
}

/// The source of jobs.
pub(crate) enum JobSource {
    Files(Vec<PathBuf>),
    Jobs(JobsFile),
}

/// A file of jobs, read and checked.
pub(crate) struct JobsFile {
    /// Parameters of all jobs.
    defaults: ConfigLayer,
    jobs: Vec<JobEntry>,
}

/// A `[[job]]`.
struct JobEntry {
    input: PathBuf,
    output: Option<String>,
    formats: Option<Vec<Extension>>,
    parameters: ConfigLayer,
}

impl JobSource {
    /// The inputs that the arguments name.
    ///
    /// # Errors A file of jobs that cannot be read, or that is given together with other inputs.
    pub(crate) fn new(inputs: &[PathBuf]) -> anyhow::Result<Self> {
        let is_jobs = |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        match (inputs, inputs.iter().find(is_jobs)) {
            ([_], Some(file)) => Ok(Self::Jobs(JobsFile::read(file)?)),
            (_, Some(file)) => {
                let message = format!("'{}' is a file of jobs and must stand alone", file.display());
                Err(Failure::usage(message).hint("name the other inputs in it, or run it by itself").into())
            }
            (files, None) => Ok(Self::Files(files.to_vec())),
        }
    }
}

impl JobSource {
    /// Parameters of all jobs, where a file gives them.
    pub(crate) fn defaults(&self) -> Option<&ConfigLayer> {
        match self {
            Self::Files(_) => None,
            Self::Jobs(file) => Some(&file.defaults),
        }
    }
}

impl JobsFile {
    fn read(path: &Path) -> anyhow::Result<Self> {
        let text = read_text(path)?;
        let mut table: Table = text.parse().map_err(|e: toml::de::Error| {
            Failure::usage(format!("cannot read '{}': {}", path.display(), fault(&text, &e)))
        })?;
        let shown = format!("'{}'", path.display());
        let jobs = match table.remove("job") {
            Some(Value::Array(jobs)) if !jobs.is_empty() => jobs,
            _ => {
                let failure = Failure::usage(format!("{shown} has no jobs"));
                return Err(failure
                    .hint("write [[job]] and below it input = \"photo.jpg\" or \"drawing.svg\", for each")
                    .into());
            }
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let entry =
            |(i, job): (usize, Value)| JobEntry::new(job, folder, format!("job {} of {shown}", i + 1));
        let jobs = jobs.into_iter().enumerate().map(entry).collect::<Result<_, _>>()?;
        Ok(Self { defaults: ConfigLayer::new(shown, table)?, jobs })
    }
}

impl JobEntry {
    fn new(job: Value, folder: &Path, place: String) -> Result<Self, Failure> {
        let Value::Table(mut table) = job else {
            return Err(
                Failure::usage(format!("{place} is not a table")).hint("write [[job]] above its keys")
            );
        };
        let mut text = |key: &str| match table.remove(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => Err(Failure::usage(format!("{place}: {key} = {other}: expected text"))),
        };
        let (input, output, format) = (text("input")?, text("output")?, text("format")?);
        let Some(input) = input else {
            let failure = Failure::usage(format!("{place} has no input"));
            return Err(failure.hint("write input = \"photo.jpg\" or \"drawing.svg\""));
        };
        if table.contains_key("threads") {
            let failure = Failure::usage(format!("{place} has the key 'threads'"));
            return Err(failure.hint("'threads' stands at the top, once for all jobs"));
        }
        if let Some(name) = &output {
            check_name(name, &place)?;
        }
        let parse = |list: String| -> Result<Vec<Extension>, Failure> {
            let names = list.split(',').map(|name| name.trim().parse());
            names
                .collect::<Result<_, String>>()
                .map_err(|e| Failure::usage(format!("{place}: format = \"{list}\": {e}")))
        };
        let formats = format.map(parse).transpose()?;
        Ok(Self { input: folder.join(input), output, formats, parameters: ConfigLayer::new(place, table)? })
    }
}

/// Refuses a name that leads out of the folder for results.
fn check_name(name: &str, place: &str) -> Result<(), Failure> {
    let plain = !name.is_empty()
        && !name.starts_with('.')
        && !name.contains(['/', '\\', ':'])
        && !name.contains(char::is_control)
        && !is_device(name);
    if plain {
        return Ok(());
    }
    let failure = Failure::usage(format!("{place}: output = \"{name}\" is not a file name"));
    Err(failure.hint("give a name without folders and extension"))
}

/// All jobs in order, with names that differ.
///
/// # Errors
/// A folder that cannot be read or holds no picture; parameters out of range; two jobs of one name.
pub(crate) fn list(
    source: JobSource,
    config: Option<&ConfigLayer>,
    values: &CommandLineValues,
    formats: Option<&[Extension]>,
    masks: impl Fn(SegmenterName) -> Result<MasksFrom, Failure>,
) -> anyhow::Result<Vec<BatchJob>> {
    let usual = formats.unwrap_or(&[Extension::DEFAULT]);
    let jobs = match source {
        JobSource::Files(paths) => {
            let parameters = Parameters::resolve(config, values)?;
            let mut jobs = Vec::new();
            for input in expanded(paths)? {
                let name = stem(&input).to_string_lossy().into_owned();
                let (formats, parameters) = (usual.to_vec(), parameters.clone());
                let masks = masks(parameters.segmenter)?;
                jobs.push(BatchJob { input, name, formats, parameters, masks });
            }
            jobs
        }
        JobSource::Jobs(file) => {
            let mut jobs = Vec::new();
            for entry in file.jobs {
                let layers = config.into_iter().chain([&file.defaults, &entry.parameters]);
                let parameters = Parameters::resolve(layers, values)?;
                let name = entry.output.unwrap_or_else(|| stem(&entry.input).to_string_lossy().into_owned());
                // As with all options, the command line takes precedence.
                let formats = formats.map(<[_]>::to_vec).or(entry.formats).unwrap_or_else(|| usual.to_vec());
                let masks = masks(parameters.segmenter)?;
                jobs.push(BatchJob { input: entry.input, name, formats, parameters, masks });
            }
            jobs
        }
    };
    differ(&jobs)?;
    Ok(jobs)
}

/// Replaces folders by the pictures in them, sorted by name.
fn expanded(paths: Vec<PathBuf>) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        if path.as_os_str() == "-" {
            return Err(Failure::usage("standard input cannot be one of many")
                .hint("use 'vtex texture -'")
                .into());
        }
        if !path.is_dir() {
            all.push(path);
            continue;
        }
        let mut found = Vec::new();
        for entry in std::fs::read_dir(&path).map_err(|e| Error::read(&path, e))? {
            let inner = entry.map_err(|e| Error::read(&path, e))?.path();
            let extension = inner.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
            let wanted = match extension.as_deref() {
                Some("svg") => !is_result(&inner),
                Some(extension) => PICTURES.contains(&extension),
                None => false,
            };
            if wanted && inner.is_file() {
                found.push(inner);
            }
        }
        if found.is_empty() {
            let failure =
                Failure::usage(format!("there are no pictures and no SVGs in '{}'", path.display()));
            return Err(failure
                .hint("folders inside of it are not looked into; name files one by one")
                .into());
        }
        found.sort();
        all.extend(found);
    }
    Ok(all)
}

/// Whether an SVG was written by vtex. Textures of an earlier run are not used as exemplars.
fn is_result(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains("<!-- Written by vtex ")
}

/// Fails if two jobs would write the same file.
fn differ(jobs: &[BatchJob]) -> Result<(), Failure> {
    let mut seen: BTreeMap<String, &Path> = BTreeMap::new();
    for job in jobs {
        // Some systems do not distinguish names that differ only in case.
        if let Some(other) = seen.insert(job.name.to_lowercase(), &job.input) {
            let (a, b) = (other.display(), job.input.display());
            let message = format!("the results of '{a}' and '{b}' would have the same name, '{}'", job.name);
            return Err(
                Failure::usage(message).hint("rename one, or give each an output name in a file of jobs")
            );
        }
    }
    Ok(())
}
