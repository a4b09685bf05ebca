//! Small photographs: where few elements are whole, the exemplar is turned and mirrored, so that each is seen in several
//! ways.
//!
//! Only where nobody would notice: light from one side makes slopes of lightness on one side of things steeper than on
//! the other, so the derivative of lightness is skewed along its direction; and structure with a direction, such as
//! courses or blades of grass, has stronger derivatives across it (the structure tensor of Förstner and Gülch, 1987).

use serde::Serialize;
use vtex_base::raster::colour::oklab;
use vtex_scene::lattice::Lattice;
use vtex_scene::library::{Guide, Library, SourceKind};

/// Whole elements below which an exemplar is turned: the number of equal ones that would cover as much. 0, so none is
/// by default yet: scenes of turned exemplars do not survive being saved to the last digit.
const FEW: f64 = 0.0;
/// Greatest anisotropy of the structure tensor, 0 to 1, and greatest skewness of the derivatives, for any turn.
const ANISOTROPY: f64 = 0.13;
const SKEWNESS: f64 = 0.4;
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

/// How exemplars are turned by default: only a single photograph with few whole elements and without rows, layers or
/// repeated copies.
pub(super) fn by_default(libraries: &[Library]) -> Option<Turned> {
    let [library] = libraries else { return None };
    let suits = library.source.kind == SourceKind::Photograph
        && library.source.copies == [1; 2]
        && !library.arrangement.periodic
        && !library.is_layered()
        && !library.lattice.as_ref().is_some_and(Lattice::is_kept);
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
        slopes.extend(
            (1..width.saturating_sub(1)).map(|x| [at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1)]),
        );
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
    let all = (0..DIRECTIONS).map(|k| skewness(std::f64::consts::PI * k as f64 / DIRECTIONS as f64));
    if anisotropy <= ANISOTROPY && all.fold(0.0, f64::max) <= SKEWNESS {
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
    }
}
