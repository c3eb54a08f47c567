//! The day before a scene, as flight dynamics knows it, feeds the ground's heat: against steady rotation, closed forms and another method.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};
use mmxrt::flight::{
    Aim, Almanac, Correction, Epoch, Interpolation, Nodes, Orientation, Path, Pointing, Segment, Span, Trajectory,
    Turn, Turning, Up,
};
use mmxrt::formats::scene_toml;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Globe, MarsModel, Motion, Past, Scene};
use mmxrt::spectral::Spectrum;
use mmxrt::{solve, study};

use crate::conduction::{DAY_S, SIGMA, explicit_k, ground, temperatures_k};
use crate::flight_scene::FLYING;
use crate::scenes::{mars, replaced};
use crate::scratch::Scratch;
use crate::shapes::plane;

const SUN_M: f64 = 1.523_679 * mmxrt::units::AU_M;
const MARS_M: f64 = 9_376_000.0;
/// What level ground under the Sun absorbs, W m-2.
const NOON_W_M2: f64 = 0.97 * 1361.0 / (1.523_679 * 1.523_679);

/// A rock that turns steadily about +y, with the Sun over +z at J2000, and Mars always there. Its ground is 11 km from its centre.
fn steady(known: Option<Span>) -> Motion {
    let always = Span { start: Epoch::FIRST, end: Epoch::LAST };
    let trajectory = |target: &str, frame: &str, span: Span, place_m: DVec3| Trajectory {
        target: target.into(),
        centre: "ROCK".into(),
        frame: frame.into(),
        source: "a test".into(),
        segments: vec![Segment { span, path: Path::Fixed(place_m) }],
    };
    let mut almanac = Almanac::default();
    almanac.trajectories.push(trajectory("SUN", "J2000", known.unwrap_or(always), DVec3::Z * SUN_M));
    almanac.trajectories.push(trajectory("MARS", "IAU_ROCK", always, DVec3::Z * (MARS_M + 11_000.0)));
    let spin = mmxrt::flight::Spin {
        since: Epoch::J2000,
        frame_from_base: DQuat::IDENTITY,
        rate_rad_s: DVec3::Y * (TAU / DAY_S),
    };
    almanac.orientations.push(Orientation {
        frame: "IAU_ROCK".into(),
        base: "J2000".into(),
        source: "a test".into(),
        turns: vec![Turn { span: None, turning: Turning::Spin(spin) }],
    });
    Motion {
        almanac: Arc::new(almanac),
        body: "ROCK".into(),
        frame: "IAU_ROCK".into(),
        origin_m: DVec3::Z * 11_000.0,
        spacecraft: "SUN".into(),
        pointing: Pointing { aim: Aim::Nadir, up: Up::North, scan: None, bias_rad: DVec3::ZERO, jitter: None },
        correction: Correction::None,
        start: Epoch::J2000,
    }
}

/// A rock that turns about its North, +z, as fast, over whose equator, at +x, a camera goes steadily, which looks straight down, North up: a kilometre over the
/// ground 10 s after the start, which is so long after noon.
pub(crate) fn over(velocity_m_s: DVec3, after_noon_deg: f64) -> Motion {
    let mut motion = steady(None);
    let start = moment(after_noon_deg);
    let mut almanac = Almanac::clone(&motion.almanac);
    motion.origin_m = DVec3::X * 11_000.0;
    almanac.trajectories[0].segments[0].path = Path::Fixed(DVec3::X * SUN_M);
    if let Turning::Spin(spin) = &mut almanac.orientations.last_mut().unwrap().turns[0].turning {
        spin.rate_rad_s = DVec3::Z * (TAU / DAY_S);
    }
    let at = |s: f64| DVec3::X * 12_000.0 + velocity_m_s * (s - 10.0);
    let path = Path::Nodes(Nodes {
        tdb_s: vec![start.tdb_s() - 100.0, start.tdb_s() + 100.0],
        position_m: vec![at(-100.0), at(100.0)],
        velocity_m_s: vec![],
        interpolation: Interpolation::Lagrange(2),
    });
    let span = Span { start: start.after_s(-100.0), end: start.after_s(100.0) };
    almanac.trajectories.push(Trajectory {
        target: "PROBE".into(),
        frame: "IAU_ROCK".into(),
        segments: vec![Segment { span, path }],
        ..almanac.trajectories[0].clone()
    });
    let sensor = DMat3::from_cols(DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X);
    motion.pointing.aim = Aim::Fixed("IAU_ROCK".into(), sensor);
    Motion { almanac: Arc::new(almanac), spacecraft: "PROBE".into(), start, ..motion }
}

fn moment(after_noon_deg: f64) -> Epoch {
    Epoch::J2000.after_s(DAY_S * after_noon_deg / 360.0)
}

/// Ground on the rock's equator under the sky of a moment, whose past is known; a black Mars that is as warm as asked.
fn remembering(after_noon_deg: f64, inertia: f64, steps: u32, mars_w_m2: Option<f64>) -> Scene {
    let mut parts = ground(plane(10.0, 0.0), after_noon_deg, inertia, steps);
    let motion = steady(None);
    if let Some(thermal_exitance_w_m2) = mars_w_m2 {
        let dark = Globe { reflectance: Spectrum::constant(0.0), bond_albedo: 0.0, ..mars(DVec3::Z * MARS_M) };
        parts.sky.mars = Some(Globe { thermal_exitance_w_m2, ..dark });
        parts.models.mars_light = MarsModel::NearField;
        parts.models.eclipses = true;
    }
    parts.sky.past = Some(Past::new(&motion, motion.start));
    parts.sky = motion.sky(&parts.sky, moment(after_noon_deg)).unwrap();
    parts.check().unwrap()
}

#[test]
fn a_steady_past_is_a_rotation() {
    let turns = steady(None).day(moment(25.0)).unwrap().unwrap();
    assert!((turns.period_s / DAY_S - 1.0).abs() < 1e-10, "{turns:?}");
    assert!((turns.axis.vec() - DVec3::Y).length() < 1e-10, "{turns:?}");
    for after_noon_deg in [0.0, 60.0, 89.0, 90.0, 200.0] {
        let by_rotation = temperatures_k(&ground(plane(10.0, 0.0), after_noon_deg, 50.0, 96).check().unwrap());
        let scene = remembering(after_noon_deg, 50.0, 96, None);
        let by_past = temperatures_k(&scene);
        for (a, b) in by_rotation.iter().zip(&by_past) {
            assert!((a - b).abs() < 1e-4, "{after_noon_deg}: {a} {b}");
        }
        // A stated day of another length is another past, though everything stands where it stood now.
        let mut parts = scene.clone().into_parts();
        parts.sky.past = None;
        assert_ne!(study::table_id(&scene), study::table_id(&parts.check().unwrap()));
    }
}

/// From the ground Mars is over it, and hides the Sun for asin(R / d) to each side of noon: 21.19 deg.
#[test]
fn an_eclipse_at_noon_is_in_the_ground_in_the_afternoon() {
    let half = (3_389_500.0 / MARS_M).asin();
    let absorbed = |time: f64| {
        let after_noon = TAU * if time > 0.5 { time - 1.0 } else { time };
        if after_noon.abs() > half { NOON_W_M2 * after_noon.cos().max(0.0) } else { 0.0 }
    };
    for after_noon_deg in [20.0_f64, 30.0] {
        let got_k = temperatures_k(&remembering(after_noon_deg, 50.0, 480, Some(0.0)))[0];
        let expected_k = explicit_k(absorbed, 50.0, after_noon_deg / 360.0);
        assert!((got_k - expected_k).abs() < 1.0, "{after_noon_deg}: {got_k} {expected_k}");
        // Without an eclipse it is far warmer.
        let free_k = temperatures_k(&remembering(after_noon_deg, 50.0, 480, None))[0];
        assert!(free_k - got_k > 10.0, "{after_noon_deg}: {got_k} {free_k}");
    }
}

/// Ground that stores next to nothing is as warm as what reaches it: Mars' heat, (R / d)^2 of its exitance under it, and, beside its disc, the Sun's light.
#[test]
fn without_inertia_an_eclipse_is_the_equilibriums() {
    let mars_w_m2 = 0.95 * 110.0 * (3_389_500.0_f64 / MARS_M).powi(2);
    for (after_noon_deg, is_dark) in [(0.0_f64, true), (20.9, true), (21.5, false), (60.0, false), (180.0, true)] {
        let sun_w_m2 = if is_dark { 0.0 } else { NOON_W_M2 * after_noon_deg.to_radians().cos() };
        let expected_k = ((mars_w_m2 + sun_w_m2) / (0.95 * SIGMA)).powf(0.25);
        let got_k = temperatures_k(&remembering(after_noon_deg, 1e-6, 96, Some(110.0)))[0];
        assert!((got_k - expected_k).abs() < 2e-3, "{after_noon_deg}: {got_k} {expected_k}");
    }
}

#[test]
fn over_a_day_what_is_absorbed_is_emitted() {
    let steps = 24;
    let (mut emitted, mut absorbed) = (0.0, 0.0);
    for step in 0..steps {
        let after_noon_deg = 360.0 * f64::from(step) / f64::from(steps);
        emitted += 0.95 * SIGMA * temperatures_k(&remembering(after_noon_deg, 50.0, steps, Some(110.0)))[0].powi(4);
        let is_dark = !(21.0..=339.0).contains(&after_noon_deg);
        let sun_w_m2 = if is_dark { 0.0 } else { NOON_W_M2 * after_noon_deg.to_radians().cos().max(0.0) };
        absorbed += sun_w_m2 + 0.95 * 110.0 * (3_389_500.0_f64 / MARS_M).powi(2);
    }
    assert!((emitted / absorbed - 1.0).abs() < 1e-5, "{emitted} {absorbed}");
}

#[test]
fn nothing_is_extrapolated() {
    let known = Span { start: moment(-90.0), end: moment(90.0) };
    let motion = steady(Some(known));
    let error = motion.day(moment(0.0)).unwrap_err().to_string();
    assert!(error.contains("SUN") && error.contains("is unknown"), "{error}");
    let mut parts = ground(plane(10.0, 0.0), 0.0, 50.0, 96);
    parts.sky.past = Some(Past::new(&motion, motion.start));
    let scene = parts.check().unwrap();
    assert!(scene.sky.ago(DAY_S / 5.0).is_ok() && scene.sky.ago(DAY_S / 3.0).is_err());
    assert!(scene.sky.reaches_back(96).is_err());
    assert!(solve::solve(&scene, &unwatched).is_err());
    // As Venus: it turns backwards in 243 days, while the Sun goes round in 224.7.
    let (turn_s, year_s) = (243.0 * 86_400.0, 224.7 * 86_400.0);
    let mut slow = steady(None);
    let mut almanac = Almanac::clone(&slow.almanac);
    let mut spin = |frame: &str, rate_rad_s: f64| {
        let mut turning = almanac.orientations.last().unwrap().clone();
        if let Turning::Spin(spin) = &mut turning.turns[0].turning {
            spin.rate_rad_s = DVec3::Z * rate_rad_s;
        }
        almanac.orientations.push(Orientation { frame: frame.into(), ..turning });
    };
    spin("IAU_ROCK", -TAU / turn_s);
    spin("WAY", TAU / year_s);
    almanac.trajectories[0].frame = "WAY".into();
    almanac.trajectories[0].segments[0].path = Path::Fixed(DVec3::X * SUN_M);
    slow.almanac = Arc::new(almanac);
    let day_s = 1.0 / (1.0 / turn_s + 1.0 / year_s);
    let found = slow.day(Epoch::J2000).unwrap().unwrap();
    assert!((found.period_s / day_s - 1.0).abs() < 1e-9 && found.axis.vec().z < -0.999, "{found:?} {day_s}");
    // What does not turn has no day.
    let mut still = steady(None);
    still.frame = "J2000".into();
    assert_eq!(still.day(moment(0.0)).unwrap(), None);
}

/// Scenes that fly over Phobos: its frame turns once in 27553.84 s (1128.8447592 deg a day), and Mars goes 0.44 to 0.64 deg about the Sun in a day.
#[test]
fn a_scene_that_flies_knows_its_day() {
    let scratch = Scratch::new();
    let thermal = "[thermal]\nmodel = \"conduction\"\ninertia = 50\n[flight]";
    let text = replaced(FLYING, &[("[flight]", thermal)]);
    let read = |text: &str| {
        scratch.write("scene.toml", text);
        scene_toml::read(&scratch.join("scene.toml"), &unwatched)
    };
    let file = read(&text).unwrap();
    let sky = &file.scene.sky;
    let turns = sky.rotation.unwrap();
    let day_s = |sun_deg: f64| 360.0 / (1_128.844_759_2 - sun_deg) * 86_400.0;
    assert!(day_s(0.44) < turns.period_s && turns.period_s < day_s(0.64), "{turns:?}");
    assert!(turns.axis.vec().z > 0.999, "{turns:?}");
    assert!(file.defaults.iter().any(|of| of.item == "thermal.period_s"), "{:?}", file.defaults);
    // A day ago the Sun was over the same meridian; a quarter of it ago it was 90 deg further east.
    let longitude_deg = |ago_s: f64| {
        let sun = sky.ago(ago_s).unwrap().sun.direction.vec();
        sun.y.atan2(sun.x).to_degrees()
    };
    assert!((longitude_deg(turns.period_s) - longitude_deg(0.0)).abs() < 1e-3);
    let east_deg = (longitude_deg(0.25 * turns.period_s) - longitude_deg(0.0)).rem_euclid(360.0);
    assert!((east_deg - 90.0).abs() < 2.5, "{east_deg}");
    // Its heat is another than with a Sun that stands still, and needs no more to be said.
    assert!(sky.past.is_some() && file.scene.models.conduction == Some(96));

    // The Sun by a file that knows it for an hour: one has to say how long a day is, and it goes round steadily.
    let oem = "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\nMETA_START\nOBJECT_NAME = SUN\nOBJECT_ID = 10\n\
        CENTER_NAME = PHOBOS\nREF_FRAME = IAU_PHOBOS\nTIME_SYSTEM = UTC\nSTART_TIME = 2027-05-01T05:30:00\n\
        STOP_TIME = 2027-05-01T06:30:00\nMETA_STOP\n2027-05-01T05:30:00 2e8 1e8 0 0 0 0\n2027-05-01T06:30:00 2e8 1e8 0 0 0 0\n";
    scratch.write("sun.oem", oem);
    let short = replaced(&text, &[("orbit = ", "files = [\"sun.oem\"]\norbit = ")]);
    let error = read(&short).unwrap_err().to_string();
    assert!(
        error.contains("nothing says how long that is; the position of SUN relative to PHOBOS is unknown"),
        "{error}"
    );
    assert!(error.contains("scene.toml:"), "{error}");
    let stated = replaced(&short, &[("inertia = 50", "inertia = 50\nperiod_s = 27553.84")]);
    let file = read(&stated).unwrap();
    assert!(file.scene.sky.past.is_none() && file.scene.models.conduction == Some(96));
    let told = file.notes.join("\n");
    assert!(told.contains("the day before the scene is not known, so the Sun goes round steadily"), "{told}");
    // If nothing says that heat is conducted, that is no error.
    let file = read(&replaced(&short, &[("model = \"conduction\"\n", "")])).unwrap();
    assert!(file.scene.sky.rotation.is_none() && file.notes.join("\n").contains("is unknown"), "{:?}", file.notes);
}
