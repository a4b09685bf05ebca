//! Elements of one shape in several colours, which change places where nothing can move: tiles, cells, bricks.
//!
//! They do so if the drawing shows no order of their colours. In a chequerboard, a stripe or a plaid, elements that lie
//! apart by some way have the same colour much more often, or less often, than by chance.

use super::relations::ElementRelations;
use super::size_of;
use crate::arrange::motifs::DrawnElement;
use std::collections::BTreeMap;
use vtex_base::geometry::{Affine, NearPoints, Outline, Point, Vec2, shortest_offset};
use vtex_base::sampling::stream;
use vtex_scene::element::bounds;
use vtex_scene::library::{ExemplarElement, Library};

/// Largest difference of places and sizes of equal shapes, in pixels, and of their areas and perimeters, as a share.
const OFF: f64 = 0.75;
const OFF_SHARE: f64 = 0.01;
/// Fewest elements of a shape whose colours are judged.
const FEWEST: usize = 16;
/// Most elements of a shape that are compared with one another.
const MOST: usize = 400;
/// Deviation from chance, in standard deviations, from which colours have an order.
const ORDER: f64 = 4.0;
/// Least share of the elements that have one of their shape at a common way.
const COMMON: f64 = 0.5;
/// Nearest elements of the same shape, of which chance is expected as well.
const NEAREST: usize = 4;

/// An element of a class.
#[derive(Clone, Copy)]
struct AlikeElement {
    /// The first element of its class.
    first: usize,
    /// From the shapes of the first to its own.
    by: Vec2,
}

/// The classes of elements that change places.
pub(super) struct AlikeShapes {
    of: Vec<Option<AlikeElement>>,
}

impl AlikeShapes {
    /// The classes of a drawing: all elements of a regular one, in others those that have no room to move.
    pub(super) fn new(library: &Library, relations: &ElementRelations) -> Self {
        let elements = library.primaries();
        let mut classes: BTreeMap<(usize, [i64; 2]), Vec<usize>> = BTreeMap::new();
        let mut of: Vec<Option<AlikeElement>> = vec![None; elements.len()];
        let is_moved: Vec<bool> = moved(library);
        for (k, element) in elements.iter().enumerate() {
            let is_fixed = relations.regular || !relations.free[k];
            if element.clipped || is_moved[k] || !is_fixed {
                continue;
            }
            // Sizes that differ little may fall on both sides of a step.
            let box_of = bounds(&element.shapes);
            let step = |v: f64| libm::round(v / 4.0) as i64;
            let (w, h) = (step(box_of.width()), step(box_of.height()));
            let keys = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (element.shapes.len(), [w + i, h + j])));
            let known = keys.filter_map(|key| classes.get(&key)).flatten();
            let first = known.copied().find(|first| is_alike(&elements[*first], element)).unwrap_or(k);
            if first == k {
                classes.entry((element.shapes.len(), [w, h])).or_default().push(k);
            }
            let by = box_of.center() - bounds(&elements[first].shapes).center();
            of[k] = Some(AlikeElement { first, by });
        }
        let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (k, own) in of.iter().enumerate() {
            if let Some(own) = own {
                members.entry(own.first).or_default().push(k);
            }
        }
        for class in members.values().filter(|class| !has_no_order(library, class)) {
            class.iter().for_each(|k| of[*k] = None);
        }
        Self { of }
    }

    /// Whether no elements change places.
    pub(super) fn is_empty(&self) -> bool {
        self.of.iter().all(Option::is_none)
    }

    /// A share of the elements change places with others of their class and zone.
    pub(super) fn exchange(
        &self,
        placed: &mut [DrawnElement],
        zone: impl Fn(&DrawnElement) -> u8,
        (share, seed): (f64, u64),
    ) {
        let mut random = stream(seed, "synth/alike", 0);
        let mut groups: BTreeMap<(usize, u8), Vec<usize>> = BTreeMap::new();
        for (i, p) in placed.iter().enumerate() {
            if let Some(own) = self.of[p.element]
                && random.unit() < share
            {
                groups.entry((own.first, zone(p))).or_default().push(i);
            }
        }
        for places in groups.values() {
            let mut elements: Vec<usize> = places.iter().map(|i| placed[*i].element).collect();
            random.shuffle(&mut elements);
            let by = |element: usize| self.of[element].map_or(Vec2::ZERO, |own| own.by);
            for (&i, element) in places.iter().zip(elements) {
                let there = &mut placed[i];
                there.map *= Affine::translate(by(there.element) - by(element));
                there.element = element;
            }
        }
    }
}

/// Whether each element is placed otherwise than it is drawn, or more than once.
fn moved(library: &Library) -> Vec<bool> {
    let mut counts = vec![0u32; library.elements.len()];
    let mut is_moved = vec![false; library.elements.len()];
    for instance in library.layers.iter().flat_map(|layer| &layer.instances) {
        let k = instance.element.index();
        let [a, b, c, d, ..] = instance.transform;
        counts[k] += 1;
        is_moved[k] |= counts[k] > 1 || [a, b, c, d] != [1.0, 0.0, 0.0, 1.0];
    }
    is_moved
}

/// Whether two elements have the same shapes but for their place and colours. Their points do not count: equal hexagons may
/// begin at different corners.
fn is_alike(a: &ExemplarElement, b: &ExemplarElement) -> bool {
    let by = bounds(&b.shapes).center() - bounds(&a.shapes).center();
    let near = |v: f64, w: f64, share: f64| (v - w).abs() <= OFF + share * v.abs().max(w.abs());
    let is_same = |a: &Outline, b: &Outline| {
        let (p, q) = (a.bounds(), b.bounds());
        near(p.width(), q.width(), 0.0)
            && near(p.height(), q.height(), 0.0)
            && (p.center() + by - q.center()).hypot() <= OFF
            && (a.area() - b.area()).abs() <= OFF_SHARE * a.area() + OFF
            && near(a.perimeter(), b.perimeter(), OFF_SHARE)
    };
    let strokes = |e: &ExemplarElement| e.shapes.iter().map(|s| s.line.is_some()).collect::<Vec<_>>();
    let mut pairs = a.shapes.iter().zip(&b.shapes);
    a.shapes.len() == b.shapes.len()
        && strokes(a) == strokes(b)
        && pairs.all(|(a, b)| is_same(&a.outline, &b.outline))
}

/// Whether elements of one shape have several colours, and no order of them is seen.
fn has_no_order(library: &Library, class: &[usize]) -> bool {
    if class.len() < FEWEST {
        return false;
    }
    let class = &class[..class.len().min(MOST)];
    let elements = library.primaries();
    let mut known: BTreeMap<Vec<[u8; 3]>, usize> = BTreeMap::new();
    let colour: Vec<usize> = class
        .iter()
        .map(|k| {
            let next = known.len();
            *known.entry(elements[*k].shapes.iter().map(|s| s.colour.0).collect()).or_insert(next)
        })
        .collect();
    let n = class.len() as f64;
    let mut counts = vec![0.0; known.len()];
    colour.iter().for_each(|c| counts[*c] += 1.0);
    let by_chance = counts.iter().map(|c| c * (c - 1.0)).sum::<f64>() / (n * (n - 1.0));
    if known.len() < 2 || by_chance > 0.9 {
        return false;
    }
    let is_by_chance = |same: f64, pairs: f64| {
        let deviation = libm::sqrt(by_chance * (1.0 - by_chance) / pairs);
        (same / pairs - by_chance).abs() <= ORDER * deviation
    };
    let places: Vec<Point> = class.iter().map(|k| bounds(&elements[*k].shapes).center()).collect();
    let periods = size_of(library).map(Some);
    let tolerance = 0.02 * libm::sqrt(size_of(library).iter().product::<f64>());
    let near = NearPoints::new(&places, periods, tolerance);
    for j in 1..class.len() {
        let common = shortest_offset(places[0], places[j], periods);
        let has_same_colour = |i: usize| {
            let (wanted, mut found) = (places[i] + common, None);
            near.each(wanted, |k| {
                let is_there = shortest_offset(wanted, places[k], periods).hypot() <= tolerance;
                found = found.or((is_there && k != i).then_some(k));
            });
            found.map(|k| colour[k] == colour[i])
        };
        let pairs: Vec<bool> = (0..class.len()).filter_map(has_same_colour).collect();
        let same = pairs.iter().filter(|same| **same).count();
        if pairs.len() as f64 >= COMMON * n && !is_by_chance(same as f64, pairs.len() as f64) {
            return false;
        }
    }
    let nearest = |i: usize| {
        let far = |k: &usize| shortest_offset(places[i], places[*k], periods).hypot();
        let mut others: Vec<usize> = (0..class.len()).filter(|k| *k != i).collect();
        others.sort_by(|a, b| far(a).total_cmp(&far(b)));
        others.into_iter().take(NEAREST).filter(|k| colour[*k] == colour[i]).count()
    };
    let same: usize = (0..class.len()).map(nearest).sum();
    // Pairs of neighbours count from both sides.
    is_by_chance(same as f64 / 2.0, n * NEAREST as f64 / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arrange::motifs::PaintingOrder;
    use crate::synth::testing::drawing_of;
    use vtex_base::raster::LabelMap;
    use vtex_base::raster::colour::Colour;

    /// Eight rows of eight tiles side by side, in three colours.
    fn tiles(colour: impl Fn(usize, usize) -> usize) -> Library {
        let mut map = LabelMap::filled(160, 160, 0);
        for y in 0..160u32 {
            for x in 0..160u32 {
                map.labels[(y * 160 + x) as usize] = y / 20 * 8 + x / 20 + 1;
            }
        }
        let mut library = drawing_of(&map);
        let colours = [Colour([200, 40, 40]), Colour([40, 160, 90]), Colour([40, 60, 180])];
        for (k, element) in library.elements.iter_mut().enumerate() {
            element.shapes.iter_mut().for_each(|s| s.colour = colours[colour(k % 8, k / 8)]);
        }
        library
    }

    fn alike(library: &Library) -> AlikeShapes {
        AlikeShapes::new(library, &ElementRelations::new(library, &|| Ok(())).unwrap())
    }

    #[test]
    fn colours_without_order_change_places_and_others_stay() {
        let mut random = stream(4, "period/alike test", 0);
        let chance: Vec<usize> = (0..64).map(|_| random.index(3)).collect();
        assert!(!alike(&tiles(|x, y| chance[8 * y + x])).is_empty());
        // A chequerboard, stripes, a plaid, and one colour.
        assert!(alike(&tiles(|x, y| (x + y) % 2)).is_empty());
        assert!(alike(&tiles(|_, y| chance[y])).is_empty());
        assert!(alike(&tiles(|x, y| chance[8 * (y % 4) + x % 4])).is_empty());
        assert!(alike(&tiles(|_, _| 1)).is_empty());
    }

    #[test]
    fn tiles_that_change_places_lie_where_tiles_lay() {
        let library = tiles(|x, y| (x * x + 3 * y * y + x * y) % 7 % 3);
        let relations = ElementRelations::new(&library, &|| Ok(())).unwrap();
        let order = |k: usize| PaintingOrder { instance: k, ..PaintingOrder::default() };
        let copy =
            |k: usize| DrawnElement { element: k, map: Affine::IDENTITY, order: order(k), motif: None };
        let before: Vec<DrawnElement> = (0..64).map(copy).collect();
        let mut of: Vec<Option<AlikeElement>> = Vec::new();
        for element in &library.elements {
            let by = bounds(&element.shapes).center() - bounds(&library.elements[0].shapes).center();
            of.push(Some(AlikeElement { first: 0, by }));
        }
        let mut after = before.clone();
        AlikeShapes { of }.exchange(&mut after, |_| 0, (1.0, 3));
        let centre = |p: &DrawnElement| p.map * relations.bounds[p.element].center();
        assert!(before.iter().zip(&after).filter(|(a, b)| a.element != b.element).count() > 50);
        for (a, b) in before.iter().zip(&after) {
            assert!((centre(a) - centre(b)).hypot() < 1e-6 && a.order == b.order);
        }
        let mut elements: Vec<usize> = after.iter().map(|p| p.element).collect();
        elements.sort_unstable();
        assert!(elements.into_iter().eq(0..64));
    }
}
