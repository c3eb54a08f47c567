//! How the image of a facet leads to a map's texels: both see the facet's plane by a homography.

use glam::DVec3;

use crate::geometry::polygon::Point;
use crate::geometry::{Chart, Facet, Projection, SpaceChart};
use crate::visibility::{OnFacet, View};

/// Of an image that `projection` makes of the facet.
///
/// The ray d from the camera c meets the facet's plane (normal n, corner a) at c + d (n.(a - c)) / (n.d); times n.d, all is
/// linear in d, which is linear in (x, y, 1).
pub(super) fn of_projection(projection: &Projection, view: &View, facet: &Facet) -> Option<Chart> {
    let View::Pinhole { centre_m, .. } = view else { return None };
    let ([right, down, ahead], offset) = view.rays()?;
    let normal = facet.cross_m2();
    let away = normal.dot(facet.corners_m[0] - *centre_m);
    let eye = projection.linear * (*centre_m - projection.origin_m) + projection.offset;
    let of_ray = |d: DVec3| eye * normal.dot(d) + projection.linear * d * away;
    let (right, down) = (of_ray(right), of_ray(down));
    let ahead = of_ray(ahead) - right * offset[0] - down * offset[1];
    // n.d is negative on the side that is seen: w shall be positive in front of the map's eye.
    let [s, t, w] = [0, 1, 2].map(|k| [-right[k], -down[k], -ahead[k]]);
    Some(Chart { s, t, w })
}

/// Of a texture, whose texel coordinates at the facet's corners are `corners`.
pub(super) fn of_corners(corners: &[Point; 3], on_facet: &OnFacet) -> Option<Chart> {
    let ([s, t], w) = of_coordinates(corners, on_facet)?;
    Some(Chart { s, t, w })
}

/// Of places in space: those of the facet's corners.
pub(super) fn of_places(corners_m: [DVec3; 3], on_facet: &OnFacet) -> Option<SpaceChart> {
    let (place_m, w) = of_coordinates(&corners_m.map(|corner| corner.to_array()), on_facet)?;
    Some(SpaceChart { place_m, w })
}

/// Linear forms over w of what is affine over the facet, given at its corners; and w.
fn of_coordinates<const N: usize>(corners: &[[f64; N]; 3], on_facet: &OnFacet) -> Option<([[f64; 3]; N], [f64; 3])> {
    let OnFacet::Pinhole { a, to_b, to_c, centre } = on_facet else { return None };
    // (u, v) = (-p.a, ray.q) / p.to_b with p = ray x to_c and q = to_b x a: see `OnFacet::uv`.
    let u_numerator = -to_c.cross(*a);
    let v_numerator = -a.cross(*to_b);
    let denominator = to_c.cross(*to_b);
    let affine = |k: usize| {
        let [a, b, c] = [corners[0][k], corners[1][k], corners[2][k]];
        a * denominator + (b - a) * u_numerator + (c - a) * v_numerator
    };
    let sign = if denominator.dot(*a + (*to_b + *to_c) / 3.0) < 0.0 { -1.0 } else { 1.0 };
    // Over the ray (x - cx, y - cy, 1).
    let form = |r: DVec3| {
        let r = r * sign;
        [r.x, r.y, r.z - r.x * centre[0] - r.y * centre[1]]
    };
    Some((std::array::from_fn(|k| form(affine(k))), form(denominator)))
}
