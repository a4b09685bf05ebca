//! Photographs on the page: matched by SHA-256, in a format that browsers show.

use super::groups::ReportGroup;
use image::ImageFormat;
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use vtex_analyze::{Exemplar, Limits};
use vtex_scene::scene::LibraryRef;

/// Largest size of a photograph on a page, in bytes.
const MOST: usize = 20_000_000;

/// A file that may be the photograph of an exemplar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Photo {
    name: String,
    bytes: Vec<u8>,
    given: bool,
    sha256: String,
}

impl Photo {
    /// A candidate photograph. `name` is its file name without the folder. `given` says that the user named
    /// it explicitly; otherwise it was found by its name.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>, given: bool) -> Self {
        let sha256 = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
        Self { name: name.into(), bytes, given, sha256 }
    }
}

/// The photograph's media type and bytes.
///
/// # Errors
/// Why it cannot be shown, in one sentence for the user.
pub(super) fn of<'a>(
    wanted: &LibraryRef,
    photos: &'a [Photo],
    ask: &str,
) -> Result<(&'static str, Cow<'a, [u8]>), String> {
    let name = &wanted.exemplar;
    let Some(photo) = photos.iter().find(|p| p.sha256 == wanted.sha256) else {
        return Err(match photos.iter().find(|p| p.given || p.name == *name) {
            Some(other) => format!(
                "The photograph {name} is not shown: the file {} has another SHA-256, so it is not the one \
                 that the library was made from.",
                other.name
            ),
            None => {
                let gap = if ask.is_empty() { "" } else { " " };
                format!(
                    "The photograph {name} is not shown: there is no such file beside what is \
                     inspected.{gap}{ask}"
                )
            }
        });
    };
    let (media_type, bytes) = shown(photo).ok_or_else(|| {
        format!("The photograph {name} is not shown: it cannot be brought into a form that browsers show.")
    })?;
    if bytes.len() > MOST {
        return Err(format!(
            "The photograph {name} is not shown: a page has room for {} MB, it has {}.",
            MOST / 1_000_000,
            bytes.len() / 1_000_000
        ));
    }
    Ok((media_type, bytes))
}

/// The photograph unchanged if browsers show its format, otherwise converted to PNG.
fn shown(photo: &Photo) -> Option<(&'static str, Cow<'_, [u8]>)> {
    let as_it_is = |media_type| Some((media_type, Cow::Borrowed(&photo.bytes[..])));
    match image::guess_format(&photo.bytes).ok()? {
        ImageFormat::Png => as_it_is("image/png"),
        ImageFormat::Jpeg => as_it_is("image/jpeg"),
        ImageFormat::WebP => as_it_is("image/webp"),
        ImageFormat::Gif => as_it_is("image/gif"),
        _ => {
            let exemplar = Exemplar::from_bytes(&photo.bytes, &photo.name, &Limits::default()).ok()?;
            let mut bytes = std::io::Cursor::new(Vec::new());
            exemplar.image.write_to(&mut bytes, ImageFormat::Png).ok()?;
            Some(("image/png", Cow::Owned(bytes.into_inner())))
        }
    }
}

/// Warnings about files named as photographs that match no exemplar.
pub(super) fn unmatched(groups: &[ReportGroup<'_>], photos: &[Photo]) -> Vec<String> {
    let known = |p: &Photo| groups.iter().any(|g| g.exemplar.sha256 == p.sha256);
    let strange = photos.iter().filter(|p| p.given && !known(p));
    strange
        .map(|p| {
            format!("'{}' is not the photograph that this was made from (its SHA-256 is another)", p.name)
        })
        .collect()
}
