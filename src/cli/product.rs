//! The product folder that `simulate` and `integrate` write: its options, and what is printed about it.

use std::path::PathBuf;

use clap::ValueEnum;
use mmxrt::Result;
use mmxrt::formats::Subject;
use mmxrt::formats::envi::{Interleave, Precision};
use mmxrt::formats::product_cubes::{CubeFormat, CubeFormats};
use mmxrt::formats::product_folder::{ProductFolder, ProductOptions, Written};
use mmxrt::formats::report_json::{Cost, ImageEntry};
use mmxrt::product::Quantity;

use super::console::Console;
use super::dry_run::rounded;

/// At most this many defaults are named in a line.
const TOLD: usize = 4;

#[derive(clap::Args)]
pub(crate) struct ProductArguments {
    /// The folder to create
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    /// Replace an existing product folder
    #[arg(long)]
    force: bool,
    /// Interleave of the cube
    #[arg(long, value_enum, default_value = "bsq")]
    interleave: InterleaveName,
    /// Precision of the cube's numbers
    #[arg(long, value_enum, default_value = "f32")]
    dtype: PrecisionName,
    /// What the numbers of the cube are
    #[arg(long, value_enum, default_value = "radiance")]
    quantity: QuantityName,
    #[command(flatten)]
    format: FormatArguments,
    /// Also write the cube as spectral OpenEXR
    #[arg(long)]
    exr: bool,
    /// Also write which facets each pixel sees
    #[arg(long)]
    footprints: bool,
    /// Also write the backplanes of these bands' exposures of a tunable filter, as backplanes.BAND.img
    #[arg(long, value_name = "BAND,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    planes_of: Vec<u32>,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum InterleaveName {
    /// Band, line, sample
    Bsq,
    /// Line, band, sample
    Bil,
    /// Line, sample, band
    Bip,
}

#[derive(Clone, Copy, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum QuantityName {
    /// Mean spectral radiance over each band, W m-2 sr-1 um-1
    Radiance,
    /// Radiance in each band: that times its width, W m-2 sr-1
    BandRadiance,
    /// I/F: pi times radiance over sunlight normal to its beam
    RadianceFactor,
    /// Pi times radiance over sunlight on level ground at the origin
    ReflectanceFactor,
    /// Temperature of the black body of the same radiance in the band, K
    BrightnessTemperature,
}

#[derive(clap::Args)]
pub(crate) struct FormatArguments {
    /// Formats of the cube: NetCDF, Zarr and FITS hold its backplanes and report as well
    #[arg(long, value_enum, value_name = "FORMAT,...", value_delimiter = ',', default_value = "envi")]
    format: Vec<FormatName>,
}

impl FormatArguments {
    /// Those of cubes, and whether OpenEXR is one of them.
    pub(super) fn formats(&self) -> (CubeFormats, bool) {
        let formats: Vec<CubeFormat> = self.format.iter().map(|format| (*format).into()).collect();
        (CubeFormats::from(formats.as_slice()), formats.contains(&CubeFormat::Exr))
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum FormatName {
    /// cube.img and cube.hdr
    Envi,
    /// cube.xml: a label of PDS4 for the numbers in cube.img
    Pds4,
    /// cube.nc: NetCDF by the CF conventions, for xarray, Panoply, GDAL
    Netcdf,
    /// cube.zarr: Zarr version 3, for xarray
    Zarr,
    /// cube.fits: for astropy
    Fits,
    /// cube.exr: spectral OpenEXR, as --exr
    Exr,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum PrecisionName {
    /// Single precision
    F32,
    /// Double precision
    F64,
}

impl From<InterleaveName> for Interleave {
    fn from(name: InterleaveName) -> Self {
        match name {
            InterleaveName::Bsq => Interleave::Bsq,
            InterleaveName::Bil => Interleave::Bil,
            InterleaveName::Bip => Interleave::Bip,
        }
    }
}

impl From<QuantityName> for Quantity {
    fn from(name: QuantityName) -> Self {
        match name {
            QuantityName::Radiance => Quantity::Radiance,
            QuantityName::BandRadiance => Quantity::BandRadiance,
            QuantityName::RadianceFactor => Quantity::RadianceFactor,
            QuantityName::ReflectanceFactor => Quantity::ReflectanceFactor,
            QuantityName::BrightnessTemperature => Quantity::BrightnessTemperature,
        }
    }
}

impl From<FormatName> for CubeFormat {
    fn from(name: FormatName) -> Self {
        match name {
            FormatName::Envi => CubeFormat::Envi,
            FormatName::Pds4 => CubeFormat::Pds4,
            FormatName::Netcdf => CubeFormat::Netcdf,
            FormatName::Zarr => CubeFormat::Zarr,
            FormatName::Fits => CubeFormat::Fits,
            FormatName::Exr => CubeFormat::Exr,
        }
    }
}

impl From<PrecisionName> for Precision {
    fn from(name: PrecisionName) -> Self {
        match name {
            PrecisionName::F32 => Precision::F32,
            PrecisionName::F64 => Precision::F64,
        }
    }
}

impl ProductArguments {
    /// Creates the folder before anything is computed, since that may fail.
    pub(super) fn stage(&self, table: bool, split: bool, console: &Console) -> Result<ProductFolder> {
        super::settle(&self.output, console)?;
        let (formats, exr) = self.format.formats();
        let options = ProductOptions {
            interleave: self.interleave.into(),
            precision: self.dtype.into(),
            formats,
            exr: self.exr || exr,
            footprints: self.footprints,
            planes_of: self.planes_of.iter().map(|band| *band as usize - 1).collect(),
            table,
            split,
            quantity: self.quantity.into(),
        };
        ProductFolder::stage(&self.output, self.force, options)
    }

    /// Reports what has been written.
    pub(super) fn say(&self, written: &Written, console: &Console) {
        let Written { product, report, run, kept } = written;
        let output = self.output.display().to_string();
        if !kept.is_empty() {
            let kept: Vec<String> = kept.iter().map(|path| path.display().to_string()).collect();
            console.note(&format!(
                "{output}: kept what other programs had put there, of what was replaced: {}",
                kept.join(", ")
            ));
        }
        say_defaults(&product.subject, console);
        report.warnings.iter().for_each(|warning| console.note(&format!("warning: {warning}")));
        cost(&run.costs).iter().for_each(|said| console.note(said));
        let ImageEntry { samples, lines, bands, .. } = report.image;
        let text = format!("{output}: {samples} x {lines} pixels, {bands} bands");
        let json = serde_json::json!({
            "product": output, "image": report.image, "defaults": report.defaults, "warnings": report.warnings, "costs": run.costs
        });
        console.done(&text, &json);
    }
}

/// What a run took beside what was predicted: of all of it, and of effects by the time that they took.
fn cost(costs: &[Cost]) -> Option<String> {
    let (all, effects) = costs.split_first()?;
    let beside = |cost: &Cost| {
        format!("{} CPU s, {} predicted", rounded(cost.measured_cpu_s, 2), rounded(cost.predicted_cpu_s, 2))
    };
    let mut effects: Vec<&Cost> = effects.iter().collect();
    effects.sort_by(|a, b| b.measured_cpu_s.total_cmp(&a.measured_cpu_s));
    let effects: Vec<String> = effects.iter().map(|cost| format!("{} {}", cost.of, beside(cost))).collect();
    let of_which = if effects.is_empty() { String::new() } else { format!("; of that {}", effects.join("; ")) };
    Some(format!("took {}{of_which}", beside(all)))
}

/// Names the heat-balance values that the scene left open, since temperatures depend on them: in one line, or each with its value.
pub(super) fn say_defaults(subject: &Subject, console: &Console) {
    let open = subject.defaults_of_heat();
    if open.is_empty() {
        return;
    }
    if console.is_verbose() {
        open.iter().for_each(|stated| console.note(&format!("default: {stated}")));
        return;
    }
    let items: Vec<&str> = open.iter().map(|stated| stated.item.as_str()).collect();
    let told = match items.len() {
        0..=TOLD => items.join(", "),
        n => format!("{} and {} more", items[..TOLD].join(", "), n - TOLD),
    };
    console.note(&format!("defaults of the heat balance: {told} (values: --verbose, or the report)"));
}
