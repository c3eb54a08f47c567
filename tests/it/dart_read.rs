//! DART simulations read: values, frames and losses against what was worked out by hand, and damaged inputs.

use std::path::{Path, PathBuf};

use glam::DVec3;
use mmxrt::Error;
use mmxrt::formats::dart::{
    self, Finding, OpticalKind, ReadOptions, Severity, Simulation, TableSummary, Version, check, flight, groups,
    no_summary, rows,
};
use mmxrt::formats::ilwis;
use mmxrt::progress::unwatched;
use mmxrt::report::{Fate, Report};

use crate::scratch::edit;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// A folder that goes away with the test.
struct Folder(PathBuf);

impl Folder {
    /// A copy of a simulation.
    fn copy(name: &str, simulation: &str) -> Self {
        let folder = Folder(std::env::temp_dir().join(format!("mmxrt-dart-{}-{name}", std::process::id())));
        copy(&data(simulation), &folder.0);
        folder
    }

    fn replace(&self, file: &str, from: &str, to: &str) {
        edit(&self.0.join(file), from, to);
    }

    fn read(&self) -> (Simulation, Report) {
        let (simulation, report, _) = dart::read(&self.0, &ReadOptions::default()).unwrap();
        (simulation, report)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn near(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn a_simulation_of_5_7_is_read_in_full() {
    let path = data("dart/boulder_574");
    let (simulation, report, inputs) = dart::read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(report.notes, []);
    // The eleven files, the object field and the sequence.
    assert_eq!(inputs.len(), 13);
    let Simulation { version, maket, optical, thermal, objects, fields, phase, directions, sequences } = &simulation;
    assert_eq!((version.version.as_str(), version.build.as_str()), ("5.7.4", "v1083"));
    assert_eq!((maket.size_m, maket.cell_m, maket.boundary), ([12.0, 9.0], [0.25, 0.5], 0));
    assert_eq!((maket.ground.kind, maket.ground.index, maket.ground.thermal_index), (4, 0, 1));
    let topography = maket.topography.as_ref().unwrap();
    assert!(maket.ground_enabled && topography.file == "DEM.mp#" && !topography.generated);
    assert_eq!(topography.at.line, Some(13));
    assert_eq!(maket.latitude_longitude_altitude, [-23.5, 10.25, 1.5]);

    let listed: Vec<(OpticalKind, &str, &str, &str)> =
        optical.iter().map(|p| (p.kind, p.ident.as_str(), p.database.as_str(), p.model.as_str())).collect();
    assert_eq!(
        listed,
        [
            (OpticalKind::Lambertian, "rock", "stones.db", "basalt"),
            (OpticalKind::Lambertian, "rust", "stones.db", "ochre"),
            (OpticalKind::Hapke, "grit", "grit.db", "grit_w"),
            (OpticalKind::Rpv, "dust", "rpv.db", "fine"),
        ]
    );
    let of_name = |factors: &[(String, f64)], name: &str| factors.iter().find(|f| f.0 == name).unwrap().1;
    let rust: Vec<f64> = optical[1].factors.iter().map(|band| of_name(band, "reflectanceFactor")).collect();
    assert_eq!((rust, optical[0].factors.len()), (vec![0.5, 0.75, 1.0], 0));
    // The same for all bands: once for each of them.
    let dust: Vec<f64> =
        optical[3].factors.iter().map(|band| of_name(band, "rhoZero_RPVMultiplicativeFactor")).collect();
    assert_eq!(dust, [0.9; 3]);
    let none = Some(("Lambertian_vegetation.db".into(), "reflect_equal_1_trans_equal_0_0".into()));
    assert_eq!((&optical[0].transmittance, &optical[2].transmittance), (&None, &none));
    assert_eq!(optical[2].at.line, Some(25));
    let temperatures: Vec<(f64, f64)> = thermal.iter().map(|t| (t.mean_k, t.range_k)).collect();
    assert_eq!(temperatures, [(310.5, 4.0), (180.0, 0.0)]);

    let [boulder] = &objects[..] else { panic!("{objects:?}") };
    assert_eq!(boulder.file, "obj\\boulder.obj");
    assert_eq!(boulder.position_m, DVec3::new(4.0, 5.5, 0.25));
    assert_eq!((boulder.scale, boulder.rotation_deg), (DVec3::new(2.0, 1.5, 1.0), DVec3::new(10.0, 20.0, 30.0)));
    assert!(boulder.links.is_none() && !boulder.hidden && !boulder.repeated_on_border && boulder.dem_mode == 2);
    let [top, foot] = &boulder.groups[..] else { panic!() };
    let (front, back) = (foot.links.as_ref().unwrap(), foot.back.as_ref().unwrap());
    assert_eq!((top.number, top.name.as_str(), top.links.as_ref().unwrap().index), (1, "top", 1));
    assert_eq!((front.kind, front.index, front.thermal_index), (2, 0, 0));
    assert_eq!((back.kind, back.index, back.thermal_index, foot.double_face), (0, 0, 1, true));

    let [pebbles] = &fields[..] else { panic!() };
    let placed: Vec<_> = pebbles.objects().collect();
    assert_eq!(placed.len(), 2);
    assert_eq!(placed[1].position_m, DVec3::new(3.0, 2.5, 0.5));
    assert_eq!((placed[1].scale, placed[1].rotation_deg), (DVec3::new(0.2, 0.25, 0.5), DVec3::new(15.0, 5.0, 90.0)));
    assert_eq!(placed[0].links.as_ref().unwrap().thermal_index, 1);

    // Bands in the order of their numbers, not of the file.
    let bands: Vec<(f64, f64, u32)> = phase.bands.iter().map(|b| (b.mean_um, b.width_um, b.mode)).collect();
    assert_eq!(bands, [(0.65, 0.01, 0), (1.9, 0.02, 0), (3.4, 0.05, 1)]);
    assert_eq!(
        (phase.irradiance_mode, &phase.irradiance[..]),
        (1, &[Some((640.5, 0.0)), Some((58.25, 0.0)), Some((5.75, 0.0))][..])
    );
    assert!(phase.radiance_products);
    assert_eq!(directions.views_deg, [[12.5, 270.0]]);
    assert_eq!(sequences[0].name, "flyby");

    let folder = ReadOptions::default().folder(&path);
    let (terrain, _) = dart::terrain(&simulation, &folder).unwrap().unwrap();
    assert_eq!((terrain.rows, terrain.columns, terrain.pixel_m), (4, 3, Some([3.0, 3.0])));
    // Row 2, column 1: the eighth value.
    assert!((terrain.values[2 * 3 + 1] - 0.7).abs() < 1e-15);
}

#[test]
fn a_simulation_of_5_11_is_read_through_its_wrappers() {
    let path = data("dart/crater_511/input");
    let (simulation, report, _) = dart::read(&path, &ReadOptions::default()).unwrap();
    let told: Vec<&str> = report.notes.iter().map(|n| n.message.as_str()).collect();
    assert_eq!(told, ["a camera that is switched off: DART ignores it too"]);
    assert!(!simulation.maket.ground_enabled && simulation.maket.boundary == 1);
    assert_eq!(simulation.optical[1].model, "black");
    let links = simulation.objects[0].groups[0].links.as_ref().unwrap();
    assert_eq!((links.kind, links.index, links.thermal_index), (0, 0, 1));
    assert_eq!(links.thermal_ident, "day");
    assert_eq!(simulation.phase.cameras.len(), 2);
    assert!(!simulation.phase.radiance_products);
    assert_eq!(simulation.directions.sun_deg, [55.0, 250.0]);
    assert!(dart::terrain(&simulation, &ReadOptions::default().folder(&path)).unwrap().is_none());
}

#[test]
fn a_simulation_of_5_4_is_read_though_half_of_it_is_missing() {
    let (simulation, report, _) = dart::read(&data("dart/plain_54"), &ReadOptions::default()).unwrap();
    assert_eq!(simulation.version, Version { version: "5.4.6".into(), build: String::new() });
    let factor = ("reflectanceFactor".to_owned(), 0.8);
    assert_eq!((&*simulation.optical[0].database, &*simulation.optical[0].model), ("2D_sand.txt", ""));
    assert!(simulation.optical[0].factors[0].contains(&factor) && simulation.objects.is_empty());
    assert_eq!((simulation.phase.irradiance_mode, simulation.phase.irradiance.len()), (0, 0));
    assert_eq!(
        (simulation.directions.sun_deg, &simulation.directions.views_deg[..]),
        ([35.5, 15.0], &[[4.25, 200.5]][..])
    );
    let told: Vec<(Fate, &str)> = report.notes.iter().map(|n| (n.fate, n.message.as_str())).collect();
    // object_3d, plots, trees, urban, water, inversion.
    assert!(
        told[..6].iter().all(|(fate, text)| *fate == Fate::Defaulted && text.starts_with("is missing")),
        "{told:#?}"
    );
    let expected = [(Fate::Dropped, "the atmosphere"), (Fate::Approximated, "says no irradiance of bands")];
    assert_eq!(told.len(), 6 + expected.len(), "{told:#?}");
    for (told, expected) in told[6..].iter().zip(expected) {
        assert!(told.0 == expected.0 && told.1.starts_with(expected.1), "{told:?}");
    }
}

#[test]
fn cameras_of_all_versions_look_the_same_way() {
    let (old, ..) = dart::read(&data("dart/boulder_574"), &ReadOptions::default()).unwrap();
    let (new, ..) = dart::read(&data("dart/crater_511"), &ReadOptions::default()).unwrap();
    for (old, new) in old.phase.cameras.iter().zip(&new.phase.cameras) {
        assert_eq!((old.position_m, old.pixels), (new.position_m, new.pixels));
        assert!(near(old.look_deg, new.look_deg, 1e-12), "{old:?} {new:?}");
        assert!(near(old.field_of_view_deg, new.field_of_view_deg, 1e-12), "{old:?} {new:?}");
    }
    // A camera at zenith angle 25, azimuth 200 as seen from the scene looks down along zenith angle 155, azimuth 20.
    assert_eq!(old.phase.cameras[0].look_deg, [155.0, 20.0]);
    // Along (0, 1, -1): 135 deg from the zenith, towards +y. 20 x 10 mm behind 10 mm: 2 atan 1 and 2 atan 0.5.
    assert!(near(old.phase.cameras[1].look_deg, [135.0, 90.0], 1e-12));
    assert!(near(old.phase.cameras[1].field_of_view_deg, [90.0, 53.130_102_354_155_98], 1e-12));
}

#[test]
fn a_camera_of_which_little_is_said() {
    let folder = Folder::copy("bare-camera", "dart/boulder_574");
    let file = "input/phase.xml";
    folder.replace(file, r#"defCameraOrientation="1""#, r#"defCameraOrientation="0""#);
    folder.replace(file, r#"setImageSize="1""#, r#"setImageSize="0""#);
    folder.replace(
        file,
        r#"sensorPosX="-40.0" sensorPosY="-10.0" sensorPosZ="120.0""#,
        r#"sensorPosX="6" sensorPosY="4.5" sensorPosZ="10""#,
    );
    let (simulation, report) = folder.read();
    let camera = &simulation.phase.cameras[0];
    // From 10 m above the middle of 12 x 9 m: columns along y. A pixel for each cell of 0.25 m.
    let angle = |half_m: f64| 2.0 * (half_m / 10.0_f64).atan().to_degrees();
    assert_eq!(camera.look_deg, [180.0, 0.0]);
    assert!(near(camera.field_of_view_deg, [angle(4.5), angle(6.0)], 1e-12), "{camera:?}");
    assert_eq!(camera.pixels, [36, 48]);
    let fates: Vec<Fate> = report.notes.iter().map(|n| n.fate).collect();
    assert_eq!(fates, [Fate::Defaulted; 3], "{report:?}");
}

#[test]
fn the_sun_in_every_way_of_giving_it() {
    let folder = Folder::copy("sun", "dart/boulder_574");
    // Light that travels along zenith angle 125, azimuth 70 comes from 55, 250.
    assert_eq!(folder.read().0.directions.sun_deg, [55.0, 250.0]);
    let sun = r#"<Sun sunZenithAngle="125.0" sunAzimuthAngle="70.0" dayOfTheYear="-1"/>"#;
    let file = "input/directions.xml";
    folder.replace(file, sun, r#"<Sun sunZenithAngle="150" sunAzimuthAngle="225" dayOfTheYear="-1"/>"#);
    let (simulation, report) = folder.read();
    assert_eq!((simulation.directions.sun_deg, report.notes.len()), ([30.0, 45.0], 0));
    let sun = r#"<Sun sunZenithAngle="150" sunAzimuthAngle="225" dayOfTheYear="-1"/>"#;
    folder.replace(
        file,
        sun,
        r#"<SunViewingAngles sunViewingZenithAngle="30" sunViewingAzimuthAngle="-135" dayOfTheYear="12"/>"#,
    );
    folder.replace(file, r#"exactDate="0""#, r#"exactDate="2""#);
    let (simulation, report) = folder.read();
    assert_eq!(simulation.directions.sun_deg, [30.0, 225.0]);
    assert_eq!(report.notes.iter().map(|n| n.fate).collect::<Vec<_>>(), [Fate::Dropped]);
}

#[test]
fn the_sun_by_a_date() {
    let folder = Folder::copy("date", "dart/boulder_574");
    let file = "input/directions.xml";
    folder.replace(file, r#"exactDate="0""#, r#"exactDate="1""#);
    let date = |more: &str| format!(r#"<ExactDateHour {more}/>"#);
    let mut now = r#"<Sun sunZenithAngle="125.0" sunAzimuthAngle="70.0" dayOfTheYear="-1"/>"#.to_owned();
    let mut at = |place: &str, when: &str| {
        let maket = std::fs::read_to_string(folder.0.join("input/maket.xml")).unwrap();
        let from = maket.split("<LatLon ").nth(1).unwrap().split("/>").next().unwrap().to_owned();
        folder.replace("input/maket.xml", &from, place);
        folder.replace(file, &now, &date(when));
        now = date(when);
        folder.read()
    };
    // Equinox of 2024: 20 March, 03:06 UTC. Over the equator, 12 h - (3 h 6 min - 7.4 min) = 9.0 h to the east of Greenwich the
    // Sun is overhead; there and then zenith angle 0.
    let east = 15.0 * (12.0 - (3.0 + 6.0 / 60.0 - 7.4 / 60.0));
    let equinox = r#"year="2024" month="3" day="20" hour="3" minute="6" second="0" localTime="0" timezone="5" daylightSavingTime="1""#;
    let (simulation, report) = at(&format!(r#"latitude="0" longitude="{east}" altitude="0""#), equinox);
    assert!(simulation.directions.sun_deg[0] < 0.05, "{:?}", simulation.directions);
    assert_eq!(report.notes[0].fate, Fate::Approximated);
    // The same moment as local time: zone +5, summer time.
    let local = equinox.replace(r#"hour="3""#, r#"hour="9""#).replace(r#"localTime="0""#, r#"localTime="1""#);
    let again = at(&format!(r#"latitude="0" longitude="{east}" altitude="0""#), &local).0;
    assert_eq!(again.directions.sun_deg, simulation.directions.sun_deg);
    // 45 deg to the west of that place the morning Sun stands 45 deg high in the East, which is azimuth 90.
    let west = at(&format!(r#"latitude="0" longitude="{}" altitude="0""#, east - 45.0), equinox).0;
    assert!(near(west.directions.sun_deg, [45.0, 90.0], 0.05), "{:?}", west.directions);
    // At 40 deg North noon's Sun stands in the South, azimuth 0, 40 deg from the zenith.
    let north = at(&format!(r#"latitude="40" longitude="{east}" altitude="0""#), equinox).0;
    let [zenith, azimuth] = north.directions.sun_deg;
    assert!((zenith - 40.0).abs() < 0.05 && azimuth.min(360.0 - azimuth) < 0.1, "{zenith} {azimuth}");
    // Given angles win.
    let options = ReadOptions { sun_deg: Some([12.0, 34.0]), ..ReadOptions::default() };
    let (simulation, report, _) = dart::read(&folder.0, &options).unwrap();
    assert_eq!((simulation.directions.sun_deg, report.notes.len()), ([12.0, 34.0], 0));
}

#[test]
fn groups_are_numbered_as_dart_does() {
    let order = |names: &[&str], build: &str| {
        let version = Version { version: "5.7.4".into(), build: build.into() };
        groups::order(names, &version).into_iter().map(|i| names[i].to_owned()).collect::<Vec<_>>()
    };
    // "top": 116 x 961 + 111 x 31 + 112 = 115029; 115029 >> 16 is 1; 115029 ^ 1 = 115028 = 16 x 7189 + 4: bucket 4.
    // "foot": ((102 x 31 + 111) x 31 + 111) x 31 + 116 = 3148910; >> 16 is 48; ^ 48 = 3148894 = 16 x 196805 + 14: bucket 14.
    assert_eq!(order(&["foot", "top"], "v1091"), ["top", "foot"]);
    assert_eq!(order(&["foot", "top"], "v1111"), ["foot", "top"]);
    // Capitals come before small letters.
    assert_eq!(order(&["b", "a", "C"], "v1449"), ["C", "a", "b"]);
    // One letter each, up to twelve: the same in both orders.
    let letters = ["l", "k", "j", "i", "h", "g", "f", "e", "d", "c", "b", "a"];
    assert_eq!(order(&letters, "v1083"), order(&letters, "v1449"));
}

#[test]
fn what_is_not_carried_is_told_once_and_at_its_place() {
    let folder = Folder::copy("losses", "dart/boulder_574");
    let plots = r#"<Plot type="1"/><Plot type="0"/><Plot hidden="1"/><ImportationFichierRaster/>"#;
    folder.replace("input/plots.xml", "<ImportationFichierRaster/>", plots);
    folder.replace("input/trees.xml", r#"isTrees="0""#, r#"isTrees="1""#);
    folder.replace("input/phase.xml", r#"TOAtoBOA="0""#, r#"TOAtoBOA="1""#);
    folder.replace(
        "input/phase.xml",
        r#"polarizationProducts="0" radiativeBudgetProducts="0""#,
        r#"polarizationProducts="1" radiativeBudgetProducts="1""#,
    );
    folder.replace(
        "input/phase.xml",
        r#"<SpectralIntervals>"#,
        r#"<SpectralIntervals gap="1">words<Odd a="1"><Odder/></Odd>"#,
    );
    folder.replace("input/phase.xml", r#"Skyl="0.0""#, r#"Skyl="0.25""#);
    std::fs::remove_file(folder.0.join("input/water.xml")).unwrap();
    let (_, report) = folder.read();
    let told: Vec<(Fate, String)> = report
        .notes
        .iter()
        .map(|n| {
            let file = n.at.file.as_ref().unwrap().file_name().unwrap().to_str().unwrap();
            (n.fate, format!("{file}:{} {}", n.at.line.unwrap_or(0), n.message))
        })
        .collect();
    let expected = [
        (Fate::Defaulted, "water.xml:0 is missing"),
        (Fate::Dropped, "phase.xml:4 the atmosphere"),
        (Fate::Dropped, "phase.xml:30 products other than images"),
        (Fate::Dropped, "phase.xml:12 the attribute `gap` of `<Phase/DartInputParameters/SpectralIntervals>`"),
        (Fate::Dropped, "phase.xml:12 text within"),
        (Fate::Dropped, "phase.xml:12 `<Phase/DartInputParameters/SpectralIntervals/Odd>` is not known"),
        (Fate::Dropped, "plots.xml:3 plots (other ground, vegetation, fluids) (in 2 places)"),
        (Fate::Dropped, "trees.xml:3 trees"),
        (Fate::Dropped, "phase.xml:22 diffuse light from the sky"),
    ];
    assert_eq!(told.len(), expected.len(), "{told:#?}");
    for (told, expected) in told.iter().zip(expected) {
        assert!(told.0 == expected.0 && told.1.starts_with(expected.1), "{told:?} {expected:?}");
    }
    assert!(report.has_losses());
}

#[test]
fn a_sequence_becomes_a_flight_table() {
    let path = data("dart/boulder_574");
    let (simulation, ..) = dart::read(&path, &ReadOptions::default()).unwrap();
    let sequence = &simulation.sequences[0];
    // 3 rows of the first group, 2 of the second, which is the faster one.
    let expanded = rows(sequence).unwrap();
    assert_eq!(expanded.len(), 6);
    assert_eq!(expanded[0], ["125.0", "100.0", "1.9"]);
    assert_eq!(expanded[1], ["125.0", "100.0", "2.1"]);
    assert_eq!(expanded[5], ["140.0", "80.0", "2.1"]);
    let (steps, report) = flight(&path, sequence, &ReadOptions::default()).unwrap();
    let sun: Vec<f64> = steps.iter().map(|s| s.sun_deg[0]).collect();
    assert_eq!(sun, [55.0, 55.0, 50.0, 50.0, 40.0, 40.0]);
    let height: Vec<f64> = steps.iter().map(|s| s.cameras[0].position_m.z).collect();
    assert_eq!(height, [100.0, 100.0, 90.0, 90.0, 80.0, 80.0]);
    assert_eq!(steps[0].cameras[1], simulation.phase.cameras[1]);
    let [note] = &report.notes[..] else { panic!("{report:?}") };
    assert!(note.message.contains("meanLambda"));
}

#[test]
fn a_sequence_that_cannot_be_made_is_told_when_it_is_wanted() {
    for (name, message) in [
        ("lengths_differ", "flyby.xml:6:1 DartSequencerDescriptor/DartSequencerDescriptorEntries/"),
        ("too_many", "makes more than 1000000 values"),
    ] {
        let folder = Folder::copy(name, "dart/boulder_574");
        let damaged = data(&format!("malformed/dart/sequence/{name}.xml"));
        std::fs::copy(damaged, folder.0.join("flyby.xml")).unwrap();
        let (simulation, _) = folder.read();
        let error = rows(&simulation.sequences[0]).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
        assert!(flight(&folder.0, &simulation.sequences[0], &ReadOptions::default()).is_err());
        let found = check(&folder.0, &ReadOptions::default(), &no_summary);
        assert!(found.iter().any(|f| f.severity == Severity::Error && f.to_string().contains(message)), "{found:#?}");
    }
}

/// A file below `input/`, what is replaced in it, and by what.
type Replacement<'a> = (&'a str, &'a str, &'a str);

/// A name, a mistake, and what a check says of it: how bad it is, and two parts of the text.
type Case<'a> = (&'a str, &'a [Replacement<'a>], Severity, &'a str, &'a str);

/// The findings of a copy of a simulation with these replacements.
fn findings(name: &str, simulation: &str, replacements: &[Replacement]) -> Vec<Finding> {
    let folder = Folder::copy(name, simulation);
    for (file, from, to) in replacements {
        folder.replace(&format!("input/{file}"), from, to);
    }
    let mut found = check(&folder.0, &ReadOptions::default(), &no_summary);
    // The simulations of these tests hold what is read, and not all that version 5.7.4 wants.
    found.retain(|f| !(f.what.starts_with('`') && f.what.ends_with("` is missing")));
    found
}

#[test]
fn a_simulation_without_a_mistake_passes() {
    assert_eq!(findings("clean", "dart/crater_511", &[]), []);
}

#[test]
fn a_check_finds_what_dart_would_take_in_silence() {
    let object = "object_3d.xml";
    let cases: &[Case] = &[
        (
            "index",
            &[(object, r#"indexFctPhase="0""#, r#"indexFctPhase="5""#)],
            Severity::Error,
            "object_3d.xml:",
            "is not there: the list has 2",
        ),
        (
            "name",
            &[(object, r#"indexFctPhase="0""#, r#"indexFctPhase="1""#)],
            Severity::Error,
            "takes `black`",
            "write index 0",
        ),
        (
            "thermal",
            &[(object, r#"indexTemperature="1""#, r#"indexTemperature="4""#)],
            Severity::Error,
            "temperature 4",
            "write index 1",
        ),
        ("group", &[(object, r#"num="1""#, r#"num="2""#)], Severity::Error, "not 1 to 1", "number them"),
        ("groups", &[("slope.obj", "f 1 3 4", "g more\nf 1 3 4")], Severity::Error, "1 groups", "2 that own faces"),
        (
            "factors",
            &[(
                "coeff_diff.xml",
                r#"useDirectionalDirectTransmittance="0" useMultiplicativeFactorForLUT="0""#,
                r#"useMultiplicativeFactorForLUT="1""#,
            )],
            Severity::Error,
            "there are none",
            "to 0",
        ),
        (
            "irradiance",
            &[("phase.xml", r#"<SpectralIrradianceValue Skyl="0" bandNumber="0" irradiance="0"/>"#, "")],
            Severity::Warning,
            "0 values of irradiance for 1 bands",
            "numbered from 0",
        ),
        (
            "dropped",
            &[(object, r#"objectDEMMode="2""#, r#"objectDEMMode="0""#)],
            Severity::Warning,
            "lowest point is at z = -3 m",
            "to 2",
        ),
        (
            "flipped",
            &[("slope.obj", "f 1 2 3", "f 3 2 1"), ("slope.obj", "f 1 3 4", "f 4 3 1")],
            Severity::Warning,
            "faces downwards",
            "turn the order",
        ),
        (
            "axes",
            &[
                ("slope.obj", "v 0 8 64\nv 48 8 64\nv 48 0 0", "v 64 0 8\nv 64 48 8\nv 0 48 0"),
                (object, r#"xdim="64.0" ydim="48.0" zdim="8.0""#, r#"xdim="64" ydim="48" zdim="8""#),
            ],
            Severity::Warning,
            "those of its own x, y, z",
            "v y z x",
        ),
        (
            "missing",
            &[(object, "slope.obj", "slopes.obj")],
            Severity::Error,
            "not in the input folder",
            "copy the file",
        ),
        (
            "version",
            &[("trees.xml", r#"version="5.11.0""#, r#"version="5.10.6""#)],
            Severity::Warning,
            "is of version 5.10.6",
            "one version",
        ),
        (
            "cells",
            &[("maket.xml", r#"x="64.0""#, r#"x="65.0""#)],
            Severity::Warning,
            "not a multiple",
            "change the extent",
        ),
        (
            "roll",
            &[("phase.xml", r#"orientationAngle="0.0""#, r#"orientationAngle="9.0""#)],
            Severity::Warning,
            "turn of 9 deg",
            "first image",
        ),
        (
            "unreadable",
            &[("maket.xml", r#"x="64.0""#, r#"x="wide""#)],
            Severity::Error,
            "maket.xml:6:",
            "`x` is `wide`",
        ),
    ];
    for (name, replacements, severity, first, second) in cases {
        let found = findings(name, "dart/crater_511", replacements);
        let hit = found.iter().find(|f| f.to_string().contains(first) && f.to_string().contains(second));
        let hit = hit.unwrap_or_else(|| panic!("{name}: {found:#?}"));
        assert_eq!(hit.severity, *severity, "{name}");
        assert!(hit.at.file.is_some(), "{name}");
        assert!(found.len() <= 3, "{name}: {found:#?}");
    }
}

#[test]
fn a_check_knows_factors_transmittance_and_group_orders() {
    let plain = findings("boulder", "dart/boulder_574", &[]);
    let text: Vec<String> = plain.iter().map(Finding::to_string).collect();
    let has = |part: &str| text.iter().any(|t| t.contains(part));
    assert!(has("`rust` is multiplied: reflectanceFactor = 0.5"), "{text:#?}");
    assert!(has("`dust` is multiplied: rhoZero_RPVMultiplicativeFactor = 0.9"), "{text:#?}");
    assert!(has("0 sets of factors for 3 bands"), "{text:#?}");
    assert!(has("have another order from build v1111 on"), "{text:#?}");
    assert!(plain.iter().all(|f| f.severity == Severity::Warning), "{text:#?}");
    // In the later order the first group is `foot`.
    let all = "object_3d.xml";
    let mut later: Vec<Replacement> = ["maket.xml", all, "phase.xml", "coeff_diff.xml", "directions.xml"]
        .map(|file| (file, r#"build="v1083""#, r#"build="v1150""#))
        .to_vec();
    let found = findings("later", "dart/boulder_574", &later);
    let wrong: Vec<String> = found.iter().filter(|f| f.severity == Severity::Error).map(Finding::to_string).collect();
    assert_eq!(wrong.len(), 2, "{wrong:#?}");
    assert!(wrong[0].contains("the group `top` has number 1, which is `foot`") && wrong[0].contains(r#"num="2""#));
    // Hapke's default lets light through, unless factors of 0 stop it.
    later.clear();
    let clear = (
        "coeff_diff.xml",
        "trans_equal_0_0\" useMultiplicativeFactorForLUT=\"0",
        "trans_equal_1_1\" useMultiplicativeFactorForLUT=\"0",
    );
    let found = findings("clear", "dart/boulder_574", &[clear]);
    let hit = found.iter().find(|f| f.what.contains("`grit` takes its transmittance from")).unwrap();
    assert_eq!(hit.severity, Severity::Error);
    // Inside out: every facet of the tetrahedron turned round, one face only.
    let turned = [
        ("obj/boulder.obj", "f 1 4 2", "f 2 4 1"),
        ("obj/boulder.obj", "f 1 3 4", "f 4 3 1"),
        ("obj/boulder.obj", "f 1 2 3", "f 3 2 1"),
        ("obj/boulder.obj", "f 2 4 3", "f 3 4 2"),
    ];
    let found = findings("inside-out", "dart/boulder_574", &turned);
    assert!(found.iter().any(|f| f.severity == Severity::Error && f.what.contains("inside out")), "{found:#?}");
}

#[test]
fn a_check_asks_databases_what_they_cover() {
    let folder = Folder::copy("coverage", "dart/boulder_574");
    std::fs::write(folder.0.join("input/stones.db"), "").unwrap();
    let coverage = |path: &Path, table: &str| {
        assert!(path.ends_with("stones.db"));
        let largest = if table == "basalt" { 0.31 } else { 31.0 };
        Some(TableSummary { range_um: (0.4, 2.5), shares: vec![[largest / 100.0, 0.0, 0.0]] })
    };
    let found = check(&folder.0, &ReadOptions::default(), &coverage);
    let of = |part: &str| found.iter().filter(|f| f.what.contains(part)).collect::<Vec<_>>();
    // The band at 3.4 um, for both tables of that database; one of them looks like fractions.
    assert_eq!(of("bands 2 reach beyond it").len(), 2, "{found:#?}");
    assert_eq!(of("look like fractions").len(), 1, "{found:#?}");
}

/// Every damaged file is read in place of the good one, and refused at the place that `expected.txt` names; or it is read,
/// with as many notes as that file says, where versions of DART are known to differ.
#[test]
fn damaged_inputs_are_refused_at_their_place() {
    let corpus = data("malformed/dart");
    let expected = std::fs::read_to_string(corpus.join("expected.txt")).unwrap();
    let expected: Vec<(&str, &str)> = expected.lines().filter_map(|line| line.split_once(" -> ")).collect();
    let mut files = Vec::new();
    for kind in std::fs::read_dir(&corpus).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()) {
        for file in std::fs::read_dir(&kind).unwrap().map(|e| e.unwrap().path()) {
            files.push(file.strip_prefix(&corpus).unwrap().to_str().unwrap().to_owned());
        }
    }
    files.sort();
    assert!(files.len() >= 100 && files.len() == expected.len(), "{} files, {} expected", files.len(), expected.len());
    let mut wrong = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let folder = Folder::copy(&format!("malformed-{i}"), "dart/boulder_574");
        let (kind, name) = file.split_once('/').unwrap();
        let target = match kind {
            "field" => "input/pebbles.txt".to_owned(),
            "sequence" => "flyby.xml".to_owned(),
            "ilwis" => format!("input/DEM.{}", name.rsplit('.').next().unwrap()),
            input => format!("input/{input}.xml"),
        };
        std::fs::copy(corpus.join(file), folder.0.join(target)).unwrap();
        let outcome = dart::read(&folder.0, &ReadOptions::default()).and_then(|(simulation, report, _)| {
            dart::terrain(&simulation, &ReadOptions::default().folder(&folder.0))?;
            Ok(report)
        });
        let told = match &outcome {
            Ok(report) => format!("read, {} notes", report.notes.len()),
            Err(Error::Syntax { .. } | Error::Invalid(_) | Error::Unsupported { .. }) => {
                let text = outcome.as_ref().unwrap_err().to_string();
                let first = text.lines().next().unwrap().to_owned();
                first.replace(&format!("{}/", folder.0.display()), "")
            }
            Err(other) => panic!("{file}: {other}"),
        };
        // What a check says of it is an error too, and never a panic.
        let found = check(&folder.0, &ReadOptions::default(), &no_summary);
        let is_wrong = matches!(outcome, Err(Error::Syntax { .. } | Error::Invalid(_)));
        assert!(!is_wrong || found.iter().any(|f| f.severity == Severity::Error), "{file}");
        match expected.iter().find(|(name, _)| name == file) {
            Some((_, start)) if told.starts_with(start) => {}
            _ => wrong.push(format!("{file} -> {told}")),
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), files.len(), wrong.join("\n"));
}

#[test]
fn a_raster_without_a_header_is_refused() {
    let folder = Folder::copy("headerless", "dart/boulder_574");
    std::fs::remove_file(folder.0.join("input/DEM.mpr")).unwrap();
    let error = ilwis::read(&folder.0.join("input/DEM.mp#")).unwrap_err().to_string();
    assert!(error.contains("has no header beside it"), "{error}");
}

#[test]
fn what_a_newer_dart_may_add_is_told() {
    let folder = Folder::copy("newer", "dart/crater_511");
    let known = folder.read().1.notes.len();
    folder.replace("input/phase.xml", r#"sensorName="down""#, r#"sensorName="down" shake="2""#);
    folder.replace(
        "input/phase.xml",
        r#"sensorDisabled="0" sensorName="level""#,
        r#"sensorDisabled="1" sensorName="level""#,
    );
    folder.replace("input/phase.xml", "<SensorImageSimulation ", "<DartInputParameters/><SensorImageSimulation ");
    folder.replace("input/maket.xml", r#"linkEarthScene="""#, r#"linkEarthScene="earth.xml""#);
    folder.replace("input/maket.xml", "</Maket>", "</Maket><Second/>");
    let (simulation, report) = folder.read();
    assert_eq!(simulation.phase.cameras.len(), 1);
    let told: Vec<&str> = report.notes.iter().map(|n| n.message.as_str()).collect();
    for expected in [
        "the attribute `shake` of `<Phase/SensorImageSimulation/Sensor>` is not known",
        "a camera that is switched off: DART ignores it too",
        "another `<Phase/DartInputParameters>`: the first is read",
        "the attribute `linkEarthScene` of `<Maket>` is not known",
        "`<Second>` is not known here",
    ] {
        assert!(told.contains(&expected), "{expected}: {told:#?}");
    }
    assert_eq!(told.len(), known + 5, "{told:#?}");
}

#[test]
fn an_object_scaled_to_nothing_is_refused() {
    let folder = Folder::copy("scaled", "dart/boulder_574");
    folder.replace("input/object_3d.xml", r#"xscale="2.0""#, r#"xscale="0.0""#);
    let error = dart::read(&folder.0, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("object_3d.xml:") && error.contains("a scale of 0"), "{error}");
}

#[test]
fn a_field_of_more_than_any_memory_holds_is_refused() {
    let folder = Folder::copy("large-field", "dart/boulder_574");
    let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\ng top\n{}g foot\nf 1 2 3\n", "f 1 2 3\n".repeat(5000));
    std::fs::write(folder.0.join("input/obj/boulder.obj"), obj).unwrap();
    std::fs::write(folder.0.join("input/pebbles.txt"), "0 1 1\n".repeat(30_000)).unwrap();
    let options = ReadOptions::default();
    let (simulation, _, _) = dart::read(&folder.0, &options).unwrap();
    let outcome = dart::to_scene(&simulation, &options.folder(&folder.0), &dart::SceneOptions::default(), &unwatched);
    let error = outcome.unwrap_err().to_string();
    assert!(error.contains("object_3d.xml:55:"), "{error}");
    assert!(error.contains("with \"pebble\" there are more than 134217728 vertices or facets"), "{error}");
}

#[test]
fn a_field_of_many_comments_is_read_in_one_pass() {
    let folder = Folder::copy("comments", "dart/boulder_574");
    let text = format!("{}0 1 / 1\n{}", "// said\n".repeat(1_000_000), "0 1 nowhere\n".repeat(100_000));
    std::fs::write(folder.0.join("input/pebbles.txt"), text).unwrap();
    let error = dart::read(&folder.0, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("pebbles.txt:1000001:1: a line of `index x y` belongs here"), "{error}");
    assert!(error.ends_with("and 99981 more problems"), "{error}");
}

#[test]
fn factors_that_one_element_gives_for_all_bands_are_bounded() {
    let folder = Folder::copy("factors", "dart/boulder_574");
    let edit = |name: &str, from: &str, to: &str, count: usize| {
        let path = folder.0.join("input").join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let (start, end) = (text.find(from).unwrap(), text.find(to).unwrap());
        let (before, repeated, after) = (&text[..start], text[start..end].repeat(count), &text[end..]);
        std::fs::write(path, format!("{before}{repeated}{after}")).unwrap();
    };
    edit("coeff_diff.xml", "<RPVMulti ", "</RPVMultiFunctions>", 300);
    let phase = folder.0.join("input/phase.xml");
    let unnumbered = std::fs::read_to_string(&phase)
        .unwrap()
        .replace("SpectralIntervalsProperties bandNumber=", "SpectralIntervalsProperties was=");
    std::fs::write(&phase, unnumbered).unwrap();
    edit("phase.xml", "<SpectralIntervalsProperties ", "</SpectralIntervals>", 1200);
    let error = dart::read(&folder.0, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("coeff_diff.xml:"), "{error}");
    assert!(error.contains("with this property there are factors for more than 1048576 bands in all"), "{error}");
}
