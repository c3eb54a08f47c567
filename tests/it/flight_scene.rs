//! Scenes with a table `flight`: what follows from it, and what is said where it cannot be.

use glam::DVec3;
use mmxrt::formats::scene_toml;
use mmxrt::progress::unwatched;
use mmxrt::scene::Readout;

use crate::cli::run;
use crate::scenes::replaced;
use crate::scratch::Scratch;

/// A site on Phobos' equator, below where `qso-20x27` starts.
pub(crate) const FLYING: &str = r#"mmxrt_scene = 1
origin_m = [13000.0, 0.0, 0.0]
[[mesh]]
recipe = { version = 1, seed = 7, facets = 1000 }
pose = "radial"
[materials]
phobos_blue = { reflectance = 0.07 }
phobos_red = { reflectance = 0.05 }
[mars]
[flight]
epoch = "2027-05-01T06:00:00 UTC"
orbit = "qso-20x27"
[sensor]
samples = 8
lines = 8
ifov_mrad = 1.0
bands = { centres_um = [1.0, 2.0, 3.0] }
"#;

/// The line in which a text has some words.
fn line_of(text: &str, words: &str) -> usize {
    1 + text.lines().position(|line| line.contains(words)).unwrap_or_else(|| panic!("{words}"))
}

#[test]
fn an_orbit_by_name_places_all() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", FLYING);
    let file = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap();
    let scene = &file.scene;
    // It starts on the line to Mars: 20 km from the centre.
    let eye = scene.exposure.camera.centre_m() + scene.body.origin_m;
    assert!((eye - DVec3::new(20_000.0, 0.0, 0.0)).length() < 1e-6, "{eye:?}");
    assert!((scene.exposure.camera.world_from_sensor.rotation.z_axis - DVec3::NEG_X).length() < 1e-12);
    // The Sun by ERFA's plan94 (Simon et al. 1994) and the rotation of pck00011 by CSPICE.
    let sun = scene.sky.sun.direction.vec();
    let expected = DVec3::new(0.2071689, 0.88212296, 0.42301316);
    assert!((sun - expected).length() < 2e-4, "{sun:?}");
    let au = scene.sky.sun.distance_m / 149_597_870_700.0;
    assert!((au - 1.649_975).abs() < 2e-4, "{au}");
    // Mars straight above, by the rough orbit.
    let mars = scene.sky.mars.as_ref().unwrap().centre_m + scene.body.origin_m;
    assert!((mars - DVec3::new(9_376_000.0, 0.0, 0.0)).length() < 1.0, "{mars:?}");
    // A quarter of its period later it is half-way round: beyond the y axis.
    let text = replaced(FLYING, &[("orbit = ", "orbit_epoch = \"2027-05-01T04:59:26.345588 UTC\"\norbit = ")]);
    scratch.write("scene.toml", text);
    let later = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap().scene;
    let eye = later.exposure.camera.centre_m() + later.body.origin_m;
    assert!(eye.x.abs() < 10.0 && (eye.y + 27_051.769_516).abs() < 0.01, "{eye:?}");
}

#[test]
fn presets_know_what_they_take_at_once() {
    let scratch = Scratch::new();
    let own = "samples = 8\nlines = 8\nifov_mrad = 1.0\nbands = { centres_um = [1.0, 2.0, 3.0] }";
    let read = |text: String| {
        scratch.write("scene.toml", text);
        scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap()
    };
    let file = read(replaced(FLYING, &[(own, "preset = \"macromega\"")]));
    let timing = file.motion.as_ref().unwrap().1;
    assert_eq!((timing.readout, timing.period_s, file.scene.exposure.bands.len()), (Readout::Band, 1.0, 300));
    // The scene's own moment is that of its middle band.
    let start_m = DVec3::new(20_000.0, 0.0, 0.0);
    let moved_m = (file.scene.exposure.camera.centre_m() + file.scene.body.origin_m - start_m).length();
    assert!((moved_m - 150.5 * 12.187).abs() < 5.0, "{moved_m}");
    let file = read(replaced(FLYING, &[(own, "preset = \"mirs\"\nlines = 20\nperiod_s = 1.4")]));
    let (exposure, timing) = (&file.scene.exposure, file.motion.as_ref().unwrap().1);
    assert_eq!((timing.readout, exposure.camera.samples, exposure.camera.lines), (Readout::Line, 165, 20));
    // Slit: 165 pixels of 0.35 mrad are 3.3 deg.
    let bands = &exposure.bands;
    assert_eq!((bands.len(), bands[1].fwhm_um), (271, Some(0.02)));
    assert!((bands[1].centre_um - bands[0].centre_um - 0.01).abs() < 1e-12);
}

/// Wrong tables, and what is said of them.
#[test]
fn what_is_wrong_is_said_where_it_is() {
    let orbit = "orbit = \"qso-20x27\"";
    let cases: [(&[(&str, &str)], &str, &str); 18] = [
        (&[("06:00:00 UTC", "06:00:00")], "epoch", "no time scale"),
        (&[("06:00:00 UTC", "06:00:60 UTC")], "epoch", "is not a time"),
        (&[("05-01T06:00:00", "06-30T23:59:60")], "epoch", "no leap second is known"),
        (&[("2027-05-01", "2027-02-29")], "epoch", "is not a time"),
        (&[("2027", "1960")], "epoch", "from 1972"),
        (&[("2027", "2127")], "[flight]", "is unknown"),
        (&[(orbit, "")], "[flight]", "the spacecraft is missing"),
        (&[(orbit, "spacecraft = \"MMX\"")], "[flight]", "MMX"),
        (&[(orbit, "orbit = \"qso-20x40\"")], "orbit", "qso-20x27"),
        (&[(orbit, "orbit = \"qso-2x3\"")], "orbit", "qso-2x3"),
        (&[(orbit, "orbit = \"halo\"")], "orbit", "qso-20x27"),
        (&[(orbit, "orbit = \"qso-20x27\"\nbody = \"DEIMOS\"")], "orbit", "about PHOBOS"),
        (&[(orbit, "orbit = \"qso-20x27\"\nframe = \"IAU_PLUTO\"")], "[flight]", "IAU_PLUTO"),
        (&[(orbit, "orbit = \"qso-20x27\"\nfiles = [\"none.bsp\"]")], "files", "no such file"),
        (&[("[mars]", "[mars]\nposition_m = [9376000.0, 0.0, 0.0]")], "position_m", "`flight` places this body too"),
        (&[("[mars]", "[sun]\ndistance_au = 1.5\n[mars]")], "[sun]", "the Sun comes from `flight`"),
        (&[("samples = 8", "samples = 8\nkind = \"push_broom\"")], "[sensor]", "`period_s` is missing"),
        (
            &[(orbit, "orbit = \"qso-20x27\"\npointing = { target_m = [0, 0, 0], frame = \"J2000\" }")],
            "pointing",
            "one of",
        ),
    ];
    let scratch = Scratch::new();
    let scene = scratch.argument("scene.toml");
    for (edits, place, words) in cases {
        let text = replaced(FLYING, edits);
        scratch.write("scene.toml", &text);
        let (code, _, err) = run(&["inspect", &scene]);
        assert_eq!(code, 1, "{edits:?}: {err}");
        assert!(err.contains(words), "{edits:?}: {err}");
        let line = line_of(&text, place);
        assert!(err.contains(&format!("scene.toml:{line}")), "{edits:?}, line {line}: {err}");
    }
}

/// A filter's cube from the command line: each band at its moment, with the displacement of what the reference shows.
#[test]
fn a_filters_cube_comes_with_its_displacement() {
    let scratch = Scratch::new();
    let text = replaced(FLYING, &[("samples = 8", "samples = 8\nkind = \"tunable_filter\"\nperiod_s = 2.0")]);
    scratch.write("scene.toml", text);
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--model", "sunlight"]);
    assert_eq!(code, 0, "{err}");
    let table = std::fs::read_to_string(scratch.join("out/exposures.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 4);
    assert!(rows[1].starts_with("1,8,1,1,2027-05-01T06:01:10.18"), "{}", rows[1]);
    let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--model", "sunlight", "--force"]);
    assert_eq!(code, 0, "{err}");
    let factor = ["--quantity", "reflectance_factor", "--force"];
    let (code, _, err) = run(&[&["simulate", &scene, "-o", &out][..], &factor].concat());
    assert!(code == 1 && err.contains("radiance factor"), "{err}");
    // What goes elsewhere is one moment of it, and that is said; a table of one moment serves all, and that is said, too.
    let (code, said, err) = run(&["convert", &scene, &scratch.argument("other/scene.toml")]);
    assert!(code == 0 && (said + &err).contains("how it moves is not written"));
    let (code, _, err) = run(&["convert", &scene, &scratch.argument("strict/scene.toml"), "--strict"]);
    assert_eq!(code, 3, "{err}");
    let table = scratch.argument("table.npz");
    let (code, _, err) = run(&["solve", &scene, "-o", &table]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = run(&["integrate", &scene, "--table", &table, "-o", &scratch.argument("by_table")]);
    assert!(code == 0 && err.contains("illumination is held fixed"), "{err}");
    let planes = std::fs::read(scratch.join("out/displacement.img")).unwrap();
    assert_eq!(planes.len(), 3 * 2 * 64 * 4);
    let value = |plane: usize, pixel: usize| {
        let at = 4 * (64 * plane + pixel);
        f32::from_le_bytes(planes[at..at + 4].try_into().unwrap())
    };
    // The reference is the second band. The spacecraft goes 12.187 m/s along -y and looks at the centre 20 km below, so that what it sees goes by at 13 / 20 of
    // that, to the right: in 2 s 15.8 m, of which a pixel has 7.
    assert!(value(2, 27).abs() < 1e-9 && value(3, 27).abs() < 1e-9);
    let moved = value(4, 27);
    assert!((moved - 2.263).abs() < 0.1, "{moved}");
}

/// What a file knows ends where it ends: what is known roughly does not take over, not even in the middle of an image.
#[test]
fn a_file_that_ends_is_not_continued_roughly() {
    let scratch = Scratch::new();
    let oem = "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\nMETA_START\nOBJECT_NAME = SUN\nOBJECT_ID = 10\n\
               CENTER_NAME = PHOBOS\nREF_FRAME = IAU_PHOBOS\nTIME_SYSTEM = UTC\nSTART_TIME = 2027-05-01T05:00:00\n\
               STOP_TIME = 2027-05-01T06:00:03\nINTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 1\nMETA_STOP\n\
               2027-05-01T05:00:00 2.0e8 1.0e8 0.0 0 0 0\n2027-05-01T06:00:03 2.0e8 1.1e8 0.0 0 0 0\n";
    scratch.write("sun.oem", oem);
    let with = |period: &str| {
        let kind = format!("samples = 8\nkind = \"tunable_filter\"\nperiod_s = {period}\nexposure_s = 0.1");
        replaced(FLYING, &[("samples = 8", &kind), ("orbit = ", "files = [\"sun.oem\"]\norbit = ")])
    };
    scratch.write("scene.toml", with("1.0"));
    let file = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap();
    // Three bands, the middle one 1.05 s after six: by the line between the two rows.
    let sun = file.scene.sky.sun.direction.vec();
    assert!((sun.y / sun.x - 0.549_973).abs() < 1e-5, "{sun:?}");
    scratch.write("scene.toml", with("2.0"));
    let (code, _, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(
        code == 1
            && err.contains("the position of SUN relative to PHOBOS is unknown")
            && err.contains("sun.oem covers"),
        "{err}"
    );
}

/// A filter's bands become a sequence of DART simulations, which comes back as a flight table; other formats have the middle moment, and it is said.
#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_moving_scene_becomes_a_sequence_of_dart() {
    let scratch = Scratch::new();
    let kind = "samples = 8\nkind = \"tunable_filter\"\nperiod_s = 20.0\nexposure_s = 0.1";
    scratch.write("scene.toml", replaced(FLYING, &[("samples = 8", kind)]));
    let argument = |name: &str| scratch.argument(name);
    let (code, out, err) = run(&["convert", &argument("scene.toml"), &argument("sim")]);
    assert_eq!(code, 0, "{err}");
    assert!((out + &err).contains("3 exposures are the sequence `flight.xml`"), "{err}");
    let (code, _, err) = run(&["convert", &argument("sim"), &argument("back/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    let table = std::fs::read_to_string(scratch.join("back/scene.flight.flight.csv")).unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    assert_eq!(rows.len(), 3, "{table}");
    // 12.187 m/s past the sub-Mars point, over 20 s.
    let place = |row: &str| {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        DVec3::new(cells[4], cells[5], cells[6])
    };
    let moved_m = (place(rows[2]) - place(rows[0])).length();
    assert!((moved_m - 40.0 * 12.187).abs() < 1.0, "{moved_m}");
    let (code, out, err) = run(&["convert", &argument("scene.toml"), &argument("plain/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    assert!((out + &err).contains("with all of the image taken at once"), "{err}");
}

/// Motion within an exposure is integrated as finely as the tolerance needs, unless the scene or a list of models says otherwise.
#[test]
fn a_plan_takes_as_many_poses_as_its_tolerance_needs() {
    let scratch = Scratch::new();
    let filter = "samples = 8\nkind = \"tunable_filter\"\nperiod_s = 1.0";
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let cube = |poses: &str, more: &[&str]| {
        let sensor = format!("{filter}\n{poses}");
        scratch.write("scene.toml", replaced(FLYING, &[("samples = 8", sensor.as_str())]));
        let (code, _, err) = run(&[&["simulate", &scene, "-o", &out, "--force", "--dtype", "f64"], more].concat());
        assert_eq!(code, 0, "{err}");
        let report = std::fs::read_to_string(scratch.join("out/report.json")).unwrap();
        (std::fs::read(scratch.join("out/cube.img")).unwrap(), report)
    };
    // 12 m/s along the way, below which Phobos turns, at 7 km: 1 or 2 pixels of 7 m in a second.
    let (by_plan, report) = cube("", &["--model", "sunlight,smear", "--tolerance", "0.01"]);
    let count: u32 = report.split(" poses stand").next().unwrap().rsplit(' ').next().unwrap().parse().unwrap();
    // The square root of 1.2 to 2.5 pixels over 8 times the tolerance.
    assert!((4..=6).contains(&count), "{report}");
    assert!(by_plan == cube(&format!("exposure_poses = {count}"), &["--model", "sunlight"]).0);
    let (middle, report) = cube("", &["--model", "sunlight"]);
    assert!(report.contains("of which the middle is taken") && middle != by_plan);
    assert!(middle == cube("exposure_poses = 1", &["--model", "sunlight,smear"]).0);
}

/// An orbit about Mars needs to know where the body is: a rough orbit is for light alone.
#[test]
fn a_camera_is_not_placed_by_what_is_rough() {
    let scratch = Scratch::new();
    let orbit = "# centre = MARS\n# frame = J2000\n# degree = 1\ntdb,mmx_x_km,mmx_y_km,mmx_z_km\n\
                 2027-05-01T00:00:00,9400,0,0\n2027-05-02T00:00:00,9400,1,0\n";
    scratch.write("mmx.csv", orbit);
    let files = "files = [\"mmx.csv\"]\nspacecraft = \"MMX\"";
    scratch.write("scene.toml", replaced(FLYING, &[("orbit = \"qso-20x27\"", files)]));
    let scene = scratch.argument("scene.toml");
    let (code, _, err) = run(&["simulate", &scene, "-o", &scratch.argument("out")]);
    assert!(code != 0 && err.contains("position of MMX relative to PHOBOS is unknown"), "{err}");
    assert!(err.contains("no file covers PHOBOS relative to MARS"), "{err}");
    // With it, all is known; and what tables do not say is said to be taken.
    let phobos = orbit.replace("mmx_", "phobos_").replace("9400,0,0", "9380,0,0").replace("9400,1,0", "9380,1,0");
    scratch.write("phobos.csv", phobos.replace("# degree = 1\n", ""));
    scratch.edit("scene.toml", "[\"mmx.csv\"]", "[\"mmx.csv\", \"phobos.csv\"]");
    let file = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap();
    let eye = file.scene.exposure.camera.centre_m() + file.scene.body.origin_m;
    assert!((eye.length() - 20_000.0).abs() < 1e-3, "{eye:?}");
    assert!(file.defaults.iter().any(|stated| stated.value.contains("phobos.csv") && stated.value.contains("degree")));
}

/// A push-broom that looks at one point shows one line again and again.
#[test]
fn lines_that_do_not_go_on_are_told() {
    let scratch = Scratch::new();
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let told = |pointing: &str| {
        let sensor = "samples = 8\nkind = \"push_broom\"\nperiod_s = 0.6\nexposure_poses = 1";
        let orbit = format!("orbit = \"qso-20x27\"\npointing = {{ {pointing} }}");
        scratch.write("scene.toml", replaced(FLYING, &[("samples = 8", sensor), ("orbit = \"qso-20x27\"", &orbit)]));
        let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--force", "--model", "sunlight"]);
        assert_eq!(code, 0, "{err}");
        err
    };
    assert!(told("target_m = [13000.0, 0.0, 0.0]").contains("goes on by 0.0"));
    assert!(told("up = \"north\"").contains("show nearly the same"));
    assert!(!told("up = \"backward\"").contains("goes on by"));
}

/// What turns about the boresight moves in the corners, and what turns away is nowhere after half of an exposure.
#[test]
fn turns_within_an_exposure_are_smear() {
    let scratch = Scratch::new();
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let told = |scan: &str| {
        let orbit = format!("orbit = \"qso-20x27\"\npointing = {{ scan = {{ {scan} }} }}");
        let sensor = "samples = 8\nexposure_s = 0.5";
        scratch.write("scene.toml", replaced(FLYING, &[("samples = 8", sensor), ("orbit = \"qso-20x27\"", &orbit)]));
        let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--force", "--model", "sunlight"]);
        assert_eq!(code, 0, "{err}");
        err
    };
    // A corner is 4 sqrt 2 pixels off: 10 deg/s for half a second are a chord of 0.49, and the way adds up to 0.6.
    let err = told("axis = \"z\", rate_deg_s = 10.0");
    let px: f64 = err.split("moves by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((0.5..=1.5).contains(&px), "{err}");
    assert!(told("axis = \"x\", rate_deg_s = 720.0, start_deg = -180.0").contains("leaves the image"), "{err}");
}
