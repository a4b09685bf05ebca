//! Simplification: joins and drops pieces until the drawing is worth its bytes.

use super::grid::{Cells, Grid};
use super::joining;
use super::palette::Palette;
use super::rate_distortion::RateDistortion;
use super::shapes::{self, Patch, Pieces};
use image::RgbImage;
use vtex_base::parallel;
use vtex_base::raster::Mask;
use vtex_scene::library::AnalyzeParams;

/// Which pieces count to those that are asked for.
pub(super) struct Counts<'a> {
    /// Whether each primary does.
    pub(super) primaries: Vec<bool>,
    /// Whether a patch does.
    pub(super) patch: &'a dyn Fn(&Cells<Mask>) -> bool,
}

/// Joins details and drops patches that cost more bytes than they save error. If `max_paths` is
/// above 0, the cost of a byte rises until at most that many shapes remain; a warning says if the
/// primaries alone exceed it.
pub(super) fn simplify(
    image: &Cells<RgbImage>,
    details: &[Vec<Cells<Mask>>],
    patches: Vec<Patch>,
    (params, grid): (&AnalyzeParams, Grid),
    counts: &Counts<'_>,
    warnings: &mut Vec<String>,
) -> (Pieces, RateDistortion) {
    let join = |cost: RateDistortion| parallel::map(details, |masks| joining::join(image, masks, cost));
    let worthwhile = |cost: RateDistortion, p: &Patch| cost.is_worth(p.mask.area(), p.difference);
    let mut cost = RateDistortion::new(params, grid);
    if params.max_paths > 0 {
        let most = params.max_paths as usize;
        cost = cost.with_limit(most, |cost| {
            let kept = patches.iter().filter(|p| worthwhile(cost, p) && (counts.patch)(&p.mask)).count();
            let joined = join(cost).into_iter().zip(&counts.primaries).filter(|(_, counts)| **counts);
            kept + joined.map(|(details, _)| details.len()).sum::<usize>()
        });
        let primaries = counts.primaries.iter().filter(|counts| **counts).count();
        if primaries > most {
            warnings.push(format!(
                "there are {primaries} primary elements, more than the {most} paths asked for: each is drawn as \
                 one (raise the minimum area)"
            ));
        }
    }
    let secondaries = patches.into_iter().filter(|p| worthwhile(cost, p)).collect();
    (Pieces { details: join(cost), secondaries }, cost)
}

/// Clusters the colours of all pieces into a palette of `colors` entries, and joins neighbouring
/// details that share an entry.
pub(super) fn reduce_colours(
    image: &Cells<RgbImage>,
    mut pieces: Pieces,
    params: &AnalyzeParams,
) -> (Pieces, Palette) {
    let count = params.colors as usize;
    if count == 0 {
        return (pieces, Palette::new(&[], 0, params.seed));
    }
    let masks: Vec<&Cells<Mask>> = pieces.details.iter().flatten().collect();
    let mut colours = parallel::map(&masks, |m| (shapes::median(image, m), m.area()));
    colours.extend(pieces.secondaries.iter().map(|p| (p.colour, p.mask.area())));
    let palette = Palette::new(&colours, count, params.seed);
    pieces.details = parallel::map(&pieces.details, |masks| {
        joining::join_alike(masks, |m| palette.nearest(shapes::median(image, m)))
    });
    (pieces, palette)
}
