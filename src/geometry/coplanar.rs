//! Where the triangles of two surfaces, triangulated differently, overlap.

use glam::DVec3;
use rayon::prelude::*;

use super::polygon::{Point, area, intersect};
use super::{Facet, Mesh, index_u32, whole};

/// Cells along an axis of the grid, at most: three numbers fit into a key.
const CELLS: f64 = (1u64 << 20) as f64;
/// Facets that are worked on together.
const CHUNK: usize = 4096;

/// Common parts of facets and triangles: convex polygons in (u, v) of a facet, point = a + u (b - a) + v (c - a).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overlaps {
    /// The facet of each polygon, ascending.
    pub polygon_facet: Vec<u32>,
    /// The triangle of each polygon, ascending within a facet.
    pub polygon_triangle: Vec<u32>,
    /// First vertex of each polygon, and the number of vertices as the last element.
    pub polygon_start: Vec<usize>,
    /// Vertices of the polygons.
    pub uv: Vec<Point>,
}

impl Overlaps {
    /// A polygon.
    pub fn polygon(&self, i: usize) -> &[Point] {
        &self.uv[self.polygon_start[i]..self.polygon_start[i + 1]]
    }

    fn append(&mut self, other: Overlaps) {
        let base = self.uv.len();
        self.polygon_facet.extend(other.polygon_facet);
        self.polygon_triangle.extend(other.polygon_triangle);
        self.polygon_start.extend(other.polygon_start.iter().skip(1).map(|start| base + start));
        self.uv.extend(other.uv);
    }
}

/// The common parts of a mesh's facets with triangles that lie in the same plane and face the same way.
///
/// `tolerance_m` is the accuracy of the coordinates: corners within it of a plane or an edge lie on it, and what is narrower is
/// not told. Of a facet and a triangle, the larger one's plane counts.
pub fn overlaps(mesh: &Mesh, triangles: &[Facet], tolerance_m: f64) -> Overlaps {
    let mut all = Overlaps { polygon_start: vec![0], ..Overlaps::default() };
    let Some(grid) = Grid::new(triangles, tolerance_m) else { return all };
    let facets = mesh.facets.len();
    let parts: Vec<Overlaps> = (0..facets.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut part = Overlaps { polygon_start: vec![0], ..Overlaps::default() };
            let (mut candidates, mut common, mut spare) = (Vec::new(), Vec::new(), Vec::new());
            for f in chunk * CHUNK..facets.min((chunk + 1) * CHUNK) {
                let Some(facet) = Plane::of(mesh.facet(f)) else { continue };
                grid.near(&facet.facet, &mut candidates);
                for &t in &candidates {
                    let Some(triangle) = Plane::of(triangles[t as usize]) else { continue };
                    if facet.is_coplanar(&triangle, tolerance_m) {
                        facet.common(&triangle.facet, tolerance_m, &mut common, &mut spare);
                        if !common.is_empty() {
                            part.polygon_facet.push(index_u32(f));
                            part.polygon_triangle.push(t);
                            part.uv.extend_from_slice(&common);
                            part.polygon_start.push(part.uv.len());
                        }
                    }
                }
            }
            part
        })
        .collect();
    parts.into_iter().for_each(|part| all.append(part));
    all
}

/// A facet that has an area.
struct Plane {
    facet: Facet,
    /// Twice the area, m2.
    twice_m2: f64,
    normal: DVec3,
}

impl Plane {
    fn of(facet: Facet) -> Option<Self> {
        let cross = facet.cross_m2();
        let twice_m2 = cross.length();
        (twice_m2 > 0.0).then(|| Plane { facet, twice_m2, normal: cross / twice_m2 })
    }

    fn is_coplanar(&self, other: &Plane, tolerance_m: f64) -> bool {
        let (large, small) = if self.twice_m2 < other.twice_m2 { (other, self) } else { (self, other) };
        let height_m = |p: &DVec3| (*p - large.facet.corners_m[0]).dot(large.normal).abs();
        self.normal.dot(other.normal) > 0.0 && small.facet.corners_m.iter().all(|p| height_m(p) <= tolerance_m)
    }

    /// What a triangle in this plane has in common with the facet, in (u, v); empty if it is narrower than the tolerance.
    fn common(&self, triangle: &Facet, tolerance_m: f64, out: &mut Vec<Point>, spare: &mut Vec<Point>) {
        let [a, b, c] = self.facet.corners_m;
        let (ab, ac) = (b - a, c - a);
        let per_area = self.normal / self.twice_m2;
        // Of u, v and 1 - u - v: what the tolerance is.
        let [du, dv, dw] = [ac, ab, c - b].map(|edge| tolerance_m * edge.length() / self.twice_m2);
        let corner = |p: DVec3| {
            let (mut u, mut v) = ((p - a).cross(ac).dot(per_area), ab.cross(p - a).dot(per_area));
            if u.abs() <= du {
                u = 0.0;
            }
            if v.abs() <= dv {
                v = 0.0;
            }
            let w = 1.0 - u - v;
            if w.abs() <= dw {
                (u, v) = match (u == 0.0, v == 0.0) {
                    (true, _) => (0.0, 1.0),
                    (_, true) => (1.0, 0.0),
                    _ => (u + 0.5 * w, 1.0 - (u + 0.5 * w)),
                };
            }
            [u, v]
        };
        intersect(&triangle.corners_m.map(corner), &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], out, spare);
        let edge_m = |(p, q): (&Point, &Point)| ((q[0] - p[0]) * ab + (q[1] - p[1]) * ac).length();
        let longest_m = out.iter().zip(out.iter().cycle().skip(1)).map(edge_m).fold(0.0, f64::max);
        if area(out) * self.twice_m2 <= tolerance_m * longest_m {
            out.clear();
        }
    }
}

/// Which triangles are near a place: cells as large as triangles are long, in the mean of squares, so that there are about as
/// many as triangles.
struct Grid {
    low_m: DVec3,
    cell_m: f64,
    reach_m: f64,
    triangles: usize,
    /// Cell and triangle, ascending, each pair once.
    entries: Vec<(u64, u32)>,
}

impl Grid {
    fn new(triangles: &[Facet], reach_m: f64) -> Option<Self> {
        let corners = || triangles.iter().flat_map(|t| t.corners_m);
        let low_m = corners().reduce(DVec3::min)?;
        let extent_m = (corners().reduce(DVec3::max)? - low_m).max_element();
        let squares: f64 = triangles.iter().map(|t| longest_m2(&t.corners_m).1).sum();
        let cell_m = (squares / triangles.len() as f64).sqrt().max(extent_m / CELLS).max(reach_m);
        if !(cell_m > 0.0 && cell_m.is_finite()) {
            return None;
        }
        let mut grid =
            Grid { low_m: low_m - reach_m, cell_m, reach_m, triangles: triangles.len(), entries: Vec::new() };
        let parts: Vec<Vec<(u64, u32)>> = triangles
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, part)| {
                let (mut entries, mut keys) = (Vec::new(), Vec::new());
                for (i, triangle) in part.iter().enumerate() {
                    grid.keys(triangle, &mut keys);
                    entries.extend(keys.iter().map(|key| (*key, index_u32(chunk * CHUNK + i))));
                }
                entries
            })
            .collect();
        grid.entries = parts.concat();
        grid.entries.par_sort_unstable();
        Some(grid)
    }

    /// Triangles that may touch a facet, ascending.
    fn near(&self, facet: &Facet, out: &mut Vec<u32>) {
        out.clear();
        // Where looking into cells would take longer than looking at all triangles.
        if longest_m2(&facet.corners_m).1 > self.cell_m * self.cell_m * self.triangles as f64 {
            out.extend(0..index_u32(self.triangles));
            return;
        }
        let mut keys = Vec::new();
        self.keys(facet, &mut keys);
        for key in keys {
            let first = self.entries.partition_point(|e| e.0 < key);
            out.extend(self.entries[first..].iter().take_while(|e| e.0 == key).map(|e| e.1));
        }
        out.sort_unstable();
        out.dedup();
    }

    /// The cells that a triangle may touch, ascending.
    fn keys(&self, triangle: &Facet, keys: &mut Vec<u64>) {
        keys.clear();
        let mut pieces = vec![triangle.corners_m];
        while let Some(piece) = pieces.pop() {
            let (i, longest_m2) = longest_m2(&piece);
            if longest_m2 > self.cell_m * self.cell_m {
                let [p, q, r] = [piece[i], piece[(i + 1) % 3], piece[(i + 2) % 3]];
                let middle = 0.5 * (p + q);
                pieces.extend([[p, middle, r], [middle, q, r]]);
                continue;
            }
            let [p, q, r] = piece;
            // Whole cells from the corner of the grid; anything outside it belongs to no cell.
            let cell = |p: DVec3| {
                ((p - self.low_m) / self.cell_m).floor().clamp(DVec3::splat(-1.0), DVec3::splat(2.0 * CELLS - 1.0))
            };
            let (low, high) = (cell(p.min(q).min(r) - self.reach_m), cell(p.max(q).max(r) + self.reach_m));
            if high.min_element() < 0.0 {
                continue;
            }
            let range = |axis: usize| whole(low[axis]) as u64..=whole(high[axis]) as u64;
            for x in range(0) {
                for y in range(1) {
                    keys.extend(range(2).map(|z| x << 42 | y << 21 | z));
                }
            }
        }
        keys.sort_unstable();
        keys.dedup();
    }
}

/// The first corner of a triangle's longest edge, and that edge's length squared.
fn longest_m2(corners_m: &[DVec3; 3]) -> (usize, f64) {
    let length = |i: usize| (i, corners_m[i].distance_squared(corners_m[(i + 1) % 3]));
    (0..3).map(length).fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a })
}

/// Areas of common parts, m2, added up for each facet and each triangle.
pub fn areas_m2(mesh: &Mesh, triangles: usize, overlaps: &Overlaps) -> (Vec<f64>, Vec<f64>) {
    let (mut of_facet, mut of_triangle) = (vec![0.0; mesh.facets.len()], vec![0.0; triangles]);
    for (i, (f, t)) in overlaps.polygon_facet.iter().zip(&overlaps.polygon_triangle).enumerate() {
        let area_m2 = area(overlaps.polygon(i)) * mesh.facet(*f as usize).cross_m2().length();
        of_facet[*f as usize] += area_m2;
        of_triangle[*t as usize] += area_m2;
    }
    (of_facet, of_triangle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MaterialId;

    fn triangle(corners: [[f64; 3]; 3]) -> Facet {
        Facet { corners_m: corners.map(DVec3::from_array) }
    }

    /// Two facets on a square of 2 m, tilted: z = x / 2.
    fn square() -> Mesh {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 0.0]];
        Mesh {
            vertices_m: corners.map(DVec3::from_array).to_vec(),
            facets: vec![[0, 1, 2], [0, 2, 3]],
            material: vec![MaterialId(0); 2],
            face_of_facet: vec![],
            uv: vec![],
        }
    }

    #[test]
    fn the_other_diagonal_halves_both_triangles() {
        let others = [
            triangle([[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.0, 2.0, 0.0]]),
            triangle([[2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 0.0]]),
            // The first from behind, one above it, and one beside it that shares an edge.
            triangle([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 0.0, 1.0]]),
            triangle([[0.0, 0.0, 0.1], [2.0, 0.0, 1.1], [0.0, 2.0, 0.1]]),
            triangle([[0.0, 0.0, 0.0], [1.0, -1.0, 0.5], [2.0, 0.0, 1.0]]),
        ];
        let mesh = square();
        let found = overlaps(&mesh, &others, 1e-9);
        assert_eq!(found.polygon_facet, [0, 0, 1, 1]);
        assert_eq!(found.polygon_triangle, [0, 1, 0, 1]);
        // A quarter of 2 x sqrt(5) m2 each.
        let (of_facet, of_triangle) = areas_m2(&mesh, others.len(), &found);
        let half = 5.0_f64.sqrt();
        assert!(of_facet.iter().all(|a| (a - half).abs() < 1e-12), "{of_facet:?}");
        assert!(of_triangle[..2].iter().all(|a| (a - half).abs() < 1e-12) && of_triangle[2..] == [0.0; 3]);
        // Facet 0 has corners (0, 0), (2, 0), (2, 2): of the first triangle it holds (0, 0), (2, 0), (1, 1) = a + 0 (b - a) +
        // (c - a) / 2.
        let mut corners = found.polygon(0).to_vec();
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [[0.0, 0.0], [0.0, 0.5], [1.0, 0.0]]);
    }

    #[test]
    fn rounded_coordinates_are_the_same_facets() {
        // Facets of about 1 m up to 1000 m away, rounded to f32: whole facets come back, and nothing else.
        let mesh = square();
        let far = DVec3::new(731.3, -412.7, 55.1);
        let mut fine = Mesh::default();
        for i in 0..20 {
            for j in 0..20 {
                let at = far + DVec3::new(2.0 * f64::from(i), 2.0 * f64::from(j), f64::from(i));
                let mut one = mesh.clone();
                one.vertices_m.iter_mut().for_each(|v| *v += at);
                fine.append(one);
            }
        }
        let rounded = |v: DVec3| v.as_vec3().as_dvec3();
        let others: Vec<Facet> =
            (0..fine.facets.len()).map(|f| Facet { corners_m: fine.facet(f).corners_m.map(rounded) }).collect();
        let found = overlaps(&fine, &others, 4.0 * 1000.0 * 2.0_f64.powi(-24));
        assert_eq!(found.polygon_facet, found.polygon_triangle);
        assert_eq!(found.polygon_facet.len(), 800);
        assert!((0..800).all(|i| area(found.polygon(i)) == 0.5), "whole facets");
    }

    #[test]
    fn one_large_triangle_and_many_small_ones() {
        let large = Mesh { facets: vec![[0, 1, 2]], material: vec![MaterialId(0)], ..square() };
        let mut small = Vec::new();
        let at = |i: i32, j: i32| [f64::from(i) / 50.0, f64::from(j) / 50.0, f64::from(i) / 100.0];
        for i in 0..100 {
            for j in 0..100 {
                small.push(triangle([at(i, j), at(i + 1, j), at(i + 1, j + 1)]));
                small.push(triangle([at(i, j), at(i + 1, j + 1), at(i, j + 1)]));
            }
        }
        let found = overlaps(&large, &small, 1e-12);
        // Below the diagonal: 100 x 101 / 2 lower ones and 100 x 99 / 2 upper ones.
        assert_eq!(found.polygon_facet.len(), 10_000);
        assert!((areas_m2(&large, small.len(), &found).0[0] - 5.0_f64.sqrt()).abs() < 1e-12);
        let turned: Vec<Facet> = vec![large.facet(0)];
        let mut fine = Mesh::default();
        for t in &small {
            let base = fine.vertices_m.len() as u32;
            fine.vertices_m.extend(t.corners_m);
            fine.facets.push([base, base + 1, base + 2]);
        }
        assert_eq!(overlaps(&fine, &turned, 1e-12).polygon_facet.len(), 10_000);
        assert!(overlaps(&fine, &[], 1e-12).polygon_facet.is_empty());
    }

    #[test]
    fn points_and_needles_do_no_harm() {
        let others = [triangle([[1.0; 3]; 3]), triangle([[0.0; 3], [1e9, 0.0, 5e8], [1e9, 1e-9, 5e8]])];
        assert!(overlaps(&square(), &others, 1e-9).polygon_facet.len() <= 2);
        assert!(overlaps(&square(), &others[..1], 0.0).polygon_facet.is_empty());
    }
}
