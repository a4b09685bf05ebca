//! Shading of elements: pieces where edges are worth their bytes, soft ellipses for what is left of each.

use super::grid::{Cells, SubpixelGrid};
use super::joining;
use super::partition::Partition;
use super::pursuit::{PaintedWindow, ROUNDS, Rules, Shade};
use super::rate_distortion::RateDistortion;
use image::RgbImage;
use std::sync::Arc;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::Progress;
use vtex_base::raster::Mask;

/// Bytes of a soft ellipse as [`RateDistortion`] counts them. It takes 70, but packed a third of what so much of an
/// outline takes.
pub(super) const ELLIPSE_BYTES: f64 = 27.0;
/// How much dearer a byte is where elements are shaded softly: the same error takes so much fewer bytes there.
pub(super) const DEARER: f64 = 8.0;
/// Cost of the bytes of pieces below ellipses, relative to that of other bytes: what has an edge stays a piece.
const PIECES: f64 = 0.5;

/// What has an edge stays a piece: it differs by more from what lies below.
const RULES: Rules = Rules {
    contrast: 60.0,
    harm: f64::INFINITY,
    seen: 0.0,
    radius: f64::INFINITY,
    areas: [0.0, f64::INFINITY],
};

/// An element's pieces and what shades them.
#[derive(Clone)]
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
        progress: &dyn Progress,
    ) -> Result<Self> {
        let mut window = window(image, &details, cost, grid);
        // Errors of the window are sums over pixels, those of the cost over cells.
        let price = cost.error_per_byte / grid.area();
        let shades = window.paint(price * ELLIPSE_BYTES, ROUNDS, RULES, progress)?;
        let bytes = joining::bytes(image, &details, cost) + ELLIPSE_BYTES * shades.len() as f64;
        Ok(Self { cost: window.error() + price * bytes, details, shades })
    }
}

/// What an element was divided into.
pub(super) struct ElementParts {
    pub(super) details: Vec<Cells<Mask>>,
    /// Its pieces with what shades them, if elements are shaded softly.
    pub(super) shaded: Option<Shaded>,
}

/// For each primary its parts, if they are known from the last analysis.
pub(super) type KnownParts = [Option<Arc<ElementParts>>];

/// Pieces and soft ellipses of each element: as few pieces as their edges need, or one, whichever is cheaper. Those
/// that are known are taken over.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub(super) fn shaded(
    partition: &Partition<'_>,
    details: &[Vec<Cells<Mask>>],
    known: &KnownParts,
    cost: RateDistortion,
    progress: &dyn Progress,
) -> Result<Vec<Shaded>> {
    let (image, grid) = (&partition.clean, partition.grid);
    let all: Vec<_> = details.iter().zip(known).collect();
    let all = parallel::map(&all, |(masks, known)| {
        if let Some(shaded) = known.as_ref().and_then(|known| known.shaded.as_ref()) {
            return Ok(shaded.clone());
        }
        let pieces = joining::join(image, masks, cost.dearer(PIECES));
        let whole = Cells(Mask::from_spans(masks.iter().flat_map(|m| m.spans()).copied().collect()));
        let one = Shaded::new(image, vec![whole], cost, grid, progress)?;
        if pieces.len() == 1 {
            return Ok(one);
        }
        let many = Shaded::new(image, pieces, cost, grid, progress)?;
        Ok(if many.cost < one.cost { many } else { one })
    });
    all.into_iter().collect()
}

/// The pixels around an element, painted with its pieces.
pub(super) fn window(
    image: &Cells<RgbImage>,
    details: &[Cells<Mask>],
    cost: RateDistortion,
    grid: SubpixelGrid,
) -> PaintedWindow {
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
        let flat = super::patches::median(image, mask).0.map(f32::from);
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
    PaintedWindow {
        width,
        height,
        corner: [x0, y0].map(f64::from),
        weight: sums.iter().map(|s| s.2 as f32 / (k * k) as f32).collect(),
        target: sums.iter().map(|s| mean(s.0, s.2)).collect(),
        painted: sums.iter().map(|s| mean(s.1, s.2)).collect(),
        layers: Vec::new(),
    }
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

    fn shaded_disc(colour: impl Fn(f64, f64) -> [f64; 3]) -> (f64, PaintedWindow, Vec<Shade>) {
        let (image, mask) = disc(colour);
        let grid = SubpixelGrid { cells: 1 };
        let params = AnalyzeParams { shading: Shading::Soft, ..AnalyzeParams::default() };
        let cost = RateDistortion::new(&params, grid).dearer(DEARER);
        let mut window = window(&image, &[mask], cost, grid);
        let before = window.error();
        let shades = window.paint(cost.error_per_byte * ELLIPSE_BYTES, ROUNDS, RULES, &()).unwrap();
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
        let vtex_scene::element::Ellipse { centre, matrix, .. } = shades[0].ellipse;
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
        let one = Shaded::new(&image, vec![mask], cost, grid, &()).unwrap();
        let two = Shaded::new(&image, pieces.to_vec(), cost, grid, &()).unwrap();
        assert!(two.cost < one.cost && two.shades.is_empty(), "{} {}", two.cost, one.cost);
        let low = |s: &Shade| s.colour.0.iter().all(|v| *v <= 100);
        assert!(one.shades.iter().all(low), "{:?}", one.shades);
    }
}
