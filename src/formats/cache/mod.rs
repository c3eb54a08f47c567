//! A folder of prepared bodies, so that processes after the first do not make them again: meshes as they were read or made, how their facets hang together,
//! trees of rays.
//!
//! An entry is found by a hash of all that it follows from, and is believed only if it is whole: anything else is made anew, and takes its place. What a
//! command writes does not depend on whether there is a cache.

mod entry;
mod landscape;
mod mesh;
mod mesh_file;
mod topology;

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Location, Problem, Result};

use entry::Packed;

/// Changes when the same entry would be made otherwise than before.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " 1");
/// How names of entries that are being written end.
const PARTIAL: &str = "partial";

/// A folder of prepared bodies.
#[derive(Debug, Clone)]
pub struct Cache {
    folder: PathBuf,
    is_writable: bool,
}

/// What can be kept.
trait Kept: Sized {
    /// What such entries are called.
    const KIND: &'static str;

    /// As an entry holds it; `None` if it must be made anew each time.
    fn packed(&self) -> Option<Packed>;
}

/// What an entry follows from.
struct Key(blake3::Hasher);

impl Key {
    fn of<T: Kept>() -> Self {
        let key = Key(blake3::Hasher::new());
        key.and(VERSION.as_bytes()).and(T::KIND.as_bytes())
    }

    /// With one part more.
    fn and(mut self, part: &[u8]) -> Self {
        // Lengths first, so that no two lists of parts have one hash.
        self.0.update(&(part.len() as u64).to_le_bytes());
        self.0.update(part);
        self
    }

    fn name(&self) -> String {
        self.0.finalize().to_hex().to_string()
    }
}

/// Whether this is what a file is called while it is written: KEY.PROCESS.NUMBER.partial, or probe. ...
fn is_partial(name: &OsStr) -> bool {
    let parts: Vec<&str> = name.to_str().unwrap_or_default().split('.').collect();
    let [key, process, number, PARTIAL] = parts[..] else { return false };
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let is_key = key == "probe" || key.len() == 2 * entry::HASH && key.bytes().all(|b| b.is_ascii_hexdigit());
    is_key && is_number(process) && is_number(number)
}

/// The end of a name that no other file of this machine has.
fn own_name() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    format!("{}.{}.{PARTIAL}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

impl Cache {
    /// In a folder, which is made if it is not there. What processes that were killed have left half-written in it is removed.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is a file; [`Error::Io`] if it can neither be read nor made.
    pub fn open(folder: &Path) -> Result<Self> {
        if folder.is_file() {
            let problem = Problem::new(Location::file(folder), "is a file, and no folder that could hold a cache");
            return Err(Error::Invalid(vec![problem.with_help("name another folder")]));
        }
        fs::create_dir_all(folder).map_err(|e| Error::io(folder, "making this folder", e))?;
        for entry in folder.read_dir().map_err(|e| Error::io(folder, "reading", e))?.flatten() {
            let path = entry.path();
            // Whoever still writes it holds its lock. What is called otherwise is somebody else's; pipes would wait for one who writes.
            let is_left = || File::open(&path).is_ok_and(|file| file.try_lock().is_ok());
            let is_ours = entry.file_type().is_ok_and(|kind| kind.is_file()) && is_partial(&entry.file_name());
            if is_ours && is_left() {
                let _ = fs::remove_file(&path);
            }
        }
        let probe = folder.join(format!("probe.{}", own_name()));
        // One that is there is another machine's, of a process of the same number.
        let is_writable = File::create_new(&probe).map_or_else(|e| e.kind() == io::ErrorKind::AlreadyExists, |_| true);
        let _ = fs::remove_file(&probe);
        Ok(Cache { folder: folder.to_owned(), is_writable })
    }

    /// What whoever named the folder should know: that what is made is not kept there. One that others have filled may be there to read.
    pub fn warning(&self) -> Option<String> {
        let folder = self.folder.display();
        (!self.is_writable)
            .then(|| format!("{folder} cannot be written to: what is in it is used, and nothing is added"))
    }

    /// What is kept under a key, if `unpacked` makes sense of it, or what is made now, and kept from now on.
    fn of<T: Kept>(
        &self,
        key: &Key,
        unpacked: impl FnOnce(Packed) -> Option<T>,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        let name = key.name();
        let path = self.folder.join(format!("{name}.{}", T::KIND));
        if let Some(kept) = entry::read(&path, &name).and_then(unpacked) {
            tracing::info!("{} taken from {}", T::KIND, path.display());
            return Ok(kept);
        }
        let made = make()?;
        if let Some(packed) = made.packed().filter(|_| self.is_writable) {
            let kept = match self.put(&path, &name, &packed) {
                // Another process has taken it, before it was locked, for what a killed one had left.
                Err(error) if error.kind() == io::ErrorKind::NotFound => self.put(&path, &name, &packed),
                kept => kept,
            };
            // It is as good without: a full disk must not end a long campaign.
            if let Err(error) = kept {
                tracing::warn!("{} is not kept: {error}", path.display());
            }
        }
        Ok(made)
    }

    /// Writes an entry, which appears whole.
    fn put(&self, path: &Path, name: &str, packed: &Packed) -> io::Result<()> {
        let partial = self.folder.join(format!("{name}.{}", own_name()));
        // Process numbers of two machines may be the same: then the other one writes it.
        let file = File::create_new(&partial)?;
        // Some disks have no locks: there, what is left is not removed either.
        let _ = file.try_lock();
        let written = entry::write(&file, name, packed).and_then(|()| file.sync_all());
        let placed = written.and_then(|()| fs::rename(&partial, path));
        if placed.is_err() {
            let _ = fs::remove_file(&partial);
        }
        placed
    }
}
