//! Properties of the elements placed on a canvas.

use super::descriptor::bands::Bands;
use super::occupancy::PlacedId;
use super::*;
use vtex_scene::library::testing::{library, mosaic};
use vtex_scene::scene::Tile;

fn params(width: u32, height: u32, seed: u64) -> SynthParams {
    SynthParams { width, height, seed, ..SynthParams::default() }
}

#[test]
fn a_texton_taken_away_leaves_no_trace() {
    // The map after a texton is placed and removed equals, cell by cell, one on which it was never placed.
    let library = library(&mosaic(120, 15.0, 0.9, 15));
    let controls = Controls::default();
    for tile in [Tile::default(), Tile { x: true, y: true }] {
        let p = SynthParams { tile, ..params(90, 90, 15) };
        let model = PlacementModel::new(std::slice::from_ref(&library), &p);
        let grid = Grid::around(&model, &p);
        let make = || PlacementRegion::new(&grid, &controls, p.edge, false);
        let placeable: Vec<PlaceableId> = model.members.iter().flatten().copied().collect();
        let mut random = vtex_base::sampling::stream(15, "removal test", 0);
        let mut map = Occupancy::new(&model, make(), grid.clone());
        let mut ids = Vec::new();
        for _ in 0..60 {
            let variant = model.in_variation(placeable[random.index(placeable.len())], 0);
            let at = [grid.width, grid.height].map(|size| random.index(size as usize) as i32);
            ids.push(map.stand(variant, at, 0.0, |_| {}));
        }
        random.shuffle(&mut ids);
        for &id in &ids[..30] {
            map.remove(id);
        }
        let mut plain = Occupancy::new(&model, make(), grid.clone());
        let mut kept = ids[30..].to_vec();
        kept.sort_unstable();
        for &id in &kept {
            plain.stand(map.get(id).variant, map.get(id).at, 0.0, |_| {});
        }
        assert_eq!(map.covered, plain.covered);
        for i in 0..map.owner.len() {
            let name = |id: PlacedId| kept.iter().position(|&kept| kept == id);
            let wanted = plain.owner[i].as_placed().map(|id| id.0 as usize);
            assert_eq!(map.owner[i].as_placed().and_then(name), wanted);
        }
        for (k, &id) in kept.iter().enumerate() {
            assert_eq!(map.get(id).visible, plain.placed[k].visible);
        }
    }
}

#[test]
fn bands_put_together_make_one_sound_map() {
    let library = library(&mosaic(150, 13.0, 0.8, 16));
    let controls = Controls::default();
    for tile in [Tile::default(), Tile { x: false, y: true }] {
        let p = SynthParams { tile, ..params(160, 900, 16) };
        let model = PlacementModel::new(std::slice::from_ref(&library), &p);
        let grid = Grid::around(&model, &p);
        assert!(Bands::new(&model, &grid).is_some(), "the map is large enough for bands");
        let make = || PlacementRegion::new(&grid, &controls, p.edge, false);
        let mut choice = MemberWeights::new(&model, true);
        let map = Occupancy::new(&model, make(), grid.clone());
        let (map, _) = descriptor::place(map, &[], &mut choice, &p, &()).unwrap();
        // As if all had been placed one after the other.
        let mut plain = Occupancy::new(&model, make(), grid.clone());
        for placed in &map.placed {
            plain.stand(placed.variant, placed.at, 0.0, |_| {});
        }
        assert!(map.placed.len() > 300);
        assert_eq!(map.covered, plain.covered);
        for i in 0..map.owner.len() {
            assert_eq!(map.taken(i), plain.taken(i));
            assert!(!map.taken(i) || map.owner[i] == plain.owner[i]);
            let asked = !matches!(map.state[i], EMPTY | UNDEFINED) && !map.taken(i);
            assert!(!asked || !map.inside(grid.place(i)), "a request was forgotten");
        }
        for (a, b) in map.placed.iter().zip(&plain.placed) {
            assert_eq!((a.visible, a.cells), (b.visible, b.cells));
            assert_eq!(map.copy_nearness(model.element_of(a.variant), a.at), 1.0);
        }
        // No row is emptier than others: bands meet without a gap.
        let share = |y: i32| {
            let row = grid.index(0, y)..grid.index(0, y) + grid.width as usize;
            row.filter(|&i| map.taken(i)).count() as f64 / f64::from(grid.width)
        };
        let rows: Vec<f64> = (20..grid.height - 20).map(share).collect();
        let mean = rows.iter().sum::<f64>() / rows.len() as f64;
        for strip in rows.chunks_exact(20) {
            let strip = strip.iter().sum::<f64>() / 20.0;
            assert!(strip > 0.75 * mean && strip < 1.25 * mean, "{strip} {mean}");
        }
    }
}

#[test]
fn cells_over_the_border_of_nothing_count_to_their_element() {
    // Density rises from 0 over 600 px: nothing is wanted left of the 19th pixel, an eighth up to the 56th.
    let library = library(&mosaic(120, 15.0, 0.9, 17));
    let density = vtex_base::raster::ControlMap::new(600, 1, (0..600).map(|x| x as f32 / 300.0).collect());
    let controls = Controls { density, ..Controls::default() };
    let p = params(600, 60, 17);
    let model = PlacementModel::new(std::slice::from_ref(&library), &p);
    let grid = Grid::around(&model, &p);
    let region = PlacementRegion::new(&grid, &controls, p.edge, false);
    let [mx, my] = grid.margin;
    let mut map = Occupancy::new(&model, region, grid);
    let largest = model.members.iter().flatten().max_by_key(|&&p| model.plain(p).area).unwrap();
    let variant = model.in_variation(*largest, 0);
    let covered = |map: &Occupancy<'_>, zone: usize| map.covered[zone].iter().sum::<u64>();
    let id = map.stand(variant, [mx + 21, my + 30], 0.0, |_| {});
    let area = covered(&map, 0) + covered(&map, 1);
    assert!(covered(&map, 0) > 0 && covered(&map, 1) > 0);
    map.count_overhang();
    assert_eq!([covered(&map, 0), covered(&map, 1)], [0, area]);
    // Elements added and removed later are counted in the same way; elements far away and elements of empty
    // zones are not moved.
    let other = map.stand(variant, [mx + 5, my + 30], 0.0, |_| {});
    assert!(covered(&map, 0) > 0);
    map.remove(other);
    assert_eq!([covered(&map, 0), covered(&map, 1)], [0, area]);
    map.remove(id);
    assert!(map.covered.iter().flatten().all(|&cells| cells == 0));
}
