//! `solve --radiance`: what each facet sends towards an observer, against the image and closed forms.

use std::f64::consts::PI;

use mmxrt::formats::npz;

use crate::cli::run;
use crate::scenes::replaced;
use crate::scratch::Scratch;
use crate::shapes::*;

/// Radiance of facets, [facet][band], the Sun's share of each, and the cosine of emission.
fn read(scratch: &Scratch, name: &str) -> (Vec<Vec<f64>>, Vec<f64>, Vec<f64>) {
    let columns = ["radiance_w_m2_sr_um", "sun_share", "cos_emission"];
    let columns = npz::read_f64s(&scratch.join(name), &columns).unwrap();
    let [Some((shape, radiance)), Some((_, share)), Some((_, cos))] = &columns[..] else { panic!("{columns:?}") };
    assert_eq!(shape[0], share.len());
    (radiance.chunks(shape[1]).map(<[f64]>::to_vec).collect(), share.clone(), cos.clone())
}

const SCENE: &str = r#"mmxrt_scene = 1
origin_m = [0, 0, 11000]
[[mesh]]
obj = "body.obj"
[materials]
a = { reflectance = 0.1 }
b = { reflectance = 0.3 }
[sun]
direction = [0.6, 0, 0.8]
distance_au = 1.5
[mars]
position_m = [-9.4e6, 0, 11000]
[observer]
position_m = [40, -60, 11090]
target_m = [0, 0, 11000]
up = [0, 0, 1]
[sensor]
samples = 24
lines = 20
fov_deg = 8
bands = { centres_um = [0.55, 1.0, 3.4], fwhm_um = [0.05, 0.1, 0.2] }
"#;

fn f64s(scratch: &Scratch, name: &str) -> Vec<f64> {
    let bytes = std::fs::read(scratch.join(name)).unwrap();
    bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
}

#[test]
fn the_image_by_way_of_facets_is_the_image() {
    let scratch = Scratch::new();
    // What is convex has facets that are wholly lit or wholly dark.
    scratch.obj(
        "body",
        &joined(&[
            of_material(sphere([0.0; 3], 3.0, 2), 0),
            of_material(cuboid([4.0, -1.0, -1.0], [5.5, 1.0, 1.0]), 1),
        ]),
        &[("a", None), ("b", None)],
    );
    // The Sun in the South, so that neither shades the other.
    scratch.write("scene.toml", replaced(SCENE, &[("[0.6, 0, 0.8]", "[0.0, -0.6, 0.8]")]));
    let [scene, table, map, image, maps] =
        ["scene.toml", "t.npz", "t_radiance.npz", "image", "maps"].map(|name| scratch.argument(name));
    let (code, said, err) =
        run(&["solve", &scene, "-o", &table, "--radiance", "camera", "--model", "sunlight,mars-light,heat"]);
    assert!(code == 0 && said.contains("t_radiance.npz"), "{said} {err}");
    let options = ["--dtype", "f64", "--quiet"];
    let (code, _, err) =
        run(&[&["simulate", &scene, "-o", &image, "--model", "sunlight,mars-light,heat"][..], &options].concat());
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = run(&[&["integrate", &scene, "--radiance", &map, "-o", &maps][..], &options].concat());
    assert_eq!(code, 0, "{err}");
    let (one, other) = (f64s(&scratch, "image/cube.img"), f64s(&scratch, "maps/cube.img"));
    let brightest = one.iter().copied().fold(0.0, f64::max);
    assert_eq!(one.len(), 24 * 20 * 3);
    assert!(one.iter().filter(|l| **l > 0.0).count() > 150, "{brightest}");
    for (i, (one, other)) in one.iter().zip(&other).enumerate() {
        assert!((one - other).abs() <= 1e-12 * one.max(1e-3 * brightest), "{i}: {one} {other}");
    }
}

#[test]
fn a_facet_lit_in_part_sends_the_mean() {
    let scratch = Scratch::new();
    let ground = plane(10.0, 0.0);
    scratch.obj(
        "body",
        &joined(&[ground, of_material(cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]), 1)]),
        &[("a", None), ("b", None)],
    );
    scratch.write(
        "scene.toml",
        replaced(SCENE, &[("[0.6, 0, 0.8]", "[1, 0, 1]"), ("[mars]\nposition_m = [-9.4e6, 0, 11000]\n", "")]),
    );
    let [scene, table] = ["scene.toml", "t.npz"].map(|name| scratch.argument(name));
    let (code, _, err) = run(&["solve", &scene, "-o", &table, "--radiance", "towards:0,0,1", "--model", "sunlight"]);
    assert_eq!(code, 0, "{err}");
    let (radiance, share, cos) = read(&scratch, "t_radiance.npz");
    // The box stands on 4 of 400 m2, and its shadow takes 4 more.
    let lit: f64 = 200.0 * (share[0] + share[1]);
    assert!((lit - 392.0).abs() < 1e-9 && share[0] < 1.0 && share[1] < 1.0, "{share:?}");
    let e490 = mmxrt::spectral::solar_e490();
    let full = 0.1 / PI * e490.at(1.0).unwrap() / 1.5_f64.powi(2) * 0.5_f64.sqrt();
    for f in 0..2 {
        // A band of 0.1 um: its mean is the curve's to some 1e-3.
        assert!((radiance[f][1] / (full * share[f]) - 1.0).abs() < 5e-3, "{f}: {radiance:?} {full}");
        assert!((radiance[f][1] / radiance[1 - f][1] - share[f] / share[1 - f]).abs() < 1e-12);
        assert_eq!(cos[f], 1.0);
    }
    // Seen from above the walls are edge-on, and the bottom faces away.
    assert!((2..radiance.len()).all(|f| radiance[f].iter().all(|l| l.is_nan()) == (cos[f] <= 0.0)));
    assert_eq!((2..radiance.len()).filter(|f| cos[*f] > 0.0).count(), 2);
}

#[test]
fn a_model_has_the_angles_of_each_facets_centroid() {
    let scratch = Scratch::new();
    scratch.obj("body", &quad([-2.0, -1.0, 0.0], [2.0, -1.0, 0.0], [2.0, 1.0, 1.0], [-2.0, 1.0, 1.0]), &[("a", None)]);
    let text = replaced(
        SCENE,
        &[
            (
                "a = { reflectance = 0.1 }\nb = { reflectance = 0.3 }",
                "a = { lommel_seeliger = {}, reflectance = 0.1, measured = \"albedo\" }",
            ),
            ("[mars]\nposition_m = [-9.4e6, 0, 11000]\n", ""),
            (", fwhm_um = [0.05, 0.1, 0.2]", ""),
        ],
    );
    scratch.write("scene.toml", text);
    let scene = scratch.argument("scene.toml");
    let centroids = [[2.0 / 3.0, -1.0 / 3.0, 1.0 / 3.0], [-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0]];
    let n = glam::DVec3::new(0.0, -1.0, 2.0).normalize();
    let sun = glam::DVec3::new(0.6, 0.0, 0.8);
    let e = mmxrt::spectral::solar_e490().at(1.0).unwrap() / 1.5_f64.powi(2);
    // Lommel and Seeliger, isotropic: w / (4 pi) E mu0 / (mu0 + mu).
    let expected = |to_viewer: glam::DVec3| 0.1 / (4.0 * PI) * e * n.dot(sun) / (n.dot(sun) + n.dot(to_viewer));
    for (observer, from_afar) in
        [("camera", None), ("at:40,-60,11090", None), ("towards:2,-3,6", Some([2.0, -3.0, 6.0]))]
    {
        let table = scratch.argument("t.npz");
        let (code, _, err) =
            run(&["solve", &scene, "-o", &table, "--radiance", observer, "--model", "sunlight", "--force"]);
        assert_eq!(code, 0, "{err}");
        let (radiance, ..) = read(&scratch, "t_radiance.npz");
        for f in 0..2 {
            let near = glam::DVec3::new(40.0, -60.0, 90.0) - glam::DVec3::from_array(centroids[f]);
            let to_viewer = from_afar.map_or(near, glam::DVec3::from_array).normalize();
            assert!((radiance[f][1] / expected(to_viewer) - 1.0).abs() < 1e-9, "{observer} {f}: {radiance:?}");
        }
    }
}

#[test]
fn what_cannot_be_asked_for_is_said() {
    let scratch = Scratch::new();
    scratch.obj("body", &plane(10.0, 0.0), &[("a", None)]);
    scratch.write("scene.toml", SCENE);
    let [scene, table] = ["scene.toml", "t.npz"].map(|name| scratch.argument(name));
    for observer in ["north", "at:1,2", "towards:0,0,0", "at:1,2,nan", "camera:1"] {
        let (code, _, err) = run(&["solve", &scene, "-o", &table, "--radiance", observer]);
        assert!(code == 2 && err.contains("towards:X,Y,Z"), "{observer}: {err}");
    }
    scratch.write("t_radiance.npz", "mine");
    let (code, _, err) = run(&["solve", &scene, "-o", &table, "--radiance", "camera"]);
    assert!(code == 1 && err.contains("t_radiance.npz") && err.contains("exists"), "{err}");
    assert!(!scratch.names().contains(&"t.npz".to_owned()));
}

/// It says of which facets it is, of which light, and towards whom.
#[test]
fn what_it_is_not_of_is_refused_or_told() {
    let scratch = Scratch::new();
    scratch.obj("body", &sphere([0.0; 3], 3.0, 2), &[("a", None)]);
    scratch.obj("moved", &sphere([0.0, 0.0, 1e-9], 3.0, 2), &[("a", None)]);
    scratch.write("scene.toml", SCENE);
    let other = |name: &str, from: &str, to: &str| {
        scratch.write(name, replaced(SCENE, &[(from, to)]));
    };
    other("mesh.toml", "body.obj", "moved.obj");
    other("origin.toml", "origin_m = [0, 0, 11000]", "origin_m = [0, 0, 11000.5]");
    other("sun.toml", "[0.6, 0, 0.8]", "[0.6, 0.1, 0.8]");
    // Half as far away, in the same direction: 3 m of the body at 56 m instead of 112.
    other("near.toml", "[40, -60, 11090]", "[20, -30, 11045]");
    // Of 60 m to the side at 115 m a hundredth of a rad is 1.1 m.
    other("beside.toml", "[40, -60, 11090]", "[40.5, -60, 11090]");
    let solved = |observer: &str| {
        let (table, scene) = (scratch.argument("t.npz"), scratch.argument("scene.toml"));
        let (code, _, err) = run(&["solve", &scene, "-o", &table, "--radiance", observer, "--force"]);
        assert_eq!(code, 0, "{err}");
    };
    let used = |scene: &str| {
        let (map, out) = (scratch.argument("t_radiance.npz"), scratch.argument("out"));
        let (code, _, err) =
            run(&["integrate", &scratch.argument(scene), "--radiance", &map, "-o", &out, "--force", "--unknown", "0"]);
        (code, err)
    };
    let (towards, light) = ("towards another observer", "another Sun, Mars, lamps or heat");
    solved("camera");
    for (scene, code, told) in [
        ("scene.toml", 0, vec![]),
        ("beside.toml", 0, vec![]),
        ("mesh.toml", 1, vec!["another mesh", "t_radiance.npz"]),
        ("origin.toml", 1, vec!["origin_m", "t_radiance.npz"]),
        ("sun.toml", 0, vec![light]),
        ("near.toml", 0, vec![towards]),
    ] {
        let (got, err) = used(scene);
        assert_eq!(got, code, "{scene}: {err}");
        assert!(told.iter().all(|told| err.contains(told)), "{scene}: {err}");
        for not in [towards, light].iter().filter(|not| !told.contains(not)) {
            assert!(!err.contains(not), "{scene}: {err}");
        }
    }
    // From afar it is of a direction; at 19 times the body's width that differs by more than a hundredth.
    solved("towards:40,-60,90");
    assert!(used("scene.toml").1.contains(towards));
    other("far.toml", "position_m = [40, -60, 11090]", "position_m = [40000, -60000, 101000]");
    assert!(!used("far.toml").1.contains(towards));
    solved("towards:-40,60,90");
    assert!(used("far.toml").1.contains(towards));
    solved("at:40,-60,11090");
    assert!(!used("scene.toml").1.contains(towards));
}
