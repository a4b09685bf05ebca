//! The document in which work is kept: `*.vtex-studio.json`.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use vtex_base::document;
use vtex_base::document::Document;
use vtex_base::file_names::is_device;

/// Work on one photograph, drawing, library or scene, to go on with later. Files are named without a folder:
/// they lie beside the document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudioWork {
    /// Always `vtex-studio`.
    pub format: String,
    /// Version of the format; this is 1.
    pub version: u32,
    /// The file that is worked on.
    pub input: WorkFile,
    /// Seed of the analysis.
    pub analysis_seed: u64,
    /// Seed of the synthesis.
    pub seed: u64,
    /// Options of `analyze` and `synth`, by name, as they are written on the command line.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub options: BTreeMap<String, String>,
    /// Operations of `edit`, as they are written after `--op`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub operations: Vec<String>,
    /// Files that steer, by the option that names them: `masks`, `density` and `domain`; and that of
    /// the operation `palette`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, WorkFile>,
}

/// A file that work refers to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkFile {
    /// Its name, without a folder.
    pub file: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Whether it was drawn in the page.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drawn: bool,
}

document!(StudioWork, "vtex-studio", 1);

impl Document for StudioWork {
    const FORMAT: &'static str = Self::FORMAT;
    const VERSION: u32 = Self::VERSION;

    fn validate(&self) -> Result<(), String> {
        let files = self.files.values().chain([&self.input]);
        match files.map(|file| &file.file).find(|name| file_name(name).as_deref() != Some(name.as_str())) {
            Some(name) => Err(format!("'{name}' is no plain name of a file")),
            None => Ok(()),
        }
    }
}

/// The longest name of a file, in bytes.
const LONGEST: usize = 120;

/// The name of a file that a page or a document gives, made harmless: without folders, without characters that
/// file systems or shells treat in a special way, neither hidden nor like an option, and none of the names that
/// Windows has for devices. `None` if nothing is left.
pub fn file_name(given: &str) -> Option<String> {
    let last = given.rsplit(['/', '\\', ':']).next().unwrap_or_default();
    let plain =
        |c: char| c.is_alphanumeric() || matches!(c, '.' | '-' | '_' | ' ' | '+' | '(' | ')' | ',' | '@');
    let kept: String = last.chars().map(|c| if plain(c) { c } else { '_' }).collect();
    let mut kept = kept.trim().trim_start_matches(['.', '-']).trim_end_matches(['.', ' ']);
    // A name of a device becomes longer by one.
    while kept.len() >= LONGEST {
        // The ending is worth more than the beginning.
        kept = &kept[kept.chars().next().map_or(0, char::len_utf8)..];
    }
    let kept = kept.trim_start_matches(['.', '-', ' ']);
    if is_device(kept) {
        return Some(format!("_{kept}"));
    }
    (!kept.is_empty()).then(|| kept.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn names_are_harmless_and_stay(given in ".{0,200}") {
            if let Some(name) = file_name(&given) {
                prop_assert!(!name.contains(['/', '\\', ':', '\0', '\n']) && name.len() <= LONGEST);
                prop_assert!(!name.starts_with(['.', '-']) && !name.ends_with('.') && !is_device(&name));
                prop_assert_eq!(std::path::Path::new(&name).components().count(), 1);
                prop_assert_eq!(file_name(&name), Some(name));
            }
        }
    }

    #[test]
    fn folders_are_left_out() {
        let named = |given| file_name(given).unwrap_or_default();
        assert_eq!(named("../../etc/passwd"), "passwd");
        assert_eq!(named("C:\\photos\\Leaf (2).JPG"), "Leaf (2).JPG");
        assert_eq!(named("--force"), "force");
        assert_eq!(named("a\"$(b)`.png"), "a__(b)_.png");
        assert_eq!(
            ["nul", "Con.png", "com1.tar.gz", "LPT9 .svg"].map(named),
            ["_nul", "_Con.png", "_com1.tar.gz", "_LPT9 .svg"]
        );
        assert_eq!(
            ["null.png", "com.png", "com10.png", "console"].map(named),
            ["null.png", "com.png", "com10.png", "console"]
        );
        assert_eq!([named(""), named(".."), named("/"), named(". .")], ["", "", "", ""]);
    }

    #[test]
    fn documents_name_no_folders() {
        let input = WorkFile { file: "leaf.png".into(), sha256: String::new(), drawn: false };
        let work = StudioWork {
            format: StudioWork::FORMAT.into(),
            version: StudioWork::VERSION,
            input,
            analysis_seed: 1,
            seed: u64::MAX,
            options: BTreeMap::from([("size".into(), "600".into())]),
            operations: vec!["tint red".into()],
            files: BTreeMap::new(),
        };
        assert_eq!(StudioWork::from_bytes(work.to_json(), "w").unwrap(), work);
        let text = String::from_utf8(work.to_json()).unwrap().replace("leaf.png", "../leaf.png");
        assert!(
            StudioWork::from_bytes(text.into_bytes(), "w").unwrap_err().to_string().contains("plain name")
        );
    }
}
