//! Sources of stated irradiance: lamps, and a Sun that is one.

use glam::DVec3;

use super::types::{Frame, LampToml, Values};
use super::{Quantity, TomlReader};
use crate::geometry::Direction;
use crate::scene::{Beam, out_of_irradiances};
use crate::spectral::{Extend, Spectrum};

impl TomlReader<'_> {
    /// All lamps; those that cannot be used are problems.
    pub(super) fn lamps(&mut self, lamps: &[LampToml]) -> Vec<Beam> {
        (0..lamps.len()).filter_map(|i| self.lamp(&format!("lamps[{i}]"), &lamps[i])).collect()
    }

    fn lamp(&mut self, item: &str, toml: &LampToml) -> Option<Beam> {
        let direction = self.lamp_direction(item, toml);
        let light = self.stated_irradiance(item, &toml.irradiance, toml.total_irradiance_w_m2);
        let (irradiance, total_irradiance_w_m2) = light?;
        Some(Beam { name: toml.name.clone(), direction: direction?, irradiance, total_irradiance_w_m2 })
    }

    fn lamp_direction(&mut self, item: &str, toml: &LampToml) -> Option<Direction> {
        let given = DVec3::from_array(toml.direction);
        let given = match toml.frame {
            Some(Frame::Site) => self.body_from_site(&format!("{item}.frame"), "the frame of a site")? * given,
            _ => given,
        };
        let direction = Direction::from_unit(given).or_else(|| Direction::new(given));
        if direction.is_none() {
            self.problem(&format!("{item}.direction"), "has no length");
        }
        direction
    }

    /// Irradiance normal to a beam, and its total, W m-2: as stated, else the integral of a table; a number for all wavelengths has none.
    pub(super) fn stated_irradiance(
        &mut self,
        item: &str,
        values: &Values,
        total_w_m2: Option<f64>,
    ) -> Option<(Spectrum, f64)> {
        let at = format!("{item}.irradiance");
        let irradiance = match values {
            Values::Constant(value) => Spectrum::constant(*value),
            Values::File(name) => self.spectrum_file(&at, name, Quantity::Irradiance, Extend::Error)?,
        };
        if let Some(message) = irradiance.value().iter().find_map(|value| out_of_irradiances(*value)) {
            self.problem(&at, message);
            return None;
        }
        let total_item = format!("{item}.total_irradiance_w_m2");
        if let Some(total) = total_w_m2 {
            if let Some(message) = out_of_irradiances(total) {
                self.problem(&total_item, message);
                return None;
            }
            return Some((irradiance, total));
        }
        let (first, last) = irradiance.coverage_um();
        let of_table = matches!(values, Values::File(_)).then(|| irradiance.integral(first, last)).flatten();
        Some((irradiance, self.default(&total_item, of_table.unwrap_or(0.0))))
    }
}
