//! Penumbrae: the Sun is not a point.

use std::f64::consts::PI;

use glam::DVec3;

use super::by_others::{self, Brought};
use super::given::{Place, Side, reflectance};
use super::{Bound, EffectKind, Finding, Given, OwnTolerance, Switch};
use crate::geometry::Direction;
use crate::physics::mars::middle_above_horizon;
use crate::physics::mars_directions::{Directions, SphereSeen, Towards};
use crate::physics::reflectance::{Brdf, Lambert, PhotometricAngles};
use crate::physics::sun_disc::DiscRule;
use crate::physics::{bounds, sun, sun_disc};
use crate::scene::{Material, SunModel};
use crate::units::SUN_RADIUS_M;

pub(super) const KIND: EffectKind = EffectKind {
    key: "sun-disc",
    name: "the Sun's disc",
    equation: Some("physics::sun_disc"),
    step: Some("solve::lit, solve::irradiance"),
    light: None,
    switch: Some(Switch {
        add: |models, stated, given, tolerance| {
            // As many points as the scene states, or as the tolerance takes.
            let rule = DiscRule::fewest(|rule| edge(given, rule), tolerance);
            models.sun = if stated.sun == SunModel::Point { SunModel::Disc(rule) } else { stated.sun };
        },
        remove: |models| models.sun = SunModel::Point,
        stated: |fixed| fixed.sun.then_some("sun.points"),
        cost_s: |given, models| match models.sun {
            SunModel::Point => 0.0,
            // The first of them takes the place of the point.
            SunModel::Disc(rule) => given.shadows_s() * (rule.count() - 1) as f64,
        },
        own: Some(|given, models| OwnTolerance {
            of: "at the edges of shadows, over the median sunlit radiance".into(),
            left: match models.sun {
                SunModel::Point => edge(given, DiscRule::G1),
                SunModel::Disc(rule) => edge(given, rule),
            },
        }),
        drops_by_own: true,
    }),
    find,
};

/// The largest error of a pixel at the edge of a shadow, or along the rays, over the median sunlit radiance.
fn edge(given: &Given, rule: DiscRule) -> f64 {
    let (sin_radius, brightness) = (given.scene.sky.sun.sin_radius(), given.median_brightness());
    bounds::shadow_edge(rule.edge_error(), sin_radius, given.throw_m(), given.pixel_m(), brightness)
        + rule.limb_error() * sin_radius / brightness
}

fn find(given: &Given) -> Finding {
    let (throw_m, pixel_m) = (given.throw_m(), given.pixel_m());
    let sun_rad = sun::angular_radius_rad(given.scene.sky.sun.distance_m);
    // Square to the rays. On a slope the penumbra is wider by 1 / cos i, and as much less bright.
    let wide_px = bounds::penumbra_width_m(throw_m, sun_rad, 1.0) / pixel_m;
    // A pixel that all of the disc lights has no edge in it.
    let edge = given.error_in_draft(|&Place { at, material, class, side, .. }| match side {
        Side::Sun => 0.0,
        Side::Shade => {
            let share = (wide_px / class.least_cos_incidence).min(1.0);
            share * given.sent(at, material, class.most_brightness, class.most_cos_incidence)
        }
    });
    let models: Vec<(&Material, OneDirection)> =
        given.materials.iter().map(|(_, material)| (*material, OneDirection::of(given, material))).collect();
    let model = |material: &Material| models.iter().find(|(other, _)| std::ptr::eq(*other, material));
    // What is behind an edge has the light of a part of the disc.
    let spread = given.error_in_draft(|&Place { at, material, class, side, .. }| {
        let Some((_, model)) = model(material).filter(|_| at.light.is_lit()) else { return 0.0 };
        let [whole, part] = model.errors(class.least_cos_incidence);
        let reflected = reflectance(material, at.um) * at.white * class.most_brightness;
        // Facets that only its limb lights have no brightness.
        let limb = if class.least_cos_incidence <= sun_rad { model.limb } else { Limb::default() };
        let white = reflectance(material, at.um) * at.white;
        match side {
            Side::Sun => whole * reflected + limb.error * white,
            Side::Shade => part * reflected + limb.error_of_part * white,
        }
    });
    // A facet along the rays.
    let slope = given.error_in_draft(|&Place { at, material, class, .. }| match class.least_cos_incidence <= sun_rad {
        true => {
            let limb = model(material).map_or(0.0, |(_, model)| model.limb.brightness);
            reflectance(material, at.um) * at.white * limb.max(bounds::terminator(sun_rad))
        }
        false => 0.0,
    });
    // Facets around have half-shadows, too, over a part of each.
    let (facet_m, sun_w_m2) = (given.extremes.site.facet_m2.sqrt(), given.scene.sky.sun.total_irradiance_w_m2());
    let share = (bounds::penumbra_width_m(throw_m, sun_rad, 1.0) / facet_m).min(1.0) + bounds::terminator(sun_rad);
    let by_others = given.error_in_draft(|place| {
        let brought = Brought { white: share * place.at.white, all_w_m2: share * sun_w_m2 };
        by_others::sent(given, place, brought)
    });
    let note = match given.models.sun {
        SunModel::Point => {
            "the Sun is a point: only pixels that a shadow's edge crosses change, and slopes along the rays".into()
        }
        SunModel::Disc(rule) => format!(
            "{} points stand for the disc, and facets cut it by their own horizon exactly; a pixel that is almost dark has an error that is larger than the \
             edge's, relative to itself",
            rule.count()
        ),
    };
    Finding {
        modelled: given.models.sun != SunModel::Point,
        bound: [edge, slope, spread, by_others].into_iter().try_fold(Bound::NOTHING, |sum, part| Some(sum.and(&part?))),
        remaining: spread,
        note,
        because: format!(
            "with the edge's cause at most {throw_m:.0} m away, penumbrae are up to {wide_px:.2} pixels wide, square to the light; behind a straight \
             edge an error is sqrt(2) c s d / (p cos i)"
        ),
        ..Finding::default()
    }
}

/// What one direction for all of the Sun's disc changes of what a material sends: the largest over its wavelengths, and over facets of all directions, with the Sun and
/// the camera where they are.
struct OneDirection {
    /// Sine of the elevation of the Sun's middle, ascending, and the largest relative error from there on: where the facet has all of the disc that is up, and where
    /// it may have any part of it.
    errors: Vec<(f64, [f64; 2])>,
    limb: Limb,
}

/// Facets whose horizon cuts the disc, at most, in the light that a Lambert surface of the same reflectance sends under a Sun at the zenith.
#[derive(Debug, Clone, Copy, Default)]
struct Limb {
    brightness: f64,
    /// By one direction, where the facet has all that is up, and where it may have any part of it.
    error: f64,
    error_of_part: f64,
}

/// Elevations at which the horizon cuts the disc, in its radii.
const CUTS: [f64; 6] = [-0.95, -0.6, -0.3, 0.0, 0.3, 0.6];
/// Step of those above.
const STEP: f64 = 1.6;
/// Facets that are turned differently about the Sun's direction.
const TURNS: u32 = 24;
/// Circles of points on the disc.
const CIRCLES: usize = 4;
/// What is between them may be worse by so much.
const BETWEEN: f64 = 1.5;

impl OneDirection {
    fn of(given: &Given, material: &Material) -> Self {
        let sun = &given.scene.sky.sun;
        let mut views = given.views();
        // A surge that the camera looks into may lie between the places that it is known to see.
        let apart_rad = |a: &Direction, b: &Direction| a.angle_rad(*b);
        let widest_rad = views.iter().flat_map(|a| views.iter().map(|b| apart_rad(a, b))).fold(0.0, f64::max);
        if views.iter().any(|view| apart_rad(view, &sun.direction) <= widest_rad) {
            views.push(sun.direction);
        }
        let disc = Disc { given, sun: sun.direction.vec(), directions: Directions::new(CIRCLES) };
        let sin_radius = sun.sin_radius();
        let above = (0..).map(|k| sin_radius * STEP.powi(k)).take_while(|sin| *sin < 1.0);
        let elevations: Vec<f64> = CUTS.map(|radii| radii * sin_radius).into_iter().chain(above).collect();
        let (brdfs, (e1, e2)) = (given.brdfs(material), sun.direction.frame());
        let (mut errors, mut limb) = (Vec::with_capacity(elevations.len()), Limb::default());
        for sin in elevations {
            let mut most = [0.0_f64; 2];
            for turn in 0..TURNS {
                let (s, c) = (2.0 * PI * f64::from(turn) / f64::from(TURNS)).sin_cos();
                let normal = sin * disc.sun + ((1.0 - sin) * (1.0 + sin)).sqrt() * (c * e1 + s * e2);
                for view in views.iter().map(|view| view.vec()).filter(|view| normal.dot(*view) > 0.0) {
                    for (um, brdf) in &brdfs {
                        let (middle, [whole, part]) = disc.seen(brdf, normal, view);
                        most = [most[0].max(whole), most[1].max(part)];
                        let lambert = Lambert { reflectance: reflectance(material, *um) }.brdf();
                        if sin <= sin_radius && lambert > 0.0 {
                            let irradiance = sun_disc::irradiance_on_facet(sin, sin_radius, sun.limb_darkening);
                            let brightness = BETWEEN * irradiance * middle / lambert;
                            limb = Limb {
                                brightness: limb.brightness.max(brightness * (1.0 + whole)),
                                error: limb.error.max(brightness * whole),
                                error_of_part: limb.error_of_part.max(brightness * part),
                            };
                        }
                    }
                }
            }
            errors.push((sin, most.map(|most| BETWEEN * most)));
        }
        // From there on.
        for k in (1..errors.len()).rev() {
            errors[k - 1].1 = [0, 1].map(|side| f64::max(errors[k - 1].1[side], errors[k].1[side]));
        }
        OneDirection { errors, limb }
    }

    /// Of facets on which the middle of the Sun is up so much, or more; 0 are those, too, on which it is not.
    fn errors(&self, sin_elevation: f64) -> [f64; 2] {
        let above = self.errors.iter().take_while(|(sin, _)| sin_elevation > 0.0 && *sin <= sin_elevation);
        above.last().or(self.errors.first()).map_or([0.0; 2], |(_, errors)| *errors)
    }
}

/// The Sun's disc over facets.
struct Disc<'g> {
    given: &'g Given<'g>,
    sun: DVec3,
    directions: Directions,
}

impl Disc<'_> {
    /// f in the direction that stands for the disc, and how much those of all of it that is up together, and any of them, differ from that, relative.
    fn seen(&self, brdf: &Brdf, normal: DVec3, to_viewer: DVec3) -> (f64, [f64; 2]) {
        let sun = &self.given.scene.sky.sun;
        let to_centre_m = sun.distance_m * self.sun;
        let f = |direction: DVec3| brdf.eval(&PhotometricAngles::of_directions(normal, direction, to_viewer));
        let middle = match self.given.models.sun {
            SunModel::Point => f(self.sun),
            SunModel::Disc(_) => f(middle_above_horizon(normal, to_centre_m, SUN_RADIUS_M)),
        };
        let (mut sum, mut light, mut part) = (0.0, 0.0, 0.0_f64);
        let seen = SphereSeen { to_centre_m, radius_m: SUN_RADIUS_M, normal, sun: None };
        for Towards { direction, share } in self.directions.of(&seen, Some(to_viewer)) {
            let off = direction.cross(self.sun).length() / sun.sin_radius();
            let share = share * (1.0 - sun.limb_darkening * (1.0 - ((1.0 - off) * (1.0 + off)).max(0.0).sqrt()));
            let of_part = f(direction);
            (sum, light) = (sum + share * of_part, light + share);
            part = part.max((of_part / middle - 1.0).abs());
        }
        // A model may reflect nothing.
        if middle > 0.0 && light > 0.0 { (middle, [(sum / light / middle - 1.0).abs(), part]) } else { (0.0, [0.0; 2]) }
    }
}
