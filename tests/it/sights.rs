//! What acquisitions see of the surface, against spheres, whose caps and swaths have closed forms, and against the images of the same.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DQuat, DVec3};
use mmxrt::flight::{
    Aim, Almanac, Correction, Epoch, Orientation, Path, Pointing, Segment, Span, Spin, Trajectory, Turn, Turning, Up,
};
use mmxrt::geometry::{BrownConrady, FrameCamera, Lens, Mesh};
use mmxrt::integrate::footprints;
use mmxrt::product::Sights;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Motion, Readout, Scene, Timing};
use mmxrt::study::{Moving, sights};
use mmxrt::visibility::Seen;

use crate::motion::{down, moving_scene, steady};
use crate::scenes::{self, edited};
use crate::shapes::{grid, joined, quad, sphere, sun};

/// Radius of the sphere, and the camera's distance from its centre, m.
const R: f64 = 11_000.0;
const D: f64 = 20_000.0;
/// How fast the sphere turns below the camera, rad/s.
const RATE: f64 = 1e-3;

/// A camera at rest over a sphere that turns about z, against its way so that lines go down along -y at the start.
fn over_sphere(up: Up) -> Motion {
    let span = Span { start: Epoch::J2000.after_s(-1e5), end: Epoch::J2000.after_s(1e5) };
    let trajectory = |target: &str, at: DVec3| Trajectory {
        target: target.into(),
        centre: "ROCK".into(),
        frame: "J2000".into(),
        source: "a test".into(),
        segments: vec![Segment { span, path: Path::Fixed(at) }],
    };
    let spin = Spin { since: Epoch::J2000, frame_from_base: DQuat::IDENTITY, rate_rad_s: DVec3::Z * RATE };
    let mut almanac = Almanac::default();
    almanac.trajectories.push(trajectory("PROBE", DVec3::X * D));
    almanac.trajectories.push(trajectory("SUN", DVec3::Y * 2e11));
    almanac.orientations.push(Orientation {
        frame: "IAU_ROCK".into(),
        base: "J2000".into(),
        source: "a test".into(),
        turns: vec![Turn { span: None, turning: Turning::Spin(spin) }],
    });
    Motion {
        almanac: Arc::new(almanac),
        body: "ROCK".into(),
        frame: "IAU_ROCK".into(),
        origin_m: DVec3::ZERO,
        spacecraft: "PROBE".into(),
        pointing: Pointing { aim: Aim::Nadir, up, scan: None, bias_rad: DVec3::ZERO, jitter: None },
        correction: Correction::None,
        start: Epoch::J2000,
    }
}

fn scene(mesh: Mesh, [samples, lines]: [u32; 2], pitch: f64, motion: &Motion, timing: Timing) -> Scene {
    let pose = motion.pose(motion.start).unwrap();
    let camera = FrameCamera { samples, lines, ..FrameCamera::centred(pose, samples, lines, pitch) };
    let mut parts = scenes::parts(mesh, camera, sun(30.0, 0.0));
    parts.surface.origin_m = DVec3::ZERO;
    let scene = parts.check().unwrap();
    let middle_s = timing.middle_s(timing.reference(&scene.exposure));
    motion.at(&scene, scene.exposure.clone(), motion.start.after_s(middle_s)).unwrap()
}

/// Areas seen, and seen in sunlight, m2.
fn areas_m2(scene: &Scene, sights: &Sights) -> [f64; 2] {
    sights.validate(scene.body.mesh.facets.len()).unwrap();
    let mut sums = [0.0; 2];
    for sight in sights.iter() {
        let area_m2 = scene.body.mesh.facet(sight.facet as usize).area_m2();
        sums = [sums[0] + sight.seen * area_m2, sums[1] + sight.sunlit * area_m2];
    }
    sums
}

const FRAME: Timing = Timing { readout: Readout::Frame, period_s: 0.0, exposure_s: 0.0, poses: 1 };

/// From a distance d a sphere shows a cap of 2 pi r^2 (1 - r / d); half of it is lit from the side.
#[test]
fn a_whole_disc_is_the_cap_within_its_horizon() {
    let motion = over_sphere(Up::North);
    let expected = 2.0 * PI * R * R * (1.0 - R / D);
    let mut errors = Vec::new();
    for n in [2_i32, 4] {
        // 80 deg wide: the disc has 67.
        let scene = scene(sphere([0.0; 3], R, n.unsigned_abs()), [16, 16], 0.105, &motion, FRAME);
        let seen = sights(Moving { scene: &scene, motion: &motion, timing: FRAME, optics: None }, &unwatched).unwrap();
        let [all, lit] = areas_m2(&scene, &seen);
        errors.push((all / expected - 1.0).abs());
        // Each facet is on one side of the terminator: by a tenth of an edge on a mean.
        assert!((lit / all - 0.5).abs() < 0.11 / 2.0_f64.powi(n), "{n}: {}", lit / all);
        // Below the camera: straight down, and the Sun on the horizon.
        let nearest = seen.iter().min_by(|a, b| a.emission_deg.total_cmp(&b.emission_deg)).unwrap();
        // Edges of an icosahedron are 63.4 deg, and some of their parts a fifth longer than others: the middle of a facet is at most 0.58 of one from straight
        // below. Emission grows by that, and by what the camera looks aside: r / (d - r) of it.
        let off_deg = 0.58 * 1.2 * 63.4 / 2.0_f64.powi(n);
        assert!(nearest.emission_deg < off_deg * D / (D - R) && (nearest.incidence_deg - 90.0).abs() < off_deg);
    }
    assert!(errors[1] < 5e-3 && errors[1] < 0.5 * errors[0], "{errors:?}");
}

/// A square field of view on a sphere: the area is that of its rays, one by one.
#[test]
fn a_frame_sees_what_its_rays_meet() {
    let motion = over_sphere(Up::North);
    let half = 0.2;
    // Of a ray (1, x, y) the sphere is met at range t: area = t^3 dx dy / (cos emission x length^3 of the ray ... in all t^2 dOmega / cos e.
    let (mut expected, n) = (0.0, 400);
    for i in 0..n {
        for j in 0..n {
            let [x, y] = [i, j].map(|k| half * ((2 * k + 1) as f64 / n as f64 - 1.0));
            let length = (1.0 + x * x + y * y).sqrt();
            let (cos_off, step) = (1.0 / length, 2.0 * half / n as f64);
            let t = D * cos_off - (R * R - D * D * (1.0 - cos_off * cos_off)).sqrt();
            let cos_emission = (D * D - R * R - t * t) / (2.0 * R * t);
            expected += t * t * cos_off.powi(3) * step * step / cos_emission;
        }
    }
    let mut errors = Vec::new();
    for n in [3, 5] {
        let scene = scene(sphere([0.0; 3], R, n), [10, 10], half / 5.0, &motion, FRAME);
        let seen = sights(Moving { scene: &scene, motion: &motion, timing: FRAME, optics: None }, &unwatched).unwrap();
        errors.push((areas_m2(&scene, &seen)[0] / expected - 1.0).abs());
        // Straight down a pixel is h x pitch.
        let finest = seen.sampling_m.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((finest / ((D - R) * half / 5.0) - 1.0).abs() < 0.05 / 4.0_f64.powi(n as i32 - 3), "{finest}");
    }
    // Facets are four times as small: twice each time, errors by four.
    assert!(errors[1] < 1e-3 && errors[1] < errors[0] / 8.0, "{errors:?}");
}

/// The swath of a push-broom on a sphere: to both sides asin(d / r sin b) - b, as long as it turns, whose lines overlap by half.
#[test]
fn a_swath_is_as_wide_and_as_long_as_geometry_says() {
    let motion = over_sphere(Up::Backward);
    let (samples, pitch, lines) = (40, 0.01, 60);
    let beta = (0.5 * f64::from(samples) * pitch).atan();
    let lambda = (D / R * beta.sin()).asin() - beta;
    // A line goes on by half of its width on the ground.
    let step_rad = 0.5 * pitch * (D - R) / R;
    let timing = Timing { readout: Readout::Line, period_s: step_rad / RATE, exposure_s: 0.0, poses: 1 };
    let long = f64::from(lines - 1) * step_rad;
    // Zone, and at both ends half a line, whose width at a latitude is the pitch times the depth of the ground.
    let expected = 2.0 * R * R * lambda.sin() * long + R * pitch * (2.0 * D * lambda - 2.0 * R * lambda.sin());
    let mut errors = Vec::new();
    for n in [3, 5] {
        let scene = scene(sphere([0.0; 3], R, n), [samples, lines], pitch, &motion, timing);
        let seen = sights(Moving { scene: &scene, motion: &motion, timing, optics: None }, &unwatched).unwrap();
        errors.push((areas_m2(&scene, &seen)[0] / expected - 1.0).abs());
        let highest = |facet: u32| scene.body.mesh.facet(facet as usize).corners_m.map(|p| (p.z / R).abs().asin());
        let reach = seen.facet.iter().flat_map(|facet| highest(*facet)).fold(0.0, f64::max);
        assert!(reach > lambda && reach < lambda + 2.4 / 2.0_f64.powi(n as i32), "{reach} {lambda}");
    }
    assert!(errors[1] < 2e-3 && errors[1] < errors[0] / 4.0, "{errors:?}");
}

/// What is seen of each facet fills as many pixels as the image has of it, and its sunlit part as many as are lit; through a lens too, which moves the image's corners
/// by half a pixel.
#[test]
fn facets_fill_their_pixels() {
    // How much a facet of 13 m differs from its middle: by what is 20 km away; and by the lens, whose scale changes by 2 % a pixel, as it is at a part of a facet, and in a
    // pixel's middle.
    for (k1, within) in [(0.0, [2e-3; 2]), (-400.0, [2e-2, 4e-2])] {
        fill_their_pixels(k1, within);
    }
}

fn fill_their_pixels(k1: f64, within: [f64; 2]) {
    let motion = steady(DVec3::ZERO, 0.0, sun(65.0, 30.0).vec(), down());
    let wall = quad([-60.0, -20.0, 0.0], [60.0, -20.0, 0.0], [60.0, -20.0, 90.0], [-60.0, -20.0, 90.0]);
    let ground = grid(200.0, 30, |x, y| 6.0 * (0.05 * x).sin() * (0.04 * y).cos());
    let scene = moving_scene(joined(&[ground, wall]), [24, 20], 12.0, &[1.0], &motion, FRAME);
    let scene = edited(&scene, |parts| {
        let camera = &mut parts.exposure.camera;
        let of = BrownConrady { radial: [k1, 0.0, 0.0], tangential: [0.0; 2] };
        let lens = Lens::brown_conrady(of, camera.pitch, camera.boresight_px, [camera.samples, camera.lines]);
        camera.lens = lens.unwrap().map(Arc::new);
    });
    let seen = sights(Moving { scene: &scene, motion: &motion, timing: FRAME, optics: None }, &unwatched).unwrap();
    let (mesh, topology) = (&scene.body.mesh, scene.body.topology());
    let sunlit = Seen::from_afar(mesh, topology, scene.sky.sun.direction, "sunlight", &unwatched).unwrap();
    let pixels = footprints(mesh, topology, &sunlit, &scene.exposure.camera);
    let mut filled = vec![[0.0; 2]; mesh.facets.len()];
    for pixel in 0..24 * 20 {
        for (facet, fraction, lit) in pixels.pixel(pixel) {
            let sum = &mut filled[facet as usize];
            *sum = [sum[0] + fraction, sum[1] + lit];
        }
    }
    let (mut checked, mut partly) = (0, 0);
    let mut sums = vec![[0.0; 2]; mesh.facets.len()];
    for sight in seen.iter() {
        let per_share = mesh.facet(sight.facet as usize).area_m2() / sight.sampling_m.powi(2);
        sums[sight.facet as usize] = [sight.seen, sight.sunlit].map(|share| share * per_share);
        checked += 1;
        partly += usize::from(sight.sunlit > 1e-3 && sight.sunlit < sight.seen - 1e-3);
    }
    assert!(checked > 800 && partly > 20, "{checked} {partly}");
    for (facet, (found, expected)) in sums.iter().zip(&filled).enumerate() {
        let plane = mesh.facet(facet);
        if (scene.exposure.camera.centre_m() - plane.centroid_m()).dot(plane.normal()) < 0.0 {
            // Inner sides only block.
            assert_eq!(*found, [0.0; 2]);
            continue;
        }
        for k in 0..2 {
            let off = (found[k] - expected[k]).abs();
            assert!(off <= within[k] * expected[0] + 1e-9, "{facet}: {found:?} {expected:?}");
        }
    }
}
