//! Bodies of the sky besides Mars.

use super::types::{BodyToml, Values};
use super::{Quantity, TomlReader};
use crate::error::number;
use crate::scene::{Globe, Motion};
use crate::spectral::{Extend, solar_mean};

impl TomlReader<'_> {
    /// All bodies; those that cannot be used are problems. `motion` says where those are that state no position.
    pub(super) fn bodies(&mut self, bodies: &[BodyToml], motion: Option<Option<&Motion>>) -> Vec<Globe> {
        (0..bodies.len()).filter_map(|i| self.body(&format!("bodies[{i}]"), &bodies[i], motion)).collect()
    }

    fn body(&mut self, item: &str, toml: &BodyToml, motion: Option<Option<&Motion>>) -> Option<Globe> {
        // A body that flight dynamics does not know may state where it is, and stays there.
        let placed = match (toml.position_m, motion) {
            (Some(_), Some(Some(motion))) if !motion.knows(&toml.name, motion.start) => None,
            (_, Some(Some(motion))) => Some(self.known(item, motion.seen_m(&toml.name, motion.start))),
            (_, unknown) => unknown.map(|_| None),
        };
        let centre_m = self.place(item, toml.position_m, placed);
        let radius_m = self.positive(&format!("{item}.radius_m"), toml.radius_m);
        let reflectance =
            self.fraction_spectrum(&format!("{item}.albedo"), &toml.albedo, Quantity::Albedo, Extend::Error);
        let bond_item = format!("{item}.bond_albedo");
        let bond_albedo = match (toml.bond_albedo, &toml.albedo, &reflectance) {
            (Some(value), ..) => self.fraction(&bond_item, value),
            (None, Values::Constant(value), _) => Some(self.default(&bond_item, *value)),
            (None, Values::File(_), Some(spectrum)) => {
                let mean = solar_mean(spectrum);
                Some(self.default(&bond_item, mean.unwrap_or(0.0)))
            }
            (None, Values::File(_), None) => None,
        };
        let day_night_k = [toml.day_k, toml.night_k].map(|t_k| t_k.unwrap_or(0.0));
        let exitance_item = format!("{item}.thermal_exitance_w_m2");
        let thermal_exitance_w_m2 = match toml.thermal_exitance_w_m2 {
            Some(value) if value >= 0.0 && value.is_finite() => Some(value),
            Some(value) => {
                self.problem(&exitance_item, format!("{} W m-2 is not a number of at least 0", number(value)));
                None
            }
            None => Some(self.default(&exitance_item, Globe::mean_exitance_w_m2(day_night_k))),
        };
        Some(Globe {
            name: toml.name.clone(),
            centre_m: centre_m? - self.origin_m,
            radius_m: radius_m?,
            reflectance: reflectance?,
            bond_albedo: bond_albedo?,
            thermal_exitance_w_m2: thermal_exitance_w_m2?,
            day_night_k,
        })
    }
}
