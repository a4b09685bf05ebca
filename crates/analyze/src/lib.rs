//! Image → library: primaries, details, secondaries, categories, descriptors, palette.
//!
//! Works badly for exemplars with few elements, with depth or with strong shadows. Descriptors do not
//! capture structure larger than a few elements; the guide does.

mod background;
mod borders;
mod candidates;
mod categories;
mod contrast;
mod doubts;
mod edges;
mod exemplar;
mod grid;
mod ground;
mod joining;
mod kinds;
mod light;
mod margin;
mod memory;
mod moments;
mod neighbours;
mod painted;
mod palette;
mod partition;
mod patches;
mod pictures;
mod pursuit;
mod rate_distortion;
mod reduced;
mod rims;
mod secondaries;
mod shading;
mod shapes;
mod simplify;
mod small_tiles;
mod strata;
mod unmix;

pub use borders::borders_join;
pub use exemplar::Exemplar;
pub use memory::AnalysisMemory;
pub use vtex_base::raster::Limits;
pub use vtex_scene::library::AnalyzeParams;

use grid::Cells;
use image::RgbImage;
use light::Light;
use memory::{ElementsMemory, LatticeMemory};
use partition::{Elements, Partition};
use rate_distortion::RateDistortion;
use shading::KnownParts;
use shapes::ExemplarPieces;
use strata::{LayersMemory, PhotographStrata};
use vtex_base::document::Document as _;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::{Progress, SideBySide, advance};
use vtex_base::raster::blur::gaussian;
use vtex_base::raster::picture::outlines;
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::lattice;
use vtex_scene::library::{
    Arrangement, Category, CategoryId, EvenLight, ExemplarElement, Guide, Library, Source, SourceKind,
};
use vtex_scene::scene::Tile;
use vtex_segment::segment::{GivenCategory, Segmenter, details};

/// Analyses an exemplar: finds its elements with `segmenter`, and derives their shapes, colours, categories
/// and arrangement and the background's palette. The same arguments give the same library on any number of
/// threads.
///
/// A photograph of more than `max_pixels` is reduced first. Its library has the units of the photograph all the
/// same, and says by how much it was reduced ([`Source::scale`]). Where light falls off slowly over it, the light is
/// taken out ([`Source::light`]). The contrast of a subtle picture is stretched, and the library has the picture's
/// own colours ([`Source::contrast`]). A small tile that was repeated is enlarged. It wraps,
/// and its lattice is its size ([`Source::copies`]).
///
/// An exemplar without primaries is no error. Its library holds the background, secondaries and a
/// warning.
///
/// # Errors
/// [`vtex_base::Error::Parameter`] for a parameter out of range, [`vtex_base::Error::Interrupted`], and the
/// errors of the segmenter.
///
/// # Example
/// ```
/// # mod vtex { pub use {vtex_base::Error, vtex_segment::segment}; pub mod analyze { pub use vtex_analyze::*; } }
/// use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
/// use vtex::segment::Felzenszwalb;
/// # use image::{Rgb, RgbImage};
/// # let dark = |x: u32, y: u32| (x % 16 < 8) && (y % 16 < 8);
/// # let picture = RgbImage::from_fn(64, 64, |x, y| Rgb(if dark(x, y) { [60, 40, 30] } else { [200; 3] }));
/// # let mut png = std::io::Cursor::new(Vec::new());
/// # picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
/// # let png = png.into_inner();
///
/// let exemplar = Exemplar::from_bytes(&png, "photo.png", &Limits::default())?;
/// let library = analyze(&exemplar, &Felzenszwalb::default(), &AnalyzeParams::default(), &())?;
/// assert_eq!(library.primaries().len(), 16);
/// # Ok::<(), vtex::Error>(())
/// ```
pub fn analyze(
    exemplar: &Exemplar,
    segmenter: &dyn Segmenter,
    params: &AnalyzeParams,
    progress: &dyn Progress,
) -> Result<Library> {
    analyzed(exemplar, segmenter, params, None, progress)
}

/// [`analyze`] with a memory of the last analysis, from which results are taken over where all that they are made from
/// is the same. The library is that of [`analyze`]. It is soon made if only a few masks have changed. After an
/// analysis that was stopped, the memory can be used as before.
///
/// # Errors
/// Those of [`analyze`].
pub fn analyze_again(
    exemplar: &Exemplar,
    segmenter: &dyn Segmenter,
    params: &AnalyzeParams,
    memory: &mut AnalysisMemory,
    progress: &dyn Progress,
) -> Result<Library> {
    analyzed(exemplar, segmenter, params, Some(memory), progress)
}

fn analyzed(
    exemplar: &Exemplar,
    segmenter: &dyn Segmenter,
    params: &AnalyzeParams,
    memory: Option<&mut AnalysisMemory>,
    progress: &dyn Progress,
) -> Result<Library> {
    params.validate()?;
    let (width, height) = exemplar.image.dimensions();
    let repeated = exemplar.copies != [1; 2];
    let params = &AnalyzeParams { wrap: params.wrap || repeated, ..params.clone() };
    let mut reduced = reduced::reduced(exemplar, segmenter, params, progress)?;
    // What wraps does not become darker towards a border, and its seam would show what is taken out.
    let wraps = params.wrap && params.even_light == EvenLight::Auto;
    let light = if repeated || wraps { None } else { Light::of(&reduced.image, params.even_light) };
    if let Some(light) = &light {
        reduced.to_mut().image = light.taken_out(&reduced.image);
    }
    let stretch = contrast::stretch(&reduced.image, repeated, params);
    if let Some(stretch) = &stretch {
        reduced.to_mut().image = contrast::stretched(&reduced.image, stretch);
    }
    if repeated && reduced.image.dimensions() == (width, height) {
        let exemplar = reduced.to_mut();
        exemplar.image = small_tiles::enlarged(&exemplar.image, exemplar.copies);
        let (width, height) = exemplar.image.dimensions();
        exemplar.layers.iter_mut().for_each(|map| map.labels = map.labels.resized(width, height));
    }
    let mut library = analyze_whole(&reduced, [width, height], (segmenter, params), memory, progress)?;
    if let Some(stretch) = stretch {
        library = contrast::undone(library, &stretch);
    }
    library.source.light = light.map(|light| light.ratio);
    if reduced.image.dimensions() == (width, height) {
        return Ok(library);
    }
    let [w, h] = [library.source.width, library.source.height].map(f64::from);
    let scale = [w / f64::from(width), h / f64::from(height)];
    let mut library = library.scaled(scale.map(|v| 1.0 / v));
    (library.source.width, library.source.height, library.source.scale) = (width, height, scale);
    debug_assert_eq!(library.validate(), Ok(()));
    Ok(library)
}

/// Analyses all pixels of an exemplar, a reduced photograph whose own size is `whole`.
fn analyze_whole(
    exemplar: &Exemplar,
    whole: [u32; 2],
    (segmenter, params): (&dyn Segmenter, &AnalyzeParams),
    mut memory: Option<&mut AnalysisMemory>,
    progress: &dyn Progress,
) -> Result<Library> {
    let mut masks = segmenter.segment_reduced(&exemplar.image, whole, progress)?;
    if exemplar.copies != [1; 2] {
        masks = small_tiles::of_all_copies(masks, exemplar.image.dimensions().into(), exemplar.copies);
    }
    progress.picture("masks", &|| pictures::masks(&exemplar.image, &masks));
    advance(progress, "primaries", 0, 1)?;
    let partition = Partition::new(exemplar, &masks, params, memory.as_mut().map(|m| &mut m.enlarged));
    progress.picture("primaries", &|| outlines(&partition.image, &partition.labels));
    advance(progress, "details", 0, partition.primaries.len() as u64)?;
    let (known, layers) = match &mut memory {
        Some(memory) => {
            (memory.elements.of(&partition, reach_of_details(&partition)), Some(&mut memory.layers))
        }
        None => (vec![None; partition.primaries.len()], None),
    };
    let (strata, parts) = parts(&partition, &known, layers, progress)?;
    advance(progress, ground::STAGE, 0, 1)?;
    let mut warnings = exemplar.warnings.clone();
    let remembers = memory.as_mut().map(|memory| &mut memory.elements);
    let pieces = pieces(&partition, &strata, (parts, &known, remembers), &mut warnings, progress)?;
    advance(progress, "outlines", 0, 1)?;
    let shapes = shapes::outlines(&partition, &pieces);
    advance(progress, "categories", 0, 1)?;
    let elements = partition.elements(shapes);
    warnings.iter().for_each(|warning| progress.warn(warning));
    if let Some(warning) = doubts::about_placing(&elements.primaries) {
        progress.warn_of_placing(&warning);
        warnings.push(warning);
    }
    if let Some(warning) = doubts::about_masks(&masks, &elements.primaries) {
        progress.warn(&warning);
        warnings.push(warning);
    }
    let source = Source { warnings, ..source(exemplar, segmenter, params) };
    let lattice = memory.map(|memory| &mut memory.lattice);
    let given = segmenter.categories(exemplar.image.dimensions().into());
    let library = library(exemplar, elements, (strata, lattice), (source, &given), progress);
    debug_assert_eq!(library.validate(), Ok(()));
    Ok(library)
}

/// The parts of elements.
struct ElementPieces {
    /// The details of each primary.
    details: Vec<Vec<Cells<Mask>>>,
    secondaries: Vec<Cells<Mask>>,
}

/// Second stage: the details of primaries, joined secondaries, and the layers with their backgrounds.
/// `known` has the parts of elements that are known from before.
fn parts(
    partition: &Partition<'_>,
    known: &KnownParts,
    layers: Option<&mut LayersMemory>,
    progress: &dyn Progress,
) -> Result<(PhotographStrata, ElementPieces)> {
    let Partition { exemplar, params, in_cells, clean, .. } = partition;
    let primaries = partition.margin.inner(&partition.labels);
    let textons = partition.textons();
    let secondaries = || {
        let cost = RateDistortion::new(params, partition.grid);
        joining::join_secondaries(clean, &partition.patches, cost, in_cells.secondary_maximum)
    };
    let tasks = SideBySide::new(progress, "details");
    let strata = || PhotographStrata::new(exemplar, [&primaries, &textons], params, layers, &tasks.silent());
    let details = || all_details(clean, &partition.primaries, known, in_cells);
    let (strata, (details, secondaries)) = parallel::join(strata, || parallel::join(details, secondaries));
    let strata = strata?;
    progress.picture("background", &|| pictures::background(&exemplar.image, &textons, &strata.fields));
    Ok((strata, ElementPieces { details, secondaries }))
}

/// Third stage: the pieces that are worth their bytes.
fn pieces(
    partition: &Partition<'_>,
    strata: &PhotographStrata,
    (parts, known, remembers): (ElementPieces, &KnownParts, Option<&mut ElementsMemory>),
    warnings: &mut Vec<String>,
    progress: &dyn Progress,
) -> Result<ExemplarPieces> {
    let wrap = partition.params.wrap;
    let behind = strata.behind(&partition.margin, Tile { x: wrap, y: wrap });
    let patches = patches::flat_patches(&partition.clean, parts.secondaries, partition.grid, &behind);
    let details = (&parts.details[..], known, remembers);
    simplify::simplify(partition, details, patches, &behind, warnings, progress)
}

/// Last stage: elements by category in their layers.
fn library(
    exemplar: &Exemplar,
    elements: Elements,
    (strata, lattice): (PhotographStrata, Option<&mut LatticeMemory>),
    (source, given): (Source, &[GivenCategory]),
    progress: &dyn Progress,
) -> Library {
    let Elements { mut primaries, secondaries, labels } = elements;
    let (width, height) = exemplar.image.dimensions();
    let params = source.parameters.clone();
    let (ids, categories) = categorise(&mut primaries, (&labels, given), &params);
    progress.picture("categories", &|| pictures::categories(&labels, &ids));
    let centroids: Vec<[f64; 2]> = primaries.iter().map(|p| p.centroid).collect();
    let descriptor_half = descriptor_half(&centroids, width, height, params.descriptor_reach);
    progress.picture("descriptors", &|| pictures::descriptors(&labels, &ids, &centroids, descriptor_half));
    let spacing = secondaries::spacing(&centres(&secondaries), &labels);
    let elements: Vec<ExemplarElement> = primaries.into_iter().chain(secondaries).collect();
    let layers = strata.layers(&labels, &elements, spacing);
    let guide = Guide::of(&exemplar.image);
    Library {
        format: Library::FORMAT.into(),
        version: Library::VERSION,
        source: Source { strata_reason: strata.why, ..source },
        // An empty sum of floats is -0; folding from 0 avoids it.
        coverage: categories.iter().fold(0.0, |sum, c| sum + c.coverage).min(1.0),
        layers,
        elements,
        categories,
        arrangement: Arrangement { periodic: params.wrap, ..Arrangement::from_labels(&labels) },
        descriptor_half,
        lattice: match (exemplar.copies, lattice) {
            ([1, 1], Some(known)) => known.of(&exemplar.image),
            ([1, 1], None) => lattice::find(&exemplar.image),
            (copies, _) => small_tiles::lattice([width, height], copies),
        },
        motifs: Vec::new(),
        guide: Some(guide),
    }
}

/// Divides primaries into categories, those that a user has given if there are any: the category of each, and all of
/// them.
fn categorise(
    primaries: &mut [ExemplarElement],
    (labels, given): (&LabelMap, &[GivenCategory]),
    params: &AnalyzeParams,
) -> (Vec<CategoryId>, Vec<Category>) {
    let features = |p: &ExemplarElement| {
        let [r, g, b] = p.colour.to_f64();
        [r, g, b, f64::from(p.area), p.compactness.unwrap_or(0.0)]
    };
    let features: Vec<kinds::Features> = primaries.iter().map(features).collect();
    let image_area = f64::from(labels.width) * f64::from(labels.height);
    let names: Vec<&str> = given.iter().map(|category| &category.name[..]).collect();
    let masks = if given.is_empty() { Vec::new() } else { Mask::all_of_labels(labels, primaries.len() + 1) };
    let of: Vec<Option<usize>> = masks.iter().skip(1).map(|mask| GivenCategory::of(mask, given)).collect();
    let (ids, categories) = categories::take((&names, &of), &features, image_area)
        .unwrap_or_else(|| categories::divide(&features, params.categories, image_area));
    primaries.iter_mut().zip(&ids).for_each(|(p, &id)| p.category = Some(id));
    (ids, categories)
}

/// The origin of a library.
fn source(exemplar: &Exemplar, segmenter: &dyn Segmenter, params: &AnalyzeParams) -> Source {
    let (width, height) = exemplar.image.dimensions();
    Source {
        kind: SourceKind::Photograph,
        file: exemplar.file.clone(),
        width,
        height,
        scale: [1.0; 2],
        copies: exemplar.copies,
        stacking: [0; 2],
        contrast: 1.0,
        light: None,
        sha256: exemplar.sha256.clone(),
        segmenter: segmenter.name(),
        parameters: params.clone(),
        program: vtex_base::PROGRAM.into(),
        strata_reason: None,
        warnings: Vec::new(),
    }
}

/// How far beyond the bounds of a primary colours count for its details, in cells.
fn reach_of_details(partition: &Partition<'_>) -> usize {
    gaussian(partition.in_cells.detail_sigma).len()
}

/// The details of each primary, those that are known among them.
fn all_details(
    image: &Cells<RgbImage>,
    primaries: &[Cells<Mask>],
    known: &KnownParts,
    params: &Cells<AnalyzeParams>,
) -> Vec<Vec<Cells<Mask>>> {
    let half = gaussian(params.detail_sigma);
    let all: Vec<_> = primaries.iter().zip(known).collect();
    parallel::map(&all, |(mask, known)| {
        if let Some(known) = known {
            return known.details.clone();
        }
        let details = details(image, &half, mask, params.detail_scale, params.detail_minimum);
        details.into_iter().map(Cells).collect()
    })
}

fn centres(secondaries: &[ExemplarElement]) -> Vec<[f64; 2]> {
    secondaries.iter().map(|s| s.centroid).collect()
}

/// Half the side of the descriptors' window, in pixels: `reach` times the mean distance between
/// neighbours, at most half the exemplar's shorter side.
fn descriptor_half(centroids: &[[f64; 2]], width: u32, height: u32, reach: f64) -> u32 {
    let lengths = neighbours::edge_lengths(centroids, |_, _| false);
    let most = width.min(height) / 2;
    if lengths.is_empty() {
        return most;
    }
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    (libm::round(reach * mean) as u32).clamp(1, most.max(1))
}
