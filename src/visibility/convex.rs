//! Whether no facet of a body faces another one.

use rayon::prelude::*;

use super::Topology;
use super::topology::NONE;
use crate::geometry::Mesh;

/// Facets whose common edge is flat to within this slope bulge there: corners of one plane are rounded.
const FLAT: f64 = 1e-12;

impl Topology {
    /// Whether the mesh is one closed body that bulges at every edge, to rounding: then it is convex (Tietze 1928, Math. Z. 28, 697), and no facet sees another.
    ///
    /// Not asked of a body that crosses itself.
    pub fn is_convex(&self, mesh: &Mesh) -> bool {
        let bulges = |(f, neighbours): (usize, &[u32; 3])| {
            let facet = mesh.facet(f);
            let (normal, [a, ..]) = (facet.cross_m2().normalize_or_zero(), facet.corners_m);
            let is_below = |other: &u32| {
                let corners_m = mesh.facet(*other as usize).corners_m;
                corners_m.iter().all(|corner_m| normal.dot(*corner_m - a) <= FLAT * (*corner_m - a).length())
            };
            neighbours.iter().all(|other| *other != NONE && is_below(other))
        };
        self.is_one_body() && self.neighbour.par_iter().enumerate().all(bulges)
    }
}
