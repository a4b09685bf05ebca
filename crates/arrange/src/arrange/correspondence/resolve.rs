//! The elements placed for each instance: a whole element, a similar one, a fused one, or none.
//!
//! The main element of an instance is placed whole if it fits as it is; the more packed the exemplar, the closer it has
//! to fit. If another element of similar colour and size fits better, that one is placed.
//!
//! If none fits, the instance is one thing all the same:
//!
//! * Where elements stand apart, and it looks like none of the exemplar ([`likeness`](super::likeness)), as two flowers
//!   at once do, those of its elements are placed that were copied in large part.
//! * Where the canvas cuts it, that of its elements is placed that fits it best.
//! * Else the element that fits best after a gentle map is placed ([`mapped`](super::mapped)), of those that it was
//!   copied from and those like its main one; if none fits well, one that is also bent ([`bent`](super::bent)).
//! * What remains is fused of its parts where elements interlock or are long, since a gap would be seen there.
//!
//! Elements cut by the exemplar's border are placed only where the canvas cuts them too.

use super::Correspondence;
use super::bent::Bent;
use super::cover::Cover;
use super::fused::fused;
use super::instances::{PixelInstance, PrimaryPixels};
use super::likeness::{ElementLook, GuideColours, Likeness};
use super::mapped::Moments;
use super::similar::Substitutes;
use crate::arrange::grid::Grid;
use crate::arrange::model::{PlaceableId, PlacementModel, VariantId};
use crate::arrange::variation::Variation;
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::{Element, ElementId, LibraryId};

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
pub(super) const PACKED: f64 = 0.65;
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

/// Areas that an element may have that is mapped onto an instance, as multiples of the instance's area.
const MAPPED_AREAS: [f64; 2] = [0.5, 2.0];
/// Number of elements whose pixels are compared: those that votes and strain speak for most.
const COMPARED: usize = 12;
/// Least overlap over union of an instance and an element mapped onto it, for elements that are apart and for packed
/// ones.
const MAPPED: [f64; 2] = [0.6, 0.82];
/// Number of elements that are bent if none fits so well, and the least overlap over union of one of them.
const BENT_ONES: usize = 3;
const BENT: f64 = 0.68;
/// Most that the area of an element grows.
const LARGER: f64 = 1.6;
/// Coverage from which on there is no ground that could be seen in a gap: all elements are bent there, and enlarged so
/// much that they reach beneath their neighbours.
const TIGHT: f64 = 0.96;
const TIGHT_GROWTH: f64 = 1.1;
/// Least overlap over union of an instance that the canvas cuts and an element that it cuts, too.
const CUT: f64 = 0.70;
/// Least ratio of length to width of an element that counts as long.
const LONG: f64 = 4.0;
/// Cost of a unit of strain, and worth of an element from which all of an instance was copied, both in overlap over
/// union.
const STRAIN: f64 = 0.08;
const VOTES: f64 = 0.1;

/// An element mapped onto an instance.
pub(super) struct Mapped {
    /// The element in the variation of the instance.
    pub(super) variant: VariantId,
    /// The map of the primary, its variation included.
    pub(super) map: Variation,
    /// Its pixels, relative to its origin, and the place of that.
    pub(super) mask: Mask,
    pub(super) at: [i32; 2],
    union: f64,
}

/// An element that is drawn for one place only.
pub(super) struct Made {
    /// The element that it is made of, or most of it.
    pub(super) variant: VariantId,
    pub(super) element: Element,
    /// Its pixels, relative to its origin, and the place of that.
    pub(super) mask: Mask,
    pub(super) at: [i32; 2],
}

/// The elements that are placed for an instance.
pub(super) enum Resolution {
    /// Elements that it is copied from.
    Whole(Vec<(VariantId, [i32; 2])>),
    /// Another element of similar colour and size.
    Like(VariantId, [i32; 2]),
    /// One, gently mapped.
    Mapped(Box<Mapped>),
    /// One, gently mapped and bent.
    Bent(Box<Made>),
    /// One of several parts.
    Fused(Box<Made>),
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
    /// Where the pixels of each element lie about its origin.
    moments: Vec<Option<Moments>>,
    field: &'a Correspondence,
    /// Packing of each exemplar, 0 to 1.
    packings: Vec<f64>,
    /// The area of the map that the field covers.
    known: [[i32; 2]; 2],
    cover: &'a Cover<'a>,
}

impl<'a> Resolver<'a> {
    /// `strata` holds the stratum of each element of the model; `packings` are of the exemplars, as [`packings`] gives
    /// them.
    pub(super) fn new(
        field: &'a Correspondence,
        libraries: &'a [Library],
        model: &'a PlacementModel,
        grid: &'a Grid,
        (alike, strata): (&'a Substitutes, &[u8]),
        packings: Vec<f64>,
        cover: &'a Cover<'a>,
    ) -> Self {
        let labels = &field.pages.labels;
        let apart = packings.iter().any(|packing| *packing < PACKED);
        let likeness = apart.then(|| Likeness::new(libraries, labels, model, strata));
        let colours = libraries.iter().map(GuideColours::new).collect();
        let known = field.known(grid);
        let plain = |k: usize| Moments::of(&model.plain(PlaceableId(k as u32)).mask);
        let moments = (0..model.elements.len()).map(plain).collect();
        Self { libraries, model, grid, alike, likeness, colours, moments, field, packings, known, cover }
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
        if instance.cut {
            if let Some(standing) = self.cut_as_well(instance, &allowed) {
                return Resolution::Whole(vec![standing]);
            }
        } else if let Some(outcome) = self.of_one_element(instance, &allowed) {
            return outcome;
        }
        if !self.is_packed(element.library)
            && instance.mask.area() >= LOOKED_AT
            && self.has_whole_ones(instance)
            && !self.is_long(main.variant)
        {
            return Resolution::Nothing;
        }
        let is_free = |at: [i32; 2]| !self.cover.is_wanted(at);
        match fused(instance, self.libraries, self.model, is_free) {
            Some((element, mask)) if allowed(&mask, main.at) => {
                Resolution::Fused(Box::new(Made { element, mask, variant: main.variant, at: main.at }))
            }
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

    /// The element that fits an instance best after a gentle map, or, if none does well, after it was bent, too: one of
    /// those that the instance was copied from, or one like the main one of these.
    fn of_one_element(
        &self,
        instance: &PixelInstance,
        allowed: impl Fn(&Mask, [i32; 2]) -> bool,
    ) -> Option<Resolution> {
        let PixelInstance { parts, mask, .. } = instance;
        let main = instance.main().variant;
        let library = self.model.element(main).library;
        let wanted = Moments::of(mask)?;
        let area = f64::from(mask.area());
        let own = parts.iter().map(|part| (part.variant, f64::from(part.mask.area()) / area));
        let areas = MAPPED_AREAS[0] * area..MAPPED_AREAS[1] * area;
        let main_element = self.model.element_of(main);
        let others = self.alike.of(main_element, areas, CANDIDATES, 0.0);
        let others = others.map(|other| (self.model.varied(other, main), 0.0));
        let mut candidates: Vec<(VariantId, f64, [f64; 3], f64)> = Vec::new();
        for (variant, votes) in own.chain(others) {
            let is_new = candidates.iter().all(|known| known.0 != variant);
            let Some(moments) = &self.moments[self.model.element_of(variant).0 as usize] else { continue };
            if is_new && self.model.element(variant).placeable {
                let (map, strain) = moments.varied(self.model.variation(variant)).onto(&wanted);
                candidates.push((variant, VOTES * votes - STRAIN * strain, map, strain));
            }
        }
        candidates.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        candidates.truncate(COMPARED);
        let judged = candidates.into_iter().filter_map(|(variant, worth, map, _)| {
            let mapped = self.under(variant, map, wanted.middle, mask)?;
            allowed(&mapped.mask, mapped.at).then_some((mapped.union + worth, mapped))
        });
        let mut judged: Vec<(f64, Mapped)> = judged.collect();
        judged.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.variant.cmp(&b.1.variant)));
        let is_tight = self.libraries[library].coverage >= TIGHT;
        let least = if is_tight { 1.0 } else { MAPPED[0] + self.packings[library] * (MAPPED[1] - MAPPED[0]) };
        let growth = if is_tight { TIGHT_GROWTH } else { 1.0 };
        if let Some(k) = judged.iter().position(|(_, mapped)| mapped.union >= least) {
            return Some(Resolution::Mapped(Box::new(judged.swap_remove(k).1)));
        }
        let bent = judged.iter().take(BENT_ONES).filter_map(|(_, mapped)| {
            let known = self.model.element(mapped.variant);
            let primary = &self.libraries[known.library].primaries()[known.index as usize];
            let bent = Bent::onto(mapped, primary, mask, growth)?;
            let union = union(mask, &bent.mask, mapped.at);
            let is_alike = union >= BENT / (growth * growth)
                && f64::from(bent.mask.area()) <= LARGER * f64::from(primary.area);
            (is_alike && allowed(&bent.mask, mapped.at)).then_some((union, mapped, bent))
        });
        let (_, mapped, bent) = bent.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let known = self.model.element(mapped.variant);
        let category = bent.primary.category;
        let (shapes, mask) = bent.into_shapes();
        let element = Element {
            library: LibraryId(known.library as u32),
            source: Some(ElementId(known.index)),
            category,
            fused: true,
            silhouette: None,
            shapes,
        };
        Some(Resolution::Bent(Box::new(Made { element, mask, variant: mapped.variant, at: mapped.at })))
    }

    /// Whether an element is long, such as the gap between two planks: islands cut it, and its parts run on.
    fn is_long(&self, variant: VariantId) -> bool {
        let moments = &self.moments[self.model.element_of(variant).0 as usize];
        moments.as_ref().is_some_and(|moments| moments.elongation() >= LONG)
    }

    /// Whether an instance was copied from an element that may be placed, or is like one. A photograph may cut all
    /// large things that it shows.
    fn has_whole_ones(&self, instance: &PixelInstance) -> bool {
        let is_whole = |part: &PrimaryPixels| self.model.element(part.variant).placeable;
        let main = self.model.element_of(instance.main().variant);
        instance.parts.iter().any(is_whole) || self.alike.of(main, 0.0..f64::MAX, 1, 0.0).next().is_some()
    }

    /// A variant under a symmetric map, with its middle at a place, beside a mask.
    fn under(&self, variant: VariantId, map: [f64; 3], middle: [f64; 2], beside: &Mask) -> Option<Mapped> {
        let element = self.model.element_of(variant);
        let map = self.model.variation(variant).then(map);
        let mask = map.of_mask(&self.model.plain(element).mask);
        let (x, y) = mask.centroid()?;
        let at = [middle[0] - x, middle[1] - y].map(|v| libm::round(v) as i32);
        let union = union(beside, &mask, at);
        Some(Mapped { variant, map, mask, at, union })
    }

    /// Of the elements that an instance at the border was copied from, the one that fits it best where it lies.
    fn cut_as_well(
        &self,
        instance: &PixelInstance,
        allowed: impl Fn(&Mask, [i32; 2]) -> bool,
    ) -> Option<(VariantId, [i32; 2])> {
        let fits = |part: &PrimaryPixels| {
            let mask = &self.model.shape(part.variant).mask;
            let (union, _) = self.fit(instance, mask, part.at);
            (union >= CUT && allowed(mask, part.at)).then_some((union, (part.variant, part.at)))
        };
        let best =
            instance.parts.iter().filter_map(fits).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        best.map(|(_, standing)| standing)
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

/// Overlap over union of a mask and another one at a place.
pub(super) fn union(one: &Mask, other: &Mask, at: [i32; 2]) -> f64 {
    let both = f64::from(one.overlap(&other.shifted(at[0], at[1])));
    both / (f64::from(one.area()) + f64::from(other.area()) - both).max(1.0)
}

/// The packing of each exemplar, 0 to 1.
pub(super) fn packings(libraries: &[Library], labels: &[LabelMap]) -> Vec<f64> {
    libraries.iter().zip(labels).map(|(library, labels)| packing(library, labels)).collect()
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
