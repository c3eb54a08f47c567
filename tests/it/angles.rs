//! Scenes whose Sun and camera are given by angles above a target.

use glam::DVec3;
use mmxrt::error::Error;
use mmxrt::formats::scene_toml::{self, SceneFile};
use mmxrt::geometry::Direction;
use mmxrt::progress::unwatched;

use crate::scratch::Scratch;
use crate::shapes::Random;

/// A level square of 2 m around the origin on the body's x axis, where the zenith is +x, east +y and north +z.
fn text(geometry: &str) -> String {
    format!(
        "mmxrt_scene = 1\norigin_m = [11000, 0, 0]\nmesh = [{{ obj = \"m.obj\", pose = \"radial\" }}]\n\
         materials = {{ default = {{ reflectance = 0.07 }} }}\nthermal = {{ model = \"off\" }}\nsun = {{ distance_au = 1.5 }}\n\
         sensor = {{ samples = 4, lines = 4, fov_deg = 0.01, bands = {{ centres_um = [1.0] }} }}\n{geometry}\n"
    )
}

fn read(text: &str) -> Result<SceneFile, Error> {
    let scratch = Scratch::new();
    scratch.write("m.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    scene_toml::read(&scratch.write("scene.toml", text), &unwatched)
}

fn placed(geometry: &str) -> SceneFile {
    read(&text(&format!("geometry = {{ {geometry} }}"))).unwrap_or_else(|e| panic!("{geometry}: {e}"))
}

fn refused(text: &str) -> String {
    read(text).map(|file| panic!("{text}: {:?}", file.notes)).unwrap_err().to_string()
}

#[test]
fn sun_and_camera_stand_where_the_angles_say() {
    let by = |altitude: &str| {
        placed(&format!(
            "incidence_deg = 60, sun_azimuth_deg = 90, emission_deg = 30, observer_azimuth_deg = 0, {altitude}"
        ))
    };
    // By hand: 2000 m at 30 deg from the zenith, in the north.
    let (half, root) = (0.5, 0.75_f64.sqrt());
    for file in [by("range_m = 2000"), by(&format!("altitude_m = {}", 2000.0 * root))] {
        let camera = &file.scene.exposure.camera;
        assert!((file.scene.sky.sun.direction.vec() - DVec3::new(half, root, 0.0)).length() < 1e-15);
        assert!((camera.centre_m() - DVec3::new(2000.0 * root, 0.0, 1000.0)).length() < 1e-12);
        let axes = camera.world_from_sensor.rotation;
        // It looks south and down; east, which is right of north on a map, is on the right.
        assert!((axes.z_axis - DVec3::new(-root, 0.0, -half)).length() < 1e-15);
        assert!((axes.x_axis - DVec3::Y).length() < 1e-15);
        assert!(file.notes.is_empty(), "{:?}", file.notes);
        let items: Vec<_> =
            file.defaults.iter().map(|d| d.item.as_str()).filter(|i| i.starts_with("geometry")).collect();
        assert_eq!(items, ["geometry.target_m", "geometry.up"]);
    }
}

#[test]
fn the_image_is_that_of_the_same_positions() {
    let scratch = Scratch::new();
    scratch.write("m.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    let by_angles = scratch.look(&text(
        "geometry = { incidence_deg = 60, sun_azimuth_deg = 90, emission_deg = 30, observer_azimuth_deg = 0, range_m = 2000 }",
    ));
    let root = 0.75_f64.sqrt();
    let positions = format!(
        "observer = {{ position_m = [{}, 0, 1000], target_m = [11000, 0, 0], up = [0, 0, 1] }}\n",
        11000.0 + 2000.0 * root
    );
    let sun = format!("sun = {{ direction = [0.5, {root}, 0], distance_au = 1.5 }}");
    let by_positions = scratch.look(&text(&positions).replace("sun = { distance_au = 1.5 }", &sun));
    let (a, b) = (by_angles.cube.band(0), by_positions.cube.band(0));
    assert!(b.iter().any(|l| *l > 1.0) && a.len() == 16);
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= 1e-12 * b, "{a} {b}");
    }
}

#[test]
fn the_phase_stands_for_an_azimuth() {
    let mut random = Random(7);
    let mut tried = 0;
    for _ in 0..300 {
        let (i, e) = (180.0 * random.share(), 180.0 * random.share());
        let (least, most) = ((i - e).abs(), (i + e).min(360.0 - i - e));
        let phase = least + (most - least) * random.share();
        let azimuth = 720.0 * random.share() - 360.0;
        let target = DVec3::from_array([(); 3].map(|()| 2e4 * random.share() - 1e4));
        for key in ["sun_azimuth_deg", "observer_azimuth_deg"] {
            let [x, y, z] = target.to_array();
            let file = placed(&format!(
                "incidence_deg = {i:?}, emission_deg = {e:?}, phase_deg = {phase:?}, {key} = {azimuth:?}, range_m = 5e4, \
                 target_m = [{x:?}, {y:?}, {z:?}], up = \"zenith\""
            ));
            let local_m = target - DVec3::new(11000.0, 0.0, 0.0);
            let zenith = Direction::new(target).unwrap();
            let sun = file.scene.sky.sun.direction;
            let camera = Direction::new(file.scene.exposure.camera.centre_m() - local_m).unwrap();
            for (angle, asked) in
                [(sun.angle_rad(zenith), i), (camera.angle_rad(zenith), e), (sun.angle_rad(camera), phase)]
            {
                assert!((angle.to_degrees() - asked).abs() < 1e-6, "{i} {e} {phase} {azimuth}: {angle} {asked}");
            }
            // The camera is clockwise of the Sun, seen from above; the azimuth that is given is kept.
            assert!(sun.vec().cross(camera.vec()).dot(zenith.vec()) <= 1e-9);
            let east = DVec3::Z.cross(zenith.vec()).normalize();
            let of = if key.starts_with("sun") { sun } else { camera };
            let seen = of.vec().dot(east).atan2(of.vec().dot(zenith.vec().cross(east))).to_degrees();
            assert!(
                (seen - azimuth).rem_euclid(360.0).min((azimuth - seen).rem_euclid(360.0)) < 1e-6,
                "{seen} {azimuth}"
            );
            // The horizon is level: the right of the image has no height.
            assert!(file.scene.exposure.camera.world_from_sensor.rotation.x_axis.dot(zenith.vec()).abs() < 1e-9);
            tried += 1;
        }
    }
    assert_eq!(tried, 600);
}

#[test]
fn the_ends_of_angles_are_defined() {
    // Both in the zenith: no azimuth is needed.
    let nadir = placed("incidence_deg = 0, emission_deg = 0, altitude_m = 100").scene;
    assert_eq!(nadir.sky.sun.direction.vec(), DVec3::X);
    assert_eq!(nadir.exposure.camera.centre_m(), DVec3::new(100.0, 0.0, 0.0));
    // One in the zenith: the other's azimuth is enough, and the phase is its angle.
    let one = placed(
        "incidence_deg = 0, emission_deg = 90, phase_deg = 90, observer_azimuth_deg = 180, range_m = 10, up = \"zenith\"",
    );
    assert_eq!(one.scene.exposure.camera.centre_m(), DVec3::new(0.0, 0.0, -10.0));
    // A grazing Sun is in the plane to the last digit.
    let grazing = placed("incidence_deg = 90, sun_azimuth_deg = 270, emission_deg = 0, altitude_m = 100").scene;
    assert_eq!(grazing.sky.sun.direction.vec(), DVec3::NEG_Y);
    // Opposition and forward scattering are within reach, and a phase of few digits is taken at its end.
    for phase in ["10.0", "9.995"] {
        let file = placed(&format!(
            "incidence_deg = 30, emission_deg = 20, phase_deg = {phase}, sun_azimuth_deg = 40, range_m = 100"
        ));
        let camera = Direction::new(file.scene.exposure.camera.centre_m()).unwrap();
        assert!((camera.angle_rad(file.scene.sky.sun.direction).to_degrees() - 10.0).abs() < 1e-9);
        assert_eq!(file.notes.len(), usize::from(phase == "9.995"), "{:?}", file.notes);
    }
    // Below the horizon: computed, and told.
    let night = placed("incidence_deg = 100, sun_azimuth_deg = 0, emission_deg = 0, altitude_m = 100");
    assert!(night.notes.iter().any(|n| n.contains("below the target's horizon")), "{:?}", night.notes);
}

#[test]
fn one_of_the_two_may_be_given_by_angles_and_the_frame_may_be_the_sites() {
    let observer = "observer = { frame = \"site\", position_m = [0, 0, 500], target_m = [0, 0, 0], up = [0, 1, 0] }\n";
    let file = read(&text(&format!(
        "geometry = {{ frame = \"site\", incidence_deg = 45, sun_azimuth_deg = 180 }}\n{observer}"
    )))
    .unwrap();
    let half = 0.5_f64.sqrt();
    assert!((file.scene.sky.sun.direction.vec() - DVec3::new(half, 0.0, -half)).length() < 1e-15);
    // At a pole east is y of the body, so that the south is +x; and a slope's normal makes its own zenith: of a wall that faces east.
    let pole = text("geometry = { incidence_deg = 90, sun_azimuth_deg = 180, emission_deg = 0, range_m = 10 }")
        .replace("[11000, 0, 0]", "[0, 0, 9000]");
    let pole = read(&pole).unwrap();
    assert!((pole.scene.sky.sun.direction.vec() - DVec3::X).length() < 1e-15);
    assert!(pole.notes.iter().any(|n| n.contains("+y of the body")), "{:?}", pole.notes);
    for (normal, frame) in [("[0, 5, 0]", "body"), ("[3, 0, 0]", "site")] {
        let wall = placed(&format!(
            "frame = \"{frame}\", normal = {normal}, incidence_deg = 90, sun_azimuth_deg = 90, emission_deg = 0, range_m = 10"
        ));
        // East of a wall's own horizon is down, and the camera is east of it.
        assert!(
            (wall.scene.sky.sun.direction.vec() - DVec3::NEG_X).length() < 1e-15,
            "{:?}",
            wall.scene.sky.sun.direction
        );
        assert!((wall.scene.exposure.camera.centre_m() - DVec3::new(0.0, 10.0, 0.0)).length() < 1e-12);
    }
}

#[test]
fn what_angles_do_not_say_is_asked_for() {
    let cases = [
        ("", "places nothing"),
        ("incidence_deg = 10", "`sun_azimuth_deg` is missing"),
        ("incidence_deg = 10, sun_azimuth_deg = 1, phase_deg = 3", "goes with `incidence_deg` and `emission_deg`"),
        (
            "incidence_deg = 10, sun_azimuth_deg = 1, emission_deg = 5, altitude_m = 9",
            "`observer_azimuth_deg` is missing",
        ),
        ("incidence_deg = 10, sun_azimuth_deg = 1, emission_deg = 5, observer_azimuth_deg = 0", "one of `altitude_m`"),
        ("incidence_deg = 200, sun_azimuth_deg = 1", "200 is more than 180"),
        ("incidence_deg = nan, sun_azimuth_deg = 1", "nan"),
        ("emission_deg = 0, range_m = inf", "inf"),
        ("emission_deg = 90, observer_azimuth_deg = 1, altitude_m = 5", "give `range_m`"),
        ("emission_deg = 0, range_m = 0", "0 is not more than 0"),
        ("emission_deg = 0, range_m = 5, normal = [0, 0, 0]", "has no length"),
        ("emission_deg = 0, range_m = 5, target_m = [0, 0, 0]", "no zenith"),
        ("emission_deg = 0, range_m = 5, up = \"zenith\"", "is along the line of sight"),
        ("emission_deg = 90, observer_azimuth_deg = 0, range_m = 5", "is along the line of sight"),
        ("emission_deg = 0, range_m = 5, up = \"sun\"", "goes with `incidence_deg`"),
        (
            "incidence_deg = 30, emission_deg = 20, phase_deg = 51, sun_azimuth_deg = 1, range_m = 5",
            "it is within 10 to 50",
        ),
        (
            "incidence_deg = 90, sun_azimuth_deg = 0, emission_deg = 90, observer_azimuth_deg = 40, phase_deg = 41, range_m = 5, \
             up = \"zenith\"",
            "the azimuths make it 40.0",
        ),
        (
            "incidence_deg = 30, emission_deg = 0, phase_deg = 20, sun_azimuth_deg = 1, range_m = 5",
            "it is within 30 to 30",
        ),
    ];
    for (geometry, expected) in cases {
        let message = refused(&text(&format!("geometry = {{ {geometry} }}")));
        assert!(message.contains(expected), "{geometry}: {message}");
    }
    // Twice, and not at all.
    let both = "geometry = { emission_deg = 0, range_m = 5, incidence_deg = 0 }\nobserver = { position_m = [0, 0, 0], target_m = [1, 0, 0], up = [0, 0, 1] }";
    assert!(refused(&text(both)).contains("leave one of them out"));
    let sun = text("geometry = { emission_deg = 0, range_m = 5, incidence_deg = 0 }")
        .replace("sun = { distance_au = 1.5 }", "sun = { direction = [1, 0, 0], distance_au = 1.5 }");
    assert!(refused(&sun).contains("places the Sun"));
    assert!(refused(&text("")).contains("observer"));
}
