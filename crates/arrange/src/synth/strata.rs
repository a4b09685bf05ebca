//! Strata of a scene: the nested layers of a weathered surface, each with its region, background and
//! elements.
//!
//! Depths in the exemplar's regions are copied along the correspondence field, pixel by pixel. Regions follow by rank,
//! nested and with the exemplar's areas, or are taken from a given map, with thin strips where strata would touch that do not in
//! the exemplar. Elements larger than a 10,000th of the squared shorter side stay whole: borders go around
//! them. Smaller ones belong to the stratum at their centre. A border is thus crisp where backgrounds meet,
//! and follows the elements where there are some.
//!
//! Control points of a background take the colour of the nearest place of the exemplar in the same stratum.
//! Where the exemplar's border is soft they take that of the whole, so the region's edge is not seen.
//! Placement by descriptors, several libraries on one canvas and warps know a single background, joined from
//! those of the strata.

mod near;

use super::backdrop::{Backdrop, BackgroundPart};
use super::secondaries::PlacedSecondary;
use crate::arrange::controls::StructureGuide;
use crate::arrange::correspondence::Correspondence;
use crate::arrange::model::PlaceableId;
use crate::arrange::{PlacementResult, Plan};
use near::NearbyPlaces;
use serde::Serialize;
use vtex_base::error::Result;
use vtex_base::geometry::Outline;
use vtex_base::parallel;
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::Colour;
use vtex_field::layers::{LayerExemplar, LayerMap, MapLayer};
use vtex_scene::library::{Library, Stratum};
use vtex_scene::scene::{ControlPoint, Field, Layer, Role, SynthParams};

/// The layers of a stratum, from bottom to top.
const ROLES: [Role; 3] = [Role::Background, Role::Secondary, Role::Primary];
/// Distance in guide cells over which the difference across a border is compared with that of one cell.
const FAR: u32 = 4;
/// Ratios of the two differences: up to the first a border is soft, from the second on it is crisp.
const SOFT: [f64; 2] = [0.25, 0.6];
/// Distance by which control points extend beyond the pixels of their stratum, in spacings.
const BEYOND: f64 = 1.5;

/// The strata of a library's exemplar as a layer map of the exemplar's size; one layer if the exemplar is
/// homogeneous.
pub fn layer_map(library: &Library) -> LayerMap {
    let layer = |s: Stratum<'_>| MapLayer { name: s.name().into(), colour: s.colour() };
    LayerMap { labels: library.strata_labels(), layers: library.strata().into_iter().map(layer).collect() }
}

/// Area and coverage of one stratum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StratumReport {
    /// Its name.
    pub name: String,
    /// Its colour in layer maps.
    pub colour: Colour,
    /// Share of the exemplar, or of a given map, 0 to 1.
    pub area_wanted: f64,
    /// Share of the canvas, 0 to 1.
    pub area: f64,
    /// Share of the layer that primaries cover in the exemplar, 0 to 1.
    pub coverage_wanted: f64,
    /// Share of the layer that primaries cover on the canvas, 0 to 1.
    pub coverage: f64,
}

/// The strata of a canvas.
pub(crate) struct CanvasStrata {
    map: LayerMap,
    /// The background layer of each, with its region and field.
    backgrounds: Vec<Layer>,
    /// The stratum of each element of the library.
    of_elements: Vec<u8>,
    /// Least area of an element that keeps its own stratum at every place, in pixels.
    least: u32,
    /// Area and coverage of each.
    pub(super) report: Vec<StratumReport>,
}

impl CanvasStrata {
    /// The strata of an arrangement; `None` for a homogeneous library, several libraries, or an arrangement
    /// without a correspondence field. `field` is the background of the whole canvas.
    pub(super) fn new(
        plan: &Plan<'_>,
        arrangement: &PlacementResult<'_>,
        field: &Field,
    ) -> Result<Option<Self>> {
        let ([library], Some(correspondence)) = (&*plan.libraries, &arrangement.correspondence) else {
            return Ok(None);
        };
        let params = &plan.params;
        if !library.is_layered() {
            return Ok(None);
        }
        let exemplar = layer_map(library);
        if exemplar.shares().iter().filter(|&&share| share > 0.0).count() < 2 {
            return Ok(None);
        }
        let map = map(&exemplar, correspondence, arrangement, plan)?;
        let of_elements = library.strata_of_elements();
        let least = LayerMap::least_element([library.source.width, library.source.height]);
        let wanted = map.shares();
        let map = map.with_whole_elements(|i| {
            let at = [i % params.width as usize, i / params.width as usize].map(|v| v as i32);
            let top = arrangement.cells.top(at)?;
            own_stratum(library, arrangement, top, &of_elements, least)
        });
        let report = report(library, arrangement, &exemplar, (&wanted, &map));
        let mut strata = Self { map, backgrounds: Vec::new(), of_elements, least, report };
        strata.backgrounds =
            strata.backgrounds(library, &exemplar, (correspondence, arrangement), field, params);
        Ok(Some(strata))
    }

    /// The stratum at a place of the canvas, to which small elements belong.
    fn at(&self, [x, y]: [i32; 2]) -> usize {
        let [w, h] = self.map.size();
        let [x, y] = [(x.max(0) as usize).min(w - 1), (y.max(0) as usize).min(h - 1)];
        self.map.labels.labels[y * w + x] as usize
    }

    /// The stratum of a secondary.
    pub(super) fn of_secondary(&self, placed: &PlacedSecondary) -> usize {
        self.at(placed.place.at)
    }

    /// The stratum of a primary at a place of the canvas.
    pub(super) fn of_primary(
        &self,
        library: &Library,
        arrangement: &PlacementResult<'_>,
        element: PlaceableId,
        at: [i32; 2],
    ) -> usize {
        let own = own_stratum(library, arrangement, element, &self.of_elements, self.least);
        own.map_or_else(|| self.at(at), usize::from)
    }

    /// The layers of the scene without elements, stratum by stratum.
    pub(super) fn layers(&self) -> Vec<Layer> {
        let of = |background: &Layer| {
            ROLES.map(|role| match role {
                Role::Background => background.clone(),
                _ => Layer { name: format!("{} {}", background.name, role.name()), ..Layer::new(role) },
            })
        };
        self.backgrounds.iter().flat_map(of).collect()
    }

    /// The index of the layer of a role in a stratum.
    pub(super) fn layer(stratum: usize, role: Role) -> usize {
        stratum * ROLES.len() + ROLES.iter().position(|r| *r == role).unwrap_or(0)
    }

    /// Removes strata without a place on the canvas: a given map may lack some, and small canvases have no
    /// room for all.
    pub(super) fn drop_empty(layers: Vec<Layer>) -> Vec<Layer> {
        let mut kept = Vec::new();
        for mut stratum in layers.chunks(ROLES.len()).map(<[Layer]>::to_vec) {
            let nowhere = stratum[0].region.as_ref().is_some_and(Outline::is_empty);
            if nowhere {
                (stratum[0].region, stratum[0].field) = (None, None);
            }
            if !nowhere || stratum.iter().any(|layer| !layer.instances.is_empty()) {
                kept.extend(stratum);
            }
        }
        kept
    }

    /// The background of each stratum: the control points of the whole background, each in the stratum's
    /// colour at the nearest place of the exemplar that belongs to it.
    fn backgrounds(
        &self,
        library: &Library,
        exemplar: &LayerMap,
        (correspondence, arrangement): (&Correspondence, &PlacementResult<'_>),
        field: &Field,
        params: &SynthParams,
    ) -> Vec<Layer> {
        let regions = self.map.outlines([params.tile.x, params.tile.y]);
        let primaries = &correspondence.labels()[0];
        let model = arrangement.cells.model();
        let strata = library.strata();
        let mut own: Vec<Vec<usize>> = vec![Vec::new(); strata.len()];
        self.of_elements.iter().enumerate().for_each(|(i, &k)| own[usize::from(k)].push(i));
        let of = |k: usize| {
            let stratum = &strata[k];
            let holds = |x: u32, y: u32| primaries.get(x, y) == 0 && exemplar.labels.get(x, y) as usize == k;
            let secondaries = own[k].iter().map(|&i| &library.elements[i]);
            let secondaries = secondaries.filter(|e| e.category.is_none()).collect();
            let backdrop =
                Backdrop::new(library, &BackgroundPart { field: stratum.field, holds: &holds, secondaries });
            let crisp = crispness(library, &exemplar.labels, k as u32);
            let near = NearbyPlaces::new(&self.map.labels, k as u32, BEYOND * field.spacing);
            let point = |p: &ControlPoint| {
                if !near.holds([p.x, p.y]) {
                    return None;
                }
                let colour = sources(correspondence, field.spacing, [p.x, p.y], |at| {
                    let (_, place) = correspondence.origin(model, at);
                    let label = exemplar.labels.at(place[0] as i64, place[1] as i64);
                    (label == Some(k as u32)).then(|| Colour::from_f64(backdrop.at(place)))
                });
                // If the exemplar's border is soft, both sides take the colours of the whole background.
                let (own, whole) = (colour?.to_f64(), p.colour.to_f64());
                let mixed = [0, 1, 2].map(|c| whole[c] + crisp * (own[c] - whole[c]));
                Some(ControlPoint { colour: Colour::from_f64(mixed), ..*p })
            };
            let points = parallel::map(&field.points, point).into_iter().flatten().collect();
            Layer {
                name: stratum.name().into(),
                region: k.checked_sub(1).map(|above| regions[above].clone()),
                field: Some(Field { spacing: field.spacing, fallback: stratum.colour(), points }),
                ..Layer::new(Role::Background)
            }
        };
        (0..strata.len()).map(of).collect()
    }
}

/// Area and coverage of each stratum. `wanted` are the shares before borders were moved around elements,
/// `got` is the map after that.
fn report(
    library: &Library,
    arrangement: &PlacementResult<'_>,
    exemplar: &LayerMap,
    (wanted, got): (&[f64], &LayerMap),
) -> Vec<StratumReport> {
    let count = exemplar.layers.len();
    let covered = |map: &LayerMap, is_covered: &dyn Fn(usize) -> bool| {
        let mut areas = vec![[0usize; 2]; count];
        for (i, &label) in map.labels.labels.iter().enumerate() {
            areas[label as usize][0] += 1;
            areas[label as usize][1] += usize::from(is_covered(i));
        }
        areas.into_iter().map(|[all, covered]| covered as f64 / all.max(1) as f64).collect::<Vec<_>>()
    };
    let runs = library.arrangement.to_labels();
    let coverage_wanted = covered(exemplar, &|i| runs.labels[i] > 0);
    let width = got.size()[0];
    let coverage =
        covered(got, &|i| arrangement.cells.top([i % width, i / width].map(|v| v as i32)).is_some());
    let area = got.shares();
    let of = |(k, layer): (usize, &MapLayer)| StratumReport {
        name: layer.name.clone(),
        colour: layer.colour,
        area_wanted: wanted[k],
        area: area[k],
        coverage_wanted: coverage_wanted[k],
        coverage: coverage[k],
    };
    exemplar.layers.iter().enumerate().map(of).collect()
}

/// The labels of a canvas: from a given map, or copied along the field.
fn map(
    exemplar: &LayerMap,
    correspondence: &Correspondence,
    arrangement: &PlacementResult<'_>,
    plan: &Plan<'_>,
) -> Result<LayerMap> {
    let params = &plan.params;
    let size = [params.width, params.height];
    let wrap = [params.tile.x, params.tile.y];
    if let Some(StructureGuide::Strata(given)) = &plan.controls.structure {
        let nested = LayerExemplar { map: exemplar, photograph: None };
        return nested.separated(&stretched(given, size), wrap);
    }
    correspondence.layer_map(arrangement.cells.model(), exemplar, size)
}

/// A map stretched to the size of the canvas, by nearest neighbour.
fn stretched(map: &LabelMap, [width, height]: [u32; 2]) -> LabelMap {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    LabelMap { width, height, labels: places.map(|at| map.under(at, [width, height])).collect() }
}

/// The stratum of an element if it is large enough to keep its own.
fn own_stratum(
    library: &Library,
    arrangement: &PlacementResult<'_>,
    element: PlaceableId,
    of_elements: &[u8],
    least: u32,
) -> Option<u8> {
    let index = arrangement.cells.model()[element].index as usize;
    (library.elements[index].area >= least).then(|| of_elements[index])
}

/// Crispness of a stratum's border, 0 to 1: the colour difference between adjacent guide cells across it,
/// relative to that over several cells.
fn crispness(library: &Library, labels: &LabelMap, stratum: u32) -> f64 {
    let Some(guide) = &library.guide else { return 1.0 };
    let cell = guide.cell;
    let size = guide.picture.0.dimensions();
    let label = |x: u32, y: u32| {
        let [x, y] = [x, y].map(|v| v * cell + cell / 2);
        labels.get(x.min(labels.width - 1), y.min(labels.height - 1)) == stratum
    };
    let colour = |x: u32, y: u32| Colour(guide.picture.0.get_pixel(x, y).0).to_oklab();
    let (mut near, mut far) = ([0f64; 3], [0f64; 3]);
    let mut add = |inside: [[u32; 2]; 2], outside: [[u32; 2]; 2]| {
        for (sums, k) in [(&mut near, 0), (&mut far, 1)] {
            let [a, b] = [inside[k], outside[k]].map(|[x, y]| colour(x, y));
            (0..3).for_each(|c| sums[c] += f64::from(a[c] - b[c]));
        }
    };
    for y in FAR..size.1.saturating_sub(FAR) {
        for x in FAR..size.0.saturating_sub(FAR) {
            for [dx, dy] in [[1, 0], [0, 1]] {
                let [own, other] = [label(x, y), label(x + dx, y + dy)];
                let [low, high] = [[x - FAR * dx, y - FAR * dy], [x + FAR * dx, y + FAR * dy]];
                // Only where each side is at least as wide.
                if own == other || label(low[0], low[1]) != own || label(high[0], high[1]) != other {
                    continue;
                }
                let (low, high) = ([[x, y], low], [[x + dx, y + dy], high]);
                if own { add(low, high) } else { add(high, low) }
            }
        }
    }
    let length = |v: [f64; 3]| libm::sqrt(v.iter().map(|v| v * v).sum::<f64>());
    if length(far) == 0.0 {
        return 1.0;
    }
    ((length(near) / length(far) - SOFT[0]) / (SOFT[1] - SOFT[0])).clamp(0.0, 1.0)
}

/// The first value that `value` gives for a place or for places around it, nearest first.
fn sources(
    correspondence: &Correspondence,
    spacing: f64,
    [x, y]: [f64; 2],
    value: impl Fn([f64; 2]) -> Option<Colour>,
) -> Option<Colour> {
    const DIRECTIONS: [[f64; 2]; 8] = [
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [0.0, -1.0],
        [0.7, 0.7],
        [-0.7, 0.7],
        [-0.7, -0.7],
        [0.7, -0.7],
    ];
    let step = f64::from(correspondence.cell());
    let rings = libm::ceil(2.0 * BEYOND * spacing / step) as usize;
    value([x, y]).or_else(|| {
        (1..=rings).find_map(|ring| {
            let reach = ring as f64 * step;
            DIRECTIONS.iter().find_map(|d| value([x + reach * d[0], y + reach * d[1]]))
        })
    })
}

#[cfg(test)]
mod tests;
