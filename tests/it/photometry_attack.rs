//! Models in the image where they vary within a pixel, and where directions are extreme: against rays through each pixel, many of them.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::geometry::{FrameCamera, Mesh};
use mmxrt::physics::reflectance::hapke::{Parameters, Roughness, Surge};
use mmxrt::physics::reflectance::{Brdf, Partition, PhaseCurve, PhaseFunction, PhotometricAngles, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Model, Photometry, Scene};
use mmxrt::spectral::Spectrum;
use mmxrt::study;

use crate::scenes::{edited, scene};
use crate::scratch::is_heavy;
use crate::shapes::*;

/// Sunlight at the scene on a plane normal to the beam.
const E: f64 = 700.0 / 2.25;

fn shapes() -> [(Shape, f64); 6] {
    let curve = PhaseCurve { beta: -1.3, gamma: 0.1, delta: 0.0 };
    let phobos = Parameters {
        phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
        shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
        roughness: Roughness::of_mean_slope(24f64.to_radians()),
        ..Parameters::PLAIN
    };
    [
        (Shape::LommelSeeliger(PhaseFunction::Isotropic), 0.1),
        (Shape::LunarLambert(curve, Partition::Moon), 0.07),
        (Shape::Minnaert(0.6), 0.07),
        (Shape::Akimov(curve), 0.07),
        (Shape::Hapke(phobos), 0.072),
        (Shape::Rpv { exponent: 0.65, asymmetry: -0.29, hot_spot: 0.075 }, 0.075),
    ]
}

fn of_model(scene: &Scene, (shape, albedo): (Shape, f64)) -> Scene {
    edited(scene, |parts| {
        let model = Model { shape, albedo: Spectrum::constant(albedo), preset: None };
        let material = &mut parts.surface.materials[0];
        material.reflectance = model.hemispherical();
        material.emissivity = material.reflectance.map(|r| 1.0 - r);
        material.photometry = Photometry::Model(Box::new(model));
    })
}

/// Where a ray meets a triangle: its length, in lengths of `along`. Moeller and Trumbore (1997).
fn met([a, b, c]: [DVec3; 3], from: DVec3, along: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = along.cross(ac);
    let det = ab.dot(p);
    let t = from - a;
    let (u, q) = (t.dot(p) / det, t.cross(ab));
    let (v, range) = (along.dot(q) / det, ac.dot(q) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range > 0.0).then_some(range)
}

/// Mean BRDF of each surface in a pixel, weighted with irradiance, by n x n rays. Edges drop out of it, but for how much a surface differs there.
fn by_rays(mesh: &Mesh, camera: &FrameCamera, to_sun: DVec3, brdfs: &[Brdf], pixel: usize, n: u32) -> Vec<f64> {
    let samples = camera.samples as usize;
    let (column, line) = ((pixel % samples) as f64, (pixel / samples) as f64);
    let (eye, to_sun) = (camera.centre_m(), to_sun.normalize());
    let (mut sums, mut weight) = (vec![0.0; brdfs.len()], 0.0);
    for i in 0..n * n {
        let [x, y] = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
        let along = camera.ray(column + x, line + y);
        let hit = |f: usize| Some((met(mesh.facet(f).corners_m, eye, along)?, f));
        let Some((range, facet)) = (0..mesh.facets.len()).filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        let normal = mesh.facet(facet).cross_m2().normalize();
        let (cos_i, at) = (normal.dot(to_sun), eye + range * along);
        let blocks = |f: usize| f != facet && met(mesh.facet(f).corners_m, at, to_sun).is_some();
        if normal.dot(along) < 0.0 && cos_i > 0.0 && !(0..mesh.facets.len()).any(blocks) {
            let angles = PhotometricAngles::of_directions(normal, to_sun, -along.normalize());
            sums.iter_mut().zip(brdfs).for_each(|(sum, brdf)| *sum += cos_i * brdf.eval(&angles));
            weight += cos_i;
        }
    }
    sums.into_iter().map(|sum| if weight > 0.0 { sum / weight } else { 0.0 }).collect()
}

/// Every pixel that is lit has the mean of its rays; none has anything that is no number. How many were compared, and the largest error.
fn compared(what: &str, mesh: &Mesh, camera: &FrameCamera, sun: [f64; 3], n: u32) -> (usize, f64) {
    let lambert = scene(mesh.clone(), camera.clone(), sun);
    // pi L of a Lambert surface of 0.07 is 0.07 E: what light a pixel sees.
    let light: Vec<f64> =
        study::simulate(&lambert, &unwatched).unwrap().1.cube.band(0).iter().map(|l| l * PI / 0.07).collect();
    let brdfs: Vec<Brdf> = shapes().iter().map(|(shape, albedo)| shape.brdf(*albedo)).collect();
    let truth: Vec<Vec<f64>> =
        (0..light.len()).map(|pixel| by_rays(mesh, camera, DVec3::from(sun), &brdfs, pixel, n)).collect();
    let (mut seen, mut worst) = (0, 0.0_f64);
    for (k, (shape, albedo)) in shapes().into_iter().enumerate() {
        let got = study::simulate(&of_model(&lambert, (shape, albedo)), &unwatched).unwrap().1.cube.band(0);
        for (pixel, (got, light)) in got.iter().zip(&light).enumerate() {
            assert!(got.is_finite() && *got >= 0.0, "{what} {shape:?} {pixel}: {got}");
            let truth = light * truth[pixel][k];
            if truth > 0.0 {
                let off = (got / truth - 1.0).abs();
                worst = worst.max(off);
                seen += 1;
            }
        }
    }
    (seen, worst)
}

fn check(what: &str, mesh: &Mesh, camera: &FrameCamera, sun: [f64; 3], n: u32, tolerance: f64) -> usize {
    let (seen, worst) = compared(what, mesh, camera, sun, n);
    assert!(worst <= tolerance, "{what}: off by {worst:e}");
    seen
}

fn ground() -> Mesh {
    mesh(&[[-900.0, -900.0, 0.0], [1800.0, -900.0, 0.0], [-900.0, 1800.0, 0.0]], &[[0, 1, 2]])
}

#[test]
fn large_facets_near_the_camera() {
    // Pixels of 60, 25 and 6 deg from 10 m above, and from the side; the Sun behind the camera, aside, and low.
    let mut seen = 0;
    for pitch in [1.2, 0.45, 0.1] {
        for (eye, at) in [([0.0, 0.0, 10.0], [0.0; 3]), ([-20.0, 0.0, 15.0], [0.0; 3])] {
            let view = camera(eye, at, [0.0, 1.0, 0.0], 2, pitch);
            // The widest from aside hold the horizon, where rays are too few.
            let (n, tolerance) = if pitch > 1.0 && eye[0] < 0.0 { (120, 2e-2) } else { (60, 2e-4) };
            for sun in [[eye[0], eye[1], eye[2]], [-1.0, 0.5, 1.0], [1.0, 0.3, 0.05]] {
                seen += check("ground", &ground(), &view, sun, n, tolerance);
            }
        }
    }
    assert!(seen > 400, "{seen}");
}

#[test]
fn facets_that_are_lit_in_part_and_hidden_in_part() {
    // A wall beside the pixels, and a block before them: lit parts are polygons, hidden ones are taken away.
    let wall = cuboid([-11.0, -100.0, 0.0], [-10.0, 100.0, 5.0]);
    let block = cuboid([-1.0, -2.0, 1.0], [1.0, 1.0, 3.0]);
    let both = joined(&[ground(), wall, block]);
    let view = camera([0.5, 0.25, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 2, 0.8);
    let seen = check("wall and block", &both, &view, [-1.0, 0.3, 1.0], if is_heavy() { 400 } else { 120 }, 3e-3);
    assert!(seen >= 24, "{seen}");
}

#[test]
fn slivers_and_edges_of_integers() {
    // Long triangles of a thousandth of their length, side by side, on whole numbers.
    let mut corners = Vec::new();
    let mut facets = Vec::new();
    for k in 0..40 {
        let first = corners.len() as u32;
        corners.extend([
            [-50.0, f64::from(k) - 20.0, 0.0],
            [50.0, f64::from(k) - 20.0, 0.0],
            [50.0, f64::from(k) - 19.0, 0.0],
        ]);
        corners.push([-50.0, f64::from(k) - 19.0, 0.0]);
        facets.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let strips = mesh(&corners, &facets);
    let view = camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 2, 0.5);
    let seen = check("strips", &strips, &view, [1.0, 0.0, 1.0], 60, 2e-4);
    assert_eq!(seen, 24);
}

#[test]
fn extreme_directions_have_numbers() {
    let block = joined(&[ground(), cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0])]);
    let mut images = 0;
    // Above, along faces and edges, in the plane of the ground, and below it.
    for eye in
        [[0.0, 0.0, 10.0], [10.0, 0.0, 2.0], [10.0, 1.0, 1.0], [10.0, 10.0, 0.0], [10.0, 0.0, -1e-12], [5.0, 5.0, 5.0]]
    {
        let view = camera(eye, [0.0, 0.0, 0.5], [0.1, 0.2, 0.97], 4, 0.1);
        for sun in [
            // With the camera, opposite to it, at the horizon, above and below it by rounding, along faces, overhead.
            eye,
            eye.map(|x| -x),
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 1e-16],
            [1.0, 1.0, -1e-16],
            [1.0, 0.0, 1e-9],
            [0.0, 0.0, 1.0],
            [1e-17, 0.0, 1.0],
        ] {
            if sun == [0.0; 3] {
                continue;
            }
            for model in shapes() {
                let lit = of_model(&scene(block.clone(), view.clone(), sun), model);
                let radiance = study::simulate(&lit, &unwatched).unwrap().1.cube.band(0);
                // No model here is brighter than 40 times a white surface.
                assert!(
                    radiance.iter().all(|l| (0.0..40.0 * E).contains(l)),
                    "{eye:?} {sun:?} {model:?}: {radiance:?}"
                );
                images += 1;
            }
        }
    }
    assert_eq!(images, 6 * 8 * 6);
}

#[test]
fn grazing_views_and_grazing_light() {
    // From 1 m above the ground towards the horizon, which a pixel holds: emission goes through 90 deg in it.
    let view = camera([0.0, 0.0, 1.0], [100.0, 0.0, 0.5], [0.0, 0.0, 1.0], 2, 0.02);
    let mut seen = 0;
    for sun in [[-1.0, 0.4, 0.8], [0.3, 1.0, 0.02], [-1.0, 0.0, 0.001]] {
        seen += check("horizon", &ground(), &view, sun, if is_heavy() { 1000 } else { 300 }, 6e-3);
    }
    assert!(seen >= 18, "{seen}");
}
