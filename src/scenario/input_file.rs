//! The input files of a scenario.

use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::files::Files;

/// An input file of a scenario, with its hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Name of the file as in the scenario; for the scenario itself, the last part of its path.
    pub file: String,
    /// SHA-256 of the bytes in hexadecimal digits, as `sha256sum` prints it.
    pub sha256: String,
}

impl InputFile {
    pub(super) fn new(file: &str, bytes: &[u8]) -> Self {
        Self {
            file: file.to_owned(),
            sha256: sha256(bytes),
        }
    }

    /// Makes the entry of a scenario, from its name in messages and its text.
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

/// All input files of a scenario. Any two values compare as equal, because scenarios are equal regardless of their files.
#[derive(Clone, Debug, Default)]
pub(super) struct InputFiles {
    /// The files; the scenario itself is the first.
    pub(super) files: Vec<InputFile>,
    /// The place of the files.
    pub(super) place: Files,
}

impl PartialEq for InputFiles {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
