//! Where a scene stands in a simulation's frame.

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Problem, Result};
use crate::geometry::Pose;
use crate::scene::Scene;

use super::folder::Folder;
use super::frame;
use super::sidecar::{self, Sidecar};
use super::simulation::{Maket, Simulation};

/// Two numbers that went through a text, or through percent, are the same within this, relative.
pub(super) const SAME: f64 = 1e-12;

pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

pub(super) fn same_all(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(*a, *b))
}

/// The scene's frame in DART's.
pub(super) struct SceneFrame {
    pub(super) origin_m: DVec3,
    pub(super) dart_from_body: DMat3,
    pub(super) origin_in_dart_m: DVec3,
    /// As `mmxrt.toml` has it, whose body-fixed vectors so mean the same.
    pub(super) is_kept: bool,
}

impl SceneFrame {
    /// As `mmxrt.toml` has it, unless an origin is given, or DART's scene is now elsewhere; else the origin, or the body's
    /// centre, is the middle of the scene's ground.
    pub(super) fn of(maket: &Maket, sidecar: Option<&Sidecar>, origin_m: Option<DVec3>) -> Self {
        if let (Some(sidecar), None) = (sidecar, origin_m) {
            let origin_m = DVec3::from_array(sidecar.origin_m);
            if same_all(&frame::latitude_longitude_altitude(origin_m), &maket.latitude_longitude_altitude) {
                let origin_in_dart_m = DVec3::from_array(sidecar.origin_in_dart_m);
                let dart_from_body = frame::dart_from_body(origin_m);
                return SceneFrame { origin_m, dart_from_body, origin_in_dart_m, is_kept: true };
            }
        }
        let origin_m = origin_m.unwrap_or(DVec3::ZERO);
        let [x, y] = maket.size_m;
        SceneFrame {
            origin_m,
            dart_from_body: frame::dart_from_body(origin_m),
            origin_in_dart_m: DVec3::new(0.5 * x, 0.5 * y, 0.0),
            is_kept: false,
        }
    }

    pub(super) fn local_m(&self, dart_m: DVec3) -> DVec3 {
        self.dart_from_body.transpose() * (dart_m - self.origin_in_dart_m)
    }

    fn scene_from_dart(&self) -> Pose {
        placed(self.origin_m, self.origin_in_dart_m)
    }
}

/// DART's frame in that of a scene whose origin, `origin_m` in the body-fixed frame, is at `origin_in_dart_m` there: x South, y East, z up.
pub fn placed(origin_m: DVec3, origin_in_dart_m: DVec3) -> Pose {
    let rotation = frame::dart_from_body(origin_m).transpose();
    Pose { rotation, translation_m: -(rotation * origin_in_dart_m) }
}

/// DART's frame (x down the image, y to its right, z up, m, from the scene's corner) in that of `scene`, if one of the two was
/// made of the other: the scene of the simulation by [`to_scene`](super::to_scene()), or the simulation, with `mmxrt.toml`
/// beside it, of the scene by [`from_scene`](super::from_scene()).
///
/// # Errors
/// [`Error::Invalid`] if `mmxrt.toml` is of a scene with another `origin_m`; as [`Sidecar::read`].
pub fn scene_from_dart(simulation: &Simulation, folder: &Folder, scene: &Scene) -> Result<Pose> {
    let path = folder.simulation.join(sidecar::FILE);
    let sidecar = Sidecar::read(&path)?.map(|(sidecar, _)| sidecar);
    let kept = SceneFrame::of(&simulation.maket, sidecar.as_ref(), None);
    if !kept.is_kept {
        return Ok(SceneFrame::of(&simulation.maket, None, Some(scene.body.origin_m)).scene_from_dart());
    }
    if !same_all(&kept.origin_m.to_array(), &scene.body.origin_m.to_array()) {
        let message = format!(
            "the simulation was made of a scene with the origin {:?}, that of this scene is {:?}",
            kept.origin_m.to_array(),
            scene.body.origin_m.to_array()
        );
        let help = "give the scene that the simulation was made of or into, or the placement `scene_from_dart`";
        return Err(Error::Invalid(vec![
            Problem::new(Location::file(&path).with_item("origin_m"), message).with_help(help),
        ]));
    }
    Ok(kept.scene_from_dart())
}
