//! Text → condition of `--where`, and the file that it may name.

use super::operation::{Comparison, Condition, Identity, Quantity};
use super::parse::Fault;
use crate::control;
use crate::error::{Result, nearest};
use crate::geometry::{Outline, Region};

/// A condition whose file is not read yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Term {
    Ready(Condition),
    Place { file: String, inside: bool },
}

impl Term {
    /// The condition on a canvas of a width and height; `read` gives the bytes of a file.
    pub(super) fn load(
        &self,
        canvas: [u32; 2],
        read: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
    ) -> Result<Condition> {
        Ok(match self {
            Self::Ready(condition) => condition.clone(),
            Self::Place { file, inside } => {
                Condition::Place { region: region(&read(file)?, file, canvas)?, inside: *inside }
            }
        })
    }

    /// Whether it asks for nothing but where something is.
    pub(super) fn is_of_place(&self) -> bool {
        match self {
            Self::Place { .. } => true,
            Self::Ready(Condition::Compare { quantity, .. }) => {
                matches!(quantity, Quantity::X | Quantity::Y)
            }
            Self::Ready(_) => false,
        }
    }
}

/// The inside of what a file shows: the shape of an SVG, or what is white in a picture.
pub(super) fn region(bytes: &[u8], name: &str, canvas: [u32; 2]) -> Result<Region> {
    let picture = image::guess_format(bytes).is_ok();
    let outline: Outline =
        if picture { control::mask(bytes, name, canvas)? } else { control::shape(bytes, name, canvas)? };
    Ok(Region::new(&outline))
}

/// A condition of `--where`.
pub(super) fn term(text: &str) -> Result<Term, Fault> {
    const EXPECTED: &str = "conditions are category=3, category!=3, category=3|5, library=0, id=17, area>200, \
                            elongation>1.5, x<500, y>=20, inside=FILE, outside=FILE, with commas between";
    let wrong = |reason: String| Fault::new(reason, EXPECTED);
    let signs = ["!=", ">=", "<=", "=", ">", "<"];
    let found = signs
        .iter()
        .filter_map(|sign| Some((text.find(sign)?, *sign)))
        .min_by_key(|(at, s)| (*at, 2 - s.len()));
    let (at, sign) = found.ok_or_else(|| wrong(format!("'{}' is no condition", crate::error::clip(text))))?;
    let (name, value) = (text[..at].trim(), text[at + sign.len()..].trim());
    let comparison = match sign {
        ">" => Some(Comparison::More),
        ">=" => Some(Comparison::AtLeast),
        "<" => Some(Comparison::Less),
        "<=" => Some(Comparison::AtMost),
        _ => None,
    };
    let equal = sign == "=";
    let unfit = || wrong(format!("'{name}' is not compared by '{sign}'"));
    let among = |identity| {
        if comparison.is_some() {
            return Err(unfit());
        }
        let numbers: std::result::Result<Vec<u32>, _> = value.split('|').map(|v| v.trim().parse()).collect();
        let numbers =
            numbers.map_err(|_| wrong(format!("'{}' is no whole number", crate::error::clip(value))))?;
        Ok(Term::Ready(Condition::Among { identity, numbers, wanted: equal }))
    };
    let compare = |quantity| {
        let limit = value.parse::<f64>().ok().filter(|v| v.is_finite());
        let limit = limit.ok_or_else(|| wrong(format!("'{}' is no number", crate::error::clip(value))))?;
        Ok(Term::Ready(Condition::Compare { quantity, comparison: comparison.ok_or_else(unfit)?, limit }))
    };
    let place = |inside| match (equal, value) {
        (true, "") => Err(wrong(format!("'{name}=' names no file"))),
        (true, file) => Ok(Term::Place { file: file.to_owned(), inside }),
        (false, _) => Err(unfit()),
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
        _ => {
            let names = ["category", "library", "id", "area", "elongation", "x", "y", "inside", "outside"];
            let reason = format!("'{}' is nothing that textons have", crate::error::clip(name));
            Err(Fault::new(reason, format!("did you mean '{}'? {EXPECTED}", nearest(name, &names))))
        }
    }
}
