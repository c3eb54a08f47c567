//! Images that are taken in parts: what comes with them besides radiance, and radiance by a table from elsewhere.

use glam::DVec3;
use mmxrt::integrate::Wanted;
use mmxrt::product::{Cube, CubeAxes, Slab};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Mirror, Motion, Readout, Scene, Timing};
use mmxrt::solve;
use mmxrt::study::{Extremes, Moving, Observation, acquire_by_slabs, acquire_by_table};

use crate::cli::run;
use crate::flight_scene::FLYING;
use crate::motion::{down, moving_scene, steady};
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

/// Under a sky that stands still a table of one moment is that of all.
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
        assert!(observation.warnings.iter().any(|warning| warning.contains("of one moment")));
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
    scratch.write("m.csv", "1\n");
    let (code, _, err) =
        run(&["integrate", &scene, "--radiance", &scratch.argument("m.csv"), "-o", &out, "--force", "--quiet"]);
    assert!(code != 0 && err.contains("taken in parts"), "{err}");
}
