//! Light and heat between facets.

use super::given::{Place, emission, reflectance};
use super::{EffectKind, Finding, Given, OwnTolerance, Switch, warmth};
use crate::physics::bounds;
use crate::scene::{Exchange, Material};
use crate::study::extremes::Class;

pub(super) const KIND: EffectKind = EffectKind {
    key: "interreflection",
    name: "light and heat between facets",
    equation: Some("physics::bounds::interreflection"),
    step: Some("solve::exchange"),
    light: None,
    switch: Some(Switch {
        add: |models, stated, given, _| {
            let pixel_m = given.pixel_m();
            let enough = || Exchange::to_within(ENOUGH, BOUNCES, pixel_m * pixel_m / given.extremes.site.facet_m2);
            models.exchange = Some(stated.exchange.unwrap_or_else(enough));
        },
        remove: |models| models.exchange = None,
        stated: |_| None,
        cost_s: |given, models| {
            let facets = given.scene.body.mesh.facets.len();
            let levels = if given.extremes.site.is_graded { 2.0 } else { 1.0 };
            models.exchange.map_or(0.0, |of| of.bounce_s(facets) * AS_LONG * levels)
        },
        own: Some(|_, models| OwnTolerance {
            of: "of what neighbours send, rms over shadows under a Sun at 60 deg; at 85 deg four times as much".into(),
            left: models.exchange.map_or(1.0, Exchange::expected_error),
        }),
        drops_by_own: false,
    }),
    find,
};

/// The tolerance of light between facets: a thousandth is not to be had at a sane price.
const ENOUGH: f64 = 0.03;
const BOUNCES: u32 = 2;
/// Bounces that take as long as the first, of all: later ones have fewer lines.
const AS_LONG: f64 = 1.2;

fn find(given: &Given) -> Finding {
    let most = |of: &dyn Fn(&Material) -> f64| given.materials.iter().map(|(_, m)| of(m)).fold(0.0, f64::max);
    // One number a wavelength; by the material's own reflectance it is what a facet sends.
    let of_light: Vec<(f64, [f64; 2])> = given
        .wavelengths
        .iter()
        .map(|at| {
            let heat = if at.light.glows() { most(&|m| emission(m, at.um, given.noon_k)) } else { 0.0 };
            (at.um, [heat, given.most_white(at)])
        })
        .collect();
    let at_um = |um: f64| of_light[of_light.partition_point(|(of, _)| *of < um).min(of_light.len() - 1)].1;
    let bound = given.error_without(|place| {
        let Place { at, material, class, .. } = *place;
        let [heat, white] = at_um(at.um);
        let light = match class.most_around > 0.0 && white > 0.0 {
            true => white * bounds::interreflection(at.brightest, heat / white, class.most_around, 1.0),
            false => bounds::neighbours_heat(heat, at.brightest, class.most_around),
        };
        let alone = Place { class: &Class { most_around: 0.0, ..*class }, ..*place };
        let warmth = warmth::sent(given, &alone, given.around_w_m2(class.most_around));
        reflectance(material, at.um) * light + warmth
    });
    let form_factor = given.most_around();
    let slopes = match given.extremes.site.up {
        Some(_) => format!("slopes up to {:.0} deg", given.extremes.site.cos_steepest.acos().to_degrees()),
        None if form_factor == 0.0 => "a closed body that bulges everywhere".to_owned(),
        None => "a body may have any slope".to_owned(),
    };
    Finding {
        modelled: given.models.exchange.is_some(),
        bound,
        note: match given.models.exchange {
            Some(of) => format!(
                "{} bounces, along {} directions: light, and heat that warms; surfaces with a model send and receive it as their directional albedo says",
                of.bounces, of.directions
            ),
            None => "facets get none from each other; in shadow it is often the only light".into(),
        },
        because: format!(
            "the surroundings fill at most {:.0} % of a facet's view ({slopes}), all of them taken as lit at normal incidence and as warm as {:.1} K",
            100.0 * form_factor,
            given.noon_k,
        ),
        ..Finding::default()
    }
}
