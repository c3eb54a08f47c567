//! A raster's numbers as spectral radiance.

use std::path::PathBuf;

use super::types::{QuantityToml, UnitToml};
use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::raster::Raster;
use crate::physics::{blackbody, reflectance};
use crate::product::TexelSource;
use crate::spectral::Band;

/// What is done to a number of a band to make it spectral radiance, W m-2 sr-1 um-1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Conversion {
    /// Radiance, in another unit.
    Times(f64),
    /// Reflectance factor times so much, under an irradiance, W m-2 um-1.
    OfFactor { scale: f64, irradiance: f64 },
    /// Brightness temperature, K, at a wavelength, um.
    OfTemperature(f64),
}

impl Conversion {
    /// For a band; `irradiance` is for reflectance factors.
    pub(super) fn new(
        quantity: QuantityToml,
        unit: UnitToml,
        band: &Band,
        irradiance: Option<f64>,
    ) -> std::result::Result<Self, String> {
        use QuantityToml::{BandRadiance, BrightnessTemperature, Radiance, ReflectanceFactor};
        use UnitToml::{InBand, Kelvin, MicroPerCm2PerNm, MilliPerNm, One, PerNm, PerUm, Percent};
        Ok(match (quantity, unit) {
            (Radiance, PerUm | MilliPerNm) => Conversion::Times(1.0),
            (Radiance, PerNm) => Conversion::Times(1e3),
            (Radiance, MicroPerCm2PerNm) => Conversion::Times(10.0),
            (BandRadiance, InBand) => match band.fwhm_um {
                Some(width_um) if width_um > 0.0 => Conversion::Times(1.0 / width_um),
                _ => {
                    return Err(format!(
                        "radiance in a band needs the band's width, which that at {} um lacks",
                        band.centre_um
                    ));
                }
            },
            (ReflectanceFactor, One | Percent) => {
                let irradiance = irradiance
                    .ok_or("a reflectance factor needs the irradiance that it refers to: give `irradiance_w_m2_um`")?;
                Conversion::OfFactor { scale: if unit == Percent { 0.01 } else { 1.0 }, irradiance }
            }
            (BrightnessTemperature, Kelvin) => Conversion::OfTemperature(band.centre_um),
            (Radiance, _) => return Err("is no unit of spectral radiance: \"W m-2 sr-1 um-1\", say".into()),
            (BandRadiance, _) => return Err("is no unit of radiance in a band: \"W m-2 sr-1\"".into()),
            (ReflectanceFactor, _) => return Err("is no unit of a factor: \"1\" or \"%\"".into()),
            (BrightnessTemperature, _) => return Err("is no unit of temperature: \"K\"".into()),
        })
    }

    fn radiance(self, value: f64) -> f64 {
        match self {
            Conversion::Times(scale) => scale * value,
            Conversion::OfFactor { scale, irradiance } => {
                reflectance::radiance_of_reflectance_factor(scale * value, irradiance)
            }
            Conversion::OfTemperature(um) => {
                if value < 0.0 {
                    value
                } else {
                    blackbody::radiance_w_m2_sr_um(um, value)
                }
            }
        }
    }
}

/// Rasters whose bands follow one another.
pub(super) struct RasterTexels {
    pub(super) rasters: Vec<Raster>,
    pub(super) bands: Vec<Band>,
    /// For each band.
    pub(super) conversion: Vec<Conversion>,
    pub(super) no_data: Option<f64>,
    /// Whether small numbers below 0 are 0.
    pub(super) clips: bool,
}

/// Numbers below 0 that a filter leaves are smaller than this share of the largest number: the side lobes of Lanczos' filter in two
/// dimensions reach a sixth.
const SIDE_LOBES: f64 = 0.2;

impl RasterTexels {
    /// The raster of a band, and its number there.
    fn place(&self, band: usize) -> Option<(usize, usize)> {
        let mut rest = band;
        for (i, raster) in self.rasters.iter().enumerate() {
            if rest < raster.bands.len() {
                return Some((i, rest));
            }
            rest -= raster.bands.len();
        }
        None
    }
}

impl TexelSource for RasterTexels {
    fn bands(&self) -> &[Band] {
        &self.bands
    }

    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        let Some((raster, within)) = self.place(band) else {
            return Err(Error::invalid(Location::item("band"), format!("there is no band {}", band + 1)));
        };
        self.rasters[raster].read(within, values)?;
        let conversion = self.conversion[band];
        if let Some(no_data) = self.no_data {
            let no_data = [no_data, self.rasters[raster].as_stored(no_data)];
            values.iter_mut().filter(|v| no_data.contains(v)).for_each(|v| *v = f64::NAN);
        }
        if self.clips {
            let largest = values.iter().copied().fold(0.0, f64::max);
            values.iter_mut().filter(|v| -SIDE_LOBES * largest < **v && **v < 0.0).for_each(|v| *v = 0.0);
        }
        // A chunk at a time without a way out of it, so that several values are compared at once.
        let is_negative = |chunk: &[f64]| chunk.iter().fold(false, |found, v| found | (*v < 0.0));
        if let Some(chunk) = values.chunks(1024).position(is_negative)
            && let Some(i) = (1024 * chunk..values.len()).find(|i| values[*i] < 0.0)
        {
            return Err(self.negative(&self.rasters[raster], within, i, values[i]));
        }
        if conversion != Conversion::Times(1.0) {
            values.iter_mut().for_each(|v| *v = conversion.radiance(*v));
        }
        Ok(())
    }
}

impl RasterTexels {
    fn negative(&self, raster: &Raster, band: usize, i: usize, value: f64) -> Error {
        let at = Location::file(&raster.path).with_item(format!(
            "band {}, row {}, column {}",
            band + 1,
            i / raster.columns,
            i % raster.columns
        ));
        let help = if value == -1.0 {
            "if -1 stands for what is not known, say `no_data = -1`"
        } else if self.clips {
            "`negative = \"clip\"` makes numbers 0 whose magnitude is below a fifth of the band's largest; this one is more"
        } else {
            "say which number stands for what is not known: `no_data`; if a filter left it beside a bright edge: `negative = \"clip\"`"
        };
        Error::Invalid(vec![
            Problem::new(at, format!("{} is negative, which nothing that a map holds can be", number(value)))
                .with_help(help),
        ])
    }
}

/// Values of facets in memory: [facet, band].
#[derive(Debug)]
pub(super) struct FacetTexels {
    pub(super) path: PathBuf,
    pub(super) bands: Vec<Band>,
    /// W m-2 sr-1 um-1.
    pub(super) values: Vec<f64>,
}

impl FacetTexels {
    /// Whether bands and values can be what they are said to be.
    pub(super) fn check(&self) -> Result<()> {
        if let Some(band) = self.bands.iter().find(|b| !(b.centre_um > 0.0 && b.centre_um.is_finite())) {
            return Err(Error::invalid(Location::file(&self.path), format!("{} um is no wavelength", band.centre_um)));
        }
        let has_width = |b: &&Band| b.fwhm_um.is_some_and(|w| !(w > 0.0 && w < b.centre_um));
        if let Some(Band { centre_um, fwhm_um }) = self.bands.iter().find(has_width) {
            let width = fwhm_um.map_or_else(String::new, number);
            let at = Location::file(&self.path).with_item("fwhm_um");
            let problem = Problem::new(at, format!("a width of {width} um for a band at {centre_um} um"))
                .with_help("widths are in um, from 0 (monochromatic) and less than the centre");
            return Err(Error::Invalid(vec![problem]));
        }
        if let Some(i) = self.values.iter().position(|v| *v < 0.0 || v.is_infinite()) {
            let (facet, band) = (i / self.bands.len(), i % self.bands.len());
            let at = Location::file(&self.path).with_item(format!("facet {facet}, band {}", band + 1));
            let problem = Problem::new(at, format!("the radiance {}", self.values[i]))
                .with_help("radiance is a number from 0; mark what is not known by NaN");
            return Err(Error::Invalid(vec![problem]));
        }
        Ok(())
    }
}

impl TexelSource for FacetTexels {
    fn bands(&self) -> &[Band] {
        &self.bands
    }

    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        values.clear();
        if band >= self.bands.len() {
            return Err(Error::invalid(Location::file(&self.path), format!("there is no band {}", band + 1)));
        }
        values.extend(self.values.chunks_exact(self.bands.len()).map(|facet| facet[band]));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn band(centre_um: f64, fwhm_um: Option<f64>) -> Band {
        Band { centre_um, fwhm_um }
    }

    fn radiance(quantity: QuantityToml, unit: UnitToml, band: Band, irradiance: Option<f64>, value: f64) -> f64 {
        Conversion::new(quantity, unit, &band, irradiance).unwrap().radiance(value)
    }

    #[test]
    fn all_quantities_become_radiance() {
        use QuantityToml::*;
        use UnitToml::*;
        let at_1 = band(1.0, None);
        assert_eq!(radiance(Radiance, PerUm, at_1, None, 3.0), 3.0);
        assert_eq!(radiance(Radiance, PerNm, at_1, None, 0.003), 3.0);
        assert_eq!(radiance(Radiance, MilliPerNm, at_1, None, 3.0), 3.0);
        // 1 uW cm-2 nm-1 = 1e-6 W 1e4 m-2 1e3 um-1.
        assert_eq!(radiance(Radiance, MicroPerCm2PerNm, at_1, None, 0.3), 3.0);
        assert_eq!(radiance(BandRadiance, InBand, band(1.0, Some(0.25)), None, 3.0), 12.0);
        // White under pi W m-2 um-1 sends 1 W m-2 sr-1 um-1.
        assert!((radiance(ReflectanceFactor, One, at_1, Some(std::f64::consts::PI), 0.5) - 0.5).abs() < 1e-16);
        assert!((radiance(ReflectanceFactor, Percent, at_1, Some(std::f64::consts::PI), 50.0) - 0.5).abs() < 1e-16);
        // Planck at 10 um and 300 K: c1L l^-5 / (exp(c2 / l T) - 1) = 1.19104297e8 1e-5 / (exp(4.79592561) - 1).
        let planck = 1.191_042_972e8 * 1e-5 / (14_387.768_775_f64 / 3000.0).exp_m1();
        assert!((radiance(BrightnessTemperature, Kelvin, band(10.0, None), None, 300.0) / planck - 1.0).abs() < 1e-8);
        assert!(Conversion::new(ReflectanceFactor, One, &at_1, None).unwrap_err().contains("irradiance"));
        assert!(Conversion::new(BandRadiance, InBand, &at_1, None).unwrap_err().contains("width"));
        assert!(Conversion::new(Radiance, Kelvin, &at_1, None).is_err());
    }
}
