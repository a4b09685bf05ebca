//! For tests: weathered surfaces with the exact map of their layers.

use image::{Rgb, RgbImage};
use vtex_base::raster::LabelMap;
use vtex_base::raster::blur::Plane;
use vtex_base::sampling::stream;

/// A smooth random plane with structures of about `size / 6` pixels.
pub(super) fn clouds(size: [usize; 2], seed: u64) -> Plane {
    let mut random = stream(seed, "layers test", 0);
    let values = (0..size[0] * size[1]).map(|_| random.normal() as f32).collect();
    Plane { size, values }.blurred(size[0].min(size[1]) as f32 / 24.0, [false; 2])
}

/// A map of `count` nested layers, which cover the same areas.
pub(super) fn nested(size: [usize; 2], count: usize, seed: u64) -> LabelMap {
    let plane = clouds(size, seed);
    let mut sorted = plane.values.clone();
    sorted.sort_by(f32::total_cmp);
    let limits: Vec<f32> = (1..count).map(|k| sorted[k * sorted.len() / count]).collect();
    let labels = plane.values.iter().map(|v| limits.iter().filter(|l| v >= l).count() as u32).collect();
    LabelMap { width: size[0] as u32, height: size[1] as u32, labels }
}

/// A photograph of such layers, with grain.
pub(super) fn surface(size: [usize; 2], count: usize, seed: u64) -> (RgbImage, LabelMap) {
    let map = nested(size, count, seed);
    let mut random = stream(seed, "layers test grain", 0);
    let colours = [[190u8, 190, 185], [150, 90, 50], [60, 110, 60]];
    let photo = RgbImage::from_fn(map.width, map.height, |x, y| {
        let grain = random.range(-25.0, 25.0);
        Rgb(colours[map.get(x, y) as usize].map(|v| (f64::from(v) + grain) as u8))
    });
    (photo, map)
}

/// Share of the pixels with the same label, for the better of both layer orders.
pub(super) fn agreement(a: &LabelMap, b: &LabelMap) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let top = b.labels.iter().copied().max().unwrap_or(0);
    let same = |turn: bool| {
        let equal = |(x, y): (&u32, &u32)| *x == if turn { top - *y } else { *y };
        a.labels.iter().zip(&b.labels).filter(|&p| equal(p)).count()
    };
    same(false).max(same(true)) as f64 / a.labels.len() as f64
}
