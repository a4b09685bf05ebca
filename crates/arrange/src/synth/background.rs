//! The background field's control points (paper §3.2.3).

use super::backdrop::{Backdrop, BackgroundPart};
use crate::arrange::region::PlacementRegion;
use crate::arrange::{PlacementResult, Plan};
use std::borrow::Cow;
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::{Area, Stream, poisson_disk, stream};
use vtex_scene::library::Library;
use vtex_scene::scene::{ControlPoint, Field};

/// Width of the margin of control points around the canvas, in spacings.
const MARGIN: f64 = 2.0;

/// Spacing of control points that take their colours from the exemplar's background, relative to the
/// exemplar's own spacing.
const FINER: f64 = 0.75;

/// Samples a Poisson-disk set over the canvas and a margin. Each point has a colour of the palette, or a
/// mixture by shares where libraries share the canvas.
pub(crate) fn field(plan: &Plan<'_>, arrangement: &PlacementResult<'_>) -> Field {
    let (params, map) = (&plan.params, &arrangement.cells);
    let correspondence = arrangement.correspondence.as_ref();
    let palettes = palettes(&plan.libraries);
    let spacings = palettes.iter().map(|palette| palette.spacing);
    let usual = spacings.fold(f64::INFINITY, f64::min) * if correspondence.is_some() { FINER } else { 1.0 };
    let spacing = params.background_spacing.unwrap_or(usual);
    let mut field = Field { spacing, fallback: palettes[0].fallback, points: Vec::new() };
    if palettes.iter().all(|palette| palette.points.is_empty()) {
        return field;
    }
    let backdrops = correspondence.map(|c| {
        let of = plan.libraries.iter().zip(&palettes).zip(c.labels()).map(|((library, palette), labels)| {
            let holds = |x: u32, y: u32| labels.get(x, y) == 0;
            let secondaries = library.secondaries().iter().collect();
            Backdrop::new(library, &BackgroundPart { field: palette, holds: &holds, secondaries })
        });
        (c, of.collect::<Vec<_>>())
    });
    let mut random = stream(params.seed, "synth/background", 0);
    let margin = |wrap: bool| if wrap { 0.0 } else { MARGIN * spacing };
    let margin = [margin(params.tile.x), margin(params.tile.y)];
    let area = Area {
        width: f64::from(params.width) + 2.0 * margin[0],
        height: f64::from(params.height) + 2.0 * margin[1],
        wrap_x: params.tile.x,
        wrap_y: params.tile.y,
    };
    for p in poisson_disk(area, spacing, &mut random) {
        // Two decimals are precise enough and keep files short.
        let [x, y] = [0, 1].map(|k| libm::round((p[k] - margin[k]) * 100.0) / 100.0);
        let colour = match &backdrops {
            Some((correspondence, backdrops)) => {
                let (library, place) = correspondence.origin(map.model(), [x, y]);
                Colour::from_f64(backdrops[library].at(place))
            }
            None => colour(&palettes, &map.region, [x, y], &mut random),
        };
        field.points.push(ControlPoint { x, y, colour });
    }
    field
}

/// The background fields of libraries.
pub(crate) fn palettes(libraries: &[Library]) -> Vec<Cow<'_, Field>> {
    libraries.iter().map(Library::background).collect()
}

/// A random colour of the palette, or of several, mixed by the shares of their libraries at a point.
pub(crate) fn colour(
    palettes: &[Cow<'_, Field>],
    region: &PlacementRegion<'_>,
    point: [f64; 2],
    random: &mut Stream,
) -> Colour {
    let drawn = |palette: &Field, random: &mut Stream| {
        let sites = &palette.points;
        if sites.is_empty() { palette.fallback } else { sites[random.index(sites.len())].colour }
    };
    if let [palette] = palettes {
        return drawn(palette, random);
    }
    let mut mixed = [0.0; 3];
    for (palette, share) in palettes.iter().zip(region.shares(point)) {
        let colour = drawn(palette, random).to_f64();
        (0..3).for_each(|k| mixed[k] += share * colour[k]);
    }
    Colour::from_f64(mixed)
}
