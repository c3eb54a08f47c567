//! A product folder: cube, backplanes, pictures, reports, and what else is asked for.

use std::path::{Path, PathBuf};

use super::envi::{self, Interleave, Precision};
use super::folder::Staged;
use super::report_json::{self, BandEntry, ImageEntry, Input, ProductReport, Run};
use super::subject::Subject;
use super::{exr_cube, machine, npz, quicklook};
use crate::error::{Error, Location, Problem, Result};
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::spectral::Band;
use crate::study::{self, Check, MapAccount, Observation};

/// How a product is written, and what of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProductOptions {
    /// Order of the cube's numbers.
    pub interleave: Interleave,
    /// Precision of the cube's numbers.
    pub precision: Precision,
    /// The cube as spectral OpenEXR as well.
    pub exr: bool,
    /// Which facets each pixel sees as well.
    pub footprints: bool,
    /// The facet table as well: not of what maps send.
    pub table: bool,
    /// The thermal part of the cube as well: not of what maps send.
    pub split: bool,
}

impl Default for ProductOptions {
    /// Band by band in single precision, and nothing besides.
    fn default() -> Self {
        ProductOptions {
            interleave: Interleave::Bsq,
            precision: Precision::F32,
            exr: false,
            footprints: false,
            table: false,
            split: false,
        }
    }
}

/// What a product folder is written from.
#[derive(Debug, Clone)]
pub struct Product {
    /// The scene.
    pub subject: Subject,
    /// What reaches its facets.
    pub table: FacetTable,
    /// The file that the table was read from, if it was.
    pub table_from: Option<PathBuf>,
    /// What the camera sees.
    pub observation: Observation,
    /// The maps that it was made from, if it was.
    pub maps: Option<MapAccount>,
}

/// A product folder that is being made, hidden until it is whole.
#[derive(Debug)]
pub struct ProductFolder {
    staged: Staged,
    options: ProductOptions,
}

/// What has been written.
#[derive(Debug, Clone)]
pub struct Written {
    /// What it was written from.
    pub product: Product,
    /// Its report.
    pub report: ProductReport,
    /// What other programs had put into the folder that was replaced, and was kept: names in it.
    pub kept: Vec<PathBuf>,
}

impl ProductFolder {
    /// Begins a folder, before anything is computed: it may not be possible.
    ///
    /// # Errors
    /// Those of [`Staged::folder`].
    pub fn stage(target: &Path, replace: bool, options: ProductOptions) -> Result<Self> {
        Ok(ProductFolder { staged: Staged::folder(target, replace)?, options })
    }

    /// How it will be written, and what of it.
    pub fn options(&self) -> &ProductOptions {
        &self.options
    }

    /// Says, before anything is computed, if the product has no room in memory or on the disk, or would replace what it is made from:
    /// its subject's files, and these.
    ///
    /// # Errors
    /// [`Error::Invalid`].
    pub fn admit<'a>(
        &self,
        subject: &'a Subject,
        more_inputs: impl IntoIterator<Item = &'a PathBuf>,
        has_maps: bool,
    ) -> Result<()> {
        let ProductOptions { precision, exr, split, table, .. } = self.options;
        if has_maps && (split || table) {
            let message = "neither a facet table nor a thermal part belongs to what maps send";
            return Err(Error::invalid(Location::item("options"), message));
        }
        let inputs = subject.inputs.iter().map(|input| &input.path).chain(more_inputs);
        self.staged.spares(inputs.map(PathBuf::as_path))?;
        study::has_room(&subject.scene, has_maps, machine::memory_bytes())?;
        let number_bytes = match precision {
            Precision::F32 => 4,
            Precision::F64 => 8,
        };
        let cubes_bytes = number_bytes * if split { 2 } else { 1 } + if exr { 4 } else { 0 };
        self.staged.has_room(study::product_bytes(&subject.scene, cubes_bytes))
    }

    /// Writes everything and gives the folder its name. A product of which a check does not hold is not written.
    ///
    /// `run` is asked last what `run.json` is to say: date, threads and timings are known to the caller only.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the checks that do not hold; [`Error::Io`]; [`Error::Interrupted`] if `watch` asks to stop.
    pub fn write(self, product: Product, run: impl FnOnce() -> Run, watch: Watch<'_>) -> Result<Written> {
        verify(&product.observation.checks, product.table_from.as_deref())?;
        let report = self.write_files(&product, run, watch).map_err(|e| self.staged.named(e))?;
        let kept = self.staged.kept().to_vec();
        self.staged.commit()?;
        Ok(Written { product, report, kept })
    }

    fn write_files(&self, product: &Product, run: impl FnOnce() -> Run, watch: Watch<'_>) -> Result<ProductReport> {
        let file = |name: &str| self.staged.path().join(name);
        let ProductOptions { interleave, precision, exr, table: with_table, split, .. } = self.options;
        let Product { subject, table, observation, .. } = product;
        let (cube, planes) = (&observation.cube, &observation.backplanes);
        let coverage = planes.plane("COVERAGE").map_or(&[][..], |plane| &plane.values);
        let instrument = &subject.scene.exposure.instrument;
        let title = |what: &str| format!("{what} by mmxrt {} of {instrument}", env!("CARGO_PKG_VERSION"));

        envi::write_cube(&file("cube.img"), cube, interleave, precision, &title("Radiance"), watch)?;
        if split {
            let title = title("Thermal part of the radiance");
            envi::write_cube(&file("thermal.img"), &cube.thermal(), interleave, precision, &title, watch)?;
        }
        if exr {
            exr_cube::write(&file("cube.exr"), cube, &title("Radiance"), watch)?;
        }
        tell(watch, "writing backplanes", 0, 1)?;
        // Always in double precision: positions in metres have more digits than f32 holds.
        envi::write_backplanes(&file("backplanes.img"), planes, Precision::F64, &title("Backplanes"))?;
        if let Some(footprints) = &observation.footprints {
            npz::write_footprints(&file("footprints.npz"), footprints, &subject.id)?;
        }
        if with_table {
            npz::write_table(&file("table.npz"), table, &study::table_id(&subject.scene))?;
        }
        tell(watch, "writing pictures and reports", 0, 1)?;
        quicklook::write_grey(&file("quicklook.png"), cube, quicklook::grey_band(&cube.bands), coverage)?;
        quicklook::write_colour(&file("quicklook_rgb.png"), cube, quicklook::colour_bands(&cube.bands), coverage)?;
        let report = report(product, coverage);
        report_json::write(&file("report.json"), &report)?;
        tell(watch, "writing pictures and reports", 1, 1)?;
        report_json::write(&file("run.json"), &run())?;
        Ok(report)
    }
}

/// Names and sizes, bytes, of what is in a product folder, by name.
///
/// # Errors
/// [`Error::Io`].
pub fn files(folder: &Path) -> Result<Vec<(String, u64)>> {
    let io = |e| Error::io(folder, "reading", e);
    let mut files = Vec::new();
    for entry in folder.read_dir().map_err(io)? {
        let entry = entry.map_err(io)?;
        files.push((entry.file_name().to_string_lossy().into_owned(), entry.metadata().map_err(io)?.len()));
    }
    files.sort();
    Ok(files)
}

/// Says which checks of a product do not hold, and whose fault that is: of what a table from elsewhere says, or ours.
fn verify(checks: &[Check], table: Option<&Path>) -> Result<()> {
    let failure = |check: &Check| {
        let message =
            format!("a check of the product failed, so it is not written: {} is above {}", check.value, check.limit);
        let help = match table {
            Some(table) => format!(
                "what {} holds cannot be so; if it is as `mmxrt solve` wrote it, report this with the scene: it is a fault of mmxrt",
                table.display()
            ),
            None => "report this with the scene: it is a fault of mmxrt".to_owned(),
        };
        Problem::new(Location::item(&check.name), message).with_help(help)
    };
    let failed: Vec<Problem> = checks.iter().filter(|check| !check.passed()).map(failure).collect();
    if failed.is_empty() { Ok(()) } else { Err(Error::Invalid(failed)) }
}

/// What is said of a product.
fn report(product: &Product, coverage: &[f64]) -> ProductReport {
    let Product { subject, observation, maps, .. } = product;
    let cube = &observation.cube;
    let band_um = |band: Option<&Band>| band.map_or(0.0, |b| b.centre_um);
    ProductReport {
        format_version: report_json::FORMAT_VERSION,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        scene: subject.id.clone(),
        inputs: subject.inputs.iter().map(Input::from).collect(),
        image: ImageEntry {
            samples: cube.samples as u64,
            lines: cube.lines as u64,
            bands: cube.bands.len() as u64,
            first_band_um: band_um(cube.bands.first()),
            last_band_um: band_um(cube.bands.last()),
            quicklook_band: quicklook::grey_band(&cube.bands) as u64 + 1,
            quicklook_rgb_bands: quicklook::colour_bands(&cube.bands).map(|band| band as u64 + 1),
        },
        bands: BandEntry::of(&subject.scene),
        effects: observation.effects.clone(),
        checks: observation.checks.clone(),
        counts: observation.counts,
        maps: maps.clone(),
        defaults: subject.defaults.iter().map(ToString::to_string).collect(),
        warnings: subject.warnings.iter().chain(&observation.warnings).cloned().collect(),
        statistics: report_json::statistics(cube, coverage, &observation.backplanes),
    }
}
