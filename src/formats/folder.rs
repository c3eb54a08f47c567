//! What is half written never stands under its final name.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};

/// A file or folder that is written under a hidden name beside its final one, and renamed when complete.
///
/// Dropped before [`commit`](Staged::commit), it leaves nothing: not even the folders made to hold it.
#[derive(Debug)]
pub struct Staged {
    target: PathBuf,
    path: PathBuf,
    replace: bool,
    /// Folders above the target that were not there before, outermost first.
    made: Vec<PathBuf>,
    committed: bool,
}

/// A kind of folder that is written, and so may be replaced.
#[derive(Debug)]
pub struct FolderKind {
    /// A folder that holds one of these is of the kind, or one staged as such; no other folder is ever replaced.
    pub marks: &'static [&'static str],
    /// What such a folder may hold; with another ending behind it, what other programs put beside it (`cube.img.aux.xml`).
    /// A folder with anything else in it is not replaced either.
    pub parts: &'static [&'static str],
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
        "thermal.img",
        "thermal.hdr",
        "backplanes.img",
        "backplanes.hdr",
        "quicklook.png",
        "quicklook_rgb.png",
        "table.npz",
        "footprints.npz",
    ],
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
        let staged = Self::new(target, replace)?;
        if replace && target.exists() {
            let reading = |e| Error::io(target, "reading", e);
            let entries = target.read_dir().map_err(reading)?;
            let names: Vec<_> = entries.map(|e| Ok(e?.file_name())).collect::<std::io::Result<_>>().map_err(reading)?;
            let refused = |message: String| {
                let help = "remove it yourself, or choose another name";
                Err(Error::Invalid(vec![Problem::new(Location::file(target), message).with_help(help)]))
            };
            if !names.is_empty() && !kind.marks.iter().any(|mark| target.join(mark).is_file()) {
                return refused("is not a product folder, so it is not replaced".into());
            }
            let is_part = |name: &str| {
                let after =
                    |part: &str| name.strip_prefix(part).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
                kind.parts.iter().any(|part| after(part))
            };
            if let Some(other) = names.iter().map(|name| name.to_string_lossy()).find(|name| !is_part(name)) {
                return refused(format!("holds {other:?}, which is no part of a product, so it is not replaced"));
            }
        }
        std::fs::create_dir(&staged.path).map_err(|e| Error::io(target, "making this folder", e))?;
        Ok(staged)
    }

    /// A name to write a file to.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the target exists and `replace` is false, or is a folder or a device;
    /// [`Error::Io`] if the folder around it cannot be made.
    pub fn file(target: &Path, replace: bool) -> Result<Self> {
        if target.is_dir() {
            return Err(Error::invalid(Location::file(target), "is a folder; name a file"));
        }
        if replace && target.exists() && !target.is_file() {
            return Err(Error::invalid(Location::file(target), "is no file, so it is not replaced"));
        }
        Self::new(target, replace)
    }

    fn new(target: &Path, replace: bool) -> Result<Self> {
        // What a link leads to is replaced, not the link.
        let target = match replace && target.is_symlink() {
            true => &target.canonicalize().map_err(|e| Error::io(target, "following this link", e))?,
            false => target,
        };
        let Some(name) = target.file_name() else {
            return Err(Error::invalid(
                Location::file(target),
                "has no name that a product could take: give a path that ends in one",
            ));
        };
        if !replace && target.symlink_metadata().is_ok() {
            let problem = Problem::new(Location::file(target), "exists")
                .with_help("choose another name, or replace it with --force");
            return Err(Error::Invalid(vec![problem]));
        }
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut made: Vec<PathBuf> =
            parent.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).map(Path::to_owned).collect();
        made.reverse();
        let mut staged = Staged { target: target.to_owned(), path: PathBuf::new(), replace, made, committed: false };
        std::fs::create_dir_all(parent).map_err(|e| Error::io(parent, "making this folder", e))?;
        staged.path = free_name(parent, name, "partial")?;
        Ok(staged)
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// An error that names what is written by the final name, which is the one its reader knows.
    #[must_use]
    pub fn named(&self, error: Error) -> Error {
        let named = |path: PathBuf| match path.strip_prefix(&self.path) {
            Ok(inside) if inside.as_os_str().is_empty() => self.target.clone(),
            Ok(inside) => self.target.join(inside),
            Err(_) => path,
        };
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

    /// Gives what is written its final name. What stood there before is removed only after that.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be renamed: then what stood there before still does.
    pub fn commit(mut self) -> Result<()> {
        let failed = |path: &Path, e| Error::io(path, "giving the product its final name", e);
        if self.path.is_file() {
            std::fs::rename(&self.path, &self.target).map_err(|e| failed(&self.target, e))?;
        } else if self.replace && self.target.exists() {
            let parent = self.path.parent().unwrap_or(Path::new("."));
            let old = free_name(parent, self.target.file_name().unwrap_or_default(), "old")?;
            std::fs::rename(&self.target, &old).map_err(|e| failed(&self.target, e))?;
            if let Err(e) = std::fs::rename(&self.path, &self.target) {
                let back = std::fs::rename(&old, &self.target);
                return Err(failed(if back.is_ok() { &self.target } else { &old }, e));
            }
            self.committed = true;
            std::fs::remove_dir_all(&old).map_err(|e| Error::io(&old, "removing what was replaced", e))?;
        } else if self.target.symlink_metadata().is_ok() {
            return Err(failed(&self.target, ErrorKind::AlreadyExists.into()));
        } else {
            std::fs::rename(&self.path, &self.target).map_err(|e| failed(&self.target, e))?;
        }
        self.committed = true;
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if self.committed {
            return;
        }
        // Nothing more can be done about what fails here: the error that led here is the one to tell.
        if self.path.is_dir() {
            let _ = std::fs::remove_dir_all(&self.path);
        } else if self.path.is_file() {
            let _ = std::fs::remove_file(&self.path);
        }
        for folder in self.made.iter().rev() {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// A hidden name in `parent` that nothing has yet.
fn free_name(parent: &Path, name: &std::ffi::OsStr, suffix: &str) -> Result<PathBuf> {
    (0..1000)
        .map(|i| {
            let mut hidden = std::ffi::OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{i}.{suffix}"));
            parent.join(hidden)
        })
        .find(|p| p.symlink_metadata().is_err())
        .ok_or_else(|| Error::io(parent, "finding a free hidden name", ErrorKind::AlreadyExists.into()))
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
        assert!(Staged::file(Path::new("/dev/null"), true).unwrap_err().to_string().contains("is no file"));
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
