//! What cubes with an instrument in them are for: `cargo run --profile quick --example 9c_unmix_and_compress`.
//!
//! Ground of two materials is looked at by a spectrometer like MIRS. First, each pixel is unmixed, and the result compared with what the product knows of
//! it: by how noisy the spectra are, over flat ground and over hills. Second, the numbers that are sent are compressed, and decompressed: bits a sample against
//! what that costs in radiance, and in abundance. Whoever has a better algorithm puts it in place of these; the truth is there for it, too.

#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;
use std::fmt::Write as _;

use mmxrt::formats::Subject;
use mmxrt::instrument::Detector;
use mmxrt::integrate::Wanted;
use mmxrt::product::{Cube, CubeAxes};
use mmxrt::progress::unwatched;
use mmxrt::scene::Readout;
use mmxrt::study::{self, Extremes, Reader};
use mmxrt::{Error, Location, Result, solve};

// MIRS' pixels, optics and detector, but fewer of each; from 20 km a pixel is 7 m.
const SCENE: &str = r#"
mmxrt_scene = 1
origin_m = [0.0, 0.0, 11e3]
mesh = [{ obj = "ground.obj" }]
[materials]
blue = { reflectance = "BLUE" }
red = { reflectance = "RED" }
[sun]
direction = [0.5, 0.3, 1.0]
distance_au = 1.5
[observer]
position_m = [0.0, 0.0, 20e3]
target_m = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
[sensor]
preset = "mirs"
samples = 48
lines = 48
exposure_s = 0.6 # Lambert's ground is bright: in three seconds it would saturate
bands = { start_um = 0.9, stop_um = 2.4, count = 31, fwhm_um = 0.02 }
"#;

/// Quads along a side of the ground, each 7.3 m wide: borders of materials fall anywhere in a pixel.
const QUADS: u32 = 60;

/// Hills of this height, m, of two units that wind through each other.
fn ground(height_m: f64) -> String {
    let place_m = |i: u32| (f64::from(i) - 0.5 * f64::from(QUADS)) * 7.3;
    let mut obj = String::new();
    for (x, y) in (0..=QUADS).flat_map(|j| (0..=QUADS).map(move |i| (place_m(i), place_m(j)))) {
        let _ = writeln!(obj, "v {x} {y} {}", height_m * (0.05 * x).sin() * (0.04 * y).cos());
    }
    for (i, j) in (0..QUADS).flat_map(|j| (0..QUADS).map(move |i| (i, j))) {
        let (x, y) = (place_m(i), place_m(j));
        let unit = if (0.021 * x + (0.03 * y).sin()).sin() > 0.0 { "blue" } else { "red" };
        let first = j * (QUADS + 1) + i + 1;
        let above = first + QUADS + 1;
        let _ = writeln!(obj, "usemtl {unit}\nf {first} {} {} {above}", first + 1, above + 1);
    }
    obj
}

/// A cube before the detector, and how much of each pixel is blue.
struct Look {
    cube: Cube,
    blue: Vec<f64>,
    detector: Detector,
}

fn look(height_m: f64, is_blurred: bool) -> Result<Look> {
    let site = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/phobos_site");
    let text = SCENE.replace("BLUE", &format!("{site}/blue_unit.csv")).replace("RED", &format!("{site}/red_unit.csv"));
    let folder = std::env::temp_dir().join(format!("mmxrt_example_{}", std::process::id()));
    let io = |e| Error::io(&folder, "writing", e);
    std::fs::create_dir_all(&folder).map_err(io)?;
    for (name, text) in [("ground.obj", ground(height_m)), ("scene.toml", text)] {
        std::fs::write(folder.join(name), text).map_err(io)?;
    }
    let subject = Subject::open(&folder.join("scene.toml"), &unwatched)?;
    std::fs::remove_dir_all(&folder).map_err(io)?;

    let (scene, chain) = (&subject.scene, subject.chain.unwrap_or_default());
    let table = solve::solve(scene, &unwatched)?;
    let mut slabs = Vec::new();
    let mut put = |slab| {
        slabs.push(slab);
        Ok(())
    };
    let optics = chain.optics.as_ref().filter(|_| is_blurred);
    let of = (&table, &Extremes::new(scene));
    let seen = study::observe_through(scene, of, optics, Wanted::default(), &mut put, &unwatched)?;
    let plane = |name: &str| seen.backplanes.plane(name).map(|plane| plane.values.clone()).unwrap_or_default();
    let (blue, red) = (plane("ABUNDANCE blue"), plane("ABUNDANCE red"));
    Ok(Look {
        cube: Cube::new(CubeAxes::of(&scene.exposure), slabs)?,
        blue: blue.iter().zip(&red).map(|(blue, red)| blue / (blue + red)).collect(),
        detector: chain.detector.expect("the preset has one"),
    })
}

impl Look {
    /// What the detector sends and what that is taken for, [band][pixel], if it gathers light so many times as long; and signal over noise, the mean over bands.
    fn read(&self, times: f64) -> Result<([Vec<Vec<f64>>; 2], f64)> {
        let detector = Detector { exposure_s: times * self.detector.exposure_s, ..self.detector.clone() };
        let mut reader = Reader::new(&detector, self.cube.axes.clone(), (Readout::Frame, 0))?;
        let [mut sent, mut taken_for] = [Vec::new(), Vec::new()];
        for slab in self.cube.slabs() {
            reader.read(slab, |reading| {
                sent.push(reading.numbers);
                taken_for.push(reading.radiance);
                Ok(())
            })?;
        }
        let account = reader.account();
        let snr = account.iter().map(|band| band.snr_mean).sum::<f64>() / account.len() as f64;
        let [sent, taken_for] = [sent, taken_for].map(|slabs| Cube::new(self.cube.axes.clone(), slabs));
        Ok(([bands(&sent?), bands(&taken_for?)], snr))
    }

    /// Error of unmixed abundances, rms over all pixels. `spectra` are those of blue and red.
    fn abundance_error(&self, spectra: &[Vec<f64>; 2], radiance: &[Vec<f64>]) -> f64 {
        let of_pixel = |(pixel, truth): (usize, &f64)| {
            let measured: Vec<f64> = radiance.iter().map(|band| band[pixel]).collect();
            (unmixed(spectra, &measured) - truth).powi(2)
        };
        (self.blue.iter().enumerate().map(of_pixel).sum::<f64>() / self.blue.len() as f64).sqrt()
    }

    /// The spectra of both materials: of pixels that show one alone, without noise.
    fn spectra(&self) -> [Vec<f64>; 2] {
        let all = bands(&self.cube);
        [1.0, 0.0].map(|share| {
            let pure = |pixel: &usize| (self.blue[*pixel] - share).abs() < 1e-9;
            let pixels: Vec<usize> = (0..self.blue.len()).filter(pure).collect();
            all.iter().map(|band| pixels.iter().map(|pixel| band[*pixel]).sum::<f64>() / pixels.len() as f64).collect()
        })
    }
}

fn bands(cube: &Cube) -> Vec<Vec<f64>> {
    (0..cube.axes.bands.len()).map(|band| cube.band(band)).collect()
}

/// The share of the first of two spectra, by least squares without negative amounts; amounts are what they are of their sum, since how bright the
/// ground is depends on its slope.
fn unmixed([a, b]: &[Vec<f64>; 2], measured: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let (aa, ab, bb, am, bm) = (dot(a, a), dot(a, b), dot(b, b), dot(a, measured), dot(b, measured));
    let amounts = [bb * am - ab * bm, aa * bm - ab * am].map(|amount| amount.max(0.0));
    // Where one would be negative, the other is there alone.
    if amounts[0] + amounts[1] > 0.0 { amounts[0] / (amounts[0] + amounts[1]) } else { 0.5 }
}

/// Samples of a cube as a coder sees them, and what it has learnt of the band at hand.
struct Coder {
    samples: usize,
    /// Bands as whoever decodes them has them: complete ones, and the beginning of the last.
    restored: Vec<Vec<f64>>,
    weights: [f64; BEFORE],
    /// No number is off by more.
    most_off: f64,
}

/// Bands before that foretell one.
const BEFORE: usize = 3;
/// How fast weights follow.
const PACE: f64 = 0.01;

/// A stand-in for CCSDS 123.0-B-2, not that standard: as there, a sample is predicted from its neighbours and from bands before it by weights that adapt, and what the prediction is off by
/// is rounded to steps in a closed loop. Weights and sums are of plain floating-point numbers, and the entropy of what is left stands for an entropy coder.
impl Coder {
    fn new(samples: usize, most_off: f64) -> Self {
        Coder { samples, restored: vec![], weights: [0.0; BEFORE], most_off }
    }

    fn new_band(&mut self) {
        self.restored.push(vec![]);
        self.weights = [1.0, 0.0, 0.0];
    }

    /// The mean of neighbours that come before a pixel in a band.
    fn around(&self, band: usize, pixel: usize) -> Option<f64> {
        let (sample, values) = (pixel % self.samples, &self.restored[band]);
        let west = (sample > 0).then(|| values[pixel - 1]);
        let Some(above) = pixel.checked_sub(self.samples) else { return west };
        let north_west = (sample > 0).then(|| values[above - 1]);
        let north_east = (sample + 1 < self.samples).then(|| values[above + 1]);
        let there: Vec<f64> = [west, north_west, Some(values[above]), north_east].into_iter().flatten().collect();
        Some(there.iter().sum::<f64>() / there.len() as f64)
    }

    /// Goes on by a sample: `step` says by how many steps it is off what is predicted, which is returned.
    fn next(&mut self, step: impl FnOnce(f64) -> f64) -> f64 {
        let band = self.restored.len() - 1;
        let pixel = self.restored[band].len();
        let around = self.around(band, pixel);
        // By how much bands before differ there from what is around them.
        let mut differ = [0.0; BEFORE];
        for (differ, before) in differ.iter_mut().zip((0..band).rev()) {
            *differ = self.restored[before][pixel] - self.around(before, pixel).unwrap_or(0.0);
        }
        let foretold: f64 = differ.iter().zip(&self.weights).map(|(d, w)| d * w).sum();
        let predicted = (around.unwrap_or(0.0) + foretold).round();
        let steps = step(predicted);
        let restored = predicted + steps * (2.0 * self.most_off + 1.0);
        self.restored[band].push(restored);
        let size: f64 = differ.iter().map(|d| d * d).sum();
        if size > 0.0 && around.is_some() {
            let off = restored - around.unwrap_or(0.0) - foretold;
            self.weights.iter_mut().zip(differ).for_each(|(weight, d)| *weight += PACE * off * d / size);
        }
        steps
    }
}

/// For each band the steps that are sent.
fn compressed(numbers: &[Vec<f64>], samples: usize, most_off: f64) -> Vec<Vec<i64>> {
    let mut coder = Coder::new(samples, most_off);
    let mut of_band = |band: &Vec<f64>| {
        coder.new_band();
        let step = |value: f64| move |predicted: f64| ((value - predicted) / (2.0 * most_off + 1.0)).round();
        #[expect(clippy::cast_possible_truncation, reason = "a whole number of 17 bits")]
        band.iter().map(|value| coder.next(step(*value)) as i64).collect()
    };
    numbers.iter().map(&mut of_band).collect()
}

fn decompressed(steps: &[Vec<i64>], samples: usize, most_off: f64) -> Vec<Vec<f64>> {
    let mut coder = Coder::new(samples, most_off);
    for band in steps {
        coder.new_band();
        band.iter().for_each(|steps| _ = coder.next(|_| *steps as f64));
    }
    coder.restored
}

/// Bits a sample: what the best code for the steps of each band takes, without its table.
fn bits(steps: &[Vec<i64>]) -> f64 {
    let of_band = |band: &Vec<i64>| {
        let mut counts: BTreeMap<i64, u32> = BTreeMap::new();
        band.iter().for_each(|step| *counts.entry(*step).or_default() += 1);
        let share = |count: u32| f64::from(count) / band.len() as f64;
        -counts.into_values().map(|count| share(count) * share(count).log2()).sum::<f64>()
    };
    steps.iter().map(of_band).sum::<f64>() / steps.len() as f64
}

/// Collects what does not hold.
#[derive(Default)]
struct Checks(Vec<String>);

impl Checks {
    fn holds(&mut self, holds: bool, what: impl Into<String>) {
        if !holds {
            self.0.push(what.into());
        }
    }
}

fn unmixing(flat: &Look, hills: &Look, checks: &mut Checks) -> Result<()> {
    println!("Unmixing: signal over noise, and rms error of abundances");
    println!("{:>8} {:>12} {:>12}", "SNR", "flat, sharp", "hills");
    let spectra = [flat.spectra(), hills.spectra()];
    let mut last = [1.0, 1.0];
    for exposure in [1.0 / 256.0, 1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0, 1.0] {
        let (([_, of_flat], snr), ([_, of_hills], _)) = (flat.read(exposure)?, hills.read(exposure)?);
        let errors = [flat.abundance_error(&spectra[0], &of_flat), hills.abundance_error(&spectra[1], &of_hills)];
        println!("{snr:8.1} {:12.4} {:12.4}", errors[0], errors[1]);
        checks.holds(errors[0] < last[0] && errors[1] < last[1], format!("errors fall with SNR {snr}"));
        last = errors;
    }
    let errors = [flat, hills].map(|look| look.abundance_error(&look.spectra(), &bands(&look.cube)));
    println!("{:>8} {:12.1e} {:12.4}", "infinite", errors[0], errors[1]);
    // Radiance over flat ground is the mean of what materials send by their areas, and nothing else. Over hills what faces the Sun counts for more than its area,
    // and optics mix in what is beside.
    checks.holds(errors[0] < 1e-9, "flat ground without noise is unmixed exactly");
    checks.holds(errors[1] < 0.05 && errors[1] < last[1], "hills without noise are unmixed to 0.05");
    Ok(())
}

fn compression(hills: &Look, checks: &mut Checks) -> Result<()> {
    let CubeAxes { samples, bands: axis, .. } = &hills.cube.axes;
    let ([numbers, radiance], snr) = hills.read(1.0)?;
    let spectra = hills.spectra();
    // Of each band what a number more stands for, and noise.
    let counting = axis.iter().map(|band| hills.detector.counting(band)).collect::<Option<Vec<_>>>();
    let counting = counting.expect("all bands have a width");
    let per_number: Vec<f64> = counting.iter().map(|band| band.radiance(1.0) - band.radiance(0.0)).collect();
    let widest = per_number.iter().copied().fold(0.0, f64::max);
    let count = (numbers.len() * hills.blue.len()) as f64;
    let noise = (radiance.iter().flatten().sum::<f64>() / count) / snr;

    println!("\nCompression by a stand-in for CCSDS-123: of numbers of {} bits at SNR {snr:.0}", hills.detector.bits);
    println!(
        "{:>8} {:>8} {:>14} {:>14} {:>10} {:>10}",
        "most off", "bits", "largest error", "rms error", "of noise", "abundance"
    );
    println!(
        "{:>8} {:>8} {:>14} {:>14} {:>10} {:>10}",
        "DN", "/sample", "W/m2/sr/um", "W/m2/sr/um", "rms", "rms error"
    );
    let mut lossless = 0.0;
    for most_off in [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0] {
        let steps = compressed(&numbers, *samples, most_off);
        let restored = decompressed(&steps, *samples, most_off);
        let bits = bits(&steps);
        let errors = |band: usize| restored[band].iter().zip(&numbers[band]).map(|(a, b)| (a - b).abs());
        let largest =
            (0..numbers.len()).map(|band| per_number[band] * errors(band).fold(0.0, f64::max)).fold(0.0, f64::max);
        let squares = (0..numbers.len()).map(|band| errors(band).map(|e| (per_number[band] * e).powi(2)).sum::<f64>());
        let rms = (squares.sum::<f64>() / count).sqrt();
        let taken_for: Vec<Vec<f64>> = (restored.iter().zip(&counting))
            .map(|(band, counting)| band.iter().map(|number| counting.radiance(*number)).collect())
            .collect();
        let abundance = hills.abundance_error(&spectra, &taken_for);
        println!("{most_off:8} {bits:8.3} {largest:14.3e} {rms:14.3e} {:10.3} {abundance:10.4}", rms / noise);

        let off = (0..numbers.len()).flat_map(errors).fold(0.0, f64::max);
        checks.holds(off <= most_off, format!("no number is off by more than {most_off}: {off}"));
        checks.holds(largest <= most_off * widest * (1.0 + 1e-9), format!("radiance is off by what {most_off} DN are"));
        // Errors spread evenly over the whole numbers from -m to m have the variance m (m + 1) / 3.
        let even = (most_off * (most_off + 1.0) / 3.0).sqrt();
        let spread = ((0..numbers.len()).flat_map(errors).map(|e| e * e).sum::<f64>() / count).sqrt();
        checks.holds(
            (spread - even).abs() <= 0.05 * even,
            format!("errors spread evenly at {most_off}: {spread}, {even}"),
        );
        // Steps of 2 m + 1 take log2 of that off each sample, as long as noise is wider.
        let saved = (2.0 * most_off + 1.0).log2();
        if most_off == 0.0 {
            lossless = bits;
            checks.holds(bits < f64::from(hills.detector.bits), "there is less in it than bits that are sent");
        } else if most_off <= 4.0 {
            checks.holds(
                (lossless - bits - saved).abs() < 0.2,
                format!("{most_off} saves {saved} of {lossless}: {bits}"),
            );
        }
    }
    Ok(())
}

fn main() -> Result<()> {
    let (flat, hills) = (look(0.0, false)?, look(4.0, true)?);
    let mut checks = Checks::default();
    unmixing(&flat, &hills, &mut checks)?;
    compression(&hills, &mut checks)?;
    match checks.0.is_empty() {
        true => Ok(()),
        false => Err(Error::invalid(Location::item("example"), checks.0.join("; "))),
    }
}
