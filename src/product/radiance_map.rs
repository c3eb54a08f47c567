//! Radiance that was computed elsewhere: where a map's texels lie in a scene, and what they hold.

use glam::{DMat3, DVec3};

use crate::error::Result;
use crate::geometry::{Direction, Mesh};
use crate::scene::FrameCamera;
use crate::spectral::{Band, KnownLight};
use crate::visibility::{Grid, View};

/// From a local point, m, to homogeneous texel coordinates: linear (p - origin) + offset = (column, row, 1) w.
///
/// Texel (0, 0) is the square from (0, 0) to (1, 1); columns run along a line, rows from line to line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Texels per metre; the last row is zero for parallel projections.
    pub linear: DMat3,
    /// A point near the scene, or the projection centre, local, m.
    pub origin_m: DVec3,
    /// Homogeneous texel coordinates of that point.
    pub offset: DVec3,
}

impl Projection {
    /// That of a camera: texels are its pixels.
    pub fn of_camera(camera: &FrameCamera) -> Self {
        let sensor_from_world = camera.world_from_sensor.rotation.transpose();
        let [x, y] = camera.boresight_px;
        // Columns of the matrix that takes (x, y, z) of the sensor to pixels times depth.
        let pixels = DMat3::from_cols(
            DVec3::new(1.0 / camera.pitch[0], 0.0, 0.0),
            DVec3::new(0.0, 1.0 / camera.pitch[1], 0.0),
            DVec3::new(x, y, 1.0),
        );
        Projection { linear: pixels * sensor_from_world, origin_m: camera.centre_m(), offset: DVec3::ZERO }
    }

    /// A parallel projection: steps from column to column and from row to row in texels per metre, and the texel coordinates of
    /// `origin_m`.
    pub fn parallel(column_per_m: DVec3, row_per_m: DVec3, origin_m: DVec3, texel_of_origin: [f64; 2]) -> Self {
        let linear = DMat3::from_cols(column_per_m, row_per_m, DVec3::ZERO).transpose();
        let [column, row] = texel_of_origin;
        Projection { linear, origin_m, offset: DVec3::new(column, row, 1.0) }
    }

    /// Homogeneous texel coordinates of a local point, m; the third is positive in front of the viewer.
    pub fn homogeneous(&self, p_m: DVec3) -> DVec3 {
        self.linear * (p_m - self.origin_m) + self.offset
    }

    /// Texel coordinates (column, row) of a local point, m.
    pub fn texel(&self, p_m: DVec3) -> [f64; 2] {
        let h = self.homogeneous(p_m);
        [h.x / h.z, h.y / h.z]
    }
}

/// From where an image was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Eye {
    /// A point, local, m.
    At(DVec3),
    /// From infinity, in this direction.
    Towards(Direction),
}

/// An image of the scene whose texels are put back onto what they saw.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewImage {
    /// Where a point appears.
    pub projection: Projection,
    /// From where.
    pub eye: Eye,
    /// Lines of texels.
    pub rows: usize,
    /// Texels in a line.
    pub columns: usize,
    /// Whether a surface that others hide from the eye is unknown; if not, the image goes through everything.
    pub occlusion: bool,
}

impl ViewImage {
    /// The image's own view of the scene, in which cells are texels; rows are counted from the last one if the second is true: seen
    /// from its eye, the image is a mirror image.
    ///
    /// `None` if the projection has no directions, or the image more texels in a line than can be drawn.
    pub fn drawn(&self, mesh: &Mesh) -> Option<(View, Grid, bool)> {
        let grid = Grid { columns: u32::try_from(self.columns).ok()?, rows: u32::try_from(self.rows).ok()? };
        let Projection { linear, origin_m, offset } = self.projection;
        let [s, t, w] = [0, 1, 2].map(|k| linear.row(k));
        let along = |axis: DVec3| Direction::new(axis).map(|d| (d.vec(), axis.length()));
        // Rows of a mirror image are counted from the last one: seen from its eye, what is right and down must be so.
        let down = |h: DVec3, v: DVec3, u: DVec3, row: f64| {
            let is_mirrored = h.cross(v).dot(u) < 0.0;
            if is_mirrored { (-v, self.rows as f64 - row, true) } else { (v, row, false) }
        };
        match self.eye {
            Eye::Towards(towards) => {
                let ((h, columns), (v, rows), u) = (along(s)?, along(t)?, -towards.vec());
                let (v, row, is_mirrored) = down(h, v, u, offset.y - t.dot(origin_m));
                let offset = [offset.x - s.dot(origin_m), row];
                Some((View::Parallel { h, v, u, scale: [columns, rows], offset }, grid, is_mirrored))
            }
            Eye::At(centre_m) => {
                let (u, per_m) = along(w)?;
                let boresight = [s, t].map(|axis| axis.dot(u) / per_m);
                let (h, columns) = along(s / per_m - u * boresight[0])?;
                let (v, rows) = along(t / per_m - u * boresight[1])?;
                let (v, row, is_mirrored) = down(h, v, u, boresight[1]);
                let view = View::pinhole(mesh, centre_m, [h, v, u], [columns, rows], [boresight[0], row]);
                Some((view, grid, is_mirrored))
            }
        }
    }
}

/// Convex parts of facets, each a texel's.
///
/// Vertices are (u, v) on the facet, as in [`Seen`](super::Seen).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Patches {
    /// Number of texels.
    pub texels: usize,
    /// The facet of each polygon, ascending.
    pub polygon_facet: Vec<u32>,
    /// The texel of each polygon.
    pub polygon_texel: Vec<u32>,
    /// First vertex of each polygon, and the number of vertices as the last element.
    pub polygon_start: Vec<usize>,
    /// Vertices of the polygons.
    pub uv: Vec<[f64; 2]>,
}

/// Texture coordinates of a mesh's facets, for an image of `rows` x `columns` texels.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// Texel coordinates (column, row) of each facet's corners; NaN where the mesh has none.
    pub corners: Vec<[[f64; 2]; 3]>,
    /// Lines of texels.
    pub rows: usize,
    /// Texels in a line.
    pub columns: usize,
}

impl PartialEq for Atlas {
    /// Corners without coordinates are alike.
    fn eq(&self, other: &Self) -> bool {
        let [ours, theirs] = [self, other].map(|atlas| atlas.corners.as_flattened().as_flattened());
        (self.rows, self.columns, ours.len()) == (other.rows, other.columns, theirs.len())
            && ours.iter().zip(theirs).all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

impl Atlas {
    /// Of texture coordinates: u to the right, v up from the last row, both 0 to 1 over the whole image.
    pub fn of_uv(uv: &[[[f64; 2]; 3]], rows: usize, columns: usize) -> Self {
        let texel = |[u, v]: [f64; 2]| [u * columns as f64, (1.0 - v) * rows as f64];
        Atlas { corners: uv.iter().map(|corners| corners.map(texel)).collect(), rows, columns }
    }
}

/// Where a map's texels lie in a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Placement {
    /// Texel i is facet i, of so many.
    Facets(usize),
    /// Texels are parts of facets.
    Patches(Patches),
    /// Texels are pixels of an image of the scene.
    View(Box<ViewImage>),
    /// Texels are pixels of an image that the mesh's texture coordinates address.
    Atlas(Atlas),
}

impl Placement {
    /// Number of texels.
    pub fn texels(&self) -> usize {
        match self {
            Placement::Facets(facets) => *facets,
            Placement::Patches(patches) => patches.texels,
            Placement::View(view) => view.rows * view.columns,
            Placement::Atlas(atlas) => atlas.rows * atlas.columns,
        }
    }
}

/// Spectral radiance of texels, read a band at a time: all bands of a large map need not fit into memory.
pub trait TexelSource: Send {
    /// The map's bands.
    fn bands(&self) -> &[Band];

    /// Reads a band, W m-2 sr-1 um-1: a value for each texel, line by line; NaN where there is none. `values` is cleared first.
    ///
    /// Bands are asked for in ascending order, each at most twice.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io), or [`Error::Invalid`](crate::Error::Invalid) for a value that no radiance has.
    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()>;

    /// The share of each texel that shows the surface and no sky, line by line, where the source knows it: a coverage plane, or
    /// alpha. What [`read`](Self::read) gives is then the mean over that share; NaN where it is 0.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    fn coverage(&mut self) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }
}

/// A radiance map: texels, and where they lie.
pub struct RadianceMap {
    /// What it is called in reports.
    pub name: String,
    /// Where its texels lie.
    pub placement: Placement,
    /// What they hold.
    pub source: Box<dyn TexelSource>,
    /// What the map's radiance is multiplied by.
    pub weight: f64,
    /// What light its bands hold, as far as anybody knows: one for each; of bands beyond the list nobody knows.
    pub light: Vec<KnownLight>,
    /// What texels that show surface in part hold.
    pub sky: SkyShare,
    /// How its place was found by its outline, if it was.
    pub registration: Option<Registration>,
}

impl RadianceMap {
    /// Whether any of its bands holds thermal emission, if that is known.
    pub fn heat(&self) -> Option<bool> {
        if self.light.iter().any(|light| light.heat == Some(true)) {
            return Some(true);
        }
        let all = self.light.len() == self.source.bands().len() && self.light.iter().all(|l| l.heat == Some(false));
        all.then_some(false)
    }
}

/// What a texel of an image holds that shows the scene in part, and sky beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SkyShare {
    /// Of a camera's image the mean over all of the texel, with a dark sky, unless its surroundings are as bright as the scene. Of
    /// other images the mean over what shows the scene, unless texels beside the scene are dark.
    #[default]
    Guessed,
    /// The mean over all of the texel, of which the sky is dark.
    Included,
    /// The mean over what shows the scene.
    LeftOut,
}

/// Where an image was found to lie, by its outline against the scene's.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    /// Columns and rows by which what it shows lies beyond where it was said to be.
    pub shift_texels: [f64; 2],
    /// The same along its lines and across, m.
    pub shift_m: [f64; 2],
    /// Share of the outline's area that image and scene have in common, as it was said to be and after the shift.
    pub overlap: [f64; 2],
    /// So far from there what it shows may lie, along its lines and across, as far as outlines tell, m: 0 where they decide.
    pub unverified_m: [f64; 2],
}

impl std::fmt::Debug for RadianceMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RadianceMap").field("name", &self.name).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    #[test]
    fn a_camera_projects_as_its_rays_go() {
        // Boresight down, right is +x: a point 2 m east and 1 m south of the axis, 100 m below, pitch 0.01: 2 and 1 pixels.
        let rotation = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
        let world_from_sensor = Pose { rotation, translation_m: DVec3::new(5.0, 6.0, 107.0) };
        let camera = FrameCamera::centred(world_from_sensor, 8, 6, 0.01);
        let projection = Projection::of_camera(&camera);
        assert_eq!(projection.texel(DVec3::new(7.0, 5.0, 7.0)), [6.0, 4.0]);
        assert!(projection.homogeneous(DVec3::new(7.0, 5.0, 108.0)).z < 0.0);
    }

    #[test]
    fn the_same_texture_coordinates_are_the_same_also_where_there_are_none() {
        let uv = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[f64::NAN; 2]; 3]];
        let atlas = || Atlas::of_uv(&uv, 2, 3);
        assert_eq!(atlas(), atlas());
        assert_eq!(atlas().corners[0], [[0.0, 2.0], [3.0, 2.0], [0.0, 0.0]]);
        assert_ne!(atlas(), Atlas::of_uv(&uv, 3, 2));
        assert_ne!(atlas(), Atlas::of_uv(&uv[..1], 2, 3));
    }

    #[test]
    fn a_parallel_projection_counts_texels_from_its_origin() {
        let origin_m = DVec3::new(1.0, 2.0, 3.0);
        let projection = Projection::parallel(DVec3::Y * 2.0, DVec3::X * 0.5, origin_m, [10.0, 20.0]);
        assert_eq!(projection.texel(DVec3::new(5.0, 3.0, -9.0)), [12.0, 22.0]);
    }
}
