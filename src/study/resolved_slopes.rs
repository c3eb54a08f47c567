//! Whether a mesh has the slopes that a roughness parameter stands for, so that they count twice.

use glam::DVec3;

use crate::geometry::Mesh;
use crate::physics::reflectance::hapke::{Parameters, Roughness};
use crate::physics::reflectance::{Parameter, Shape};
use crate::random::{STEP, mix};
use crate::scene::{Material, Setup};

/// What fitted mean slopes stand for: slopes at lengths below the pixels of the images they were fitted to, some tens to hundreds of metres, m.
const FITTED_BELOW_M: f64 = 100.0;
/// A mesh with at least this share of a roughness's slope is reported: less changes what is left below the facets by 6 % of it.
const NOTEWORTHY: f64 = 1.0 / 3.0;
/// About so many facets are looked at.
const SAMPLE: usize = 1 << 16;

/// A sentence for each material whose roughness the mesh resolves in part.
pub(super) fn warnings(scene: &Setup) -> Vec<String> {
    let roughness = |material: &Material| match material.photometry.model()?.shape {
        Shape::Hapke(Parameters { roughness, .. }) => Some(roughness).filter(|of| *of != Roughness::SMOOTH),
        _ => None,
    };
    let rough: Vec<(&str, Roughness)> =
        scene.body.materials.iter().filter_map(|m| Some((m.name.as_str(), roughness(m)?))).collect();
    if rough.is_empty() {
        return vec![];
    }
    let Some(of_mesh) = mean_slope(&scene.body.mesh, FITTED_BELOW_M) else { return vec![] };
    let mesh_deg = of_mesh.mean_slope_rad().to_degrees();
    let told = |(name, roughness): (&str, Roughness)| {
        let theta_deg = roughness.mean_slope_rad().to_degrees();
        let rest_deg = roughness.without(&of_mesh).mean_slope_rad().to_degrees();
        let key = Parameter::MeanSlopeDeg.key();
        (mesh_deg > NOTEWORTHY * theta_deg).then(|| {
            format!(
                "slopes count twice: facets have a mean slope of {mesh_deg:.1} deg at lengths below {FITTED_BELOW_M} m, and the `{key}` of {name}, \
                 {theta_deg:.1}, comes on top: if it was fitted to images with such pixels, {rest_deg:.1} is what facets do not show"
            )
        })
    };
    rough.into_iter().filter_map(told).collect()
}

/// The mean slope of facets against their surroundings: the mean surface in cubes of this size, m. `None` without facets.
fn mean_slope(mesh: &Mesh, size_m: f64) -> Option<Roughness> {
    let every = (mesh.facets.len() / SAMPLE).max(1) as u64;
    let mut facets: Vec<(u64, u32)> = Vec::new();
    for (f, index) in (0..mesh.facets.len()).zip(0_u32..) {
        let cell = number((mesh.facet(f).centroid_m() / size_m).floor());
        // All facets of a cube, or none.
        if cell.is_multiple_of(every) {
            facets.push((cell, index));
        }
    }
    facets.sort_unstable();
    let (mut tangents, mut weights) = (0.0, 0.0);
    for cube in facets.chunk_by(|a, b| a.0 == b.0) {
        let cross_m2 = |(_, f): &(u64, u32)| mesh.facet(*f as usize).cross_m2();
        let mean = cube.iter().map(cross_m2).sum::<DVec3>().normalize_or_zero();
        for facet in cube {
            let cross_m2 = cross_m2(facet);
            let level_m2 = cross_m2.dot(mean);
            if level_m2 > 0.0 {
                tangents += cross_m2.reject_from_normalized(mean).length();
                weights += level_m2;
            }
        }
    }
    (weights > 0.0).then(|| Roughness::of_tangents(tangents / weights))
}

/// A cube's number, spread evenly over 64 bits.
fn number(cell: DVec3) -> u64 {
    cell.to_array().into_iter().fold(0, |hash: u64, x| mix((hash ^ x.to_bits()).wrapping_add(STEP)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MaterialId;

    /// Strips across x, 5 m wide, that go up and down by turns over a plane that itself rises along x.
    fn corrugated(slope_deg: f64, rise_deg: f64) -> Mesh {
        let rise = |i: u32| {
            let up = if i % 2 == 1 { 5.0 * f64::to_radians(slope_deg).tan() } else { 0.0 };
            let x = 5.0 * f64::from(i);
            let (s, c) = f64::to_radians(rise_deg).sin_cos();
            DVec3::new(c * x - s * up, 0.0, s * x + c * up)
        };
        let vertices_m: Vec<DVec3> =
            (0..=200).flat_map(|i| [rise(i) - 400.0 * DVec3::Y, rise(i) + 400.0 * DVec3::Y]).collect();
        let facets: Vec<[u32; 3]> =
            (0..200).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]]).collect();
        let count = facets.len();
        Mesh {
            vertices_m,
            material: vec![MaterialId(0); count],
            face_of_facet: (0..).take(count).collect(),
            facets,
            uv: vec![],
        }
    }

    #[test]
    fn strips_up_and_down_have_their_slope() {
        for rise_deg in [0.0, 30.0] {
            // tan theta-bar = (2 / pi) tan 20 deg; cubes at the ends may have one strip more up than down.
            let found = mean_slope(&corrugated(20.0, rise_deg), 100.0).unwrap().mean_slope_rad();
            let expected = (2.0 / std::f64::consts::PI * 20f64.to_radians().tan()).atan();
            assert!((found / expected - 1.0).abs() < 0.02, "{rise_deg}: {found} {expected}");
        }
        // A plane is level with its surroundings, however it lies, and cubes smaller than its strips see no slopes.
        assert!(mean_slope(&corrugated(0.0, 30.0), 100.0).unwrap().mean_slope_rad() < 1e-6);
        assert!(mean_slope(&corrugated(20.0, 0.0), 0.1).unwrap().mean_slope_rad() < 1e-6);
        assert!(mean_slope(&Mesh::default(), 100.0).is_none());
    }
}
