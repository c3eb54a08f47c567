//! Geolocation errors as a table, images and a summary.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::envi::{self, Precision};
use super::folder::FolderKind;
use crate::error::{Error, Result};
use crate::product::Plane;
use crate::study::knowledge::{Asked, Budget, Part, PixelBudget, Row};

/// The folder that [`write()`] fills.
pub const FOLDER: FolderKind = FolderKind {
    marks: &["errors.json"],
    parts: &["errors.json", "errors.csv", "errors.img", "errors.hdr"],
    holds: None,
};

/// Columns of the table: a row per pixel and source. The scatter of `sources` is linear, that of `monte_carlo` sampled;
/// cells that do not apply are empty.
pub const COLUMNS: &str = "sample,line,band,source,bias_east_m,bias_north_m,bias_up_m,sd_east_m,sd_north_m,sd_up_m,error_m,level_m,level_px,level_p95_m,missed";

/// The table.
pub fn table(budget: &Budget) -> String {
    let mut text = format!("{COLUMNS}\n");
    for pixel in budget.pixels.iter().flatten() {
        let PixelBudget { place, pixel_m, .. } = pixel;
        let mut row = |source: &str, part: Option<&Part>, others: &str| {
            let _ = write!(text, "{},{},{},{source}", place.sample, place.line, budget.band + 1);
            match part {
                Some(part) => {
                    let (bias, sd, level_m) = (part.bias_m, part.sd_m(), part.level_m());
                    let sizes = [part.rms_m(), level_m, level_m / pixel_m];
                    let numbers = bias.to_array().into_iter().chain(sd.to_array()).chain(sizes);
                    numbers.for_each(|number| _ = write!(text, ",{number}"));
                }
                None => text.push_str(&",".repeat(9)),
            }
            let _ = writeln!(text, ",{others}");
        };
        for (source, part) in budget.sources.iter().zip(&pixel.sources) {
            row(source.name(), part.as_ref(), ",");
        }
        row("total", pixel.total.as_ref(), ",");
        if let Some(sampled) = &pixel.sampled {
            let part = Part { bias_m: sampled.mean_m, covariance_m2: sampled.covariance_m2 };
            let p95 = if sampled.met > 0 { sampled.level_p95_m.to_string() } else { String::new() };
            row("monte_carlo", (sampled.met > 0).then_some(&part), &format!("{p95},{}", sampled.missed));
        }
    }
    text
}

/// The images: horizontal error by source, and components of the total.
fn planes(budget: &Budget) -> Vec<Plane> {
    let plane = |name: String, unit: &str, of: &dyn Fn(&PixelBudget) -> Option<f64>| Plane {
        name,
        unit: unit.into(),
        values: budget.pixels.iter().map(|pixel| pixel.as_ref().and_then(of).unwrap_or(f64::NAN)).collect(),
    };
    let mut planes: Vec<Plane> = Vec::new();
    for (i, source) in budget.sources.iter().enumerate() {
        let level = |pixel: &PixelBudget| Some(pixel.sources[i].as_ref()?.level_m());
        planes.push(plane(format!("LEVEL {}", source.name()), "m", &level));
    }
    planes.push(plane("LEVEL total".into(), "m", &|pixel| Some(pixel.total.as_ref()?.level_m())));
    planes.push(plane("LEVEL total".into(), "pixels", &|pixel| Some(pixel.total.as_ref()?.level_m() / pixel.pixel_m)));
    planes.push(plane("ERROR total".into(), "m", &|pixel| Some(pixel.total.as_ref()?.rms_m())));
    for (k, name) in ["EAST", "NORTH", "UP"].into_iter().enumerate() {
        planes.push(plane(format!("BIAS {name}"), "m", &|pixel| Some(pixel.total.as_ref()?.bias_m[k])));
    }
    for (k, name) in ["EAST", "NORTH", "UP"].into_iter().enumerate() {
        planes.push(plane(format!("SD {name}"), "m", &|pixel| Some(pixel.total.as_ref()?.sd_m()[k])));
    }
    planes
}

/// The summary.
pub fn summary_json(budget: &Budget, asked: Asked, rows: &[Row]) -> Value {
    json!({
        "band": budget.band + 1,
        "every": asked.every,
        "pixels": budget.pixels.len(),
        "pixels_of_surface": budget.pixels.iter().flatten().count(),
        "draws": asked.draws,
        "seed": asked.seed,
        "sources": rows,
    })
}

/// Fills a folder: `errors.csv`, `errors.img`, `errors.json`.
///
/// # Errors
/// [`Error::Io`].
pub fn write(folder: &Path, budget: &Budget, summary: &Value) -> Result<()> {
    let put = |name: &str, text: String| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| Error::io(&path, "writing", e))
    };
    put("errors.csv", table(budget))?;
    put("errors.json", format!("{summary:#}\n"))?;
    let planes = planes(budget);
    let description = "Geolocation errors, believed minus true; NaN: no surface, or the believed ray misses it";
    let all = planes.iter().map(Cow::Borrowed);
    envi::write_planes(&folder.join("errors.img"), budget.size, all, Precision::F64, description)
}
