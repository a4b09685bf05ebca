//! Tests of the whole, in one program, because every test program links all of vtex. A part of them is run by
//! the name of its file, as in `cargo test --test all golden::`.

mod circles;
mod cli;
mod drawings;
mod exemplar;
mod exemplars;
mod formats;
mod golden;
mod hostile;
mod odd_drawings;
mod pages;
mod papers;
mod pipeline;
mod programs;
mod readme;
mod report;
mod rows;
mod schema;
mod support;
mod tile;
mod vectors;
