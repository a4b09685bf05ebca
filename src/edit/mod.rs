//! Scene → scene: what can be done to a texture after it was made (paper §4.5).
//!
//! An operation is written as a line of text, such as `tint #ff0000 --amount 0.5 --layer primary`.
//! [`Request::parse`] checks the text, [`Request::load`] reads the files that it names by a function
//! that the caller gives, and [`apply`] does the resulting [`Operation`]s one after the other. The
//! operations are data; [`catalogue`] says which there are and what they take.
//!
//! A texton that several instances share is copied when only some of them change.

mod catalogue;
mod colours;
mod conditions;
mod dress;
mod operation;
mod order;
mod parse;
mod place;
mod replace;
mod selection;
#[cfg(test)]
mod tests;
mod textons;
mod thin;

pub use catalogue::{Entry, Kind, Need, Parameter, catalogue, common_parameters};
pub use operation::{
    Action, Comparison, Condition, Direction, Identity, Layers, Operation, Quantity, ThinOrder,
};
pub use parse::Request;

use crate::document::Document;
use crate::error::{Error, Result};
use crate::sampling::{Stream, stream};
use crate::scene::{EditRecord, Scene};
use selection::Chosen;
use serde::Serialize;

/// What an operation came to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Outcome {
    /// The operation as it was written.
    pub operation: String,
    /// Textons, or points of the background, that it was for: those selected; of `recolor` those that
    /// have a colour like the one sought, of `replace` those for which the library has another.
    pub matched: usize,
    /// Textons that are gone after it.
    pub removed: usize,
}

/// Random numbers of one operation, independent for each instance.
struct Draw {
    seed: u64,
    /// Place of the operation in the scene's chain.
    step: u64,
}

impl Draw {
    /// The stream of an instance, or of a point of the background.
    fn of(&self, name: &str, id: u32) -> Stream {
        stream(self.seed, name, self.step << 32 | u64::from(id))
    }
}

/// Does operations one after the other and records them in the scene. Random choices follow `seed`,
/// by default the scene's own, 0 for a reconstruction; a chain done in one go or one by one gives the
/// same scene.
///
/// # Errors
/// [`Error::Format`] for a scene that breaks its invariants, [`Error::Edit`] for an operation that
/// leads out of their range.
pub fn apply(mut scene: Scene, operations: &[Operation], seed: Option<u64>) -> Result<(Scene, Vec<Outcome>)> {
    let unsound = |reason| Error::Format { name: "scene".into(), format: Scene::FORMAT, reason };
    scene.validate().map_err(unsound)?;
    let seed = seed.or(scene.parameters.as_ref().map(|p| p.seed)).unwrap_or(0);
    let mut outcomes = Vec::with_capacity(operations.len());
    for operation in operations {
        let chosen = Chosen::new(&scene, operation);
        let before = scene.primary.len() + scene.secondary.len();
        let draw = Draw { seed, step: scene.edits.len() as u64 };
        let matched = act(&mut scene, &chosen, &operation.action, &draw);
        textons::drop_unused(&mut scene);
        let removed = before - scene.primary.len() - scene.secondary.len();
        scene.edits.push(EditRecord { operation: operation.text.clone(), seed });
        scene.validate().map_err(|reason| Error::Edit {
            operation: operation.text.clone(),
            reason: format!("it leads too far: {reason}"),
            advice: "give smaller numbers".into(),
        })?;
        outcomes.push(Outcome { operation: operation.text.clone(), matched, removed });
    }
    Ok((scene, outcomes))
}

/// Does an operation; how many it was for.
fn act(scene: &mut Scene, chosen: &Chosen, action: &Action, draw: &Draw) -> usize {
    match action {
        Action::Thin { keep, order, minimum_area } => {
            thin::thin(scene, chosen, *keep, *order, *minimum_area, draw);
        }
        Action::Density { map } => thin::by_map(scene, chosen, map, draw),
        Action::Mask { region, inside } => thin::by_region(scene, chosen, region, *inside),
        Action::Delete => thin::retain(scene, chosen, |_, _| false),
        Action::Orient { direction, strength } => place::orient(scene, chosen, direction, *strength),
        Action::Move { by } => place::shift(scene, chosen, *by),
        Action::Scale { factor } => place::scale(scene, chosen, *factor),
        Action::Rotate { angle } => place::rotate(scene, chosen, *angle),
        Action::Jitter { distance, angle, scale } => {
            place::jitter(scene, chosen, *distance, *angle, *scale, draw);
        }
        Action::Tint { colour, amount, share } => {
            colours::tint(scene, chosen, *colour, *amount, *share, draw);
        }
        Action::Recolor { from, to, reach } => return colours::recolor(scene, chosen, *from, *to, *reach),
        Action::Palette { colours } => colours::palette(scene, chosen, colours),
        Action::Shadow { angle, length, opacity, blur } => {
            dress::shadow(scene, chosen, *angle, *length, *opacity, *blur);
        }
        Action::Outline { width, colour } => dress::outline(scene, chosen, *width, *colour),
        Action::Flatten => dress::flatten(scene, chosen),
        Action::Simplify { tolerance } => dress::simplify(scene, chosen, *tolerance),
        Action::Replace { library } => return replace::replace(scene, chosen, library),
    }
    chosen.count()
}
