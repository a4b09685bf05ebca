//! Windows around the pixels of a border, and the distance of two borders.

use super::super::map::LayerRegion;
use vtex_base::parallel;
use vtex_base::raster::continued;

/// Words of a window of 15 × 15 bits.
const WORDS: usize = 4;

/// A window: one bit for each pixel, row by row.
pub(super) type Window = [u64; WORDS];

/// The windows around all border pixels of a region.
pub(super) struct BorderWindows {
    /// Side of a window in pixels, odd.
    pub(super) side: usize,
    /// Border pixels: inside, with one of the four adjacent pixels outside.
    pub(super) at: Vec<u32>,
    /// The window of each, in all four rotations.
    pub(super) windows: Vec<[Window; 4]>,
}

/// The pixel at an offset: across the seam where the region repeats, mirrored at other borders.
fn index(region: &LayerRegion, [x, y]: [usize; 2], d: [i64; 2]) -> usize {
    let axis = |v: usize, d: i64, k: usize| continued(v as i64 + d, region.size[k], region.wrap[k]);
    axis(y, d[1], 1) * region.size[0] + axis(x, d[0], 0)
}

/// The pixels of the window around a pixel, row by row.
pub(super) fn shown(region: &LayerRegion, pixel: usize, side: usize) -> impl Iterator<Item = usize> + '_ {
    let at = [pixel % region.size[0], pixel / region.size[0]];
    let reach = (side / 2) as i64;
    (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| index(region, at, [dx, dy])))
}

/// The position of each bit of a window after its rotation by `turn` quarters.
pub(super) fn turned(side: usize, turn: usize) -> impl Iterator<Item = usize> {
    (0..side * side).map(move |i| {
        let (mut x, mut y) = (i % side, i / side);
        for _ in 0..turn {
            (x, y) = (side - 1 - y, x);
        }
        y * side + x
    })
}

impl BorderWindows {
    pub(super) fn new(region: &LayerRegion, side: usize) -> Self {
        let [w, h] = region.size;
        let is_border = |&i: &usize| {
            let at = [i % w, i / w];
            region.inside[i]
                && [[-1, 0], [1, 0], [0, -1], [0, 1]].iter().any(|&d| !region.inside[index(region, at, d)])
        };
        let at: Vec<u32> = (0..w * h).filter(is_border).map(|i| i as u32).collect();
        let turns: Vec<Vec<usize>> = (0..4).map(|turn| turned(side, turn).collect()).collect();
        let windows = parallel::map(&at, |&pixel| {
            let mut windows = [[0; WORDS]; 4];
            for (i, q) in shown(region, pixel as usize, side).enumerate() {
                if region.inside[q] {
                    for (window, turn) in windows.iter_mut().zip(&turns) {
                        window[turn[i] / 64] |= 1 << (turn[i] % 64);
                    }
                }
            }
            windows
        });
        Self { side, at, windows }
    }

    pub(super) fn len(&self) -> usize {
        self.at.len()
    }
}

/// Number of pixels in which two windows differ.
#[inline]
pub(super) fn differing(a: &Window, b: &Window) -> u32 {
    (0..WORDS).map(|k| (a[k] ^ b[k]).count_ones()).sum()
}

/// Number of pixels in which two windows differ in the best of the given rotations of the second, and that
/// rotation. Ties go to the first.
#[inline]
pub(super) fn best_turn(window: &Window, other: &[Window; 4], turns: &[usize]) -> (u32, usize) {
    let mut best = (u32::MAX, 0);
    for &turn in turns {
        let d = differing(window, &other[turn]);
        if d < best.0 {
            best = (d, turn);
        }
    }
    best
}

/// Bidirectional distance of the borders of two regions: the mean number of pixels in which the window
/// of 15 × 15 pixels around a border pixel differs from the most similar one of the other border, in
/// the best of four turns (the paper, eq. 1–3). 0 for equal regions; infinite if one of the two
/// has no border and the other has.
pub fn shape_distance(a: &LayerRegion, b: &LayerRegion) -> f64 {
    let [a, b] = [a, b].map(|region| BorderWindows::new(region, 15));
    distance(&a, &b)
}

/// The distance of two sets of windows.
pub(super) fn distance(a: &BorderWindows, b: &BorderWindows) -> f64 {
    if a.len() + b.len() == 0 {
        return 0.0;
    }
    if a.len() == 0 || b.len() == 0 {
        return f64::INFINITY;
    }
    let one_way = |from: &BorderWindows, to: &BorderWindows| -> u64 {
        let nearest = |window: &[Window; 4]| {
            let each = to.windows.iter().map(|other| best_turn(&window[0], other, &[0, 1, 2, 3]).0);
            u64::from(each.min().unwrap_or(0))
        };
        parallel::map(&from.windows, nearest).iter().sum()
    };
    (one_way(a, b) + one_way(b, a)) as f64 / (a.len() + b.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(inside: impl Fn(f64, f64) -> bool) -> LayerRegion {
        let at = |i: usize| ((i % 64) as f64 - 31.5, (i / 64) as f64 - 31.5);
        LayerRegion {
            size: [64; 2],
            wrap: [false; 2],
            inside: (0..64 * 64).map(|i| inside(at(i).0, at(i).1)).collect(),
        }
    }

    fn shapes() -> [LayerRegion; 5] {
        let radius = |x: f64, y: f64| libm::sqrt(x * x + y * y);
        let angle = |x: f64, y: f64| libm::atan2(y, x);
        [
            region(|x, y| radius(x, y) < 20.0),
            region(|x, y| x.abs() < 17.0 && y.abs() < 17.0),
            region(|x, y| radius(x, y) < 14.0 + 9.0 * libm::cos(5.0 * angle(x, y))),
            region(|x, y| radius(x, y) < 20.0 + 4.0 * libm::sin(3.0 * angle(x, y) + 1.0)),
            region(|x, y| {
                radius(x, y)
                    < 19.0 + 3.0 * libm::sin(17.0 * angle(x, y)) + 2.0 * libm::cos(29.0 * angle(x, y))
            }),
        ]
    }

    #[test]
    fn a_shape_is_nearest_to_itself() {
        let shapes = shapes();
        for (i, a) in shapes.iter().enumerate() {
            assert_eq!(shape_distance(a, a), 0.0);
            for (j, b) in shapes.iter().enumerate() {
                assert_eq!(shape_distance(a, b), shape_distance(b, a));
                assert!(i == j || shape_distance(a, b) > 1.0, "{i} {j}: {}", shape_distance(a, b));
            }
        }
    }

    #[test]
    fn turns_make_no_difference() {
        for shape in shapes() {
            let mut turned = shape.clone();
            for i in 0..64 * 64 {
                turned.inside[i % 64 * 64 + 63 - i / 64] = shape.inside[i];
            }
            assert_eq!(shape_distance(&shape, &turned), 0.0);
        }
    }

    #[test]
    fn no_border_is_infinitely_far() {
        let empty = region(|_, _| false);
        assert_eq!(shape_distance(&empty, &empty), 0.0);
        assert_eq!(shape_distance(&empty, &shapes()[0]), f64::INFINITY);
    }
}
