//! Properties of the whole, in one program: every test program would link all of vtex anew. Run a part of
//! them by the name of its file, as in `cargo test --test all golden::`.

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
mod pipeline;
mod programs;
mod readme;
mod report;
mod schema;
mod support;
mod tile;
mod vectors;
mod versions;
