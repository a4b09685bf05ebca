//! Placement by correspondences: elements carried along a field that gives the place in the exemplar that
//! each place of the canvas comes from.
//!
//! The descriptors of the paper see a few textons around one. Larger structure, such as clouds of rust or
//! courses of a wall, is kept by copying whole islands of the exemplar, as pixel-based synthesis does.
//! Primaries, secondaries and the colours of the background are copied together.
//!
//! 1. Exemplars become pages of cells ([`pages`]), and the field is found ([`vtex_field::correspondence`]).
//! 2. Pixels of the canvas that show one element together are an instance ([`instances`]).
//! 3. Each instance becomes a whole element, another like it, one gently mapped onto it, or, where elements
//!    interlock, a fused one ([`resolve`], [`likeness`], [`mapped`], [`fused`]).
//! 4. With a lattice, elements are moved until their offset is a vector of the lattice, unless the exemplar
//!    is packed and its elements stray by more than a pixel. A lattice that holds in parts only is reported,
//!    and followed only on request.
//! 5. Secondaries come along with their islands ([`secondaries`]), with their own colours.
//!
//! A small tile that was repeated for its analysis ([`Source::copies`](vtex_scene::library::Source::copies)) is one
//! period: the field repeats it.
//!
//! Coverage follows from the field. It is corrected only where a map asks for another density.

mod bent;
mod courses;
mod cover;
mod fused;
mod ground;
mod instances;
mod likeness;
mod mapped;
mod pages;
mod resolve;
mod rows;
mod secondaries;
mod shares;
mod similar;
mod streaks;
mod structure_classes;

use super::grid::{CellRun, Grid};
use super::model::{Content, PlacementModel, VariantId};
use super::region::PlacementRegion;
use super::turned::Turned;
use super::{PlacementContext, Plan};
use courses::Courses;
use cover::Cover;
use image::{Rgb, RgbImage};
use instances::Kinds;
use pages::Pages;
use resolve::{Mapped, Resolution, Resolver};
pub(crate) use secondaries::SecondaryPlace;
use serde::Serialize;
use similar::Substitutes;
use streaks::Streaks;
use structure_classes::StructureClasses;
use vtex_base::error::{Error, Result};
use vtex_base::parallel;
use vtex_base::progress::advance;
use vtex_base::raster::picture::label_colour;
use vtex_base::raster::{LabelMap, Mask};
use vtex_base::sampling::stream;
use vtex_field::correspondence::{CanvasRequest, CellSource, CorrespondenceField, Islands, find_again};
use vtex_field::layers::{Carrier, LayerExemplar, LayerMap};
use vtex_scene::lattice::{Lattice, Phases};
use vtex_scene::library::Library;
use vtex_scene::scene::{Edge, LatticeChoice, SynthParams};

/// Cells beyond the borders of the canvas, where it does not repeat.
const MARGIN: i32 = 6;

/// Largest stray of a lattice onto which elements are moved in a packed exemplar, in pixels.
const MOST_STRAY: f64 = 1.0;

/// Farthest that an element is moved onto a lattice, in cells: offsets may miss by a cell and a half.
const MOST_MOVED: f64 = 2.0;

/// Passes in which elements that replace what the field brings settle.
const PASSES: usize = 2;

/// Primaries carried along a correspondence field. Shares are of the canvas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Structure {
    /// How the exemplar was turned because few of its elements are whole; `None` if it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turned: Option<Turned>,
    /// Number of islands.
    pub islands: usize,
    /// Share on which primaries are wanted.
    pub wanted: f64,
    /// Primaries that were carried whole.
    pub whole: usize,
    /// Primaries that stand, moved, gently stretched or bent, for what was carried in part or of several.
    pub like: usize,
    /// Primaries fused from parts of others.
    pub fused: usize,
    /// Share that fused primaries cover.
    pub fused_share: f64,
    /// Share that is wanted but empty.
    pub empty: f64,
    /// Share that is covered but not wanted.
    pub unwanted: f64,
}

/// Elements carried along a field.
pub(super) struct Carried {
    /// Variants, fused ones included, and their places on the grid, in the order of placement.
    pub(super) elements: Vec<(VariantId, [i32; 2])>,
    pub(super) structure: Structure,
}

/// A canvas as a mosaic of its exemplars.
pub(crate) struct Correspondence {
    pages: Pages,
    field: CorrespondenceField,
    /// The lattice of each library, and how its phases run over the canvas.
    lattices: Vec<Option<(Lattice, Phases)>>,
    /// Cells beside the canvas, left and above.
    margin: [i32; 2],
}

impl Correspondence {
    /// Finds the correspondences of a canvas.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a library has no guide, [`Error::Interrupted`].
    pub(super) fn new(context: &PlacementContext<'_>, model: &PlacementModel) -> Result<Self> {
        let PlacementContext { plan, progress, .. } = *context;
        let (libraries, params) = (&*plan.libraries, &plan.params);
        let structure = StructureClasses::new(libraries, &plan.controls);
        let classes = structure.as_ref().map(StructureClasses::of_exemplar);
        let lattices = lattices(plan)?;
        let wrap = [params.tile.x, params.tile.y];
        let margin = wrap.map(|w| if w { 0 } else { MARGIN });
        let pages = Pages::new(libraries, model, classes, &lattices, margin).ok_or_else(no_guide)?;
        let cells =
            |k: usize, size: u32| (size as usize).div_ceil(pages.cell as usize) + 2 * margin[k] as usize;
        let size = [cells(0, params.width), cells(1, params.height)];
        let place =
            |x: usize, y: usize| [0, 1].map(|k| ([x, y][k] as i32 - margin[k]) * pages.cell + pages.cell / 2);
        let groups = match &structure {
            Some(classes) => Some(classes.of_cells([params.width, params.height], size, place)),
            None => shares::libraries(context, model, size, place),
        };
        let field = match repeated(plan, pages.cell, (size, margin)) {
            Some(field) if groups.is_none() => field,
            _ => {
                let active = shares::active(context, size, place);
                let (found, pages) = (&pages, &pages.pages);
                let request = CanvasRequest { pages, size, wrap, groups, active, seed: params.seed };
                let mut field = find_again(&request, plan.memory, progress)?;
                if let (None, [Some((lattice, phases))]) = (&request.groups, &lattices[..])
                    && let Some(streaks) = Streaks::find(&found.labels[0], lattice)
                {
                    streaks.run_on(&mut field, found, (lattice, phases), margin);
                }
                field
            }
        };
        let this = Self { pages, field, lattices, margin };
        progress.picture("correspondence", &|| this.picture(plan, model));
        progress.picture("islands", &|| this.islands_picture(params));
        Ok(this)
    }

    /// Whether the field has a source for a pixel on or beside the canvas.
    fn reaches(&self, at: [i32; 2]) -> bool {
        let cell = self.pages.cell;
        (0..2).all(|k| (0..self.field.size[k] as i32 * cell).contains(&(at[k] + self.margin[k] * cell)))
    }

    /// The carried primaries, and those fused from parts, which are added to the model.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub(super) fn carry(
        &self,
        context: &PlacementContext<'_>,
        model: &mut PlacementModel,
    ) -> Result<Carried> {
        let PlacementContext { plan, grid, region, progress } = *context;
        let (libraries, params) = (&*plan.libraries, &plan.params);
        let step = |done: u64| advance(progress, "carrying", done, 4);
        step(0)?;
        let kinds = Kinds::new(libraries, model);
        let instances = instances::find(self, model, grid, &kinds);
        let packings = resolve::packings(libraries, &self.pages.labels);
        step(1)?;
        let alike = Substitutes::new(libraries, model);
        let mut cover = Cover::new(grid, &instances);
        let resolver = Resolver::new(self, libraries, model, grid, (&alike, &kinds.strata), packings, &cover);
        let allowed = |mask: &Mask, at: [i32; 2]| {
            let middle = mask.centroid().map_or(at, |(x, y)| [at[0] + x as i32, at[1] + y as i32]);
            stands(grid, region, mask, at, middle)
        };
        step(2)?;
        let outcomes = parallel::map(&instances, |instance| resolver.resolve(instance, allowed));
        step(3)?;
        let packed: Vec<bool> = (0..libraries.len()).map(|library| resolver.is_packed(library)).collect();
        let mut structure = Structure {
            turned: model.turned,
            islands: Islands::new(&self.field).sizes.len(),
            ..Structure::default()
        };
        let mut elements = Vec::with_capacity(instances.len());
        // Those that replace what the field brings.
        let mut others = Vec::new();
        for (instance, outcome) in instances.iter().zip(outcomes) {
            let library = model.element(instance.main().variant).library;
            if let Resolution::Like(..) | Resolution::Mapped(_) | Resolution::Bent(_) = outcome
                && self.lattices[library].is_none()
            {
                others.push(elements.len());
            }
            let standing = match outcome {
                Resolution::Whole(standing) => {
                    structure.whole += standing.len();
                    standing
                }
                Resolution::Like(variant, at) => {
                    structure.like += 1;
                    vec![(variant, at)]
                }
                Resolution::Mapped(mapped) => {
                    structure.like += 1;
                    let Mapped { variant, map, mask, at, .. } = *mapped;
                    vec![(model.add_mapped(variant, mask, map), at)]
                }
                Resolution::Bent(made) => {
                    structure.like += 1;
                    vec![(model.add_fused(made.variant, made.mask, made.element), made.at)]
                }
                Resolution::Fused(made) => {
                    structure.fused += 1;
                    structure.fused_share += cover.share(&made.mask, made.at);
                    vec![(model.add_fused(made.variant, made.mask, made.element), made.at)]
                }
                Resolution::Nothing => Vec::new(),
            };
            for (variant, at) in standing {
                elements.push((variant, self.on_lattice(model, grid, packed[library], (variant, at))));
            }
        }
        for library in (0..packed.len()).filter(|&library| packed[library]) {
            let rows = self.lattices[library].as_ref();
            if let Some(courses) = rows.and_then(|rows| Courses::find(model, library, rows)) {
                courses.lay(&mut elements, model, grid, [params.tile.x, params.tile.y]);
            }
        }
        elements.iter().for_each(|&(variant, at)| cover.take(&model.shape(variant).mask, at));
        for k in (0..PASSES).flat_map(|_| &others) {
            let (variant, at) = elements[*k];
            let mask = &model.shape(variant).mask;
            elements[*k].1 = cover.settle(mask, at, |to| allowed(mask, to));
        }
        (structure.wanted, structure.empty, structure.unwanted) = cover.shares();
        if self.lattices.iter().any(Option::is_some) && model.variations.len() > 1 {
            vary(&mut elements, &self.lattices, model, params.seed);
        }
        step(4)?;
        Ok(Carried { elements, structure })
    }

    /// The place of a variant, moved to where its offset from the exemplar is a vector of the lattice, if
    /// there is one. Not in a packed exemplar whose elements stray: joints would open.
    fn on_lattice(
        &self,
        model: &PlacementModel,
        grid: &Grid,
        packed: bool,
        (variant, at): (VariantId, [i32; 2]),
    ) -> [i32; 2] {
        let element = model.element(variant);
        let Some((lattice, canvas)) = &self.lattices[element.library] else { return at };
        if lattice.stray > MOST_STRAY && packed {
            return at;
        }
        let place = [0, 1].map(|k| f64::from(at[k] - grid.margin[k]));
        let way = lattice.residual(canvas, element.origin.map(f64::from), place);
        // An element that replaces another may have another phase; it is not moved.
        if libm::hypot(way[0], way[1]) > MOST_MOVED * f64::from(self.pages.cell) {
            return at;
        }
        [0, 1].map(|k| at[k] + libm::round(way[k]) as i32)
    }

    /// Page and pixel there that a pixel of the canvas comes from; the pixel may lie beside the
    /// canvas by less than the margin.
    fn source(&self, [x, y]: [i32; 2]) -> (usize, [i32; 2]) {
        let cell = self.pages.cell;
        let at = [x + self.margin[0] * cell, y + self.margin[1] * cell];
        let [cx, cy] = at.map(|v| v.div_euclid(cell));
        let [cx, cy] =
            [cx.clamp(0, self.field.size[0] as i32 - 1), cy.clamp(0, self.field.size[1] as i32 - 1)];
        let source = self.field.sources[cy as usize * self.field.size[0] + cx as usize];
        let place = [0, 1].map(|k| i32::from(source.at[k]) * cell + at[k].rem_euclid(cell));
        (usize::from(source.page), place)
    }

    /// Side of a cell, in pixels.
    pub(crate) fn cell(&self) -> i32 {
        self.pages.cell
    }

    /// The primary on each pixel of each exemplar.
    pub(crate) fn labels(&self) -> &[LabelMap] {
        &self.pages.labels
    }

    /// Library and place in its exemplar that a place of the canvas comes from.
    pub(crate) fn origin(&self, model: &PlacementModel, at: [f64; 2]) -> (usize, [f64; 2]) {
        let (page, there) = self.source(at.map(|v| libm::floor(v) as i32));
        let sheet = &self.pages.sheets[page];
        let place = sheet.exemplar(model, there).unwrap_or([0, 0]);
        (sheet.library, place.map(|v| f64::from(v) + 0.5))
    }

    /// A layer map of the canvas, of the layers of the only library's exemplar.
    ///
    /// # Errors
    /// As [`LayerExemplar::along`].
    pub(crate) fn layer_map(
        &self,
        model: &PlacementModel,
        exemplar: &LayerMap,
        canvas: [u32; 2],
    ) -> Result<LayerMap> {
        let width = exemplar.size()[0];
        let pixel = |page: usize, at: [i64; 2]| {
            let sheet = &self.pages.sheets[page];
            let [x, y] = sheet.exemplar(model, [at[0] as i32, at[1] as i32])?;
            Some(y as usize * width + x as usize)
        };
        let carrier = Carrier {
            field: &self.field,
            cell: self.pages.cell as usize,
            pitch: [f64::from(self.pages.cell); 2],
            margin: self.margin.map(|v| v as usize),
            canvas: canvas.map(|v| v as usize),
            pixel,
        };
        LayerExemplar { map: exemplar, photograph: None }.along(&carrier)
    }

    /// The guides' colours where the field points.
    fn picture(&self, plan: &Plan<'_>, model: &PlacementModel) -> RgbImage {
        RgbImage::from_fn(plan.params.width, plan.params.height, |x, y| {
            let (page, at) = self.source([x as i32, y as i32]);
            let sheet = &self.pages.sheets[page];
            let guide = plan.libraries[sheet.library].guide.as_ref();
            let colour = guide
                .zip(sheet.exemplar(model, at))
                .map(|(g, [ex, ey])| *g.picture.0.get_pixel(ex as u32 / g.cell, ey as u32 / g.cell));
            colour.unwrap_or(Rgb([0; 3]))
        })
    }

    /// The islands, each in a colour of its own.
    fn islands_picture(&self, params: &SynthParams) -> RgbImage {
        let islands = Islands::new(&self.field);
        let cell = self.pages.cell;
        RgbImage::from_fn(params.width, params.height, |x, y| {
            let [cx, cy] = [0, 1].map(|k| ([x, y][k] as i32 / cell + self.margin[k]) as usize);
            Rgb(label_colour(islands.of[cy * self.field.size[0] + cx] + 1))
        })
    }
}

/// Turns and mirrors each whole element of libraries with a lattice at its own place. Pages that are varied
/// as a whole would have other rows.
fn vary(
    elements: &mut [(VariantId, [i32; 2])],
    lattices: &[Option<(Lattice, Phases)>],
    model: &PlacementModel,
    seed: u64,
) {
    for (i, (variant, _)) in elements.iter_mut().enumerate() {
        let element = model.element(*variant);
        if lattices[element.library].is_some() && element.content == Content::Known {
            let mut random = stream(seed, "correspondence/variations", i as u64);
            *variant = model.draw_variant(model.element_of(*variant), &mut random);
        }
    }
}

/// The lattice of each library, and how its phases run over the canvas.
///
/// # Errors
/// [`Error::Periods`] if a canvas that repeats has no room for whole periods.
fn lattices(plan: &Plan<'_>) -> Result<Vec<Option<(Lattice, Phases)>>> {
    let params = &plan.params;
    let of = |library: &Library| {
        let Some(lattice) = params.lattice.of(library.lattice.as_ref())? else { return Ok(None) };
        let tile = [params.tile.x, params.tile.y];
        let phases = lattice.phases_of_tile([params.width, params.height], tile)?;
        Ok(Some((lattice, phases)))
    };
    plan.libraries.iter().map(of).collect()
}

/// The field that repeats a small tile, on a canvas of `size` cells with `margin` cells beside it. `None` if the only
/// exemplar is no such tile, if another lattice is asked for, or if a canvas that repeats has no whole number of tiles.
fn repeated(
    plan: &Plan<'_>,
    cell: i32,
    (size, margin): ([usize; 2], [i32; 2]),
) -> Option<CorrespondenceField> {
    let ([library], params) = (&*plan.libraries, &plan.params) else { return None };
    let exemplar = [library.arrangement.width, library.arrangement.height];
    let (canvas, wrap) = ([params.width, params.height], [params.tile.x, params.tile.y]);
    let fits = |k: usize| {
        exemplar[k] % cell as u32 == 0
            && (!wrap[k] || (canvas[k] * library.source.copies[k]).is_multiple_of(exemplar[k]))
    };
    if library.source.copies == [1; 2] || params.lattice != LatticeChoice::Auto || !fits(0) || !fits(1) {
        return None;
    }
    let source = |v: usize, k: usize| (v as i32 - margin[k]).rem_euclid(exemplar[k] as i32 / cell) as u16;
    let row = |y: usize| (0..size[0]).map(move |x| CellSource { page: 0, at: [source(x, 0), source(y, 1)] });
    Some(CorrespondenceField { size, wrap, sources: (0..size[1]).flat_map(row).collect() })
}

/// A library without a guide cannot be followed.
pub(crate) fn no_guide() -> Error {
    Error::Parameter {
        name: "method",
        value: "correspondence".into(),
        allowed:
            "for libraries with a guide, which those of older versions lack (analyse the photograph again)"
                .into(),
    }
}

/// Whether a mask is allowed at a place: its zone must be filled along the correspondence field, and the edge
/// of the domain must permit it.
fn stands(grid: &Grid, region: &PlacementRegion<'_>, mask: &Mask, at: [i32; 2], middle: [i32; 2]) -> bool {
    if region.is_plain() {
        return true;
    }
    let served = |zone| region.is_carried(zone);
    let canvas =
        || mask.spans().iter().flat_map(|&s| grid.runs(s, at)).flat_map(|CellRun { canvas, .. }| canvas);
    let inside = grid.canvas_cell(middle).and_then(|i| region.zone(i));
    match region.edge {
        Edge::Clip => inside.or_else(|| canvas().find_map(|i| region.zone(i))).is_some_and(served),
        Edge::Keep => inside.is_some_and(served),
        Edge::Avoid => {
            inside.is_some_and(served)
                && canvas().filter(|&i| region.zone(i).is_some()).count() as u32 == mask.area()
        }
    }
}
