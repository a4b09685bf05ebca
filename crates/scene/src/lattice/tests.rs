//! Lattices of generated pictures.

use super::*;
use image::{Rgb, RgbImage};
use vtex_base::sampling::{Stream, stream};

const SIDE: u32 = 260;

/// A picture of disks or bricks at some places, each in its own colour, on an uneven background.
fn picture(places: &[[f64; 2]], half: [f64; 2], round: bool, random: &mut Stream) -> RgbImage {
    let mut image = RgbImage::from_fn(SIDE, SIDE, |_, _| {
        let grain = random.range(-14.0, 14.0);
        Rgb([90.0 + grain, 84.0 + grain, 80.0 + grain].map(|v| v as u8))
    });
    for &[cx, cy] in places {
        let light = random.range(150.0, 220.0);
        let [w, h] = half.map(|v| v * random.range(0.85, 1.15));
        let range =
            |c: f64, d: f64| (c - d).max(0.0) as u32..(c + d + 1.0).clamp(0.0, f64::from(SIDE)) as u32;
        for y in range(cy, h) {
            for x in range(cx, w) {
                let [u, v] = [(f64::from(x) - cx) / w, (f64::from(y) - cy) / h];
                let inside = if round { u * u + v * v <= 1.0 } else { u.abs() <= 1.0 && v.abs() <= 1.0 };
                if inside {
                    let grain = light + random.range(-12.0, 12.0);
                    image.put_pixel(x, y, Rgb([grain, 0.9 * grain, 0.8 * grain].map(|v| v as u8)));
                }
            }
        }
    }
    image
}

/// A picture of a lattice, and its vectors: hexagons, bonds, chequers or plain grids; places stray by up to a
/// tenth of the period, and up to 15 % of the elements are missing.
fn regular(seed: u64) -> (RgbImage, [[f64; 2]; 2]) {
    let mut random = stream(seed, "lattice test", 0);
    let a = random.range(22.0, 44.0);
    let b = a * random.range(0.6, 1.0);
    let vectors = match seed % 4 {
        0 => [[a, 0.0], [0.5 * a, 0.866 * a]],
        1 => [[a, 0.0], [0.5 * a, b]],
        2 => [[0.5 * a, 0.5 * a], [0.5 * a, -0.5 * a]].map(|v| v.map(|c| c * 1.4)),
        _ => [[a, 0.0], [0.0, b]],
    };
    let turn = random.range(-0.1, 0.1);
    let (s, c) = libm::sincos(turn);
    let vectors = vectors.map(|[x, y]| [c * x - s * y, s * x + c * y]);
    let stray = random.range(0.0, 0.1) * libm::hypot(vectors[1][0], vectors[1][1]);
    let missing = random.range(0.0, 0.15);
    let mut places = Vec::new();
    for n in -30..30 {
        for m in -30..30 {
            if !random.chance(missing) {
                let jitter = [0, 1].map(|_| random.range(-stray, stray));
                let at = |k: usize| {
                    130.0 + f64::from(n) * vectors[0][k] + f64::from(m) * vectors[1][k] + jitter[k]
                };
                places.push([at(0), at(1)]);
            }
        }
    }
    let round = seed % 4 != 1;
    let half = if round { [0.36 * b.min(0.8 * a); 2] } else { [0.44 * a, 0.42 * b] };
    (picture(&places, half, round, &mut random), vectors)
}

/// A picture of elements of several sizes at random places.
fn irregular(seed: u64) -> RgbImage {
    let mut random = stream(seed, "lattice test", 1);
    let size = random.range(5.0, 14.0);
    let count = (random.range(0.3, 0.9) * f64::from(SIDE * SIDE) / (4.0 * size * size)) as usize;
    let mut places: Vec<[f64; 2]> = Vec::new();
    for _ in 0..20 * count {
        let at = [0, 1].map(|_| random.range(0.0, f64::from(SIDE)));
        let free = places.iter().all(|p| libm::hypot(p[0] - at[0], p[1] - at[1]) > 1.7 * size);
        if free && places.len() < count {
            places.push(at);
        }
    }
    let long = random.range(0.7, 1.3);
    picture(&places, [size * long, size / long], random.chance(0.5), &mut random)
}

/// Whether two pairs of vectors make one lattice.
fn same(found: &Lattice, wanted: [[f64; 2]; 2]) -> bool {
    let [a, b] = found.vectors[..] else { return false };
    let d = cross(a, b);
    let close = |v: f64| (v - libm::round(v)).abs() < 0.08;
    let within = wanted.iter().all(|&w| close(cross(w, b) / d) && close(cross(a, w) / d));
    within && (d / cross(wanted[0], wanted[1])).abs() > 0.8
}

/// Shares of lattices that are found correctly, and of irregular pictures in which a lattice is found.
fn shares(count: u64) -> (f64, f64) {
    let right = (0..count).filter(|&seed| {
        let (image, wanted) = regular(seed);
        let found = find(&image);
        if !found.as_ref().is_some_and(|found| same(found, wanted)) {
            println!("seed {seed}: {wanted:.1?} found as {found:.1?}");
        }
        found.is_some_and(|found| same(&found, wanted))
    });
    let wrong = (0..count).filter(|&seed| find(&irregular(seed)).is_some());
    (right.count() as f64 / count as f64, wrong.count() as f64 / count as f64)
}

#[test]
fn lattices_are_found_and_irregular_pictures_have_none() {
    let (right, wrong) = shares(24);
    assert!(right >= 0.9 && wrong == 0.0, "{right} right, {wrong} false");
}

#[test]
#[ignore = "the same on 200 pictures of each kind"]
fn lattices_of_many_pictures() {
    let (right, wrong) = shares(200);
    println!("{right} right, {wrong} false");
    assert!(right >= 0.97 && wrong <= 0.01, "{right} right, {wrong} false");
}

#[test]
fn lattices_are_said_as_people_see_them() {
    let words = |vectors: &[[f64; 2]]| Lattice::new(vectors).unwrap().in_words();
    assert_eq!(words(&[[0.0, 85.2]]), "rows every 85 px");
    assert_eq!(words(&[[93.2, 0.4]]), "columns every 93 px");
    assert_eq!(words(&[[30.0, 40.0]]), "rows every 50 px, turned by 37°");
    assert_eq!(words(&[[-146.3, 0.0], [0.1, 146.4]]), "rows every 146 px and columns every 146 px");
    assert_eq!(
        words(&[[39.1, 56.9], [-39.6, 57.0]]),
        "rows every 57 px, in each a period of 79 px, moved by a half from row to row"
    );
    assert_eq!(
        words(&[[0.0, 60.0], [45.0, 20.0]]),
        "columns every 45 px, in each a period of 60 px, moved by a third from column to column"
    );
    assert_eq!(words(&[[40.0, 30.0], [-30.0, 40.0]]), "a lattice that repeats every 50 px and every 50 px");
}

#[test]
fn planks_are_rows_with_a_free_axis() {
    let mut random = stream(3, "lattice test", 2);
    let image = RgbImage::from_fn(SIDE, SIDE, |_, y| {
        let light = if y % 37 < 4 { 50.0 } else { 150.0 } + random.range(-10.0, 10.0);
        Rgb([light as u8; 3])
    });
    let found = find(&image).unwrap();
    let [[x, y]] = found.vectors[..] else { panic!("{found:?}") };
    assert!(x.abs() < 0.5 && (y.abs() - 37.0).abs() < 0.3, "{found:?}");
}

#[test]
fn a_period_of_a_drawing_is_one_of_its_lattice() {
    let image = RgbImage::from_fn(60, 48, |x, y| {
        let [dx, dy] = [f64::from(x) - 30.0, f64::from(y) - 24.0];
        Rgb(if libm::hypot(dx, dy) < 12.0 { [200, 40, 40] } else { [240; 3] })
    });
    assert_eq!(find(&image), None);
    assert!(same(&of_period(&image).unwrap(), [[60.0, 0.0], [0.0, 48.0]]));
}

#[test]
fn tiles_hold_whole_periods() {
    let bricks = Lattice::new(&[[80.0, 0.0], [40.0, 30.0]]).unwrap();
    // A little stretched: 10 bricks and 16 courses in 790 x 484.
    let phases = bricks.phases_of_tile([790, 484], [true, true]).unwrap();
    for (wave, size) in [([790.0, 0.0], "across"), ([0.0, 484.0], "down")] {
        for own in &phases.waves {
            let phase = dot(*own, wave);
            assert!((phase - libm::round(phase)).abs() < 1e-9, "{size}: {phase}");
        }
    }
    // There is no stretch along an axis that does not repeat.
    let open = bricks.phases_of_tile([790, 470], [true, false]).unwrap();
    let down = |phases: &Phases| phases.waves.iter().map(|wave| wave[1]).collect::<Vec<f64>>();
    assert_eq!(down(&open), down(&bricks.phases()));
    match bricks.phases_of_tile([120, 80], [true, true]) {
        Err(Error::Periods { nearest: Some([w, h]), .. }) => {
            assert!(bricks.phases_of_tile([w, h], [true, true]).is_ok(), "{w} x {h}");
            assert!(w.abs_diff(120) <= 60 && h.abs_diff(80) <= 40, "{w} x {h}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn lattices_that_make_no_sense_are_refused() {
    for vectors in
        [&[][..], &[[1.0, 1.0]], &[[80.0, 0.0], [160.0, 1.0]], &[[f64::NAN, 9.0]], &[[9.0, 9.0]; 3]]
    {
        assert!(
            matches!(Lattice::new(vectors), Err(Error::Parameter { name: "lattice", .. })),
            "{vectors:?}"
        );
    }
    assert!(Lattice::new(&[[0.0, 12.0]]).is_ok());
}

/// The photographs in which rows or a lattice are seen at once, and their vectors by hand, in pixels.
const SEEN: [(&str, &[[f64; 2]]); 9] = [
    ("brown_floor_tiles", &[[146.4, 0.0], [0.0, 146.4]]),
    ("blue_floor_tiles_01", &[[0.0, 85.2]]),
    ("black_painted_planks", &[[93.2, 0.0]]),
    ("brick_wall_001", &[[0.0, 73.1]]),
    ("tread_plate", &[[0.5, 92.0], [143.0, 0.5]]),
    ("brick_wall_02", &[[73.1, 51.4], [-73.1, 51.4]]),
    ("brick_floor_003", &[[39.4, 56.9], [-39.4, 56.9]]),
    ("stone_floor", &[[0.0, 56.9]]),
    ("blue_painted_planks", &[[0.0, 169.0]]),
];

#[test]
fn rows_that_are_seen_at_once_are_found_and_others_are_not() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/exemplars");
    let Ok(files) = std::fs::read_dir(&folder) else {
        println!("skipped: no {}", folder.display());
        return;
    };
    for file in files.map(|file| file.unwrap().path()).filter(|file| file.is_file()) {
        let Ok(image) = image::open(&file) else { continue };
        let found = find(&image.to_rgb8());
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        println!("{name}: {found:.2?}");
        match (SEEN.iter().find(|seen| seen.0 == name), found) {
            (None, found) => assert_eq!(found, None, "{name}"),
            (Some((_, wanted)), Some(found)) => {
                assert!(found.is_kept(), "{name}: {found:?}");
                match **wanted {
                    [a] => assert!(is_near(&found.vectors, a, 0.01), "{name}: {found:?}"),
                    [a, b] => assert!(same(&found, [a, b]), "{name}: {found:?}"),
                    _ => unreachable!(),
                }
            }
            (Some(_), None) => panic!("{name} has none"),
        }
    }
}

/// Whether there is one vector, which is another one within a share of its length.
fn is_near(found: &[[f64; 2]], wanted: [f64; 2], share: f64) -> bool {
    let [[x, y]] = *found else { return false };
    length([x - wanted[0], y - wanted[1]]) <= share * length(wanted)
}

#[test]
fn cells_are_drawn_around_the_elements() {
    // A bond of bricks of 40 × 20 px, each row moved by a half.
    let lattice = Lattice::new(&[[40.0, 0.0], [20.0, 20.0]]).unwrap();
    let centre = |row: i32, n: i32| [13.0 + f64::from(40 * n + 20 * row), 7.0 + f64::from(20 * row)];
    let centres: Vec<[f64; 2]> = (0..5).flat_map(|row| (-2..4).map(move |n| centre(row, n))).collect();
    let lines = lattice.cells(&centres, [120.0, 100.0]);
    let is_level = |[a, b]: &[[f64; 2]; 2]| (a[1] - b[1]).abs() < 1e-6;
    let (rows, ends): (Vec<_>, Vec<_>) = lines.iter().partition(|line| is_level(line));
    assert!(
        rows.iter().all(|&&[a, _]| ((a[1] - 17.0) / 20.0 - libm::round((a[1] - 17.0) / 20.0)).abs() < 1e-6)
    );
    assert_eq!(rows.len(), 5);
    // Each end is half-way between two bricks of its row.
    for &[a, b] in ends {
        assert!((a[0] - b[0]).abs() < 1e-6 && (a[1] - b[1]).abs() > 19.0);
        let row = libm::round((0.5 * (a[1] + b[1]) - 7.0) / 20.0);
        let phase = (a[0] - 13.0 - 20.0 * row) / 40.0 - 0.5;
        assert!((phase - libm::round(phase)).abs() < 1e-6, "{a:?}");
    }
    let rows = Lattice::new(&[[0.0, 25.0]]).unwrap().cells(&[[9.0, 10.0]], [50.0, 100.0]);
    let heights: Vec<f64> = rows.iter().map(|[a, _]| libm::round(a[1])).collect();
    assert_eq!(heights.iter().map(|h| h.rem_euclid(25.0)).collect::<Vec<_>>(), vec![23.0; rows.len()]);
    assert_eq!(rows.len(), 4);
}

#[test]
fn vectors_of_no_length_are_no_endless_work() {
    let [zero, other] = fit::shortest([[3.0, 4.0], [0.0; 2]]);
    assert_eq!((zero, other), ([0.0; 2], [3.0, 4.0]));
}
