//! From all that can be told apart to what is worth drawing.

use super::grid::Grid;
use super::joining;
use super::palette::Palette;
use super::price::Price;
use super::shapes::{self, Patch, Pieces};
use crate::library::AnalyzeParams;
use crate::parallel;
use crate::raster::Mask;
use image::RgbImage;

/// Joins details and leaves out patches that are not worth their bytes, at the lowest price that
/// leaves no more shapes than asked for. A warning tells if that cannot be.
pub(super) fn economise(
    image: &RgbImage,
    details: &[Vec<Mask>],
    patches: Vec<Patch>,
    params: &AnalyzeParams,
    grid: Grid,
    warnings: &mut Vec<String>,
) -> (Pieces, Price) {
    let join = |price: Price| parallel::map(details, |masks| joining::join(image, masks, price));
    let affordable = |price: Price, p: &Patch| price.affords(p.mask.area(), p.difference);
    let mut price = Price::new(params, grid);
    if params.max_paths > 0 {
        let most = params.max_paths as usize;
        price = price.within(most, |price| {
            let kept = patches.iter().filter(|p| affordable(price, p)).count();
            kept + join(price).iter().map(Vec::len).sum::<usize>()
        });
        if details.len() > most {
            warnings.push(format!(
                "there are {} primary textons, more than the {most} paths asked for: each is drawn as one \
                 (raise the minimum area)",
                details.len()
            ));
        }
    }
    let secondaries = patches.into_iter().filter(|p| affordable(price, p)).collect();
    (Pieces { details: join(price), secondaries }, price)
}

/// The palette of all pieces, and the pieces with neighbours of one colour joined.
pub(super) fn reduce_colours(
    image: &RgbImage,
    mut pieces: Pieces,
    params: &AnalyzeParams,
) -> (Pieces, Palette) {
    let count = params.colors as usize;
    if count == 0 {
        return (pieces, Palette::new(&[], 0, params.seed));
    }
    let masks: Vec<&Mask> = pieces.details.iter().flatten().collect();
    let mut colours = parallel::map(&masks, |m| (shapes::median(image, m), m.area()));
    colours.extend(pieces.secondaries.iter().map(|p| (p.colour, p.mask.area())));
    let palette = Palette::new(&colours, count, params.seed);
    pieces.details = parallel::map(&pieces.details, |masks| {
        joining::join_alike(masks, |m| palette.nearest(shapes::median(image, m)))
    });
    (pieces, palette)
}
