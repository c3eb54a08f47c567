//! What bounds are made from: a body, a sky, an exposure, and what they are relative to.

use crate::physics::reflectance::Lambert;
use crate::physics::{blackbody, bounds, heat, sun};
use crate::product::{Backplanes, FacetTable};
use crate::scene::{MARS_ALBEDO, Material, Setup, Sky};
use crate::spectral::Light;
use crate::study::site::Site;
use crate::units::{MARS_RADIUS_M, PHOBOS_ORBIT_M};

/// The properties of an image that bounds are relative to, taken from the image itself.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::study) struct Reference {
    /// Median cosine of incidence of the sunlit pixels; `None` if nothing that is seen is lit.
    pub(in crate::study) cos_incidence: Option<f64>,
    /// The largest irradiance by Mars on a facet, over Mars' reflectance times the solar irradiance.
    pub(in crate::study) largest_mars_irradiance: f64,
    /// The warmest temperature of a facet, K; 0 without heat.
    pub(in crate::study) warmest_k: f64,
}

impl Reference {
    /// Of an image and the table that it was made of.
    pub(in crate::study) fn of(table: &FacetTable, backplanes: &Backplanes) -> Self {
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        Reference {
            cos_incidence: median_cos_incidence(backplanes),
            largest_mars_irradiance: table.of(Sky::MARS).map_or(0.0, |mars| largest(&mars.irradiance)),
            warmest_k: largest(&table.temperature_lit_k).max(largest(&table.temperature_shaded_k)),
        }
    }
}

/// What the bounds are made from.
pub(in crate::study) struct Given<'a> {
    pub(in crate::study) scene: &'a Setup,
    pub(in crate::study) site: &'a Site,
    pub(in crate::study) reference: Reference,
    /// Share of the site that terrain outside it might shadow.
    pub(in crate::study) open_to_shadow: f64,
    /// The warmest that any facet gets in a day, K: in equilibrium with sunlight at normal incidence, and as much heat from
    /// Mars as it can send; or the warmest of the reference.
    pub(super) noon_k: f64,
    pub(super) materials: Vec<&'a Material>,
    /// Where spectra are looked at, um, and what light the band has: centres of the bands, and ends and corners of their tables in those
    /// that are wide.
    pub(super) bands_um: Vec<(f64, Light)>,
}

impl<'a> Given<'a> {
    pub(in crate::study) fn new(scene: &'a Setup, site: &'a Site, reference: Reference) -> Self {
        let mut used = vec![false; scene.body.materials.len()];
        scene.body.mesh.material.iter().for_each(|m| used[m.0 as usize] = true);
        let materials: Vec<&Material> =
            scene.body.materials.iter().zip(used).filter(|(_, used)| *used).map(|(m, _)| m).collect();
        let total_w_m2 = scene.sky.sun.total_irradiance_w_m2();
        let (q, _) = mars_seen(scene, site);
        let at_noon_k = |m: &&Material| {
            let absorbed_w_m2 = (1.0 - m.bond_albedo + q * q) * total_w_m2;
            heat::equilibrium_temperature_k(absorbed_w_m2, m.emissivity_bolometric)
        };
        let noon_k = materials.iter().map(at_noon_k).fold(reference.warmest_k, f64::max);
        Given {
            scene,
            site,
            reference,
            open_to_shadow: site.open_to_shadow(&scene.body.mesh, scene.sky.sun.direction.vec()),
            noon_k,
            bands_um: bands_um(scene, &materials),
            materials,
        }
    }

    /// The most that a facet sends because of sunlight: reflected at normal incidence, and emitted when warmest; relative as all bounds.
    pub(super) fn all_light(&self) -> Option<f64> {
        let reflected = if self.lit_um().next().is_some() { 1.0 / self.reference.cos_incidence? } else { 0.0 };
        Some(reflected + self.emitted(self.noon_k)?)
    }

    /// Where bands have sunlight, um.
    pub(super) fn lit_um(&self) -> impl Iterator<Item = f64> {
        self.bands_um.iter().filter(|(_, light)| light.is_lit()).map(|(um, _)| *um)
    }

    /// Longest way, m, from what casts a shadow to where it falls.
    pub(super) fn longest_ray_m(&self) -> f64 {
        self.site.longest_ray_m(self.site.up.map_or(0.0, |up| up.dot(self.scene.sky.sun.direction.vec())))
    }

    /// Width of a pixel at the nearest point of the surface, square to the line of sight, m.
    pub(super) fn pixel_m(&self) -> f64 {
        let camera = &self.scene.exposure.camera;
        self.site.distance_m(camera.centre_m()) * camera.mean_pitch()
    }

    pub(super) fn mars_light_bound(&self) -> Option<f64> {
        let (q, _) = mars_seen(self.scene, self.site);
        let albedo = match &self.scene.sky.mars {
            Some(mars) => self.lit_um().filter_map(|um| mars.reflectance.at(um)).fold(0.0, f64::max),
            None => MARS_ALBEDO,
        };
        self.reference.cos_incidence.map(|cos| bounds::mars_light(albedo, q, cos))
    }

    /// What a surface at a temperature emits, relative to the median sunlit radiance.
    pub(super) fn emitted(&self, t_k: f64) -> Option<f64> {
        self.largest(|um, m| emission(m, um, t_k))
    }

    /// As [`largest`](Given::largest), also over temperatures up to the warmest: warm surfaces emit most, but may change least.
    pub(super) fn largest_up_to(&self, warmest_k: f64, radiance: impl Fn(f64, &Material, f64) -> f64) -> Option<f64> {
        const STEPS: u32 = 16;
        let at = |um, m: &Material, i| radiance(um, m, warmest_k * f64::from(i) / f64::from(STEPS));
        self.largest(|um, m| (1..=STEPS).map(|i| at(um, m, i)).fold(0.0, f64::max))
    }

    /// The largest ratio, over bands with heat and materials, of a radiance (of wavelength, um, and material; W m-2 sr-1 um-1) to the
    /// median sunlit radiance.
    pub(super) fn largest(&self, radiance: impl Fn(f64, &Material) -> f64) -> Option<f64> {
        let cos = self.reference.cos_incidence?;
        let mut largest = 0.0_f64;
        for (um, _) in self.bands_um.iter().copied().filter(|(_, light)| light.glows()) {
            for material in &self.materials {
                let ratio = radiance(um, material) / sunlit_radiance(self.scene, material, um, cos)?;
                largest = largest.max(if ratio.is_nan() { 0.0 } else { ratio });
            }
        }
        largest.is_finite().then_some(largest)
    }
}

/// Centres of all bands; of wide ones also the ends, and the corners between them of reflectances and emissivities; um, ascending.
fn bands_um(scene: &Setup, materials: &[&Material]) -> Vec<(f64, Light)> {
    let parameters = materials.iter().flat_map(|m| m.photometry.parameters()).map(|(_, spectrum)| spectrum);
    let of_materials = materials.iter().flat_map(|m| [&m.reflectance, &m.emissivity]).chain(parameters);
    let mut corners_um: Vec<f64> = of_materials
        .chain(scene.sky.mars.iter().map(|m| &m.reflectance))
        .flat_map(|spectrum| spectrum.wavelength_um().iter().copied())
        .collect();
    corners_um.sort_by(f64::total_cmp);
    corners_um.dedup();
    let mut all_um: Vec<(f64, Light)> = Vec::new();
    for band in &scene.exposure.bands {
        let (lo, hi) = band.support_within_um(scene.known_um(band.light));
        let from = corners_um.partition_point(|um| *um <= lo);
        let inside = corners_um[from..].iter().copied().take_while(|um| *um < hi);
        all_um.extend(inside.chain([lo, band.centre_um, hi]).map(|um| (um, band.light)));
    }
    all_um.sort_by(|a, b| a.0.total_cmp(&b.0));
    all_um.dedup();
    all_um
}

/// The largest sine of the angular radius of Mars, or of what it would be over Phobos, and whether the scene has a Mars.
pub(in crate::study) fn mars_seen(scene: &Setup, site: &Site) -> (f64, bool) {
    match &scene.sky.mars {
        Some(mars) => ((mars.radius_m / site.distance_m(mars.centre_m)).min(1.0), true),
        None => (MARS_RADIUS_M / PHOBOS_ORBIT_M, false),
    }
}

/// Sunlight that a white Lambert surface square to it reflects, W m-2 sr-1 um-1.
pub(super) fn white_radiance(scene: &Setup, um: f64) -> Option<f64> {
    let normal = scene.sky.sun.irradiance_w_m2_um(um)?;
    Some(Lambert { reflectance: 1.0 }.brdf() * normal)
}

/// Sunlight that a material reflects at an incidence, W m-2 sr-1 um-1.
fn sunlit_radiance(scene: &Setup, material: &Material, um: f64, cos_incidence: f64) -> Option<f64> {
    Some(material.reflectance.at(um)? * sun::irradiance_on_facet(white_radiance(scene, um)?, cos_incidence))
}

/// Thermal emission of a material, W m-2 sr-1 um-1.
pub(super) fn emission(material: &Material, um: f64, t_k: f64) -> f64 {
    material.emissivity.at(um).unwrap_or(1.0) * blackbody::radiance_w_m2_sr_um(um, t_k)
}

/// Median over the pixels that are sunlit for the most part; over all that have any light if none are.
fn median_cos_incidence(backplanes: &Backplanes) -> Option<f64> {
    let (incidence, lit) = (backplanes.plane("LOCALINCIDENCE_MEAN")?, backplanes.plane("LIT_FRACTION")?);
    let cosines = |least: f64| -> Vec<f64> {
        let pixels = incidence.values.iter().zip(&lit.values);
        let lit = pixels.filter(|(_, lit)| **lit > least).map(|(i, _)| i.to_radians().cos());
        lit.filter(|cos| *cos > 0.0).collect()
    };
    let mut cosines = [0.5, 0.0].into_iter().map(cosines).find(|c| !c.is_empty())?;
    let middle = cosines.len() / 2;
    Some(*cosines.select_nth_unstable_by(middle, f64::total_cmp).1)
}
