//! The figures of benches/composable.md.

mod tests;
