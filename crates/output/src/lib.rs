//! Scene → files: SVG, SVGZ, PDF, PNG; and SVG → pixels.
//!
//! All writers take one finished type, [`vtex_scene::scene::Scene`], and know nothing of how it was made.
//! [`svg`] and [`pdf`] write it as pure vectors, [`png`] draws it directly at any scale, [`raster_animation`]
//! writes animated GIFs and PNGs, [`raster_svg`] draws any SVG, [`reduce`] reduces a scene to a number of
//! bytes, [`file`] replaces files safely. [`formats`] is the table of all formats, and [`writing`] writes a scene in
//! any of them.
//!
//! A writer does not know the path that it writes to. It fails with [`std::io::Error`]; [`Error::write`] adds the
//! path, and gives back an error of vtex that the writer passed on.

mod background;
mod categories;
mod coverage;
pub mod file;
pub mod formats;
pub mod layer_map;
mod paths;
pub mod pdf;
pub mod png;
pub mod raster_animation;
pub mod raster_svg;
pub mod reduce;
#[cfg(test)]
mod rims;
pub mod seal;
#[cfg(test)]
mod seams;
mod shadow;
pub mod svg;
#[cfg(test)]
mod testing;
pub mod writing;

pub use categories::{SceneCategory, categories};
pub use coverage::{coverage, inside};

use vtex_base::Parameter;
use vtex_base::document::in_order;
use vtex_base::error::{Error, Large, Result};
pub use vtex_scene::scene::CSS_DPI;
use vtex_scene::scene::{Scene, SynthParams};

/// Pixels of the canvas per inch of its page.
pub const DPI: Parameter<u32> = Parameter::new("dpi", [1, 9600], "");

/// Largest picture drawn, in pixels: 4 GiB of memory.
const LARGEST_PICTURE: u64 = 1 << 30;

/// Size of a picture of a canvas at a scale, in pixels: rounded, at least 1 × 1.
///
/// # Errors
/// A scale that is not positive and finite; a picture larger than [`LARGEST_PICTURE`] or with a side beyond
/// [`SynthParams::SIDE`], where `name` is the drawn file.
fn picture_size(width: f64, height: f64, scale: f64, name: &str) -> Result<(u32, u32)> {
    vtex_base::error::check(scale.is_finite() && scale > 0.0, "scale", scale, "a number above 0")?;
    let side = |v: f64| libm::round(v * scale).max(1.0);
    let (w, h) = (side(width), side(height));
    let side = SynthParams::SIDE.range[1];
    let limit = if w.max(h) > f64::from(side) {
        format!("{side} pixels on each side")
    } else if w * h > LARGEST_PICTURE as f64 {
        format!("{} megapixels", LARGEST_PICTURE / 1_000_000)
    } else {
        return Ok((w as u32, h as u32));
    };
    let found = format!("a picture of {w:.0} x {h:.0} pixels");
    Err(Error::TooLarge { what: Large::Drawn, name: name.into(), found, limit })
}

/// The title of a file: which exemplars the texture comes from.
fn title(scene: &Scene) -> String {
    let names: Vec<&str> = scene.libraries.iter().map(|l| l.exemplar.as_str()).collect();
    let what = if scene.parameters.is_some() { "Texture" } else { "Reconstruction" };
    in_order(if names.is_empty() { what.into() } else { format!("{what} from {}", names.join(", ")) })
}

/// The label of a layer in editors and viewers: its name with a capital letter.
fn label(name: &str) -> String {
    let mut letters = name.chars();
    in_order(letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect()))
}
