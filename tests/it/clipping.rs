//! Corners that rounding has put anywhere: they must not decide what is cut off, nor where a point lies.

use std::path::Path;

use crate::scratch::Scratch;
use crate::shapes::*;
use glam::DVec3;
use mmxrt::formats::scene_toml;
use mmxrt::geometry::Mesh;
use mmxrt::geometry::polygon::{Point, area, holds, intersect};
use mmxrt::integrate::Wanted;
use mmxrt::progress::{Progress, unwatched};
use mmxrt::scene::Scene;
use mmxrt::study::{self, Observation};
use mmxrt::visibility::Shown;
use mmxrt::{Error, solve};

/// A number within a range.
fn within(numbers: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * numbers.share()
}

/// How a clean polygon is put somewhere else: turned, enlarged, moved.
struct Place {
    turn: f64,
    size: f64,
    by: Point,
}

impl Place {
    fn of(&self, [x, y]: Point) -> Point {
        let (sin, cos) = self.turn.sin_cos();
        [self.size * (cos * x - sin * y) + self.by[0], self.size * (sin * x + cos * y) + self.by[1]]
    }
}

/// A polygon with more corners, some at the old ones and some along the sides, each moved by up to `noise`; also several at a place.
fn with_noise(polygon: &[Point], noise: f64, numbers: &mut Random) -> Vec<Point> {
    let mut noisy = Vec::new();
    for (i, p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let mut steps: Vec<f64> = (0..numbers.whole(0, 3)).map(|_| numbers.share()).collect();
        steps.push(0.0);
        steps.sort_by(f64::total_cmp);
        for t in steps {
            for _ in 0..1 + numbers.whole(0, 3) {
                let moved = |k: usize, by: f64| p[k] + t * (q[k] - p[k]) + by;
                noisy.push([moved(0, within(numbers, -noise, noise)), moved(1, within(numbers, -noise, noise))]);
            }
        }
    }
    noisy
}

/// What the triangle (0, 0), (1, 0), (0, 1) has in common with the square from (x, y) to (x + s, y + s), x and y not negative:
/// what the corner at (x, y) cuts off the triangle, less what the others do.
fn in_triangle(x: f64, y: f64, s: f64) -> f64 {
    let corner = |x: f64, y: f64| (1.0 - x - y).max(0.0).powi(2) / 2.0;
    corner(x, y) - corner(x + s, y) - corner(x, y + s) + corner(x + s, y + s)
}

#[test]
fn noise_in_the_corners_moves_no_area() {
    let mut numbers = Random(7);
    let (mut out, mut spare) = (vec![], vec![]);
    let (mut worst, mut tried) = (0.0_f64, 0);
    for round in 0..20_000 {
        let [x, y, s] =
            [within(&mut numbers, 0.0, 0.8), within(&mut numbers, 0.0, 0.8), within(&mut numbers, 0.05, 0.9)];
        let far = [0.0, 1.0, 1e3, 1e5, 1e7][round % 5];
        let place = Place {
            turn: if round % 3 == 0 { 0.0 } else { within(&mut numbers, 0.0, 6.3) },
            size: within(&mut numbers, 0.3, 3.0),
            by: [far * within(&mut numbers, -1.0, 1.0), far * within(&mut numbers, -1.0, 1.0)],
        };
        let rounding = f64::EPSILON * (far + 4.0);
        let noise = [0.0, 1.0, 10.0, 1e3][numbers.whole(0, 3) as usize] * rounding;
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|p| place.of(p));
        let square = [[x, y], [x + s, y], [x + s, y + s], [x, y + s]].map(|p| place.of(p));
        let expected = in_triangle(x, y, s) * place.size * place.size;
        let (a, b) = (with_noise(&triangle, noise, &mut numbers), with_noise(&square, noise, &mut numbers));
        // Corners move by so much, along outlines of less than 4 sides each.
        let allowed = (2.0 * noise + 8.0 * rounding) * 8.0 * place.size;
        for (a, b) in [(&a, &b), (&b, &a)] {
            intersect(a, b, &mut out, &mut spare);
            let error = (area(&out) - expected).abs();
            worst = worst.max(error / allowed);
            assert!(
                error <= allowed,
                "{round}: {} instead of {expected}, {error:e} > {allowed:e}\n{a:?}\n{b:?}",
                area(&out)
            );
            tried += 1;
        }
    }
    assert!(tried == 40_000 && worst > 1e-3, "{worst}");
}

#[test]
fn what_is_as_narrow_as_rounding_has_no_area() {
    let square = [[300.0, 300.0], [301.0, 300.0], [301.0, 301.0], [300.0, 301.0]];
    let (mut out, mut spare) = (vec![], vec![]);
    let up = |x: f64, n: u64| f64::from_bits(x.to_bits() + n);
    // Spikes, doubled corners, and a polygon that runs back over itself.
    let narrow: [&[Point]; 5] = [
        &[[300.1, 300.1], [300.9, 300.9], [300.5, up(300.5, 1)]],
        &[[300.1, 300.5], [300.9, 300.5], [300.9, 300.5], [300.1, 300.5]],
        &[[300.1, 300.5], [300.9, 300.5], [300.9, up(300.5, 2)], [300.1, up(300.5, 1)]],
        &[[300.1, 300.5], [300.9, 300.5], [300.3, 300.5], [300.7, 300.5]],
        &[[300.5, 300.5], [300.5, 300.5], [300.5, 300.5]],
    ];
    for polygon in narrow {
        for (a, b) in [(polygon, &square[..]), (&square[..], polygon)] {
            intersect(a, b, &mut out, &mut spare);
            assert!(area(&out).abs() <= 4.0 * 301.0 * f64::EPSILON, "{polygon:?}: {out:?}");
        }
    }
}

#[test]
fn noise_in_the_corners_moves_no_point_out() {
    let mut numbers = Random(11);
    for round in 0..20_000 {
        let far = [0.0, 1.0, 1e3, 1e7][round % 4];
        let place = Place { turn: within(&mut numbers, 0.0, 6.3), size: 1.0, by: [far, -far] };
        let noise = [1.0, 10.0, 1e3][numbers.whole(0, 2) as usize] * f64::EPSILON * (far + 4.0);
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|p| place.of(p));
        let noisy = with_noise(&triangle, noise, &mut numbers);
        let [x, y] = [within(&mut numbers, -0.5, 1.5), within(&mut numbers, -0.5, 1.5)];
        // How far inside, for certain.
        let inside = x.min(y).min(1.0 - x - y);
        if inside.abs() > 16.0 * noise {
            assert_eq!(holds(&noisy, place.of([x, y])), inside > 0.0, "{x} {y} {noise:e}: {noisy:?}");
        }
    }
}

fn data(case: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geometry").join(case)
}

fn scene(case: &str) -> Scene {
    scene_toml::read(&data(case).join("s.toml"), &unwatched).unwrap_or_else(|e| panic!("{case}: {e}")).scene
}

fn values<'a>(seen: &'a Observation, name: &str) -> &'a [f64] {
    &seen.backplanes.plane(name).unwrap().values
}

fn assert_sound(seen: &Observation) {
    for check in &seen.checks {
        assert!(check.value <= check.limit, "{check:?}");
    }
}

/// Images of a few facets with each pixel's right value, by half-planes and sums over slabs in quadruple precision.
#[test]
fn shadows_within_pixels_are_whole() {
    for case in
        ["noise_edge_3_facets", "noise_edge_3_facets_7pct", "noise_edge_box_in_ground", "walls_edge_on_to_the_sun"]
    {
        let (_, seen) = study::simulate(&scene(case), &unwatched).unwrap();
        assert_sound(&seen);
        let (coverage, cube) = (values(&seen, "COVERAGE"), seen.cube.to_array());
        let expected = std::fs::read_to_string(data(case).join("expected.csv")).unwrap();
        let mut pixels = 0;
        for line in expected.lines().skip(1) {
            let right: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
            let (line, sample) = (right[0] as usize, right[1] as usize);
            assert!(
                (coverage[line * seen.cube.axes.samples + sample] - right[2]).abs() < 1e-11,
                "{case} {line} {sample}"
            );
            // The Sun's irradiance is 1000.
            let radiance = cube[[line, sample, 0]] * std::f64::consts::PI / 1000.0;
            assert!((radiance - right[3]).abs() < 1e-11, "{case} {line} {sample}: {radiance} not {}", right[3]);
            pixels += 1;
        }
        assert_eq!(pixels, seen.cube.axes.samples * seen.cube.axes.lines);
    }
}

/// Where all that a pixel sees is lit, or dark, so is what its centre sees; where all is covered, the centre sees something.
fn assert_mask_agrees(seen: &Observation) -> [usize; 2] {
    let [mask, lit, coverage, range] =
        ["SUNILLUMINATIONMASK", "LIT_FRACTION", "COVERAGE", "RANGE"].map(|name| values(seen, name));
    let mut counted = [0; 2];
    for i in 0..mask.len() {
        if coverage[i] < 1.0 - 1e-12 {
            continue;
        }
        assert!(range[i].is_finite(), "pixel {i} is covered, but not its centre");
        if lit[i] > 1.0 - 1e-12 || lit[i] == 0.0 {
            assert_eq!(mask[i], lit[i].round(), "pixel {i}");
            counted[lit[i].round() as usize] += 1;
        }
    }
    counted
}

#[test]
fn the_centre_of_a_lit_pixel_is_lit() {
    let (_, seen) = study::simulate(&scene("rough_body"), &unwatched).unwrap();
    let [dark, lit] = assert_mask_agrees(&seen);
    assert!(dark > 1000 && lit > 1000, "{dark} {lit}");
    let mut numbers = Random(3);
    for round in 0..6 {
        let mut body = sphere([0.0; 3], 1.0, 3);
        body.vertices_m.iter_mut().for_each(|v| *v *= within(&mut numbers, 0.93, 1.07));
        let scratch = Scratch::new();
        scratch.obj("body", &body, &[("ground", None)]);
        let sun = [within(&mut numbers, -1.0, 1.0), 1.0, within(&mut numbers, 0.0, 0.4)];
        let seen = scratch.look(&format!(
            "{}[observer]\nposition_m = [0.3, {}, 6.0]\ntarget_m = [0.0, 0.0, 0.0]\nup = [0.0, 1.0, 0.0]\n\
             [sensor]\nsamples = 96\nlines = 96\nfov_deg = 16.0\nbands = {{ centres_um = [1.0] }}\n",
            body_text(sun),
            f64::from(round) - 2.5
        ));
        assert_sound(&seen);
        let [dark, lit] = assert_mask_agrees(&seen);
        assert!(dark + lit > 1000, "{dark} {lit}");
    }
}

fn body_text(sun: [f64; 3]) -> String {
    format!(
        "mmxrt_scene = 1\norigin_m = [0.0, 0.0, 0.0]\n[[mesh]]\nobj = \"body.obj\"\ncoordinates = \"local\"\n\
         [materials]\nground = {{ reflectance = 0.1 }}\n[sun]\ndirection = {sun:?}\ndistance_au = 1.0\n"
    )
}

/// A camera 10 m above the origin, whose lines run along x; pixels of 1 m on the ground.
fn from_above(samples: u32) -> String {
    format!(
        "[observer]\nposition_m = [0.0, 0.0, 10.0]\nh = [1.0, 0.0, 0.0]\nv = [0.0, -1.0, 0.0]\nu = [0.0, 0.0, -1.0]\n\
         [sensor]\nsamples = {samples}\nlines = {samples}\nfov_deg = {}\nbands = {{ centres_um = [1.0] }}\n",
        2.0 * (f64::from(samples) / 20.0).atan().to_degrees()
    )
}

#[test]
fn an_inner_side_is_dark_at_the_centre_too() {
    let (_, seen) = study::simulate(&scene("inner_side"), &unwatched).unwrap();
    let [dark, lit] = assert_mask_agrees(&seen);
    assert!(dark > 100 && lit > 100, "{dark} {lit}");
}

#[test]
fn centres_on_seams_see_what_is_around_them() {
    // Pixels whose centres are corners of facets, of roofs of boxes, and of shadows: boxes of whole metres, as high as pixels are wide.
    let scratch = Scratch::new();
    let mut all = vec![grid(5.5, 11, |_, _| 0.0)];
    for (x, y) in [(-3.0, -2.0), (0.0, 1.0), (2.0, -3.0), (2.0, 3.0)] {
        all.push(cuboid([x, y, -1.0], [x + 1.0, y + 1.0, 0.0]));
        all.push(cuboid([x - 0.5, y - 0.5, -0.5], [x + 0.5, y + 0.5, 1.0]));
    }
    for sun in [[1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 2.0], [0.0, -1.0, 3.0], [0.3, -0.7, 0.4]] {
        scratch.obj("body", &joined(&all), &[("ground", None)]);
        let seen = scratch.look(&(body_text(sun) + &from_above(11)));
        assert_sound(&seen);
        let [dark, lit] = assert_mask_agrees(&seen);
        assert!(dark + lit > 50, "{dark} {lit}");
    }
}

#[test]
fn walls_edge_on_to_the_sun_are_dark() {
    let mut numbers = Random(5);
    for round in 0..12 {
        let mut all = vec![plane(8.0, 0.0)];
        for _ in 0..40 {
            let [x, y, z] =
                [within(&mut numbers, -6.0, 6.0), within(&mut numbers, -6.0, 6.0), within(&mut numbers, 0.1, 2.0)];
            let [dx, dy] = [within(&mut numbers, 0.1, 2.0), within(&mut numbers, 0.1, 2.0)];
            all.push(cuboid([x, y, -0.5], [x + dx, y + dy, z]));
        }
        let mut mesh = joined(&all);
        // Where coordinates lose digits as well.
        let far = [0.0, 1e3, 1e6][round % 3];
        mesh.vertices_m.iter_mut().for_each(|v| *v += DVec3::new(far, -far, far));
        let scratch = Scratch::new();
        scratch.obj("body", &mesh, &[("ground", None)]);
        let view = from_above(16).replace("[0.0, 0.0, 10.0]", &format!("[{far:?}, {:?}, {:?}]", -far, far + 10.0));
        let direction = [[1.0, 0.0, 1.0], [0.0, 1.0, 2.0], [0.3, 0.0, 0.1], [0.0, -1.0, 0.0]][round % 4];
        let scene = scratch.scene(&(body_text(direction) + &view));
        let (table, seen) = study::simulate(&scene, &unwatched).unwrap();
        assert_sound(&seen);
        let sunlit = table.sunlit().unwrap();
        let mut edge_on = 0;
        for f in 0..mesh.facets.len() {
            let cos_i = mesh.facet(f).normal().dot(scene.sky.sun.direction.vec());
            if cos_i.abs() < 1e-12 {
                assert_eq!(sunlit.shown[f], Shown::Nothing, "facet {f}, cos i {cos_i}");
                edge_on += 1;
            }
        }
        assert!(edge_on >= 80, "{edge_on}");
        // What is written is a polygon, not noise: rounding, relative to what the facet is wide to the Sun, is all it may stick out by.
        for uv in &sunlit.uv {
            assert!(uv[0] > -1e-6 && uv[1] > -1e-6 && uv[0] + uv[1] < 1.0 + 1e-6, "{uv:?}");
        }
    }
}

/// A square of 1 m, so many times, each time changed a little.
fn layers(count: u32, change: impl Fn(u32, usize, DVec3) -> DVec3) -> Mesh {
    let square = quad([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]);
    let turned = mesh(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 3], [1, 2, 3]]);
    let copies: Vec<Mesh> = (0..count)
        .map(|i| {
            let mut copy = if i % 3 == 2 { turned.clone() } else { square.clone() };
            copy.vertices_m.iter_mut().enumerate().for_each(|(k, v)| *v = change(i, k, *v));
            copy
        })
        .collect();
    joined(&copies)
}

fn of_layers(scratch: &Scratch, mesh: &Mesh, samples: u32) -> Scene {
    scratch.obj("body", mesh, &[("ground", None)]);
    scratch.scene(&format!(
        "{}[observer]\nposition_m = [3.0, 1.0, 5.0]\ntarget_m = [0.5, 0.5, 0.0]\nup = [0.0, 1.0, 0.0]\n\
         [sensor]\nsamples = {samples}\nlines = {samples}\nfit = \"scene\"\nbands = {{ centres_um = [1.0] }}\n",
        body_text([0.0, 0.6, 0.8])
    ))
}

#[test]
fn layers_on_one_another_are_one() {
    let scratch = Scratch::new();
    let look = |mesh: &Mesh| {
        let (_, seen) = study::simulate(&of_layers(&scratch, mesh, 16), &unwatched).unwrap();
        assert_sound(&seen);
        seen
    };
    let one = look(&layers(1, |_, _, v| v));
    let pseudo = |i: u32, k: usize, axis: u64| Random(u64::from(i) * 31 + k as u64 * 7 + axis).share() - 0.5;
    let ulps = |i: u32, k: usize, v: DVec3| v + 1e-15 * DVec3::new(pseudo(i, k, 1), pseudo(i, k, 2), pseudo(i, k, 3));
    let tilted = |i: u32, k: usize, v: DVec3| v + DVec3::new(0.0, 0.0, 1e-13 * pseudo(i, k, 4));
    // What lies as deep as rounding tells is one surface; deeper, each is seen and lit for itself.
    let changes: [(&str, bool, &dyn Fn(u32, usize, DVec3) -> DVec3); 4] = [
        ("copies", true, &|_, _, v| v),
        ("moved by an ulp", true, &ulps),
        ("larger and larger", true, &|i, _, v| v * (1.0 + 1e-15 * f64::from(i))),
        ("tilted", false, &tilted),
    ];
    let same = |a: &[f64], b: &[f64]| {
        assert!(!a.is_empty() && a.len() == b.len());
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-10 * a.abs().max(1.0))
    };
    for (name, is_one, change) in changes {
        for count in [80, 300] {
            let many = look(&layers(count, change));
            assert!(same(values(&one, "COVERAGE"), values(&many, "COVERAGE")), "{count} {name}");
            let [a, b] = [&one, &many].map(|seen| seen.cube.to_array().into_iter().collect::<Vec<f64>>());
            assert!(!is_one || same(&a, &b), "{count} {name}");
        }
    }
}

#[test]
fn one_cell_that_takes_long_hears_that_it_should_stop() {
    let scratch = Scratch::new();
    let pseudo = |i: u32, k: usize| Random(u64::from(i) * 31 + k as u64 * 7).share() - 0.5;
    // Planes that all pierce one another.
    let scene = of_layers(&scratch, &layers(1000, |i, k, v| v + DVec3::new(0.0, 0.0, 0.1 * pseudo(i, k))), 1);
    let table = solve::lit(&scene, &unwatched).unwrap();
    // Between the beginning of the image and the end of its only line.
    let stop = |p: Progress| p.stage != "image" || p.done != 0;
    assert!(matches!(study::observe(&scene, &table, Wanted::default(), &stop), Err(Error::Interrupted)));
}
