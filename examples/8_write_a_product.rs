//! A product folder without the command: `cargo run --profile quick --example 8_write_a_product`.
//!
//! What `mmxrt simulate` writes, a program or a module of another language writes by the same call, and from the second exposure on it
//! reads nothing again. The work runs in a thread; whoever waits asks how far it is, and may stop it.

#![allow(clippy::print_stdout)]

use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

use mmxrt::formats::Subject;
use mmxrt::formats::product_folder::{ProductFolder, ProductOptions, Written};
use mmxrt::formats::report_json::{FORMAT_VERSION, Run, rfc3339};
use mmxrt::job;
use mmxrt::progress::Gauge;
use mmxrt::study::Request;
use mmxrt::{Error, Result};

fn main() -> Result<()> {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/phobos_site/scene.toml");
    let top = std::env::temp_dir().join(format!("mmxrt_example_{}", std::process::id()));
    let gauge = Gauge::default();

    let subject = Subject::open(&scene, &|progress| gauge.watch(progress))?;
    let written = write_product(subject.clone(), &top.join("as_it_is"), ProductOptions::default(), &gauge)?;
    let mean = |written: &Written| written.report.statistics.iter().find_map(|s| s.mean).unwrap_or_default();
    println!("as it is: {:.6} W m-2 sr-1 um-1 in the first band", mean(&written));

    // Another exposure of the same body, which is shared: a narrower view.
    let mut exposure = subject.scene.exposure.clone();
    exposure.camera.pitch.iter_mut().for_each(|pitch| *pitch /= 4.0);
    let narrow = Subject { scene: subject.scene.seen_by(exposure)?, id: format!("{}, narrow", subject.id), ..subject };
    let written = std::thread::scope(|threads| {
        let work = threads.spawn(|| write_product(narrow, &top.join("narrow"), ProductOptions::default(), &gauge));
        while !work.is_finished() {
            // Here a host would draw a bar, and call `gauge.stop()` if its user has enough.
            std::thread::sleep(Duration::from_millis(20));
        }
        work.join().expect("nothing in the library panics")
    })?;
    println!("a quarter of the view: {:.6}; last stage: {:?}", mean(&written), gauge.progress().map(|p| p.stage));
    std::fs::remove_dir_all(&top).map_err(|e| Error::io(&top, "removing", e))
}

/// Simulates a scene and writes its product folder, byte for byte as the command does.
pub(crate) fn write_product(
    subject: Subject,
    target: &Path,
    options: ProductOptions,
    gauge: &Gauge,
) -> Result<Written> {
    let (date, began) = (SystemTime::now(), Instant::now());
    let folder = ProductFolder::stage(target, false, options)?;
    // The library reads no clock: what `run.json` says is known here.
    let run = || Run {
        format_version: FORMAT_VERSION,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        command: "example".to_owned(),
        date: rfc3339(date),
        threads: rayon::current_num_threads() as u64,
        host_cores: std::thread::available_parallelism().map_or(1, |n| n.get() as u64),
        wall_s: began.elapsed().as_secs_f64(),
        cpu_s: None,
        stages: vec![],
        costs: vec![],
        files: std::collections::BTreeMap::new(),
    };
    job::simulate(subject, &Request::default(), folder, run, &|progress| gauge.watch(progress))
}
