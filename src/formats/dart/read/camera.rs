//! Cameras of all versions as frame cameras that look along a line of sight.
//!
//! Above the scene (`Pinhole` before 5.10) angles lead from the scene to the camera; in the scene (`InsideSensor`) and
//! from 5.10 (`Sensor`) they are those of the look.

use glam::DVec3;

use crate::formats::xml::Element;
use crate::geometry::{FrameCamera, whole_u32};
use crate::report::Fate;

use super::super::frame::{self, angles_deg, full_turn};
use super::super::{Maket, Pinhole};
use super::reading::Reading;

pub(super) fn read(phase: &Element, maket: &Maket, reading: &mut Reading) -> Vec<Pinhole> {
    let Some(list) = phase.descendant("SensorImageSimulation") else { return Vec::new() };
    if list.get("importMultipleSensors") == Some("1") {
        let message = "cameras from a text file: give them as elements";
        reading.note(Fate::Dropped, list.at_attribute("importMultipleSensors"), message);
    }
    let mut cameras = Vec::new();
    for element in &list.children {
        cameras.extend(match element.name.as_str() {
            "Pinhole" => pinhole(element, maket, reading),
            "InsideSensor" => inside(element, reading),
            "Sensor" => sensor(element, reading),
            "Pushbroom" => {
                reading.note(Fate::Dropped, element.at(), "a push-broom camera");
                None
            }
            "SensorsImportation" => None,
            other => {
                let message = format!("a camera of a kind that is not known, `<{other}>`");
                reading.note(Fate::Dropped, element.at(), message);
                None
            }
        });
    }
    cameras
}

fn position(element: &Element, reading: &mut Reading) -> DVec3 {
    DVec3::from_array(["sensorPosX", "sensorPosY", "sensorPosZ"].map(|name| reading.number(element, name)))
}

/// A turn about the line of sight, deg; 0 where none is given.
fn roll(element: Option<&Element>, name: &str, reading: &mut Reading) -> f64 {
    element.filter(|e| e.get(name).is_some()).map_or(0.0, |e| reading.number_or(e, name, 0.0))
}

fn pixels(element: &Element, names: [&str; 2], reading: &mut Reading) -> [u32; 2] {
    names.map(|name| {
        let pixels = reading.integer(element, name);
        if pixels == 0 && element.get(name).is_some_and(|text| text.trim() == "0") {
            reading.problem(element.at_attribute(name), "an image of 0 pixels");
        }
        pixels
    })
}

/// Two full angles, deg, between 0 and 180.
fn angles_of_view(element: &Element, names: [&str; 2], reading: &mut Reading) -> [f64; 2] {
    names.map(|name| {
        let angle = reading.positive(element, name);
        if angle >= 180.0 {
            let message = format!("a field of view of {angle} deg: a frame camera's is below 180");
            reading.problem(element.at_attribute(name), message);
        }
        angle
    })
}

/// The full angle, deg, of what spans this size at a distance across the line of sight.
fn angle_deg(size_m: f64, distance_m: f64) -> f64 {
    FrameCamera::angle_of_pitch(size_m / distance_m, 1).to_degrees()
}

/// Full angles of a detector of these sizes, m, behind a focal length, m.
fn from_focal_length(dimensions: &Element, focal: &Element, reading: &mut Reading) -> [f64; 2] {
    let focal_m = reading.positive(focal, "focaleDistance");
    ["width", "height"].map(|name| angle_deg(reading.positive(dimensions, name), focal_m))
}

/// A frame camera above the scene, before 5.10.
fn pinhole(element: &Element, maket: &Maket, reading: &mut Reading) -> Option<Pinhole> {
    if reading.flag(element, "ifFishEye") {
        reading.note(Fate::Dropped, element.at(), "a fish-eye camera");
        return None;
    }
    let position_m = position(reading.child(element, "Sensor")?, reading);
    let (mut look_deg, mut roll_deg) = ([180.0, 0.0], 0.0);
    if reading.flag(element, "defCameraOrientation") {
        let definition = reading.child(element, "OrientationDef")?;
        if reading.integer_or(definition, "orientDefType", 0) != 0 {
            reading.note(Fate::Dropped, definition.at(), "a camera turned by yaw, pitch and roll");
            return None;
        }
        let orientation = reading.child(definition, "CameraOrientation")?;
        let zenith = reading.number(orientation, "cameraTheta");
        let azimuth = reading.number(orientation, "cameraPhi");
        look_deg = frame::reversed([zenith, full_turn(azimuth)]);
        roll_deg = roll(Some(orientation), "cameraRotation", reading);
    } else {
        let middle = DVec3::new(maket.size_m[0] / 2.0, maket.size_m[1] / 2.0, 0.0);
        look_deg = if middle == position_m { look_deg } else { angles_deg(middle - position_m) };
        let message = "a camera without orientation: taken to look at the middle of the ground";
        reading.note(Fate::Defaulted, element.at(), message);
    }
    // How far the ground is along the line of sight.
    let drop = -look_deg[0].to_radians().cos();
    let range_m = if drop > 0.0 { position_m.z / drop } else { 0.0 };
    let over_range = |size_m: f64| angle_deg(size_m, range_m);
    let field = element.child("CamImageFOV").filter(|_| element.get("setImageSize") == Some("1"));
    let (field_of_view_deg, size_m) = match field.map(|f| (f, reading.integer_or(f, "definitionFOV", 1))) {
        Some((field, 1)) => {
            let view = angles_of_view(reading.child(field, "CamImageAOV")?, ["aovX", "aovY"], reading);
            (view, view.map(|a| range_m * FrameCamera::pitch_of_angle(a.to_radians(), 1)))
        }
        Some((field, _)) => {
            let dimensions = reading.child(field, "CamImageDim")?;
            let size = ["sizeImageX", "sizeImageY"].map(|name| reading.positive(dimensions, name));
            let message =
                "an image by its size on the ground: taken is the angle of that size at the range of the ground";
            reading.note(Fate::Approximated, dimensions.at(), message);
            (size.map(over_range), size)
        }
        None => {
            // Columns run along y, rows along x.
            let size = [maket.size_m[1], maket.size_m[0]];
            let message =
                "a camera without a field of view: taken is the angle of the scene's sides at the range of the ground";
            reading.note(Fate::Defaulted, element.at(), message);
            (size.map(over_range), size)
        }
    };
    if field_of_view_deg.iter().any(|a| !(a.is_finite() && (0.0..180.0).contains(a) && *a > 0.0)) {
        reading.problem(
            element.at(),
            "a camera whose field of view cannot be told: it does not look at the ground from above",
        );
        return None;
    }
    let counted = field.filter(|f| f.get("defNbPixels") == Some("1")).and_then(|f| f.child("NbPixels"));
    let pixels = match counted {
        Some(counted) => pixels(counted, ["nbPixelsX", "nbPixelsY"], reading),
        None => {
            reading.note(
                Fate::Defaulted,
                element.at(),
                "a camera without a number of pixels: taken is one a cell of the scene",
            );
            size_m.map(|size| whole_u32((size / maket.cell_m[0]).ceil().clamp(1.0, 1e4)))
        }
    };
    Some(Pinhole { position_m, look_deg, roll_deg, field_of_view_deg, pixels, at: element.at() })
}

/// Zenith angle and azimuth of the look, deg, from a `SensorView`.
fn look(view: &Element, zenith: &str, reading: &mut Reading) -> Option<[f64; 2]> {
    match reading.integer_or(view, "viewDefinition", 1) {
        0 => {
            let element = reading.child(view, "SensorViewDirection")?;
            let names = ["sensorDirectionX", "sensorDirectionY", "sensorDirectionZ"];
            let direction = DVec3::from_array(names.map(|name| reading.number(element, name)));
            if direction == DVec3::ZERO {
                reading.problem(element.at(), "a camera looks along (0, 0, 0)");
            }
            Some(angles_deg(direction))
        }
        1 => {
            let element = reading.child(view, "SensorAngleDirection")?;
            Some([reading.number(element, zenith), full_turn(reading.number(element, "sensorDirectionPhi"))])
        }
        _ => {
            reading.note(Fate::Dropped, view.at(), "a camera turned by yaw, pitch and roll");
            None
        }
    }
}

/// A camera in the scene, before 5.10.
fn inside(element: &Element, reading: &mut Reading) -> Option<Pinhole> {
    if reading.integer_or(element, "sensorConfiguration", 0) != 0 {
        reading.note(Fate::Dropped, element.at(), "a camera that is not a frame camera (hemisphere, orthographic)");
        return None;
    }
    let configuration = reading.child(element, "InsideSensorConfiguration")?;
    let position_m = position(reading.child(configuration, "SensorCentralPosition")?, reading);
    let view = reading.child(configuration, "SensorView")?;
    let look_deg = look(view, "sensorDirectionTetha", reading)?;
    let image = reading.child(element, "Image")?;
    let dimensions = reading.child(image, "SensorDimensions")?;
    let focal = reading.child(image, "FocaleDistance")?;
    let resolution = reading.child(image, "ImageResolution")?;
    Some(Pinhole {
        position_m,
        look_deg,
        roll_deg: roll(image.child("SensorOrientation"), "tethaOrientation", reading),
        field_of_view_deg: from_focal_length(dimensions, focal, reading),
        pixels: pixels(resolution, ["nbPixelsWidth", "nbPixelsHeight"], reading),
        at: element.at(),
    })
}

/// A camera from 5.10 on.
fn sensor(element: &Element, reading: &mut Reading) -> Option<Pinhole> {
    if reading.flag(element, "sensorDisabled") {
        reading.note(Fate::Dropped, element.at(), "a camera that is switched off: DART ignores it too");
        return None;
    }
    if reading.integer_or(element, "sensorConfiguration", 0) != 0 {
        reading.note(Fate::Dropped, element.at(), "a camera that is not a frame camera (hemisphere, orthographic)");
        return None;
    }
    let common = reading.child(element, "SensorCommonConfiguration")?;
    let position_m = position(reading.child(common, "SensorPosition")?, reading);
    let look_deg = look(reading.child(common, "SensorView")?, "sensorDirectionTheta", reading)?;
    let frame = reading.child(element, "Pinhole")?;
    let field_of_view_deg = if reading.integer_or(frame, "fieldOfViewDefinition", 1) == 1 {
        angles_of_view(reading.child(frame, "FieldOfView")?, ["aovWidth", "aovHeight"], reading)
    } else {
        let dimensions = reading.child(frame, "SensorDimensions")?;
        from_focal_length(dimensions, reading.child(frame, "FocaleDistance")?, reading)
    };
    let resolution = reading.child(frame, "ImageResolution")?;
    Some(Pinhole {
        position_m,
        look_deg,
        roll_deg: roll(common.child("SensorOrientation"), "orientationAngle", reading),
        field_of_view_deg,
        pixels: pixels(resolution, ["nbPixelsWidth", "nbPixelsHeight"], reading),
        at: element.at(),
    })
}
