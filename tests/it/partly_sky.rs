//! Texels of an image that show the scene in part: their sky counts once.

use mmxrt::geometry::Texels as Between;
use mmxrt::integrate::Wanted;
use mmxrt::product::{RadianceMap, SkyShare};
use mmxrt::progress::unwatched;
use mmxrt::study::{self, MapOptions};

use crate::maps::{camera_image, map, observe, parallel_image, solved};
use crate::scenes::{edited, scene};
use crate::shapes::*;

/// A square of 10 m, from 1 km above, in pixels of 3.75 m: 1/3 of those at its borders show it.
fn square() -> mmxrt::scene::Scene {
    scene(plane(5.0, 0.0), nadir(1000.0, 15.0, 4), [0.0, 0.0, 1.0])
}

/// Coverage of the pixels of [`square`], by hand: 1.25 m of 3.75 m at the borders.
fn shares() -> Vec<f64> {
    let side = [1.0 / 3.0, 1.0, 1.0, 1.0 / 3.0];
    (0..16).map(|i| side[i / 4] * side[i % 4]).collect()
}

pub(crate) fn assert_near(image: &[f64], expected: &[f64], tolerance: f64) {
    let worst = image.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(image.len() == expected.len() && worst < tolerance, "{image:?}\n{expected:?}");
}

#[test]
fn a_camera_gives_back_its_own_image() {
    let scene = square();
    let own: Vec<f64> = shares().iter().map(|share| 9.0 * share).collect();
    let image = |sky: SkyShare| RadianceMap { sky, ..map(camera_image(&scene.exposure.camera, true), own.clone()) };
    for sky in [SkyShare::Guessed, SkyShare::Included] {
        let (seen, account) = observe(&scene, vec![vec![image(sky)]], &MapOptions::default()).unwrap();
        assert_near(&seen.cube.band(0), &own, 1e-12);
        assert_eq!(account.maps[0].divided_texels, 12);
        let told = seen.warnings.iter().filter(|w| w.contains("12 texels are partly sky")).count();
        assert_eq!(told, usize::from(sky == SkyShare::Guessed), "{:?}", seen.warnings);
    }
    // As means over the surface alone, each would count its share once more.
    let squared: Vec<f64> = shares().iter().map(|share| 9.0 * share * share).collect();
    let (seen, _) = observe(&scene, vec![vec![image(SkyShare::LeftOut)]], &MapOptions::default()).unwrap();
    assert_near(&seen.cube.band(0), &squared, 1e-12);
}

#[test]
fn every_rim_of_a_landscape_comes_back() {
    // The image of the scene's own camera, whatever its rim and its inner sides.
    let mesh = joined(&[plane(6.0, 0.0), cuboid([-2.0, -1.0, 0.0], [1.0, 2.0, 3.0])]);
    let camera = camera([15.0, -25.0, 20.0], [0.0; 3], [0.0, 0.0, 1.0], 40, 0.018);
    let scene = scene(of_material(mesh, 0), camera, [1.0, 0.5, 0.6]);
    let table = solved(&scene);
    let own = study::observe(&scene, &table, Wanted::default(), &unwatched).unwrap();
    let coverage = &own.backplanes.plane("COVERAGE").unwrap().values;
    assert!(coverage.iter().filter(|c| **c > 0.0 && **c < 1.0 - 1e-9).count() > 50);
    let image = own.cube.band(0);
    let map =
        || RadianceMap { sky: SkyShare::Guessed, ..map(camera_image(&scene.exposure.camera, true), image.clone()) };
    let (again, account) = observe(&scene, vec![vec![map()]], &MapOptions::default()).unwrap();
    let largest = image.iter().copied().fold(0.0, f64::max);
    assert_near(&again.cube.band(0), &image, 1e-9 * largest);
    assert!(account.unknown_share < 1e-9, "{account:?}");
    // From elsewhere the ground's radiance is what it was seen with: no darker towards the rim.
    let elsewhere = crate::shapes::camera([-10.0, -25.0, 30.0], [0.0; 3], [0.0, 0.0, 1.0], 40, 0.018);
    let other = edited(&scene, |scene| scene.exposure.camera = elsewhere);
    let lit = 0.07 / std::f64::consts::PI * 700.0 / 2.25;
    let options = MapOptions { fill: study::Fill::Value(0.0), ..MapOptions::default() };
    let (seen, _) = observe(&other, vec![vec![map()]], &options).unwrap();
    let seen = seen.cube.band(0);
    // Level ground under a Sun at 0.6 of its height.
    let ground = lit * 0.6 / (1.0_f64 + 0.25 + 0.36).sqrt();
    let level = seen.iter().filter(|l| (**l / ground - 1.0).abs() < 1e-9).count();
    assert!(seen.iter().all(|l| *l <= lit) && level > 50, "{lit} {ground} {level}");
}

#[test]
fn between_texel_centres_sky_does_not_count() {
    // A square of uniform radiance, seen from twice as far, in as many pixels: blended with the sky beside it, its rim would be dark.
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 15.0, 12), [0.0, 0.0, 1.0]);
    let side = |i: usize| ((1.25 * i as f64 + 1.25).min(12.5) - (1.25 * i as f64).max(2.5)).max(0.0) / 1.25;
    let expected: Vec<f64> = (0..144).map(|i| 9.0 * side(i / 12) * side(i % 12)).collect();
    let eye = nadir(2000.0, 16.0, 8);
    let texel = |i: usize| ((2.0 * i as f64 + 2.0).min(13.0) - (2.0 * i as f64).max(3.0)).max(0.0) / 2.0;
    let values: Vec<f64> = (0..64).map(|i| 9.0 * texel(i / 8) * texel(i % 8)).collect();
    for texels in [Between::Nearest, Between::Bilinear] {
        let map = RadianceMap { sky: SkyShare::Guessed, ..map(camera_image(&eye, true), values.clone()) };
        let options = MapOptions { texels, ..MapOptions::default() };
        let (seen, account) = observe(&scene, vec![vec![map]], &options).unwrap();
        assert_near(&seen.cube.band(0), &expected, 1e-9);
        assert!(account.unknown_share < 1e-9, "{account:?}");
    }
}

#[test]
fn an_orthographic_render_is_divided_and_an_orthoimage_is_not() {
    let scene = square();
    // Texels of 2 m from -7 m on: those at the rim are half sky.
    let side = [0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0].map(|s: f64| s);
    let of = |sky: f64| -> Vec<f64> {
        (0..64)
            .map(|i| {
                let share = side[i / 8] * side[i % 8];
                9.0 * share + sky * (1.0 - share)
            })
            .collect()
    };
    let expected: Vec<f64> = shares().iter().map(|share| 9.0 * share).collect();
    let placement = || parallel_image([0.0, 0.0, 1.0], [-8.0, 8.0], 2.0, 8, 8, true);
    // Dark around: a render. As bright all around: a map of more than the scene.
    for values in [of(0.0), of(9.0)] {
        let map = RadianceMap { sky: SkyShare::Guessed, ..map(placement(), values) };
        let (seen, _) = observe(&scene, vec![vec![map]], &MapOptions::default()).unwrap();
        assert_near(&seen.cube.band(0), &expected, 1e-12);
    }
}

#[test]
fn a_patch_within_a_brighter_picture_is_not_brightened() {
    // A camera that saw more ground than the scene has: no texel is partly sky.
    let scene = square();
    let map = RadianceMap { sky: SkyShare::Guessed, ..map(camera_image(&nadir(1000.0, 18.0, 6), true), vec![9.0; 36]) };
    let (seen, account) = observe(&scene, vec![vec![map]], &MapOptions::default()).unwrap();
    let expected: Vec<f64> = shares().iter().map(|share| 9.0 * share).collect();
    assert_near(&seen.cube.band(0), &expected, 1e-12);
    assert_eq!(account.maps[0].divided_texels, 0);
    assert!(seen.warnings.iter().any(|w| w.contains("as bright as the scene")), "{:?}", seen.warnings);
}
