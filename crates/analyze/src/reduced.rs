//! The size at which a photograph is analysed.
//!
//! Segmentation and placement work best for elements of some 20 to 80 pixels, and their cost grows with the
//! number of pixels. A photograph of more pixels than [`AnalyzeParams::max_pixels`] is therefore reduced: to
//! that number, or further, until half of the area of its elements belongs to elements of less than [`LARGE`]
//! pixels across, but not so far that a quarter of it belongs to elements of less than [`SMALL`]. How large
//! elements are is seen in a first pass of the region tree at a small size.
//!
//! The library that comes of it has the photograph's own pixels as its units (`crates/scene/src/library/units.rs`), so sizes
//! of results mean what they mean without reduction.

use super::{AnalyzeParams, Exemplar};
use image::RgbImage;
use std::borrow::Cow;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::{Filter, resized};
use vtex_field::layers::LayerMap;
use vtex_segment::segment::{OneTree, Segmenter};

/// Pixels of the first pass. No photograph is reduced further for the size of its elements.
const FIRST: f64 = 160_000.0;
/// Diameter above which elements are large, in pixels.
const LARGE: f64 = 80.0;
/// Diameter below which elements are small, in pixels.
const SMALL: f64 = 20.0;
/// Least share of the photograph that its elements cover, if their size is to count.
const COVERED: f64 = 0.05;

/// The exemplar at the size at which it is analysed.
pub(super) fn reduced<'a>(
    exemplar: &'a Exemplar,
    segmenter: &dyn Segmenter,
    params: &AnalyzeParams,
    progress: &dyn Progress,
) -> Result<Cow<'a, Exemplar>> {
    let (width, height) = exemplar.image.dimensions();
    let pixels = f64::from(width) * f64::from(height);
    let most = f64::from(params.max_pixels);
    if most == 0.0 || pixels <= most {
        return Ok(Cow::Borrowed(exemplar));
    }
    advance(progress, "reducing", 0, 2)?;
    let known = if segmenter.seeks_elements() { elements_known(&exemplar.image)? } else { None };
    advance(progress, "reducing", 1, 2)?;
    let most = known.map_or(most, |known| most.min(known));
    let image = at_most(&exemplar.image, most, Filter::Lanczos);
    let layers = exemplar.layers.as_ref().map(|map| LayerMap {
        labels: map.labels.resized(image.width(), image.height()),
        layers: map.layers.clone(),
    });
    advance(progress, "reducing", 2, 2)?;
    let Exemplar { copies, file, sha256, warnings, .. } = exemplar;
    let (file, sha256, warnings) = (file.clone(), sha256.clone(), warnings.clone());
    Ok(Cow::Owned(Exemplar { image, copies: *copies, file, sha256, layers, warnings }))
}

/// Number of pixels at which an image's elements have the best size; `None` if they cover too little of it.
fn elements_known(image: &RgbImage) -> Result<Option<f64>> {
    let first = at_most(image, FIRST, Filter::Triangle);
    let masks = OneTree.segment(&first, &())?;
    let areas = masks.iter().map(|found| f64::from(found.mask.area())).collect();
    let shown = f64::from(first.width()) * f64::from(first.height());
    Ok(factor(areas, shown).map(|factor| shown * factor * factor))
}

/// Factor by which the area of a picture may grow after a first pass until its elements are large. At least
/// 1; `None` if elements cover too little of it.
fn factor(mut areas: Vec<f64>, shown: f64) -> Option<f64> {
    areas.sort_by(f64::total_cmp);
    let all: f64 = areas.iter().sum();
    // Quantile of the elements' diameters, weighted by area.
    let across = |share: f64| {
        let mut sum = 0.0;
        let at = areas.iter().find(|area| {
            sum += **area;
            sum >= share * all
        });
        at.map(|area| libm::sqrt(4.0 * area / std::f64::consts::PI))
    };
    let (quarter, half) = (across(0.25)?, across(0.5)?);
    (all >= COVERED * shown).then(|| (LARGE / half).max(SMALL / quarter).max(1.0))
}

/// The image reduced to at most `pixels` pixels, up to rounding.
fn at_most(image: &RgbImage, pixels: f64, filter: Filter) -> RgbImage {
    let (width, height) = image.dimensions();
    let by = libm::sqrt(pixels / f64::from(width) / f64::from(height)).min(1.0);
    let side = |side: u32| (libm::round(f64::from(side) * by) as u32).max(Exemplar::SMALLEST_SIDE).min(side);
    resized(image, side(width), side(height), filter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_segment::segment::Regions;

    /// Discs of a diameter on a lattice, of a brightness each.
    fn discs(side: u32, diameter: u32) -> Exemplar {
        let step = diameter * 3 / 2;
        let image = RgbImage::from_fn(side * 4 / 3, side, |x, y| {
            let [dx, dy] = [x, y].map(|v| f64::from(v % step) - f64::from(step) / 2.0);
            let inside = dx * dx + dy * dy < f64::from(diameter * diameter) / 4.0;
            let shade = 40 + ((x / step * 7 + y / step * 13) % 6) as u8 * 12;
            Rgb(if inside { [shade, shade / 2, 30] } else { [210, 205, 190] })
        });
        let warnings = Vec::new();
        Exemplar {
            image,
            copies: [1; 2],
            file: "discs".into(),
            sha256: String::new(),
            layers: None,
            warnings,
        }
    }

    #[test]
    fn photographs_are_reduced_to_the_limit_or_to_the_size_of_their_elements() {
        let params = AnalyzeParams { max_pixels: 700_000, ..AnalyzeParams::default() };
        let size = |diameter: u32| {
            let exemplar = discs(1500, diameter);
            let found = reduced(&exemplar, &Regions, &params, &()).unwrap();
            let (width, height) = found.image.dimensions();
            assert!((f64::from(width) / f64::from(height) - 4.0 / 3.0).abs() < 0.01);
            (width, f64::from(diameter * width) / 2000.0)
        };
        let (width, _) = size(40);
        assert_eq!(width, 966, "elements of this size bound nothing");
        let (width, across) = size(240);
        assert!(width < 900 && (60.0..100.0).contains(&across), "{width} {across}");
        let exemplar = discs(1500, 240);
        assert_eq!(reduced(&exemplar, &OneTree, &params, &()).unwrap().image.width(), 966);
        // An image filled by a few elements is not reduced below the size of the first pass.
        let (width, _) = size(800);
        assert!((460..470).contains(&width), "{width}");
    }

    #[test]
    fn without_a_limit_and_below_it_nothing_is_reduced() {
        let exemplar = discs(300, 40);
        for max_pixels in [0, 120_000] {
            let params = AnalyzeParams { max_pixels, ..AnalyzeParams::default() };
            assert!(matches!(reduced(&exemplar, &Regions, &params, &()).unwrap(), Cow::Borrowed(_)));
        }
        let params = AnalyzeParams { max_pixels: 119_999, ..AnalyzeParams::default() };
        assert!(matches!(reduced(&exemplar, &Regions, &params, &()).unwrap(), Cow::Owned(_)));
    }
}
