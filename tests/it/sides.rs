//! Inner sides: black, blocking, and left out only where nobody can see them.

use glam::DVec3;
use mmxrt::Error;
use mmxrt::formats::scene_toml;
use mmxrt::geometry::Mesh;
use mmxrt::progress::unwatched;
use mmxrt::scene::Exposure;
use mmxrt::study::{Observation, simulate};
use mmxrt::visibility::{Enclosure, Topology};

use crate::scratch::Scratch;
use crate::shapes::*;

/// A scene in `tests/data/geometry`, beside which an independent program in quad precision has put the whole right image.
fn observed(case: &str) -> (Observation, Vec<[f64; 2]>) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geometry").join(case);
    let scene = scene_toml::read(&folder.join("s.toml"), &unwatched).unwrap().scene;
    let (_, observation) = simulate(&scene, &unwatched).unwrap();
    let text = std::fs::read_to_string(folder.join("expected.csv")).unwrap();
    let expected = text.lines().skip(1).map(|line| {
        let number = |k: usize| line.split(',').nth(k).unwrap().parse().unwrap();
        [number(2), number(3)]
    });
    (observation, expected.collect())
}

/// Coverage and radiance of every pixel; the scenes' Sun has 1000 W m-2 um-1.
pub(crate) fn assert_right(case: &str, tolerance: f64) -> Observation {
    let (observation, expected) = observed(case);
    for check in &observation.checks {
        assert!(check.passed(), "{case}: {check:?}");
    }
    let coverage = &observation.backplanes.plane("COVERAGE").unwrap().values;
    let radiance = observation.cube.band(0);
    assert!(expected.len() == coverage.len() && expected.iter().any(|e| e[0] > 0.0));
    for (p, [covered, sent]) in expected.into_iter().enumerate() {
        let got = [coverage[p], radiance[p] * std::f64::consts::PI / 1000.0];
        assert!(
            (got[0] - covered).abs() <= tolerance && (got[1] - sent).abs() <= tolerance,
            "{case}, pixel {p}: {got:?}, not {covered} {sent}"
        );
    }
    observation
}

#[test]
fn an_eye_inside_one_part_of_several_sees_its_dark_inside() {
    let seen = assert_right("camera_inside_closed_part", 1e-12);
    assert!(seen.warnings.iter().any(|w| w.contains("the camera is inside a closed part")), "{:?}", seen.warnings);
}

#[test]
fn an_eye_on_a_face_sees_the_dark_inside() {
    for case in ["camera_on_face_simple", "camera_on_body_simple"] {
        let seen = assert_right(case, 1e-12);
        assert!(seen.warnings.iter().any(|w| w.contains("on the surface of a closed part")), "{:?}", seen.warnings);
    }
}

#[test]
fn a_sheet_with_two_sides_shows_the_outer_one() {
    let seen = assert_right("two_sided_sheet", 1e-12);
    assert!(seen.warnings.is_empty(), "{:?}", seen.warnings);
    assert_eq!(seen.counts.visible_facets, 2);
}

#[test]
fn two_sides_within_rounding_of_one_another_show_the_outer_one() {
    // The reverse lies 1e-17 to 1e-15 m above the sheet or below it, with either diagonal.
    for gap in [1e-17, -1e-17, 3e-16, -3e-16, 1e-15, -1e-15] {
        for turn in 0..4 {
            let p = |z: f64| [[-2.0, -2.0, z], [2.0, -2.0, z], [2.0, 2.0, z], [-2.0, 2.0, z]];
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| p(gap)[(k + turn) % 4]);
            let [e, f, g, h] = p(0.0);
            let both = joined(&[quad(d, c, b, a), quad(e, f, g, h)]);
            let seen = see(&both, direction([0.3, 0.2, 1.0]), &nadir(5.0, 4.0, 4));
            let (area, lit) = totals(&seen, |f| f >= 2);
            assert!((area - 16.0).abs() < 1e-12 && (lit - 16.0).abs() < 1e-12, "{gap} {turn}: {area} {lit}");
        }
    }
}

fn enclosure(mesh: &Mesh, eye: [f64; 3]) -> (usize, usize) {
    let Enclosure { inside, on } = Topology::new(mesh).enclosure(mesh, DVec3::from_array(eye));
    (inside, on)
}

#[test]
fn each_closed_part_is_asked_whether_the_eye_is_in_it() {
    // Two bodies that overlap, a room whose walls face inward, and an open sheet.
    let walls = {
        let mut walls = cuboid([-9.0; 3], [9.0; 3]);
        walls.facets.iter_mut().for_each(|f| f.swap(0, 1));
        walls
    };
    let ball = sphere([3.0, 0.0, 0.0], 2.0, 3);
    let mesh = joined(&[walls, cuboid([0.0; 3], [4.0, 2.0, 2.0]), ball, plane(8.0, -3.0)]);
    for (eye, expected) in [
        ([-5.0, 0.0, 0.0], (0, 0)),
        ([0.5, 1.0, 1.0], (1, 0)),
        ([3.0, 0.5, 0.5], (2, 0)),
        ([0.0, 1.0, 1.0], (0, 1)),
        ([0.0, 0.0, 0.0], (0, 1)),
        // On a face of the box and inside the ball.
        ([3.0, 0.5, 0.0], (1, 1)),
        // In the plane of a face, beside it; on the sheet; outside of everything.
        ([-1.0, 1.0, 0.0], (0, 0)),
        ([-1.0, 1.0, -3.0], (0, 0)),
        ([1e9, 1.0, 1.0], (0, 0)),
    ] {
        assert_eq!(enclosure(&mesh, eye), expected, "{eye:?}");
    }
    // A unit in the last place off a face may be either side; 1e-12 is not.
    let cube = cuboid([1.0; 3], [2.0; 3]);
    assert_eq!(enclosure(&cube, [1.5, 1.5, 2.0_f64.next_up()]), (0, 1));
    assert_eq!(enclosure(&cube, [1.5, 1.5, 2.0 + 1e-12]), (0, 0));
    assert_eq!(enclosure(&cube, [1.5, 1.5, 2.0 - 1e-12]), (1, 0));
}

#[test]
fn only_inside_the_only_body_is_an_error() {
    let down = |x: f64, z: f64| camera([x, 4.0, z], [x, 4.0, z - 1.0], [0.0, 1.0, 0.0], 8, 1e-2);
    let hills = || grid(50.0, 30, |x, y| 4.0 * (0.15 * x).sin() * (0.2 * y + 0.1 * x).cos());
    let ball = sphere([0.0; 3], 10.0, 3);
    let site = joined(&[hills(), cuboid([0.0, 0.0, -10.0], [10.0, 10.0, 30.0])]);
    let two = joined(&[ball.clone(), sphere([100.0, 0.0, 0.0], 10.0, 2)]);
    let (behind, inside) =
        ("100.0 % of what the camera sees is the back of facets", "the camera is inside a closed part");
    for (what, mesh, camera, words) in [
        ("above a ball", &ball, down(3.0, 11.0), ""),
        ("far above a ball", &ball, down(3.0, 1e6), ""),
        (
            "just below hills, looking up",
            &hills(),
            camera([3.0, 4.0, -9.0], [3.0, 4.0, 0.0], [0.0, 1.0, 0.0], 8, 1e-2),
            behind,
        ),
        ("among hills", &hills(), down(3.0, 3.9), ""),
        ("above hills", &hills(), down(3.0, 50.0), ""),
        ("in a block on hills", &site, down(3.0, 20.0), inside),
        ("above a block on hills", &site, down(3.0, 40.0), ""),
        ("in one of two balls", &two, down(3.0, 1.0), inside),
    ] {
        let scene = crate::scenes::scene(of_material(mesh.clone(), 0), camera, [0.3, 0.2, 1.0]);
        let (_, seen) = simulate(&scene, &unwatched).unwrap();
        let of_sides = |w: &&String| w.contains("back of facets") || w.contains("closed part");
        let told: Vec<&String> = seen.warnings.iter().filter(of_sides).collect();
        assert!(told.iter().any(|w| w.contains(words)) != told.is_empty(), "{what}: {told:?}");
        assert_eq!(told.is_empty(), words.is_empty(), "{what}: {told:?}");
    }
    let scene = crate::scenes::scene(of_material(ball, 0), down(3.0, 11.0), [0.3, 0.2, 1.0]);
    let refused = scene.seen_by(Exposure { camera: down(3.0, 1.0), ..scene.exposure.clone() });
    let Err(Error::Invalid(problems)) = refused else { panic!("{refused:?}") };
    assert_eq!((problems.len(), problems[0].at.item.as_deref()), (1, Some("observer.position_m")));
    assert!(problems[0].message.contains("inside the surface"), "{}", problems[0].message);
}

#[test]
fn open_panels_become_a_scene() {
    // Two upright panels back to back, open above.
    let scratch = Scratch::new();
    let obj =
        "v -1 0 0\nv 1 0 0\nv 1 0 2\nv -1 0 2\nv -1 0.1 0\nv 1 0.1 0\nv 1 0.1 2\nv -1 0.1 2\nf 1 2 3 4\nf 8 7 6 5\n";
    let path = scratch.write("m.obj", obj).into_os_string().into_string().unwrap();
    let (code, _, err) = crate::cli::run(&["convert", &path, &scratch.argument("s/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    let scene = scene_toml::read(&scratch.join("s/scene.toml"), &unwatched).unwrap().scene;
    assert_eq!(scene.body.mesh.facets.len(), 4);
}
