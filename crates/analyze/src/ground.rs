//! The ground between primaries: patches whose edges are worth their bytes, and spots, soft ellipses that are
//! secondaries of their own.
//!
//! A secondary of a few pixels has no outline that anybody sees, and an ellipse takes a quarter of its bytes. Spots
//! are found first on the bare background. A patch stays if it still saves more error than its bytes cost. Spots are
//! then painted again around the patches that stay, and more are found.

use super::grid::{Cells, SubpixelGrid, to_four_digits};
use super::partition::Partition;
use super::patches::{FlatPatch, difference};
use super::pursuit::{PaintedWindow, ROUNDS, Rules, Shade};
use super::rate_distortion::{RateDistortion, SECONDARY_BYTES};
use super::shading::ELLIPSE_BYTES;
use super::strata::BehindElements;
use image::RgbImage;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::Progress;
use vtex_scene::library::{AnalyzeParams, ExemplarElement};
use vtex_scene::scene::Shape;

/// Spots may differ by any amount from what they are painted on. Most of each is seen, or its colour could be anything
/// below a primary; large ones would shine beyond the edges of what they are found in.
fn rules(params: &AnalyzeParams) -> Rules {
    let areas = [params.secondary_minimum, params.secondary_maximum].map(f64::from);
    Rules { contrast: f64::INFINITY, harm: 0.5, seen: 0.6, radius: 8.5, areas }
}

/// Name of the stage.
pub(super) const STAGE: &str = "joining";
/// Most rounds of the pursuit on the bare background, which only tells what patches are worth.
const FIRST_ROUNDS: usize = 8;
/// Bytes of a spot as [`RateDistortion`] counts them: an ellipse and the element that it is.
const SPOT_BYTES: f64 = 1.5 * ELLIPSE_BYTES;
/// How much dearer a byte of a patch is than one of a spot.
const DEARER: f64 = 2.0;

/// The ground of a photograph.
pub(super) struct Ground {
    pub(super) patches: Vec<FlatPatch>,
    pub(super) spots: Vec<GroundSpot>,
}

/// A soft ellipse between the primaries.
pub(super) struct GroundSpot {
    pub(super) shade: Shade,
    /// The background's colour at its centre.
    behind: [f64; 3],
}

impl Ground {
    /// Replaces those of `patches` by spots that are not worth their bytes beside them.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`].
    pub(super) fn new(
        partition: &Partition<'_>,
        patches: Vec<FlatPatch>,
        cost: RateDistortion,
        behind: &BehindElements<'_>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let (image, grid) = (&partition.clean, partition.grid);
        let mut window = window(partition, behind);
        let bare = window.painted.clone();
        // Errors of the window are sums over pixels.
        let least = cost.error_per_byte / grid.area() * SPOT_BYTES;
        let rules = rules(partition.params);
        let rounds = |span| PaintedRounds { progress, span };
        let shades = window.paint(least, FIRST_ROUNDS, rules, &rounds(FIRST_PURSUIT))?;
        let worth = cost.error_per_byte * DEARER * SECONDARY_BYTES;
        let stays = parallel::map(&patches, |patch| gain(image, &window, patch, grid.cells) >= worth);
        let patches: Vec<FlatPatch> =
            patches.into_iter().zip(stays).filter_map(|(patch, stays)| stays.then_some(patch)).collect();
        window.painted = bare;
        leave_out(&mut window, &patches, grid);
        let mut shades = window.repaint(&shades, least, rules);
        shades.extend(window.paint(least, ROUNDS, rules, &rounds(LAST_PURSUIT))?);
        let spot = |shade: Shade| GroundSpot { behind: behind.colour(shade.ellipse.centre), shade };
        Ok(Self { patches, spots: shades.into_iter().map(spot).collect() })
    }
}

/// Progress of the stage, in thousandths of its time, by the rounds of a pursuit, each of which takes about
/// [`NEXT_ROUND`] as long as the one before.
struct PaintedRounds<'a> {
    progress: &'a dyn Progress,
    /// Thousandths before this pursuit, and after its last round.
    span: [u64; 2],
}

/// Thousandths of the stage's time that both pursuits span, as measured; what follows takes the rest.
const FIRST_PURSUIT: [u64; 2] = [0, 650];
const LAST_PURSUIT: [u64; 2] = [650, 800];
/// Time of a round, in hundredths of that of the one before.
const NEXT_ROUND: u64 = 57;

impl Progress for PaintedRounds<'_> {
    fn advance(&self, _: &'static str, done: u64, _: u64) -> bool {
        let [begin, end] = self.span;
        let left = (0..done).fold(end - begin, |left, _| left * NEXT_ROUND / 100);
        self.progress.advance(STAGE, end - left, 1000)
    }
}

impl GroundSpot {
    /// The secondary that it is.
    pub(super) fn element(&self) -> Option<ExemplarElement> {
        let Shade { ellipse, colour } = self.shade;
        let shape = Shape::of_ellipse(ellipse, colour)?;
        Some(ExemplarElement {
            category: None,
            colour,
            difference: Some(difference(colour, self.behind)),
            area: (libm::round(shape.area()) as u32).max(1),
            centroid: ellipse.centre.map(to_four_digits),
            compactness: None,
            clipped: false,
            silhouette: None,
            shapes: vec![shape],
        })
    }
}

/// The squared error, over cells, that a patch takes away from what is painted.
fn gain(image: &Cells<RgbImage>, window: &PaintedWindow, patch: &FlatPatch, cells: u32) -> f64 {
    let own = patch.colour.0.map(f32::from);
    let saved = patch.mask.pixels().map(|(x, y)| {
        let painted = window.painted[pixel(x, y, cells, window.width)];
        let target = image.get_pixel(x as u32, y as u32).0.map(f32::from);
        let square =
            |from: [f32; 3]| (0..3).map(|c| (target[c] - from[c]) * (target[c] - from[c])).sum::<f32>();
        f64::from(square(painted) - square(own))
    });
    saved.sum()
}

/// Leaves what patches cover out of what is to be painted.
fn leave_out(window: &mut PaintedWindow, patches: &[FlatPatch], grid: SubpixelGrid) {
    for (x, y) in patches.iter().flat_map(|patch| patch.mask.pixels()) {
        let weight = &mut window.weight[pixel(x, y, grid.cells, window.width)];
        *weight = (*weight - 1.0 / grid.area() as f32).max(0.0);
    }
}

/// What is seen of the background and of spots: the window over the whole photograph, painted with them.
pub(super) fn painted(
    partition: &Partition<'_>,
    behind: &BehindElements<'_>,
    patches: &[FlatPatch],
    spots: &[GroundSpot],
) -> PaintedWindow {
    let mut window = window(partition, behind);
    leave_out(&mut window, patches, partition.grid);
    window.draw(&spots.iter().map(|spot| spot.shade).collect::<Vec<_>>());
    window
}

/// Index of the pixel of a window over the whole photograph that holds a cell.
pub(super) fn pixel(x: i32, y: i32, cells: u32, width: usize) -> usize {
    (y as u32 / cells) as usize * width + (x as u32 / cells) as usize
}

/// The whole photograph, of which all but the primaries is to be painted, with the background painted.
fn window(partition: &Partition<'_>, behind: &BehindElements<'_>) -> PaintedWindow {
    let (image, k) = (&partition.clean, partition.grid.cells);
    let (width, height) = ((image.width() / k) as usize, (image.height() / k) as usize);
    let mut is_free = vec![true; (image.width() * image.height()) as usize];
    for span in partition.primaries.iter().flat_map(|mask| mask.spans()) {
        let start = span.y as usize * image.width() as usize + span.x0 as usize;
        is_free[start..start + span.len() as usize].fill(false);
    }
    let size = [width, height];
    let smooth: Vec<CoarseBackground> =
        (0..behind.count()).map(|layer| CoarseBackground::new(size, behind, layer)).collect();
    let layer = |i: usize| behind.layer([i % width, i / width].map(|v| v as f64 + 0.5)) as u8;
    let layers: Vec<u8> =
        if behind.count() > 1 { (0..width * height).map(layer).collect() } else { Vec::new() };
    let mut pixels = vec![(0f32, [0f32; 3], [0f32; 3]); width * height];
    parallel::for_chunks(&mut pixels, width, |y, row| {
        for (x, (weight, target, painted)) in row.iter_mut().enumerate() {
            let mut count = 0u32;
            for (u, v) in (0..k * k).map(|i| (x as u32 * k + i % k, y as u32 * k + i / k)) {
                if is_free[v as usize * image.width() as usize + u as usize] {
                    let own = image.get_pixel(u, v).0;
                    (0..3).for_each(|c| target[c] += f32::from(own[c]));
                    count += 1;
                }
            }
            if count > 0 {
                *target = target.map(|v| v / count as f32);
                *weight = count as f32 / (k * k) as f32;
                let layer = layers.get(y * width + x).copied().unwrap_or(0);
                *painted = smooth[usize::from(layer)].at([x, y]);
            }
        }
    });
    PaintedWindow {
        width,
        height,
        corner: [0.0; 2],
        weight: pixels.iter().map(|p| p.0).collect(),
        target: pixels.iter().map(|p| p.1).collect(),
        painted: pixels.iter().map(|p| p.2).collect(),
        layers,
    }
}

/// The background of a layer at every fourth pixel.
struct CoarseBackground {
    columns: usize,
    colours: Vec<[f32; 3]>,
}

impl CoarseBackground {
    /// Distance of the pixels at which it is known. The field's control points lie several times as far apart.
    const STEP: usize = 4;

    fn new([width, height]: [usize; 2], behind: &BehindElements<'_>, layer: usize) -> Self {
        let [columns, rows] = [width, height].map(|side| side.div_ceil(Self::STEP) + 1);
        let mut colours = vec![[0.0; 3]; columns * rows];
        parallel::for_chunks(&mut colours, columns, |row, chunk| {
            for (column, colour) in chunk.iter_mut().enumerate() {
                let at = [column, row].map(|v| (v * Self::STEP) as f64 + 0.5);
                *colour = behind.colour_of(layer, at).map(|v| v as f32);
            }
        });
        Self { columns, colours }
    }

    /// The colour at the middle of a pixel.
    fn at(&self, [x, y]: [usize; 2]) -> [f32; 3] {
        let first = y / Self::STEP * self.columns + x / Self::STEP;
        let [tx, ty] = [x, y].map(|v| (v % Self::STEP) as f32 / Self::STEP as f32);
        let mix = |a: [f32; 3], b: [f32; 3], t: f32| -> [f32; 3] {
            std::array::from_fn(|c| a[c] + t * (b[c] - a[c]))
        };
        let row = |i: usize| mix(self.colours[i], self.colours[i + 1], tx);
        mix(row(first), row(first + self.columns), ty)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Exemplar;
    use image::{Rgb, RgbImage};
    use std::sync::Mutex;
    use vtex_base::raster::Limits;
    use vtex_scene::element::Ellipse;
    use vtex_scene::library::{AnalyzeParams, Library};
    use vtex_segment::segment::Felzenszwalb;

    /// The library of a picture of 120 × 120 without primaries.
    fn library(colour: impl Fn(f64, f64) -> [f64; 3]) -> Library {
        let pixel = |x: u32, y: u32| Rgb(colour(f64::from(x) + 0.5, f64::from(y) + 0.5).map(|v| v as u8));
        let mut png = std::io::Cursor::new(Vec::new());
        RgbImage::from_fn(120, 120, pixel).write_to(&mut png, image::ImageFormat::Png).unwrap();
        let exemplar = Exemplar::from_bytes(&png.into_inner(), "test.png", &Limits::default()).unwrap();
        let params = AnalyzeParams { minimum_area: 5000, ..AnalyzeParams::default() };
        crate::analyze(&exemplar, &Felzenszwalb::default(), &params, &()).unwrap()
    }

    #[test]
    fn rounds_are_reported_by_the_time_that_they_take() {
        struct Reports(Mutex<Vec<[u64; 2]>>);
        impl Progress for Reports {
            fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
                assert_eq!(stage, STAGE);
                self.0.lock().unwrap().push([done, total]);
                true
            }
        }
        let reports = Reports(Mutex::default());
        for (span, rounds) in [(FIRST_PURSUIT, FIRST_ROUNDS), (LAST_PURSUIT, ROUNDS)] {
            let pursuit = PaintedRounds { progress: &reports, span };
            (0..rounds as u64).for_each(|round| assert!(pursuit.advance("spots", round, rounds as u64)));
        }
        let reports = reports.0.into_inner().unwrap();
        assert!(reports.iter().all(|r| r[0] < r[1]));
        assert!(reports.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
        // The first rounds take most of the time, and pursuits end before their last round.
        assert_eq!(reports[..4], [[0, 1000], [280, 1000], [440, 1000], [531, 1000]]);
        assert_eq!(reports[FIRST_ROUNDS..][..3], [[650, 1000], [715, 1000], [752, 1000]]);
    }

    #[test]
    fn specks_are_spots() {
        // Eight by eight, of a few pixels each.
        let found = library(|x, y| {
            let off = [x, y].map(|v| v % 15.0 - 7.5);
            let opacity = (2.6 - libm::hypot(off[0], off[1])).clamp(0.0, 1.0);
            [140.0, 130.0, 120.0].map(|v| v - opacity * 90.0)
        });
        let dark = found.secondaries().iter().filter(|s| s.difference.is_some_and(|d| d[0] < -30));
        let spots: Vec<&Ellipse> = dark.filter_map(|s| s.shapes[0].ellipse.as_deref()).collect();
        let is_there = |s: &&&Ellipse| s.centre.iter().all(|v| (v % 15.0 - 7.5).abs() < 0.5);
        assert!(spots.iter().filter(is_there).count() >= 60, "{}", spots.len());
    }

    #[test]
    fn a_patch_with_corners_stays() {
        // A cross too small for a primary, but large for a speck.
        let is_marked = |x: f64, y: f64| {
            let (u, v) = ((x - 60.0).abs(), (y - 60.0).abs());
            u.max(v) < 8.0 && u.min(v) < 2.0
        };
        let found = library(|x, y| if is_marked(x, y) { [30.0; 3] } else { [200.0; 3] });
        let crosses = found.secondaries().iter().filter(|s| s.shapes[0].ellipse.is_none());
        let areas: Vec<u32> = crosses.map(|s| s.area).collect();
        // In pieces: it is narrow.
        assert!((90..=130).contains(&areas.iter().sum::<u32>()), "{areas:?}");
    }
}
