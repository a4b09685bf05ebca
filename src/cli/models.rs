//! The folder of models: a folder for each, with copies of its files and a description.
//!
//! A model is copied as a whole or not at all, with the SHA-256 of each file. Nothing is downloaded.

use super::failure::Failure;
use super::interrupt;
use etcetera::BaseStrategy;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use vtex::engine::{EngineOptions, NetworkSource, load};
use vtex::segment::prompt::Sam;
use vtex::segment::prompt::sam::{SamRole, recognise};
use vtex::{Error, Result};

/// Name of the description within a model's folder.
pub(crate) const DESCRIPTION: &str = "model.json";

/// A model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Model {
    format: String,
    version: u32,
    pub(crate) name: String,
    /// Such as `SAM 2`.
    pub(crate) kind: String,
    pub(crate) files: Vec<ModelFile>,
}

/// A file of a model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelFile {
    pub(crate) file: String,
    pub(crate) role: FileRole,
    pub(crate) bytes: u64,
    pub(crate) sha256: String,
}

/// The purpose of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FileRole {
    Encoder,
    Decoder,
    /// Encoder and decoder in one graph.
    Both,
    /// Weights of a graph beside it.
    Weights,
}

impl FileRole {
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Encoder => "encoder",
            Self::Decoder => "decoder",
            Self::Both => "encoder and decoder",
            Self::Weights => "weights",
        }
    }
}

/// The state of a file relative to when it was added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FileState {
    Good,
    Changed,
    Missing,
}

/// The folder of models.
pub(crate) struct ModelFolder {
    folder: PathBuf,
}

impl ModelFolder {
    /// The folder that `VTEX_MODELS` names, else `vtex/models` in the user's folder for data. It need not
    /// exist.
    ///
    /// # Errors
    /// If the system has no home folder.
    pub(crate) fn open() -> Result<Self, Failure> {
        if let Some(folder) = std::env::var_os("VTEX_MODELS").filter(|v| !v.is_empty()) {
            return Ok(Self { folder: folder.into() });
        }
        let strategy = etcetera::choose_base_strategy().map_err(|_| {
            Failure::failed("there is no folder for the user's data").hint("name one with VTEX_MODELS")
        })?;
        Ok(Self { folder: strategy.data_dir().join("vtex").join("models") })
    }

    /// Where models are kept.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Names of all models, sorted.
    pub(crate) fn names(&self) -> Result<Vec<String>> {
        let entries = match fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(e) => return Err(Error::read(&self.folder, e)),
        };
        let mut names = Vec::new();
        for entry in entries {
            let entry = entry.map_err(|e| Error::read(&self.folder, e))?;
            // Files that are being added, or that a crash left, begin with a dot.
            if let Ok(name) = entry.file_name().into_string()
                && !name.starts_with('.')
                && entry.path().join(DESCRIPTION).is_file()
            {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }

    /// Names of folders that hold files and no description of a model, sorted.
    pub(crate) fn undescribed(&self) -> Result<Vec<String>> {
        let known = self.names()?;
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter(|entry| entry.path().is_dir())
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| !name.starts_with('.') && !known.contains(name))
            .collect();
        names.sort();
        Ok(names)
    }

    /// All models, sorted by name.
    pub(crate) fn models(&self) -> anyhow::Result<Vec<Model>> {
        self.names()?.iter().map(|name| self.model(name)).collect()
    }

    /// Facts about a model.
    pub(crate) fn model(&self, name: &str) -> anyhow::Result<Model> {
        let path = self.folder.join(name).join(DESCRIPTION);
        let text = match fs::read(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == ErrorKind::NotFound => {
                let names = self.names()?;
                let hint = match names.is_empty() {
                    true => "there are none; add one with 'vtex models add'".into(),
                    false => format!("there are: {}", names.join(", ")),
                };
                return Err(Failure::failed(format!("there is no model '{name}'")).hint(hint).into());
            }
            Err(e) => return Err(Error::read(&path, e).into()),
        };
        let damaged = |reason: String| {
            let message = format!("'{}' does not describe a model: {reason}", path.display());
            let hint = format!("add it again with 'vtex models add FILE... --name {name} --force'");
            anyhow::Error::from(Failure::failed(message).hint(hint))
        };
        let model: Model = serde_json::from_slice(&text).map_err(|e| damaged(e.to_string()))?;
        let plain =
            |file: &ModelFile| Path::new(&file.file).file_name().is_some_and(|n| n == file.file.as_str());
        if model.format != "vtex-model" || model.version != 1 || model.name != name {
            return Err(damaged("it is of another name, format or version".into()));
        }
        if !model.files.iter().all(plain) {
            return Err(damaged("a file lies outside of its folder".into()));
        }
        Ok(model)
    }

    /// The ONNX files of a model.
    pub(crate) fn networks(&self, name: &str) -> anyhow::Result<Vec<PathBuf>> {
        let model = self.model(name)?;
        let networks = model.files.iter().filter(|f| f.role != FileRole::Weights);
        Ok(networks.map(|f| self.folder.join(name).join(&f.file)).collect())
    }

    /// Checksums of all files of a model, as stored when it was added.
    pub(crate) fn sums(&self, name: &str) -> anyhow::Result<Vec<String>> {
        Ok(self.model(name)?.files.into_iter().map(|f| f.sha256).collect())
    }

    /// Copies files into the folder, after their roles are recognised. All of them appear, or none.
    pub(crate) fn add(
        &self,
        files: &[PathBuf],
        name: &str,
        force: bool,
        engine: &EngineOptions,
    ) -> anyhow::Result<Model> {
        let is_network = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("onnx"));
        if !files.iter().any(is_network) {
            let named: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
            let failure = Failure::failed(format!("none of {} is an ONNX file", named.join(", ")));
            return Err(failure
                .hint("name encoder.onnx and decoder.onnx, or one file that contains both")
                .into());
        }
        let place = self.folder.join(name);
        if place.exists() && !force {
            let failure = Failure::failed(format!("there is a model '{name}' already"));
            return Err(failure.hint("give another --name, or --force to replace it").into());
        }
        // Fails before the copying, which may take long.
        let mut roles = Vec::new();
        for path in files {
            let role = if is_network(path) {
                let network = load(NetworkSource::File(path), engine)?;
                match recognise(network.as_ref(), &path.display().to_string())?.0 {
                    SamRole::Encoder => FileRole::Encoder,
                    SamRole::Decoder => FileRole::Decoder,
                    SamRole::Both => FileRole::Both,
                }
            } else {
                FileRole::Weights
            };
            roles.push(role);
        }
        fs::create_dir_all(&self.folder).map_err(|e| Error::write(&self.folder, e))?;
        let new = tempfile::Builder::new().prefix(".vtex-").suffix(".tmp").tempdir_in(&self.folder);
        let new = new.map_err(|e| Error::write(&self.folder, e.kind().into()))?;
        let _passing = interrupt::Passing::new(new.path());
        let mut described = Vec::new();
        for (path, role) in files.iter().zip(roles) {
            let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
            if file == DESCRIPTION || described.iter().any(|d: &ModelFile| d.file == file) {
                let failure = Failure::failed(format!("two files of a model would be called '{file}'"));
                return Err(failure.hint("rename one of them").into());
            }
            let (bytes, sha256) = copy(path, Some(&new.path().join(&file)))?;
            described.push(ModelFile { file, role, bytes, sha256 });
        }
        // Checks that the files belong together, and that the copies are complete.
        let networks = described.iter().filter(|d| d.role != FileRole::Weights);
        let copies: Vec<PathBuf> = networks.map(|d| new.path().join(&d.file)).collect();
        let sources: Vec<NetworkSource<'_>> = copies.iter().map(|path| NetworkSource::File(path)).collect();
        let named = |text: String| text.replace(&format!("{}/", new.path().display()), "");
        let sam = Sam::open(&sources, engine).map_err(|e| match e {
            // The user knows the files by their own names.
            Error::Network { name, reason, advice } => {
                Error::Network { name: named(name), reason: named(reason), advice }
            }
            other => other,
        });
        let kind = sam?.kind().to_owned();
        let model =
            Model { format: "vtex-model".into(), version: 1, name: name.to_owned(), kind, files: described };
        let mut text = serde_json::to_vec_pretty(&model)?;
        text.push(b'\n');
        let description = new.path().join(DESCRIPTION);
        fs::write(&description, text).map_err(|e| Error::write(&description, e))?;
        self.put(&new.keep(), &place)?;
        Ok(model)
    }

    /// Moves a folder to a place where another may exist, which is removed only after it is replaced.
    fn put(&self, new: &Path, place: &Path) -> Result<()> {
        let fail = |e: io::Error| {
            let _ = fs::remove_dir_all(new);
            Error::write(place, e)
        };
        if !place.exists() {
            return fs::rename(new, place).map_err(fail);
        }
        let aside = new.with_extension("old");
        fs::rename(place, &aside).map_err(fail)?;
        if let Err(e) = fs::rename(new, place) {
            let _ = fs::rename(&aside, place);
            return Err(fail(e));
        }
        fs::remove_dir_all(&aside).map_err(|e| Error::write(&aside, e))
    }

    /// The state of each file of a model.
    pub(crate) fn verify(&self, model: &Model) -> Result<Vec<(String, FileState)>> {
        let state = |file: &ModelFile| {
            let path = self.folder.join(&model.name).join(&file.file);
            if !path.is_file() {
                return Ok((file.file.clone(), FileState::Missing));
            }
            let (bytes, sha256) = copy(&path, None)?;
            let same = bytes == file.bytes && sha256 == file.sha256;
            Ok((file.file.clone(), if same { FileState::Good } else { FileState::Changed }))
        };
        model.files.iter().map(state).collect()
    }

    /// Deletes the files of a model, and its folder if nothing else is in it.
    pub(crate) fn remove(&self, name: &str) -> anyhow::Result<()> {
        let model = self.model(name)?;
        let folder = self.folder.join(name);
        // The description is removed first, so that remaining files are not taken for a model.
        for file in std::iter::once(DESCRIPTION).chain(model.files.iter().map(|f| f.file.as_str())) {
            let path = folder.join(file);
            match fs::remove_file(&path) {
                Err(e) if e.kind() != ErrorKind::NotFound => return Err(Error::write(&path, e).into()),
                _ => {}
            }
        }
        fs::remove_dir(&folder).map_err(|e| Error::write(&folder, e))?;
        Ok(())
    }
}

/// SHA-256 of a network and of the files beside it whose names begin with its own, because weights may
/// lie in a file such as `encoder.onnx.data` or `encoder.data`.
pub(crate) fn sums_of_network(path: &Path) -> Result<Vec<String>> {
    let mut files = vec![path.to_owned()];
    if let (Some(folder), Some(stem)) = (path.parent(), path.file_stem()) {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let begin = stem.to_string_lossy();
        for entry in fs::read_dir(folder).map_err(|e| Error::read(folder, e))? {
            let entry = entry.map_err(|e| Error::read(folder, e))?;
            let is_weights = entry.file_name() != path.file_name().unwrap_or_default()
                && entry.file_name().to_string_lossy().starts_with(&*begin)
                && entry.path().is_file();
            if is_weights {
                files.push(entry.path());
            }
        }
    }
    files[1..].sort();
    files.iter().map(|file| Ok(copy(file, None)?.1)).collect()
}

/// Copies a file, or only reads it. Returns the number of bytes and their SHA-256.
fn copy(from: &Path, to: Option<&Path>) -> Result<(u64, String)> {
    let mut file = File::open(from).map_err(|e| Error::read(from, e))?;
    let mut out = match to {
        Some(path) => Some((path, File::create_new(path).map_err(|e| Error::write(path, e))?)),
        None => None,
    };
    let (mut hash, mut bytes) = (Sha256::new(), 0);
    let mut buffer = vec![0; 1 << 20];
    loop {
        interrupt::check()?;
        let n = file.read(&mut buffer).map_err(|e| Error::read(from, e))?;
        if n == 0 {
            break;
        }
        hash.update(&buffer[..n]);
        bytes += n as u64;
        if let Some((path, out)) = &mut out {
            out.write_all(&buffer[..n]).map_err(|e| Error::write(path, e))?;
        }
    }
    if let Some((path, out)) = &out {
        // Some file systems report a full disk only here.
        out.sync_all().map_err(|e| Error::write(path, e))?;
    }
    Ok((bytes, hash.finalize().iter().map(|b| format!("{b:02x}")).collect()))
}
