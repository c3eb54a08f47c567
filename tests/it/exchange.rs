//! Light and heat between facets, against closed forms and rays to every facet.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::formats::npz;
use mmxrt::geometry::{MaterialId, Mesh};
use mmxrt::integrate::Wanted;
use mmxrt::physics::form_factor;
use mmxrt::product::{FacetTable, Reflected, ReflectedPart};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Beam, Exchange, Models, Scene, SceneParts, Thermal};
use mmxrt::solve::solve;
use mmxrt::spectral::{Band, Extend, Light, Spectrum};
use mmxrt::study;
use mmxrt::visibility::{Bundles, LineScratch};

use crate::scenes::{lambert, parts};
use crate::scratch::Scratch;
use crate::shapes::{Random, cuboid, direction, grid, joined, mesh, nadir, of_material, quad};

/// How much of what each of some groups of facets sends arrives at each other one: form factors, [from, to].
fn factors(mesh: &Mesh, groups: &[std::ops::Range<u32>], bundles: u32) -> Vec<Vec<f64>> {
    factors_by(&Bundles::new(mesh, bundles, 1024), groups)
}

fn factors_by(bundles: &Bundles, groups: &[std::ops::Range<u32>]) -> Vec<Vec<f64>> {
    let mesh = bundles.mesh();
    let group = |facet: u32| groups.iter().position(|g| g.contains(&facet)).unwrap();
    let mut lines = vec![vec![0.0; groups.len()]; groups.len()];
    let mut scratch = LineScratch::default();
    for bundle in 0..bundles.count() {
        let mut met = vec![];
        let each = bundles.meetings(bundle, &mut scratch, |_, meeting| met.push(meeting.facets));
        for [one, other] in met {
            lines[group(one)][group(other)] += each;
            lines[group(other)][group(one)] += each;
        }
    }
    for (row, group) in lines.iter_mut().zip(groups) {
        let area_m2: f64 = group.clone().map(|f| mesh.facet(f as usize).area_m2()).sum();
        row.iter_mut().for_each(|sum| *sum *= bundles.share_of_line(area_m2));
    }
    lines
}

fn assert_near(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!((got / expected - 1.0).abs() < tolerance, "{what}: {got}, not {expected}");
}

/// A square of 1 m at a height that faces up, or down.
fn level(z: f64, is_up: bool) -> Mesh {
    let mut square = quad([0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]);
    if !is_up {
        square.flip();
    }
    square
}

#[test]
fn squares_and_strips() {
    let parallel = factors(&joined(&[level(0.0, true), level(1.0, false)]), &[0..2, 2..4], 512);
    assert_near("parallel squares", parallel[0][1], 0.199_824_895_7, 5e-3);
    assert_eq!((parallel[0][0], parallel[1][1]), (0.0, 0.0));
    let wall = quad([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]);
    let adjacent = factors(&joined(&[level(0.0, true), wall]), &[0..2, 2..4], 512);
    assert_near("adjacent squares", adjacent[0][1], 0.200_043_776_1, 1e-2);
    assert_near("reciprocity", adjacent[1][0], adjacent[0][1], 1e-12);
    // Long strips at right angles, of which the ends count for less than a hundredth.
    let strip = quad([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 200.0, 0.0], [0.0, 200.0, 0.0]);
    let upright = quad([0.0, 0.0, 0.0], [0.0, 200.0, 0.0], [0.0, 200.0, 1.0], [0.0, 0.0, 1.0]);
    let strips = factors(&joined(&[strip, upright]), &[0..2, 2..4], 512);
    assert_near("strips", strips[0][1], 1.0 - 0.5_f64.sqrt(), 2e-2);
}

#[test]
fn in_a_closed_box_all_that_is_sent_arrives() {
    // Corners are whole numbers, so that lines of a lattice might run along edges; the box is turned inside out.
    let mut room = cuboid([0.0, 0.0, 0.0], [4.0, 2.0, 1.0]);
    room.flip();
    let groups: Vec<_> = (0..12).step_by(2).map(|f| f..f + 2).collect();
    for row in factors(&room, &groups, 512) {
        assert_near("sum of a row", row.iter().sum(), 1.0, 5e-3);
    }
    // From outside it is convex.
    room.flip();
    assert!(factors(&room, &groups, 64).concat().iter().all(|f| *f == 0.0));
}

#[test]
fn coincident_plates_neither_let_light_through_nor_swallow_it() {
    // A sheet with both its sides, between two plates that face it; of other triangles, at an angle to all axes.
    let mut down = mesh(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 3], [1, 2, 3]]);
    down.flip();
    let mut all = joined(&[level(0.0, true), down, level(0.25, false), level(-0.25, true)]);
    let turned = glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, -1.1);
    all.vertices_m.iter_mut().for_each(|p| *p = turned * *p + DVec3::new(1e3, -2e3, 3e3));
    let groups = [0..2, 2..4, 4..6, 6..8];
    let f = factors(&all, &groups, 512);
    let expected = form_factor::parallel_rectangles(1.0, 1.0, 0.25);
    assert_near("upper", f[0][2], expected, 5e-3);
    assert_near("lower", f[1][3], expected, 5e-3);
    assert_eq!([f[0][1], f[0][3], f[1][2]], [0.0; 3]);
    // What passes the sheet on its sides, not through it: nothing, since all four are as wide.
    assert_eq!(f[2][3], 0.0);
    // Plates that all but touch exchange everything.
    let near = factors(&joined(&[level(0.0, true), level(1e-7, false)]), &[0..2, 2..4], 256);
    assert_near("nearly touching", near[0][1], 1.0, 5e-3);
}

#[test]
fn an_inner_side_is_dark_and_blocks() {
    // The plate in the middle faces up: what is below it sees its inner side.
    let all = joined(&[level(0.0, true), level(0.5, true), level(1.0, false)]);
    let f = factors(&all, &[0..2, 2..4, 4..6], 512);
    assert_near("above", f[1][2], form_factor::parallel_rectangles(1.0, 1.0, 0.5), 5e-3);
    assert_eq!(f[0][1], 0.0);
    // What goes round the middle one is less than all that would pass without it.
    assert!(f[0][2] == 0.0, "{f:?}");
}

#[test]
fn a_part_in_detail_has_lines_of_its_own() {
    // Two finely divided squares that face each other, 1 m apart, over the middle of a plain of 40 x 40 m: by area they would have a line in 400.
    let fine = |z: f64, is_up: bool| {
        let mut square = grid(0.5, 24, |_, _| z);
        if !is_up {
            square.flip();
        }
        square
    };
    let plain = grid(20.0, 4, |_, _| -1.0);
    let (low, high) = (fine(0.0, true), fine(1.0, false));
    let n = u32::try_from(low.facets.len()).unwrap();
    let all = joined(&[low, high, plain]);
    let groups = [0..n, n..2 * n, 2 * n..u32::try_from(all.facets.len()).unwrap()];
    let levels = Bundles::levels(&all, 256, 256);
    assert_eq!(levels.len(), 2);
    assert!(
        groups
            .iter()
            .zip([0, 0, 1])
            .all(|(g, level)| g.clone().all(|f| levels[level].is_of(f) && !levels[1 - level].is_of(f)))
    );
    let of_fine = factors_by(&levels[0], &groups);
    let expected = form_factor::parallel_rectangles(1.0, 1.0, 1.0);
    assert_near("parallel squares", of_fine[0][1], expected, 1e-2);
    assert_near("reciprocity", of_fine[1][0], of_fine[0][1], 1e-12);
    // Past the lower square the upper one sees the plain, and little beyond it: a hundredth of its hemisphere.
    assert_near("upper and plain", of_fine[1][2], 1.0 - expected, 2e-2);
    assert_eq!(of_fine[0][2], 0.0);
    // The plain's own lines tell the same of what the upper square sends it, if only roughly.
    let of_plain = factors_by(&levels[1], &groups);
    assert_near("plain and upper", of_plain[2][1] * 40.0 * 40.0, 1.0 - expected, 0.15);
    // All of one size: one level.
    assert_eq!(Bundles::levels(&fine(0.0, true), 16, 16).len(), 1);
}

#[test]
fn slivers_and_facets_without_area_are_harmless() {
    let sliver =
        mesh(&[[0.2, 0.2, 0.5], [0.8, 0.2, 0.5], [0.5, 0.2 + 1e-13, 0.5], [0.1, 0.1, 0.3]], &[[0, 1, 2], [3, 3, 0]]);
    let all = joined(&[level(0.0, true), level(1.0, false), sliver]);
    let f = factors(&all, &[0..2, 2..4, 4..6], 512);
    assert_near("parallel squares", f[0][1], 0.199_824_895_7, 5e-3);
    assert!(f.concat().iter().all(|f| f.is_finite()));
    assert_eq!(Bundles::new(&mesh(&[[0.0; 3]], &[[0, 0, 0]]), 16, 16).count(), 0);
}

/// A scene of a Lambert mesh with exchange.
fn with_exchange(mesh: Mesh, towards_sun: [f64; 3], exchange: Exchange, change: impl FnOnce(&mut SceneParts)) -> Scene {
    let mut parts = parts(mesh, nadir(1000.0, 100.0, 8), direction(towards_sun));
    parts.models = Models { exchange: Some(exchange), ..parts.models };
    change(&mut parts);
    parts.check().unwrap()
}

/// Irradiance of a facet by way of others at a wavelength, over sunlight there.
fn over_sunlight(scene: &Scene, table: &FacetTable, facet: usize, um: f64) -> f64 {
    let source =
        |s: usize| scene.incoming_w_m2_um(scene.sources()[s].incoming, Light::Both, um).iter().product::<f64>();
    let reflectance = |m: &MaterialId| scene.body.materials[m.0 as usize].reflectance.at(um).unwrap();
    let of_part =
        |part: &ReflectedPart| part.factor * source(part.source) * part.by.iter().map(reflectance).product::<f64>();
    let of = |r: &Reflected| r.irradiance[facet] * r.parts.iter().map(of_part).sum::<f64>();
    table.reflected.iter().map(of).sum::<f64>() / source(0)
}

/// A bowl: the cap of a sphere, of rings, whose rim is a circle of diameter 1 at height 0.
fn bowl(depth: f64, rings: u32) -> Mesh {
    let radius = (0.25 + depth * depth) / (2.0 * depth);
    let opening = (0.5 / radius).asin();
    let opening = if depth > radius { PI - opening } else { opening };
    let point = |ring: u32, k: u32, n: u32| {
        let (polar, turn) = (opening * f64::from(ring) / f64::from(rings), 2.0 * PI * f64::from(k) / f64::from(n));
        [radius * polar.sin() * turn.cos(), radius * polar.sin() * turn.sin(), radius - depth - radius * polar.cos()]
    };
    // Ring r has 6 r points; between rings, triangles both ways.
    let (mut vertices, mut facets, mut first) = (vec![point(0, 0, 1)], vec![], 0);
    for ring in 1..=rings {
        let (inner, outer, base) = (6 * (ring - 1), 6 * ring, vertices.len() as u32);
        vertices.extend((0..outer).map(|k| point(ring, k, outer)));
        let at_inner = |k: u32| if inner == 0 { 0 } else { first + k % inner };
        for sector in 0..6 {
            for k in 0..ring {
                let (o, i) = (sector * ring + k, sector * (ring - 1) + k);
                facets.push([at_inner(i), base + o, base + (o + 1) % outer]);
                if k + 1 < ring {
                    facets.push([at_inner(i), base + (o + 1) % outer, at_inner(i + 1)]);
                }
            }
        }
        first = base;
    }
    mesh(&vertices, &facets)
}

#[test]
fn bowls_have_the_light_and_the_warmth_of_ingersoll() {
    // Ingersoll, Svitek & Murray (1992): in a cap of a sphere both are the same everywhere. Albedo 0.07, emissivity 0.95, 586.22 W m-2.
    let mut worst = vec![];
    for (depth, rings, elevation_deg, light_w_m2, t_k) in [
        (0.2, 12, 30.0, 2.463_524, 163.355_4),
        (0.2, 57, 10.0, 0.855_573, 125.403_2),
        (0.2, 57, 30.0, 2.463_524, 163.355_4),
        (0.5, 57, 60.0, 9.206_881, 258.617_0),
    ] {
        let bowl = bowl(depth, rings);
        let elevation = f64::to_radians(elevation_deg);
        let exchange = Exchange { bounces: 40, directions: 256, lines_per_facet: 1024 };
        let scene = with_exchange(bowl, [elevation.cos(), 0.0, elevation.sin()], exchange, |parts| {
            parts.models.thermal = Thermal::Equilibrium;
            parts.sky.sun.total_irradiance_1au_w_m2 = 586.22 * 1.5 * 1.5;
        });
        let table = solve(&scene, &unwatched).unwrap();
        let (mut light, mut warmth, mut area_m2, mut spread) = (0.0, 0.0, 0.0, 0.0);
        for f in 0..table.facets() {
            let facet_m2 = scene.body.mesh.facet(f).area_m2();
            area_m2 += facet_m2;
            light += facet_m2 * 586.22 * over_sunlight(&scene, &table, f, 1.0);
            warmth += facet_m2 * table.temperature_shaded_k[f].powi(4);
            spread += facet_m2 * (table.temperature_shaded_k[f] - t_k).powi(2);
        }
        let off = [light / area_m2 / light_w_m2 - 1.0, (warmth / area_m2).sqrt().sqrt() / t_k - 1.0];
        worst.push(off.map(f64::abs));
        let limit = if rings == 57 { 5e-3 } else { 3e-2 };
        assert!(off[0].abs() < limit && off[1].abs() < limit, "{depth} {rings} {elevation_deg}: {off:?}");
        assert!(
            (spread / area_m2).sqrt() < 0.05 * t_k,
            "{depth} {rings} {elevation_deg}: {}",
            (spread / area_m2).sqrt()
        );
    }
    // The error falls with the number of facets: 864 and 19,494.
    assert!(worst[2][0] < worst[0][0] && worst[2][1] < worst[0][1], "{worst:?}");
}

/// Ground of 8 x 8 m in material 0, and a wall 4 m high on its west side in material 1, which faces east.
fn corner() -> Mesh {
    let ground = quad([-4.0, -4.0, 0.0], [4.0, -4.0, 0.0], [4.0, 4.0, 0.0], [-4.0, 4.0, 0.0]);
    let wall = quad([-4.0, -4.0, 0.0], [-4.0, 4.0, 0.0], [-4.0, 4.0, 4.0], [-4.0, -4.0, 4.0]);
    joined(&[ground, of_material(wall, 1)])
}

#[test]
fn each_surface_on_the_way_counts_once_in_the_spectrum() {
    let spectrum = |at_1: f64, at_2: f64| Spectrum::new(vec![1.0, 2.0], vec![at_1, at_2], Extend::Error).unwrap();
    let of_bounces = |bounces: u32| {
        with_exchange(corner(), [1.0, 0.0, 1.0], Exchange { bounces, ..Exchange::default() }, |parts| {
            parts.surface.materials =
                vec![lambert(0, "ground", spectrum(0.1, 0.8)), lambert(1, "wall", spectrum(0.9, 0.4))];
            parts.exposure.bands = vec![Band::new(1.0, None), Band::new(2.0, None)];
            parts.exposure.camera = nadir(1000.0, 4.0, 1);
        })
    };
    let [one, two] = [1, 2].map(of_bounces);
    let [first, both] = [&one, &two].map(|scene| solve(scene, &unwatched).unwrap());
    let mean = |scene: &Scene, table: &FacetTable, um: f64, facets: [usize; 2]| {
        0.5 * facets.map(|f| over_sunlight(scene, table, f, um)).iter().sum::<f64>()
    };
    // Adjacent rectangles, both lit at 45 deg: by closed form.
    let (to_wall, to_ground) =
        (form_factor::perpendicular_rectangles(8.0, 8.0, 4.0), form_factor::perpendicular_rectangles(8.0, 4.0, 8.0));
    let lit = 0.5_f64.sqrt();
    for (um, ground, wall) in [(1.0, 0.1, 0.9), (2.0, 0.8, 0.4)] {
        let (on_ground, on_wall) = (mean(&one, &first, um, [0, 1]), mean(&one, &first, um, [2, 3]));
        assert_near("first, on the ground", on_ground, wall * to_wall * lit, 1e-2);
        assert_near("first, on the wall", on_wall, ground * to_ground * lit, 1e-2);
        // Of the second bounce each has what it sent to the other itself; facets are large, so about.
        let more = mean(&two, &both, um, [0, 1]) - on_ground;
        assert_near("second, on the ground", more, ground * wall * to_wall * to_ground * lit, 0.2);
        let more = mean(&two, &both, um, [2, 3]) - on_wall;
        assert_near("second, on the wall", more, ground * wall * to_wall * to_ground * lit, 0.2);
    }

    // The image: one pixel amid the ground, on both of its facets or on one.
    let (_, seen) = study::simulate(&two, &unwatched).unwrap();
    let without =
        Scene::new(mmxrt::scene::Setup { models: Models { exchange: None, ..two.models }, ..(*two).clone() }).unwrap();
    let (_, bare) = study::simulate(&without, &unwatched).unwrap();
    let sun = 700.0 / (1.5 * 1.5);
    for (band, um, ground) in [(0, 1.0, 0.1), (1, 2.0, 0.8)] {
        let more = seen.cube.band(band)[0] - bare.cube.band(band)[0];
        let bounds = [0, 1].map(|f| ground / PI * sun * over_sunlight(&two, &both, f, um));
        let (low, high) = (bounds[0].min(bounds[1]), bounds[0].max(bounds[1]));
        assert!(more > low * (1.0 - 1e-5) && more < high * (1.0 + 1e-5), "{band}: {more} {bounds:?}");
    }
}

/// A rough site in so many materials with spectra of their own, a band depth of each somewhere else, under the Sun and so many beams, in these bands.
fn colourful(materials: u16, beams: usize, bands_um: &[f64]) -> Scene {
    let mut random = Random(11);
    let ground = grid(20.0, 16, |x, y| 3.0 * (0.4 * x).sin() * (0.3 * y).cos() + (0.9 * x - 0.7 * y).sin());
    let exchange = Exchange { bounces: 3, directions: 32, lines_per_facet: 256 };
    with_exchange(ground, [1.0, 0.2, 0.4], exchange, |parts| {
        parts.exposure.bands = bands_um.iter().map(|um| Band::new(*um, None)).collect();
        let um: Vec<f64> = (0..=60).map(|i| 0.9 + 0.05 * f64::from(i)).collect();
        let mut spectrum = |most: f64| {
            let (level, slope, at) = (random.share(), random.share() - 0.5, 0.9 + 3.0 * random.share());
            let value = |um: &f64| {
                most * (0.3 + 0.4 * level + 0.15 * slope * (um - 2.0) - 0.15 * (-((um - at) / 0.2).powi(2)).exp())
            };
            Spectrum::new(um.clone(), um.iter().map(value).collect(), Extend::Error).unwrap()
        };
        let named = |m: u16| lambert(m.into(), &format!("m{m}"), spectrum(1.0));
        parts.surface.materials = (0..materials).map(named).collect();
        let count = parts.surface.mesh.facets.len();
        parts.surface.mesh.material = (0..count).map(|f| MaterialId((f * 7 % usize::from(materials)) as u16)).collect();
        let beam = |k: usize| Beam {
            name: format!("lamp-{k}"),
            direction: direction([-0.5, 0.3 * k as f64, 1.0]),
            irradiance: spectrum(300.0),
            total_irradiance_w_m2: 300.0,
        };
        parts.sky.beams = (0..beams).map(beam).collect();
    })
}

#[test]
fn many_materials_and_sources_keep_all_their_colours() {
    // In one band there is one number for each surface, and no spectrum to be made up. 40 materials, three bounces: 12,340 colours a source.
    let bands_um = [0.95, 1.3, 1.8, 2.2, 2.9, 3.55];
    let mut some = 0;
    for (materials, beams) in [(1, 0), (4, 5), (40, 3)] {
        let scene = colourful(materials, beams, &bands_um);
        let table = solve(&scene, &unwatched).unwrap();
        assert!(table.reflected.len() <= bands_um.len() && table.sampling.unwrap().spectra <= 1e-5);
        for um in bands_um {
            let alone = colourful(materials, beams, &[um]);
            let of_one = solve(&alone, &unwatched).unwrap();
            for f in 0..table.facets() {
                let expected = over_sunlight(&alone, &of_one, f, um);
                let got = over_sunlight(&scene, &table, f, um);
                assert!((got - expected).abs() <= 1e-4 * expected, "{materials} {f} {um}: {got}, not {expected}");
                some += usize::from(expected > 1e-3);
            }
        }
    }
    assert!(some > 3000, "{some}");
}

#[test]
fn a_table_for_other_bands_says_how_far_off_their_colours_are() {
    let error = |scene: &Scene, table: &FacetTable| {
        let off = |warning: &String| warning.starts_with("light between facets is known at").then(|| warning.clone());
        let seen = study::observe(scene, table, Wanted::default(), &unwatched).unwrap();
        seen.warnings.iter().find_map(off)
    };
    let solved = colourful(6, 2, &[1.0, 2.0, 3.0]);
    let table = solve(&solved, &unwatched).unwrap();
    assert_eq!(error(&solved, &table), None);
    // Bands 0.4 um from those: spectra have dips of 0.2 um. Between them, worse than 1 % and no worse than a dip is deep.
    let elsewhere = colourful(6, 2, &[1.4, 2.4]);
    assert!(error(&elsewhere, &table).is_some());
    // Another reflectance on the way, where it was taken: not the scene's any more.
    let mut parts = colourful(6, 2, &[1.0, 2.0, 3.0]).into_parts();
    parts.surface.materials[3].reflectance = parts.surface.materials[3].reflectance.map(|r| 1.001 * r);
    let Err(mmxrt::Error::Invalid(problems)) = table.fits(&parts.check().unwrap()) else { panic!() };
    assert!(problems[0].message.contains("another reflectance of \"m3\""), "{problems:?}");
}

#[test]
fn a_faint_source_changes_nothing_of_the_others() {
    let with = |irradiance: f64| {
        let mut parts = colourful(6, 4, &[1.0, 1.5, 2.0, 2.5, 3.0, 3.5]).into_parts();
        if irradiance > 0.0 {
            let irradiance = Spectrum::new(vec![0.9, 2.0, 4.0], vec![0.0, irradiance, 0.0], Extend::Error).unwrap();
            let direction = direction([0.0, -0.2, 1.0]);
            let total_irradiance_w_m2 = 0.0;
            parts.sky.beams.push(Beam { name: "faint".into(), direction, irradiance, total_irradiance_w_m2 });
        }
        let scene = parts.check().unwrap();
        let table = solve(&scene, &unwatched).unwrap();
        let of = |um: f64| (0..table.facets()).map(|f| over_sunlight(&scene, &table, f, um)).collect::<Vec<_>>();
        [1.0, 2.0, 3.5].map(of).concat()
    };
    let (without, with) = (with(0.0), with(1e-6));
    assert!(without.iter().filter(|x| **x > 1e-3).count() > 300);
    for (got, expected) in with.iter().zip(&without) {
        assert!((got - expected).abs() <= 1e-4 * expected, "{got}, not {expected}");
    }
}

#[test]
fn a_facet_that_is_lit_in_part_shines_where_it_is_lit() {
    // A roof over the wall shades its upper part: one large facet, or many small ones, light the ground alike.
    let roof = |wall: Mesh| {
        let roof = quad([0.0, -50.0, 4.0], [2.0, -50.0, 4.0], [2.0, 50.0, 4.0], [0.0, 50.0, 4.0]);
        joined(&[quad([0.5, 3.0, 0.0], [1.5, 3.0, 0.0], [1.5, 5.0, 0.0], [0.5, 5.0, 0.0]), wall, roof])
    };
    let coarse = quad([0.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 8.0, 4.0], [0.0, 0.0, 4.0]);
    let fine: Vec<Mesh> = (0..16)
        .map(|k| 0.25 * f64::from(k))
        .map(|z| quad([0.0, 0.0, z], [0.0, 8.0, z], [0.0, 8.0, z + 0.25], [0.0, 0.0, z + 0.25]))
        .collect();
    let on_ground = |wall: Mesh| {
        let exchange = Exchange { bounces: 1, directions: 512, lines_per_facet: 1024 };
        let scene = with_exchange(roof(wall), [1.0, 0.0, 1.0], exchange, |_| {});
        let table = solve(&scene, &unwatched).unwrap();
        [0, 1].map(|f| over_sunlight(&scene, &table, f, 1.0)).iter().sum::<f64>()
    };
    assert_near("ground", on_ground(coarse), on_ground(joined(&fine)), 2e-2);
}

/// Where a ray first meets a mesh: after which way, which facet, and whether on its outer side.
fn first_met(mesh: &Mesh, from: DVec3, ray: DVec3) -> Option<(f64, usize, bool)> {
    let mut first: Option<(f64, usize, bool)> = None;
    for f in 0..mesh.facets.len() {
        let [a, b, c] = mesh.facet(f).corners_m;
        let (e1, e2) = (b - a, c - a);
        let p = ray.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            continue;
        }
        let t = from - a;
        let u = t.dot(p) / det;
        let q = t.cross(e1);
        let (v, way) = (ray.dot(q) / det, e2.dot(q) / det);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && way > 1e-9 && first.is_none_or(|(nearest, ..)| way < nearest) {
            first = Some((way, f, det > 0.0));
        }
    }
    first
}

#[test]
fn rays_to_every_facet_find_the_same_light() {
    let ground = grid(10.0, 12, |x, y| 2.0 * (0.7 * x).sin() * (0.5 * y).cos() + 0.5 * (1.3 * x - 0.9 * y).sin());
    let all = joined(&[ground, cuboid([-1.0, -1.0, 1.0], [1.0, 1.5, 4.0])]);
    let exchange = Exchange { bounces: 1, directions: 1024, lines_per_facet: 16384 };
    let scene = with_exchange(all.clone(), [1.0, 0.3, 0.7], exchange, |_| {});
    let table = solve(&scene, &unwatched).unwrap();
    let (sun, towards_sun) = (&table.sources[0], scene.sky.sun.direction.vec());
    let mut noise = Random(7);
    let (mut all_got, mut all_expected, mut some) = (0.0, 0.0, 0);
    for f in (0..all.facets.len()).step_by(13) {
        let facet = all.facet(f);
        let normal = facet.normal();
        let (h, v) = direction(normal.to_array()).frame();
        let mut sum = 0.0;
        const RAYS: u32 = 4096;
        for k in 0..RAYS {
            // Cosine-weighted directions from points all over the facet.
            let (s, turn) = ((f64::from(k) + noise.share()) / f64::from(RAYS), 2.0 * PI * noise.share());
            let ray = s.sqrt() * (turn.cos() * h + turn.sin() * v) + (1.0 - s).sqrt() * normal;
            let (mut a, mut b) = (noise.share(), noise.share());
            if a + b > 1.0 {
                (a, b) = (1.0 - a, 1.0 - b);
            }
            let from = facet.point_m(a, b);
            if let Some((way, met, true)) = first_met(&all, from, ray)
                && sun.irradiance[met] > 0.0
                && first_met(&all, from + way * ray, towards_sun).is_none()
            {
                sum += sun.irradiance[met];
            }
        }
        // The albedo is 0.07.
        let (got, expected) = (over_sunlight(&scene, &table, f, 1.0) / 0.07, sum / f64::from(RAYS));
        all_got += got;
        all_expected += expected;
        some += 1;
        assert!((got - expected).abs() < 0.15 * expected + 5e-3, "{f}: {got}, not {expected}");
    }
    assert!(some > 15 && all_expected > 0.1);
    assert_near("all", all_got, all_expected, 2e-2);
}

/// Of a Sun or a lamp of which only the irradiance in the bands is known, nothing is known of all its light; it is reflected as often.
#[test]
fn light_without_a_total_is_reflected_as_often() {
    let table = |total_w_m2: f64, bounces: u32| {
        let exchange = Exchange { bounces, directions: 64, lines_per_facet: 256 };
        let scene = with_exchange(corner(), [1.0, 0.0, 1.0], exchange, |parts| {
            parts.surface.materials =
                vec![lambert(0, "ground", Spectrum::constant(0.9)), lambert(1, "wall", Spectrum::constant(0.8))];
            parts.sky.sun.total_irradiance_1au_w_m2 = total_w_m2;
        });
        solve(&scene, &unwatched).unwrap()
    };
    let (known, unknown, fewer) = (table(1361.0, 3), table(0.0, 3), table(0.0, 2));
    let light = |table: &FacetTable| table.reflected[0].irradiance[0];
    assert!(light(&unknown) > 1.005 * light(&fewer), "{} {}", light(&unknown), light(&fewer));
    assert_eq!(known.reflected, unknown.reflected);
}

/// A lamp without a total under a Sun that has one, and is down: what is left after a bounce is left of the lamp's light.
#[test]
fn light_without_a_total_is_reflected_as_often_beside_a_known_sun() {
    let light = |bounces: u32| {
        let exchange = Exchange { bounces, directions: 64, lines_per_facet: 256 };
        let scene = with_exchange(corner(), [0.0, 0.0, -1.0], exchange, |parts| {
            parts.surface.materials =
                vec![lambert(0, "ground", Spectrum::constant(0.9)), lambert(1, "wall", Spectrum::constant(0.8))];
            let (name, irradiance) = ("lamp".to_owned(), Spectrum::constant(100.0));
            let direction = direction([1.0, 0.0, 1.0]);
            parts.sky.beams = vec![Beam { name, direction, irradiance, total_irradiance_w_m2: 0.0 }];
        });
        assert!(scene.sky.sun.total_irradiance_w_m2() > 0.0);
        solve(&scene, &unwatched).unwrap().reflected[0].irradiance[0]
    };
    let [one, two, three] = [1, 2, 3].map(light);
    assert!(one > 1.0 && two > 1.02 * one && three > 1.005 * two, "{one} {two} {three}");
}

/// Light by way of others and sunlight, each a sum over area, of patches of a site: columns over squares twice as wide as a facet's, if they are mostly full.
fn of_patches(scene: &Scene, table: &FacetTable) -> Vec<[f64; 2]> {
    let mesh = &scene.body.mesh;
    let areas_m2: Vec<f64> = (0..mesh.facets.len()).map(|f| mesh.facet(f).area_m2()).collect();
    let edge_m = 2.0 * (areas_m2.iter().sum::<f64>() / areas_m2.len() as f64).sqrt();
    let (low_m, _) = mesh.bounds_m().unwrap();
    let mut patches: std::collections::BTreeMap<[i64; 3], [f64; 3]> = Default::default();
    for (f, area_m2) in areas_m2.iter().enumerate() {
        let at = ((mesh.facet(f).centroid_m() - low_m) / edge_m).to_array().map(|x| x.floor() as i64);
        let seen = table.sunlit().unwrap().fraction(f as u32);
        let patch = patches.entry(at).or_default();
        patch[0] += area_m2 * over_sunlight(scene, table, f, 1.0);
        patch[1] += area_m2 * table.sources[0].irradiance[f] * seen;
        patch[2] += area_m2;
    }
    let full = patches.into_values().filter(|patch| patch[2] > 0.25 * edge_m * edge_m);
    full.map(|[received, sunlit, area_m2]| [received / area_m2, sunlit]).collect()
}

#[test]
fn the_error_by_sampling_is_told() {
    // Against four and more times as many directions and lines; one bounce, since the error is of the first.
    let ground = || grid(40.0, 48, |x, y| 3.0 * (0.4 * x).sin() * (0.3 * y).cos() + (0.9 * x - 0.7 * y).sin());
    let solved = |directions: u32, lines_per_facet: u32| {
        let exchange = Exchange { bounces: 1, directions, lines_per_facet };
        let scene = with_exchange(ground(), [1.0, 0.2, 0.4], exchange, |_| {});
        let table = solve(&scene, &unwatched).unwrap();
        (of_patches(&scene, &table), table.sampling.unwrap())
    };
    let (truth, _) = solved(1024, 8192);
    for (directions, lines) in [(128, 512), (256, 2048)] {
        let (patches, told) = solved(directions, lines);
        assert_eq!(patches.len(), truth.len());
        for (is_lit, told) in [(true, told.lit.unwrap()), (false, told.shadow.unwrap())] {
            let of = || patches.iter().zip(&truth).filter(|(patch, _)| (patch[1] > 0.0) == is_lit);
            let (off, all) = of().fold((0.0, 0.0), |(off, all), ([got, _], [expected, _])| {
                (off + (got - expected).powi(2), all + expected.powi(2))
            });
            let (rms, patches) = (f64::sqrt(off / all), of().count());
            assert!(patches > 50, "{patches}");
            assert!(told.rms > 0.6 * rms && told.rms < 1.8 * rms, "{directions} {is_lit}: {told:?}, not {rms}");
            assert!(told.p50 > 0.2 * rms && told.p50 < 2.0 * rms, "{directions} {is_lit}: {told:?}, not {rms}");
        }
    }
    // More lines, less error.
    let shadow = |directions: u32, lines: u32| solved(directions, lines).1.shadow.unwrap().rms;
    assert!(shadow(256, 2048) < 0.7 * shadow(64, 512));
}

#[test]
fn what_is_convex_has_nothing_to_exchange() {
    let scene = with_exchange(cuboid([0.0; 3], [1.0, 2.0, 3.0]), [1.0, 1.0, 1.0], Exchange::default(), |parts| {
        parts.models.thermal = Thermal::Equilibrium;
    });
    let (table, _) = study::simulate(&scene, &unwatched).unwrap();
    assert!(table.reflected.is_empty() && table.temperature_lit_k.iter().any(|t_k| *t_k > 100.0));
    // A needle, whose lattice would have no end.
    let needle = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-13, 0.0]], &[[0, 1, 2], [0, 2, 1]]);
    assert_eq!(factors(&needle, &[0..1, 1..2], 32), vec![vec![0.0; 2]; 2]);
}

/// A rough site with shadows, of two materials, with heat.
fn rough() -> Scene {
    let ground = grid(20.0, 24, |x, y| 3.0 * (0.4 * x).sin() * (0.3 * y).cos() + (0.9 * x - 0.7 * y).sin());
    let all = joined(&[ground, of_material(cuboid([-2.0, -2.0, 0.0], [2.0, 3.0, 6.0]), 1)]);
    let exchange = Exchange { bounces: 3, directions: 48, lines_per_facet: 256 };
    with_exchange(all, [1.0, 0.2, 0.4], exchange, |parts| {
        parts.models.thermal = Thermal::Equilibrium;
        let red = Spectrum::new(vec![0.9, 4.0], vec![0.06, 0.12], Extend::Error).unwrap();
        parts.surface.materials = vec![lambert(0, "red", red), lambert(1, "grey", Spectrum::constant(0.3))];
    })
}

#[test]
fn the_order_of_facets_makes_no_difference() {
    let scene = rough();
    let table = solve(&scene, &unwatched).unwrap();
    let count = table.facets();
    // 577 is prime to the number of facets.
    let order: Vec<usize> = (0..count).map(|i| i * 577 % count).collect();
    let mut parts = scene.clone().into_parts();
    let mesh = &scene.body.mesh;
    parts.surface.mesh.facets = order.iter().map(|f| mesh.facets[*f]).collect();
    parts.surface.mesh.material = order.iter().map(|f| mesh.material[*f]).collect();
    parts.surface.mesh.face_of_facet = vec![];
    let other = solve(&parts.check().unwrap(), &unwatched).unwrap();
    assert_eq!(table.reflected.len(), other.reflected.len());
    let mut light = 0.0;
    for (one, other) in table.reflected.iter().zip(&other.reflected) {
        assert_eq!((one.um, &one.parts), (other.um, &other.parts));
        for (i, f) in order.iter().enumerate() {
            assert!((one.irradiance[*f] - other.irradiance[i]).abs() < 1e-9, "{f}");
            light += other.irradiance[i];
        }
    }
    assert!(light > 1.0);
    for (i, f) in order.iter().enumerate() {
        assert!((table.temperature_shaded_k[*f] - other.temperature_shaded_k[i]).abs() < 1e-9);
    }
}

#[test]
fn any_number_of_threads_and_a_table_on_the_disk_give_the_same() {
    let scene = rough();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&scene, &unwatched).unwrap())
    };
    let table = on(1);
    assert_eq!(table, on(2));
    assert!(!table.reflected.is_empty());
    let scratch = Scratch::new();
    let path = scratch.path().join("table.npz");
    npz::write_table(&path, &table, "rough").unwrap();
    let (read, header) = npz::read_table(&path).unwrap();
    assert_eq!((&read, header.format_version, header.reflected.len()), (&table, 3, table.reflected.len()));
    // A scene that asks for nothing takes what its table has.
    let without =
        Scene::new(mmxrt::scene::Setup { models: Models { exchange: None, ..scene.models }, ..(*scene).clone() })
            .unwrap();
    let image = |scene: &Scene, table: &FacetTable| study::observe(scene, table, Wanted::default(), &unwatched);
    let (one, other) = (image(&scene, &table).unwrap(), image(&without, &read).unwrap());
    assert_eq!(one.cube.band(0), other.cube.band(0));
    assert_ne!(study::table_id(&scene), study::table_id(&without));
}
