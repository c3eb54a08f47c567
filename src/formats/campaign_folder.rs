//! The folder of a campaign: the state of each acquisition, and the coverage of all.
//!
//! ```text
//! products/NAME/      the product folder of an acquisition
//! sights/NAME.npz     what it sees of each facet
//! failed/NAME.json    why it could not be made, until it is
//! manifest.json       all of them, once each is there or has failed
//! coverage.csv        how each facet has been seen; coverage_sampling.png and coverage_count.png: maps of it
//! ```
//!
//! Each of these appears when complete, with a hash of its inputs. That is the only state, so several processes can
//! share a folder, and any of them can be killed.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::folder::{self, Staged, settle};
use super::manifest_json::{FORMAT, Manifest};
use super::product_folder::{self, ProductFolder, ProductOptions};
use super::report_json::{self, ProductReport, Run};
use super::{coverage_csv, coverage_map, npz, staging};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::envi::Precision;
use crate::product::{Coverage, Sights};
use crate::scene::Body;
use crate::study::SurfaceMap;

/// The command recorded in run.json of a campaign's products.
pub const COMMAND: &str = "campaign";
const PRODUCTS: &str = "products";
const SIGHTS: &str = "sights";
const FAILED: &str = "failed";
const MANIFEST: &str = "manifest.json";
const COVERAGE: [&str; 3] = ["coverage.csv", "coverage_sampling.png", "coverage_count.png"];

/// A campaign's folder.
#[derive(Debug)]
pub struct CampaignFolder(PathBuf);

/// Why an acquisition could not be made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// The id of its request.
    pub entry: String,
    /// All that was wrong.
    pub errors: Vec<String>,
}

impl CampaignFolder {
    /// Opens a folder that is a campaign's, empty, or not there yet, and that contains none of the campaign's inputs.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is something else; [`Error::Io`].
    pub fn open<'a>(path: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self> {
        let refused = |message: &str| {
            let help = "choose another folder, or one that is not there yet";
            Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
        };
        let folder = CampaignFolder(path.to_owned());
        match path.read_dir() {
            Err(e) if e.kind() == ErrorKind::NotFound && path.is_symlink() => return refused("is a link to nothing"),
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Err(_) if path.is_file() => return refused("is a file"),
            Err(e) => return Err(Error::io(path, "reading", e)),
            Ok(entries) => {
                let mut names =
                    entries.filter_map(|entry| Some(entry.ok()?.file_name().into_string().unwrap_or_default()));
                let is_ours = [PRODUCTS, SIGHTS, FAILED].iter().any(|name| path.join(name).is_dir());
                let says_so = || fs::read_to_string(path.join(MANIFEST)).is_ok_and(|text| text.contains(FORMAT));
                if !is_ours && !says_so() && names.any(|name| !name.starts_with('.')) {
                    return refused("holds something else than a campaign");
                }
            }
        }
        let made = [PRODUCTS, SIGHTS, FAILED, MANIFEST].iter().chain(&COVERAGE);
        folder::spares(&made.map(|name| path.join(name)).collect::<Vec<_>>(), inputs)?;
        Ok(folder)
    }

    /// Whether an error means that another process is making the same.
    pub fn is_busy(error: &Error) -> bool {
        staging::is_busy(error)
    }

    /// Path of an acquisition's product.
    pub fn product(&self, name: &str) -> PathBuf {
        self.0.join(PRODUCTS).join(name)
    }

    /// Path of an acquisition's facet sightings.
    pub fn sights(&self, name: &str) -> PathBuf {
        self.0.join(SIGHTS).join(format!("{name}.npz"))
    }

    fn failure_path(&self, name: &str) -> PathBuf {
        self.0.join(FAILED).join(format!("{name}.json"))
    }

    /// Path of the manifest.
    pub fn manifest(&self) -> PathBuf {
        self.0.join(MANIFEST)
    }

    /// Finishes or removes leftovers of killed runs of an acquisition; says so.
    ///
    /// # Errors
    /// Those of [`settle`].
    pub fn settle(&self, name: &str) -> Result<Vec<String>> {
        let mut said = Vec::new();
        for path in [self.product(name), self.sights(name), self.failure_path(name)] {
            // Testing for a name is cheaper than listing a folder of thousands.
            if staging::is_staged(&path) {
                said.extend(settle(&path, true)?);
            }
        }
        Ok(said)
    }

    /// Whether an acquisition's sightings are there, complete, and made from this.
    pub fn has_sights(&self, name: &str, id: &str) -> bool {
        npz::sights_id(&self.sights(name)).is_ok_and(|found| found == id)
    }

    /// Whether somebody is making something of an acquisition; of what killed runs have left [`settle`](Self::settle) comes first.
    pub fn is_being_made(&self, name: &str) -> bool {
        [self.product(name), self.sights(name)].iter().any(|path| staging::is_staged(path))
    }

    /// The report of an acquisition's product, if that is there, complete, and made from this.
    pub fn product_report(&self, name: &str, id: &str, options: &ProductOptions) -> Option<ProductReport> {
        let folder = self.product(name);
        let report = report_json::read::<ProductReport>(&folder.join("report.json")).ok()?;
        let image = &report.image;
        let width = match options.precision {
            Precision::U16 => 2,
            Precision::F32 | Precision::U32 => 4,
            Precision::F64 => 8,
        };
        let cube_bytes = image.samples * image.lines * image.bands * width;
        // What it was made with is in the run, and what of that is still there, in the folder.
        let run = report_json::read::<Run>(&folder.join("run.json")).ok()?;
        let found = product_folder::files(&folder).ok()?;
        let is_there = |(name, bytes): (&String, &u64)| {
            found.binary_search_by(|(other, _)| other.cmp(name)).is_ok_and(|place| found[place].1 == *bytes)
        };
        let mut wanted = options.formats.files("cube");
        if options.split {
            wanted.extend(options.formats.files("thermal"));
        }
        let parts = [(options.exr, "cube.exr"), (options.table, "table.npz"), (options.footprints, "footprints.npz")];
        wanted.extend(parts.iter().filter(|(is_wanted, _)| *is_wanted).map(|(_, part)| (*part).to_owned()));
        let is_whole = report.scene == id
            && run.files.get("cube.img").is_none_or(|bytes| *bytes == cube_bytes)
            && wanted.iter().all(|part| run.files.contains_key(part))
            && run.files.iter().all(is_there);
        is_whole.then_some(report)
    }

    /// Makes an acquisition's sightings and writes them: other processes see at once that they are being made.
    ///
    /// # Errors
    /// Those of `make` and of [`Staged::file`]; [`Error::Io`].
    pub fn put_sights(&self, name: &str, id: &str, make: impl FnOnce() -> Result<Sights>) -> Result<()> {
        let staged = Staged::file(&self.sights(name), true)?;
        npz::write_sights(staged.path(), &make()?, id).map_err(|e| staged.named(e))?;
        staged.commit()
    }

    /// Reads an acquisition's sightings of a mesh of so many facets.
    ///
    /// # Errors
    /// Those of [`npz::read_sights`].
    pub fn read_sights(&self, name: &str, facets: usize) -> Result<Sights> {
        Ok(npz::read_sights(&self.sights(name), facets)?.0)
    }

    /// Begins an acquisition's product, replacing an older one of a campaign.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a product that no campaign made; those of [`ProductFolder::stage`].
    pub fn stage(&self, name: &str, options: ProductOptions) -> Result<ProductFolder> {
        let path = self.product(name);
        if report_json::read::<Run>(&path.join("run.json")).is_ok_and(|run| run.command != COMMAND) {
            let help = "move it away, or give the acquisition another name";
            let problem = Problem::new(Location::file(&path), "is a product that no campaign made");
            return Err(Error::Invalid(vec![problem.with_help(help)]));
        }
        ProductFolder::stage(&path, true, options)
    }

    /// Records why an acquisition failed.
    ///
    /// # Errors
    /// Those of [`Staged::file`]; [`Error::Io`].
    pub fn put_failure(&self, name: &str, failure: &Failure) -> Result<()> {
        let staged = Staged::file(&self.failure_path(name), true)?;
        let text = serde_json::to_string_pretty(failure).unwrap_or_default();
        staged.put(staged.path(), |out| writeln!(out, "{text}"))?;
        staged.commit()
    }

    /// The recorded failure of an acquisition, if it was the same request.
    pub fn failure(&self, name: &str, entry: &str) -> Option<Failure> {
        let text = fs::read_to_string(self.failure_path(name)).ok()?;
        serde_json::from_str(&text).ok().filter(|failure: &Failure| failure.entry == entry)
    }

    /// Removes the record of a failure once the acquisition is made.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn clear_failure(&self, name: &str) -> Result<()> {
        let path = self.failure_path(name);
        match fs::remove_file(&path) {
            Ok(()) => {
                // The folder goes with the last of them.
                let _ = fs::remove_dir(self.0.join(FAILED));
                Ok(())
            }
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
            Err(e) => Err(Error::io(&path, "removing", e)),
        }
    }

    /// Writes manifest, coverage table and maps, which appear together. `false` if another process is doing so.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn finish(&self, manifest: &Manifest, coverage: &Coverage, body: &Body) -> Result<bool> {
        let mut staged = match Staged::file(&self.manifest(), true) {
            Err(error) if staging::is_busy(&error) => return Ok(false),
            staged => staged?,
        };
        let [table, sampling, count] = COVERAGE.map(|name| staged.beside(&self.0.join(name)));
        let (table, sampling, count) = (table?, sampling?, count?);
        staged.put(&table, |out| coverage_csv::write(out, coverage, body))?;
        let map = SurfaceMap::new(body);
        let percent = |share: f64| format!("{:.1}", 100.0 * share);
        let seen = &manifest.coverage.seen;
        let said = format!(
            "{} acquisitions; {} to {} % of the surface seen{}",
            manifest.acquisitions.len(),
            percent(seen.at_least),
            percent(seen.at_most),
            if coverage.rule.in_sunlight { " in sunlight" } else { "" }
        );
        for (path, png) in [
            (sampling, coverage_map::sampling(&map, coverage, &said)),
            (count, coverage_map::count(&map, coverage, &said)),
        ] {
            staged.put(&path, |out| out.write_all(&png))?;
        }
        let text = serde_json::to_string_pretty(manifest).unwrap_or_default();
        staged.put(staged.path(), |out| writeln!(out, "{text}"))?;
        staged.commit()?;
        Ok(true)
    }

    /// Names of products that belong to no acquisition of the campaign.
    pub fn others<'a>(&self, names: impl Iterator<Item = &'a str>) -> Vec<String> {
        let mut known: Vec<&str> = names.collect();
        known.sort_unstable();
        let found = product_folder::files(&self.0.join(PRODUCTS)).unwrap_or_default().into_iter().map(|(name, _)| name);
        found.filter(|name| !name.starts_with('.') && known.binary_search(&name.as_str()).is_err()).collect()
    }
}
