//! Secondaries between the primaries (paper §3.2.2).
//!
//! The paper scatters secondaries one by one over a Poisson-disk set. Where they tile the background of the
//! exemplar, this loses a third of them to overlap and leaves gaps of bare background, and a fifth of the
//! contrast is lost. Here a sparser Poisson-disk set divides the background into small cells. Each cell
//! takes a neighbourhood of the exemplar: all secondaries around a place whose primaries best match those
//! around the cell. Secondaries thus keep their distances to each other and to primaries. Single ones fill
//! the gaps that remain.
//!
//! Works badly where secondaries form structures larger than a cell, because these are cut.

use super::neighbourhoods::ExemplarSecondaries;
use crate::arrange::correspondence::{Correspondence, SecondaryPlace};
use crate::arrange::occupancy::Occupancy;
use crate::arrange::sites::{Sites, scattered};
use crate::arrange::variation::Variation;
use crate::arrange::{PlacementResult, Plan};
use vtex_base::geometry::Point;
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::{Stream, stream};
use vtex_scene::library::{ExemplarElement, Library};
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Ablation, SynthParams};

/// Points per area of a Poisson-disk set of radius 1 made by [`poisson_disk`] (measured).
const POISSON_DENSITY: f64 = 0.616;
/// Radius of the cells, relative to the radius of a set of single secondaries.
pub(crate) const CELL: f64 = 3.0;
/// Places of the exemplar compared for each cell.
const CANDIDATES: usize = 8;
/// Least visible share of a secondary's outline points; below it, the secondary is left out.
const LEAST_VISIBLE: f64 = 0.3;
/// Quantisation step of secondaries' colours, per sRGB component.
const COLOUR_STEP: f64 = 5.0;
/// Quantisation step of the colours of soft secondaries. It is larger because each colour is a brush of the
/// file.
const SPOT_STEP: f64 = 12.0;

/// A secondary on the canvas.
#[derive(Clone, Copy)]
pub(crate) struct PlacedSecondary {
    /// Index of its library.
    pub(crate) library: usize,
    pub(crate) place: SecondaryPlace,
    /// Its colour.
    pub(crate) colour: Colour,
}

/// Places secondaries. Each has the colour of the background beneath it plus its own difference. Their
/// number per area of background is the exemplar's, times the density map. Those hidden by primaries are
/// left out.
pub(crate) fn place(
    plan: &Plan<'_>,
    arrangement: &PlacementResult<'_>,
    field: &Interpolant,
) -> Vec<PlacedSecondary> {
    let (params, map) = (&plan.params, &arrangement.cells);
    if params.without(Ablation::Secondary) {
        return Vec::new();
    }
    let correspondence = arrangement.correspondence.as_ref();
    let came = correspondence.map_or_else(Vec::new, |c| copied(plan, map, c));
    if map.region.all_carried() {
        return came;
    }
    let parts = SecondaryRegions::new(plan, map);
    let mut placed = Vec::new();
    for (number, library) in plan.libraries.iter().enumerate() {
        let Some(radius) = radius(library) else { continue };
        let task = SecondaryTask { number, library, map, radius, params };
        placed.extend(task.places(&parts).into_iter().map(|place| task.placed(place)));
    }
    let mut placed = painted(plan, placed, field);
    placed.extend(came);
    placed.sort_by_key(|p| p.painting_key(plan));
    placed
}

/// Secondaries copied along the correspondence field. They keep their exemplar colours, because the
/// background beneath them is copied too.
fn copied(plan: &Plan<'_>, map: &Occupancy<'_>, correspondence: &Correspondence) -> Vec<PlacedSecondary> {
    let mut placed = Vec::new();
    let mut random = stream(plan.params.seed, "correspondence/secondaries", 0);
    for (number, library) in plan.libraries.iter().enumerate() {
        let samples: Vec<Vec<[f64; 2]>> = library.secondaries().iter().map(samples).collect();
        let placed_at = |place: SecondaryPlace| {
            let own = &library.secondaries()[place.secondary as usize];
            let colour =
                if own.base().is_soft() { own.colour } else { coarse(own.colour.to_f64(), COLOUR_STEP) };
            PlacedSecondary { library: number, place, colour }
        };
        let arrived = correspondence.secondaries(library, number, map.model());
        let mut came: Vec<PlacedSecondary> = arrived.into_iter().map(placed_at).collect();
        if !map.region.is_plain() {
            came.retain(|p| {
                let level = map.region.density(p.place.at.map(f64::from));
                is_served(map, p.place.at) && (level >= 1.0 || random.chance(level))
            });
        }
        let seen = |p: &PlacedSecondary| {
            visible(map, &samples[p.place.secondary as usize], &p.place) >= LEAST_VISIBLE
        };
        let seen = parallel::map(&came, seen).into_iter();
        placed.extend(came.into_iter().zip(seen).filter(|c| c.1).map(|c| c.0));
    }
    placed.sort_by_key(|p| p.painting_key(plan));
    placed
}

/// Whether a place of the canvas is covered by the correspondence field.
fn is_served(map: &Occupancy<'_>, at: [i32; 2]) -> bool {
    let at = [0, 1].map(|k| at[k] + map.grid.margin[k]);
    map.grid.canvas_cell(at).is_some_and(|i| map.region.cell_is_carried(i))
}

/// Gives each secondary the colour of the background beneath it plus its own difference. Colours are clamped
/// to the range of the exemplar's secondaries: dark flecks of a pale background would become too dark on a
/// dark one.
pub(crate) fn painted(
    plan: &Plan<'_>,
    placed: Vec<PlacedSecondary>,
    field: &Interpolant,
) -> Vec<PlacedSecondary> {
    let is_matched = !plan.params.without(Ablation::Matching);
    let tones: Vec<[[f64; 2]; 3]> = plan.libraries.iter().map(tones).collect();
    parallel::map(&placed, |p| {
        let secondary = &plan.libraries[p.library].secondaries()[p.place.secondary as usize];
        let difference = secondary.difference.unwrap_or_default();
        let background = field.at(f64::from(p.place.at[0]), f64::from(p.place.at[1]));
        let matched = |c: usize| {
            let [least, most] = tones[p.library][c];
            (background[c] + f64::from(difference[c])).clamp(least, most)
        };
        let colour = if is_matched { [0, 1, 2].map(matched) } else { secondary.colour.to_f64() };
        let step = if secondary.base().is_soft() { SPOT_STEP } else { COLOUR_STEP };
        PlacedSecondary { colour: coarse(colour, step), ..*p }
    })
}

/// Range of each component among the secondaries of a library, without the outermost hundredth at either
/// end.
fn tones(library: &Library) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|c| {
        let mut values: Vec<u8> = library.secondaries().iter().map(|s| s.colour.0[c]).collect();
        values.sort_unstable();
        let beyond = values.len() / 100;
        match (values.get(beyond), values.len().checked_sub(beyond + 1)) {
            (Some(&least), Some(last)) => [f64::from(least), f64::from(values[last])],
            _ => [0.0, 255.0],
        }
    })
}

impl PlacedSecondary {
    /// Sort key for painting. Soft ones lie below, in the order of the exemplar. Others hardly overlap, so
    /// their order is nearly free: equal fills are adjacent, which makes files smaller, and the order of
    /// fills is random, so that no tone is always on top.
    pub(crate) fn painting_key(&self, plan: &Plan<'_>) -> impl Ord + use<> {
        let SecondaryPlace { secondary, at, .. } = self.place;
        let is_soft = plan.libraries[self.library].secondaries()[secondary as usize].base().is_soft();
        let [r, g, b] = self.colour.0.map(u32::from);
        let colour = (r << 16 | g << 8 | b).wrapping_mul(0x9e37_79b1);
        let order = if is_soft { secondary } else { colour };
        (!is_soft, order, at[1], at[0], self.library, secondary)
    }
}

/// The parts of the canvas that each library's secondaries fill.
struct SecondaryRegions {
    /// Sites and the library of each; `None` for a single library.
    sites: Option<(Sites, Vec<usize>)>,
}

impl SecondaryRegions {
    /// Divides the canvas into cells the size of a neighbourhood, and draws the library of each by its share.
    fn new(plan: &Plan<'_>, map: &Occupancy<'_>) -> Self {
        let reach = plan.libraries.iter().filter_map(radius).fold(f64::INFINITY, f64::min) * CELL;
        if plan.libraries.len() < 2 || !reach.is_finite() {
            return Self { sites: None };
        }
        let mut random = stream(plan.params.seed, "synth/secondaries/lands", 0);
        let sites = scattered(&map.grid, reach, reach, &mut random);
        let library = |p: &[i32; 2]| map.region.draw_library(p.map(f64::from), &mut random);
        let of = sites.centres().to_vec().iter().map(library).collect();
        Self { sites: Some((sites, of)) }
    }

    fn belongs(&self, at: [i32; 2], library: usize) -> bool {
        self.sites.as_ref().is_none_or(|(sites, of)| sites.owner(at).is_some_and(|site| of[site] == library))
    }
}

/// The secondaries of one library.
struct SecondaryTask<'t, 'a> {
    number: usize,
    library: &'t Library,
    map: &'t Occupancy<'a>,
    /// Radius of a Poisson-disk set of the exemplar's density of secondaries, in pixels.
    radius: f64,
    params: &'t SynthParams,
}

impl SecondaryTask<'_, '_> {
    /// A placed secondary without a colour yet.
    fn placed(&self, place: SecondaryPlace) -> PlacedSecondary {
        PlacedSecondary { library: self.number, place, colour: Colour([0; 3]) }
    }

    fn places(&self, parts: &SecondaryRegions) -> Vec<SecondaryPlace> {
        let samples: Vec<Vec<[f64; 2]>> = self.library.secondaries().iter().map(samples).collect();
        let fits = |p: &SecondaryPlace| {
            !is_served(self.map, p.at)
                && parts.belongs(p.at, self.number)
                && visible(self.map, &samples[p.secondary as usize], p) >= LEAST_VISIBLE
        };
        let mut places = Vec::new();
        if !self.params.without(Ablation::Neighbourhoods) {
            places = self.neighbourhoods();
            places.retain(&fits);
        }
        self.fill_gaps(&mut places, fits);
        places
    }

    /// All secondaries of the chosen neighbourhoods.
    fn neighbourhoods(&self) -> Vec<SecondaryPlace> {
        let (map, seed) = (self.map, self.params.seed);
        let reach = CELL * self.radius;
        // Each library has its own stream, so its draws do not depend on the others.
        let item = |i: usize| (self.number as u64) << 40 | i as u64;
        // Cells just outside the canvas reach into it.
        let sites = scattered(&map.grid, reach, reach, &mut stream(seed, "synth/secondaries", item(0)));
        let exemplar = ExemplarSecondaries::new(self.library, reach);
        let indices: Vec<usize> = (0..sites.centres().len()).collect();
        let cells = parallel::map(&indices, |&i| {
            let mut random = stream(seed, "synth/neighbourhood", item(i));
            let cell = sites.cell(i);
            self.neighbourhood(&exemplar, sites.centres()[i], |at| cell.owns(at), &mut random)
        });
        cells.into_iter().flatten().collect()
    }

    /// The secondaries of an exemplar neighbourhood that matches a place, where they fall into its cell.
    fn neighbourhood(
        &self,
        exemplar: &ExemplarSecondaries,
        here: [i32; 2],
        in_cell: impl Fn([i32; 2]) -> bool,
        random: &mut Stream,
    ) -> Vec<SecondaryPlace> {
        let map = self.map;
        let [mx, my] = map.grid.margin;
        let free = |x: i32, y: i32| {
            let at = [x + mx, y + my];
            !map.inside(at) || map.grid.cell(at).is_none_or(|i| !map.taken(i))
        };
        let variations = &map.model().variations;
        let variation = drawn(variations, random);
        let varied = &variations[usize::from(variation)];
        let source = exemplar.best_source(here, CANDIDATES, varied, free, random);
        let mut found = Vec::new();
        exemplar.around(source, |secondary, offset| {
            let [dx, dy] = varied.mapped_pixel(offset);
            let at = [here[0] + dx, here[1] + dy];
            if in_cell(at) {
                let density = map.region.density(at.map(f64::from));
                if density >= 1.0 || random.chance(density) {
                    found.push(SecondaryPlace { secondary, at: self.canonical(at), variation });
                }
            }
        });
        found
    }

    /// Wraps a place into the canvas where the canvas repeats.
    fn canonical(&self, at: [i32; 2]) -> [i32; 2] {
        let [mx, my] = self.map.grid.margin;
        let [x, y] = self.map.grid.canonical([at[0] + mx, at[1] + my]);
        [x - mx, y - my]
    }

    /// Adds single secondaries in the gaps until the wanted number per area of free background is reached.
    fn fill_gaps(&self, places: &mut Vec<SecondaryPlace>, fits: impl Fn(&SecondaryPlace) -> bool) {
        let (map, radius) = (self.map, self.radius);
        let categories = map.model().sources[self.number].categories.clone();
        let background = |zone: usize| {
            let covered = map.covered_in(zone, categories.clone());
            map.region.level(zone) * (map.region.area(zone, self.number) - covered as f64).max(0.0)
        };
        let zones = (0..map.region.zone_count()).filter(|&z| !map.region.is_carried(z));
        let wanted = POISSON_DENSITY * zones.clone().map(background).sum::<f64>() / (radius * radius);
        let missing = wanted - places.len() as f64;
        if missing < 1.0 {
            return;
        }
        // Where the density exceeds the exemplar's, single secondaries stand closer together.
        let closer = |density: f64| radius / libm::sqrt(density.max(1.0));
        let used = zones.filter(|&z| map.region.area(z, self.number) > 0.0);
        let densest = used.map(|z| map.region.level(z)).fold(1.0, f64::max);
        let (canvas, tile) = (map.grid.canvas(), map.grid.tile);
        let sites = Sites::new(places.iter().map(|p| p.at).collect(), radius, canvas, tile);
        let item = (self.number as u64) << 40;
        let mut random = stream(self.params.seed, "synth/secondaries/gaps", item);
        let mut gaps = scattered(&map.grid, closer(densest), 0.0, &mut random).centres().to_vec();
        gaps.retain(|&at| {
            let density = map.region.density(at.map(f64::from));
            !sites.any_within(at, closer(density)) && (density >= 1.0 || random.chance(density))
        });
        random.shuffle(&mut gaps);
        let count = self.library.secondaries().len();
        let variations = &map.model().variations;
        let single = |at| {
            let secondary = random.index(count) as u32;
            SecondaryPlace { secondary, at, variation: drawn(variations, &mut random) }
        };
        let singles = gaps.into_iter().map(single).filter(fits);
        places.extend(singles.take(missing as usize));
    }
}

/// Secondaries of one library for the gaps of an existing arrangement.
pub(crate) struct SecondaryFinder<'t, 'a> {
    task: SecondaryTask<'t, 'a>,
    exemplar: ExemplarSecondaries,
    samples: Vec<Vec<[f64; 2]>>,
}

impl<'t, 'a> SecondaryFinder<'t, 'a> {
    /// For a library by its number; `None` if it has no secondaries.
    pub(crate) fn new(
        number: usize,
        library: &'t Library,
        map: &'t Occupancy<'a>,
        params: &'t SynthParams,
    ) -> Option<Self> {
        let radius = radius(library)?;
        let samples = library.secondaries().iter().map(samples).collect();
        let exemplar = ExemplarSecondaries::new(library, CELL * radius);
        Some(Self { task: SecondaryTask { number, library, map, radius, params }, exemplar, samples })
    }

    /// Radius of a Poisson-disk set of the exemplar's density of secondaries, in pixels.
    pub(crate) fn radius(&self) -> f64 {
        self.task.radius
    }

    /// Whether enough of a secondary is visible.
    pub(crate) fn is_visible(&self, place: &SecondaryPlace) -> bool {
        visible(self.task.map, &self.samples[place.secondary as usize], place) >= LEAST_VISIBLE
    }

    /// The secondaries of an exemplar neighbourhood that matches a place, where they fall into its cell.
    pub(crate) fn neighbourhood(
        &self,
        here: [i32; 2],
        in_cell: impl Fn([i32; 2]) -> bool,
        random: &mut Stream,
    ) -> Vec<PlacedSecondary> {
        let mut places = self.task.neighbourhood(&self.exemplar, here, in_cell, random);
        places.retain(|place| self.is_visible(place));
        places.into_iter().map(|place| self.task.placed(place)).collect()
    }

    /// Single secondaries in the gaps between existing ones, where the library has more than half the share.
    pub(crate) fn fill_gaps(&self, standing: Vec<[i32; 2]>) -> Vec<PlacedSecondary> {
        let mut places: Vec<SecondaryPlace> =
            standing.into_iter().map(|at| SecondaryPlace { secondary: 0, at, variation: 0 }).collect();
        let count = places.len();
        let region = &self.task.map.region;
        let own =
            |at: [i32; 2]| !region.is_shared() || region.shares(at.map(f64::from))[self.task.number] > 0.5;
        self.task.fill_gaps(&mut places, |place| own(place.at) && self.is_visible(place));
        places.drain(count..).map(|place| self.task.placed(place)).collect()
    }
}

/// A random variation; a single one needs no draw.
fn drawn(variations: &[Variation], random: &mut Stream) -> u16 {
    if variations.len() > 1 { random.index(variations.len()) as u16 } else { 0 }
}

/// The colour quantised to a step too small to be visible on a speck.
fn coarse(colour: [f64; 3], step: f64) -> Colour {
    Colour::from_f64(colour.map(|v| step * libm::round(v / step)))
}

/// Radius of a Poisson-disk set with the exemplar's number of secondaries per area of background. `None`
/// without secondaries or without background.
///
/// The number per area is what the eye compares. The library's spacing, a percentile of the distances
/// between neighbours, is far smaller in clustered exemplars than this number implies.
fn radius(library: &Library) -> Option<f64> {
    let count = library.secondaries().len() as f64;
    let exemplar = f64::from(library.source.width) * f64::from(library.source.height);
    let background = exemplar * (1.0 - library.coverage);
    (count > 0.0 && background > 0.0).then(|| libm::sqrt(POISSON_DENSITY * background / count).max(1.0))
}

/// Sample points of a secondary, relative to its origin: its centre and the points of its outline, moved a
/// little towards the centre.
fn samples(secondary: &ExemplarElement) -> Vec<[f64; 2]> {
    let origin = secondary.origin().map(f64::from);
    let [cx, cy] = secondary.centroid;
    let inner = |p: Point| [cx + (p.x - cx) * 0.7 - origin[0], cy + (p.y - cy) * 0.7 - origin[1]];
    let ends = secondary.outline().path().elements().iter().filter_map(|e| e.end_point());
    std::iter::once(Point::new(cx, cy)).chain(ends).map(inner).collect()
}

/// Share of the sample points that lie in the domain and are not covered by primaries.
fn visible(map: &Occupancy<'_>, samples: &[[f64; 2]], place: &SecondaryPlace) -> f64 {
    let variation = &map.model().variations[usize::from(place.variation)];
    let free = |p: &&[f64; 2]| {
        let p = variation.of_point(**p);
        let at = [0, 1].map(|k| place.at[k] + map.grid.margin[k] + libm::floor(p[k]) as i32);
        map.inside(at) && map.grid.cell(at).is_some_and(|i| !map.taken(i))
    };
    samples.iter().filter(free).count() as f64 / samples.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::{Area, poisson_disk};

    #[test]
    fn density_of_poisson_sets_is_as_stated() {
        let mut random = stream(1, "poisson density test", 0);
        let points =
            poisson_disk(Area { wrap_x: true, wrap_y: true, ..Area::plane(100.0, 100.0) }, 1.0, &mut random);
        let density = points.len() as f64 / 1e4;
        assert!((density / POISSON_DENSITY - 1.0).abs() < 0.01, "{density}");
    }

    #[test]
    fn no_secondary_is_darker_or_lighter_than_those_of_the_exemplar() {
        let library = vtex_scene::library::testing::library(&vtex_base::raster::LabelMap::filled(40, 40, 0));
        let own = library.secondaries()[0].clone();
        let secondary = |r: u8| ExemplarElement {
            colour: vtex_base::raster::colour::Colour([r, 90, 200]),
            ..own.clone()
        };
        let library = library.without_secondaries();
        assert_eq!(tones(&library), [[0.0, 255.0]; 3]);
        let library = library.with_secondaries((0..=200).map(secondary).collect());
        assert_eq!(tones(&library), [[2.0, 198.0], [90.0, 90.0], [200.0, 200.0]]);
    }
}
