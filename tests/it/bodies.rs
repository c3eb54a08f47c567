//! Whole bodies: a mesh inscribed in a smooth body is compared with the body's closed form, at the mesh's own error,
//! which goes as 1 / N: four times the facets, a quarter of the error.

use crate::shapes::*;
use glam::{DQuat, DVec3, EulerRot};
use mmxrt::geometry::{Direction, Mesh};
use serde_json::Value;

/// Errors, relative, of meshes of 1280, 5120 and 20480 facets.
///
/// A facet's corners lie on the sphere, its middle (4.8 R / N) below: areas are off by some R / N.
fn assert_converges(what: &str, errors: [f64; 3]) {
    for (error, facets) in errors.iter().zip([1280.0, 5120.0, 20480.0]) {
        assert!(error.abs() < 12.0 / facets, "{what}: {errors:?}");
    }
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..5.0).contains(&ratio), "{what}: {errors:?}");
    }
}

/// Turned, so that no plane of symmetry of the mesh is one of the light or of the body.
fn balls() -> [Mesh; 3] {
    let turn = DQuat::from_euler(EulerRot::ZYX, 0.7, 0.4, 1.9);
    [3, 4, 5].map(|n| {
        let mut ball = sphere([0.0; 3], 1.0, n);
        ball.vertices_m.iter_mut().for_each(|v| *v = turn * *v);
        ball
    })
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
    for (phase_deg, phi) in [
        (0.0, 1.0),
        (60.0, 0.608_997_781_044_229_4),
        (90.0, 0.318_309_886_183_790_7),
        (120.0, 0.108_997_781_044_229_36),
    ] {
        let phase = f64::to_radians(phase_deg);
        let sun = direction((phase.cos() * observer + phase.sin() * aside).to_array());
        let errors = balls().map(|ball| {
            let [_, _, shine] = far_view(&ball, sun, observer, 2.1);
            shine / std::f64::consts::PI / (2.0 / 3.0 * phi) - 1.0
        });
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

/// The balls, stretched.
fn ellipsoids(radii: DVec3) -> [Mesh; 3] {
    balls().map(|mut ball| {
        ball.vertices_m.iter_mut().for_each(|v| *v *= radii);
        ball
    })
}

#[test]
fn an_ellipsoid_shows_its_projected_area() {
    let oracles = oracles("ellipsoid_projected_area");
    assert!(!oracles.is_empty());
    for (inputs, expected) in oracles {
        let (radii, view) = (vector(&inputs["radii_km"]), vector(&inputs["view"]));
        let errors = ellipsoids(radii)
            .map(|body| far_view(&body, direction([1.0, 0.0, 0.0]), view, 28.0)[0] / expected.as_f64().unwrap() - 1.0);
        assert_converges(&format!("view {view}"), errors);
    }
}

#[test]
fn an_ellipsoid_shows_its_lit_area_and_shines_as_its_integral() {
    let mut seen = 0;
    for (kind, which) in [("ellipsoid_lit_visible_projected_area", 1), ("ellipsoid_disc_integrated", 2)] {
        for (inputs, expected) in oracles(kind) {
            let (radii, view) = (vector(&inputs["radii_km"]), vector(&inputs["view"]));
            let sun = direction(vector(&inputs["sun"]).to_array());
            let expected = if which == 1 { &expected } else { &expected["int_mu0_mu_dA"] }.as_f64().unwrap();
            let errors = ellipsoids(radii).map(|body| far_view(&body, sun, view, 28.0)[which] / expected - 1.0);
            println!("{kind} {view} {sun:?}: {errors:?}");
            seen += 1;
        }
    }
    assert!(seen >= 5);
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
        let centre = [sin * distance, 0.0, cos * distance];
        let errors = [3, 4, 5].map(|n| {
            let camera = camera([0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 64, 2.0 / 64.0);
            let seen = see(&sphere(centre, 1.0, n), direction([0.0, 0.0, -1.0]), &camera);
            let area = totals(&seen, |_| true).0 * camera.pitch.powi(2);
            area / expected["area"].as_f64().unwrap() - 1.0
        });
        assert_converges(&format!("{inputs}"), errors);
    }
}
