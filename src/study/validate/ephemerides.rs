//! Oracles of files of flight dynamics: what an almanac says between the rows of the file that an oracle names.

use serde_json::{Value, json};

use super::values::simulate;
use super::{Answer, Oracle};
use crate::flight::{Epoch, Scale};

impl Oracle<'_> {
    /// The state of what the file is about, or the rotation that it knows, at a moment.
    pub(super) fn ephemeris(&self) -> Option<Vec<Answer>> {
        let almanac = (self.files?.kernels)(&[self.inputs.get("file")?.as_str()?])?;
        let utc = self.inputs.get("utc").and_then(Value::as_str);
        let epoch = match utc {
            Some(utc) => Epoch::parse(utc, Some(Scale::Utc), &almanac.leap).ok()?,
            None => Epoch::from_tdb_s(self.input("et_tdb")?)?,
        };
        if self.expected.get("state_km_kms").is_some() {
            let of = almanac.trajectories.last()?;
            let state = almanac.state(&of.target, &of.centre, &of.frame, epoch).ok()?;
            let km: Vec<f64> =
                [state.position_m, state.velocity_m_s].iter().flat_map(|v| (*v / 1000.0).to_array()).collect();
            return Some(simulate(json!({ "state_km_kms": km })));
        }
        let of = almanac.orientations.last()?;
        let rotation = almanac.rotation(&of.frame, &of.base, epoch).ok()?;
        let rows: Vec<[f64; 3]> = (0..3).map(|i| rotation.row(i).to_array()).collect();
        Some(simulate(json!({ "J2000_to_SC": rows })))
    }
}
