//! Scene → scene: operations on a finished texture (paper §4.5).
//!
//! An [`Operation`] is plain data, as scenes record it: an action, and the elements that it applies to. Files
//! that it names are in [`Files`]. [`apply`] applies operations one after the other.
//!
//! Operations keep ids. An element that several instances share is copied if only some of them change, and
//! dropped once no instance shows it. An operation that changes nothing is not recorded.

mod amount;
mod colours;
#[cfg(test)]
mod composing_tests;
mod files;
mod groups;
mod hatch;
mod jitter;
mod paint_order;
mod palette;
mod place;
mod propagate;
mod relax;
mod replace;
#[cfg(test)]
mod rim_tests;
mod selection;
mod shuffle;
mod style;
#[cfg(test)]
mod tests;
mod textons;
mod thin;
mod uncovering;
mod validate;
mod vary;

pub use files::Files;
pub(crate) use place::draw_as;
pub use validate::validate;
pub use vtex_scene::scene::{
    About, Action, ColourOrMap, Comparison, Condition, Direction, Distribution, Identity, Jitter, Keep,
    NumberOrMap, Operation, OrderBy, Quantity, ThinOrder, Within,
};

use amount::{Amount, ColourByPlace};
use colours::Shift;
use hatch::Pen;
use propagate::Propagated;
use relax::Relaxing;
use selection::{Chosen, ChosenPlaces};
use serde::Serialize;
use vtex_base::document::Document;
use vtex_base::error::{EditFault, Error, Result};
use vtex_base::geometry::{Affine, rotation};
use vtex_base::sampling::{Stream, stream};
use vtex_scene::scene::{EditRecord, InstanceId, Recorded, Scene};

/// The outcome of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Outcome {
    /// Number of elements, or points of fields, that it applied to: the selected ones; for `recolor` those
    /// with a matching colour, for `replace` those for which the library has a replacement.
    pub matched: usize,
    /// Number of textons that it removed.
    pub removed: usize,
    /// Number of textons that it left unchanged because they have no frame: they are at most a pixel wide or
    /// enclose no area, or would become so.
    #[serde(skip_serializing_if = "is_zero")]
    pub thin: usize,
}

/// Counts of the elements that an action applied to.
#[derive(Clone, Copy, Default)]
struct AppliedCounts {
    /// As [`Outcome::matched`].
    matched: usize,
    /// As [`Outcome::thin`].
    thin: usize,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Random numbers of one operation, independent for each instance.
struct Draw {
    seed: u64,
    /// Index of the operation in the scene's chain.
    step: u64,
}

impl Draw {
    /// The stream of an instance.
    fn of(&self, name: &str, id: InstanceId) -> Stream {
        stream(self.seed, name, self.step << 32 | u64::from(id.0))
    }
}

/// Applies operations one after the other and records them in the scene. Random choices follow `seed`, by
/// default the scene's own, 0 for a reconstruction; a chain applied at once or one by one gives the same
/// scene. `files` holds the files that the operations name ([`Files::read`]).
///
/// # Errors
/// [`Error::Format`] for a scene that breaks its invariants, [`Error::Edit`] for an operation that cannot be
/// applied or leads out of the permitted range.
pub fn apply(
    mut scene: Scene,
    operations: &[Operation],
    files: &Files,
    seed: Option<u64>,
) -> Result<(Scene, Vec<Outcome>)> {
    scene.check()?;
    let seed = seed.or(scene.parameters.as_ref().map(|p| p.seed)).unwrap_or(0);
    let mut outcomes = Vec::with_capacity(operations.len());
    for operation in operations {
        let fail = |fault| Error::Edit { operation: operation.to_string(), fault };
        validate(operation).map_err(fail)?;
        let chosen = Chosen::new(&scene, operation, files).map_err(fail)?;
        if operation.action.is_nothing() {
            outcomes.push(Outcome { matched: chosen.count(), removed: 0, thin: 0 });
            continue;
        }
        let before = scene.count();
        let draw = Draw { seed, step: scene.edits.len() as u64 };
        let AppliedCounts { matched, thin } =
            act(&mut scene, &chosen, operation, files, &draw).map_err(fail)?;
        scene.drop_unused();
        let removed = before - scene.count();
        scene.edits.push(EditRecord { operation: Recorded::Edit(operation.clone()), seed });
        scene.validate().map_err(|reason| fail(EditFault::TooFar(reason)))?;
        outcomes.push(Outcome { matched, removed, thin });
    }
    Ok((scene, outcomes))
}

/// Applies the action of an operation.
fn act(
    scene: &mut Scene,
    chosen: &Chosen,
    operation: &Operation,
    files: &Files,
    draw: &Draw,
) -> Result<AppliedCounts, EditFault> {
    let mut thin = 0;
    match &operation.action {
        Action::Thin { keep, order, minimum_area } => {
            thin::thin(scene, chosen, *keep, *order, *minimum_area, draw);
        }
        Action::Density { map } => thin::by_map(scene, chosen, files.map(map)?, draw),
        Action::Mask { shape, inside } => thin::by_region(scene, chosen, files.shape(shape)?, *inside),
        Action::Delete => thin::retain(scene, chosen, |_, _| false),
        Action::Orient { direction, strength } => {
            let towards = match direction {
                Direction::Angle(degrees) => place::Towards::Angle(degrees.to_radians()),
                Direction::Map(map) => place::Towards::Map(files.map(map)?),
            };
            place::orient(scene, chosen, &towards, *strength);
        }
        Action::Move { x, y } => place::shift(scene, chosen, [*x, *y]),
        Action::Scale { factor } => place::scale(scene, chosen, &Amount::new(factor, files)?),
        Action::Rotate { angle } => place::rotate(scene, chosen, &Amount::new(angle, files)?),
        Action::Transform { by, scale: [x, y], angle, about } => {
            let map = rotation(angle.to_radians()) * Affine::scale_non_uniform(*x, *y);
            place::transform(scene, chosen, map, *by, *about);
        }
        Action::Jitter(jitter) => jitter::jitter(scene, chosen, jitter, draw),
        Action::Relax { rounds, strength, minimum_distance } => {
            let places = ChosenPlaces::new(operation, files)?;
            let how = Relaxing { rounds: *rounds, strength: *strength, minimum: *minimum_distance, places };
            relax::relax(scene, chosen, &how);
        }
        Action::Propagate { drawing, element, fill, of, similar, replace } => {
            let what = match (drawing, element, fill) {
                (Some(file), None, None) => Propagated::Over(files.drawing(file)?),
                (None, Some(file), None) => Propagated::Alone(files.drawing(file)?),
                (None, None, Some(colour)) => Propagated::Fill(*colour),
                _ => return Err(EditFault::NotOneOf("a drawing, an element and a fill")),
            };
            if similar.is_some() && drawing.is_none() && of.is_none() {
                return Err(EditFault::LikeNothing);
            }
            let similarity = propagate::Similarity { of: *of, distance: *similar };
            return propagate::propagate(scene, chosen, &what, similarity, *replace);
        }
        Action::Order { by, reverse } => paint_order::order(scene, chosen, *by, *reverse, draw),
        Action::Shuffle { within, share, outlines } => {
            thin = shuffle::shuffle(scene, chosen, *within, *share, *outlines, draw);
        }
        Action::Vary { colour, shape, within } => {
            if let Some(factor) = colour {
                vary::colours(scene, chosen, &Amount::new(factor, files)?, *within);
            }
            if let Some(factor) = shape {
                thin = vary::shapes(scene, chosen, &Amount::new(factor, files)?, *within);
            }
        }
        Action::Tint { colour, amount, share } => {
            colours::tint(scene, chosen, &ColourByPlace::new(colour, files)?, *amount, *share, draw);
        }
        Action::Recolor { from, to, reach, keep } => {
            let keeps_details = *keep == Keep::Details;
            let shift = Shift { from: *from, to: *to, reach: *reach, keeps_details };
            let matched = colours::recolor(scene, chosen, shift);
            return Ok(AppliedCounts { matched, thin });
        }
        Action::Palette { colours, .. } => palette::palette(scene, chosen, colours),
        Action::Shadow { angle, length, opacity, blur } => {
            style::shadow(scene, chosen, *angle, *length, *opacity, *blur);
        }
        Action::Outline { width, colour } => style::outline(scene, chosen, *width, *colour),
        Action::Hatch { spacing, angle, width, colour, paper } => {
            let (angle, ink, paper) = (angle.to_radians(), *colour, *paper);
            hatch::hatch(scene, chosen, Pen { spacing: *spacing, angle, width: *width, ink, paper });
        }
        Action::Flatten => style::flatten(scene, chosen),
        Action::Simplify { tolerance } => style::simplify(scene, chosen, *tolerance),
        Action::Replace { library } => {
            let matched = replace::replace(scene, chosen, files.library(library)?);
            return Ok(AppliedCounts { matched, thin });
        }
    }
    Ok(AppliedCounts { matched: chosen.count(), thin })
}
