//! What bodies of the sky leave of the Sun, facet by facet: over a moon it differs.

use glam::DVec3;

use crate::physics::sun_disc::share_beside_sphere;
use crate::scene::{Setup, Sky, Sun};

/// Bodies that may hide some of the Sun from some of the mesh.
pub(super) struct Eclipse<'a> {
    sun: &'a Sun,
    spheres: Vec<(DVec3, f64)>,
}

impl<'a> Eclipse<'a> {
    /// `None` if all of the Sun is seen from everywhere, or eclipses are not asked for.
    pub(super) fn of(setup: &'a Setup) -> Option<Self> {
        if !setup.models.eclipses {
            return None;
        }
        let (sun, (low_m, high_m)) = (&setup.sky.sun, setup.body.bounds_m()?);
        let (middle_m, half_m) = (0.5 * (low_m + high_m), 0.5 * (high_m - low_m).length());
        // From anywhere in the mesh the body is within its limb as seen from the middle, widened by the mesh.
        let may_hide = |(centre_m, radius_m): &(DVec3, f64)| {
            let to_centre_m = *centre_m - middle_m;
            let alone =
                |radius_m| share_beside_sphere(sun.direction.vec(), sun.sin_radius(), 0.0, to_centre_m, radius_m);
            alone(radius_m + half_m) < 1.0
        };
        let spheres: Vec<_> = setup.sky.spheres().filter(may_hide).collect();
        (!spheres.is_empty()).then_some(Eclipse { sun, spheres })
    }

    /// Share of the Sun's light that reaches a place, local, m.
    pub(super) fn share(&self, place_m: DVec3) -> f64 {
        let Sun { direction, limb_darkening, .. } = self.sun;
        let beside = |(centre_m, radius_m): &(DVec3, f64)| {
            share_beside_sphere(direction.vec(), self.sun.sin_radius(), *limb_darkening, *centre_m - place_m, *radius_m)
        };
        self.spheres.iter().map(beside).product()
    }

    /// Whether a body is seen from a place, local, m, in this direction.
    pub(super) fn hides(&self, place_m: DVec3, towards: DVec3) -> bool {
        self.spheres.iter().any(|sphere| hides(*sphere, place_m, towards))
    }
}

/// Whether a body of the sky hides the middle of the Sun from a place, local, m.
pub fn is_eclipsed(sky: &Sky, place_m: DVec3) -> bool {
    sky.spheres().any(|sphere| hides(sphere, place_m, sky.sun.direction.vec()))
}

/// Whether a sphere is seen from a place, local, m, in this direction.
fn hides((centre_m, radius_m): (DVec3, f64), place_m: DVec3, towards: DVec3) -> bool {
    let to_centre_m = centre_m - place_m;
    to_centre_m.dot(towards) > 0.0
        && to_centre_m.cross(towards).length_squared() < (radius_m * radius_m) * towards.length_squared()
}
