//! Inputs that several tests use.

use std::path::Path;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::segment::Regions;

/// The library of the middle of one of the generated exemplars, 160 × 160 pixels.
pub(crate) fn library(name: &str) -> Library {
    library_with(name, &AnalyzeParams::default())
}

/// [`library`] with other parameters of the analysis.
pub(crate) fn library_with(name: &str, params: &AnalyzeParams) -> Library {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/exemplars/{name}.png"));
    let whole = image::open(path).unwrap().into_rgb8();
    let (x, y) = ((whole.width() - 160) / 2, (whole.height() - 160) / 2);
    let crop = image::imageops::crop_imm(&whole, x, y, 160, 160).to_image();
    let mut bytes = std::io::Cursor::new(Vec::new());
    crop.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    let exemplar = Exemplar::from_bytes(&bytes.into_inner(), name, &Limits::default()).unwrap();
    analyze(&exemplar, &Regions, params, &()).unwrap()
}
