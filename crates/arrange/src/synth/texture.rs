//! A texture: all that is decided before anything is placed, and then the scene that is made of it.
//!
//! Placement works on pixels; canvases and scenes have the units of the exemplars.
//!
//! The thresholds of colours are those of ordinary contrast. A library whose contrast was stretched for its analysis is
//! stretched for placement, too, if it is the only one, and the scene gets the library's own colours.

use super::canvas::check_canvas;
use super::canvas_parts::CanvasParts;
use super::drawn::with_drawing;
use super::excluded::no_elements;
use super::methods::{PlacementMethod, chosen};
use super::report::SynthReport;
use super::units::Units;
use crate::arrange::Plan;
use crate::arrange::controls::Controls;
use crate::arrange::period::check_periods;
use std::borrow::Cow;
use vtex_base::error::{Error, Result};
use vtex_base::progress::Progress;
use vtex_base::raster::colour::Colour;
use vtex_field::correspondence::PagesMemory;
use vtex_scene::library::{Library, Stretch};
use vtex_scene::scene::{Method, Scene, SynthParams};

/// A texture that is planned.
pub(super) struct Texture<'a> {
    plan: Plan<'a>,
    making: Making,
    /// Parameters and controls that are asked for, in the units of the canvas.
    asked: SynthParams,
    controls: Cow<'a, Controls>,
    units: Option<Units>,
    stretch: Option<Stretch>,
}

/// How a texture is made.
enum Making {
    /// By one method.
    Whole(Box<dyn PlacementMethod>),
    /// Of several textures, each of which fills a part of the canvas.
    Parts(CanvasParts),
}

impl<'a> Texture<'a> {
    /// Decides how a texture is made.
    ///
    /// # Errors
    /// [`Error::Parameter`] for parameters, controls or a method that are not for the libraries, [`Error::TooLarge`] for a
    /// canvas of too many pixels; those of `progress`.
    pub(super) fn new(
        mut libraries: Cow<'a, [Library]>,
        asked: SynthParams,
        mut controls: Cow<'a, Controls>,
        memory: Option<&'a PagesMemory>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        asked.validate()?;
        controls.validate(&libraries)?;
        let stretch = match &*libraries {
            [library] if controls.context.is_none() => Stretch::of_library(library),
            _ => None,
        };
        if let Some(stretch) = &stretch {
            libraries = Cow::Owned(vec![stretch.stretched(&libraries[0])]);
        }
        let page = libraries[0].page();
        // From here on libraries are those of the plan, in pixels.
        let mut units = Units::of(&libraries, &asked);
        let mut plan = Plan { libraries, controls: controls.clone(), params: asked.clone(), memory };
        if let Some(units) = &units {
            plan.libraries = Cow::Owned(units.in_pixels(&plan.libraries));
            units.fit(&mut plan, &asked, &controls);
        }
        check_canvas(&plan.params).map_err(|error| Units::error(units.as_ref(), error, &asked))?;
        if let Some(parts) = CanvasParts::of(&plan, progress)? {
            return Ok(Self { plan, making: Making::Parts(parts), asked, controls, units, stretch });
        }
        let method = chosen(&mut plan, progress)?;
        if plan.params.method == Method::Period {
            check_periods(page, &asked)?;
            if let Some(units) = &mut units {
                units.fit_periods(&asked, page);
                units.fit(&mut plan, &asked, &controls);
            }
        }
        // What is drawn in a region that is made anew is left out first.
        if let Some(context) = controls.context.as_ref().filter(|context| context.anew) {
            let cleared = method.cleared(context, [asked.width, asked.height]);
            controls.to_mut().context = Some(cleared);
            match &units {
                Some(units) => units.fit(&mut plan, &asked, &controls),
                None => plan.controls = controls.clone(),
            }
        }
        Ok(Self { plan, making: Making::Whole(method), asked, controls, units, stretch })
    }

    /// Makes the scene, and reports on it.
    ///
    /// # Errors
    /// Those of the method, and of `progress`.
    pub(super) fn scene(&self, progress: &dyn Progress) -> Result<(Scene, SynthReport)> {
        let Self { plan, asked, .. } = self;
        let made = match &self.making {
            Making::Whole(method) => {
                let arranged = method.arrange(plan, progress);
                arranged.and_then(|arranged| arranged.composed(plan, progress)).map_err(|e| self.named(e))
            }
            Making::Parts(parts) => parts.joined(plan, progress),
        };
        let mut made = made.map_err(|error| Units::error(self.units.as_ref(), error, asked))?;
        if let Some(units) = &self.units {
            made = units.back(made, plan, (asked, &self.controls));
        }
        let (mut scene, mut report) = made;
        if let Some(stretch) = &self.stretch {
            for stratum in &mut report.strata {
                stratum.colour = Colour::from_f64(stretch.undone(stratum.colour.to_f64()));
            }
            scene = stretch.undone_in(scene);
        }
        if let Some(warning) = no_elements(&plan.libraries, &scene) {
            progress.warn(&warning);
        }
        if let Some(context) = &self.controls.context {
            scene = with_drawing(scene, &context.drawing);
        }
        Ok((scene, report))
    }

    /// The error of a method. Where nobody has named it, the error says so.
    fn named(&self, error: Error) -> Error {
        match error {
            Error::Parameter { name: name @ "method", value, allowed }
                if self.asked.method == Method::Auto =>
            {
                Error::Parameter { name, value: format!("auto (it chose {value})"), allowed }
            }
            error => error,
        }
    }
}
