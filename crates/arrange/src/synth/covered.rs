//! Coverage of a drawing's scene, counted in pixels.

use vtex_base::error::Result;
use vtex_base::geometry::Affine;
use vtex_scene::library::Library;
use vtex_scene::scene::{Scene, pixels};

/// Largest difference of an angle or a size from that of an equal element, for one that is only moved.
pub(super) const MOVED: f64 = 1e-3;
/// Largest canvas on which covered pixels are counted.
pub(super) const MOST_COUNTED: u64 = 100_000_000;

/// Whether a map neither turns nor resizes.
pub(super) fn is_moved(map: Affine) -> bool {
    let [a, b, c, d, ..] = map.as_coeffs();
    [a - 1.0, b, c, d - 1.0].iter().all(|v| v.abs() < MOVED)
}

/// Share of the canvas that each category visibly covers; that of the exemplar where the canvas is too large to count.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn covered(library: &Library, scene: &Scene, go_on: impl Fn() -> Result<()>) -> Result<Vec<f64>> {
    let [width, height] = [scene.width, scene.height];
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MOST_COUNTED {
        return Ok(library.categories.iter().map(|c| c.coverage).collect());
    }
    let masks: Vec<_> = scene.elements.iter().map(|e| pixels::of_shapes(&e.shapes)).collect();
    let mut cells = vec![0u16; pixels as usize];
    for instance in scene.instances() {
        go_on()?;
        let element = &scene.elements[instance.element.index()];
        let map = instance.affine();
        let mask = if is_moved(map) {
            let by = map.translation();
            masks[instance.element.index()].shifted(libm::round(by.x) as i32, libm::round(by.y) as i32)
        } else {
            let shapes: Vec<_> = element.shapes.iter().map(|s| s.moved(map)).collect();
            pixels::of_shapes(&shapes)
        };
        let value = element.category.map_or(0, |c| c.index() as u16 + 1);
        for by in scene.copies(map.transform_rect_bbox(element.bounds())) {
            let (dx, dy) = (libm::round(by.x) as i32, libm::round(by.y) as i32);
            for span in mask.spans() {
                let (row, x0, x1) = (span.y + dy, (span.x0 + dx).max(0), (span.x1 + dx).min(width as i32));
                if (0..height as i32).contains(&row) && x0 < x1 {
                    let start = row as usize * width as usize;
                    cells[start + x0 as usize..start + x1 as usize].fill(value);
                }
            }
        }
    }
    let mut counts = vec![0u64; library.categories.len() + 1];
    for cell in cells {
        counts[usize::from(cell)] += 1;
    }
    Ok(counts[1..].iter().map(|n| *n as f64 / pixels as f64).collect())
}
