//! Scene → the coverage of the canvas by the elements of each category.

use super::paths::{ClipRegion, path_of};
use std::collections::BTreeMap;
use tiny_skia::{Color, FillRule, Paint, Path, PixmapMut, Transform};
use vtex_base::geometry::{Affine, Rect};
use vtex_base::parallel;
use vtex_scene::scene::{CategoryId, LibraryId, Scene};

/// Height of the bands counted at a time, in pixels.
const BAND: u32 = 256;

/// For each library and category, in order, the number of pixels on which a primary of the category is on
/// top, among those that [`inside`] counts. Pixels are counted by their centres. Categories without a texton
/// in the scene are left out.
pub fn coverage(scene: &Scene) -> BTreeMap<(LibraryId, CategoryId), u64> {
    let mut pixels: BTreeMap<(LibraryId, CategoryId), u64> = BTreeMap::new();
    for element in &scene.elements {
        pixels.extend(element.category.map(|c| ((element.library, c), 0)));
    }
    let keys: Vec<(LibraryId, CategoryId)> = pixels.keys().copied().collect();
    let shapes: Vec<Option<(Path, Rect, u32)>> = parallel::map(&scene.elements, |element| {
        let key = (element.library, element.category?);
        let number = keys.binary_search(&key).ok()? as u32 + 1;
        Some((path_of(element.outline())?, element.outline().bounds(), number))
    });
    let region = scene.domain.is_some().then(|| ClipRegion::of_domain(scene, [1.0; 2]));
    let counts = parallel::map(&bands(scene), |&(top, rows)| {
        count_band(scene, &shapes, region.as_ref(), keys.len(), top, rows)
    });
    for band in counts {
        for (total, count) in pixels.values_mut().zip(band) {
            *total += count;
        }
    }
    pixels
}

/// Number of pixels of the canvas: all `width * height`, or those of a domain, by their centres.
pub fn inside(scene: &Scene) -> u64 {
    if scene.domain.is_none() {
        return u64::from(scene.width) * u64::from(scene.height);
    }
    let region = ClipRegion::of_domain(scene, [1.0; 2]);
    let counts = parallel::map(&bands(scene), |&(top, rows)| {
        let mask = region.mask(scene.width, rows, f64::from(top), false);
        mask.map_or(0, |m| m.data().iter().filter(|v| **v > 0).count() as u64)
    });
    counts.into_iter().sum()
}

/// First row and number of rows of the bands counted at a time.
fn bands(scene: &Scene) -> Vec<(u32, u32)> {
    let tops = (0..scene.height).step_by(BAND as usize);
    tops.map(|top| (top, BAND.min(scene.height - top))).collect()
}

fn count_band(
    scene: &Scene,
    shapes: &[Option<(Path, Rect, u32)>],
    region: Option<&ClipRegion>,
    categories: usize,
    top: u32,
    rows: u32,
) -> Vec<u64> {
    let mut counts = vec![0; categories];
    let mut data = vec![0; scene.width as usize * rows as usize * 4];
    let Some(mut band) = PixmapMut::from_bytes(&mut data, scene.width, rows) else { return counts };
    let (y0, y1) = (f64::from(top), f64::from(top + rows));
    for instance in scene.individuals() {
        let Some((path, bounds, number)) = &shapes[instance.element.index()] else { continue };
        let affine: Affine = instance.affine();
        let bounds = affine.transform_rect_bbox(*bounds);
        // The number of the category, as an opaque colour without blending.
        let [_, r, g, b] = number.to_be_bytes();
        let mut paint = Paint { anti_alias: false, ..Paint::default() };
        paint.set_color(Color::from_rgba8(r, g, b, 255));
        for shift in scene.copies(bounds) {
            if bounds.y1 + shift.y < y0 || bounds.y0 + shift.y > y1 {
                continue;
            }
            let [a, bb, c, d, e, f] = affine.then_translate(shift).as_coeffs();
            let [a, bb, c, d, e, f] = [a, bb, c, d, e, f - y0].map(|v| v as f32);
            band.fill_path(path, &paint, FillRule::Winding, Transform::from_row(a, bb, c, d, e, f), None);
        }
    }
    let mask = region.and_then(|r| r.mask(scene.width, rows, y0, false));
    for (i, pixel) in data.chunks_exact(4).enumerate() {
        if mask.as_ref().is_some_and(|m| m.data()[i] == 0) {
            continue;
        }
        let number = u32::from_be_bytes([0, pixel[0], pixel[1], pixel[2]]) as usize;
        if let Some(count) = number.checked_sub(1).and_then(|i| counts.get_mut(i)) {
            *count += 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::{BezPath, Outline};
    use vtex_base::raster::colour::Colour;
    use vtex_scene::scene::{Element, ElementId, Instance, InstanceId, testing};

    fn square(category: Option<u16>) -> Element {
        let mut path = BezPath::new();
        path.move_to((0.0, 0.0));
        for corner in [(10.0, 0.0), (10.0, 10.0), (0.0, 10.0)] {
            path.line_to(corner);
        }
        path.close_path();
        testing::element(0, category, Outline::new(&path).unwrap(), Colour([9; 3]))
    }

    #[test]
    fn what_is_on_top_and_inside_counts() {
        let place = |id, element, x, y| Instance {
            transform: [1.0, 0.0, 0.0, 1.0, x, y],
            ..Instance::new(InstanceId(id), ElementId(element))
        };
        let elements = vec![square(Some(3)), square(Some(300)), square(None), square(Some(7))];
        // Half covered, across two bands, half outside.
        let primary = vec![
            place(1, 0, 0.0, 0.0),
            place(2, 1, 5.0, 0.0),
            place(3, 0, 20.0, 251.0),
            place(4, 1, 35.0, 590.0),
        ];
        let secondary = vec![place(0, 2, 20.0, 20.0)];
        let field = testing::flat(Colour([0; 3]));
        let scene = testing::scene([40, 600], elements, secondary, primary, field);
        let counted: Vec<_> = coverage(&scene).into_iter().collect();
        assert_eq!(
            counted,
            [(3, 150), (7, 0), (300, 150)].map(|(category, n)| ((LibraryId(0), CategoryId(category)), n))
        );
    }
}
