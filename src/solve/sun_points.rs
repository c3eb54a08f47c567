//! How many points stand for the Sun's disc.

use crate::physics::bounds;
use crate::physics::sun_disc::DiscRule;
use crate::scene::{Setup, SunModel};
use crate::visibility::longest_throw_m;

/// The fewest points of the Sun's disc with which no pixel behind a straight shadow edge, or along the rays, is off by more than `tolerance`, relative to a
/// surface that is sunlit at `cos_incidence`, and by how much one may be: more than the tolerance if the most points there are do not reach it.
///
/// `pixel_m` is the smallest pixel at the surface, square to the line of sight. Cheap: the mesh is drawn once as the Sun sees it, and no shadow is computed.
/// See [`bounds::shadow_edge`].
pub fn sun_model(setup: &Setup, pixel_m: f64, cos_incidence: f64, tolerance: f64) -> (SunModel, f64) {
    let sun = &setup.sky.sun;
    let throw_m = longest_throw_m(&setup.body.mesh, setup.body.topology(), sun.direction);
    let bound = |rule: DiscRule| {
        bounds::shadow_edge(rule.edge_error(), sun.sin_radius(), throw_m, pixel_m, cos_incidence)
            + rule.limb_error() * sun.sin_radius() / cos_incidence
    };
    let all = || DiscRule::ALL.into_iter();
    let fewest = all().filter(|rule| bound(*rule) <= tolerance).min_by_key(|rule| rule.count());
    let rule = fewest.or_else(|| all().min_by(|a, b| bound(*a).total_cmp(&bound(*b)))).unwrap_or(DiscRule::G1);
    let model = if rule == DiscRule::G1 { SunModel::Point } else { SunModel::Disc(rule) };
    (model, bound(rule))
}
