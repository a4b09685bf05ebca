//! Files by kind, and safe replacement: a file is written as a whole or not at all.
//!
//! An existing file is replaced unasked only if vtex wrote it and nobody has changed it since
//! ([`seal`](super::seal)). While a file is written it has a temporary name and is locked. A temporary file
//! that nobody has locked was left by a killed process; the next write to the folder removes it.

use super::formats::{FileKind, signatures};
use super::seal::{self, Sealed};
use flate2::write::GzEncoder;
use flate2::{Compression, GzBuilder};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::NamedTempFile;
use vtex_base::error::{Error, Result};
use vtex_base::gzip;

/// Packs output as gzip, always to the same bytes: without time and name. Call [`GzEncoder::finish`] at the
/// end.
pub fn gzip<W: Write>(out: W) -> GzEncoder<W> {
    GzBuilder::new().mtime(0).write(out, Compression::best())
}

impl FileKind {
    /// Passes a writer to `content`, one that packs if files of this kind are packed. Packed content is sealed here, other
    /// content by the file that it is written to.
    ///
    /// # Errors
    /// Those of `content` and of writing.
    pub fn pack<T>(
        self,
        out: &mut dyn Write,
        content: impl FnOnce(&mut dyn Write) -> io::Result<T>,
    ) -> io::Result<T> {
        if !self.gzip {
            return content(out);
        }
        let mut packed = Sealed::new(gzip(out));
        let value = content(&mut packed)?;
        packed.finish()?.finish()?;
        Ok(value)
    }
}

/// Writes a file as a whole or not at all: `content` writes to a temporary file in the same
/// folder, which then takes the place of the old one. If `content` fails, the old file stays as it
/// was and nothing is left behind. A device or pipe is written to directly. Files of vtex are sealed
/// ([`super::seal`]). Gives what `content` returns and the number of bytes written.
///
/// # Errors
/// [`Error::Exists`] if there is a file that vtex did not write or that was changed since, unless
/// `force`; whatever `content` returns; [`Error::Write`].
pub fn write_file<T>(
    path: &Path,
    force: bool,
    content: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> Result<(T, u64)> {
    let fail = |e: io::Error| Error::write(path, e);
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
            let out = File::options().write(true).open(path).map_err(fail)?;
            return write_sealed(path, &out, content);
        }
        if !force {
            match existing_file(path)? {
                ExistingFile::Ours => {}
                other => {
                    let changed = other == ExistingFile::Changed;
                    return Err(Error::Exists { path: path.to_owned(), changed });
                }
            }
        }
    }
    // A link stays a link: the file that it points to is replaced.
    let target = if old.is_some() { fs::canonicalize(path).map_err(fail)? } else { path.to_owned() };
    // Reports the system's error if the folder does not exist.
    fs::metadata(folder_of(&target)).map_err(fail)?;
    // The error is reported without the temporary name, which means nothing to the user.
    let temporary = new_temporary(folder_of(&target)).map_err(|e| fail(e.kind().into()))?;
    let _unfinished = Unfinished::new(temporary.path());
    let written = write_sealed(path, temporary.as_file(), content)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old.permissions()).map_err(fail)?;
    }
    // Some file systems report a full disk only here.
    temporary.as_file().sync_all().map_err(fail)?;
    temporary.persist(&target).map_err(|e| fail(e.error))?;
    Ok(written)
}

/// Writes content, sealed, to an open file; `path` is for errors.
fn write_sealed<T>(
    path: &Path,
    file: &File,
    content: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> Result<(T, u64)> {
    let fail = |e: io::Error| Error::write(path, e);
    let mut out = Sealed::new(BufWriter::new(ByteCounter { out: file, count: 0 }));
    let value = content(&mut out).map_err(fail)?;
    let out = out.finish().map_err(fail)?.into_inner().map_err(|e| fail(e.into_error()))?;
    Ok((value, out.count))
}

/// Counts bytes.
struct ByteCounter<W> {
    out: W,
    count: u64,
}

impl<W: Write> Write for ByteCounter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.out.write(bytes)?;
        self.count += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The folder that a file is in.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

const PREFIX: &str = ".vtex-";
const SUFFIX: &str = ".tmp";

/// Creates a temporary file. It is locked as long as it is open, which tells other processes that it is being
/// written.
fn new_temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
    loop {
        let file = builder.tempfile_in(folder)?;
        // Without support for locks, no file counts as abandoned.
        let locked = file.as_file().lock().is_ok();
        // Before it was locked, another process may have removed it as abandoned.
        if !locked || file.path().exists() {
            return Ok(file);
        }
    }
}

/// Temporary files of this process.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A temporary file that [`remove_unfinished`] knows until this is dropped.
struct Unfinished(PathBuf);

impl Unfinished {
    fn new(path: &Path) -> Self {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.0);
    }
}

/// Removes the temporary files that this process is writing, for a program that is about to end.
pub fn remove_unfinished() {
    for path in &*UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner) {
        let _ = fs::remove_file(path);
    }
}

/// Removes the temporary files that killed processes left in the folder of a file: those without a lock.
/// Files that cannot be removed stay.
pub fn remove_abandoned(path: &Path) {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    for entry in fs::read_dir(folder_of(&target)).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let middle = name.to_str().and_then(|n| n.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
        let ours = middle.is_some_and(|m| m.len() == 6 && m.bytes().all(|b| b.is_ascii_alphanumeric()));
        if ours
            && entry.file_type().is_ok_and(|t| t.is_file())
            && let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// An existing file at the place of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ExistingFile {
    /// Written by vtex and unchanged.
    Ours,
    /// Written by vtex and changed since.
    Changed,
    Foreign,
}

/// Distinguishes files by their seal, else by their beginning.
fn existing_file(path: &Path) -> Result<ExistingFile> {
    let file = File::open(path).map_err(|e| Error::read(path, e))?;
    if seal::is_whole(file).map_err(|e| Error::read(path, e))? {
        Ok(ExistingFile::Ours)
    } else if begins_as_own(path)? {
        Ok(ExistingFile::Changed)
    } else {
        Ok(ExistingFile::Foreign)
    }
}

/// Whether vtex wrote a file, even if somebody has changed it since.
fn begins_as_own(path: &Path) -> Result<bool> {
    const HEAD: usize = 4096;
    let fail = |e| Error::read(path, e);
    let mut file = &File::open(path).map_err(fail)?;
    let mut start = Vec::new();
    file.take(HEAD as u64).read_to_end(&mut start).map_err(fail)?;
    // The data may be cut off; only the beginning matters.
    let start = gzip::beginning(&start, HEAD);
    for signature in signatures() {
        if (signature.is_own)(&start, &mut file).map_err(fail)? {
            return Ok(true);
        }
    }
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{png, svg, testing};

    fn put(path: &Path, force: bool, text: &str) -> Result<()> {
        write_file(path, force, |w| w.write_all(text.as_bytes())).map(drop)
    }

    /// The bytes written of some content.
    fn seal(content: &[u8]) -> Vec<u8> {
        let mut out = Sealed::new(Vec::new());
        out.write_all(content).unwrap();
        out.finish().unwrap()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn failing_content_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.svg");
        put(&path, false, "old").unwrap();
        let failed = write_file(&path, true, |w| {
            w.write_all(&[b'x'; 100_000]).unwrap();
            Err::<(), _>(io::ErrorKind::StorageFull.into())
        });
        let error = failed.unwrap_err();
        assert!(matches!(&error, Error::Write { path: p, .. } if p == &path), "{error}");
        let failed =
            write_file(&folder.path().join("new.svg"), false, |_| Err::<(), _>(Error::Interrupted.into()));
        assert!(matches!(failed, Err(Error::Interrupted)));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.svg"]);
    }

    #[test]
    fn only_own_files_are_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let scene = testing::scene(40, 40, 1);
        let mut drawn = Vec::new();
        svg::write(&scene, &svg::SvgOptions::default(), &mut drawn).unwrap();
        let pack = |bytes: &[u8]| {
            let mut packed = gzip(Vec::new());
            packed.write_all(bytes).unwrap();
            packed.finish().unwrap()
        };
        let mut picture = Vec::new();
        png::encode(&png::render(&scene, 1.0).unwrap(), None, None, &mut picture).unwrap();
        let unsealed = testing::files(&scene);
        let own = unsealed.iter().map(|content| seal(content));
        let own = own.chain([pack(&seal(&drawn)), pack(&seal(&scene.to_json()))]);
        for (i, content) in own.enumerate() {
            fs::write(&path, &content).unwrap();
            put(&path, false, "new").unwrap_or_else(|e| panic!("{i}: {e}"));
            assert_eq!(fs::read(&path).unwrap(), b"new");
            // Added or changed bytes mean that somebody has worked on the file.
            let appended = [&content[..], b"<!-- mine -->"].concat();
            fs::write(&path, &appended).unwrap();
            let refused = put(&path, false, "new");
            assert!(matches!(refused, Err(Error::Exists { changed: true, .. })), "{i}");
            assert_eq!(fs::read(&path).unwrap(), appended);
        }
        // A change by hand in a text editor.
        let text = String::from_utf8(seal(&drawn)).unwrap();
        for (from, to) in [("Background", "Backdrop"), ("fill=\"#", "fill=\"#0"), ("</svg>\n", "</svg>")] {
            let edited = text.replacen(from, to, 1);
            assert_ne!(edited, text);
            fs::write(&path, &edited).unwrap();
            let refused = put(&path, false, "new");
            assert!(matches!(refused, Err(Error::Exists { changed: true, .. })), "{from}");
        }

        let resaved = String::from_utf8(drawn).unwrap().replacen("UTF-8\"", "UTF-8\" standalone=\"no\"", 1);
        let from_elsewhere = {
            let at = picture.windows(5).position(|w| w == b"vtex ").unwrap();
            [&picture[..at], b"gimp ", &picture[at + 5..]].concat()
        };
        let foreign: [&[u8]; 9] = [
            b"%PDF-1.7\n1 0 obj <</Producer (other)>> endobj\n%%EOF",
            b"",
            b"my notes",
            b"{\"format\":\"other\"}",
            b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>",
            b"\x1f\x8b\x08",
            b"\x89PNG\r\n\x1a\n\xff\xff\xff\xffIDAT",
            resaved.as_bytes(),
            &from_elsewhere,
        ];
        for (i, content) in foreign.iter().enumerate() {
            fs::write(&path, content).unwrap();
            let refused = put(&path, false, "new");
            assert!(matches!(refused, Err(Error::Exists { changed: false, .. })), "{i}");
            assert_eq!(&fs::read(&path).unwrap(), content);
            put(&path, true, "new").unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"new");
        }
    }

    #[test]
    fn only_abandoned_files_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.svg");
        for name in [".vtex-aB3dEf.tmp", ".vtex-mine.tmp", "vtex-aB3dEf.tmp"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        fs::create_dir(folder.path().join(".vtex-folder.tmp")).unwrap();
        // A file that is being written stays.
        write_file(&path, false, |w| {
            w.write_all(b"begun").unwrap();
            remove_abandoned(&path);
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"begun");
        assert_eq!(names(folder.path()), [".vtex-folder.tmp", ".vtex-mine.tmp", "a.svg", "vtex-aB3dEf.tmp"]);
    }

    #[test]
    fn folders_that_are_missing_or_in_the_way() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("missing/a.svg")] {
            assert!(matches!(put(&path, true, "new"), Err(Error::Write { .. })), "{}", path.display());
        }
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.svg"), folder.path().join("link.svg"));
        put(&path, false, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        put(&link, true, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        put(Path::new("/dev/null"), false, "gone").unwrap();
    }

    #[test]
    fn packing_gives_the_same_bytes() {
        let pack = || {
            let mut out = gzip(Vec::new());
            out.write_all(b"texture").unwrap();
            out.finish().unwrap()
        };
        assert_eq!(pack(), pack());
        assert_eq!(pack()[4..8], [0; 4], "no time");
    }
}
