//! Whole bodies: a mesh inscribed in a smooth body is compared with the body's closed form, at the mesh's own error,
//! which goes as 1 / N: four times the facets, a quarter of the error.

use std::f64::consts::{PI, TAU};

use crate::shapes::*;
use glam::{DQuat, DVec3, EulerRot};
use mmxrt::geometry::{Direction, Mesh};
use serde_json::Value;

/// Facets of the meshes.
const FACETS: [f64; 3] = [1280.0, 5120.0, 20480.0];

/// Relative errors of the three meshes go as 1 / N.
///
/// A facet's corners lie on the sphere, its middle 4.8 R / N below: areas are off by some R / N.
fn assert_converges(what: &str, errors: [f64; 3]) {
    for (error, facets) in errors.iter().zip(FACETS) {
        assert!(error.abs() < 12.0 / facets, "{what}: {errors:?}");
    }
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..5.0).contains(&ratio), "{what}: {errors:?}");
    }
}

/// Mean relative error of each mesh over a few turns of it: where the terminator cuts through the facets is chance.
fn errors(expected: f64, got: impl Fn(&Mesh) -> f64) -> [f64; 3] {
    const TURNS: u32 = 8;
    let mut random = Random(4);
    let mut sums = [0.0; 3];
    for _ in 0..TURNS {
        let [a, b, c] = [(); 3].map(|()| TAU * random.share());
        let turn = DQuat::from_euler(EulerRot::ZYX, a, b, c);
        for (sum, splits) in sums.iter_mut().zip(3..) {
            let mut ball = sphere([0.0; 3], 1.0, splits);
            ball.vertices_m.iter_mut().for_each(|v| *v = turn * *v);
            *sum += got(&ball) / expected - 1.0;
        }
    }
    sums.map(|sum| sum / f64::from(TURNS))
}

/// So many radii away the view is parallel to 1e-6.
const FAR: f64 = 1e6;

/// Sums over an image of 64 x 64 pixels from far away, each in squares of the mesh's unit: area, lit area, lit area x cos i.
fn far_view(mesh: &Mesh, towards_sun: Direction, towards_observer: DVec3, width: f64) -> [f64; 3] {
    let from = FAR * width * towards_observer.normalize();
    let camera = camera(from.to_array(), [0.0; 3], [0.1, 0.2, 1.0], 64, 1.0 / FAR / 64.0);
    let seen = see(mesh, towards_sun, &camera);
    let pixel = (width / 64.0).powi(2);
    let f = &seen.footprints;
    let mut sums = [0.0; 3];
    for i in 0..f.facet.len() {
        let cos_i = mesh.facet(f.facet[i] as usize).normal().dot(towards_sun.vec());
        let parts = [f.fraction[i], f.lit_fraction[i], f.lit_fraction[i] * cos_i];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part * pixel);
    }
    sums
}

#[test]
fn a_lambert_sphere_shines_as_its_phase_function_says() {
    // I/F of the disc = (2/3) rho Phi, Phi = [sin a + (pi - a) cos a] / pi.
    let observer = DVec3::new(0.3, -0.5, 0.81).normalize();
    let aside = observer.cross(DVec3::new(0.2, 0.9, 0.1)).normalize();
    for phase_deg in [0.0, 60.0, 90.0, 120.0] {
        let phase = f64::to_radians(phase_deg);
        let sun = direction((phase.cos() * observer + phase.sin() * aside).to_array());
        let phi = (phase.sin() + (PI - phase) * phase.cos()) / PI;
        // An image of the unit sphere's disc, pi, at full I/F.
        let disc = PI * 2.0 / 3.0 * phi;
        let errors = errors(disc, |ball| far_view(ball, sun, observer, 2.1)[2]);
        assert_converges(&format!("phase {phase_deg} deg"), errors);
    }
}

/// An oracle of tests/data/oracles.json.
fn oracles(kind: &str) -> Vec<(Value, Value)> {
    let file: Value = serde_json::from_str(include_str!("../data/oracles.json")).unwrap();
    let list = file["oracles"].as_array().unwrap();
    let of_kind = |o: &&Value| o["name"].as_str().unwrap().split('(').next() == Some(kind);
    list.iter().filter(of_kind).map(|o| (o["inputs"].clone(), o["expected"].clone())).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| value[k].as_f64().unwrap()))
}

/// The ball, stretched.
fn ellipsoid(ball: &Mesh, radii: DVec3) -> Mesh {
    Mesh { vertices_m: ball.vertices_m.iter().map(|v| *v * radii).collect(), ..ball.clone() }
}

#[test]
fn an_ellipsoid_shows_its_projected_area() {
    let oracles = oracles("ellipsoid_projected_area");
    assert!(!oracles.is_empty());
    for (inputs, expected) in oracles {
        let (radii, view) = (vector(&inputs["radii_km"]), vector(&inputs["view"]));
        let area = |ball: &Mesh| far_view(&ellipsoid(ball, radii), sun(0.0, 0.0), view, 28.0)[0];
        assert_converges(&format!("view {view}"), errors(expected.as_f64().unwrap(), area));
    }
}

#[test]
fn an_ellipsoid_shows_its_lit_area() {
    let oracles = oracles("ellipsoid_lit_visible_projected_area");
    assert!(oracles.len() >= 2);
    for (inputs, expected) in oracles {
        let (radii, view) = (vector(&inputs["radii_km"]), vector(&inputs["view"]));
        let sun = direction(vector(&inputs["sun"]).to_array());
        let area = |ball: &Mesh| far_view(&ellipsoid(ball, radii), sun, view, 28.0)[1];
        let errors = errors(expected.as_f64().unwrap(), area);
        // The terminator is a zigzag of some sqrt(N) whole facets, each of 4 / N of the area, in or out by chance:
        // the sum of these scatters by 4 N^(-3/4).
        for (error, facets) in errors.iter().zip(FACETS) {
            assert!(error.abs() < 4.0 * facets.powf(-0.75), "view {view}: {errors:?}");
        }
    }
}

#[test]
fn an_ellipsoid_shines_as_its_integral() {
    let oracles = oracles("ellipsoid_disc_integrated");
    assert!(oracles.len() >= 3);
    for (inputs, expected) in oracles {
        let (radii, view) = (vector(&inputs["radii_km"]), vector(&inputs["view"]));
        let sun = direction(vector(&inputs["sun"]).to_array());
        let shine = |ball: &Mesh| far_view(&ellipsoid(ball, radii), sun, view, 28.0)[2];
        assert_converges(&format!("view {view}"), errors(expected["int_mu0_mu_dA"].as_f64().unwrap(), shine));
    }
}

#[test]
fn a_pinhole_draws_a_sphere_as_an_ellipse() {
    let oracles = oracles("pinhole_image_of_sphere");
    assert!(oracles.len() >= 3);
    for (inputs, expected) in oracles {
        let angle = |key: &str| inputs[key].as_f64().unwrap().to_radians();
        let distance = 1.0 / angle("angular_radius_deg").sin();
        let (sin, cos) = angle("offaxis_deg").sin_cos();
        // The camera at the origin looks along z; the ball is off its axis.
        let centre = DVec3::new(sin * distance, 0.0, cos * distance);
        let errors = errors(expected["area"].as_f64().unwrap(), |ball| {
            let mut ball = ball.clone();
            ball.vertices_m.iter_mut().for_each(|v| *v += centre);
            let camera = camera([0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 64, 2.0 / 64.0);
            let seen = see(&ball, direction([0.0, 0.0, -1.0]), &camera);
            totals(&seen, |_| true).0 * camera.pitch[0].powi(2)
        });
        assert_converges(&format!("{inputs}"), errors);
    }
}
