//! Files by kind, and writing them so that nothing is ever lost or left half done.

use crate::error::{Error, Result};
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use flate2::{Compression, GzBuilder};
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

/// What a file holds, told by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `.svg`, `.svgz`.
    Svg,
    /// `.png`.
    Png,
    /// `.scene.json`, `.scene.json.gz`.
    Scene,
    /// `.lib.json`, `.lib.json.gz`.
    Library,
}

/// What a file holds and whether it is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// What it holds.
    pub format: Format,
    /// Whether that is packed as gzip.
    pub gzip: bool,
}

impl Kind {
    /// The kind that a file name stands for, whatever its case; none for any other name.
    pub fn from_path(path: &Path) -> Option<Self> {
        const ENDINGS: [(&str, Format, bool); 7] = [
            (".svg", Format::Svg, false),
            (".svgz", Format::Svg, true),
            (".png", Format::Png, false),
            (".scene.json", Format::Scene, false),
            (".scene.json.gz", Format::Scene, true),
            (".lib.json", Format::Library, false),
            (".lib.json.gz", Format::Library, true),
        ];
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let (_, format, gzip) = ENDINGS.into_iter().find(|(ending, ..)| name.ends_with(ending))?;
        Some(Self { format, gzip })
    }
}

/// Packs what is written as gzip, always to the same bytes: no time, no name. Call
/// [`GzEncoder::finish`] at the end.
pub fn gzip<W: Write>(out: W) -> GzEncoder<W> {
    GzBuilder::new().mtime(0).write(out, Compression::best())
}

/// Writes a file as a whole or not at all: `content` writes to a temporary file in the same
/// folder, which then takes the place of the old one. If `content` fails, the old file stays as it
/// was and nothing is left behind. A device or pipe is written to directly.
///
/// # Errors
/// [`Error::Exists`] if there is a file that vtex did not write, unless `force`; whatever `content`
/// returns; [`Error::Write`].
pub fn write_file<T>(
    path: &Path,
    force: bool,
    content: impl FnOnce(&mut dyn Write) -> Result<T>,
) -> Result<T> {
    let fail = |e: io::Error| Error::write(path, e);
    // Writers do not know the path they write to.
    let named = |e: Error| match e {
        Error::Write { path, source } if path == Path::new("-") => fail(source),
        other => other,
    };
    let old = match fs::metadata(path) {
        Ok(found) => Some(found),
        Err(e) if e.kind() == io::ErrorKind::NotFound => None,
        Err(e) => return Err(fail(e)),
    };
    if let Some(old) = &old {
        if old.is_dir() {
            return Err(fail(io::ErrorKind::IsADirectory.into()));
        }
        if !old.is_file() {
            let mut out = BufWriter::new(File::options().write(true).open(path).map_err(fail)?);
            let value = content(&mut out).map_err(named)?;
            out.flush().map_err(fail)?;
            return Ok(value);
        }
        if !force && !is_ours(path)? {
            return Err(Error::Exists { path: path.to_owned() });
        }
    }
    // A link stays a link: the file that it points to is replaced.
    let target = if old.is_some() { fs::canonicalize(path).map_err(fail)? } else { path.to_owned() };
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".vtex-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
    let temporary = builder.tempfile_in(folder).map_err(fail)?;
    let mut out = BufWriter::new(temporary);
    let value = content(&mut out).map_err(named)?;
    let temporary = out.into_inner().map_err(|e| fail(e.into_error()))?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old.permissions()).map_err(fail)?;
    }
    // Some disks say only now that they are full.
    temporary.as_file().sync_all().map_err(fail)?;
    temporary.persist(&target).map_err(|e| fail(e.error))?;
    Ok(value)
}

/// Whether vtex wrote a file, told by its content: an SVG just as vtex begins it, a JSON document
/// whose first field is `"format": "vtex-…"`, one of these packed, or a PNG whose text says so. A
/// file that another program saved since does not count.
fn is_ours(path: &Path) -> Result<bool> {
    const ENOUGH: u64 = 4096;
    let mut start = Vec::new();
    let file = File::open(path).map_err(|e| Error::read(path, e))?;
    file.take(ENOUGH).read_to_end(&mut start).map_err(|e| Error::read(path, e))?;
    if start.starts_with(&[0x1f, 0x8b]) {
        let mut unpacked = Vec::new();
        // The data end in the middle, which is an error; what came before it is what counts.
        let _ = GzDecoder::new(&start[..]).take(ENOUGH).read_to_end(&mut unpacked);
        start = unpacked;
    }
    Ok(start.starts_with(super::svg::BEGINNING.as_bytes()) || is_document(&start) || is_png(&start))
}

fn is_document(start: &[u8]) -> bool {
    let mut rest = start.iter().filter(|b| !b.is_ascii_whitespace());
    b"{\"format\":\"vtex-".iter().all(|expected| rest.next() == Some(expected))
}

fn is_png(start: &[u8]) -> bool {
    let Some(mut rest) = start.strip_prefix(b"\x89PNG\r\n\x1a\n") else { return false };
    // Length, type, data, checksum.
    while let Some((head, after)) = rest.split_at_checked(8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if &head[4..] == b"tEXt" && after.starts_with(b"Software\0vtex ") {
            return true;
        }
        let Some(next) = length.checked_add(4).and_then(|n| after.get(n..)) else { return false };
        rest = next;
    }
    false
}
