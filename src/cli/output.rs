//! Places of results: files that are replaced as a whole, or standard output.
//!
//! A scene goes from [`Targets`] to each [`Target`], whose [`Destination`] opens the file; into it a [`PreparedFile`] is
//! written by its format.

use super::foreign::{escaped, escaped_json, styled};
use super::input::was_read;
use super::interrupt;
use super::options::render::RenderParameters;
use super::options::svg::{SvgForm, SvgParameters};
use super::values::{Bytes, Resolution};
use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tiny_skia::Pixmap;
use vtex::flow::Flowing;
use vtex::interpolate::Interpolation;
use vtex::library::Library;
use vtex::output::file::{
    FileKind, Format, PreparedFile, Uses, WriteOptions, coloured, remove_abandoned, users_of, write_file,
};
use vtex::output::reduce::GivenUp;
use vtex::output::seal::Sealed;
use vtex::output::{png, svg};
use vtex::scene::{Length, LengthUnit, Scene, page_at};
use vtex::{Error, Progress, Result};

/// A file, standard output or memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Destination {
    Stdout,
    File {
        path: PathBuf,
        force: bool,
    },
    #[cfg(feature = "studio")]
    Memory(Buffer),
}

/// Bytes in memory, which all copies share, and the caller who waits for them.
#[cfg(feature = "studio")]
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffer(std::sync::Arc<Mutex<Vec<u8>>>, vtex_studio::Caller);

#[cfg(feature = "studio")]
impl Buffer {
    /// An empty one, to which nothing more is written once the caller has left.
    pub(crate) fn of(caller: &vtex_studio::Caller) -> Self {
        Self(std::sync::Arc::default(), caller.clone())
    }

    /// The bytes, of which none are left.
    pub(crate) fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(feature = "studio")]
impl PartialEq for Buffer {
    fn eq(&self, other: &Self) -> bool {
        std::sync::Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(feature = "studio")]
impl Eq for Buffer {}

/// A place and the kind of its content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) place: Destination,
    pub(crate) kind: FileKind,
}

/// One place or several for one result, at most one of them standard output. The first names it.
#[derive(Clone, Debug)]
pub(crate) struct Targets {
    pub(crate) first: Target,
    pub(crate) others: Vec<Target>,
}

/// Options of drawing and writing a scene, besides the formats of the file names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawingOptions<'a> {
    pub(crate) svg: SvgParameters,
    pub(crate) render: RenderParameters,
    /// The recipe in the metadata of an SVG.
    pub(crate) recipe: Option<&'a Value>,
}

impl DrawingOptions<'_> {
    /// A picture of a scene.
    ///
    /// # Errors
    /// Those of [`png::render`].
    pub(crate) fn picture(&self, scene: &Scene) -> Result<Pixmap> {
        self.picture_with(scene, &())
    }

    /// A picture of a scene, which can be stopped.
    ///
    /// # Errors
    /// Those of [`png::render_page`].
    pub(crate) fn picture_with(&self, scene: &Scene, progress: &dyn Progress) -> Result<Pixmap> {
        png::render_page(&*self.scene(scene)?, self.render.scale, progress)
    }

    /// The page of a scene, or that at the resolution of the options.
    pub(crate) fn page(&self, scene: &Scene) -> Option<[Length; 2]> {
        match self.render.dpi {
            Resolution(None) => scene.page,
            Resolution(Some(dpi)) => page_at([scene.width, scene.height], dpi),
        }
    }

    /// Refuses a scene that cannot be drawn as the options say.
    ///
    /// # Errors
    /// Those of [`Scene::with_ink`] and of [`svg::check_fill`].
    pub(crate) fn check(&self, scene: &Scene) -> Result<()> {
        let scene = self.scene(scene)?;
        if self.svg.form == SvgForm::Pattern { svg::check_fill(&scene) } else { Ok(()) }
    }

    /// The scene with the ink, the background and the page of the options.
    fn scene<'s>(&self, scene: &'s Scene) -> Result<Cow<'s, Scene>> {
        let page = self.page(scene);
        let scene = match page == scene.page {
            true => Cow::Borrowed(scene),
            false => Cow::Owned(Scene { page, ..scene.clone() }),
        };
        coloured(scene, self.render.ink, self.render.background)
    }

    /// Size of a scene that is written in a format, in pixels: that of a picture, or of the canvas of a vector file on a
    /// page in lengths.
    pub(crate) fn size_of(&self, scene: &Scene, format: Format) -> [u32; 2] {
        match self.page(scene) {
            _ if format.uses().scale => scene.picture_size(self.render.scale),
            Some(page) if page[0].unit() != LengthUnit::Pixel => [scene.width, scene.height],
            _ => scene.picture_size(1.0),
        }
    }

    /// The options of the writers of files.
    fn write_options(&self) -> WriteOptions<'_> {
        WriteOptions {
            svg: self.svg.into(),
            max_bytes: self.svg.max_bytes.map(|Bytes(most)| most),
            scale: self.render.scale,
            recipe: self.recipe,
            pattern: false,
        }
    }
}

/// A written file.
#[derive(Debug, Default)]
pub(crate) struct WrittenFile {
    /// Bytes of the first file.
    pub(crate) bytes: u64,
    /// The other files and their bytes.
    pub(crate) others: Vec<(PathBuf, u64)>,
    /// Warnings of the writer.
    pub(crate) warnings: Vec<String>,
    /// Reductions that made it small enough.
    pub(crate) given_up: Option<GivenUp>,
}

impl WrittenFile {
    /// `bytes` written, no warnings.
    pub(crate) fn of(bytes: u64) -> Self {
        Self { bytes, ..Self::default() }
    }
}

/// The folders that were already searched for files left by killed processes.
static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

impl Destination {
    /// The path, `-` for standard output.
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Stdout => Path::new("-"),
            Self::File { path, .. } => path,
            #[cfg(feature = "studio")]
            Self::Memory(_) => Path::new("memory"),
        }
    }

    /// Who may stop the work on the file.
    fn progress(&self) -> &dyn Progress {
        #[cfg(feature = "studio")]
        if let Self::Memory(buffer) = self {
            return &buffer.1;
        }
        &interrupt::Requests
    }

    /// Fails early if writing would fail for a known reason: a foreign file, or a folder that is missing or
    /// not writable. Changes nothing.
    ///
    /// # Errors
    /// As [`write_file`].
    pub(crate) fn probe(&self) -> Result<()> {
        let Self::File { path, force } = self else { return Ok(()) };
        // Opening a pipe or device would have effects at its other end.
        if fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir()) {
            return Ok(());
        }
        match write_file(path, *force, |_| Err::<(), _>(Error::Interrupted.into())) {
            Err(Error::Interrupted) | Ok(_) => Ok(()),
            Err(e) => Err(e),
        }
    }

    /// Passes a writer to `content`; the output is sealed. A file appears, or is replaced, only when it is
    /// complete.
    ///
    /// # Errors
    /// Those of `content` and of [`write_file`]; [`Error::Interrupted`].
    pub(crate) fn write<T>(&self, content: impl FnOnce(&mut dyn Write) -> io::Result<T>) -> Result<(T, u64)> {
        if let Self::File { path, .. } = self {
            if was_read(path) {
                return Err(Error::write(path, io::Error::other("this command has read it as an input")));
            }
            let folder = path.parent().map(Path::to_owned).unwrap_or_default();
            if SWEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(folder) {
                remove_abandoned(path);
            }
        }
        let outcome = match self {
            Self::Stdout => interrupt::waiting(|| {
                let fail = |e| Error::write(self.path(), e);
                check_open().map_err(fail)?;
                let out = StoppableByteCounter::new(io::BufWriter::new(io::stdout().lock()));
                let mut out = Sealed::new(out);
                let value = content(&mut out).map_err(fail)?;
                let mut out = out.finish().map_err(fail)?;
                out.flush().map_err(fail)?;
                Ok((value, out.count))
            }),
            #[cfg(feature = "studio")]
            Self::Memory(buffer) => {
                let fail = |e| Error::write(self.path(), e);
                let bytes = StoppedByCaller { out: Vec::new(), caller: &buffer.1 };
                let mut out = Sealed::new(StoppableByteCounter::new(bytes));
                let value = content(&mut out).map_err(fail)?;
                let StoppableByteCounter { out: StoppedByCaller { out, .. }, count } =
                    out.finish().map_err(fail)?;
                *buffer.0.lock().unwrap_or_else(PoisonError::into_inner) = out;
                Ok((value, count))
            }
            Self::File { path, force } => write_file(path, *force, |out| {
                let mut out = StoppableByteCounter::new(out);
                let value = content(&mut out)?;
                interrupt::check()?;
                Ok(value)
            }),
        };
        outcome.map_err(or_interrupted)
    }
}

/// Fails if standard output was closed when the program began. Rust opens the null device in its place, for
/// reading and writing; a user who discards output opens it for writing only.
#[cfg(unix)]
fn check_open() -> io::Result<()> {
    use std::os::unix::fs::MetadataExt;
    let flags = rustix::fs::fcntl_getfl(io::stdout())?;
    let found = rustix::fs::fstat(io::stdout())?;
    let null = fs::metadata("/dev/null").is_ok_and(|null| null.rdev() == found.st_rdev as u64);
    let device = rustix::fs::FileType::from_raw_mode(found.st_mode).is_char_device();
    if null && device && flags.contains(rustix::fs::OFlags::RDWR) {
        return Err(io::Error::other("it is closed, or leads nowhere"));
    }
    Ok(())
}

#[cfg(not(unix))]
fn check_open() -> io::Result<()> {
    Ok(())
}

/// [`Error::Interrupted`] if the user asked to stop, in place of errors that the stop caused.
fn or_interrupted(error: Error) -> Error {
    if interrupt::is_requested() { Error::Interrupted } else { error }
}

impl Targets {
    /// All targets.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Target> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// Fails early if a file could not be written later.
    ///
    /// # Errors
    /// As [`Destination::probe`].
    pub(crate) fn probe(&self) -> Result<()> {
        self.all().try_for_each(|target| target.place.probe())
    }

    /// The first place, which names the result.
    pub(crate) fn path(&self) -> &Path {
        self.first.place.path()
    }

    /// Whether standard output is among them.
    pub(crate) fn piped(&self) -> bool {
        self.all().any(|target| target.place == Destination::Stdout)
    }

    /// Whether a file of a format is among them.
    pub(crate) fn has(&self, format: Format) -> bool {
        self.all().any(|target| target.kind.format == format)
    }

    /// Whether one of their formats uses an option.
    pub(crate) fn any_uses(&self, option: fn(&Uses) -> bool) -> bool {
        self.all().any(|target| option(&target.kind.format.uses()))
    }

    /// Writes a scene to all targets, or its library where the file name stands for one.
    ///
    /// # Errors
    /// As [`Target::write_scene`].
    pub(crate) fn write_scene(
        &self,
        scene: &Scene,
        library: Option<&Library>,
        drawing: DrawingOptions<'_>,
    ) -> Result<WrittenFile> {
        let mut written = self.each(|target| match (target.kind.format, library) {
            (Format::Library, Some(library)) => target.write_bytes(&library.to_json()),
            _ => target.write_scene(scene, drawing),
        })?;
        if drawing.svg.max_bytes.is_some() && !self.any_uses(|uses| uses.max_bytes) {
            let users = users_of(|uses| uses.max_bytes);
            written.warnings.push(format!("--max-bytes has no effect here: it is for {users}"));
        }
        Ok(written)
    }

    /// Writes to all targets, one after the other.
    ///
    /// # Errors
    /// Those of `write`.
    pub(crate) fn each(&self, write: impl Fn(&Target) -> Result<WrittenFile>) -> Result<WrittenFile> {
        let mut all = write(&self.first)?;
        for target in &self.others {
            let one = write(target)?;
            all.others.push((target.place.path().to_owned(), one.bytes));
            all.warnings.extend(one.warnings);
            all.given_up = all.given_up.or(one.given_up);
        }
        Ok(all)
    }
}

impl Target {
    /// Writes bytes, packed if the file name ends so.
    ///
    /// # Errors
    /// As [`Destination::write`].
    pub(crate) fn write_bytes(&self, bytes: &[u8]) -> Result<WrittenFile> {
        let (_, count) = self.place.write(|out| self.kind.pack(out, |out| out.write_all(bytes)))?;
        Ok(WrittenFile::of(count))
    }

    /// Writes a scene in the format of the file name, which uses some of the options.
    ///
    /// # Errors
    /// As [`Destination::write`], and those of [`PreparedFile`].
    pub(crate) fn write_scene(&self, scene: &Scene, drawing: DrawingOptions<'_>) -> Result<WrittenFile> {
        self.write_prepared(&*drawing.scene(scene)?, drawing.write_options())
    }

    /// Writes a scene as a pattern. The background may have one colour, but may not be missing.
    ///
    /// # Errors
    /// As [`Target::write_scene`].
    pub(crate) fn write_pattern(&self, scene: &Scene, drawing: DrawingOptions<'_>) -> Result<WrittenFile> {
        let options = WriteOptions { pattern: true, ..drawing.write_options() };
        self.write_prepared(&*drawing.scene(scene)?, options)
    }

    fn write_prepared(&self, scene: &Scene, options: WriteOptions<'_>) -> Result<WrittenFile> {
        let progress = self.place.progress();
        let file = PreparedFile::new(self.kind, scene, options, progress)
            .map_err(|e| or_interrupted(Error::write(self.place.path(), e)))?;
        let (warnings, bytes) = self.place.write(|out| file.write(progress, out))?;
        Ok(WrittenFile { bytes, warnings, given_up: file.given_up, others: Vec::new() })
    }

    /// Writes the interpolation of two scenes as an animated SVG.
    ///
    /// # Errors
    /// As [`Destination::write`], and those of [`svg::write_animation`].
    pub(crate) fn write_animation(
        &self,
        way: &Interpolation,
        animation: &svg::Animation,
    ) -> Result<WrittenFile> {
        let (summary, bytes) =
            self.place.write(|out| self.kind.pack(out, |w| svg::write_animation(way, animation, w)))?;
        Ok(WrittenFile { bytes, warnings: summary.warnings, ..WrittenFile::default() })
    }

    /// Writes a scene in a flow; a loop takes `seconds`.
    ///
    /// # Errors
    /// As [`Destination::write`], and those of [`svg::write_flow`].
    pub(crate) fn write_flow(
        &self,
        flowing: &Flowing,
        seconds: f64,
        options: &svg::SvgOptions,
    ) -> Result<WrittenFile> {
        let write = |out: &mut dyn Write| svg::write_flow(flowing, seconds, options, out);
        let (summary, bytes) = self.place.write(|out| self.kind.pack(out, |w| write(w)))?;
        Ok(WrittenFile { bytes, warnings: summary.warnings, ..WrittenFile::default() })
    }
}

/// Prints data on standard output.
///
/// # Errors
/// [`Error::Write`] with the path `-`.
pub(crate) fn print(data: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    let printed = out.write_all(data).and_then(|()| out.flush());
    Ok(printed.map_err(|e| Error::write(Destination::Stdout.path(), e))?)
}

/// Prints a report in JSON on standard output, or on stderr if that carries data. Characters that would
/// control the terminal are escaped.
///
/// # Errors
/// [`Error::Write`] with the path `-`.
pub(crate) fn print_json(report: &impl Serialize, stdout_is_taken: bool) -> anyhow::Result<()> {
    let text = escaped_json(&serde_json::to_string_pretty(report)?);
    if stdout_is_taken {
        say(&text);
        return Ok(());
    }
    print(format!("{text}\n").as_bytes())
}

/// Prints text that may hold colours, which are removed if standard output does not take them.
///
/// # Errors
/// [`Error::Write`] with the path `-`.
pub(crate) fn print_styled(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    let printed = out.write_all(styled(text).as_bytes()).and_then(|()| out.flush());
    Ok(printed.map_err(|e| Error::write(Destination::Stdout.path(), e))?)
}

/// Prints a message on stderr, in lines. Errors are ignored, because stderr may be closed.
pub(crate) fn say(text: &str) {
    say_styled(&text.split('\n').map(escaped).collect::<Vec<_>>().join("\n"));
}

/// As [`say`], for text that may hold colours; foreign parts of it must be escaped.
pub(crate) fn say_styled(text: &str) {
    let _ = writeln!(anstream::stderr().lock(), "{}", styled(text));
}

/// Bytes that nobody waits for once their caller has left.
#[cfg(feature = "studio")]
struct StoppedByCaller<'a> {
    out: Vec<u8>,
    caller: &'a vtex_studio::Caller,
}

#[cfg(feature = "studio")]
impl Write for StoppedByCaller<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.caller.has_left() {
            return Err(Error::Interrupted.into());
        }
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Counts bytes, and stops when the user asks to.
struct StoppableByteCounter<W> {
    out: W,
    count: u64,
}

impl<W: Write> StoppableByteCounter<W> {
    fn new(out: W) -> Self {
        Self { out, count: 0 }
    }
}

impl<W: Write> Write for StoppableByteCounter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Not `ErrorKind::Interrupted`, after which writers try again.
        interrupt::check().map_err(io::Error::other)?;
        let n = self.out.write(bytes)?;
        self.count += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
