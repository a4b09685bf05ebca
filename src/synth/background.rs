//! The background field's control points (paper §3.2.3).

use crate::library::Library;
use crate::sampling::{Area, poisson_disk, stream};
use crate::scene::{ControlPoint, Field, SynthParams};

/// How far control points reach beyond the canvas, in spacings.
const MARGIN: f64 = 2.0;

/// Poisson-disk points over the canvas and a margin, each in a colour of the palette.
pub(super) fn field(library: &Library, params: &SynthParams) -> Field {
    let background = &library.background;
    let spacing = params.background_spacing.unwrap_or(background.spacing);
    let mut field = Field { spacing, fallback: background.fallback, points: Vec::new() };
    if background.sites.is_empty() {
        return field;
    }
    let mut random = stream(params.seed, "synth/background", 0);
    let margin = MARGIN * spacing;
    let domain = Area::plane(f64::from(params.width) + 2.0 * margin, f64::from(params.height) + 2.0 * margin);
    for [x, y] in poisson_disk(domain, spacing, &mut random) {
        let site = background.sites[random.index(background.sites.len())];
        // A hundredth of a pixel is enough, and shorter to write.
        let [x, y] = [x - margin, y - margin].map(|v| libm::round(v * 100.0) / 100.0);
        field.points.push(ControlPoint { x, y, colour: site.colour });
    }
    field
}
