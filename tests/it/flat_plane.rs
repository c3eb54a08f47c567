//! From scene files to radiance on surfaces so simple that a page of paper gives the number.

use crate::scratch::Scratch;
use crate::shapes::*;
use glam::DVec3;
use mmxrt::geometry::{MaterialId, Mesh};
use mmxrt::physics::mars;
use mmxrt::spectral::solar_e490;
use mmxrt::study::Observation;

/// Radiance at 1.0 um of a Lambert plane of reflectance 0.07 at the target of Table I of Domagala (2020), normal to the
/// radius, W m-2 sr-1 um-1: 0.07 / pi x 747.9 x cos i / d^2, i and d (au) from the target.
const TABLE_I: f64 = 6.933_166_079_105;
const ORIGIN: DVec3 = DVec3::new(-2743.5946, 11860.0360, 0.51269);
const SUN: DVec3 = DVec3::new(3.992e10, 2.1812e11, 1.1501e10);

/// Table I with this material, and further tables.
fn table_i(material: &str, fov_deg: f64, bands: &str, more: &str) -> String {
    format!(
        r#"
mmxrt_scene = 1
origin_m = [-2743.5946, 11860.0360, 0.51269]
[[mesh]]
obj = "plane.obj"
pose = "radial"
[materials]
{material}
[sun]
position_m = [3.992e10, 2.1812e11, 1.1501e10]
[observer]
position_m = [-20159.4581, 87145.4911, 3.7671]
target_m = [-2743.5946, 11860.0360, 0.51269]
up = [0.0, 0.0, 1.0]
[sensor]
samples = 33
lines = 33
fov_deg = {fov_deg}
bands = {{ {bands} }}
{more}
"#
    )
}

const NO_HEAT: &str = "[thermal]\nmodel = \"off\"";
const ONE_UM: &str = "centres_um = [1.0]";

fn plane_values<'a>(seen: &'a Observation, name: &str) -> &'a [f64] {
    &seen.backplanes.plane(name).unwrap_or_else(|| panic!("no {name}")).values
}

/// The radiance of every fully covered pixel, in each band.
fn covered(seen: &Observation) -> Vec<Vec<f64>> {
    let mut radiance = vec![0.0; seen.cube.axes.bands.len()];
    let coverage = plane_values(seen, "COVERAGE").iter().enumerate();
    let full: Vec<_> = coverage
        .filter(|(_, c)| **c > 1.0 - 1e-12)
        .map(|(pixel, _)| {
            seen.cube.pixel(pixel, &mut radiance);
            radiance.clone()
        })
        .collect();
    assert!(!full.is_empty(), "no pixel is covered");
    full
}

fn assert_close(what: &str, got: f64, expected: f64, relative: f64) {
    assert!((got / expected - 1.0).abs() <= relative, "{what}: {got}, expected {expected} to {relative:e}");
}

/// A horizontal square of half width `r`, cut at random: a point in the largest facet, again and again.
fn random_triangulation(r: f64, facets: usize) -> Mesh {
    let mut random = Random(7);
    let mut m = plane(r, 0.0);
    while m.facets.len() < facets {
        let area = |f: &usize| m.facet(*f).area_m2();
        let largest = (0..m.facets.len()).max_by(|a, b| area(a).total_cmp(&area(b))).unwrap();
        let (u, v) = (0.2 + 0.3 * random.share(), 0.2 + 0.3 * random.share());
        let mut p = m.facet(largest).point_m(u, v);
        p.z = 0.0;
        m.vertices_m.push(p);
        let (new, [a, b, c]) = (m.vertices_m.len() as u32 - 1, m.facets[largest]);
        m.facets[largest] = [a, b, new];
        m.facets.extend([[b, c, new], [c, a, new]]);
    }
    m.material = vec![MaterialId(0); m.facets.len()];
    m
}

#[test]
fn the_plane_of_table_i_has_its_radiance_in_every_pixel() {
    let scratch = Scratch::new();
    for (name, mesh) in [
        ("two facets", plane(1000.0, 0.0)),
        ("a grid", grid(1000.0, 20, |_, _| 0.0)),
        ("at random", random_triangulation(1000.0, 300)),
    ] {
        scratch.obj("plane", &mesh, &[("ground", None)]);
        // 1.6 deg see 2158 m: the plane, and a rim of sky.
        let seen = scratch.look(&table_i("ground = { reflectance = 0.07 }", 1.6, ONE_UM, NO_HEAT));
        let full = covered(&seen);
        assert!((700..1000).contains(&full.len()), "{name}: {} pixels", full.len());
        for radiance in full {
            assert_close(name, radiance[0], TABLE_I, 1e-10);
        }
        // Pixels on the rim include the sky as 0.
        let (mut rim, band) = (0, seen.cube.band(0));
        for (radiance, coverage) in band.iter().zip(plane_values(&seen, "COVERAGE")) {
            assert!((radiance - coverage * TABLE_I).abs() <= 1e-10 * TABLE_I);
            rim += usize::from((0.01..0.99).contains(coverage));
        }
        assert!(rim >= 80, "{name}: {rim} pixels on the rim");
    }
}

#[test]
fn mars_adds_its_closed_form() {
    let scratch = Scratch::new();
    // So small that Mars is the same everywhere on it: 0.2 m of 9e6 m.
    scratch.obj("plane", &plane(0.1, 0.0), &[("ground", None)]);
    let up = ORIGIN.normalize();
    let to_sun = (SUN - ORIGIN).normalize();
    // From the Sun's side of the sky over the horizon to the other: Mars is lit where the Sun is not near it.
    let aside = (to_sun - to_sun.dot(up) * up).normalize();
    let opposite = |elevation_deg: f64| {
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        9.376e6 * (sin * up - cos * aside)
    };
    let mut seen_cases = 0;
    // As in Table I, low and cut by the horizon; below the horizon but for a rim; the whole disc up.
    for (position, cut, least_share) in [
        (DVec3::new(9.376e6, 0.0, 0.0), true, 0.0),
        (opposite(-10.0), true, 0.0),
        (opposite(10.0), true, 0.001),
        (opposite(25.0), false, 0.001),
        (opposite(35.0), false, 0.001),
    ] {
        let mars_text =
            format!("[mars]\nposition_m = {:?}\nradius_m = 3389500\nalbedo = 0.3\n{NO_HEAT}", position.to_array());
        let seen = scratch.look(&table_i("ground = { reflectance = 0.07 }", 0.0001, ONE_UM, &mars_text));
        let share = 0.3 * mars::irradiance(position - ORIGIN, 3_389_500.0, up, to_sun);
        let expected = TABLE_I * (1.0 + share / up.dot(to_sun));
        // The fast evaluation is good to 1e-5 of a full Mars overhead (q^2 2/3 of its reflectance) where the horizon cuts it.
        let full = 0.3 * 2.0 / 3.0 * (3.3895f64 / 9.376).powi(2) * TABLE_I / up.dot(to_sun);
        let tolerance = if cut { 1e-5 } else { 1e-6 } * full;
        for radiance in covered(&seen) {
            let off = (radiance[0] - expected).abs();
            assert!(off <= tolerance, "{position}: {} not {expected}: {off:e} > {tolerance:e}", radiance[0]);
            seen_cases += 1;
        }
        assert!(share >= least_share, "{position}: {share}");
    }
    assert!(seen_cases >= 5 * 1000);
}

/// Planck's radiance, W m-2 sr-1 um-1: 2 h c^2 and h c / k of the SI of 2019.
fn planck(um: f64, k: f64) -> f64 {
    1.191_042_972_397_188e8 / um.powi(5) / (14_387.768_775_039_337 / (um * k)).exp_m1()
}

const STEFAN_BOLTZMANN: f64 = 5.670_374_419_184_429e-8;
const AU: f64 = 149_597_870_700.0;

#[test]
fn the_plane_glows_at_its_equilibrium_temperature() {
    let scratch = Scratch::new();
    scratch.obj("plane", &plane(1000.0, 0.0), &[("ground", None)]);
    let material = "ground = { reflectance = 0.07, bond_albedo = 0.03, emissivity_bolometric = 0.9 }";
    let seen =
        scratch.look(&table_i(material, 1.0, "centres_um = [1.0, 3.0, 3.6]", "[thermal]\nmodel = \"equilibrium\""));
    let to_sun = SUN - ORIGIN;
    let (cos_i, au2) = (ORIGIN.normalize().dot(to_sun.normalize()), (to_sun.length() / AU).powi(2));
    // E490's whole integral, 0.1195 to 1000 um.
    let sunlight = 1_366.090_796_839 * cos_i / au2;
    let t = (0.97 * sunlight / (0.9 * STEFAN_BOLTZMANN)).powf(0.25);
    assert!((310.0..330.0).contains(&t), "{t}");
    for radiance in covered(&seen) {
        for (got, um) in radiance.iter().zip([1.0, 3.0, 3.6]) {
            let reflected = 0.07 / std::f64::consts::PI * solar_e490().at(um).unwrap() * cos_i / au2;
            // Temperatures are interpolated: to 1e-8 at 3 um.
            assert_close(&format!("{um} um"), *got, reflected + 0.93 * planck(um, t), 2e-8);
        }
    }
    // By the thesis: 150 K + 180 K cos i.
    let seen = scratch.look(&table_i(material, 1.0, "centres_um = [3.6]", "[thermal]\nmodel = \"thesis\""));
    let reflected = 0.07 / std::f64::consts::PI * solar_e490().at(3.6).unwrap() * cos_i / au2;
    for radiance in covered(&seen) {
        assert_close("thesis", radiance[0], reflected + 0.93 * planck(3.6, 150.0 + 180.0 * cos_i), 2e-8);
    }
}

#[test]
fn lit_and_shaded_ground_each_have_their_own_light_and_heat() {
    let scratch = Scratch::new();
    // A box whose shadow is 2 m long at 45 degrees, seen straight from above in one pixel: x from -4 to 0 m, half in shadow.
    let mesh = joined(&[plane(8.0, 0.0), cuboid([0.0, -8.0, -1.0], [3.0, 8.0, 2.0])]);
    scratch.obj("plane", &mesh, &[("ground", None)]);
    let text = format!(
        r#"
mmxrt_scene = 1
origin_m = [0.0, 0.0, 9000.0]
[[mesh]]
obj = "plane.obj"
[materials]
ground = {{ reflectance = 0.1, bond_albedo = 0.05, emissivity_bolometric = 0.95 }}
[sun]
direction = [1.0, 0.0, 1.0]
distance_au = 1.5
[mars]
position_m = [0.0, 0.0, 9.385e6]
radius_m = 3389500
albedo = 0.3
bond_albedo = 0.25
thermal_exitance_w_m2 = 120
[observer]
position_m = [-2.0, 0.0, 9100.0]
target_m = [-2.0, 0.0, 9000.0]
up = [0.0, 1.0, 0.0]
[sensor]
samples = 1
lines = 1
fov_deg = {:?}
bands = {{ centres_um = [1.5, 3.4] }}
"#,
        2.0 * 0.02f64.atan().to_degrees()
    );
    let seen = scratch.look(&text);
    assert!((plane_values(&seen, "LIT_FRACTION")[0] - 0.5).abs() < 1e-9);
    assert!((plane_values(&seen, "COVERAGE")[0] - 1.0).abs() < 1e-12);
    let (to_mars, radius) = (DVec3::new(0.0, 0.0, 9.376e6), 3_389_500.0);
    let to_sun = DVec3::new(0.5f64.sqrt(), 0.0, 0.5f64.sqrt());
    let mars_light = mars::irradiance(to_mars, radius, DVec3::Z, to_sun);
    // Mars overhead, whole: form factor (R / D)^2.
    let mars_heat = 120.0 * (radius / 9.376e6).powi(2);
    let total = 1_366.090_796_839 / 2.25;
    let background = 0.95 * 0.25 * mars_light * total + 0.95 * mars_heat;
    let temperature = |absorbed: f64| (absorbed / (0.95 * STEFAN_BOLTZMANN)).powf(0.25);
    let (lit_k, shaded_k) = (temperature(0.95 * total * to_sun.z + background), temperature(background));
    assert!(lit_k > 290.0 && (120.0..160.0).contains(&shaded_k), "{lit_k} {shaded_k}");
    for (got, um) in covered(&seen)[0].iter().zip([1.5, 3.4]) {
        let sunlight = solar_e490().at(um).unwrap() / 2.25;
        let reflected = |irradiance: f64| 0.1 / std::f64::consts::PI * sunlight * irradiance;
        let lit = reflected(to_sun.z + 0.3 * mars_light) + 0.9 * planck(um, lit_k);
        let shaded = reflected(0.3 * mars_light) + 0.9 * planck(um, shaded_k);
        assert!(shaded < 0.1 * lit && shaded > 0.0);
        // Mars moves by 1e-6 rad over the plane.
        assert_close(&format!("{um} um"), *got, 0.5 * (lit + shaded), 1e-6);
    }
}

#[test]
fn a_gaussian_band_is_the_gaussian_mean() {
    let scratch = Scratch::new();
    scratch.obj("plane", &plane(1000.0, 0.0), &[("ground", None)]);
    // Reflectance 0.02 um, irradiance 1000 - 200 um: linear each, so their product has a curvature of -8.
    scratch.write("linear.csv", "wavelength_um,reflectance\n0.5,0.01\n4,0.08\n");
    scratch.write("sun.csv", "wavelength_um,irradiance_w_m2_um\n0.5,900\n2.1,580\n4,200\n");
    let bands = "centres_um = [1.0, 2.1, 3.0], fwhm_um = [0.05, 0.2, 0.1]";
    let text = table_i("ground = { reflectance = \"linear.csv\" }", 1.0, bands, NO_HEAT)
        .replace("[sun]", "[sun]\nspectrum = \"sun.csv\"");
    let seen = scratch.look(&text);
    let to_sun = SUN - ORIGIN;
    let geometry = ORIGIN.normalize().dot(to_sun.normalize()) * (AU / to_sun.length()).powi(2) / std::f64::consts::PI;
    let flat = scratch.look(&text.replace("\"linear.csv\"", "0.05"));
    for (pixel, radiance) in covered(&seen).iter().enumerate() {
        for (b, (um, fwhm)) in [(1.0, 0.05), (2.1, 0.2), (3.0, 0.1)].into_iter().enumerate() {
            let irradiance: f64 = 1000.0 - 200.0 * um;
            let sigma2 = fwhm * fwhm / (8.0 * 2f64.ln());
            // The mean of f over a Gaussian is f(centre) + f'' sigma^2 / 2.
            assert_close("product", radiance[b], geometry * (0.02 * um * irradiance - 4.0 * sigma2), 1e-9);
            assert_close("linear", covered(&flat)[pixel][b], geometry * 0.05 * irradiance, 1e-9);
        }
        if pixel == 3 {
            break;
        }
    }
}

#[test]
fn a_mixture_is_the_sum_of_its_parts() {
    let scratch = Scratch::new();
    scratch.obj("plane", &plane(1000.0, 0.0), &[("mixed", None)]);
    let materials = "dark = { reflectance = 0.1 }\nmixed = { mixture = { dark = 0.25, bright = 0.75 } }\nbright = { reflectance = 0.3 }";
    let seen = scratch.look(&table_i(materials, 1.0, ONE_UM, NO_HEAT));
    for radiance in covered(&seen) {
        assert_close("radiance", radiance[0], TABLE_I * (0.25 * 0.1 + 0.75 * 0.3) / 0.07, 1e-10);
    }
    for (name, share) in [("ABUNDANCE dark", 0.25), ("ABUNDANCE bright", 0.75), ("ABUNDANCE_LIT dark", 0.25)] {
        assert!(plane_values(&seen, name).iter().all(|v| (v - share).abs() < 1e-12), "{name}");
    }
}

#[test]
fn materials_are_found_by_their_colours() {
    let scratch = Scratch::new();
    let r = 1000.0;
    let left = quad([-r, -r, 0.0], [0.0, -r, 0.0], [0.0, r, 0.0], [-r, r, 0.0]);
    let right = of_material(quad([0.0, -r, 0.0], [r, -r, 0.0], [r, r, 0.0], [0.0, r, 0.0]), 1);
    // sRGB #b03020 and #204060 as linear light (IEC 61966-2-1), by hand.
    let colours = [[0.434_154, 0.029_557, 0.014_444], [0.014_444, 0.051_269, 0.116_971]];
    scratch.obj("plane", &joined(&[left, right]), &[("one", Some(colours[0])), ("two", Some(colours[1]))]);
    let materials = "\"#204060\" = { reflectance = 0.3 }\n\"#b03020\" = { reflectance = 0.1 }";
    let seen = scratch.look(&table_i(materials, 1.0, ONE_UM, NO_HEAT));
    let (band, mut counts) = (seen.cube.band(0), [0; 2]);
    for (pixel, radiance) in band.iter().enumerate() {
        // The image's right is east, which is x; the boundary halves the middle column, but for 1e-5 of perspective.
        let (reflectance, tolerance) = match pixel % 33 {
            0..16 => (0.1, 1e-10),
            16 => (0.2, 1e-3),
            _ => (0.3, 1e-10),
        };
        assert_close(&format!("pixel {pixel}"), *radiance, TABLE_I * reflectance / 0.07, tolerance);
        counts[usize::from(pixel % 33 > 16)] += 1;
    }
    assert_eq!(counts, [33 * 17, 33 * 16]);
}

#[test]
fn the_plane_is_where_it_was_put() {
    // Its middle pixel looks at the target: position, range and angles of Table I.
    let scratch = Scratch::new();
    scratch.obj("plane", &plane(1000.0, 0.0), &[("ground", None)]);
    let seen = scratch.look(&table_i("ground = { reflectance = 0.07 }", 1.0, ONE_UM, NO_HEAT));
    let middle = |name: &str| plane_values(&seen, name)[33 * 16 + 16];
    for (name, expected, tolerance) in [
        ("BODYFIXEDX", ORIGIN.x, 1e-6),
        ("BODYFIXEDY", ORIGIN.y, 1e-6),
        ("BODYFIXEDZ", ORIGIN.z, 1e-6),
        ("RANGE", 77_273.618_147_825_4, 1e-6),
        ("LOCALINCIDENCE", 23.573_397_908_631_627, 1e-5),
        ("INCIDENCE", 23.573_397_908_631_627, 1e-5),
    ] {
        assert!((middle(name) - expected).abs() <= tolerance, "{name}: {} not {expected}", middle(name));
    }
    assert_eq!(middle("SUNILLUMINATIONMASK"), 1.0);
}

#[test]
fn random_triangulations_are_sound() {
    let m = random_triangulation(1.0, 300);
    let area: f64 = (0..m.facets.len()).map(|f| m.facet(f).area_m2()).sum();
    assert!(m.facets.len() >= 300 && (area - 4.0).abs() < 1e-12);
    assert!((0..m.facets.len()).all(|f| (m.facet(f).normal() - DVec3::Z).length() < 1e-15));
}
