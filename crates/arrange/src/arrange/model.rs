//! Data that placement derives from libraries once: the elements that may be placed, their shapes, and the
//! exemplars' runs.
//!
//! A *variant* is an element in one of its variations (rotated, mirrored, scaled). Variants are numbered
//! element by element; without variations each element has one variant. The shape of a variant is made when it
//! is first needed; its descriptor is the exemplar's arrangement under the same map. Elements and categories
//! have numbers that are unique over all libraries.

use super::turned::{self, Turned};
use super::variation::Variation;
use std::ops::{Index, Range};
use std::sync::OnceLock;
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::library::{CategoryId, Library};
use vtex_scene::scene::{Element, SynthParams};

/// Index of an element: a primary of any of the libraries, or a part of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct PlaceableId(pub(crate) u32);

/// Index of a variant of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct VariantId(pub(crate) u32);

/// A cell that may hold anything.
pub(crate) const UNDEFINED: u16 = u16::MAX;
/// A cell that should hold no primary.
pub(crate) const EMPTY: u16 = 0;

/// The shape of a variant.
pub(crate) struct VariantShape {
    /// Its pixels, relative to the origin.
    pub(crate) mask: Mask,
    /// Box around its pixels relative to the origin: x0, y0, x1, y1, ends exclusive.
    pub(crate) bounds: [i32; 4],
    /// Number of pixels.
    pub(crate) area: u32,
}

impl VariantShape {
    fn new(mask: Mask) -> Self {
        let bounds = mask.bounds().map_or([0; 4], |b| [b.0, b.1, b.2, b.3]);
        Self { area: mask.area(), bounds, mask }
    }
}

/// A primary of one of the libraries, or a part of one.
#[derive(Clone, Copy)]
pub(crate) struct Placeable {
    /// Index of its library.
    pub(crate) library: usize,
    /// Its index in that library.
    pub(crate) index: u32,
    /// Its centroid in the exemplar, rounded to whole pixels.
    pub(crate) origin: [i32; 2],
    /// Index of its category.
    pub(crate) category: usize,
    /// Its category as a cell of the target map; [`EMPTY`] if the category cannot be placed.
    pub(crate) code: u16,
    /// Whether it may be placed: it is whole and fits on the canvas.
    pub(crate) placeable: bool,
    /// Whether the border of its exemplar cuts it.
    pub(crate) clipped: bool,
    /// What is drawn.
    pub(crate) content: Content,
}

/// What is drawn for an element of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// The primary of the library, in its variation.
    Known,
    /// The primary under a map of [`PlacementModel::maps`].
    Mapped(u32),
    /// An element of [`PlacementModel::fused`].
    Fused(u32),
}

/// One library.
pub(crate) struct LibraryModel {
    /// Indices of its elements.
    pub(crate) elements: Range<u32>,
    /// Its categories.
    pub(crate) categories: Range<usize>,
    /// Half the side of its descriptors, in pixels.
    pub(crate) half: i32,
    /// Placeable textons per pixel of the exemplar.
    pub(crate) density: f64,
    exemplar: ArrangementRuns,
}

/// Libraries made ready for placement.
pub(crate) struct PlacementModel {
    /// The libraries.
    pub(crate) sources: Vec<LibraryModel>,
    /// All elements.
    pub(crate) elements: Vec<Placeable>,
    /// Elements of each category that may be placed.
    pub(crate) members: Vec<Vec<PlaceableId>>,
    /// Half the side of the largest descriptor, in pixels.
    pub(crate) half: i32,
    /// Largest distance of a pixel of a placeable element from the origin along an axis, in pixels.
    pub(crate) reach: i32,
    /// Wanted share of the library's area, for each category; zero if no element of it can be placed.
    pub(crate) wanted: Vec<f64>,
    /// The variations; the first leaves elements as they are.
    pub(crate) variations: Vec<Variation>,
    /// How the exemplar is turned by default.
    pub(crate) turned: Option<Turned>,
    /// The fused elements as they are drawn.
    pub(crate) fused: Vec<Element>,
    /// The maps of primaries that have one of their own.
    pub(crate) maps: Vec<Variation>,
    shapes: Vec<OnceLock<VariantShape>>,
}

/// The exemplar's arrangement as runs by row.
struct ArrangementRuns {
    width: i32,
    height: i32,
    wrap: bool,
    /// Index of each row's first run.
    rows: Vec<u32>,
    runs: Vec<LabelRun>,
}

/// Cells of one label in a row.
struct LabelRun {
    /// Column after the last cell.
    end: i32,
    label: u32,
}

impl ArrangementRuns {
    fn new(map: &LabelMap, wrap: bool) -> Self {
        let mut rows = vec![0];
        let mut runs = Vec::new();
        for y in 0..map.height {
            let mut x = 0;
            for run in map.row(y).chunk_by(|a, b| a == b) {
                x += run.len() as i32;
                runs.push(LabelRun { end: x, label: run[0] });
            }
            rows.push(runs.len() as u32);
        }
        Self { width: map.width as i32, height: map.height as i32, wrap, rows, runs }
    }

    fn row_of(&self, y: i32) -> &[LabelRun] {
        &self.runs[self.rows[y as usize] as usize..self.rows[y as usize + 1] as usize]
    }

    /// Calls `visit(x0, x1, label)` for the runs of row `y` within `from..to`.
    fn row(&self, y: i32, from: i32, to: i32, mut visit: impl FnMut(i32, i32, u32)) {
        let (row, first, last) = if self.wrap {
            let last = (to - 1).div_euclid(self.width);
            (y.rem_euclid(self.height), from.div_euclid(self.width), last)
        } else if (0..self.height).contains(&y) {
            (y, 0, 0)
        } else {
            return;
        };
        let runs = self.row_of(row);
        for tile in first..=last {
            let shift = tile * self.width;
            let (low, high) = ((from - shift).max(0), (to - shift).min(self.width));
            let mut x = low;
            let start = runs.partition_point(|run| run.end <= low);
            for &LabelRun { end, label } in &runs[start..] {
                if x >= high {
                    break;
                }
                let end = end.min(high);
                visit(x + shift, end + shift, label);
                x = end;
            }
        }
    }

    /// The label at a place; `None` outside the exemplar.
    fn at(&self, [x, y]: [i32; 2]) -> Option<u32> {
        let [x, y] = if self.wrap { [x.rem_euclid(self.width), y.rem_euclid(self.height)] } else { [x, y] };
        if !(0..self.width).contains(&x) || !(0..self.height).contains(&y) {
            return None;
        }
        let runs = self.row_of(y);
        runs.get(runs.partition_point(|run| run.end <= x)).map(|run| run.label)
    }
}

impl PlacementModel {
    /// The model of libraries, for the canvas and the variations of the parameters.
    pub(crate) fn new(libraries: &[Library], params: &SynthParams) -> Self {
        let turned = if params.rotate.is_none() { turned::by_default(libraries) } else { None };
        let variations = Variation::all(params, turned);
        let mut model = Self {
            sources: Vec::new(),
            elements: Vec::new(),
            members: Vec::new(),
            half: 0,
            reach: 0,
            wanted: Vec::new(),
            variations,
            turned,
            fused: Vec::new(),
            maps: Vec::new(),
            shapes: Vec::new(),
        };
        for library in libraries {
            model.add(library, params);
        }
        model
    }

    /// Adds the elements and categories of a library.
    fn add(&mut self, library: &Library, params: &SynthParams) {
        let map = library.arrangement.to_labels();
        let wrap = library.arrangement.periodic;
        let torus = wrap.then_some([map.width as i32, map.height as i32]);
        let masks = Mask::all_of_labels(&map, library.primaries().len() + 1);
        let (first_element, first_category) = (self.elements.len() as u32, self.members.len());
        self.members.resize(first_category + library.categories.len(), Vec::new());
        // On a canvas that repeats, an element as large as the canvas would overlap itself.
        let limit = [(params.tile.x, params.width), (params.tile.y, params.height)]
            .map(|(wrap, size)| if wrap { size as i32 } else { i32::MAX });
        let growth = self.variations.iter().map(Variation::growth).fold(1.0, f64::max);
        for (p, mask) in library.primaries().iter().zip(&masks[1..]) {
            let origin = p.origin();
            let shape = VariantShape::new(mask.around(origin, torus));
            let b = shape.bounds;
            let reach = b.map(i32::abs).into_iter().max().unwrap_or(0);
            let [w, h] = if self.variations.len() > 1 { [2 * reach; 2] } else { [b[2] - b[0], b[3] - b[1]] };
            let fits =
                growth * f64::from(w) < f64::from(limit[0]) && growth * f64::from(h) < f64::from(limit[1]);
            let placeable = !p.clipped && shape.area > 0 && fits;
            let category = first_category + p.category.map_or(0, CategoryId::index);
            if placeable {
                self.members[category].push(PlaceableId(self.elements.len() as u32));
                self.reach = self.reach.max(libm::ceil(growth * f64::from(reach)) as i32);
            }
            let index = self.elements.len() as u32 - first_element;
            let library = self.sources.len();
            let (code, clipped, content) = (EMPTY, p.clipped, Content::Known);
            self.elements.push(Placeable {
                library,
                index,
                origin,
                category,
                code,
                placeable,
                clipped,
                content,
            });
            self.shapes.push(OnceLock::from(shape));
            self.shapes.extend((1..self.variations.len()).map(|_| OnceLock::new()));
        }
        for p in &mut self.elements[first_element as usize..] {
            if !self.members[p.category].is_empty() && p.category < usize::from(UNDEFINED - 1) {
                p.code = p.category as u16 + 1;
            }
        }
        let placeable = self.members[first_category..].iter().map(Vec::len).sum::<usize>();
        self.wanted.extend(wanted(library, &self.members[first_category..]));
        self.half = self.half.max(library.descriptor_half as i32);
        self.sources.push(LibraryModel {
            elements: first_element..self.elements.len() as u32,
            categories: first_category..self.members.len(),
            half: library.descriptor_half as i32,
            density: placeable as f64 / (f64::from(map.width) * f64::from(map.height)),
            exemplar: ArrangementRuns::new(&map, wrap),
        });
    }

    /// Adds a part of a variant as an element that placement never chooses. Returns its variant.
    pub(crate) fn add_fused(&mut self, variant: VariantId, mask: Mask, painted: Element) -> VariantId {
        self.fused.push(painted);
        self.add_made(variant, mask, Content::Fused(self.fused.len() as u32 - 1))
    }

    /// Adds a primary under a map of its own as an element that placement never chooses. `variant` is the primary in
    /// the variation that is nearest. Returns its variant.
    pub(crate) fn add_mapped(&mut self, variant: VariantId, mask: Mask, map: Variation) -> VariantId {
        self.maps.push(map);
        self.add_made(variant, mask, Content::Mapped(self.maps.len() as u32 - 1))
    }

    fn add_made(&mut self, variant: VariantId, mask: Mask, content: Content) -> VariantId {
        let element = PlaceableId(self.elements.len() as u32);
        self.elements.push(Placeable { placeable: false, content, ..*self.element(variant) });
        let shape = OnceLock::from(VariantShape::new(mask));
        // Only the variation of `variant` is used.
        self.shapes.extend((0..self.variations.len()).map(|_| OnceLock::new()));
        let part = self.varied(element, variant);
        self.shapes[part.0 as usize] = shape;
        part
    }

    /// Depth in the painting order, where the deepest is painted first: the area of a variant; fused parts lie
    /// beneath all others.
    pub(crate) fn depth(&self, variant: VariantId) -> u32 {
        const BENEATH: u32 = 1 << 31;
        let area = self.shape(variant).area;
        if matches!(self.element(variant).content, Content::Fused(_)) {
            BENEATH.saturating_add(area)
        } else {
            area
        }
    }

    /// Index of the element of a variant.
    pub(crate) fn element_of(&self, variant: VariantId) -> PlaceableId {
        PlaceableId(variant.0 / self.variations.len() as u32)
    }

    /// The element of a variant.
    pub(crate) fn element(&self, variant: VariantId) -> &Placeable {
        &self[self.element_of(variant)]
    }

    /// Index of the variation of a variant.
    pub(crate) fn variation_of(&self, variant: VariantId) -> u16 {
        (variant.0 as usize % self.variations.len()) as u16
    }

    /// The variation of a variant.
    pub(crate) fn variation(&self, variant: VariantId) -> &Variation {
        &self.variations[usize::from(self.variation_of(variant))]
    }

    /// An element in one of the variations.
    pub(crate) fn in_variation(&self, element: PlaceableId, variation: u16) -> VariantId {
        VariantId(element.0 * self.variations.len() as u32 + u32::from(variation))
    }

    /// An element in the variation of another variant.
    pub(crate) fn varied(&self, element: PlaceableId, like: VariantId) -> VariantId {
        self.in_variation(element, self.variation_of(like))
    }

    /// An element in a variation drawn at random.
    pub(crate) fn draw_variant(
        &self,
        element: PlaceableId,
        random: &mut vtex_base::sampling::Stream,
    ) -> VariantId {
        let count = self.variations.len();
        self.in_variation(element, if count > 1 { random.index(count) as u16 } else { 0 })
    }

    /// The shape of a variant, made when first needed.
    pub(crate) fn shape(&self, variant: VariantId) -> &VariantShape {
        self.shapes[variant.0 as usize].get_or_init(|| {
            let unvaried = self.in_variation(self.element_of(variant), 0);
            let unvaried = self.shapes[unvaried.0 as usize]
                .get()
                .expect("the first variant of each element is made at once");
            VariantShape::new(self.variation(variant).of_mask(&unvaried.mask))
        })
    }

    /// Calls `visit(y, x0, x1, label)` for the runs of the descriptor's window around a variant, relative to its
    /// origin. Label k is primary k - 1 of its library, 0 the background. Places outside the exemplar have no run.
    pub(crate) fn window(&self, variant: VariantId, mut visit: impl FnMut(i32, i32, i32, u32)) {
        let element = self.element(variant);
        let LibraryModel { half, exemplar, .. } = &self.sources[element.library];
        let [ox, oy] = element.origin;
        let variation = self.variation(variant);
        for y in -half..=*half {
            if variation.is_none() {
                exemplar.row(oy + y, ox - half, ox + half + 1, |x0, x1, label| {
                    visit(y, x0 - ox, x1 - ox, label);
                });
                continue;
            }
            let mut run: Option<(i32, u32)> = None;
            for x in -half..=half + 1 {
                let label = if x <= *half {
                    let [dx, dy] = variation.source_pixel([x, y]);
                    exemplar.at([ox + dx, oy + dy])
                } else {
                    None
                };
                if let Some((start, old)) = run
                    && label != Some(old)
                {
                    visit(y, start, x, old);
                    run = None;
                }
                if let (None, Some(label)) = (run, label) {
                    run = Some((x, label));
                }
            }
        }
    }

    /// Placeable elements per pixel of the exemplar, averaged over libraries.
    pub(crate) fn density(&self) -> f64 {
        self.sources.iter().map(|s| s.density).sum::<f64>() / self.sources.len() as f64
    }

    /// Mean area of the placeable primaries, in pixels.
    pub(crate) fn mean_area(&self) -> f64 {
        let areas = self.members.iter().flatten().map(|&p| f64::from(self.plain(p).area));
        let count = self.members.iter().map(Vec::len).sum::<usize>().max(1);
        areas.sum::<f64>() / count as f64
    }

    /// The shape of an element without variation.
    pub(crate) fn plain(&self, element: PlaceableId) -> &VariantShape {
        self.shape(self.in_variation(element, 0))
    }
}

impl Index<PlaceableId> for PlacementModel {
    type Output = Placeable;

    fn index(&self, element: PlaceableId) -> &Placeable {
        &self.elements[element.0 as usize]
    }
}

/// Wanted coverage of each category. The coverage of categories that cannot be placed is added to that of the
/// others, in proportion and by at most a tenth of theirs.
fn wanted(library: &Library, members: &[Vec<PlaceableId>]) -> Vec<f64> {
    let share = |c: usize| if members[c].is_empty() { 0.0 } else { library.categories[c].coverage };
    let possible: f64 = (0..members.len()).map(share).sum();
    let factor = if possible > 0.0 { (library.coverage / possible).clamp(0.5, 1.1) } else { 0.0 };
    (0..members.len()).map(|c| share(c) * factor).collect()
}
