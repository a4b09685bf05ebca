//! Elements as the optimiser knows them, and their samples.

use vtex_base::geometry::plane::{PeriodicPlane, length};
use vtex_base::geometry::{Affine, ConvexPolygon, Interior, Outline, Rect, edges};
use vtex_base::sampling::stream;

/// The shape of an element. Elements that are equal up to their place share one.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The areas that it paints, around its reference point.
    pub outlines: Vec<Outline>,
    /// Its category: figures of one category look alike.
    pub category: u32,
    /// Mean colour, in Oklab.
    pub colour: [f64; 3],
}

impl Figure {
    /// The figure with all lengths multiplied.
    pub(crate) fn scaled(&self, by: f64) -> Self {
        let map = Affine::scale(by);
        Self { outlines: self.outlines.iter().map(|o| o.moved(map)).collect(), ..*self }
    }

    /// Its part in a rectangle, which has the figure's reference point as its origin. The part has a reference point of
    /// its own, the middle of its bounds; the way there is returned, too. `None`: no part of the figure is there.
    pub(crate) fn within(&self, rectangle: Rect) -> Option<(Self, [f64; 2])> {
        let polygon = ConvexPolygon::rect(rectangle);
        let part =
            Self { outlines: self.outlines.iter().filter_map(|o| polygon.part_of(o)).collect(), ..*self };
        if part.outlines.is_empty() {
            return None;
        }
        let middle = part.bounds().center();
        let map = Affine::translate(-middle.to_vec2());
        let outlines = part.outlines.iter().map(|o| o.moved(map)).collect();
        Some((Self { outlines, ..part }, [middle.x, middle.y]))
    }

    /// Bounds of all that it paints, around its reference point.
    pub fn bounds(&self) -> Rect {
        self.outlines.iter().map(Outline::bounds).reduce(|a, b| a.union(b)).unwrap_or_default()
    }
}

/// A figure at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FigurePlace {
    /// Index of the figure.
    pub figure: u32,
    /// Place of its reference point.
    pub at: [f64; 2],
    /// Whether the result may have it. False for one that the border of the exemplar cuts.
    pub placeable: bool,
}

/// An exemplar.
#[derive(Clone, Debug)]
pub struct ClusterExemplar {
    /// The page. Axes that wrap repeat without a seam.
    pub page: PeriodicPlane,
    /// The figures.
    pub figures: Vec<Figure>,
    /// The elements in painting order.
    pub places: Vec<FigurePlace>,
}

impl ClusterExemplar {
    /// The exemplar with all lengths multiplied.
    pub(crate) fn scaled(&self, by: f64) -> Self {
        let figures = self.figures.iter().map(|figure| figure.scaled(by));
        let places = self.places.iter().map(|p| FigurePlace { at: p.at.map(|v| v * by), ..*p });
        Self {
            page: PeriodicPlane { size: self.page.size.map(|v| v * by), ..self.page },
            figures: figures.collect(),
            places: places.collect(),
        }
    }

    /// The exemplar repeated along the axes that wrap, so that each is at least `side` long.
    pub(crate) fn repeated(&self, side: f64) -> Self {
        let page = self.page;
        let times =
            [0, 1].map(|k| if page.wraps[k] { libm::ceil(side / page.size[k]).max(1.0) } else { 1.0 });
        let mut places = Vec::with_capacity(self.places.len() * (times[0] * times[1]) as usize);
        for p in &self.places {
            // Copies of an element follow each other in the painting order, as they do on a torus.
            for j in 0..times[1] as u32 {
                for i in 0..times[0] as u32 {
                    let at = [p.at[0] + f64::from(i) * page.size[0], p.at[1] + f64::from(j) * page.size[1]];
                    places.push(FigurePlace { at, ..*p });
                }
            }
        }
        let size = [page.size[0] * times[0], page.size[1] * times[1]];
        Self { page: PeriodicPlane { size, ..page }, figures: self.figures.clone(), places }
    }
}

/// Most candidates for samples of a figure.
const MOST_CANDIDATES: f64 = 200_000.0;

/// Samples of a figure around its reference point: a Poisson-disk set of its interior. No two are closer than
/// `distance`, and no point of the interior is much farther than that from the nearest. At least one.
pub(crate) fn samples(figure: &Figure, distance: f64, seed: u64, item: u64) -> Vec<[f64; 2]> {
    let bounds = figure.bounds();
    let step = (distance / 6.0).max(libm::sqrt(bounds.area() / MOST_CANDIDATES));
    let mut random = stream(seed, "cluster/samples", item);
    let mut candidates: Vec<[f64; 2]> = Vec::new();
    for outline in &figure.outlines {
        let (interior, b) = (Interior::new(outline), outline.bounds());
        for j in 0..=(b.height() / step) as u32 {
            let y = b.y0 + (f64::from(j) + 0.5) * step;
            for [x0, x1] in interior.intervals(y) {
                let count = ((x1 - x0) / step) as u32;
                let begin = x0 + 0.5 * (x1 - x0 - f64::from(count) * step);
                candidates.extend((0..=count).map(|i| [begin + f64::from(i) * step, y]));
            }
        }
        // Of shapes thinner than the step, points of the border.
        let length = outline.perimeter();
        let border = (0.25 * distance).max(length / MOST_CANDIDATES);
        for [a, b] in edges(outline.path().iter(), 0.1 * distance) {
            let count = libm::ceil(a.distance(b) / border).max(1.0) as u32;
            candidates.extend((0..count).map(|k| {
                let p = a.lerp(b, f64::from(k) / f64::from(count));
                [p.x, p.y]
            }));
        }
    }
    random.shuffle(&mut candidates);
    let found = thinned(&candidates, distance);
    if found.is_empty() {
        let middle = bounds.center();
        return vec![[middle.x, middle.y]];
    }
    found
}

/// The candidates in their order, without those closer than `distance` to an earlier one.
fn thinned(candidates: &[[f64; 2]], distance: f64) -> Vec<[f64; 2]> {
    let low = [0, 1].map(|k| candidates.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min));
    let high = [0, 1].map(|k| candidates.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max));
    // At most one sample to a cell.
    let side =
        (distance / std::f64::consts::SQRT_2).max(libm::sqrt((high[0] - low[0]) * (high[1] - low[1]) / 4e6));
    let cell = |p: &[f64; 2], k: usize| ((p[k] - low[k]) / side).max(0.0) as usize;
    if candidates.is_empty() {
        return Vec::new();
    }
    let cells = [cell(&high, 0) + 1, cell(&high, 1) + 1];
    let mut taken: Vec<Vec<u32>> = vec![Vec::new(); cells[0] * cells[1]];
    let reach = libm::ceil(distance / side) as usize;
    let mut found: Vec<[f64; 2]> = Vec::new();
    for p in candidates {
        let [x, y] = [cell(p, 0), cell(p, 1)];
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(cells[1]);
        let mut near = rows.flat_map(|j| {
            (x.saturating_sub(reach)..(x + reach + 1).min(cells[0])).map(move |i| j * cells[0] + i)
        });
        let close = |i: &u32| length([found[*i as usize][0] - p[0], found[*i as usize][1] - p[1]]) < distance;
        if near.any(|c| taken[c].iter().any(close)) {
            continue;
        }
        taken[y * cells[0] + x].push(found.len() as u32);
        found.push(*p);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::parse_path;

    fn figure(text: &str) -> Figure {
        let outlines = vec![Outline::new(&parse_path(text).unwrap()).unwrap()];
        Figure { outlines, category: 0, colour: [0.5, 0.0, 0.0] }
    }

    #[test]
    fn samples_keep_their_distance_and_cover_the_interior() {
        for text in ["M0 0H60V40H0Z", "M0 0H90V1H0Z", "M-20 0C-20 30 20 30 20 0C20 -30 -20 -30 -20 0Z"] {
            let figure = figure(text);
            for distance in [5.0, 10.0, 20.0] {
                let found = samples(&figure, distance, 3, 0);
                let apart = |a: &[f64; 2], b: &[f64; 2]| length([a[0] - b[0], a[1] - b[1]]);
                for (i, a) in found.iter().enumerate() {
                    assert!(found[..i].iter().all(|b| apart(a, b) >= distance), "{text}");
                }
                let interior = Interior::new(&figure.outlines[0]);
                let b = figure.bounds();
                for k in 0..2000u32 {
                    let p = [
                        b.x0 + b.width() * f64::from(k % 50) / 50.0,
                        b.y0 + b.height() * f64::from(k / 50) / 40.0,
                    ];
                    let inside = interior.contains((p[0], p[1]).into());
                    assert!(!inside || found.iter().any(|q| apart(q, &p) < 1.2 * distance), "{text} {p:?}");
                }
            }
        }
    }

    #[test]
    fn every_figure_has_a_sample() {
        assert_eq!(samples(&figure("M3 3H3.01V3.01H3Z"), 20.0, 1, 0).len(), 1);
        assert_eq!(samples(&Figure { outlines: Vec::new(), ..figure("") }, 20.0, 1, 0), [[0.0, 0.0]]);
    }
}
