//! More or fewer lines where a map of densities says so.
//!
//! Lines are drawn as densely as the densest place asks for. All have a rank, such that the lines of the lowest ranks lie
//! evenly at any number of them: each next line is the one farthest from those before it. A line is shown where the density
//! is above its rank, as in prioritized stroke textures (Winkenbach and Salesin 1994) and tonal art maps (Praun et al.
//! 2001).

use vtex_base::error::Result;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, along, length};
use vtex_base::geometry::{Curve, PathEl};
use vtex_curves::TracedCurve;

/// Distance of the places at which lines are compared, and the farthest that counts, in mean distances of lines.
const STEP: f64 = 0.5;
const FARTHEST: f64 = 10.0;
/// Shortest part of a line that is shown, in mean distances of lines.
const SHORTEST: f64 = 1.0;

/// The parts of curves where the density, 0 to 1, is above their rank.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn thinned(
    curves: Vec<TracedCurve>,
    plane: PeriodicPlane,
    density: impl Fn([f64; 2]) -> f64,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<TracedCurve>> {
    let courses: Vec<Vec<[f64; 2]>> = curves.iter().map(course).collect();
    let lengths: Vec<f64> = courses.iter().map(|c| along(c)).collect();
    let total: f64 = lengths.iter().sum();
    if total <= 0.0 {
        return Ok(curves);
    }
    let spacing = plane.area() / total;
    let order = evenly_ordered(&courses, &lengths, plane, spacing, go_on)?;
    let mut kept: Vec<TracedCurve> = Vec::new();
    let mut before = 0.0;
    for number in order {
        go_on()?;
        let (curve, own) = (&curves[number], lengths[number]);
        let rank = (before + 0.5 * own) / total;
        before += own;
        let Some(path) = Curve::new(curve.path.clone()) else { continue };
        let parts = path.outside(|p| density([p.x, p.y]) <= rank);
        let is_whole = parts.len() == 1 && parts[0].curve == path;
        for part in parts {
            let part = TracedCurve { path: part.curve.path().clone(), ..curve.clone() };
            let long = along(&course(&part));
            if is_whole || long >= SHORTEST * spacing {
                kept.push(TracedCurve { shown_length: part.shown_length * (long / own).min(1.0), ..part });
            }
        }
    }
    Ok(kept)
}

/// The points along a curve.
fn course(curve: &TracedCurve) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    kurbo::flatten(curve.path.iter(), 0.1, |element| {
        let p = if element == PathEl::ClosePath {
            points.first().copied()
        } else {
            element.end_point().map(|p| [p.x, p.y])
        };
        points.extend(p);
    });
    points
}

/// The numbers of courses, each as far from those before it as can be. Short ones, which look like crumbs where they
/// are alone, come later.
///
/// # Errors
/// Those of `go_on`.
fn evenly_ordered(
    courses: &[Vec<[f64; 2]>],
    lengths: &[f64],
    plane: PeriodicPlane,
    spacing: f64,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<usize>> {
    let (mut places, mut of): (Vec<[f64; 2]>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut starts = Vec::with_capacity(courses.len());
    for (number, course) in courses.iter().enumerate() {
        starts.push(places.len());
        places.extend(places_along(course, STEP * spacing));
        of.resize(places.len(), number);
    }
    starts.push(places.len());
    let farthest = FARTHEST * spacing;
    let index = PointIndex::new(plane, farthest, &places);
    // Distance of each place to the nearest line that has a rank, and its sum over each line.
    let mut near = vec![farthest; places.len()];
    let count = |number: usize| (starts[number + 1] - starts[number]).max(1) as f64;
    let mut sums: Vec<f64> = (0..courses.len()).map(|number| count(number) * farthest).collect();
    let mut sorted = lengths.to_vec();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2].max(1e-9);
    let mut left: Vec<usize> = (0..courses.len()).collect();
    let mut order = Vec::with_capacity(courses.len());
    while !left.is_empty() {
        go_on()?;
        let merit = |number: usize| (lengths[number] / usual).min(1.0) * sums[number] / count(number);
        let best =
            (1..left.len()).fold(0, |best, k| if merit(left[k]) > merit(left[best]) { k } else { best });
        let number = left.remove(best);
        order.push(number);
        for place in starts[number]..starts[number + 1] {
            index.within(places[place], farthest, |other, way| {
                let far = length(way);
                if far < near[other] {
                    sums[of[other]] -= near[other] - far;
                    near[other] = far;
                }
            });
        }
    }
    Ok(order)
}

/// Places along a course, about every `step`, its first point among them.
fn places_along(course: &[[f64; 2]], step: f64) -> impl Iterator<Item = [f64; 2]> {
    let first = course.first().copied();
    let mut walked = 0.0;
    let further = course.windows(2).flat_map(move |w| {
        let way = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let (from, long) = (walked, length(way));
        walked += long;
        let [low, high] = [from, walked].map(|v| libm::floor(v / step) as usize);
        (low + 1..=high).map(move |k| {
            let share = if long > 0.0 { (k as f64 * step - from) / long } else { 0.0 };
            [w[0][0] + share * way[0], w[0][1] + share * way[1]]
        })
    });
    first.into_iter().chain(further)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::parse_path;

    const PLANE: PeriodicPlane = PeriodicPlane { size: [200.0, 160.0], wraps: [false; 2] };

    /// Forty lines from the left to the right, four units apart.
    fn lines() -> Vec<TracedCurve> {
        let line = |k: usize| {
            let path = parse_path(&format!("M0 {}H200", 2 + 4 * k)).unwrap();
            TracedCurve { path, style: 0, shown_length: 200.0 }
        };
        (0..40).map(line).collect()
    }

    fn heights(of: &[TracedCurve]) -> Vec<f64> {
        let mut all: Vec<f64> = of.iter().map(|c| course(c)[0][1]).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn lines_that_stay_lie_evenly() {
        for share in [0.125, 0.25, 0.5] {
            let kept = heights(&thinned(lines(), PLANE, |_| share, &|| Ok(())).unwrap());
            let wanted = 40.0 * share;
            assert!((kept.len() as f64 - wanted).abs() <= 1.0, "{} of {wanted}", kept.len());
            let widest = kept.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
            assert!(widest <= 2.1 * 160.0 / wanted, "{share}: {kept:?}");
        }
    }

    #[test]
    fn length_follows_the_density() {
        let kept = thinned(lines(), PLANE, |p| p[0] / 200.0, &|| Ok(())).unwrap();
        let mut quarters = [0.0; 4];
        for [from, to] in kept.iter().map(|c| [course(c)[0][0], course(c).last().unwrap()[0]]) {
            for (k, quarter) in quarters.iter_mut().enumerate() {
                let [low, high] = [50.0 * k as f64, 50.0 * (k + 1) as f64];
                *quarter += (to.min(high) - from.max(low)).max(0.0);
            }
        }
        for (k, quarter) in quarters.iter().enumerate() {
            let wanted = 2000.0 * (k as f64 + 0.5) / 4.0;
            assert!((quarter - wanted).abs() < 120.0, "{quarters:?}");
        }
    }

    #[test]
    fn all_or_nothing() {
        let of = |share: f64| thinned(lines(), PLANE, move |_| share, &|| Ok(())).unwrap();
        assert_eq!(heights(&of(1.0)), heights(&lines()));
        assert!(of(0.0).is_empty());
    }
}
