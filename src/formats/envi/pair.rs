//! The two files of an image: a header and its numbers.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};

/// What data files of images are called, besides by their satellite's or nothing.
pub(in crate::formats) const ENDINGS: [&str; 6] = ["img", "dat", "bsq", "bil", "bip", "raw"];

/// The header and the data file of one image, whichever of the two is named.
///
/// # Errors
/// [`Error::Invalid`] if the other one is not there.
pub fn pair(path: &Path) -> Result<(PathBuf, PathBuf)> {
    let is_header = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("hdr"));
    let appended = {
        let mut name = path.as_os_str().to_owned();
        name.push(".hdr");
        PathBuf::from(name)
    };
    let found = if is_header {
        let bare = path.with_extension("");
        let endings = ENDINGS.iter().chain(&["sli"]);
        let candidates = endings.clone().map(|e| path.with_extension(e));
        let in_capitals = endings.map(|e| path.with_extension(e.to_uppercase()));
        candidates.chain(in_capitals).chain([bare]).find(|p| p.is_file()).map(|data| (path.to_owned(), data))
    } else {
        let in_capitals = path.with_extension("HDR");
        [path.with_extension("hdr"), appended, in_capitals]
            .into_iter()
            .find(|p| p.is_file())
            .map(|header| (header, path.to_owned()))
    };
    // Of a link, where it leads to: the other is there too, or the error tells of the link.
    let target = || path.canonicalize().ok().filter(|_| path.is_symlink()).and_then(|target| pair(&target).ok());
    found.or_else(target).ok_or_else(|| {
        let (other, help) = if is_header {
            ("data file", "it has the header's name with .img, .dat, .bsq, .bil, .bip, .raw, .sli, or without .hdr")
        } else {
            ("header", "it has the data file's name with .hdr")
        };
        let problem = Problem::new(Location::file(path), format!("its {other} is not beside it")).with_help(help);
        Error::Invalid(vec![problem])
    })
}

/// The header to write for a data file; not one by which another image is read, which would be lost.
///
/// # Errors
/// [`Error::Invalid`] if there is such an image.
pub(in crate::formats) fn header_of(data: &Path) -> Result<PathBuf> {
    let header = data.with_extension("hdr");
    let is_there = |path: &Path| path.symlink_metadata().is_ok();
    match pair(&header) {
        Ok((_, other)) if is_there(&header) && !is_there(data) => {
            let problem = Problem::new(Location::file(&header), format!("is the header of {}", other.display()))
                .with_help("choose another name for the output");
            Err(Error::Invalid(vec![problem]))
        }
        _ => Ok(header),
    }
}
