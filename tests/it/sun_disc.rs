//! The Sun's disc: penumbrae and terminators, against closed forms, sums over the disc, and images under many points.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::geometry::{Direction, FrameCamera, Mesh};
use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Scene, SceneParts, SunModel, Thermal};
use mmxrt::study::{Extremes, Request};
use mmxrt::units::{AU_M, SUN_RADIUS_M};
use mmxrt::{formats::npz, integrate::Wanted, study};

use crate::scenes::{edited, scene};
use crate::shapes::{camera, cuboid, grid, joined, nadir, of_material, plane, quad};

const DISTANCE_M: f64 = 1.523_679 * AU_M;

/// Sine of the disc's radius.
fn radius() -> f64 {
    SUN_RADIUS_M / DISTANCE_M
}

/// The same scene under a disc.
fn with_disc(scene: &Scene, rule: DiscRule, limb_darkening: f64) -> Scene {
    edited(scene, |parts| {
        parts.sky.sun.distance_m = DISTANCE_M;
        parts.sky.sun.limb_darkening = limb_darkening;
        parts.models.sun = SunModel::Disc(rule);
    })
}

/// The same under a point of the disc, x and y radii from its middle.
fn under_point(scene: &Scene, x: f64, y: f64) -> Scene {
    edited(scene, |parts| {
        let (u, (h, v)) = (parts.sky.sun.direction.vec(), parts.sky.sun.direction.frame());
        let (x, y) = (radius() * x, radius() * y);
        let towards = (1.0 - x * x - y * y).sqrt() * u + x * h + y * v;
        parts.sky.sun.direction = Direction::new(towards).unwrap();
        parts.sky.sun.distance_m = DISTANCE_M;
    })
}

fn radiance(scene: &Scene) -> Vec<f64> {
    study::simulate(scene, &unwatched).unwrap().1.cube.band(0)
}

/// What a grey plane of the test scenes sends back of light that meets it at normal incidence.
fn facing() -> f64 {
    0.07 / PI * 700.0 * (AU_M / DISTANCE_M).powi(2)
}

/// Sums over a disc by a rule that is none of the product's: rings of equal width, 7 i + 3 points each.
fn over_disc(rings: u32, limb_darkening: f64, value: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for i in 0..rings {
        let r = (f64::from(i) + 0.5) / f64::from(rings);
        let points = 7 * i + 3;
        let weight = r / f64::from(points) * (1.0 - limb_darkening * (1.0 - (1.0 - r * r).sqrt()));
        for k in 0..points {
            let (sin, cos) = (2.0 * PI * (f64::from(k) + 0.37 * f64::from(i)) / f64::from(points)).sin_cos();
            sum += weight * value(r * cos, r * sin);
            all += weight;
        }
    }
    sum / all
}

#[test]
fn ground_is_lit_until_the_last_of_the_disc_has_set() {
    let low = |radii: f64| (radii * radius().asin()).sin_cos();
    for rule in [DiscRule::G3, DiscRule::G7, DiscRule::E37] {
        // Over the irradiance at normal incidence, at 1.523679 au, of a uniform disc: computed independently.
        for (radii, expected) in [
            (-1.0, 0.0),
            (-0.5, 0.000_122_335_022_11),
            (0.0, 0.000_647_684_033_82),
            (1.0, 0.003_052_130_574),
            (3.0, 0.009_156_277_99),
        ] {
            let (sin, cos) = low(radii);
            let ground = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [0.6 * cos, 0.8 * cos, sin]);
            let lit = with_disc(&ground, rule, 0.0);
            assert!(radiance(&lit).iter().all(|l| (l / facing() - expected).abs() < 1e-9), "{rule:?} {radii}");
        }
    }
    // With limb darkening 1 the horizon halves the light, but what is up is lower: 3 s / 16 instead of 2 s / (3 pi).
    let ground = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [1.0, 0.0, 0.0]);
    let (_, seen) = study::simulate(&with_disc(&ground, DiscRule::G7, 1.0), &unwatched).unwrap();
    for (pixel, l) in seen.cube.band(0).iter().enumerate() {
        assert!((l / facing() / radius() - 3.0 / 16.0).abs() < 1e-12);
        assert_eq!(seen.backplanes.plane("LIT_FRACTION").unwrap().values[pixel], 1.0);
    }
}

/// Behind a straight edge 12 m high, across and oblique to the light: the light of each strip of ground, against a sum over the disc.
#[test]
fn penumbrae_behind_a_straight_edge() {
    let (height, incidence) = (12.0_f64, 60f64.to_radians());
    let wall = quad([0.0, -200.0, 0.0], [0.0, 200.0, 0.0], [0.0, 200.0, height], [0.0, -200.0, height]);
    let ground = joined(&[plane(100.0, 0.0), wall]);
    for (azimuth, limb_darkening) in [(0.0_f64, 0.0), (0.0, 0.6), (0.7, 0.15)] {
        let towards = [incidence.sin() * azimuth.cos(), incidence.sin() * azimuth.sin(), incidence.cos()];
        let edge_x = -height * incidence.tan() * azimuth.cos();
        // Some 0.3 m of penumbra in pixels of 4 cm.
        let view = camera([edge_x, 0.0, 1000.0], [edge_x, 0.0, 0.0], [0.0, 1.0, 0.0], 16, 4e-5);
        let point = scene(of_material(ground.clone(), 0), view, towards);
        let sun = Direction::new(DVec3::from_array(towards)).unwrap();
        let (u, (h, v)) = (sun.vec(), sun.frame());
        let strip = |column: u32| {
            let samples = 40;
            let at = |i: u32| edge_x + 0.04 * (f64::from(column) - 8.0 + (f64::from(i) + 0.5) / f64::from(samples));
            let light = |x: f64| {
                over_disc(60, limb_darkening, |p, q| {
                    let t = u + radius() * (p * h + q * v);
                    if t.z / t.x > height / -x { t.z } else { 0.0 }
                })
            };
            (0..samples).map(|i| light(at(i))).sum::<f64>() / f64::from(samples)
        };
        let expected: Vec<f64> = (0..16).map(strip).collect();
        assert!(
            expected[0] > 0.499
                && expected[15] == 0.0
                && (2..14).filter(|i| expected[*i] > 0.02 && expected[*i] < 0.48).count() > 4,
            "{expected:?}"
        );
        let mut worst_before = f64::INFINITY;
        for rule in [DiscRule::G1, DiscRule::G7, DiscRule::E37] {
            let got = radiance(&with_disc(&point, rule, limb_darkening));
            // Of a strip as wide as a pixel, square to the light.
            let wide = 0.04 * incidence.cos() * azimuth.cos();
            let bound = rule.edge_error() * 2.0 * radius() * height / incidence.cos() / wide * incidence.cos() + 1e-3;
            let off = |i: usize| (got[i] / facing() - expected[i % 16]).abs();
            let worst = (0..256).map(off).fold(0.0, f64::max);
            assert!(
                worst < bound.min(worst_before),
                "{rule:?}, azimuth {azimuth}, u {limb_darkening}: {worst} {bound}"
            );
            worst_before = worst;
        }
    }
}

/// Hills and boxes, seen askance.
fn site(towards_sun: [f64; 3]) -> Scene {
    let hills = grid(10.0, 24, |x, y| (0.7 * x).sin() * (0.5 * y).cos());
    let mesh = joined(&[hills, cuboid([-3.0, -2.0, -1.0], [0.0, 1.0, 4.0]), cuboid([2.0, 3.0, -1.0], [3.0, 6.0, 3.0])]);
    scene(of_material(mesh, 0), camera([20.0, -30.0, 40.0], [0.0; 3], [0.0, 0.0, 1.0], 40, 0.008), towards_sun)
}

/// Light adds up: under a disc a scene is the sum of what it is under each of its points.
#[test]
fn a_disc_is_the_sum_of_its_points() {
    let point = site([0.8, 0.2, 1.0]);
    for (rule, limb_darkening) in [(DiscRule::G3, 0.0), (DiscRule::G7, 0.6), (DiscRule::G12, 0.2)] {
        let got = radiance(&with_disc(&point, rule, limb_darkening));
        let mut expected = vec![0.0; got.len()];
        for [x, y, share] in rule.darkened_points(limb_darkening) {
            let (x_, y_) = (radius() * x, radius() * y);
            // A part of a disc that faces a plane is as bright as the middle, though it is farther from the normal.
            let per_cos = share / (1.0 - x_ * x_ - y_ * y_).sqrt();
            let of_point = radiance(&under_point(&point, x, y));
            expected.iter_mut().zip(of_point).for_each(|(sum, l)| *sum += per_cos * l);
        }
        let mixed = with_disc(&point, rule, 0.0);
        let (table, _) = study::simulate(&mixed, &unwatched).unwrap();
        assert!(table.sunlit().unwrap().polygon_share.len() > 100);
        let largest = expected.iter().copied().fold(0.0, f64::max);
        for (i, (got, expected)) in got.iter().zip(&expected).enumerate() {
            assert!((got - expected).abs() < 1e-12 * largest, "{rule:?} {i}: {got} {expected}");
        }
    }
}

/// Judged by the mean of images under hundreds of points, by another rule, each with a sharp shadow: pixels of 0.1 m at the edge of
/// the shadows of a block and a roof.
#[test]
fn more_points_come_nearer_to_the_disc() {
    let roof = quad([-0.5, -3.0, 2.0], [-0.5, 3.0, 2.0], [0.4, 2.0, 4.5], [0.4, -2.0, 4.5]);
    let mesh = of_material(joined(&[plane(80.0, 0.0), cuboid([-1.0, -1.0, 0.0], [1.0, 1.5, 4.0]), roof]), 0);
    for (incidence_deg, pixels) in [(60.0_f64, 10), (85.0, 16)] {
        let (sin, cos) = incidence_deg.to_radians().sin_cos();
        // The farther of the corners of the two shadows.
        let corners = [[-1.0 - 4.0 * sin / cos, 1.5], [0.4 - 4.5 * sin / cos, 2.0]];
        let [x, y] = if corners[0][0] < corners[1][0] { corners[0] } else { corners[1] };
        let view = camera([x, y, 1000.0], [x, y, 0.0], [0.0, 1.0, 0.0], pixels, 1e-4);
        let point = scene(mesh.clone(), view, [sin, 0.0, cos]);
        let mut truth = vec![0.0; (pixels * pixels) as usize];
        let mut all = 0.0;
        let rings = 9;
        for i in 0..rings {
            let (r, points) = ((f64::from(i) + 0.5) / f64::from(rings), 7 * i + 3);
            for k in 0..points {
                let (y, x) = (2.0 * PI * (f64::from(k) + 0.37 * f64::from(i)) / f64::from(points)).sin_cos();
                let weight = r / f64::from(points);
                let image = radiance(&under_point(&point, r * x, r * y));
                truth.iter_mut().zip(image).for_each(|(sum, l)| *sum += weight * l);
                all += weight;
            }
        }
        truth.iter_mut().for_each(|l| *l /= all);
        let lit = facing() * cos;
        assert!(truth.iter().filter(|l| **l > 0.03 * lit && **l < 0.97 * lit).count() > 5);
        let mut before = f64::INFINITY;
        for rule in [DiscRule::G1, DiscRule::G7, DiscRule::E37] {
            let got = radiance(&with_disc(&point, rule, 0.0));
            let worst = got.iter().zip(&truth).map(|(a, b)| (a - b).abs() / lit).fold(0.0, f64::max);
            let bound = std::f64::consts::SQRT_2 * rule.edge_error() * radius() * (4.5 / cos) / 0.1 / cos;
            // Two edges cross some pixels.
            assert!(worst < 2.0 * bound && worst < 0.5 * before, "{incidence_deg} {rule:?}: {worst} {bound} {before}");
            before = worst;
        }
        assert!(before < 0.04, "{before}");
    }
}

/// The Sun at the zenith, walls along the rays: half of the disc is beyond each, and none of it casts a sharp shadow.
#[test]
fn walls_along_the_rays_see_half_of_the_disc() {
    let block = joined(&[plane(8.0, 0.0), cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0])]);
    let side = camera([0.0, -1000.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], 4, 2.5e-4);
    let lit = with_disc(&scene(of_material(block, 0), side, [0.0, 0.0, 1.0]), DiscRule::G7, 0.0);
    let seen = radiance(&lit);
    // 2 s / (3 pi) on all of the wall.
    assert!(seen.iter().all(|l| (l / facing() - 0.000_647_684_033_82).abs() < 1e-9), "{seen:?}");
    let (_, seen) = study::simulate(&lit, &unwatched).unwrap();
    assert!(seen.backplanes.plane("LIT_FRACTION").unwrap().values.iter().all(|lit| (lit - 1.0).abs() < 1e-12));
}

#[test]
fn one_point_is_the_point_sun_where_the_disc_is_up() {
    let point = edited(&site([0.8, 0.2, 1.0]), |parts| parts.sky.sun.distance_m = DISTANCE_M);
    let (a, b) = (radiance(&point), radiance(&with_disc(&point, DiscRule::G1, 0.0)));
    let largest = a.iter().copied().fold(0.0, f64::max);
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12 * largest));
}

#[test]
fn tables_keep_penumbrae_and_threads_change_nothing() {
    let scratch = crate::scratch::Scratch::new();
    let path = scratch.join("table.npz");
    let lit = edited(&with_disc(&site([0.8, 0.2, 0.3]), DiscRule::G7, 0.3), |parts| {
        parts.models.thermal = Thermal::Equilibrium
    });
    let in_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| study::simulate(&lit, &unwatched).unwrap())
    };
    let (table, seen) = in_threads(1);
    let (other, seen_by_three) = in_threads(3);
    assert!(table == other && seen.cube.band(0) == seen_by_three.cube.band(0));
    npz::write_table(&path, &table, "s").unwrap();
    let (read, header) = npz::read_table(&path).unwrap();
    assert_eq!((header.format_version, read == table), (3, true));
    let again = study::observe(&lit, &read, Wanted::default(), &unwatched).unwrap();
    assert_eq!(again.cube.band(0), seen.cube.band(0));
    // A share that cannot be is refused, by file and by value.
    let mut odd = table;
    let mmxrt::product::Sees::Polygons(sunlit) = &mut odd.sources[0].sees else { panic!() };
    sunlit.polygon_share[2] = 1.5;
    npz::write_table(&path, &odd, "s").unwrap();
    let error = npz::read_table(&path).unwrap_err().to_string();
    assert!(error.contains("sun_polygon_share[2]: 1.5 is not a share"), "{error}");
    let mmxrt::product::Sees::Polygons(sunlit) = &mut odd.sources[0].sees else { panic!() };
    sunlit.polygon_share.pop();
    let error = study::observe(&lit, &odd, Wanted::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("polygons, but"), "{error}");
    let scenes = [lit.clone(), with_disc(&lit, DiscRule::G3, 0.3), with_disc(&lit, DiscRule::G7, 0.2)];
    let ids = scenes.each_ref().map(study::table_id);
    assert!(ids[0] != ids[1] && ids[0] != ids[2]);
}

/// In a penumbra the surface is in part as warm as in sunlight, and in part as cold as in shadow.
#[test]
fn penumbrae_are_warm_by_their_share_of_the_light() {
    let wall: Mesh = quad([0.0, -200.0, 0.0], [0.0, 200.0, 0.0], [0.0, 200.0, 12.0], [0.0, -200.0, 12.0]);
    let edge_x = -12.0;
    let view: FrameCamera = camera([edge_x, 0.0, 1000.0], [edge_x, 0.0, 0.0], [0.0, 1.0, 0.0], 8, 2e-5);
    let ground = scene(of_material(joined(&[plane(100.0, 0.0), wall]), 0), view, [1.0, 0.0, 1.0]);
    let warm = |parts: &mut SceneParts| {
        parts.models.thermal = Thermal::Equilibrium;
        parts.exposure.bands = vec![mmxrt::spectral::Band::new(8.0, None)];
        parts.exposure.bands[0].light = mmxrt::spectral::Light::Heat;
    };
    let lit = edited(&with_disc(&ground, DiscRule::G7, 0.0), warm);
    let (table, seen) = study::simulate(&lit, &unwatched).unwrap();
    let share = &seen.backplanes.plane("LIT_FRACTION").unwrap().values;
    let of_lit = mmxrt::physics::blackbody::radiance_w_m2_sr_um(8.0, table.temperature_lit_k[0]);
    assert!(share.iter().filter(|share| **share > 0.05 && **share < 0.95).count() > 20);
    for (l, share) in seen.cube.band(0).iter().zip(share) {
        assert!((l / (0.93 * of_lit) - share).abs() < 1e-7, "{l} {share}");
    }
}

/// Textures and maps count lit areas like all else.
#[test]
fn what_maps_do_not_know_is_in_penumbra_too() {
    let lit = with_disc(&site([0.8, 0.2, 0.3]), DiscRule::G7, 0.0);
    let own = radiance(&lit);
    let facets = lit.body.mesh.facets.len();
    let map = crate::maps::map(mmxrt::product::Placement::Facets(facets), vec![f64::NAN; facets]);
    let options = study::MapOptions { fill: study::Fill::Solved, ..study::MapOptions::default() };
    let (filled, _) = crate::maps::observe(&lit, vec![vec![map]], &options).unwrap();
    let largest = own.iter().copied().fold(0.0, f64::max);
    crate::partly_sky::assert_near(&filled.cube.band(0), &own, 1e-13 * largest);
    let textured = edited(&lit, |parts| {
        let mesh = &parts.surface.mesh;
        let corners =
            (0..mesh.facets.len()).map(|f| mesh.facet(f).corners_m.map(|p| [p.x + 10.0, p.y + 10.0])).collect();
        parts.surface.textures = vec![mmxrt::scene::Texture {
            material: mmxrt::geometry::MaterialId(0),
            kind: mmxrt::scene::TextureKind::Factor,
            corners,
            rows: 20,
            columns: 20,
            wavelength_um: vec![],
            values: vec![1.0; 400],
            texels: mmxrt::geometry::Texels::Nearest,
            lon_lat: None,
        }];
    });
    crate::partly_sky::assert_near(&radiance(&textured), &own, 1e-12 * largest);
}

/// The fewest points whose bound is within the tolerance, and a point Sun where nothing throws a shadow far enough to matter.
#[test]
fn points_are_chosen_by_a_tolerance() {
    let mesh = of_material(joined(&[plane(60.0, 0.0), cuboid([-1.0, -1.0, 0.0], [1.0, 1.5, 4.0])]), 0);
    let site =
        edited(&scene(mesh, nadir(1000.0, 40.0, 8), [0.866, 0.0, 0.5]), |parts| parts.sky.sun.distance_m = DISTANCE_M);
    // A block 4 m high under 60 deg: 8 m along the rays, and no more than the ground's facets are long beyond.
    let mut counts = Vec::new();
    for tolerance in [1.0, 1e-2, 3e-3, 1e-9] {
        // Edges have half of it.
        let request = Request { tolerance: 2.0 * tolerance, ..Request::default() };
        let (models, plan) = study::plan(&site, &Extremes::with_shadows(&site, &unwatched).unwrap(), &request).unwrap();
        let bound = plan.effects.iter().find(|effect| effect.key == "sun-disc").and_then(|effect| effect.own.clone());
        let bound = bound.unwrap().left;
        counts.push(match models.sun {
            SunModel::Point => 1,
            SunModel::Disc(rule) => rule.count(),
        });
        assert!(bound <= tolerance || tolerance == 1e-9, "{tolerance} {bound}");
        let least = std::f64::consts::SQRT_2 * 8.0 * radius() / 5.0 / 0.5;
        if let SunModel::Disc(rule) = models.sun {
            assert!(bound >= rule.edge_error() * least);
        }
    }
    assert!(counts[0] == 1 && counts.is_sorted() && counts[2] > 3 && counts[3] == 37, "{counts:?}");
}
