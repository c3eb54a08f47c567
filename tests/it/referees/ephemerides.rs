//! Orbits and attitudes as other programs read and write them: the packages `oem` and, if it is there too, `ccsds-ndm`.

use std::path::Path;

use glam::{DMat3, DVec3};
use mmxrt::flight::LeapSeconds;
use mmxrt::formats::convert::{Content, differences};
use mmxrt::formats::{ccsds, ephemeris};

use super::{answer, python_with};
use crate::scratch::Scratch;

const OEM: &str = "import importlib.util as u, sys; sys.exit(u.find_spec('oem') is None)";

#[test]
fn others_read_what_is_written_and_write_what_is_read() {
    let Some(python) = python_with(OEM) else { return };
    let (leap, scratch) = (LeapSeconds::default(), Scratch::new());
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/flight");
    let read = |path: &Path| ephemeris::read(path, &leap).unwrap();
    let (orbit, attitude) = (read(&data.join("circle.oem")), read(&data.join("turn.aem")));
    scratch.write("ours.oem", ccsds::oem(&orbit, &leap, None).unwrap().0);
    scratch.write("ours.xml", ccsds::ndm(&orbit, &leap, None).unwrap().0);
    scratch.write("ours_aem.xml", ccsds::ndm(&attitude, &leap, None).unwrap().0);
    let states = answer(&python, "ephemerides.py", &scratch, "states.f64");
    let (tilt, rate) = (DMat3::from_rotation_x(30_f64.to_radians()), 2e-4_f64);
    assert_eq!(states.len(), 2 * 4 * 6);
    for (state, s) in states.as_chunks::<6>().0.iter().zip([450.0, 1001.0, 2222.0, 3333.0].repeat(2)) {
        let (sin, cos) = (rate * s).sin_cos();
        let [position_km, velocity_km_s] = [&state[..3], &state[3..]].map(DVec3::from_slice);
        assert!((position_km - tilt * DVec3::new(cos, sin, 0.0) * 40.0).length() < 1e-9, "{position_km:?} at {s} s");
        assert!(
            (velocity_km_s - tilt * DVec3::new(-sin, cos, 0.0) * 40.0 * rate).length() < 1e-9,
            "{velocity_km_s:?} at {s} s"
        );
    }
    let same = |ours: &mmxrt::formats::flight_file::FlightFile, theirs: &str| {
        let theirs = read(&scratch.join(theirs));
        let [ours, theirs] = [ours.clone(), theirs].map(|file| Content::Flight(Box::new(file)));
        let lines = differences(&ours, &theirs);
        assert!(lines.is_empty(), "{lines:?}");
    };
    // 15 digits of their numbers are more than the rows have.
    same(&orbit, "theirs.oem");
    same(&orbit, "theirs.xml");
    if scratch.join("theirs_aem.xml").exists() {
        same(&attitude, "theirs_aem.xml");
    } else {
        println!("SKIPPED: {python} has no ccsds-ndm");
    }
}
