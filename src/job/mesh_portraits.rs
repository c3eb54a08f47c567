//! A mesh's file, drawn.

use std::path::Path;

use crate::error::Result;
use crate::formats::{mesh_picture, registry};

/// Draws the mesh in a file from four sides, as PNG.
///
/// # Errors
/// Those of [`registry::mesh`] and of [`mesh_picture::write`].
pub fn draw_mesh(path: &Path, target: &Path, replace: bool) -> Result<()> {
    let file = registry::mesh(path, true)?;
    mesh_picture::write(&file.surface.mesh, target, replace, path)
}
