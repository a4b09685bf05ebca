//! Overlap of primaries.
//!
//! The canvas is painted in bands of rows, so memory does not grow with its height; shapes are the
//! pixels of the exemplar's arrangement.

use crate::library::Library;
use crate::scene::pixels;
use crate::scene::{Scene, Tile};
use kurbo::Point;
use serde::Serialize;
use vtex_base::geometry::Affine;
use vtex_base::parallel;
use vtex_base::raster::{Mask, Span};

/// Rows of a band.
const BAND: i32 = 64;

/// Mutual overlap of primaries, counted in pixels of the canvas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Overlap {
    /// Share of the area of all primaries that lies beneath others, 0 to 1.
    pub hidden: f64,
    /// Share of the primaries of which more than half lies beneath others, 0 to 1.
    pub buried: f64,
}

/// A shape at a place.
pub(super) struct Stamp<'a> {
    pub(super) mask: &'a Mask,
    /// Brings the shape to the canvas.
    pub(super) transform: Affine,
}

impl Overlap {
    /// Measures the primaries of a scene made from `libraries`. Textons that are missing in their library, as
    /// after a mix-up of files, are ignored.
    pub fn of_scene(scene: &Scene, libraries: &[Library]) -> Self {
        let masks: Vec<Vec<Mask>> = libraries.iter().map(silhouettes).collect();
        let fused: Vec<Option<Mask>> =
            parallel::map(&scene.elements, |t| t.fused.then(|| pixels::mask(t.outline())));
        let stamp = |i: &crate::scene::Instance| {
            let element = scene.elements.get(i.element.index())?;
            if let Some(mask) = fused.get(i.element.index())? {
                return Some(Stamp { mask, transform: i.affine() });
            }
            let mask = masks.get(element.library.index())?.get(element.source?.index())?;
            Some(Stamp { mask, transform: i.affine() })
        };
        let stamps: Vec<Stamp<'_>> = scene.individuals().filter_map(stamp).collect();
        Self::of_stamps(&stamps, [scene.width, scene.height], scene.tile)
    }

    /// Measures shapes in painting order.
    pub(super) fn of_stamps(stamps: &[Stamp<'_>], size: [u32; 2], tile: Tile) -> Self {
        let canvas = CanvasBounds { size: size.map(|s| s as i32), tile };
        let shapes = parallel::map(stamps, |s| canvas.rows(s));
        let bands = (canvas.size[1] + BAND - 1) / BAND;
        let mut members = vec![Vec::new(); bands as usize];
        for (i, spans) in shapes.iter().enumerate() {
            let mut first = 0;
            while let Some(span) = spans.get(first) {
                let band = span.y / BAND;
                let end = first + spans[first..].partition_point(|s| s.y < (band + 1) * BAND);
                members[band as usize].push((i, first..end));
                first = end;
            }
        }
        let numbers: Vec<i32> = (0..bands).collect();
        let counts = parallel::map(&numbers, |&band| {
            let width = canvas.size[0] as usize;
            let mut owner = vec![0u32; width * BAND as usize];
            let members = &members[band as usize];
            for (k, (i, spans)) in members.iter().enumerate() {
                for s in &shapes[*i][spans.clone()] {
                    let row = (s.y - band * BAND) as usize * width;
                    owner[row + s.x0 as usize..row + s.x1 as usize].fill(k as u32 + 1);
                }
            }
            let mut visible = vec![0u64; members.len() + 1];
            for run in owner.chunk_by(|a, b| a == b) {
                visible[run[0] as usize] += run.len() as u64;
            }
            visible
        });
        let mut visible = vec![0u64; stamps.len()];
        for (members, counts) in members.iter().zip(&counts) {
            for ((i, _), count) in members.iter().zip(&counts[1..]) {
                visible[*i] += count;
            }
        }
        let areas: Vec<u64> =
            shapes.iter().map(|s| s.iter().map(|span| u64::from(span.len())).sum()).collect();
        let share = |part: u64, of: u64| if of == 0 { 0.0 } else { part as f64 / of as f64 };
        let shown: u64 = visible.iter().sum();
        let area: u64 = areas.iter().sum();
        let seen = areas.iter().filter(|a| **a > 0).count();
        let buried = areas.iter().zip(&visible).filter(|(a, v)| **v * 2 < **a).count();
        Self { hidden: share(area - shown, area), buried: share(buried as u64, seen as u64) }
    }
}

/// The pixels of every primary around its origin.
fn silhouettes(library: &Library) -> Vec<Mask> {
    let map = library.arrangement.to_labels();
    let masks = Mask::all_of_labels(&map, library.primaries().len() + 1);
    let size = [map.width as i32, map.height as i32];
    let torus = library.arrangement.periodic.then_some(size);
    let origin = |p: &crate::library::ExemplarElement| p.centroid.map(|v| libm::round(v) as i32);
    library.primaries().iter().zip(&masks[1..]).map(|(p, m)| m.around(origin(p), torus)).collect()
}

/// The canvas as far as shapes are cut or wrapped by it.
struct CanvasBounds {
    size: [i32; 2],
    tile: Tile,
}

impl CanvasBounds {
    /// The pixels of a shape on the canvas, by row.
    fn rows(&self, stamp: &Stamp<'_>) -> Vec<Span> {
        let [a, b, c, d, e, f] = stamp.transform.as_coeffs();
        let straight = [a, b, c, d] == [1.0, 0.0, 0.0, 1.0] && e == libm::floor(e) && f == libm::floor(f);
        let mut found = Vec::with_capacity(stamp.mask.spans().len());
        if straight {
            let shift = [e as i32, f as i32];
            for s in stamp.mask.spans() {
                self.push(s.y + shift[1], s.x0 + shift[0], s.x1 + shift[0], &mut found);
            }
        } else {
            for s in turned(stamp) {
                self.push(s.y, s.x0, s.x1, &mut found);
            }
        }
        // Each pixel counts once, even if a shape overlaps itself around a small torus.
        Mask::from_spans(found).spans().to_vec()
    }

    /// Adds the parts of a run that are on the canvas.
    fn push(&self, y: i32, x0: i32, x1: i32, found: &mut Vec<Span>) {
        let [w, h] = self.size;
        let y = if self.tile.y { y.rem_euclid(h) } else { y };
        if !(0..h).contains(&y) {
            return;
        }
        if !self.tile.x {
            found.push(Span { y, x0: x0.max(0), x1: x1.min(w) });
            return;
        }
        let mut x = x0;
        while x < x1 {
            let start = x.rem_euclid(w);
            let len = (x1 - x).min(w - start);
            found.push(Span { y, x0: start, x1: start + len });
            x += len;
        }
    }
}

/// The pixels whose centres lie in a shape that is turned, mirrored or scaled.
fn turned(stamp: &Stamp<'_>) -> Vec<Span> {
    let Some((x0, y0, x1, y1)) = stamp.mask.bounds() else { return Vec::new() };
    let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)]
        .map(|(x, y)| stamp.transform * Point::new(f64::from(x), f64::from(y)));
    let low = corners.into_iter().reduce(|a, b| Point::new(a.x.min(b.x), a.y.min(b.y)));
    let high = corners.into_iter().reduce(|a, b| Point::new(a.x.max(b.x), a.y.max(b.y)));
    let (Some(low), Some(high)) = (low, high) else { return Vec::new() };
    // A degenerate shape, or one larger than any canvas, has no pixels.
    let determinant = stamp.transform.determinant();
    if !(determinant.abs() > 1e-6 && (high - low).hypot2() < 1e9) {
        return Vec::new();
    }
    let back = stamp.transform.inverse();
    let [a, b, ..] = back.as_coeffs();
    let mut spans = Vec::new();
    for y in libm::floor(low.y) as i32..libm::ceil(high.y) as i32 {
        let from = libm::floor(low.x) as i32;
        let start = back * Point::new(f64::from(from) + 0.5, f64::from(y) + 0.5);
        for i in 0..libm::ceil(high.x) as i32 - from {
            let (px, py) = (start.x + a * f64::from(i), start.y + b * f64::from(i));
            if stamp.mask.contains(libm::floor(px) as i32, libm::floor(py) as i32) {
                spans.push(Span { y, x0: from + i, x1: from + i + 1 });
            }
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: i32) -> Mask {
        Mask::from_spans((0..side).map(|y| Span { y, x0: 0, x1: side }).collect())
    }

    fn at(mask: &Mask, x: f64, y: f64) -> Stamp<'_> {
        Stamp { mask, transform: Affine::translate((x, y)) }
    }

    #[test]
    fn hidden_area_is_that_beneath_others() {
        let (large, small) = (square(10), square(4));
        let tile = Tile::default();
        let of = |stamps: &[Stamp<'_>]| Overlap::of_stamps(stamps, [100, 150], tile);
        assert_eq!(of(&[]), Overlap::default());
        assert_eq!(of(&[at(&large, 0.0, 0.0), at(&large, 10.0, 0.0)]), Overlap::default());
        // 16 of 116 px; the small one, on top, hides a sixth of the large one.
        let one = of(&[at(&large, 20.0, 60.0), at(&small, 22.0, 62.0)]);
        assert!((one.hidden - 16.0 / 116.0).abs() < 1e-12 && one.buried == 0.0, "{one:?}");
        // In the other order all of the small one is hidden, even across the border of two bands.
        let two = of(&[at(&small, 22.0, 62.0), at(&large, 20.0, 60.0)]);
        assert!((two.hidden - 16.0 / 116.0).abs() < 1e-12 && two.buried == 0.5, "{two:?}");
        // Pixels off the canvas do not count: 50 px of each are on it, those of the lower ones are all
        // hidden.
        let three = of(&[at(&large, -5.0, 0.0), at(&large, -5.0, 0.0), at(&large, 200.0, 0.0)]);
        assert_eq!(three, Overlap { hidden: 0.5, buried: 0.5 });
    }

    #[test]
    fn on_a_torus_textons_meet_across_the_border() {
        let shape = square(10);
        let stamps = [at(&shape, 95.0, 145.0), at(&shape, -5.0, -5.0)];
        let tile = |x, y| Overlap::of_stamps(&stamps, [100, 150], Tile { x, y });
        assert_eq!(tile(true, true), Overlap { hidden: 0.5, buried: 0.5 });
        assert_eq!(tile(false, false), Overlap::default());
        assert_eq!(tile(true, false), Overlap::default());
    }

    #[test]
    fn turned_and_scaled_shapes_keep_their_area() {
        let shape = square(40);
        for (transform, hidden) in [
            (vtex_base::geometry::rotation(std::f64::consts::FRAC_PI_2), 0.5),
            (Affine::scale_non_uniform(-1.0, 1.0), 0.5),
            (Affine::scale(0.5), 0.2),
            (Affine::scale(0.0), 0.0),
            (Affine::scale(f64::NAN), 0.0),
        ] {
            // A square above it covers all of the second one.
            let transform = Affine::translate((100.0, 100.0)) * transform * Affine::translate((-20.0, -20.0));
            let stamps = [Stamp { mask: &shape, transform }, at(&shape, 80.0, 80.0)];
            let found = Overlap::of_stamps(&stamps, [200, 200], Tile::default());
            assert!((found.hidden - hidden).abs() < 0.02, "{transform:?}: {found:?}");
        }
        let eighth = Affine::translate((100.0, 100.0)) * vtex_base::geometry::rotation(0.7);
        let area: u32 = turned(&Stamp { mask: &shape, transform: eighth }).iter().map(Span::len).sum();
        assert!((area as i32 - 1600).abs() < 30, "{area}");
    }
}
