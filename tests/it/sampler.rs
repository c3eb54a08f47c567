//! Against a sampler of rays that shares nothing with the product but the mesh: it is slow, simple and double precision.
//!
//! What both compute is the mean over each pixel of cos i where the Sun is seen, 0 elsewhere. The sampler's two images
//! differ by their noise; the product may differ from their mean by no more than that noise explains.
//! `MMXRT_HEAVY=1` takes 16 times as many rays.

use crate::shapes::*;
use glam::DVec3;
use mmxrt::geometry::FrameCamera;
use mmxrt::geometry::{Direction, Mesh};
use mmxrt::landscape::{self, Boulders, Craters, Overlap, Recipe, Relief, Sources, Span};
use mmxrt::study::{Fill, MapOptions};

/// 200 m of hills, craters and 150 boulders a fifth sunk of 2 to 12 m, facets of 2 m.
fn site() -> Mesh {
    let mut recipe = Recipe { facets: 20_000, size_m: 200.0, ..Recipe::new(3) };
    recipe.relief = vec![Relief::Rolling { rms_m: 8.0, longest_m: 120.0, hurst: 1.0 }];
    recipe.craters = vec![Craters {
        count: 200,
        min_diameter_m: 6.0,
        max_diameter_m: 60.0,
        overlap: Overlap::Add,
        ..Craters::default()
    }];
    recipe.boulders = vec![Boulders { count: 150, buried: Span::One(0.2), ..Boulders::default() }];
    let site = landscape::generate(&recipe, &Sources::default(), &|_| true).unwrap();
    let shown =
        [site.boulders.iter().filter(|b| b.facets.is_some()).count(), site.craters.iter().filter(|c| c.shown).count()];
    assert!(shown[0] == 150 && shown[1] > 100, "{shown:?} boulders and craters");
    site.mesh
}

/// Facets by the squares of a plane that their projections touch.
struct Bins {
    low: DVec3,
    per_unit: DVec3,
    lists: Vec<Vec<u32>>,
}

const BINS: usize = 256;

impl Bins {
    /// `place` projects a vertex; only x and y count.
    fn new(mesh: &Mesh, place: impl Fn(DVec3) -> DVec3) -> Self {
        let placed: Vec<DVec3> = mesh.vertices_m.iter().map(|v| place(*v)).collect();
        let (low, high) = placed.iter().fold((placed[0], placed[0]), |(a, b), p| (a.min(*p), b.max(*p)));
        let mut bins = Bins { low, per_unit: BINS as f64 / (high - low), lists: vec![vec![]; BINS * BINS] };
        for (f, facet) in mesh.facets.iter().enumerate() {
            let [a, b, c] = facet.map(|v| bins.share(placed[v as usize]));
            // A margin of 1e-6 squares for rounding.
            let first = (a.min(b).min(c) - 1e-6).max(DVec3::ZERO);
            let last = a.max(b).max(c) + 1e-6;
            for row in first.y as usize..=(last.y as usize).min(BINS - 1) {
                for column in first.x as usize..=(last.x as usize).min(BINS - 1) {
                    bins.lists[row * BINS + column].push(f as u32);
                }
            }
        }
        bins
    }

    fn share(&self, p: DVec3) -> DVec3 {
        (p - self.low) * self.per_unit
    }

    /// The facets that a ray through this point of the plane may meet.
    fn at(&self, p: DVec3) -> &[u32] {
        let p = self.share(p);
        let inside = |x: f64| (0.0..=BINS as f64).contains(&x);
        if !inside(p.x) || !inside(p.y) {
            return &[];
        }
        &self.lists[(p.y as usize).min(BINS - 1) * BINS + (p.x as usize).min(BINS - 1)]
    }
}

/// Where a ray meets a facet, in lengths of `ray`: Moeller and Trumbore (1997), both sides.
fn meets(mesh: &Mesh, facet: u32, from: DVec3, ray: DVec3) -> Option<f64> {
    let [a, b, c] = mesh.facets[facet as usize].map(|v| mesh.vertices_m[v as usize]);
    let (ab, ac) = (b - a, c - a);
    let p = ray.cross(ac);
    let det = ab.dot(p);
    let away = from - a;
    let u = away.dot(p) / det;
    let q = away.cross(ab);
    let v = ray.dot(q) / det;
    let t = ac.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// The image by rays, `side` x `side` of them in each pixel, each at a random place of its own square. `value` is told the facet, the
/// point, and the facet's unit normal.
fn sampled(
    mesh: &Mesh,
    camera: &FrameCamera,
    side: u32,
    seed: u64,
    value: impl Fn(u32, DVec3, DVec3) -> f64,
) -> Vec<f64> {
    let eye = camera.world_from_sensor.translation_m;
    let [h, v, u] = [0, 1, 2].map(|k| camera.world_from_sensor.rotation.col(k));
    let in_image = Bins::new(mesh, |p| through(camera, p));
    let value = |x: f64, y: f64| {
        let ray = x * h + y * v + u;
        let hits = in_image.at(DVec3::new(x, y, 0.0)).iter().filter_map(|f| Some((meets(mesh, *f, eye, ray)?, *f)));
        let Some((t, facet)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) else { return 0.0 };
        let [a, b, c] = mesh.facets[facet as usize].map(|v| mesh.vertices_m[v as usize]);
        let normal = (b - a).cross(c - a).normalize();
        if normal.dot(ray) >= 0.0 { 0.0 } else { value(facet, eye + t * ray, normal) }
    };
    let pixels = camera.samples * camera.lines;
    let coordinate = |pixel: u32, pixels: u32, part: f64| {
        (f64::from(pixel) + part / f64::from(side) - 0.5 * f64::from(pixels)) * camera.pitch[0]
    };
    (0..pixels)
        .map(|pixel| {
            let mut random = Random(seed << 32 | u64::from(pixel));
            let mut sum = 0.0;
            for part in 0..side * side {
                let x = f64::from(part % side) + random.share();
                let y = f64::from(part / side) + random.share();
                let x = coordinate(pixel % camera.samples, camera.samples, x);
                sum += value(x, coordinate(pixel / camera.samples, camera.lines, y));
            }
            sum / f64::from(side * side)
        })
        .collect()
}

/// Where a camera sees a point: tangents to the right and down.
fn through(camera: &FrameCamera, p: DVec3) -> DVec3 {
    let p = camera.world_from_sensor.rotation.transpose() * (p - camera.world_from_sensor.translation_m);
    assert!(p.z > 0.0, "behind the camera");
    DVec3::new(p.x, p.y, 0.0) / p.z
}

/// Cosine of incidence where the Sun is seen, else 0.
fn sunlight(mesh: &Mesh, towards_sun: DVec3) -> impl Fn(u32, DVec3, DVec3) -> f64 {
    let (across, along) = towards_sun.any_orthonormal_pair();
    let from_sun = move |p: DVec3| DVec3::new(p.dot(across), p.dot(along), 0.0);
    let shadows = Bins::new(mesh, from_sun);
    move |facet, point, normal| {
        let cos_i = normal.dot(towards_sun);
        let hides = |f: &u32| *f != facet && meets(mesh, *f, point, towards_sun).is_some();
        if cos_i <= 0.0 || shadows.at(from_sun(point)).iter().any(hides) { 0.0 } else { cos_i }
    }
}

/// The same image by areas.
fn exact(mesh: &Mesh, towards_sun: Direction, camera: &FrameCamera) -> Vec<f64> {
    let seen = see(mesh, towards_sun, camera);
    let cos_i = |f: u32| mesh.facet(f as usize).normal().dot(towards_sun.vec());
    let pixels = (camera.samples * camera.lines) as usize;
    (0..pixels).map(|p| seen.footprints.pixel(p).map(|(f, _, lit)| lit * cos_i(f)).sum()).collect()
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, n), v| (sum + v * v, n + 1));
    (sum / f64::from(count)).sqrt()
}

/// What differs is no more than the noise of two images by rays explains.
fn assert_alike(ours: &[f64], one: &[f64], two: &[f64]) {
    let mean: Vec<f64> = one.iter().zip(two).map(|(a, b)| 0.5 * (a + b)).collect();
    let noise = rms(one.iter().zip(two).map(|(a, b)| 0.5 * (a - b)));
    let error = rms(ours.iter().zip(&mean).map(|(a, b)| a - b));
    let level = mean.iter().sum::<f64>() / mean.len() as f64;
    let worst = (0..ours.len()).max_by(|a, b| (ours[*a] - mean[*a]).abs().total_cmp(&(ours[*b] - mean[*b]).abs()));
    let worst = worst.unwrap();
    let told = format!("worst pixel {worst}: {}, rays say {} and {}", ours[worst], one[worst], two[worst]);
    assert!(error <= 1.2 * noise, "error {error:e}, noise {noise:e} of {level}; {told}");
    assert!(noise > 0.0 && noise < 0.02 * level, "noise {noise:e} of {level}");
}

/// `least_shadow`: the share of cos i over the image that shadows take away, at least: there is something to get wrong.
fn assert_converges(camera: &FrameCamera, towards_sun: Direction, least_shadow: f64) {
    let heavy = crate::scratch::is_heavy();
    let side = if heavy { 128 } else { 32 };
    let mesh = site();
    let ours = exact(&mesh, towards_sun, camera);
    let [one, two] = [1, 2].map(|seed| sampled(&mesh, camera, side, seed, sunlight(&mesh, towards_sun.vec())));
    assert_alike(&ours, &one, &two);
    // Without shadows.
    let bare: f64 = {
        let seen = see(&mesh, towards_sun, camera);
        let cos_i = |f: u32| mesh.facet(f as usize).normal().dot(towards_sun.vec()).max(0.0);
        let f = &seen.footprints;
        f.facet.iter().zip(&f.fraction).map(|(facet, share)| share * cos_i(*facet)).sum()
    };
    let shadow = 1.0 - ours.iter().sum::<f64>() / bare;
    assert!(shadow >= least_shadow, "shadows take {shadow} of the light");
}

/// From 1.5 km above: all but the site's rim, which would be the noisiest of all.
fn above() -> FrameCamera {
    nadir(1500.0, 180.0, 32)
}

#[test]
fn rays_agree_at_24_degrees() {
    assert_converges(&above(), sun(24.0, 30.0), 0.001);
}

#[test]
fn rays_agree_at_60_degrees() {
    assert_converges(&above(), sun(60.0, 200.0), 0.02);
}

#[test]
fn rays_agree_at_85_degrees() {
    assert_converges(&above(), sun(85.0, 110.0), 0.4);
}

#[test]
fn rays_agree_in_an_oblique_view() {
    let camera = camera([700.0, -500.0, 320.0], [0.0; 3], [0.0, 0.0, 1.0], 32, 0.08 / 32.0);
    assert_converges(&camera, sun(70.0, 10.0), 0.05);
}

#[test]
fn rays_agree_on_a_map_from_another_camera() {
    // A camera in the west took an image of noise, 60 x 60 pixels; another one, in the south, sees what of it lies where.
    let mesh = site();
    let map_camera = camera([-800.0, 200.0, 500.0], [0.0; 3], [0.0, 0.0, 1.0], 60, 0.0035);
    let view = camera([250.0, -900.0, 420.0], [0.0; 3], [0.0, 0.0, 1.0], 32, 0.08 / 32.0);
    let mut random = Random(7);
    let texels: Vec<f64> = (0..3600).map(|_| random.share()).collect();
    let scene = crate::scenes::scene(of_material(mesh.clone(), 0), view.clone(), [0.0, 0.0, 1.0]);
    let placement = crate::maps::camera_image(&map_camera, true);
    let options = MapOptions { fill: Fill::Value(0.0), ..MapOptions::default() };
    let terms = vec![vec![crate::maps::map(placement, texels.clone())]];
    let (seen, account) = crate::maps::observe(&scene, terms, &options).unwrap();
    let eye = map_camera.world_from_sensor.translation_m;
    let hidden = Bins::new(&mesh, |p| through(&map_camera, p));
    let of_map = |facet: u32, point: DVec3, normal: DVec3| {
        let at = through(&map_camera, point);
        let [column, row] = [at.x, at.y].map(|x| x / map_camera.pitch[0] + 30.0);
        let is_inside = (0.0..60.0).contains(&column) && (0.0..60.0).contains(&row);
        let ray = point - eye;
        // What lies between the eye and the point, short of it by more than rounding.
        let hides = |f: &u32| *f != facet && meets(&mesh, *f, eye, ray).is_some_and(|t| t < 1.0 - 1e-12);
        if !is_inside || normal.dot(ray) >= 0.0 || hidden.at(at).iter().any(hides) {
            return 0.0;
        }
        texels[row as usize * 60 + column as usize]
    };
    let side = if crate::scratch::is_heavy() { 128 } else { 32 };
    let [one, two] = [1, 2].map(|seed| sampled(&mesh, &view, side, seed, of_map));
    assert_alike(&seen.cube.band(0), &one, &two);
    // Something is hidden, and something is seen.
    assert!((0.1..0.9).contains(&account.unknown_share), "{account:?}");
}
