//! Bodies of the sky in an image: closed forms of a sphere's disc, rays as the independent truth, and placements that leave little room.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::geometry::{FrameCamera, Mesh};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Globe, Scene, Thermal};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::study::{self, Observation};

use crate::scenes::{edited, parts};
use crate::shapes::*;

/// Reflectance of globes; sunlight at the scene, W m-2 um-1.
const ALBEDO: f64 = 0.3;
const SUNLIGHT: f64 = 700.0 / 2.25;

pub(crate) fn globe(name: &str, centre_m: DVec3, radius_m: f64) -> Globe {
    Globe {
        name: name.into(),
        centre_m,
        radius_m,
        reflectance: Spectrum::constant(ALBEDO),
        bond_albedo: ALBEDO,
        thermal_exitance_w_m2: 0.0,
        day_night_k: [0.0; 2],
    }
}

/// A mesh and globes, seen by a camera.
fn scene(mesh: Mesh, camera: FrameCamera, to_sun: [f64; 3], globes: &[Globe]) -> Scene {
    let mut parts = parts(mesh, camera, direction(to_sun));
    parts.sky.bodies = globes.to_vec();
    parts.models.bodies = 0;
    parts.check().unwrap()
}

fn seen(scene: &Scene) -> Observation {
    study::simulate(scene, &unwatched).unwrap().1
}

fn plane_of(seen: &Observation, name: &str) -> Vec<f64> {
    seen.backplanes.plane(name).unwrap_or_else(|| panic!("no plane {name}")).values.clone()
}

/// Ground out of the field, behind a camera that looks along y.
fn behind() -> Mesh {
    quad([-1.0, -9.0, 0.0], [1.0, -9.0, 0.0], [1.0, -8.0, 0.0], [-1.0, -8.0, 0.0])
}

fn along_y(pixels: u32, pitch: f64) -> FrameCamera {
    camera([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], pixels, pitch)
}

#[test]
fn all_of_a_distant_disc_is_the_flux_of_a_lambert_sphere() {
    for (phase_deg, pixels_across) in [(0.0, 8.0), (30.0, 1e-3), (60.0, 3.0), (90.0, 0.7), (140.0, 5.0), (175.0, 2.0)] {
        let pitch = 1e-6;
        let sin_radius = 0.5 * pixels_across * pitch;
        let (sin, cos) = f64::to_radians(phase_deg).sin_cos();
        // Off the middle, across corners of pixels.
        let towards = DVec3::new(0.3 * pitch, 1.0, -pitch).normalize();
        let at = globe("moon", 1e6 * towards, 1e6 * sin_radius);
        let got = seen(&scene(behind(), along_y(12, pitch), [sin, -cos, 0.0], &[at]));
        let flux: f64 = got.cube.band(0).iter().sum::<f64>() * pitch * pitch;
        let phase = f64::to_radians(phase_deg);
        let law = (phase.sin() + (PI - phase) * phase.cos()) / PI;
        let expected = 2.0 / 3.0 * ALBEDO * SUNLIGHT * sin_radius * sin_radius * law;
        // Phase angles differ over the sphere and the image by a few 1e-6, of which a crescent makes more.
        assert!((flux / expected - 1.0).abs() < 2e-5 / law.sqrt().max(0.1), "{phase_deg}: {flux} {expected}");
        let area: f64 = plane_of(&got, "GLOBE moon").iter().sum();
        assert!((area / (PI * 0.25 * pixels_across * pixels_across) - 1.0).abs() < 1e-6, "{phase_deg}: {area}");
        assert!(plane_of(&got, "COVERAGE").iter().all(|coverage| *coverage == 0.0));
    }
}

#[test]
fn a_full_disc_is_as_bright_as_a_lambert_surface_and_glows_by_day_and_night() {
    let at = Globe { day_night_k: [270.0, 180.0], ..globe("moon", DVec3::Y * 1e5, 1e4) };
    let of = |to_sun: [f64; 3]| {
        let base = scene(behind(), along_y(64, 4e-3), to_sun, std::slice::from_ref(&at));
        seen(&edited(&base, |parts| {
            parts.exposure.bands = [1.0, 4.0].map(|um| Band::new(um, None)).to_vec();
            parts.models.thermal = Thermal::Equilibrium;
        }))
    };
    let planck = |um: f64, t_k: f64| 1.191_042_972e8 / um.powi(5) / (1.438_776_877e4 / (um * t_k)).exp_m1();
    let (full, new) = (of([0.0, -1.0, 0.0]), of([0.0, 1.0, 0.0]));
    let centre = 32 * 64 + 32;
    let near = |got: f64, expected: f64| (got / expected - 1.0).abs() < 2e-3;
    let reflected = ALBEDO * SUNLIGHT / PI;
    assert!(near(full.cube.band(0)[centre], reflected + planck(1.0, 270.0)));
    assert!(near(full.cube.band(1)[centre], reflected + planck(4.0, 270.0)));
    assert!(near(new.cube.band(1)[centre], planck(4.0, 180.0)) && new.cube.band(0)[centre] < 1e-9 * reflected);
    // Half of it is day: the terminator goes through its middle; both sides are as warm as they are.
    let half = of([1.0, 0.0, 0.0]);
    let line = &half.cube.band(1)[32 * 64..33 * 64];
    assert!(near(line[16], planck(4.0, 180.0)), "{} {}", line[16], planck(4.0, 180.0));
    assert!(line[46] > planck(4.0, 270.0) + 0.3 * reflected);
    // Off: nothing glows.
    let cold = edited(&scene(behind(), along_y(64, 4e-3), [0.0, 1.0, 0.0], std::slice::from_ref(&at)), |parts| {
        parts.exposure.bands = vec![Band::new(4.0, None)];
    });
    assert_eq!(seen(&cold).cube.band(0)[centre], 0.0);
}

#[test]
fn ground_before_it_hides_it_along_its_edge() {
    // A wall 10 m ahead that ends at x = 0.025: at 1/4 of a pixel to the right of the middle.
    let wall = quad([-9.0, 10.0, -9.0], [0.025, 10.0, -9.0], [0.025, 10.0, 9.0], [-9.0, 10.0, 9.0]);
    let at = globe("moon", DVec3::Y * 1e5, 3e4);
    let got = seen(&scene(wall, along_y(8, 1e-2), [0.0, -1.0, 0.0], &[at]));
    let (globe, coverage) = (plane_of(&got, "GLOBE moon"), plane_of(&got, "COVERAGE"));
    for line in 0..8 {
        for sample in 0..8 {
            let expected = [1.0, 0.25, 0.0][(sample as i32 - 3).clamp(0, 2) as usize];
            let pixel = 8 * line + sample;
            assert!((coverage[pixel] - expected).abs() < 1e-12 && (globe[pixel] - (1.0 - expected)).abs() < 1e-9);
        }
    }
    // What is left has its own light: a pixel of both is the mean of one and the other.
    let wall_and_all = got.cube.band(0)[8 * 4 + 3];
    assert!((wall_and_all - 0.07 / PI * SUNLIGHT).abs() < 1e-9 * SUNLIGHT);
    let (mixed, beside) = (got.cube.band(0)[8 * 4 + 4], got.cube.band(0)[8 * 4 + 5]);
    assert!((mixed - (0.25 * wall_and_all + 0.75 * beside)).abs() < 2e-3 * mixed);
}

#[test]
fn before_the_ground_it_hides_it() {
    // A disc 2.6 pixels in radius, in front of a wall that fills the image.
    let wall = || quad([-90.0, 100.0, -90.0], [90.0, 100.0, -90.0], [90.0, 100.0, 90.0], [-90.0, 100.0, 90.0]);
    let tangent = 2.6e-2_f64;
    let sin_radius = tangent / tangent.hypot(1.0);
    let at = globe("moon", DVec3::Y * 50.0, 50.0 * sin_radius);
    let got = seen(&scene(wall(), along_y(8, 1e-2), [0.6, -0.8, 0.0], &[at]));
    let (globe, coverage) = (plane_of(&got, "GLOBE moon"), plane_of(&got, "COVERAGE"));
    let area: f64 = globe.iter().sum();
    assert!((area / (PI * 2.6 * 2.6) - 1.0).abs() < 1e-9, "{area}");
    for (globe, coverage) in globe.iter().zip(&coverage) {
        assert!((globe + coverage - 1.0).abs() < 1e-5, "{globe} {coverage}");
    }
    let (range, lit) = (plane_of(&got, "RANGE"), plane_of(&got, "LIT_FRACTION"));
    // The centre rays of the middle pixels meet the globe; those of corners the wall, whose lit part is all of it.
    assert!(range[8 * 4 + 4].is_nan() && (range[0] - 100.0) < 1.0 && lit[0] == 1.0);
    // Pixels that show nothing but the globe have no surface.
    assert!(coverage[8 * 4 + 4] == 0.0 && lit[8 * 4 + 4].is_nan());
    // Behind the wall there is nothing of it.
    let hidden = self::globe("moon", DVec3::Y * 200.0, 5.0);
    let got = seen(&scene(wall(), along_y(8, 1e-2), [0.6, -0.8, 0.0], &[hidden]));
    assert!(plane_of(&got, "GLOBE moon").iter().all(|share| *share == 0.0));
    assert!(plane_of(&got, "COVERAGE").iter().all(|share| (share - 1.0).abs() < 1e-12));
}

/// How far along a ray of unit length a sphere is met; infinity if it is not.
fn met(from: DVec3, ray: DVec3, globe: &Globe) -> f64 {
    let to = globe.centre_m - from;
    let along = to.dot(ray);
    let half2 = along * along - (to.length_squared() - globe.radius_m * globe.radius_m);
    if along > 0.0 && half2 >= 0.0 { along - half2.sqrt() } else { f64::INFINITY }
}

fn met_facet(from: DVec3, ray: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let along = (a - from).dot(normal) / ray.dot(normal);
    let p = from + along * ray;
    let is_in = [(a, b), (b, c), (c, a)].iter().all(|(a, b)| (*b - *a).cross(p - *a).dot(normal) >= 0.0);
    if along > 0.0 && is_in { along } else { f64::INFINITY }
}

#[test]
fn rays_see_the_same_of_globes_among_facets_and_one_another() {
    const RAYS: u32 = 16;
    let mut random = Random(11);
    let (mut compared, mut mixed) = (0, 0);
    for seed in 0..12 {
        let mut uniform = |from: f64, to: f64| from + (to - from) * random.share();
        // A boulder amid globes before it, beside it and behind it; the camera somewhere around.
        let mesh = sphere([0.0; 3], 1.0, 1);
        let mut globes: Vec<Globe> = Vec::new();
        for i in 0..4 {
            let towards = direction([uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)]).vec();
            let (distance, size) = (uniform(1.5, 9.0), uniform(0.05, 0.6));
            let one = globe(&format!("g{i}"), distance * towards, size * (distance - 1.0));
            if globes.iter().all(|g| (g.centre_m - one.centre_m).length() > g.radius_m + one.radius_m) {
                globes.push(one);
            }
        }
        let from = 12.0 * direction([uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)]).vec();
        if globes.iter().any(|g| (g.centre_m - from).length() < 1.05 * g.radius_m) {
            continue;
        }
        let pixels = 9;
        let camera = camera(from.to_array(), [0.2, 0.1, 0.0], [0.1, 0.2, 1.0], pixels, uniform(0.02, 0.2));
        let scene = scene(mesh, camera.clone(), [0.3, 0.5, 0.8], &globes);
        let got = seen(&scene);
        let coverage = plane_of(&got, "COVERAGE");
        let planes: Vec<(usize, Vec<f64>)> = (0..globes.len())
            .filter_map(|g| Some((g, got.backplanes.plane(&format!("GLOBE {}", globes[g].name))?.values.clone())))
            .collect();
        let mesh = &scene.body.mesh;
        for pixel in 0..(pixels * pixels) as usize {
            let (sample, line) = (pixel as u32 % pixels, pixel as u32 / pixels);
            let mut counts = vec![0.0; globes.len() + 1];
            for i in 0..RAYS {
                for j in 0..RAYS {
                    let at = |k: u32, ray: u32| f64::from(k) + (f64::from(ray) + 0.5) / f64::from(RAYS);
                    let ray = camera.ray(at(sample, i), at(line, j)).normalize();
                    let ground = (0..mesh.facets.len())
                        .map(|f| met_facet(from, ray, mesh.facet(f).corners_m))
                        .fold(f64::INFINITY, f64::min);
                    let first = globes.iter().map(|g| met(from, ray, g)).enumerate();
                    let (g, nearest) = first.fold((0, f64::INFINITY), |m, (g, t)| if t < m.1 { (g, t) } else { m });
                    if nearest < ground {
                        counts[g] += 1.0;
                    } else if ground.is_finite() {
                        counts[globes.len()] += 1.0;
                    }
                }
            }
            let share = |count: f64| count / f64::from(RAYS * RAYS);
            // Along an outline that crosses a pixel rays are off by some of those beside it.
            let near = |got: f64, count: f64| {
                (got - share(count)).abs() < 4.0 / f64::from(RAYS) / f64::from(RAYS).sqrt() + 0.01
            };
            assert!(near(coverage[pixel], counts[globes.len()]), "{seed} {pixel}: {} {counts:?}", coverage[pixel]);
            for (g, plane) in &planes {
                assert!(near(plane[pixel], counts[*g]), "{seed} {pixel} {g}: {} {counts:?}", plane[pixel]);
                compared += 1;
            }
            let all: f64 = coverage[pixel] + planes.iter().map(|(_, plane)| plane[pixel]).sum::<f64>();
            assert!(all < 1.0 + 2e-5, "{seed} {pixel}: {all}");
            mixed += usize::from(counts.iter().filter(|count| **count > 0.0).count() > 1);
        }
        // Those without a plane are nowhere.
        for g in (0..globes.len()).filter(|g| planes.iter().all(|(other, _)| other != g)) {
            let corner = [0.0, f64::from(pixels)];
            let hit = corner
                .iter()
                .flat_map(|x| corner.map(|y| (*x, y)))
                .any(|(x, y)| met(from, camera.ray(x, y).normalize(), &globes[g]).is_finite());
            assert!(!hit, "{seed}: {g}");
        }
    }
    assert!(compared > 1500 && mixed > 20, "{compared} {mixed}");
}

#[test]
fn near_degenerate_placements() {
    let total = |globes: &[Globe], pitch: f64| {
        let got = seen(&scene(behind(), along_y(8, pitch), [0.3, -0.9, 0.1], globes));
        let share = plane_of(&got, "GLOBE moon");
        assert!(share.iter().all(|share| (0.0..=1.0 + 1e-9).contains(share)), "{share:?}");
        assert!(got.cube.band(0).iter().all(|radiance| radiance.is_finite() && *radiance >= 0.0));
        share.iter().sum::<f64>()
    };
    // A thousandth of a pixel across: inside one, on an edge of two, at a corner of four.
    for [x, z] in [[0.5, 0.5], [0.0, 0.5], [0.0, 0.0], [1e-4, 0.0]] {
        let pitch = 1e-3;
        let at = DVec3::new(x * pitch, 1.0, z * pitch) * 1e6;
        let area = total(&[globe("moon", at, 0.5e-3 * pitch * at.length())], pitch);
        let expected = PI * 0.25e-6 * at.length() / at.y * (at.length() / at.y).powi(2);
        assert!((area / expected - 1.0).abs() < 1e-5, "{x} {z}: {area} {expected}");
    }
    // The limb through the corners of pixels: a disc of radius 2 sqrt 2 pixels about the middle.
    let tangent = 8.0_f64.sqrt() * 1e-2;
    let area = total(&[globe("moon", DVec3::Y * 100.0, 100.0 * tangent / tangent.hypot(1.0))], 1e-2);
    assert!((area / (8.0 * PI) - 1.0).abs() < 1e-9, "{area}");
    // It fills the image; half of it, from some metres above its surface; a metre above it.
    assert!((total(&[globe("moon", DVec3::Y * 100.0, 60.0)], 1e-2) - 64.0).abs() < 1e-8);
    for height_m in [1e5, 5.0, 1.0] {
        let radius_m = 3_389_500.0;
        let half = total(&[globe("moon", DVec3::NEG_Z * (radius_m + height_m), radius_m)], 0.2);
        // The horizon is a dip of sqrt(2 h / R) below the middle of the image, which is 8 pixels of 0.2 wide; it is a hyperbola.
        let dip = (2.0 * height_m / radius_m).sqrt();
        assert!(half < 32.0 && half > 32.0 - 8.0 * 1.3 * dip / 0.2 - 1e-3, "{height_m}: {half}");
    }
    // Beside the image, and behind the camera: there is no plane.
    for at in [DVec3::NEG_Y, DVec3::X] {
        let got = seen(&scene(behind(), along_y(8, 1e-2), [0.3, -0.9, 0.1], &[globe("moon", at * 1e6, 1e5)]));
        assert!(got.backplanes.plane("GLOBE moon").is_none() && got.cube.band(0).iter().all(|l| *l == 0.0));
    }
}

#[test]
fn what_touches_is_refused() {
    let refused = |globes: &[Globe]| {
        let mut parts = parts(behind(), along_y(8, 1e-2), direction([0.0, 0.0, 1.0]));
        parts.sky.bodies = globes.to_vec();
        parts.check().err().map(|e| e.to_string()).unwrap_or_default()
    };
    let at = |y: f64, radius: f64| globe("moon", DVec3::Y * y, radius);
    // The camera is at the scene's origin, which no globe may hold; and 0.1 m before it.
    assert!(refused(&[at(10.0, 10.0)]).contains("inside moon"));
    assert_eq!(refused(&[at(10.0, 9.9)]), "");
    // Ground whose nearer edge is 8 m behind: an edge, a corner, the middle of a facet.
    assert!(refused(&[at(-4.5, 3.5)]).contains("moon touches facet"));
    assert_eq!(refused(&[at(-4.5, 3.499)]), "");
    let below = |radius: f64| globe("moon", DVec3::new(0.1, -8.5, -5.0), radius);
    assert!(refused(&[below(5.0)]).contains("moon touches facet") && refused(&[below(4.999)]).is_empty());
    let two = |radius: f64| [at(100.0, 10.0), Globe { name: "other".into(), ..at(130.0, radius) }];
    assert!(refused(&two(20.0)).contains("touch") && refused(&two(19.9)).is_empty());
}
