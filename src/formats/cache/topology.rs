//! What follows from a mesh alone: how its facets hang together, and the tree by which rays meet them.

use crate::error::Result;
use crate::geometry::Mesh;
use crate::progress::Watch;
use crate::scene::Body;
use crate::visibility::{RayTree, Topology, TopologyParts, TreeOrder};

use super::entry::Packed;
use super::mesh::{facets, three_bytes, threes, vertex, vertices};
use super::{Cache, Kept, Key};

impl Kept for Topology {
    const KIND: &'static str = "topology";

    fn packed(&self) -> Option<Packed> {
        let TopologyParts { neighbour, part, closed, open_edges, flipped_facets, coincident_facets } = self.parts();
        let mut packed = Packed::new(&[open_edges, flipped_facets, coincident_facets])?;
        packed.put(neighbour.iter().map(|of| three_bytes(*of)));
        packed.put(part.iter().map(|part| part.to_le_bytes()));
        packed.put(closed.iter().map(|closed| [u8::from(closed.is_some())]));
        let corners = closed.iter().flat_map(|closed| closed.unwrap_or_default());
        packed.put(corners.flat_map(|corner| corner.to_array()).map(f64::to_le_bytes));
        Some(packed)
    }
}

fn topology(mut packed: Packed, mesh: &Mesh) -> Option<Topology> {
    let [open_edges, flipped_facets, coincident_facets] = packed.text()?;
    let neighbour = packed.take(|of: [u8; 12]| threes(of, u32::from_le_bytes))?;
    let part = packed.take(u32::from_le_bytes)?;
    let is_closed = packed.take(|[of]: [u8; 1]| of == 1)?;
    let corners = packed.take(vertex)?;
    let (corners, rest) = corners.as_chunks::<2>();
    if !rest.is_empty() || corners.len() != is_closed.len() {
        return None;
    }
    let closed = is_closed.into_iter().zip(corners).map(|(is, corners)| is.then_some(*corners)).collect();
    Topology::from_parts(
        TopologyParts { neighbour, part, closed, open_edges, flipped_facets, coincident_facets },
        mesh.facets.len(),
    )
}

/// A tree and the mesh that it is of.
struct Tree(RayTree);

impl Kept for Tree {
    const KIND: &'static str = "tree";

    fn packed(&self) -> Option<Packed> {
        let TreeOrder { nodes, facets } = self.0.order();
        let mut packed = Packed::new(&())?;
        packed.put(nodes.iter().map(|[at, count, axis]| three_bytes([*at, *count, *axis])));
        packed.put(facets.iter().map(|facet| facet.to_le_bytes()));
        Some(packed)
    }
}

fn tree(mut packed: Packed, mesh: &Mesh) -> Option<Tree> {
    let nodes = packed.take(|of: [u8; 12]| threes(of, u32::from_le_bytes))?;
    let facets = packed.take(u32::from_le_bytes)?;
    RayTree::from_order(mesh, TreeOrder { nodes, facets }).map(Tree)
}

/// The key of what follows from the places of a mesh's facets.
fn key<T: Kept>(mesh: &Mesh) -> Key {
    let mut key = Key::of::<T>().and(&(mesh.vertices_m.len() as u64).to_le_bytes());
    // Hashed by blocks, which is faster than a vertex at a time.
    let mut block = Vec::new();
    let mut add = |bytes: &[u8], hasher: &mut blake3::Hasher| {
        block.extend_from_slice(bytes);
        if block.len() >= 1 << 16 {
            hasher.update(&block);
            block.clear();
        }
    };
    vertices(mesh).for_each(|bytes| add(&bytes, &mut key.0));
    facets(mesh).for_each(|bytes| add(&bytes, &mut key.0));
    key.0.update(&block);
    key
}

impl Cache {
    /// Gives a body its topology.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub(in crate::formats) fn hang_together(&self, body: &Body, watch: Watch<'_>) -> Result<()> {
        let mesh = &body.mesh;
        let found =
            self.of(&key::<Topology>(mesh), |packed| topology(packed, mesh), || body.topology_watched(watch).cloned())?;
        body.take_topology(found);
        Ok(())
    }

    /// Gives a body its tree of rays.
    pub(crate) fn plant(&self, body: &Body) {
        let mesh = &body.mesh;
        let made: Result<Tree> =
            self.of(&key::<Tree>(mesh), |packed| tree(packed, mesh), || Ok(Tree(RayTree::new(mesh))));
        if let Ok(Tree(tree)) = made {
            body.take_ray_tree(tree);
        }
    }
}
