//! Mars before the Sun: less sunlight, and from what is left of the disc.

use mmxrt::geometry::Direction;
use mmxrt::physics::reflectance::Preset;
use mmxrt::physics::reflectance::albedo::Measure;
use mmxrt::physics::sun_disc::{DiscRule, share_beside_sphere, share_beyond_edge};
use mmxrt::product::FacetTable;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Globe, MarsModel, Model, Photometry, Scene, SunModel, Thermal};
use mmxrt::solve;
use mmxrt::spectral::Spectrum;
use mmxrt::study;
use mmxrt::units::{AU_M, SUN_RADIUS_M};

use crate::scenes::{edited, mars, scene};
use crate::shapes::{camera, cuboid, grid, joined, nadir, of_material, plane};

const DISTANCE_M: f64 = 1.523_679 * AU_M;
const MARS_M: f64 = 9_376_000.0;

/// Mars whose limb is this many radii of the Sun short of its middle, on the side of -y. It sends no light of its own, being black.
fn before(scene: &Scene, beyond: f64) -> Scene {
    let sun = scene.sky.sun.direction;
    let (u, (h, v)) = (sun.vec(), sun.frame());
    let off = (3_389_500.0 / MARS_M).asin() + beyond * (SUN_RADIUS_M / DISTANCE_M).asin();
    let side = 0.6 * h + 0.8 * v;
    edited(scene, |parts| {
        parts.sky.sun.distance_m = DISTANCE_M;
        let centre_m = MARS_M * (off.cos() * u + off.sin() * side);
        parts.sky.mars = Some(Globe { reflectance: mmxrt::spectral::Spectrum::constant(0.0), ..mars(centre_m) });
        parts.models.eclipses = true;
    })
}

fn radiance(scene: &Scene) -> Vec<f64> {
    study::simulate(scene, &unwatched).unwrap().1.cube.band(0)
}

#[test]
fn a_site_has_the_sunlight_that_mars_leaves() {
    let ground = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [0.3, 0.2, 0.9]);
    let free = edited(&before(&ground, 0.0), |parts| parts.models.eclipses = false);
    let full = radiance(&free)[0];
    for (beyond, limb_darkening) in [(1.1, 0.0), (0.5, 0.0), (0.0, 0.0), (-0.5, 0.6), (0.25, 1.0), (-1.1, 0.3)] {
        let darkened = edited(&before(&ground, beyond), |parts| parts.sky.sun.limb_darkening = limb_darkening);
        // Seen from here the limb of Mars, 130 times as large as the Sun, is nearly straight.
        let expected = share_beyond_edge(beyond, limb_darkening);
        for model in [SunModel::Point, SunModel::Disc(DiscRule::G3), SunModel::Disc(DiscRule::G7)] {
            let lit = edited(&darkened, |parts| parts.models.sun = model);
            let got = radiance(&lit);
            assert!(
                got.iter().all(|l| (l / full - expected).abs() < 3e-3),
                "{beyond} {limb_darkening} {model:?}: {got:?} {full} {expected}"
            );
            assert!(expected > 0.0 && expected < 1.0 || got.iter().all(|l| (l / full - expected).abs() < 1e-14));
        }
    }
    let told = |scene: &Scene| study::simulate(scene, &unwatched).unwrap().1.warnings.join("\n");
    assert!(told(&before(&ground, -2.0)).contains("in eclipse: Mars covers the Sun"));
    assert!(!told(&before(&ground, -2.0)).contains("as if it did not"));
    assert!(told(&edited(&before(&ground, -2.0), |parts| parts.models.eclipses = false)).contains("as if it did not"));
    assert_ne!(study::table_id(&before(&ground, 0.0)), study::table_id(&free));
}

/// What a surface with a model absorbs goes by the incidence of the light, not by how much of it there is: its temperature to the fourth power is the share.
#[test]
fn a_surface_with_a_model_absorbs_its_share() {
    let ground = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [0.3, 0.2, 0.9]);
    let bright = edited(&ground, |parts| {
        parts.models.thermal = Thermal::Equilibrium;
        let material = &mut parts.surface.materials[0];
        let reflectance = Spectrum::constant(0.5);
        let shape = Preset::Moon.known().shape.unwrap();
        let model = Model::measured(shape, &reflectance, &Measure::Spherical).unwrap();
        (material.photometry, material.reflectance, material.bond_albedo) =
            (Photometry::Model(Box::new(model)), reflectance, 0.5);
    });
    let lit_k = |scene: &Scene| solve::solve(scene, &unwatched).unwrap().temperature_lit_k[0];
    for beyond in [0.5, 0.0, -0.5, -0.8] {
        let dark = edited(&before(&bright, beyond), |parts| {
            parts.sky.mars.as_mut().unwrap().thermal_exitance_w_m2 = 0.0;
        });
        let free_k = lit_k(&edited(&dark, |parts| parts.models.eclipses = false));
        let share = share_beyond_edge(beyond, 0.0);
        let got = (lit_k(&dark) / free_k).powi(4);
        assert!(free_k > 200.0 && (got / share - 1.0).abs() < 0.02, "{beyond}: {got} {share}");
    }
}

/// The shadow of Mars is as wide as the moon: 57 km from light to dark. Rays to points of the Sun are counted, facet by facet.
#[test]
fn each_facet_has_an_eclipse_of_its_own() {
    let ground = scene(grid(20_000.0, 6, |_, _| 0.0), nadir(1e6, 4e4, 4), [0.0, 0.0, 1.0]);
    let half = before(&ground, 0.1);
    let table = solve::solve(&half, &unwatched).unwrap();
    let (centre_m, sun) = (half.sky.mars.as_ref().unwrap().centre_m, half.sky.sun.direction);
    let (u, (h, v)) = (sun.vec(), sun.frame());
    let mut shares = Vec::new();
    for (facet, got) in table.sources[0].irradiance.iter().enumerate() {
        let from_m = half.body.mesh.facet(facet).centroid_m();
        let (mut all, mut free) = (0.0, 0.0);
        for i in 0..120 {
            for k in 0..240 {
                let r = (f64::from(i) + 0.5) / 120.0;
                let (sin, cos) = (std::f64::consts::PI * f64::from(k) / 120.0).sin_cos();
                let ray = (u + SUN_RADIUS_M / DISTANCE_M * r * (cos * h + sin * v)).normalize();
                all += r;
                free += if ray.cross(centre_m - from_m).length() > 3_389_500.0 { r } else { 0.0 };
            }
        }
        assert!((got - free / all).abs() < 5e-3, "{facet}: {got} {}", free / all);
        shares.push(*got);
    }
    let (low, high) = shares.iter().fold((1.0_f64, 0.0_f64), |(low, high), s| (low.min(*s), high.max(*s)));
    assert!(high - low > 0.3 && low > 0.0, "{low} {high}");
}

/// What of the disc Mars hides casts no light, and so no penumbra: a sum over the points that are left.
#[test]
fn light_comes_from_what_is_left_of_the_disc() {
    let hills = grid(10.0, 16, |x, y| 0.6 * (0.7 * x).sin() * (0.5 * y).cos());
    let mesh = of_material(joined(&[hills, cuboid([-3.0, -2.0, -1.0], [0.0, 1.0, 4.0])]), 0);
    let view = camera([20.0, -30.0, 40.0], [0.0; 3], [0.0, 0.0, 1.0], 32, 0.01);
    let half = before(&scene(mesh, view, [0.8, 0.2, 1.0]), 0.05);
    let rule = DiscRule::G12;
    let disc = edited(&half, |parts| parts.models.sun = SunModel::Disc(rule));
    let got = radiance(&disc);
    let (sun, centre_m) = (half.sky.sun.direction, half.sky.mars.as_ref().unwrap().centre_m);
    let (u, (h, v)) = (sun.vec(), sun.frame());
    let share = share_beyond_edge(0.05, 0.0);
    let (mut expected, mut left, mut hidden) = (vec![0.0; got.len()], 0.0, 0);
    for [x, y, weight] in rule.points() {
        let [x, y] = [x, y].map(|p| p * SUN_RADIUS_M / DISTANCE_M);
        let towards = u + (x * h + y * v) / (1.0 - x * x - y * y).sqrt();
        if towards.normalize().cross(centre_m).length() < 3_389_500.0 {
            hidden += 1;
            continue;
        }
        left += weight;
        let point = edited(&half, |parts| {
            parts.sky.sun.direction = Direction::new(towards).unwrap();
            parts.models.eclipses = false;
        });
        expected.iter_mut().zip(radiance(&point)).for_each(|(sum, l)| *sum += weight * l);
    }
    assert!(hidden > 3 && hidden < 9, "{hidden}");
    let largest = expected.iter().copied().fold(0.0, f64::max) / left * share;
    let off = |(got, expected): (&f64, &f64)| (got - expected / left * share).abs() / largest;
    // The limb of Mars is not quite straight; and of light from one side of the disc the cosine is that of its middle.
    let worst = got.iter().zip(&expected).map(off).fold(0.0, f64::max);
    assert!(worst < 6e-3, "{worst}");
    let as_if_whole = radiance(&edited(&disc, |parts| parts.models.eclipses = false));
    assert!(got.iter().zip(&as_if_whole).map(|(a, b)| (a - share * b).abs() / largest).fold(0.0, f64::max) > worst);
}

/// A black Mars by the thesis's equations hides the Sun as well; a body beside the Sun or behind the site hides nothing.
#[test]
fn nothing_else_is_changed() {
    let ground = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [0.3, 0.2, 0.9]);
    for beyond in [1.001, 40.0, 900.0] {
        let lit = before(&ground, beyond);
        let without = edited(&lit, |parts| parts.models.eclipses = false);
        let table = FacetTable { models: without.models, ..solve::solve(&lit, &unwatched).unwrap() };
        assert_eq!(table, solve::solve(&without, &unwatched).unwrap());
    }
    let thesis = edited(&before(&ground, -3.0), |parts| parts.models.mars_light = MarsModel::Thesis);
    assert!(radiance(&thesis).iter().all(|l| *l == 0.0));
}

/// Over a facet of kilometres the edge of the shadow passes: what its corners see is within what is told.
#[test]
fn what_a_large_facet_leaves_out_is_told() {
    // 2/3 of a median of 11.18 m, 8742 km from the limb, over the Sun's 3.05 mrad and times 2 / pi: 1.8e-4; and 1e-3 of a flat disc.
    for (half_m, least, most) in [(5.0, 1.17e-3, 1.19e-3), (5e3, 0.17, 0.19)] {
        let ground = before(&scene(plane(half_m, 0.0), nadir(1000.0, 8.0, 2), [0.3, 0.2, 0.9]), 0.2);
        let extremes = study::Extremes::new(&ground);
        let request = study::Request { choice: study::Choice::Full, tolerance: 1e-3 };
        let (_, plan) = study::plan(&ground, &extremes, &request).unwrap();
        let told = plan.effects.iter().find(|effect| effect.key == "eclipse").unwrap().remaining.unwrap().most();
        assert!(told > least && told < most, "{half_m}: {told}");
        let (sun, globe) = (&ground.sky.sun, ground.sky.mars.as_ref().unwrap());
        let share = |place_m: glam::DVec3| {
            let to_centre_m = globe.centre_m - place_m;
            share_beside_sphere(sun.direction.vec(), sun.sin_radius(), sun.limb_darkening, to_centre_m, globe.radius_m)
        };
        for f in 0..ground.body.mesh.facets.len() {
            let facet = ground.body.mesh.facet(f);
            for corner_m in facet.corners_m {
                let error = (share(corner_m) - share(facet.centroid_m())).abs();
                assert!(error <= told, "{half_m} {corner_m}: {error} {told}");
            }
        }
    }
}
