//! The cost of a texture, estimated before it is made.
//!
//! Shapes are those of the exemplar in proportion to the area, which holds within a tenth: placement keeps the density of
//! elements. Bytes and seconds follow from shapes and pixels; their constants were fitted to textures of six photographs
//! and seven drawings, which they meet within a factor of two, except for seconds of drawings: a regular one takes less, one
//! that is not placed by its period may take more.

use super::methods::chosen;
use super::period;
use crate::arrange::Plan;
use std::borrow::Cow;
use vtex_scene::library::Library;
use vtex_scene::scene::{Method, SynthParams};

/// Bytes of an SVG for each placed element that has a group and an id, for each other one, for each shape drawn, and for
/// each shape of the library.
const SVG_BYTES: [f64; 4] = [120.0, 55.0, 25.0, 100.0];
/// Bytes of a PDF for each shape drawn, of a photograph and of a drawing, and for each shape of the library.
const PDF_BYTES: [f64; 3] = [9.0, 4.0, 26.0];
/// Bytes of the background as SVG and as PDF, of a photograph and of a drawing.
const BACKGROUND_BYTES: [[f64; 2]; 2] = [[35e3, 300e3], [0.0, 4e3]];
/// Seconds for each megapixel of the canvas, and for each million shapes, of a photograph.
const SECONDS: [f64; 2] = [1.4, 16.0];
/// Seconds for each megapixel of a drawing, and for each thousand elements, by its period and by other methods.
const DRAWING_SECONDS: [f64; 3] = [0.18, 0.05, 5.0];
/// Megapixels above which a drawing is placed on fewer pixels.
const FINE: f64 = 25.0;
/// Number of shapes from which on a texture may be heavy.
const MANY: f64 = 50_000.0;
/// Factor by which a heavy texture has more shapes than one of the usual size.
const HEAVY: f64 = 10.0;

/// What a texture costs. [`CanvasSize::usual_for`](super::CanvasSize::usual_for) gives a size to compare it with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Number of shapes that are drawn.
    pub shapes: f64,
    /// Length of an SVG, in bytes.
    pub svg_bytes: f64,
    /// Length of a PDF, in bytes.
    pub pdf_bytes: f64,
    /// Seconds until it is written, on one core of 2024.
    pub seconds: f64,
}

impl Cost {
    /// Estimates the cost of a texture of libraries, without controls.
    pub fn of(libraries: &[Library], params: &SynthParams) -> Self {
        let area = f64::from(params.width) * f64::from(params.height);
        let costs = libraries.iter().map(|library| Self::of_one(library, params, area));
        let mean = |of: &dyn Fn(&Self) -> f64| {
            costs.clone().map(|c| of(&c)).sum::<f64>() / libraries.len().max(1) as f64
        };
        Self {
            shapes: mean(&|c| c.shapes),
            svg_bytes: mean(&|c| c.svg_bytes),
            pdf_bytes: mean(&|c| c.pdf_bytes),
            seconds: mean(&|c| c.seconds),
        }
    }

    fn of_one(library: &Library, params: &SynthParams, area: f64) -> Self {
        let [w, h] = library.page();
        let pages = area / (w * h);
        let (mut named, mut plain, mut shapes) = (0.0, 0.0, 0.0);
        for layer in &library.layers {
            let own = layer.instances.len() as f64 * pages;
            if layer.role.is_individual() {
                named += own
            } else {
                plain += own
            }
            let of =
                |i: &vtex_scene::library::ExemplarInstance| library.elements[i.element.index()].shapes.len();
            shapes += layer.instances.iter().map(of).sum::<usize>() as f64 * pages;
        }
        let known = library.elements.iter().map(|element| element.shapes.len()).sum::<usize>() as f64;
        let megapixels = area * library.source.scale[0] * library.source.scale[1] / 1e6;
        let seconds = if library.is_drawing() {
            let [pixels, by_period, by_others] = DRAWING_SECONDS;
            let each = if is_by_period(library, params) { by_period } else { by_others };
            pixels * megapixels.min(FINE.max(area / 1e6)) + each * (named + plain) / 1e3
        } else {
            SECONDS[0] * megapixels + SECONDS[1] * shapes / 1e6
        };
        let kind = usize::from(library.is_drawing());
        let [svg_background, pdf_background] = BACKGROUND_BYTES[kind];
        Self {
            shapes,
            svg_bytes: SVG_BYTES[0] * named
                + SVG_BYTES[1] * plain
                + SVG_BYTES[2] * shapes
                + SVG_BYTES[3] * known
                + svg_background,
            pdf_bytes: PDF_BYTES[kind] * shapes + PDF_BYTES[2] * known + pdf_background,
            seconds,
        }
    }

    /// Whether the texture has more than ten times as many shapes as one of the usual size, and at least 50 000.
    pub fn is_heavy(&self, usual: &Self) -> bool {
        self.shapes > MANY.max(HEAVY * usual.shapes)
    }
}

/// Whether a drawing is placed by its period.
fn is_by_period(library: &Library, params: &SynthParams) -> bool {
    let libraries = Cow::Borrowed(std::slice::from_ref(library));
    let mut plan = Plan { libraries, controls: Cow::default(), params: params.clone(), memory: None };
    period::applies(&plan) && chosen(&mut plan, &()).is_ok() && plan.params.method == Method::Period
}
