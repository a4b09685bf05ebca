//! Library and scene → one HTML page for inspection in a browser.
//!
//! The page is self-contained: it includes all pictures, data, styles and scripts, and its content
//! security policy forbids all requests. Pictures are compressed SVGs of [`vtex_output::svg`]. The
//! page decompresses them and shows each layer as a separate image, which pans smoothly, is toggled
//! instantly, and has no clashing ids. All figures are computed here ([`distributions`]); the
//! script in `page/` only displays them.
//!
//! Works badly for canvases of several thousand pixels: the page has tens of megabytes, and browsers
//! draw it slowly.

mod data;
mod distributions;
mod groups;
mod neighbours;
mod page;
mod photo;

pub use groups::exemplars;
pub use photo::Photo;

use groups::ReportGroup;
use page::{Embedded, ReportPage};
use std::io::{self, Write};
use vtex_base::document::Document;
use vtex_base::error::{Error, Result};
use vtex_output::file::gzip;
use vtex_output::svg::{self, SvgOptions};
use vtex_scene::library::Library;
use vtex_scene::scene::Scene;

/// The content of a file, with the file's name.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    /// File name, as shown to the user.
    pub name: String,
    /// The parsed content.
    pub content: T,
}

/// The subject of a page: libraries, a scene, or both.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The libraries.
    pub libraries: &'a [Named<Library>],
    /// The scene. It is compared with the libraries that it was made from.
    pub scene: Option<&'a Named<Scene>>,
    /// Candidate photographs. Those whose SHA-256 matches an exemplar are shown.
    pub photos: &'a [Photo],
    /// A sentence that the page shows in place of a missing photograph, such as how to give it; may be empty.
    pub ask: &'a str,
}

/// Writes the page. The same subject gives the same bytes. Returns warnings, one sentence each.
///
/// # Errors
/// [`Error::Format`] for a library or scene that breaks its invariants; those of the writer.
pub fn write(subject: &Subject<'_>, mut out: impl Write) -> io::Result<Vec<String>> {
    subject.libraries.iter().try_for_each(check)?;
    subject.scene.map_or(Ok(()), check)?;
    let groups = ReportGroup::all(subject);
    let mut files = Vec::new();
    let mut described = Vec::new();
    for (number, group) in groups.iter().enumerate() {
        let mut about = data::GroupData::new(group, subject.scene.map(|s| &s.content));
        match photo::of(&group.exemplar, subject.photos, subject.ask) {
            Ok((media_type, bytes)) => {
                let id = format!("photo-{number}");
                files.push(Embedded { id: id.clone(), media_type, gzip: false, bytes });
                about.photo = Some(id);
            }
            Err(reason) => about.photo_missing = Some(reason),
        }
        if let Some(drawn) = group.drawn(subject.scene.map(|s| &s.content)) {
            let id = format!("textons-{number}");
            files.push(picture(id.clone(), &drawn)?);
            about.picture = Some(id);
            if group.library.is_some() {
                about.ellipses = data::ellipses(&drawn);
            }
        }
        described.push(about);
    }
    let scene = match subject.scene {
        Some(scene) => {
            files.push(picture("result".into(), &scene.content)?);
            Some(data::SceneData::new(scene))
        }
        None => None,
    };
    let data = data::ReportData { program: vtex_base::PROGRAM, groups: described, scene };
    let json = serde_json::to_string(&data)?;
    let page = ReportPage { title: title(subject, &groups), json, files };
    page.write(&mut out)?;
    Ok(photo::unmatched(&groups, subject.photos))
}

/// Validates a document that may have been built in memory.
fn check<T: Document>(named: &Named<T>) -> Result<()> {
    let unsound = |reason| Error::Format { name: named.name.clone(), format: T::FORMAT, reason };
    named.content.validate().map_err(unsound)
}

/// A scene as a compressed SVG.
fn picture(id: String, scene: &Scene) -> io::Result<Embedded<'static>> {
    let mut packed = gzip(Vec::new());
    svg::write(scene, &SvgOptions::default(), &mut packed)?;
    let bytes = packed.finish()?;
    Ok(Embedded { id, media_type: "image/svg+xml", gzip: true, bytes: bytes.into() })
}

/// The title of the page, from the names of the photographs.
fn title(subject: &Subject<'_>, groups: &[ReportGroup<'_>]) -> String {
    let names: Vec<&str> = groups.iter().map(|g| g.exemplar.exemplar.as_str()).collect();
    match (subject.scene.is_some(), names.is_empty()) {
        (true, true) => "Texture".into(),
        (true, false) => format!("Texture from {}", names.join(", ")),
        (false, _) => format!("Library of {}", names.join(", ")),
    }
}
