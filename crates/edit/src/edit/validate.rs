//! Validation of operations: ranges, and combinations that are not permitted.

use std::fmt::Display;
use vtex_base::Parameter;
use vtex_base::error::EditFault;
use vtex_scene::scene::{Action, Condition, Direction, Jitter, NumberOrMap, Operation, Quantity, Role};

/// Checks an operation; [`super::apply`] does so too.
///
/// # Errors The first fault: a number out of its range, or a selection that the action does not support.
pub fn validate(operation: &Operation) -> Result<(), EditFault> {
    let Operation { action, layer, conditions } = operation;
    ranges(action)?;
    match action {
        Action::Thin { keep: None, minimum_area: None | Some(0.0), .. } => {
            return Err(EditFault::NothingKept);
        }
        Action::Jitter(jitter) if jitter.is_nothing() => return Err(EditFault::NothingChanged),
        Action::Vary { colour: None, shape: None, .. } => return Err(EditFault::NothingChanged),
        _ => {}
    }
    if layer.as_deref() != Some(Role::Background.name()) {
        return Ok(());
    }
    if !matches!(action, Action::Tint { .. } | Action::Recolor { .. } | Action::Palette { .. }) {
        return Err(EditFault::NotForBackground);
    }
    if conditions.iter().all(of_place) { Ok(()) } else { Err(EditFault::BackgroundCondition) }
}

/// Whether a condition depends on places only.
fn of_place(condition: &Condition) -> bool {
    match condition {
        Condition::Place { .. } => true,
        Condition::Compare { quantity, .. } => matches!(quantity, Quantity::X | Quantity::Y),
        Condition::Among { .. } | Condition::Named { .. } => false,
    }
}

/// Refuses the first number out of its range.
fn ranges(action: &Action) -> Result<(), EditFault> {
    use Action as A;
    match *action {
        A::Thin { keep, minimum_area, .. } => {
            within(A::KEEP, keep).and(within(A::MINIMUM_AREA, minimum_area))
        }
        A::Orient { direction: Direction::Angle(degrees), strength } => {
            within(A::DEGREES, degrees).and(within(A::STRENGTH, strength))
        }
        A::Orient { strength, .. } => within(A::STRENGTH, strength),
        A::Tint { amount, share, .. } => within(A::AMOUNT, amount).and(within(A::SHARE, share)),
        A::Recolor { reach, .. } => within(A::REACH, reach),
        A::Shadow { angle, length, opacity, blur } => within(A::SHADOW_ANGLE, angle)
            .and(within(A::SHADOW_LENGTH, length))
            .and(within(A::OPACITY, opacity))
            .and(within(A::BLUR, blur)),
        A::Simplify { tolerance } => within(A::TOLERANCE, tolerance),
        A::Outline { width, .. } => within(A::WIDTH, width),
        A::Hatch { spacing, angle, width, .. } => within(A::HATCH_SPACING, spacing)
            .and(within(A::HATCH_ANGLE, angle))
            .and(within(A::HATCH_WIDTH, width)),
        A::Move { x, y } => within(A::X, x).and(within(A::Y, y)),
        A::Scale { factor: NumberOrMap::Number(factor) } => within(A::FACTOR, factor),
        A::Rotate { angle: NumberOrMap::Number(angle) } => within(A::DEGREES, angle),
        A::Transform { by: [x, y], scale: [wide, high], angle, .. } => within(A::WAY, x)
            .and(within(A::WAY, y))
            .and(within(A::FACTORS, wide))
            .and(within(A::FACTORS, high))
            .and(within(A::TURN, angle)),
        A::Jitter(ref j) => within(Jitter::DISTANCE, j.distance)
            .and(within(Jitter::ANGLE, j.angle))
            .and(within(Jitter::SCALE, j.scale))
            .and(within(Jitter::STRETCH, j.stretch))
            .and(within(Jitter::FLIP, j.flip))
            .and(within(Jitter::HUE, j.hue))
            .and(within(Jitter::CHROMA, j.chroma))
            .and(within(Jitter::LIGHTNESS, j.lightness))
            .and(within(Jitter::STEPS, j.steps)),
        A::Shuffle { share, .. } => within(A::SHARE, share),
        A::Vary { ref colour, ref shape, .. } => {
            within(A::COLOUR, number(colour)).and(within(A::SHAPE, number(shape)))
        }
        A::Propagate { similar, .. } => within(A::SIMILAR, similar),
        A::Relax { rounds, strength, minimum_distance } => within(A::ROUNDS, rounds)
            .and(within(A::RELAX_STRENGTH, strength))
            .and(within(A::MINIMUM_DISTANCE, minimum_distance)),
        A::Density { .. }
        | A::Scale { .. }
        | A::Rotate { .. }
        | A::Order { .. }
        | A::Palette { .. }
        | A::Flatten
        | A::Replace { .. }
        | A::Delete
        | A::Mask { .. } => Ok(()),
    }
}

/// The number; `None` for a map.
fn number(factor: &Option<NumberOrMap>) -> Option<f64> {
    match factor {
        Some(NumberOrMap::Number(factor)) => Some(*factor),
        _ => None,
    }
}

/// Refuses a number out of its range.
fn within<T: Copy + PartialOrd + Display>(
    range: Parameter<T>,
    value: impl Into<Option<T>>,
) -> Result<(), EditFault> {
    match value.into() {
        Some(value) if !range.allows(value) => {
            Err(EditFault::Range { name: range.name, value: value.to_string(), allowed: range.to_string() })
        }
        _ => Ok(()),
    }
}
