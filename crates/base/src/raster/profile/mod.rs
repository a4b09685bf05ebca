//! Colour profiles: conversion of pictures to sRGB.
//!
//! `moxcms` reads ICC profiles. They are evaluated here, in double precision: the vectorised paths of `moxcms` depend on
//! the processor, and results must not. Conversion is relative to white (D50). Tables of a profile, such as those for
//! inks, take precedence over its matrix; theirs is the perceptual intent if the profile has it, and their darkest
//! colour becomes black, as other programs do it (black point compensation).

mod curve;
mod png;
mod table;

use crate::error::caught;
use crate::parallel::for_chunks;
use crate::symmetric::inverse;
use curve::{Curve, between};
use image::{DynamicImage, RgbImage};
use moxcms::{ColorProfile, DataColorSpace, LutWarehouse, ProfileVersion, ToneReprCurve};
use std::sync::OnceLock;
use table::{Table, WHITE};

/// From X, Y and Z under D50 to linear sRGB: the inverse of the primaries of sRGB profiles.
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.134_112_161_899_541, -1.617_392_435_666_53, -0.490_633_424_666_166_3],
    [-0.978_787_281_478_924_8, 1.916_279_568_535_073, 0.033_454_718_340_960_38],
    [0.071_983_028_418_387_81, -0.228_985_848_850_765_1, 1.405_385_132_929_906_7],
];
/// Black of the perceptual intent in profiles of the fourth version, as X, Y and Z.
const PERCEPTUAL_BLACK: [f64; 3] = [0.00336, 0.003_473_1, 0.00287];
/// Largest lightness that counts as black, in Lab.
const LIGHTEST_BLACK: f64 = 50.0;
/// Largest difference to sRGB, in steps of 8 bits, of a profile that is taken for sRGB.
const SAME: f64 = 1.0;
/// Pixels that are converted at a time.
const PIECE: usize = 1 << 14;

/// The colours that samples of a picture stand for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColourProfile {
    /// The first curve of each channel: one for grey, three for RGB, four for CMYK.
    curves: Vec<Curve>,
    after: After,
}

/// What follows the first curves.
#[derive(Clone, Debug, PartialEq)]
enum After {
    /// Nothing: linear grey.
    Grey,
    /// A matrix to linear sRGB.
    Matrix([[f64; 3]; 3]),
    /// A table to X, Y and Z, of which each is then multiplied by a number and another is added.
    Table(Box<Table>, [[f64; 2]; 3]),
}

impl ColourProfile {
    /// Reads an ICC profile.
    ///
    /// # Errors
    /// What is wrong with it, as the end of a sentence that begins with it.
    pub(super) fn from_icc(bytes: &[u8]) -> Result<Self, &'static str> {
        let damaged = "is damaged";
        let profile =
            caught(|| ColorProfile::new_from_slice(bytes)).ok().and_then(Result::ok).ok_or(damaged)?;
        let channels = match profile.color_space {
            DataColorSpace::Gray => 1,
            DataColorSpace::Rgb => 3,
            DataColorSpace::Cmyk => 4,
            _ => return Err("is neither for grey nor for RGB nor for CMYK"),
        };
        let tables = [
            &profile.lut_a_to_b_perceptual,
            &profile.lut_a_to_b_colorimetric,
            &profile.lut_a_to_b_saturation,
        ];
        if let Some(lut) = tables.into_iter().flatten().next().filter(|_| channels > 1) {
            return Self::of_table(&profile, lut, channels).ok_or(damaged);
        }
        let curve = |curve: &Option<ToneReprCurve>| curve.as_ref().and_then(Curve::new).ok_or(damaged);
        match channels {
            1 => Ok(Self { curves: vec![curve(&profile.gray_trc)?], after: After::Grey }),
            3 => {
                let [r, g, b] = [profile.red_colorant, profile.green_colorant, profile.blue_colorant];
                let colorants = [[r.x, g.x, b.x], [r.y, g.y, b.y], [r.z, g.z, b.z]];
                let curves =
                    vec![curve(&profile.red_trc)?, curve(&profile.green_trc)?, curve(&profile.blue_trc)?];
                Ok(Self { curves, after: After::Matrix(product(&FROM_XYZ, &colorants)) })
            }
            _ => Err(damaged),
        }
    }

    fn of_table(profile: &ColorProfile, lut: &LutWarehouse, channels: usize) -> Option<Self> {
        let (curves, table) = Table::new(lut, profile.pcs, channels)?;
        let is_perceptual = profile.lut_a_to_b_perceptual.is_some();
        let black = if is_perceptual && profile.version() >= ProfileVersion::V4_0 {
            PERCEPTUAL_BLACK
        } else {
            // All inks, or no light.
            let level = if channels == 4 { 1.0 } else { 0.0 };
            let darkest: Vec<f64> = curves.iter().map(|curve| curve.at(level)).collect();
            let y = table.xyz(&darkest)[1].clamp(0.0, luminance(LIGHTEST_BLACK));
            WHITE.map(|v| v * y)
        };
        // Black becomes 0, white stays.
        let scale = |k: usize| {
            let by = WHITE[k] / (WHITE[k] - black[k]);
            [by, -by * black[k]]
        };
        Some(Self { curves, after: After::Table(Box::new(table), std::array::from_fn(scale)) })
    }

    /// RGB with a curve for all channels and primaries: x and y of white, red, green and blue, those of sRGB if `None`.
    /// `None` if these are no primaries.
    fn of_primaries(curve: Curve, primaries: Option<[[f64; 2]; 4]>) -> Option<Self> {
        let matrix = match primaries {
            Some(primaries) => product(&FROM_XYZ, &to_xyz(primaries)?),
            None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        Some(Self { curves: vec![curve; 3], after: After::Matrix(matrix) })
    }

    /// Whether it is for CMYK.
    pub(super) fn is_for_inks(&self) -> bool {
        self.curves.len() == 4
    }

    /// Whether it changes no colour by more than a step of 8 bits.
    pub(super) fn is_srgb(&self) -> bool {
        let levels = Levels::new(self, 255);
        let same = |rgb: [usize; 3]| {
            let samples = &rgb[..self.curves.len()];
            levels.encoded(samples).iter().zip(rgb).all(|(own, v)| (255.0 * own - v as f64).abs() <= SAME)
        };
        let colours = || (0..216).map(|i| [51 * (i % 6), 51 * (i / 6 % 6), 51 * (i / 36)]);
        !self.is_for_inks()
            && (0..256).all(|v| same([v; 3]))
            && (self.curves.len() == 1 || colours().all(same))
    }

    /// Converts a picture of grey or RGB to sRGB; one of grey becomes one of RGB where the profile is for RGB.
    ///
    /// # Errors
    /// Why it cannot, as the end of a sentence that begins with the profile.
    pub(super) fn converted(&self, image: &mut DynamicImage) -> Result<(), &'static str> {
        use DynamicImage as D;
        match (&*image, self.curves.len()) {
            (_, 4) => return Err("is for CMYK, which the picture is not"),
            (image, 1) if image.color().has_color() => return Err("is for grey, which the picture is not"),
            (D::ImageLuma8(_), 3) => *image = D::ImageRgb8(image.to_rgb8()),
            (D::ImageLuma16(_), 3) => *image = D::ImageRgb16(image.to_rgb16()),
            (D::ImageLumaA8(_), 3) => *image = D::ImageRgba8(image.to_rgba8()),
            (D::ImageLumaA16(_), 3) => *image = D::ImageRgba16(image.to_rgba16()),
            _ => {}
        }
        match image {
            D::ImageLuma8(p) => self.convert(p, 1),
            D::ImageLumaA8(p) => self.convert(p, 2),
            D::ImageRgb8(p) => self.convert(p, 3),
            D::ImageRgba8(p) => self.convert(p, 4),
            D::ImageLuma16(p) => self.convert(p, 1),
            D::ImageLumaA16(p) => self.convert(p, 2),
            D::ImageRgb16(p) => self.convert(p, 3),
            D::ImageRgba16(p) => self.convert(p, 4),
            _ => return Err("is not applied to floating-point samples"),
        }
        Ok(())
    }

    /// Converts pixels of `each` samples, of which those after the channels of the profile stay.
    fn convert<S: Sample>(&self, pixels: &mut [S], each: usize) {
        let (levels, channels) = (Levels::new(self, S::MOST), self.curves.len());
        for_chunks(pixels, PIECE * each, |_, piece| {
            for pixel in piece.chunks_exact_mut(each) {
                let samples: [usize; 3] = std::array::from_fn(|k| pixel[k.min(channels - 1)].into());
                let encoded = levels.encoded(&samples[..channels]);
                for (sample, value) in pixel[..channels].iter_mut().zip(encoded) {
                    *sample = S::rounded(value);
                }
            }
        });
    }

    /// The colours of inks, four samples to a pixel, where 0 is no ink.
    pub(super) fn of_inks<S: Sample>(&self, inks: &[S], [width, height]: [u32; 2]) -> RgbImage {
        let levels = Levels::new(self, S::MOST);
        let mut image = RgbImage::new(width, height);
        for_chunks(&mut image, PIECE * 3, |piece, colours| {
            let inks = inks[piece * PIECE * 4..].chunks_exact(4);
            for (colour, inks) in colours.chunks_exact_mut(3).zip(inks) {
                let samples: [usize; 4] = std::array::from_fn(|k| inks[k].into());
                colour.copy_from_slice(&levels.encoded(&samples).map(u8::rounded));
            }
        });
        image
    }
}

/// A sample of a picture.
pub(super) trait Sample: Copy + Into<usize> + Send + Sync {
    /// The largest.
    const MOST: usize;
    /// The nearest to a share of the largest.
    fn rounded(share: f64) -> Self;
}

impl Sample for u8 {
    const MOST: usize = 255;
    fn rounded(share: f64) -> Self {
        (share * 255.0 + 0.5) as u8
    }
}

impl Sample for u16 {
    const MOST: usize = 65535;
    fn rounded(share: f64) -> Self {
        (share * 65535.0 + 0.5) as u16
    }
}

/// A profile with its first curves for all levels of a sample.
struct Levels<'a> {
    profile: &'a ColourProfile,
    curves: Vec<Vec<f32>>,
    /// sRGB components of linear light at even distances.
    encoding: &'static [f32],
}

impl<'a> Levels<'a> {
    fn new(profile: &'a ColourProfile, most: usize) -> Self {
        Self {
            profile,
            curves: profile.curves.iter().map(|c| c.levels(most)).collect(),
            encoding: encoding(),
        }
    }

    /// The sRGB components, 0 to 1, of samples; those of grey are equal.
    fn encoded(&self, samples: &[usize]) -> [f64; 3] {
        let level = |k: usize| f64::from(self.curves[k][samples[k]]);
        let linear = match &self.profile.after {
            After::Grey => [level(0); 3],
            After::Matrix(matrix) => times(matrix, [level(0), level(1), level(2)]),
            After::Table(table, scale) => {
                let mut values = [0.0; 4];
                values.iter_mut().zip(0..samples.len()).for_each(|(v, k)| *v = level(k));
                let xyz = table.xyz(&values[..samples.len()]);
                times(&FROM_XYZ, std::array::from_fn(|k| scale[k][0] * xyz[k] + scale[k][1]))
            }
        };
        linear.map(|v| between(self.encoding, v.clamp(0.0, 1.0)))
    }
}

/// sRGB components of 65537 levels of linear light, so dense that they are exact to 16 bits between two.
fn encoding() -> &'static [f32] {
    static ENCODING: OnceLock<Vec<f32>> = OnceLock::new();
    let encoded = |v: f64| {
        if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 }
    };
    ENCODING.get_or_init(|| (0..=65536).map(|i| encoded(f64::from(i) / 65536.0) as f32).collect())
}

/// Luminance of a lightness of Lab from 8 on, relative to white.
fn luminance(lightness: f64) -> f64 {
    let v = (lightness + 16.0) / 116.0;
    v * v * v
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| std::array::from_fn(|k| (0..3).map(|i| row[i] * b[i][k]).sum()))
}

/// From linear RGB with primaries, x and y of white, red, green and blue, to X, Y and Z under D50, adapted as Bradford
/// does; `None` if these are not primaries.
fn to_xyz(primaries: [[f64; 2]; 4]) -> Option<[[f64; 3]; 3]> {
    const CONES: [[f64; 3]; 3] =
        [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    let [white, r, g, b] = primaries.map(|[x, y]| [x / y, 1.0, (1.0 - x - y) / y]);
    let columns: [[f64; 3]; 3] = std::array::from_fn(|k| [r[k], g[k], b[k]]);
    let light = times(&inverse(&columns)?, white);
    let own = columns.map(|row| std::array::from_fn(|k| row[k] * light[k]));
    let [from, to] = [white, WHITE].map(|white| times(&CONES, white));
    let adapted: [[f64; 3]; 3] = std::array::from_fn(|k| CONES[k].map(|v| v * to[k] / from[k]));
    let all = product(&product(&inverse(&CONES)?, &adapted), &own);
    all.iter().flatten().all(|v| v.is_finite()).then_some(all)
}

#[cfg(test)]
pub(super) mod tests;
