//! Exchange of appearances among elements of similar size (Tu, dissertation, section 4.4.1).

use super::Draw;
use super::groups::groups;
use super::place::draw_as;
use super::selection::Chosen;
use vtex_base::geometry::{Affine, Outline, Point, inside, nearest};
use vtex_base::parallel;
use vtex_scene::element::Gaussian;
use vtex_scene::scene::{Element, ElementId, Instance, Scene, Shape, Within};

/// Largest ratio of the areas of Gaussians that exchange appearances.
const LARGEST_RATIO: f64 = 2.0;
/// Largest number of exchanges tried for an element that would get an equal appearance.
const TRIES: usize = 32;
/// Largest distance of the polygons of details and outlines from their curves, in pixels.
const TOLERANCE: f64 = 0.15;
/// Largest distance of points along outlines that are moved onto a ring, in pixels.
const STEP: f64 = 1.0;

/// Exchanges appearances. Outlines stay, unless `outlines` is set or an element has a silhouette of its own.
/// Returns the number of elements that are too thin and stay unchanged.
pub(super) fn shuffle(
    scene: &mut Scene,
    chosen: &Chosen,
    within: Within,
    share: f64,
    outlines: bool,
    draw: &Draw,
) -> usize {
    let gaussians = scene.gaussians();
    let all: Vec<Instance> = scene.instances().cloned().collect();
    let mut from: Vec<usize> = (0..all.len()).collect();
    let mut thin = 0;
    for group in groups(scene, chosen, within) {
        let drawn = |i: &usize| share >= 1.0 || draw.of("edit/shuffle/share", all[*i].id).chance(share);
        let sizes = group.iter().filter(|i| drawn(i)).map(|&i| (gaussians[i].map(|g| g.size()), i));
        let mut ranked: Vec<(f64, usize)> = sizes.filter_map(|(size, i)| Some((size?, i))).collect();
        thin += group.iter().filter(|i| gaussians[**i].is_none()).count();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut rest = &ranked[..];
        while let Some(&(least, _)) = rest.first() {
            let count = rest.partition_point(|(size, _)| *size <= LARGEST_RATIO * least);
            let (similar, larger) = rest.split_at(count);
            exchange(&all, similar, &mut from, draw);
            rest = larger;
        }
    }
    let jobs: Vec<usize> = (0..all.len()).filter(|&i| from[i] != i).collect();
    let exchange = Exchange { scene, all: &all, gaussians: &gaussians, outlines };
    let results = parallel::map(&jobs, |&i| exchange.changed(i, from[i]));
    let mut changes: Vec<Option<ChangedInstance>> = vec![None; all.len()];
    jobs.into_iter().zip(results).for_each(|(i, change)| changes[i] = change);
    let mut elements = std::mem::take(&mut scene.elements);
    for (instance, change) in scene.instances_mut().zip(changes) {
        let Some(change) = change else { continue };
        *instance = change.instance;
        if let Some(element) = change.element {
            elements.push(element);
            instance.element = ElementId::after(elements.len() - 1);
        }
    }
    scene.elements = elements;
    thin
}

/// Chooses the instance from which each of some instances of similar size gets its appearance: a random
/// cycle, so that none keeps its own, with exchanges where an instance would get an equal appearance.
fn exchange(all: &[Instance], similar: &[(f64, usize)], from: &mut [usize], draw: &Draw) {
    let keyed = similar.iter().map(|&(_, i)| (draw.of("edit/shuffle", all[i].id).bits(), i));
    let mut cycle: Vec<(u64, usize)> = keyed.collect();
    cycle.sort_unstable();
    let cycle: Vec<usize> = cycle.into_iter().map(|(_, i)| i).collect();
    let n = cycle.len();
    let mut source: Vec<usize> = (0..n).map(|k| cycle[(k + 1) % n]).collect();
    let appearance = |i: usize| (all[i].element, all[i].colour);
    for k in 0..n {
        if appearance(source[k]) != appearance(cycle[k]) {
            continue;
        }
        let fits = |other: &usize| {
            appearance(source[*other]) != appearance(cycle[k])
                && appearance(source[k]) != appearance(cycle[*other])
        };
        if let Some(other) = (1..n.min(TRIES)).map(|d| (k + d) % n).find(fits) {
            source.swap(k, other);
        }
    }
    cycle.iter().zip(source).for_each(|(&i, source)| from[i] = source);
}

/// A changed instance.
#[derive(Clone)]
struct ChangedInstance {
    instance: Instance,
    /// Its element, if that is new.
    element: Option<Element>,
}

/// The scene before an exchange.
struct Exchange<'a> {
    scene: &'a Scene,
    all: &'a [Instance],
    gaussians: &'a [Option<Gaussian>],
    outlines: bool,
}

impl Exchange<'_> {
    /// The instance `to` with the appearance of the instance `from`.
    fn changed(&self, to: usize, from: usize) -> Option<ChangedInstance> {
        let (own, other) = (&self.all[to], &self.all[from]);
        let (target, source) = (self.gaussians[to]?, self.gaussians[from]?);
        let [own_element, other_element] = [own, other].map(|i| self.scene.element(i));
        if self.outlines || own_element.silhouette.is_some() || other_element.silhouette.is_some() {
            let mut instance = Instance { element: other.element, colour: other.colour, ..own.clone() };
            draw_as(&mut instance, other, &source, &target, self.scene.periods());
            return Some(ChangedInstance { instance, element: None });
        }
        let (colour, gradient) = other_element.paint(other.colour);
        let is_bare = |e: &Element| e.details().is_empty() && e.base().rim.is_none();
        let plain = gradient.is_none() && is_bare(other_element) && is_bare(own_element);
        if plain {
            let instance = Instance { colour: Some(colour), ..own.clone() };
            return Some(ChangedInstance { instance, element: None });
        }
        let map = own.affine().inverse() * source.onto(&target) * other.affine();
        let gradient = gradient.and_then(|g| g.drawn(map));
        let own_base = own_element.base();
        let is_filled = own_base.line.is_none() && !own_base.is_soft();
        let rim = other_element.base().rim.as_ref().filter(|_| is_filled).map(|rim| Box::new(rim.moved(map)));
        let base = Shape { colour, gradient, rim, ..own_base.clone() };
        let rings = own_element.base().outline.polygons(TOLERANCE);
        let outer = rings.iter().max_by(|a, b| extent(a).total_cmp(&extent(b)));
        let details = other_element.details().iter().filter_map(|detail| moved_into(detail, map, outer?));
        let shapes = std::iter::once(base).chain(details).collect();
        let instance = Instance { colour: None, ..own.clone() };
        Some(ChangedInstance { instance, element: Some(own_element.with_shapes(shapes)) })
    }
}

/// Area of the bounds of a ring.
fn extent(ring: &[Point]) -> f64 {
    let along = |at: &dyn Fn(&Point) -> f64| {
        let values = ring.iter().map(at);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    along(&|p| p.x) * along(&|p| p.y)
}

/// A detail mapped into a ring. Points outside the ring are moved onto it, except those of soft ellipses,
/// which are clipped. `None` if nothing of the detail is left.
fn moved_into(detail: &Shape, map: Affine, hull: &[Point]) -> Option<Shape> {
    let path = map * detail.outline.path();
    let moved = Outline::new(&path)?;
    let rings = moved.polygons(TOLERANCE);
    let outline = if detail.is_soft() || rings.iter().flatten().all(|p| inside(hull, *p)) {
        moved
    } else {
        let kept = |p: Point| if inside(hull, p) { p } else { nearest(hull, p) };
        let rings: Vec<Vec<Point>> =
            rings.iter().map(|ring| dense(ring).into_iter().map(kept).collect()).collect();
        Outline::along(&rings, TOLERANCE)?
    };
    if outline.is_empty() || outline.area() < TOLERANCE {
        return None;
    }
    let gradient = detail.gradient.as_ref().and_then(|g| g.drawn(map));
    Some(Shape { gradient, ..detail.with_outline(outline) })
}

/// A ring with further points between those that are far apart.
fn dense(ring: &[Point]) -> Vec<Point> {
    let sides = (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]));
    let points = sides.flat_map(|(a, b)| {
        let count = libm::ceil(a.distance(b) / STEP).clamp(1.0, 1e4) as u32;
        (0..count).map(move |k| a.lerp(b, f64::from(k) / f64::from(count)))
    });
    points.collect()
}
