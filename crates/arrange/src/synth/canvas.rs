//! The canvas of a texture: its size where none is asked for, and its pixels where lengths are.

use vtex_base::error::{Error, Large, Result};
use vtex_scene::library::{Lattice, Library};
use vtex_scene::scene::{LatticeChoice, Length, LengthUnit, SynthParams, page_at};

/// Repetitions of a drawing's page along each axis, where no size is asked for.
const REPEATS: u32 = 3;
/// Largest number of elements of a drawing that is placed unasked, unless its page alone has more: of one that repeats, and
/// of a page that ends, whose arrangement is optimised.
const MOST_ELEMENTS: [usize; 2] = [9000, 2500];
/// Longer side of a drawing's texture on a screen, in pixels, where no size is asked for.
const ON_SCREEN: u32 = 900;
/// Pixels of a canvas by which its page's proportions are met better, as a share of its side.
const SLACK: f64 = 0.05;
/// Weight of a canvas larger or smaller than usual against one of other proportions than its page.
const SIZE_WEIGHT: f64 = 0.05;
/// Most periods of a drawing along an axis of a page that tiles, where no resolution is given.
const MOST_PERIODS: u32 = 40;

/// Largest canvas, in pixels.
pub(super) const LARGEST_CANVAS: u64 = 400_000_000;
/// Memory per pixel of the canvas, in bytes: seven of the target map, and the share of placed elements
/// (measured on sandy concrete, which has the most).
const BYTES_PER_PIXEL: u64 = 25;

/// The size that is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CanvasSize {
    /// One that suits the libraries: 1000 × 1000 px. For a single drawing 3 × 3 of its pages, shown at 900 px along the
    /// longer side; fewer pages where these have more than 9000 elements, or 2500 if their borders do not join.
    #[default]
    Auto,
    /// Width and height in pixels of a photograph or units of a drawing.
    Pixels([u32; 2]),
    /// Width and height of the page.
    Page([Length; 2]),
}

impl CanvasSize {
    /// Sets canvas and page of `params` for a texture of `libraries`. `dpi` is the number of pixels to the inch. Where it is
    /// `None`, a page given in lengths has as many pixels as the canvas that suits the libraries, so that elements are as
    /// large in relation to the page whatever its size; one that tiles has whole periods of a drawing or lattice.
    pub fn set(self, params: &mut SynthParams, libraries: &[Library], dpi: Option<u32>) {
        self.set_repeated(params, libraries, dpi, REPEATS);
    }

    /// As [`CanvasSize::set`], but where no size is asked for, a drawing has one page, at a pixel for each unit. A page in
    /// lengths has one, too.
    pub fn set_one_page(self, params: &mut SynthParams, libraries: &[Library], dpi: Option<u32>) {
        self.set_repeated(params, libraries, dpi, 1);
        if self == Self::Auto && dpi.is_none() {
            params.page = None;
        }
    }

    fn set_repeated(self, params: &mut SynthParams, libraries: &[Library], dpi: Option<u32>, repeats: u32) {
        let (size, page) = match self {
            Self::Auto => {
                let (size, page) = usual(libraries, repeats);
                (size, dpi.map_or(page, |dpi| page_at(size, dpi)))
            }
            Self::Pixels(size) => (size, dpi.and_then(|dpi| page_at(size, dpi))),
            Self::Page(page) => {
                let at = |dpi: u32| page.map(|side| libm::round(side.inches() * f64::from(dpi)) as u32);
                (dpi.map_or_else(|| fitted(page, params, libraries, repeats), at), Some(page))
            }
        };
        [params.width, params.height] = size;
        params.page = page;
    }

    /// The parameters with as many pixels as suit the libraries, in the proportions of their own canvas.
    pub fn usual_for(params: &SynthParams, libraries: &[Library]) -> SynthParams {
        let mut usual = params.clone();
        let side = |pixels: u32| Length::new(f64::from(pixels), LengthUnit::Pixel);
        let own = side(params.width).zip(side(params.height)).map(|(width, height)| [width, height]);
        params.page.or(own).map_or(Self::Auto, Self::Page).set(&mut usual, libraries, None);
        usual
    }
}

/// The canvas that suits libraries, and its page. A drawing has at most `most` pages along each axis.
fn usual(libraries: &[Library], most: u32) -> ([u32; 2], Option<[Length; 2]>) {
    let SynthParams { width, height, .. } = SynthParams::default();
    let [library] = libraries else { return ([width, height], None) };
    if !library.is_drawing() {
        return ([width, height], None);
    }
    let side = library.page().map(|side| side * f64::from(repeats(library, most)));
    let longer = side[0].max(side[1]);
    let shown = side.map(|v| libm::round(v / longer * f64::from(ON_SCREEN)).max(1.0));
    let [x, y] = shown.map(|v| Length::new(v, LengthUnit::Pixel));
    (side.map(whole), x.zip(y).map(|(x, y)| [x, y]))
}

/// A side in whole pixels.
fn whole(side: f64) -> u32 {
    let [least, most] = SynthParams::SIDE.range.map(f64::from);
    libm::round(side).clamp(least, most) as u32
}

/// Number of pages of a drawing along each axis, at most `most`, where no size is asked for.
fn repeats(library: &Library, most: u32) -> u32 {
    let elements: usize = library.layers.iter().map(|layer| layer.instances.len()).sum();
    let [of_period, of_page] = MOST_ELEMENTS;
    let placed = if library.arrangement.periodic { of_period } else { of_page };
    let few = |n: &u32| elements * (n * n) as usize <= placed;
    (1..=most).rev().find(few).unwrap_or(1)
}

/// The canvas of a page for which no resolution is given.
fn fitted(page: [Length; 2], params: &SynthParams, libraries: &[Library], most: u32) -> [u32; 2] {
    let proportion = page[0].points() / page[1].points();
    let single = if let [library] = libraries { Some(library) } else { None };
    let area = match single.filter(|library| library.is_drawing()) {
        Some(library) => {
            let [w, h] = library.page();
            let area = w * h * f64::from(repeats(library, most).pow(2));
            if library.arrangement.periodic && params.tile.any() {
                return whole_periods([w, h], proportion, area, params);
            }
            area
        }
        None => f64::from(SynthParams::SIDE.default()) * f64::from(SynthParams::SIDE.default()),
    };
    let lattice = match &params.lattice {
        _ if !params.tile.any() => None,
        LatticeChoice::Auto => single.and_then(|library| library.lattice.clone()).filter(Lattice::is_kept),
        LatticeChoice::Off => None,
        LatticeChoice::Vectors(vectors) => Lattice::new(vectors).ok(),
    };
    let Some(lattice) = lattice else { return nearest(proportion, area) };
    let wrap = [params.tile.x, params.tile.y];
    // From the usual area up and down in steps of 2 %.
    let factors = (0..40).flat_map(|k| [1.0 + 0.02 * f64::from(k), 1.0 / (1.0 + 0.02 * f64::from(k))]);
    let mut sizes = factors.map(|by| nearest(proportion, area * by));
    sizes.find(|size| lattice.fits_tile(*size, wrap)).unwrap_or_else(|| nearest(proportion, area))
}

/// A canvas of about an area whose proportion of width to height is nearly the given one.
fn nearest(proportion: f64, area: f64) -> [u32; 2] {
    let about = libm::sqrt(area * proportion);
    let first = whole(about * (1.0 - SLACK));
    let last = whole(about * (1.0 + SLACK));
    let cost = |width: u32| {
        let stretch =
            libm::log(f64::from(width) / f64::from(whole(f64::from(width) / proportion)) / proportion);
        stretch.abs() + SIZE_WEIGHT * (f64::from(width) / about - 1.0).abs()
    };
    let width = (first..=last).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(first);
    [width, whole(f64::from(width) / proportion)]
}

/// A canvas of whole periods along the axes that tile, of about an area and nearly a proportion.
fn whole_periods([w, h]: [f64; 2], proportion: f64, area: f64, params: &SynthParams) -> [u32; 2] {
    let [width, height] = [libm::sqrt(area * proportion), libm::sqrt(area / proportion)];
    let count = |side: f64, period: f64| libm::round(side / period).max(1.0) * period;
    let [width, height] = match (params.tile.x, params.tile.y) {
        (true, true) => {
            let counts = || (1..=MOST_PERIODS).map(f64::from);
            let sizes = counts().flat_map(|n| counts().map(move |m| [n * w, m * h]));
            let cost = |[x, y]: &[f64; 2]| {
                let stretch = libm::log(x / y / proportion).abs();
                stretch + SIZE_WEIGHT * libm::log(x * y / area).abs()
            };
            sizes.min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or([w, h])
        }
        (true, false) => [count(width, w), count(width, w) / proportion],
        (false, _) => [count(height, h) * proportion, count(height, h)],
    };
    [whole(width), whole(height)]
}

/// An error if the canvas is too large.
pub(crate) fn check_canvas(params: &SynthParams) -> Result<()> {
    let canvas = u64::from(params.width) * u64::from(params.height);
    if canvas <= LARGEST_CANVAS {
        return Ok(());
    }
    Err(Error::TooLarge {
        what: Large::Canvas,
        name: "size".into(),
        found: format!(
            "{} x {} px, about {} GB of memory",
            params.width,
            params.height,
            canvas * BYTES_PER_PIXEL / 1_000_000_000
        ),
        limit: format!("{} megapixels", LARGEST_CANVAS / 1_000_000),
    })
}
