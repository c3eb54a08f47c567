//! The believed ray of a pixel, and where it meets the believed surface.

use glam::{DMat3, DQuat, DVec3};

use super::{Deviation, Knowledge, PositionAxes};
use crate::error::{Error, Location, Result};
use crate::flight::Epoch;
use crate::geometry::{Direction, FrameCamera, Mesh, body_from_site};
use crate::study::locate::{Locator, Now, Place};
use crate::visibility::RayTree;

/// A believed camera.
pub(super) struct Believed {
    now: Now,
    focal_length: f64,
}

/// A ray: local, m, and a direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub(super) from_m: DVec3,
    pub(super) along: DVec3,
}

/// A surface, and the tree that finds its facets.
pub(super) struct Ground<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) tree: &'a RayTree,
}

/// A point of a surface, local, m, and the normal of its facet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Met {
    pub(super) point_m: DVec3,
    pub(super) normal: DVec3,
}

impl Believed {
    /// The camera that takes a place in a band.
    pub(super) fn new(
        locator: &Locator<'_>,
        knowledge: &Knowledge,
        (place, band): (Place, usize),
        by: &Deviation,
    ) -> Result<Self> {
        if by.clock_s != 0.0 && locator.motion.is_none() {
            let message = "`clock` needs a scene with `[flight]`: add one, or leave `clock` out";
            return Err(Error::invalid(Location::item("clock"), message));
        }
        let Now { camera, epoch } = locator.camera_later(place, band, by.clock_s)?;
        let mut pose = camera.world_from_sensor;
        if by.position_m != DVec3::ZERO {
            let from_centre_m = pose.translation_m + locator.scene.body.origin_m;
            let axes = match knowledge.axes {
                PositionAxes::Body => DMat3::IDENTITY,
                PositionAxes::Track => track(locator, epoch, from_centre_m)?,
            };
            pose.translation_m += axes * by.position_m;
        }
        pose.rotation *= DMat3::from_quat(DQuat::from_scaled_axis(by.attitude_rad));
        let camera = FrameCamera { world_from_sensor: pose, ..camera };
        Ok(Believed { now: Now { camera, epoch }, focal_length: 1.0 + by.focal_length })
    }

    /// Through a place of the image: a longer focal length makes angles smaller.
    pub(super) fn sight(&self, locator: &Locator<'_>, place: Place) -> Sight {
        let boresight = self.now.camera.world_from_sensor.rotation.z_axis;
        let ray = locator.ray(&self.now, place);
        Sight { from_m: self.now.camera.centre_m(), along: boresight + (ray - boresight) / self.focal_length }
    }
}

/// Along-track, cross-track and radial axes as columns, body-fixed.
fn track(locator: &Locator<'_>, epoch: Option<Epoch>, from_centre_m: DVec3) -> Result<DMat3> {
    let refused = |why: &str| {
        Err(Error::invalid(Location::item("position.axes"), format!("{why}; or use axes = \"body\" and give x, y, z")))
    };
    let (Some((motion, _)), Some(epoch)) = (locator.motion, epoch) else {
        return refused("axes = \"track\" needs a moving camera (`[flight]`)");
    };
    let velocity = motion.velocity_m_s(epoch, from_centre_m)?;
    let (Some(radial), Some(across)) = (Direction::new(from_centre_m), Direction::new(from_centre_m.cross(velocity)))
    else {
        return refused("axes = \"track\" needs a ground track: the camera does not move, or moves along the radius");
    };
    Ok(DMat3::from_cols(across.vec().cross(radial.vec()), across.vec(), radial.vec()))
}

impl Ground<'_> {
    /// Where a ray first meets this surface, raised by a height.
    pub(super) fn met(&self, sight: &Sight, raised_m: DVec3) -> Option<Met> {
        // A lens shows nothing beyond its fold.
        let hit = self.tree.nearest(sight.from_m - raised_m, sight.along).filter(|_| sight.along.is_finite())?;
        let normal = self.mesh.facet(hit.facet as usize).cross_m2();
        Some(Met { point_m: sight.from_m + hit.t * sight.along, normal })
    }
}

impl Met {
    /// Where a ray meets the plane of a facet, raised by a height.
    pub(super) fn on_plane(&self, sight: &Sight, raised_m: DVec3) -> DVec3 {
        let t = self.normal.dot(self.point_m + raised_m - sight.from_m) / self.normal.dot(sight.along);
        sight.from_m + t * sight.along
    }
}

/// East, north and up at a local point as columns; at the body's centre, where they are undefined, the body axes.
pub(super) fn site(locator: &Locator<'_>, local_m: DVec3) -> DMat3 {
    body_from_site(local_m + locator.scene.body.origin_m).unwrap_or(DMat3::IDENTITY)
}
