//! The hidden folder next to an output, in which it is made and from which it is moved into place.
//!
//! ```text
//! .NAME.partial/
//!   lock     held by the process that writes: if no process holds it, that process was killed
//!   main/    what will be called NAME
//!   beside/  the files that go with it
//!   old/     what is replaced, on its way out
//!   commit   all is written: from here on, the next run finishes
//! ```
//!
//! The folder's name depends only on the output, and making a folder is exclusive: only one of two processes gets it. Its contents
//! are the whole state, so that an exchange can continue from wherever a killed process left it.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use crate::error::{Error, Location, Problem, Result};

/// A longer name does not go into a hidden one, bytes: systems allow 255.
const LONGEST_NAME: usize = 200;
/// A folder that comes and goes this often is no longer waited for.
const ATTEMPTS: usize = 1000;

const LOCK: &str = "lock";
const MAIN: &str = "main";
const BESIDE: &str = "beside";
const OLD: &str = "old";
const COMMIT: &str = "commit";
/// The content of `commit` if existing files may be replaced.
const REPLACE: &[u8] = b"replace\n";

/// Whether outputs of this process may still take their places, or one has begun to, or none ever will.
static PLACES: AtomicU8 = AtomicU8::new(OPEN);
const OPEN: u8 = 0;
const BEGUN: u8 = 1;
const ABANDONED: u8 = 2;

fn move_places(to: u8) -> bool {
    PLACES.compare_exchange(OPEN, to, Ordering::SeqCst, Ordering::SeqCst).is_ok() || PLACES.load(Ordering::SeqCst) == to
}

/// For a process that is about to end: no output is moved into place any more. `false` if one already has been, or is being moved.
pub(super) fn abandon() -> bool {
    move_places(ABANDONED)
}

/// A hidden folder that this process holds.
#[derive(Debug)]
pub(super) struct Staging {
    /// Where the outputs belong.
    parent: PathBuf,
    /// The main output's name there.
    name: OsString,
    folder: PathBuf,
    /// `None` where the disk has no locks.
    lock: Option<File>,
}

/// What comes of asking for a hidden folder.
enum Claim {
    Held(Option<File>),
    /// Another process holds it.
    Busy,
    /// It went away meanwhile.
    Gone,
}

impl Staging {
    /// An empty one, for the output `name` in `parent`, which is made if it is not there.
    ///
    /// # Errors
    /// [`Error::Invalid`] if another process is writing this output; [`Error::Io`] if the folder cannot be made.
    pub(super) fn new(parent: &Path, name: &OsStr) -> Result<Self> {
        let target = parent.join(name);
        let folder = parent.join(hidden_name(name));
        let making = |path: &Path, e| Err(Error::io(path, "making this folder", e));
        let mut lost = None;
        for _ in 0..ATTEMPTS {
            if let Err(e) = fs::create_dir_all(parent) {
                return making(parent, e);
            }
            let is_mine = match fs::create_dir(&folder) {
                Ok(()) => true,
                Err(e) if e.kind() == ErrorKind::AlreadyExists && folder.is_dir() => false,
                Err(e) if e.kind() == ErrorKind::NotFound => {
                    lost = Some(e);
                    continue;
                }
                Err(e) => return making(&target, e),
            };
            let lock = match claim(&folder, is_mine).map_err(|e| Error::io(&folder, "locking this folder", e))? {
                Claim::Held(lock) => lock,
                Claim::Busy => return Err(busy(&target, &folder)),
                Claim::Gone => continue,
            };
            let staging = Staging { parent: parent.to_owned(), name: name.to_owned(), folder, lock };
            staging.finish()?;
            empty(&staging.folder);
            for part in [MAIN, BESIDE, OLD] {
                if let Err(e) = fs::create_dir(staging.folder.join(part)) {
                    return making(&target, e);
                }
            }
            return Ok(staging);
        }
        // A folder that is there, and in which none can be made, as /proc.
        match lost {
            Some(e) => making(&target, e),
            None => Err(busy(&target, &folder)),
        }
    }

    /// The hidden folder.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where the main output is written.
    pub(super) fn main(&self) -> PathBuf {
        self.folder.join(MAIN).join(&self.name)
    }

    /// Where a file that goes with it is written.
    pub(super) fn beside(&self, name: &OsStr) -> PathBuf {
        self.folder.join(BESIDE).join(name)
    }

    /// The final paths of the files that are written beside the main output.
    pub(super) fn companions(&self) -> Vec<PathBuf> {
        // A folder that cannot be read has nothing in it that could be moved either.
        names(&self.folder.join(BESIDE)).unwrap_or_default().iter().map(|name| self.parent.join(name)).collect()
    }

    /// Where the outputs belong.
    pub(super) fn parent(&self) -> &Path {
        &self.parent
    }

    /// The final path of what is written at `path`.
    pub(super) fn final_path(&self, path: &Path) -> Option<PathBuf> {
        let inside = path.strip_prefix(&self.folder).ok()?;
        let inside = inside.strip_prefix(MAIN).or_else(|_| inside.strip_prefix(BESIDE)).unwrap_or(Path::new(""));
        Some(if inside.as_os_str().is_empty() { self.parent.join(&self.name) } else { self.parent.join(inside) })
    }

    /// Moves everything into place, in one step as far as the disk allows, replacing existing files if permitted.
    ///
    /// # Errors
    /// [`Error::Io`], and [`Error::Interrupted`] after [`abandon`]: then everything is where it was.
    pub(super) fn commit(&self, replace: bool) -> Result<()> {
        self.commit_by(replace, exchange)
    }

    /// With the way to exchange two folders, which says whether the disk could.
    fn commit_by(&self, replace: bool, exchange: impl Fn(&Path, &Path) -> io::Result<bool>) -> Result<()> {
        let (from, target) = (self.main(), self.parent.join(&self.name));
        let failed = |path: &Path, e| Error::io(path, "giving the product its final name", e);
        let sync = |path: &Path| sync_all(path).map_err(|e| Error::io(&target, "writing to the disk", e));
        let beside = names(&self.folder.join(BESIDE)).map_err(|e| failed(&target, e))?;
        sync(&self.folder.join(MAIN))?;
        sync(&self.folder.join(BESIDE))?;
        if !move_places(BEGUN) {
            return Err(Error::Interrupted);
        }
        let is_there = target.symlink_metadata().is_ok();
        let done = if !beside.is_empty() {
            false
        } else if !is_there || !replace {
            rename_new(&from, &target).map_err(|e| failed(&target, e))?;
            true
        } else if from.is_file() {
            fs::rename(&from, &target).map_err(|e| failed(&target, e))?;
            true
        } else {
            exchange(&from, &target).map_err(|e| failed(&target, e))?
        };
        if !done {
            self.begin(replace).map_err(|e| failed(&target, e))?;
            if let Err(error) = self.forward(replace) {
                // While that exists, the next run goes forward: it is removed only when everything is back.
                if self.back(&beside) {
                    let _ = fs::remove_file(self.folder.join(COMMIT));
                }
                return Err(error);
            }
        }
        sync_folder(&self.parent).map_err(|e| failed(&target, e))?;
        let _ = fs::remove_file(self.folder.join(COMMIT));
        Ok(())
    }

    /// Says on the disk that all is written.
    fn begin(&self, replace: bool) -> io::Result<()> {
        sync_folder(&self.folder)?;
        let draft = self.folder.join("commit.new");
        fs::write(&draft, if replace { REPLACE } else { b"" })?;
        sync_file(&draft)?;
        fs::rename(&draft, self.folder.join(COMMIT))?;
        sync_folder(&self.folder)
    }

    /// Whether an exchange was begun, and not finished.
    fn has_begun(&self) -> bool {
        self.folder.join(COMMIT).is_file()
    }

    /// Finishes an exchange that a killed process had begun.
    fn finish(&self) -> Result<()> {
        if !self.has_begun() {
            return Ok(());
        }
        let commit = self.folder.join(COMMIT);
        let replace = fs::read(&commit).map_err(|e| Error::io(&commit, "reading", e))? == REPLACE;
        self.forward(replace)?;
        sync_folder(&self.parent).map_err(|e| Error::io(&self.parent, "writing to the disk", e))?;
        fs::remove_file(&commit).map_err(|e| Error::io(&commit, "removing", e))
    }

    /// Puts everything into its place, from whatever state: the main output leaves first and comes last, so that
    /// what is found under its name is never of two products.
    fn forward(&self, replace: bool) -> Result<()> {
        let beside = self.folder.join(BESIDE);
        let others = names(&beside).map_err(|e| Error::io(&beside, "reading", e))?;
        self.leave(&self.main(), &self.name, replace)?;
        for name in &others {
            self.put(&self.beside(name), name, replace)?;
        }
        self.put(&self.main(), &self.name, replace)
    }

    /// Moves away what is in the place of `new`, unless `new` is there already.
    fn leave(&self, new: &Path, name: &OsStr, replace: bool) -> Result<()> {
        let (target, old) = (self.parent.join(name), self.folder.join(OLD).join(name));
        if new.symlink_metadata().is_err() || target.symlink_metadata().is_err() {
            return Ok(());
        }
        if !replace || old.symlink_metadata().is_ok() {
            let problem =
                Problem::new(Location::file(&target), "was written by another program in the meantime").with_help(
                    format!("what was to come here is in {}: move or remove that folder", self.folder.display()),
                );
            return Err(Error::Invalid(vec![problem]));
        }
        fs::rename(&target, &old).map_err(|e| Error::io(&target, "replacing", e))
    }

    fn put(&self, new: &Path, name: &OsStr, replace: bool) -> Result<()> {
        self.leave(new, name, replace)?;
        if new.symlink_metadata().is_err() {
            return Ok(());
        }
        let target = self.parent.join(name);
        rename_new(new, &target).map_err(|e| Error::io(&target, "giving the product its final name", e))
    }

    /// Puts everything back to where it was; whether it could.
    fn back(&self, beside: &[OsString]) -> bool {
        let others = beside.iter().map(|name| (self.beside(name), name));
        let mut all = std::iter::once((self.main(), &self.name)).chain(others);
        all.all(|(new, name)| {
            let (target, old) = (self.parent.join(name), self.folder.join(OLD).join(name));
            (new.symlink_metadata().is_ok() || fs::rename(&target, &new).is_ok())
                && (old.symlink_metadata().is_err() || rename_new(&old, &target).is_ok())
        })
    }
}

/// Removes all of a hidden folder but the lock.
fn empty(folder: &Path) {
    for part in [MAIN, BESIDE, OLD] {
        let _ = fs::remove_dir_all(folder.join(part));
    }
    let _ = fs::remove_file(folder.join("commit.new"));
}

/// Removes a hidden folder that this process holds.
pub(super) fn remove(folder: &Path) {
    empty(folder);
    // The lock goes last: from here on another process may have the folder, and nothing in it is touched any more.
    let _ = fs::remove_file(folder.join(LOCK));
    let _ = fs::remove_dir(folder);
}

impl Drop for Staging {
    /// Removes the folder, unless there is an exchange to finish.
    fn drop(&mut self) {
        if self.has_begun() {
            return;
        }
        remove(&self.folder);
        drop(self.lock.take());
    }
}

/// Finishes in the folder of `path` what killed processes had begun to exchange, and, for an output, removes what such a one had half
/// written of it; says what was done.
///
/// # Errors
/// [`Error::Io`] and [`Error::Invalid`] if an exchange cannot be finished.
pub fn settle(path: &Path, is_output: bool) -> Result<Vec<String>> {
    let mut said = Vec::new();
    let real = path.canonicalize().ok().filter(|_| path.is_symlink());
    for path in real.as_deref().into_iter().chain([path]) {
        let parent = folder_of(path);
        let wanted = path.file_name().map(hidden_name);
        // A folder that is missing or unreadable is reported by the code that needs it.
        let Ok(entries) = parent.read_dir() else { continue };
        let mut found: Vec<OsString> = entries.filter_map(|entry| Some(entry.ok()?.file_name())).collect();
        found.retain(|name| is_hidden(name));
        found.sort();
        for hidden in found {
            let folder = parent.join(&hidden);
            let is_begun = folder.join(COMMIT).is_file();
            let is_of_output = is_output && wanted.as_ref() == Some(&hidden);
            let is_left = is_of_output && folder.join(LOCK).is_file();
            if is_of_output && !is_left {
                // Without its lock it is empty: it was being made or removed. Who has just made it finds it gone, and makes it again.
                let _ = fs::remove_dir(&folder);
            }
            if !is_begun && !is_left {
                continue;
            }
            let Ok(Claim::Held(lock @ Some(_))) = claim(&folder, false) else { continue };
            let name = if is_begun { main_name(&folder) } else { None };
            let name = name.or_else(|| path.file_name().map(OsStr::to_owned)).unwrap_or_default();
            let staging = Staging { parent: parent.to_owned(), name, folder, lock };
            let target = staging.parent.join(&staging.name);
            // Another process may have finished it by now.
            if staging.has_begun() {
                staging.finish()?;
                let what = target.strip_prefix(".").unwrap_or(&target).display();
                said.push(format!("{what}: finished what a run that was stopped had begun to put in its place"));
            } else if is_left && staging.folder.join(MAIN).is_dir() {
                let what = staging.folder.strip_prefix(".").unwrap_or(&staging.folder).display();
                said.push(format!("removed {what}, which a run that was stopped had left"));
            }
        }
    }
    Ok(said)
}

/// Whether there is a hidden folder of an output: somebody is writing it, or was killed doing so.
pub(super) fn is_staged(path: &Path) -> bool {
    path.file_name().is_some_and(|name| folder_of(path).join(hidden_name(name)).exists())
}

/// The folder that a path is in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The name of the main output of a hidden folder, as far as one of its parts still holds it.
fn main_name(folder: &Path) -> Option<OsString> {
    let name = names(&folder.join(MAIN)).ok()?.pop();
    // It is the one that has no companion of its name.
    name.or_else(|| names(&folder.join(OLD)).ok()?.into_iter().find(|n| folder.file_name() == Some(&hidden_name(n))))
}

const ENDING: &str = ".partial";

/// The name of the hidden folder of an output: the name with a dot before it, or for a long one its hash.
fn hidden_name(name: &OsStr) -> OsString {
    let mut hidden = OsString::from(".");
    if name.len() <= LONGEST_NAME {
        hidden.push(name);
    } else {
        hidden.push("mmxrt-");
        hidden.push(&blake3::hash(name.as_encoded_bytes()).to_hex()[..32]);
    }
    hidden.push(ENDING);
    hidden
}

fn is_hidden(name: &OsStr) -> bool {
    let bytes = name.as_encoded_bytes();
    bytes.starts_with(b".") && bytes.ends_with(ENDING.as_bytes())
}

fn busy(target: &Path, folder: &Path) -> Error {
    let help = format!(
        "choose another name, or wait until that process has ended; if there is none, remove {}",
        folder.display()
    );
    Error::Invalid(vec![Problem::new(Location::file(target), BUSY).with_help(help)])
}

const BUSY: &str = "another process is writing it: when that has ended, it exists";

/// Whether an error says that another process is writing an output.
pub(super) fn is_busy(error: &Error) -> bool {
    error.problems().iter().any(|problem| problem.message == BUSY)
}

/// Takes the lock of a hidden folder.
fn claim(folder: &Path, is_mine: bool) -> io::Result<Claim> {
    let path = folder.join(LOCK);
    let lock = match File::options().read(true).write(true).create(true).truncate(false).open(&path) {
        Ok(lock) => lock,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Claim::Gone),
        Err(e) => return Err(e),
    };
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Ok(Claim::Busy),
        // Without locks there is no telling whether the process lives, but of a folder that was just made.
        Err(TryLockError::Error(_)) if is_mine => return Ok(Claim::Held(None)),
        Err(TryLockError::Error(_)) => return Ok(Claim::Busy),
    }
    Ok(if is_same_file(&lock, &path) { Claim::Held(Some(lock)) } else { Claim::Gone })
}

/// Whether an open file still stands at a path.
#[cfg(unix)]
fn is_same_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    let (file, path) = (file.metadata().map(id), path.metadata().map(id));
    file.is_ok() && file.ok() == path.ok()
}

/// Whether an open file still stands at a path: elsewhere files that are open are not removed.
#[cfg(not(unix))]
fn is_same_file(_: &File, path: &Path) -> bool {
    path.is_file()
}

/// The names in a folder, sorted.
fn names(folder: &Path) -> io::Result<Vec<OsString>> {
    let mut names: Vec<OsString> = folder.read_dir()?.map(|e| Ok(e?.file_name())).collect::<io::Result<_>>()?;
    names.sort();
    Ok(names)
}

/// Everything below a path, on the disk. Several at a time: a disk does that in one go.
fn sync_all(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        let inside: Vec<PathBuf> = names(path)?.iter().map(|name| path.join(name)).collect();
        inside.par_iter().try_for_each(|path| sync_all(path))?;
        sync_folder(path)
    } else {
        sync_file(path)
    }
}

fn sync_file(path: &Path) -> io::Result<()> {
    File::options().read(true).write(cfg!(windows)).open(path)?.sync_all()
}

/// Not all disks know this for folders.
fn sync_folder(path: &Path) -> io::Result<()> {
    let Ok(folder) = File::open(path) else { return Ok(()) };
    match folder.sync_all() {
        Err(e) if e.raw_os_error() == Some(EIO) => Err(e),
        _ => Ok(()),
    }
}

/// A disk that fails; the same number on all systems.
const EIO: i32 = 5;

/// Renames to a name that nothing has.
fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    if let Some(result) = system::rename_new(from, to) {
        return result;
    }
    // A second name for a file is never one that is taken.
    if from.is_file() && fs::hard_link(from, to).is_ok() {
        return fs::remove_file(from);
    }
    if to.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    fs::rename(from, to)
}

/// Exchanges two paths in one step; `false` if the disk cannot.
fn exchange(a: &Path, b: &Path) -> io::Result<bool> {
    system::exchange(a, b)
}

/// Free space on the disk of a folder, bytes, if the disk reports it.
pub(super) fn free_bytes(folder: &Path) -> Option<u64> {
    system::free_bytes(folder)
}

#[cfg(any(target_os = "linux", target_vendor = "apple"))]
mod system {
    use std::io;
    use std::path::Path;

    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;

    /// Whether the disk, or the system, has no such call.
    fn is_unknown(errno: Errno) -> bool {
        [Errno::INVAL, Errno::NOSYS, Errno::NOTSUP, Errno::OPNOTSUPP].contains(&errno)
    }

    pub(super) fn rename_new(from: &Path, to: &Path) -> Option<io::Result<()>> {
        match renameat_with(CWD, from, CWD, to, RenameFlags::NOREPLACE) {
            Err(e) if is_unknown(e) => None,
            result => Some(result.map_err(io::Error::from)),
        }
    }

    pub(super) fn exchange(a: &Path, b: &Path) -> io::Result<bool> {
        match renameat_with(CWD, a, CWD, b, RenameFlags::EXCHANGE) {
            Ok(()) => Ok(true),
            Err(e) if is_unknown(e) => Ok(false),
            Err(e) => Err(e.into()),
        }
    }

    pub(super) fn free_bytes(folder: &Path) -> Option<u64> {
        let disk = rustix::fs::statvfs(folder).ok()?;
        // Some network disks do not report it.
        if disk.f_blocks == 0 { None } else { disk.f_bavail.checked_mul(disk.f_frsize) }
    }
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
mod system {
    use std::io;
    use std::path::Path;

    pub(super) fn rename_new(_: &Path, _: &Path) -> Option<io::Result<()>> {
        None
    }

    pub(super) fn exchange(_: &Path, _: &Path) -> io::Result<bool> {
        Ok(false)
    }

    pub(super) fn free_bytes(_: &Path) -> Option<u64> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty_folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("mmxrt-staging-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        path
    }

    fn text(path: &Path) -> String {
        fs::read_to_string(path).unwrap_or_default()
    }

    fn staged_pair(top: &Path) -> Staging {
        let staging = Staging::new(top, OsStr::new("x.img")).unwrap();
        fs::write(staging.main(), "new numbers").unwrap();
        fs::write(staging.beside(OsStr::new("x.hdr")), "new header").unwrap();
        staging
    }

    /// A process that is killed drops nothing, and holds no lock.
    fn killed(mut staging: Staging) {
        staging.lock = None;
        std::mem::forget(staging);
    }

    /// All moves of an exchange, one more each time, and then the process is gone.
    #[test]
    fn a_pair_that_was_being_replaced_is_finished_from_every_state() {
        let moves: [&dyn Fn(&Staging); 4] = [
            &|s| s.leave(&s.main(), &s.name, true).unwrap(),
            &|s| s.leave(&s.beside(OsStr::new("x.hdr")), OsStr::new("x.hdr"), true).unwrap(),
            &|s| s.put(&s.beside(OsStr::new("x.hdr")), OsStr::new("x.hdr"), true).unwrap(),
            &|s| s.put(&s.main(), &s.name, true).unwrap(),
        ];
        for done in 0..=moves.len() {
            let top = empty_folder(&format!("pair{done}"));
            fs::write(top.join("x.img"), "old numbers").unwrap();
            fs::write(top.join("x.hdr"), "old header").unwrap();
            let staging = staged_pair(&top);
            staging.begin(true).unwrap();
            moves[..done].iter().for_each(|act| act(&staging));
            killed(staging);
            // What is found under the main name has its own header.
            let pair = (text(&top.join("x.img")), text(&top.join("x.hdr")));
            match pair.0.as_str() {
                "" => {}
                numbers => assert_eq!(pair.1, numbers.replace("numbers", "header"), "after {done} moves"),
            }
            let said = settle(&top.join("y"), false).unwrap();
            assert!(said.len() == 1 && said[0].contains("finished"), "{said:?}");
            assert_eq!(
                (text(&top.join("x.img")), text(&top.join("x.hdr"))),
                ("new numbers".into(), "new header".into())
            );
            assert_eq!(names(&top).unwrap(), ["x.hdr", "x.img"]);
            fs::remove_dir_all(top).unwrap();
        }
    }

    #[test]
    fn a_disk_that_cannot_exchange_folders_replaces_them_all_the_same() {
        let top = empty_folder("noexchange");
        fs::create_dir(top.join("p")).unwrap();
        fs::write(top.join("p/report.json"), "old").unwrap();
        let staging = Staging::new(&top, OsStr::new("p")).unwrap();
        fs::create_dir(staging.main()).unwrap();
        fs::write(staging.main().join("report.json"), "new").unwrap();
        staging.commit_by(true, |_, _| Ok(false)).unwrap();
        drop(staging);
        assert_eq!((text(&top.join("p/report.json")), names(&top).unwrap()), ("new".into(), vec!["p".into()]));
        fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn what_cannot_all_be_replaced_stays_as_it_was() {
        let top = empty_folder("back");
        fs::write(top.join("x.img"), "old numbers").unwrap();
        let staging = staged_pair(&top);
        // Meanwhile another program takes the header's name, which was free.
        fs::remove_file(top.join("x.img")).unwrap();
        fs::write(top.join("x.hdr"), "of another").unwrap();
        let error = staging.commit(false).unwrap_err().to_string();
        assert!(error.contains("x.hdr") && error.contains("another program"), "{error}");
        drop(staging);
        assert_eq!((text(&top.join("x.hdr")), names(&top).unwrap()), ("of another".into(), vec!["x.hdr".into()]));
        fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_what_a_living_one_writes_is_not() {
        let top = empty_folder("left");
        killed(staged_pair(&top));
        let said = settle(&top.join("x.img"), true).unwrap();
        assert!(said.len() == 1 && said[0].contains("removed") && said[0].contains(".x.img.partial"), "{said:?}");
        assert!(names(&top).unwrap().is_empty());
        let alive = staged_pair(&top);
        assert_eq!(settle(&top.join("x.img"), true).unwrap(), [""; 0]);
        let error = Staging::new(&top, OsStr::new("x.img")).unwrap_err().to_string();
        assert!(error.contains("another process is writing it"), "{error}");
        alive.commit(false).unwrap();
        drop(alive);
        assert_eq!(names(&top).unwrap(), ["x.hdr", "x.img"]);
        fs::remove_dir_all(top).unwrap();
    }

    /// A process may be killed after it has made the hidden folder and before it has its lock, or while it removes it.
    #[test]
    fn a_hidden_folder_without_a_lock_goes_if_it_is_empty() {
        let top = empty_folder("unlocked");
        fs::create_dir(top.join(".x.partial")).unwrap();
        fs::create_dir_all(top.join(".y.partial/main")).unwrap();
        assert_eq!(settle(&top.join("x"), false).unwrap(), [""; 0]);
        assert_eq!(names(&top).unwrap(), [".x.partial", ".y.partial"]);
        assert_eq!(settle(&top.join("x"), true).unwrap(), [""; 0]);
        settle(&top.join("y"), true).unwrap();
        assert_eq!(names(&top).unwrap(), [".y.partial"]);
        fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn long_names_are_written_and_too_long_ones_told_before_the_work() {
        let top = empty_folder("long");
        let name = "n".repeat(250);
        let staging = Staging::new(&top, OsStr::new(&name)).unwrap();
        fs::write(staging.main(), "x").unwrap();
        staging.commit(false).unwrap();
        drop(staging);
        assert_eq!(names(&top).unwrap(), [name.as_str()]);
        fs::remove_dir_all(top).unwrap();
    }
}
