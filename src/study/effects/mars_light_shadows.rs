//! Terrain between a facet and Mars.

use super::by_others::{self, Brought};
use super::given::{Place, Wavelength};
use super::{Bound, EffectKind, Finding, Given, OwnTolerance, Switch, bodies, glow_of_mars, mars_light, warmth};
use crate::physics::sun_disc::DiscRule;

pub(super) const KIND: EffectKind = EffectKind {
    key: "mars-shadows",
    name: "shadows in Mars-light",
    equation: Some("physics::mars_points"),
    step: Some("solve::mars_shadows"),
    light: None,
    switch: Some(Switch {
        add: |models, stated, given, _| {
            let rule = stated.mars_shadows.unwrap_or(ENOUGH);
            models.mars_shadows = given.scene.sky.globes().next().map(|_| rule);
        },
        remove: |models| models.mars_shadows = None,
        stated: |fixed| fixed.mars_shadows.then_some("mars.points"),
        cost_s: |given, models| {
            models.mars_shadows.map_or(0.0, |rule| {
                if given.scene.sky.mars.is_some() { given.shadows_s() * rule.count() as f64 } else { 0.0 }
            })
        },
        own: Some(|_, models| OwnTolerance {
            of: "of the Mars-light of a facet that a straight horizon crosses".into(),
            left: models.mars_shadows.map_or(1.0, DiscRule::share_error),
        }),
        drops_by_own: false,
    }),
    find,
};

/// Parts of Mars that are good to 1 % of all Mars-light where Mars stands high.
const ENOUGH: DiscRule = DiscRule::G7;

fn find(given: &Given) -> Finding {
    let (has_globes, models) = (given.scene.sky.globes().next().is_some(), given.models);
    Finding {
        modelled: has_globes && models.mars_shadows.is_some(),
        missing: (!has_globes).then(|| "no Mars in the scene".into()),
        bound: hidden(given),
        note: match models.mars_shadows {
            Some(rule) => {
                format!(
                    "each facet has the share of Mars-light that terrain leaves, of {} parts of Mars; so it is of other bodies that are kept",
                    rule.count()
                )
            }
            None => "a facet's own horizon cuts Mars, other terrain does not".into(),
        },
        because: "all of the light and heat of Mars, where a horizon may be higher than its lower limb, and of further bodies".into(),
        ..Finding::default()
    }
}

/// All that Mars does where it may be hidden, and all that further bodies do: what hides their light hides their heat, too. Without any of them, what Mars would do.
fn hidden(given: &Given) -> Option<Bound> {
    let sky = &given.scene.sky;
    let all_w_m2 = given.mars_w_m2(given.most_of_mars());
    let brought = |at: &Wavelength| Brought {
        white: mars_light::brought(given, at).white + glow_of_mars::brought(given, at).white,
        all_w_m2,
    };
    let of_mars = given.error_in_draft(|place| {
        let Place { at, material, class, .. } = *place;
        let [by_mars, of_mars] = match (&sky.mars, sky.bodies.is_empty()) {
            (Some(_), _) => class.most_hidden,
            (None, true) => [given.most_of_mars(); 2],
            (None, false) => return 0.0,
        };
        mars_light::sent(given, at, material, by_mars)
            + glow_of_mars::sent(given, at, material, [by_mars, of_mars])
            + warmth::sent(given, place, given.mars_w_m2(of_mars))
            + by_others::sent(given, place, brought(at))
    });
    Some(of_mars?.and(&bodies::hidden(given)?))
}
