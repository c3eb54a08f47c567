//! Answers about time, rotations and orbits.

use glam::DMat3;
use serde_json::{Value, json};

use super::values::simulate;
use super::{Answer, Oracle};
use crate::flight::{Almanac, Epoch, Hill, J2000, LeapSeconds, Scale, body_name, frame_name};

/// A matrix by rows.
pub(super) fn rows(matrix: DMat3) -> Value {
    json!(matrix.transpose().to_cols_array_2d())
}

impl Oracle<'_> {
    /// The moment that is asked about.
    fn epoch(&self) -> Option<Epoch> {
        Epoch::from_tdb_s((self.input("jd_tdb")? - 2_451_545.0) * 86_400.0)
    }

    pub(super) fn time(&self, kind: &str) -> Option<Vec<Answer>> {
        let utc = self.inputs.get("utc").and_then(Value::as_str)?;
        let epoch = Epoch::parse(utc, Some(Scale::Utc), &LeapSeconds::default()).ok()?;
        (kind == "utc2et").then(|| simulate(epoch.tdb_s()))
    }

    pub(super) fn iau(&self) -> Option<Vec<Answer>> {
        let epoch = self.epoch()?;
        let body = body_name(&format!("{}", self.input("body")?));
        let frame = frame_name(&format!("IAU_{body}"));
        let rotation = Almanac::default().rotation(&frame, J2000, epoch).ok()?;
        // The pole is the last row; the node of the equator is where the meridian is counted from.
        let [x, y, z] = rotation.transpose().to_cols_array_2d();
        let right_ascension = z[1].atan2(z[0]).to_degrees().rem_euclid(360.0);
        let declination = z[2].atan2(z[0].hypot(z[1])).to_degrees();
        let meridian = x[2].atan2(y[2]).to_degrees().rem_euclid(360.0);
        Some(simulate(json!({
            "ra_deg": right_ascension,
            "dec_deg": declination,
            "W_deg": meridian,
            "matrix_icrf_to_fixed": rows(rotation),
        })))
    }

    pub(super) fn qso(&self, kind: &str) -> Option<Vec<Answer>> {
        let hill = Hill { mean_motion_rad_s: self.input("n_rad_s")?, gm_m3_s2: 1e9 * self.input("mu_km3_s2")? };
        let orbit = hill.quasi_satellite(1e3 * self.input("x0_km")?)?;
        let (start, far) = (orbit.start, orbit.farthest);
        let (fast, slow) = (start.velocity_m_s.length(), far.velocity_m_s.length());
        (kind == "planar_qso").then(|| {
            simulate(json!({
                "vy0_m_s": start.velocity_m_s.y,
                "period_s": orbit.period_s,
                "y_max_km": 1e-3 * far.position_m.y.abs(),
                "speed_min_m_s": slow.min(fast),
                "speed_max_m_s": slow.max(fast),
                "jacobi": 1e-6 * hill.jacobi_m2_s2(start),
            }))
        })
    }
}
