//! Simplification: joins and drops pieces until the drawing is worth its bytes.

use super::grid::Cells;
use super::joining;
use super::palette::Palette;
use super::partition::Partition;
use super::rate_distortion::RateDistortion;
use super::shading;
use super::shapes::{self, ExemplarPieces, FlatPatch};
use image::RgbImage;
use vtex_base::parallel;
use vtex_base::raster::Mask;
use vtex_scene::library::{AnalyzeParams, Shading};

/// Joins details, shades them softly, and drops patches that cost more bytes than they save error. If `max_paths` is
/// above 0, the cost of a byte rises until at most that many shapes remain; a warning says if the
/// primaries alone exceed it.
/// Then, if colours are limited, clusters those of all pieces, and joins neighbouring details of one colour.
pub(super) fn simplify(
    partition: &Partition<'_>,
    details: &[Vec<Cells<Mask>>],
    patches: Vec<FlatPatch>,
    warnings: &mut Vec<String>,
) -> ExemplarPieces {
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
    let secondaries = patches.into_iter().filter(|p| worthwhile(cost, p)).collect();
    let palette = Palette::new(&[], 0, params.seed);
    let is_soft = params.shading == Shading::Soft && params.colors == 0 && params.max_paths == 0;
    let (details, shades) = if is_soft {
        cost = cost.dearer(shading::DEARER);
        let shaded = shading::shaded(partition, details, cost);
        shaded.into_iter().map(|s| (s.details, s.shades)).unzip()
    } else {
        (join(cost), vec![Vec::new(); details.len()])
    };
    let pieces = ExemplarPieces { details, shades, secondaries, cost, palette };
    if params.colors == 0 { pieces } else { reduce_colours(clean, pieces, params) }
}

/// Clusters the colours of all pieces into a palette of `colors` entries, and joins neighbouring
/// details that share an entry.
fn reduce_colours(
    image: &Cells<RgbImage>,
    mut pieces: ExemplarPieces,
    params: &AnalyzeParams,
) -> ExemplarPieces {
    let masks: Vec<&Cells<Mask>> = pieces.details.iter().flatten().collect();
    let mut colours = parallel::map(&masks, |m| (shapes::median(image, m), m.area()));
    colours.extend(pieces.secondaries.iter().map(|p| (p.colour, p.mask.area())));
    let palette = Palette::new(&colours, params.colors as usize, params.seed);
    pieces.details = parallel::map(&pieces.details, |masks| {
        joining::join_alike(masks, |m| palette.nearest(shapes::median(image, m)))
    });
    ExemplarPieces { palette, ..pieces }
}
