//! Meshes without names: triangles and nothing else, or nearly so.

pub(super) mod dsk;
mod ply_read;
pub(super) mod shape_text;
pub(super) mod stl;

pub(super) use ply_read::PLY;

use std::collections::HashMap;

use glam::DVec3;

use super::input::InputFile;
use super::mesh_file::{ColouredMesh, MeshFile, Up};
use super::mtl::ObjMaterial;
use crate::geometry::{MaterialId, Mesh, index_u32};
use crate::report::{Note, Report};

/// Longer files are refused, bytes.
const LIMIT: u64 = 8 << 30;
/// The unit of length of shape models of bodies, m.
const KM_M: f64 = 1000.0;

/// The file of a mesh of one material without a name; facets are its faces.
fn plain(vertices: Vec<DVec3>, facets: Vec<[u32; 3]>, unit_m: f64, input: InputFile, doubts: Vec<Note>) -> MeshFile {
    let material = vec![MaterialId(0); facets.len()];
    let mesh = Mesh { vertices_m: vertices, facets, material, ..Mesh::default() };
    let materials = vec![ObjMaterial { name: String::new(), kd: None }];
    MeshFile {
        surface: ColouredMesh { mesh, materials, origin_m: None, sun: None },
        up: Up::Z,
        unit_m,
        ignored: Default::default(),
        report: Report::default(),
        doubts,
        material_doubts: vec![],
        may_change: false,
        inputs: vec![input],
    }
}

/// Vertices that are told apart by their coordinates alone, in the order in which they come.
#[derive(Debug, Default)]
struct Welded {
    vertices: Vec<DVec3>,
    known: HashMap<[u64; 3], u32>,
}

impl Welded {
    /// The number of the vertex at a place.
    fn vertex(&mut self, p: DVec3) -> u32 {
        // Adding 0 makes -0 and 0 one number.
        let key = p.to_array().map(|x| (x + 0.0).to_bits());
        *self.known.entry(key).or_insert_with(|| {
            self.vertices.push(p);
            index_u32(self.vertices.len() - 1)
        })
    }
}
