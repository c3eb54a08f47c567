//! DART's axes and angles: the only place where they are turned into mmxrt's.
//!
//! A site's frame has x down the image (South), y to its right (East), z up: right-handed, as mmxrt's frames are, so that a
//! rotation leads from one to the other, and facets keep the way they turn. Azimuths run from +x to +y.

use glam::{DMat3, DVec2, DVec3};

use crate::geometry::latitude_longitude_deg;
use crate::geometry::{Direction, body_from_site};

/// Angles below this are rounding errors of a rotation: a camera that looks straight down has no azimuth of its own, rad.
const ROUNDING_RAD: f64 = 1e-13;

/// Rotation that carries axes of the body into the site's: x South, y East, z along the outward radius at `origin_m`, as
/// [`body_from_site`] has them. At the body's centre x is -y and y is x of the body.
pub(super) fn dart_from_body(origin_m: DVec3) -> DMat3 {
    let site = body_from_site(origin_m).unwrap_or(DMat3::IDENTITY);
    DMat3::from_cols(-site.y_axis, site.x_axis, site.z_axis).transpose()
}

/// Zenith angle and azimuth of a vector of any length, deg; azimuths from 0 to below 360, 0 for a vertical one.
pub(super) fn angles_deg(v: DVec3) -> [f64; 2] {
    [v.x.hypot(v.y).atan2(v.z).to_degrees(), full_turn(v.y.atan2(v.x).to_degrees())]
}

/// Zenith angle and azimuth of the Sun, towards which `sun` leads in axes of the body, deg; `None` below the horizon of the site at
/// `origin_m`, where DART has no Sun.
pub(super) fn sun_deg(origin_m: DVec3, sun: Direction) -> Option<[f64; 2]> {
    let angles_deg = angles_deg(dart_from_body(origin_m) * sun.vec());
    Some(angles_deg).filter(|[zenith_deg, _]| *zenith_deg < 90.0)
}

/// Planetocentric latitude and longitude (-180 to 180), deg, and no altitude: DART uses them for dates.
pub(super) fn latitude_longitude_altitude(origin_m: DVec3) -> [f64; 3] {
    let [latitude, longitude] = latitude_longitude_deg(origin_m);
    [latitude, longitude, 0.0]
}

/// The unit vector with this zenith angle and azimuth, deg.
pub(super) fn vector([zenith_deg, azimuth_deg]: [f64; 2]) -> DVec3 {
    let (sin, cos) = zenith_deg.to_radians().sin_cos();
    (sin * horizontal(azimuth_deg)).extend(cos)
}

/// The horizontal unit vector with this azimuth, deg. In an image that faces where it leads, lines follow one another along it, and
/// pixels of a line along its perpendicular, [`DVec2::perp`].
pub(super) fn horizontal(azimuth_deg: f64) -> DVec2 {
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    DVec2::new(cos, sin)
}

/// The opposite direction, deg.
pub(super) fn reversed([zenith_deg, azimuth_deg]: [f64; 2]) -> [f64; 2] {
    [180.0 - zenith_deg, if azimuth_deg < 180.0 { azimuth_deg + 180.0 } else { azimuth_deg - 180.0 }]
}

/// Axes of an upright image for a line of sight: right (horizontal, across it) and down.
///
/// Looking straight down along azimuth a, the image's rows run along a - 180 deg, as DART's own nadir images do for a = 180.
fn upright([zenith_deg, azimuth_deg]: [f64; 2]) -> (DVec3, DVec3) {
    let look = vector([zenith_deg, azimuth_deg]);
    let right = (-horizontal(azimuth_deg).perp()).extend(0.0);
    (right, look.cross(right))
}

/// Line of sight (zenith angle and azimuth) and turn about it, deg, of a camera whose axes right, down, ahead are the columns.
///
/// The turn is clockwise as seen along the line of sight: it leads from the upright image's right towards its down. A line of sight within
/// `blur_rad` of the vertical is taken to be vertical: any azimuth is its own, and there is one without a turn.
pub(super) fn camera_deg(dart_from_sensor: DMat3, blur_rad: f64) -> ([f64; 2], f64) {
    let (right, ahead) = (dart_from_sensor.x_axis, dart_from_sensor.z_axis);
    let mut look_deg = angles_deg(ahead);
    if ahead.x.hypot(ahead.y) < blur_rad.max(ROUNDING_RAD) {
        look_deg = [if ahead.z < 0.0 { 180.0 } else { 0.0 }, full_turn(right.x.atan2(-right.y).to_degrees())];
    }
    let (upright_right, upright_down) = upright(look_deg);
    let roll = right.dot(upright_down).atan2(right.dot(upright_right));
    (look_deg, if roll.abs() < ROUNDING_RAD { 0.0 } else { roll.to_degrees() })
}

/// The camera's axes right, down, ahead as columns: the inverse of [`camera_deg`].
pub(super) fn camera_rotation(look_deg: [f64; 2], roll_deg: f64) -> DMat3 {
    let (right, down) = upright(look_deg);
    let (sin, cos) = roll_deg.to_radians().sin_cos();
    DMat3::from_cols(cos * right + sin * down, cos * down - sin * right, vector(look_deg))
}

/// The turn of an object by its intrinsic rotation, nutation and precession, deg.
pub(super) fn object_rotation(angles_deg: DVec3) -> DMat3 {
    let [intrinsic, nutation, precession] = angles_deg.to_array().map(f64::to_radians);
    DMat3::from_rotation_z(precession) * DMat3::from_rotation_y(nutation) * DMat3::from_rotation_z(intrinsic)
}

/// Intrinsic rotation, nutation and precession of a turn, deg: the inverse of [`object_rotation`]. About the vertical alone, all of it is intrinsic.
pub(super) fn object_deg(turn: DMat3) -> DVec3 {
    let (x, z) = (turn.x_axis, turn.z_axis);
    let sin = z.x.hypot(z.y);
    let (intrinsic, precession) = match sin < ROUNDING_RAD {
        true => (x.y.atan2(turn.y_axis.y), 0.0),
        false => (turn.y_axis.z.atan2(-x.z), z.y.atan2(z.x)),
    };
    let nutation = if sin < ROUNDING_RAD && z.z > 0.0 { 0.0 } else { sin.atan2(z.z) };
    DVec3::new(intrinsic, nutation, precession).map(f64::to_degrees)
}

/// How DART takes an OBJ file's `v`, for people: [`dart_from_obj`] in words.
pub(super) const OBJ_AXES: &str = "reads `v a b c` as x = c, y = a, z = b";
/// What to write so that it is taken as is meant: [`obj_from_dart`] in words.
pub(super) const WRITE_OBJ_AXES: &str = "write the OBJ file as `v y z x`";

/// An OBJ file's `v` from DART's axes.
pub(super) fn obj_from_dart(v: DVec3) -> DVec3 {
    DVec3::new(v.y, v.z, v.x)
}

/// DART's axes from an OBJ file's `v`.
pub(super) fn dart_from_obj(v: DVec3) -> DVec3 {
    DVec3::new(v.z, v.x, v.y)
}

/// An azimuth from 0 to below 360, deg.
pub(super) fn full_turn(deg: f64) -> f64 {
    let turned = deg.rem_euclid(360.0);
    // A hair below 0 is rounded up to all of the turn.
    if turned < 360.0 { turned } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_site_stands_upright_on_the_body() {
        // On the equator at longitude 90 deg: up +y, East -x, South -z.
        let site = dart_from_body(DVec3::new(0.0, 11e3, 0.0));
        for (body, dart) in [(DVec3::Y, DVec3::Z), (DVec3::NEG_X, DVec3::Y), (DVec3::NEG_Z, DVec3::X)] {
            assert_eq!(site * body, dart);
        }
        // At a pole East is +y of the body, South then +x of it in the North, -x in the South.
        assert_eq!(dart_from_body(DVec3::Z), DMat3::IDENTITY);
        assert_eq!(dart_from_body(DVec3::NEG_Z), DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0)));
        for origin_m in [DVec3::ZERO, DVec3::Z, DVec3::NEG_Z, DVec3::new(1.0, -2.0, 3.0)] {
            let site = dart_from_body(origin_m);
            assert!((site.determinant() - 1.0).abs() < 1e-15);
            assert!((site * origin_m - DVec3::Z * origin_m.length()).length() <= 1e-15 * origin_m.length());
        }
    }

    #[test]
    fn objects_come_back() {
        for angles_deg in
            [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [10.0, 20.0, -170.0], [100.0, 180.0, 0.0], [-50.0, 90.0, 5.0]]
        {
            let turn = object_rotation(DVec3::from_array(angles_deg));
            let back = object_deg(turn);
            assert!((back - DVec3::from_array(angles_deg)).length() < 1e-12, "{angles_deg:?} {back}");
        }
    }

    #[test]
    fn cameras_come_back() {
        let mut worst: f64 = 0.0;
        for zenith in [180.0, 179.999_999_9, 120.0, 91.0, 30.0] {
            for (azimuth, roll) in [(0.0, 0.0), (123.4, 5.0), (359.9, -179.0), (180.0, 90.0)] {
                let given = camera_rotation([zenith, azimuth], roll);
                let (look, turn) = camera_deg(given, 0.0);
                let back = camera_rotation(look, turn);
                worst = worst.max((0..3).map(|i| (given.col(i) - back.col(i)).length()).fold(0.0, f64::max));
                assert!((given.determinant() - 1.0).abs() < 1e-15);
            }
        }
        assert!(worst < 1e-15, "{worst:e}");
        // Straight down, right of the image to +y: DART's own nadir image.
        let nadir = DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::NEG_Z);
        assert_eq!(camera_deg(nadir, 0.0), ([180.0, 180.0], 0.0));
        // Almost so.
        let tilted = DMat3::from_rotation_x(1e-6) * DMat3::from_rotation_y(1e-6) * nadir;
        assert!(camera_deg(tilted, 0.0).1 != 0.0);
        assert_eq!(camera_deg(tilted, 1e-5).1, 0.0);
    }
}
