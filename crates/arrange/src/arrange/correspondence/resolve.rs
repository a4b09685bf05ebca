//! The elements placed for each instance: a whole element, a similar one, a fused one, or none.
//!
//! The main element of an instance is placed whole if it fits. If another element of similar colour and size
//! fits better, that one is placed. Otherwise the instance becomes a fused element. The more packed the
//! exemplar, the closer an element has to fit, because a gap is seen there at once. Where elements stand
//! apart, a fused one has to look like an element of the exemplar ([`likeness`](super::likeness)). If it does
//! not, it is replaced by those of its elements that were copied in large part, or by the most similar
//! element, or by none. Elements cut by the exemplar's border are placed only where the canvas cuts them too.

use super::Correspondence;
use super::cover::Cover;
use super::fused::fused;
use super::instances::PixelInstance;
use super::likeness::{ElementLook, GuideColours, Likeness};
use super::similar::Substitutes;
use crate::arrange::grid::Grid;
use crate::arrange::model::{PlaceableId, PlacementModel, VariantId};
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::Element;

/// Least overlap over union of an instance and its main element, for elements that are apart and for packed
/// elements, where gaps are conspicuous.
const WHOLE: [f64; 2] = [0.62, 0.74];
/// Least share of an instance that its main element covers, likewise.
const COVERED: [f64; 2] = [0.72, 0.86];
/// Least overlap over union of an instance and an element like its main one.
const LIKE: f64 = 0.8;
/// Areas of elements like another, as shares of the instance's.
const AREAS: [f64; 2] = [0.72, 1.4];
/// Elements compared with each instance.
const CANDIDATES: usize = 60;
/// An exemplar is packed if this share of the borders of primaries lies on others,
const CONTACT: f64 = 0.15;
/// or if primaries cover the second share of it (at the first it is not packed at all),
const PRIMARIES: [f64; 2] = [0.45, 0.6];
/// or if secondaries cover such a share of its background, so that bare background is seen at once.
const TILED: [f64; 2] = [0.4, 0.6];

/// From this packing on an exemplar counts as packed: its fused elements need not look like its elements.
const PACKED: f64 = 0.65;
/// Fewest pixels of an instance that has to look like an element.
const LOOKED_AT: u32 = 60;
/// If several elements replace one instance: least share of each that lies on the instance,
const WITHIN: f64 = 0.5;
/// least share of each that was copied,
const CAME: f64 = 0.4;
/// and largest share of each that may lie on elements placed before.
const ON_OTHERS: f64 = 0.35;
/// Least overlap over union of an instance and an element that looks like it.
const LOOKS_LIKE: f64 = 0.4;

/// The elements that are placed for an instance.
pub(super) enum Resolution {
    /// Elements that it is copied from.
    Whole(Vec<(VariantId, [i32; 2])>),
    /// Another element of similar colour and size.
    Like(VariantId, [i32; 2]),
    /// A new one, relative to the origin of the instance's main part, with its pixels.
    Fused(Box<Element>, Mask),
    /// None.
    Nothing,
}

/// Decides which elements are placed for instances.
pub(super) struct Resolver<'a> {
    libraries: &'a [Library],
    model: &'a PlacementModel,
    grid: &'a Grid,
    alike: &'a Substitutes,
    /// Looks of elements, unless every exemplar is packed.
    likeness: Option<Likeness>,
    colours: Vec<Option<GuideColours<'a>>>,
    field: &'a Correspondence,
    /// Packing of each exemplar, 0 to 1.
    packings: Vec<f64>,
    /// The area of the map that the field covers.
    known: [[i32; 2]; 2],
    cover: &'a Cover<'a>,
}

impl<'a> Resolver<'a> {
    /// `strata` holds the stratum of each element of the model.
    pub(super) fn new(
        field: &'a Correspondence,
        libraries: &'a [Library],
        model: &'a PlacementModel,
        grid: &'a Grid,
        (alike, strata): (&'a Substitutes, &[u8]),
        cover: &'a Cover<'a>,
    ) -> Self {
        let labels = &field.pages.labels;
        let packings: Vec<f64> =
            libraries.iter().zip(labels).map(|(library, labels)| packing(library, labels)).collect();
        let apart = packings.iter().any(|packing| *packing < PACKED);
        let likeness = apart.then(|| Likeness::new(libraries, labels, model, strata));
        let colours = libraries.iter().map(GuideColours::new).collect();
        let known = field.known(grid);
        Self { libraries, model, grid, alike, likeness, colours, field, packings, known, cover }
    }

    /// Whether the exemplar of a library counts as packed.
    pub(super) fn is_packed(&self, library: usize) -> bool {
        self.packings[library] >= PACKED
    }

    /// The elements that are placed for an instance. `allowed` tells whether a variant is permitted at a
    /// place.
    pub(super) fn resolve(
        &self,
        instance: &PixelInstance,
        allowed: impl Fn(&Mask, [i32; 2]) -> bool,
    ) -> Resolution {
        let main = instance.main();
        let element = self.model.element(main.variant);
        let between = |[loose, packed]: [f64; 2]| loose + self.packings[element.library] * (packed - loose);
        let clipped = element.clipped && !instance.cut;
        let mask = &self.model.shape(main.variant).mask;
        let at = self.best_place(instance, mask, main.at);
        let (union, covered) = self.fit(instance, mask, at);
        if !clipped && union >= between(WHOLE) && covered >= between(COVERED) && allowed(mask, at) {
            return Resolution::Whole(vec![(main.variant, at)]);
        }
        if !instance.cut
            && let Some((variant, at)) = self.similar_element(instance)
            && allowed(&self.model.shape(variant).mask, at)
        {
            return Resolution::Like(variant, at);
        }
        // Half a motif would be conspicuous.
        if self.libraries[element.library].source.kind == SourceKind::Drawing {
            let stands = !clipped && allowed(mask, main.at);
            return if stands {
                Resolution::Whole(vec![(main.variant, main.at)])
            } else {
                Resolution::Nothing
            };
        }
        if !self.is_packed(element.library)
            && !instance.cut
            && instance.mask.area() >= LOOKED_AT
            && let Some(likeness) = &self.likeness
            && let Some(outcome) = self.replacement(instance, likeness, &allowed)
        {
            return outcome;
        }
        let is_free = |at: [i32; 2]| !self.cover.is_wanted(at);
        match fused(instance, self.libraries, self.model, is_free) {
            Some((element, mask)) if allowed(&mask, main.at) => Resolution::Fused(Box::new(element), mask),
            _ => Resolution::Nothing,
        }
    }

    /// Replaces an instance that looks like no element: by those of its elements that were copied in large
    /// part, by the most similar element, or by nothing. `None` if it looks like an element.
    fn replacement(
        &self,
        instance: &PixelInstance,
        likeness: &Likeness,
        allowed: impl Fn(&Mask, [i32; 2]) -> bool,
    ) -> Option<Resolution> {
        let main = instance.main();
        let (x, y) = instance.mask.centroid()?;
        let variation = self.model.variation(main.variant);
        let colour = |at: [i32; 2]| instance.mask.contains(at[0], at[1]).then(|| self.colour(at)).flatten();
        let look =
            ElementLook::new([x, y], f64::from(instance.mask.area()), |way| variation.of_point(way), colour);
        let nearest = likeness.nearest(self.model.element_of(main.variant), &look);
        if nearest.is_some_and(|(_, alike)| alike) {
            return None;
        }
        let mut standing: Vec<(VariantId, [i32; 2])> = Vec::new();
        let mut taken = Mask::default();
        for part in &instance.parts {
            let mask = &self.model.shape(part.variant).mask;
            let area = f64::from(mask.area());
            let there = mask.shifted(part.at[0], part.at[1]);
            let fits = f64::from(instance.mask.overlap(&there)) >= WITHIN * area
                && f64::from(part.mask.area()) >= CAME * area
                && f64::from(taken.overlap(&there)) <= ON_OTHERS * area;
            if fits && !self.model.element(part.variant).clipped && allowed(mask, part.at) {
                taken = Mask::from_spans(taken.spans().iter().chain(there.spans()).copied().collect());
                standing.push((part.variant, part.at));
            }
        }
        if !standing.is_empty() {
            return Some(Resolution::Whole(standing));
        }
        let at = [x, y].map(|v| libm::round(v) as i32);
        let other = nearest.map(|(id, _)| self.model.varied(id, main.variant));
        let fits = |variant: &VariantId| {
            let mask = &self.model.shape(*variant).mask;
            self.fit(instance, mask, at).0 >= LOOKS_LIKE && allowed(mask, at)
        };
        Some(other.filter(fits).map_or(Resolution::Nothing, |variant| Resolution::Like(variant, at)))
    }

    /// The colour that the field brings to a pixel of the map.
    fn colour(&self, at: [i32; 2]) -> Option<[f32; 3]> {
        let at = self.grid.canonical(at);
        let (page, there) = self.field.source([0, 1].map(|k| at[k] - self.grid.margin[k]));
        let sheet = &self.field.pages.sheets[page];
        let place = sheet.exemplar(self.model, there)?;
        self.colours[sheet.library].as_ref().map(|colours| colours.at(place))
    }

    /// The place at which the main element fits an instance best: that of its largest part, or middle on
    /// middle.
    fn best_place(&self, instance: &PixelInstance, mask: &Mask, at: [i32; 2]) -> [i32; 2] {
        if instance.cut || instance.parts.len() == 1 {
            return at;
        }
        let (Some((x, y)), Some((u, v))) = (instance.mask.centroid(), mask.centroid()) else { return at };
        let middle = [x - u, y - v].map(|v| libm::round(v) as i32);
        let union = |at: [i32; 2]| self.fit(instance, mask, at).0;
        if union(middle) > union(at) { middle } else { at }
    }

    /// Overlap over union of an instance and a mask at a place, and the share of the instance that it covers.
    /// Pixels outside the field are ignored.
    fn fit(&self, instance: &PixelInstance, mask: &Mask, at: [i32; 2]) -> (f64, f64) {
        let there = mask.shifted(at[0], at[1]);
        let there = if instance.cut {
            let [low, high] = self.known;
            let along = |k: usize, wrap: bool| if wrap { (i32::MIN, i32::MAX) } else { (low[k], high[k]) };
            let (x, y) = (along(0, self.grid.tile.x), along(1, self.grid.tile.y));
            there.within([x.0, y.0], [x.1, y.1])
        } else {
            there
        };
        let (own, other) = (f64::from(instance.mask.area()), f64::from(there.area()));
        let both = f64::from(instance.mask.overlap(&there));
        (both / (own + other - both).max(1.0), both / own.max(1.0))
    }

    /// The element that fits an instance best of those like its main one, if it fits well.
    fn similar_element(&self, instance: &PixelInstance) -> Option<(VariantId, [i32; 2])> {
        let main = instance.main();
        let (x, y) = instance.mask.centroid()?;
        let at = [x, y].map(|v| libm::round(v) as i32);
        let area = f64::from(instance.mask.area());
        let areas = AREAS[0] * area..AREAS[1] * area;
        let fit = |element: PlaceableId| {
            let variant = self.model.varied(element, main.variant);
            let (union, _) = self.fit(instance, &self.model.shape(variant).mask, at);
            (union >= LIKE).then_some((union, variant))
        };
        let candidates = self.alike.of(self.model.element_of(main.variant), areas, CANDIDATES, 0.0);
        let best = candidates.filter_map(fit).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
        Some((best.1, at))
    }
}

/// The packing of an exemplar, 0 to 1: by how much primaries touch, or how much they cover, or how much
/// of the background secondaries do.
fn packing(library: &Library, labels: &LabelMap) -> f64 {
    let (mut all, mut others) = (0u64, 0u64);
    // Steps from a primary to a pixel that is not its own.
    let mut step = |a: u32, b: u32| {
        if a != b {
            all += u64::from(a > 0) + u64::from(b > 0);
            others += 2 * u64::from(a > 0 && b > 0);
        }
    };
    for y in 0..labels.height {
        let row = labels.row(y);
        row.windows(2).for_each(|w| step(w[0], w[1]));
        if y > 0 {
            labels.row(y - 1).iter().zip(row).for_each(|(&a, &b)| step(a, b));
        }
    }
    let share = |part: u64, of: usize| part as f64 / of.max(1) as f64;
    let covered = share(labels.labels.iter().filter(|l| **l > 0).count() as u64, labels.labels.len());
    let background = (1.0 - covered) * labels.labels.len() as f64;
    let patches: u64 = library.secondaries().iter().map(|s| u64::from(s.area)).sum();
    let tiled = patches as f64 / background.max(1.0);
    let within = |v: f64, [low, high]: [f64; 2]| (v - low) / (high - low);
    let contact = share(others, all as usize) / CONTACT;
    contact.max(within(covered, PRIMARIES)).max(within(tiled, TILED)).clamp(0.0, 1.0)
}
