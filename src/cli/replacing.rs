//! Replacing of textures: a picture of another seed or of another exemplar is not replaced without asking.
//!
//! A seed that was chosen at random is stored only in the picture, so replacing the picture loses it. On a
//! terminal the user is asked. Scripts are not stopped, because they write the same file again on purpose;
//! the replaced seed is printed.

use super::common::Common;
use super::failure::Failure;
use super::foreign::line;
use super::interrupt;
use super::output::{Destination, Target, Targets};
use super::progress::Reporter;
use super::recipe::metadata;
use std::fs::File;
use std::io::{self, IsTerminal, Read};
use std::path::Path;
use vtex::output::file::Format;

/// Number of bytes of a file that are searched for its seed.
const HEAD: u64 = 1 << 20;

/// The origin of a texture: its seed and exemplars.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TextureOrigin {
    pub(crate) seed: u64,
    /// Width and height of its canvas, in pixels, if they are known.
    pub(crate) size: Option<[u32; 2]>,
    /// SHA-256 of its exemplars; `None` if they are not known.
    pub(crate) exemplars: Option<Vec<String>>,
}

/// A picture that is about to be replaced by another.
struct Loss<'a> {
    path: &'a Path,
    seed: u64,
    /// Its size, if the new picture has another.
    size: Option<[u32; 2]>,
    /// Names of its exemplars, if it states them.
    names: Vec<String>,
}

/// The origin stored in a picture, and the names of its exemplars.
type Found = (TextureOrigin, Vec<String>);

impl TextureOrigin {
    /// Whether the origins differ, as far as both are known.
    fn differs(&self, other: &Self) -> bool {
        let exemplars = self.exemplars.as_ref().zip(other.exemplars.as_ref());
        self.seed != other.seed || exemplars.is_some_and(|(a, b)| a != b)
    }
}

/// Asks on a terminal before pictures are replaced by others; elsewhere returns a hint how to make the first
/// of them again, to be printed after it is replaced. `made` are the pictures that will be written, with
/// their origins.
///
/// # Errors
/// An answer that is not yes.
pub(crate) fn ask(
    common: &Common,
    reporter: &Reporter,
    made: &[(Targets, TextureOrigin)],
) -> anyhow::Result<Option<String>> {
    let lost: Vec<Loss<'_>> =
        made.iter().flat_map(|(targets, origin)| targets.all().filter_map(|t| loss(t, origin))).collect();
    let Some(first) = lost.first() else { return Ok(None) };
    let path = first.path.display();
    let of = if first.names.is_empty() { String::new() } else { format!(" of {}", first.names.join(", ")) };
    let texture = format!("'{path}' contains another texture{of}, with the seed {}", first.seed);
    let asks = !common.quiet && !common.json && io::stdin().is_terminal() && io::stderr().is_terminal();
    if !asks {
        let size = first.size.map_or(String::new(), |[w, h]| format!(" --size {w}x{h}"));
        return Ok(Some(format!(
            "'{path}' held another texture{of}: --seed {}{size}, with its other options, makes it again",
            first.seed
        )));
    }
    let more = match lost.len() - 1 {
        0 => String::new(),
        1 => ", and so does 1 more file".into(),
        n => format!(", and so do {n} more files"),
    };
    let answer = reporter.with_bar_hidden(|| {
        anstream::eprint!("{}; replace it? [y/N] ", line(&format!("{texture}{more}")));
        let mut answer = String::new();
        // An answer that cannot be read does not count as consent.
        let _ = interrupt::waiting(|| io::stdin().read_line(&mut answer));
        answer
    });
    if ["y", "yes"].contains(&answer.trim().to_lowercase().as_str()) {
        return Ok(None);
    }
    let failure = Failure::failed(format!("'{path}' was kept"));
    Err(failure.hint("give another name with -o, or --force to replace it unasked").into())
}

/// The picture that a target replaces, if it was made from something else.
fn loss<'a>(target: &'a Target, origin: &TextureOrigin) -> Option<Loss<'a>> {
    let Destination::File { path, force: false } = &target.place else { return None };
    let (old, names) = match target.kind.format {
        Format::Svg => of_svg(path),
        Format::Png => of_png(path),
        Format::Pdf | Format::Scene | Format::Library => None,
    }?;
    let size = old.size.filter(|size| origin.size != Some(*size));
    old.differs(origin).then(|| Loss { path, seed: old.seed, size, names })
}

/// The first bytes of a file; `None` for anything else, because opening a pipe has effects at its other end.
fn head(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::metadata(path).ok().filter(|m| m.is_file())?;
    File::open(path).ok()?.take(HEAD).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// The origin stored in an SVG, and the names of its exemplars.
fn of_svg(path: &Path) -> Option<Found> {
    let found = metadata(&head(path)?)?;
    let libraries = found["libraries"].as_array()?;
    let each = |key: &str| libraries.iter().map(|l| Some(l[key].as_str()?.to_owned())).collect::<Option<_>>();
    let side = |key: &str| u32::try_from(found[key].as_u64()?).ok();
    let size = side("width").zip(side("height")).map(<[u32; 2]>::from);
    Some((
        TextureOrigin { seed: found["seed"].as_u64()?, size, exemplars: each("sha256") },
        each("exemplar")?,
    ))
}

/// The seed of a PNG, which names no exemplars.
fn of_png(path: &Path) -> Option<Found> {
    const BEGINNING: &[u8] = b"tEXtSeed\0";
    let bytes = head(path)?;
    let at = bytes.windows(BEGINNING.len()).position(|w| w == BEGINNING)?;
    let length = u32::from_be_bytes(bytes.get(at.checked_sub(4)?..at)?.try_into().ok()?);
    let text = bytes.get(at + BEGINNING.len()..at.checked_add(4)?.checked_add(length as usize)?)?;
    let seed = std::str::from_utf8(text).ok()?.parse().ok()?;
    Some((TextureOrigin { seed, size: None, exemplars: None }, Vec::new()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_read_from_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let of = |bytes: &[u8], read: fn(&Path) -> Option<Found>| {
            std::fs::write(&path, bytes).unwrap();
            read(&path)
        };
        let svg = br#"<svg><metadata>{"seed":18446744073709551615,"width":30,"height":20,"libraries":[{"exemplar":"a.jpg","sha256":"x"}]}</metadata>"#;
        let origin =
            TextureOrigin { seed: u64::MAX, size: Some([30, 20]), exemplars: Some(vec!["x".into()]) };
        assert_eq!(of(svg, of_svg), Some((origin.clone(), vec!["a.jpg".into()])));
        assert_eq!(of(b"<svg/>", of_svg), None);
        let png = of(b"\x89PNG\0\0\0\x07tEXtSeed\x0077crc", of_png);
        assert_eq!(png, Some((TextureOrigin { seed: 77, size: None, exemplars: None }, Vec::new())));
        for damaged in [&b"\xff\xff\xff\xfftEXtSeed\x0077crc"[..], b"tEXtSeed\0", b"\0\0\0\0tEXtSeed\x007"] {
            assert_eq!(of(damaged, of_png), None);
        }
        assert!(!origin.differs(&TextureOrigin { exemplars: None, ..origin.clone() }));
        assert!(origin.differs(&TextureOrigin { exemplars: Some(Vec::new()), ..origin.clone() }));
        assert!(origin.differs(&TextureOrigin { seed: 1, ..origin.clone() }));
    }
}
