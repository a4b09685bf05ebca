//! Results looked at and compared: the HTML page, metrics of pictures.

pub mod metrics;
pub mod report;
