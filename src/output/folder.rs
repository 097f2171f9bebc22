//! Folders of results. All files of one command get their names together.

use std::cell::RefCell;
use std::collections::{BTreeSet, VecDeque};
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, IntoInnerError, Write as _};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::{fmt, mem};

use tempfile::TempPath;

use super::PictureFormat;
use super::manifest::{MANIFEST, Manifest, Origin, command_line};
use super::{OutputError, is_too_many_files, pretty};
use crate::scenario::ModelKind;

/// The folder for the results of one command, or a folder inside it.
///
/// The folder and everything below it stay locked while this value or a clone of it exists: no other command writes there. The system unlocks
/// the folder when the program ends, even if the program is killed.
///
/// Every file is written under a hidden name. [`Folder::publish`] gives all files their names: they replace the results of the last run of the
/// same command, which the [`Manifest`] of the folder lists. The manifest is the seal: results that it calls complete are those of one run. A
/// file that it does not list, or that the scenario needs, is never removed or replaced, and no result is written through a link.
///
/// A run that is killed, or cannot publish its results, leaves its hidden files; the next run removes them.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
    /// Format of pictures in addition to SVG.
    pub pictures: Option<PictureFormat>,
    locked: Rc<RefCell<LockedFolder>>,
}

/// The folder that a command has locked, with the results that it has prepared.
#[derive(Debug)]
struct LockedFolder {
    path: PathBuf,
    /// The name of the command in the manifest.
    command: String,
    origin: Origin,
    manifest: Manifest,
    /// True for an exclusive lock; false for a lock that is shared with other commands.
    alone: bool,
    /// The locks; empty if folders cannot be locked, as on some network drives and on Windows.
    locks: Vec<File>,
    /// Folders that were created for the results, the outermost first.
    made: Vec<PathBuf>,
    /// The complete files, still under hidden names, with their final names relative to the folder.
    prepared: VecDeque<(String, TempPath)>,
}

/// The paths of complete results that stay under hidden names until the next run, because they could not get their names.
#[derive(Debug)]
pub struct UnpublishedFiles(Vec<PathBuf>);

/// A file of results that is being written, under a hidden name.
#[derive(Debug)]
pub(crate) struct NewFile {
    /// The path that it will have.
    path: PathBuf,
    hidden: TempPath,
    pub(crate) writer: BufWriter<File>,
}

/// Prefix of the hidden names.
const PREFIX: &str = ".archrock-";
/// Largest number of characters that a hidden name has from the name of its result.
const HIDDEN_CHARACTERS: usize = 50;

/// The paths, in a sentence about them.
impl fmt::Display for UnpublishedFiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Largest number of files that are listed.
        const LISTED: usize = 12;
        let listed = self.0.iter().take(LISTED);
        let listed: Vec<_> = listed.map(|path| path.display().to_string()).collect();
        let paths = listed.join(", ");
        write!(
            f,
            "complete results stay under hidden names until the next run: {paths}"
        )?;
        match self.0.len() - listed.len() {
            0 => Ok(()),
            more => write!(f, ", and {more} more"),
        }
    }
}

impl Folder {
    /// Locks the folder and everything below it for the results of a command, exclusively if `alone`, otherwise shared. Creates the folder if
    /// necessary.
    ///
    /// # Errors
    /// When the folder cannot be created, another command is writing to this folder, a folder below it or a folder above it, the folder is named
    /// after a scenario file and has results of another one, or an earlier result of the command is now an input of the scenario.
    pub fn lock(
        path: &Path,
        command: &str,
        origin: Origin,
        alone: bool,
    ) -> Result<Self, OutputError> {
        let mut locked = LockedFolder {
            path: path.to_owned(),
            command: command.to_owned(),
            origin,
            manifest: Manifest::default(),
            alone,
            locks: Vec::new(),
            made: Vec::new(),
            prepared: VecDeque::new(),
        };
        locked.make_and_lock()?;
        if let Some(other) = locked.manifest.other_scenario(command, &locked.origin) {
            return Err(OutputError::OfOtherScenario(path.to_owned(), other));
        }
        locked.check_last()?;
        Ok(Self {
            path: path.to_owned(),
            pictures: None,
            locked: Rc::new(RefCell::new(locked)),
        })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns a folder inside this one, which shares the lock.
    #[must_use]
    pub fn within(&self, name: impl AsRef<Path>) -> Self {
        let path = self.path.join(name);
        Self {
            path,
            ..self.clone()
        }
    }

    /// Returns the folder for a model of motion: a folder inside this one if there are several models.
    #[must_use]
    pub fn of_model(&self, model: &ModelKind, several: bool) -> Self {
        match several {
            true => self.within(model.option),
            false => self.clone(),
        }
    }

    /// Returns an error if files with these names cannot be written here.
    ///
    /// # Errors
    /// When one of them is an input of the scenario, or is there and is no earlier result of the command, or a folder in its path is a link.
    pub fn check(&self, names: &[&str]) -> Result<(), OutputError> {
        let locked = self.locked.borrow();
        locked.check_folders(&self.path)?;
        let mut paths = names.iter().map(|name| self.path.join(name));
        paths.try_for_each(|path| locked.check(&path))
    }

    /// Protects the inputs of a further scenario whose results go into the locked folder.
    ///
    /// # Errors
    /// When an earlier result of the command is one of these inputs.
    pub fn protect(&self, origin: &Origin) -> Result<(), OutputError> {
        let mut locked = self.locked.borrow_mut();
        locked.origin.protect(origin);
        locked.check_last()
    }

    /// Returns true if another command has a result with this name here.
    pub fn is_of_other_command(&self, name: &str) -> bool {
        let locked = self.locked.borrow();
        let file = locked.relative(&self.path.join(name));
        locked.manifest.is_of_other(&locked.command, &file)
    }

    /// Returns warnings about results of other commands in the locked folder that come from another scenario.
    pub fn warnings(&self) -> Vec<String> {
        let LockedFolder {
            path,
            command,
            origin,
            manifest,
            ..
        } = &*self.locked.borrow();
        manifest.warnings(path, command, origin)
    }

    /// Creates a file that is written in pieces.
    ///
    /// # Errors
    /// When the file cannot be created, or as for [`Folder::check`].
    pub(crate) fn create(&self, name: &str) -> Result<NewFile, OutputError> {
        let (path, mut locked) = (self.path.join(name), self.locked.borrow_mut());
        // The user may have removed the folder since it was locked.
        if !locked.path.exists() {
            locked.make_and_lock()?;
        }
        locked.check(&path)?;
        let (file, hidden) = hidden_file(&locked.path, &locked.relative(&path))
            .map_err(OutputError::unusable(cannot_write(&path)))?;
        let writer = BufWriter::new(file);
        Ok(NewFile {
            path,
            hidden,
            writer,
        })
    }

    /// Completes a file. It gets its name when the results are published.
    ///
    /// # Errors
    /// When the system reports an error.
    pub(crate) fn complete(&self, file: NewFile) -> Result<(), OutputError> {
        let written = file.writer.into_inner();
        let written = written.map_err(IntoInnerError::into_error);
        let synced = written.and_then(|written| written.sync_data());
        synced.map_err(OutputError::io(cannot_write(&file.path)))?;
        let mut locked = self.locked.borrow_mut();
        let name = locked.relative(&file.path);
        locked.prepared.push_back((name, file.hidden));
        Ok(())
    }

    /// Adds a complete file. The name may be in a subfolder.
    ///
    /// # Errors
    /// When the file cannot be written, or as for [`Folder::check`].
    pub fn add(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        let mut file = self.create(name)?;
        let written = file.writer.write_all(contents);
        written.map_err(OutputError::io(cannot_write(&file.path)))?;
        self.complete(file)
    }

    /// Adds a complete file, and a picture also in the other format. The last file of a command is its seal.
    ///
    /// # Errors
    /// When a file cannot be written, or as for [`Folder::check`].
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        let other = self.pictures.filter(|format| *format != PictureFormat::Svg);
        if let Some((stem, format)) = name.strip_suffix(".svg").zip(other) {
            let other = format!("{stem}.{}", format.name());
            let picture = format.of_picture(&String::from_utf8_lossy(contents));
            let what = cannot_write(&self.path.join(&other));
            let picture = picture.map_err(io::Error::other);
            self.add(&other, &picture.map_err(OutputError::io(what))?)?;
        }
        self.add(name, contents)
    }

    /// Gives all complete files their names, in place of the results of the last run of the command. Does nothing if there are none.
    ///
    /// The manifest calls the results incomplete until all new files have replaced the earlier ones, and those without a successor are removed.
    ///
    /// # Errors
    /// When the system reports an error, or as for [`Folder::check`]. The manifest then calls the results incomplete, or they are unchanged. All
    /// files that have not got their names stay under hidden names, which the error lists.
    pub fn publish(&self) -> Result<(), OutputError> {
        if self.locked.borrow().prepared.is_empty() {
            return Ok(());
        }
        let exchanged = self.locked.borrow_mut().exchange();
        exchanged.map_err(|cause| match self.keep() {
            None => cause,
            Some(files) => OutputError::Unpublished(Box::new(cause), files),
        })
    }

    /// Leaves all complete files under hidden names until the next run. Returns their paths; `None` if there are none.
    pub fn keep(&self) -> Option<UnpublishedFiles> {
        let mut locked = self.locked.borrow_mut();
        let prepared = mem::take(&mut locked.prepared);
        let kept = prepared.into_iter().filter_map(|(_, file)| {
            let kept = file.keep().ok()?;
            Some(locked.path.join(kept.file_name()?))
        });
        let kept: Vec<PathBuf> = kept.collect();
        (!kept.is_empty()).then_some(UnpublishedFiles(kept))
    }

    /// Deletes all files that are complete but not published, in this folder and below it.
    pub fn abandon(&self) {
        let mut locked = self.locked.borrow_mut();
        let below = locked.relative(&self.path);
        locked
            .prepared
            .retain(|(name, _)| !Path::new(name).starts_with(&below));
    }
}

impl LockedFolder {
    /// Creates the folder and its missing parent folders, locks it, takes shared locks of all folders above it, and reads the manifest.
    fn make_and_lock(&mut self) -> Result<(), OutputError> {
        for folder in self.path.ancestors().collect::<Vec<_>>().into_iter().rev() {
            if folder.as_os_str().is_empty() || folder.exists() {
                continue;
            }
            match fs::create_dir(folder) {
                Ok(()) => self.made.push(folder.to_owned()),
                // Another run created it first.
                Err(_) if folder.is_dir() => {}
                Err(error) => {
                    let what = format!("cannot make the folder {}", folder.display());
                    return Err(OutputError::unusable(what)(error));
                }
            }
        }
        self.locks = lock(&self.path, self.alone)?.into_iter().collect();
        // With links in the path, the folders above differ from those in the path.
        let canonical = self.path.canonicalize().unwrap_or_default();
        for around in canonical.ancestors().skip(1) {
            self.locks.extend(lock(around, false)?);
        }
        if self.alone && !self.locks.is_empty() {
            remove_abandoned(&self.path);
        }
        self.manifest = Manifest::read(&self.path)?;
        Ok(())
    }

    /// The results of the last run of the command.
    fn last(&self) -> &[String] {
        self.manifest.files(&self.command)
    }

    /// Returns an error if one of these results is now an input of the scenario.
    fn check_last(&self) -> Result<(), OutputError> {
        let mut last = self.last().iter();
        last.try_for_each(|name| self.check(&self.path.join(name)))
    }

    /// Returns the name of a path in the folder, relative to it.
    fn relative(&self, path: &Path) -> String {
        let below = path.strip_prefix(&self.path).unwrap_or(path);
        let parts = below.iter().map(|part| part.to_string_lossy());
        parts.collect::<Vec<_>>().join("/")
    }

    /// Returns an error if a result with this path would replace an input of the scenario, or anything else than an earlier result of the command,
    /// or would be written through a link.
    fn check(&self, path: &Path) -> Result<(), OutputError> {
        if self.origin.is_input(path) {
            return Err(OutputError::IsInput(path.to_owned()));
        }
        self.check_folders(path.parent().unwrap_or(path))?;
        match path.symlink_metadata() {
            Err(_) => Ok(()),
            Ok(_) if !self.last().contains(&self.relative(path)) => Err(self.taken(path)),
            Ok(found) if found.is_file() => Ok(()),
            Ok(_) => Err(OutputError::NoFile(path.to_owned())),
        }
    }

    /// Returns an error if one of these folders, up to the locked one, is a link or another file.
    fn check_folders(&self, folder: &Path) -> Result<(), OutputError> {
        let folders = folder.ancestors();
        let mut folders = folders.take_while(|folder| *folder != self.path);
        folders.try_for_each(|folder| match folder.symlink_metadata() {
            Ok(found) if found.is_symlink() => Err(OutputError::IsLink(folder.to_owned())),
            Ok(found) if !found.is_dir() => Err(self.taken(folder)),
            _ => Ok(()),
        })
    }

    fn taken(&self, path: &Path) -> OutputError {
        OutputError::Taken {
            path: path.to_owned(),
            command: command_line(&self.command).to_owned(),
        }
    }

    /// Gives the complete files their names between two manifests, of which the first calls the results incomplete. On an error the others stay
    /// prepared.
    fn exchange(&mut self) -> Result<(), OutputError> {
        let names = self.prepared.iter().map(|(name, _)| name.clone());
        let new: Vec<String> = names.collect();
        let mut paths = new.iter().chain(self.last());
        paths.try_for_each(|name| self.check(&self.path.join(name)))?;
        let kept: BTreeSet<&String> = new.iter().collect();
        let last = self.last().iter().filter(|name| !kept.contains(name));
        let stale: Vec<String> = last.cloned().collect();
        self.list([&stale[..], &new].concat(), false)?;
        while let Some((name, file)) = self.prepared.pop_front() {
            let path = self.path.join(&name);
            let placed = match prepare_place(&path) {
                Ok(()) => file.persist(&path).map_err(|it| (it.error, it.path)),
                Err(error) => Err((error, file)),
            };
            placed.map_err(|(error, file)| {
                self.prepared.push_front((name, file));
                OutputError::io(cannot_write(&path))(error)
            })?;
        }
        for path in stale.iter().map(|name| self.path.join(name)) {
            let cannot = format!("cannot remove {}", path.display());
            remove_if_there(&path).map_err(OutputError::io(cannot))?;
            let folders = path.ancestors().skip(1);
            for folder in folders.take_while(|folder| *folder != self.path) {
                // A folder with other files stays.
                let _ = fs::remove_dir(folder);
            }
        }
        self.list(new, true)
    }

    /// Writes the manifest with these results of the command.
    fn list(&mut self, files: Vec<String>, complete: bool) -> Result<(), OutputError> {
        let path = self.path.join(MANIFEST);
        self.manifest
            .set(&self.command, &self.origin, files, complete);
        let text = serde_json::to_value(&self.manifest).map(|it| pretty(&it));
        let text = text.map_err(io::Error::from);
        let written = text.and_then(|text| write_whole(&path, text.as_bytes()));
        written.map_err(OutputError::io(cannot_write(&path)))
    }
}

impl Drop for LockedFolder {
    /// Removes everything that was not published.
    fn drop(&mut self) {
        self.prepared.clear();
        for made in self.made.iter().rev() {
            // A folder that is not empty stays.
            let _ = fs::remove_dir(made);
        }
    }
}

fn cannot_write(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

/// Makes the folder of a result that gets its name.
fn prepare_place(path: &Path) -> io::Result<()> {
    #[cfg(test)]
    tests::before_change(path)?;
    fs::create_dir_all(path.parent().unwrap_or(path))
}

/// Creates a file under a hidden name in a folder, for a result with this name.
fn hidden_file(folder: &Path, name: &str) -> io::Result<(File, TempPath)> {
    let name = name.replace('/', "-");
    let skipped = name.chars().count().saturating_sub(HIDDEN_CHARACTERS);
    let name: String = name.chars().skip(skipped).collect();
    let prefix = format!("{PREFIX}{name}-");
    // Temporary files are private by default; results get the usual permissions.
    let mut named = tempfile::Builder::new();
    let named = named
        .prefix(&prefix)
        .make_in(folder, |path| File::create_new(path))?;
    Ok(named.into_parts())
}

/// Writes a file that no manifest lists, because the user named it. It replaces only an earlier one that begins alike, or a film by a film.
///
/// # Errors
/// When the system reports an error, or the file is there and was not written by this program.
pub fn write_named_file(path: &Path, contents: &[u8]) -> Result<(), OutputError> {
    let cannot = || OutputError::io(cannot_write(path));
    if path.exists() && !path.is_file() {
        // A device, such as that of standard output.
        return fs::write(path, contents).map_err(cannot());
    }
    if path.exists() {
        let earlier = fs::read(path).map_err(cannot())?;
        // Another text may name this program too: a scenario does.
        let are_films = names_program(&earlier) && names_program(contents);
        if beginning(&earlier) != beginning(contents) && !are_films {
            return Err(OutputError::NotWrittenHere(path.to_owned()));
        }
    }
    check_folder_of(path)?;
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    write_whole(&path, contents).map_err(cannot())
}

/// Checks, before long work, that a film can be written to a file that the user named: its folder exists, and the file is absent or an earlier film.
///
/// # Errors
/// When the folder does not exist, or the file is there and was not written by this program.
pub fn check_named_file(path: &Path) -> Result<(), OutputError> {
    check_folder_of(path)?;
    if !path.exists() {
        return Ok(());
    }
    let earlier = fs::read(path).map_err(OutputError::unusable(cannot_write(path)))?;
    match names_program(&earlier) {
        true => Ok(()),
        false => Err(OutputError::NotWrittenHere(path.to_owned())),
    }
}

/// Returns an error if there is no folder for a file that the user named.
fn check_folder_of(path: &Path) -> Result<(), OutputError> {
    match folder_of(path) {
        folder if folder.is_dir() => Ok(()),
        folder => Err(OutputError::NoFolder(path.to_owned(), folder.to_owned())),
    }
}

/// Returns the folder of a file; `.` for a name alone.
fn folder_of(path: &Path) -> &Path {
    let folder = path.parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// Returns true if a file names this program, as films do.
fn names_program(contents: &[u8]) -> bool {
    let name = env!("CARGO_PKG_NAME").as_bytes();
    contents.windows(name.len()).any(|part| part == name)
}

/// Writes a file under a hidden name, and then gives it its name, so the file is complete or absent.
fn write_whole(path: &Path, contents: &[u8]) -> io::Result<()> {
    #[cfg(test)]
    tests::before_change(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (mut file, hidden) = hidden_file(folder_of(path), &name)?;
    file.write_all(contents)?;
    file.sync_data()?;
    Ok(hidden.persist(path)?)
}

/// Returns what files of one kind have in common: the first line of a text without its numbers, and the first bytes of other files.
fn beginning(contents: &[u8]) -> String {
    const BYTES: usize = 24;
    let first = contents
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default();
    match str::from_utf8(contents) {
        Ok(_) => String::from_utf8_lossy(first)
            .replace("mm\"", "\"")
            .replace(|it: char| it.is_ascii_digit() || it == '.', ""),
        Err(_) => format!("{:?}", &contents[..contents.len().min(BYTES)]),
    }
}

/// Locks a folder, exclusively or shared; `None` if the folder cannot be locked. The system unlocks it when the program ends, even if it is
/// killed.
fn lock(path: &Path, alone: bool) -> Result<Option<File>, OutputError> {
    let folder = match File::open(path) {
        Ok(folder) => folder,
        Err(error) if is_too_many_files(&error) => {
            let what = format!("cannot lock the folder {}", path.display());
            return Err(OutputError::io(what)(error));
        }
        Err(_) => return Ok(None),
    };
    let locked = match alone {
        true => folder.try_lock(),
        false => folder.try_lock_shared(),
    };
    match locked {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(OutputError::InUse(path.to_owned())),
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
    #[cfg(test)]
    tests::before_change(path)?;
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Called with the path before a file is written at once, gets its name or is removed. An error prevents the change.
    type BeforeChange = Box<dyn FnMut(&Path) -> io::Result<()>>;

    thread_local! {
        static BEFORE_CHANGE: RefCell<Option<BeforeChange>> = const { RefCell::new(None) };
    }

    pub(super) fn before_change(path: &Path) -> io::Result<()> {
        BEFORE_CHANGE.with_borrow_mut(|hook| hook.as_mut().map_or(Ok(()), |hook| hook(path)))
    }

    /// Does work with this action before each change.
    fn with_changes<T>(hook: BeforeChange, work: impl FnOnce() -> T) -> T {
        BEFORE_CHANGE.set(Some(hook));
        let done = work();
        BEFORE_CHANGE.set(None);
        done
    }

    /// All files below a folder, by their paths relative to it.
    fn contents(folder: &Path) -> BTreeMap<String, String> {
        let mut all = BTreeMap::new();
        for name in names(folder) {
            let path = folder.join(&name);
            if path.is_dir() {
                let inner = contents(&path).into_iter();
                all.extend(inner.map(|(inner, text)| (format!("{name}/{inner}"), text)));
            } else {
                all.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
        all
    }

    /// Copies a folder as a kill would leave it.
    fn copy(from: &Path, to: &Path) {
        for (name, text) in contents(from) {
            fs::create_dir_all(to.join(&name).parent().unwrap()).unwrap();
            fs::write(to.join(name), text).unwrap();
        }
    }

    const OLD: [&str; 4] = ["a/x.csv", "b/x.csv", "x.csv", "seal.json"];
    const NEW: [&str; 4] = ["b/x.csv", "c/x.csv", "x.csv", "seal.json"];
    /// Changes when the new files replace the old ones: of two manifests, of the names of four files, and the removal of a file.
    const CHANGES: usize = 7;

    /// Asserts that a folder has the old results, the new ones, or an incomplete seal. Returns true for a complete seal.
    #[track_caller]
    fn assert_of_one_run(folder: &Path, name: &str) -> bool {
        let mut found = contents(folder);
        found.retain(|name, _| !name.starts_with(PREFIX));
        let seal = found.remove(MANIFEST).unwrap();
        let seal: serde_json::Value = serde_json::from_str(&seal).unwrap();
        let all = |names: [&str; 4], text: &str| {
            let all = names.map(|name| (name.to_owned(), text.to_owned()));
            found == BTreeMap::from(all)
        };
        let is_complete = seal["results"]["run"]["complete"] == true;
        assert!(
            !is_complete || all(OLD, "old") || all(NEW, "new"),
            "{name}: {found:?}"
        );
        is_complete
    }

    /// Asserts that the next run replaces whatever is in a folder.
    #[track_caller]
    fn assert_next_run(folder: &Path) {
        write(folder, &NEW, "new").unwrap();
        assert!(assert_of_one_run(folder, "next run"));
        assert!(names(folder).iter().all(|name| !name.starts_with(PREFIX)));
    }

    #[test]
    fn a_kill_at_any_change_leaves_results_of_one_run_or_an_incomplete_seal() {
        let root = tempfile::tempdir().unwrap();
        let (path, kills) = (root.path().join("o"), root.path().join("kills"));
        write(&path, &OLD, "old").unwrap();
        let (from, to) = (path.clone(), kills.clone());
        let mut count = 0;
        let kill = Box::new(move |_: &Path| {
            copy(&from, &to.join(count.to_string()));
            count += 1;
            Ok(())
        });
        with_changes(kill, || write(&path, &NEW, "new")).unwrap();
        assert!(assert_of_one_run(&path, "the end"));
        assert_eq!(names(&kills).len(), CHANGES);
        for (index, name) in names(&kills).into_iter().enumerate() {
            let killed = kills.join(&name);
            assert_eq!(assert_of_one_run(&killed, &name), index == 0, "{name}");
            assert_next_run(&killed);
        }
    }

    #[test]
    fn a_failure_at_any_change_keeps_all_new_files() {
        for failing in 0..CHANGES {
            let root = tempfile::tempdir().unwrap();
            let path = root.path().join("o");
            write(&path, &OLD, "old").unwrap();
            let mut count = 0;
            let fails = Box::new(move |_: &Path| {
                count += 1;
                let is_failing = count == failing + 1;
                let full = io::Error::from(io::ErrorKind::StorageFull);
                if is_failing { Err(full) } else { Ok(()) }
            });
            let error = with_changes(fails, || write(&path, &NEW, "new")).unwrap_err();
            assert_eq!(assert_of_one_run(&path, "failure"), failing == 0);
            let found = contents(&path);
            let hidden: Vec<_> = found
                .keys()
                .filter(|name| name.starts_with(PREFIX))
                .collect();
            // Each new file is whole, under its name or a hidden one.
            let new = found.values().filter(|text| *text == "new").count();
            assert_eq!((new, hidden.len()), (4, [4, 4, 3, 2, 1, 0, 0][failing]));
            let said = error.to_string();
            for name in hidden {
                assert!(
                    said.contains(&path.join(name).display().to_string()),
                    "{said}"
                );
            }
            assert!(said.contains("df -i"), "{said}");
            assert_next_run(&path);
        }
    }

    #[test]
    fn no_result_replaces_a_folder_or_is_written_through_a_link() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("o");
        write(&path, &OLD, "old").unwrap();
        fs::remove_file(path.join("x.csv")).unwrap();
        fs::create_dir(path.join("x.csv")).unwrap();
        let before = contents(&path);
        let error = write(&path, &NEW, "new").unwrap_err();
        assert!(matches!(error, OutputError::NoFile(_)), "{error}");
        assert_eq!(contents(&path), before);
        // The folder appears during the computation.
        fs::remove_dir(path.join("x.csv")).unwrap();
        let folder = lock(&path).unwrap();
        NEW.iter()
            .try_for_each(|name| folder.write(name, b"new"))
            .unwrap();
        fs::create_dir(path.join("x.csv")).unwrap();
        let error = folder.publish().unwrap_err();
        drop(folder);
        assert!(matches!(error, OutputError::Unpublished(..)), "{error}");
        let kept = contents(&path);
        assert_eq!(kept.len(), before.len() + NEW.len());
        assert!(
            before
                .iter()
                .all(|(name, text)| kept.get(name) == Some(text))
        );
        fs::remove_dir(path.join("x.csv")).unwrap();
        assert_next_run(&path);
    }

    #[cfg(unix)]
    #[test]
    fn links_inside_a_folder_are_refused() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let (path, outside) = (root.path().join("o"), root.path().join("outside"));
        write(&outside, &["x.csv", "seal.json"], "mine").unwrap();
        let mine = contents(&outside);
        write(&path, &OLD, "old").unwrap();
        fs::remove_dir_all(path.join("b")).unwrap();
        // To a folder, to a file, and to nothing.
        for (link, to) in [("b", ""), ("x.csv", "x.csv"), ("seal.json", "none")] {
            let _ = fs::remove_file(path.join(link));
            symlink(outside.join(to), path.join(link)).unwrap();
            let before = names(&path);
            write(&path, &NEW, "new").unwrap_err();
            assert_eq!((contents(&outside), names(&path)), (mine.clone(), before));
            fs::remove_file(path.join(link)).unwrap();
        }
        // The folder itself may be a link.
        symlink(&path, root.path().join("link")).unwrap();
        assert_next_run(&root.path().join("link"));
    }

    fn names(path: &Path) -> Vec<String> {
        let entries = fs::read_dir(path).unwrap();
        let mut names: Vec<_> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    const ALL: [&str; 2] = ["x.csv", "seal.json"];

    fn lock(path: &Path) -> Result<Folder, OutputError> {
        Folder::lock(path, "run", Origin::default(), true)
    }

    /// Writes the contents into all files, and publishes them.
    fn write(path: &Path, all: &[&str], contents: &str) -> Result<(), OutputError> {
        let folder = lock(path)?;
        for name in all {
            folder.write(name, contents.as_bytes())?;
        }
        folder.publish()
    }

    #[test]
    fn what_is_not_completed_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        let folder = lock(&path).unwrap().within("c");
        folder.write("x.csv", b"whole").unwrap();
        let mut file = folder.create("y.csv").unwrap();
        file.writer.write_all(b"half").unwrap();
        drop((file, folder));
        assert!(names(root.path()).is_empty());
    }

    #[test]
    fn completed_files_replace_earlier_ones() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path();
        write(path, &["old/x.csv", "x.csv", "seal.json"], "zero").unwrap();
        fs::write(path.join("mine.txt"), "keep").unwrap();
        for content in ["one", "two"] {
            write(path, &ALL, content).unwrap();
            assert_eq!(fs::read_to_string(path.join("x.csv")).unwrap(), content);
            assert_eq!(names(path), [MANIFEST, "mine.txt", "seal.json", "x.csv"]);
        }
        // A file that the list lacks is not replaced, and no earlier result is lost.
        let error = write(path, &["mine.txt"], "three").unwrap_err();
        assert!(matches!(error, OutputError::Taken { .. }), "{error}");
        assert_eq!(fs::read_to_string(path.join("mine.txt")).unwrap(), "keep");
        assert_eq!(fs::read_to_string(path.join("x.csv")).unwrap(), "two");
    }

    /// A list from elsewhere must not lead to files outside the folder.
    #[test]
    fn no_list_names_files_outside_its_folder() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("o");
        write(&path, &ALL, "one").unwrap();
        let list = fs::read_to_string(path.join(MANIFEST)).unwrap();
        for outside in ["../x.csv", "/x.csv"] {
            fs::write(path.join(MANIFEST), list.replace("x.csv", outside)).unwrap();
            let error = write(&path, &ALL, "two").unwrap_err();
            assert!(matches!(error, OutputError::NoManifest { .. }), "{error}");
        }
    }

    #[test]
    fn what_a_killed_run_left_goes() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(".archrock-x.csv-dead"), "half").unwrap();
        // A folder stays even if its name is that of a hidden file.
        fs::create_dir(root.path().join(".archrock-folder")).unwrap();
        write(root.path(), &ALL, "one").unwrap();
        assert_eq!(
            names(root.path()),
            [".archrock-folder", MANIFEST, "seal.json", "x.csv"]
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_is_written_to_by_one_run_at_a_time() {
        let root = tempfile::tempdir().unwrap();
        let working = lock(root.path()).unwrap();
        let mut file = working.create("x.csv").unwrap();
        file.writer.write_all(b"slow").unwrap();
        let before = names(root.path());
        for below in ["", "below"] {
            let error = lock(&root.path().join(below)).unwrap_err();
            assert!(error.to_string().contains("is being written to"), "{error}");
            assert_eq!(names(root.path()), before);
        }
        working.complete(file).unwrap();
        working.write("seal.json", b"").unwrap();
        working.publish().unwrap();
        assert_eq!(names(root.path()), [MANIFEST, "seal.json", "x.csv"]);
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
                        if write(path, &["a", "b", "seal"], &format!("{writer} {turn}")).is_ok() {
                            sealed.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                        }
                    }
                });
            }
        });
        assert!(sealed.into_inner() > 0);
        let read = |name| fs::read_to_string(root.path().join(name)).unwrap();
        assert_eq!([read("a"), read("b")], [read("seal"), read("seal")]);
        assert_eq!(names(root.path()), ["a", MANIFEST, "b", "seal"]);
    }

    #[test]
    fn a_file_in_the_way_is_said() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("file");
        fs::write(&path, "").unwrap();
        let error = lock(&path.join("results")).unwrap_err();
        assert!(error.to_string().contains("file/results"), "{error}");
        let error = write(root.path(), &["file/x"], "one").unwrap_err();
        assert!(error.to_string().contains("file is there"), "{error}");
    }

    #[test]
    fn a_named_file_replaces_only_one_that_begins_alike() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("line.csv");
        for contents in ["x_m,y_m\n1,2\n", "x_m,y_m\n3,4\n"] {
            write_named_file(&path, contents.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), contents);
        }
        for mine in ["1,2,3\n", "[arch]\n", ""] {
            fs::write(&path, mine).unwrap();
            assert!(write_named_file(&path, b"x_m,y_m\n5,6\n").is_err());
            assert_eq!(fs::read_to_string(&path).unwrap(), mine);
        }
    }
}
