//! Errors of the library as exceptions of Python.

use std::any::Any;
use std::fmt::Display;

use archrock::MemoryError;
use archrock::output::OutputError;
use archrock::scenario::{ScenarioError, ScenarioErrors};
use archrock::studies::{PartError, PartErrorKind, RunnerError};
use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};

/// A value that the library refuses, with its explanation.
pub fn refused_value(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// An allocation that would exceed the allowed memory.
pub fn too_large(error: MemoryError) -> PyErr {
    PyMemoryError::new_err(format!("{error}, by `memory_gb`"))
}

/// The errors of a scenario: with their places if a person wrote the text, otherwise the messages alone. Those of a change name the
/// argument `changes`, not the option of the program.
pub fn errors_in_words(errors: &ScenarioErrors, placed: bool) -> String {
    let words = |error: &ScenarioError| match error.file.strip_prefix("--set ") {
        Some(change) if error.place.is_none() => format!("changes {change:?}: {}", error.message),
        _ if placed => error.to_string(),
        _ => error.message.clone(),
    };
    let messages = errors.0.iter().map(words);
    messages.collect::<Vec<_>>().join("\n")
}

/// An error of the runner of studies.
pub fn not_run(error: RunnerError) -> PyErr {
    match error {
        RunnerError::Part(error) => unusable_part(error),
        _ => PyRuntimeError::new_err(error.to_string()),
    }
}

/// Why a part cannot be used.
pub fn unusable_part(error: PartError) -> PyErr {
    match error.kind {
        PartErrorKind::System | PartErrorKind::Folder => PyOSError::new_err(error.message),
        _ => refused_value(error),
    }
}

/// Why results could not be written.
pub fn not_written(error: OutputError) -> PyErr {
    match error {
        OutputError::NotFinite { .. } => PyRuntimeError::new_err(error.to_string()),
        _ => PyOSError::new_err(error.to_string()),
    }
}

/// A bug of the library; it must not end the interpreter.
pub fn panicked(panic: &(dyn Any + Send)) -> PyErr {
    let words = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no reason given");
    PyRuntimeError::new_err(format!(
        "a defect of archrock, please report the scenario: {words}"
    ))
}
