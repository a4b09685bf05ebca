//! Libraries as pages for the search of correspondences, and the way back to their pixels.
//!
//! A cell has six features: its colour in Oklab in units of the standard deviation, the signed distance to
//! the nearest border of a primary, up to three cells, and its place within that primary, from the middle,
//! in radii. Each variation that the parameters allow has a page of its own, at most eight. An exemplar that
//! wraps is continued beyond its borders. An exemplar with a lattice has its plain page only, because a
//! rotated one has other rows. Where colours are so alike that their mean exceeds what features hold, as in pale or
//! subtle pictures, the mean is taken off. Colours of strata lie half as far again apart as in the exemplar, so islands
//! keep to their stratum.

use crate::arrange::model::PlacementModel;
use vtex_base::raster::colour::oklab;
use vtex_base::raster::{LabelMap, squared_distance};
use vtex_field::correspondence::{CHANNELS, ExemplarPage, LARGEST_FEATURE, Periods};
use vtex_scene::lattice::{Lattice, Phases};
use vtex_scene::library::{Guide, Library};

/// Most pages of a library, of those that variations make.
const MOST_VARIED: usize = 8;
/// Distances to the border of a primary are clamped to this, in cells.
const FARTHEST: f32 = 3.0;
/// Weight of a distance of [`FARTHEST`], relative to a standard deviation of colour.
const BORDER_WEIGHT: f32 = 0.6;
/// Weight of a place at one radius from the middle of a primary.
const PLACE_WEIGHT: f32 = 0.8;
/// Farthest place within a primary, in radii; farther ones are clamped to this.
const MOST_RADII: f64 = 1.5;
/// How much further apart the colours of strata are than they are in the exemplar, as a share of the
/// difference of their means: cells of one stratum come from that stratum.
const STRATA_APART: f32 = 0.5;
/// Distance by which offsets may miss a lattice, in strays of the exemplar, and at most in cells.
const STRAY: f64 = 0.5;
const MOST_ASTRAY: f64 = 1.5;
/// Distance by which an exemplar that wraps is continued, as a share of its side.
const CONTINUED: f64 = 0.35;

/// The map from the pixels of a page to those of an exemplar.
pub(super) struct PixelMap {
    /// Index of the library.
    pub(super) library: usize,
    /// Index of the model's variation.
    pub(super) variation: u16,
    /// Size of the exemplar, in pixels.
    pub(super) size: [i32; 2],
    /// Size of the page, in pixels.
    area: [i32; 2],
    /// Place of the exemplar's middle on the page, in pixels.
    middle: [i32; 2],
    wrap: bool,
}

/// The exemplars as pages for the search.
pub(super) struct Pages {
    /// Side of a cell, in pixels.
    pub(super) cell: i32,
    pub(super) pages: Vec<ExemplarPage>,
    pub(super) sheets: Vec<PixelMap>,
    /// The primary on each pixel of the exemplar, library by library.
    pub(super) labels: Vec<LabelMap>,
}

/// The pixels of an exemplar as features are computed from them.
struct Surface<'a> {
    guide: &'a Guide,
    /// Colours of the guide's cells.
    colours: &'a [[f32; 3]],
    /// Weight of a unit of Oklab.
    unit: f32,
    /// Signed distance of each pixel to the nearest border, as [`border_distances`] gives it.
    borders: Vec<f32>,
    /// Middle and radius of each primary, by its label; label 0 is none.
    middles: Vec<Option<Middle>>,
    map: &'a LabelMap,
    /// The class of each pixel, if cells of the canvas take their sources from a class.
    classes: Option<&'a LabelMap>,
}

/// The middle of a primary, and the radius of a disk of its area, in pixels.
struct Middle {
    at: [f64; 2],
    radius: f64,
}

impl PixelMap {
    /// For an exemplar of `size` pixels in one of the model's variations.
    fn new(library: usize, model: &PlacementModel, variation: usize, size: [i32; 2], wrap: bool) -> Self {
        let area = extent(model, variation, size, wrap);
        let middle = if variation == 0 { size } else { area }.map(|v| v / 2);
        Self { library, variation: variation as u16, size, area, middle, wrap }
    }

    /// Whether the page is the exemplar as it is: neither varied nor continued.
    pub(super) fn is_exemplar(&self) -> bool {
        self.variation == 0 && !self.wrap
    }

    /// The page, in cells of `cell` pixels.
    fn page(
        &self,
        model: &PlacementModel,
        cell: i32,
        exemplar: &Surface<'_>,
        periods: Option<&Periods>,
    ) -> ExemplarPage {
        let size = self
            .area
            .map(|v| if self.is_exemplar() { (v + cell - 1) / cell } else { v / cell }.max(1) as usize);
        let cells = (0..size[1] as i32).flat_map(|y| (0..size[0] as i32).map(move |x| [x * cell, y * cell]));
        let groups = exemplar.classes.map(|classes| {
            let class = |first: [i32; 2]| {
                let mut middle = first.map(|v| v + cell / 2);
                if self.is_exemplar() {
                    middle = [0, 1].map(|k| middle[k].min(self.size[k] - 1));
                }
                let at = self.exemplar(model, middle);
                at.and_then(|[x, y]| classes.at(i64::from(x), i64::from(y))).unwrap_or(0) as u8
            };
            cells.clone().map(class).collect()
        });
        let (features, inside) = cells.map(|first| self.feature(model, first, cell, exemplar)).unzip();
        // A cell of the plain page that sticks out of the exemplar still counts.
        let inside = (self.variation != 0).then_some(inside);
        ExemplarPage { group: self.library as u8, groups, size, features, inside, periods: periods.cloned() }
    }

    /// Features of the cell with the given first pixel, and whether all of it shows the exemplar.
    fn feature(
        &self,
        model: &PlacementModel,
        first: [i32; 2],
        cell: i32,
        exemplar: &Surface<'_>,
    ) -> ([f32; CHANNELS], bool) {
        let (mut border, mut found) = (0.0, 0);
        for v in 0..cell {
            for u in 0..cell {
                if let Some([x, y]) = self.exemplar(model, [first[0] + u, first[1] + v]) {
                    border += exemplar.borders[(y * self.size[0] + x) as usize];
                    found += 1;
                }
            }
        }
        let mut centre = first.map(|v| v + cell / 2);
        if self.is_exemplar() {
            centre = [0, 1].map(|k| centre[k].min(self.size[k] - 1));
        }
        let at = self.exemplar(model, centre);
        let colour = at.map_or([0.0; 3], |[x, y]| {
            let side = exemplar.guide.cell as i32;
            exemplar.colours[((y / side) * exemplar.guide.picture.0.width() as i32 + x / side) as usize]
        });
        let [l, a, b] = colour.map(|v| v * exemplar.unit);
        let [u, v] = at.map_or([0.0; 2], |at| self.place_within(model, at, exemplar));
        let feature = [l, a, b, BORDER_WEIGHT * border / found.max(1) as f32, u, v];
        (feature, at.is_some() && found == cell * cell)
    }

    /// Position of an exemplar's pixel within its primary, turned as on the page: offset from the middle in
    /// radii, weighted; zero on background.
    fn place_within(&self, model: &PlacementModel, at: [i32; 2], exemplar: &Surface<'_>) -> [f32; 2] {
        let label = exemplar.map.get(at[0] as u32, at[1] as u32);
        let Some(middle) = &exemplar.middles[label as usize] else { return [0.0; 2] };
        let from = [0, 1].map(|k| {
            let d = f64::from(at[k]) + 0.5 - middle.at[k];
            let period = f64::from(self.size[k]);
            // Across the borders of an exemplar that wraps.
            if self.wrap { d - period * libm::round(d / period) } else { d }
        });
        let variation = &model.variations[usize::from(self.variation)];
        let shown =
            if variation.is_none() { from } else { variation.of_point(from).map(|c| c / variation.scale) };
        shown.map(|c| PLACE_WEIGHT * (c / middle.radius).clamp(-MOST_RADII, MOST_RADII) as f32)
    }

    /// The pixel of the exemplar at a pixel of the page; `None` outside the exemplar.
    pub(super) fn exemplar(&self, model: &PlacementModel, page: [i32; 2]) -> Option<[i32; 2]> {
        let variation = &model.variations[usize::from(self.variation)];
        let at = if variation.is_none() {
            page
        } else {
            let half = self.size.map(|v| v / 2);
            let back = variation.source_pixel([page[0] - self.middle[0], page[1] - self.middle[1]]);
            [back[0] + half[0], back[1] + half[1]]
        };
        if self.wrap {
            return Some([at[0].rem_euclid(self.size[0]), at[1].rem_euclid(self.size[1])]);
        }
        let is_inside = (0..self.size[0]).contains(&at[0]) && (0..self.size[1]).contains(&at[1]);
        is_inside.then_some(at)
    }

    /// Place of the exemplar → place on the page; the one nearest to `near` if the exemplar wraps.
    pub(super) fn on_page(&self, model: &PlacementModel, at: [i32; 2], near: [i32; 2]) -> [i32; 2] {
        let variation = &model.variations[usize::from(self.variation)];
        if variation.is_none() && !self.wrap {
            return at;
        }
        if variation.is_none() {
            return [0, 1].map(|k| nearest_copy(at[k], near[k], self.size[k]));
        }
        let half = self.size.map(|v| v / 2);
        let place = |at: [i32; 2]| {
            let there = variation.mapped_pixel([at[0] - half[0], at[1] - half[1]]);
            [there[0] + self.middle[0], there[1] + self.middle[1]]
        };
        if !self.wrap {
            return place(at);
        }
        let back = variation.source_pixel([near[0] - self.middle[0], near[1] - self.middle[1]]);
        place([0, 1].map(|k| nearest_copy(at[k], back[k] + half[k], self.size[k])))
    }

    /// Calls `visit` with every place on a page of `area` pixels that shows a place of the exemplar.
    pub(super) fn copies(
        &self,
        model: &PlacementModel,
        at: [i32; 2],
        area: [i32; 2],
        mut visit: impl FnMut([i32; 2]),
    ) {
        let shifts = |k: usize| {
            let most = if self.wrap { area[k] / self.size[k] + 1 } else { 0 };
            (-most..=most).map(move |n| n * self.size[k])
        };
        for dy in shifts(1) {
            for dx in shifts(0) {
                let variation = &model.variations[usize::from(self.variation)];
                let copy = [at[0] + dx, at[1] + dy];
                let there = if variation.is_none() {
                    copy
                } else {
                    let half = self.size.map(|v| v / 2);
                    let there = variation.mapped_pixel([copy[0] - half[0], copy[1] - half[1]]);
                    [there[0] + self.middle[0], there[1] + self.middle[1]]
                };
                if (0..2).all(|k| (0..area[k]).contains(&there[k])) {
                    visit(there);
                }
            }
        }
    }
}

/// `v` moved by whole periods to where it is nearest to `near`.
fn nearest_copy(v: i32, near: i32, period: i32) -> i32 {
    near + (v - near + period / 2).rem_euclid(period) - period / 2
}

impl Pages {
    /// The pages of libraries; `None` if one of them has no guide. `classes` are those of the pixels of the
    /// only exemplar, if cells of the canvas take their sources from a class. `margin` are the cells of the
    /// field beside the canvas.
    pub(super) fn new(
        libraries: &[Library],
        model: &PlacementModel,
        classes: Option<&LabelMap>,
        lattices: &[Option<(Lattice, Phases)>],
        margin: [i32; 2],
    ) -> Option<Self> {
        let guides: Vec<&Guide> = libraries.iter().map(|l| l.guide.as_ref()).collect::<Option<_>>()?;
        let cell = guides.iter().map(|g| g.cell).min()? as i32;
        let labels: Vec<LabelMap> = libraries.iter().map(|l| l.arrangement.to_labels()).collect();
        let colours: Vec<Vec<[f32; 3]>> = libraries.iter().zip(&guides).map(|(l, g)| colours(l, g)).collect();
        let unit = 1.0 / joint_deviation(&colours).max(1e-3);
        let colours = within_features(colours, unit);
        // An odd step, for every second variation is mirrored.
        let step = model.variations.len().div_ceil(MOST_VARIED) | 1;
        let mut this = Self { cell, pages: Vec::new(), sheets: Vec::new(), labels };
        for (k, library) in libraries.iter().enumerate() {
            let map = &this.labels[k];
            let size = [map.width as i32, map.height as i32];
            let exemplar = Surface {
                guide: guides[k],
                colours: &colours[k],
                unit,
                borders: border_distances(map, cell as f32 * FARTHEST),
                middles: middles(library, map),
                map,
                classes,
            };
            let lattice = lattices[k].as_ref();
            let periods = lattice.map(|(lattice, canvas)| periods(lattice, canvas, cell, margin));
            // A page that is turned or mirrored has other rows, so elements are varied at their own places
            // instead.
            let count = if periods.is_some() { 1 } else { model.variations.len() };
            for variation in (0..count).step_by(step) {
                let sheet = PixelMap::new(k, model, variation, size, library.arrangement.periodic);
                this.pages.push(sheet.page(model, cell, &exemplar, periods.as_ref()));
                this.sheets.push(sheet);
            }
        }
        Some(this)
    }
}

/// The colours of a guide in Oklab, those of strata further apart.
fn colours(library: &Library, guide: &Guide) -> Vec<[f32; 3]> {
    let mut colours: Vec<[f32; 3]> = guide.picture.0.pixels().map(|p| oklab(p.0)).collect();
    if !library.is_layered() {
        return colours;
    }
    let labels = library.strata_labels();
    let middle = |v: u32, size: u32| (v * guide.cell + guide.cell / 2).min(size - 1);
    let of = guide
        .picture
        .0
        .enumerate_pixels()
        .map(|(x, y, _)| labels.get(middle(x, labels.width), middle(y, labels.height)) as usize);
    let of: Vec<usize> = of.collect();
    let mut means = vec![[0f32; 4]; library.strata().len()];
    for (colour, &k) in colours.iter().zip(&of) {
        (0..3).for_each(|c| means[k][c] += colour[c]);
        means[k][3] += 1.0;
    }
    for (colour, &k) in colours.iter_mut().zip(&of) {
        (0..3).for_each(|c| colour[c] += STRATA_APART * means[k][c] / means[k][3]);
    }
    colours
}

/// Size of the page of a variation, in pixels.
fn extent(model: &PlacementModel, variation: usize, size: [i32; 2], wrap: bool) -> [i32; 2] {
    let size = if wrap { size.map(|v| v + (CONTINUED * f64::from(v)) as i32) } else { size };
    let variation = &model.variations[variation];
    if variation.is_none() {
        return size;
    }
    let half = size.map(|v| f64::from(v) / 2.0);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let there = corners.map(|c: [f64; 2]| variation.of_point([c[0] * half[0], c[1] * half[1]]));
    [0, 1].map(|k| {
        let most = there.iter().map(|p| p[k].abs()).fold(0.0, f64::max);
        2 * libm::ceil(most) as i32
    })
}

/// The colours without their mean, if that exceeds what features hold at `unit` for 1.
fn within_features(mut colours: Vec<Vec<[f32; 3]>>, unit: f32) -> Vec<Vec<[f32; 3]>> {
    let count = colours.iter().map(Vec::len).sum::<usize>().max(1) as f64;
    let sum = |c: usize| colours.iter().flatten().map(|v| f64::from(v[c])).sum::<f64>();
    let mean = [0, 1, 2].map(|c| (sum(c) / count) as f32);
    if mean.iter().any(|v| v.abs() * unit >= LARGEST_FEATURE) {
        colours.iter_mut().flatten().for_each(|colour| (0..3).for_each(|c| colour[c] -= mean[c]));
    }
    colours
}

/// Square root of the variances of all three components together.
fn joint_deviation(colours: &[Vec<[f32; 3]>]) -> f32 {
    let count = colours.iter().map(Vec::len).sum::<usize>().max(1) as f64;
    let all = || colours.iter().flatten();
    let variance = |c: usize| {
        let mean = all().map(|v| f64::from(v[c])).sum::<f64>() / count;
        all().map(|v| (f64::from(v[c]) - mean) * (f64::from(v[c]) - mean)).sum::<f64>() / count
    };
    libm::sqrt((0..3).map(variance).sum::<f64>()) as f32
}

/// The periods of a lattice, in cells.
fn periods(lattice: &Lattice, canvas: &Phases, cell: i32, margin: [i32; 2]) -> Periods {
    let cell = f64::from(cell);
    let both = |list: &[[f64; 2]], factor: f64| {
        [0, 1].map(|k| list.get(k).map_or([0.0; 2], |v| v.map(|c| (c * factor) as f32)))
    };
    Periods {
        vectors: both(&lattice.vectors, 1.0 / cell),
        page: both(&lattice.phases().waves, cell),
        canvas: both(&canvas.waves, cell),
        margin: margin.map(|v| v as f32),
        tolerance: (STRAY * lattice.stray / cell).min(MOST_ASTRAY) as f32,
    }
}

/// Middle and radius of each primary of a library, by label.
fn middles(library: &Library, map: &LabelMap) -> Vec<Option<Middle>> {
    let areas = map.areas();
    let middle = |label: usize| {
        let area = areas.get(label).copied().filter(|&area| area > 0)?;
        let primary = library.primaries().get(label.checked_sub(1)?)?;
        let radius = libm::sqrt(f64::from(area) / std::f64::consts::PI).max(1.0);
        Some(Middle { at: primary.centroid, radius })
    };
    (0..areas.len().max(library.primaries().len() + 1)).map(middle).collect()
}

/// For each pixel its distance to the nearest border of a primary as a share of `farthest`: positive
/// within primaries, negative on the region.
pub(super) fn border_distances(map: &LabelMap, farthest: f32) -> Vec<f32> {
    let (w, h) = (map.width as usize, map.height as usize);
    let is_border = |i: usize| {
        (!i.is_multiple_of(w) && map.labels[i] != map.labels[i - 1])
            || (i >= w && map.labels[i] != map.labels[i - w])
    };
    let squared = squared_distance(w, h, is_border);
    let signed = |(i, d): (usize, &f32)| {
        let share = libm::sqrtf(*d).min(farthest) / farthest;
        if map.labels[i] > 0 { share } else { -share }
    };
    squared.iter().enumerate().map(signed).collect()
}
