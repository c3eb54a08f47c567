//! Models of reflectance in scene files: what their numbers mean, what comes back of them, and what is refused.

use std::f64::consts::PI;

use mmxrt::formats::convert::{Content, differences};
use mmxrt::formats::scene_toml;
use mmxrt::physics::reflectance::albedo::Measure;
use mmxrt::physics::reflectance::{PhotometricAngles, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Photometry, Scene};
use mmxrt::study;

use crate::cli::run;
use crate::scenes::{SQUARE, SQUARE_OBJ, replaced};
use crate::scratch::Scratch;

const PHOBOS: &str =
    "b = -0.25, shadow_hiding = { amplitude = 2.28, width = 0.0573 }, mean_slope_deg = 24, h = \"hapke2002\"";

/// The square with this of its material.
fn text(material: &str) -> String {
    replaced(SQUARE, &[("reflectance = 0.1\n", &format!("{material}\n"))])
}

fn folder(material: &str) -> Scratch {
    let folder = Scratch::new();
    folder.write("square.obj", SQUARE_OBJ);
    folder.write("scene.toml", text(material));
    folder.write("grey.csv", "wavelength_um,reflectance\n0.8,0.02\n0.9,0.03\n1.4,0.06\n");
    folder
}

fn scene_of(folder: &Scratch) -> Scene {
    scene_toml::read(&folder.join("scene.toml"), &unwatched).unwrap_or_else(|e| panic!("{e}")).scene
}

fn refused(material: &str) -> String {
    scene_toml::read(&folder(material).join("scene.toml"), &unwatched).unwrap_err().to_string()
}

const ALL: [&str; 9] = [
    "lommel_seeliger = {}",
    "lommel_seeliger = { b = 0.3, c = 0.4 }",
    "lunar_lambert = { share = 0.7 }",
    "lunar_lambert = { share = { scale_deg = 60 }, phase = { beta = -1.3, gamma = 0.1 } }",
    "lunar_lambert = { share = \"moon\" }",
    "minnaert = { exponent = 0.6 }",
    "akimov = { phase = { beta = -1.3 } }",
    "hapke = { b = -0.25, shadow_hiding = { amplitude = 2.28, width = 0.0573 }, mean_slope_deg = 24, porosity_factor = 1.2 }",
    "rpv = { k = 0.65, g = -0.29, h = 0.075 }",
];

#[test]
fn a_model_has_the_reflectance_that_was_measured() {
    let angles = PhotometricAngles::of_angles(PI / 6.0, PI / 4.0, PI / 3.0);
    let phase_deg = angles.phase_rad().to_degrees();
    let measured_at = format!("{{ incidence_deg = 30, emission_deg = 45, phase_deg = {phase_deg} }}");
    for model in ALL {
        for (measured, measure) in [
            ("\"hemispherical\"", Measure::Spherical),
            ("\"normal\"", Measure::ReflectanceFactor(PhotometricAngles::ZENITH)),
            (measured_at.as_str(), Measure::ReflectanceFactor(angles)),
        ] {
            let scene = scene_of(&folder(&format!("reflectance = \"grey.csv\"\nmeasured = {measured}\n{model}")));
            let Some(model) = scene.body.materials[0].photometry.model() else { panic!("{model}") };
            for (um, reflectance) in [(0.8, 0.02), (0.9, 0.03), (1.4, 0.06)] {
                // Minnaert's limb is that of the brightest.
                let brightest = model.albedo.at(1.4).unwrap();
                let albedo = model.albedo.at(um).unwrap();
                let is_minnaert = matches!(model.shape, Shape::Minnaert(_));
                let of = |albedo: f64| measure.of(&model.shape.brdf(albedo));
                let got = if is_minnaert { of(brightest) * albedo / brightest } else { of(albedo) };
                assert!((got / reflectance - 1.0).abs() < 1e-11, "{model:?} {measure:?}: {got}");
            }
        }
    }
}

#[test]
fn a_square_from_above_has_its_normal_reflectance() {
    // Sun and camera at the zenith: L = 0.1 E / pi whatever the model.
    let lambert = study::simulate(&scene_of(&folder("reflectance = 0.1")), &unwatched).unwrap().1.cube.band(0);
    for model in ALL {
        let scene = scene_of(&folder(&format!("reflectance = 0.1\nmeasured = \"normal\"\n{model}")));
        let seen = study::simulate(&scene, &unwatched).unwrap().1.cube.band(0);
        // Pixels of 4 m from 1 km are seen up to 0.3 deg off: surges fall.
        for (got, lambert) in seen.iter().zip(&lambert) {
            assert!((got / lambert - 1.0).abs() < 0.05, "{model}: {got} {lambert}");
        }
    }
}

#[test]
fn a_w_of_ones_own_is_the_albedo() {
    let scene = scene_of(&folder(&format!("reflectance = 0.072\nmeasured = \"albedo\"\nhapke = {{ {PHOBOS} }}")));
    let material = &scene.body.materials[0];
    let angles = PhotometricAngles::of_angles(60f64.to_radians(), 40f64.to_radians(), 90f64.to_radians());
    // Computed independently in 40 digits.
    let brdf = material.photometry.brdf(1.0).unwrap().eval(&angles);
    assert!((brdf / 0.005_613_527_003_819_967 - 1.0).abs() < 1e-12, "{brdf}");
    // Its spherical albedo is 0.022; emissivity and Bond albedo follow.
    let hemispherical = material.reflectance.value()[0];
    assert!((hemispherical - 0.022).abs() < 5e-4, "{hemispherical}");
    assert!((material.bond_albedo - hemispherical).abs() < 1e-12);
    assert_eq!(material.emissivity.value()[0], 1.0 - hemispherical);
}

#[test]
fn models_are_written_and_read_back_the_same() {
    for model in ALL {
        let folder = folder(&format!("reflectance = \"grey.csv\"\n{model}"));
        let (code, out, err) = run(&["convert", &folder.argument("scene.toml"), &folder.argument("again/scene.toml")]);
        assert!(code == 0 && !out.contains("Dropped") && !out.contains("Approximated"), "{out}{err}");
        let again = scene_toml::read(&folder.join("again/scene.toml"), &unwatched).unwrap().scene;
        let content = |scene: Scene| Content::Scene(Box::new(scene), Vec::new());
        let scene = scene_of(&folder);
        assert_eq!(scene.body.materials, again.body.materials, "{model}");
        assert_eq!(differences(&content(scene), &content(again)), [""; 0]);
    }
    let [a, b] = [0.6, 0.7].map(|exponent| {
        let scene = scene_of(&folder(&format!("reflectance = 0.1\nminnaert = {{ exponent = {exponent} }}")));
        Content::Scene(Box::new(scene), Vec::new())
    });
    let told = differences(&a, &b).join("\n");
    assert!(told.contains("photometry") && told.contains("0.7"), "{told}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn spectra_and_dart_have_the_hemispherical_reflectance() {
    let folder = folder("reflectance = 0.05\nminnaert = { exponent = 0.6 }");
    let (code, out, err) = run(&["convert", &folder.argument("scene.toml"), &folder.argument("dart"), "--to", "dart"]);
    assert!(code == 0 && format!("{out}{err}").contains("a Lambert surface of the same hemispherical"), "{out}{err}");
    let Photometry::Model(model) = &scene_of(&folder).body.materials[0].photometry else { panic!() };
    assert!((model.hemispherical().value()[0] - 0.05).abs() < 1e-15);
}

#[test]
fn all_that_is_wrong_is_told_at_its_place() {
    let told = refused(
        "reflectance = 0.1\nhapke = { b = 1.5, shadow_hiding = { amplitude = -1, width = 0 }, mean_slope_deg = 95, porosity_factor = 0.5 }",
    );
    for (place, message) in [
        ("hapke.b", "1.5 is out of range, which is from -1 to 1, ends excluded"),
        ("hapke.shadow_hiding.amplitude", "-1 is out of range, which is from 0"),
        ("hapke.shadow_hiding.width", "0 is out of range, which is above 0"),
        ("hapke.mean_slope_deg", "which is from 0 to below 90"),
        ("hapke.porosity_factor", "0.5 is out of range, which is from 1"),
    ] {
        assert!(told.contains(place) && told.contains(message), "{place}: {told}");
    }
    for (material, message) in [
        ("reflectance = 0.1\nminnaert = { exponent = -0.1 }", "minnaert.exponent: -0.1 is out of range"),
        ("reflectance = 0.1\nminnaert = { exponent = nan }", "minnaert.exponent: nan is not a finite number"),
        ("reflectance = 0.1\nminnaert = { k = 0.1 }", "exponent"),
        ("reflectance = 0.1\nlunar_lambert = { share = 1.5 }", "lunar_lambert.share: 1.5 is out of range"),
        ("reflectance = 0.1\nlommel_seeliger = { b = 0.9, c = 3 }", "the phase function is negative nowhere"),
        ("reflectance = 0.1\nlommel_seeliger = { b = -0.1, c = 0.3 }", "lommel_seeliger.b: -0.1"),
        ("reflectance = 0.1\nakimov = { phase = { beta = inf } }", "akimov.phase.beta"),
        ("reflectance = 0.1\nrpv = { k = 0.5, g = -1, h = 0.1 }", "rpv.g: -1 is out of range"),
        ("reflectance = 0.1\nrpv = { k = 0.5, g = -0.1, h = 3 }", "rpv.h: 3 is out of range"),
        ("reflectance = 0.1\nakimov = {}\nminnaert = { exponent = 1 }", "give either `minnaert` or `akimov`"),
        ("reflectance = 0.1\nmeasured = \"normal\"", "measured: says nothing of a Lambert surface"),
        ("reflectance = 0.1\nakimov = {}\nmeasured = \"nadir\"", "hemispherical"),
        ("reflectance = 0.9\nlommel_seeliger = {}", "reflectance: no albedo gives a reflectance of 0.9"),
        (
            "reflectance = 0.1\nakimov = {}\nmeasured = { incidence_deg = 90, emission_deg = 10, phase_deg = 30 }",
            "incidence_deg: 90 is outside",
        ),
        (
            "reflectance = 0.1\nakimov = {}\nmeasured = { incidence_deg = 50, emission_deg = 10, phase_deg = 30 }",
            "phase_deg: 30 is impossible at these angles, which leave 40 to 60",
        ),
        (
            "mixture = { dark = 1 }\nakimov = {}\n[materials.dark]\nreflectance = 0.1",
            "a mixture has no parameters of its own",
        ),
        ("mixture = { dark = 1 }\n[materials.dark]\nreflectance = 0.1\nakimov = {}", "only Lambert surfaces are mixed"),
    ] {
        let told = refused(material);
        assert!(told.contains(message), "{message}: {told}");
    }
}

/// The three cases of tables, with the value at incidence 30, emission 45, azimuth 60 deg, by hand: linear in each angle.
const TABLES: [(&str, f64); 4] = [
    ("incidence_deg,reflectance_factor\n0,0.1\n60,0.3\n", 0.2),
    ("incidence_deg,emission_deg,reflectance_factor\n0,0,0.1\n0,60,0.2\n60,0,0.2\n60,60,0.4\n", 0.2625),
    (
        "incidence_deg,emission_deg,azimuth_deg,reflectance_factor\n0,0,0,0.1\n0,90,0,0.1\n60,0,0,0.2\n60,90,0,0.2\n\
         0,0,180,0.4\n0,90,180,0.4\n60,0,180,0.5\n60,90,180,0.5\n",
        0.25,
    ),
    ("wavelength_um,incidence_deg,reflectance_factor\n0.5,0,0.1\n0.5,60,0.3\n1.5,0,0.2\n1.5,60,0.4\n", 0.25),
];

#[test]
fn tables_are_as_they_stand_or_at_the_level_of_a_spectrum() {
    let angles = PhotometricAngles::of_angles(PI / 6.0, PI / 4.0, PI / 3.0);
    let factor =
        |scene: &Scene, um: f64| scene.body.materials[0].photometry.brdf(um).unwrap().reflectance_factor(&angles);
    let phase_deg = angles.phase_rad().to_degrees();
    let at = format!("measured = {{ incidence_deg = 30, emission_deg = 45, phase_deg = {phase_deg} }}");
    for (table, expected) in TABLES {
        let with = |more: &str| {
            let folder = folder(&format!("table = \"table.csv\"\n{more}"));
            folder.write("table.csv", table);
            folder
        };
        let scene = scene_of(&with(""));
        assert!((factor(&scene, 1.0) / expected - 1.0).abs() < 1e-14, "{table}");
        let brdf = scene.body.materials[0].photometry.brdf(1.0).unwrap();
        let hemispherical = scene.body.materials[0].reflectance.at(1.0).unwrap();
        assert!((hemispherical / Measure::Spherical.of(&brdf) - 1.0).abs() < 1e-12);
        let halved = scene_of(&with("reflectance = 0.5\nmeasured = \"albedo\""));
        assert!((factor(&halved, 1.0) / (0.5 * expected) - 1.0).abs() < 1e-14, "{table}");
        // The spectrum is 0.03 at 0.9 and 0.06 at 1.4 um.
        let scene = scene_of(&with(&format!("reflectance = \"grey.csv\"\n{at}")));
        for (um, reflectance) in [(0.9, 0.03), (1.4, 0.06)] {
            assert!((factor(&scene, um) / reflectance - 1.0).abs() < 1e-12, "{table}");
        }
        for more in
            ["", "reflectance = 0.5\nmeasured = \"albedo\"", "reflectance = \"grey.csv\"\nmeasured = \"normal\""]
        {
            let folder = with(more);
            let (code, out, err) =
                run(&["convert", &folder.argument("scene.toml"), &folder.argument("again/scene.toml")]);
            assert!(code == 0 && !out.contains("Dropped"), "{out}{err}");
            let again = scene_toml::read(&folder.join("again/scene.toml"), &unwatched).unwrap().scene;
            let scene = scene_of(&folder);
            assert_eq!(scene.body.materials, again.body.materials, "{table} {more}");
            let content = |scene: Scene| Content::Scene(Box::new(scene), Vec::new());
            assert_eq!(differences(&content(scene), &content(again)), [""; 0]);
        }
    }
}

#[test]
fn a_table_in_the_image_has_its_factor_at_the_angles_of_each_pixel() {
    for (table, expected) in TABLES {
        let folder = folder("table = \"table.csv\"");
        folder.write("table.csv", table);
        // Light from 30 deg, view from 45 deg, 60 deg aside; pixels of a few metres from 100 km.
        let (s, c) = (0.5 * 3f64.sqrt() * 0.5_f64.sqrt(), 0.5_f64.sqrt());
        let (x, y) = (1e5 * 0.5 * 0.5_f64.sqrt(), 1e5 * s);
        let z = 11_000.0 + 1e5 * c;
        folder.edit("scene.toml", "direction = [0, 0, 1]", "direction = [0.5, 0, 0.8660254037844386]");
        folder.edit("scene.toml", "position_m = [0, 0, 12000]", &format!("position_m = [{x}, {y}, {z}]"));
        folder.edit("scene.toml", "fov_deg = 0.45836379150820084", "fov_deg = 0.0001");
        let scene = scene_of(&folder);
        let cube = study::simulate(&scene, &unwatched).unwrap().1.cube;
        let e = scene.sky.sun.irradiance_w_m2_um(1.0).unwrap() * (PI / 6.0).cos();
        let got = cube.band(0)[0] * PI / e;
        assert!((got / expected - 1.0).abs() < 1e-5, "{table}: {got} {expected}");
    }
}

#[test]
fn what_is_told_of_tables() {
    let told = |table: &str, more: &str| {
        let folder = folder(&format!("table = \"table.csv\"\n{more}"));
        folder.write("table.csv", table);
        match scene_toml::read(&folder.join("scene.toml"), &unwatched) {
            Ok(file) => file.notes.join("\n"),
            Err(error) => error.to_string(),
        }
    };
    let bright = "incidence_deg,reflectance_factor\n0,0.2\n80,1.3\n";
    let said = told(bright, "");
    assert!(said.contains("reflects 1.300 of the light from 80.0 deg: more than arrives"), "{said}");
    assert!(said.contains("light and view may not change places"), "{said}");
    for (more, message) in [
        ("measured = \"normal\"", "measured: says nothing without a `reflectance`: the table"),
        ("akimov = {}", "give either `akimov` or `table`"),
    ] {
        let said = told(TABLES[0].0, more);
        assert!(said.contains(message), "{message}: {said}");
    }
    let said = told("incidence_deg,reflectance_factor\n0,0\n80,0\n", "reflectance = 0.1");
    assert!(said.contains("reflectance: cannot set the level of the table"), "{said}");
    let said = told("incidence_deg,reflectance_factor\n0,0.1\n0,0.2\n", "");
    assert!(said.contains("table.csv:3: the same angles and wavelength as in line 2"), "{said}");
}
