//! Planes whose opposite sides may be joined, and points found by their place on them.

/// A rectangle from the origin. Lengths in any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodicPlane {
    /// Width and height.
    pub size: [f64; 2],
    /// The axes whose opposite sides are joined.
    pub wraps: [bool; 2],
}

impl PeriodicPlane {
    /// The shortest way from one point to another.
    pub fn between(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| {
            let d = to[k] - from[k];
            let size = self.size[k];
            if !self.wraps[k] || d.abs() <= 0.5 * size {
                d
            } else if d.abs() <= 1.5 * size {
                d - size.copysign(d)
            } else {
                d - size * libm::round(d / size)
            }
        })
    }

    /// The point on the rectangle that is the same where sides are joined.
    pub fn wrapped(&self, p: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| {
            let size = self.size[k];
            if self.wraps[k] && !(0.0..size).contains(&p[k]) {
                let q = p[k] - size * libm::floor(p[k] / size);
                if q < size { q } else { 0.0 }
            } else {
                p[k]
            }
        })
    }

    /// Width times height.
    pub fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }
}

/// Length of a vector.
pub fn length(v: [f64; 2]) -> f64 {
    libm::sqrt(v[0] * v[0] + v[1] * v[1])
}

/// Length of a course through points.
pub fn along(course: &[[f64; 2]]) -> f64 {
    course.windows(2).map(|w| length([w[1][0] - w[0][0], w[1][1] - w[0][1]])).sum()
}

/// Most cells of an index along an axis.
const MOST_CELLS: f64 = 2048.0;

/// Points in cells, to find those near a place.
#[derive(Debug)]
pub struct PointIndex {
    plane: PeriodicPlane,
    cells: [usize; 2],
    /// The points of cell c are `ids[starts[c]..starts[c + 1]]`, in their order.
    starts: Vec<u32>,
    ids: Vec<u32>,
    points: Vec<[f64; 2]>,
}

impl PointIndex {
    /// An index for searches within about `reach`.
    pub fn new(plane: PeriodicPlane, reach: f64, points: &[[f64; 2]]) -> Self {
        let count = |size: f64| (size / reach.max(1e-9)).clamp(1.0, MOST_CELLS) as usize;
        let cells = plane.size.map(count);
        let mut index = Self { plane, cells, starts: Vec::new(), ids: Vec::new(), points: Vec::new() };
        index.points = points.iter().map(|p| plane.wrapped(*p)).collect();
        let of: Vec<usize> = index.points.iter().map(|p| index.cell(*p)).collect();
        let mut starts = vec![0u32; cells[0] * cells[1] + 1];
        of.iter().for_each(|c| starts[c + 1] += 1);
        for c in 1..starts.len() {
            starts[c] += starts[c - 1];
        }
        let mut next = starts.clone();
        index.ids = vec![0; points.len()];
        for (id, c) in of.iter().enumerate() {
            index.ids[next[*c] as usize] = id as u32;
            next[*c] += 1;
        }
        index.starts = starts;
        index
    }

    fn along(&self, v: f64, k: usize) -> usize {
        let cell = v / self.plane.size[k] * self.cells[k] as f64;
        (cell.max(0.0) as usize).min(self.cells[k] - 1)
    }

    fn cell(&self, p: [f64; 2]) -> usize {
        self.along(p[1], 1) * self.cells[0] + self.along(p[0], 0)
    }

    /// Cells that a range touches, each once: the first, and how many.
    fn range(&self, k: usize, low: f64, high: f64) -> (usize, usize) {
        let (size, cells) = (self.plane.size[k], self.cells[k]);
        if !self.plane.wraps[k] {
            let first = self.along(low, k);
            return (first, self.along(high, k) - first + 1);
        }
        let per = cells as f64 / size;
        let (first, last) = (libm::floor(low * per), libm::floor(high * per));
        let count = ((last - first) as usize + 1).min(cells);
        ((first as i64).rem_euclid(cells as i64) as usize, count)
    }

    /// The points of the cells that a circle may touch, in their order cell by cell.
    fn around(&self, centre: [f64; 2], radius: f64) -> impl Iterator<Item = &[u32]> {
        let (column, columns) = self.range(0, centre[0] - radius, centre[0] + radius);
        let (row, rows) = self.range(1, centre[1] - radius, centre[1] + radius);
        let row = move |j: usize| (row + j) % self.cells[1] * self.cells[0];
        let cell = move |i: usize| (column + i) % self.cells[0];
        let cells = (0..rows).flat_map(move |j| (0..columns).map(move |i| row(j) + cell(i)));
        cells.map(|c| &self.ids[self.starts[c] as usize..self.starts[c + 1] as usize])
    }

    /// The way to a point that is closer than `radius`.
    fn way_within(&self, centre: [f64; 2], radius: f64, id: u32) -> Option<[f64; 2]> {
        let way = self.plane.between(centre, self.points[id as usize]);
        (way[0] * way[0] + way[1] * way[1] < radius * radius).then_some(way)
    }

    /// Calls `f` with the index of each point closer than `radius`, and the way to it.
    pub fn within(&self, centre: [f64; 2], radius: f64, mut f: impl FnMut(usize, [f64; 2])) {
        let centre = self.plane.wrapped(centre);
        for ids in self.around(centre, radius) {
            for &id in ids {
                if let Some(way) = self.way_within(centre, radius, id) {
                    f(id as usize, way);
                }
            }
        }
    }

    /// How many points [`Self::within`] looks at in searches around some places.
    pub fn looked_at(&self, centres: &[[f64; 2]], radius: f64) -> u64 {
        let of = |at: &[f64; 2]| self.around(self.plane.wrapped(*at), radius).map(|ids| ids.len() as u64);
        centres.iter().flat_map(of).sum()
    }

    /// Whether a point is closer than `radius`.
    pub fn any(&self, centre: [f64; 2], radius: f64) -> bool {
        let centre = self.plane.wrapped(centre);
        self.around(centre, radius).flatten().any(|&id| self.way_within(centre, radius, id).is_some())
    }

    /// The nearest point closer than `radius`, and its distance; of equally near ones the first.
    pub fn nearest(&self, centre: [f64; 2], radius: f64) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        self.within(centre, radius, |id, way| {
            let far = length(way);
            if best.is_none_or(|(i, least)| far < least || far == least && id < i) {
                best = Some((id, far));
            }
        });
        best
    }
}

/// The points near each point.
#[derive(Clone, Debug, Default)]
pub struct Vicinity {
    starts: Vec<u32>,
    /// The points near each, by distance, without the point itself.
    pub ids: Vec<u32>,
    /// The ways to them.
    pub ways: Vec<[f64; 2]>,
}

impl Vicinity {
    /// The points closer than `radius` to each of `centres`, at most `most` of them; `own` says whether centre i is
    /// point i.
    pub fn new(index: &PointIndex, centres: &[[f64; 2]], radius: f64, (most, own): (usize, bool)) -> Self {
        let all: Vec<usize> = (0..centres.len()).collect();
        let lists = crate::parallel::map(&all, |&c| {
            let mut near: Vec<(f64, u32, [f64; 2])> = Vec::new();
            index.within(centres[c], radius, |id, way| {
                if !(own && id == c) {
                    near.push((length(way), id as u32, way));
                }
            });
            let nearer =
                |a: &(f64, u32, [f64; 2]), b: &(f64, u32, [f64; 2])| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            if near.len() > most {
                near.select_nth_unstable_by(most, nearer);
                near.truncate(most);
                near.shrink_to_fit();
            }
            near.sort_unstable_by(nearer);
            near
        });
        let mut made = Self { starts: vec![0], ..Self::default() };
        for near in lists {
            made.ids.extend(near.iter().map(|n| n.1));
            made.ways.extend(near.iter().map(|n| n.2));
            made.starts.push(made.ids.len() as u32);
        }
        made
    }

    /// Where the points near point `i` are listed.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// Whether no point has a list.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many points have a list.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream;

    #[test]
    fn near_points_are_those_of_an_exhaustive_search() {
        let mut random = stream(1, "geometry/plane test", 0);
        for wraps in [[true; 2], [false, true], [false; 2]] {
            let plane = PeriodicPlane { size: [70.0, 40.0], wraps };
            let points: Vec<[f64; 2]> =
                (0..120).map(|_| [random.range(-5.0, 75.0), random.range(-5.0, 45.0)]).collect();
            for reach in [3.0, 11.0, 39.0] {
                let index = PointIndex::new(plane, reach, &points);
                for p in &points {
                    let mut found = Vec::new();
                    index.within(*p, reach, |id, _| found.push(id));
                    found.sort_unstable();
                    let near =
                        |q: &[f64; 2]| length(plane.between(plane.wrapped(*p), plane.wrapped(*q))) < reach;
                    let wanted: Vec<usize> = (0..points.len()).filter(|i| near(&points[*i])).collect();
                    assert_eq!(found, wanted, "{wraps:?} {reach}");
                }
            }
        }
    }
}
