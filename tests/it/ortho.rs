//! An image as a map: nothing is lost or made up on the way, and areas are those of the ground.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::product::{CellPart, MapGrid};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Mirror, Readout, Timing};
use mmxrt::study::{MapWish, ortho};

use crate::cli::run;
use crate::motion::{down, moving_scene, steady};
use crate::scenes::{edited, scene};
use crate::scratch::Scratch;
use crate::shapes::{Random, camera, cuboid, grid, joined, nadir, plane, sphere};

fn tangent(cell: f64) -> MapWish {
    MapWish { plate_carree: false, cell, borders: None }
}

fn random_values(pixels: usize) -> Vec<f64> {
    let mut random = Random(3);
    (0..pixels).map(|_| 1.0 + random.share()).collect()
}

/// The integral of radiance over a map, and over the ground that pixels of this area see.
fn integrals((map, parts): &(MapGrid, Vec<CellPart>), samples: usize, values: &[f64], pixel_m2: f64) -> [f64; 2] {
    let (means, coverage) = (map.means(parts, values, samples), map.coverage(parts));
    let cells = means.iter().zip(&coverage).enumerate().filter(|(_, (_, share))| **share > 0.0);
    let of_map = cells.map(|(cell, (mean, share))| mean * share * map.cell_area(cell)).sum();
    [of_map, values.iter().sum::<f64>() * pixel_m2]
}

/// Flat ground from straight above, cells that fit no pixel: what the cells have together is what the pixels have.
#[test]
fn on_flat_ground_radiance_times_area_is_kept() {
    let ground = edited(&scene(grid(300.0, 7, |_, _| 0.0), nadir(2e4, 120.0, 12), [0.3, 0.0, 1.0]), |parts| {
        parts.surface.origin_m = DVec3::new(0.0, 0.0, 11_000.0);
    });
    let values = random_values(144);
    for cell in [3.7, 10.0, 27.0] {
        let made = ortho(&ground, None, 0, tangent(cell), &unwatched).unwrap();
        let [of_map, of_pixels] = integrals(&made, 12, &values, 100.0);
        assert!((of_map / of_pixels - 1.0).abs() < 1e-9, "{cell}: {of_map} {of_pixels}");
        let (map, parts) = &made;
        let mut sums = vec![0.0; map.cells()];
        map.weights(parts).iter().zip(parts).for_each(|(weight, part)| sums[part.cell as usize] += weight);
        assert!(sums.iter().all(|sum| *sum == 0.0 || (sum - 1.0).abs() < 1e-12));
        let of_pixel: f64 = parts.iter().filter(|part| (part.sample, part.line) == (5, 7)).map(|part| part.area).sum();
        assert!((of_pixel - 100.0).abs() < 1e-7, "{of_pixel}");
    }
    // Cells of two by two pixels: the mean of four. At the pole east is +y, north -x: up in the map is left in the image.
    let wish = MapWish { borders: Some([-60.0, -60.0, 60.0, 60.0]), ..tangent(20.0) };
    let (map, parts) = ortho(&ground, None, 0, wish, &unwatched).unwrap();
    assert_eq!((map.columns, map.rows), (6, 6));
    let means = map.means(&parts, &values, 12);
    // The first cell: the west is -y, the bottom of the image; the north is -x, its left.
    let expected = 0.25 * (values[120] + values[121] + values[132] + values[133]);
    assert!((means[0] - expected).abs() < 1e-9, "{} {expected}", means[0]);
}

/// Each line of a push-broom lies where it was taken.
#[test]
fn a_push_broom_is_laid_down_line_by_line() {
    let timing = Timing { readout: Readout::Line, period_s: 2.0, exposure_s: 0.0, poses: 1 };
    let motion = steady(DVec3::NEG_Y * 5.0, 3.0, DVec3::Z, down());
    let scene = moving_scene(plane(900.0, 0.0), [8, 5], 10.0, &[1.0], &motion, timing);
    let made = ortho(&scene, Some((&motion, timing)), 0, tangent(6.0), &unwatched).unwrap();
    let values = random_values(40);
    let [of_map, of_pixels] = integrals(&made, 8, &values, 100.0);
    assert!((of_map / of_pixels - 1.0).abs() < 1e-9, "{of_map} {of_pixels}");
    // 8 pixels across by 5 lines that touch: nothing of a cell inside is missed or seen twice.
    let full = made.0.coverage(&made.1).iter().filter(|share| (*share - 1.0).abs() < 1e-9).count();
    assert!(full >= 11 * 6, "{full}");
}

/// A whisk-broom looks at each sample by itself, over a mirror: at height h it sees from h tan(angle - step / 2) to h tan(angle + step / 2) but for the pixel's own width.
#[test]
fn a_whisk_broom_is_laid_down_sample_by_sample() {
    let mirror = Mirror { samples: 8, sample_s: 0.01, step_rad: 5e-4, elements: 2 };
    let timing = Timing { readout: Readout::Sample(mirror), period_s: 4.0, exposure_s: 0.0, poses: 1 };
    let motion = steady(DVec3::NEG_Y * 5.0, 5.0, DVec3::Z, down());
    let scene = moving_scene(plane(900.0, 0.0), [8, 6], 10.0, &[1.0], &motion, timing);
    let made = ortho(&scene, Some((&motion, timing)), 0, tangent(6.0), &unwatched).unwrap();
    let values = random_values(48);
    let [of_map, of_pixels] = integrals(&made, 8, &values, 100.0);
    // A pixel is wider away from the middle by 1 / cos^3 of 1.75e-3 rad at most: 5e-6.
    assert!((of_map / of_pixels - 1.0).abs() < 1e-5, "{of_map} {of_pixels}");
    let pixels: std::collections::BTreeSet<(u32, u32)> = made.1.iter().map(|part| (part.sample, part.line)).collect();
    assert_eq!(pixels.len(), 48);
}

/// A box on the ground hides some of it, and its walls have no area from above: no cell is seen more than once.
#[test]
fn what_is_hidden_is_not_mapped() {
    let mesh = joined(&[plane(300.0, 0.0), cuboid([-20.0, -20.0, 0.0], [20.0, 20.0, 30.0])]);
    let from = [0.0, -1e4, 1e4];
    let scene = edited(&scene(mesh, camera(from, [0.0; 3], [0.0, 0.0, 1.0], 24, 5e-4), [0.3, 0.0, 1.0]), |parts| {
        parts.surface.origin_m = DVec3::new(0.0, 0.0, 11_000.0);
    });
    let wish = MapWish { borders: Some([-50.0, -50.0, 50.0, 50.0]), ..tangent(2.0) };
    let (map, parts) = ortho(&scene, None, 0, wish, &unwatched).unwrap();
    let coverage = map.coverage(&parts);
    assert!(coverage.iter().all(|share| *share < 1.0 + 1e-6));
    // At 45 deg a box of 30 m hides 30 m behind its far wall, over its width of 40 m: from y = 20 to 50; east is y.
    let hidden: f64 = coverage.iter().map(|share| (1.0 - share) * 4.0).sum();
    assert!((hidden / 1200.0 - 1.0).abs() < 0.02, "{hidden}");
}

/// A ball from its back, over the meridian at which longitudes jump: a cap of 2 pi (1 - R / D) sr, without a seam.
#[test]
fn a_ball_is_mapped_by_longitude_and_latitude() {
    let ball = sphere([0.0; 3], 1000.0, 4);
    let eye = camera([-5000.0, 100.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], 24, 0.02);
    let ball = edited(&scene(ball, eye, [-1.0, 0.0, 0.2]), |parts| parts.surface.origin_m = DVec3::ZERO);
    let wish = MapWish { plate_carree: true, cell: 6.0, borders: None };
    let (map, parts) = ortho(&ball, None, 0, wish, &unwatched).unwrap();
    let seen: f64 = parts.iter().map(|part| part.area).sum::<f64>() * (PI / 180.0).powi(2);
    let cap = 2.0 * PI * (1.0 - 1000.0 / 5001.0);
    assert!((seen / cap - 1.0).abs() < 0.02, "{seen} {cap}");
    let full = map.coverage(&parts).iter().filter(|share| (*share - 1.0).abs() < 1e-6).count();
    assert!(full > 200, "{full}");
    let error = ortho(&ball, None, 0, tangent(10.0), &unwatched).unwrap_err().to_string();
    assert!(error.contains("plate-carree"), "{error}");
}

#[test]
fn the_command_maps_a_product() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", crate::scenes::SITE);
    let [scene, product, map] = ["scene.toml", "product", "map"].map(|name| scratch.argument(name));
    let (code, _, err) = run(&["simulate", &scene, "-o", &product]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = run(&["locate", &product, "--ortho", "tangent:25", "-o", &map]);
    assert_eq!(code, 0, "{err}");
    let header = std::fs::read_to_string(scratch.join("map/ortho.hdr")).unwrap();
    assert!(header.contains("map info = {Arbitrary, 1, 1, ") && header.contains("COVERAGE"), "{header}");
    let (code, out, err) = run(&["inspect", &scratch.argument("map/ortho.hdr")]);
    assert_eq!(code, 0, "{out} {err}");
    assert_eq!(run(&["inspect", &scratch.argument("map/lookup.npz")]).0, 0);
    let (code, out, err) = run(&["inspect", &map]);
    assert!(code == 0 && out.starts_with("kind: orthorectified image") && out.contains("ortho.img"), "{out} {err}");
    // A scene alone has no values, but says which pixels see what.
    let (code, _, err) = run(&["locate", &scene, "--ortho", "plate-carree:0.2", "-o", &map, "--force"]);
    assert_eq!(code, 0, "{err}");
    assert!(std::fs::read_to_string(scratch.join("map/ortho.hdr")).unwrap().contains("units=Degrees"));
    for (ortho, borders, what) in [
        ("mercator:5", None, "tangent:CELL"),
        ("tangent:0", None, "tangent:CELL"),
        ("tangent:1e-6", None, "too many"),
        ("tangent:5", Some("10,0,-10,5"), "borders"),
        ("tangent:10", Some("-100,-100,103,100"), "20 x 20 of them the borders are -100, -100, 100 and 100"),
    ] {
        let mut arguments = vec!["locate", &scene, "--ortho", ortho, "-o", &map, "--force"];
        arguments.extend(borders.iter().flat_map(|borders| ["--borders", borders]));
        let (code, _, err) = run(&arguments);
        assert!(code != 0 && err.contains(what), "{ortho}: {err}");
    }
    // A product is the image of the files that it was made of.
    let text = std::fs::read_to_string(scratch.join("scene.toml")).unwrap();
    scratch.write("scene.toml", format!("{text}\n# later\n"));
    let (code, _, err) = run(&["locate", &product, "--ortho", "tangent:25", "-o", &map, "--force"]);
    assert!(code != 0 && err.contains("other files") && err.contains("scene.toml"), "{err}");
    scratch.write("scene.toml", text);
    let (code, _, err) = run(&["locate", &scene, "--ortho", "tangent:5"]);
    assert!(code != 0 && err.contains("--output"), "{err}");
}
