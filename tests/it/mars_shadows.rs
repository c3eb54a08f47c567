//! Terrain before Mars: against rays to many points of its lit disc.

use glam::DVec3;
use mmxrt::formats::npz;
use mmxrt::geometry::Mesh;
use mmxrt::integrate::Wanted;
use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::product::Sees;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Scene, Thermal};
use mmxrt::{solve, study};

use crate::scenes::{edited, mars, scene};
use crate::shapes::{cuboid, grid, joined, nadir, of_material, plane};

const R_M: f64 = 3_389_500.0;

/// A block on the ground, Mars 35 deg high in the east; the Sun below the horizon, so that Mars is seen at this phase.
fn site(mesh: Mesh, phase_deg: f64) -> Scene {
    let towards = DVec3::new(0.819, 0.0, 0.574).normalize();
    let (sin, cos) = phase_deg.to_radians().sin_cos();
    // Away from Mars, turned about y.
    let side = DVec3::Y.cross(towards);
    let sun = -cos * towards + sin * side;
    let bare = scene(of_material(mesh, 0), nadir(1000.0, 12.0, 6), sun.to_array());
    edited(&bare, |parts| parts.sky.mars = Some(mars(9_376_000.0 * towards)))
}

fn blocks() -> Mesh {
    joined(&[grid(6.0, 8, |x, y| 0.3 * (0.9 * x).sin() * (0.8 * y).cos()), cuboid([-1.0, -2.0, -1.0], [1.0, 1.0, 3.0])])
}

fn with_parts(scene: &Scene, rule: DiscRule) -> Scene {
    edited(scene, |parts| parts.models.mars_shadows = Some(rule))
}

fn shares(scene: &Scene) -> Vec<f64> {
    let table = solve::solve(scene, &unwatched).unwrap();
    let Sees::Shares(shares) = &table.of("mars").unwrap().sees else { panic!() };
    shares.clone()
}

/// Whether a ray meets any facet, by solving for where.
fn is_blocked(mesh: &Mesh, from: DVec3, ray: DVec3) -> bool {
    (0..mesh.facets.len()).any(|f| {
        let [a, b, c] = mesh.facet(f).corners_m;
        let (u, v, w) = (b - a, c - a, from - a);
        let det = -ray.dot(u.cross(v));
        let (s, t) = (-w.cross(v).dot(ray) / det, -u.cross(w).dot(ray) / det);
        w.dot(u.cross(v)) / det > 1e-9 && s >= 0.0 && t >= 0.0 && s + t <= 1.0
    })
}

/// The share of Mars' light that reaches a facet: rays from six of its points to hundreds of Mars', cones of equal solid angle.
fn share_by_rays(scene: &Scene, facet: usize) -> Option<f64> {
    let (mesh, centre_m) = (&scene.body.mesh, scene.sky.mars.as_ref().unwrap().centre_m);
    let normal = mesh.facet(facet).cross_m2().normalize();
    let (c, sun) = (centre_m.normalize(), scene.sky.sun.direction.vec());
    let (h, v) = c.any_orthonormal_pair();
    let cos_alpha = (1.0 - (R_M / centre_m.length()).powi(2)).sqrt();
    let [p, q, r] = mesh.facet(facet).corners_m;
    let from: Vec<DVec3> =
        [[1.0, 1.0, 4.0], [1.0, 4.0, 1.0], [4.0, 1.0, 1.0], [1.0, 2.5, 2.5], [2.5, 1.0, 2.5], [2.5, 2.5, 1.0]]
            .map(|w| (w[0] * p + w[1] * q + w[2] * r) / 6.0)
            .to_vec();
    let (mut all, mut free) = (0.0, 0.0);
    for i in 0..14 {
        let cos = 1.0 - (1.0 - cos_alpha) * (f64::from(i) + 0.5) / 14.0;
        let sin = (1.0 - cos * cos).sqrt();
        for k in 0..28 {
            let (y, x) = (std::f64::consts::PI * (f64::from(k) + 0.3 * f64::from(i)) / 14.0).sin_cos();
            let ray = cos * c + sin * (x * h + y * v);
            let along = ray.dot(centre_m);
            let met = along - (R_M * R_M - (centre_m.length_squared() - along * along)).max(0.0).sqrt();
            let light = (met * ray - centre_m).dot(sun).max(0.0) * normal.dot(ray).max(0.0);
            if light > 0.0 {
                for from in &from {
                    all += light;
                    free += if is_blocked(mesh, *from, ray) { 0.0 } else { light };
                }
            }
        }
    }
    (all > 0.0).then(|| free / all)
}

#[test]
fn terrain_hides_what_rays_do_not_reach() {
    for phase_deg in [20.0, 110.0] {
        let lit = site(blocks(), phase_deg);
        // Ground behind the block, in its penumbra.
        let looked_at: Vec<usize> =
            (0..128).filter(|f| lit.body.mesh.facet(*f).centroid_m().x < -1.0).step_by(2).collect();
        let expected: Vec<Option<f64>> = looked_at.iter().map(|f| share_by_rays(&lit, *f)).collect();
        let mut means = Vec::new();
        for rule in [DiscRule::G7, DiscRule::E37] {
            let got = shares(&with_parts(&lit, rule));
            let pairs = looked_at.iter().zip(&expected).filter_map(|(f, expected)| Some((got[*f], (*expected)?)));
            let off: Vec<f64> = pairs.clone().map(|(got, expected)| (got - expected).abs()).collect();
            assert!(pairs.filter(|(_, expected)| *expected > 0.05 && *expected < 0.95).count() > 8);
            let worst = off.iter().copied().fold(0.0, f64::max);
            // Rays and points of facets have an error of their own.
            assert!(worst < rule.share_error() + 0.06, "{phase_deg} {rule:?}: {worst}");
            means.push(off.iter().sum::<f64>() / off.len() as f64);
        }
        assert!(means[1] < means[0] && means[1] < 0.012, "{means:?}");
    }
}

#[test]
fn where_nothing_is_before_mars_nothing_changes() {
    let flat = site(plane(5.0, 0.0), 40.0);
    let without = study::simulate(&flat, &unwatched).unwrap().1.cube.band(0);
    for rule in DiscRule::ALL {
        let lit = with_parts(&flat, rule);
        assert!(shares(&lit).iter().all(|share| *share == 1.0));
        assert_eq!(study::simulate(&lit, &unwatched).unwrap().1.cube.band(0), without);
    }
    // A new Mars, before the Sun, sends nothing, which terrain cannot lessen.
    let new = with_parts(&edited(&site(blocks(), 180.0), |parts| parts.models.eclipses = true), DiscRule::G7);
    assert!(shares(&new).iter().all(|share| *share == 1.0));
    assert!(study::simulate(&new, &unwatched).unwrap().1.cube.band(0).iter().all(|l| *l == 0.0));
}

#[test]
fn tables_keep_shares_of_mars() {
    let scratch = crate::scratch::Scratch::new();
    let path = scratch.join("table.npz");
    let warm = edited(&site(blocks(), 30.0), |parts| parts.models.thermal = Thermal::Equilibrium);
    let lit = with_parts(&warm, DiscRule::G7);
    let (table, seen) = study::simulate(&lit, &unwatched).unwrap();
    npz::write_table(&path, &table, "s").unwrap();
    let (read, _) = npz::read_table(&path).unwrap();
    assert!(read == table);
    let again = study::observe(&lit, &read, Wanted::default(), &unwatched).unwrap();
    assert_eq!(again.cube.band(0), seen.cube.band(0));
    assert_ne!(study::table_id(&lit), study::table_id(&warm));
    // What does not reach a facet does not warm it: as the fourth root of its share, of reflected light and of heat.
    let open = solve::solve(&warm, &unwatched).unwrap();
    let Sees::Shares(shares) = &table.of("mars").unwrap().sees else { panic!() };
    let mut compared = 0;
    for (f, share) in
        shares.iter().enumerate().filter(|(f, share)| **share < 0.99 && open.temperature_shaded_k[*f] > 0.0)
    {
        let ratio = table.temperature_shaded_k[f] / open.temperature_shaded_k[f];
        assert!((ratio - share.powf(0.25)).abs() < 1e-12, "{f}: {ratio} {share}");
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}
