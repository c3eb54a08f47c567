//! Radiance maps of elsewhere, put onto a scene: closed forms, identities, and the same scene made otherwise.

use glam::DVec3;
use mmxrt::geometry::{Camera, FrameCamera, Mesh, ParallelCamera, Pose, Texels as Between};
use mmxrt::integrate::ViewChoice;
use mmxrt::integrate::Wanted;
use mmxrt::landscape::{self, Boulders, Craters, Recipe, Relief, Sources};
use mmxrt::product::{Atlas, FacetTable, Placement, RadianceMap, SkyShare, TexelSource, ViewImage};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Material, Scene};
use mmxrt::spectral::Band;
use mmxrt::study::{self, Fill, MapAccount, MapOptions, Observation};

use crate::scenes::{edited, scene};
use crate::shapes::*;

/// Texels held in memory: [band][texel].
pub(crate) struct Texels(pub(crate) Vec<Band>, pub(crate) Vec<Vec<f64>>);

impl TexelSource for Texels {
    fn bands(&self) -> &[Band] {
        &self.0
    }

    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> mmxrt::Result<()> {
        values.clone_from(&self.1[band]);
        Ok(())
    }
}

pub(crate) fn at_1_um() -> Vec<Band> {
    vec![Band::new(1.0, None)]
}

pub(crate) fn map(placement: Placement, values: Vec<f64>) -> RadianceMap {
    RadianceMap {
        name: "map".into(),
        placement,
        source: Box::new(Texels(at_1_um(), vec![values])),
        weight: 1.0,
        light: vec![],
        sky: SkyShare::LeftOut,
        registration: None,
    }
}

pub(crate) fn solved(scene: &Scene) -> FacetTable {
    mmxrt::solve::solve(scene, &unwatched).unwrap()
}

pub(crate) fn observe(
    scene: &Scene,
    terms: Vec<Vec<RadianceMap>>,
    options: &MapOptions,
) -> mmxrt::Result<(Observation, MapAccount)> {
    let table = solved(scene);
    study::observe_maps(scene, &table, terms, options, &unwatched)
}

/// The radiance of the only band, by one map.
fn radiance(scene: &Scene, map: RadianceMap, options: &MapOptions) -> Vec<f64> {
    observe(scene, vec![vec![map]], options).unwrap().0.cube.band(0)
}

fn coverage(observation: &Observation) -> &[f64] {
    &observation.backplanes.plane("COVERAGE").unwrap().values
}

/// Hills with craters and boulders, 40 m wide.
fn site() -> Mesh {
    let mut recipe = Recipe { facets: 3000, size_m: 40.0, ..Recipe::new(5) };
    recipe.relief = vec![Relief::Rolling { rms_m: 1.5, longest_m: 30.0, hurst: 1.0 }];
    recipe.craters = vec![Craters { count: 20, min_diameter_m: 3.0, max_diameter_m: 12.0, ..Craters::default() }];
    recipe.boulders = vec![Boulders { count: 15, min_diameter_m: 1.0, max_diameter_m: 4.0, ..Boulders::default() }];
    of_material(landscape::generate(&recipe, &Sources::default(), &|_| true).unwrap().mesh, 0)
}

pub(crate) fn camera_image(camera: &FrameCamera, occlusion: bool) -> Placement {
    Placement::View(Box::new(ViewImage { camera: Camera::Frame(camera.clone()), occlusion }))
}

/// Texels of `step_m`, columns along x and rows along -y, seen from a direction; the first corner lies at (x, y) of z = 0.
pub(crate) fn parallel_image(
    towards: [f64; 3],
    corner_m: [f64; 2],
    step_m: f64,
    columns: usize,
    rows: usize,
    occlusion: bool,
) -> Placement {
    let towards = DVec3::from_array(towards);
    // Along the rays nothing changes: the horizontal coordinate of where a ray meets z = 0.
    let column_per_m = DVec3::new(1.0, 0.0, -towards.x / towards.z) / step_m;
    let row_per_m = DVec3::new(0.0, -1.0, towards.y / towards.z) / step_m;
    let origin_m = DVec3::new(corner_m[0], corner_m[1], 0.0);
    let camera = ParallelCamera {
        towards: direction(towards.to_array()),
        samples: columns as u32,
        lines: rows as u32,
        sample_per_m: column_per_m,
        line_per_m: row_per_m,
        origin_m,
        origin_px: [0.0; 2],
    };
    Placement::View(Box::new(ViewImage { camera: Camera::Parallel(camera), occlusion }))
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn ones_own_image_gives_the_same_image() {
    let camera = camera([15.0, -25.0, 60.0], [0.0; 3], [0.0, 1.0, 0.0], 48, 0.016);
    let scene = scene(site(), camera, [1.0, 0.5, 0.6]);
    let table = solved(&scene);
    let own = study::observe(&scene, &table, Wanted::default(), &unwatched).unwrap();
    let image = own.cube.band(0);
    let values: Vec<f64> =
        image.iter().zip(coverage(&own)).map(|(l, c)| if *c > 0.0 { l / c } else { f64::NAN }).collect();
    let partly = coverage(&own).iter().filter(|c| **c > 0.0 && **c < 0.999).count();
    assert!(partly > 20, "{partly} pixels at the rim");
    let map = map(camera_image(&scene.exposure.camera, true), values);
    let (again, account) = observe(&scene, vec![vec![map]], &MapOptions::default()).unwrap();
    let largest = image.iter().copied().fold(0.0, f64::max);
    assert!(worst(&again.cube.band(0), &image) < 1e-12 * largest, "{:e}", worst(&again.cube.band(0), &image) / largest);
    assert!(account.unknown_share < 1e-9 && account.largest_angle_deg < 1e-5, "{account:?}");
}

#[test]
fn a_uniform_map_is_uniform_from_everywhere() {
    let camera = camera([30.0, 20.0, 50.0], [0.0; 3], [0.0, 1.0, 0.0], 40, 0.012);
    let scene = scene(site(), camera, [1.0, 0.5, 0.6]);
    let far = camera_image(&crate::shapes::camera([-20.0, 40.0, 90.0], [0.0; 3], [0.0, 1.0, 0.0], 500, 0.002), true);
    let maps = [
        (parallel_image([0.0, 0.0, 1.0], [-30.0, 30.0], 0.07, 857, 857, false), 857 * 857),
        (parallel_image([0.3, -0.4, 1.0], [-60.0, 60.0], 3.7, 40, 40, true), 1600),
        (far, 250_000),
    ];
    for (placement, count) in maps {
        for texels in [Between::Nearest, Between::Bilinear] {
            let options = MapOptions { texels, fill: Fill::Refuse(0.9), ..MapOptions::default() };
            let (seen, account) =
                observe(&scene, vec![vec![map(placement.clone(), vec![5.0; count])]], &options).unwrap();
            let covered = coverage(&seen);
            let full = covered.iter().filter(|c| **c > 1.0 - 1e-9).count();
            assert!(full > 500, "{full}");
            for (pixel, (value, covered)) in seen.cube.band(0).iter().zip(covered).enumerate() {
                assert!((value - 5.0 * covered).abs() < 5e-12, "{texels:?} pixel {pixel}: {value} of {covered}");
            }
            assert!(account.quadrature_error < 1e-10, "{account:?}");
        }
    }
}

/// A tilted square in the frame of a camera at the origin: point (X, Y) of it is at (X, Y cos a, 10 + Y sin a).
fn tilted(half: f64, tilt_rad: f64, cells: u32) -> Mesh {
    let mut mesh = grid(half, cells, |_, _| 0.0);
    for v in &mut mesh.vertices_m {
        *v = DVec3::new(v.x, v.y * tilt_rad.cos(), 10.0 + v.y * tilt_rad.sin());
    }
    // Seen from the origin: its front faces -z.
    for f in &mut mesh.facets {
        f.swap(1, 2);
    }
    mesh
}

/// Texel coordinates on the tilted square by a parallel projection along its normal.
fn on_tilted(half: f64, tilt_rad: f64, texels: usize) -> Placement {
    let per_m = texels as f64 / (2.0 * half);
    let along_y = DVec3::new(0.0, tilt_rad.cos(), tilt_rad.sin());
    let camera = ParallelCamera {
        towards: direction(DVec3::X.cross(-along_y).to_array()),
        samples: texels as u32,
        lines: texels as u32,
        sample_per_m: DVec3::X * per_m,
        line_per_m: along_y * per_m,
        origin_m: DVec3::new(0.0, 0.0, 10.0),
        origin_px: [0.5 * texels as f64; 2],
    };
    Placement::View(Box::new(ViewImage { camera: Camera::Parallel(camera), occlusion: true }))
}

fn looking_up(pixels: u32, pitch: f64) -> FrameCamera {
    FrameCamera::centred(Pose::IDENTITY, pixels, pixels, pitch)
}

#[test]
fn a_ramp_on_a_tilted_plane_has_its_analytic_pixel_means() {
    let (half, tilt, texels) = (12.0, 0.8_f64, 16);
    let scene = scene(tilted(half, tilt, 3), looking_up(12, 0.05), [0.2, -0.5, -1.0]);
    // The value of a texel is Y at its centre: bilinearly, Y itself.
    let step = 2.0 * half / texels as f64;
    let y_of = |row: usize| -half + step * (row as f64 + 0.5);
    let values: Vec<f64> = (0..texels * texels).map(|i| 100.0 + y_of(i / texels)).collect();
    let options = MapOptions { texels: Between::Bilinear, ..MapOptions::default() };
    let image = radiance(&scene, map(on_tilted(half, tilt, texels), values), &options);
    // y = Y cos a / (10 + Y sin a): Y = 10 y / (cos a - y sin a), whose integral is
    // -10 y / sin a - 10 cos a / sin^2 a ln(cos a - y sin a).
    let (s, c) = tilt.sin_cos();
    let integral = |y: f64| -10.0 * y / s - 10.0 * c / (s * s) * (c - y * s).ln();
    for line in 0..12 {
        let [y0, y1] = [0.0, 1.0].map(|k| (f64::from(line) + k - 6.0) * 0.05);
        let mean = 100.0 + (integral(y1) - integral(y0)) / (y1 - y0);
        for sample in 0..12 {
            let value = image[(line * 12 + sample) as usize];
            assert!((value / mean - 1.0).abs() < 1e-9, "line {line}: {value} {mean}");
        }
    }
}

#[test]
fn a_map_is_as_good_as_a_mesh_cut_along_its_texels() {
    // The same tilted square twice: of two facets under 24 x 24 texels, and of 24 x 24 cells that have the texels' values.
    let (half, tilt, n) = (6.0, -0.6, 24);
    let values: Vec<f64> = (0..n * n).map(|i| 1.0 + ((i * 7919) % 101) as f64).collect();
    let camera = looking_up(10, 0.11);
    let coarse = scene(tilted(half, tilt, 1), camera.clone(), [0.2, -0.5, -1.0]);
    let fine = scene(tilted(half, tilt, n as u32), camera, [0.2, -0.5, -1.0]);
    let by_texel = radiance(&coarse, map(on_tilted(half, tilt, n), values.clone()), &MapOptions::default());
    let of_facet: Vec<f64> = (0..2 * n * n).map(|f| values[f / 2]).collect();
    let by_facet = radiance(&fine, map(Placement::Facets(2 * n * n), of_facet), &MapOptions::default());
    assert!(by_texel.iter().filter(|v| **v > 0.0).count() > 60);
    assert!(worst(&by_texel, &by_facet) < 1e-11, "{:e}", worst(&by_texel, &by_facet));
    // And by texture coordinates: those of the two facets' corners.
    let texel = |p: DVec3| [p.x, (p.y / tilt.cos())].map(|x| (x + half) * n as f64 / (2.0 * half));
    let corners = (0..2).map(|f| coarse.body.mesh.facet(f).corners_m.map(texel)).collect();
    let atlas = Placement::Atlas(Atlas { corners, rows: n, columns: n });
    let by_atlas = radiance(&coarse, map(atlas, values), &MapOptions::default());
    assert!(worst(&by_atlas, &by_facet) < 1e-11, "{:e}", worst(&by_atlas, &by_facet));
}

#[test]
fn a_checkerboard_of_sevenths_of_a_pixel_has_exact_fractions() {
    // Pixels of 0.7 m over texels of 0.1 m: 25 or 24 of 49 are white.
    let n = 12 * 7;
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 8.4, 12), [0.0, 0.3, 1.0]);
    let values: Vec<f64> = (0..n * n).map(|i| if (i % n + i / n) % 2 == 0 { 49.0 } else { 0.0 }).collect();
    let placement = parallel_image([0.0, 0.0, 1.0], [-4.2, 4.2], 0.1, n, n, true);
    let image = radiance(&scene, map(placement, values), &MapOptions::default());
    for (pixel, value) in image.iter().enumerate() {
        let white = if (pixel % 12 + pixel / 12) % 2 == 0 { 25.0 } else { 24.0 };
        assert!((value - white).abs() < 1e-9, "pixel {pixel}: {value}");
    }
}

#[test]
fn what_pixels_receive_is_what_facets_send() {
    let camera = camera([20.0, -15.0, 60.0], [0.0; 3], [0.0, 1.0, 0.0], 32, 0.02);
    let scene = scene(site(), camera, [1.0, 0.5, 0.6]);
    let facets = scene.body.mesh.facets.len();
    let values: Vec<f64> = (0..facets).map(|f| ((f * 31) % 97) as f64).collect();
    let image = radiance(&scene, map(Placement::Facets(facets), values.clone()), &MapOptions::default());
    let seen = see(&scene.body.mesh, scene.sky.sun.direction, &scene.exposure.camera);
    let sent: f64 = (0..facets).map(|f| values[f] * totals(&seen, |g| g as usize == f).0).sum();
    let received: f64 = image.iter().sum();
    assert!((received / sent - 1.0).abs() < 1e-10, "{received} {sent}");
}

#[test]
fn a_map_that_knows_nothing_leaves_all_to_the_scene() {
    let camera = camera([15.0, -25.0, 60.0], [0.0; 3], [0.0, 1.0, 0.0], 24, 0.03);
    let scene = scene(site(), camera, [1.0, 0.5, 0.6]);
    let table = solved(&scene);
    let own = study::observe(&scene, &table, Wanted::default(), &unwatched).unwrap().cube.band(0);
    let nadir = || parallel_image([0.0, 0.0, 1.0], [-30.0, 30.0], 1.0, 60, 60, true);
    let nothing = || map(nadir(), vec![f64::NAN; 3600]);
    let solve = MapOptions { fill: Fill::Solved, ..MapOptions::default() };
    let (seen, account) = observe(&scene, vec![vec![nothing()]], &solve).unwrap();
    assert_eq!(seen.cube.band(0), own);
    assert_eq!(account.unknown_share, 1.0);
    assert!(seen.backplanes.plane("MAP_COVERAGE").unwrap().values.iter().all(|v| *v == 0.0 || v.is_nan()));
    let error = observe(&scene, vec![vec![nothing()]], &MapOptions::default()).unwrap_err().to_string();
    assert!(error.contains("100.00 % of what the camera sees is unknown"), "{error}");
    let valued = MapOptions { fill: Fill::Value(3.0), ..MapOptions::default() };
    let (seen, _) = observe(&scene, vec![vec![nothing()]], &valued).unwrap();
    assert!(worst(&seen.cube.band(0), &coverage(&seen).iter().map(|c| 3.0 * c).collect::<Vec<_>>()) < 1e-12);
}

#[test]
fn behind_a_wall_a_map_knows_nothing() {
    // A wall 1 m high along x = 0, on a ground of 8 m, seen by the map from 45 deg in the east: the ground from x = -1 to 0 is
    // hidden. The camera sees it from above.
    let ground = plane(4.0, 0.0);
    let wall = quad([0.0, 4.0, 0.0], [0.0, -4.0, 0.0], [0.0, -4.0, 1.0], [0.0, 4.0, 1.0]);
    let back = quad([0.0, -4.0, 0.0], [0.0, 4.0, 0.0], [0.0, 4.0, 1.0], [0.0, -4.0, 1.0]);
    let scene = scene(joined(&[ground, wall, back]), nadir(1000.0, 4.0, 8), [0.0, 0.1, 1.0]);
    let east = parallel_image([1.0, 0.0, 1.0], [-8.0, 8.0], 1.0, 16, 16, true);
    let valued = MapOptions { fill: Fill::Value(100.0), ..MapOptions::default() };
    let (seen, account) = observe(&scene, vec![vec![map(east.clone(), vec![1.0; 256])]], &valued).unwrap();
    // Pixels of 0.5 m, x from -2: columns 2 and 3 are hidden.
    for (pixel, value) in seen.cube.band(0).iter().enumerate() {
        let expected = if [2, 3].contains(&(pixel % 8)) { 100.0 } else { 1.0 };
        assert!((value - expected).abs() < 1e-3, "pixel {pixel}: {value}");
    }
    assert!((account.unknown_share - 0.25).abs() < 1e-3, "{account:?}");
    // 45 deg between the map's direction and the camera's.
    let angle = seen.backplanes.plane("MAP_ANGLE").unwrap();
    assert!(angle.values[0].is_finite() && (angle.values[0] - 45.0).abs() < 0.2, "{}", angle.values[0]);
    // From the west the map knows it: the nearest view that knows a place serves it.
    let west = parallel_image([-1.0, 0.0, 2.0], [-8.0, 8.0], 1.0, 16, 16, true);
    let both = || vec![vec![map(east.clone(), vec![1.0; 256]), map(west.clone(), vec![3.0; 256])]];
    let (seen, account) = observe(&scene, both(), &valued).unwrap();
    assert!(account.unknown_share < 1e-3, "{account:?}");
    // 26.57 deg to the west view, 45 deg to the east: the ground is the west view's, but for what it does not see.
    assert!((seen.cube.band(0)[2] - 3.0).abs() < 1e-2);
    let mixed = MapOptions { choice: ViewChoice::Interpolated, fill: Fill::Refuse(0.1), ..MapOptions::default() };
    let (seen, _) = observe(&scene, both(), &mixed).unwrap();
    let (near, far) = ((0.5_f64).atan().to_degrees().powi(-2), 45.0_f64.powi(-2));
    let expected = (3.0 * near + far) / (near + far);
    // Facets are large here: both views know parts of them; where both know all of what a pixel sees, the angles decide.
    assert!((seen.cube.band(0)[0] - expected).abs() < 2e-2, "{} {expected}", seen.cube.band(0)[0]);
}

#[test]
fn a_view_that_knows_next_to_nothing_of_a_facet_does_not_stand_for_it() {
    // The camera's own direction knows one texel of 1 cm in the middle of pixels of 1 m; 45 deg off all is known.
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 1.0, 1), [0.0, 0.3, 1.0]);
    let values: Vec<f64> = (0..10_000).map(|i| if i == 5050 { 7.0 } else { f64::NAN }).collect();
    let near = map(parallel_image([0.0, 0.0, 1.0], [-0.5, 0.5], 0.01, 100, 100, true), values);
    let far = map(parallel_image([1.0, 0.0, 1.0], [-8.0, 8.0], 1.0, 16, 16, true), vec![1.0; 256]);
    let (seen, account) = observe(&scene, vec![vec![near, far]], &MapOptions::default()).unwrap();
    // It serves that texel, 1e-4 of the pixel, and no more.
    assert!((seen.cube.band(0)[0] - (1.0 + 6e-4)).abs() < 1e-12, "{:?}", seen.cube.band(0));
    assert!((account.largest_angle_deg - 45.0).abs() < 0.1 && account.unknown_share < 1e-9, "{account:?}");
}

#[test]
fn maps_without_a_direction_serve_what_no_view_knows() {
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 4.0, 2), [0.0, 0.3, 1.0]);
    let facets = || map(Placement::Facets(2), vec![3.0; 2]);
    // Only the western half.
    let view = || map(parallel_image([1.0, 0.0, 1.0], [-8.0, 8.0], 1.0, 8, 16, true), vec![1.0; 128]);
    for choice in [ViewChoice::Nearest, ViewChoice::Interpolated] {
        let options = MapOptions { choice, ..MapOptions::default() };
        for views in [vec![facets(), view()], vec![view(), facets()]] {
            let image = observe(&scene, vec![views], &options).unwrap().0.cube.band(0);
            assert!(worst(&image, &[1.0, 3.0, 1.0, 3.0]) < 1e-9, "{choice:?}: {image:?}");
        }
    }
}

#[test]
fn the_angle_is_that_of_all_terms_with_a_direction() {
    let scene = scene(plane(5.0, 0.0), nadir(1e5, 4.0, 2), [0.0, 0.3, 1.0]);
    let facets = map(Placement::Facets(2), vec![3.0; 2]);
    let view = map(parallel_image([1.0, 0.0, 1.0], [-8.0, 8.0], 1.0, 16, 16, true), vec![1.0; 256]);
    let (seen, account) = observe(&scene, vec![vec![facets], vec![view]], &MapOptions::default()).unwrap();
    for angle in &seen.backplanes.plane("MAP_ANGLE").unwrap().values {
        assert!((angle - 45.0).abs() < 1e-3, "{angle}");
    }
    assert!((account.largest_angle_deg - 45.0).abs() < 1e-3, "{account:?}");
}

/// What a level camera 1.5 m above a plane sees of it, pixels of 0.02: line j ends 1.5 / (0.02 (j + 1)) m ahead.
const EYE_M: f64 = 1.5;
const PITCH: f64 = 0.02;

fn level_camera(samples: u32, lines: u32) -> FrameCamera {
    let pose = camera([0.0, 0.0, EYE_M], [0.0, 1.0, EYE_M], [0.0, 0.0, 1.0], 1, PITCH).world_from_sensor;
    FrameCamera::centred(pose, samples, lines, PITCH)
}

/// Mean over y0 to y1 of values that hold between ascending borders; 0 beyond them.
fn mean_of_steps(borders: &[f64], values: &[f64], y0: f64, y1: f64) -> f64 {
    let common = |k: usize| (borders[k + 1].min(y1) - borders[k].max(y0)).max(0.0);
    (0..values.len()).map(|k| values[k] * common(k)).sum::<f64>() / (y1 - y0)
}

#[test]
fn a_camera_close_to_the_ground_sees_texels_of_facets_behind_it() {
    // Two facets of 60 m that reach behind the camera, under lines of 0.7 m.
    let camera = level_camera(6, 80);
    let scene = scene(plane(30.0, 0.0), camera, [0.0, 0.3, 1.0]);
    let line_value = |row: usize| 1.0 + ((row * 37) % 11) as f64;
    let values: Vec<f64> = (0..80 * 80).map(|i| line_value(i / 80)).collect();
    let placement = parallel_image([0.2, -0.3, 1.0], [-28.0, 28.0], 0.7, 80, 80, true);
    let (seen, account) = observe(
        &scene,
        vec![vec![map(placement, values)]],
        &MapOptions { fill: Fill::Value(0.0), ..MapOptions::default() },
    )
    .unwrap();
    let image = seen.cube.band(0);
    // Row r lies from y = 28 - 0.7 (r + 1) to 28 - 0.7 r, and appears at the line 40 + 1.5 / (0.02 y): nearer is lower.
    let rows: Vec<usize> = (0..40).collect();
    let line_of = |y: f64| 40.0 + EYE_M / (PITCH * y);
    let borders: Vec<f64> = (0..40).map(|r| line_of(28.0 - 0.7 * r as f64)).chain([f64::INFINITY]).collect();
    let values: Vec<f64> = rows.iter().map(|r| line_value(*r)).collect();
    for line in 0..80_usize {
        let expected = mean_of_steps(&borders, &values, line as f64, line as f64 + 1.0);
        for sample in 0..6 {
            let value = image[line * 6 + sample];
            assert!((value - expected).abs() < 1e-11, "line {line}: {value} {expected}");
        }
    }
    assert!(image.iter().filter(|v| **v > 0.0).count() > 200 && account.unknown_share < 0.01, "{account:?}");
}

#[test]
fn an_image_from_close_to_the_ground_lies_where_it_was_seen() {
    // The same camera, its image put onto the ground and seen from above: 2 m wide, lines from y = 2 to 6.
    let map_camera = level_camera(80, 80);
    let mut camera = nadir(1000.0, 4.0, 8);
    camera.world_from_sensor.translation_m.y = 4.0;
    (camera.samples, camera.boresight_px[0]) = (2, 1.0);
    let scene = scene(plane(30.0, 0.0), camera, [0.0, 0.3, 1.0]);
    let line_value = |line: usize| 1.0 + ((line * 37) % 11) as f64;
    let values: Vec<f64> = (0..6400).map(|i| line_value(i / 80)).collect();
    let image = radiance(
        &scene,
        map(camera_image(&map_camera, true), values),
        &MapOptions { fill: Fill::Value(0.0), ..MapOptions::default() },
    );
    // Line 40 + j lies from 1.5 / (0.02 (j + 1)) to 1.5 / (0.02 j); the last ends at 1.875.
    let border = |j: usize| EYE_M / (PITCH * j as f64);
    let borders: Vec<f64> = (0..40).rev().map(|j| border(j + 1)).chain([f64::INFINITY]).collect();
    let values: Vec<f64> = (0..40).rev().map(|j| line_value(40 + j)).collect();
    for line in 0..8 {
        let y1 = 6.0 - 0.5 * line as f64;
        let expected = mean_of_steps(&borders, &values, y1 - 0.5, y1);
        for sample in 0..2 {
            let value = image[line * 2 + sample];
            assert!((value - expected).abs() < 1e-9, "line {line}: {value} {expected}");
        }
    }
}

#[test]
fn from_very_far_texels_are_where_they_are() {
    // Pixels of 0.7 m from 1e7 m, whose ulp is 2e-9 m, over texels of 0.1 m; and the same by a camera's image from there.
    let n = 12 * 7;
    let scene = scene(plane(5.0, 0.0), nadir(1e7, 8.4, 12), [0.0, 0.3, 1.0]);
    let values: Vec<f64> = (0..n * n).map(|i| if (i % n + i / n) % 2 == 0 { 49.0 } else { 0.0 }).collect();
    let far = camera_image(&nadir(1e7, 8.4, n as u32), true);
    for placement in [parallel_image([0.0, 0.0, 1.0], [-4.2, 4.2], 0.1, n, n, true), far] {
        let image = radiance(&scene, map(placement, values.clone()), &MapOptions::default());
        for (pixel, value) in image.iter().enumerate() {
            let white = if (pixel % 12 + pixel / 12) % 2 == 0 { 25.0 } else { 24.0 };
            assert!((value - white).abs() < 2e-6, "pixel {pixel}: {value}");
        }
    }
}

#[test]
fn maps_add_with_their_weights() {
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 4.0, 4), [0.0, 0.3, 1.0]);
    let placement = parallel_image([0.0, 0.0, 1.0], [-4.0, 4.0], 1.0, 8, 8, true);
    let a = map(placement.clone(), vec![2.0; 64]);
    let b = RadianceMap { weight: 0.5, ..map(placement.clone(), vec![3.0; 64]) };
    let facets = map(Placement::Facets(2), vec![10.0, 10.0]);
    let (seen, account) = observe(&scene, vec![vec![a], vec![b], vec![facets]], &MapOptions::default()).unwrap();
    assert!(worst(&seen.cube.band(0), &[13.5; 16]) < 1e-12);
    // Two of them have their texels at the same places: one term.
    assert_eq!(account.maps.iter().map(|m| m.term).collect::<Vec<_>>(), [1, 1, 2]);
    let own = MapOptions { add_solved: true, ..MapOptions::default() };
    let (both, _) = observe(&scene, vec![vec![map(placement, vec![2.0; 64])]], &own).unwrap();
    let table = solved(&scene);
    let alone = study::observe(&scene, &table, Wanted::default(), &unwatched).unwrap().cube.band(0);
    assert!(worst(&both.cube.band(0), &alone.iter().map(|l| l + 2.0).collect::<Vec<_>>()) < 1e-12);
}

#[test]
fn what_one_band_alone_does_not_know_is_told() {
    // One texel of 3600, as large as a pixel: below what may be unknown, but that pixel would be 0 and called known.
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 6.0, 60), [0.0, 0.3, 1.0]);
    let scene = edited(&scene, |scene| scene.exposure.bands.push(Band::new(2.0, None)));
    let second: Vec<f64> = (0..3600).map(|i| if i == 1000 { f64::NAN } else { 1.0 }).collect();
    let source = Texels(scene.exposure.bands.clone(), vec![vec![1.0; 3600], second]);
    let placement = parallel_image([0.0, 0.0, 1.0], [-3.0, 3.0], 0.1, 60, 60, true);
    let map = RadianceMap { source: Box::new(source), ..map(placement, vec![]) };
    let error = observe(&scene, vec![vec![map]], &MapOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("map, band 2: texel ") && error.contains("has no value") && error.contains("the same in all"),
        "{error}"
    );
}

#[test]
fn maps_that_cannot_be_are_refused() {
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 4.0, 4), [0.0, 0.3, 1.0]);
    let placement = || parallel_image([0.0, 0.0, 1.0], [-4.0, 4.0], 1.0, 8, 8, true);
    let negative: Vec<f64> = (0..64).map(|i| if i == 19 { -2.0 } else { 1.0 }).collect();
    let other_band = RadianceMap {
        source: Box::new(Texels(vec![Band::new(2.0, None)], vec![vec![1.0; 64]])),
        ..map(placement(), vec![])
    };
    let far_away = parallel_image([0.0, 0.0, 1.0], [100.0, 4.0], 1.0, 8, 8, true);
    for (map, message) in [
        (map(placement(), negative), "map, band 1: texel (row 2, column 3) holds the radiance -2"),
        (map(placement(), vec![1.0; 63]), "has 63 values in a band, but its placement has 64 texels"),
        (map(Placement::Facets(3), vec![1.0; 3]), "has values for 3 facets, but the scene has 2"),
        (map(far_away, vec![1.0; 64]), "does not overlap the scene"),
        (other_band, "band 1 of the sensor, at 1 um, is not among the map's"),
    ] {
        let error = observe(&scene, vec![vec![map]], &MapOptions::default()).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn facets_that_reach_behind_the_camera_are_mapped_as_they_are_textured() {
    // A camera 5 m above a ground of two facets of 300 m, which pass below and behind it, and a box on it; the map sees all from above,
    // but for what lies under the box. The texture has the same values: radiance per factor is that of the plain scene.
    let half = 150.0;
    let mesh = joined(&[plane(half, 0.0), of_material(cuboid([-4.0, -100.0, 0.0], [4.0, -92.0, 6.0]), 1)]);
    let camera = camera([0.3, -140.0, 5.0], [0.0, -95.0, 0.0], [0.0, 0.0, 1.0], 24, 0.04);
    let values: Vec<f64> = (0..300 * 300).map(|i| 0.2 + 0.8 * ((i * 7919) % 101) as f64 / 101.0).collect();
    let mut plain = scene(of_material(mesh.clone(), 0), camera, [0.0, 0.0, 1.0]).into_parts();
    plain.surface.materials.push(Material {
        name: "box".into(),
        mixture: vec![(1, 1.0)],
        ..plain.surface.materials[0].clone()
    });
    plain.surface.mesh = mesh;
    let plain = plain.check().unwrap();
    let texel = |p: DVec3| [p.x + half, half - p.y];
    let texture = mmxrt::scene::Texture {
        material: mmxrt::geometry::MaterialId(0),
        kind: mmxrt::scene::TextureKind::Factor,
        corners: (0..plain.body.mesh.facets.len()).map(|f| plain.body.mesh.facet(f).corners_m.map(texel)).collect(),
        rows: 300,
        columns: 300,
        wavelength_um: vec![],
        values: values.clone(),
        texels: Between::Nearest,
        lon_lat: None,
    };
    let textured = edited(&plain, |scene| scene.surface.textures = vec![texture]);
    let by_texture = study::simulate(&textured, &unwatched).unwrap().1.cube.band(0);
    let alone = study::simulate(&plain, &unwatched).unwrap().1;
    let image = parallel_image([0.0, 0.0, 1.0], [-half, half], 1.0, 300, 300, true);
    let options = MapOptions { fill: Fill::Refuse(0.5), ..MapOptions::default() };
    let (seen, _) = observe(&plain, vec![vec![map(image, values)]], &options).unwrap();
    let (by_map, material) = (seen.cube.band(0), &alone.backplanes.plane("ABUNDANCE grey").unwrap().values);
    let white = 0.07 / std::f64::consts::PI * 700.0 / 2.25;
    let mut compared = 0;
    for pixel in (0..by_map.len()).filter(|p| material[*p] > 1.0 - 1e-9) {
        let (a, b) = (by_map[pixel], by_texture[pixel] / white);
        assert!((a - b).abs() < 1e-9, "pixel {pixel}: {a} {b}");
        compared += 1;
    }
    assert!(compared > 150, "{compared}");
}
