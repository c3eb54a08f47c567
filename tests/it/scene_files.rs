//! The shipped scenes are read, and hold what their sheets say.

use std::path::{Path, PathBuf};

use mmxrt::formats::scene_toml;
use mmxrt::physics::reflectance::PhotometricAngles;
use mmxrt::progress::unwatched;

use crate::scratch::Scratch;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_site_of_table_i_is_read_as_it_is_printed() {
    let file = scene_toml::read(&root().join("scenes/phobos_site/scene.toml"), &unwatched).unwrap();
    let scene = &file.scene;
    let camera = &scene.exposure.camera;
    // Distances and angles of Table I: range 77 273.6 m, Sun 1.4842525 au, incidence 23.5734 deg.
    assert!((camera.centre_m().length() - 77_273.6).abs() < 0.05);
    assert!((scene.sky.sun.distance_m / mmxrt::units::AU_M - 1.484_252_5).abs() < 1e-7);
    let outward = mmxrt::geometry::Direction::new(scene.body.origin_m).unwrap();
    assert!((scene.sky.sun.direction.angle_rad(outward).to_degrees() - 23.5734).abs() < 5e-5);
    // Straight above, north up: right of the image is east, which is x of the radial pose.
    let down = camera.world_from_sensor.rotation.z_axis;
    assert!((down + outward.vec()).length() < 1e-4);
    let east = glam::DVec3::Z.cross(outward.vec()).normalize();
    assert!((camera.world_from_sensor.rotation.x_axis - east).length() < 1e-4);
    // 2 km, and what perspective adds for relief, in 256 pixels: 7.8 m.
    let pixel_m = camera.pitch[0] * camera.centre_m().length();
    assert!((7.8..8.0).contains(&pixel_m), "{pixel_m}");
    assert_eq!((camera.samples, camera.lines, scene.exposure.bands.len()), (256, 256, 300));
    assert_eq!(scene.exposure.bands[299].centre_um, 3.6);
    assert_eq!(scene.body.materials.len(), 2);
    // The blue unit's normal albedo, of a surface that is not Lambert.
    let surface = scene.body.materials[0].photometry.brdf(1.0).unwrap();
    let normal = std::f64::consts::PI * surface.eval(&PhotometricAngles::of_cosines(1.0, 1.0, 1.0));
    assert!((normal - 0.10617).abs() < 1e-9, "{normal}");
    // The site lies around the origin, its relief along the outward radius, tilted as Phobos is there; and the ground around it falls away to the horizon.
    let height = |v: &glam::DVec3| v.dot(outward.vec());
    let vertices_m = &scene.body.mesh.vertices_m;
    assert!(vertices_m.iter().filter(|v| v.length() < 1000.0).map(|v| height(v).abs()).fold(0.0, f64::max) < 400.0);
    assert!(vertices_m.iter().map(height).fold(0.0, f64::min) < -2000.0);
    assert!(scene.body.mesh.vertices_m.len() > 50_000);
    assert!(file.notes.len() == 1 && file.notes[0].contains("788.4 m above the body"), "{:?}", file.notes);
}

#[test]
fn mars_stands_high_over_the_mars_side_and_the_sun_low() {
    let file = scene_toml::read(&root().join("scenes/phobos_mars_side/scene.toml"), &unwatched).unwrap();
    let scene = &file.scene;
    let outward = mmxrt::geometry::Direction::new(scene.body.origin_m).unwrap();
    let mars = mmxrt::geometry::Direction::new(scene.sky.mars.as_ref().unwrap().centre_m).unwrap();
    assert!((scene.sky.sun.direction.angle_rad(outward).to_degrees() - 77.07).abs() < 0.01);
    assert!((mars.angle_rad(outward).to_degrees() - 20.03).abs() < 0.01);
    assert!((scene.exposure.camera.centre_m().length() - 77_000.0).abs() < 0.1);
}

#[test]
fn the_scene_in_the_tutorial_is_read_as_it_stands() {
    let page = std::fs::read_to_string(root().join("docs/tutorial/change.md")).unwrap();
    let text = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let scratch = Scratch::new();
    for name in ["blue_unit.csv", "site.toml"] {
        std::fs::copy(root().join("scenes/phobos_site").join(name), scratch.join(name)).unwrap();
    }
    let scene = scratch.scene(text);
    // 0.4 of the blue unit, which has 0.10617 at 1 um, and 0.6 of 0.12.
    let mixed = scene.body.materials[1].reflectance.at(1.0).unwrap();
    assert!((mixed - (0.4 * 0.10617 + 0.6 * 0.12)).abs() < 1e-15, "{mixed}");
    assert_eq!(scene.exposure.bands.len(), 300);
}

#[test]
fn every_shipped_scene_has_its_sheet() {
    let mut seen = 0;
    for entry in std::fs::read_dir(root().join("scenes")).unwrap() {
        let folder: &Path = &entry.unwrap().path();
        let sheet = std::fs::read_to_string(folder.join("README.md")).unwrap();
        for part in ["**Rationale.**", "**Geometry.**", "**Expected.**", "**Tolerance and why.**"] {
            assert!(sheet.contains(part), "{}: {part}", folder.display());
        }
        seen += 1;
    }
    assert!(seen >= 2);
}
