//! The detector's pixels over the cells of the drawing.
//!
//! Cells are where geometry is cut, pixels where sums go. Through a lens without distortion each pixel is one cell, a unit square. Through another one it is the
//! quadrilateral of its four corners in the plane of the ideal pinhole, over several cells: what is seen of it is what they show, clipped by its sides. Its areas are
//! shares of that quadrilateral, as those of a cell are of its square: areas in the plane, not solid angles. This file alone takes one for the other.

use glam::DVec3;

use crate::geometry::polygon::{Point, Rect, area};
use crate::geometry::{Drawn, FrameCamera, Mesh, whole_u32};
use crate::visibility::{Drawing, Grid, Topology, View};

/// The drawing of a mesh in a camera, and the camera's pixels in it; `bounds_m` are the mesh's.
pub(super) fn draw<'a>(
    mesh: &'a Mesh,
    topology: &'a Topology,
    bounds_m: Option<(DVec3, DVec3)>,
    camera: &'a FrameCamera,
) -> (Drawing<'a>, Detector<'a>) {
    let drawn = camera.drawn();
    let (view, grid) = View::of_frame(&drawn.pinhole, bounds_m);
    (Drawing::new(mesh, topology, view, grid), Detector { drawn, grid, size: [camera.samples, camera.lines] })
}

/// All pixels.
#[derive(Debug)]
pub(super) struct Detector<'a> {
    drawn: Drawn<'a>,
    grid: Grid,
    /// Pixels in a line, and lines.
    pub(super) size: [u32; 2],
}

/// Those of a line of the image.
#[derive(Debug)]
pub(super) struct PixelLine<'d> {
    detector: &'d Detector<'d>,
    line: u32,
    /// Corners of pixels, above and below; none where pixels are cells.
    corners: [Vec<Point>; 2],
    /// The first row of cells that it reaches into, and the one after the last.
    pub(super) rows: [u32; 2],
}

impl Detector<'_> {
    /// The pixels of a line.
    pub(super) fn line(&self, line: u32) -> PixelLine<'_> {
        let mut of = PixelLine { detector: self, line, corners: [vec![], vec![]], rows: [line, line + 1] };
        if self.drawn.is_distorted() {
            let corner = |sample: u32, line: u32| self.drawn.at([sample, line].map(f64::from));
            of.corners = [line, line + 1].map(|line| (0..=self.size[0]).map(|sample| corner(sample, line)).collect());
            of.rows = self.cells(&Rect::of(&of.corners.concat()))[1];
        }
        of
    }

    /// Columns and rows of the cells that a rectangle reaches into: the first, and the one after the last.
    fn cells(&self, rect: &Rect) -> [[u32; 2]; 2] {
        let most = [self.grid.columns, self.grid.rows];
        [0, 1].map(|k| [whole_u32(rect.min[k].floor()), whole_u32(rect.max[k].ceil()).min(most[k])])
    }
}

impl PixelLine<'_> {
    /// One of its pixels.
    #[inline]
    pub(super) fn site(&self, sample: u32) -> PixelSite {
        let [Some([a, b]), Some([d, c])] = self.corners.each_ref().map(|row| row.get(sample as usize..)?.first_chunk())
        else {
            let rect = self.detector.grid.cell(sample, self.line);
            return PixelSite::cell(sample, self.line, rect);
        };
        let outline = [*a, *b, *c, *d];
        let rect = Rect::of(&outline);
        let [columns, rows] = self.detector.cells(&rect);
        let centre = self.detector.drawn.at([sample, self.line].map(|i| f64::from(i) + 0.5));
        PixelSite { sample, columns, rows, rect, outline: Some(outline), per_cell: 1.0 / area(&outline), centre }
    }
}

/// A pixel of the image, and where it lies in the drawing.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSite {
    /// Its place in its line.
    pub(super) sample: u32,
    /// Columns and rows of the cells in which it lies: the first, and the one after the last.
    columns: [u32; 2],
    rows: [u32; 2],
    /// Its bounds.
    pub(super) rect: Rect,
    /// Its corners, counter-clockwise, if it is not all of its bounds.
    pub(super) outline: Option<[Point; 4]>,
    /// What share of it the area of a cell is.
    pub(super) per_cell: f64,
    /// Its centre.
    pub(super) centre: Point,
}

impl PixelSite {
    /// One that is a cell.
    #[inline]
    pub(super) fn cell(column: u32, row: u32, rect: Rect) -> Self {
        PixelSite {
            sample: column,
            columns: [column, column + 1],
            rows: [row, row + 1],
            rect,
            outline: None,
            per_cell: 1.0,
            centre: rect.centre(),
        }
    }

    /// The cells in which it lies.
    #[inline]
    pub(super) fn cells(self) -> impl Iterator<Item = [u32; 2]> {
        let columns = self.columns[0]..self.columns[1];
        (self.rows[0]..self.rows[1]).flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }

    /// Its corners, counter-clockwise.
    pub(super) fn corners(&self) -> [Point; 4] {
        self.outline.unwrap_or_else(|| self.rect.corners())
    }

    /// Its diagonal, in diagonals of a cell.
    pub(super) fn extent(&self) -> f64 {
        let Rect { min, max } = self.rect;
        (0.5 * ((max[0] - min[0]).powi(2) + (max[1] - min[1]).powi(2))).sqrt()
    }
}
