//! Soft ellipses: what is left of an element's shading once its pieces have their fills.
//!
//! Matching pursuit: the place, size and colour of a soft ellipse that takes most from the squared error are
//! found by convolutions on a pyramid, its form by the moments of the error there. Ellipses that do not touch
//! are taken in one round. Rounds end where no ellipse is worth its bytes.

use super::grid::{Cells, SubpixelGrid};
use super::joining;
use super::palette::Palette;
use super::partition::Partition;
use super::rate_distortion::RateDistortion;
use image::RgbImage;
use vtex_base::geometry::Point;
use vtex_base::parallel;
use vtex_base::raster::Mask;
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Ellipse;

/// Bytes of a soft ellipse as [`RateDistortion`] counts them. It takes 70, but packed a third of what so much of an
/// outline takes.
const ELLIPSE_BYTES: f64 = 27.0;
/// How much dearer a byte is where elements are shaded softly: the same error takes so much fewer bytes there.
pub(super) const DEARER: f64 = 8.0;
/// Cost of the bytes of pieces below ellipses, relative to that of other bytes: what has an edge stays a piece.
const PIECES: f64 = 0.5;
/// Largest difference of a component from what an ellipse is painted on, in steps of 8 bits. What differs by more is
/// a marking, whose edge is seen.
const CONTRAST: f64 = 60.0;
/// Colours of all ellipses of a photograph.
const COLOURS: usize = 64;
/// Smallest semi-axis, in pixels.
const LEAST_RADIUS: f64 = 1.4;
/// Largest ratio of a semi-axis to the radius at which an ellipse was found.
const STRETCH: f64 = 2.5;
/// Radius of the circle whose errors give an ellipse its form, relative to that at which it was found.
const WIDE: f64 = 1.5;
/// Most rounds.
const ROUNDS: usize = 24;
/// Radii sought on each level of the pyramid, in pixels of the level.
const RADII: [f64; 2] = [2.0, 2.828_427];

/// A soft ellipse of an element, in pixels of the photograph.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shade {
    pub(super) ellipse: Ellipse,
    pub(super) colour: Colour,
}

/// An element's pieces and what shades them.
pub(super) struct Shaded {
    pub(super) details: Vec<Cells<Mask>>,
    pub(super) shades: Vec<Shade>,
    /// Squared error and bytes, at the price of a byte.
    cost: f64,
}

impl Shaded {
    /// The pieces of an element with the soft ellipses that are worth their bytes.
    fn new(
        image: &Cells<RgbImage>,
        details: Vec<Cells<Mask>>,
        cost: RateDistortion,
        grid: SubpixelGrid,
    ) -> Self {
        let mut window = ElementWindow::new(image, &details, cost, grid);
        // Errors of the window are sums over pixels, those of the cost over cells.
        let price = cost.error_per_byte / grid.area();
        let shades = window.shade(price * ELLIPSE_BYTES);
        let bytes = joining::bytes(image, &details, cost) + ELLIPSE_BYTES * shades.len() as f64;
        Self { cost: window.error() + price * bytes, details, shades }
    }
}

/// Pieces and soft ellipses of each element: as few pieces as their edges need, or one, whichever is cheaper.
pub(super) fn shaded(
    partition: &Partition<'_>,
    details: &[Vec<Cells<Mask>>],
    cost: RateDistortion,
) -> Vec<Shaded> {
    let (image, grid) = (&partition.clean, partition.grid);
    let mut all = parallel::map(details, |masks| {
        let pieces = joining::join(image, masks, cost.dearer(PIECES));
        let whole = Cells(Mask::from_spans(masks.iter().flat_map(|m| m.spans()).copied().collect()));
        let one = Shaded::new(image, vec![whole], cost, grid);
        if pieces.len() == 1 {
            return one;
        }
        let many = Shaded::new(image, pieces, cost, grid);
        if many.cost < one.cost { many } else { one }
    });
    let colours: Vec<(Colour, u32)> = all.iter().flat_map(|s| &s.shades).map(|s| (s.colour, 1)).collect();
    let palette = Palette::new(&colours, COLOURS, partition.params.seed);
    for shade in all.iter_mut().flat_map(|s| &mut s.shades) {
        shade.colour = palette.nearest(shade.colour);
    }
    all
}

/// The pixels around an element.
struct ElementWindow {
    width: usize,
    height: usize,
    /// Place of its corner in the photograph.
    corner: [f64; 2],
    /// Share of each pixel that the element covers.
    weight: Vec<f32>,
    /// The photograph's colour, the mean over what is covered.
    target: Vec<[f32; 3]>,
    /// The colour painted so far.
    painted: Vec<[f32; 3]>,
}

/// What an ellipse in its best colour does.
struct Fit {
    /// By how much it reduces the squared error.
    gain: f64,
    colour: [f64; 3],
    /// Largest difference of a component from what lies below it, in the mean.
    contrast: f64,
}

/// A place where an ellipse may stand.
struct Candidate {
    gain: f64,
    centre: [f64; 2],
    radius: f64,
}

impl ElementWindow {
    fn new(
        image: &Cells<RgbImage>,
        details: &[Cells<Mask>],
        cost: RateDistortion,
        grid: SubpixelGrid,
    ) -> Self {
        let k = grid.cells as i32;
        let bounds = details.iter().filter_map(|m| m.bounds());
        let bounds = bounds.reduce(|a, b| (a.0.min(b.0), a.1.min(b.1), a.2.max(b.2), a.3.max(b.3)));
        let (x0, y0, x1, y1) = bounds.unwrap_or_default();
        let (x0, y0) = (x0.div_euclid(k), y0.div_euclid(k));
        let (width, height) = ((x1.div_euclid(k) - x0 + 1) as usize, (y1.div_euclid(k) - y0 + 1) as usize);
        let mut sums = vec![([0f32; 3], [0f32; 3], 0u32); width * height];
        let inside =
            |&(x, y): &(i32, i32)| x >= 0 && y >= 0 && x < image.width() as i32 && y < image.height() as i32;
        for mask in details {
            let gradient = joining::gradient(image, mask, cost, grid);
            let flat = super::shapes::median(image, mask).0.map(f32::from);
            for (x, y) in mask.pixels().filter(inside) {
                let fill = gradient.as_ref().map_or(flat, |g| {
                    let at = [x, y].map(|v| (f64::from(v) + 0.5) / grid.along());
                    let way = [g.to[0] - g.from[0], g.to[1] - g.from[1]];
                    let along = (at[0] - g.from[0]) * way[0] + (at[1] - g.from[1]) * way[1];
                    let t = (along / (way[0] * way[0] + way[1] * way[1])).clamp(0.0, 1.0);
                    let (a, b) = (g.start.to_f64(), g.end.to_f64());
                    std::array::from_fn(|c| (a[c] + t * (b[c] - a[c])) as f32)
                });
                let own = image.get_pixel(x as u32, y as u32).0;
                let index = (y.div_euclid(k) - y0) as usize * width + (x.div_euclid(k) - x0) as usize;
                let (target, painted, count) = &mut sums[index];
                for c in 0..3 {
                    target[c] += f32::from(own[c]);
                    painted[c] += fill[c];
                }
                *count += 1;
            }
        }
        let mean = |sum: [f32; 3], count: u32| sum.map(|v| v / count.max(1) as f32);
        Self {
            width,
            height,
            corner: [x0, y0].map(f64::from),
            weight: sums.iter().map(|s| s.2 as f32 / (k * k) as f32).collect(),
            target: sums.iter().map(|s| mean(s.0, s.2)).collect(),
            painted: sums.iter().map(|s| mean(s.1, s.2)).collect(),
        }
    }

    /// Squared error over all pixels and components.
    fn error(&self) -> f64 {
        let all = self.weight.iter().zip(&self.target).zip(&self.painted);
        all.map(|((w, t), p)| f64::from(w * (0..3).map(|c| (t[c] - p[c]) * (t[c] - p[c])).sum::<f32>())).sum()
    }

    /// Paints ellipses that each reduce the error by `least` or more.
    fn shade(&mut self, least: f64) -> Vec<Shade> {
        let pyramid = Level::pyramid(self);
        let mut shades = Vec::new();
        for _ in 0..ROUNDS {
            let mut candidates = self.candidates(&pyramid, least);
            candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            let mut taken: Vec<Candidate> = Vec::new();
            let before = shades.len();
            for candidate in candidates {
                let touches = |other: &Candidate| {
                    let [dx, dy] = [0, 1].map(|k| other.centre[k] - candidate.centre[k]);
                    let apart = 0.7 * (other.radius + candidate.radius);
                    dx * dx + dy * dy < apart * apart
                };
                if taken.iter().any(touches) {
                    continue;
                }
                shades.extend(self.paint(&candidate, least));
                taken.push(candidate);
            }
            // Few are left to gain from a further round.
            if shades.len() - before <= before / 50 {
                break;
            }
        }
        shades
    }

    /// Where circles reduce the error most, of each size.
    fn candidates(&self, pyramid: &[Level], least: f64) -> Vec<Candidate> {
        let mut errors: [Vec<f32>; 3] = std::array::from_fn(|c| {
            let all = self.weight.iter().zip(&self.target).zip(&self.painted);
            all.map(|((w, t), p)| w * (t[c] - p[c])).collect()
        });
        let mut found = Vec::new();
        for (i, level) in pyramid.iter().enumerate() {
            if i > 0 {
                let finer = &pyramid[i - 1];
                errors = errors.map(|plane| halved(&plane, finer.width, finer.height));
            }
            level.peaks(&errors, least, &mut found);
        }
        found
    }

    /// Paints an ellipse near a candidate if it reduces the error by `least`.
    fn paint(&mut self, candidate: &Candidate, least: f64) -> Option<Shade> {
        let circle = circle(candidate.centre, candidate.radius)?;
        let mut best = (self.fit(&circle)?, circle);
        if let Some(fitted) = self.fitted(&circle, candidate.radius, best.0.colour)
            && let Some(found) = self.fit(&fitted)
            && found.gain > best.0.gain
        {
            best = (found, fitted);
        }
        let (Fit { gain, colour, contrast }, ellipse) = best;
        if gain < least || contrast > CONTRAST {
            return None;
        }
        let colour = Colour::from_f64(colour);
        let own = colour.to_f64().map(|v| v as f32);
        for (i, opacity) in self.covered(&ellipse).collect::<Vec<_>>() {
            let painted = &mut self.painted[i];
            (0..3).for_each(|c| painted[c] += opacity * (own[c] - painted[c]));
        }
        let centre = [0, 1].map(|k| ellipse.centre[k] + self.corner[k]);
        Some(Shade { ellipse: Ellipse { centre, ..ellipse }, colour })
    }

    /// The colour in which an ellipse reduces the error most.
    fn fit(&self, ellipse: &Ellipse) -> Option<Fit> {
        let (mut wanted, mut squares, mut before, mut black) = ([0f32; 3], 0f32, 0f32, 0f32);
        let (mut below, mut opacities) = ([0.0; 3], 1e-9);
        for (i, opacity) in self.covered(ellipse) {
            let (w, t, p) = (self.weight[i], self.target[i], self.painted[i]);
            squares += w * opacity * opacity;
            let share = f64::from(opacity * w);
            opacities += share;
            for c in 0..3 {
                // What is left if the ellipse were black.
                let rest = t[c] - p[c] + opacity * p[c];
                wanted[c] += w * opacity * rest;
                before += w * (t[c] - p[c]) * (t[c] - p[c]);
                black += w * rest * rest;
                below[c] += share * f64::from(p[c]);
            }
        }
        if squares < 0.5 {
            return None;
        }
        let colour = wanted.map(|v| (v / squares).clamp(0.0, 255.0));
        let after: f32 = black
            + (0..3).map(|c| squares * colour[c] * colour[c] - 2.0 * colour[c] * wanted[c]).sum::<f32>();
        let colour = colour.map(f64::from);
        let contrast = (0..3).map(|c| (colour[c] - below[c] / opacities).abs()).fold(0.0, f64::max);
        Some(Fit { gain: f64::from(before - after), colour, contrast })
    }

    /// The ellipse that has the moments of the error towards `colour` around a circle.
    fn fitted(&self, around: &Ellipse, radius: f64, colour: [f64; 3]) -> Option<Ellipse> {
        let centre = around.centre;
        let wide = circle(centre, WIDE * radius)?;
        let aim = colour.map(|v| v as f32);
        let (mut sum, mut first, mut second) = (0f64, [0f64; 2], [0f64; 3]);
        for (i, opacity) in self.covered(&wide) {
            let (t, p) = (self.target[i], self.painted[i]);
            let (mut along, mut length) = (0f32, 1e-3f32);
            for c in 0..3 {
                let d = aim[c] - p[c];
                along += (t[c] - p[c]) * d;
                length += d * d;
            }
            let share = f64::from((along / length).clamp(0.0, 1.0) * self.weight[i] * opacity);
            let x = (i % self.width) as f64 + 0.5 - centre[0];
            let y = (i / self.width) as f64 + 0.5 - centre[1];
            sum += share;
            first = [first[0] + share * x, first[1] + share * y];
            second = [second[0] + share * x * x, second[1] + share * x * y, second[2] + share * y * y];
        }
        if sum < 0.1 {
            return None;
        }
        let mean = first.map(|v| v / sum);
        let own = [
            second[0] / sum - mean[0] * mean[0],
            second[1] / sum - mean[0] * mean[1],
            second[2] / sum - mean[1] * mean[1],
        ];
        // The window is a Gaussian itself: precisions of the two add up.
        let of_window = WIDE * WIDE * radius * radius / 8.0;
        let (half, rest) = ((own[0] + own[2]) / 2.0, libm::hypot((own[0] - own[2]) / 2.0, own[1]));
        let angle = 0.5 * libm::atan2(2.0 * own[1], own[0] - own[2]);
        let axis = |variance: f64| {
            let precision = 1.0 / variance.max(1e-3) - 1.0 / of_window;
            let free = if precision > 0.0 { 1.0 / precision } else { f64::INFINITY };
            libm::sqrt(8.0 * free).clamp((radius / STRETCH).max(LEAST_RADIUS), radius * STRETCH)
        };
        let (long, short) = (axis(half + rest), axis(half - rest));
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let (a, b) = (long * long, short * short);
        let square = [
            a * cosine * cosine + b * sine * sine,
            (a - b) * sine * cosine,
            a * sine * sine + b * cosine * cosine,
        ];
        Ellipse::of_square([centre[0] + mean[0], centre[1] + mean[1]], square)
    }

    /// The pixels of the element that an ellipse covers, and its opacity there.
    fn covered(&self, ellipse: &Ellipse) -> impl Iterator<Item = (usize, f32)> + '_ {
        let inverse = ellipse.map().inverse();
        let [xx, xy, yy] = ellipse.matrix;
        let (centre, reach) = (ellipse.centre, [libm::hypot(xx, xy), libm::hypot(xy, yy)]);
        let range = |k: usize, side: usize| {
            let [low, high] = [-1.0, 1.0].map(|s| centre[k] + s * reach[k]);
            (low.max(0.0) as usize)..(libm::ceil(high.clamp(0.0, side as f64)) as usize)
        };
        let (columns, rows) = (range(0, self.width), range(1, self.height));
        let pixels = rows.flat_map(move |y| columns.clone().map(move |x| (x, y)));
        pixels.filter_map(move |(x, y)| {
            let i = y * self.width + x;
            if self.weight[i] <= 0.0 {
                return None;
            }
            let p = inverse * Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let square = p.x * p.x + p.y * p.y;
            (square < 1.0).then(|| (i, Ellipse::opacity_at(square) as f32))
        })
    }
}

/// A circle as an ellipse.
fn circle(centre: [f64; 2], radius: f64) -> Option<Ellipse> {
    Ellipse::of_square(centre, [radius * radius, 0.0, radius * radius])
}

/// What does not change from round to round, at a fraction of a window's resolution.
struct Level {
    /// Pixels of the window to a pixel, along one axis.
    scale: f64,
    width: usize,
    height: usize,
    /// Sum of the weights under the squared opacity of a circle around each pixel, by radius.
    weights: [Vec<f32>; 2],
}

impl Level {
    /// All levels of a window, each at half the resolution of the one before.
    fn pyramid(window: &ElementWindow) -> Vec<Self> {
        let (mut width, mut height, mut plane) = (window.width, window.height, window.weight.clone());
        let mut levels: Vec<Self> = Vec::new();
        loop {
            let scale = levels.last().map_or(1.0, |level| 2.0 * level.scale);
            let weights = RADII.map(|radius| blurred(&plane, width, &kernel(radius, 8.0)));
            levels.push(Self { scale, width, height, weights });
            if width.min(height) < 4 {
                return levels;
            }
            plane = halved(&plane, width, height);
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
    }

    /// Adds the peaks of the reduction of the error by circles. `errors` are weighted, by component.
    fn peaks(&self, errors: &[Vec<f32>; 3], least: f64, found: &mut Vec<Candidate>) {
        let (width, height) = (self.width, self.height);
        for (radius, weights) in RADII.into_iter().zip(&self.weights) {
            let kernel = kernel(radius, 4.0);
            let errors = errors.each_ref().map(|plane| blurred(plane, width, &kernel));
            let gains: Vec<f32> = (0..width * height)
                .map(|i| {
                    let squares: f32 = (0..3).map(|c| errors[c][i] * errors[c][i]).sum();
                    squares / weights[i].max(0.5)
                })
                .collect();
            for (i, &gain) in gains.iter().enumerate().filter(|(_, gain)| f64::from(**gain) >= least) {
                let (x, y) = (i % width, i / width);
                let mut around = (y.saturating_sub(1)..(y + 2).min(height))
                    .flat_map(|v| (x.saturating_sub(1)..(x + 2).min(width)).map(move |u| v * width + u));
                // Of equals the first is the peak.
                let is_peak = around.all(|k| k == i || gains[k] < gain || (gains[k] == gain && k > i));
                if is_peak {
                    let centre = [x, y].map(|v| (v as f64 + 0.5) * self.scale);
                    found.push(Candidate { gain: gain.into(), centre, radius: radius * self.scale });
                }
            }
        }
    }
}

/// The opacity of a circle along one axis, or a power of it by `fall`.
fn kernel(radius: f64, fall: f64) -> Vec<f32> {
    let reach = libm::ceil(radius) as i32 - 1;
    let value = |i: i32| libm::exp(-fall * f64::from(i * i) / (radius * radius)) as f32;
    (-reach..=reach).map(value).collect()
}

/// A plane at half the resolution, of sums.
fn halved(plane: &[f32], width: usize, height: usize) -> Vec<f32> {
    let half = width.div_ceil(2);
    let mut out = vec![0.0; half * height.div_ceil(2)];
    for (i, value) in plane.iter().enumerate() {
        out[i / width / 2 * half + i % width / 2] += value;
    }
    out
}

/// A plane convolved along both axes with an odd, symmetric kernel; nothing lies beyond its borders.
fn blurred(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() / 2;
    let mut rows = vec![0.0; plane.len()];
    for (from, to) in plane.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        for (k, factor) in kernel.iter().enumerate() {
            let (skip, shift) = (reach.saturating_sub(k), k.saturating_sub(reach));
            if skip < width && shift < width {
                let (to, from) = (&mut to[skip..], &from[shift..]);
                to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
            }
        }
    }
    let mut out = vec![0.0; plane.len()];
    for (k, factor) in kernel.iter().enumerate() {
        let (skip, shift) = (reach.saturating_sub(k) * width, k.saturating_sub(reach) * width);
        if skip < out.len() && shift < out.len() {
            let (to, from) = (&mut out[skip..], &rows[shift..]);
            to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use vtex_base::raster::LabelMap;
    use vtex_scene::library::{AnalyzeParams, Shading};

    /// A disc of radius 30 in a picture of 80 × 80, in colours of its own.
    fn disc(colour: impl Fn(f64, f64) -> [f64; 3]) -> (Cells<RgbImage>, Cells<Mask>) {
        let image = RgbImage::from_fn(80, 80, |x, y| {
            Rgb(colour(f64::from(x) + 0.5, f64::from(y) + 0.5).map(|v| libm::round(v) as u8))
        });
        let mut map = LabelMap::filled(80, 80, 0);
        for (i, label) in map.labels.iter_mut().enumerate() {
            let [x, y] = [i % 80, i / 80].map(|v| v as f64 - 39.5);
            *label = u32::from(x * x + y * y < 900.0);
        }
        let mask = Mask::all_of_labels(&map, 2).pop().unwrap_or_default();
        (Cells(image), Cells(mask))
    }

    fn shaded_disc(colour: impl Fn(f64, f64) -> [f64; 3]) -> (f64, ElementWindow, Vec<Shade>) {
        let (image, mask) = disc(colour);
        let grid = SubpixelGrid { cells: 1 };
        let params = AnalyzeParams { shading: Shading::Soft, ..AnalyzeParams::default() };
        let cost = RateDistortion::new(&params, grid).dearer(DEARER);
        let mut window = ElementWindow::new(&image, &[mask], cost, grid);
        let before = window.error();
        let shades = window.shade(cost.error_per_byte * ELLIPSE_BYTES);
        (before, window, shades)
    }

    #[test]
    fn a_soft_spot_is_one_ellipse_where_it_is() {
        // Longer along the falling diagonal.
        let opacity = |x: f64, y: f64| {
            let (u, v) = ((x - 44.0 + y - 36.0) / 2f64.sqrt(), (x - 44.0 - y + 36.0) / 2f64.sqrt());
            0.8 * libm::exp(-4.0 * (u * u / 225.0 + v * v / 64.0))
        };
        let (before, window, shades) =
            shaded_disc(|x, y| [150.0, 120.0, 100.0].map(|v| v + opacity(x, y) * 50.0));
        assert!(window.error() < 0.02 * before, "{} of {before}", window.error());
        assert!(shades.len() <= 4, "{}", shades.len());
        let Ellipse { centre, matrix } = shades[0].ellipse;
        assert!((centre[0] - 44.0).abs() < 1.0 && (centre[1] - 36.0).abs() < 1.0, "{centre:?}");
        assert!(matrix[1] > 2.0 && (matrix[0] - matrix[2]).abs() < 1.0, "{matrix:?}");
    }

    #[test]
    fn an_even_element_has_no_ellipses() {
        let (before, _, shades) = shaded_disc(|_, _| [90.0, 120.0, 60.0]);
        assert_eq!((before, shades.len()), (0.0, 0));
    }

    #[test]
    fn a_marking_with_an_edge_is_cheaper_as_a_piece() {
        let is_marked = |x: f64, y: f64| libm::hypot(x - 42.0, y - 38.0) < 12.0;
        let (image, mask) = disc(|x, y| if is_marked(x, y) { [220.0; 3] } else { [40.0; 3] });
        let (marked, rest): (Vec<_>, Vec<_>) =
            mask.pixels().partition(|&(x, y)| is_marked(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let pieces = [rest, marked].map(|pixels| {
            let mut map = LabelMap::filled(80, 80, 0);
            pixels.iter().for_each(|&(x, y)| map.labels[(y * 80 + x) as usize] = 1);
            Cells(Mask::all_of_labels(&map, 2).pop().unwrap_or_default())
        });
        let grid = SubpixelGrid { cells: 1 };
        let cost = RateDistortion::new(&AnalyzeParams::default(), grid).dearer(DEARER);
        let one = Shaded::new(&image, vec![mask], cost, grid);
        let two = Shaded::new(&image, pieces.to_vec(), cost, grid);
        assert!(two.cost < one.cost && two.shades.is_empty(), "{} {}", two.cost, one.cost);
        let low = |s: &Shade| s.colour.0.iter().all(|v| *v <= 100);
        assert!(one.shades.iter().all(low), "{:?}", one.shades);
    }

    #[test]
    fn convolution_of_a_point_is_the_kernel() {
        let mut plane = vec![0.0; 15];
        plane[7] = 1.0;
        let kernel = [0.25, 0.5, 0.25];
        let out = blurred(&plane, 5, &kernel);
        let wanted: Vec<f32> =
            (0..3).flat_map(|y| [0.0, 0.25, 0.5, 0.25, 0.0].map(|v| v * kernel[y])).collect();
        assert_eq!(out, wanted);
        // Kernels longer than a plane.
        assert_eq!(blurred(&[1.0], 1, &[0.125, 0.25, 0.5, 0.25, 0.125]), [0.25]);
    }
}
