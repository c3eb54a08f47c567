//! A square metre under a sky of one's choice: the smallest scene by which the product's own functions answer a closed form.

use glam::{DMat3, DVec3};

use crate::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose};
use crate::integrate::Wanted;
use crate::product::{Backplanes, FacetTable};
use crate::progress::unwatched;
use crate::scene::{
    Exposure, Globe, Material, Models, Photometry, Scene, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal,
};
use crate::spectral::{Band, Spectrum};
use crate::study::{observe, simulate};
use crate::units::AU_M;

/// A square metre at the origin, and what lights and sees it. Spectra are the same at all wavelengths.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    /// Where the patch is, from the body's centre, m.
    pub(super) origin_m: DVec3,
    /// Its outward normal, of any length.
    pub(super) normal: DVec3,
    /// Towards the Sun, of any length.
    pub(super) sun: DVec3,
    pub(super) sun_distance_m: f64,
    /// Sunlight at 1 au, W m-2 um-1.
    pub(super) irradiance_1au: f64,
    /// The same over all wavelengths, W m-2.
    pub(super) total_irradiance_1au_w_m2: f64,
    /// Centre and radius of Mars, m.
    pub(super) mars_m: Option<(DVec3, f64)>,
    pub(super) reflectance: f64,
    pub(super) emissivity: f64,
    pub(super) bond_albedo: f64,
    pub(super) emissivity_bolometric: f64,
    pub(super) thermal: Thermal,
    /// The camera, m.
    pub(super) observer_m: DVec3,
    pub(super) wavelength_um: f64,
}

impl Default for Patch {
    fn default() -> Self {
        Patch {
            origin_m: DVec3::ZERO,
            normal: DVec3::Z,
            sun: DVec3::Z,
            sun_distance_m: AU_M,
            irradiance_1au: 1.0,
            total_irradiance_1au_w_m2: 1361.0,
            mars_m: None,
            reflectance: 0.0,
            emissivity: 1.0,
            bond_albedo: 0.0,
            emissivity_bolometric: 1.0,
            thermal: Thermal::Off,
            observer_m: 1000.0 * DVec3::Z,
            wavelength_um: 1.0,
        }
    }
}

impl Patch {
    /// What `solve` finds of the patch, which is facet 0.
    pub(super) fn table(&self) -> Option<FacetTable> {
        Some(simulate(&self.scene()?, &unwatched).ok()?.0)
    }

    /// Radiance of the pixel that looks at the middle of the patch, W m-2 sr-1 um-1.
    pub(super) fn radiance(&self) -> Option<f64> {
        Some(simulate(&self.scene()?, &unwatched).ok()?.1.cube.band(0)[0])
    }

    /// The same, of a patch without light and with this temperature.
    pub(super) fn radiance_at(&self, temperature_k: f64) -> Option<f64> {
        let scene = Patch { thermal: Thermal::Thesis, ..self.clone() }.scene()?;
        let mut table = simulate(&scene, &unwatched).ok()?.0;
        table.sources[0].irradiance.fill(0.0);
        table.temperature_lit_k.fill(temperature_k);
        table.temperature_shaded_k.fill(temperature_k);
        Some(observe(&scene, &table, Wanted::default(), &unwatched).ok()?.cube.band(0)[0])
    }

    /// The planes of that pixel.
    pub(super) fn backplanes(&self) -> Option<Backplanes> {
        Some(simulate(&self.scene()?, &unwatched).ok()?.1.backplanes)
    }

    fn scene(&self) -> Option<Scene> {
        let up = Direction::new(self.normal)?;
        let (h, v) = up.frame();
        let square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| x * h + y * v);
        // Two specks a kilometre away make it a site of 2 km: tables over the site are as coarse as in a product.
        let specks = [1000.0, -1000.0].map(|side| square.map(|p| 1e-3 * p + side * (h + v) * 0.5f64.sqrt()));
        let mesh = Mesh {
            vertices_m: square.into_iter().chain(specks.into_iter().flatten()).collect(),
            facets: (0..3).flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]).collect(),
            material: vec![MaterialId(0); 6],
            face_of_facet: vec![],
            uv: vec![],
        };
        let mars = self.mars_m.map(|(centre_m, radius_m)| Globe {
            name: Sky::MARS.into(),
            centre_m,
            radius_m,
            reflectance: Spectrum::constant(1.0),
            bond_albedo: 1.0,
            thermal_exitance_w_m2: 0.0,
            day_night_k: crate::scene::MARS_DAY_NIGHT_K,
        });
        let parts = SceneParts {
            surface: Surface {
                origin_m: self.origin_m,
                mesh,
                materials: vec![Material {
                    name: "patch".to_owned(),
                    reflectance: Spectrum::constant(self.reflectance),
                    photometry: Photometry::Lambert,
                    emissivity: Spectrum::constant(self.emissivity),
                    bond_albedo: self.bond_albedo,
                    emissivity_bolometric: self.emissivity_bolometric,
                    thermal_inertia: 0.0,
                    temperature_k: None,
                    mixture: vec![(0, 1.0)],
                }],
                textures: vec![],
            },
            sky: Sky {
                sun: Sun {
                    direction: Direction::new(self.sun)?,
                    distance_m: self.sun_distance_m,
                    irradiance_1au: Spectrum::constant(self.irradiance_1au),
                    total_irradiance_1au_w_m2: self.total_irradiance_1au_w_m2,
                    limb_darkening: 0.0,
                },
                mars,
                bodies: vec![],
                beams: vec![],
                rotation: None,
                past: None,
            },
            exposure: Exposure {
                instrument: "frame camera".to_owned(),
                camera: camera(self.observer_m, 1, 0.1 / self.observer_m.length())?,
                bands: vec![Band::new(self.wavelength_um, None)],
                spectrometer: Spectrometer::default(),
            },
            models: Models { thermal: self.thermal, ..Models::default() },
        };
        parts.check().ok()
    }
}

/// A camera that looks at the origin.
pub(super) fn camera(from_m: DVec3, pixels: u32, pitch: f64) -> Option<FrameCamera> {
    let boresight = Direction::new(-from_m)?;
    let (h, v) = boresight.frame();
    let rotation = DMat3::from_cols(h, v, boresight.vec());
    Some(FrameCamera::centred(Pose { rotation, translation_m: from_m }, pixels, pixels, pitch))
}
