//! The film of a run: numbered pictures of the deformed structure in a subfolder of the results.

use std::fs;
use std::path::{Path, PathBuf};

use crate::output::{Folder, OutputError};

/// The folder of a film, in that of the results.
pub const FILM: &str = "film";

/// Beginning of the names of the pictures.
const PICTURE_PREFIX: &str = "frame-";

/// Returns the pictures of a film that are in its folder.
#[must_use]
pub fn pictures_in(film: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(film).into_iter().flatten().flatten();
    let is_picture = |entry: &fs::DirEntry| {
        let name = entry.file_name();
        name.to_str()
            .is_some_and(|name| name.starts_with(PICTURE_PREFIX))
    };
    entries
        .filter(is_picture)
        .map(|entry| entry.path())
        .collect()
}

/// Adds the pictures of a film to the results. They replace those of an earlier film.
pub(super) fn add(folder: &mut Folder, pictures: &[String]) -> Result<(), OutputError> {
    for old in pictures_in(&folder.path().join(FILM)) {
        if let Some(name) = old.file_name().and_then(|name| name.to_str()) {
            folder.forget(&format!("{FILM}/{name}"));
        }
    }
    for (number, picture) in (1..).zip(pictures) {
        let name = format!("{FILM}/{PICTURE_PREFIX}{number:04}.svg");
        folder.add(&name, picture.as_bytes())?;
    }
    Ok(())
}
