//! What was taken when, and from where; and how images that were taken at different moments lie on each other.

use glam::DVec3;

use super::{Backplanes, Plane};
use crate::flight::Epoch;
use crate::geometry::{Direction, FrameCamera};
use crate::scene::Take;

/// A part of a cube, when and from where it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposed {
    /// Its lines and bands.
    pub take: Take,
    /// The middle of the exposure.
    pub epoch: Epoch,
    /// Optics and pose then, local; of a push-broom one line.
    pub camera: FrameCamera,
    /// Towards the Sun.
    pub to_sun: Direction,
    /// From the origin to the Sun, m.
    pub sun_m: f64,
    /// Its own backplanes, if they were wanted: those of a product are the reference's.
    pub backplanes: Option<Backplanes>,
}

/// All parts of a cube, in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposures {
    /// Origin of local coordinates, from the body's centre along its axes, m.
    pub origin_m: DVec3,
    /// The parts.
    pub taken: Vec<Exposed>,
    /// The part whose image the backplanes are of; `None` if they are of all.
    pub reference: Option<usize>,
}

impl Exposures {
    /// By how many samples (axis 0) or lines (axis 1) what is at the centre of each pixel of the reference image lies elsewhere in the image of another part,
    /// pixels; NaN where the pixel's centre shows no surface, or what it shows is not before the camera then. `None` without such planes.
    pub fn displacement(&self, backplanes: &Backplanes, part: usize, axis: usize) -> Option<Plane> {
        self.reference?;
        let part = self.taken.get(part)?;
        let place = |axis: &str| Some(&backplanes.plane(&format!("BODYFIXED{axis}"))?.values);
        let (x, y, z) = (place("X")?, place("Y")?, place("Z")?);
        let moved_px = |pixel: usize| {
            let at = part.camera.place(DVec3::new(x[pixel], y[pixel], z[pixel]) - self.origin_m);
            let centre = [pixel % backplanes.samples, pixel / backplanes.samples].map(|i| i as f64 + 0.5);
            at.map_or(f64::NAN, |at| at[axis] - centre[axis])
        };
        let along = ["samples", "lines"][axis];
        let name = format!("DISPLACEMENT of band {}, {along}", part.take.bands.start + 1);
        Some(Plane { name, unit: "px".into(), values: (0..x.len()).map(moved_px).collect() })
    }
}
