//! What a site lies on: a plane, or a body.

use glam::DVec3;

use super::body::Wrap;

/// Text with five decimals holds coordinates of a plane.
const ON_PLANE_PER_M: f64 = 1e5;

/// On a body its formula is met to a micrometre.
pub(super) const ON_BODY_PER_M: f64 = 1e7;

/// The surface that heights of a site are above.
#[derive(Debug, Clone)]
pub(super) enum Base {
    /// A plane.
    Plane,
    /// A body at a target.
    Body(Box<Wrap>),
}

impl Base {
    /// A place of the site, x east, y north and so high above the base, m, in the axes of the mesh; and the unit vector that heights go along there.
    pub(super) fn stand_m(&self, site_m: DVec3) -> (DVec3, DVec3) {
        match self {
            Base::Plane => (site_m, DVec3::Z),
            Base::Body(wrap) => {
                let (foot_m, up) = wrap.foot(site_m.x, site_m.y);
                (foot_m + site_m.z * up, up)
            }
        }
    }

    /// The place alone.
    pub(super) fn point_m(&self, site_m: DVec3) -> DVec3 {
        self.stand_m(site_m).0
    }

    /// The share of a site's relief that there is at a place: towards the end of the surroundings on a body it vanishes, so that they end on the body.
    pub(super) fn relief(&self, x_m: f64, y_m: f64) -> f64 {
        match self {
            Base::Plane => 1.0,
            Base::Body(wrap) => wrap.relief(x_m, y_m),
        }
    }

    /// Coordinates of the mesh are whole multiples of a metre over this, 1/m.
    pub(super) fn per_m(&self) -> f64 {
        match self {
            Base::Plane => ON_PLANE_PER_M,
            Base::Body(_) => ON_BODY_PER_M,
        }
    }
}

/// The nearest whole multiple of a metre over `per_m`, as the f64 that reading its decimal text gives: a whole number over a whole
/// number is rounded once, as the text is. Adding zero makes -0 into 0.
pub(super) fn rounded_m(v: DVec3, per_m: f64) -> DVec3 {
    (v * per_m).round() / per_m + DVec3::ZERO
}
