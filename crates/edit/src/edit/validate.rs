//! Validation of operations: ranges, and combinations that are not permitted.

use vtex_base::error::EditFault;
use vtex_scene::scene::{
    Action, Condition, Direction, Jitter, NumberOrMap, Operation, Quantity, Role, Shadow,
};

/// Furthest that textons are moved, in pixels.
const FAR: f64 = 1e6;

/// Least and largest factor of sizes.
const FACTOR: [f64; 2] = [0.01, 100.0];

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

/// Whether a condition is about places only.
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
        Action::Scale { factor: NumberOrMap::Number(factor) } => vec![("factor", factor, FACTOR, "")],
        Action::Rotate { angle: NumberOrMap::Number(turn) } => vec![angle("degrees", turn)],
        Action::Transform { by: [x, y], scale: [wide, high], angle: turn, .. } => vec![
            ("move", x, [-FAR, FAR], "px"),
            ("move", y, [-FAR, FAR], "px"),
            ("scale", wide, FACTOR, ""),
            ("scale", high, FACTOR, ""),
            angle("rotate", turn),
        ],
        Action::Jitter(ref jitter) => of_jitter(jitter),
        Action::Shuffle { share: some, .. } => vec![share("share", some)],
        Action::Vary { ref colour, ref shape, .. } => {
            let pairs = [("color", colour), ("shape", shape)];
            let number = |(name, number): (_, &Option<NumberOrMap>)| match number {
                Some(NumberOrMap::Number(factor)) => Some((name, *factor, [0.0, 4.0], "")),
                _ => None,
            };
            pairs.into_iter().filter_map(number).collect()
        }
        Action::Propagate { similar, .. } => {
            similar.map(|v| ("similar", v, [0.0, 2.0], "")).into_iter().collect()
        }
        Action::Relax { rounds, strength, minimum_distance } => {
            let least = minimum_distance.map(|v| length("min-distance", v));
            let own = [("rounds", f64::from(rounds), [1.0, 1000.0], ""), share("strength", strength)];
            own.into_iter().chain(least).collect()
        }
        Action::Density { .. }
        | Action::Scale { .. }
        | Action::Rotate { .. }
        | Action::Order { .. }
        | Action::Palette { .. }
        | Action::Flatten
        | Action::Replace { .. }
        | Action::Delete
        | Action::Mask { .. } => Vec::new(),
    }
}

/// The numbers of a jitter.
fn of_jitter(jitter: &Jitter) -> Vec<Number> {
    vec![
        ("move", jitter.distance, [0.0, FAR], "px"),
        ("rotate", jitter.angle, [0.0, 180.0], "degrees"),
        ("scale", jitter.scale, [0.0, 90.0], "per cent"),
        ("stretch", jitter.stretch, [0.0, 90.0], "per cent"),
        ("flip", jitter.flip, [0.0, 1.0], ""),
        ("hue", jitter.hue, [0.0, 180.0], "degrees"),
        ("chroma", jitter.chroma, [0.0, 100.0], "per cent"),
        ("lightness", jitter.lightness, [0.0, 100.0], "per cent"),
        ("steps", f64::from(jitter.steps), [0.0, 1000.0], ""),
    ]
}
