//! Simplification: joins and drops pieces until the drawing is worth its bytes.

use super::grid::Cells;
use super::ground::{Ground, STAGE};
use super::joining;
use super::memory::ElementsMemory;
use super::painted::PaintedPicture;
use super::palette::Palette;
use super::partition::Partition;
use super::patches::{self, FlatPatch};
use super::pursuit::Shade;
use super::rate_distortion::RateDistortion;
use super::shading::{self, ElementParts, KnownParts, Shaded};
use super::shapes::ExemplarPieces;
use super::strata::BehindElements;
use image::RgbImage;
use std::collections::BTreeMap;
use std::sync::Arc;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::{Progress, SideBySide};
use vtex_base::raster::Mask;
use vtex_base::raster::colour::Colour;
use vtex_scene::library::{AnalyzeParams, Shading};

/// Colours of all soft ellipses of a photograph.
const COLOURS: usize = 128;

/// Joins details, shades them softly, and drops patches that cost more bytes than they save error, or that spots
/// replace. If `max_paths` is above 0, the cost of a byte rises until at most that many shapes remain; a warning
/// says if the primaries alone exceed it. Then, if colours are limited, clusters those of all pieces, and joins
/// neighbouring details of one colour. Elements whose parts are `known` are not shaded again; `remembers` keeps the
/// parts of all.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub(super) fn simplify(
    partition: &Partition<'_>,
    (details, known, remembers): (&[Vec<Cells<Mask>>], &KnownParts, Option<&mut ElementsMemory>),
    patches: Vec<FlatPatch>,
    behind: &BehindElements<'_>,
    warnings: &mut Vec<String>,
    progress: &dyn Progress,
) -> Result<ExemplarPieces> {
    let Partition { params, clean, grid, .. } = partition;
    let join = |cost: RateDistortion| parallel::map(details, |masks| joining::join(clean, masks, cost));
    let worthwhile = |cost: RateDistortion, p: &FlatPatch| cost.is_worth(p.mask.area(), p.difference);
    let mut cost = RateDistortion::new(params, *grid);
    if params.max_paths > 0 {
        let most = params.max_paths as usize;
        cost = cost.with_limit(most, |cost| {
            let kept = patches.iter().filter(|p| worthwhile(cost, p) && partition.counts(&p.mask)).count();
            let joined = join(cost).into_iter().zip(&partition.primaries);
            let joined = joined.filter(|(_, mask)| partition.counts(mask));
            kept + joined.map(|(details, _)| details.len()).sum::<usize>()
        });
        let primaries = partition.primaries.iter().filter(|mask| partition.counts(mask)).count();
        if primaries > most {
            warnings.push(format!(
                "there are {primaries} primary elements, more than the {most} paths asked for: each is drawn as \
                 one (raise the minimum area)"
            ));
        }
    }
    let secondaries: Vec<FlatPatch> = patches.into_iter().filter(|p| worthwhile(cost, p)).collect();
    let palette = Palette::new(&[], 0, params.seed);
    let is_soft = params.shading == Shading::Soft && params.colors == 0 && params.max_paths == 0;
    if is_soft {
        cost = cost.dearer(shading::DEARER).adapted(&partition.exemplar.image);
        let tasks = SideBySide::new(progress, STAGE);
        let (shaded, ground) = parallel::join(
            || shading::shaded(partition, details, known, cost, &tasks.silent()),
            || Ground::new(partition, secondaries, cost, behind, &tasks),
        );
        let (mut shaded, mut ground) = (shaded?, ground?);
        remember(partition, (details, known), Some(&shaded), remembers);
        let spots = ground.spots.iter_mut().map(|spot| &mut spot.shade);
        share_colours(shaded.iter_mut().flat_map(|s| &mut s.shades).chain(spots), params.seed);
        let Ground { patches: secondaries, spots } = ground;
        let (details, shades): (Vec<_>, Vec<_>) = shaded.into_iter().map(|s| (s.details, s.shades)).unzip();
        let elements: Vec<_> = details.iter().zip(&shades).map(|(d, s)| (&d[..], &s[..])).collect();
        let painted = Some(PaintedPicture::new(partition, behind, cost, &elements, (&secondaries, &spots)));
        return Ok(ExemplarPieces { details, shades, secondaries, spots, cost, painted, palette });
    }
    remember(partition, (details, known), None, remembers);
    let (details, shades) = (join(cost), vec![Vec::new(); details.len()]);
    let (spots, painted) = (Vec::new(), None);
    let pieces = ExemplarPieces { details, shades, secondaries, spots, cost, painted, palette };
    Ok(if params.colors == 0 { pieces } else { reduce_colours(clean, pieces, params) })
}

/// Keeps the parts of all elements, if there is a memory.
fn remember(
    partition: &Partition<'_>,
    (details, known): (&[Vec<Cells<Mask>>], &KnownParts),
    shaded: Option<&[Shaded]>,
    memory: Option<&mut ElementsMemory>,
) {
    let Some(memory) = memory else { return };
    let made = |k: usize| {
        let shaded = shaded.map(|all| all[k].clone());
        Arc::new(ElementParts { details: details[k].clone(), shaded })
    };
    let parts = known.iter().enumerate().map(|(k, known)| known.clone().unwrap_or_else(|| made(k)));
    memory.put(partition, parts.collect());
}

/// Gives soft ellipses the nearest of [`COLOURS`] colours.
fn share_colours<'s>(shades: impl Iterator<Item = &'s mut Shade>, seed: u64) {
    let mut shades: Vec<&mut Shade> = shades.collect();
    // Clusters of thousands of ellipses come out the same from colours to a few steps.
    let mut counts: BTreeMap<Colour, u32> = BTreeMap::new();
    for shade in &shades {
        *counts.entry(Colour(shade.colour.0.map(|v| v / 6 * 6 + 3))).or_default() += 1;
    }
    let colours: Vec<(Colour, u32)> = counts.into_iter().collect();
    let palette = Palette::new(&colours, COLOURS, seed);
    shades.iter_mut().for_each(|shade| shade.colour = palette.nearest(shade.colour));
}

/// Clusters the colours of all pieces into a palette of `colors` entries, and joins neighbouring
/// details that share an entry.
fn reduce_colours(
    image: &Cells<RgbImage>,
    mut pieces: ExemplarPieces,
    params: &AnalyzeParams,
) -> ExemplarPieces {
    let masks: Vec<&Cells<Mask>> = pieces.details.iter().flatten().collect();
    let mut colours = parallel::map(&masks, |m| (patches::median(image, m), m.area()));
    colours.extend(pieces.secondaries.iter().map(|p| (p.colour, p.mask.area())));
    let palette = Palette::new(&colours, params.colors as usize, params.seed);
    pieces.details = parallel::map(&pieces.details, |masks| {
        joining::join_alike(masks, |m| palette.nearest(patches::median(image, m)))
    });
    ExemplarPieces { palette, ..pieces }
}
