//! The convex hull of points in a plane.

use super::polygon::{Point, side};

/// Convex hull of points, counter-clockwise, without points on its sides; of a single point empty. By Andrew's monotone chains.
pub fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let chain = |points: &mut dyn Iterator<Item = &Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && side(a, b, *p) <= 0.0
            {
                chain.pop();
            }
            chain.push(*p);
        }
        // The end is the other chain's beginning.
        chain.pop();
        chain
    };
    let mut all = chain(&mut points.iter());
    all.extend(chain(&mut points.iter().rev()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_points_has_their_extreme_ones() {
        let points = vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [1.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]];
        assert_eq!(hull(points), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert!(hull(vec![[1.0, 2.0]]).is_empty() && hull(vec![]).is_empty());
    }
}
