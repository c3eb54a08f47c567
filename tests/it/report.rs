//! What a result says of itself: effects with bounds, warnings, checks; and what is refused.

use mmxrt::geometry::{Direction, FrameCamera, Mesh};
use mmxrt::integrate::Wanted;
use mmxrt::product::FacetTable;
use mmxrt::progress::unwatched;
use mmxrt::scene::{DirectionField, Globe, MarsModel, SceneParts, Thermal};
use mmxrt::spectral::{Band, Light, Spectrum, solar_e490};
use mmxrt::study::{Bound, Decision, Effect, Observation, simulate, table_id};
use mmxrt::units::AU_M;

use crate::cli::run;
use crate::scenes;
use crate::scratch::Scratch;
use crate::shapes::*;

const MARS_M: f64 = 9_376_000.0;

fn mars(towards: [f64; 3]) -> Globe {
    scenes::mars(MARS_M * direction(towards).vec())
}

/// A scene of one material, without Mars or heat, in bands at 1 and 3.6 um.
fn scene(mesh: Mesh, towards_sun: Direction, camera: FrameCamera) -> SceneParts {
    let mut parts = scenes::parts(mesh, camera, towards_sun);
    let sun = &mut parts.sky.sun;
    (sun.distance_m, sun.irradiance_1au, sun.total_irradiance_1au_w_m2) = (1.5237 * AU_M, solar_e490().clone(), 1366.1);
    parts.exposure.bands = [1.0, 3.6].map(|centre_um| Band::new(centre_um, None)).into();
    parts
}

fn observed(scene: &SceneParts) -> Observation {
    let (_, observation) = simulate(&scene.clone().check().unwrap(), &unwatched).unwrap();
    for check in &observation.checks {
        assert!(check.passed(), "{check:?}");
    }
    assert!(observation.checks.len() >= 4);
    observation
}

fn hills() -> Mesh {
    grid(50.0, 60, |x, y| 4.0 * (0.15 * x).sin() * (0.2 * y + 0.1 * x).cos())
}

fn effect<'a>(observation: &'a Observation, name: &str) -> &'a Effect {
    observation.effects.iter().find(|e| e.name == name).unwrap_or_else(|| panic!("no effect {name:?}"))
}

/// The bound on a change of radiance, over the median sunlit radiance: in shadow errors are relative to 0.01 of that.
fn of_median(observation: &Observation, name: &str) -> f64 {
    0.01 * effect(observation, name).bound.unwrap().shadow
}

fn warned(observation: &Observation, words: &str) -> bool {
    observation.warnings.iter().any(|w| w.contains(words))
}

/// Median of the radiance of pixels that are lit all over.
fn median_sunlit(observation: &Observation, band: usize) -> f64 {
    let lit = &observation.backplanes.plane("LIT_FRACTION").unwrap().values;
    let radiance = observation.cube.band(band);
    let mut lit: Vec<f64> = radiance.into_iter().zip(lit).filter(|(_, lit)| **lit > 0.999).map(|(l, _)| l).collect();
    assert!(lit.len() > 50);
    lit.sort_by(f64::total_cmp);
    lit[lit.len() / 2]
}

/// Largest change between two cubes in any band, relative to the median sunlit radiance of the first.
fn largest_change(one: &Observation, other: &Observation) -> f64 {
    let of_band = |band| {
        let reference = median_sunlit(one, band);
        let pairs = one.cube.band(band).into_iter().zip(other.cube.band(band));
        pairs.map(|(a, b)| (a - b).abs() / reference).fold(0.0, f64::max)
    };
    (0..one.cube.axes.bands.len()).map(of_band).fold(0.0, f64::max)
}

/// The largest error of a pixel in any band, as bounds are of it.
fn largest_error(truth: &Observation, other: &Observation) -> f64 {
    let of_band = |band| {
        let floor = 0.01 * median_sunlit(truth, band);
        let pairs = truth.cube.band(band).into_iter().zip(other.cube.band(band));
        pairs.map(|(a, b)| (a - b).abs() / a.max(floor)).fold(0.0, f64::max)
    };
    (0..truth.cube.axes.bands.len()).map(of_band).fold(0.0, f64::max)
}

#[test]
fn every_effect_says_what_it_is() {
    let observation = observed(&scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 24)));
    assert_eq!(observation.effects.len(), 18);
    let mut bounded = 0;
    for effect in &observation.effects {
        assert!(effect.note.len() > 20 && effect.because.len() > 15, "{effect:?}");
        assert!(effect.bound.is_none_or(|b| b.lit >= 0.0 && b.shadow >= b.lit && b.shadow.is_finite()), "{effect:?}");
        bounded += usize::from(effect.bound.is_some());
    }
    // Not known: photometry, the instrument, an eclipse by a Mars that is not in the scene, and beaming of what has no temperature.
    assert_eq!(bounded, 14);
    let kept = |observation: &Observation| -> Vec<String> {
        let kept = observation.effects.iter().filter(|e| e.decision == Decision::Kept);
        kept.map(|e| e.key.clone()).collect()
    };
    let modelled = kept(&observation);
    assert_eq!(modelled, ["sunlight"]);
    let mut all = scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 24));
    all.sky.mars = Some(mars([0.3, -0.1, 1.0]));
    all.models.thermal = Thermal::Equilibrium;
    assert_eq!(kept(&observed(&all)), ["sunlight", "mars-light", "heat", "mars-heat"]);
}

/// What an effect names is there to be found: a file or folder of modules, or an item in one.
#[test]
fn every_effect_names_what_is_there() {
    let observation = observed(&scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 24)));
    let source = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = 0;
    for effect in &observation.effects {
        assert!(
            effect.decision != Decision::Kept || (effect.equation.is_some() && effect.step.is_some()),
            "{effect:?}"
        );
        for path in effect.equation.iter().chain(&effect.step).flat_map(|paths| paths.split(", ")) {
            let place = |path: &str| source.join(path.replace("::", "/"));
            let is_module = place(path).is_dir() || place(path).with_extension("rs").is_file();
            let (module, item) = path.rsplit_once("::").unwrap();
            let files = [place(module).with_extension("rs"), place(module).join("mod.rs")];
            let text: String = files.iter().filter_map(|file| std::fs::read_to_string(file).ok()).collect();
            let is_item = ["fn ", "struct ", "enum ", "{", ", ", "::"]
                .iter()
                .any(|before| text.contains(&format!("{before}{item}")));
            assert!(is_module || is_item, "{}: {path}", effect.name);
            found += 1;
        }
    }
    assert!(found >= 10, "{found}");
}

#[test]
fn bounds_of_what_is_left_out_hold() {
    let plain = scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 24));
    let without = observed(&plain);
    // A half Mars, 30 deg above the horizon.
    let mut with_mars = plain.clone();
    with_mars.sky.mars = Some(mars([-0.9, -0.15, 0.5]));
    let error = largest_error(&observed(&with_mars), &without);
    let bound = effect(&without, "Mars-light").bound.unwrap().most();
    assert!(error > 1e-3 && error <= bound, "Mars-light: {error} {bound}");

    let mut warm = plain.clone();
    warm.models.thermal = Thermal::Equilibrium;
    let warm_seen = observed(&warm);
    let change = largest_change(&warm_seen, &without);
    assert!(change > 0.5, "{change}");
    // What was left out is also what a shadow that is no cooler than sunlit ground would send.
    let bound = of_median(&warm_seen, "thermal inertia");
    assert!(change <= bound, "thermal inertia: {change} {bound}");

    let mut heated = warm.clone();
    heated.sky.mars = with_mars.sky.mars.clone();
    let error = largest_error(&observed(&heated), &warm_seen);
    let bound = |name: &str| effect(&warm_seen, name).bound.unwrap().most();
    let bound = bound("heat from Mars") + bound("Mars-light");
    assert!(error > 1e-3 && error <= bound, "heat: {error} {bound}");
}

#[test]
fn what_no_band_has_changes_nothing() {
    let mut warm = scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 24));
    warm.models.thermal = Thermal::Equilibrium;
    let with = |light: Light| {
        let mut scene = warm.clone();
        scene.exposure.bands = vec![Band { light, ..Band::new(3.6, None) }];
        observed(&scene)
    };
    let (sunlight, heat) = (with(Light::Sunlight), with(Light::Heat));
    for name in ["thermal emission", "thermal inertia", "heat from Mars"] {
        assert_eq!(effect(&sunlight, name).bound, Some(Bound::NOTHING));
        assert_eq!(effect(&sunlight, name).decision, Decision::Dropped);
        assert!(of_median(&heat, name) > 0.0, "{name}");
    }
    for name in ["sunlight", "Mars-light"] {
        assert_eq!(effect(&heat, name).bound, Some(Bound::NOTHING));
        assert_eq!(effect(&heat, name).decision, Decision::Dropped);
        assert!(of_median(&sunlight, name) > 0.0, "{name}");
    }
}

#[test]
fn the_bound_of_thermal_inertia_knows_that_noon_was_warmer() {
    // Level ground just before sunset. Ground with a thermal inertia of 50 J m-2 K-1 s-1/2 is then at 200.263 K at the equator
    // of Phobos, 1.523679 au from the Sun (A 0.03, eps 0.95; periodic solution by harmonic balance, computed independently).
    let mut dusk = scene(grid(50.0, 60, |_, _| 0.0), sun(89.0, 10.0), nadir(1e4, 80.0, 8));
    dusk.models.thermal = Thermal::Equilibrium;
    let dusk = observed(&dusk);
    // Emission of that, less that in equilibrium with sunlight at 89 deg.
    let normal = 0.93 * 1366.1 / 1.5237_f64.powi(2);
    let equilibrium_k = mmxrt::physics::heat::equilibrium_temperature_k(normal * 89f64.to_radians().cos(), 0.95);
    let black = |t_k| mmxrt::physics::blackbody::radiance_w_m2_sr_um(3.6, t_k);
    let missing = 0.93 * (black(200.263) - black(equilibrium_k));
    let change = missing / median_sunlit(&dusk, 1);
    let bound = of_median(&dusk, "thermal inertia");
    assert!(change > 0.1 && change <= bound, "{change} {bound}");
}

#[test]
fn aberration_moves_shadows_by_no_more_than_its_bound() {
    // The edge of a box's shadow falls 6 m below it: 29 km/s turn the Sun by 1e-4 rad, and move the edge by 5 mm.
    let ground = joined(&[plane(60.0, 0.0), cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, 6.0])]);
    let camera = camera([0.0, 0.0, 1e4], [-15.0, 0.0, 0.0], [0.0, 1.0, 0.0], 48, 0.5 / 1e4);
    let geometric = observed(&scene(ground.clone(), sun(70.0, 0.0), camera.clone()));
    let apparent = observed(&scene(ground, sun(70.0 + 9.5e-5_f64.to_degrees(), 0.0), camera));
    let change = largest_change(&geometric, &apparent);
    let bound = of_median(&geometric, "aberration and light time");
    assert!(change > 0.005 && change <= bound, "{change} {bound}");
}

#[test]
fn surroundings_that_glow_stay_below_the_bound_of_interreflection() {
    // The floor of a valley with walls of 30 deg sees them under a form factor of 1 - cos(60 deg / 2 + 30 deg): those of two half
    // planes, 1 - cos(30 deg). At 3.6 um walls at 310 K outshine the sunlight that they reflect.
    let valley = grid(50.0, 60, |x, _| (x.abs() - 10.0).max(0.0) * 30f64.to_radians().tan());
    let mut valley = scene(valley, sun(10.0, 90.0), nadir(1e4, 80.0, 24));
    valley.models.thermal = Thermal::Equilibrium;
    let seen = observed(&valley);
    let form_factor = 1.0 - 30f64.to_radians().cos();
    let walls = mmxrt::physics::blackbody::radiance_w_m2_sr_um(3.6, 310.0) * 0.93;
    let missing = 0.07 * form_factor * walls;
    let error = missing / (median_sunlit(&seen, 1) + missing);
    for name in ["light and heat between facets", "heat of neighbours as light"] {
        let bound = effect(&seen, name).bound.unwrap().lit;
        assert!(error > 4e-3 && error <= bound, "{name}: {error} {bound}");
    }
}

#[test]
fn the_suns_disc_changes_no_more_than_its_bound() {
    // A box 6 m high on a plane, pixels of 0.5 m, the Sun 70 deg from the zenith: penumbrae of a few decimetres.
    let ground = joined(&[plane(60.0, 0.0), cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, 6.0])]);
    let camera = camera([0.0, 0.0, 1e4], [-5.0, 0.0, 0.0], [0.0, 1.0, 0.0], 48, 0.5 / 1e4);
    let towards = sun(70.0, 0.0);
    let point = observed(&scene(ground.clone(), towards, camera.clone()));
    let radius_rad = mmxrt::physics::sun::angular_radius_rad(1.5237 * mmxrt::units::AU_M);
    let (h, v) = towards.frame();
    // The mean over directions on the disc, of equal shares of its area.
    let count = 24;
    let mut mean = vec![0.0; 48 * 48];
    for i in 0..count {
        let r = radius_rad * ((f64::from(i) + 0.5) / f64::from(count)).sqrt();
        let a = 2.399_963_229_728_653 * f64::from(i);
        let there = Direction::new(towards.vec() + r * (a.cos() * h + a.sin() * v)).unwrap();
        let seen = observed(&scene(ground.clone(), there, camera.clone()));
        mean.iter_mut().zip(seen.cube.band(0)).for_each(|(m, l)| *m += l / f64::from(count));
    }
    let reference = median_sunlit(&point, 0);
    let change = point.cube.band(0).iter().zip(&mean).map(|(a, b)| (a - b).abs() / reference).fold(0.0, f64::max);
    let bound = of_median(&point, "the Sun's disc");
    assert!(change > 0.01 && change <= bound, "{change} {bound}");

    // Flat ground along the rays: 6.476840338e-4 of the Sun at 1.523679 au (closed form of a disc cut by the horizon, 40 digits).
    let level = observed(&scene(plane(60.0, 0.0), sun(89.999, 0.0), nadir(1e4, 60.0, 8)));
    // All of it is as bright as the median.
    let bound = effect(&level, "the Sun's disc").bound.unwrap().lit;
    let cos = 89.999f64.to_radians().cos();
    assert!((6.47e-4 - cos) / cos <= bound && bound < 7e-4 / cos, "{bound}");
}

#[test]
fn a_black_scene_is_a_result_and_says_so() {
    let flat = || grid(50.0, 60, |_, _| 0.0);
    let black = observed(&scene(flat(), sun(95.0, 10.0), nadir(1e4, 80.0, 8)));
    assert!(warned(&black, "nothing is lit") && warned(&black, "the image is black"), "{:?}", black.warnings);
    assert!(black.cube.band(0).iter().all(|l| *l == 0.0));
    assert!(black.counts.visible_facets > 100 && black.counts.lit_facets == 0);
    assert_eq!(effect(&black, "Mars-light").bound, None);
    let mut warm = scene(flat(), sun(95.0, 10.0), nadir(1e4, 80.0, 8));
    warm.models.thermal = Thermal::Equilibrium;
    // Without a source nothing is warm.
    assert!(warned(&observed(&warm), "the image is black"));
    warm.sky.mars = Some(mars([0.0, 0.0, 1.0]));
    assert!(warned(&observed(&warm), "Mars-light and heat"));
}

#[test]
fn an_empty_image_says_so() {
    let away = camera([0.0, 0.0, 100.0], [0.0, 500.0, 100.0], [0.0, 0.0, 1.0], 8, 1e-3);
    let empty = observed(&scene(plane(10.0, 0.0), sun(30.0, 0.0), away));
    assert!(warned(&empty, "nothing is in view"), "{:?}", empty.warnings);
    assert_eq!(empty.counts.visible_facets, 0);
    let full = observed(&scene(plane(10.0, 0.0), sun(30.0, 0.0), nadir(1000.0, 10.0, 8)));
    assert!(full.warnings.is_empty(), "{:?}", full.warnings);
}

#[test]
fn a_site_in_eclipse_says_so() {
    // Mars has a radius of 21.2 deg, the Sun one of 0.175 deg.
    let towards = sun(30.0, 0.0);
    for (off_deg, words) in [(0.0, "is in eclipse"), (20.9, "is in eclipse"), (21.2, "in partial eclipse"), (21.5, "")]
    {
        let mut site = scene(plane(10.0, 0.0), towards, nadir(1000.0, 10.0, 8));
        site.sky.mars = Some(mars(sun(30.0 + off_deg, 0.0).vec().to_array()));
        let seen = observed(&site);
        let expected = usize::from(!words.is_empty());
        assert_eq!(seen.warnings.iter().filter(|w| w.contains("eclipse") && w.contains(words)).count(), expected);
        // In what is left of the light any error may be as large.
        let bound = effect(&seen, "eclipses").bound;
        assert_eq!(bound, if expected > 0 { None } else { Some(Bound::NOTHING) }, "{off_deg}");
    }
}

#[test]
fn flaws_of_a_mesh_are_counted() {
    let mut mesh = hills();
    mesh.facets[100].swap(0, 1);
    mesh.facets.push([0, 0, 1]);
    mesh.material.push(mesh.material[0]);
    let seen = observed(&scene(mesh, sun(20.0, 0.0), nadir(1e4, 80.0, 8)));
    assert!(warned(&seen, "1 facet turned inside out"), "{:?}", seen.warnings);
    assert!(warned(&seen, "1 facet without area"), "{:?}", seen.warnings);
    let mut ball = sphere([0.0; 3], 10.0, 2);
    ball.facets.pop();
    ball.material.pop();
    let seen = observed(&scene(ball, sun(20.0, 0.0), nadir(1000.0, 25.0, 8)));
    assert!(warned(&seen, "not closed: 3 open edges"), "{:?}", seen.warnings);
}

#[test]
fn terrain_outside_a_site_may_shadow_it_under_a_low_sun() {
    let low = observed(&scene(hills(), sun(85.0, 10.0), nadir(1e4, 80.0, 8)));
    assert!(warned(&low, "might be shadowed by terrain outside"), "{:?}", low.warnings);
    assert!(of_median(&low, "terrain outside the mesh") > 1.0);
    let high = observed(&scene(hills(), sun(1.0, 10.0), nadir(1e4, 80.0, 8)));
    assert!(effect(&high, "terrain outside the mesh").bound.is_some());
    let body = observed(&scene(sphere([0.0; 3], 10.0, 2), sun(85.0, 10.0), nadir(1000.0, 25.0, 8)));
    assert_eq!(effect(&body, "terrain outside the mesh").bound, Some(Bound::NOTHING));
}

#[test]
fn one_table_serves_all_cameras_and_bands_and_no_other_scene() {
    let base = {
        let mut base = scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 8));
        base.sky.mars = Some(mars([0.0, 1.0, 1.0]));
        base.models.thermal = Thermal::Equilibrium;
        base
    };
    let id = table_id(&base.clone().check().unwrap());
    assert_eq!(id.len(), 64);
    let changed = |change: &dyn Fn(&mut SceneParts)| {
        let mut other = base.clone();
        change(&mut other);
        table_id(&other.check().unwrap())
    };
    let same: [&dyn Fn(&mut SceneParts); 4] = [
        &|s| s.exposure.camera = nadir(2e4, 10.0, 64),
        &|s| s.exposure.bands.truncate(1),
        &|s| s.surface.materials[0].reflectance = Spectrum::constant(0.2),
        &|s| s.sky.sun.irradiance_1au = Spectrum::constant(1.0),
    ];
    for (i, change) in same.into_iter().enumerate() {
        assert_eq!(changed(change), id, "{i}");
    }
    let other: [&dyn Fn(&mut SceneParts); 11] = [
        &|s| s.surface.origin_m.z += 1.0,
        &|s| s.surface.mesh.vertices_m[7].z += 1e-9,
        &|s| s.surface.mesh.facets.swap(3, 4),
        &|s| s.sky.sun.direction = sun(40.0, 10.1),
        &|s| s.sky.sun.distance_m *= 1.01,
        &|s| s.sky.sun.total_irradiance_1au_w_m2 = 1361.0,
        &|s| s.sky.mars = None,
        &|s| s.models.mars_light = MarsModel::Thesis,
        &|s| s.sky.mars.iter_mut().for_each(|m| m.thermal_exitance_w_m2 = 0.0),
        &|s| s.models.thermal = Thermal::Off,
        &|s| s.surface.materials[0].bond_albedo = 0.02,
    ];
    let mut ids: Vec<String> = other.into_iter().map(changed).collect();
    ids.push(id);
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), 12);
}

#[test]
fn a_table_of_another_mesh_is_refused() {
    let one = scene(hills(), sun(40.0, 10.0), nadir(1e4, 80.0, 8)).check().unwrap();
    let (table, _) = simulate(&one, &unwatched).unwrap();
    let other = scene(plane(50.0, 0.0), sun(40.0, 10.0), nadir(1e4, 80.0, 8)).check().unwrap();
    let error = mmxrt::study::observe(&other, &table, Wanted::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("has 7200 values, but the scene needs 2"), "{error}");
}

/// Else the image would lack what the report says is in it.
#[test]
fn a_table_without_what_the_scene_asks_for_is_refused() {
    let mut one = scene(plane(50.0, 0.0), sun(40.0, 10.0), nadir(1e4, 80.0, 8));
    one.models.thermal = Thermal::Equilibrium;
    let one = one.check().unwrap();
    let (whole, _) = simulate(&one, &unwatched).unwrap();
    let observe = |table| mmxrt::study::observe(&one, &table, Wanted::default(), &unwatched).map(drop);
    observe(whole.clone()).unwrap();
    let cold = FacetTable { temperature_lit_k: vec![], temperature_shaded_k: vec![], ..whole.clone() };
    assert!(observe(cold).unwrap_err().to_string().contains("temperature_lit_k: has 0 values, but the scene needs 2"));
    let mut turned = whole;
    turned.sources[0].field = DirectionField::Afar(sun(40.001, 10.0));
    assert!(observe(turned).unwrap_err().to_string().contains("sun_direction: is 1.000e-3 deg"));
}

/// Mars is beyond what the camera looks at, to the right of it and below by as much.
#[test]
fn the_report_says_where_mars_is_in_the_image() {
    let scratch = Scratch::new();
    scratch.write("ground.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl grey\nf 1 2 3 4\n");
    let scene = "mmxrt_scene = 1\norigin_m = [12000.0, 0.0, 0.0]\n[[mesh]]\nfile = \"ground.obj\"\npose = \"radial\"\n\
        [materials]\ngrey = { reflectance = 0.07 }\n[sun]\ndirection = [0.6, 0.8, 0.0]\ndistance_au = 1.5\n[mars]\nposition_m = [12000.0, 9.0e6, -9.0e6]\n\
        [thermal]\nmodel = \"off\"\n[observer]\nposition_m = [13000.0, 0.0, 0.0]\ntarget_m = [12000.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]\n\
        [sensor]\nsamples = 4\nlines = 4\nifov_mrad = 1.0\nbands = { centres_um = [1.0] }\n";
    scratch.write("scene.toml", scene);
    for (set, mars) in [("sensor.lines=4", Some(135.0)), ("mars=", None)] {
        let out = scratch.argument(set);
        let (code, _, error) =
            run(&["simulate", &scratch.argument("scene.toml"), "-o", &out, "--model", "sunlight", "--set", set]);
        assert_eq!(code, 0, "{error}");
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(scratch.join(set).join("report.json")).unwrap()).unwrap();
        let orientation = &report["orientation"];
        assert_eq!((orientation["north_deg"].as_f64(), orientation["sun_deg"].as_f64()), (Some(0.0), Some(90.0)));
        let found = orientation["mars_deg"].as_f64();
        assert_eq!(found.is_some(), mars.is_some(), "{orientation}");
        assert!((found.unwrap_or_default() - mars.unwrap_or_default()).abs() < 1e-9, "{orientation}");
    }
}
