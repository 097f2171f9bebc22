//! Folders of results. All files of one command get their names together.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempPath};

use super::OutputError;
use super::print::PictureFormat;

/// The results of one command, in a folder and its subfolders.
///
/// The folder and everything below it stay locked while this value or one of its [`Folder`]s exists: no other command writes there. The system
/// unlocks the folder when the program ends, even if the program is killed.
///
/// Every file is written under a hidden name. [`Batch::publish`] removes the results of the last run, then renames all files. The seal of each
/// folder is removed first and written last: a folder with a seal contains complete results of one run.
///
/// A killed run leaves its hidden files; the next run removes them.
#[derive(Clone, Debug)]
pub struct Batch(Arc<Mutex<Inner>>);

#[derive(Debug)]
struct Inner {
    path: PathBuf,
    /// True for an exclusive lock; false for a lock that is shared with other commands.
    alone: bool,
    /// The locks; empty if folders cannot be locked, as on some network drives and on Windows.
    locks: Vec<File>,
    /// Folders that were created for the results, the outermost first.
    made: Vec<PathBuf>,
    /// The complete files of each folder, still under hidden names, with their final paths; the seal last.
    prepared: Vec<Vec<(PathBuf, TempPath)>>,
    /// Results of earlier runs, in the order of removal.
    last: Vec<PathBuf>,
}

/// A folder in which results are being prepared.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Complete files, still under hidden names.
    done: Vec<(String, TempPath)>,
    files: Vec<(String, BufWriter<NamedTempFile>)>,
    /// Names of results that earlier runs may have left and that this run does not write.
    obsolete: Vec<String>,
    /// Format of pictures in addition to SVG.
    pictures: Option<PictureFormat>,
    /// True if completing the folder publishes the batch.
    publishes: bool,
    batch: Batch,
}

/// Prefix of the hidden names.
const PREFIX: &str = ".archrock-";

impl Batch {
    /// Locks the folder and everything below it, exclusively if `alone`, otherwise shared. Creates the folder if necessary.
    ///
    /// # Errors
    /// When the folder cannot be created, or another command is writing to this folder, a folder below it or a folder above it.
    pub fn lock(path: &Path, alone: bool) -> Result<Self, OutputError> {
        let mut inner = Inner {
            path: path.to_owned(),
            alone,
            locks: Vec::new(),
            made: Vec::new(),
            prepared: Vec::new(),
            last: Vec::new(),
        };
        inner.make(path)?;
        inner.lock()?;
        Ok(Self(Arc::new(Mutex::new(inner))))
    }

    /// Sets the results of the last run. They are removed just before the new files get their names. Hidden files that a killed run left beside
    /// them are removed immediately.
    pub fn replace(&self, results: Vec<PathBuf>) {
        let mut inner = self.inner();
        if inner.alone && !inner.locks.is_empty() {
            for folder in folders(&results) {
                remove_abandoned(folder);
            }
        }
        inner.last = results;
    }

    /// Opens the folder, or a folder below it, for files with these names, the seal last.
    ///
    /// # Errors
    /// When the folder or a file in it cannot be created.
    pub fn folder(&self, path: &Path, names: &[&str]) -> Result<Folder, OutputError> {
        let mut inner = self.inner();
        // The user may have removed the folder since it was locked.
        let root = inner.path.clone();
        if !root.exists() {
            inner.make(&root)?;
            inner.lock()?;
        }
        inner.make(path)?;
        drop(inner);
        let mut folder = Folder {
            path: path.to_owned(),
            done: Vec::new(),
            files: Vec::new(),
            obsolete: Vec::new(),
            pictures: None,
            publishes: false,
            batch: self.clone(),
        };
        for name in names {
            let file = folder.hidden(name)?;
            let file = (String::from(*name), BufWriter::new(file));
            folder.files.push(file);
        }
        Ok(folder)
    }

    /// Removes the results of the last run, then gives all complete files their names.
    ///
    /// # Errors
    /// When the system reports an error. The folders are then without their seals, or unchanged.
    pub fn publish(&self) -> Result<(), OutputError> {
        let mut inner = self.inner();
        let failed = |path: &Path| OutputError::io(format!("cannot write {}", path.display()));
        let prepared = std::mem::take(&mut inner.prepared);
        let last = std::mem::take(&mut inner.last);
        let seals = prepared.iter().filter_map(|files| files.last());
        for path in seals.map(|(path, _)| path).chain(&last) {
            remove_if_there(path).map_err(failed(path))?;
        }
        let mut emptied: Vec<&Path> = folders(&last);
        emptied.sort_by_key(|folder| std::cmp::Reverse(folder.components().count()));
        for folder in emptied.into_iter().filter(|folder| *folder != inner.path) {
            // A folder with other files stays.
            let _ = fs::remove_dir(folder);
        }
        let (mut files, mut seals) = (Vec::new(), Vec::new());
        for mut folder in prepared {
            seals.extend(folder.pop());
            files.extend(folder);
        }
        // The comparison of several models is prepared last and sealed first: it shows that the folders of the models belong to one run.
        for (path, file) in files.into_iter().chain(seals.into_iter().rev()) {
            let persisted = file.persist(&path);
            persisted.map_err(|error| failed(&path)(error.error))?;
        }
        Ok(())
    }

    /// Deletes all files that are complete but not published.
    pub fn abandon(&self) {
        self.inner().prepared.clear();
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    /// Creates a folder and its missing parent folders.
    fn make(&mut self, path: &Path) -> Result<(), OutputError> {
        for ancestor in path.ancestors().collect::<Vec<_>>().into_iter().rev() {
            if ancestor.as_os_str().is_empty() || ancestor.exists() {
                continue;
            }
            match fs::create_dir(ancestor) {
                Ok(()) => self.made.push(ancestor.to_owned()),
                // Another run created it first.
                Err(_) if ancestor.is_dir() => {}
                Err(error) => {
                    let what = format!("cannot make the folder {}", ancestor.display());
                    return Err(OutputError::io(what)(error));
                }
            }
        }
        Ok(())
    }

    /// Locks the folder, and takes shared locks of all folders above it.
    fn lock(&mut self) -> Result<(), OutputError> {
        self.locks = lock(&self.path, self.alone)?.into_iter().collect();
        // With links in the path, the folders above differ from those in the path.
        let canonical = self.path.canonicalize().unwrap_or_default();
        for around in canonical.ancestors().skip(1) {
            self.locks.extend(lock(around, false)?);
        }
        if self.alone && !self.locks.is_empty() {
            remove_abandoned(&self.path);
        }
        Ok(())
    }
}

impl Drop for Inner {
    /// Removes everything that was not published.
    fn drop(&mut self) {
        self.prepared.clear();
        for made in self.made.iter().rev() {
            // A folder that is not empty stays.
            let _ = fs::remove_dir(made);
        }
    }
}

impl Folder {
    /// Opens the folder for files with these names, the seal last; creates the folder if necessary. [`Folder::complete`] gives the files their
    /// names.
    ///
    /// A single file is replaced in one step and cannot mix with others. So commands that write a single file share the lock.
    ///
    /// # Errors
    /// When the folder or a file in it cannot be created, or another command is writing to it.
    pub fn open(path: &Path, names: &[&str]) -> Result<Self, OutputError> {
        let batch = Batch::lock(path, names.len() > 1)?;
        Ok(Self {
            publishes: true,
            ..batch.folder(path, names)?
        })
    }

    /// Adds the name of a result that earlier runs may have left and that this run does not write.
    pub fn forget(&mut self, name: &str) {
        self.obsolete.push(name.to_owned());
    }

    /// Sets the format in which pictures are written in addition to SVG.
    #[must_use]
    pub fn with_pictures(mut self, pictures: Option<PictureFormat>) -> Self {
        self.pictures = pictures;
        self
    }

    /// Returns the path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes to the file with this name.
    ///
    /// # Errors
    /// When the system reports an error.
    ///
    /// # Panics
    /// When the folder was not opened with this name.
    pub fn write(&mut self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let found = self.files.iter_mut().find(|(known, _)| known == name);
        let file = &mut found.expect("the names are those given to `open`").1;
        let written = file.write_all(contents.as_ref());
        written.map_err(self.cannot_write(name))
    }

    /// Returns all files with their names, to be written.
    pub fn files(&mut self) -> impl Iterator<Item = (&str, &mut impl Write)> {
        self.files.iter_mut().map(|(name, file)| (&**name, file))
    }

    /// Adds a file with these contents. It is not the seal. The name may be in a subfolder, which is created.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn add(&mut self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        if let Some(folder) = self.path.join(name).parent() {
            self.batch.inner().make(folder)?;
        }
        let mut file = self.hidden(name)?;
        let written = file.write_all(contents);
        written
            .and_then(|()| file.as_file().sync_data())
            .map_err(self.cannot_write(name))?;
        self.done
            .insert(0, (name.to_owned(), file.into_temp_path()));
        Ok(())
    }

    /// Completes the files. They get their names when the batch is published; [`Folder::open`] makes a batch that is published here.
    ///
    /// # Errors
    /// When the system reports an error. Earlier results are then without their seal, or unchanged.
    pub fn complete(mut self) -> Result<(), OutputError> {
        for (name, writer) in std::mem::take(&mut self.files) {
            let file = writer
                .into_inner()
                .map_err(|error| self.cannot_write(&name)(error.into_error()))?;
            if let Some(stem) = name.strip_suffix(".svg") {
                for format in PictureFormat::OTHERS {
                    let other = format!("{stem}.{}", format.name());
                    if self.pictures == Some(format) {
                        let bytes = converted(&file, format).map_err(self.cannot_write(&other))?;
                        self.add(&other, &bytes)?;
                    } else {
                        self.obsolete.push(other);
                    }
                }
            }
            file.as_file()
                .sync_data()
                .map_err(self.cannot_write(&name))?;
            self.done.push((name, file.into_temp_path()));
        }
        let files = self.done.drain(..);
        let files = files.map(|(name, file)| (self.path.join(name), file));
        let files = files.collect();
        let mut inner = self.batch.inner();
        inner.prepared.push(files);
        inner
            .last
            .extend(self.obsolete.iter().map(|name| self.path.join(name)));
        drop(inner);
        if self.publishes {
            self.batch.publish()?;
        }
        Ok(())
    }

    /// Creates a file under a hidden name.
    fn hidden(&self, name: &str) -> Result<NamedTempFile, OutputError> {
        let path = self.path.join(name);
        let name_alone = path.file_name().unwrap_or_default().to_string_lossy();
        let prefix = format!("{PREFIX}{name_alone}-");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        // Temporary files are private by default; results get the usual permissions, to which the system applies the user's umask.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder
            .tempfile_in(path.parent().unwrap_or(&self.path))
            // The system's message would name the hidden file.
            .map_err(|error| self.cannot_write(name)(error.kind().into()))
    }

    fn cannot_write(&self, name: &str) -> impl FnOnce(io::Error) -> OutputError + use<> {
        OutputError::io(format!("cannot write {}", self.path.join(name).display()))
    }
}

/// Converts a picture to another format.
fn converted(picture: &NamedTempFile, format: PictureFormat) -> io::Result<Vec<u8>> {
    let picture = fs::read_to_string(picture.path())?;
    format.of_picture(&picture).map_err(io::Error::other)
}

/// Returns the folders of these files, without duplicates.
fn folders(files: &[PathBuf]) -> Vec<&Path> {
    let mut folders: Vec<&Path> = files.iter().filter_map(|file| file.parent()).collect();
    folders.sort_unstable();
    folders.dedup();
    folders
}

/// Locks a folder, exclusively or shared; `None` if the folder cannot be locked. The system unlocks it when the program ends, even if it is
/// killed.
fn lock(path: &Path, alone: bool) -> Result<Option<File>, OutputError> {
    let Ok(folder) = File::open(path) else {
        return Ok(None);
    };
    let locked = match alone {
        true => folder.try_lock(),
        false => folder.try_lock_shared(),
    };
    match locked {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(OutputError::InUse {
            folder: path.to_owned(),
        }),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Removes the hidden files of killed runs if possible.
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
        folder.write("x.csv", b"half").unwrap();
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
            folder.write("x.csv", content.as_bytes()).unwrap();
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
        // A folder stays even if its name is that of a hidden file.
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
        working.write("x.csv", b"slow").unwrap();
        let before = names(root.path());
        for files in [&all[..], &all[..1]] {
            let error = Folder::open(root.path(), files).unwrap_err();
            assert!(error.to_string().contains("is being written to"), "{error}");
            assert_eq!(names(root.path()), before);
        }
        working.complete().unwrap();
        assert_eq!(names(root.path()), ["seal.json", "x.csv"]);
        // Runs that write single files can share a folder, also with a hidden file of an interrupted run.
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
