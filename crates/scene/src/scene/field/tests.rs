//! Properties of background fields.

use super::*;
use crate::scene::ControlPoint;
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::{Area, poisson_disk, stream};

const PLANE: Tile = Tile { x: false, y: false };
const TILES: [Tile; 3] = [Tile { x: true, y: false }, Tile { x: false, y: true }, Tile { x: true, y: true }];

fn field(width: f64, height: f64, spacing: f64, seed: u64) -> Field {
    let mut random = stream(seed, "field test", 0);
    let places = poisson_disk(Area::plane(width, height), spacing, &mut random);
    let mut colour = || Colour([0; 3].map(|_| random.below(256) as u8));
    let points = places.iter().map(|p| ControlPoint { x: p[0], y: p[1], colour: colour() }).collect();
    Field { spacing, fallback: Colour([9, 8, 7]), points }
}

#[test]
fn passes_through_every_point() {
    for (w, h) in [(500, 400), (3, 2000), (60, 60)] {
        let f = field(f64::from(w), f64::from(h), 12.0, 1);
        let i = Interpolant::new(&f, w, h, PLANE);
        for p in &f.points {
            let (got, want) = (i.at(p.x, p.y), p.colour.to_f64());
            assert!((0..3).all(|k| (got[k] - want[k]).abs() < 1e-6), "{got:?} {want:?}");
        }
    }
}

#[test]
fn its_slope_is_continuous_in_every_point() {
    let mut f = field(300.0, 300.0, 20.0, 5);
    // Avoids 0 and 255, where values are clamped.
    f.points.iter_mut().for_each(|p| p.colour.0 = p.colour.0.map(|v| 64 + v / 2));
    let i = Interpolant::new(&f, 300, 300, PLANE);
    // The slope of a cone changes equally at every scale.
    let bend = |p: &ControlPoint, d: f64| {
        let [before, here, after] = [-d, 0.0, d].map(|d| i.at(p.x + d, p.y)[0]);
        (after - 2.0 * here + before).abs() / d
    };
    let steep = f.points.iter().map(|p| bend(p, 2.0)).fold(0.0, f64::max);
    let tips = f.points.iter().map(|p| bend(p, 0.02)).fold(0.0, f64::max);
    assert!(steep > 2.0 && tips < 0.02 * steep, "{steep} {tips}");
}

#[test]
fn a_constant_field_is_constant() {
    let mut f = field(400.0, 300.0, 10.0, 2);
    f.points.iter_mut().for_each(|p| p.colour = Colour([10, 200, 77]));
    let i = Interpolant::new(&f, 400, 300, PLANE);
    for value in i.grid(-20.0, -20.0, 7.3, 60, 50) {
        assert_eq!(value, [10.0, 200.0, 77.0]);
    }
}

#[test]
fn close_to_the_solution_for_all_points_at_once() {
    let f = field(300.0, 300.0, 14.0, 3);
    let sites = merged(&f, 300, 300, PLANE);
    assert!(sites.len() > 3 * WHOLE);
    let blend = Interpolant::new(&f, 300, 300, PLANE);
    let whole = CornerInterpolant::new(&sites, blend.round);
    let (mut sum, mut count) = (0.0, 0.0);
    for k in 0..2500 {
        let (x, y) = (25.0 + 5.0 * f64::from(k % 50), 25.0 + 5.0 * f64::from(k / 50));
        let (a, b) = (whole.at(x, y), blend.at(x, y));
        for c in 0..3 {
            let difference = (a[c].clamp(0.0, 255.0) - b[c]).abs();
            assert!(difference < 12.0, "{x} {y}: {difference}");
            sum += difference;
            count += 1.0;
        }
    }
    assert!(sum / count < 1.0, "{}", sum / count);
}

#[test]
fn smooth_from_patch_to_patch() {
    let f = field(400.0, 400.0, 15.0, 4);
    let i = Interpolant::new(&f, 400, 400, PLANE);
    let g = &i.grid;
    for border in 1..g.x.count {
        let x = g.x.start + border as f64 * g.x.side;
        for k in 0..80 {
            let y = 5.0 * f64::from(k);
            let at = |dx: f64| i.at(x + dx, y)[0];
            assert!((at(1e-6) - at(-1e-6)).abs() < 1e-3);
            let (left, right) = ((at(-1e-4) - at(-2e-4)) / 1e-4, (at(2e-4) - at(1e-4)) / 1e-4);
            let near = f.points.iter().any(|p| libm::hypot(p.x - x, p.y - y) < 0.5);
            assert!(near || (left - right).abs() < 0.1, "{left} {right}");
        }
    }
}

#[test]
fn few_and_hostile_points() {
    let none = Field { spacing: 25.0, fallback: Colour([9, 8, 7]), points: Vec::new() };
    assert_eq!(Interpolant::new(&none, 10, 10, PLANE).at(5.0, 5.0), [9.0, 8.0, 7.0]);
    let one = |x: f64, y: f64, v: u8| ControlPoint { x, y, colour: Colour([v; 3]) };
    let at = |points: Vec<ControlPoint>, x: f64, y: f64| {
        Interpolant::new(&Field { points, ..none.clone() }, 100_000, 100_000, PLANE).at(x, y)
    };
    assert_eq!(at(vec![one(3.0, 4.0, 50)], 1.0, 1.0), [50.0; 3]);
    assert_eq!(at(vec![one(3.0, 4.0, 50), one(3.0, 4.0, 70)], 1.0, 1.0), [60.0; 3]);
    assert_eq!(at(vec![one(3.0, 4.0, 50); 1_000_000], 99_999.0, 1.0), [50.0; 3]);
    let mut crowd: Vec<_> = (0..200_000u32)
        .map(|k| one(f64::from(k % 400) * 0.1, f64::from(k / 400) * 0.1, (k % 251) as u8))
        .collect();
    crowd.push(one(9e6, -9e6, 0));
    for (x, y) in [(20.0, 20.0), (70_000.0, 100.0), (99_000.0, 99_000.0)] {
        assert!(at(crowd.clone(), x, y).iter().all(|v| (0.0..=255.0).contains(v)));
    }
}

/// A field whose points keep their distance across the seams too.
fn tiled(width: f64, height: f64, spacing: f64, tile: Tile) -> Field {
    let mut random = stream(7, "field test", 0);
    let area = Area { width, height, wrap_x: tile.x, wrap_y: tile.y };
    let places = poisson_disk(area, spacing, &mut random);
    let mut colour = || Colour([0; 3].map(|_| random.below(256) as u8));
    let points = places.iter().map(|p| ControlPoint { x: p[0], y: p[1], colour: colour() }).collect();
    Field { spacing, fallback: Colour([9, 8, 7]), points }
}

#[test]
fn periodic_where_it_tiles_and_through_every_point() {
    for tile in TILES {
        for (w, h, spacing) in [(300, 200, 11.0), (40, 500, 15.0), (64, 64, 30.0), (20, 20, 40.0)] {
            let f = tiled(f64::from(w), f64::from(h), spacing, tile);
            let i = Interpolant::new(&f, w, h, tile);
            for p in &f.points {
                let (got, want) = (i.at(p.x, p.y), p.colour.to_f64());
                assert!((0..3).all(|k| (got[k] - want[k]).abs() < 1e-6), "{tile:?} {got:?} {want:?}");
            }
            let (px, py) = (f64::from(w), f64::from(h));
            for k in 0..200 {
                let (x, y) = (f64::from(k % 20) / 16.0 * px / 2.0, f64::from(k / 20) * py / 8.0);
                let (dx, dy) = (if tile.x { px } else { 0.0 }, if tile.y { py } else { 0.0 });
                assert_eq!(i.at(x, y), i.at(x + dx, y + dy));
                assert_eq!(i.at(x, y), i.at(x - 3.0 * dx, y));
            }
        }
    }
}

#[test]
fn smooth_across_the_seam() {
    let tile = TILES[2];
    let f = tiled(300.0, 200.0, 11.0, tile);
    let i = Interpolant::new(&f, 300, 200, tile);
    for k in 0..200 {
        let y = f64::from(k);
        let at = |dx: f64| i.at(300.0 + dx, y)[0];
        assert!((at(1e-6) - at(-1e-6)).abs() < 1e-3);
        let (left, right) = ((at(-1e-4) - at(-2e-4)) / 1e-4, (at(2e-4) - at(1e-4)) / 1e-4);
        let near = f.points.iter().any(|p| libm::hypot(p.x.min(300.0 - p.x), p.y - y) < 0.5);
        assert!(near || (left - right).abs() < 0.2, "{y}: {left} {right}");
    }
}

/// The position of the seam hardly changes the field.
#[test]
fn the_seam_can_be_anywhere() {
    let tile = TILES[2];
    let f = tiled(300.0, 200.0, 11.0, tile);
    let mut moved = f.clone();
    for p in &mut moved.points {
        (p.x, p.y) = (p.x + 150.0, p.y - 500.0);
    }
    let (a, b) = (Interpolant::new(&f, 300, 200, tile), Interpolant::new(&moved, 300, 200, tile));
    let (mut sum, mut count) = (0.0, 0.0);
    for k in 0..3000 {
        let (x, y) = (f64::from(k % 60) * 5.0, f64::from(k / 60) * 4.0);
        let (a, b) = (a.at(x, y), b.at(x + 150.0, y - 500.0));
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() < 14.0, "{x} {y}: {a:?} {b:?}");
            sum += (a[c] - b[c]).abs();
            count += 1.0;
        }
    }
    assert!(sum / count < 1.0, "{}", sum / count);
}

#[test]
fn few_points_on_a_torus() {
    let one = |x: f64, y: f64, v: u8| ControlPoint { x, y, colour: Colour([v; 3]) };
    for tile in TILES {
        for points in [
            vec![one(3.0, 4.0, 50)],
            vec![one(-9e5, 9e5, 50), one(3.0, -0.0, 50)],
            vec![one(-1e-20, 100.0, 50), one(0.0, 0.0, 50)],
        ] {
            let f = Field { spacing: 25.0, fallback: Colour([9, 8, 7]), points };
            for (w, h) in [(1, 1), (100, 100), (100_000, 100_000), (1, 100_000)] {
                let v = Interpolant::new(&f, w, h, tile).at(55.5, 7.25);
                assert!(v.iter().all(|c| (c - 50.0).abs() < 1e-6), "{tile:?} {v:?}");
            }
        }
    }
}

#[test]
fn same_on_any_number_of_threads() {
    let f = field(300.0, 300.0, 9.0, 5);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Interpolant::new(&f, 300, 300, PLANE).grid(0.0, 0.0, 3.0, 100, 100))
    };
    assert_eq!(run(1), run(4));
}
