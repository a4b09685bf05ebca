//! Secondary textons between the primaries (paper §3.2.2).
//!
//! The paper scatters secondaries one by one over a Poisson-disk set. Where they tile the ground of
//! the exemplar that loses a third of them to overlap and leaves gaps of bare ground, and with them
//! a fifth of the contrast. Here a Poisson-disk set of wider spacing divides the ground into small
//! cells, and each cell takes a neighbourhood of the exemplar: all secondaries around a place whose
//! primaries lie most as they lie in the cell. So secondaries keep their distances, and those that
//! sit beside primaries do so again. Where too few came of it, single ones follow in the gaps.
//!
//! Works badly where secondaries form structures larger than a cell: those are cut.

use super::neighbourhoods::{Exemplar, Sites};
use super::target::TargetMap;
use crate::geometry::Point;
use crate::library::{Library, Secondary};
use crate::parallel;
use crate::raster::colour::Colour;
use crate::sampling::{Area, poisson_disk, stream};
use crate::scene::field::Interpolant;

/// Points per area of a Poisson-disk set of radius 1, as [`poisson_disk`] makes them (measured).
const POISSON_DENSITY: f64 = 0.616;
/// Radius of the cells, in radii of the set that would hold single secondaries.
const CELL: f64 = 3.0;
/// Places of the exemplar compared for each cell.
const CANDIDATES: usize = 8;
/// A secondary is left out unless at least this share of its outline's points can be seen.
const LEAST_VISIBLE: f64 = 0.3;
/// Step of the colours of secondaries, per sRGB component.
const COLOUR_STEP: f64 = 5.0;

/// A secondary texton on the canvas.
pub(super) struct Placed {
    /// Index among the library's secondaries.
    pub(super) secondary: u32,
    /// Place of its origin, in whole pixels.
    pub(super) at: [i32; 2],
    /// Its colour.
    pub(super) colour: Colour,
}

/// Secondaries in the colour of the ground beneath them plus their own difference; as many per area
/// of ground as in the exemplar. Those that primaries hide are left out.
pub(super) fn place(library: &Library, map: &TargetMap<'_>, field: &Interpolant, seed: u64) -> Vec<Placed> {
    let Some(radius) = radius(library) else { return Vec::new() };
    let samples: Vec<Vec<[f64; 2]>> = library.secondaries.textons.iter().map(samples).collect();
    let visible = |k: u32, at: [i32; 2]| visible(map, &samples[k as usize], at) >= LEAST_VISIBLE;
    let mut places = neighbourhoods(library, map, radius, seed);
    places.retain(|&(k, at)| visible(k, at));
    fill_gaps(library, map, radius, seed, &mut places, visible);
    let mut placed = parallel::map(&places, |&(k, at)| {
        let difference = library.secondaries.textons[k as usize].difference;
        let ground = field.at(f64::from(at[0]), f64::from(at[1]));
        let colour = [0, 1, 2].map(|c| ground[c] + f64::from(difference[c]));
        Placed { secondary: k, at, colour: coarse(colour) }
    });
    // Equal fills side by side, for smaller files; secondaries hardly overlap, so which of them is
    // painted first matters little. The order of the fills is mixed, so that no tone is always on top.
    placed.sort_by_key(|p| {
        let [r, g, b] = p.colour.0.map(u32::from);
        ((r << 16 | g << 8 | b).wrapping_mul(0x9e37_79b1), p.at[1], p.at[0], p.secondary)
    });
    placed
}

/// Size of the canvas, in pixels.
fn canvas(map: &TargetMap<'_>) -> [f64; 2] {
    [map.width, map.height].map(|side| f64::from(side - 2 * map.margin))
}

/// A secondary and its place for every secondary of the neighbourhoods chosen.
fn neighbourhoods(library: &Library, map: &TargetMap<'_>, radius: f64, seed: u64) -> Vec<(u32, [i32; 2])> {
    let reach = CELL * radius;
    let [width, height] = canvas(map);
    // Cells just outside reach in.
    let domain = Area::plane(width + 2.0 * reach, height + 2.0 * reach);
    let centres: Vec<[i32; 2]> = poisson_disk(domain, reach, &mut stream(seed, "synth/secondaries", 0))
        .into_iter()
        .map(|p| [0, 1].map(|c| libm::floor(p[c] - reach) as i32))
        .collect();
    let sites = Sites::new(centres, reach);
    let exemplar = Exemplar::new(library, reach);
    let free = |x: i32, y: i32| {
        let (x, y) = (x + map.margin, y + map.margin);
        !map.on_canvas(x, y) || !map.taken(map.index(x, y))
    };
    let indices: Vec<usize> = (0..sites.centres().len()).collect();
    let cells = parallel::map(&indices, |&i| {
        let here = sites.centres()[i];
        let mut random = stream(seed, "synth/neighbourhood", i as u64);
        let source = exemplar.best_source(here, CANDIDATES, free, &mut random);
        let mut found = Vec::new();
        exemplar.around(source, |k, offset| {
            let at = [here[0] + offset[0], here[1] + offset[1]];
            if sites.nearest(at) == i {
                found.push((k, at));
            }
        });
        found
    });
    cells.into_iter().flatten().collect()
}

/// Adds single secondaries, as far as possible from all others, until there are as many per area of
/// free ground as in the exemplar.
fn fill_gaps(
    library: &Library,
    map: &TargetMap<'_>,
    radius: f64,
    seed: u64,
    places: &mut Vec<(u32, [i32; 2])>,
    visible: impl Fn(u32, [i32; 2]) -> bool,
) {
    let [width, height] = canvas(map);
    let covered: f64 = map.covered.iter().map(|&c| c as f64).sum();
    let wanted = POISSON_DENSITY * (width * height - covered) / (radius * radius);
    let missing = wanted - places.len() as f64;
    if missing < 1.0 {
        return;
    }
    let sites = Sites::new(places.iter().map(|p| p.1).collect(), radius);
    let mut random = stream(seed, "synth/secondaries/gaps", 0);
    let mut gaps: Vec<[i32; 2]> = poisson_disk(Area::plane(width, height), radius, &mut random)
        .into_iter()
        .map(|p| p.map(|v| libm::floor(v) as i32))
        .filter(|&at| !sites.any_within(at, radius))
        .collect();
    random.shuffle(&mut gaps);
    let count = library.secondaries.textons.len();
    let singles =
        gaps.into_iter().map(|at| (random.index(count) as u32, at)).filter(|&(k, at)| visible(k, at));
    places.extend(singles.take(missing as usize));
}

/// The colour in steps of [`COLOUR_STEP`], too small to be seen on a speck.
fn coarse(colour: [f64; 3]) -> Colour {
    Colour::from_f64(colour.map(|v| COLOUR_STEP * libm::round(v / COLOUR_STEP)))
}

/// Radius of the Poisson-disk set that holds as many secondaries per area of ground as the
/// exemplar. `None` if there are no secondaries, or no ground to put them on.
///
/// The number per ground is what the eye compares. The library's spacing, a percentile of the
/// distances between neighbours, is in clustered exemplars well below what the number implies.
fn radius(library: &Library) -> Option<f64> {
    let count = library.secondaries.textons.len() as f64;
    let exemplar = f64::from(library.source.width) * f64::from(library.source.height);
    let ground = exemplar * (1.0 - library.coverage);
    (count > 0.0 && ground > 0.0).then(|| libm::sqrt(POISSON_DENSITY * ground / count).max(1.0))
}

/// Origin of a secondary: its centroid in whole pixels.
pub(super) fn origin(secondary: &Secondary) -> [i32; 2] {
    secondary.centroid.map(|v| libm::round(v) as i32)
}

/// Points within a secondary, relative to its origin: its centre, and the points of its outline
/// drawn a little towards it.
fn samples(secondary: &Secondary) -> Vec<[f64; 2]> {
    let origin = origin(secondary).map(f64::from);
    let [cx, cy] = secondary.centroid;
    let inner = |p: Point| [cx + (p.x - cx) * 0.7 - origin[0], cy + (p.y - cy) * 0.7 - origin[1]];
    let ends = secondary.outline.path().elements().iter().filter_map(|e| e.end_point());
    std::iter::once(Point::new(cx, cy)).chain(ends).map(inner).collect()
}

/// Share of the points that lie on the canvas and that no primary covers.
fn visible(map: &TargetMap<'_>, samples: &[[f64; 2]], at: [i32; 2]) -> f64 {
    let free = |p: &&[f64; 2]| {
        let [x, y] = [0, 1].map(|c| at[c] + map.margin + libm::floor(p[c]) as i32);
        map.on_canvas(x, y) && !map.taken(map.index(x, y))
    };
    samples.iter().filter(free).count() as f64 / samples.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_of_poisson_sets_is_as_stated() {
        let mut random = stream(1, "poisson density test", 0);
        let points =
            poisson_disk(Area { wrap_x: true, wrap_y: true, ..Area::plane(100.0, 100.0) }, 1.0, &mut random);
        let density = points.len() as f64 / 1e4;
        assert!((density / POISSON_DENSITY - 1.0).abs() < 0.01, "{density}");
    }
}
