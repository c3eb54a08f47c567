//! Cameras as other programs describe them: matrices, focal lengths in pixels and mm, shifted lenses, windows, oblong pixels.

use glam::{DMat3, DVec3};
use mmxrt::formats::scene_toml;
use mmxrt::geometry::FrameCamera;
use mmxrt::progress::unwatched;
use mmxrt::study;

use crate::cli::run;
use crate::map_files::Bench;

const OBSERVER: &str = "position_m = [0, 0, 12000]\ntarget_m = [0, 0, 11000]\nup = [0, 1, 0]\n";
const LENS: &str = "samples = 2\nlines = 2\nfov_deg = 0.45836379150820084\n";

/// The bench's scene, another observer and lens.
fn scene_with(bench: &Bench, observer: &str, lens: &str) {
    bench.0.write("scene.toml", crate::scenes::SQUARE.replace(OBSERVER, observer).replace(LENS, lens));
}

fn read(bench: &Bench) -> Result<scene_toml::SceneFile, String> {
    scene_toml::read(&bench.0.join("scene.toml"), &unwatched).map_err(|e| e.to_string())
}

fn camera(bench: &Bench) -> FrameCamera {
    read(bench).unwrap().scene.exposure.camera.clone()
}

fn image(bench: &Bench) -> Vec<f64> {
    study::simulate(&read(bench).unwrap().scene, &unwatched).unwrap().1.cube.band(0)
}

fn assert_near(a: &[f64], b: &[f64], tolerance: f64) {
    let worst = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(a.len() == b.len() && worst <= tolerance, "{worst:e}: {a:?} {b:?}");
}

#[test]
fn a_pose_is_a_matrix_by_the_axes_of_each_program() {
    let bench = Bench::new();
    // Straight down from 12 km, north up. Blender's camera without a rotation; what Mitsuba's look_at makes; right, down, ahead.
    for (convention, axes) in
        [("blender", [1, 1, 1]), ("opengl", [1, 1, 1]), ("mitsuba", [-1, 1, -1]), ("opencv", [1, -1, -1])]
    {
        let [x, y, z] = axes;
        for (coordinates, height) in [("", 12_000), ("coordinates = \"local\"\n", 1000)] {
            let observer = format!(
                "camera_to_world = [[{x}, 0, 0, 3], [0, {y}, 0, 4], [0, 0, {z}, {height}], [0, 0, 0, 1]]\nconvention = \"{convention}\"\n{coordinates}"
            );
            scene_with(&bench, &observer, LENS);
            let pose = camera(&bench).world_from_sensor;
            assert_eq!(pose.rotation, DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z), "{convention}");
            assert_eq!(pose.translation_m, DVec3::new(3.0, 4.0, 1000.0));
        }
    }
}

#[test]
fn rounded_matrices_are_made_rotations_and_others_refused() {
    let bench = Bench::new();
    // Turned by 30 deg about z, and scaled by 2, in seven digits.
    let rows = |s: &str| {
        format!(
            "camera_to_world = [[1.7320508, -1.0, 0, 0], [1.0, 1.7320508, 0, 0], [0, 0, {s}, 12000], [0, 0, 0, 1]]\nconvention = \"blender\"\n"
        )
    };
    scene_with(&bench, &rows("2.0000001"), LENS);
    let made = read(&bench).unwrap();
    let rotation = made.scene.exposure.camera.world_from_sensor.rotation;
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let expected = DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(sin, -cos, 0.0), DVec3::NEG_Z);
    assert!((rotation - expected).to_cols_array().iter().all(|x| x.abs() < 1e-7), "{rotation}");
    assert!((rotation.transpose() * rotation - DMat3::IDENTITY).to_cols_array().iter().all(|x| x.abs() < 1e-15));
    assert!(made.notes.iter().any(|n| n.contains("a scale of 2")), "{:?}", made.notes);
    let wrong = |observer: &str, message: &str| {
        scene_with(&bench, observer, LENS);
        let error = read(&bench).unwrap_err();
        assert!(error.contains(message), "{error}");
    };
    wrong(&rows("2.1"), "those of a camera are alike");
    wrong(&rows("-2"), "left-handed");
    wrong(&rows("2").replace("convention = \"blender\"\n", ""), "a matrix does not say which way a camera looks");
    wrong(
        &rows("2").replace("1.7320508, -1.0", "1.7320508, -1.2").replace("1.0, 1.7320508", "1.0, 1.6"),
        "not at right angles",
    );
    wrong(
        "camera_to_world = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 12000, 1]]\nconvention = \"blender\"\n",
        "exchange rows and columns",
    );
    // Each axis has the length 1 to 0.01, and h x v is u; v is 0.012 off the right angle with h.
    wrong(
        "position_m = [0, 0, 12000]\nh = [1, 0, 0]\nv = [0.012, 0, 1]\nu = [0, -1, 0]\n",
        "not at right angles: 1.2e-2 off",
    );
    wrong(&format!("position_m = [0, 0, 1]\n{}", rows("2")), "leave the other keys out");
    wrong(&format!("{OBSERVER}convention = \"opencv\"\n"), "goes with `camera_to_world` alone");
    wrong("target_m = [0, 0, 0]\nup = [0, 1, 0]\n", "`position_m` is missing");
}

#[test]
fn lenses_are_those_of_blender_and_opencv() {
    let bench = Bench::new();
    let optics = |lens: &str| {
        scene_with(&bench, OBSERVER, lens);
        let camera = camera(&bench);
        [camera.pitch[0], camera.pitch[1], camera.boresight_px[0], camera.boresight_px[1]]
    };
    // pitch = sensor / (lens x size); principal point W/2 - shift_x size, H/2 + shift_y size.
    let lens = "focal_mm = 35\nsensor_mm = 36\nshift = [0.1, -0.2]\n";
    let wide = 36.0 / (35.0 * 200.0);
    assert_near(&optics(&format!("samples = 200\nlines = 100\n{lens}")), &[wide, wide, 80.0, 10.0], 1e-12);
    assert_near(&optics(&format!("samples = 100\nlines = 200\n{lens}")), &[wide, wide, 30.0, 60.0], 1e-12);
    let fit = "samples = 100\nlines = 200\nsensor_fit = \"horizontal\"\n";
    assert_near(&optics(&format!("{fit}{lens}")), &[2.0 * wide, 2.0 * wide, 40.0, 80.0], 1e-12);
    let fit = "samples = 200\nlines = 100\nsensor_fit = \"vertical\"\n";
    assert_near(&optics(&format!("{fit}{lens}")), &[2.0 * wide, 2.0 * wide, 90.0, 30.0], 1e-12);
    // Pixels twice as high as wide: 10 x 10 of them are 10 x 20 widths, of which 20 mm are the height, or the width. By Blender's
    // `BKE_camera_params_compute_viewplane`: a fit goes by max(W, H aspect), and is W or H aspect wide.
    let tall = "samples = 10\nlines = 10\nfocal_mm = 50\nsensor_mm = 20\npixel_aspect = 2\nshift = [0.1, 0.2]\n";
    for (fit, width, boresight) in
        [("vertical", 0.02, [3.0, 7.0]), ("auto", 0.02, [3.0, 7.0]), ("horizontal", 0.04, [4.0, 6.0])]
    {
        let found = optics(&format!("{tall}sensor_fit = \"{fit}\"\n"));
        assert_near(&found, &[width, 2.0 * width, boresight[0], boresight[1]], 1e-12);
    }
    // fx, fy, cx, cy of OpenCV, which counts from the first pixel's centre.
    let size = "samples = 20\nlines = 10\n";
    let opencv = optics(&format!("{size}focal_px = [1000, 500]\nboresight_px = [9.0, 4.5]\n"));
    assert_near(&opencv, &[1e-3, 2e-3, 9.0, 4.5], 1e-18);
    assert_near(&optics(&format!("{size}focal_px = 1000\n")), &[1e-3, 1e-3, 10.0, 5.0], 1e-18);
    assert_near(&optics(&format!("{size}focal_px = 1000\npixel_aspect = 2\n")), &[1e-3, 2e-3, 10.0, 5.0], 1e-18);
    let window = "window = { first_px = [30, 5], of_px = [100, 50] }\n";
    let half = (0.5 * 40f64.to_radians()).tan() / 50.0;
    assert_near(&optics(&format!("{size}fov_deg = 40\n{window}")), &[half, half, 20.0, 20.0], 1e-15);
    let wrong = |lens: &str, message: &str| {
        scene_with(&bench, OBSERVER, &format!("{size}{lens}"));
        let error = read(&bench).unwrap_err();
        assert!(error.contains(message), "{error}");
    };
    wrong("focal_mm = 35\n", "sensor.sensor_mm: is missing");
    wrong("fov_deg = 30\nsensor_mm = 36\n", "goes with `focal_mm` alone");
    wrong("fov_deg = 30\nfocal_px = 10\n", "give one of");
    wrong("fov_deg = 30\nshift = [0, 0]\nboresight_px = [1, 1]\n", "leave one of them out");
    wrong("focal_px = [10, 20]\npixel_aspect = 2\n", "leave one of them out");
    wrong("fov_deg = 30\nwindow = { first_px = [90, 0], of_px = [100, 50] }\n", "do not lie within");
    wrong("focal_px = -10\n", "");
    wrong("focal_px = [0, 1]\n", "focal lengths");
    wrong("fov_deg = 30\nboresight_px = [1e30, 0]\n", "boresight");
    wrong("fit = \"scene\"\nshift = [0.1, 0]\n", "works only with square pixels");
}

/// 16 x 12 pixels of 1 m and some more, from askance.
const ASKANCE: &str = "position_m = [300, -400, 11900]\ntarget_m = [1, 0, 11000]\nup = [0, 1, 0]\n";
const WHOLE: &str = "samples = 16\nlines = 12\nifov_mrad = 0.9\n";

#[test]
fn a_window_or_a_shifted_lens_sees_what_the_larger_image_sees_there() {
    let bench = Bench::new();
    scene_with(&bench, ASKANCE, WHOLE);
    let whole = image(&bench);
    let expected: Vec<f64> = (0..24).map(|i| whole[(1 + i / 6) * 16 + 1 + i % 6]).collect();
    assert!(expected.iter().filter(|l| **l > 0.0).count() > 5 && expected.contains(&0.0), "{expected:?}");
    for lens in [
        "window = { first_px = [1, 1], of_px = [16, 12] }\n",
        "boresight_px = [7.0, 5.0]\n",
        // (3 - 7) / 6 to the right, (5 - 2) / 6 up.
        "shift = [-0.66666666666666667, 0.5]\n",
    ] {
        scene_with(&bench, ASKANCE, &format!("samples = 6\nlines = 4\nifov_mrad = 0.9\n{lens}"));
        assert_near(&image(&bench), &expected, 1e-12);
    }
}

#[test]
fn an_oblong_pixel_is_the_mean_of_two_square_ones() {
    let bench = Bench::new();
    scene_with(&bench, ASKANCE, WHOLE);
    let whole = image(&bench);
    let expected: Vec<f64> =
        (0..96).map(|i| 0.5 * (whole[i / 16 * 32 + i % 16] + whole[i / 16 * 32 + 16 + i % 16])).collect();
    scene_with(&bench, ASKANCE, &WHOLE.replace("lines = 12", "lines = 6\npixel_aspect = 2"));
    assert_near(&image(&bench), &expected, 1e-12);
}

#[test]
fn a_shifted_camera_is_written_as_it_was_read() {
    let bench = Bench::new();
    scene_with(&bench, ASKANCE, "samples = 6\nlines = 4\nfocal_px = [1100, 700]\nboresight_px = [-3.25, 9.125]\n");
    let before = camera(&bench);
    let (from, to) = (bench.0.argument("scene.toml"), bench.0.argument("again/scene.toml"));
    let (code, _, err) = run(&["convert", &from, &to]);
    assert_eq!(code, 0, "{err}");
    let after = scene_toml::read(&bench.0.join("again/scene.toml"), &unwatched).unwrap().scene.exposure.camera.clone();
    assert_eq!((before.pitch, before.boresight_px), (after.pitch, after.boresight_px));
}

#[test]
fn the_image_of_a_shifted_oblong_camera_is_put_back_where_it_was_seen() {
    let bench = Bench::new();
    let lens = "samples = 6\nlines = 8\nfocal_px = [250, 400]\nboresight_px = [1.5, 5.25]\n";
    scene_with(&bench, ASKANCE, lens);
    let own = image(&bench);
    let lines: Vec<String> =
        own.chunks(6).map(|line| line.iter().map(f64::to_string).collect::<Vec<_>>().join(",")).collect();
    bench.0.write("m.csv", lines.join("\n") + "\n");
    bench.map(
        "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\nplacement = \"camera\"\n\
         observer = { position_m = [300, -400, 11900], target_m = [1, 0, 11000], up = [0, 1, 0] }\n\
         sensor = { focal_px = [250, 400], boresight_px = [1.5, 5.25] }\n",
    );
    assert!(own.iter().any(|l| *l > 0.0));
    assert_near(&bench.integrate(&["--radiance", "{}m.csv"]), &own, 1e-9);
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn what_darts_camera_cannot_be_is_told() {
    let bench = Bench::new();
    scene_with(&bench, OBSERVER, "samples = 6\nlines = 4\nfocal_px = [1100, 700]\nboresight_px = [2, 2]\n");
    let (from, to) = (bench.0.argument("scene.toml"), bench.0.argument("dart"));
    let (code, out, err) = run(&["convert", &from, &to, "--to", "dart"]);
    let said = format!("{out}{err}");
    assert!(
        code == 0 && said.contains("Dropped") && said.contains("the boresight at sample and line [2.0, 2.0]"),
        "{said}"
    );
    // Oblong pixels are two fields of view, 2 atan(n / 2 f), and come back.
    let back = bench.0.argument("back/scene.toml");
    let (code, out, err) = run(&["convert", &to, &back]);
    assert_eq!(code, 0, "{out}{err}");
    let pitch = scene_toml::read(&bench.0.join("back/scene.toml"), &unwatched).unwrap().scene.exposure.camera.pitch;
    assert!((pitch[0] * 1100.0 - 1.0).abs() < 1e-9 && (pitch[1] * 700.0 - 1.0).abs() < 1e-9, "{pitch:?}");
}
