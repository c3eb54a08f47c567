//! Where things are seen, and where they are.

use super::{EffectKind, Finding, Given, left_out};

/// Stellar aberration at Mars: its largest orbital speed and Phobos' own, 28.6 km/s, over that of light; rad.
const ABERRATION_RAD: f64 = 9.6e-5;

pub(super) const KIND: EffectKind =
    EffectKind { name: "aberration and light time", equation: None, step: None, light: None, find };

fn find(given: &Given) -> Finding {
    // Of irradiance, and of shadows' edges. Emission follows irradiance by a power that makes it 2 at most, up to 20 um.
    let share = (ABERRATION_RAD * (1.0 + given.longest_ray_m() / given.pixel_m())).min(1.0);
    let bound = given.all_light().map(|all| 2.0 * share * all);
    let note = "directions and distances are taken as given. Apparent ones of one instant need nothing more; geometric ones are off by \
                up to 1e-4 rad, a sixtieth of the Sun's disc: shadow edges move by as much";
    left_out(bound, note)
}
