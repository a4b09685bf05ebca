//! Scenes and libraries as bytes and files, equal to those of the program.

use crate::errors;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;
use vtex::output::file::{
    BackgroundChoice, FileKind, Format, PreparedFile, WriteOptions, coloured, endings, gzip, users_of,
    write_file,
};
use vtex::output::seal::Sealed;
use vtex::output::svg::SvgOptions;
use vtex::raster::css;
use vtex::scene::Scene;
use vtex::{Error, Progress, Result};

/// How a scene is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WritingOptions {
    precision: u8,
    expand: bool,
    css: bool,
    /// Whether an SVG is a tile for the fills of other programs.
    pattern: bool,
    max_bytes: Option<u64>,
    /// Pixels of a PNG for each pixel of the canvas, or of a page in pixels.
    pub(crate) scale: f64,
    /// The colour of all elements; the exemplar's if it is not given.
    ink: Option<String>,
    /// A colour, or `none`; the exemplar's if it is not given.
    background: Option<String>,
}

fn in_memory(error: io::Error) -> Error {
    Error::write(Path::new("memory"), error)
}

/// The error of a parameter whose text names no colour.
fn not_a_colour(name: &'static str, text: &str, allowed: &'static str) -> Error {
    let value = format!("'{}'", text.chars().take(24).collect::<String>());
    Error::Parameter { name, value, allowed: allowed.into() }
}

impl WritingOptions {
    /// The scene with the ink and the background asked for.
    ///
    /// # Errors [`Error::Parameter`] for text that is not a colour; those of [`Scene::with_ink`].
    pub(crate) fn scene<'s>(&self, scene: &'s Scene) -> Result<Cow<'s, Scene>> {
        let ink = self.ink.as_deref().map(|text| {
            css::colour(text).ok_or_else(|| not_a_colour("ink", text, "#rrggbb, #rgb or a name of CSS"))
        });
        let background = self.background.as_deref().map(|text| {
            let choice = text.parse::<BackgroundChoice>();
            choice.map_err(|_| not_a_colour("background", text, "#rrggbb, #rgb, a name of CSS, or none"))
        });
        coloured(Cow::Borrowed(scene), ink.transpose()?, background.transpose()?)
    }

    fn options(&self) -> WriteOptions<'static> {
        let Self { precision, expand, css, max_bytes, scale, pattern, .. } = *self;
        let svg = SvgOptions { precision, expand, css, names: true, fills: pattern };
        WriteOptions { svg, max_bytes, scale, ..WriteOptions::default() }
    }

    /// A sentence about each option that was given but that a format does not use.
    fn idle(&self, format: Format) -> Vec<String> {
        let uses = format.uses();
        let mut idle = Vec::new();
        if self.max_bytes.is_some() && !uses.max_bytes {
            idle.push(format!("max_bytes has no effect here: it is for {}", users_of(|uses| uses.max_bytes)));
        }
        if self.scale != 1.0 && !uses.scale {
            idle.push(format!("scale has no effect here: it is for {}", users_of(|uses| uses.scale)));
        }
        idle
    }

    /// The bytes of a file, sealed as a file is, and warnings.
    ///
    /// # Errors
    /// As [`WritingOptions::save`].
    pub(crate) fn bytes(
        &self,
        scene: &Scene,
        kind: FileKind,
        progress: &dyn Progress,
    ) -> Result<(Vec<u8>, Vec<String>)> {
        let mut out = Sealed::new(Vec::new());
        let scene = self.scene(scene)?;
        let file = PreparedFile::new(kind, &scene, self.options(), progress).map_err(in_memory)?;
        let mut warnings = self.idle(kind.format);
        warnings.extend(file.write(progress, &mut out).map_err(in_memory)?);
        Ok((out.finish().map_err(in_memory)?, warnings))
    }

    /// Writes a file; its size and warnings.
    ///
    /// # Errors
    /// Those of [`PreparedFile`] and of [`write_file`].
    pub(crate) fn save(
        &self,
        scene: &Scene,
        (path, kind): (&Path, FileKind),
        force: bool,
        progress: &dyn Progress,
    ) -> Result<(u64, Vec<String>)> {
        let scene = self.scene(scene)?;
        let file =
            PreparedFile::new(kind, &scene, self.options(), progress).map_err(|e| Error::write(path, e))?;
        let mut warnings = self.idle(kind.format);
        let (written, bytes) = write_file(path, force, |out| file.write(progress, out))?;
        warnings.extend(written);
        Ok((bytes, warnings))
    }
}

/// The kind of file that a name stands for, among the formats that `allowed` is true of. `what` ends in the message.
pub(crate) fn kind_of(
    py: Python<'_>,
    path: &Path,
    allowed: impl Fn(Format) -> bool,
    what: &str,
) -> PyResult<FileKind> {
    let kind = FileKind::from_path(path).filter(|kind| allowed(kind.format));
    kind.ok_or_else(|| {
        let hint = match &endings(allowed)[..] {
            [others @ .., last] if !others.is_empty() => {
                format!("names end in {} or {last}", others.join(", "))
            }
            few => format!("names end in {}", few.concat()),
        };
        errors::input(py, &format!("the name of '{}' {what}", path.display()), Some(&hint))
    })
}

/// Writes a document's file; its size.
///
/// # Errors
/// Those of [`write_file`].
pub(crate) fn save_document(path: &Path, kind: FileKind, force: bool, json: &[u8]) -> Result<u64> {
    Ok(write_file(path, force, |out| kind.pack(out, |out| out.write_all(json)))?.1)
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
