//! Random scenes against a truth in numbers of 106 bits: what each pixel sees and how much of it is lit.

mod double;
mod image;
mod kinds;

use std::panic::{AssertUnwindSafe, catch_unwind};

use mmxrt::geometry::Direction;
use mmxrt::scene::{Beam, Material};
use mmxrt::spectral::Spectrum;
use mmxrt::visibility::{Drawing, Topology, View, covered};
use rayon::prelude::*;

use crate::shapes::*;
use image::{GRAZING, Truth};
use kinds::{REFLECTANCE, Scene};

/// Largest error of a pixel's area, pixels, and of its radiance over that of a white surface under the Sun.
const TOLERANCE: f64 = 1e-11;

/// What the library says of each pixel.
fn ours(scene: &Scene) -> Vec<Truth> {
    let seen = see(&scene.mesh, scene.towards_sun, &scene.camera);
    let pixels = (scene.camera.samples * scene.camera.lines) as usize;
    let mut image = vec![Truth::default(); pixels];
    let outwards: Vec<f64> = (0..scene.mesh.facets.len())
        .map(|f| {
            let facet = scene.mesh.facet(f);
            facet.cross_m2().dot(scene.camera.centre_m() - facet.corners_m[0])
        })
        .collect();
    for (p, truth) in image.iter_mut().enumerate() {
        for (facet, fraction, lit) in seen.footprints.pixel(p) {
            let f = facet as usize;
            let cos_incidence = scene.mesh.facet(f).normal().dot(scene.towards_sun.vec());
            truth.coverage += fraction;
            truth.front += if outwards[f] > 0.0 { fraction } else { 0.0 };
            truth.lit += if cos_incidence > GRAZING { lit } else { 0.0 };
            truth.radiance += REFLECTANCE[scene.mesh.material[f].0 as usize] * cos_incidence.max(0.0) * lit;
        }
    }
    image
}

/// What of a scene is wrong: the worst of its pixels, in a sentence. `truths` has one truth, or several of which a pixel may have any.
fn wrong(scene: &Scene, truths: &[Vec<Truth>], tolerance: f64) -> Option<String> {
    let ours = match catch_unwind(AssertUnwindSafe(|| ours(scene))) {
        Ok(ours) => ours,
        Err(why) => {
            let why = why.downcast_ref::<String>().cloned().unwrap_or_default();
            return Some(format!("refused by the product's own check: {why}"));
        }
    };
    let mut worst = (tolerance, None);
    for (p, ours) in ours.iter().enumerate() {
        // Which of two sides is seen that lie within rounding of one another is for the rule of ties to say.
        let sides_matter = scene.before.is_none();
        let errors = truths.iter().map(|truth| largest_error(ours, &truth[p], sides_matter));
        let (error, what) = errors.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a truth");
        if error.is_nan() || error > worst.0 {
            worst = (error, Some(format!("pixel {p}: {what}")));
        }
    }
    worst.1
}

fn largest_error(ours: &Truth, truth: &Truth, sides_matter: bool) -> (f64, String) {
    [
        ("coverage", ours.coverage, truth.coverage),
        ("front", ours.front, if sides_matter { truth.front } else { ours.front }),
        ("lit", ours.lit, truth.lit),
        ("radiance", ours.radiance, truth.radiance),
    ]
    .map(|(what, got, expected)| {
        ((got - expected).abs(), format!("{what} {got}, not {expected}: {:.2e}", got - expected))
    })
    .into_iter()
    .max_by(|a, b| a.0.total_cmp(&b.0))
    .expect("four of them")
}

/// Writes a scene as files, with the truth beside it.
fn keep(folder: &std::path::Path, scene: &Scene, truth: &[Truth], what: &str) {
    std::fs::create_dir_all(folder).unwrap();
    let mut obj = String::from("mtllib s.mtl\n");
    for v in &scene.mesh.vertices_m {
        obj += &format!("v {:?} {:?} {:?}\n", v.x, v.y, v.z);
    }
    for (f, m) in scene.mesh.facets.iter().zip(&scene.mesh.material) {
        obj += &format!("usemtl m{}\nf {} {} {}\n", m.0, f[0] + 1, f[1] + 1, f[2] + 1);
    }
    let materials: String = (0..3).map(|m| format!("m{m} = {{ reflectance = {} }}\n", REFLECTANCE[m])).collect();
    let mtl: String = (0..3).map(|m| format!("newmtl m{m}\n")).collect();
    let camera = &scene.camera;
    let axes = camera.world_from_sensor.rotation;
    let toml = format!(
        "mmxrt_scene = 1\norigin_m = [0.0, 0.0, 0.0]\n[[mesh]]\nobj = \"s.obj\"\ncoordinates = \"local\"\n[materials]\n{materials}\
         [sun]\ndirection = {:?}\ndistance_au = 1.0\nspectrum = \"e1.csv\"\n[observer]\nposition_m = {:?}\nh = {:?}\nv = {:?}\nu = {:?}\n\
         [sensor]\nsamples = {}\nlines = {}\nifov_mrad = {:?}\nbands = {{ centres_um = [1.0] }}\n[thermal]\nmodel = \"off\"\n",
        scene.towards_sun.vec().to_array(),
        camera.centre_m().to_array(),
        axes.x_axis.to_array(),
        axes.y_axis.to_array(),
        axes.z_axis.to_array(),
        camera.samples,
        camera.lines,
        1e3 * camera.ifov_rad(),
    );
    let mut csv = String::from("line,sample,coverage,pi_radiance_over_irradiance,front_area,lit_area\n");
    for (p, t) in truth.iter().enumerate() {
        let (line, sample) = (p / camera.samples as usize, p % camera.samples as usize);
        csv += &format!("{line},{sample},{:?},{:?},{:?},{:?}\n", t.coverage, t.radiance, t.front, t.lit);
    }
    for (name, content) in [
        ("s.obj", obj.as_str()),
        ("s.mtl", &mtl),
        ("s.toml", &toml),
        ("expected.csv", &csv),
        ("README.md", what),
        ("e1.csv", "wavelength_um,irradiance_w_m2_um\n0.1,1000\n10,1000\n"),
    ] {
        std::fs::write(folder.join(name), content).unwrap();
    }
}

/// So many scenes of a kind are looked at in further ways.
const FEW: u64 = 8;

/// What is wrong of a scene under the Sun and a beam: the truth is the sum of what each lights alone.
fn wrong_with_a_beam(scene: &Scene, seed: u64, tolerance: f64) -> Option<String> {
    let mut r = Random(seed ^ 0xBEA3);
    let towards = direction([r.share() - 0.5, r.share() - 0.5, r.share() + 0.05]);
    let mut parts = crate::scenes::scene(plane(1.0, 0.0), nadir(10.0, 1.0, 1), [0.0, 0.0, 1.0]).into_parts();
    let grey = parts.surface.materials[0].clone();
    parts.surface.materials = REFLECTANCE
        .iter()
        .enumerate()
        .map(|(i, reflectance)| Material {
            name: format!("m{i}"),
            reflectance: Spectrum::constant(*reflectance),
            mixture: vec![(i, 1.0)],
            ..grey.clone()
        })
        .collect();
    parts.surface.mesh.clone_from(&scene.mesh);
    parts.exposure.camera = scene.camera.clone();
    parts.sky.sun.direction = scene.towards_sun;
    let irradiance = 500.0;
    let beam = Beam {
        name: "lamp".into(),
        direction: towards,
        irradiance: Spectrum::constant(irradiance),
        total_irradiance_w_m2: 0.0,
    };
    parts.sky.beams.push(beam);
    // A camera inside the only body is refused.
    let lit = parts.check().ok()?;
    let radiance = match mmxrt::study::simulate(&lit, &mmxrt::progress::unwatched) {
        Ok((_, seen)) => seen.cube.band(0),
        Err(error) => return Some(error.to_string()),
    };
    let lit_by = |towards: Direction| image::image(&scene.mesh, towards.vec(), &scene.camera, &REFLECTANCE);
    let (by_sun, by_beam) = (lit_by(scene.towards_sun), lit_by(towards));
    let (sun, pi) = (700.0 / 2.25, std::f64::consts::PI);
    (0..radiance.len()).find_map(|p| {
        let expected = (sun * by_sun[p].radiance + irradiance * by_beam[p].radiance) / pi;
        let off = (radiance[p] - expected).abs() / (sun + irradiance) * pi;
        (off.is_nan() || off > tolerance).then(|| format!("with a beam, pixel {p}: {} for {expected}", radiance[p]))
    })
}

/// What is wrong of a line that is drawn of the facets near it alone, against the same line drawn of all.
fn wrong_by_lines(scene: &Scene) -> Option<String> {
    let topology = Topology::new(&scene.mesh);
    (0..scene.camera.lines).find_map(|line| {
        let camera = scene.camera.window(0..scene.camera.samples, line..line + 1);
        let (view, grid) = View::of_frame(&camera, scene.mesh.bounds_m());
        let facets = crate::subset::near_the_lines(&scene.mesh, &camera);
        let shares = |drawing: &Drawing| {
            covered(drawing, "line", |sides| sides[0] + 2.0 * sides[1], &mmxrt::progress::unwatched).unwrap()
        };
        let all = shares(&Drawing::new(&scene.mesh, &topology, view, grid));
        let some = shares(&Drawing::of_facets(&scene.mesh, &topology, view, grid, &facets));
        let differs = |p: &usize| (all[*p] - some[*p]).abs() > TOLERANCE;
        (0..all.len()).find(differs).map(|p| format!("line {line}, sample {p}: {} of all, {} of some", all[p], some[p]))
    })
}

/// Compares random scenes of a kind. `MMXRT_HEAVY=1` takes many; `MMXRT_FAILURES` names a folder for those that are wrong.
fn compare(kind: &str, make: fn(&mut Random) -> Scene, tolerance: fn(&Scene) -> f64) {
    let heavy = crate::scratch::is_heavy();
    let scenes: u64 = if heavy { 2000 } else { 40 };
    let scenes = std::env::var("MMXRT_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(scenes);
    assert!(scenes > 0, "MMXRT_SCENES is a number from 1");
    let failures = std::env::var_os("MMXRT_FAILURES").map(std::path::PathBuf::from);
    // Of each scene: what is wrong, its facets, and pixels that are seen in part, lit in part.
    let results: Vec<(Option<String>, usize, usize, usize)> = (0..scenes)
        .into_par_iter()
        .map(|seed| {
            let scene = make(&mut Random(seed));
            let truth_of = |mesh| image::image(mesh, scene.towards_sun.vec(), &scene.camera, &REFLECTANCE);
            let truths: Vec<_> = std::iter::once(&scene.mesh).chain(&scene.before).map(truth_of).collect();
            let mut wrong = wrong(&scene, &truths, tolerance(&scene));
            if seed < FEW {
                // Of scenes with several truths each pixel may have any: sums of two are not theirs.
                let of_beam =
                    || if scene.before.is_none() { wrong_with_a_beam(&scene, seed, tolerance(&scene)) } else { None };
                wrong = wrong.or_else(of_beam).or_else(|| wrong_by_lines(&scene));
            }
            let truth = &truths[0];
            if let (Some(folder), Some(wrong)) = (&failures, &wrong) {
                keep(&folder.join(format!("{kind}-{seed}")), &scene, truth, &format!("{kind} {seed}: {wrong}\n"));
            }
            let partly = |area: f64, of: f64| area > 1e-6 && area < of - 1e-6;
            let edges = truth.iter().filter(|t| partly(t.coverage, 1.0)).count();
            let shadows = truth.iter().filter(|t| partly(t.lit, t.front)).count();
            (wrong, scene.mesh.facets.len(), edges, shadows)
        })
        .collect();
    let bad: Vec<String> =
        results.iter().enumerate().filter_map(|(seed, r)| Some(format!("{seed}: {}", r.0.as_ref()?))).collect();
    let sum = |of: fn(&(Option<String>, usize, usize, usize)) -> usize| results.iter().map(of).sum::<usize>() as u64;
    let (facets, edges, shadows) = (sum(|r| r.1), sum(|r| r.2), sum(|r| r.3));
    println!(
        "{kind}: {scenes} scenes, {facets} facets; of pixels {edges} seen in part, {shadows} lit in part; {} wrong",
        bad.len()
    );
    let few: Vec<&String> = bad.iter().take(20).collect();
    assert!(bad.is_empty(), "{kind}: {} of {scenes} scenes are wrong: {few:#?}", bad.len());
    assert!(facets >= 5 * scenes && edges + shadows >= scenes, "{kind}: {edges} seen in part, {shadows} lit in part");
}

fn near(_: &Scene) -> f64 {
    TOLERANCE
}

macro_rules! kinds {
    ($($kind:ident, $tolerance:ident;)*) => {
        $(#[test]
        fn $kind() {
            compare(stringify!($kind), kinds::$kind, $tolerance);
        })*
    };
}

kinds! {
    fans, near;
    polygons, near;
    boxes, near;
    slivers, near;
    sheets, near;
    rooms, near;
    eyes, near;
    scattered, near;
    piercing, near;
    copies, near;
    nudged, near;
    far, near;
}
