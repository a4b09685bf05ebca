//! Properties of pictures made from pixels.

use super::*;
use vtex_base::sampling::stream;

/// Streaks and grain in two colours.
fn photo(width: u32, height: u32, seed: u64) -> RgbImage {
    let mut random = stream(seed, "pixels test", 0);
    let waves: Vec<[f64; 3]> = (0..6)
        .map(|_| [random.range(-0.5, 0.5), random.range(-0.12, 0.12), random.range(0.0, 6.3)])
        .collect();
    RgbImage::from_fn(width, height, |x, y| {
        let wave = |w: &[f64; 3]| libm::sin(w[0] * f64::from(x) + w[1] * f64::from(y) + w[2]);
        let v = 128.0 + 30.0 * waves.iter().map(wave).sum::<f64>() + random.range(-12.0, 12.0);
        let v = v.clamp(0.0, 255.0);
        Rgb([v as u8, (v * 0.8) as u8, (255.0 - v) as u8])
    })
}

/// Earth mover's distance of the lightness of two pictures, 0 to 1.
fn distance(a: &RgbImage, b: &RgbImage) -> f64 {
    let quantiles = |image: &RgbImage| {
        let mut all: Vec<f32> = image.pixels().map(|p| oklab(p.0)[0]).collect();
        all.sort_by(f32::total_cmp);
        (0..500).map(|k| f64::from(all[k * all.len() / 500])).collect::<Vec<_>>()
    };
    quantiles(a).iter().zip(quantiles(b)).map(|(x, y)| (x - y).abs()).sum::<f64>() / 500.0
}

/// Mean difference of lightness between adjacent columns.
fn step(image: &RgbImage, x: u32) -> f64 {
    let light = |x: u32, y: u32| f64::from(oklab(image.get_pixel(x % image.width(), y).0)[0]);
    let sum: f64 = (0..image.height()).map(|y| (light(x, y) - light(x + 1, y)).abs()).sum();
    sum / f64::from(image.height())
}

fn has_no_seam(image: &RgbImage) {
    let all: f64 = (0..image.width() - 1).map(|x| step(image, x)).sum();
    let (seam, inside) = (step(image, image.width() - 1), all / f64::from(image.width() - 1));
    assert!((0.7..1.4).contains(&(seam / inside)), "{seam} {inside}");
}

#[test]
fn every_way_keeps_colours_and_repeats() {
    let own = photo(64, 60, 1);
    let params = ScanParams::default();
    let made = scanned(&own, [120, 70], &params, 2, &()).unwrap();
    assert_eq!(made.dimensions(), (120, 70));
    assert!(distance(&own, &made) < 0.02, "{}", distance(&own, &made));
    has_no_seam(&made);
    assert_eq!(scanned(&own, [120, 70], &params, 2, &()).unwrap(), made);
    assert_ne!(scanned(&own, [120, 70], &params, 3, &()).unwrap(), made);
    let made = carried(&own, [120, 70], [true; 2], 2, &()).unwrap();
    assert_eq!(made.dimensions(), (120, 70));
    assert!(distance(&own, &made) < 0.03, "{}", distance(&own, &made));
    has_no_seam(&made);
    assert_ne!(carried(&own, [120, 70], [true; 2], 3, &()).unwrap(), made);
}

#[test]
fn exact_pixels_are_the_photographs() {
    let own = photo(48, 48, 2);
    let known: std::collections::BTreeSet<[u8; 3]> = own.pixels().map(|p| p.0).collect();
    let scanned = scanned(&own, [70, 40], &ScanParams::default(), 1, &()).unwrap();
    let carried = carried(&own, [71, 43], [false; 2], 1, &()).unwrap();
    assert!(scanned.pixels().chain(carried.pixels()).all(|p| known.contains(&p.0)));
}

#[test]
fn everything_is_where_the_map_says() {
    // The left half of the photograph is red, the right one blue.
    let mut random = stream(3, "pixels test", 0);
    let own = RgbImage::from_fn(80, 80, |x, _| {
        let v = random.below(60) as u8;
        Rgb(if x < 40 { [180 + v, 40, 40] } else { [40, 40, 180 + v] })
    });
    let label = |w: u32, h: u32, f: &dyn Fn(u32, u32) -> bool| LabelMap {
        width: w,
        height: h,
        labels: (0..w * h).map(|i| u32::from(f(i % w, i / w))).collect(),
    };
    let known = label(80, 80, &|x, _| x >= 40);
    let wanted = label(90, 60, &|x, y| (x / 30 + y / 30) % 2 == 0);
    let made = by_numbers(&own, &known, &wanted, [false; 2], 1, &()).unwrap();
    let right = made.enumerate_pixels().filter(|(x, y, p)| (p.0[2] > p.0[0]) == (wanted.get(*x, *y) == 1));
    assert!(right.count() >= 90 * 60 * 98 / 100);
    let other = label(80, 70, &|x, _| x >= 40);
    assert!(matches!(by_numbers(&own, &other, &wanted, [false; 2], 1, &()), Err(Error::Control { .. })));
    let third = LabelMap::filled(40, 40, 2);
    assert!(matches!(by_numbers(&own, &known, &third, [false; 2], 1, &()), Err(Error::Control { .. })));
}

#[test]
fn any_size_is_filled_and_work_can_be_stopped() {
    let own = photo(33, 32, 4);
    let dot = scanned(&photo(1, 1, 4), [5, 4], &ScanParams::default(), 1, &()).unwrap();
    assert!(dot.pixels().all(|p| p == photo(1, 1, 4).get_pixel(0, 0)));
    for size in [[1, 1], [3, 90], [90, 2]] {
        let wide = |image: RgbImage| [image.width() as usize, image.height() as usize];
        assert_eq!(wide(scanned(&own, size, &ScanParams::default(), 1, &()).unwrap()), size);
        assert_eq!(wide(carried(&own, size, [true, false], 1, &()).unwrap()), size);
    }
    assert!(matches!(carried(&own, [0, 4], [false; 2], 1, &()), Err(Error::Parameter { .. })));
    assert!(matches!(
        scanned(&own, [4, 20_000], &ScanParams::default(), 1, &()),
        Err(Error::TooLarge { .. })
    ));
    let stop = &vtex_testing::StopAtOnce;
    assert!(matches!(scanned(&own, [40, 40], &ScanParams::default(), 1, stop), Err(Error::Interrupted)));
    assert!(matches!(carried(&own, [40, 40], [false; 2], 1, stop), Err(Error::Interrupted)));
}
