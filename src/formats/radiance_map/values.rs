//! A raster's numbers as spectral radiance.

use std::path::PathBuf;

use super::types::QuantityToml;
use super::unit::Unit;
use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::raster::Raster;
use crate::formats::scene_toml::Tiling;
use crate::physics::{blackbody, reflectance};
use crate::product::TexelSource;
use crate::spectral::Band;
use crate::units::cm_1_per_um;

/// What is done to a number of a band to make it spectral radiance, W m-2 sr-1 um-1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ToRadiance {
    /// Radiance, in another unit.
    Times(f64),
    /// Reflectance factor times so much, under an irradiance, W m-2 um-1.
    OfFactor { scale: f64, irradiance: f64 },
    /// Brightness temperature, K, at a wavelength, um.
    OfTemperature(f64),
}

impl ToRadiance {
    /// For a band; `irradiance` is for reflectance factors.
    pub(super) fn new(
        quantity: QuantityToml,
        unit: &Unit,
        band: &Band,
        irradiance: Option<f64>,
    ) -> std::result::Result<Self, String> {
        use QuantityToml::{BandRadiance, BrightnessTemperature, Radiance, ReflectanceFactor};
        let of = |wanted: &str| Unit::of(wanted).and_then(|wanted| unit.over(&wanted));
        let times = match quantity {
            Radiance => of("W m-2 sr-1 um-1")
                .or_else(|| Some(of("W m-2 sr-1 (cm-1)-1")? * cm_1_per_um(band.centre_um)))
                .ok_or("the quantity is a radiance: its unit must be one of spectral radiance, such as \"W m-2 sr-1 um-1\""),
            BandRadiance => of("W m-2 sr-1").ok_or("the quantity is the radiance in a band: its unit must be \"W m-2 sr-1\", or a multiple of it"),
            ReflectanceFactor => of("1").ok_or("the quantity is a reflectance factor: its unit must be \"1\" or \"%\""),
            BrightnessTemperature => of("K").filter(|times| *times == 1.0).ok_or("the quantity is a brightness temperature: its unit must be \"K\""),
        }?;
        Ok(match quantity {
            Radiance => ToRadiance::Times(times),
            BandRadiance => match band.fwhm_um {
                Some(width_um) if width_um > 0.0 => ToRadiance::Times(times / width_um),
                _ => {
                    return Err(format!(
                        "radiance in a band needs the band's width, which that at {} um lacks",
                        band.centre_um
                    ));
                }
            },
            ReflectanceFactor => {
                let irradiance = irradiance
                    .ok_or("a reflectance factor needs the irradiance that it refers to: give `irradiance_w_m2_um`")?;
                ToRadiance::OfFactor { scale: times, irradiance }
            }
            BrightnessTemperature => ToRadiance::OfTemperature(band.centre_um),
        })
    }

    fn radiance(self, value: f64) -> f64 {
        match self {
            ToRadiance::Times(scale) => scale * value,
            ToRadiance::OfFactor { scale, irradiance } => {
                reflectance::radiance_of_reflectance_factor(scale * value, irradiance)
            }
            ToRadiance::OfTemperature(um) => {
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
    pub(super) conversion: Vec<ToRadiance>,
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
        if conversion != ToRadiance::Times(1.0) {
            values.iter_mut().for_each(|v| *v = conversion.radiance(*v));
        }
        Ok(())
    }

    fn coverage(&mut self) -> Result<Option<Vec<f64>>> {
        // Of several rasters the least: what one of them does not know of a texel is not known.
        let mut least: Option<Vec<f64>> = None;
        for raster in &mut self.rasters {
            match (raster.coverage()?, &mut least) {
                (Some(shares), Some(least)) => least.iter_mut().zip(shares).for_each(|(a, b)| *a = a.min(*b)),
                (Some(shares), None) => least = Some(shares.to_vec()),
                (None, _) => {}
            }
        }
        Ok(least)
    }
}

/// The same, of an image that is repeated.
pub(super) struct TiledTexels {
    pub(super) texels: RasterTexels,
    pub(super) tiling: Tiling,
    /// A band of the image; working memory.
    pub(super) image: Vec<f64>,
}

impl TexelSource for TiledTexels {
    fn bands(&self) -> &[Band] {
        self.texels.bands()
    }

    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        self.texels.read(band, &mut self.image)?;
        self.tiling.expanded(&self.image, values);
        Ok(())
    }

    fn coverage(&mut self) -> Result<Option<Vec<f64>>> {
        let image = self.texels.coverage()?;
        Ok(image.map(|image| {
            let mut all = Vec::new();
            self.tiling.expanded(&image, &mut all);
            all
        }))
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
            "if -1 means \"not known\", say `no_data = -1`"
        } else if self.clips {
            "`negative = \"clip\"` makes numbers 0 whose magnitude is below a fifth of the band's largest; this one is more"
        } else {
            "say which number means \"not known\": `no_data`; if a filter left it next to a bright edge: `negative = \"clip\"`"
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
    /// Checks that bands and values can be what they claim to be.
    pub(super) fn check(&self) -> Result<()> {
        if let Some(band) = self.bands.iter().find(|b| !(b.centre_um > 0.0 && b.centre_um.is_finite())) {
            return Err(Error::invalid(
                Location::file(&self.path),
                format!("{} um is not a wavelength", band.centre_um),
            ));
        }
        let has_width = |b: &&Band| b.fwhm_um.is_some_and(|w| !(w > 0.0 && w <= 2.0 * b.centre_um));
        if let Some(Band { centre_um, fwhm_um, .. }) = self.bands.iter().find(has_width) {
            let width = fwhm_um.map_or_else(String::new, number);
            let at = Location::file(&self.path).with_item("fwhm_um");
            let problem = Problem::new(at, format!("a width of {width} um for a band at {centre_um} um"))
                .with_help("widths are in um, from 0 (monochromatic) to twice the centre");
            return Err(Error::Invalid(vec![problem]));
        }
        if let Some(i) = self.values.iter().position(|v| *v < 0.0 || v.is_infinite()) {
            let (facet, band) = (i / self.bands.len(), i % self.bands.len());
            let at = Location::file(&self.path).with_item(format!("facet {facet}, band {}", band + 1));
            let problem = Problem::new(at, format!("the radiance {}", self.values[i]))
                .with_help("radiance is a number of at least 0; mark unknown values by NaN");
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
        Band::new(centre_um, fwhm_um)
    }

    fn radiance(quantity: QuantityToml, unit: &str, band: Band, irradiance: Option<f64>, value: f64) -> f64 {
        ToRadiance::new(quantity, &Unit::of(unit).unwrap(), &band, irradiance).unwrap().radiance(value)
    }

    #[test]
    fn all_quantities_become_radiance() {
        use QuantityToml::*;
        let at_1 = || band(1.0, None);
        assert_eq!(radiance(Radiance, "W m-2 sr-1 um-1", at_1(), None, 3.0), 3.0);
        assert_eq!(radiance(Radiance, "W m-2 sr-1 nm-1", at_1(), None, 0.003), 3.0);
        assert_eq!(radiance(Radiance, "mW m-2 sr-1 nm-1", at_1(), None, 3.0), 3.0);
        // 1 uW cm-2 nm-1 = 1e-6 W 1e4 m-2 1e3 um-1.
        assert_eq!(radiance(Radiance, "uW cm-2 sr-1 nm-1", at_1(), None, 0.3), 3.0);
        // At 10 um a cm-1 is 1e-2 um wide: 1 mW per cm-1 is 0.1 W per um.
        assert!((radiance(Radiance, "mW/(m2 sr cm-1)", band(10.0, None), None, 3.0) - 0.3).abs() < 1e-15);
        assert_eq!(radiance(BandRadiance, "W m-2 sr-1", band(1.0, Some(0.25)), None, 3.0), 12.0);
        // White under pi W m-2 um-1 sends 1 W m-2 sr-1 um-1.
        assert!((radiance(ReflectanceFactor, "1", at_1(), Some(std::f64::consts::PI), 0.5) - 0.5).abs() < 1e-16);
        assert!((radiance(ReflectanceFactor, "%", at_1(), Some(std::f64::consts::PI), 50.0) - 0.5).abs() < 1e-16);
        // Planck at 10 um and 300 K: c1L l^-5 / (exp(c2 / l T) - 1) = 1.19104297e8 1e-5 / (exp(4.79592561) - 1).
        let planck = 1.191_042_972e8 * 1e-5 / (14_387.768_775_f64 / 3000.0).exp_m1();
        assert!((radiance(BrightnessTemperature, "K", band(10.0, None), None, 300.0) / planck - 1.0).abs() < 1e-8);
        let refused =
            |quantity, unit: &str| ToRadiance::new(quantity, &Unit::of(unit).unwrap(), &at_1(), None).unwrap_err();
        assert!(refused(ReflectanceFactor, "1").contains("irradiance"));
        assert!(refused(BandRadiance, "W m-2 sr-1").contains("width"));
        assert!(refused(Radiance, "K").contains("must be one of spectral radiance"));
        assert!(refused(Radiance, "W m-2 sr-1").contains("must be one of spectral radiance"));
    }
}
