//! Properties of pictures made by codebook: holes, borders, labels, parameters.

use super::*;
use std::sync::Mutex;
use vtex_base::sampling::stream;

const SIZE: [u32; 2] = [96, 80];

/// Slanted stripes of 8 px, with grain.
fn stripes(size: [u32; 2], origin: [i64; 2]) -> RgbImage {
    let mut random = stream(9, "scan test", 0);
    RgbImage::from_fn(size[0], size[1], |x, y| {
        let [x, y] = [i64::from(x) + origin[0], i64::from(y) + origin[1]];
        let v = if (2 * x + y).rem_euclid(16) < 8 { 60 } else { 180 } + random.below(12) as u8;
        Rgb([v, v / 2, 200 - v / 2])
    })
}

/// Share of the pixels `of` that are light where the stripes are.
fn like_stripes(made: &RgbImage, origin: [i64; 2], of: impl Fn(u32, u32) -> bool) -> f64 {
    let right = stripes([made.width(), made.height()], origin);
    let asked: Vec<bool> = made
        .enumerate_pixels()
        .filter(|(x, y, _)| of(*x, *y))
        .map(|(x, y, p)| (p.0[0] > 120) == (right.get_pixel(x, y).0[0] > 120))
        .collect();
    asked.iter().filter(|right| **right).count() as f64 / asked.len() as f64
}

/// Remembers warnings.
#[derive(Default)]
struct Warnings(Mutex<Vec<String>>);

impl Progress for Warnings {
    fn warn(&self, message: &str) {
        self.0.lock().unwrap().push(message.into());
    }
}

#[test]
fn a_hole_is_filled_and_the_rest_stays() {
    let own = stripes(SIZE, [0, 0]);
    let mut damaged = own.clone();
    let in_hole =
        |x: u32, y: u32| (40..64).contains(&x) && (30..50).contains(&y) && x + y < 106 || x < 6 && y > 60;
    let hole: Vec<bool> = own.enumerate_pixels().map(|(x, y, _)| in_hole(x, y)).collect();
    damaged
        .enumerate_pixels_mut()
        .filter(|(x, y, _)| in_hole(*x, *y))
        .for_each(|(.., p)| *p = Rgb([0, 255, 0]));
    let params = ScanParams::default();
    let made = filled(&damaged, &hole, [false; 2], &params, 1, &()).unwrap();
    for (x, y, p) in made.enumerate_pixels() {
        assert!(in_hole(x, y) || p == own.get_pixel(x, y));
        assert_ne!(p.0, [0, 255, 0], "{x} {y}");
    }
    let like = like_stripes(&made, [0, 0], in_hole);
    assert!(like > 0.95, "{like}");
    assert_eq!(filled(&damaged, &hole, [false; 2], &params, 1, &()).unwrap(), made);
    assert_ne!(filled(&damaged, &hole, [false; 2], &params, 2, &()).unwrap(), made);
}

#[test]
fn holes_that_cannot_be_filled_are_refused() {
    let own = stripes([40, 40], [0, 0]);
    let refused = |hole: &[bool], what: &str| {
        let error = filled(&own, hole, [false; 2], &ScanParams::default(), 1, &()).unwrap_err();
        assert!(matches!(error, Error::Control { .. }) && error.to_string().contains(what), "{error}");
    };
    refused(&[true; 7], "another size");
    refused(&[false; 1600], "it is empty");
    refused(&[true; 1600], "it leaves 0 neighbourhoods of 7 x 7 pixels");
    let most: Vec<bool> = (0..1600).map(|i| i % 40 > 9).collect();
    let last = |n| ScanParams { neighbourhood: n, ..ScanParams::default() };
    assert!(filled(&own, &most, [false; 2], &last(3), 1, &()).is_ok());
    let lines: Vec<bool> = (0..1600).map(|i| i % 40 % 6 == 0).collect();
    refused(&lines, "64 are needed");
}

#[test]
fn a_picture_is_continued_beyond_its_border() {
    let own = stripes([64, 48], [0, 0]);
    let margins = [20, 9, 5, 12];
    let params = ScanParams::default();
    let made = extended(&own, margins, [false; 2], &params, 1, &()).unwrap();
    assert_eq!(made.dimensions(), (89, 69));
    let inside = |x: u32, y: u32| (20..84).contains(&x) && (9..57).contains(&y);
    let same = made.enumerate_pixels().filter(|(x, y, _)| inside(*x, *y));
    assert!(same.into_iter().all(|(x, y, p)| p == own.get_pixel(x - 20, y - 9)));
    let like = like_stripes(&made, [-20, -9], |x, y| !inside(x, y));
    assert!(like > 0.8, "{like}");
    assert_eq!(extended(&own, [0; 4], [false; 2], &params, 1, &()).unwrap(), own);
    let far = extended(&own, [usize::MAX, 0, 1, 0], [false; 2], &params, 1, &());
    assert!(matches!(far, Err(Error::TooLarge { .. })));

    // 64 + 16 and 48 + 16 px hold whole periods: the margins then join both borders.
    let tile = extended(&own, [8; 4], [true; 2], &params, 1, &()).unwrap();
    let shifted = RgbImage::from_fn(80, 64, |x, y| *tile.get_pixel((x + 72) % 80, (y + 56) % 64));
    assert!(like_stripes(&shifted, [-16, -16], |_, _| true) > 0.95);
}

#[test]
fn every_pixel_has_the_label_of_the_map() {
    let mut random = stream(3, "scan test", 0);
    let own = RgbImage::from_fn(80, 60, |x, _| {
        let v = random.below(60) as u8;
        Rgb(if x < 40 { [180 + v, 40, 40] } else { [40, 40, 180 + v] })
    });
    let map = |width: u32, height: u32, f: &dyn Fn(u32, u32) -> u32| LabelMap {
        width,
        height,
        labels: (0..width * height).map(|i| f(i % width, i / width)).collect(),
    };
    let known = map(80, 60, &|x, _| u32::from(x >= 40));
    let wanted = map(71, 50, &|x, y| (x / 20 + y / 15) % 2);
    let params = ScanParams::default();
    let by = |known: &LabelMap, wanted: &LabelMap, seed| {
        scanned_by_numbers(&own, known, wanted, [false; 2], &params, seed, &())
    };
    let made = by(&known, &wanted, 1).unwrap();
    assert_eq!(made.dimensions(), (71, 50));
    assert!(made.enumerate_pixels().all(|(x, y, p)| (p.0[2] > p.0[0]) == (wanted.get(x, y) == 1)));
    assert_ne!(by(&known, &wanted, 2).unwrap(), made);
    assert!(matches!(by(&map(60, 80, &|_, _| 0), &wanted, 1), Err(Error::Control { .. })));
    assert!(matches!(by(&known, &LabelMap::filled(20, 20, 2), 1), Err(Error::Control { .. })));
}

#[test]
fn more_levels_keep_larger_structure() {
    // A wall of bricks of 20 x 10 px; on one level, neighbourhoods of 5 x 5 px see a joint at most.
    let mut random = stream(5, "scan test", 0);
    let wall = RgbImage::from_fn(128, 128, |x, y| {
        let joint = y % 10 < 2 || (x + y / 10 % 2 * 10) % 20 < 2;
        Rgb([if joint { 190 } else { 90 } + random.below(40) as u8, 80, 70])
    });
    let regular = |levels| {
        let params = ScanParams { levels: Some(levels), neighbourhood: 5, codebook: 512 };
        let made = scanned(&wall, [120, 120], &params, 1, &()).unwrap();
        let value = |x: u32, y: u32| f64::from(made.get_pixel(x % 120, y % 120).0[0]) - 130.0;
        let product = |dx: u32, dy: u32| -> f64 {
            (0..14_400).map(|i| value(i % 120, i / 120) * value(i % 120 + dx, i / 120 + dy)).sum()
        };
        product(20, 0) / product(0, 0)
    };
    let [one, three] = [1, 3].map(regular);
    assert!(three > one + 0.1, "{one} {three}");
}

#[test]
fn parameters_are_checked() {
    let own = stripes([48, 40], [0, 0]);
    let with = |levels, neighbourhood, codebook, progress: &dyn Progress| {
        scanned(&own, [30, 20], &ScanParams { levels, neighbourhood, codebook }, 1, progress)
    };
    for (levels, neighbourhood, codebook, name) in [
        (Some(0), 7, 64, "levels = 0"),
        (Some(9), 7, 64, "levels = 9"),
        (None, 6, 64, "neighbourhood = 6 is out of range: an odd number, 3 to 15 px"),
        (None, 17, 64, "neighbourhood = 17"),
        (None, 7, 0, "codebook = 0"),
    ] {
        let error = with(levels, neighbourhood, codebook, &()).unwrap_err();
        assert!(matches!(error, Error::Parameter { .. }) && error.to_string().contains(name), "{error}");
    }
    let warnings = Warnings::default();
    let all = with(Some(8), 7, 60_000, &warnings).unwrap();
    assert_eq!(
        *warnings.0.lock().unwrap(),
        [
            "the codebook has 1428 codewords, as many as there are neighbourhoods",
            "2 levels in place of 8: coarser ones would have too few neighbourhoods",
        ]
    );
    let none = Warnings::default();
    assert_eq!(with(Some(2), 7, 4096, &none).unwrap(), all);
    assert!(none.0.lock().unwrap().is_empty());
    assert_ne!(with(Some(1), 7, 4096, &()).unwrap(), all);
    assert_ne!(with(Some(2), 5, 4096, &()).unwrap(), all);
    assert_ne!(with(Some(2), 7, 16, &()).unwrap(), all);
}
