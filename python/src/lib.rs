//! The native part of the Python package `archrock`: the library's own types behind handles, text and arrays.
//!
//! It computes nothing itself. Structures, ground motions and scenarios come in as the TOML text of a scenario, so that the
//! reader of the library checks them and explains errors. Small results are returned as the JSON of the program, tables as the
//! files of the program, and histories as arrays that are moved out of Rust and not copied. The classes for users are in
//! `package/archrock`.

mod error;
mod history;
mod scenario;
mod studies;
mod watched;

use pyo3::prelude::*;

/// The module `archrock._native`.
#[pymodule]
mod _native {
    use archrock::scenario::MODELS;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::history::History;
    #[pymodule_export]
    use crate::scenario::{Ground, Scenario, file_of};
    #[pymodule_export]
    use crate::studies::{compute_part, merge, save, study};

    /// Names of the models of motion, in results and as options of the program, and the memory that a history may take by default, in units of 1e9 bytes.
    #[pymodule_init]
    fn constants(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let models = MODELS.iter().map(|one| (one.option, one.name));
        module.add("MODELS", models.collect::<Vec<_>>())?;
        module.add("MEMORY_GB", archrock::MEMORY_BYTES as f64 / 1e9)
    }
}
