//! What the numbers of a cube are: radiance, or what follows from it band by band.

use super::{Added, Slab};
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::angle_rad;
use crate::physics::blackbody;
use crate::physics::reflectance::radiance_of_reflectance_factor;
use crate::scene::Scene;
use crate::spectral::{Band, Light};

/// What the numbers of a cube are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quantity {
    /// Mean spectral radiance over a band's response, L.
    #[default]
    Radiance,
    /// Radiance in a band, L times its width. Source: equation (16) of Domagala (2020).
    BandRadiance,
    /// I/F: pi L over the band's mean of sunlight normal to its beam.
    RadianceFactor,
    /// pi L over the band's mean of sunlight on level ground at the scene's origin.
    ReflectanceFactor,
    /// Temperature of the black body whose mean over the band's response is L.
    BrightnessTemperature,
    /// Numbers that a detector sends: not of radiance alone.
    Counts,
}

impl Quantity {
    /// Its name in options and reports.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Radiance => "radiance",
            Quantity::BandRadiance => "band_radiance",
            Quantity::RadianceFactor => "radiance_factor",
            Quantity::ReflectanceFactor => "reflectance_factor",
            Quantity::BrightnessTemperature => "brightness_temperature",
            Quantity::Counts => "counts",
        }
    }

    /// Whether it is radiance times a factor of the band: then spectra that pixels share are converted, and else each number by itself.
    pub fn is_proportional(self) -> bool {
        !matches!(self, Quantity::BrightnessTemperature | Quantity::Counts)
    }

    /// In words, as the title of an image.
    pub fn title(self) -> &'static str {
        match self {
            Quantity::Radiance => "Radiance",
            Quantity::BandRadiance => "Radiance in the band",
            Quantity::RadianceFactor => "Radiance factor",
            Quantity::ReflectanceFactor => "Reflectance factor",
            Quantity::BrightnessTemperature => "Brightness temperature",
            Quantity::Counts => "Numbers sent",
        }
    }

    /// Its unit; "1" without any.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Radiance => "W m-2 sr-1 um-1",
            Quantity::BandRadiance => "W m-2 sr-1",
            Quantity::RadianceFactor | Quantity::ReflectanceFactor => "1",
            Quantity::BrightnessTemperature => "K",
            Quantity::Counts => "DN",
        }
    }
}

/// How radiance becomes another quantity, band by band.
#[derive(Debug, Clone)]
pub struct Conversion {
    bands: Vec<OfBand>,
}

#[derive(Debug, Clone)]
enum OfBand {
    Times(f64),
    Temperature(Vec<(f64, f64)>),
}

/// Temperatures of the table that radiances are looked up in: ln T from 5 to 10,000 K in steps of 1 / 150, 2 K at 300 K.
const COLDEST_K: f64 = 5.0;
const STEP: f64 = 1.0 / 150.0;
const STEPS: u32 = 1141;

impl Conversion {
    /// Of a scene's bands.
    ///
    /// # Errors
    /// [`Error::Invalid`] with each band that has no such quantity: one without a width, or where sunlight is not known; and if the origin has no level
    /// ground, or the Sun is below it.
    pub fn new(quantity: Quantity, scene: &Scene) -> Result<Self> {
        let mut problems = Vec::new();
        let mut problem = |item: String, message: String| problems.push(Problem::new(Location::item(item), message));
        let cos_level = match quantity {
            Quantity::ReflectanceFactor => {
                let cosine = angle_rad(scene.body.origin_m, scene.sky.sun.direction.vec()).cos();
                let reason = if scene.body.origin_m == glam::DVec3::ZERO {
                    Some("the origin is the body's centre, where no ground is level")
                } else {
                    (cosine <= 0.0).then_some("the Sun is below level ground at the origin")
                };
                if let Some(reason) = reason {
                    problem(
                        "quantity".into(),
                        format!("{reason}: take radiance_factor, which divides by sunlight normal to its beam"),
                    );
                }
                cosine
            }
            _ => 1.0,
        };
        let mut of_band = |(i, band): (usize, &Band)| {
            let item = || format!("sensor.bands[{i}]");
            match quantity {
                Quantity::Counts => {
                    problem("quantity".into(), "numbers follow from a detector, not from radiance alone".into());
                    OfBand::Times(f64::NAN)
                }
                Quantity::Radiance => OfBand::Times(1.0),
                Quantity::BandRadiance => match band.in_band_w_m2_sr(1.0) {
                    Some(width) => OfBand::Times(width),
                    None => {
                        problem(item(), format!("at {} um has no width: no radiance is in it", band.centre_um));
                        OfBand::Times(f64::NAN)
                    }
                },
                Quantity::RadianceFactor | Quantity::ReflectanceFactor => match sunlight(scene, band) {
                    // L = REFF E / pi.
                    Some(normal) => OfBand::Times(radiance_of_reflectance_factor(1.0, normal * cos_level).recip()),
                    None => {
                        problem(item(), format!("at {} um has no sunlight to compare with", band.centre_um));
                        OfBand::Times(f64::NAN)
                    }
                },
                Quantity::BrightnessTemperature => {
                    OfBand::Temperature(temperatures(&band.quadrature(&[], scene.known_um(band.light))))
                }
            }
        };
        let bands = scene.exposure.bands.iter().enumerate().map(&mut of_band).collect();
        if problems.is_empty() { Ok(Conversion { bands }) } else { Err(Error::Invalid(problems)) }
    }

    /// A radiance, W m-2 sr-1 um-1, in a band of this number.
    pub fn of(&self, band: usize, radiance_w_m2_sr_um: f64) -> f64 {
        match &self.bands[band] {
            OfBand::Times(factor) => factor * radiance_w_m2_sr_um,
            OfBand::Temperature(table) => temperature_k(table, radiance_w_m2_sr_um),
        }
    }

    /// Hands out a slab in this quantity, whole or a few lines at a time.
    ///
    /// # Errors
    /// What `put` says.
    pub fn slabs(&self, mut slab: Slab, mut put: impl FnMut(Slab) -> Result<()>) -> Result<()> {
        let first = slab.bands.start;
        let bands = slab.bands.len();
        let factor =
            |band: usize| if let OfBand::Times(factor) = self.bands[first + band] { Some(factor) } else { None };
        if let Some(factors) = (0..bands).map(factor).collect::<Option<Vec<f64>>>() {
            slab.spectra
                .chunks_mut(bands.max(1))
                .for_each(|row| row.iter_mut().zip(&factors).for_each(|(v, f)| *v *= f));
            let reached = slab.added.reached();
            for (radiance, factor) in slab.added.radiance.chunks_mut(reached.max(1)).zip(&factors) {
                radiance.iter_mut().for_each(|value| *value *= factor);
            }
            return put(slab);
        }
        // What is not proportional belongs to pixels, not to spectra that they share.
        let samples = (slab.row_start.len().saturating_sub(1)) / slab.lines.len().max(1);
        for line in 0..slab.lines.len() {
            let mut added = Added::zeros(std::iter::repeat_n(true, samples), bands);
            let pixels = line * samples..(line + 1) * samples;
            slab.expand(pixels, 0..bands, |pixel, band, values| {
                for (k, value) in values.iter().enumerate() {
                    let at = (band + k) * samples + pixel - line * samples;
                    added.radiance[at] = self.of(first + band + k, *value);
                }
            });
            put(Slab {
                lines: slab.lines.start + line..slab.lines.start + line + 1,
                bands: slab.bands.clone(),
                row_start: vec![0; samples + 1],
                row: vec![],
                weight: vec![],
                spectra: vec![],
                first_thermal_row: 0,
                added,
            })?;
        }
        Ok(())
    }
}

/// The band's mean of sunlight normal to its beam at the scene, W m-2 um-1; `None` where it is not known, or if there is none.
fn sunlight(scene: &Scene, band: &Band) -> Option<f64> {
    let known_um = scene.known_um(Light::Sunlight);
    let (low_um, high_um) = band.support_within_um(known_um);
    let spectrum = &scene.sky.sun.irradiance_1au;
    let knots: Vec<f64> = spectrum.wavelength_um().iter().copied().filter(|um| low_um < *um && *um < high_um).collect();
    let at = |(um, weight): (f64, f64)| Some(weight * scene.sky.sun.irradiance_w_m2_um(um)?);
    let mean = band.quadrature(&knots, known_um).into_iter().map(at).sum::<Option<f64>>()?;
    (mean > 0.0).then_some(mean)
}

/// ln of the band's mean of black bodies, and ln T, where there is any radiance.
fn temperatures(quadrature: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let of = |k: u32| {
        let ln_t = COLDEST_K.ln() + f64::from(k) * STEP;
        let black = |(um, weight): &(f64, f64)| weight * blackbody::radiance_w_m2_sr_um(*um, ln_t.exp());
        (quadrature.iter().map(black).sum::<f64>().ln(), ln_t)
    };
    (0..STEPS).map(of).filter(|(ln_radiance, _)| *ln_radiance > f64::MIN_POSITIVE.ln()).collect()
}

/// The temperature of a radiance, K, by cubic interpolation of ln T in ln L; 0 of none, and what is beyond the table is at its ends.
fn temperature_k(table: &[(f64, f64)], radiance: f64) -> f64 {
    if radiance.is_nan() || radiance <= 0.0 {
        return if radiance.is_nan() { f64::NAN } else { 0.0 };
    }
    let (Some(first), Some(last)) = (table.first(), table.last()) else { return 0.0 };
    let x = radiance.ln().clamp(first.0, last.0);
    let from =
        table.partition_point(|(ln_radiance, _)| *ln_radiance < x).saturating_sub(2).min(table.len().saturating_sub(4));
    let points = &table[from..(from + 4).min(table.len())];
    // Lagrange polynomials.
    let term = |(i, (xi, y)): (usize, &(f64, f64))| {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        y * others.map(|(_, (xj, _))| (x - xj) / (xi - xj)).product::<f64>()
    };
    points.iter().enumerate().map(term).sum::<f64>().exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_are_found_again() {
        for band in [Band::new(1.0, None), Band::new(3.6, Some(0.4)), Band::boxed(11.0, 4.0)] {
            let quadrature = band.quadrature(&[], (0.1, 100.0));
            let table = temperatures(&quadrature);
            for t_k in [120.0, 201.3, 300.0, 333.3, 1000.0, 5772.0] {
                let black = |(um, weight): &(f64, f64)| weight * blackbody::radiance_w_m2_sr_um(*um, t_k);
                let found = temperature_k(&table, quadrature.iter().map(black).sum());
                assert!((found / t_k - 1.0).abs() < 1e-9, "{t_k}: {found}");
            }
            assert_eq!(temperature_k(&table, 0.0), 0.0);
            assert!(temperature_k(&table, f64::NAN).is_nan());
        }
    }
}
