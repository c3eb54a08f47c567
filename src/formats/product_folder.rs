//! A product folder: cube, backplanes, pictures, reports, and what else is asked for.

use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::envi::{self, Interleave, Precision};
use super::folder::Staged;
use super::product_cubes::{CubeFile, CubeFormats, CubeSource};
use super::product_curves;
use super::report_json::{self, BandEntry, ImageEntry, Input, PlanEntry, ProductReport, Run, SignalEntry};
use super::subject::Subject;
use super::{exposures_csv, exr_cube, machine, npz, quicklook};
use crate::error::{Error, Location, Problem, Result};
use crate::instrument::Detector;
use crate::product::{Backplanes, Conversion, CubeAxes, FacetTable, Plane, Quantity, ShownBands, Slab};
use crate::progress::{Watch, tell};
use crate::scene::{Readout, Scene};
use crate::spectral::Band;
use crate::study::{self, Check, MapAccount, Observation, Orientation, Plan, Reader, Reading};

/// How a product is written, and what of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProductOptions {
    /// Order of the cube's numbers.
    pub interleave: Interleave,
    /// Precision of the cube's numbers.
    pub precision: Precision,
    /// In which formats cubes are.
    pub formats: CubeFormats,
    /// The cube as spectral OpenEXR as well.
    pub exr: bool,
    /// Which facets each pixel sees as well.
    pub footprints: bool,
    /// Bands, from 0, of a tunable filter whose exposures' own backplanes are written as well.
    pub planes_of: Vec<usize>,
    /// The facet table as well: not of what maps send.
    pub table: bool,
    /// The thermal part of the cube as well: not of what maps send.
    pub split: bool,
    /// What the numbers of the cube are.
    pub quantity: Quantity,
}

impl Default for ProductOptions {
    /// Band by band in single precision, and nothing besides.
    fn default() -> Self {
        ProductOptions {
            interleave: Interleave::Bsq,
            precision: Precision::F32,
            formats: CubeFormats::default(),
            exr: false,
            footprints: false,
            planes_of: vec![],
            table: false,
            split: false,
            quantity: Quantity::Radiance,
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
    /// What the camera sees, but for the cube: its slabs have been written.
    pub observation: Observation<()>,
    /// What decided by which models it was made, if it was decided here.
    pub plan: Option<Plan>,
    /// The maps that it was made from, if it was.
    pub maps: Option<MapAccount>,
}

impl Product {
    /// Adds to the observation what its instrument does, and its motion.
    pub(crate) fn tell(&mut self, reader: Option<&Reader>) {
        let Product { subject, observation, .. } = self;
        if let Some(chain) = &subject.chain {
            study::tell_instrument(&mut observation.effects, chain);
        }
        if let Some((motion, _)) = &subject.motion {
            study::tell_correction(&mut observation.effects, motion.correction);
        }
        observation.warnings.extend(reader.iter().flat_map(|reader| reader.remarks()));
    }
}

/// A product folder that is being made, hidden until it is whole.
#[derive(Debug)]
pub struct ProductFolder {
    staged: Staged,
    options: ProductOptions,
}

/// A product folder that takes the slabs of its cube as they are made, and then all else.
#[derive(Debug)]
pub struct OpenProduct {
    conversion: Conversion,
    /// What reads the image, and where the numbers go.
    detector: Option<(Reader, envi::EnviCube)>,
    cube: envi::EnviCube,
    thermal: Option<envi::EnviCube>,
    exr: Option<exr_cube::ExrCube>,
    shown: ShownBands,
    // Last: files are closed before their folder is removed.
    folder: ProductFolder,
}

/// What has been written.
#[derive(Debug, Clone)]
pub struct Written {
    /// What it was written from.
    pub product: Product,
    /// Its report.
    pub report: ProductReport,
    /// What it took.
    pub run: Run,
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
        let ProductOptions { precision, exr, split, table, quantity, ref formats, .. } = self.options;
        if split && quantity == Quantity::BrightnessTemperature {
            let message =
                "temperatures of parts of the light do not add up: leave out the thermal part, or take radiance";
            return Err(Error::invalid(Location::item("options"), message));
        }
        Conversion::new(quantity, &subject.scene)?;
        let in_parts = subject.motion.as_ref().is_some_and(|(_, timing)| timing.is_in_parts());
        if in_parts && quantity == Quantity::ReflectanceFactor {
            let message = "the Sun's incidence is another one for each part of this image: take the radiance factor";
            return Err(Error::invalid(Location::item("options"), message));
        }
        if split && subject.chain.is_some() {
            let message = "what an instrument makes of light has no thermal part of its own: take the light before it (`--ideal`), or leave out `--split`";
            return Err(Error::invalid(Location::item("options"), message));
        }
        if let Some(detector) = subject.chain.as_ref().and_then(|chain| chain.detector.as_ref()) {
            Reader::new(detector, CubeAxes::of(&subject.scene.exposure), (subject.readout(), subject.occasion()))?;
        }
        if has_maps && (split || table) {
            let message = "neither a facet table nor a thermal part belongs to what maps send";
            return Err(Error::invalid(Location::item("options"), message));
        }
        let is_filter = subject.motion.as_ref().is_some_and(|(_, timing)| timing.readout == Readout::Band);
        let bands = subject.scene.exposure.bands.len();
        let has_exposure = |band: &&usize| !has_maps && is_filter && **band < bands;
        if let Some(other) = self.options.planes_of.iter().find(|band| !has_exposure(band)) {
            let number = other.saturating_add(1);
            let message = match *other < bands {
                true => format!(
                    "band {number} has no exposure of its own: each band of a simulated scene with a `[flight]` and `kind = \"tunable_filter\"` has"
                ),
                false => format!("band {number} is asked for, counted from 1: there are {bands}"),
            };
            return Err(Error::invalid(Location::item("--planes-of"), message));
        }
        let inputs = subject.inputs.iter().map(|input| &input.path).chain(more_inputs);
        self.staged.spares(inputs.map(PathBuf::as_path))?;
        study::has_room(&subject.scene, has_maps, machine::memory_bytes())?;
        let number_bytes = match precision {
            Precision::U16 => 2,
            Precision::F32 | Precision::U32 => 4,
            Precision::F64 => 8,
        };
        // In the files of other formats, too, and there with the backplanes.
        let cubes_bytes = number_bytes * if split { 2 } else { 1 } * formats.copies() + if exr { 4 } else { 0 };
        self.staged.has_room(study::product_bytes(&subject.scene, cubes_bytes))
    }

    /// Begins the files of the cube.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] if OpenEXR cannot hold the cube.
    pub fn open(self, subject: &Subject) -> Result<OpenProduct> {
        let scene = &subject.scene;
        let named = |e| self.staged.named(e);
        let file = |name: &str| self.staged.path().join(name);
        let ProductOptions { interleave, precision, exr, split, quantity, .. } = self.options.clone();
        let conversion = Conversion::new(quantity, scene)?;
        let axes = CubeAxes { quantity, ..CubeAxes::of(&scene.exposure) };
        let create = |name: &str, title: &str| {
            let title = titled(title, scene);
            envi::EnviCube::create(&file(name), axes.clone(), interleave, precision, &title).map_err(named)
        };
        let cube = create("cube.img", quantity.title())?;
        let thermal =
            split.then(|| create("thermal.img", &format!("Thermal part of: {}", quantity.title()))).transpose()?;
        let create =
            || exr_cube::ExrCube::create(&file("cube.exr"), &axes, &titled(quantity.title(), scene)).map_err(named);
        let exr = exr.then(create).transpose()?;
        let detector = subject.chain.as_ref().and_then(|chain| chain.detector.as_ref());
        let read = |detector: &Detector| {
            let sent = CubeAxes { quantity: Quantity::Counts, ..axes.clone() };
            let precision = if detector.bits > 16 { Precision::U32 } else { Precision::U16 };
            let title = titled(sent.quantity.title(), scene);
            let numbers =
                envi::EnviCube::create(&file("dn.img"), sent, interleave, precision, &title).map_err(named)?;
            Ok::<_, Error>((
                Reader::new(detector, CubeAxes::of(&scene.exposure), (subject.readout(), subject.occasion()))?,
                numbers,
            ))
        };
        let detector = detector.map(read).transpose()?;
        Ok(OpenProduct { conversion, detector, cube, thermal, exr, shown: shown(axes), folder: self })
    }
}

impl OpenProduct {
    /// Writes a slab of the cube; they come in any order.
    ///
    /// # Errors
    /// Those of [`envi::EnviCube::put`].
    pub fn put(&mut self, slab: Slab, watch: Watch<'_>) -> Result<()> {
        let OpenProduct { conversion, detector, folder, cube, thermal, exr, shown } = self;
        let mut put = |slab: Slab| {
            shown.take(&slab)?;
            cube.put(&slab, watch)?;
            thermal.as_mut().map_or(Ok(()), |file| file.put(&slab.thermal(), watch))?;
            exr.as_mut().map_or(Ok(()), |file| file.put(&slab, watch))
        };
        let mut put = |slab: Slab| conversion.slabs(slab, &mut put);
        let done = match detector {
            None => put(slab),
            Some((reader, file)) => reader.read(&slab, |Reading { radiance, numbers }| {
                file.put(&numbers, watch)?;
                put(radiance)
            }),
        };
        done.map_err(|e| folder.staged.named(e))
    }

    /// Writes all else and gives the folder its name. A product of which a check does not hold, or whose cube slabs have not filled,
    /// is not written.
    ///
    /// `run` is asked last what `run.json` is to say: date, threads and timings are known to the caller only.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the checks that do not hold; [`Error::Io`]; [`Error::Interrupted`] if `watch` asks to stop.
    pub fn finish(self, mut product: Product, run: impl FnOnce() -> Run, watch: Watch<'_>) -> Result<Written> {
        verify(&product.observation.checks, product.table_from.as_deref())?;
        let OpenProduct { folder: ProductFolder { staged, options }, detector, cube, thermal, exr, shown, .. } = self;
        product.tell(detector.as_ref().map(|(reader, _)| reader));
        let product = product;
        let write = || {
            cube.end()?;
            let signal = match detector {
                None => None,
                Some((reader, numbers)) => {
                    numbers.end()?;
                    Some(write_signal(&staged.path().join("snr.img"), &reader, &product.subject.scene)?)
                }
            };
            thermal.map_or(Ok(()), envi::EnviCube::end)?;
            exr.map_or(Ok(()), exr_cube::ExrCube::end)?;
            write_files(&staged, &options, &shown, (&product, signal), run, watch)
        };
        let (report, run) = write().map_err(|e| staged.named(e))?;
        let kept = staged.kept().to_vec();
        staged.commit()?;
        Ok(Written { product, report, run, kept })
    }
}

/// What pictures and the report show of a cube, to be taken from its slabs.
pub(crate) fn shown(axes: CubeAxes) -> ShownBands {
    let mut bands = report_json::bands_of_statistics(&axes.bands);
    bands.push(quicklook::grey_band(&axes.bands));
    bands.extend(quicklook::colour_bands(&axes.bands));
    ShownBands::new(axes, bands)
}

/// Writes images of signal over noise, and gives the account of it.
fn write_signal(path: &Path, reader: &Reader, scene: &Scene) -> Result<SignalEntry> {
    let [mean, lowest, good] = reader.snr_planes();
    let plane = |name: &str, values| Plane { name: name.to_owned(), unit: "1".to_owned(), values };
    let planes =
        vec![plane("SNR_MEAN", mean), plane("SNR_LOWEST", lowest), plane(&format!("BANDS_FROM_{}", study::GOOD), good)];
    let CubeAxes { samples, lines, .. } = CubeAxes::of(&scene.exposure);
    let title = titled("Signal over noise", scene);
    envi::write_backplanes(path, &Backplanes { samples, lines, planes }, Precision::F32, &title)?;
    Ok(SignalEntry::of(reader))
}

/// What an image of a scene is called.
fn titled(what: &str, scene: &Scene) -> String {
    format!("{what} by mmxrt {} of {}", env!("CARGO_PKG_VERSION"), scene.exposure.instrument)
}

/// Writes all but the cube.
fn write_files(
    staged: &Staged,
    options: &ProductOptions,
    cube: &ShownBands,
    (product, signal): (&Product, Option<SignalEntry>),
    run: impl FnOnce() -> Run,
    watch: Watch<'_>,
) -> Result<(ProductReport, Run)> {
    let file = |name: &str| staged.path().join(name);
    let Product { subject, table, observation, .. } = product;
    let (bands, planes) = (&cube.axes.bands, &observation.backplanes);
    let shown = planes.shown();
    tell(watch, "writing backplanes", 0, 1)?;
    // Always in double precision: positions in metres have more digits than f32 holds.
    envi::write_backplanes(&file("backplanes.img"), planes, Precision::F64, &titled("Backplanes", &subject.scene))?;
    if let Some(exposures) = &observation.exposures {
        for part in &exposures.taken {
            let Some(planes) = &part.backplanes else { continue };
            let band = part.take.bands.start + 1;
            let title = titled(&format!("Backplanes of the exposure of band {band}"), &subject.scene);
            envi::write_backplanes(&file(&format!("backplanes.{band}.img")), planes, Precision::F64, &title)?;
        }
        exposures_csv::write(&file("exposures.csv"), exposures)?;
        if exposures.reference.is_some() {
            tell(watch, "writing displacements", 0, 1)?;
            let title = titled("Displacement of what the reference image shows", &subject.scene);
            let mut within_px = Vec::new();
            let plane = |i: usize| {
                let plane = exposures.displacement(planes, i / 2, i % 2).unwrap_or_default();
                within_px.push(product_curves::within_px(&plane));
                plane
            };
            let all = (0..2 * exposures.taken.len()).map(plane).map(Cow::Owned);
            envi::write_planes(&file("displacement.img"), [planes.samples, planes.lines], all, Precision::F32, &title)?;
            staged.put(&file("displacement.svg"), |out| {
                out.write_all(product_curves::displacement_svg(&within_px).as_bytes())
            })?;
        }
    }
    if let Some(signal) = &signal {
        let svg = product_curves::signal_svg(bands, &signal.bands);
        staged.put(&file("snr.svg"), |out| out.write_all(svg.as_bytes()))?;
    }
    if let Some(footprints) = &observation.footprints {
        npz::write_footprints(&file("footprints.npz"), footprints, &subject.id)?;
    }
    if options.table {
        npz::write_table(&file("table.npz"), table, &study::table_id(&subject.scene))?;
    }
    tell(watch, "writing pictures and reports", 0, 1)?;
    let compass = Orientation::of(&subject.scene);
    quicklook::write_grey(&file("quicklook.png"), cube, quicklook::grey_band(bands), &shown, Some(&compass))?;
    quicklook::write_colour(&file("quicklook_rgb.png"), cube, quicklook::colour_bands(bands), &shown, Some(&compass))?;
    let has_numbers = signal.is_some();
    let report = report(product, cube, signal);
    report_json::write(&file("report.json"), &report)?;
    tell(watch, "writing pictures and reports", 1, 1)?;
    let source = CubeSource {
        by: &titled("", &subject.scene),
        scene: Some(&report.scene),
        report: report_json::text(&file("report.json"), &report)?,
    };
    options.formats.write(staged.path(), &cubes(options, has_numbers, planes), &source, watch)?;
    let mut run = run();
    product.plan.iter().for_each(|plan| run.set_costs(plan));
    run.files = files(staged.path())?.into_iter().collect();
    report_json::write(&file("run.json"), &run)?;
    Ok((report, run))
}

/// The cubes of a product.
fn cubes<'a>(options: &ProductOptions, has_numbers: bool, planes: &'a Backplanes) -> Vec<CubeFile<'a>> {
    let quantity = options.quantity;
    let words = quantity.title();
    let mut cubes = vec![CubeFile { stem: "cube", quantity, words: words.to_owned(), planes: Some(planes) }];
    if options.split {
        cubes.push(CubeFile { stem: "thermal", quantity, words: format!("Thermal part of: {words}"), planes: None });
    }
    if has_numbers {
        let quantity = Quantity::Counts;
        cubes.push(CubeFile { stem: "dn", quantity, words: quantity.title().to_owned(), planes: None });
    }
    cubes
}

/// Names and sizes, bytes, of what is in a product folder, by name.
///
/// # Errors
/// [`Error::Io`].
pub fn files(folder: &Path) -> Result<Vec<(String, u64)>> {
    let io = |e| Error::io(folder, "reading", e);
    let mut found = Vec::new();
    for entry in folder.read_dir().map_err(io)? {
        let entry = entry.map_err(io)?;
        let about = entry.metadata().map_err(io)?;
        // Of a folder, the bytes in it.
        let bytes = match about.is_dir() {
            true => files(&entry.path())?.iter().map(|(_, bytes)| bytes).sum(),
            false => about.len(),
        };
        found.push((entry.file_name().to_string_lossy().into_owned(), bytes));
    }
    found.sort();
    Ok(found)
}

/// Says which checks of a product do not hold, and whose fault that is: of what a table from elsewhere says, or ours.
pub(crate) fn verify(checks: &[Check], table: Option<&Path>) -> Result<()> {
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
pub(crate) fn report(product: &Product, cube: &ShownBands, signal: Option<SignalEntry>) -> ProductReport {
    let Product { subject, observation, plan, maps, .. } = product;
    let CubeAxes { samples, lines, bands, quantity } = &cube.axes;
    let band_um = |band: Option<&Band>| band.map_or(0.0, |b| b.centre_um);
    let coverage = observation.backplanes.plane("COVERAGE").map_or(&[][..], |plane| &plane.values);
    ProductReport {
        format_version: report_json::FORMAT_VERSION,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        scene: subject.id.clone(),
        inputs: subject.inputs.iter().map(Input::from).collect(),
        settings: subject.settings.clone(),
        image: ImageEntry {
            samples: *samples as u64,
            lines: *lines as u64,
            bands: bands.len() as u64,
            quantity: quantity.name().to_owned(),
            unit: quantity.unit().to_owned(),
            first_band_um: band_um(bands.first()),
            last_band_um: band_um(bands.last()),
            quicklook_band: quicklook::grey_band(bands) as u64 + 1,
            quicklook_rgb_bands: quicklook::colour_bands(bands).map(|band| band as u64 + 1),
        },
        orientation: Some(Orientation::of(&subject.scene)),
        bands: BandEntry::of(&subject.scene),
        plan: plan.as_ref().map(PlanEntry::from),
        effects: observation.effects.clone(),
        surfaces: observation.surfaces.clone(),
        checks: observation.checks.clone(),
        counts: observation.counts,
        maps: maps.clone(),
        signal,
        defaults: subject.defaults.iter().map(ToString::to_string).collect(),
        warnings: subject.warnings.iter().chain(&observation.warnings).cloned().collect(),
        statistics: report_json::statistics(cube, coverage, &observation.backplanes),
    }
}
