//! Text → condition of `--where`.

use super::fault::{Fault, clip};
use crate::cli::nearest::nearest;
use vtex::edit::{Comparison, Condition, Identity, Quantity};

const EXPECTED: &str = "conditions are category=3, category!=3, category=3|5, library=0, id=17, area>200, \
                        elongation>1.5, x<500, y>=20, inside=FILE, outside=FILE, with commas between";
const NAMES: [&str; 9] = ["category", "library", "id", "area", "elongation", "x", "y", "inside", "outside"];

/// A condition such as `category=3|5`, `area>200` or `inside=disc.svg`.
pub(super) fn condition(text: &str) -> Result<Condition, Fault> {
    let wrong = |reason: String| Fault::new(reason, EXPECTED);
    let text = text.trim();
    let at = text.find(['=', '!', '<', '>']);
    let (name, rest) = text.split_at(at.ok_or_else(|| wrong(format!("'{}' is no condition", clip(text))))?);
    let signs = ["!=", ">=", "<=", "=", ">", "<"];
    let found = signs.into_iter().find_map(|sign| Some((sign, rest.strip_prefix(sign)?.trim())));
    let (sign, value) = found.ok_or_else(|| wrong(format!("'{}' is no condition", clip(text))))?;
    let name = name.trim();
    let unfit = || wrong(format!("'{name}' is not compared by '{sign}'"));
    let among = |identity| {
        let wanted = match sign {
            "=" => true,
            "!=" => false,
            _ => return Err(unfit()),
        };
        let numbers: Result<Vec<u32>, _> = value.split('|').map(|v| v.trim().parse()).collect();
        let numbers = numbers.map_err(|_| wrong(format!("'{}' is no whole number", clip(value))))?;
        Ok(Condition::Among { identity, numbers, wanted })
    };
    let compare = |quantity| {
        let comparison = match sign {
            ">" => Comparison::More,
            ">=" => Comparison::AtLeast,
            "<" => Comparison::Less,
            "<=" => Comparison::AtMost,
            _ => return Err(unfit()),
        };
        let limit = value.parse::<f64>().ok().filter(|v| v.is_finite());
        let limit = limit.ok_or_else(|| wrong(format!("'{}' is no number", clip(value))))?;
        Ok(Condition::Compare { quantity, comparison, limit })
    };
    let place = |inside| match (sign, value) {
        ("=", "") => Err(wrong(format!("'{name}=' names no file"))),
        ("=", shape) => Ok(Condition::Place { shape: shape.to_owned(), inside }),
        _ => Err(unfit()),
    };
    match name {
        "category" => among(Identity::Category),
        "library" => among(Identity::Library),
        "id" => among(Identity::Id),
        "area" => compare(Quantity::Area),
        "elongation" => compare(Quantity::Elongation),
        "x" => compare(Quantity::X),
        "y" => compare(Quantity::Y),
        "inside" => place(true),
        "outside" => place(false),
        _ => Err(Fault::new(
            format!("'{}' is nothing that elements have", clip(name)),
            format!("did you mean '{}'? {EXPECTED}", nearest(name, &NAMES)),
        )),
    }
}
