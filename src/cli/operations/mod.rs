//! The text of an operation on a scene, such as `tint #ff0000 --amount 0.5 --layer primary`, and the
//! operation that it means.

mod fault;
mod line;
mod list;
#[cfg(test)]
mod tests;
mod verb;
mod words;

pub(crate) use line::{Asked, parse};
pub(crate) use list::list;
