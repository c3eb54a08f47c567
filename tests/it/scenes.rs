//! Scenes that tests share, to be changed where a test wants another: in memory as [`parts`], as a file [`SITE`] or [`SQUARE`].

use glam::DVec3;
use mmxrt::geometry::{Direction, FrameCamera, Mesh};
use mmxrt::scene::{
    Exposure, Globe, Material, Models, Photometry, Scene, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal,
};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::units::AU_M;

use crate::shapes::direction;

/// A site of 1000 facets on top of a body, seen from 70 km above in 16 x 16 pixels of one band.
pub(crate) const SITE: &str = r#"mmxrt_scene = 1
origin_m = [0.0, 12000.0, 0.0]
[[mesh]]
recipe = { version = 1, seed = 7, facets = 1000 }
[materials]
phobos_blue = { reflectance = 0.07 }
phobos_red = { reflectance = 0.1 }
[sun]
direction = [0.0, 1.0, 0.5]
distance_au = 1.5
[mars]
position_m = [9.4e6, 12000.0, 0.0]
[observer]
position_m = [0.0, 82000.0, 0.0]
target_m = [0.0, 12000.0, 0.0]
up = [0, 0, 1]
[sensor]
samples = 16
lines = 16
fov_deg = 1.0
bands = { centres_um = [1.0] }
"#;

/// The square of [`SQUARE_OBJ`], which is `square.obj`, from 1 km above: each of the 2 x 2 pixels is 4 m wide.
pub(crate) const SQUARE: &str = r#"mmxrt_scene = 1
origin_m = [0, 0, 11000]
[[mesh]]
obj = "square.obj"
[materials.default]
reflectance = 0.1
[sun]
direction = [0, 0, 1]
distance_au = 1.5
[thermal]
model = "off"
[observer]
position_m = [0, 0, 12000]
target_m = [0, 0, 11000]
up = [0, 1, 0]
[sensor]
samples = 2
lines = 2
fov_deg = 0.45836379150820084
[sensor.bands]
centres_um = [1.0]
"#;

/// A square of 8 m with the whole of an image on it.
pub(crate) const SQUARE_OBJ: &str =
    "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

/// A text with each of some pieces, all of which it has, replaced by another.
pub(crate) fn replaced(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "no {from} in {text}");
        text.replace(from, to)
    })
}

/// A Lambertian material, entry `entry` of the dictionary, that emits what it does not reflect.
pub(crate) fn lambert(entry: usize, name: &str, reflectance: Spectrum) -> Material {
    Material {
        name: name.into(),
        emissivity: reflectance.map(|r| 1.0 - r),
        reflectance,
        photometry: Photometry::Lambert,
        bond_albedo: 0.07,
        emissivity_bolometric: 0.95,
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: vec![(entry, 1.0)],
    }
}

pub(crate) fn mars(centre_m: DVec3) -> Globe {
    Globe {
        name: "mars".into(),
        centre_m,
        radius_m: 3_389_500.0,
        reflectance: Spectrum::constant(0.25),
        bond_albedo: 0.25,
        thermal_exitance_w_m2: 110.0,
        day_night_k: [270.0, 200.0],
    }
}

/// A mesh of one material, 11 km above the body's centre, under nothing but the Sun, cold, in one band at 1 um.
pub(crate) fn parts(mesh: Mesh, camera: FrameCamera, towards_sun: Direction) -> SceneParts {
    SceneParts {
        surface: Surface {
            origin_m: DVec3::new(0.0, 0.0, 11_000.0),
            mesh,
            materials: vec![lambert(0, "grey", Spectrum::constant(0.07))],
            textures: vec![],
        },
        sky: Sky {
            sun: Sun {
                direction: towards_sun,
                distance_m: 1.5 * AU_M,
                irradiance_1au: Spectrum::constant(700.0),
                total_irradiance_1au_w_m2: 1361.0,
                limb_darkening: 0.0,
            },
            mars: None,
            bodies: vec![],
            beams: vec![],
            rotation: None,
            past: None,
        },
        exposure: Exposure {
            instrument: "test".into(),
            camera,
            bands: vec![Band::new(1.0, None)],
            spectrometer: Spectrometer::default(),
        },
        models: Models { thermal: Thermal::Off, ..Models::default() },
    }
}

/// The same, checked.
pub(crate) fn scene(mesh: Mesh, camera: FrameCamera, towards_sun: [f64; 3]) -> Scene {
    parts(mesh, camera, direction(towards_sun)).check().unwrap()
}

/// A scene of which some parts are others.
pub(crate) fn edited(scene: &Scene, change: impl FnOnce(&mut SceneParts)) -> Scene {
    let mut parts = scene.clone().into_parts();
    change(&mut parts);
    parts.check().unwrap()
}
