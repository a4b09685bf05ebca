//! Library → scene. What is made of what, and by which method, is decided once (`texture`); the method arranges elements
//! (`methods`); a scene is composed of them (`compose`). It refers to the libraries in their order, then to that of a drawing
//! that stays.
//!
//! Works badly for exemplars with long curves, which islands cut, and for exemplars with too few whole
//! elements, whose copies are seen.

mod backdrop;
pub(crate) mod background;
pub(crate) mod canvas;
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
mod excluded;
mod in_place;
#[cfg(feature = "curves")]
mod line_density;
#[cfg(feature = "curves")]
mod line_drawing;
mod methods;
#[cfg(test)]
mod motif_tests;
mod neighbourhoods;
pub(crate) mod one_by_one;
#[cfg(feature = "curves")]
mod page_raster;
mod period;
#[cfg(feature = "clustered")]
mod recognised;
mod refusal;
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
mod texture;
mod thinned;
mod units;

pub use crate::arrange::context::DrawnContext;
pub use crate::arrange::controls::{Controls, StructureGuide};
pub use crate::arrange::correspondence::Structure;
pub use crate::arrange::turned::Turned;
pub use canvas::CanvasSize;
pub use cost::Cost;
pub use report::{CategoryReport, ClusterReport, CurveReport, SynthReport};
pub use strata::{StratumReport, layer_map};
pub use vtex_scene::reconstruct::reconstruct;

use excluded::excluding;
use std::borrow::Cow;
use texture::Texture;
use vtex_base::error::Result;
use vtex_base::progress::Progress;
use vtex_field::correspondence::PagesMemory;
use vtex_scene::library::Library;
use vtex_scene::scene::{Scene, SynthParams};

/// Synthesises a texture of the size in `params` like the exemplar of the library. The same library,
/// parameters and program give the same scene on any number of threads.
///
/// # Errors
/// [`vtex_base::Error::Parameter`] for a parameter out of range, [`vtex_base::Error::TooLarge`] for a canvas of more than
/// 400 megapixels, [`vtex_base::Error::Interrupted`].
pub fn synthesize(library: &Library, params: &SynthParams, progress: &dyn Progress) -> Result<Scene> {
    let libraries = std::slice::from_ref(library);
    synthesize_with(libraries, params, &Controls::default(), progress).map(|(scene, _)| scene)
}

/// [`synthesize`] from several libraries and with control maps. Also reports how close the
/// result is to its targets.
///
/// # Errors
/// As [`synthesize`]; also [`vtex_base::Error::Parameter`] for no library, more than [`Controls::MOST_LIBRARIES`], or a number of
/// share maps other than that of libraries.
pub fn synthesize_with(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    synthesized(libraries, params, controls, None, progress)
}

/// What a synthesis leaves for the next one from the same libraries; see [`synthesize_again`].
#[derive(Default)]
pub struct SynthesisMemory(PagesMemory);

/// [`synthesize_with`] with a memory of the last synthesis. The scene is that of [`synthesize_with`]. Correspondences
/// are sooner found if libraries and lattices are those of the last time: the similar cells of an exemplar, which take
/// most of the time of a small canvas, are then known.
///
/// # Errors
/// Those of [`synthesize_with`].
pub fn synthesize_again(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: &SynthesisMemory,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    synthesized(libraries, params, controls, Some(&memory.0), progress)
}

fn synthesized(
    libraries: &[Library],
    params: &SynthParams,
    controls: &Controls,
    memory: Option<&PagesMemory>,
    progress: &dyn Progress,
) -> Result<(Scene, SynthReport)> {
    let kept = excluding(libraries, &params.exclude, progress).map_or(Cow::Borrowed(libraries), Cow::Owned);
    Texture::new(kept, params.clone(), Cow::Borrowed(controls), memory, progress)?.scene(progress)
}
