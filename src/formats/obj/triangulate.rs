//! Faces of four or more corners, cut into facets.

use glam::DVec3;

/// Cuts a face of four or more corners into facets, by the rule of the [module](super) around this one.
pub(in crate::formats) fn triangulate(corners: &[u32], vertices: &[DVec3], facets: &mut Vec<[u32; 3]>) {
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
    let mut left: Vec<usize> = (0..n).collect();
    while left.len() > 3 {
        let m = left.len();
        let is_ear = |&k: &usize| {
            let (a, b, c) = (left[(k + m - 1) % m], left[k], left[(k + 1) % m]);
            let holds = |&p: &usize| {
                // A corner that coincides with one of the triangle's is where the face touches itself.
                ![a, b, c].iter().any(|&q| flat[p] == flat[q])
                    && turn(a, b, p) >= 0.0
                    && turn(b, c, p) >= 0.0
                    && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 0.0 && !left.iter().any(holds)
        };
        let k = (0..m).find(|k| is_ear(k)).unwrap_or(0);
        push(left[(k + m - 1) % m], left[k], left[(k + 1) % m]);
        left.remove(k);
    }
    push(left[0], left[1], left[2]);
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
    fn faces_without_area_still_give_their_facets() {
        assert_eq!(facets(&[[1.0; 3]; 5]).len(), 3);
        assert_eq!(facets(&[[1.0; 3]; 4]).len(), 2);
    }
}
