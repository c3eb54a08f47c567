//! Drawings of orbits and attitudes: what is drawn is what the files say.

use std::path::Path;

use mmxrt::formats::quicklook;
use mmxrt::formats::track_picture::TrackSheet;
use mmxrt::job::flight_sheet;

use crate::cli::run;
use crate::scratch::Scratch;

fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/flight").join(name).display().to_string()
}

fn values(sheet: &TrackSheet, quantity: usize) -> Vec<[f64; 2]> {
    sheet.tracks[0].series[quantity].concat()
}

/// A circle of 40 km at 2e-4 rad/s about a body of 13.0 x 11.4 x 9.1 km, 35 minutes of which are missing.
#[test]
fn an_orbit_is_drawn_with_its_gap() {
    let sheet = flight_sheet(Path::new(&data("circle.oem"))).unwrap();
    assert_eq!(sheet.tracks.len(), 1);
    assert_eq!(sheet.tracks[0].series[0].len(), 2, "two spans");
    let heights = values(&sheet, 0);
    assert!(heights.len() > 1000 && heights.iter().all(|[_, km]| (40.0 - 13.01..40.0 - 9.09).contains(km)));
    let longest = heights.windows(2).map(|two| two[1][0] - two[0][0]).fold(0.0, f64::max);
    assert!((longest - 35.0 / 60.0).abs() < 1e-9, "the gap: {longest} h");
    // The Sun stands still: the phase angle changes by no more than the way along the circle.
    let phases = values(&sheet, 1);
    let most = 2e-4_f64.to_degrees() * 3600.0;
    assert!(phases.len() == heights.len());
    for two in phases.windows(2) {
        let rate = (two[1][1] - two[0][1]).abs() / (two[1][0] - two[0][0]).max(1e-12);
        assert!((0.0..=180.0).contains(&two[0][1]) && rate < 1.01 * most, "{two:?}");
    }
    // Latitudes of a circle; the ground track moves against the turning body.
    assert!(sheet.tracks[0].map.concat().iter().all(|[lon, lat]| (0.0..=360.0).contains(lon) && lat.abs() <= 90.0));
    assert!(sheet.map_labels[0].contains("longitude"));
}

#[test]
fn an_attitude_is_drawn_with_its_rate() {
    let sheet = flight_sheet(Path::new(&data("turn.aem"))).unwrap();
    let angles = values(&sheet, 0);
    // 0.6 deg/s for 300 s; between rows 12 deg apart a rate may be off by the square of half of that, 1 %.
    assert!(angles[0][1].abs() < 1e-6 && (angles.last().unwrap()[1] - 180.0).abs() < 1e-4, "{:?}", angles.last());
    let rates = values(&sheet, 1);
    assert!(rates.len() >= 600 && rates.iter().all(|[_, rate]| (rate - 0.6).abs() < 0.01), "{rates:?}");
}

#[test]
fn the_command_draws_both() {
    let scratch = Scratch::new();
    for file in ["circle.oem", "turn.aem"] {
        let (svg, png) = (scratch.argument(&format!("{file}.svg")), scratch.argument(&format!("{file}.png")));
        for target in [&svg, &png] {
            let (code, _, err) = run(&["inspect", &data(file), "--picture", target]);
            assert_eq!(code, 0, "{err}");
            assert_eq!(run(&["inspect", &data(file), "--picture", target]).0, 1, "replaced");
        }
        let text = std::fs::read_to_string(&svg).unwrap();
        assert!((text.contains("minutes after") || text.contains("seconds after")) && !text.contains("NaN"));
        assert!(quicklook::read_info(Path::new(&png)).unwrap().0 > 800);
    }
    let (code, _, err) = run(&["inspect", &data("circle.oem"), "--picture", &scratch.argument("x.jpg")]);
    assert!(code == 1 && err.contains(".svg or .png"), "{err}");
}

/// Kernels are drawn as other files are; a meta-kernel draws what it lists together, which attitudes need, whose times are ticks of a clock.
#[test]
fn kernels_are_drawn() {
    let scratch = Scratch::new();
    let spice = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/spice");
    let kernel = |name: &str| spice.join(name).display().to_string();
    let of = |names: [&str; 4]| names.map(|name| format!("'{}'", kernel(name))).join(", ");
    let meta = |names: [&str; 4], file: &str| {
        scratch
            .write(file, format!("KPL/MK\n\\begindata\nKERNELS_TO_LOAD = ( {} )\n\\begintext\n", of(names)))
            .display()
            .to_string()
    };
    let turns = meta(["probe.tls", "probe.tsc", "probe.tf", "probe.bc"], "turns.tm");
    for (file, said) in [(kernel("probe.bsp"), "height, km"), (turns, "turned, deg")] {
        let svg = scratch.argument("kernel.svg");
        let (code, _, err) = run(&["inspect", &file, "--picture", &svg, "--force"]);
        assert_eq!(code, 0, "{err}");
        let text = std::fs::read_to_string(&svg).unwrap();
        assert!(text.contains(said) && text.contains("TDB") && !text.contains("NaN"), "{file}");
    }
    // What has no times cannot be drawn, nor attitudes whose clock is missing.
    for (file, expected) in [("mars.tpc", "no span of time"), ("probe.bc", "clock")] {
        let (code, _, err) = run(&["inspect", &kernel(file), "--picture", &scratch.argument("none.svg")]);
        assert!(code == 1 && err.contains(expected) && !scratch.join("none.svg").exists(), "{err}");
    }
}
