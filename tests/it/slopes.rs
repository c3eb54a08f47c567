//! Planes of slopes and of ground sampling, which on a tilted plane are by hand; and of single exposures of a filter.

use glam::DVec3;
use mmxrt::geometry::Mesh;
use mmxrt::integrate::Wanted;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Readout, Scene, Timing};
use mmxrt::study::{self, Extremes, Moving, acquire_by_slabs};

use crate::cli::run;
use crate::motion::{down, moving_scene, steady};
use crate::scenes::{edited, scene};
use crate::scratch::Scratch;
use crate::shapes::{camera, grid};

/// 11 km from the centre of the body on its x: east is y, north z.
const ORIGIN_M: DVec3 = DVec3::new(11_000.0, 0.0, 0.0);

/// Ground through the origin that goes down by `slope` towards an azimuth from north by east.
fn tilted(slope_deg: f64, azimuth_deg: f64) -> Mesh {
    let (grade, (sin, cos)) = (slope_deg.to_radians().tan(), azimuth_deg.to_radians().sin_cos());
    let mut mesh = grid(300.0, 3, |east, north| -grade * (east * sin + north * cos));
    // x, y, z of the grid are east, north, up: y, z, x of the body.
    mesh.vertices_m.iter_mut().for_each(|p| *p = DVec3::new(p.z, p.x, p.y));
    mesh
}

/// The middle pixel, whose centre ray goes through the origin from an emission towards an azimuth.
fn planes(mesh: Mesh, emission_deg: f64, azimuth_deg: f64) -> impl Fn(&str) -> f64 {
    let (e, (sin, cos)) = (emission_deg.to_radians(), azimuth_deg.to_radians().sin_cos());
    let from = 1e4 * DVec3::new(e.cos(), e.sin() * sin, e.sin() * cos);
    let camera = camera(from.to_array(), [0.0; 3], [0.1, sin, cos], 5, 1e-3);
    let scene: Scene = edited(&scene(mesh, camera, [1.0, 0.3, 0.4]), |parts| parts.surface.origin_m = ORIGIN_M);
    let seen = study::simulate(&scene, &unwatched).unwrap().1;
    move |name| seen.backplanes.plane(name).unwrap_or_else(|| panic!("no {name}")).values[12]
}

#[test]
fn slopes_go_down_where_the_ground_does() {
    for (slope, azimuth) in [(20.0, 0.0), (5.0, 90.0), (35.0, 225.0), (60.0, 300.0)] {
        let of = planes(tilted(slope, azimuth), 10.0, azimuth);
        // The centre ray meets the origin, where up is x; the mean is of a few pixels of 10 m: 1e-3 rad.
        assert!(
            (of("SLOPE") - slope).abs() < 1e-9 && (of("SLOPEAZIMUTH") - azimuth).abs() % 360.0 < 1e-7,
            "{slope} {azimuth}: {} {}",
            of("SLOPE"),
            of("SLOPEAZIMUTH")
        );
        assert!((of("SLOPE_MEAN") - slope).abs() < 0.1);
        let off = (of("SLOPEAZIMUTH_MEAN") - azimuth + 180.0).rem_euclid(360.0) - 180.0;
        assert!(off.abs() < 0.5, "{off}");
        assert!((of("RADIUS") - 11_000.0).abs() < 1e-9);
        let mean = DVec3::from_array(["X", "Y", "Z"].map(|k| of(&format!("BODYFIXED{k}_MEAN")))).length();
        assert!((of("RADIUS_MEAN") - mean).abs() < 1e-9);
    }
    let level = planes(tilted(0.0, 0.0), 10.0, 0.0);
    assert!(level("SLOPE").abs() < 1e-9 && level("SLOPEAZIMUTH") == 0.0);
}

/// A pixel is range x pitch wide; along the plane of emission, here from line to line, 1 / cos e of that.
#[test]
fn ground_is_sampled_wider_where_it_is_seen_at_a_slant() {
    for emission in [0.0_f64, 30.0, 60.0, 75.0] {
        let of = planes(tilted(0.0, 0.0), emission, 0.0);
        assert!((of("PIXELRESOLUTION") / 10.0 - 1.0).abs() < 1e-12);
        assert!((of("GSD_SAMPLE") / 10.0 - 1.0).abs() < 1e-9);
        assert!((of("GSD_LINE") * emission.to_radians().cos() / 10.0 - 1.0).abs() < 1e-9, "{emission}");
    }
    // The ground's own slope counts: seen from straight above it.
    let of = planes(tilted(25.0, 0.0), 25.0, 0.0);
    assert!((of("GSD_LINE") / 10.0 - 1.0).abs() < 1e-9);
}

/// Backplanes of single exposures are those of the scene at their moment.
#[test]
fn exposures_of_a_filter_have_planes_of_their_own() {
    let timing = Timing { readout: Readout::Band, period_s: 2.0, exposure_s: 1.0, poses: 1 };
    let motion = steady(DVec3::new(3.0, -4.0, 0.0), 6.0, DVec3::new(1.0, 0.0, 1.0), down());
    let relief = grid(200.0, 12, |x, y| 8.0 * (0.05 * x).sin() * (0.07 * y).cos());
    let scene = moving_scene(relief, [16, 12], 10.0, &[1.0, 1.5, 2.0], &motion, timing);
    let moving = Moving { scene: &scene, motion: &motion, timing, optics: None };
    let taken = |planes_of: &[usize]| {
        let wanted = Wanted { planes_of, ..Wanted::default() };
        acquire_by_slabs(moving, (&Extremes::new(&scene), 1e-9), wanted, &mut |_| Ok(()), &unwatched)
    };
    let exposures = taken(&[2, 0]).unwrap().1.exposures.unwrap();
    assert_eq!(exposures.taken.iter().map(|part| part.backplanes.is_some()).collect::<Vec<_>>(), [true, false, true]);
    for band in [0, 2] {
        let mut alone = scene.exposure.clone();
        alone.bands.truncate(1);
        let then = motion.at(&scene, alone, motion.start.after_s(2.0 * band as f64 + 0.5)).unwrap();
        let of = exposures.taken[band].backplanes.as_ref().unwrap();
        let expected = study::simulate(&then, &unwatched).unwrap().1.backplanes;
        assert_eq!(of.plane("BODYFIXEDX"), expected.plane("BODYFIXEDX"));
        assert_eq!(of.plane("PHASE"), expected.plane("PHASE"));
    }
    assert!(taken(&[3]).unwrap_err().to_string().contains("band 4"));
}

#[test]
fn a_still_scene_has_no_exposures_to_have_planes_of() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", crate::scenes::SITE);
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--planes-of", "1"]);
    assert!(code == 1 && err.contains("--planes-of") && err.contains("tunable_filter"), "{err}");
}
