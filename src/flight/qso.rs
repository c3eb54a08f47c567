//! Quasi-satellite orbits about Phobos by name.

use glam::DVec3;

use super::hill::{Hill, QuasiSatellite};
use super::radii::{altitude_m, radii_m};
use super::trajectory::{Path, Segment, Span, Trajectory};
use super::{Epoch, State, body_name};

/// Tolerance of the second number of a name, km: names have whole kilometres.
const NAME_KM: f64 = 0.75;

/// A quasi-satellite orbit by its size, e.g. `qso-20x27`: 20 km from Phobos on the line to Mars, 27 km along its orbit.
/// A third number, as in `3d-qso-30x49x20`, is the starting height above Phobos' equator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Qso {
    /// On the line to Mars, m.
    pub x0_m: f64,
    /// Above the equator, m.
    pub height_m: f64,
    found: QuasiSatellite,
}

impl Qso {
    /// Those of the mission: QSO-LC, LB, LA, M and H, and two 3D ones.
    pub const NAMES: [&str; 7] =
        ["qso-20x27", "qso-22x31", "qso-30x49", "qso-50x94", "qso-100x198", "3d-qso-30x49x20", "3d-qso-50x94x30"];

    /// By its name; any size will do.
    ///
    /// # Errors
    /// What is wrong with the name, as a sentence.
    pub fn named(name: &str) -> Result<Self, String> {
        let expected = || format!("{name:?}: expected a quasi-satellite orbit as {}", Self::NAMES.join(", "));
        let (sizes, is_3d) = match (name.strip_prefix("qso-"), name.strip_prefix("3d-qso-")) {
            (Some(sizes), _) => (sizes, false),
            (_, Some(sizes)) => (sizes, true),
            _ => return Err(expected()),
        };
        let km: Option<Vec<f64>> =
            sizes.split('x').map(|size| size.parse().ok().filter(|km| (0.0..1000.0).contains(km))).collect();
        let (x0_km, y_km, height_km) = match (km.as_deref(), is_3d) {
            (Some([x0, y]), false) => (*x0, *y, 0.0),
            (Some([x0, y, height]), true) => (*x0, *y, *height),
            _ => return Err(expected()),
        };
        let altitude_m = radii_m("PHOBOS").map(|radii_m| altitude_m(DVec3::new(x0_km, 0.0, height_km) * 1e3, radii_m));
        if altitude_m.is_some_and(|altitude_m| altitude_m.is_nan() || altitude_m <= 0.0) {
            return Err(format!("{name:?}: {x0_km} km from its centre is inside Phobos"));
        }
        let (x0_m, height_m) = (1e3 * x0_km, 1e3 * height_km);
        let hill = Hill::PHOBOS;
        let planar = hill
            .quasi_satellite(x0_m)
            .ok_or_else(|| format!("{name:?}: no closed orbit starts {x0_km} km from Phobos' centre"))?;
        let long_km = planar.farthest.position_m.y.abs() / 1e3;
        if (long_km - y_km).abs() > NAME_KM {
            return Err(format!(
                "{name:?}: this orbit reaches {long_km:.1} km along-track: its name is {}qso-{x0_km}x{long_km:.0}{}",
                if is_3d { "3d-" } else { "" },
                if is_3d { format!("x{height_km}") } else { String::new() }
            ));
        }
        let found = match is_3d {
            false => planar,
            true => {
                hill.quasi_satellite_3d(x0_m, height_m).ok_or_else(|| format!("{name:?}: there is no such orbit"))?
            }
        };
        Ok(Qso { x0_m, height_m, found })
    }

    /// Period, s; for a 3D orbit, of its projection on the plane.
    pub fn period_s(&self) -> f64 {
        self.found.period_s
    }

    /// Its state on the line to Mars, along Phobos' axes.
    pub fn start(&self) -> State {
        self.found.start
    }

    /// The trajectory that passes the start (on the Mars side) at an epoch, over a span. Its axes are Phobos' own,
    /// whose libration is neglected.
    ///
    /// # Errors
    /// If it cannot be propagated that long, as a sentence.
    pub fn trajectory(&self, name: &str, target: &str, at: Epoch, span: Span) -> Result<Trajectory, String> {
        let span = Span {
            start: if at < span.start { at } else { span.start },
            end: if span.end < at { at } else { span.end },
        };
        let orbit = Hill::PHOBOS.orbit(self.found.start, at, span);
        let orbit = orbit.ok_or_else(|| format!("{name} cannot be propagated from {} to {}", span.start, span.end))?;
        Ok(Trajectory {
            target: body_name(target),
            centre: "PHOBOS".to_owned(),
            frame: "IAU_PHOBOS".to_owned(),
            source: name.to_owned(),
            segments: vec![Segment { span, path: Path::Orbit(orbit) }],
        })
    }
}
