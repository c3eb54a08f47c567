//! Light and heat of bodies of the sky besides Mars: the Earth, moons.

use super::by_others::{self, Brought};
use super::given::{Place, reflectance};
use super::{Bound, EffectKind, Finding, Given, Switch, mars_light, warmth};
use crate::physics::blackbody;
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::scene::{Globe, Models, Setup, Thermal};
use crate::study::extremes::BodySeen;

pub(super) const KIND: EffectKind = EffectKind {
    key: "bodies",
    name: "light and heat of further bodies",
    equation: Some("physics::mars_light::MarsLight"),
    step: Some("solve::irradiance"),
    light: None,
    switch: Some(Switch {
        add: |models, _, given, tolerance| models.bodies = fewest(given, tolerance),
        remove: |models| models.bodies = 0,
        stated: |_| None,
        cost_s: |given, models| {
            let passes = models.mars_shadows.map_or(0, |rule| rule.count()) as f64;
            let each_s = FACET_S * given.scene.body.mesh.facets.len() as f64 + passes * given.shadows_s();
            each_s * (models.bodies as usize).min(given.scene.sky.bodies.len()) as f64
        },
        own: None,
        drops_by_own: false,
    }),
    find,
};

/// CPU time that light and heat of a body take for a facet, s.
const FACET_S: f64 = 1.3e-7;

fn find(given: &Given) -> Finding {
    let bodies = &given.scene.sky.bodies;
    let setup = Setup { models: given.models, ..given.scene.clone() };
    let lighting = setup.lighting_bodies();
    let is_lighting = |globe: &Globe| lighting.iter().any(|other| other.name == globe.name);
    let (kept, left): (Vec<&Globe>, Vec<&Globe>) = bodies.iter().partition(|globe| is_lighting(globe));
    let of = |globes: &[&Globe]| of_all(given, |globe| globes.iter().any(|other| other.name == globe.name));
    let parts = bodies.iter().zip(&given.extremes.bodies).map(|(globe, seen)| {
        let bound = of_body(given, globe, seen).map_or("no bound".to_owned(), |bound| format!("{:.1e}", bound.most()));
        format!("{} {bound}", globe.name)
    });
    let names = |globes: &[&Globe]| globes.iter().map(|globe| globe.name.as_str()).collect::<Vec<_>>().join(", ");
    Finding {
        modelled: !kept.is_empty(),
        bound: of_all(given, |_| true),
        // What of the kept ones is approximated, and all of the others.
        remaining: of(&kept).zip(of(&left)).map(|(of_kept, left)| {
            let by_models =
                |globe: &&Globe| [true, false].map(|is_lit| mars_light::of_directions(given, globe, is_lit));
            let error = kept.iter().flat_map(by_models).fold(MARS_LIGHT_ERROR, f64::max);
            of_kept.times(error).and(&left)
        }),
        note: match (bodies.is_empty(), kept.is_empty(), left.is_empty()) {
            (true, ..) => "the scene has no body besides Mars".into(),
            (_, true, _) => format!("left out: {}", names(&left)),
            (_, _, true) => format!("{}: Lambert spheres as Mars is one", names(&kept)),
            _ => format!("{}: Lambert spheres as Mars is one; without {}", names(&kept), names(&left)),
        },
        because: if bodies.is_empty() {
            "nothing sends nothing".into()
        } else {
            format!(
                "a facet that faces the body where that is nearest and fullest, as warm as its day side: {}",
                parts.collect::<Vec<_>>().join(", ")
            )
        },
        ..Finding::default()
    }
}

/// The fewest bodies without which all others change no more than this.
fn fewest(given: &Given, tolerance: f64) -> u32 {
    let bodies = given.scene.sky.bodies.len();
    let fits = |count: &u32| {
        let setup = Setup { models: Models { bodies: *count, ..given.scene.models }, ..given.scene.clone() };
        let kept = setup.lighting_bodies();
        let left = of_all(given, |globe| kept.iter().all(|other| other.name != globe.name));
        left.is_some_and(|left| left.most() <= tolerance)
    };
    let all = u32::try_from(bodies).unwrap_or(u32::MAX);
    (0..all).find(fits).unwrap_or(all)
}

/// What these bodies change together.
fn of_all(given: &Given, counts: impl Fn(&Globe) -> bool) -> Option<Bound> {
    let bodies = given.scene.sky.bodies.iter().zip(&given.extremes.bodies).filter(|(globe, _)| counts(globe));
    bodies.map(|(globe, seen)| of_body(given, globe, seen)).try_fold(Bound::NOTHING, |sum, of| Some(sum.and(&of?)))
}

/// What a body's light, its own heat as light, and its warmth change if they are left out.
fn of_body(given: &Given, globe: &Globe, seen: &BodySeen) -> Option<Bound> {
    given.error_without(|place| sent(given, place, (globe, seen)))
}

/// What all of them change if terrain hides them.
pub(super) fn hidden(given: &Given) -> Option<Bound> {
    let bodies = || given.scene.sky.bodies.iter().zip(&given.extremes.bodies);
    given.error_in_draft(|place| bodies().map(|body| sent(given, place, body)).sum())
}

/// Radiance of a facet by a body's light, its own heat as light, and its warmth, W m-2 sr-1 um-1: the most.
fn sent(given: &Given, place: &Place, (globe, seen): (&Globe, &BodySeen)) -> f64 {
    let Place { at, material, .. } = *place;
    let warmest_k = globe.day_night_k[0].max(globe.day_night_k[1]);
    let albedo = globe.reflectance.at(at.um).unwrap_or(f64::NAN);
    let of_light = if at.light.is_lit() { at.white * albedo * seen.light } else { 0.0 };
    let of_glow =
        if at.light.glows() { blackbody::radiance_w_m2_sr_um(at.um, warmest_k) * seen.form_factor } else { 0.0 };
    let of_warmth = match given.models.thermal {
        Thermal::Equilibrium => warmth::sent(given, place, given.body_w_m2(globe, seen)),
        _ => 0.0,
    };
    let all_w_m2 = given.body_w_m2(globe, seen);
    let by_others = by_others::sent(given, place, Brought { white: of_light + of_glow, all_w_m2 });
    reflectance(material, at.um) * seen.gain * (of_light + of_glow) + of_warmth + by_others
}
