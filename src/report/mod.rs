//! Library and scene → one HTML page, for people who would rather look.
//!
//! The page asks no server for anything: pictures, data, style and script are part of it, and its
//! own policy forbids all requests. Pictures are the SVGs of [`crate::output::svg`], packed; the
//! page unpacks them and shows each layer as an image of its own, which moves smoothly, is switched at
//! once, and whose ids meet nobody else's. What is computed is computed here
//! ([`distributions`]); the script in `page/` only shows it.
//!
//! When this works badly: canvases of several thousand pixels make pages of tens of megabytes,
//! which browsers draw slowly.

mod data;
mod distributions;
mod groups;
mod neighbours;
mod page;
mod photo;

pub use groups::exemplars;
pub use photo::Photo;

use crate::document::Document;
use crate::error::{Error, Result};
use crate::library::Library;
use crate::output::file::gzip;
use crate::output::svg::{self, SvgOptions};
use crate::scene::Scene;
use groups::Group;
use page::{Embedded, Page};
use std::io::Write;
use std::path::Path;

/// What came from a file, with the file's name.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    /// The name, as people know it.
    pub name: String,
    /// What the file holds.
    pub content: T,
}

/// What a page is about: libraries, a scene, or both.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The libraries, as they were read.
    pub libraries: &'a [Named<Library>],
    /// The scene, as it was read. It is compared with those of the libraries that it was made from.
    pub scene: Option<&'a Named<Scene>>,
    /// Files that may be the photographs; those are shown whose SHA-256 says that they are.
    pub photos: &'a [Photo],
    /// A sentence that the page adds where a photograph was not given, such as how to give it; may be
    /// empty.
    pub ask: &'a str,
}

/// Writes the page. Same subject: the same bytes. Returns what the user should know.
///
/// # Errors
/// A library or scene that breaks its invariants; a failing writer, as [`Error::Write`] with the
/// path `-`.
pub fn write(subject: &Subject<'_>, mut out: impl Write) -> Result<Vec<String>> {
    subject.libraries.iter().try_for_each(check)?;
    subject.scene.map_or(Ok(()), check)?;
    let groups = Group::all(subject);
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
    let data = data::Data { program: crate::PROGRAM, groups: described, scene };
    let json = serde_json::to_string(&data).map_err(|e| Error::write(Path::new("-"), e.into()))?;
    let page = Page { title: title(subject, &groups), json, files };
    page.write(&mut out).map_err(|e| Error::write(Path::new("-"), e))?;
    Ok(photo::strangers(&groups, subject.photos))
}

/// Refuses what anyone may have made in memory, so that no index leads nowhere.
fn check<T: Document>(named: &Named<T>) -> Result<()> {
    let unsound = |reason| Error::Format { name: named.name.clone(), format: T::FORMAT, reason };
    named.content.validate().map_err(unsound)
}

/// A scene as a packed SVG.
fn picture(id: String, scene: &Scene) -> Result<Embedded<'static>> {
    let mut packed = gzip(Vec::new());
    svg::write(scene, &SvgOptions::default(), &mut packed)?;
    let bytes = packed.finish().map_err(|e| Error::write(Path::new("-"), e))?;
    Ok(Embedded { id, media_type: "image/svg+xml", gzip: true, bytes: bytes.into() })
}

/// What the page is called: after the photographs.
fn title(subject: &Subject<'_>, groups: &[Group<'_>]) -> String {
    let names: Vec<&str> = groups.iter().map(|g| g.exemplar.exemplar.as_str()).collect();
    match (subject.scene.is_some(), names.is_empty()) {
        (true, true) => "Texture".into(),
        (true, false) => format!("Texture from {}", names.join(", ")),
        (false, _) => format!("Library of {}", names.join(", ")),
    }
}
