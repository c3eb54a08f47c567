//! Sun and camera by angles above a target: incidence, emission, phase, azimuths.

use glam::{DMat3, DVec3};

use crate::geometry::{Direction, Pose, angle_rad, body_from_site};

use super::TomlReader;
use super::types::{Frame, GeometryToml, Top};

/// As far as printed angles may contradict each other, deg.
const ROUNDED_DEG: f64 = 0.01;
/// Angles that differ by less are the same, deg: rounding of the trigonometry.
const SAME_DEG: f64 = 1e-6;

/// What `[geometry]` places. What could not be placed is `Some(None)`: the problem has been reported.
#[derive(Default)]
pub(super) struct ByAngles {
    /// Towards the Sun, axes of the body.
    pub(super) sun: Option<Option<Direction>>,
    /// Local coordinates from the sensor's.
    pub(super) camera: Option<Option<Pose>>,
}

/// Sine and cosine of an angle in degrees: 0 and 1 to the last digit at right angles.
fn sin_cos_deg(angle_deg: f64) -> (f64, f64) {
    let quarters = (angle_deg / 90.0).round();
    let (sin, cos) = (angle_deg - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) {
        1.0 => (cos, -sin),
        2.0 => (-sin, -cos),
        3.0 => (-cos, sin),
        _ => (sin, cos),
    }
}

/// Unit vector at an angle from z, at an azimuth from y (north) through x (east), both in deg.
fn towards(from_zenith_deg: f64, azimuth_deg: f64) -> DVec3 {
    let ((sin, cos), (east, north)) = (sin_cos_deg(from_zenith_deg), sin_cos_deg(azimuth_deg));
    DVec3::new(sin * east, sin * north, cos)
}

/// Haversine of an angle in degrees.
fn haversine(angle_deg: f64) -> f64 {
    sin_cos_deg(0.5 * angle_deg).0.powi(2)
}

/// Difference of the azimuths, 0 to 180 deg, of two directions at `i_deg` and `e_deg` from the zenith which are `phase_deg` apart: the law of
/// haversines, from both ends. 0 if one of them is the zenith or the nadir.
fn azimuths_apart_deg(i_deg: f64, e_deg: f64, phase_deg: f64) -> f64 {
    let near = haversine(phase_deg) - haversine(i_deg - e_deg);
    let far = haversine(i_deg + e_deg) - haversine(phase_deg);
    2.0 * near.max(0.0).sqrt().atan2(far.max(0.0).sqrt()).to_degrees()
}

/// East, north and zenith as columns. `None` if the zenith is along north.
fn horizon(zenith: Direction, north: DVec3) -> Option<DMat3> {
    let east = Direction::new(north.cross(zenith.vec()))?.vec();
    Some(DMat3::from_cols(east, zenith.vec().cross(east), zenith.vec()))
}

impl TomlReader<'_> {
    /// What a scene's angles place.
    pub(super) fn by_angles(&mut self, toml: &GeometryToml) -> ByAngles {
        if toml.incidence_deg.or(toml.emission_deg).is_none() {
            let message = "places nothing: `incidence_deg` places the Sun, `emission_deg` the camera";
            self.problem("geometry", message);
        }
        let placed = self.placed_by_angles(toml);
        let (sun, camera) = placed.unwrap_or_default();
        ByAngles { sun: toml.incidence_deg.map(|_| sun), camera: toml.emission_deg.map(|_| camera) }
    }

    fn placed_by_angles(&mut self, toml: &GeometryToml) -> Option<(Option<Direction>, Option<Pose>)> {
        let range_m = toml.emission_deg.map(|emission_deg| self.range_m(toml, emission_deg));
        let mut are_good = true;
        for (key, is_given, with) in [
            ("sun_azimuth_deg", toml.sun_azimuth_deg.is_some(), toml.incidence_deg.is_some()),
            ("observer_azimuth_deg", toml.observer_azimuth_deg.is_some(), toml.emission_deg.is_some()),
            ("altitude_m", toml.altitude_m.is_some(), toml.emission_deg.is_some()),
            ("range_m", toml.range_m.is_some(), toml.emission_deg.is_some()),
            ("up", toml.up.is_some(), toml.emission_deg.is_some()),
            ("phase_deg", toml.phase_deg.is_some(), toml.incidence_deg.and(toml.emission_deg).is_some()),
        ] {
            if is_given && !with {
                let needed = match key {
                    "sun_azimuth_deg" => "`incidence_deg`",
                    "phase_deg" => "`incidence_deg` and `emission_deg`",
                    _ => "`emission_deg`",
                };
                self.problem(&format!("geometry.{key}"), format!("goes with {needed}"));
                are_good = false;
            }
        }
        let (body_from_target, target_m) = self.target(toml)?;
        if !are_good {
            return None;
        }
        let (sun_azimuth_deg, observer_azimuth_deg) = self.azimuths(toml)?;
        let sun = toml.incidence_deg.map(|incidence_deg| {
            if incidence_deg > 90.0 {
                self.note("geometry.incidence_deg", "the Sun is below the target's horizon");
            }
            body_from_target * towards(incidence_deg, sun_azimuth_deg)
        });
        let camera = toml.emission_deg.zip(range_m.flatten()).and_then(|(emission_deg, range_m)| {
            if emission_deg > 90.0 {
                self.note("geometry.emission_deg", "the camera is below the target's horizon");
            }
            let to_camera = body_from_target * towards(emission_deg, observer_azimuth_deg);
            let top = toml.up.unwrap_or_else(|| {
                self.stated("geometry.up", "north");
                Top::North
            });
            let up = match (top, sun) {
                (Top::North, _) => body_from_target.y_axis,
                (Top::Zenith, _) => body_from_target.z_axis,
                (Top::Sun, Some(sun)) => sun,
                (Top::Sun, None) => {
                    self.problem("geometry.up", "\"sun\" goes with `incidence_deg`");
                    return None;
                }
            };
            let rotation =
                self.upright("geometry.up", Direction::new(-to_camera)?, up, "say \"north\", \"zenith\" or \"sun\"")?;
            Some(Pose { rotation, translation_m: target_m + range_m * to_camera })
        });
        Some((sun.and_then(Direction::new), camera))
    }

    /// From the target to the camera, m.
    fn range_m(&mut self, toml: &GeometryToml, emission_deg: f64) -> Option<f64> {
        let (key, value_m) = match (toml.altitude_m, toml.range_m) {
            (Some(altitude_m), None) => ("altitude_m", altitude_m),
            (None, Some(range_m)) => ("range_m", range_m),
            _ => {
                let message =
                    "give one of `altitude_m`, above the target's horizontal plane, and `range_m`, from the target";
                self.problem("geometry", message);
                return None;
            }
        };
        let item = format!("geometry.{key}");
        let value_m = self.positive(&item, value_m)?;
        if key == "range_m" {
            return Some(value_m);
        }
        let cos = sin_cos_deg(emission_deg).1;
        if cos <= 0.0 {
            let message =
                format!("at an emission angle of {emission_deg} deg the camera has no height above the target");
            self.helped(&item, message, "give `range_m`, the distance from the target");
            return None;
        }
        Some(value_m / cos)
    }

    /// East, north and zenith at the target as columns, axes of the body, and the target in local coordinates, m.
    fn target(&mut self, toml: &GeometryToml) -> Option<(DMat3, DVec3)> {
        let normal = toml.normal.map(DVec3::from_array);
        let zenith = normal.map(Direction::new);
        if zenith == Some(None) {
            self.problem("geometry.normal", "has no length");
            return None;
        }
        let zenith = zenith.flatten();
        let target_m = toml.target_m.map(DVec3::from_array);
        if target_m.is_none() {
            self.stated("geometry.target_m", "`origin_m`");
        }
        if toml.frame == Some(Frame::Site) {
            let body_from_site = self.body_from_site("geometry.frame", "the frame of a site")?;
            let axes = match zenith.map(|zenith| horizon(zenith, DVec3::Y)) {
                None => DMat3::IDENTITY,
                Some(Some(axes)) => axes,
                Some(None) => {
                    self.problem("geometry.normal", "is along north, from which azimuths are counted");
                    return None;
                }
            };
            return Some((body_from_site * axes, body_from_site * target_m.unwrap_or_default()));
        }
        let target_m = target_m.unwrap_or(self.origin_m);
        let up = zenith.map_or(target_m, Direction::vec);
        let Some(axes) = body_from_site(up) else {
            let message = "the target is the body's centre, which has no zenith";
            self.helped("geometry", message, "give `normal`, or a `target_m` on the surface");
            return None;
        };
        if up.x == 0.0 && up.y == 0.0 {
            self.note("geometry", "the zenith is along the body's axis: east is taken as +y of the body");
        }
        Some((axes, target_m - self.origin_m))
    }

    /// Azimuths of Sun and observer, deg; 0 where they mean nothing.
    fn azimuths(&mut self, toml: &GeometryToml) -> Option<(f64, f64)> {
        let (sun, observer) = (toml.sun_azimuth_deg, toml.observer_azimuth_deg);
        // In the zenith an azimuth means nothing.
        let turns = |angle_deg: Option<f64>| angle_deg.is_some_and(|angle_deg| sin_cos_deg(angle_deg).0 != 0.0);
        let (turns_sun, turns_observer) = (turns(toml.incidence_deg), turns(toml.emission_deg));
        let missing = |reader: &mut Self, key: &str, or: &str| {
            reader.problem("geometry", format!("`{key}` is missing: from north through east{or}"));
            None
        };
        let (Some(phase_deg), Some(i_deg), Some(e_deg)) = (toml.phase_deg, toml.incidence_deg, toml.emission_deg)
        else {
            return match (turns_sun && sun.is_none(), turns_observer && observer.is_none()) {
                (true, true) => missing(self, "sun_azimuth_deg", ", and the observer's or `phase_deg`"),
                (true, false) => missing(self, "sun_azimuth_deg", if turns_observer { "; or `phase_deg`" } else { "" }),
                (false, true) => missing(self, "observer_azimuth_deg", if turns_sun { "; or `phase_deg`" } else { "" }),
                (false, false) => Some((sun.unwrap_or(0.0), observer.unwrap_or(0.0))),
            };
        };
        let (least, most) = ((i_deg - e_deg).abs(), (i_deg + e_deg).min(360.0 - i_deg - e_deg));
        if !(least - ROUNDED_DEG..=most + ROUNDED_DEG).contains(&phase_deg) {
            let message =
                format!("{phase_deg} deg: with these angles of incidence and emission it is within {least} to {most}");
            self.problem("geometry.phase_deg", message);
            return None;
        }
        if !turns_sun || !turns_observer {
            // One of them is in the zenith: the phase is the other's angle, and says nothing more.
            let key = if turns_sun { ("sun_azimuth_deg", sun) } else { ("observer_azimuth_deg", observer) };
            if (turns_sun || turns_observer) && key.1.is_none() {
                return missing(self, key.0, "");
            }
            return Some((sun.unwrap_or(0.0), observer.unwrap_or(0.0)));
        }
        if !(least - SAME_DEG..=most + SAME_DEG).contains(&phase_deg) {
            let nearest = phase_deg.clamp(least, most);
            self.note("geometry.phase_deg", format!("{phase_deg} deg is rounded: {nearest} is taken"));
        }
        let apart_deg = azimuths_apart_deg(i_deg, e_deg, phase_deg);
        let taken = |azimuth_deg: f64, other: &str| {
            format!(
                "{azimuth_deg} deg: of the two that `phase_deg` leaves, the observer clockwise of the Sun ({other})"
            )
        };
        match (sun, observer) {
            (Some(sun), None) => {
                let observer = (sun + apart_deg).rem_euclid(360.0);
                let other = format!("the other is {} deg", (sun - apart_deg).rem_euclid(360.0));
                self.stated("geometry.observer_azimuth_deg", taken(observer, &other));
                Some((sun, observer))
            }
            (None, Some(observer)) => {
                let sun = (observer - apart_deg).rem_euclid(360.0);
                let other = format!("the other is {} deg", (observer + apart_deg).rem_euclid(360.0));
                self.stated("geometry.sun_azimuth_deg", taken(sun, &other));
                Some((sun, observer))
            }
            (Some(sun), Some(observer)) => {
                let [to_sun, to_observer] = [towards(i_deg, sun), towards(e_deg, observer)];
                let made_deg = angle_rad(to_sun, to_observer).to_degrees();
                let off_deg = (made_deg - phase_deg).abs();
                if off_deg > ROUNDED_DEG {
                    let message =
                        format!("{phase_deg} deg, and the azimuths make it {made_deg:.6}: leave one of the three out");
                    self.problem("geometry.phase_deg", message);
                    return None;
                }
                if off_deg > SAME_DEG {
                    self.note(
                        "geometry.phase_deg",
                        format!("{phase_deg} deg; the azimuths count, and make it {made_deg:.6}"),
                    );
                }
                Some((sun, observer))
            }
            (None, None) => missing(self, "sun_azimuth_deg", ", or the observer's"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact() {
        for (angle_deg, sin, cos) in
            [(-90.0, -1.0, 0.0), (0.0, 0.0, 1.0), (90.0, 1.0, 0.0), (180.0, 0.0, -1.0), (270.0, -1.0, 0.0)]
        {
            assert_eq!(sin_cos_deg(angle_deg), (sin, cos), "{angle_deg}");
        }
        let (sin, cos) = sin_cos_deg(1e-7);
        assert!((sin - 1e-7_f64.to_radians()).abs() < 1e-24 && cos <= 1.0);
    }

    #[test]
    fn azimuths_follow_from_the_phase() {
        // By hand: two directions on the horizon; two at 60 deg whose phase is 60 deg: hav = (1/4) / (3/4).
        assert!((azimuths_apart_deg(90.0, 90.0, 35.0) - 35.0).abs() < 1e-13);
        assert!(
            (azimuths_apart_deg(60.0, 60.0, 60.0) - 2.0 * (1.0_f64 / 3.0).sqrt().asin().to_degrees()).abs() < 1e-13
        );
        assert_eq!(azimuths_apart_deg(30.0, 20.0, 10.0), 0.0);
        assert_eq!(azimuths_apart_deg(30.0, 20.0, 50.0), 180.0);
    }
}
