//! The text of a scenario, from a file, a reader or a program.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use archrock_records::not_plain;

use super::error::{Fault, ScenarioErrors};
use super::files::{FileContents, Files, read_at_most, without_current_folders};

/// The text of a scenario, and its name in errors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    pub(super) name: String,
    pub(super) files: Files,
    pub(super) text: String,
}

impl Source {
    /// Makes a source of a text. `name` is the file name in errors. Records of ground motion are read from files relative to the folder of
    /// `name`.
    pub fn of_text(text: &str, name: &str) -> Self {
        Self {
            name: name.to_owned(),
            files: folder_of(Path::new(name)),
            text: text.to_owned(),
        }
    }

    /// Makes a source that reads no files from disk, but these contents by the names in the scenario.
    #[must_use]
    pub fn with_files<C: Into<FileContents>>(
        self,
        contents: impl IntoIterator<Item = (PathBuf, C)>,
    ) -> Self {
        let contents = contents.into_iter();
        let named = contents.map(|(name, one)| (without_current_folders(&name), one.into()));
        let files = Files {
            folder: PathBuf::new(),
            in_memory: Some(Arc::new(named.collect())),
        };
        Self { files, ..self }
    }

    /// Name in errors.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// When there is no such file, or the file cannot be read, is not UTF-8 text or is larger than 1 MiB.
    pub fn of_file(path: &Path) -> Result<Self, ScenarioErrors> {
        let name = path.display().to_string();
        let unreadable = |message: String| ScenarioErrors::unreadable(&name, message);
        if path.is_dir() {
            return Err(unreadable("is a folder, not a scenario file".to_owned()));
        }
        let file =
            File::open(path).map_err(|error| unreadable(format!("cannot be read: {error}")))?;
        Ok(Self {
            files: folder_of(path),
            ..Self::of_reader(file, &name)?
        })
    }

    /// Reads the text from a reader. `name` is the file name in errors. Records of ground motion are read from files relative to the current
    /// folder.
    ///
    /// # Errors
    /// When the text cannot be read, is not UTF-8 text or is larger than 1 MiB.
    pub fn of_reader(reader: impl Read, name: &str) -> Result<Self, ScenarioErrors> {
        let unreadable = |wrong: String| ScenarioErrors::unreadable(name, wrong);
        let bytes = read_at_most(reader, 1, "scenario").map_err(unreadable)?;
        not_plain(&bytes).map(unreadable).map_or(Ok(()), Err)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            // The lossy text is identical up to the fault.
            let text = String::from_utf8_lossy(error.as_bytes());
            let offset = error.utf8_error().valid_up_to();
            let fault = Fault::new(0, offset, "not UTF-8 text from here".to_owned());
            ScenarioErrors::placed((&text, name), &[], vec![fault])
        })?;
        Ok(Self {
            name: name.to_owned(),
            files: Files::default(),
            text,
        })
    }
}

/// Files in the folder of a file.
fn folder_of(file: &Path) -> Files {
    Files {
        folder: file.parent().unwrap_or(Path::new("")).to_owned(),
        in_memory: None,
    }
}
