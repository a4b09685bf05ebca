//! Nearest-neighbour distances of primaries, corrected for the border.
//!
//! If a centre is nearer to the border than to any other centre, its nearest neighbour may lie outside.
//! Such centres are left out. The others are weighted by the inverse of the area in which their
//! distance can be observed (Hanisch 1984).

use vtex_base::geometry::wrapped;
use vtex_scene::statistics::Layout;

/// The distance from each centre to the nearest other, in pixels, with its weight. Centres whose
/// nearest neighbour may lie outside are left out.
pub(super) fn nearest(layout: &Layout) -> Vec<(f64, f64)> {
    let [width, height] = layout.size;
    let periods = layout.tile.periods(layout.size);
    let centres: Vec<[f64; 2]> =
        layout.centres.iter().map(|c| [wrapped(c.at[0], periods[0]), wrapped(c.at[1], periods[1])]).collect();
    let images = images(&centres, periods);
    let mut found = Vec::new();
    for (i, &at) in centres.iter().enumerate() {
        let inside = at[0] >= 0.0 && at[1] >= 0.0 && at[0] < width && at[1] < height;
        let Some(distance) = inside.then(|| to_nearest(&images, i, at)).flatten() else { continue };
        let (mut border, mut area) = (f64::INFINITY, 1.0);
        for k in 0..2 {
            if periods[k].is_none() {
                border = border.min(at[k]).min(layout.size[k] - at[k]);
                area *= layout.size[k] - 2.0 * distance;
            } else {
                area *= layout.size[k];
            }
        }
        if distance <= border && area > 0.0 {
            found.push((distance, 1.0 / area));
        }
    }
    found
}

/// The centres with their periodic copies, and their indices, sorted by x.
fn images(centres: &[[f64; 2]], periods: [Option<f64>; 2]) -> Vec<(f64, f64, usize)> {
    let shifts = |period: Option<f64>| period.map_or(vec![0.0], |p| vec![-p, 0.0, p]);
    let mut images = Vec::new();
    for dx in shifts(periods[0]) {
        for dy in shifts(periods[1]) {
            images.extend(centres.iter().enumerate().map(|(i, c)| (c[0] + dx, c[1] + dy, i)));
        }
    }
    images.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    images
}

/// The distance to the nearest image of another centre.
fn to_nearest(images: &[(f64, f64, usize)], own: usize, at: [f64; 2]) -> Option<f64> {
    let start = images.partition_point(|image| image.0 < at[0]);
    let mut best = f64::INFINITY;
    let mut look = |image: &(f64, f64, usize)| {
        let dx = image.0 - at[0];
        if dx.abs() >= best {
            return false;
        }
        if image.2 != own {
            best = best.min(libm::hypot(dx, image.1 - at[1]));
        }
        true
    };
    for image in &images[start..] {
        if !look(image) {
            break;
        }
    }
    for image in images[..start].iter().rev() {
        if !look(image) {
            break;
        }
    }
    best.is_finite().then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;
    use vtex_scene::element::{CategoryId, ElementId};
    use vtex_scene::scene::Tile;
    use vtex_scene::statistics::Centre;

    fn layout(points: &[[f64; 2]], size: f64, tile: bool) -> Layout {
        let centre = |at: &[f64; 2]| Centre {
            library: Default::default(),
            source: ElementId(0),
            category: CategoryId(0),
            at: *at,
        };
        let tile = Tile { x: tile, y: tile };
        Layout { size: [size; 2], tile, centres: points.iter().map(centre).collect() }
    }

    #[test]
    fn the_nearest_is_found_also_across_a_seam() {
        let mut random = stream(1, "report/neighbours test", 0);
        let points: Vec<[f64; 2]> = (0..60).map(|_| [random.unit() * 30.0, random.unit() * 30.0]).collect();
        let found = nearest(&layout(&points, 30.0, true));
        assert_eq!(found.len(), points.len());
        for (i, (distance, _)) in found.iter().enumerate() {
            let apart = |a: f64, b: f64| (a - b).abs().min(30.0 - (a - b).abs());
            let others = points.iter().enumerate().filter(|(k, _)| *k != i);
            let all = others.map(|(_, p)| libm::hypot(apart(p[0], points[i][0]), apart(p[1], points[i][1])));
            assert!((distance - all.fold(f64::INFINITY, f64::min)).abs() < 1e-9);
        }
    }

    #[test]
    fn the_border_does_not_change_the_mean() {
        // A random scatter of density d has the mean distance 1 / (2 √d).
        let mut random = stream(2, "report/neighbours test", 0);
        let (mut sum, mut weights) = (0.0, 0.0);
        for _ in 0..60 {
            let points: Vec<[f64; 2]> = (0..64).map(|_| [random.unit() * 8.0, random.unit() * 8.0]).collect();
            for (distance, weight) in nearest(&layout(&points, 8.0, false)) {
                sum += weight * distance;
                weights += weight;
            }
        }
        assert!((sum / weights - 0.5).abs() < 0.02, "{}", sum / weights);
    }

    #[test]
    fn few_points_have_few_neighbours() {
        assert!(nearest(&layout(&[], 9.0, false)).is_empty());
        assert!(nearest(&layout(&[[4.0; 2]], 9.0, true)).is_empty());
        assert_eq!(nearest(&layout(&[[4.0, 4.0], [5.0, 4.0]], 9.0, false)).len(), 2);
    }
}
