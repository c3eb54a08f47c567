//! What the instrument makes of the radiance before it: `[sensor.optics]` and `[sensor.detector]`.

use super::TomlReader;
use super::chain_types::{BackgroundToml, DetectorToml, OpticsToml, PointSpreadToml, WarmToml};
use super::types::{Preset, SensorToml};
use crate::error::number;
use crate::formats::registry;
use crate::formats::spectrum_csv::Quantity;
use crate::instrument::{Chain, Detector, Lens, Optics, PointSpread};
use crate::physics::{mtf, signal};
use crate::scene::Timing;
use crate::spectral::{Extend, Spectrum};

/// What is sent for no electrons, in standard deviations of the noise of reading, where nothing says so: noise then goes below it only once in 3e6 values.
const OFFSET_SIGMA: f64 = 5.0;

/// What a file says of an instrument.
pub(in crate::formats) struct Said<'t> {
    /// What its keys begin with.
    pub(in crate::formats) at: &'static str,
    pub(in crate::formats) preset: Option<Preset>,
    pub(in crate::formats) f_number: Option<f64>,
    pub(in crate::formats) pixel_um: Option<f64>,
    pub(in crate::formats) exposure_s: Option<f64>,
    pub(in crate::formats) optics: Option<&'t OpticsToml>,
    pub(in crate::formats) detector: Option<&'t DetectorToml>,
}

impl TomlReader<'_> {
    /// What a scene's instrument does, if it does anything.
    pub(super) fn sensor_chain(&mut self, toml: &SensorToml, timing: Option<Timing>) -> Option<Chain> {
        if toml.ideal == Some(true) {
            for (key, given) in [("optics", toml.optics.is_some()), ("detector", toml.detector.is_some())] {
                if given {
                    self.note(&format!("sensor.{key}"), "not used: `sensor.ideal` says so");
                }
            }
            return None;
        }
        self.chain(&Said {
            at: "sensor.",
            preset: toml.preset,
            f_number: toml.f_number,
            pixel_um: toml.pixel_um,
            exposure_s: timing.map(|timing| timing.exposure_s).filter(|s| *s > 0.0),
            optics: toml.optics.as_ref(),
            detector: toml.detector.as_ref(),
        })
    }

    /// What an instrument does, if it does anything: what the text says, over what is known of a preset.
    pub(in crate::formats) fn chain(&mut self, said: &Said<'_>) -> Option<Chain> {
        let at = said.at;
        let preset = said.preset.map(Preset::instrument);
        if let Some(instrument) = preset.filter(|_| said.optics.is_none() && said.detector.is_none()) {
            let message = format!("those of {}: {}", instrument.name, instrument.chain_told());
            self.stated(&format!("{at}optics, {at}detector"), message);
        }
        let f_number = said.f_number.or(preset.map(|of| of.f_number));
        let pixel_um = said.pixel_um.or(preset.map(|of| of.pixel_um));
        let lens = f_number.zip(pixel_um).map(|(f_number, pixel_um)| Lens { f_number, pixel_um });
        let optics = match (said.optics, preset) {
            (Some(optics), _) => Some(self.blurring(at, optics, lens)?),
            (None, preset) => preset.map(|of| of.optics(lens)),
        };
        let detector = match (said.detector, preset) {
            (None, None) => None,
            (given, _) => {
                let exposure_s = said.exposure_s.or(preset.and_then(|of| of.period_s));
                Some(self.counting(at, given, preset.map(|of| of.detector()), lens.zip(exposure_s))?)
            }
        };
        let problems = [
            optics.as_ref().map(|optics| optics.problems(&format!("{at}optics"))),
            detector.as_ref().map(|detector| detector.problems(&format!("{at}detector"))),
        ];
        for problem in problems.into_iter().flatten().flatten() {
            let item = problem.at.item.clone().unwrap_or_default();
            self.problem(&item, problem.message);
        }
        let chain = Chain { optics: optics.map(Optics::on_grid), detector };
        (!chain.is_ideal()).then_some(chain)
    }

    fn blurring(&mut self, at: &str, toml: &OpticsToml, lens: Option<Lens>) -> Option<Optics> {
        if toml.diffraction == Some(true) && lens.is_none() {
            self.problem(&format!("{at}optics.diffraction"), format!("needs `{at}f_number` and `{at}pixel_um`"));
            return None;
        }
        if toml.gaussian_px.is_some() && toml.gaussian_mtf_nyquist.is_some() {
            self.problem(
                &format!("{at}optics.gaussian_mtf_nyquist"),
                "does not go with `gaussian_px`: give one of them",
            );
            return None;
        }
        let plain = Optics::default();
        let measured = match &toml.point_spread {
            Some(spread) => Some(self.point_spread(&format!("{at}optics.point_spread.file"), spread)?),
            None => None,
        };
        Some(Optics {
            lens: lens.filter(|_| toml.diffraction != Some(false)),
            gaussian_px: toml.gaussian_px.or(toml.gaussian_mtf_nyquist.map(mtf::sigma_px)).unwrap_or(0.0),
            jitter_px: toml.jitter_px.unwrap_or(0.0),
            smear_px: toml.smear_px.unwrap_or_default(),
            measured,
            stray: toml.stray.unwrap_or(0.0),
            subpixels: toml.subpixels.unwrap_or(plain.subpixels),
            reach_px: toml.reach_px.unwrap_or(plain.reach_px),
        })
    }

    fn point_spread(&mut self, item: &str, toml: &PointSpreadToml) -> Option<PointSpread> {
        let path = self.path(&toml.file);
        let mut raster = self.taken(item, registry::image(&path))?;
        if raster.take_image(None).is_err() || raster.bands.len() != 1 {
            self.problem(item, format!("{} has {} bands: one is wanted", path.display(), raster.bands.len()));
            return None;
        }
        let mut values = Vec::new();
        self.taken(item, raster.read(0, &mut values))?;
        let inputs = self.taken(item, raster.inputs())?;
        self.inputs.extend(inputs);
        if values.iter().any(|value| !value.is_finite()) {
            self.problem(item, "not all of its values are numbers");
            return None;
        }
        Some(PointSpread { samples: raster.columns, values, step_px: toml.step_px })
    }

    fn counting(
        &mut self,
        at: &str,
        toml: Option<&DetectorToml>,
        preset: Option<Detector>,
        light: Option<(Lens, f64)>,
    ) -> Option<Detector> {
        let none = DetectorToml::default();
        let toml = toml.unwrap_or(&none);
        let Some((lens, exposure_s)) = light else {
            self.problem(
                &format!("{at}detector"),
                format!("needs `{at}f_number`, `{at}pixel_um` and `{at}exposure_s`: how much light it gets"),
            );
            return None;
        };
        let throughput = match (&toml.throughput, &preset) {
            (Some(values), _) => {
                self.fraction_spectrum(&format!("{at}detector.throughput"), values, Quantity::Throughput, Extend::Error)
            }
            (None, Some(preset)) => Some(preset.throughput.clone()),
            (None, None) => {
                self.problem(&format!("{at}detector"), "`throughput` is missing: electrons per photon that enters");
                None
            }
        };
        let Some(gain_e_dn) = toml.gain_e_dn.or(preset.as_ref().map(|of| of.gain_e_dn)) else {
            self.problem(&format!("{at}detector"), "`gain_e_dn` is missing: electrons per DN");
            return None;
        };
        let of_preset = |value: fn(&Detector) -> f64| preset.as_ref().map_or(0.0, value);
        let background_e_s = match &toml.background {
            None => of_preset(|of| of.background_e_s),
            Some(BackgroundToml::Electrons(e_s)) => *e_s,
            Some(BackgroundToml::Warm(WarmToml { temperature_k, emissivity, to_um })) => {
                let etendue_m2_sr = signal::etendue_m2_sr(lens.pixel_um * 1e-6, lens.f_number);
                let e_s = signal::background_electrons_s(*temperature_k, *emissivity, etendue_m2_sr, *to_um);
                self.stated(&format!("{at}detector.background"), format!("{} electrons per second", number(e_s)));
                e_s
            }
        };
        let read_e = toml.read_e.unwrap_or(of_preset(|of| of.read_e));
        let bits = toml.bits.or(preset.as_ref().map(|of| of.bits)).unwrap_or(16);
        let all_e = gain_e_dn * 2.0_f64.powi(bits.cast_signed());
        let offset_dn = toml.offset_dn.or(preset.as_ref().map(|of| of.offset_dn)).unwrap_or_else(|| {
            let most_dn = 2.0_f64.powi(bits.cast_signed()) - 1.0;
            let offset_dn = (OFFSET_SIGMA * read_e / gain_e_dn).ceil().min((0.5 * most_dn).floor());
            if offset_dn > 0.0 {
                let what = format!(
                    "{offset_dn}: {OFFSET_SIGMA} times the noise of reading, so that faint light is not cut off"
                );
                self.stated(&format!("{at}detector.offset_dn"), what);
            }
            offset_dn
        });
        Some(Detector {
            lens,
            throughput: throughput?,
            exposure_s,
            width_um: toml.width_um.or(preset.as_ref().and_then(|of| of.width_um)),
            dark_e_s: toml.dark_e_s.unwrap_or(of_preset(|of| of.dark_e_s)),
            background_e_s,
            read_e,
            full_well_e: toml.full_well_e.or(preset.as_ref().map(|of| of.full_well_e)).unwrap_or(all_e),
            gain_e_dn,
            offset_dn,
            bits,
            prnu: toml.prnu.unwrap_or(of_preset(|of| of.prnu)),
            dead_fraction: toml.dead_fraction.unwrap_or(of_preset(|of| of.dead_fraction)),
            seed: toml.seed.unwrap_or(1),
        })
    }
}

impl super::instruments::Instrument {
    /// What is assumed of its optics.
    fn optics(&self, lens: Option<Lens>) -> Optics {
        Optics { lens, gaussian_px: mtf::sigma_px(self.gaussian_mtf_nyquist), ..Optics::default() }
    }

    /// What is assumed of its detector, but for light and time.
    fn detector(&self) -> Detector {
        Detector {
            lens: Lens { f_number: self.f_number, pixel_um: self.pixel_um },
            throughput: Spectrum::constant(self.throughput),
            exposure_s: 1.0,
            width_um: self.width_um,
            dark_e_s: self.reading.dark_e_s,
            background_e_s: 0.0,
            read_e: self.reading.read_e,
            full_well_e: self.reading.full_well_e,
            gain_e_dn: self.reading.gain_e_dn,
            offset_dn: self.reading.offset_dn,
            bits: self.reading.bits,
            prnu: self.reading.prnu,
            dead_fraction: 0.0,
            seed: 1,
        }
    }

    /// That, in words.
    fn chain_told(&self) -> String {
        format!(
            "f/{}, pixels of {} um, a Gaussian that passes {} at Nyquist, throughput {}, {} dark electrons a second, {} read, {} a step, {} bits: assumed but for the pixels; \
             `ideal = true` leaves them out",
            self.f_number,
            self.pixel_um,
            self.gaussian_mtf_nyquist,
            self.throughput,
            self.reading.dark_e_s,
            self.reading.read_e,
            self.reading.gain_e_dn,
            self.reading.bits
        )
    }
}
