//! A detector reads an image: DN, calibrated radiance, and signal-to-noise statistics.

use std::ops::Range;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Location, Problem, Result};
use crate::instrument::{Counting, Detector, Element};
use crate::product::{CubeAxes, Slab};
use crate::scene::{Readout, uncovered};

/// A detector at work on one cube.
#[derive(Debug, Clone)]
pub struct Reader {
    detector: Detector,
    axes: CubeAxes,
    readout: Readout,
    occasion: u64,
    bands: Vec<Counting>,
    account: Vec<BandSignal>,
    /// Of each pixel: what its signal over noise adds up to over bands, the lowest of them, and how many are at least [`GOOD`].
    snr: [Vec<f64>; 3],
}

/// A measured slab.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Calibrated radiance, W m-2 sr-1 um-1.
    pub radiance: Slab,
    /// DN.
    pub numbers: Slab,
}

/// Signal and noise of a band, before and after the detector.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BandSignal {
    /// Centre, um.
    pub centre_um: f64,
    /// Lowest radiance of a pixel that shows something, W m-2 sr-1 um-1.
    pub lowest: f64,
    /// Mean radiance of these pixels.
    pub mean: f64,
    /// Highest radiance.
    pub highest: f64,
    /// Saturation radiance.
    pub brightest: f64,
    /// Electrons of the mean radiance.
    pub signal_e: f64,
    /// Dark and background electrons.
    pub others_e: f64,
    /// Shot noise of all electrons, electrons.
    pub shot_e: f64,
    /// Read noise, electrons.
    pub read_e: f64,
    /// Quantisation noise, electrons.
    pub rounding_e: f64,
    /// Noise of the elements' sensitivities, electrons, at the mean radiance: the same in every image.
    #[serde(default)]
    pub sensitivity_e: f64,
    /// Calibration: radiance is `radiance_per_dn` times (number - `zero_dn`), W m-2 sr-1 um-1.
    #[serde(default)]
    pub radiance_per_dn: f64,
    /// The number that no light gives, on average.
    #[serde(default)]
    pub zero_dn: f64,
    /// Signal-to-noise ratio of the lowest radiance.
    pub snr_lowest: f64,
    /// Signal-to-noise ratio of the mean radiance.
    pub snr_mean: f64,
    /// Pixels with signal.
    pub pixels: u64,
    /// Saturated pixels.
    pub saturated: u64,
}

/// Lines are read together up to this size of their numbers.
const LINES_BYTES: usize = 64 << 20;
/// Required signal-to-noise ratio of such instruments.
pub const GOOD: f64 = 100.0;

impl Reader {
    /// For the cube of an exposure, of which this much is read at once. Noise is another one on another occasion; elements are the same.
    ///
    /// # Errors
    /// [`Error::Invalid`] with each band that has no width, or is not covered by the detector's throughput.
    pub fn new(detector: &Detector, axes: CubeAxes, (readout, occasion): (Readout, u64)) -> Result<Self> {
        if let Some(message) = uncovered("throughput", &detector.throughput, &axes.bands, |_| true) {
            return Err(Error::invalid(Location::item("sensor.detector.throughput"), message));
        }
        let bands: Vec<Option<Counting>> = axes.bands.iter().map(|band| detector.counting(band)).collect();
        let problem = |(i, _): (usize, &Option<Counting>)| {
            let message = format!("band at {} um needs a width", axes.bands[i].centre_um);
            Problem::new(Location::item(format!("sensor.bands[{i}]")), message)
                .with_help("give `sensor.bands.fwhm_um`, or `sensor.detector.width_um` for all of them")
        };
        let problems: Vec<Problem> =
            bands.iter().enumerate().filter(|(_, b)| b.is_none()).map(problem).take(20).collect();
        if !problems.is_empty() {
            return Err(Error::Invalid(problems));
        }
        let bands: Vec<Counting> = bands.into_iter().flatten().collect();
        let empty = |(band, counting): (&crate::spectral::Band, &Counting)| BandSignal {
            centre_um: band.centre_um,
            lowest: f64::INFINITY,
            mean: 0.0,
            highest: 0.0,
            brightest: counting.brightest(),
            signal_e: 0.0,
            others_e: counting.others_e,
            shot_e: 0.0,
            read_e: counting.read_e,
            rounding_e: counting.gain_e_dn / 12.0_f64.sqrt(),
            sensitivity_e: 0.0,
            radiance_per_dn: counting.radiance_per_dn(),
            zero_dn: counting.zero_dn(),
            snr_lowest: 0.0,
            snr_mean: 0.0,
            pixels: 0,
            saturated: 0,
        };
        let account = axes.bands.iter().zip(&bands).map(empty).collect();
        let pixels = axes.samples * axes.lines;
        let snr = [vec![0.0; pixels], vec![f64::INFINITY; pixels], vec![0.0; pixels]];
        Ok(Reader { detector: detector.clone(), axes, readout, occasion, bands, account, snr })
    }

    /// Reads a slab of radiance; `put` takes what comes of it, some lines at a time.
    ///
    /// # Errors
    /// What `put` says.
    pub fn read(&mut self, slab: &Slab, mut put: impl FnMut(Reading) -> Result<()>) -> Result<()> {
        let step = (LINES_BYTES / (8 * self.axes.samples * slab.bands.len()).max(1)).max(1);
        for start in (0..slab.lines.len()).step_by(step) {
            let reading = self.read_lines(slab, start..slab.lines.len().min(start + step));
            put(reading)?;
        }
        Ok(())
    }

    /// Reads some lines of a slab, counted from its first.
    fn read_lines(&mut self, slab: &Slab, lines: Range<usize>) -> Reading {
        let Reader { detector, axes, readout, occasion, bands, .. } = &*self;
        let (samples, all_bands) = (axes.samples, slab.bands.len());
        let pixels = samples * lines.len();
        let in_slab = lines.start * samples;
        let first = slab.lines.start * samples + in_slab;
        // What a push-broom's slit is dispersed over is read anew for each line; other sensors have an element for each pixel.
        let element = |pixel: usize, band: usize| match readout {
            Readout::Line => (band * samples + pixel % samples) as u64,
            Readout::Sample(mirror) => {
                let elements = mirror.elements.max(1) as usize;
                (band * elements + (first + pixel) / samples % elements) as u64
            }
            Readout::Frame | Readout::Band => (first + pixel) as u64,
        };
        let by_pixel: Vec<Element> = match readout {
            Readout::Line | Readout::Sample(_) => vec![],
            Readout::Frame | Readout::Band => {
                (0..pixels).into_par_iter().map(|pixel| detector.element(element(pixel, 0))).collect()
            }
        };
        let [mut radiance, mut numbers] = [0, 1].map(|_| vec![0.0; pixels * all_bands]);
        let each = radiance.par_chunks_exact_mut(pixels.max(1)).zip(numbers.par_chunks_exact_mut(pixels.max(1)));
        let made: Vec<(BandSignal, Vec<f64>)> = each
            .enumerate()
            .map(|(i, (radiance, numbers))| {
                let band = slab.bands.start + i;
                let counting = &bands[band];
                let mut sums = BandSignal { ..self.account[band] };
                let mut snr = vec![0.0; pixels];
                let noise_of =
                    |pixel: usize| detector.noise(*occasion, (band * axes.samples * axes.lines + first + pixel) as u64);
                slab.expand(in_slab..in_slab + pixels, i..i + 1, |pixel, _, value| {
                    let (pixel, light) = (pixel - in_slab, value[0]);
                    let element =
                        by_pixel.get(pixel).copied().unwrap_or_else(|| detector.element(element(pixel, band)));
                    let measured = counting.measure(light, element, noise_of(pixel));
                    // Unknown radiance is not measured; its DN is still written.
                    radiance[pixel] = if light.is_nan() { light } else { measured.radiance };
                    numbers[pixel] = measured.dn;
                    sums.saturated += u64::from(measured.is_saturated);
                    if light > 0.0 {
                        sums.lowest = sums.lowest.min(light);
                        sums.highest = sums.highest.max(light);
                        // A sum for now.
                        sums.mean += light;
                        sums.pixels += 1;
                    }
                    snr[pixel] = counting.snr(light.max(0.0));
                });
                (sums, snr)
            })
            .collect();
        for (i, (sums, snr)) in made.into_iter().enumerate() {
            self.account[slab.bands.start + i] = sums;
            let [sum, least, good] = &mut self.snr;
            for (pixel, snr) in snr.into_iter().enumerate() {
                let pixel = first + pixel;
                sum[pixel] += snr;
                least[pixel] = least[pixel].min(snr);
                good[pixel] += f64::from(snr >= GOOD);
            }
        }
        let like = |values| {
            let lines = slab.lines.start + lines.start..slab.lines.start + lines.end;
            Slab::dense(lines, slab.bands.clone(), values)
        };
        Reading { radiance: like(radiance), numbers: like(numbers) }
    }

    /// Signal and noise of each band, of all that was read.
    pub fn account(&self) -> Vec<BandSignal> {
        let finished = |(sums, counting): (&BandSignal, &Counting)| {
            let mean = if sums.pixels > 0 { sums.mean / sums.pixels as f64 } else { 0.0 };
            let lowest = if sums.pixels > 0 { sums.lowest } else { 0.0 };
            let signal_e = mean * counting.electrons_per_radiance;
            BandSignal {
                mean,
                lowest,
                signal_e,
                sensitivity_e: counting.prnu * signal_e,
                shot_e: (signal_e + sums.others_e).sqrt(),
                snr_lowest: counting.snr(lowest),
                snr_mean: counting.snr(mean),
                ..*sums
            }
        };
        self.account.iter().zip(&self.bands).map(finished).collect()
    }

    /// What a reader of the cube must know of it, as sentences: values that are bounds, because they were too bright.
    pub fn remarks(&self) -> Vec<String> {
        let full: Vec<&BandSignal> = self.account.iter().filter(|band| band.saturated > 0).collect();
        let Some(worst) = full.iter().max_by_key(|band| band.saturated) else { return vec![] };
        vec![format!(
            "{} of {} bands have saturated values, which the cube holds as if they were radiances: {} of {} pixels at {} um, where nothing above {:.3e} W m-2 sr-1 um-1 is measured; \
             take a shorter exposure, or less throughput",
            full.len(),
            self.account.len(),
            worst.saturated,
            self.axes.samples * self.axes.lines,
            worst.centre_um,
            worst.brightest
        )]
    }

    /// Images of signal over noise: the mean over bands, the lowest of them, and the share of bands in which it is at least [`GOOD`].
    pub fn snr_planes(&self) -> [Vec<f64>; 3] {
        let share = 1.0 / self.bands.len() as f64;
        let [sum, least, good] = &self.snr;
        [sum.iter().map(|s| s * share).collect(), least.clone(), good.iter().map(|g| g * share).collect()]
    }

    /// Dead elements.
    pub fn dead_elements(&self) -> u64 {
        let CubeAxes { samples, lines, bands, .. } = &self.axes;
        let count = match self.readout {
            Readout::Line => samples * bands.len(),
            Readout::Sample(mirror) => mirror.elements.max(1) as usize * bands.len(),
            Readout::Frame | Readout::Band => samples * lines,
        };
        (0..count as u64).into_par_iter().filter(|i| self.detector.element(*i).is_dead).count() as u64
    }
}
