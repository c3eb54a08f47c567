//! Numbers that no image could hold, surfaces that send less than nothing, and names that are taken are refused or told, where they are said.

use std::f64::consts::PI;

use mmxrt::physics::reflectance::{PhaseFunction, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{MOST_IRRADIANCE, Model, Photometry};
use mmxrt::spectral::Spectrum;
use mmxrt::study;

use crate::cli::run;
use crate::scenes::{self, SQUARE, SQUARE_OBJ, replaced};
use crate::scratch::Scratch;
use crate::shapes::{nadir, plane, sun};

const LAMP: &str = "[[lamps]]\nname = \"L\"\ndirection = [0, 0, 1]\nirradiance = 1.0\n";
const MOON: &str = "[[bodies]]\nname = \"moon\"\nposition_m = [0, 0, 3e8]\nradius_m = 1e5\nalbedo = 0.1\n";

fn square() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    scratch
}

/// What `inspect` says of a scene: its exit code, and both streams.
fn told(scratch: &Scratch, text: &str) -> (i32, String) {
    scratch.write("scene.toml", text);
    let (code, said, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    (code, said + &err)
}

/// The line of a text that has this in it, from 1.
fn line(text: &str, of: &str) -> usize {
    1 + text.lines().position(|line| line.contains(of)).unwrap()
}

#[test]
fn light_that_no_image_holds_is_refused_where_it_is_said() {
    let scratch = square();
    let mars = "[mars]\nposition_m = [9.4e6, 0, 11000]\n";
    let lamp = |from: &str, to: &str| SQUARE.to_owned() + &replaced(LAMP, &[(from, to)]);
    let total = "irradiance = 1.0\ntotal_irradiance_w_m2 = ";
    scratch.write("huge.csv", "wavelength_um,irradiance_w_m2_um\n0.5,1\n1.0,1e300\n2.0,1\n");
    let sun = |to: &str| replaced(SQUARE, &[("distance_au = 1.5", to)]);
    let material = |to: &str| replaced(SQUARE, &[("reflectance = 0.1\n", to)]);
    let equilibrium = |to: &str| material(to).replace("\"off\"", "\"equilibrium\"");
    for (text, at) in [
        (lamp("= 1.0", "= 1e308"), "irradiance = 1e308"),
        (lamp("= 1.0", "= 1.1e24"), "irradiance = 1.1e24"),
        (lamp("= 1.0", "= -1.0"), "irradiance = -1.0"),
        (lamp("= 1.0", "= \"huge.csv\""), "huge.csv"),
        (lamp("irradiance = 1.0", &format!("{total}1e308")), "total_irradiance_w_m2 = 1e308"),
        (sun("irradiance = 1e308"), "irradiance = 1e308"),
        (
            sun("position_m = [0, 0, 2e11]\nirradiance = 1e308").replace("direction = [0, 0, 1]\n", ""),
            "irradiance = 1e308",
        ),
        (sun("distance_au = 1.0\nspectrum = \"huge.csv\""), "huge.csv"),
        (sun("distance_au = 1.0\ntotal_irradiance_w_m2 = 1e308"), "total_irradiance_w_m2 = 1e308"),
        (SQUARE.to_owned() + mars + "thermal_exitance_w_m2 = 1e308\n", "thermal_exitance_w_m2 = 1e308"),
        (equilibrium("reflectance = 0.1\nemissivity_bolometric = 1e-300\n"), "emissivity_bolometric"),
        (equilibrium("reflectance = 0.1\nthermal_inertia = 1e300\n"), "thermal_inertia"),
        (SQUARE.replace("model = \"off\"", "period_s = 1e-300"), "period_s"),
    ] {
        let (code, said) = told(&scratch, &text);
        let expected = format!("scene.toml:{}:", line(&text, at));
        assert!(code == 1 && said.contains(&expected), "{expected}: {said}\n{text}");
    }
}

/// As bright as is allowed, twice over: 0.1 / pi of it, in 32 bits.
#[test]
fn the_most_light_that_is_allowed_is_a_number() {
    let scratch = square();
    let most = replaced(LAMP, &[("= 1.0", "= 1e24")]);
    let text = replaced(SQUARE, &[("distance_au = 1.5", "irradiance = 1e24")]) + &most;
    scratch.write("scene.toml", text);
    let out = scratch.argument("out");
    let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &out]);
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(scratch.join("out/cube.img")).unwrap();
    let values: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let expected = 2.0 * 0.1 / PI * MOST_IRRADIANCE;
    assert_eq!(values.len(), 4);
    assert!(values.iter().all(|v| (f64::from(*v) / expected - 1.0).abs() < 1e-6), "{values:?} {expected}");
}

#[test]
fn surfaces_that_send_less_than_nothing_are_told() {
    // Lommel and Seeliger: w (1 + c cos g) / 4 / (mu0 + mu), below 0 where light comes back if c is below -1.
    let of = |c: f64, albedo: f64| {
        let mut parts = scenes::parts(plane(60.0, 0.0), nadir(1e4, 80.0, 4), sun(40.0, 10.0));
        let shape = Shape::LommelSeeliger(PhaseFunction::Legendre { about_source: [c, 0.0], about_specular: [0.0; 2] });
        let model = Model { shape, albedo: Spectrum::constant(albedo), preset: None };
        parts.surface.materials[0].photometry = Photometry::Model(Box::new(model));
        parts.check().map(|scene| scene.remarks())
    };
    for c in [-1.0, 0.0, 1.0] {
        assert_eq!(of(c, 0.1).unwrap(), Vec::<String>::new(), "{c}");
    }
    for (c, place) in [(-1.5, "azimuth 0 deg"), (1.5, "azimuth 180 deg")] {
        let told = of(c, 0.1).unwrap();
        assert!(
            told.len() == 1 && told[0].contains("materials.\"grey\".lommel_seeliger: reflects less than nothing"),
            "{told:?}"
        );
        assert!(told[0].contains(place) && told[0].contains("phase function"), "{told:?}");
    }
    // And what is too much is refused.
    assert!(of(1e200, 0.1).unwrap_err().to_string().contains("materials.\"grey\".lommel_seeliger"));
    // A product says so, too.
    let scratch = square();
    let hapke = |c1: f64| {
        scratch.write(
            "h.csv",
            format!("wavelength_um,w,c1,c2,c3,c4,h1,h2\n0.5,0.1,{c1},0,0,0,0,0.1\n2,0.1,{c1},0,0,0,0,0.1\n"),
        );
        replaced(SQUARE, &[("reflectance = 0.1", "reflectance = 0.1\nhapke = \"h.csv\"")])
    };
    let (code, said) = told(&scratch, &hapke(-3.0));
    assert!(code == 0 && said.contains("hapke: reflects less than nothing"), "{said}");
    let scene = scratch.scene(&hapke(-3.0));
    let (_, seen) = study::simulate(&scene, &unwatched).unwrap();
    assert!(
        seen.cube.band(0).iter().all(|l| *l < 0.0) && seen.warnings.iter().any(|w| w.contains("less than nothing"))
    );
    let (code, said) = told(&scratch, &hapke(0.9));
    assert!(code == 0 && !said.contains("less than nothing"), "{said}");
}

#[test]
fn a_table_of_a_surface_says_which_line_is_wrong() {
    let scratch = square();
    let with = |key: &str| replaced(SQUARE, &[("reflectance = 0.1", key)]);
    let (hapke, rpv) = ("wavelength_um,w,c1,c2,c3,c4,h1,h2\n", "wavelength_um,rho0,k,g,h\n");
    for (key, csv, at) in [
        (
            "reflectance = 0.1\nhapke = \"t.csv\"",
            format!("# c\n{hapke}0.5,0.1,0,0,0,0,0,0.1\n2,1.1,0,0,0,0,0,0.1\n"),
            "t.csv:4: w = 1.1",
        ),
        (
            "reflectance = 0.1\nhapke = \"t.csv\"",
            format!("{hapke}0.5,0.1,0,0,0,0,0,0\n2,0.1,0,0,0,0,0,0.1\n"),
            "t.csv:2: h2 = 0",
        ),
        (
            "reflectance = 0.1\nrpv = \"t.csv\"",
            format!("{rpv}0.5,0.1,0.8,0,0.1\n2,0.1,0.8,0,2.5\n"),
            "t.csv:3: h = 2.5",
        ),
        (
            "reflectance = 0.1\nrpv = \"t.csv\"",
            format!("{rpv}0.5,0.1,0.8,-1,0.1\n2,0.1,0.8,0,0.1\n"),
            "t.csv:2: g = -1",
        ),
        (
            "table = \"t.csv\"",
            "incidence_deg,reflectance_factor\n0,0.1\n60,1e300\n".to_owned(),
            "t.csv:3: reflectance_factor 1e300",
        ),
        (
            "table = \"t.csv\"",
            "incidence_deg,emission_deg,reflectance_factor\n0,0,1\n0,60,1\n30,0,1\n".to_owned(),
            "t.csv:4: 1 factors",
        ),
        ("table = \"t.csv\"", "incidence_deg,reflectance_factor\n".to_owned(), "t.csv:1: no rows"),
    ] {
        scratch.write("t.csv", csv);
        let (code, said) = told(&scratch, &with(key));
        assert!(code == 1 && said.contains(at), "{at}: {said}");
    }
}

#[test]
fn names_that_are_taken_are_refused_in_their_line() {
    let scratch = square();
    let lamp = |name: &str| replaced(LAMP, &[("\"L\"", &format!("\"{name}\""))]);
    let body = |name: &str, z: &str| replaced(MOON, &[("\"moon\"", &format!("\"{name}\"")), ("3e8", z)]);
    for (more, name) in [
        (lamp("Sun"), "Sun"),
        (lamp("sun"), "sun"),
        (lamp("Mars"), "Mars"),
        (lamp("mars-heat"), "mars-heat"),
        (lamp("L") + &lamp("l"), "l"),
        (body("moon", "3e8") + &lamp("Moon"), "Moon"),
        (body("moon", "3e8") + &lamp("moon-heat"), "moon-heat"),
        (body("SUN", "3e8"), "SUN"),
        (body("moon", "3e8") + &body("MOON", "4e8"), "MOON"),
        (body("moon", "3e8") + &body("moon-heat", "4e8"), "moon-heat"),
        (lamp("sun_polygon"), "sun_polygon"),
        (lamp("a b"), "a b"),
        (lamp(""), ""),
    ] {
        let text = SQUARE.to_owned() + &more;
        let (code, said) = told(&scratch, &text);
        let expected = format!("scene.toml:{}:", line(&text, &format!("name = \"{name}\"")));
        assert!(code == 1 && said.contains(&expected) && said.contains("name"), "{expected}: {said}\n{text}");
    }
    // The second of two alike, where both are spelt alike.
    let text = SQUARE.to_owned() + LAMP + LAMP;
    let second = 1 + text.lines().collect::<Vec<_>>().iter().rposition(|line| line.contains("name = \"L\"")).unwrap();
    let (code, said) = told(&scratch, &text);
    assert!(code == 1 && said.contains(&format!("scene.toml:{second}:")) && said.contains("lamps[1].name"), "{said}");
    let (code, said) = told(&scratch, &(SQUARE.to_owned() + LAMP + &lamp("lamp-2") + MOON));
    assert_eq!(code, 0, "{said}");
}
