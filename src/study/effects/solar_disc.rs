//! Penumbrae: the Sun is no point.

use super::given::{Place, Side, reflectance};
use super::{Bound, EffectKind, Finding, Given, OwnTolerance, Switch, mars_light};
use crate::physics::sun_disc::DiscRule;
use crate::physics::{bounds, sun};
use crate::scene::SunModel;

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
    let spread = mars_light::spread(given, given.scene.sky.sun.sin_radius());
    // A facet along the rays.
    let slope = given.error_in_draft(|&Place { at, material, class, .. }| match class.least_cos_incidence <= sun_rad {
        true => reflectance(material, at.um) * at.white * bounds::terminator(sun_rad),
        false => 0.0,
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
        bound: edge.zip(slope).map(|(edge, slope)| edge.and(&slope).and(&Bound { lit: spread, shadow: spread })),
        note,
        because: format!(
            "with the edge's cause at most {throw_m:.0} m away, penumbrae are up to {wide_px:.2} pixels wide, square to the light; behind a straight \
             edge an error is sqrt(2) c s d / (p cos i)"
        ),
        ..Finding::default()
    }
}
