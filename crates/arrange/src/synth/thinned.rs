//! Fewer elements of a drawing where a map of densities says so.
//!
//! Elements are arranged as if there were no map. Then each, or each whole motif, has a rank such that those of the lowest
//! ranks lie evenly at any number of them ([`even_ranks`]), and stays where the density is above its rank. So rows and
//! distances remain those of the drawing, up to what is left out.

use super::compose::Arranged;
use crate::arrange::Plan;
use vtex_base::error::Result;
use vtex_base::geometry::Point;
use vtex_base::geometry::plane::PeriodicPlane;
use vtex_base::progress::{Progress, advance};
use vtex_base::sampling::{even_ranks, stream};

/// Densities up to this are those of the drawing: middle grey of a map of 8 bits is a little more than 1.
const WHOLE: f64 = 1.01;

/// Leaves out what the plan's map of densities does not ask for. Its coverage is counted in the scene, in `stage`.
///
/// # Errors
/// Those of `progress`.
pub(super) fn thin(
    arranged: &mut Arranged<'_>,
    plan: &Plan<'_>,
    stage: &'static str,
    progress: &dyn Progress,
) -> Result<()> {
    if plan.controls.density.is_none() {
        return Ok(());
    }
    advance(progress, stage, 1, 2)?;
    let canvas = [plan.params.width, plan.params.height].map(f64::from);
    let plane = PeriodicPlane { size: canvas, wraps: [plan.params.tile.x, plan.params.tile.y] };
    let density = |at: Point| plan.controls.density_at(plane.wrapped([at.x, at.y]), canvas);
    if plan.controls.largest_density() > WHOLE {
        progress.warn_of_placing(
            "the map of densities asks for more elements than the drawing has: where it is lighter than middle grey there \
             are as many as in the drawing; '--method descriptor' places more, without the drawing's order",
        );
    }
    let number = arranged.thing_numbers();
    let count = number.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![([0.0; 2], 0.0); count];
    for (placement, &thing) in arranged.placements.iter().zip(&number) {
        let [.., x, y] = placement.transform;
        let (sum, parts) = &mut sums[thing];
        *sum = [sum[0] + x, sum[1] + y];
        *parts += 1.0;
    }
    let places: Vec<Point> = sums.iter().map(|([x, y], parts)| Point::new(x / parts, y / parts)).collect();
    let stays = shown(&places, plane, plan.params.seed, density);
    let mut of = number.iter();
    arranged.placements.retain(|_| of.next().is_some_and(|&thing| stays[thing]));
    arranged.report.wanted_times(plan.controls.mean_density(1.0));
    arranged.counted = Some(stage);
    Ok(())
}

/// Whether what is at each place stays where the density, 0 to 1, is as given.
pub(super) fn shown(
    places: &[Point],
    plane: PeriodicPlane,
    seed: u64,
    density: impl Fn(Point) -> f64,
) -> Vec<bool> {
    let mut random = stream(seed, "synth/thinned", 0);
    let ties: Vec<u64> = places.iter().map(|_| random.bits()).collect();
    let periods = [0, 1].map(|k| plane.wraps[k].then_some(plane.size[k]));
    let ranks = even_ranks(places, &ties, periods);
    places.iter().zip(ranks).map(|(at, rank)| density(*at) > rank).collect()
}

#[cfg(test)]
mod tests {
    use crate::synth::testing::{Warnings, drawing_of};
    use crate::synth::{Controls, synthesize_with};
    use vtex_base::raster::{ControlMap, LabelMap};
    use vtex_scene::library::Library;
    use vtex_scene::scene::{Method, SynthParams};

    /// Six times six squares, a little out of line.
    fn drawing() -> Library {
        let mut map = LabelMap::filled(120, 120, 0);
        for k in 0..36u32 {
            let (x0, y0) = (4 + k % 6 * 20 + k * 7 % 4, 4 + k / 6 * 20 + k * 5 % 3);
            for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x0 + x, y0 + y))) {
                map.labels[(y * 120 + x) as usize] = k + 1;
            }
        }
        drawing_of(&map)
    }

    /// The places of elements on a canvas, and the warnings, for a map of two densities side by side.
    fn places(
        library: &Library,
        method: Method,
        densities: Option<[f32; 2]>,
    ) -> (Vec<[f64; 2]>, Vec<String>) {
        let density = densities.map(|v| ControlMap::new(2, 1, v.to_vec()).unwrap());
        let controls = Controls { density, ..Controls::default() };
        let params = SynthParams { width: 480, height: 240, seed: 3, ..SynthParams::default() };
        let warnings = Warnings::default();
        let made = synthesize_with(std::slice::from_ref(library), &params, &controls, &warnings);
        let (scene, report) = made.unwrap();
        scene.check().unwrap();
        assert_eq!(report.method, method);
        let off = (report.coverage - report.coverage_wanted).abs();
        assert!(off < 0.03, "{} of {}", report.coverage, report.coverage_wanted);
        let all = scene.instances().map(|i| [i.transform[4], i.transform[5]]).collect();
        (all, warnings.0.into_inner().unwrap())
    }

    #[test]
    fn a_map_leaves_out_elements_evenly_and_moves_none() {
        let mut library = drawing();
        let methods: &[Method] = if cfg!(feature = "clustered") {
            &[Method::Period, Method::Clustered]
        } else {
            &[Method::Period]
        };
        for &method in methods {
            library.arrangement.periodic = method == Method::Period;
            let (whole, _) = places(&library, method, None);
            let (same, warnings) = places(&library, method, Some([1.0, 1.0]));
            assert!(same == whole && warnings.is_empty());
            let (most, warnings) = places(&library, method, Some([2.0, 1.0]));
            assert!(most == whole && warnings.len() == 1, "{warnings:?}");
            assert!(places(&library, method, Some([0.0, 0.0])).0.is_empty());
            let (half, _) = places(&library, method, Some([0.5, 0.5]));
            assert!(half.iter().all(|at| whole.contains(at)));
            let share = half.len() as f64 / whole.len() as f64;
            assert!((share - 0.5).abs() < 0.02, "{share}");
            // About half of the elements of each window stay.
            for (x, y) in
                (0..5).flat_map(|y| (0..11).map(move |x| (f64::from(x) * 40.0, f64::from(y) * 40.0)))
            {
                let is_in = |at: &&[f64; 2]| (x..x + 80.0).contains(&at[0]) && (y..y + 80.0).contains(&at[1]);
                let [count, all] = [&half, &whole].map(|places| places.iter().filter(is_in).count());
                assert!(4 * count > all && 4 * count < 3 * all, "{method:?} {count} of {all} at {x} {y}");
            }
            let (ramp, _) = places(&library, method, Some([0.0, 1.0]));
            let counts =
                [0.0, 240.0].map(|x0| ramp.iter().filter(|at| (x0..x0 + 240.0).contains(&at[0])).count());
            assert!(3 * counts[0] < 2 * counts[1] && counts[0] > 0, "{counts:?}");
        }
    }
}
