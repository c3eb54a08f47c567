//! What a scene's source does not say is not written by `convert`, and where it stands on the body, and in what unit it is, can be said.

use glam::DVec3;
use mmxrt::formats::scene_toml::{self, SceneFile};
use mmxrt::progress::unwatched;
use mmxrt::study;

use crate::cli::run;
use crate::scratch::Scratch;

const SQUARE: &str = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl grey\nf 1 2 3 4\n";

/// A square of Blender's default grey.
fn square() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("m.obj", SQUARE);
    scratch.write("m.mtl", "newmtl grey\nKd 0.8 0.8 0.8\n");
    scratch
}

/// Converts; what was written, and what was told.
fn converted(scratch: &Scratch, from: &str, to: &str, more: &[&str]) -> (String, String) {
    let (from, path) = (scratch.argument(from), scratch.argument(to));
    let (code, out, err) = run(&[&["convert", &from, &path], more].concat());
    assert_eq!(code, 0, "{out}{err}");
    (std::fs::read_to_string(path).unwrap_or_default(), out)
}

fn read(scratch: &Scratch, name: &str) -> SceneFile {
    scene_toml::read(&scratch.join(name), &unwatched).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn bond_albedo_follows_a_reflectance_that_is_edited() {
    let scratch = square();
    let (text, _) = converted(&scratch, "m.obj", "s.toml", &[]);
    for key in ["bond_albedo", "emissivity", "[thermal]", "spectrum", "name ="] {
        assert!(!text.contains(key), "{key}: {text}");
    }
    assert!(text.contains("# Not said by the source, and taken: 1 au away"), "{text}");
    let edited = text.replace("reflectance = 0.8", "reflectance = 0.07");
    assert_ne!(edited, text);
    scratch.write("s.toml", edited);
    let material = &read(&scratch, "s.toml").scene.body.materials[0];
    assert!((material.bond_albedo - 0.07).abs() < 1e-15 && material.emissivity_bolometric == 0.95, "{material:?}");
    // By hand: the Sun in the zenith at 1 au, (1 - 0.07) 1366.1 W m-2 = 0.95 sigma T^4.
    let (table, _) = study::simulate(&read(&scratch, "s.toml").scene, &unwatched).unwrap();
    let expected = (0.93_f64 * 1366.09 / (0.95 * 5.670_374e-8)).powf(0.25);
    assert!((table.temperature_lit_k[0] - expected).abs() < 0.01, "{} {expected}", table.temperature_lit_k[0]);
    assert!((expected - 392.0).abs() < 1.0);
}

#[test]
fn a_scene_keeps_what_it_says_and_no_more() {
    let scratch = square();
    let (text, _) = converted(&scratch, "m.obj", "s.toml", &[]);
    // Stated, though it is what would be taken anyway; and Mars with one number of six.
    let text = text.replace("reflectance = 0.8", "reflectance = 0.8\nbond_albedo = 0.8\nemissivity = 0.2")
        + "\n[mars]\nposition_m = [0, 0, 9.4e6]\nalbedo = 0.25\n";
    scratch.write("s.toml", &text);
    let (again, _) = converted(&scratch, "s.toml", "out/again.toml", &[]);
    for line in ["bond_albedo = 0.8\n", "emissivity = 0.2", "albedo = 0.25"] {
        assert!(again.contains(line), "{line}: {again}");
    }
    for key in ["emissivity_bolometric", "radius_m", "thermal_exitance", "model", "spectrum"] {
        assert!(!again.contains(key), "{key}: {again}");
    }
    // The library states everything, but for choices that it leaves to a plan.
    let scene = read(&scratch, "s.toml").scene;
    let (files, _) = scene_toml::write(&scene, &scratch.join("all.toml"), false).unwrap();
    files.commit().unwrap();
    let all = std::fs::read_to_string(scratch.join("all.toml")).unwrap();
    for key in ["emissivity_bolometric = 0.95", "radius_m = 3389500", "thermal_exitance_w_m2 = 110", "e490"] {
        assert!(all.contains(key), "{key}: {all}");
    }
    assert!(!all.contains("model"), "{all}");
}

#[cfg(feature = "sqlite")]
#[test]
fn what_dart_does_not_say_is_not_written() {
    let scratch = square();
    converted(&scratch, "m.obj", "s.toml", &[]);
    converted(&scratch, "s.toml", "dart", &[]);
    std::fs::remove_file(scratch.join("dart/mmxrt.toml"))
        .or_else(|_| std::fs::remove_file(scratch.join("dart/input/mmxrt.toml")))
        .unwrap();
    let (text, _) = converted(&scratch, "dart", "back/scene.toml", &[]);
    assert!(text.contains("reflectance") && !text.contains("bond_albedo") && !text.contains("bolometric"), "{text}");
    // With the sidecar a Bond albedo that was given comes back, and one that follows does not.
    let text = std::fs::read_to_string(scratch.join("s.toml")).unwrap();
    scratch.write("s.toml", text.replace("reflectance = 0.8", "reflectance = 0.8\nbond_albedo = 0.3"));
    converted(&scratch, "s.toml", "dart2", &[]);
    let (text, _) = converted(&scratch, "dart2", "back2/scene.toml", &[]);
    assert!(text.contains("bond_albedo = 0.3") && !text.contains("bolometric"), "{text}");
}

#[test]
fn unit_and_axes_of_a_mesh_can_be_said() {
    let scratch = Scratch::new();
    scratch.write("m.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
    let corner = |name: &str| read(&scratch, name).scene.body.mesh.vertices_m[2];
    let (_, out) = converted(&scratch, "m.obj", "a.toml", &[]);
    assert!(out.contains("mesh.unit_m: 1: the mesh is 2.236 m across") && out.contains("mesh.up: z"), "{out}");
    assert_eq!(corner("a.toml"), DVec3::new(2.0, 1.0, 0.0));
    let (_, out) = converted(&scratch, "m.obj", "b.toml", &["--unit-m", "1000", "--up", "y"]);
    assert!(!out.contains("mesh.unit_m") && !out.contains("mesh.up"), "{out}");
    assert_eq!(corner("b.toml"), DVec3::new(2000.0, 0.0, 1000.0));
    // glTF has y up and metres, unless it was written by somebody who did not know.
    converted(&scratch, "m.obj", "m.glb", &[]);
    converted(&scratch, "m.glb", "c.toml", &["--unit-m", "0.01"]);
    assert!((corner("c.toml") - DVec3::new(0.02, 0.01, 0.0)).length() < 1e-17);
    converted(&scratch, "m.glb", "d.toml", &["--up", "z"]);
    assert_eq!(corner("d.toml"), DVec3::new(2.0, 0.0, -1.0));
    for (more, code, told) in [
        (["--unit-m", "0"], 1, "--unit-m: 0 is not positive"),
        (["--unit-m", "nan"], 1, "--unit-m: NaN is not positive"),
        (["--up", "x"], 2, "axes are y, z"),
        (["--pose", "tilted"], 2, "poses are body, radial"),
        (["--pose", "radial"], 1, "needs an origin"),
    ] {
        let arguments = ["convert", &scratch.argument("m.obj"), &scratch.argument("e.toml"), more[0], more[1]];
        let (found, _, err) = run(&arguments);
        assert!(found == code && err.contains(told), "{more:?}: {err}");
    }
    for (from, to, more) in [("a.toml", "f.toml", ["--unit-m", "2"]), ("m.obj", "f.glb", ["--pose", "radial"])] {
        let (code, _, err) = run(&["convert", &scratch.argument(from), &scratch.argument(to), more[0], more[1]]);
        assert!(code == 1 && err.contains("changes nothing"), "{err}");
    }
}

#[test]
fn a_site_made_at_home_stands_upright_on_the_body() {
    let scratch = square();
    let origin = ["--origin-m", "10000,3000,2000"];
    let (_, out) = converted(&scratch, "m.obj", "a.toml", &origin);
    assert!(out.contains("mesh.pose: body") && out.contains("--pose radial"), "{out}");
    let (text, out) = converted(&scratch, "m.obj", "b.toml", &[&origin[..], &["--pose", "radial"]].concat());
    assert!(!out.contains("mesh.pose"), "{out}");
    assert!(text.contains("pose = \"radial\"") && text.matches("frame = \"site\"").count() == 2, "{text}");
    // The mesh stays as it was drawn; on the body its normal is the radius.
    let obj = std::fs::read_to_string(scratch.join("b.obj")).unwrap();
    assert!(obj.contains("v -1 -1 0\n") && obj.contains("v 1 1 0\n"), "{obj}");
    let scene = read(&scratch, "b.toml").scene;
    let radius = DVec3::new(10000.0, 3000.0, 2000.0).normalize();
    assert!((scene.body.mesh.facet(0).normal() - radius).length() < 1e-15);
    assert!((scene.sky.sun.direction.vec() - radius).length() < 1e-15);
    let (_, seen) = study::simulate(&scene, &unwatched).unwrap();
    let incidence = &seen.backplanes.plane("INCIDENCE").unwrap().values;
    let middle = incidence[128 * 256 + 128];
    // The camera's rays at the middle pixel meet the ground beside the axis by half a pixel: 1e-2 m of 10 km.
    assert!(middle < 1e-3, "{middle}");
    // DART gets the same scene.
    #[cfg(feature = "sqlite")]
    {
        converted(&scratch, "m.obj", "dart", &[&origin[..], &["--pose", "radial"]].concat());
        converted(&scratch, "dart", "c/scene.toml", &[]);
        let back = read(&scratch, "c/scene.toml").scene;
        assert!((back.body.mesh.facet(0).normal() - radius).length() < 1e-6, "{}", back.body.mesh.facet(0).normal());
    }
}

#[test]
fn observer_and_sun_in_the_axes_of_the_site() {
    // On the equator at longitude 90 deg east is -x, north z, the zenith y.
    let scratch = square();
    let text = |sun: &str, observer: &str| {
        format!(
            "mmxrt_scene = 1\norigin_m = [0, 1000, 0]\n[[mesh]]\nobj = \"m.obj\"\npose = \"radial\"\n[materials]\ngrey = {{ reflectance = 0.1 }}\n\
             [sun]\n{sun}\n[observer]\n{observer}\n[sensor]\nsamples = 4\nlines = 4\nfov_deg = 5\nbands = {{ centres_um = [1.0] }}\n"
        )
    };
    let site = text(
        "frame = \"site\"\ndirection = [0.6, 0, 0.8]\ndistance_au = 1.5",
        "frame = \"site\"\nposition_m = [3, 4, 50]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]",
    );
    let body = text(
        "direction = [-0.6, 0.8, 0]\ndistance_au = 1.5",
        "position_m = [-3, 1050, 4]\ntarget_m = [0, 1000, 0]\nup = [0, 0, 1]",
    );
    let (a, b) = (scratch.scene(&site), scratch.scene(&body));
    assert!((a.sky.sun.direction.vec() - b.sky.sun.direction.vec()).length() < 1e-15);
    let (a, b) = (a.exposure.camera.world_from_sensor, b.exposure.camera.world_from_sensor);
    assert!((a.translation_m - b.translation_m).length() < 1e-12, "{a:?} {b:?}");
    assert!((a.rotation - b.rotation).to_cols_array().iter().all(|x| x.abs() < 1e-15), "{a:?} {b:?}");
    // h, v and u as a program has them; the Sun by its place.
    let axes = text(
        "frame = \"site\"\nposition_m = [0, 0, 2.2e11]",
        "frame = \"site\"\nposition_m = [0, 0, 50]\nh = [1, 0, 0]\nv = [0, -1, 0]\nu = [0, 0, -1]",
    );
    let scene = scratch.scene(&axes);
    assert!(
        (scene.sky.sun.direction.vec() - DVec3::Y).length() < 1e-15 && (scene.sky.sun.distance_m - 2.2e11).abs() < 1e-3
    );
    let rotation = scene.exposure.camera.world_from_sensor.rotation;
    assert!((rotation.x_axis - DVec3::NEG_X).length() + (rotation.z_axis - DVec3::NEG_Y).length() < 1e-15);
    // At the body's centre there is no zenith; at a pole east is told.
    let path = scratch.write("centre.toml", site.replace("[0, 1000, 0]", "[0, 0, 0]"));
    let error = scene_toml::read(&path, &unwatched).unwrap_err().to_string();
    for item in ["mesh[0].pose", "sun.frame", "observer.frame"] {
        assert!(error.contains(item) && error.contains("zenith is undefined"), "{item}: {error}");
    }
    scratch.write("pole.toml", site.replace("origin_m = [0, 1000, 0]", "origin_m = [0, 0, 1000]"));
    let pole = read(&scratch, "pole.toml");
    assert!(pole.notes.iter().any(|n| n.contains("at a pole")), "{:?}", pole.notes);
    assert!((pole.scene.sky.sun.direction.vec() - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
}

#[test]
fn the_camera_that_convert_chooses_sees_an_outer_side() {
    let scratch = Scratch::new();
    // Two upright panels back to back, a cup that is open above and faces outwards, and panels that face +x alone.
    for (name, obj) in [
        (
            "panels",
            "v 0 0 0\nv 2 0 0\nv 2 0 1\nv 0 0 1\nv 0 .1 0\nv 2 .1 0\nv 2 .1 1\nv 0 .1 1\nf 1 2 3 4\nf 5 8 7 6\n",
        ),
        (
            "cup",
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 9\nv 1 0 9\nv 1 1 9\nv 0 1 9\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
        ),
        ("wall", "v 0 0 0\nv 0 2 0\nv 0 2 1\nv 0 0 1\nf 1 2 3 4\n"),
        ("roof", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 4 3 2\n"),
    ] {
        scratch.write(&format!("{name}.obj"), obj);
        converted(&scratch, &format!("{name}.obj"), &format!("out/{name}.toml"), &[]);
        let scene = read(&scratch, &format!("out/{name}.toml")).scene;
        let (_, seen) = study::simulate(&scene, &unwatched).unwrap();
        assert!(seen.counts.visible_facets > 0, "{name}");
        let behind = seen.warnings.iter().any(|w| w.contains("back of facets"));
        assert!(!behind, "{name}: {:?}", seen.warnings);
        let expanded = seen.cube.to_array();
        assert!(expanded.iter().any(|radiance| *radiance > 0.0), "{name} is black");
    }
}
