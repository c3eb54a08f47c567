//! What a site lies on: a plane, or a body.

use glam::DVec3;

use super::body::Wrap;

/// The surface that heights of a site are above.
#[derive(Debug, Clone)]
pub(super) enum Base {
    /// A plane.
    Plane,
    /// A body at a target.
    Body(Box<Wrap>),
}

impl Base {
    /// A place of the site, x east, y north and so high above the base, m, in the axes of the mesh.
    pub(super) fn point_m(&self, site_m: DVec3) -> DVec3 {
        match self {
            Base::Plane => site_m,
            Base::Body(wrap) => {
                let (foot_m, up) = wrap.foot(site_m.x, site_m.y);
                foot_m + site_m.z * up
            }
        }
    }

    /// The unit vector that heights go along at a place.
    pub(super) fn up(&self, x_m: f64, y_m: f64) -> DVec3 {
        match self {
            Base::Plane => DVec3::Z,
            Base::Body(wrap) => wrap.foot(x_m, y_m).1,
        }
    }

    /// The share of a site's relief that there is at a place: towards the end of the surroundings on a body it vanishes, so that they end on the body.
    pub(super) fn relief(&self, x_m: f64, y_m: f64) -> f64 {
        match self {
            Base::Plane => 1.0,
            Base::Body(wrap) => wrap.relief(x_m, y_m),
        }
    }

    /// Coordinates of the mesh are whole multiples of 1 m over this.
    pub(super) fn digits(&self) -> f64 {
        match self {
            Base::Plane => 1e5,
            // A body's are 1e4 times larger, and its formula is to be met to 1e-6 m.
            Base::Body(_) => 1e7,
        }
    }
}
