//! Half-written output never appears under its final name.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Location, Problem, Result};

use super::machine;
use super::staging::{self, Staging};

pub use super::staging::settle;

/// What is under way: the hidden folder of each output, and the folders that were made above it.
static UNDER_WAY: Mutex<Vec<(PathBuf, Vec<PathBuf>)>> = Mutex::new(Vec::new());

fn under_way() -> MutexGuard<'static, Vec<(PathBuf, Vec<PathBuf>)>> {
    // A list of paths is whole whenever the lock is free.
    UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// For a process that is about to end, whatever its threads do: from now on no output is moved into place, and half-written files are removed.
/// `false` if one has begun to take its place, or has.
pub fn abandon() -> bool {
    let is_abandoned = staging::abandon();
    if is_abandoned {
        for (hidden, made) in under_way().drain(..) {
            staging::remove(&hidden);
            made.iter().rev().for_each(|folder| _ = fs::remove_dir(folder));
        }
    }
    is_abandoned
}

/// A file with its companions, or a folder, that is written in a hidden folder next to its final place, and moved there when
/// complete.
///
/// Dropped before [`commit`](Staged::commit), it leaves nothing: not even the folders made to hold it. No other process writes
/// the same output meanwhile.
#[derive(Debug)]
pub struct Staged {
    target: PathBuf,
    path: PathBuf,
    staging: Option<Staging>,
    replace: bool,
    /// What other programs had put into the folder that is replaced: names from there.
    kept: Vec<PathBuf>,
    /// Folders above the target that were not there before, outermost first.
    made: Vec<PathBuf>,
}

/// A kind of folder that is written, and so may be replaced.
#[derive(Debug)]
pub struct FolderKind {
    /// A folder that holds one of these is of the kind, or one staged as such; no other folder is ever replaced.
    pub marks: &'static [&'static str],
    /// What such a folder may hold: names, or how names begin, if they end in a dot. A folder with anything else in it is not replaced
    /// either, except for what other programs leave everywhere.
    pub parts: &'static [&'static str],
    /// Folders in it that hold a file of this name are parts, too.
    pub holds: Option<&'static str>,
}

/// A product folder.
const PRODUCT: FolderKind = FolderKind {
    marks: &["report.json", "run.json"],
    parts: &[
        "report.json",
        "run.json",
        "cube.img",
        "cube.hdr",
        "cube.exr",
        "cube.xml",
        "cube.nc",
        "cube.zarr",
        "cube.fits",
        "thermal.img",
        "thermal.hdr",
        "thermal.xml",
        "thermal.nc",
        "thermal.zarr",
        "thermal.fits",
        "backplanes.",
        "exposures.csv",
        "displacement.img",
        "displacement.hdr",
        "displacement.svg",
        "dn.img",
        "dn.hdr",
        "dn.xml",
        "dn.nc",
        "dn.zarr",
        "dn.fits",
        "snr.img",
        "snr.hdr",
        "snr.svg",
        "quicklook.png",
        "quicklook_rgb.png",
        "table.npz",
        "footprints.npz",
    ],
    holds: None,
};

impl Staged {
    /// An empty product folder to write into.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the target exists and `replace` is false, or if it is not a product folder, or holds what is
    /// no part of a product; [`Error::Io`] if a folder cannot be made there.
    pub fn folder(target: &Path, replace: bool) -> Result<Self> {
        Self::folder_of(&PRODUCT, target, replace)
    }

    /// An empty folder of another kind to write into.
    ///
    /// # Errors
    /// As [`folder`](Staged::folder).
    pub fn folder_of(kind: &FolderKind, target: &Path, replace: bool) -> Result<Self> {
        if replace && target.is_file() {
            return Err(Error::invalid(Location::file(target), "is a file; name a folder"));
        }
        let mut staged = Self::new(target, replace)?;
        if replace && target.exists() {
            let reading = |e| Error::io(target, "reading", e);
            let entries = target.read_dir().map_err(reading)?;
            let names: Vec<_> = entries.map(|e| Ok(e?.file_name())).collect::<std::io::Result<_>>().map_err(reading)?;
            let refused = |message: String| {
                let help = "remove it yourself, or choose another name";
                Err(Error::Invalid(vec![Problem::new(Location::file(target), message).with_help(help)]))
            };
            if names.iter().any(|name| !is_stray(&name.to_string_lossy()))
                && !kind.marks.iter().any(|mark| target.join(mark).is_file())
            {
                return refused("is not a product folder, so it is not replaced".into());
            }
            let is_part = |name: &str| {
                kind.parts.iter().any(|part| *part == name || (part.ends_with('.') && name.starts_with(part)))
            };
            let is_inner = |name: &str| kind.holds.is_some_and(|mark| target.join(name).join(mark).is_file());
            let is_known = |name: &str| is_part(name) || is_inner(name) || is_stray(name);
            if let Some(other) = names.iter().map(|name| name.to_string_lossy()).find(|name| !is_known(name)) {
                return refused(format!("holds {other:?}, which is not part of a product, so it is not replaced"));
            }
        }
        fs::create_dir(&staged.path).map_err(|e| Error::io(target, "making this folder", e))?;
        if replace && staged.target.is_dir() {
            strays(&staged.target, Path::new(""), &mut staged.kept);
        }
        Ok(staged)
    }

    /// A name to write a file to.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the target exists and `replace` is false, or is a folder or a device, or if another process is writing it;
    /// [`Error::Io`] if the folder around it cannot be made.
    pub fn file(target: &Path, replace: bool) -> Result<Self> {
        is_file_name(target, replace)?;
        Self::new(target, replace)
    }

    /// A name to write a file to that goes with this one, in the same folder: all take their places together.
    ///
    /// # Errors
    /// As [`file`](Staged::file); [`Error::Invalid`] if a link leads one of them to another folder.
    pub fn beside(&mut self, target: &Path) -> Result<PathBuf> {
        is_file_name(target, self.replace)?;
        let target = &resolved(target, self.replace)?;
        let staging = self.staging()?;
        let (parent, name) = (staging::folder_of(target), named_by(target)?);
        let is_same =
            |a: &Path, b: &Path| a == b || a.canonicalize().ok().is_some_and(|a| Some(a) == b.canonicalize().ok());
        if !is_same(parent, staging.parent()) {
            let message =
                format!("goes with {}, but a link leads one of them to another folder", self.target.display());
            let problem = Problem::new(Location::file(target), message);
            return Err(Error::Invalid(vec![problem.with_help("name the file that the link leads to")]));
        }
        Ok(staging.beside(name))
    }

    fn staging(&self) -> Result<&Staging> {
        self.staging.as_ref().ok_or_else(|| Error::io(&self.target, "writing", ErrorKind::NotFound.into()))
    }

    fn new(target: &Path, replace: bool) -> Result<Self> {
        settle(target, false)?;
        let target = &resolved(target, replace)?;
        let name = named_by(target)?;
        let parent = staging::folder_of(target);
        let mut made: Vec<PathBuf> =
            parent.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).map(Path::to_owned).collect();
        made.reverse();
        let mut staged =
            Staged { target: target.to_owned(), path: PathBuf::new(), staging: None, replace, kept: Vec::new(), made };
        let staging = Staging::new(parent, name)?;
        staged.path = staging.main();
        under_way().push((staging.folder().to_owned(), staged.made.clone()));
        staged.staging = Some(staging);
        // Another process may have been quicker.
        resolved(target, replace)?;
        Ok(staged)
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file of what is staged, at a path that [`path`](Staged::path) or [`beside`](Staged::beside) gave.
    ///
    /// # Errors
    /// [`Error::Io`], with the final name.
    pub fn put(&self, path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
        let writing = |e| self.named(Error::io(path, "writing", e));
        let mut out = BufWriter::with_capacity(1 << 20, File::create(path).map_err(writing)?);
        write(&mut out).and_then(|()| out.flush()).map_err(writing)
    }

    /// Names in the folder that is replaced of what other programs have put there: it is kept.
    pub fn kept(&self) -> &[PathBuf] {
        &self.kept
    }

    /// Refuses if the disk has no room for this many bytes.
    ///
    /// # Errors
    /// [`Error::Invalid`]; disks that do not report their free space are not checked.
    pub fn has_room(&self, bytes: u64) -> Result<()> {
        let free = self.path.parent().and_then(staging::free_bytes).filter(|free| *free < bytes);
        let Some(free) = free else { return Ok(()) };
        let message = format!("takes {}, and the disk has {} left", machine::size(bytes, 3), machine::size(free, 3));
        Err(Error::invalid(Location::file(&self.target), message))
    }

    /// Says if one of the files that it is made from would be replaced, under whatever name.
    ///
    /// # Errors
    /// [`Error::Invalid`].
    pub fn spares<'a>(&self, inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
        let mut targets = vec![self.target.clone()];
        targets.extend(self.staging()?.companions());
        spares(&targets, inputs)
    }

    /// An error that names the output by its final name, which is the one the user knows.
    #[must_use]
    pub fn named(&self, error: Error) -> Error {
        let final_path = |path: &Path| self.staging.as_ref()?.final_path(path);
        let named = |path: PathBuf| final_path(&path).unwrap_or(path);
        match error {
            Error::Io { path, action, source } => Error::Io { path: named(path), action, source },
            Error::Invalid(mut problems) => {
                problems.iter_mut().for_each(|p| p.at.file = p.at.file.take().map(named));
                Error::Invalid(problems)
            }
            Error::Syntax { mut at, message } => {
                at.file = at.file.take().map(named);
                Error::Syntax { at, message }
            }
            Error::Unsupported { mut at, feature } => {
                at.file = at.file.take().map(named);
                Error::Unsupported { at, feature }
            }
            Error::Interrupted => Error::Interrupted,
        }
    }

    /// Moves the output to its final name once it is on the disk. What was there before is removed only after that.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be renamed: then what stood there before still does.
    pub fn commit(mut self) -> Result<()> {
        for stray in &self.kept {
            let (from, to) = (self.target.join(stray), self.path.join(stray));
            if to.symlink_metadata().is_err() && to.parent().is_some_and(Path::is_dir) {
                let kept = fs::hard_link(&from, &to).or_else(|_| fs::copy(&from, &to).map(drop));
                kept.map_err(|e| Error::io(&from, "keeping this file", e))?;
            }
        }
        let Some(staging) = self.staging.take() else { return Ok(()) };
        match staging.commit(self.replace) {
            Ok(()) => {
                self.made.clear();
                Ok(())
            }
            Err(error) => {
                self.staging = Some(staging);
                Err(error)
            }
        }
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        under_way().retain(|(hidden, _)| self.path.parent() != Some(hidden));
        self.staging = None;
        // A failure here cannot be helped: the error that led here is the one to report.
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// The target that is really replaced: what a link leads to, not the link.
fn resolved(target: &Path, replace: bool) -> Result<PathBuf> {
    match target.symlink_metadata() {
        Ok(_) if !replace => {
            let problem = Problem::new(Location::file(target), "exists")
                .with_help("choose another name, or replace it with --force");
            Err(Error::Invalid(vec![problem]))
        }
        Ok(about) if about.is_symlink() => {
            target.canonicalize().map_err(|e| Error::io(target, "following this link", e))
        }
        Err(e) if e.kind() == ErrorKind::InvalidFilename => Err(Error::io(target, "making this file", e)),
        _ => Ok(target.to_owned()),
    }
}

fn named_by(target: &Path) -> Result<&OsStr> {
    target.file_name().ok_or_else(|| {
        let message = "has no name that a product could take: give a path that ends in one";
        Error::invalid(Location::file(target), message)
    })
}

fn is_file_name(target: &Path, replace: bool) -> Result<()> {
    if target.is_dir() {
        return Err(Error::invalid(Location::file(target), "is a folder; name a file"));
    }
    if replace && target.exists() && !target.is_file() {
        return Err(Error::invalid(Location::file(target), "is not a file, so it is not replaced"));
    }
    Ok(())
}

/// Refuses an input that is one of the targets, or lies in one that is a folder: by whatever name, link, or case of
/// letters.
///
/// # Errors
/// [`Error::Invalid`] with all of them.
pub fn spares<'a>(targets: &[PathBuf], inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    let targets: Vec<(&PathBuf, Option<FileId>, Option<PathBuf>)> =
        targets.iter().map(|target| (target, file_id(target), target.canonicalize().ok())).collect();
    let mut problems = Vec::new();
    for input in inputs {
        let (id, real) = (file_id(input), input.canonicalize().ok());
        let is_in = |(_, target_id, target): &&(&PathBuf, Option<FileId>, Option<PathBuf>)| {
            (id.is_some() && *target_id == id)
                || real.as_ref().zip(target.as_ref()).is_some_and(|(real, target)| real.starts_with(target))
        };
        if let Some((target, ..)) = targets.iter().find(is_in) {
            let target = target.strip_prefix(".").unwrap_or(target);
            let message = format!("would be replaced, but {} is read for it", input.display());
            let problem = Problem::new(Location::file(target), message).with_help("choose another name for the output");
            if !problems.contains(&problem) {
                problems.push(problem);
            }
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
}

/// What identifies a file, whatever name it is reached by.
#[cfg(unix)]
type FileId = (u64, u64);
#[cfg(not(unix))]
type FileId = PathBuf;

#[cfg(unix)]
fn file_id(path: &Path) -> Option<FileId> {
    use std::os::unix::fs::MetadataExt;
    path.metadata().ok().map(|about| (about.dev(), about.ino()))
}

#[cfg(not(unix))]
fn file_id(path: &Path) -> Option<FileId> {
    path.canonicalize().ok()
}

/// Whether a file is one that other programs leave wherever they look: file managers, editors, image viewers.
fn is_stray(name: &str) -> bool {
    const NAMES: [&str; 5] = [".DS_Store", ".directory", "Thumbs.db", "desktop.ini", ".localized"];
    // Resource forks of macOS; locks of editors; files that were open when they were removed.
    const STARTS: [&str; 5] = ["._", ".#", ".~lock.", ".nfs", ".fuse_hidden"];
    // Statistics and overviews of GDAL and ENVI; what editors keep.
    const ENDS: [&str; 9] = [".aux.xml", ".ovr", ".enp", ".sta", "~", ".bak", ".swp", ".swo", ".orig"];
    NAMES.iter().any(|n| name.eq_ignore_ascii_case(n))
        || STARTS.iter().any(|start| name.starts_with(start))
        || ENDS.iter().any(|end| name.ends_with(end))
}

/// All strays in a folder, by their names from there.
fn strays(folder: &Path, inside: &Path, found: &mut Vec<PathBuf>) {
    // A file that cannot be inspected does not prevent writing: it is reported if it turns out to be in the way.
    let Ok(entries) = folder.join(inside).read_dir() else { return };
    for entry in entries.filter_map(std::result::Result::ok) {
        let path = inside.join(entry.file_name());
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => strays(folder, &path, found),
            Ok(kind) if kind.is_file() && is_stray(&entry.file_name().to_string_lossy()) => found.push(path),
            _ => {}
        }
    }
    found.sort();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty_folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("mmxrt-folder-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        path
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            folder.read_dir().unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn product(target: &Path, text: &str) {
        let staged = Staged::folder(target, true).unwrap();
        std::fs::write(staged.path().join("report.json"), text).unwrap();
        staged.commit().unwrap();
    }

    #[test]
    fn a_product_appears_whole_or_not_at_all() {
        let top = empty_folder("whole");
        let target = top.join("a/b/product");
        {
            let staged = Staged::folder(&target, false).unwrap();
            std::fs::write(staged.path().join("cube.img"), "half").unwrap();
            assert!(!target.exists());
        }
        assert_eq!(names(&top), [""; 0], "what was dropped left something behind");
        let staged = Staged::folder(&target, false).unwrap();
        std::fs::write(staged.path().join("cube.img"), "all").unwrap();
        staged.commit().unwrap();
        assert_eq!(names(&top.join("a/b")), ["product"]);
        assert_eq!(std::fs::read_to_string(target.join("cube.img")).unwrap(), "all");
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn what_exists_is_replaced_only_on_request_and_only_if_it_is_a_product() {
        let top = empty_folder("force");
        let target = top.join("product");
        product(&target, "old");
        assert!(Staged::folder(&target, false).unwrap_err().to_string().contains("exists"));
        product(&target, "new");
        assert_eq!(std::fs::read_to_string(target.join("report.json")).unwrap(), "new");
        assert_eq!(names(&top), ["product"]);

        let home = top.join("thesis");
        std::fs::create_dir(&home).unwrap();
        std::fs::write(home.join("chapter1.tex"), "years of work").unwrap();
        assert!(Staged::folder(&home, true).unwrap_err().to_string().contains("not a product folder"));
        assert_eq!(names(&home), ["chapter1.tex"]);
        // A report makes it no product folder: the chapter is still no part of one.
        std::fs::write(home.join("report.json"), "{}").unwrap();
        assert!(Staged::folder(&home, true).unwrap_err().to_string().contains("\"chapter1.tex\""));
        assert_eq!(names(&home), ["chapter1.tex", "report.json"]);
        assert_eq!(names(&top), ["product", "thesis"]);
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn a_failed_rename_leaves_the_old_product_in_place() {
        let top = empty_folder("rename");
        let target = top.join("product");
        product(&target, "old");
        let staged = Staged::folder(&target, true).unwrap();
        std::fs::remove_dir(staged.path()).unwrap();
        let error = staged.commit().unwrap_err();
        assert!(matches!(&error, Error::Io { path, .. } if *path == target), "{error}");
        assert_eq!(std::fs::read_to_string(target.join("report.json")).unwrap(), "old");
        assert_eq!(names(&top), ["product"]);
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    #[cfg(unix)]
    fn what_a_link_leads_to_is_replaced() {
        let top = empty_folder("link");
        let link = top.join("link");
        product(&top.join("real"), "old");
        std::os::unix::fs::symlink("real", &link).unwrap();
        assert!(Staged::folder(&link, false).unwrap_err().to_string().contains("exists"));
        product(&link, "new");
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(top.join("real/report.json")).unwrap(), "new");
        std::fs::remove_file(&link).unwrap();
        std::os::unix::fs::symlink("nowhere", &link).unwrap();
        // Before anything is computed, not after.
        assert!(Staged::folder(&link, true).unwrap_err().to_string().contains("link: following this link"));
        assert_eq!(names(&top), ["link", "real"]);
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn only_a_file_is_replaced_by_a_file_and_a_folder_by_a_folder() {
        let top = empty_folder("kinds");
        std::fs::write(top.join("table.npz"), "one").unwrap();
        assert!(
            Staged::folder(&top.join("table.npz"), true).unwrap_err().to_string().ends_with("is a file; name a folder")
        );
        #[cfg(unix)]
        assert!(Staged::file(Path::new("/dev/null"), true).unwrap_err().to_string().contains("is not a file"));
        assert_eq!(names(&top), ["table.npz"]);
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn a_file_is_staged_too() {
        let top = empty_folder("file");
        let target = top.join("table.npz");
        drop(Staged::file(&target, false).unwrap());
        let staged = Staged::file(&target, false).unwrap();
        std::fs::write(staged.path(), "half").unwrap();
        drop(staged);
        assert_eq!(names(&top), [""; 0]);
        for (text, replace) in [("one", false), ("two", true)] {
            let staged = Staged::file(&target, replace).unwrap();
            std::fs::write(staged.path(), text).unwrap();
            staged.commit().unwrap();
            assert_eq!(std::fs::read_to_string(&target).unwrap(), text);
        }
        assert!(Staged::file(&target, false).is_err());
        assert!(Staged::file(&top, true).is_err());
        assert!(Staged::file(Path::new(".."), true).is_err());
        assert_eq!(names(&top), ["table.npz"]);
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn errors_name_what_is_staged_by_its_final_name() {
        let top = empty_folder("named");
        let told = |staged: &Staged, path: PathBuf| {
            staged.named(Error::io(path, "writing", ErrorKind::StorageFull.into())).to_string()
        };
        let folder = Staged::folder(&top.join("product"), false).unwrap();
        let cube = told(&folder, folder.path().join("cube.img"));
        assert!(cube.starts_with(&format!("{}: writing: ", top.join("product/cube.img").display())), "{cube}");
        let invalid = folder.named(Error::invalid(Location::file(folder.path().join("cube.exr")), "x")).to_string();
        assert_eq!(invalid, format!("{}: x", top.join("product/cube.exr").display()));
        let file = Staged::file(&top.join("table.npz"), false).unwrap();
        let table = told(&file, file.path().to_owned());
        assert!(table.starts_with(&format!("{}: writing: ", top.join("table.npz").display())), "{table}");
        assert!(told(&file, top.join("other")).starts_with(&top.join("other").display().to_string()));
        drop((folder, file));
        std::fs::remove_dir_all(top).unwrap();
    }

    #[test]
    fn a_place_that_cannot_hold_a_folder_is_named() {
        let top = empty_folder("nofolder");
        std::fs::write(top.join("file"), "").unwrap();
        let error = Staged::folder(&top.join("file/product"), false).unwrap_err();
        assert!(matches!(&error, Error::Io { path, .. } if *path == top.join("file")), "{error}");
        std::fs::remove_dir_all(top).unwrap();
    }
}
