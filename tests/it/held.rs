//! Materials that are held at a temperature, whatever they absorb.

use mmxrt::Error;
use mmxrt::formats::scene_toml;
use mmxrt::geometry::MaterialId;
use mmxrt::physics::form_factor;
use mmxrt::product::FacetTable;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Exchange, Rotation, SceneParts, Thermal};
use mmxrt::solve;
use mmxrt::spectral::{Band, Light, Spectrum};
use mmxrt::study::{self, Choice, Decision, Extremes, Request};

use crate::cli::run;
use crate::scenes::{SQUARE, SQUARE_OBJ, lambert, parts, replaced};
use crate::scratch::Scratch;
use crate::shapes::*;

/// Two squares of ground side by side under the Sun at the zenith, the second of another material.
fn two_squares() -> SceneParts {
    let mut squares = [plane(2.0, 0.0), plane(2.0, 0.0)];
    squares[1].vertices_m.iter_mut().for_each(|v| v.x += 10.0);
    let mut parts = parts(joined(&squares), nadir(1000.0, 3.0, 4), direction([0.0, 0.0, 1.0]));
    parts.surface.materials.push(lambert(1, "heater", Spectrum::constant(0.2)));
    let half = parts.surface.mesh.facets.len() / 2;
    parts.surface.mesh.material[half..].fill(MaterialId(1));
    parts.models.thermal = Thermal::Equilibrium;
    parts.exposure.bands = vec![Band { light: Light::Heat, ..Band::new(10.0, None) }];
    parts
}

fn solved(parts: &SceneParts) -> FacetTable {
    solve::solve(&parts.clone().check().unwrap(), &unwatched).unwrap()
}

#[test]
fn what_is_held_has_its_temperature_and_nothing_else_another() {
    let plain = solved(&two_squares());
    for held_k in [0.0, 3.5, 700.0] {
        for thermal in [Thermal::Equilibrium, Thermal::Thesis] {
            let mut parts = two_squares();
            parts.models.thermal = thermal;
            parts.surface.materials[1].temperature_k = Some(held_k);
            // Neither a floor nor what the ground stores counts there.
            parts.models.floor_k = 100.0;
            parts.models.conduction = Some(24);
            parts.sky.rotation = Some(Rotation { axis: direction([0.0, 1.0, 0.0]), period_s: 27_554.0 });
            parts.surface.materials[1].thermal_inertia = 50.0;
            let table = solved(&parts);
            let half = table.facets() / 2;
            for column in [&table.temperature_lit_k, &table.temperature_shaded_k] {
                assert!(column[half..].iter().all(|t_k| *t_k == held_k), "{held_k} {thermal:?}");
                assert!(column[..half].iter().all(|t_k| *t_k >= 100.0), "{held_k} {thermal:?}");
            }
            if thermal == Thermal::Equilibrium {
                assert_eq!(table.temperature_lit_k[..half], plain.temperature_lit_k[..half]);
            }
            // A table of its own, and of no other scene.
            table.fits(&parts.clone().check().unwrap()).unwrap();
        }
    }
    let mut off = two_squares();
    off.surface.materials[1].temperature_k = Some(700.0);
    off.models.thermal = Thermal::Off;
    assert!(solved(&off).temperature_lit_k.is_empty());
}

#[test]
fn a_radiance_is_that_of_planck() {
    let mut parts = two_squares();
    parts.surface.mesh.material.fill(MaterialId(1));
    parts.surface.materials[1].temperature_k = Some(250.0);
    let (_, seen) = study::simulate(&parts.check().unwrap(), &unwatched).unwrap();
    // Emissivity 0.8 at 10 um and 250 K, by the constants of CODATA 2018: c1 = 2 h c^2, c2 = h c / k.
    let expected = 0.8 * 1.191_042_972_397_188e8 / 1e5 / ((14_387.768_775_039_337_f64 / 2500.0).exp() - 1.0);
    // Temperatures are interpolated.
    let band = seen.cube.band(0);
    assert!(band.iter().all(|l| (l / expected - 1.0).abs() < 1e-5), "{band:?} {expected}");
}

#[test]
fn what_is_held_warms_others_and_is_not_warmed() {
    // Two black squares of 1 m face each other 1 m apart in the dark: of what the one sends 0.1998 arrives at the other (Hottel).
    let mut plates = [plane(0.5, 0.0), plane(0.5, 0.0)];
    plates[1].flip();
    plates[1].vertices_m.iter_mut().for_each(|v| v.z += 1.0);
    let mut parts = parts(joined(&plates), nadir(1000.0, 3.0, 4), direction([0.0, 1.0, -1e-3]));
    parts.surface.materials =
        ["cold", "hot"].iter().enumerate().map(|(i, name)| lambert(i, name, Spectrum::constant(0.0))).collect();
    for material in &mut parts.surface.materials {
        (material.bond_albedo, material.emissivity_bolometric) = (1.0, 1.0);
    }
    let half = parts.surface.mesh.facets.len() / 2;
    parts.surface.mesh.material[half..].fill(MaterialId(1));
    parts.surface.materials[1].temperature_k = Some(300.0);
    parts.models.thermal = Thermal::Equilibrium;
    parts.exposure.bands = vec![Band::new(10.0, None)];
    parts.models.exchange = Some(Exchange { directions: 1024, lines_per_facet: 4096, bounces: 4 });
    let table = solved(&parts);
    assert!(table.temperature_shaded_k[half..].iter().all(|t_k| *t_k == 300.0));
    // Of what the cold one sends back nothing returns: the hot one is black.
    let factor = form_factor::parallel_rectangles(1.0, 1.0, 1.0);
    assert!((factor - 0.199_824_895_7).abs() < 1e-9);
    let mean = table.temperature_shaded_k[..half].iter().map(|t_k| t_k.powi(4)).sum::<f64>() / half as f64;
    assert!((mean / (factor * 300f64.powi(4)) - 1.0).abs() < 0.02, "{}", mean.powf(0.25));
}

#[test]
fn a_plan_knows_what_is_held() {
    // In the dark nothing but what is held is warm: its heat is the image.
    let mut parts = two_squares();
    parts.sky.sun.direction = direction([0.0, 1.0, -1.0]);
    parts.surface.materials[1].temperature_k = Some(400.0);
    let scene = parts.check().unwrap();
    let extremes = Extremes::with_shadows(&scene, &unwatched).unwrap();
    let request = Request { choice: Choice::Auto, tolerance: 1e-2 };
    let (models, plan) = study::plan(&scene, &extremes, &request).unwrap();
    let heat = plan.effects.iter().find(|effect| effect.key == "heat").unwrap();
    assert_eq!((models.thermal, heat.decision), (Thermal::Equilibrium, Decision::Kept));
}

const WARM: &str = "reflectance = 0.1\ntemperature_k = 291.5\n";

fn read(text: &str) -> Result<scene_toml::SceneFile, Error> {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    scene_toml::read(&scratch.write("scene.toml", text), &unwatched)
}

#[test]
fn a_scene_file_says_it_and_keeps_it() {
    let text = replaced(SQUARE, &[("reflectance = 0.1\n", WARM), ("model = \"off\"", "model = \"equilibrium\"")]);
    let file = read(&text).unwrap();
    assert_eq!(file.scene.body.materials[0].temperature_k, Some(291.5));
    for (value, message) in [
        ("-1", "-1 is less than 0"),
        ("nan", "temperature_k"),
        ("1e5", "100000 K is not from 0 to 1e4"),
        ("\"hot\"", "hot"),
    ] {
        let told = read(&text.replace("291.5", value)).unwrap_err().to_string();
        assert!(told.contains("scene.toml:7") && told.contains(message), "{value}: {told}");
    }
    let off = read(&text.replace("\"equilibrium\"", "\"off\"")).unwrap();
    assert!(
        off.notes.iter().any(|note| note.contains("temperature_k") && note.contains("counts for nothing")),
        "{:?}",
        off.notes
    );
    let mixed = text.replace("[sun]", "[materials.mixed]\nmixture = { default = 1 }\n[sun]");
    let mixed = read(&mixed).unwrap();
    assert!(mixed.notes.iter().any(|note| note.contains("the mixture is not")), "{:?}", mixed.notes);
    // Written and read again; another value, and none, are differences.
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    scratch.write("scene.toml", &text);
    let (code, _, err) = run(&["convert", &scratch.argument("scene.toml"), &scratch.argument("out/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    let compare = |other: &str| run(&["convert", "--diff", &scratch.argument("scene.toml"), &scratch.argument(other)]);
    assert_eq!(compare("out/scene.toml").1, "the same in meaning\n");
    scratch.write("other.toml", text.replace("291.5", "291.6"));
    assert!(compare("other.toml").1.contains("temperature_k: 291.5, 291.6"));
    scratch.write("none.toml", text.replace("temperature_k = 291.5\n", ""));
    assert!(compare("none.toml").1.contains("temperature_k: 291.5, as the model has it"));
}
