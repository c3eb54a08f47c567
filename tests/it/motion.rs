//! Scenes that move: each part of a cube is taken at its own moment, and what that does to its geometry has closed forms.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use mmxrt::flight::{
    Aim, Almanac, Correction, Epoch, Interpolation, Nodes, Orientation, Path, Pointing, Scan, Segment, Span,
    Trajectory, Turn, Turning, Up,
};
use mmxrt::geometry::Mesh;
use mmxrt::integrate::Wanted;
use mmxrt::product::{Cube, CubeAxes, Slab};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Motion, Readout, Scene, Thermal, Timing};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::study::{self, Extremes, Moving, Observation, acquire_by_slabs};

use crate::scenes::{self, edited, lambert};
use crate::shapes::{Random, cuboid, grid, joined, nadir, plane, quad, sun};

/// Height of the camera over the ground at z = 0, m.
pub(crate) const HEIGHT_M: f64 = 20_000.0;
/// Where the ground is, from the centre of the body, which is what scenes of these tests have.
pub(crate) const ORIGIN_M: DVec3 = DVec3::new(0.0, 0.0, 11_000.0);
/// The Sun's distance in these scenes, m.
const FAR_M: f64 = 2e11;

/// A spacecraft that goes steadily along a straight line over ground that does not turn, and is over the origin after `over_s`.
pub(crate) fn steady(velocity_m_s: DVec3, over_s: f64, to_sun: DVec3, pointing: Pointing) -> Motion {
    let span = Span { start: Epoch::J2000.after_s(-1e4), end: Epoch::J2000.after_s(1e4) };
    let at = |s: f64| ORIGIN_M + DVec3::Z * HEIGHT_M + velocity_m_s * (s - over_s);
    let nodes = Nodes {
        tdb_s: vec![-1e4, 1e4],
        position_m: vec![at(-1e4), at(1e4)],
        velocity_m_s: vec![],
        interpolation: Interpolation::Lagrange(2),
    };
    let trajectory = |target: &str, path: Path| Trajectory {
        target: target.into(),
        centre: "ROCK".into(),
        frame: "IAU_ROCK".into(),
        source: "a test".into(),
        segments: vec![Segment { span, path }],
    };
    let mut almanac = Almanac::default();
    almanac.trajectories.push(trajectory("PROBE", Path::Nodes(nodes)));
    almanac.trajectories.push(trajectory("SUN", Path::Fixed(ORIGIN_M + to_sun.normalize() * FAR_M)));
    almanac.orientations.push(Orientation {
        frame: "IAU_ROCK".into(),
        base: "J2000".into(),
        source: "a test".into(),
        turns: vec![Turn { span: None, turning: Turning::Fixed(DMat3::IDENTITY) }],
    });
    Motion {
        almanac: Arc::new(almanac),
        body: "ROCK".into(),
        frame: "IAU_ROCK".into(),
        origin_m: ORIGIN_M,
        spacecraft: "PROBE".into(),
        pointing,
        correction: Correction::None,
        start: Epoch::J2000,
    }
}

/// Straight down: right is +x, lines go down along -y.
pub(crate) fn down() -> Pointing {
    let sensor = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
    Pointing {
        aim: Aim::Fixed("IAU_ROCK".into(), sensor),
        up: Up::North,
        scan: None,
        bias_rad: DVec3::ZERO,
        jitter: None,
    }
}

/// A scene at its reference exposure: pixels of `pixel_m` on the ground.
pub(crate) fn moving_scene(
    mesh: Mesh,
    [samples, lines]: [u32; 2],
    pixel_m: f64,
    bands: &[f64],
    motion: &Motion,
    timing: Timing,
) -> Scene {
    let mut camera = nadir(HEIGHT_M, pixel_m, 1);
    (camera.samples, camera.lines) = (samples, lines);
    camera.boresight_px = [samples, lines].map(|n| 0.5 * f64::from(n));
    let mut parts = scenes::parts(mesh, camera, sun(30.0, 0.0));
    parts.models.thermal = Thermal::Off;
    parts.exposure.bands = bands.iter().map(|um| Band::new(*um, None)).collect();
    parts.surface.materials = vec![
        lambert(0, "dark", Spectrum::constant(0.05)),
        lambert(1, "bright", Spectrum::new(vec![0.5, 5.0], vec![0.3, 0.6], mmxrt::spectral::Extend::Error).unwrap()),
    ];
    let scene = parts.check().unwrap();
    let middle_s = timing.middle_s(timing.reference(&scene.exposure));
    motion.at(&scene, scene.exposure.clone(), motion.start.after_s(middle_s)).unwrap()
}

pub(crate) fn taken(scene: &Scene, motion: &Motion, timing: Timing) -> (Cube, Observation<()>) {
    let mut slabs: Vec<Slab> = Vec::new();
    let mut put = |slab| {
        slabs.push(slab);
        Ok(())
    };
    let moving = Moving { scene, motion, timing, optics: None };
    let (_, observation) =
        acquire_by_slabs(moving, (&Extremes::new(scene), 1e-9), Wanted::default(), &mut put, &unwatched).unwrap();
    (Cube::new(CubeAxes::of(&scene.exposure), slabs).unwrap(), observation)
}

/// Flat ground of random patches, bright and dark.
fn patches(r: f64, n: u32) -> Mesh {
    let mut mesh = grid(r, n, |_, _| 0.0);
    let mut random = Random(5);
    mesh.material.iter_mut().for_each(|material| material.0 = u16::from(random.share() < 0.5));
    mesh
}

fn push_broom(period_s: f64) -> Timing {
    Timing { readout: Readout::Line, period_s, exposure_s: 0.0, poses: 1 }
}

/// Over flat ground, square to the way, a push-broom's image is that of a frame camera: each line lies where the frame has it.
#[test]
fn over_flat_ground_a_push_broom_sees_what_a_frame_camera_sees() {
    let (lines, pixel_m, period_s) = (24, 8.0, 1.6);
    let timing = push_broom(period_s);
    // Line k is over y = -(k - 11.5) pixels: down the image.
    let velocity = DVec3::NEG_Y * pixel_m / period_s;
    let to_sun = sun(50.0, 40.0).vec();
    let motion = steady(velocity, 11.5 * period_s, to_sun, down());
    // Ground far beyond the strip, of which each line looks at its part; shifted, so that no edge halves a pixel.
    let mut ground = patches(900.0, 91);
    ground.vertices_m.iter_mut().for_each(|vertex| *vertex += DVec3::new(1.37, 2.71, 0.0));
    let scene = moving_scene(ground, [20, lines], pixel_m, &[1.0, 2.0, 3.0], &motion, timing);
    let (cube, observation) = taken(&scene, &motion, timing);
    // A frame camera over the middle: the Sun is a point far away, where it moves by nothing.
    let over_middle = motion.at(&scene, scene.exposure.clone(), motion.start.after_s(11.5 * period_s)).unwrap();
    let frame = study::simulate(&over_middle, &unwatched).unwrap().1;
    let mut brightest = 0.0_f64;
    for band in 0..3 {
        for (a, b) in cube.band(band).iter().zip(frame.cube.band(band).iter()) {
            brightest = brightest.max(*b);
            assert!((a - b).abs() <= 1e-9 * b.abs(), "{a} {b}");
        }
    }
    assert!(brightest > 1.0);
    // Facets have the numbers of the whole mesh.
    let facets = |of: &mmxrt::product::Backplanes| of.plane("FACET").unwrap().values.clone();
    assert_eq!(facets(&observation.backplanes), facets(&frame.backplanes));
    let coverage = &observation.backplanes.plane("COVERAGE").unwrap().values;
    assert_eq!(coverage.len(), 20 * lines as usize);
    assert!(coverage.iter().all(|share| (share - 1.0).abs() < 1e-9));
}

/// A raised plate: along the way a push-broom sees it where it is, across it as a frame camera does, larger by h / (h - dz).
#[test]
fn a_push_broom_has_no_relief_displacement_along_its_way() {
    let (pixel_m, period_s, dz) = (10.0, 2.0, 100.0);
    let timing = push_broom(period_s);
    let motion = steady(DVec3::NEG_Y * pixel_m / period_s, 31.5 * period_s, DVec3::Z, down());
    let plate = crate::shapes::of_material(
        quad([-203.0, -157.0, dz], [203.0, -157.0, dz], [203.0, 157.0, dz], [-203.0, 157.0, dz]),
        1,
    );
    let mesh = joined(&[plane(1000.0, 0.0), plate]);
    let scene = moving_scene(mesh, [64, 64], pixel_m, &[1.0], &motion, timing);
    let (_, observation) = taken(&scene, &motion, timing);
    let plate = &observation.backplanes.plane("ABUNDANCE bright").unwrap().values;
    let larger = HEIGHT_M / (HEIGHT_M - dz);
    // A line's slit has the width of a pixel on the ground, and of larger^-1 of that on the plate.
    let slit_m = pixel_m / larger;
    for line in 0..64 {
        let y_m = (31.5 - line as f64) * pixel_m;
        let seen: f64 = plate[line * 64..(line + 1) * 64].iter().sum();
        // How much of the slit is on the plate.
        let on = |edge_m: f64| ((edge_m - y_m) / slit_m + 0.5).clamp(0.0, 1.0);
        let share = on(157.0) - on(-157.0);
        let expected = share * 2.0 * 203.0 * larger / pixel_m;
        assert!((seen - expected).abs() < 1e-9 * 41.0, "{line}: {seen} {expected}");
    }
}

#[test]
fn without_motion_all_lines_are_one() {
    let timing = push_broom(1.0);
    let motion = steady(DVec3::ZERO, 0.0, sun(60.0, 10.0).vec(), down());
    let relief = grid(200.0, 24, |x, y| 8.0 * (0.05 * x).sin() * (0.07 * y).cos());
    let scene = moving_scene(relief, [16, 5], 10.0, &[1.0], &motion, timing);
    let (cube, _) = taken(&scene, &motion, timing);
    let band = cube.band(0).to_vec();
    assert!(band[..16].iter().all(|l| *l > 0.0));
    (1..5).for_each(|line| assert_eq!(band[..16], band[16 * line..16 * (line + 1)]));
}

/// A mirror that turns the view about the sensor's x: line k looks at h tan(angle) along the way, whatever the optics.
#[test]
fn a_scan_looks_along_the_tangent_of_its_angle() {
    let timing = push_broom(0.5);
    let rate_rad_s = 0.01;
    // By the right hand about x the boresight turns up the image: towards +y here.
    let scan = Scan { axis: DVec3::X, start_rad: -0.04, rate_rad_s };
    let motion = steady(DVec3::ZERO, 0.0, DVec3::Z, Pointing { scan: Some(scan), ..down() });
    let scene = moving_scene(plane(4000.0, 0.0), [3, 17], 10.0, &[1.0], &motion, timing);
    let (_, observation) = taken(&scene, &motion, timing);
    let y = &observation.backplanes.plane("BODYFIXEDY").unwrap().values;
    for line in 0..17 {
        let angle = -0.04 + rate_rad_s * 0.5 * line as f64;
        let expected = HEIGHT_M * angle.tan();
        assert!((y[3 * line + 1] - expected).abs() < 1e-8, "{line}: {} {expected}", y[3 * line + 1]);
    }
}

/// Each band of a filter is the image of its own moment, to the last bit; and what moved by how much is known for every pixel.
#[test]
fn each_band_of_a_filter_is_taken_at_its_moment() {
    let timing = Timing { readout: Readout::Band, period_s: 2.0, exposure_s: 1.0, poses: 1 };
    let velocity = DVec3::new(3.0, -4.0, 0.0);
    let motion = steady(velocity, 6.0, sun(55.0, 200.0).vec(), down());
    let relief = grid(200.0, 24, |x, y| 8.0 * (0.05 * x).sin() * (0.07 * y).cos());
    let um = [1.0, 1.5, 2.0, 2.5, 3.0];
    let scene = moving_scene(relief, [16, 12], 10.0, &um, &motion, timing);
    let (cube, observation) = taken(&scene, &motion, timing);
    for (band, um) in um.into_iter().enumerate() {
        let epoch = motion.start.after_s(2.0 * band as f64 + 0.5);
        let mut alone = scene.exposure.clone();
        alone.bands = vec![Band::new(um, None)];
        let alone = motion.at(&scene, alone, epoch).unwrap();
        assert_eq!(cube.band(band), study::simulate(&alone, &unwatched).unwrap().1.cube.band(0), "{um}");
    }
    // On a plane at the camera's height h over what is seen, a shift by v dt is v dt / (h pitch) pixels, against the motion of the camera.
    let exposures = observation.exposures.unwrap();
    assert_eq!((exposures.reference, exposures.taken.len()), (Some(2), 5));
    let planes = &observation.backplanes;
    let z = &planes.plane("BODYFIXEDZ").unwrap().values;
    let pitch = scene.exposure.camera.pitch[0];
    for part in 0..5 {
        let dt_s = 2.0 * (part as f64 - 2.0);
        let [samples, lines] = [0, 1].map(|axis| exposures.displacement(planes, part, axis).unwrap().values);
        let mut seen = 0;
        for pixel in (0..z.len()).filter(|pixel| z[*pixel].is_finite()) {
            let per_m = 1.0 / (pitch * (HEIGHT_M + ORIGIN_M.z - z[pixel]));
            let expected = [-velocity.x * dt_s * per_m, velocity.y * dt_s * per_m];
            assert!((samples[pixel] - expected[0]).abs() < 1e-8 && (lines[pixel] - expected[1]).abs() < 1e-8);
            seen += 1;
        }
        assert!(seen > 150, "{seen}");
    }
}

/// An edge that moves 0.6 pixel during an exposure, from 0.4 to 1.0 of a pixel: a mean of 0.7 of it is beyond; and what moves inside the image loses no light.
#[test]
fn a_smear_is_the_mean_over_the_way() {
    // Bright ground at x < edge on dark ground of a hundredth: it is lit alike, so that contrast alone counts.
    let bright = |from: f64, to: f64| {
        let strip = quad([from, -500.0, 0.0], [to, -500.0, 0.0], [to, 500.0, 0.0], [from, 500.0, 0.0]);
        crate::shapes::of_material(strip, 1)
    };
    let dark = |from: f64, to: f64| quad([from, -500.0, 0.0], [to, -500.0, 0.0], [to, 500.0, 0.0], [from, 500.0, 0.0]);
    let pixel_m = 10.0;
    // In 1 s the camera goes 6 m along -x: what is seen goes 0.6 pixel to the right.
    let velocity = DVec3::NEG_X * 6.0;
    let seen = |mesh: Mesh, poses: u32| {
        let timing = Timing { readout: Readout::Frame, period_s: 0.0, exposure_s: 1.0, poses };
        let motion = steady(velocity, 0.5, DVec3::Z, down());
        let scene = moving_scene(mesh, [20, 4], pixel_m, &[1.0], &motion, timing);
        let scene = edited(&scene, |parts| {
            parts.surface.materials[0] = lambert(0, "dark", Spectrum::constant(0.002));
            parts.surface.materials[1] = lambert(1, "bright", Spectrum::constant(0.2));
        });
        taken(&scene, &motion, timing).0.band(0).to_vec()
    };
    // In the middle of the exposure the edge is at 0.7 of pixel 12: x = (12.7 - 10) pixels.
    let edge_m = (12.7 - 10.0) * pixel_m;
    let [full, least] = [0, 19].map(|pixel| seen(joined(&[bright(-500.0, edge_m), dark(edge_m, 500.0)]), 1)[pixel]);
    let share = |poses: u32| {
        let line = seen(joined(&[bright(-500.0, edge_m), dark(edge_m, 500.0)]), poses);
        (line[12] - least) / (full - least)
    };
    for poses in [2_u32, 5, 16] {
        // The edge does not leave the pixel: any number of poses has the mean.
        assert!((share(poses) - 0.7).abs() < 1e-9, "{poses}: {}", share(poses));
    }
    // From 0.7 to 1.3: 0.925 of the pixel, and the next one has the rest; within d / (8 n^2) of it.
    let edge_m = (13.0 - 10.0) * pixel_m;
    for poses in [2_u32, 3, 7, 50] {
        let line = seen(joined(&[bright(-500.0, edge_m), dark(edge_m, 500.0)]), poses);
        let [in_it, beyond] = [12, 13].map(|pixel| (line[pixel] - least) / (full - least));
        let bound = 0.6 / (8.0 * f64::from(poses * poses)) + 1e-9;
        assert!((in_it - 0.925).abs() <= bound && (beyond - 0.075).abs() <= bound, "{poses}: {in_it} {beyond}");
        assert!((in_it + beyond - 1.0).abs() < 1e-9, "{poses}");
    }
    // A bright strip inside the image sends as much as when it stands still.
    let strip = || joined(&[dark(-500.0, -23.0), bright(-23.0, 14.0), dark(14.0, 500.0)]);
    let sum = |poses: u32| -> f64 { seen(strip(), poses)[..20].iter().sum() };
    let still = sum(1);
    for poses in [2, 9] {
        assert!((sum(poses) / still - 1.0).abs() < 1e-12, "{poses}: {} {still}", sum(poses));
    }
}

/// Where nothing is known, nothing is made up.
#[test]
fn beyond_the_data_there_is_no_image() {
    let timing = Timing { readout: Readout::Band, period_s: 4000.0, exposure_s: 1.0, poses: 1 };
    let motion = steady(DVec3::X, 0.0, DVec3::Z, down());
    let scene = moving_scene(plane(1e5, 0.0), [4, 4], 10.0, &[1.0, 2.0, 3.0], &motion, timing);
    let scene =
        edited(&scene, |parts| parts.exposure.bands = [1.0, 2.0, 3.0, 4.0].map(|um| Band::new(um, None)).to_vec());
    let moving = Moving { scene: &scene, motion: &motion, timing, optics: None };
    let outcome =
        acquire_by_slabs(moving, (&Extremes::new(&scene), 1e-9), Wanted::default(), &mut |_| Ok(()), &unwatched)
            .unwrap_err();
    let said = outcome.to_string();
    assert!(said.contains("PROBE") && said.contains("a test covers"), "{said}");
}

/// The same with a Sun that goes along a straight line, by so many rad a second at first.
fn under_a_moving_sun(velocity_m_s: DVec3, to_sun: DVec3, rad_s: f64) -> Motion {
    let mut motion = steady(velocity_m_s, 0.0, to_sun, down());
    let mut almanac = Almanac::clone(&motion.almanac);
    let start_m = ORIGIN_M + to_sun.normalize() * FAR_M;
    let at = |s: f64| start_m + DVec3::X * (rad_s * s * FAR_M);
    let nodes = Nodes {
        tdb_s: vec![-1e4, 1e4],
        position_m: vec![at(-1e4), at(1e4)],
        velocity_m_s: vec![],
        interpolation: Interpolation::Lagrange(2),
    };
    let sun = almanac.trajectories.iter_mut().find(|t| t.target == "SUN").unwrap();
    sun.segments[0].path = Path::Nodes(nodes);
    motion.almanac = Arc::new(almanac);
    motion
}

/// Boxes on the ground, of sizes from far below a pixel to far above one, some with walls exactly on pixels' borders.
fn boxes(seed: u64, count: u32) -> Mesh {
    let mut random = Random(seed);
    let mut all = vec![plane(2000.0, 0.0)];
    for i in 0..count {
        let whole = |x: f64| if i % 2 == 0 { (x / 10.0).round() * 10.0 } else { x };
        let size = 3.0 * 40.0_f64.powf(random.share());
        let [x, y] = [0; 2].map(|_| whole(300.0 * (random.share() - 0.5)));
        let high = [x + whole(size).max(1.0), y + whole(0.7 * size).max(1.0), 5.0 + 60.0 * random.share()];
        let mut cuboid = cuboid([x, y, -1.0], high);
        cuboid.material.iter_mut().for_each(|material| material.0 = 1);
        all.push(cuboid);
    }
    joined(&all)
}

/// Each part of a cube by itself: the whole body, solved at its moment.
fn one_by_one(scene: &Scene, motion: &Motion, timing: Timing) -> Cube {
    let slab = |take: mmxrt::scene::Take| {
        let exposure = take.exposure(&scene.exposure);
        let then = motion.at(scene, exposure, motion.start.after_s(take.middle_s)).unwrap();
        let (_, seen) = study::simulate(&then, &unwatched).unwrap();
        let mut slab = seen.cube.into_slabs().remove(0);
        (slab.lines, slab.bands) = (take.lines, take.bands);
        slab
    };
    Cube::new(CubeAxes::of(&scene.exposure), timing.takes(&scene.exposure).map(slab).collect()).unwrap()
}

/// Differences of all values of two cubes over the median of what is bright, ascending.
fn differences(cube: &Cube, truth: &Cube) -> Vec<f64> {
    let [cube, truth] = [cube, truth].map(|cube| cube.to_array().into_iter().collect::<Vec<f64>>());
    let mut bright: Vec<f64> = truth.iter().copied().filter(|v| *v > 0.0).collect();
    bright.sort_by(f64::total_cmp);
    let median = bright[bright.len() / 2];
    let mut off: Vec<f64> = cube.iter().zip(&truth).map(|(a, b)| (a - b).abs() / median).collect();
    off.sort_by(f64::total_cmp);
    off
}

/// Shadows that move meanwhile: as if each part had been solved by itself, to the tolerance in 999 of 1000 values, and to rounding where the tolerance leaves nothing.
#[test]
fn shadows_between_solved_moments_are_within_the_tolerance() {
    let um: Vec<f64> = (0..40).map(|i| 1.0 + 0.01 * f64::from(i)).collect();
    for (seed, elevation) in [(1, 0.9_f64), (2, 0.5), (3, 0.25)] {
        let to_sun = DVec3::new(elevation.cos() * 0.6, elevation.cos() * 0.8, elevation.sin());
        let motion = under_a_moving_sun(DVec3::X * 2.0, to_sun, 2e-4);
        let timing = Timing { readout: Readout::Band, period_s: 1.0, exposure_s: 0.0, poses: 1 };
        let scene = moving_scene(boxes(seed, 12), [20, 20], 10.0, &um, &motion, timing);
        let truth = one_by_one(&scene, &motion, timing);
        for tolerance in [1e-2, 1e-9] {
            let mut slabs: Vec<Slab> = Vec::new();
            let mut put = |slab| {
                slabs.push(slab);
                Ok(())
            };
            let moving = Moving { scene: &scene, motion: &motion, timing, optics: None };
            let asked = (&Extremes::new(&scene), tolerance);
            let (_, told) = acquire_by_slabs(moving, asked, Wanted::default(), &mut put, &unwatched).unwrap();
            let cube = Cube::new(CubeAxes::of(&scene.exposure), slabs).unwrap();
            let off = differences(&cube, &truth);
            let steady = told.warnings.iter().any(|said| said.contains("interpolated between"));
            if tolerance > 1e-3 {
                assert!(steady, "{elevation}: {:?}", told.warnings);
                // It is found at three moments, and holds at all to a factor that is theirs.
                assert!(
                    off[off.len() - 1 - off.len() / 1000] <= 2.0 * tolerance,
                    "{elevation}: {}",
                    off[off.len() - 17]
                );
                assert!(off[off.len() - 1] > 1e-9, "shadows do not move");
            } else {
                assert!(!steady && off[off.len() - 1] < 1e-12, "{elevation}: {}", off[off.len() - 1]);
            }
        }
    }
}

/// Lines that look at the facets near their slits alone see what they would of all: walls that are edge-on, facets far larger than blocks of lines, borders of pixels on
/// borders of facets, a slit beside everything.
#[test]
fn lines_of_a_push_broom_lose_no_facet() {
    for seed in 1..=6 {
        let to_sun = DVec3::new(0.5, -0.3, 0.4);
        // Steps of a pixel a line, of 0.37 of one, and none at all.
        let velocity = [10.0, 3.7, 0.0][seed as usize % 3];
        let motion = under_a_moving_sun(DVec3::NEG_Y * velocity, to_sun, 1e-5);
        let timing = push_broom(1.0);
        let scene = moving_scene(boxes(seed, 20), [24, 40], 10.0, &[1.0, 2.0], &motion, timing);
        let truth = one_by_one(&scene, &motion, timing);
        let (cube, _) = taken(&scene, &motion, timing);
        let off = differences(&cube, &truth);
        assert!(off[off.len() - 1] < 1e-12, "{seed}: {}", off[off.len() - 1]);
    }
}

/// The slit of a push-broom lies on the boresight, however many lines it takes, and wherever a frame's boresight would be.
#[test]
fn a_single_line_is_a_slit_too() {
    let timing = push_broom(1.0);
    for lines in [1, 5] {
        let motion = steady(DVec3::NEG_Y, 0.0, DVec3::Z, down());
        let scene = moving_scene(plane(1e3, 0.0), [4, lines], 10.0, &[1.0], &motion, timing);
        let scene = edited(&scene, |parts| parts.exposure.camera.boresight_px[1] = 3.0);
        for take in timing.takes(&scene.exposure) {
            let camera = take.exposure(&scene.exposure).camera;
            assert_eq!((camera.lines, camera.boresight_px[1]), (1, 0.5));
        }
    }
}
