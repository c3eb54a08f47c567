//! What must not change an image: where the body's coordinates start, and how far the Sun is along its ray.

use crate::scratch::Scratch;
use crate::shapes::*;
use glam::DVec3;
use mmxrt::geometry::{Direction, Mesh};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::study::Observation;
use mmxrt::units::AU_M;

/// Hills with a box in them, 40 m wide; all coordinates are whole multiples of 2^-10 m.
fn site() -> Mesh {
    let hills = grid(20.0, 16, |x, y| 3.0 * (0.5 * x).sin() + 2.0 * (0.4 * y + 0.1 * x).cos());
    let mut site = joined(&[hills, of_material(cuboid([-4.0, -4.0, -3.0], [1.0, 2.0, 7.0]), 1)]);
    site.vertices_m.iter_mut().for_each(|v| *v = (*v * 1024.0).round() / 1024.0);
    site
}

/// The site moved, for a file in body coordinates.
fn moved(mut mesh: Mesh, by_m: DVec3) -> Mesh {
    mesh.vertices_m.iter_mut().for_each(|v| *v += by_m);
    mesh
}

/// Where the site is on its body, m; whole numbers.
const PLACE: DVec3 = DVec3::new(3072.0, -5120.0, 1024.0);
const SUN: DVec3 = DVec3::new(2e11, -0.5e11, 0.9e11);

/// A scene around `place`: everything is given in body coordinates, but for a mesh of `local` ones.
fn text(origin_m: DVec3, place: DVec3, sun: &str, coordinates: &str) -> String {
    from_afar(1.0, origin_m, place, sun, coordinates)
}

/// The same for a site so many times as large, from so many times as far.
fn from_afar(times: f64, origin_m: DVec3, place: DVec3, sun: &str, coordinates: &str) -> String {
    let mars = place + DVec3::new(9e6, 1e6, 2e6);
    let observer = place + times * DVec3::new(20.0, -30.0, 90.0);
    let list = |v: DVec3| format!("{:?}", v.to_array());
    format!(
        r#"
mmxrt_scene = 1
origin_m = {}
[[mesh]]
obj = "site.obj"
coordinates = "{coordinates}"
[materials]
ground = {{ reflectance = 0.07 }}
box = {{ reflectance = 0.2 }}
[sun]
{sun}
[mars]
position_m = {}
[observer]
position_m = {}
target_m = {}
up = [0.0, 1.0, 0.0]
[sensor]
samples = 24
lines = 24
fov_deg = 20.0
bands = {{ centres_um = [1.0, 2.5, 3.6] }}
"#,
        list(origin_m),
        list(mars),
        list(observer),
        list(place)
    )
}

fn sun_at(position_m: DVec3) -> String {
    format!("position_m = {:?}", position_m.to_array())
}

fn look(scratch: &Scratch, mesh: &Mesh, text: &str) -> Observation {
    scratch.obj("site", mesh, &[("ground", None), ("box", None)]);
    scratch.look(text)
}

/// Planes that depend on where the body's centre is.
fn is_body_fixed(name: &str) -> bool {
    let name = name.trim_end_matches("_MEAN");
    let by_radius = ["RADIUS", "INCIDENCE", "EMISSION", "SLOPE", "SLOPEAZIMUTH"];
    ["LATITUDE", "LONGITUDE", "BODYFIXEDX", "BODYFIXEDY", "BODYFIXEDZ"].contains(&name) || by_radius.contains(&name)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn cube(seen: &Observation) -> Vec<f64> {
    seen.cube.to_array().into_raw_vec_and_offset().0
}

/// Largest difference of two lists over the largest value; NaN only beside NaN.
fn difference(one: &[f64], two: &[f64]) -> f64 {
    assert_eq!(one.len(), two.len());
    let (mut most, mut largest) = (0.0f64, 0.0f64);
    for (a, b) in one.iter().zip(two) {
        assert_eq!(a.is_nan(), b.is_nan());
        if !a.is_nan() {
            most = most.max((a - b).abs());
            largest = largest.max(a.abs());
        }
    }
    most / largest.max(f64::MIN_POSITIVE)
}

/// There is something to get wrong: shadows, facets of both materials, all pixels covered or nearly.
fn assert_worth_looking_at(seen: &Observation) {
    assert!(seen.counts.partly_lit_facets > 50, "{:?}", seen.counts);
    let plane = |name: &str| &seen.backplanes.plane(name).unwrap().values;
    assert!(plane("LIT_FRACTION").iter().filter(|v| (0.01..0.99).contains(*v)).count() > 50);
    assert!(plane("MATERIAL").iter().filter(|v| **v == 1.0).count() > 5);
}

#[test]
fn moving_the_body_by_2_23_m_changes_no_bit() {
    let scratch = Scratch::new();
    let by_m = DVec3::new(8_388_608.0, -8_388_608.0, 8_388_608.0);
    let here = text(PLACE, PLACE, &sun_at(PLACE + SUN), "body");
    let there = text(PLACE + by_m, PLACE + by_m, &sun_at(PLACE + by_m + SUN), "body");
    let local = text(PLACE + by_m, PLACE + by_m, &sun_at(PLACE + by_m + SUN), "local");
    let one = look(&scratch, &moved(site(), PLACE), &here);
    assert_worth_looking_at(&one);
    let mut same = 0;
    for (mesh, text) in [(moved(site(), PLACE + by_m), &there), (site(), &local)] {
        let two = look(&scratch, &mesh, text);
        assert!(
            bits(&cube(&one)) == bits(&cube(&two)),
            "radiance differs by {:e}",
            difference(&cube(&one), &cube(&two))
        );
        for (a, b) in one.backplanes.planes.iter().zip(&two.backplanes.planes) {
            assert_eq!(a.name, b.name);
            if let Some(axis) = ["BODYFIXEDX", "BODYFIXEDY", "BODYFIXEDZ"].iter().position(|n| a.name.starts_with(n)) {
                // To the rounding of a number of 8e6.
                let back: Vec<f64> = b.values.iter().map(|v| v - by_m[axis]).collect();
                assert!(a.values.iter().zip(&back).all(|(a, b)| (a - b).abs() <= 1e-9 || a.is_nan() && b.is_nan()));
            } else if !is_body_fixed(&a.name) {
                assert!(bits(&a.values) == bits(&b.values), "{} differs", a.name);
                same += 1;
            }
        }
    }
    assert!(same >= 2 * 20, "{same} planes");
}

#[test]
fn moving_the_body_by_1e7_m_changes_the_ninth_digit_at_most() {
    let scratch = Scratch::new();
    // Pixels of 14 m, and coordinates that 1e7 m cuts off at 2e-9 m.
    let mut mesh = site();
    mesh.vertices_m.iter_mut().for_each(|v| *v = *v * 10.1 + DVec3::splat(std::f64::consts::FRAC_1_PI));
    let by_m = DVec3::new(-1e7, 1e7, 1e7);
    let scene = |place: DVec3| from_afar(10.0, place, place, &sun_at(place + SUN), "body");
    let one = look(&scratch, &moved(mesh.clone(), PLACE), &scene(PLACE));
    let two = look(&scratch, &moved(mesh, PLACE + by_m), &scene(PLACE + by_m));
    assert_worth_looking_at(&one);
    let off = difference(&cube(&one), &cube(&two));
    assert!(off > 0.0 && off <= 1e-9, "radiance differs by {off:e}");
    for name in ["COVERAGE", "LIT_FRACTION", "RANGE_MEAN", "LOCALINCIDENCE_MEAN", "PHASE_MEAN"] {
        let [a, b] = [&one, &two].map(|o| &o.backplanes.plane(name).unwrap().values);
        assert!(difference(a, b) <= 1e-9, "{name} differs by {:e}", difference(a, b));
    }
}

#[test]
fn another_origin_for_the_same_place_shows_the_same() {
    let scratch = Scratch::new();
    let other = PLACE + DVec3::new(300.0, -200.0, 100.0);
    // Not by the Sun's position: its direction is taken from the origin.
    let sun = "direction = [2.0, -0.5, 0.9]\ndistance_au = 1.5";
    let mesh = moved(site(), PLACE);
    let one = look(&scratch, &mesh, &text(PLACE, PLACE, sun, "body"));
    let two = look(&scratch, &mesh, &text(other, PLACE, sun, "body"));
    assert_worth_looking_at(&one);
    let off = difference(&cube(&one), &cube(&two));
    assert!(off <= 1e-9, "radiance differs by {off:e}");
    let mut seen = 0;
    for (a, b) in one.backplanes.planes.iter().zip(&two.backplanes.planes) {
        // Values of the centre ray jump where it changes facets; means and whole numbers of pixels do not.
        if a.name.ends_with("_MEAN") || ["COVERAGE", "LIT_FRACTION"].contains(&a.name.as_str()) {
            assert!(difference(&a.values, &b.values) <= 1e-9, "{}", a.name);
            seen += 1;
        }
    }
    assert!(seen >= 12, "{seen} planes");
}

#[test]
fn the_sun_casts_the_same_shadows_from_any_distance_along_its_ray() {
    let scratch = Scratch::new();
    scratch.obj("site", &moved(site(), PLACE), &[("ground", None), ("box", None)]);
    let scene = |sun: &str| -> Scene { scratch.scene(&text(PLACE, PLACE, sun, "body")) };
    let shadows = |scene: &Scene, towards: Direction| {
        let (mesh, topology) = (&scene.body.mesh, scene.body.topology());
        mmxrt::visibility::Seen::from_afar(mesh, topology, towards, "sunlight", &unwatched).unwrap()
    };
    let true_m = SUN.length();
    let reference = scene(&sun_at(PLACE + SUN));
    let lit = shadows(&reference, reference.sky.sun.direction);
    assert!(lit.polygon_facet.len() > 100);
    let mut same_direction = 0;
    for distance_m in [true_m, AU_M, 1e15] {
        // Along the ray, as near as its coordinates in the body frame are rounded.
        let by_position = scene(&sun_at(PLACE + SUN * (distance_m / true_m)));
        assert!((by_position.sky.sun.distance_m / distance_m - 1.0).abs() < 1e-15);
        let by_direction = scene(&format!("direction = {:?}\ndistance_au = {:?}", SUN.to_array(), distance_m / AU_M));
        for other in [&by_position, &by_direction] {
            let far = shadows(other, other.sky.sun.direction);
            if other.sky.sun.direction == reference.sky.sun.direction {
                same_direction += 1;
                assert!(far == lit, "{distance_m} m");
            }
            for f in 0..other.body.mesh.facets.len() as u32 {
                let (here, there) = (lit.fraction(f), far.fraction(f));
                assert!((here - there).abs() <= 1e-12, "facet {f}, {distance_m} m: {here} {there}");
            }
        }
    }
    assert!(same_direction >= 1, "no direction was the same to the bit");
}

#[test]
fn mars_is_where_it_is_from_any_origin() {
    let scratch = Scratch::new();
    scratch.obj("site", &site(), &[("ground", None), ("box", None)]);
    let centre_m = |place: DVec3| -> DVec3 {
        scratch.scene(&text(place, PLACE, &sun_at(SUN), "local")).sky.mars.as_ref().expect("Mars").centre_m + place
    };
    assert_eq!(centre_m(PLACE), PLACE + DVec3::new(9e6, 1e6, 2e6));
    assert_eq!(centre_m(PLACE + DVec3::new(512.0, 0.0, -512.0)), centre_m(PLACE));
}
