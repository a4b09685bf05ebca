//! What a PNG says of its colours without an ICC profile.

use super::ColourProfile;
use super::curve::Curve;
use std::io::Cursor;

/// x and y of the white, the red, the green and the blue of sRGB, BT.2020 and Display P3.
const SRGB: [[f64; 2]; 4] = [[0.3127, 0.3290], [0.640, 0.330], [0.300, 0.600], [0.150, 0.060]];
const BT_2020: [[f64; 2]; 4] = [[0.3127, 0.3290], [0.708, 0.292], [0.170, 0.797], [0.131, 0.046]];
const DISPLAY_P3: [[f64; 2]; 4] = [[0.3127, 0.3290], [0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];
/// The exponent that programs write for sRGB, and the largest difference to it.
const EXPONENT: [f64; 2] = [0.45455, 0.002];

impl ColourProfile {
    /// The colours of a PNG by its chunks: `cICP`, which takes precedence over an ICC profile, or `gAMA` with `cHRM` if
    /// it has neither a profile nor the chunk `sRGB`. `None` if they say nothing or it is no
    /// PNG, else an error if that cannot be applied.
    pub(in crate::raster) fn of_png(bytes: &[u8]) -> Option<Result<Self, &'static str>> {
        let reader = png::Decoder::new(Cursor::new(bytes)).read_info().ok()?;
        let info = reader.info();
        if let Some(points) = info.coding_independent_code_points {
            return Some(coded(points.color_primaries, points.transfer_function));
        }
        if info.icc_profile.is_some() || info.srgb.is_some() {
            return None;
        }
        let primaries = info.chrm_chunk.map(|found| {
            [found.white, found.red, found.green, found.blue]
                .map(|(x, y)| [x, y].map(|v| f64::from(v.into_scaled()) / 1e5))
        });
        let curve = match info.gama_chunk.map(|gamma| f64::from(gamma.into_scaled()) / 1e5) {
            Some(exponent) if exponent <= 0.0 => return Some(Err("is damaged")),
            Some(exponent) if (exponent - EXPONENT[0]).abs() > EXPONENT[1] => Curve::gamma(1.0 / exponent),
            Some(_) => Curve::srgb(),
            None => return None,
        };
        Some(Self::of_primaries(curve, primaries).ok_or("is damaged"))
    }
}

/// The colours of code points as ITU-T H.273 numbers them.
fn coded(primaries: u8, transfer: u8) -> Result<ColourProfile, &'static str> {
    let unknown = "is of a kind that vtex does not apply";
    let primaries = match primaries {
        1 => SRGB,
        9 => BT_2020,
        12 => DISPLAY_P3,
        _ => return Err(unknown),
    };
    let curve = match transfer {
        8 => Curve::gamma(1.0),
        13 => Curve::srgb(),
        16 | 18 => return Err("is for high dynamic range, which vtex does not show"),
        _ => return Err(unknown),
    };
    ColourProfile::of_primaries(curve, Some(primaries)).ok_or(unknown)
}
