//! Orbits and attitudes in CCSDS' messages, and tables of them: against closed forms, there and back, and damaged.

use std::hint::black_box;
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3, DVec4};
use mmxrt::Error;
use mmxrt::flight::{
    self, Almanac, Attitudes, Between, Epoch, Interpolation, LeapSeconds, Nodes, Orientation, Scale, Segment, Span,
    Trajectory, Turn, Turning,
};
use mmxrt::formats::flight_file::{FlightFile, Object};
use mmxrt::formats::{InputFile, ccsds, ephemeris, flight_table};
use mmxrt::report::Report;

use crate::scratch::Scratch;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/flight").join(name)
}

fn leap() -> LeapSeconds {
    LeapSeconds::default()
}

fn time(text: &str) -> Epoch {
    Epoch::parse(text, None, &leap()).unwrap()
}

fn parsed(text: &str) -> mmxrt::Result<FlightFile> {
    ccsds::parse(text, InputFile::of(Path::new("a.oem"), text.as_bytes()), &leap())
}

fn table(text: &str) -> mmxrt::Result<FlightFile> {
    flight_table::parse(text, InputFile::of(Path::new("a.csv"), text.as_bytes()), &leap())
}

fn notes(file: &FlightFile) -> String {
    file.report.notes.iter().map(|note| format!("{note}\n")).collect()
}

/// An OEM of one segment about Phobos in J2000 and TDB.
fn oem(meta: &str, rows: &str) -> String {
    format!(
        "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\nMETA_START\nOBJECT_NAME = MMX\n\
         OBJECT_ID = -3\nCENTER_NAME = PHOBOS\nREF_FRAME = EME2000\nTIME_SYSTEM = TDB\n{meta}META_STOP\n{rows}"
    )
}

/// An AEM of one segment.
fn aem(version: &str, meta: &str, rows: &str) -> String {
    format!(
        "CCSDS_AEM_VERS = {version}\nMETA_START\nOBJECT_NAME = MMX\nREF_FRAME_A = EME2000\nREF_FRAME_B = SC\n\
         TIME_SYSTEM = TDB\nSTART_TIME = 2026-07-01T00:00:00\nSTOP_TIME = 2026-07-01T01:00:00\n{meta}META_STOP\n\
         DATA_START\n{rows}DATA_STOP\n"
    )
}

fn rotation(file: &FlightFile, at: &str) -> DMat3 {
    file.orientations[0].1.frame_from_base(time(at)).unwrap().unwrap()
}

fn close(a: DMat3, b: DMat3, tolerance: f64) -> bool {
    (a - b).to_cols_array().iter().all(|v| v.abs() <= tolerance)
}

#[test]
fn a_circle_is_followed_between_its_rows() {
    let mut almanac = Almanac::default();
    ephemeris::furnish(&data("circle.oem"), &mut almanac).unwrap();
    let (radius_m, rate) = (40_000.0, 2e-4);
    let tilt = DMat3::from_rotation_x(30_f64.to_radians());
    let start = time("2026-07-01T00:00:00 TDB");
    // Rows have 1e-9 m, and 1e-9 m/s, which count for up to a minute; whole seconds are exact.
    for second in (0..=3600).step_by(37).chain((5700..=8700).step_by(41)) {
        let s = f64::from(second);
        let state = almanac.state("mmx", "401", "EME2000", start.after_s(s)).unwrap();
        let (sin, cos) = (rate * s).sin_cos();
        let position_m = tilt * DVec3::new(cos, sin, 0.0) * radius_m;
        let velocity_m_s = tilt * DVec3::new(-sin, cos, 0.0) * radius_m * rate;
        assert!((state.position_m - position_m).length() < 1e-7, "{second} s: {:?}", state.position_m - position_m);
        assert!((state.velocity_m_s - velocity_m_s).length() < 5e-9, "{second} s");
    }
    // Beyond what may be used, and between segments, nothing is known, though there are rows.
    for (second, told) in
        [(-0.001, "from 2026-07-01"), (3600.5, "but not from"), (5500.0, "but not from"), (8800.0, "to")]
    {
        let error = almanac.state("MMX", "PHOBOS", "J2000", start.after_s(second)).unwrap_err().to_string();
        assert!(error.contains("is unknown at") && error.contains(told), "{error}");
    }
}

#[test]
fn a_steady_turn_is_followed_between_its_rows() {
    let mut almanac = Almanac::default();
    ephemeris::furnish(&data("turn.aem"), &mut almanac).unwrap();
    let axis = DVec3::new(1.0, 2.0, 2.0) / 3.0;
    for s in [0.0, 7.25, 20.0, 133.3, 150.0, 299.0] {
        let epoch = time(&format!("2026-07-01T00:0{}:{:09.6} UTC", (s / 60.0_f64).floor(), s % 60.0));
        let got = almanac.rotation("SC_BODY_1", "J2000", epoch).unwrap();
        // The frame turns by the angle, and components in it by its opposite. Moments are 1.2e-7 s apart.
        let expected = DMat3::from_axis_angle(axis, -(0.6 * s).to_radians());
        assert!(close(got, expected, 3e-9), "{s} s: {got:?} for {expected:?}");
    }
    // By hand: after 90 deg x becomes u (u x) - u x x = (1, -4, 8) / 9.
    let got = almanac.rotation("SC_BODY_1", "EME2000", time("2026-07-01T00:02:30 UTC")).unwrap() * DVec3::X;
    assert!((got - DVec3::new(1.0, -4.0, 8.0) / 9.0).length() < 3e-9, "{got:?}");
}

#[test]
fn one_rotation_is_said_in_many_ways() {
    // 90 deg about z and then 90 deg about the new x: the quaternion (1, 1, 1, 1) / 2, a cyclic change of axes.
    let expected = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);
    let quaternion = "ATTITUDE_TYPE = QUATERNION\n";
    for (version, meta, numbers) in [
        ("2.0", quaternion.to_owned(), "0.5 0.5 0.5 0.5"),
        ("1.0", format!("{quaternion}ATTITUDE_DIR = A2B\nQUATERNION_TYPE = LAST\n"), "0.5 0.5 0.5 0.5"),
        ("1.0", format!("{quaternion}ATTITUDE_DIR = A2B\nQUATERNION_TYPE = FIRST\n"), "-0.5 -0.5 -0.5 -0.5"),
        ("1.0", format!("{quaternion}ATTITUDE_DIR = B2A\nQUATERNION_TYPE = LAST\n"), "-0.5 -0.5 -0.5 0.5"),
        ("1.0", format!("{quaternion}ATTITUDE_DIR = b2a\nQUATERNION_TYPE = first\n"), "0.5 -0.5 -0.5 -0.5"),
        ("2.0", "ATTITUDE_TYPE = QUATERNION/DERIVATIVE\n".into(), "0.5 0.5 0.5 0.5 0 0 0 0"),
        ("2.0", "ATTITUDE_TYPE = QUATERNION/ANGVEL\nANGVEL_FRAME = SC\n".into(), "0.5 0.5 0.5 0.5 0 0 0"),
        (
            "1.0",
            "ATTITUDE_TYPE = QUATERNION/RATE\nATTITUDE_DIR = A2B\nQUATERNION_TYPE = LAST\n".into(),
            ".5 .5 .5 .5 0 0 0",
        ),
        ("2.0", "ATTITUDE_TYPE = EULER_ANGLE\nEULER_ROT_SEQ = ZXZ\n".into(), "90 90 0"),
        ("1.0", "ATTITUDE_TYPE = EULER_ANGLE\nATTITUDE_DIR = A2B\nEULER_ROT_SEQ = 312\n".into(), "90 90 0"),
        ("2.0", "ATTITUDE_TYPE = EULER_ANGLE/DERIVATIVE\nEULER_ROT_SEQ = XZX\n".into(), "0 90 90 1 1 1"),
        // The inverse: -90 deg about x, then -90 deg about the new z.
        ("1.0", "ATTITUDE_TYPE = EULER ANGLE\nATTITUDE_DIR = B2A\nEULER_ROT_SEQ = 131\n".into(), "-90 -90 0"),
    ] {
        let meta = format!("{meta}INTERPOLATION_METHOD = LINEAR\n");
        let file = parsed(&aem(version, &meta, &format!("2026-07-01T00:30:00 {numbers}\n"))).unwrap();
        let got = rotation(&file, "2026-07-01T00:30:00 TDB");
        assert!(close(got, expected, 1e-15), "{meta}{numbers}: {got:?}");
        // As XML it is the same.
        let (xml, _) = ccsds::ndm(&file, &leap(), None).unwrap();
        assert!(close(rotation(&parsed(&xml).unwrap(), "2026-07-01T00:30:00 TDB"), got, 0.0), "{xml}");
    }
    // Euler's three angles, each of which counts: M = R_x(c) R_y(b) R_z(a), every R of axes, as products of written-out matrices.
    let [a, b, c] = [20_f64, -35.0, 110.0].map(f64::to_radians);
    let about_z = DMat3::from_cols_array(&[a.cos(), a.sin(), 0.0, -a.sin(), a.cos(), 0.0, 0.0, 0.0, 1.0]).transpose();
    let about_y = DMat3::from_cols_array(&[b.cos(), 0.0, -b.sin(), 0.0, 1.0, 0.0, b.sin(), 0.0, b.cos()]).transpose();
    let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, c.cos(), c.sin(), 0.0, -c.sin(), c.cos()]).transpose();
    let meta = "ATTITUDE_TYPE = EULER_ANGLE\nEULER_ROT_SEQ = 321\n";
    let file = parsed(&aem("2.0", meta, "2026-07-01T00:30:00 20 -35 110\n")).unwrap();
    let got = rotation(&file, "2026-07-01T00:30:00 TDB");
    assert!(close(got, about_x * about_y * about_z, 1e-15), "{got:?}");
    let old = "<aem id='CCSDS_AEM_VERS' version='1.0'><body><segment><metadata><OBJECT_NAME>X</OBJECT_NAME>\
        <REF_FRAME_A>EME2000</REF_FRAME_A><REF_FRAME_B>SC</REF_FRAME_B><ATTITUDE_DIR>A2B</ATTITUDE_DIR><TIME_SYSTEM>TDB</TIME_SYSTEM>\
        <ATTITUDE_TYPE>EULER_ANGLE/RATE</ATTITUDE_TYPE><EULER_ROT_SEQ>321</EULER_ROT_SEQ></metadata><data><attitudeState><eulerAngleRate>\
        <EPOCH>2026-07-01T00:30:00</EPOCH><rotationAngles><rotation1 angle='Z_ANGLE' units='deg'>20</rotation1>\
        <rotation2 angle='Y_ANGLE' units='deg'>-35</rotation2><rotation3 angle='X_ANGLE' units='deg'>110</rotation3></rotationAngles>\
        <rotationRates><rotation1 units='deg/s'>1</rotation1><rotation2 units='deg/s'>1</rotation2><rotation3 units='deg/s'>1</rotation3>\
        </rotationRates></eulerAngleRate></attitudeState></data></segment></body></aem>";
    assert!(close(rotation(&parsed(old).unwrap(), "2026-07-01T00:30:00 TDB"), got, 0.0));
}

#[test]
fn angular_velocities_and_derivatives_give_hermites_polynomials() {
    // A frame that turns about its own x by 0.02 rad/s, while that axis turns about z by 0.01 rad/s.
    let (spin, precession) = (0.02_f64, 0.01_f64);
    let q = |s: f64| DQuat::from_rotation_z(precession * s) * DQuat::from_rotation_x(spin * s);
    let along_b = |s: f64| DQuat::from_rotation_x(-spin * s) * DVec3::Z * precession + DVec3::X * spin;
    let along_a = |s: f64| DVec3::Z * precession + DQuat::from_rotation_z(precession * s) * DVec3::X * spin;
    let derivative = |s: f64| {
        let w = along_b(s) / 2.0;
        q(s) * DQuat::from_xyzw(w.x, w.y, w.z, 0.0)
    };
    let method = "INTERPOLATION_METHOD = HERMITE\nINTERPOLATION_DEGREE = 7\n";
    type Extra<'a> = &'a dyn Fn(f64) -> Vec<f64>;
    let velocities: [(&str, Extra<'_>); 4] = [
        ("QUATERNION/ANGVEL\nANGVEL_FRAME = SC", &|s| (along_b(s) * 180.0 / std::f64::consts::PI).to_array().to_vec()),
        ("QUATERNION/ANGVEL\nANGVEL_FRAME = REF_FRAME_A", &|s| {
            (along_a(s) * 180.0 / std::f64::consts::PI).to_array().to_vec()
        }),
        ("QUATERNION/DERIVATIVE", &|s| derivative(s).to_array().to_vec()),
        ("QUATERNION", &|_| vec![]),
    ];
    for (kind, extra) in velocities {
        let row = |i: u32| {
            let s = 10.0 * f64::from(i);
            let numbers: Vec<String> = q(s).to_array().iter().chain(&extra(s)).map(|v| format!("{v:.16}")).collect();
            format!("2026-07-01T00:{:02}:{:02} {}\n", i / 6, i % 6 * 10, numbers.join(" "))
        };
        let rows: String = (0..=12).map(row).collect();
        let file = parsed(&aem("2.0", &format!("ATTITUDE_TYPE = {kind}\n{method}"), &rows)).unwrap();
        for s in [3.0, 15.0, 58.0, 117.0] {
            let epoch = time("2026-07-01T00:00:00 TDB").after_s(s);
            let got = file.orientations[0].1.frame_from_base(epoch).unwrap().unwrap();
            // Parts of the quaternion go by 0.015 rad/s at most: next to the end eight rows of Lagrange's are off by 4e-9, four of
            // Hermite's by 6e-12 (the eighth derivative by the product of distances over 8!).
            let tolerance = if kind == "QUATERNION" { 2e-8 } else { 1e-10 };
            assert!(close(got, DMat3::from_quat(q(s)).transpose(), tolerance), "{kind} at {s} s");
        }
        // Hermite's need what is not there.
        assert_eq!(kind == "QUATERNION", notes(&file).contains("Lagrange is used instead"), "{}", notes(&file));
    }
}

/// Numbers that are the same everywhere.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 16
    }

    /// From -1 to 1.
    fn unit(&mut self) -> f64 {
        self.next() as f64 / (1_u64 << 47) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// A file of a trajectory and an orientation at moments of any number of digits.
fn made(seed: u64, scale: Scale, start: Epoch) -> FlightFile {
    let mut numbers = Numbers(seed);
    let object = || Object { name: "MMX".into(), id: "-3".into() };
    let mut tdb_s = vec![];
    let mut s = start.tdb_s();
    for _ in 0..40 {
        s += 1e-3 + 100.0 * numbers.unit().abs();
        tdb_s.push(s);
    }
    let span = Span { start: Epoch::from_tdb_s(tdb_s[3]).unwrap(), end: Epoch::from_tdb_s(tdb_s[39]).unwrap() };
    let vectors =
        |numbers: &mut Numbers, scale: f64| tdb_s.iter().map(|_| numbers.vector() * scale).collect::<Vec<_>>();
    let nodes = Nodes {
        tdb_s: tdb_s.clone(),
        position_m: vectors(&mut numbers, 1e7),
        velocity_m_s: vectors(&mut numbers, 1e3),
        interpolation: if seed.is_multiple_of(2) { Interpolation::Hermite(4) } else { Interpolation::Lagrange(9) },
    };
    let frame_from_base: Vec<DQuat> =
        tdb_s.iter().map(|_| DQuat::from_vec4(DVec4::from((numbers.vector(), numbers.unit())).normalize())).collect();
    let derivative = match seed.is_multiple_of(2) {
        true => tdb_s.iter().map(|_| DVec4::from((numbers.vector(), numbers.unit())) * 1e-3).collect(),
        false => vec![],
    };
    let between = if seed.is_multiple_of(2) { Between::Hermite(3) } else { Between::SteadyTurn };
    let attitudes = Attitudes { tdb_s, frame_from_base, derivative, between }.with_continuous_signs();
    let trajectory = Trajectory {
        target: "MMX".into(),
        centre: "PHOBOS".into(),
        frame: "J2000".into(),
        source: "made".into(),
        segments: vec![Segment { span, path: flight::Path::Nodes(nodes) }],
    };
    let orientation = Orientation {
        frame: "SC_BODY_1".into(),
        base: "J2000".into(),
        source: "made".into(),
        turns: vec![Turn { span: Some(span), turning: Turning::Attitudes(attitudes) }],
    };
    FlightFile {
        trajectories: vec![(object(), trajectory)],
        orientations: vec![(object(), orientation)],
        scale,
        made: Some(("2026-01-01T00:00:00".into(), "X".into())),
        comments: vec!["one < two".into(), "three".into()],
        report: Report::default(),
        input: InputFile::of(Path::new("made"), b""),
    }
}

#[test]
fn what_is_written_is_read_back_bit_by_bit() {
    let mut exact = 0;
    let scales = [Scale::Tdb, Scale::Utc, Scale::Tai, Scale::Tt, Scale::Gps];
    let starts =
        ["2000-01-01T12:00:00 TDB", "2026-07-01T00:00:00 TDB", "1980-01-01T00:00:00 TDB", "2016-12-31T23:59:00 TDB"];
    for (seed, (scale, start)) in scales.into_iter().flat_map(|scale| starts.map(|start| (scale, start))).enumerate() {
        let file = made(seed as u64, scale, time(start));
        let both = parsed(&ccsds::ndm(&file, &leap(), None).unwrap().0).unwrap();
        let orbit = parsed(&ccsds::oem(&file, &leap(), None).unwrap().0).unwrap();
        let attitude = parsed(&ccsds::aem(&file, &leap(), None).unwrap().0).unwrap();
        for (trajectories, orientations) in
            [(&both.trajectories, &both.orientations), (&orbit.trajectories, &attitude.orientations)]
        {
            let ((object, found), (_, made)) = (&trajectories[0], &file.trajectories[0]);
            assert_eq!((object, &found.target, &found.frame), (&file.trajectories[0].0, &made.target, &made.frame));
            let (flight::Path::Nodes(a), flight::Path::Nodes(b)) = (&found.segments[0].path, &made.segments[0].path)
            else {
                panic!("no nodes")
            };
            assert_eq!(
                (&a.position_m, &a.velocity_m_s, a.interpolation),
                (&b.position_m, &b.velocity_m_s, b.interpolation)
            );
            // TDB is the scale of moments; others are rounded once on their way, to what an f64 of them has.
            for (a, b) in a.tdb_s.iter().zip(&b.tdb_s) {
                assert!((a - b).abs() <= 1e-9_f64.max(2.0 * f64::EPSILON * b.abs()), "{}: {a} {b}", scale.name());
                // Within months of J2000 they are finer than the 9 digits that are written.
                assert!(a == b || scale != Scale::Tdb || b.abs() < 1e7);
                exact += usize::from(a == b);
            }
            let (Turning::Attitudes(a), Turning::Attitudes(b)) =
                (&orientations[0].1.turns[0].turning, &file.orientations[0].1.turns[0].turning)
            else {
                panic!("no attitudes")
            };
            assert_eq!((&a.frame_from_base, &a.derivative, a.between), (&b.frame_from_base, &b.derivative, b.between));
        }
        assert_eq!((both.comments[..2].to_vec(), both.made.clone()), (file.comments.clone(), file.made.clone()));
    }
    // Of 15 files away from J2000, twice 40 moments each: nearly all come back as they were.
    assert!(exact > 1150, "{exact} of 1200");
}

#[test]
fn leap_seconds_are_there_or_not() {
    let meta = "START_TIME = 2016-12-31T23:59:59\nSTOP_TIME = 2017-01-01T00:00:01\nINTERPOLATION = LINEAR\n";
    let rows = "2016-12-31T23:59:59 0 0 0\n2016-12-31T23:59:60.5 1.5 0 0\n2017-01-01T00:00:01 3 0 0\n";
    let file = parsed(&oem(meta, rows).replace("TDB", "UTC")).unwrap();
    // One km a second, through a minute of 61.
    let state = file.trajectories[0].1.state(time("2017-01-01T00:00:00 UTC")).unwrap().unwrap();
    assert!((state.position_m.x - 2000.0).abs() < 1e-3, "{}", state.position_m.x);
    let other = oem(meta, rows).replace("TDB", "UTC").replace("2016-", "2015-").replace("2017-", "2016-");
    let error = parsed(&other).unwrap_err().to_string();
    assert!(error.contains("a.oem:15:1") && error.contains("leap second"), "{error}");
}

#[test]
fn all_that_is_wrong_is_told_with_its_line() {
    let span = "START_TIME = 2026-07-01T00:00:00\nSTOP_TIME = 2026-07-01T00:10:00\n";
    let text = oem(
        &format!("{span}INTERPOLATION = SPLINE\nINTERPOLATION_DEGREE = 0\nINTERPOLATION = LINEAR\n"),
        "2026-07-01T00:00:00 1 2 3\n2026-07-01T00:00:00 1 2 3\n2026-06-30T00:00:00 1 2 3\n2026-07-01T00:02:00 1 2\n\
         2026-07-01T00:03:00 1 2 x\n2026-07-01T00:04:60 1 2 3\n2026-07-01T00:05:00Z 1 2 3\n2026-07-01T00:06:00 1 2 inf\nnonsense\n",
    );
    let error = parsed(&text).unwrap_err().to_string();
    for told in [
        ":14:1: INTERPOLATION is given twice",
        ":17:1: has the same time as the previous row",
        ":18:1: is earlier than the previous row",
        ":19:1: 2 numbers after the time; expected 3 or 6 or 9",
        ":20:25: `x` is not a finite number",
        ":21:1: \"2026-07-01T00:04:60\" is not a time",
        ":22:1: \"2026-07-01T00:05:00Z\" ends in Z",
        ":23:25: `inf` is not a finite number",
        ":24:1: `nonsense` is unexpected here",
    ] {
        assert!(error.contains(told), "{told} is not in\n{error}");
    }
    let quaternion = |row: &str| aem("2.0", "ATTITUDE_TYPE = QUATERNION\n", row);
    let row = "2026-07-01T00:00:00 1 2 3 4 5 6\n";
    let rows = "2026-07-01T00:00:00 1 2 3\n";
    for (text, told) in [
        (oem(span, ""), ":4:1: has no rows"),
        (oem(span, "2026-07-01T00:00:00 1 2 3\n2026-07-01T00:11:00 1 2 3\n"), ":14:1: lies after STOP_TIME"),
        (oem(span, "2026-07-01T00:00:00 1 2 3\n2026-07-01T00:01:00 1 2 3 4 5 6\n"), ":14:1: has a velocity"),
        (oem(&format!("{span}INTERPOLATION = SPLINE\n"), row), "`SPLINE` is not an interpolation method"),
        (
            oem(&format!("{span}INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = -1\n"), row),
            ":13:1: `-1` is not a degree",
        ),
        (
            oem(&format!("{span}USEABLE_START_TIME = 2026-07-01T01:00:00\n"), row),
            ":12:1: USEABLE_START_TIME does not lie",
        ),
        (oem(span, row).replace("STOP_TIME = 2026", "STOP_TIME = 2025"), "stops before it starts"),
        (oem(span, row).replace("2.0", "two"), ":1:1: `two` is not a version"),
        (oem(span, row).replace("META_STOP\n", ""), "META_STOP: it may be cut off"),
        (oem(span, rows).replace("CENTER_NAME = PHOBOS\n", ""), ":4:1: this segment's metadata lacks CENTER_NAME"),
        (
            oem(span, rows).replace("OBJECT_NAME = MMX\n", "OBJECT_NAME =\n"),
            ":5:1: this segment's metadata lacks OBJECT_NAME",
        ),
        (oem(span, rows).replace("REF_FRAME = EME2000", "REF_FRAME"), ":8:1: `REF_FRAME` is not of the form"),
        ("CCSDS_OEM_VERS = 2.0\n".into(), ":1:1: holds no segment"),
        (quaternion("2026-07-01T00:00:00 0.6 0.0 0.6 0.6\n"), ":12:1: quaternion of length 1.039230"),
        (quaternion("2026-07-01T00:00:00 0 0 0 0\n"), "quaternion of length 0.000000"),
        (quaternion("2026-07-01T00:00:00 1e300 1e300 0 0\n"), "quaternion of length inf"),
        (quaternion("2026-07-01T00:00:00 0 0 1\n"), ":12:1: 3 numbers after the time; expected 4"),
        (
            quaternion("2026-07-01T00:00:00 0 0 0 1\n").replace("DATA_STOP\n", ""),
            ":11:1: the file ends before DATA_STOP",
        ),
        (quaternion("2026-07-01T00:00:00 0 0 0 1\n").replace("2.0", "1.0"), "lacks ATTITUDE_DIR"),
        (
            aem("2.0", "ATTITUDE_TYPE = EULER_ANGLE\nEULER_ROT_SEQ = 311\n", rows),
            ":10:1: `311` is not a sequence of axes",
        ),
        (aem("2.0", "ATTITUDE_TYPE = EULER_ANGLE\n", rows), "lacks EULER_ROT_SEQ"),
        (aem("2.0", "ATTITUDE_TYPE = MATRIX\n", rows), ":9:1: `MATRIX` is not a type of attitude"),
        ("<ndm></ndm>".into(), "a.oem:1:1 ndm: holds neither <oem> nor <aem>"),
        ("<oem version='2.0'><body/></oem>".into(), "holds no segment"),
        ("hello".into(), "is not a message of CCSDS"),
        (String::new(), "is not a message of CCSDS"),
    ] {
        let error = parsed(&text).expect_err(&text).to_string();
        assert!(error.contains(told), "{told} is not in\n{error}\n{text}");
    }
}

#[test]
fn what_is_not_supported_is_named() {
    let span = "START_TIME = 2026-07-01T00:00:00\nSTOP_TIME = 2026-07-01T00:10:00\n";
    let rows = "2026-07-01T00:00:00 1 2 3\n";
    for (text, told) in [
        (oem(span, rows).replace("TDB", "MET"), "a.oem:9:1: TIME_SYSTEM = MET"),
        (oem(span, rows).replace("2.0", "4.0"), "a.oem:1:1: version 4.0"),
        (aem("2.0", "ATTITUDE_TYPE = SPIN/NUTATION\n", rows), "a.oem:9:1: ATTITUDE_TYPE = SPIN/NUTATION"),
        ("COMMENT x\nCCSDS_OPM_VERS = 2.0\n".into(), "OPM (one state of an orbit"),
        ("<?xml version='1.0'?>\n<!-- x -->\n<apm/>".into(), "a.oem:3:1 apm: a message of kind APM"),
        ("<ndm><omm/><tdm/></ndm>".into(), "a.oem:1:6 omm: a message of kind OMM"),
    ] {
        let error = parsed(&text).expect_err(&text);
        assert!(matches!(error, Error::Unsupported { .. }) && error.to_string().contains(told), "{error}");
    }
}

#[test]
fn what_is_taken_otherwise_is_told() {
    let span = "START_TIME = 2026-07-01T00:00:00\nSTOP_TIME = 2026-07-01T00:10:00\n";
    let hermite = "INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\n";
    let positions = "2026-07-01T00:00:00 1 2 3\n2026-07-01T00:10:00 1 2 4\n";
    let states = "2026-07-01T00:00:00 1 2 3 0 0 0 9 9 9\n2026-07-01T00:10:00 1 2 4 0 0 0\n";
    let covariance = "COVARIANCE_START\nEPOCH = 2026-07-01T00:00:00\n1e-4\nCOVARIANCE_STOP\n";
    let linear = "INTERPOLATION = LINEAR\n";
    for (text, told) in [
        (oem(span, positions), "INTERPOLATION, which is missing: Lagrange polynomials of degree 7"),
        (oem(span, states), "INTERPOLATION, which is missing: Hermite polynomials of degree 7"),
        (oem(span, positions), ":4:1: its polynomials need 8 rows, but there are 2: all are used"),
        (oem(&format!("{span}{hermite}"), positions), ":12:1: Hermite polynomials need velocities"),
        (oem(&format!("{span}{linear}"), states), ":14:1: accelerations"),
        (oem(&format!("{span}{linear}"), &format!("{states}{covariance}")), ":16:1: covariances"),
        (oem(&format!("{span}{linear}COLOUR = RED\n"), states), ":13:1: COLOUR is not a known key"),
        (oem(linear, states), "START_TIME, which is missing: that of its rows, 2026-07-01T00:00:00"),
        (
            oem(&format!("{span}{linear}"), "2026-07-01T00:01:00 1 2 3\n"),
            "2026-07-01T00:00:00 to 2026-07-01T00:10:00, but its rows cover 2026-07-01T00:01:00 to",
        ),
        (oem(&format!("{span}INTERPOLATION = LAGRANGE\n"), states), ":12:1: INTERPOLATION_DEGREE, which is missing: 7"),
        (
            aem("2.0", "ATTITUDE_TYPE = QUATERNION\n", "2026-07-01T00:00:00 0 0 0 1.00001\n"),
            "differ from 1 by up to 1.0e-5",
        ),
    ] {
        let file = parsed(&text).expect(&text);
        assert!(notes(&file).contains(told), "{told} is not in\n{}", notes(&file));
    }
    // Nothing is said where nothing is taken: all is stated here.
    let file = parsed(&oem(&format!("{span}{linear}"), positions)).unwrap();
    assert_eq!(notes(&file), "");
    // Where segments overlap the later one holds; where they touch there is nothing to tell.
    let later = |start: &str| {
        let span = span.replace("00:00:00", start);
        let rows = format!("2026-07-01T{start} 5 0 0\n2026-07-01T00:10:00 5 0 0\n");
        let second = oem(&format!("{span}{linear}"), &rows);
        format!(
            "{}{}",
            oem(&format!("{span}{linear}", span = span.replace(start, "00:00:00")), positions),
            &second[second.find("META_START").unwrap()..]
        )
    };
    let file = parsed(&later("00:05:00")).unwrap();
    assert!(notes(&file).contains(":16:1: overlaps an earlier segment"), "{}", notes(&file));
    let x = |at: &str| file.trajectories[0].1.state(time(at)).unwrap().unwrap().position_m.x;
    assert_eq!((x("2026-07-01T00:04:59 TDB"), x("2026-07-01T00:05:00 TDB")), (1000.0, 5000.0));
}

#[test]
fn tables_are_read() {
    let text = "# centre = Phobos\n# epoch = 2026-07-01T00:00:00 UTC\nseconds,mmx_x_km,mmx_y_km,mmx_z_km,Sun_x_m,sun_y_m,sun_z_m,\
        sc_q1,sc_q2,sc_q3,sc_qc\n0,20,0,0,2e11,0,0,0.5,0.5,0.5,0.5\n10,20,0.1,0,2e11,0,0,0.5,0.5,0.5,0.5\n20,20,0.4,0,2e11,0,0,.5,.5,.5,.5\n";
    let file = table(text).unwrap();
    let of = |name: &str| &file.trajectories.iter().find(|(_, of)| of.target == name).unwrap().1;
    assert_eq!((of("MMX").frame.as_str(), of("SUN").centre.as_str()), ("IAU_PHOBOS", "PHOBOS"));
    // y = t^2 m.
    let state = of("MMX").state(time("2026-07-01T00:00:15 UTC")).unwrap().unwrap();
    assert!((state.position_m - DVec3::new(20_000.0, 225.0, 0.0)).length() < 1e-5, "{state:?}");
    assert!((state.velocity_m_s.y - 30.0).abs() < 1e-5, "{state:?}");
    let turned = file.orientations[0].1.frame_from_base(time("2026-07-01T00:00:05 UTC")).unwrap().unwrap();
    assert!(close(turned, DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y), 1e-15));
    let one = table("# center = MARS\n# frame = J2000\n# degree = 1\ntdb;a_x_m;a_y_m;a_z_m\n2026-182;1;2;3\n").unwrap();
    assert_eq!(
        one.trajectories[0].1.state(time("2026-07-01 TDB")).unwrap().unwrap().position_m,
        DVec3::new(1.0, 2.0, 3.0)
    );
    assert_eq!(notes(&one), "");
    for (from, to, told) in [
        ("# centre = Phobos\n", "", "`centre` is missing"),
        ("# epoch = 2026-07-01T00:00:00 UTC\n", "", "a.csv:2:1: `seconds` needs an `epoch`"),
        ("UTC\nseconds", "\nseconds", "a.csv:2:11: "),
        ("seconds,", "when,", "a.csv:3:1: `when` is not a column of time"),
        ("mmx_x_km", "mmx_x", "a.csv:3:9: `mmx_x` is not a known column"),
        ("mmx_x_km", "mmx_y_m", "a.csv:3:17: duplicate column `mmx_y_km`"),
        ("mmx_x_km", "moon_x_km", "mmx has 2 of the 3 position columns"),
        ("\n10,", "\n0,", "a.csv:5:1: is not later than the previous row"),
        ("0.1,", "0.1,7,", "a.csv:5:1: 12 columns where the header has 11"),
        ("0.1", "?", "a.csv:5:7: `?` is not a finite number"),
        ("# epoch", "# fram = J2000\n# epoch", "did you mean `frame`?"),
        ("\n20,", "\n1e14,", "more than 100,000 years away"),
        ("0.5,0.5,0.5,0.5\n10", "0.5,0.5,0.5,0.7\n10", "the quaternion of sc has length"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let error = table(&changed).expect_err(&changed).to_string();
        assert!(error.contains(told), "{told} is not in\n{error}");
    }
    assert!(table("# centre = MARS\ntdb,a_x_m,a_y_m,a_z_m\n").unwrap_err().to_string().contains("no rows"));
}

#[test]
fn tables_are_read_as_toml() {
    let scratch = Scratch::new();
    let text = "mmxrt_flight = 1\ncentre = \"PHOBOS\"\nepoch = \"2026-07-01T00:00:00 TDB\"\n[[row]]\nseconds = 0\n\
        position_km = { MMX = [20, 0, 0] }\nquaternion = { SC = [0.5, 0.5, 0.5, 0.5] }\n[[row]]\ntime = \"2026-07-01T00:00:10 TDB\"\n\
        position_km = { MMX = [20, 1, 0] }\nquaternion = { SC = [0.5, 0.5, 0.5, 0.5] }\n";
    let read = |text: &str| ephemeris::read(&scratch.write("a.toml", text), &leap());
    let file = read(text).unwrap();
    let at = time("2026-07-01T00:00:05 TDB");
    let state = file.trajectories[0].1.state(at).unwrap().unwrap();
    // Half of the way between two rows; 100 m/s.
    assert!((state.position_m - DVec3::new(20_000.0, 500.0, 0.0)).length() < 1e-9, "{state:?}");
    assert!((state.velocity_m_s - DVec3::new(0.0, 100.0, 0.0)).length() < 1e-9, "{state:?}");
    assert_eq!(file.trajectories[0].1.frame, "IAU_PHOBOS");
    let turned = file.orientations[0].1.frame_from_base(at).unwrap().unwrap();
    assert!(close(turned, DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y), 1e-15));
    for (from, to, told) in [
        ("epoch = \"2026-07-01T00:00:00 TDB\"\n", "", "needs either `time`"),
        ("TDB\"\n[[row]]", "\"\n[[row]]", "has no time scale"),
        ("00:00:10", "00:00:00", "is not later than the previous row"),
        ("{ MMX = [20, 1, 0] }", "{ SUN = [20, 1, 0] }", "must list the same objects as the first row"),
        ("0.5, 0.5, 0.5, 0.5", "0.5, 0.5, 0.5, 0.7", "a.toml:7:"),
        ("centre = \"PHOBOS\"\n", "", "centre"),
        ("[20, 0, 0]", "[20, 0]", "a.toml:6:"),
        ("flight = 1", "flight = 2", "a.toml:1:"),
    ] {
        let error = read(&text.replacen(from, to, 1)).expect_err(from).to_string();
        assert!(error.contains(told), "{told} is not in\n{error}");
    }
}

#[test]
fn damaged_files_are_errors_and_no_more() {
    let mut texts = vec![];
    for name in ["circle.oem", "turn.aem"] {
        let file = ephemeris::read(&data(name), &leap()).unwrap();
        texts.push(std::fs::read(data(name)).unwrap());
        texts.push(ccsds::ndm(&file, &leap(), None).unwrap().0.into_bytes());
    }
    let csv = "# centre = PHOBOS\n# frame = J2000\nutc,a_x_km,a_y_km,a_z_km,a_vx_m_s,a_vy_m_s,a_vz_m_s,b_q1,b_q2,b_q3,b_qc\n\
        2026-07-01T00:00:00,1,2,3,4,5,6,0,0,0,1\n2026-07-01T00:01:00,1,2,3,4,5,6,0,0,1,0\n";
    texts.push(csv.as_bytes().to_vec());
    let words: [&[u8]; 12] =
        [b"nan", b"1e308", b"-", b"=", b"\n", b"META_STOP", b"\xc3\xa9", b"0", b"9999999", b"<", b"Z", b"T23:59:60"];
    let mut numbers = Numbers(1);
    let (mut read, mut refused) = (0, 0);
    for round in 0..4000 {
        let mut bytes = texts[round % texts.len()].clone();
        for _ in 0..=numbers.next() % 3 {
            let at = numbers.next() as usize % bytes.len();
            let end = (at + numbers.next() as usize % 20).min(bytes.len());
            let word = words[numbers.next() as usize % words.len()];
            match numbers.next() % 4 {
                0 => drop(bytes.splice(at..end, [])),
                1 => drop(bytes.splice(at..at, word.iter().copied())),
                2 => drop(bytes.splice(at..(at + 1).min(bytes.len()), word.iter().copied())),
                _ => bytes.truncate(at.max(1)),
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        let is_table = round % texts.len() == 4;
        match if is_table { table(&text) } else { parsed(&text) } {
            Err(error) => {
                assert!(!error.problems().is_empty());
                refused += 1;
            }
            Ok(file) => {
                for (_, of) in &file.trajectories {
                    let spans = of.spans();
                    spans.iter().for_each(|span| _ = black_box((of.state(span.start), of.state(span.end))));
                }
                for (_, of) in &file.orientations {
                    let spans = of.spans().unwrap();
                    spans
                        .iter()
                        .for_each(|span| _ = black_box((of.frame_from_base(span.start), of.frame_from_base(span.end))));
                }
                // What was read can be written, and read again.
                let (text, _) = ccsds::ndm(&file, &leap(), None).unwrap();
                parsed(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
                read += 1;
            }
        }
    }
    assert!(read > 300 && refused > 300, "{read} read, {refused} refused");
}

#[test]
fn steps_are_sampled_and_their_number_is_bounded() {
    let file = ephemeris::read(&data("circle.oem"), &leap()).unwrap();
    let (text, report) = ccsds::oem(&file, &leap(), Some(600.0)).unwrap();
    assert!(report.has_losses());
    let sampled = parsed(&text).unwrap();
    let lengths: Vec<usize> = sampled.trajectories[0]
        .1
        .segments
        .iter()
        .map(|segment| match &segment.path {
            flight::Path::Nodes(nodes) => nodes.tdb_s.len(),
            _ => 0,
        })
        .collect();
    // 3600 s and 3000 s, both ends included.
    assert_eq!(lengths, [7, 6]);
    // An hour has 60 steps of a minute in the scale of the file, whose seconds are not those of TDB: no row lies just before the last one.
    let mut looked_at = 0;
    for scale in ["utc", "tai", "tt", "gps", "tdb"] {
        for month in 1..=12 {
            let at = |hour: u32| format!("2027-{month:02}-0{}T0{hour}:59:30.{month:03}", 1 + month % 9);
            let rows = format!("{},1,2,3\n{},2,2,3\n", at(6), at(7));
            let text = format!("# centre = PHOBOS\n# frame = J2000\n# degree = 1\n{scale},a_x_m,a_y_m,a_z_m\n{rows}");
            let (text, _) = ccsds::oem(&table(&text).unwrap(), &leap(), Some(60.0)).unwrap();
            let trajectory = parsed(&text).unwrap().trajectories.remove(0).1;
            let flight::Path::Nodes(nodes) = &trajectory.segments[0].path else { panic!("{trajectory:?}") };
            let steps: Vec<f64> = nodes.tdb_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps.len() == 60 && steps.iter().all(|s| (s - 60.0).abs() < 1e-5), "{scale} {month}: {steps:?}");
            looked_at += 1;
        }
    }
    assert_eq!(looked_at, 60);
    for step_s in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        assert!(ccsds::oem(&file, &leap(), Some(step_s)).is_err(), "{step_s}");
    }
    assert!(ccsds::aem(&file, &leap(), None).unwrap_err().to_string().contains("holds no orientation"));
}

#[test]
fn commands_take_them() {
    let scratch = Scratch::new();
    let path = |name: &str| data(name).to_str().unwrap().to_owned();
    let run = |arguments: &[&str]| {
        let output = crate::cli::mmxrt().args(arguments).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (code, out, error) = run(&["inspect", &path("circle.oem")]);
    assert_eq!(code, Some(0), "{error}");
    // Rows 0 to 12 of 300 s twice; heights between those of a point above the poles' radius and above the longest axis.
    for told in [
        "kind: oem",
        "Hermite, degree 7",
        "Lagrange, degree 8",
        "rows 13",
        "[300.0,300.0,300.0]",
        "gaps:\n  name MMX, from 2026-07-01T01:00:00.000 TDB, to 2026-07-01T01:35:00.000 TDB",
    ] {
        assert!(out.contains(told), "{told} is not in\n{out}");
    }
    let (_, json, _) = run(&["inspect", &path("circle.oem"), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let height = |key: &str| json["altitude_km"][0][key].as_f64().unwrap();
    assert!(height("min") > 27.0 && height("max") < 40.0 - 9.1 && height("min") < height("max"), "{json}");
    let xml = scratch.argument("a.xml");
    let back = scratch.argument("b.oem");
    for arguments in [
        ["convert", &path("circle.oem"), &xml].as_slice(),
        &["convert", &xml, &back],
        &["convert", "--diff", &path("circle.oem"), &back],
    ] {
        let (code, _, error) = run(arguments);
        assert_eq!(code, Some(0), "{arguments:?}: {error}");
    }
    let (code, _, error) = run(&["convert", &path("turn.aem"), &scratch.argument("c.oem")]);
    assert!(code != Some(0) && error.contains("holds no trajectory"), "{error}");
    let (code, _, error) = run(&["convert", &path("turn.aem"), &scratch.argument("c.obj")]);
    assert!(code != Some(0) && error.contains("they make no obj"), "{error}");
    let cases = r#"{"oracles": [{"group": "ccsds", "name": "circle", "inputs": {"file": "circle.oem", "et_tdb": 836136000.0},
        "expected": {"state_km_kms": [40.0, 0.0, 0.0, 0.0, 0.006928203230275509, 0.004]}, "tol_abs": 1e-12}]}"#;
    let cases = scratch.write("cases.json", cases);
    let folder = data("").to_str().unwrap().to_owned();
    let (code, out, error) = run(&["validate", "--oracles", cases.to_str().unwrap(), "--data", &folder]);
    assert!(code == Some(0) && out.contains("6 passed, 0 failed, 0 skipped"), "{out}{error}");
    let (_, out, _) = run(&["validate", "--oracles", cases.to_str().unwrap()]);
    assert!(out.contains("0 passed, 0 failed, 1 skipped"), "{out}");
}
