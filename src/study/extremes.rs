//! What a scene's geometry allows: the facets that a camera may see, in classes of sunlit radiance, with the extremes of each.
//! Bounds of effects are made from these, before anything is solved.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use rayon::prelude::*;

use super::draft::Draft;
use super::glimpse::Glimpse;
use super::site::Site;
use crate::error::Result;
use crate::geometry::{Direction, Mesh, angle_rad};
use crate::physics::mars::{irradiance_vector, uniform_sphere_form_factor};
use crate::physics::mars_directions::{Directions, OF_TWO_CIRCLES, SphereSeen, Towards};
use crate::physics::reflectance::{Brdf, Lambert, PhotometricAngles};
use crate::product::Backplanes;
use crate::progress::Watch;
use crate::scene::{Globe, Material, Scene, Setup};
use crate::visibility::{Penumbra, Seen, Shown, highest_horizons};

/// Facets are processed this many at a time.
const CHUNK: usize = 16_384;
/// Leading bits of a number that make its class: sign, exponent, and three of the mantissa, so that a class spans an eighth of an octave.
const CLASS_SHIFT: u32 = 49;
/// Classes of numbers from 2^-10 to 2^3; what is less has one of its own, together with what the Sun does not reach.
const CLASSES: usize = 13 * 8 + 1;
/// The least number that has a class.
const LEAST: f64 = 1.0 / 1024.0;
/// Sunlit places that stand for all of an image.
const PLACES: usize = 4096;

/// What a camera may see of a scene: of what hides what little is known, or, if that was looked for, where the Sun shines, and how high horizons are.
pub struct Extremes {
    pub(super) site: Site,
    pub(super) glimpse: Glimpse,
    /// Whether some facet has each material.
    pub(super) is_used: Vec<bool>,
    /// Of each material, its facets that face the camera.
    pub(super) facing: Vec<Facing>,
    /// What bodies of the sky besides Mars can send, in the scene's order.
    pub(super) bodies: Vec<BodySeen>,
    /// Share of the site that terrain outside it might shadow.
    pub(super) open_to_shadow: f64,
    /// The farthest that a shadow is thrown, m, if that was looked for.
    pub(super) throw_m: Option<f64>,
    /// Where the image is sunlit, as far as rays tell: what hides the Sun is not known.
    pub(super) sunlit: Vec<Sunlit>,
    /// The most that a facet may have of Mars' day as a form factor.
    pub(super) most_of_day: f64,
    /// How dark pixels are at most, if that was looked for.
    pub(super) draft: Option<Draft>,
}

/// A place in the image that faces the Sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sunlit {
    pub(super) material: usize,
    /// Its radiance in sunlight over that of a Lambert surface of the same hemispherical reflectance under a Sun at the zenith.
    pub(super) brightness: f64,
    pub(super) cos_incidence: f64,
}

/// Facets of one material that face the camera.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Facing {
    /// Those that the Sun may shine on.
    pub(super) lit: Classes,
    /// Those that it may not shine on, or with a part of its disc only, somewhere.
    pub(super) shaded: Classes,
}

/// Facets by their brightness in sunlight, as if nothing hid the Sun.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Classes(Vec<Class>);

/// Facets that are about as bright in sunlight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Class {
    pub(super) facets: u64,
    /// The least brightness in it.
    pub(super) least_brightness: f64,
    /// The largest in it.
    pub(super) most_brightness: f64,
    /// The largest cosine of incidence.
    pub(super) most_cos_incidence: f64,
    /// The smallest cosine of incidence.
    pub(super) least_cos_incidence: f64,
    /// A bound of how bright a Mars of reflectance 1 makes them; as brightness in sunlight.
    pub(super) most_by_mars: f64,
    /// The largest form factor of Mars.
    pub(super) most_of_mars: f64,
    /// The same two of those from which other terrain may hide some of Mars.
    pub(super) most_hidden: [f64; 2],
    /// A bound of the form factor of the surroundings.
    pub(super) most_around: f64,
}

const NONE: Class = Class {
    facets: 0,
    least_brightness: f64::INFINITY,
    most_brightness: 0.0,
    least_cos_incidence: 1.0,
    most_cos_incidence: 0.0,
    most_by_mars: 0.0,
    most_of_mars: 0.0,
    most_hidden: [0.0; 2],
    most_around: 0.0,
};

impl Class {
    fn join(&mut self, other: &Class) {
        self.facets += other.facets;
        self.least_brightness = self.least_brightness.min(other.least_brightness);
        self.most_brightness = self.most_brightness.max(other.most_brightness);
        self.least_cos_incidence = self.least_cos_incidence.min(other.least_cos_incidence);
        self.most_cos_incidence = self.most_cos_incidence.max(other.most_cos_incidence);
        self.most_by_mars = self.most_by_mars.max(other.most_by_mars);
        self.most_of_mars = self.most_of_mars.max(other.most_of_mars);
        self.most_hidden = [0, 1].map(|k| self.most_hidden[k].max(other.most_hidden[k]));
        self.most_around = self.most_around.max(other.most_around);
    }
}

impl Facing {
    fn none() -> Self {
        Facing { lit: Classes(vec![NONE; CLASSES]), shaded: Classes(vec![NONE; CLASSES]) }
    }

    fn join(&mut self, other: &Facing) {
        self.lit.join(&other.lit);
        self.shaded.join(&other.shaded);
    }
}

impl Classes {
    /// Classes that have facets.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Class> {
        self.0.iter().filter(|class| class.facets > 0)
    }

    fn add(&mut self, sight: &Sight, shelter: &Shelter) {
        let by_mars = [sight.by_mars, sight.of_mars];
        self.0[class_of(sight.brightness)].join(&Class {
            facets: 1,
            least_brightness: sight.extremes[0],
            most_brightness: sight.extremes[1],
            least_cos_incidence: sight.cos_incidence,
            most_cos_incidence: sight.cos_incidence,
            most_by_mars: sight.by_mars,
            most_of_mars: sight.of_mars,
            most_hidden: if shelter.may_hide_mars { by_mars } else { [0.0; 2] },
            most_around: shelter.around,
        });
    }

    fn join(&mut self, other: &Classes) {
        self.0
            .iter_mut()
            .zip(&other.0)
            .filter(|(_, other)| other.facets > 0)
            .for_each(|(class, other)| class.join(other));
    }
}

/// The class of a brightness: 0 for what the Sun hardly reaches, or not at all.
fn class_of(brightness: f64) -> usize {
    if brightness.is_nan() || brightness < LEAST {
        return 0;
    }
    let place = (brightness.to_bits() >> CLASS_SHIFT) - (LEAST.to_bits() >> CLASS_SHIFT);
    usize::try_from(place).unwrap_or(usize::MAX).min(CLASSES - 2) + 1
}

/// A material's reflectance by direction where spectra are in the middle of what bands show, and how far it is from that elsewhere.
struct Look {
    /// `None`: Lambert.
    model: Option<(Brdf, f64)>,
    /// The least and the most that the gain is in any band, over that in the middle.
    in_bands: [f64; 2],
}

/// Bands in which a model is compared with itself, at most, and facets at whose angles.
const COMPARED: (usize, usize) = (8, 1024);
/// A facet that takes a larger angle of the camera's view, rad, is looked at from its corners, too.
const LARGE_RAD: f64 = 0.1;

impl Look {
    fn of(scene: &Setup) -> Vec<Look> {
        let bands = scene.exposure.bands.iter().filter(|band| band.light.is_lit());
        let um: Vec<f64> = bands.map(|band| band.centre_um).collect();
        let middle_um = um.get(um.len() / 2).copied();
        let look = |material: &Material| Look {
            model: middle_um.and_then(|um| Self::model(material, um)),
            in_bands: [1.0; 2],
        };
        let mut looks: Vec<Look> = scene.body.materials.iter().map(look).collect();
        if looks.iter().all(|look| look.model.is_none()) {
            return looks;
        }
        let others_um = um.iter().step_by(um.len().div_ceil(COMPARED.0).max(1)).chain(um.last());
        let others: Vec<Vec<Look>> = others_um
            .map(|um| {
                let look = |material| Look { model: Self::model(material, *um), in_bands: [1.0; 2] };
                scene.body.materials.iter().map(look).collect()
            })
            .collect();
        let mesh = &scene.body.mesh;
        let (eye_m, to_sun) = (scene.exposure.camera.centre_m(), scene.sky.sun.direction.vec());
        for f in (0..mesh.facets.len()).step_by(mesh.facets.len().div_ceil(COMPARED.1).max(1)) {
            let (facet, material) = (mesh.facet(f), mesh.material[f].0 as usize);
            let normal = facet.cross_m2().normalize_or_zero();
            let to_eye = (eye_m - facet.centroid_m()).normalize_or_zero();
            // From Mars, light may come as well: from above.
            for to_source in [to_sun, normal, (to_sun + normal).normalize_or_zero()] {
                if normal.dot(to_eye) <= 0.0 || normal.dot(to_source) <= 0.0 {
                    continue;
                }
                let angles = || PhotometricAngles::of_directions(normal, to_source, to_eye);
                let middle = looks[material].gain(angles);
                for other in &others {
                    let times = other[material].gain(angles) / middle;
                    let [least, most] = looks[material].in_bands;
                    looks[material].in_bands = [least.min(times), most.max(times)];
                }
            }
        }
        looks
    }

    fn model(material: &Material, um: f64) -> Option<(Brdf, f64)> {
        let hemispherical = material.reflectance.at(um).filter(|value| *value > 0.0)?;
        Some((material.photometry.brdf(um)?, Lambert { reflectance: hemispherical }.brdf()))
    }

    /// f over that of a Lambert surface of the same hemispherical reflectance.
    fn gain(&self, angles: impl FnOnce() -> PhotometricAngles) -> f64 {
        self.model.as_ref().map_or(1.0, |(brdf, lambert)| brdf.eval(&angles()) / lambert)
    }
}

impl Extremes {
    /// Looks at all facets once; of what hides what it knows the few rays of a glimpse.
    pub fn new(scene: &Scene) -> Self {
        let site = Site::new(&scene.body.mesh, scene.body.topology());
        Self::by_shelter(scene, site, &Shelters::UNKNOWN)
    }

    /// Finds out where the Sun shines, how far shadows are thrown, and how high horizons are: the mesh is drawn as seen from the Sun, twice, and from above.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub fn with_shadows(scene: &Scene, watch: Watch<'_>) -> Result<Self> {
        let site = Site::new(&scene.body.mesh, scene.body.topology());
        let shelters = Shelters::of(scene, &site, watch)?;
        Ok(Self::by_shelter(scene, site, &shelters))
    }

    fn by_shelter(scene: &Scene, site: Site, shelters: &Shelters) -> Self {
        let glimpse = Glimpse::new(scene);
        let (looks, mars) = (Look::of(scene), scene.sky.mars.as_ref().and_then(|mars| MarsBound::of(scene, mars)));
        let least_tangent_of_mars = least_tangent(&site, mars.as_ref());
        let most_of_day = mars.as_ref().map_or(0.0, |mars| mars.most_of_day);
        let mesh = &scene.body.mesh;
        let none = || vec![Facing::none(); scene.body.materials.len()];
        let of_chunk = |chunk: usize| {
            let mut facing = none();
            for facet in chunk * CHUNK..mesh.facets.len().min((chunk + 1) * CHUNK) {
                let material = mesh.material[facet].0 as usize;
                if let Some(sight) = sight(scene, &mars, facet, &looks[material]) {
                    let shelter = shelters.shelter(mesh, &site, facet, least_tangent_of_mars);
                    if sight.faces_sun && shelter.may_be_lit {
                        facing[material].lit.add(&sight, &shelter);
                    }
                    if shelter.may_be_dark {
                        facing[material].shaded.add(&sight, &shelter);
                    }
                }
            }
            facing
        };
        let join = |mut all: Vec<Facing>, part: Vec<Facing>| {
            all.iter_mut().zip(&part).for_each(|(all, part)| all.join(part));
            all
        };
        let facing = (0..mesh.facets.len().div_ceil(CHUNK)).into_par_iter().map(of_chunk).reduce(none, join);
        let mut is_used = vec![false; scene.body.materials.len()];
        mesh.material.iter().for_each(|material| is_used[material.0 as usize] = true);
        let place = |facet: usize| {
            let material = mesh.material[facet].0 as usize;
            let Sight { brightness, cos_incidence, .. } = sight(scene, &mars, facet, &looks[material])?;
            (brightness > 0.0).then_some(Sunlit { material, brightness, cos_incidence })
        };
        Extremes {
            open_to_shadow: site.open_to_shadow(mesh, scene.sky.sun.direction.vec(), glimpse.facets()),
            throw_m: shelters.penumbra.as_ref().map(|penumbra| penumbra.throw_m),
            sunlit: glimpse.facets().filter_map(place).collect(),
            site,
            glimpse,
            is_used,
            facing,
            most_of_day,
            draft: None,
            bodies: scene.sky.bodies.iter().map(|globe| BodySeen::of(scene, globe, &looks)).collect(),
        }
    }
}

/// What hides what.
struct Shelters {
    /// What the Sun's middle sees.
    sunlit: Option<Seen>,
    penumbra: Option<Penumbra>,
    /// Tangents of the horizon's elevation: of a site's facets.
    horizons: Option<Vec<f64>>,
}

/// What is known of a facet's.
struct Shelter {
    may_be_lit: bool,
    may_be_dark: bool,
    may_hide_mars: bool,
    /// A bound of the form factor of the surroundings.
    around: f64,
}

impl Shelters {
    const UNKNOWN: Shelters = Shelters { sunlit: None, penumbra: None, horizons: None };

    fn of(scene: &Scene, site: &Site, watch: Watch<'_>) -> Result<Self> {
        let (mesh, topology, sun) = (&scene.body.mesh, scene.body.topology(), &scene.sky.sun);
        let up = site.up.and_then(Direction::new);
        Ok(Shelters {
            sunlit: Some(Seen::from_afar(mesh, topology, sun.direction, "plan", watch)?),
            penumbra: Some(Penumbra::of(mesh, topology, sun.direction, sun.sin_radius())),
            horizons: up.map(|up| highest_horizons(mesh, topology, up, watch)).transpose()?,
        })
    }

    fn shelter(&self, mesh: &Mesh, site: &Site, facet: usize, least_tangent_of_mars: f64) -> Shelter {
        let shown = self.sunlit.as_ref().map(|sunlit| sunlit.shown[facet]);
        let is_reached = self.penumbra.as_ref().is_none_or(|penumbra| penumbra.reached[facet]);
        let horizon = self.horizons.as_ref().map_or(f64::INFINITY, |tangents| tangents[facet]);
        let around = match site.up {
            Some(up) => {
                let cross_m2 = mesh.facet(facet).cross_m2();
                let cos_slope = cross_m2.dot(up) / cross_m2.length();
                // Whichever of the two knows more.
                sky_below(horizon, cos_slope).min(site.most_around())
            }
            None => site.most_around(),
        };
        Shelter {
            may_be_lit: shown != Some(Shown::Nothing) || is_reached,
            may_be_dark: shown != Some(Shown::Whole) || is_reached,
            may_hide_mars: horizon >= least_tangent_of_mars,
            around,
        }
    }
}

/// Tangent of the elevation of Mars' lower limb, from where it is lowest; negative infinity if there is no up.
fn least_tangent(site: &Site, mars: Option<&MarsBound>) -> f64 {
    let (Some(up), Some(mars)) = (site.up, mars) else { return f64::NEG_INFINITY };
    let zenith_rad = angle_rad(up, mars.towards) + mars.off.1.atan2(mars.off.0) + mars.radius.0.asin();
    if zenith_rad < FRAC_PI_2 { 1.0 / zenith_rad.tan() } else { f64::NEG_INFINITY }
}

/// Form factor of all that is below an elevation of this tangent, to a facet of such a slope.
fn sky_below(tangent: f64, cos_slope: f64) -> f64 {
    // The sine of the half angle of the cone of sky is the cosine of the elevation.
    let sin_sky = 1.0 / tangent.hypot(1.0);
    let sky = if sin_sky < 1.0 { uniform_sphere_form_factor(sin_sky, cos_slope) } else { 0.5 * (1.0 + cos_slope) };
    (1.0 - sky).clamp(0.0, 1.0)
}

/// How bright sunlight and Mars make a facet that faces the camera.
struct Sight {
    /// Whether it does, or would but for rounding.
    faces_sun: bool,
    brightness: f64,
    /// The least and the most that it is in any band, and anywhere on the facet.
    extremes: [f64; 2],
    cos_incidence: f64,
    by_mars: f64,
    of_mars: f64,
}

fn sight(scene: &Setup, mars: &Option<MarsBound>, facet: usize, look: &Look) -> Option<Sight> {
    let facet = scene.body.mesh.facet(facet);
    let (cross_m2, centroid_m) = (facet.cross_m2(), facet.centroid_m());
    let to_eye = scene.exposure.camera.centre_m() - centroid_m;
    // The same plane has the same side to the eye everywhere on it.
    if cross_m2.dot(to_eye) <= 0.0 {
        return None;
    }
    let normal = cross_m2.normalize_or_zero();
    let gain_from = |to_source: DVec3, to_eye: DVec3| {
        look.gain(|| PhotometricAngles::of_directions(normal, to_source, to_eye.normalize_or_zero()))
    };
    let gain = |to_source: DVec3| gain_from(to_source, to_eye);
    let to_sun = scene.sky.sun.direction.vec();
    let faces_sun = normal.dot(to_sun) > -8.0 * f64::EPSILON;
    let cos_incidence = normal.dot(to_sun).max(0.0);
    let brightness = if cos_incidence > 0.0 { cos_incidence * gain(to_sun) } else { 0.0 };
    let (by_mars, of_mars) = mars.as_ref().map_or((0.0, 0.0), |mars| {
        let (most, of_mars) = mars.at(normal);
        (if most > 0.0 { most * mars.gain(look, normal, centroid_m, to_eye.normalize_or_zero()) } else { 0.0 }, of_mars)
    });
    let mut extremes = [brightness; 2];
    if look.model.is_some() && cos_incidence > 0.0 {
        let [a, b, c] = facet.corners_m;
        let largest_m2 = (b - a).length_squared().max((c - a).length_squared());
        if largest_m2 > LARGE_RAD * LARGE_RAD * to_eye.length_squared() {
            for corner_m in facet.corners_m {
                let there = cos_incidence * gain_from(to_sun, scene.exposure.camera.centre_m() - corner_m);
                extremes = [extremes[0].min(there), extremes[1].max(there)];
            }
        }
        extremes = [extremes[0] * look.in_bands[0], extremes[1] * look.in_bands[1]];
    }
    Some(Sight { faces_sun, brightness, extremes, cos_incidence, by_mars: by_mars * look.in_bands[1], of_mars })
}

/// Bounds of Mars-light, cheaper than itself.
struct MarsBound {
    centre_m: DVec3,
    radius_m: f64,
    /// From there to the Sun.
    sun: DVec3,
    directions: Directions,
    /// Towards its centre from the middle of the scene, and cosine and sine of the angle that it is off from elsewhere.
    towards: DVec3,
    off: (f64, f64),
    /// Sine and cosine of its angular radius where it is nearest.
    radius: (f64, f64),
    /// The most that all of Mars sends, over its reflectance and sunlight: radiance summed over directions, times pi.
    scalar: f64,
    /// The largest cosine of the Sun's incidence on what of Mars is in view.
    most_cos: f64,
    /// The largest form factor of the part of it that has day.
    most_of_day: f64,
}

impl MarsBound {
    fn of(scene: &Setup, globe: &Globe) -> Option<Self> {
        let Globe { centre_m, radius_m, .. } = *globe;
        let (low_m, high_m) = scene.body.bounds_m()?;
        // Where Mars is nearest, and anywhere in the box, the phase angle is the middle's but for the box's size as Mars sees it.
        let middle_m = 0.5 * (low_m + high_m);
        let (to_centre_m, reach_m) = (centre_m - middle_m, 0.5 * (high_m - low_m).length());
        let nearest_m = (to_centre_m.length() - reach_m).max(1.000_001 * radius_m);
        let sin_radius = radius_m / nearest_m;
        let off_rad = reach_m / nearest_m;
        // From Mars: between the Sun and the scene.
        let phase_rad = angle_rad(scene.sky.sun_on(globe).direction.vec(), -to_centre_m);
        let least_phase_rad = (phase_rad - off_rad).max(0.0);
        let in_view_rad = (least_phase_rad - sin_radius.acos()).max(0.0);
        let (away, sunward) = irradiance_vector(sin_radius, least_phase_rad.cos());
        // A facet that faces Mars gets every direction's light by a cosine that is at least the rim's.
        let facing = away - sunward * least_phase_rad.cos();
        let rim = (1.0 - sin_radius * sin_radius).max(0.0).sqrt();
        Some(MarsBound {
            centre_m,
            radius_m,
            sun: scene.sky.sun_on(globe).direction.vec(),
            directions: Directions::new(2),
            towards: to_centre_m.normalize_or_zero(),
            off: (off_rad.cos(), off_rad.sin()),
            radius: (sin_radius, rim),
            scalar: facing / rim,
            most_cos: in_view_rad.cos().max(0.0),
            // The share of a disc from afar, at a phase angle that is smaller by what nearness may show more of the day; by the cosine of what is nearest.
            most_of_day: sin_radius * sin_radius / rim
                * 0.5
                * (1.0 + (least_phase_rad - sin_radius.asin()).max(0.0).cos()),
        })
    }

    /// How much more of its light a facet sends to the camera than a Lambert surface would, at most: by a few directions on its day and, for its heat, on all of it.
    fn gain(&self, look: &Look, normal: DVec3, centroid_m: DVec3, to_eye: DVec3) -> f64 {
        if look.model.is_none() {
            return 1.0;
        }
        let of = |sun: Option<DVec3>| {
            let seen = SphereSeen { to_centre_m: self.centre_m - centroid_m, radius_m: self.radius_m, normal, sun };
            let gain = |Towards { direction, share }| {
                share * look.gain(|| PhotometricAngles::of_directions(normal, direction, to_eye))
            };
            self.directions.of(&seen, Some(to_eye)).into_iter().map(gain).sum::<f64>()
        };
        (1.0 + OF_TWO_CIRCLES) * of(Some(self.sun)).max(of(None))
    }

    /// How much more of its light facets send to the camera than a Lambert surface that faces it would, at most.
    fn most_gain(&self, scene: &Scene, looks: &[Look]) -> f64 {
        let mesh = &scene.body.mesh;
        let (sin_radius, cos_radius) = self.radius;
        let of = |i: usize| {
            let facet = mesh.facet(i);
            let (normal, centroid_m) = (facet.cross_m2().normalize_or_zero(), facet.centroid_m());
            let to_eye = (scene.exposure.camera.centre_m() - centroid_m).normalize_or_zero();
            let tilt = nearer(with_sine(normal.dot(self.towards)), self.off);
            let (nearest, _) = nearer(tilt, (cos_radius, sin_radius));
            if normal.dot(to_eye) <= 0.0 || nearest <= 0.0 {
                return 0.0;
            }
            nearest / cos_radius * self.gain(&looks[mesh.material[i].0 as usize], normal, centroid_m, to_eye)
        };
        (0..mesh.facets.len()).into_par_iter().map(of).reduce(|| 0.0, f64::max)
    }

    /// Bounds of E / (reflectance x sunlight), and of the form factor, of a facet anywhere in the scene.
    fn at(&self, normal: DVec3) -> (f64, f64) {
        let (sin_radius, cos_radius) = self.radius;
        // The least tilt there may be; then that of the part of the disc that is nearest to the normal.
        let (cos_tilt, sin_tilt) = nearer(with_sine(normal.dot(self.towards)), self.off);
        let form_factor = uniform_sphere_form_factor(sin_radius, cos_tilt);
        if form_factor <= 0.0 {
            return (0.0, 0.0);
        }
        let (nearest, _) = nearer((cos_tilt, sin_tilt), (cos_radius, sin_radius));
        ((form_factor * self.most_cos).min(self.scalar * nearest.max(0.0)), form_factor)
    }
}

/// The most that a body of the sky can send a facet of the scene.
pub(super) struct BodySeen {
    /// Irradiance over its reflectance and the scene's sunlight.
    pub(super) light: f64,
    /// Form factor.
    pub(super) form_factor: f64,
    /// How much more of that a surface sends to the camera than a Lambert surface that faces the body would.
    pub(super) gain: f64,
}

impl BodySeen {
    fn of(scene: &Scene, globe: &Globe, looks: &[Look]) -> Self {
        let Some(bound) = MarsBound::of(scene, globe) else {
            return BodySeen { light: 0.0, form_factor: 0.0, gain: 1.0 };
        };
        let (sin_radius, _) = bound.radius;
        let form_factor = sin_radius * sin_radius;
        let strength = scene.sky.sun_on(globe).strength;
        let has_models = looks.iter().any(|look| look.model.is_some());
        let gain = if has_models { bound.most_gain(scene, looks) } else { 1.0 };
        BodySeen { light: strength * (form_factor * bound.most_cos).min(bound.scalar), form_factor, gain }
    }
}

fn with_sine(cos: f64) -> (f64, f64) {
    (cos, (1.0 - cos * cos).max(0.0).sqrt())
}

/// Cosine and sine of an angle less another one, or of 0 if that is larger.
fn nearer((cos, sin): (f64, f64), (cos_by, sin_by): (f64, f64)) -> (f64, f64) {
    if cos >= cos_by { (1.0, 0.0) } else { (cos * cos_by + sin * sin_by, sin * cos_by - cos * sin_by) }
}

/// Places that are sunlit for the most part, of an image; those with any light if none are.
pub(super) fn sunlit_places(scene: &Setup, backplanes: &Backplanes) -> Vec<Sunlit> {
    let plane = |name: &str| backplanes.plane(name).map_or(&[][..], |plane| &plane.values);
    let (incidence, emission) = (plane("LOCALINCIDENCE_MEAN"), plane("LOCALEMISSION_MEAN"));
    let (phase, lit, material) = (plane("PHASE"), plane("LIT_FRACTION"), plane("MATERIAL"));
    let looks = Look::of(scene);
    let to_sun = scene.sky.sun.direction.vec();
    let phase_rad = angle_rad(scene.exposure.camera.centre_m(), to_sun);
    let place = |i: usize| {
        let material = crate::geometry::whole(material[i]);
        let [cos_incidence, cos_emission] = [incidence, emission].map(|plane| plane[i].to_radians().cos());
        // The centre ray may miss what the rest of the pixel sees.
        let phase_rad = if phase[i].is_nan() { phase_rad } else { phase[i].to_radians() };
        let angles = || PhotometricAngles::of_cosines(cos_incidence, cos_emission, phase_rad.cos());
        let brightness = cos_incidence * looks.get(material)?.gain(angles);
        (brightness > 0.0).then_some(Sunlit { material, brightness, cos_incidence })
    };
    let lit_more = |least: f64| -> Vec<usize> { (0..lit.len()).filter(|i| lit[*i] > least).collect() };
    let found = [0.5, 0.0].into_iter().map(lit_more).find(|found| !found.is_empty()).unwrap_or_default();
    let step = found.len().div_ceil(PLACES).max(1);
    found.into_iter().step_by(step).filter_map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_an_eighth_of_an_octave() {
        assert_eq!([0.0, f64::NAN, LEAST].map(class_of), [0, 0, 1]);
        // 1 is 10 octaves up; 1.124 is still in its class, 1.125 in the next.
        assert_eq!([1.0, 1.124, 1.125].map(class_of), [81, 81, 82]);
        assert_eq!([1e9, f64::INFINITY].map(class_of), [CLASSES - 1; 2]);
    }
}
