//! What light and heat reach by way of others, where facets send each other some: a facet that does not see a source has its part of it, too.

use super::given::{Place, reflectance};
use super::{Given, warmth};
use crate::physics::bounds;
use crate::study::extremes::Class;

/// What a source brings to a facet that faces all of it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Brought {
    /// Radiance of a white Lambert surface, W m-2 sr-1 um-1.
    pub(super) white: f64,
    /// Light and heat of all wavelengths, W m-2.
    pub(super) all_w_m2: f64,
}

/// Radiance that a facet sends at most of what all others pass on of that, W m-2 sr-1 um-1: none where no light between facets is modelled.
///
/// Others absorb, and emit, no more than comes; each bounce brings the form factor's share of it.
pub(super) fn sent(given: &Given, place: &Place, of: Brought) -> f64 {
    let Some(exchange) = given.models.exchange.filter(|_| place.class.most_around > 0.0) else { return 0.0 };
    let Place { at, material, class, .. } = *place;
    let light = of.white * bounds::interreflection(at.brightest, 0.0, class.most_around, 1.0);
    let alone = Place { class: &Class { most_around: 0.0, ..*class }, ..*place };
    let arriving_w_m2 = f64::from(exchange.bounces) * class.most_around * of.all_w_m2;
    reflectance(material, at.um) * light + warmth::sent(given, &alone, arriving_w_m2)
}
