//! Drawings whose motifs are placed as single elements, and taken apart afterwards.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use vtex_base::geometry::{Affine, Outline, Point, SecondMoments, Vec2, rigid_map, ring_path, rotation};
use vtex_base::raster::LabelMap;
use vtex_scene::element::{Shape, SimilarTo, bounds};
use vtex_scene::library::{
    Arrangement, ElementId, ExemplarElement, ExemplarInstance, ExemplarLayer, Library, Motif, Source,
};
use vtex_scene::scene::pixels;

/// Differences of residuals below which a motif counts as turned rather than mirrored, in pixels.
const SAME: f64 = 1e-6;
/// Least distance of a part's centre from the middle of a motif's, in sides of its bounds, from which the centres tell how
/// the motif is turned: those of a square in a circle lie apart by chance.
const APART: f64 = 0.15;
/// Least elongation of a part that has a direction.
const DIRECTED: f64 = 1.3;

/// A drawing in which each motif is one element, a *unit*; elements of no motif are units by themselves.
pub(crate) struct MotifUnits {
    /// The drawing, with units as its elements.
    pub(crate) library: Library,
    /// The parts of each unit, in painting order.
    pub(crate) parts: Vec<Vec<DrawnElement>>,
    /// The motif that each unit is.
    motifs: Vec<Option<UnitMotif>>,
}

/// An element of a drawing at a place: there, on a canvas, or as part of a unit.
#[derive(Clone, Copy)]
pub(crate) struct DrawnElement {
    /// Index of the element in the drawing.
    pub(crate) element: usize,
    /// From the shapes of the element to their place.
    pub(crate) map: Affine,
    pub(crate) order: PaintingOrder,
    /// Number of the motif on the canvas of which it is a part.
    pub(crate) motif: Option<u32>,
}

/// What is painted when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PaintingOrder {
    /// Index of the layer in the drawing.
    pub(crate) layer: usize,
    /// Index of the instance in the layer; that of the first where the parts of a unit are painted one after another.
    pub(crate) instance: usize,
    /// By how many instances its copy of the page is painted later, where copies overlap.
    pub(crate) later: i32,
}

impl PaintingOrder {
    /// The order of a copy that lies this number of periods to the right and below.
    pub(crate) fn of_copy(self, source: &Source, periods: [i32; 2]) -> Self {
        let [x, y] = [0, 1].map(|k| source.stacking[k].saturating_mul(periods[k]));
        Self { later: self.later.saturating_add(x).saturating_add(y), ..self }
    }

    /// The height in the layer.
    pub(crate) fn height(self) -> i32 {
        (self.instance as i32).saturating_add(self.later)
    }
}

impl Ord for PaintingOrder {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |order: &Self| (order.layer, order.height(), order.instance);
        key(self).cmp(&key(other))
    }
}

impl PartialOrd for PaintingOrder {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A unit that is a motif.
struct UnitMotif {
    kind: u32,
    /// Centres of the parts, in the order that the motifs of a kind share.
    centres: Vec<Point>,
    /// For each part in painting order, its place in that order.
    numbers: Vec<usize>,
    /// Whether the centres tell how the motif is turned.
    has_direction: bool,
    /// Directions of the longer axes of the parts, in that order too; `None` for one about as wide as long.
    axes: Vec<Option<f64>>,
    /// The part with an axis whose bounds are largest.
    longest: Option<usize>,
}

impl MotifUnits {
    /// The units of a drawing; `None` for a library without motifs. A motif of which an element is placed more
    /// than once, or nowhere, is none.
    pub(crate) fn new(library: &Library) -> Option<Self> {
        if library.motifs.is_empty() || !library.secondaries().is_empty() {
            return None;
        }
        let placed = placed(library);
        let mut is_part = vec![false; library.elements.len()];
        let is_whole = |m: &&Motif| m.parts.iter().all(|p| placed[p.element.index()].len() == 1);
        let mut units: Vec<(Option<&Motif>, Vec<DrawnElement>)> = Vec::new();
        for motif in library.motifs.iter().filter(is_whole) {
            let mut parts: Vec<DrawnElement> = Vec::with_capacity(motif.parts.len());
            for part in &motif.parts {
                let element = part.element.index();
                is_part[element] = true;
                let place = placed[element][0];
                let order = place.order.of_copy(&library.source, part.periods);
                parts.push(DrawnElement { map: period(library, part.periods) * place.map, order, ..place });
            }
            units.push((Some(motif), parts));
        }
        let alone = placed.iter().zip(&is_part).filter(|(_, is_part)| !**is_part);
        units.extend(alone.flat_map(|(places, _)| places.iter().map(|place| (None, vec![*place]))));
        Some(Self::of_units(library, &units))
    }

    fn of_units(library: &Library, units: &[(Option<&Motif>, Vec<DrawnElement>)]) -> Self {
        // Units are painted where their topmost parts are.
        let top = |parts: &[DrawnElement]| parts.iter().map(|p| p.order).max().unwrap_or_default();
        let mut order: Vec<usize> = (0..units.len()).collect();
        order.sort_by_key(|&u| top(&units[u].1));
        let mut own = Self { library: empty(library), parts: Vec::new(), motifs: Vec::new() };
        // The label of each element in the arrangement of units.
        let mut labels = vec![0; library.elements.len() + 1];
        for u in order {
            let (motif, parts) = &units[u];
            let mut sorted: Vec<usize> = (0..parts.len()).collect();
            sorted.sort_by_key(|&k| parts[k].order);
            let mut painted: Vec<DrawnElement> = sorted.iter().map(|&k| parts[k]).collect();
            let after = |order: PaintingOrder| PaintingOrder { instance: order.instance + 1, ..order };
            let is_run = |w: &[DrawnElement]| w[1].order == after(w[0].order);
            if painted.windows(2).all(is_run) {
                let first = painted[0].order;
                painted.iter_mut().for_each(|part| part.order = first);
            }
            let number = own.parts.len();
            for part in &painted {
                if labels[part.element + 1] == 0 {
                    labels[part.element + 1] = number as u32 + 1;
                }
            }
            let unit = element(library, &painted);
            let centre = |p: &DrawnElement| p.map * bounds(&library.elements[p.element].shapes).center();
            own.motifs.push(motif.map(|m| {
                let centres: Vec<Point> = parts.iter().map(centre).collect();
                let all = bounds(&unit.shapes);
                let apart = |p: &Point| p.distance(mean(&centres)) > APART * all.width().max(all.height());
                let axes: Vec<Option<f64>> = parts.iter().map(|p| axis(library, p)).collect();
                let length = |k: &usize| {
                    let b = bounds(&library.elements[parts[*k].element].shapes);
                    libm::hypot(b.width(), b.height())
                };
                let directed = (0..parts.len()).filter(|&k| axes[k].is_some());
                UnitMotif {
                    kind: m.kind,
                    has_direction: centres.iter().any(apart),
                    longest: directed.max_by(|a, b| length(a).total_cmp(&length(b))),
                    axes,
                    centres,
                    numbers: sorted,
                }
            }));
            own.library.elements.push(unit);
            let layer = top(parts).layer;
            own.library.layers[layer].instances.push(ExemplarInstance::of(ElementId::after(number)));
            own.parts.push(painted);
        }
        own.library.arrangement = relabelled(library, &labels);
        count_categories(&mut own.library);
        own
    }

    /// The drawing of units in whose arrangement motifs are without gaps: each also covers what lies between its
    /// parts, so that nothing else is placed there.
    pub(crate) fn closed(&self) -> Library {
        let mut map = self.library.arrangement.to_labels();
        let size = [map.width as i32, map.height as i32];
        let periodic = self.library.arrangement.periodic;
        for (u, _) in self.motifs.iter().enumerate().filter(|(_, motif)| motif.is_some()) {
            let shapes = &self.library.elements[u].shapes;
            let points = shapes.iter().flat_map(|s| s.outline.polygons(0.5)).flatten().collect();
            for (x, y) in convex_hull(points).as_ref().map(pixels::mask).unwrap_or_default().pixels() {
                let inside = (0..size[0]).contains(&x) && (0..size[1]).contains(&y);
                if periodic || inside {
                    let [x, y] = [x.rem_euclid(size[0]) as u32, y.rem_euclid(size[1]) as u32];
                    if map.get(x, y) == 0 {
                        map.set(x, y, u as u32 + 1);
                    }
                }
            }
        }
        let mut library = self.library.clone();
        library.arrangement = Arrangement { periodic, ..Arrangement::from_labels(&map) };
        count_categories(&mut library);
        library.coverage = library.categories.iter().fold(0.0, |sum, c| sum + c.coverage).min(1.0);
        library
    }

    /// For each unit that is a motif, the first of its kind and the rigid map from that one; for others, what
    /// `known` says.
    pub(crate) fn similar(&self, known: &[SimilarTo]) -> Vec<SimilarTo> {
        let mut first: BTreeMap<u32, usize> = BTreeMap::new();
        let similar = |(u, motif): (usize, &Option<UnitMotif>)| {
            let Some(motif) = motif else { return known[u] };
            let first = *first.entry(motif.kind).or_insert(u);
            let map = self.motifs[first].as_ref().map_or(Affine::IDENTITY, |m| m.map_to(motif));
            SimilarTo { first, map }
        };
        self.motifs.iter().enumerate().map(similar).collect()
    }

    /// The units of each kind of motif, ascending.
    pub(crate) fn kinds(&self) -> BTreeMap<u32, Vec<usize>> {
        let mut kinds: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (u, motif) in self.motifs.iter().enumerate() {
            if let Some(motif) = motif {
                kinds.entry(motif.kind).or_default().push(u);
            }
        }
        kinds
    }

    /// The kind of a unit that is a motif.
    pub(crate) fn kind(&self, unit: usize) -> Option<u32> {
        self.motifs[unit].as_ref().map(|motif| motif.kind)
    }

    /// For each part of a motif, in painting order, the vector from its place to that of its counterpart in
    /// another motif of the kind, laid upon this one.
    pub(crate) fn deviations(&self, unit: usize, other: usize) -> Vec<Vec2> {
        let (Some(own), Some(other)) = (&self.motifs[unit], &self.motifs[other]) else { return Vec::new() };
        let map = other.map_to(own);
        own.numbers.iter().map(|&k| map * other.centres[k] - own.centres[k]).collect()
    }
}

impl UnitMotif {
    /// The rigid map to another motif of the kind, mirrored only if that fits better. The centres of the parts give a first
    /// angle, and the longest part corrects it. Centres that lie close together give none.
    fn map_to(&self, other: &Self) -> Affine {
        if !(self.has_direction && other.has_direction) {
            return Affine::translate(mean(&other.centres) - mean(&self.centres));
        }
        let of = |mirrored: bool| {
            let map = rigid_map(&self.centres, &other.centres, mirrored);
            let apart = self.centres.iter().zip(&other.centres).map(|(p, q)| (map * *p).distance(*q));
            (apart.fold(0.0, f64::max), map)
        };
        let (plain, mirrored) = (of(false), of(true));
        let map = if mirrored.0 + SAME < plain.0 { mirrored.1 } else { plain.1 };
        let Some((own, wanted)) = self.longest.and_then(|k| self.axes[k].zip(other.axes[k])) else {
            return map;
        };
        let [a, b, c, d, ..] = map.as_coeffs();
        let (sin, cos) = (libm::sin(own), libm::cos(own));
        let turn = wanted - libm::atan2(b * cos + d * sin, a * cos + c * sin);
        let turn = turn - PI * libm::round(turn / PI);
        let middle = mean(&other.centres).to_vec2();
        Affine::translate(middle) * rotation(turn) * Affine::translate(-middle) * map
    }
}

/// The direction of the longer axis of a part; `None` for one about as wide as long.
fn axis(library: &Library, part: &DrawnElement) -> Option<f64> {
    let moments = SecondMoments::new(library.elements[part.element].outline()).moved(part.map);
    (moments.elongation() >= DIRECTED).then(|| moments.angle())
}

/// The mean of points.
fn mean(points: &[Point]) -> Point {
    let sum = points.iter().fold(Vec2::ZERO, |sum, p| sum + p.to_vec2());
    (sum / points.len().max(1) as f64).to_point()
}

/// The convex hull of points (Andrew's monotone chain); `None` for points on a line.
fn convex_hull(mut points: Vec<Point>) -> Option<Outline> {
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).cross(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut ring = half(&mut points.iter().copied());
    ring.extend(half(&mut points.iter().rev().copied()));
    Outline::new(&ring_path(&ring)).filter(|outline| outline.area() > 0.0)
}

/// A translation by whole periods of a drawing.
fn period(library: &Library, count: [i32; 2]) -> Affine {
    let size = [library.source.width, library.source.height];
    let by = [0, 1].map(|k| f64::from(count[k]) * f64::from(size[k]));
    Affine::translate((by[0], by[1]))
}

/// The places of each element of a drawing.
fn placed(library: &Library) -> Vec<Vec<DrawnElement>> {
    let mut placed: Vec<Vec<DrawnElement>> = vec![Vec::new(); library.elements.len()];
    for (l, layer) in library.layers.iter().enumerate() {
        for (n, instance) in layer.instances.iter().enumerate() {
            let element = instance.element.index();
            placed[element].push(DrawnElement {
                element,
                map: Affine::new(instance.transform),
                order: PaintingOrder { layer: l, instance: n, later: 0 },
                motif: None,
            });
        }
    }
    placed
}

/// A library without elements.
fn empty(library: &Library) -> Library {
    let layer = |layer: &ExemplarLayer| ExemplarLayer { instances: Vec::new(), ..layer.clone() };
    Library {
        elements: Vec::new(),
        layers: library.layers.iter().map(layer).collect(),
        motifs: Vec::new(),
        ..library.clone()
    }
}

/// The element of a unit. Its category and colour are those of its largest part.
fn element(library: &Library, parts: &[DrawnElement]) -> ExemplarElement {
    let of = |p: &DrawnElement| &library.elements[p.element];
    let largest = parts.iter().map(of).max_by_key(|e| e.area).unwrap_or(&library.elements[0]);
    let shapes: Vec<Shape> = parts
        .iter()
        .flat_map(|p| {
            of(p).shapes.iter().map(|s| if p.map == Affine::IDENTITY { s.clone() } else { s.moved(p.map) })
        })
        .collect();
    let [part] = parts else {
        let middle = bounds(&shapes).center();
        let page = [library.source.width, library.source.height].map(f64::from);
        let inside = |v: f64, k: usize| libm::round(v.clamp(0.0, page[k]) * 100.0) / 100.0;
        let rings = shapes.iter().flat_map(|s| s.outline.path().iter()).collect();
        let silhouette = Outline::new(&rings);
        return ExemplarElement {
            difference: None,
            area: parts.iter().map(|p| of(p).area).sum(),
            centroid: [inside(middle.x, 0), inside(middle.y, 1)],
            compactness: silhouette.as_ref().map(Outline::compactness),
            clipped: parts.iter().any(|p| of(p).clipped),
            silhouette,
            shapes,
            ..*largest
        };
    };
    ExemplarElement {
        shapes,
        silhouette: of(part).silhouette.as_ref().map(|s| s.moved(part.map)),
        ..*largest
    }
}

/// The arrangement with the labels of elements replaced.
fn relabelled(library: &Library, labels: &[u32]) -> Arrangement {
    let own = library.arrangement.to_labels();
    let new = own.labels.iter().map(|&label| labels[label as usize]).collect();
    let map = LabelMap { labels: new, ..own };
    Arrangement { periodic: library.arrangement.periodic, ..Arrangement::from_labels(&map) }
}

/// Counts members and coverage of the categories anew.
fn count_categories(library: &mut Library) {
    let areas = library.arrangement.to_labels().areas();
    let pixels = f64::from(library.arrangement.width) * f64::from(library.arrangement.height);
    for category in &mut library.categories {
        (category.members, category.coverage) = (0, 0.0);
    }
    for (k, element) in library.elements.iter().enumerate() {
        if let Some(category) = element.category {
            let category = &mut library.categories[category.index()];
            category.members += 1;
            category.coverage += areas.get(k + 1).map_or(0.0, |a| f64::from(*a)) / pixels;
        }
    }
}
