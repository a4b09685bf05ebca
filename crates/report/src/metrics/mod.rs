//! Measures of the similarity of two pictures of textures; none of them needs a network.
//!
//! No single value decides. Each covers one aspect (colours, frequencies, grain, small structures,
//! repetition), and two photographs of the same texture are never at distance 0. Reference values are in
//! `docs/measurements/metrics.md`.
//!
//! [`contours`] alone looks at a result drawn larger than its exemplar.
//!
//! Definitions agree with those of the usual Python packages (numpy, scipy, scikit-image, POT, PyIQA); tests
//! hold values of these. The last digits of spectra depend on the processor, so they are reported and
//! nothing is made from them.
//!
//! Works badly for pictures at different scales (see [`scaled`]), and for pictures with so few elements that
//! the values are dominated by chance.

mod colour;
mod contours;
mod filter_bank;
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

pub use contours::{Contours, ENLARGED, can_compare_contours, contours};
use image::RgbImage;
use plane::Channel;
use serde::Serialize;
pub use structure::Spread;
use vtex_base::Parameter;
use vtex_base::error::{Error, Large, Result};
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::{Filter, resized};

/// Smallest permitted width and height of a picture, in pixels.
const SMALLEST: u32 = 32;
/// Largest permitted number of pixels of a picture: two of them take some 12 seconds of one core and 350 MB.
const MOST_PIXELS: u64 = 1_600_000;
/// Largest number of pixels of a picture that [`scaled`] makes.
const MOST_SCALED: u64 = 24_000_000;

/// Measures of how far a result is from its exemplar, as [`compare`] returns them. Distances are 0
/// for identical pictures and grow with the difference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Width and height of the exemplar, in pixels.
    pub exemplar_size: [u32; 2],
    /// Width and height of the result as it was compared, in pixels.
    pub result_size: [u32; 2],
    /// Side of the windows whose power spectra are compared, in pixels.
    pub window: usize,
    /// Earth mover's distance between 8-bit histograms, averaged over red, green and blue; 0 to 255.
    pub emd_rgb: f64,
    /// Earth mover's distance between histograms in CIE Lab, in ΔE.
    pub emd_lab: f64,
    /// Root mean square difference of log power over 14 radial frequency bands.
    pub psd_radial: f64,
    /// Root mean square difference of log power over the same bands, each split into eight directions.
    pub psd_2d: f64,
    /// χ² distance between histograms of local binary patterns, 0 to 1.
    pub lbp: f64,
    /// Sliced Wasserstein distance between patches, averaged over the pyramid's levels, in standard
    /// deviations of the exemplar's patches.
    pub swd: f64,
    /// [`Metrics::swd`] for each level, the finest first.
    pub swd_levels: Vec<f64>,
    /// Fréchet distance between filter responses, in standard deviations of the exemplar's responses.
    pub fb_frechet: f64,
    /// Mean distance of the result's patches to the nearest patch of the exemplar, relative to that among
    /// the exemplar's own patches (1 is equal). `None` if a side is below 53 px.
    pub coherence: Option<f64>,
    /// Mean distance of the exemplar's patches to the nearest patch of the result, relative to that among
    /// the exemplar's own patches (1 is equal). `None` if a side is below 53 px.
    pub completeness: Option<f64>,
    /// Variance of the Laplacian of the exemplar's grey values (0 to 255). Lower is more blurred.
    pub lapvar_exemplar: f64,
    /// Variance of the Laplacian of the result's grey values (0 to 255).
    pub lapvar_result: f64,
    /// Logarithm of result over exemplar of these variances. Below 0 the result is more blurred, above 0
    /// noisier.
    pub lapvar_logratio: f64,
    /// Spread of block means for each block size: contrast of structure larger than a few elements.
    pub structure: Vec<Spread>,
    /// Repetition in the exemplar: its largest normalised autocorrelation beyond 12 px, at most 1.
    pub acf_peak_exemplar: f64,
    /// Repetition in the result, measured likewise.
    pub acf_peak_result: f64,
    /// Structural similarity (SSIM) of the pictures' common central part, 0 to 1 (identical).
    pub ssim: f64,
    /// Multi-scale structural similarity (MS-SSIM, five scales), 0 to 1. `None` if a side is below 176 px.
    pub ms_ssim: Option<f64>,
    /// Contours of the enlarged result. `None` from [`compare`], which sees the result at one size only; what can be
    /// drawn at another size has those of [`contours`].
    pub contours: Option<Contours>,
}

/// Compares a result with its exemplar. Both must show the texture at the same scale; their sizes
/// may differ.
///
/// # Errors
/// [`Error::Unusable`] if a side is below 32 px, [`Error::TooLarge`] above 1.6 million pixels (see [`reduced`]),
/// [`Error::Interrupted`].
///
/// # Example
/// ```
/// # mod vtex { pub use {vtex_base::Error, vtex_report::metrics}; }
/// # use image::{Rgb, RgbImage};
/// let stripes = |period: u32| RgbImage::from_fn(64, 64, |x, _| Rgb([(x % period * 20) as u8; 3]));
/// let same = vtex::metrics::compare(&stripes(8), &stripes(8), &())?;
/// let other = vtex::metrics::compare(&stripes(8), &stripes(5), &())?;
/// assert_eq!(same.emd_rgb, 0.0);
/// assert!(other.emd_rgb > 10.0 && other.ssim < same.ssim);
/// # Ok::<(), vtex::Error>(())
/// ```
pub fn compare(exemplar: &RgbImage, result: &RgbImage, progress: &dyn Progress) -> Result<Metrics> {
    const STEPS: u64 = 8;
    for (image, name) in [(exemplar, "exemplar"), (result, "result")] {
        check_size(image, name)?;
    }
    let step = |done: u64| advance(progress, "comparing", done, STEPS);
    step(0)?;
    let (grey_a, grey_b) = (Channel::grey(exemplar), Channel::grey(result));
    let (lab_a, lab_b) = (Channel::lab(exemplar), Channel::lab(result));
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
        contours: None,
    })
}

/// How many times as large as the exemplar a picture shows the texture.
pub const SCALE: Parameter<f64> = Parameter::new("scale", [0.01, 100.0], "").or(1.0);

/// Resamples a picture that shows the texture `scale` times as large as the exemplar to the
/// exemplar's scale, by a Lanczos filter.
///
/// # Errors
/// [`Error::Parameter`] for a scale out of range; [`Error::TooLarge`] if the result would have more
/// than 24 million pixels.
pub fn scaled(image: RgbImage, scale: f64) -> Result<RgbImage> {
    SCALE.check(scale)?;
    if scale == 1.0 {
        return Ok(image);
    }
    let side = |v: u32| libm::rint(f64::from(v) / scale).max(1.0);
    let (width, height) = (side(image.width()), side(image.height()));
    check_pixels(width * height, MOST_SCALED, "result")?;
    Ok(resized(&image, width as u32, height as u32, Filter::Lanczos))
}

/// Two pictures as they are, or made smaller by the same factor, with a warning, so that the larger has no more pixels
/// than [`compare`] takes.
pub fn reduced([exemplar, result]: [RgbImage; 2], progress: &dyn Progress) -> [RgbImage; 2] {
    let pixels = |image: &RgbImage| f64::from(image.width()) * f64::from(image.height());
    let factor = libm::sqrt(MOST_PIXELS as f64 / pixels(&exemplar).max(pixels(&result)));
    if factor >= 1.0 {
        return [exemplar, result];
    }
    let smaller = |image: RgbImage| {
        let [width, height] =
            [image.width(), image.height()].map(|v| (f64::from(v) * factor).max(1.0) as u32);
        resized(&image, width, height, Filter::Lanczos)
    };
    let pictures = [smaller(exemplar), smaller(result)];
    let (width, height) = pictures[0].dimensions();
    progress.warn(&format!(
        "both pictures were reduced by the same factor before they were compared, the exemplar to \
         {width} x {height} px: fine grain counts for less"
    ));
    pictures
}

fn check_size(image: &RgbImage, name: &str) -> Result<()> {
    let (width, height) = image.dimensions();
    if width.min(height) < SMALLEST {
        let reason = format!(
            "it has {width} x {height} pixels, at least {SMALLEST} x {SMALLEST} are needed to compare"
        );
        let advice = "use larger pictures, or reduce them less";
        return Err(Error::Unusable { name: name.into(), reason, advice });
    }
    check_pixels(f64::from(width) * f64::from(height), MOST_PIXELS, name)
}

fn check_pixels(pixels: f64, most: u64, name: &str) -> Result<()> {
    if pixels <= most as f64 {
        return Ok(());
    }
    let limit = format!("{most} pixels");
    Err(Error::TooLarge {
        what: Large::Picture,
        name: name.into(),
        found: format!("{pixels:.0} pixels"),
        limit,
    })
}
