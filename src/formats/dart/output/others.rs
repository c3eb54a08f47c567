//! What a simulation's `output/` holds that is not a map here: listed by name, and otherwise ignored.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::error::Result;

use super::{ImageQuantity, band_number, budget, names, properties};

/// At most this many are listed one by one.
const TOLD: usize = 40;

/// Folders and files of an output that are not `read`, sorted; those of all bands as one. `is_wanted`: what lies in or around what is
/// asked for.
pub(super) fn passed_over(folder: &Path, read: &[PathBuf], is_wanted: &dyn Fn(&Path) -> bool) -> Result<Vec<String>> {
    let mut found = BTreeSet::new();
    for name in names(folder)? {
        let path = folder.join(&name);
        if name == properties::FILE || read.contains(&path) || !is_wanted(&path) {
            continue;
        }
        if band_number(&name).is_none() {
            found.insert(shown(&path, &name));
            continue;
        }
        for quantity in names(&path)? {
            let within = path.join(&quantity);
            let in_band = format!("BAND*/{quantity}");
            let is_known =
                ImageQuantity::ALL.iter().any(|known| known.name() == quantity) || quantity == budget::FOLDER;
            if !is_wanted(&within) {
            } else if is_known && within.is_dir() {
                for iteration in names(&within)? {
                    let path = within.join(&iteration);
                    let is_read = read.iter().any(|file| file.starts_with(&path));
                    if !is_read && is_wanted(&path) {
                        found.insert(shown(&path, &format!("{in_band}/{iteration}")));
                    }
                }
            } else {
                found.insert(shown(&within, &in_band));
            }
        }
    }
    let more = found.len().saturating_sub(TOLD);
    let mut told: Vec<String> = found.into_iter().take(TOLD).collect();
    if more > 0 {
        told.push(format!("and {more} more"));
    }
    Ok(told)
}

fn shown(path: &Path, name: &str) -> String {
    if path.is_dir() { format!("{name}/") } else { name.to_owned() }
}
