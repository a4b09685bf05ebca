//! File formats told by extension, and default names.

use super::failure::Failure;
use std::path::{Path, PathBuf};

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Library,
    LibraryGzip,
    Scene,
    SceneGzip,
    Svg,
    Svgz,
    Png,
    Masks,
    MasksGzip,
}

impl Format {
    /// What `analyze` can write.
    pub(crate) const OF_LIBRARY: [Self; 2] = [Self::Library, Self::LibraryGzip];
    /// What `texture`, `synth` and `render` can write.
    pub(crate) const OF_SCENE: [Self; 5] = [Self::Svg, Self::Svgz, Self::Png, Self::Scene, Self::SceneGzip];

    /// What `--save-masks` can write.
    pub(crate) const OF_MASKS: [Self; 3] = [Self::Masks, Self::MasksGzip, Self::Png];

    fn extension(self) -> &'static str {
        match self {
            Self::Library => ".lib.json",
            Self::LibraryGzip => ".lib.json.gz",
            Self::Scene => ".scene.json",
            Self::SceneGzip => ".scene.json.gz",
            Self::Svg => ".svg",
            Self::Svgz => ".svgz",
            Self::Png => ".png",
            Self::Masks => ".masks.json",
            Self::MasksGzip => ".masks.json.gz",
        }
    }

    /// Whether the bytes are no text.
    pub(crate) fn is_binary(self) -> bool {
        matches!(self, Self::LibraryGzip | Self::SceneGzip | Self::MasksGzip | Self::Svgz | Self::Png)
    }

    /// The format among `allowed` that the extension of `path` names, whatever its case.
    pub(crate) fn of(path: &Path, allowed: &[Self]) -> Result<Self, Failure> {
        let name = path.to_string_lossy().to_ascii_lowercase();
        allowed.iter().copied().find(|f| name.ends_with(f.extension())).ok_or_else(|| {
            let known: Vec<&str> = allowed.iter().map(|f| f.extension()).collect();
            let (last, others) = known.split_last().expect("some format is allowed");
            Failure::usage(format!("cannot tell the format from the name '{}'", path.display()))
                .hint(format!("give --output a name that ends in {} or {last}", others.join(", ")))
        })
    }
}

/// `photo.svg` in the current folder for `some/photo.lib.json` and [`Format::Svg`].
pub(crate) fn default_name(input: &Path, format: Format) -> PathBuf {
    let mut stem = input.file_name().unwrap_or("texture".as_ref()).to_os_string();
    if let Some(name) = input.file_name().and_then(|n| n.to_str()) {
        let lower = name.to_ascii_lowercase();
        let known = [".lib.json.gz", ".lib.json", ".scene.json.gz", ".scene.json"];
        stem = match known.iter().find(|e| lower.ends_with(*e) && lower.len() > e.len()) {
            Some(e) => name[..name.len() - e.len()].into(),
            None => Path::new(name).file_stem().unwrap_or(name.as_ref()).into(),
        };
    } else if let Some(short) = input.file_stem() {
        stem = short.into();
    }
    stem.push(format.extension());
    stem.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_follow_the_extension() {
        let of = |name: &str| Format::of(Path::new(name), &Format::OF_SCENE).ok();
        assert_eq!(of("a.svg"), Some(Format::Svg));
        assert_eq!(of("A.SVGZ"), Some(Format::Svgz));
        assert_eq!(of("dir.svg/a.scene.json.gz"), Some(Format::SceneGzip));
        assert_eq!(of("a.lib.json"), None);
        assert_eq!(of("svg"), None);
        assert_eq!(of("a.json"), None);
    }

    #[test]
    fn default_names_stand_in_the_current_folder() {
        let name = |input: &str, format| default_name(Path::new(input), format);
        assert_eq!(name("/x/photo.jpg", Format::Library), Path::new("photo.lib.json"));
        assert_eq!(name("y/photo.LIB.json.gz", Format::Svg), Path::new("photo.svg"));
        assert_eq!(name("my.photo.jpeg", Format::Svg), Path::new("my.photo.svg"));
        assert_eq!(name("photo", Format::Png), Path::new("photo.png"));
        assert_eq!(name(".lib.json", Format::Svg), Path::new(".lib.svg"));
    }
}
