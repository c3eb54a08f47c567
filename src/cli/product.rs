//! The product folder that `simulate` and `integrate` write: its options, and what is said of it.

use std::path::PathBuf;

use clap::ValueEnum;
use mmxrt::Result;
use mmxrt::formats::Subject;
use mmxrt::formats::envi::{Interleave, Precision};
use mmxrt::formats::product_folder::{ProductFolder, ProductOptions, Written};
use mmxrt::formats::report_json::ImageEntry;

use super::console::Console;

/// Of more defaults only so many are named in a line.
const TOLD: usize = 4;

#[derive(clap::Args)]
pub(crate) struct ProductArguments {
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

impl ProductArguments {
    /// Begins the folder, before anything is computed: it may not be possible.
    pub(super) fn stage(&self, table: bool, split: bool, console: &Console) -> Result<ProductFolder> {
        super::settle(&self.output, console)?;
        let interleave = match self.interleave {
            InterleaveName::Bsq => Interleave::Bsq,
            InterleaveName::Bil => Interleave::Bil,
            InterleaveName::Bip => Interleave::Bip,
        };
        let precision = match self.dtype {
            PrecisionName::F32 => Precision::F32,
            PrecisionName::F64 => Precision::F64,
        };
        let options =
            ProductOptions { interleave, precision, exr: self.exr, footprints: self.footprints, table, split };
        ProductFolder::stage(&self.output, self.force, options)
    }

    /// Says what has been written.
    pub(super) fn say(&self, written: &Written, console: &Console) {
        let Written { product, report, kept } = written;
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
        let ImageEntry { samples, lines, bands, .. } = report.image;
        let text = format!("{output}: {samples} x {lines} pixels, {bands} bands");
        let json = serde_json::json!({
            "product": output, "image": report.image, "defaults": report.defaults, "warnings": report.warnings
        });
        console.done(&text, &json);
    }
}

/// Says which values of the heat balance the scene left open: temperatures depend on them. In a line, or each with its value.
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
