//! Geolocation: the ground point of a pixel, and the pixel of a ground point, for any sensor, at the epoch of each.
//!
//! Image coordinates are continuous, pixels from the outer corner of the first pixel. For a push-broom the line is
//! time: line coordinate l is the epoch `start` + `exposure_s` / 2 + (l - 1/2) `period_s`, and the ray goes through the
//! middle of the slit. For a whisk-broom the sample is time and scan angle, and the line, less those of earlier sweeps,
//! is along the column.

use std::sync::OnceLock;

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::flight::Epoch;
use crate::geometry::{FrameCamera, Pose, angle_rad, direction_of_deg, planetocentric_deg, whole};
use crate::scene::{Body, Mirror, Motion, Readout, Scene, Timing};
use crate::visibility::RayTree;

/// Least number of epochs at which the side of the slit is tested.
const LOOKS: usize = 64;
/// Epochs in a cycle of the fastest jitter, and how many at most.
const LOOKS_OF_CYCLE: f64 = 16.0;
const MOST_LOOKS: f64 = 65_536.0;
/// Most iterations for the mirror angle of a point.
const TURNS: usize = 50;
/// Most bisections between two epochs: to machine precision.
const HALVINGS: usize = 80;
/// Smallest difference in distance, relative, by which one surface hides another: the rest is rounding.
const BEHIND: f64 = 1e-9;
/// Convergence of the mirror angle, samples.
const ON_POINT: f64 = 1e-10;

/// A scene, its sensor and its surface, ready for queries.
#[derive(Debug)]
pub struct Locator<'a> {
    pub(super) scene: &'a Scene,
    pub(super) motion: Option<(&'a Motion, Timing)>,
    pub(super) tree: &'a RayTree,
    /// The camera in the middle of each exposure, cached: many places share an exposure.
    middles: Vec<OnceLock<Now>>,
}

/// The reference band, from 0: the middle one for a filter.
pub fn reference_band(scene: &Scene, motion: Option<(&Motion, Timing)>) -> usize {
    match motion {
        Some((_, timing)) if timing.readout == Readout::Band => timing.reference(&scene.exposure),
        _ => 0,
    }
}

/// Refuses a band, from 0, that a scene does not have; `item` asks for it.
///
/// # Errors
/// [`Error::Invalid`].
pub fn check_band(scene: &Scene, band: usize, item: &str) -> Result<()> {
    let count = scene.exposure.bands.len();
    if band < count {
        return Ok(());
    }
    Err(Error::invalid(Location::item(item), format!("band {} is not one of {count}", band.saturating_add(1))))
}

/// A place of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Along a line, pixels.
    pub sample: f64,
    /// From line to line, pixels.
    pub line: f64,
}

/// The ground point of an image place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// From the body's centre along its axes, m.
    pub point_m: DVec3,
    /// The facet.
    pub facet: u32,
    /// Whether its outer side is seen.
    pub front: bool,
    /// From the camera, m.
    pub range_m: f64,
    /// Angle between the facet's normal and the ray back to the camera, rad.
    pub local_emission_rad: f64,
    /// Epoch: the middle of the exposure; `None` for a static scene.
    pub epoch: Option<Epoch>,
}

impl Ground {
    /// Planetocentric latitude and longitude east, deg, 0 to 360.
    pub fn latitude_longitude_deg(&self) -> [f64; 2] {
        planetocentric_deg(self.point_m)
    }
}

/// The image place of a ground point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Where.
    pub place: Place,
    /// Whether that is in the image.
    pub inside: bool,
    /// The facet that hides it from the camera, if one does.
    pub hidden_by: Option<u32>,
    /// From the camera, m.
    pub range_m: f64,
    /// Epoch; `None` for a static scene.
    pub epoch: Option<Epoch>,
}

/// The outermost facet at a planetocentric latitude and east longitude, deg, and the point there, from the body's
/// centre in body axes, m.
pub fn outermost_at(body: &Body, place_deg: [f64; 2]) -> Option<(u32, DVec3)> {
    let (low_m, high_m) = body.bounds_m()?;
    let up = direction_of_deg(place_deg);
    // A ray from outside the body towards the centre, no farther.
    let reach_m = (low_m + body.origin_m).abs().max((high_m + body.origin_m).abs()).length();
    let from_m = up * (2.0 * reach_m);
    let hit = body.ray_tree().nearest(from_m - body.origin_m, -up).filter(|hit| hit.t <= 2.0 * reach_m)?;
    Some((hit.facet, from_m - up * hit.t))
}

/// A camera at an epoch.
#[derive(Debug, Clone)]
pub(super) struct Now {
    pub(super) camera: FrameCamera,
    pub(super) epoch: Option<Epoch>,
}

impl<'a> Locator<'a> {
    /// For a scene, and its motion, if any.
    pub fn new(scene: &'a Scene, motion: Option<(&'a Motion, Timing)>) -> Self {
        let exposures = motion.map_or(1, |(_, timing)| match timing.readout {
            Readout::Sample(_) => 0,
            Readout::Frame | Readout::Band | Readout::Line => timing.count(&scene.exposure),
        });
        let middles = (0..exposures).map(|_| OnceLock::new()).collect();
        Locator { scene, motion, tree: scene.body.ray_tree(), middles }
    }

    /// The reference band, counted from 0: the middle one for a filter.
    pub fn reference_band(&self) -> usize {
        reference_band(self.scene, self.motion)
    }

    /// The ground point at an image place in a band, counted from 0; `None`: no surface.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such band, or a position is unknown at its epoch.
    pub fn ground(&self, place: Place, band: usize) -> Result<Option<Ground>> {
        let now = self.camera_at(place, band)?;
        let (from_m, ray) = (now.camera.centre_m(), self.ray(&now, place));
        // A lens shows nothing beyond its fold.
        let Some(hit) = self.tree.nearest(from_m, ray).filter(|_| ray.is_finite()) else { return Ok(None) };
        let to_m = hit.t * ray;
        let normal = self.scene.body.mesh.facet(hit.facet as usize).cross_m2();
        Ok(Some(Ground {
            point_m: from_m + to_m + self.scene.body.origin_m,
            facet: hit.facet,
            front: hit.front,
            range_m: to_m.length(),
            local_emission_rad: angle_rad(normal, -ray),
            epoch: now.epoch,
        }))
    }

    /// The image place of a ground point, from the body's centre in body axes, m, in a band, counted from 0; `None` if
    /// it is never in front of the camera or never in the slit. Of several crossings of the slit the first one is used.
    ///
    /// # Errors
    /// As [`ground`](Locator::ground).
    pub fn place(&self, point_m: DVec3, band: usize) -> Result<Option<Seen>> {
        let local_m = point_m - self.scene.body.origin_m;
        let all = &self.scene.exposure.camera;
        let found = match self.readout() {
            Readout::Frame | Readout::Band => {
                let now = self.camera_at(Place { sample: 0.0, line: 0.0 }, band)?;
                let at = now.camera.place(local_m);
                at.map(|[sample, line]| (Place { sample, line }, now))
            }
            Readout::Line => match self.line_of(local_m)? {
                Some(line) => {
                    let now = self.camera_at(Place { sample: 0.0, line }, band)?;
                    let at = now.camera.place(local_m);
                    at.map(|[sample, _]| (Place { sample, line }, now))
                }
                None => None,
            },
            Readout::Sample(mirror) => match self.swept(&mirror, local_m)? {
                Some(place) => Some((place, self.camera_at(place, band)?)),
                None => None,
            },
        };
        let Some((place, now)) = found else { return Ok(None) };
        let inside = (0.0..=f64::from(all.samples)).contains(&place.sample)
            && (0.0..=f64::from(all.lines)).contains(&place.line);
        let to_m = local_m - now.camera.centre_m();
        // Only a nearer surface, by more than rounding, hides it.
        let before = self.tree.nearest(now.camera.centre_m(), to_m).filter(|hit| hit.t < 1.0 - BEHIND);
        Ok(Some(Seen {
            place,
            inside,
            hidden_by: before.map(|hit| hit.facet),
            range_m: to_m.length(),
            epoch: now.epoch,
        }))
    }

    fn readout(&self) -> Readout {
        self.motion.map_or(Readout::Frame, |(_, timing)| timing.readout)
    }

    /// The viewing direction through an image place.
    pub(super) fn ray(&self, now: &Now, place: Place) -> DVec3 {
        let [sample, line] = match self.readout() {
            Readout::Frame | Readout::Band => [place.sample, place.line],
            Readout::Line => [place.sample, now.camera.boresight_px[1]],
            // The mirror brings the place to the middle of the column.
            Readout::Sample(mirror) => [0.5, place.line - f64::from(mirror.elements) * self.sweep(&mirror, place.line)],
        };
        now.camera.ray(sample, line)
    }

    /// The camera of a band when a place is taken; the slit alone for a push-broom, the column for a whisk-broom.
    fn camera_at(&self, place: Place, band: usize) -> Result<Now> {
        check_band(self.scene, band, "band")?;
        let exposure = match self.readout() {
            Readout::Frame => Some(0),
            Readout::Band => Some(band),
            Readout::Line => Some(whole(place.line)).filter(|line| place.line == *line as f64 + 0.5),
            Readout::Sample(_) => None,
        };
        let now = || self.camera_later(place, band, 0.0);
        let Some(kept) = exposure.and_then(|i| self.middles.get(i)) else { return now() };
        if let Some(now) = kept.get() {
            return Ok(now.clone());
        }
        let now = now()?;
        Ok(kept.get_or_init(|| now).clone())
    }

    /// The same, seconds later; the mirror does not move.
    pub(super) fn camera_later(&self, place: Place, band: usize, by_s: f64) -> Result<Now> {
        let exposure = &self.scene.exposure;
        let mut camera = exposure.camera.clone();
        let Some((motion, timing)) = self.motion else { return Ok(Now { camera, epoch: None }) };
        let mut mirror_rad = None;
        let middle_s = match timing.readout {
            Readout::Frame => timing.middle_s(0),
            Readout::Band => timing.middle_s(band),
            Readout::Line => {
                camera.lines = 1;
                camera.boresight_px[1] = 0.5;
                timing.middle_s(0) + (place.line - 0.5) * timing.period_s
            }
            Readout::Sample(mirror) => {
                (camera.samples, camera.lines) = (1, mirror.elements);
                camera.boresight_px = [0.5, 0.5 * f64::from(mirror.elements)];
                mirror_rad = Some(mirror.angle_rad(place.sample));
                let in_sweep_s = mirror.since_s(place.sample);
                timing.middle_s(0) + self.sweep(&mirror, place.line) * timing.period_s + in_sweep_s
            }
        };
        let epoch = motion.start.after_s(middle_s + by_s);
        let pose: Pose = motion.pose(epoch)?;
        let pose = mirror_rad.map_or(pose, |angle_rad| Mirror::turned(pose, angle_rad));
        Ok(Now { camera: FrameCamera { world_from_sensor: pose, ..camera }, epoch: Some(epoch) })
    }

    /// The sweep, counted from 0, that takes a line coordinate; outside the image the nearest one.
    fn sweep(&self, mirror: &Mirror, line: f64) -> f64 {
        let elements = f64::from(mirror.elements);
        let last = (f64::from(self.scene.exposure.camera.lines) / elements).floor() - 1.0;
        (line / elements).floor().clamp(0.0, last.max(0.0))
    }

    /// Where a whisk-broom takes a point: in the sweep whose column contains it or is nearest; `None` if it is never in
    /// front of the camera.
    fn swept(&self, mirror: &Mirror, local_m: DVec3) -> Result<Option<Place>> {
        let elements = f64::from(mirror.elements);
        let sweeps = self.scene.exposure.camera.lines / mirror.elements.max(1);
        let mut best: Option<(f64, Place)> = None;
        for sweep in 0..sweeps {
            let first = f64::from(sweep) * elements;
            let Some([sample, line]) = self.in_sweep(mirror, first, local_m)? else { continue };
            // Distance outside: across the column, and beyond either end of the sweep.
            let beyond = |at: f64, end: f64| (-at).max(at - end).max(0.0);
            let off = beyond(line, elements).max(beyond(sample, f64::from(mirror.samples)));
            if best.as_ref().is_none_or(|(least, _)| off < *least) {
                best = Some((off, Place { sample, line: first + line }));
            }
            if off == 0.0 {
                break;
            }
        }
        Ok(best.map(|(_, place)| place))
    }

    /// The sample at which a sweep that begins with a line has a point in the middle of its column's width, and its
    /// place along the column.
    ///
    /// Fixed-point iteration: the mirror moves most, so the angle to the point at one time gives the next time.
    fn in_sweep(&self, mirror: &Mirror, first: f64, local_m: DVec3) -> Result<Option<[f64; 2]>> {
        let mut sample = 0.5 * f64::from(mirror.samples);
        for _ in 0..TURNS {
            let now = self.camera_at(Place { sample, line: first + 0.5 }, 0)?;
            let at = now.camera.world_from_sensor.inverse().point(local_m);
            let step = at.x.atan2(at.z) / mirror.step_rad;
            sample += step;
            // Angles beyond half a turn are behind the camera.
            if !(at.z > 0.0 || step.abs() < f64::from(mirror.samples)) || !sample.is_finite() {
                return Ok(None);
            }
            if step.abs() <= ON_POINT {
                return Ok(now.camera.place(local_m).map(|[_, y]| [sample, y]));
            }
        }
        Ok(None)
    }

    /// The line coordinate at which a point crosses the middle of the slit, from half a line before the image to half a
    /// line after it.
    fn line_of(&self, local_m: DVec3) -> Result<Option<f64>> {
        // Signed distance from the slit's plane, in pixels; `None` behind the camera.
        let side = |line: f64| -> Result<Option<f64>> {
            let now = self.camera_at(Place { sample: 0.0, line }, 0)?;
            Ok(now.camera.place(local_m).map(|[_, y]| y - now.camera.boresight_px[1]))
        };
        // Half a line beyond both ends, so that what lies on one is not lost by rounding.
        let lines = f64::from(self.scene.exposure.camera.lines) + 1.0;
        // Jitter moves the slit to and fro.
        let cycles = self.motion.map_or(0.0, |(motion, timing)| {
            motion.pointing.jitter.as_ref().map_or(0.0, |jitter| jitter.band_hz[1] * timing.period_s * lines)
        });
        let looks = LOOKS
            .max(self.scene.exposure.camera.lines as usize / 16)
            .max(whole((LOOKS_OF_CYCLE * cycles).min(MOST_LOOKS)));
        let at = |i: usize| lines * i as f64 / looks as f64 - 0.5;
        // The half lines may lie outside the coverage: an error only if nothing is known at any of them.
        let (mut unknown, mut known) = (None, 0);
        let mut look = |i: usize| match side(at(i)) {
            Err(Error::Invalid(problems)) => {
                unknown.get_or_insert(problems);
                Ok((at(i), None))
            }
            side => {
                known += 1;
                side.map(|side| (at(i), side))
            }
        };
        let mut before = look(0)?;
        let mut outside = None;
        for i in 1..=looks {
            let after = look(i)?;
            if let (Some(a), Some(b)) = (before.1, after.1)
                && (a <= 0.0) != (b <= 0.0)
            {
                // Jitter crosses it several times: in the image, if in any.
                let line = self.crossing((before.0, a), (after.0, b), side)?;
                if (0.0..=lines - 1.0).contains(&line) {
                    return Ok(Some(line));
                }
                outside.get_or_insert(line);
            }
            before = after;
        }
        if let Some(problems) = unknown.filter(|_| known == 0) {
            return Err(Error::Invalid(problems));
        }
        if outside.is_some() {
            return Ok(outside);
        }
        // Exactly in the slit at the last epoch.
        Ok(before.1.filter(|y| *y == 0.0).map(|_| before.0))
    }

    /// The line, between two on either side, at which a point is in the slit: bracketed secants.
    fn crossing(
        &self,
        mut low: (f64, f64),
        mut high: (f64, f64),
        side: impl Fn(f64) -> Result<Option<f64>>,
    ) -> Result<f64> {
        let mut by_secant = true;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low.0 + high.0);
            let secant = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let next = if by_secant && low.0 < secant && secant < high.0 { secant } else { middle };
            if next == low.0 || next == high.0 {
                break;
            }
            let width = high.0 - low.0;
            match side(next)? {
                Some(0.0) => return Ok(next),
                Some(y) if (y <= 0.0) == (low.1 <= 0.0) => low = (next, y),
                Some(y) => high = (next, y),
                None => break,
            }
            // A secant step that gains less than half is followed by a bisection.
            by_secant = high.0 - low.0 <= 0.5 * width || !by_secant;
            if (high.0 - low.0) <= 4.0 * f64::EPSILON * high.0.abs() {
                break;
            }
        }
        Ok(if low.1.abs() <= high.1.abs() { low.0 } else { high.0 })
    }
}
