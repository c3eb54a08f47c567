//! The product folder that `simulate` and `integrate` write.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mmxrt::formats::envi::{self, Interleave, Precision};
use mmxrt::formats::folder::Staged;
use mmxrt::formats::report_json::{self, BandEntry, Image, Report};
use mmxrt::formats::{exr_cube, machine, npz, quicklook};
use mmxrt::integrate::Wanted;
use mmxrt::product::FacetTable;
use mmxrt::progress::tell;
use mmxrt::spectral::Band;
use mmxrt::study::{Check, MapAccount, Observation};
use mmxrt::{Error, Location, Problem, Result, study};

use super::Outcome;
use super::console::Console;
use super::scene::Opened;

#[derive(clap::Args)]
pub(crate) struct ProductOptions {
    /// The folder to make
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    /// Replace a product folder that exists
    #[arg(long)]
    force: bool,
    /// Order of the cube's numbers
    #[arg(long, value_enum, default_value = "bsq")]
    interleave: InterleaveName,
    /// Precision of the cube's numbers
    #[arg(long, value_enum, default_value = "f32")]
    dtype: PrecisionName,
    /// Write the cube as spectral OpenEXR as well
    #[arg(long)]
    exr: bool,
    /// Write which facets each pixel sees as well
    #[arg(long)]
    footprints: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum InterleaveName {
    /// Band, line, sample
    Bsq,
    /// Line, band, sample
    Bil,
    /// Line, sample, band
    Bip,
}

#[derive(Clone, Copy, ValueEnum)]
enum PrecisionName {
    /// Single precision
    F32,
    /// Double precision
    F64,
}

impl ProductOptions {
    /// What it asks for besides the cube.
    pub(super) fn wanted(&self) -> Wanted<'static> {
        Wanted { footprints: self.footprints, ..Wanted::default() }
    }

    /// Makes the folder to write into, before anything is computed: it may not be possible.
    pub(super) fn stage(&self, console: &Console) -> Result<Staged> {
        super::settle(&self.output, console)?;
        Staged::folder(&self.output, self.force)
    }

    /// Says, before anything is computed, if the product has no room, or would replace what it is made from.
    pub(super) fn admit(
        &self,
        staged: &Staged,
        opened: &Opened,
        more_inputs: &[PathBuf],
        has_maps: bool,
        extras: Extras,
    ) -> Result<()> {
        let inputs = opened.inputs.iter().map(|input| Path::new(&input.path));
        staged.spares(inputs.chain(more_inputs.iter().map(PathBuf::as_path)))?;
        study::has_room(&opened.scene, has_maps, machine::memory_bytes())?;
        let number_bytes = match self.dtype {
            PrecisionName::F32 => 4,
            PrecisionName::F64 => 8,
        };
        let cubes_bytes = number_bytes * if extras.with_split { 2 } else { 1 } + if self.exr { 4 } else { 0 };
        staged.has_room(study::product_bytes(&opened.scene, cubes_bytes))
    }
}

/// What a product is written from.
pub(super) struct Made {
    pub(super) opened: Opened,
    pub(super) table: FacetTable,
    /// The file that the table was read from, if it was.
    pub(super) table_from: Option<PathBuf>,
    pub(super) observation: Observation,
    /// The maps that it was made from, if it was.
    pub(super) maps: Option<MapAccount>,
}

/// What only `simulate` can write.
#[derive(Clone, Copy, Default)]
pub(super) struct Extras {
    /// The facet table.
    pub(super) with_table: bool,
    /// The thermal part of the cube.
    pub(super) with_split: bool,
}

/// Writes everything into the staged folder, gives it its name, and says so. A product of which a check does not hold is not written.
pub(super) fn write(
    command: &str,
    options: &ProductOptions,
    staged: Staged,
    made: &Made,
    Extras { with_table, with_split }: Extras,
    console: &Console,
) -> Result<Outcome> {
    verify(&made.observation.checks, made.table_from.as_deref())?;
    let report = write_files(command, options, &staged, made, Extras { with_table, with_split }, console)
        .map_err(|e| staged.named(e))?;
    let kept: Vec<String> = staged.kept().iter().map(|path| path.display().to_string()).collect();
    staged.commit()?;
    if !kept.is_empty() {
        let output = options.output.display();
        console.note(&format!(
            "{output}: kept what other programs had put there, of what was replaced: {}",
            kept.join(", ")
        ));
    }
    made.opened.say_defaults(console);
    report.warnings.iter().for_each(|warning| console.note(&format!("warning: {warning}")));
    let output = options.output.display().to_string();
    let Image { samples, lines, bands, .. } = report.image;
    let text = format!("{output}: {samples} x {lines} pixels, {bands} bands");
    let json = serde_json::json!({
        "product": output, "image": report.image, "defaults": report.defaults, "warnings": report.warnings
    });
    console.done(&text, &json);
    Ok(Outcome::Done)
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

fn write_files(
    command: &str,
    options: &ProductOptions,
    staged: &Staged,
    made: &Made,
    Extras { with_table, with_split }: Extras,
    console: &Console,
) -> Result<Report> {
    let watch = |progress| console.watch(progress);
    let file = |name: &str| staged.path().join(name);
    let Made { opened, table, observation, maps, .. } = made;
    let (cube, planes) = (&observation.cube, &observation.backplanes);
    let coverage = planes.plane("COVERAGE").map_or(&[][..], |plane| &plane.values);
    let title =
        |what: &str| format!("{what} by mmxrt {} of {}", env!("CARGO_PKG_VERSION"), opened.scene.exposure.instrument);

    let interleave = match options.interleave {
        InterleaveName::Bsq => Interleave::Bsq,
        InterleaveName::Bil => Interleave::Bil,
        InterleaveName::Bip => Interleave::Bip,
    };
    let precision = match options.dtype {
        PrecisionName::F32 => Precision::F32,
        PrecisionName::F64 => Precision::F64,
    };
    envi::write_cube(&file("cube.img"), cube, interleave, precision, &title("Radiance"), &watch)?;
    if with_split {
        let title = title("Thermal part of the radiance");
        envi::write_cube(&file("thermal.img"), &cube.thermal(), interleave, precision, &title, &watch)?;
    }
    if options.exr {
        exr_cube::write(&file("cube.exr"), cube, &title("Radiance"), &watch)?;
    }
    tell(&watch, "writing backplanes", 0, 1)?;
    // Always in double precision: positions in metres have more digits than f32 holds.
    envi::write_backplanes(&file("backplanes.img"), planes, Precision::F64, &title("Backplanes"))?;
    if let Some(footprints) = &observation.footprints {
        npz::write_footprints(&file("footprints.npz"), footprints, &opened.id)?;
    }
    if with_table {
        npz::write_table(&file("table.npz"), table, &study::table_id(&opened.scene))?;
    }
    tell(&watch, "writing pictures and reports", 0, 1)?;
    quicklook::write_grey(&file("quicklook.png"), cube, quicklook::grey_band(&cube.bands), coverage)?;
    quicklook::write_colour(&file("quicklook_rgb.png"), cube, quicklook::colour_bands(&cube.bands), coverage)?;
    let report = report(opened, observation, maps.clone(), coverage);
    report_json::write(&file("report.json"), &report)?;
    tell(&watch, "writing pictures and reports", 1, 1)?;
    report_json::write(&file("run.json"), &console.run(command))?;
    Ok(report)
}

/// What is said of a product.
fn report(opened: &Opened, observation: &Observation, maps: Option<MapAccount>, coverage: &[f64]) -> Report {
    let cube = &observation.cube;
    let band_um = |band: Option<&Band>| band.map_or(0.0, |b| b.centre_um);
    Report {
        format_version: report_json::FORMAT_VERSION,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        scene: opened.id.clone(),
        inputs: opened.inputs.clone(),
        image: Image {
            samples: cube.samples as u64,
            lines: cube.lines as u64,
            bands: cube.bands.len() as u64,
            first_band_um: band_um(cube.bands.first()),
            last_band_um: band_um(cube.bands.last()),
            quicklook_band: quicklook::grey_band(&cube.bands) as u64 + 1,
            quicklook_rgb_bands: quicklook::colour_bands(&cube.bands).map(|band| band as u64 + 1),
        },
        bands: BandEntry::of(&opened.scene),
        effects: observation.effects.clone(),
        checks: observation.checks.clone(),
        counts: observation.counts,
        maps,
        defaults: opened.defaults.clone(),
        warnings: opened.warnings.iter().chain(&observation.warnings).cloned().collect(),
        statistics: report_json::statistics(cube, coverage, &observation.backplanes),
    }
}
