//! Folders of results: the results of one command get their names together.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempPath};

use super::OutputError;
use super::print::PictureFormat;

/// The results of one command, in a folder and its subfolders.
///
/// The folder and everything below it stay locked as long as this value or a [`Folder`] of it lives: no other command writes there.
/// The system unlocks the folder when the program ends, even if it is killed.
///
/// Every file is written under a hidden name. [`Batch::publish`] removes the results of the last run, then gives all files
/// their names. The seal of each folder is removed first and written last: a folder with a seal holds the results of one run.
///
/// A killed run leaves its hidden files behind; the next run removes them.
#[derive(Clone, Debug)]
pub struct Batch(Arc<Mutex<Inner>>);

#[derive(Debug)]
struct Inner {
    path: PathBuf,
    /// Whether other commands are locked out, rather than only those that lock others out.
    alone: bool,
    /// Hold the locks; empty where folders cannot be locked, as on some network drives and on Windows.
    locks: Vec<File>,
    /// Folders that were created for the results, outermost first.
    made: Vec<PathBuf>,
    /// The complete files of each folder with their paths, still under hidden names, the seal last.
    prepared: Vec<Vec<(PathBuf, TempPath)>>,
    /// Results of earlier runs, in the order in which they are removed.
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
    /// The format of pictures beside SVG.
    pictures: Option<PictureFormat>,
    /// Whether completing it publishes the batch.
    publishes: bool,
    batch: Batch,
}

/// Beginning of the hidden names.
const PREFIX: &str = ".archrock-";

impl Batch {
    /// Locks the folder and everything below it, alone or together with others that do so too; creates the folder if necessary.
    ///
    /// # Errors
    /// When the folder cannot be created, or another command is writing to it, to a folder below it, or to a folder around it.
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

    /// Names the results of the last run, which are removed before the first new file gets its name; returns those that exist. Hidden files
    /// beside them, which a killed run left, are removed at once.
    pub fn replace(&self, results: Vec<PathBuf>) {
        let mut inner = self.inner();
        if inner.alone && !inner.locks.is_empty() {
            for folder in folders(&results) {
                remove_abandoned(folder);
            }
        }
        inner.last = results;
    }

    /// Opens the folder, or one below it, for files with these names, the seal last.
    ///
    /// # Errors
    /// When the folder or a file in it cannot be created.
    pub fn folder(&self, path: &Path, names: &[&str]) -> Result<Folder, OutputError> {
        let mut inner = self.inner();
        // The user may have removed it since it was locked.
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

    /// Gives all complete files their names, after removing the results of the last run.
    ///
    /// # Errors
    /// When the system refuses; the folders are then left without their seals, or untouched.
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
            // A folder that holds anything else stays.
            let _ = fs::remove_dir(folder);
        }
        let (mut files, mut seals) = (Vec::new(), Vec::new());
        for mut folder in prepared {
            seals.extend(folder.pop());
            files.extend(folder);
        }
        // The comparison of several models is prepared last and sealed first: it marks their folders as those of one run.
        for (path, file) in files.into_iter().chain(seals.into_iter().rev()) {
            let persisted = file.persist(&path);
            persisted.map_err(|error| failed(&path)(error.error))?;
        }
        Ok(())
    }

    /// Drops all files that are complete but not published.
    pub fn abandon(&self) {
        self.inner().prepared.clear();
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    /// Creates a folder and missing folders around it.
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

    /// Locks the folder, and shares the lock of every folder around it with others that write below that one.
    fn lock(&mut self) -> Result<(), OutputError> {
        self.locks = lock(&self.path, self.alone)?.into_iter().collect();
        // Links in the path lead to other folders around it.
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
            // A folder that holds anything stays.
            let _ = fs::remove_dir(made);
        }
    }
}

impl Folder {
    /// Opens the folder for the files with these names, the seal last; creates the folder if necessary. [`Folder::complete`] gives the
    /// files their names.
    ///
    /// A single file is replaced in one step and cannot mix with others, so commands that write only one share the lock.
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

    /// Names a result that earlier runs may have left and that this run does not write.
    pub fn forget(&mut self, name: &str) {
        self.obsolete.push(name.to_owned());
    }

    /// This folder with every picture in this format too, beside its SVG.
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

    /// Writes to the file of that name.
    ///
    /// # Errors
    /// When the system refuses.
    ///
    /// # Panics
    /// When the folder was not opened with this name.
    pub fn write(&mut self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let found = self.files.iter_mut().find(|(known, _)| known == name);
        let file = &mut found.expect("the names are those given to `open`").1;
        let written = file.write_all(contents.as_ref());
        written.map_err(self.cannot_write(name))
    }

    /// All files with their names, to be written in turn.
    pub fn files(&mut self) -> impl Iterator<Item = (&str, &mut impl Write)> {
        self.files.iter_mut().map(|(name, file)| (&**name, file))
    }

    /// Adds a file with these contents, which is not the seal. Its name may be that of a file in a subfolder, which is created.
    ///
    /// # Errors
    /// When it cannot be written.
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

    /// Completes the files. They get their names when their batch is published, which a folder that was opened by itself does at once.
    ///
    /// # Errors
    /// When the system refuses; earlier results are then left without their seal, or untouched.
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

    /// A new file under a hidden name.
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

/// A picture in another format.
fn converted(picture: &NamedTempFile, format: PictureFormat) -> io::Result<Vec<u8>> {
    let picture = fs::read_to_string(picture.path())?;
    format.of_picture(&picture).map_err(io::Error::other)
}

/// The folders of these files, each once.
fn folders(files: &[PathBuf]) -> Vec<&Path> {
    let mut folders: Vec<&Path> = files.iter().filter_map(|file| file.parent()).collect();
    folders.sort_unstable();
    folders.dedup();
    folders
}

/// Locks a folder, for one command alone or for several. The system unlocks it when the program ends, even if it is killed.
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
        working.write("x.csv", b"slow").unwrap();
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
