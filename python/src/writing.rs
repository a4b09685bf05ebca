//! Scenes and libraries as bytes and files, equal to those of the program.

use crate::errors;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;
use vtex::output::file::{FileKind, Format, gzip, write_file};
use vtex::output::seal::Sealed;
use vtex::output::svg::{self, SvgOptions};
use vtex::output::{pdf, png, reduce};
use vtex::raster::css;
use vtex::scene::Scene;
use vtex::{Error, Result};

/// How a scene is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WritingOptions {
    precision: u8,
    expand: bool,
    css: bool,
    max_bytes: Option<u64>,
    /// Pixels of a PNG for each pixel of the canvas, or of a page in pixels.
    pub(crate) scale: f64,
    /// A colour, or `none`; the exemplar's if it is not given.
    background: Option<String>,
}

fn in_memory(error: io::Error) -> Error {
    Error::write(Path::new("memory"), error)
}

impl WritingOptions {
    /// The scene with the background asked for.
    ///
    /// # Errors [`Error::Parameter`] for text that is not a colour.
    pub(crate) fn scene<'s>(&self, scene: &'s Scene) -> Result<Cow<'s, Scene>> {
        let Some(background) = &self.background else { return Ok(Cow::Borrowed(scene)) };
        let colour = match background.as_str() {
            "none" => None,
            text => Some(css::colour(text).ok_or_else(|| Error::Parameter {
                name: "background",
                value: format!("'{}'", text.chars().take(24).collect::<String>()),
                allowed: "#rrggbb, #rgb, a name of CSS, or none".into(),
            })?),
        };
        Ok(Cow::Owned(scene.clone().with_background(colour)))
    }

    /// Writes a scene in a format; warnings of the writer.
    ///
    /// # Errors
    /// Those of the writers and of [`reduce::to_fit`].
    fn write(&self, scene: &Scene, kind: FileKind, out: &mut dyn Write) -> io::Result<Vec<String>> {
        let FileKind { format, gzip } = kind;
        match format {
            Format::Svg => {
                let write = |scene: &Scene, options: &SvgOptions, out: &mut dyn Write| {
                    packed(gzip, out, |out| svg::write(scene, options, out)).map(|summary| summary.warnings)
                };
                return self.write_within(scene, write, out);
            }
            Format::Pdf => {
                let write = |scene: &Scene, _: &SvgOptions, out: &mut dyn Write| {
                    pdf::write(scene, out).map(|_| Vec::new())
                };
                return self.write_within(scene, write, out);
            }
            Format::Png => {
                let seed = scene.parameters.as_ref().map(|p| p.seed);
                png::encode(&png::render_page(scene, self.scale, &())?, seed, scene.page, out)?;
            }
            Format::Scene | Format::Library => write_document(&scene.to_json(), gzip, out)?,
        }
        Ok(Vec::new())
    }

    /// Writes a scene by `writer`, which returns its warnings, reduced to the permitted number of bytes.
    fn write_within(
        &self,
        scene: &Scene,
        writer: impl Fn(&Scene, &SvgOptions, &mut dyn Write) -> io::Result<Vec<String>>,
        out: &mut dyn Write,
    ) -> io::Result<Vec<String>> {
        let options =
            SvgOptions { precision: self.precision, expand: self.expand, css: self.css, names: true };
        let Some(most) = self.max_bytes else { return writer(scene, &options, out) };
        let measure = |scene: &Scene, options: &SvgOptions| {
            let mut out = Sealed::new(PythonByteCounter(0));
            writer(scene, options, &mut out)?;
            io::Result::Ok(out.finish()?.0)
        };
        let reduced = reduce::to_fit(scene, &options, most, measure)?;
        writer(&reduced.scene, &reduced.options, out)
    }

    /// The bytes of a file, sealed as a file is.
    ///
    /// # Errors
    /// As [`WritingOptions::save`].
    pub(crate) fn bytes(&self, scene: &Scene, kind: FileKind) -> Result<(Vec<u8>, Vec<String>)> {
        let mut out = Sealed::new(Vec::new());
        let warnings = self.write(&*self.scene(scene)?, kind, &mut out).map_err(in_memory)?;
        Ok((out.finish().map_err(in_memory)?, warnings))
    }

    /// Writes a file; its size and warnings of the writer.
    ///
    /// # Errors
    /// Those of the writers, of [`reduce::to_fit`] and of [`write_file`].
    pub(crate) fn save(
        &self,
        scene: &Scene,
        path: &Path,
        kind: FileKind,
        force: bool,
    ) -> Result<(u64, Vec<String>)> {
        let scene = self.scene(scene)?;
        let (warnings, bytes) = write_file(path, force, |out| self.write(&scene, kind, out))?;
        Ok((bytes, warnings))
    }
}

/// Counts bytes.
struct PythonByteCounter(u64);

impl Write for PythonByteCounter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Hands a writer to `content` that packs if asked to; then the content is sealed here.
fn packed<T>(
    pack: bool,
    out: &mut dyn Write,
    content: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> io::Result<T> {
    if !pack {
        return content(out);
    }
    let mut packed = Sealed::new(gzip(out));
    let value = content(&mut packed)?;
    packed.finish()?.finish()?;
    Ok(value)
}

/// Writes a document, packed if asked to.
fn write_document(json: &[u8], pack: bool, out: &mut dyn Write) -> io::Result<()> {
    packed(pack, out, |out| out.write_all(json))
}

/// Writes a document's file, packed if asked to; its size.
///
/// # Errors
/// Those of [`write_file`].
pub(crate) fn save_document(path: &Path, force: bool, pack: bool, json: &[u8]) -> Result<u64> {
    Ok(write_file(path, force, |out| write_document(json, pack, out))?.1)
}

/// A document packed as gzip, without a seal.
///
/// # Errors None in practice, because the output is in memory.
pub(crate) fn gzipped(json: &[u8]) -> Result<Vec<u8>> {
    let mut out = gzip(Vec::new());
    out.write_all(json).map_err(in_memory)?;
    out.finish().map_err(in_memory)
}

/// A value as JSON.
pub(crate) fn json(py: Python<'_>, value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|e| errors::input(py, &e.to_string(), None))
}

/// A value from JSON. `what` names it in errors.
pub(crate) fn from_json<T: for<'de> Deserialize<'de>>(py: Python<'_>, text: &str, what: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|e| {
        // The place within the text tells users nothing.
        let reason = e.to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default();
        errors::input(py, &format!("{what}: {reason}"), None)
    })
}
