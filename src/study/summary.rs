//! What a scene is, in a few numbers.

use glam::DVec3;
use serde::Serialize;

use super::site::Site;
use crate::geometry::angle_rad;
use crate::scene::Scene;
use crate::units::AU_M;

/// A scene in a few numbers. Angles at the scene's origin, deg; "level" is square to the outward radius there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Facets of all meshes.
    pub facets: usize,
    /// Vertices of all meshes.
    pub vertices: usize,
    /// Edges with a facet on one side only.
    pub open_edges: usize,
    /// Facets whose neighbours have the other side out.
    pub flipped_facets: usize,
    /// Facets without area.
    pub zero_area_facets: u64,
    /// Extents of the meshes along the axes of the body, m.
    pub size_m: [f64; 3],
    /// From the origin to the Sun, au.
    pub sun_distance_au: f64,
    /// Elevation of the Sun above level ground; `None` if the origin is the body's centre.
    pub sun_elevation_deg: Option<f64>,
    /// Incidence of sunlight on the mean surface; `None` for a closed body.
    pub mean_incidence_deg: Option<f64>,
    /// Between the directions to Sun and camera.
    pub phase_deg: f64,
    /// Angle of the camera from the zenith; `None` if the origin is the body's centre.
    pub emission_deg: Option<f64>,
    /// From the camera to the origin, m.
    pub range_m: f64,
    /// Elevation of the centre of Mars above level ground; `None` without Mars or level ground.
    pub mars_elevation_deg: Option<f64>,
    /// Angular radius of Mars; `None` without Mars.
    pub mars_radius_deg: Option<f64>,
    /// Angle that the central pixel subtends, mrad.
    pub ifov_mrad: f64,
    /// Width of a pixel at the origin's distance, square to the line of sight, m.
    pub pixel_m: f64,
    /// Width and height of the image there, m.
    pub image_m: [f64; 2],
}

pub(super) fn summary(scene: &Scene, site: &Site) -> Summary {
    let camera = &scene.exposure.camera;
    let (towards_sun, eye_m) = (scene.sky.sun.direction.vec(), camera.centre_m());
    let from_zenith =
        |v: DVec3| (scene.body.origin_m != DVec3::ZERO).then(|| angle_rad(scene.body.origin_m, v).to_degrees());
    let elevation = |v: DVec3| from_zenith(v).map(|angle| 90.0 - angle);
    let pixel_m = camera.mean_pitch() * eye_m.length();
    let (low_m, high_m) = site.box_m;
    Summary {
        facets: scene.body.mesh.facets.len(),
        vertices: scene.body.mesh.vertices_m.len(),
        open_edges: scene.body.topology().open_edges,
        flipped_facets: scene.body.topology().flipped_facets,
        zero_area_facets: site.zero_area_facets,
        size_m: (high_m - low_m).to_array(),
        sun_distance_au: scene.sky.sun.distance_m / AU_M,
        sun_elevation_deg: elevation(towards_sun),
        mean_incidence_deg: site.up.map(|up| angle_rad(up, towards_sun).to_degrees()),
        phase_deg: angle_rad(eye_m, towards_sun).to_degrees(),
        emission_deg: from_zenith(eye_m),
        range_m: eye_m.length(),
        mars_elevation_deg: scene.sky.mars.as_ref().and_then(|mars| elevation(mars.centre_m)),
        mars_radius_deg: scene.sky.mars.as_ref().map(|m| (m.radius_m / m.centre_m.length()).asin().to_degrees()),
        ifov_mrad: 1e3 * camera.ifov_rad(),
        pixel_m,
        image_m: [f64::from(camera.samples) * pixel_m, f64::from(camera.lines) * pixel_m],
    }
}
