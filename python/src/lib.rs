//! The compiled half of the Python package: vtex's functions on plain values, bytes and arrays. The public
//! interface, with names, defaults and documentation, is in Python (`package/vtex/`).

mod analysis;
mod comparing;
mod composing;
mod document;
mod editing;
mod errors;
mod library;
mod pictures;
mod program;
mod run;
mod scene;
mod synthesis;
mod writing;

/// The compiled half of vtex.
#[pyo3::pymodule]
mod _vtex {
    #[pymodule_export]
    use crate::analysis::analyze;
    #[pymodule_export]
    use crate::comparing::compare;
    #[pymodule_export]
    use crate::composing::{interpolate, morph, stylize, transfer, warp};
    #[pymodule_export]
    use crate::editing::{colour, palette};
    #[pymodule_export]
    use crate::library::Library;
    #[pymodule_export]
    use crate::pictures::{encode, read};
    #[pymodule_export]
    use crate::program::run_program;
    #[pymodule_export]
    use crate::run::{set_threads, threads};
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::synthesis::{reconstruct, synthesize};

    /// Version of the library.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "as Python names it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
