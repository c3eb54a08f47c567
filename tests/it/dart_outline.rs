//! Images of DART whose printed corners are beside what they show: their place is found by their outline. Outlines are made by rays.

use glam::{DVec2, DVec3};
use mmxrt::formats::dart::output::{self, OutputMapOptions, RegistrationMode};
use mmxrt::product::{Placement, RadianceMap};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;

use crate::dart_output::{Image, options, output_with, scene};
use crate::scratch::Scratch;
use crate::shapes::{cuboid, joined, quad};

/// Half-extents of the ground, and a box on it, local: x East, y North, m. The ground's outline alone would tell nothing from its
/// mirror image.
const GROUND: [f64; 2] = [8.0, 6.0];
const BOX: [[f64; 3]; 2] = [[-5.0, 1.0, 0.0], [-2.0, 4.0, 6.0]];

fn made() -> Scene {
    let [x, y] = GROUND;
    let ground = quad([-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]);
    scene(crate::shapes::of_material(joined(&[ground, cuboid(BOX[0], BOX[1])]), 0), DVec3::new(0.0, 0.0, 11_000.0))
}

/// Whether the line of sight through a point of the ground (DART's frame: x South, y East, the scene's origin at (6, 8)) meets the scene.
fn meets(ground: DVec2, towards: DVec3) -> bool {
    let p = DVec3::new(ground.y - 8.0, 6.0 - ground.x, 0.0);
    let d = DVec3::new(towards.y, -towards.x, towards.z);
    if p.x.abs() <= GROUND[0] && p.y.abs() <= GROUND[1] {
        return true;
    }
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        if d[k] == 0.0 {
            if p[k] < BOX[0][k] || p[k] > BOX[1][k] {
                return false;
            }
            continue;
        }
        let (a, b) = ((BOX[0][k] - p[k]) / d[k], (BOX[1][k] - p[k]) / d[k]);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far
}

const PIXEL_M: f64 = 0.5;
const SIZE: [usize; 2] = [56, 60];

/// An image from a direction whose corners are printed `shift` (columns, rows) away from where it lies; `rule` says of how many of 64
/// rays that meet the scene a texel has a value.
fn image(view_deg: [f64; 2], shift: [f64; 2], rule: impl Fn(usize) -> bool) -> (String, [[f64; 2]; 4], Vec<f64>) {
    let [zenith, azimuth] = view_deg.map(f64::to_radians);
    let towards = DVec3::new(zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos());
    let row = DVec2::new(azimuth.cos(), azimuth.sin()) * PIXEL_M / zenith.cos();
    let column = DVec2::new(-azimuth.sin(), azimuth.cos()) * PIXEL_M;
    let [rows, columns] = SIZE.map(|n| n as f64);
    // The scene's middle, 2 m above ground, in the middle of the image.
    let middle = DVec2::new(6.0, 8.0) - towards.truncate() / towards.z * 2.0;
    let first = middle - 0.5 * rows * row - 0.5 * columns * column;
    let values = (0..SIZE[0] * SIZE[1]).map(|i| {
        let (r, c) = ((i / SIZE[1]) as f64, (i % SIZE[1]) as f64);
        let sub = |k: usize| (k as f64 + 0.5) / 8.0;
        let hits =
            (0..64).filter(|k| meets(first + (r + sub(k / 8)) * row + (c + sub(k % 8)) * column, towards)).count();
        if rule(hits) { 1.0 + r / 100.0 } else { -1.0 }
    });
    let values = values.collect();
    let printed = first + shift[0] * column + shift[1] * row;
    let corners = [printed, printed + rows * row, printed + rows * row + columns * column, printed + columns * column];
    let angle = |deg: f64| format!("{deg:05.1}").replace('.', "_");
    let name = format!("ima02_VZ={}_VA={}", angle(view_deg[0]), angle(view_deg[1]));
    (name, corners.map(|p| p.to_array()), values)
}

fn opened(
    view_deg: [f64; 2],
    shift: [f64; 2],
    rule: impl Fn(usize) -> bool,
    placing: RegistrationMode,
) -> mmxrt::Result<(RadianceMap, Option<String>)> {
    let scratch = Scratch::new();
    let (name, corners_m, values) = image(view_deg, shift, rule);
    let folder = "BAND0/BRF/ITERX";
    let image = Image { folder, name: &name, number: 2, size: SIZE, pixel_m: PIXEL_M, corners_m, values };
    let output = output_with(&scratch, &image);
    let properties = output.join("simulation.properties.txt");
    let text = std::fs::read_to_string(&properties).unwrap();
    let text = text.replace("teta:36.869898", &format!("teta:{:.6}", view_deg[0]));
    std::fs::write(properties, text.replace("phi:90.000000", &format!("phi:{:.6}", view_deg[1]))).unwrap();
    let options = OutputMapOptions { placing, ..options() };
    output::open(&output)?.view_map(0, &made(), &options, &unwatched)
}

/// Where the scene's north-western corner of the ground is, texels.
fn corner(map: &RadianceMap) -> [f64; 2] {
    match &map.placement {
        Placement::View(view) => view.camera.projection().at(DVec3::new(-GROUND[0], GROUND[1], 0.0)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_image_beside_its_printed_corners_is_put_where_it_shows_the_scene() {
    let any = |hits: usize| hits > 0;
    let half = |hits: usize| hits >= 32;
    let all = |hits: usize| hits == 64;
    for (view_deg, shift) in [
        ([22.4, 90.0], [0.0, 6.0]),
        ([22.4, 270.0], [-3.3, 2.6]),
        ([36.9, 30.0], [3.75, -1.0]),
        ([50.2, 195.0], [-1.75, -7.2]),
        ([62.0, 300.0], [0.7, -0.6]),
        ([0.0, 0.0], [-1.5, 0.47]),
    ] {
        let truth = corner(&opened(view_deg, [0.0; 2], half, RegistrationMode::Shifted([0.0; 2])).unwrap().0);
        for rule in [&any as &dyn Fn(usize) -> bool, &half, &all] {
            let (map, note) = opened(view_deg, shift, rule, RegistrationMode::Outline).unwrap();
            let found = map.registration.as_ref().unwrap();
            let place = corner(&map);
            let off = (0..2).map(|k| (place[k] - truth[k]).abs()).fold(0.0, f64::max);
            assert!(off <= 0.5, "{view_deg:?} {shift:?}: off by {off}, {found:?}");
            assert!(
                found.overlap[1] > 0.97 && found.overlap[0] < found.overlap[1],
                "{view_deg:?} {shift:?}: {found:?}"
            );
            for (k, shift) in shift.iter().enumerate() {
                assert!((found.shift_texels[k] - shift).abs() <= 0.5, "{found:?}");
                assert!((found.shift_m[k] - found.shift_texels[k] * PIXEL_M).abs() < 1e-9, "{found:?}");
            }
            assert!(note.unwrap().contains("by its outline"));
        }
    }
}

#[test]
fn printed_corners_stand_where_the_outline_fits_them() {
    for (view_deg, shift) in [([22.4, 90.0], [0.0; 2]), ([36.9, 30.0], [0.3, -0.2]), ([50.2, 195.0], [0.0, 0.25])] {
        let (map, note) = opened(view_deg, shift, |hits| hits >= 32, RegistrationMode::Outline).unwrap();
        let found = map.registration.as_ref().unwrap();
        assert!(found.shift_texels == [0.0; 2] && found.overlap[0] > 0.97 && note.is_none(), "{found:?} {note:?}");
        let printed = opened(view_deg, shift, |hits| hits >= 32, RegistrationMode::Shifted([0.0; 2])).unwrap().0;
        assert_eq!(map.placement, printed.placement);
    }
}

#[test]
fn an_outline_that_is_not_the_scenes_is_refused_unless_forced() {
    // Only what lies in every other stripe of eight rows has a value.
    let view_deg = [22.4, 90.0];
    let (name, corners_m, mut values) = image(view_deg, [1.0, 2.0], |hits| hits > 0);
    for (i, value) in values.iter_mut().enumerate() {
        if (i / SIZE[1] / 8).is_multiple_of(2) {
            *value = -1.0;
        }
    }
    let scratch = Scratch::new();
    let image =
        Image { folder: "BAND0/BRF/ITERX", name: &name, number: 2, size: SIZE, pixel_m: PIXEL_M, corners_m, values };
    let output = output_with(&scratch, &image);
    let properties = output.join("simulation.properties.txt");
    let text = std::fs::read_to_string(&properties).unwrap();
    std::fs::write(&properties, text.replace("teta:36.869898", "teta:22.400000")).unwrap();
    let output = output::open(&output).unwrap();
    let map = |placing| output.view_map(0, &made(), &OutputMapOptions { placing, ..options() }, &unwatched);
    let error = map(RegistrationMode::Outline).unwrap_err().to_string();
    assert!(error.contains("its outline has") && error.contains("below 95 %"), "{error}");
    assert!(
        error.contains("registration = \"printed\"") && error.contains("shift_texels = [columns, rows]"),
        "{error}"
    );
    let (forced, note) = map(RegistrationMode::Forced).unwrap();
    assert!(forced.registration.unwrap().overlap[1] < 0.95 && note.unwrap().contains("by its outline"));
    let (given, note) = map(RegistrationMode::Shifted([1.0, 2.0])).unwrap();
    assert!(given.registration.is_none() && note.is_none());
    let printed = map(RegistrationMode::Shifted([0.0; 2])).unwrap().0;
    let moved = (0..2).map(|k| corner(&given)[k] - corner(&printed)[k]).collect::<Vec<_>>();
    assert!((moved[0] - 1.0).abs() < 1e-9 && (moved[1] - 2.0).abs() < 1e-9, "{moved:?}");
}

#[test]
fn an_image_without_an_outline_lies_where_it_was_printed() {
    // 60 columns and 56 rows about a scene 24 texels wide (12 m) and less than 36 high: it may lie nearly anywhere in it.
    let (map, note) = opened([22.4, 90.0], [2.0, 3.0], |_| true, RegistrationMode::Outline).unwrap();
    let found = map.registration.as_ref().unwrap();
    // As far as shifts are looked for, 5 m, but no farther than the scene still is in the image: (60 - 24) / 2 + 2 texels of 0.5 m.
    assert!(found.shift_texels == [0.0; 2] && (found.unverified_m[0] - 5.0).abs() < 0.6, "{found:?}");
    assert!(found.unverified_m[1] > 3.0 && found.overlap[1] < 0.35, "{found:?}");
    let note = note.unwrap();
    assert!(note.contains("is not verified") && note.contains("outside the scene"), "{note}");
    let printed = opened([22.4, 90.0], [2.0, 3.0], |_| true, RegistrationMode::Shifted([0.0; 2])).unwrap().0;
    assert_eq!(map.placement, printed.placement);
}

/// An image from 10 deg above the North whose texels all have values, of a ground 16 m wide that has nothing on it.
fn full(size: [usize; 2], ground_m: [f64; 2], shift: [f64; 2], view_deg: [f64; 2]) -> (RadianceMap, Option<String>) {
    let scratch = Scratch::new();
    let [zenith, azimuth] = view_deg.map(f64::to_radians);
    let row = DVec2::new(azimuth.cos(), azimuth.sin()) / zenith.cos();
    let column = DVec2::new(-azimuth.sin(), azimuth.cos());
    let [rows, columns] = size.map(|n| n as f64);
    let first = DVec2::new(6.0, 8.0) - 0.5 * rows * row - 0.5 * columns * column + shift[0] * column + shift[1] * row;
    let corners = [first, first + rows * row, first + rows * row + columns * column, first + columns * column];
    let angle = |deg: f64| format!("{deg:05.1}").replace('.', "_");
    let name = format!("ima02_VZ={}_VA={}", angle(view_deg[0]), angle(view_deg[1]));
    let corners_m = corners.map(|p| p.to_array());
    let values = vec![1.0; size[0] * size[1]];
    let image = Image { folder: "BAND0/BRF/ITERX", name: &name, number: 2, size, pixel_m: 1.0, corners_m, values };
    let output = output_with(&scratch, &image);
    let properties = output.join("simulation.properties.txt");
    let text = std::fs::read_to_string(&properties).unwrap();
    let text = text.replace("teta:36.869898", &format!("teta:{:.6}", view_deg[0]));
    std::fs::write(properties, text.replace("phi:90.000000", &format!("phi:{:.6}", view_deg[1]))).unwrap();
    let [x, y] = ground_m.map(|m| 0.5 * m);
    let ground = quad([-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]);
    let scene = scene(crate::shapes::of_material(ground, 0), DVec3::new(0.0, 0.0, 11_000.0));
    output::open(&output).unwrap().view_map(0, &scene, &options(), &unwatched).unwrap()
}

#[test]
fn a_full_image_is_put_where_its_rectangle_fits_the_scenes() {
    // From 10 deg above the East (y in DART's frame) 16 m are 16 cos 10 deg = 15.757 rows: in 17 rows that all show some of the scene it can
    // lie by no more than 0.38 texels elsewhere than in their middle. Across, 12 m are 12 columns.
    for shift in [[0.0, -2.35], [1.5, 3.1], [-2.25, 0.0]] {
        let (map, note) = full([17, 12], [16.0, 12.0], shift, [10.0, 90.0]);
        let found = map.registration.as_ref().unwrap();
        let off = (0..2).map(|k| (found.shift_texels[k] - shift[k]).abs()).fold(0.0, f64::max);
        assert!(off <= 0.5 && found.unverified_m == [0.0; 2] && found.overlap[1] > 0.99, "{shift:?}: {found:?}");
        assert!(note.unwrap().contains("is moved there"));
    }
    let (map, note) = full([17, 12], [16.0, 12.0], [0.0, 0.0], [10.0, 90.0]);
    assert!(map.registration.unwrap().shift_texels == [0.0; 2] && note.is_none());
}

#[test]
fn a_full_image_of_a_part_of_the_scene_is_moved_into_it_and_may_lie_anywhere_there() {
    // 12 rows of 30 m, 29.54 rows: anywhere within 8.77 texels of the middle; columns decide. The window of shifts is 8 texels.
    let (map, note) = full([12, 12], [30.0, 12.0], [0.0, 2.0], [10.0, 90.0]);
    let found = map.registration.as_ref().unwrap();
    assert!(found.shift_texels == [0.0; 2] && found.unverified_m[0] == 0.0, "{found:?}");
    assert!((found.unverified_m[1] - 8.0).abs() < 0.3, "{found:?}");
    assert!(note.unwrap().contains("m along its rows"));
    // 12 rows of 18 m, 17.73 rows: within 2.86 texels of the middle. Printed 6 beyond, it lies at least 6 - 2.86 before that.
    let (map, note) = full([12, 12], [18.0, 12.0], [0.0, 6.0], [10.0, 90.0]);
    let found = map.registration.as_ref().unwrap();
    assert!((found.shift_texels[1] - (6.0 - 2.86)).abs() <= 0.4 && found.shift_texels[0].abs() <= 0.25, "{found:?}");
    assert!((found.unverified_m[1] - 4.86).abs() <= 0.8, "{found:?}");
    let note = note.unwrap();
    assert!(note.contains("is moved there") && note.contains("is not verified"), "{note}");
    // From the zenith corners have always been right.
    let (map, note) = full([12, 12], [30.0, 12.0], [0.0, 2.0], [0.0, 90.0]);
    assert!(map.registration.unwrap().unverified_m[1] > 0.0 && note.is_none());
}
