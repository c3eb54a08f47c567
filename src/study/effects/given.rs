//! What bounds are made from: a scene, what its camera may see, and what an error is relative to.

use super::{Bound, by_globes};
use crate::geometry::Direction;
use crate::physics::bounds;
use crate::physics::mars_directions::Directions;
use crate::physics::reflectance::{Brdf, Lambert};
use crate::physics::sun::Eclipse;
use crate::physics::{blackbody, heat};
use crate::scene::{Globe, MarsModel, Material, Models, Setup, Sky, Thermal};
use crate::spectral::{Light, Spectrum};
use crate::study::cost;
use crate::study::draft::Draft;
use crate::study::extremes::{BodySeen, Class, Extremes, Sunlit};
use crate::units::{MARS_RADIUS_M, PHOBOS_ORBIT_M};

/// The least radiance that an error is relative to, over the band's median sunlit radiance.
pub(in crate::study) const FLOOR: f64 = 0.01;

/// So many places stand for what is sunlit.
const PLACES: usize = 1024;
/// Wavelengths that are closer, relative, are looked at once,
const SPACING: f64 = 0.005;
/// if no spectrum changes by more between them, relative.
const ALIKE: f64 = 0.02;
/// Heat is looked at as that of such a surface, K.
const WARM_K: f64 = 300.0;

/// Directions of view that stand for an image.
const MOST_VIEWS: usize = 16;
/// Those that differ by less, rad, are one: surges are not much narrower.
const SAME_VIEW_RAD: f64 = 0.02;

/// What the bounds are made from.
#[derive(Clone)]
pub(in crate::study) struct Given<'a> {
    /// What it is, and what it states; which of that is computed, `models` say.
    pub(in crate::study) scene: &'a Setup,
    pub(in crate::study) models: Models,
    pub(in crate::study) extremes: &'a Extremes,
    /// The warmest that any facet gets in a day, K: in equilibrium with sunlight at normal incidence, as much heat from Mars as it can
    /// send, and all that its surroundings can.
    pub(super) noon_k: f64,
    /// Materials that some facet has, with their places in the scene.
    pub(super) materials: Vec<(usize, &'a Material)>,
    /// Where spectra are looked at: centres of the bands, and ends and corners of their tables in those that are wide.
    pub(super) wavelengths: Vec<Wavelength>,
    /// A bound, from below, of the radiance of facets in sunlight, of each wavelength, material and class, in this order: what is modelled beside sunlight and heat
    /// adds.
    least: Vec<f64>,
    median_brightness: f64,
    /// What is sunlit of the image: its material, its brightness, and its temperature, K.
    sunlit: Vec<(&'a Material, f64, f64)>,
    /// How dark pixels are at most, if that is known.
    draft: Option<&'a Draft>,
}

/// Where on a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// Where the Sun lights it.
    Sun,
    /// Where it does not, whatever the facet's direction.
    Shade,
}

impl Side {
    /// The largest cosine of incidence there.
    pub(super) fn most_cos_incidence(self, class: &Class) -> f64 {
        if self == Side::Sun { class.most_cos_incidence } else { 0.0 }
    }
}

/// Facets whose radiance changes.
#[derive(Clone, Copy)]
pub(super) struct Place<'g> {
    pub(super) at: &'g Wavelength,
    pub(super) material: &'g Material,
    pub(super) class: &'g Class,
    pub(super) side: Side,
    /// What the change is relative to, at the least, W m-2 sr-1 um-1.
    pub(super) least: f64,
}

/// A wavelength of a band.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wavelength {
    pub(super) um: f64,
    pub(super) light: Light,
    /// Sunlight that a white Lambert surface square to it reflects, W m-2 sr-1 um-1.
    pub(super) white: f64,
    /// Median radiance of what is sunlit; 0 if nothing is.
    pub(super) median: f64,
    /// The largest reflectance of any material.
    pub(super) brightest: f64,
}

impl<'a> Given<'a> {
    /// `sunlit` are places of the image: of extremes, or, once it is there, of the image itself.
    pub(in crate::study) fn new(scene: &'a Setup, extremes: &'a Extremes, sunlit: &[Sunlit]) -> Self {
        let materials: Vec<_> = scene.body.materials.iter().enumerate().filter(|(i, _)| extremes.is_used[*i]).collect();
        let mut given = Given {
            scene,
            models: scene.models,
            extremes,
            noon_k: 0.0,
            wavelengths: vec![],
            least: vec![],
            materials,
            median_brightness: median(sunlit.iter().map(|place| place.brightness)).unwrap_or(1.0),
            sunlit: vec![],
            draft: None,
        };
        let others_w_m2 = given.mars_w_m2(given.most_of_mars())
            + given.bodies_w_m2()
            + given.lamps_w_m2()
            + given.around_w_m2(given.most_around());
        let noon_k = |(_, m): &(usize, &Material)| given.temperature_k(m, 1.0, others_w_m2);
        given.noon_k = given.materials.iter().map(noon_k).fold(0.0, f64::max);
        let is_dimmed = matches!(by_globes(scene), Some(Eclipse::Partial | Eclipse::Total));
        given.sunlit = sunlit
            .iter()
            .step_by(sunlit.len().div_ceil(PLACES).max(1))
            .map(|place| {
                let material = &scene.body.materials[place.material];
                (material, place.brightness, given.temperature_k(material, place.cos_incidence, 0.0))
            })
            .collect();
        let at = |(um, light)| {
            let mut at = given.wavelength(um, light);
            // In an eclipse there is no telling what sunlight errors are relative to.
            at.median = if is_dimmed { 0.0 } else { given.median_at(um, light) };
            at
        };
        given.wavelengths = wavelengths(scene, &given.materials).into_iter().map(at).collect();
        given.least = given.least();
        given
    }

    /// Without a median yet.
    fn wavelength(&self, um: f64, light: Light) -> Wavelength {
        let brightest = self.materials.iter().map(|(_, material)| reflectance(material, um)).fold(0.0, f64::max);
        Wavelength { um, light, white: white_radiance(self.scene, um), median: 0.0, brightest }
    }

    /// Median radiance of what is sunlit, W m-2 sr-1 um-1; 0 if nothing is.
    pub(in crate::study) fn median_at(&self, um: f64, light: Light) -> f64 {
        let at = self.wavelength(um, light);
        let sent = self.sunlit.iter().map(|(material, brightness, t_k)| self.sent_at(&at, material, *brightness, *t_k));
        median(sent).unwrap_or(0.0)
    }

    /// With what is known of an image of these places.
    pub(in crate::study) fn with_draft(mut self, draft: Option<&'a Draft>) -> Self {
        for at in &mut self.wavelengths {
            at.median *= draft.map_or(1.0, |draft| draft.median_at(at.um, at.light));
        }
        Given { draft, ..self }
    }

    /// The same by other models.
    pub(in crate::study) fn by(&self, models: Models) -> Self {
        let mut given = Given { models, ..self.clone() };
        given.least = given.least();
        given
    }

    /// Where spectra are looked at, and the median sunlit radiance there: um, its light, W m-2 sr-1 um-1.
    pub(in crate::study) fn references(&self) -> Vec<(f64, Light, f64)> {
        self.wavelengths.iter().map(|at| (at.um, at.light, at.median)).collect()
    }

    fn least(&self) -> Vec<f64> {
        // What conducts may be colder than in equilibrium.
        let is_warm = self.models.conduction.is_none();
        // A texel may be black.
        let materials = &self.scene.body.materials;
        let is_textured = |material: &Material| {
            let mut textures = self.scene.body.textures.iter();
            textures.any(|texture| std::ptr::eq(&materials[texture.material.0 as usize], material))
        };
        let classes: Vec<_> = self
            .lit()
            .map(|(material, class)| {
                if is_textured(material) {
                    return (material, 0.0, 0.0);
                }
                let t_k = if is_warm { self.temperature_k(material, class.least_cos_incidence, 0.0) } else { 0.0 };
                (material, class.least_brightness, t_k)
            })
            .collect();
        let of = |at: &Wavelength| {
            classes
                .iter()
                .map(|(material, brightness, t_k)| self.sent_at(at, material, *brightness, *t_k))
                .collect::<Vec<_>>()
        };
        self.wavelengths.iter().flat_map(of).collect()
    }

    /// In equilibrium with sunlight at this cosine of incidence, and more heat, W m-2, no colder than the floor; or held.
    pub(super) fn temperature_k(&self, material: &Material, cos_incidence: f64, more_w_m2: f64) -> f64 {
        if let Some(held_k) = material.temperature_k {
            return held_k;
        }
        let absorbed_w_m2 = self.absorbed_w_m2(material, cos_incidence) + more_w_m2;
        heat::equilibrium_temperature_k(absorbed_w_m2, material.emissivity_bolometric).max(self.scene.models.floor_k)
    }

    fn absorbed_w_m2(&self, material: &Material, cos_incidence: f64) -> f64 {
        (1.0 - material.bond_albedo) * cos_incidence * self.scene.sky.sun.total_irradiance_w_m2()
    }

    /// More heat, W m-2, that makes a facet emit this radiance; negative if it does without any.
    pub(super) fn heat_to_emit(&self, at: &Wavelength, material: &Material, cos_incidence: f64, radiance: f64) -> f64 {
        let t_k = blackbody::temperature_k(at.um, radiance / material.emissivity.at(at.um).unwrap_or(1.0));
        heat::emitted_w_m2(t_k, material.emissivity_bolometric) - self.absorbed_w_m2(material, cos_incidence)
    }

    /// A bound of the form factor of Mars, or of one over Phobos.
    pub(super) fn most_of_mars(&self) -> f64 {
        let (sin_radius, _) = mars_seen(self.scene, self.extremes);
        sin_radius * sin_radius
    }

    /// A bound of what Mars, or one over Phobos, warms a facet by that has this form factor of it: by light and heat, W m-2.
    pub(super) fn mars_w_m2(&self, of_mars: f64) -> f64 {
        let sun_w_m2 = self.scene.sky.sun.total_irradiance_w_m2();
        // That of the thesis has no phase, and more than twice the light.
        let times = if self.models.mars_light == MarsModel::Thesis { 2.0 } else { 1.0 };
        let exitance_w_m2 = self
            .scene
            .sky
            .mars
            .as_ref()
            .map_or(sun_w_m2, |mars| times * mars.bond_albedo * sun_w_m2 + mars.thermal_exitance_w_m2);
        of_mars * exitance_w_m2
    }

    /// The same of further bodies that a facet faces all at once.
    pub(super) fn bodies_w_m2(&self) -> f64 {
        let bodies = self.scene.sky.bodies.iter().zip(&self.extremes.bodies);
        bodies.map(|(globe, seen)| self.body_w_m2(globe, seen)).sum()
    }

    /// The same of one of them.
    pub(super) fn body_w_m2(&self, globe: &Globe, seen: &BodySeen) -> f64 {
        globe.bond_albedo * seen.light * self.scene.sky.sun.total_irradiance_w_m2()
            + globe.thermal_exitance_w_m2 * seen.form_factor
    }

    /// What lamps warm a facet by that faces all of them, W m-2.
    pub(super) fn lamps_w_m2(&self) -> f64 {
        self.scene.sky.beams.iter().map(|beam| beam.total_irradiance_w_m2).sum()
    }

    /// What surroundings of this form factor warm a facet by at most, W m-2: on average they send no more than white ones that face all light and heat there is,
    /// and what emits most of those that are held at a temperature.
    pub(super) fn around_w_m2(&self, form_factor: f64) -> f64 {
        let sun_w_m2 = self.scene.sky.sun.total_irradiance_w_m2();
        let held = |(_, m): &(usize, &Material)| Some(heat::emitted_w_m2(m.temperature_k?, m.emissivity_bolometric));
        let held_w_m2 = self.materials.iter().filter_map(held).fold(0.0, f64::max);
        let from_sky_w_m2 = sun_w_m2 + self.lamps_w_m2() + self.mars_w_m2(self.most_of_mars()) + self.bodies_w_m2();
        form_factor * (from_sky_w_m2 + held_w_m2)
    }

    /// What may warm a facet of such a class besides the Sun, W m-2.
    pub(super) fn others_w_m2(&self, class: &Class) -> f64 {
        self.mars_w_m2(class.most_of_mars)
            + self.bodies_w_m2()
            + self.lamps_w_m2()
            + self.around_w_m2(class.most_around)
    }

    /// Radiance of a white Lambert surface that faces the Sun, lamps, Mars and further bodies all at once, W m-2 sr-1 um-1.
    pub(super) fn most_white(&self, at: &Wavelength) -> f64 {
        let albedo = |globe: &Globe| globe.reflectance.at(at.um).unwrap_or(f64::NAN);
        let of_mars = self.scene.sky.mars.as_ref().map_or(0.0, |mars| 2.0 * albedo(mars) * self.most_of_mars());
        let of_body = |(globe, seen): (&Globe, &BodySeen)| {
            let warmest_k = globe.day_night_k[0].max(globe.day_night_k[1]);
            let glow = if at.light.glows() { blackbody::radiance_w_m2_sr_um(at.um, warmest_k) } else { 0.0 };
            at.white * albedo(globe) * seen.light + glow * seen.form_factor
        };
        let of_bodies: f64 = self.scene.sky.bodies.iter().zip(&self.extremes.bodies).map(of_body).sum();
        let white = Lambert { reflectance: 1.0 }.brdf();
        let of_lamps: f64 =
            self.scene.sky.beams.iter().map(|beam| white * beam.irradiance.at(at.um).unwrap_or(0.0)).sum();
        at.white * (1.0 + of_mars) + of_bodies + of_lamps
    }

    /// A bound of the form factor of any facet's surroundings.
    pub(super) fn most_around(&self) -> f64 {
        self.extremes.site.most_around()
    }

    /// Radiance of what the Sun lights, W m-2 sr-1 um-1: reflected, and emitted in equilibrium with that alone.
    pub(super) fn sent(&self, at: &Wavelength, material: &Material, brightness: f64, cos_incidence: f64) -> f64 {
        self.sent_at(at, material, brightness, self.temperature_k(material, cos_incidence, 0.0))
    }

    /// The same at a temperature, K.
    fn sent_at(&self, at: &Wavelength, material: &Material, brightness: f64, t_k: f64) -> f64 {
        let reflected = if at.light.is_lit() { reflectance(material, at.um) * at.white * brightness } else { 0.0 };
        let emits = [self.scene.models.thermal, self.models.thermal] == [Thermal::Equilibrium; 2];
        let is_warm = at.light.glows() && emits;
        reflected + if is_warm { emission(material, at.um, t_k) } else { 0.0 }
    }

    /// The classes of each material that the Sun may shine on.
    fn lit(&self) -> impl Iterator<Item = (&'a Material, &'a Class)> {
        let facing = &self.extremes.facing;
        self.materials.iter().flat_map(move |(i, material)| facing[*i].lit.iter().map(move |class| (*material, class)))
    }

    /// Those of which a part may be in shadow.
    fn shaded(&self) -> impl Iterator<Item = (&'a Material, &'a Class)> {
        let facing = &self.extremes.facing;
        self.materials
            .iter()
            .flat_map(move |(i, material)| facing[*i].shaded.iter().map(move |class| (*material, class)))
    }

    /// The largest error of a pixel, of those that show nothing but sunlit ground and of the others, if the radiance of facets is wrong by so
    /// much, where the Sun lights them and where it does not, W m-2 sr-1 um-1.
    ///
    /// `None` if it has no bound: nothing is sunlit.
    pub(super) fn error(&self, change: impl Fn(&Place) -> f64) -> Option<Bound> {
        self.largest(change, |_| 0.0, false)
    }

    /// As [`Given::error`], if no pixel is darker without the change than in the draft of the image.
    pub(super) fn error_in_draft(&self, change: impl Fn(&Place) -> f64) -> Option<Bound> {
        self.largest(change, |_| 0.0, true)
    }

    /// As [`Given::error`], of light that is left out: a pixel has at least that light, so that no more than all of its radiance is missing.
    pub(super) fn error_without(&self, light: impl Fn(&Place) -> f64) -> Option<Bound> {
        let bound = self.largest(light, |light| light, true)?;
        Some(Bound { lit: bound.lit.min(1.0), shadow: bound.shadow.min(1.0) })
    }

    /// `more` is what a change says of the least radiance.
    fn largest(&self, change: impl Fn(&Place) -> f64, more: impl Fn(f64) -> f64, is_in_draft: bool) -> Option<Bound> {
        let mut most = Bound::NOTHING;
        let mut least = self.least.iter();
        for at in &self.wavelengths {
            let floor = FLOOR * at.median;
            // Where nothing is sunlit, there is nothing to be relative to.
            let relative = |change: f64, least: f64| {
                if floor > 0.0 { change / (least + more(change)).max(floor) } else { change / floor }
            };
            // Of what is brighter than the floor relative to itself, else to the floor; in one pixel both may be. A maximum passes over what is not a
            // number: a spectrum ends before the band does, and its part is left out.
            let (mut bright, mut dim, mut shade) = (0.0_f64, 0.0_f64, 0.0_f64);
            for ((material, class), least) in self.lit().zip(&mut least) {
                let change = change(&Place { at, material, class, side: Side::Sun, least: least.max(floor) });
                let part = if least + more(change) >= floor { &mut bright } else { &mut dim };
                *part = part.max(relative(change, *least));
            }
            for (material, class) in self.shaded() {
                let change = change(&Place { at, material, class, side: Side::Shade, least: floor });
                shade = shade.max(relative(change, 0.0));
            }
            let mut bound = Bound { lit: bright + dim, shadow: bright + dim + shade };
            if let Some(draft) = self.draft(at).filter(|_| is_in_draft && bound.most() > 0.0) {
                let by_draft = self.error_of_draft(at, draft, &change, &more);
                bound = Bound { lit: bound.lit.min(by_draft.lit), shadow: bound.shadow.min(by_draft.shadow) };
            }
            most = Bound { lit: most.lit.max(bound.lit), shadow: most.shadow.max(bound.shadow) };
        }
        (most.lit.is_finite() && most.shadow.is_finite()).then_some(most)
    }

    /// The least radiance of pixels that show nothing but sunlit ground, and of all, W m-2 sr-1 um-1.
    fn draft(&self, at: &Wavelength) -> Option<[f64; 2]> {
        // What conducts may be colder than in a draft, where all is in equilibrium.
        let holds = |draft: &&Draft| (draft.is_whole || self.models.conduction.is_none()) && at.median > 0.0;
        let draft = self.draft.filter(holds)?;
        Some(draft.least_at(at.um, at.light).map(|least| least * at.median))
    }

    /// The largest error at a wavelength if in pixels that are as dark as the darkest of a draft all of the surface changes most.
    fn error_of_draft(
        &self,
        at: &Wavelength,
        [lit, all]: [f64; 2],
        change: impl Fn(&Place) -> f64,
        more: impl Fn(f64) -> f64,
    ) -> Bound {
        let floor = FLOOR * at.median;
        let change_of =
            |(material, class), side, least: f64| change(&Place { at, material, class, side, least: least.max(floor) });
        let in_sun = |least: f64| self.lit().map(|of| change_of(of, Side::Sun, least)).fold(0.0, f64::max);
        let in_shade = |least: f64| self.shaded().map(|of| change_of(of, Side::Shade, least)).fold(0.0, f64::max);
        let over = |change: f64, least: f64| {
            // A draft has heat, and an image all that is modelled: it is not added again.
            let has_it = self.models.thermal == Thermal::Off || self.draft.is_some_and(|draft| draft.is_whole);
            let more = if has_it { 0.0 } else { more(change) };
            change / (least + more).max(floor)
        };
        // What may change of brighter pixels is no less.
        let in_sun = in_sun(lit);
        Bound { lit: over(in_sun, lit), shadow: over(in_sun.max(in_shade(all)), all) }
    }

    /// The largest error if edges of shadows move by this many pixels, square to the light: on a slope they move farther, by 1 / cos i.
    pub(super) fn error_of_edges(&self, width_px: f64) -> Option<Bound> {
        self.error(|&Place { at, material, class, .. }| {
            let share = (width_px / class.least_cos_incidence).min(1.0);
            share * self.sent(at, material, class.most_brightness, class.most_cos_incidence)
        })
    }

    /// The error if any light may be missing.
    pub(super) fn error_of_all(&self) -> Option<Bound> {
        self.error_without(|&Place { at, material, class, .. }| {
            self.sent(at, material, class.most_brightness, class.most_cos_incidence)
        })
    }

    /// A material by direction, at wavelengths, um: where only its albedo depends on wavelength at the darkest and the brightest, else at each; none of Lambert's.
    pub(super) fn brdfs(&self, material: &Material) -> Vec<(f64, Brdf)> {
        let lit = || self.wavelengths.iter().filter(|at| at.light.is_lit()).map(|at| at.um);
        let value = |um: &f64| reflectance(material, *um);
        let by_value = |a: &f64, b: &f64| value(a).total_cmp(&value(b));
        let all_um: Vec<f64> = match material.photometry.to_model() {
            Some(_) => lit().min_by(by_value).into_iter().chain(lit().max_by(by_value)).collect(),
            None => lit().collect(),
        };
        all_um.into_iter().filter_map(|um| Some((um, material.photometry.brdf(um)?))).collect()
    }

    /// Directions towards the camera from some places that it sees, those that differ.
    pub(super) fn views(&self) -> Vec<Direction> {
        let body = &self.scene.body;
        let (low_m, high_m) = body.bounds_m().unwrap_or_default();
        let eye_m = self.scene.exposure.camera.centre_m();
        let seen: Vec<usize> = self.extremes.glimpse.facets().collect();
        let step = seen.len().div_ceil(MOST_VIEWS).max(1);
        let places_m = seen.iter().step_by(step).map(|facet| body.mesh.facet(*facet).centroid_m());
        let mut views: Vec<Direction> = Vec::new();
        for place_m in std::iter::once(0.5 * (low_m + high_m)).chain(places_m) {
            if let Some(view) = Direction::new(eye_m - place_m)
                && views.iter().all(|other| other.angle_rad(view) > SAME_VIEW_RAD)
            {
                views.push(view);
            }
        }
        views
    }

    /// Longest way, m, from the edge that casts a shadow to where it falls.
    pub(super) fn throw_m(&self) -> f64 {
        let towards_sun = self.scene.sky.sun.direction.vec();
        let site = &self.extremes.site;
        self.extremes.throw_m.unwrap_or_else(|| site.longest_ray_m(site.up.map_or(0.0, |up| up.dot(towards_sun))))
    }

    /// How long, s, shadows may be taken to go steadily from where they are to where they will be, if the Sun goes on at this rate, rad/s: what a pixel's light is off
    /// by is then within a tolerance, over the median sunlit radiance.
    ///
    /// A straight edge that sweeps d across a pixel's border is off by at most d / 4 between the two: as behind a disc as wide as the Sun's way, of which a point
    /// misses half.
    pub(in crate::study) fn steady_s(&self, rate_rad_s: f64, tolerance: f64) -> f64 {
        let per_s =
            bounds::shadow_edge(0.5, 0.5 * rate_rad_s, self.throw_m(), self.pixel_m(), self.median_brightness());
        tolerance / per_s
    }

    /// Median brightness in sunlight of what is sunlit, over that of a Lambert surface under a Sun at the zenith; 1 if nothing is.
    pub(super) fn median_brightness(&self) -> f64 {
        self.median_brightness
    }

    /// CPU time, s, to find the shadows of one more Sun.
    pub(super) fn shadows_s(&self) -> f64 {
        cost::shadows_s(self.scene)
    }

    /// CPU time, s, that surfaces with models take for light from all of a globe.
    pub(super) fn directions_s(&self, globe: &Globe) -> f64 {
        if self.has_models() { cost::directions_s(self.scene, self.extremes, self.directions(globe)) } else { 0.0 }
    }

    /// From how many directions light comes to each part of a surface with a model, as the models at hand have it; 0 if no surface has one.
    pub(in crate::study) fn all_directions(&self) -> usize {
        let reflects = |globe: &&Globe| globe.name != Sky::MARS || self.models.mars_light != MarsModel::Off;
        let of_globes = self.scene.sky.globes().filter(reflects).map(|globe| self.directions(globe));
        if self.has_models() { 1 + of_globes.sum::<usize>() } else { 0 }
    }

    fn has_models(&self) -> bool {
        self.materials.iter().any(|(_, material)| material.photometry.key().is_some())
    }

    fn directions(&self, globe: &Globe) -> usize {
        Directions::for_size(globe.radius_m / self.extremes.site.distance_m(globe.centre_m)).count()
    }

    /// Width of a pixel at the nearest point of the surface, square to the line of sight, m.
    pub(super) fn pixel_m(&self) -> f64 {
        let camera = &self.scene.exposure.camera;
        self.extremes.site.distance_m(camera.centre_m()) * camera.mean_pitch()
    }
}

/// Centres of all bands; of wide ones also the ends, and the corners between them of reflectances and emissivities; um, ascending.
fn wavelengths(scene: &Setup, materials: &[(usize, &Material)]) -> Vec<(f64, Light)> {
    let parameters = materials.iter().flat_map(|(_, m)| m.photometry.parameters()).map(|(_, spectrum)| spectrum);
    let of_materials = materials.iter().flat_map(|(_, m)| [&m.reflectance, &m.emissivity]).chain(parameters);
    let mut corners_um: Vec<f64> = of_materials
        .chain(scene.sky.globes().map(|globe| &globe.reflectance))
        .chain(scene.sky.beams.iter().map(|beam| &beam.irradiance))
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
    // What a facet sends of each light, but for the Sun's spectrum, which all of them share.
    let spectra: Vec<&Spectrum> = materials
        .iter()
        .flat_map(|(_, m)| [&m.reflectance, &m.emissivity])
        .chain(materials.iter().flat_map(|(_, m)| m.photometry.parameters()).map(|(_, spectrum)| spectrum))
        .chain(scene.sky.globes().map(|globe| &globe.reflectance))
        .chain(scene.sky.beams.iter().map(|beam| &beam.irradiance))
        .collect();
    // Heat changes by more than any spectrum.
    let heat = |um: f64, light: Light| light.glows().then(|| blackbody::radiance_w_m2_sr_um(um, WARM_K));
    let values = |um: f64, light: Light| -> Vec<f64> {
        spectra.iter().map(|spectrum| spectrum.at(um).unwrap_or(0.0)).chain(heat(um, light)).collect()
    };
    let is_like = |(a, b): (&f64, &f64)| (a - b).abs() <= ALIKE * a.abs().max(b.abs());
    let mut kept: Vec<(f64, Light, Vec<f64>)> = Vec::new();
    for (um, light) in all_um {
        let values = values(um, light);
        let last = kept.iter().rev().find(|of| of.1 == light);
        let is_near = last.is_some_and(|of| um < (1.0 + SPACING) * of.0 && of.2.iter().zip(&values).all(is_like));
        if !is_near {
            kept.push((um, light, values));
        }
    }
    kept.into_iter().map(|(um, light, _)| (um, light)).collect()
}

/// The largest sine of the angular radius of Mars, or of what it would be over Phobos, and whether the scene has a Mars.
pub(in crate::study) fn mars_seen(scene: &Setup, extremes: &Extremes) -> (f64, bool) {
    match &scene.sky.mars {
        Some(mars) => ((mars.radius_m / extremes.site.distance_m(mars.centre_m)).min(1.0), true),
        None => (MARS_RADIUS_M / PHOBOS_ORBIT_M, false),
    }
}

/// Sunlight that a white Lambert surface square to it reflects, W m-2 sr-1 um-1; not a number where its spectrum is not known.
fn white_radiance(scene: &Setup, um: f64) -> f64 {
    Lambert { reflectance: 1.0 }.brdf() * scene.sky.sun.irradiance_w_m2_um(um).unwrap_or(f64::NAN)
}

/// Hemispherical reflectance; not a number where it is not known.
pub(super) fn reflectance(material: &Material, um: f64) -> f64 {
    material.reflectance.at(um).unwrap_or(f64::NAN)
}

/// Thermal emission of a material, W m-2 sr-1 um-1.
pub(super) fn emission(material: &Material, um: f64, t_k: f64) -> f64 {
    material.emissivity.at(um).unwrap_or(1.0) * blackbody::radiance_w_m2_sr_um(um, t_k)
}

/// Of numbers above 0; `None` without any.
fn median(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.filter(|x| *x > 0.0 && x.is_finite()).collect();
    let middle = numbers.len() / 2;
    (!numbers.is_empty()).then(|| *numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
}
