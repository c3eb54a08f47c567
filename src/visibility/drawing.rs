//! A mesh drawn in the plane of a view: each vertex projected once, each facet's side decided once.
//!
//! The rounded drawing is the exact input of everything that follows: neighbours share vertices, so they fit to the last bit.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::coincident::{Rank, SAME_PLANE, rank};
use super::topology::{NONE, Topology};
use crate::geometry::polygon::{Point, Rect, area};
use crate::geometry::{Camera, Direction, Facet, FrameCamera, Mesh, ParallelCamera, index_u32, whole_u32};

/// How points of space become points of the drawing. The drawing's unit is a cell; h points right, v down, u away from the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// All rays parallel.
    Parallel {
        /// Right, unit vector.
        h: DVec3,
        /// Down, unit vector.
        v: DVec3,
        /// Away from the viewer, unit vector.
        u: DVec3,
        /// Cells per metre along h and v.
        scale: [f64; 2],
        /// Drawing coordinates of the origin.
        offset: [f64; 2],
    },
    /// All rays through one point. See [`View::pinhole`].
    Pinhole {
        /// Projection centre, m.
        centre_m: DVec3,
        /// What vertices are measured from, m: the centre itself, or from afar a point in the middle of the mesh.
        from_m: DVec3,
        /// Depth of that point, m; 0 for the centre.
        depth_m: f64,
        /// Right, across the ray to that point.
        h: DVec3,
        /// Down, across the ray to that point.
        v: DVec3,
        /// Boresight, unit vector.
        u: DVec3,
        /// Cells per unit of tangent along h and v.
        scale: [f64; 2],
        /// Drawing coordinates of that point; of the boresight, if it is the centre.
        offset: [f64; 2],
    },
}

/// From this many times the mesh's size on, vertices are measured from the middle of the mesh.
const AFAR: f64 = 16.0;

impl View {
    /// A camera's view of what lies within bounds, m, in which cells are its pixels; lines are counted from the last one if the third is
    /// true: seen from its eye, the image is a mirror image.
    ///
    /// `None` if its image has no directions.
    pub fn of_camera(camera: &Camera, bounds_m: Option<(DVec3, DVec3)>) -> Option<(Self, Grid, bool)> {
        let [columns, rows] = camera.size();
        let grid = Grid { columns, rows };
        match camera {
            Camera::Frame(camera) => {
                let (view, grid) = View::of_frame(camera, bounds_m);
                Some((view, grid, false))
            }
            Camera::Parallel(camera) => {
                let ParallelCamera { towards, sample_per_m, line_per_m, origin_m, origin_px, .. } = *camera;
                let along = |axis: DVec3| Direction::new(axis).map(|d| (d.vec(), axis.length()));
                let ((h, columns), (v, rows), u) = (along(sample_per_m)?, along(line_per_m)?, -towards.vec());
                let row = origin_px[1] - line_per_m.dot(origin_m);
                // Lines of a mirror image are counted from the last one: seen from its eye, what is right and down must be so.
                let is_mirrored = h.cross(v).dot(u) < 0.0;
                let (v, row) = if is_mirrored { (-v, f64::from(grid.rows) - row) } else { (v, row) };
                let offset = [origin_px[0] - sample_per_m.dot(origin_m), row];
                Some((View::Parallel { h, v, u, scale: [columns, rows], offset }, grid, is_mirrored))
            }
        }
    }

    /// A frame camera's view of what lies within bounds, m, and its pixels as cells.
    pub fn of_frame(camera: &FrameCamera, bounds_m: Option<(DVec3, DVec3)>) -> (Self, Grid) {
        let axes = camera.world_from_sensor.rotation;
        let axes = [axes.x_axis, axes.y_axis, axes.z_axis];
        let scale = camera.pitch.map(|pitch| 1.0 / pitch);
        let view = View::pinhole(bounds_m, camera.centre_m(), axes, scale, camera.boresight_px);
        (view, Grid { columns: camera.samples, rows: camera.lines })
    }

    /// A central view of what lies within bounds, m: projection centre, m, unit vectors right, down and along the boresight, cells per unit of tangent
    /// along the first two, and the drawing coordinates of the boresight.
    ///
    /// From afar the distance costs no digits: vertices are measured from a point in its middle, with axes sheared so that its ray
    /// is drawn as a point. With tangents t of that ray, x / z = t + (dx - t dz) / (z0 + dz).
    pub fn pinhole(
        bounds_m: Option<(DVec3, DVec3)>,
        centre_m: DVec3,
        [h, v, u]: [DVec3; 3],
        scale: [f64; 2],
        offset: [f64; 2],
    ) -> Self {
        let near = View::Pinhole { centre_m, from_m: centre_m, depth_m: 0.0, h, v, u, scale, offset };
        let Some((low, high)) = bounds_m else { return near };
        let from_m = 0.5 * (low + high);
        let depth_m = dot_difference(from_m, centre_m, u);
        let is_afar = depth_m > AFAR * (high - low).length() && depth_m.is_finite();
        if !is_afar {
            return near;
        }
        let [right, down] = [h, v].map(|axis| dot_difference(from_m, centre_m, axis) / depth_m);
        View::Pinhole {
            centre_m,
            from_m,
            depth_m,
            h: h - right * u,
            v: v - down * u,
            u,
            scale,
            offset: [offset[0] + right * scale[0], offset[1] + down * scale[1]],
        }
    }
}

impl View {
    /// Rays of a central view: those through (x, y) and (x0, y0) differ by `right` (x - x0) + `down` (y - y0).
    /// Gives right, down, and the ray through (x0, y0), 1 along the boresight; and (x0, y0). None if rays are parallel.
    pub fn rays(&self) -> Option<([DVec3; 3], [f64; 2])> {
        let View::Pinhole { depth_m, h, v, u, scale, offset, .. } = *self else { return None };
        if depth_m == 0.0 {
            return Some(([h / scale[0], v / scale[1], u], offset));
        }
        // Axes before they were sheared, and the tangents that they were sheared by.
        let (right, down) = (-h.dot(u), -v.dot(u));
        let (h, v) = (h + right * u, v + down * u);
        Some(([h / scale[0], v / scale[1], u + right * h + down * v], offset))
    }
}

/// (a - b) . axis, to the last digits even where its parts cancel: Ogita, Rump & Oishi (2005), SIAM J. Sci. Comput. 26, 1955.
fn dot_difference(a: DVec3, b: DVec3, axis: DVec3) -> f64 {
    let (mut sum, mut rest) = (0.0, 0.0);
    for k in 0..3 {
        for (x, sign) in [(a[k], 1.0), (b[k], -1.0)] {
            let product = sign * x * axis[k];
            let error = (sign * x).mul_add(axis[k], -product);
            let next = sum + product;
            let part = next - sum;
            rest += (sum - (next - part)) + (product - part) + error;
            sum = next;
        }
    }
    sum + rest
}

/// The cells of a drawing: unit squares from (0, 0) to (columns, rows).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// Cells in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
}

impl Grid {
    /// The square of a cell.
    pub fn cell(&self, column: u32, row: u32) -> Rect {
        let (x, y) = (f64::from(column), f64::from(row));
        Rect { min: [x, y], max: [x + 1.0, y + 1.0] }
    }

    /// All cells together.
    pub fn bounds(&self) -> Rect {
        Rect { min: [0.0; 2], max: [f64::from(self.columns), f64::from(self.rows)] }
    }
}

/// Which side of a facet the viewer sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The outer one.
    Front,
    /// The inner one: it blocks, but neither receives nor emits.
    Back,
    /// Neither: seen edge-on.
    Edge,
}

const DRAWN: u8 = 1;
const FRONT: u8 = 2;
const BACK: u8 = 4;
const OPEN: [u8; 3] = [8, 16, 32];
/// The facet was cut at the image's side planes: its pieces are drawn in its place.
const CUT: u8 = 64;
/// The triangle is narrower than [`NARROW`], or was not looked at.
const MAYBE_EDGE_ON: u8 = 128;

/// A triangle cut from a facet that crosses the camera plane or reaches far beyond the image.
#[derive(Debug, Clone, Copy)]
struct Extra {
    facet: u32,
    vertices: [u32; 3],
}

/// A mesh, drawn. Triangles are the facets, by their index, then the pieces of those that had to be cut.
#[derive(Debug)]
pub struct Drawing<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    /// The only facets that are drawn, ascending; `None`: all.
    listed: Option<&'a [u32]>,
    /// The view.
    pub view: View,
    /// The cells.
    pub grid: Grid,
    /// x, y in cells; nearness: height towards the viewer, m (parallel) or 1 / depth, 1/m, less a constant (pinhole). Affine over a facet.
    points: Vec<[f64; 3]>,
    extra: Vec<Extra>,
    flags: Vec<u8>,
    /// Largest magnitude of x, y and of nearness among what is drawn.
    magnitude: [f64; 2],
}

/// How far what is drawn reaches.
#[derive(Debug, Clone, Copy, Default)]
struct Extent {
    /// Largest magnitude of nearness.
    near: f64,
    /// Largest distance from the view's offset along x or y, cells.
    across: f64,
}

impl Extent {
    #[inline]
    fn take(&mut self, corners: &[[f64; 3]; 3], bounds: &Rect, offset: [f64; 2]) {
        self.near = corners.iter().fold(self.near, |near, p| near.max(p[2].abs()));
        self.across =
            (0..2).fold(self.across, |across, k| across.max(offset[k] - bounds.min[k]).max(bounds.max[k] - offset[k]));
    }

    fn and(self, other: Extent) -> Extent {
        Extent { near: self.near.max(other.near), across: self.across.max(other.across) }
    }
}

/// Facets are cut at the image's side planes once a corner lies this many image sizes beside the image, or behind the camera.
const CUT_BEYOND: f64 = 4.0;
/// ... and these planes lie this many image sizes beside the image, so that no cut edge comes near a pixel.
const CUT_AT: f64 = 1.0;

/// Triangles narrower than this, cells, may be drawn no wider than their corners are rounded: it depends on where they are.
const NARROW: f64 = 1e-3;

/// Corners lie in a facet's plane within this, times the magnitude of coordinates: their rounding.
const PLANE_ROUNDING: f64 = 4.0 * f64::EPSILON;

impl<'a> Drawing<'a> {
    /// Draws a mesh for light from a direction, with cells fitted to what is there.
    ///
    /// The axes follow the mesh's own extent as seen from there, so that under grazing light cells are as flat as facets are.
    pub fn from_afar(mesh: &'a Mesh, topology: &'a Topology, towards: Direction, cells: f64) -> Self {
        let axes = long_and_short(mesh, mesh.facets.len(), |place| place, towards);
        let (view, grid) = fitted(mesh.used_vertices_m(), axes, towards, cells);
        Self::new(mesh, topology, view, grid)
    }

    /// The same of some facets, ascending, and no others.
    pub fn of_facets_from_afar(
        mesh: &'a Mesh,
        topology: &'a Topology,
        towards: Direction,
        cells: f64,
        facets: &'a [u32],
    ) -> Self {
        let axes = long_and_short(mesh, facets.len(), |place| facets[place] as usize, towards);
        let vertices_m = facets.iter().flat_map(|facet| mesh.facet(*facet as usize).corners_m);
        let (view, grid) = fitted(vertices_m, axes, towards, cells);
        Self::of_facets(mesh, topology, view, grid, facets)
    }

    /// Draws a mesh in a view.
    pub fn new(mesh: &'a Mesh, topology: &'a Topology, view: View, grid: Grid) -> Self {
        let points = mesh.vertices_m.par_iter().with_min_len(4096).map(|p| project(&view, *p)).collect();
        Self::of_points(mesh, topology, view, grid, points, None)
    }

    /// Draws some facets of a mesh, ascending, and no others: those that the cells may show, or that may hide these. No vertex of
    /// another facet is looked at.
    pub fn of_facets(mesh: &'a Mesh, topology: &'a Topology, view: View, grid: Grid, facets: &'a [u32]) -> Self {
        // Zeroed memory that is never touched costs nothing.
        let mut points = vec![[0.0; 3]; mesh.vertices_m.len()];
        for vertex in facets.iter().flat_map(|facet| mesh.facets[*facet as usize]) {
            points[vertex as usize] = project(&view, mesh.vertices_m[vertex as usize]);
        }
        Self::of_points(mesh, topology, view, grid, points, Some(facets))
    }

    fn of_points(
        mesh: &'a Mesh,
        topology: &'a Topology,
        view: View,
        grid: Grid,
        points: Vec<[f64; 3]>,
        listed: Option<&'a [u32]>,
    ) -> Self {
        let mut drawing =
            Drawing { mesh, topology, listed, view, grid, points, extra: vec![], flags: vec![], magnitude: [0.0; 2] };
        let hides_inner = match view {
            // The Sun is outside of everything.
            View::Parallel { .. } => Cow::Borrowed(&topology.closed[..]),
            View::Pinhole { centre_m, .. } => topology.hides_inner_sides(mesh, centre_m),
        };
        let mut extent = drawing.decide_sides(&hides_inner);
        drawing.cut_far_facets(&hides_inner);
        drawing.mark_open_edges();
        let offset = drawing.offset();
        for piece in &drawing.extra {
            let corners = piece.vertices.map(|v| drawing.points[v as usize]);
            extent.take(&corners, &Rect::of(&corners.map(|p| [p[0], p[1]])), offset);
        }
        drawing.measure(extent);
        drawing
    }

    /// Drawing coordinates of the view's origin, or of its boresight.
    fn offset(&self) -> [f64; 2] {
        match self.view {
            View::Pinhole { offset, .. } | View::Parallel { offset, .. } => offset,
        }
    }

    /// Number of triangles: facets, then pieces of facets.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.flags.len()
    }

    /// Number of triangles that may be in a cell.
    pub(super) fn listed(&self) -> usize {
        self.listed.map_or(self.mesh.facets.len(), <[u32]>::len) + self.extra.len()
    }

    /// The triangle at a place among them: facets, then pieces of facets, ascending.
    #[inline]
    pub(super) fn listed_at(&self, place: usize) -> u32 {
        match self.listed {
            None => index_u32(place),
            Some(facets) => match facets.get(place) {
                Some(facet) => *facet,
                None => index_u32(self.mesh.facets.len() + place - facets.len()),
            },
        }
    }

    /// The mesh that is drawn.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The triangles that are drawn in a facet's place: itself, or its pieces if it had to be cut.
    pub fn triangles(&self, facet: u32) -> std::ops::Range<u32> {
        if !self.is_cut(facet) {
            return facet..facet + 1;
        }
        let facets = index_u32(self.mesh.facets.len());
        // Pieces were made facet by facet.
        let first = index_u32(self.extra.partition_point(|e| e.facet < facet));
        let count = index_u32(self.extra[first as usize..].partition_point(|e| e.facet == facet));
        facets + first..facets + first + count
    }

    /// The facet of a triangle.
    #[inline]
    pub fn facet(&self, triangle: u32) -> u32 {
        let facets = index_u32(self.mesh.facets.len());
        if triangle < facets { triangle } else { self.extra[(triangle - facets) as usize].facet }
    }

    #[inline]
    fn vertices(&self, triangle: u32) -> [u32; 3] {
        let facets = &self.mesh.facets;
        if (triangle as usize) < facets.len() {
            facets[triangle as usize]
        } else {
            self.extra[triangle as usize - facets.len()].vertices
        }
    }

    /// Corners of a triangle: x, y in cells, nearness.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [[f64; 3]; 3] {
        self.vertices(triangle).map(|v| self.points[v as usize])
    }

    /// Corners of a triangle in the plane, counter-clockwise (x right, y up).
    #[inline]
    pub fn outline(&self, triangle: u32) -> [Point; 3] {
        let [a, b, c] = self.corners(triangle).map(|p| [p[0], p[1]]);
        if self.flags[triangle as usize] & BACK != 0 { [a, b, c] } else { [a, c, b] }
    }

    /// Whether a triangle is drawn at all.
    #[inline]
    pub(super) fn is_drawn(&self, triangle: u32) -> bool {
        self.flags[triangle as usize] & DRAWN != 0
    }

    /// The sides of a triangle's outline (bit k: the side that starts at its corner k) that may have something else beyond
    /// them than a facet that continues this one.
    #[inline]
    pub(super) fn open_sides(&self, triangle: u32) -> u8 {
        let flags = self.flags[triangle as usize];
        let open = |k: usize| u8::from(flags & OPEN[k] != 0);
        // The outline of a front side runs a, c, b: its sides are c-a, b-c, a-b.
        let order = if flags & BACK != 0 { [0, 1, 2] } else { [2, 1, 0] };
        open(order[0]) | open(order[1]) << 1 | open(order[2]) << 2
    }

    /// The facets beyond the edges of a triangle that cannot overlap it, being its continuation in the drawing.
    pub(super) fn continuations(&self, triangle: u32) -> [u32; 3] {
        let facet = self.facet(triangle);
        if self.flags[triangle as usize] & CUT != 0 || triangle as usize >= self.mesh.facets.len() {
            return [NONE; 3];
        }
        let mut next = self.topology.neighbour[facet as usize];
        for (k, n) in next.iter_mut().enumerate() {
            if self.flags[triangle as usize] & OPEN[k] != 0 {
                *n = NONE;
            }
        }
        next
    }

    /// Which side of a facet, or of another triangle, the viewer sees.
    pub fn side(&self, facet: u32) -> Side {
        match self.flags[facet as usize] & (FRONT | BACK) {
            FRONT => Side::Front,
            BACK => Side::Back,
            _ => Side::Edge,
        }
    }

    /// Whether a facet had to be cut because it crosses the camera plane or reaches far beyond the image.
    pub fn is_cut(&self, facet: u32) -> bool {
        self.flags[facet as usize] & CUT != 0
    }

    /// Whether a triangle is drawn no wider than its corners are rounded: it may as well be seen edge-on.
    #[inline]
    pub fn is_edge_on(&self, triangle: u32) -> bool {
        // Few are narrow enough to be looked at closer: coordinates lie within some thousands of cells.
        self.flags[triangle as usize] & MAYBE_EDGE_ON != 0 && {
            let outline = self.outline(triangle);
            area(&outline) <= self.rounding(triangle) * around(&outline)
        }
    }

    /// Bound of the error of the corners of a triangle, cells.
    fn rounding(&self, triangle: u32) -> f64 {
        let points = &self.mesh.vertices_m;
        let reach = |v: u32| points.get(v as usize).map_or(0.0, |p| p.abs().element_sum());
        let reach_m = self.vertices(triangle).map(reach).into_iter().fold(0.0, f64::max);
        let (far, offset) = match &self.view {
            View::Parallel { scale, offset, .. } => (reach_m * scale[0].max(scale[1]), offset),
            View::Pinhole { from_m, depth_m, scale, offset, .. } => {
                // Nearness is 1 / depth; from afar, minus the inverse depth of the point in the middle of the mesh.
                let amid = if *depth_m > 0.0 { 1.0 / depth_m } else { 0.0 };
                let near = self.corners(triangle).iter().fold(0.0, |n: f64, p| n.max(p[2] + amid));
                ((reach_m + from_m.abs().element_sum()) * near * scale[0].max(scale[1]), offset)
            }
        };
        4.0 * f64::EPSILON * (far + offset[0].abs().max(offset[1].abs()))
    }

    /// Largest magnitude of drawing coordinates, and of nearness.
    pub(super) fn magnitude(&self) -> [f64; 2] {
        self.magnitude
    }

    /// Whether a facet hides another that is close to it wherever they overlap, as they lie in space: the same from everywhere, so
    /// that what the camera sees is what the Sun lights.
    ///
    /// If they lie in one plane, to [`SAME_PLANE`], the outer side goes before the inner one, then material and sorted corners decide;
    /// else, if all of one lies on one side of the other's plane, that does. `None`: they cross, and depth decides.
    pub(super) fn is_before(&self, facet: u32, other: u32) -> Option<bool> {
        let (one, two) = (self.mesh.facet(facet as usize), self.mesh.facet(other as usize));
        let in_plane = |a, b| matches!(lies(a, b, SAME_PLANE), Lies::Within);
        if in_plane(&one, &two) && in_plane(&two, &one) {
            return Some(self.goes_before(facet, other));
        }
        let faces_away = |facet: u32| self.side(facet) == Side::Back;
        match lies(&one, &two, PLANE_ROUNDING) {
            Lies::Above => return Some(!faces_away(other)),
            Lies::Below => return Some(faces_away(other)),
            Lies::Within | Lies::Across => {}
        }
        match lies(&two, &one, PLANE_ROUNDING) {
            Lies::Above => Some(faces_away(facet)),
            Lies::Below => Some(!faces_away(facet)),
            Lies::Within | Lies::Across => None,
        }
    }

    /// Whether a facet wins a tie against another.
    pub(super) fn goes_before(&self, facet: u32, other: u32) -> bool {
        self.rank(facet) < self.rank(other)
    }

    /// What decides ties: an outer side before an inner one, then [`rank`].
    pub(super) fn rank(&self, facet: u32) -> (bool, Rank) {
        (self.side(facet) != Side::Front, rank(self.mesh, facet))
    }

    /// `hides_inner`: of each facet, whether its inner side cannot be seen from here. Gives how far the drawing reaches.
    fn decide_sides(&mut self, hides_inner: &[bool]) -> Extent {
        let image = self.grid.bounds();
        let reach = [0, 1].map(|k| CUT_BEYOND * image.max[k]);
        // From afar everything is in front of the camera.
        let (pinhole, afar) = match self.view {
            View::Pinhole { depth_m, .. } => (true, depth_m > 0.0),
            View::Parallel { .. } => (false, true),
        };
        let offset = self.offset();
        let points = &self.points;
        let of_facet = |i: usize, facet: &[u32; 3], extent: &mut Extent| {
            let corners = facet.map(|v| points[v as usize]);
            let outline = corners.map(|p| [p[0], p[1]]);
            let bounds = Rect::of(&outline);
            if pinhole {
                let in_front = |p: &[f64; 3]| afar || p[2] > 0.0;
                let far = |p: &[f64; 3]| {
                    !(in_front(p) && (0..2).all(|k| -reach[k] <= p[k] && p[k] <= image.max[k] + reach[k]))
                };
                // Beside the image, in front of the camera, there is nothing to cut.
                let is_beside = || {
                    let has_place = |p: &[f64; 3]| in_front(p) && p.iter().all(|x| x.is_finite());
                    corners.iter().all(has_place) && !bounds.overlaps(&image)
                };
                if corners.iter().any(far) && !is_beside() {
                    return CUT | MAYBE_EDGE_ON;
                }
            }
            let [a, b, c] = outline;
            let turn = turn(a, b, c);
            // h right, v down, u forward is right-handed: an outer side seen from in front turns negative.
            let side = if turn < 0.0 {
                FRONT
            } else if turn > 0.0 {
                BACK
            } else {
                return MAYBE_EDGE_ON;
            };
            let width_and_height = bounds.max[0] - bounds.min[0] + (bounds.max[1] - bounds.min[1]);
            let narrow = if turn.abs() <= 2.0 * NARROW * width_and_height { MAYBE_EDGE_ON } else { 0 };
            let hidden = side == BACK && hides_inner[i];
            if hidden || !bounds.overlaps(&image) {
                return side | narrow;
            }
            extent.take(&corners, &bounds, offset);
            side | narrow | DRAWN
        };
        let mut flags = vec![0; self.mesh.facets.len()];
        if let Some(facets) = self.listed {
            let mut extent = Extent::default();
            for facet in facets.iter().map(|facet| *facet as usize) {
                flags[facet] = of_facet(facet, &self.mesh.facets[facet], &mut extent);
            }
            self.flags = flags;
            return extent;
        }
        let chunk = 4096;
        let extent = (flags.par_chunks_mut(chunk).zip(self.mesh.facets.par_chunks(chunk)).enumerate())
            .map(|(c, (flags, facets))| {
                let mut extent = Extent::default();
                for (k, (flag, facet)) in flags.iter_mut().zip(facets).enumerate() {
                    *flag = of_facet(c * chunk + k, facet, &mut extent);
                }
                extent
            })
            .reduce(Extent::default, Extent::and);
        self.flags = flags;
        extent
    }

    /// Cuts facets that cross the camera plane or reach far beyond the image, in homogeneous coordinates, at planes beside the image.
    fn cut_far_facets(&mut self, hides_inner: &[bool]) {
        let View::Pinhole { centre_m, from_m, depth_m, h, v, u, scale, offset } = self.view else { return };
        let image = self.grid.bounds();
        // Planes through the projection centre: w = n . (p - from) + constant >= 0 inside.
        let mut planes = Vec::new();
        for (axis, side) in [(0, h), (1, v)] {
            let margin = CUT_AT * image.max[axis];
            let low = (-margin - offset[axis]) / scale[axis];
            let high = (image.max[axis] + margin - offset[axis]) / scale[axis];
            planes.push((side - low * u, -low * depth_m));
            planes.push((high * u - side, high * depth_m));
        }
        let mut places: std::collections::HashMap<(u32, u32, usize), u32> = Default::default();
        for place in 0..self.listed.map_or(self.mesh.facets.len(), <[u32]>::len) {
            let facet = self.listed_at(place);
            if self.flags[facet as usize] & CUT == 0 {
                continue;
            }
            let corners = self.mesh.facets[facet as usize];
            // Polygon of (drawing vertex or original vertex, position, original edge it lies on).
            let mut polygon: Vec<(DVec3, Name)> =
                corners.iter().map(|&i| (self.mesh.vertices_m[i as usize] - from_m, Name::Corner(i))).collect();
            for (number, plane) in planes.iter().enumerate() {
                polygon = cut(&polygon, *plane, number);
                if polygon.len() < 3 {
                    break;
                }
            }
            if polygon.len() < 3 {
                continue;
            }
            let ids: Vec<u32> = polygon
                .iter()
                .map(|(p, name)| match name {
                    // A corner inside all planes: drawn where it was, if it has a finite place.
                    Name::Corner(i) => *i,
                    Name::Cut(a, b, plane) => *places.entry((*a, *b, *plane)).or_insert_with(|| {
                        self.points.push(project(&self.view, *p + from_m));
                        index_u32(self.points.len()) - 1
                    }),
                    Name::Inner => {
                        self.points.push(project(&self.view, *p + from_m));
                        index_u32(self.points.len()) - 1
                    }
                })
                .collect();
            // Of the whole facet: a narrow piece may be turned over by rounding.
            let side = match seen_from_above(&self.mesh.facet(facet as usize), centre_m) {
                Some(true) => FRONT,
                Some(false) => BACK,
                None => continue,
            };
            self.flags[facet as usize] |= side;
            if side == BACK && hides_inner[facet as usize] {
                continue;
            }
            for k in 2..ids.len() {
                let vertices = [ids[0], ids[k - 1], ids[k]];
                let [a, b, c] = vertices.map(|v| self.points[v as usize]);
                let sound = [a, b, c].iter().all(|p| p.iter().all(|x| x.is_finite()) && (depth_m > 0.0 || p[2] > 0.0));
                let turn = turn([a[0], a[1]], [b[0], b[1]], [c[0], c[1]]);
                if sound && (if side == FRONT { turn < 0.0 } else { turn > 0.0 }) {
                    self.extra.push(Extra { facet, vertices });
                }
            }
        }
    }

    /// An edge is open unless the facet beyond it is drawn on the same side, and in one piece.
    fn mark_open_edges(&mut self) {
        let sides = &self.flags;
        let mark = |(&flag, neighbour): (&u8, &[u32; 3])| {
            let side = flag & (FRONT | BACK);
            let mut marked = flag;
            for (k, &n) in neighbour.iter().enumerate() {
                if n == NONE || side == 0 || sides[n as usize] & (FRONT | BACK | CUT) != side {
                    marked |= OPEN[k];
                }
            }
            marked
        };
        let neighbours = &self.topology.neighbour;
        let mut flags: Vec<u8> = match self.listed {
            None => sides.par_iter().with_min_len(4096).zip(neighbours).map(mark).collect(),
            Some(facets) => {
                let mut flags = vec![0; sides.len()];
                for facet in facets.iter().map(|facet| *facet as usize) {
                    flags[facet] = mark((&sides[facet], &neighbours[facet]));
                }
                flags
            }
        };
        // Pieces of cut facets: every edge open. They are few, and open only means that nothing is taken for granted.
        let all_open = DRAWN | MAYBE_EDGE_ON | OPEN[0] | OPEN[1] | OPEN[2];
        flags.extend(self.extra.iter().map(|e| all_open | sides[e.facet as usize] & (FRONT | BACK)));
        self.flags = flags;
    }

    fn measure(&mut self, Extent { near, across }: Extent) {
        let image = self.grid.bounds();
        self.magnitude[0] = (1.0 + 2.0 * CUT_BEYOND) * image.max[0].max(image.max[1]);
        self.magnitude[1] = match self.view {
            View::Parallel { .. } => {
                // Heights are sums of products of coordinates, however flat the mesh.
                let largest = |near: f64, vertex_m: &DVec3| near.max(vertex_m.abs().max_element());
                match self.listed {
                    None => self.mesh.vertices_m.iter().fold(near, largest),
                    Some(facets) => {
                        let corners_m = facets.iter().flat_map(|facet| self.mesh.facet(*facet as usize).corners_m);
                        corners_m.fold(near, |near, corner_m| largest(near, &corner_m))
                    }
                }
            }
            // Heights above the point in the middle of the mesh are as good as what lies across, however flat the mesh.
            View::Pinhole { depth_m, scale, .. } if depth_m > 0.0 => {
                near.max(across / (scale[0].min(scale[1]) * depth_m))
            }
            View::Pinhole { .. } => near,
        };
    }
}

/// What a corner of a cut facet is: an original vertex, a point on an original edge and a plane, or neither.
#[derive(Clone, Copy, PartialEq)]
enum Name {
    Corner(u32),
    Cut(u32, u32, usize),
    Inner,
}

/// The part of a polygon where n . p + constant >= 0. Crossings are computed in the order of the original edge's ends.
fn cut(polygon: &[(DVec3, Name)], (normal, constant): (DVec3, f64), number: usize) -> Vec<(DVec3, Name)> {
    let mut out = Vec::new();
    for i in 0..polygon.len() {
        let ((p, a), (q, b)) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let (d, e) = (normal.dot(p) + constant, normal.dot(q) + constant);
        if d >= 0.0 {
            out.push((p, a));
        }
        if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
            let (from, to, df, de, name) = match (a, b) {
                (Name::Corner(x), Name::Corner(y)) if x <= y => (p, q, d, e, Name::Cut(x, y, number)),
                (Name::Corner(x), Name::Corner(y)) => (q, p, e, d, Name::Cut(y, x, number)),
                _ => (p, q, d, e, Name::Inner),
            };
            out.push((from + (to - from) * (df / (df - de)), name));
        }
    }
    out
}

pub(super) fn project(view: &View, p_m: DVec3) -> [f64; 3] {
    match view {
        View::Parallel { h, v, u, scale, offset } => {
            [p_m.dot(*h) * scale[0] + offset[0], p_m.dot(*v) * scale[1] + offset[1], -p_m.dot(*u)]
        }
        View::Pinhole { from_m, depth_m, h, v, u, scale, offset, .. } => {
            let p = p_m - *from_m;
            let along = p.dot(*u);
            let near = 1.0 / (along + depth_m);
            // 1 / depth minus that of the point in the middle of the mesh: just as affine, and with all its digits.
            let nearness = if *depth_m > 0.0 { -along * near / depth_m } else { near };
            [p.dot(*h) * near * scale[0] + offset[0], p.dot(*v) * near * scale[1] + offset[1], nearness]
        }
    }
}

/// Twice the signed area of a triangle, with the sign of exact arithmetic.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    let coord = |p: Point| Coord { x: p[0], y: p[1] };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether a place is on the outer side of a facet, in exact arithmetic; `None` in its plane.
fn seen_from_above(facet: &Facet, eye_m: DVec3) -> Option<bool> {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let [a, b, c] = facet.corners_m.map(coord);
    let below = orient3d(a, b, c, coord(eye_m));
    (below != 0.0).then_some(below < 0.0)
}

/// Half the length of a triangle's outline, up to a factor of 2.
fn around(outline: &[Point; 3]) -> f64 {
    let [a, b, c] = outline;
    let side = |p: &Point, q: &Point| (q[0] - p[0]).abs() + (q[1] - p[1]).abs();
    side(a, b).max(side(a, c))
}

/// Where a facet lies, seen from another's plane.
enum Lies {
    /// On the outer side.
    Above,
    /// On the inner side.
    Below,
    /// In the plane.
    Within,
    /// On both sides.
    Across,
}

/// Where a facet lies, seen from the plane of `of`; corners within `rounding` of their coordinates lie in it.
fn lies(facet: &Facet, of: &Facet, rounding: f64) -> Lies {
    let [a, b, c] = of.corners_m;
    let largest = facet.corners_m.iter().chain(&of.corners_m).fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    let (to_b, to_c) = (b - a, c - a);
    let normal = to_b.cross(to_c);
    let (lb, lc) = (to_b.length(), to_c.length());
    let (mut above, mut below) = (false, false);
    for corner in facet.corners_m {
        let to_corner = corner - a;
        let height = normal.dot(to_corner);
        // What a change of every coordinate by its rounding makes of the volume.
        let l = to_corner.length();
        let least = rounding * largest * (lb * lc + lb * l + lc * l);
        above |= height > least;
        below |= height < -least;
    }
    match (above, below) {
        (true, false) => Lies::Above,
        (false, true) => Lies::Below,
        (false, false) => Lies::Within,
        (true, true) => Lies::Across,
    }
}

/// Unit vectors across `towards`: h along the longer extent of some facets as seen from there, v along the shorter; h x v = -towards.
fn long_and_short(mesh: &Mesh, count: usize, facet: impl Fn(usize) -> usize, towards: Direction) -> (DVec3, DVec3) {
    let (h, v) = towards.reversed().frame();
    // A few thousand facets tell the extent as well as all of them.
    let step = count.div_ceil(4096).max(1);
    let centres: Vec<[f64; 2]> = (0..count)
        .step_by(step)
        .map(|place| {
            let p = mesh.facet(facet(place)).centroid_m();
            [p.dot(h), p.dot(v)]
        })
        .collect();
    let count = centres.len().max(1) as f64;
    let mean = [0, 1].map(|k| centres.iter().map(|c| c[k]).sum::<f64>() / count);
    let moment = |i: usize, k: usize| centres.iter().map(|c| (c[i] - mean[i]) * (c[k] - mean[k])).sum::<f64>();
    let angle = 0.5 * (2.0 * moment(0, 1)).atan2(moment(0, 0) - moment(1, 1));
    let (sin, cos) = angle.sin_cos();
    (cos * h + sin * v, cos * v - sin * h)
}

/// A view from afar with axes right and down, and about so many cells that hold some points.
fn fitted(
    points_m: impl Iterator<Item = DVec3>,
    (h, v): (DVec3, DVec3),
    towards: Direction,
    cells: f64,
) -> (View, Grid) {
    let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in points_m {
        let at = [p.dot(h), p.dot(v)];
        lo = [lo[0].min(at[0]), lo[1].min(at[1])];
        hi = [hi[0].max(at[0]), hi[1].max(at[1])];
    }
    let side = cells.sqrt().ceil().clamp(1.0, 4096.0);
    let grid = Grid { columns: whole_u32(side), rows: whole_u32(side) };
    // A margin of 1e-3 cells keeps the outermost points inside.
    let scale = [0, 1].map(|k| {
        let extent = hi[k] - lo[k];
        if extent > 0.0 { (side - 2e-3) / extent } else { 1.0 }
    });
    let offset = [1e-3 - lo[0] * scale[0], 1e-3 - lo[1] * scale[1]];
    (View::Parallel { h, v, u: -towards.vec(), scale, offset }, grid)
}
