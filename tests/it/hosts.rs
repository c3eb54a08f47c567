//! The library as a host uses it, without the command line: what it writes, how it is watched, and what can be kept.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use mmxrt::formats::Subject;
use mmxrt::formats::product_folder::{ProductFolder, ProductOptions};
use mmxrt::formats::radiance_map::summands;
use mmxrt::formats::report_json::{FORMAT_VERSION, Run};
use mmxrt::job::{self, Radiance};
use mmxrt::progress::{Gauge, Progress, unwatched};
use mmxrt::study::Request;
use mmxrt::{Error, landscape};

use crate::cli::run as command;
use crate::scenes::SITE;
use crate::scratch::Scratch;

#[allow(dead_code)]
#[path = "../../examples/8_write_a_product.rs"]
mod example;

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = folder.read_dir().unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    names.map(|name| (name.clone(), std::fs::read(folder.join(name)).unwrap())).collect()
}

/// Says that two folders hold the same files, and those the same bytes, but `run.json`.
fn assert_same(one: &Path, other: &Path, count: usize) {
    let [one, other] = [one, other].map(files);
    assert_eq!((one.len(), one.keys().collect::<Vec<_>>()), (count, other.keys().collect()));
    for (name, bytes) in one.iter().filter(|(name, _)| *name != "run.json") {
        assert!(!bytes.is_empty() && other[name] == *bytes, "{name} differs");
    }
}

fn run() -> Run {
    Run {
        format_version: FORMAT_VERSION,
        mmxrt: String::new(),
        command: "test".into(),
        date: "2026-11-22T00:00:00Z".into(),
        threads: 1,
        host_cores: 1,
        wall_s: 0.0,
        cpu_s: None,
        stages: vec![],
        costs: vec![],
        files: std::collections::BTreeMap::new(),
    }
}

#[test]
fn the_library_alone_writes_what_the_command_writes() {
    let scratch = Scratch::new();
    let scene = scratch.write("scene.toml", SITE);
    let arguments = ["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("command"), "--quiet"];
    let (code, _, err) = command(&[&arguments[..], &["--exr", "--footprints", "--table", "--split"]].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    let options = ProductOptions { exr: true, footprints: true, table: true, split: true, ..ProductOptions::default() };
    let subject = Subject::open(&scene, &unwatched).unwrap();
    let written = example::write_product(subject, &scratch.join("library"), options, &Gauge::default()).unwrap();
    assert_same(&scratch.join("command"), &scratch.join("library"), 13);
    assert_eq!(written.report.image.samples, 16);

    // And by maps that add up with a table.
    let facets = written.product.subject.scene.body.mesh.facets.len();
    let map =
        format!("facet,radiance_w_m2_sr_um at 1 um\n{}", (0..facets).map(|f| format!("{f},2\n")).collect::<String>());
    scratch.write("map.csv", map);
    let sum = format!("{}*0.5+{}", scratch.argument("map.csv"), scratch.argument("library/table.npz"));
    let out = scratch.argument("command_maps");
    let (code, _, err) = command(&["integrate", arguments[1], "--radiance", &sum, "-o", &out, "--quiet"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let folder = ProductFolder::stage(&scratch.join("library_maps"), false, ProductOptions::default()).unwrap();
    let radiance = Radiance { maps: vec![summands(&sum).unwrap()], ..Radiance::default() };
    let subject = Subject::open(&scene, &unwatched).unwrap();
    let summed = job::integrate(subject, &radiance, folder, run, &unwatched).unwrap();
    assert_same(&scratch.join("command_maps"), &scratch.join("library_maps"), 8);
    // Half of 2 beside what the scene sends itself.
    let [alone, summed] = [&written, &summed].map(|w| w.report.statistics[0].mean.unwrap());
    assert!((summed - alone - 1.0).abs() < 1e-9, "{summed} {alone}");
}

#[test]
fn what_maps_send_has_no_facet_table_and_no_thermal_part() {
    let scratch = Scratch::new();
    let scene = scratch.write("scene.toml", SITE);
    let subject = Subject::open(&scene, &unwatched).unwrap();
    let options = ProductOptions { split: true, ..ProductOptions::default() };
    let folder = ProductFolder::stage(&scratch.join("out"), false, options).unwrap();
    assert!(folder.admit(&subject, [], false).is_ok());
    let error = folder.admit(&subject, [], true).unwrap_err().to_string();
    assert!(error.contains("belongs to what maps send"), "{error}");
    drop(folder);
    assert_eq!(scratch.names(), ["scene.toml"]);
}

#[test]
fn a_host_polls_and_stops() {
    let scratch = Scratch::new();
    let scene = scratch.write("scene.toml", SITE.replace("facets = 1000", "facets = 100000"));
    let gauge = Gauge::default();
    assert_eq!(gauge.progress(), None);
    let (is_stopped, is_over) = (AtomicBool::new(false), AtomicBool::new(false));
    let result = std::thread::scope(|threads| {
        threads.spawn(|| {
            while !is_over.load(Relaxed) && gauge.progress().is_none_or(|progress| progress.stage != "sunlight") {
                std::thread::sleep(Duration::from_micros(100));
            }
            gauge.stop();
            is_stopped.store(true, Relaxed);
        });
        let watch = |progress: Progress| {
            // The work waits where it is to be stopped: a fast machine would be through.
            while progress.stage == "sunlight" && gauge.watch(progress) && !is_stopped.load(Relaxed) {
                std::thread::yield_now();
            }
            gauge.watch(progress)
        };
        let folder = ProductFolder::stage(&scratch.join("out"), false, ProductOptions::default())?;
        let result = Subject::open(&scene, &watch)
            .and_then(|subject| job::simulate(subject, &Request::default(), folder, run, &watch));
        is_over.store(true, Relaxed);
        result.map(drop)
    });
    assert!(matches!(result, Err(Error::Interrupted)), "{result:?}");
    assert_eq!(gauge.progress().unwrap().stage, "sunlight");
    assert_eq!(scratch.names(), ["scene.toml"]);

    // Once stopped, it stops all that is given to.
    let recipe = landscape::Recipe::new(7);
    assert!(matches!(
        landscape::generate(&recipe, &landscape::Sources::default(), &|p| gauge.watch(p)),
        Err(Error::Interrupted)
    ));
}

#[test]
fn what_a_host_keeps_borrows_nothing_and_may_change_threads() {
    fn is_kept<T: Send + 'static>() {}
    is_kept::<mmxrt::scene::Scene>();
    is_kept::<mmxrt::product::FacetTable>();
    is_kept::<mmxrt::product::Cube>();
    is_kept::<mmxrt::product::RadianceMap>();
    is_kept::<mmxrt::study::Observation>();
    is_kept::<mmxrt::study::MapAccount>();
    is_kept::<mmxrt::study::DryRun>();
    is_kept::<mmxrt::integrate::Image>();
    is_kept::<mmxrt::formats::product_folder::ProductFolder>();
    is_kept::<mmxrt::formats::product_folder::Written>();
    is_kept::<mmxrt::formats::radiance_map::Sum>();
    is_kept::<mmxrt::formats::raster::Raster>();
    is_kept::<mmxrt::formats::scene_toml::SceneFile>();
    is_kept::<mmxrt::formats::dart::output::Output>();
    is_kept::<Subject>();
    is_kept::<Radiance>();
    is_kept::<job::Outlook>();
    fn is_shared<T: Sync>() {}
    is_shared::<Gauge>();
    is_shared::<Subject>();
}
