//! Cameras: how points of space become points of an image, and back.
//!
//! One type serves the sensor of a scene and the image of a radiance map; its kinds are central and parallel projections.

use std::ops::Range;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::polygon::{Point, Rect};
use super::{Direction, Lens, Pose, whole_u32};

/// A pinhole camera, with what its lens does to the image. Sensor axes: +X sample (right), +Y line (down), +Z boresight.
///
/// The boresight is the axis of projection, and need not meet the image in its middle, or at all: shifted lenses and windows cut
/// from larger images are cameras too.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameCamera {
    /// Placement of the sensor in the scene: axes are h, v, u; translation is the projection centre, local to the origin, m.
    pub world_from_sensor: Pose,
    /// Pixels in a line.
    pub samples: u32,
    /// Lines.
    pub lines: u32,
    /// Width and height of a pixel over the focal length (dimensionless): 2 tan(IFOV / 2).
    pub pitch: [f64; 2],
    /// Where the boresight meets the image, pixels from the first pixel's outer corner.
    pub boresight_px: [f64; 2],
    /// What the lens does to the image of that pinhole; `None`: nothing.
    pub lens: Option<Arc<Lens>>,
}

impl FrameCamera {
    /// A camera with square pixels whose boresight goes through the image's middle.
    pub fn centred(world_from_sensor: Pose, samples: u32, lines: u32, pitch: f64) -> Self {
        let boresight_px = [samples, lines].map(|n| 0.5 * f64::from(n));
        FrameCamera { world_from_sensor, samples, lines, pitch: [pitch; 2], boresight_px, lens: None }
    }

    /// A part of the image: some samples of some lines, from the same place.
    #[must_use]
    pub fn window(&self, samples: Range<u32>, lines: Range<u32>) -> Self {
        let [x, y] = self.boresight_px;
        FrameCamera {
            samples: samples.end.saturating_sub(samples.start),
            lines: lines.end.saturating_sub(lines.start),
            boresight_px: [x - f64::from(samples.start), y - f64::from(lines.start)],
            ..self.clone()
        }
    }

    /// The same for parts of pixels, so many along and across each, of some lines and of so many pixels more on each side.
    ///
    /// # Errors
    /// What a lens does not say of parts of pixels, or of what is beside the image, as a sentence.
    pub fn refined(&self, parts: u32, more: u32, lines: Range<u32>) -> Result<Self, String> {
        let larger = |pixels: u32| (pixels + 2 * more) * parts;
        let ([x, y], [more_px, parts_px]) = (self.boresight_px, [more, parts].map(f64::from));
        let (samples, lines_of_parts) = (larger(self.samples), larger(lines.end.saturating_sub(lines.start)));
        let pitch = self.pitch.map(|pitch| pitch / parts_px);
        let boresight_px = [(x + more_px) * parts_px, (y - f64::from(lines.start) + more_px) * parts_px];
        let lens = match self.active_lens().map(Lens::coefficients) {
            None => None,
            Some(Some(of)) => Lens::brown_conrady(of, pitch, boresight_px, [samples, lines_of_parts])?.map(Arc::new),
            Some(None) => {
                return Err("a table of directions says where pixels look, and not what is seen between them and beside the image, whose light optics \
                            bring in: give the lens by `sensor.distortion`, or leave optics out with `ideal = true` (`--ideal`)"
                    .into());
            }
        };
        Ok(FrameCamera { samples, lines: lines_of_parts, pitch, boresight_px, lens, ..self.clone() })
    }

    /// Whether pixels are square, the boresight goes through the image's middle, and the lens does nothing.
    pub fn is_centred(&self) -> bool {
        let Self { samples, lines, pitch, boresight_px, lens, .. } = self;
        lens.is_none() && pitch[0] == pitch[1] && *boresight_px == [*samples, *lines].map(|n| 0.5 * f64::from(n))
    }

    /// Whether it is the image that its lens was made for, or a window of it; of a slit's lens, a line of it.
    pub fn is_within_lens(&self) -> bool {
        let Some(lens) = &self.lens else { return true };
        let (size, of_px) = ([self.samples, self.lines], lens.boresight_px());
        // Where a window begins is a difference of two numbers; a band of a slit may look somewhat beyond its ends, where a lens goes on.
        let is_slit = lens.size()[1] == 1;
        let rounding = |k: usize| if is_slit { 17.0 } else { 1e-6 + 4.0 * f64::EPSILON * of_px[k].abs() };
        let is_within = |k: usize| {
            let first = of_px[k] - self.boresight_px[k];
            first >= -rounding(k) && first + f64::from(size[k]) <= f64::from(lens.size()[k]) + rounding(k)
        };
        lens.pitch() == self.pitch && is_within(0) && (is_slit || is_within(1))
    }

    /// The projection centre, m.
    pub fn centre_m(&self) -> DVec3 {
        self.world_from_sensor.translation_m
    }

    /// Direction (not of unit length: 1 along the boresight) of the ray through image point (x, y), pixels from the first pixel's outer corner; not a number where the
    /// lens shows nothing, which is outside the image.
    pub fn ray(&self, x_px: f64, y_px: f64) -> DVec3 {
        let x = (x_px - self.boresight_px[0]) * self.pitch[0];
        let y = (y_px - self.boresight_px[1]) * self.pitch[1];
        let [x, y] = self.active_lens().map_or([x, y], |lens| lens.ideal([x, y]).unwrap_or([f64::NAN; 2]));
        self.world_from_sensor.vector(DVec3::new(x, y, 1.0))
    }

    /// Where a local point, m, appears in the image, pixels from the first pixel's outer corner; `None` behind the camera, and where the lens shows nothing.
    pub fn place(&self, p_m: DVec3) -> Option<Point> {
        let h = Projection::of_frame(self).homogeneous(p_m);
        let at = (h.z > 0.0).then(|| [h.x / h.z, h.y / h.z])?;
        match self.active_lens() {
            None => Some(at),
            Some(lens) => Some(self.px(lens.imaged(self.tangents(at))?)),
        }
    }

    /// Where the lens has what its pinhole shows at a place, pixels both, and how that changes with the place; `None` where it shows nothing.
    pub fn lensed(&self, px: Point) -> Option<(Point, [[f64; 2]; 2])> {
        let Some(lens) = self.active_lens() else { return Some((px, [[1.0, 0.0], [0.0, 1.0]])) };
        let (imaged, jacobian) = lens.imaged_with(self.tangents(px))?;
        let by_px = [0, 1].map(|i| [0, 1].map(|k| jacobian[i][k] * self.pitch[k] / self.pitch[i]));
        Some((self.px(imaged), by_px))
    }

    /// The pinhole through which its image is drawn.
    pub fn drawn(&self) -> Drawn<'_> {
        Drawn::of(self)
    }

    /// Its lens, if it is one of all lines: the lens of a slit says nothing of lines beside it.
    fn active_lens(&self) -> Option<&Lens> {
        self.lens.as_deref().filter(|lens| lens.size()[1] > 1 || self.lines == 1)
    }

    /// Tangents of a place, without the lens.
    fn tangents(&self, px: Point) -> Point {
        [0, 1].map(|k| (px[k] - self.boresight_px[k]) * self.pitch[k])
    }

    /// The inverse.
    fn px(&self, tangents: Point) -> Point {
        [0, 1].map(|k| tangents[k] / self.pitch[k] + self.boresight_px[k])
    }

    /// Size of a pixel over the focal length, of a square one of the same area.
    pub fn mean_pitch(&self) -> f64 {
        if self.pitch[0] == self.pitch[1] { self.pitch[0] } else { (self.pitch[0] * self.pitch[1]).sqrt() }
    }

    /// By how much rounding may move what is drawn, pixels: 4 eps x range over the width of a pixel at that range.
    pub fn rounding_px(&self) -> f64 {
        4.0 * f64::EPSILON / self.pitch[0].min(self.pitch[1])
    }

    /// Angle that a pixel on the boresight subtends along its line, rad.
    pub fn ifov_rad(&self) -> f64 {
        Self::angle_of_pitch(self.pitch[0], 1)
    }

    /// Width of a pixel over the focal length if this many pixels, centred on the boresight, subtend this angle, rad.
    pub fn pitch_of_angle(angle_rad: f64, pixels: u32) -> f64 {
        2.0 * (0.5 * angle_rad).tan() / f64::from(pixels)
    }

    /// The angle, rad, that this many pixels, centred on the boresight, subtend: the inverse of
    /// [`pitch_of_angle`](FrameCamera::pitch_of_angle).
    pub fn angle_of_pitch(pitch: f64, pixels: u32) -> f64 {
        2.0 * (0.5 * f64::from(pixels) * pitch).atan()
    }
}

/// The pinhole through which a camera's image is drawn, so that straight edges are straight: without its lens, with square cells of the size of a pixel in the middle, as
/// many as cover all of its pixels. Without a lens cells are pixels.
#[derive(Debug, Clone)]
pub struct Drawn<'a> {
    /// Its pixels are the cells.
    pub pinhole: FrameCamera,
    camera: &'a FrameCamera,
}

impl<'a> Drawn<'a> {
    fn of(camera: &'a FrameCamera) -> Self {
        let mut drawn = Drawn { pinhole: FrameCamera { lens: None, ..camera.clone() }, camera };
        if camera.active_lens().is_some() {
            // What is not folded has all of itself inside its border.
            let [samples, lines] = [camera.samples, camera.lines];
            let rows = (0..=samples).flat_map(|x| [[x, 0], [x, lines]]);
            let border = rows.chain((0..=lines).flat_map(|y| [[0, y], [samples, y]]));
            let places: Vec<Point> = border.map(|px| drawn.at(px.map(f64::from))).collect();
            let Rect { min, max } = Rect::of(&places);
            let first = min.map(f64::floor);
            let [columns, rows] = [0, 1].map(|k| whole_u32((max[k].ceil() - first[k]).max(1.0)));
            let boresight_px = [0, 1].map(|k| camera.boresight_px[k] - first[k]);
            drawn.pinhole = FrameCamera { samples: columns, lines: rows, boresight_px, ..drawn.pinhole };
        }
        drawn
    }

    /// Whether pixels are other than cells.
    pub fn is_distorted(&self) -> bool {
        self.camera.active_lens().is_some()
    }

    /// Where a place of the image, pixels, lies in the drawing, cells; not a number where the lens shows nothing.
    pub fn at(&self, px: Point) -> Point {
        match self.camera.active_lens() {
            None => px,
            Some(lens) => self.pinhole.px(lens.ideal(self.camera.tangents(px)).unwrap_or([f64::NAN; 2])),
        }
    }
}

/// A camera at infinity: all rays are parallel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParallelCamera {
    /// Towards it.
    pub towards: Direction,
    /// Pixels in a line.
    pub samples: u32,
    /// Lines.
    pub lines: u32,
    /// Steps from sample to sample, and from line to line, pixels per metre; both across the rays, of any angle to each other.
    pub sample_per_m: DVec3,
    /// See `sample_per_m`.
    pub line_per_m: DVec3,
    /// A point near the scene, local, m.
    pub origin_m: DVec3,
    /// Where it appears, pixels from the first pixel's outer corner.
    pub origin_px: [f64; 2],
}

/// A camera of either kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Camera {
    /// Rays go through a point.
    Frame(FrameCamera),
    /// Rays are parallel.
    Parallel(ParallelCamera),
}

/// From where an image is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Eye {
    /// A point, local, m.
    At(DVec3),
    /// From infinity, in this direction.
    Towards(Direction),
}

impl Camera {
    /// Pixels in a line, and lines.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Camera::Frame(camera) => [camera.samples, camera.lines],
            Camera::Parallel(camera) => [camera.samples, camera.lines],
        }
    }

    /// The same without a lens, with pixels that cover all that it sees.
    #[must_use]
    pub fn drawn(&self) -> Camera {
        match self {
            Camera::Frame(camera) => Camera::Frame(camera.drawn().pinhole),
            Camera::Parallel(camera) => Camera::Parallel(*camera),
        }
    }

    /// From where it sees.
    pub fn eye(&self) -> Eye {
        match self {
            Camera::Frame(camera) => Eye::At(camera.centre_m()),
            Camera::Parallel(camera) => Eye::Towards(camera.towards),
        }
    }

    /// How points appear in its image, but for its lens.
    pub fn projection(&self) -> Projection {
        match self {
            Camera::Frame(camera) => Projection::of_frame(camera),
            Camera::Parallel(camera) => Projection::of_parallel(camera),
        }
    }
}

/// From a local point, m, to homogeneous image coordinates: linear (p - origin) + offset = (column, row, 1) w.
///
/// Pixel (0, 0) is the square from (0, 0) to (1, 1); columns run along a line, rows from line to line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Pixels per metre; the last row is zero for parallel projections.
    pub linear: DMat3,
    /// A point near the scene, or the projection centre, local, m.
    pub origin_m: DVec3,
    /// Homogeneous image coordinates of that point.
    pub offset: DVec3,
}

impl Projection {
    fn of_frame(camera: &FrameCamera) -> Self {
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

    fn of_parallel(camera: &ParallelCamera) -> Self {
        let ParallelCamera { sample_per_m, line_per_m, origin_m, origin_px: [x, y], .. } = *camera;
        let linear = DMat3::from_cols(sample_per_m, line_per_m, DVec3::ZERO).transpose();
        Projection { linear, origin_m, offset: DVec3::new(x, y, 1.0) }
    }

    /// Homogeneous image coordinates of a local point, m; the third is positive in front of the viewer.
    pub fn homogeneous(&self, p_m: DVec3) -> DVec3 {
        self.linear * (p_m - self.origin_m) + self.offset
    }

    /// Texel coordinates (column, row) of a local point, m.
    pub fn at(&self, p_m: DVec3) -> [f64; 2] {
        let h = self.homogeneous(p_m);
        [h.x / h.z, h.y / h.z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_projects_as_its_rays_go() {
        // Boresight down, right is +x: a point 2 m east and 1 m south of the axis, 100 m below, pitch 0.01: 2 and 1 pixels.
        let rotation = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
        let world_from_sensor = Pose { rotation, translation_m: DVec3::new(5.0, 6.0, 107.0) };
        let camera = FrameCamera::centred(world_from_sensor, 8, 6, 0.01);
        let projection = Camera::Frame(camera).projection();
        assert_eq!(projection.at(DVec3::new(7.0, 5.0, 7.0)), [6.0, 4.0]);
        assert!(projection.homogeneous(DVec3::new(7.0, 5.0, 108.0)).z < 0.0);
    }

    #[test]
    fn a_parallel_camera_counts_pixels_from_its_origin() {
        let camera = ParallelCamera {
            towards: Direction::new(DVec3::Z).unwrap(),
            samples: 4,
            lines: 3,
            sample_per_m: DVec3::Y * 2.0,
            line_per_m: DVec3::X * 0.5,
            origin_m: DVec3::new(1.0, 2.0, 3.0),
            origin_px: [10.0, 20.0],
        };
        let camera = Camera::Parallel(camera);
        assert_eq!(camera.projection().at(DVec3::new(5.0, 3.0, -9.0)), [12.0, 22.0]);
        assert_eq!(camera.size(), [4, 3]);
    }
}
