//! Motion smear during an exposure, and its warning.

use glam::DVec2;

use super::acquisition::Moving;
use super::observation::Observation;
use crate::geometry::FrameCamera;
use crate::product::{Exposed, Exposures};
use crate::scene::{Readout, Timing};

/// Exposures sampled for smear, and steps in each.
const SMEARS: usize = 16;
const SMEAR_STEPS: u32 = 8;
/// Smear below this, pixels, is not reported.
const SMEAR_PX: f64 = 0.05;

impl Moving<'_> {
    /// Largest smear of the mesh's middle over sampled exposures, pixels; `None` where it is not in front of the
    /// camera, or unknown.
    fn smear_px(&self) -> Option<f64> {
        let Moving { scene, motion, timing, .. } = *self;
        if let Readout::Sample(mirror) = timing.readout {
            // The mirror is what moves.
            let turned_rad = mirror.step_rad.abs() * timing.exposure_s / mirror.sample_s;
            return Some(turned_rad / scene.exposure.camera.pitch[0]);
        }
        let (low_m, high_m) = scene.body.bounds_m()?;
        let seen = |s: f64| {
            let pose = motion.pose(motion.start.after_s(s)).ok()?;
            let camera = FrameCamera { world_from_sensor: pose, ..scene.exposure.camera.clone() };
            camera.place(0.5 * (low_m + high_m)).map(DVec2::from)
        };
        let count = timing.count(&scene.exposure);
        let of_exposure = |i: usize| {
            let at = |k: u32| timing.middle_s(i) + timing.exposure_s * (f64::from(k) / f64::from(SMEAR_STEPS) - 0.5);
            let places: Option<Vec<DVec2>> = (0..=SMEAR_STEPS).map(|k| seen(at(k))).collect();
            let places = places?;
            let end = |by: fn(DVec2, DVec2) -> DVec2| places.iter().copied().reduce(by);
            Some((end(DVec2::max)? - end(DVec2::min)?).length())
        };
        (0..count).step_by(count.div_ceil(SMEARS).max(1)).filter_map(of_exposure).reduce(f64::max)
    }

    /// The warning about smear.
    pub(super) fn smear_remark(&self, tolerance: f64) -> Option<String> {
        let smear_px = self.smear_px().filter(|px| *px > SMEAR_PX)?;
        let moves = format!("the scene moves by {smear_px:.2} pixels during an exposure");
        Some(match self.timing.poses {
            0 | 1 => format!(
                "{moves}, and only its middle is modelled: `sensor.exposure_poses = {}` keeps errors at edges within {tolerance}",
                Timing::poses_for(smear_px, tolerance)
            ),
            poses => format!(
                "{moves}, modelled by {poses} poses: the error at an edge is at most {:.1e} of the contrast",
                self.timing.smear_error(smear_px)
            ),
        })
    }
}

/// What is known before of how a scene is taken: by how much it moves during an exposure, and what moment other commands take for all of it.
pub fn foreseen(moving: Moving<'_>, tolerance: f64) -> Vec<String> {
    let Moving { scene, timing, .. } = moving;
    let count = timing.count(&scene.exposure);
    let parts = (count > 1).then(|| {
        let reference = timing.reference(&scene.exposure);
        format!(
            "the image is taken in {count} parts over {:.1} s: bounds, and what is said of the scene, are of the middle of part {}",
            timing.duration_s(&scene.exposure),
            reference + 1
        )
    });
    parts.into_iter().chain(moving.smear_remark(tolerance)).collect()
}

/// Adds to the account of a frame that was taken at once when and from where it was.
pub fn tell_exposure(moving: Moving<'_>, tolerance: f64, observation: &mut Observation<()>) {
    let Moving { scene, timing, .. } = moving;
    let taken = timing.takes(&scene.exposure).map(|take| Exposed {
        epoch: moving.epoch(&take),
        take,
        camera: scene.exposure.camera.clone(),
        to_sun: scene.sky.sun.direction,
        sun_m: scene.sky.sun.distance_m,
        backplanes: None,
    });
    let exposures = Exposures { origin_m: scene.body.origin_m, taken: taken.collect(), reference: None };
    observation.exposures = Some(exposures);
    observation.warnings.extend(moving.smear_remark(tolerance));
}
