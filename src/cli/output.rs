//! Where results go: files put in place as a whole, or standard output.

use super::input::was_read;
use super::interrupt;
use super::options::svg::SvgParameters;
use super::values::Bytes;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use vtex::interpolate::Interpolation;
use vtex::output::file::{Format, Kind, gzip, write_file};
use vtex::output::reduce::{self, GivenUp};
use vtex::output::{pdf, png, svg};
use vtex::scene::Scene;
use vtex::{Error, Result};

/// A file or standard output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Stdout,
    File { path: PathBuf, force: bool },
}

/// A place and what is written there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) place: Place,
    pub(crate) kind: Kind,
}

/// What was written.
#[derive(Debug, Default)]
pub(crate) struct Written {
    pub(crate) bytes: u64,
    /// What the writer warns of.
    pub(crate) warnings: Vec<String>,
    /// What was given up to make it small enough.
    pub(crate) given_up: Option<GivenUp>,
}

impl Written {
    /// So many bytes, and nothing to say of them.
    pub(crate) fn of(bytes: u64) -> Self {
        Self { bytes, ..Self::default() }
    }
}

impl Place {
    /// The path, `-` for standard output.
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Stdout => Path::new("-"),
            Self::File { path, .. } => path,
        }
    }

    /// Fails now if writing would fail later for a reason known already: a foreign file, a folder
    /// that is missing or closed. Nothing is changed.
    ///
    /// # Errors
    /// As [`write_file`].
    pub(crate) fn probe(&self) -> Result<()> {
        let Self::File { path, force } = self else { return Ok(()) };
        // Opening a pipe or device would be noticed at its other end.
        if fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir()) {
            return Ok(());
        }
        match write_file(path, *force, |_| Err::<(), _>(Error::Interrupted)) {
            Err(Error::Interrupted) | Ok(()) => Ok(()),
            Err(e) => Err(e),
        }
    }

    /// Hands a writer to `content`. A file appears, or is replaced, only when all of it is there.
    ///
    /// # Errors
    /// Those of `content` and of [`write_file`]; [`Error::Interrupted`].
    pub(crate) fn write<T>(&self, content: impl FnOnce(&mut dyn Write) -> Result<T>) -> Result<(T, u64)> {
        if let Self::File { path, .. } = self
            && was_read(path)
        {
            return Err(Error::write(path, io::Error::other("this command has read it as an input")));
        }
        let outcome = match self {
            Self::Stdout => interrupt::waiting(|| {
                let mut out = Counting::new(io::BufWriter::new(io::stdout().lock()));
                content(&mut out).and_then(|value| {
                    out.flush().map_err(|e| Error::write(self.path(), e))?;
                    Ok((value, out.count))
                })
            }),
            Self::File { path, force } => write_file(path, *force, |out| {
                let mut out = Counting::new(out);
                let value = content(&mut out)?;
                interrupt::check()?;
                Ok((value, out.count))
            }),
        };
        outcome.map_err(|e| if interrupt::asked() { Error::Interrupted } else { e })
    }
}

impl Target {
    /// Writes bytes, packed if the name asks for it.
    ///
    /// # Errors
    /// As [`Place::write`].
    pub(crate) fn write_bytes(&self, bytes: &[u8]) -> Result<Written> {
        let fail = |e| Error::write(Path::new("-"), e);
        let (_, count) = self.place.write(|out| {
            if self.kind.gzip {
                let mut packed = gzip(out);
                packed.write_all(bytes).and_then(|()| packed.finish().map(drop)).map_err(fail)
            } else {
                out.write_all(bytes).map_err(fail)
            }
        })?;
        Ok(Written::of(count))
    }

    /// Writes a scene as what the name asks for; `scale` counts for PNG only, a limit of bytes for SVG
    /// only.
    ///
    /// # Errors
    /// As [`Place::write`], and those of the writers and of [`reduce::to_fit`].
    pub(crate) fn write_scene(&self, scene: &Scene, svg: SvgParameters, scale: f64) -> Result<Written> {
        let mut written = match self.kind.format {
            Format::Svg => return self.write_svg(scene, svg, |s, o, out| svg::write(s, o, out)),
            Format::Scene | Format::Library => self.write_bytes(&scene.to_json())?,
            Format::Pdf => Written::of(self.place.write(|out| pdf::write(scene, out))?.1),
            Format::Png => {
                let picture = png::render(scene, scale)?;
                let seed = scene.parameters.as_ref().map(|p| p.seed);
                Written::of(self.place.write(|out| png::encode(&picture, seed, out))?.1)
            }
        };
        if svg.max_bytes.is_some() {
            written.warnings.push("--max-bytes has no effect here: it is for .svg and .svgz".into());
        }
        Ok(written)
    }

    /// Writes a scene as a pattern.
    ///
    /// # Errors
    /// As [`Place::write`], and those of [`svg::write_pattern`] and of [`reduce::to_fit`].
    pub(crate) fn write_pattern(&self, scene: &Scene, svg: SvgParameters) -> Result<Written> {
        self.write_svg(scene, svg, |s, o, out| svg::write_pattern(s, o, out))
    }

    /// Writes the way between two scenes as an SVG that plays.
    ///
    /// # Errors
    /// As [`Place::write`], and those of [`svg::write_animation`].
    pub(crate) fn write_animation(&self, way: &Interpolation, animation: &svg::Animation) -> Result<Written> {
        let (summary, bytes) =
            self.place.write(|out| self.pack(out, |w| svg::write_animation(way, animation, w)))?;
        Ok(Written { bytes, warnings: summary.warnings, given_up: None })
    }

    /// Writes a scene by `writer`, as much of it as is allowed.
    fn write_svg(
        &self,
        scene: &Scene,
        svg: SvgParameters,
        writer: impl Fn(&Scene, &svg::SvgOptions, &mut dyn Write) -> Result<svg::SvgSummary>,
    ) -> Result<Written> {
        let options = svg.into();
        let Some(Bytes(most)) = svg.max_bytes else {
            let (summary, bytes) = self.place.write(|out| self.pack(out, |w| writer(scene, &options, w)))?;
            return Ok(Written { bytes, warnings: summary.warnings, given_up: None });
        };
        let reduced = reduce::to_fit(scene, &options, most, |scene, options| {
            let mut out = Counting::new(io::sink());
            self.pack(&mut out, |w| writer(scene, options, w))?;
            Ok(out.count)
        })?;
        let written =
            self.place.write(|out| self.pack(out, |w| writer(&reduced.scene, &reduced.options, w)))?;
        Ok(Written { bytes: written.1, warnings: written.0.warnings, given_up: reduced.given_up })
    }

    /// Hands a writer to `content` that packs if the name asks for it.
    fn pack<T>(&self, out: &mut dyn Write, content: impl FnOnce(&mut dyn Write) -> Result<T>) -> Result<T> {
        if !self.kind.gzip {
            return content(out);
        }
        let mut packed = gzip(out);
        let value = content(&mut packed)?;
        packed.finish().map_err(|e| Error::write(Path::new("-"), e))?;
        Ok(value)
    }
}

/// Prints data on standard output.
///
/// # Errors
/// [`Error::Write`] with the path `-`.
pub(crate) fn print(data: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(data).and_then(|()| out.flush()).map_err(|e| Error::write(Path::new("-"), e))?;
    Ok(())
}

/// Prints text that may hold colours, which go if standard output is not to have them.
///
/// # Errors
/// [`Error::Write`] with the path `-`.
pub(crate) fn print_styled(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    let printed = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    printed.map_err(|e| Error::write(Path::new("-"), e))?;
    Ok(())
}

/// Says something on stderr. If that is closed there is nobody to tell.
pub(crate) fn say(text: &str) {
    let _ = writeln!(anstream::stderr().lock(), "{text}");
}

/// Counts bytes, and stops when the user asks to.
struct Counting<W> {
    out: W,
    count: u64,
}

impl<W: Write> Counting<W> {
    fn new(out: W) -> Self {
        Self { out, count: 0 }
    }
}

impl<W: Write> Write for Counting<W> {
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
