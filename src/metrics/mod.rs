//! How alike two pictures of textures are, in numbers that need no network.
//!
//! None of these is a judge by itself: each looks at one thing (colours, frequencies, grain, small
//! structures, repetition), and two photographs of one texture are never at distance 0. Figures
//! for comparison are in `benches/metrics.md`.
//!
//! When this works badly: textures that differ in scale (say so, see [`scaled`]), and pictures that
//! show few elements, where chance decides.

mod colour;
mod filter_bank;
mod fourier;
mod local_patterns;
mod patches;
mod plane;
mod sharpness;
mod similarity;
mod spectrum;
mod structure;
#[cfg(test)]
mod tests;
mod transport;

use crate::error::{Error, Result, check};
use crate::progress::{Progress, advance};
use image::RgbImage;
use image::imageops::{FilterType, resize};
use plane::Plane;
use serde::Serialize;
pub use structure::Spread;

/// Smallest side of a picture, in pixels.
const SMALLEST: u32 = 32;
/// Most pixels of a picture.
const MOST_PIXELS: u64 = 1 << 24;

/// How far a result is from an exemplar. Of what is called a distance 0 is the same and more is
/// worse.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Width and height of the exemplar, in pixels.
    pub exemplar_size: [u32; 2],
    /// Width and height of the result as it was compared, in pixels.
    pub result_size: [u32; 2],
    /// Side of the windows on which spectra are compared, in pixels.
    pub window: usize,
    /// Earth mover's distance of the histograms of red, green and blue, their mean; 0 to 255.
    pub emd_rgb: f64,
    /// Earth mover's distance of the histograms in CIE Lab, in ΔE.
    pub emd_lab: f64,
    /// Distance of the logarithms of power in 14 bands of frequencies, root mean square.
    pub psd_radial: f64,
    /// The same, in eight directions each.
    pub psd_2d: f64,
    /// χ² distance of local binary patterns, 0 to 1.
    pub lbp: f64,
    /// Sliced Wasserstein distance of patches, mean of the levels, in deviations of the exemplar's.
    pub swd: f64,
    /// The same for each level, from the finest.
    pub swd_levels: Vec<f64>,
    /// Fréchet distance of filter responses, in deviations of the exemplar's.
    pub fb_frechet: f64,
    /// How far the result's patches are from the exemplar's, 1 being as far as the exemplar's own
    /// from each other; none where a side is below 53 px.
    pub coherence: Option<f64>,
    /// How far the exemplar's patches are from the result's, likewise.
    pub completeness: Option<f64>,
    /// Variance of the Laplacian of the exemplar's grey values: less is more blurred.
    pub lapvar_exemplar: f64,
    /// The same of the result.
    pub lapvar_result: f64,
    /// Logarithm of their quotient: below 0 the result is more blurred, above 0 rougher.
    pub lapvar_logratio: f64,
    /// The spread of the means of blocks, by their size: structure larger than a few elements.
    pub structure: Vec<Spread>,
    /// How strongly the exemplar repeats beyond 12 px: its largest autocorrelation, at most 1.
    pub acf_peak_exemplar: f64,
    /// The same of the result.
    pub acf_peak_result: f64,
    /// Structural similarity of the middles of both pictures, pixel on pixel, 0 to 1 (the same).
    pub ssim: f64,
    /// The same at five scales; none where a side is below 176 px.
    pub ms_ssim: Option<f64>,
}

/// Compares a result with its exemplar. Both are taken at the same scale and may differ in size.
///
/// # Errors
/// [`Error::Unusable`] of a picture with a side below 32 px, [`Error::TooLarge`] above 2²⁴ pixels,
/// [`Error::Interrupted`].
pub fn compare(exemplar: &RgbImage, result: &RgbImage, progress: &dyn Progress) -> Result<Metrics> {
    const STEPS: u64 = 8;
    for (image, name) in [(exemplar, "exemplar"), (result, "result")] {
        check_size(image, name)?;
    }
    let step = |done: u64| advance(progress, "comparing", done, STEPS);
    step(0)?;
    let (grey_a, grey_b) = (Plane::grey(exemplar), Plane::grey(result));
    let (lab_a, lab_b) = (Plane::lab(exemplar), Plane::lab(result));
    let emd_rgb = colour::emd_rgb(exemplar, result);
    let emd_lab = colour::emd_lab(exemplar, result);
    step(1)?;
    let window = spectrum::window(&grey_a, &grey_b);
    let [psd_radial, psd_2d] = spectrum::psd(&grey_a, &grey_b, window);
    step(2)?;
    let lbp = local_patterns::lbp(&grey_a, &grey_b);
    step(3)?;
    let swd_levels = patches::swd(&lab_a, &lab_b);
    step(4)?;
    let fb_frechet = filter_bank::frechet(&lab_a, &lab_b);
    step(5)?;
    let complete = patches::completeness(&lab_a, &lab_b);
    step(6)?;
    let [lapvar_exemplar, lapvar_result] = [&grey_a, &grey_b].map(sharpness::lapvar);
    let [acf_peak_exemplar, acf_peak_result] = [&grey_a, &grey_b].map(spectrum::acf_peak);
    step(7)?;
    let structure = structure::spreads(exemplar, result);
    let (ssim, ms_ssim) = similarity::ssim(&grey_a, &grey_b);
    step(STEPS)?;
    Ok(Metrics {
        exemplar_size: exemplar.dimensions().into(),
        result_size: result.dimensions().into(),
        window,
        emd_rgb,
        emd_lab,
        psd_radial,
        psd_2d,
        lbp,
        swd: swd_levels.iter().sum::<f64>() / swd_levels.len() as f64,
        swd_levels,
        fb_frechet,
        coherence: complete.map(|c| c.coherence),
        completeness: complete.map(|c| c.completeness),
        lapvar_exemplar,
        lapvar_result,
        lapvar_logratio: libm::log((lapvar_result + 1e-3) / (lapvar_exemplar + 1e-3)),
        structure,
        acf_peak_exemplar,
        acf_peak_result,
        ssim,
        ms_ssim,
    })
}

/// A picture that shows the texture `scale` times as large as the exemplar, brought to the
/// exemplar's scale by a Lanczos filter.
///
/// # Errors
/// A scale outside 0.01 to 100; [`Error::TooLarge`] if the result would have more than 2²⁴ pixels.
pub fn scaled(image: RgbImage, scale: f64) -> Result<RgbImage> {
    check((0.01..=100.0).contains(&scale), "scale", scale, "0.01 to 100")?;
    if scale == 1.0 {
        return Ok(image);
    }
    let side = |v: u32| libm::rint(f64::from(v) / scale).max(1.0);
    let (width, height) = (side(image.width()), side(image.height()));
    check_pixels(width * height, "result")?;
    Ok(resize(&image, width as u32, height as u32, FilterType::Lanczos3))
}

fn check_size(image: &RgbImage, name: &str) -> Result<()> {
    let (width, height) = image.dimensions();
    if width.min(height) < SMALLEST {
        let reason = format!(
            "it has {width} x {height} pixels, at least {SMALLEST} x {SMALLEST} are needed to compare"
        );
        return Err(Error::Unusable { name: name.into(), reason });
    }
    check_pixels(f64::from(width) * f64::from(height), name)
}

fn check_pixels(pixels: f64, name: &str) -> Result<()> {
    if pixels <= MOST_PIXELS as f64 {
        return Ok(());
    }
    let limit = format!("{MOST_PIXELS} pixels");
    Err(Error::TooLarge { name: name.into(), found: format!("{pixels:.0} pixels"), limit })
}
