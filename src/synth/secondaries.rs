//! Secondary textons between the primaries (paper §3.2.2).

use super::target::TargetMap;
use crate::geometry::Point;
use crate::library::{Library, Secondary};
use crate::raster::colour::Colour;
use crate::sampling::{Domain, poisson_disk, stream};
use crate::scene::field::Interpolant;

/// Points per area of a Poisson-disk set of radius 1, as [`poisson_disk`] makes them (measured).
const POISSON_DENSITY: f64 = 0.616;
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

/// Secondaries at Poisson-disk places, each drawn at random, in the colour of the ground there
/// plus its own difference. Those that primaries hide are left out.
pub(super) fn place(library: &Library, map: &TargetMap<'_>, field: &Interpolant, seed: u64) -> Vec<Placed> {
    let textons = &library.secondaries.textons;
    let Some(radius) = radius(library) else { return Vec::new() };
    let mut random = stream(seed, "synth/secondaries", 0);
    let canvas = [map.width - 2 * map.margin, map.height - 2 * map.margin];
    // Those just outside may reach in.
    let domain = Domain::plane(f64::from(canvas[0]) + 2.0 * radius, f64::from(canvas[1]) + 2.0 * radius);
    let places = poisson_disk(domain, radius, &mut random);
    let samples: Vec<Vec<[f64; 2]>> = textons.iter().map(samples).collect();
    let mut placed = Vec::new();
    for place in places {
        let k = random.index(textons.len());
        let at = [0, 1].map(|c| libm::floor(place[c] - radius) as i32);
        if visible(map, &samples[k], at) < LEAST_VISIBLE {
            continue;
        }
        let ground = field.at(f64::from(at[0]), f64::from(at[1]));
        let colour = [0, 1, 2].map(|c| ground[c] + f64::from(textons[k].difference[c]));
        placed.push(Placed { secondary: k as u32, at, colour: coarse(colour) });
    }
    // Equal fills side by side, for smaller files; secondaries hardly overlap, so which of them is
    // painted first matters little. The order of the fills is mixed, so that no tone is always on top.
    placed.sort_by_key(|p| {
        let [r, g, b] = p.colour.0.map(u32::from);
        ((r << 16 | g << 8 | b).wrapping_mul(0x9e37_79b1), p.at[1], p.at[0])
    });
    placed
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
        let points = poisson_disk(
            Domain { wrap_x: true, wrap_y: true, ..Domain::plane(100.0, 100.0) },
            1.0,
            &mut random,
        );
        let density = points.len() as f64 / 1e4;
        assert!((density / POISSON_DENSITY - 1.0).abs() < 0.01, "{density}");
    }
}
