//! The recipe of a texture, as written into its SVG and read by `--again`: all parameters, and the names and
//! SHA-256 of the files that were used.

use super::config::{ConfigLayer, Parameters};
use super::failure::Failure;
use super::input::Input;
use super::options::analyze::SegmenterName;
use super::options::control::Steering;
use super::options::masks::{MasksFrom, SamFrom};
use super::values::Name;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use vtex::library::{Contrast, EvenLight, Library};

/// Number of bytes of an SVG that are searched for its metadata, which are at its beginning.
const HEAD: usize = 1 << 20;

/// A file that was used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RecipeFile {
    /// `photo`, or the option that named it.
    pub(crate) role: String,
    pub(crate) file: PathBuf,
    pub(crate) sha256: String,
}

impl RecipeFile {
    /// The role, name and checksum of a file.
    pub(crate) fn of(role: &str, file: &Path, content: &[u8]) -> Self {
        Self { role: role.into(), file: file.into(), sha256: sum(content) }
    }
}

/// SHA-256 in hexadecimal.
pub(crate) fn sum(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The recipe of the texture of a photograph and of the library that was made from it; `masks` is the source
/// of its masks.
///
/// # Errors Files that were used and can no longer be read.
pub(crate) fn of(
    parameters: &Parameters,
    masks: MasksFrom,
    (steering, painted): (&Steering, Option<&Input>),
    library: &Library,
    photo: &Input,
) -> anyhow::Result<Value> {
    let sha256 = library.source.sha256.clone();
    let mut parts = vec![RecipeFile { role: "photo".into(), file: photo.path().to_owned(), sha256 }];
    let mut add = |role: &str, file: &Path| {
        parts.push(RecipeFile::of(role, file, &Input::new(file.to_owned()).read()?));
        anyhow::Ok(())
    };
    for (role, file) in steering.files().chain(painted.map(|file| ("--layer-map", file))) {
        // Input from a pipe cannot be read again.
        if let Input::File(path) = file {
            add(role, path)?;
        }
    }
    let mut model = None;
    let segmenter = match masks {
        MasksFrom::File(path) => {
            add("--masks", &path)?;
            SegmenterName::Auto
        }
        MasksFrom::Sam(SamFrom::Files(files)) => {
            for (role, file) in ["--encoder", "--decoder"].iter().zip(&files) {
                add(role, file)?;
            }
            SegmenterName::Sam
        }
        MasksFrom::Sam(SamFrom::Model(name)) => {
            model = name;
            SegmenterName::Sam
        }
        MasksFrom::Auto | MasksFrom::Texton => SegmenterName::Texton,
        MasksFrom::Regions | MasksFrom::OneTree => SegmenterName::Regions,
        MasksFrom::Felzenszwalb => SegmenterName::Felzenszwalb,
    };
    Ok(write(parameters, segmenter, &parts, model.as_ref().map(Name::as_str)))
}

/// The recipe of a variant: the photograph is analysed once, with the seed of the first.
pub(crate) fn of_variant(recipe: &Value, variant: u64) -> Value {
    let mut recipe = recipe.clone();
    let own = recipe.get("variant").and_then(Value::as_u64).unwrap_or(0) + variant;
    if own > 0 {
        recipe["variant"] = own.into();
    }
    recipe
}

/// A recipe that was read.
pub(crate) struct Recipe {
    /// The SVG that holds it, in quotes.
    pub(crate) place: String,
    pub(crate) program: String,
    pub(crate) parameters: ConfigLayer,
    pub(crate) parts: Vec<RecipeFile>,
    /// The model of Segment Anything, if one was named.
    pub(crate) model: Option<String>,
    /// Offset of the texture's seed from that of the analysis.
    pub(crate) variant: u64,
}

/// The recipe as JSON; `segmenter` finds the masks if none are given.
fn write(
    parameters: &Parameters,
    segmenter: SegmenterName,
    parts: &[RecipeFile],
    model: Option<&str>,
) -> Value {
    // Named weights are stored as numbers, because the file of that name may change.
    let parameters = Parameters { segmenter, weights: None, threads: None, ..parameters.clone() };
    let mut recipe = serde_json::to_value(parameters.table()).unwrap_or_default();
    // What is the default needs no words.
    if let Some(analyze) = recipe.get_mut("analyze").and_then(Value::as_object_mut) {
        if parameters.analyze.contrast == Contrast::Auto {
            analyze.remove("contrast");
        }
        if parameters.analyze.even_light == EvenLight::Auto {
            analyze.remove("even_light");
        }
    }
    let parts = parts.iter().map(|part| {
        let file = part.file.to_string_lossy();
        serde_json::json!({ "role": part.role, "file": file, "sha256": part.sha256 })
    });
    recipe["command"] = "texture".into();
    recipe["files"] = parts.collect();
    if let Some(model) = model {
        recipe["model"] = model.into();
    }
    recipe
}

impl Recipe {
    /// Reads the recipe of an SVG, plain or packed.
    ///
    /// # Errors
    /// A file that cannot be read or holds none.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let bytes = Input::new(path.to_owned()).read()?;
        let place = format!("'{}'", path.display());
        let missing = || {
            let failure = Failure::failed(format!("{place} does not say how it was made"));
            failure.hint("only an SVG that 'vtex texture' has written does; give it to --again")
        };
        let metadata = metadata(&bytes).ok_or_else(missing)?;
        if metadata["seed"].is_u64() && !metadata["recipe"].is_object() {
            let message = format!("{place} has no recipe: another command than 'vtex texture' wrote it");
            let failure = Failure::failed(message);
            let hint = format!("repeat that command, with its options and --seed {}", metadata["seed"]);
            return Err(failure.hint(hint).into());
        }
        let program = metadata["program"].as_str().unwrap_or_default().to_owned();
        let Some(Value::Object(recipe)) = metadata.get("recipe") else { return Err(missing().into()) };
        let text = |value: &Value, key: &str| value[key].as_str().map(str::to_owned);
        let part = |value: &Value| {
            let file = text(value, "file")?.into();
            Some(RecipeFile { role: text(value, "role")?, file, sha256: text(value, "sha256")? })
        };
        let parts = recipe.get("files").and_then(Value::as_array).into_iter().flatten();
        let parts = parts.map(part).collect::<Option<Vec<_>>>().ok_or_else(missing)?;
        let model = recipe.get("model").and_then(Value::as_str).map(str::to_owned);
        let mut table = toml::Table::new();
        for (key, value) in recipe {
            if !["command", "files", "model", "variant"].contains(&key.as_str()) {
                let value = toml::Value::try_from(value).map_err(|_| missing())?;
                table.insert(key.clone(), value);
            }
        }
        let parameters = ConfigLayer::new(place.clone(), table)?;
        let variant = recipe.get("variant").and_then(Value::as_u64).unwrap_or(0);
        Ok(Self { place, program, parameters, parts, model, variant })
    }

    /// The file that had a role.
    pub(crate) fn part(&self, role: &str) -> Option<&RecipeFile> {
        self.parts.iter().find(|part| part.role == role)
    }

    /// Refuses a file whose content has changed since.
    ///
    /// # Errors
    /// A file that cannot be read or has another sum.
    pub(crate) fn check(&self, role: &str, what: &str, file: &Input) -> anyhow::Result<()> {
        let (Some(part), Input::File(path)) = (self.part(role), file) else { return Ok(()) };
        if sum(&file.read()?) == part.sha256 {
            return Ok(());
        }
        let (path, place) = (path.display(), &self.place);
        let failure = Failure::failed(format!("'{path}' is not {what} that {place} was made with"));
        Err(failure
            .hint(format!("it was '{}', with the SHA-256 {}", part.file.display(), part.sha256))
            .into())
    }
}

/// The metadata of an SVG.
pub(crate) fn metadata(bytes: &[u8]) -> Option<Value> {
    let head = vtex::gzip::beginning(bytes, HEAD);
    let text = String::from_utf8_lossy(&head);
    let (_, rest) = text.split_once("<metadata")?;
    let (_, rest) = rest.split_once('>')?;
    let (content, _) = rest.split_once("</metadata>")?;
    let entities = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")];
    let plain = entities.iter().fold(content.to_owned(), |text, (from, to)| text.replace(from, to));
    serde_json::from_str(plain.trim()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::config::CommandLineValues;
    use vtex::synth::CanvasSize;

    #[test]
    fn what_is_written_down_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.svg");
        let mut parameters = Parameters::resolve(None, &CommandLineValues::default()).unwrap();
        parameters.seed = "18446744073709551615".parse().ok();
        parameters.analyze.detail_scale = 12.5;
        (parameters.size, parameters.synth.width) = (CanvasSize::Pixels([70, 1000]), 70);
        parameters.svg.precision = 3;
        let parts = [RecipeFile::of("photo", Path::new("a<b>&c.png"), b"x")];
        let recipe = write(&parameters, SegmenterName::Texton, &parts, None);
        let metadata = serde_json::json!({ "program": "vtex 7", "recipe": recipe }).to_string();
        let escaped = metadata.replace('&', "&amp;").replace('<', "&lt;");
        std::fs::write(&path, format!("<svg><metadata id=\"m\">\n{escaped}</metadata></svg>")).unwrap();
        let read = Recipe::read(&path).unwrap();
        assert_eq!((read.program.as_str(), &read.parts[..]), ("vtex 7", &parts[..]));
        parameters.segmenter = SegmenterName::Texton;
        assert_eq!(
            Parameters::resolve([&read.parameters], &CommandLineValues::default()).unwrap(),
            parameters
        );
        std::fs::write(&path, "<svg/>").unwrap();
        assert!(Recipe::read(&path).is_err());
    }
}
