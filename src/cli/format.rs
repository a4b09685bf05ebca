//! File formats by extension, and default names.

use super::failure::Failure;
use super::values::alternatives;
use clap::Arg;
use clap::builder::StyledStr;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use vtex::output::file::{FileKind, Format, endings};

/// The formats of a command, by a condition.
pub(crate) type Allowed = fn(Format) -> bool;

/// Formats of `texture`.
pub(crate) const OF_PHOTO: Allowed = |_| true;
/// Formats of a scene.
pub(crate) const OF_SCENE: Allowed = Format::is_of_scene;
/// Formats of `analyze`.
pub(crate) const OF_LIBRARY: Allowed = |format| !format.is_of_scene();
/// Formats of `--pattern`.
pub(crate) const OF_PATTERN: Allowed = |format| format.uses().pattern;

/// Formats that keep to `--max-bytes`.
pub(crate) const OF_MAX_BYTES: Allowed = |format| format.uses().max_bytes;

/// Names formats in the help of an option.
pub(crate) trait Lists: Sized {
    /// Puts the endings of formats in the place of `{formats}`.
    fn lists(self, allowed: Allowed) -> Self {
        self.fills("{formats}", &alternatives(&endings(allowed)))
    }

    /// Puts a text in place of another.
    fn fills(self, place: &str, text: &str) -> Self;
}

impl Lists for Arg {
    fn fills(self, place: &str, text: &str) -> Self {
        let filled = |help: Option<&StyledStr>| help.map(|help| help.to_string().replace(place, text));
        let long = filled(self.get_long_help());
        let short = filled(self.get_help()).unwrap_or_default();
        match long {
            Some(long) => self.help(short).long_help(long),
            None => self.help(short),
        }
    }
}

/// The names of formats in words, such as `SVG or PDF`.
pub(crate) fn titles(allowed: Allowed) -> String {
    let formats = Format::all().filter(|format| allowed(*format));
    alternatives(&formats.map(|format| format.writer().endings[0].title).collect::<Vec<_>>())
}

/// The kind of file that the name `path` stands for, among those allowed; `flag` is the option that named it.
pub(crate) fn kind_of(flag: &str, path: &Path, allowed: Allowed) -> Result<FileKind, Failure> {
    let kind = FileKind::from_path(path).filter(|k| allowed(k.format));
    kind.ok_or_else(|| unknown_name(flag, path, &endings(allowed)))
}

/// Checks that masks can be saved under a name.
pub(crate) fn check_masks_name(path: &Path) -> Result<(), Failure> {
    check_name("--save-masks", path, &[".png", ".json", ".json.gz"])
}

/// Checks that a layer map can be written under a name, given for `flag`.
pub(crate) fn check_map_name(flag: &str, path: &Path) -> Result<(), Failure> {
    check_name(flag, path, &[".png", ".svg", ".json"])
}

/// Checks that a page can be written under a name.
pub(crate) fn check_page_name(path: &Path) -> Result<(), Failure> {
    check_name("--output", path, &[".htm", ".html"])
}

fn check_name(flag: &str, path: &Path, known: &[&str]) -> Result<(), Failure> {
    let name = path.to_string_lossy().to_ascii_lowercase();
    if known.iter().any(|e| name.ends_with(e)) { Ok(()) } else { Err(unknown_name(flag, path, known)) }
}

fn unknown_name(flag: &str, path: &Path, known: &[&str]) -> Failure {
    Failure::usage(format!("cannot tell the format from the name '{}'", path.display()))
        .hint(format!("give {flag} a name that ends in {}", alternatives(known)))
}

/// `some/photo.tuned.weights.json` for `some/photo.lib.json` and the name `tuned`.
pub(crate) fn weights_path(beside: &Path, name: &str) -> PathBuf {
    let mut file = stem(beside);
    file.push(format!(".{name}.weights.json"));
    beside.with_file_name(file)
}

/// `photo.svg` in the current folder for `some/photo.lib.json` and [`Format::Svg`]; with a word,
/// `photo.word.svg`.
pub(crate) fn default_name(input: &Path, word: &str, format: Format) -> PathBuf {
    let mut name = stem(input);
    if !word.is_empty() {
        name.push(".");
        name.push(word);
    }
    name.push(format.ending());
    name.into()
}

/// `some/photo.lib.json` for `some/photo.svg` and [`Format::Library`].
pub(crate) fn beside(result: &Path, format: Format) -> PathBuf {
    result.with_file_name(default_name(result, "", format))
}

/// `some/out-7.scene.json` for `some/out.scene.json` and 7.
pub(crate) fn numbered(path: &Path, number: u64) -> PathBuf {
    let whole = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = stem(path).to_string_lossy().into_owned();
    let ending = whole.strip_prefix(&stem).unwrap_or_default();
    path.with_file_name(format!("{stem}-{number}{ending}"))
}

/// `photo` for `some/photo.lib.json`, whatever the bytes of the name.
pub(crate) fn stem(input: &Path) -> OsString {
    let whole = input.file_name().unwrap_or("texture".as_ref());
    // A name without its last ending, if it is one of these.
    let without = |name: &OsStr, endings: &[&str]| -> Option<OsString> {
        let path = Path::new(name);
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        endings.contains(&ending.as_str()).then(|| path.file_stem().unwrap_or(name).to_owned())
    };
    let unpacked = without(whole, &["gz"]);
    let document = without(unpacked.as_deref().unwrap_or(whole), &["json"]);
    match document.and_then(|name| without(&name, &["lib", "scene"])) {
        Some(name) => name,
        None => Path::new(whole).file_stem().unwrap_or(whole).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_held_to_what_a_command_writes() {
        let of = |name: &str| kind_of("--output", Path::new(name), OF_SCENE).ok().map(|k| k.format);
        assert_eq!(of("a.SVGZ"), Some(Format::Svg));
        assert_eq!(of("dir.svg/a.scene.json.gz"), Some(Format::Scene));
        assert_eq!(of("a.lib.json"), None);
        assert_eq!(of("a.json"), None);
        assert!(check_masks_name(Path::new("m.masks.json.gz")).is_ok());
        assert!(check_masks_name(Path::new("m.jpg")).is_err());
    }

    #[test]
    fn default_names_stand_in_the_current_folder() {
        let name = |input: &str, format| default_name(Path::new(input), "", format);
        assert_eq!(name("/x/photo.jpg", Format::Library), Path::new("photo.lib.json"));
        assert_eq!(name("y/photo.LIB.json.gz", Format::Svg), Path::new("photo.svg"));
        assert_eq!(name("my.photo.jpeg", Format::Svg), Path::new("my.photo.svg"));
        assert_eq!(name("photo", Format::Png), Path::new("photo.png"));
        assert_eq!(name(".lib.json", Format::Svg), Path::new(".lib.svg"));
        let named = default_name(Path::new("x/photo.jpg"), "texture", Format::Svg);
        assert_eq!(named, Path::new("photo.texture.svg"));
        #[cfg(unix)]
        {
            use std::os::unix::ffi::OsStrExt;
            let latin = |name: &[u8]| Path::new(OsStr::from_bytes(name)).to_owned();
            for name in [&b"caf\xe9.lib.json.gz"[..], b"caf\xe9.jpg", b"caf\xe9.scene.json"] {
                assert_eq!(default_name(&latin(name), "", Format::Svg), latin(b"caf\xe9.svg"));
            }
        }
        assert_eq!(numbered(Path::new("x/a.scene.json.gz"), 7), Path::new("x/a-7.scene.json.gz"));
        assert_eq!(numbered(Path::new("my.out.svg"), 12), Path::new("my.out-12.svg"));
        assert_eq!(beside(Path::new("x/a.svgz"), Format::Scene), Path::new("x/a.scene.json"));
    }

    #[test]
    fn weights_stand_beside_what_they_are_for() {
        let path = |input: &str| weights_path(Path::new(input), "tuned");
        assert_eq!(path("/x/photo.lib.json.gz"), Path::new("/x/photo.tuned.weights.json"));
        assert_eq!(path("photo.jpg"), Path::new("photo.tuned.weights.json"));
    }
}
