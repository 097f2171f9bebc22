//! What a study tells once all its rows are there: files and words, the same for the program, for parts that are merged, and for Python.

use std::io::Write as _;

use serde_json::Value;

use crate::output::{Figure, Folder, OutputError};

/// What a study tells.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Results {
    /// Files by their names; a folder that has the last one is complete.
    pub files: Vec<(&'static str, Vec<u8>)>,
    /// A file that earlier results may have, and these have not.
    pub obsolete: Option<&'static str>,
    /// What they say, line by line.
    pub words: String,
    /// The same for programs, with all numbers.
    pub summary: Value,
}

impl Results {
    /// Names of the files, in their order.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        self.files.iter().map(|(name, _)| *name).collect()
    }

    /// Writes the files into a folder that was opened for them; it is complete afterwards.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write(&self, mut folder: Folder) -> Result<(), OutputError> {
        if let Some(name) = self.obsolete {
            folder.forget(name);
        }
        for (name, contents) in &self.files {
            let what = format!("cannot write {name}");
            folder
                .file(name)
                .write_all(contents)
                .map_err(OutputError::io(what))?;
        }
        folder.complete()
    }
}

/// What is answered at once, for programs and for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// All numbers.
    pub json: Value,
    /// The same in words.
    pub text: String,
}

/// How results look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Width of the pictures, and the size of their text.
    pub figure: Figure,
    /// Whether what survives in a map is coloured by its largest rotation over the critical one, where that is known.
    pub by_peak: bool,
    /// What the axes of a map, pulse duration and amplitude, are multiplied by to have no dimension; `None`: as they are.
    pub factors: Option<[f64; 2]>,
    /// Whether the least amplitudes of a map that overturn without impact are a table.
    pub no_impact: bool,
}

impl Look {
    /// A map coloured by outcome, its axes as they are, without the table.
    #[must_use]
    pub const fn of(figure: Figure) -> Self {
        Self {
            figure,
            by_peak: false,
            factors: None,
            no_impact: false,
        }
    }
}
