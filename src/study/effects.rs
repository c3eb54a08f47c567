//! What shapes the light, modelled or not, each with a bound of what that costs.
//!
//! Bounds are relative to the **median sunlit radiance**: sunlight reflected by the same material at the median incidence of
//! the sunlit pixels, in the worst band and material. A pixel in shadow may change by more of its own radiance.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::site::Site;
use crate::geometry::{Direction, angle_rad};
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::physics::reflectance::{Brdf, PhotometricAngles};
use crate::physics::sun::{self, Eclipse};
use crate::physics::{blackbody, bounds, heat};
use crate::product::{Backplanes, FacetTable};
use crate::scene::{MARS_ALBEDO, MarsModel, Material, Scene, Thermal};
use crate::solve;
use crate::spectral::Light;
use crate::units::{MARS_RADIUS_M, PHOBOS_ORBIT_M};

/// Something that shapes the light, modelled or left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Its name.
    pub name: String,
    /// Whether it is in the result.
    pub modelled: bool,
    /// By at most this share of the median sunlit radiance would a sunlit pixel change with it (if left out) or without its
    /// approximations (if modelled), in the worst band; null: not known.
    pub bound: Option<f64>,
    /// How it is modelled, or why it is left out, and what the bound is of.
    pub note: String,
}

/// A bound of as much as all the sunlight, or more, tells nothing apart.
const USELESS: f64 = 1.0;

/// Says so of an effect whose bound is useless.
fn ranked(effect: Effect) -> Effect {
    match effect.bound {
        Some(bound) if bound >= USELESS => Effect { note: format!("not bounded usefully: {}", effect.note), ..effect },
        _ => effect,
    }
}

/// Shadows and fractions are exact to this, relative: what the tests hold them to.
const ROUNDING: f64 = 1e-9;
/// Stellar aberration at Mars: its largest orbital speed and Phobos' own, 28.6 km/s, over that of light; rad.
const ABERRATION_RAD: f64 = 9.6e-5;

/// What the bounds are made from.
pub(super) struct Account<'a> {
    pub(super) scene: &'a Scene,
    pub(super) table: &'a FacetTable,
    pub(super) site: &'a Site,
    /// Median cosine of incidence of the sunlit pixels; `None` if nothing that is seen is lit.
    pub(super) cos_incidence: Option<f64>,
    /// Share of the site that terrain outside it might shadow.
    pub(super) open_to_shadow: f64,
    pub(super) eclipse: Option<Eclipse>,
    /// The largest of the table's irradiances by Mars, over Mars' reflectance times the solar irradiance.
    pub(super) largest_mars_irradiance: f64,
    /// The warmest temperature of the table, K; 0 without one.
    pub(super) warmest_k: f64,
    /// The warmest that any facet gets in a day, K: in equilibrium with sunlight at normal incidence, and as much heat from
    /// Mars as it can send; or the warmest of the table.
    noon_k: f64,
    materials: Vec<&'a Material>,
    /// Where spectra are looked at, um, and what light the band has: centres of the bands, and ends and corners of their tables in those that
    /// are wide.
    bands_um: Vec<(f64, Light)>,
}

/// Whether Mars covers the Sun; `None` without Mars.
pub(super) fn eclipse(scene: &Scene) -> Option<Eclipse> {
    let mars = scene.sky.mars.as_ref()?;
    let (towards_m, sun_rad) = (Direction::new(mars.centre_m)?, sun::angular_radius_rad(scene.sky.sun.distance_m));
    let separation_rad = scene.sky.sun.direction.angle_rad(towards_m);
    Some(sun::eclipse(separation_rad, (mars.radius_m / mars.centre_m.length()).asin(), sun_rad))
}

impl<'a> Account<'a> {
    pub(super) fn new(scene: &'a Scene, table: &'a FacetTable, site: &'a Site, backplanes: &Backplanes) -> Self {
        let mut used = vec![false; scene.body.materials.len()];
        scene.body.mesh.material.iter().for_each(|m| used[m.0 as usize] = true);
        let materials: Vec<&Material> =
            scene.body.materials.iter().zip(used).filter(|(_, used)| *used).map(|(m, _)| m).collect();
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let warmest_k = largest(&table.temperature_lit_k).max(largest(&table.temperature_shaded_k));
        let total_w_m2 = sun::irradiance_at(scene.sky.sun.total_irradiance_1au_w_m2, scene.sky.sun.distance_m);
        let (q, _) = mars_seen(scene, site);
        let at_noon_k = |m: &&Material| {
            let absorbed_w_m2 = (1.0 - m.bond_albedo + q * q) * total_w_m2;
            heat::equilibrium_temperature_k(absorbed_w_m2, m.emissivity_bolometric)
        };
        let noon_k = materials.iter().map(at_noon_k).fold(warmest_k, f64::max);
        Account {
            scene,
            table,
            site,
            cos_incidence: median_cos_incidence(backplanes),
            open_to_shadow: site.open_to_shadow(&scene.body.mesh, scene.sky.sun.direction.vec()),
            eclipse: eclipse(scene),
            largest_mars_irradiance: table.of("mars").map_or(0.0, |mars| largest(&mars.irradiance)),
            warmest_k,
            noon_k,
            bands_um: bands_um(scene, &materials),
            materials,
        }
    }

    pub(super) fn effects(&self) -> Vec<Effect> {
        let effects = vec![
            self.sunlight(),
            self.photometry(),
            self.mars_light(),
            self.mars_light_shadows(),
            self.thermal_emission(),
            self.thermal_inertia(),
            self.heat_from_mars(),
            self.interreflection(),
            self.penumbra(),
            self.terrain_outside(),
            self.eclipse_by_mars(),
            self.aberration(),
            left_out(
                "instrument",
                None,
                "the cube is radiance at the aperture: no PSF, distortion, smear, stray light or noise",
            ),
        ];
        effects.into_iter().map(|effect| self.of_no_band(effect)).map(ranked).collect()
    }

    /// What is in none of the bands changes nothing.
    fn of_no_band(&self, effect: Effect) -> Effect {
        const OF_SUNLIGHT: [&str; 4] = ["sunlight", "photometric function", "Mars-light", "shadows in Mars-light"];
        const OF_HEAT: [&str; 3] = ["thermal emission", "thermal inertia", "heat from Mars"];
        let has = |is: fn(Light) -> bool| self.bands_um.iter().any(|(_, light)| is(*light));
        let absent = |names: &[&str], is| names.contains(&effect.name.as_str()) && !has(is);
        let note = match (absent(&OF_SUNLIGHT, Light::is_lit), absent(&OF_HEAT, Light::glows)) {
            (true, _) => "no band has sunlight",
            (_, true) => "no band has heat",
            (false, false) => return effect,
        };
        left_out(&effect.name, Some(0.0), note)
    }

    fn sunlight(&self) -> Effect {
        let note = "point source; exact shadows and areas of plane facets. The spectrum is an input: E490 is uncertain by 1 to 3 % \
                    below 2 um, 3 to 5 % above 2.5 um";
        modelled("sunlight", Some(ROUNDING), note)
    }

    fn photometry(&self) -> Effect {
        let camera_m = self.scene.exposure.camera.centre_m();
        let phase_deg = angle_rad(camera_m, self.scene.sky.sun.direction.vec()).to_degrees();
        let note = format!(
            "surfaces are Lambert, and smooth below the size of a facet. No bound without a photometric function: one fitted to Phobos \
             gives 0.37 times the radiance of a Lambert surface of its geometric albedo at 30 deg phase, 0.25 at 60 deg; here the \
             phase angle at the origin is {phase_deg:.1} deg"
        );
        left_out("photometric function", None, note)
    }

    fn mars_light(&self) -> Effect {
        let bound = self.mars_light_bound();
        let is_lit_by_mars = self.scene.sky.mars.is_some() && self.table.of("mars").is_some();
        match is_lit_by_mars.then_some(self.scene.models.mars_light) {
            Some(MarsModel::NearField) => modelled(
                "Mars-light",
                bound.map(|b| b * MARS_LIGHT_ERROR),
                "a Lambert sphere near at hand with its phase, tilt and horizon of each facet; uniform and without air: the albedo is an input",
            ),
            Some(MarsModel::Thesis) => modelled(
                "Mars-light",
                bound.map(|b| 2.0 * b),
                "Domagala (2020), equations (4) to (8) as printed: no phase, no horizon; 2.4 times the light of a full Lambert sphere",
            ),
            None => left_out(
                "Mars-light",
                bound,
                format!(
                    "no Mars in the scene: the bound is that of a full Mars of albedo {MARS_ALBEDO} over Phobos. It is the main light in shadows that face Mars"
                ),
            ),
        }
    }

    fn mars_light_shadows(&self) -> Effect {
        let bound = match &self.scene.sky.mars {
            Some(_) if self.largest_mars_irradiance == 0.0 => Some(0.0),
            _ => self.mars_light_bound(),
        };
        left_out(
            "shadows in Mars-light",
            bound,
            "a facet's own horizon cuts Mars, other terrain does not: up to all of the Mars-light",
        )
    }

    fn thermal_emission(&self) -> Effect {
        let (warmest_k, noon_k) = (self.warmest_k, self.noon_k);
        match self.scene.models.thermal {
            Thermal::Off => left_out(
                "thermal emission",
                self.emitted(noon_k),
                format!("off: the bound is the emission of a facet under the Sun at its zenith, {noon_k:.1} K"),
            ),
            Thermal::Thesis => modelled(
                "thermal emission",
                self.emitted(noon_k),
                "Domagala (2020), equation (9): 150 to 330 K at any distance from the Sun; the bound is all of the emission",
            ),
            Thermal::Equilibrium => modelled(
                "thermal emission",
                self.largest_up_to(warmest_k, |um, m, t_k| {
                    solve::interpolation_error(um, t_k).min(1.0) * emission(m, um, t_k)
                }),
                format!(
                    "each facet in equilibrium with what it absorbs, its lit and shaded parts apart; up to {warmest_k:.1} K. The bound is \
                         of the interpolation in temperature; see thermal inertia for the rest"
                ),
            ),
        }
    }

    fn thermal_inertia(&self) -> Effect {
        let noon_k = self.noon_k;
        left_out(
            "thermal inertia",
            self.emitted(noon_k),
            format!(
                "no heat is stored, conducted or exchanged between facets. The bound is the emission at {noon_k:.1} K, of a facet \
                 under the Sun at its zenith: what a fresh shadow might still send, and more than equilibrium can be wrong in sunlight"
            ),
        )
    }

    fn heat_from_mars(&self) -> Effect {
        let (q, has_mars) = mars_seen(self.scene, self.site);
        let scene = self.scene;
        let total_w_m2 = sun::irradiance_at(scene.sky.sun.total_irradiance_1au_w_m2, scene.sky.sun.distance_m);
        // Reflected or emitted, Mars sends no more than sunlight at its zenith.
        let bound = self.largest_up_to(self.noon_k, |um, m, t_k| {
            let own_w_m2 = heat::emitted_w_m2(t_k, m.emissivity_bolometric);
            let heated_k = heat::equilibrium_temperature_k(own_w_m2 + q * q * total_w_m2, m.emissivity_bolometric);
            emission(m, um, heated_k) - emission(m, um, t_k)
        });
        match scene.models.thermal {
            Thermal::Equilibrium if has_mars => modelled(
                "heat from Mars",
                bound,
                "sunlight that Mars reflects, and its mean thermal exitance on day and night side alike; the bound is all of it",
            ),
            Thermal::Equilibrium => {
                left_out("heat from Mars", bound, "no Mars in the scene: the bound is that of a full Mars over Phobos")
            }
            _ => left_out("heat from Mars", bound, "the thermal model has no heat balance"),
        }
    }

    fn interreflection(&self) -> Effect {
        let form_factor = bounds::surroundings_form_factor(self.site.cos_steepest);
        let bound = self.cos_incidence.and_then(|cos| {
            let at = |um, light: Light| {
                let largest = |of: &dyn Fn(&Material) -> f64| self.materials.iter().map(|m| of(m)).fold(0.0, f64::max);
                let reflectance = largest(&|m| m.reflectance.at(um).unwrap_or(0.0));
                let heat = if light.glows() { largest(&|m| emission(m, um, self.noon_k)) } else { 0.0 };
                let emitted = heat / white_radiance(self.scene, um)?;
                let bounded = reflectance * form_factor < 1.0;
                bounded.then(|| bounds::interreflection(reflectance, emitted, form_factor, cos))
            };
            self.bands_um.iter().try_fold(0.0, |most, (um, light)| Some(f64::max(most, at(*um, *light)?)))
        });
        let slopes = match self.site.up {
            Some(_) => format!("slopes up to {:.0} deg", self.site.cos_steepest.acos().to_degrees()),
            None => "a body may have any slope".to_owned(),
        };
        let note = format!(
            "the surroundings fill at most {:.0} % of a facet's view ({slopes}), all of them taken as lit at normal incidence and \
             as warm as {:.1} K. On gentle ground the truth is 10 to 100 times less; in shadow it is often the only light",
            100.0 * form_factor,
            self.noon_k,
        );
        left_out("interreflection", bound, note)
    }

    fn penumbra(&self) -> Effect {
        let (ray_m, pixel_m) = (self.longest_ray_m(), self.pixel_m());
        let sun_rad = sun::angular_radius_rad(self.scene.sky.sun.distance_m);
        // Square to the rays. On a slope the penumbra is wider by 1 / cos i, and as much less bright.
        let wide_px = bounds::penumbra_width_m(ray_m, sun_rad, 1.0) / pixel_m;
        let note = format!(
            "the Sun is a point. Only pixels that a shadow's edge crosses change, and slopes along the rays: with the edge's cause at \
             most {ray_m:.0} m away, penumbrae are up to {wide_px:.2} pixels wide, square to the light"
        );
        let edge = self.all_light().map(|all| wide_px.min(1.0) * all);
        let slope = self.cos_incidence.map(|cos| bounds::terminator(sun_rad) / cos);
        left_out("the Sun's disc", edge.zip(slope).map(|(edge, slope)| edge + slope), note)
    }

    fn terrain_outside(&self) -> Effect {
        let share = 100.0 * self.open_to_shadow;
        let (bound, note) = match self.site.up {
            None => (Some(0.0), "the mesh is a body: there is none".to_owned()),
            Some(_) if share == 0.0 => {
                (Some(0.0), "every ray to the Sun leaves the site above its highest point".to_owned())
            }
            Some(_) => (
                self.all_light(),
                format!(
                    "from {share:.1} % of the site's area rays to the Sun leave it below its highest point: these might be in shadow"
                ),
            ),
        };
        left_out("terrain outside the mesh", bound, note)
    }

    fn eclipse_by_mars(&self) -> Effect {
        let (bound, note) = match self.eclipse {
            None => (None, "no Mars in the scene: cannot be said"),
            Some(Eclipse::None) => (Some(0.0), "Mars is not in front of the Sun"),
            Some(Eclipse::Partial) => {
                (self.all_light(), "Mars covers part of the Sun's disc: the site has less sunlight")
            }
            Some(Eclipse::Total) => (self.all_light(), "Mars covers the Sun: the site has no sunlight"),
        };
        left_out("eclipse by Mars", bound, note)
    }

    fn aberration(&self) -> Effect {
        // Of irradiance, and of shadows' edges. Emission follows irradiance by a power that makes it 2 at most, up to 20 um.
        let share = (ABERRATION_RAD * (1.0 + self.longest_ray_m() / self.pixel_m())).min(1.0);
        let bound = self.all_light().map(|all| 2.0 * share * all);
        let note = "directions and distances are taken as given. Apparent ones of one instant need nothing more; geometric ones are off by \
                    up to 1e-4 rad, a sixtieth of the Sun's disc: by so much shadows' edges move too";
        left_out("aberration and light time", bound, note)
    }

    /// Most that a facet sends by sunlight: reflected at normal incidence, and emitted when warmest; relative as all bounds.
    fn all_light(&self) -> Option<f64> {
        let reflected = if self.lit_um().next().is_some() { 1.0 / self.cos_incidence? } else { 0.0 };
        Some(reflected + self.emitted(self.noon_k)?)
    }

    /// Where bands have sunlight, um.
    fn lit_um(&self) -> impl Iterator<Item = f64> {
        self.bands_um.iter().filter(|(_, light)| light.is_lit()).map(|(um, _)| *um)
    }

    /// Longest way, m, from what casts a shadow to where it falls.
    fn longest_ray_m(&self) -> f64 {
        self.site.longest_ray_m(self.site.up.map_or(0.0, |up| up.dot(self.scene.sky.sun.direction.vec())))
    }

    /// Width of a pixel at the nearest point of the surface, square to the line of sight, m.
    fn pixel_m(&self) -> f64 {
        let camera = &self.scene.exposure.camera;
        self.site.distance_m(camera.centre_m()) * camera.mean_pitch()
    }

    fn mars_light_bound(&self) -> Option<f64> {
        let (q, _) = mars_seen(self.scene, self.site);
        let albedo = match &self.scene.sky.mars {
            Some(mars) => self.lit_um().filter_map(|um| mars.reflectance.at(um)).fold(0.0, f64::max),
            None => MARS_ALBEDO,
        };
        self.cos_incidence.map(|cos| bounds::mars_light(albedo, q, cos))
    }

    /// What a surface at a temperature emits, relative to the median sunlit radiance.
    fn emitted(&self, t_k: f64) -> Option<f64> {
        self.largest(|um, m| emission(m, um, t_k))
    }

    /// As [`largest`](Account::largest), also over temperatures up to the warmest: warm surfaces emit most, but may change least.
    fn largest_up_to(&self, warmest_k: f64, radiance: impl Fn(f64, &Material, f64) -> f64) -> Option<f64> {
        const STEPS: u32 = 16;
        let at = |um, m: &Material, i| radiance(um, m, warmest_k * f64::from(i) / f64::from(STEPS));
        self.largest(|um, m| (1..=STEPS).map(|i| at(um, m, i)).fold(0.0, f64::max))
    }

    /// The largest ratio, over bands with heat and materials, of a radiance (of wavelength, um, and material; W m-2 sr-1 um-1) to the
    /// median sunlit radiance.
    fn largest(&self, radiance: impl Fn(f64, &Material) -> f64) -> Option<f64> {
        let cos = self.cos_incidence?;
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
fn bands_um(scene: &Scene, materials: &[&Material]) -> Vec<(f64, Light)> {
    let of_materials = materials.iter().flat_map(|m| [&m.reflectance, &m.emissivity]);
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
pub(super) fn mars_seen(scene: &Scene, site: &Site) -> (f64, bool) {
    match &scene.sky.mars {
        Some(mars) => ((mars.radius_m / site.distance_m(mars.centre_m)).min(1.0), true),
        None => (MARS_RADIUS_M / PHOBOS_ORBIT_M, false),
    }
}

/// Sunlight that a white Lambert surface square to it reflects, W m-2 sr-1 um-1.
fn white_radiance(scene: &Scene, um: f64) -> Option<f64> {
    let normal = sun::irradiance_at(scene.sky.sun.irradiance_1au.at(um)?, scene.sky.sun.distance_m);
    let angles = PhotometricAngles { cos_incidence: 1.0, cos_emission: 1.0, phase_rad: 0.0 };
    Some(Brdf::Lambert { reflectance: 1.0 }.eval(&angles) * normal)
}

/// Sunlight that a material reflects at an incidence, W m-2 sr-1 um-1.
fn sunlit_radiance(scene: &Scene, material: &Material, um: f64, cos_incidence: f64) -> Option<f64> {
    Some(material.reflectance.at(um)? * sun::irradiance_on_facet(white_radiance(scene, um)?, cos_incidence))
}

/// Thermal emission of a material, W m-2 sr-1 um-1.
fn emission(material: &Material, um: f64, t_k: f64) -> f64 {
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

fn modelled(name: &str, bound: Option<f64>, note: impl Into<String>) -> Effect {
    Effect { name: name.to_owned(), modelled: true, bound, note: note.into() }
}

fn left_out(name: &str, bound: Option<f64>, note: impl Into<String>) -> Effect {
    Effect { name: name.to_owned(), modelled: false, bound, note: note.into() }
}
