//! Convex polygons in the plane.

/// Signed area: positive counter-clockwise in a right-handed (x right, y up) plane. Taken about the first vertex.
pub fn area(polygon: &[[f64; 2]]) -> f64 {
    let Some(&[x0, y0]) = polygon.first() else { return 0.0 };
    let mut twice = 0.0;
    for w in polygon[1..].windows(2) {
        twice += (w[0][0] - x0) * (w[1][1] - y0) - (w[1][0] - x0) * (w[0][1] - y0);
    }
    0.5 * twice
}
