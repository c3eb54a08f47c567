//! Small scenes under the Sun alone, and their images.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Result};
use crate::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose, index_u32};
use crate::integrate;
use crate::progress::unwatched;
use crate::scene::{
    Exposure, Material, Models, Photometry, Scene, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal,
};
use crate::solve;
use crate::spectral::{Band, Spectrum};
use crate::units::AU_M;
use crate::visibility::Seen;

/// A direction, which these scenes know to be one.
pub(super) fn direction(v: DVec3) -> Result<Direction> {
    Direction::new(v).ok_or_else(|| Error::invalid(Location::item("stability"), format!("{v} has no direction")))
}

/// Towards a Sun at an incidence on level ground and an azimuth from x.
pub(super) fn sun(incidence_deg: f64, azimuth_deg: f64) -> Result<Direction> {
    let ((sin, cos), (sin_a, cos_a)) = (incidence_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    direction(DVec3::new(sin * cos_a, sin * sin_a, cos))
}

/// A camera that looks from a place at another one, x of the image square to `up`.
pub(super) fn camera(from_m: DVec3, at_m: DVec3, up: DVec3, pixels: u32, pitch: f64) -> Result<FrameCamera> {
    let u = direction(at_m - from_m)?.vec();
    let h = direction(u.cross(up))?.vec();
    let pose = Pose { rotation: DMat3::from_cols(h, u.cross(h), u), translation_m: from_m };
    Ok(FrameCamera::centred(pose, pixels, pixels, pitch))
}

/// A camera above the origin that sees `width_m` of level ground.
pub(super) fn above(height_m: f64, width_m: f64, pixels: u32) -> Result<FrameCamera> {
    camera(height_m * DVec3::Z, DVec3::ZERO, DVec3::Y, pixels, width_m / height_m / f64::from(pixels))
}

/// A mesh of one material.
pub(super) fn mesh(corners_m: &[DVec3], facets: &[[u32; 3]], material: u16) -> Mesh {
    Mesh {
        vertices_m: corners_m.to_vec(),
        facets: facets.to_vec(),
        material: vec![MaterialId(material); facets.len()],
        ..Mesh::default()
    }
}

/// Four corners, counter-clockwise from outside.
pub(super) fn quad(corners_m: [DVec3; 4], material: u16) -> Mesh {
    mesh(&corners_m, &[[0, 1, 2], [0, 2, 3]], material)
}

/// Level ground.
pub(super) fn ground(half_m: f64, material: u16) -> Mesh {
    quad([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| half_m * DVec3::new(x, y, 0.0)), material)
}

/// Level ground as n x n cells between two corners, of `height_m` where they meet.
pub(super) fn cells(low_m: [f64; 2], high_m: [f64; 2], n: [u32; 2], material: impl Fn(u32, u32) -> u16) -> Mesh {
    let mut mesh = Mesh::default();
    let at = |k: usize, i: u32| low_m[k] + (high_m[k] - low_m[k]) * f64::from(i) / f64::from(n[k]);
    for j in 0..=n[1] {
        mesh.vertices_m.extend((0..=n[0]).map(|i| DVec3::new(at(0, i), at(1, j), 0.0)));
    }
    for j in 0..n[1] {
        for i in 0..n[0] {
            let a = j * (n[0] + 1) + i;
            let (b, c, d) = (a + 1, a + n[0] + 2, a + n[0] + 1);
            mesh.facets.extend([[a, b, c], [a, c, d]]);
            mesh.material.extend([MaterialId(material(i, j)); 2]);
        }
    }
    mesh
}

/// A box without its foot.
pub(super) fn cuboid(low: DVec3, high: DVec3, material: u16) -> Mesh {
    let corner = |n: u8| DVec3::select(glam::BVec3::new(n & 1 > 0, n & 2 > 0, n & 4 > 0), high, low);
    let corners: Vec<DVec3> = (0..8).map(corner).collect();
    let facets =
        [[4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
    mesh(&corners, &facets, material)
}

/// A ball of 20 x 4^n facets.
pub(super) fn ball(centre_m: DVec3, radii_m: DVec3, rings: u32, material: u16) -> Mesh {
    let (n, around) = (rings, 2 * rings);
    let at = |ring: u32, i: u32| {
        let polar = PI * f64::from(ring) / f64::from(n);
        let turn = 2.0 * PI * f64::from(i % around) / f64::from(around);
        centre_m + radii_m * DVec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos())
    };
    let mut corners = vec![centre_m + radii_m * DVec3::Z, centre_m - radii_m * DVec3::Z];
    for ring in 1..n {
        corners.extend((0..around).map(|i| at(ring, i)));
    }
    let place = |ring: u32, i: u32| match ring {
        0 => 0,
        r if r == n => 1,
        r => 2 + (r - 1) * around + i % around,
    };
    let mut facets = Vec::new();
    for ring in 0..n {
        for i in 0..around {
            let [a, b, c, d] = [place(ring, i), place(ring + 1, i), place(ring + 1, i + 1), place(ring, i + 1)];
            if ring + 1 < n {
                facets.push([a, b, c]);
            }
            if ring > 0 {
                facets.push([a, c, d]);
            }
        }
    }
    mesh(&corners, &facets, material)
}

/// Several meshes as one.
pub(super) fn joined(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut all = Mesh::default();
    all.append_all(meshes);
    all
}

/// Irradiance normal to the Sun's beam, W m-2 um-1: pi, so that a white surface square to it has radiance 1.
const IRRADIANCE: f64 = PI;

/// A scene without heat, of Lambert materials of these reflectances: radiance is reflectance x cosine of incidence.
pub(super) fn scene(mesh: Mesh, reflectances: &[f64], sun: Direction, camera: FrameCamera) -> Result<Scene> {
    let material = |(i, reflectance): (usize, &f64)| Material {
        name: format!("m{i}"),
        reflectance: Spectrum::constant(*reflectance),
        photometry: Photometry::Lambert,
        emissivity: Spectrum::constant(1.0 - reflectance),
        bond_albedo: *reflectance,
        emissivity_bolometric: 0.95,
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: vec![(i, 1.0)],
    };
    SceneParts {
        surface: Surface {
            origin_m: DVec3::ZERO,
            mesh,
            materials: reflectances.iter().enumerate().map(material).collect(),
            textures: vec![],
        },
        sky: Sky {
            sun: Sun {
                direction: sun,
                distance_m: AU_M,
                irradiance_1au: Spectrum::constant(IRRADIANCE),
                total_irradiance_1au_w_m2: 1361.0,
                limb_darkening: 0.0,
            },
            mars: None,
            bodies: vec![],
            beams: vec![],
            rotation: None,
            past: None,
        },
        exposure: Exposure {
            instrument: "stability".into(),
            camera,
            bands: vec![Band::new(1.0, None)],
            spectrometer: Spectrometer::default(),
        },
        models: Models { thermal: Thermal::Off, ..Models::default() },
    }
    .check()
}

/// The image by what this program does.
pub(super) fn exact(scene: &Scene) -> Result<Vec<f64>> {
    let table = solve::solve(scene, &unwatched)?;
    of_table(scene, &table)
}

/// The image with other shadows.
pub(super) fn lit_by(scene: &Scene, sunlit: Seen) -> Result<Vec<f64>> {
    of_table(scene, &solve::solve_sunlit(scene, sunlit, &unwatched)?)
}

fn of_table(scene: &Scene, table: &crate::product::FacetTable) -> Result<Vec<f64>> {
    let slab = integrate::radiance(scene, table, &unwatched)?;
    let mut image = vec![0.0; slab.row_start.len() - 1];
    slab.expand(0..image.len(), 0..1, |pixel, _, values| image[pixel] = values[0]);
    Ok(image)
}

/// The image by rays.
pub(super) fn by_rays(scene: &Scene, rays: u32) -> Result<Vec<f64>> {
    Ok(crate::study::chart::by_rays(scene, rays, &unwatched)?.swap_remove(0))
}

/// A scene with its corners rounded to single precision.
pub(super) fn in_single(mesh: &Mesh) -> Mesh {
    let round = |v: &DVec3| crate::physics::thesis_projection::Precision::Single.round_each(*v);
    Mesh { vertices_m: mesh.vertices_m.iter().map(round).collect(), ..mesh.clone() }
}

/// The largest difference of two images, over the largest true value.
pub(super) fn worst(image: &[f64], truth: &[f64]) -> f64 {
    let brightest = truth.iter().copied().fold(0.0, f64::max);
    let off = image.iter().zip(truth).map(|(a, b)| (a - b).abs());
    off.fold(0.0, |worst: f64, off| if off.is_nan() { f64::INFINITY } else { worst.max(off) }) / brightest
}

/// Root of the mean square difference of two images, over the largest true value.
pub(super) fn rms(image: &[f64], truth: &[f64]) -> f64 {
    let brightest = truth.iter().copied().fold(0.0, f64::max);
    let sum: f64 = image.iter().zip(truth).map(|(a, b)| (a - b) * (a - b)).sum();
    (sum / image.len() as f64).sqrt() / brightest
}

/// 0, 1, 2 ... as facets count.
pub(super) fn facets(mesh: &Mesh) -> std::ops::Range<u32> {
    0..index_u32(mesh.facets.len())
}
