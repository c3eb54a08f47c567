//! Faces of four or more corners, cut into facets.

use std::collections::BTreeSet;

use glam::DVec3;

/// Cuts a face of four or more corners into facets, by the rule of the [module](super) around this one.
pub(super) fn triangulate(corners: &[u32], vertices: &[DVec3], facets: &mut Vec<[u32; 3]>) {
    let n = corners.len();
    let at = |i: usize| vertices[corners[i] as usize];
    // Newell: the sum over the edges, about the first corner so that far-off coordinates keep their digits.
    let normal: DVec3 = (1..n - 1).map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0))).sum();
    let flat: Vec<[f64; 2]> = {
        let size = normal.abs();
        // Leaving out the largest component of the normal keeps the turn and the shape's convexity.
        let (u, v, sign) = if size.x >= size.y && size.x >= size.z {
            (1, 2, normal.x)
        } else if size.y >= size.z {
            (2, 0, normal.y)
        } else {
            (0, 1, normal.z)
        };
        let (u, v) = if sign < 0.0 { (v, u) } else { (u, v) };
        (0..n).map(|i| [at(i)[u], at(i)[v]]).collect()
    };
    let turn = |a: usize, b: usize, c: usize| {
        let point = |i: usize| robust::Coord { x: flat[i][0], y: flat[i][1] };
        robust::orient2d(point(a), point(b), point(c))
    };
    let mut push = |a: usize, b: usize, c: usize| facets.push([corners[a], corners[b], corners[c]]);
    if n == 4 {
        let first = turn(0, 1, 2) > 0.0 && turn(0, 2, 3) > 0.0;
        let second = turn(1, 2, 3) > 0.0 && turn(1, 3, 0) > 0.0;
        let shorter = (at(3) - at(1)).length_squared() < (at(2) - at(0)).length_squared();
        if second && (!first || shorter) {
            push(0, 1, 3);
            push(1, 2, 3);
        } else {
            push(0, 1, 2);
            push(0, 2, 3);
        }
        return;
    }
    let mut left = Left::new(n);
    while left.corners.len() > 3 {
        let k = left.first_ear(&flat, turn);
        let [a, b, c] = left.around(k);
        push(a, b, c);
        left.cut(k);
    }
    push(left.corners[0], left.corners[1], left.corners[2]);
}

/// The corners of a face that are left. Each may be an ear unless something says that it is not; then it is looked at again only once
/// that has changed.
struct Left {
    /// Ascending.
    corners: Vec<usize>,
    /// Those that may be ears.
    maybe: BTreeSet<usize>,
    /// For each corner those that are no ears because their triangle holds it.
    waiting: Vec<Vec<usize>>,
}

impl Left {
    fn new(n: usize) -> Self {
        Left { corners: (0..n).collect(), maybe: (0..n).collect(), waiting: vec![vec![]; n] }
    }

    /// The corner at a place, between its neighbours.
    fn around(&self, k: usize) -> [usize; 3] {
        let m = self.corners.len();
        [self.corners[(k + m - 1) % m], self.corners[k], self.corners[(k + 1) % m]]
    }

    /// The place of the first ear; the first one of all if there is none.
    fn first_ear(&mut self, flat: &[[f64; 2]], turn: impl Fn(usize, usize, usize) -> f64) -> usize {
        while let Some(&corner) = self.maybe.first() {
            let k = self.corners.partition_point(|c| *c < corner);
            let [a, b, c] = self.around(k);
            if turn(a, b, c) > 0.0 {
                let least = [0, 1].map(|k| flat[a][k].min(flat[b][k]).min(flat[c][k]));
                let most = [0, 1].map(|k| flat[a][k].max(flat[b][k]).max(flat[c][k]));
                let holds = |&p: &usize| {
                    (0..2).all(|k| least[k] <= flat[p][k] && flat[p][k] <= most[k])
                        // A corner that coincides with one of the triangle's is where the face touches itself.
                        && ![a, b, c].iter().any(|&q| flat[p] == flat[q])
                        && turn(a, b, p) >= 0.0
                        && turn(b, c, p) >= 0.0
                        && turn(c, a, p) >= 0.0
                };
                match self.corners.iter().copied().find(holds) {
                    None => return k,
                    Some(p) => self.waiting[p].push(corner),
                }
            }
            self.maybe.remove(&corner);
        }
        0
    }

    /// Takes the corner at a place away: its neighbours have another triangle now, and it is in nobody's.
    fn cut(&mut self, k: usize) {
        let [a, b, c] = self.around(k);
        self.corners.remove(k);
        self.maybe.remove(&b);
        self.maybe.extend([a, c]);
        for corner in std::mem::take(&mut self.waiting[b]) {
            if self.corners.binary_search(&corner).is_ok() {
                self.maybe.insert(corner);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets(polygon: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let vertices: Vec<DVec3> = polygon.iter().map(|p| DVec3::from_array(*p)).collect();
        let corners: Vec<u32> = (0..vertices.len() as u32).collect();
        let mut facets = Vec::new();
        triangulate(&corners, &vertices, &mut facets);
        facets
    }

    #[test]
    fn a_quad_is_cut_along_the_shorter_diagonal_inside() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(facets(&square), [[0, 1, 2], [0, 2, 3]]);
        let kite = [[0.0, 0.0, 0.0], [1.0, -0.1, 0.0], [4.0, 0.0, 0.0], [1.0, 0.1, 0.0]];
        assert_eq!(facets(&kite), [[0, 1, 3], [1, 2, 3]]);
        // An arrow head: the shorter diagonal, from 1 to 3, is outside.
        let arrow = [[0.0, 0.0, 0.0], [-0.9, -1.0, 0.0], [3.0, 0.0, 0.0], [-0.9, 1.0, 0.0]];
        assert_eq!(facets(&arrow), [[0, 1, 2], [0, 2, 3]]);
        // Seen from below, and standing upright: the same cuts.
        for map in
            [|p: [f64; 3]| [p[1], p[0], p[2]], |p: [f64; 3]| [p[2], p[0], p[1]], |p: [f64; 3]| [p[0], p[2], p[1]]]
        {
            assert_eq!(facets(&kite.map(map)), [[0, 1, 3], [1, 2, 3]]);
            assert_eq!(facets(&arrow.map(map)), [[0, 1, 2], [0, 2, 3]]);
        }
    }

    #[test]
    fn ears_cover_a_concave_face_exactly() {
        // A comb of 2 teeth: area by the shoelace formula 3*3 - 1*2 = 7.
        let comb = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let comb = comb.map(|[x, y]| [5.0, x, y]);
        let cut = facets(&comb);
        assert_eq!(cut.len(), 6);
        let mut sum = 0.0;
        for [a, b, c] in cut {
            let [a, b, c] = [a, b, c].map(|i| DVec3::from_array(comb[i as usize]));
            let twice = (b - a).cross(c - a).x;
            assert!(twice >= 0.0);
            sum += 0.5 * twice;
        }
        assert_eq!(sum, 7.0);
    }

    #[test]
    fn ears_are_cut_in_the_order_of_the_rule() {
        // Stars whose ears appear and vanish: the rule as it is worded, looked up anew for each ear.
        let mut random = 1_u64;
        for n in [5, 8, 30, 101] {
            let face: Vec<[f64; 3]> = (0..n)
                .map(|i| {
                    random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let (radius, angle) = (1.0 + (random >> 40) as f64 / 1e6, f64::from(i) * 6.25 / f64::from(n));
                    [radius * angle.cos(), radius * angle.sin(), 0.0]
                })
                .collect();
            let at = |i: usize| robust::Coord { x: face[i][0], y: face[i][1] };
            let turn = |a, b, c| robust::orient2d(at(a), at(b), at(c));
            let mut left: Vec<usize> = (0..face.len()).collect();
            let mut expected = vec![];
            while left.len() > 3 {
                let m = left.len();
                let corners = |k: usize| [left[(k + m - 1) % m], left[k], left[(k + 1) % m]];
                let is_ear = |k: &usize| {
                    let [a, b, c] = corners(*k);
                    let holds = |p: usize| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
                    turn(a, b, c) > 0.0 && !left.iter().any(|p| ![a, b, c].contains(p) && holds(*p))
                };
                let k = (0..m).find(is_ear).unwrap();
                expected.push(corners(k).map(|i| i as u32));
                left.remove(k);
            }
            expected.push([left[0], left[1], left[2]].map(|i| i as u32));
            assert_eq!(facets(&face), expected);
        }
    }

    #[test]
    fn faces_without_area_still_give_their_facets() {
        assert_eq!(facets(&[[1.0; 3]; 5]).len(), 3);
        assert_eq!(facets(&[[1.0; 3]; 4]).len(), 2);
    }
}
