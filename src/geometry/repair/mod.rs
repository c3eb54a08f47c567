//! What can be mended in a mesh, each where it is asked for.

mod decimate;
mod outward;
mod t_junctions;
mod weld;

pub use decimate::{Decimated, decimate};
pub use outward::{Turned, outward};
pub use t_junctions::t_junctions;
pub use weld::{Welded, join_equal, weld};

use super::{Mesh, index_u32};

/// Takes out facets, and then vertices that no facet uses.
fn keep(mesh: &mut Mesh, is_kept: impl Fn(usize) -> bool) {
    let kept: Vec<u32> = (0..mesh.facets.len()).filter(|facet| is_kept(*facet)).map(index_u32).collect();
    *mesh = mesh.part(&kept);
}
