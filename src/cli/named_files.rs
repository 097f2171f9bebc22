//! Files that an option names, such as `--plot`.

use std::path::Path;

use archrock::output::{PictureFormat, PrintError, write_named_file};

use super::Failure;
use super::progress::print_status;

/// Writes a picture to the file named by `--plot`.
pub fn write_picture(path: &Path, picture: &str) -> Result<(), Failure> {
    let input = |wrong: PrintError| Failure::Input(format!("--plot: {wrong}"));
    let format = PictureFormat::of_file(path).map_err(input)?;
    let picture = format.of_picture(picture).map_err(input)?;
    write_named(path, &picture, "--plot")?;
    print_status(&format!("picture in {}", path.display()));
    Ok(())
}

/// Writes a file that this option names.
pub fn write_named(path: &Path, contents: &[u8], option: &str) -> Result<(), Failure> {
    let written = write_named_file(path, contents);
    written.map_err(|error| Failure::Input(format!("{error}; choose another file with {option}")))
}
