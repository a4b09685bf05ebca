//! The grammar of `--op`: the text of an operation, such as `tint #ff0000 --amount 0.5 --layer primary`,
//! becomes an operation on a scene.

mod fault;
mod line;
mod list;
#[cfg(test)]
mod tests;
pub(super) mod verb;
mod words;

#[cfg(feature = "studio")]
pub(crate) use line::verbs;
pub(crate) use line::{ParsedOperation, parse};
pub(crate) use list::list;
