//! Images that are taken in parts: what comes with them besides radiance, and radiance by a table or maps from elsewhere.

use glam::DVec3;
use mmxrt::formats::envi::{self, Precision};
use mmxrt::formats::{exposures_csv, scene_toml};
use mmxrt::integrate::Wanted;
use mmxrt::job::exposure_facts;
use mmxrt::product::{Cube, CubeAxes, Placement, RadianceMap, Slab};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Mirror, Motion, Readout, Scene, Timing};
use mmxrt::solve;
use mmxrt::spectral::Band;
use mmxrt::study::{
    Extremes, Fill, Looks, MapAccount, MapOptions, Moving, Observation, acquire_by_maps, acquire_by_slabs,
    acquire_by_table, observe_maps,
};

use crate::cli::run;
use crate::flight_scene::FLYING;
use crate::maps::{Texels, camera_image, map};
use crate::motion::{down, moving_scene, steady};
use crate::scenes::replaced;
use crate::scratch::Scratch;
use crate::shapes::*;

/// Relief of small facets, of which each exposure sees few.
fn moving(readout: Readout) -> (Scene, Motion, Timing) {
    let timing = Timing { readout, period_s: 1.0, exposure_s: 0.0, poses: 1 };
    let motion = steady(DVec3::NEG_Y * 20.0, 1.5, sun(50.0, 40.0).vec(), down());
    let mut ground = grid(300.0, 41, |x, y| 9.0 * (0.02 * x).sin() * (0.03 * y).cos());
    ground.vertices_m.iter_mut().for_each(|vertex| *vertex += DVec3::new(1.37, 2.71, 0.0));
    let scene = moving_scene(ground, [6, 4], 10.0, &[1.0, 2.0], &motion, timing);
    (scene, motion, timing)
}

fn mirror() -> Readout {
    Readout::Sample(Mirror { samples: 6, sample_s: 0.1, step_rad: 5e-4, elements: 2 })
}

fn taken(
    scene: &Scene,
    look: impl FnOnce(Wanted, &mut dyn FnMut(Slab) -> mmxrt::Result<()>) -> Observation<()>,
) -> (Cube, Observation<()>) {
    let mut slabs = Vec::new();
    let wanted = Wanted { footprints: true, ..Wanted::default() };
    let observation = look(wanted, &mut |slab| {
        slabs.push(slab);
        Ok(())
    });
    (Cube::new(CubeAxes::of(&scene.exposure), slabs).unwrap(), observation)
}

#[test]
fn lines_have_footprints_with_the_bodys_own_facets() {
    for readout in [Readout::Line, mirror()] {
        let (scene, motion, timing) = moving(readout);
        let extremes = Extremes::new(&scene);
        let moving = Moving { scene: &scene, motion: &motion, timing, optics: None };
        let (_, observation) = taken(&scene, |wanted, put| {
            acquire_by_slabs(moving, (&extremes, 1e-9), wanted, put, &unwatched).unwrap().1
        });
        let footprints = observation.footprints.unwrap();
        footprints.validate().unwrap();
        assert_eq!(footprints.row_start.len(), 25);
        let plane = |name: &str| observation.backplanes.plane(name).unwrap().values.clone();
        let (coverage, largest, lit) = (plane("COVERAGE"), plane("FACET"), plane("LIT_FRACTION"));
        for pixel in 0..24 {
            assert!((footprints.coverage(pixel) - coverage[pixel]).abs() < 1e-12);
            let most = footprints
                .pixel(pixel)
                .fold((0, 0.0), |most, (f, area, _)| if area > most.1 { (f, area) } else { most });
            assert_eq!(f64::from(most.0), largest[pixel], "{readout:?} {pixel}");
            let of_lit: f64 = footprints.pixel(pixel).map(|(_, _, lit)| lit).sum();
            assert!((of_lit / coverage[pixel] - lit[pixel]).abs() < 1e-12);
        }
    }
}

/// Under a sky that stands still a table of one epoch is that of all.
#[test]
fn a_given_table_serves_every_part() {
    for readout in [Readout::Band, Readout::Line, mirror()] {
        let (scene, motion, timing) = moving(readout);
        let extremes = Extremes::new(&scene);
        let moving = Moving { scene: &scene, motion: &motion, timing, optics: None };
        let (solved, _) = taken(&scene, |wanted, put| {
            acquire_by_slabs(moving, (&extremes, 1e-9), wanted, put, &unwatched).unwrap().1
        });
        let table = solve::solve(&scene, &unwatched).unwrap();
        let (given, observation) = taken(&scene, |wanted, put| {
            acquire_by_table(moving, &table, (&extremes, 1e-9), wanted, put, &unwatched).unwrap()
        });
        for band in 0..2 {
            let (a, b) = (solved.band(band), given.band(band));
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs() && *b > 0.0), "{readout:?}");
        }
        assert!(observation.warnings.iter().any(|warning| warning.contains("of one epoch")));
    }
}

#[test]
fn the_command_takes_tables_and_footprints_of_push_brooms() {
    let scratch = Scratch::new();
    let text =
        FLYING.replace("samples = 8\nlines = 8\n", "kind = \"push_broom\"\nperiod_s = 1.0\nsamples = 4\nlines = 3\n");
    scratch.write("scene.toml", text);
    let (scene, table, out) = (scratch.argument("scene.toml"), scratch.argument("table.npz"), scratch.argument("out"));
    assert_eq!(run(&["solve", &scene, "-o", &table, "--quiet"]).0, 0);
    let (code, _, err) = run(&["integrate", &scene, "--table", &table, "-o", &out, "--footprints", "--quiet"]);
    assert_eq!(code, 0, "{err}");
    assert!(scratch.join("out/footprints.npz").exists() && scratch.join("out/exposures.csv").exists());
    // Maps of radiance, too: 3 everywhere is 3 everywhere.
    let facets = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap().scene.body.mesh.facets.len();
    let rows: String = (0..facets).map(|f| format!("{f},3\n")).collect();
    scratch.write("m.csv", format!("facet,radiance_w_m2_sr_um at 1 um\n{rows}"));
    scratch.write("scene.toml", replaced(&std::fs::read_to_string(&scene).unwrap(), &[("[1.0, 2.0, 3.0]", "[1.0]")]));
    let map = scratch.argument("m.csv");
    let (code, _, err) = run(&["integrate", &scene, "--radiance", &map, "-o", &out, "--force"]);
    assert!(code == 0 && err.contains("of one epoch"), "{err}");
    let cube = std::fs::read(scratch.join("out/cube.img")).unwrap();
    let values: Vec<f32> = cube.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    assert!(values.len() == 12 && values.iter().all(|value| (value - 3.0).abs() < 1e-6), "{values:?}");
}

/// Radiance of facets that tells each from all others, in two bands; without a value where `unknown` says so.
fn of_facets(scene: &Scene, unknown: impl Fn(usize) -> bool) -> RadianceMap {
    let facets = scene.body.mesh.facets.len();
    let band = |times: f64| {
        (0..facets).map(|f| if unknown(f) { f64::NAN } else { times * (1.0 + (f * 37 % 101) as f64) }).collect()
    };
    let bands = vec![Band::new(1.0, None), Band::new(2.0, None)];
    let source = Box::new(Texels(bands, vec![band(1.0), band(0.125)]));
    RadianceMap { source, ..map(Placement::Facets(facets), vec![]) }
}

/// What maps show of a moving scene.
fn by_maps(
    (scene, motion, timing): &(Scene, Motion, Timing),
    maps: Vec<RadianceMap>,
    options: &MapOptions,
) -> mmxrt::Result<(Cube, Observation<()>, MapAccount)> {
    let table = solve::solve(scene, &unwatched).unwrap();
    let moving = Moving { scene, motion, timing: *timing, optics: None };
    let mut slabs = Vec::new();
    let mut put = |slab| {
        slabs.push(slab);
        Ok(())
    };
    let wanted = Wanted { footprints: true, ..Wanted::default() };
    let terms = maps.into_iter().map(|map| vec![map]).collect();
    let (observation, account) =
        acquire_by_maps(moving, (&table, terms), (options, 1e-3), wanted, &mut put, &unwatched)?;
    Ok((Cube::new(CubeAxes::of(&scene.exposure), slabs).unwrap(), observation, account))
}

/// A pixel has of each facet as much as it sees of it then.
#[test]
fn facets_have_the_radiance_of_maps_at_every_exposure() {
    for readout in [Readout::Line, mirror()] {
        let of = moving(readout);
        let (cube, observation, account) =
            by_maps(&of, vec![of_facets(&of.0, |_| false)], &MapOptions::default()).unwrap();
        let footprints = observation.footprints.unwrap();
        for pixel in 0..24 {
            let mean: f64 = footprints.pixel(pixel).map(|(f, area, _)| area * (1.0 + (f * 37 % 101) as f64)).sum();
            for (band, times) in [(0, 1.0), (1, 0.125)] {
                let value = cube.band(band)[pixel];
                assert!(
                    (value - times * mean).abs() < 1e-12 * mean && mean > 1.0,
                    "{readout:?} {pixel} {value} {mean}"
                );
            }
        }
        assert_eq!((account.unknown_share, account.unknown_pixels), (0.0, 0));
        assert!(observation.effects.is_empty() && observation.warnings.iter().any(|w| w.contains("of one epoch")));
        assert_eq!(observation.backplanes.plane("MAP_COVERAGE").unwrap().values.len(), 24);
    }
}

/// Each band of a filter, and each line of a push-broom that stands still, is a frame of its own.
#[test]
fn maps_show_to_each_exposure_what_they_show_to_a_frame() {
    for readout in [Readout::Band, Readout::Line] {
        let mut of = moving(readout);
        if readout == Readout::Line {
            of.1 = steady(DVec3::ZERO, 1.5, sun(50.0, 40.0).vec(), down());
        }
        let (scene, motion, timing) = &of;
        let (cube, ..) = by_maps(&of, vec![of_facets(scene, |_| false)], &MapOptions::default()).unwrap();
        let table = solve::solve(scene, &unwatched).unwrap();
        for take in timing.takes(&scene.exposure) {
            let mut exposure = take.exposure(&scene.exposure);
            exposure.camera.world_from_sensor = motion.pose(motion.start.after_s(take.middle_s)).unwrap();
            let frame = scene.seen_by(exposure).unwrap();
            let maps = vec![vec![of_facets(scene, |_| false)]];
            let (shown, _) = observe_maps(&frame, &table, maps, &MapOptions::default(), &unwatched).unwrap();
            for band in take.bands.clone() {
                let all = cube.band(band);
                let there = &all[take.lines.start * 6..take.lines.end * 6];
                let alone = shown.cube.band(band - take.bands.start);
                assert!(there.iter().zip(&alone).all(|(a, b)| (a - b).abs() <= 1e-12 * b && *b > 0.1), "{readout:?}");
            }
        }
    }
}

/// What an image knows and what fills the rest are alike, from however many poses: so is all that is seen.
#[test]
fn images_and_fills_serve_exposures_of_several_poses() {
    for readout in [Readout::Frame, Readout::Band, Readout::Line, mirror()] {
        for poses in [0, 1, 3] {
            let mut of = moving(readout);
            (of.2.poses, of.2.exposure_s) = (poses, 0.5);
            let (eye, small) = (nadir(20_000.0, 400.0, 2), nadir(20_000.0, 30.0, 2));
            for (camera, is_enough) in [(&eye, true), (&small, false)] {
                let bands = vec![Band::new(1.0, None), Band::new(2.0, None)];
                let source = Box::new(Texels(bands, vec![vec![5.0; 4]; 2]));
                let image = || RadianceMap { source, ..map(camera_image(camera, true), vec![]) };
                let options = MapOptions { fill: Fill::Value(5.0), ..MapOptions::default() };
                let (cube, observation, account) = by_maps(&of, vec![image()], &options).unwrap();
                assert_eq!(account.unknown_share < 1e-9, is_enough);
                let coverage = &observation.backplanes.plane("COVERAGE").unwrap().values;
                for band in 0..2 {
                    let values = cube.band(band);
                    assert!(values.iter().zip(coverage).all(|(l, c)| (l - 5.0 * c).abs() < 1e-9 && *c > 0.9));
                }
            }
        }
    }
}

/// What maps leave unknown is counted over all exposures, refused, or marked; sums that are too small say where in the cube.
#[test]
fn what_is_unknown_is_of_all_exposures() {
    for readout in [Readout::Band, Readout::Line, mirror()] {
        let of = moving(readout);
        let scene = &of.0;
        let beyond = |f: usize| {
            let facet = scene.body.mesh.facet(f);
            facet.corners_m.iter().map(|corner| corner.x).sum::<f64>() > 3.0 * 12.0
        };
        let map = || of_facets(scene, beyond);
        let refused = by_maps(&of, vec![map()], &MapOptions::default()).unwrap_err().to_string();
        assert!(refused.contains("% of what the camera sees is unknown"), "{refused}");
        let options = MapOptions { fill: Fill::Nan, ..MapOptions::default() };
        let (cube, observation, account) = by_maps(&of, vec![map()], &options).unwrap();
        let bands = [cube.band(0), cube.band(1)];
        let marked = (0..24).filter(|pixel| bands[0][*pixel].is_nan()).count();
        assert!(marked > 3 && marked < 21, "{readout:?} {marked}");
        let either = (0..24).filter(|pixel| bands.iter().any(|band| band[*pixel].is_nan())).count();
        assert_eq!(account.unknown_pixels, either as u64);
        assert!(account.unknown_share > 0.1 && account.unknown_share < 0.9);
        if readout != Readout::Band {
            let known = &observation.backplanes.plane("MAP_COVERAGE").unwrap().values;
            let none = |pixel: usize| known[pixel] < 1e-9;
            assert!((0..24).all(|pixel| bands[0][pixel].is_nan() == none(pixel)));
            let mean = known.iter().sum::<f64>() / 24.0;
            assert!((account.unknown_share - (1.0 - mean)).abs() < 1e-9);
        }
        // The last pixel alone sees less than nothing: of a facet that no other has.
        if readout == Readout::Band {
            continue;
        }
        let (_, whole, _) = by_maps(&of, vec![of_facets(scene, |_| false)], &MapOptions::default()).unwrap();
        let footprints = whole.footprints.unwrap();
        let of_others: Vec<u32> = (0..23).flat_map(|pixel| footprints.pixel(pixel).map(|(f, ..)| f)).collect();
        let own = footprints.pixel(23).map(|(f, ..)| f).find(|f| !of_others.contains(f)).unwrap();
        let facets = scene.body.mesh.facets.len();
        let mut dark = vec![0.0; facets];
        dark[own as usize] = 1e6;
        let both = vec![Band::new(1.0, None), Band::new(2.0, None)];
        let source = Box::new(Texels(both, vec![dark; 2]));
        let less = RadianceMap { source, weight: -1.0, ..crate::maps::map(Placement::Facets(facets), vec![]) };
        let wrong = by_maps(&of, vec![of_facets(scene, |_| false), less], &MapOptions::default());
        let wrong = wrong.unwrap_err().to_string();
        assert!(wrong.contains("sample 5, line 3 (from 0)"), "{readout:?} {wrong}");
    }
}

/// Ground that is as flat as anything, and what a product of it has beside its table of exposures.
fn flat_product(scratch: &Scratch, readout: Readout) -> std::path::PathBuf {
    let timing = Timing { readout, period_s: 1.0, exposure_s: 0.0, poses: 1 };
    let motion = steady(DVec3::NEG_Y * 20.0, 1.5, sun(50.0, 40.0).vec(), down());
    let scene = moving_scene(plane(900.0, 0.0), [6, 4], 10.0, &[1.0, 2.0, 3.0], &motion, timing);
    let (_, observation) = crate::motion::taken(&scene, &motion, timing);
    let (table, exposures) = (scratch.join("exposures.csv"), observation.exposures.unwrap());
    exposures_csv::write(&table, &exposures).unwrap();
    let planes = &observation.backplanes;
    envi::write_backplanes(&scratch.join("backplanes.img"), planes, Precision::F64, "t").unwrap();
    if readout == Readout::Band {
        let all = (0..6).map(|i| std::borrow::Cow::Owned(exposures.displacement(planes, i / 2, i % 2).unwrap()));
        envi::write_planes(&scratch.join("displacement.img"), [6, 4], all, Precision::F64, "t").unwrap();
    }
    table
}

/// 20 m a second are two pixels a second; lines go down the way, so that what was seen moves up.
#[test]
fn a_table_of_exposures_tells_times_and_drift() {
    for (readout, of, count, drift) in [
        (Readout::Band, "a band", 3, Some([0.0, -2.0])),
        (Readout::Line, "a line", 4, Some([0.0, 2.0])),
        (mirror(), "a sample", 12, None),
    ] {
        let scratch = Scratch::new();
        let table = flat_product(&scratch, readout);
        let facts = exposure_facts(&table).unwrap();
        assert_eq!((facts.takes.name(), facts.exposures, facts.gaps.len()), (of, count, 0));
        let is = |value: f64, wanted: f64| (value - wanted).abs() < 1e-6;
        let (step_s, span_s) = if readout == mirror() { (0.1, 1.5) } else { (1.0, (count - 1) as f64) };
        let steps = facts.steps.unwrap();
        assert!(is(facts.span_s, span_s) && is(steps.min_s, step_s) && is(steps.max_s, step_s), "{facts:?}");
        // Five steps of a tenth of a second, and then the mirror goes back until the second is over.
        assert_eq!(facts.between_sweeps.map(|of| is(of.median_s, 0.5)), (readout == mirror()).then_some(true));
        let [speed, turn] = facts.moves.unwrap();
        assert!((speed - 20.0).abs() < 1e-5 && (turn < 1e-9 || readout == mirror()), "{readout:?} {speed} {turn}");
        if readout == mirror() {
            assert!((turn - 5e-3).abs() < 1e-8, "half a milliradian in a tenth of a second: {turn}");
        }
        match (facts.drift_px_s, drift) {
            (None, None) => {}
            (Some(found), Some(wanted)) => {
                assert!((0..2).all(|axis| (found.mean[axis] - wanted[axis]).abs() < 1e-6), "{found:?}");
                assert!((found.most - 2.0).abs() < 1e-6);
            }
            other => panic!("{other:?}"),
        }
        let (code, out, err) = run(&["inspect", table.to_str().unwrap()]);
        assert!(
            code == 0 && out.contains(&format!("exposures: {count}\n")) && out.contains("gaps: none"),
            "{out}{err}"
        );
        assert_eq!(out.contains("drift_px_s"), drift.is_some(), "{out}");
    }
}

#[test]
fn a_table_of_exposures_that_is_not_whole_says_so() {
    let scratch = Scratch::new();
    let table = flat_product(&scratch, Readout::Line);
    let text = std::fs::read_to_string(&table).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    // A line is missing: nothing of backplanes can be said, but of a table alone that a second was left out.
    std::fs::write(&table, [rows[0], rows[1], rows[2], rows[4], ""].join("\n")).unwrap();
    let message = exposure_facts(&table).unwrap_err().to_string();
    assert!(message.contains("has 4 lines but exposures.csv has 3 exposures"), "{message}");
    std::fs::remove_file(scratch.join("backplanes.img")).unwrap();
    let facts = exposure_facts(&table).unwrap();
    assert!(facts.gaps.len() == 1 && facts.gaps[0].0 == 1 && (facts.gaps[0].1 - 2.0).abs() < 1e-6, "{facts:?}");
    assert_eq!(facts.drift_px_s, None);
    // One exposure alone has no steps, and none has nothing.
    std::fs::write(&table, [rows[0], rows[1]].join("\n")).unwrap();
    let facts = exposure_facts(&table).unwrap();
    assert_eq!((facts.takes.name(), facts.steps, facts.moves, facts.span_s), ("all", None, None, 0.0));
    let bad = |text: String, words: &str| {
        std::fs::write(&table, text).unwrap();
        let message = exposure_facts(&table).unwrap_err().to_string();
        assert!(message.contains(words), "{words}: {message}");
    };
    bad(rows[0].to_owned(), "has no rows");
    bad(format!("{},more\n{},1", rows[0], rows[1]), "the header is not");
    bad([rows[0], rows[2], rows[1]].join("\n"), "exposures.csv:3:");
    bad([rows[0], rows[1], rows[1]].join("\n"), "times must ascend");
    bad([rows[0], &rows[1].replace("1,1,1,3,", "1,1,0,3,")].join("\n"), "first_band counts from 1");
    bad([rows[0], &rows[1].replace("1,1,1,3,", "1,1,4,3,")].join("\n"), "ends at 3, before it begins at 4");
    bad([rows[0], &rows[1].replace("1,1,1,3,", "1,1,1,3,,")].join("\n"), "18 cells of 17");
    for nothing in ["nan", "inf", "1e999", "x", ""] {
        let cells: Vec<&str> =
            rows[1].split(',').enumerate().map(|(i, cell)| if i == 7 { nothing } else { cell }).collect();
        bad([rows[0], &cells.join(",")].join("\n"), "y_m is not a finite number");
        let cells: Vec<&str> =
            rows[1].split(',').enumerate().map(|(i, cell)| if i == 12 { "0.5" } else { cell }).collect();
        bad([rows[0], &cells.join(",")].join("\n"), "must have length 1");
    }
}

/// What is foreseen of exposures' work: without optics their parts together have the image's pixels once for each pose, a filter's once for each band.
#[test]
fn exposures_are_foreseen_by_the_pixels_that_they_have() {
    let pixels = |readout: Readout, poses: u32| {
        let (scene, _, timing) = moving(readout);
        let looks = Looks::of(&scene, Some(Timing { poses, ..timing }), None);
        assert!(looks.facets > 0.0 && looks.facets <= 1.0);
        looks.count * looks.pixels
    };
    for (readout, once) in [(Readout::Line, 1.0), (mirror(), 1.0), (Readout::Band, 2.0)] {
        for poses in [1, 5] {
            assert!((pixels(readout, poses) - once * f64::from(poses)).abs() < 1e-12, "{readout:?} {poses}");
        }
    }
}
