//! Images by Mitsuba: a path tracer in single precision, with Hapke's model as `render.py` has it from the books.

use mmxrt::physics::reflectance::hapke::{Parameters, Roughness, Surge};
use mmxrt::physics::reflectance::{PhaseFunction, Preset, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Exchange, Material, Model, Photometry, Scene, SceneParts};
use mmxrt::spectral::Spectrum;
use mmxrt::study::{self, Observation};

use super::{MITSUBA, Sampling, python_with, rendered};
use crate::scenes::{self, lambert};
use crate::scratch::is_heavy;
use crate::shapes::*;

/// A model of Hapke's as the script reads it.
pub(super) fn hapke_json(shape: &Shape, albedo: f64) -> serde_json::Value {
    let Shape::Hapke(of) = shape else { panic!("{shape:?} is not Hapke's") };
    let (b, c) = match of.phase {
        PhaseFunction::Isotropic => (0.0, -2.0),
        // The script's sign of two terms: below -1.5 there is one.
        PhaseFunction::HenyeyGreenstein { b } => (b, -2.0),
        PhaseFunction::TwoTerms { b, c } => (b, c),
        PhaseFunction::Legendre { .. } => panic!("{:?} is not written there", of.phase),
    };
    assert_eq!(of.porosity_factor, 1.0);
    serde_json::json!({
        "w": albedo, "b": b, "c": c, "b0": of.shadow_hiding.amplitude, "h": of.shadow_hiding.width, "bc0": of.coherent.amplitude,
        "hc": of.coherent.width, "slope": of.roughness.mean_slope_rad(),
    })
}

/// The Sun alone, as Mitsuba has it.
fn sunlight(scene: &Scene) -> Vec<([f64; 3], f64)> {
    let sun = &scene.sky.sun;
    vec![(sun.direction.vec().to_array(), sun.irradiance_w_m2_um(scene.exposure.bands[0].centre_um).unwrap())]
}

fn seen(scene: &Scene) -> Observation {
    study::simulate(scene, &unwatched).unwrap().1
}

fn lit_share(seen: &Observation) -> &[f64] {
    &seen.backplanes.plane("LIT_FRACTION").unwrap().values
}

/// A relief of hollows with a box on it.
fn relief() -> mmxrt::geometry::Mesh {
    let ground = grid(10.0, 20, |x, y| 1.2 * (0.7 * x).sin() * (0.5 * y).cos() + 0.4 * (1.3 * x - 0.9 * y).sin());
    joined(&[ground, of_material(cuboid([-1.5, -1.0, -1.0], [1.0, 1.5, 3.0]), 1)])
}

fn hapke(w: f64, parameters: Parameters) -> Photometry {
    Photometry::Model(Box::new(Model { shape: Shape::Hapke(parameters), albedo: Spectrum::constant(w), preset: None }))
}

/// Two surfaces that have all of Hapke's terms between them.
fn of_hapke(parts: &mut SceneParts) {
    let rough = Parameters {
        phase: PhaseFunction::HenyeyGreenstein { b: -0.26 },
        shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
        roughness: Roughness::of_mean_slope(24_f64.to_radians()),
        ..Parameters::PLAIN
    };
    let bright = Parameters {
        phase: PhaseFunction::TwoTerms { b: 0.3, c: 0.4 },
        shadow_hiding: Surge { amplitude: 1.0, width: 0.1 },
        coherent: Surge { amplitude: 0.5, width: 0.05 },
        ..Parameters::PLAIN
    };
    parts.surface.materials = [(0, "rough", 0.07, rough), (1, "bright", 0.8, bright)]
        .map(|(i, name, w, parameters)| {
            let photometry = hapke(w, parameters);
            let reflectance = photometry.model().unwrap().hemispherical();
            mmxrt::scene::Material { photometry, ..lambert(i, name, reflectance) }
        })
        .into();
}

/// Of one pair of angles for a facet in a pixel: CONVENTIONS.md has 1.4e-4. What single precision adds is less.
const OWN: f64 = 2e-4;

/// Of a pixel with a shadow's edge in it, over the mean: Mitsuba begins a shadow's ray 9e-5 of a place's coordinates off the surface, which at flat light moves
/// the edge by up to a hundredth of these pixels, to the bright side.
const LEAK: f64 = 4e-3;

/// Ratios of difference and noise, root mean square and largest; our own tolerance, and at the edges of shadows theirs, count as noise.
fn in_noise(ours: &[f64], theirs: &[(f64, f64)], lit: &[f64], level: f64) -> (f64, f64) {
    let ratio = |((ours, (theirs, noise)), lit): ((&f64, &(f64, f64)), &f64)| {
        let leak = if 0.0 < *lit && *lit < 1.0 { LEAK * level } else { 0.0 };
        (ours - theirs) / noise.hypot(OWN * theirs.max(level)).hypot(leak)
    };
    let ratios: Vec<f64> = ours.iter().zip(theirs).zip(lit).map(ratio).collect();
    let rms = (ratios.iter().map(|r| r * r).sum::<f64>() / ratios.len() as f64).sqrt();
    (rms, ratios.iter().fold(0.0, |most, r| f64::max(most, r.abs())))
}

#[test]
fn hapkes_surfaces_are_as_mitsuba_has_them() {
    let Some(python) = python_with(MITSUBA) else { return };
    let rays = if is_heavy() { 1024 } else { 256 };
    for (i, (towards, from)) in [
        // Before, beside and behind the camera; the last near opposition.
        (sun(40.0, 200.0), [60.0, -40.0, 90.0]),
        (sun(70.0, 20.0), [-80.0, 10.0, 60.0]),
        (sun(30.0, 60.0), [30.0, 50.0, 99.0]),
    ]
    .into_iter()
    .enumerate()
    {
        let camera = camera(from, [0.0; 3], [0.0, 0.0, 1.0], 24, 0.18 / 24.0);
        let mut parts = scenes::parts(relief(), camera, towards);
        of_hapke(&mut parts);
        let scene = parts.check().unwrap();
        let seen = seen(&scene);
        let (ours, lit) = (seen.cube.band(0), &seen.backplanes.plane("LIT_FRACTION").unwrap().values);
        let sampling = Sampling { max_depth: 2, rays, seeds: 16 };
        let theirs = rendered(&python, &scene, &sunlight(&scene), sampling);
        let level = ours.iter().sum::<f64>() / ours.len() as f64;
        let (rms, most) = in_noise(&ours, &theirs, lit, level);
        let of_level = |differences: &mut dyn Iterator<Item = (f64, f64)>| {
            let squares: Vec<f64> = differences.map(|(off, of)| (off / of.max(level)).powi(2)).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        let noise = of_level(&mut theirs.iter().map(|(l, noise)| (*noise, *l)));
        let difference = of_level(&mut ours.iter().zip(&theirs).map(|(a, (b, _))| (a - b, *b)));
        let sums = ours.iter().sum::<f64>() / theirs.iter().map(|(l, _)| l).sum::<f64>() - 1.0;
        println!(
            "view {i}: rms of difference {difference:.2e} of the mean, noise {noise:.2e}; in its noise {rms:.2} {most:.2}; sums {sums:.1e}"
        );
        assert!(rms < 1.2 && most < 6.0, "{i}: {rms} {most}");
        assert!(noise < 5e-3 && sums.abs() < 1e-3, "{i}: {noise} {sums}");
    }
}

/// Hollows and a boulder, of cells of so many to 20 m, under a low Sun.
fn hollows(cells: u32, split: u32) -> SceneParts {
    let ground = grid(10.0, cells, |x, y| 1.2 * (0.7 * x).sin() * (0.5 * y).cos() + 0.4 * (1.3 * x - 0.9 * y).sin());
    let mesh = joined(&[ground, of_material(sphere([0.0, 0.0, 1.0], 2.0, split), 1)]);
    let camera = camera([60.0, -40.0, 90.0], [0.0; 3], [0.0, 0.0, 1.0], 24, 0.18 / 24.0);
    let mut parts = scenes::parts(mesh, camera, sun(65.0, 200.0));
    let material = |i, name, reflectance| lambert(i, name, Spectrum::constant(reflectance));
    parts.surface.materials = vec![material(0, "ground", 0.3), material(1, "boulder", 0.6)];
    parts
}

fn exchanging(mut parts: SceneParts, bounces: u32) -> Scene {
    parts.models.exchange = Some(Exchange { bounces, directions: 512, lines_per_facet: 4096 });
    parts.check().unwrap()
}

/// Of pixels wholly in shadow: light relative to theirs in sum, and root mean square of differences, ours and noise, relative to the mean.
fn in_shadow(ours: &Observation, theirs: &[(f64, f64)]) -> [f64; 3] {
    let dark: Vec<usize> = lit_share(ours).iter().enumerate().filter(|(_, lit)| **lit == 0.0).map(|(i, _)| i).collect();
    assert!(dark.len() > 60, "{}", dark.len());
    let image = ours.cube.band(0);
    let sum = |of: &dyn Fn(usize) -> f64| dark.iter().map(|p| of(*p)).sum::<f64>();
    let mean = sum(&|p| theirs[p].0) / dark.len() as f64;
    let rms = |of: &dyn Fn(usize) -> f64| (sum(&|p| of(p).powi(2)) / dark.len() as f64).sqrt() / mean;
    let off = sum(&|p| image[p]) / (mean * dark.len() as f64) - 1.0;
    [off, rms(&|p| image[p] - theirs[p].0), rms(&|p| theirs[p].1)]
}

/// Both materials of a model, their albedos by it.
fn of_model(parts: &mut SceneParts, w: f64, shape: Shape) {
    for material in &mut parts.surface.materials {
        let model = Model { shape, albedo: Spectrum::constant(w), preset: None };
        let (name, reflectance) = (std::mem::take(&mut material.name), model.hemispherical());
        *material = Material { photometry: Photometry::Model(Box::new(model)), ..lambert(0, &name, reflectance) };
    }
}

#[test]
fn light_between_facets_is_as_mitsuba_has_it() {
    let Some(python) = python_with(MITSUBA) else { return };
    let phobos = Preset::PhobosAssumed.known().shape.unwrap();
    // Bounces, cells, and the most that the sum, and pixels by root mean square beyond the noise, may be off; Lambert's surfaces, and those of Phobos.
    let mut cases = vec![(1, 24, [0.01, 0.03], false), (1, 24, [0.08, 0.15], true)];
    if is_heavy() {
        cases.extend([(1, 64, [0.005, 0.015], false), (3, 64, [0.005, 0.015], false), (1, 64, [0.08, 0.15], true)]);
    }
    let (rays, seeds) = if is_heavy() { (4096, 16) } else { (1024, 8) };
    for (bounces, cells, most, is_phobos) in cases {
        let mut parts = hollows(cells, if cells > 30 { 4 } else { 3 });
        if is_phobos {
            of_model(&mut parts, 0.072, phobos);
        }
        let scene = exchanging(parts, bounces);
        let ours = seen(&scene);
        let theirs = rendered(&python, &scene, &sunlight(&scene), Sampling { max_depth: bounces + 2, rays, seeds });
        let [sum, rms, noise] = in_shadow(&ours, &theirs);
        println!("{bounces} bounces, {cells} cells, Phobos {is_phobos}: sum {sum:.4}, rms {rms:.4}, noise {noise:.4}");
        assert!(
            sum.abs() < most[0] + noise && rms < most[1].hypot(1.2 * noise),
            "{bounces} {cells}: {sum} {rms} {noise}"
        );
    }
}
