//! Pictures whose pixels are made one by one with codebooks of neighbourhoods (Wei and Levoy, "Deterministic
//! Texture Analysis and Synthesis using Tree Structure Vector Quantization").

use super::neighbourhood::complete;
use super::pyramid::PictureLevel;
use super::synthesis::{LEAST_COMPLETE, ScanRequest, sources};
use super::{check_map, hardly_known};
use image::{Rgb, RgbImage};
use std::collections::BTreeSet;
use vtex_base::error::{Error, Result, check};
use vtex_base::parameter::Parameter;
use vtex_base::progress::Progress;
use vtex_base::raster::{LabelMap, check_size};

/// How pixels are made one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanParams {
    /// Levels of resolution, each half of the next finer one; see [`ScanParams::LEVELS`]. A level needs at
    /// least 64 neighbourhoods; of more levels than have these the coarsest are left out, with a warning. The
    /// default, `None`, is as many as have them, up to [`ScanParams::MOST_DEFAULT_LEVELS`].
    pub levels: Option<usize>,
    /// Side of the neighbourhoods that are compared, an odd number of pixels; see
    /// [`ScanParams::NEIGHBOURHOOD`].
    pub neighbourhood: usize,
    /// Codewords of each level at most; see [`ScanParams::CODEBOOK`].
    pub codebook: usize,
}

impl ScanParams {
    /// Range of the number of levels.
    pub const LEVELS: Parameter<usize> = Parameter::new("levels", [1, 8], "");
    /// Most levels by default (the paper: 6).
    pub const MOST_DEFAULT_LEVELS: usize = 6;
    /// Range and default of the side of neighbourhoods (the paper: 7).
    pub const NEIGHBOURHOOD: Parameter<usize> = Parameter::new("neighbourhood", [3, 15], "px").or(7);
    /// Range and default of the number of codewords (the paper: 4096).
    pub const CODEBOOK: Parameter<usize> = Parameter::new("codebook", [1, 65_536], "").or(4096);

    fn check(&self) -> Result<()> {
        self.levels.map_or(Ok(()), |levels| Self::LEVELS.check(levels))?;
        Self::NEIGHBOURHOOD.check(self.neighbourhood)?;
        let odd = format!("an odd number, {}", Self::NEIGHBOURHOOD);
        check(self.neighbourhood % 2 == 1, Self::NEIGHBOURHOOD.name, self.neighbourhood, odd)?;
        Self::CODEBOOK.check(self.codebook)
    }
}

impl Default for ScanParams {
    fn default() -> Self {
        let (neighbourhood, codebook) = (Self::NEIGHBOURHOOD.default(), Self::CODEBOOK.default());
        Self { levels: None, neighbourhood, codebook }
    }
}

/// Makes a picture of `size` pixels, pixel by pixel. It repeats along both axes, and has the colours of the
/// photograph as often as the photograph.
///
/// # Errors
/// A size or a parameter out of range; [`Error::Interrupted`].
pub fn scanned(
    image: &RgbImage,
    size: [usize; 2],
    params: &ScanParams,
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    check_size(size)?;
    params.check()?;
    let (exemplar, canvas) = (PictureLevel::of(image, None), PictureLevel::empty(size, [true; 2], None));
    made(image, ScanRequest { exemplar, canvas, params, keeps_colours: true, seed }, progress)
}

/// Makes a picture that follows the labels of `wanted` and has its size, pixel by pixel; `known` has the labels
/// of the photograph's pixels (texture by numbers, Hertzmann et al. 2001). It repeats along the axes of `wrap`.
///
/// # Errors
/// [`Error::Control`] if `known` has another size than the photograph, or `wanted` has labels that are
/// not in `known`; as [`scanned`].
pub fn scanned_by_numbers(
    image: &RgbImage,
    known: &LabelMap,
    wanted: &LabelMap,
    wrap: [bool; 2],
    params: &ScanParams,
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    let size = [wanted.width as usize, wanted.height as usize];
    check_size(size)?;
    params.check()?;
    check_map(image, known)?;
    let present: BTreeSet<u32> = known.labels.iter().copied().collect();
    if let Some(label) = wanted.labels.iter().find(|label| !present.contains(label)) {
        return Err(hardly_known(*label));
    }
    let exemplar = PictureLevel::of(image, Some(known));
    let canvas = PictureLevel::empty(size, wrap, Some(wanted));
    made(image, ScanRequest { exemplar, canvas, params, keeps_colours: true, seed }, progress)
}

/// The picture on a canvas without known pixels.
fn made(image: &RgbImage, request: ScanRequest<'_>, progress: &dyn Progress) -> Result<RgbImage> {
    let [width, height] = request.canvas.size;
    let found = sources(request, progress)?;
    let pixel = |x, y| taken(image, found[y as usize * width + x as usize]);
    Ok(RgbImage::from_fn(width as u32, height as u32, pixel))
}

/// Makes the pixels of a hole anew, from the others and joined to them; the others do not change. `hole` says for
/// each pixel, row by row, whether it is in the hole. The picture joins itself along the axes of `wrap`.
///
/// # Errors
/// [`Error::Control`] if the hole has another size than the picture, is empty, or leaves fewer than 64
/// neighbourhoods; a parameter out of range; [`Error::Interrupted`].
pub fn filled(
    image: &RgbImage,
    hole: &[bool],
    wrap: [bool; 2],
    params: &ScanParams,
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    params.check()?;
    let refuse = |reason: String, advice| {
        Err(Error::Control { name: "the hole".into(), role: "the part to fill", reason, advice })
    };
    if hole.len() != image.pixels().len() {
        return refuse("it has another size than the picture".into(), "make both of the same size");
    }
    if !hole.contains(&true) {
        return refuse("it is empty".into(), "paint what is to be filled white on black");
    }
    let mut exemplar = PictureLevel::of(image, None);
    for (i, _) in hole.iter().enumerate().filter(|(_, hole)| **hole) {
        (exemplar.known[i], exemplar.pixels[i]) = (false, [0.0; 3]);
    }
    let complete = complete(&exemplar, None, (params.neighbourhood / 2) as i64);
    let left = complete.into_iter().filter(|complete| *complete).count();
    if left < LEAST_COMPLETE {
        let n = params.neighbourhood;
        let reason =
            format!("it leaves {left} neighbourhoods of {n} x {n} pixels, {LEAST_COMPLETE} are needed");
        return refuse(reason, "leave more of the picture, or compare smaller neighbourhoods");
    }
    let canvas = PictureLevel { wrap, ..exemplar.clone() };
    let found = sources(ScanRequest { exemplar, canvas, params, keeps_colours: false, seed }, progress)?;
    let mut made = image.clone();
    for (i, pixel) in made.pixels_mut().enumerate().filter(|(i, _)| hole[*i]) {
        *pixel = taken(image, found[i]);
    }
    Ok(made)
}

/// Continues a picture beyond its border by `margins` pixels: on the left, at the top, on the right, at the
/// bottom. The picture itself does not change; the new pixels have its colours as often as the picture. The
/// result repeats along the axes of `wrap`.
///
/// # Errors
/// As [`scanned`].
pub fn extended(
    image: &RgbImage,
    margins: [usize; 4],
    wrap: [bool; 2],
    params: &ScanParams,
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    params.check()?;
    let own = [image.width() as usize, image.height() as usize];
    let [left, top, right, bottom] = margins;
    let size = [
        own[0].saturating_add(left).saturating_add(right),
        own[1].saturating_add(top).saturating_add(bottom),
    ];
    check_size(size)?;
    let exemplar = PictureLevel::of(image, None);
    let mut canvas = PictureLevel::empty(size, wrap, None);
    let place = |i: usize| (top + i / own[0]) * size[0] + left + i % own[0];
    for (i, pixel) in exemplar.pixels.iter().enumerate() {
        (canvas.known[place(i)], canvas.pixels[place(i)]) = (true, *pixel);
    }
    let known = canvas.known.clone();
    let found = sources(ScanRequest { exemplar, canvas, params, keeps_colours: true, seed }, progress)?;
    Ok(RgbImage::from_fn(size[0] as u32, size[1] as u32, |x, y| {
        let i = y as usize * size[0] + x as usize;
        if known[i] { *image.get_pixel(x - left as u32, y - top as u32) } else { taken(image, found[i]) }
    }))
}

/// The pixel of a photograph by its number.
fn taken(image: &RgbImage, source: u32) -> Rgb<u8> {
    *image.get_pixel(source % image.width(), source / image.width())
}
