//! Measures the figures of docs/measurements/composable.md.

mod tests;
