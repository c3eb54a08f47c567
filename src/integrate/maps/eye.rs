//! What the eye of a map, the camera that took it, sees of the scene.

use super::MapView;
use crate::error::Result;
use crate::geometry::polygon::Rect;
use crate::geometry::{Camera, Direction};
use crate::integrate::parts::Polygons;
use crate::product::{Placement, ViewImage};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::visibility::Seen;

/// What a map's eye sees of each facet; `None` if it has none, or sees through everything. Cameras that look at the map share it.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn seen_by_eye(placement: &Placement, scene: &Scene, watch: Watch<'_>) -> Result<Option<Seen>> {
    match placement {
        Placement::View(image) if image.occlusion => seen_by(image, scene, watch).map(Some),
        _ => Ok(None),
    }
}

fn seen_by(image: &ViewImage, scene: &Scene, watch: Watch<'_>) -> Result<Seen> {
    const STAGE: &str = "what the map sees";
    let (mesh, topology) = (&scene.body.mesh, scene.body.topology());
    match &image.camera {
        Camera::Parallel(camera) => Seen::from_afar(mesh, topology, camera.towards, STAGE, watch),
        Camera::Frame(camera) => {
            let camera = camera.drawn().pinhole;
            let axis = camera.world_from_sensor.rotation.z_axis;
            let axis = Direction::new(axis).unwrap_or(scene.sky.sun.direction);
            let [samples, lines] = [camera.samples, camera.lines].map(f64::from);
            let corners = [[0.0, 0.0], [samples, 0.0], [samples, lines], [0.0, lines]];
            let rays = corners.map(|[x, y]| camera.ray(x, y));
            Seen::from_point(mesh, topology, camera.centre_m(), (axis, &rays), STAGE, watch)
        }
    }
}

impl<'a> MapView<'a> {
    /// The polygons on facets that the map is made of, or that it sees.
    pub(in crate::integrate) fn polygons(&self, facets: usize) -> Option<Polygons<'a>> {
        match (self.placement, self.eye) {
            (Placement::Patches(patches), _) => Some(Polygons::of_patches(facets, patches)),
            (_, Some(seen)) => Some(Polygons::of_seen(seen)),
            _ => None,
        }
    }
}

/// Whether some facet of a scene lies, in part, within an image of it: its bounds do.
pub fn meets(image: &ViewImage, scene: &Scene) -> bool {
    let camera = image.camera.drawn();
    let frame = Rect { min: [0.0; 2], max: camera.size().map(f64::from) };
    let projection = camera.projection();
    (0..scene.body.mesh.facets.len()).any(|f| {
        let corners = scene.body.mesh.facet(f).corners_m.map(|p| projection.homogeneous(p));
        let in_front = corners.iter().filter(|c| c.z > 0.0).count();
        // What reaches behind the eye may be anywhere.
        in_front > 0 && (in_front < 3 || Rect::of(&corners.map(|c| [c.x / c.z, c.y / c.z])).overlaps(&frame))
    })
}
