//! Cycle consistency: whether a scene that is drawn and analysed again has the elements that it was made of
//! (Tu, dissertation, equation 4.32 and section 7.2).
//!
//! When this works badly: scenes whose elements lie on others of the same colour, because invisible borders
//! cannot be found.

use crate::element::{Appearance, Gaussian};
use crate::scene::{Role, Scene};
use serde::Serialize;
use vtex_base::geometry::{NearPoints, Point, Table, assign, shortest_offset};

/// Integer costs of the assignment per unit of cost.
const UNIT: f64 = 1e6;
/// Largest cost of a pair. Elements one root of their area apart, twice as large or of opposite shades cost
/// about 1.
const MOST: f64 = 2.0;
/// Least visible share of an element that counts.
const SEEN: f64 = 0.6;
/// Side of the cells by which visible areas are counted, in pixels.
const CELL: f64 = 2.0;

/// Measures of how well the individual elements of a scene are found again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cycle {
    /// Elements of the scene that count: whole on the canvas, and mostly visible.
    pub elements: usize,
    /// Share of these that has a partner, 0 to 1.
    pub matched: f64,
    /// Mean distance of partners, as a share of the root of the element's area.
    pub distance: f64,
    /// Mean of the absolute logarithm (base 2) of the ratio of their areas.
    pub size: f64,
    /// Mean distance of their median colours, in Oklab times 100.
    pub colour: f64,
    /// Mean cost over all elements that count; an element without a partner has the largest cost. 0 for
    /// perfect consistency, 2 for none.
    pub cost: f64,
}

/// The properties of an element that are compared.
struct ComparedElement {
    gaussian: Gaussian,
    colour: [f32; 3],
}

impl Cycle {
    /// Compares the individual elements of a scene with those of `again`, the scene of the same size that
    /// analysis of its picture gives.
    pub fn between(scene: &Scene, again: &Scene) -> Self {
        let (items, found) = (visible(scene), items(again));
        let points: Vec<Point> = found.iter().map(|item| item.gaussian.mean).collect();
        let radius = |item: &ComparedElement| libm::sqrt(4.0 * std::f64::consts::PI * item.gaussian.size());
        let reach = items.iter().map(radius).fold(1.0, f64::max) * libm::sqrt(MOST);
        let near = NearPoints::new(&points, scene.periods(), reach);
        let rows = items.iter().map(|item| {
            let mut row = Vec::new();
            near.each(item.gaussian.mean, |k| {
                let cost = parts(scene, item, &found[k]).cost();
                if cost < MOST {
                    row.push((k as u32, (cost * UNIT) as i64));
                }
            });
            row
        });
        // An element without a partner costs as much as the costliest pair.
        let partners = assign(&Table::new(rows.collect()), found.len(), (MOST * UNIT) as i64);
        let mut sums = Self { elements: items.len(), ..Self::default() };
        let mut pairs = 0.0;
        for (item, partner) in items.iter().zip(partners) {
            let Some(partner) = partner else {
                sums.cost += MOST;
                continue;
            };
            let parts = parts(scene, item, &found[partner as usize]);
            pairs += 1.0;
            sums.cost += parts.cost();
            sums.distance += parts.distance;
            sums.size += parts.size;
            sums.colour += 100.0 * parts.colour;
        }
        let all = (items.len() as f64).max(1.0);
        let of_pairs = f64::max(pairs, 1.0);
        Self {
            elements: items.len(),
            matched: pairs / all,
            distance: sums.distance / of_pairs,
            size: sums.size / of_pairs,
            colour: sums.colour / of_pairs,
            cost: sums.cost / all,
        }
    }
}

/// The differences of two elements.
struct ElementDifference {
    /// In roots of the area.
    distance: f64,
    /// Logarithm of the ratio of areas.
    size: f64,
    /// In Oklab.
    colour: f64,
}

impl ElementDifference {
    fn cost(&self) -> f64 {
        self.distance * self.distance + self.size * self.size + 4.0 * self.colour * self.colour
    }
}

fn parts(scene: &Scene, a: &ComparedElement, b: &ComparedElement) -> ElementDifference {
    let way = shortest_offset(a.gaussian.mean, b.gaussian.mean, scene.periods());
    let area = 4.0 * std::f64::consts::PI * a.gaussian.size();
    let square: f64 = (0..3).map(|k| f64::from(a.colour[k] - b.colour[k])).map(|d| d * d).sum();
    ElementDifference {
        distance: libm::sqrt(way.hypot2() / area),
        size: libm::log2(b.gaussian.size() / a.gaussian.size()).abs(),
        colour: libm::sqrt(square),
    }
}

/// The individual elements of a scene.
fn items(scene: &Scene) -> Vec<ComparedElement> {
    all(scene).into_iter().flatten().collect()
}

/// Each individual element, `None` if it is degenerate, in painting order.
fn all(scene: &Scene) -> Vec<Option<ComparedElement>> {
    let of = scene.gaussians().into_iter().zip(scene.appearances()).zip(scene.roles());
    let item = |((gaussian, Appearance { median, .. }), _): ((Option<Gaussian>, Appearance), Role)| {
        gaussian.map(|gaussian| ComparedElement { gaussian, colour: median })
    };
    of.filter(|(_, role)| role.is_individual()).map(item).collect()
}

/// The individual elements that lie whole on the canvas and are mostly visible: elements painted later hide
/// only a small share of their ellipse of two standard deviations.
fn visible(scene: &Scene) -> Vec<ComparedElement> {
    let items = all(scene);
    let canvas = [f64::from(scene.width), f64::from(scene.height)];
    let [columns, rows] = canvas.map(|v| libm::ceil(v / CELL) as usize);
    let mut owner = vec![0u32; columns * rows];
    let mut areas = vec![0u32; items.len()];
    for (k, item) in items.iter().enumerate() {
        let Some(item) = item else { continue };
        for cell in cells(&item.gaussian, [columns, rows]) {
            owner[cell] = k as u32 + 1;
            areas[k] += 1;
        }
    }
    let mut seen = vec![0u32; items.len() + 1];
    owner.iter().for_each(|k| seen[*k as usize] += 1);
    let counts = |k: usize| f64::from(seen[k + 1]) >= SEEN * f64::from(areas[k].max(1));
    let whole = |item: &ComparedElement| {
        let reach = 2.0 * item.gaussian.deviations()[0];
        let p = item.gaussian.mean;
        (reach..canvas[0] - reach).contains(&p.x) && (reach..canvas[1] - reach).contains(&p.y)
    };
    items.into_iter().enumerate().filter(|(k, _)| counts(*k)).filter_map(|(_, i)| i.filter(whole)).collect()
}

/// The cells whose middle lies within two standard deviations of a Gaussian: for an ellipse, its area.
fn cells(gaussian: &Gaussian, [columns, rows]: [usize; 2]) -> Vec<usize> {
    let least = libm::exp(-4.0);
    let [xx, _, yy] = gaussian.covariance;
    let range = |middle: f64, variance: f64, count: usize| {
        let reach = 2.0 * libm::sqrt(variance);
        let cell = |v: f64| libm::floor(v / CELL).clamp(0.0, count as f64) as usize;
        cell(middle - reach)..(cell(middle + reach) + 1).min(count)
    };
    let mut inside = Vec::new();
    for y in range(gaussian.mean.y, yy, rows) {
        for x in range(gaussian.mean.x, xx, columns) {
            let middle = Point::new((x as f64 + 0.5) * CELL, (y as f64 + 0.5) * CELL);
            if gaussian.at(middle) >= least {
                inside.push(y * columns + x);
            }
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ElementId, Instance, InstanceId, testing};
    use vtex_base::geometry::{Affine, Outline, parse_path};
    use vtex_base::raster::colour::Colour;
    use vtex_base::sampling::stream;

    /// Bars of several shades on a lattice, moved by up to `off` pixels.
    fn scene(off: f64, keep: impl Fn(u32) -> bool) -> Scene {
        let bar = |shade: u8| {
            let outline = Outline::new(&parse_path("M-9-4h18v8h-18z").unwrap()).unwrap();
            testing::element(0, Some(0), outline, Colour([shade; 3]))
        };
        let mut random = stream(1, "test/cycle", 0);
        let primary = (0..64).map(|k| {
            let at = [k % 8, k / 8].map(|v| 30.0 + 28.0 * f64::from(v) + random.range(-off, off));
            let transform =
                (Affine::translate((at[0], at[1])) * vtex_base::geometry::rotation(f64::from(k))).as_coeffs();
            Instance { transform, ..Instance::new(InstanceId(k), ElementId(k % 3)) }
        });
        let primary = primary.filter(|i| keep(i.id.0)).collect();
        let elements = vec![bar(60), bar(120), bar(200)];
        testing::scene([256, 256], elements, Vec::new(), primary, testing::flat(Colour([9; 3])))
    }

    #[test]
    fn a_scene_is_consistent_with_itself() {
        let cycle = Cycle::between(&scene(0.0, |_| true), &scene(0.0, |_| true));
        assert_eq!((cycle.elements, cycle.matched, cycle.cost), (64, 1.0, 0.0));
    }

    #[test]
    fn what_is_moved_or_missing_costs() {
        let moved = Cycle::between(&scene(0.0, |_| true), &scene(4.0, |_| true));
        assert!(moved.matched == 1.0 && moved.distance > 0.1 && moved.cost > 0.01, "{moved:?}");
        let missing = Cycle::between(&scene(0.0, |_| true), &scene(0.0, |k| k % 4 != 0));
        assert!((missing.matched - 0.75).abs() < 0.02 && (missing.cost - 0.5).abs() < 0.05, "{missing:?}");
        let more = Cycle::between(&scene(0.0, |k| k % 4 != 0), &scene(0.0, |_| true));
        assert_eq!((more.elements, more.matched), (48, 1.0));
    }

    #[test]
    fn what_is_hidden_does_not_count() {
        let mut pile = scene(0.0, |_| true);
        let top = pile.primary().to_vec();
        let again = top.iter().map(|i| Instance { id: InstanceId(i.id.0 + 100), ..i.clone() });
        let again: Vec<Instance> = again.collect();
        pile.primary_mut().extend(again);
        assert_eq!(Cycle::between(&pile, &scene(0.0, |_| true)).elements, 64);
        assert_eq!(Cycle::between(&scene(0.0, |_| false), &pile), Cycle::default());
    }
}
