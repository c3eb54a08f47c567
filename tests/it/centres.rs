//! What stands at a pixel's centre where the centre is aimed at an edge or a corner, or lies in the plane of a wall.

use glam::DVec3;
use mmxrt::study::Observation;

use crate::scratch::Scratch;
use crate::shapes::Random;

/// A ground of 40 m and a box of 3 m on it, with corners at (-3, -2) and (0, 0).
const BOX: &str = "v -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\nv -3 -2 0\nv 0 -2 0\nv 0 0 0\nv -3 0 0\nv -3 -2 3\nv 0 -2 3\nv 0 0 3\nv -3 0 3\n\
    f 1 2 3 4\nf 9 10 11 12\nf 5 6 10 9\nf 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12\n";

fn seen(sun: [f64; 3], eye_m: DVec3, target_m: DVec3, up: [i32; 3], pixels: u32, fov_deg: f64) -> Observation {
    let scratch = Scratch::new();
    scratch.write("m.obj", BOX);
    let (eye, target) = (eye_m.to_array(), target_m.to_array());
    scratch.look(&format!(
        "mmxrt_scene = 1\norigin_m = [0, 0, 0]\nmesh = [{{ obj = \"m.obj\" }}]\nmaterials = {{ default = {{ reflectance = 0.1 }} }}\n\
         thermal = {{ model = \"off\" }}\nsun = {{ direction = {sun:?}, distance_au = 1 }}\n\
         observer = {{ position_m = {eye:?}, target_m = {target:?}, up = {up:?} }}\n\
         sensor = {{ samples = {pixels}, lines = {pixels}, fov_deg = {fov_deg:?}, bands = {{ centres_um = [1.0] }} }}\n"
    ))
}

fn plane<'a>(seen: &'a Observation, name: &str) -> &'a [f64] {
    &seen.backplanes.planes.iter().find(|p| p.name == name).unwrap().values
}

#[test]
fn an_edge_that_is_lit_all_around_is_lit() {
    let mut random = Random(5);
    let (mut lit, mut tried) = (0, 0);
    // Corners of the box at the ground and on top, and points of its edges; the Sun and the camera stand before both walls.
    let targets =
        [[0.0, 0.0, 0.0], [0.0, 0.0, 3.0], [0.0, 0.0, 1.0], [0.0, -1.0, 3.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    for round in 0..90 {
        let target_m = DVec3::from_array(targets[round % targets.len()]);
        let away_m = [30.0, 100.0, 2000.0][round % 3];
        let [x, y, z] = [(); 3].map(|()| 0.5 + random.share());
        let eye_m = target_m + away_m * DVec3::new(x, y, z).normalize();
        let sun = [[2.0, 1.0, 2.0], [1.0, 1.0, 1.0], [1.0, 0.5, 0.3]][(round / 6) % 3];
        let seen = seen(sun, eye_m, target_m, [0, 0, 1], 3, (3.0 / away_m).to_degrees());
        let at = |name: &str| plane(&seen, name)[4];
        tried += 1;
        assert!((at("COVERAGE") - 1.0).abs() < 1e-11);
        // The line of sight through the target is as long as the way to it.
        assert!((at("RANGE") / away_m - 1.0).abs() < 1e-9, "{} {away_m}", at("RANGE"));
        if at("LIT_FRACTION") > 1.0 - 1e-9 {
            lit += 1;
            assert_eq!(at("SUNILLUMINATIONMASK"), 1.0, "{target_m} {eye_m} {sun:?}");
        }
    }
    assert!(tried == 90 && lit > 40, "{lit} of {tried}");
}

#[test]
fn a_wall_in_the_line_of_sight_hides_nothing_and_loses_nothing() {
    // Straight above the wall x = 0, from afar: the middle column of pixels looks along it, at the roof's edge or at the ground.
    let seen = seen([1.0, 0.0, 3.0], DVec3::new(0.0, -0.5, 7770.0), DVec3::new(0.0, -0.5, 0.0), [0, 1, 0], 9, 0.04);
    let ranges = plane(&seen, "RANGE");
    for name in ["RANGE", "RANGE_MEAN", "BODYFIXEDZ", "BODYFIXEDZ_MEAN", "LATITUDE_MEAN", "LOCALEMISSION_MEAN"] {
        assert!(plane(&seen, name).iter().all(|value| value.is_finite()), "{name}: {:?}", plane(&seen, name));
    }
    for line in 0..9 {
        let range_m = ranges[9 * line + 4];
        let slant = |height_m: f64| {
            // Half the field spans 4.5 pixels.
            let tan = (line as f64 - 4.0) / 4.5 * 0.02_f64.to_radians().tan();
            (7770.0 - height_m) * (1.0 + tan * tan).sqrt()
        };
        assert!(
            (range_m - slant(0.0)).abs() < 1e-6 || (range_m - slant(3.0)).abs() < 1e-6,
            "line {line}: {range_m}, not {} or {}",
            slant(0.0),
            slant(3.0)
        );
    }
    assert!(plane(&seen, "SUNILLUMINATIONMASK").iter().filter(|mask| **mask == 1.0).count() > 60);
}
