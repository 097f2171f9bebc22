//! The files from which a scenario was read.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest as _, Sha256};

/// A file from which a scenario was read, with its hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputFile {
    /// Its name: as the scenario names it, or the last part of the path of the scenario itself.
    pub file: String,
    /// SHA-256 of its bytes in hexadecimal digits, as `sha256sum` prints it.
    pub sha256: String,
}

impl InputFile {
    pub(super) fn new(file: &str, bytes: &[u8]) -> Self {
        Self {
            file: file.to_owned(),
            sha256: sha256(bytes),
        }
    }

    /// The text of a scenario with its name in messages.
    pub(super) fn of_scenario(name: &str, text: &str) -> Self {
        let file = Path::new(name).file_name();
        let file = file.map_or(name.into(), |file| file.to_string_lossy());
        Self::new(&file, text.as_bytes())
    }
}

/// SHA-256 in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// All files from which a scenario was read. Scenarios may be equal whatever their files, so these compare as equal.
#[derive(Clone, Debug, Default)]
pub(super) struct InputFiles {
    /// The scenario itself first.
    pub(super) files: Vec<InputFile>,
    /// The folder to which the names of files are relative.
    pub(super) folder: PathBuf,
}

impl PartialEq for InputFiles {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
