//! Whether a fused element looks like an element of its exemplar.
//!
//! A look is a small picture of an element: a square grid of points, the points that the element covers, and
//! their colours. A flower with two hearts, a torn side or an unknown shape differs from every element of
//! the exemplar by more than the usual difference between its elements.

use crate::arrange::model::{PlaceableId, PlacementModel};
use vtex_base::parallel;
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::{oklab, squared_distance};
use vtex_scene::library::{Guide, Library};

/// Points along a side of a look.
const SIDE: usize = 11;
/// Half the side of the square, in radii of a disk of the element's area.
const HALF: f64 = 1.35;
/// Difference of a point that only one of two looks covers, in squared Oklab. Differences of colours are
/// limited to it.
const MISSING: f32 = 0.04;
/// Least ratio of the areas of two elements that are compared.
const AREA: f64 = 0.6;
/// Number of elements of similar area that each element is compared with.
const COMPARED: usize = 160;
/// Number of elements from which the usual difference is learned.
const LEARNED: usize = 200;
/// Fewest elements from which the usual difference is learned.
const LEAST: usize = 8;
/// Quantile of the elements' distances to their most similar element; a look within that distance counts as
/// similar.
const USUAL: f64 = 0.5;

/// The look of an element.
pub(super) struct ElementLook {
    points: Vec<Option<[f32; 3]>>,
    area: f64,
}

impl ElementLook {
    /// The look of an element with a given middle and area, in pixels. `colour` gives the colour of a pixel,
    /// `None` outside the element; `turned` rotates an offset from the middle as the element is rotated.
    pub(super) fn new(
        middle: [f64; 2],
        area: f64,
        turned: impl Fn([f64; 2]) -> [f64; 2],
        colour: impl Fn([i32; 2]) -> Option<[f32; 3]>,
    ) -> Self {
        let radius = libm::sqrt(area / std::f64::consts::PI);
        let offset = |k: usize| ((k as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0) * HALF * radius;
        let point = |i: usize| {
            let [dx, dy] = turned([offset(i % SIDE), offset(i / SIDE)]);
            colour([middle[0] + dx, middle[1] + dy].map(|v| libm::floor(v) as i32))
        };
        Self { points: (0..SIDE * SIDE).map(point).collect(), area }
    }

    /// Mean squared difference over the points that either look covers.
    fn distance(&self, other: &Self) -> f64 {
        let (mut sum, mut count) = (0f32, 0);
        for (a, b) in self.points.iter().zip(&other.points) {
            sum += match (a, b) {
                (Some(a), Some(b)) => squared_distance(*a, *b).min(MISSING),
                (None, None) => continue,
                _ => MISSING,
            };
            count += 1;
        }
        f64::from(sum) / f64::from(count.max(1))
    }
}

/// The looks of all elements that can be placed whole, and their usual differences.
pub(super) struct Likeness {
    /// By library and stratum: area, element and look, the smallest first.
    groups: Vec<SimilarElements>,
    /// The group of each element.
    group_of: Vec<usize>,
}

struct SimilarElements {
    members: Vec<(PlaceableId, ElementLook)>,
    /// Largest distance of looks that count as similar.
    usual: f64,
}

impl Likeness {
    /// `strata` holds the stratum of each element; libraries without a guide have no looks.
    pub(super) fn new(
        libraries: &[Library],
        labels: &[LabelMap],
        model: &PlacementModel,
        strata: &[u8],
    ) -> Self {
        let keys: Vec<(usize, u8)> =
            model.elements.iter().map(|e| e.library).zip(strata.iter().copied()).collect();
        let mut kinds = keys.clone();
        kinds.sort_unstable();
        kinds.dedup();
        let group_of: Vec<usize> = keys.iter().map(|key| kinds.binary_search(key).unwrap_or(0)).collect();
        let colours: Vec<Option<GuideColours<'_>>> = libraries.iter().map(GuideColours::new).collect();
        let all: Vec<PlaceableId> = (0..model.elements.len() as u32).map(PlaceableId).collect();
        let looks = parallel::map(&all, |&id| {
            let element = &model[id];
            let colours = colours[element.library].as_ref().filter(|_| element.placeable)?;
            let (map, label) = (&labels[element.library], element.index + 1);
            let middle = libraries[element.library].primaries()[element.index as usize].centroid;
            let colour =
                |[x, y]: [i32; 2]| (map.at(x.into(), y.into()) == Some(label)).then(|| colours.at([x, y]));
            Some(ElementLook::new(middle, f64::from(model.plain(id).area), |offset| offset, colour))
        });
        let mut groups: Vec<SimilarElements> =
            kinds.iter().map(|_| SimilarElements { members: Vec::new(), usual: f64::INFINITY }).collect();
        for ((&id, look), &group) in all.iter().zip(looks).zip(&group_of) {
            groups[group].members.extend(look.map(|look| (id, look)));
        }
        for group in &mut groups {
            group.members.sort_by(|a, b| a.1.area.total_cmp(&b.1.area).then(a.0.cmp(&b.0)));
            group.learn_usual_distance();
        }
        Self { groups, group_of }
    }

    /// The element most similar to `look` among those of the library and stratum of `element`, and whether
    /// the two are as similar as the exemplar's elements usually are; `None` if no element has a similar
    /// size.
    pub(super) fn nearest(&self, element: PlaceableId, look: &ElementLook) -> Option<(PlaceableId, bool)> {
        let group = &self.groups[self.group_of[element.0 as usize]];
        let (nearest, distance) = group.nearest(look, None)?;
        Some((nearest, distance <= group.usual))
    }
}

impl SimilarElements {
    /// The member most similar to a look, and its distance; `except` is left out.
    fn nearest(&self, look: &ElementLook, except: Option<PlaceableId>) -> Option<(PlaceableId, f64)> {
        let bound = |area: f64| self.members.partition_point(|(_, l)| l.area < area);
        let range = bound(AREA * look.area)..bound(look.area / AREA);
        let step = range.len().div_ceil(COMPARED).max(1);
        let near = self.members[range].iter().step_by(step).filter(|(id, _)| Some(*id) != except);
        let found = near.map(|(id, other)| (*id, look.distance(other)));
        found.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }

    /// Sets the usual distance of similar members.
    fn learn_usual_distance(&mut self) {
        let step = self.members.len().div_ceil(LEARNED).max(1);
        let sample: Vec<&(PlaceableId, ElementLook)> = self.members.iter().step_by(step).collect();
        let nearest = parallel::map(&sample, |(id, look)| self.nearest(look, Some(*id)).map(|n| n.1));
        let mut distances: Vec<f64> = nearest.into_iter().flatten().collect();
        if distances.len() >= LEAST {
            distances.sort_by(f64::total_cmp);
            self.usual = distances[(USUAL * (distances.len() - 1) as f64) as usize];
        }
    }
}

/// The colours of a guide.
pub(super) struct GuideColours<'a> {
    guide: &'a Guide,
    of_cells: Vec<[f32; 3]>,
}

impl<'a> GuideColours<'a> {
    /// `None` for a library without a guide.
    pub(super) fn new(library: &'a Library) -> Option<Self> {
        let guide = library.guide.as_ref()?;
        Some(Self { guide, of_cells: guide.picture.0.pixels().map(|p| oklab(p.0)).collect() })
    }

    /// The colour at a pixel of the exemplar.
    pub(super) fn at(&self, pixel: [i32; 2]) -> [f32; 3] {
        let (width, height) = self.guide.picture.0.dimensions();
        let [x, y] = pixel.map(|v| v.max(0) as u32 / self.guide.cell);
        self.of_cells[(y.min(height - 1) * width + x.min(width - 1)) as usize]
    }
}
