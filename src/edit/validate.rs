//! Operations that can be done: ranges, and what does not go together.

use crate::error::EditFault;
use crate::scene::{Action, Condition, Direction, Operation, Quantity, Role, Shadow};

/// Furthest that textons are moved, in pixels.
const FAR: f64 = 1e6;

/// A number of an operation: its name, itself, its range and unit.
type Number = (&'static str, f64, [f64; 2], &'static str);

/// Checks an operation; [`super::apply`] does so too.
///
/// # Errors
/// The first fault: a number out of its range, or a selection that the action is not for.
pub fn validate(operation: &Operation) -> Result<(), EditFault> {
    let Operation { action, layer, conditions } = operation;
    for (name, value, [low, high], unit) in numbers(action) {
        if !(low..=high).contains(&value) {
            return Err(EditFault::Range { name, value, low, high, unit });
        }
    }
    match action {
        Action::Thin { keep: None, minimum_area: None | Some(0.0), .. } => {
            return Err(EditFault::NothingKept);
        }
        Action::Jitter { distance, angle, scale } if [distance, angle, scale] == [&0.0; 3] => {
            return Err(EditFault::NothingChanged);
        }
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

/// Whether a condition asks for nothing but where something is.
fn of_place(condition: &Condition) -> bool {
    match condition {
        Condition::Place { .. } => true,
        Condition::Compare { quantity, .. } => matches!(quantity, Quantity::X | Quantity::Y),
        Condition::Among { .. } => false,
    }
}

/// The numbers of an action.
fn numbers(action: &Action) -> Vec<Number> {
    let share = |name, value| (name, value, [0.0, 1.0], "");
    let angle = |name, value| (name, value, [-360.0, 360.0], "degrees");
    let length = |name, value| (name, value, [0.0, 1000.0], "px");
    match *action {
        Action::Thin { keep, minimum_area, .. } => {
            let area = minimum_area.map(|v| ("min-area", v, [0.0, 1e9], "px of area"));
            keep.map(|v| share("keep", v)).into_iter().chain(area).collect()
        }
        Action::Orient { ref direction, strength } => {
            let towards = match direction {
                Direction::Angle(degrees) => Some(angle("degrees", *degrees)),
                Direction::Map(_) => None,
            };
            towards.into_iter().chain([share("strength", strength)]).collect()
        }
        Action::Tint { amount, share: some, .. } => vec![share("amount", amount), share("share", some)],
        Action::Recolor { reach, .. } => vec![("reach", reach, [0.01, 2.0], "")],
        Action::Shadow { angle: towards, length: far, opacity, blur } => vec![
            angle("angle", towards),
            length("length", far),
            share("opacity", opacity),
            ("blur", blur, [0.0, Shadow::WIDEST], "px"),
        ],
        Action::Simplify { tolerance } => vec![("px", tolerance, [0.01, 100.0], "px")],
        Action::Outline { width, .. } => vec![length("width", width)],
        Action::Move { x, y } => vec![("x", x, [-FAR, FAR], "px"), ("y", y, [-FAR, FAR], "px")],
        Action::Scale { factor } => vec![("factor", factor, [0.01, 100.0], "")],
        Action::Rotate { angle: turn } => vec![angle("degrees", turn)],
        Action::Jitter { distance, angle, scale } => vec![
            ("move", distance, [0.0, FAR], "px"),
            ("rotate", angle, [0.0, 180.0], "degrees"),
            ("scale", scale, [0.0, 90.0], "per cent"),
        ],
        Action::Density { .. }
        | Action::Palette { .. }
        | Action::Flatten
        | Action::Replace { .. }
        | Action::Delete
        | Action::Mask { .. } => Vec::new(),
    }
}
