//! A scene in code, and what a camera sees of it: `cargo run --profile quick --example 1_first_image`.
//!
//! A scene is plain values with names and units. `check` looks at all of them at once and gives the scene back;
//! below it nothing can fail any more but by being interrupted.

#![allow(clippy::print_stdout)]

use glam::{DMat3, DVec3};
use mmxrt::geometry::{Direction, FrameCamera, Pose};
use mmxrt::landscape::{self, Recipe, Sources};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Exposure, Material, Models, Photometry, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal};
use mmxrt::spectral::{Band, Extend, Spectrum, solar_e490};
use mmxrt::units::{AU_M, TSI_1AU_W_M2};
use mmxrt::{Result, study};

fn main() -> Result<()> {
    // 2 x 2 km of craters and boulders from a seed; x east, y north, z up. The same seed always makes the same mesh.
    let landscape = landscape::generate(&Recipe { facets: 20_000, ..Recipe::new(7) }, &Sources::default(), &|_| true)?;

    // The ground reflects more at longer waves, the boulders the same everywhere. A Lambert surface each.
    let red = Spectrum::new(vec![0.9, 4.0], vec![0.06, 0.10], Extend::Error).expect("wavelengths ascend");
    let reflectances = [red, Spectrum::constant(0.08)];
    let materials = (landscape.materials.iter().zip(reflectances).enumerate())
        .map(|(i, (made, reflectance))| Material {
            name: made.name.clone(),
            photometry: Photometry::Lambert,
            emissivity: reflectance.map(|r| 1.0 - r), // Kirchhoff
            reflectance,
            bond_albedo: 0.08,
            emissivity_bolometric: 0.95,
            thermal_inertia: 0.0,
            temperature_k: None,
            mixture: vec![(i, 1.0)],
        })
        .collect();

    // 500 m over the ground, looking straight down: +X of the sensor (right) is east, +Y (down) is south.
    let world_from_sensor = Pose {
        rotation: DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z),
        translation_m: DVec3::new(0.0, 0.0, 500.0),
    };
    let scene = SceneParts {
        surface: Surface {
            origin_m: DVec3::new(0.0, 11_860.0, 0.0), // where the site is on the body: for latitudes and longitudes
            mesh: landscape.mesh,
            materials,
            textures: vec![],
        },
        sky: Sky {
            sun: Sun {
                direction: Direction::new(DVec3::new(1.0, 0.0, 1.0)).expect("has a length"), // 45 deg high in the east
                distance_m: 1.52 * AU_M,
                irradiance_1au: solar_e490().clone(),
                total_irradiance_1au_w_m2: TSI_1AU_W_M2,
                limb_darkening: 0.0,
            },
            mars: None,
            bodies: vec![],
            beams: vec![],
            rotation: None,
            past: None,
        },
        models: Models { thermal: Thermal::Equilibrium, ..Models::default() },
        exposure: Exposure {
            instrument: "first camera".into(),
            camera: FrameCamera::centred(world_from_sensor, 64, 64, 0.02), // 10 m a pixel
            bands: [1.0, 2.0, 3.0, 3.6].map(|centre_um| Band::new(centre_um, None)).into(),
            spectrometer: Spectrometer::default(),
        },
    }
    .check()?;

    let (_, observation) = study::simulate(&scene, &unwatched)?;

    // A cube is [line, sample, band]; backplanes are found by their names.
    let (line, sample) = (32, 32);
    let cube = observation.cube.to_array();
    println!("pixel ({line}, {sample}), W m-2 sr-1 um-1:");
    for (b, band) in scene.exposure.bands.iter().enumerate() {
        println!("  {:.2} um: {:.6}", band.centre_um, cube[[line, sample, b]]);
    }
    for name in ["COVERAGE", "LIT_FRACTION", "RANGE_MEAN", "LOCALINCIDENCE_MEAN"] {
        let plane = observation.backplanes.plane(name).expect("every product has it");
        println!("  {name}: {:.6} {}", plane.values[line * 64 + sample], plane.unit);
    }
    Ok(())
}
