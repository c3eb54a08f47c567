//! Surfaces by name: what scenes and reports have of them, and the phase curve of a sphere of them.

use std::f64::consts::PI;

use mmxrt::formats::convert::{Content, differences};
use mmxrt::formats::scene_toml;
use mmxrt::physics::reflectance::{PhotometricAngles, Preset};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Photometry, Scene};
use mmxrt::study;
use serde_json::Value;

use crate::cli::run;
use crate::scenes::{SQUARE, SQUARE_OBJ, replaced};
use crate::scratch::Scratch;
use crate::shapes::sphere;

fn folder(material: &str) -> Scratch {
    let folder = Scratch::new();
    folder.write("square.obj", SQUARE_OBJ);
    folder.write("scene.toml", replaced(SQUARE, &[("reflectance = 0.1\n", &format!("{material}\n"))]));
    folder.write("grey.csv", "wavelength_um,reflectance\n0.8,0.04\n1.4,0.08\n");
    folder
}

fn scene_of(folder: &Scratch) -> Scene {
    scene_toml::read(&folder.join("scene.toml"), &unwatched).unwrap_or_else(|e| panic!("{e}")).scene
}

fn refused(material: &str) -> String {
    match scene_toml::read(&folder(material).join("scene.toml"), &unwatched) {
        Ok(_) => panic!("{material} is read"),
        Err(error) => error.to_string(),
    }
}

/// Hapke's model of Phobos as the equations have it (1981 to 2002), written out once more; 1/sr.
fn hapke(cos_i: f64, cos_e: f64, cos_g: f64, [w, b, b0, h, slope_deg]: [f64; 5]) -> f64 {
    let (i, e) = (cos_i.acos(), cos_e.acos());
    let across = i.sin() * e.sin();
    let psi = if across > 0.0 { ((cos_g - cos_i * cos_e) / across).clamp(-1.0, 1.0).acos() } else { 0.0 };
    let t = slope_deg.to_radians().tan();
    let chi = 1.0 / (1.0 + PI * t * t).sqrt();
    let e1 = |x: f64| (-2.0 / (PI * t * x.tan())).exp();
    let e2 = |x: f64| (-1.0 / (PI * (t * x.tan()).powi(2))).exp();
    let eta = |x: f64| chi * (x.cos() + x.sin() * t * e2(x) / (2.0 - e1(x)));
    let s2 = (0.5 * psi).sin().powi(2);
    let f = (-2.0 * (0.5 * psi).tan()).exp();
    let (mu0e, mue, s);
    if i <= e {
        let n = 2.0 - e1(e) - psi / PI * e1(i);
        mu0e = chi * (i.cos() + i.sin() * t * (psi.cos() * e2(e) + s2 * e2(i)) / n);
        mue = chi * (e.cos() + e.sin() * t * (e2(e) - s2 * e2(i)) / n);
        s = mue / eta(e) * cos_i / eta(i) * chi / (1.0 - f + f * chi * cos_i / eta(i));
    } else {
        let n = 2.0 - e1(i) - psi / PI * e1(e);
        mu0e = chi * (i.cos() + i.sin() * t * (e2(i) - s2 * e2(e)) / n);
        mue = chi * (e.cos() + e.sin() * t * (psi.cos() * e2(i) + s2 * e2(e)) / n);
        s = mue / eta(e) * cos_i / eta(i) * chi / (1.0 - f + f * chi * cos_e / eta(e));
    }
    let g = cos_g.clamp(-1.0, 1.0).acos();
    let p = (1.0 - b * b) / (1.0 + 2.0 * b * cos_g + b * b).powf(1.5);
    let surge = b0 / (1.0 + (0.5 * g).tan() / h);
    let gamma = (1.0 - w).sqrt();
    let r0 = (1.0 - gamma) / (1.0 + gamma);
    // Within 2.5e-5 of Chandrasekhar's at this w.
    let h_of = |x: f64| 1.0 / (1.0 - w * x * (r0 + 0.5 * (1.0 - 2.0 * r0 * x) * ((1.0 + x) / x).ln()));
    w / (4.0 * PI) * mu0e / (mu0e + mue) * (p * (1.0 + surge) + h_of(mu0e) * h_of(mue) - 1.0) * s / cos_i
}

/// Brightness of a sphere of it, over that of a white disc: int f mu0 mu dOmega over what is lit and seen, by the midpoint rule.
fn of_sphere(phase_deg: f64) -> f64 {
    const N: usize = 400;
    let phase = phase_deg.to_radians();
    let step = (PI - phase) / N as f64;
    let mut sum = 0.0;
    for k in 0..N {
        let longitude = phase - 0.5 * PI + (k as f64 + 0.5) * step;
        for j in 0..N {
            let latitude = (j as f64 + 0.5) * 0.5 * PI / N as f64;
            let (mu0, mu) = (latitude.cos() * (longitude - phase).cos(), latitude.cos() * longitude.cos());
            let f = hapke(mu0, mu, phase.cos(), [0.072, -0.2587, 2.28, 0.0573, 24.0]);
            sum += f * mu0 * mu * latitude.cos();
        }
    }
    2.0 * sum * step * 0.5 * PI / N as f64
}

#[test]
fn a_sphere_of_phobos_has_the_published_albedo_and_its_phase_curve() {
    let folder = Scratch::new();
    folder.obj("ball", &sphere([0.0; 3], 1.0, 5), &[("grey", None)]);
    const PIXELS: f64 = 64.0;
    let pitch = 2.2 / PIXELS / 1e4;
    for (phase_deg, tolerance) in [(0.0, 0.01), (5.0, 0.01), (30.0, 0.01), (90.0, 0.01)] {
        let (sin, cos) = f64::to_radians(phase_deg).sin_cos();
        folder.write(
            "scene.toml",
            format!(
                "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\nobj = \"ball.obj\"\n[materials.grey]\npreset = \"phobos_assumed\"\n\
                 [sun]\ndirection = [{sin}, 0, {cos}]\ndistance_au = 1.0\n[thermal]\nmodel = \"off\"\n\
                 [observer]\nposition_m = [0, 0, 1e4]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
                 [sensor]\nsamples = {PIXELS}\nlines = {PIXELS}\nifov_mrad = {}\n[sensor.bands]\ncentres_um = [0.538]\n",
                2e3 * (0.5 * pitch).atan()
            ),
        );
        let scene = scene_of(&folder);
        let irradiance = scene.sky.sun.irradiance_w_m2_um(0.538).unwrap();
        let sum: f64 = study::simulate(&scene, &unwatched).unwrap().1.cube.band(0).iter().sum();
        let got = sum * (pitch * 1e4).powi(2) / irradiance;
        let expected = of_sphere(phase_deg);
        assert!((got / expected - 1.0).abs() < tolerance, "{phase_deg}: {got} {expected}");
        if phase_deg == 0.0 {
            assert!((got / 0.068 - 1.0).abs() < 0.01, "{got}");
        }
    }
}

#[test]
fn numbers_are_replaced_one_by_one() {
    let angles = [(0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (60.0, 40.0, 90.0)]
        .map(|(i, e, psi)| PhotometricAngles::of_angles(f64::to_radians(i), f64::to_radians(e), f64::to_radians(psi)));
    // w 0.072, b -0.25, B0 2.28, h 0.0573, 24 deg and the H of 2002, computed independently in 40 digits.
    let expected = [0.021_021_228_757_924_24, 0.008_221_149_356_839_853, 0.005_613_527_003_819_967];
    let scene = scene_of(&folder("preset = \"phobos_assumed\"\nhapke = { b = -0.25, h = \"hapke2002\" }"));
    let brdf = scene.body.materials[0].photometry.brdf(1.0).unwrap();
    for (angles, expected) in angles.iter().zip(expected) {
        assert!((brdf.eval(angles) / expected - 1.0).abs() < 1e-12);
    }
    // Half of a surge, and an albedo from a spectrum.
    let more = "reflectance = \"grey.csv\"\nmeasured = \"normal\"\nhapke = { shadow_hiding = { width = 0.1 } }";
    let scene = scene_of(&folder(&format!("preset = \"deimos_assumed\"\n{more}")));
    let brdf = scene.body.materials[0].photometry.brdf(1.4).unwrap();
    assert!((brdf.reflectance_factor(&PhotometricAngles::ZENITH) / 0.08 - 1.0).abs() < 1e-12);
    assert!(format!("{brdf:?}").contains("amplitude: 2.14, width: 0.1"), "{brdf:?}");
    // Lambert, by name.
    let thesis = scene_of(&folder("preset = \"thesis\""));
    let lambert = scene_of(&folder("reflectance = 0.07"));
    assert_eq!(thesis.body.materials, lambert.body.materials);
}

#[test]
fn all_are_written_and_read_back_the_same() {
    for preset in Preset::ALL {
        let name = preset.name();
        let own = match preset {
            Preset::Thesis => "",
            Preset::Mars => "minnaert = { exponent = 0.6 }",
            _ => "hapke = { mean_slope_deg = 0, coherent = { amplitude = 0.2, width = 0.01 }, h = \"hapke1981\" }",
        };
        for more in ["", "reflectance = \"grey.csv\"", own] {
            let folder = folder(&format!("preset = {name:?}\n{more}"));
            let (code, out, err) =
                run(&["convert", &folder.argument("scene.toml"), &folder.argument("again/scene.toml")]);
            assert!(code == 0 && !out.contains("Dropped") && !out.contains("Approximated"), "{out}{err}");
            let again = scene_toml::read(&folder.join("again/scene.toml"), &unwatched).unwrap().scene;
            let scene = scene_of(&folder);
            assert_eq!(scene.body.materials, again.body.materials, "{name} {more}");
            let content = |scene: Scene| Content::Scene(Box::new(scene), Vec::new());
            assert_eq!(differences(&content(scene), &content(again)), [""; 0]);
        }
    }
}

#[test]
fn what_does_not_fit_a_preset() {
    for (material, message) in [
        ("preset = \"pluto\"", "phobos_assumed"),
        (
            "preset = \"mars\"\nhapke = { b = 0.1 }",
            "hapke: the preset `mars` is a `minnaert` surface, not a `hapke` one",
        ),
        ("preset = \"thesis\"\nakimov = {}", "akimov: the preset `thesis` is Lambert's surface"),
        ("preset = \"moon\"\nhapke = \"x.csv\"", "hapke: a table has all numbers"),
        ("preset = \"moon\"\nmeasured = \"normal\"", "measured: says nothing without a `reflectance`"),
        ("preset = \"thesis\"\nmeasured = \"normal\"", "measured: says nothing of a Lambert surface"),
        ("mixture = { dark = 1 }\npreset = \"moon\"\n[materials.dark]\nreflectance = 0.1", "preset: a mixture has no"),
        ("reflectance = 0.1\nhapke = { shadow_hiding = { width = 0.1 } }", "shadow_hiding.amplitude: is not given"),
        ("preset = \"moon\"\nhapke = { coherent = { amplitude = 0.1 } }", "coherent.width: is not given"),
        ("preset = \"phobos_assumed\"\nreflectance = 0.99", "no albedo gives a reflectance of 0.99"),
    ] {
        let told = refused(material);
        assert!(told.contains(message), "{message}: {told}");
    }
}

#[test]
fn the_report_says_where_numbers_come_from_and_what_they_are_worth() {
    let folder = folder("preset = \"phobos_assumed\"\nhapke = { b = -0.25, h = \"hapke2002\" }");
    // The Sun at 30 deg.
    folder.edit("scene.toml", "direction = [0, 0, 1]", "direction = [0.5, 0, 0.8660254037844386]");
    let (code, out, err) = run(&["simulate", &folder.argument("scene.toml"), "-o", &folder.argument("out")]);
    assert_eq!(code, 0, "{out}{err}");
    let report: Value = serde_json::from_slice(&std::fs::read(folder.join("out/report.json")).unwrap()).unwrap();
    let surface = &report["surfaces"][0];
    let factors: Vec<f64> =
        surface["reflectance_factors"].as_array().unwrap().iter().map(|f| f["value"].as_f64().unwrap()).collect();
    for (got, brdf) in
        factors.iter().zip([0.021_021_228_757_924_24, 0.008_221_149_356_839_853, 0.005_613_527_003_819_967])
    {
        assert!((got / (PI * brdf) - 1.0).abs() < 1e-12, "{got}");
    }
    // Computed independently: 0.065995.
    assert!((surface["geometric_albedo"].as_f64().unwrap() / 0.065_995 - 1.0).abs() < 1e-4);
    let preset = &surface["preset"];
    let numbers = preset["numbers"].as_array().unwrap();
    let of = |key: &str| numbers.iter().find(|n| n["key"] == key).unwrap();
    let (b, b0, slope) = (of("b"), of("shadow_hiding.amplitude"), of("mean_slope_deg"));
    assert_eq!(
        (&b["origin"], &b0["origin"], &slope["origin"]),
        (&"given".into(), &"published".into(), &"assumed".into())
    );
    assert!(b0["source"].as_str().unwrap().contains("Fornasier"), "{b0}");
    // (1 + B(30 deg)) / (1 + B0) with B0 3 percent of 1 more: as the equation has it, of light scattered once.
    let surge = |b0: f64| (1.0 + b0 / (1.0 + 15f64.to_radians().tan() / 0.0573)) / (1.0 + b0);
    let worth = b0["worth"].as_f64().unwrap();
    assert!((worth / (surge(2.25) / surge(2.28) - 1.0).abs() - 1.0).abs() < 0.05, "{worth}");
    let sum = numbers.iter().map(|n| n["worth"].as_f64().unwrap().powi(2)).sum::<f64>().sqrt();
    assert!(sum > 0.0 && (preset["uncertainty"].as_f64().unwrap() / sum - 1.0).abs() < 1e-12);
    assert!(preset["at"].as_str().unwrap().contains("phase 30.0 deg"), "{preset}");
    let Photometry::Model(model) = &scene_of(&folder).body.materials[0].photometry else { panic!() };
    assert_eq!(model.preset, Some(Preset::PhobosAssumed));
}

#[test]
fn a_surface_is_inspected_and_its_phase_curve_drawn() {
    let folder = folder("reflectance = 0.1\nmeasured = \"normal\"\nminnaert = { exponent = 0.6 }");
    let scene = folder.argument("scene.toml");
    let (svg, csv) = (folder.argument("curve.svg"), folder.argument("curve.csv"));
    let told =
        ["inspect", &scene, "--material", "default", "--um", "0.8", "--um", "2", "--picture", &svg, "--csv", &csv];
    let (code, out, err) = run(&[&["--json"], &told[..]].concat());
    assert_eq!(code, 0, "{err}");
    let surfaces: Value = serde_json::from_str(&out).unwrap();
    let surface = &surfaces["surfaces"][1];
    assert_eq!((surface["wavelength_um"].as_f64(), surface["model"].as_str()), (Some(2.0), Some("minnaert")));
    // A (cos i cos e)^(k - 1) at 60 and 40 deg, computed independently for A = 0.07.
    let factor = surface["reflectance_factors"][2]["value"].as_f64().unwrap();
    assert!((factor / (PI * 0.032_708_345_679_563_704 / 0.07 * 0.1) - 1.0).abs() < 1e-12, "{factor}");
    // 2 A / (2 k + 1), but for the limb; the phase of 60 and 40 deg at 90 deg azimuth.
    assert!((surface["geometric_albedo"].as_f64().unwrap() / (0.2 / 2.2) - 1.0).abs() < 1e-4);
    let phase = surface["reflectance_factors"][2]["phase_deg"].as_f64().unwrap();
    assert!((phase - (0.5 * 40f64.to_radians().cos()).acos().to_degrees()).abs() < 1e-9);
    let drawn = std::fs::read_to_string(&svg).unwrap();
    assert!(drawn.contains("phase angle, deg") && drawn.contains("Lambert"), "{drawn}");
    let table = std::fs::read_to_string(&csv).unwrap();
    let rows: Vec<Vec<f64>> =
        table.lines().skip(2).map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert!(rows.len() > 150 && rows[0][0] == 0.0 && (rows[0][1] / rows[0][3] - 1.0).abs() < 1e-9);
    // Lambert at 90 deg: 1 / pi of its full phase.
    let at_90 = rows.iter().find(|row| row[0] == 90.0).unwrap();
    assert!((at_90[3] / rows[0][3] * PI - 1.0).abs() < 1e-9);

    let (code, out, err) = run(&["inspect", "phobos_assumed"]);
    assert_eq!(code, 0, "{err}");
    for told in ["geometric albedo: 0.0680", "hemispherical albedo: 0.0227", "published", "Fornasier", "assumed"] {
        assert!(out.contains(told), "{told}: {out}");
    }
    let (code, _, err) = run(&["inspect", &scene, "--material", "gold"]);
    assert!(code == 1 && err.contains("has no material \"gold\"") && err.contains("default"), "{err}");
    let (code, _, err) = run(&["inspect", &scene, "--material", "default", "--picture", &folder.argument("x.png")]);
    assert!(code == 1 && err.contains("ends in .svg"), "{err}");
}
