//! The background field's control points (paper §3.2.3).

use super::ground::Ground;
use crate::library::Library;
use crate::raster::colour::Colour;
use crate::sampling::{Area, Stream, poisson_disk, stream};
use crate::scene::{ControlPoint, Field, SynthParams};

/// How far control points reach beyond a border of the canvas, in spacings.
const MARGIN: f64 = 2.0;

/// Poisson-disk points over the canvas and a margin, each in a colour of the palette. Where libraries
/// share the canvas, in colours of their palettes mixed by their shares.
pub(super) fn field(libraries: &[Library], ground: &Ground<'_>, params: &SynthParams) -> Field {
    let spacings = libraries.iter().map(|l| l.background.spacing);
    let spacing = params.background_spacing.unwrap_or_else(|| spacings.fold(f64::INFINITY, f64::min));
    let mut field = Field { spacing, fallback: libraries[0].background.fallback, points: Vec::new() };
    if libraries.iter().all(|l| l.background.sites.is_empty()) {
        return field;
    }
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
        // A hundredth of a pixel is enough, and shorter to write.
        let [x, y] = [0, 1].map(|k| libm::round((p[k] - margin[k]) * 100.0) / 100.0);
        field.points.push(ControlPoint { x, y, colour: colour(libraries, ground, [x, y], &mut random) });
    }
    field
}

/// A colour of the palette, or of several mixed by the shares of their libraries at a point.
pub(super) fn colour(
    libraries: &[Library],
    ground: &Ground<'_>,
    point: [f64; 2],
    random: &mut Stream,
) -> Colour {
    let drawn = |library: &Library, random: &mut Stream| {
        let sites = &library.background.sites;
        if sites.is_empty() { library.background.fallback } else { sites[random.index(sites.len())].colour }
    };
    if let [library] = libraries {
        return drawn(library, random);
    }
    let mut mixed = [0.0; 3];
    for (library, share) in libraries.iter().zip(ground.shares(point)) {
        let colour = drawn(library, random).to_f64();
        (0..3).for_each(|k| mixed[k] += share * colour[k]);
    }
    Colour::from_f64(mixed)
}
