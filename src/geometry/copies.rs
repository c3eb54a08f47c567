//! One mesh in many places: rocks.

use std::ops::Range;

use glam::DAffine3;

use super::Mesh;

/// Facets of a mesh that are copies of one model, a copy after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Copies {
    /// Which facets of the whole mesh they are.
    pub facets: Range<usize>,
    /// The model, m, in its own axes; its material ids are those of the whole mesh.
    pub model: Mesh,
    /// Where each copy stands: from the model's axes to those of the whole mesh.
    pub places: Vec<DAffine3>,
}

impl Mesh {
    /// All copies of it in one mesh, in the order of their places. Outer sides stay outside where a place mirrors.
    #[must_use]
    pub fn copied(&self, places: &[DAffine3]) -> Mesh {
        let copy = |place: &DAffine3| {
            let mut copy = self.clone();
            copy.vertices_m.iter_mut().for_each(|v| *v = place.transform_point3(*v));
            if place.matrix3.determinant() < 0.0 {
                copy.flip();
            }
            copy
        };
        let mut copies = places.iter().map(copy);
        let mut all = copies.next().unwrap_or_default();
        all.append_all(copies);
        all
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::super::MaterialId;
    use super::*;

    #[test]
    fn copies_stand_where_they_are_put() {
        // A tetrahedron on three unit axes, of volume 1/6.
        let model = Mesh {
            vertices_m: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            facets: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            material: vec![MaterialId(3); 4],
            ..Mesh::default()
        };
        let place = |scale: DVec3, translation: DVec3| DAffine3 { matrix3: DMat3::from_diagonal(scale), translation };
        let places = [place(DVec3::splat(2.0), DVec3::X), place(DVec3::new(1.0, -3.0, 1.0), DVec3::new(9.0, 0.0, 5.0))];
        let all = model.copied(&places);
        assert_eq!((all.vertices_m.len(), all.facets.len(), all.material.len()), (8, 8, 8));
        assert_eq!(all.vertices_m[1], DVec3::new(3.0, 0.0, 0.0));
        assert_eq!(all.vertices_m[6], DVec3::new(9.0, -3.0, 5.0));
        // 8/6 and 3/6, both with their outer sides outside.
        assert!((all.enclosed_m3().unwrap() - 11.0 / 6.0).abs() < 1e-14);
        assert_eq!(model.copied(&[]), Mesh::default());
    }
}
