//! Oracles that ask what kernels of SPICE say.

use glam::DMat3;
use serde_json::{Value, json};

use super::values::simulate;
use super::{Answer, Oracle};
use crate::flight::{Almanac, Correction, Epoch, J2000};
use crate::geometry::angle_rad;

const KM_M: f64 = 1000.0;

/// What gives an almanac of the kernels of these names, if they are there.
pub type Kernels<'a> = dyn Fn(&[&str]) -> Option<Almanac> + 'a;

impl Oracle<'_> {
    pub(super) fn spk(&self) -> Option<Vec<Answer>> {
        let almanac = (self.files?.kernels)(&[self.inputs.get("file")?.as_str()?])?;
        let [target, centre] = ["target", "center"].map(|key| Some(self.inputs.get(key)?.as_i64()?.to_string()));
        // A Julian date as one number is off by up to 20 us, in which Mars goes half a metre: the name has it in two, as in "2451545-0.3".
        let in_name = self.name.rsplit_once("2451545").and_then(|(_, days)| days.trim_end_matches(')').parse().ok());
        let days = in_name.or_else(|| Some(self.input("jd_tdb")? - 2_451_545.0))?;
        let epoch = Epoch::from_tdb_s(days * 86_400.0)?;
        let state = almanac.state(&target?, &centre?, J2000, epoch).ok()?;
        Some(simulate(json!({
            "position_km": (state.position_m / KM_M).to_array(),
            "velocity_km_s": (state.velocity_m_s / KM_M).to_array(),
        })))
    }

    pub(super) fn spice(&self, kind: &str) -> Option<Vec<Answer>> {
        let names: Vec<&str> = self.inputs.get("kernels")?.as_array()?.iter().filter_map(Value::as_str).collect();
        let almanac = (self.files?.kernels)(&names)?;
        let (target, centre) = kind.split_once("_rel_")?;
        let epoch = match (self.input("et"), self.inputs.get("utc").and_then(Value::as_str)) {
            (Some(tdb_s), _) => Epoch::from_tdb_s(tdb_s)?,
            (None, utc) => Epoch::parse(utc?, Some(crate::flight::Scale::Utc), &almanac.leap).ok()?,
        };
        let fixed = format!("IAU_{target}");
        let state = almanac.state(target, centre, J2000, epoch).ok()?;
        let rows = |rotation: DMat3| rotation.transpose().to_cols_array_2d();
        let sun = |correction| almanac.apparent("SUN", target, &fixed, epoch, correction).ok();
        let [geometric, apparent] = [Correction::None, Correction::LightTimeAndAberration].map(|of| Some(sun(of)?.0));
        let between = geometric.zip(apparent).map(|(a, b)| angle_rad(a, b).to_degrees());
        let km = |at: Option<glam::DVec3>| at.map(|at_m| (at_m / KM_M).to_array());
        let state_km = [state.position_m / KM_M, state.velocity_m_s / KM_M].map(|v| v.to_array()).concat();
        Some(simulate(json!({
            "et": epoch.tdb_s(),
            "state_km_kms": state_km,
            "lt_s": almanac.apparent(target, centre, J2000, epoch, Correction::None).ok()?.1,
            (format!("J2000_to_{fixed}")): rows(almanac.rotation(&fixed, J2000, epoch).ok()?),
            (format!("sun_from_{}_IAU_km", target.to_lowercase())): km(geometric),
            "sun_LTS_km": km(apparent),
            "lts_minus_geometric_deg": between,
        })))
    }
}
