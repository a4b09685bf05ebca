//! Image → library: primaries, details, secondaries, categories, descriptors, palette.
//!
//! Works badly for exemplars with few elements, with depth or with strong shadows. Descriptors do not
//! capture structure larger than a few elements; the guide does.

mod background;
mod borders;
mod candidates;
mod categories;
mod doubts;
mod edges;
mod exemplar;
mod grid;
mod joining;
mod kmeans;
mod margin;
mod moments;
mod neighbours;
mod palette;
mod pictures;
mod rate_distortion;
mod reduced;
mod secondaries;
mod shapes;
mod simplify;
mod strata;
mod unmix;

pub use borders::borders_join;
pub use exemplar::Exemplar;
pub use vtex_base::raster::Limits;
pub use vtex_scene::library::AnalyzeParams;

use grid::{Cells, Grid};
use image::RgbImage;
use margin::Margin;
use rate_distortion::RateDistortion;
use shapes::Style;
use simplify::Counts;
use std::borrow::Cow;
use strata::Strata;
use unmix::unmixed;
use vtex_base::document::Document as _;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::{Progress, SideBySide, advance};
use vtex_base::raster::{LabelMap, Mask};
use vtex_scene::library::{Arrangement, Category, CategoryId, Element, Guide, Library, Source, SourceKind};
use vtex_scene::scene::Tile;
use vtex_scene::scene::field::Interpolant;
use vtex_segment::segment::{Segmenter, details, gaussian};

/// Analyses an exemplar: finds its elements with `segmenter`, and derives their shapes, colours, categories
/// and arrangement and the background's palette. The same arguments give the same library on any number of
/// threads.
///
/// A photograph of more than `max_pixels` is reduced first. Its library has the units of the photograph all the
/// same, and says by how much it was reduced ([`Source::scale`]).
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
    params.validate()?;
    let (width, height) = exemplar.image.dimensions();
    let reduced = reduced::reduced(exemplar, segmenter, params, progress)?;
    let library = analyze_whole(&reduced, [width, height], segmenter, params, progress)?;
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
    segmenter: &dyn Segmenter,
    params: &AnalyzeParams,
    progress: &dyn Progress,
) -> Result<Library> {
    let image = &exemplar.image;
    let (width, height) = image.dimensions();
    let masks = segmenter.segment_reduced(image, whole, progress)?;
    progress.picture("masks", &|| pictures::masks(image, &masks));

    advance(progress, "primaries", 0, 1)?;
    let mut primaries = candidates::select(image, &masks, params.minimum_area);
    // Of a photograph that repeats, all until the outlines is done with a margin of what comes next.
    let margin = params.wrap.then(|| Margin::new(&primaries));
    let (image, cut) = match &margin {
        None => (Cow::Borrowed(image), Vec::new()),
        Some(margin) => {
            let (whole, cut) = margin.primaries(&primaries);
            primaries = whole;
            (Cow::Owned(margin.image(image)), cut)
        }
    };
    let image = &*image;
    let grid = Grid::new(&exemplar.image, params);
    let (fine, in_cells) = (grid.image(image), grid.params(params));
    let mut cells = grid.labels(image, &fine, &primaries);
    let mut clean = own_colours(&fine, &cells, grid, params);
    let patches = secondaries::find(&clean, &cells, &in_cells);
    promote(&mut primaries, &mut cells, &patches.promoted, grid);
    let count = cells.labels.iter().max().map_or(0, |m| *m as usize);
    let primary_masks = Mask::all_of_labels(&cells, count + 1).split_off(1);
    let primary_masks: Vec<Cells<Mask>> = primary_masks.into_iter().map(Cells).collect();
    progress.picture("primaries", &|| vtex_base::raster::picture::outlines(image, &primaries));

    advance(progress, "details", 0, count as u64)?;
    // From here on shapes take the colours of `clean`; only edges are located in the photograph.
    if !patches.promoted.is_empty() {
        clean = own_colours(&fine, &cells, grid, params);
    }
    drop(fine);
    let textons = grid.pixels(&any_texton(cells, &patches.secondaries));
    let textons = inside(margin.as_ref(), &textons);
    let primaries_inside = inside(margin.as_ref(), &primaries);
    let palette = || background::palette(&exemplar.image, &primaries_inside, &textons, params);
    let secondaries = || {
        let cost = RateDistortion::new(params, grid);
        joining::join_secondaries(&clean, &patches.secondaries, cost, in_cells.secondary_maximum)
    };
    let tasks = SideBySide::new(progress, "details");
    let strata = || Strata::new(exemplar, &primaries_inside, params, &tasks.silent());
    let ((details, strata), (background, secondaries)) = parallel::join(
        || parallel::join(|| all_details(&clean, &primary_masks, &in_cells), strata),
        || parallel::join(palette, secondaries),
    );
    let strata = strata?;
    progress.picture("background", &|| pictures::background(&exemplar.image, &textons, &background));
    let tile = Tile { x: params.wrap, y: params.wrap };
    let interpolant = Interpolant::new(&background, width, height, tile);
    let place = |at: [f64; 2]| margin.as_ref().map_or(at, |margin| margin.place(at));
    let behind = |at: [f64; 2]| {
        let [x, y] = place(at);
        interpolant.at(x, y)
    };
    let patches = shapes::patches(&clean, secondaries, grid, &behind);

    advance(progress, "joining", 0, 1)?;
    let mut warnings = exemplar.warnings.clone();
    let counts = |mask: &Cells<Mask>| margin.as_ref().is_none_or(|m| m.holds(grid.centroid(mask)));
    let counts = Counts { primaries: primary_masks.iter().map(counts).collect(), patch: &counts };
    let (pieces, cost) =
        simplify::simplify(&clean, &details, patches, (params, grid), &counts, &mut warnings);
    let (pieces, palette) = simplify::reduce_colours(&clean, pieces, params);

    advance(progress, "outlines", 0, 1)?;
    let style = Style { fidelity: params.fidelity, grid, cost, palette: &palette };
    let shapes = shapes::outlines(image, &clean, &pieces, &style);

    advance(progress, "categories", 0, 1)?;
    let (mut primary_textons, mut secondary_textons) = (shapes.primaries, shapes.secondaries);
    for (label, (p, mask)) in (1..).zip(primary_textons.iter_mut().zip(&primary_masks)) {
        p.clipped = touches_border(mask, clean.width(), clean.height()) || cut.contains(&label);
    }
    if let Some(margin) = &margin {
        let (kept, indices) = margin.kept(primary_textons);
        let mut new = vec![0; primary_masks.len() + 1];
        (1..).zip(&indices).for_each(|(label, &old)| new[old + 1] = label);
        primary_textons = kept;
        primaries = margin.kept_labels(&primaries, &new);
        (secondary_textons, _) = margin.kept(secondary_textons);
    }
    let (ids, categories) = categorise(&mut primary_textons, f64::from(width) * f64::from(height), params);
    progress.picture("categories", &|| pictures::categories(&primaries, &ids));

    let centroids: Vec<[f64; 2]> = primary_textons.iter().map(|p| p.centroid).collect();
    let descriptor_half = descriptor_half(&centroids, width, height, params.descriptor_reach);
    progress.picture("descriptors", &|| pictures::descriptors(&primaries, &ids, &centroids, descriptor_half));

    doubts::about(&masks, &primary_textons, &mut warnings);
    for warning in &warnings {
        progress.warn(warning);
    }
    let spacing = secondaries::spacing(&centres(&secondary_textons), &primaries);
    let elements: Vec<Element> = primary_textons.into_iter().chain(secondary_textons).collect();
    let maps = [&primaries, &textons];
    let layers = strata.layers(exemplar, maps, &elements, (background, spacing), params);
    let guide = Guide::of(&exemplar.image);
    let lattice = guide.lattice(false);
    let library = Library {
        format: Library::FORMAT.into(),
        version: Library::VERSION,
        source: Source { layers: strata.why, warnings, ..source(exemplar, segmenter, params) },
        // An empty sum of floats is -0; folding from 0 avoids it.
        coverage: categories.iter().fold(0.0, |sum, c| sum + c.coverage).min(1.0),
        layers,
        elements,
        categories,
        arrangement: Arrangement { periodic: params.wrap, ..Arrangement::from_labels(&primaries) },
        descriptor_half,
        guide: Some(guide),
        lattice,
    };
    debug_assert_eq!(library.validate(), Ok(()));
    Ok(library)
}

/// The part of a map that is the photograph.
fn inside<'a>(margin: Option<&Margin>, map: &'a LabelMap) -> Cow<'a, LabelMap> {
    margin.map_or(Cow::Borrowed(map), |margin| Cow::Owned(margin.inner(map)))
}

/// Divides primaries into categories: the category of each, and all of them. `image_area` is in pixels.
fn categorise(
    primaries: &mut [Element],
    image_area: f64,
    params: &AnalyzeParams,
) -> (Vec<CategoryId>, Vec<Category>) {
    let features = |p: &Element| {
        let [r, g, b] = p.colour.to_f64();
        [r, g, b, f64::from(p.area), p.compactness.unwrap_or(0.0)]
    };
    let features: Vec<categories::Features> = primaries.iter().map(features).collect();
    let (ids, categories) = categories::divide(&features, params.categories, image_area, params.seed);
    primaries.iter_mut().zip(&ids).for_each(|(p, &id)| p.category = Some(id));
    (ids, categories)
}

/// Where a library comes from.
fn source(exemplar: &Exemplar, segmenter: &dyn Segmenter, params: &AnalyzeParams) -> Source {
    let (width, height) = exemplar.image.dimensions();
    Source {
        kind: SourceKind::Photograph,
        file: exemplar.file.clone(),
        width,
        height,
        scale: [1.0; 2],
        sha256: exemplar.sha256.clone(),
        segmenter: segmenter.name(),
        parameters: params.clone(),
        program: vtex_base::PROGRAM.into(),
        layers: None,
        warnings: Vec::new(),
    }
}

/// Fit tolerance (`fidelity`, in pixels) below which mixed pixels along rims keep their colours.
const FINEST_UNMIXED: f64 = 0.2;

/// The enlarged image, in which cells along the borders of primaries have the colour of their side.
fn own_colours(
    fine: &Cells<RgbImage>,
    cells: &Cells<LabelMap>,
    grid: Grid,
    params: &AnalyzeParams,
) -> Cells<RgbImage> {
    if params.fidelity < FINEST_UNMIXED { fine.clone() } else { unmixed(fine, cells, grid) }
}

/// Adds promoted patches to the primaries, on both the pixel and the cell map.
fn promote(primaries: &mut LabelMap, cells: &mut Cells<LabelMap>, promoted: &[Cells<Mask>], grid: Grid) {
    let first = cells.labels.iter().max().map_or(0, |m| *m) + 1;
    for (k, mask) in promoted.iter().enumerate() {
        cells.0.fill(mask, first + k as u32);
    }
    for (label, new) in primaries.labels.iter_mut().zip(grid.pixels(cells).labels) {
        if *label == 0 && new >= first {
            *label = new;
        }
    }
}

/// The details of each primary.
fn all_details(
    image: &Cells<RgbImage>,
    primaries: &[Cells<Mask>],
    params: &Cells<AnalyzeParams>,
) -> Vec<Vec<Cells<Mask>>> {
    let half = gaussian(params.detail_sigma);
    parallel::map(primaries, |mask| {
        let details = details(image, &half, mask, params.detail_scale, params.detail_minimum);
        details.into_iter().map(Cells).collect()
    })
}

/// A map with a label above 0 wherever there is an element, given that of the primaries.
fn any_texton(mut primaries: Cells<LabelMap>, secondaries: &[Cells<Mask>]) -> Cells<LabelMap> {
    for mask in secondaries {
        primaries.0.fill(mask, 1);
    }
    primaries
}

fn touches_border(mask: &Cells<Mask>, width: u32, height: u32) -> bool {
    mask.bounds()
        .is_some_and(|(x0, y0, x1, y1)| x0 <= 0 || y0 <= 0 || x1 >= width as i32 || y1 >= height as i32)
}

fn centres(secondaries: &[Element]) -> Vec<[f64; 2]> {
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
