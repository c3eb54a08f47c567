//! Whole scenes that have a closed form: they go through the product's own solving and integrating.

use std::f64::consts::PI;

use glam::DVec3;

use super::closed_forms::lambert_sphere_phase;
use super::{By, Row, Verdict, patch};
use crate::error::{Error, Location, Result};
use crate::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose, index_u32};
use crate::integrate;
use crate::progress::unwatched;
use crate::scene::{Exposure, Material, Models, Photometry, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal};
use crate::spectral::{Band, Spectrum, solar_e490};
use crate::study::simulate;
use crate::units::AU_M;
use crate::visibility::Topology;
use crate::visibility::{Seen, Shown};

/// Table I of Domagala (2020): spacecraft, Sun and target in the body-fixed frame of Phobos, m.
const SPACECRAFT_M: DVec3 = DVec3::new(-20159.4581, 87145.4911, 3.7671);
const SUN_M: DVec3 = DVec3::new(3.992e10, 2.1812e11, 1.1501e10);
const TARGET_M: DVec3 = DVec3::new(-2743.5946, 11860.036, 0.51269);

/// All cases.
pub(super) fn rows() -> Result<Vec<Row>> {
    let mut rows = vec![flat_plane()?];
    for phase_deg in [0.0, 60.0, 120.0] {
        rows.push(lambert_sphere(phase_deg)?);
    }
    for incidence_deg in [60.0, 85.0] {
        rows.push(shadow_of_a_box(incidence_deg)?);
    }
    Ok(rows)
}

fn row(name: String, unit: &str, expected: f64, got: f64, tolerance: f64, source: &str) -> Row {
    let passes = (got - expected).abs() <= tolerance * expected.abs();
    Row {
        group: "product".to_owned(),
        name,
        expected: Some(expected),
        got: Some(got),
        tolerance: format!("{tolerance:e} rel"),
        by: Some(By::Simulate),
        verdict: if passes { Verdict::Pass } else { Verdict::Fail },
        unit: unit.to_owned(),
        source: source.to_owned(),
    }
}

/// A plane of reflectance 0.07 in the geometry of Table I, lit by the Sun alone: every pixel has the same radiance.
fn flat_plane() -> Result<Row> {
    let up = direction(TARGET_M)?;
    let (east, north) = up.frame();
    let corners_m = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| 1000.0 * (x * east + y * north));
    let towards_m = SUN_M - TARGET_M;
    let sun = Sun {
        direction: direction(towards_m)?,
        distance_m: towards_m.length(),
        irradiance_1au: solar_e490().clone(),
        total_irradiance_1au_w_m2: 1366.1,
        limb_darkening: 0.0,
    };
    let camera = camera(SPACECRAFT_M - TARGET_M, 8, 1e-3)?;
    let cube = look(mesh(&corners_m, &[[0, 1, 2], [0, 2, 3]]), 0.07, sun, camera)?;
    let expected = 6.933_166_079_105;
    let far = |l: &f64| (l - expected).abs();
    let worst = cube.into_iter().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(f64::NAN);
    let source = "rho E490(1 um) / d^2 cos i / pi, direction and distance from the target; computed independently";
    Ok(row("flat plane of Table I, worst of 64 pixels".into(), "W m-2 sr-1 um-1", expected, worst, 1e-10, source))
}

/// Light of a whole Lambert sphere, over that at phase 0: 3/2 of the mean of cos i over its disc.
fn lambert_sphere(phase_deg: f64) -> Result<Row> {
    const RINGS: u32 = 64;
    const PIXELS: u32 = 32;
    let (radius_m, distance_m) = (1000.0, 1e9);
    let (sin, cos) = phase_deg.to_radians().sin_cos();
    // One over pi of this is reflected, so that radiance is cos i.
    let sun = Sun {
        direction: direction(DVec3::new(sin, 0.0, cos))?,
        distance_m: AU_M,
        irradiance_1au: Spectrum::constant(PI),
        total_irradiance_1au_w_m2: 1366.1,
        limb_darkening: 0.0,
    };
    let pixel_m = 2.2 * radius_m / f64::from(PIXELS);
    let camera = camera(distance_m * DVec3::Z, PIXELS, pixel_m / distance_m)?;
    let cube = look(sphere(radius_m, RINGS), 1.0, sun, camera)?;
    let got = 1.5 * cube.iter().sum::<f64>() * pixel_m * pixel_m / (PI * radius_m * radius_m);
    let source = "[sin a + (pi - a) cos a] / pi; sphere of 16128 facets";
    Ok(row(format!("Lambert sphere, phase {phase_deg} deg"), "1", lambert_sphere_phase(phase_deg), got, 2e-3, source))
}

/// Dark ground about a box that stands on it: its foot and its shadow.
fn shadow_of_a_box(incidence_deg: f64) -> Result<Row> {
    let (low_m, high_m) = (DVec3::new(-3.0, -2.0, -1.0), DVec3::new(2.0, 4.0, 5.0));
    let ground =
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(100.0 * x, 100.0 * y, 0.0));
    let mut scene = mesh(&ground, &[[0, 1, 2], [0, 2, 3]]);
    scene.append(cuboid(low_m, high_m));
    let (sin, cos) = incidence_deg.to_radians().sin_cos();
    let (sin_azimuth, cos_azimuth) = 33f64.to_radians().sin_cos();
    let towards = direction(DVec3::new(sin * cos_azimuth, sin * sin_azimuth, cos))?;
    let sunlit = Seen::from_afar(&scene, &Topology::new(&scene), towards, "sunlight", &unwatched)?;
    let dark_m2 = (0..2).map(|f| (1.0 - sunlit.fraction(f)) * scene.facet(f as usize).area_m2()).sum();
    let [x, y, _] = (high_m - low_m).to_array();
    // The foot, swept by height x tan i along the Sun's azimuth.
    let expected_m2 = x * y + high_m.z * (sin / cos) * (x * sin_azimuth + y * cos_azimuth);
    let source = "w d + h tan i (w |sin a| + d |cos a|)";
    Ok(row(format!("shadow of a box, incidence {incidence_deg} deg"), "m2", expected_m2, dark_m2, 1e-9, source))
}

/// Share of each pixel (row, column; a unit square from (column, row)) that a convex polygon covers.
pub(super) fn coverage(polygon: &[[f64; 2]], columns: u32, rows: u32) -> Vec<Vec<f64>> {
    // Axes of the image, and a distance of 1.
    let camera = FrameCamera::centred(Pose::IDENTITY, columns, rows, 1.0);
    let [x0, y0] = camera.boresight_px;
    let corners_m: Vec<DVec3> = polygon.iter().map(|[x, y]| DVec3::new(x - x0, y - y0, 1.0)).collect();
    let fan: Vec<[u32; 3]> = (2..index_u32(corners_m.len())).map(|i| [0, i - 1, i]).collect();
    let mesh = mesh(&corners_m, &fan);
    let dark = Seen { shown: vec![Shown::Nothing; fan.len()], polygon_start: vec![0], ..Seen::default() };
    let footprints = integrate::footprints(&mesh, &Topology::new(&mesh), &dark, &camera);
    let (columns, rows) = (columns as usize, rows as usize);
    (0..rows).map(|row| (0..columns).map(|column| footprints.coverage(row * columns + column)).collect()).collect()
}

/// Radiance of every pixel at 1 um by the Sun alone, W m-2 sr-1 um-1.
fn look(mesh: Mesh, reflectance: f64, sun: Sun, camera: FrameCamera) -> Result<Vec<f64>> {
    let material = Material {
        name: "plain".to_owned(),
        reflectance: Spectrum::constant(reflectance),
        photometry: Photometry::Lambert,
        emissivity: Spectrum::constant(1.0 - reflectance),
        bond_albedo: reflectance,
        emissivity_bolometric: 0.95,
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: vec![(0, 1.0)],
    };
    let bands = vec![Band::new(1.0, None)];
    let parts = SceneParts {
        surface: Surface { origin_m: TARGET_M, mesh, materials: vec![material], textures: vec![] },
        sky: Sky { sun, mars: None, bodies: vec![], beams: vec![], rotation: None, past: None },
        exposure: Exposure {
            instrument: "frame camera".to_owned(),
            camera,
            bands,
            spectrometer: Spectrometer::default(),
        },
        models: Models { thermal: Thermal::Off, ..Models::default() },
    };
    let (_, observation) = simulate(&parts.check()?, &unwatched)?;
    Ok(observation.cube.band(0))
}

fn direction(v: DVec3) -> Result<Direction> {
    Direction::new(v).ok_or_else(|| Error::invalid(Location::item("direction"), "has no length"))
}

fn camera(from_m: DVec3, pixels: u32, pitch: f64) -> Result<FrameCamera> {
    patch::camera(from_m, pixels, pitch).ok_or_else(|| Error::invalid(Location::item("camera"), "is at the origin"))
}

fn mesh(vertices_m: &[DVec3], facets: &[[u32; 3]]) -> Mesh {
    Mesh {
        vertices_m: vertices_m.to_vec(),
        facets: facets.to_vec(),
        material: vec![MaterialId(0); facets.len()],
        face_of_facet: vec![],
        uv: vec![],
    }
}

/// A sphere by rings of latitude, twice as many steps of longitude: 4 rings (rings - 1) facets.
fn sphere(radius_m: f64, rings: u32) -> Mesh {
    let steps = 2 * rings;
    let at = |ring: u32, step: u32| {
        let (sin, cos) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
        let (sin_longitude, cos_longitude) = (PI * f64::from(step) / f64::from(rings)).sin_cos();
        radius_m * DVec3::new(sin * cos_longitude, sin * sin_longitude, cos)
    };
    let vertices_m: Vec<DVec3> = (0..=rings).flat_map(|ring| (0..steps).map(move |step| at(ring, step))).collect();
    let mut facets = Vec::new();
    for ring in 0..rings {
        for step in 0..steps {
            let [a, d] = [step, (step + 1) % steps].map(|step| ring * steps + step);
            let (b, c) = (a + steps, d + steps);
            if ring + 1 < rings {
                facets.push([a, b, c]);
            }
            if ring > 0 {
                facets.push([a, c, d]);
            }
        }
    }
    mesh(&vertices_m, &facets)
}

fn cuboid(low_m: DVec3, high_m: DVec3) -> Mesh {
    let corner = |n: u32| DVec3::select(glam::BVec3::new(n & 1 > 0, n & 2 > 0, n & 4 > 0), high_m, low_m);
    let corners_m: Vec<DVec3> = (0..8).map(corner).collect();
    // Bottom, top, and the four sides, counter-clockwise seen from outside.
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let facets: Vec<[u32; 3]> = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh(&corners_m, &facets)
}
