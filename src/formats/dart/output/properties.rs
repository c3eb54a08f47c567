//! `simulation.properties.txt`: what DART says of its own run, a `key:value` in each line.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::{Location, Problem, Result};
use crate::formats::input;
use crate::spectral::{Band, KnownLight};

/// Its name in `output/`.
pub(super) const FILE: &str = "simulation.properties.txt";
/// Longer files are refused, bytes: there are some hundred lines for a band and for a direction.
const LIMIT: u64 = 1 << 30;

/// A value, or what is wrong with it.
pub(super) type Told<T> = std::result::Result<T, Problem>;

/// A simulation's properties. A key that is there twice has its last value: modules append theirs.
#[derive(Debug, Clone)]
pub(super) struct Properties {
    pub(super) path: PathBuf,
    /// Value and line, from 1.
    values: BTreeMap<String, (String, usize)>,
}

impl Properties {
    /// # Errors
    /// [`Error::Io`](crate::Error::Io); [`Error::Invalid`](crate::Error::Invalid) for a file that is too long.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let bytes = input::bytes(path, LIMIT)?;
        // Names of materials may be in any encoding; keys and numbers are ASCII.
        let text = String::from_utf8_lossy(&bytes);
        let pair = |(i, line): (usize, &str)| {
            let (key, value) = line.split_once(':')?;
            Some((key.trim().to_owned(), (value.trim().to_owned(), i + 1)))
        };
        Ok(Properties { path: path.to_owned(), values: text.lines().enumerate().filter_map(pair).collect() })
    }

    pub(super) fn text(&self, key: &str) -> Option<&str> {
        self.values.get(key).map(|(value, _)| value.as_str())
    }

    pub(super) fn at(&self, key: &str) -> Location {
        match self.values.get(key) {
            Some((_, line)) => Location::line(&self.path, *line),
            None => Location::file(&self.path),
        }
        .with_item(key)
    }

    /// A finite number; `None` if the key is not there.
    pub(super) fn number(&self, key: &str) -> Told<Option<f64>> {
        let Some(text) = self.text(key) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(Problem::new(self.at(key), format!("`{text}` is not a finite number"))),
        }
    }

    /// The first of several keys, as DART's modules and versions call them, that is there.
    pub(super) fn first_number(&self, keys: &[String]) -> Told<Option<f64>> {
        keys.iter().find_map(|key| self.number(key).transpose()).transpose()
    }

    /// A band by its number: the middle, and the full width, of the wavelengths it reaches over.
    pub(super) fn band(&self, number: usize) -> Told<Band> {
        let keys = |end: &str| {
            [format!("dart.band{number}.lambda{end}"), format!("phase.band{number}.lambda{}", end.to_lowercase())]
        };
        let (min, max) = (keys("Min"), keys("Max"));
        let (Some(from_um), Some(to_um)) = (self.first_number(&min)?, self.first_number(&max)?) else {
            let message = format!("does not say which wavelengths band {number} reaches over");
            return Err(
                Problem::new(self.at(&min[0]), message).with_help(format!("`{}` and `{}` belong here", min[0], max[0]))
            );
        };
        if !(0.0 < from_um && from_um <= to_um) {
            let message = format!("a band from {from_um} to {to_um} um: wavelengths ascend, and are above 0");
            return Err(Problem::new(self.at(&min[0]), message));
        }
        let (middle_um, width_um) = (0.5 * (from_um + to_um), to_um - from_um);
        Ok(if width_um > 0.0 { Band::boxed(middle_um, width_um) } else { Band::new(middle_um, None) })
    }

    /// The wavelength to which a band's apparent temperatures refer, um: as DART states since 5.8, else the band's middle.
    pub(super) fn equivalent_um(&self, number: usize, band: &Band) -> Told<f64> {
        let key = format!("dart.band{number}.equivalentWavelength");
        match self.number(&key)? {
            Some(um) if um <= 0.0 => Err(Problem::new(self.at(&key), format!("{um} um is not a wavelength"))),
            Some(um) => Ok(um),
            None => Ok(band.centre_um),
        }
    }

    /// Irradiance at the bottom of the atmosphere on a horizontal plane, W m-2 um-1, if it is there.
    pub(super) fn irradiance_w_m2_um(&self, number: usize) -> Told<Option<f64>> {
        let key = format!("dart.band{number}.BOA.irradiance");
        match self.number(&key)? {
            Some(e) if e < 0.0 => Err(Problem::new(self.at(&key), format!("an irradiance of {e} W m-2 um-1"))),
            other => Ok(other),
        }
    }

    fn mode(&self, number: usize) -> Option<&str> {
        self.text(&format!("dart.band{number}.mode"))
    }

    /// Whether a band's surfaces glow: unless DART says that there is sunlight only.
    pub(super) fn emits(&self, number: usize) -> bool {
        self.mode(number) != Some("R")
    }

    /// What light a band holds, as its mode says: R, T, or R+T.
    pub(super) fn light(&self, number: usize) -> KnownLight {
        let has = |letter: char| self.mode(number).map(|mode| mode.contains(letter));
        KnownLight { sunlight: has('R'), heat: has('T') }
    }

    /// What is known of an image by the first part of its name.
    pub(super) fn image(&self, prefix: &str) -> Told<Option<ImageProperties>> {
        let named = |(key, (value, _)): (&String, &(String, usize))| {
            (value == prefix).then(|| key.strip_suffix(".imageNamePrefix")).flatten().map(str::to_owned)
        };
        let Some(key) = self.values.iter().find_map(named) else { return Ok(None) };
        let angle = |name: &str| {
            let key = format!("{key}.{name}");
            self.number(&key)?
                .ok_or_else(|| Problem::new(self.at(&key), format!("the direction of {prefix} is missing")))
        };
        let is_sensor = self.text(&format!("{key}.isSensorImage")).is_some_and(|v| v != "0");
        Ok(Some(ImageProperties { towards_deg: [angle("teta")?, angle("phi")?], is_sensor }))
    }

    /// Height of the scene's bottom, where the ground corners of images lie, m.
    pub(super) fn bottom_m(&self) -> Told<f64> {
        Ok(self.number("maket.lowerCorner.z")?.unwrap_or(0.0))
    }
}

/// An image, as listed in the properties.
pub(super) struct ImageProperties {
    /// Zenith angle and azimuth of the direction from the scene to the viewer, deg.
    pub(super) towards_deg: [f64; 2],
    /// By a camera, not a parallel view.
    pub(super) is_sensor: bool,
}
