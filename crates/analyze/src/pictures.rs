//! Diagnostic pictures of the stages of analysis.

use image::{Rgb, RgbImage};
use vtex_base::raster::picture::{label_colour, labels};
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::library::CategoryId;
use vtex_scene::scene::Field;
use vtex_segment::segment::ScoredMask;

/// Masks in flat colours over a dimmed image, smaller over larger.
pub(super) fn masks(image: &RgbImage, masks: &[ScoredMask]) -> RgbImage {
    let mut picture =
        RgbImage::from_fn(image.width(), image.height(), |x, y| Rgb(image.get_pixel(x, y).0.map(|v| v / 3)));
    let mut order: Vec<(usize, &Mask)> = masks.iter().map(|m| &m.mask).enumerate().collect();
    order.sort_by_key(|(_, m)| std::cmp::Reverse(m.area()));
    for (i, mask) in order {
        let colour = Rgb(label_colour(i as u32 + 1));
        mask.pixels().for_each(|(x, y)| picture.put_pixel(x as u32, y as u32, colour));
    }
    picture
}

/// Primaries in the colours of their categories.
pub(super) fn categories(primaries: &LabelMap, ids: &[CategoryId]) -> RgbImage {
    labels(&by_category(primaries, ids))
}

fn by_category(primaries: &LabelMap, ids: &[CategoryId]) -> LabelMap {
    let category = |&l: &u32| if l == 0 { 0 } else { u32::from(ids[l as usize - 1].0) + 1 };
    LabelMap { labels: primaries.labels.iter().map(category).collect(), ..*primaries }
}

/// The descriptor windows of the first few primaries whose window fits the image, side by side.
pub(super) fn descriptors(
    primaries: &LabelMap,
    ids: &[CategoryId],
    centroids: &[[f64; 2]],
    half: u32,
) -> RgbImage {
    let map = by_category(primaries, ids);
    let (side, gap) = (2 * half + 1, 6);
    let inside = |c: &&[f64; 2]| {
        let h = f64::from(half);
        c[0] >= h && c[1] >= h && c[0] + h < f64::from(map.width) && c[1] + h < f64::from(map.height)
    };
    let shown: Vec<&[f64; 2]> = centroids.iter().filter(inside).take(6).collect();
    let mut picture = RgbImage::from_pixel((side + gap) * shown.len().max(1) as u32, side, Rgb([255; 3]));
    for (k, c) in shown.iter().enumerate() {
        let (x0, y0) = (c[0] as i64 - i64::from(half), c[1] as i64 - i64::from(half));
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let label = map.at(x0 + i64::from(x), y0 + i64::from(y)).unwrap_or(0);
            picture.put_pixel(k as u32 * (side + gap) + x, y, Rgb(label_colour(label)));
        }
    }
    picture
}

/// The background pixels that the palette is sampled from, with a square of its colour at each site.
pub(super) fn background(image: &RgbImage, textons: &LabelMap, backgrounds: &[Field]) -> RgbImage {
    let mut picture = RgbImage::from_fn(image.width(), image.height(), |x, y| {
        if textons.get(x, y) == 0 { *image.get_pixel(x, y) } else { Rgb([0; 3]) }
    });
    for site in backgrounds.iter().flat_map(|field| &field.points) {
        for (dx, dy) in (-4..=4i64).flat_map(|dy| (-4..=4i64).map(move |dx| (dx, dy))) {
            let (x, y) = (site.x as i64 + dx, site.y as i64 + dy);
            if x >= 0 && y >= 0 && x < i64::from(image.width()) && y < i64::from(image.height()) {
                let edge = dx.abs() == 4 || dy.abs() == 4;
                picture.put_pixel(x as u32, y as u32, Rgb(if edge { [255; 3] } else { site.colour.0 }));
            }
        }
    }
    picture
}
