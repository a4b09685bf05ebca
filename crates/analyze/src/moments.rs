//! Sums over a region's pixels, and the flat or gradient fill that fits them best.
//!
//! The sums of two disjoint regions add up to those of their union, so a union is cheap to evaluate.

use super::grid::{Cells, SubpixelGrid};
use image::RgbImage;
use vtex_base::geometry::STEP;
use vtex_base::raster::Mask;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::Gradient;

/// Least difference between a gradient's start and end (8-bit steps, summed over components).
const LEAST_CHANGE: f64 = 6.0;

/// Sums over pixels: count, positions, colours, and their products. Positions are relative to a
/// nearby origin, which limits rounding errors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PixelMoments {
    count: f64,
    place: [f64; 2],
    /// Sums of xx, xy, yy.
    places: [f64; 3],
    colour: [f64; 3],
    /// Sums of colour · x and of colour · y.
    mixed: [[f64; 3]; 2],
    /// Sum of squared colours, over all components.
    colours: f64,
}

/// The linear change of colour that explains most of a region's variance.
struct Trend {
    /// Direction: a unit vector.
    along: [f64; 2],
    /// Change of each component per pixel along it.
    slope: [f64; 3],
    /// Reduction of the squared error against a flat fill.
    explained: f64,
}

impl PixelMoments {
    /// Sums over those pixels of a mask that lie inside the image.
    pub(super) fn new(image: &Cells<RgbImage>, mask: &Cells<Mask>, origin: [f64; 2]) -> Self {
        let mut sums = Self::default();
        let (width, height) = (image.width() as i32, image.height() as i32);
        for (x, y) in mask.pixels().filter(|&(x, y)| x >= 0 && y >= 0 && x < width && y < height) {
            let place = [f64::from(x) + 0.5 - origin[0], f64::from(y) + 0.5 - origin[1]];
            sums.add(place, image.get_pixel(x as u32, y as u32).0.map(f64::from));
        }
        sums
    }

    /// Number of pixels.
    pub(super) fn count(&self) -> f64 {
        self.count
    }

    fn add(&mut self, [x, y]: [f64; 2], colour: [f64; 3]) {
        self.count += 1.0;
        self.place = [self.place[0] + x, self.place[1] + y];
        self.places = [self.places[0] + x * x, self.places[1] + x * y, self.places[2] + y * y];
        for c in 0..3 {
            self.colour[c] += colour[c];
            self.mixed[0][c] += colour[c] * x;
            self.mixed[1][c] += colour[c] * y;
            self.colours += colour[c] * colour[c];
        }
    }

    /// Sums of the union of two disjoint regions with the same origin.
    pub(super) fn with(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            place: std::array::from_fn(|i| self.place[i] + other.place[i]),
            places: std::array::from_fn(|i| self.places[i] + other.places[i]),
            colour: std::array::from_fn(|i| self.colour[i] + other.colour[i]),
            mixed: std::array::from_fn(|k| std::array::from_fn(|i| self.mixed[k][i] + other.mixed[k][i])),
            colours: self.colours + other.colours,
        }
    }

    /// Squared error of the mean colour, summed over components.
    pub(super) fn flat_error(&self) -> f64 {
        let squares: f64 = self.colour.iter().map(|c| c * c).sum();
        (self.colours - squares / self.count.max(1.0)).max(0.0)
    }

    /// Squared error of the best linear gradient, summed over components.
    pub(super) fn gradient_error(&self) -> f64 {
        let explained = self.trend().map_or(0.0, |t| t.explained);
        (self.flat_error() - explained).max(0.0)
    }

    /// The direction in which a linear change explains most: the eigenvector of the larger eigenvalue
    /// of S⁻¹ CᵀC, where S is the covariance of positions and C that of colours and positions.
    fn trend(&self) -> Option<Trend> {
        let n = self.count;
        if n < 3.0 {
            return None;
        }
        let [mx, my] = self.place.map(|v| v / n);
        let sxx = self.places[0] - n * mx * mx;
        let sxy = self.places[1] - n * mx * my;
        let syy = self.places[2] - n * my * my;
        let determinant = sxx * syy - sxy * sxy;
        if determinant <= 1e-6 * (sxx + syy) * (sxx + syy) {
            return None;
        }
        let cov = [0, 1].map(|k| [0, 1, 2].map(|c| self.mixed[k][c] - self.colour[c] * [mx, my][k]));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (a, b, d) = (dot(cov[0], cov[0]), dot(cov[0], cov[1]), dot(cov[1], cov[1]));
        let m = [
            [(syy * a - sxy * b) / determinant, (syy * b - sxy * d) / determinant],
            [(sxx * b - sxy * a) / determinant, (sxx * d - sxy * b) / determinant],
        ];
        let half = (m[0][0] + m[1][1]) / 2.0;
        let rest = half * half - (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
        let explained = half + libm::sqrt(rest.max(0.0));
        // The longer row of (m − explained · I) is perpendicular to the eigenvector.
        let rows = [[m[0][0] - explained, m[0][1]], [m[1][0], m[1][1] - explained]];
        let length = |r: [f64; 2]| libm::sqrt(r[0] * r[0] + r[1] * r[1]);
        let row = if length(rows[0]) >= length(rows[1]) { rows[0] } else { rows[1] };
        let along =
            if length(row) > 1e-12 { [-row[1] / length(row), row[0] / length(row)] } else { [1.0, 0.0] };
        let spread = sxx * along[0] * along[0] + 2.0 * sxy * along[0] * along[1] + syy * along[1] * along[1];
        let slope = [0, 1, 2].map(|c| (cov[0][c] * along[0] + cov[1][c] * along[1]) / spread);
        Some(Trend { along, slope, explained })
    }

    /// The best linear gradient over `mask`, whose sums about `origin` these are. `None` if its colours
    /// hardly change.
    pub(super) fn gradient(
        &self,
        mask: &Cells<Mask>,
        origin: [f64; 2],
        cells: SubpixelGrid,
    ) -> Option<Gradient> {
        let Trend { along, slope, .. } = self.trend()?;
        let mean = self.place.map(|v| v / self.count);
        let reach = |x: i32, y: i32| {
            let [x, y] = [f64::from(x) + 0.5 - origin[0] - mean[0], f64::from(y) + 0.5 - origin[1] - mean[1]];
            x * along[0] + y * along[1]
        };
        let ends = mask.spans().iter().flat_map(|s| [reach(s.x0, s.y), reach(s.x1 - 1, s.y)]);
        let (least, most) = ends.fold((f64::MAX, f64::MIN), |(a, b), t| (a.min(t), b.max(t)));
        let grid = |v: f64| libm::round(v / cells.along() / STEP) * STEP;
        let place = |t: f64| [0, 1].map(|k| grid(origin[k] + mean[k] + t * along[k]));
        let colour = |t: f64| Colour::from_f64([0, 1, 2].map(|c| self.colour[c] / self.count + t * slope[c]));
        let gradient = Gradient::linear(place(least), place(most), [colour(least), colour(most)]);
        let (a, b) = (gradient.start.to_f64(), gradient.end.to_f64());
        let change: f64 = (0..3).map(|c| (a[c] - b[c]).abs()).sum();
        (change >= LEAST_CHANGE && gradient.fault().is_none()).then_some(gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::raster::Span;

    fn rows(spans: Vec<Span>) -> Cells<Mask> {
        Cells(Mask::from_spans(spans))
    }

    fn square(side: i32) -> Cells<Mask> {
        rows((0..side).map(|y| Span { y, x0: 0, x1: side }).collect())
    }

    #[test]
    fn a_slope_is_found_whatever_its_direction() {
        for turn in 0..8 {
            let angle = f64::from(turn) * 0.77;
            let (u, v) = (libm::cos(angle), libm::sin(angle));
            let at = |x: f64, y: f64| {
                let t = (x - 20.0) * u + (y - 20.0) * v;
                [120.0 + 2.0 * t, 90.0 - 1.5 * t, 100.0]
            };
            let image = Cells(RgbImage::from_fn(40, 40, |x, y| {
                Rgb(at(f64::from(x) + 0.5, f64::from(y) + 0.5).map(|v| libm::round(v) as u8))
            }));
            let (mask, origin) = (square(40), [20.0, 20.0]);
            let sums = PixelMoments::new(&image, &mask, origin);
            assert!(sums.gradient_error() < 0.001 * sums.flat_error());
            let g = sums.gradient(&mask, origin, SubpixelGrid { cells: 1 }).unwrap();
            for (place, colour) in [(g.from, g.start), (g.to, g.end)] {
                let wanted = at(place[0], place[1]);
                assert!((0..3).all(|c| (wanted[c] - colour.to_f64()[c]).abs() < 1.5), "{turn}: {g:?}");
            }
        }
    }

    #[test]
    fn sums_of_parts_are_those_of_the_whole() {
        let image = Cells(RgbImage::from_fn(12, 12, |x, y| Rgb([(x * 20) as u8, (y * 13 + x) as u8, 77])));
        let part = |a, b| rows((a..b).map(|y| Span { y, x0: 0, x1: 12 }).collect());
        let origin = [6.0, 6.0];
        let both = PixelMoments::new(&image, &part(0, 5), origin).with(&PixelMoments::new(
            &image,
            &part(5, 12),
            origin,
        ));
        let whole = PixelMoments::new(&image, &square(12), origin);
        assert!((both.gradient_error() - whole.gradient_error()).abs() < 1e-6);
        assert!((both.flat_error() - whole.flat_error()).abs() < 1e-6);
    }

    #[test]
    fn what_is_flat_or_a_line_has_no_gradient() {
        let image = Cells(RgbImage::from_pixel(9, 9, Rgb([40, 50, 60])));
        assert!(
            PixelMoments::new(&image, &square(9), [4.0; 2])
                .gradient(&square(9), [4.0; 2], SubpixelGrid { cells: 1 })
                .is_none()
        );
        let line = rows(vec![Span { y: 3, x0: 0, x1: 9 }]);
        let sums = PixelMoments::new(&image, &line, [4.0; 2]);
        assert!(
            sums.gradient(&line, [4.0; 2], SubpixelGrid { cells: 1 }).is_none()
                && sums.gradient_error() < 1e-6
        );
        let empty = PixelMoments::new(&image, &rows(Vec::new()), [0.0; 2]);
        assert_eq!((empty.flat_error(), empty.gradient_error()), (0.0, 0.0));
    }
}
