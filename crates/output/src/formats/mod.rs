//! The formats in which vtex writes scenes and libraries: one table for the command line, Python and the studio.
//!
//! A new format is a [`Writer`] in a file of this folder, a case of [`Format`] and a line of [`WRITERS`].

mod document;
mod pdf;
mod png;
mod signature;
mod svg;

pub use signature::PAGE_BEGINNING;
pub(crate) use signature::Signature;

use super::svg::SvgOptions;
use std::io::{self, Write};
use std::path::Path;
use vtex_base::Progress;
use vtex_scene::scene::Scene;

/// The content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A scene as vectors in groups.
    Svg,
    /// A scene as a page of vectors.
    Pdf,
    /// A scene as pixels.
    Png,
    /// A scene as it is.
    Scene,
    /// A library as it is.
    Library,
}

/// The table: the writers of all formats, in the order of their cases, in which they are listed.
static WRITERS: [(Format, &Writer); 5] = [
    (Format::Svg, &svg::WRITER),
    (Format::Pdf, &pdf::WRITER),
    (Format::Png, &png::WRITER),
    (Format::Scene, &document::SCENE),
    (Format::Library, &document::LIBRARY),
];

/// The content of a file, and whether it is packed as gzip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileKind {
    /// The content.
    pub format: Format,
    /// Whether the content is packed.
    pub gzip: bool,
}

/// A format: how its files are called, recognised and written.
pub struct Writer {
    /// Its name among the formats, such as `svg`.
    pub name: &'static str,
    /// What its files are for, in a few words.
    pub purpose: &'static str,
    /// The endings of file names, the usual one first.
    pub endings: &'static [Ending],
    /// The options that it uses.
    pub uses: Uses,
    /// How its files begin and end, and the place of their seal.
    pub(crate) signature: &'static Signature,
    /// Writes a scene; `None` for a format of libraries.
    pub(crate) write: Option<WriteScene>,
}

/// Writes a scene. Returns warnings for the user, a sentence each.
pub(crate) type WriteScene =
    fn(&Scene, &WriteOptions<'_>, &dyn Progress, &mut dyn Write) -> io::Result<Vec<String>>;

/// An ending of file names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ending {
    /// The ending, with its dot, such as `.svgz`.
    pub text: &'static str,
    /// The name of these files in messages, such as `SVGZ`.
    pub title: &'static str,
    /// Whether they are packed as gzip.
    pub gzip: bool,
}

/// The options that a format uses. Others have no effect on its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uses {
    /// Its files can be reduced to [`WriteOptions::max_bytes`].
    pub max_bytes: bool,
    /// It is made of pixels, so it has a [`WriteOptions::scale`].
    pub scale: bool,
    /// It can contain a [`WriteOptions::pattern`].
    pub pattern: bool,
}

impl Uses {
    const NONE: Self = Self { max_bytes: false, scale: false, pattern: false };
}

/// How a scene is written. Each format uses some of the options ([`Uses`]).
#[derive(Clone, Copy, Debug)]
pub struct WriteOptions<'a> {
    /// How an SVG is written. For a drawing on a small page it has at least two decimals ([`SvgOptions::fit`]).
    pub svg: SvgOptions,
    /// Maximum number of bytes. Default none.
    pub max_bytes: Option<u64>,
    /// Pixels for each pixel of the canvas, or of a page in pixels. Default 1.
    pub scale: f64,
    /// How the scene was made from its inputs, for the metadata. Default none.
    pub recipe: Option<&'a serde_json::Value>,
    /// Write a scene that tiles as a pattern that fills any area. Default false.
    pub pattern: bool,
}

impl Default for WriteOptions<'_> {
    fn default() -> Self {
        Self { svg: SvgOptions::default(), max_bytes: None, scale: 1.0, recipe: None, pattern: false }
    }
}

impl Format {
    /// All formats, in the order in which they are listed.
    pub fn all() -> impl Iterator<Item = Self> {
        WRITERS.iter().map(|(format, _)| *format)
    }

    /// How its files are called, recognised and written.
    pub fn writer(self) -> &'static Writer {
        WRITERS[self as usize].1
    }

    /// The format of a name, such as `svg`.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|format| format.writer().name == name)
    }

    /// The usual ending of its files, with its dot.
    pub fn ending(self) -> &'static str {
        self.writer().endings[0].text
    }

    /// The options that it uses.
    pub fn uses(self) -> Uses {
        self.writer().uses
    }

    /// Whether its files contain a scene. A library has none.
    pub fn is_of_scene(self) -> bool {
        self.writer().write.is_some()
    }
}

/// The endings of the formats that satisfy a condition, in the order in which they are listed.
pub fn endings(allowed: impl Fn(Format) -> bool) -> Vec<&'static str> {
    let formats = Format::all().filter(|format| allowed(*format));
    formats.flat_map(|format| format.writer().endings).map(|ending| ending.text).collect()
}

impl FileKind {
    /// All kinds of files, in the order in which they are listed.
    pub fn all() -> impl Iterator<Item = Self> {
        let kinds = |format: Format| {
            format.writer().endings.iter().map(move |ending| Self { format, gzip: ending.gzip })
        };
        Format::all().flat_map(kinds)
    }

    /// The kind that a file name stands for, whatever its case; `None` for any other name.
    pub fn from_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        Self::all().find(|kind| name.ends_with(kind.ending().text))
    }

    /// The ending of its file names.
    ///
    /// # Panics
    /// For a packed kind of a format that is never packed.
    pub fn ending(self) -> &'static Ending {
        let known = self.format.writer().endings.iter().find(|ending| ending.gzip == self.gzip);
        known.expect("only formats with a packed ending are packed")
    }
}

/// All files that have a seal: those of the formats, and animations and pages.
pub(crate) fn signatures() -> impl Iterator<Item = &'static Signature> {
    let others = [&signature::GIF, &signature::PAGE];
    Format::all().map(|format| format.writer().signature).chain(others)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_endings_stand_for_one_kind_each() {
        for format in Format::all() {
            assert_eq!(Format::named(format.writer().name), Some(format));
            assert!(!format.writer().endings[0].gzip, "{format:?} is not packed unless it is asked for");
        }
        for kind in FileKind::all() {
            let Ending { text, gzip, .. } = *kind.ending();
            assert_eq!(FileKind::from_path(Path::new(&format!("x/a{text}"))), Some(kind));
            assert_eq!(FileKind::from_path(Path::new(&format!("A{}", text.to_uppercase()))), Some(kind));
            assert_eq!(FileKind::from_path(Path::new(text)), Some(kind));
            assert_eq!(gzip, text.ends_with('z'));
        }
        for name in ["a.json", "a.svg.txt", "svg", "", "a.svg/b"] {
            assert_eq!(FileKind::from_path(Path::new(name)), None, "{name}");
        }
    }

    #[test]
    fn the_table_has_the_order_of_the_cases() {
        for (place, (format, writer)) in WRITERS.iter().enumerate() {
            assert_eq!(*format as usize, place, "{format:?}");
            assert_eq!(writer.name, format.writer().name);
        }
    }
}
