//! One pixel of a product folder: its spectrum and its planes.

use std::fmt::Write as _;
use std::path::Path;

use crate::error::{Error, Location, Result, number};

use super::raster;

/// What a product says of one pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixel {
    /// Its place in a line, from 0.
    pub sample: usize,
    /// Its line, from 0.
    pub line: usize,
    /// Centres of the bands, um.
    pub wavelength_um: Vec<f64>,
    /// Radiance in each band, W m-2 sr-1 um-1.
    pub radiance_w_m2_sr_um: Vec<f64>,
    /// The part of it that is emitted, if the product was made with it: the rest is reflected.
    pub thermal_w_m2_sr_um: Option<Vec<f64>>,
    /// Names and values of the backplanes; NaN: no surface.
    pub planes: Vec<(String, f64)>,
}

/// Reads a pixel of a product folder.
///
/// # Errors
/// [`Error::Invalid`] for a pixel beyond the image, and for a folder that is no product; those of reading its images.
pub fn read(folder: &Path, sample: usize, line: usize) -> Result<Pixel> {
    let cube = folder.join("cube.img");
    let radiance = spectrum(&cube, sample, line)?;
    let thermal = folder.join("thermal.img");
    let thermal = if thermal.is_file() { Some(spectrum(&thermal, sample, line)?) } else { None };
    let planes = spectrum(&folder.join("backplanes.img"), sample, line)?;
    Ok(Pixel {
        sample,
        line,
        wavelength_um: radiance.iter().map(|b| b.centre_um.unwrap_or(f64::NAN)).collect(),
        radiance_w_m2_sr_um: radiance.into_iter().map(|b| b.value).collect(),
        thermal_w_m2_sr_um: thermal.map(|bands| bands.into_iter().map(|b| b.value).collect()),
        planes: planes.into_iter().map(|b| (b.name, b.value)).collect(),
    })
}

/// A band of an image at one pixel.
struct AtPixel {
    name: String,
    centre_um: Option<f64>,
    value: f64,
}

fn spectrum(path: &Path, sample: usize, line: usize) -> Result<Vec<AtPixel>> {
    let mut raster = raster::open(path)?;
    if sample >= raster.columns || line >= raster.rows {
        let message = format!(
            "pixel {sample},{line} is beyond its {} samples and {} lines; both are counted from 0",
            raster.columns, raster.rows
        );
        return Err(Error::invalid(Location::file(path), message));
    }
    let at = line * raster.columns + sample;
    let mut values = Vec::new();
    let mut bands = Vec::with_capacity(raster.bands.len());
    for i in 0..raster.bands.len() {
        raster.read(i, &mut values)?;
        let band = &raster.bands[i];
        bands.push(AtPixel { name: band.name.clone(), centre_um: band.centre_um, value: values[at] });
    }
    Ok(bands)
}

impl Pixel {
    /// Names and values of what is known in each band: the radiance and, if it is known, what of it is reflected and emitted.
    pub fn columns(&self) -> Vec<(&'static str, Vec<f64>)> {
        let total = &self.radiance_w_m2_sr_um;
        let mut columns = vec![("radiance_w_m2_sr_um", total.clone())];
        if let Some(thermal) = &self.thermal_w_m2_sr_um {
            columns
                .push(("reflected_w_m2_sr_um", total.iter().zip(thermal).map(|(total, heat)| total - heat).collect()));
            columns.push(("thermal_w_m2_sr_um", thermal.clone()));
        }
        columns
    }

    /// As CSV: comments with the pixel and its planes, a header with units, a row for each band.
    pub fn csv(&self) -> String {
        let mut text = format!("# sample {}, line {}, counted from 0\n", self.sample, self.line);
        for (name, value) in &self.planes {
            let _ = writeln!(text, "# {name} {}", number(*value));
        }
        let columns = self.columns();
        let names: Vec<&str> = columns.iter().map(|c| c.0).collect();
        let _ = writeln!(text, "wavelength_um,{}", names.join(","));
        for (i, um) in self.wavelength_um.iter().enumerate() {
            let _ = write!(text, "{}", number(*um));
            columns.iter().for_each(|(_, values)| text.push_str(&format!(",{}", number(values[i]))));
            text.push('\n');
        }
        text
    }
}
