//! Scene → SVG: pure vectors in groups that a designer finds their way in.
//!
//! The file is written as it is made; nothing of it is held in memory but the background's grid.
//! Textons that stand more than once are defined once. Those with details become
//! `<symbol overflow="visible">`, which vector editors list among their symbols; those of one path
//! become a plain `<path>` that takes the fill of its `<use>`. References are `xlink:href`, which
//! old and new readers alike understand. A texton that stands once is written where it stands.
//!
//! Ids: layers `background`, `secondary`, `primary`; `p7` the primary instance of id 7; `t3` the
//! texton of index 3; `b…` the background's gradients.

mod background;
mod metadata;
mod number;
#[cfg(test)]
mod tests;
mod textons;
mod xml;

use super::background::Background;
use crate::error::{Error, Result, check};
use crate::scene::Scene;
use number::Paint;
use std::io::{self, Write};
use std::path::Path;
use textons::Textons;
use xml::Xml;

/// How every SVG of vtex begins. Editors write another beginning when they save, so a file that
/// begins like this holds nobody's work.
pub(super) const BEGINNING: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Written by vtex ";

/// From this many elements on many programs struggle with the file.
const MANY_ELEMENTS: u64 = 1_000_000;

/// How an SVG is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SvgOptions {
    /// Digits after the decimal point of coordinates, 0 to 6. Default 2: outlines are kept on a
    /// grid of 0.01 px, so nothing is lost.
    pub precision: u8,
    /// Write every texton as plain paths where it stands, without `<symbol>`, `<use>` and
    /// transforms, for programs that know none of these. Default false.
    pub expand: bool,
}

impl Default for SvgOptions {
    fn default() -> Self {
        Self { precision: 2, expand: false }
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SvgSummary {
    /// Length of the file.
    pub bytes: u64,
    /// Elements in the file.
    pub elements: u64,
    /// Textons defined once and placed by reference.
    pub shared_textons: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Writes a scene as SVG. Same scene and options: the same bytes.
///
/// # Errors
/// A precision out of range; a scene that breaks its invariants; a failing writer, as [`Error::Write`] with the path `-`.
pub fn write(scene: &Scene, options: &SvgOptions, out: impl Write) -> Result<SvgSummary> {
    check(options.precision <= 6, "precision", options.precision, "0 to 6 digits")?;
    super::check_scene(scene)?;
    let background = Background::new(scene);
    let textons = Textons::new(scene, options);
    let written = document(scene, &background, &textons, out).map_err(|e| Error::write(Path::new("-"), e))?;
    let (bytes, elements) = written;
    let mut warnings = Vec::new();
    if elements >= MANY_ELEMENTS {
        warnings.push(format!(
            "the SVG has {elements} elements; many programs are slow beyond {MANY_ELEMENTS}: \
             write a smaller size, or a PNG"
        ));
    }
    Ok(SvgSummary { bytes, elements, shared_textons: textons.shared_count(), warnings })
}

fn document(
    scene: &Scene,
    background: &Background,
    textons: &Textons<'_>,
    out: impl Write,
) -> io::Result<(u64, u64)> {
    let program = crate::PROGRAM.strip_prefix("vtex ").unwrap_or_default();
    let mut xml = Xml::new(out, &format!("{BEGINNING}{program} -->\n"));
    xml.open("svg");
    xml.attribute("xmlns", "http://www.w3.org/2000/svg");
    xml.attribute("xmlns:xlink", "http://www.w3.org/1999/xlink");
    xml.attribute("xmlns:inkscape", "http://www.inkscape.org/namespaces/inkscape");
    xml.attribute("width", scene.width);
    xml.attribute("height", scene.height);
    xml.attribute("viewBox", format_args!("0 0 {} {}", scene.width, scene.height));
    xml.line();
    xml.open("title");
    xml.text(&metadata::title(scene));
    xml.close()?;
    xml.line();
    xml.open("metadata");
    xml.text(&metadata::json(scene));
    xml.close()?;
    xml.line();

    xml.open("defs");
    xml.line();
    background.write_definitions(&mut xml)?;
    textons.write_definitions(&mut xml)?;
    xml.close()?;
    xml.line();

    layer(&mut xml, "background", "Background");
    background.write_bands(&mut xml)?;
    xml.close()?;
    xml.line();

    layer(&mut xml, "secondary", "Secondary");
    // Neighbours in painting order that share a fill take it from one group.
    for run in
        scene.secondary.chunk_by(|a, b| textons.fill(a).is_some() && textons.fill(a) == textons.fill(b))
    {
        let fill = textons.fill(&run[0]).filter(|_| run.len() > 1);
        if let Some(fill) = fill {
            xml.open("g");
            xml.attribute("fill", Paint(fill));
            xml.line();
        }
        for instance in run {
            textons.write_instance(&mut xml, instance, fill.is_none())?;
            xml.line();
        }
        if fill.is_some() {
            xml.close()?;
            xml.line();
        }
    }
    xml.close()?;
    xml.line();

    layer(&mut xml, "primary", "Primary");
    for instance in &scene.primary {
        xml.open("g");
        xml.attribute("id", format_args!("p{}", instance.id));
        if let Some(category) = scene.textons[instance.texton as usize].category {
            xml.attribute("data-category", category);
        }
        textons.write_instance(&mut xml, instance, true)?;
        xml.close()?;
        xml.line();
    }
    xml.close()?;
    xml.line();
    xml.finish()
}

/// Begins one of the three layers, which Inkscape shows as such.
fn layer<W: Write>(xml: &mut Xml<W>, id: &str, label: &str) {
    xml.open("g");
    xml.attribute("id", id);
    xml.attribute("inkscape:groupmode", "layer");
    xml.attribute("inkscape:label", label);
    xml.line();
}
