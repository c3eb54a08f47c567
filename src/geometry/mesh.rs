//! Triangle meshes: what everything else is computed on.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{index_u32, whole};
use crate::units::GOLDEN;

/// Index of a material in [`Scene::materials`](crate::scene::Scene).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MaterialId(pub u16);

/// A triangle mesh, in metres, local to the scene's origin. Facets are counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertices, m.
    pub vertices_m: Vec<DVec3>,
    /// Three vertex indices for each facet.
    pub facets: Vec<[u32; 3]>,
    /// The material of each facet.
    pub material: Vec<MaterialId>,
    /// The face (polygon of the input, counted from 0 through all meshes) that each facet was cut from.
    /// Empty: facet i is face i.
    pub face_of_facet: Vec<u32>,
    /// Texture coordinates of each facet's corners: u to the right of an image, v up, both 0 to 1; NaN where a facet has none.
    /// Empty: no facet has any.
    pub uv: Vec<[[f64; 2]; 3]>,
}

/// One facet's corners, with what follows from them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// Corners, m, counter-clockwise seen from outside.
    pub corners_m: [DVec3; 3],
}

impl Facet {
    /// Twice the area times the unit normal, m2.
    pub fn cross_m2(&self) -> DVec3 {
        let [a, b, c] = self.corners_m;
        (b - a).cross(c - a)
    }

    /// Unit normal; the zero vector for a facet without area.
    pub fn normal(&self) -> DVec3 {
        self.cross_m2().normalize_or_zero()
    }

    /// Area, m2.
    pub fn area_m2(&self) -> f64 {
        0.5 * self.cross_m2().length()
    }

    /// Mean of the corners, m.
    pub fn centroid_m(&self) -> DVec3 {
        let [a, b, c] = self.corners_m;
        (a + b + c) / 3.0
    }

    /// Where a ray from `from_m`, which meets the facet, meets its plane, in lengths of `ray`.
    ///
    /// Within `EDGE_ON` of the plane rounding would decide; there it is at least no nearer or farther than the corners.
    pub fn met_by(&self, from_m: DVec3, ray: DVec3) -> f64 {
        let normal = self.cross_m2();
        let along = normal.dot(ray);
        let met = normal.dot(self.corners_m[0] - from_m) / along;
        if along * along > EDGE_ON * EDGE_ON * normal.length_squared() * ray.length_squared() {
            return met;
        }
        let [a, b, c] = self.corners_m.map(|p| (p - from_m).dot(ray) / ray.length_squared());
        let (nearest, farthest) = (a.min(b).min(c), a.max(b).max(c));
        if met.is_nan() { 0.5 * (nearest + farthest) } else { met.max(nearest).min(farthest) }
    }

    /// The point with barycentric coordinates (1 - u - v, u, v), m.
    pub fn point_m(&self, u: f64, v: f64) -> DVec3 {
        let [a, b, c] = self.corners_m;
        a + u * (b - a) + v * (c - a)
    }
}

/// Sine of the angle between a ray and a plane that it nearly lies in.
const EDGE_ON: f64 = 1e-6;

/// Normals of closed meshes, times areas, add up to no more than this share of the area: coordinates are often of 6 digits, and unwelded.
const CLOSED: f64 = 1e-4;
/// A volume that is no larger than this share of the parts that it is the sum of is rounding.
const NO_VOLUME: f64 = 64.0 * f64::EPSILON;

/// Texture coordinates of a facet that has none.
pub const NO_UV: [[f64; 2]; 3] = [[f64::NAN; 2]; 3];

impl Mesh {
    /// Some of its facets, ascending, with the vertices that they use; each facet's face is that which it had.
    #[must_use]
    pub fn part(&self, facets: &[u32]) -> Mesh {
        let mut used: Vec<u32> = facets.iter().flat_map(|facet| self.facets[*facet as usize]).collect();
        used.sort_unstable();
        used.dedup();
        let place = |vertex: u32| index_u32(used.partition_point(|of| *of < vertex));
        let of_facet = |facet: &u32| self.face_of_facet.get(*facet as usize).copied().unwrap_or(*facet);
        let uv = |facet: &u32| self.uv.get(*facet as usize).copied();
        Mesh {
            vertices_m: used.iter().map(|vertex| self.vertices_m[*vertex as usize]).collect(),
            facets: facets.iter().map(|facet| self.facets[*facet as usize].map(place)).collect(),
            material: facets.iter().map(|facet| self.material[*facet as usize]).collect(),
            face_of_facet: facets.iter().map(of_facet).collect(),
            uv: facets.iter().map_while(uv).collect(),
        }
    }

    /// A facet.
    pub fn facet(&self, facet: usize) -> Facet {
        let [a, b, c] = self.facets[facet];
        Facet { corners_m: [self.vertices_m[a as usize], self.vertices_m[b as usize], self.vertices_m[c as usize]] }
    }

    /// The face that a facet was cut from.
    pub fn face(&self, facet: usize) -> u32 {
        self.face_of_facet.get(facet).copied().unwrap_or(index_u32(facet))
    }

    /// At most `count` facets, spread evenly over the mesh's order without falling into step with a grid: all of them
    /// if there are no more.
    pub fn spread(&self, count: usize) -> impl Iterator<Item = usize> + Clone {
        let facets = self.facets.len();
        // Multiples of the golden ratio, modulo 1, are never far apart nor close together.
        let place = move |i: usize| whole((i as f64 * GOLDEN).fract() * facets as f64);
        (0..facets.min(count)).map(move |i| if facets <= count { i } else { place(i) })
    }

    /// Appends another mesh, whose material ids already mean the same.
    pub fn append(&mut self, other: Mesh) {
        self.append_all([other]);
    }

    /// Appends other meshes, whose material ids already mean the same.
    pub fn append_all(&mut self, others: impl IntoIterator<Item = Mesh>) {
        // Faces so far, once they are counted: not anew for each of many small meshes.
        let mut faces: Option<u32> = None;
        for other in others {
            let base = index_u32(self.vertices_m.len());
            if !self.face_of_facet.is_empty() || !other.face_of_facet.is_empty() {
                if self.face_of_facet.is_empty() {
                    self.face_of_facet.extend(0..index_u32(self.facets.len()));
                }
                let before = faces.unwrap_or_else(|| self.face_of_facet.iter().max().map_or(0, |f| f + 1));
                self.face_of_facet.extend((0..other.facets.len()).map(|i| before + other.face(i)));
                let more = (0..other.facets.len()).map(|i| other.face(i) + 1).max();
                faces = Some(before + more.unwrap_or(0));
            }
            if !self.uv.is_empty() || !other.uv.is_empty() {
                self.uv.resize(self.facets.len(), NO_UV);
                self.uv.extend(&other.uv);
                self.uv.resize(self.facets.len() + other.facets.len(), NO_UV);
            }
            self.vertices_m.extend(other.vertices_m);
            self.facets.extend(other.facets.iter().map(|f| f.map(|v| v + base)));
            self.material.extend(other.material);
        }
    }

    /// Turns every facet over: what was its inner side is its outer one.
    pub fn flip(&mut self) {
        self.facets.iter_mut().for_each(|facet| facet.swap(1, 2));
        self.uv.iter_mut().for_each(|uv| uv.swap(1, 2));
    }

    /// The sum of the facets' areas as vectors along their normals, m2, and that of their sizes. The first is 0 for what is closed; of a
    /// sheet it is the way that it faces.
    pub fn vector_area_m2(&self) -> (DVec3, f64) {
        let corners_m = self.facets.iter().map(|facet| facet.map(|v| self.vertices_m[v as usize]));
        let cross_m2 = corners_m.map(|corners_m| Facet { corners_m }.cross_m2());
        let (sum_m2, size_m2) = cross_m2.fold((DVec3::ZERO, 0.0), |(sum, size), v| (sum + v, size + v.length()));
        (0.5 * sum_m2, 0.5 * size_m2)
    }

    /// The volume within facets that enclose one, m3: below 0 if they face inwards. `None` for a sheet, or a body with holes.
    ///
    /// It is found by sums alone: the normals of what is closed, times areas, add up to 0, to rounding of the coordinates.
    pub fn enclosed_m3(&self) -> Option<f64> {
        // Any point of the mesh serves: what is closed has the same volume about all.
        let about = self.vertices_m[self.facets.first()?[0] as usize];
        let (sum_m2, size_m2) = self.vector_area_m2();
        if sum_m2.length() > CLOSED * size_m2 {
            return None;
        }
        let of_facet = |facet: Facet| (facet.corners_m[0] - about).dot(facet.cross_m2()) / 6.0;
        let parts_m3 = (0..self.facets.len()).map(|facet| of_facet(self.facet(facet)));
        let (volume_m3, size_m3) = parts_m3.fold((0.0, 0.0), |(sum, size), part| (sum + part, size + part.abs()));
        // Of a surface that goes back on itself, as sheets with two sides do, only rounding is left.
        Some(if volume_m3.abs() <= NO_VOLUME * size_m3 { 0.0 } else { volume_m3 })
    }

    /// The vertices that facets use, m, each once.
    pub fn used_vertices_m(&self) -> impl Iterator<Item = DVec3> {
        let mut used = vec![false; self.vertices_m.len()];
        self.facets.iter().flatten().for_each(|v| used[*v as usize] = true);
        self.vertices_m.iter().zip(used).filter(|(_, used)| *used).map(|(v, _)| *v)
    }

    /// Smallest and largest coordinates of the vertices that facets use, m; `None` without facets.
    pub fn bounds_m(&self) -> Option<(DVec3, DVec3)> {
        let mut vertices = self.used_vertices_m();
        let first = vertices.next()?;
        Some(vertices.fold((first, first), |(lo, hi), v| (lo.min(v), hi.max(v))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_triangle() {
        let facet = Facet { corners_m: [DVec3::ZERO, DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)] };
        assert_eq!(facet.area_m2(), 6.0);
        assert_eq!(facet.normal(), DVec3::Z);
        assert_eq!(facet.centroid_m(), DVec3::new(1.0, 4.0 / 3.0, 0.0));
        assert_eq!(facet.point_m(0.5, 0.25), DVec3::new(1.5, 1.0, 0.0));
        assert_eq!(facet.met_by(DVec3::new(9.0, 9.0, 6.0), DVec3::new(1.0, 0.0, -2.0)), 3.0);
    }

    #[test]
    fn a_body_that_is_turned_inside_out_has_a_negative_volume() {
        // A tetrahedron on three unit axes, far from the origin: volume 1/6.
        let far = DVec3::new(1e4, 2e4, -3e4);
        let vertices_m = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|v| v + far).to_vec();
        let facets = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mut mesh = Mesh { vertices_m, material: vec![MaterialId(0); 4], facets, ..Mesh::default() };
        assert!((mesh.enclosed_m3().unwrap() - 1.0 / 6.0).abs() < 1e-10);
        mesh.flip();
        assert!((mesh.enclosed_m3().unwrap() + 1.0 / 6.0).abs() < 1e-10);
        mesh.facets.pop();
        assert_eq!(mesh.enclosed_m3(), None);
    }

    #[test]
    fn facets_are_spread_over_the_mesh() {
        let mesh = Mesh { facets: vec![[0; 3]; 1000], ..Mesh::default() };
        assert!(mesh.spread(1000).eq(0..1000));
        let mut some: Vec<usize> = mesh.spread(100).collect();
        some.sort_unstable();
        assert_eq!(some.len(), 100);
        // The three-gap theorem: no gap above 1000 / F(11) = 1000 / 55 and its smaller kin.
        assert!(
            some[0] < 19 && some[99] > 980 && some.windows(2).all(|w| (3..19).contains(&(w[1] - w[0]))),
            "{some:?}"
        );
    }

    #[test]
    fn appending_keeps_faces_apart() {
        let quad = Mesh {
            vertices_m: vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y],
            facets: vec![[0, 1, 2], [0, 2, 3]],
            material: vec![MaterialId(0); 2],
            face_of_facet: vec![0, 0],
            uv: vec![],
        };
        let mut both = quad.clone();
        both.append(quad.clone());
        assert_eq!(both.face_of_facet, [0, 0, 1, 1]);
        assert_eq!(both.facets[3], [4, 6, 7]);
        let triangle =
            Mesh { facets: vec![[0, 1, 2]], material: vec![MaterialId(0)], face_of_facet: vec![], ..quad.clone() };
        let mut all = triangle.clone();
        all.append_all([triangle.clone(), quad.clone(), triangle, quad]);
        assert_eq!(all.face_of_facet, [0, 1, 2, 2, 3, 4, 4]);
        assert_eq!(all.facets[6], [16, 18, 19]);
    }
}
