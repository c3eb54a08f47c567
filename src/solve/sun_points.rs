//! How many points stand for the Sun's disc.

use crate::physics::bounds;
use crate::physics::sun_disc::DiscRule;
use crate::scene::{Setup, SunModel};
use crate::visibility::longest_throw_m;

/// The fewest points of the Sun's disc behind whose straight shadow edges no pixel is off by more than `tolerance`, relative to a surface that is
/// sunlit at `cos_incidence`, and by how much one may be: more than the tolerance if the most points there are do not reach it.
///
/// `pixel_m` is the smallest pixel at the surface, square to the line of sight. Cheap: the mesh is drawn once as the Sun sees it, and no shadow is computed.
/// See [`bounds::shadow_edge`].
pub fn sun_model(setup: &Setup, pixel_m: f64, cos_incidence: f64, tolerance: f64) -> (SunModel, f64) {
    let sun = &setup.sky.sun;
    let throw_m = longest_throw_m(&setup.body.mesh, setup.body.topology(), sun.direction);
    let edge =
        |rule: DiscRule| bounds::shadow_edge(rule.edge_error(), sun.sin_radius(), throw_m, pixel_m, cos_incidence);
    // A point Sun gives nothing to facets along its rays.
    let of_point = edge(DiscRule::G1) + bounds::terminator(sun.sin_radius()) / cos_incidence;
    if of_point <= tolerance {
        return (SunModel::Point, of_point);
    }
    let rules = || DiscRule::ALL.into_iter().filter(|rule| *rule != DiscRule::G1);
    let by_count = rules().filter(|rule| edge(*rule) <= tolerance).min_by_key(|rule| rule.count());
    let rule = by_count.or_else(|| rules().min_by(|a, b| a.edge_error().total_cmp(&b.edge_error())));
    rule.map_or((SunModel::Point, of_point), |rule| (SunModel::Disc(rule), edge(rule)))
}
