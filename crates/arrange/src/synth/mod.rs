//! Library → scene, in this order: correspondence field, arrangement and density
//! ([`arrange`](crate::arrange)), background, secondaries, composition.
//!
//! Works badly for exemplars with long curves, which islands cut, and for exemplars with too few whole
//! elements, whose copies are seen.

mod backdrop;
pub(crate) mod background;
mod canvas;
mod canvas_parts;
#[cfg(feature = "curves")]
mod cell_drawing;
#[cfg(feature = "curves")]
mod cells;
#[cfg(feature = "clustered")]
mod clustered;
pub(crate) mod compose;
mod cost;
mod covered;
#[cfg(feature = "curves")]
mod curves;
mod drawn;
#[cfg(feature = "curves")]
mod line_density;
#[cfg(feature = "curves")]
mod line_drawing;
#[cfg(test)]
mod motif_tests;
mod neighbourhoods;
#[cfg(feature = "curves")]
mod page_raster;
mod period;
#[cfg(feature = "clustered")]
mod recognised;
pub(crate) mod report;
#[cfg(any(feature = "clustered", feature = "curves"))]
mod samples_picture;
pub(crate) mod secondaries;
#[cfg(any(feature = "clustered", feature = "curves"))]
mod single_drawing;
mod strata;
mod taken_apart;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod units;

pub use crate::arrange::context::DrawnContext;
pub use crate::arrange::controls::{Controls, StructureGuide};
pub use crate::arrange::correspondence::Structure;
pub use crate::arrange::turned::Turned;
pub use canvas::CanvasSize;
pub use cost::Cost;
pub use report::{CategoryReport, ClusterReport, CurveReport, SynthReport};
pub use strata::{StratumReport, layer_map};
pub use units::{SynthesisMemory, synthesize_again, synthesize_with};
pub use vtex_scene::reconstruct::reconstruct;

use crate::arrange::correspondence::no_guide;
use crate::arrange::model::PlacementModel;
use crate::arrange::motifs::MotifUnits;
use crate::arrange::{PlacementResult, PlacementTask, arrange};
use compose::{Placement, What, compose};
use secondaries::PlacedSecondary;
use strata::CanvasStrata;
use vtex_base::error::{Error, Large, Result};
use vtex_base::progress::{Progress, advance};
use vtex_field::correspondence::PagesMemory;
#[cfg(feature = "curves")]
use vtex_scene::library::PictureKind;
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Ablation, InstanceId, Layer, LibraryId, Method, Role, Scene, SynthParams, Weights};

/// Largest canvas, in pixels.
const LARGEST_CANVAS: u64 = 400_000_000;
/// Memory per pixel of the canvas, in bytes: seven of the target map, and the share of placed elements
/// (measured on sandy concrete, which has the most).
const BYTES_PER_PIXEL: u64 = 25;

/// Synthesises a texture of the size in `params` like the exemplar of the library. The same library,
/// parameters and program give the same scene on any number of threads.
///
/// # Errors
/// [`Error::Parameter`] for a parameter out of range, [`Error::TooLarge`] for a canvas of more than
/// 400 megapixels, [`Error::Interrupted`].
pub fn synthesize(library: &Library, params: &SynthParams, progress: &dyn Progress) -> Result<Scene> {
    let libraries = std::slice::from_ref(library);
    synthesize_with(libraries, params, &Controls::default(), progress).map(|(scene, _)| scene)
}

/// [`synthesize_with`] of libraries whose units are the pixels of their arrangements.
fn in_pixels(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    params.validate()?;
    controls.validate(libraries)?;
    check_canvas(params)?;

    if canvas_parts::applies(libraries, controls) {
        return canvas_parts::synthesize(libraries, params, controls, progress);
    }
    let method = method(libraries, params, controls)?;
    let asked = params.method;
    let params = &SynthParams { method, ..params.clone() };
    by_method(libraries, params, controls, memory, progress).map_err(|error| chosen(asked, error))
}

/// The error of a method. Where nobody has named it, the error says so.
fn chosen(asked: Method, error: Error) -> Error {
    match error {
        Error::Parameter { name: name @ "method", value, allowed } if asked == Method::Auto => {
            Error::Parameter { name, value: format!("auto (it chose {value})"), allowed }
        }
        error => error,
    }
}

/// A texture by the method of the parameters, which is not [`Method::Auto`].
fn by_method(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let method = params.method;
    if method == Method::Period {
        return period::synthesize(&libraries[0], params, controls, progress);
    }
    if method == Method::Clustered {
        return clustered(&libraries[0], params, controls, progress);
    }
    if method == Method::Curves {
        return curves(&libraries[0], params, controls, progress);
    }
    if method == Method::Descriptor
        && let [library] = libraries
        && let Some(units) = MotifUnits::new(library)
    {
        let params = &keeping_apart(libraries, params);
        let (scene, report) = arranged(&[units.closed()], params, controls, None, progress)?;
        return taken_apart::taken_apart(&units, library, (scene, report), progress);
    }
    arranged(libraries, &keeping_apart(libraries, params), controls, memory, progress)
}

/// A texture of elements placed one by one, by correspondences or descriptors.
fn arranged(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let method = params.method;
    let mut model = PlacementModel::new(libraries, params);
    let task = PlacementTask { libraries, controls, params, method, memory, fixed: Vec::new() };
    let arrangement = arrange(&mut model, &task, progress)?;

    advance(progress, "background field", 0, 2)?;
    let correspondence = arrangement.correspondence.as_ref();
    let field = background::field(libraries, &arrangement.cells, correspondence, params);
    let interpolant = Interpolant::new(&field, params.width, params.height, params.tile);
    advance(progress, "background field", 1, 2)?;
    let secondaries = secondaries::place(libraries, &arrangement.cells, &interpolant, correspondence, params);
    advance(progress, "background field", 2, 2)?;

    let strata = CanvasStrata::new(libraries, controls, &arrangement, &field, params)?;
    let layers = match &strata {
        Some(strata) => strata.layers(),
        None => Scene::three_layers(field),
    };
    let placements = placements(libraries, &arrangement, &secondaries, strata.as_ref());
    let blank = compose::blank(libraries, params, controls, layers);
    let mut scene = compose(blank, InstanceId(0), libraries, placements);
    let strata = strata.map_or_else(Vec::new, |strata| {
        scene.layers = CanvasStrata::drop_empty(std::mem::take(&mut scene.layers));
        strata.report
    });
    let report = SynthReport { strata, ..SynthReport::of_arrangement(libraries, &arrangement, &scene) };
    Ok((scene, report))
}

/// A drawing arranged by clustered samples.
#[cfg(feature = "clustered")]
use clustered::synthesize as clustered;

/// The context without what its drawing has in the region, for a method.
#[cfg(feature = "clustered")]
fn cleared(library: &Library, context: &DrawnContext, canvas: [u32; 2], method: Method) -> DrawnContext {
    match method {
        Method::Clustered => clustered::cleared(library, context, canvas),
        _ => context.without_lines(canvas),
    }
}

#[cfg(not(feature = "clustered"))]
fn cleared(_: &Library, context: &DrawnContext, canvas: [u32; 2], _: Method) -> DrawnContext {
    context.without_lines(canvas)
}

/// Stands for [`clustered`] where it is left out: [`method`] refuses the method.
#[cfg(not(feature = "clustered"))]
fn clustered(_: &Library, _: &SynthParams, _: &Controls, _: &dyn Progress) -> Result<(Scene, SynthReport)> {
    Err(not_built("clustered"))
}

/// A drawing of lines, made anew as curves.
#[cfg(feature = "curves")]
use curves::synthesize as curves;

/// Stands for [`curves`] where it is left out: [`method`] refuses the method.
#[cfg(not(feature = "curves"))]
fn curves(_: &Library, _: &SynthParams, _: &Controls, _: &dyn Progress) -> Result<(Scene, SynthReport)> {
    Err(not_built("curves"))
}

/// The method stands behind a feature of its name.
#[cfg(not(all(feature = "clustered", feature = "curves")))]
fn not_built(method: &str) -> Error {
    let allowed = format!("where vtex was built with the feature `{method}`").into();
    Error::Parameter { name: "method", value: method.into(), allowed }
}

/// Secondaries, then primaries, each in the layer of its stratum.
fn placements<'a>(
    libraries: &'a [Library],
    arrangement: &'a PlacementResult<'_>,
    secondaries: &'a [PlacedSecondary],
    strata: Option<&'a CanvasStrata>,
) -> impl Iterator<Item = Placement<'a>> {
    let below = secondaries.iter().map(move |p| Placement {
        what: What::Known(
            LibraryId(p.library as u32),
            libraries[p.library].secondary_id(p.secondary),
            Some(p.colour),
        ),
        transform: compose::at(&arrangement.cells.model().variations[usize::from(p.variation)], p.at),
        layer: CanvasStrata::layer(strata.map_or(0, |strata| strata.of_secondary(p)), Role::Secondary),
        motif: None,
    });
    let above = arrangement.placed.iter().map(move |p| {
        let (what, transform) = compose::primary(arrangement, p);
        let of = |strata: &CanvasStrata| strata.of_primary(&libraries[0], arrangement, p.element, p.at);
        let layer = CanvasStrata::layer(strata.map_or(0, of), Role::Primary);
        Placement { what, transform, layer, motif: None }
    });
    below.chain(above)
}

/// The parameters, with overlaps refused if all exemplars are drawings without touching elements.
fn keeping_apart(libraries: &[Library], params: &SynthParams) -> SynthParams {
    let mut params = params.clone();
    let apart = |l: &Library| is_drawing(l) && !l.arrangement.to_labels().any_touch();
    if libraries.iter().all(apart) && !params.without(Ablation::Overlap) {
        params.ablate.push(Ablation::Overlap);
    }
    params
}

fn is_drawing(library: &Library) -> bool {
    library.source.kind == SourceKind::Drawing
}

/// Whether a library was made of a picture of lines.
#[cfg(feature = "curves")]
fn is_line_art(library: &Library) -> bool {
    library.source.parameters.kind == PictureKind::Curves
}

/// The method that places primaries; chosen by the libraries for [`Method::Auto`].
///
/// # Errors
/// [`Error::Parameter`] if correspondences are asked for and a library has no guide.
fn method(libraries: &[Library], params: &SynthParams, controls: &Controls) -> Result<Method> {
    let periodic = period::applies(libraries, params, controls);
    let guided = libraries.iter().all(|l| l.guide.is_some());
    // Ablations that correspondences support.
    let of_both = |part: &Ablation| *part == Ablation::Secondary;
    let plain = params.weights == Weights::default() && params.ablate.iter().all(of_both);
    let led = controls.structure.is_some();
    match params.method {
        // Lines go on from what is drawn, other elements fit to it.
        Method::Auto if controls.context.is_some() => {
            let with = |method| SynthParams { method, ..params.clone() };
            let made = |name| method(libraries, &with(name), controls);
            #[cfg(feature = "curves")]
            if libraries.iter().any(curves::runs_on) {
                return made(Method::Curves).or_else(|_| made(Method::Clustered));
            }
            made(Method::Clustered).or_else(|_| made(Method::Curves))
        }
        other if controls.context.is_some() && !matches!(other, Method::Curves | Method::Clustered) => {
            Err(Error::Parameter {
                name: "method",
                value: format!("{other:?}").to_lowercase(),
                allowed: "without a drawing that stays; beside one, auto, curves and clustered do".into(),
            })
        }
        // Nothing else makes more of lines on paper.
        #[cfg(feature = "curves")]
        Method::Auto
            if libraries.iter().all(is_line_art) && curves::check(libraries, params, controls).is_ok() =>
        {
            Ok(Method::Curves)
        }
        Method::Auto if led && guided && plain => Ok(Method::Correspondence),
        Method::Correspondence if guided => Ok(Method::Correspondence),
        method if led => Err(Error::Parameter {
            name: "method",
            value: format!("{method:?}").to_lowercase(),
            allowed: "without a map of layers or a guide to follow; correspondence follows them, with a library that \
                      has a guide, and without weights or ablation"
                .into(),
        }),
        #[cfg(feature = "clustered")]
        Method::Clustered => clustered::check(libraries, params, controls).map(|()| Method::Clustered),
        #[cfg(not(feature = "clustered"))]
        Method::Clustered => Err(not_built("clustered")),
        #[cfg(feature = "curves")]
        Method::Curves => curves::check(libraries, params, controls).map(|()| Method::Curves),
        #[cfg(not(feature = "curves"))]
        Method::Curves => Err(not_built("curves")),
        // The period of irregular cells would be seen.
        #[cfg(feature = "curves")]
        Method::Auto if plain && curves::rearranges_cells(libraries, params, controls) => Ok(Method::Curves),
        Method::Auto if periodic && plain => Ok(Method::Period),
        Method::Period if !periodic => Err(Error::Parameter {
            name: "method",
            value: "period".into(),
            allowed:
                "for one drawing whose borders join, without a map of densities, turned or mirrored elements"
                    .into(),
        }),
        // Distances and neighbours are those of the drawing.
        #[cfg(feature = "clustered")]
        Method::Auto if plain && clustered::suits(libraries, params, controls) => Ok(Method::Clustered),
        // Islands would cut a drawing and lose elements along every border.
        Method::Auto if libraries.iter().all(is_drawing) => Ok(Method::Descriptor),
        Method::Auto if guided && plain => Ok(Method::Correspondence),
        Method::Auto => Ok(Method::Descriptor),
        Method::Correspondence if !guided => Err(no_guide()),
        method => Ok(method),
    }
}

/// The primaries of a scene alone, and the share of the canvas that each category covered before the
/// density was corrected.
pub(crate) fn primaries_alone(
    libraries: &[Library],
    params: &SynthParams,
    progress: &dyn Progress,
) -> Result<(Scene, Vec<f64>)> {
    let controls = Controls::default();
    let mut model = PlacementModel::new(libraries, params);
    let method = Method::Descriptor;
    let task =
        PlacementTask { libraries, controls: &controls, params, method, memory: None, fixed: Vec::new() };
    let arrangement = arrange(&mut model, &task, progress)?;
    let canvas = f64::from(params.width) * f64::from(params.height);
    let covered = arrangement.covered_before.iter().map(|&cells| cells as f64 / canvas).collect();
    let layers = vec![Layer::new(Role::Primary)];
    let placements = arrangement.placed.iter().map(|p| {
        let (what, transform) = compose::primary(&arrangement, p);
        Placement { what, transform, layer: 0, motif: None }
    });
    let blank = compose::blank(libraries, params, &controls, layers);
    Ok((compose(blank, InstanceId(0), libraries, placements), covered))
}

/// An error if the canvas is too large.
pub(crate) fn check_canvas(params: &SynthParams) -> Result<()> {
    let canvas = u64::from(params.width) * u64::from(params.height);
    if canvas <= LARGEST_CANVAS {
        return Ok(());
    }
    Err(Error::TooLarge {
        what: Large::Canvas,
        name: "size".into(),
        found: format!(
            "{} x {} px, about {} GB of memory",
            params.width,
            params.height,
            canvas * BYTES_PER_PIXEL / 1_000_000_000
        ),
        limit: format!("{} megapixels", LARGEST_CANVAS / 1_000_000),
    })
}
