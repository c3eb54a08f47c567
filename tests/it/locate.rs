//! Where pixels look, and where points lie: there and back over whole images, of every kind of sensor.

use std::sync::Mutex;

use glam::DVec3;
use mmxrt::flight::{Jitter, Pointing, Scan};
use mmxrt::formats::points_csv::{Asked, Found, Question};
use mmxrt::formats::{Reading, Subject, scene_toml};
use mmxrt::geometry::Mesh;
use mmxrt::progress::{Progress, unwatched};
use mmxrt::scene::{Readout, Timing};
use mmxrt::study::locate::{Locator, Place};
use mmxrt::{Error, job};

use crate::cli::run;
use crate::motion::{HEIGHT_M, ORIGIN_M, down, moving_scene, steady};
use crate::scenes::{SQUARE, SQUARE_OBJ};
use crate::scratch::Scratch;
use crate::shapes::{Random, grid, joined, plane, quad};

const KINDS: [Readout; 3] = [Readout::Frame, Readout::Band, Readout::Line];

fn relief() -> Mesh {
    grid(900.0, 60, |x, y| 15.0 * (0.02 * x).sin() * (0.03 * y).cos())
}

fn timing(readout: Readout) -> Timing {
    Timing { readout, period_s: if readout == Readout::Frame { 0.0 } else { 1.7 }, exposure_s: 1.0, poses: 1 }
}

/// A camera that drifts, scans and shakes: there and back is the same place, to 1e-6 of a pixel, at the image's ends as in its middle.
#[test]
fn there_and_back_is_the_same_place() {
    let jitter = Jitter { seed: 3, rms_rad: DVec3::new(2e-5, 2e-5, 1e-5), band_hz: [0.01, 0.05] };
    let scan = Scan { axis: DVec3::X, start_rad: 0.002, rate_rad_s: -1e-4 };
    for readout in KINDS {
        let timing = timing(readout);
        let law = Pointing { scan: Some(scan), jitter: Some(jitter), ..down() };
        let motion = steady(DVec3::new(0.4, -4.0, 0.1), 20.0, DVec3::new(1.0, 0.0, 2.0), law);
        let scene = moving_scene(relief(), [40, 24], 10.0, &[1.0, 2.0, 3.0], &motion, timing);
        let locator = Locator::new(&scene, Some((&motion, timing)));
        let mut random = Random(11);
        let mut count = 0;
        let ends = [(0.0, 0.0), (40.0, 24.0), (0.5, 23.5), (39.5, 0.5), (20.0, 12.0), (7.0, 0.0), (33.0, 24.0)];
        let others = (0..200).map(|_| (40.0 * random.share(), 24.0 * random.share()));
        for (sample, line) in ends.into_iter().chain(others.collect::<Vec<_>>()) {
            for band in [0, 2] {
                let place = Place { sample, line };
                let Some(ground) = locator.ground(place, band).unwrap() else { continue };
                let seen =
                    locator.place(ground.point_m, band).unwrap().unwrap_or_else(|| panic!("{readout:?} {place:?}"));
                let off = (seen.place.sample - sample).abs().max((seen.place.line - line).abs());
                assert!(off < 1e-6, "{readout:?} {place:?}: {:?}", seen.place);
                assert_eq!((seen.hidden_by, seen.epoch), (None, seen.epoch));
                assert!((seen.range_m - ground.range_m).abs() < 1e-6);
                count += 1;
            }
        }
        assert!(count > 380, "{readout:?}: {count}");
    }
}

/// On flat ground below a steady camera the answer is by hand.
#[test]
fn on_flat_ground_it_is_arithmetic() {
    let timing = timing(Readout::Line);
    let velocity = DVec3::new(0.0, -5.0, 0.0);
    let motion = steady(velocity, 10.0, DVec3::Z, down());
    let scene = moving_scene(plane(2000.0, 0.0), [40, 24], 10.0, &[1.0], &motion, timing);
    let locator = Locator::new(&scene, Some((&motion, timing)));
    for (sample, line) in [(0.0, 0.5), (12.25, 7.75), (40.0, 23.0)] {
        let ground = locator.ground(Place { sample, line }, 0).unwrap().unwrap();
        let t_s = 0.5 + (line - 0.5) * 1.7;
        let expected = ORIGIN_M + DVec3::new((sample - 20.0) * 10.0, -5.0 * (t_s - 10.0), 0.0);
        assert!((ground.point_m - expected).length() < 1e-8, "{:?} {expected:?}", ground.point_m);
        assert!((ground.local_emission_rad - ((sample - 20.0) * 10.0 / HEIGHT_M).abs().atan()).abs() < 1e-12);
    }
}

#[test]
fn what_is_hidden_or_outside_is_said() {
    let timing = timing(Readout::Frame);
    let motion = steady(DVec3::ZERO, 0.0, DVec3::Z, down());
    // A roof over the origin, facets 2 and 3.
    let roof = quad([-20.0, -20.0, 50.0], [20.0, -20.0, 50.0], [20.0, 20.0, 50.0], [-20.0, 20.0, 50.0]);
    let scene = moving_scene(joined(&[plane(900.0, 0.0), roof]), [40, 24], 10.0, &[1.0], &motion, timing);
    let locator = Locator::new(&scene, Some((&motion, timing)));
    let hidden = locator.place(ORIGIN_M, 0).unwrap().unwrap();
    assert!(hidden.inside && matches!(hidden.hidden_by, Some(2 | 3)), "{hidden:?}");
    let beside = locator.place(ORIGIN_M + DVec3::new(500.0, 0.0, 0.0), 0).unwrap().unwrap();
    assert!(!beside.inside && beside.hidden_by.is_none() && (beside.place.sample - 70.0).abs() < 1e-9, "{beside:?}");
    assert_eq!(locator.place(ORIGIN_M + DVec3::Z * 3e4, 0).unwrap(), None, "behind the camera");
    assert!(locator.ground(Place { sample: 1.0, line: 1.0 }, 1).unwrap_err().to_string().contains("band 2"));
}

/// Of the shipped kind of scene: answers as a table, from the command line.
#[test]
fn the_command_answers_as_a_table() {
    let scratch = Scratch::new();
    let flying = crate::scenes::SITE;
    scratch.write("scene.toml", flying);
    let scene = scratch.argument("scene.toml");
    let (code, out, err) = run(&["locate", &scene, "--pixel", "4,4"]);
    assert_eq!(code, 0, "{err}");
    let row: Vec<&str> = out.lines().nth(1).unwrap().split(',').collect();
    let point = format!("{},{},{}", row[4], row[5], row[6]);
    let (code, out, err) = run(&["locate", &scene, "--ground", &point]);
    assert_eq!(code, 0, "{err}");
    let row: Vec<&str> = out.lines().nth(1).unwrap().split(',').collect();
    let near = |text: &str| (text.parse::<f64>().unwrap() - 4.0).abs() < 1e-6;
    assert!(near(row[0]) && near(row[1]), "{out}");
    scratch.write("points.csv", "sample,line\n1,2\n3,x\n4\n");
    let (code, _, err) = run(&["locate", &scene, "--points", &scratch.argument("points.csv")]);
    assert!(code == 1 && err.contains("points.csv:3") && err.contains("points.csv:4"), "{err}");
    scratch.write("points.csv", "a,b\n1,2\n");
    let (code, _, err) = run(&["locate", &scene, "--points", &scratch.argument("points.csv")]);
    assert!(code == 1 && err.contains("sample, line"), "{err}");
    let (code, _, err) = run(&["locate", &scene]);
    assert!(code == 2 && err.contains("--pixel"), "{err}");
}

/// Any number of questions is answered in order, with progress, and nobody waits for the rest who asks to stop.
#[test]
fn questions_are_answered_in_order_until_one_stops() {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    let subject = Subject::from(scene_toml::read(&scratch.write("scene.toml", SQUARE), &unwatched).unwrap());
    let reading = Reading::default();
    let camera = &subject.scene.exposure.camera;
    let [samples, lines] = [camera.samples, camera.lines].map(f64::from);
    for count in [0, 1, 255, 256, 257, 1000] {
        let mut random = Random(count + 1);
        let places: Vec<Place> =
            (0..count).map(|_| Place { sample: samples * random.share(), line: lines * random.share() }).collect();
        let pixel = |place: &Place| Question { asked: Asked::Pixel(*place), band: None };
        let told = Mutex::new(Vec::new());
        let watch = |now: Progress| {
            if now.stage == "answers" {
                told.lock().unwrap().push((now.done, now.total));
            }
            true
        };
        let found = job::answers(&subject, &reading, &places.iter().map(pixel).collect::<Vec<_>>(), &watch).unwrap();
        assert_eq!(found.len(), places.len());
        let told = told.into_inner().unwrap();
        assert!(told.is_sorted() && told[0] == (0, count) && told.last() == Some(&(count, count)), "{told:?}");
        let points = found.iter().zip(&places).filter_map(|((_, found), place)| match found {
            Found::Ground(ground) => Some((ground.as_ref()?.point_m, *place)),
            Found::Place(_) => None,
        });
        let points: Vec<(DVec3, Place)> = points.collect();
        assert!(points.len() * 2 >= places.len());
        let asked: Vec<Question> =
            points.iter().map(|(point_m, _)| Question { asked: Asked::Ground(*point_m), band: Some(0) }).collect();
        for ((band, found), (_, place)) in
            job::answers(&subject, &reading, &asked, &unwatched).unwrap().iter().zip(&points)
        {
            let Found::Place(Some(seen)) = found else { panic!("{found:?}") };
            let off = (seen.place.sample - place.sample).abs().max((seen.place.line - place.line).abs());
            assert!(*band == 0 && off < 1e-6, "{seen:?} {place:?}");
        }
        let stop = |now: Progress| now.stage != "answers" || now.done < 256;
        let stopped = job::answers(&subject, &reading, &places.iter().map(pixel).collect::<Vec<_>>(), &stop);
        assert_eq!(matches!(stopped, Err(Error::Interrupted)), count >= 256, "{count}");
    }
}

/// A slit that trembles crosses a point several times: where it does so in the image, that is where the point is.
#[test]
fn a_point_in_the_image_is_found_there_though_the_slit_trembles() {
    let timing = timing(Readout::Line);
    let jitter = Jitter { seed: 5, rms_rad: DVec3::new(2e-4, 0.0, 0.0), band_hz: [0.01, 2.0] };
    let motion = steady(DVec3::new(0.0, -5.0, 0.0), 10.0, DVec3::Z, Pointing { jitter: Some(jitter), ..down() });
    let scene = moving_scene(plane(2000.0, 0.0), [40, 24], 10.0, &[1.0], &motion, timing);
    let locator = Locator::new(&scene, Some((&motion, timing)));
    let (mut several, mut missed) = (0, 0);
    for i in 0..240 {
        let place = Place { sample: 20.0, line: 0.05 + 0.1 * f64::from(i) };
        let ground = locator.ground(place, 0).unwrap().unwrap();
        let found = locator.place(ground.point_m, 0).unwrap().unwrap();
        // Where the slit turns round just there, it may cross the point twice between two looks.
        missed += usize::from(!found.inside);
        if !found.inside {
            continue;
        }
        // It may be another moment, but shows the same.
        let again = locator.ground(found.place, 0).unwrap().unwrap();
        assert!((again.point_m - ground.point_m).length() < 1e-5, "{place:?}: {found:?}");
        several += usize::from((found.place.line - place.line).abs() > 0.01);
    }
    assert!(several > 10 && missed <= 2, "{several} {missed}");
}

/// Nothing that the scene is read from is written over.
#[test]
fn answers_spare_all_that_the_scene_names() {
    let scratch = Scratch::new();
    scratch.write("ground.obj", "mtllib ground.mtl\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl grey\nf 1 2 3 4\n");
    scratch.write("ground.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n");
    scratch.write("blue.csv", "wavelength_um,reflectance\n0.5,0.1\n2,0.1\n");
    scratch.write(
        "scene.toml",
        "mmxrt_scene = 1\norigin_m = [12000.0, 0.0, 0.0]\n[[mesh]]\nfile = \"ground.obj\"\npose = \"radial\"\n[materials]\n\
         grey = { reflectance = \"blue.csv\" }\n[sun]\ndirection = [0.6, 0.8, 0.0]\ndistance_au = 1.5\n[thermal]\nmodel = \"off\"\n[observer]\n\
         position_m = [13000.0, 0.0, 0.0]\ntarget_m = [12000.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]\n\
         [sensor]\nsamples = 4\nlines = 4\nifov_mrad = 1.0\nbands = { centres_um = [1.0] }\n",
    );
    let scene = scratch.argument("scene.toml");
    for name in ["scene.toml", "ground.obj", "ground.mtl", "blue.csv"] {
        let before = std::fs::read(scratch.join(name)).unwrap();
        let (code, _, err) =
            run(&["locate", &scene, "--pixel", "2,2", "-o", &scratch.argument(name), "--force", "--quiet"]);
        assert!(code == 1 && err.contains("is read for it"), "{name}: {err}");
        assert!(std::fs::read(scratch.join(name)).unwrap() == before, "{name}");
    }
    let answers = scratch.argument("answers.csv");
    assert_eq!(run(&["locate", &scene, "--pixel", "2,2", "-o", &answers, "--quiet"]).0, 0);
}
