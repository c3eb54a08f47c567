//! Facets in blocks that lie close together: what a block cannot do, none of its facets can.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Facet, Mesh, index_u32, whole};

/// Facets in a block.
const SIZE: usize = 32;
/// What rounding may take from a block's bounds.
const ROUNDING: f64 = 1e-9;

/// A few facets, and where they face.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// All normals are within an angle of this direction; its sine, above 1 where that is not a bound.
    axis: DVec3,
    sin_spread: f64,
    /// Where its facets are among those of all blocks.
    pub(super) facets: Range<usize>,
}

impl Block {
    /// Whether one of its facets may face away from a direction.
    pub(super) fn may_face_away(&self, towards: DVec3) -> bool {
        self.axis.dot(towards) < self.sin_spread
    }

    /// Whether one of its facets may face a direction.
    pub(super) fn may_face(&self, towards: DVec3) -> bool {
        -self.axis.dot(towards) < self.sin_spread
    }
}

/// All facets with an area, block by block.
#[derive(Debug)]
pub(super) struct Blocks {
    /// Each with its corners among the vertices.
    pub(super) facets: Vec<(u32, [u32; 3])>,
    /// Those of the mesh that facets have, in another order.
    pub(super) vertices_m: Vec<DVec3>,
    pub(super) blocks: Vec<Block>,
}

impl Blocks {
    /// Sorts the facets of a mesh along Morton's curve, and cuts the curve into blocks.
    pub(super) fn new(mesh: &Mesh, low_m: DVec3, high_m: DVec3) -> Self {
        // A cube, so that blocks are as wide as they are high.
        let scale = f64::from(1 << 21) / (high_m - low_m).max_element().max(f64::MIN_POSITIVE);
        let mut places: Vec<(u64, u32)> = (0..mesh.facets.len())
            .into_par_iter()
            .filter(|f| mesh.facet(*f).cross_m2() != DVec3::ZERO)
            .map(|f| {
                let at = ((mesh.facet(f).centroid_m() - low_m) * scale).to_array().map(|x| spread(whole(x)));
                (at[0] | at[1] << 1 | at[2] << 2, index_u32(f))
            })
            .collect();
        places.par_sort_unstable();
        let facets: Vec<u32> = places.into_iter().map(|(_, facet)| facet).collect();
        let blocks = facets.par_chunks(SIZE).enumerate().map(|(b, facets)| block(mesh, facets, b * SIZE)).collect();
        // What is read together is side by side: vertices in the order in which facets come to them.
        let mut place = vec![None; mesh.vertices_m.len()];
        let mut vertices_m = Vec::with_capacity(mesh.vertices_m.len());
        let mut placed = |v: u32| {
            *place[v as usize].get_or_insert_with(|| {
                vertices_m.push(mesh.vertices_m[v as usize]);
                index_u32(vertices_m.len() - 1)
            })
        };
        let facets = facets.into_iter().map(|f| (f, mesh.facets[f as usize].map(&mut placed))).collect();
        Blocks { facets, vertices_m, blocks }
    }
}

/// The lowest 21 bits of a number, two places between them.
fn spread(x: usize) -> u64 {
    let mut x = (x as u64).min((1 << 21) - 1);
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// A block of facets, of which the first has this place.
fn block(mesh: &Mesh, facets: &[u32], first: usize) -> Block {
    let end = first + facets.len();
    let facets: Vec<Facet> = facets.iter().map(|f| mesh.facet(*f as usize)).collect();
    let axis = facets.iter().map(|facet| facet.normal()).sum::<DVec3>().normalize_or_zero();
    let cos = facets.iter().map(|facet| facet.normal().dot(axis)).fold(1.0, f64::min);
    let sin_spread = if cos > 0.0 { (1.0 - cos * cos).max(0.0).sqrt() + ROUNDING } else { 2.0 };
    Block { axis, sin_spread, facets: first..end }
}
