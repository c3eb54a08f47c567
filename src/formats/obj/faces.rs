//! Faces as they come, and the facets they become.

use std::collections::HashMap;

use glam::DVec3;

use super::triangulate::triangulate;
use crate::geometry::index_u32;

/// Faces so far, in the order of the file.
#[derive(Default)]
pub(super) struct Faces {
    /// Facets. Those of polygons hold their place, and are cut when all vertices are known.
    pub(super) facets: Vec<[u32; 3]>,
    /// The material of each facet.
    pub(super) facet_material: Vec<u16>,
    /// The texture coordinates (`vt`, from 0) of each facet's corners, or [`NO_TEXTURE`]; empty as long as no face has any.
    pub(super) facet_texture: Vec<[u32; 3]>,
    /// The face of each facet; empty as long as all faces are triangles.
    pub(super) face_of_facet: Vec<u32>,
    /// The group of each facet; empty as long as there is none.
    pub(super) facet_group: Vec<u16>,
    /// Names of groups, in the order of their first face.
    pub(super) groups: Vec<String>,
    /// The group of the faces that come.
    group: Option<u16>,
    index_of_group: HashMap<String, u16>,
    count: u32,
    has_texture: bool,
    polygons: Vec<Polygon>,
    polygon_corners: Vec<u32>,
    /// Texture coordinates of these corners; empty as long as no face has any.
    polygon_texture: Vec<u32>,
}

/// Of a corner without texture coordinates.
pub(super) const NO_TEXTURE: u32 = u32::MAX;

/// A face of more than three corners.
struct Polygon {
    first_facet: usize,
    first_corner: usize,
    corners: usize,
}

impl Faces {
    #[inline]
    pub(super) fn push_triangle(&mut self, corners: [u32; 3], material: u16) {
        self.push_facet(corners, [NO_TEXTURE; 3], material);
        self.count += 1;
    }

    /// Takes a face of three or more corners, each with its texture coordinates.
    pub(super) fn push(&mut self, corners: &[u32], texture: &[u32], material: u16) {
        if self.facet_texture.is_empty() && texture.iter().any(|t| *t != NO_TEXTURE) {
            self.facet_texture.resize(self.facets.len(), [NO_TEXTURE; 3]);
            self.polygon_texture.resize(self.polygon_corners.len(), NO_TEXTURE);
            self.has_texture = true;
        }
        if corners.len() > 3 {
            let first_facet = self.facets.len();
            if self.face_of_facet.is_empty() {
                self.face_of_facet.extend(0..index_u32(first_facet));
            }
            let first_corner = self.polygon_corners.len();
            self.polygons.push(Polygon { first_facet, first_corner, corners: corners.len() });
            self.polygon_corners.extend_from_slice(corners);
            if self.has_texture {
                self.polygon_texture.extend_from_slice(texture);
            }
        }
        for k in 2..corners.len() {
            let of = |list: &[u32]| [list[0], list[k - 1], list[k]];
            self.push_facet(of(corners), of(texture), material);
        }
        self.count += 1;
    }

    #[inline]
    fn push_facet(&mut self, corners: [u32; 3], texture: [u32; 3], material: u16) {
        self.facets.push(corners);
        if self.has_texture {
            self.facet_texture.push(texture);
        }
        self.facet_material.push(material);
        if !self.polygons.is_empty() {
            self.face_of_facet.push(self.count);
        }
        if let Some(group) = self.group {
            self.facet_group.push(group);
        }
    }

    /// Makes this the group of the faces that come; `false` for a new one beyond the 65536 that can be told apart.
    pub(super) fn use_group(&mut self, name: &str) -> bool {
        let earlier = self.facets.len();
        if self.groups.is_empty() && earlier > 0 {
            self.groups.push(String::new());
            self.facet_group.resize(earlier, 0);
            self.index_of_group.insert(String::new(), 0);
        }
        let known = self.index_of_group.get(name).copied();
        let Some(index) = known.or_else(|| u16::try_from(self.groups.len()).ok()) else { return false };
        if known.is_none() {
            self.groups.push(name.to_owned());
            self.index_of_group.insert(name.to_owned(), index);
        }
        self.group = Some(index);
        true
    }

    /// Cuts the polygons, of which all corners must be vertices.
    pub(super) fn cut(&mut self, vertices: &[DVec3]) {
        let mut cut = Vec::new();
        for polygon in &self.polygons {
            cut.clear();
            let corners = &self.polygon_corners[polygon.first_corner..][..polygon.corners];
            triangulate(corners, vertices, &mut cut);
            self.facets[polygon.first_facet..][..cut.len()].copy_from_slice(&cut);
            if self.has_texture {
                let texture = &self.polygon_texture[polygon.first_corner..][..polygon.corners];
                let of = |v: u32| corners.iter().position(|c| *c == v).map_or(NO_TEXTURE, |i| texture[i]);
                for (i, facet) in cut.iter().enumerate() {
                    self.facet_texture[polygon.first_facet + i] = facet.map(of);
                }
            }
        }
    }
}
