//! For figures: the photographs that they are measured on.

use image::RgbImage;

/// A photograph of the folder that `VTEX_FIGURES` names, by default `../shared/exemplars`; `None` if there is none.
pub(crate) fn photograph(name: &str) -> Option<RgbImage> {
    let folder = std::env::var("VTEX_FIGURES");
    let folder = folder.unwrap_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/exemplars").into());
    let path = format!("{folder}/{name}");
    let found = image::open(&path).map(image::DynamicImage::into_rgb8);
    found.inspect_err(|_| println!("skipped: there is no {path}")).ok()
}
