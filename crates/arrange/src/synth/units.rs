//! The units of libraries and canvases, and the pixels that placement works on.
//!
//! The number of pixels per unit is that of the finest photograph. Without photographs it is that of the
//! finest drawing, reduced on large canvases.

use super::canvas::LARGEST_CANVAS;
use super::report::SynthReport;
use crate::arrange::Plan;
use crate::arrange::controls::Controls;
use std::borrow::Cow;
use vtex_base::error::Error;
use vtex_base::geometry::Affine;
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::{Domain, LibraryRef, Scene, SynthParams};

/// Number of pixels of a canvas above which drawings have fewer pixels per unit.
const MOST_PIXELS: f64 = 25e6;

/// The pixels of a canvas whose libraries have other units.
pub(super) struct Units {
    /// Pixels per unit, along x and y.
    scale: [f64; 2],
    /// The axes along which the canvas is a whole number of periods long, but for its rounding.
    whole: [bool; 2],
    /// The libraries in units.
    references: Vec<LibraryRef>,
}

impl Units {
    /// The pixels per unit of libraries; `None` if all are in pixels.
    pub(super) fn of(libraries: &[Library], asked: &SynthParams) -> Option<Self> {
        let is_in_units = !libraries.iter().all(Library::is_in_pixels);
        is_in_units.then(|| Self {
            scale: scale(libraries, asked),
            whole: [false; 2],
            references: libraries.iter().map(Library::reference).collect(),
        })
    }

    /// Libraries in pixels.
    pub(super) fn in_pixels(&self, libraries: &[Library]) -> Vec<Library> {
        libraries.iter().map(|library| library.at_scale(self.scale).into_owned()).collect()
    }

    /// Gives a plan in pixels the canvas and the controls that are asked for.
    pub(super) fn fit(&self, plan: &mut Plan<'_>, asked: &SynthParams, controls: &Controls) {
        let scale = self.scale;
        let source = &plan.libraries[0].source;
        let [width, height] = self.canvas(asked, [source.width, source.height]);
        let spacing = |v: f64| (v * mean(scale)).clamp(4.0, 1000.0);
        plan.params = SynthParams {
            width,
            height,
            background_spacing: asked.background_spacing.map(spacing),
            lattice: asked.lattice.scaled(scale),
            ..plan.params.clone()
        };
        let places = places(plan, asked);
        let stretch = Affine::scale_non_uniform(places[0], places[1]);
        plan.controls = Cow::Owned(Controls {
            domain: controls.domain.as_ref().map(|d| d.moved(stretch)),
            context: controls.context.as_ref().map(|c| c.scaled(places, scale)),
            ..controls.clone()
        });
    }

    /// Makes the canvas a whole number of periods of a page long, along the axes that tile, and along both where its page
    /// says how long it is.
    pub(super) fn fit_periods(&mut self, asked: &SynthParams, page: [f64; 2]) {
        let fits = |size: u32, k: usize| {
            let rest = f64::from(size) / page[k];
            libm::round(rest) >= 1.0 && (rest - libm::round(rest)).abs() * page[k] <= 0.5
        };
        let shown = asked.page.is_some() && fits(asked.width, 0) && fits(asked.height, 1);
        self.whole = [asked.tile.x || shown, asked.tile.y || shown];
    }

    /// The canvas in pixels, given the pixels of a period.
    fn canvas(&self, asked: &SynthParams, period: [u32; 2]) -> [u32; 2] {
        let side = |k: usize, size: u32| {
            let exact = f64::from(size) * self.scale[k];
            let period = f64::from(period[k]);
            let side = if self.whole[k] {
                libm::round(exact / period).max(1.0) * period
            } else {
                libm::round(exact)
            };
            (side as u32).max(1)
        };
        [side(0, asked.width), side(1, asked.height)]
    }

    /// A scene of a plan in the units of the canvas, with its report.
    pub(super) fn back(
        &self,
        (scene, mut report): (Scene, SynthReport),
        plan: &Plan<'_>,
        (asked, controls): (&SynthParams, &Controls),
    ) -> (Scene, SynthReport) {
        // Whole periods are stretched with the canvas; otherwise copies would not meet. So are curves that go on from others.
        let exact = self.whole.contains(&true) || controls.context.is_some();
        let elements = if exact { places(plan, asked) } else { self.scale };
        let scene = scene.scaled([asked.width, asked.height], elements.map(|v| 1.0 / v));
        let given = |p: SynthParams| {
            let SynthParams { method, ablate, variation, .. } = p;
            SynthParams { method, ablate, variation, ..asked.clone() }
        };
        let domain =
            |d: Domain| Domain { outline: controls.domain.clone().unwrap_or(d.outline), edge: d.edge };
        if let Some(copies) = &mut report.repetition.copies {
            copies.shortest /= mean(self.scale);
            copies.median /= mean(self.scale);
        }
        let mut scene =
            Scene { parameters: scene.parameters.map(given), domain: scene.domain.map(domain), ..scene };
        for (own, reference) in scene.libraries.iter_mut().zip(&self.references) {
            own.clone_from(reference);
        }
        (scene, report)
    }

    /// An error that names sizes, in the units of the canvas; as it is where all is in pixels.
    pub(super) fn error(units: Option<&Self>, error: Error, asked: &SynthParams) -> Error {
        let Some(Self { scale, .. }) = units else { return error };
        match error {
            Error::TooLarge { what, name, .. } => {
                let most = LARGEST_CANVAS as f64 / scale[0] / scale[1] / 1e6;
                let found = format!("{} x {} px", asked.width, asked.height);
                Error::TooLarge {
                    what,
                    name,
                    found,
                    limit: format!("{most:.0} megapixels of this photograph"),
                }
            }
            Error::Periods { nearest, .. } => {
                let side = |v: u32, k: usize| (libm::round(f64::from(v) / scale[k]) as u32).max(1);
                let nearest = nearest.map(|[w, h]| [side(w, 0), side(h, 1)]);
                Error::Periods { width: asked.width, height: asked.height, nearest }
            }
            other => other,
        }
    }
}

/// Pixels of a plan's canvas per unit of the one asked for.
fn places(plan: &Plan<'_>, asked: &SynthParams) -> [f64; 2] {
    let of = |pixels: u32, units: u32| f64::from(pixels) / f64::from(units);
    [of(plan.params.width, asked.width), of(plan.params.height, asked.height)]
}

fn mean(scale: [f64; 2]) -> f64 {
    libm::sqrt(scale[0] * scale[1])
}

/// Pixels per unit of the canvas, along x and y.
fn scale(libraries: &[Library], params: &SynthParams) -> [f64; 2] {
    let finest = |kind: SourceKind| {
        let of_kind = libraries.iter().filter(|l| l.source.kind == kind).map(|l| l.source.scale);
        of_kind.max_by(|a, b| mean(*a).total_cmp(&mean(*b)))
    };
    if let Some(scale) = finest(SourceKind::Photograph) {
        return scale;
    }
    let scale = finest(SourceKind::Drawing).unwrap_or([1.0; 2]);
    let canvas = f64::from(params.width) * f64::from(params.height);
    let most = libm::sqrt(MOST_PIXELS / canvas).max(1.0);
    // Divided by a whole number, so that most borders between pixels keep their places.
    let part = libm::ceil(mean(scale) / most).max(1.0);
    scale.map(|v| v / part)
}
