//! Tests of textures of cells.

use super::{go_on, page};
use crate::partition::{CellShape, PartitionTask, PlacedShape};
use crate::quilt::{CellExemplar, CellParams, QuiltedCell, quilted_cells};
use vtex_base::error::{Error, Result};
use vtex_base::geometry::{Outline, Point, Rect, Vec2, inside, signed_area};
use vtex_base::sampling::stream;

fn shape(points: &[[f64; 2]]) -> CellShape {
    CellShape::new(vec![points.iter().map(|p| Point::new(p[0], p[1])).collect()])
}

fn brick(x: f64, y: f64, width: f64, height: f64) -> CellShape {
    shape(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
}

/// Courses of bricks with joints of 2.
fn bricks() -> CellExemplar {
    let at = |k: u32| {
        let [column, row] = [k % 4, k / 4].map(f64::from);
        brick(30.0 * column + 15.0 * (row % 2.0) + 1.0, 14.0 * row + 1.0, 28.0, 12.0)
    };
    let cells: Vec<CellShape> = (0..16).map(at).collect();
    CellExemplar { page: page([120.0, 56.0], true), is_whole: vec![true; cells.len()], cells }
}

/// Cells around jittered points on a page that repeats, with joints of 3.
fn mosaic() -> CellExemplar {
    const N: i32 = 6;
    const SIDE: f64 = 240.0;
    let mut random = stream(9, "curves/quilt", 0);
    let unit = SIDE / f64::from(N);
    let sites: Vec<[f64; 2]> = (0..N * N)
        .map(|k| [k % N, k / N].map(|v| unit * (f64::from(v) + 0.5 + random.range(-0.33, 0.33))))
        .collect();
    let around = |site: &[f64; 2]| {
        let mut ring = vec![[-SIDE, -SIDE], [SIDE, -SIDE], [SIDE, SIDE], [-SIDE, SIDE]];
        for other in &sites {
            for shift in 0..9 {
                let by = [f64::from(shift % 3 - 1) * SIDE, f64::from(shift / 3 - 1) * SIDE];
                let way = [other[0] + by[0] - site[0], other[1] + by[1] - site[1]];
                let far = libm::sqrt(way[0] * way[0] + way[1] * way[1]);
                if far > 0.0 && far < 3.0 * unit {
                    // The half plane on this side of the joint.
                    let share = (far - 3.0) / far;
                    ring = super::cut(&ring, &vec![0; ring.len()], way.map(|v| share * v), 0).0;
                }
            }
        }
        let ring: Vec<[f64; 2]> = ring.iter().map(|p| [p[0] + site[0], p[1] + site[1]]).collect();
        shape(&ring)
    };
    let cells: Vec<CellShape> = sites.iter().map(around).collect();
    CellExemplar { page: page([SIDE; 2], true), is_whole: vec![true; cells.len()], cells }
}

fn params(size: [f64; 2], tile: bool) -> CellParams {
    CellParams { size, tile: [tile; 2], seed: 3, variation: 1.0 }
}

fn made(exemplar: &CellExemplar, params: &CellParams) -> Vec<QuiltedCell> {
    quilted_cells(exemplar, params, &go_on).unwrap()
}

/// The outlines of cells as polygons.
fn rings(exemplar: &CellExemplar, cells: &[QuiltedCell]) -> Vec<Vec<Point>> {
    let ring = |cell: &QuiltedCell| match &cell.path {
        Some(path) => Outline::new(path).unwrap().polygons(0.01).remove(0),
        None => exemplar.cells[cell.cell as usize].rings[0].iter().map(|p| cell.map * *p).collect(),
    };
    cells.iter().map(ring).collect()
}

fn covered(exemplar: &CellExemplar) -> f64 {
    exemplar.cells.iter().map(CellShape::area).sum::<f64>() / exemplar.page.area()
}

#[test]
fn bricks_go_on_as_they_are() {
    let exemplar = bricks();
    assert!(!exemplar.is_rearranged(&go_on).unwrap());
    for (size, tile) in [([300.0, 200.0], false), ([240.0, 168.0], true)] {
        let found = made(&exemplar, &params(size, tile));
        assert!(found.iter().all(|cell| cell.path.is_none()), "{size:?}");
        let total: f64 = found.iter().map(|c| c.shown_area).sum();
        let wanted = covered(&exemplar) * size[0] * size[1];
        assert!((total / wanted - 1.0).abs() < 0.02, "{total} of {wanted}");
        if tile {
            assert_eq!(found.len(), 8 * 12);
        }
    }
}

#[test]
fn cells_of_a_mosaic_come_in_another_order_and_none_is_broken() {
    let exemplar = mosaic();
    assert!(exemplar.is_rearranged(&go_on).unwrap());
    let smallest = exemplar.cells.iter().map(CellShape::area).fold(f64::INFINITY, f64::min);
    let largest = exemplar.cells.iter().map(CellShape::area).fold(0.0, f64::max);
    for (size, tile) in [([400.0, 330.0], false), ([310.0, 290.0], true)] {
        let found = made(&exemplar, &params(size, tile));
        let total: f64 = found.iter().map(|c| c.shown_area).sum();
        let wanted = covered(&exemplar) * size[0] * size[1];
        assert!((total / wanted - 1.0).abs() < 0.05, "{total} of {wanted}");
        let outlines = rings(&exemplar, &found);
        for outline in &outlines {
            let area = signed_area(outline).abs();
            assert!(area > 0.3 * smallest && area < 1.6 * largest, "{area}: {smallest} to {largest}");
        }
        // A place belongs to one cell at most, that of a copy where a tile repeats.
        let mut random = stream(1, "curves/quilt/places", 0);
        let (mut twice, mut none) = (0, 0);
        for _ in 0..2000 {
            let p = Point::new(random.range(0.0, size[0]), random.range(0.0, size[1]));
            let copies: Vec<Vec2> = match tile {
                true => (0..9)
                    .map(|k| Vec2::new(size[0] * f64::from(k % 3 - 1), size[1] * f64::from(k / 3 - 1)))
                    .collect(),
                false => vec![Vec2::ZERO],
            };
            let hit = outlines
                .iter()
                .map(|o| copies.iter().filter(|by| inside(o, p + **by)).count())
                .sum::<usize>();
            twice += usize::from(hit > 1);
            none += usize::from(hit == 0);
        }
        assert!(twice < 5, "{twice}");
        assert!((none as f64 / 2000.0 - (1.0 - covered(&exemplar))).abs() < 0.05, "{none}");
        // They do not go on as the exemplar does.
        let moves: std::collections::BTreeSet<[i64; 2]> = found
            .iter()
            .map(|c| {
                let [.., x, y] = c.map.as_coeffs();
                [x.rem_euclid(240.0), y.rem_euclid(240.0)].map(|v| libm::round(v) as i64)
            })
            .collect();
        assert!(moves.len() > 3, "{moves:?}");
    }
}

#[test]
fn without_variation_a_mosaic_goes_on_as_it_is() {
    let exemplar = mosaic();
    let found = made(&exemplar, &CellParams { variation: 0.0, ..params([480.0, 480.0], true) });
    assert_eq!(found.len(), 4 * exemplar.cells.len());
    assert!(found.iter().all(|c| c.path.is_none()));
}

#[test]
fn cells_that_a_border_cuts_do_not_come() {
    let mut exemplar = mosaic();
    exemplar.page.wraps = [false; 2];
    let page = Rect::new(0.0, 0.0, 240.0, 240.0);
    let is_in = |cell: &CellShape| cell.rings[0].iter().all(|p| page.contains(*p));
    exemplar.is_whole = exemplar.cells.iter().map(is_in).collect();
    let found = made(&exemplar, &params([400.0, 330.0], false));
    assert!(found.iter().all(|c| exemplar.is_whole[c.cell as usize]));
    let total: f64 = found.iter().map(|c| c.shown_area).sum();
    let wanted = covered(&exemplar) * 400.0 * 330.0;
    assert!((total / wanted - 1.0).abs() < 0.08, "{total} of {wanted}");
}

#[test]
fn the_same_cells_on_any_number_of_threads() {
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made(&mosaic(), &params([300.0, 260.0], true)))
    };
    let one = of(1);
    assert_eq!(one, of(2));
    assert_eq!(one, of(4));
}

#[test]
fn asked_to_stop_cells_are_not_made() {
    let calls = std::cell::Cell::new(0);
    for last in [0, 3, 12, 40] {
        calls.set(0);
        let stop = || -> Result<()> {
            calls.set(calls.get() + 1);
            if calls.get() > last { Err(Error::Interrupted) } else { Ok(()) }
        };
        let found = quilted_cells(&mosaic(), &params([300.0, 260.0], false), &stop);
        assert!(matches!(found, Err(Error::Interrupted)), "{last}");
    }
}

#[test]
fn overlaps_and_gaps_are_divided_half_way() {
    // Two squares that overlap by 6, or are 6 apart, with joints of 2.
    for (apart, border) in [(-6.0, 17.0), (6.0, 23.0)] {
        let shapes = [brick(0.0, 0.0, 20.0, 20.0)];
        let placed = [0.0, 20.0 + apart].map(|x| PlacedShape { shape: 0, by: Vec2::new(x, 0.0) });
        let task = PartitionTask {
            shapes: &shapes,
            placed: &placed,
            window: Rect::new(-10.0, -10.0, 60.0, 30.0),
            step: 1.0,
            reach: 8.0,
            tolerance: 0.05,
            half_gap: Some(1.0),
        };
        let found = task.divided(&go_on).unwrap();
        let [only] = &found.borders[..] else { panic!("{} borders", found.borders.len()) };
        assert!(!only.is_drawn);
        for p in only.points.iter().filter(|p| (3.0..17.0).contains(&p.y)) {
            assert!((p.x - border).abs() < 0.1, "{p:?}");
        }
    }
}

#[test]
fn a_tile_smaller_than_its_cells_is_refused() {
    let found = quilted_cells(&mosaic(), &params([12.0, 12.0], true), &go_on);
    assert!(matches!(found, Err(Error::Parameter { name: "canvas", .. })), "{found:?}");
}
