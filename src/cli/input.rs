//! Files and standard input, and the kinds of their content.

use super::failure::Failure;
use super::interrupt;
use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use vtex::error::Large;
use vtex::output::file::{FileKind, Format};
use vtex::{Error, Result};

/// Most bytes read from a file or from standard input.
const LARGEST: u64 = 2 << 30;

/// Most bytes read of content that is neither picture, SVG, JSON nor gzip.
const UNKNOWN: u64 = 1 << 20;

/// The files that this process has read as inputs, links resolved.
static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Registers a file as an input, so that no result replaces it.
pub(crate) fn note_read(path: &Path) {
    if let Ok(path) = path.canonicalize() {
        READ.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
    }
}

/// Whether a file has been read as an input, by any path.
pub(crate) fn was_read(path: &Path) -> bool {
    path.canonicalize().is_ok_and(|path| READ.lock().unwrap_or_else(PoisonError::into_inner).contains(&path))
}

/// Reads a text file written by the user, such as a configuration.
///
/// # Errors [`Error::Read`], also for a file that is not UTF-8; [`Error::TooLarge`] beyond 16 MiB.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    const MOST: u64 = 16 << 20;
    let mut text = String::new();
    let file = std::fs::File::open(path).map_err(|e| Error::read(path, e))?;
    file.take(MOST + 1).read_to_string(&mut text).map_err(|e| Error::read(path, e))?;
    if text.len() as u64 > MOST {
        let (found, limit) = ("more than 16 MiB of text".into(), "16 MiB".into());
        return Err(Error::TooLarge { what: Large::File, name: path.display().to_string(), found, limit });
    }
    note_read(path);
    Ok(text)
}

/// The source of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Input {
    Stdin,
    File(PathBuf),
}

impl Input {
    /// `-` is standard input.
    pub(crate) fn new(path: PathBuf) -> Self {
        if path.as_os_str() == "-" { Self::Stdin } else { Self::File(path) }
    }

    /// The path as given, `-` for standard input.
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Stdin => Path::new("-"),
            Self::File(path) => path,
        }
    }

    /// [`Input::path`] as text.
    pub(crate) fn name(&self) -> String {
        self.path().display().to_string()
    }

    /// All bytes.
    pub(crate) fn read(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let read = interrupt::waiting(|| match self {
            Self::Stdin => read_known(std::io::stdin().lock(), &mut bytes),
            Self::File(path) => std::fs::File::open(path).and_then(|f| read_known(f, &mut bytes)),
        });
        read.map_err(|e| Error::read(self.path(), e))?;
        if let Self::File(path) = self {
            note_read(path);
        }
        if bytes.len() as u64 > LARGEST {
            let (found, limit) = ("more than 2 GiB".into(), "2 GiB".into());
            return Err(Error::TooLarge { what: Large::File, name: self.name(), found, limit });
        }
        Ok(bytes)
    }
}

/// Reads all content of a known kind, or the beginning of unknown content, which may be endless.
fn read_known(mut from: impl Read, bytes: &mut Vec<u8>) -> std::io::Result<()> {
    from.by_ref().take(HEAD as u64).read_to_end(bytes)?;
    let start = bytes.trim_ascii_start();
    let begins = |beginnings: &[&[u8]]| beginnings.iter().any(|b| start.starts_with(b));
    // Text may be masks or a table and contains no zeros; the kind of packed data is not known yet.
    let text = !bytes.contains(&0) && begins(&[b"{", b"<", b"\xef\xbb\xbf"]);
    let known = InputKind::of(bytes) != InputKind::Unknown || text || begins(&[b"\x1f\x8b"]);
    let most = if known { LARGEST + 1 } else { UNKNOWN };
    from.take(most - HEAD as u64).read_to_end(bytes)?;
    Ok(())
}

/// The kind of a file, by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InputKind {
    Library,
    Scene,
    Svg,
    Image,
    Unknown,
}

impl InputKind {
    /// Recognises content, plain or gzip, by its first bytes.
    pub(crate) fn of(bytes: &[u8]) -> Self {
        let head = vtex::gzip::beginning(bytes, HEAD);
        if vtex::raster::is_picture(&head) {
            return Self::Image;
        }
        let text = String::from_utf8_lossy(&head);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let named = |name: &str| text.contains(&format!("\"{name}\""));
        if text.starts_with('{') {
            if named(vtex::scene::Scene::FORMAT) {
                return Self::Scene;
            }
            if named(vtex::library::Library::FORMAT) {
                return Self::Library;
            }
        }
        if vtex::import::is_drawing(bytes) { Self::Svg } else { Self::Unknown }
    }

    /// The kind, which must be one of `wanted`; otherwise an error that says what the file is and
    /// which command reads it.
    pub(crate) fn expect(bytes: &[u8], input: &Input, wanted: &[Self]) -> Result<Self, Failure> {
        // The reader of a damaged document gives the most precise error.
        let kind = match (Self::of(bytes), FileKind::from_path(input.path()).map(|k| k.format)) {
            (Self::Unknown, Some(Format::Library)) => Self::Library,
            (Self::Unknown, Some(Format::Scene)) => Self::Scene,
            (kind, _) => kind,
        };
        if wanted.contains(&kind) {
            return Ok(kind);
        }
        let known = wanted.iter().filter(|k| **k != Self::Unknown);
        let names: Vec<&str> = known.map(|k| k.name()).collect();
        let found =
            if bytes.is_empty() { "is empty".to_owned() } else { format!("contains {}", kind.name()) };
        let failure = Failure::failed(format!("'{}' {found}, not {}", input.name(), names.join(", not ")));
        Err(match kind {
            Self::Library => failure.hint("make a texture of it with 'vtex synth'"),
            Self::Image | Self::Svg if wanted.contains(&Self::Library) => {
                failure.hint("make a library of it with 'vtex analyze' first")
            }
            Self::Scene | Self::Svg => failure.hint("draw it with 'vtex render'"),
            Self::Image => failure.hint("make a library of it with 'vtex analyze' first"),
            Self::Unknown if bytes.is_empty() => failure.hint("is the file complete?"),
            Self::Unknown => failure.hint("libraries are made by 'vtex analyze', scenes by 'vtex synth'"),
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Library => "a library",
            Self::Scene => "a scene",
            Self::Svg => "an SVG",
            Self::Image => "an image",
            Self::Unknown => "something else",
        }
    }
}

/// Number of bytes that are examined; vtex writes the name of the format first.
const HEAD: usize = 4096;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nothing_known_is_read_no_further_than_need_be() {
        let read = |beginning: &[u8]| {
            let mut bytes = Vec::new();
            read_known(beginning.chain(std::io::repeat(0)).take(3 << 20), &mut bytes).unwrap();
            bytes.len() as u64
        };
        assert_eq!((read(b""), read(b"noise"), read(b" {")), (UNKNOWN, UNKNOWN, UNKNOWN));
        assert_eq!((read(b"\x89PNG\r\n\x1a\n"), read(b"\x1f\x8b")), (3 << 20, 3 << 20));
        let mut bytes = Vec::new();
        read_known(std::io::repeat(b'{').take(3 << 20), &mut bytes).unwrap();
        assert_eq!(bytes.len(), 3 << 20);
    }

    #[test]
    fn content_tells_the_kind() {
        assert_eq!(InputKind::of(b" \n{\"format\":\"vtex-library\"}"), InputKind::Library);
        assert_eq!(InputKind::of(b"{\"version\":1,\"format\":\"vtex-scene\"}"), InputKind::Scene);
        assert_eq!(InputKind::of(b"\xef\xbb\xbf<?xml version='1.0'?><!-- c --><svg/>"), InputKind::Svg);
        assert_eq!(InputKind::of(b"\x89PNG\r\n\x1a\n...."), InputKind::Image);
        let wide: Vec<u8> = "\u{feff}<svg/>".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(InputKind::of(&wide), InputKind::Svg);
        assert_eq!(InputKind::of(b""), InputKind::Unknown);
        assert_eq!(InputKind::of(b"\x1f\x8b damaged"), InputKind::Unknown);
    }
}
