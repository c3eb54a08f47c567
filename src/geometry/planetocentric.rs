//! Planetocentric coordinates.

use glam::DVec3;

/// Planetocentric latitude and east longitude of a body-fixed position or direction, deg; longitude from -180 to 180.
pub fn latitude_longitude_deg(p: DVec3) -> [f64; 2] {
    [p.z.atan2(p.x.hypot(p.y)).to_degrees(), p.y.atan2(p.x).to_degrees()]
}

/// The same, longitude from 0 to 360.
pub fn planetocentric_deg(p: DVec3) -> [f64; 2] {
    let [latitude, longitude] = latitude_longitude_deg(p);
    [latitude, longitude.rem_euclid(360.0)]
}

/// The direction with this planetocentric latitude and east longitude, deg: unit vector, body axes.
pub fn direction_of_deg([latitude_deg, longitude_deg]: [f64; 2]) -> DVec3 {
    let (latitude, longitude) = (latitude_deg.to_radians(), longitude_deg.to_radians());
    DVec3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_poles_and_the_far_side_have_the_coordinates_of_a_map() {
        let near = |p: DVec3, expected: [f64; 2]| {
            let found = planetocentric_deg(p);
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-13), "{p}: {found:?}");
        };
        near(DVec3::X, [0.0, 0.0]);
        near(DVec3::new(-1.0, 0.0, 1.0), [45.0, 180.0]);
        near(DVec3::new(1.0, -1.0, 0.0), [0.0, 315.0]);
        near(DVec3::new(0.0, 0.0, -2.0), [-90.0, 0.0]);
        // A square of these would overflow; and nothing has no direction, but is no panic.
        near(DVec3::new(1e200, 1e200, 0.0), [0.0, 45.0]);
        near(DVec3::ZERO, [0.0, 0.0]);
        // There and back.
        for at in [[0.0, 0.0], [45.0, 180.0], [-30.0, 315.0], [90.0, 0.0]] {
            near(direction_of_deg(at), at);
            assert!((direction_of_deg(at).length() - 1.0).abs() < 1e-15);
        }
        assert_eq!(latitude_longitude_deg(DVec3::NEG_Y), [0.0, -90.0]);
    }
}
