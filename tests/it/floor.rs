//! A floor under temperatures, and what neighbours' heat may be worth.

use mmxrt::physics::{blackbody, form_factor};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Exchange, Rotation, SceneParts, Thermal};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::study::{self, Choice, Decision, Extremes, Request};
use mmxrt::{Error, solve};

use crate::scenes::{SQUARE, SQUARE_OBJ, lambert, parts, replaced};
use crate::scratch::Scratch;
use crate::shapes::*;

/// Ground and a wall in the South, whose shadow covers the ground, seen at 10 um.
fn before_a_wall() -> SceneParts {
    let mesh = joined(&[plane(2.0, 0.0), cuboid([-9.0, -3.0, 0.0], [9.0, -2.5, 9.0]), plane(2.0, 20.0)]);
    let mut parts = parts(mesh, nadir(1000.0, 3.0, 4), direction([0.0, -1.0, 1.0]));
    parts.models.thermal = Thermal::Equilibrium;
    parts.exposure.bands = vec![Band::new(10.0, None)];
    parts
}

#[test]
fn nothing_is_colder_than_the_floor() {
    let solved = |floor_k: f64, thermal: Thermal| {
        let mut parts = before_a_wall();
        (parts.models.floor_k, parts.models.thermal) = (floor_k, thermal);
        solve::solve(&parts.check().unwrap(), &unwatched).unwrap()
    };
    let (bare, floored) = (solved(0.0, Thermal::Equilibrium), solved(40.0, Thermal::Equilibrium));
    // The ground is in shadow, which is at 0 K otherwise; what stands in the Sun is as warm as before.
    assert_eq!((bare.temperature_shaded_k[0], floored.temperature_shaded_k[0]), (0.0, 40.0));
    let last = floored.facets() - 1;
    assert!(bare.temperature_lit_k[last] > 250.0);
    assert_eq!(bare.temperature_lit_k[last], floored.temperature_lit_k[last]);
    assert!(floored.temperature_lit_k.iter().chain(&floored.temperature_shaded_k).all(|t_k| *t_k >= 40.0));
    assert!(solved(40.0, Thermal::Off).temperature_lit_k.is_empty());
    // The thesis has 150 K in shadow.
    assert!(solved(160.0, Thermal::Thesis).temperature_shaded_k.iter().all(|t_k| *t_k == 160.0));
    // A floor above all else is the temperature everywhere, and fits its scene.
    let mut parts = before_a_wall();
    parts.models.floor_k = 500.0;
    let scene = parts.check().unwrap();
    let table = solve::solve(&scene, &unwatched).unwrap();
    assert!(table.temperature_lit_k.iter().all(|t_k| *t_k == 500.0) && table.fits(&scene).is_ok());
}

#[test]
fn a_floor_does_not_heat_the_ground_below_it() {
    // Nights that would be colder end there; noon is what it was: what keeps the floor up is not stored.
    let solved = |floor_k: f64, towards: [f64; 3]| {
        let mut parts = parts(plane(2.0, 0.0), nadir(1000.0, 3.0, 4), direction(towards));
        parts.models.thermal = Thermal::Equilibrium;
        parts.models.conduction = Some(48);
        parts.models.floor_k = floor_k;
        parts.sky.rotation = Some(Rotation { axis: direction([0.0, 1.0, 0.0]), period_s: 27_554.0 });
        parts.surface.materials[0].thermal_inertia = 50.0;
        solve::solve(&parts.check().unwrap(), &unwatched).unwrap().temperature_lit_k[0]
    };
    let night = [0.1, 0.0, -1.0];
    assert!(solved(0.0, night) < 170.0);
    assert_eq!(solved(170.0, night), 170.0);
    assert_eq!(solved(170.0, [0.0, 0.0, 1.0]), solved(0.0, [0.0, 0.0, 1.0]));
}

#[test]
fn the_plan_knows_the_floor() {
    // At 10 um ground of 120 K in shadow counts: leaving heat out changes it by all of it.
    let mut parts = before_a_wall();
    parts.models.floor_k = 120.0;
    let scene = parts.check().unwrap();
    let extremes = Extremes::with_shadows(&scene, &unwatched).unwrap();
    let (_, plan) = study::plan(&scene, &extremes, &Request { choice: Choice::Full, tolerance: 1e-3 }).unwrap();
    let heat = plan.effects.iter().find(|effect| effect.key == "heat").unwrap();
    assert_eq!(heat.decision, Decision::Kept);
    let (_, seen) = study::simulate(&scene, &unwatched).unwrap();
    let expected = 0.93 * blackbody::radiance_w_m2_sr_um(10.0, 120.0);
    assert!(seen.cube.band(0).iter().all(|l| *l >= 0.999 * expected), "{:?} {expected}", seen.cube.band(0));
}

#[test]
fn a_floor_is_read_and_checked() {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    let scene = scratch.scene(&replaced(SQUARE, &[("model = \"off\"", "floor_k = 45.5")]));
    assert_eq!(scene.models.floor_k, 45.5);
    // And written.
    scratch.write("from.toml", replaced(SQUARE, &[("model = \"off\"", "floor_k = 45.5")]));
    let (from, to) = (scratch.argument("from.toml"), scratch.argument("to.toml"));
    let (code, _, err) = crate::cli::run(&["convert", &from, &to]);
    assert_eq!(code, 0, "{err}");
    assert!(std::fs::read_to_string(&to).unwrap().contains("floor_k = 45.5"));
    for floor_k in [-1.0, f64::NAN, 2e4] {
        let mut parts = before_a_wall();
        parts.models.floor_k = floor_k;
        let Err(Error::Invalid(problems)) = parts.check() else { panic!("{floor_k}") };
        assert!(problems.iter().any(|p| p.to_string().contains("thermal.floor_k")), "{problems:?}");
    }
}

/// Ground of 8 x 8 m, and a wall in the West that is 4 m high and faces the Sun in the East: what of its heat the ground reflects is within the bound.
#[test]
fn what_neighbours_heat_adds_is_bounded() {
    let ground = quad([-4.0, -4.0, 0.0], [4.0, -4.0, 0.0], [4.0, 4.0, 0.0], [-4.0, 4.0, 0.0]);
    let wall = quad([-4.0, -4.0, 0.0], [-4.0, 4.0, 0.0], [-4.0, 4.0, 4.0], [-4.0, -4.0, 4.0]);
    let mut parts = parts(joined(&[ground, wall]), nadir(1000.0, 8.0, 8), direction([1.0, 0.0, 0.02]));
    parts.models.thermal = Thermal::Equilibrium;
    parts.models.exchange = Some(Exchange::default());
    parts.surface.materials = vec![lambert(0, "grey", Spectrum::constant(0.2))];
    parts.exposure.bands = vec![Band::new(3.6, None)];
    let scene = parts.check().unwrap();
    let extremes = Extremes::with_shadows(&scene, &unwatched).unwrap();
    let (_, plan) = study::plan(&scene, &extremes, &Request { choice: Choice::Full, tolerance: 1e-3 }).unwrap();
    let effect = plan.effects.iter().find(|effect| effect.key == "neighbours-glow").unwrap();
    assert_eq!(effect.decision, Decision::Open);
    let table = solve::solve(&scene, &unwatched).unwrap();
    let (_, seen) = study::simulate(&scene, &unwatched).unwrap();
    // The mean over the ground, of the wall as it is.
    let factor = form_factor::perpendicular_rectangles(8.0, 8.0, 4.0);
    let arriving = factor * 0.8 * blackbody::radiance_w_m2_sr_um(3.6, table.temperature_lit_k[2]);
    let of_ground = seen.cube.band(0);
    let mut sorted = of_ground.clone();
    sorted.sort_by(f64::total_cmp);
    let (largest, median) = (sorted[sorted.len() - 1], sorted[sorted.len() / 2]);
    let change = 0.2 * arriving / largest.max(0.01 * median);
    let bound = effect.bound.unwrap();
    assert!(change > 0.01 && change <= bound.lit && bound.lit < 300.0 * change, "{change} {bound:?}");
}
