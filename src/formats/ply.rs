//! PLY, the Stanford polygon format: meshes for other programs, binary, little-endian.

use std::io::{self, Write};

use crate::geometry::{MaterialId, Mesh};

/// Writes the facets of one material, in double precision.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut impl Write, mesh: &Mesh, material: MaterialId) -> io::Result<()> {
    let facets: Vec<&[u32; 3]> =
        mesh.facets.iter().zip(&mesh.material).filter(|(_, m)| **m == material).map(|(f, _)| f).collect();
    // Vertices that these facets use, in their order.
    let mut place = vec![u32::MAX; mesh.vertices_m.len()];
    facets.iter().copied().flatten().for_each(|v| place[*v as usize] = 0);
    let mut count = 0;
    for place in place.iter_mut().filter(|place| **place == 0) {
        *place = count;
        count += 1;
    }
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment m\nelement vertex {count}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        facets.len()
    )?;
    for (vertex, _) in mesh.vertices_m.iter().zip(&place).filter(|(_, place)| **place != u32::MAX) {
        vertex.to_array().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
    }
    for facet in facets {
        out.write_all(&[3])?;
        facet.iter().try_for_each(|v| out.write_all(&place[*v as usize].to_le_bytes()))?;
    }
    Ok(())
}
