//! The painting order in which elements that have grown do not cover smaller ones.

use vtex_base::geometry::shortest_offset;
use vtex_scene::element::Gaussian;

/// Half width of the box of a Gaussian, in standard deviations: that of a uniform ellipse.
const REACH: f64 = 2.0;

/// The box around a Gaussian's ellipse: half its width and height.
fn half(gaussian: &Gaussian) -> [f64; 2] {
    let [xx, _, yy] = gaussian.covariance;
    [xx, yy].map(|v| REACH * libm::sqrt(v))
}

/// The area of a Gaussian, up to a factor.
fn area(gaussian: &Gaussian) -> f64 {
    let [xx, xy, yy] = gaussian.covariance;
    xx * yy - xy * xy
}

/// Whether the boxes of two Gaussians overlap.
fn overlap(a: &Gaussian, b: &Gaussian, periods: [Option<f64>; 2]) -> bool {
    let (way, [a, b]) = (shortest_offset(a.mean, b.mean, periods), [half(a), half(b)]);
    way.x.abs() < a[0] + b[0] && way.y.abs() < a[1] + b[1]
}

/// The indices of a layer's elements in a new painting order: one that has grown comes right before the first smaller
/// one that it overlaps and did not overlap before. `before` and `after` are the Gaussians of elements in painting
/// order, the latter `None` where nothing changed.
pub(super) fn uncovering(
    before: &[Option<Gaussian>],
    after: &[Option<Gaussian>],
    periods: [Option<f64>; 2],
) -> Vec<usize> {
    let now: Vec<Option<&Gaussian>> =
        before.iter().zip(after).map(|(b, a)| a.as_ref().or(b.as_ref())).collect();
    let areas: Vec<f64> = now.iter().map(|g| g.map_or(0.0, area)).collect();
    let has_grown = |i: usize| after[i].is_some() && before[i].as_ref().is_some_and(|b| area(b) < areas[i]);
    // The smaller elements below each grown one that it has come to overlap.
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); now.len()];
    each_close(&now, periods[0], |a, b| {
        let (under, over) = (a.min(b), a.max(b));
        if !has_grown(over) || areas[under] >= areas[over] {
            return;
        }
        let [Some(x), Some(y)] = [now[under], now[over]] else { return };
        let [Some(was), Some(other)] = [&before[under], &before[over]] else { return };
        if overlap(x, y, periods) && !overlap(was, other, periods) {
            below[over].push(under);
        }
    });
    let mut places: Vec<usize> = (0..now.len()).collect();
    let mut grown: Vec<usize> = (0..now.len()).filter(|&i| !below[i].is_empty()).collect();
    grown.sort_by(|&a, &b| areas[a].total_cmp(&areas[b]).then(a.cmp(&b)));
    for &i in &grown {
        places[i] = below[i].iter().fold(i, |place, &j| place.min(places[j]));
    }
    let mut order: Vec<usize> = (0..now.len()).collect();
    // At one place the larger come first, what stays there last.
    order.sort_by(|&a, &b| {
        let stays = |i: usize| places[i] == i;
        let by_place = places[a].cmp(&places[b]).then(stays(a).cmp(&stays(b)));
        by_place.then(areas[b].total_cmp(&areas[a])).then(a.cmp(&b))
    });
    order
}

/// Calls `visit` for all pairs of elements whose boxes overlap along x, which may repeat.
fn each_close(all: &[Option<&Gaussian>], period: Option<f64>, mut visit: impl FnMut(usize, usize)) {
    let mut sides: Vec<(f64, f64, usize)> = Vec::new();
    for (i, gaussian) in all.iter().enumerate() {
        let Some(gaussian) = gaussian else { continue };
        let (x, half) = (gaussian.mean.x, half(gaussian)[0]);
        sides.push((x - half, x + half, i));
        if let Some(period) = period {
            // What reaches beyond a seam is listed on its other side too.
            sides.extend((x - half < 0.0).then_some((x - half + period, x + half + period, i)));
            sides.extend((x + half > period).then_some((x - half - period, x + half - period, i)));
        }
    }
    sides.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    for (k, &(_, right, i)) in sides.iter().enumerate() {
        for &(_, _, j) in sides[k + 1..].iter().take_while(|(left, ..)| *left < right) {
            if i != j {
                visit(i, j);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::{Point, Vec2};

    fn round(x: f64, radius: f64) -> Option<Gaussian> {
        let variance = radius * radius / 4.0;
        Some(Gaussian {
            mean: Point::new(x, 5.0),
            covariance: [variance, 0.0, variance],
            direction: Vec2::new(1.0, 0.0),
        })
    }

    #[test]
    fn grown_elements_come_below_smaller_ones_that_they_reach() {
        let before =
            [round(10.0, 3.0), round(20.0, 3.0), round(28.0, 4.0), round(90.0, 3.0), round(97.0, 4.0)];
        // The third grows over the second, which grows too; the last over the first, across the seam.
        let after = [None, round(20.0, 4.0), round(28.0, 8.0), None, round(97.0, 12.0)];
        assert_eq!(uncovering(&before, &after, [None; 2]), [0, 2, 1, 4, 3]);
        assert_eq!(uncovering(&before, &after, [Some(100.0), None]), [4, 0, 2, 1, 3]);
        // What overlapped before keeps its order, and so does what does not grow.
        let wide = [round(10.0, 3.0), round(14.0, 4.0)];
        assert_eq!(uncovering(&wide, &[None, round(14.0, 9.0)], [None; 2]), [0, 1]);
        assert_eq!(uncovering(&before, &[None; 5], [None; 2]), [0, 1, 2, 3, 4]);
    }
}
