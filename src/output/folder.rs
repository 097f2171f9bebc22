//! A folder of results that are replaced together.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::OutputError;
use super::print::PictureFormat;

/// A folder in which results are being prepared.
///
/// Every file is written under a hidden name and gets its own name when all are complete. The last of them,
/// the seal, is removed first and written last: a folder with a seal holds the results of one run.
///
/// The folder stays locked as long as this value lives, so that two runs cannot mix their files: a second run gets an error.
/// A single file is replaced in one step and cannot mix with others, so runs that write only one share the lock.
///
/// A killed run leaves its hidden files behind, but no lock; the next run removes the files.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Holds the lock; `None` where folders cannot be locked, as on some network drives and on Windows.
    _lock: Option<File>,
    /// Folders that were created for this one, outermost first.
    made: Vec<PathBuf>,
    files: Vec<(String, BufWriter<NamedTempFile>)>,
    /// Results that earlier runs may have left and that this run does not write.
    obsolete: Vec<String>,
    /// What pictures are written in beside SVG.
    pictures: Option<PictureFormat>,
}

/// How the hidden names begin.
const PREFIX: &str = ".archrock-";

impl Folder {
    /// Opens the folder for the files with these names, the seal last; creates the folder if necessary.
    ///
    /// # Errors
    /// When the folder or a file in it cannot be created, or another run is writing to it.
    pub fn open(path: &Path, names: &[&str]) -> Result<Self, OutputError> {
        let mut folder = Self {
            path: path.to_owned(),
            _lock: None,
            made: Vec::new(),
            files: Vec::new(),
            obsolete: Vec::new(),
            pictures: None,
        };
        for ancestor in path.ancestors().collect::<Vec<_>>().into_iter().rev() {
            if ancestor.as_os_str().is_empty() || ancestor.exists() {
                continue;
            }
            match fs::create_dir(ancestor) {
                Ok(()) => folder.made.push(ancestor.to_owned()),
                // Another run created it first.
                Err(_) if ancestor.is_dir() => {}
                Err(error) => {
                    let what = format!("cannot make the folder {}", ancestor.display());
                    return Err(OutputError::io(what)(error));
                }
            }
        }
        let alone = names.len() > 1;
        folder._lock = lock(path, alone)?;
        if alone && folder._lock.is_some() {
            remove_abandoned(path);
        }
        for name in names {
            let file = tempfile::Builder::new()
                .prefix(&format!("{PREFIX}{name}-"))
                .permissions_like_others()
                .tempfile_in(path)
                // The system's message would name the hidden file.
                .map_err(|error| error.kind().into())
                .map_err(OutputError::io(format!(
                    "cannot write {}",
                    path.join(name).display()
                )))?;
            folder
                .files
                .push(((*name).to_owned(), BufWriter::new(file)));
        }
        Ok(folder)
    }

    /// Names a result that earlier runs may have left and that this run does not write.
    pub fn forget(&mut self, name: &str) {
        self.obsolete.push(name.to_owned());
    }

    /// The same with every picture in this format too, beside its SVG.
    #[must_use]
    pub fn with_pictures(mut self, pictures: Option<PictureFormat>) -> Self {
        self.pictures = pictures;
        self
    }

    /// The path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file of that name, to write to.
    ///
    /// # Panics
    /// When the folder was not opened with this name.
    pub fn file(&mut self, name: &str) -> &mut impl Write {
        let found = self.files.iter_mut().find(|(known, _)| known == name);
        &mut found.expect("the names are those given to `open`").1
    }

    /// All files with their names, to be written in turn.
    pub fn files(&mut self) -> impl Iterator<Item = (&str, &mut impl Write)> {
        self.files.iter_mut().map(|(name, file)| (&**name, file))
    }

    /// Completes the files and gives them their names.
    ///
    /// # Errors
    /// When the system refuses; earlier results are then left without their seal, or untouched.
    pub fn complete(mut self) -> Result<(), OutputError> {
        let path = self.path.clone();
        let failed =
            |name: &str| OutputError::io(format!("cannot write {}", path.join(name).display()));
        let mut files = Vec::new();
        for (name, writer) in std::mem::take(&mut self.files) {
            let file = writer
                .into_inner()
                .map_err(|error| failed(&name)(error.into_error()))?;
            if let Some(stem) = name.strip_suffix(".svg") {
                for format in PictureFormat::OTHERS {
                    let other = format!("{stem}.{}", format.extension());
                    if self.pictures == Some(format) {
                        let converted = converted(&file, format, &path).map_err(failed(&other))?;
                        files.push((other, converted));
                    } else {
                        self.obsolete.push(other);
                    }
                }
            }
            file.as_file().sync_data().map_err(failed(&name))?;
            files.push((name, file));
        }
        if let Some((seal, _)) = files.last() {
            remove_if_there(&path.join(seal)).map_err(failed(seal))?;
        }
        for name in &self.obsolete {
            remove_if_there(&path.join(name)).map_err(failed(name))?;
        }
        for (name, file) in files {
            file.persist(path.join(&name))
                .map_err(|error| failed(&name)(error.error))?;
        }
        self.made.clear();
        Ok(())
    }
}

impl Drop for Folder {
    /// Removes everything if the results were not completed.
    fn drop(&mut self) {
        self.files.clear();
        for made in self.made.iter().rev() {
            // A folder that holds anything else stays.
            let _ = fs::remove_dir(made);
        }
    }
}

/// A picture in another format, as a hidden file of this folder.
fn converted(
    picture: &NamedTempFile,
    format: PictureFormat,
    folder: &Path,
) -> io::Result<NamedTempFile> {
    let picture = fs::read_to_string(picture.path())?;
    let picture = format.of_picture(&picture).map_err(io::Error::other)?;
    let mut file = tempfile::Builder::new()
        .prefix(PREFIX)
        .permissions_like_others()
        .tempfile_in(folder)?;
    file.write_all(&picture)?;
    file.as_file().sync_data()?;
    Ok(file)
}

/// Locks a folder, for one run alone or for several that write single files. The system unlocks it when the program ends,
/// even if it is killed.
fn lock(path: &Path, alone: bool) -> Result<Option<File>, OutputError> {
    let Ok(folder) = File::open(path) else {
        return Ok(None);
    };
    let locked = if alone {
        folder.try_lock()
    } else {
        folder.try_lock_shared()
    };
    match locked {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(OutputError::InUse {
            folder: path.to_owned(),
        }),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Removes the hidden files of killed runs, as far as possible.
fn remove_abandoned(path: &Path) {
    let entries = fs::read_dir(path).into_iter().flatten().flatten();
    for entry in entries {
        let hidden = entry
            .file_name()
            .to_str()
            .is_some_and(|name| name.starts_with(PREFIX));
        if hidden && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Temporary files are private by default; results get the usual permissions.
trait PermissionsLikeOthers {
    fn permissions_like_others(&mut self) -> &mut Self;
}

#[cfg(unix)]
impl PermissionsLikeOthers for tempfile::Builder<'_, '_> {
    fn permissions_like_others(&mut self) -> &mut Self {
        use std::os::unix::fs::PermissionsExt as _;
        // The system applies the user's umask.
        self.permissions(fs::Permissions::from_mode(0o666))
    }
}

#[cfg(not(unix))]
impl PermissionsLikeOthers for tempfile::Builder<'_, '_> {
    fn permissions_like_others(&mut self) -> &mut Self {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(path: &Path) -> Vec<String> {
        let entries = fs::read_dir(path).unwrap();
        let mut names: Vec<_> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_is_not_completed_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        let mut folder = Folder::open(&path, &["x.csv", "seal.json"]).unwrap();
        folder.file("x.csv").write_all(b"half").unwrap();
        drop(folder);
        assert!(names(root.path()).is_empty());
    }

    #[test]
    fn completed_files_replace_earlier_ones() {
        let root = tempfile::tempdir().unwrap();
        for content in ["one", "two"] {
            let mut folder = Folder::open(root.path(), &["x.csv", "seal.json"]).unwrap();
            folder.forget("old.csv");
            fs::write(root.path().join("old.csv"), "old").unwrap();
            fs::write(root.path().join("mine.txt"), "keep").unwrap();
            folder.file("x.csv").write_all(content.as_bytes()).unwrap();
            folder.complete().unwrap();
            assert_eq!(
                fs::read_to_string(root.path().join("x.csv")).unwrap(),
                content
            );
            assert_eq!(names(root.path()), ["mine.txt", "seal.json", "x.csv"]);
        }
    }

    #[test]
    fn what_a_killed_run_left_goes() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(".archrock-x.csv-dead"), "half").unwrap();
        // A folder is never one of our hidden files, whatever its name.
        fs::create_dir(root.path().join(".archrock-folder")).unwrap();
        let folder = Folder::open(root.path(), &["x.csv", "seal.json"]).unwrap();
        folder.complete().unwrap();
        assert_eq!(
            names(root.path()),
            [".archrock-folder", "seal.json", "x.csv"]
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_is_written_to_by_one_run_at_a_time() {
        let root = tempfile::tempdir().unwrap();
        let all = ["x.csv", "seal.json"];
        let mut working = Folder::open(root.path(), &all).unwrap();
        working.file("x.csv").write_all(b"slow").unwrap();
        let before = names(root.path());
        for files in [&all[..], &all[..1]] {
            let error = Folder::open(root.path(), files).unwrap_err();
            assert!(error.to_string().contains("is being written to"), "{error}");
            assert_eq!(names(root.path()), before);
        }
        working.complete().unwrap();
        assert_eq!(names(root.path()), ["seal.json", "x.csv"]);
        // Runs that write single files do not disturb each other, nor does a hidden file that one leaves behind.
        let mut one = Folder::open(root.path(), &["one.csv"]).unwrap();
        let mut two = Folder::open(root.path(), &["two.csv"]).unwrap();
        assert!(Folder::open(root.path(), &all).is_err());
        for folder in [&mut one, &mut two] {
            let (_, file) = folder.files().next().unwrap();
            file.write_all(b"whole").unwrap();
        }
        one.complete().unwrap();
        two.complete().unwrap();
        for file in ["one.csv", "two.csv"] {
            assert_eq!(fs::read(root.path().join(file)).unwrap(), b"whole");
        }
        drop(Folder::open(root.path(), &all).unwrap());
    }

    #[test]
    fn of_many_that_write_at_once_each_seals_its_own_files() {
        let root = tempfile::tempdir().unwrap();
        let sealed = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for writer in 0..8 {
                let (path, sealed) = (root.path(), &sealed);
                scope.spawn(move || {
                    for turn in 0..50 {
                        let Ok(mut folder) = Folder::open(path, &["a", "b", "seal"]) else {
                            continue;
                        };
                        for (_, file) in folder.files() {
                            write!(file, "{writer} {turn}").unwrap();
                        }
                        folder.complete().unwrap();
                        sealed.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    }
                });
            }
        });
        assert!(sealed.into_inner() > 0);
        let read = |name| fs::read_to_string(root.path().join(name)).unwrap();
        assert_eq!([read("a"), read("b")], [read("seal"), read("seal")]);
        assert_eq!(names(root.path()), ["a", "b", "seal"]);
    }

    #[test]
    fn a_file_in_the_way_is_said() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("file");
        fs::write(&path, "").unwrap();
        let error = Folder::open(&path.join("results"), &["x"]).unwrap_err();
        assert!(error.to_string().contains("file/results"), "{error}");
    }
}
