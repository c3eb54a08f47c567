//! One pixel of a product folder: its spectrum and its planes.

use std::fmt::Write as _;
use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::number::single;
use crate::geometry::whole;
use crate::product::Quantity;

use super::number::DataType;
use super::product_image::product_image;
use super::registry;

/// What a product says of one pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelValues {
    /// Its place in a line, from 0.
    pub sample: usize,
    /// Its line, from 0.
    pub line: usize,
    /// What bands are called, as filters; empty if nothing.
    pub names: Vec<String>,
    /// Centres of the bands, um.
    pub wavelength_um: Vec<f64>,
    /// Radiance in each band, W m-2 sr-1 um-1.
    pub radiance_w_m2_sr_um: Vec<f64>,
    /// The part of it that is emitted, if the product was made with it: the rest is reflected.
    pub thermal_w_m2_sr_um: Option<Vec<f64>>,
    /// Names and values of the backplanes; NaN: no surface.
    pub planes: Vec<(String, f64)>,
    /// By what share of itself the number after a radiance is larger: 2^-23 of single precision; 0 of double precision.
    pub epsilon: f64,
}

/// Reads a pixel of a product folder.
///
/// # Errors
/// [`Error::Invalid`] for a pixel beyond the image, and for a folder that is not a product; those of reading its images.
pub fn read(folder: &Path, sample: usize, line: usize) -> Result<PixelValues> {
    folder.metadata().map_err(|e| Error::io(folder, "reading", e))?;
    let cube = product_image(folder, "cube");
    if !cube.exists() {
        let at = Location::file(folder);
        let around = folder.parent().filter(|around| product_image(around, "cube").exists());
        let help = match around {
            Some(around) if around.as_os_str().is_empty() => "name the folder that this image is in: `.`".to_owned(),
            Some(around) => format!("name the folder that this image is in: {}", around.display()),
            None => "a pixel is looked at in a folder that `simulate` or `integrate` made".to_owned(),
        };
        return Err(Error::Invalid(vec![Problem::new(at, "is not the folder of a product").with_help(help)]));
    }
    let unit = registry::image(&cube)?.unit.unwrap_or_default();
    if !unit.is_empty() && unit != Quantity::Radiance.unit() {
        let message = format!("its numbers are in {unit:?}: a pixel's spectrum is shown of radiance");
        return Err(Error::invalid(Location::file(&cube), message));
    }
    let radiance = spectrum(&cube, sample, line)?;
    let is_single = radiance.iter().any(|band| band.is_single);
    let thermal = product_image(folder, "thermal");
    let thermal = if thermal.exists() { Some(spectrum(&thermal, sample, line)?) } else { None };
    let planes = spectrum(&folder.join("backplanes.img"), sample, line)?;
    Ok(PixelValues {
        sample,
        line,
        names: radiance.iter().map(|b| b.name.clone()).collect(),
        wavelength_um: radiance.iter().map(|b| b.centre_um.unwrap_or(f64::NAN)).collect(),
        radiance_w_m2_sr_um: radiance.into_iter().map(|b| b.value).collect(),
        thermal_w_m2_sr_um: thermal.map(|bands| bands.into_iter().map(|b| b.value).collect()),
        planes: planes.into_iter().map(|b| (b.name, b.value)).collect(),
        epsilon: if is_single { f64::from(f32::EPSILON) } else { 0.0 },
    })
}

/// A band of an image at one pixel.
struct AtPixel {
    name: String,
    centre_um: Option<f64>,
    value: f64,
    is_single: bool,
}

/// A number of single precision as the shortest decimal that is it: 0.1, not 0.10000000149.
fn decimal(value: f64) -> f64 {
    single(value).to_string().parse().unwrap_or(value)
}

fn spectrum(path: &Path, sample: usize, line: usize) -> Result<Vec<AtPixel>> {
    let mut raster = registry::image(path)?;
    if sample >= raster.columns || line >= raster.rows {
        let message = format!(
            "pixel {sample},{line} is beyond its {} samples and {} lines; both are counted from 0",
            raster.columns, raster.rows
        );
        return Err(Error::invalid(Location::file(path), message));
    }
    let at = line * raster.columns + sample;
    let is_single = raster.data_type == DataType::F32;
    let mut values = Vec::new();
    let mut bands = Vec::with_capacity(raster.bands.len());
    for i in 0..raster.bands.len() {
        raster.read(i, &mut values)?;
        let band = &raster.bands[i];
        let value = if is_single { decimal(values[at]) } else { values[at] };
        bands.push(AtPixel { name: band.name.clone(), centre_um: band.centre_um, value, is_single });
    }
    Ok(bands)
}

impl PixelValues {
    /// Names and values of what is known in each band: the radiance and, if it is known, what of it is reflected and emitted.
    pub fn columns(&self) -> Vec<(&'static str, Vec<f64>)> {
        let total = &self.radiance_w_m2_sr_um;
        let mut columns = vec![("radiance_w_m2_sr_um", total.clone())];
        if let Some(thermal) = &self.thermal_w_m2_sr_um {
            let reflected = total.iter().zip(thermal).map(|(total, heat)| self.known_digits(total - heat, *total));
            columns.push(("reflected_w_m2_sr_um", reflected.collect()));
            columns.push(("thermal_w_m2_sr_um", thermal.clone()));
        }
        columns
    }

    /// A difference of two numbers of about this size, without digits beyond those of the numbers.
    fn known_digits(&self, difference: f64, of: f64) -> f64 {
        if self.epsilon == 0.0 || difference == 0.0 || !difference.is_finite() {
            return difference;
        }
        let digits = difference.abs().log10().floor() - (self.epsilon * of.abs()).log10().ceil();
        if digits < 0.0 {
            return 0.0;
        }
        format!("{difference:.0$e}", whole(digits.min(16.0))).parse().unwrap_or(difference)
    }

    /// Whether any band has a name.
    pub fn has_names(&self) -> bool {
        self.names.iter().any(|name| !name.is_empty())
    }

    /// Wavelengths, ascending, and the [columns](Self::columns) in that order, called without their unit.
    pub fn curves(&self) -> (Vec<f64>, Vec<(&'static str, Vec<f64>)>) {
        let mut order: Vec<usize> = (0..self.wavelength_um.len()).collect();
        order.sort_by(|a, b| self.wavelength_um[*a].total_cmp(&self.wavelength_um[*b]));
        let sorted = |values: &[f64]| order.iter().map(|i| values[*i]).collect::<Vec<f64>>();
        let curve = |(name, values): (&'static str, Vec<f64>)| (name.trim_end_matches("_w_m2_sr_um"), sorted(&values));
        (sorted(&self.wavelength_um), self.columns().into_iter().map(curve).collect())
    }

    /// As CSV: comments with the pixel and its planes, a header with units, a row for each band.
    pub fn csv(&self) -> String {
        let mut text = format!("# sample {}, line {}, counted from 0\n", self.sample, self.line);
        for (name, value) in &self.planes {
            let _ = writeln!(text, "# {name} {}", number(*value));
        }
        let columns = self.columns();
        let names: Vec<&str> = columns.iter().map(|c| c.0).collect();
        let band = if self.has_names() { "band," } else { "" };
        let _ = writeln!(text, "{band}wavelength_um,{}", names.join(","));
        for (i, um) in self.wavelength_um.iter().enumerate() {
            if self.has_names() {
                let _ = write!(text, "{},", self.names[i].replace([',', '"'], " "));
            }
            let _ = write!(text, "{}", number(*um));
            columns.iter().for_each(|(_, values)| text.push_str(&format!(",{}", number(values[i]))));
            text.push('\n');
        }
        text
    }
}
