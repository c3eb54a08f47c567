//! Lenses that distort: pixels are quadrilaterals in the plane of the ideal pinhole, and nothing of what is seen is lost, or seen twice.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;
use mmxrt::formats::scene_toml;
use mmxrt::geometry::{BrownConrady, FrameCamera, Lens, Mesh, Texels};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Scene, Texture, TextureKind};
use mmxrt::study::{self, locate::Locator, locate::Place};

use crate::cli::run;
use crate::globes_in_view::globe;
use crate::map_files::Bench;
use crate::scenes::{edited, scene};
use crate::shapes::*;

const BARREL: [f64; 5] = [-0.25, 0.04, 0.0, 0.0, 0.0];
const PINCUSHION: [f64; 5] = [0.3, 0.1, 0.05, 0.0, 0.0];
const SKEW: [f64; 5] = [-0.12, 0.03, -0.01, 4e-3, -6e-3];

/// A camera with a lens of these coefficients: k1, k2, k3, p1, p2.
fn with(camera: &FrameCamera, [k1, k2, k3, p1, p2]: [f64; 5]) -> FrameCamera {
    let of = BrownConrady { radial: [k1, k2, k3], tangential: [p1, p2] };
    let size = [camera.samples, camera.lines];
    let lens = Lens::brown_conrady(of, camera.pitch, camera.boresight_px, size).unwrap();
    FrameCamera { lens: lens.map(Arc::new), ..camera.clone() }
}

/// A camera that looks where a table of tangents says.
fn tabulated(camera: &FrameCamera, at: impl Fn(f64, f64) -> [f64; 2]) -> FrameCamera {
    let size = [camera.samples, camera.lines];
    let tangent = |i: u32, k: usize| (f64::from(i) + 0.5 - camera.boresight_px[k]) * camera.pitch[k];
    let centres = (0..size[1]).flat_map(|line| (0..size[0]).map(move |sample| (sample, line)));
    let centres = centres.map(|(sample, line)| at(tangent(sample, 0), tangent(line, 1))).collect();
    let lens = Lens::table(centres, size).unwrap();
    FrameCamera { pitch: lens.pitch(), boresight_px: lens.boresight_px(), lens: Some(Arc::new(lens)), ..camera.clone() }
}

/// Tangents without radial distortion of tangents with it, by halves: the inverse of r (1 + k1 r2 + k2 r4 + k3 r6).
fn undistorted([x, y]: [f64; 2], [k1, k2, k3, ..]: [f64; 5]) -> [f64; 2] {
    let far = x.hypot(y);
    let (mut low, mut high) = (0.0, 2.0 * far + 1e-300);
    for _ in 0..200 {
        let r: f64 = 0.5 * (low + high);
        let r2 = r * r;
        if r * (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) < far { low = r } else { high = r }
    }
    if far == 0.0 { [0.0; 2] } else { [x * low / far, y * low / far] }
}

/// Area of each pixel in the ideal plane, in units of the focal length: of the quadrilateral of its corners, worked out here.
fn areas(camera: &FrameCamera, corner: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    let at = |i: u32, j: u32| {
        let px = [f64::from(i), f64::from(j)];
        corner([0, 1].map(|k| (px[k] - camera.boresight_px[k]) * camera.pitch[k]))
    };
    let area = |i: u32, j: u32| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        0.5 * ((c[0] - a[0]) * (d[1] - b[1]) - (d[0] - b[0]) * (c[1] - a[1]))
    };
    (0..camera.lines).flat_map(|j| (0..camera.samples).map(move |i| (i, j))).map(|(i, j)| area(i, j)).collect()
}

/// Ground with a post that throws a shadow, all of it well within 24 x 24 pixels of 0.03, 20 m below.
fn post() -> (Mesh, FrameCamera) {
    let mesh = joined(&[plane(4.0, 0.0), cuboid([-0.53, -0.71, 0.0], [0.46, 0.52, 2.0])]);
    (mesh, camera([0.6, -0.9, 20.0], [0.3, 0.2, 0.0], [0.1, 1.0, 0.0], 24, 0.03))
}

#[test]
fn a_lens_that_does_nothing_changes_no_byte() {
    let (mesh, camera) = post();
    assert_eq!(with(&camera, [0.0; 5]), camera);
    let bench = Bench::new();
    let text = crate::scenes::SQUARE;
    bench.0.write("none.toml", text);
    bench.0.write("zero.toml", text.replace("[sensor]\n", "[sensor]\ndistortion = { k1 = 0.0, p2 = 0.0 }\n"));
    let read = |name: &str| scene_toml::read(&bench.0.join(name), &unwatched).unwrap().scene.exposure.camera.clone();
    assert!(bench.0.join("zero.toml").exists() && read("none.toml") == read("zero.toml"));
    // The pinhole's own centres: to rounding.
    let table = tabulated(&camera, |x, y| [x, y]);
    let [a, b] = [camera, table]
        .map(|camera| study::simulate(&scene(mesh.clone(), camera, [1.0, 0.3, 0.7]), &unwatched).unwrap().1);
    let (a, b) = (a.cube.band(0), b.cube.band(0));
    let most = a.iter().copied().fold(0.0, f64::max);
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12 * most) && most > 1.0);
}

#[test]
fn all_pixels_together_see_what_a_pinhole_sees() {
    let (mesh, camera) = post();
    let towards = sun(50.0, 30.0);
    let plain = see(&mesh, towards, &camera);
    let twist = |x: f64, y: f64| [0.9 * x - 0.3 * y + 0.2 * x * y, 0.3 * x + 0.9 * y - 0.3 * x * x];
    let facets = mesh.facets.len();
    let sums = |seen: &Seen, areas: &[f64]| {
        let mut sums = vec![[0.0; 2]; facets];
        for (pixel, area) in areas.iter().enumerate() {
            for (facet, shown, lit) in seen.footprints.pixel(pixel) {
                sums[facet as usize][0] += area * shown;
                sums[facet as usize][1] += area * lit;
            }
        }
        sums
    };
    let expected = sums(&plain, &vec![camera.pitch[0] * camera.pitch[0]; 24 * 24]);
    assert!(expected[..2].iter().all(|[shown, lit]| *lit > 0.0 && *lit < 0.98 * shown));
    for coefficients in [BARREL, PINCUSHION] {
        let camera = with(&camera, coefficients);
        let areas = areas(&camera, |at| undistorted(at, coefficients));
        let got = sums(&see(&mesh, towards, &camera), &areas);
        for (got, expected) in got.iter().flatten().zip(expected.iter().flatten()) {
            assert!((got - expected).abs() < 1e-12, "{got} {expected}");
        }
    }
    // A rotated, sheared and bent table, whose corners are means of centres.
    let bent = tabulated(&camera, twist);
    let centre = |i: f64, j: f64| twist((i + 0.5 - 12.0) * 0.03, (j + 0.5 - 12.0) * 0.03);
    let corner = |i: f64, j: f64| {
        // The table is quadratic: on beyond the rim linear, as given.
        let inside = |x: f64| x.clamp(1.0, 23.0);
        let mean = |i: f64, j: f64| {
            let around = [centre(i - 1.0, j - 1.0), centre(i, j - 1.0), centre(i - 1.0, j), centre(i, j)];
            [0, 1].map(|k| 0.25 * around.iter().map(|at| at[k]).sum::<f64>())
        };
        // Twice the difference of two centres is a step of one from the mean between them.
        let (x, y) = (inside(i), inside(j));
        let slope = |di: f64, dj: f64| {
            let (a, b) = ([x - 1.0, y - 1.0], [x, y]);
            let at = |u: f64, v: f64| centre(a[0] + u * (b[0] - a[0]), a[1] + v * (b[1] - a[1]));
            let (right, down) = match (di != 0.0, dj != 0.0) {
                (true, false) => ([at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(0.0, 1.0)]),
                _ => ([at(0.0, 1.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 0.0)]),
            };
            [0, 1].map(|k| 0.5 * (right[0][k] + right[1][k] - down[0][k] - down[1][k]))
        };
        let both = {
            let at = |u: f64, v: f64| centre(x - 1.0 + u, y - 1.0 + v);
            let (p, q, r, s) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0));
            [0, 1].map(|k| p[k] + s[k] - q[k] - r[k])
        };
        let (right, down, m) = (slope(1.0, 0.0), slope(0.0, 1.0), mean(x, y));
        [0, 1].map(|k| m[k] + (i - x) * right[k] + (j - y) * down[k] + (i - x) * (j - y) * both[k])
    };
    let areas = areas(&bent, |at| {
        let px = [0, 1].map(|k| (at[k] / bent.pitch[k] + bent.boresight_px[k]).round());
        corner(px[0], px[1])
    });
    let got = sums(&see(&mesh, towards, &bent), &areas);
    for (got, expected) in got.iter().flatten().zip(expected.iter().flatten()) {
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
    }
}

#[test]
fn radiance_of_textures_and_globes_is_conserved_too() {
    let (mesh, camera) = post();
    let plain = edited(&scene(mesh, camera.clone(), [1.0, 0.3, 0.7]), |parts| {
        let mesh = &parts.surface.mesh;
        let texel = |f: usize| mesh.facet(f).corners_m.map(|p| [(p.x + 4.0) * 2.0, (4.0 - p.y) * 2.0]);
        parts.surface.textures = vec![Texture {
            material: mmxrt::geometry::MaterialId(0),
            kind: TextureKind::Factor,
            corners: (0..mesh.facets.len()).map(texel).collect(),
            rows: 16,
            columns: 16,
            wavelength_um: vec![],
            values: (0..256).map(|i| 0.2 + f64::from(i * 37 % 101) / 100.0).collect(),
            texels: Texels::Nearest,
            lon_lat: None,
        }];
        // One globe before the ground, one behind it, in part.
        parts.sky.bodies =
            vec![globe("near", DVec3::new(1.0, 1.0, 8.0), 0.5), globe("far", DVec3::new(12.0, 1.0, -30.0), 4.0)];
        parts.models.bodies = 0;
    });
    let total = |scene: &Scene, areas: &[f64]| {
        let seen = study::simulate(scene, &unwatched).unwrap().1;
        let planes = ["GLOBE near", "GLOBE far"].map(|name| seen.backplanes.plane(name).unwrap().values.clone());
        [seen.cube.band(0), planes[0].clone(), planes[1].clone()]
            .map(|of| of.iter().zip(areas).map(|(x, area)| x * area).sum::<f64>())
    };
    let expected = total(&plain, &vec![camera.pitch[0] * camera.pitch[0]; 24 * 24]);
    for coefficients in [BARREL, PINCUSHION] {
        let camera = with(&camera, coefficients);
        let areas = areas(&camera, |at| undistorted(at, coefficients));
        let got = total(&edited(&plain, |parts| parts.exposure.camera = camera), &areas);
        // Outlines and integrals over globes are good to some 1e-6.
        for (got, expected) in got.iter().zip(expected) {
            assert!((got / expected - 1.0).abs() < 1e-5 && expected > 0.0, "{got} {expected}");
        }
    }
}

#[test]
fn a_pixel_of_even_ground_keeps_its_value() {
    // Pixels at the borders of strong barrels and pincushions, all full of ground to their last bit.
    let camera = camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 17, 0.05);
    let all: Vec<Vec<f64>> = [[0.0; 5], BARREL, PINCUSHION, SKEW]
        .iter()
        .map(|k| {
            let seen =
                study::simulate(&scene(plane(100.0, 0.0), with(&camera, *k), [1.0, 0.3, 0.7]), &unwatched).unwrap().1;
            let coverage = &seen.backplanes.plane("COVERAGE").unwrap().values;
            assert!(coverage.iter().all(|c| (c - 1.0).abs() < 1e-12), "{k:?}");
            seen.cube.band(0)
        })
        .collect();
    let value = all[0][0];
    assert!(value > 1.0 && all.iter().flatten().all(|x| (x / value - 1.0).abs() < 1e-12));
}

#[test]
fn a_centred_disc_has_the_area_of_its_distorted_circle() {
    // A disc of 720 sides and 3 m, 10 m away: r = 0.3 becomes r (1 + k1 r2).
    let n = 720;
    let rim = |i: u32| {
        let (sin, cos) = (2.0 * PI * f64::from(i) / f64::from(n)).sin_cos();
        [3.0 * cos, 3.0 * sin, 0.0]
    };
    let points: Vec<[f64; 3]> = std::iter::once([0.0; 3]).chain((0..n).map(rim)).collect();
    let facets: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    let (disc, plain) = (mesh(&points, &facets), camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 120, 0.006));
    let sides = 0.5 * f64::from(n) * (2.0 * PI / f64::from(n)).sin() / PI;
    for k1 in [0.0, -0.3, 0.5] {
        let seen = see(&disc, direction([0.2, 0.1, 1.0]), &with(&plain, [k1, 0.0, 0.0, 0.0, 0.0]));
        let (area_px, _) = totals(&seen, |_| true);
        let radius = 0.3 * (1.0 + k1 * 0.09) / 0.006;
        let expected = PI * radius * radius * sides;
        // Shares are of straight quadrilaterals, and pixels on the rim are not even: quadratic in a pixel.
        assert!((area_px / expected - 1.0).abs() < if k1 == 0.0 { 1e-12 } else { 5e-5 }, "{k1}: {area_px} {expected}");
    }
}

#[test]
fn a_marker_is_where_opencv_has_it() {
    // Tangents 0.3 and -0.2 at f = 400 and 380 px, principal point (330.5, 236.5): as worked by hand in geometry/lens.rs.
    let pinhole = camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 1, 1.0);
    let plain = FrameCamera {
        samples: 640,
        lines: 480,
        pitch: [1.0 / 400.0, 1.0 / 380.0],
        boresight_px: [330.5, 236.5],
        ..pinhole
    };
    let camera = with(&plain, [-0.1, 0.05, 0.02, 0.01, -0.02]);
    // Right is x, down is -y.
    let at = camera.place(DVec3::new(3.0, 2.0, 0.0)).unwrap();
    let expected = [330.5 + 400.0 * 0.288966682, 236.5 - 380.0 * 0.193077788];
    assert!((0..2).all(|k| (at[k] - expected[k]).abs() < 1e-11), "{at:?} {expected:?}");
    // Behind, and so far aside that the image has folded before: nowhere.
    assert_eq!(camera.place(DVec3::new(0.0, 0.0, 11.0)), None);
    let small = FrameCamera { samples: 320, lines: 240, boresight_px: [160.5, 120.0], ..plain };
    let folded = with(&small, [-0.3, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(folded.place(DVec3::new(11.0, 0.0, 0.0)), None);
    assert!(folded.place(DVec3::new(10.0, 0.0, 0.0)).is_some());
}

#[test]
fn locate_goes_both_ways_over_the_whole_image() {
    let plain = camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 20, 0.05);
    let fisheye = |x: f64, y: f64| {
        // Equidistant: tangents of angles, to 0.7 rad.
        let r = x.hypot(y);
        if r == 0.0 { [x, y] } else { [x * r.tan() / r, y * r.tan() / r] }
    };
    let rough = |x: f64, y: f64| [x + 4e-3 * (31.0 * x).sin() * (17.0 * y).cos(), y + 5e-3 * (23.0 * x + 1.0).cos()];
    let cameras = [BARREL, PINCUSHION, SKEW].map(|k| with(&plain, k));
    for camera in cameras.into_iter().chain([tabulated(&plain, fisheye), tabulated(&plain, rough)]) {
        let scene = scene(plane(1000.0, 0.0), camera, [1.0, 0.3, 0.7]);
        let locator = Locator::new(&scene, None);
        for (i, j) in (0..=40).flat_map(|i| (0..=40).map(move |j| (i, j))) {
            let place = Place { sample: 0.5 * f64::from(i), line: 0.5 * f64::from(j) };
            let ground = locator.ground(place, 0).unwrap().unwrap();
            let seen = locator.place(ground.point_m, 0).unwrap().unwrap();
            let off = (seen.place.sample - place.sample).hypot(seen.place.line - place.line);
            assert!(off < 1e-9, "{place:?}: {off:e}");
        }
        // Planes of the centre are those of the centre's ray.
        let seen = study::simulate(&scene, &unwatched).unwrap().1;
        let of = |name: &str| seen.backplanes.plane(name).unwrap().values.clone();
        let (x, y) = (of("BODYFIXEDX"), of("BODYFIXEDY"));
        for pixel in 0..400_u32 {
            let place = Place { sample: f64::from(pixel % 20) + 0.5, line: f64::from(pixel / 20) + 0.5 };
            let at = locator.ground(place, 0).unwrap().unwrap().point_m;
            let (x, y) = (x[pixel as usize], y[pixel as usize]);
            assert!((at.x - x).hypot(at.y - y) < 1e-11, "{pixel}");
        }
    }
}

#[test]
fn a_window_of_a_distorted_image_is_a_part_of_it() {
    let (mesh, camera) = post();
    for camera in [with(&camera, SKEW), tabulated(&camera, |x, y| [x + 0.2 * x * y, y - 0.2 * x * x])] {
        let image = |camera: FrameCamera| {
            study::simulate(&scene(mesh.clone(), camera, [1.0, 0.3, 0.7]), &unwatched).unwrap().1.cube.band(0)
        };
        let (all, part) = (image(camera.clone()), image(camera.window(5..12, 9..15)));
        for (i, value) in part.iter().enumerate() {
            let whole = all[(9 + i / 7) * 24 + 5 + i % 7];
            assert!((value - whole).abs() < 1e-12 * whole.max(1.0), "{i}: {value} {whole}");
        }
    }
    let other = FrameCamera { samples: 25, ..with(&camera, SKEW) };
    let parts = crate::scenes::parts(mesh, other, sun(30.0, 0.0));
    assert!(parts.check().unwrap_err().to_string().contains("not part of"));
}

/// Keys of the sensor of [`crate::scenes::SQUARE`].
const LENS: &str = "samples = 2\nlines = 2\nfov_deg = 0.45836379150820084\n";

#[test]
fn lenses_are_read_written_and_refused_where_they_are_wrong() {
    let bench = Bench::new();
    let write = |lens: &str| bench.0.write("scene.toml", crate::scenes::SQUARE.replace(LENS, lens));
    let read = |name: &str| scene_toml::read(&bench.0.join(name), &unwatched).map_err(|e| e.to_string());
    let npy = |shape: &str, numbers: &[f64]| {
        let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        bytes.extend(format!("{text:<117}\n").bytes());
        bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        std::fs::write(bench.0.join("d.npy"), bytes).unwrap();
    };
    let distorted =
        "samples = 6\nlines = 4\nfocal_px = [30, 28]\nboresight_px = [2.5, 2]\ndistortion = { k1 = -0.1, p1 = 1e-3 }\n";
    let table = "samples = 2\nlines = 2\ndirections = \"d.npy\"\n";
    let vectors = [[-1.0, -1.0, 10.0], [1.0, -1.0, 10.0], [-1.0, 1.0, 10.0], [2.0, 2.0, 20.0]].concat();
    npy("(2, 2, 3)", &vectors);
    for lens in [distorted, table] {
        write(lens);
        let before = read("scene.toml").unwrap().scene.exposure.camera.clone();
        let (code, _, err) =
            run(&["convert", &bench.0.argument("scene.toml"), &bench.0.argument("again/scene.toml"), "--force"]);
        assert_eq!(code, 0, "{err}");
        let after = read("again/scene.toml").unwrap().scene.exposure.camera.clone();
        assert!(before == after && before.lens.is_some());
    }
    write(table);
    let camera = read("scene.toml").unwrap().scene.exposure.camera.clone();
    assert!((camera.pitch[0] - 0.2).abs() < 1e-15 && (camera.boresight_px[1] - 1.0).abs() < 1e-15);
    bench.0.write("d.csv", "x, y\n-0.1,-0.1\n0.1,-0.1\n-0.1,0.1\n0.1,0.1\n");
    write(&table.replace("npy", "csv"));
    assert_eq!(read("scene.toml").unwrap().scene.exposure.camera.lens, camera.lens);

    let wrong = |lens: &str, messages: &[&str]| {
        write(lens);
        let error = read("scene.toml").unwrap_err();
        assert!(messages.iter().all(|message| error.contains(message)), "{error}");
    };
    wrong(&distorted.replace("-0.1", "-40.0"), &["sensor.distortion", "folded", "scene.toml:"]);
    wrong(&distorted.replace("-0.1", "nan"), &["not a finite number"]);
    wrong(&distorted.replace("p1 =", "p3 ="), &["p3"]);
    wrong(&format!("{table}fov_deg = 3\n"), &["sensor.directions", "says all"]);
    wrong(&format!("{table}distortion = {{ k1 = 0.1 }}\n"), &["sensor.directions", "says all"]);
    wrong("samples = 2\nlines = 2\nfit = \"scene\"\ndirections = \"d.npy\"\n", &["give one of"]);
    wrong("samples = 3\nlines = 2\ndirections = \"d.npy\"\n", &["d.npy", "shape [2, 2, 3]", "(2, 3, 2)"]);
    npy("(4, 3)", &vectors[..11]);
    wrong(table, &["d.npy", "11 numbers of 12"]);
    npy("(4, 2)", &[-0.1, -0.1, 0.1, f64::NAN, -0.1, 0.1, 0.1, 0.1]);
    wrong(table, &["d.npy", "pixel 1 of line 0"]);
    npy("(4, 3)", &vectors.iter().map(|x| -x).collect::<Vec<f64>>());
    wrong(table, &["looks along", "above 0"]);
    npy("(4, 2)", &[-0.1, -0.1, 0.1, -0.1, -0.1, 0.1, -0.2, 0.1]);
    wrong(table, &["d.npy", "fold"]);
    npy("(4, 2)", &[-80.0, -0.1, 80.0, -0.1, -80.0, 0.1, 80.0, 0.1]);
    wrong(table, &["89 deg"]);
    let csv = table.replace("npy", "csv");
    bench.0.write("d.csv", "x,y\n-0.1,-0.1\n0.1,oops\n-0.1,0.1\n0.1,0.1\n");
    wrong(&csv, &["d.csv:3", "oops"]);
    bench.0.write("d.csv", "x,y\n-0.1,-0.1\n");
    wrong(&csv, &["1 directions for 2 x 2 pixels"]);
    bench.0.write("d.csv", "u,v\n1,2\n");
    wrong(&csv, &["d.csv:1", "header"]);
}

#[test]
fn a_map_of_a_distorted_camera_is_laid_where_it_was_seen() {
    let bench = Bench::new();
    // 24 x 24 pixels of the square's 8 m, 8 m wide at r = 0.004: k1 r2 = -0.064 at the sides, 0.8 pixels.
    let lens = "samples = 24\nlines = 24\nfov_deg = 0.45836379150820084\ndistortion = { k1 = -4000 }\n";
    bench.0.write("scene.toml", crate::scenes::SQUARE.replace(LENS, lens));
    let rows = |i: u32| (0..24).map(move |j| f64::from((i * 7 + j * 11) % 5) + 1.0);
    let text: Vec<String> = (0..24).map(|i| rows(i).map(|x| x.to_string()).collect::<Vec<_>>().join(",")).collect();
    bench.0.write("m.csv", text.join("\n") + "\n");
    bench.map(
        "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\nplacement = \"camera\"\nscene = \"scene.toml\"\n",
    );
    let image = bench.integrate(&["--radiance", "{}m.csv", "--unknown", "nan", "--quantity", "radiance"]);
    let raster: Vec<f64> = (0..24).flat_map(rows).collect();
    // Pixels all of the square, whose sides are at 4 m / 1 km of r: the image of 0.00368 is 0.88 of the way to the border.
    let inner = (0..576).filter(|i| (3..21).contains(&(i % 24)) && (3..21).contains(&(i / 24)));
    let off = inner.map(|i| (image[i] - raster[i]).abs()).fold(0.0, f64::max);
    // Borders of texels are curved, of pixels straight: by 0.006 pixels at most, of a difference of 4 on each of four sides.
    assert!(off < 0.1, "{off}");
}
