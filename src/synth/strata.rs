//! Strata of a scene: the nested layers of a weathered surface, each with its region, its background
//! and its elements.
//!
//! The correspondence field says from which stratum of the exemplar each cell comes. Regions follow by
//! rank, so that they are nested and of the exemplar's areas, or are those of a given map. Large
//! elements stay whole: borders go around them. Small ones belong where their centre lies, so a
//! border is crisp where backgrounds meet and made of elements where elements are.

mod near;

use super::backdrop::{Backdrop, Part};
use super::secondaries::Placed;
use crate::arrange::Arrangement;
use crate::arrange::controls::{Controls, Lead};
use crate::arrange::correspondence::Correspondence;
use crate::arrange::model::PlaceableId;
use crate::error::Result;
use crate::layers::{Exemplar, Layer as Nested, LayerMap};
use crate::library::{Library, Stratum};
use crate::parallel;
use crate::raster::LabelMap;
use crate::raster::colour::Colour;
use crate::scene::{ControlPoint, Field, Layer, Role, SynthParams};
use near::Near;
use serde::Serialize;

/// Cells of the guide over which the difference across a border is compared with that of one cell.
const FAR: u32 = 4;
/// Shares of that difference at and below which a border is soft, and at and above which it is crisp.
const SOFT: [f64; 2] = [0.25, 0.6];
/// How far control points of a background reach beyond the pixels of its stratum, in spacings.
const BEYOND: f64 = 1.5;

/// The layers of a library's exemplar as a map of its size, one pixel for each of the exemplar's; of a
/// homogeneous one a map of one layer.
pub fn layer_map(library: &Library) -> LayerMap {
    let layer = |s: Stratum<'_>| Nested { name: s.name().into(), colour: s.colour() };
    LayerMap { labels: library.strata_labels(), layers: library.strata().into_iter().map(layer).collect() }
}

/// How much of a canvas a layer has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StratumReport {
    /// Its name.
    pub name: String,
    /// Its colour in layer maps.
    pub colour: Colour,
    /// Share of the area in the exemplar, or in a given map, 0 to 1.
    pub area_wanted: f64,
    /// Share of the canvas, 0 to 1.
    pub area: f64,
    /// Share of the layer that primaries cover in the exemplar, 0 to 1.
    pub coverage_wanted: f64,
    /// The same on the canvas.
    pub coverage: f64,
}

/// The strata of a canvas.
pub(crate) struct Strata {
    map: LayerMap,
    /// Region and field of each.
    backgrounds: Vec<Layer>,
    /// The stratum of each element of the library.
    of_elements: Vec<u8>,
    /// Smallest area of an element that stays in its own stratum wherever it stands, in pixels.
    least: u32,
    /// How much of the canvas each has.
    pub(super) report: Vec<StratumReport>,
}

impl Strata {
    /// The strata of an arrangement; none for a homogeneous library, several libraries, or where elements
    /// were not carried along a field. `field` is the background of the canvas as a whole.
    pub(super) fn new(
        libraries: &[Library],
        controls: &Controls,
        arrangement: &Arrangement<'_>,
        field: &Field,
        params: &SynthParams,
    ) -> Result<Option<Self>> {
        let ([library], Some(correspondence)) = (libraries, &arrangement.correspondence) else {
            return Ok(None);
        };
        if !library.is_layered() {
            return Ok(None);
        }
        let exemplar = layer_map(library);
        if exemplar.shares().iter().filter(|&&share| share > 0.0).count() < 2 {
            return Ok(None);
        }
        let map = map(&exemplar, correspondence, arrangement, controls, params)?;
        let of_elements = library.strata_of_elements();
        let least = LayerMap::least_element([library.source.width, library.source.height]);
        let wanted = map.shares();
        let map = map.settled(|i| {
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

    /// The stratum of a small element at a place of the canvas.
    fn at(&self, [x, y]: [i32; 2]) -> usize {
        let [w, h] = self.map.size();
        let [x, y] = [(x.max(0) as usize).min(w - 1), (y.max(0) as usize).min(h - 1)];
        self.map.labels.labels[y * w + x] as usize
    }

    /// The stratum of a secondary.
    pub(super) fn of_secondary(&self, placed: &Placed) -> usize {
        self.at(placed.at)
    }

    /// The stratum of a primary at a place of the canvas.
    pub(super) fn of_primary(
        &self,
        library: &Library,
        arrangement: &Arrangement<'_>,
        element: PlaceableId,
        at: [i32; 2],
    ) -> usize {
        let own = own_stratum(library, arrangement, element, &self.of_elements, self.least);
        own.map_or_else(|| self.at(at), usize::from)
    }

    /// The layers of the scene, without elements: those of each stratum in turn.
    pub(super) fn layers(&self) -> Vec<Layer> {
        let of = |background: &Layer| {
            let elements = [Role::Secondary, Role::Primary].map(|role| Layer {
                name: format!("{} {}", background.name, role.name()),
                ..Layer::new(role)
            });
            [background.clone()].into_iter().chain(elements)
        };
        self.backgrounds.iter().flat_map(of).collect()
    }

    /// Number of layers of the scene that each stratum has; the background is the first.
    pub(super) const LAYERS: usize = 3;

    /// The backgrounds: points of the background as a whole, each in the colour that the stratum has
    /// at the nearest place of the exemplar that is its own.
    fn backgrounds(
        &self,
        library: &Library,
        exemplar: &LayerMap,
        (correspondence, arrangement): (&Correspondence, &Arrangement<'_>),
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
            let backdrop = Backdrop::new(library, &Part { field: stratum.field, holds: &holds, secondaries });
            let crisp = crispness(library, &exemplar.labels, k as u32);
            let near = Near::new(&self.map.labels, k as u32, BEYOND * field.spacing);
            let point = |p: &ControlPoint| {
                if !near.holds([p.x, p.y]) {
                    return None;
                }
                let colour = sources(correspondence, field.spacing, [p.x, p.y], |at| {
                    let (_, place) = correspondence.origin(model, at);
                    let label = exemplar.labels.at(place[0] as i64, place[1] as i64);
                    (label == Some(k as u32)).then(|| Colour::from_f64(backdrop.at(place)))
                });
                // Where the exemplar's border is soft, both sides have the colours of the whole.
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

/// How much of a canvas each stratum has. `wanted` are the shares before borders went around elements,
/// `got` is the map after it.
fn report(
    library: &Library,
    arrangement: &Arrangement<'_>,
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
    let of = |(k, layer): (usize, &Nested)| StratumReport {
        name: layer.name.clone(),
        colour: layer.colour,
        area_wanted: wanted[k],
        area: area[k],
        coverage_wanted: coverage_wanted[k],
        coverage: coverage[k],
    };
    exemplar.layers.iter().enumerate().map(of).collect()
}

/// The labels of a canvas: those that are given, or those that came along the field.
fn map(
    exemplar: &LayerMap,
    correspondence: &Correspondence,
    arrangement: &Arrangement<'_>,
    controls: &Controls,
    params: &SynthParams,
) -> Result<LayerMap> {
    let size = [params.width, params.height];
    let wrap = [params.tile.x, params.tile.y];
    let nested = Exemplar { map: exemplar, photograph: None };
    if let Some(Lead::Strata(given)) = &controls.lead {
        return nested.parted(&stretched(given, size), wrap);
    }
    let cells = correspondence.labels_of_cells(arrangement.cells.model(), &exemplar.labels, size);
    nested.smoothed_cells(&cells, size.map(|v| v as usize), wrap)
}

/// A map at the size of the canvas; each pixel has the label of the pixel that it lies in.
fn stretched(map: &LabelMap, [width, height]: [u32; 2]) -> LabelMap {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    LabelMap { width, height, labels: places.map(|at| map.under(at, [width, height])).collect() }
}

/// The stratum of an element that keeps its own wherever it stands, because it is large.
fn own_stratum(
    library: &Library,
    arrangement: &Arrangement<'_>,
    element: PlaceableId,
    of_elements: &[u8],
    least: u32,
) -> Option<u8> {
    let index = arrangement.cells.model()[element].index as usize;
    (library.elements[index].area >= least).then(|| of_elements[index])
}

/// How crisp the border of a stratum is, 0 to 1: the difference of colours from one cell of the guide to the
/// next across it, as a share of that over several cells.
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
                // Only where each side goes on for as long.
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

/// The first value that `value` gives for a place, or for places around it, nearer ones first.
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
