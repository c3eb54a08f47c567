//! Oracles of meshes of bodies: their size, what they show and catch of parallel light, and where rays meet them.

use glam::DVec3;
use serde_json::{Value, json};

use super::values::{reference, simulate, vector};
use super::{Answer, Oracle};
use crate::geometry::Mesh;
use crate::visibility::RayTree;

/// What gives the mesh of a file of this name, in the file's own unit, if it is there.
pub type Shapes<'a> = dyn Fn(&str) -> Option<Mesh> + 'a;

/// Rays begin so far from the centre, km.
const FROM_KM: f64 = 100.0;

impl Oracle<'_> {
    pub(super) fn shape(&self, kind: &str) -> Option<Vec<Answer>> {
        // A name like "body.obj/.bds" is of one shape in two forms.
        let file = self.inputs.get("file")?.as_str()?;
        let mesh = (self.files?.shapes)(file.split_once("/.").map_or(file, |(name, _)| name))?;
        if kind.starts_with("ray_intercepts") { self.ray_intercepts(&mesh) } else { self.mesh(&mesh) }
    }

    /// Where rays towards the centre first meet the surface: longitudes and latitudes are those that are expected.
    fn ray_intercepts(&self, mesh: &Mesh) -> Option<Vec<Answer>> {
        let tree = RayTree::new(mesh);
        let met = |place: &Value| {
            let [longitude, latitude] = ["lon_deg", "lat_deg"].map(|key| Some(place.get(key)?.as_f64()?.to_radians()));
            let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (longitude?.sin_cos(), latitude?.sin_cos());
            let outward = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
            let from_km = FROM_KM * outward;
            let hit = tree.nearest(from_km, -outward)?;
            let point_km = from_km - hit.t * outward;
            Some(json!({
                "lon_deg": place.get("lon_deg"),
                "lat_deg": place.get("lat_deg"),
                "plate": hit.facet + 1,
                "point_km": point_km.to_array(),
                "radius_km": point_km.length(),
                "plate_normal": mesh.facet(hit.facet as usize).cross_m2().normalize().to_array(),
            }))
        };
        Some(simulate(Value::from_iter(self.expected.as_array()?.iter().map(met).collect::<Option<Vec<Value>>>()?)))
    }

    /// Sums over facets, and over tetrahedra between them and the origin.
    fn mesh(&self, mesh: &Mesh) -> Option<Vec<Answer>> {
        let facets = || (0..mesh.facets.len()).map(|facet| mesh.facet(facet));
        let volume = |[a, b, c]: [DVec3; 3]| a.dot(b.cross(c)) / 6.0;
        let volume_km3: f64 = facets().map(|facet| volume(facet.corners_m)).sum();
        let moment: DVec3 =
            facets().map(|facet| volume(facet.corners_m) * 0.25 * facet.corners_m.into_iter().sum::<DVec3>()).sum();
        let areas_km2 = || facets().map(|facet| 0.5 * facet.cross_m2());
        let [view, sun] = ["view", "sun"].map(|key| vector(self.inputs.get(key)?));
        let (view, sun) = (view?, sun?);
        let lit = |area: DVec3| {
            let size = area.length();
            if size > 0.0 { area.dot(view).max(0.0) * area.dot(sun).max(0.0) / size } else { 0.0 }
        };
        let extreme = |of: fn(f64, f64) -> f64| areas_km2().map(DVec3::length).reduce(of);
        // The sum of all areas with their directions is 0, and what is expected of it is the rounding of a sum: no answer.
        Some(reference(json!({
            "vertices": mesh.vertices_m.len(),
            "facets": mesh.facets.len(),
            "volume_km3": volume_km3,
            "area_km2": areas_km2().map(DVec3::length).sum::<f64>(),
            "centroid_km": (moment / volume_km3).to_array(),
            "sum_visible_facet_projected_area_km2": areas_km2().map(|area| area.dot(view).max(0.0)).sum::<f64>(),
            "sum_lit_visible_mu0_mu_dA_no_shadow_km2": areas_km2().map(lit).sum::<f64>(),
            "facet_area_min_km2": extreme(f64::min),
            "facet_area_max_km2": extreme(f64::max),
        })))
    }
}
