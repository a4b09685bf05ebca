//! Regions around painted ones, from the top layer down (the paper, fig. 12).

use super::super::map::LayerRegion;
use super::super::regions::depth;
use super::assignment::Assigned;
use super::patches::BorderWindows;
use super::pyramid::doubled;
use super::shape::{BoundaryModel, Bounds, Votes, fill, optimise};
use super::{SIDES, nested::pyramid};
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::sampling::stream;

/// Most levels: few, so that painted shapes stay in place.
const LEVELS: usize = 2;
/// Distance in cells by which a border may leave its painted place, on each level.
const BAND: [f32; LEVELS] = [1.5, 0.6];
/// The same on the finest level as a share of the mean depth of what is painted, so that thin strokes keep
/// their place.
const BAND_OF_DEPTH: f32 = 0.5;

/// The region above, after its optimisation.
struct Above {
    region: LayerRegion,
    model: BoundaryModel,
    last: Option<(BorderWindows, Vec<Assigned>)>,
}

/// Makes regions from S_1 up with borders like those of `exemplar`. Each covers what is `painted` and,
/// below the top, extends around the region above as far as in the exemplar.
///
/// # Errors
/// [`vtex_base::Error::Interrupted`].
pub(in super::super) fn outlined(
    exemplar: &[LayerRegion],
    painted: &[LayerRegion],
    seed: u64,
    progress: &dyn Progress,
) -> Result<Vec<LayerRegion>> {
    let mut above: Option<Above> = None;
    let mut found = Vec::new();
    for k in (0..exemplar.len()).rev() {
        advance(progress, "borders", found.len() as u64, exemplar.len() as u64)?;
        let mut start = painted[k].clone();
        if let Some(above) = &above {
            let votes = above.last.as_ref().map(|(patches, assigned)| {
                Votes::new(&above.region, patches, assigned, &above.model, &exemplar[k])
            });
            for i in 0..start.inside.len() {
                let likely = votes.as_ref().and_then(|v| v.share(i)).is_some_and(|share| share > 0.5);
                start.inside[i] |= likely || above.region.inside[i];
            }
        }
        let next = around(k, &exemplar[k], start, above.as_ref().map(|a| &a.region), seed);
        found.push(next.region.clone());
        above = Some(next);
    }
    found.reverse();
    Ok(found)
}

/// Optimises a region from its start, coarse to fine. It always holds the region above.
fn around(
    k: usize,
    exemplar: &LayerRegion,
    start: LayerRegion,
    above: Option<&LayerRegion>,
    seed: u64,
) -> Above {
    let shortest = exemplar.size.into_iter().chain(start.size).min().unwrap_or(1);
    let levels = (0..LEVELS).take_while(|l| shortest >> l >= 16).count().max(1);
    let models = pyramid(exemplar, levels);
    let starts = pyramid(&start, levels);
    let under = above.map(|a| pyramid(a, levels));
    let most = BAND_OF_DEPTH * mean_depth(&start);
    let mut above =
        Above { region: starts[levels - 1].clone(), model: level_model(&models, levels - 1), last: None };
    for level in (0..levels).rev() {
        let mut region = match level + 1 == levels {
            true => starts[level].clone(),
            false => doubled(&above.region, starts[level].size),
        };
        let model = level_model(&models, level);
        let band = BAND[level].min(most / (1 << level) as f32);
        let mut free: Vec<bool> = depth(&starts[level]).iter().map(|d| d.abs() <= band).collect();
        if let Some(under) = &under {
            for i in (0..free.len()).filter(|&i| under[level].inside[i]) {
                (free[i], region.inside[i]) = (false, true);
            }
        }
        let bounds = Bounds { free: Some(&free), area: starts[level].area() };
        let values: Vec<f32> = region.inside.iter().map(|&v| if v { 1.0 } else { 0.0 }).collect();
        fill(&mut region, &values, &bounds);
        let mut random = stream(seed, "layers/sketch", (k * LEVELS + level) as u64);
        let last = optimise(&mut region, &model, &bounds, &mut random);
        above = Above { region, model, last };
    }
    above
}

/// Mean distance of what is inside from the border, in cells.
fn mean_depth(region: &LayerRegion) -> f32 {
    let inside = depth(region).into_iter().filter(|&d| d > 0.0);
    inside.sum::<f32>() / region.area().max(1) as f32
}

/// The model of a level.
fn level_model(models: &[LayerRegion], level: usize) -> BoundaryModel {
    BoundaryModel::new(models[level].clone(), SIDES[usize::from(level > 0)])
}
