//! Cameras that are far away: distance costs no digits, and pixels too small for coordinates are refused.

use crate::scratch::Scratch;
use crate::shapes::*;
use crate::sides::assert_right;

#[test]
fn from_1e7_m_facets_of_a_metre_are_right() {
    for case in ["far_camera", "far_camera_below"] {
        assert_right(case, 1e-11);
    }
}

#[test]
fn a_square_metre_covers_what_it_does_from_any_distance() {
    // 1 m at the middle of pixels of 1 m; the camera looks a little beside it, so that it lies at (0.3, -0.4) pixels from the middle.
    for distance in [1e2, 1e5, 1e7, 1e9] {
        let from = [0.7 * distance, 0.1 * distance, 0.2 * distance];
        let range = (from.iter().map(|x| x * x).sum::<f64>()).sqrt();
        let wall = {
            let towards = glam::DVec3::from_array(from) / range;
            let right = glam::DVec3::Z.cross(towards).normalize();
            let up = towards.cross(right);
            let p = |x: f64, y: f64| (right * x + up * y).to_array();
            quad(p(-0.5, -0.5), p(0.5, -0.5), p(0.5, 0.5), p(-0.5, 0.5))
        };
        let camera = camera(from, [0.0; 3], [0.0, 0.0, 1.0], 5, 1.0 / range);
        let seen = see(&wall, direction(from), &camera);
        let (area, lit) = totals(&seen, |_| true);
        assert!((area - 1.0).abs() < 1e-13 && (lit - 1.0).abs() < 1e-13, "{distance}: {area} {lit}");
        assert!((seen.footprints.coverage(12) - 1.0).abs() < 1e-7, "{distance}: {}", seen.footprints.coverage(12));
    }
}

#[test]
fn pixels_smaller_than_the_digits_of_coordinates_are_refused_at_their_place() {
    let scratch = Scratch::new();
    scratch.obj("s", &plane(1e6, 0.0), &[("m", None)]);
    for (key, fails) in [
        ("ifov_mrad = 1e-300", true),
        ("ifov_mrad = 1e-12", true),
        ("fov_deg = 1e-11", true),
        ("ifov_mrad = 1e-8", false),
    ] {
        let text = format!(
            "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\nobj = \"s.obj\"\ncoordinates = \"local\"\n[materials]\nm = {{ reflectance = 0.5 }}\n\
             [sun]\ndirection = [0, 0, 1]\ndistance_au = 1\n[observer]\nposition_m = [0, 0, 30000]\nh = [1, 0, 0]\nv = [0, -1, 0]\nu = [0, 0, -1]\n\
             [sensor]\nsamples = 4\nlines = 4\n{key}\nbands = {{ centres_um = [1.0] }}\n[thermal]\nmodel = \"off\"\n"
        );
        let path = scratch.write("s.toml", text).into_os_string().into_string().unwrap();
        let (code, _, err) = crate::cli::run(&["simulate", &path, "-o", &scratch.argument("o")]);
        assert_eq!(code, i32::from(fails), "{key}: {err}");
        let name = key.split(' ').next().unwrap();
        assert!(!fails || (err.contains("s.toml:19:") && err.contains(name) && err.contains("rad")), "{key}: {err}");
    }
}
