//! Motion smear during an exposure, and its warning.

use glam::{DVec2, DVec3};

use super::moving::Moving;
use super::observation::Observation;
use crate::geometry::{FrameCamera, whole_u32};
use crate::product::{Exposed, Exposures};
use crate::scene::{Readout, Take, Timing};

/// Exposures sampled for smear, and steps in each.
const SMEARS: usize = 16;
const SMEAR_STEPS: u32 = 8;
/// A plan takes no more poses of an exposure: what is left is said.
const MOST_POSES: u32 = 64;
/// Smear below this, pixels, is not reported.
const SMEAR_PX: f64 = 0.05;
/// Lines that follow one another closer, or farther apart, than so many pixels are worth one.
const ADVANCE_PX: [f64; 2] = [0.5, 1.5];

impl Moving<'_> {
    /// By how many pixels what an exposure shows moves meanwhile at most, of some exposures: in the middle of its image, along its borders and in its corners, as far away as the middle
    /// of the mesh. Infinite where it comes to lie behind the camera, `None` where nothing is known.
    fn smear_px(&self) -> Option<f64> {
        let timing = self.timing;
        let takes: Vec<Take> = timing.takes(&self.scene.exposure).collect();
        let of_take = |take: &Take| {
            let points_m = self.shown_m(take)?;
            let at = |k: u32| take.middle_s + timing.exposure_s * (f64::from(k) / f64::from(SMEAR_STEPS) - 0.5);
            // Beside the middle, nothing may be known.
            let cameras = (0..=SMEAR_STEPS).filter_map(|k| Some(self.exposure_at(take, at(k)).ok()?.camera));
            let cameras: Vec<FrameCamera> = cameras.collect();
            let moved_px = |point_m: &DVec3| {
                let places: Option<Vec<DVec2>> =
                    cameras.iter().map(|camera| camera.place(*point_m).map(DVec2::from)).collect();
                let Some(places) = places else { return f64::INFINITY };
                let end = |by: fn(DVec2, DVec2) -> DVec2| places.iter().copied().reduce(by).unwrap_or_default();
                (end(DVec2::max) - end(DVec2::min)).length()
            };
            points_m.iter().map(moved_px).reduce(f64::max)
        };
        some(&takes).filter_map(of_take).reduce(f64::max)
    }

    /// Points that an exposure shows in its middle, along its borders and in its corners, as far away as the middle of the mesh, m.
    fn shown_m(&self, take: &Take) -> Option<Vec<DVec3>> {
        let (low_m, high_m) = self.scene.body.bounds_m()?;
        let camera = self.exposure_at(take, take.middle_s).ok()?.camera;
        let far_m = (0.5 * (low_m + high_m) - camera.centre_m()).length();
        let [samples, lines] = [camera.samples, camera.lines].map(f64::from);
        let shares = [0.5, 0.0, 1.0];
        let places = shares.into_iter().flat_map(|x| shares.map(|y| (x * samples, y * lines)));
        let points = places.map(|(x, y)| camera.centre_m() + far_m * camera.ray(x, y).normalize());
        Some(points.filter(|point| point.is_finite()).collect())
    }

    /// The warning about smear.
    pub(super) fn smear_remark(&self, tolerance: f64) -> Option<String> {
        let smear_px = self.smear_px().filter(|px| *px > SMEAR_PX)?;
        let camera = &self.scene.exposure.camera;
        let poses = self.timing.poses.max(1);
        // Then parts of the image have nothing in common.
        if smear_px > f64::from(camera.samples.max(camera.lines)) {
            let count = if poses == 1 { "one pose stands".to_owned() } else { format!("{poses} poses stand") };
            return Some(format!(
                "what is seen leaves the image during an exposure, for which {count}: no bound holds; a shorter `sensor.exposure_s`, or a slower turn, would be another image"
            ));
        }
        let moves = format!("what is seen moves by {smear_px:.2} pixels during an exposure");
        Some(match poses {
            1 => format!(
                "{moves}, of which the middle is taken: `sensor.exposure_poses = {}` keeps errors at edges within {tolerance}",
                Timing::poses_for(smear_px, tolerance)
            ),
            _ => format!(
                "{moves}, for which {poses} poses stand: at an edge a pixel is off by at most {:.1e} of the contrast; Sun and shadows are those of the middle",
                self.timing.smear_error(smear_px)
            ),
        })
    }

    /// Of a push-broom, what a reader should know of how its lines follow one another: that they show the same ground, or leave some out.
    pub(super) fn advance_remark(&self) -> Option<String> {
        if self.timing.readout != Readout::Line {
            return None;
        }
        let takes: Vec<Take> = self.timing.takes(&self.scene.exposure).collect();
        let advance_px = |pair: &[Take]| {
            let point_m = *self.shown_m(&pair[0])?.first()?;
            let seen = |take: &Take| self.exposure_at(take, take.middle_s).ok()?.camera.place(point_m);
            Some((seen(&pair[1])?[1] - seen(&pair[0])?[1]).abs())
        };
        let pairs: Vec<&[Take]> = takes.windows(2).collect();
        let mut all: Vec<f64> = some(&pairs).filter_map(|pair| advance_px(pair)).collect();
        if all.is_empty() {
            return None;
        }
        let middle = all.len() / 2;
        let px = *all.select_nth_unstable_by(middle, f64::total_cmp).1;
        let lines = format!("from line to line the slit goes on by {px:.2} pixels of the ground");
        if px < ADVANCE_PX[0] {
            let help = "a push-broom flies across its slit and lets the ground go by: a longer `period_s` puts lines farther apart; with a `target_m` in `[flight.pointing]` it would be kept on one place";
            return Some(format!("{lines}: lines show nearly the same ({help})"));
        }
        (px > ADVANCE_PX[1])
            .then(|| format!("{lines}: what is between lines is not seen (a shorter `period_s` would show it)"))
    }
}

/// Some of a list, evenly.
fn some<T>(all: &[T]) -> impl Iterator<Item = &T> {
    all.iter().step_by(all.len().div_ceil(SMEARS).max(1))
}

/// How many poses keep an exposure's smear within a tolerance: one if that does, or if how things move is not known.
pub fn poses(moving: Moving<'_>, tolerance: f64) -> u32 {
    let smear_px = moving.smear_px().filter(|px| *px > tolerance);
    smear_px.map_or(1, |px| whole_u32(Timing::poses_for(px, tolerance)).clamp(1, MOST_POSES))
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
    parts.into_iter().chain(moving.smear_remark(tolerance)).chain(moving.advance_remark()).collect()
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
