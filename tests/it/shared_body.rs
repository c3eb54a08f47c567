//! One body, many skies and many exposures: what is large is there once.

use glam::DVec3;
use mmxrt::geometry::{Direction, FrameCamera, Mesh};
use mmxrt::integrate::Wanted;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Body, Exposure, Scene, Setup, Sky, Sun, Thermal};
use mmxrt::solve::solve;
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::study;

use crate::scenes::{edited, scene};
use crate::shapes::{grid, nadir};

/// Where a scene keeps what is large.
fn places(scene: &Scene) -> (*const DVec3, *const Mesh, *const mmxrt::visibility::Topology) {
    (scene.body.mesh.vertices_m.as_ptr(), &raw const scene.body.mesh, scene.body.topology())
}

/// The Sun `step` thirds of a degree on.
fn later(sun: &Sun, step: u32) -> Sun {
    let angle_rad = f64::from(step).to_radians() / 3.0;
    let direction = Direction::new(glam::DMat3::from_rotation_y(angle_rad) * sun.direction.vec()).unwrap();
    Sun { direction, ..sun.clone() }
}

#[test]
fn one_body_serves_three_hundred_skies_and_exposures() {
    let hills = grid(20.0, 24, |x, y| (0.4 * x).sin() * (0.3 * y).cos());
    let first = scene(hills, nadir(1000.0, 30.0, 4), [0.3, 0.1, 1.0]);
    let kept = places(&first);
    let (mut skies, mut exposures) = (0, 0);
    for step in 0..300 {
        let under = first.under(Sky { sun: later(&first.sky.sun, step), ..first.sky.clone() }).unwrap();
        assert_eq!(places(&under), kept);
        skies += 1;
        let camera = nadir(1000.0 + f64::from(step), 30.0, 4);
        let seen = under.seen_by(Exposure { camera, ..under.exposure.clone() }).unwrap();
        assert_eq!(places(&seen), kept);
        exposures += 1;
        if step % 60 == 0 {
            // What is solved and seen of it is its own.
            let table = solve(&seen, &unwatched).unwrap();
            let image = study::observe(&seen, &table, Wanted::default(), &unwatched).unwrap();
            let alone = Setup { body: Body::new(seen.clone().into_parts().surface).unwrap(), ..(*seen).clone() };
            let (_, same) = study::simulate(&Scene::new(alone).unwrap(), &unwatched).unwrap();
            assert_eq!(image.cube, same.cube);
        }
    }
    assert_eq!((skies, exposures), (300, 300));
    // The only one there is gives its surface away; of several each gets a copy.
    let vertices = first.body.mesh.vertices_m.as_ptr();
    assert_eq!(first.into_parts().surface.mesh.vertices_m.as_ptr(), vertices);
}

#[test]
fn what_belongs_to_pairs_is_checked_when_they_meet() {
    let first = scene(grid(20.0, 4, |_, _| 0.0), nadir(1000.0, 30.0, 4), [0.0, 0.0, 1.0]);
    let items = |refused: mmxrt::Result<Scene>| -> Vec<String> {
        let Err(mmxrt::Error::Invalid(problems)) = refused else { panic!("{refused:?}") };
        problems.into_iter().filter_map(|problem| problem.at.item).collect()
    };
    let mut sky = first.sky.clone();
    sky.sun.distance_m = -1.0;
    assert_eq!(items(first.under(sky)), ["sun"]);
    // A spectrum from 2 um on under a band at 1 um.
    let mut sky = first.sky.clone();
    let table = mmxrt::spectral::Spectrum::new(vec![2.0, 3.0], vec![1.0; 2], mmxrt::spectral::Extend::Error);
    sky.sun.irradiance_1au = table.unwrap();
    assert_eq!(items(first.under(sky)), ["sun.spectrum"]);
    let camera = FrameCamera { samples: 0, ..first.exposure.camera.clone() };
    assert_eq!(
        items(first.seen_by(Exposure { camera, bands: vec![], ..first.exposure.clone() })),
        ["sensor", "sensor.bands"]
    );
}

/// What was found of a body's heat for some bands does not answer for others, nor for other temperatures.
#[test]
fn a_warm_body_is_looked_at_in_other_bands_and_under_other_suns() {
    let hills = grid(20.0, 12, |x, y| (0.4 * x).sin() * (0.3 * y).cos());
    let warm = edited(&scene(hills, nadir(1000.0, 30.0, 4), [0.3, 0.1, 1.0]), |parts| {
        parts.models.thermal = Thermal::Equilibrium;
        parts.surface.materials[0].emissivity = Spectrum::constant(0.9);
    });
    let bands = |um: &[f64]| um.iter().map(|um| Band::new(*um, None)).collect::<Vec<_>>();
    let band_sets = [bands(&[2.5, 3.5]), bands(&[3.5, 2.5]), bands(&[3.0]), bands(&[2.5, 3.5])];
    let mut hottest = 0.0_f64;
    for step in [0, 0, 60, 0] {
        for bands in band_sets.iter().chain(&band_sets) {
            let shared = warm.under(Sky { sun: later(&warm.sky.sun, step), ..warm.sky.clone() }).unwrap();
            let shared = shared.seen_by(Exposure { bands: bands.clone(), ..shared.exposure.clone() }).unwrap();
            let alone = Setup { body: Body::new(shared.clone().into_parts().surface).unwrap(), ..(*shared).clone() };
            let cube = |scene: &Scene| study::simulate(scene, &unwatched).unwrap().1.cube;
            let (of_shared, of_alone) = (cube(&shared), cube(&Scene::new(alone).unwrap()));
            assert_eq!(of_shared, of_alone);
            hottest = hottest.max(of_shared.band(0).iter().copied().fold(0.0, f64::max));
        }
    }
    assert!(hottest > 0.1, "{hottest}");
}
