//! A detector: radiance to electrons, to DN, and back to radiance.

use crate::error::{Location, Problem};
use crate::physics::signal;
use crate::random::{Draws, mix};
use crate::spectral::{Band, Spectrum};

use super::Lens;

/// A detector and its electronics. Random numbers follow from `seed` and the element or value they belong to.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    /// The lens and pixel that collect light.
    pub lens: Lens,
    /// Electrons per photon entering the optics, over wavelength (optics and detector).
    pub throughput: Spectrum,
    /// Exposure time, s.
    pub exposure_s: f64,
    /// Width of bands that have none, um.
    pub width_um: Option<f64>,
    /// Dark current, electrons per second.
    pub dark_e_s: f64,
    /// Background from the instrument's own radiation, electrons per second.
    pub background_e_s: f64,
    /// Noise of reading, electrons.
    pub read_e: f64,
    /// Full well, electrons.
    pub full_well_e: f64,
    /// Gain, electrons per DN.
    pub gain_e_dn: f64,
    /// Offset (bias level), DN.
    pub offset_dn: f64,
    /// Bit depth.
    pub bits: u32,
    /// Photo-response non-uniformity (PRNU), standard deviation, not removed by calibration.
    pub prnu: f64,
    /// Fraction of dead elements.
    pub dead_fraction: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// Largest bit depth.
const MOST_BITS: u32 = 32;

/// What random numbers are for.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Sensitivity = 1,
    Death = 2,
    Noise = 3,
}

/// Conversion of a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counting {
    /// Responsivity, electrons per W m-2 sr-1 um-1.
    pub electrons_per_radiance: f64,
    /// Dark and background electrons.
    pub others_e: f64,
    /// Noise of reading, electrons.
    pub read_e: f64,
    /// Electrons per DN.
    pub gain_e_dn: f64,
    /// PRNU, standard deviation.
    pub prnu: f64,
    full_well_e: f64,
    offset_dn: f64,
    most_dn: f64,
}

/// A pixel's measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// DN.
    pub dn: f64,
    /// Calibrated radiance, W m-2 sr-1 um-1.
    pub radiance: f64,
    /// Whether it is saturated, by full well or bit depth.
    pub is_saturated: bool,
}

/// An element of a detector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Its sensitivity relative to the mean.
    pub sensitivity: f64,
    /// Whether it is dead.
    pub is_dead: bool,
}

impl Detector {
    /// How a band is counted; `None` if it has no width, or the throughput is not known at its centre.
    pub fn counting(&self, band: &Band) -> Option<Counting> {
        let width_um = band.equivalent_width_um().or(self.width_um)?;
        let etendue_m2_sr = signal::etendue_m2_sr(self.lens.pixel_um * 1e-6, self.lens.f_number);
        let throughput = self.throughput.at(band.centre_um)?;
        Some(Counting {
            electrons_per_radiance: signal::electrons_per_radiance(
                band.centre_um,
                width_um,
                etendue_m2_sr,
                throughput,
                self.exposure_s,
            ),
            others_e: (self.dark_e_s + self.background_e_s) * self.exposure_s,
            read_e: self.read_e,
            gain_e_dn: self.gain_e_dn,
            prnu: self.prnu,
            full_well_e: self.full_well_e,
            offset_dn: self.offset_dn,
            most_dn: self.most_dn(),
        })
    }

    /// The largest number that is sent.
    fn most_dn(&self) -> f64 {
        2.0_f64.powi(self.bits.min(MOST_BITS).cast_signed()) - 1.0
    }

    /// An element by its number.
    pub fn element(&self, number: u64) -> Element {
        let draws = |purpose| Draws::new(self.key(purpose, number));
        let sensitivity = 1.0 + self.prnu * draws(Purpose::Sensitivity).normal();
        Element { sensitivity: sensitivity.max(0.0), is_dead: draws(Purpose::Death).unit() < self.dead_fraction }
    }

    /// Random numbers for the noise of a value of a cube, by its place and by the exposure.
    pub fn noise(&self, occasion: u64, place: u64) -> Draws {
        Draws::new(mix(self.key(Purpose::Noise, place) ^ mix(occasion)))
    }

    fn key(&self, purpose: Purpose, number: u64) -> u64 {
        mix(mix(mix(self.seed) ^ purpose as u64) ^ number)
    }

    /// Problems with it.
    pub fn problems(&self, item: &str) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem =
            |key: &str, message: String| problems.push(Problem::new(Location::item(format!("{item}.{key}")), message));
        for (key, value) in [
            ("f_number", self.lens.f_number),
            ("pixel_um", self.lens.pixel_um),
            ("exposure_s", self.exposure_s),
            ("full_well_e", self.full_well_e),
            ("gain_e_dn", self.gain_e_dn),
            ("width_um", self.width_um.unwrap_or(1.0)),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                problem(key, format!("{value} is not positive"));
            }
        }
        for (key, value) in [
            ("dark_e_s", self.dark_e_s),
            ("background_e_s", self.background_e_s),
            ("read_e", self.read_e),
            ("offset_dn", self.offset_dn),
            ("prnu", self.prnu),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                problem(key, format!("{value}: must be 0 or more"));
            }
        }
        if !(0.0..=1.0).contains(&self.dead_fraction) {
            problem("dead_fraction", format!("{}: must be 0 to 1", self.dead_fraction));
        }
        if !(1..=MOST_BITS).contains(&self.bits) {
            problem("bits", format!("{}: must be 1 to {MOST_BITS}", self.bits));
        }
        let most_dn = self.most_dn();
        if self.offset_dn >= most_dn {
            let message = format!("{} leaves no number for light: {} bits end at {most_dn}", self.offset_dn, self.bits);
            problem("offset_dn", message);
        }
        if self.throughput.value().iter().any(|value| !(0.0..=1.0).contains(value)) {
            problem("throughput", "must be 0 to 1 at all wavelengths".to_owned());
        }
        problems
    }
}

impl Counting {
    /// Measures a radiance, W m-2 sr-1 um-1, with an element: Poisson electrons, read noise, and rounding to DN. A dead
    /// element gives the DN of no electrons.
    pub fn measure(&self, radiance: f64, element: Element, mut noise: Draws) -> Measured {
        if element.is_dead {
            return Measured { dn: self.offset_dn.round(), radiance: 0.0, is_saturated: false };
        }
        let expected_e = (radiance * self.electrons_per_radiance * element.sensitivity).max(0.0) + self.others_e;
        let counted_e = noise.count(expected_e);
        let held_e = counted_e.min(self.full_well_e) + self.read_e * noise.normal();
        let dn = (held_e / self.gain_e_dn + self.offset_dn).round().clamp(0.0, self.most_dn);
        let is_saturated = counted_e > self.full_well_e || dn == self.most_dn;
        Measured { dn, radiance: self.radiance(dn), is_saturated }
    }

    /// Calibrated radiance of a DN, W m-2 sr-1 um-1, with dark and background removed. 0 where the band transmits
    /// nothing.
    pub fn radiance(&self, dn: f64) -> f64 {
        self.radiance_of_electrons((dn - self.offset_dn) * self.gain_e_dn - self.others_e)
    }

    /// Radiance of a number of electrons, W m-2 sr-1 um-1; 0 where the band lets nothing through.
    fn radiance_of_electrons(&self, electrons: f64) -> f64 {
        if self.electrons_per_radiance > 0.0 { electrons / self.electrons_per_radiance } else { 0.0 }
    }

    /// Radiance per DN, W m-2 sr-1 um-1.
    pub fn radiance_per_dn(&self) -> f64 {
        self.radiance_of_electrons(self.gain_e_dn)
    }

    /// DN without light, on average.
    pub fn zero_dn(&self) -> f64 {
        self.offset_dn + self.others_e / self.gain_e_dn
    }

    /// Signal-to-noise ratio of a radiance.
    pub fn snr(&self, radiance: f64) -> f64 {
        if radiance > self.brightest() {
            return 0.0;
        }
        signal::snr(radiance * self.electrons_per_radiance, self.others_e, self.read_e, self.gain_e_dn, self.prnu)
    }

    /// Saturation radiance, on average.
    pub fn brightest(&self) -> f64 {
        let most_e = self.full_well_e.min((self.most_dn - self.offset_dn) * self.gain_e_dn);
        self.radiance_of_electrons((most_e - self.others_e).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detector() -> Detector {
        Detector {
            lens: Lens { f_number: 4.0, pixel_um: 30.0 },
            throughput: Spectrum::constant(0.3),
            exposure_s: 1.0,
            width_um: None,
            dark_e_s: 1e4,
            background_e_s: 0.0,
            read_e: 100.0,
            full_well_e: 2e6,
            gain_e_dn: 40.0,
            offset_dn: 100.0,
            bits: 16,
            prnu: 0.0,
            dead_fraction: 0.0,
            seed: 1,
        }
    }

    const PLAIN: Element = Element { sensitivity: 1.0, is_dead: false };

    #[test]
    fn many_measurements_have_the_mean_and_the_noise_that_is_told() {
        let detector = detector();
        let counting = detector.counting(&Band::new(3.0, Some(0.01))).unwrap();
        let (radiance, n) = (0.4, 40_000_u32);
        let measured: Vec<f64> =
            (0..n).map(|i| counting.measure(radiance, PLAIN, detector.noise(0, u64::from(i))).radiance).collect();
        let mean = measured.iter().sum::<f64>() / f64::from(n);
        let variance = measured.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n - 1);
        let noise = radiance / counting.snr(radiance);
        assert!((mean - radiance).abs() < 4.5 * noise / f64::from(n).sqrt(), "{mean}");
        // The variance of a variance is 2 s^4 / n.
        assert!((variance / (noise * noise) - 1.0).abs() < 4.5 * (2.0 / f64::from(n)).sqrt(), "{variance}");
    }

    #[test]
    fn numbers_go_there_and_back() {
        let detector = Detector { read_e: 0.0, dark_e_s: 0.0, ..detector() };
        let counting = detector.counting(&Band::new(2.0, Some(0.01))).unwrap();
        assert_eq!(counting.radiance(100.0), 0.0);
        let one = counting.radiance(101.0);
        assert!((one * counting.electrons_per_radiance - 40.0).abs() < 1e-12);
        // Too bright for the pixel: 2e6 electrons are 50 000 steps.
        let bright = counting.measure(10.0 * counting.brightest(), PLAIN, detector.noise(0, 0));
        assert_eq!((bright.dn, bright.is_saturated), (50_100.0, true));
        // Too bright for the number.
        let few = Detector { bits: 8, ..detector.clone() }.counting(&Band::new(2.0, Some(0.01))).unwrap();
        let bright = few.measure(1e3, PLAIN, detector.noise(0, 0));
        assert_eq!((bright.dn, bright.is_saturated), (255.0, true));
        // No light, and what sees none.
        assert_eq!(counting.measure(0.0, PLAIN, detector.noise(0, 5)).radiance, 0.0);
        let dead = counting.measure(1.0, Element { is_dead: true, ..PLAIN }, detector.noise(0, 5));
        assert_eq!((dead.dn, dead.radiance), (100.0, 0.0));
    }

    #[test]
    fn elements_are_as_many_and_as_different_as_told() {
        let detector = Detector { prnu: 0.01, dead_fraction: 0.02, ..detector() };
        let elements: Vec<Element> = (0..50_000).map(|i| detector.element(i)).collect();
        let dead = elements.iter().filter(|e| e.is_dead).count() as f64;
        assert!((dead - 1000.0).abs() < 4.5 * (1000.0_f64 * 0.98).sqrt(), "{dead}");
        let variance = elements.iter().map(|e| (e.sensitivity - 1.0).powi(2)).sum::<f64>() / 5e4;
        assert!((variance / 1e-4 - 1.0).abs() < 4.5 * (2.0_f64 / 5e4).sqrt(), "{variance}");
        assert_eq!(detector.element(7), detector.element(7));
        // Elements stay what they are; noise is another one on another occasion, and at another place.
        let first = |occasion, place| detector.noise(occasion, place).unit();
        assert_eq!(first(1, 5), first(1, 5));
        assert!(first(1, 5) != first(2, 5) && first(1, 5) != first(1, 6) && first(2, 1) != first(1, 2));
    }
}
