//! Form factors: the share of what a Lambert surface sends out that arrives at another one; also, of an element, its irradiance over the exitance of
//! what it sees.
//!
//! Numbers such as C-11 are those of Howell, *A Catalog of Radiation Heat Transfer Configuration Factors* (2010). Lengths are in one unit, whichever it is.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::angle_rad;

/// Form factor of two equal, opposite rectangles a x b (Howell C-11).
pub fn parallel_rectangles(a: f64, b: f64, distance: f64) -> f64 {
    let (x, y) = (a / distance, b / distance);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let sum = 0.5 * ((1.0 + x * x) * (1.0 + y * y) / (1.0 + x * x + y * y)).ln()
        + x * ry * (x / ry).atan()
        + y * rx * (y / rx).atan()
        - x * x.atan()
        - y * y.atan();
    2.0 / (PI * x * y) * sum
}

/// Form factor from a rectangle of width `w1` to one of height `h2` at right angles, with a common edge (Howell C-14).
pub fn perpendicular_rectangles(common: f64, w1: f64, h2: f64) -> f64 {
    let (h, w) = (h2 / common, w1 / common);
    let (h_2, w_2) = (h * h, w * w);
    let (both, all) = (h_2 + w_2, 1.0 + h_2 + w_2);
    let logs = ((1.0 + w_2) * (1.0 + h_2) / all).ln()
        + w_2 * (w_2 * all / ((1.0 + w_2) * both)).ln()
        + h_2 * (h_2 * all / ((1.0 + h_2) * both)).ln();
    let arcs = w * (1.0 / w).atan() + h * (1.0 / h).atan() - both.sqrt() * (1.0 / both.sqrt()).atan();
    (arcs + 0.25 * logs) / (PI * w)
}

/// Form factor from an endless strip of width `w1` to one of height `h2` at right angles, with a common edge (Howell C-9).
pub fn perpendicular_strips(w1: f64, h2: f64) -> f64 {
    0.5 * (1.0 + h2 / w1 - (h2 / w1).hypot(1.0))
}

/// Form factor from a disc of radius `r1` to one of `r2` on the same axis, `distance` apart (Howell C-41).
pub fn coaxial_discs(r1: f64, r2: f64, distance: f64) -> f64 {
    let (x, y) = (r1 / distance, r2 / distance);
    let s = 1.0 + (1.0 + y * y) / (x * x);
    // (s - sqrt(s^2 - 4 (y/x)^2)) / 2, without its cancellation.
    2.0 * (y / x).powi(2) / (s + (s * s - 4.0 * (y / x).powi(2)).sqrt())
}

/// Form factor from an element to a disc of this radius that faces it, at this distance on its normal (Howell B-12): sin^2 of the disc's angular radius.
pub fn element_to_coaxial_disc(radius: f64, distance: f64) -> f64 {
    radius * radius / (radius * radius + distance * distance)
}

/// Form factor from an element at the origin with this unit normal to the part of a planar polygon that is above its horizon.
///
/// Source: Lambert's contour sum, (1 / 2 pi) sum over edges of (angle of the edge) (normal of the element . normal of the plane through edge
/// and element). Limits: a polygon that does not cross itself, either way around, not through the origin.
pub fn element_to_polygon(normal: DVec3, polygon: &[DVec3]) -> f64 {
    let mut above = Vec::new();
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (height_a, height_b) = (normal.dot(a), normal.dot(b));
        if height_a > 0.0 {
            above.push(a);
        }
        if (height_a > 0.0) != (height_b > 0.0) {
            above.push(a + (b - a) * (height_a / (height_a - height_b)));
        }
    }
    let edges = (0..above.len()).map(|i| {
        let (a, b) = (above[i], above[(i + 1) % above.len()]);
        angle_rad(a, b) * normal.dot(a.cross(b).normalize_or_zero())
    });
    (edges.sum::<f64>() / (2.0 * PI)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_is_closed() {
        let (opposite, beside) = (parallel_rectangles(1.0, 1.0, 1.0), perpendicular_rectangles(1.0, 1.0, 1.0));
        assert!((opposite - 0.199_824_895_7).abs() < 1e-10 && (beside - 0.200_043_776_1).abs() < 1e-10);
        assert!((opposite + 4.0 * beside - 1.0).abs() < 1e-14);
    }

    #[test]
    fn rectangles_strips_and_discs() {
        // Computed independently.
        assert!((parallel_rectangles(1.0, 1.0, 0.1) / 0.826_994_522_397_256_6 - 1.0).abs() < 1e-12);
        assert!((parallel_rectangles(1.0, 1.0, 10.0) / 0.003_162_056_838_757_601_5 - 1.0).abs() < 1e-11);
        assert!((perpendicular_rectangles(1.0, 2.0, 1.0) / 0.116_426_301_397_680_94 - 1.0).abs() < 1e-12);
        assert!((perpendicular_strips(1.0, 1.0) - (1.0 - 0.5f64.sqrt())).abs() < 1e-15);
        assert!((coaxial_discs(1.0, 1.0, 1.0) - 0.5 * (3.0 - 5f64.sqrt())).abs() < 1e-15);
        assert!((element_to_coaxial_disc(1.0, 2.0) - 0.2).abs() < 1e-16);
        // Reciprocity: areas times form factors, both ways.
        assert!(
            (2.0 * perpendicular_rectangles(1.0, 2.0, 1.0) - perpendicular_rectangles(1.0, 1.0, 2.0)).abs() < 1e-14
        );
        // A small disc is an element.
        assert!((coaxial_discs(1e-5, 1.0, 2.0) - 0.2).abs() < 1e-10);
    }

    #[test]
    fn a_triangle_across_the_horizon() {
        // Computed independently; a quadrature agrees.
        let triangle = [DVec3::new(-1.0, 0.5, 2.0), DVec3::new(2.0, 0.0, 1.0), DVec3::new(0.5, 2.0, -1.0)];
        let turned = [triangle[2], triangle[1], triangle[0]];
        for (normal, expected) in
            [(DVec3::Z, 0.289_067_586_753_677_05), (DVec3::new(0.6, 0.0, 0.8), 0.339_520_133_249_013_37)]
        {
            assert!((element_to_polygon(normal, &triangle) / expected - 1.0).abs() < 1e-13);
            assert!((element_to_polygon(normal, &turned) / expected - 1.0).abs() < 1e-13);
        }
        assert_eq!(element_to_polygon(DVec3::new(0.0, -1.0, 0.0), &triangle[..0]), 0.0);
        assert_eq!(element_to_polygon(DVec3::Z, &triangle.map(|p| p - 5.0 * DVec3::Z)), 0.0);
    }

    #[test]
    fn a_wide_polygon_is_all_that_is_seen() {
        let square =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(1e6 * x, 1e6 * y, 1.0));
        assert!((element_to_polygon(DVec3::Z, &square) - 1.0).abs() < 1e-11);
    }
}
