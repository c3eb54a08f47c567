//! Orientation of an image: directions to north, Sun and Mars.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::FrameCamera;
use crate::scene::Scene;

/// Shorter than this, in pixels for a unit of a direction over the scale of a pixel, a direction is along the line of sight, but for rounding.
const ALONG: f64 = 16.0 * f64::EPSILON;

/// Orientation in the middle of an image (for one taken in parts: of its reference exposure).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Orientation {
    /// Unit vector along a line, from sample to sample, axes of the body.
    pub plus_sample: [f64; 3],
    /// From line to line.
    pub plus_line: [f64; 3],
    /// Of the ray through the image's middle.
    pub view: [f64; 3],
    /// Where the body's north (+z) points in the image, from up by the right, 0 to 360 deg; null if it is along the line of sight.
    pub north_deg: Option<f64>,
    /// Where the Sun is, the same way.
    pub sun_deg: Option<f64>,
    /// Where Mars's middle is, the same way; null too if the scene has no Mars.
    #[serde(default)]
    pub mars_deg: Option<f64>,
}

impl Orientation {
    /// Of a scene's image.
    pub fn of(scene: &Scene) -> Self {
        let camera = &scene.exposure.camera;
        let axes = camera.world_from_sensor.rotation;
        let [x, y] = [camera.samples, camera.lines].map(|n| 0.5 * f64::from(n));
        Orientation {
            plus_sample: axes.x_axis.to_array(),
            plus_line: axes.y_axis.to_array(),
            view: camera.ray(x, y).normalize().to_array(),
            north_deg: azimuth_deg(camera, DVec3::Z),
            sun_deg: azimuth_deg(camera, scene.sky.sun.direction.vec()),
            // The origin is not far from the image's middle, for one as distant as Mars.
            mars_deg: scene.sky.mars.as_ref().and_then(|mars| azimuth_deg(camera, mars.centre_m)),
        }
    }
}

/// Where what is in the image's middle goes in it if it moves along a direction, from up by the right, deg.
fn azimuth_deg(camera: &FrameCamera, towards: DVec3) -> Option<f64> {
    let sensor_from_world = camera.world_from_sensor.rotation.transpose();
    let [x, y] = [camera.samples, camera.lines].map(|n| 0.5 * f64::from(n));
    let (ray, way) = (sensor_from_world * camera.ray(x, y), sensor_from_world * towards);
    // x / z of a point on the ray, as the point moves.
    let [right, down] = [way.x - ray.x / ray.z * way.z, way.y - ray.y / ray.z * way.z];
    if right.hypot(down) <= ALONG * way.length() {
        return None;
    }
    let [right, down] = [right / camera.pitch[0], down / camera.pitch[1]];
    Some(right.atan2(-down).to_degrees().rem_euclid(360.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use glam::DMat3;

    #[test]
    fn azimuths_are_counted_from_up_by_the_right() {
        // Looking along -x with z up: +y is to the right.
        let rotation = DMat3::from_cols(DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X);
        let camera = FrameCamera::centred(Pose { rotation, translation_m: DVec3::X * 9.0 }, 4, 2, 0.1);
        for (towards, expected) in [
            (DVec3::Z, Some(0.0)),
            (DVec3::Y, Some(90.0)),
            (DVec3::new(-3.0, -1.0, -1.0), Some(225.0)),
            (DVec3::NEG_Y, Some(270.0)),
            (DVec3::X, None),
            (DVec3::NEG_X, None),
        ] {
            let found = azimuth_deg(&camera, towards);
            assert_eq!(found.is_some(), expected.is_some(), "{towards:?}");
            assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 1e-12, "{towards:?}: {found:?}");
        }
        // A window to the right of the boresight, 1 pixel of 0.1 off: what goes away from the camera goes to the left there, towards the vanishing point.
        let off = FrameCamera { boresight_px: [1.0, 1.0], ..camera.clone() };
        assert!((azimuth_deg(&off, DVec3::NEG_X).unwrap() - 270.0).abs() < 1e-12);
        // Pixels twice as high as wide: 45 deg in space is atan(2) from up.
        let high = FrameCamera { pitch: [0.1, 0.2], ..camera };
        assert!((azimuth_deg(&high, DVec3::new(0.0, 1.0, 1.0)).unwrap() - 2.0_f64.atan().to_degrees()).abs() < 1e-12);
    }
}
