//! Inspection and comparison of results: an HTML page, and metrics of pictures.

pub mod metrics;
pub mod report;
