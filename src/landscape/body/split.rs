//! A smooth function over a triangle from values and slopes at its corners: the reduced Clough-Tocher split (R. W. Clough and J. L. Tocher 1965, Proc. Conf.
//! Matrix Methods in Structural Mechanics; in Bernstein form as M.-J. Lai and L. L. Schumaker 2007, "Spline functions on triangulations", section 6.2).
//!
//! Three cubics that meet in the centroid. Along an edge the function depends on the edge's two corners alone, and so does its slope across the edge, which
//! goes linearly from one to the other: functions over neighbouring triangles meet with the same slopes. It reproduces quadratic functions.

use glam::DVec2;

/// A value and its slopes at a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub(super) at: DVec2,
    pub(super) value: f64,
    pub(super) slope: DVec2,
}

/// Value and slopes at a place of a triangle.
pub(super) fn smooth(corners: &[Corner; 3], place: DVec2) -> (f64, DVec2) {
    let centroid = (corners[0].at + corners[1].at + corners[2].at) / 3.0;
    // The part of the triangle that the place is in is opposite to the corner that it is farthest from.
    let weights = barycentric(corners.each_ref().map(|c| c.at), place);
    let apex = (0..3).min_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
    let (i, j) = ((apex + 1) % 3, (apex + 2) % 3);

    // Control values: next to a corner, towards another point.
    let near = |c: &Corner, point: DVec2| c.value + c.slope.dot(point - c.at) / 3.0;
    let inner = [0, 1, 2].map(|k| near(&corners[k], centroid));
    // In the middle of the part at edge (a, b): so that the slope across the edge is linear along it.
    let middle = |a: usize, b: usize| {
        let (p, q) = (&corners[a], &corners[b]);
        let along = q.at - p.at;
        let [alpha, beta, gamma] = directional([p.at, q.at, centroid], along.perp());
        let first = alpha * p.value + beta * near(p, q.at) + gamma * inner[a];
        let last = alpha * near(q, p.at) + beta * q.value + gamma * inner[b];
        (0.5 * (first + last) - alpha * near(p, q.at) - beta * near(q, p.at)) / gamma
    };
    let middles = [middle(1, 2), middle(2, 0), middle(0, 1)];
    // Between a corner and the centroid: the mean of the three around it, as the centroid is that of the corners.
    let towards = |k: usize| (inner[k] + middles[(k + 1) % 3] + middles[(k + 2) % 3]) / 3.0;
    let centre = (towards(0) + towards(1) + towards(2)) / 3.0;

    // De Casteljau's steps over the part (i, j, centroid).
    let (p, q) = (&corners[i], &corners[j]);
    let part = [p.at, q.at, centroid];
    let [u, v, w] = barycentric(part, place);
    let mix = |a: f64, b: f64, c: f64| u * a + v * b + w * c;
    let rows = [
        [p.value, near(p, q.at), inner[i]],
        [near(p, q.at), near(q, p.at), middles[apex]],
        [inner[i], middles[apex], towards(i)],
        [near(q, p.at), q.value, inner[j]],
        [middles[apex], inner[j], towards(j)],
        [towards(i), towards(j), centre],
    ]
    .map(|[a, b, c]| mix(a, b, c));
    // rows: uu, uv, uw, vv, vw, ww.
    let tips = [mix(rows[0], rows[1], rows[2]), mix(rows[1], rows[3], rows[4]), mix(rows[2], rows[4], rows[5])];
    let value = mix(tips[0], tips[1], tips[2]);
    let slope = |direction: DVec2| {
        let [a, b, c] = directional(part, direction);
        3.0 * (a * tips[0] + b * tips[1] + c * tips[2])
    };
    (value, DVec2::new(slope(DVec2::X), slope(DVec2::Y)))
}

/// Barycentric coordinates of a place.
pub(super) fn barycentric([a, b, c]: [DVec2; 3], place: DVec2) -> [f64; 3] {
    let area = (b - a).perp_dot(c - a);
    let v = (place - a).perp_dot(c - a) / area;
    let w = (b - a).perp_dot(place - a) / area;
    [1.0 - v - w, v, w]
}

/// Barycentric coordinates of a direction: their sum is 0.
fn directional([a, b, c]: [DVec2; 3], direction: DVec2) -> [f64; 3] {
    let area = (b - a).perp_dot(c - a);
    let v = direction.perp_dot(c - a) / area;
    let w = (b - a).perp_dot(direction) / area;
    [-v - w, v, w]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f64, y: f64, f: impl Fn(f64, f64) -> (f64, DVec2)) -> Corner {
        let (value, slope) = f(x, y);
        Corner { at: DVec2::new(x, y), value, slope }
    }

    #[test]
    fn quadratic_functions_come_back_exactly() {
        let f = |x: f64, y: f64| {
            (
                1.0 + 2.0 * x - y + 0.5 * x * x - 3.0 * x * y + 0.7 * y * y,
                DVec2::new(2.0 + x - 3.0 * y, -1.0 - 3.0 * x + 1.4 * y),
            )
        };
        let corners = [corner(0.0, 0.0, f), corner(5.0, 1.0, f), corner(2.0, 4.0, f)];
        for (x, y) in [(0.0, 0.0), (5.0, 1.0), (2.4, 1.7), (2.0, 1.0), (3.0, 2.5), (7.0 / 3.0, 5.0 / 3.0), (1.0, 2.0)] {
            let (value, slope) = smooth(&corners, DVec2::new(x, y));
            let expected = f(x, y);
            assert!(
                (value - expected.0).abs() < 1e-12 && (slope - expected.1).length() < 1e-12,
                "{x} {y}: {value} {slope}"
            );
        }
    }

    #[test]
    fn neighbours_meet_smoothly_whatever_their_corners_have() {
        // Anything at all at four corners of two triangles.
        let any = |k: f64| (k.sin() * 3.0, DVec2::new((7.0 * k).cos(), (5.0 * k).sin()));
        let [a, b, c, d] = [(0.0, 0.0, 1.0), (4.0, 0.5, 2.0), (3.0, 3.0, 3.0), (0.5, 4.0, 4.0)]
            .map(|(x, y, k)| corner(x, y, |_, _| any(k)));
        let (one, two) = ([a, b, c], [a, c, d]);
        for k in 0..=20 {
            let place = a.at.lerp(c.at, f64::from(k) / 20.0);
            let (left, right) = (smooth(&one, place), smooth(&two, place));
            assert!((left.0 - right.0).abs() < 1e-12 && (left.1 - right.1).length() < 1e-11, "{k}");
        }
        // And so do the three parts of one triangle.
        let centroid = (a.at + b.at + c.at) / 3.0;
        for k in 1..20 {
            let on = b.at.lerp(centroid, f64::from(k) / 20.0);
            let across = (centroid - b.at).perp().normalize() * 1e-7;
            let (left, right) = (smooth(&one, on + across), smooth(&one, on - across));
            assert!((left.0 - right.0).abs() < 1e-6 && (left.1 - right.1).length() < 1e-5, "{k}");
        }
        // Slopes are those of the values.
        let place = DVec2::new(2.1, 0.8);
        let h = 1e-6;
        let by_differences = DVec2::new(
            smooth(&one, place + DVec2::X * h).0 - smooth(&one, place - DVec2::X * h).0,
            smooth(&one, place + DVec2::Y * h).0 - smooth(&one, place - DVec2::Y * h).0,
        ) / (2.0 * h);
        assert!((smooth(&one, place).1 - by_differences).length() < 1e-8);
    }
}
