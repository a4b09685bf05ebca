//! Small photographs: where few elements are whole, the exemplar is turned and mirrored, so that each is seen in several
//! ways.
//!
//! Only where nobody would notice. Light from one side makes slopes of lightness on one side of things steeper than on
//! the other, so the derivative of lightness is skewed along its direction. Structure with a direction, such as courses
//! or blades of grass, has stronger derivatives across it (the structure tensor of Förstner and Gülch, 1987); structure
//! with two directions at right angles, such as tiles, has them across both, which the same mean shows with four times
//! the angle in place of twice.

use serde::Serialize;
use vtex_base::raster::colour::oklab;
use vtex_scene::library::{Guide, Library, SourceKind};

/// Whole elements below which an exemplar is turned: the number of equal ones that would cover as much.
const FEW: f64 = 30.0;
/// Greatest anisotropy, 0 to 1, with one direction and with two at right angles, and greatest skewness of the
/// derivatives, for any turn.
const ANISOTROPY: f64 = 0.13;
const RIGHT_ANGLES: f64 = 0.12;
const SKEWNESS: f64 = 0.4;
/// Weights beside and on the axis of a derivative that is nearly the same in all directions (Scharr, "Optimal Operators in
/// Digital Image Processing", 2000).
const WEIGHTS: [f64; 2] = [3.0 / 16.0, 10.0 / 16.0];
/// Directions in which the skewness is measured.
const DIRECTIONS: usize = 12;

/// How an exemplar is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Turned {
    /// By any angle, and mirrored.
    Freely,
    /// Mirrored left to right only: light or structure has an upright direction.
    Mirrored,
}

impl Turned {
    /// Largest angle, in degrees.
    pub(super) fn angle(self) -> f64 {
        if self == Self::Freely { 180.0 } else { 0.0 }
    }
}

/// How exemplars are turned by default: only a single photograph with few whole elements and without layers, repeated
/// copies or anything regular.
pub(super) fn by_default(libraries: &[Library]) -> Option<Turned> {
    let [library] = libraries else { return None };
    let suits = library.source.kind == SourceKind::Photograph
        && library.source.copies == [1; 2]
        && !library.arrangement.periodic
        && !library.is_layered()
        && library.lattice.is_none();
    if !suits || equal_ones(library) >= FEW {
        return None;
    }
    allowed(library.guide.as_ref()?)
}

/// The number of equal elements that would cover as much as the whole primaries, each by as much as these on average,
/// weighted by area.
fn equal_ones(library: &Library) -> f64 {
    let whole = library.primaries().iter().filter(|p| !p.clipped).map(|p| f64::from(p.area));
    let (sum, squares) = whole.fold((0.0, 0.0), |(sum, squares), area| (sum + area, squares + area * area));
    // An exemplar without any has nothing to turn.
    if squares > 0.0 { sum * sum / squares } else { f64::INFINITY }
}

/// How a picture may be turned: light and structure must not show it.
fn allowed(guide: &Guide) -> Option<Turned> {
    let (width, height) = guide.picture.0.dimensions();
    let lightness: Vec<f64> = guide.picture.0.pixels().map(|p| f64::from(oklab(p.0)[0])).collect();
    let at = |x: u32, y: u32| lightness[(y * width + x) as usize];
    let mut slopes = Vec::new();
    for y in 1..height.saturating_sub(1) {
        slopes.extend((1..width.saturating_sub(1)).map(|x| {
            let side = |of: &dyn Fn(u32) -> f64| WEIGHTS[0] * (of(0) + of(2)) + WEIGHTS[1] * of(1);
            let across = side(&|k| at(x + 1, y + k - 1)) - side(&|k| at(x - 1, y + k - 1));
            [across, side(&|k| at(x + k - 1, y + 1)) - side(&|k| at(x + k - 1, y - 1))]
        }));
    }
    let mean =
        |of: &dyn Fn(&[f64; 2]) -> f64| slopes.iter().map(of).sum::<f64>() / slopes.len().max(1) as f64;
    let [xx, xy, yy] = [mean(&|s| s[0] * s[0]), mean(&|s| s[0] * s[1]), mean(&|s| s[1] * s[1])];
    let trace = (xx + yy).max(1e-12);
    let skewness = |turn: f64| {
        let (sine, cosine) = libm::sincos(turn);
        let along = |s: &[f64; 2]| cosine * s[0] + sine * s[1];
        let square = mean(&|s| along(s) * along(s)).max(1e-12);
        (mean(&|s| along(s) * along(s) * along(s)) / (square * libm::sqrt(square))).abs()
    };
    let anisotropy = libm::hypot(xx - yy, 2.0 * xy) / trace;
    // The square of the derivative as a complex number, over its length.
    let twice = |[x, y]: &[f64; 2]| {
        let [re, im, length] = [x * x - y * y, 2.0 * x * y, (x * x + y * y).max(1e-12)];
        [(re * re - im * im) / length, 2.0 * re * im / length]
    };
    let right_angles = libm::hypot(mean(&|s| twice(s)[0]), mean(&|s| twice(s)[1])) / trace;
    let all = (0..DIRECTIONS).map(|k| skewness(std::f64::consts::PI * k as f64 / DIRECTIONS as f64));
    let has_direction = anisotropy > ANISOTROPY || right_angles > RIGHT_ANGLES;
    if !has_direction && all.fold(0.0, f64::max) <= SKEWNESS {
        return Some(Turned::Freely);
    }
    let is_symmetric = (2.0 * xy / trace).abs() <= ANISOTROPY && skewness(0.0) <= SKEWNESS;
    is_symmetric.then_some(Turned::Mirrored)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, RgbImage};
    use vtex_base::sampling::stream;
    use vtex_scene::library::Picture;

    /// Tiles of several tones.
    fn tiles() -> Guide {
        let tone = |x: u32, y: u32| Rgb([90 + ((x / 16 * 7 + y / 16 * 11) % 5 * 20) as u8; 3]);
        Guide { cell: 4, picture: Picture(RgbImage::from_fn(80, 80, tone)) }
    }

    /// Domes lit from a direction, or flat disks, stretched along x.
    fn guide(light: [f64; 2], stretch: f64) -> Guide {
        let mut random = stream(4, "turned test", 0);
        let mut heights = vec![0.35f64; 80 * 80];
        for _ in 0..90 {
            let (cx, cy, r) = (random.range(0.0, 80.0), random.range(0.0, 80.0), random.range(3.0, 6.0));
            let tone = random.range(-0.15, 0.15);
            for (i, value) in heights.iter_mut().enumerate() {
                let (u, v) = (((i % 80) as f64 - cx) / (stretch * r), ((i / 80) as f64 - cy) / r);
                if u * u + v * v < 1.0 {
                    *value = 0.55 + tone + 0.3 * (light[0] * u + light[1] * v);
                }
            }
        }
        let pixel = |x: u32, y: u32| Rgb([(255.0 * heights[(y * 80 + x) as usize]) as u8; 3]);
        Guide { cell: 4, picture: Picture(RgbImage::from_fn(80, 80, pixel)) }
    }

    #[test]
    fn light_and_structure_decide_on_turning() {
        assert_eq!(allowed(&guide([0.0; 2], 1.0)), Some(Turned::Freely));
        assert_eq!(allowed(&guide([0.0, 1.0], 1.0)), Some(Turned::Mirrored));
        assert_eq!(allowed(&guide([0.7, 0.7], 1.0)), None);
        assert_eq!(allowed(&guide([0.0; 2], 2.5)), Some(Turned::Mirrored));
        assert_ne!(allowed(&tiles()), Some(Turned::Freely));
    }
}
