//! The film of a run: numbered pictures of the deformed structure in a subfolder of the results.

use crate::output::{Folder, OutputError};

/// The folder of a film, in that of the results.
pub(super) const FILM: &str = "film";

/// Beginning of the names of the pictures.
const PICTURE_PREFIX: &str = "frame-";

/// Adds the pictures of a film to the results.
pub(super) fn add(folder: &mut Folder, pictures: &[String]) -> Result<(), OutputError> {
    for (number, picture) in (1..).zip(pictures) {
        let name = format!("{FILM}/{PICTURE_PREFIX}{number:04}.svg");
        folder.add(&name, picture.as_bytes())?;
    }
    Ok(())
}
