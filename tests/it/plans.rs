//! A plan drops no more than its tolerance allows: bounds hold on random scenes, and are worth something.

use glam::DVec3;
use mmxrt::geometry::{MaterialId, Texels};
use mmxrt::physics::reflectance::albedo::Measure;
use mmxrt::physics::reflectance::{PhaseFunction, Preset, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Beam, Globe, Model, Models, Photometry, Scene, SceneParts, Texture, TextureKind, Thermal};
use mmxrt::spectral::{Band, Extend, Spectrum, solar_e490};
use mmxrt::study::{self, Bound, Choice, Decision, Effect, Extremes, Observation, Plan, Request};
use mmxrt::units::AU_M;

use crate::scenes::{self, lambert};
use crate::scratch::is_heavy;
use crate::shapes::*;

/// A site of two materials: relief, sometimes with a boulder, under a random Sun and Mars, in random bands.
pub(crate) fn random_scene(seed: u64) -> SceneParts {
    let mut random = Random(seed);
    let mut uniform = |from: f64, to: f64| from + (to - from) * random.share();
    let steep = uniform(0.0, 0.6);
    let waves: Vec<[f64; 4]> =
        (0..5).map(|_| [uniform(-0.4, 0.4), uniform(-0.4, 0.4), uniform(0.0, 6.3), uniform(0.0, 1.0)]).collect();
    let height = |x: f64, y: f64| -> f64 {
        let wave = |[a, b, phase, amplitude]: &[f64; 4]| amplitude * (a * x + b * y + phase).sin() / a.hypot(*b);
        steep * waves.iter().map(wave).sum::<f64>() / 5.0
    };
    let ground = grid(50.0, 16, height);
    let mesh = match uniform(0.0, 1.0) < 0.4 {
        true => joined(&[ground, of_material(sphere([5.0, -3.0, height(5.0, -3.0)], uniform(2.0, 9.0), 4), 1)]),
        false => ground,
    };
    let towards = sun(uniform(0.0, 88.0), uniform(0.0, 360.0));
    let (from, at) = ([uniform(-6e3, 6e3), uniform(-6e3, 6e3), 1e4], [0.0, 0.0, 0.0]);
    let camera = camera(from, at, [0.0, 1.0, 0.0], 20, 90.0 / 20.0 / 1e4);
    let mut parts = scenes::parts(mesh, camera, towards);
    let spectrum = |low: f64, high: f64| Spectrum::new(vec![0.5, 5.0], vec![low, high], Extend::Error).unwrap();
    let reflectances = [0, 1].map(|_| spectrum(uniform(0.03, 0.3), uniform(0.03, 0.3)));
    parts.surface.materials =
        vec![lambert(0, "ground", reflectances[0].clone()), lambert(1, "rock", reflectances[1].clone())];
    if uniform(0.0, 1.0) < 0.1 {
        let reflectance = spectrum(0.02, 0.04);
        let model = Model::measured(Preset::PhobosAssumed.known().shape.unwrap(), &reflectance, &Measure::Spherical);
        parts.surface.materials[0].photometry = Photometry::Model(Box::new(model.unwrap()));
        parts.surface.materials[0].reflectance = reflectance;
    }
    let sun = &mut parts.sky.sun;
    (sun.distance_m, sun.irradiance_1au, sun.total_irradiance_1au_w_m2) =
        (uniform(1.38, 1.67) * AU_M, solar_e490().clone(), 1366.1);
    if uniform(0.0, 1.0) < 0.8 {
        let towards = direction([uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-0.5, 1.0)]);
        parts.sky.mars = Some(scenes::mars(9_376_000.0 * towards.vec()));
    }
    let sets: [&[f64]; 7] = [&[1.0], &[1.0, 1.5], &[1.7], &[2.0], &[2.4], &[1.0, 3.0], &[3.6]];
    let bands = sets[(uniform(0.0, 7.0) as usize).min(6)];
    parts.exposure.bands = bands.iter().map(|um| Band::new(*um, None)).collect();
    if uniform(0.0, 1.0) < 0.5 {
        let towards = direction([uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-0.5, 1.0)]).vec();
        let (distance_m, sin_radius) = (10f64.powf(uniform(6.0, 11.0)), 10f64.powf(uniform(-3.5, -0.3)));
        let moon = scenes::mars(distance_m * towards);
        let moon = Globe { name: "moon".into(), radius_m: sin_radius * distance_m, ..moon };
        parts.sky.bodies = vec![moon];
    }
    parts.models.thermal = Thermal::Equilibrium;
    parts
}

/// With light between facets, which takes by far the longest, where it is wanted.
pub(crate) fn planned(scene: &Scene, choice: Choice, tolerance: f64, exchanges: bool) -> (Scene, Plan) {
    let extremes = Extremes::with_shadows(scene, &unwatched).unwrap().with_draft(scene, &unwatched).unwrap();
    let (models, plan) = study::plan(scene, &extremes, &Request { choice, tolerance }).unwrap();
    let models = Models { exchange: models.exchange.filter(|_| exchanges), ..models };
    (scene.by(models).unwrap(), plan)
}

pub(crate) fn seen(scene: &Scene) -> Observation {
    study::simulate(scene, &unwatched).unwrap().1
}

/// Errors of pixels relative to a truth: the largest over bands, of pixels that show nothing but sunlit ground, and of the others.
fn errors(truth: &Observation, other: &Observation) -> [Vec<f64>; 2] {
    errors_beyond(truth, other, 0.0)
}

/// The same, of what is beyond a share of the median sunlit radiance.
fn errors_beyond(truth: &Observation, other: &Observation, spared: f64) -> [Vec<f64>; 2] {
    let plane = |name: &str| &truth.backplanes.plane(name).unwrap().values;
    let (lit, coverage) = (plane("LIT_FRACTION"), plane("COVERAGE"));
    let mut errors = vec![0.0_f64; lit.len()];
    for band in 0..truth.cube.axes.bands.len() {
        let (truth, other) = (truth.cube.band(band), other.cube.band(band));
        // Of the surface: a pixel that shows some of it only is darker.
        let surface = truth.iter().zip(coverage).map(|(radiance, coverage)| radiance / coverage);
        let mut sunlit: Vec<f64> = surface.zip(lit).filter(|(_, lit)| **lit > 0.5).map(|(l, _)| l).collect();
        sunlit.sort_by(f64::total_cmp);
        let median = sunlit[sunlit.len() / 2];
        let pixels = errors.iter_mut().zip(truth.iter().zip(&other));
        pixels.for_each(|(error, (truth, other))| {
            let change = ((truth - other).abs() - spared * median).max(0.0);
            *error = error.max(change / truth.max(0.01 * median));
        });
    }
    let is_whole = |pixel: usize| lit[pixel] > 1.0 - 1e-9;
    let of = |is_lit: bool| (0..errors.len()).filter(|i| is_whole(*i) == is_lit).map(|i| errors[i]).collect();
    [of(true), of(false)]
}

fn most(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

pub(crate) fn effect<'p>(plan: &'p Plan, key: &str) -> &'p Effect {
    plan.effects.iter().find(|effect| effect.key == key).unwrap()
}

/// Effects that can be taken out of `full`.
fn switches(plan: &Plan) -> Vec<String> {
    let can = |effect: &&Effect| effect.cost_s.is_some() && effect.decision == Decision::Kept;
    plan.effects.iter().filter(can).map(|effect| effect.key.clone()).collect()
}

/// The same with what other scenes have: models of several kinds, black and bright texels, lamps with lines, spectra with features between bands.
fn scene_of_all_kinds(seed: u64) -> SceneParts {
    let mut parts = random_scene(seed);
    let mut random = Random(!seed);
    let mut uniform = |from: f64, to: f64| from + (to - from) * random.share();
    // Dips 0.2 % wide, in bands that are as close to one another.
    if uniform(0.0, 1.0) < 0.3 {
        let um = parts.exposure.bands[0].centre_um;
        let dip = uniform(0.1, 1.0);
        parts.exposure.bands.extend([0.998, 1.002, 1.02].map(|times| Band::new(times * um, None)));
        parts.exposure.bands.sort_by(|a, b| a.centre_um.total_cmp(&b.centre_um));
        let narrow = |reflectance: &Spectrum| {
            let at = |um: f64| reflectance.at(um).unwrap();
            let ums = [0.5, um * 0.997, um * 0.998, um * 0.999, 5.0];
            let values = [at(0.5), at(ums[1]), dip * at(ums[2]), at(ums[3]), at(5.0)];
            Spectrum::new(ums.to_vec(), values.to_vec(), Extend::Error).unwrap()
        };
        let [ground, rock] = [0, 1].map(|i| narrow(&parts.surface.materials[i].reflectance));
        let photometry = [0, 1].map(|i| parts.surface.materials[i].photometry.clone());
        parts.surface.materials = vec![lambert(0, "ground", ground), lambert(1, "rock", rock)];
        if photometry.iter().all(|photometry| *photometry == Photometry::Lambert) {
            parts.surface.materials.iter_mut().zip(photometry).for_each(|(m, photometry)| m.photometry = photometry);
        }
    }
    // Wide bands, whose ends reach far.
    if uniform(0.0, 1.0) < 0.3 {
        let wide = |band: &Band| Band::new(band.centre_um, Some(0.15 * band.centre_um));
        parts.exposure.bands = parts.exposure.bands.iter().map(wide).collect();
    }
    if uniform(0.0, 1.0) < 0.5 {
        let preset = Preset::PhobosAssumed.known().shape.unwrap();
        let shapes = [
            Shape::Minnaert(uniform(0.5, 0.9)),
            Shape::LommelSeeliger(PhaseFunction::Isotropic),
            Shape::Rpv { exponent: uniform(0.6, 0.95), asymmetry: uniform(-0.3, 0.1), hot_spot: uniform(0.5, 1.0) },
            preset,
        ];
        for material in &mut parts.surface.materials {
            let shape = shapes[(uniform(0.0, 4.0) as usize).min(3)];
            // Not more than such a surface can reflect.
            material.reflectance = material.reflectance.map(|r| 0.3 * r);
            let model = Model::measured(shape, &material.reflectance, &Measure::Spherical);
            material.photometry = Photometry::Model(Box::new(model.unwrap()));
        }
    }
    if uniform(0.0, 1.0) < 0.4 {
        let mesh = &parts.surface.mesh;
        let texel = |f: usize| mesh.facet(f).corners_m.map(|p| [(p.x + 60.0) / 15.0, (60.0 - p.y) / 15.0]);
        parts.surface.textures = vec![Texture {
            material: MaterialId(0),
            kind: TextureKind::Factor,
            corners: (0..mesh.facets.len()).map(texel).collect(),
            rows: 8,
            columns: 8,
            wavelength_um: vec![],
            values: (0..64).map(|_| if uniform(0.0, 1.0) < 0.1 { 0.0 } else { uniform(0.1, 1.0) }).collect(),
            texels: Texels::Nearest,
            lon_lat: None,
        }];
    }
    if uniform(0.0, 1.0) < 0.4 {
        let um = parts.exposure.bands[0].centre_um;
        let level = 10f64.powf(uniform(-3.0, 2.5));
        let line =
            Spectrum::new(vec![0.5, 0.999 * um, um, 1.001 * um, 5.0], vec![0.0, 0.0, level, 0.0, 0.0], Extend::Error);
        let lamp = |k: usize, irradiance: Spectrum| Beam {
            name: format!("lamp-{k}"),
            direction: direction([0.3 - k as f64, 0.4, 0.6]),
            irradiance,
            total_irradiance_w_m2: level,
        };
        parts.sky.beams = vec![lamp(0, line.unwrap()), lamp(1, Spectrum::constant(0.3 * level))];
    }
    parts
}

/// Boxes beside each other on the ground, dark or bright, under a low Mars that some sides see, and others only what those pass on.
fn boxes(seed: u64) -> SceneParts {
    let mut random = Random(seed ^ 0xb0c5);
    let mut uniform = |from: f64, to: f64| from + (to - from) * random.share();
    let mesh = joined(&[
        quad([-40.0, -40.0, 0.0], [40.0, -40.0, 0.0], [40.0, 40.0, 0.0], [-40.0, 40.0, 0.0]),
        cuboid([-12.0, -10.0, -1.0], [-4.0, 10.0, uniform(4.0, 12.0)]),
        cuboid([2.0, -10.0, -1.0], [10.0, 10.0, uniform(4.0, 12.0)]),
    ]);
    let towards = sun(uniform(20.0, 85.0), uniform(0.0, 360.0));
    let camera =
        camera([uniform(-6e3, 6e3), uniform(-6e3, 6e3), 1e4], [0.0; 3], [0.0, 1.0, 0.0], 20, 60.0 / 20.0 / 1e4);
    let mut parts = scenes::parts(mesh, camera, towards);
    let albedo = if uniform(0.0, 1.0) < 0.5 { 0.05 } else { 0.9 };
    parts.surface.materials = vec![lambert(0, "ground", Spectrum::constant(albedo))];
    let distance_m = if uniform(0.0, 1.0) < 0.5 { 9_376_000.0 } else { 3e7 };
    let mars = direction([uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-0.1, 0.3)]);
    parts.sky.mars = Some(scenes::mars(distance_m * mars.vec()));
    let um = [0.6, 2.4, 3.6, 5.0][(uniform(0.0, 4.0) as usize).min(3)];
    parts.exposure.bands = vec![Band::new(um, None)];
    parts.models.thermal = Thermal::Equilibrium;
    parts
}

/// What was found of some scenes.
#[derive(Default)]
struct Found {
    scenes: usize,
    dropped: usize,
    /// Bounds over what they bound, and of what.
    looseness: Vec<(f64, String)>,
}

/// Takes each effect out of scenes by itself, and plans them.
fn judge(seeds: std::ops::Range<u64>, of: impl Fn(u64) -> SceneParts, exchanges: impl Fn(u64) -> bool) -> Found {
    let mut found = Found::default();
    for seed in seeds {
        let scene = of(seed).check().unwrap();
        let exchanges = exchanges(seed);
        let (full, plan_of_full) = planned(&scene, Choice::Full, 1e-3, exchanges);
        let truth = seen(&full);
        let lit = &truth.backplanes.plane("LIT_FRACTION").unwrap().values;
        // In an eclipse there is no sunlight that errors could be relative to.
        let eclipse = effect(&plan_of_full, "eclipse");
        let is_dark = eclipse.decision == Decision::Kept && eclipse.bound.is_none();
        if is_dark || lit.iter().filter(|lit| **lit > 0.5).count() < 30 {
            continue;
        }
        found.scenes += 1;
        // Without each effect by itself.
        let keys = switches(&plan_of_full);
        for key in keys.iter().filter(|key| exchanges || *key != "interreflection") {
            let others = keys.iter().filter(|other| *other != key).cloned().collect();
            let (without, _) = planned(&scene, Choice::Only(others), 1e-3, exchanges);
            let without_it = seen(&without);
            let [in_sun, in_shade] = errors(&truth, &without_it).map(|errors| most(&errors));
            // The fewer effects share the tolerance, the more bodies each share is enough to leave out.
            let other_bodies = key != "bodies" && without.models.bodies != full.models.bodies;
            let of_bodies = effect(&plan_of_full, "bodies").bound.filter(|_| other_bodies);
            // What has no bound is kept.
            let Some(bound) = effect(&plan_of_full, key).bound else { continue };
            let bound = bound.and(&of_bodies.unwrap_or(Bound::NOTHING));
            assert!(in_sun <= bound.lit, "{seed} {key}: {in_sun} {bound:?}");
            assert!(in_shade <= bound.shadow, "{seed} {key}: {in_shade} {bound:?}");
            // And beside the result: of what it lacks, and of what it has.
            for (seen, whose) in [(&truth, "full"), (&without_it, "without")] {
                let of_result = seen.effects.iter().find(|effect| effect.key == *key).and_then(|effect| effect.bound);
                let of_result =
                    of_result.map_or(Bound { lit: 1e9, shadow: 1e9 }, |b| b.and(&of_bodies.unwrap_or(Bound::NOTHING)));
                assert!(in_sun <= of_result.lit * (1.0 + 1e-9), "{seed} {key} {whose}: {in_sun} {of_result:?}");
                assert!(in_shade <= of_result.shadow * (1.0 + 1e-9), "{seed} {key} {whose}: {in_shade} {of_result:?}");
            }
            for (change, bound, side) in [(in_sun, bound.lit, "lit"), (in_shade, bound.shadow, "shadow")] {
                if change > 1e-9 {
                    found.looseness.push((bound / change, format!("{key}, {side}")));
                }
            }
        }
        for tolerance in [1e-3, 3e-2] {
            let (auto, plan) = planned(&scene, Choice::Auto, tolerance, exchanges);
            // The Sun's disc has a tolerance of its own, over the median sunlit radiance, at the edges of shadows.
            let at_edges = effect(&plan, "sun-disc").own.as_ref().map_or(0.0, |own| own.left);
            let seen = seen(&auto);
            let [in_sun, at_edges] = [0.0, at_edges].map(|spared| errors_beyond(&truth, &seen, spared));
            let error = [most(&in_sun[0]), most(&at_edges[1])];
            // Light between facets has a tolerance of its own.
            let own = if exchanges { 0.03 } else { 0.0 };
            assert!(error.iter().all(|error| *error <= tolerance + own), "{seed}: {error:?} {tolerance}");
            assert!(plan.dropped.is_some_and(|dropped| dropped.most() <= tolerance), "{seed}: {plan:?}");
            found.dropped += switches(&plan_of_full).len() - switches(&plan).len();
        }
    }
    found
}

#[test]
fn bounds_hold_on_random_scenes_and_the_plan_keeps_its_tolerance() {
    let Found { scenes, dropped, looseness } = judge(0..60, random_scene, |seed| seed % 20 == 0);
    assert!(scenes >= 50 && dropped >= 10, "{scenes} {dropped}");
    // A bound that keeps everything is worth nothing.
    let median = |key: &str| {
        let mut of: Vec<f64> = looseness.iter().filter(|(_, of)| of == key).map(|(times, _)| *times).collect();
        of.sort_by(f64::total_cmp);
        assert!(!of.is_empty(), "{key}");
        of[of.len() / 2]
    };
    let keys = ["heat", "mars-light", "mars-glow", "mars-shadows", "sun-disc", "interreflection"];
    let medians: Vec<(String, f64)> = keys
        .iter()
        .flat_map(|key| [format!("{key}, lit"), format!("{key}, shadow")])
        .map(|key| (key.clone(), median(&key)))
        .collect();
    println!("{scenes} scenes, {dropped} dropped; bound over truth, median: {medians:?}");
    // Where shadows may be anywhere, and scenes have few, bounds are far above the truth.
    for key in ["heat, lit", "mars-light, lit", "mars-glow, lit", "interreflection, lit"] {
        assert!(medians.iter().any(|(of, times)| of == key && *times <= 10.0), "{medians:?}");
    }
}

#[test]
fn bounds_hold_on_scenes_of_all_kinds() {
    // Heavy: `MMXRT_HEAVY=1`.
    let count = if is_heavy() { 150 } else { 15 };
    let Found { scenes, dropped, .. } = judge(100..100 + count, scene_of_all_kinds, |seed| seed % 20 == 0);
    assert!(5 * scenes as u64 >= 4 * count && dropped >= 10, "{scenes} {dropped}");
}

#[test]
fn what_a_source_does_by_way_of_others_is_in_its_bound() {
    let Found { scenes, .. } = judge(0..if is_heavy() { 100 } else { 8 }, boxes, |_| true);
    assert!(scenes >= 5, "{scenes}");
}

#[test]
fn a_plan_leaves_out_what_cannot_matter() {
    // Heat at 1 um: at 330 K, 1e-9 of sunlight. Mars below the horizon of a plain.
    let mut parts = scenes::parts(plane(60.0, 0.0), nadir(1e4, 80.0, 8), sun(40.0, 10.0));
    parts.sky.mars = Some(scenes::mars(DVec3::new(0.0, 0.0, -9_376_000.0)));
    parts.models.thermal = Thermal::Equilibrium;
    let scene = parts.check().unwrap();
    let (auto, plan) = planned(&scene, Choice::Auto, 1e-3, true);
    assert_eq!(auto.models.thermal, Thermal::Off);
    assert_eq!(effect(&plan, "heat").decision, Decision::Dropped);
    assert_eq!(effect(&plan, "mars-light").bound.unwrap().most(), 0.0);
    assert!(plan.keeps_tolerance() && plan.dropped.unwrap().most() < 1e-3);
    // All of it, if that is wanted.
    let (full, plan) = planned(&scene, Choice::Full, 1e-3, true);
    assert_eq!(full.models.thermal, Thermal::Equilibrium);
    assert_eq!(effect(&plan, "heat").decision, Decision::Kept);
    // A choice that the scene has made itself stands.
    let mut parts = scene.into_parts();
    parts.models.thermal = Thermal::Off;
    let (full, plan) = planned(&parts.check().unwrap(), Choice::Full, 1e-3, true);
    assert_eq!(full.models.thermal, Thermal::Off);
    assert_eq!(effect(&plan, "heat").decision, Decision::Dropped);
}

#[test]
fn a_body_that_bulges_everywhere_has_no_surroundings() {
    let bound = |mesh: mmxrt::geometry::Mesh| {
        let scene = scenes::parts(mesh, nadir(1e4, 80.0, 8), sun(40.0, 10.0)).check().unwrap();
        let (_, plan) = planned(&scene, Choice::Auto, 1e-3, true);
        effect(&plan, "interreflection").bound.unwrap().most()
    };
    // Planar facets of a box, a sphere; pressed flat; far from the origin.
    let ball = || sphere([0.0, 0.0, 0.0], 30.0, 3);
    let moved = |mut mesh: mmxrt::geometry::Mesh, at: DVec3, by: DVec3| {
        mesh.vertices_m.iter_mut().for_each(|v| *v = *v * by + at);
        mesh
    };
    for mesh in [
        cuboid([-9.0, -9.0, -9.0], [9.0, 9.0, 9.0]),
        ball(),
        moved(ball(), DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-3)),
        moved(ball(), DVec3::new(30.0, -20.0, -100.0), DVec3::ONE),
    ] {
        assert_eq!(bound(mesh), 0.0);
    }
    // A dent; a body beside another one; an open one.
    let mut dented = ball();
    dented.vertices_m[100] *= 0.9;
    let two = joined(&[ball(), cuboid([40.0, -9.0, -9.0], [50.0, 9.0, 9.0])]);
    let mut open = ball();
    open.facets.pop();
    open.material.pop();
    for mesh in [dented, two, open] {
        assert!(bound(mesh) > 1e-3);
    }
}

#[test]
fn choices_are_named_by_their_keys() {
    assert_eq!(Choice::parse("auto"), Ok(Choice::Auto));
    assert_eq!(Choice::parse("sunlight, heat,heat"), Ok(Choice::Only(vec!["sunlight".into(), "heat".into()])));
    let wrong = Choice::parse("heat,warmth").unwrap_err();
    assert!(wrong.contains("\"warmth\"") && wrong.contains("mars-light"), "{wrong}");
    assert!(Choice::parse("").is_err());
    // What is only accounted for is no choice.
    assert!(Choice::parse("instrument").is_err());
}
