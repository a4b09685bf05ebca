//! Local binary patterns (Ojala and others 2002): which points on a circle are at least as bright
//! as the pixel at its centre.

use super::plane::Channel;
use vtex_base::parallel;

/// For each circle, its number of points and its radius in pixels.
const CIRCLES: [(usize, f64); 3] = [(8, 1.0), (16, 2.0), (24, 3.0)];

/// χ² distance between histograms of uniform patterns, averaged over three circles and two scales,
/// 0 to 1.
pub(super) fn lbp(a: &Channel, b: &Channel) -> f64 {
    let (a, b) = (histograms(a), histograms(b));
    let distance = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        0.5 * a.iter().zip(b).map(|(x, y)| (x - y) * (x - y) / (x + y + 1e-12)).sum::<f64>()
    };
    let all: Vec<f64> = a.iter().zip(&b).map(distance).collect();
    all.iter().sum::<f64>() / all.len() as f64
}

fn histograms(plane: &Channel) -> Vec<Vec<f64>> {
    let half = |side: usize| libm::rint(side as f64 * 0.5) as usize;
    let smaller = plane.smooth(1.0).resized(half(plane.width), half(plane.height));
    let scales = [plane, &smaller].into_iter();
    scales
        .flat_map(|p| {
            let steps = Steps::new(p);
            CIRCLES.map(|(points, radius)| steps.histogram(points, radius))
        })
        .collect()
}

/// A picture quantised to 256 levels of brightness.
struct Steps {
    width: usize,
    height: usize,
    data: Vec<f64>,
}

/// A point on a circle, with its bilinear weights and the offsets of the four pixels around it.
struct Point {
    at: [f64; 2],
    corners: [(isize, isize); 4],
}

impl Steps {
    fn new(plane: &Channel) -> Self {
        let data = plane.data.iter().map(|v| f64::from((v.clamp(0.0, 1.0) * 255.0) as u8));
        Self { width: plane.width, height: plane.height, data: data.collect() }
    }

    /// Brightness; 0 outside.
    fn at(&self, x: isize, y: isize) -> f64 {
        let inside = x >= 0 && y >= 0 && x < self.width as isize && y < self.height as isize;
        if inside { self.data[y as usize * self.width + x as usize] } else { 0.0 }
    }

    /// Shares of each pattern. Uniform patterns, which change at most twice around the circle, have one
    /// bin for each number of bright points, 0 to all; the last bin holds all other patterns.
    fn histogram(&self, points: usize, radius: f64) -> Vec<f64> {
        let circle = Circle::new(points, radius);
        let columns: Vec<Vec<f64>> = (0..self.width).map(|x| circle.weights(x as isize, 0)).collect();
        let rows: Vec<usize> = (0..self.height).collect();
        let counts = parallel::map(&rows, |&y| {
            let down = circle.weights(y as isize, 1);
            let mut counts = vec![0u32; points + 2];
            for (x, across) in columns.iter().enumerate() {
                counts[self.pattern(&circle, [x, y], [across, &down])] += 1;
            }
            counts
        });
        let all = (self.width * self.height) as f64;
        (0..points + 2).map(|k| counts.iter().map(|c| f64::from(c[k])).sum::<f64>() / all).collect()
    }

    /// The pattern around a pixel, with the circle's weights at its column and at its row.
    fn pattern(&self, circle: &Circle, [x, y]: [usize; 2], [across, down]: [&[f64]; 2]) -> usize {
        let own = self.data[y * self.width + x];
        let within = |v: usize, size: usize| v >= circle.reach && v + circle.reach < size;
        let inside = within(x, self.width) && within(y, self.height);
        let (mut bright, mut changes, mut last) = (0, 0, None);
        for (point, (u, v)) in circle.points.iter().zip(across.iter().zip(down)) {
            let corner = |(dx, dy): (isize, isize)| {
                let [x, y] = [x as isize + dx, y as isize + dy];
                if inside { self.data[y as usize * self.width + x as usize] } else { self.at(x, y) }
            };
            let [a, b, c, d] = point.corners.map(corner);
            let (top, bottom) = ((1.0 - u) * a + u * b, (1.0 - u) * c + u * d);
            let set = (1.0 - v) * top + v * bottom - own >= 0.0;
            bright += usize::from(set);
            changes += usize::from(last.is_some_and(|l| l != set));
            last = Some(set);
        }
        if changes <= 2 { bright } else { circle.points.len() + 1 }
    }
}

/// Points on a circle.
struct Circle {
    points: Vec<Point>,
    /// Largest distance of their pixels from the centre.
    reach: usize,
}

impl Circle {
    fn new(points: usize, radius: f64) -> Self {
        let points = (0..points).map(|k| Point::new(k, points, radius)).collect();
        Self { points, reach: libm::ceil(radius) as usize }
    }

    /// The weight of each point's further pixels along an axis, around a column or row.
    fn weights(&self, pixel: isize, axis: usize) -> Vec<f64> {
        let weight = |point: &Point| {
            let floor = [point.corners[0].0, point.corners[0].1][axis];
            // Rounded like the pixel's own coordinates: in flat areas the last digit decides.
            (pixel as f64 + point.at[axis]) - (pixel + floor) as f64
        };
        self.points.iter().map(weight).collect()
    }
}

impl Point {
    fn new(k: usize, points: usize, radius: f64) -> Self {
        let angle = 2.0 * std::f64::consts::PI * k as f64 / points as f64;
        // Five decimals, so that points meant to lie on pixels do.
        let decimals = |v: f64| libm::rint(v * 1e5) / 1e5;
        let (x, y) = (decimals(radius * libm::cos(angle)), decimals(-radius * libm::sin(angle)));
        let [x0, x1, y0, y1] =
            [libm::floor(x), libm::ceil(x), libm::floor(y), libm::ceil(y)].map(|v| v as isize);
        Self { at: [x, y], corners: [(x0, y0), (x1, y0), (x0, y1), (x1, y1)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Steps {
        fn around(&self, circle: &Circle, at: [usize; 2]) -> usize {
            let weights = [0, 1].map(|k| circle.weights(at[k] as isize, k));
            self.pattern(circle, at, weights.each_ref().map(Vec::as_slice))
        }
    }

    #[test]
    fn a_flat_picture_has_one_pattern_inside() {
        let flat = Steps::new(&Channel::from_fn(20, 20, |_, _| 0.5));
        for (points, radius) in CIRCLES {
            let circle = Circle::new(points, radius);
            assert_eq!(flat.around(&circle, [10, 10]), points);
            // Points beyond the border count as black.
            assert!(flat.around(&circle, [0, 10]) < points);
        }
    }

    #[test]
    fn an_edge_is_uniform_and_a_line_is_not() {
        let pattern = |plane: Channel| Steps::new(&plane).around(&Circle::new(8, 1.0), [5, 5]);
        assert_eq!(pattern(Channel::from_fn(11, 11, |x, _| if x < 6 { 0.8 } else { 0.2 })), 5);
        assert_eq!(pattern(Channel::from_fn(11, 11, |x, y| ((x + y) % 2) as f32)), 8);
        assert_eq!(pattern(Channel::from_fn(11, 11, |x, _| (x % 2) as f32)), 9);
    }

    #[test]
    fn unlike_pictures_are_further_apart() {
        let wave =
            |length: usize| Channel::from_fn(64, 64, |x, y| ((x * 3 + y) % length) as f32 / length as f32);
        assert_eq!(lbp(&wave(9), &wave(9)), 0.0);
        assert!(lbp(&wave(9), &wave(23)) > 10.0 * lbp(&wave(23), &wave(24)));
    }
}
