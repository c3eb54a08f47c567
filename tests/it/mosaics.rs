//! Several maps that each know another part of a facet: together they know what any of them knows.

use mmxrt::geometry::Texels as Between;
use mmxrt::integrate::ViewChoice;
use mmxrt::product::{Placement, RadianceMap};
use mmxrt::study::{Fill, MapOptions};

use crate::maps::{camera_image, map, observe, parallel_image};
use crate::scenes::scene;
use crate::shapes::*;

fn options(choice: ViewChoice, texels: Between) -> MapOptions {
    MapOptions { choice, texels, fill: Fill::Value(0.0), add_solved: false, footprints: false }
}

const CHOICES: [ViewChoice; 2] = [ViewChoice::Nearest, ViewChoice::Interpolated];
const BETWEEN: [Between; 2] = [Between::Nearest, Between::Bilinear];

fn check(maps: Vec<RadianceMap>, options: &MapOptions, expected: &[f64], tolerance: f64) {
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 4), [0.0, 0.3, 1.0]);
    let (seen, account) = observe(&scene, vec![maps], options).unwrap();
    let image = seen.cube.band(0);
    let worst = image.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(image.len() == expected.len() && worst < tolerance, "{options:?}: {image:?}");
    assert!(account.unknown_share < 1e-12, "{account:?}");
    let known = &seen.backplanes.plane("MAP_COVERAGE").unwrap().values;
    assert!(known.iter().all(|c| *c > 1.0 - 1e-12), "{known:?}");
}

#[test]
fn orthoimages_that_meet_within_a_pixel_leave_no_seam() {
    // Pixels are 2 m; the west (1) and the east (3) meet at x = 0.7 m, a column of pixels from 0 to 2 m.
    let towards = [0.0, 0.0, 1.0];
    let west = || map(parallel_image(towards, [-4.3, 5.0], 1.0, 5, 10, true), vec![1.0; 50]);
    let east = || map(parallel_image(towards, [0.7, 5.0], 1.0, 5, 10, true), vec![3.0; 50]);
    let expected: Vec<f64> = (0..4).flat_map(|_| [1.0, 1.0, 0.35 + 3.0 * 0.65, 3.0]).collect();
    for choice in CHOICES {
        for texels in BETWEEN {
            check(vec![west(), east()], &options(choice, texels), &expected, 1e-12);
            check(vec![east(), west()], &options(choice, texels), &expected, 1e-12);
        }
    }
}

#[test]
fn texels_that_one_map_lacks_another_has() {
    // A checkerboard of half-metre texels, of which each image has those that the other has not.
    let image = || parallel_image([0.0, 0.0, 1.0], [-4.0, 4.0], 0.5, 16, 16, true);
    let of = |parity: usize, value: f64| {
        let texel = |i: usize| if (i + i / 16) % 2 == parity { value } else { f64::NAN };
        map(image(), (0..256).map(texel).collect())
    };
    for choice in CHOICES {
        check(vec![of(0, 2.0), of(1, 5.0)], &options(choice, Between::Nearest), &[3.5; 16], 1e-12);
    }
}

#[test]
fn a_camera_a_plane_and_a_table_of_facets_share_a_pixel() {
    // The camera sees what lies north of its own lower border (2 m south of the middle), the plane the west, the table what is left.
    let eye = camera_image(&camera([0.0, 1.0, 2000.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 6, 5e-4), true);
    let ortho = parallel_image([0.3, 0.0, 1.0], [-6.0, 6.0], 1.0, 7, 12, true);
    // The table serves only what nobody else knows: north of y = -2 it is 4 (camera) or 6 (plane), by the angle.
    let maps = || {
        vec![
            map(eye.clone(), vec![4.0; 36]),
            map(ortho.clone(), vec![6.0; 84]),
            map(Placement::Facets(2), vec![9.0, 9.0]),
        ]
    };
    // Columns of pixels from x = -4, -2, 0, 2; rows from y = 4, 2, 0, -2. The camera is nearest: x from -3 to 3, y from -2 to 4.
    let row = |y_is_seen: bool| -> Vec<f64> {
        let beyond = |x0: f64, x1: f64| {
            // What the camera does not see: the plane to x = 1, then the table.
            let plane = (x1.min(1.0) - x0).max(0.0);
            6.0 * plane + 9.0 * (x1 - x0 - plane)
        };
        (0..4)
            .map(|i| {
                let (x0, x1) = (2.0 * f64::from(i) - 4.0, 2.0 * f64::from(i) - 2.0);
                if !y_is_seen {
                    return beyond(x0, x1) / 2.0;
                }
                let (a, b) = (x0.max(-3.0), x1.min(3.0));
                (4.0 * (b - a) + beyond(x0, a) + beyond(b, x1)) / 2.0
            })
            .collect()
    };
    let expected = [row(true), row(true), row(true), row(false)].concat();
    check(maps(), &options(ViewChoice::Nearest, Between::Nearest), &expected, 1e-9);
}

#[test]
fn what_a_wall_hides_from_one_view_another_sees() {
    // Two views from both sides of a wall, each of which the other's shadow is hidden from; the ground's two facets are large, and
    // each pixel at the wall holds both parts.
    let mesh = joined(&[plane(8.0, 0.0), cuboid([-0.5, -8.0, 0.0], [0.5, 8.0, 4.0])]);
    let scene = scene(of_material(mesh, 0), nadir(1000.0, 12.0, 3), [0.0, 0.3, 1.0]);
    let view =
        |x: f64, value: f64| map(parallel_image([x, 0.0, 1.0], [-20.0, 20.0], 1.0, 40, 40, true), vec![value; 1600]);
    for choice in CHOICES {
        let maps = vec![view(1.0, 2.0), view(-1.0, 2.0)];
        let (seen, account) = observe(&scene, vec![maps], &options(choice, Between::Nearest)).unwrap();
        assert!(account.unknown_share < 1e-9, "{account:?}");
        assert!(seen.cube.band(0).iter().all(|l| (l - 2.0).abs() < 1e-9), "{:?}", seen.cube.band(0));
        // Each by itself lacks the other's side: ground of 4 m, of 12 m across the image.
        let (_, alone) = observe(&scene, vec![vec![view(1.0, 2.0)]], &options(choice, Between::Nearest)).unwrap();
        assert!((alone.unknown_share - 4.0 / 12.0).abs() < 0.01, "{alone:?}");
    }
}

#[test]
fn gaps_that_no_map_fills_are_still_solved() {
    // Between the two, 1 m of each 8 m is unknown; the scene's own light fills it.
    let west = map(parallel_image([0.0, 0.0, 1.0], [-4.0, 5.0], 0.5, 7, 20, true), vec![1.0; 140]);
    let east = map(parallel_image([0.0, 0.0, 1.0], [0.5, 5.0], 0.5, 9, 20, true), vec![1.0; 180]);
    let scene = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), [0.0, 0.0, 1.0]);
    let options = MapOptions { fill: Fill::Solved, ..MapOptions::default() };
    let (seen, account) = observe(&scene, vec![vec![west, east]], &options).unwrap();
    assert!((account.unknown_share - 0.125).abs() < 1e-12, "{account:?}");
    // 700 W m-2 um-1 at 1.5 au on a reflectance of 0.07.
    let own = 0.07 / std::f64::consts::PI * 700.0 / 2.25;
    let expected = [3.5 / 4.0 + own * 0.5 / 4.0, 3.5 / 4.0 + own * 0.5 / 4.0];
    for line in seen.cube.band(0).chunks(2) {
        assert!(line.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{line:?} {expected:?}");
    }
}
