//! The detector's pixels over the cells of the drawing.
//!
//! Cells are where geometry is cut, pixels where sums go. Through a lens without distortion each pixel is one cell, a unit square: this file
//! alone takes one for the other.

use glam::DVec3;

use crate::geometry::polygon::{Point, Rect};
use crate::geometry::{FrameCamera, Mesh};
use crate::visibility::{Drawing, Topology, View};

/// The drawing of a mesh in a camera; `bounds_m` are the mesh's.
pub(super) fn draw<'a>(
    mesh: &'a Mesh,
    topology: &'a Topology,
    bounds_m: Option<(DVec3, DVec3)>,
    camera: &FrameCamera,
) -> Drawing<'a> {
    let (view, grid) = View::of_frame(camera, bounds_m);
    Drawing::new(mesh, topology, view, grid)
}

/// Pixels in a line, and lines, of the image that is drawn.
pub(super) fn size(drawing: &Drawing) -> [u32; 2] {
    [drawing.grid.columns, drawing.grid.rows]
}

/// The row of cells in which a line of the image lies.
pub(super) fn row(line: u32) -> u32 {
    line
}

/// A pixel of the image, and where it lies in the drawing.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSite {
    /// Its place in its line.
    pub(super) sample: u32,
    /// The cell in which it lies: column and row.
    pub(super) cell: [u32; 2],
    /// Its outline; areas in it are shares of the pixel.
    pub(super) rect: Rect,
    /// Its centre.
    pub(super) centre: Point,
}

impl PixelSite {
    /// Of one pixel.
    #[inline]
    pub(super) fn of(drawing: &Drawing, sample: u32, line: u32) -> Self {
        let cell = [sample, row(line)];
        let rect = drawing.grid.cell(cell[0], cell[1]);
        PixelSite { sample, cell, rect, centre: rect.centre() }
    }
}
