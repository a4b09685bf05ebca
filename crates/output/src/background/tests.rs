//! Tests: few stops, near to the field everywhere, periodic where the scene is.

use super::*;
use crate::testing;
use vtex_scene::scene::Tile;

/// Mean and spread of a photograph's background colours. Neighbours in rusty metal differ by a hundred steps.
const HARSH: ([f64; 3], f64) = ([110.0, 70.0, 45.0], 90.0);
const CALM: ([f64; 3], f64) = ([120.0, 115.0, 100.0], 12.0);

/// A scene with a background only. Its colours lie on a line through `centre`, up to `spread` from it, as
/// those of photographs do.
fn scene_of(width: u32, height: u32, (centre, spread): ([f64; 3], f64), tile: Tile) -> Scene {
    let mut scene = testing::tiled(width, height, 1, tile);
    scene.layers.iter_mut().for_each(|layer| layer.instances.clear());
    let mut rng = vtex_base::sampling::stream(2, "output/ground", 0);
    for point in &mut scene.field_mut().points {
        let light = (rng.unit() - 0.5 + rng.unit() - 0.5) * spread;
        point.colour = Colour::from_f64(centre.map(|v| v + light + 4.0 * (rng.unit() - 0.5)));
    }
    scene
}

/// The grid of a scene's field.
fn grid(scene: &Scene) -> PreparedBackground {
    PreparedBackground::new(scene, scene.field())
}

/// Mean and largest distance of the grid from the field, and the share of places further than 4 from it, at
/// places independent of rows and stops.
fn distance(scene: &Scene) -> (f64, f64, f64) {
    let grid = self::grid(scene);
    let field = Interpolant::new(scene.field(), scene.width, scene.height, scene.tile);
    let step = 0.9;
    let xs: Vec<f64> = (0..(f64::from(scene.width) / step) as usize).map(|i| i as f64 * step).collect();
    let (mut sum, mut most, mut far, mut count) = (0.0, 0.0f64, 0.0, 0.0);
    for j in 0..(f64::from(scene.height) / step) as usize {
        let y = j as f64 * step;
        let k = ((y / grid.row_height) as usize).min(grid.rows.len() - 2);
        let t = y / grid.row_height - k as f64;
        for ((x, a), b) in xs.iter().zip(grid.row(k, &xs)).zip(grid.row(k + 1, &xs)) {
            let field = field.at(*x, y);
            let off = [0, 1, 2].map(|c| (f64::from(a[c]) * (1.0 - t) + f64::from(b[c]) * t - field[c]).abs());
            let worst = off.iter().fold(0.0, |a: f64, b| a.max(*b));
            sum += off.iter().sum::<f64>() / 3.0;
            most = most.max(worst);
            far += f64::from(u8::from(worst > 4.0));
            count += 1.0;
        }
    }
    (sum / count, most, far / count)
}

fn stop_count(scene: &Scene) -> usize {
    grid(scene).rows.iter().flatten().map(Vec::len).sum()
}

#[test]
fn near_to_the_field() {
    let (mean, most, _) = distance(&scene_of(300, 300, CALM, Tile::default()));
    assert!(mean < 0.8 && most < 3.0, "{mean} {most}");
    let (mean, most, far) = distance(&scene_of(300, 300, HARSH, Tile::default()));
    assert!(mean < 0.9 && most < 9.0 && far < 0.003, "{mean} {most} {far}");
}

#[test]
fn few_stops() {
    let [calm, harsh] =
        [CALM, HARSH].map(|colours| stop_count(&scene_of(300, 300, colours, Tile::default())));
    // Number of stops for these pixels; a stop takes 40 bytes.
    assert!(calm < 330 && harsh < 680, "{calm} {harsh}");
}

#[test]
fn an_even_ground_needs_two_stops_a_row() {
    let mut scene = scene_of(300, 300, CALM, Tile::default());
    scene.field_mut().points.clear();
    let grid = self::grid(&scene);
    assert!(grid.rows.iter().flatten().all(|stops| stops.len() == 2));
    assert!(grid.rows.iter().flatten().flatten().all(|s| s.colour == scene.field().fallback));
}

#[test]
fn stops_ascend_and_columns_join() {
    let grid = self::grid(&scene_of(1100, 60, HARSH, Tile::default()));
    assert!(grid.columns.len() == 4 && grid.columns[3] == 1100.0);
    for row in &grid.rows {
        assert!(row.iter().flatten().is_sorted_by(|a, b| a.x <= b.x));
        for (c, stops) in row.iter().enumerate() {
            assert_eq!(stops[0].x, grid.columns[c]);
            assert_eq!(stops[stops.len() - 1].x, grid.columns[c + 1]);
        }
        for pair in row.windows(2) {
            assert_eq!(pair[0][pair[0].len() - 1].colour, pair[1][0].colour);
        }
    }
}

#[test]
fn periodic_where_the_scene_tiles() {
    // An odd and an even number of rows.
    for height in [110, 200] {
        let scene = scene_of(310, height, HARSH, Tile { x: true, y: true });
        let grid = self::grid(&scene);
        let [first, last] = [0, grid.rows.len() - 1]
            .map(|k| grid.rows[k].iter().flatten().map(|s| (s.x, s.colour)).collect::<Vec<_>>());
        assert_eq!(first, last);
        for row in &grid.rows {
            let stops: Vec<&RowStop> = row.iter().flatten().collect();
            assert_eq!(stops[0].colour, stops[stops.len() - 1].colour);
        }
    }
}

#[test]
fn any_size_has_a_grid() {
    for (width, height) in [(1, 1), (1, 400), (400, 1), (2, 3)] {
        for tile in [Tile::default(), Tile { x: true, y: true }] {
            let grid = self::grid(&scene_of(width, height, HARSH, tile));
            assert!(grid.rows.len() >= 2 && grid.rows.iter().flatten().all(|stops| stops.len() >= 2));
        }
    }
}
